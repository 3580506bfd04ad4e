//! As many rays as a vector has lanes, cast as a group.
//!
//! Rays that start near each other and go about the same way meet about the same boxes. A node's
//! boxes are first tested against all that the rays have in common, by interval arithmetic, then each
//! that passes against every ray, a lane each: A. Reshetov, A. Soupikov, J. Hurley, "Multi-Level Ray
//! Tracing Algorithm", SIGGRAPH 2005; S. Boulos, D. Edwards, J. D. Lacewell et al., "Packet-based Whitted
//! and Distribution Ray Tracing", Graphics Interface 2007.
//!
//! Rays go the same way where they go in the same direction of each axis and, where there are outlines, are
//! closest to the same one. Of rays that go several ways, enough that go the same go together. The rest go
//! one after the other, and share only how their terms are computed; and so do those of a group from
//! where they part: C. Benthin, I. Wald, S. Woop, M. Ernst, W. R. Mark, "Combining Single and Packet-Ray
//! Tracing for Arbitrary Ray Distributions on the Intel MIC Architecture", IEEE TVCG 18 (9), 2012.

use core::hint::black_box;

use fearless_simd::{Select, Simd, SimdBase, SimdFrom, SimdMask, f32x8};
use heapless::Vec as Stack;
use whitted::Ray;
use whitted::math::Transmittance;

use super::across::{self, Terms, TermsOf};
use super::beams::{Beams, Set};
use super::blocks::{Found, Kind};
use super::lanes::{Lanes, Vectors, fastest_of_each};
use super::nodes::{Child, Content, Node, NodeTermsOfEach, SlabTermsOfEach, met};
use super::parts::Parts;
use super::rays::{RayTerms, fastest};
use super::tree::{Extent, LEAF, Nearest, Search, Tree, Vector, Visit, WAITING, without};

/// Some of as many rays as there are lanes.
pub struct Packet<'a, const N: usize> {
    pub beams: &'a Beams<N>,
    /// Which: a bit a ray, at least one.
    pub active: u32,
}

/// So many rays that go the same way go together; fewer go one by one, unless they are all there are.
const ENOUGH: u32 = 5;

/// What is done with what rays of a packet meet.
pub trait PacketVisit {
    /// Before which distance more is asked for, of this ray: minus infinity for no more.
    fn visit(&mut self, ray: usize, t: f32, object: u32, opaque: bool) -> f32;
}

/// What is known of some rays together, and of each.
struct Bundle<V> {
    x: Slabs<V>,
    y: Slabs<V>,
    z: Slabs<V>,
    /// To which all rays are closest; of no interest where all that is met is solid.
    axis: usize,
}

/// How rays cross the space between planes across an axis, all in the same direction.
///
/// No ray is at a plane before the least that `(plane - start) * reciprocal - nearest` is for any of the
/// reciprocals, nor after the greatest with `farthest`.
struct Slabs<V> {
    down: bool,
    of_each: SlabTermsOfEach<V>,
    /// Where one of the rays starts: as from here the others start near.
    start: f32,
    /// The reciprocals' range.
    least: f32,
    greatest: f32,
    /// The most that is to be taken off for any ray where planes are near, and the least where they are far.
    nearest: f32,
    farthest: f32,
}

/// The terms of each ray, from which follow those of rays that go the same way.
struct Ways<V> {
    axes: [SlabTermsOfEach<V>; 3],
    /// A bit a ray: down which axes it goes, and to which it is closest. Rays without a difference go the
    /// same way.
    ways: [u32; 5],
}

impl<V: Copy> Ways<V> {
    #[inline(always)]
    fn new<S: Simd, const N: usize>(simd: S, beams: &Beams<N>, slack: f32, solid: bool) -> Self
    where
        V: Lanes<S>,
    {
        let origin: Vectors<V> = beams.origin.load(simd);
        let direction: Vectors<V> = beams.direction.load(simd);
        let axes = SlabTermsOfEach::of_axes(simd, origin, direction, slack);
        let [x, y, z] = &axes;
        let zero = V::simd_from(simd, 0.0);
        let mut ways = [
            x.reciprocal.simd_lt(zero).to_bitmask() as u32,
            y.reciprocal.simd_lt(zero).to_bitmask() as u32,
            z.reciprocal.simd_lt(zero).to_bitmask() as u32,
            0,
            0,
        ];
        if !solid {
            let [along_x, along_y] = fastest_of_each(direction);
            ways[3] = along_x.to_bitmask() as u32;
            ways[4] = along_y.to_bitmask() as u32;
        }
        Self { axes, ways }
    }

