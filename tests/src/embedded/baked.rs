//! Scenes for `whitted bake`: those of the firmware's `src/baked.rs`.

use std::convert::Infallible;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use glam::Vec3;
use whitted_cli::bake::{Layout, bake_with};
use whitted_cli::render::{Settings, keep, render_whole as render};
use whitted_cli::scene::{HostScene, Pool};
use whitted_cli::scene_file::{self, SceneFile};

use super::expected::Expected;

/// Scene files of a size that suits them, by name.
pub type Scenes = Vec<(String, SceneFile, [u32; 2])>;

/// Scenes of more objects are drawn small.
const MANY: usize = 50;

fn size(file: &SceneFile) -> [u32; 2] {
    if file.objects.len() > MANY {
        [32, 24]
    } else {
        [64, 48]
    }
}

fn with_size((name, file): (&str, SceneFile)) -> (String, SceneFile, [u32; 2]) {
    let size = size(&file);
    (name.to_owned(), file, size)
}

/// Our own.
///
/// # Errors
///
/// Where one is wrong.
pub fn own() -> Result<Scenes> {
    let builtin = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host-cli/scenes/builtin.toml");
    let builtin = ("builtin", scene_file::read(&builtin)?);
    let written = [
        ("ball", BALL.to_owned()),
        ("pyramid", pyramid()),
        ("gear", gear()),
        ("grove", grove()),
        ("hills", hills()),
    ];
    let written = written.map(|(name, text)| {
        let file = scene_file::toml::parse(Path::new(name), &text);
        file.map(|file| with_size((name, file))).context(name)
    });
    written
        .into_iter()
        .chain([Ok(with_size(builtin))])
        .collect()
}

/// Of the Standard Procedural Databases; none where they are not beside the project.
///
/// # Errors
///
/// Where one cannot be read.
pub fn standard(names: &[&'static str]) -> Result<Option<Scenes>> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/scenes/spd");
    if !directory.exists() {
        return Ok(None);
    }
    let read = |&name: &&'static str| {
        let file = scene_file::read(&directory.join(format!("{name}.nff")))?;
        Ok(with_size((name, file)))
    };
    names.iter().map(read).collect::<Result<_>>().map(Some)
}

/// Those that the firmware has a program for.
pub const STANDARD: [&str; 6] = [
    "balls-2", "gears-1", "mount-2", "rings-1", "teapot-2", "tree-4",
];

/// Bakes scenes into a directory, and tells what their pictures are.
///
/// # Errors
///
/// Where a scene cannot be built or a file not be written.
pub fn write(scenes: &Scenes, directory: &Path) -> Result<Vec<(String, Expected)>> {
    write_with(scenes, directory, Layout::Fastest)
}

/// [`write()`] with a layout of choice.
///
/// # Errors
///
/// As [`write()`].
pub fn write_with(
    scenes: &Scenes,
    directory: &Path,
    layout: Layout,
) -> Result<Vec<(String, Expected)>> {
    fs::create_dir_all(directory)?;
    let all = scenes.iter().map(|(name, file, [width, height])| {
        let pool = Pool::new(file);
        let scene = HostScene::new(file, &pool)?;
        let view = scene.camera(*width, *height)?;
        let view = view.with_context(|| format!("{name} has no camera"))?;
        let path: PathBuf = directory.join(format!("{name}.rs"));
        write_changed(&path, &bake_with(&scene, Some(&view), layout).text)?;
        let settings = Settings {
            depth: file.depth,
            threshold: 0.0,
        };
        let mut pixels: Vec<Vec3> = Vec::new();
        let add = |row: &[Vec3]| {
            pixels.extend(row);
            Ok::<_, Infallible>(())
        };
        let Ok(counters) = render(&scene, &view, 0..*height, settings, keep, add);
        Ok((name.clone(), Expected::of_pixels(&pixels, counters)))
    });
    all.collect()
}

/// Writes a file where it is not there or another, so that only what changed is built again.
///
/// # Errors
///
/// Where it cannot be written.
pub fn write_changed(path: &Path, text: &str) -> Result<()> {
    if !fs::read_to_string(path).is_ok_and(|known| known == text) {
        fs::write(path, text)?;
    }
    Ok(())
}

