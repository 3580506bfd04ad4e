//! As many rays as a vector has lanes, cast together.
//!
//! Rays that start near each other and go about the same way meet about the same boxes. A node's
//! boxes are first tested against all that the rays have in common, by interval arithmetic, then each
//! that passes against every ray, a lane each: A. Reshetov, A. Soupikov, J. Hurley, "Multi-Level Ray
//! Tracing Algorithm", SIGGRAPH 2005; S. Boulos, D. Edwards, J. D. Lacewell et al., "Packet-based Whitted
//! and Distribution Ray Tracing", Graphics Interface 2007.

use core::hint::black_box;

use fearless_simd::{Simd, SimdBase, SimdMask, f32x8};
use heapless::Vec as Stack;
use whitted::Ray;
use whitted::math::Transmittance;

use super::across::{self, Terms, TermsOf};
use super::beams::Beams;
use super::blocks::{Found, Kind};
use super::bounds::FAR;
use super::lanes::{Lanes, Vectors, fastest_of_each};
use super::nodes::{Child, Content, Node, met};
use super::parts::Parts;
use super::rays::{RayTerms, fastest};
use super::tree::{LEAF, Nearest, Search, Tree, Vector, WAITING, without};

/// Some of as many rays as there are lanes.
pub struct Packet<'a, const N: usize> {
    pub beams: &'a Beams<N>,
    /// Which: a bit a ray, at least one.
    pub active: u32,
}

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
struct Slabs<V> {
    down: bool,
    /// Of each ray, as of a single one.
    reciprocal: V,
    near: V,
    far: V,
    /// Of all: what follows is as from this coordinate.
    start: f32,
    /// The reciprocals' range.
    least: f32,
    greatest: f32,
    nearest: f32,
    farthest: f32,
}

impl<V: Copy> Bundle<V> {
    /// `None` where the rays have too little in common.
    #[inline(always)]
    fn new<S: Simd, const N: usize>(
        simd: S,
        packet: &Packet<'_, N>,
        slack: f32,
        solid: bool,
    ) -> Option<Self>
    where
        V: Lanes<S>,
    {
        // The lanes without a ray copy one: what all have in common is not theirs.
        let active = V::Mask::from_bitmask(simd, packet.active.into());
        let any = packet.active.trailing_zeros() as usize % N;
        let (start, way) = (
            packet.beams.origin.get(any),
            packet.beams.direction.get(any),
        );
        let origin = Vectors::<V>::select(simd, active, packet.beams.origin.load(simd), start);
        let direction = Vectors::<V>::select(simd, active, packet.beams.direction.load(simd), way);
        let axis = fastest(way);
        if !solid {
            let [x, y]: [V::Mask; 2] = fastest_of_each(direction);
            let same = match axis {
                0 => x,
                1 => y,
                _ => !(x | y),
            };
            if same.any_false() {
                return None;
            }
        }
        let zero = V::simd_from(simd, 0.0);
        let reach = origin.x.abs() + origin.y.abs() + origin.z.abs();
        let slack = reach * slack;
        Some(Self {
            x: Slabs::new(simd, origin.x, direction.x, slack, start.x, zero)?,
            y: Slabs::new(simd, origin.y, direction.y, slack, start.y, zero)?,
            z: Slabs::new(simd, origin.z, direction.z, slack, start.z, zero)?,
            axis,
        })
    }
}

impl<V: Copy> Slabs<V> {
    #[inline(always)]
    fn new<S: Simd>(simd: S, origin: V, direction: V, slack: V, start: f32, zero: V) -> Option<Self>
    where
        V: Lanes<S>,
    {
        // As `SlabTerms::new`.
        let one = V::simd_from(simd, 1.0);
        let reciprocal = (one / direction)
            .max(V::simd_from(simd, -FAR))
            .min(V::simd_from(simd, FAR));
        let down = reciprocal.simd_lt(zero);
        if down.any_true() && down.any_false() {
            return None;
        }
        let moved = reciprocal.max(-reciprocal) * slack;
        let from_zero = origin * reciprocal;
        let (near, far) = (from_zero + moved, from_zero - moved);
        let from_start = reciprocal * V::simd_from(simd, start);
        Some(Self {
            down: down.any_true(),
            reciprocal,
            near,
            far,
            start,
            least: reciprocal.reduce_min(),
            greatest: reciprocal.reduce_max(),
            nearest: (near - from_start).reduce_max(),
            farthest: (far - from_start).reduce_min(),
        })
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
        (
            near.mul_sub(self.reciprocal, self.near),
            far.mul_sub(self.reciprocal, self.far),
        )
    }
}

impl<V: Copy> Bundle<V> {
    /// A distance before which no ray meets anything in each of a node's boxes, and a bit for each box
    /// in which one may meet something up to `limit`.
    #[inline(always)]
    fn meet_all<S: Simd, const N: usize, const SOLID: bool>(
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
        met::<S, V, SOLID>(simd, [x, y, z], self.axis, spread, limit)
    }

    /// A bit for each ray that may meet something in one of a node's boxes before its limit.
    #[inline(always)]
    fn meet_each<S: Simd, const N: usize, const SOLID: bool>(
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
        met::<S, V, SOLID>(simd, [x, y, z], self.axis, spread, limits).1
    }
}

