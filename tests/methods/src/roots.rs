//! Square roots, their reciprocals, and unit vectors.

use glam::Vec3;
use micromath::F32Ext;
use whitted::{Exact, Math};

use crate::Method;

/// A function of one number.
pub type ScalarMethod = Method<fn(f32) -> f32>;
/// A function of a vector.
pub type VectorMethod = Method<fn(Vec3) -> Vec3>;

/// Square roots.
pub const SQRT: &[ScalarMethod] = &[
    Method::new("core", sqrt_core),
    Method::new("libm", sqrt_libm),
    Method::new("bit trick, 2 Newton", sqrt_bit_trick),
    Method::new("micromath", sqrt_micromath),
];

/// Reciprocals of square roots.
pub const RSQRT: &[ScalarMethod] = &[
    Method::new("core", rsqrt_core),
    Method::new("libm", rsqrt_libm),
    Method::new("bit trick, 1 Newton", rsqrt_bit_trick_1),
    Method::new("bit trick, 2 Newton", rsqrt_bit_trick_2),
    Method::new("bit trick, tuned", rsqrt_tuned),
    Method::new("micromath", rsqrt_micromath),
];

/// Unit vectors.
pub const NORMALIZE: &[VectorMethod] = &[
    Method::new("core", normalize_core),
    Method::new("3 divisions", normalize_three_divisions),
    Method::new("libm root", normalize_libm),
    Method::new("bit trick, 2 Newton", normalize_bit_trick),
    Method::new("bit trick, tuned", normalize_tuned),
    Method::new("micromath", normalize_micromath),
    Method::new("scaled by 2^k", normalize_scaled),
];

/// As `whitted` does: the instruction where there is one.
#[inline(never)]
pub fn sqrt_core(x: f32) -> f32 {
    Exact::sqrt(x)
}

/// In software on 32-bit Arm.
#[inline(never)]
pub fn sqrt_libm(x: f32) -> f32 {
    libm::sqrtf(x)
}

/// `x` times the approximate reciprocal root.
#[inline(never)]
pub fn sqrt_bit_trick(x: f32) -> f32 {
    if x == 0.0 {
        0.0
    } else {
        x * bit_trick(bit_trick_start(x), x, 2)
    }
}

/// micromath's approximation.
#[inline(never)]
pub fn sqrt_micromath(x: f32) -> f32 {
    F32Ext::sqrt(x)
}

/// As `whitted` does: root and division.
#[inline(never)]
pub fn rsqrt_core(x: f32) -> f32 {
    Exact::sqrt_and_recip(x).1
}

/// Root and division, the root in software on 32-bit Arm.
#[inline(never)]
pub fn rsqrt_libm(x: f32) -> f32 {
    1.0 / libm::sqrtf(x)
}

/// Half the exponent, negated, by integer arithmetic: C. Lomont, "Fast Inverse Square Root" (2003).
#[inline(always)]
fn bit_trick_start(x: f32) -> f32 {
    f32::from_bits(0x5f37_5a86_u32.wrapping_sub(x.to_bits() >> 1))
}

#[inline(always)]
fn bit_trick(mut y: f32, x: f32, steps: u32) -> f32 {
    for _ in 0..steps {
        y *= 1.5 - 0.5 * x * y * y;
    }
    y
}

/// The bit trick with one step of Newton's method.
#[inline(never)]
pub fn rsqrt_bit_trick_1(x: f32) -> f32 {
    bit_trick(bit_trick_start(x), x, 1)
}

/// With two.
#[inline(never)]
pub fn rsqrt_bit_trick_2(x: f32) -> f32 {
    bit_trick(bit_trick_start(x), x, 2)
}

/// Constants of the first step chosen for the least error after it, J. Kadlec (2010), then one of
/// Newton's.
#[inline(always)]
fn tuned(x: f32) -> f32 {
    let y = f32::from_bits(0x5f1f_fff9_u32.wrapping_sub(x.to_bits() >> 1));
    let y = y * (0.703_952_25 * (2.389_244_6 - x * y * y));
    bit_trick(y, x, 1)
}

/// The tuned first step and one of Newton's.
#[inline(never)]
pub fn rsqrt_tuned(x: f32) -> f32 {
    tuned(x)
}

/// micromath's approximation.
#[inline(never)]
pub fn rsqrt_micromath(x: f32) -> f32 {
    F32Ext::invsqrt(x)
}

/// As `whitted` does: root, one division, three products.
#[inline(never)]
pub fn normalize_core(v: Vec3) -> Vec3 {
    Exact::normalize(v)
}

/// Root and three divisions.
#[inline(never)]
pub fn normalize_three_divisions(v: Vec3) -> Vec3 {
    v / Exact::sqrt(v.dot(v))
}

/// As `whitted`, the root in software on 32-bit Arm.
#[inline(never)]
pub fn normalize_libm(v: Vec3) -> Vec3 {
    v * (1.0 / libm::sqrtf(v.dot(v)))
}

/// By the bit trick.
#[inline(never)]
pub fn normalize_bit_trick(v: Vec3) -> Vec3 {
    let square = v.dot(v);
    v * bit_trick(bit_trick_start(square), square, 2)
}

/// By the tuned bit trick.
#[inline(never)]
pub fn normalize_tuned(v: Vec3) -> Vec3 {
    v * tuned(v.dot(v))
}

/// By micromath's reciprocal root.
#[inline(never)]
pub fn normalize_micromath(v: Vec3) -> Vec3 {
    v * F32Ext::invsqrt(v.dot(v))
}

/// First scaled by the power of two that brings the largest component to 1…2: for any length.
#[inline(never)]
pub fn normalize_scaled(v: Vec3) -> Vec3 {
    let size = v.abs();
    let xy = if size.x > size.y { size.x } else { size.y };
    let largest = if xy > size.z { xy } else { size.z };
    // Two steps: the reciprocal of the smallest exponents is no number, nor is 2^-126 of the largest.
    let exponent = (largest.to_bits() >> 23).clamp(1, 253);
    let v = v * f32::from_bits((254 - exponent) << 23);
    let v = if largest < f32::MIN_POSITIVE {
        v * 8_388_608.0
    } else {
        v
    };
    v * (1.0 / Exact::sqrt(v.dot(v)))
}
