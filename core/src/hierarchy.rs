//! A hierarchy of bounds over the objects of one slice, in flash.
//!
//! A [`Hierarchy`] answers every query with the bits, and the objects' places, of the slice that it
//! was built over; it only looks at fewer of them. It is as much a [`Geometry`] as a slice is, so that
//! a pair may hold a hierarchy of spheres, one of triangles and a bare plane. `whitted bake` and the
//! builder in `whitted-cli` make the arrays; nothing is built here, and nothing is allocated.
//!
//! Its bounds are [boxes](Aabb), which suit everything, or [balls](Ball), which take two thirds of the
//! flash and of the instructions where what they hold is round, and are for [`Solid`] shapes.
//!
//! # Why no hit is ever lost
//!
//! Bounds are tested with a margin *e*: the [slack](SLACK) times the greatest coordinate of the ray's
//! origin and of the bound. The second part is in the bounds, the first is added once a ray, for
//! rounding grows with the distance from which a ray comes: no margin of the bounds alone could do.
//! With u = 2^-24, what the kernels in [`crate::shape`] report as a hit satisfies, within half the
//! usual slack of 128 u:
//!
//! 1. the ray's line passes the bound at no more than *e*;
//! 2. at the reported distance, the ray's coordinate along the axis to which it is most parallel lies
//!    within *e* of the box's; of a solid, the point itself lies within *e* of box and ball.
//!
//! Solids owe this to their kernels' backward error: the reported point is off the surface by a few
//! u of the coordinates. For outlines, the error of the shear gives the first; for the second their
//! kernel keeps what it finds edge-on between the distances of the vertices. A box is passed over only
//! where one of the two fails, and so the distances at which the other slabs are met are not asked
//! for: that to an outline may be less or more. The sums here round by less than 16 u of the same
//! coordinates, which the other half of the slack covers.
//!
//! The object that a ray leaves is met where its chord ends, which may lie off its bounds by the
//! rounding of the point that is left. It is looked up and tested apart.

use core::fmt;
use core::ops::Range;

use glam::Vec3;
use heapless::Vec;

use crate::candidates::Candidates;
use crate::geometry::{Geometry, Object};
use crate::material::Finish;
use crate::math::{self, Math, Passage, dot, length_squared};
use crate::ray::{Departure, Ray, Side};
use crate::shape::Shape;
use crate::shape::cuboid::Cuboid;
use crate::shape::frustum::Frustum;
use crate::shape::polygon::Axis;
use crate::shape::quadric::Quadric;
use crate::shape::sphere::Sphere;
use crate::shape::torus::Torus;

/// What a box is round: a node, or some objects next to each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Link(u32);

impl Link {
    /// Most objects of a [`leaf`](Self::leaf).
    pub const MAX_COUNT: u32 = 127;
    /// Objects of a leaf, and nodes, lie before this place.
    pub const END: u32 = 1 << 24;
    const LEAF: u32 = 1 << 31;

    /// To a node, by its place among the nodes; `None` where that is not before [`END`](Self::END).
    pub const fn to_node(place: u32) -> Option<Self> {
        if place < Self::END {
            Some(Self(place))
        } else {
            None
        }
    }

    /// To `count` objects from the slot `first` on; `None` where they are none or more than
    /// [`MAX_COUNT`](Self::MAX_COUNT), or do not all lie before [`END`](Self::END).
    pub const fn leaf(first: u32, count: u32) -> Option<Self> {
        if count > 0 && count <= Self::MAX_COUNT && first <= Self::END - count {
            Some(Self(Self::LEAF | count << 24 | first))
        } else {
            None
        }
    }

    /// The link with these [`bits`](Self::bits); what they say is checked by [`Hierarchy::new`].
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// Bit 31: whether this is a leaf; then bits 24 to 30: of how many objects, bits 0 to 23: from which
    /// slot on. Otherwise the place of a node.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// The slots of a leaf's objects.
    pub const fn objects(self) -> Option<Range<usize>> {
        if self.is_leaf() {
            Some(self.first()..self.first() + self.count())
        } else {
            None
        }
    }

