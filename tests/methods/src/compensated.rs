//! Sums of two `f32` that stand for about 48 bits.
//!
//! T. J. Dekker, "A Floating-Point Technique for Extending the Available Precision", Numerische
//! Mathematik 18, 1971; T. Ogita, S. M. Rump, S. Oishi, "Accurate Sum and Dot Product", SIAM J. Sci.
//! Comput. 26(6), 2005. Without fused multiply-add: products are split, which overflows above 2^115.

use core::ops::{Add, Mul, Neg, Sub};

use glam::Vec3;

/// An unevaluated sum, `low` at most half a step of `high`.
#[derive(Clone, Copy, Debug)]
pub struct Pair {
    /// The sum, rounded.
    pub high: f32,
    /// What rounding took from it.
    pub low: f32,
}

/// The exact sum of two numbers (Knuth's six operations: no order of size is needed).
#[inline(always)]
pub fn two_sum(a: f32, b: f32) -> Pair {
    let high = a + b;
    let b_part = high - a;
    let low = (a - (high - b_part)) + (b - b_part);
    Pair { high, low }
}

/// The exact sum where `a` is not the smaller.
#[inline(always)]
fn quick_two_sum(a: f32, b: f32) -> Pair {
    let high = a + b;
    Pair {
        high,
        low: b - (high - a),
    }
}

/// Upper and lower half of the significand.
#[inline(always)]
fn split(a: f32) -> (f32, f32) {
    let c = 4097.0 * a;
    let high = c - (c - a);
    (high, a - high)
}

/// The exact product of two numbers.
#[inline(always)]
pub fn two_product(a: f32, b: f32) -> Pair {
    let high = a * b;
    let (a_high, a_low) = split(a);
    let (b_high, b_low) = split(b);
    let low = ((a_high * b_high - high) + a_high * b_low + a_low * b_high) + a_low * b_low;
    Pair { high, low }
}

impl Pair {
    /// A number as it is.
    #[inline(always)]
    pub fn new(x: f32) -> Self {
        Self { high: x, low: 0.0 }
    }

    /// Rounded to one number.
    #[inline(always)]
    pub fn value(self) -> f32 {
        self.high + self.low
    }

    /// Square root: one Newton step from the rounded one; zero for zero.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        let root = whitted::math::sqrt(self.high);
        if !(root > 0.0) {
            return Self::new(root);
        }
        let rest = self - two_product(root, root);
        quick_two_sum(root, rest.high / (2.0 * root))
    }

    /// `self / other`, rounded to one number.
    #[inline(always)]
    pub fn over(self, other: Self) -> f32 {
        let quotient = self.high / other.high;
        let rest = self - other * Self::new(quotient);
        quotient + rest.high / other.high
    }
}

impl Add for Pair {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let sum = two_sum(self.high, other.high);
        let rest = two_sum(self.low, other.low);
        let sum = quick_two_sum(sum.high, sum.low + rest.high);
        quick_two_sum(sum.high, sum.low + rest.low)
    }
}

impl Neg for Pair {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl Sub for Pair {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Pair {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let product = two_product(self.high, other.high);
        let low = product.low + (self.high * other.low + self.low * other.high);
        quick_two_sum(product.high, low)
    }
}

/// A vector of pairs.
#[derive(Clone, Copy, Debug)]
pub struct Pair3(pub [Pair; 3]);

impl Pair3 {
    /// A vector as it is.
    #[inline(always)]
    pub fn new(v: Vec3) -> Self {
        Self(v.to_array().map(Pair::new))
    }

    /// The exact difference of two vectors.
    #[inline(always)]
    pub fn difference(a: Vec3, b: Vec3) -> Self {
        Self([two_sum(a.x, -b.x), two_sum(a.y, -b.y), two_sum(a.z, -b.z)])
    }

    /// The dot product.
    #[inline(always)]
    pub fn dot(self, other: Self) -> Pair {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        a * x + b * y + c * z
    }

    /// `self - other * factor`.
    #[inline(always)]
    pub fn minus(self, other: Self, factor: Pair) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a - x * factor, b - y * factor, c - z * factor])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_and_sums_are_exact() {
        for (a, b) in [(0.1_f32, 0.7_f32), (1.0e7, 3.3e-5), (-1.2345e-3, 9.876e8)] {
            let product = two_product(a, b);
            let pair = f64::from(product.high) + f64::from(product.low);
            assert_eq!(pair, f64::from(a) * f64::from(b));
            let sum = two_sum(a, b);
            assert_eq!(
                f64::from(sum.high) + f64::from(sum.low),
                f64::from(a) + f64::from(b)
            );
            assert!(sum.low != 0.0 || product.low != 0.0, "both rounded nothing");
        }
    }

    #[test]
    fn roots_and_quotients_have_more_digits_than_a_float() {
        let two = Pair::new(2.0);
        let root = two.sqrt();
        let root = f64::from(root.high) + f64::from(root.low);
        assert!((root - libm::sqrt(2.0)).abs() < 1e-13, "{root}");
        assert_eq!(Pair::new(1.0).over(Pair::new(3.0)), 1.0 / 3.0);
    }
}
