//! Surfaces that lie in one another.
//!
//! Which of two coincident surfaces a ray meets first is a matter of rounding: what one sees there is
//! noise, or the one that comes first in the file. Found are flat shapes that overlap in one plane,
//! and equal copies of the others. Faces of boxes are not looked at: a box that stands on a floor is
//! no mistake.

use std::collections::HashMap;

use super::{cross, difference, dot};
use crate::scene_file::{Object, Shape};

/// Pairs of coincident objects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Coincidence {
    /// The first pair, by index, the lower first.
    pub first: [usize; 2],
    /// How many there are.
    pub pairs: usize,
}

/// Looks for coincident objects.
pub(super) fn find(objects: &[Object]) -> Option<Coincidence> {
    let mut pairs = copies(objects);
    let mut groups: HashMap<_, Vec<Flat>> = HashMap::new();
    let flats: Vec<_> = (objects.iter().enumerate())
        .filter_map(|(index, object)| Flat::new(index, &object.shape))
        .collect();
    let reach = flats.iter().map(Flat::reach).fold(0.0, f64::max);
    for flat in flats {
        groups.entry(flat.plane(reach)).or_default().push(flat);
    }
    // A budget, so that a strange scene cannot keep us: warnings are not worth minutes.
    let mut budget = 100_000_000;
    for mut group in groups.into_values() {
        overlaps(&mut group, &mut budget, &mut pairs);
    }
    Some(Coincidence {
        first: *pairs.iter().min_by_key(|it| (it[1], it[0]))?,
        pairs: pairs.len(),
    })
}

/// Equal shapes that are not flat; each with the one before.
fn copies(objects: &[Object]) -> Vec<[usize; 2]> {
    let mut seen = HashMap::new();
    let mut pairs = Vec::new();
    for (index, object) in objects.iter().enumerate() {
        let (kind, numbers) = match object.shape {
            Shape::Sphere { center, radius } => (0, [&center[..], &[radius]].concat()),
            Shape::Box { min, max } => (1, [min, max].concat()),
            Shape::Frustum {
                base,
                base_radius,
                apex,
                apex_radius,
            } => (2, [&base[..], &apex, &[base_radius, apex_radius]].concat()),
            Shape::Torus {
                center,
                axis,
                major,
                minor,
            } => (5, [&center[..], &axis, &[major, minor]].concat()),
            Shape::Quadric { ref form, closed } => (3 + i32::from(closed), form.numbers()),
            _ => continue,
        };
        // So that -0 is 0.
        let bits: Vec<_> = numbers.iter().map(|it| (it + 0.0).to_bits()).collect();
        if let Some(first) = seen.insert((kind, bits), index) {
            pairs.push([first, index]);
        }
    }
    pairs
}

/// A flat shape.
struct Flat {
    index: usize,
    /// Unit length, of two opposite ones always the same.
    normal: [f64; 3],
    /// Of its plane from the origin, along the normal.
    offset: f64,
    /// None for a whole plane.
    vertices: Vec<[f64; 3]>,
}

impl Flat {
    fn new(index: usize, shape: &Shape) -> Option<Self> {
        let (normal, point, vertices) = match shape {
            Shape::Plane { point, normal } => (*normal, *point, Vec::new()),
            Shape::Polygon { vertices } => (newell(vertices), vertices[0], vertices.clone()),
            Shape::Triangle { vertices } | Shape::Patch { vertices, .. } => {
                (newell(vertices), vertices[0], vertices.to_vec())
            }
            _ => return None,
        };
        let length = dot(normal, normal).sqrt();
        let largest = normal
            .iter()
            .copied()
            .max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        let turned = length.copysign(largest);
        let normal = normal.map(|it| it / turned);
        Some(Self {
            index,
            normal,
            offset: dot(normal, point),
            vertices,
        })
    }

    /// The greatest distance from the origin, about.
    fn reach(&self) -> f64 {
        let coordinates = self.vertices.iter().flatten();
        coordinates.fold(self.offset.abs(), |most, it| most.max(it.abs()))
    }

    /// A key that flat shapes of one plane share.
    fn plane(&self, reach: f64) -> [i64; 4] {
        let [x, y, z] = self.normal.map(|it| (it * 1e4).round() as i64);
        [x, y, z, (self.offset / reach * 1e5).round() as i64]
    }
}

fn newell(vertices: &[[f64; 3]]) -> [f64; 3] {
    let origin = vertices[0];
    let mut sum = [0.0; 3];
    for (index, &vertex) in vertices.iter().enumerate() {
        let next = vertices[(index + 1) % vertices.len()];
        let area = cross(difference(vertex, origin), difference(next, origin));
        for axis in 0..3 {
            sum[axis] += area[axis];
        }
    }
    sum
}

