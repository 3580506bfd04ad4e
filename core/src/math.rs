//! Every float function of the crate passes through here.
//!
//! [`Exact`] gives the same bits on every target: only operations that IEEE 754 rounds correctly,
//! in a fixed order, never contracted. [`Micro`] is micromath's approximations for firmware that
//! wants speed before accuracy; a program names one by type, so that both can be in one binary.

use core::ops::Mul;

use glam::Vec3;
use micromath::F32Ext;

use crate::material::Transmission;
use crate::subdivision::Quantity;

/// How roots and powers are computed.
pub trait Math: 'static {
    /// Whether roots are correctly rounded, and so unit vectors unit length but for rounding.
    const EXACT: bool;

    /// Square root of a number that is at least zero.
    fn sqrt(x: f32) -> f32;

    /// Square root of a number above zero, and the reciprocal of that root.
    fn sqrt_and_recip(x: f32) -> (f32, f32);

    /// `x` to a whole power.
    fn powi(x: f32, n: u32) -> f32;

    /// `x`, from 0 to about 1, to a power of at least 0; the same bits as [`Math::powi`] where `n` is
    /// a whole number.
    fn powf(x: f32, n: f32) -> f32;

    /// `v` over its length. Not a number where the length is zero or its square leaves the range.
    #[cfg_attr(soft_float, inline(never))]
    #[cfg_attr(not(soft_float), inline)]
    fn normalize(v: Vec3) -> Vec3 {
        scale(&v, Self::sqrt_and_recip(length_squared(&v)).1)
    }
}

/// Correctly rounded roots, powers to within 0.01 of a step of an 8-bit channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Exact;

/// The approximations of the micromath crate: roots to within a few percent, and powers whose error
/// shows. The README's chart has what that costs a picture and what it saves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Micro;

impl Math for Exact {
    const EXACT: bool = true;

    #[inline(always)]
    fn sqrt(x: f32) -> f32 {
        sqrt(x)
    }

    #[inline(always)]
    fn sqrt_and_recip(x: f32) -> (f32, f32) {
        let root = sqrt(x);
        (root, 1.0 / root)
    }

    #[inline]
    fn powi(x: f32, n: u32) -> f32 {
        powi(x, n)
    }

    #[inline]
    fn powf(x: f32, n: f32) -> f32 {
        let whole = n as u32;
        if whole as f32 == n {
            powi(x, whole)
        } else {
            exp2(n * log2(x))
        }
    }
}

impl Math for Micro {
    const EXACT: bool = false;

    #[inline(always)]
    fn sqrt(x: f32) -> f32 {
        F32Ext::sqrt(x)
    }

    #[inline(always)]
    fn sqrt_and_recip(x: f32) -> (f32, f32) {
        let recip = F32Ext::invsqrt(x);
        (x * recip, recip)
    }

    #[inline]
    fn powi(x: f32, n: u32) -> f32 {
        F32Ext::powf(x, n as f32)
    }

    #[inline]
    fn powf(x: f32, n: f32) -> f32 {
        F32Ext::powf(x, n)
    }
}

