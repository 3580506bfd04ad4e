//! Measures the methods of every stage against exact answers, and draws what came out.
//!
//! `cargo run --release -p whitted-tests --bin lab` writes the committed tables and charts anew.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use whitted_tests::lab::charts::{self, Failure};
use whitted_tests::lab::{self, Plan, cycles, pricing};

/// The method lab of whitted.
#[derive(Parser)]
struct Arguments {
    /// 10^7 rays a primitive and 10^9 at shared edges: half an hour, not two minutes.
    #[arg(long)]
    full: bool,
    /// So many rays at the edges, and as many at the corners, of each of the six meshes.
    #[arg(long, value_name = "COUNT")]
    rays: Option<u64>,
    /// Only these stages, as named in sweeps.csv, or `watertight`, `frames`, `sampling` or `light buffer`.
    #[arg(long, value_name = "STAGE", requires = "out")]
    only: Vec<String>,
    /// Where the tables and charts go, if not where the committed ones are.
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Prices methods and frames anew, in QEMU, and writes cycles.csv and frame-cycles.csv. Where the
    /// tools for that are missing, the committed figures serve.
    #[arg(long, conflicts_with = "check")]
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

fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let start = Instant::now();
    let committed = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/charts"));
    let (cycles, frame_cycles) = (
        committed.join("cycles.csv"),
        committed.join("frame-cycles.csv"),
    );
    let counted = arguments.price && pricing::is_possible();
    if counted {
        lab::table(&cycles, &pricing::measure()?)?;
        lab::table(&frame_cycles, &pricing::frames()?)?;
    } else if arguments.price {
        eprintln!("no compiler or no emulator for the part: the committed figures serve");
    }
    let mut plan = if arguments.full {
        Plan::FULL
    } else {
        Plan::QUICK
    };
    plan.our_rays = arguments.rays.unwrap_or(plan.our_rays);
    let wanted =
        |stage: &str| arguments.only.is_empty() || arguments.only.iter().any(|one| one == stage);
    let bar = ProgressBar::no_length().with_style(ProgressStyle::with_template(
        "{elapsed:>4} {spinner} {msg}",
    )?);
    bar.enable_steady_tick(Duration::from_millis(200));
    let mut results = lab::measure(plan, wanted, &|stage, sweep| {
        let text = format!("{stage}: {sweep}");
        // A log has no bar, but lines.
        if bar.is_hidden() {
            eprintln!("{:6.1} s  {text}", start.elapsed().as_secs_f64());
        }
        bar.set_message(text);
    });
    bar.finish_and_clear();
    results.prices = cycles::read(&cycles)?;
    results.frame_prices = cycles::read(&frame_cycles)?;
    results.counted = counted;
    if !arguments.check {
        let out = arguments.out.as_ref().unwrap_or(&committed);
        std::fs::create_dir_all(out)?;
        lab::write(&results, out)?;
        charts::draw_all(&results, out)?;
        let seconds = start.elapsed().as_secs_f64();
        eprintln!("{seconds:6.1} s  wrote {}", out.display());
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
