//! Ray and open quadric.
//!
//! Along the ray the polynomial is `a t² + 2 b t + c`. The methods differ in the point of the ray from
//! which `t` counts, and so in how large the numbers are that cancel.

use glam::Vec3;
use whitted::math::sqrt;
use whitted::{Exact, Quadric, Ray, Shape};

use crate::Method;

/// Distance to the nearest point of the clipped surface that the ray admits.
pub type QuadricMethod = Method<fn(&Ray, &Quadric) -> Option<f32>>;

/// All methods.
pub const METHODS: &[QuadricMethod] = &[
    Method::new("core", core),
    Method::new("plain", plain),
    Method::new("plain, stable q", plain_stable),
    Method::new("shift", shift),
    Method::new("shift twice", shift_twice),
    Method::new("f64", double),
];

/// The kernel of `whitted`: both shifts, and a last step at the root.
#[inline(never)]
pub fn core(ray: &Ray, quadric: &Quadric) -> Option<f32> {
    quadric.intersect::<Exact>(ray, &Quadric::setup(ray), None)
}

fn times(quadric: &Quadric, v: Vec3) -> Vec3 {
    let (s, p) = (quadric.squares, quadric.products);
    Vec3::new(
        s.x * v.x + p.z * v.y + p.y * v.z,
        p.z * v.x + s.y * v.y + p.x * v.z,
        p.y * v.x + p.x * v.y + s.z * v.z,
    )
}

/// Whether a point is inside of a closed one.
#[inline(always)]
pub(crate) fn contains(quadric: &Quadric, point: Vec3) -> bool {
    let (q, clip) = (point - quadric.center, &quadric.clip);
    let [.., value] = polynomial(quadric, q, Vec3::ZERO);
    let along = clip.axis.dot(q);
    value <= 0.0 && along >= clip.from && along <= clip.to
}

/// `a`, `b` and `c` from a point.
#[inline(always)]
fn polynomial(quadric: &Quadric, q: Vec3, direction: Vec3) -> [f32; 3] {
    let half_gradient = times(quadric, q) + quadric.linear;
    [
        times(quadric, direction).dot(direction),
        half_gradient.dot(direction),
        (half_gradient + quadric.linear).dot(q) + quadric.constant,
    ]
}

/// The nearest root in the clip.
#[inline(always)]
fn choose(ray: &Ray, quadric: &Quadric, shift: f32, roots: [f32; 2]) -> Option<f32> {
    let mut nearest = None;
    for root in roots {
        let t = shift + root;
        let q = ray.at(t) - quadric.center;
        let along = quadric.clip.axis.dot(q);
        let is_inside = q.cmpge(quadric.clip.min).all()
            && q.cmple(quadric.clip.max).all()
            && along >= quadric.clip.from
            && along <= quadric.clip.to;
        if is_inside && ray.admits(t) && nearest.is_none_or(|best| t < best) {
            nearest = Some(t);
        }
    }
    nearest
}

#[inline(always)]
fn stable([a, b, c]: [f32; 3]) -> Option<[f32; 2]> {
    let discriminant = b * b - a * c;
    if !(discriminant >= 0.0) {
        return None;
    }
    let q = -(b + sqrt(discriminant).copysign(b));
    Some([q / a, c / q])
}

/// The quadratic formula from the ray's origin.
#[inline(never)]
pub fn plain(ray: &Ray, quadric: &Quadric) -> Option<f32> {
    let [a, b, c] = polynomial(quadric, ray.origin - quadric.center, ray.direction);
    let discriminant = b * b - a * c;
    if !(discriminant >= 0.0) {
        return None;
    }
    let root = sqrt(discriminant);
    choose(ray, quadric, 0.0, [(-b - root) / a, (-b + root) / a])
}

/// The same with a stable q.
#[inline(never)]
pub fn plain_stable(ray: &Ray, quadric: &Quadric) -> Option<f32> {
    let roots = stable(polynomial(
        quadric,
        ray.origin - quadric.center,
        ray.direction,
    ))?;
    choose(ray, quadric, 0.0, roots)
}

/// From where the ray is closest to the center, as Wald shifts the sphere's.
#[inline(never)]
pub fn shift(ray: &Ray, quadric: &Quadric) -> Option<f32> {
    let to_center = quadric.center - ray.origin;
    let approach = to_center.dot(ray.direction);
    let q = ray.direction * approach - to_center;
    choose(
        ray,
        quadric,
        approach,
        stable(polynomial(quadric, q, ray.direction))?,
    )
}

/// And from there to where the polynomial is extreme, always.
#[inline(never)]
pub fn shift_twice(ray: &Ray, quadric: &Quadric) -> Option<f32> {
    let to_center = quadric.center - ray.origin;
    let approach = to_center.dot(ray.direction);
    let q = ray.direction * approach - to_center;
    let [a, b, _] = polynomial(quadric, q, ray.direction);
    let further = -b / a;
    let q = q + ray.direction * further;
    let roots = stable(polynomial(quadric, q, ray.direction))?;
    choose(ray, quadric, approach + further, roots)
}

/// In `f64`, from the ray's origin.
#[inline(never)]
pub fn double(ray: &Ray, quadric: &Quadric) -> Option<f32> {
    let dot = crate::sphere::dot;
    let wide = |v: Vec3| v.to_array().map(f64::from);
    let (squares, [yz, zx, xy]) = (wide(quadric.squares), wide(quadric.products));
    let times = |v: [f64; 3]| {
        [
            dot([squares[0], xy, zx], v),
            dot([xy, squares[1], yz], v),
            dot([zx, yz, squares[2]], v),
        ]
    };
    let (d, linear) = (wide(ray.direction), wide(quadric.linear));
    let q = crate::sphere::difference(ray.origin, quadric.center);
    let a = dot(times(d), d);
    let (sq, constant) = (times(q), f64::from(quadric.constant));
    let b = dot(sq, d) + dot(linear, d);
    let c = dot(sq, q) + 2.0 * dot(linear, q) + constant;
    let discriminant = b * b - a * c;
    if !(discriminant >= 0.0) {
        return None;
    }
    let sum = -(b + libm::sqrt(discriminant).copysign(b));
    let clip = &quadric.clip;
    let (min, max, axis) = (wide(clip.min), wide(clip.max), wide(clip.axis));
    let mut nearest = None;
    for root in [sum / a, c / sum] {
        let at = [0, 1, 2].map(|i| q[i] + d[i] * root);
        let along = dot(axis, at);
        let is_inside = (0..3).all(|i| at[i] >= min[i] && at[i] <= max[i])
            && along >= f64::from(clip.from)
            && along <= f64::from(clip.to);
        let t = root as f32;
        if is_inside && ray.admits(t) && nearest.is_none_or(|best| t < best) {
            nearest = Some(t);
        }
    }
    nearest
}
