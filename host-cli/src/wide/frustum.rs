//! Blocks of open cylinders and cones.

use fearless_simd::{Select, Simd, SimdMask};
use whitted::Frustum;

use super::across::Terms;
use super::lanes::{Lanes, Meeting, Vectors, mask_of, nothing};
use super::rays::RayTerms;

/// `N` frusta that are all visible from outside, or all from inside only.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct Frusta<const N: usize> {
    base: [[f32; N]; 3],
    axis: [[f32; N]; 3],
    /// Not a number where there is no frustum: that is never met.
    length: [f32; N],
    base_radius: [f32; N],
    slope: [f32; N],
}

impl<const N: usize> Frusta<N> {
    pub fn new(frusta: impl Iterator<Item = Frustum>) -> Self {
        let mut block = Self {
            base: [[0.0; N]; 3],
            axis: [[0.0; N]; 3],
            length: [f32::NAN; N],
            base_radius: [0.0; N],
            slope: [0.0; N],
        };
        for (lane, frustum) in frusta.enumerate() {
            for i in 0..3 {
                block.base[i][lane] = frustum.base[i];
                block.axis[i][lane] = frustum.axis[i];
            }
            block.length[lane] = frustum.length;
            block.base_radius[lane] = frustum.base_radius;
            block.slope[lane] = frustum.slope;
        }
        block
    }

    /// As `Frustum::intersect`, for points before `limit`.
    #[inline(always)]
    pub fn meet<S: Simd, V: Lanes<S>, const HOLLOW: bool>(
        &self,
        simd: S,
        terms: &RayTerms<'_>,
        limit: f32,
    ) -> Meeting<V, V::Mask> {
        let frustum = Spread {
            base: Vectors::load(simd, &self.base),
            axis: Vectors::load(simd, &self.axis),
            length: V::from_slice(simd, &self.length),
            base_radius: V::from_slice(simd, &self.base_radius),
            slope: V::from_slice(simd, &self.slope),
        };
        let origin = Vectors::splat(simd, terms.ray.origin);
        let direction = Vectors::splat(simd, terms.ray.direction);
        let limit = V::simd_from(simd, limit);
        meet::<S, V, HOLLOW>(simd, &frustum, origin, direction, limit)
    }
}

/// The same frustum, and a ray a lane.
#[inline(always)]
pub fn meet_rays<S: Simd, V: Lanes<S>>(
    simd: S,
    shape: &Frustum,
    terms: &Terms<V, V::Mask>,
    limit: V,
) -> Meeting<V, V::Mask> {
    let frustum = Spread {
        base: Vectors::splat(simd, shape.base),
        axis: Vectors::splat(simd, shape.axis),
        length: V::simd_from(simd, shape.length),
        base_radius: V::simd_from(simd, shape.base_radius),
        slope: V::simd_from(simd, shape.slope),
    };
    if shows_outside(shape) {
        meet::<S, V, false>(simd, &frustum, terms.origin, terms.direction, limit)
    } else {
        meet::<S, V, true>(simd, &frustum, terms.origin, terms.direction, limit)
    }
}

/// As the kernel asks it.
pub fn shows_outside(shape: &Frustum) -> bool {
    shape.base_radius + shape.slope * (0.5 * shape.length) > 0.0
}

/// As `Frustum::normal`, of a frustum and a point on it a lane.
#[inline(always)]
pub fn normals<S: Simd, V: Lanes<S>>(
    simd: S,
    point: Vectors<V>,
    base: Vectors<V>,
    axis: Vectors<V>,
    slope: V,
    hollow: V::Mask,
) -> Vectors<V> {
    let (zero, one) = (V::simd_from(simd, 0.0), V::simd_from(simd, 1.0));
    let from_base = point - base;
    let along = from_base.dot(axis);
    let across = from_base - axis * along;
    let square = across.dot(across);
    let across = across * (one / square.sqrt());
    let tilted = mask_of(hollow, -across, across) - axis * slope;
    let unit = tilted * (one / tilted.dot(tilted).sqrt());
    let at_tip = mask_of(slope.simd_gt(zero), -axis, axis);
    mask_of(square.simd_gt(zero), unit, at_tip)
}

/// A frustum a lane.
struct Spread<V> {
    base: Vectors<V>,
    axis: Vectors<V>,
    length: V,
    base_radius: V,
    slope: V,
}

/// As `Frustum::intersect`, a frustum and a ray a lane.
#[inline(always)]
fn meet<S: Simd, V: Lanes<S>, const HOLLOW: bool>(
    simd: S,
    frustum: &Spread<V>,
    origin: Vectors<V>,
    direction: Vectors<V>,
    limit: V,
) -> Meeting<V, V::Mask> {
    let zero = V::simd_from(simd, 0.0);
    let (axis, slope) = (frustum.axis, frustum.slope);
    let to_base = frustum.base - origin;
    let approach = to_base.dot(direction);
    let from_base = direction * approach - to_base;
    let along = from_base.dot(axis);
    let across = from_base - axis * along;
    let radius = frustum.base_radius + slope * along;
    let along_rate = direction.dot(axis);
    let across_rate = direction - axis * along_rate;
    let radius_rate = slope * along_rate;
    let growth = across_rate * radius - across * radius_rate;
    let twist = across.cross(across_rate);
    let discriminant = growth.dot(growth) - twist.dot(twist);
    let real = discriminant.simd_ge(zero);
    if !real.any_true() {
        return nothing(simd);
    }
    let a = across_rate.dot(across_rate) - radius_rate * radius_rate;
    let b = across.dot(across_rate) - radius * radius_rate;
    let c = across.dot(across) - radius * radius;
    let root = discriminant.sqrt();
    let outgoing = b.simd_gt(zero);
    let q = outgoing.select(-b - root, root - b);
    let (far, near) = (q / a, c / q);
    let (entry, exit) = (outgoing.select(far, near), outgoing.select(near, far));
    let length = frustum.length;
    let at = along + exit * along_rate;
    let exit = approach + exit;
    let between_ends = real & at.simd_ge(zero) & at.simd_le(length);
    let exits = between_ends & exit.simd_gt(zero) & exit.simd_lt(limit);
    if HOLLOW {
        return Meeting {
            t: exit,
            met: exits,
        };
    }
    let at = along + entry * along_rate;
    let entry = approach + entry;
    let between_ends = real & at.simd_ge(zero) & at.simd_le(length);
    let enters = between_ends & entry.simd_gt(zero) & entry.simd_lt(limit);
    let exits_first = exits & (!enters | exit.simd_lt(entry));
    Meeting {
        t: exits_first.select(exit, entry),
        met: enters | exits,
    }
}
