//! Exact intersections with a torus.
//!
//! With `q` from the center, along the ray, a torus is where `(|q|² + R² - r²)² = 4 R² (|q|² - (q·axis)²)`,
//! all numbers, and the length of the axis, taken as they are: a polynomial of degree four. How many of its
//! roots lie ahead is counted by Sturm's theorem in exact arithmetic; where they are, in `f64`.

use std::cmp::Ordering;

use super::number::{Exact, Number, Vector};
use super::{Line, U, along, difference, dot, wide};

/// A torus as it is.
#[derive(Clone, Copy, Debug)]
pub struct Torus {
    /// Of the circle.
    pub center: [f32; 3],
    /// About unit length.
    pub axis: [f32; 3],
    /// Of the circle.
    pub major: f32,
    /// Of the tube.
    pub minor: f32,
}

/// Coefficients, the constant first.
type Polynomial = Vec<Exact>;

/// The quartic along a ray, from its origin.
fn quartic(ray: &Line, torus: &Torus) -> Polynomial {
    let d = Vector::<Exact>::new(ray.direction);
    let q = Vector::new(ray.origin).minus(&Vector::new(torus.center));
    let axis = Vector::new(torus.axis);
    let [major, minor] = [torus.major, torus.minor].map(Exact::new);
    let major_squared = major.clone() * major;
    let two = || Exact::new(2.0);
    // |q|² and |q|² - (q·axis)², each quadratic along the ray.
    let square = [q.square(), two() * q.dot(&d), d.square()];
    let (height, rate) = (q.dot(&axis), d.dot(&axis));
    let across = [
        square[0].clone() - height.clone() * height.clone(),
        square[1].clone() - two() * height * rate.clone(),
        square[2].clone() - rate.clone() * rate,
    ];
    let mut sum = square;
    sum[0] = sum[0].clone() + major_squared.clone() - minor.clone() * minor;
    let mut quartic = vec![Exact::new(0.0); 5];
    for i in 0..3 {
        for j in 0..3 {
            quartic[i + j] = quartic[i + j].clone() + sum[i].clone() * sum[j].clone();
        }
        let share = Exact::new(4.0) * major_squared.clone() * across[i].clone();
        quartic[i] = quartic[i].clone() - share;
    }
    quartic
}

fn is_zero(x: &Exact) -> bool {
    x.sign() == Some(Ordering::Equal)
}

/// Without leading zeros.
fn trimmed(mut polynomial: Polynomial) -> Polynomial {
    while polynomial.last().is_some_and(is_zero) {
        polynomial.pop();
    }
    polynomial
}

/// How often the signs of a sequence change, zeros left out.
fn changes<'a>(numbers: impl Iterator<Item = &'a Exact>) -> usize {
    let signs: Vec<_> = numbers
        .filter(|it| !is_zero(it))
        .map(Number::sign)
        .collect();
    signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
}

/// How many points of the torus are ahead of the origin; one that is touched counts once.
pub fn count(ray: &Line, torus: &Torus) -> usize {
    let quartic = trimmed(quartic(ray, torus));
    // A root at the origin itself is not ahead.
    let zeros = quartic.iter().take_while(|it| is_zero(it)).count();
    let quartic = quartic[zeros.min(quartic.len())..].to_vec();
    if quartic.len() < 2 {
        return 0;
    }
    let derivative = (1_u8..).zip(&quartic[1..]);
    let derivative = derivative.map(|(power, it)| Exact::new(power.into()) * it.clone());
    let mut chain = vec![quartic.clone(), trimmed(derivative.collect())];
    // Negative remainders, each times a number above zero, which changes no sign.
    while let [.., dividend, divisor] = chain.as_slice() {
        let mut rest = dividend.clone();
        let leading = divisor.last().expect("not zero").clone();
        let positive = match leading.sign() {
            Some(Ordering::Less) => -leading.clone(),
            _ => leading.clone(),
        };
        while rest.len() >= divisor.len() {
            let factor = rest.last().expect("not empty").clone();
            let factor = if leading.sign() == Some(Ordering::Less) {
                -factor
            } else {
                factor
            };
            let shift = rest.len() - divisor.len();
            rest = rest.into_iter().map(|it| it * positive.clone()).collect();
            for (place, it) in divisor.iter().enumerate() {
                rest[shift + place] = rest[shift + place].clone() - factor.clone() * it.clone();
            }
            rest.pop();
            rest = trimmed(rest);
        }
        if rest.is_empty() {
            break;
        }
        chain.push(rest.into_iter().map(|it| -it).collect());
    }
    let at_zero = changes(chain.iter().map(|it| &it[0]));
    let at_infinity = changes(chain.iter().filter_map(|it| it.last()));
    at_zero - at_infinity
}

