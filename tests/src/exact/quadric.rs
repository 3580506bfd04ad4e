//! Exact intersections with a clipped quadric, open or closed.
//!
//! With `q` from the center the surface is `q·(S q) + 2 l·q + k = 0`, all ten coefficients, the planes of
//! the clip and the length of its axis taken as they are.

use std::cmp::Ordering;

use super::number::{Number, Vector};
use super::{Line, Margins, Root, Truth, U, along, difference, dot, first_sure, reach, wide};

/// A quadric as it is.
#[derive(Clone, Copy, Debug)]
pub struct Quadric {
    /// From which all else is measured.
    pub center: [f32; 3],
    /// The coefficients of squares.
    pub squares: [f32; 3],
    /// Half of those of yz, zx and xy.
    pub products: [f32; 3],
    /// Half of those of x, y and z.
    pub linear: [f32; 3],
    /// The constant.
    pub constant: f32,
    /// Normals, about unit length, and distances of the planes that clip it. What counts is on the side
    /// to which the normal does not point.
    pub planes: [Option<([f32; 3], f32)>; 8],
    /// Whether the planes are faces.
    pub closed: bool,
}

/// The nearest point of the surface in front of the origin. Where the ray meets it exactly where it is
/// cut, a hit and a miss are both right.
pub fn truth(ray: &Line, quadric: &Quadric) -> Truth {
    first_sure!(solve(ray, quadric))
}

/// `S v`.
fn times<N: Number>(quadric: &Quadric, v: &Vector<N>) -> Vector<N> {
    let [xx, yy, zz] = quadric.squares.map(N::new);
    let [yz, zx, xy] = quadric.products.map(N::new);
    let row = |a: &N, b: &N, c: &N| Vector([a.clone(), b.clone(), c.clone()]).dot(v);
    Vector([row(&xx, &xy, &zx), row(&xy, &yy, &yz), row(&zx, &yz, &zz)])
}

pub(super) fn solve<N: Number>(ray: &Line, quadric: &Quadric) -> Option<Truth> {
    let d = Vector::<N>::new(ray.direction);
    let q = Vector::new(ray.origin).minus(&Vector::new(quadric.center));
    let linear = Vector::new(quadric.linear);
    // a t² + 2 b t + c.
    let a = times(quadric, &d).dot(&d);
    let sq = times(quadric, &q);
    let b = sq.dot(&d) + linear.dot(&d);
    let c = sq.dot(&q) + linear.dot(&q) + linear.dot(&q) + N::new(quadric.constant);
    let mut nearest: Option<f64> = None;
    let mut either = false;
    let mut offer = |t: &N, cut: bool| {
        let t = t.value()?;
        if nearest.is_none_or(|best| t < best) {
            nearest = Some(t);
            either = cut;
        }
        Some(())
    };
    // How far beyond each plane the ray starts, and how fast it goes there.
    let planes: Vec<(N, N, N)> = quadric
        .planes
        .iter()
        .flatten()
        .map(|(normal, distance)| {
            let (normal, distance) = (Vector::new(*normal), N::new(*distance));
            (normal.dot(&q) - distance.clone(), normal.dot(&d), distance)
        })
        .collect();
    // Whether the point at `t` is inside all planes but one, or on one.
    let inside = |t: &N, but: Option<usize>| {
        let mut cut = false;
        for (i, (start, rate, distance)) in planes.iter().enumerate() {
            if Some(i) == but {
                continue;
            }
            let beyond = start.clone() + rate.clone() * t.clone();
            let scale = start.clone() * start.clone() + distance.clone() * distance.clone();
            if beyond.vanishes(&scale)? {
                cut = true;
            } else if beyond.sign()? == Ordering::Greater {
                return Some(None);
            }
        }
        Some(Some(cut))
    };
    let discriminant = b.clone() * b.clone() - a.clone() * c.clone();
    let root = match discriminant.sign()? {
        Ordering::Less => None,
        Ordering::Equal => Some(N::new(0.0)),
        Ordering::Greater => Some(discriminant.sqrt()),
    };
    if let Some(root) = root {
        // -b and the root add.
        let sum = if b.sign()? == Ordering::Greater {
            -(b.clone() + root)
        } else {
            root - b.clone()
        };
        for (numerator, denominator) in [(sum.clone(), a.clone()), (c.clone(), sum)] {
            let sign = denominator.sign()?;
            // In front of the origin: decided without the quotient.
            if sign == Ordering::Equal || numerator.sign()? != sign {
                continue;
            }
            let t = numerator.over(denominator);
            if let Some(cut) = inside(&t, None)? {
                offer(&t, cut)?;
            }
        }
    }
    if quadric.closed {
        for (i, (start, rate, _)) in planes.iter().enumerate() {
            let sign = rate.sign()?;
            if sign == Ordering::Equal || (-start.clone()).sign()? != sign {
                continue;
            }
            // The polynomial at -start / rate, times rate².
            let value =
                (a.clone() * start.clone() - b.clone() * rate.clone() - b.clone() * rate.clone())
                    * start.clone()
                    + c.clone() * rate.clone() * rate.clone();
            let value = value.sign()?;
            if value == Ordering::Greater {
                continue;
            }
            let t = (-start.clone()).over(rate.clone());
            if let Some(cut) = inside(&t, Some(i))? {
                offer(&t, cut || value == Ordering::Equal)?;
            }
        }
    }
    Some(nearest.map_or(Truth::MISS, |t| Truth {
        either,
        ..Truth::hit(t)
    }))
}