    /// A bit for each ray that may meet something in a tree.
    #[inline(always)]
    fn meet<S: Simd>(&self, simd: S, all: &Extent) -> u32
    where
        V: Lanes<S>,
    {
        let [low, high] = all.bounds;
        let x = self.slab(simd, 0, low.x, high.x);
        let y = self.slab(simd, 1, low.y, high.y);
        let z = self.slab(simd, 2, low.z, high.z);
        let (entry, exit) = (x.0.max(y.0).max(z.0), x.1.min(y.1).min(z.1));
        // Hits of outlines are spread along rays.
        let ahead = exit.simd_ge(V::simd_from(simd, -all.spread));
        (entry.simd_le(exit) & ahead).to_bitmask() as u32
    }

    /// Where each ray enters the space between two planes across an axis, and where it leaves it.
    #[inline(always)]
    fn slab<S: Simd>(&self, simd: S, axis: usize, low: f32, high: f32) -> (V, V)
    where
        V: Lanes<S>,
    {
        let down = V::Mask::from_bitmask(simd, self.ways[axis].into());
        let (low, high) = (V::simd_from(simd, low), V::simd_from(simd, high));
        self.axes[axis].meet(down.select(high, low), down.select(low, high))
    }

    /// Those of some rays that go the same way as the first of them.
    #[inline(always)]
    fn alike(&self, rays: u32) -> u32 {
        let first = rays.trailing_zeros();
        (self.ways.iter()).fold(rays, |alike, &way| {
            alike & if way >> first & 1 != 0 { way } else { !way }
        })
    }

    /// What rays that go the same way have in common.
    #[inline(always)]
    fn bundle<S: Simd, const N: usize>(&self, simd: S, beams: &Beams<N>, rays: u32) -> Bundle<V>
    where
        V: Lanes<S>,
    {
        let any = rays.trailing_zeros() as usize % N;
        let start = beams.origin.get(any);
        let down = |axis: usize| self.ways[axis] >> any & 1 != 0;
        let rays = V::Mask::from_bitmask(simd, rays.into());
        Bundle {
            x: Slabs::new(simd, &self.axes[0], rays, start.x, down(0)),
            y: Slabs::new(simd, &self.axes[1], rays, start.y, down(1)),
            z: Slabs::new(simd, &self.axes[2], rays, start.z, down(2)),
            axis: fastest(beams.direction.get(any)),
        }
    }
}

/// The least of some lanes.
#[inline(always)]
fn least<S: Simd, V: Lanes<S>>(simd: S, lanes: V::Mask, v: V) -> f32 {
    lanes
        .select(v, V::simd_from(simd, f32::INFINITY))
        .reduce_min()
}

/// The greatest of some lanes.
#[inline(always)]
fn greatest<S: Simd, V: Lanes<S>>(simd: S, lanes: V::Mask, v: V) -> f32 {
    lanes
        .select(v, V::simd_from(simd, f32::NEG_INFINITY))
        .reduce_max()
}

impl<V: Copy> Slabs<V> {
    #[inline(always)]
    fn new<S: Simd>(
        simd: S,
        terms: &SlabTermsOfEach<V>,
        rays: V::Mask,
        start: f32,
        down: bool,
    ) -> Self
    where
        V: Lanes<S>,
    {
        // What is added and taken off again is rounded with what it is added to, 7 u of it in all. Planes'
        // and each ray's own rounding is within their margins, but others may start much farther away.
        const APART: f32 = 1.0 / (1 << 20) as f32;
        let &SlabTermsOfEach {
            reciprocal,
            near,
            far,
        } = terms;
        let from_start = reciprocal * V::simd_from(simd, start);
        let apart = from_start.abs() * V::simd_from(simd, APART);
        Self {
            down,
            of_each: *terms,
            start,
            least: least(simd, rays, reciprocal),
            greatest: greatest(simd, rays, reciprocal),
            nearest: greatest(simd, rays, near - from_start + apart),
            farthest: least(simd, rays, far - from_start - apart),
        }
    }

