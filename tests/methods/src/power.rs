//! The power of Phong's highlight, for a base from 0 to 1.

use micromath::F32Ext;
use whitted::{Exact, Math};

use crate::Method;

/// `x` to the power of `n`.
pub type PowerMethod = Method<fn(f32, f32) -> f32>;

/// For whole exponents.
pub const WHOLE: &[PowerMethod] = &[
    Method::new("core", squaring),
    Method::new("libm powf", libm_powf),
    Method::new("Schlick", schlick),
    Method::new("micromath", micromath),
];

/// For real exponents.
pub const REAL: &[PowerMethod] = &[
    Method::new("core", log_exp),
    Method::new("libm powf", libm_powf),
    Method::new("Schlick", schlick),
    Method::new("micromath", micromath),
];

/// Repeated squaring, as `whitted` does for whole exponents.
#[inline(never)]
pub fn squaring(x: f32, n: f32) -> f32 {
    Exact::powi(x, n as u32)
}

/// As `whitted` does for real exponents.
#[inline(never)]
pub fn log_exp(x: f32, n: f32) -> f32 {
    Exact::powf(x, n)
}

/// The C library's, correctly rounded but for 1 step.
#[inline(never)]
pub fn libm_powf(x: f32, n: f32) -> f32 {
    libm::powf(x, n)
}

/// C. Schlick, "A Fast Alternative to Phong's Specular Model", Graphics Gems IV (1994): another model
/// of shading rather than an approximation.
#[inline(never)]
pub fn schlick(x: f32, n: f32) -> f32 {
    x / (n - n * x + x)
}

/// micromath's approximation.
#[inline(never)]
pub fn micromath(x: f32, n: f32) -> f32 {
    F32Ext::powf(x, n)
}