/// The square root, correctly rounded, by the target's instruction where it has one.
#[inline(always)]
#[allow(unsafe_code)]
pub fn sqrt(x: f32) -> f32 {
    #[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
    {
        // `libm` computes roots in software on 32-bit Arm. The operand passes through a core
        // register: the `sreg` register class asks for a feature that stable Rust cannot name on
        // M-profile targets (rust-lang/rust#159976).
        let mut bits = x.to_bits();
        // SAFETY: every `eabihf` target has VSQRT.F32; it touches s0 and its operand, no memory, no
        // flags and no stack.
        unsafe {
            core::arch::asm!(
                "vmov s0, {0}",
                "vsqrt.f32 s0, s0",
                "vmov {0}, s0",
                inout(reg) bits,
                out("s0") _,
                options(pure, nomem, nostack, preserves_flags),
            );
        }
        f32::from_bits(bits)
    }
    #[cfg(riscv_f)]
    {
        let root: f32;
        // SAFETY: the target has the F extension (build.rs); no memory, no stack. The accrued
        // exception flags, which Rust never reads, are all that changes beside `root`.
        unsafe {
            core::arch::asm!(
                "fsqrt.s {0}, {1}, rne",
                out(freg) root,
                in(freg) x,
                options(pure, nomem, nostack),
            );
        }
        root
    }
    #[cfg(narrow_multiply)]
    {
        sqrt_by_digits(x)
    }
    #[cfg(all(target_arch = "x86_64", target_feature = "sse"))]
    {
        use core::arch::x86_64::{_mm_cvtss_f32, _mm_set_ss, _mm_sqrt_ss};
        // `libm` has SQRTSS in assembly, in an encoding that waits for the upper halves of the registers
        // where code around it uses them: on Intel's processors for longer than all the rest of a ray
        // takes. The compiler picks the encoding that fits.
        // SAFETY: the target has SSE.
        unsafe { _mm_cvtss_f32(_mm_sqrt_ss(_mm_set_ss(x))) }
    }
    #[cfg(not(any(
        all(target_arch = "arm", target_abi = "eabihf"),
        riscv_f,
        narrow_multiply,
        all(target_arch = "x86_64", target_feature = "sse")
    )))]
    {
        libm::sqrtf(x)
    }
}

/// The square root, correctly rounded, in integers: a quarter of what `libm` takes with its table, and
/// faster where no instruction multiplies to 64 bits.
#[cfg(any(narrow_multiply, test))]
#[cfg_attr(narrow_multiply, inline(never))]
fn sqrt_by_digits(x: f32) -> f32 {
    const FRACTION: u32 = f32::MANTISSA_DIGITS - 1;
    const HIDDEN: u32 = 1 << FRACTION;
    let bits = x.to_bits();
    if bits > (-0.0_f32).to_bits() {
        return f32::NAN;
    }
    if !(1..f32::INFINITY.to_bits()).contains(&bits) {
        return x;
    }
    // With such a bias, halving the number before it leaves the usual one.
    let mut exponent = (bits >> FRACTION) + 127;
    let mut significand = bits & (HIDDEN - 1);
    if bits >= HIDDEN {
        significand |= HIDDEN;
    } else {
        let shift = significand.leading_zeros() - HIDDEN.leading_zeros();
        significand <<= shift;
        exponent -= shift - 1;
    }
    // What halving the exponent leaves over, and room for one digit more than is kept.
    let root = root_by_digits(significand << (1 + (exponent & 1)), HIDDEN << 1);
    // Never halfway between two floats: the square of that has too many digits for one.
    f32::from_bits(((root + 1) >> 1) + (((exponent - 2) >> 1) << FRACTION))
}

/// The digits of the square root of `rest`, of which `digit` is the highest.
///
/// The loop stands in assembly where it counts: LLVM takes each loop for one that may not end, and so
/// keeps calls of what has one also where nobody needs the result.
#[cfg(any(narrow_multiply, test))]
#[inline(always)]
#[allow(unsafe_code)]
fn root_by_digits(rest: u32, digit: u32) -> u32 {
    let mut twice_root = 0;
    #[cfg(narrow_multiply)]
    // SAFETY: registers and flags; no memory and no stack. It ends when the digit is shifted out.
    unsafe {
        core::arch::asm!(
            "2:",
            "adds {next}, {twice_root}, {digit}",
            "cmp {next}, {rest}",
            "bhi 3f",
            "subs {rest}, {rest}, {next}",
            "adds {twice_root}, {next}, {digit}",
            "3:",
            "lsls {rest}, {rest}, #1",
            "lsrs {digit}, {digit}, #1",
            "bne 2b",
            next = out(reg) _,
            twice_root = inout(reg) twice_root,
            rest = inout(reg) rest => _,
            digit = inout(reg) digit => _,
            options(pure, nomem, nostack),
        );
    }
    #[cfg(not(narrow_multiply))]
    {
        let (mut rest, mut digit) = (rest, digit);
        while digit != 0 {
            let next = twice_root + digit;
            if next <= rest {
                rest -= next;
                twice_root = next + digit;
            }
            rest <<= 1;
            digit >>= 1;
        }
    }
    twice_root / 2
}

