//! A scene's blocks and the hierarchy over them; none where there are few.

use fearless_simd::{Simd, f32x8, f32x16};
use heapless::Vec as Stack;
use whitted::math::Transmittance;
use whitted::{Finish, Math, Ray};

use super::blocks::{Blocks, Found, Kind, Labels};
use super::bounds::ROUNDING;
use super::build::{Binary, Item, Method, binary, opened};
use super::lanes::Lanes;
use super::nodes::{Child, Content, Node, NodeRay};
use super::parts::Parts;
use super::rays::{Needs, RayLanes};

/// Up to so many objects, boxes cost more than they spare.
pub const FLAT: usize = 64;

/// How many boxes may wait on the way down a tree.
const WAITING: usize = 512;

/// The vector whose lanes are as many as a tree's blocks have.
pub trait Vector<S: Simd> {
    /// The vector.
    type Lanes: Lanes<S>;
}

impl<S: Simd> Vector<S> for Tree<8> {
    type Lanes = f32x8<S>;
}

impl<S: Simd> Vector<S> for Tree<16> {
    type Lanes = f32x16<S>;
}

/// Blocks of `N` objects below nodes of `N` children.
#[derive(Clone, Debug)]
pub struct Tree<const N: usize> {
    nodes: Vec<Node<N>>,
    blocks: Blocks<N>,
    needs: Needs,
    /// How many coordinates of its origin a ray's hits may lie outside the boxes.
    slack: f32,
}

/// The nearest hit so far.
#[derive(Clone, Copy, Debug)]
pub struct Nearest {
    /// Its distance; before there is one, the greatest that the ray admits.
    pub t: f32,
    /// Its place in the geometry; before there is one, `u32::MAX`.
    pub object: u32,
}

impl Nearest {
    /// Before the first hit.
    #[inline(always)]
    pub fn before(ray: &Ray) -> Self {
        Self {
            t: ray.t_max.next_down(),
            object: u32::MAX,
        }
    }

