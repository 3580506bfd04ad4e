//! A hierarchy of boxes over the objects of one slice, in flash.
//!
//! A [`Hierarchy`] answers every query with the bits, and the objects' places, of the slice that it
//! was built over; it only looks at fewer of them. It is as much a [`Geometry`] as a slice is, so that
//! a pair may hold a hierarchy of spheres, one of triangles and a bare plane. `whitted bake` and the
//! builder in `whitted-cli` make the arrays; nothing is built here, and nothing is allocated.
//!
//! # Why no hit is ever lost
//!
//! Boxes are tested with a margin *e*, a [`slack`](Hierarchy::new) times the greatest coordinate of
//! the ray's origin and of the box. The second part is in the stored boxes, the first is added once
//! a ray: the rounding of what is computed grows with the distance from which a ray comes, so that no
//! margin of a box alone could do. With u = 2^-24, what the kernels in [`crate::shape`] report as
//! hit satisfies, within less than half of the usual slack of 128 u:
//!
//! 1. the ray's line passes the shape's box at no more than *e*;
//! 2. at the reported distance, the ray's coordinate along the axis to which it is most parallel lies
//!    within *e* of the box's.
//!
//! For the solids both follow from the kernels' backward error: the reported point is a point of the
//! surface up to a few u of the coordinates. For outlines the first is the error of the shear; the
//! second is why their kernels keep a distance found edge-on within the outline's own. A box is
//! passed over if either fails, and only then: its other two slabs are not asked at which distance
//! they are met, for the distance to an outline has no bound there. The sums here round by
//! another 7 u, which the slack covers as well.
//!
//! The object that a ray leaves is met where its chord ends, which may lie off its box by the
//! rounding of the point that is left. It is looked up and tested apart.

use core::fmt;

use glam::Vec3;
use heapless::Vec;

use crate::geometry::{Geometry, Object};
use crate::material::{Finish, Transmission};
use crate::math::{self, Math, Transmittance};
use crate::ray::{Departure, Ray, Side};
use crate::shape::Shape;

/// What a box is round: a node, or some objects next to each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Link(u32);

impl Link {
    /// Most objects of a [`leaf`](Self::leaf).
    pub const MAX_COUNT: u32 = 127;
    /// Objects of a leaf, and nodes, lie before this place.
    pub const END: u32 = 1 << 24;
    const LEAF: u32 = 1 << 31;

    /// A node, by its place among the nodes.
    ///
    /// # Errors
    ///
    /// `None` where the place is not before [`END`](Self::END).
    pub const fn node(place: u32) -> Option<Self> {
        if place < Self::END {
            Some(Self(place))
        } else {
            None
        }
    }

    /// `count` objects from the slot `first` on.
    ///
    /// # Errors
    ///
    /// `None` where they are none or more than [`MAX_COUNT`](Self::MAX_COUNT), or do not all lie before
    /// [`END`](Self::END).
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

/// A box with its margin, and what is in it. 28 bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Child {
    /// In world space.
    pub center: Vec3,
    /// From the center to the faces, and the slack times the greatest coordinate in the box.
    pub half: Vec3,
    /// What is in the box.
    pub link: Link,
}

/// Two boxes. 56 bytes; over n objects in leaves of k there are n/k - 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node(pub [Child; 2]);

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
    /// The slack is not a number of at least 2^-17.
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
            Self::Slack => f.write_str("the slack must be a number of at least 2^-17"),
        }
    }
}

impl core::error::Error for HierarchyError {}

/// Objects of one kind under a hierarchy of boxes: a [`Geometry`] with the bits of the plain slice,
/// for rays whose direction is unit length.
///
/// `DEPTH` is the most nodes on the way to an object; queries use 8 bytes of stack for each. `I`
/// holds places: `u8` or `u16`, or `usize` where there are more than 2^16 objects.
///
/// Below about eight objects the slice itself is faster. By the [`Micro`](crate::Micro) policy hits
/// lie off their surfaces by percents of a radius, and those off their boxes may be missed.
#[derive(Debug, PartialEq)]
pub struct Hierarchy<'a, S, M, const DEPTH: usize, I = u16> {
    nodes: &'a [Node],
    objects: &'a [Object<'a, S, M>],
    places: &'a [I],
    slots: &'a [I],
    slack: f32,
}