    /// Before which distance no ray enters the space between planes, and after which none is in it:
    /// for each box, from its planes.
    #[inline(always)]
    fn meet_all<S: Simd, const N: usize>(&self, simd: S, planes: &[[f32; N]; 2]) -> (V, V)
    where
        V: Lanes<S>,
    {
        let start = V::simd_from(simd, self.start);
        let (least, greatest) = (
            V::simd_from(simd, self.least),
            V::simd_from(simd, self.greatest),
        );
        let near = V::from_slice(simd, &planes[usize::from(self.down)]) - start;
        let far = V::from_slice(simd, &planes[usize::from(!self.down)]) - start;
        (
            (near * least).min(near * greatest) - V::simd_from(simd, self.nearest),
            (far * least).max(far * greatest) - V::simd_from(simd, self.farthest),
        )
    }

    /// Where each ray enters the space between the planes of one box, and where it leaves it.
    #[inline(always)]
    fn meet_each<S: Simd, const N: usize>(
        &self,
        simd: S,
        planes: &[[f32; N]; 2],
        child: usize,
    ) -> (V, V)
    where
        V: Lanes<S>,
    {
        let near = V::simd_from(simd, planes[usize::from(self.down)][child]);
        let far = V::simd_from(simd, planes[usize::from(!self.down)][child]);
        self.of_each.meet(near, far)
    }
}

impl<V: Copy> Bundle<V> {
    /// A distance before which no ray meets anything in each of a node's boxes, and a bit for each box
    /// in which one may meet something up to `limit`.
    #[inline(always)]
    fn meet_all<S: Simd, const N: usize, const SEARCH: u8>(
        &self,
        simd: S,
        node: &Node<N>,
        limit: f32,
    ) -> (V, u32)
    where
        V: Lanes<S>,
    {
        let [x, y, z] = node.planes();
        let limit = V::simd_from(simd, limit);
        let x = self.x.meet_all(simd, x);
        let y = self.y.meet_all(simd, y);
        let z = self.z.meet_all(simd, z);
        let spread = || V::from_slice(simd, node.spread());
        met::<S, V, SEARCH>(simd, [x, y, z], self.axis, spread, limit)
    }

    /// A bit for each ray that may meet something in one of a node's boxes before its limit.
    #[inline(always)]
    fn meet_each<S: Simd, const N: usize, const SEARCH: u8>(
        &self,
        simd: S,
        node: &Node<N>,
        child: usize,
        limits: V,
    ) -> u32
    where
        V: Lanes<S>,
    {
        let [x, y, z] = node.planes();
        let x = self.x.meet_each(simd, x, child);
        let y = self.y.meet_each(simd, y, child);
        let z = self.z.meet_each(simd, z, child);
        let spread = || V::simd_from(simd, node.spread()[child]);
        met::<S, V, SEARCH>(simd, [x, y, z], self.axis, spread, limits).1
    }
}

impl<const N: usize> Tree<N> {
    /// Calls `visit` with what the rays meet before their limits, for each ray what `visit` returned last,
    /// but not with the objects of `left`, one a ray. There is a hierarchy.
    ///
    /// `ordered` says whether limits fall.
    #[inline(always)]
    pub fn visit_rays<S: Simd, M>(
        &self,
        simd: S,
        parts: &Parts<'_, M>,
        ordered: bool,
        packet: &Packet<'_, N>,
        limits: &mut [f32; N],
        visit: &mut impl PacketVisit,
    ) where
        Self: Vector<S>,
    {
        for (lane, limit) in limits.iter_mut().enumerate() {
            // Nothing is before such an end, which may be no number: that is not to be all rays' limit.
            if packet.active >> lane & 1 == 0 || !(*limit > 0.0) {
                *limit = f32::NEG_INFINITY;
            }
        }
        macro_rules! cast {
            ($search:ident) => {{
                const SEARCH: u8 = Search::$search as u8;
                simd.vectorize(
                    #[inline(always)]
                    || self.in_groups::<S, M, SEARCH>(simd, parts, ordered, packet, limits, visit),
                )
            }};
        }
        if self.is_solid() {
            cast!(SolidBoxes);
        } else {
            cast!(Boxes);
        }
    }

