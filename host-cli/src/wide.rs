//! Any scene, cast by vectors: many objects at once, and few of many.
//!
//! [`Wide`] answers every query as the plain slices of its objects do, to the bit, and in a fraction
//! of the time. Objects of one kind lie eight or sixteen to a block, a number a row, and one vector of
//! each row meets a ray at once; where there are many blocks, a hierarchy of boxes, eight or sixteen to
//! a node, says which. The instructions are chosen when the program runs: one binary is fast on any
//! machine and right on all.
//!
//! Lanes do what `whitted`'s kernels do, operation by operation. Boxes are a little wider than their
//! content ([`bounds`]), so that none hides a hit that a kernel would report. Of equally near hits the
//! first in the geometry wins, wherever it lies in the hierarchy. An object that a ray leaves, one whose
//! numbers are out of all proportion, and a ray whose numbers are, are left to the kernels themselves.

#![forbid(unsafe_code)]

#[cfg(test)]
mod agreement;
mod blocks;
mod bounds;
mod build;
mod cuboid;
mod frustum;
mod lanes;
mod nodes;
mod outline;
mod parts;
mod rays;
mod sphere;
mod tree;

use core::any::TypeId;

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
use fearless_simd::x86::Avx512;
use fearless_simd::{Level, Simd, dispatch};
use whitted::math::Transmittance;
use whitted::{Departure, Exact, Finish, Geometry, Math, Ray, Shape, Vec3};

pub use parts::{Kinds, Slice};

use nodes::is_regular;
use parts::Parts;
use tree::{FLAT, Nearest, Tree};

/// A geometry of every kind of object, built for speed.
#[derive(Debug)]
pub struct Wide<'a, M> {
    parts: Parts<'a, M>,
    /// Places of objects that no block holds.
    odd: Vec<u32>,
    tree: AnyTree,
    /// Whether the lanes take every ray.
    takes_any_ray: bool,
}

/// A tree, and the instructions that it is for.
#[derive(Debug)]
enum AnyTree {
    Eight(Level, Tree<8>),
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    Sixteen(Avx512, Tree<16>),
}

/// Evaluates `$call` with the tree and a token, compiled for the tree's instructions.
macro_rules! with_tree {
    ($wide:expr, |$tree:ident, $simd:ident| $call:expr) => {
        match &$wide.tree {
            AnyTree::Eight(level, $tree) => dispatch!(*level, $simd => $call),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            AnyTree::Sixteen(token, $tree) => {
                let $simd = *token;
                $simd.vectorize(
                    #[inline(always)]
                    || $call,
                )
            }
        }
    };
}

impl<'a, M: Finish> Wide<'a, M> {
    /// Builds blocks and hierarchy, for the best instructions that this machine has.
    pub fn new(kinds: Kinds<'a, M>) -> Self {
        Self::with_level(kinds, Level::new())
    }

    /// Builds for instructions of choice.
    ///
    /// # Panics
    ///
    /// Where there are 2^32 objects or more.
    pub fn with_level(kinds: Kinds<'a, M>, level: Level) -> Self {
        Self::with(kinds, level, FLAT)
    }

    fn with(kinds: Kinds<'a, M>, level: Level, flat: usize) -> Self {
        let parts = Parts::new(kinds);
        assert!(parts.len() < u32::MAX as usize, "too many objects");
        let (items, odd) = blocks::items(&parts);
        let tree = AnyTree::new(&parts, items, level, flat);
        Self {
            parts,
            odd,
            takes_any_ray: tree.takes_any_ray(),
            tree,
        }
    }
}

impl AnyTree {
    fn new<M: Finish>(
        parts: &Parts<'_, M>,
        items: Vec<build::Item>,
        level: Level,
        flat: usize,
    ) -> Self {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        if let Some(token) = level.as_avx512() {
            return Self::Sixteen(token, Tree::new(parts, items, flat));
        }
        Self::Eight(level, Tree::new(parts, items, flat))
    }

    fn takes_any_ray(&self) -> bool {
        match self {
            Self::Eight(_, tree) => tree.takes_any_ray(),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Sixteen(_, tree) => tree.takes_any_ray(),
        }
    }
}

