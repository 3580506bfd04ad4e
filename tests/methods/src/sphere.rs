//! Ray and sphere.
//!
//! In all of them `f` joins the ray's origin with the center, `b` is its part along the ray. Those that
//! say so take any length of `ray.direction`; the others need unit length.

use glam::Vec3;
use whitted::math::sqrt;
use whitted::{Exact, Ray, Shape, Sphere};

use crate::compensated::{Pair, Pair3};
use crate::{Method, nearest};

/// Distance to the nearest point of the sphere that the ray admits.
pub type SphereMethod = Method<fn(&Ray, &Sphere) -> Option<f32>>;

/// All methods.
pub const METHODS: &[SphereMethod] = &[
    Method::new("core", core),
    Method::new("a,b,c", naive),
    Method::new("half b", half_b),
    Method::new("tangent", tangent),
    Method::new("half b, stable q", stable_q),
    Method::new("perpendicular", perpendicular),
    Method::new("remainder, stable q", remainder),
    Method::new("(r+l)(r-l)", difference_of_squares),
    Method::new("shift", shift),
    Method::new("shift, any d", shift_any),
    Method::new("shift, two sums", shift_two_sums),
    Method::new("shift, near surface", shift_near_surface),
    Method::new("compensated", compensated),
    Method::new("f64", double),
];

/// The kernel of `whitted`.
#[inline(never)]
pub fn core(ray: &Ray, sphere: &Sphere) -> Option<f32> {
    sphere.intersect::<Exact>(ray, &(), None)
}

/// The quadratic formula, by the school book; any direction.
#[inline(never)]
pub fn naive(ray: &Ray, sphere: &Sphere) -> Option<f32> {
    let f = ray.origin - sphere.center;
    let a = ray.direction.dot(ray.direction);
    let b = 2.0 * f.dot(ray.direction);
    let c = f.dot(f) - sphere.radius * sphere.radius;
    let discriminant = b * b - 4.0 * a * c;
    if !(discriminant >= 0.0) {
        return None;
    }
    let root = sqrt(discriminant);
    let scale = 1.0 / (2.0 * a);
    nearest(ray, (-b - root) * scale, (-b + root) * scale)
}

/// The same for a unit direction, where all factors 2 and `a` vanish.
#[inline(never)]
pub fn half_b(ray: &Ray, sphere: &Sphere) -> Option<f32> {
    let f = sphere.center - ray.origin;
    let b = f.dot(ray.direction);
    let c = f.dot(f) - sphere.radius * sphere.radius;
    let discriminant = b * b - c;
    if !(discriminant >= 0.0) {
        return None;
    }
    let root = sqrt(discriminant);
    nearest(ray, b - root, b + root)
}

/// By Pythagoras from the center: E. Haines, "Essential Ray Tracing Algorithms", in Glassner (ed.), An
/// Introduction to Ray Tracing (1989).
#[inline(never)]
pub fn tangent(ray: &Ray, sphere: &Sphere) -> Option<f32> {
    let f = sphere.center - ray.origin;
    let b = f.dot(ray.direction);
    let miss_squared = f.dot(f) - b * b;
    let half_chord_squared = sphere.radius * sphere.radius - miss_squared;
    if !(half_chord_squared >= 0.0) {
        return None;
    }
    let half_chord = sqrt(half_chord_squared);
    nearest(ray, b - half_chord, b + half_chord)
}

/// Half b, and the root that cancels from the product of both: W. H. Press et al., Numerical Recipes,
/// 5.6.
#[inline(never)]
pub fn stable_q(ray: &Ray, sphere: &Sphere) -> Option<f32> {
    let f = sphere.center - ray.origin;
    let b = f.dot(ray.direction);
    let c = f.dot(f) - sphere.radius * sphere.radius;
    let discriminant = b * b - c;
    if !(discriminant >= 0.0) {
        return None;
    }
    by_stable_q(ray, b, c, sqrt(discriminant))
}