/// Distance from the surface at `t`, and by how much u of the inputs changes it.
fn offset(ray: &Line, torus: &Torus, t: f64) -> (f64, f64) {
    let axis = wide(torus.axis);
    let q = along(difference(ray.origin, torus.center), wide(ray.direction), t);
    let height = dot(q, axis);
    let across = along(q, axis, -height);
    let radius = dot(across, across).sqrt();
    let (major, minor) = (f64::from(torus.major), f64::from(torus.minor));
    let outward = if radius > 0.0 {
        across.map(|x| x / radius)
    } else {
        [0.0; 3]
    };
    let from_circle = (radius - major).hypot(height);
    let normal =
        along(outward.map(|x| x * (radius - major)), axis, height).map(|x| x / from_circle);
    let (o, d, c) = (wide(ray.origin), wide(ray.direction), wide(torus.center));
    let reach: f64 = (0..3)
        .map(|i| {
            let arm = o[i].abs() + (t * d[i]).abs() + c[i].abs() + (height * axis[i]).abs();
            normal[i].abs() * arm
        })
        .sum();
    let in_plane = ((radius - major) / from_circle).abs();
    (from_circle - minor, U * (reach + in_plane * major + minor))
}

/// Backward error of a distance, in u.
pub fn residual(ray: &Line, torus: &Torus, t: f64) -> f64 {
    let (offset, scale) = offset(ray, torus, t);
    offset.abs() / scale
}

/// Signed: below zero in the tube.
fn depth(ray: &Line, torus: &Torus, t: f64) -> f64 {
    let (offset, scale) = offset(ray, torus, t);
    offset / scale
}

/// How far from the surface, in u, the ray is where it comes closest or goes deepest: the least change of the
/// inputs that may change how many points it meets; the origin's own distance included.
pub fn least_margin(ray: &Line, torus: &Torus) -> f64 {
    let d = wide(ray.direction);
    let approach = -dot(difference(ray.origin, torus.center), d) / dot(d, d);
    let reach = 1.1 * (f64::from(torus.major) + f64::from(torus.minor)) / dot(d, d).sqrt();
    const STEPS: usize = 4000;
    let at = |i: usize| approach + reach * (2.0 * i as f64 / STEPS as f64 - 1.0);
    let mut least = residual(ray, torus, 0.0);
    for i in 1..STEPS {
        let [a, b, c] = [i - 1, i, i + 1].map(|i| depth(ray, torus, at(i)));
        if (b <= a && b <= c) || (b >= a && b >= c) {
            // A ternary search for the extreme.
            let (mut low, mut high) = (at(i - 1), at(i + 1));
            let sign = if b <= a { 1.0 } else { -1.0 };
            for _ in 0..80 {
                let (x, y) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
                if sign * depth(ray, torus, x) < sign * depth(ray, torus, y) {
                    high = y;
                } else {
                    low = x;
                }
            }
            least = least.min(depth(ray, torus, 0.5 * (low + high)).abs());
        }
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;

    const RING: Torus = Torus {
        center: [0.0; 3],
        axis: [0.0, 1.0, 0.0],
        major: 2.0,
        minor: 0.5,
    };

    #[test]
    fn known_counts() {
        let ray = |origin, direction| Line { origin, direction };
        let (x, down) = ([1.0, 0.0, 0.0], [0.0, -1.0, 0.0]);
        let cases = [
            ("across", ray([-5.0, 0.0, 0.0], x), 4),
            ("from the center", ray([0.0; 3], x), 2),
            ("on top, touching twice", ray([-5.0, 0.5, 0.0], x), 2),
            (
                "a step over the top",
                ray([-5.0, 0.5 + f32::EPSILON / 2.0, 0.0], x),
                0,
            ),
            (
                "a step under the top",
                ray([-5.0, 0.5 - f32::EPSILON / 4.0, 0.0], x),
                4,
            ),
            ("down through the tube", ray([2.0, 5.0, 0.0], down), 2),
            ("down through the hole", ray([0.0, 5.0, 0.0], down), 0),
            ("past the rim, touching", ray([2.5, 5.0, 0.0], down), 1),
            ("from the rim", ray([2.5, 0.0, 0.0], x), 0),
            (
                "from the rim, inward",
                ray([2.5, 0.0, 0.0], [-1.0, 0.0, 0.0]),
                3,
            ),
        ];
        for (name, ray, expected) in cases {
            assert_eq!(count(&ray, &RING), expected, "{name}");
        }
    }

    #[test]
    fn errors_are_counted_in_roundings_of_the_inputs() {
        let ray = Line {
            origin: [-5.0, 0.0, 0.0],
            direction: [1.0, 0.0, 0.0],
        };
        // |o| + |t d| + major + minor = 5 + 2.5 + 2 + 0.5.
        let residual = residual(&ray, &RING, 2.5 * (1.0 + 4.0 * U));
        assert!((residual - 1.0).abs() < 1e-3, "{residual}");
    }
}