    /// A node's place.
    pub const fn node(self) -> Option<usize> {
        if self.is_leaf() {
            None
        } else {
            Some(self.first())
        }
    }

    #[inline(always)]
    const fn is_leaf(self) -> bool {
        self.0 >= Self::LEAF
    }

    /// First slot of a leaf, or a node's place.
    #[inline(always)]
    const fn first(self) -> usize {
        (self.0 & (Self::END - 1)) as usize
    }

    #[inline(always)]
    const fn count(self) -> usize {
        (self.0 >> 24 & Self::MAX_COUNT) as usize
    }
}

/// What is round some objects, and what leads on from there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Child<B> {
    /// Round everything that the link leads to.
    pub bound: B,
    /// Where to go on where a ray meets the bound.
    pub link: Link,
}

/// Where two bounds lead to: 56 bytes with boxes, 40 with balls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node<B>(pub [Child<B>; 2]);

/// A box with faces across the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// In world space.
    pub center: Vec3,
    /// From the center to the faces, and the slack times the greatest coordinate in the box.
    pub half: Vec3,
}

/// A ball, for shapes that are [`Solid`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// In world space.
    pub center: Vec3,
    /// With the slack times the greatest coordinate in the ball.
    pub radius: f32,
}

/// A shape whose hits are reported where its surface is, up to rounding. Outlines are not solid: seen
/// edge-on, all that is sure of the distance is that it lies between those of the vertices.
pub trait Solid: Shape {}

impl Solid for Sphere {}
impl Solid for Cuboid {}
impl Solid for Frustum {}
impl Solid for Quadric {}
impl Solid for Torus {}

/// What is put round objects of kind `S`.
pub trait Bound<S> {
    /// What all bounds need to know of a ray.
    type Probe: Copy;

    /// Prepares a ray. What a hit may lie off by is the slack, times the greatest coordinate of the
    /// ray's origin, and what is in the bounds already.
    fn probe(ray: &Ray, slack: f32) -> Self::Probe;

    /// Distance before which nothing inside is met; `None` where nothing is met before `t_max`.
    fn enter(&self, probe: &Self::Probe, t_max: f32) -> Option<f32>;
}

/// A ray that is tested against boxes.
#[derive(Clone, Copy, Debug)]
pub struct BoxProbe {
    origin: Vec3,
    direction: Vec3,
    /// Of the direction's components.
    magnitude: Vec3,
    /// Of the tests across each axis.
    margin: Vec3,
    /// To which the ray is closest.
    axis: Axis,
    /// How far the ray goes for each step along the axis, and the size of that.
    rate: f32,
    rate_size: f32,
    /// Of distances along the axis.
    margin_along: f32,
}

impl<S: Shape> Bound<S> for Aabb {
    type Probe = BoxProbe;

    #[inline]
    fn probe(ray: &Ray, slack: f32) -> BoxProbe {
        let (o, d) = (ray.origin, ray.direction);
        let a = d.abs();
        let axis = Axis::along(ray);
        let rate = 1.0 / axis.of(&d);
        let margin = slack * math::max_component(o.abs());
        let across = Vec3::new(a.y + a.z, a.z + a.x, a.x + a.y);
        BoxProbe {
            origin: o,
            direction: d,
            magnitude: a,
            // Products that leave the normal range round by more than a share of themselves.
            margin: across * margin + Vec3::splat(f32::MIN_POSITIVE),
            axis,
            rate,
            rate_size: rate.abs(),
            margin_along: margin,
        }
    }