/// Keeps the loop that calls it from being unrolled on microcontrollers; no instruction.
///
/// LLVM unrolls small loops four times for Cortex-M. Most scenes have one plane, and flash is dear.
#[inline(always)]
#[allow(unsafe_code)]
pub(crate) fn keep_rolled() {
    #[cfg(all(target_os = "none", any(target_arch = "arm", target_arch = "riscv32")))]
    // SAFETY: an empty template.
    unsafe {
        core::arch::asm!("", options(nomem, nostack, preserves_flags));
    }
}

/// `x`, of which the compiler then knows nothing on microcontrollers; no instruction.
///
/// What LLVM knows of an address it tests anew in every round of a loop, to save one comparison.
#[inline(always)]
#[allow(unsafe_code)]
pub(crate) fn forget<T>(x: *const T) -> *const T {
    #[cfg(all(target_os = "none", any(target_arch = "arm", target_arch = "riscv32")))]
    {
        let mut x = x;
        // SAFETY: an empty template.
        unsafe {
            core::arch::asm!("/* {0} */", inout(reg) x, options(pure, nomem, nostack, preserves_flags));
        }
        x
    }
    #[cfg(not(all(target_os = "none", any(target_arch = "arm", target_arch = "riscv32"))))]
    x
}

/// The same of a number.
#[inline(always)]
pub(crate) fn forget_number(x: usize) -> usize {
    forget(core::ptr::without_provenance::<()>(x)).addr()
}

/// The outcome of a comparison that is used in many places. Where comparing floats is a call, LLVM would
/// compare anew in each.
#[inline(always)]
pub(crate) fn decided(x: bool) -> bool {
    #[cfg(soft_float)]
    let x = forget_number(x as usize) != 0;
    x
}

/// The objects of a slice, for a loop over them.
///
/// Where each float operation is a call, the loop looks short, and LLVM unrolls it whole where it knows how long
/// the slice is: which [`keep_rolled`] does not prevent.
#[inline(always)]
pub(crate) fn rolled<T>(slice: &[T]) -> core::slice::Iter<'_, T> {
    #[cfg(soft_float)]
    if slice.len() > 1 {
        return slice
            .get(..forget_number(slice.len()))
            .unwrap_or_default()
            .iter();
    }
    slice.iter()
}

/// `x` to a whole power by repeated squaring; at most 32 rounds.
#[inline]
fn powi(mut x: f32, mut n: u32) -> f32 {
    let mut power = 1.0;
    loop {
        if n & 1 == 1 {
            power *= x;
        }
        n >>= 1;
        if n == 0 {
            return power;
        }
        x *= x;
    }
}

/// Base-2 logarithm of a normal number above zero; of zero and subnormal numbers, -127 or so.
///
/// The significand is moved to [√½, √2) and log2((1+s)/(1-s)) expanded in odd powers of s: relative
/// error 1.2e-7 also near x = 1, where powers with a large exponent are sensitive.
#[cfg_attr(soft_float, inline(never))]
fn log2(x: f32) -> f32 {
    const SQRT_HALF_BITS: u32 = 0x3f35_04f3;
    let offset = x.to_bits().wrapping_sub(SQRT_HALF_BITS);
    let exponent = (offset as i32) >> 23;
    let significand = f32::from_bits((offset & 0x007f_ffff).wrapping_add(SQRT_HALF_BITS));
    let s = (significand - 1.0) / (significand + 1.0);
    let z = s * s;
    exponent as f32 + s * (2.885_390_4 + z * (0.961_588_3 + z * 0.595_781_7))
}

/// 2 to the power of `x`, for `x` up to 127; zero below -126. Relative error 2e-7, by a minimax
/// polynomial that is exactly 1 at 0.
#[cfg_attr(soft_float, inline(never))]
#[allow(clippy::approx_constant)]
fn exp2(x: f32) -> f32 {
    // Rounding by addition: beyond 2^22 all fractions are gone.
    const ROUND: f32 = 12_582_912.0;
    // Also false for NaN.
    if !(x >= -126.0) {
        return 0.0;
    }
    let x = if x < 127.0 { x } else { 127.0 };
    let rounded = (x + ROUND) - ROUND;
    let f = x - rounded;
    let p = 0.693_147
        + f * (0.240_222_42 + f * (0.055_507_337 + f * (0.009_671_513 + f * 0.001_326_472_7)));
    let scale = f32::from_bits(((rounded as i32 + 127) as u32) << 23);
    (1.0 + f * p) * scale
}

