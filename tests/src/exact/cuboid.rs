//! Exact intersections with an axis-aligned box.

use std::cmp::Ordering;

use super::number::Number;
use super::{Line, Margins, Root, Truth, U, first_sure};

/// The nearest point of the surface in front of the origin; edges and corners belong to it.
pub fn truth(ray: &Line, min: [f32; 3], max: [f32; 3]) -> Truth {
    first_sure!(solve(ray, min, max))
}

/// A distance as a fraction with a positive denominator.
#[derive(Clone)]
struct Fraction<N> {
    numerator: N,
    denominator: N,
}

impl<N: Number> Fraction<N> {
    fn compare(&self, other: &Self) -> Option<Ordering> {
        let left = self.numerator.clone() * other.denominator.clone();
        let right = other.numerator.clone() * self.denominator.clone();
        (left - right).sign()
    }
}

pub(super) fn solve<N: Number>(ray: &Line, min: [f32; 3], max: [f32; 3]) -> Option<Truth> {
    let (mut entry, mut exit): (Option<Fraction<N>>, Option<Fraction<N>>) = (None, None);
    for i in 0..3 {
        let (o, d) = (ray.origin[i], ray.direction[i]);
        if d == 0.0 {
            if !(min[i]..=max[i]).contains(&o) {
                return Some(Truth::MISS);
            }
            continue;
        }
        let (near, far) = if d > 0.0 {
            (min[i], max[i])
        } else {
            (max[i], min[i])
        };
        let to = |bound: f32| {
            let way = if d > 0.0 {
                N::new(bound) - N::new(o)
            } else {
                N::new(o) - N::new(bound)
            };
            Fraction {
                numerator: way,
                denominator: N::new(d.abs()),
            }
        };
        let (near, far) = (to(near), to(far));
        entry = match entry {
            Some(entry) if near.compare(&entry)? != Ordering::Greater => Some(entry),
            _ => Some(near),
        };
        exit = match exit {
            Some(exit) if far.compare(&exit)? != Ordering::Less => Some(exit),
            _ => Some(far),
        };
    }
    let (Some(entry), Some(exit)) = (entry, exit) else {
        return Some(Truth::MISS);
    };
    if entry.compare(&exit)? == Ordering::Greater {
        return Some(Truth::MISS);
    }
    let met = if entry.numerator.sign()? == Ordering::Greater {
        entry
    } else if exit.numerator.sign()? == Ordering::Greater {
        exit
    } else {
        return Some(Truth::MISS);
    };
    Some(Truth::hit(met.numerator.over(met.denominator).value()?))
}

/// Distance of a coordinate from a bound against what both are made of, in u; negative within.
fn offset(ray: &Line, axis: usize, t: f64, bound: f32, outward: f64) -> f64 {
    let (o, d) = (f64::from(ray.origin[axis]), f64::from(ray.direction[axis]));
    let bound = f64::from(bound);
    let scale = o.abs() + (t * d).abs() + bound.abs();
    let distance = outward * ((o - bound) + t * d);
    if distance == 0.0 {
        0.0
    } else {
        distance / (U * scale)
    }
}

/// Backward error of a distance, in u: of the six faces, the one furthest inward decides.
pub fn residual(ray: &Line, min: [f32; 3], max: [f32; 3], t: f64) -> f64 {
    (0..3)
        .map(|i| offset(ray, i, t, min[i], -1.0).max(offset(ray, i, t, max[i], 1.0)))
        .fold(f64::NEG_INFINITY, f64::max)
        .abs()
}

