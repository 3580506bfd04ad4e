//! Which color of a checker a point of a surface has.
//!
//! A surface may lie in the boundary between two layers of cells, where rounding puts its points on either
//! side: it then shows specks of both.

use glam::Vec3;
use libm::floorf;
use whitted::Checker;
use whitted::pattern::{Spot, Varying};

use crate::Method;

/// The color of a spot.
pub type CheckerMethod = Method<fn(&Checker, &Spot) -> Vec3>;

/// All methods.
pub const METHODS: &[CheckerMethod] = &[
    Method::new("core", core),
    Method::new("floor", floor),
    Method::new("truncated", truncated),
    Method::new("floor, + 1e-4", plus_epsilon),
    Method::new("floor, 1e-4 beneath", beneath),
];

/// The way of `whitted`: a share of a cell beneath the surface.
#[inline(never)]
pub fn core(checker: &Checker, spot: &Spot) -> Vec3 {
    checker.at(spot)
}

#[inline(always)]
fn parity(checker: &Checker, point: Vec3) -> Vec3 {
    let cells = (point / checker.size).to_array().map(|x| floorf(x) as i32);
    checker.colors[((cells[0] ^ cells[1] ^ cells[2]) & 1) as usize]
}

/// As it is written down.
#[inline(never)]
pub fn floor(checker: &Checker, spot: &Spot) -> Vec3 {
    parity(checker, spot.point)
}

/// The cast for the floor: the cells round the origin are twice as wide.
#[inline(never)]
pub fn truncated(checker: &Checker, spot: &Spot) -> Vec3 {
    let cells = (spot.point / checker.size).to_array().map(|x| x as i32);
    checker.colors[((cells[0] ^ cells[1] ^ cells[2]) & 1) as usize]
}

/// A small length is added to each coordinate.
#[inline(never)]
pub fn plus_epsilon(checker: &Checker, spot: &Spot) -> Vec3 {
    parity(checker, spot.point + Vec3::splat(1e-4))
}

/// A small length beneath the surface.
#[inline(never)]
pub fn beneath(checker: &Checker, spot: &Spot) -> Vec3 {
    parity(checker, spot.point - spot.outward * 1e-4)
}
