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
//! numbers are out of all proportion, and a ray whose numbers are, are left to the kernels themselves, and
//! so are quadrics and tori, each in a box of its own.

#![forbid(unsafe_code)]

/// Evaluates `$call` with the tree, a token and perhaps the way to search, compiled for them.
macro_rules! with_tree {
    ($any:expr, |$tree:ident, $simd:ident| $call:expr) => {
        match $any {
            #[cfg(target_arch = "x86_64")]
            $crate::wide::AnyTree::Avx512(token, $tree) => with_tree!(token, |$simd| $call),
            #[cfg(target_arch = "x86_64")]
            $crate::wide::AnyTree::Avx2(token, $tree) => with_tree!(token, |$simd| $call),
            #[cfg(target_arch = "x86_64")]
            $crate::wide::AnyTree::Sse2(token, $tree) => {
                $crate::wide::apart(|| with_tree!(token, |$simd| $call))
            }
            #[cfg(not(target_arch = "x86_64"))]
            $crate::wide::AnyTree::Other(level, $tree) => {
                fearless_simd::dispatch!(*level, $simd => $call)
            }
        }
    };
    ($token:ident, |$simd:ident| $call:expr) => {{
        let $simd = *$token;
        fearless_simd::Simd::vectorize(
            $simd,
            #[inline(always)]
            || $call,
        )
    }};
    ($any:expr, $search:expr, |$tree:ident, $simd:ident, $way:ident| $call:expr) => {
        match $search {
            Search::Spheres => with_tree!(@ Spheres, $any, |$tree, $simd, $way| $call),
            Search::Blocks => with_tree!(@ Blocks, $any, |$tree, $simd, $way| $call),
            Search::SolidBoxes => with_tree!(@ SolidBoxes, $any, |$tree, $simd, $way| $call),
            Search::Boxes => with_tree!(@ Boxes, $any, |$tree, $simd, $way| $call),
        }
    };
    (@ $kind:ident, $any:expr, |$tree:ident, $simd:ident, $way:ident| $call:expr) => {{
        const $way: u8 = Search::$kind as u8;
        with_tree!($any, |$tree, $simd| $call)
    }};
}

mod across;
#[cfg(test)]
mod agreement;
mod around;
mod beams;
mod blocks;
mod bounds;
mod build;
mod cuboid;
mod frustum;
mod group;
mod lanes;
pub mod lockstep;
mod nodes;
mod order;
mod outline;
mod packet;
mod pairs;
mod parts;
mod paths;
mod power;
mod rays;
mod sphere;
mod tree;

use core::any::TypeId;

#[cfg(target_arch = "x86_64")]
use fearless_simd::x86::{Avx2, Avx512, Sse2};
use fearless_simd::{Level, Simd, SimdMask};
use whitted::math::Passage;
use whitted::{Candidates, Departure, Exact, Finish, Geometry, Math, Ray, Side, Vec3};

pub use parts::{Kinds, Slice};

use across::{Few, PLACES};
use beams::{Beams, Rows, Set};
use lanes::Lanes;
use nodes::is_regular;
use parts::Parts;
use rays::INVERTIBLE;
use tree::{About, FLAT, Nearest, Search, Tree, Vector};

/// Of so many bytes caches soon hold what rays meet, in whatever order they come.
const NEAR: usize = 2 << 20;

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
    /// Whether an object may be met again by a ray that leaves it outwards.
    returns_outside: bool,
    /// Whether light may weaken in any object: all in which it does are loose.
    absorbs: bool,
    /// Where there are boxes, the one round all of them.
    bounds: Option<[Vec3; 2]>,
    /// Whether boxes and objects take more memory than is near.
    is_far: bool,
    /// Where all objects are tested, and lanes give the kernels' own answer about all.
    few: Option<Few<'a, M>>,
}

/// What lanes leave out of rays: objects in no block, and those that rays leave.
struct Departures<const N: usize> {
    /// A bit a lane: which leave a sphere through its other side, before their end, and meet no other of
    /// these objects.
    across: u32,
    /// Of each of those, where.
    t: [f32; N],
    /// Which may meet others, a bit a lane.
    others: u32,
}