/// How far the ray is from meeting the box otherwise.
pub fn margins(ray: &Line, min: [f32; 3], max: [f32; 3]) -> Margins {
    let o = ray.origin.map(f64::from);
    let d = ray.direction.map(f64::from);
    let bounds = |i: usize| {
        if d[i] >= 0.0 {
            (min[i], max[i])
        } else {
            (max[i], min[i])
        }
    };
    let way = |i: usize, bound: f32| f64::from(bound) - o[i];
    let (mut entry, mut exit) = (f64::NEG_INFINITY, f64::INFINITY);
    for i in (0..3).filter(|&i| d[i] != 0.0) {
        let (near, far) = bounds(i);
        entry = entry.max(way(i, near) / d[i]);
        exit = exit.min(way(i, far) / d[i]);
    }
    // The line meets the box if it enters each slab before it leaves each other: seen along the third
    // axis, it passes the edge between the two planes on the right side.
    let (mut least, mut worst) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut passes = |distance: f64, scale: f64| {
        let margin = if distance == 0.0 {
            0.0
        } else {
            distance / (U * scale)
        };
        least = least.min(margin);
        worst = worst.max(-margin);
    };
    for i in 0..3 {
        let near = bounds(i).0;
        if d[i] == 0.0 {
            passes(-way(i, min[i]), o[i].abs() + f64::from(min[i]).abs());
            passes(way(i, max[i]), o[i].abs() + f64::from(max[i]).abs());
            continue;
        }
        for j in (0..3).filter(|&j| j != i && d[j] != 0.0) {
            let far = bounds(j).1;
            let distance = way(j, far) * d[j].signum() * d[i].abs()
                - way(i, near) * d[i].signum() * d[j].abs();
            let reach = |k: usize, bound: f32, t: f64| {
                o[k].abs() + f64::from(bound).abs() + (t * d[k]).abs()
            };
            let (t_i, t_j) = (way(i, near) / d[i], way(j, far) / d[j]);
            passes(
                distance,
                d[j].abs() * reach(i, near, t_i) + d[i].abs() * reach(j, far, t_j),
            );
        }
    }
    let meets = least >= 0.0;
    let margin = residual(ray, min, max, 0.0);
    let root = |t: f64| {
        t.is_finite().then_some(Root {
            t,
            counts: t > 0.0,
            margin,
        })
    };
    Margins {
        line: if meets { least } else { worst },
        meets,
        // Where it misses, the one point that it might touch.
        roots: if meets {
            [root(entry), root(exit)]
        } else {
            [root(0.5 * (entry + exit)), None]
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_answers() {
        let cube = ([-1.0; 3], [1.0; 3]);
        let along = |y, direction| Line {
            origin: [-2.0, y, 0.0],
            direction,
        };
        let edge = |y| Line {
            origin: [0.0, y, 0.0],
            direction: [1.0, 1.0, 0.0],
        };
        let step = f32::EPSILON;
        let cases = [
            (
                "along an axis",
                along(0.0, [1.0, -0.0, 0.0]),
                cube,
                Some(1.0),
            ),
            (
                "in a face's plane",
                along(1.0, [1.0, 0.0, -0.0]),
                cube,
                Some(1.0),
            ),
            (
                "a step above it",
                along(1.0 + step, [1.0, 0.0, 0.0]),
                cube,
                None,
            ),
            (
                "inside",
                Line {
                    origin: [0.0; 3],
                    direction: [1.0, 0.0, 0.0],
                },
                cube,
                Some(1.0),
            ),
            ("through an edge", edge(-2.0), cube, Some(1.0)),
            ("a step past it", edge(-2.0 - 2.0 * step), cube, None),
            (
                "flat",
                Line {
                    origin: [0.0, 1.0, 0.0],
                    direction: [0.0, -1.0, 0.0],
                },
                ([-1.0, 0.0, -1.0], [1.0, 0.0, 1.0]),
                Some(1.0),
            ),
            (
                "no direction",
                Line {
                    origin: [0.0; 3],
                    direction: [0.0; 3],
                },
                cube,
                None,
            ),
        ];
        for (name, ray, (min, max), t) in cases {
            assert_eq!(truth(&ray, min, max).t, t, "{name}");
        }
    }

    #[test]
    fn a_miss_is_as_far_off_as_the_edge_that_it_passes() {
        let ray = Line {
            origin: [0.0, -2.0 - 2.0 * f32::EPSILON, 0.0],
            direction: [1.0, 1.0, 0.0],
        };
        let margins = margins(&ray, [-1.0; 3], [1.0; 3]);
        assert!(!margins.meets);
        // 4 u in y, of |o| + |b| + |t d| = 0 + 1 + 1 in x and 2 + 1 + 1 in y.
        assert!((margins.line - 4.0 / 6.0).abs() < 1e-6, "{}", margins.line);
    }
}
