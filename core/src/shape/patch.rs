//! Triangles shaded as if they were curved.

use core::fmt;

use glam::{Vec2, Vec3};

use super::polygon::{Axis, PolygonError, newell, x, y};
use super::triangle;
use super::{Shape, mapping};
use crate::math::{self, Math, length_squared};
use crate::ray::{Ray, Side};

/// A triangle with a normal at each vertex, interpolated in between: B. T. Phong's shading,
/// "Illumination for Computer Generated Pictures", CACM 18(6), 1975.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// In world space.
    pub vertices: [Vec3; 3],
    /// Unit length, one a vertex; they say which side is outward.
    pub normals: [Vec3; 3],
    /// Unit normal of the vertices' plane, either way round.
    pub normal: Vec3,
}

/// Why some vertices and normals are not a [`Patch`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PatchError {
    /// The vertices are not a triangle.
    Outline(PolygonError),
    /// The normal of this vertex, counted from 0, is zero or not finite.
    Normal(usize),
}

impl fmt::Display for PatchError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Outline(error) => error.fmt(f),
            Self::Normal(vertex) => {
                write!(
                    f,
                    "the normal of vertex {vertex} (from 0) is zero or not finite"
                )
            }
        }
    }
}

impl core::error::Error for PatchError {}

impl Patch {
    /// A patch. The normals need not have unit length.
    ///
    /// # Errors
    ///
    /// Where a vertex is not finite, the triangle has no area, or a normal has no direction.
    pub fn new(vertices: [Vec3; 3], normals: [Vec3; 3]) -> Result<Self, PatchError> {
        let normal = newell(&vertices).map_err(PatchError::Outline)?;
        let mut units = normals;
        for (index, unit) in units.iter_mut().enumerate() {
            let (_, direction) =
                math::unit(math::difference(*unit, Vec3::ZERO)).ok_or(PatchError::Normal(index))?;
            *unit = direction;
        }
        Ok(Self {
            vertices,
            normals: units,
            normal,
        })
    }
}

/// Where the vertices are as seen along the ray, to its scale.
#[inline(always)]
fn seen(ray: &Ray, depth: Axis, vertices: &[Vec3; 3]) -> [Vec2; 3] {
    vertices
        .each_ref()
        .map(|vertex| Vec2::new(x(ray, depth, vertex), y(ray, depth, vertex)))
}

impl Shape for Patch {
    type Setup = Axis;

    #[inline]
    fn setup(ray: &Ray) -> Axis {
        Axis::along(ray)
    }

    #[inline]
    fn intersect<P: Math>(&self, ray: &Ray, &axis: &Axis, leaving: Option<Side>) -> Option<f32> {
        if leaving.is_some() {
            return None;
        }
        triangle::intersect(ray, axis, &self.vertices, self.normal)
    }

    /// How much of the second and of the third vertex is in the point.
    #[inline]
    fn uv(&self, point: Vec3) -> (f32, f32) {
        mapping::barycentric(&self.vertices, point)
    }

    #[inline]
    fn normal<P: Math>(&self, ray: &Ray, _: f32) -> Vec3 {
        let vertices = &self.vertices;
        let [a, b, c] = Axis::along(ray).apart(|axis| seen(ray, axis, vertices));
        // Twice the areas opposite the vertices, all of one sign within the outline.
        let weights = [b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)];
        let sum = weights[0] + weights[1] + weights[2];
        let blend = self.normals[0] * (weights[0] / sum)
            + self.normals[1] * (weights[1] / sum)
            + self.normals[2] * (weights[2] / sum);
        let square = length_squared(&blend);
        // Also false for NaN: a patch seen edge-on, or normals that cancel.
        if square > 0.0 && square < f32::INFINITY {
            blend * P::sqrt_and_recip(square).1
        } else {
            self.normal
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Exact;

    const CORNERS: [Vec3; 3] = [Vec3::ZERO, Vec3::X, Vec3::Y];

    #[test]
    fn normals_are_interpolated_between_the_vertices() {
        let normals = [Vec3::Z, Vec3::new(3.0, 0.0, 4.0), Vec3::new(0.0, 3.0, 4.0)];
        let patch = Patch::new(CORNERS, normals).unwrap();
        let near_corner = |x, y| {
            let ray = Ray::new(Vec3::new(x, y, 2.0), Vec3::NEG_Z);
            let t = patch
                .intersect::<Exact>(&ray, &Patch::setup(&ray), None)
                .unwrap();
            patch.normal::<Exact>(&ray, t)
        };
        let cases = [
            ("first", near_corner(0.000_01, 0.000_01), Vec3::Z),
            (
                "second",
                near_corner(0.999_98, 0.000_01),
                Vec3::new(0.6, 0.0, 0.8),
            ),
            (
                "third",
                near_corner(0.000_01, 0.999_98),
                Vec3::new(0.0, 0.6, 0.8),
            ),
            (
                "middle",
                near_corner(0.5, 0.499_999),
                Exact::normalize(Vec3::new(0.3, 0.3, 0.8)),
            ),
        ];
        for (name, normal, expected) in cases {
            assert!(
                (normal - expected).length() < 1e-4,
                "{name}: {normal} for {expected}"
            );
            assert!((normal.length() - 1.0).abs() < 1e-6, "{name}");
        }
    }

    #[test]
    fn normals_that_cancel_leave_the_plane_s_own() {
        let patch = Patch::new(CORNERS, [Vec3::X, Vec3::NEG_X, Vec3::NEG_X]).unwrap();
        let ray = Ray::new(Vec3::new(0.25, 0.25, 1.0), Vec3::NEG_Z);
        assert_eq!(patch.normal::<Exact>(&ray, 1.0), Vec3::Z);
    }

    #[test]
    fn degenerate_patches_are_refused() {
        let normals = [Vec3::Z; 3];
        assert_eq!(
            Patch::new([Vec3::ZERO, Vec3::X, Vec3::X * 2.0], normals),
            Err(PatchError::Outline(PolygonError::ZeroArea))
        );
        assert_eq!(
            Patch::new(CORNERS, [Vec3::Z, Vec3::ZERO, Vec3::Z]),
            Err(PatchError::Normal(1))
        );
    }
}
