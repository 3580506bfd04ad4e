//! A scene's blocks and the hierarchy over them; none where there are few.

use core::hint::black_box;

use fearless_simd::{Simd, SimdBase, SimdCombine, f32x4, f32x8, f32x16};
use heapless::Vec as Stack;
use whitted::{Finish, Ray, Vec3};

use super::beams::Set;
use super::blocks::{Blocks, Found, Kind};
use super::bounds::ROUNDING;
use super::build::{Binary, Collapse, Item, Method, binary};
use super::lanes::Lanes;
use super::nodes::{Child, Content, Node, NodeTerms};
use super::parts::Parts;
use super::rays::{Needs, RayTerms};

/// Up to so many objects, boxes cost more than they spare.
pub const FLAT: usize = 64;

/// How many boxes may wait on the way down a tree.
pub const WAITING: usize = 384;

/// How many objects fit into a leaf. Of more lanes more would lie idle: most leaves hold fewer.
pub const LEAF: usize = 8;

/// The vector whose lanes are as many as a tree's nodes have children.
pub trait Vector<S: Simd> {
    /// The vector.
    type Lanes: Lanes<S>;

    /// A vector of parts; as many as it has.
    fn join(fours: [f32x4<S>; 4]) -> Self::Lanes;
}

impl<S: Simd> Vector<S> for Tree<8> {
    type Lanes = f32x8<S>;

    #[inline(always)]
    fn join([a, b, ..]: [f32x4<S>; 4]) -> Self::Lanes {
        a.combine(b)
    }
}

impl<S: Simd> Vector<S> for Tree<16> {
    type Lanes = f32x16<S>;

    #[inline(always)]
    fn join([a, b, c, d]: [f32x4<S>; 4]) -> Self::Lanes {
        a.combine(b).combine(c.combine(d))
    }
}

/// The vector of as many lanes as a tree's nodes have children.
type Many<S, T> = <T as Vector<S>>::Lanes;

/// Blocks of objects below nodes of `N` children.
#[derive(Clone, Debug)]
pub struct Tree<const N: usize> {
    nodes: Vec<Node<N>>,
    /// Its leaves.
    blocks: Blocks<LEAF>,
    /// All there is where there is no hierarchy: few blocks, and full ones.
    flat: Blocks<N>,
    /// A bit for each [`Kind`] of which there is a flat block.
    flat_kinds: u16,
    needs: Needs,
    /// How many coordinates of its origin a ray's hits may lie outside the boxes.
    slack: f32,
    extent: Extent,
}

/// What lies round all of a tree's boxes.
#[derive(Clone, Copy, Debug)]
pub struct Extent {
    pub bounds: [Vec3; 2],
    /// How far from it along a ray a hit may be reported.
    pub spread: f32,
}

/// Numbers that no two lines of a cache share.
#[repr(align(64))]
struct Aligned<const N: usize>([f32; N]);

/// The nearest hit so far.
#[derive(Clone, Copy, Debug)]
pub struct Nearest {
    /// Its distance; before there is one, where the ray ends.
    pub t: f32,
    /// Its place in the geometry; before there is one, `u32::MAX`.
    pub object: u32,
}

impl Nearest {
    /// Before the first hit of a ray that ends there.
    #[inline(always)]
    pub fn before(end: f32) -> Self {
        Self {
            t: end,
            object: u32::MAX,
        }
    }

    /// Before which distance hits are of interest: one as near may be earlier in the geometry.
    #[inline(always)]
    pub fn limit(&self) -> f32 {
        if self.object == u32::MAX {
            self.t
        } else {
            // Of a finite number above zero, the next one.
            f32::from_bits(self.t.to_bits() + 1)
        }
    }

    /// Takes a hit before the limit that is nearer, or as near and earlier in the geometry.
    #[inline(always)]
    pub fn offer(&mut self, t: f32, object: u32) {
        if t < self.t || (t == self.t && object < self.object) {
            *self = Self { t, object };
        }
    }
}