/// `x` to the power of two thirds, relative error 3e-7; zero unless `x` is above zero.
pub(crate) fn two_thirds_power(x: f32) -> f32 {
    if x > 0.0 {
        exp2(log2(x) * (2.0 / 3.0))
    } else {
        0.0
    }
}

/// A product of transmittances whose bits do not depend on the order of its factors.
///
/// A hierarchy meets surfaces in another order than a slice does, and products of floats depend on
/// their order. Whole sums do not: this adds -log2 of each factor in units of 2^-24.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Transmittance(u32);

impl Transmittance {
    /// Multiplies by `factor`, from 0 to 1, `times` times.
    #[inline]
    pub fn cross(&mut self, factor: f32, times: u32) {
        // The cast saturates: zero for NaN and for factors above 1, the largest sum for a factor of 0.
        let depth = if factor > 0.0 {
            (-log2(factor) * 16_777_216.0) as u32
        } else {
            u32::MAX
        };
        self.0 = self.0.saturating_add(depth.saturating_mul(times));
    }

    /// Crosses a surface `times` times, and tells whether nothing is left: where it is met and opaque.
    #[inline(always)]
    pub fn ends(&mut self, factor: f32, times: u32) -> bool {
        if times > 0 && factor > 0.0 {
            self.cross(factor, times);
        }
        // Also true for NaN.
        times > 0 && !(factor > 0.0)
    }

    /// Weakens light by `e` to the power of minus `depth`, as Beer's law has it.
    #[inline]
    fn absorb(&mut self, depth: f32) {
        // Also false for NaN.
        if depth > 0.0 {
            let depth = (depth * (LOG2_E * 16_777_216.0)) as u32;
            self.0 = self.0.saturating_add(depth);
        }
    }

    /// The product, from 0 to 1. Relative error 2e-7 and 2^-25 for each factor; zero below 2^-126.
    #[inline]
    pub fn product(self) -> f32 {
        if self.0 == 0 {
            // As below, in one step for the many rays that nothing weakens.
            return 1.0;
        }
        let whole = (self.0 >> 24) as f32;
        let fraction = (self.0 & 0x00ff_ffff) as f32 / 16_777_216.0;
        // A sum so large that adding its parts rounds is a product that no picture shows.
        exp2(-(whole + fraction))
    }
}

const LOG2_E: f32 = core::f32::consts::LOG2_E;

/// What is left of light after `distance` in a medium: Beer's law, `e^(-absorption·distance)`, a channel
/// each; 1 where nothing is absorbed, over no matter what distance. Relative error 1e-6 where more than
/// 1/1000 is left.
#[inline]
pub(crate) fn beer(absorption: Vec3, distance: f32) -> Vec3 {
    absorption.map(|rate| {
        let depth = rate * distance;
        // Also false for NaN: what absorbs nothing over an infinite distance.
        if depth > 0.0 {
            exp2(-LOG2_E * depth)
        } else {
            1.0
        }
    })
}

/// What weighs light on its way: one number, or one for each channel.
pub trait Weight: Quantity + Mul<Output = Self> {
    /// The same for each channel.
    fn splat(share: f32) -> Self;
    /// What a surface lets through.
    fn through(surface: &impl Transmission) -> Self;
    /// What is left after a distance, by Beer's law, where all that absorbs has a color.
    fn absorbed(absorption: Vec3, distance: f32) -> Self;
    /// A share of it.
    fn scaled(self, share: f32) -> Self;
    /// Light, weighed.
    fn weigh(self, light: Vec3) -> Vec3;
    /// Whether any channel is above a bound; not where it is NaN.
    fn exceeds(self, bound: f32) -> bool;
}

impl Weight for f32 {
    #[inline(always)]
    fn splat(share: f32) -> Self {
        share
    }

    #[inline(always)]
    fn through(surface: &impl Transmission) -> Self {
        surface.transmittance()
    }

    #[inline(always)]
    fn absorbed(_: Vec3, _: f32) -> Self {
        1.0
    }