    /// The line is tested by separating axes: S. Gottschalk, M. C. Lin, D. Manocha, "OBBTree",
    /// SIGGRAPH 1996, for those that the box's edges and the line span. There is no division, so that
    /// directions along an axis are like any other.
    #[inline(always)]
    fn enter(&self, probe: &BoxProbe, t_max: f32) -> Option<f32> {
        let (m, h) = (self.center - probe.origin, self.half);
        let (d, a, e) = (probe.direction, probe.magnitude, probe.margin);
        // All of these are also false for NaN, with which nothing is met.
        if !((m.y * d.z - m.z * d.y).abs() <= h.y * a.z + h.z * a.y + e.x) {
            return None;
        }
        if !((m.z * d.x - m.x * d.z).abs() <= h.z * a.x + h.x * a.z + e.y) {
            return None;
        }
        if !((m.x * d.y - m.y * d.x).abs() <= h.x * a.y + h.y * a.x + e.z) {
            return None;
        }
        let (m, h) = match probe.axis {
            Axis::X => (m.x, h.x),
            Axis::Y => (m.y, h.y),
            Axis::Z => (m.z, h.z),
        };
        let middle = m * probe.rate;
        let reach = (h + probe.margin_along) * probe.rate_size;
        let near = middle - reach;
        if near <= t_max && middle + reach >= 0.0 {
            Some(near)
        } else {
            None
        }
    }
}

/// A ray that is tested against balls.
#[derive(Clone, Copy, Debug)]
pub struct BallProbe {
    origin: Vec3,
    direction: Vec3,
    margin: f32,
}

impl<S: Solid> Bound<S> for Ball {
    type Probe = BallProbe;

    #[inline]
    fn probe(ray: &Ray, slack: f32) -> BallProbe {
        BallProbe {
            origin: ray.origin,
            direction: ray.direction,
            margin: slack * math::max_component(ray.origin.abs()),
        }
    }

    #[inline(always)]
    fn enter(&self, probe: &BallProbe, t_max: f32) -> Option<f32> {
        let to_center = self.center - probe.origin;
        let middle = dot(&to_center, &probe.direction);
        let miss = to_center - probe.direction * middle;
        let reach = self.radius + probe.margin;
        // Also false for NaN, with which nothing is met.
        if !(length_squared(&miss) <= reach * reach) {
            return None;
        }
        let near = middle - reach;
        if near <= t_max && middle + reach >= 0.0 {
            Some(near)
        } else {
            None
        }
    }
}

/// Why some arrays are not a [`Hierarchy`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum HierarchyError {
    /// There is no node, or no object.
    Empty,
    /// `places` or `slots` are not as many as the objects.
    Lengths,
    /// The node at this place is not where it has to be: a node comes right before what is in its
    /// first box, and what is in the second follows that.
    Order(usize),
    /// The leaves do not hold each object once, in order, from this slot on.
    Leaf(usize),
    /// Paths are longer than `DEPTH`.
    TooDeep,
    /// The slack is negative or not finite.
    Slack,
}

impl fmt::Display for HierarchyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("a hierarchy needs a node and two objects"),
            Self::Lengths => f.write_str("there must be as many places and slots as objects"),
            Self::Order(node) => write!(f, "node {node} (from 0) is not in depth-first order"),
            Self::Leaf(slot) => write!(f, "no leaf holds the object in slot {slot} (from 0) next"),
            Self::TooDeep => f.write_str("the hierarchy is deeper than its type says"),
            Self::Slack => f.write_str("the slack must be finite and at least zero"),
        }
    }
}

impl core::error::Error for HierarchyError {}

/// Objects of one kind under a hierarchy of bounds: a [`Geometry`] with the bits of the plain slice,
/// for rays whose direction is unit length.
///
/// `B` is [`Aabb`] or [`Ball`]. `DEPTH` is the most nodes on the way to an object; queries use 8 bytes
/// of stack for each. `I` holds places: `u8` or `u16`, or `usize` where there are more than 2^16
/// objects.
///
/// On a Cortex-M4F a plain slice is faster up to about a dozen spheres, or two triangles, and a
/// [`Culled`](crate::Culled) one wherever there can be one and nothing mirrors. By the [`Micro`](crate::Micro) policy hits
/// lie off their surfaces by percents of a radius, and those off their bounds may be missed.
#[derive(Debug, PartialEq)]
pub struct Hierarchy<'a, S, M, B, const DEPTH: usize, I = u16> {
    nodes: &'a [Node<B>],
    objects: &'a [Object<'a, S, M>],
    places: &'a [I],
    slots: &'a [I],
    slack: f32,
}

