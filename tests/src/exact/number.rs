//! Numbers that know whether they are sure of their sign.

use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Sub};

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;

/// An arithmetic in which the oracle's formulas are written once.
///
/// [`Bounded`] is fast and sometimes undecided; then the same formula runs in [`Exact`], which never
/// is.
pub trait Number:
    Clone + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// Takes an input as it is.
    fn new(x: f32) -> Self;

    /// The sign, or `None` where this arithmetic cannot tell.
    ///
    /// Of sums and products of inputs [`Exact`] always can, zero included. Do not ask it of
    /// differences of quotients and roots: they have 256 bits.
    fn sign(&self) -> Option<Ordering>;

    /// The quotient, to 256 bits in [`Exact`].
    fn over(self, other: Self) -> Self;

    /// The square root of a number above zero, to 256 bits in [`Exact`].
    fn sqrt(self) -> Self;

    /// The nearest `f64`, or `None` where not even 40 bits are certain.
    fn value(&self) -> Option<f64>;

    /// Whether the number is zero but for the rounding of 256 bits, against numbers of the size of
    /// `scale`. `None` where this arithmetic cannot tell.
    fn vanishes(&self, scale: &Self) -> Option<bool>;
}

/// An `f64` and how far at most it is from the true value: running error analysis, N. J. Higham,
/// Accuracy and Stability of Numerical Algorithms, 2nd ed. (2002), 3.3.
#[derive(Clone, Copy, Debug)]
pub struct Bounded {
    value: f64,
    error: f64,
}

/// The largest relative error of an operation of `f64`, and a little for the errors of the bounds.
const HALF_STEP: f64 = f64::EPSILON * 0.5;
const SLACK: f64 = 1.0 + 1e-12;

impl Bounded {
    fn rounded(value: f64, error: f64) -> Self {
        let rounding = value.abs() * HALF_STEP;
        Self {
            value,
            error: (error + rounding) * SLACK,
        }
    }

    fn is_zero(&self) -> bool {
        self.value == 0.0 && self.error == 0.0
    }
}

impl Add for Bounded {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        // A sum of f64 that is zero or subnormal is exact.
        Self::rounded(self.value + other.value, self.error + other.error)
    }
}

impl Sub for Bounded {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Bounded {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            value: -self.value,
            error: self.error,
        }
    }
}

impl Mul for Bounded {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        if self.is_zero() || other.is_zero() {
            return Self::new(0.0);
        }
        let error = self.value.abs() * other.error
            + other.value.abs() * self.error
            + self.error * other.error;
        // The last term is for products that leave the range of normal numbers.
        Self::rounded(self.value * other.value, error + f64::MIN_POSITIVE)
    }
}

impl Number for Bounded {
    fn new(x: f32) -> Self {
        Self {
            value: f64::from(x),
            error: 0.0,
        }
    }

    fn sign(&self) -> Option<Ordering> {
        // False for NaN, which is what an overflow leads to.
        if self.value.abs() > self.error {
            self.value.partial_cmp(&0.0)
        } else if self.is_zero() {
            Some(Ordering::Equal)
        } else {
            None
        }
    }

    fn over(self, other: Self) -> Self {
        let least = other.value.abs() - other.error;
        if !(least > 0.0) {
            return Self {
                value: f64::NAN,
                error: f64::NAN,
            };
        }
        let value = self.value / other.value;
        let error = (self.error + value.abs() * other.error * SLACK) / least;
        Self::rounded(value, error + f64::MIN_POSITIVE)
    }

    fn sqrt(self) -> Self {
        // |sqrt(a + e) - sqrt(a)| <= e / sqrt(a).
        let value = self.value.sqrt();
        Self::rounded(value, self.error / value * SLACK)
    }

    fn value(&self) -> Option<f64> {
        const LEAST: f64 = 1.0 / (1_u64 << 40) as f64;
        (self.error <= self.value.abs() * LEAST).then_some(self.value)
    }

    fn vanishes(&self, _: &Self) -> Option<bool> {
        // What is certainly not zero in f64 does not vanish to 256 bits either.
        self.sign().map(|sign| sign == Ordering::Equal)
    }
}

type Big = FBig<HalfEven, 2>;

/// A binary float of any length: sums and products are exact.
#[derive(Clone, Debug)]
pub struct Exact(Big);

const BITS: usize = 256;

impl Exact {
    fn approximate(self) -> Big {
        self.0.with_precision(BITS).value()
    }

    fn unlimited(x: Big) -> Self {
        Self(x.with_precision(0).value())
    }
}

impl Add for Exact {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Sub for Exact {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl Neg for Exact {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Mul for Exact {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }
}

impl Number for Exact {
    /// # Panics
    ///
    /// Where the number is not finite.
    fn new(x: f32) -> Self {
        Self::unlimited(Big::try_from(x).expect("the oracle is for finite inputs"))
    }

    fn sign(&self) -> Option<Ordering> {
        Some(self.0.cmp(&Big::ZERO))
    }

    fn over(self, other: Self) -> Self {
        Self::unlimited(self.approximate() / other.approximate())
    }

