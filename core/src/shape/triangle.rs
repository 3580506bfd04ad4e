//! Flat triangles.

use glam::Vec3;

use super::polygon::{Axis, PolygonError, crosses, differ, distance, newell, x, y};
use super::{Shape, mapping};
use crate::math::Math;
use crate::ray::{Ray, Side};

/// Three vertices, stored in place, where a [`Polygon`](crate::Polygon) borrows them.
///
/// Judged by the same test as polygons: meshes of both are watertight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// In world space.
    pub vertices: [Vec3; 3],
    /// Unit length; the side on which the vertices run counterclockwise.
    pub normal: Vec3,
}

impl Triangle {
    /// A triangle with the normal of its plane.
    ///
    /// # Errors
    ///
    /// Where a vertex is not finite or the triangle has no area.
    pub fn new(vertices: [Vec3; 3]) -> Result<Self, PolygonError> {
        let normal = newell(&vertices)?;
        Ok(Self { vertices, normal })
    }
}

/// Distance to the plane of a triangle where the ray passes within its outline.
#[inline(never)]
pub(super) fn intersect(ray: &Ray, axis: Axis, vertices: &[Vec3; 3], normal: Vec3) -> Option<f32> {
    if meets(ray, axis, vertices) {
        distance(ray, axis, vertices, normal)
    } else {
        None
    }
}

/// As for an outline of any length: where not all corners lie on one side of the x axis, the edges that
/// cross it are those of the corner that is alone on its side.
#[inline(always)]
fn meets(ray: &Ray, depth: Axis, vertices: &[Vec3; 3]) -> bool {
    // Most rays that miss are told by y alone; what follows needs no code of its own for each axis.
    let [a, b, c] = depth.apart(|depth| vertices.each_ref().map(|it| (it, y(ray, depth, it))));
    let (alone, first, second) = match (differ(a.1, b.1), differ(b.1, c.1)) {
        (false, false) => return false,
        (false, true) => (c, a, b),
        (true, false) => (a, b, c),
        (true, true) => (b, c, a),
    };
    let alone = (x(ray, depth, alone.0), alone.1);
    let first = (x(ray, depth, first.0), first.1);
    let second = (x(ray, depth, second.0), second.1);
    crosses(alone, first) != crosses(alone, second)
}

impl Shape for Triangle {
    type Setup = Axis;

    #[inline(always)]
    fn setup(ray: &Ray) -> Axis {
        Axis::along(ray)
    }

    #[inline]
    fn intersect<P: Math>(&self, ray: &Ray, &axis: &Axis, leaving: Option<Side>) -> Option<f32> {
        if leaving.is_some() {
            return None;
        }
        intersect(ray, axis, &self.vertices, self.normal)
    }

    /// How much of the second and of the third vertex is in the point.
    #[inline]
    fn uv(&self, point: Vec3) -> (f32, f32) {
        mapping::barycentric(&self.vertices, point)
    }

    #[inline(always)]
    fn normal<P: Math>(&self, _: &Ray, _: f32) -> Vec3 {
        self.normal
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Exact;
    use crate::shape::polygon::Polygon;

    #[test]
    fn an_edge_along_the_scan_line_is_on_one_side_of_it_whatever_the_signs_of_zero() {
        let ray = Ray::new(Vec3::ZERO, Vec3::new(0.0, -0.0, -1.0));
        for zero in [0.0, -0.0] {
            let beside = [(3.0, 0.0), (5.0, 1.0), (7.0, zero)].map(|(x, y)| Vec3::new(x, y, -5.0));
            let triangle = Triangle::new(beside).unwrap();
            let axis = Triangle::setup(&ray);
            assert_eq!(triangle.intersect::<Exact>(&ray, &axis, None), None);
            let polygon = Polygon::new(&beside).unwrap();
            assert_eq!(polygon.intersect::<Exact>(&ray, &axis, None), None);
        }
    }

    #[test]
    fn a_triangle_is_the_polygon_of_its_vertices() {
        let vertices = [
            Vec3::new(0.1, 0.2, -3.0),
            Vec3::new(2.3, -0.4, -4.1),
            Vec3::new(0.7, 1.9, -5.2),
        ];
        let triangle = Triangle::new(vertices).unwrap();
        let polygon = Polygon::new(&vertices).unwrap();
        assert_eq!(triangle.normal, polygon.normal);
        let mut hits = 0;
        for i in 0..4096 {
            let direction = Exact::normalize(Vec3::new(
                (i % 64) as f32 * 0.015,
                (i / 64) as f32 * 0.01,
                -1.0,
            ));
            let ray = Ray::new(Vec3::ZERO, direction);
            let setup = Triangle::setup(&ray);
            let t = triangle.intersect::<Exact>(&ray, &setup, None);
            assert_eq!(t, polygon.intersect::<Exact>(&ray, &setup, None));
            hits += t.is_some() as u32;
        }
        assert!((100..4000).contains(&hits), "{hits} hits say nothing");
    }

    #[test]
    fn slivers_are_kept_and_lines_refused() {
        let sliver = [Vec3::ZERO, Vec3::X, Vec3::new(0.5, 1e-7, 0.0)];
        assert_eq!(Triangle::new(sliver).unwrap().normal, Vec3::Z);
        assert_eq!(
            Triangle::new([Vec3::ZERO, Vec3::X, Vec3::X * 2.0]),
            Err(PolygonError::ZeroArea)
        );
    }
}
