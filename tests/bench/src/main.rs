//! whitted beside other ray tracers, on the same rays and scenes in one process.
//!
//! Prints ratios: how many times as long as whitted the others take, one thread, each the least of
//! several interleaved rounds.

mod crates;
mod embree;
mod ours;
mod peer;
mod workload;

use std::time::Instant;

use peer::{Builder, Peer};
use workload::{Answer, Query, Workload};

const PEERS: [Builder; 13] = [
    ours::wide,
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

fn main() {
    let mut workloads = vec![
        Workload::new("8 spheres", workload::spheres(8), 256),
        Workload::new("64 spheres", workload::spheres(64), 256),
        Workload::new("16 boxes", workload::cuboids(16), 256),
        Workload::new("16 triangles", workload::triangles(16), 256),
        Workload::new("flake", workload::flake(4), 256),
        Workload::new("10k spheres", workload::spheres(10000), 256),
        Workload::new("10k triangles", workload::triangles(10000), 256),
        Workload::new("10k surface", workload::surface(10000), 256),
    ];
    let args: Vec<String> = std::env::args().skip(1).collect();
    if !args.is_empty() {
        workloads.retain(|w| args.iter().any(|a| w.name.contains(a.as_str())));
    }
    for w in &workloads {
        println!("{} ({} objects)", w.name, w.shapes.len());
        let peers: Vec<_> = PEERS.iter().filter_map(|b| b(&w.shapes).ok()).collect();
        for set in &w.rays {
            let n = set.rays.len();
            let mut answers = vec![Answer::MISS; n];
            let mut flags = vec![false; n];
            let mut best = vec![f64::INFINITY; peers.len()];
            let mut hits = vec![0; peers.len()];
            for _ in 0..9 {
                for (i, p) in peers.iter().enumerate() {
                    if p.name().contains("loop") && w.shapes.len() > 100 {
                        continue;
                    }
                    best[i] =
                        best[i].min(run(&**p, set.query, &set.rays, &mut answers, &mut flags));
                    hits[i] = match set.query {
                        Query::Nearest => answers.iter().filter(|a| a.object != u32::MAX).count(),
                        Query::Any => flags.iter().filter(|&&f| f).count(),
                    };
                }
            }
            print!("  {:11} {n}:", set.name);
            for (i, p) in peers.iter().enumerate() {
                print!(
                    " | {} {:.1} ns {:.2}x {}",
                    p.name(),
                    best[i] / n as f64 * 1e9,
                    best[i] / best[0],
                    hits[i]
                );
            }
            println!();
        }
    }
}