impl<const N: usize> Tree<N> {
    /// Calls `visit` with everything that the rays meet before their limits, for each ray what `visit`
    /// returned last, but not with the objects of `left`, one a ray. False, and nothing is done, where
    /// the rays have too little in common, or there is no faster way than one by one.
    ///
    /// `ordered` says whether limits fall.
    #[allow(clippy::too_many_arguments)]
    pub fn visit_packet<S: Simd, M>(
        &self,
        simd: S,
        parts: &Parts<'_, M>,
        search: Search,
        ordered: bool,
        packet: &Packet<'_, N>,
        limits: &mut [f32; N],
        visit: &mut impl PacketVisit,
    ) -> bool
    where
        Self: Vector<S>,
    {
        for (lane, limit) in limits.iter_mut().enumerate() {
            // Nothing is before such an end, which may be no number: that is not to be all rays' limit.
            if packet.active >> lane & 1 == 0 || !(*limit > 0.0) {
                *limit = f32::NEG_INFINITY;
            }
        }
        macro_rules! down {
            ($solid:literal) => {
                simd.vectorize(
                    #[inline(always)]
                    || self.down::<S, M, $solid>(simd, parts, ordered, packet, limits, visit),
                )
            };
        }
        match search {
            Search::Spheres | Search::Blocks => false,
            Search::SolidBoxes => down!(true),
            Search::Boxes => down!(false),
        }
    }

    /// Down the hierarchy.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    fn down<S: Simd, M, const SOLID: bool>(
        &self,
        simd: S,
        parts: &Parts<'_, M>,
        ordered: bool,
        packet: &Packet<'_, N>,
        limits: &mut [f32; N],
        visit: &mut impl PacketVisit,
    ) -> bool
    where
        Self: Vector<S>,
    {
        type Of<S, T> = <T as Vector<S>>::Lanes;
        let bundle = Bundle::<Of<S, Self>>::new(simd, packet, self.slack(), SOLID);
        let Some(bundle) = bundle else {
            return false;
        };
        let terms = Terms::<Of<S, Self>, _>::new(simd, packet.beams, self.needs());
        // In memory, as the terms of a single ray.
        let terms = black_box(&terms);
        let mut farthest = Of::<S, Self>::from_slice(simd, limits).reduce_max();
        let mut waiting = Stack::<(f32, Child, u32), WAITING>::new();
        let (mut next, mut rays) = (Child::node(0), packet.active);
        loop {
            match next.content() {
                Content::Node(index) => {
                    let node = self.node(index);
                    let each = Of::<S, Self>::from_slice(simd, limits);
                    let (entry, mut boxes) = bundle.meet_all::<S, N, SOLID>(simd, node, farthest);
                    let mut entries = [0.0; N];
                    entry.store_slice(&mut entries);
                    let first = waiting.len();
                    while boxes != 0 {
                        let child = boxes.trailing_zeros() as usize % N;
                        boxes &= boxes - 1;
                        let met = rays & bundle.meet_each::<S, N, SOLID>(simd, node, child, each);
                        if met != 0 {
                            let fits = waiting
                                .push((entries[child], node.children[child], met))
                                .is_ok();
                            debug_assert!(fits, "the tree was built for fewer");
                        }
                    }
                    // The nearest is next.
                    if ordered {
                        let last = waiting.len();
                        for place in first + 1..last {
                            if waiting[place].0 < waiting[last - 1].0 {
                                waiting.swap(place, last - 1);
                            }
                        }
                        if last > first && waiting[first].0 < waiting[last - 1].0 {
                            waiting.swap(first, last - 1);
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
                        self.visit_objects(simd, parts, kind, index, terms, rays, limits, visit);
                    } else {
                        self.visit_block(simd, kind, index, packet, rays, limits, visit);
                    }
                    farthest = Of::<S, Self>::from_slice(simd, limits).reduce_max();
                }
            }
            loop {
                match waiting.pop() {
                    None => return true,
                    Some((entry, child, met)) if entry <= farthest => {
                        (next, rays) = (child, met);
                        break;
                    }
                    Some(_) => {}
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
        rays: u32,
        limits: &mut [f32; N],
        visit: &mut impl PacketVisit,
    ) where
        Self: Vector<S>,
    {
        type Of<S, T> = <T as Vector<S>>::Lanes;
        let labels = self.all_blocks().labels(kind, index);
        let mut each = Of::<S, Self>::from_slice(simd, limits);
        for (lane, &object) in labels.objects.iter().enumerate() {
            if object == u32::MAX {
                break;
            }
            let meeting = across::object(simd, parts, kind, object as usize, terms, each);
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
        packet: &Packet<'_, N>,
        mut rays: u32,
        limits: &mut [f32; N],
        visit: &mut impl PacketVisit,
    ) where
        Self: Vector<S>,
    {
        while rays != 0 {
            let ray = rays.trailing_zeros() as usize % N;
            rays &= rays - 1;
            let cast = packet.beams.ray(ray);
            let terms = RayTerms::new(&cast, self.needs());
            let terms = black_box(&terms);
            let found: Found<'_, f32x8<S>, LEAF> =
                self.all_blocks()
                    .meet(simd, kind, index, terms, limits[ray]);
            let mut met = without(&found, packet.beams.left[ray]);
            if met == 0 {
                continue;
            }
            let mut t = [0.0; LEAF];
            found.t.store_slice(&mut t);
            while met != 0 {
                let lane = met.trailing_zeros() as usize % LEAF;
                met &= met - 1;
                let opaque = found.labels.opaque >> lane & 1 != 0;
                limits[ray] = visit.visit(ray, t[lane], found.labels.objects[lane], opaque);
            }
        }
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
