//! Exact intersections with a plane.

use std::cmp::Ordering;

use super::number::{Number, Vector};
use super::{Line, Margins, Root, Truth, U, along, difference, dot, first_sure, reach, wide};

/// The point of the plane in front of the origin; a ray in the plane or beside it has none.
pub fn truth(ray: &Line, point: [f32; 3], normal: [f32; 3]) -> Truth {
    first_sure!(solve(ray, point, normal))
}

pub(super) fn solve<N: Number>(ray: &Line, point: [f32; 3], normal: [f32; 3]) -> Option<Truth> {
    let normal = Vector::<N>::new(normal);
    let rate = normal.dot(&Vector::new(ray.direction));
    let height = normal.dot(&Vector::new(point).minus(&Vector::new(ray.origin)));
    let (rate_sign, height_sign) = (rate.sign()?, height.sign()?);
    if rate_sign == Ordering::Equal || height_sign != rate_sign {
        return Some(Truth::MISS);
    }
    Some(Truth::hit(height.over(rate).value()?))
}

/// Backward error of a distance, in u.
pub fn residual(ray: &Line, point: [f32; 3], normal: [f32; 3], t: f64) -> f64 {
    let normal = wide(normal);
    let height = dot(
        normal,
        along(difference(ray.origin, point), wide(ray.direction), t),
    );
    height.abs() / (U * reach(normal, ray, t, point))
}

/// How far the ray is from meeting the plane otherwise.
pub fn margins(ray: &Line, point: [f32; 3], normal: [f32; 3]) -> Margins {
    let (n, d) = (wide(normal), wide(ray.direction));
    let rate = dot(n, d);
    let t = dot(n, difference(point, ray.origin)) / rate;
    let rate_scale: f64 = (0..3).map(|i| (n[i] * d[i]).abs()).sum();
    let root = Root {
        t,
        counts: t > 0.0,
        margin: residual(ray, point, normal, 0.0),
    };
    Margins {
        line: rate.abs() / (U * rate_scale),
        meets: rate != 0.0,
        roots: [Some(root), None],
    }
}
