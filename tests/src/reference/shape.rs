//! The primitives, each by its textbook equation.

use glam::{DVec2, DVec3};

use super::quadric::Quadric;
use super::solid::{Part, Placed};
use super::torus;

/// A surface.
#[derive(Clone, Debug)]
pub enum Shape {
    /// All points at `radius` from `center`; of a negative radius, only the inside is visible, and it
    /// counts as the outward side.
    Sphere {
        /// In world space.
        center: DVec3,
        /// In world units.
        radius: f64,
    },
    /// An endless plane.
    Plane {
        /// Any point of it.
        point: DVec3,
        /// Outward; any length.
        normal: DVec3,
    },
    /// A planar outline, filled by the even-odd rule.
    Polygon {
        /// In order; counterclockwise seen from outside.
        vertices: Vec<DVec3>,
    },
    /// A triangle whose normal is interpolated.
    Patch {
        /// The corners.
        vertices: [DVec3; 3],
        /// The normal at each corner.
        normals: [DVec3; 3],
    },
    /// An axis-aligned box.
    Cuboid {
        /// Lowest corner.
        min: DVec3,
        /// Highest corner.
        max: DVec3,
    },
    /// An open cylinder or cone; of negative radii, only the inside is visible, and it counts as the
    /// outward side.
    Frustum {
        /// Centre of one end.
        base: DVec3,
        /// Centre of the other end.
        apex: DVec3,
        /// Radius at the base.
        base_radius: f64,
        /// Radius at the apex.
        apex_radius: f64,
    },
    /// A surface of degree two.
    Quadric(Quadric),
    /// Any shape, moved.
    Placed(Placed),
    /// A leaf of a solid.
    Part(Part),
    /// All points at `minor` from a circle.
    Torus {
        /// Of the circle.
        center: DVec3,
        /// Across the circle, unit length.
        axis: DVec3,
        /// Of the circle.
        major: f64,
        /// Of the tube.
        minor: f64,
    },
}

use Shape::{Cuboid, Frustum, Patch, Plane, Polygon, Sphere, Torus};

impl Shape {
    /// Where the line `origin + t direction` meets the surface, in any order.
    ///
    /// If the line starts on the surface, `leaving` it, the root that stands for the start is left
    /// out: the one nearest to 0, whatever rounding made of it.
    pub fn crossings(
        &self,
        origin: DVec3,
        direction: DVec3,
        leaving: bool,
    ) -> std::vec::IntoIter<f64> {
        let mut roots = match self {
            Shape::Placed(placed) => {
                return Vec::into_iter(placed.crossings(origin, direction, leaving));
            }
            Shape::Part(part) => {
                return Vec::into_iter(part.crossings(origin, direction, leaving));
            }
            Shape::Quadric(quadric) => quadric.roots(origin, direction),
            Torus {
                center,
                axis,
                major,
                minor,
            } => torus::roots(origin - *center, direction, *axis, *major, *minor),
            _ => self
                .roots(origin, direction)
                .into_iter()
                .flatten()
                .collect(),
        };
        if leaving {
            let distances = roots.iter().map(|root| root.abs()).enumerate();
            if let Some((nearest, _)) = distances.min_by(|a, b| a.1.total_cmp(&b.1)) {
                roots.remove(nearest);
            }
        }
        let visible = |&t: &f64| {
            self.bounds_contain(origin, direction, t)
                && (!self.shows_inside_only()
                    || direction.dot(self.normal(origin, direction, t)) < 0.0)
        };
        roots.retain(visible);
        roots.into_iter()
    }