/// Adds the pairs of one plane that overlap.
fn overlaps(group: &mut [Flat], budget: &mut usize, pairs: &mut Vec<[usize; 2]>) {
    let Some(normal) = group.first().map(|it| it.normal) else {
        return;
    };
    let axis = (0..3).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs()));
    let axis = axis.unwrap_or(0);
    let outlines: Vec<_> = group
        .iter()
        .map(|flat| {
            let seen = |it: &[f64; 3]| [it[(axis + 1) % 3], it[(axis + 2) % 3]];
            (
                flat.index,
                Outline::new(flat.vertices.iter().map(seen).collect()),
            )
        })
        .collect();
    let mut order: Vec<_> = outlines.iter().collect();
    order.sort_by(|a, b| a.1.min[0].total_cmp(&b.1.min[0]));
    for (place, (index, outline)) in order.iter().enumerate() {
        for (other_index, other) in &order[place + 1..] {
            if other.min[0] >= outline.max[0] {
                break;
            }
            let work = 1 + outline.points.len() * other.points.len();
            if work > *budget {
                return;
            }
            *budget -= work;
            if outline.overlaps(other) {
                pairs.push([*index.min(other_index), *index.max(other_index)]);
            }
        }
    }
}

/// A closed outline in the plane; without points, all of it.
struct Outline {
    points: Vec<[f64; 2]>,
    min: [f64; 2],
    max: [f64; 2],
    /// What is not further away is taken to touch, since files round.
    touch: f64,
}

impl Outline {
    fn new(points: Vec<[f64; 2]>) -> Self {
        if points.is_empty() {
            return Self {
                points,
                min: [f64::NEG_INFINITY; 2],
                max: [f64::INFINITY; 2],
                touch: 0.0,
            };
        }
        let bound = |start, choose: fn(f64, f64) -> f64| {
            [0, 1].map(|axis| points.iter().map(|it| it[axis]).fold(start, choose))
        };
        let min = bound(f64::INFINITY, f64::min);
        let max = bound(f64::NEG_INFINITY, f64::max);
        Self {
            min,
            max,
            touch: 1e-5 * (max[0] - min[0]).max(max[1] - min[1]),
            points,
        }
    }

    fn edges(&self) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
        let next = self.points.iter().cycle().skip(1);
        self.points.iter().copied().zip(next.copied())
    }

    /// Whether two outlines have an area in common, and not just points or edges.
    fn overlaps(&self, other: &Self) -> bool {
        if self.points.is_empty() || other.points.is_empty() {
            return true;
        }
        let apart = (0..2)
            .any(|axis| self.min[axis] >= other.max[axis] || other.min[axis] >= self.max[axis]);
        !apart
            && (self.has_part_in(other)
                || other.has_part_in(self)
                || self
                    .edges()
                    .any(|a| other.edges().any(|b| self.crosses(a, b))))
    }

    /// Whether a corner, the middle of an edge or some point within lies well within another outline.
    fn has_part_in(&self, other: &Self) -> bool {
        let corners_and_middles = self.edges().flat_map(|(a, b)| [a, middle(a, b)]);
        let mut probes = corners_and_middles.chain(self.inner_point());
        let touch = self.touch.min(other.touch);
        probes.any(|it| other.contains(it, touch))
    }

    /// Whether a point lies within, further than `touch` from the outline; even-odd.
    fn contains(&self, point: [f64; 2], touch: f64) -> bool {
        let mut inside = false;
        for (a, b) in self.edges() {
            if distance(point, a, b) <= touch {
                return false;
            }
            if (a[1] > point[1]) != (b[1] > point[1]) {
                let x = a[0] + (point[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
                inside ^= point[0] < x;
            }
        }
        inside
    }

    /// Whether two edges cross well within both.
    fn crosses(&self, (a, b): ([f64; 2], [f64; 2]), (c, d): ([f64; 2], [f64; 2])) -> bool {
        // The distance of a point from a line, on one side positive.
        let side = |point: [f64; 2], from: [f64; 2], to: [f64; 2]| {
            turn(from, to, point) / (to[0] - from[0]).hypot(to[1] - from[1])
        };
        let apart = |one: f64, other: f64| {
            one.abs() > self.touch && other.abs() > self.touch && (one > 0.0) != (other > 0.0)
        };
        apart(side(a, c, d), side(b, c, d)) && apart(side(c, a, b), side(d, a, b))
    }

    /// Some point within a simple outline: at its leftmost corner, half way to what is next there.
    ///
    /// J. O'Rourke, "Computational Geometry in C", 2nd ed. 1998, section 1.5.
    fn inner_point(&self) -> Option<[f64; 2]> {
        let points = &self.points;
        let count = points.len();
        let corner = (0..count).min_by(|&a, &b| {
            let (a, b) = (points[a], points[b]);
            a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
        })?;
        let (before, after) = (
            points[(corner + count - 1) % count],
            points[(corner + 1) % count],
        );
        let corner = points[corner];
        let sign = turn(before, corner, after);
        // Of the points in the corner's triangle, the one furthest from its opposite side.
        let deepest = points
            .iter()
            .copied()
            .filter(|&it| it != corner && it != before && it != after)
            .filter(|&it| {
                [(before, corner), (corner, after), (after, before)]
                    .iter()
                    .all(|&(from, to)| turn(from, to, it) * sign >= 0.0)
            })
            .max_by(|&a, &b| {
                let depth = |it| (turn(after, before, it) * sign).abs();
                depth(a).total_cmp(&depth(b))
            });
        Some(match deepest {
            Some(deepest) => middle(corner, deepest),
            None => [0, 1].map(|axis| (before[axis] + corner[axis] + after[axis]) / 3.0),
        })
    }
}

/// Twice the area of a triangle, positive if it turns left.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn middle(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0]
}

