//! The renderer and the oracle on the same scene, pixel by pixel.

use std::convert::Infallible;
use std::f64::consts::FRAC_PI_4;

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use whitted::Tracer;
use whitted::picture::{row, to_rgb8};
use whitted_cli::render::{Settings, keep, render_whole as host_render};
use whitted_cli::scene::{HostScene, Pool};
use whitted_cli::scene_file::SceneFile;

use crate::reference::{Options, Scene, quantize};

/// The most rays on a path that [`render`] can follow.
pub const DEPTH: usize = 8;

/// What the renderer makes of a scene file: linear RGB, row by row. Panics where the file has no
/// camera or describes shapes that are none.
pub fn render(file: &SceneFile, width: u32, height: u32) -> Vec<Vec3> {
    assert!(file.depth <= DEPTH, "{} is too deep", file.path.display());
    let pool = Pool::new(file);
    let host = HostScene::new(file, &pool).expect("a possible scene");
    let view = host.camera(width, height).expect("a possible camera");
    let view = view.expect("a camera");
    let plain = host.scene();
    let scene = whitted::Scene {
        geometry: host.whole(|it| it),
        lights: plain.lights,
        background: plain.background,
        ambient: plain.ambient,
    };
    let line = |y| {
        let mut tracer = Tracer::<DEPTH>::new();
        tracer.depth = file.depth;
        row(&scene, &view, y, &mut tracer).collect::<Vec<_>>()
    };
    let rows: Vec<_> = (0..height).into_par_iter().map(line).collect();
    rows.concat()
}

/// The same bits in less time: what `whitted render` does. Panics where [`render`] does.
pub fn render_fast(file: &SceneFile, width: u32, height: u32) -> Vec<Vec3> {
    let pool = Pool::new(file);
    let host = HostScene::new(file, &pool).expect("a possible scene");
    let view = host.camera(width, height).expect("a possible camera");
    let view = view.expect("a camera");
    let settings = Settings {
        depth: file.depth,
        threshold: 0.0,
    };
    let mut pixels = Vec::new();
    let Ok::<_, Infallible>(_) = host_render(&host, &view, 0..height, settings, keep, |rows| {
        pixels.extend_from_slice(rows);
        Ok(())
    });
    pixels
}

/// How the oracle follows this file's rays.
pub fn options(file: &SceneFile) -> Options {
    Options {
        depth: file.depth as u32,
        ..Options::default()
    }
}

/// Largest difference of a channel.
pub fn steps(a: [u8; 3], b: [u8; 3]) -> u8 {
    (0..3).map(|i| a[i].abs_diff(b[i])).max().unwrap_or(0)
}

/// A pixel that the renderer and the oracle see differently, by more than one step of 255.
#[derive(Clone, Copy, Debug)]
pub struct Difference {
    /// From the left.
    pub x: u32,
    /// From the top.
    pub y: u32,
    /// As rendered.
    pub renderer: [u8; 3],
    /// As it should be.
    pub oracle: [u8; 3],
    /// Why rounding to `f32` can explain it, if it can.
    pub cause: Option<Cause>,
}

/// What rounding a number to `f32` can do to a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// The eye's ray passes within so many units of roundoff of where the picture changes: of a
    /// silhouette, an edge, a shadow's outline, seen directly or by way of curved mirrors.
    Silhouette(u32),
    /// A point that is hit lies within so many units of roundoff, by its coordinates, of another
    /// surface: where two touch or pass into each other.
    Contact(u32),
}

/// One unit of roundoff of `f32`.
const U: f64 = 1.0 / (1 << 24) as f64;

/// The errors that are tried, in units of roundoff: about that of one rounded direction or point,
/// and larger ones, since each further surface on a path adds one and curved ones magnify them.
pub const ERRORS: [u32; 4] = [1, 4, 16, 64];

/// The smallest error that changes the oracle's pixel by more than a step: of eight directions into
/// which the eye's ray is turned, or of the hit points, which are moved off and into their surfaces.
pub fn cause(scene: &Scene, direction: DVec3, options: Options) -> Option<Cause> {
    let center = quantize(scene.seen(direction, options));
    let moves = |direction, options| steps(quantize(scene.seen(direction, options)), center) > 1;
    let side = direction.any_orthonormal_vector();
    let other = direction.cross(side);
    ERRORS.into_iter().find_map(|units| {
        let error = f64::from(units) * U;
        let turned = |i: u32| {
            let (sin, cos) = (f64::from(i) * FRAC_PI_4).sin_cos();
            (direction + error * (cos * side + sin * other)).normalize()
        };
        let lifted = |lift| Options { lift, ..options };
        if (0..8).any(|i| moves(turned(i), options)) {
            Some(Cause::Silhouette(units))
        } else if [error, -error]
            .into_iter()
            .any(|lift| moves(direction, lifted(lift)))
        {
            Some(Cause::Contact(units))
        } else {
            None
        }
    })
}

/// All pixels of a scene that differ by more than one step. The oracle sees the scene that the
/// renderer sees: rounded to `f32`.
pub fn differences(file: &SceneFile, width: u32, height: u32) -> Vec<Difference> {
    let scene = Scene::from_file(&file.rounded(), width, height).expect("a camera");
    let options = options(file);
    let oracle = scene.render(width, height, options);
    let renderer = render_fast(file, width, height);
    let differing = renderer.into_iter().zip(oracle).enumerate();
    differing
        .filter_map(|(index, (renderer, oracle))| {
            let (x, y) = (index as u32 % width, index as u32 / width);
            let (renderer, oracle) = (to_rgb8(renderer), quantize(oracle));
            (steps(renderer, oracle) > 1).then(|| Difference {
                x,
                y,
                renderer,
                oracle,
                cause: cause(&scene, scene.camera().center(x, y, width, height), options),
            })
        })
        .collect()
}