#[inline(always)]
fn by_stable_q(ray: &Ray, b: f32, c: f32, root: f32) -> Option<f32> {
    if b > 0.0 {
        let q = b + root;
        nearest(ray, c / q, q)
    } else {
        let q = b - root;
        nearest(ray, q, c / q)
    }
}

/// The half chord from the vector of closest approach, as in Embree's sphere.
#[inline(never)]
pub fn perpendicular(ray: &Ray, sphere: &Sphere) -> Option<f32> {
    let f = sphere.center - ray.origin;
    let b = f.dot(ray.direction);
    let miss = f - ray.direction * b;
    let half_chord_squared = sphere.radius * sphere.radius - miss.dot(miss);
    if !(half_chord_squared >= 0.0) {
        return None;
    }
    let half_chord = sqrt(half_chord_squared);
    nearest(ray, b - half_chord, b + half_chord)
}

/// The same with a stable q: E. Haines et al., "Precision Improvements for Ray/Sphere Intersection",
/// Ray Tracing Gems (2019), ch. 7, after D. Hearn and M. P. Baker.
#[inline(never)]
pub fn remainder(ray: &Ray, sphere: &Sphere) -> Option<f32> {
    let f = sphere.center - ray.origin;
    let b = f.dot(ray.direction);
    let miss = f - ray.direction * b;
    let radius_squared = sphere.radius * sphere.radius;
    let half_chord_squared = radius_squared - miss.dot(miss);
    if !(half_chord_squared >= 0.0) {
        return None;
    }
    by_stable_q(ray, b, f.dot(f) - radius_squared, sqrt(half_chord_squared))
}

/// The discriminant as a product, any direction: M. Pharr, W. Jakob, G. Humphreys, Physically Based
/// Rendering, 4th ed. (2023), 6.2.2, without its intervals.
#[inline(never)]
pub fn difference_of_squares(ray: &Ray, sphere: &Sphere) -> Option<f32> {
    let f = sphere.center - ray.origin;
    let a = ray.direction.dot(ray.direction);
    let b = f.dot(ray.direction);
    let miss = f - ray.direction * (b / a);
    let length = sqrt(miss.dot(miss));
    let discriminant = a * (sphere.radius + length) * (sphere.radius - length);
    if !(discriminant >= 0.0) {
        return None;
    }
    let c = f.dot(f) - sphere.radius * sphere.radius;
    let root = sqrt(discriminant);
    if b > 0.0 {
        let q = b + root;
        nearest(ray, c / q, q / a)
    } else {
        let q = b - root;
        nearest(ray, q / a, c / q)
    }
}

/// The quadratic from the point of closest approach: I. Wald, "Improving Numerical Precision in
/// Intersection Programs", Ray Tracing Gems II (2021), ch. 34.
#[inline(never)]
pub fn shift(ray: &Ray, sphere: &Sphere) -> Option<f32> {
    let f = sphere.center - ray.origin;
    let approach = f.dot(ray.direction);
    let f = f - ray.direction * approach;
    let b = f.dot(ray.direction);
    let discriminant = b * b - (f.dot(f) - sphere.radius * sphere.radius);
    if !(discriminant >= 0.0) {
        return None;
    }
    let root = sqrt(discriminant);
    nearest(ray, approach + (b - root), approach + (b + root))
}

/// The same for any direction.
#[inline(never)]
pub fn shift_any(ray: &Ray, sphere: &Sphere) -> Option<f32> {
    by_any_length(ray, sphere)
}

#[inline(always)]
pub(crate) fn by_any_length(ray: &Ray, sphere: &Sphere) -> Option<f32> {
    let f = sphere.center - ray.origin;
    let a = ray.direction.dot(ray.direction);
    let approach = f.dot(ray.direction) / a;
    let f = f - ray.direction * approach;
    let b = f.dot(ray.direction);
    let discriminant = b * b - a * (f.dot(f) - sphere.radius * sphere.radius);
    if !(discriminant >= 0.0) {
        return None;
    }
    let root = sqrt(discriminant);
    nearest(ray, approach + (b - root) / a, approach + (b + root) / a)
}

