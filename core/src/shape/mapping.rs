//! Coordinates on surfaces.

use core::f32::consts::PI;

use glam::Vec3;

use crate::math::{dot, length_squared, sqrt};

/// Two unit vectors along a plane: to the right and upwards for who looks at its outward side. The first is
/// level, that is, without y. Of a floor, on which nothing is upwards, the second leads along -z.
#[inline]
pub(super) fn tangents(normal: Vec3) -> (Vec3, Vec3) {
    let level = Vec3::new(normal.z, 0.0, -normal.x);
    let square = length_squared(&level);
    let right = if square > 0.0 {
        level * (1.0 / sqrt(square))
    } else {
        Vec3::X
    };
    (right, normal.cross(right))
}

/// Of a point in the plane through another.
#[inline]
pub(super) fn flat(from_point: Vec3, normal: Vec3) -> (f32, f32) {
    let (right, up) = tangents(normal);
    (dot(&from_point, &right), dot(&from_point, &up))
}

/// The angle round an axis as a share of a full turn, from 0 to 1, and how far from the axis that is. It
/// grows to the right for who looks from outside, the axis upwards; 1/2 is opposite of where the second of
/// the axis's [`tangents`] leads: towards +z if the axis is y.
#[inline]
pub(super) fn around(from_axis: Vec3, axis: Vec3) -> (f32, f32) {
    let (right, back) = tangents(axis);
    // Not a negation: on the axis itself both are zero, and of no sign.
    let (x, z) = (dot(&from_axis, &right), 0.0 - dot(&from_axis, &back));
    (turn(x, z), sqrt(x * x + z * z))
}

/// The angle between (0, 1) and (`x`, `y`) as a share of a full turn, plus 1/2.
#[inline]
pub(super) fn turn(x: f32, y: f32) -> f32 {
    0.5 + libm::atan2f(x, y) * (0.5 / PI)
}

/// How much of the second and of the third vertex is in a point of a triangle.
#[inline]
pub(super) fn barycentric(vertices: &[Vec3; 3], point: Vec3) -> (f32, f32) {
    let [a, b, c] = vertices;
    let (along, across, from) = (*b - *a, *c - *a, point - *a);
    let normal = along.cross(across);
    let recip = 1.0 / length_squared(&normal);
    (
        dot(&from.cross(across), &normal) * recip,
        dot(&along.cross(from), &normal) * recip,
    )
}

#[cfg(test)]
mod tests {
    use crate::math::{Exact, Math};
    use crate::ray::{Ray, Side};
    use crate::shape::Shape;
    use crate::shape::cuboid::Cuboid;
    use crate::shape::frustum::Frustum;
    use crate::shape::plane::Plane;
    use crate::shape::polygon::Polygon;
    use crate::shape::quadric::{Ends, Quadric};
    use crate::shape::sphere::Sphere;
    use crate::shape::torus::Torus;
    use crate::shape::triangle::Triangle;

    use super::*;

    const UP: Vec3 = Vec3::new(0.0, 2.0, 0.0);
    const BALL: Sphere = Sphere {
        center: Vec3::ZERO,
        radius: 2.0,
    };
    const DIE: Cuboid = Cuboid {
        min: Vec3::ZERO,
        max: Vec3::splat(4.0),
    };
    const FLOOR: Plane = Plane {
        point: Vec3::ZERO,
        normal: Vec3::Y,
    };

    fn check(name: &str, shape: &impl Shape, point: [f32; 3], uv: (f32, f32)) {
        let found = shape.uv(Vec3::from_array(point));
        let off = (found.0 - uv.0).abs().max((found.1 - uv.1).abs());
        assert!(off < 1e-6, "{name} {point:?}: {found:?}, not {uv:?}");
    }

    #[test]
    fn shapes_say_where_a_point_lies_on_them() {
        let cases = [
            ([0.0, 0.0, 2.0], (0.5, 0.5)),
            ([2.0, 0.0, 0.0], (0.75, 0.5)),
            ([-2.0, 0.0, 0.0], (0.25, 0.5)),
            ([0.0, 0.0, -2.0], (1.0, 0.5)),
            // Just beside the seam, and the poles.
            ([-1e-9, 0.0, -2.0], (0.0, 0.5)),
            ([0.0, 2.0, 0.0], (0.5, 1.0)),
            ([0.0, -2.0, 0.0], (0.5, 0.0)),
            ([0.0, 2.0_f32.sqrt(), 2.0_f32.sqrt()], (0.5, 0.75)),
        ];
        for (point, uv) in cases {
            check("sphere", &BALL, point, uv);
        }
        check("floor", &FLOOR, [3.0, 0.0, -7.0], (3.0, 7.0));
        let wall = Plane {
            point: Vec3::ONE,
            normal: Vec3::Z,
        };
        check("wall", &wall, [3.0, 5.0, 1.0], (2.0, 4.0));
        let cases = [
            ([4.0, 1.0, 3.0], (0.25, 0.25)),
            ([0.0, 1.0, 3.0], (0.75, 0.25)),
            ([1.0, 4.0, 1.0], (0.25, 0.75)),
            ([1.0, 0.0, 1.0], (0.25, 0.25)),
            ([1.0, 3.0, 4.0], (0.25, 0.75)),
            ([1.0, 3.0, 0.0], (0.75, 0.75)),
        ];
        for (point, uv) in cases {
            check("box", &DIE, point, uv);
        }
        let corners = [Vec3::ZERO, Vec3::X * 2.0, UP];
        let triangle = Triangle::new(corners).unwrap();
        check("triangle", &triangle, [0.5, 1.0, 0.0], (0.25, 0.5));
        let polygon = Polygon::new(&corners).unwrap();
        check("polygon", &polygon, [0.5, 1.0, 0.0], (0.5, 1.0));
        let can = Quadric::cylinder(Vec3::ZERO, UP, 1.0, Ends::Closed).unwrap();
        check("cylinder", &can, [1.0, 0.5, 0.0], (0.75, 0.25));
        let egg = Quadric::ellipsoid(Vec3::ZERO, Vec3::new(1.0, 2.0, 1.0)).unwrap();
        check("ellipsoid", &egg, [0.0, 2.0, 0.0], (0.5, 1.0));
        let bucket = Frustum::new(Vec3::ZERO, 1.0, UP, 2.0).unwrap();
        check("frustum", &bucket, [0.0, 1.0, 1.5], (0.5, 0.5));
        let ring = Torus::new(Vec3::ZERO, UP, 2.0, 0.5).unwrap();
        check("torus", &ring, [2.5, 0.0, 0.0], (0.75, 0.5));
        check("torus", &ring, [0.0, 0.5, 2.0], (0.5, 0.75));
    }

