//! Top-down building by the surface-area heuristic.
//!
//! J. D. MacDonald, K. S. Booth, "Heuristics for Ray Tracing Using Space Subdivision", The Visual
//! Computer 6(3), 1990; over bins of centroids: I. Wald, "On Fast Construction of SAH-Based Bounding
//! Volume Hierarchies", RT 2007. One thread, no randomness: the same boxes make the same tree.

use std::ops::Range;

use glam::Vec3A;
use whitted::hierarchy::Link;

use super::{Bounds, Branch, Settings};

/// Nodes in depth-first order, the place of each slot, and the most nodes on the way to an object.
pub fn build(bounds: &[Bounds], settings: Settings) -> (Vec<[Branch; 2]>, Vec<u32>, usize) {
    let mut builder = Builder {
        settings,
        boxes: bounds.iter().map(Extent::from).collect(),
        places: (0..bounds.len() as u32).collect(),
        nodes: Vec::new(),
        depth: 0,
    };
    let all = Group::new(0..bounds.len(), &builder.boxes);
    let split = Split::best(
        &builder.boxes,
        &all,
        settings.costs.node / settings.costs.object,
    );
    builder.node(&all, split, 1);
    (builder.nodes, builder.places, builder.depth)
}

/// Four lanes, so that all coordinates are compared at once.
#[derive(Clone, Copy)]
struct Extent {
    min: Vec3A,
    max: Vec3A,
}

impl From<&Bounds> for Extent {
    fn from(bounds: &Bounds) -> Self {
        Self {
            min: bounds.min.into(),
            max: bounds.max.into(),
        }
    }
}

impl Extent {
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
    bounds: Extent,
    /// Of the [centers](Extent::center).
    centers: Extent,
}

struct Builder {
    settings: Settings,
    boxes: Vec<Extent>,
    /// Of the object in each of the boxes.
    places: Vec<u32>,
    nodes: Vec<[Branch; 2]>,
    depth: usize,
}

impl Builder {
    /// Divides a group of at least two, and makes its node and all that follows in depth-first order.
    fn node(&mut self, group: &Group, split: Option<Split>, depth: usize) {
        self.depth = self.depth.max(depth);
        let halves = self.divide(group, split, depth);
        let place = self.nodes.len();
        self.nodes.push(halves.each_ref().map(|half| Branch {
            min: half.bounds.min.into(),
            max: half.bounds.max.into(),
            // Until it is known.
            link: Link::from_bits(0),
        }));
        for (side, half) in halves.iter().enumerate() {
            self.nodes[place][side].link = self.link(half, depth);
        }
    }

    /// What is in the box of a group: a leaf, or a node with more under it.
    fn link(&mut self, group: &Group, depth: usize) -> Link {
        let count = group.range.len();
        let boxes = &self.boxes[group.range.clone()];
        let split = Split::best(
            boxes,
            group,
            self.settings.costs.node / self.settings.costs.object,
        );
        let whole = count as f32 * group.bounds.area();
        let pays = split.as_ref().is_some_and(|it| it.cost < whole);
        if count <= self.settings.leaf && !(pays && depth < self.settings.depth) {
            return Link::leaf(group.range.start as u32, count as u32)
                .expect("leaves are small and objects counted");
        }
        let node = self.nodes.len() as u32;
        self.node(group, split, depth + 1);
        Link::to_node(node).expect("there are fewer nodes than objects")
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
}

impl Group {
    fn new(range: Range<usize>, boxes: &[Extent]) -> Self {
        let (mut bounds, mut centers) = (Extent::EMPTY, Extent::EMPTY);
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
    fn best(boxes: &[Extent], group: &Group, node_cost: f32) -> Option<Self> {
        // More bins than boxes find nothing more.
        let binning = Binning::new(group.centers, boxes.len().min(MOST_BINS));
        let mut bins = [[(Extent::EMPTY, 0_u32); MOST_BINS]; 3];
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
            let (mut bounds, mut first_count) = (Extent::EMPTY, 0);
            for (first, bin) in firsts[1..].iter_mut().zip(bins) {
                bounds = bounds.join(bin.0);
                first_count += bin.1;
                *first = (bounds.area() * first_count as f32, first_count);
            }
            let (mut bounds, mut count) = (Extent::EMPTY, 0);
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
    fn apply(&self, boxes: &mut [Extent], places: &mut [u32]) -> usize {
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
fn halve(boxes: &mut [Extent], places: &mut [u32], group: &Group) -> usize {
    let half = boxes.len() / 2;
    let extent = (group.centers.max - group.centers.min).to_array();
    let axis = (0..3).fold(
        0,
        |most, it| if extent[it] > extent[most] { it } else { most },
    );
    let mut both: Vec<_> = boxes.iter().copied().zip(places.iter().copied()).collect();
    both.select_nth_unstable_by(half, |(a, a_place), (b, b_place)| {
        let along = |it: &Extent| it.center().to_array()[axis];
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
    fn new(centers: Extent, count: usize) -> Self {
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