impl<S, M, B, const DEPTH: usize, I> Clone for Hierarchy<'_, S, M, B, DEPTH, I> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<S, M, B, const DEPTH: usize, I> Copy for Hierarchy<'_, S, M, B, DEPTH, I> {}

/// The usual slack: twice what the kernels in [`crate::shape`] need. Only frusta whose radius grows
/// faster than the axis need more, in proportion.
pub const SLACK: f32 = 128.0 / (1 << 24) as f32;

impl<'a, S, M, B: Copy, const DEPTH: usize, I> Hierarchy<'a, S, M, B, DEPTH, I> {
    /// A hierarchy of arrays that a builder made; in a `static`, an error is one of the build.
    ///
    /// `objects` are in the order of the leaves. What counts objects by their places in the slice
    /// that was built over, [`Hit::object`](crate::Hit::object) for one, finds them by `places`, the
    /// place of each slot, and `slots`, the slot of each place.
    ///
    /// `slack` is [`SLACK`], or more for shapes that are met further off their bounds. That bounds
    /// hold what is in them, and that `places` and `slots` are each other's inverse, is not checked:
    /// objects may then be missed or mistaken for others, but nothing worse.
    ///
    /// # Errors
    ///
    /// Where the arrays do not make a tree; see [`HierarchyError`].
    pub const fn new(
        nodes: &'a [Node<B>],
        objects: &'a [Object<'a, S, M>],
        places: &'a [I],
        slots: &'a [I],
        slack: f32,
    ) -> Result<Self, HierarchyError> {
        if nodes.is_empty() || objects.is_empty() {
            return Err(HierarchyError::Empty);
        }
        if places.len() != objects.len() || slots.len() != objects.len() {
            return Err(HierarchyError::Lengths);
        }
        // Also true for NaN.
        if !(slack >= 0.0 && slack < f32::INFINITY) {
            return Err(HierarchyError::Slack);
        }
        // Every node is reached in the order in which it is stored, so none is reached twice, and the
        // tree ends.
        let (mut node, mut slot) = (0, 0);
        let mut waiting = [(Link(0), 0); DEPTH];
        let mut top = 0;
        let (mut link, mut depth) = (Link(0), 0);
        loop {
            if link.is_leaf() {
                if link.first() != slot || link.count() == 0 {
                    return Err(HierarchyError::Leaf(slot));
                }
                slot += link.count();
                if top == 0 || top > DEPTH {
                    break;
                }
                top -= 1;
                (link, depth) = waiting[top];
            } else {
                if link.first() != node || link.bits() >= Link::END || node >= nodes.len() {
                    return Err(HierarchyError::Order(node));
                }
                let Node([first, second]) = nodes[node];
                node += 1;
                depth += 1;
                if depth > DEPTH || top >= DEPTH {
                    return Err(HierarchyError::TooDeep);
                }
                waiting[top] = (second.link, depth);
                top += 1;
                link = first.link;
            }
        }
        if node != nodes.len() {
            return Err(HierarchyError::Order(node));
        }
        if slot != objects.len() {
            return Err(HierarchyError::Leaf(slot));
        }
        Ok(Self {
            nodes,
            objects,
            places,
            slots,
            slack,
        })
    }
}

