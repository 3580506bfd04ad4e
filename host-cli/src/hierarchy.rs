//! Builds [hierarchies](whitted::Hierarchy) for firmware.
//!
//! A [`Tree`] of boxes is built first, from the [bounds](Bounded) of the objects. What is put into flash
//! round each of its branches is then either a box or a ball, each with the margin that the proof in
//! [`whitted::hierarchy`] asks for.

use std::ops::Range;

use glam::{DVec3, Vec3};
use whitted::hierarchy::{Aabb, Ball, Child, Link, Node, SLACK};

mod bounds;
mod sah;

pub use bounds::{Bounded, Bounds};

/// What casting a ray costs, in any unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Costs {
    /// To prepare it.
    pub ray: f32,
    /// To test both bounds of a node, and to go on.
    pub node: f32,
    /// To test an object.
    pub object: f32,
}

/// What a tree is built for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// What it is to keep low.
    pub costs: Costs,
    /// Most objects of a leaf, at most [`Link::MAX_COUNT`].
    pub leaf: usize,
    /// Most nodes on the way to an object. Trees are deeper only where there are too many objects.
    pub depth: usize,
}

/// A hierarchy of boxes, without margins.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    /// In depth-first order.
    pub nodes: Vec<[Branch; 2]>,
    /// For each slot, the place that its object has.
    pub places: Vec<u32>,
    /// Most nodes on the way to an object.
    pub depth: usize,
    /// The most that any object needs.
    pub slack: f32,
}

/// A box round some objects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branch {
    /// Least coordinates.
    pub min: Vec3,
    /// Greatest coordinates.
    pub max: Vec3,
    /// To the objects.
    pub link: Link,
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
        let (nodes, places, depth) = sah::build(bounds, settings);
        Some(Self {
            nodes,
            places,
            depth,
            slack: bounds.iter().fold(SLACK, |most, it| most.max(it.slack)),
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

    /// The nodes with boxes.
    pub fn boxes(&self) -> Vec<Node<Aabb>> {
        let child = |it: &Branch| Child {
            bound: self.widened(it),
            link: it.link,
        };
        self.nodes
            .iter()
            .map(|it| Node(it.each_ref().map(child)))
            .collect()
    }

    /// The nodes with balls, where `balls` are those of each object by its place; `None` where an object
    /// has none.
    pub fn balls(&self, balls: impl Fn(usize) -> Vec<(DVec3, f64)>) -> Option<Vec<Node<Ball>>> {
        let by_slot: Vec<_> = self.places.iter().map(|&it| balls(it as usize)).collect();
        if by_slot.iter().any(Vec::is_empty) {
            return None;
        }
        let child = |it: &Branch| {
            let inside = by_slot[self.slots_under(it.link)].concat();
            Child {
                bound: self.enclosing(it, &inside),
                link: it.link,
            }
        };
        Some(
            self.nodes
                .iter()
                .map(|it| Node(it.each_ref().map(child)))
                .collect(),
        )
    }

    /// What a random ray that meets the box round all objects costs, but for a factor, if the areas of
    /// the bounds are those of `areas`.
    pub fn cost(&self, areas: impl Iterator<Item = [f64; 2]>, costs: Costs) -> f64 {
        let [ray, node, object] = [costs.ray, costs.node, costs.object].map(f64::from);
        let [a, b] = self.nodes[0];
        let size = (a.max.max(b.max) - a.min.min(b.min)).as_dvec3();
        let whole = 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x);
        let branches = self.nodes.iter().flatten().zip(areas.flatten());
        branches.fold(whole * (ray + node), |cost, (branch, area)| {
            let inside = branch.link.objects();
            cost + area * inside.map_or(node, |it| it.len() as f64 * object)
        })
    }

    /// The box with its margin.
    fn widened(&self, branch: &Branch) -> Aabb {
        let (min, max) = (branch.min.as_dvec3(), branch.max.as_dvec3());
        let center = ((min + max) * 0.5).as_vec3();
        let margin = f64::from(self.slack) * min.abs().max(max.abs()).max_element();
        let half = (max - center.as_dvec3()).max(center.as_dvec3() - min) + margin;
        Aabb {
            center,
            // Rounding to nearest may have gone down.
            half: half.as_vec3().map(f32::next_up),
        }
    }

    /// A small ball round some balls, with its margin.
    ///
    /// The center goes towards whatever is farthest, by less each time: M. Badoiu, K. L. Clarkson,
    /// "Smaller Core-Sets for Balls", SODA 2003.
    fn enclosing(&self, branch: &Branch, balls: &[(DVec3, f64)]) -> Ball {
        const STEPS: u32 = 128;
        let farthest = |from: DVec3| {
            let far = balls.iter().map(|&(center, radius)| {
                let way = center - from;
                (way.length() + radius, way.normalize_or_zero())
            });
            far.fold(
                (0.0, DVec3::ZERO),
                |most, it| if it.0 > most.0 { it } else { most },
            )
        };
        let mut center = (branch.min.as_dvec3() + branch.max.as_dvec3()) * 0.5;
        let mut best = (f64::INFINITY, center);
        for step in 1..=STEPS {
            let (radius, towards) = farthest(center);
            if radius < best.0 {
                best = (radius, center);
            }
            center += towards * (radius / f64::from(step + 1));
        }
        let center = best.1.as_vec3();
        let radius = farthest(center.as_dvec3()).0;
        let greatest = center.as_dvec3().abs().max_element() + radius;
        let radius = radius + f64::from(self.slack) * greatest;
        Ball {
            center,
            radius: (radius as f32).next_up(),
        }
    }

    /// The slots of all objects to which a link leads: they lie next to each other.
    fn slots_under(&self, link: Link) -> Range<usize> {
        let end = |half: usize| {
            let mut link = link;
            loop {
                match (link.objects(), link.node()) {
                    (Some(objects), _) => break objects,
                    (None, node) => link = self.nodes[node.unwrap_or_default()][half].link,
                }
            }
        };
        end(0).start..end(1).end
    }
}