impl<const N: usize> Tree<N> {
    /// Puts items into blocks, and blocks into a tree where there are more than `flat`.
    pub fn new<M: Finish>(parts: &Parts<'_, M>, mut items: Vec<Item>, flat: usize) -> Self {
        let mut tree = Self {
            nodes: Vec::new(),
            blocks: Blocks::default(),
            flat: Blocks::default(),
            flat_kinds: 0,
            needs: Needs::default(),
            slack: ROUNDING * (1.0 + parts.steepness()),
            extent: Extent {
                bounds: [Vec3::INFINITY, Vec3::NEG_INFINITY],
                spread: 0.0,
            },
        };
        // A kernel that takes one object costs as much as one that takes a vector of them.
        let others = items.iter().filter(|it| it.kind == Kind::Other).count();
        if items.len() + others * (N - 1) <= flat {
            items.sort_unstable_by_key(|item| (item.kind as u8, item.object));
            for items in items.chunk_by_mut(|a, b| a.kind == b.kind) {
                for items in items.chunks_mut(Blocks::<N>::capacity(items[0].kind)) {
                    tree.flat.push(parts, items);
                }
            }
        } else {
            for method in [Method::Area, Method::Halves] {
                let nodes = binary(&mut items, Blocks::<LEAF>::capacity, method);
                tree.nodes.clear();
                tree.blocks = Blocks::default();
                if tree.widen(parts, &mut items, &nodes) {
                    break;
                }
            }
        }
        for kind in Kind::ALL {
            tree.flat_kinds |= u16::from(tree.flat.len(kind) > 0) << kind as u8;
        }
        if let Some(root) = tree.nodes.first() {
            tree.extent = Extent {
                bounds: root.bounds(),
                spread: root.spread().iter().copied().fold(0.0, f32::max),
            };
        }
        tree.needs = if tree.nodes.is_empty() {
            tree.flat.needs()
        } else {
            tree.blocks.needs()
        };
        tree
    }

    /// Makes nodes of a binary tree. False where that is so deep that a ray might not find its way.
    fn widen<M: Finish>(
        &mut self,
        parts: &Parts<'_, M>,
        items: &mut [Item],
        binary: &[Binary],
    ) -> bool {
        let collapse = Collapse::<N>::new(binary);
        let spreads = spreads(items, binary);
        // A node to be filled, which binary one it stands for, and how many boxes may wait when a ray
        // meets it.
        let mut pending = vec![(0, 0, 0)];
        let mut below = Vec::with_capacity(N);
        self.nodes.push(Node::EMPTY);
        while let Some((place, root, waiting)) = pending.pop() {
            below.clear();
            collapse.children(root, &mut below);
            // Leaves last, which is where those begin to look that any hit will do for.
            below.sort_by_key(|&root| binary[root].count);
            let waiting = waiting + below.len() - 1;
            if waiting >= WAITING {
                return false;
            }
            for (lane, &root) in below.iter().enumerate() {
                let Binary {
                    bounds,
                    first,
                    count,
                } = binary[root];
                let child = if count == 0 {
                    let child = self.nodes.len();
                    self.nodes.push(Node::EMPTY);
                    pending.push((child, root, waiting));
                    Child::node(child)
                } else {
                    let items = &mut items[first as usize..(first + count) as usize];
                    let kind = items[0].kind;
                    Child::block(kind, self.blocks.push(parts, items))
                };
                self.nodes[place].set(lane, &bounds, spreads[root], child);
            }
        }
        true
    }

    /// A node, by its place.
    #[inline(always)]
    pub fn node(&self, index: usize) -> &Node<N> {
        &self.nodes[index]
    }

    /// The blocks of every kind.
    #[inline(always)]
    pub fn all_blocks(&self) -> &Blocks<LEAF> {
        &self.blocks
    }

    /// All there is where there is no hierarchy.
    #[inline(always)]
    pub fn flat_blocks(&self) -> &Blocks<N> {
        &self.flat
    }

    /// Which terms of a ray the blocks ask for.
    #[inline(always)]
    pub fn needs(&self) -> Needs {
        self.needs
    }

    /// How many coordinates of its origin a ray's hits may lie outside the boxes.
    #[inline(always)]
    pub fn slack(&self) -> f32 {
        self.slack
    }

    /// What lies round all boxes.
    #[inline(always)]
    pub fn extent(&self) -> &Extent {
        &self.extent
    }

    /// Whether all in the boxes is met within them: there are no outlines.
    #[inline(always)]
    pub fn is_solid(&self) -> bool {
        !self.needs.turned
    }

    /// How to look for what a ray meets.
    fn search(&self) -> Search {
        let others = |kind: &Kind| *kind != Kind::Sphere && self.flat.len(*kind) > 0;
        if !self.nodes.is_empty() {
            if self.is_solid() {
                Search::SolidBoxes
            } else {
                Search::Boxes
            }
        } else if Kind::ALL.iter().any(others) {
            Search::Blocks
        } else {
            Search::Spheres
        }
    }