impl<S, M, B, const DEPTH: usize, I: Copy + Into<usize>> Hierarchy<'_, S, M, B, DEPTH, I> {
    /// The object at a place of the slice that was built over.
    #[inline]
    fn object(&self, place: usize) -> Option<&Object<'_, S, M>> {
        let &slot = self.slots.get(place)?;
        self.objects.get(slot.into())
    }

    /// The place of one of the objects; one that no object has, where there are fewer places.
    #[inline]
    fn place(&self, object: &Object<'_, S, M>) -> usize {
        let slot = self.objects.element_offset(object);
        match slot.and_then(|slot| self.places.get(slot)) {
            Some(&place) => place.into(),
            None => usize::MAX,
        }
    }

    /// The object that the ray leaves, if it is one of these, and the side.
    #[inline]
    fn left(&self, ray: &Ray, first: usize) -> Option<(&Object<'_, S, M>, Side)> {
        let Departure { object, side } = ray.departure?;
        Some((self.object(object.wrapping_sub(first))?, side))
    }

    /// The objects of a leaf.
    #[inline(always)]
    fn leaf(&self, leaf: Link) -> &[Object<'_, S, M>] {
        let first = leaf.first();
        self.objects
            .get(first..first + leaf.count())
            .unwrap_or_default()
    }
}

/// Bounds that a ray meets and has not yet looked into, each with the distance before which nothing in
/// it is met. Each node on the way to an object leaves at most one, so `DEPTH` always suffices.
type Waiting<const DEPTH: usize> = Vec<(f32, Link), DEPTH>;

const ROOT: Link = Link(0);

/// The next leaf in which something before `t_max` may be met: from `start`, or else from what waits;
/// of two, the nearer first.
#[inline]
fn next_leaf<S, B: Bound<S>, const DEPTH: usize>(
    nodes: &[Node<B>],
    probe: &B::Probe,
    waiting: &mut Waiting<DEPTH>,
    mut start: Option<Link>,
    t_max: f32,
) -> Option<Link> {
    // In registers, whatever is written to `waiting`.
    let probe = *probe;
    loop {
        let mut link = match start.take() {
            Some(link) => link,
            None => {
                let (near, link) = waiting.pop()?;
                // Something nearer may have been found since.
                if near > t_max {
                    continue;
                }
                link
            }
        };
        // Nodes lie after those that lead to them: this ends.
        loop {
            if link.is_leaf() {
                return Some(link);
            }
            let Node([a, b]) = nodes.get(link.first())?;
            link = match (a.bound.enter(&probe, t_max), b.bound.enter(&probe, t_max)) {
                (Some(a_near), Some(b_near)) => {
                    let (near, far) = if a_near <= b_near {
                        (a.link, (b_near, b.link))
                    } else {
                        (b.link, (a_near, a.link))
                    };
                    let fits = waiting.push(far).is_ok();
                    debug_assert!(fits, "more than one bound waits at a depth");
                    near
                }
                (Some(_), None) => a.link,
                (None, Some(_)) => b.link,
                (None, None) => break,
            };
        }
    }
}