fn apply(quadric: &Quadric, v: [f64; 3]) -> [f64; 3] {
    let ([xx, yy, zz], [yz, zx, xy]) = (wide(quadric.squares), wide(quadric.products));
    [
        dot([xx, xy, zx], v),
        dot([xy, yy, yz], v),
        dot([zx, yz, zz], v),
    ]
}

/// The polynomial at `t`, half its gradient, and how much a rounding of each input changes it.
fn value(ray: &Line, quadric: &Quadric, t: f64) -> (f64, [f64; 3], f64) {
    let q = along(
        difference(ray.origin, quadric.center),
        wide(ray.direction),
        t,
    );
    let (sq, linear) = (apply(quadric, q), wide(quadric.linear));
    let constant = f64::from(quadric.constant);
    let half_gradient = along(sq, linear, 1.0);
    let value = dot(sq, q) + 2.0 * dot(linear, q) + constant;
    let absolute = Quadric {
        squares: quadric.squares.map(f32::abs),
        products: quadric.products.map(f32::abs),
        ..*quadric
    };
    let sizes = q.map(f64::abs);
    let of_coefficients = dot(apply(&absolute, sizes), sizes)
        + 2.0 * dot(linear.map(f64::abs), sizes)
        + constant.abs();
    let scale = of_coefficients + 2.0 * reach(half_gradient, ray, t, quadric.center);
    (value, half_gradient, U * scale)
}

/// How far beyond a plane the ray is at `t`, and how much a rounding of each input changes that.
fn beyond(ray: &Line, quadric: &Quadric, plane: ([f32; 3], f32), t: f64) -> (f64, f64) {
    let q = along(
        difference(ray.origin, quadric.center),
        wide(ray.direction),
        t,
    );
    let (normal, distance) = (wide(plane.0), f64::from(plane.1));
    let scale = reach(normal, ray, t, quadric.center) + distance.abs();
    (dot(normal, q) - distance, U * scale)
}