    #[inline(always)]
    fn scaled(self, share: f32) -> Self {
        share * self
    }

    #[inline(always)]
    fn weigh(self, light: Vec3) -> Vec3 {
        light * self
    }

    #[inline(always)]
    fn exceeds(self, bound: f32) -> bool {
        self > bound
    }
}

impl Weight for Vec3 {
    #[inline(always)]
    fn splat(share: f32) -> Self {
        Vec3::splat(share)
    }

    #[inline(always)]
    fn through(surface: &impl Transmission) -> Self {
        surface.tint()
    }

    #[inline(always)]
    fn absorbed(absorption: Vec3, distance: f32) -> Self {
        beer(absorption, distance)
    }

    #[inline(always)]
    fn scaled(self, share: f32) -> Self {
        share * self
    }

    #[inline(always)]
    fn weigh(self, light: Vec3) -> Vec3 {
        light * self
    }

    #[inline(always)]
    fn exceeds(self, bound: f32) -> bool {
        self.x > bound || self.y > bound || self.z > bound
    }
}

/// Light on its way through objects.
pub trait Passage {
    /// Crosses a surface of this kind `times` times, and so much of what it encloses as `inside` tells, where
    /// that matters. True as soon as nothing is left.
    fn pass(
        &mut self,
        surface: &impl Transmission,
        times: u32,
        inside: impl FnOnce() -> f32,
    ) -> bool;
}

/// What is left of light that passes through objects, whatever their order: [`Transmittance`], or
/// [`Transmittances`] where they have colors.
pub trait Attenuation: Passage + Default {
    /// How much that is.
    type Share: Weight;

    /// What is left, each channel from 0 to 1.
    fn share(self) -> Self::Share;
}

impl Passage for Transmittance {
    #[inline(always)]
    fn pass(&mut self, surface: &impl Transmission, times: u32, _: impl FnOnce() -> f32) -> bool {
        self.ends(surface.transmittance(), times)
    }
}

impl Attenuation for Transmittance {
    type Share = f32;

    #[inline(always)]
    fn share(self) -> f32 {
        self.product()
    }
}

/// [`Transmittance`] of each channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Transmittances([Transmittance; 3]);

impl Passage for Transmittances {
    #[inline]
    fn pass(
        &mut self,
        surface: &impl Transmission,
        times: u32,
        inside: impl FnOnce() -> f32,
    ) -> bool {
        if times > 0 {
            let tint = surface.tint().to_array();
            for (channel, factor) in self.0.iter_mut().zip(tint) {
                channel.cross(factor, times);
            }
        }
        let absorption = surface.absorption();
        if absorption != Vec3::ZERO {
            let distance = inside();
            for (channel, rate) in self.0.iter_mut().zip(absorption.to_array()) {
                channel.absorb(rate * distance);
            }
        }
        self.0 == [Transmittance(u32::MAX); 3]
    }
}

impl Attenuation for Transmittances {
    type Share = Vec3;

    #[inline]
    fn share(self) -> Vec3 {
        Vec3::from_array(self.0.map(Transmittance::product))
    }
}

/// A [`Passage`] through a space in which lengths are others.
pub(crate) struct Scaled<'a, L> {
    pub(crate) light: &'a mut L,
    /// A length outside over the same inside.
    pub(crate) factor: f32,
}

impl<L: Passage> Passage for Scaled<'_, L> {
    #[inline(always)]
    fn pass(
        &mut self,
        surface: &impl Transmission,
        times: u32,
        inside: impl FnOnce() -> f32,
    ) -> bool {
        self.light.pass(surface, times, || inside() * self.factor)
    }
}

/// Length and unit vector of a difference of `f32` points, for constructors; `None` where the length
/// is zero or not finite. In f64 no difference of finite points over- or underflows when squared.
pub(crate) fn unit(v: [f64; 3]) -> Option<(f64, Vec3)> {
    let length = libm::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    let scale = 1.0 / length;
    let unit = v.map(|x| (x * scale) as f32);
    (length > 0.0 && length.is_finite()).then_some((length, Vec3::from_array(unit)))
}

