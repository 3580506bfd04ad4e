//! Measures the methods of every stage against exact answers, and draws what came out.
//!
//! `cargo run --release -p whitted-tests --bin lab` writes the committed tables and charts anew.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use whitted_tests::lab::{self, Plan, charts, cycles, pricing};

/// The method lab of whitted.
#[derive(Parser)]
struct Arguments {
    /// A million inputs a cell and 10^9 rays at shared edges: for an hour, not a minute.
    #[arg(long)]
    full: bool,
    /// Only these stages, as named in sweeps.csv, or `watertight`.
    #[arg(long, value_name = "STAGE")]
    only: Vec<String>,
    /// Where the tables and charts go.
    #[arg(long, value_name = "FOLDER", default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/charts"))]
    out: PathBuf,
    /// Prices the methods anew, in QEMU, and writes cycles.csv before all else.
    #[arg(long)]
    price: bool,
    /// Writes nothing, and fails where a method that whitted uses is not on the front.
    #[arg(long)]
    check: bool,
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(code) => code,
        Err(failure) => {
            eprintln!("error: {failure}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<ExitCode, charts::Failure> {
    let start = Instant::now();
    let cycles = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/charts/cycles.csv"));
    if arguments.price {
        lab::table(&cycles, &pricing::measure()?)?;
    }
    let plan = if arguments.full {
        Plan::FULL
    } else {
        Plan::QUICK
    };
    let wanted =
        |stage: &str| arguments.only.is_empty() || arguments.only.iter().any(|one| one == stage);
    let mut results = lab::measure(plan, wanted, &|stage, sweep| {
        eprintln!("{:6.1} s  {stage}: {sweep}", start.elapsed().as_secs_f64());
    });
    results.prices = cycles::read(&cycles)?;
    if !arguments.check {
        std::fs::create_dir_all(&arguments.out)?;
        lab::write(&results, &arguments.out)?;
        charts::draw_all(&results, &arguments.out)?;
        eprintln!(
            "{:6.1} s  wrote {}",
            start.elapsed().as_secs_f64(),
            arguments.out.display()
        );
        return Ok(ExitCode::SUCCESS);
    }
    let unpriced = results.unpriced();
    if !unpriced.is_empty() {
        println!(
            "without a price in cycles.csv, so not compared: {}",
            unpriced.join("; ")
        );
    }
    let complaints = results.complaints();
    for complaint in &complaints {
        println!("{complaint}");
    }
    println!("{} complaints", complaints.len());
    Ok(if complaints.is_empty() {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}