    /// One ray after the other from a node down the hierarchy: they need have nothing in common.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    fn each<S: Simd, const SEARCH: u8>(
        &self,
        simd: S,
        node: usize,
        ordered: bool,
        packet: &Packet<'_, N>,
        rays: u32,
        boxes: &NodeTermsOfEach<N>,
        limits: &mut [f32; N],
        visit: &mut impl PacketVisit,
    ) where
        Self: Vector<S>,
    {
        macro_rules! cast {
            ($ordered:literal) => {
                // With AVX a function of its own, lest the way down is compiled into all that come here.
                simd.vectorize(
                    #[inline(always)]
                    || {
                        for lane in Set(rays) {
                            let ray = packet.beams.ray(lane);
                            let terms = RayTerms::new(&ray, self.needs());
                            let boxes = boxes.get(lane, ray.direction);
                            let limit = limits[lane];
                            let one = OneOfEach {
                                ray: lane,
                                left: packet.beams.left[lane],
                                ordered: $ordered,
                                limit: &mut limits[lane],
                                visit: &mut *visit,
                            };
                            self.descend::<S, SEARCH, $ordered>(
                                simd, node, &terms, &boxes, limit, one,
                            );
                        }
                    },
                )
            };
        }
        if ordered {
            cast!(true);
        } else {
            cast!(false);
        }
    }

    /// Rays that go the same way together down the hierarchy, the others one by one.
    #[inline(always)]
    fn in_groups<S: Simd, M, const SEARCH: u8>(
        &self,
        simd: S,
        parts: &Parts<'_, M>,
        ordered: bool,
        packet: &Packet<'_, N>,
        limits: &mut [f32; N],
        visit: &mut impl PacketVisit,
    ) where
        Self: Vector<S>,
    {
        type Of<S, T> = <T as Vector<S>>::Lanes;
        let beams = packet.beams;
        let ways = Ways::<Of<S, Self>>::new(
            simd,
            beams,
            self.slack(),
            SEARCH == Search::SolidBoxes as u8,
        );
        let active = packet.active & ways.meet(simd, self.extent());
        if active == 0 {
            return;
        }
        // Of single rays, from memory.
        let boxes = NodeTermsOfEach::new(&ways.axes);
        let boxes = black_box(&boxes);
        let mut groups = Stack::<u32, N>::new();
        let (mut rest, mut alone) = (active, 0);
        while rest != 0 {
            let rays = ways.alike(rest);
            rest &= !rays;
            if rays == active || rays.count_ones() >= ENOUGH {
                let fits = groups.push(rays).is_ok();
                debug_assert!(fits, "each has a ray");
            } else {
                alone |= rays;
            }
        }
        if alone != 0 {
            self.each::<S, SEARCH>(simd, 0, ordered, packet, alone, boxes, limits, visit);
        }
        if groups.is_empty() {
            return;
        }
        let terms = Terms::<Of<S, Self>, _>::new(simd, beams, self.needs());
        // In memory, as the terms of a single ray.
        let terms = black_box(&terms);
        for &rays in &groups {
            let bundle = ways.bundle(simd, beams, rays);
            self.down::<S, M, SEARCH>(
                simd, parts, ordered, packet, rays, &bundle, boxes, terms, limits, visit,
            );
        }
    }

    /// Some rays together down the hierarchy.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    fn down<S: Simd, M, const SEARCH: u8>(
        &self,
        simd: S,
        parts: &Parts<'_, M>,
        ordered: bool,
        packet: &Packet<'_, N>,
        rays: u32,
        bundle: &Bundle<<Self as Vector<S>>::Lanes>,
        boxes: &NodeTermsOfEach<N>,
        terms: &TermsOf<S, <Self as Vector<S>>::Lanes>,
        limits: &mut [f32; N],
        visit: &mut impl PacketVisit,
    ) where
        Self: Vector<S>,
    {
        type Of<S, T> = <T as Vector<S>>::Lanes;
        let these = <Of<S, Self> as SimdBase<S>>::Mask::from_bitmask(simd, rays.into());
        let mut farthest = greatest(simd, these, Of::<S, Self>::from_slice(simd, limits));
        let mut waiting = Stack::<(f32, Child, u32), WAITING>::new();
        let (mut next, mut rays) = (Child::node(0), rays);
        loop {
            match next.content() {
                Content::Node(index) => {
                    let node = self.node(index);
                    let (entry, near) = bundle.meet_all::<S, N, SEARCH>(simd, node, farthest);
                    if near.count_ones() > rays.count_ones() {
                        // What the bundle may meet, with rays that are elsewhere, is too much for these.
                        self.each::<S, SEARCH>(
                            simd, index, ordered, packet, rays, boxes, limits, visit,
                        );
                        farthest = greatest(simd, these, Of::<S, Self>::from_slice(simd, limits));
                    } else {
                        let ends = Of::<S, Self>::from_slice(simd, limits);
                        let mut entries = [0.0; N];
                        entry.store_slice(&mut entries);
                        let first = waiting.len();
                        for child in Set(near) {
                            let child = child % N;
                            let met = bundle.meet_each::<S, N, SEARCH>(simd, node, child, ends);
                            if met & rays != 0 {
                                let mut place = (entries[child], node.children[child], met & rays);
                                // The nearest is next.
                                if ordered {
                                    for other in &mut waiting[first..] {
                                        if other.0 < place.0 {
                                            core::mem::swap(other, &mut place);
                                        }
                                    }
                                }
                                let fits = waiting.push(place).is_ok();
                                debug_assert!(fits, "the tree was built for fewer");
                            }
                        }
                    }
                }
                Content::Block(kind, index) => {
                    let (blocks, count) = (self.all_blocks(), rays.count_ones() as usize);
                    let labels = blocks.labels(kind, index);
                    let objects = labels.objects.iter().take_while(|&&it| it != u32::MAX);
                    // What a lane a ray costs, and what a lane an object, or an edge.
                    let (by_rays, by_objects) = if kind == Kind::Outline {
                        let edges = parts.outline(labels.objects[0] as usize).0.len();
                        (edges, count * edges.div_ceil(LEAF))
                    } else if kind == Kind::Other {
                        (count, 0)
                    } else {
                        (objects.count(), count)
                    };
                    if by_rays <= by_objects {
                        self.visit_objects(
                            simd,
                            parts,
                            kind,
                            index,
                            terms,
                            bundle.axis,
                            rays,
                            limits,
                            visit,
                        );
                    } else {
                        self.visit_block(simd, kind, index, ordered, packet, rays, limits, visit);
                    }
                    farthest = greatest(simd, these, Of::<S, Self>::from_slice(simd, limits));
                }
            }
            let ends = Of::<S, Self>::from_slice(simd, limits);
            loop {
                let Some((entry, child, met)) = waiting.pop() else {
                    return;
                };
                // Limits have fallen since.
                let entry = Of::<S, Self>::simd_from(simd, entry);
                rays = met & ends.simd_ge(entry).to_bitmask() as u32;
                if rays != 0 {
                    next = child;
                    break;
                }
            }
        }
    }

    /// Casts some rays of a packet into a block, object by object.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    fn visit_objects<S: Simd, M>(
        &self,
        simd: S,
        parts: &Parts<'_, M>,
        kind: Kind,
        index: usize,
        terms: &TermsOf<S, <Self as Vector<S>>::Lanes>,
        axis: usize,
        rays: u32,
        limits: &mut [f32; N],
        visit: &mut impl PacketVisit,
    ) where
        Self: Vector<S>,
    {
        type Of<S, T> = <T as Vector<S>>::Lanes;
        let blocks = self.all_blocks();
        let labels = blocks.labels(kind, index);
        let mut each = Of::<S, Self>::from_slice(simd, limits);
        for (lane, &object) in labels.objects.iter().enumerate() {
            if object == u32::MAX {
                break;
            }
            let meeting = match kind {
                Kind::Triangle => {
                    blocks.triangles.blocks[index].meet_rays(simd, lane, terms, axis, each)
                }
                Kind::Quad => blocks.quads.blocks[index].meet_rays(simd, lane, terms, axis, each),
                _ => across::object(simd, parts, kind, object as usize, terms, each),
            };
            let meeting = terms.unless_left(simd, object as usize, meeting);
            let mut met = meeting.met.to_bitmask() as u32 & rays;
            if met == 0 {
                continue;
            }
            let opaque = labels.opaque >> lane & 1 != 0;
            let mut t = [0.0; N];
            meeting.t.store_slice(&mut t);
            while met != 0 {
                let ray = met.trailing_zeros() as usize % N;
                met &= met - 1;
                limits[ray] = visit.visit(ray, t[ray], object, opaque);
            }
            each = Of::<S, Self>::from_slice(simd, limits);
        }
    }

    /// Casts some rays of a packet into a block, ray by ray.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    fn visit_block<S: Simd>(
        &self,
        simd: S,
        kind: Kind,
        index: usize,
        ordered: bool,
        packet: &Packet<'_, N>,
        rays: u32,
        limits: &mut [f32; N],
        visit: &mut impl PacketVisit,
    ) where
        Self: Vector<S>,
    {
        for ray in Set(rays) {
            let ray = ray % N;
            let cast = packet.beams.ray(ray);
            let terms = RayTerms::new(&cast, self.needs());
            let terms = black_box(&terms);
            let found: Found<'_, f32x8<S>, LEAF> =
                self.all_blocks()
                    .meet(simd, kind, index, terms, limits[ray]);
            let limit = limits[ray];
            let mut one = OneOfEach {
                ray,
                left: packet.beams.left[ray],
                ordered,
                limit: &mut limits[ray],
                visit: &mut *visit,
            };
            one.visit(found, limit);
        }
    }
}