/// Backward error of a distance, in u: from the quadric and from beyond the planes; of a closed one, from
/// whatever is furthest outward.
pub fn residual(ray: &Line, quadric: &Quadric, t: f64) -> f64 {
    let (value, _, scale) = value(ray, quadric, t);
    let off = value / scale;
    let planes = quadric.planes.iter().flatten();
    let beyond = planes.map(|&plane| {
        let (beyond, scale) = beyond(ray, quadric, plane, t);
        beyond / scale
    });
    let beyond = beyond.fold(f64::NEG_INFINITY, f64::max);
    if quadric.closed {
        off.max(beyond).abs()
    } else {
        off.abs().max(beyond)
    }
}

/// How far the ray is from meeting an open quadric otherwise.
pub fn margins(ray: &Line, quadric: &Quadric) -> Margins {
    let d = wide(ray.direction);
    // From the point closest to the center, so that f64 has digits to spare.
    let to_center = difference(quadric.center, ray.origin);
    let approach = dot(to_center, d) / dot(d, d);
    let mut shift = approach;
    let (mut c, mut half_gradient, _) = value(ray, quadric, shift);
    let a = dot(apply(quadric, d), d);
    let mut b = dot(half_gradient, d);
    // And on to where the polynomial is extreme, if that is not far.
    if a * c > 0.5 * b * b {
        shift -= b / a;
        (c, half_gradient, _) = value(ray, quadric, shift);
        b = dot(half_gradient, d);
    }
    let discriminant = b * b - a * c;
    let half = discriminant.max(0.0).sqrt();
    let q = if b > 0.0 { -(b + half) } else { half - b };
    let meets = discriminant >= 0.0;
    let middle = -b / a;
    let off = |t: f64| {
        let (value, _, scale) = value(ray, quadric, t);
        value.abs() / scale
    };
    let at_origin = off(0.0);
    let root = |root: f64| {
        let t = shift + root;
        let (_, half_gradient, scale) = value(ray, quadric, t);
        // By how much a rounding of the inputs moves the root along the ray.
        let slip = scale / (2.0 * dot(half_gradient, d)).abs();
        let ends = quadric.planes.iter().flatten().map(|&plane| {
            let (beyond, scale) = beyond(ray, quadric, plane, t);
            let rate = dot(wide(plane.0), d).abs();
            -beyond / (scale + rate * slip)
        });
        let ahead = if t > 0.0 { at_origin } else { -at_origin };
        let least = ends.fold(ahead, f64::min);
        t.is_finite().then_some(Root {
            t,
            counts: least >= 0.0,
            margin: least.abs(),
        })
    };
    let line = if middle.is_finite() {
        off(shift + middle)
    } else {
        f64::INFINITY
    };
    Margins {
        line,
        meets,
        roots: if meets {
            [root(q / a), root(c / q)]
        } else {
            [root(middle), None]
        },
    }
}

