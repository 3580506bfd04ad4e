//! `whitted::Tracer`, for as many rays at once as a vector has lanes.
//!
//! Of each pixel one ray is on its way at a time, and each is the one that the tracer would trace next: so
//! every pixel adds up its terms in the tracer's order, and has its bits. All arithmetic of shading is by
//! vectors, a lane a ray. In scenes of few objects, so are all queries (`across`). In larger ones groups of
//! rays go down the hierarchy together where they go about the same way, as those of neighbouring pixels and
//! of their shadows do, and else one by one (`packet`); what mirrors scatter is gathered anew (`paths`).

use core::ops::Range;

use fearless_simd::Simd;
use whitted::math;
use whitted::{Counters, Geometry, Hit, Light, LightSource, Ray, Vec3, View};

use super::Wide;
use super::beams::{Rows, Set};
use super::group::{Canvas, Group};
use super::lanes::{Lanes, Vectors};
use super::order::{by_cells, by_cells_and_ways};
use super::tree::{Tree, Vector};
use crate::scene::Material;

/// What is traced, and how far.
#[derive(Clone, Copy, Debug)]
pub struct Job<'a, L> {
    /// The objects.
    pub geometry: &'a Wide<'a, Material>,
    /// As [`whitted::Scene::lights`].
    pub lights: &'a [L],
    /// As [`whitted::Scene::background`].
    pub background: Vec3,
    /// As [`whitted::Scene::ambient`].
    pub ambient: Vec3,
    /// As [`whitted::Tracer::depth`].
    pub depth: usize,
    /// As [`whitted::Tracer::threshold`].
    pub threshold: f32,
}

/// Renders some rows and columns of a picture, from top to bottom, left to right, into the first of `pixels`.
///
/// # Panics
///
/// Where there are fewer `pixels` than that.
pub fn tile<L: LightSource + Copy>(
    job: &Job<'_, L>,
    view: &View,
    rows: Range<u32>,
    columns: Range<u32>,
    pixels: &mut [Vec3],
) -> Counters {
    let mut canvas = Canvas::new(&mut pixels[..rows.len() * columns.len()]);
    with_tree!(&job.geometry.tree, |tree, simd| groups(
        simd,
        tree,
        job,
        view,
        [rows, columns],
        &mut canvas
    ));
    canvas.counters
}

/// As [`Geometry::closest_hit`] of each ray; fastest where neighbours go about the same way. Calls `meet`
/// with the index of each ray that hits anything, and its hit, in an order of its own.
pub fn closest_hits<'a>(
    geometry: &'a Wide<'_, Material>,
    rays: &[Ray],
    mut meet: impl FnMut(usize, Hit<'a, Material>),
) {
    let mut cast = |rays: &[Ray], places: Option<&[u32]>| {
        with_tree!(&geometry.tree, |tree, simd| each_hit(
            simd, tree, geometry, rays, places, &mut meet
        ));
    };
    match order(geometry, rays) {
        None => cast(rays, None),
        Some(order) => in_parts(rays, &order, |rays, places| cast(rays, Some(places))),
    }
}

/// The order in which to cast rays, if it is not theirs: where boxes and objects lie [far](Wide::is_far), it
/// [matters](by_cells_and_ways).
fn order(geometry: &Wide<'_, Material>, rays: &[Ray]) -> Option<Vec<u32>> {
    // Fewer have too little in common.
    const ENOUGH: usize = 4096;
    let bounds = (geometry.bounds).filter(|_| geometry.is_far && rays.len() >= ENOUGH)?;
    (!start_together(rays)).then(|| by_cells_and_ways(rays, bounds))
}

/// Whether rays all have one origin, as those of a camera, which come in a good order, or those that a light
/// sends, which cells would not part.
fn start_together(rays: &[Ray]) -> bool {
    rays.iter().all(|ray| ray.origin == rays[0].origin)
}

/// Rays are put in order in parts.
const AT_A_TIME: usize = 1024;

/// Calls `cast` with some rays after others, in an order, and with their places.
fn in_parts(rays: &[Ray], order: &[u32], mut cast: impl FnMut(&[Ray], &[u32])) {
    let mut part = Vec::with_capacity(AT_A_TIME);
    for places in order.chunks(AT_A_TIME) {
        part.clear();
        part.extend(places.iter().map(|&place| rays[place as usize]));
        cast(&part, places);
    }
}

/// As [`closest_hits`], in the rays' order; `places` are what to call them by.
#[inline(always)]
fn each_hit<'a, S: Simd, V: Lanes<S>, const N: usize>(
    simd: S,
    tree: &'a Tree<N>,
    geometry: &'a Wide<'_, Material>,
    rays: &[Ray],
    places: Option<&[u32]>,
    meet: &mut impl FnMut(usize, Hit<'a, Material>),
) where
    Tree<N>: Vector<S, Lanes = V>,
{
    let mut group = Group::<Light, N>::new(Job::dark(geometry), tree);
    for (first, rays) in (0..).step_by(N).zip(rays.chunks(N)) {
        let active = group.beams.take(simd, rays, geometry.len());
        let hit = group.nearest(simd, active);
        if hit == 0 {
            continue;
        }
        group.surfaces(simd);
        let found = &group.hits;
        for lane in Set(hit) {
            // Every hit is of an object.
            let Some(material) = found.material[lane] else {
                continue;
            };
            let hit = Hit {
                t: found.t[lane],
                point: found.point.get(lane),
                normal: found.normal.get(lane),
                front: found.front >> lane & 1 != 0,
                object: found.object[lane] as usize,
                material,
            };
            let ray = first + lane;
            meet(places.map_or(ray, |it| it[ray] as usize), hit);
        }
    }
}

