//! Binary hierarchies by the surface-area heuristic, then wide ones from those.
//!
//! I. Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", IEEE Symposium on
//! Interactive Ray Tracing 2007 (bins).

use glam::Vec3A;

use super::blocks::Kind;
use super::bounds::{self, Bounds};

/// An object to be put into a tree.
#[derive(Clone, Copy, Debug)]
pub struct Item {
    pub bounds: Bounds,
    pub kind: Kind,
    /// Whether no light goes through.
    pub opaque: bool,
    /// Its place in the geometry.
    pub object: u32,
}

impl Item {
    /// How far along a ray from its bounds a hit may be reported.
    pub fn spread(&self) -> f32 {
        match self.kind {
            Kind::Triangle | Kind::Quad | Kind::Outline => bounds::spread(&self.bounds),
            _ => 0.0,
        }
    }
}

/// A node of a binary tree over a slice of items that was reordered for it.
#[derive(Clone, Copy, Debug)]
pub struct Binary {
    pub bounds: Bounds,
    /// Of a leaf, where its items start; of an inner node, where its two children stand.
    pub first: u32,
    /// How many items a leaf has; 0 for an inner node.
    pub count: u32,
}

/// Of nodes with more items than this, the bins are many; of those with fewer, they would cost more than
/// they spare.
const FEW: usize = 48;

/// How items are parted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Where rays are expected to have the least to do.
    Area,
    /// In halves, so that no tree is deeper than the logarithm of its size.
    Halves,
}

/// Below so many items, to share a subtree out among threads costs more than it spares.
const SHARED: usize = 512;

/// So deep at most: a tree may be deeper than a stack.
const SHARED_DEPTH: u32 = 24;

/// Reorders items and builds the binary tree over them, root first. A leaf holds at most `leaf`
/// items, all of one kind.
///
/// Large subtrees are grown by whichever thread is free; the tree is the same.
pub fn binary(
    items: &mut [Item],
    leaf: impl Fn(Kind) -> usize + Copy + Sync,
    method: Method,
) -> Vec<Binary> {
    shared(items, leaf, method, SHARED_DEPTH)
}

/// As [`binary`]; subtrees so many levels below the root are not shared out.
fn shared(
    items: &mut [Item],
    leaf: impl Fn(Kind) -> usize + Copy + Sync,
    method: Method,
    levels: u32,
) -> Vec<Binary> {
    let root = Binary::leaf(bounds_of(items), 0, items.len());
    let grown = grow(items, root, leaf, method, levels);
    let mut nodes = Vec::with_capacity(items.len());
    // Each is to be put where it belongs.
    let mut pending = vec![(grown, 0)];
    nodes.push(root);
    while let Some((grown, place)) = pending.pop() {
        match grown {
            Grown::Nodes(mut below) => {
                // The root has a place; the others follow.
                let offset = nodes.len() as u32 - 1;
                for node in &mut below {
                    node.first += if node.count == 0 { offset } else { 0 };
                }
                nodes[place] = below[0];
                nodes.extend_from_slice(&below[1..]);
            }
            Grown::Halves(halves) => {
                let first = nodes.len();
                nodes[place].first = first as u32;
                nodes[place].count = 0;
                for ((node, half), place) in halves.into_iter().zip(first..) {
                    nodes.push(node);
                    pending.push((half, place));
                }
            }
        }
    }
    nodes
}

/// What became of a node.
enum Grown {
    /// All below it and itself, which is the first. Places of nodes count from there.
    Nodes(Vec<Binary>),
    /// Two nodes, and what became of them.
    Halves(Box<[(Binary, Grown); 2]>),
}

/// Parts the items of a node, and those of its parts, until they are leaves; the first levels by whichever
/// thread is free.
fn grow(
    items: &mut [Item],
    node: Binary,
    leaf: impl Fn(Kind) -> usize + Copy + Sync,
    method: Method,
    levels: u32,
) -> Grown {
    if items.len() < SHARED || levels == 0 {
        return Grown::Nodes(subtree(items, node, leaf, method));
    }
    let Some(split) = split(items, leaf, method) else {
        return Grown::Nodes(vec![node]);
    };
    let halves = split.halves(node);
    let (left, right) = items.split_at_mut(split.at);
    let (left, right) = rayon::join(
        || grow(left, halves[0], leaf, method, levels - 1),
        || grow(right, halves[1], leaf, method, levels - 1),
    );
    Grown::Halves(Box::new([(halves[0], left), (halves[1], right)]))
}

