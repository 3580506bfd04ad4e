//! Whole pictures, on all cores.

use std::ops::Range;

use fearless_simd::Level;
use glam::Vec3;
use rayon::prelude::*;
use whitted::antialiasing::{Adaptive, magnified, share, shown};
use whitted::picture::{quantize, to_rgb8};
use whitted::{Counters, Exact, Geometry, Object, Scene, Tracer, View};

use crate::picture::Transfer;
use crate::scene::{AnyScene, HostScene, Light, Material, is_simple};
use crate::scene_file::limits;
use crate::wide::Wide;
use crate::wide::lockstep::{self, HEIGHT, Job};

/// How far rays are followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Longest chain of rays, the eye ray counted as 1; at most [`limits::DEPTH`].
    pub depth: usize,
    /// As [`whitted::Tracer::threshold`].
    pub threshold: f32,
}

/// Where a pixel is looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Sampling {
    /// In its middle.
    #[default]
    Middle,
    /// At so many places to a side, as [`whitted::antialiasing::supersampled_row`] does.
    Regular(u32),
    /// As [`Adaptive`] does.
    Adaptive {
        /// By how much channels may differ.
        bound: f32,
        /// How often squares are halved: from 1 to 4.
        levels: u32,
    },
}

/// Most pixels that are held at a time.
const BATCH: usize = 1 << 20;

/// Renders rows of a picture, some whole rows at a time: `develop` makes of them, as linear RGB, what is to
/// be kept of each pixel, on any thread, in any order; and `emit` is given that, in the picture's order.
///
/// Every pixel is computed alone: neither the number of threads nor the choice of rows changes a bit.
///
/// # Errors
///
/// What `emit` returns; nothing is rendered after that.
pub fn render<P: Clone + Default + Send, E>(
    scene: &AnyScene<'_>,
    view: &View,
    rows: Range<u32>,
    settings: Settings,
    develop: impl Fn(&[Vec3], &mut [P]) + Sync,
    emit: impl FnMut(&[P]) -> Result<(), E>,
) -> Result<Counters, E> {
    render_at(Level::new(), scene, view, rows, settings, develop, emit)
}

/// For [`render`]: keeps pixels as they are.
pub fn keep(pixels: &[Vec3], kept: &mut [Vec3]) {
    kept.copy_from_slice(pixels);
}

/// As [`render`], with the pixels sampled in some way.
///
/// # Errors
///
/// As [`render`]'s.
pub fn render_sampled<P: Clone + Default + Send, E>(
    host: &HostScene<'_>,
    view: &View,
    rows: Range<u32>,
    settings: Settings,
    sampling: Sampling,
    develop: impl Fn(&[Vec3], &mut [P]) + Sync,
    emit: impl FnMut(&[P]) -> Result<(), E>,
) -> Result<Counters, E> {
    match sampling {
        Sampling::Middle => render_whole(host, view, rows, settings, develop, emit),
        Sampling::Regular(samples) => {
            supersample(view, rows, samples, develop, emit, |fine, rows, add| {
                render_whole(host, fine, rows, settings, keep, add)
            })
        }
        Sampling::Adaptive { bound, levels } => {
            let geometry = host.whole(Wide::new);
            let scene = host.scene();
            let scene = over(&geometry, &scene);
            adaptive(&scene, view, rows, settings, (bound, levels), develop, emit)
        }
    }
}

/// As [`render_sampled`], any scene, ray by ray.
///
/// # Errors
///
/// As [`render`]'s.
pub fn trace_sampled<G, P, E>(
    scene: &Scene<'_, G, Light>,
    view: &View,
    rows: Range<u32>,
    settings: Settings,
    sampling: Sampling,
    develop: impl Fn(&[Vec3], &mut [P]) + Sync,
    emit: impl FnMut(&[P]) -> Result<(), E>,
) -> Result<Counters, E>
where
    G: Geometry<Material = Material> + Sync,
    P: Clone + Default + Send,
{
    match sampling {
        Sampling::Middle => {
            let lone_rays =
                |tile, pixels: &mut [Vec3]| trace_tile(scene, view, tile, settings, pixels);
            tiles(view, rows, LONE, lone_rays, develop, emit)
        }
        Sampling::Regular(samples) => {
            supersample(view, rows, samples, develop, emit, |fine, rows, add| {
                let lone_rays =
                    |tile, pixels: &mut [Vec3]| trace_tile(scene, fine, tile, settings, pixels);
                tiles(fine, rows, LONE, lone_rays, keep, add)
            })
        }
        Sampling::Adaptive { bound, levels } => {
            adaptive(scene, view, rows, settings, (bound, levels), develop, emit)
        }
    }
}