const CAMERA: &str = "[camera]\neye = [2, 2.5, 6]\ntarget = [0, 0.75, 0]\nfov = 40\n\
                      [[light]]\nposition = [3, 5, 4]\ncolor = [0.9, 0.8, 0.7]\n";

/// One matte ball.
const BALL: &str = "[camera]\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nfov = 40\n\
                    [[light]]\nposition = [3, 5, 4]\nshadows = false\n\
                    [material.clay]\ncolor = [0.8, 0.3, 0.2]\n\
                    [[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = 'clay'\n";

/// Mirroring balls upon each other, and a polygon: as in balls-2.
fn pyramid() -> String {
    let mut text = format!(
        "depth = 4\nbackground = [0.1, 0.2, 0.3]\n{CAMERA}\
         [material.brass]\ncolor = [0.9, 0.7, 0.5]\ndiffuse = 0.5\nspecular = 0.5\n\
         shininess = 3.0827\nreflectance = 0.5\n\
         [material.sand]\ncolor = [0.7, 0.6, 0.4]\n\
         [[polygon]]\nmaterial = 'sand'\n\
         vertices = [[-4, 0, 4], [4, 0, 4], [4, 0, -4], [-4, 0, -4]]\n"
    );
    for layer in 0..5 {
        let side = 5 - layer;
        for i in 0..side * side {
            let place = |i: i32| 0.4 * (f64::from(i) - 0.5 * f64::from(side - 1));
            let (x, z) = (place(i % side), place(i / side));
            let y = 0.2 + 0.28 * f64::from(layer);
            let _ = writeln!(
                text,
                "[[sphere]]\ncenter = [{x}, {y}, {z}]\nradius = 0.2\nmaterial = 'brass'"
            );
        }
    }
    text
}

/// A wheel of glass with teeth, in which light is reflected totally, between concave polygons: as in
/// gears-1.
fn gear() -> String {
    let mut text = format!(
        "depth = 6\nbackground = [0.3, 0.3, 0.4]\nambient = [0.2, 0.2, 0.2]\n{CAMERA}\
         [material.glass]\ncolor = [1, 1, 1]\ndiffuse = 0.1\nspecular = 0.4\nshininess = 33.5\n\
         reflectance = 0.1\ntransmittance = 0.8\nior = 1.4\n\
         [material.chalk]\ncolor = [0.7, 0.7, 0.6]\n\
         [[plane]]\npoint = [0, -0.5, 0]\nnormal = [0, 1, 0]\nmaterial = 'chalk'\n"
    );
    const TEETH: usize = 6;
    let corners: Vec<[f64; 2]> = (0..4 * TEETH)
        .map(|i| {
            let angle = i as f64 / (4 * TEETH) as f64 * std::f64::consts::TAU;
            let radius = if i % 4 < 2 { 1.5 } else { 1.1 };
            [radius * angle.cos(), radius * angle.sin() + 1.0]
        })
        .collect();
    let outline = |corners: &mut dyn Iterator<Item = &[f64; 2]>, z: f64| {
        let points: Vec<_> = corners.map(|[x, y]| format!("[{x}, {y}, {z}]")).collect();
        points.join(", ")
    };
    let mut polygon = |vertices: &str| {
        let _ = writeln!(
            text,
            "[[polygon]]\nmaterial = 'glass'\nvertices = [{vertices}]"
        );
    };
    polygon(&outline(&mut corners.iter(), 0.25));
    polygon(&outline(&mut corners.iter().rev(), -0.25));
    for (i, from) in corners.iter().enumerate() {
        let to = corners[(i + 1) % corners.len()];
        let [near, far] = [0.25, -0.25];
        polygon(&format!(
            "{}, {}",
            outline(&mut [*from, to].iter().rev(), near),
            outline(&mut [*from, to].iter(), far)
        ));
    }
    text
}

