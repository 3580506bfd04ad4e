//! Quadrics by their polynomials.

use glam::{DMat3, DVec3};

use super::shape::quadratic;

/// All points q from the center with q·(matrix q) + 2 linear·q + constant = 0 that lie behind all planes;
/// of a solid, also the parts of the planes where that is negative.
#[derive(Clone, Debug)]
pub struct Quadric {
    /// In world space.
    pub center: DVec3,
    /// Symmetric.
    pub matrix: DMat3,
    /// Half of the coefficients of x, y and z.
    pub linear: DVec3,
    /// The constant.
    pub constant: f64,
    /// Normals and distances from the center.
    pub planes: Vec<(DVec3, f64)>,
    /// Whether it is a solid.
    pub closed: bool,
    /// Lowest and highest corner of a box round it, unless it is endless.
    pub extent: Option<(DVec3, DVec3)>,
}

/// How far off a point that was computed to lie on a surface may be, as a share of its size.
const ON: f64 = 1e-9;

impl Quadric {
    /// All points whose distance from the axis, squared, is `squared[0] + 2 squared[1] s + squared[2] s²`
    /// where they are s along it from the center.
    pub fn of_revolution(center: DVec3, axis: DVec3, squared: [f64; 3]) -> Self {
        let along = DMat3::from_cols(axis * axis.x, axis * axis.y, axis * axis.z);
        Self {
            center,
            matrix: DMat3::IDENTITY - along * (1.0 + squared[2]),
            linear: axis * -squared[1],
            constant: -squared[0],
            planes: Vec::new(),
            closed: false,
            extent: None,
        }
    }

    fn value(&self, q: DVec3) -> f64 {
        q.dot(self.matrix * q) + 2.0 * self.linear.dot(q) + self.constant
    }

    /// Where a line meets the quadric, and where the planes of a solid.
    pub(super) fn roots(&self, origin: DVec3, direction: DVec3) -> Vec<f64> {
        let q = origin - self.center;
        let image = self.matrix * direction;
        let b = image.dot(q) + self.linear.dot(direction);
        let of_quadric = quadratic(image.dot(direction), b, self.value(q));
        let mut roots: Vec<_> = of_quadric.into_iter().flatten().collect();
        if self.closed {
            let to_plane = |(normal, distance): &(DVec3, f64)| {
                let approach = normal.dot(direction);
                (approach != 0.0).then(|| (distance - normal.dot(q)) / approach)
            };
            roots.extend(self.planes.iter().filter_map(to_plane));
        }
        roots
    }

    /// The plane on which a point of the surface is; none for one on the quadric itself.
    fn plane(&self, q: DVec3) -> Option<DVec3> {
        if !self.closed {
            return None;
        }
        let gradient = 2.0 * (self.matrix * q + self.linear);
        let off_quadric = self.value(q).abs() / gradient.length();
        let off = |it: &&(DVec3, f64)| (it.0.dot(q) - it.1).abs();
        let nearest = self
            .planes
            .iter()
            .min_by(|a, b| off(a).total_cmp(&off(b)))?;
        (off(&nearest) < off_quadric).then_some(nearest.0)
    }

    /// Whether a point where a line meets the quadric or a plane is on the surface.
    pub(super) fn has(&self, point: DVec3) -> bool {
        let q = point - self.center;
        let on = ON * (q.length() + self.center.length());
        let plane = self.plane(q);
        let is_behind =
            |it: &(DVec3, f64)| it.0.dot(q) <= it.1 + if Some(it.0) == plane { on } else { 0.0 };
        self.planes.iter().all(is_behind) && (plane.is_none() || self.value(q) <= 0.0)
    }

    /// Whether a point is inside of the solid.
    pub(super) fn contains(&self, point: DVec3) -> bool {
        let q = point - self.center;
        self.value(q) < 0.0 && self.planes.iter().all(|it| it.0.dot(q) < it.1)
    }

    /// The outward unit normal.
    pub(super) fn normal(&self, point: DVec3) -> DVec3 {
        let q = point - self.center;
        let across = self.plane(q);
        across.unwrap_or_else(|| (self.matrix * q + self.linear).normalize())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_answers() {
        // x² + z² = 1 + y² / 4, from -2 to 1.
        let mut barrel = Quadric::of_revolution(DVec3::ZERO, DVec3::Y, [1.0, 0.0, 0.25]);
        barrel.planes = vec![(DVec3::Y, 1.0), (DVec3::NEG_Y, 2.0)];
        let solid = Quadric {
            closed: true,
            ..barrel.clone()
        };
        let meets = |quadric: &Quadric, origin: [f64; 3], direction: DVec3| -> Vec<f64> {
            let origin = DVec3::from(origin);
            let mut roots = quadric.roots(origin, direction);
            roots.retain(|&t| quadric.has(origin + direction * t));
            roots.sort_by(f64::total_cmp);
            roots
        };
        assert_eq!(meets(&barrel, [-3.0, 0.0, 0.0], DVec3::X), [2.0, 4.0]);
        assert_eq!(meets(&barrel, [-3.0, 1.5, 0.0], DVec3::X), [0.0; 0]);
        assert_eq!(meets(&barrel, [0.5, 5.0, 0.0], DVec3::NEG_Y), [0.0; 0]);
        assert_eq!(meets(&solid, [0.5, 5.0, 0.0], DVec3::NEG_Y), [4.0, 7.0]);
        assert_eq!(meets(&solid, [2.0, 5.0, 0.0], DVec3::NEG_Y), [0.0; 0]);
        assert_eq!(solid.normal(DVec3::new(0.5, 1.0, 0.0)), DVec3::Y);
        assert_eq!(barrel.normal(DVec3::new(1.0, 0.0, 0.0)), DVec3::X);
    }
}
