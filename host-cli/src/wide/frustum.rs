//! Blocks of open cylinders and cones.

use fearless_simd::{Select, Simd, SimdMask};
use whitted::Frustum;

use super::lanes::{Lanes, Meeting, Vectors, nothing};
use super::rays::RayTerms;

/// `N` frusta that are all visible from outside, or all from inside only.
#[derive(Clone, Debug)]
#[repr(C, align(32))]
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
        let (zero, limit) = (V::simd_from(simd, 0.0), V::simd_from(simd, limit));
        let origin = Vectors::splat(simd, terms.ray.origin);
        let direction = Vectors::splat(simd, terms.ray.direction);
        let axis = Vectors::<V>::load(simd, &self.axis);
        let slope = V::from_slice(simd, &self.slope);
        let to_base = Vectors::load(simd, &self.base) - origin;
        let approach = to_base.dot(direction);
        let from_base = direction * approach - to_base;
        let along = from_base.dot(axis);
        let across = from_base - axis * along;
        let radius = V::from_slice(simd, &self.base_radius) + slope * along;
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
        let length = V::from_slice(simd, &self.length);
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
}
