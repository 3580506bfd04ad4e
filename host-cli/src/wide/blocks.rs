//! All blocks of a scene, by kind.

use fearless_simd::{Simd, SimdMask};
use glam::Vec3;
use rayon::iter::Either;
use rayon::prelude::*;
use whitted::{Exact, Finish, Quadric, Ray, Shape, Torus};

use super::bounds;
use super::build::Item;
use super::cuboid::Cuboids;
use super::frustum::{self, Frusta};
use super::lanes::{Lanes, Meeting};
use super::outline::{Outline, Outlines};
use super::parts::Parts;
use super::rays::{Needs, RayTerms};
use super::sphere::Spheres;

/// What the lanes of a block are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Kind {
    Sphere,
    /// Visible from inside only.
    HollowSphere,
    Triangle,
    Quad,
    /// A polygon of any other size, alone in its block: its edges are the lanes.
    Outline,
    Cuboid,
    Frustum,
    /// Visible from inside only.
    HollowFrustum,
    /// A quadric or a torus, alone in its block: left to its own kernel.
    Other,
}

impl Kind {
    pub const ALL: [Self; 9] = {
        let mut all = [Self::Other; 9];
        let mut number = 0;
        while number < all.len() {
            all[number] = Self::of(number as u32);
            number += 1;
        }
        all
    };

    /// The kind of a number, of others the last.
    #[inline(always)]
    pub const fn of(number: u32) -> Self {
        match number {
            0 => Self::Sphere,
            1 => Self::HollowSphere,
            2 => Self::Triangle,
            3 => Self::Quad,
            4 => Self::Outline,
            5 => Self::Cuboid,
            6 => Self::Frustum,
            7 => Self::HollowFrustum,
            _ => Self::Other,
        }
    }
}

/// The blocks of one kind, and what their lanes stand for.
#[derive(Clone, Debug)]
pub struct Shelf<B, const N: usize> {
    pub blocks: Vec<B>,
    pub labels: Vec<Labels<N>>,
}

/// What the lanes of a block stand for.
#[derive(Clone, Copy, Debug)]
pub struct Labels<const N: usize> {
    /// Places in the geometry.
    pub objects: [u32; N],
    /// A bit a lane: whether no light goes through.
    pub opaque: u32,
}

impl<B, const N: usize> Default for Shelf<B, N> {
    fn default() -> Self {
        Self {
            blocks: Vec::new(),
            labels: Vec::new(),
        }
    }
}

impl<B, const N: usize> Shelf<B, N> {
    fn push(&mut self, block: B, labels: Labels<N>) -> usize {
        self.blocks.push(block);
        self.labels.push(labels);
        self.blocks.len() - 1
    }
}

/// Blocks of `N` objects.
#[derive(Clone, Debug, Default)]
pub struct Blocks<const N: usize> {
    pub spheres: Shelf<Spheres<N>, N>,
    pub hollow_spheres: Shelf<Spheres<N>, N>,
    pub triangles: Shelf<Outlines<3, N>, N>,
    pub quads: Shelf<Outlines<4, N>, N>,
    pub outlines: Shelf<Outline, N>,
    pub cuboids: Shelf<Cuboids<N>, N>,
    pub frusta: Shelf<Frusta<N>, N>,
    pub hollow_frusta: Shelf<Frusta<N>, N>,
    pub others: Shelf<Other, N>,
}

/// A shape that has no kernel for lanes.
#[derive(Clone, Copy, Debug)]
pub enum Other {
    Quadric(Quadric),
    Torus(Torus),
}

impl Other {
    /// Where a ray that does not leave it meets it before a limit.
    ///
    /// Not inlined, and rare: no vector survives a call.
    #[cold]
    #[inline(never)]
    fn meet(&self, ray: &Ray, limit: f32) -> Option<f32> {
        let t = match self {
            Self::Quadric(it) => it.intersect::<Exact>(ray, &Quadric::setup(ray), None),
            Self::Torus(it) => it.intersect::<Exact>(ray, &Torus::setup(ray), None),
        };
        t.filter(|&t| t < limit)
    }
}

/// Which lanes of a block meet a ray, and where.
pub struct Found<'a, V, const N: usize> {
    pub t: V,
    /// A bit a lane.
    pub lanes: u32,
    /// Of all blocks of the kind: most blocks are not met, and of those none is looked for.
    labels: &'a [Labels<N>],
    block: usize,
}

impl<const N: usize> Blocks<N> {
    /// How many objects a block of some kind holds.
    pub fn capacity(kind: Kind) -> usize {
        if matches!(kind, Kind::Outline | Kind::Other) {
            1
        } else {
            N
        }
    }

    /// Which terms of a ray the blocks ask for.
    pub fn needs(&self) -> Needs {
        let outlines = self.outlines.blocks.len();
        Needs {
            turned: self.triangles.blocks.len() + self.quads.blocks.len() + outlines > 0,
            reciprocal: !self.cuboids.blocks.is_empty(),
        }
    }

