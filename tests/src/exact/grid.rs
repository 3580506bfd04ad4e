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
/// What it runs along is never met.
pub fn is_x_first(ray: &Line, borders: [f32; 2]) -> bool {
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
fn compare<N: Number>(ray: &Line, borders: [f32; 2]) -> Option<Ordering> {
    let [x, z] = sides::<N>(ray, borders);
    (x - z).sign()
}

/// `|x - ox| |dz|` and `|z - oz| |dx|`.
fn sides<N: Number>(ray: &Line, borders: [f32; 2]) -> [N; 2] {
    let ahead = |axis: usize, border: f32| {
        let distance = N::new(border) - N::new(ray.origin[axis]);
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
pub fn band(ray: &Line, borders: [f32; 2]) -> f64 {
    let [x, z] = sides::<Exact>(ray, borders);
    let gap = (x - z).value().unwrap_or(f64::INFINITY).abs();
    let reach = |axis: usize, border: f32| {
        let (origin, border) = (f64::from(ray.origin[axis]), f64::from(border));
        origin.abs() + border + (border - origin).abs()
    };
    let [dx, dz] = [X, Z].map(|axis| f64::from(ray.direction[axis]).abs());
    gap / (U * (reach(X, borders[0]) * dz + reach(Z, borders[1]) * dx))
}

/// Backward error, in u, of a distance to a border across an axis, 0 or 2.
pub fn residual(ray: &Line, axis: usize, border: f32, t: f32) -> f64 {
    let (origin, border) = (f64::from(ray.origin[axis]), f64::from(border));
    let way = f64::from(t) * f64::from(ray.direction[axis]);
    (origin - border + way).abs() / (U * (origin.abs() + way.abs() + border))
}

/// Those on which the ray leaves a cell, if it does not run along them.
pub fn borders_ahead(ray: &Line, cell: [u32; 2]) -> [f32; 2] {
    [0, 1].map(|i| cell[i] as f32 + f32::from(u8::from(ray.direction[[X, Z][i]] > 0.0)))
}

/// A door's panel in the middle of its cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Panel {
    /// Its cell.
    pub cell: [u32; 2],
    /// What it stands across: 0 for x, 1 for z.
    pub across: usize,
    /// The share of its width that is open, from the west or the north on.
    pub open: f32,
}

impl Panel {
    /// Whether the ray meets it: a ray that is in its cell, which it has entered over a border across x (0)
    /// or z (1), or where it starts.
    pub fn is_met(&self, ray: &Line, entered: Option<usize>) -> bool {
        let axis = [X, Z][self.across];
        let (origin, direction) = (ray.origin[axis], ray.direction[axis]);
        let middle = self.cell[self.across] as f32 + 0.5;
        let is_ahead = match entered {
            // Shifted towards +.
            None if direction > 0.0 => origin < middle,
            None => origin >= middle,
            Some(across) => across == self.across || !self.is_before(ray, self.borders(ray)[0]),
        };
        direction != 0.0
            && is_ahead
            && self.is_before(ray, self.borders(ray)[1])
            && (self.open <= 0.0 || (self.open < 1.0 && first_sure!(is_beside(ray, self))))
    }

    /// Across the other axis: on which its cell is entered, and left.
    fn borders(&self, ray: &Line) -> [f32; 2] {
        let ahead = borders_ahead(ray, self.cell)[1 - self.across];
        [2.0 * self.cell[1 - self.across] as f32 + 1.0 - ahead, ahead]
    }

    /// Whether the ray meets its plane before a border across the other axis.
    fn is_before(&self, ray: &Line, border: f32) -> bool {
        is_x_first(ray, self.and(border)) == (self.across == 0)
    }

    /// Its plane, and a border across the other axis, that across x first.
    fn and(&self, border: f32) -> [f32; 2] {
        let mut borders = [border; 2];
        borders[self.across] = self.cell[self.across] as f32 + 0.5;
        borders
    }

    /// By what relative change of all numbers it would be met or not, or elsewhere, in u.
    pub fn band(&self, ray: &Line) -> f64 {
        let [axis, along] = [[X, Z][self.across], [X, Z][1 - self.across]];
        let corners = self.borders(ray).map(|it| band(ray, self.and(it)));
        let edge = edge::<Exact>(ray, self)
            .value()
            .unwrap_or(f64::INFINITY)
            .abs();
        let [from, to] = [axis, along].map(|axis| f64::from(ray.origin[axis]).abs());
        let [dx, dz] = [axis, along].map(|axis| f64::from(ray.direction[axis]).abs());
        let [x, z] = [self.across, 1 - self.across].map(|it| f64::from(self.cell[it]) + 1.0);
        let edge = edge / (U * ((to + z) * dx + (from + x) * dz));
        corners.into_iter().fold(edge, f64::min)
    }
}

/// Whether the ray passes the plane of a panel beyond its edge.
fn is_beside<N: Number>(ray: &Line, panel: &Panel) -> Option<bool> {
    Some(edge::<N>(ray, panel).sign()? != Ordering::Less)
}

/// How far from the edge the ray passes the plane, in units of the direction across it.
fn edge<N: Number>(ray: &Line, panel: &Panel) -> N {
    let [axis, along] = [[X, Z][panel.across], [X, Z][1 - panel.across]];
    let [origin, start] = [axis, along].map(|axis| N::new(ray.origin[axis]));
    let [direction, slope] = [axis, along].map(|axis| ray.direction[axis]);
    let low = N::new(panel.cell[1 - panel.across] as f32);
    let middle = N::new(panel.cell[panel.across] as f32 + 0.5);
    let way = (middle - origin) * N::new(if direction < 0.0 { -slope } else { slope });
    (start - low - N::new(panel.open)) * N::new(direction.abs()) + way
}

/// The first wall or panel that a ray meets which starts in no wall, and what it looks across: 0 for x, 1
/// for z.
pub fn first(
    ray: &Line,
    size: [u32; 2],
    is_solid: impl Fn([u32; 2]) -> bool,
    panel: impl Fn([u32; 2]) -> Option<Panel>,
) -> Option<([u32; 2], usize)> {
    let mut last: Option<[u32; 2]> = None;
    for cell in cells(ray, size) {
        let entered = last.map(|last| usize::from(last[0] == cell[0]));
        if let Some(entered) = entered
            && is_solid(cell)
        {
            return Some((cell, entered));
        }
        if let Some(panel) = panel(cell)
            && panel.is_met(ray, entered)
        {
            return Some((cell, panel.across));
        }
        last = Some(cell);
    }
    None
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
        let axis = usize::from(!is_x_first(ray, borders_ahead(ray, cell)));
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

    #[test]
    fn known_panels() {
        let ray = |x, z, dx, dz| Line {
            origin: [x, 0.0, z],
            direction: [dx, 0.0, dz],
        };
        let panel = |across, open| Panel {
            cell: [1, 1],
            across,
            open,
        };
        let least = 2.0_f32.powi(-24);
        let cases = [
            (
                "ahead",
                panel(0, 0.0),
                ray(0.5, 1.25, 1.0, 0.0),
                Some(0),
                true,
            ),
            (
                "not in the other way",
                panel(1, 0.0),
                ray(0.5, 1.25, 1.0, 0.0),
                Some(0),
                false,
            ),
            (
                "its edge",
                panel(0, 0.25),
                ray(0.5, 1.25, 1.0, 0.0),
                Some(0),
                true,
            ),
            (
                "past it",
                panel(0, 0.25),
                ray(0.5, 1.25, 1.0, -least),
                Some(0),
                false,
            ),
            (
                "on it",
                panel(0, 0.25),
                ray(0.5, 1.25, 1.0, least),
                Some(0),
                true,
            ),
            (
                "open",
                panel(0, 1.0),
                ray(0.5, 1.25, 1.0, 0.0),
                Some(0),
                false,
            ),
            (
                "from within",
                panel(0, 0.0),
                ray(1.5, 1.25, -1.0, 0.0),
                None,
                true,
            ),
            (
                "from within, behind",
                panel(0, 0.0),
                ray(1.5, 1.25, 1.0, 0.0),
                None,
                false,
            ),
            (
                "into its end",
                panel(0, 0.0),
                ray(1.0, 1.5, 1.0, 1.0),
                None,
                true,
            ),
            (
                "into its end, back",
                panel(0, 0.0),
                ray(2.0, 1.5, -1.0, 1.0),
                None,
                false,
            ),
            (
                "beside its end",
                panel(0, 0.0),
                ray(1.0, 1.5, 1.0, 1.0 + 2.0 * least),
                None,
                false,
            ),
            (
                "passed before",
                panel(0, 0.0),
                ray(1.0, 0.25, 1.0, 1.0),
                Some(1),
                false,
            ),
            (
                "and not",
                panel(0, 0.0),
                ray(1.0, 0.75, 1.0, 1.0),
                Some(1),
                true,
            ),
        ];
        for (name, panel, ray, entered, is_met) in cases {
            assert_eq!(panel.is_met(&ray, entered), is_met, "{name}");
        }
    }
}
