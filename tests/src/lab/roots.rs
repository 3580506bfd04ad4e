//! Roots, unit vectors and powers: errors of a result, in u of it or in steps of an 8-bit channel.

use whitted::Vec3;
use whitted_methods::{power, roots};

use super::random::Random;
use super::sweep::{Stage, Sweep};
use crate::exact::{U, Verdict};

/// Square roots.
pub struct Sqrt;
/// Reciprocals of square roots.
pub struct Rsqrt;
/// Unit vectors.
pub struct Normalize;
/// Powers with whole exponents.
pub struct WholePower;
/// Powers with real exponents.
pub struct RealPower;

fn verdict(error: f64) -> Verdict {
    // What is not finite is a wrong answer.
    Verdict {
        backward: error,
        forward: error,
        wrong: (!error.is_finite()).then_some(f64::INFINITY),
    }
}

/// Numbers from 2^x to 2^(x+1), and those below the normal ones.
fn numbers() -> Vec<Sweep<f32>> {
    let draw = |x: f64, random: &mut Random| (random.between(1.0, 2.0) * x.exp2()) as f32;
    let normal = [-126.0, -64.0, -20.0, 0.0, 20.0, 64.0, 127.0];
    let axis = "log2 of the number";
    vec![
        Sweep::new("size", axis, &normal, draw),
        Sweep::new("size, extreme", axis, &[-148.0, -140.0, -127.0], draw),
    ]
}

fn relative(result: f32, exact: f64) -> Verdict {
    verdict((f64::from(result) - exact).abs() / (exact * U))
}

impl Stage for Sqrt {
    const NAME: &'static str = "sqrt";
    type Case = f32;

    fn sweeps() -> Vec<Sweep<f32>> {
        numbers()
    }

    fn methods() -> Vec<&'static str> {
        roots::SQRT.iter().map(|method| method.name).collect()
    }

    fn ask(&x: &f32, judged: &mut dyn FnMut(usize, Verdict)) {
        for (i, method) in roots::SQRT.iter().enumerate() {
            judged(i, relative((method.run)(x), f64::from(x).sqrt()));
        }
    }
}

impl Stage for Rsqrt {
    const NAME: &'static str = "rsqrt";
    type Case = f32;

    fn sweeps() -> Vec<Sweep<f32>> {
        numbers()
    }

    fn methods() -> Vec<&'static str> {
        roots::RSQRT.iter().map(|method| method.name).collect()
    }

    fn ask(&x: &f32, judged: &mut dyn FnMut(usize, Verdict)) {
        for (i, method) in roots::RSQRT.iter().enumerate() {
            judged(i, relative((method.run)(x), 1.0 / f64::from(x).sqrt()));
        }
    }
}

impl Stage for Normalize {
    const NAME: &'static str = "normalize";
    type Case = Vec3;

    fn sweeps() -> Vec<Sweep<Vec3>> {
        let direction = |x: f64, random: &mut Random| {
            let length = x.exp2() * random.between(1.0, 2.0);
            (random.direction() * length).round()
        };
        let inside = [-60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0];
        // Where squares leave the range of f32.
        let outside = [-140.0, -100.0, -75.0, -70.0, 64.0, 70.0, 100.0, 126.0];
        vec![
            Sweep::new("length", "log2 of the length", &inside, direction),
            Sweep::new("length, extreme", "log2 of the length", &outside, direction),
        ]
    }

    fn methods() -> Vec<&'static str> {
        roots::NORMALIZE.iter().map(|method| method.name).collect()
    }

    /// The distance from the exact unit vector, in u.
    fn ask(&v: &Vec3, judged: &mut dyn FnMut(usize, Verdict)) {
        let exact = v.to_array().map(f64::from);
        let length = exact.iter().map(|x| x * x).sum::<f64>().sqrt();
        for (i, method) in roots::NORMALIZE.iter().enumerate() {
            let unit = (method.run)(v).to_array().map(f64::from);
            let square: f64 = (0..3).map(|i| (unit[i] - exact[i] / length).powi(2)).sum();
            judged(i, verdict(square.sqrt() / U));
        }
    }
}

/// Bases from 0 to 1, dense near 1, where a large exponent has its highlight.
fn powers(exponents: &[f64]) -> Vec<Sweep<(f32, f32)>> {
    let draw = |x: f64, random: &mut Random| ((1.0 - random.unit().powi(3)) as f32, x as f32);
    vec![Sweep::new("exponent", "exponent", exponents, draw)]
}

/// The error in steps of an 8-bit channel.
fn steps(result: f32, (x, n): (f32, f32)) -> Verdict {
    verdict((f64::from(result) - f64::from(x).powf(f64::from(n))).abs() * 255.0)
}

impl Stage for WholePower {
    const NAME: &'static str = "power";
    type Case = (f32, f32);

    fn sweeps() -> Vec<Sweep<Self::Case>> {
        powers(&[1.0, 2.0, 5.0, 10.0, 50.0, 100.0, 333.0, 1000.0])
    }

    fn methods() -> Vec<&'static str> {
        power::WHOLE.iter().map(|method| method.name).collect()
    }

    fn ask(&case: &Self::Case, judged: &mut dyn FnMut(usize, Verdict)) {
        for (i, method) in power::WHOLE.iter().enumerate() {
            judged(i, steps((method.run)(case.0, case.1), case));
        }
    }
}

impl Stage for RealPower {
    const NAME: &'static str = "power, real";
    type Case = (f32, f32);

    fn sweeps() -> Vec<Sweep<Self::Case>> {
        powers(&[0.5, 1.5, 3.0827, 9.99, 50.5, 99.5, 333.3, 999.5])
    }

    fn methods() -> Vec<&'static str> {
        power::REAL.iter().map(|method| method.name).collect()
    }

    fn ask(&case: &Self::Case, judged: &mut dyn FnMut(usize, Verdict)) {
        for (i, method) in power::REAL.iter().enumerate() {
            judged(i, steps((method.run)(case.0, case.1), case));
        }
    }
}