    /// Whether every ray gets the kernels' own answer: there are no boxes, and no kernel of those
    /// whose lanes presuppose numbers of common size.
    fn takes_any_ray(&self) -> bool {
        self.nodes.is_empty() && self.needs == Needs::default()
    }

    /// Calls `visit` with what each block finds that a ray meets before a limit, which is what `visit`
    /// returned last, or to begin with `limit`; ends where it returns `None`, and then is true.
    ///
    /// `SEARCH` is [`Self::search`], `ORDERED` says whether the limit will fall.
    #[inline(always)]
    fn visit<S: Simd, const SEARCH: u8, const ORDERED: bool>(
        &self,
        simd: S,
        ray: &Ray,
        mut limit: f32,
        mut visit: impl Visit,
    ) -> bool
    where
        Self: Vector<S>,
    {
        let terms = RayTerms::new(ray, self.needs);
        if SEARCH == Search::Spheres as u8 || SEARCH == Search::Blocks as u8 {
            macro_rules! each {
                ($kind:ident, $shelf:ident, $block:ident => $meeting:expr) => {
                    // Of most kinds there is none.
                    if self.flat_kinds & 1 << Kind::$kind as u8 != 0 {
                        let shelf = &self.flat.$shelf;
                        for ($block, labels) in shelf.blocks.iter().zip(&shelf.labels) {
                            let found: Found<'_, Many<S, Self>, N> =
                                Found::new($meeting, core::slice::from_ref(labels), 0);
                            match visit.visit::<S, _, N>(found, limit) {
                                Some(nearer) => limit = nearer,
                                None => return true,
                            }
                        }
                    }
                };
            }
            each!(Sphere, spheres, it => it.meet::<S, _, false>(simd, &terms, limit));
            if SEARCH == Search::Blocks as u8 {
                each!(HollowSphere, hollow_spheres, it => it.meet::<S, _, true>(simd, &terms, limit));
                each!(Triangle, triangles, it => it.meet(simd, &terms, limit));
                each!(Quad, quads, it => it.meet(simd, &terms, limit));
                each!(Cuboid, cuboids, it => it.meet(simd, &terms, limit));
                each!(Frustum, frusta, it => it.meet::<S, _, false>(simd, &terms, limit));
                each!(HollowFrustum, hollow_frusta, it => it.meet::<S, _, true>(simd, &terms, limit));
                for kind in [Kind::Outline, Kind::Other] {
                    for index in 0..self.flat.len(kind) {
                        let found: Found<'_, Many<S, Self>, N> =
                            self.flat.meet(simd, kind, index, &terms, limit);
                        match visit.visit::<S, _, N>(found, limit) {
                            Some(nearer) => limit = nearer,
                            None => return true,
                        }
                    }
                }
            }
            return false;
        }
        let boxes = NodeTerms::new(ray, self.slack);
        self.descend::<S, SEARCH, ORDERED>(simd, 0, &terms, &boxes, limit, visit)
    }

    /// As `visit`, from a node down the hierarchy.
    #[inline(always)]
    pub fn descend<S: Simd, const SEARCH: u8, const ORDERED: bool>(
        &self,
        simd: S,
        node: usize,
        terms: &RayTerms<'_>,
        boxes: &NodeTerms,
        limit: f32,
        visit: impl Visit,
    ) -> bool
    where
        Self: Vector<S>,
    {
        // The terms stay in memory, from where lanes are loaded for nothing: in vectors, they would take
        // the registers of the boxes' terms.
        let terms = black_box(terms);
        if ORDERED {
            self.descend_nearest::<S, SEARCH>(simd, node, terms, boxes, limit, visit)
        } else {
            self.descend_any::<S, SEARCH>(simd, node, terms, boxes, limit, visit)
        }
    }