impl<S, M, const DEPTH: usize, I> Clone for Hierarchy<'_, S, M, DEPTH, I> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<S, M, const DEPTH: usize, I> Copy for Hierarchy<'_, S, M, DEPTH, I> {}

/// The slack that covers the rounding of the kernels in [`crate::shape`], cones of a slope of at most
/// 1 included.
pub const SLACK: f32 = 1.0 / (1 << 17) as f32;

impl<'a, S, M, const DEPTH: usize, I> Hierarchy<'a, S, M, DEPTH, I> {
    /// A hierarchy of arrays that a builder made; in a `static`, an error is one of the build.
    ///
    /// `objects` are in the order of the leaves. What counts objects by their places in the slice
    /// that was built over, [`Hit::object`](crate::Hit::object) for one, finds them by `places`, the
    /// place of each slot, and `slots`, the slot of each place.
    ///
    /// `slack` is [`SLACK`], or more for shapes that are met further off their boxes. That boxes
    /// hold what is in them, and that `places` and `slots` are each other's inverse, is not checked:
    /// objects may then be missed or mistaken for others, but nothing worse.
    ///
    /// # Errors
    ///
    /// Where the arrays do not make a tree; see [`HierarchyError`].
    pub const fn new(
        nodes: &'a [Node],
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
        if !(slack >= SLACK && slack < f32::INFINITY) {
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

impl<S, M, const DEPTH: usize, I: Copy + Into<usize>> Hierarchy<'_, S, M, DEPTH, I> {
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

/// A ray's way through the nodes: the leaves whose boxes it meets, the nearest of two first.
struct Walk<const DEPTH: usize> {
    /// Each node on the way leaves at most one box waiting, so `DEPTH` always suffices. With each, the
    /// distance before which nothing in it is met.
    waiting: Vec<(f32, Link), DEPTH>,
    origin: Vec3,
    direction: Vec3,
    /// Of the direction's components.
    magnitude: Vec3,
    /// Margin of the tests across each axis.
    margin: Vec3,
    /// Takes an offset to how far the ray has to go for it along the axis to which it is most parallel.
    rate: Vec3,
    /// Margin of such distances.
    margin_along: f32,
}

impl<const DEPTH: usize> Walk<DEPTH> {
    #[inline]
    fn new(ray: &Ray, slack: f32) -> Self {
        let (o, d) = (ray.origin.abs(), ray.direction);
        let magnitude = d.abs();
        let rate = if magnitude.x > magnitude.y && magnitude.x > magnitude.z {
            Vec3::new(1.0 / d.x, 0.0, 0.0)
        } else if magnitude.y > magnitude.z {
            Vec3::new(0.0, 1.0 / d.y, 0.0)
        } else {
            Vec3::new(0.0, 0.0, 1.0 / d.z)
        };
        let margin = slack * math::max_component(o);
        let across = Vec3::new(
            magnitude.y + magnitude.z,
            magnitude.z + magnitude.x,
            magnitude.x + magnitude.y,
        );
        let mut waiting = Vec::new();
        let fits = waiting.push((0.0, Link(0))).is_ok();
        debug_assert!(fits, "a hierarchy has at least one node");
        Self {
            waiting,
            origin: ray.origin,
            direction: d,
            magnitude,
            // Products that leave the normal range round by more than a share of themselves.
            margin: across * margin + Vec3::splat(f32::MIN_POSITIVE),
            rate,
            // The fastest coordinate covers at least 1/√3 of the way.
            margin_along: 2.0 * margin,
        }
    }

    /// Distance before which nothing in the box is met; infinite where nothing in it is met at all.
    ///
    /// The line is tested against the box by separating axes: S. Gottschalk, M. C. Lin, D. Manocha,
    /// "OBBTree", SIGGRAPH 1996, for the axes that the box's edges and the line span. No division, so
    /// that directions along an axis are like any other.
    #[inline(always)]
    fn enters(&self, child: &Child, t_max: f32) -> f32 {
        let (m, h) = (child.center - self.origin, child.half);
        let (d, a) = (self.direction, self.magnitude);
        // All of these are also false for NaN, with which nothing is hit.
        let x = (m.y * d.z - m.z * d.y).abs() <= h.y * a.z + h.z * a.y + self.margin.x;
        if !x {
            return f32::INFINITY;
        }
        let y = (m.z * d.x - m.x * d.z).abs() <= h.z * a.x + h.x * a.z + self.margin.y;
        if !y {
            return f32::INFINITY;
        }
        let z = (m.x * d.y - m.y * d.x).abs() <= h.x * a.y + h.y * a.x + self.margin.z;
        if !z {
            return f32::INFINITY;
        }
        let middle = m.dot(self.rate);
        let reach = h.dot(self.rate).abs() + self.margin_along;
        let near = middle - reach;
        if near <= t_max && middle + reach >= 0.0 {
            near
        } else {
            f32::INFINITY
        }
    }

    /// The next leaf in which something before `t_max` may be met.
    #[inline]
    fn next(&mut self, nodes: &[Node], t_max: f32) -> Option<Link> {
        loop {
            let (near, mut link) = self.waiting.pop()?;
            // Something nearer may have been found since.
            let mut near = if near <= t_max { near } else { f32::INFINITY };
            // Nodes lie after those that lead to them.
            while near < f32::INFINITY {
                if link.is_leaf() {
                    return Some(link);
                }
                let Node([first, second]) = nodes.get(link.first())?;
                let (first_near, second_near) =
                    (self.enters(first, t_max), self.enters(second, t_max));
                let far;
                (near, link, far) = if first_near <= second_near {
                    (first_near, first.link, (second_near, second.link))
                } else {
                    (second_near, second.link, (first_near, first.link))
                };
                if far.0 < f32::INFINITY {
                    let fits = self.waiting.push(far).is_ok();
                    debug_assert!(fits, "more than one box waits at a depth");
                }
            }
        }
    }
}

impl<S: Shape, M, const DEPTH: usize, I: Copy + Into<usize>> Geometry
    for Hierarchy<'_, S, M, DEPTH, I>
{
    type Material = M;

    #[inline(always)]
    fn len(&self) -> usize {
        self.objects.len()
    }

    #[inline]
    fn nearest<P: Math>(&self, ray: &mut Ray, first: usize) -> Option<usize> {
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
        let mut walk = Walk::<DEPTH>::new(ray, self.slack);
        while let Some(leaf) = walk.next(self.nodes, ray.t_max) {
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
        Some(first + place)
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
    fn blocks<P: Math>(&self, ray: &Ray, first: usize) -> bool {
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
        let mut walk = Walk::<DEPTH>::new(ray, self.slack);
        while let Some(leaf) = walk.next(self.nodes, ray.t_max) {
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
    fn absorbs<P: Math>(&self, ray: &Ray, first: usize, light: &mut Transmittance) -> bool
    where
        M: Finish,
    {
        let setup = S::setup(ray);
        let left = self.left(ray, first);
        // Whether all light ends at this object.
        let mut crosses = |object: &Object<'_, S, M>, leaving| {
            let times = object.shape.crossings::<P>(ray, &setup, leaving);
            let factor = object.material.transmission().transmittance();
            if times > 0 && factor > 0.0 {
                light.cross(factor, times);
            }
            // Also true for NaN.
            times > 0 && !(factor > 0.0)
        };
        if let Some((object, side)) = left
            && crosses(object, Some(side))
        {
            return true;
        }
        let mut walk = Walk::<DEPTH>::new(ray, self.slack);
        while let Some(leaf) = walk.next(self.nodes, ray.t_max) {
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
