//! whitted beside other ray tracers, on the same rays and scenes in one run.
//!
//! ```sh
//! cargo run --release -p whitted-bench             # all of it: ten minutes
//! cargo run --release -p whitted-bench -- --quick  # two minutes
//! ```
//!
//! Prints ratios, each of the least of several interleaved rounds on one thread: how many times as long
//! as whitted the others take. `tests/charts/bench.md`, `bench.csv` and `bench-*.svg` keep what a full run
//! found.
//!
//! A full run also builds `whitted` for this very processor, to compare it with the plain build.
//! `WHITTED_EMBREE` may name another library than Debian's Embree 3.

mod crates;
mod embree;
mod frames;
mod growth;
mod ours;
mod peer;
mod pov;
mod report;
mod workload;

use std::time::Instant;

use clap::Parser;
use peer::{Builder, Peer};
use report::{Report, chart, ratio};
use whitted_cli::wide::Wide;
use workload::{Answer, Query, Workload};

/// The first two are the two ways to ask whitted.
const PEERS: [Builder; 14] = [
    ours::wide,
    ours::together,
    ours::wide_avx2,
    ours::scalar,
    embree::single,
    embree::user,
    embree::packets,
    crates::obvhs_bvh2,
    crates::obvhs_cwbvh,
    crates::bvh,
    crates::parry,
    crates::parry_flat,
    crates::tiny,
    crates::tiny8,
];

fn run(
    peer: &dyn Peer,
    query: Query,
    rays: &[whitted::Ray],
    answers: &mut [Answer],
    flags: &mut [bool],
) -> f64 {
    let start = Instant::now();
    match query {
        Query::Nearest => peer.nearest(rays, answers),
        Query::Any => peer.any(rays, flags),
    }
    start.elapsed().as_secs_f64()
}

fn workloads(quick: bool) -> Vec<Workload> {
    let mut workloads = vec![
        Workload::new("8 spheres", workload::spheres(8), 256),
        Workload::new("64 spheres", workload::spheres(64), 256),
        Workload::new("16 boxes", workload::cuboids(16), 256),
        Workload::new("16 triangles", workload::triangles(16), 256),
        Workload::new("sphereflake", workload::flake(4), 256),
        Workload::new("10,000 spheres", workload::spheres(10_000), 256),
        Workload::new("10,000 triangles", workload::triangles(10_000), 256),
        Workload::new("10,000, a surface", workload::surface(10_000), 256),
    ];
    if !quick {
        workloads.extend([
            Workload::new("1,000,000 spheres", workload::spheres(1_000_000), 256),
            Workload::new("1,000,000 triangles", workload::triangles(1_000_000), 256),
        ]);
    }
    workloads
}

/// Who takes so many seconds for a set of rays is asked about it once.
const SLOW: f64 = 0.5;

