//! Boxes with faces across the axes.

use core::fmt;

use glam::Vec3;

use super::polygon::Axis;
use super::{Closed, Shape, within};
use crate::math::{self, Math};
use crate::ray::{Ray, Side};

/// All points of the surface of an axis-aligned box, edges and corners included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    /// The corner with the least coordinates, in world space.
    pub min: Vec3,
    /// The corner with the greatest; no component less than `min`'s. Equal ones make a flat box.
    pub max: Vec3,
}

/// Why two corners are not a [`Cuboid`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CuboidError {
    /// A coordinate is not finite.
    NotFinite,
    /// A coordinate of `min` is greater than the one of `max`.
    Inverted,
}

impl fmt::Display for CuboidError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "the corners must be finite",
            Self::Inverted => "no coordinate of min may be greater than that of max",
        })
    }
}

impl core::error::Error for CuboidError {}

impl Cuboid {
    /// A box between two corners.
    ///
    /// # Errors
    ///
    /// Where a coordinate is not finite, or `min` is above `max` in one.
    pub fn new(min: Vec3, max: Vec3) -> Result<Self, CuboidError> {
        if !(min.is_finite() && max.is_finite()) {
            Err(CuboidError::NotFinite)
        } else if !min.cmple(max).all() {
            Err(CuboidError::Inverted)
        } else {
            Ok(Self { min, max })
        }
    }

    /// Entry and exit, in that order, whether or not the ray admits them.
    ///
    /// Slabs, T. L. Kay and J. T. Kajiya, "Ray Tracing Complex Scenes", SIGGRAPH 1986; equal entry and
    /// exit count, so that the box is closed.
    fn roots(&self, ray: &Ray, reciprocal: &Vec3) -> Option<(f32, f32)> {
        let (o, d) = (ray.origin, ray.direction);
        let x = slab(o.x, d.x, reciprocal.x, self.min.x, self.max.x)?;
        let y = slab(o.y, d.y, reciprocal.y, self.min.y, self.max.y)?;
        let z = slab(o.z, d.z, reciprocal.z, self.min.z, self.max.z)?;
        let entry = if x.0 > y.0 { x.0 } else { y.0 };
        let entry = if z.0 > entry { z.0 } else { entry };
        let exit = if x.1 < y.1 { x.1 } else { y.1 };
        let exit = if z.1 < exit { z.1 } else { exit };
        // Each is at least zero, and infinite along the planes; NaN if anything is, which the
        // comparisons above may have passed over.
        let widths = (x.1 - x.0) + (y.1 - y.0) + (z.1 - z.0);
        (entry <= exit && widths >= 0.0).then_some((entry, exit))
    }
}

/// Where a ray is between two planes across an axis; `None` if it never is.
///
/// A ray along the planes is always between them or never: dividing by its zero would make 0/0 of an
/// origin that lies on one of them.
#[cfg_attr(soft_float, inline(never))]
#[cfg_attr(not(soft_float), inline(always))]
pub(super) fn slab(
    origin: f32,
    direction: f32,
    reciprocal: f32,
    min: f32,
    max: f32,
) -> Option<(f32, f32)> {
    let (to_min, to_max) = (min - origin, max - origin);
    if direction > 0.0 {
        Some((to_min * reciprocal, to_max * reciprocal))
    } else if direction < 0.0 {
        Some((to_max * reciprocal, to_min * reciprocal))
    } else if to_min <= 0.0 && to_max >= 0.0 && direction == 0.0 {
        Some((f32::NEG_INFINITY, f32::INFINITY))
    } else {
        None
    }
}

impl Shape for Cuboid {
    /// The reciprocals of the direction's components.
    type Setup = Vec3;

    #[inline]
    fn setup(ray: &Ray) -> Vec3 {
        ray.direction.recip()
    }