/// The levels of SIMD instructions that this machine has, by name, the least first.
pub fn levels() -> Vec<(&'static str, Level)> {
    let best = Level::new();
    let mut levels = Vec::new();
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    {
        levels.extend(best.as_sse2().map(|it| ("SSE2", Level::Sse2(it))));
        levels.extend(best.as_sse4_2().map(|it| ("SSE4.2", Level::Sse4_2(it))));
        levels.extend(best.as_avx2().map(|it| ("AVX2", Level::Avx2(it))));
        levels.extend(best.as_avx512().map(|it| ("AVX-512", Level::Avx512(it))));
    }
    if levels.is_empty() {
        levels.push(("baseline", best));
    }
    levels
}

impl<M> Wide<'_, M> {
    /// The bytes of the nodes and of the blocks, beside the objects themselves.
    pub fn bytes(&self) -> [usize; 2] {
        match &self.tree {
            AnyTree::Eight(_, tree) => tree.bytes(),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            AnyTree::Sixteen(_, tree) => tree.bytes(),
        }
    }

    /// The ray with its departure counted as the objects here are, and which object that is.
    #[inline(always)]
    fn localized(&self, ray: &Ray, first: usize) -> (Ray, u32) {
        match ray.departure {
            None => (*ray, u32::MAX),
            Some(departure) => {
                let object = departure.object.wrapping_sub(first);
                let left = if object < self.parts.len() {
                    object as u32
                } else {
                    u32::MAX
                };
                let departure = Some(Departure {
                    object,
                    ..departure
                });
                (Ray { departure, ..*ray }, left)
            }
        }
    }

    /// Whether the lanes give the kernels' own answer.
    #[inline(always)]
    fn takes<P: Math>(&self, ray: &Ray) -> bool {
        TypeId::of::<P>() == TypeId::of::<Exact>() && (self.takes_any_ray || is_regular(ray))
    }

    /// Objects that the lanes leave out: the one that the ray leaves, and those in no block.
    #[inline(always)]
    fn left_out(&self, left: u32) -> impl Iterator<Item = u32> {
        let left = (left != u32::MAX).then_some(left);
        self.odd.iter().copied().chain(left)
    }
}

impl<M: Finish> Geometry for Wide<'_, M> {
    type Material = M;

    fn len(&self) -> usize {
        self.parts.len()
    }

    #[inline]
    fn nearest<P: Math>(&self, ray: &mut Ray, first: usize) -> Option<usize> {
        if !self.takes::<P>(ray) {
            return self.parts.kinds.nearest::<P>(ray, first);
        }
        let (local, left) = self.localized(ray, first);
        let mut nearest = Nearest::before(&local);
        for (place, plane) in self.parts.planes.places() {
            if let Some(t) = plane.shape.intersect::<P>(&local, &(), local.leaves(place)) {
                nearest.offer(t, place as u32);
            }
        }
        for object in self.left_out(left) {
            if let Some(t) = self.parts.intersect::<P>(&local, object as usize) {
                nearest.offer(t, object);
            }
        }
        with_tree!(self, |tree, simd| tree.nearest(
            simd,
            &local,
            left,
            &mut nearest
        ));
        if nearest.object == u32::MAX {
            return None;
        }
        ray.t_max = nearest.t;
        Some(first + nearest.object as usize)
    }

    #[inline]
    fn surface<P: Math>(
        &self,
        ray: &Ray,
        t: f32,
        object: usize,
        first: usize,
    ) -> Option<(Vec3, &M)> {
        self.parts.kinds.surface::<P>(ray, t, object, first)
    }

    #[inline]
    fn blocks<P: Math>(&self, ray: &Ray, first: usize) -> bool {
        if !self.takes::<P>(ray) {
            return self.parts.kinds.blocks::<P>(ray, first);
        }
        let (local, left) = self.localized(ray, first);
        let planes = &self.parts.planes;
        planes.objects.blocks::<P>(&local, planes.first)
            || self
                .left_out(left)
                .any(|it| self.parts.intersect::<P>(&local, it as usize).is_some())
            || with_tree!(self, |tree, simd| tree.blocks(simd, &local, left))
    }

    #[inline]
    fn absorbs<P: Math>(&self, ray: &Ray, first: usize, light: &mut Transmittance) -> bool {
        if !self.takes::<P>(ray) {
            return self.parts.kinds.absorbs::<P>(ray, first, light);
        }
        let (local, left) = self.localized(ray, first);
        let (parts, planes) = (&self.parts, &self.parts.planes);
        planes.objects.absorbs::<P>(&local, planes.first, light)
            || self
                .left_out(left)
                .any(|it| parts.absorbs::<P>(&local, it as usize, light))
            || with_tree!(self, |tree, simd| tree
                .absorbs::<_, _, P>(simd, parts, &local, left, light))
    }
}
