//! Ray and triangle: what of the polygon's methods becomes simpler, or was made, for three corners.

use glam::Vec3;
use whitted::{Exact, Ray, Shape, Triangle};

use crate::Method;
use crate::polygon::{self, Axis, Setup, Shear, permute};

/// Distance to the triangle if the ray admits it.
pub type TriangleMethod = Method<fn(&Ray, &Setup, &Triangle) -> Option<f32>>;

/// All methods.
pub const METHODS: &[TriangleMethod] = &[
    Method::new("core", core),
    Method::new("Moeller-Trumbore", moller_trumbore),
    Method::new("Woop", woop),
    Method::new("sheared crossings", sheared),
    Method::new("sheared, lazy", sheared_lazy),
];

/// Whether a method also finds its distance from the vertices, and not from the stored normal.
pub fn ignores_normal(name: &str) -> bool {
    ["Moeller-Trumbore", "Woop"].contains(&name)
}

/// The kernel of `whitted`.
#[inline(never)]
pub fn core(ray: &Ray, setup: &Setup, triangle: &Triangle) -> Option<f32> {
    triangle.intersect::<Exact>(ray, &setup.core, None)
}

#[inline(always)]
fn plane(ray: &Ray, triangle: &Triangle) -> Option<f32> {
    polygon::plane(ray, triangle.vertices[0], triangle.normal)
}

/// As for a fan of one.
#[inline(never)]
pub fn moller_trumbore(ray: &Ray, _: &Setup, triangle: &Triangle) -> Option<f32> {
    polygon::moller_trumbore(ray, triangle.vertices, 0.0)
}

/// As for a fan of one.
#[inline(never)]
pub fn woop(ray: &Ray, setup: &Setup, triangle: &Triangle) -> Option<f32> {
    let [a, b, c] = triangle
        .vertices
        .map(|v| polygon::place(ray, &setup.shear, v));
    polygon::woop(ray, &setup.shear, [a, b, c])
}

/// The crossings of all edges.
#[inline(never)]
pub fn sheared(ray: &Ray, setup: &Setup, triangle: &Triangle) -> Option<f32> {
    let [a, b, c] = triangle.vertices.map(|v| {
        let v = polygon::place(ray, &setup.shear, v);
        (v.x, v.y)
    });
    let inside = polygon::crosses(a, b) ^ polygon::crosses(b, c) ^ polygon::crosses(c, a);
    if inside { plane(ray, triangle) } else { None }
}

/// The same, an axis at a time: nothing more is computed where all corners are on one side of the scan
/// line; else two edges cross it, those that meet in the corner that is alone on its side.
#[inline(never)]
pub fn sheared_lazy(ray: &Ray, setup: &Setup, triangle: &Triangle) -> Option<f32> {
    let shear = &setup.shear;
    let inside = match shear.axis {
        Axis::X => surrounds(ray, shear, triangle, |v| permute(Axis::X, v)),
        Axis::Y => surrounds(ray, shear, triangle, |v| permute(Axis::Y, v)),
        Axis::Z => surrounds(ray, shear, triangle, |v| permute(Axis::Z, v)),
    };
    if inside { plane(ray, triangle) } else { None }
}

#[inline(always)]
fn surrounds(
    ray: &Ray,
    shear: &Shear,
    triangle: &Triangle,
    permute: impl Fn(Vec3) -> Vec3,
) -> bool {
    let origin = permute(ray.origin);
    let [a, b, c] = triangle.vertices.map(|v| permute(v) - origin);
    let y = |v: Vec3| v.y - shear.y * v.z;
    let x = |v: Vec3| v.x - shear.x * v.z;
    let (a_y, b_y, c_y) = (y(a), y(b), y(c));
    let differ = |p: f32, q: f32| ((p.to_bits() ^ q.to_bits()) as i32) < 0;
    let (alone, first, second) = match (differ(a_y, b_y), differ(b_y, c_y)) {
        (false, false) => return false,
        (true, true) => ((b, b_y), (a, a_y), (c, c_y)),
        (true, false) => ((a, a_y), (b, b_y), (c, c_y)),
        (false, true) => ((c, c_y), (a, a_y), (b, b_y)),
    };
    let (alone_x, first_x, second_x) = (x(alone.0), x(first.0), x(second.0));
    // Looked at from the lower end: both owners of an edge compare the same products alike.
    let right = |(p_x, p_y): (f32, f32), (q_x, q_y): (f32, f32)| {
        let (from_p, from_q) = (p_x * q_y, q_x * p_y);
        if p_y < 0.0 {
            from_p > from_q
        } else {
            from_q > from_p
        }
    };
    let alone = (alone_x, alone.1);
    right(alone, (first_x, first.1)) != right(alone, (second_x, second.1))
}
