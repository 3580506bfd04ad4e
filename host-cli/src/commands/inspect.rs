//! `whitted inspect`.

use std::fmt::Display;
use std::io::{self, Write};

use serde::Serialize;

use super::Outcome;
use super::render::DEFAULT_SIZE;
use crate::args;
use crate::inspect::{inspect, inspect_map};
use crate::map::HostMap;
use crate::scene::{HostScene, Pool};
use crate::scene_file::{self, map};

pub(super) fn run(args: &args::Inspect) -> anyhow::Result<Outcome> {
    if map::is_map(&args.scene) {
        let file = map::read(&args.scene)?;
        let map = HostMap::new(&file);
        let [width, height] = file.size.unwrap_or(DEFAULT_SIZE);
        show(args, &inspect_map(&map, &map.view(width, height)?))
    } else {
        let file = scene_file::read(&args.scene)?;
        let pool = Pool::new(&file);
        show(args, &inspect(&HostScene::new(&file, &pool)?, &pool))
    }
}

fn show(args: &args::Inspect, report: &(impl Serialize + Display)) -> anyhow::Result<Outcome> {
    let mut out = io::stdout().lock();
    if args.json {
        serde_json::to_writer_pretty(&mut out, report).map_err(io::Error::from)?;
        writeln!(out)?;
    } else {
        write!(out, "{report}")?;
    }
    out.flush()?;
    Ok(Outcome::Success)
}
