//! Blocks of spheres.

use fearless_simd::{Select, Simd, SimdMask};
use whitted::Sphere;

use super::lanes::{Lanes, Meeting, Vectors, nothing};
use super::rays::RayTerms;

/// `N` spheres that are all visible from outside, or all from inside only.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct Spheres<const N: usize> {
    center: [[f32; N]; 3],
    /// Minus infinity where there is no sphere, or one without a surface: that is never met.
    radius_squared: [f32; N],
}

impl<const N: usize> Spheres<N> {
    pub fn new(spheres: impl Iterator<Item = Sphere>) -> Self {
        let mut block = Self {
            center: [[0.0; N]; 3],
            radius_squared: [f32::NEG_INFINITY; N],
        };
        for (lane, sphere) in spheres.enumerate() {
            for (row, x) in block.center.iter_mut().zip(sphere.center.to_array()) {
                row[lane] = x;
            }
            let square = sphere.radius * sphere.radius;
            if square > 0.0 {
                block.radius_squared[lane] = square;
            }
        }
        block
    }

    /// As `Sphere::intersect`, for points before `limit`.
    #[inline(always)]
    pub fn meet<S: Simd, V: Lanes<S>, const HOLLOW: bool>(
        &self,
        simd: S,
        terms: &RayTerms<'_>,
        limit: f32,
    ) -> Meeting<V, V::Mask> {
        meet::<S, V, HOLLOW>(
            simd,
            Vectors::load(simd, &self.center),
            V::from_slice(simd, &self.radius_squared),
            Vectors::splat(simd, terms.ray.origin),
            Vectors::splat(simd, terms.ray.direction),
            V::simd_from(simd, limit),
        )
    }
}

/// Where rays that start on a sphere are at its other side, as `Sphere::intersect` says; behind the start of
/// those that go outwards.
#[inline(always)]
pub fn across<S: Simd, V: Lanes<S>>(
    simd: S,
    center: Vectors<V>,
    origin: Vectors<V>,
    direction: Vectors<V>,
) -> V {
    (center - origin).dot(direction) * V::simd_from(simd, 2.0)
}

/// As `Sphere::intersect`, a sphere and a ray a lane.
#[inline(always)]
pub fn meet<S: Simd, V: Lanes<S>, const HOLLOW: bool>(
    simd: S,
    center: Vectors<V>,
    radius_squared: V,
    origin: Vectors<V>,
    direction: Vectors<V>,
    limit: V,
) -> Meeting<V, V::Mask> {
    let to_center = center - origin;
    let approach = to_center.dot(direction);
    let distance_squared = to_center.dot(to_center);
    // As the kernel, what surely misses goes first.
    const CERTAIN: f32 = 1.0 - 1.0 / (1_u32 << 18) as f32;
    let least = distance_squared * V::simd_from(simd, CERTAIN) - radius_squared;
    if (approach * approach).simd_lt(least).all_true() {
        return nothing(simd);
    }
    let zero = V::simd_from(simd, 0.0);
    let miss = direction * approach - to_center;
    let along = miss.dot(direction);
    let half_chord_squared = radius_squared - miss.dot(miss) + along * along;
    let met = half_chord_squared.simd_ge(zero);
    let half_chord = half_chord_squared.sqrt();
    let exit = approach + (half_chord - along);
    // Rounding is monotonic: the exit is never before the entry.
    let t = if HOLLOW {
        exit
    } else {
        let entry = approach - (half_chord + along);
        entry.simd_gt(zero).select(entry, exit)
    };
    Meeting {
        t,
        met: met & t.simd_gt(zero) & t.simd_lt(limit),
    }
}
