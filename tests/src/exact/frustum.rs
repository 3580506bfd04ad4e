//! Exact intersections with an open cylinder or cone.
//!
//! With `q = point - base` and `s = q·axis` the surface is `|q - s axis| = base_radius + slope s` for
//! `s` from 0 to `length`, all five fields, and the length of the axis, taken as they are.

use std::cmp::Ordering;

use super::number::{Number, Vector};
use super::{Line, Margins, Root, Truth, U, along, difference, dot, first_sure, reach, wide};

/// A frustum as it is.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    /// Center of the base.
    pub base: [f32; 3],
    /// About unit length.
    pub axis: [f32; 3],
    /// Along the axis.
    pub length: f32,
    /// At the base, at least 0.
    pub base_radius: f32,
    /// Growth of the radius along the axis.
    pub slope: f32,
}

/// The nearest point of the side in front of the origin. Where the ray meets it exactly at an end, a
/// hit and a miss are both right.
pub fn truth(ray: &Line, side: &Side) -> Truth {
    first_sure!(solve(ray, side))
}

pub(super) fn solve<N: Number>(ray: &Line, side: &Side) -> Option<Truth> {
    let d = Vector::<N>::new(ray.direction);
    let axis = Vector::new(side.axis);
    let q = Vector::new(ray.origin).minus(&Vector::new(side.base));
    let (s, s_rate) = (q.dot(&axis), d.dot(&axis));
    let across = q.minus(&axis.times(&s));
    let across_rate = d.minus(&axis.times(&s_rate));
    let radius = N::new(side.base_radius) + N::new(side.slope) * s.clone();
    let radius_rate = N::new(side.slope) * s_rate.clone();
    // a t² + 2 b t + c = 0, and the discriminant without what cancels, by Lagrange's identity.
    let a = across_rate.square() - radius_rate.clone() * radius_rate.clone();
    let b = across.dot(&across_rate) - radius.clone() * radius_rate.clone();
    let c = across.square() - radius.clone() * radius.clone();
    let growth = across_rate
        .times(&radius)
        .minus(&across.times(&radius_rate));
    let discriminant = growth.square() - across.cross(&across_rate).square();
    let root = match discriminant.sign()? {
        Ordering::Less => return Some(Truth::MISS),
        Ordering::Equal => N::new(0.0),
        Ordering::Greater => discriminant.sqrt(),
    };
    // -b and the root add in q.
    let q = if b.sign()? == Ordering::Greater {
        -(b + root)
    } else {
        root - b
    };
    let mut nearest: Option<f64> = None;
    let mut either = false;
    for (numerator, denominator) in [(q.clone(), a), (c, q)] {
        if denominator.sign()? == Ordering::Equal {
            continue;
        }
        // In front of the origin: decided without the quotient.
        if numerator.sign()? != denominator.sign()? {
            continue;
        }
        let t = numerator.over(denominator);
        let at = s.clone() + t.clone() * s_rate.clone();
        let length = N::new(side.length);
        let to_end = length.clone() - at.clone();
        let at_an_end = at.vanishes(&length)? || to_end.vanishes(&length)?;
        let between = at.sign()? != Ordering::Less && to_end.sign()? != Ordering::Less;
        // Between the ends the radius is not negative, but for its own rounding.
        if !(at_an_end || between) {
            continue;
        }
        let t = t.value()?;
        if nearest.is_none_or(|best| t < best) {
            nearest = Some(t);
            either = at_an_end;
        }
    }
    Some(nearest.map_or(Truth::MISS, |t| Truth {
        either,
        ..Truth::hit(t)
    }))
}

/// Distance from the double cone without ends at `t`, and by how much u of the inputs changes it.
fn offset(ray: &Line, side: &Side, t: f64) -> (f64, f64) {
    let axis = wide(side.axis);
    let q = along(difference(ray.origin, side.base), wide(ray.direction), t);
    let s = dot(q, axis);
    let across = along(q, axis, -s);
    let distance = dot(across, across).sqrt();
    let (radius, slope) = (f64::from(side.base_radius), f64::from(side.slope));
    // Of both halves of the double cone, the one on whose side the point is.
    let sign = if radius + slope * s < 0.0 { -1.0 } else { 1.0 };
    let secant = (1.0 + slope * slope).sqrt();
    let unit = if distance > 0.0 {
        across.map(|x| x / distance)
    } else {
        [0.0; 3]
    };
    let normal = [0, 1, 2].map(|i| (unit[i] - sign * slope * axis[i]) / secant);
    let (o, d, base) = (wide(ray.origin), wide(ray.direction), wide(side.base));
    let reach: f64 = (0..3)
        .map(|i| {
            let arm = o[i].abs() + (t * d[i]).abs() + base[i].abs() + (s * axis[i]).abs();
            normal[i].abs() * arm
        })
        .sum();
    let offset = (distance - sign * (radius + slope * s)) / secant;
    (
        offset,
        U * (reach + (radius.abs() + (slope * s).abs()) / secant),
    )
}

/// Backward error of a distance, in u: from the double cone, and from between the ends.
pub fn residual(ray: &Line, side: &Side, t: f64) -> f64 {
    let (offset, scale) = offset(ray, side, t);
    let axis = wide(side.axis);
    let at = dot(
        along(difference(ray.origin, side.base), wide(ray.direction), t),
        axis,
    );
    let beyond = (-at).max(at - f64::from(side.length)).max(0.0);
    (offset.abs() / scale).max(beyond / end_scale(ray, side, t))
}

/// By how much u of the inputs moves a point along the axis, or the end that it is compared with.
fn end_scale(ray: &Line, side: &Side, t: f64) -> f64 {
    U * (reach(wide(side.axis), ray, t, side.base) + f64::from(side.length))
}

