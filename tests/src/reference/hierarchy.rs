//! A tree of boxes, so that a ray need not ask every object.

use glam::DVec3;

use super::Object;

/// Objects in a tree of boxes, and those without bounds in a list.
#[derive(Clone, Debug)]
pub struct Hierarchy {
    unbounded: Vec<usize>,
    root: Option<Node>,
}

#[derive(Clone, Debug)]
struct Node {
    min: DVec3,
    max: DVec3,
    content: Content,
}

#[derive(Clone, Debug)]
enum Content {
    Leaf(Vec<usize>),
    Pair(Box<[Node; 2]>),
}

/// An object's number and bounds.
type Entry = (usize, DVec3, DVec3);

impl Hierarchy {
    /// Splits the objects in halves along the longest side until few are left.
    pub fn new(objects: &[Object]) -> Self {
        let mut unbounded = Vec::new();
        let mut bounded = Vec::new();
        for (index, object) in objects.iter().enumerate() {
            match object.shape.bounds() {
                Some((min, max)) => bounded.push((index, min, max)),
                None => unbounded.push(index),
            }
        }
        let root = (!bounded.is_empty()).then(|| Node::new(&mut bounded));
        Hierarchy { unbounded, root }
    }

    /// Shows every object that the ray may meet to `look`, which says how far to go on looking.
    pub fn visit(&self, origin: DVec3, direction: DVec3, look: &mut impl FnMut(usize) -> f64) {
        let mut far = f64::INFINITY;
        for &index in &self.unbounded {
            far = look(index);
        }
        if let Some(root) = &self.root {
            root.visit(origin, direction, &mut far, look);
        }
    }
}

impl Node {
    fn new(entries: &mut [Entry]) -> Self {
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for &(_, low, high) in entries.iter() {
            min = min.min(low);
            max = max.max(high);
        }
        let content = if entries.len() <= 4 {
            Content::Leaf(entries.iter().map(|entry| entry.0).collect())
        } else {
            let size = max - min;
            let axis = if size.x >= size.y && size.x >= size.z {
                0
            } else if size.y >= size.z {
                1
            } else {
                2
            };
            entries.sort_by(|a, b| (a.1 + a.2)[axis].total_cmp(&(b.1 + b.2)[axis]));
            let (low, high) = entries.split_at_mut(entries.len() / 2);
            Content::Pair(Box::new([Node::new(low), Node::new(high)]))
        };
        // Only a filter: a little larger than it must be, so that its own rounding loses nothing.
        let margin = 1e-9 * (max - min).max_element() + 1e-12 * min.abs().max(max.abs());
        Node {
            min: min - margin,
            max: max + margin,
            content,
        }
    }

    fn visit(
        &self,
        origin: DVec3,
        direction: DVec3,
        far: &mut f64,
        look: &mut impl FnMut(usize) -> f64,
    ) {
        let a = (self.min - origin) / direction;
        let b = (self.max - origin) / direction;
        let enter = a.min(b).max_element();
        let leave = a.max(b).min_element();
        if enter > leave || leave < 0.0 || enter > *far {
            return;
        }
        match &self.content {
            Content::Leaf(indices) => {
                for &index in indices {
                    *far = look(index);
                }
            }
            Content::Pair(pair) => {
                // What lies ahead first: it may make the other one needless.
                let [low, high] = &**pair;
                let forward = direction.dot(high.min + high.max - low.min - low.max) > 0.0;
                for node in if forward { [low, high] } else { [high, low] } {
                    node.visit(origin, direction, far, look);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Finish, Shape};
    use super::*;

    #[test]
    fn every_object_that_a_ray_meets_is_shown() {
        let finish = Finish {
            pattern: None,
            filter: DVec3::ONE,
            absorption: DVec3::ZERO,
            color: DVec3::ONE,
            ambient: 0.0,
            diffuse: 1.0,
            specular: 0.0,
            shininess: 1.0,
            mirror: 0.0,
            transmittance: 0.0,
            ior: 1.0,
        };
        let ball = |i: u32| {
            let [a, b, c] = [0.819, 0.671, 0.549].map(|step| (f64::from(i) * step).fract());
            Shape::Sphere {
                center: DVec3::new(a, b, c),
                radius: 0.02 + 0.05 * a * b,
            }
        };
        let shapes = (0..300).map(ball).chain([Shape::Plane {
            point: DVec3::ZERO,
            normal: DVec3::Y,
        }]);
        let objects: Vec<_> = shapes
            .map(|shape| Object {
                shape,
                finish: finish.clone(),
            })
            .collect();
        let hierarchy = Hierarchy::new(&objects);
        let (mut met, mut asked) = (0, 0);
        for i in 0..500 {
            let origin = DVec3::new(f64::from(i).sin(), f64::from(i).cos(), -2.0);
            let direction = DVec3::new(0.5 - origin.x, 0.6 - origin.y, 2.5).normalize();
            let mut shown = vec![];
            hierarchy.visit(origin, direction, &mut |index| {
                shown.push(index);
                f64::INFINITY
            });
            asked += shown.len();
            shown.sort_unstable();
            assert!(
                shown.windows(2).all(|pair| pair[0] != pair[1]),
                "shown twice"
            );
            for (index, object) in objects.iter().enumerate() {
                if object
                    .shape
                    .crossings(origin, direction, false)
                    .any(|t| t > 0.0)
                {
                    assert!(shown.contains(&index));
                    met += 1;
                }
            }
        }
        assert!(
            met > 1000 && asked < 500 * 300 / 4,
            "{met} met, {asked} asked"
        );
    }
}
