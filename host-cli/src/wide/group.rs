//! As many rays as a vector has lanes, traced and shaded a lane each.

use fearless_simd::{Select, Simd, SimdMask};
use whitted::material::Transmission;
use whitted::math::{self, Transmittance};
use whitted::{Candidates, Counters, Exact, Geometry, LightSource, Ray, Vec3};

use super::Wide;
use super::across::{self, Few, Near, Terms};
use super::beams::{Beams, Rows, Set};
use super::blocks::Kind;
use super::frustum;
use super::lanes::{Lanes, Vectors, mask_of};
use super::lockstep::Job;
use super::order::by_cells;
use super::packet::{LightOfEach, NearestOfEach, Packet};
use super::pairs::Pairs;
use super::paths::{Path, Paths};
use super::power::powers;
use super::tree::{Nearest, Search, Tree, Vector};
use crate::scene::Material;

impl Wide<'_, Material> {
    /// Whether these rays go down a hierarchy together.
    #[inline(always)]
    fn casts_as_group(&self, rays: u32) -> bool {
        let boxes = matches!(self.search, Search::SolidBoxes | Search::Boxes);
        boxes && rays.count_ones() > 1
    }
}

/// What the lanes' rays hit, and what it is made of.
pub struct Hits<'a, const N: usize> {
    pub t: [f32; N],
    pub object: [u32; N],
    pub material: [Option<&'a Material>; N],
    pub point: Rows<N>,
    /// Unit normals on the objects' outward sides.
    outward: Rows<N>,
    /// The same, turned to the rays.
    pub normal: Rows<N>,
    /// A bit a lane: whether its ray came from outside.
    pub front: u32,
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

/// Where a ray that has parted hits what it meets first.
struct PartedHit {
    /// The ray's place among those that have.
    path: u32,
    nearest: Nearest,
    point: Vec3,
}

/// Some pixels of a picture, and the rays through them.
pub struct Canvas<'a> {
    /// What has been added up of each pixel.
    pub pixels: &'a mut [Vec3],
    pub counters: Counters,
    paths: Paths,
}

impl<'a> Canvas<'a> {
    pub fn new(pixels: &'a mut [Vec3]) -> Self {
        pixels.fill(Vec3::ZERO);
        Self {
            paths: Paths::of(pixels.len()),
            pixels,
            counters: Counters::default(),
        }
    }
}

/// As many rays as there are lanes, each for a pixel of its own.
pub struct Group<'a, L, const N: usize> {
    job: Job<'a, L>,
    tree: &'a Tree<N>,
    /// Of each lane, what is being traced.
    pub beams: Beams<N>,
    throughput: [f32; N],
    depth: [u32; N],
    /// The pixel's place in the canvas.
    pixel: [u32; N],
    /// What has been added up of it.
    radiance: Rows<N>,
    pub hits: Hits<'a, N>,
    /// Towards one light.
    pub shadows: Beams<N>,
    /// Of few objects, which to look at.
    near: Near,
    /// And which of them with few rays.
    pairs: Pairs<N>,
    /// For each light an object that was seen to hide it from what the eye sees, and one that hid it from
    /// what mirrors show; `u32::MAX` for none.
    occluders: Vec<[u32; 2]>,
}

impl<'a, L: LightSource + Copy, const N: usize> Group<'a, L, N> {
    pub fn new(job: Job<'a, L>, tree: &'a Tree<N>) -> Self {
        let few = job.geometry.few.as_ref();
        let few = few.map_or(0, |it| it.materials.len());
        Self {
            job,
            tree,
            beams: Beams::NONE,
            throughput: [1.0; N],
            depth: [1; N],
            pixel: [0; N],
            radiance: Rows::ZERO,
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
            near: Near::new(few),
            pairs: Pairs::new(tree.flat_blocks(), few),
            occluders: vec![[u32::MAX; 2]; job.lights.len()],
        }
    }

    /// Takes the rays from the eye through a pixel a lane; `pixel` are the places of these in the tile.
    #[inline(always)]
    pub fn start<S: Simd, V: Lanes<S>>(
        &mut self,
        simd: S,
        eye: Vec3,
        direction: Vectors<V>,
        pixel: [u32; N],
    ) where
        Tree<N>: Vector<S, Lanes = V>,
    {
        self.beams.origin.store(Vectors::<V>::splat(simd, eye));
        self.beams.direction.store(direction);
        self.beams.left = [u32::MAX; N];
        self.beams.inward = 0;
        self.throughput = [1.0; N];
        self.depth = [1; N];
        self.pixel = pixel;
    }