    /// Roots of the equation of the whole sphere, plane, box or cone, before it is cut to size.
    fn roots(&self, origin: DVec3, direction: DVec3) -> [Option<f64>; 2] {
        match *self {
            Sphere { center, radius } => {
                let offset = origin - center;
                let c = offset.length_squared() - radius * radius;
                quadratic(direction.length_squared(), offset.dot(direction), c)
            }
            Plane { point, .. } => [plane(point, self.outward(), origin, direction), None],
            Polygon { ref vertices } => {
                [plane(vertices[0], self.outward(), origin, direction), None]
            }
            Patch { vertices, .. } => [plane(vertices[0], self.outward(), origin, direction), None],
            Cuboid { min, max } => slabs(min, max, origin, direction),
            Frustum { base, .. } => {
                // In the frame of the axis: distance from it squared = radius squared.
                let (axis, _, slope) = self.axis();
                let offset = origin - base;
                let height = offset.dot(axis);
                let climb = direction.dot(axis);
                let across = offset - height * axis;
                let drift = direction - climb * axis;
                let radius = self.base_radius() + slope * height;
                let growth = slope * climb;
                quadratic(
                    drift.length_squared() - growth * growth,
                    across.dot(drift) - growth * radius,
                    across.length_squared() - radius * radius,
                )
            }
            Shape::Quadric(_) | Torus { .. } | Shape::Placed(_) | Shape::Part(_) => {
                unreachable!("may have more than two")
            }
        }
    }

    /// Whether a root of the whole equation is on the part that exists.
    fn bounds_contain(&self, origin: DVec3, direction: DVec3, t: f64) -> bool {
        let point = origin + t * direction;
        match self {
            Sphere { .. } | Plane { .. } | Cuboid { .. } | Torus { .. } => true,
            Shape::Placed(_) | Shape::Part(_) => true,
            Polygon { vertices } => inside_outline(vertices, self.outward(), point),
            Patch { vertices, .. } => inside_outline(vertices, self.outward(), point),
            Frustum { base, .. } => {
                let (axis, length, _) = self.axis();
                (0.0..=length).contains(&(point - base).dot(axis))
            }
            Shape::Quadric(quadric) => quadric.has(point),
        }
    }

    /// The outward unit normal where the line meets the surface at `t`.
    pub fn normal(&self, origin: DVec3, direction: DVec3, t: f64) -> DVec3 {
        let point = origin + t * direction;
        let turn = if self.shows_inside_only() { -1.0 } else { 1.0 };
        match *self {
            Sphere { center, .. } => turn * (point - center).normalize(),
            Plane { .. } | Polygon { .. } => self.outward(),
            Patch {
                vertices: [a, b, c],
                normals,
            } => {
                // Areas of the parts opposite to each corner, over the whole.
                let whole = (b - a).cross(c - a);
                let share = |p: DVec3, q: DVec3| {
                    (p - point).cross(q - point).dot(whole) / whole.length_squared()
                };
                let normal =
                    share(b, c) * normals[0] + share(c, a) * normals[1] + share(a, b) * normals[2];
                normal.normalize()
            }
            Cuboid { min, max } => {
                // The face that is nearest, in units of the box's size.
                let scaled = (2.0 * point - (min + max)) / (max - min).max(DVec3::splat(1e-300));
                let magnitude = scaled.abs();
                let axis = if magnitude.x >= magnitude.y && magnitude.x >= magnitude.z {
                    DVec3::X
                } else if magnitude.y >= magnitude.z {
                    DVec3::Y
                } else {
                    DVec3::Z
                };
                axis * scaled.dot(axis).signum()
            }
            Frustum { base, .. } => {
                let (axis, _, slope) = self.axis();
                let offset = point - base;
                let across = (offset - offset.dot(axis) * axis).normalize();
                turn * (across - slope * axis).normalize()
            }
            Shape::Quadric(ref quadric) => quadric.normal(point),
            Shape::Placed(ref placed) => placed.normal(origin, direction, t),
            Shape::Part(ref part) => part.normal(origin, direction, t),
            Torus {
                center,
                axis,
                major,
                ..
            } => {
                let q = point - center;
                let across = (q - q.dot(axis) * axis).normalize();
                (q - across * major).normalize()
            }
        }
    }

    /// Whether a point is inside of a closed shape.
    pub fn contains(&self, point: DVec3) -> bool {
        match self {
            Sphere { center, radius } => center.distance(point) < *radius,
            Plane { point: on, .. } => self.outward().dot(point - on) < 0.0,
            Cuboid { min, max } => min.cmplt(point).all() && point.cmplt(*max).all(),
            Shape::Quadric(quadric) => quadric.contains(point),
            Torus {
                center,
                axis,
                major,
                minor,
            } => {
                let q = point - center;
                let along = q.dot(*axis);
                let off = (q - along * axis).length() - major;
                off * off + along * along < minor * minor
            }
            _ => unreachable!("has no inside"),
        }
    }