    #[test]
    fn coordinates_of_nowhere_are_no_surprise() {
        for x in [f32::NAN, f32::INFINITY, 0.0] {
            let point = Vec3::new(x, x, -x);
            let _ = (BALL.uv(point), DIE.uv(point), FLOOR.uv(point));
            let plane = Plane {
                point,
                normal: point,
            };
            let _ = plane.uv(Vec3::ONE);
        }
        let flat = Polygon {
            vertices: &[],
            normal: Vec3::Y,
        };
        assert_eq!(flat.uv(Vec3::ONE), (0.0, 0.0));
    }

    fn inside(shape: &impl Shape, ray: &Ray, leaving: Option<Side>) -> f32 {
        fn by<S: Shape, P: Math>(shape: &S, ray: &Ray, leaving: Option<Side>) -> f32 {
            shape.inside::<P>(ray, &S::setup(ray), leaving)
        }
        by::<_, Exact>(shape, ray, leaving)
    }

    #[test]
    fn solids_know_how_long_a_ray_is_in_them() {
        use Side::{Inside, Outside};
        let die = Cuboid {
            min: Vec3::splat(-2.0),
            max: Vec3::splat(2.0),
        };
        let can = Quadric::cylinder(-UP, UP, 2.0, Ends::Closed).unwrap();
        let pipe = Quadric::cylinder(-UP, UP, 2.0, Ends::Open).unwrap();
        let ring = Torus::new(Vec3::ZERO, UP, 2.0, 0.5).unwrap();
        let infinity = f32::INFINITY;
        // From a height on the axis down, as far as an end.
        let cases = [
            (5.0, infinity, None, [4.0, 4.0, 4.0, infinity]),
            (5.0, 4.0, None, [1.0, 1.0, 1.0, 0.0]),
            (5.0, 1.0, None, [0.0; 4]),
            (1.0, infinity, None, [3.0, 3.0, 3.0, infinity]),
            (1.0, 0.5, None, [0.5, 0.5, 0.5, 0.0]),
            (-5.0, 3.0, None, [0.0, 0.0, 0.0, 3.0]),
            (2.0, infinity, Some(Inside), [4.0, 4.0, 4.0, infinity]),
            (2.0, 1.5, Some(Inside), [1.5; 4]),
            (-2.0, infinity, Some(Outside), [0.0; 4]),
        ];
        for (y, t_max, leaving, expected) in cases {
            let ray = Ray {
                t_max,
                ..Ray::new(Vec3::Y * y, Vec3::NEG_Y)
            };
            let found = [
                inside(&BALL, &ray, leaving),
                inside(&die, &ray, leaving),
                inside(&can, &ray, leaving),
                inside(&FLOOR, &ray, leaving),
            ];
            assert_eq!(found, expected, "{y} {t_max} {leaving:?}");
            // Through the open ends light comes and goes unnoticed.
            if leaving.is_none() {
                assert_eq!(inside(&pipe, &ray, leaving), 0.0);
            }
        }
        let across = |t_max| Ray {
            t_max,
            ..Ray::new(Vec3::X * 5.0, Vec3::NEG_X)
        };
        let cases = [(9.0, 2.0), (6.0, 1.0), (2.75, 0.25), (7.25, 1.75)];
        for (t_max, expected) in cases {
            let found = inside(&ring, &across(t_max), None);
            assert!((found - expected).abs() < 1e-5, "{t_max}: {found}");
        }
        assert_eq!(inside(&pipe, &across(9.0), None), 4.0);
        let hollow = Sphere {
            radius: -2.0,
            ..BALL
        };
        assert_eq!(inside(&hollow, &across(9.0), None), 0.0);
        assert_eq!(inside(&FLOOR, &Ray::new(Vec3::NAN, Vec3::Y), None), 0.0);
    }
}