    /// As `Tracer::radiance`, for the `active` lanes' rays, as long as they go the same way; what they meet
    /// is added to their pixels, and the rest becomes the canvas's paths. `by_eye` says that the eye sends them.
    #[inline(always)]
    pub fn trace<S: Simd, V: Lanes<S>>(
        &mut self,
        simd: S,
        active: u32,
        by_eye: bool,
        canvas: &mut Canvas<'_>,
    ) where
        Tree<N>: Vector<S, Lanes = V>,
    {
        let hit = self.nearest(simd, active);
        self.go_on(simd, active, hit, by_eye, canvas);
    }

    /// Traces the rays that have parted, and those that part from them, to the last.
    #[inline(always)]
    pub fn trace_parted<S: Simd, V: Lanes<S>>(&mut self, simd: S, canvas: &mut Canvas<'_>)
    where
        Tree<N>: Vector<S, Lanes = V>,
    {
        // Where there are no boxes, rays need nothing in common, and any order will do.
        let boxes = self.job.geometry.bounds;
        let bounds = boxes.unwrap_or_default();
        // Where such rays hit, they are gathered again, if several lights are then asked for there.
        let shadows = (self.job.lights.iter()).filter(|it| it.casts_shadows());
        let regroups = boxes.is_some() && shadows.count() > 1;
        loop {
            let (parted, order) = canvas.paths.gather(bounds);
            if parted.is_empty() {
                return;
            }
            let mut hits = Vec::new();
            for places in order.chunks(N) {
                let active = self.follow_all(simd, &parted, places.iter().copied());
                if !regroups {
                    self.trace(simd, active, false, canvas);
                    continue;
                }
                let hit = self.nearest_of_each(simd, active);
                for lane in Set(hit) {
                    let (t, object) = (self.hits.t[lane], self.hits.object[lane]);
                    let point = self.beams.origin.get(lane) + self.beams.direction.get(lane) * t;
                    hits.push(PartedHit {
                        path: places[lane],
                        nearest: Nearest { t, object },
                        point,
                    });
                }
                if hit != active {
                    self.go_on(simd, active & !hit, 0, false, canvas);
                }
            }
            let order = by_cells(hits.iter().map(|hit| hit.point), bounds);
            for places in order.chunks(N) {
                let hits = places.iter().map(|&place| &hits[place as usize]);
                let hit = self.follow_all(simd, &parted, hits.clone().map(|hit| hit.path));
                for (lane, PartedHit { nearest, .. }) in hits.enumerate() {
                    (self.hits.t[lane], self.hits.object[lane]) = (nearest.t, nearest.object);
                }
                self.look_up_all(simd, hit);
                self.go_on(simd, hit, hit, false, canvas);
            }
        }
    }

    /// As [`trace`](Self::trace), from what was `hit`.
    #[inline(always)]
    fn go_on<S: Simd, V: Lanes<S>>(
        &mut self,
        simd: S,
        active: u32,
        mut hit: u32,
        mut by_eye: bool,
        canvas: &mut Canvas<'_>,
    ) where
        Tree<N>: Vector<S, Lanes = V>,
    {
        // With AVX a function of its own: it is long.
        simd.vectorize(
            #[inline(always)]
            || {
                for lane in Set(active) {
                    let pixel = self.pixel[lane] as usize;
                    self.radiance.set(lane, canvas.pixels[pixel]);
                }
                let mut rays = active;
                loop {
                    rays = self.shade(simd, rays, hit, by_eye, canvas);
                    if rays == 0 {
                        break;
                    }
                    if !self.goes_together(simd, rays) {
                        for lane in Set(rays) {
                            canvas.paths.part(self.path(lane));
                        }
                        break;
                    }
                    hit = self.nearest(simd, rays);
                    by_eye = false;
                }
                for lane in Set(active) {
                    canvas.pixels[self.pixel[lane] as usize] = self.radiance.get(lane);
                }
            },
        );
    }

    /// Shades what the lanes' rays hit, and the background where they hit nothing; says which lanes go on
    /// with another ray.
    #[inline(always)]
    fn shade<S: Simd, V: Lanes<S>>(
        &mut self,
        simd: S,
        active: u32,
        hit: u32,
        by_eye: bool,
        canvas: &mut Canvas<'_>,
    ) -> u32
    where
        Tree<N>: Vector<S, Lanes = V>,
    {
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
            canvas.counters.hits += u64::from(hit.count_ones());
            self.surfaces(simd);
            self.finishes(hit);
            self.direct(simd, hit, by_eye, &mut canvas.counters);
            going_on = self.children(simd, hit, canvas);
        }
        for lane in Set(active & !going_on) {
            if let Some(path) = canvas.paths.refracted(self.pixel[lane]) {
                self.follow(lane, &path);
                going_on |= 1 << lane;
            }
        }
        going_on
    }

