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
fn solve<N: Number>(ray: &Line, center: [f32; 3], radius: f32) -> Option<Truth> {
    let d = Vector::<N>::new(ray.direction);
    let f = Vector::new(center).minus(&Vector::new(ray.origin));
    let radius = N::new(radius);
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
    let a = dot(d, d);
    let middle = dot(f, d) / a;
    let miss = cross(f, d);
    let half_chord_squared = f64::from(radius).powi(2) - dot(miss, miss) / a;
    let half_chord = (half_chord_squared.max(0.0) / a).sqrt();
    // A root counts no more, or again, when the origin is on the sphere.
    let margin = residual(ray, center, radius, 0.0);
    let root = |t| {
        Some(Root {
            t,
            counts: t > 0.0,
            margin,
        })
    };
    Margins {
        line: residual(ray, center, radius, middle),
        meets: half_chord_squared >= 0.0,
        roots: [root(middle - half_chord), root(middle + half_chord)],
    }
}