/// A tree, and the instructions that it is for.
#[derive(Debug)]
enum AnyTree {
    #[cfg(target_arch = "x86_64")]
    Avx512(Avx512, Tree<16>),
    #[cfg(target_arch = "x86_64")]
    Avx2(Avx2, Tree<8>),
    /// What every such machine has.
    #[cfg(target_arch = "x86_64")]
    Sse2(Sse2, Tree<8>),
    #[cfg(not(target_arch = "x86_64"))]
    Other(Level, Tree<8>),
}

impl<'a, M: Finish + Sync> Wide<'a, M> {
    /// Builds blocks and hierarchy, for the best instructions that this machine has.
    ///
    /// # Panics
    ///
    /// As [`with_level`](Self::with_level).
    pub fn new(kinds: Kinds<'a, M>) -> Self {
        Self::with_level(kinds, Level::new())
    }

    /// Builds for instructions of choice.
    ///
    /// # Panics
    ///
    /// Where there are 2^23 objects or more.
    pub fn with_level(kinds: Kinds<'a, M>, level: Level) -> Self {
        Self::with(kinds, level, FLAT)
    }

    fn with(kinds: Kinds<'a, M>, level: Level, flat: usize) -> Self {
        let parts = Parts::new(kinds);
        assert!(parts.len() < PLACES, "too many objects");
        let (items, loose) = blocks::items(&parts);
        let tree = AnyTree::new(&parts, items, level, flat);
        let about = tree.about();
        let all_tested = matches!(about.search, Search::Spheres | Search::Blocks);
        let few = all_tested
            && loose.len() == parts.planes.objects.len()
            && parts.quadrics.first == parts.len();
        Self {
            few: few.then(|| Few::new(&parts)),
            returns_outside: (0..parts.len()).any(|it| !parts.is_left_for_good(it, Side::Outside)),
            absorbs: loose.iter().any(|&it| !parts.is_clear(it as usize)),
            parts,
            loose,
            search: about.search,
            takes_any_ray: about.takes_any_ray,
            is_far: about.bytes.iter().sum::<usize>() > NEAR,
            bounds: about.bounds,
            has_cuboids: !parts.cuboids.objects.is_empty(),
            tree,
        }
    }
}

impl AnyTree {
    #[cfg(target_arch = "x86_64")]
    fn new<M: Finish>(
        parts: &Parts<'_, M>,
        items: Vec<build::Item>,
        level: Level,
        flat: usize,
    ) -> Self {
        if let Some(token) = level.as_avx512() {
            Self::Avx512(token, Tree::new(parts, items, flat))
        } else if let Some(token) = level.as_avx2() {
            Self::Avx2(token, Tree::new(parts, items, flat))
        } else {
            let token = level.as_sse2().expect("x86-64 has SSE2");
            Self::Sse2(token, Tree::new(parts, items, flat))
        }
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn new<M: Finish>(
        parts: &Parts<'_, M>,
        items: Vec<build::Item>,
        level: Level,
        flat: usize,
    ) -> Self {
        Self::Other(level, Tree::new(parts, items, flat))
    }
}

/// Calls what would be inlined, as SSE2 needs no function of its own: the frame of a way down a tree
/// would be every query's.
#[cfg(target_arch = "x86_64")]
#[inline(never)]
fn apart<R>(call: impl FnOnce() -> R) -> R {
    call()
}

impl AnyTree {
    /// As [`Tree::nearest`]. Inlined, as among few objects a call more is half of what a ray costs.
    #[inline(always)]
    fn nearest(&self, search: Search, ray: &Ray, left: u32, nearest: &mut Nearest) {
        with_tree!(self, search, |tree, simd, SEARCH| tree
            .nearest::<_, SEARCH>(simd, ray, left, nearest));
    }

    /// As [`Tree::absorbs`].
    fn absorbs(
        &self,
        search: Search,
        ray: &Ray,
        left: u32,
        absorb: &mut dyn FnMut(u32) -> bool,
    ) -> bool {
        with_tree!(self, search, |tree, simd, SEARCH| tree
            .absorbs::<_, SEARCH>(simd, ray, left, absorb))
    }