    /// Whether rays have so much in common that they had better not be parted: there are enough, and they
    /// go about the same way.
    #[inline(always)]
    fn goes_together<S: Simd, V: Lanes<S>>(&self, simd: S, rays: u32) -> bool
    where
        Tree<N>: Vector<S, Lanes = V>,
    {
        // Cosine of the angle between any and the first.
        const NARROW: f32 = 0.9;
        if (rays.count_ones() as usize) < N / 2 {
            return false;
        }
        let first = rays.trailing_zeros() as usize % N;
        let first = Vectors::<V>::splat(simd, self.beams.direction.get(first));
        let cos: V = first.dot(self.beams.direction.load(simd));
        let narrow = cos.simd_gt(V::simd_from(simd, NARROW));
        rays & !(narrow.to_bitmask() as u32) == 0
    }

    /// A lane's ray, to be followed later.
    #[inline(always)]
    fn path(&self, lane: usize) -> Path {
        Path {
            origin: self.beams.origin.get(lane),
            direction: self.beams.direction.get(lane),
            left: self.beams.left[lane],
            inward: self.beams.inward >> lane & 1 != 0,
            throughput: self.throughput[lane],
            depth: self.depth[lane],
            pixel: self.pixel[lane],
        }
    }

    #[inline(always)]
    fn follow(&mut self, lane: usize, path: &Path) {
        self.beams.origin.set(lane, path.origin);
        self.beams.direction.set(lane, path.direction);
        self.throughput[lane] = path.throughput;
        self.follow_on(lane, path);
    }

    /// As [`follow`](Self::follow), but for origin, direction, and throughput.
    #[inline(always)]
    fn follow_on(&mut self, lane: usize, path: &Path) {
        self.beams.left[lane] = path.left;
        self.beams.inward = self.beams.inward & !(1 << lane) | u32::from(path.inward) << lane;
        self.depth[lane] = path.depth;
        self.pixel[lane] = path.pixel;
    }

    /// Takes up to as many paths as there are lanes, by their places; says which lanes have one.
    #[inline(always)]
    fn follow_all<S: Simd, V: Lanes<S>>(
        &mut self,
        simd: S,
        paths: &[Path],
        places: impl ExactSizeIterator<Item = u32>,
    ) -> u32
    where
        Tree<N>: Vector<S, Lanes = V>,
    {
        let active = u32::MAX >> (32 - places.len());
        // Lanes without a path have any.
        let mut lanes = [&paths[0]; N];
        for (lane, place) in lanes.iter_mut().zip(places) {
            *lane = &paths[place as usize];
        }
        let throughputs = self.beams.take_rows(simd, lanes, |path| {
            (path.origin, path.direction, path.throughput)
        });
        throughputs.store_slice(&mut self.throughput);
        for (lane, path) in lanes.iter().enumerate() {
            self.follow_on(lane, path);
        }
        active
    }