    #[inline]
    fn intersect<P: Math>(
        &self,
        ray: &Ray,
        reciprocal: &Vec3,
        leaving: Option<Side>,
    ) -> Option<f32> {
        if leaving == Some(Side::Outside) {
            return None;
        }
        let (entry, exit) = self.roots(ray, reciprocal)?;
        let enters = entry > 0.0 && leaving.is_none();
        ray.admitted(if enters { entry } else { exit })
    }

    #[inline]
    fn crossings<P: Math>(&self, ray: &Ray, reciprocal: &Vec3, leaving: Option<Side>) -> u32 {
        if leaving == Some(Side::Outside) {
            return 0;
        }
        match self.roots(ray, reciprocal) {
            Some((entry, exit)) => {
                (leaving.is_none() && ray.admits(entry)) as u32 + ray.admits(exit) as u32
            }
            None => 0,
        }
    }

    #[inline]
    fn inside<P: Math>(&self, ray: &Ray, reciprocal: &Vec3, leaving: Option<Side>) -> f32 {
        if leaving == Some(Side::Outside) {
            return 0.0;
        }
        match self.roots(ray, reciprocal) {
            Some((entry, exit)) => within(ray, entry, exit),
            None => 0.0,
        }
    }

    /// From 0 to 1 across the face that is met, y being upwards; of the upper and the lower one, -z and +z.
    #[inline]
    fn uv(&self, point: Vec3) -> (f32, f32) {
        let size = self.max - self.min;
        let from_min = (point - self.min) / size;
        let from_max = Vec3::ONE - from_min;
        let off = (from_min - Vec3::splat(0.5)).to_array();
        // Of a box without extent along an axis that face is met.
        let [x, y, z] = off.map(|it| if it.is_nan() { f32::INFINITY } else { it.abs() });
        if x >= y && x >= z {
            let u = if off[0] > 0.0 { from_max.z } else { from_min.z };
            (u, from_min.y)
        } else if y >= z {
            let v = if off[1] > 0.0 { from_max.z } else { from_min.z };
            (from_min.x, v)
        } else {
            let u = if off[2] > 0.0 { from_min.x } else { from_max.x };
            (u, from_min.y)
        }
    }

    #[inline]
    fn normal<P: Math>(&self, ray: &Ray, t: f32) -> Vec3 {
        // The hit's distance is, to the bit, that of the face that was met; of equal ones, that of the
        // first axis.
        for axis in [Axis::X, Axis::Y, Axis::Z] {
            math::keep_rolled();
            let (origin, direction) = (axis.of(&ray.origin), axis.of(&ray.direction));
            let reciprocal = 1.0 / direction;
            if direction != 0.0 {
                if (axis.of(&self.min) - origin) * reciprocal == t {
                    return axis.at(-1.0);
                }
                if (axis.of(&self.max) - origin) * reciprocal == t {
                    return axis.at(1.0);
                }
            }
        }
        Vec3::Z
    }
}

impl Closed for Cuboid {
    const CROSSINGS: usize = 2;

