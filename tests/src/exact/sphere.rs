//! Exact intersections with a sphere.

use std::cmp::Ordering;

use super::number::{Number, Vector};
use super::{
    Line, Margins, Root, Truth, U, along, cross, difference, dot, first_sure, reach, wide,
};

/// The nearest point of the sphere in front of the origin; touching counts.
pub fn truth(ray: &Line, center: [f32; 3], radius: f32) -> Truth {
    first_sure!(solve(ray, center, radius))
}

/// `None` where the arithmetic does not decide.
pub(super) fn solve<N: Number>(ray: &Line, center: [f32; 3], radius: f32) -> Option<Truth> {
    let d = Vector::<N>::new(ray.direction);
    let f = Vector::new(center).minus(&Vector::new(ray.origin));
    along_line(d, f, N::new(radius))
}

/// Along a ray of direction `d`, of a sphere whose center lies at `f` from the origin.
pub(super) fn along_line<N: Number>(d: Vector<N>, f: Vector<N>, radius: N) -> Option<Truth> {
    // a t² - 2 b t + c = 0; the discriminant without the terms that cancel, by Lagrange's identity.
    let a = d.square();
    let b = f.dot(&d);
    let c = f.square() - radius.clone() * radius.clone();
    let discriminant = a.clone() * radius.clone() * radius - f.cross(&d).square();
    let (sign, ahead) = (discriminant.sign()?, b.sign()? == Ordering::Greater);
    if sign == Ordering::Less || a.sign()? == Ordering::Equal {
        return Some(Truth::MISS);
    }
    let root = if sign == Ordering::Equal {
        N::new(0.0)
    } else {
        discriminant.sqrt()
    };
    // In all that follows root and b add, and do not cancel.
    let t = match (c.sign()?, ahead) {
        (Ordering::Greater, true) => c.over(b + root),
        (Ordering::Less, true) => (b + root).over(a),
        (Ordering::Less, false) => (-c).over(root - b),
        // The origin is on the sphere: the other end of the chord.
        (Ordering::Equal, true) => (b.clone() + b).over(a),
        (_, false) => return Some(Truth::MISS),
    };
    Some(Truth::hit(t.value()?))
}

/// Backward error of a distance, in u.
pub fn residual(ray: &Line, center: [f32; 3], radius: f32, t: f64) -> f64 {
    let point = along(difference(ray.origin, center), wide(ray.direction), t);
    let length = dot(point, point).sqrt();
    let radius = f64::from(radius).abs();
    let scale = reach(point.map(|x| x / length), ray, t, center) + radius;
    (length - radius).abs() / (U * scale)
}

/// How far the ray is from meeting the sphere otherwise.
pub fn margins(ray: &Line, center: [f32; 3], radius: f32) -> Margins {
    let (d, f) = (wide(ray.direction), difference(center, ray.origin));
    margins_along(d, f, radius, |t| residual(ray, center, radius, t))
}

/// Along a ray of direction `d`, of a sphere whose center lies at `f` from the origin.
pub(super) fn margins_along(
    d: [f64; 3],
    f: [f64; 3],
    radius: f32,
    residual: impl Fn(f64) -> f64,
) -> Margins {
    let a = dot(d, d);
    let middle = dot(f, d) / a;
    let miss = cross(f, d);
    let half_chord_squared = f64::from(radius).powi(2) - dot(miss, miss) / a;
    let half_chord = (half_chord_squared.max(0.0) / a).sqrt();
    // A root counts no more, or again, when the origin is on the sphere.
    let margin = residual(0.0);
    let root = |t| {
        Some(Root {
            t,
            counts: t > 0.0,
            margin,
        })
    };
    Margins {
        line: residual(middle),
        meets: half_chord_squared >= 0.0,
        roots: [root(middle - half_chord), root(middle + half_chord)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const U32: f32 = f32::EPSILON * 0.5;

    #[test]
    fn known_answers() {
        let ray = |origin, direction| Line { origin, direction };
        let ahead = |x, z| ray([x, 0.0, z], [0.0, 0.0, 1.0]);
        let (zero, tiny) = ([0.0; 3], 2.0_f32.powi(-80));
        // Exact answers by rational arithmetic, rounded to 15 digits.
        let cases = [
            ("tangent", ahead(1.0, -3.0), zero, 1.0, Some(3.0)),
            (
                "a step inside",
                ahead(1.0 - U32, -3.0),
                zero,
                1.0,
                Some(2.999_654_733_022_14),
            ),
            (
                "a step outside",
                ahead(1.0 + 2.0 * U32, -3.0),
                zero,
                1.0,
                None,
            ),
            (
                "far",
                ahead(0.5, -10_000.0),
                zero,
                1.0,
                Some(9_999.133_974_596_22),
            ),
            ("far outside", ahead(1.5, -10_000.0), zero, 1.0, None),
            ("center", ray(zero, [0.0, 1.0, 0.0]), zero, 2.0, Some(2.0)),
            (
                "surface, out",
                ray([0.0, 0.0, -1.0], [0.0, 0.0, -1.0]),
                zero,
                1.0,
                None,
            ),
            (
                "surface, in",
                ray([0.0, 0.0, -1.0], [0.0, 0.0, 1.0]),
                zero,
                1.0,
                Some(2.0),
            ),
            (
                "surface, along",
                ray([0.0, 0.0, -1.0], [1.0, 0.0, 0.0]),
                zero,
                1.0,
                None,
            ),
            (
                "long direction",
                ray(zero, [3.0, 4.0, 0.0]),
                [6.0, 8.0, 0.0],
                5.0,
                Some(1.0),
            ),
            (
                "ground",
                ray([0.0, 1.0, 0.0], [0.0, -1.0, 0.0]),
                [0.0, -1e6, 0.0],
                1e6,
                Some(1.0),
            ),
            (
                "tiny",
                ahead(0.0, -3.0 * tiny),
                zero,
                tiny,
                Some(2.0_f64.powi(-79)),
            ),
            ("no direction", ray([0.0, 0.0, -3.0], zero), zero, 1.0, None),
        ];
        for (name, ray, center, radius, t) in cases {
            let found = truth(&ray, center, radius).t;
            let error = found.zip(t).map(|(found, t)| (found / t - 1.0).abs());
            assert_eq!(found.is_some(), t.is_some(), "{name}");
            assert!(error.unwrap_or(0.0) < 1e-14, "{name}: {found:?}");
        }
    }

    #[test]
    fn errors_are_counted_in_roundings_of_the_inputs() {
        let ray = Line {
            origin: [0.0, 0.0, -3.0],
            direction: [0.0, 0.0, 1.0],
        };
        // |o| + |t d| + |c| + r = 3 + 2 + 0 + 1.
        let residual = residual(&ray, [0.0; 3], 1.0, 2.0 * (1.0 + 3.0 * U));
        assert!((residual - 1.0).abs() < 1e-6, "{residual}");
        // One step outside the silhouette: 2 u of |o| + r = 1 + 1.
        let beside = Line {
            origin: [1.0 + 2.0 * U32, 0.0, -3.0],
            ..ray
        };
        let margins = margins(&beside, [0.0; 3], 1.0);
        assert!(
            !margins.meets && (margins.line - 1.0).abs() < 1e-6,
            "{margins:?}"
        );
    }
}