    /// Casts the lanes' rays; says which hit anything.
    #[inline(always)]
    pub fn nearest<S: Simd, V: Lanes<S>>(&mut self, simd: S, active: u32) -> u32
    where
        Tree<N>: Vector<S, Lanes = V>,
    {
        let geometry = self.job.geometry;
        if let Some(few) = &geometry.few
            && active & !self.beams.regular(simd, self.tree.needs()) == 0
        {
            let parts = &geometry.parts;
            let hits = &mut self.hits;
            let returning = geometry.returning(&self.beams);
            if !(self.near).find::<S, V, _, N>(simd, few, &self.beams, active, returning) {
                return 0;
            }
            let terms = Terms::new(simd, &self.beams, self.tree.needs());
            let ends = V::from_slice(simd, &self.beams.end);
            let limit = V::Mask::from_bitmask(simd, active.into())
                .select(ends, V::simd_from(simd, f32::NEG_INFINITY));
            // An object that a ray may meet again is not met in pairs, nor a box by rays along its faces.
            if active & returning == 0
                && !terms.any_along
                && self.pairs.find(self.tree.flat_blocks(), &self.near)
            {
                let (hit, unknown) = self.nearest_in_pairs(simd, few, &terms, limit, active);
                self.look_up(unknown);
                return hit;
            }
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
        let hit = self.nearest_of_each(simd, active);
        self.look_up_all(simd, hit);
        hit
    }

    /// As [`nearest`](Self::nearest), of few objects, with those in [`pairs`](super::pairs) that were found; and of
    /// which lanes the kernels have to say the normal.
    #[inline(always)]
    fn nearest_in_pairs<S: Simd, V: Lanes<S>>(
        &mut self,
        simd: S,
        few: &Few<'a, Material>,
        terms: &Terms<V, V::Mask>,
        limit: V,
        active: u32,
    ) -> (u32, u32)
    where
        Tree<N>: Vector<S, Lanes = V>,
    {
        // With AVX a function of its own: what is here is not to take the registers of what is not.
        simd.vectorize(
            #[inline(always)]
            || {
                let (hits, near, beams) = (&mut self.hits, &mut self.near, &self.beams);
                let mut nearest = [Nearest::before(0.0); N];
                for (nearest, &end) in nearest.iter_mut().zip(&beams.end) {
                    nearest.t = end;
                }
                let (blocks, outward) = (self.tree.flat_blocks(), &mut hits.outward);
                (self.pairs).cast(simd, blocks, near, terms, beams, &mut nearest, outward);
                let mut unknown = 0;
                if !near.is_empty() {
                    let parts = &self.job.geometry.parts;
                    let found = across::nearest(simd, parts, few, near, terms, beams, limit);
                    let met = found.t.simd_lt(limit).to_bitmask() as u32 & active;
                    let (mut t, mut places) = ([0.0; N], [0.0; N]);
                    found.t.store_slice(&mut t);
                    found.object.store_slice(&mut places);
                    let mut normals = Rows::<N>::ZERO;
                    normals.store(found.outward);
                    for lane in Set(met) {
                        let object = places[lane].to_bits() % across::PLACES as u32;
                        nearest[lane].offer(t[lane], object);
                        if nearest[lane].object == object {
                            hits.outward.set(lane, normals.get(lane));
                            unknown |= found.unknown & 1 << lane;
                        }
                    }
                }
                let mut hit = 0;
                for lane in Set(active) {
                    let Nearest { t, object } = nearest[lane];
                    (hits.t[lane], hits.object[lane]) = (t, object);
                    if let Some(&material) = few.materials.get(object as usize) {
                        hit |= 1 << lane;
                        hits.material[lane] = Some(material);
                        unknown |= u32::from(few.is_patch(object as usize)) << lane;
                    }
                }
                (hit, unknown)
            },
        )
    }

    /// As [`nearest`](Self::nearest), but for what is there.
    #[inline(always)]
    fn nearest_of_each<S: Simd, V: Lanes<S>>(&mut self, simd: S, active: u32) -> u32
    where
        Tree<N>: Vector<S, Lanes = V>,
    {
        let geometry = self.job.geometry;
        let hits = &mut self.hits;
        let regular = self.beams.regular(simd, self.tree.needs());
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
            self.tree.visit_rays(
                simd,
                &geometry.parts,
                true,
                &packet,
                &mut limits,
                &mut visit,
            );
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
    pub fn surfaces<S: Simd, V: Lanes<S>>(&mut self, simd: S)
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
            let weighs = if job.threshold == 0.0 {
                // One may be no number.
                diffuse.simd_gt(zero) | peak.simd_gt(zero)
            } else {
                let most = (diffuse + peak) * (weight.x + weight.y + weight.z);
                most.simd_gt(V::simd_from(simd, job.threshold))
            };
            let seen = above & weighs;
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
    pub fn cast_shadows<S: Simd, V: Lanes<S>>(
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
        let regular = beams.regular(simd, self.tree.needs());
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
            let meeting = terms.unless_left(simd, *occluder as usize, meeting);
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
    fn children<S: Simd, V: Lanes<S>>(&mut self, simd: S, hit: u32, canvas: &mut Canvas<'_>) -> u32
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
                    canvas.paths.refract(Path {
                        origin: hits.point.get(lane),
                        direction,
                        left: hits.object[lane],
                        inward: front,
                        throughput: self.throughput[lane] * hits.transmittance[lane],
                        depth: self.depth[lane] + 1,
                        pixel: self.pixel[lane],
                    });
                }
                Some(_) => {}
                // Total internal reflection.
                None => hits.reflectance[lane] += hits.transmittance[lane],
            }
        }
        canvas.counters.refracted += u64::from(refracted.count_ones());
        let hits = &self.hits;
        let weight = throughput * V::from_slice(simd, &hits.reflectance);
        let reflected = weight.simd_gt(threshold).to_bitmask() as u32 & can;
        canvas.counters.reflected += u64::from(reflected.count_ones());
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

#[cfg(test)]
mod tests {
    use whitted::{Absorbing, Light, Mirror, Object, PhongReal, Polygon, Sphere};

    use super::super::{Kinds, levels};
    use super::*;
    use crate::paint::Paint;

    static MIRROR: Material = Material {
        color: Paint::Plain(Vec3::ONE),
        ambient: 0.0,
        diffuse: 0.0,
        highlight: PhongReal {
            specular: 0.0,
            shininess: 1.0,
        },
        reflection: Mirror { reflectance: 1.0 },
        transmission: Absorbing {
            tint: Vec3::ZERO,
            ior: 1.0,
            absorption: Vec3::ZERO,
        },
    };

    /// How many rays part of a group that goes down towards some mirrors, spread by 17 degrees.
    fn parted<const N: usize, S: Simd, V: Lanes<S>>(
        simd: S,
        geometry: &Wide<'_, Material>,
        tree: &Tree<N>,
        active: u32,
    ) -> usize
    where
        Tree<N>: Vector<S, Lanes = V>,
    {
        let job = Job::<Light> {
            geometry,
            lights: &[],
            background: Vec3::ONE,
            ambient: Vec3::ZERO,
            depth: 2,
            threshold: 0.0,
        };
        let mut pixels = [Vec3::ZERO; N];
        let mut canvas = Canvas::new(&mut pixels);
        let mut group = Group::new(job, tree);
        let places: [f32; N] =
            core::array::from_fn(|lane| 0.3 * (lane as f32 / (N - 1) as f32 - 0.5));
        let mut direction = Vectors::<V>::splat(simd, Vec3::NEG_Y);
        direction.x = V::from_slice(simd, &places);
        let unit = direction * (V::simd_from(simd, 1.0) / direction.dot(direction).sqrt());
        let pixel = core::array::from_fn(|lane| lane as u32);
        group.start(simd, Vec3::Y, unit, pixel);
        group.trace(simd, active, true, &mut canvas);
        let (parted, order) = canvas.paths.gather([-Vec3::ONE, Vec3::ONE]);
        assert_eq!(parted.len(), order.len());
        group.trace_parted(simd, &mut canvas);
        parted.len()
    }

    #[test]
    fn rays_part_that_a_ball_mirrors_or_that_are_few() {
        let balls = [Object {
            shape: Sphere {
                center: Vec3::ZERO,
                radius: 0.6,
            },
            material: &MIRROR,
        }];
        let corners = [[-9.0, -9.0], [-9.0, 9.0], [9.0, 9.0], [9.0, -9.0]];
        let corners = corners.map(|[x, z]| Vec3::new(x, 0.0, z));
        let flat = [Object {
            shape: Polygon::new(&corners).unwrap(),
            material: &MIRROR,
        }];
        let of = |spheres, polygons| -> Kinds<'_, Material> {
            (
                spheres,
                (
                    &[],
                    (polygons, (&[], (&[], (&[], (&[], (&[], &[] as &[_])))))),
                ),
            )
        };
        for (name, level) in levels() {
            let rays_of = |kinds, active: u32| {
                let wide = Wide::with_level(kinds, level);
                with_tree!(&wide.tree, |tree, simd| parted(simd, &wide, tree, active))
            };
            let lanes = if name == "AVX-512" { 16 } else { 8 };
            let all = u32::MAX >> (32 - lanes);
            assert!(rays_of(of(&balls, &[]), all) > lanes / 2, "{name}");
            assert_eq!(rays_of(of(&[], &flat), all), 0, "{name}");
            assert_eq!(rays_of(of(&[], &flat), 0b1011), 3, "{name}");
        }
    }
}