/// Has `render` make rows of a larger picture, and adds its pixels up as
/// [`whitted::antialiasing::supersampled_row`] does.
pub(crate) fn supersample<P: Clone + Default, E, R>(
    view: &View,
    rows: Range<u32>,
    samples: u32,
    develop: impl Fn(&[Vec3], &mut [P]),
    mut emit: impl FnMut(&[P]) -> Result<(), E>,
    render: impl FnOnce(&View, Range<u32>, &mut dyn FnMut(&[Vec3]) -> Result<(), E>) -> Result<R, E>,
) -> Result<R, E> {
    let fine = magnified(view, samples);
    let samples = fine.width / view.width;
    let mut sums = vec![Vec3::ZERO; view.width as usize];
    let mut developed = vec![P::default(); sums.len()];
    let mut added = 0;
    let mut add = |radiances: &[Vec3]| {
        for line in radiances.chunks_exact(fine.width as usize) {
            for (sum, radiances) in sums.iter_mut().zip(line.chunks_exact(samples as usize)) {
                for &radiance in radiances {
                    *sum += shown(radiance);
                }
            }
            added += 1;
            if added == samples {
                sums.iter_mut().for_each(|sum| *sum *= share(samples));
                develop(&sums, &mut developed);
                emit(&developed)?;
                sums.fill(Vec3::ZERO);
                added = 0;
            }
        }
        Ok(())
    };
    let fine_rows = rows.start * samples..rows.end * samples;
    render(&fine, fine_rows, &mut add)
}

/// A picture with adaptive anti-aliasing.
fn adaptive<G, P, E>(
    scene: &Scene<'_, G, Light>,
    view: &View,
    rows: Range<u32>,
    settings: Settings,
    (bound, levels): (f32, u32),
    develop: impl Fn(&[Vec3], &mut [P]) + Sync,
    emit: impl FnMut(&[P]) -> Result<(), E>,
) -> Result<Counters, E>
where
    G: Geometry<Material = Material> + Sync,
    P: Clone + Default + Send,
{
    let whole_rows = |tile: Tile, pixels: &mut [Vec3]| {
        let adaptive_rows = match levels {
            ..=1 => adaptive_rows::<_, 3>,
            2 => adaptive_rows::<_, 5>,
            3 => adaptive_rows::<_, 9>,
            4.. => adaptive_rows::<_, 17>,
        };
        adaptive_rows(scene, view, tile.rows, settings, bound, pixels)
    };
    // Only the rays of a band's upper edge are traced twice.
    let bands = Sizes {
        width: view.width,
        rows: 16,
        most: 16,
    };
    tiles(view, rows, bands, whole_rows, develop, emit)
}

/// Rows with adaptive anti-aliasing.
fn adaptive_rows<G: Geometry<Material = Material>, const N: usize>(
    scene: &Scene<'_, G, Light>,
    view: &View,
    rows: Range<u32>,
    settings: Settings,
    bound: f32,
    pixels: &mut [Vec3],
) -> Counters {
    let mut shared = vec![Vec3::ZERO; view.width as usize * (N - 1) + 1];
    let tracer = tracer(settings);
    let mut adaptive = Adaptive::<_, _, _, _, _, N>::new(scene, *view, tracer, bound, &mut shared);
    for (row, pixels) in rows.zip(pixels.chunks_exact_mut(view.width as usize)) {
        for (pixel, radiance) in pixels.iter_mut().zip(adaptive.row(row)) {
            *pixel = radiance;
        }
    }
    adaptive.tracer.counters
}