/// One set of rays by every peer: how long each took, least of the rounds, and how many rays hit.
fn measure(
    peers: &[Box<dyn Peer + '_>],
    workload: &Workload,
    set: &workload::RaySet,
    rounds: usize,
) -> Vec<(f64, usize)> {
    let mut answers = vec![Answer::MISS; set.rays.len()];
    let mut flags = vec![false; set.rays.len()];
    let mut best = vec![(f64::INFINITY, 0); peers.len()];
    for round in 0..rounds {
        for (best, peer) in best.iter_mut().zip(peers) {
            let is_hopeless = peer.name().contains("loop") && workload.shapes.len() > 100;
            if is_hopeless || round > 0 && best.0 > SLOW {
                continue;
            }
            let time = run(&**peer, set.query, &set.rays, &mut answers, &mut flags);
            best.0 = best.0.min(time);
            best.1 = match set.query {
                Query::Nearest => answers.iter().filter(|it| it.object != u32::MAX).count(),
                Query::Any => flags.iter().filter(|&&it| it).count(),
            };
        }
    }
    best
}

fn rays(report: &mut Report, rounds: usize, quick: bool) {
    let mut rows = Vec::new();
    let mut summary = Vec::new();
    let mut memory = Vec::new();
    for workload in workloads(quick) {
        let bytes = Wide::new(workload.shapes.kinds()).bytes();
        let [nodes, blocks] = bytes.map(|it| it as f64 / workload.shapes.len() as f64);
        memory.push(vec![
            workload.name.clone(),
            format!("{nodes:.1}"),
            format!("{blocks:.1}"),
        ]);
        let peers: Vec<_> = PEERS
            .iter()
            .filter_map(|build| build(&workload.shapes).ok())
            .collect();
        eprintln!("{}", workload.name);
        for set in &workload.rays {
            let best = measure(&peers, &workload, set, rounds);
            let scene = format!("{}, {}", workload.name, set.name);
            let ours = best[0].0.min(best[1].0);
            let (mut embree, mut other) = (f64::NAN, (f64::INFINITY, String::new()));
            for (peer, &(time, hits)) in peers.iter().zip(&best) {
                let name = peer.name();
                if time == f64::INFINITY {
                    continue;
                }
                let miss = (hits as f64 - best[0].1 as f64).abs() / set.rays.len() as f64;
                rows.push(vec![
                    scene.clone(),
                    name.clone(),
                    ratio(time / best[0].0),
                    ratio(time / best[1].0),
                    format!("{:.3} %", 100.0 * miss),
                ]);
                let is_embree_single =
                    name.starts_with("Embree") && !name.contains(',') && embree.is_nan();
                if is_embree_single {
                    embree = time;
                } else if !name.starts_with("whitted") && time < other.0 {
                    other = (time, name);
                }
            }
            summary.push(vec![
                scene,
                ratio(embree / best[0].0),
                ratio(embree / ours),
                ratio(other.0 / best[0].0),
                ratio(other.0 / ours),
                other.1,
            ]);
        }
    }
    let head = [
        "rays",
        "Embree's single rays / ours one by one",
        "/ our better way",
        "best other peer / ours one by one",
        "/ our better way",
        "that peer",
    ];
    report.table(
        "Rays: normal and material included, one thread",
        &head,
        &summary,
    );
    report.note(
        "Ours together: all rays of a set in one call, which puts them in order where that helps, in the time \
         that is measured, and casts as many at once as a vector has lanes. All others get them as they come.",
    );
    let head = [
        "rays",
        "who",
        "/ whitted, one by one",
        "/ together",
        "rays that differ",
    ];
    report.table("Rays: everybody", &head, &rows);
    report.table(
        "Memory of whitted's hierarchy, beside the objects themselves",
        &["scene", "bytes an object: nodes", "blocks"],
        &memory,
    );
}

fn main() -> anyhow::Result<()> {
    let arguments: Vec<_> = std::env::args().collect();
    if arguments.get(1).is_some_and(|it| it == frames::AS_WHITTED) {
        let arguments = whitted_cli::args::Arguments::parse_from(&arguments[1..]);
        whitted_cli::commands::run(&arguments.command)?;
        return Ok(());
    }
    let has = |name: &str| arguments.iter().any(|it| it == name);
    let quick = has("--quick");
    let only =
        |name: &str| !["--rays", "--growth", "--frames"].iter().any(|it| has(it)) || has(name);
    let rounds = if quick { 5 } else { 7 };
    let mut report = Report::default();
    let threads = std::thread::available_parallelism().map_or(0, usize::from);
    report.note(&format!(
        "How many times as long as whitted others take; {rounds} interleaved rounds, the least of each. \
         {}, {threads} processors, {}.",
        processor(),
        instructions(),
    ));
    if only("--rays") {
        rays(&mut report, rounds, quick);
    }
    if only("--frames") {
        frames::run(&mut report, rounds, quick)?;
    }
    if only("--growth") {
        growth::run_all(&mut report, rounds.min(5), quick)?;
    }
    std::fs::write(
        chart("bench.md"),
        format!("# Beside other ray tracers\n\n{}", report.0),
    )?;
    Ok(())
}

fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text
        .lines()
        .find_map(|line| line.strip_prefix("model name"));
    name.map_or("unknown processor".into(), |it| {
        it.trim_start_matches([':', ' ', '\t']).into()
    })
}

fn instructions() -> String {
    let levels = whitted_cli::wide::levels();
    levels.last().map_or(String::new(), |it| it.0.to_owned())
}