/// `a - b`, for constructors.
pub(crate) fn difference(a: Vec3, b: Vec3) -> [f64; 3] {
    core::array::from_fn(|i| f64::from(a.to_array()[i]) - f64::from(b.to_array()[i]))
}

/// The cross product, for constructors.
pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The dot product.
///
/// Where each float operation is a call, this is one call of its own.
#[cfg_attr(soft_float, inline(never))]
#[cfg_attr(not(soft_float), inline(always))]
pub fn dot(a: &Vec3, b: &Vec3) -> f32 {
    a.dot(*b)
}

/// `a - b`; like [`dot`], one call where each float operation is one.
#[cfg_attr(soft_float, inline(never))]
#[cfg_attr(not(soft_float), inline(always))]
pub(crate) fn sub(a: &Vec3, b: &Vec3) -> Vec3 {
    *a - *b
}

/// `v` times a number; like [`dot`], one call where each float operation is one.
#[cfg_attr(soft_float, inline(never))]
#[cfg_attr(not(soft_float), inline(always))]
pub(crate) fn scale(v: &Vec3, factor: f32) -> Vec3 {
    *v * factor
}

/// The dot product of a vector with itself.
#[inline(always)]
pub fn length_squared(v: &Vec3) -> f32 {
    dot(v, v)
}

/// The larger of `x` and zero; zero for NaN.
#[inline(always)]
pub fn positive(x: f32) -> f32 {
    if is_positive(x) { x } else { 0.0 }
}

/// Whether `x` is above zero; not where it is NaN. Where comparing floats is a call, bits tell.
#[inline(always)]
pub(crate) fn is_positive(x: f32) -> bool {
    if cfg!(soft_float) {
        x.to_bits().wrapping_sub(1) < f32::INFINITY.to_bits()
    } else {
        x > 0.0
    }
}

/// The largest component.
#[inline(always)]
pub(crate) fn max_component(v: Vec3) -> f32 {
    let xy = if v.x > v.y { v.x } else { v.y };
    if xy > v.z { xy } else { v.z }
}

/// A vector whose length differs from 1 only by rounding, without that difference: one step of
/// Newton's method, no root and no division.
#[cfg_attr(soft_float, inline(never))]
#[cfg_attr(not(soft_float), inline)]
pub fn renormalize(v: Vec3) -> Vec3 {
    scale(&v, 1.5 - 0.5 * length_squared(&v))
}

/// `direction` mirrored at a surface with this unit normal; unit length but for rounding, which
/// [`renormalize`] takes away and which would otherwise grow from bounce to bounce.
#[cfg_attr(soft_float, inline(never))]
#[cfg_attr(not(soft_float), inline)]
pub fn mirror(direction: Vec3, normal: Vec3) -> Vec3 {
    sub(&direction, &scale(&normal, 2.0 * dot(&direction, &normal)))
}