/// The nodes from one on, whose items these are.
fn subtree(
    items: &mut [Item],
    root: Binary,
    leaf: impl Fn(Kind) -> usize + Copy,
    method: Method,
) -> Vec<Binary> {
    let start = root.first as usize;
    let mut nodes = Vec::with_capacity(items.len());
    nodes.push(root);
    // Each becomes a leaf or two smaller nodes.
    let mut pending = vec![0];
    while let Some(place) = pending.pop() {
        let node: Binary = nodes[place];
        let first = node.first as usize - start;
        if let Some(split) = split(&mut items[first..][..node.count as usize], leaf, method) {
            nodes[place].first = nodes.len() as u32;
            nodes[place].count = 0;
            for half in split.halves(node) {
                pending.push(nodes.len());
                nodes.push(half);
            }
        }
    }
    nodes
}

impl Binary {
    fn leaf(bounds: Bounds, first: usize, count: usize) -> Self {
        Self {
            bounds,
            first: first as u32,
            count: count as u32,
        }
    }
}

struct Split {
    at: usize,
    bounds: [Bounds; 2],
}

impl Split {
    /// Both parts of a node, for now leaves.
    fn halves(&self, node: Binary) -> [Binary; 2] {
        let (first, count) = (node.first as usize, node.count as usize);
        [
            Binary::leaf(self.bounds[0], first, self.at),
            Binary::leaf(self.bounds[1], first + self.at, count - self.at),
        ]
    }
}

fn bounds_of(items: &[Item]) -> Bounds {
    let mut bounds = Bounds::EMPTY;
    for item in items {
        bounds.grow(&item.bounds);
    }
    bounds
}

/// Parts the items in two; `None` where they are a leaf.
fn split(items: &mut [Item], leaf: impl Fn(Kind) -> usize, method: Method) -> Option<Split> {
    let kind = items.first()?.kind;
    if items.len() <= leaf(kind) {
        let others = partition(items, |item| item.kind == kind);
        return (others < items.len()).then(|| at(items, others));
    }
    if method == Method::Area
        && let Some(split) = if items.len() > FEW {
            by_bins::<16>(items)
        } else {
            by_bins::<8>(items)
        }
    {
        return Some(split);
    }
    let half = items.len() / 2;
    let Bounds { min, max } = bounds_of(items);
    let axis = (max - min).max_position();
    items.select_nth_unstable_by(half, |a, b| center(a)[axis].total_cmp(&center(b)[axis]));
    Some(at(items, half))
}

fn at(items: &[Item], at: usize) -> Split {
    Split {
        at,
        bounds: [bounds_of(&items[..at]), bounds_of(&items[at..])],
    }
}

/// Twice the middle of an item's box.
#[inline(always)]
fn center(item: &Item) -> Vec3A {
    item.bounds.min + item.bounds.max
}

#[derive(Clone, Copy)]
struct Bin {
    bounds: Bounds,
    count: u32,
}