/// As [`render`], by instructions of choice: no bit depends on them.
///
/// # Errors
///
/// As [`render`]'s.
pub fn render_at<P: Clone + Default + Send, E>(
    level: Level,
    scene: &AnyScene<'_>,
    view: &View,
    rows: Range<u32>,
    settings: Settings,
    develop: impl Fn(&[Vec3], &mut [P]) + Sync,
    emit: impl FnMut(&[P]) -> Result<(), E>,
) -> Result<Counters, E> {
    let geometry = Wide::with_level(scene.geometry, level);
    if needs_tracer(scene) {
        let scene = over(&geometry, scene);
        let lone_rays =
            |tile, pixels: &mut [Vec3]| trace_tile(&scene, view, tile, settings, pixels);
        return tiles(view, rows, LONE, lone_rays, develop, emit);
    }
    let job = Job {
        geometry: &geometry,
        lights: scene.lights,
        background: scene.background,
        ambient: scene.ambient,
        depth: settings.depth.min(limits::DEPTH),
        threshold: settings.threshold,
    };
    let in_lockstep = |Tile { rows, columns }: Tile, pixels: &mut [Vec3]| {
        lockstep::tile(&job, view, rows, columns, pixels)
    };
    tiles(view, rows, IN_GROUPS, in_lockstep, develop, emit)
}

/// As [`render`], of all of a scene, with solids and what is placed.
///
/// # Errors
///
/// As [`render`]'s.
pub fn render_whole<P: Clone + Default + Send, E>(
    host: &HostScene<'_>,
    view: &View,
    rows: Range<u32>,
    settings: Settings,
    develop: impl Fn(&[Vec3], &mut [P]) + Sync,
    emit: impl FnMut(&[P]) -> Result<(), E>,
) -> Result<Counters, E> {
    let scene = host.scene();
    if host.is_plain() {
        return render(&scene, view, rows, settings, develop, emit);
    }
    let whole = host.whole(Wide::new);
    let scene = over(&whole, &scene);
    let lone_rays = |tile, pixels: &mut [Vec3]| trace_tile(&scene, view, tile, settings, pixels);
    tiles(view, rows, LONE, lone_rays, develop, emit)
}

/// Whether the scene has something that only [`Tracer`] does.
fn needs_tracer(scene: &AnyScene<'_>) -> bool {
    fn all_simple<S>(objects: &[Object<'_, S, Material>]) -> bool {
        objects.iter().all(|it| is_simple(it.material))
    }
    let (spheres, (planes, (polygons, (triangles, (patches, (cuboids, curved)))))) = scene.geometry;
    let (frusta, (quadrics, tori)) = curved;
    let flat = all_simple(planes) && all_simple(polygons) && all_simple(triangles);
    let round = all_simple(spheres) && all_simple(quadrics) && all_simple(tori);
    let others = all_simple(patches) && all_simple(cuboids) && all_simple(frusta);
    let is_soft = scene.lights.iter().any(|it| it.area.is_some());
    is_soft || !(flat && round && others)
}

/// Renders a tile as [`lockstep::tile`] does, with the same bits, by [`Tracer`] itself: each ray alone.
fn trace_tile<G: Geometry<Material = Material>>(
    scene: &Scene<'_, G, Light>,
    view: &View,
    Tile { rows, columns }: Tile,
    settings: Settings,
    pixels: &mut [Vec3],
) -> Counters {
    let mut tracer = tracer(settings);
    let (left, width) = (columns.start as usize, columns.len());
    let rays = rows.flat_map(|row| view.rays(row).skip(left).take(width));
    for (pixel, ray) in pixels.iter_mut().zip(rays) {
        *pixel = tracer.radiance(scene, ray);
    }
    tracer.counters
}

/// The scene with its objects in hierarchies.
fn over<'a, G>(geometry: &'a G, scene: &AnyScene<'a>) -> Scene<'a, &'a G, Light> {
    Scene {
        geometry,
        lights: scene.lights,
        background: scene.background,
        ambient: scene.ambient,
    }
}

fn tracer(settings: Settings) -> Tracer<{ limits::DEPTH }, Exact, Counters> {
    let mut tracer = Tracer::with(Counters::default());
    tracer.depth = settings.depth;
    tracer.threshold = settings.threshold;
    tracer
}

/// Some rows and columns of a picture.
#[derive(Clone)]
struct Tile {
    rows: Range<u32>,
    columns: Range<u32>,
}

/// How large tiles are.
#[derive(Clone, Copy)]
struct Sizes {
    /// Of all but those at the right edge.
    width: u32,
    /// Heights are whole multiples of this, but for the last.
    rows: u32,
    /// The greatest height.
    most: u32,
}

/// How wide tiles of either sort are.
const WIDTH: u32 = 128;

/// Where each ray is traced alone.
const LONE: Sizes = Sizes {
    width: WIDTH,
    rows: 1,
    most: 1,
};

