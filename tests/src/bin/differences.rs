//! Lists the pixels that the renderer sees differently from the `f64` oracle by more than one step of
//! 255, and what rounding to `f32` has to do with it: for scene files on the command line, or else
//! for the standard sphere scene and those of `../shared/scenes/spd`, where that folder is there; then
//! it also writes `tests/charts/differences.csv`, a line a pixel, and `difference-counts.csv`, a line a
//! scene.

use std::error::Error;
use std::path::{Path, PathBuf};

use serde::Serialize;
use whitted_cli::scene_file::read;
use whitted_tests::comparison::{Cause, Difference, ERRORS, differences};
use whitted_tests::lab::table;

const WIDTH: u32 = 640;
const HEIGHT: u32 = 480;

/// A line of `differences.csv`.
#[derive(Serialize)]
struct Line {
    scene: String,
    x: u32,
    y: u32,
    /// Red, green and blue as rendered.
    renderer: String,
    oracle: String,
    /// What a change of so many units of roundoff explains: `silhouette`, `contact`; or `nothing`.
    cause: &'static str,
    units: Option<u32>,
}

/// A line of `difference-counts.csv`.
#[derive(Serialize)]
struct Counts {
    scene: String,
    pixels: u32,
    differing: usize,
    /// Explained by the least of the errors that are tried.
    one_unit: usize,
    /// By any.
    explained: usize,
}

impl Line {
    fn new(scene: &str, difference: &Difference) -> Self {
        let (cause, units) = match difference.cause {
            Some(Cause::Silhouette(units)) => ("silhouette", Some(units)),
            Some(Cause::Contact(units)) => ("contact", Some(units)),
            None => ("nothing", None),
        };
        let color = |rgb: [u8; 3]| rgb.map(|channel| channel.to_string()).join(" ");
        Self {
            scene: scene.into(),
            x: difference.x,
            y: difference.y,
            renderer: color(difference.renderer),
            oracle: color(difference.oracle),
            cause,
            units,
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let files: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let chosen = !files.is_empty();
    let files = if chosen { files } else { known_files() };
    println!(
        "Of {WIDTH} x {HEIGHT} pixels, those that differ by more than a step, and how many of"
    );
    println!("them an error of {ERRORS:?} units of roundoff in the eye's direction or in the");
    println!("points that are hit changes in the oracle as well.\n");
    println!("scene       differ  by 1 unit  explained");
    let (mut lines, mut counts) = (Vec::new(), Vec::new());
    for path in files {
        let file = read(&path)?;
        let scene = path.file_stem().unwrap_or_default().to_string_lossy();
        let found = differences(&file, WIDTH, HEIGHT);
        let of_scene: Vec<_> = found.iter().map(|it| Line::new(&scene, it)).collect();
        let count = |is: fn(u32) -> bool| {
            let units = of_scene.iter().filter_map(|line| line.units);
            units.filter(|&units| is(units)).count()
        };
        let count = Counts {
            scene: scene.to_string(),
            pixels: WIDTH * HEIGHT,
            differing: found.len(),
            one_unit: count(|units| units == ERRORS[0]),
            explained: count(|_| true),
        };
        let Counts {
            differing,
            one_unit,
            explained,
            ..
        } = count;
        println!("{scene:10} {differing:7} {one_unit:10} {explained:10}");
        lines.extend(of_scene);
        counts.push(count);
    }
    if !chosen {
        let charts = Path::new(env!("CARGO_MANIFEST_DIR")).join("charts");
        table(&charts.join("differences.csv"), &lines)?;
        table(&charts.join("difference-counts.csv"), &counts)?;
    }
    Ok(())
}

fn known_files() -> Vec<PathBuf> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = vec![here.join("golden/spheres.toml")];
    let Ok(folder) = here.join("../../shared/scenes/spd").read_dir() else {
        println!("only the standard sphere scene: there is no ../shared/scenes/spd");
        return files;
    };
    files.extend(folder.filter_map(|entry| Some(entry.ok()?.path())));
    files[1..].sort();
    files
}
