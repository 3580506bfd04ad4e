//! Exact intersections with a sphere that is placed by an affine map.
//!
//! With A the adjugate of the map's matrix, D its determinant and c the translation, the ray meets the
//! sphere where `|A (o - c) + t A d - D center| = |D radius|`: no inverse is needed, and nothing is rounded.

use super::number::{Number, Vector};
use super::sphere::{along_line, margins_along};
use super::{Line, Margins, Truth, U, cross, difference, dot, first_sure, wide};

/// An affine map as it is.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    /// To what the axes become.
    pub axes: [[f32; 3]; 3],
    /// To where the origin goes.
    pub translation: [f32; 3],
}

/// The nearest point of the placed sphere in front of the origin; touching counts.
pub fn truth(ray: &Line, placement: &Placement, center: [f32; 3], radius: f32) -> Truth {
    first_sure!(solve(ray, placement, center, radius))
}

fn solve<N: Number>(
    ray: &Line,
    placement: &Placement,
    center: [f32; 3],
    radius: f32,
) -> Option<Truth> {
    let [a, b, c] = placement.axes.map(Vector::<N>::new);
    let rows = [b.cross(&c), c.cross(&a), a.cross(&b)];
    let determinant = a.dot(&rows[0]);
    let turned = |v: &Vector<N>| Vector([rows[0].dot(v), rows[1].dot(v), rows[2].dot(v)]);
    let origin = Vector::new(ray.origin).minus(&Vector::new(placement.translation));
    let d = turned(&Vector::new(ray.direction));
    let f = Vector::new(center)
        .times(&determinant)
        .minus(&turned(&origin));
    along_line(d, f, determinant * N::new(radius))
}

/// The rows of the inverse.
fn inverse(placement: &Placement) -> [[f64; 3]; 3] {
    let [a, b, c] = placement.axes.map(wide);
    let rows = [cross(b, c), cross(c, a), cross(a, b)];
    let determinant = dot(a, rows[0]);
    rows.map(|row| row.map(|x| x / determinant))
}

/// How far the point at a distance is off the sphere, in the sphere's space, in u of the greatest of its
/// coordinates there and of the sums that make them.
pub fn residual(ray: &Line, placement: &Placement, center: [f32; 3], radius: f32, t: f64) -> f64 {
    let inverse = inverse(placement);
    let (o, d, place, center) = (
        wide(ray.origin),
        wide(ray.direction),
        wide(placement.translation),
        wide(center),
    );
    let local: [f64; 3] = std::array::from_fn(|i| {
        let at = |j: usize| (o[j] - place[j]) + t * d[j];
        (0..3).map(|j| inverse[i][j] * at(j)).sum::<f64>() - center[i]
    });
    let length = dot(local, local).sqrt();
    let radius = f64::from(radius).abs();
    let reach = (0..3)
        .map(|i| {
            let size = |j: usize| o[j].abs() + place[j].abs() + (t * d[j]).abs();
            let moved: f64 = (0..3).map(|j| inverse[i][j].abs() * size(j)).sum();
            moved + center[i].abs()
        })
        .fold(0.0, f64::max);
    (length - radius).abs() / (U * (reach + radius))
}

/// How far the ray is from meeting the sphere otherwise, as [`residual`] counts.
pub fn margins(ray: &Line, placement: &Placement, center: [f32; 3], radius: f32) -> Margins {
    let inverse = inverse(placement);
    let turned = |v: [f64; 3]| inverse.map(|row| dot(row, v));
    let origin = turned(difference(ray.origin, placement.translation));
    let center_there = wide(center);
    let f = std::array::from_fn(|i| center_there[i] - origin[i]);
    margins_along(turned(wide(ray.direction)), f, radius, |t| {
        residual(ray, placement, center, radius, t)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_answers() {
        let ray = |origin, direction| Line { origin, direction };
        let map = |axes, translation| Placement { axes, translation };
        let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
        let flat = map([[2.0, 0.0, 0.0], y, [0.0, 0.0, 0.25]], [0.0, 0.0, -5.0]);
        let mirrored = map([y, x, z], [0.0; 3]);
        let down = |x| ray([x, 0.0, 0.0], [0.0, 0.0, -1.0]);
        let cases = [
            ("thin", down(0.0), flat, Some(4.75)),
            ("touched", down(2.0), flat, Some(5.0)),
            ("passed", down(2.0 + f32::EPSILON * 2.0), flat, None),
            (
                "mirrored",
                ray([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]),
                mirrored,
                Some(2.0),
            ),
        ];
        for (name, ray, map, t) in cases {
            truth(&ray, &map, [0.0; 3], 1.0).assert_is(t, false, name);
            if let Some(t) = t {
                assert!(residual(&ray, &map, [0.0; 3], 1.0, t) < 1e-6, "{name}");
                // A change of 100 u of the distance is less of the inputs, but not none.
                let off = residual(&ray, &map, [0.0; 3], 1.0, t * (1.0 + 100.0 * U));
                assert!((name == "touched") == (off < 1.0), "{name}: {off}");
            }
        }
    }
}