/// Of a point from the line between two others.
fn distance(point: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (edge, to) = (
        [b[0] - a[0], b[1] - a[1]],
        [point[0] - a[0], point[1] - a[1]],
    );
    let squared = edge[0] * edge[0] + edge[1] * edge[1];
    let along = if squared > 0.0 {
        ((edge[0] * to[0] + edge[1] * to[1]) / squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (to[0] - along * edge[0]).hypot(to[1] - along * edge[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn overlap(a: &[[f64; 2]], b: &[[f64; 2]]) -> bool {
        let (a, b) = (Outline::new(a.to_vec()), Outline::new(b.to_vec()));
        let overlap = a.overlaps(&b);
        assert_eq!(overlap, b.overlaps(&a), "the order does not matter");
        overlap
    }

    fn rectangle(x: f64, y: f64, width: f64, height: f64) -> Vec<[f64; 2]> {
        vec![
            [x, y],
            [x + width, y],
            [x + width, y + height],
            [x, y + height],
        ]
    }

    #[test]
    fn outlines_overlap_where_they_share_an_area() {
        let unit = rectangle(0.0, 0.0, 1.0, 1.0);
        let turned = [[1.0, 1.0], [0.0, 1.0], [0.0, 0.0], [1.0, 0.0]];
        let diamond = [[0.5, -0.2], [1.2, 0.5], [0.5, 1.2], [-0.2, 0.5]];
        let notched = [[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]];
        let cases = [
            ("itself", unit.clone(), true),
            ("itself, from another corner", turned.to_vec(), true),
            ("next to it", rectangle(1.0, 0.0, 1.0, 1.0), false),
            (
                "next to it, as files round",
                rectangle(0.999_999, 0.0, 1.0, 1.0),
                false,
            ),
            ("at a corner", rectangle(1.0, 1.0, 1.0, 1.0), false),
            ("elsewhere", rectangle(3.0, 0.0, 1.0, 1.0), false),
            (
                "half of it, edge on edge",
                rectangle(0.5, 0.0, 1.0, 1.0),
                true,
            ),
            (
                "a third of it, edge on edge",
                rectangle(0.7, 0.0, 1.0, 1.0),
                true,
            ),
            (
                "across, off all middles",
                rectangle(-5.0, 0.42, 6.5, 0.05),
                true,
            ),
            ("within", rectangle(0.4, 0.4, 0.1, 0.1), true),
            ("across", rectangle(-1.0, 0.4, 3.0, 0.1), true),
            ("a diamond", diamond.to_vec(), true),
            (
                "a half of it",
                vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]],
                true,
            ),
            ("the whole plane", Vec::new(), true),
        ];
        for (name, other, expected) in cases {
            assert_eq!(overlap(&unit, &other), expected, "{name}");
        }
        assert!(
            !overlap(&notched, &rectangle(1.0, 1.0, 1.0, 1.0)),
            "in the notch"
        );
        assert!(
            overlap(&notched, &rectangle(0.5, 0.5, 0.2, 0.2)),
            "beside the notch"
        );
    }
}