    #[inline]
    fn cross<P: Math>(
        &self,
        ray: &Ray,
        leaving: Option<Side>,
        visit: &mut impl FnMut(f32),
    ) -> bool {
        if leaving == Some(Side::Outside) {
            return false;
        }
        if let Some((entry, exit)) = self.roots(ray, &Self::setup(ray)) {
            let entry = ray.admitted(entry).filter(|_| leaving.is_none());
            entry.into_iter().chain(ray.admitted(exit)).for_each(visit);
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Exact;

    const DIE: Cuboid = Cuboid {
        min: Vec3::NEG_ONE,
        max: Vec3::ONE,
    };

    fn meets(die: Cuboid, ray: Ray, leaving: Option<Side>) -> Option<(f32, Vec3)> {
        let t = die.intersect::<Exact>(&ray, &Cuboid::setup(&ray), leaving)?;
        Some((t, die.normal::<Exact>(&ray, t)))
    }

    #[test]
    fn flat_boxes_have_the_coordinates_of_their_face() {
        let plate = Cuboid {
            max: Vec3::new(1.0, -1.0, 1.0),
            ..DIE
        };
        assert_eq!(plate.uv(Vec3::new(0.5, -1.0, -0.5)), (0.75, 0.25));
    }

    #[test]
    fn every_face_is_met_from_both_sides() {
        for normal in [
            Vec3::X,
            Vec3::Y,
            Vec3::Z,
            Vec3::NEG_X,
            Vec3::NEG_Y,
            Vec3::NEG_Z,
        ] {
            assert_eq!(
                meets(DIE, Ray::new(normal * 3.0, -normal), None),
                Some((2.0, normal))
            );
            assert_eq!(
                meets(DIE, Ray::new(Vec3::ZERO, normal), None),
                Some((1.0, normal))
            );
        }
    }

    #[test]
    fn rays_in_the_plane_of_a_face_are_decided() {
        let along =
            |y: f32, zero: f32| Ray::new(Vec3::new(-2.0, y, 0.0), Vec3::new(1.0, zero, zero));
        let cases = [
            ("on a face", along(1.0, 0.0), true),
            ("on a face, negative zero", along(1.0, -0.0), true),
            ("beside", along(1.000_000_2, 0.0), false),
            ("beside, negative zero", along(1.000_000_2, -0.0), false),
        ];
        for (name, ray, hit) in cases {
            assert_eq!(
                meets(DIE, ray, None),
                hit.then_some((1.0, Vec3::NEG_X)),
                "{name}"
            );
        }
        let edge = Vec3::new(1.0, 1.0, 0.0);
        assert!(meets(DIE, Ray::new(Vec3::new(0.0, -2.0, 0.0), edge), None).is_some());
        assert!(meets(DIE, Ray::new(Vec3::new(0.0, -2.000_000_5, 0.0), edge), None).is_none());
    }

    #[test]
    fn flat_boxes_are_met_and_inverted_ones_refused() {
        let flat = Cuboid::new(Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 0.0, 1.0)).unwrap();
        let down = Ray::new(Vec3::Y, Vec3::NEG_Y);
        assert_eq!(meets(flat, down, None).unwrap().0, 1.0);
        assert_eq!(
            Cuboid::new(Vec3::ONE, Vec3::ZERO),
            Err(CuboidError::Inverted)
        );
        assert_eq!(
            Cuboid::new(Vec3::NAN, Vec3::ZERO),
            Err(CuboidError::NotFinite)
        );
    }

    #[test]
    fn what_leaves_a_face_meets_only_the_far_ones() {
        let inward = Ray::new(Vec3::X, Vec3::NEG_X);
        assert_eq!(
            meets(DIE, inward, Some(Side::Inside)),
            Some((2.0, Vec3::NEG_X))
        );
        assert_eq!(meets(DIE, inward, Some(Side::Outside)), None);
    }

    #[test]
    fn nothing_that_is_not_a_number_is_met() {
        let ray = Ray::new(Vec3::new(-2.0, 0.0, 0.0), Vec3::new(1.0, f32::NAN, 0.0));
        assert_eq!(meets(DIE, ray, None), None);
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            let nowhere = Ray::new(
                Vec3::ONE * -3.0 + axis * f32::NAN,
                Exact::normalize(Vec3::ONE),
            );
            assert_eq!(meets(DIE, nowhere, None), None);
            let boundless = Cuboid {
                max: DIE.max + axis * f32::NAN,
                ..DIE
            };
            assert_eq!(
                meets(
                    boundless,
                    Ray::new(Vec3::ONE * -3.0, Exact::normalize(Vec3::ONE)),
                    None
                ),
                None
            );
        }
        assert_eq!(
            meets(
                Cuboid {
                    min: Vec3::NAN,
                    ..DIE
                },
                Ray::new(Vec3::Z * 3.0, Vec3::NEG_Z),
                None
            ),
            None
        );
    }
}
