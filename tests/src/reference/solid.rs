//! What is placed, and what is joined: by other methods than the renderer's.
//!
//! Of a solid each leaf is an object of its own, met where the point just before and the point just
//! behind differ: one inside of the whole, the other outside. Which points are inside of what is asked of
//! the points, not of the ray.

use std::sync::Arc;

use glam::{DMat3, DVec3};
use whitted_cli::scene_file::Step;

use super::Shape;

/// A shape, moved by an affine map.
#[derive(Clone, Debug)]
pub struct Placed {
    pub shape: Box<Shape>,
    pub matrix: DMat3,
    pub inverse: DMat3,
    pub translation: DVec3,
}

impl Placed {
    pub fn new(shape: Shape, axes: [[f64; 3]; 3], translation: [f64; 3]) -> Self {
        let matrix = DMat3::from_cols_array_2d(&axes);
        Self {
            shape: Box::new(shape),
            matrix,
            inverse: matrix.inverse(),
            translation: translation.into(),
        }
    }

    /// The line in the shape's space, where `t` is the same as in the world.
    fn local(&self, origin: DVec3, direction: DVec3) -> (DVec3, DVec3) {
        (
            self.inverse * (origin - self.translation),
            self.inverse * direction,
        )
    }

    pub fn crossings(&self, origin: DVec3, direction: DVec3, leaving: bool) -> Vec<f64> {
        // The oracle's shapes want directions of unit length.
        let (origin, direction) = self.local(origin, direction);
        let length = direction.length();
        let found = self
            .shape
            .crossings(origin, direction / length, leaving)
            .map(|t| t / length);
        found.collect()
    }

    pub fn normal(&self, origin: DVec3, direction: DVec3, t: f64) -> DVec3 {
        let (origin, direction) = self.local(origin, direction);
        let length = direction.length();
        let normal = self.shape.normal(origin, direction / length, t * length);
        (self.inverse.transpose() * normal).normalize()
    }

    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let (min, max) = self.shape.bounds()?;
        let corner = |i: usize| {
            let of = |axis: usize| {
                if i >> axis & 1 == 0 {
                    min[axis]
                } else {
                    max[axis]
                }
            };
            self.matrix * DVec3::new(of(0), of(1), of(2)) + self.translation
        };
        let low = (0..8).map(corner).reduce(DVec3::min)?;
        let high = (0..8).map(corner).reduce(DVec3::max)?;
        Some((low, high))
    }
}

/// What leaves are joined to.
#[derive(Clone, Debug)]
pub struct Solid {
    leaves: Vec<Shape>,
    steps: Vec<Step>,
    /// Of which leaves the inside is outside of the whole.
    taken_away: Vec<bool>,
}

/// What of a leaf is on the surface of a solid.
#[derive(Clone, Debug)]
pub struct Part {
    pub solid: Arc<Solid>,
    pub leaf: usize,
}

/// How far before and behind a crossing points are asked, over the greatest number at hand.
const ASIDE: f64 = 1e-9;

impl Solid {
    pub fn new(leaves: Vec<Shape>, steps: Vec<Step>) -> Self {
        let mut solid = Self {
            leaves,
            steps,
            taken_away: Vec::new(),
        };
        solid.taken_away = (0..solid.leaves.len())
            .map(|it| solid.takes_away(it))
            .collect();
        solid
    }

    /// Whether what is inside of these leaves is inside of the whole.
    fn joined(&self, mut inside: impl FnMut(usize) -> bool) -> bool {
        let (mut waiting, mut leaf) = (Vec::new(), 0);
        for step in &self.steps {
            let value = if *step == Step::Leaf {
                leaf += 1;
                inside(leaf - 1)
            } else {
                let (right, left): (bool, bool) =
                    (waiting.pop().expect("two"), waiting.pop().expect("two"));
                match step {
                    Step::Union => left || right,
                    Step::Intersection => left && right,
                    _ => left && !right,
                }
            };
            waiting.push(value);
        }
        waiting.pop() == Some(true)
    }

    fn contains(&self, point: DVec3) -> bool {
        self.joined(|leaf| self.leaves[leaf].contains(point))
    }

    /// Whether some other leaves make it so that going
    /// into this one goes out of the whole.
    fn takes_away(&self, leaf: usize) -> bool {
        (0..1_u32 << self.leaves.len()).any(|others| {
            let with = |is_in: bool| {
                self.joined(|it| {
                    if it == leaf {
                        is_in
                    } else {
                        others >> it & 1 == 1
                    }
                })
            };
            with(false) && !with(true)
        })
    }
}

impl Part {
    /// Where the line meets this leaf on the surface of the whole.
    pub fn crossings(&self, origin: DVec3, direction: DVec3, leaving: bool) -> Vec<f64> {
        let leaf = &self.solid.leaves[self.leaf];
        leaf.crossings(origin, direction, leaving)
            .filter(|&t| {
                let step = ASIDE * (origin.abs().max_element() + t.abs());
                let [before, behind] = [t - step, t + step].map(|t| origin + t * direction);
                let enters = self.solid.contains(behind);
                // The first leaf that goes along is the one that is met.
                let met = (0..self.solid.leaves.len()).find(|&it| {
                    let leaf = &self.solid.leaves[it];
                    let is_in = leaf.contains(behind);
                    leaf.contains(before) != is_in && (is_in != self.solid.taken_away[it]) == enters
                });
                // What is nearer than the step belongs to where the line starts.
                t > step && self.solid.contains(before) != enters && met == Some(self.leaf)
            })
            .collect()
    }

    pub fn normal(&self, origin: DVec3, direction: DVec3, t: f64) -> DVec3 {
        let normal = self.solid.leaves[self.leaf].normal(origin, direction, t);
        match self.solid.taken_away[self.leaf] {
            true => -normal,
            false => normal,
        }
    }

    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        self.solid.leaves[self.leaf].bounds()
    }
}