    /// Whether it has an inside, in which light can weaken.
    pub fn is_solid(&self) -> bool {
        match self {
            Sphere { .. } => !self.shows_inside_only(),
            Plane { .. } | Cuboid { .. } | Torus { .. } | Shape::Quadric(_) => true,
            // Of the leaves of a solid none has one of its own.
            _ => false,
        }
    }

    /// Whether a ray that does not meet the surface is inside all the way, `leaving` it or not.
    pub fn is_beyond(&self, origin: DVec3, direction: DVec3, leaving: bool) -> bool {
        match *self {
            Plane { normal, .. } if leaving => direction.dot(normal) < 0.0,
            Plane { point, normal } => (origin - point).dot(normal) < 0.0,
            _ => false,
        }
    }

    /// Corners of the smallest box round the surface; nothing for a plane.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let around = |points: &[DVec3], radius: f64| {
            let low = points.iter().copied().reduce(DVec3::min)?;
            let high = points.iter().copied().reduce(DVec3::max)?;
            Some((low - radius, high + radius))
        };
        match self {
            Sphere { center, radius } => around(&[*center], radius.abs()),
            Plane { .. } => None,
            Polygon { vertices } => around(vertices, 0.0),
            Patch { vertices, .. } => around(vertices, 0.0),
            Cuboid { min, max } => around(&[*min, *max], 0.0),
            Frustum {
                base,
                apex,
                base_radius,
                apex_radius,
            } => around(&[*base, *apex], base_radius.abs().max(apex_radius.abs())),
            Shape::Quadric(quadric) => quadric.extent,
            Shape::Placed(placed) => placed.bounds(),
            Shape::Part(part) => part.bounds(),
            Torus {
                center,
                major,
                minor,
                ..
            } => around(&[*center], major + minor),
        }
    }

    /// The unit normal of a flat shape, by Newell's sum over the edges of its outline.
    fn outward(&self) -> DVec3 {
        match self {
            Plane { normal, .. } => normal.normalize(),
            Polygon { vertices } => newell(vertices),
            Patch { vertices, .. } => newell(vertices),
            _ => unreachable!("not flat"),
        }
    }

    /// Unit axis, length and radius gained per unit of length of a frustum.
    fn axis(&self) -> (DVec3, f64, f64) {
        let Frustum {
            base,
            apex,
            base_radius,
            apex_radius,
        } = *self
        else {
            unreachable!("not a frustum")
        };
        let length = base.distance(apex);
        (
            (apex - base) / length,
            length,
            (apex_radius.abs() - base_radius.abs()) / length,
        )
    }

    fn base_radius(&self) -> f64 {
        match self {
            Frustum { base_radius, .. } => base_radius.abs(),
            _ => unreachable!("not a frustum"),
        }
    }

    fn shows_inside_only(&self) -> bool {
        match *self {
            Sphere { radius, .. } => radius < 0.0,
            Frustum {
                base_radius,
                apex_radius,
                ..
            } => base_radius.min(apex_radius) < 0.0,
            _ => false,
        }
    }
}

/// Real roots of a t² + 2 b t + c, without the cancellation of the schoolbook formula: Press et
/// al., Numerical Recipes, "Quadratic and Cubic Equations".
pub(super) fn quadratic(a: f64, b: f64, c: f64) -> [Option<f64>; 2] {
    let discriminant = b * b - a * c;
    if discriminant < 0.0 {
        return [None, None];
    }
    let q = -(b + discriminant.sqrt().copysign(b));
    [(a != 0.0).then(|| q / a), (q != 0.0).then(|| c / q)]
}

/// Where a line meets a plane, unless it is parallel to it.
fn plane(point: DVec3, normal: DVec3, origin: DVec3, direction: DVec3) -> Option<f64> {
    let approach = normal.dot(direction);
    (approach != 0.0).then(|| normal.dot(point - origin) / approach)
}

