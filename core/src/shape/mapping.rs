//! Coordinates on surfaces.

use core::f32::consts::PI;

use glam::Vec3;

use crate::math::{dot, length_squared, sqrt};

/// Two unit vectors along a plane: to the right and upwards for who looks at its outward side. The first is
/// level, that is, without y. Of a floor, on which nothing is upwards, the second leads along -z.
#[inline]
pub(super) fn tangents(normal: Vec3) -> (Vec3, Vec3) {
    let level = Vec3::new(normal.z, 0.0, -normal.x);
    let square = length_squared(&level);
    let right = if square > 0.0 {
        level * (1.0 / sqrt(square))
    } else {
        Vec3::X
    };
    (right, normal.cross(right))
}

/// Of a point in the plane through another.
#[inline]
pub(super) fn flat(from_point: Vec3, normal: Vec3) -> (f32, f32) {
    let (right, up) = tangents(normal);
    (dot(&from_point, &right), dot(&from_point, &up))
}

/// The angle round an axis as a share of a full turn, from 0 to 1, and how far from the axis that is. It
/// grows to the right for who looks from outside, the axis upwards; 1/2 is opposite of where the second of
/// the axis's [`tangents`] leads: towards +z if the axis is y.
#[inline]
pub(super) fn around(from_axis: Vec3, axis: Vec3) -> (f32, f32) {
    let (right, back) = tangents(axis);
    let (x, z) = (dot(&from_axis, &right), -dot(&from_axis, &back));
    (turn(x, z), sqrt(x * x + z * z))
}

/// The angle between (0, 1) and (`x`, `y`) as a share of a full turn, plus 1/2.
#[inline]
pub(super) fn turn(x: f32, y: f32) -> f32 {
    0.5 + libm::atan2f(x, y) * (0.5 / PI)
}

/// How much of the second and of the third vertex is in a point of a triangle.
#[inline]
pub(super) fn barycentric(vertices: &[Vec3; 3], point: Vec3) -> (f32, f32) {
    let [a, b, c] = vertices;
    let (along, across, from) = (*b - *a, *c - *a, point - *a);
    let normal = along.cross(across);
    let recip = 1.0 / length_squared(&normal);
    (
        dot(&from.cross(across), &normal) * recip,
        dot(&along.cross(from), &normal) * recip,
    )
}