    /// As `descend`, where limits do not fall.
    #[inline(always)]
    fn descend_any<S: Simd, const SEARCH: u8>(
        &self,
        simd: S,
        mut node: usize,
        terms: &RayTerms<'_>,
        boxes: &NodeTerms,
        limit: f32,
        mut visit: impl Visit,
    ) -> bool
    where
        Self: Vector<S>,
    {
        // Nodes on the way down, and a bit for each of their boxes that is still to be looked into.
        let mut waiting = Stack::<(usize, u32), WAITING>::new();
        let start = &self.nodes[node];
        let (_, mut rest) = start.meet::<S, Many<S, Self>, SEARCH>(simd, boxes, limit);
        loop {
            if rest == 0 {
                match waiting.pop() {
                    None => return false,
                    Some(above) => (node, rest) = above,
                }
            }
            let lane = rest.ilog2() as usize % N;
            rest &= !(1 << lane);
            match self.nodes[node].children[lane].content() {
                Content::Node(index) => {
                    let below = &self.nodes[index];
                    let (_, met) = below.meet::<S, Many<S, Self>, SEARCH>(simd, boxes, limit);
                    if met != 0 {
                        if rest != 0 {
                            let fits = waiting.push((node, rest)).is_ok();
                            debug_assert!(fits, "the tree was built for fewer");
                        }
                        (node, rest) = (index, met);
                    }
                }
                Content::Block(kind, index) => {
                    let found: Found<'_, f32x8<S>, LEAF> =
                        self.blocks.meet(simd, kind, index, terms, limit);
                    if visit.visit::<S, _, LEAF>(found, limit).is_none() {
                        return true;
                    }
                }
            }
        }
    }

    /// As `descend`, where they do.
    #[inline(always)]
    fn descend_nearest<S: Simd, const SEARCH: u8>(
        &self,
        simd: S,
        node: usize,
        terms: &RayTerms<'_>,
        boxes: &NodeTerms,
        mut limit: f32,
        mut visit: impl Visit,
    ) -> bool
    where
        Self: Vector<S>,
    {
        let mut waiting = Stack::<i64, WAITING>::new();
        let mut next = Child::node(node);
        loop {
            match next.content() {
                Content::Node(index) => {
                    let node = &self.nodes[index];
                    let (entry, mut met) =
                        node.meet::<S, Many<S, Self>, SEARCH>(simd, boxes, limit);
                    if met != 0 {
                        let mut entries = Aligned([0.0; N]);
                        entry.store_slice(&mut entries.0);
                        let entries = &entries.0;
                        let mut take = || {
                            let lane = met.trailing_zeros() as usize % N;
                            met &= met - 1;
                            (node.children[lane].at(entries[lane]), met)
                        };
                        // The nearest is next, the others wait, the nearer on top. No branch depends on
                        // which is nearer: nothing could foresee it.
                        let (mut nearest, mut rest) = take();
                        let first = waiting.len();
                        while rest != 0 {
                            let mut place;
                            (place, rest) = take();
                            for other in &mut waiting[first..] {
                                (*other, place) = ((*other).max(place), (*other).min(place));
                            }
                            (place, nearest) = (place.max(nearest), place.min(nearest));
                            let fits = waiting.push(place).is_ok();
                            debug_assert!(fits, "the tree was built for fewer");
                        }
                        next = Child::of(nearest);
                        continue;
                    }
                }
                Content::Block(kind, index) => {
                    let found: Found<'_, f32x8<S>, LEAF> =
                        self.blocks.meet(simd, kind, index, terms, limit);
                    match visit.visit::<S, _, LEAF>(found, limit) {
                        Some(nearer) => {
                            if nearer < limit {
                                // What is too far now goes at once, and without a branch for each.
                                let last = Child::last_at(nearer);
                                let mut kept = 0;
                                for i in 0..waiting.len() {
                                    let place = waiting[i];
                                    waiting[kept] = place;
                                    kept += usize::from(place <= last);
                                }
                                waiting.truncate(kept);
                            }
                            limit = nearer;
                        }
                        None => return true,
                    }
                }
            }
            match waiting.pop().map(Child::of) {
                None => return false,
                Some(child) => next = child,
            }
        }
    }

    /// Casts a ray; `left` is the object that it leaves, which is not met.
    #[inline(always)]
    pub fn nearest<S: Simd, const SEARCH: u8>(
        &self,
        simd: S,
        ray: &Ray,
        left: u32,
        nearest: &mut Nearest,
    ) where
        Self: Vector<S>,
    {
        let limit = nearest.limit();
        let visit = TakeNearest { left, nearest };
        self.visit::<S, SEARCH, true>(simd, ray, limit, visit);
    }

    /// Calls `absorb` with each object but `left` that the ray meets, until it is true or the object
    /// opaque; whether that was so.
    #[inline(always)]
    pub fn absorbs<S: Simd, const SEARCH: u8>(
        &self,
        simd: S,
        ray: &Ray,
        left: u32,
        absorb: &mut dyn FnMut(u32) -> bool,
    ) -> bool
    where
        Self: Vector<S>,
    {
        let visit = UntilDark { left, absorb };
        self.visit::<S, SEARCH, false>(simd, ray, ray.t_max, visit)
    }