/// Where a line enters and leaves the space between three pairs of planes.
fn slabs(min: DVec3, max: DVec3, origin: DVec3, direction: DVec3) -> [Option<f64>; 2] {
    let mut enter = f64::NEG_INFINITY;
    let mut leave = f64::INFINITY;
    for axis in 0..3 {
        let (low, high) = (min[axis] - origin[axis], max[axis] - origin[axis]);
        if direction[axis] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return [None, None];
            }
            continue;
        }
        let (a, b) = (low / direction[axis], high / direction[axis]);
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    if enter > leave {
        [None, None]
    } else {
        [Some(enter), Some(leave)]
    }
}

/// Unit normal of an outline: the components are the areas of its three projections.
fn newell(vertices: &[DVec3]) -> DVec3 {
    let next = vertices.iter().cycle().skip(1);
    let areas = vertices
        .iter()
        .zip(next)
        .map(|(&a, &b)| (a - vertices[0]).cross(b - vertices[0]));
    areas.sum::<DVec3>().normalize()
}

/// Whether a point of its plane is inside an outline: a half-line from it crosses the outline an
/// odd number of times, looking along the axis nearest to the normal.
fn inside_outline(vertices: &[DVec3], normal: DVec3, point: DVec3) -> bool {
    let size = normal.abs();
    let flatten = |v: DVec3| {
        let v = v - point;
        if size.x >= size.y && size.x >= size.z {
            DVec2::new(v.y, v.z)
        } else if size.y >= size.z {
            DVec2::new(v.z, v.x)
        } else {
            DVec2::new(v.x, v.y)
        }
    };
    let next = vertices.iter().cycle().skip(1);
    let crossed = vertices.iter().zip(next).filter(|&(&a, &b)| {
        let (a, b) = (flatten(a), flatten(b));
        // Half-open, so that a vertex on the half-line counts once.
        (a.y <= 0.0) != (b.y <= 0.0) && (a.perp_dot(b) > 0.0) == (b.y > a.y)
    });
    crossed.count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    const DOWN: DVec3 = DVec3::NEG_Z;

    fn crossings(shape: &Shape, origin: [f64; 3], direction: DVec3) -> Vec<f64> {
        let mut roots: Vec<_> = shape.crossings(origin.into(), direction, false).collect();
        roots.sort_by(f64::total_cmp);
        roots
    }

    fn outline(points: &[[f64; 2]]) -> Shape {
        Polygon {
            vertices: points.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)).collect(),
        }
    }

    #[test]
    fn lines_cross_each_shape_where_they_should() {
        let ball = |radius| Sphere {
            center: DVec3::ZERO,
            radius,
        };
        let notched = outline(&[[2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.], [0., 0.]]);
        let funnel = |sign: f64| Frustum {
            base: DVec3::ZERO,
            apex: DVec3::Z * 4.0,
            base_radius: sign,
            apex_radius: 3.0 * sign,
        };
        let patch = Patch {
            vertices: [DVec3::ZERO, DVec3::X, DVec3::Y],
            normals: [DVec3::Z; 3],
        };
        type Case<'a> = (&'a str, Shape, [f64; 3], DVec3, &'a [f64]);
        let cases: [Case; 18] = [
            ("sphere", ball(1.0), [0., 0., 3.], DOWN, &[2.0, 4.0]),
            ("sphere from within", ball(1.0), [0.; 3], DOWN, &[-1.0, 1.0]),
            ("sphere touched", ball(1.0), [1., 0., 3.], DOWN, &[3.0, 3.0]),
            ("sphere missed", ball(1.0), [1.1, 0., 3.], DOWN, &[]),
            ("inside of a sphere", ball(-1.0), [0., 0., 3.], DOWN, &[4.0]),
            (
                "plane",
                Plane {
                    point: DVec3::Y,
                    normal: DVec3::Z,
                },
                [0., 0., 3.],
                DOWN,
                &[3.0],
            ),
            (
                "plane alongside",
                Plane {
                    point: DVec3::Y,
                    normal: DVec3::X,
                },
                [0.; 3],
                DOWN,
                &[],
            ),
            ("arm of an L", notched.clone(), [0.5, 1.5, 1.], DOWN, &[1.0]),
            ("notch of an L", notched.clone(), [1.2, 1.2, 1.], DOWN, &[]),
            (
                "beside an L, at a vertex",
                notched,
                [-0.5, 1., 1.],
                DOWN,
                &[],
            ),
            ("patch", patch.clone(), [0.25, 0.25, 1.], DOWN, &[1.0]),
            ("beside a patch", patch, [0.75, 0.75, 1.], DOWN, &[]),
            (
                "box",
                Cuboid {
                    min: DVec3::ZERO,
                    max: DVec3::ONE,
                },
                [0., 1., 3.],
                DOWN,
                &[2.0, 3.0],
            ),
            (
                "box missed",
                Cuboid {
                    min: DVec3::ZERO,
                    max: DVec3::ONE,
                },
                [0., 2., 3.],
                DOWN,
                &[],
            ),
            (
                "frustum across",
                funnel(1.0),
                [-5., 0., 2.],
                DVec3::X,
                &[3.0, 7.0],
            ),
            ("frustum along", funnel(1.0), [2., 0., 9.], DOWN, &[7.0]),
            (
                "frustum past its end",
                funnel(1.0),
                [-5., 0., 4.5],
                DVec3::X,
                &[],
            ),
            (
                "inside of a frustum",
                funnel(-1.0),
                [-5., 0., 2.],
                DVec3::X,
                &[7.0],
            ),
        ];
        for (name, shape, origin, direction, expected) in cases {
            assert_eq!(crossings(&shape, origin, direction), expected, "{name}");
        }
    }

    #[test]
    fn the_point_that_is_left_is_not_met_again() {
        let ball = Sphere {
            center: DVec3::ZERO,
            radius: 1.0,
        };
        // Off the surface by more than rounding, either way.
        for height in [0.99999, 1.0, 1.00001] {
            let [left] = ball
                .crossings(DVec3::Z * height, DOWN, true)
                .collect::<Vec<_>>()[..]
            else {
                panic!("one other end of the chord")
            };
            assert!((left - (1.0 + height)).abs() < 1e-15);
        }
        let floor = Plane {
            point: DVec3::ZERO,
            normal: DVec3::Z,
        };
        assert_eq!(floor.crossings(DVec3::Z * 1e-9, DOWN, true).count(), 0);
    }

    #[test]
    fn normals_are_perpendicular_to_the_surface() {
        // Displaced along the normal by h, a point is at distance h from where it was, outside.
        let shapes = [
            Sphere {
                center: DVec3::new(0.1, 0.2, 0.3),
                radius: 1.5,
            },
            Frustum {
                base: DVec3::new(-1.0, 0.0, -2.0),
                apex: DVec3::new(1.0, 0.5, 2.0),
                base_radius: 1.5,
                apex_radius: 0.75,
            },
            Cuboid {
                min: DVec3::NEG_ONE,
                max: DVec3::new(1.0, 2.0, 0.5),
            },
        ];
        for shape in shapes {
            for i in 0..50 {
                let angle = f64::from(i);
                let origin = 7.0 * DVec3::new(angle.cos(), angle.sin(), 0.3 * (3.0 * angle).sin());
                let direction = -origin.normalize();
                let roots = shape.crossings(origin, direction, false);
                let Some(t) = roots.min_by(f64::total_cmp) else {
                    continue;
                };
                let normal = shape.normal(origin, direction, t);
                assert!((normal.length() - 1.0).abs() < 1e-14);
                let above = origin + t * direction + 0.01 * normal;
                let back: Vec<_> = shape.crossings(above, -normal, false).collect();
                assert!(
                    back.iter().any(|t| (t - 0.01).abs() < 1e-12),
                    "{shape:?}: {back:?}"
                );
            }
        }
    }

    #[test]
    fn patches_blend_their_normals() {
        let patch = Patch {
            vertices: [DVec3::ZERO, DVec3::X, DVec3::Y],
            normals: [
                DVec3::Z,
                DVec3::new(0.6, 0.0, 0.8),
                DVec3::new(0.0, 0.6, 0.8),
            ],
        };
        let at = |x, y| patch.normal(DVec3::new(x, y, 2.0), DOWN, 2.0);
        assert!(at(1.0, 0.0).abs_diff_eq(DVec3::new(0.6, 0.0, 0.8), 1e-15));
        assert!(at(0.5, 0.5).abs_diff_eq(DVec3::new(0.3, 0.3, 0.8).normalize(), 1e-15));
    }
}
