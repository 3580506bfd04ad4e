//! Planes.

use core::fmt;

use glam::Vec3;

use super::{Closed, Shape, mapping, within};
use crate::math::{self, Math, dot};
use crate::ray::{Ray, Side};

/// All points whose difference from `point` is perpendicular to `normal`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// In world space; the nearer to what is seen, the more exact.
    pub point: Vec3,
    /// Unit length; the outward side.
    pub normal: Vec3,
}

/// Why some numbers are not a [`Plane`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PlaneError {
    /// The point or the normal is not finite.
    NotFinite,
    /// The normal has no length.
    ZeroNormal,
}

impl fmt::Display for PlaneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "the point and the normal must be finite",
            Self::ZeroNormal => "the normal must not be zero",
        })
    }
}

impl core::error::Error for PlaneError {}

impl Plane {
    /// A plane through a point. `normal` need not have unit length.
    ///
    /// # Errors
    ///
    /// Where a number is not finite or the normal is zero.
    pub fn new(point: Vec3, normal: Vec3) -> Result<Self, PlaneError> {
        if !(point.is_finite() && normal.is_finite()) {
            return Err(PlaneError::NotFinite);
        }
        let (_, normal) =
            math::unit(math::difference(normal, Vec3::ZERO)).ok_or(PlaneError::ZeroNormal)?;
        Ok(Self { point, normal })
    }
}

/// How far the plane through `point` lies beyond the ray's origin, along its normal, and how fast the
/// ray nears it. Differences first, so that digits survive far from the world's origin.
#[cfg_attr(soft_float, inline(never))]
#[cfg_attr(not(soft_float), inline(always))]
pub(super) fn approach(ray: &Ray, point: Vec3, normal: Vec3) -> (f32, f32) {
    (
        dot(&normal, &math::sub(&point, &ray.origin)),
        dot(&normal, &ray.direction),
    )
}

/// The quotient of both, where the ray admits it. No angle counts as parallel but the exact one, whose
/// quotient is infinite or NaN.
#[cfg_attr(soft_float, inline(never))]
#[cfg_attr(not(soft_float), inline(always))]
pub(super) fn distance(ray: &Ray, (height, rate): (f32, f32)) -> Option<f32> {
    // Quotients of two signs are not positive: no need to divide.
    if ((height.to_bits() ^ rate.to_bits()) as i32) < 0 {
        None
    } else {
        ray.admitted(height / rate)
    }
}

impl Shape for Plane {
    type Setup = ();

    #[inline(always)]
    fn setup(_: &Ray) {}

    #[inline(always)]
    fn intersect<P: Math>(&self, ray: &Ray, _: &(), leaving: Option<Side>) -> Option<f32> {
        if leaving.is_some() {
            return None;
        }
        distance(ray, approach(ray, self.point, self.normal))
    }

    /// The outward side is that of the normal; all beyond is inside.
    #[inline]
    fn inside<P: Math>(&self, ray: &Ray, _: &(), leaving: Option<Side>) -> f32 {
        match leaving {
            Some(Side::Inside) => ray.t_max,
            Some(Side::Outside) => 0.0,
            None => {
                let (height, rate) = approach(ray, self.point, self.normal);
                let t = height / rate;
                if rate < 0.0 {
                    within(ray, t, f32::INFINITY)
                } else if rate > 0.0 {
                    within(ray, 0.0, t)
                } else if height > 0.0 {
                    ray.t_max
                } else {
                    0.0
                }
            }
        }
    }

    /// From [`Plane::point`] in world units: u along the level direction, v along what is upwards, or along -z.
    #[inline]
    fn uv(&self, point: Vec3) -> (f32, f32) {
        mapping::flat(point - self.point, self.normal)
    }

    #[inline(always)]
    fn normal<P: Math>(&self, _: &Ray, _: f32) -> Vec3 {
        self.normal
    }
}

impl Closed for Plane {
    const CROSSINGS: usize = 1;

    #[inline]
    fn cross<P: Math>(
        &self,
        ray: &Ray,
        leaving: Option<Side>,
        visit: &mut impl FnMut(f32),
    ) -> bool {
        if let Some(side) = leaving {
            return side == Side::Inside;
        }
        let (height, rate) = approach(ray, self.point, self.normal);
        distance(ray, (height, rate)).into_iter().for_each(visit);
        rate < 0.0 || rate == 0.0 && height > 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Exact;

    const FLOOR: Plane = Plane {
        point: Vec3::ZERO,
        normal: Vec3::Y,
    };

    #[test]
    fn rays_meet_the_plane_once_or_never() {
        let cases = [
            ("from above", Ray::new(Vec3::Y, Vec3::NEG_Y), Some(1.0)),
            ("from below", Ray::new(Vec3::NEG_Y, Vec3::Y), Some(1.0)),
            ("away", Ray::new(Vec3::Y, Vec3::Y), None),
            ("beside", Ray::new(Vec3::Y, Vec3::X), None),
            ("within", Ray::new(Vec3::ZERO, Vec3::X), None),
            ("from the plane", Ray::new(Vec3::ZERO, Vec3::NEG_Y), None),
            (
                "at the horizon",
                Ray::new(Vec3::Y, Vec3::new(1.0, -1.0 / 1_048_576.0, 0.0)),
                Some(1_048_576.0),
            ),
            (
                "beyond all numbers",
                Ray::new(Vec3::Y, Vec3::new(1.0, -f32::from_bits(1), 0.0)),
                None,
            ),
            ("not a number", Ray::new(Vec3::Y, Vec3::NAN), None),
        ];
        for (name, ray, t) in cases {
            assert_eq!(FLOOR.intersect::<Exact>(&ray, &(), None), t, "{name}");
        }
    }

    #[test]
    fn what_leaves_a_plane_never_meets_it() {
        let grazing = Ray::new(Vec3::new(3.0, 1e-7, 0.0), Vec3::NEG_Y);
        assert_eq!(
            FLOOR.intersect::<Exact>(&grazing, &(), Some(Side::Outside)),
            None
        );
        assert_eq!(
            FLOOR.intersect::<Exact>(&grazing, &(), Some(Side::Inside)),
            None
        );
    }

    #[test]
    fn normals_are_made_unit_or_refused() {
        let plane = Plane::new(Vec3::ONE, Vec3::new(0.0, -3.0, 4.0)).unwrap();
        assert_eq!(plane.normal, Vec3::new(0.0, -0.6, 0.8));
        assert!(Plane::new(Vec3::ONE, Vec3::X * 1e-30).is_ok());
        assert!(Plane::new(Vec3::ONE, Vec3::X * 1e30).is_ok());
        assert_eq!(
            Plane::new(Vec3::ONE, Vec3::ZERO),
            Err(PlaneError::ZeroNormal)
        );
        assert_eq!(Plane::new(Vec3::NAN, Vec3::X), Err(PlaneError::NotFinite));
    }
}
