//! `whitted cast`.

use std::io::{self, BufWriter, Write};

use anyhow::Context;

use super::Outcome;
use crate::args;
use crate::cast::{Cast, Lines, Query, cast_lines};
use crate::map::HostMap;
use crate::scene::{HostScene, Pool};
use crate::scene_file::{self, map};

pub(super) fn run(args: &args::Cast) -> anyhow::Result<Outcome> {
    let lines = if map::is_map(&args.scene) {
        answer(args, &HostMap::new(&map::read(&args.scene)?))?
    } else {
        let file = scene_file::read(&args.scene)?;
        let pool = Pool::new(&file);
        answer(args, &HostScene::new(&file, &pool)?)?
    };
    if lines.bad == 0 {
        return Ok(Outcome::Success);
    }
    let _ = writeln!(
        io::stderr(),
        "error: {} of {} lines were not rays",
        lines.bad,
        lines.all
    );
    Ok(Outcome::BadInput)
}

fn answer(args: &args::Cast, scene: &impl Cast) -> anyhow::Result<Lines> {
    let query = if args.occluded {
        Query::Occluded
    } else {
        Query::Closest
    };
    let mut output = BufWriter::new(io::stdout().lock());
    cast_lines(scene, query, io::stdin().lock(), &mut output).context("cannot answer all rays")
}
