//! Any scene, cast by vectors: many objects at once, and few of many.
//!
//! [`Wide`] answers every query as the plain slices of its objects do, to the bit, and in a fraction
//! of the time. Objects of one kind lie eight or sixteen to a block, a number a row, and one vector of
//! each row meets a ray at once; where there are many blocks, a hierarchy of boxes, eight or sixteen to
//! a node, says which. The instructions are chosen when the program runs: one binary is fast on any
//! machine and right on all.
//!
//! Lanes do what `whitted`'s kernels do, operation by operation. Boxes are a little wider than their
//! content (`bounds`), so that none hides a hit that a kernel would report. Of equally near hits the
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
use whitted::{Exact, Finish, Geometry, Math, Ray, Vec3};

pub use parts::{Kinds, Slice};

use nodes::is_regular;
use parts::Parts;
use tree::{FLAT, Nearest, Search, Tree};

/// A geometry of every kind of object, built for speed.
#[derive(Debug)]
pub struct Wide<'a, M> {
    parts: Parts<'a, M>,
    /// Places of objects that no block holds: planes, and those with odd numbers.
    loose: Vec<u32>,
    tree: AnyTree,
    search: Search,
    /// Whether the lanes take every ray.
    takes_any_ray: bool,
    has_cuboids: bool,
}

/// A tree, and the instructions that it is for.
#[derive(Debug)]
enum AnyTree {
    Eight(Level, Tree<8>),
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    Sixteen(Avx512, Tree<16>),
}

/// Evaluates `$call` with the tree, a token and the way to search, compiled for them.
macro_rules! with_tree {
    ($wide:expr, |$tree:ident, $simd:ident, $search:ident| $call:expr) => {
        match $wide.search {
            Search::Spheres => with_tree!(Spheres, $wide, |$tree, $simd, $search| $call),
            Search::Blocks => with_tree!(Blocks, $wide, |$tree, $simd, $search| $call),
            Search::SolidBoxes => with_tree!(SolidBoxes, $wide, |$tree, $simd, $search| $call),
            Search::Boxes => with_tree!(Boxes, $wide, |$tree, $simd, $search| $call),
        }
    };
    ($kind:ident, $wide:expr, |$tree:ident, $simd:ident, $search:ident| $call:expr) => {{
        const $search: u8 = Search::$kind as u8;
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
    }};
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
        let (items, loose) = blocks::items(&parts);
        let tree = AnyTree::new(&parts, items, level, flat);
        Self {
            parts,
            loose,
            search: tree.search(),
            takes_any_ray: tree.takes_any_ray(),
            has_cuboids: !parts.cuboids.objects.is_empty(),
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

    fn search(&self) -> Search {
        match self {
            Self::Eight(_, tree) => tree.search(),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Sixteen(_, tree) => tree.search(),
        }
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

    /// The object that a ray leaves, if it is one of these.
    #[inline(always)]
    fn left(&self, ray: &Ray, first: usize) -> u32 {
        match ray.departure {
            Some(departure) if departure.object.wrapping_sub(first) < self.parts.len() => {
                (departure.object - first) as u32
            }
            _ => u32::MAX,
        }
    }

    /// Whether the lanes give the kernels' own answer.
    #[inline(always)]
    fn takes<P: Math>(&self, ray: &Ray) -> bool {
        TypeId::of::<P>() == TypeId::of::<Exact>() && (self.takes_any_ray || self.takes_this(ray))
    }

    #[inline(always)]
    fn takes_this(&self, ray: &Ray) -> bool {
        // Boxes are met by products with reciprocals, which are not to be infinite times zero.
        const LEAST: f32 = 4.0 / f32::MAX;
        let invertible = |x: f32| x == 0.0 || x.abs() > LEAST;
        let d = ray.direction;
        is_regular(ray)
            && (!self.has_cuboids || invertible(d.x) && invertible(d.y) && invertible(d.z))
    }

    /// Objects that the lanes leave out: those in no block, and the one that the ray leaves.
    #[inline(always)]
    fn apart(&self, left: u32) -> impl Iterator<Item = u32> {
        let left = (left != u32::MAX).then_some(left);
        left.into_iter().chain(self.loose.iter().copied())
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
        let left = self.left(ray, first);
        let mut nearest = Nearest::before(ray);
        for object in self.apart(left) {
            if let Some(t) = self.parts.intersect::<P>(ray, object as usize, first) {
                nearest.offer(t, object);
            }
        }
        with_tree!(self, |tree, simd, SEARCH| tree.nearest::<_, SEARCH>(
            simd,
            ray,
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
        let left = self.left(ray, first);
        self.apart(left)
            .any(|it| self.parts.intersect::<P>(ray, it as usize, first).is_some())
            || with_tree!(self, |tree, simd, SEARCH| tree
                .blocks::<_, SEARCH>(simd, ray, left))
    }

    #[inline]
    fn absorbs<P: Math>(&self, ray: &Ray, first: usize, light: &mut Transmittance) -> bool {
        if !self.takes::<P>(ray) {
            return self.parts.kinds.absorbs::<P>(ray, first, light);
        }
        let left = self.left(ray, first);
        let parts = &self.parts;
        self.apart(left)
            .any(|it| parts.absorbs::<P>(ray, it as usize, first, light))
            || with_tree!(self, |tree, simd, SEARCH| tree
                .absorbs::<_, _, P, SEARCH>(simd, parts, ray, left, first, light))
    }
}
