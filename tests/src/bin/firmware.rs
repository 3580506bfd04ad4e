//! Measures the firmware.
//!
//! `firmware table` rewrites the table under `tests/charts`; `firmware show TARGET [RUSTFLAG..]` tells
//! what every program takes there; `firmware peer TARGET [RUSTFLAG..]` compares with plain C;
//! `firmware hierarchy` and `firmware columns` rewrite only what is told of hierarchies, and of maps
//! by columns; `firmware annotate PROGRAM` shows where its cycles go.

use std::env;
use std::path::PathBuf;

use anyhow::{Context, Result, bail};
use whitted_tests::embedded::expected::{Expected, Kind};
use whitted_tests::embedded::firmware::Request;
use whitted_tests::embedded::image::Image;
use whitted_tests::embedded::instructions::Decoder;
use whitted_tests::embedded::measure::{self, PEERS, Row, Variant, in_c};
use whitted_tests::embedded::target::{CORTEX_M4F, Target};
use whitted_tests::embedded::{chart, columns, cortex_m4, firmware, hierarchy, run};

fn main() -> Result<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["table"] => {
            let (compiler, plugin) = (compiler()?, plugin()?);
            chart::write(&measure::table(&compiler, &plugin)?)?;
            columns::write(&columns::measure(&columns::targets(), &compiler, &plugin)?)?;
            hierarchy::write(&hierarchy::measure(&hierarchy::COUNTS, &compiler, &plugin)?)
        }
        ["columns"] => columns::write(&columns::measure(
            &columns::targets(),
            &compiler()?,
            &plugin()?,
        )?),
        ["hierarchy"] => {
            let savings = hierarchy::measure(&hierarchy::COUNTS, &compiler()?, &plugin()?)?;
            hierarchy::write(&savings)
        }
        ["show", target, ref rustflags @ ..] => show(target, rustflags),
        ["peer", target, ref rustflags @ ..] => peer(target, rustflags),
        ["annotate", program] => annotate(program),
        _ => bail!(
            "usage: firmware table | hierarchy | columns | show TARGET [RUSTFLAG..] | peer TARGET [RUSTFLAG..] | \
             annotate PROGRAM"
        ),
    }
}

fn compiler() -> Result<String> {
    firmware::compiler()?.context("no compiler; see tests/embedded.sh setup")
}

fn plugin() -> Result<PathBuf> {
    run::build_plugin(&firmware::build_directory())
}

/// Measures frames on a target.
fn measured(target: &str, rustflags: &[&str], frames: &measure::Frames) -> Result<Vec<Row>> {
    let variant = Variant {
        profile: "speed",
        target: Target::named(target).context("no such target")?,
        kind: Kind::Rows,
        request: Request {
            rustflags,
            ..Request::default()
        },
    };
    measure::measure(&[variant], frames, &compiler()?, &plugin()?)
}

/// What every program takes on a target.
fn show(target: &str, rustflags: &[&str]) -> Result<()> {
    let frames = Expected::all();
    println!(
        "{:20} flash support   ram stack bound  insn/px cycles/px rays/px shadow rays/px",
        ""
    );
    let rows = measured(target, rustflags, &frames)?;
    for (row, (_, expected)) in rows.iter().zip(&frames) {
        let counters = expected.counters;
        let rays = counters.primary + counters.reflected + counters.refracted;
        println!(
            "{:20} {:5} {:7} {:5} {:5} {:5} {:8.1} {:9.1} {:7.2} {:7.2}",
            row.program,
            row.flash,
            row.support,
            row.static_ram,
            row.stack,
            row.stack_bound.unwrap_or_default(),
            row.instructions,
            row.cycles.unwrap_or(f64::NAN),
            rays as f64 / expected.pixels as f64,
            counters.shadow as f64 / expected.pixels as f64,
        );
    }
    Ok(())
}

/// What the scenes take that plain C draws too, both ways.
fn peer(target: &str, rustflags: &[&str]) -> Result<()> {
    let all = Expected::all();
    let frames = ["empty"].into_iter().chain(PEERS);
    let frames = frames
        .map(|name| frame(&all, name))
        .collect::<Result<Vec<_>>>()?;
    let mut rows = measured(target, rustflags, &frames)?;
    let target = Target::named(target).context("no such target")?;
    rows.extend(measure::measure_peers(
        &[target],
        rustflags,
        &compiler()?,
        &plugin()?,
    )?);
    println!("{}", chart::against_c(&rows));
    Ok(())
}

fn frame(frames: &measure::Frames, name: &str) -> Result<(String, Expected)> {
    let found = frames.iter().find(|frame| frame.0 == name);
    found.cloned().with_context(|| format!("no frame {name}"))
}

/// A program's code on the Cortex-M4F, with how often each instruction runs and what it costs a pixel.
fn annotate(program: &str) -> Result<()> {
    let is_peer = program.ends_with(&in_c(""));
    let request = Request {
        programs: &[program],
        features: if is_peer { &["peer"] } else { &[] },
        ..Request::default()
    };
    let built = firmware::build(&[CORTEX_M4F], request)?;
    let image = Image::read(&built[0][program])?;
    let (_, profiles) = run::run_counted(&CORTEX_M4F, &image, &["render_row"], &plugin()?)?;
    let scene = program.trim_end_matches(&in_c(""));
    let pixels = frame(&Expected::all(), scene)?.1.pixels as f64;
    let prices = cortex_m4::price(&image, &profiles[0])?;
    let decoder = Decoder::new(&image)?;
    for (&start, function) in &image.functions {
        println!("\n{} ({} bytes)", function.symbol, function.size);
        let mut address = start;
        while address < start + function.size {
            if image.is_data(address) {
                address += 2;
                continue;
            }
            let instruction = decoder.at(address)?;
            let times = profiles[0]
                .instructions
                .get(&instruction.place)
                .copied()
                .unwrap_or_default();
            let cycles = prices
                .get(&instruction.place)
                .map_or(0, cortex_m4::Cycles::total);
            println!(
                "{:9.3} {:9.3} {instruction}",
                times as f64 / pixels,
                cycles as f64 / pixels
            );
            address += instruction.place.size;
        }
    }
    Ok(())
}
