//! Rays against error: where pixels are looked at, and where lights are.

use std::convert::Infallible;
use std::path::{Path, PathBuf};

use glam::Vec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use whitted::antialiasing::shown;
use whitted::area::{Disk, Extent, Outline, Samples};
use whitted::math::length_squared;
use whitted::picture::row;
use whitted::scene::Quantity;
use whitted::{
    AreaLight, Counters, Exact, LightSource, Math, Ray, Scene, Tracer, Vec3 as Color, View,
};
use whitted_cli::render::{Sampling, Settings, keep, render_sampled};
use whitted_cli::scene::{HostScene, Light, Pool};
use whitted_cli::scene_file::{SceneFile, read};

use super::random::{Random, Stream};
use crate::comparison::DEPTH;

/// A line of `sampling.csv`: what a way to sample takes, and how far its picture is from a converged one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sampled {
    /// What is sampled: `pixels` or `lights`.
    pub subject: String,
    /// A scene of the gallery.
    pub scene: String,
    /// How.
    pub method: String,
    /// How closely.
    pub setting: String,
    /// Of all kinds, a pixel.
    pub rays: f64,
    /// Root of the mean square over channels, in steps of 255.
    pub error: f64,
    /// The greatest of any channel, in steps.
    pub worst: f64,
}

/// A picture, and how many rays it took.
struct Drawn {
    pixels: Vec<Color>,
    rays: u64,
}

impl Drawn {
    fn held_against(&self, truth: &[Color]) -> (f64, f64, f64) {
        let (mut squares, mut worst) = (0.0, 0.0_f64);
        for (pixel, truth) in self.pixels.iter().zip(truth) {
            for off in (shown(*pixel) - *truth).to_array() {
                let off = 255.0 * f64::from(off.abs());
                squares += off * off;
                worst = worst.max(off);
            }
        }
        let count = truth.len() as f64;
        (
            self.rays as f64 / count,
            (squares / (3.0 * count)).sqrt(),
            worst,
        )
    }
}

fn all(it: &Counters) -> u64 {
    it.primary + it.reflected + it.refracted + it.shadow
}

/// A scene of the gallery, or the standard spheres.
fn scene(name: &str) -> SceneFile {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let folder = if name == "spheres" {
        "golden"
    } else {
        "gallery"
    };
    let path: &Path = &root.join(folder).join(format!("{name}.toml"));
    read(path).expect("a scene of the project")
}

/// Where a sample lies in its part of a square, from 0 to 1.
fn jitter(cell: u64, count: u32) -> Vec<[f32; 2]> {
    let mut random = Random::new(Stream {
        seed: 1,
        purpose: Stream::purpose(["sampling", "jitter"]),
        cell,
        chunk: 0,
    });
    (0..count * count)
        .map(|_| [random.unit() as f32, random.unit() as f32])
        .collect()
}

/// Both subjects, with pictures of this width.
pub fn run(width: u32, progress: &(impl Fn(&str, &str) + Sync)) -> Vec<Sampled> {
    let mut lines = Vec::new();
    for name in ["spheres", "tori"] {
        progress("sampling", name);
        lines.extend(pixels(name, width));
    }
    for name in ["panel", "globe"] {
        progress("sampling", name);
        lines.extend(lights(name, width / 2));
    }
    lines
}

