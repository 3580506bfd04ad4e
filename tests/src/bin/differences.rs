//! Lists the pixels that the renderer sees differently from the `f64` oracle by more than one step of
//! 255, and what rounding to `f32` has to do with it: for scene files on the command line, or else
//! for the standard sphere scene and those of `../shared/scenes/spd`, where that folder is there.

use std::path::{Path, PathBuf};

use whitted_cli::scene_file::read;
use whitted_tests::comparison::{Cause, Difference, ERRORS, differences};

const WIDTH: u32 = 640;
const HEIGHT: u32 = 480;

/// How many pixels of a scene are listed one by one.
const LISTED: usize = 12;

fn main() {
    let mut files: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    if files.is_empty() {
        files = known_files();
    }
    println!("Of {WIDTH} x {HEIGHT} pixels, those that differ by more than a step. In the oracle");
    println!("they change as well with an error of {ERRORS:?} units of roundoff");
    println!("in the eye's direction (silhouette) or in the points that are hit (contact).\n");
    println!("scene       differ  silhouette          contact             unexplained");
    for path in files {
        let file = match read(&path) {
            Ok(file) => file,
            Err(error) => {
                println!("{error}");
                continue;
            }
        };
        let found = differences(&file, WIDTH, HEIGHT);
        let count = |cause: Option<Cause>| found.iter().filter(|it| it.cause == cause).count();
        let silhouette = ERRORS.map(|units| count(Some(Cause::Silhouette(units))));
        let contact = ERRORS.map(|units| count(Some(Cause::Contact(units))));
        println!(
            "{:10} {:7}  {:18}  {:18}  {}",
            path.file_stem().unwrap_or_default().display(),
            found.len(),
            format!("{silhouette:?}"),
            format!("{contact:?}"),
            count(None)
        );
        for difference in found.iter().take(LISTED) {
            let Difference {
                x,
                y,
                renderer,
                oracle,
                cause,
            } = difference;
            println!("    ({x}, {y}): {renderer:?}, oracle {oracle:?}; {cause:?}");
        }
        if found.len() > LISTED {
            println!("    …");
        }
    }
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
