//! Builds [hierarchies](whitted::Hierarchy) of boxes, for rendering here and for baking.
//!
//! Top down, by the surface-area heuristic over bins of centroids: J. D. MacDonald, K. S. Booth,
//! "Heuristics for Ray Tracing Using Space Subdivision", The Visual Computer 6(3), 1990; I. Wald,
//! "On Fast Construction of SAH-Based Bounding Volume Hierarchies", RT 2007. One thread, no
//! randomness: the same objects make the same tree.

use std::ops::Range;

use glam::{Vec3, Vec3A};
use whitted::hierarchy::{Child, Link, Node, SLACK};
use whitted::{Cuboid, Frustum, Patch, Polygon, Sphere, Triangle};

/// A box round all points at which rays can be met by a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Least coordinates.
    pub min: Vec3,
    /// Greatest coordinates.
    pub max: Vec3,
    /// How far off the box hits may be reported: times the greatest coordinate of the ray's origin and
    /// of the box. [`SLACK`] is twice what the shapes of [`whitted::shape`] need, but for steep cones.
    pub slack: f32,
}

/// A shape that has bounds.
pub trait Bounded {
    /// What holds it.
    fn bounds(&self) -> Bounds;
}

impl Bounds {
    /// Round a box in `f64`, outwards.
    fn around(min: [f64; 3], max: [f64; 3], slack: f32) -> Self {
        let below = |x: f64| {
            let near = x as f32;
            if f64::from(near) > x {
                near.next_down()
            } else {
                near
            }
        };
        Self {
            min: Vec3::from_array(min.map(below)),
            max: Vec3::from_array(max.map(|x| -below(-x))),
            slack,
        }
    }

    /// Of an outline in the plane with this normal.
    fn of_outline(vertices: &[Vec3], normal: Vec3) -> Self {
        let (mut min, mut max) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
        let normal = normal.as_dvec3();
        for vertex in vertices {
            let vertex = vertex.as_dvec3();
            for (axis, x) in vertex.to_array().into_iter().enumerate() {
                min[axis] = min[axis].min(x);
                max[axis] = max[axis].max(x);
            }
            let height = normal.dot(vertex);
            lowest = lowest.min(height);
            highest = highest.max(height);
        }
        // The plane through one vertex is met, which the others may be off. A ray goes up to 8 times
        // as far between the two before it counts as edge-on.
        let warp = 8.0 * (highest - lowest);
        Self::around(min.map(|x| x - warp), max.map(|x| x + warp), SLACK)
    }
}

impl Bounded for Sphere {
    fn bounds(&self) -> Bounds {
        let (center, radius) = (self.center.to_array(), f64::from(self.radius.abs()));
        Bounds::around(
            center.map(|x| f64::from(x) - radius),
            center.map(|x| f64::from(x) + radius),
            SLACK,
        )
    }
}

impl Bounded for Polygon<'_> {
    fn bounds(&self) -> Bounds {
        Bounds::of_outline(self.vertices, self.normal)
    }
}

impl Bounded for Triangle {
    fn bounds(&self) -> Bounds {
        Bounds::of_outline(&self.vertices, self.normal)
    }
}

impl Bounded for Patch {
    fn bounds(&self) -> Bounds {
        Bounds::of_outline(&self.vertices, self.normal)
    }
}

impl Bounded for Cuboid {
    fn bounds(&self) -> Bounds {
        Bounds {
            min: self.min,
            max: self.max,
            slack: SLACK,
        }
    }
}