impl<S: Shape, M, B: Bound<S>, const DEPTH: usize, I: Copy + Into<usize>> Geometry
    for Hierarchy<'_, S, M, B, DEPTH, I>
{
    type Material = M;

    #[inline(always)]
    fn len(&self) -> usize {
        self.objects.len()
    }

    #[inline]
    fn nearest<P: Math>(&self, ray: &mut Ray, first: usize, _: Candidates) -> Option<usize> {
        let setup = S::setup(ray);
        let left = self.left(ray, first);
        // Distance, and place of the object.
        let mut nearest = None;
        if let Some((object, side)) = left
            && let Some(t) = object.shape.intersect::<P>(ray, &setup, Some(side))
        {
            nearest = Some((t, self.place(object)));
            ray.t_max = up_to(t);
        }
        let probe = B::probe(ray, self.slack);
        let mut waiting = Waiting::<DEPTH>::new();
        let mut start = Some(ROOT);
        while let Some(leaf) = next_leaf(self.nodes, &probe, &mut waiting, start.take(), ray.t_max)
        {
            for object in self.leaf(leaf) {
                math::keep_rolled();
                if is(left, object) {
                    continue;
                }
                if let Some(t) = object.shape.intersect::<P>(ray, &setup, None) {
                    let place = self.place(object);
                    // Of equally near ones the first, in whatever order they are met.
                    if nearest.is_none_or(|it| t < it.0 || place < it.1) {
                        nearest = Some((t, place));
                        ray.t_max = up_to(t);
                    }
                }
            }
        }
        let (t, place) = nearest?;
        ray.t_max = t;
        Some(first.wrapping_add(place))
    }

    #[inline]
    fn surface<P: Math>(
        &self,
        ray: &Ray,
        t: f32,
        object: usize,
        first: usize,
    ) -> Option<(Vec3, &M)> {
        let object = self.object(object.wrapping_sub(first))?;
        Some((object.shape.normal::<P>(ray, t), object.material))
    }

    #[inline]
    fn uv(&self, point: Vec3, object: usize, first: usize) -> (f32, f32) {
        match self.object(object.wrapping_sub(first)) {
            Some(object) => object.shape.uv(point),
            None => (0.0, 0.0),
        }
    }

    #[inline]
    fn blocks<P: Math>(&self, ray: &Ray, first: usize, _: Candidates) -> bool {
        let setup = S::setup(ray);
        let left = self.left(ray, first);
        if let Some((object, side)) = left
            && object
                .shape
                .intersect::<P>(ray, &setup, Some(side))
                .is_some()
        {
            return true;
        }
        let probe = B::probe(ray, self.slack);
        let mut waiting = Waiting::<DEPTH>::new();
        let mut start = Some(ROOT);
        while let Some(leaf) = next_leaf(self.nodes, &probe, &mut waiting, start.take(), ray.t_max)
        {
            for object in self.leaf(leaf) {
                math::keep_rolled();
                if !is(left, object) && object.shape.intersect::<P>(ray, &setup, None).is_some() {
                    return true;
                }
            }
        }
        false
    }

    #[inline]
    fn absorbs<P: Math, L: Passage>(
        &self,
        ray: &Ray,
        first: usize,
        _: Candidates,
        light: &mut L,
    ) -> bool
    where
        M: Finish,
    {
        let setup = S::setup(ray);
        let left = self.left(ray, first);
        // Whether all light ends at this object.
        let mut crosses = |object: &Object<'_, S, M>, leaving| {
            let times = object.shape.crossings::<P>(ray, &setup, leaving);
            let inside = || object.shape.inside::<P>(ray, &setup, leaving);
            light.pass(object.material.transmission(), times, inside)
        };
        if let Some((object, side)) = left
            && crosses(object, Some(side))
        {
            return true;
        }
        let probe = B::probe(ray, self.slack);
        let mut waiting = Waiting::<DEPTH>::new();
        let mut start = Some(ROOT);
        while let Some(leaf) = next_leaf(self.nodes, &probe, &mut waiting, start.take(), ray.t_max)
        {
            for object in self.leaf(leaf) {
                math::keep_rolled();
                if !is(left, object) && crosses(object, None) {
                    return true;
                }
            }
        }
        false
    }
}

/// The end of the interval that holds `t`, a distance that a ray admitted, and nothing beyond.
#[inline(always)]
fn up_to(t: f32) -> f32 {
    f32::from_bits(t.to_bits().wrapping_add(1))
}

