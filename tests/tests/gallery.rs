//! Scenes that show what there is, by the renderer, by the oracle and by POV-Ray.

use std::convert::Infallible;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::Command;

use glam::Vec3;
use whitted::picture::to_rgb8;
use whitted_cli::picture::{Picture, Transfer};
use whitted_cli::render::{Sampling, Settings, encode, render_sampled};
use whitted_cli::scene::{HostScene, Pool};
use whitted_cli::scene_file::{SceneFile, Shape, read};
use whitted_tests::comparison::{differences, render, render_fast};

#[path = "../bench/src/pov.rs"]
mod pov;

/// Every scene; the most pixels in which the renderer and the oracle may differ by more than a step of
/// 255, all explained by rounding; and the least share of channels, in percent, that must lie within a
/// step of POV-Ray's.
const SCENES: [(&str, usize, f64); 9] = [
    ("quadrics", 10, 99.8),
    ("tori", 10, 99.8),
    ("panel", 10, 99.9),
    ("globe", 10, 98.0),
    ("instances", 10, 99.8),
    ("solids", 10, 99.8),
    ("patterns", 20, 99.9),
    ("tinted", 20, 98.4),
    ("images", 200, 99.8),
];

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

/// What POV-Ray draws, without anti-aliasing; nothing where it is not installed.
fn pov_ray(name: &str, file: &SceneFile, width: u32, height: u32) -> Option<Picture> {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let path = |extension| folder.join(format!("{name}-{width}.{extension}"));
    let (source, picture) = (path("pov"), path("ppm"));
    pov::write(file, &source).unwrap();
    let mut command = Command::new("povray");
    command.arg(format!("+I{}", source.display()));
    command.arg(format!("+O{}", picture.display()));
    command.args(["+FP", "File_Gamma=1.0", "-A", "-D", "-GA"]);
    command.args([format!("+W{width}"), format!("+H{height}")]);
    let Ok(output) = command.output() else {
        // Not printed: the harness keeps what passing tests print.
        let _ = writeln!(io::stderr(), "NOT RUN: {name}, for there is no povray");
        return None;
    };
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    Some(Picture::read(&picture).unwrap())
}

/// Of the channels those, in percent, that are at most so far apart.
fn close(ours: &[u16], theirs: &[u16], steps: u16) -> f64 {
    let pairs = ours.iter().zip(theirs);
    let close = pairs.filter(|(a, b)| a.abs_diff(**b) <= steps).count();
    100.0 * close as f64 / ours.len() as f64
}

#[test]
fn pictures_are_those_of_pov_ray() {
    for (name, _, least) in SCENES {
        let (mut file, width, height) = scene(name);
        if name == "images" {
            // Its images lie on its tori in other ways.
            file.objects
                .retain(|it| !matches!(it.shape, Shape::Torus { .. }));
        }
        let Some(theirs) = pov_ray(name, &file, width, height) else {
            return;
        };
        let ours = rendered(&file, width, height);
        let share = close(&ours, &theirs.samples, 1);
        println!("{name}: {share:.4} % of channels are POV-Ray's");
        assert!(
            share >= least,
            "{name}: {share:.4} % of channels, not {least}"
        );
    }
}

/// Colored glass without what POV-Ray has other rules for. What glass reflects when it refracts nothing keeps
/// all light there, and here the shares of reflection and of refraction; and what lies in a medium is lit
/// there as if nothing weakened light on its way in: highlights on the far side, and a floor within.
fn without_other_rules(mut file: SceneFile) -> SceneFile {
    for it in &mut file.materials {
        if it.absorption != [0.0; 3] {
            (it.transmittance, it.specular) = (1.0, 0.0);
        }
    }
    for it in &mut file.objects {
        if let Shape::Torus { center, .. } = &mut it.shape {
            center[1] += 0.5;
        }
    }
    file
}

#[test]
fn colored_glass_is_that_of_pov_ray_where_the_rules_are_the_same() {
    let (file, width, height) = scene("tinted");
    let file = without_other_rules(file);
    let Some(theirs) = pov_ray("tinted-alike", &file, width, height) else {
        return;
    };
    let share = close(&rendered(&file, width, height), &theirs.samples, 1);
    println!("{share:.4} % of channels are POV-Ray's");
    assert!(share >= 99.95, "{share:.4} % of channels");
}

#[test]
fn smooth_pictures_are_those_of_pov_ray() {
    for name in ["quadrics", "tori"] {
        let (file, width, height) = scene(name);
        let (width, height) = (width / 2, height / 2);
        let Some(fine) = pov_ray(name, &file, 4 * width, 4 * height) else {
            return;
        };
        // 4 × 4 of its pixels make one of ours.
        let (width, height) = (width as usize, height as usize);
        let mut theirs = Vec::new();
        for place in 0..width * height {
            let (left, top) = (4 * (place % width), 4 * (place / width));
            for channel in 0..3 {
                let sample = |i: usize| (top + i / 4) * 4 * width + left + i % 4;
                let samples = (0..16).map(|i| fine.samples[3 * sample(i) + channel]);
                theirs.push((samples.sum::<u16>() + 8) / 16);
            }
        }
        for (sampling, steps, least) in [
            (Sampling::Regular(4), 1, 99.8),
            (
                Sampling::Adaptive {
                    bound: 1.0 / 32.0,
                    levels: 2,
                },
                8,
                98.0,
            ),
        ] {
            let ours = sampled(&file, width as u32, height as u32, sampling);
            let share = close(&ours, &theirs, steps);
            println!("{name}, {sampling:?}: {share:.4} % of channels within {steps} steps");
            assert!(
                share >= least,
                "{name}, {sampling:?}: {share:.4} % of channels, not {least}"
            );
        }
    }
}

/// `whitted render tests/gallery/patterns.toml --samples 4 -o tests/gallery/patterns-smooth.png` draws it.
#[test]
fn the_smooth_picture_is_the_one_that_is_shown() {
    let (file, width, height) = scene("patterns");
    let shown = Picture::read(&folder().join("patterns-smooth.png")).unwrap();
    let drawn = sampled(&file, width, height, Sampling::Regular(4));
    assert!(drawn == shown.samples);
}

/// What `whitted render` draws with anti-aliasing.
fn sampled(file: &SceneFile, width: u32, height: u32, sampling: Sampling) -> Vec<u16> {
    let pool = Pool::new(file);
    let host = HostScene::new(file, &pool).unwrap();
    let view = host.camera(width, height).unwrap().unwrap();
    let settings = Settings {
        depth: file.depth,
        threshold: 0.0,
    };
    let mut channels = Vec::new();
    let develop = |pixels: &[Vec3], bytes: &mut [[u8; 3]]| encode(pixels, bytes, Transfer::Linear);
    let emit = |bytes: &[[u8; 3]]| {
        channels.extend(bytes.as_flattened().iter().copied().map(u16::from));
        Ok::<_, Infallible>(())
    };
    let Ok(_) = render_sampled(&host, &view, 0..height, settings, sampling, develop, emit);
    channels
}