/// Where they are traced in groups. Rays that part are gathered from all of a tile: of 16 to 512 rows,
/// 64 were the fastest.
const IN_GROUPS: Sizes = Sizes {
    width: WIDTH,
    rows: HEIGHT as u32,
    most: 64,
};

impl Sizes {
    /// How high the next tiles are, before so many rows of pixels: the less is left to do, the lower. So all
    /// threads end at about the same time: C. D. Polychronopoulos, D. J. Kuck, "Guided Self-Scheduling",
    /// IEEE Transactions on Computers C-36 (12), 1987.
    fn height(&self, rows: u32, width: u32) -> u32 {
        // Tiles a thread, if all that is left were of this height.
        const SHARE: u64 = 8;
        let threads = rayon::current_num_threads() as u64;
        let height = u64::from(rows) * u64::from(width) / (SHARE * threads * u64::from(self.width));
        let factor = (height.min(self.most.into()) as u32 / self.rows).max(1);
        rows.min(factor * self.rows)
    }
}

/// Has `trace` compute all rows, on all cores, by tiles.
fn tiles<P: Clone + Default + Send, E>(
    view: &View,
    rows: Range<u32>,
    sizes: Sizes,
    trace: impl Fn(Tile, &mut [Vec3]) -> Counters + Sync,
    develop: impl Fn(&[Vec3], &mut [P]) + Sync,
    mut emit: impl FnMut(&[P]) -> Result<(), E>,
) -> Result<Counters, E> {
    let width = view.width as usize;
    let batch = (BATCH / width).clamp(1, rows.len().max(1)) as u32;
    let mut counters = Counters::default();
    // Where that is made of zeros, what the system gives: threads are the first to touch it.
    let mut developed = vec![P::default(); batch as usize * width];
    for start in rows.clone().step_by(batch as usize) {
        let developed = &mut developed[..batch.min(rows.end - start) as usize * width];
        let mut tiles = Vec::new();
        let (mut row, mut rest) = (start, &mut *developed);
        while !rest.is_empty() {
            let height = sizes.height((rest.len() / width) as u32, view.width);
            let (band, below) = rest.split_at_mut(height as usize * width);
            let lines = band.chunks_mut(width);
            let mut lines: Vec<_> = lines
                .map(|line| line.chunks_mut(sizes.width as usize))
                .collect();
            for left in (0..view.width).step_by(sizes.width as usize) {
                let tile = Tile {
                    rows: row..row + height,
                    columns: left..view.width.min(left.saturating_add(sizes.width)),
                };
                let lines: Vec<_> = lines.iter_mut().filter_map(Iterator::next).collect();
                tiles.push((tile, lines));
            }
            (row, rest) = (row + height, below);
        }
        // One after the other to whichever thread is free.
        counters += (tiles.into_iter().par_bridge())
            .map(|(tile, lines)| {
                let width = tile.columns.len();
                let mut pixels = vec![Vec3::ZERO; lines.len() * width];
                let counters = trace(tile, &mut pixels);
                for (pixels, line) in pixels.chunks_exact(width).zip(lines) {
                    develop(pixels, line);
                }
                counters
            })
            .reduce(Counters::default, |mut sum, tile| {
                sum += tile;
                sum
            });
        emit(developed)?;
    }
    Ok(counters)
}

/// Pixels as red, green, blue. Of pixels and of room for them, what there is more of is left alone.
pub fn encode(pixels: &[Vec3], bytes: &mut [[u8; 3]], transfer: Transfer) {
    for (bytes, &pixel) in bytes.iter_mut().zip(pixels) {
        *bytes = match transfer {
            Transfer::Linear => to_rgb8(pixel),
            Transfer::Srgb => pixel.to_array().map(|it| quantize(srgb(it))),
        };
    }
}

