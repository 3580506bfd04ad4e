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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_answers() {
        let floor = ([0.0; 3], [0.0, 1.0, 0.0]);
        let above = |direction| Line {
            origin: [0.0, 1.0, 0.0],
            direction,
        };
        let within = |direction| Line {
            origin: [0.0; 3],
            direction,
        };
        let far = 8_388_608.0;
        let cases = [
            (
                "horizon",
                above([1.0, -(2.0_f32.powi(-20)), 0.0]),
                floor,
                Some(1_048_576.0),
            ),
            ("beside", above([1.0, 0.0, 0.0]), floor, None),
            ("within", within([1.0, 0.0, 0.0]), floor, None),
            ("away", above([0.0, 1.0, 0.0]), floor, None),
            ("from the plane", within([0.0, -1.0, 0.0]), floor, None),
            (
                "beyond all f32",
                above([1.0, -f32::from_bits(1), 0.0]),
                floor,
                None,
            ),
            (
                "far from 0",
                Line {
                    origin: [far + 1.0, far + 2.0, far + 2.0],
                    direction: [-1.0, -2.0, -2.0],
                },
                ([far; 3], [1.0, 2.0, 2.0]),
                Some(1.0),
            ),
        ];
        for (name, ray, (point, normal), t) in cases {
            assert_eq!(truth(&ray, point, normal).t, t, "{name}");
        }
    }
}
