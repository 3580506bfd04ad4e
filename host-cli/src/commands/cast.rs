//! `whitted cast`.

use std::io::{self, BufWriter, Write};

use anyhow::Context;

use super::Outcome;
use crate::args;
use crate::cast::{Query, cast_lines};
use crate::scene::{HostScene, Pool};
use crate::scene_file;

pub(super) fn run(args: &args::Cast) -> anyhow::Result<Outcome> {
    let file = scene_file::read(&args.scene)?;
    let pool = Pool::new(&file);
    let scene = HostScene::new(&file, &pool)?;
    let query = if args.occluded {
        Query::Occluded
    } else {
        Query::Closest
    };
    let mut output = BufWriter::new(io::stdout().lock());
    let lines = cast_lines(&scene, query, io::stdin().lock(), &mut output)
        .context("cannot answer all rays")?;
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
