//! The exact way of a ray over a grid of cells of 1 by 1, seen from above: along x and z.
//!
//! A ray through a corner or along a border is that ray shifted by (ε, ε²): by a distance towards +x
//! that is smaller than any number, and by its square towards +z.

use std::cmp::Ordering;

use super::number::{Exact, Number};
use super::{Line, U, first_sure};

/// The axes that count.
const X: usize = 0;
const Z: usize = 2;

/// The cell of a point that is on the map, where coordinates are not negative.
pub fn cell(point: [f32; 3]) -> [u32; 2] {
    // A shift towards + leaves points on a border where rounding down has put them.
    [point[X] as u32, point[Z] as u32]
}

/// Whether the ray meets the border across x at `borders[0]` before the one across z at `borders[1]`.
/// Both lie ahead of it; what it runs along is never met.
pub fn is_x_first(ray: &Line, borders: [u32; 2]) -> bool {
    let direction = ray.direction[X];
    if direction == 0.0 || ray.direction[Z] == 0.0 {
        return direction != 0.0;
    }
    match first_sure!(compare(ray, borders)) {
        Ordering::Less => true,
        Ordering::Greater => false,
        // A shift towards +x by ε brings borders nearer if the ray goes there; ε² along z is nothing
        // against that.
        Ordering::Equal => direction > 0.0,
    }
}

/// Orders the distances (x - ox) / dx and (z - oz) / dz without a division.
fn compare<N: Number>(ray: &Line, borders: [u32; 2]) -> Option<Ordering> {
    let [x, z] = sides::<N>(ray, borders);
    (x - z).sign()
}

/// `|x - ox| |dz|` and `|z - oz| |dx|`.
fn sides<N: Number>(ray: &Line, borders: [u32; 2]) -> [N; 2] {
    let ahead = |axis: usize, border: u32| {
        let distance = N::new(border as f32) - N::new(ray.origin[axis]);
        if ray.direction[axis] < 0.0 {
            -distance
        } else {
            distance
        }
    };
    [
        ahead(X, borders[0]) * N::new(ray.direction[Z].abs()),
        ahead(Z, borders[1]) * N::new(ray.direction[X].abs()),
    ]
}

/// By what relative change of the ray and the borders they would be met in the other order, in u.
pub fn band(ray: &Line, borders: [u32; 2]) -> f64 {
    let [x, z] = sides::<Exact>(ray, borders);
    let gap = (x - z).value().unwrap_or(f64::INFINITY).abs();
    let reach = |axis: usize, border: u32| {
        let (origin, border) = (f64::from(ray.origin[axis]), f64::from(border));
        origin.abs() + border + (border - origin).abs()
    };
    let [dx, dz] = [X, Z].map(|axis| f64::from(ray.direction[axis]).abs());
    gap / (U * (reach(X, borders[0]) * dz + reach(Z, borders[1]) * dx))
}

/// Backward error, in u, of a distance to a border across an axis, 0 or 2.
pub fn residual(ray: &Line, axis: usize, border: u32, t: f32) -> f64 {
    let (origin, border) = (f64::from(ray.origin[axis]), f64::from(border));
    let way = f64::from(t) * f64::from(ray.direction[axis]);
    (origin - border + way).abs() / (U * (origin.abs() + way.abs() + border))
}

/// All cells of a map of `size` that the ray is in, one after the other, until it leaves the map.
pub fn cells(ray: &Line, size: [u32; 2]) -> Vec<[u32; 2]> {
    let mut cell = cell(ray.origin);
    let mut cells = vec![cell];
    let [dx, dz] = [X, Z].map(|axis| ray.direction[axis]);
    if dx == 0.0 && dz == 0.0 {
        return cells;
    }
    loop {
        let borders = [cell[0] + u32::from(dx > 0.0), cell[1] + u32::from(dz > 0.0)];
        let axis = usize::from(!is_x_first(ray, borders));
        let next = cell[axis].wrapping_add_signed(if [dx, dz][axis] > 0.0 { 1 } else { -1 });
        if next >= size[axis] {
            return cells;
        }
        cell[axis] = next;
        cells.push(cell);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_ways() {
        let ray = |x, z, dx, dz| Line {
            origin: [x, 0.0, z],
            direction: [dx, 0.0, dz],
        };
        let cases = [
            (
                "diagonal",
                ray(0.5, 0.5, 1.0, 1.0),
                vec![[0, 0], [1, 0], [1, 1], [2, 1], [2, 2]],
            ),
            (
                "back",
                ray(2.5, 2.5, -1.0, -1.0),
                vec![[2, 2], [2, 1], [1, 1], [1, 0], [0, 0]],
            ),
            (
                "along a border",
                ray(1.0, 0.5, 0.0, 1.0),
                vec![[1, 0], [1, 1], [1, 2]],
            ),
            (
                "off a border",
                ray(1.0, 0.5, -1.0, 0.0),
                vec![[1, 0], [0, 0]],
            ),
            // The corner at (1, 1) is missed by less than any f32 of its size tells.
            (
                "through a far corner",
                ray(1.0 - 2.0_f32.powi(-24), 0.0, 2.0_f32.powi(-24), 1.0),
                vec![[0, 0], [1, 0], [1, 1], [1, 2]],
            ),
            (
                "past it",
                ray(1.0 - 2.0_f32.powi(-24), 0.0, 0.999 * 2.0_f32.powi(-24), 1.0),
                vec![[0, 0], [0, 1], [1, 1], [1, 2]],
            ),
        ];
        for (name, ray, expected) in cases {
            assert_eq!(cells(&ray, [3, 3]), expected, "{name}");
        }
    }
}