impl Bounded for Frustum {
    fn bounds(&self) -> Bounds {
        let length = f64::from(self.length);
        let slope = f64::from(self.slope);
        let base_radius = f64::from(self.base_radius);
        let apex_radius = base_radius + slope * length;
        let (base, axis) = (self.base.as_dvec3(), self.axis.as_dvec3());
        let apex = base + axis * length;
        // A circle reaches as far along a coordinate axis as that is across its own.
        let across = axis.to_array().map(|a| (1.0 - a * a).max(0.0).sqrt());
        // Where a ray is parallel to the side, the kernel's quadratic is nearly linear and its residual
        // no longer small against the radius, only its root against the whole.
        let stray =
            (length + base_radius.abs().max(apex_radius.abs())) * (1.0 + slope.abs()) / 2048.0;
        let end = |center: [f64; 3], radius: f64, axis: usize| {
            let reach = across[axis] * radius.abs() + stray;
            (center[axis] - reach, center[axis] + reach)
        };
        let (mut min, mut max) = ([0.0; 3], [0.0; 3]);
        for axis in 0..3 {
            let ends = [
                end(base.to_array(), base_radius, axis),
                end(apex.to_array(), apex_radius, axis),
            ];
            min[axis] = ends[0].0.min(ends[1].0);
            max[axis] = ends[0].1.max(ends[1].1);
        }
        // Just beyond an end, a steep cone is wider by its slope.
        Bounds::around(min, max, SLACK * (1.0 + self.slope.abs()))
    }
}

/// What a tree is built for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// What it costs to test both boxes of a node, in tests of objects.
    pub node_cost: f32,
    /// Most objects of a leaf, at most [`Link::MAX_COUNT`].
    pub leaf: usize,
    /// Most nodes on the way to an object, where there are few enough objects for that.
    pub depth: usize,
}

/// A hierarchy before it has objects.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    /// In depth-first order.
    pub nodes: Vec<Node>,
    /// For each slot, the place that its object had.
    pub places: Vec<u32>,
    /// Most nodes on the way to an object.
    pub depth: usize,
    /// The most that any object needs.
    pub slack: f32,
}

impl Tree {
    /// A tree over objects with these bounds; `None` where there are fewer than two.
    ///
    /// # Panics
    ///
    /// With more than [`Link::END`] objects.
    pub fn new(bounds: &[Bounds], settings: Settings) -> Option<Self> {
        assert!(bounds.len() <= Link::END as usize, "too many objects");
        if bounds.len() < 2 {
            return None;
        }
        let mut builder = Builder {
            settings,
            slack: bounds.iter().fold(SLACK, |most, it| most.max(it.slack)),
            boxes: bounds.iter().map(Aabb::from).collect(),
            places: (0..bounds.len() as u32).collect(),
            nodes: Vec::new(),
            depth: 0,
        };
        let all = Group::new(0..bounds.len(), &builder.boxes);
        let split = Split::best(&builder.boxes, &all, settings.node_cost);
        builder.node(&all, split, 1);
        Some(Self {
            nodes: builder.nodes,
            places: builder.places,
            depth: builder.depth,
            slack: builder.slack,
        })
    }

    /// For each place, the slot in which its object is.
    pub fn slots(&self) -> Vec<u32> {
        let mut slots = vec![0; self.places.len()];
        for (&place, slot) in self.places.iter().zip(0..) {
            slots[place as usize] = slot;
        }
        slots
    }
}

/// Four lanes, so that all coordinates are compared at once.
#[derive(Clone, Copy)]
struct Aabb {
    min: Vec3A,
    max: Vec3A,
}

impl From<&Bounds> for Aabb {
    fn from(bounds: &Bounds) -> Self {
        Self {
            min: bounds.min.into(),
            max: bounds.max.into(),
        }
    }
}

impl Aabb {
    const EMPTY: Self = Self {
        min: Vec3A::INFINITY,
        max: Vec3A::NEG_INFINITY,
    };

    /// Twice the center.
    #[inline(always)]
    fn center(self) -> Vec3A {
        self.min + self.max
    }

    #[inline(always)]
    fn with(self, point: Vec3A) -> Self {
        self.join(Self {
            min: point,
            max: point,
        })
    }

