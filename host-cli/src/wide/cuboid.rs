//! Blocks of boxes.

use fearless_simd::{Select, Simd, SimdMask};
use whitted::Cuboid;

use super::lanes::{Lanes, Meeting, nothing};
use super::rays::{RayLanes, Way};

/// `N` axis-aligned boxes.
#[derive(Clone, Debug)]
#[repr(C, align(32))]
pub struct Cuboids<const N: usize> {
    /// For each axis the lower and the upper bounds.
    bounds: [[[f32; N]; 2]; 3],
}

impl<const N: usize> Cuboids<N> {
    pub fn new(cuboids: impl Iterator<Item = Cuboid>) -> Self {
        // What has no extent is never met.
        let mut bounds = [[[f32::NAN; N]; 2]; 3];
        for (lane, cuboid) in cuboids.enumerate() {
            for (axis, rows) in bounds.iter_mut().enumerate() {
                rows[0][lane] = cuboid.min[axis];
                rows[1][lane] = cuboid.max[axis];
            }
        }
        Self { bounds }
    }

    /// As `Cuboid::intersect`, for points up to `limit`. No reciprocal of the ray may be infinite
    /// unless the ray goes across its axis.
    #[inline(always)]
    pub fn meet<S: Simd, V: Lanes<S>>(
        &self,
        simd: S,
        ray: &RayLanes<V>,
        limit: V,
    ) -> Meeting<V, V::Mask> {
        let zero = V::simd_from(simd, 0.0);
        let mut entry = V::simd_from(simd, f32::NEG_INFINITY);
        let mut exit = V::simd_from(simd, f32::INFINITY);
        let mut between = V::Mask::splat(simd, true);
        for (slab, [min, max]) in ray.slabs.iter().zip(&self.bounds) {
            let to_min = V::from_slice(simd, min) - slab.origin;
            let to_max = V::from_slice(simd, max) - slab.origin;
            let (near, far) = match slab.way {
                Way::Up => (to_min, to_max),
                Way::Down => (to_max, to_min),
                Way::Across => {
                    between &= to_min.simd_le(zero) & to_max.simd_ge(zero);
                    continue;
                }
            };
            let (near, far) = (near * slab.reciprocal, far * slab.reciprocal);
            entry = near.simd_gt(entry).select(near, entry);
            exit = far.simd_lt(exit).select(far, exit);
        }
        let met = between & entry.simd_le(exit);
        if !met.any_true() {
            return nothing(simd);
        }
        let t = entry.simd_gt(zero).select(entry, exit);
        Meeting {
            t,
            met: met & t.simd_gt(zero) & t.simd_le(limit),
        }
    }
}
