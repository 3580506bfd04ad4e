//! Vectors of numbers: one lane an object, or one lane a ray.
//!
//! Every lane does what `whitted`'s scalar kernels do, in their order: nothing is fused or
//! reassociated, so that the bits are the same at every SIMD level.

use core::ops::{Add, Mul, Neg, Sub};

use fearless_simd::{Select, Simd, SimdFloat, SimdMask};
use glam::Vec3;

/// A vector of `f32` at some SIMD level.
pub trait Lanes<S: Simd>: SimdFloat<S, Element = f32> {
    /// In each lane the number of another one, by the places of whose bytes each is given.
    #[inline(always)]
    fn pick(self, places: Self) -> Self {
        self.swizzle_dyn(places.to_bytes())
    }
}

impl<S: Simd, V: SimdFloat<S, Element = f32>> Lanes<S> for V {}

/// A point or direction a lane.
#[derive(Clone, Copy)]
pub struct Vectors<V> {
    pub x: V,
    pub y: V,
    pub z: V,
}

impl<V> Vectors<V> {
    /// The same in every lane.
    #[inline(always)]
    pub fn splat<S: Simd>(simd: S, v: Vec3) -> Self
    where
        V: Lanes<S>,
    {
        Self {
            x: V::simd_from(simd, v.x),
            y: V::simd_from(simd, v.y),
            z: V::simd_from(simd, v.z),
        }
    }

    /// One lane an object, from a row a coordinate.
    #[inline(always)]
    pub fn load<S: Simd, const N: usize>(simd: S, rows: &[[f32; N]; 3]) -> Self
    where
        V: Lanes<S>,
    {
        Self {
            x: V::from_slice(simd, &rows[0]),
            y: V::from_slice(simd, &rows[1]),
            z: V::from_slice(simd, &rows[2]),
        }
    }

    /// As [`Lanes::pick`], of each coordinate.
    #[inline(always)]
    pub fn pick<S: Simd>(self, places: V) -> Self
    where
        V: Lanes<S>,
    {
        Self {
            x: self.x.pick(places),
            y: self.y.pick(places),
            z: self.z.pick(places),
        }
    }

    /// Summed as glam's `Vec3::dot` does.
    #[inline(always)]
    pub fn dot<S: Simd>(self, other: Self) -> V
    where
        V: Lanes<S>,
    {
        (self.x * other.x + self.y * other.y) + self.z * other.z
    }

    /// As glam's `Vec3::cross`.
    #[inline(always)]
    pub fn cross<S: Simd>(self, other: Self) -> Self
    where
        V: Lanes<S>,
    {
        Self {
            x: self.y * other.z - other.y * self.z,
            y: self.z * other.x - other.z * self.x,
            z: self.x * other.y - other.x * self.y,
        }
    }
}

/// `set` where `mask` is set, else `unset`.
#[inline(always)]
pub fn mask_of<S: Simd, V: Lanes<S>>(
    mask: V::Mask,
    set: Vectors<V>,
    unset: Vectors<V>,
) -> Vectors<V> {
    Vectors {
        x: mask.select(set.x, unset.x),
        y: mask.select(set.y, unset.y),
        z: mask.select(set.z, unset.z),
    }
}

/// As `rays::fastest`: which directions go fastest along the first axis, and which along the second.
#[inline(always)]
pub fn fastest_of_each<S: Simd, V: Lanes<S>>(direction: Vectors<V>) -> [V::Mask; 2] {
    let (x, y, z) = (direction.x.abs(), direction.y.abs(), direction.z.abs());
    let along_x = x.simd_gt(y) & x.simd_gt(z);
    [along_x, !along_x & y.simd_gt(z)]
}

impl<V: Add<Output = V>> Add for Vectors<V> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            x: self.x + other.x,
            y: self.y + other.y,
            z: self.z + other.z,
        }
    }
}

impl<V: Mul<Output = V>> Mul for Vectors<V> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self {
            x: self.x * other.x,
            y: self.y * other.y,
            z: self.z * other.z,
        }
    }
}

impl<V: Sub<Output = V>> Sub for Vectors<V> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self {
            x: self.x - other.x,
            y: self.y - other.y,
            z: self.z - other.z,
        }
    }
}

impl<V: Copy + Mul<Output = V>> Mul<V> for Vectors<V> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: V) -> Self {
        Self {
            x: self.x * factor,
            y: self.y * factor,
            z: self.z * factor,
        }
    }
}

impl<V: Neg<Output = V>> Neg for Vectors<V> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            x: -self.x,
            y: -self.y,
            z: -self.z,
        }
    }
}

/// What the lanes of a block say about a ray.
#[derive(Clone, Copy)]
pub struct Meeting<V, M> {
    /// Distance to the nearest point that the ray admits, where `met`.
    pub t: V,
    /// Whether there is one.
    pub met: M,
}

/// Nothing is met in any lane.
#[inline(always)]
pub fn nothing<S: Simd, V: Lanes<S>>(simd: S) -> Meeting<V, V::Mask> {
    Meeting {
        t: V::simd_from(simd, 0.0),
        met: V::Mask::splat(simd, false),
    }
}