/// The least change of the inputs, in u, that may change what a closed quadric answers: until the origin
/// is on the surface, the line touches the quadric, or it passes through where a plane cuts it.
pub fn least_margin(ray: &Line, quadric: &Quadric) -> f64 {
    let open = margins(ray, quadric);
    let mut least = open.line.min(residual(ray, quadric, 0.0));
    for root in open.roots.iter().flatten() {
        least = least.min(root.margin);
    }
    let d = wide(ray.direction);
    for &plane in quadric.planes.iter().flatten() {
        let rate = dot(wide(plane.0), d);
        let (start, _) = beyond(ray, quadric, plane, 0.0);
        let t = -start / rate;
        if !t.is_finite() {
            continue;
        }
        let (value, half_gradient, scale) = value(ray, quadric, t);
        let (_, of_plane) = beyond(ray, quadric, plane, t);
        let moved = (2.0 * dot(half_gradient, d) * of_plane / rate).abs();
        least = least.min(value.abs() / (scale + moved));
        // Or through the edge between two planes.
        for &other in quadric.planes.iter().flatten().filter(|&&it| it != plane) {
            let (beyond, scale) = beyond(ray, quadric, other, t);
            let moved = (dot(wide(other.0), d) * of_plane / rate).abs();
            least = least.min(beyond.abs() / (scale + moved));
        }
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;

    const BALL: Quadric = Quadric {
        center: [0.0; 3],
        squares: [1.0; 3],
        products: [0.0; 3],
        linear: [0.0; 3],
        constant: -1.0,
        planes: [None; 8],
        closed: false,
    };

    #[test]
    fn known_answers() {
        let mut bowl = BALL;
        bowl.planes[0] = Some(([0.0, 1.0, 0.0], 0.5));
        let half = Quadric {
            closed: true,
            ..bowl
        };
        // z = x y, of one ruling: the ray along it lies in the surface.
        let saddle = Quadric {
            squares: [0.0; 3],
            products: [0.0, 0.0, 0.5],
            linear: [0.0, 0.0, -0.5],
            constant: 0.0,
            ..BALL
        };
        let ray = |origin, direction| Line { origin, direction };
        let (down, across) = ([0.0, -1.0, 0.0], [0.0, 0.0, 1.0]);
        let chord = 0.75_f64.sqrt();
        let cases = [
            (
                "ball",
                ray([0.0, 0.0, -3.0], across),
                BALL,
                Some(2.0),
                false,
            ),
            (
                "tangent",
                ray([1.0, 0.0, -3.0], across),
                BALL,
                Some(3.0),
                false,
            ),
            (
                "into the bowl",
                ray([0.0, 3.0, 0.0], down),
                bowl,
                Some(4.0),
                false,
            ),
            (
                "on its face",
                ray([0.0, 3.0, 0.0], down),
                half,
                Some(2.5),
                false,
            ),
            (
                "its rim",
                ray([0.0, 0.5, -3.0], across),
                bowl,
                Some(3.0 - chord),
                true,
            ),
            (
                "over its rim",
                ray([0.0, 0.625, -3.0], across),
                half,
                None,
                false,
            ),
            (
                "saddle",
                ray([2.0, 3.0, 10.0], [0.0, 0.0, -1.0]),
                saddle,
                Some(4.0),
                false,
            ),
            (
                "beside a ruling",
                ray([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
                saddle,
                None,
                false,
            ),
            (
                "parallel to an asymptote",
                ray([0.0, 1.0, -3.0], [1.0, 0.0, 0.0]),
                saddle,
                None,
                false,
            ),
            (
                "and ahead",
                ray([0.0, 1.0, 3.0], [1.0, 0.0, 0.0]),
                saddle,
                Some(3.0),
                false,
            ),
        ];
        for (name, ray, quadric, t, either) in cases {
            truth(&ray, &quadric).assert_is(t, either, name);
        }
    }

    #[test]
    fn a_sphere_is_judged_as_a_sphere() {
        let ray = Line {
            origin: [0.3, 0.2, -3.0],
            direction: [0.0, 0.1, 1.0],
        };
        let root = truth(&ray, &BALL).t.expect("a hit");
        // To first order, which is all that either is.
        let near = root * (1.0 + 1e-5);
        let here = residual(&ray, &BALL, near);
        let there = super::super::sphere::residual(&ray, [0.0; 3], 1.0, near);
        assert!((here / there - 1.0).abs() < 1e-3, "{here} {there}");
    }

    #[test]
    fn a_point_beyond_a_plane_is_off_the_surface() {
        let mut bowl = BALL;
        bowl.planes[0] = Some(([0.0, 1.0, 0.0], 0.5));
        let ray = Line {
            origin: [0.0, 3.0, 0.0],
            direction: [0.0, -1.0, 0.0],
        };
        assert_eq!(residual(&ray, &bowl, 4.0), 0.0);
        // Half above the plane, of |o| + |t d| + distance = 3 + 2 + 0.5.
        assert!((residual(&ray, &bowl, 2.0) * U - 0.5 / 5.5).abs() < 1e-12);
        let closed = Quadric {
            closed: true,
            ..bowl
        };
        assert_eq!(residual(&ray, &closed, 2.5), 0.0);
    }
}