    /// The bytes of all blocks and labels.
    pub fn bytes(&self) -> usize {
        fn shelf<B, const N: usize>(shelf: &Shelf<B, N>) -> usize {
            shelf.blocks.len() * size_of::<B>() + shelf.labels.len() * size_of::<Labels<N>>()
        }
        let rows = self.outlines.blocks.iter().map(Outline::bytes);
        shelf(&self.spheres)
            + shelf(&self.hollow_spheres)
            + shelf(&self.triangles)
            + shelf(&self.quads)
            + shelf(&self.outlines)
            + rows.sum::<usize>()
            + shelf(&self.cuboids)
            + shelf(&self.frusta)
            + shelf(&self.hollow_frusta)
            + shelf(&self.others)
    }

    /// What the lanes of a block stand for.
    #[inline(always)]
    pub fn labels(&self, kind: Kind, index: usize) -> &Labels<N> {
        match kind {
            Kind::Sphere => &self.spheres.labels[index],
            Kind::HollowSphere => &self.hollow_spheres.labels[index],
            Kind::Triangle => &self.triangles.labels[index],
            Kind::Quad => &self.quads.labels[index],
            Kind::Outline => &self.outlines.labels[index],
            Kind::Cuboid => &self.cuboids.labels[index],
            Kind::Frustum => &self.frusta.labels[index],
            Kind::HollowFrustum => &self.hollow_frusta.labels[index],
            Kind::Other => &self.others.labels[index],
        }
    }

    /// How many blocks of a kind there are.
    pub fn len(&self, kind: Kind) -> usize {
        match kind {
            Kind::Sphere => self.spheres.blocks.len(),
            Kind::HollowSphere => self.hollow_spheres.blocks.len(),
            Kind::Triangle => self.triangles.blocks.len(),
            Kind::Quad => self.quads.blocks.len(),
            Kind::Outline => self.outlines.blocks.len(),
            Kind::Cuboid => self.cuboids.blocks.len(),
            Kind::Frustum => self.frusta.blocks.len(),
            Kind::HollowFrustum => self.hollow_frusta.blocks.len(),
            Kind::Other => self.others.blocks.len(),
        }
    }

    /// Adds a block of items, all of one kind and no more than fit, and says which of its kind it is.
    pub fn push<M: Finish>(&mut self, parts: &Parts<'_, M>, items: &mut [Item]) -> usize {
        // Of equally near lanes the first is the one with the lowest place.
        items.sort_unstable_by_key(|item| item.object);
        let mut labels = Labels {
            objects: [u32::MAX; N],
            opaque: 0,
        };
        for (lane, item) in items.iter().enumerate() {
            labels.objects[lane] = item.object;
            labels.opaque |= u32::from(item.opaque) << lane;
        }
        let places = items.iter().map(|item| item.object as usize);
        match items[0].kind {
            Kind::Sphere | Kind::HollowSphere => {
                let part = &parts.spheres;
                let block = Spheres::new(places.map(|it| part.objects[it - part.first].shape));
                if items[0].kind == Kind::Sphere {
                    self.spheres.push(block, labels)
                } else {
                    self.hollow_spheres.push(block, labels)
                }
            }
            Kind::Triangle => {
                let block = Outlines::new(places.map(|it| corners(parts, it)));
                self.triangles.push(block, labels)
            }
            Kind::Quad => {
                let block = Outlines::new(places.map(|it| corners(parts, it)));
                self.quads.push(block, labels)
            }
            Kind::Outline => {
                let (vertices, normal) = parts.outline(items[0].object as usize);
                let block = Outline::new::<N>(vertices, normal);
                self.outlines.push(block, labels)
            }
            Kind::Cuboid => {
                let part = &parts.cuboids;
                let block = Cuboids::new(places.map(|it| part.objects[it - part.first].shape));
                self.cuboids.push(block, labels)
            }
            Kind::Frustum | Kind::HollowFrustum => {
                let part = &parts.frusta;
                let block = Frusta::new(places.map(|it| part.objects[it - part.first].shape));
                if items[0].kind == Kind::Frustum {
                    self.frusta.push(block, labels)
                } else {
                    self.hollow_frusta.push(block, labels)
                }
            }
            Kind::Other => {
                let (quadrics, tori) = (&parts.quadrics, &parts.tori);
                let place = items[0].object as usize;
                let block = match quadrics.get(place) {
                    Some(it) => Other::Quadric(it.shape),
                    None => Other::Torus(tori.objects[place - tori.first].shape),
                };
                self.others.push(block, labels)
            }
        }
    }

