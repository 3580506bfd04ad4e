//! `whitted bake`.

use std::io::Write;

use anyhow::{Context, bail};

use super::Outcome;
use super::render::DEFAULT_SIZE;
use crate::args;
use crate::bake::{bake, bake_map};
use crate::map::HostMap;
use crate::output::Output;
use crate::scene::{HostScene, Pool};
use crate::scene_file::{self, map};

pub(super) fn run(args: &args::Bake) -> anyhow::Result<Outcome> {
    let size = |of_file: Option<[u32; 2]>| match args.size {
        Some(size) => [size.width, size.height],
        None => of_file.unwrap_or(DEFAULT_SIZE),
    };
    let module = if map::is_map(&args.scene) {
        let file = map::read(&args.scene)?;
        let map = HostMap::new(&file);
        let [width, height] = size(file.size);
        bake_map(&map, &map.view(width, height)?)
    } else {
        let file = scene_file::read(&args.scene)?;
        let pool = Pool::new(&file);
        let scene = HostScene::new(&file, &pool)?;
        let [width, height] = size(file.size);
        bake(&scene, scene.camera(width, height)?.as_ref())
    };
    if let Some(limit) = args.max_flash {
        let flash = module.flash();
        if flash > limit {
            bail!(
                "{}: the scene's arrays take {flash} bytes of flash, --max-flash allows {limit}",
                args.scene.display()
            );
        }
    }
    let cannot_write = || format!("cannot write {}", args.output.display());
    let output = Output::create(&args.output).with_context(cannot_write)?;
    let mut sink = output.sink().with_context(cannot_write)?;
    sink.write_all(module.text.as_bytes())
        .and_then(|()| sink.flush())
        .with_context(cannot_write)?;
    output.commit().with_context(cannot_write)?;
    Ok(Outcome::Success)
}