/// The shift without the correction of the discriminant, which matters only at a million radii.
#[inline(never)]
pub fn shift_two_sums(ray: &Ray, sphere: &Sphere) -> Option<f32> {
    let f = sphere.center - ray.origin;
    let approach = f.dot(ray.direction);
    let f = f - ray.direction * approach;
    let discriminant = sphere.radius * sphere.radius - f.dot(f);
    if !(discriminant >= 0.0) {
        return None;
    }
    let b = f.dot(ray.direction);
    let root = sqrt(discriminant);
    nearest(ray, approach + (b - root), approach + (b + root))
}

/// The shift; where the near root cancels, it is taken from a compensated product of both roots.
#[inline(never)]
pub fn shift_near_surface(ray: &Ray, sphere: &Sphere) -> Option<f32> {
    let f = sphere.center - ray.origin;
    let approach = f.dot(ray.direction);
    let rest = f - ray.direction * approach;
    let b = rest.dot(ray.direction);
    let discriminant = b * b - (rest.dot(rest) - sphere.radius * sphere.radius);
    if !(discriminant >= 0.0) {
        return None;
    }
    let root = sqrt(discriminant);
    let (near, far) = (approach + (b - root), approach + (b + root));
    // Half of the digits or more are gone in the smaller root.
    let product = || {
        let f = Pair3::difference(sphere.center, ray.origin);
        let radius = Pair::new(sphere.radius);
        (f.dot(f) - radius * radius).value()
    };
    if near.abs() < 0.5 * far.abs() {
        nearest(ray, product() / far, far)
    } else if far.abs() < 0.5 * near.abs() {
        nearest(ray, near, product() / near)
    } else {
        nearest(ray, near, far)
    }
}

/// Everything but the final rounding in pairs of `f32`; any direction.
#[inline(never)]
pub fn compensated(ray: &Ray, sphere: &Sphere) -> Option<f32> {
    let f = Pair3::difference(sphere.center, ray.origin);
    let d = Pair3::new(ray.direction);
    let radius = Pair::new(sphere.radius);
    let a = d.dot(d);
    let b = f.dot(d);
    let approach = Pair::new(b.over(a));
    let rest = f.minus(d, approach);
    let along = rest.dot(d);
    let discriminant = along * along - a * (rest.dot(rest) - radius * radius);
    if !(discriminant.value() >= 0.0) {
        return None;
    }
    let root = discriminant.sqrt();
    let c = f.dot(f) - radius * radius;
    // The root's own error is that of a Newton step: the stable q keeps it out of the smaller root.
    if b.value() > 0.0 {
        let q = b + root;
        nearest(ray, c.over(q), q.over(a))
    } else {
        let q = b - root;
        nearest(ray, q.over(a), c.over(q))
    }
}

/// Remainder with stable q in `f64`; any direction.
#[inline(never)]
pub fn double(ray: &Ray, sphere: &Sphere) -> Option<f32> {
    let d = ray.direction.to_array().map(f64::from);
    let f = difference(sphere.center, ray.origin);
    let radius = f64::from(sphere.radius);
    let a = dot(d, d);
    let b = dot(f, d);
    let approach = b / a;
    let miss = [0, 1, 2].map(|i| f[i] - approach * d[i]);
    let discriminant = a * (radius * radius - dot(miss, miss));
    if !(discriminant >= 0.0) {
        return None;
    }
    let c = dot(f, f) - radius * radius;
    let root = libm::sqrt(discriminant);
    if b > 0.0 {
        let q = b + root;
        nearest(ray, (c / q) as f32, (q / a) as f32)
    } else {
        let q = b - root;
        nearest(ray, (q / a) as f32, (c / q) as f32)
    }
}

#[inline(always)]
pub(crate) fn difference(a: Vec3, b: Vec3) -> [f64; 3] {
    let wide = f64::from;
    [
        wide(a.x) - wide(b.x),
        wide(a.y) - wide(b.y),
        wide(a.z) - wide(b.z),
    ]
}

#[inline(always)]
pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