    /// What holds for every ray.
    pub fn about(&self) -> About {
        About {
            search: self.search(),
            takes_any_ray: self.takes_any_ray(),
            bytes: [
                self.nodes.len() * size_of::<Node<N>>(),
                self.blocks.bytes() + self.flat.bytes(),
            ],
            bounds: (!self.nodes.is_empty()).then_some(self.extent.bounds),
        }
    }
}

/// Of each node of a binary tree, how far from its box a hit may be reported.
fn spreads(items: &[Item], nodes: &[Binary]) -> Vec<f32> {
    let mut spreads = vec![0.0_f32; nodes.len()];
    // Children stand behind their parents.
    for (place, node) in nodes.iter().enumerate().rev() {
        let (first, count) = (node.first as usize, node.count as usize);
        spreads[place] = if count == 0 {
            spreads[first].max(spreads[first + 1])
        } else {
            let spreads = items[first..first + count].iter().map(Item::spread);
            spreads.fold(0.0, f32::max)
        };
    }
    spreads
}

/// What of a tree does not depend on how wide it is.
pub struct About {
    pub search: Search,
    pub takes_any_ray: bool,
    /// Of nodes and of blocks.
    pub bytes: [usize; 2],
    /// The box round all that is in boxes, if there are any.
    pub bounds: Option<[Vec3; 2]>,
}

/// How to look for what a ray meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Search {
    /// There are few objects, all spheres: all are tested.
    Spheres,
    /// There are few objects: all are tested.
    Blocks,
    /// There are boxes, and what is in them is met within them.
    SolidBoxes,
    /// There are boxes, round outlines too.
    Boxes,
}

/// What is done with what a block finds.
pub trait Visit {
    /// Up to which distance more is asked for; `None` ends the search.
    fn visit<S: Simd, V: Lanes<S>, const N: usize>(
        &mut self,
        found: Found<'_, V, N>,
        limit: f32,
    ) -> Option<f32>;
}

struct TakeNearest<'a> {
    left: u32,
    nearest: &'a mut Nearest,
}

impl Visit for TakeNearest<'_> {
    #[inline(always)]
    fn visit<S: Simd, V: Lanes<S>, const N: usize>(
        &mut self,
        found: Found<'_, V, N>,
        limit: f32,
    ) -> Option<f32> {
        let mut met = without(&found, self.left);
        if met == 0 {
            return Some(limit);
        }
        let mut t = [0.0; N];
        found.t.store_slice(&mut t);
        while met != 0 {
            let lane = met.trailing_zeros() as usize % N;
            met &= met - 1;
            self.nearest.offer(t[lane], found.labels().objects[lane]);
        }
        Some(self.nearest.limit())
    }
}

struct UntilDark<'a> {
    left: u32,
    absorb: &'a mut dyn FnMut(u32) -> bool,
}

impl Visit for UntilDark<'_> {
    #[inline(always)]
    fn visit<S: Simd, V: Lanes<S>, const N: usize>(
        &mut self,
        found: Found<'_, V, N>,
        limit: f32,
    ) -> Option<f32> {
        let met = without(&found, self.left);
        if met == 0 {
            return Some(limit);
        }
        let labels = found.labels();
        let dark = met & labels.opaque != 0 || absorbs_any(met, &labels.objects, self.absorb);
        (!dark).then_some(limit)
    }
}

/// Whether any of the objects of a set of lanes takes the last of a light.
///
/// No vector survives a call: the compiler is told that this one is rare, lest it keeps in memory what
/// the search could keep in registers.
#[cold]
#[inline(never)]
fn absorbs_any(lanes: u32, objects: &[u32], absorb: &mut dyn FnMut(u32) -> bool) -> bool {
    Set(lanes).any(|lane| absorb(objects[lane]))
}

/// The lanes that are met, without the object that the ray leaves.
#[inline(always)]
pub fn without<V, const N: usize>(found: &Found<'_, V, N>, left: u32) -> u32 {
    let mut met = found.lanes;
    if met != 0 && left != u32::MAX {
        for (lane, &object) in found.labels().objects.iter().enumerate() {
            met &= !(u32::from(object == left) << lane);
        }
    }
    met
}