/// How far the ray is from meeting the side otherwise.
pub fn margins(ray: &Line, side: &Side) -> Margins {
    let (axis, d) = (wide(side.axis), wide(ray.direction));
    // From the point closest to the base, so that f64 has digits to spare.
    let to_base = difference(side.base, ray.origin);
    let approach = dot(to_base, d) / dot(d, d);
    let q = along(to_base.map(|x| -x), d, approach);
    let (s, s_rate) = (dot(q, axis), dot(d, axis));
    let (across, across_rate) = (along(q, axis, -s), along(d, axis, -s_rate));
    let slope = f64::from(side.slope);
    let (radius, radius_rate) = (f64::from(side.base_radius) + slope * s, slope * s_rate);
    let a = dot(across_rate, across_rate) - radius_rate * radius_rate;
    let b = dot(across, across_rate) - radius * radius_rate;
    let c = dot(across, across) - radius * radius;
    let growth = [0, 1, 2].map(|i| across_rate[i] * radius - across[i] * radius_rate);
    let twist = super::cross(across, across_rate);
    let discriminant = dot(growth, growth) - dot(twist, twist);
    let half = discriminant.max(0.0).sqrt();
    let q = if b > 0.0 { -(b + half) } else { half - b };
    let meets = discriminant >= 0.0;
    let middle = -b / a;
    let (at_origin, at_origin_scale) = offset(ray, side, 0.0);
    let at_origin = at_origin.abs() / at_origin_scale;
    let length = f64::from(side.length);
    let root = |root: f64| {
        let t = approach + root;
        let at = s + root * s_rate;
        let (_, scale) = offset(ray, side, t);
        let point = radius + root * radius_rate;
        // Derivative of the offset along the ray.
        let across = along(across, across_rate, root);
        let distance = dot(across, across).sqrt();
        let rate = (dot(across, across_rate) / distance - slope * s_rate * point.signum())
            / (1.0 + slope * slope).sqrt();
        // By how much u of the inputs moves the root along the axis: also along the ray, where it
        // grazes the surface.
        let shift = end_scale(ray, side, t) + s_rate.abs() * scale / rate.abs();
        let ends = [at / shift, (length - at) / shift];
        let ahead = if t > 0.0 { at_origin } else { -at_origin };
        let least = ends[0].min(ends[1]).min(ahead);
        t.is_finite().then_some(Root {
            t,
            counts: least >= 0.0,
            margin: least.abs(),
        })
    };
    Margins {
        line: {
            let (offset, scale) = offset(ray, side, approach + middle);
            offset.abs() / scale
        },
        meets,
        roots: if meets {
            [root(q / a), root(c / q)]
        } else {
            [root(middle), None]
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_answers() {
        let side = |base_radius, slope| Side {
            base: [0.0; 3],
            axis: [0.0, 1.0, 0.0],
            length: 2.0,
            base_radius,
            slope,
        };
        let (cylinder, cone) = (side(1.0, 0.0), side(0.0, 0.75));
        let across = |x, y| Line {
            origin: [x, y, -3.0],
            direction: [0.0, 0.0, 1.0],
        };
        let up = |x, y| Line {
            origin: [x, y, 0.0],
            direction: [0.0, 1.0, 0.0],
        };
        let cases = [
            ("across", across(0.0, 1.0), cylinder, Some(2.0), false),
            (
                "off center",
                across(0.5, 1.0),
                cylinder,
                Some(3.0 - 0.75_f64.sqrt()),
                false,
            ),
            (
                "beside",
                across(1.0 + f32::EPSILON, 1.0),
                cylinder,
                None,
                false,
            ),
            ("at the rim", across(0.0, 2.0), cylinder, Some(2.0), true),
            (
                "past the rim",
                across(0.0, 2.0 + 2.0 * f32::EPSILON),
                cylinder,
                None,
                false,
            ),
            ("through the hole", up(0.5, -3.0), cylinder, None, false),
            ("cone", across(0.0, 1.0), cone, Some(2.25), false),
            ("cone, below", across(0.0, -1.0), cone, None, false),
            ("cone, from below", up(0.75, -3.0), cone, Some(4.0), false),
            ("cone, apex", across(0.0, 0.0), cone, Some(3.0), true),
            (
                // Parallel to a side: one root only, and linear. 2 (t/√2 - 1) t/√2 … by hand: the ray
                // (0, s, s - 1) meets |z| = 0.75 y where 1 - s = 0.75 s.
                "cone, steep",
                Line {
                    origin: [0.0, 0.0, -1.0],
                    direction: [0.0, 1.0, 1.0],
                },
                cone,
                Some(1.0 / 1.75),
                false,
            ),
        ];
        for (name, ray, side, t, either) in cases {
            truth(&ray, &side).assert_is(t, either, name);
        }
    }

    #[test]
    fn a_point_beyond_an_end_is_off_the_surface() {
        let side = Side {
            base: [0.0; 3],
            axis: [0.0, 1.0, 0.0],
            length: 2.0,
            base_radius: 1.0,
            slope: 0.0,
        };
        let ray = |y| Line {
            origin: [0.0, y, -3.0],
            direction: [0.0, 0.0, 1.0],
        };
        assert_eq!(residual(&ray(1.0), &side, 2.0), 0.0);
        // A quarter above the rim, of |o| + |b| + length = 2.25 + 0 + 2.
        let beyond = residual(&ray(2.25), &side, 2.0);
        assert!((beyond * U - 0.25 / 4.25).abs() < 1e-12, "{beyond}");
    }
}
