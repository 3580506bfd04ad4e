//! Measures the firmware.
//!
//! `firmware table` rewrites the table under `tests/charts`; `firmware show TARGET [RUSTFLAG..]` tells
//! what every program takes there; `firmware annotate PROGRAM` shows where its cycles go.

use std::env;

use anyhow::{Context, Result, bail};
use whitted_tests::embedded::expected::Expected;
use whitted_tests::embedded::firmware::{Build, Kind, Options};
use whitted_tests::embedded::image::Image;
use whitted_tests::embedded::instructions::Decoder;
use whitted_tests::embedded::measure::{self, Variant};
use whitted_tests::embedded::target::{CORTEX_M4F, Target};
use whitted_tests::embedded::{chart, cortex_m4, firmware, run};

fn main() -> Result<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["table"] => table(),
        ["show", target, ref rustflags @ ..] => show(target, rustflags),
        ["annotate", program] => annotate(program),
        _ => bail!("usage: firmware table | show TARGET [RUSTFLAG..] | annotate PROGRAM"),
    }
}

/// Measures all variants and writes the table.
fn table() -> Result<()> {
    let compiler = firmware::compiler()?.context("no compiler; see tests/embedded.sh setup")?;
    let expected = Expected::all();
    let plugin = run::build_plugin(&firmware::build_directory())?;
    let mut rows = Vec::new();
    for variant in measure::variants() {
        eprintln!("{}, {}", variant.target.name, variant.profile);
        rows.extend(variant.measure(&compiler, &expected, &plugin)?);
    }
    chart::write(&rows)
}

/// What every program takes on a target.
fn show(target: &str, rustflags: &[&str]) -> Result<()> {
    let target = Target::named(target).context("no such target")?;
    let compiler = firmware::compiler()?.context("no compiler; see tests/embedded.sh setup")?;
    let expected = Expected::all();
    let plugin = run::build_plugin(&firmware::build_directory())?;
    let options = Options {
        rustflags,
        ..Options::default()
    };
    let variant = Variant {
        profile: "speed",
        target,
        kind: Kind::Rows,
        options,
    };
    println!(
        "{:20} flash support   ram stack bound  insn/px cycles/px rays/px shadow rays/px",
        ""
    );
    for (row, (_, expected)) in variant
        .measure(&compiler, &expected, &plugin)?
        .iter()
        .zip(&expected)
    {
        let counters = expected.counters;
        let rays = counters.primary + counters.reflected + counters.refracted;
        println!(
            "{:20} {:5} {:7} {:5} {:5} {:5} {:8.1} {:9.1} {:7.2} {:7.2}",
            row.program,
            row.flash,
            row.support,
            row.static_ram,
            row.stack,
            row.stack_bound,
            row.instructions,
            row.cycles.unwrap_or(f64::NAN),
            rays as f64 / expected.pixels as f64,
            counters.shadow as f64 / expected.pixels as f64,
        );
    }
    Ok(())
}

/// A program's code on the Cortex-M4F, with how often each instruction runs and what it costs a pixel.
fn annotate(program: &str) -> Result<()> {
    let Build::Programs(programs) = firmware::build(&CORTEX_M4F, Kind::Rows)? else {
        bail!("no compiler for {}", CORTEX_M4F.triple);
    };
    let image = Image::read(programs.get(program).context("no such program")?)?;
    let plugin = run::build_plugin(&firmware::build_directory())?;
    let (_, profiles) = run::run_counted(&CORTEX_M4F, &image, &["render_row"], &plugin)?;
    let frames = Expected::all();
    let (_, frame) = frames
        .iter()
        .find(|(name, _)| *name == program)
        .context("no such frame")?;
    let pixels = frame.pixels as f64;
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