    #[inline(always)]
    fn join(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// Half of the surface.
    #[inline(always)]
    fn area(self) -> f32 {
        let d = self.max - self.min;
        d.x * d.y + d.y * d.z + d.z * d.x
    }
}

/// Some objects to be put under one box.
struct Group {
    range: Range<usize>,
    bounds: Aabb,
    /// Of the [centers](Item::center).
    centers: Aabb,
}

struct Builder {
    settings: Settings,
    slack: f32,
    boxes: Vec<Aabb>,
    /// Of the object in each of the boxes.
    places: Vec<u32>,
    nodes: Vec<Node>,
    depth: usize,
}

impl Builder {
    /// Divides a group of at least two, and makes its node and all that follows in depth-first order.
    fn node(&mut self, group: &Group, split: Option<Split>, depth: usize) {
        self.depth = self.depth.max(depth);
        let place = self.nodes.len();
        self.nodes.push(UNFINISHED);
        let halves = self.divide(group, split, depth);
        for (half, group) in halves.iter().enumerate() {
            let link = self.link(group, depth);
            self.nodes[place].0[half] = self.child(group.bounds, link);
        }
    }

    /// What is in the box of a group: a leaf, or a node with more under it.
    fn link(&mut self, group: &Group, depth: usize) -> Link {
        let count = group.range.len();
        let split = Split::best(
            &self.boxes[group.range.clone()],
            group,
            self.settings.node_cost,
        );
        let pays = split
            .as_ref()
            .is_some_and(|it| it.cost < count as f32 * group.bounds.area());
        if count <= self.settings.leaf && !(pays && depth < self.settings.depth) {
            return Link::leaf(group.range.start as u32, count as u32)
                .expect("leaves are small and objects counted");
        }
        let node = Link::node(self.nodes.len() as u32).expect("there are fewer nodes than objects");
        self.node(group, split, depth + 1);
        node
    }

    /// Two halves of a group. `depth` is how many nodes lead to them.
    fn divide(&mut self, group: &Group, split: Option<Split>, depth: usize) -> [Group; 2] {
        let boxes = &mut self.boxes[group.range.clone()];
        let places = &mut self.places[group.range.clone()];
        // What may be in one half if the limit of depth is to be kept.
        let levels = self.settings.depth.saturating_sub(depth).min(32);
        let room = self.settings.leaf << levels;
        let first_count = match split {
            Some(split) if split.counts.iter().all(|&it| it <= room) => split.apply(boxes, places),
            _ => halve(boxes, places, group),
        };
        let middle = group.range.start + first_count;
        [group.range.start..middle, middle..group.range.end].map(|range| {
            let boxes = &self.boxes[range.clone()];
            Group::new(range, boxes)
        })
    }