    fn sqrt(self) -> Self {
        Self::unlimited(self.approximate().sqrt())
    }

    fn value(&self) -> Option<f64> {
        Some(self.0.to_f64().value())
    }

    fn vanishes(&self, scale: &Self) -> Option<bool> {
        let zero = self.0 == Big::ZERO;
        // A hundred bits are kept for the formula's own cancellation.
        let size = |x: &Big| x.repr().significand().bit_len() as isize + x.repr().exponent();
        Some(zero || (scale.0 != Big::ZERO && size(&self.0) + 156 < size(&scale.0)))
    }
}

trait BitLen {
    fn bit_len(&self) -> usize;
}

impl BitLen for dashu_int::IBig {
    fn bit_len(&self) -> usize {
        dashu_base::BitTest::bit_len(self)
    }
}

/// A vector of numbers.
#[derive(Clone, Debug)]
pub struct Vector<N>(pub [N; 3]);

impl<N: Number> Vector<N> {
    /// Takes an input as it is.
    pub fn new(v: [f32; 3]) -> Self {
        Self(v.map(N::new))
    }

    /// `self - other`.
    pub fn minus(&self, other: &Self) -> Self {
        Self(self.zip(other, |a, b| a - b))
    }

    /// `self * factor`.
    pub fn times(&self, factor: &N) -> Self {
        let [x, y, z] = self.0.clone();
        Self([x * factor.clone(), y * factor.clone(), z * factor.clone()])
    }

    /// The dot product.
    pub fn dot(&self, other: &Self) -> N {
        let [x, y, z] = self.zip(other, |a, b| a * b);
        x + y + z
    }

    /// The dot product with itself.
    pub fn square(&self) -> N {
        self.dot(self)
    }

    /// The cross product.
    pub fn cross(&self, other: &Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0.clone(), other.0.clone());
        Self([
            b.clone() * z.clone() - c.clone() * y.clone(),
            c * x.clone() - a.clone() * z,
            a * y - b * x,
        ])
    }

    fn zip(&self, other: &Self, f: impl Fn(N, N) -> N) -> [N; 3] {
        let ([a, b, c], [x, y, z]) = (self.0.clone(), other.0.clone());
        [f(a, x), f(b, y), f(c, z)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Formulas that cancel, in both arithmetics.
    fn formulas<N: Number>([a, b, c, d]: [f32; 4]) -> Vec<N> {
        let [a, b, c, d] = [a, b, c, d].map(N::new);
        vec![
            a.clone() * d.clone() - b.clone() * c.clone(),
            (a.clone() + b.clone()) - (b.clone() + a.clone()),
            (a.clone() * a.clone() + b.clone() * b.clone()) * c.clone() - d.clone() * d.clone(),
            (a.clone() - b.clone()).over(c.clone() * c.clone() + N::new(1.0)),
            (a.clone() * a.clone() + N::new(1.0)).sqrt() - d,
            a * b.clone() * b * c.clone() * c,
        ]
    }

    #[test]
    fn what_is_certain_in_f64_is_true() {
        let mut undecided = 0;
        let mut bits = 1_u32;
        let mut next = || {
            bits = bits.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            // Few digits, so that differences vanish now and then.
            ((bits >> 20) as i32 - 2048) as f32 * [1.0, 0.01, 1e-30, 1e20][bits as usize >> 5 & 3]
        };
        for _ in 0..3000 {
            let inputs = [next(), next(), next(), next()];
            for (bounded, exact) in formulas::<Bounded>(inputs)
                .iter()
                .zip(formulas::<Exact>(inputs))
            {
                let Some(sign) = bounded.sign() else {
                    undecided += 1;
                    continue;
                };
                assert_eq!(Some(sign), exact.sign(), "{inputs:?} {bounded:?} {exact:?}");
                if let Some(value) = bounded.value() {
                    let exact = exact.value().unwrap();
                    let error = (value - exact).abs();
                    assert!(
                        error <= exact.abs() * 2.0_f64.powi(-39),
                        "{inputs:?}: {value} {exact}"
                    );
                }
            }
        }
        assert!(
            (10..9000).contains(&undecided),
            "{undecided} undecided say nothing"
        );
    }

    #[test]
    fn exact_sums_lose_nothing() {
        let big = Exact::new(1e30) * Exact::new(1e30);
        let small = Exact::new(f32::from_bits(1)) * Exact::new(f32::from_bits(1));
        let sum = big.clone() + small.clone() - big;
        assert_eq!(sum.value(), small.value());
        assert_eq!(sum.sign(), Some(Ordering::Greater));
    }

    #[test]
    fn what_vanishes_is_zero_but_for_256_bits() {
        let third = Exact::new(1.0).over(Exact::new(3.0));
        let rest = third.clone() + third.clone() + third - Exact::new(1.0);
        assert_eq!(rest.vanishes(&Exact::new(1.0)), Some(true));
        let step = Exact::new(2.0_f32.powi(-100));
        assert_eq!(step.vanishes(&Exact::new(1.0)), Some(false));
    }
}
