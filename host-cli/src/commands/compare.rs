//! `whitted compare`.

use std::io::{self, Write};
use std::path::Path;

use anyhow::Context;

use super::Outcome;
use crate::args;
use crate::compare::Comparison;
use crate::output::Output;
use crate::picture::{Format, Picture, Transfer, Writer};

pub(super) fn run(args: &args::Compare) -> anyhow::Result<Outcome> {
    let diff = match &args.diff {
        Some(path) => Some((path, Format::of(path)?)),
        None => None,
    };
    let read = |path: &Path| Picture::read(path).with_context(|| path.display().to_string());
    let (a, b) = (read(&args.a)?, read(&args.b)?);
    let comparison = match Comparison::new(&a, &b) {
        Ok(comparison) => comparison,
        Err(error) => {
            writeln!(io::stdout(), "sizes differ: {error}")?;
            return Ok(Outcome::Different);
        }
    };
    if let Some((path, format)) = diff {
        write_diff(&comparison, path, format)
            .with_context(|| format!("cannot write {}", path.display()))?;
    }
    report(&comparison, args.max_diff)?;
    let beyond = comparison.pixels_beyond(args.max_diff) as f64;
    if beyond <= args.max_differing * comparison.all_pixels() as f64 {
        Ok(Outcome::Success)
    } else {
        Ok(Outcome::Different)
    }
}

fn report(comparison: &Comparison, max_diff: u16) -> io::Result<()> {
    let mut out = io::stdout().lock();
    let psnr = comparison.psnr();
    if psnr.is_finite() {
        writeln!(out, "PSNR: {psnr:.2} dB")?;
    } else {
        writeln!(out, "PSNR: infinite")?;
    }
    let (largest, max) = (comparison.largest(), comparison.max);
    writeln!(out, "largest channel difference: {largest} of {max}")?;
    let mut bounds = vec![0];
    if max_diff > 0 {
        bounds.push(max_diff);
    }
    for bound in bounds {
        let by = if bound == 0 {
            String::new()
        } else {
            format!(" by more than {bound}")
        };
        let pixels = comparison.pixels_beyond(bound);
        let share = 100.0 * pixels as f64 / comparison.all_pixels() as f64;
        let all = comparison.all_pixels();
        writeln!(
            out,
            "pixels that differ{by}: {pixels} of {all} ({share:.4} %)"
        )?;
        let channels = comparison.channels_beyond(bound);
        let share = 100.0 * channels as f64 / comparison.all_channels() as f64;
        let all = comparison.all_channels();
        writeln!(
            out,
            "channels that differ{by}: {channels} of {all} ({share:.4} %)"
        )?;
    }
    out.flush()
}

fn write_diff(comparison: &Comparison, path: &Path, format: Format) -> io::Result<()> {
    let output = Output::create(path)?;
    let (width, height) = (comparison.width as u32, comparison.height as u32);
    let mut writer = Writer::new(output.sink()?, format, width, height, Transfer::Linear)?;
    writer.rows(&comparison.picture())?;
    writer.finish()?;
    output.commit()
}