fn by_bins<const BINS: usize>(items: &mut [Item]) -> Option<Split> {
    let (mut low, mut high) = (Vec3A::INFINITY, Vec3A::NEG_INFINITY);
    for item in items.iter() {
        let center = center(item);
        low = low.min(center);
        high = high.max(center);
    }
    // The greatest center falls into the last bin, not beyond it.
    let size = high - low;
    let scale = BINS as f32 * (1.0 - 1.0 / (1 << 20) as f32) / size;
    // Not where all centers are equal, nor where their distances leave the range of `f32`.
    let usable = [0, 1, 2].map(|axis| size[axis] > 0.0 && scale[axis] < f32::INFINITY);
    if !usable.contains(&true) {
        return None;
    }
    let scale = Vec3A::new(
        if usable[0] { scale.x } else { 0.0 },
        if usable[1] { scale.y } else { 0.0 },
        if usable[2] { scale.z } else { 0.0 },
    );
    let bin_of = |item: &Item| {
        ((center(item) - low) * scale)
            .to_array()
            .map(|x| x as usize & (BINS - 1))
    };
    let empty = Bin {
        bounds: Bounds::EMPTY,
        count: 0,
    };
    let mut bins = [[empty; BINS]; 3];
    for item in items.iter() {
        let place = bin_of(item);
        for axis in 0..3 {
            let bin = &mut bins[axis][place[axis]];
            bin.bounds.grow(&item.bounds);
            bin.count += 1;
        }
    }
    let mut best = (f32::INFINITY, 0, 0);
    for (axis, bins) in bins.iter().enumerate() {
        // Costs of all that lies right of each bin's left edge.
        let mut right = [0.0; BINS];
        let mut sum = empty;
        for place in (1..BINS).rev() {
            sum.bounds.grow(&bins[place].bounds);
            sum.count += bins[place].count;
            right[place] = cost(&sum);
        }
        let mut sum = empty;
        for place in 1..BINS {
            sum.bounds.grow(&bins[place - 1].bounds);
            sum.count += bins[place - 1].count;
            let cost = cost(&sum) + right[place];
            if cost < best.0 && sum.count > 0 && (sum.count as usize) < items.len() {
                best = (cost, axis, place);
            }
        }
    }
    let (cost, axis, place) = best;
    if !(cost < f32::INFINITY) {
        return None;
    }
    let mut bounds = [Bounds::EMPTY; 2];
    for (i, bin) in bins[axis].iter().enumerate() {
        bounds[usize::from(i >= place)].grow(&bin.bounds);
    }
    let at = partition(items, |item| bin_of(item)[axis] < place);
    Some(Split { at, bounds })
}

fn cost(bin: &Bin) -> f32 {
    if bin.count == 0 {
        0.0
    } else {
        bin.bounds.area() * bin.count as f32
    }
}

/// Moves the items for which `left` holds to the front, and says how many there are.
fn partition(items: &mut [Item], left: impl Fn(&Item) -> bool) -> usize {
    let (mut start, mut end) = (0, items.len());
    loop {
        while start < end && left(&items[start]) {
            start += 1;
        }
        while start < end && !left(&items[end - 1]) {
            end -= 1;
        }
        if start >= end {
            return start;
        }
        items.swap(start, end - 1);
        start += 1;
        end -= 1;
    }
}

/// Which nodes of a binary tree become nodes of up to `N` children: those that rays meet least.
///
/// Dynamic programming from the leaves up, as in H. Ylitie, T. Karras, S. Laine, "Efficient Incoherent
/// Ray Traversal on GPUs Through Compressed Wide BVHs", High-Performance Graphics 2017.
pub struct Collapse<'a, const N: usize> {
    nodes: &'a [Binary],
    /// Of each node, if up to 1, 2, ... `N` boxes may stand for it: the least area of all wide nodes
    /// in it.
    costs: Vec<[f32; N]>,
}

impl<'a, const N: usize> Collapse<'a, N> {
    pub fn new(nodes: &'a [Binary]) -> Self {
        let mut costs = vec![[0.0; N]; nodes.len()];
        // Of each node; more than a wide node has children are as many.
        let mut leaves = vec![1_u8; nodes.len()];
        // Children stand behind their parents.
        for (place, node) in nodes.iter().enumerate().rev() {
            if node.count > 0 {
                continue;
            }
            let first = node.first as usize;
            let most = [leaves[first], leaves[first + 1]].map(usize::from);
            let (left, right) = (&costs[first][..most[0]], &costs[first + 1][..most[1]]);
            let mut of = [f32::INFINITY; N];
            for (k, left) in left.iter().enumerate() {
                for (of, right) in of[(k + 1).min(N)..].iter_mut().zip(right) {
                    *of = of.min(left + right);
                }
            }
            // Where there are fewer leaves than boxes might be, no more stand for it.
            let all = (most[0] + most[1]).min(N);
            leaves[place] = all as u8;
            let least = of[all - 1];
            of[all..].fill(least);
            of[0] = node.bounds.area() + of[N - 1];
            let one = of[0];
            of[1..].iter_mut().for_each(|it| *it = it.min(one));
            costs[place] = of;
        }
        Self { nodes, costs }
    }