/// As [`Geometry::transmittance`] of each ray, where that is the same for all channels; fastest where many go
/// about the same way. Of rays and places for answers, what there is more of is left alone.
pub fn transmittances(geometry: &Wide<'_, Material>, rays: &[Ray], passed: &mut [f32]) {
    // So few are cast in less time than others are put in order.
    const FEW: usize = 64;
    // Rays towards a light have much in common with others that start near them. A few rows of a picture have
    // most of those; where memory is far, each that comes later fetches again what has left the caches.
    const ROWS: usize = 4096;
    const PICTURE: usize = 16 * ROWS;
    let rays = &rays[..rays.len().min(passed.len())];
    let cast = |rays: &[Ray], passed: &mut [f32]| {
        with_tree!(&geometry.tree, |tree, simd| each_transmittance(
            simd, tree, geometry, rays, passed
        ));
    };
    let bounds = (geometry.bounds).filter(|_| rays.len() > FEW && !start_together(rays));
    let Some(bounds) = bounds else {
        return cast(rays, passed);
    };
    let window = if geometry.is_far { PICTURE } else { ROWS };
    let mut part = [0.0; AT_A_TIME];
    for (rays, passed) in rays.chunks(window).zip(passed.chunks_mut(window)) {
        let order = by_cells(rays.iter().map(|ray| ray.origin), bounds);
        in_parts(rays, &order, |rays, places| {
            let part = &mut part[..rays.len()];
            cast(rays, part);
            for (&place, &it) in places.iter().zip(&*part) {
                passed[place as usize] = it;
            }
        });
    }
}

#[inline(always)]
fn each_transmittance<S: Simd, V: Lanes<S>, const N: usize>(
    simd: S,
    tree: &Tree<N>,
    geometry: &Wide<'_, Material>,
    rays: &[Ray],
    passed: &mut [f32],
) where
    Tree<N>: Vector<S, Lanes = V>,
{
    let mut group = Group::<Light, N>::new(Job::dark(geometry), tree);
    let mut occluder = u32::MAX;
    for (rays, to) in rays.chunks(N).zip(passed.chunks_mut(N)) {
        let active = group.shadows.take(simd, rays, geometry.len());
        let mut passed = [0.0; N];
        group.cast_shadows(simd, active, &mut occluder, &mut passed);
        to.copy_from_slice(&passed[..to.len()]);
    }
}

impl<'a, L> Job<'a, L> {
    /// Nothing but the objects.
    fn dark(geometry: &'a Wide<'a, Material>) -> Self {
        Self {
            geometry,
            lights: &[],
            background: Vec3::ZERO,
            ambient: Vec3::ZERO,
            depth: 1,
            threshold: 0.0,
        }
    }
}

/// Groups of neighbouring pixels, as square as they can be.
#[inline(always)]
fn groups<S: Simd, V: Lanes<S>, L: LightSource + Copy, const N: usize>(
    simd: S,
    tree: &Tree<N>,
    job: &Job<'_, L>,
    view: &View,
    [rows, columns]: [Range<u32>; 2],
    canvas: &mut Canvas<'_>,
) where
    Tree<N>: Vector<S, Lanes = V>,
{
    let camera = &view.camera;
    let down = camera.down / view.height as f32;
    let step = Vectors::<V>::splat(simd, camera.right / view.width as f32);
    let (width, across) = (columns.len(), N / HEIGHT);
    let (half, one) = (V::simd_from(simd, 0.5), V::simd_from(simd, 1.0));
    let mut group = Group::new(*job, tree);
    for top in rows.clone().step_by(HEIGHT) {
        let height = HEIGHT.min((rows.end - top) as usize);
        let mut start = Rows::<N>::ZERO;
        for lane in 0..N {
            // Lanes below the last row are not looked at.
            let row = top.wrapping_add((lane / across) as u32) as f32;
            start.set(lane, camera.corner + down * (row + 0.5));
        }
        let first = (top - rows.start) as usize * width;
        for left in (0..width).step_by(across) {
            // As `View::rays`.
            let mut places = [0.0; N];
            for (lane, place) in places.iter_mut().enumerate() {
                *place = (columns.start as usize + left + lane % across) as u32 as f32;
            }
            let to_pixel = start.load(simd) + step * (V::from_slice(simd, &places) + half);
            let direction = to_pixel * (one / to_pixel.dot(to_pixel).sqrt());
            let (mut active, mut pixel) = (0, [0; N]);
            for (lane, pixel) in pixel.iter_mut().enumerate() {
                let (row, column) = (lane / across, left + lane % across);
                let is_within = row < height && column < width;
                active |= u32::from(is_within) << lane;
                *pixel = (first + row * width + column) as u32;
            }
            group.start(simd, camera.eye, direction, pixel);
            canvas.counters.primary += u64::from(active.count_ones());
            group.trace(simd, active, true, canvas);
        }
    }
    group.trace_parted(simd, canvas);
    for pixel in &mut *canvas.pixels {
        *pixel = pixel.map(math::positive);
    }
}

/// Rows of pixels in a group.
pub const HEIGHT: usize = 4;