    /// Takes a hit that is nearer, or as near and earlier in the geometry.
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
            needs: Needs::default(),
            slack: ROUNDING * (1.0 + parts.steepness()),
        };
        if items.len() <= flat {
            items.sort_unstable_by_key(|item| (item.kind as u8, item.object));
            for items in items.chunk_by_mut(|a, b| a.kind == b.kind) {
                for items in items.chunks_mut(Blocks::<N>::capacity(items[0].kind)) {
                    tree.blocks.push(parts, items);
                }
            }
        } else {
            let capacity = |kind| Blocks::<N>::capacity(kind).min(LEAF);
            for method in [Method::Area, Method::Halves] {
                let nodes = binary(&mut items, capacity, method);
                tree.nodes.clear();
                tree.blocks = Blocks::default();
                if tree.widen(parts, &mut items, &nodes) {
                    break;
                }
            }
        }
        tree.needs = tree.blocks.needs();
        tree
    }

    /// Makes nodes of a binary tree. False where that is so deep that a ray might not find its way.
    fn widen<M: Finish>(
        &mut self,
        parts: &Parts<'_, M>,
        items: &mut [Item],
        binary: &[Binary],
    ) -> bool {
        // A node to be filled, what it is made of, and how many boxes may wait when a ray meets it.
        let mut pending = vec![(0, binary[0], 0)];
        self.nodes.push(Node::EMPTY);
        while let Some((place, node, waiting)) = pending.pop() {
            let open = opened(binary, &node, N);
            let waiting = waiting + open.len() - 1;
            if waiting >= WAITING {
                return false;
            }
            for (lane, below) in open.iter().enumerate() {
                let child = if below.count == 0 {
                    let child = self.nodes.len();
                    self.nodes.push(Node::EMPTY);
                    pending.push((child, *below, waiting));
                    Child::node(child)
                } else {
                    let first = below.first as usize;
                    let items = &mut items[first..first + below.count as usize];
                    let kind = items[0].kind;
                    Child::block(kind, self.blocks.push(parts, items))
                };
                self.nodes[place].set(lane, &below.bounds, child);
            }
        }
        true
    }

    /// Whether every ray gets the kernels' own answer: there are no boxes, and no kernel of those
    /// whose lanes presuppose numbers of common size.
    #[inline(always)]
    pub fn takes_any_ray(&self) -> bool {
        self.nodes.is_empty() && self.needs == Needs::default()
    }

    /// Casts a ray; `left` is the object that it leaves, which is not met.
    #[inline(always)]
    pub fn nearest<S: Simd>(&self, simd: S, ray: &Ray, left: u32, nearest: &mut Nearest)
    where
        Self: Vector<S>,
    {
        self.nearest_by::<S, <Self as Vector<S>>::Lanes>(simd, ray, left, nearest);
    }

    #[inline(always)]
    fn nearest_by<S: Simd, V: Lanes<S>>(
        &self,
        simd: S,
        ray: &Ray,
        left: u32,
        nearest: &mut Nearest,
    ) {
        let lanes = RayLanes::<V>::new(simd, ray, self.needs);
        if self.nodes.is_empty() {
            for kind in Kind::ALL {
                for index in 0..self.blocks.len(kind) {
                    let found = self.blocks.meet(simd, kind, index, ray, &lanes, nearest.t);
                    take(found, left, nearest);
                }
            }
            return;
        }
        let terms = NodeRay::<V>::new(simd, ray, self.slack);
        let mut waiting = Stack::<(f32, Child), WAITING>::new();
        let mut next = Child::node(0);
        loop {
            match next.content() {
                Content::Node(index) => {
                    let node = &self.nodes[index];
                    let limit = V::simd_from(simd, nearest.t);
                    let (entry, mut met) = node.meet(simd, &terms, limit);
                    if met != 0 {
                        if met & (met - 1) == 0 {
                            next = node.children[met.trailing_zeros() as usize % N];
                            continue;
                        }
                        let mut entries = [0.0; N];
                        entry.store_slice(&mut entries);
                        let start = waiting.len();
                        while met != 0 {
                            let lane = met.trailing_zeros() as usize % N;
                            met &= met - 1;
                            insert(&mut waiting, start, (entries[lane], node.children[lane]));
                        }
                    }
                }
                Content::Block(kind, index) => {
                    let found = self.blocks.meet(simd, kind, index, ray, &lanes, nearest.t);
                    take(found, left, nearest);
                }
            }
            next = loop {
                match waiting.pop() {
                    None => return,
                    Some((entry, child)) if entry <= nearest.t => break child,
                    Some(_) => {}
                }
            };
        }
    }

    /// Calls `stop` with what each block finds that is met before `limit`, in no particular order,
    /// until that is true; says whether it was.
    #[inline(always)]
    fn any<S: Simd, V: Lanes<S>>(
        &self,
        simd: S,
        ray: &Ray,
        left: u32,
        mut stop: impl FnMut(u32, &Labels<N>) -> bool,
    ) -> bool {
        let lanes = RayLanes::<V>::new(simd, ray, self.needs);
        let limit = ray.t_max.next_down();
        let mut stops = |kind, index| {
            let found = self.blocks.meet(simd, kind, index, ray, &lanes, limit);
            let met = without(&found, left);
            met != 0 && stop(met, found.labels)
        };
        if self.nodes.is_empty() {
            return Kind::ALL
                .into_iter()
                .any(|kind| (0..self.blocks.len(kind)).any(|index| stops(kind, index)));
        }
        let terms = NodeRay::<V>::new(simd, ray, self.slack);
        let limit = V::simd_from(simd, limit);
        let mut waiting = Stack::<Child, WAITING>::new();
        let mut next = Child::node(0);
        loop {
            match next.content() {
                Content::Node(index) => {
                    let node = &self.nodes[index];
                    let (_, mut met) = node.meet(simd, &terms, limit);
                    while met != 0 {
                        let lane = met.trailing_zeros() as usize % N;
                        met &= met - 1;
                        let fits = waiting.push(node.children[lane]).is_ok();
                        debug_assert!(fits, "the tree was built for fewer");
                    }
                }
                Content::Block(kind, index) => {
                    if stops(kind, index) {
                        return true;
                    }
                }
            }
            match waiting.pop() {
                None => return false,
                Some(child) => next = child,
            }
        }
    }

    /// Whether the ray admits a point of any object but `left`.
    #[inline(always)]
    pub fn blocks<S: Simd>(&self, simd: S, ray: &Ray, left: u32) -> bool
    where
        Self: Vector<S>,
    {
        self.any::<S, <Self as Vector<S>>::Lanes>(simd, ray, left, |_, _| true)
    }

    /// Takes from `light` what all objects but `left` take; true where that is all of it.
    #[inline(always)]
    pub fn absorbs<S: Simd, M: Finish, P: Math>(
        &self,
        simd: S,
        parts: &Parts<'_, M>,
        ray: &Ray,
        left: u32,
        light: &mut Transmittance,
    ) -> bool
    where
        Self: Vector<S>,
    {
        type Of<S, T> = <T as Vector<S>>::Lanes;
        self.any::<S, Of<S, Self>>(simd, ray, left, |mut met, labels| {
            if met & labels.opaque != 0 {
                return true;
            }
            while met != 0 {
                let lane = met.trailing_zeros() as usize % N;
                met &= met - 1;
                if parts.absorbs::<P>(ray, labels.objects[lane] as usize, light) {
                    return true;
                }
            }
            false
        })
    }

    /// Bytes of nodes and of blocks.
    pub fn bytes(&self) -> [usize; 2] {
        [self.nodes.len() * size_of::<Node<N>>(), self.blocks.bytes()]
    }
}

/// How many objects of a leaf the area heuristic is not asked about.
const LEAF: usize = 8;

/// Keeps what waits from `start` on in order, the nearest last.
#[inline(always)]
fn insert(waiting: &mut Stack<(f32, Child), WAITING>, start: usize, entry: (f32, Child)) {
    let fits = waiting.push(entry).is_ok();
    debug_assert!(fits, "the tree was built for fewer");
    let mut place = waiting.len() - 1;
    while place > start && waiting[place - 1].0 < entry.0 {
        waiting[place] = waiting[place - 1];
        place -= 1;
    }
    waiting[place] = entry;
}

/// The lanes that are met, without the object that the ray leaves.
#[inline(always)]
fn without<V, const N: usize>(found: &Found<'_, V, N>, left: u32) -> u32 {
    let mut met = found.lanes;
    if met != 0 && left != u32::MAX {
        for (lane, &object) in found.labels.objects.iter().enumerate() {
            met &= !(u32::from(object == left) << lane);
        }
    }
    met
}

/// Takes the nearest of the lanes that are met.
#[inline(always)]
fn take<S: Simd, V: Lanes<S>, const N: usize>(
    found: Found<'_, V, N>,
    left: u32,
    nearest: &mut Nearest,
) {
    let mut met = without(&found, left);
    if met == 0 {
        return;
    }
    let mut t = [0.0; N];
    found.t.store_slice(&mut t);
    while met != 0 {
        let lane = met.trailing_zeros() as usize % N;
        met &= met - 1;
        nearest.offer(t[lane], found.labels.objects[lane]);
    }
}