/// What a display is to be sent for an amount of light, both from 0 to 1.
///
/// IEC 61966-2-1; by libm, which has the same bits everywhere.
fn srgb(light: f32) -> f32 {
    let light = f64::from(light.clamp(0.0, 1.0));
    let signal = if light <= 0.003_130_8 {
        12.92 * light
    } else {
        1.055 * libm::pow(light, 1.0 / 2.4) - 0.055
    };
    signal as f32
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::scene::{HostScene, Pool};
    use crate::scene_file::toml;

    #[test]
    fn lone_rays_give_the_bits_of_those_in_lockstep() {
        let builtin = include_str!("../scenes/builtin.toml");
        let file = toml::parse(Path::new("builtin.toml"), builtin).unwrap();
        let pool = Pool::new(&file);
        let host = HostScene::new(&file, &pool).unwrap();
        let scene = host.scene();
        let view = host.camera(61, 43).unwrap().unwrap();
        let settings = Settings {
            depth: file.depth,
            threshold: 1.0 / 512.0,
        };
        let mut expected = Vec::new();
        let rendered = render(&scene, &view, 5..43, settings, keep, |pixels| {
            expected.extend_from_slice(pixels);
            Ok::<_, ()>(())
        });
        let mut pixels = vec![Vec3::ZERO; expected.len()];
        let geometry = Wide::new(scene.geometry);
        let tile = Tile {
            rows: 5..43,
            columns: 0..61,
        };
        let scene = over(&geometry, &scene);
        let counters = trace_tile(&scene, &view, tile, settings, &mut pixels);
        assert_eq!(Ok(counters), rendered);
        let bits = |it: Vec3| it.to_array().map(f32::to_bits);
        assert!(
            pixels
                .iter()
                .map(|&it| bits(it))
                .eq(expected.iter().map(|&it| bits(it)))
        );
        assert!(counters.refracted > 0 && counters.shadow > 0);
    }

    #[test]
    fn every_pixel_is_in_a_tile_whatever_the_size() {
        let sides = [1, 2, 127, 128, 129, 255, 256, 257, 385];
        for (width, sizes) in sides
            .into_iter()
            .flat_map(|it| [(it, LONE), (it, IN_GROUPS)])
        {
            let camera = whitted::Camera::look_at(Vec3::ZERO, Vec3::Z, Vec3::Y, 1.0, 1.0);
            let view = View {
                camera: camera.unwrap(),
                width,
                height: 307,
            };
            let number = |tile: Tile, pixels: &mut [Vec3]| {
                let columns = tile.columns;
                assert_eq!(pixels.len(), tile.rows.len() * columns.len());
                let places = tile
                    .rows
                    .flat_map(|row| columns.clone().map(move |it| (it, row)));
                for (pixel, (column, row)) in pixels.iter_mut().zip(places) {
                    *pixel = Vec3::new(column as f32, row as f32, 1.0);
                }
                Counters::default()
            };
            let mut all = Vec::new();
            let emit = |pixels: &[Vec3]| {
                all.extend_from_slice(pixels);
                Ok::<_, ()>(())
            };
            tiles(&view, 2..307, sizes, number, keep, emit).unwrap();
            let expected = (2..307).flat_map(|row| {
                (0..width).map(move |column| Vec3::new(column as f32, row as f32, 1.0))
            });
            assert!(all.into_iter().eq(expected), "{width}");
        }
    }

    #[test]
    fn tiles_become_lower_to_the_last() {
        let heights = |threads, mut rows| {
            let next = || {
                let height = IN_GROUPS.height(rows, 512);
                rows -= height;
                height
            };
            let all = std::iter::repeat_with(next).take_while(|&it| it > 0);
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let pool = pool.build().unwrap();
            pool.install(|| all.collect::<Vec<_>>())
        };
        let two = heights(2, 510);
        assert_eq!(two[..4], [64; 4]);
        assert!(
            two.is_sorted_by(|a, b| a >= b) && two.ends_with(&[4, 4, 2]),
            "{two:?}"
        );
        assert_eq!(two.iter().sum::<u32>(), 510);
        // Less than a row for each.
        assert_eq!(heights(64, 9), [4, 4, 1]);
    }

    #[test]
    fn light_becomes_bytes() {
        let pixels = [
            Vec3::new(0.0, 0.5, 1.0),
            Vec3::new(-1.0, 2.0, f32::NAN),
            Vec3::new(0.001, 0.2, f32::INFINITY),
        ];
        let encoded = |transfer| {
            let mut bytes = [[0; 3]; 3];
            encode(&pixels, &mut bytes, transfer);
            bytes
        };
        let linear = encoded(Transfer::Linear);
        assert_eq!(linear, [[0, 128, 255], [0, 255, 0], [0, 51, 255]]);
        // By the standard's formula: 0.5 is 187.5, 0.2 is 123.6 and 0.001 is 3.3 of 255.
        let display = encoded(Transfer::Srgb);
        assert_eq!(display, [[0, 188, 255], [0, 255, 0], [3, 124, 255]]);
    }
}