/// Whether `object` is the one that is left; a comparison of addresses, which loops have at hand.
#[inline(always)]
fn is<T>(left: Option<(&T, Side)>, object: &T) -> bool {
    left.is_some_and(|(left, _)| core::ptr::eq(left, object))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::plane::Plane;
    use crate::{Geometry, Hit};

    type Balls<const DEPTH: usize> = Hierarchy<'static, Sphere, u8, Ball, DEPTH, u8>;

    const fn ball(x: f32, material: &'static u8) -> Object<'static, Sphere, u8> {
        let center = Vec3::new(x, 0.0, 0.0);
        let shape = Sphere {
            center,
            radius: 1.0,
        };
        Object { shape, material }
    }

    const fn around(x: f32, radius: f32, link: u32) -> Child<Ball> {
        let center = Vec3::new(x, 0.0, 0.0);
        Child {
            bound: Ball { center, radius },
            link: Link::from_bits(link),
        }
    }

    /// A row along x: the places 2, 0, 3 and 1. The last two are the same ball.
    static ROW: [Object<Sphere, u8>; 4] =
        [ball(-5.0, &2), ball(0.0, &0), ball(5.0, &3), ball(5.0, &1)];
    static NODES: [Node<Ball>; 2] = [
        Node([around(-5.0, 1.01, 0x8100_0000), around(2.5, 3.6, 1)]),
        Node([
            around(0.0, 1.01, 0x8100_0001),
            around(5.0, 1.01, 0x8200_0002),
        ]),
    ];
    static PLACES: [u8; 4] = [2, 0, 3, 1];
    static SLOTS: [u8; 4] = [1, 3, 0, 2];
    static TREE: Balls<2> = match Hierarchy::new(&NODES, &ROW, &PLACES, &SLOTS, SLACK) {
        Ok(tree) => tree,
        Err(_) => panic!("not a tree"),
    };

    fn place_and_t(hit: Option<Hit<'_, u8>>) -> Option<(usize, f32)> {
        // The material says the same as the place.
        hit.inspect(|it| assert_eq!(usize::from(*it.material), it.object % 10))
            .map(|it| (it.object, it.t))
    }

    #[test]
    fn places_are_those_of_the_slice_and_of_equals_the_first_wins() {
        let cases = [
            ("from the left", Vec3::X * -9.0, Vec3::X, Some((2, 3.0))),
            ("from the right", Vec3::X * 9.0, Vec3::NEG_X, Some((1, 3.0))),
            ("from inside", Vec3::ZERO, Vec3::X, Some((0, 1.0))),
            ("between", Vec3::new(-2.5, 0.0, -9.0), Vec3::Z, None),
            ("away", Vec3::X * 9.0, Vec3::X, None),
            ("nowhere", Vec3::NAN, Vec3::X, None),
            ("no direction", Vec3::X * -9.0, Vec3::NAN, None),
        ];
        for (name, origin, direction, expected) in cases {
            let ray = Ray::new(origin, direction);
            assert_eq!(place_and_t(TREE.closest_hit(&ray)), expected, "{name}");
            assert_eq!(TREE.occluded(&ray), expected.is_some(), "{name}");
        }
        let short = Ray {
            t_max: 3.0,
            ..Ray::new(Vec3::X * -9.0, Vec3::X)
        };
        assert_eq!(place_and_t(TREE.closest_hit(&short)), None);
        assert_eq!(TREE.len(), 4);
    }

    #[test]
    fn pairs_count_on_and_departures_name_places() {
        let wall = [Object {
            shape: Plane {
                point: Vec3::X * 20.0,
                normal: Vec3::NEG_X,
            },
            material: &9,
        }];
        let floor = wall.each_ref().map(|it| Object {
            shape: it.shape,
            material: &0,
        });
        let pair = (wall.as_slice(), (TREE, floor.as_slice()));
        let hit = pair
            .closest_hit(&Ray::new(Vec3::X * -9.0, Vec3::X))
            .unwrap();
        assert_eq!((hit.object, *hit.material), (3, 2));
        let inside = hit.through(Vec3::X);
        let exit = pair.closest_hit(&inside).unwrap();
        assert_eq!((exit.object, exit.t, exit.front), (3, 2.0, false));
        let beyond = exit.through(Vec3::X);
        assert_eq!(pair.closest_hit(&beyond).unwrap().object, 1);
        assert_eq!(pair.len(), 6);
        assert_eq!(pair.closest_hit(&hit.back(Vec3::NEG_X)), None);
    }

    #[test]
    fn what_is_no_tree_is_refused() {
        let swapped = [NODES[1], NODES[0]];
        let circle = [Node([around(0.0, 9.0, 0), around(0.0, 9.0, 0x8400_0000)])];
        let twice = [Node([
            around(0.0, 9.0, 0x8200_0000),
            around(0.0, 9.0, 0x8200_0000),
        ])];
        let none = [Node([
            around(0.0, 9.0, 0x8000_0000),
            around(0.0, 9.0, 0x8400_0000),
        ])];
        let too_few = [Node([
            around(0.0, 9.0, 0x8100_0000),
            around(0.0, 9.0, 0x8200_0001),
        ])];
        let beyond = [Node([
            around(0.0, 9.0, 0x8400_0000),
            around(0.0, 9.0, 0x8100_0004),
        ])];
        let far = [Node([around(0.0, 9.0, 7), around(0.0, 9.0, 0x8400_0000)])];
        let huge = [Node([
            around(0.0, 9.0, 0x7f00_0001),
            around(0.0, 9.0, 0x8400_0000),
        ])];
        let unused = [NODES[0], NODES[1], NODES[1]];
        let cases: [(&str, &[Node<Ball>], _); 10] = [
            ("no nodes", &[], HierarchyError::Empty),
            ("leaves out of order", &swapped, HierarchyError::Leaf(0)),
            ("a node in itself", &circle, HierarchyError::Order(1)),
            ("objects twice", &twice, HierarchyError::Leaf(2)),
            ("an empty leaf", &none, HierarchyError::Leaf(0)),
            ("too few objects", &too_few, HierarchyError::Leaf(3)),
            ("more than there are", &beyond, HierarchyError::Leaf(5)),
            ("a node that is not there", &far, HierarchyError::Order(1)),
            ("bits without meaning", &huge, HierarchyError::Order(1)),
            (
                "a node that nothing leads to",
                &unused,
                HierarchyError::Order(2),
            ),
        ];
        for (name, nodes, error) in cases {
            let tree = Balls::<8>::error(nodes, &PLACES, SLACK);
            assert_eq!(tree, Some(error), "{name}");
        }
        assert_eq!(
            Balls::<1>::error(&NODES, &PLACES, SLACK),
            Some(HierarchyError::TooDeep)
        );
        assert_eq!(
            Balls::<0>::error(&NODES, &PLACES, SLACK),
            Some(HierarchyError::TooDeep)
        );
        assert_eq!(
            Balls::<2>::error(&NODES, &[0; 3], SLACK),
            Some(HierarchyError::Lengths)
        );
        for slack in [-SLACK, f32::NAN, f32::INFINITY] {
            assert_eq!(
                Balls::<2>::error(&NODES, &PLACES, slack),
                Some(HierarchyError::Slack)
            );
        }
        assert_eq!(Balls::<2>::error(&NODES, &PLACES, SLACK), None);
    }

    impl<const DEPTH: usize> Balls<DEPTH> {
        fn error(nodes: &[Node<Ball>], places: &[u8], slack: f32) -> Option<HierarchyError> {
            Hierarchy::<_, _, _, DEPTH, _>::new(nodes, &ROW, places, &SLOTS, slack).err()
        }
    }

    #[test]
    fn places_that_are_none_are_never_a_panic() {
        let places = [9; 4];
        let tree = Hierarchy::<_, _, _, 2, u8>::new(&NODES, &ROW, &places, &places, SLACK).unwrap();
        let ray = Ray::new(Vec3::X * -9.0, Vec3::X);
        assert_eq!(tree.closest_hit(&ray), None);
        assert!(tree.occluded(&ray));
    }

    #[test]
    fn nodes_are_as_small_as_said() {
        assert_eq!(size_of::<Node<Aabb>>(), 56);
        assert_eq!(size_of::<Node<Ball>>(), 40);
        assert_eq!(size_of::<(f32, Link)>(), 8);
    }
}