/// One ray of a packet.
struct OneOfEach<'a, P> {
    ray: usize,
    left: u32,
    /// Whether its limit falls.
    ordered: bool,
    /// Becomes what `visit` returned last.
    limit: &'a mut f32,
    visit: &'a mut P,
}

impl<P: PacketVisit> Visit for OneOfEach<'_, P> {
    #[inline(always)]
    fn visit<S: Simd, V: Lanes<S>, const N: usize>(
        &mut self,
        found: Found<'_, V, N>,
        mut limit: f32,
    ) -> Option<f32> {
        let mut met = without(&found, self.left);
        if met == 0 {
            return Some(limit);
        }
        let opaque = met & found.labels().opaque;
        if !self.ordered && opaque != 0 {
            // One of these is the last.
            met = opaque;
        }
        let mut t = [0.0; N];
        found.t.store_slice(&mut t);
        while met != 0 {
            let lane = met.trailing_zeros() as usize % N;
            met &= met - 1;
            let opaque = found.labels().opaque >> lane & 1 != 0;
            limit = (self.visit).visit(self.ray, t[lane], found.labels().objects[lane], opaque);
            *self.limit = limit;
            if limit == f32::NEG_INFINITY {
                return None;
            }
        }
        Some(limit)
    }
}

/// The nearest hit of each ray.
pub struct NearestOfEach<'a, const N: usize>(pub &'a mut [Nearest; N]);