/// Ways to sample pixels.
fn pixels(name: &str, width: u32) -> Vec<Sampled> {
    let file = scene(name);
    let [wide, high] = file.size.expect("a size");
    let height = width * high / wide;
    let pool = Pool::new(&file);
    let host = HostScene::new(&file, &pool).expect("a possible scene");
    let view = host.camera(width, height).expect("a possible camera");
    let view = view.expect("a camera");
    let scene = host.scene();
    let settings = Settings {
        depth: file.depth,
        threshold: 0.0,
    };
    let draw = |view: &View, sampling| {
        let mut pixels = Vec::new();
        let emit = |rows: &[Vec3]| {
            pixels.extend_from_slice(rows);
            Ok::<_, Infallible>(())
        };
        let rows = 0..view.height;
        let Ok(counters) = render_sampled(&host, view, rows, settings, sampling, keep, emit);
        let rays = all(&counters);
        Drawn { pixels, rays }
    };
    // 32 × 32 samples a pixel.
    let larger = View {
        width: 2 * width,
        height: 2 * height,
        ..view
    };
    let fine = draw(&larger, Sampling::Regular(16)).pixels;
    let truth: Vec<_> = (0..height * width)
        .map(|place| {
            let corner = 2 * (place / width) * larger.width + 2 * (place % width);
            let quarters = [0, 1, larger.width, larger.width + 1];
            quarters
                .map(|it| fine[(corner + it) as usize])
                .iter()
                .sum::<Vec3>()
                * 0.25
        })
        .collect();
    let jittered = |count: u32, once: bool| {
        let line = |y: u32| {
            let mut tracer = Tracer::<DEPTH, Exact, _>::with(Counters::default());
            tracer.depth = file.depth;
            let mut pixels = Vec::new();
            for x in 0..width {
                let cell = if once { 0 } else { 1 + y * width + x };
                let mut sum = Vec3::ZERO;
                for (place, [u, v]) in (0..).zip(jitter(cell.into(), count)) {
                    let across =
                        (x as f32 + ((place % count) as f32 + u) / count as f32) / width as f32;
                    let along =
                        (y as f32 + ((place / count) as f32 + v) / count as f32) / height as f32;
                    let camera = &view.camera;
                    let way = camera.corner + camera.right * across + camera.down * along;
                    let ray = Ray::new(camera.eye, Exact::normalize(way));
                    sum += shown(tracer.radiance(&scene, ray));
                }
                pixels.push(sum / (count * count) as f32);
            }
            (pixels, all(&tracer.counters))
        };
        together((0..height).into_par_iter().map(line).collect())
    };
    let mut lines = Vec::new();
    let mut add = |method: &str, setting: String, drawn: Drawn| {
        lines.push(Sampled::new(
            "pixels", name, method, setting, &drawn, &truth,
        ));
    };
    for count in [1, 2, 3, 4, 6, 8] {
        let setting = format!("{count} × {count}");
        add(
            "regular",
            setting.clone(),
            draw(&view, Sampling::Regular(count)),
        );
        if count <= 6 {
            add(
                "jittered everywhere",
                setting.clone(),
                jittered(count, false),
            );
            add("jittered once", setting, jittered(count, true));
        }
    }
    for (method, levels) in [("adaptive, 4 × 4", 2), ("adaptive, 16 × 16", 4)] {
        for parts in [4, 8, 16, 32, 64] {
            let bound = 1.0 / parts as f32;
            let drawn = draw(&view, Sampling::Adaptive { bound, levels });
            add(method, format!("1/{parts}"), drawn);
        }
    }
    lines
}

/// Rows, one after the other.
fn together(rows: Vec<(Vec<Color>, u64)>) -> Drawn {
    let rays = rows.iter().map(|it| it.1).sum();
    let pixels = rows.into_iter().flat_map(|it| it.0).collect();
    Drawn { pixels, rays }
}

/// How an area light is looked at.
#[derive(Clone)]
enum Look {
    /// As `whitted` does.
    Grid(Samples),
    /// At a place in each of so many parts to a side: the same for all points, or another for each.
    Jittered {
        count: u32,
        table: Option<Vec<[f32; 2]>>,
    },
}

/// An area light that is looked at in some way.
struct Looked<'a> {
    light: &'a Light,
    look: &'a Look,
}

impl LightSource for Looked<'_> {
    const IS_AREA: bool = true;

    fn position(&self) -> Vec3 {
        self.light.position
    }

    fn color(&self) -> Vec3 {
        self.light.color
    }

    fn casts_shadows(&self) -> bool {
        self.light.shadows
    }

    fn share<P: Math, V: Quantity>(
        &self,
        normal: Vec3,
        center: &Ray,
        mut passes: impl FnMut(&Ray) -> V,
    ) -> V {
        let point = Outline::Disk(Disk { radius: 0.0 });
        let extent = self.light.area.map_or(point, |it| it.0);
        let count = match self.look {
            _ if self.light.area.is_none() => return passes(center),
            Look::Jittered { count, .. } => *count,
            Look::Grid(samples) => {
                let light = AreaLight {
                    position: self.light.position,
                    color: self.light.color,
                    extent,
                    samples: *samples,
                };
                return light.share::<P, V>(normal, center, passes);
            }
        };
        let own = match self.look {
            Look::Jittered { table: Some(_), .. } => Vec::new(),
            _ => {
                let bits = center.origin.to_array().map(f32::to_bits);
                let cell = bits.iter().fold(1_u64, |sum, &it| {
                    sum.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ u64::from(it)
                });
                jitter(cell, count)
            }
        };
        let places = match self.look {
            Look::Jittered {
                table: Some(table), ..
            } => table,
            _ => &own,
        };
        let [right, up] = extent.axes(center.direction);
        let mut sum = V::default();
        for (place, [u, v]) in (0..).zip(places) {
            let at = |index: u32, part: &f32| 2.0 * (index as f32 + part) / count as f32 - 1.0;
            let [x, y] = extent.place([at(place % count, u), at(place / count, v)]);
            let way = self.light.position - center.origin + (right * x + up * y);
            if normal.dot(way) > 0.0 {
                let (distance, recip) = P::sqrt_and_recip(length_squared(&way));
                sum = sum
                    + passes(&Ray {
                        direction: way * recip,
                        t_max: distance,
                        ..*center
                    });
            }
        }
        sum * (1.0 / (count * count) as f32)
    }
}

