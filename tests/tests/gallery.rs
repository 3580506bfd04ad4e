//! Scenes that show what there is, by the renderer, by the oracle and by POV-Ray.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::Command;

use whitted::picture::to_rgb8;
use whitted_cli::picture::Picture;
use whitted_cli::scene_file::{SceneFile, read};
use whitted_tests::comparison::{differences, render, render_fast};

#[path = "../bench/src/pov.rs"]
mod pov;

/// Every scene; the most pixels in which the renderer and the oracle may differ by more than a step of
/// 255, all explained by rounding; and the least share of channels, in percent, that must lie within a
/// step of POV-Ray's.
const SCENES: [(&str, usize, f64); 2] = [("quadrics", 10, 99.8), ("tori", 10, 99.8)];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("gallery")
}

fn scene(name: &str) -> (SceneFile, u32, u32) {
    let file = read(&folder().join(format!("{name}.toml"))).unwrap();
    let [width, height] = file.size.unwrap();
    (file, width, height)
}

fn rendered(file: &SceneFile, width: u32, height: u32) -> Vec<u16> {
    let pixels = render(file, width, height);
    let is_same = pixels == render_fast(file, width, height);
    assert!(is_same, "the host's hierarchy changes bits");
    pixels
        .into_iter()
        .flat_map(to_rgb8)
        .map(u16::from)
        .collect()
}

#[test]
fn pictures_are_those_that_are_shown() {
    for (name, ..) in SCENES {
        let (file, width, height) = scene(name);
        let shown = Picture::read(&folder().join(format!("{name}.png"))).unwrap();
        assert_eq!(
            (shown.width, shown.height),
            (width as usize, height as usize)
        );
        // `whitted render tests/gallery/NAME.toml -o tests/gallery/NAME.png` draws it.
        let drawn = rendered(&file, width, height);
        let off = drawn
            .iter()
            .zip(&shown.samples)
            .filter(|(a, b)| a != b)
            .count();
        assert_eq!(off, 0, "{name}: channels that differ");
    }
}

#[test]
fn pictures_are_those_of_the_oracle() {
    for (name, most, _) in SCENES {
        let (file, width, height) = scene(name);
        let found = differences(&file, width, height);
        for pixel in found.iter().filter(|pixel| pixel.cause.is_none()) {
            println!("{name}: {pixel:?} is not explained by rounding");
        }
        assert!(found.len() <= most, "{name}: {} pixels differ", found.len());
        for pixel in found {
            assert!(
                pixel.cause.is_some(),
                "{name}: {pixel:?} is not explained by rounding"
            );
        }
    }
}

#[test]
fn pictures_are_those_of_pov_ray() {
    for (name, _, least) in SCENES {
        let (file, width, height) = scene(name);
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
        let (source, picture) = (folder.join("scene.pov"), folder.join("scene.ppm"));
        std::fs::write(&source, pov::write(&file).unwrap()).unwrap();
        let mut command = Command::new("povray");
        command.arg(format!("+I{}", source.display()));
        command.arg(format!("+O{}", picture.display()));
        command.args(["+FP", "File_Gamma=1.0", "-A", "-D", "-GA"]);
        command.args([format!("+W{width}"), format!("+H{height}")]);
        let Ok(output) = command.output() else {
            // Not printed: the harness keeps what passing tests print.
            let _ = writeln!(io::stderr(), "NOT RUN: {name}, for there is no povray");
            return;
        };
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        let theirs = Picture::read(&picture).unwrap();
        let ours = rendered(&file, width, height);
        let close = ours
            .iter()
            .zip(&theirs.samples)
            .filter(|(a, b)| a.abs_diff(**b) <= 1);
        let share = 100.0 * close.count() as f64 / ours.len() as f64;
        println!("{name}: {share:.4} % of channels are POV-Ray's");
        assert!(
            share >= least,
            "{name}: {share:.4} % of channels, not {least}"
        );
    }
}
