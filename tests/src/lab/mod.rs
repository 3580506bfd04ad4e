//! The method lab: every method of every stage over sweeps of difficulty, against exact answers.

pub mod charts;
pub mod cuboid;
pub mod cycles;
pub mod front;
pub mod frustum;
pub mod mesh;
pub mod plane;
pub mod polygon;
pub mod pricing;
pub mod random;
pub mod roots;
pub mod secondary;
pub mod special;
pub mod sphere;
pub mod sweep;
pub mod tally;
pub mod watertight;

use std::path::Path;

use serde::Serialize;
use whitted::Ray;

use crate::exact::Line;
use front::Results;
use sweep::Effort;
use tally::Row;

/// How much to measure.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// All inputs follow from it.
    pub seed: u64,
    /// Inputs a cell of a sweep.
    pub inputs: u64,
    /// Rays at the edges, and as many at the corners, of each mesh, for all methods.
    pub rays: u64,
    /// The same for the method that `whitted` uses alone.
    pub our_rays: u64,
}

impl Plan {
    /// Under two minutes on two cores.
    pub const QUICK: Self = Self {
        seed: 1,
        inputs: 20_000,
        rays: 20_000,
        our_rays: 1_000_000,
    };

    /// A million inputs a cell, and 10^9 rays at edges and corners.
    pub const FULL: Self = Self {
        seed: 2,
        inputs: 1_000_000,
        rays: 1_000_000,
        our_rays: 83_400_000,
    };
}

/// Measures the stages that `wanted` names; `progress` hears of each sweep as it starts.
pub fn measure(
    plan: Plan,
    wanted: impl Fn(&str) -> bool,
    progress: &(impl Fn(&str, &str) + Sync),
) -> Results {
    fn stage<S: sweep::Stage>(
        rows: &mut Vec<Row>,
        plan: Plan,
        wanted: &impl Fn(&str) -> bool,
        progress: &(impl Fn(&str, &str) + Sync),
    ) {
        if wanted(S::NAME) {
            let effort = Effort {
                seed: plan.seed,
                n: plan.inputs,
            };
            rows.extend(sweep::run::<S>(effort, progress));
        }
    }
    let mut rows = Vec::new();
    stage::<sphere::Spheres>(&mut rows, plan, &wanted, progress);
    stage::<plane::Planes>(&mut rows, plan, &wanted, progress);
    stage::<polygon::Triangles>(&mut rows, plan, &wanted, progress);
    stage::<polygon::Polygons>(&mut rows, plan, &wanted, progress);
    stage::<cuboid::Cuboids>(&mut rows, plan, &wanted, progress);
    stage::<frustum::Frusta>(&mut rows, plan, &wanted, progress);
    stage::<secondary::Secondary>(&mut rows, plan, &wanted, progress);
    stage::<roots::Sqrt>(&mut rows, plan, &wanted, progress);
    stage::<roots::Rsqrt>(&mut rows, plan, &wanted, progress);
    stage::<roots::Normalize>(&mut rows, plan, &wanted, progress);
    stage::<roots::WholePower>(&mut rows, plan, &wanted, progress);
    stage::<roots::RealPower>(&mut rows, plan, &wanted, progress);
    let mut leaks = Vec::new();
    if wanted("watertight") {
        let ours = |method: &str| method == "core";
        leaks = watertight::run(plan.seed, plan.our_rays, ours, progress);
        leaks.extend(watertight::run(
            plan.seed,
            plan.rays,
            |method| !ours(method),
            progress,
        ));
    }
    Results {
        rows,
        special: special::run(),
        leaks,
        prices: Vec::new(),
    }
}

/// A line of `worst.csv`: all cells of a stage in one.
#[derive(Serialize)]
struct Worst {
    stage: String,
    method: String,
    inputs: u64,
    backward: f64,
    wrong: u64,
    beyond: u64,
    band: f64,
}

/// Writes what was measured into a folder.
///
/// # Errors
///
/// Where a file cannot be written.
pub fn write(results: &Results, folder: &Path) -> Result<(), csv::Error> {
    table(&folder.join("sweeps.csv"), &results.rows)?;
    table(&folder.join("special.csv"), &results.special)?;
    table(&folder.join("watertight.csv"), &results.leaks)?;
    let mut worst: Vec<Worst> = Vec::new();
    for row in results
        .rows
        .iter()
        .filter(|row| !row.sweep.ends_with("extreme"))
    {
        let is = |one: &&mut Worst| one.stage == row.stage && one.method == row.method;
        let Some(one) = worst.iter_mut().find(is) else {
            worst.push(Worst {
                stage: row.stage.clone(),
                method: row.method.clone(),
                inputs: row.n,
                backward: row.backward,
                wrong: row.wrong,
                beyond: row.beyond,
                band: row.band,
            });
            continue;
        };
        one.inputs += row.n;
        one.backward = one.backward.max(row.backward);
        one.wrong += row.wrong;
        one.beyond += row.beyond;
        one.band = one.band.max(row.band);
    }
    table(&folder.join("worst.csv"), &worst)
}

/// Writes lines into a file, with a heading.
///
/// # Errors
///
/// Where it cannot be written.
pub fn table(path: &Path, lines: &[impl Serialize]) -> Result<(), csv::Error> {
    let mut writer = csv::Writer::from_path(path)?;
    for line in lines {
        writer.serialize(line)?;
    }
    Ok(writer.flush()?)
}

/// A ray as the oracle takes it.
fn line(ray: &Ray) -> Line {
    Line {
        origin: ray.origin.to_array(),
        direction: ray.direction.to_array(),
    }
}
