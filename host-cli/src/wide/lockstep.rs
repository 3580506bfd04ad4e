//! `whitted::Tracer`, for as many pixels at once as a vector has lanes.
//!
//! Every lane goes through the tracer's own loop and adds up its terms in its order, so that every pixel
//! has its bits; all arithmetic of shading is by vectors, a lane a pixel. In scenes of few objects, so
//! are all queries (`across`). In larger ones groups of rays go down the hierarchy together where they go
//! about the same way, as those of neighbouring pixels and of their shadows do, and else one by one (`packet`).

use core::ops::Range;

use fearless_simd::{Select, Simd, SimdMask};
use whitted::material::Transmission;
use whitted::math::{self, Transmittance};
use whitted::{Candidates, Counters, Exact, Geometry, Hit, Light, LightSource, Ray, Vec3, View};

use super::Wide;
use super::across::{self, Near, Terms};
use super::beams::{Beams, Rows, Set};
use super::blocks::Kind;
use super::frustum;
use super::lanes::{Lanes, Vectors, mask_of};
use super::order::by_cells;
use super::packet::{LightOfEach, NearestOfEach, Packet};
use super::power::powers;
use super::tree::{Nearest, Search, Tree, Vector};
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

/// Renders some rows and columns of a picture, from top to bottom, left to right, into `pixels`.
pub fn tile<L: LightSource + Copy>(
    job: &Job<'_, L>,
    view: &View,
    rows: Range<u32>,
    columns: Range<u32>,
    pixels: &mut [Vec3],
) -> Counters {
    let mut counters = Counters::default();
    with_tree!(&job.geometry.tree, |tree, simd| groups(
        simd,
        tree,
        job,
        view,
        [rows, columns],
        pixels,
        &mut counters
    ));
    counters
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

/// The order in which to cast rays, if it is not theirs: where boxes and objects lie [far](Wide::far), it
/// [matters](by_cells).
fn order(geometry: &Wide<'_, Material>, rays: &[Ray]) -> Option<Vec<u32>> {
    // Fewer have too little in common.
    const ENOUGH: usize = 4096;
    let bounds = geometry.far.filter(|_| rays.len() >= ENOUGH)?;
    // Rays of one camera come in a good order.
    let is_camera = rays.iter().all(|ray| ray.origin == rays[0].origin);
    (!is_camera).then(|| by_cells(rays, bounds))
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

/// As [`Geometry::transmittance`] of each ray, where that is the same for all channels; fastest where
/// neighbours go about the same way. Of rays and places for answers, what there is more of is left alone.
pub fn transmittances(geometry: &Wide<'_, Material>, rays: &[Ray], passed: &mut [f32]) {
    let rays = &rays[..rays.len().min(passed.len())];
    let cast = |rays: &[Ray], passed: &mut [f32]| {
        with_tree!(&geometry.tree, |tree, simd| each_transmittance(
            simd, tree, geometry, rays, passed
        ));
    };
    match order(geometry, rays) {
        None => cast(rays, passed),
        Some(order) => {
            let mut part = [0.0; AT_A_TIME];
            in_parts(rays, &order, |rays, places| {
                let part = &mut part[..rays.len()];
                cast(rays, part);
                for (&place, &it) in places.iter().zip(&*part) {
                    passed[place as usize] = it;
                }
            });
        }
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

impl Wide<'_, Material> {
    /// Whether these rays go down a hierarchy together.
    #[inline(always)]
    fn casts_as_group(&self, rays: u32) -> bool {
        let boxes = matches!(self.search, Search::SolidBoxes | Search::Boxes);
        boxes && rays.count_ones() > 1
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
    pixels: &mut [Vec3],
    counters: &mut Counters,
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
            group
                .beams
                .origin
                .store(Vectors::<V>::splat(simd, camera.eye));
            group.beams.direction.store(direction);
            let mut active = 0;
            for lane in 0..N {
                let is_within = lane / across < height && left + lane % across < width;
                active |= u32::from(is_within) << lane;
            }
            group.trace(simd, active, counters);
            for lane in Set(active) {
                let place = first + lane / across * width + left + lane % across;
                pixels[place] = group.radiance.get(lane).map(math::positive);
            }
        }
    }
}

/// Rows of pixels in a group.
pub const HEIGHT: usize = 4;

/// A ray yet to be traced.
#[derive(Clone, Copy)]
struct Path {
    origin: Vec3,
    direction: Vec3,
    left: u32,
    inward: bool,
    throughput: f32,
    depth: u32,
}

/// What the lanes' rays hit, and what it is made of.
struct Hits<'a, const N: usize> {
    t: [f32; N],
    object: [u32; N],
    material: [Option<&'a Material>; N],
    point: Rows<N>,
    /// Unit normals on the objects' outward sides.
    outward: Rows<N>,
    /// The same, turned to the rays.
    normal: Rows<N>,
    /// A bit a lane: whether its ray came from outside.
    front: u32,
    /// The view's direction, mirrored.
    mirrored: Rows<N>,
    color: Rows<N>,
    ambient: [f32; N],
    diffuse: [f32; N],
    specular: [f32; N],
    shininess: [f32; N],
    reflectance: [f32; N],
    transmittance: [f32; N],
    ior: [f32; N],
}

/// As many pixels as there are lanes.
struct Group<'a, L, const N: usize> {
    job: Job<'a, L>,
    tree: &'a Tree<N>,
    /// Of each lane, what is being traced.
    beams: Beams<N>,
    throughput: [f32; N],
    depth: [u32; N],
    radiance: Rows<N>,
    /// Refracted rays, of which each depth leaves at most one.
    waiting: [Vec<Path>; N],
    hits: Hits<'a, N>,
    /// Towards one light.
    shadows: Beams<N>,
    /// Of few objects, which to look at.
    near: Near,
    /// For each light an object that was seen to hide it from what the eye sees, and one that hid it from
    /// what mirrors show; `u32::MAX` for none.
    occluders: Vec<[u32; 2]>,
}

impl<'a, L: LightSource + Copy, const N: usize> Group<'a, L, N> {
    fn new(job: Job<'a, L>, tree: &'a Tree<N>) -> Self {
        Self {
            job,
            tree,
            beams: Beams::NONE,
            throughput: [1.0; N],
            depth: [1; N],
            radiance: Rows::ZERO,
            waiting: core::array::from_fn(|_| Vec::new()),
            hits: Hits {
                t: [0.0; N],
                object: [0; N],
                material: [None; N],
                point: Rows::ZERO,
                outward: Rows::ZERO,
                normal: Rows::ZERO,
                front: 0,
                mirrored: Rows::ZERO,
                color: Rows::ZERO,
                ambient: [0.0; N],
                diffuse: [0.0; N],
                specular: [0.0; N],
                shininess: [0.0; N],
                reflectance: [0.0; N],
                transmittance: [0.0; N],
                ior: [1.0; N],
            },
            shadows: Beams::NONE,
            near: Near::new(job.geometry.few.as_ref().map_or(0, |it| it.materials.len())),
            occluders: vec![[u32::MAX; 2]; job.lights.len()],
        }
    }

    /// As `Tracer::radiance`, for the `active` lanes' rays.
    #[inline(always)]
    fn trace<S: Simd, V: Lanes<S>>(&mut self, simd: S, mut active: u32, counters: &mut Counters)
    where
        Tree<N>: Vector<S, Lanes = V>,
    {
        counters.primary += u64::from(active.count_ones());
        self.beams.left = [u32::MAX; N];
        self.beams.inward = 0;
        self.throughput = [1.0; N];
        self.depth = [1; N];
        self.radiance = Rows::ZERO;
        let mut first = true;
        while active != 0 {
            let hit = self.nearest(simd, active);
            let missed = active & !hit;
            if missed != 0 {
                let missed = V::Mask::from_bitmask(simd, missed.into());
                let throughput = V::from_slice(simd, &self.throughput);
                let background = Vectors::splat(simd, self.job.background) * throughput;
                let radiance = self.radiance.load(simd);
                let sum = mask_of(missed, radiance + background, radiance);
                self.radiance.store(sum);
            }
            let mut going_on = 0;
            if hit != 0 {
                counters.hits += u64::from(hit.count_ones());
                self.surfaces(simd);
                self.finishes(hit);
                self.direct(simd, hit, first, counters);
                going_on = self.children(simd, hit, counters);
            }
            for lane in Set(active & !going_on) {
                if let Some(path) = self.waiting[lane].pop() {
                    self.follow(lane, &path);
                    going_on |= 1 << lane;
                }
            }
            active = going_on;
            first = false;
        }
    }

    #[inline(always)]
    fn follow(&mut self, lane: usize, path: &Path) {
        self.beams.origin.set(lane, path.origin);
        self.beams.direction.set(lane, path.direction);
        self.beams.left[lane] = path.left;
        self.beams.inward = self.beams.inward & !(1 << lane) | u32::from(path.inward) << lane;
        self.throughput[lane] = path.throughput;
        self.depth[lane] = path.depth;
    }

    /// Casts the lanes' rays; says which hit anything.
    #[inline(always)]
    fn nearest<S: Simd, V: Lanes<S>>(&mut self, simd: S, active: u32) -> u32
    where
        Tree<N>: Vector<S, Lanes = V>,
    {
        let geometry = self.job.geometry;
        let parts = &geometry.parts;
        let (origin, direction) = (
            self.beams.origin.load::<S, V>(simd),
            self.beams.direction.load(simd),
        );
        let regular =
            across::regular(simd, origin, direction, self.tree.needs()).to_bitmask() as u32;
        let hits = &mut self.hits;
        if let Some(few) = &geometry.few
            && active & !regular == 0
        {
            let returning = geometry.returning(&self.beams);
            if !(self.near).find::<S, V, _, N>(simd, few, &self.beams, active, returning) {
                return 0;
            }
            let terms = Terms::new(simd, &self.beams, self.tree.needs());
            let ends = V::from_slice(simd, &self.beams.end);
            let limit = V::Mask::from_bitmask(simd, active.into())
                .select(ends, V::simd_from(simd, f32::NEG_INFINITY));
            let found = across::nearest(simd, parts, few, &self.near, &terms, &self.beams, limit);
            let hit = active & found.t.simd_lt(ends).to_bitmask() as u32;
            if hit == 0 {
                return 0;
            }
            found.t.store_slice(&mut hits.t);
            let mut places = [0.0; N];
            found.object.store_slice(&mut places);
            hits.object = places.map(|it| it.to_bits() % across::PLACES as u32);
            hits.outward.store(found.outward);
            for lane in Set(hit) {
                hits.material[lane] = few.materials.get(hits.object[lane] as usize).copied();
            }
            self.look_up(found.unknown & hit);
            return hit;
        }
        let mut nearest = self.beams.end.map(Nearest::before);
        let as_group = active & !regular == 0 && geometry.casts_as_group(active);
        if as_group {
            let mut limits = self.beams.end;
            let departures = geometry.departures(simd, &self.beams, active);
            for lane in Set(departures.across) {
                nearest[lane].offer(departures.t[lane], self.beams.left[lane]);
                limits[lane] = nearest[lane].limit();
            }
            for lane in Set(departures.others) {
                let (ray, left) = (self.beams.ray(lane), self.beams.left[lane]);
                geometry.nearest_apart(&ray, 0, left, &mut nearest[lane]);
                limits[lane] = nearest[lane].limit();
            }
            let packet = Packet {
                beams: &self.beams,
                active,
            };
            let mut visit = NearestOfEach(&mut nearest);
            self.tree
                .visit_rays(simd, parts, true, &packet, &mut limits, &mut visit);
        }
        let mut hit = 0;
        for lane in Set(active) {
            if !as_group {
                let mut ray = self.beams.ray(lane);
                if let Some(object) = geometry.nearest::<Exact>(&mut ray, 0, Candidates::ALL) {
                    nearest[lane] = Nearest {
                        t: ray.t_max,
                        object: object as u32,
                    };
                }
            }
            let Nearest { t, object } = nearest[lane];
            hit |= u32::from(object != u32::MAX) << lane;
            (hits.t[lane], hits.object[lane]) = (t, object);
        }
        self.look_up_all(simd, hit);
        hit
    }

    /// Looks up the normals and materials of what was hit, lane by lane.
    #[inline(always)]
    fn look_up(&mut self, lanes: u32) {
        let hits = &mut self.hits;
        for lane in Set(lanes) {
            let (ray, object) = (self.beams.ray(lane), hits.object[lane] as usize);
            let surface = (self.job.geometry).surface::<Exact>(&ray, hits.t[lane], object, 0);
            hits.material[lane] = surface.map(|(normal, material)| {
                hits.outward.set(lane, normal);
                material
            });
        }
    }

    /// As [`look_up`](Self::look_up), what is round by vectors.
    #[inline(always)]
    fn look_up_all<S: Simd, V: Lanes<S>>(&mut self, simd: S, hit: u32)
    where
        Tree<N>: Vector<S, Lanes = V>,
    {
        let (hits, parts) = (&mut self.hits, &self.job.geometry.parts);
        // The center of a sphere stands for its normal, and the base of a frustum.
        let (mut spheres, mut frusta, mut hollow) = (0_u32, 0_u32, 0_u32);
        let mut axis = Rows::<N>::ZERO;
        let mut slope = [0.0; N];
        for lane in Set(hit) {
            let object = hits.object[lane] as usize;
            if let Some(it) = parts.spheres.get(object) {
                hits.outward.set(lane, it.shape.center);
                spheres |= 1 << lane;
                hollow |= u32::from(!(it.shape.radius > 0.0)) << lane;
                hits.material[lane] = Some(it.material);
            } else if let Some(it) = parts.frusta.get(object) {
                hits.outward.set(lane, it.shape.base);
                axis.set(lane, it.shape.axis);
                slope[lane] = it.shape.slope;
                frusta |= 1 << lane;
                hollow |= u32::from(!frustum::shows_outside(&it.shape)) << lane;
                hits.material[lane] = Some(it.material);
            }
        }
        self.look_up(hit & !(spheres | frusta));
        if spheres | frusta != 0 {
            let hits = &mut self.hits;
            let (origin, direction) = (
                self.beams.origin.load::<S, V>(simd),
                self.beams.direction.load(simd),
            );
            let point = origin + direction * V::from_slice(simd, &hits.t);
            let mut outward = hits.outward.load(simd);
            if frusta != 0 {
                let (axis, slope) = (axis.load(simd), V::from_slice(simd, &slope));
                let hollow = V::Mask::from_bitmask(simd, hollow.into());
                let unit = frustum::normals(simd, point, outward, axis, slope, hollow);
                let frusta = V::Mask::from_bitmask(simd, frusta.into());
                outward = mask_of(frusta, unit, outward);
            }
            if spheres != 0 {
                let unit = across::away(simd, point, outward, hollow);
                let spheres = V::Mask::from_bitmask(simd, spheres.into());
                outward = mask_of(spheres, unit, outward);
            }
            hits.outward.store(outward);
        }
    }

    /// What is where the lanes' rays hit.
    #[inline(always)]
    fn surfaces<S: Simd, V: Lanes<S>>(&mut self, simd: S)
    where
        Tree<N>: Vector<S, Lanes = V>,
    {
        let hits = &mut self.hits;
        let (origin, direction) = (
            self.beams.origin.load::<S, V>(simd),
            self.beams.direction.load(simd),
        );
        let point = origin + direction * V::from_slice(simd, &hits.t);
        let outward = hits.outward.load(simd);
        let front = outward.dot(direction).simd_le(V::simd_from(simd, 0.0));
        let normal = mask_of(front, outward, -outward);
        hits.point.store(point);
        hits.normal.store(normal);
        hits.front = front.to_bitmask() as u32;
    }

    /// Copies what surfaces are made of.
    #[inline(always)]
    fn finishes(&mut self, hit: u32) {
        let hits = &mut self.hits;
        for lane in Set(hit) {
            // Every hit is of an object.
            let Some(material) = hits.material[lane] else {
                continue;
            };
            // Scenes with other materials do not come here.
            hits.color
                .set(lane, material.color.plain().unwrap_or_default());
            hits.ambient[lane] = material.ambient;
            hits.diffuse[lane] = material.diffuse;
            hits.specular[lane] = material.highlight.specular;
            hits.shininess[lane] = material.highlight.shininess;
            hits.reflectance[lane] = material.reflection.reflectance;
            hits.transmittance[lane] = material.transmission.transmittance();
            hits.ior[lane] = material.transmission.ior;
        }
    }

    /// As the tracer's `direct`, for the lanes that hit something; `by_eye` says that the eye sees it.
    #[inline(always)]
    fn direct<S: Simd, V: Lanes<S>>(
        &mut self,
        simd: S,
        hit: u32,
        by_eye: bool,
        counters: &mut Counters,
    ) where
        Tree<N>: Vector<S, Lanes = V>,
    {
        let job = self.job;
        let mut occluders = core::mem::take(&mut self.occluders);
        let (view, normal) = (
            self.beams.direction.load::<S, V>(simd),
            self.hits.normal.load(simd),
        );
        let twice = V::simd_from(simd, 2.0) * view.dot(normal);
        self.hits.mirrored.store(view - normal * twice);
        let (zero, one) = (V::simd_from(simd, 0.0), V::simd_from(simd, 1.0));
        let throughput = V::from_slice(simd, &self.throughput);
        let color = self.hits.color.load::<S, V>(simd);
        let share = V::from_slice(simd, &self.hits.ambient) * throughput;
        let mut light = color * Vectors::splat(simd, job.ambient) * share;
        for (source, known) in job.lights.iter().zip(&mut occluders) {
            let occluder = &mut known[usize::from(!by_eye)];
            let hits = &self.hits;
            let position = Vectors::splat(simd, source.position());
            let to_light = position - hits.point.load(simd);
            let height: V = hits.normal.load(simd).dot(to_light);
            let above = height.simd_gt(zero);
            if above.to_bitmask() as u32 & hit == 0 {
                continue;
            }
            let distance = to_light.dot(to_light).sqrt();
            let recip = one / distance;
            let direction = to_light * recip;
            let cos = hits.mirrored.load(simd).dot(direction);
            let weight = Vectors::splat(simd, source.color()) * throughput;
            let diffuse = V::from_slice(simd, &hits.diffuse) * (height * recip);
            let specular = V::from_slice(simd, &hits.specular);
            let peak = cos.simd_gt(zero).select(specular, zero);
            let most = if job.threshold == 0.0 {
                diffuse + peak
            } else {
                (diffuse + peak) * (weight.x + weight.y + weight.z)
            };
            let seen = above & most.simd_gt(V::simd_from(simd, job.threshold));
            let lit = seen.to_bitmask() as u32 & hit;
            if lit == 0 {
                continue;
            }
            let mut passed = [1.0; N];
            if source.casts_shadows() {
                counters.shadow += u64::from(lit.count_ones());
                self.shadows.origin = hits.point;
                self.shadows.direction.store(direction);
                distance.store_slice(&mut self.shadows.end);
                self.shadows.left = hits.object;
                self.shadows.inward = !hits.front;
                self.cast_shadows(simd, lit, occluder, &mut passed);
            }
            let hits = &self.hits;
            let passed = V::from_slice(simd, &passed);
            let lit = V::Mask::from_bitmask(simd, lit.into()) & passed.simd_gt(zero);
            let mut term = color * diffuse;
            let shines = lit & cos.simd_gt(zero) & specular.simd_gt(zero);
            if shines.any_true() {
                let mut cosines = [0.0; N];
                // Others are not to be slow.
                shines.select(cos, zero).store_slice(&mut cosines);
                let powers = powers(&cosines, &hits.shininess);
                let brightness = specular * V::from_slice(simd, &powers);
                term = plus(term, shines.select(brightness, zero));
            } else {
                term = plus(term, zero);
            }
            light = mask_of(lit, light + term * weight * passed, light);
        }
        self.occluders = occluders;
        let hit = V::Mask::from_bitmask(simd, hit.into());
        let radiance = self.radiance.load(simd);
        self.radiance
            .store(mask_of(hit, radiance + light, radiance));
    }

    /// Which share of a light arrives at the lanes' hit points. What hid it last is asked first: shadows
    /// are larger than a group of pixels.
    #[inline(always)]
    fn cast_shadows<S: Simd, V: Lanes<S>>(
        &mut self,
        simd: S,
        mut lit: u32,
        occluder: &mut u32,
        passed: &mut [f32; N],
    ) where
        Tree<N>: Vector<S, Lanes = V>,
    {
        let geometry = self.job.geometry;
        let parts = &geometry.parts;
        let beams = &self.shadows;
        let (origin, direction) = (beams.origin.load::<S, V>(simd), beams.direction.load(simd));
        let regular =
            across::regular(simd, origin, direction, self.tree.needs()).to_bitmask() as u32;
        // Of rays together is counted what they cross, not how far they go in it.
        let countable = lit & !regular == 0 && !geometry.absorbs;
        if let Some(few) = &geometry.few
            && countable
        {
            let returning = geometry.returning(beams);
            if !(self.near).find::<S, V, _, N>(simd, few, beams, lit, returning) {
                *passed = [1.0; N];
                return;
            }
            let terms = Terms::<V, _>::new(simd, beams, self.tree.needs());
            *passed = across::transmittance(simd, parts, few, &self.near, &terms, beams, lit);
            return;
        }
        let kind = (*occluder != u32::MAX).then(|| parts.kind(*occluder as usize));
        if let Some(kind) = kind
            && kind != Kind::Other
            && lit & !regular == 0
        {
            let terms = Terms::<V, _>::new(simd, beams, self.tree.needs());
            let ends = V::from_slice(simd, &beams.end);
            let meeting = across::object(simd, parts, kind, *occluder as usize, &terms, ends);
            let dark = meeting.met.to_bitmask() as u32 & lit;
            for lane in Set(dark) {
                passed[lane] = 0.0;
            }
            if dark == 0 {
                *occluder = u32::MAX;
            }
            lit &= !dark;
            if lit == 0 {
                return;
            }
        }
        let mut light = [Transmittance::default(); N];
        if countable && geometry.casts_as_group(lit) {
            let (mut limits, mut dark) = (beams.end, 0_u32);
            let departures = geometry.departures(simd, beams, lit);
            for lane in Set(departures.across | departures.others) {
                let (left, light) = (beams.left[lane], &mut light[lane]);
                let is_dark = if departures.across >> lane & 1 != 0 {
                    parts.absorbs_once(left as usize, light)
                } else {
                    geometry.absorbs_apart(&beams.ray(lane), 0, left, light)
                };
                if is_dark {
                    dark |= 1 << lane;
                    limits[lane] = f32::NEG_INFINITY;
                }
            }
            let mut visit = LightOfEach {
                beams,
                light,
                dark,
                occluder,
                absorb: |ray: &Ray, object: u32, light: &mut Transmittance| {
                    parts.absorbs_met::<Exact, _>(ray, object as usize, 0, light)
                },
            };
            let packet = Packet { beams, active: lit };
            self.tree
                .visit_rays(simd, parts, false, &packet, &mut limits, &mut visit);
            for lane in Set(lit) {
                passed[lane] = if visit.dark >> lane & 1 != 0 {
                    0.0
                } else {
                    visit.light[lane].product()
                };
            }
            return;
        }
        for lane in Set(lit) {
            passed[lane] = geometry.transmittance(&beams.ray(lane)).x;
        }
    }

    /// As the tracer's `children`: which lanes go on with one of theirs.
    #[inline(always)]
    fn children<S: Simd, V: Lanes<S>>(&mut self, simd: S, hit: u32, counters: &mut Counters) -> u32
    where
        Tree<N>: Vector<S, Lanes = V>,
    {
        let threshold = V::simd_from(simd, self.job.threshold);
        let mut can = hit;
        for lane in 0..N {
            let ends = self.depth[lane] as usize >= self.job.depth;
            can &= !(u32::from(ends) << lane);
        }
        if can == 0 {
            return 0;
        }
        let throughput = V::from_slice(simd, &self.throughput);
        let transmittance = V::from_slice(simd, &self.hits.transmittance);
        let clear = transmittance.simd_gt(V::simd_from(simd, 0.0));
        let weighs = (throughput * transmittance).simd_gt(threshold);
        let weighs = weighs.to_bitmask() as u32;
        let mut refracted = 0_u32;
        for lane in Set(clear.to_bitmask() as u32 & can) {
            let hits = &mut self.hits;
            let front = hits.front >> lane & 1 != 0;
            let ior = hits.ior[lane];
            let eta = if front { 1.0 / ior } else { ior };
            let direction = self.beams.direction.get(lane);
            match math::refract::<Exact>(direction, hits.normal.get(lane), eta) {
                Some(direction) if weighs >> lane & 1 != 0 => {
                    refracted |= 1 << lane;
                    self.waiting[lane].push(Path {
                        origin: hits.point.get(lane),
                        direction,
                        left: hits.object[lane],
                        inward: front,
                        throughput: self.throughput[lane] * hits.transmittance[lane],
                        depth: self.depth[lane] + 1,
                    });
                }
                Some(_) => {}
                // Total internal reflection.
                None => hits.reflectance[lane] += hits.transmittance[lane],
            }
        }
        counters.refracted += u64::from(refracted.count_ones());
        let hits = &self.hits;
        let weight = throughput * V::from_slice(simd, &hits.reflectance);
        let reflected = weight.simd_gt(threshold).to_bitmask() as u32 & can;
        counters.reflected += u64::from(reflected.count_ones());
        if reflected == 0 {
            return 0;
        }
        // All lanes: those that do not go on are not looked at again.
        let mirrored = hits.mirrored.load::<S, V>(simd);
        let half = V::simd_from(simd, 0.5) * mirrored.dot(mirrored);
        let mirrored = mirrored * (V::simd_from(simd, 1.5) - half);
        self.beams.direction.store(mirrored);
        self.beams.origin = hits.point;
        self.beams.left = hits.object;
        self.beams.inward = !hits.front;
        weight.store_slice(&mut self.throughput);
        for depth in &mut self.depth {
            *depth += 1;
        }
        reflected
    }
}

/// The same number added to each coordinate.
#[inline(always)]
fn plus<S: Simd, V: Lanes<S>>(v: Vectors<V>, x: V) -> Vectors<V> {
    Vectors {
        x: v.x + x,
        y: v.y + x,
        z: v.z + x,
    }
}