    fn about(&self) -> About {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(_, tree) => tree.about(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(_, tree) | Self::Sse2(_, tree) => tree.about(),
            #[cfg(not(target_arch = "x86_64"))]
            Self::Other(_, tree) => tree.about(),
        }
    }
}

/// The levels of SIMD instructions that this machine has, by name, the least first.
pub fn levels() -> Vec<(&'static str, Level)> {
    let best = Level::new();
    #[cfg(target_arch = "x86_64")]
    let levels = [
        best.as_sse2().map(|it| ("SSE2", Level::Sse2(it))),
        best.as_avx2().map(|it| ("AVX2", Level::Avx2(it))),
        best.as_avx512().map(|it| ("AVX-512", Level::Avx512(it))),
    ];
    #[cfg(not(target_arch = "x86_64"))]
    let levels = [Some(("baseline", best))];
    levels.into_iter().flatten().collect()
}

impl<M> Wide<'_, M> {
    /// The bytes of the nodes and of the blocks, beside the objects themselves.
    pub fn bytes(&self) -> [usize; 2] {
        self.tree.about().bytes
    }

    /// The object that a ray leaves, if it is one of these, and the side.
    #[inline(always)]
    fn left(&self, ray: &Ray, first: usize) -> (u32, Side) {
        match ray.departure {
            Some(Departure { object, side }) if object.wrapping_sub(first) < self.parts.len() => {
                ((object - first) as u32, side)
            }
            _ => (u32::MAX, Side::Outside),
        }
    }

    /// Whether the lanes give the kernels' own answer.
    #[inline(always)]
    fn takes<P: Math>(&self, ray: &Ray) -> bool {
        TypeId::of::<P>() == TypeId::of::<Exact>() && (self.takes_any_ray || self.takes_this(ray))
    }

    #[inline(always)]
    fn takes_this(&self, ray: &Ray) -> bool {
        if self.has_cuboids {
            // Zero, or large: of whole numbers one comparison, and no branch. NaN is not regular.
            let size = |x: f32| x.abs().to_bits();
            let invertible = |x: f32| size(x).wrapping_sub(1) >= INVERTIBLE.to_bits();
            let d = ray.direction;
            if !(invertible(d.x) & invertible(d.y) & invertible(d.z)) {
                return false;
            }
        }
        is_regular(ray)
    }

    /// Whether there are objects that the lanes leave out: those in no block, and the one that the ray
    /// leaves on this side.
    #[inline(always)]
    fn has_apart(&self, left: u32, side: Side) -> bool {
        !self.loose.is_empty()
            || left != u32::MAX && !self.parts.is_left_for_good(left as usize, side)
    }

    /// A bit a lane: which rays may meet the object again that they leave.
    #[inline(always)]
    fn returning<const N: usize>(&self, beams: &Beams<N>) -> u32 {
        let all = u32::MAX >> (32 - N);
        let lanes = if self.returns_outside {
            all
        } else {
            all & beams.inward
        };
        Set(lanes).fold(0, |returning, lane| {
            let left = beams.left[lane];
            let returns =
                left != u32::MAX && !(self.parts).is_left_for_good(left as usize, beams.side(lane));
            returning | u32::from(returns) << lane
        })
    }

    /// What lanes leave out of some rays.
    #[inline(always)]
    fn departures<S: Simd, V: Lanes<S>, const N: usize>(
        &self,
        simd: S,
        beams: &Beams<N>,
        active: u32,
    ) -> Departures<N>
    where
        Tree<N>: Vector<S, Lanes = V>,
    {
        let mut departures = Departures {
            across: 0,
            t: [0.0; N],
            others: 0,
        };
        if !self.loose.is_empty() {
            departures.others = active;
            return departures;
        }
        let returning = active & self.returning(beams);
        if returning == 0 {
            return departures;
        }
        let mut center = Rows::<N>::ZERO;
        let mut spheres = 0_u32;
        for lane in Set(returning) {
            if let Some(sphere) = self.parts.spheres.get(beams.left[lane] as usize) {
                spheres |= 1 << lane;
                center.set(lane, sphere.shape.center);
            }
        }
        departures.others = returning & !spheres;
        let (origin, direction) = (beams.origin.load::<S, V>(simd), beams.direction.load(simd));
        let t = sphere::across(simd, center.load(simd), origin, direction);
        let ends = V::from_slice(simd, &beams.end);
        let met = t.simd_gt(V::simd_from(simd, 0.0)) & t.simd_lt(ends);
        departures.across = met.to_bitmask() as u32 & spheres;
        t.store_slice(&mut departures.t);
        departures
    }