    /// Casts a ray into a block, for points before `limit`.
    #[inline(always)]
    pub fn meet<S: Simd, V: Lanes<S>>(
        &self,
        simd: S,
        kind: Kind,
        index: usize,
        terms: &RayTerms<'_>,
        limit: f32,
    ) -> Found<'_, V, N> {
        macro_rules! meet {
            ($shelf:ident, $block:ident => $meeting:expr) => {{
                let $block = &self.$shelf.blocks[index];
                Found::new($meeting, &self.$shelf.labels, index)
            }};
        }
        match kind {
            Kind::Sphere => meet!(spheres, it => it.meet::<S, V, false>(simd, terms, limit)),
            Kind::HollowSphere => {
                meet!(hollow_spheres, it => it.meet::<S, V, true>(simd, terms, limit))
            }
            Kind::Triangle => meet!(triangles, it => it.meet(simd, terms, limit)),
            Kind::Quad => meet!(quads, it => it.meet(simd, terms, limit)),
            Kind::Cuboid => meet!(cuboids, it => it.meet(simd, terms, limit)),
            Kind::Frustum => meet!(frusta, it => it.meet::<S, V, false>(simd, terms, limit)),
            Kind::HollowFrustum => {
                meet!(hollow_frusta, it => it.meet::<S, V, true>(simd, terms, limit))
            }
            Kind::Outline => {
                let t = self.outlines.blocks[index].meet::<S, V, N>(simd, terms, limit);
                Found::one(simd, t, &self.outlines.labels, index)
            }
            Kind::Other => {
                let t = self.others.blocks[index].meet(terms.ray, limit);
                Found::one(simd, t, &self.others.labels, index)
            }
        }
    }
}

impl<'a, V, const N: usize> Found<'a, V, N> {
    #[inline(always)]
    pub fn new<S: Simd>(meeting: Meeting<V, V::Mask>, labels: &'a [Labels<N>], block: usize) -> Self
    where
        V: Lanes<S>,
    {
        Self {
            t: meeting.t,
            lanes: meeting.met.to_bitmask() as u32,
            labels,
            block,
        }
    }

    /// Of a block of one object.
    #[inline(always)]
    fn one<S: Simd>(simd: S, t: Option<f32>, labels: &'a [Labels<N>], block: usize) -> Self
    where
        V: Lanes<S>,
    {
        Self {
            t: V::simd_from(simd, t.unwrap_or(0.0)),
            lanes: u32::from(t.is_some()),
            labels,
            block,
        }
    }

    /// What the lanes stand for.
    #[inline(always)]
    pub fn labels(&self) -> &'a Labels<N> {
        &self.labels[self.block]
    }
}

fn corners<M, const CORNERS: usize>(
    parts: &Parts<'_, M>,
    object: usize,
) -> ([Vec3; CORNERS], Vec3) {
    let (vertices, normal) = parts.outline(object);
    let mut corners = [Vec3::ZERO; CORNERS];
    corners.copy_from_slice(vertices);
    (corners, normal)
}

/// All objects that a tree can hold, and the places of those that it cannot: planes, quadrics without
/// bounds, and objects with a number so large or so odd that nothing is known about where their kernels report hits.
pub fn items<M: Finish + Sync>(parts: &Parts<'_, M>) -> (Vec<Item>, Vec<u32>) {
    // Fewer are found before another thread is awake.
    const AT_A_TIME: usize = 512;
    (0..parts.len())
        .into_par_iter()
        .with_min_len(AT_A_TIME)
        .partition_map(|place| match item(parts, place) {
            Some(item) => Either::Left(item),
            None => Either::Right(place as u32),
        })
}

fn item<M: Finish>(parts: &Parts<'_, M>, place: usize) -> Option<Item> {
    // Light weakens in a solid also where it meets no surface of it: each is looked at.
    let clear = |_: &bounds::Bounds| parts.is_clear(place);
    let (kind, bounds) = if let Some(it) = parts.spheres.get(place) {
        let kind = if it.shape.radius > 0.0 {
            Kind::Sphere
        } else {
            Kind::HollowSphere
        };
        (kind, bounds::of_sphere(&it.shape).filter(clear))
    } else if parts.planes.get(place).is_some() {
        return None;
    } else if let Some(it) = parts.cuboids.get(place) {
        (Kind::Cuboid, bounds::of_cuboid(&it.shape).filter(clear))
    } else if let Some(it) = parts.frusta.get(place) {
        let kind = if frustum::shows_outside(&it.shape) {
            Kind::Frustum
        } else {
            Kind::HollowFrustum
        };
        (kind, bounds::of_frustum(&it.shape))
    } else if let Some(it) = parts.quadrics.get(place) {
        (Kind::Other, bounds::of_quadric(&it.shape).filter(clear))
    } else if let Some(it) = parts.tori.get(place) {
        (Kind::Other, bounds::of_torus(&it.shape).filter(clear))
    } else {
        let (vertices, normal) = parts.outline(place);
        let kind = match vertices.len() {
            3 => Kind::Triangle,
            4 => Kind::Quad,
            _ => Kind::Outline,
        };
        (kind, bounds::of_outline(vertices, normal))
    };
    Some(Item {
        bounds: bounds?,
        kind,
        opaque: parts.is_opaque(place),
        object: place as u32,
    })
}