impl<const N: usize> PacketVisit for NearestOfEach<'_, N> {
    #[inline(always)]
    fn visit(&mut self, ray: usize, t: f32, object: u32, _: bool) -> f32 {
        self.0[ray].offer(t, object);
        self.0[ray].limit()
    }
}

/// What surfaces leave of a light, for each ray.
pub struct LightOfEach<'a, F, const N: usize> {
    pub beams: &'a Beams<N>,
    pub light: [Transmittance; N],
    /// A bit for each ray that nothing is left for.
    pub dark: u32,
    /// Becomes the object that hid all light from a ray last.
    pub occluder: &'a mut u32,
    /// Takes what an object absorbs; true where that is all that was left.
    pub absorb: F,
}

impl<F, const N: usize> PacketVisit for LightOfEach<'_, F, N>
where
    F: Fn(&Ray, u32, &mut Transmittance) -> bool,
{
    #[inline(always)]
    fn visit(&mut self, ray: usize, _: f32, object: u32, opaque: bool) -> f32 {
        if opaque {
            *self.occluder = object;
        }
        if opaque || (self.absorb)(&self.beams.ray(ray), object, &mut self.light[ray]) {
            self.dark |= 1 << ray;
            f32::NEG_INFINITY
        } else {
            self.beams.end[ray]
        }
    }
}