    /// These objects, each once.
    fn apart(&self, left: u32) -> impl Iterator<Item = u32> {
        let others = self.loose.iter().copied().filter(move |&it| it != left);
        (left != u32::MAX).then_some(left).into_iter().chain(others)
    }

    /// What a ray meets of these objects. Not inlined, nor are the next two: most rays have none, and what
    /// the kernels compute of a ray would be computed for all.
    #[inline(never)]
    fn nearest_apart(&self, ray: &Ray, first: usize, left: u32, nearest: &mut Nearest) {
        for object in self.apart(left) {
            if let Some(t) = self.parts.intersect::<Exact>(ray, object as usize, first) {
                nearest.offer(t, object);
            }
        }
    }

    /// Whether a ray meets any of these objects.
    #[inline(never)]
    fn blocks_apart(&self, ray: &Ray, first: usize, left: u32) -> bool {
        self.apart(left).any(|object| {
            let t = self.parts.intersect::<Exact>(ray, object as usize, first);
            t.is_some()
        })
    }

    /// What these objects take of a light; true where that is all.
    #[inline(never)]
    fn absorbs_apart<L: Passage>(&self, ray: &Ray, first: usize, left: u32, light: &mut L) -> bool
    where
        M: Finish,
    {
        let parts = &self.parts;
        self.apart(left)
            .any(|object| parts.absorbs::<Exact, L>(ray, object as usize, first, light))
    }
}

impl<M: Finish> Geometry for Wide<'_, M> {
    type Material = M;

    fn len(&self) -> usize {
        self.parts.len()
    }

    #[inline]
    fn nearest<P: Math>(&self, ray: &mut Ray, first: usize, among: Candidates) -> Option<usize> {
        if !self.takes::<P>(ray) {
            return self.parts.kinds.nearest::<P>(ray, first, among);
        }
        let (left, side) = self.left(ray, first);
        let mut nearest = Nearest::before(ray.t_max);
        if self.has_apart(left, side) {
            self.nearest_apart(ray, first, left, &mut nearest);
        }
        self.tree.nearest(self.search, ray, left, &mut nearest);
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
        let cuboids = &self.parts.cuboids;
        let place = object.wrapping_sub(first).wrapping_sub(cuboids.first);
        if let Some(it) = cuboids.objects.get(place) {
            return Some((cuboid::normal(&it.shape, ray, t), it.material));
        }
        self.parts.kinds.surface::<P>(ray, t, object, first)
    }

    #[inline]
    fn uv(&self, point: Vec3, object: usize, first: usize) -> (f32, f32) {
        self.parts.kinds.uv(point, object, first)
    }

    #[inline]
    fn blocks<P: Math>(&self, ray: &Ray, first: usize, among: Candidates) -> bool {
        if !self.takes::<P>(ray) {
            return self.parts.kinds.blocks::<P>(ray, first, among);
        }
        let (left, side) = self.left(ray, first);
        self.has_apart(left, side) && self.blocks_apart(ray, first, left)
            || self.tree.absorbs(self.search, ray, left, &mut |_| true)
    }

    #[inline]
    fn absorbs<P: Math, L: Passage>(
        &self,
        ray: &Ray,
        first: usize,
        among: Candidates,
        light: &mut L,
    ) -> bool {
        if !self.takes::<P>(ray) {
            return self.parts.kinds.absorbs::<P, L>(ray, first, among, light);
        }
        let (left, side) = self.left(ray, first);
        self.has_apart(left, side) && self.absorbs_apart(ray, first, left, light)
            || self.tree.absorbs(self.search, ray, left, &mut |object| {
                (self.parts).absorbs_met::<P, L>(ray, object as usize, first, light)
            })
    }
}
