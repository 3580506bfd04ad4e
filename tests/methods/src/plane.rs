//! Ray and plane.

use whitted::{Exact, Plane, Ray, Shape};

use crate::Method;
use crate::compensated::Pair3;
use crate::sphere::{difference, dot};

/// A plane both ways.
#[derive(Clone, Copy, Debug)]
pub struct PlaneForms {
    /// By a point and the normal.
    pub plane: Plane,
    /// `-normal · point`, rounded once: what the implicit form stores in place of the point.
    pub offset: f32,
}

/// Distance to the plane if the ray admits it.
pub type PlaneMethod = Method<fn(&Ray, &PlaneForms) -> Option<f32>>;

/// All methods.
pub const METHODS: &[PlaneMethod] = &[
    Method::new("core", core),
    Method::new("implicit", implicit),
    Method::new("point", point),
    Method::new("point, |n.d| > 1e-6", point_epsilon),
    Method::new("compensated", compensated),
    Method::new("f64", double),
];

impl PlaneForms {
    /// Both forms of a plane.
    pub fn new(plane: Plane) -> Self {
        let zero = [0.0; 3].into();
        let exact = dot(
            difference(plane.normal, zero),
            difference(plane.point, zero),
        );
        Self {
            plane,
            offset: -exact as f32,
        }
    }
}

/// The kernel of `whitted`.
#[inline(never)]
pub fn core(ray: &Ray, plane: &PlaneForms) -> Option<f32> {
    plane.plane.intersect::<Exact>(ray, &(), None)
}

/// `n·x + k = 0`.
#[inline(never)]
pub fn implicit(ray: &Ray, plane: &PlaneForms) -> Option<f32> {
    let normal = plane.plane.normal;
    let rate = normal.dot(ray.direction);
    if rate == 0.0 {
        return None;
    }
    ray.admitted(-(normal.dot(ray.origin) + plane.offset) / rate)
}

/// `n·(x - p) = 0`.
#[inline(never)]
pub fn point(ray: &Ray, plane: &PlaneForms) -> Option<f32> {
    let normal = plane.plane.normal;
    let rate = normal.dot(ray.direction);
    if rate == 0.0 {
        return None;
    }
    ray.admitted(normal.dot(plane.plane.point - ray.origin) / rate)
}

/// The same, small angles counted as parallel, as many tutorials have it.
#[inline(never)]
pub fn point_epsilon(ray: &Ray, plane: &PlaneForms) -> Option<f32> {
    let normal = plane.plane.normal;
    let rate = normal.dot(ray.direction);
    if rate.abs() < 1e-6 {
        return None;
    }
    ray.admitted(normal.dot(plane.plane.point - ray.origin) / rate)
}

/// Both dot products in pairs of `f32`.
#[inline(never)]
pub fn compensated(ray: &Ray, plane: &PlaneForms) -> Option<f32> {
    let normal = Pair3::new(plane.plane.normal);
    let rate = normal.dot(Pair3::new(ray.direction));
    if rate.value() == 0.0 {
        return None;
    }
    let to_plane = Pair3::difference(plane.plane.point, ray.origin);
    ray.admitted(normal.dot(to_plane).over(rate))
}

/// The point form in `f64`.
#[inline(never)]
pub fn double(ray: &Ray, plane: &PlaneForms) -> Option<f32> {
    let normal = plane.plane.normal.to_array().map(f64::from);
    let rate = dot(normal, ray.direction.to_array().map(f64::from));
    if rate == 0.0 {
        return None;
    }
    let to_plane = difference(plane.plane.point, ray.origin);
    ray.admitted((dot(normal, to_plane) / rate) as f32)
}
