//! The method lab: every method of every stage over sweeps of difficulty, against exact answers.

pub mod charts;
pub mod checker;
pub mod cuboid;
pub mod cycles;
pub mod frames;
pub mod front;
pub mod frustum;
pub mod grid;
pub mod instance;
pub mod light_buffer;
pub mod mesh;
pub mod plane;
pub mod polygon;
pub mod pricing;
pub mod quadric;
pub mod random;
pub mod roots;
pub mod sampling;
pub mod secondary;
pub mod solid;
pub mod special;
pub mod sphere;
pub mod sweep;
pub mod tally;
pub mod torus;
pub mod watertight;

use std::io::{self, Write};
use std::path::Path;

use serde::Serialize;
use whitted::Ray;
use whitted_cli::output::Output;

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
    /// Width of the frames in pixels; they are three quarters as high.
    pub width: u32,
}

impl Plan {
    /// Under two minutes on two cores.
    pub const QUICK: Self = Self {
        seed: 1,
        inputs: 20_000,
        rays: 20_000,
        our_rays: 1_000_000,
        width: 320,
    };

    /// 10^7 rays a primitive, and 10^9 at edges and corners: half an hour on two cores.
    pub const FULL: Self = Self {
        seed: 2,
        inputs: 250_000,
        rays: 1_000_000,
        our_rays: 83_400_000,
        width: 640,
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
    stage::<quadric::Quadrics>(&mut rows, plan, &wanted, progress);
    stage::<grid::Grids>(&mut rows, plan, &wanted, progress);
    stage::<torus::Tori>(&mut rows, plan, &wanted, progress);
    stage::<instance::Instances>(&mut rows, plan, &wanted, progress);
    stage::<solid::Solids>(&mut rows, plan, &wanted, progress);
    stage::<checker::Checkers>(&mut rows, plan, &wanted, progress);
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
        frames: match wanted("frames") {
            true => frames::run(plan.width, progress),
            false => Vec::new(),
        },
        sampling: match wanted("sampling") {
            true => sampling::run(plan.width / 2, progress),
            false => Vec::new(),
        },
        buffers: match wanted("light buffer") {
            true => light_buffer::run(progress),
            false => Vec::new(),
        },
        ..Results::default()
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
    table(&folder.join("frames.csv"), &results.frames)?;
    table(&folder.join("sampling.csv"), &results.sampling)?;
    table(&folder.join("light-buffer.csv"), &results.buffers)?;
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

/// Writes lines into a file, with a heading; all of them, or the file stays as it was.
///
/// # Errors
///
/// Where it cannot be written.
pub fn table(path: &Path, lines: &[impl Serialize]) -> Result<(), csv::Error> {
    let mut text = Vec::new();
    let mut writer = csv::Writer::from_writer(&mut text);
    for line in lines {
        writer.serialize(line)?;
    }
    writer.flush()?;
    drop(writer);
    Ok(save(path, &text)?)
}

/// Makes these the file's content at once.
///
/// # Errors
///
/// Where it cannot be written.
pub fn save(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let output = Output::create(path)?;
    output.sink()?.write_all(bytes)?;
    output.commit()
}

/// A ray as the oracle takes it.
fn line(ray: &Ray) -> Line {
    Line {
        origin: ray.origin.to_array(),
        direction: ray.direction.to_array(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAN: Plan = Plan {
        seed: 3,
        inputs: 300,
        rays: 1000,
        our_rays: 3000,
        width: 32,
    };

    fn worst(results: &Results, stage: &str, method: &str) -> (f64, f64) {
        let rows = || {
            let is = |row: &&Row| row.stage == stage && row.method == method;
            results
                .rows
                .iter()
                .filter(is)
                .filter(|row| !row.sweep.ends_with("extreme"))
        };
        assert!(rows().count() > 0, "{stage}: {method}");
        let max = |of: fn(&Row) -> f64| rows().map(of).fold(0.0, f64::max);
        (max(|row| row.backward), max(|row| row.band))
    }

    /// Few inputs, so the bounds have room; the lab's tables have the extremes of many.
    #[test]
    fn whitted_is_within_its_bounds_and_the_text_books_are_not() {
        let intersections = [
            "sphere", "plane", "triangle", "polygon", "cuboid", "frustum", "quadric",
        ];
        let results = measure(PLAN, |stage| intersections.contains(&stage), &|_, _| {});
        for stage in intersections {
            let (backward, band) = worst(&results, stage, "core");
            // A plane's distance is a quotient of two sums of three products.
            let is_quadric = ["sphere", "cuboid", "frustum", "quadric"].contains(&stage);
            let most = if is_quadric { 2.0 } else { 2.5 };
            assert!(backward <= most, "{stage}: {backward} u");
            // The horizon: the sign of three products that cancel.
            let most = if stage == "plane" { 1.5 } else { 1.0 };
            assert!(band <= most, "{stage}: wrong {band} u from the silhouette");
        }
        for (stage, method) in [
            ("sphere", "half b"),
            ("plane", "point, |n.d| > 1e-6"),
            ("polygon", "angles, acos"),
            ("cuboid", "o/d folded"),
            ("frustum", "plain"),
            ("quadric", "shift"),
        ] {
            let (backward, band) = worst(&results, stage, method);
            assert!(
                backward.max(band) > 100.0,
                "{stage}, {method}: {backward} u, {band} u"
            );
        }
    }

    #[test]
    fn tori_are_met_within_their_bounds() {
        let results = measure(PLAN, |stage| stage == "torus", &|_, _| {});
        // From 100,000 sizes away the quartic's coefficients lose what the quadrics' do not.
        let near = |row: &&Row| row.sweep != "distance" || row.x < 1e5;
        let of = |method| {
            let rows = results.rows.iter().filter(near);
            rows.filter(move |row| row.method == method)
        };
        assert!(of("core").count() > 20);
        for row in of("core") {
            assert!(row.backward <= 2.0 && row.band <= 1.0, "{row:?}");
        }
        for method in ["Ferrari", "Sturm", "Bernstein", "sphere tracing"] {
            let most = of(method).map(|row| row.backward.max(row.band));
            assert!(most.fold(0.0, f64::max) > 100.0, "{method}");
        }
    }

    #[test]
    fn what_is_placed_is_met_within_its_bounds() {
        let results = measure(PLAN, |stage| stage == "instance", &|_, _| {});
        let (backward, band) = worst(&results, "instance", "core");
        assert!(backward <= 3.0 && band <= 2.0, "{backward} u, {band} u");
        let (backward, _) = worst(&results, "instance", "quadric in the world");
        assert!(backward > 100.0, "{backward} u");
    }

    #[test]
    fn faces_that_coincide_make_no_film_and_no_specks() {
        let results = measure(
            PLAN,
            |stage| ["solid", "checker"].contains(&stage),
            &|_, _| {},
        );
        let wrong = |stage: &str, method: &str| {
            let is = |row: &&Row| row.stage == stage && row.method == method;
            let near = |row: &&Row| !row.sweep.ends_with("extreme");
            let share = |row: &Row| row.wrong as f64 / row.n as f64;
            let rows = results.rows.iter().filter(is).filter(near);
            rows.map(share).fold(0.0, f64::max)
        };
        assert_eq!(wrong("solid", "core"), 0.0);
        // Edges across surfaces that are not quite in a boundary move by 1/1024 of a cell.
        assert!(wrong("checker", "core") < 0.1);
        for method in ["intervals", "points, 1e-4 aside", "256 steps, halved"] {
            assert!(wrong("solid", method) > 0.02, "{method}");
        }
        for method in ["floor", "floor, + 1e-4"] {
            assert!(wrong("checker", method) > 0.1, "{method}");
        }
    }

    #[test]
    fn whitted_does_not_shadow_itself_leak_or_lose_digits() {
        let functions = [
            "sqrt",
            "rsqrt",
            "normalize",
            "power",
            "power, real",
            "secondary",
        ];
        let results = measure(PLAN, |stage| functions.contains(&stage), &|_, _| {});
        let bound = |stage: &str, most: f64| {
            let (error, _) = worst(&results, stage, "core");
            assert!(error <= most, "{stage}: {error}");
        };
        bound("sqrt", 1.0);
        bound("rsqrt", 1.5);
        bound("normalize", 3.0);
        bound("power", 0.01);
        bound("power, real", 0.01);
        for row in results.rows.iter().filter(|row| row.stage == "secondary") {
            // Among neighbours a ray has to be told from one that starts a rounding lower.
            let is_among_neighbours = row.sweep == "neighbour";
            let is_near = row.x <= 1.0;
            match row.method.as_str() {
                "core" if is_among_neighbours => assert!(!is_near || row.wrong <= 1, "{row:?}"),
                "core" => assert_eq!(row.wrong, 0, "{row:?}"),
                "skip, outward" if is_among_neighbours => assert_eq!(row.wrong, 0, "{row:?}"),
                _ => {}
            }
            if row.method == "nothing" && row.sweep.starts_with("acne") {
                assert!(row.wrong > row.n / 4, "{row:?}");
            }
        }
    }

    #[test]
    fn no_ray_passes_between_faces_or_meets_two() {
        let results = measure(PLAN, |stage| stage == "watertight", &|_, _| {});
        let ours = results.leaks.iter().filter(|leaks| leaks.method == "core");
        assert_eq!(ours.clone().count(), 12);
        for leaks in ours {
            assert_eq!((leaks.holes, leaks.doubles), (0, 0), "{leaks:?}");
        }
        assert!(
            results
                .leaks
                .iter()
                .any(|leaks| leaks.method == "f64 crossings" && leaks.holes > 0)
        );
    }

    #[test]
    fn threads_do_not_change_what_is_measured() {
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let sphere = || measure(PLAN, |stage| stage == "sphere", &|_, _| {});
            pool.expect("threads").install(sphere).rows
        };
        assert_eq!(run(1), run(3));
    }
}
