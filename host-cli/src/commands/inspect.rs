//! `whitted inspect`.

use std::io::{self, Write};

use super::Outcome;
use crate::args;
use crate::inspect::inspect;
use crate::scene::{HostScene, Pool};
use crate::scene_file;

pub(super) fn run(args: &args::Inspect) -> anyhow::Result<Outcome> {
    let file = scene_file::read(&args.scene)?;
    let pool = Pool::new(&file);
    let scene = HostScene::new(&file, &pool)?;
    let report = inspect(&scene, &pool);
    let mut out = io::stdout().lock();
    if args.json {
        serde_json::to_writer_pretty(&mut out, &report).map_err(io::Error::from)?;
        writeln!(out)?;
    } else {
        write!(out, "{report}")?;
    }
    out.flush()?;
    Ok(Outcome::Success)
}
