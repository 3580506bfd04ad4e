//! Tori by their quartic.

use glam::DVec3;

/// Where a line meets a torus; `origin` is seen from the center.
pub(crate) fn roots(
    origin: DVec3,
    direction: DVec3,
    axis: DVec3,
    major: f64,
    minor: f64,
) -> Vec<f64> {
    // From the closest approach, and in units of the major radius, so that powers of t are of one size.
    let shift = -origin.dot(direction) / direction.length_squared();
    let q = (origin + direction * shift) / major;
    let (height, climb) = (q.dot(axis), direction.dot(axis));
    let tube = minor / major;
    // (|p|² + 1 - tube²)² = 4 (|p|² - height²) at p = q + t direction.
    let square = [
        q.length_squared(),
        2.0 * q.dot(direction),
        direction.length_squared(),
    ];
    let across = [
        square[0] - height * height,
        square[1] - 2.0 * height * climb,
        square[2] - climb * climb,
    ];
    let sum = [square[0] + 1.0 - tube * tube, square[1], square[2]];
    let mut quartic = [0.0; 5];
    for i in 0..3 {
        for j in 0..3 {
            quartic[i + j] += sum[i] * sum[j];
        }
        quartic[i] -= 4.0 * across[i];
    }
    let found = real_roots(&quartic, 4.0);
    found.into_iter().map(|t| shift + t * major).collect()
}

/// The real roots within `limit` of a polynomial, the constant first: between two extremes there is one at
/// most, and halving finds it.
fn real_roots(polynomial: &[f64], limit: f64) -> Vec<f64> {
    if polynomial.len() < 2 {
        return Vec::new();
    }
    let derivative: Vec<_> = (1..polynomial.len())
        .map(|i| polynomial[i] * i as f64)
        .collect();
    let at = |t: f64| polynomial.iter().rev().fold(0.0, |sum, x| sum * t + x);
    let mut places = vec![-limit];
    places.extend(real_roots(&derivative, limit));
    places.push(limit);
    let mut roots = Vec::new();
    for pair in places.windows(2) {
        let (mut low, mut high) = (pair[0], pair[1]);
        if (at(low) < 0.0) == (at(high) < 0.0) {
            continue;
        }
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if (at(middle) < 0.0) == (at(low) < 0.0) {
                low = middle;
            } else {
                high = middle;
            }
        }
        roots.push(low);
    }
    roots
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_answers() {
        let meets = |origin: [f64; 3], direction: DVec3| -> Vec<f64> {
            roots(DVec3::from(origin), direction, DVec3::Y, 2.0, 0.5)
        };
        for (found, expected) in [
            (meets([-5.0, 0.0, 0.0], DVec3::X), &[2.5, 3.5, 6.5, 7.5][..]),
            (meets([2.0, 5.0, 0.0], DVec3::NEG_Y), &[4.5, 5.5]),
            (meets([0.5, 5.0, 0.0], DVec3::NEG_Y), &[]),
            (meets([-5.0, 0.6, 0.0], DVec3::X), &[]),
        ] {
            assert_eq!(found.len(), expected.len(), "{found:?}");
            for (t, expected) in found.iter().zip(expected) {
                assert!((t - expected).abs() < 1e-12, "{found:?}");
            }
        }
    }
}