/// `direction` refracted by Snell's law, unit length; `None` for total internal reflection.
///
/// `normal` has unit length and is turned to the side from which `direction` comes; `eta` is the
/// index of refraction on that side over the one on the other side.
#[cfg_attr(soft_float, inline(never))]
#[cfg_attr(not(soft_float), inline)]
pub fn refract<P: Math>(direction: Vec3, normal: Vec3, eta: f32) -> Option<Vec3> {
    let cos = -dot(&direction, &normal);
    let cos_squared = 1.0 - eta * eta * (1.0 - cos * cos);
    // Also false for NaN.
    if cos_squared >= 0.0 {
        let bent = direction * eta + normal * (eta * cos - P::sqrt(cos_squared));
        Some(renormalize(bent))
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sqrt_is_correctly_rounded() {
        let mut bits: u32 = 1;
        while bits < 0x7f80_0000 {
            let x = f32::from_bits(bits);
            let expected = libm::sqrt(f64::from(x)) as f32;
            assert_eq!(sqrt(x).to_bits(), expected.to_bits(), "{x:e}");
            assert_eq!(sqrt_by_digits(x).to_bits(), expected.to_bits(), "{x:e}");
            bits += 65_537;
        }
        for sqrt in [sqrt, sqrt_by_digits] {
            for x in [0.0, -0.0, f32::INFINITY] {
                assert_eq!(sqrt(x).to_bits(), x.to_bits());
            }
            for x in [-1.0, f32::NEG_INFINITY, f32::NAN, -f32::NAN] {
                assert!(sqrt(x).is_nan(), "{x}");
            }
        }
    }

    /// Largest error of a power on [0, 1], in steps of an 8-bit channel.
    fn worst_step<F: Fn(f32) -> f32>(power: F, n: f64) -> f64 {
        (0..=200_000)
            .map(|i| {
                // Dense near 1, where a large exponent puts the highlight.
                let x = 1.0 - libm::pow(f64::from(i) / 200_000.0, 3.0);
                let x = x as f32;
                let exact = libm::pow(f64::from(x), n);
                libm::fabs(f64::from(power(x)) - exact) * 255.0
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn powers_are_within_a_hundredth_of_a_step() {
        for n in [1.0, 1.5, 3.0827_f32, 9.99, 50.0, 99.5, 333.3, 1000.0, 999.5] {
            let error = worst_step(|x| Exact::powf(x, n), f64::from(n));
            assert!(error < 0.01, "exponent {n}: {error} of a step");
        }
    }

    #[test]
    fn whole_real_exponents_have_the_bits_of_integer_ones() {
        for n in [0_u32, 1, 2, 50, 1000] {
            for i in 0..=1000_u32 {
                let x = i as f32 / 1000.0;
                assert_eq!(
                    Exact::powf(x, n as f32).to_bits(),
                    Exact::powi(x, n).to_bits()
                );
            }
        }
    }

    #[test]
    fn powers_of_the_ends_are_exact_and_nothing_else_is_a_surprise() {
        assert_eq!(Exact::powf(1.0, 3.5), 1.0);
        assert_eq!(Exact::powf(0.0, 3.5), 0.0);
        assert_eq!(Exact::powf(0.5, f32::INFINITY), 0.0);
        assert_eq!(Exact::powf(0.5, f32::NAN), 0.0);
        assert!(Exact::powf(f32::NAN, 2.5).is_finite());
    }

    #[test]
    fn transmittance_does_not_depend_on_the_order() {
        let factors = [0.9, 0.8, 0.33, 1.0, 0.51];
        let mut forward = Transmittance::default();
        let mut backward = Transmittance::default();
        for factor in factors {
            forward.cross(factor, 2);
        }
        for factor in factors.iter().rev() {
            backward.cross(*factor, 1);
            backward.cross(*factor, 1);
        }
        assert_eq!(forward, backward);
        let exact: f64 = factors
            .iter()
            .map(|f| f64::from(*f) * f64::from(*f))
            .product();
        let relative = f64::from(forward.product()) / exact - 1.0;
        assert!(relative.abs() < 2e-6, "{relative:e}");
    }

    #[test]
    fn transmittance_is_exact_at_its_ends() {
        let mut clear = Transmittance::default();
        clear.cross(1.0, 100);
        assert_eq!(clear.product(), 1.0);
        let mut opaque = Transmittance::default();
        opaque.cross(0.0, 1);
        opaque.cross(0.5, 1);
        assert_eq!(opaque.product(), 0.0);
        let mut half = Transmittance::default();
        half.cross(0.5, 3);
        assert_eq!(half.product(), 0.125);
    }

    #[test]
    fn directions_stay_unit_over_many_bounces() {
        let mut direction = Exact::normalize(Vec3::new(1.0, 2.0, 3.0));
        let normal = Exact::normalize(Vec3::new(-2.0, 1.0, 0.5));
        for _ in 0..10_000 {
            direction = renormalize(mirror(direction, normal));
        }
        assert!((direction.length_squared() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn refraction_obeys_snell() {
        let normal = Vec3::Y;
        let incoming = Exact::normalize(Vec3::new(1.0, -1.0, 0.0));
        let bent = refract::<Exact>(incoming, normal, 1.0 / 1.5).unwrap();
        assert!((bent.x - incoming.x / 1.5).abs() < 1e-6);
        assert!(bent.y < 0.0);
        assert_eq!(
            refract::<Exact>(Exact::normalize(Vec3::new(2.0, -1.0, 0.0)), normal, 1.5),
            None
        );
        assert_eq!(refract::<Exact>(Vec3::NAN, normal, 1.5), None);
    }
}