    fn child(&self, bounds: Aabb, link: Link) -> Child {
        let [min, max] = [bounds.min, bounds.max].map(|it| Vec3::from(it).as_dvec3());
        let center = ((min + max) * 0.5).as_vec3();
        let greatest = min.abs().max(max.abs()).max_element();
        let margin = f64::from(self.slack) * greatest;
        let half = (max - center.as_dvec3()).max(center.as_dvec3() - min) + margin;
        Child {
            center,
            // Rounding to nearest may have gone down.
            half: half.as_vec3().map(f32::next_up),
            link,
        }
    }
}

/// Stands where a node will be.
const UNFINISHED: Node = Node(
    [Child {
        center: Vec3::ZERO,
        half: Vec3::ZERO,
        link: Link::from_bits(0),
    }; 2],
);

impl Group {
    fn new(range: Range<usize>, boxes: &[Aabb]) -> Self {
        let (mut bounds, mut centers) = (Aabb::EMPTY, Aabb::EMPTY);
        for it in boxes {
            bounds = bounds.join(*it);
            centers = centers.with(it.center());
        }
        Self {
            range,
            bounds,
            centers,
        }
    }
}

const MOST_BINS: usize = 16;

/// Where to divide a group.
struct Split {
    binning: Binning,
    axis: usize,
    /// The first bin of the second half.
    bin: usize,
    /// Of the halves.
    counts: [usize; 2],
    /// Times the area of the box: what a ray that meets the box costs.
    cost: f32,
}

impl Split {
    /// The cheapest; `None` where all centers are the same.
    fn best(boxes: &[Aabb], group: &Group, node_cost: f32) -> Option<Self> {
        // More bins than boxes find nothing more.
        let binning = Binning::new(group.centers, boxes.len().min(MOST_BINS));
        let mut bins = [[(Aabb::EMPTY, 0_u32); MOST_BINS]; 3];
        for it in boxes {
            for (bins, bin) in bins.iter_mut().zip(binning.bins(it.center())) {
                let (bounds, count) = &mut bins[bin];
                *bounds = bounds.join(*it);
                *count += 1;
            }
        }
        let base = node_cost * group.bounds.area();
        let mut best = Self {
            binning,
            axis: 0,
            bin: 0,
            counts: [0; 2],
            cost: f32::INFINITY,
        };
        for (axis, bins) in bins.iter().enumerate() {
            let bins = &bins[..binning.count];
            // What would be in the first half, and its cost, for each first bin of the second.
            let mut firsts = [(0.0, 0); MOST_BINS];
            let (mut bounds, mut first_count) = (Aabb::EMPTY, 0);
            for (first, bin) in firsts[1..].iter_mut().zip(bins) {
                bounds = bounds.join(bin.0);
                first_count += bin.1;
                *first = (bounds.area() * first_count as f32, first_count);
            }
            let (mut bounds, mut count) = (Aabb::EMPTY, 0);
            for (bin, (&(first_cost, first_count), it)) in firsts.iter().zip(bins).enumerate().rev()
            {
                bounds = bounds.join(it.0);
                count += it.1;
                let cost = base + (first_cost + bounds.area() * count as f32);
                // Not a number, or no second half, where one of the two is empty.
                if cost < best.cost && first_count > 0 && count > 0 {
                    best.axis = axis;
                    best.bin = bin;
                    best.counts = [first_count as usize, count as usize];
                    best.cost = cost;
                }
            }
        }
        (best.cost < f32::INFINITY).then_some(best)
    }

    /// Moves the first half to the front; its size.
    fn apply(&self, boxes: &mut [Aabb], places: &mut [u32]) -> usize {
        let mut first_count = 0;
        for index in 0..boxes.len() {
            if self.binning.bins(boxes[index].center())[self.axis] < self.bin {
                boxes.swap(first_count, index);
                places.swap(first_count, index);
                first_count += 1;
            }
        }
        first_count
    }
}

/// Moves the half of a group that is first along its longest axis to the front; its size.
fn halve(boxes: &mut [Aabb], places: &mut [u32], group: &Group) -> usize {
    let half = boxes.len() / 2;
    let extent = (group.centers.max - group.centers.min).to_array();
    let axis = (0..3).fold(
        0,
        |most, it| if extent[it] > extent[most] { it } else { most },
    );
    let mut both: Vec<_> = boxes.iter().copied().zip(places.iter().copied()).collect();
    both.select_nth_unstable_by(half, |(a, a_place), (b, b_place)| {
        let along = |it: &Aabb| it.center().to_array()[axis];
        along(a).total_cmp(&along(b)).then(a_place.cmp(b_place))
    });
    for (index, (bounds, place)) in both.into_iter().enumerate() {
        (boxes[index], places[index]) = (bounds, place);
    }
    half
}

/// Which bin a center falls into.
#[derive(Clone, Copy)]
struct Binning {
    start: Vec3A,
    scale: Vec3A,
    count: usize,
}

impl Binning {
    fn new(centers: Aabb, count: usize) -> Self {
        let extent = centers.max - centers.min;
        // An axis without extent has one bin.
        let scale = |extent: f32| {
            let scale = count as f32 / extent;
            if scale.is_finite() { scale } else { 0.0 }
        };
        Self {
            start: centers.min,
            scale: Vec3A::from_array(extent.to_array().map(scale)),
            count,
        }
    }

    #[inline(always)]
    fn bins(self, center: Vec3A) -> [usize; 3] {
        let offset = (center - self.start) * self.scale;
        // The last center would fall behind the last bin.
        let last = self.count as i32 - 1;
        offset.to_array().map(|it| (it as i32).min(last) as usize)
    }
}