/// Ways to sample lights.
fn lights(name: &str, width: u32) -> Vec<Sampled> {
    let file = scene(name);
    let [wide, high] = file.size.expect("a size");
    let height = width * high / wide;
    let pool = Pool::new(&file);
    let host = HostScene::new(&file, &pool).expect("a possible scene");
    let view = host.camera(width, height).expect("a possible camera");
    let view = view.expect("a camera");
    let plain = host.scene();
    let draw = |look: Look| {
        let lights: Vec<_> = plain
            .lights
            .iter()
            .map(|light| Looked { light, look: &look })
            .collect();
        let scene = Scene {
            geometry: plain.geometry,
            lights: &lights[..],
            background: plain.background,
            ambient: plain.ambient,
        };
        let line = |y: u32| {
            let mut tracer = Tracer::<DEPTH, Exact, _>::with(Counters::default());
            tracer.depth = file.depth;
            let pixels = row(&scene, &view, y, &mut tracer).collect();
            (pixels, all(&tracer.counters))
        };
        together((0..height).into_par_iter().map(line).collect())
    };
    let jittered = |count, once: bool| Look::Jittered {
        count,
        table: once.then(|| jitter(0, count)),
    };
    let truth = draw(jittered(64, true)).pixels;
    let truth: Vec<_> = truth.into_iter().map(shown).collect();
    let mut lines = Vec::new();
    let mut add = |method: &str, setting: String, look| {
        let drawn = draw(look);
        lines.push(Sampled::new(
            "lights", name, method, setting, &drawn, &truth,
        ));
    };
    for most in 0..=4 {
        let count = 1 << most;
        let setting = format!("{count} × {count}");
        add(
            "regular",
            setting.clone(),
            Look::Grid(Samples { least: most, most }),
        );
        if most > 0 {
            add(
                "jittered everywhere",
                setting.clone(),
                jittered(count, false),
            );
            add("jittered once", setting, jittered(count, true));
        }
    }
    for (method, least) in [("adaptive, from 2 × 2", 1), ("adaptive, from 4 × 4", 2)] {
        for most in least + 1..=4 {
            let setting = format!("{0} × {0}", 1 << most);
            add(method, setting, Look::Grid(Samples { least, most }));
        }
    }
    lines
}

impl Sampled {
    fn new(
        subject: &str,
        scene: &str,
        method: &str,
        setting: String,
        drawn: &Drawn,
        truth: &[Color],
    ) -> Self {
        let (rays, error, worst) = drawn.held_against(truth);
        Self {
            subject: subject.into(),
            scene: scene.into(),
            method: method.into(),
            setting,
            rays,
            error,
            worst,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The fewest rays with which a method's picture is no further from the truth than this.
    fn rays(lines: &[Sampled], method: &str, error: f64) -> f64 {
        let of = lines.iter().filter(|it| it.method.starts_with(method));
        let good = of.filter(|it| it.error <= error);
        good.map(|it| it.rays).fold(f64::INFINITY, f64::min)
    }

    fn error(lines: &[Sampled], method: &str, setting: &str) -> f64 {
        let mut of = lines.iter().filter(|it| it.method == method);
        of.find(|it| it.setting == setting).expect("measured").error
    }

    #[test]
    fn adaptive_pixels_take_fewer_rays_than_regular_ones_as_good() {
        let lines = pixels("spheres", 128);
        let regular = error(&lines, "regular", "3 × 3");
        assert!(error(&lines, "regular", "1 × 1") > 2.0 * regular);
        let (ours, theirs) = (
            rays(&lines, "adaptive", regular),
            rays(&lines, "regular", regular),
        );
        assert!(ours < 0.5 * theirs, "{ours} and {theirs} rays");
    }

    #[test]
    fn adaptive_shadows_take_fewer_rays_than_regular_ones_as_good() {
        for name in ["panel", "globe"] {
            let lines = lights(name, 32);
            let good = 2.0 * error(&lines, "regular", "8 × 8");
            assert!(error(&lines, "regular", "2 × 2") > 2.0 * good, "{name}");
            let (ours, theirs) = (
                rays(&lines, "adaptive", good),
                rays(&lines, "regular", good),
            );
            assert!(ours < 0.5 * theirs, "{name}: {ours} and {theirs} rays");
        }
    }
}