/// Trees of cones and cylinders with balls for fruit, some of them of glass: as in tree-4 and rings-1.
fn grove() -> String {
    let mut text = format!(
        "background = [0.1, 0.2, 0.3]\nambient = [0.1, 0.1, 0.1]\n{CAMERA}\
         [[light]]\nposition = [-4, 6, 2]\ncolor = [0.4, 0.4, 0.5]\nshadows = false\n\
         [material.bark]\ncolor = [0.55, 0.4, 0.2]\n\
         [material.leaf]\ncolor = [0.2, 0.7, 0.2]\nspecular = 0.2\nshininess = 7\n\
         [material.dew]\ncolor = [1, 1, 1]\ndiffuse = 0.1\nspecular = 0.5\nshininess = 60.25\n\
         transmittance = 0.75\nior = 1.33\n\
         [[plane]]\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\nmaterial = 'bark'\n"
    );
    for i in 0..16 {
        let (x, z) = (f64::from(i % 4) * 0.8 - 1.2, f64::from(i / 4) * 0.8 - 1.2);
        let height = 0.6 + 0.1 * f64::from(i * 7 % 5);
        let (lean, fruit) = (x + 0.1, if i % 3 == 0 { "dew" } else { "leaf" });
        let _ = writeln!(
            text,
            "[[cylinder]]\nbase = [{x}, 0, {z}]\napex = [{lean}, {height}, {z}]\nradius = 0.08\n\
             material = 'bark'\n\
             [[cone]]\nbase = [{lean}, {height}, {z}]\nbase_radius = 0.35\n\
             apex = [{lean}, {top}, {z}]\nmaterial = 'leaf'\n\
             [[sphere]]\ncenter = [{x}, 0.2, {front}]\nradius = 0.15\nmaterial = '{fruit}'",
            top = height + 0.7,
            front = z + 0.3,
        );
    }
    text
}

/// Patches that join smoothly, triangles, boxes: as in teapot-2 and mount-2.
fn hills() -> String {
    let mut text = format!(
        "depth = 3\nbackground = [0.5, 0.6, 0.8]\nambient = [0.1, 0.1, 0.1]\n{CAMERA}\
         [material.grass]\ncolor = [0.3, 0.6, 0.2]\nspecular = 0.25\nshininess = 4.81884\n\
         [material.rock]\ncolor = [0.5, 0.5, 0.5]\n\
         [material.ice]\ncolor = [0.2, 0.3, 0.4]\nreflectance = 0.5\n\
         [[box]]\nmin = [-3, -0.6, -3]\nmax = [3, -0.5, 3]\nmaterial = 'ice'\n"
    );
    const SIDE: u32 = 6;
    let height = |x: f64, z: f64| (2.0 * x).sin() * (1.5 * z).cos() * 0.4 + 0.4;
    let corner = |i: u32, j: u32| {
        let at = |i: u32| 4.0 * f64::from(i) / f64::from(SIDE) - 2.0;
        let (x, z) = (at(i), at(j));
        let slope = |dx: f64, dz: f64| (height(x + dx, z + dz) - height(x - dx, z - dz)) / 2e-3;
        let (dx, dz) = (slope(1e-3, 0.0), slope(0.0, 1e-3));
        (
            format!("[{x}, {}, {z}]", height(x, z)),
            format!("[{}, 1, {}]", -dx, -dz),
        )
    };
    for (i, j) in (0..SIDE * SIDE).map(|k| (k / SIDE, k % SIDE)) {
        let [a, b, c, d] = [(0, 0), (0, 1), (1, 1), (1, 0)].map(|(di, dj)| corner(i + di, j + dj));
        let smooth = (i + j) % 4 > 0;
        for [a, b, c] in [[&a, &b, &c], [&a, &c, &d]] {
            let vertices = format!("vertices = [{}, {}, {}]", a.0, b.0, c.0);
            let normals = format!("normals = [{}, {}, {}]", a.1, b.1, c.1);
            let _ = if smooth {
                writeln!(text, "[[patch]]\nmaterial = 'grass'\n{vertices}\n{normals}")
            } else {
                writeln!(text, "[[triangle]]\nmaterial = 'rock'\n{vertices}")
            };
        }
    }
    text
}