    /// Gives `below` the places of the nodes that stand below the wide node of this one.
    pub fn children(&self, place: usize, below: &mut Vec<usize>) {
        if self.nodes[place].count > 0 {
            below.push(place);
        } else {
            self.part(place, N, below);
        }
    }

    /// The same below an inner node for which up to `width` boxes may stand.
    fn part(&self, place: usize, width: usize, below: &mut Vec<usize>) {
        let first = self.nodes[place].first as usize;
        let cost =
            |left: &usize| self.costs[first][left - 1] + self.costs[first + 1][width - left - 1];
        let left = (1..width).min_by(|a, b| cost(a).total_cmp(&cost(b)));
        let left = left.expect("there is room for two");
        for (place, width) in [(first, left), (first + 1, width - left)] {
            let costs = &self.costs[place];
            if self.nodes[place].count > 0 || costs[width - 1] >= costs[0] {
                below.push(place);
            } else {
                self.part(place, width, below);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Boxes about a curve, some of them equal.
    fn items() -> Vec<Item> {
        let coordinate = |i: u32, rate: f32| (i as f32 * rate).sin();
        let item = |i: u32| {
            let min = Vec3A::new(
                coordinate(i / 3, 1.0),
                coordinate(i / 3, 0.37),
                coordinate(i / 3, 0.11),
            );
            Item {
                bounds: Bounds {
                    min,
                    max: min + 0.01,
                },
                kind: if i.is_multiple_of(7) {
                    Kind::Sphere
                } else {
                    Kind::Triangle
                },
                opaque: true,
                object: i,
            }
        };
        (0..5000).map(item).collect()
    }

    /// Leaves from left to right, and how deep each lies.
    fn leaves(nodes: &[Binary]) -> Vec<(usize, u32, u32)> {
        let mut leaves = Vec::new();
        let mut pending = vec![(0, 0)];
        while let Some((place, depth)) = pending.pop() {
            let node: &Binary = &nodes[place];
            if node.count > 0 {
                leaves.push((depth, node.first, node.count));
            } else {
                let first = node.first as usize;
                assert!(first > place, "children stand behind their parents");
                pending.extend([(first + 1, depth + 1), (first, depth + 1)]);
            }
        }
        leaves
    }

    #[test]
    fn shared_subtrees_are_those_of_one_thread() {
        for method in [Method::Area, Method::Halves] {
            let mut alone = items();
            let root = Binary::leaf(bounds_of(&alone), 0, alone.len());
            let expected = leaves(&subtree(&mut alone, root, |_| 8, method));
            let counts: usize = expected.iter().map(|leaf| leaf.2 as usize).sum();
            assert_eq!(counts, alone.len());
            for (threads, levels) in [(1, SHARED_DEPTH), (3, SHARED_DEPTH), (3, 0), (3, 1), (3, 2)]
            {
                let mut shared = items();
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
                let pool = pool.build().unwrap();
                let nodes = pool.install(|| super::shared(&mut shared, |_| 8, method, levels));
                assert_eq!(nodes.len(), 2 * expected.len() - 1);
                assert_eq!(leaves(&nodes), expected);
                let objects = |items: &[Item]| items.iter().map(|it| it.object).collect::<Vec<_>>();
                assert_eq!(objects(&shared), objects(&alone));
                for node in &nodes {
                    let inner = node.count == 0;
                    let within = |it: &Binary| {
                        it.bounds.min.cmpge(node.bounds.min).all()
                            && it.bounds.max.cmple(node.bounds.max).all()
                    };
                    let first = node.first as usize;
                    assert!(!inner || nodes[first..first + 2].iter().all(within));
                }
            }
        }
    }
}
