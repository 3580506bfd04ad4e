//! Powers, many at once.

/// As `Exact::powf` of each: the same operations without a branch, so that the compiler makes vectors
/// of them.
#[inline(always)]
pub fn powers<const N: usize>(x: &[f32; N], n: &[f32; N]) -> [f32; N] {
    let mut whole = [0; N];
    let mut rest = 0;
    let mut all_whole = true;
    for (whole, &n) in whole.iter_mut().zip(n) {
        let near = n as u32;
        let is_whole = near as f32 == n;
        *whole = if is_whole { near } else { 0 };
        rest |= *whole;
        all_whole &= is_whole;
    }
    // By repeated squaring.
    let mut power = [1.0; N];
    let mut square = *x;
    while rest != 0 {
        for lane in 0..N {
            let product = power[lane] * square[lane];
            power[lane] = if whole[lane] & 1 == 1 {
                product
            } else {
                power[lane]
            };
            whole[lane] >>= 1;
            square[lane] *= square[lane];
        }
        rest >>= 1;
    }
    if !all_whole {
        for lane in 0..N {
            let other = exp2(n[lane] * log2(x[lane]));
            let is_whole = n[lane] as u32 as f32 == n[lane];
            power[lane] = if is_whole { power[lane] } else { other };
        }
    }
    power
}

/// As `whitted::math`'s.
#[inline(always)]
fn log2(x: f32) -> f32 {
    const SQRT_HALF_BITS: u32 = 0x3f35_04f3;
    let offset = x.to_bits().wrapping_sub(SQRT_HALF_BITS);
    let exponent = (offset as i32) >> 23;
    let significand = f32::from_bits((offset & 0x007f_ffff).wrapping_add(SQRT_HALF_BITS));
    let s = (significand - 1.0) / (significand + 1.0);
    let z = s * s;
    exponent as f32 + s * (2.885_390_4 + z * (0.961_588_3 + z * 0.595_781_7))
}

/// As `whitted::math`'s.
#[inline(always)]
#[allow(clippy::approx_constant)]
fn exp2(x: f32) -> f32 {
    const ROUND: f32 = 12_582_912.0;
    // Zero for NaN too.
    let normal = x >= -126.0;
    let x = if normal { x } else { 0.0 };
    let x = if x < 127.0 { x } else { 127.0 };
    let shifted = x + ROUND;
    let rounded = shifted - ROUND;
    let f = x - rounded;
    let p = 0.693_147
        + f * (0.240_222_42 + f * (0.055_507_337 + f * (0.009_671_513 + f * 0.001_326_472_7)));
    // The whole number stands in the last bits of the sum.
    let whole = shifted.to_bits().wrapping_sub(ROUND.to_bits());
    let scale = f32::from_bits(whole.wrapping_add(127) << 23);
    let power = (1.0 + f * p) * scale;
    if normal { power } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use whitted::{Exact, Math};

    use super::powers;

    #[test]
    fn powers_are_those_of_the_scalar_code() {
        let bases = (0..=4096).map(|i| i as f32 / 4096.0).chain([
            1.000_001,
            1.5,
            1e-30,
            1e-40,
            f32::NAN,
            f32::INFINITY,
            -0.0,
        ]);
        for base in bases {
            for exponents in [
                [0.0, 1.0, 2.0, 3.0827, 50.0, 0.5, 16_777_216.0, 1e-9],
                [7.0, 8.0, 200.0, 3.0, 1e9, 77.0, 1.0, 5.0],
                [0.1, 1.9, 2.5, 99.5, 1e10, 333.3, 999.5, f32::NAN],
            ] {
                let expected = exponents.map(|n| Exact::powf(base, n).to_bits());
                let found = powers(&[base; 8], &exponents).map(f32::to_bits);
                for lane in 0..8 {
                    let both = [found, expected].map(|it| f32::from_bits(it[lane]));
                    assert!(
                        found[lane] == expected[lane] || both.iter().all(|it| it.is_nan()),
                        "{base} to {}: {both:?}",
                        exponents[lane]
                    );
                }
            }
        }
    }
}
