//! Cylinders and cones without caps.

use core::fmt;

use glam::Vec3;

use super::{Shape, mapping};
use crate::math::{self, Math, dot, length_squared};
use crate::ray::{Ray, Side};

/// The side of a cylinder, a cone or a frustum of one: open at both ends.
///
/// All points at distance `base_radius + slope * s` from the axis, where `s`, from 0 to `length`, is
/// how far along the axis from the base they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frustum {
    /// Center of the base, in world space. The narrower end, for the sake of accuracy: measured from
    /// the wider one, the radius near the tip of a cone is a difference of large numbers, and hits there
    /// lie further off the surface than the slack of hierarchies covers.
    pub base: Vec3,
    /// From the base to the other end; unit length.
    pub axis: Vec3,
    /// Along the axis, in world units; above 0.
    pub length: f32,
    /// In world units; negative, as the radius at the other end then is too: only the inside is
    /// visible.
    pub base_radius: f32,
    /// Growth of the radius by length; 0 for a cylinder.
    pub slope: f32,
}

/// Why some numbers are not a [`Frustum`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FrustumError {
    /// A number is not finite, or the slope of the side is not.
    NotFinite,
    /// The ends are one point.
    ZeroLength,
    /// Both radii are zero.
    ZeroRadius,
    /// One radius is negative, the other positive.
    MixedSigns,
}

impl fmt::Display for FrustumError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "the ends, the radii and the slope must be finite",
            Self::ZeroLength => "the two ends must not be the same point",
            Self::ZeroRadius => "the radii must not both be zero",
            Self::MixedSigns => "the radii must not have opposite signs",
        })
    }
}

impl core::error::Error for FrustumError {}

impl Frustum {
    /// The side between two circles: a cylinder for equal radii, a cone for one radius of zero. The
    /// narrower end becomes the base, whichever is named first.
    ///
    /// # Errors
    ///
    /// Where a number is not finite, the ends coincide, both radii are zero or their signs differ.
    pub fn new(
        base: Vec3,
        base_radius: f32,
        apex: Vec3,
        apex_radius: f32,
    ) -> Result<Self, FrustumError> {
        let radii_are_finite = base_radius.is_finite() && apex_radius.is_finite();
        if !(base.is_finite() && apex.is_finite() && radii_are_finite) {
            return Err(FrustumError::NotFinite);
        }
        if base_radius == 0.0 && apex_radius == 0.0 {
            return Err(FrustumError::ZeroRadius);
        }
        if (base_radius < 0.0 && apex_radius > 0.0) || (base_radius > 0.0 && apex_radius < 0.0) {
            return Err(FrustumError::MixedSigns);
        }
        let (base, base_radius, apex, apex_radius) = if apex_radius.abs() < base_radius.abs() {
            (apex, apex_radius, base, base_radius)
        } else {
            (base, base_radius, apex, apex_radius)
        };
        let (length, axis) =
            math::unit(math::difference(apex, base)).ok_or(FrustumError::ZeroLength)?;
        let growth = f64::from(apex_radius) - f64::from(base_radius);
        let (slope, length) = ((growth / length) as f32, length as f32);
        if !(slope.is_finite() && length.is_finite()) {
            return Err(FrustumError::NotFinite);
        }
        Ok(Self {
            base,
            axis,
            length,
            base_radius,
            slope,
        })
    }

    #[inline(always)]
    fn shows_outside(&self) -> bool {
        self.base_radius + self.slope * (0.5 * self.length) > 0.0
    }

    /// Entry into and exit from the solid, each where it lies between the ends and is visible, whether
    /// or not the ray admits it. A ray from the surface meets the side at 0 by definition.
    #[inline]
    fn roots<P: Math>(&self, ray: &Ray, leaving: Option<Side>) -> (Option<f32>, Option<f32>) {
        // Where only the inside is visible, that is the outward side.
        let outward = leaving.map(|side| (side == Side::Outside) == self.shows_outside());
        if outward == Some(true) {
            return (None, None);
        }
        // As for the sphere, the origin moves to where the ray is closest, here to the base.
        let to_base = math::sub(&self.base, &ray.origin);
        let approach = if leaving.is_some() {
            0.0
        } else {
            dot(&to_base, &ray.direction)
        };
        let from_base = math::sub(&math::scale(&ray.direction, approach), &to_base);
        // Along the axis, across it, and the radius there; then how these change along the ray.
        let along = dot(&from_base, &self.axis);
        let across = math::sub(&from_base, &math::scale(&self.axis, along));
        let radius = self.base_radius + self.slope * along;
        let along_rate = dot(&ray.direction, &self.axis);
        let across_rate = math::sub(&ray.direction, &math::scale(&self.axis, along_rate));
        let radius_rate = self.slope * along_rate;
        // a t² + 2 b t + c = 0.
        let a = length_squared(&across_rate) - radius_rate * radius_rate;
        let b = dot(&across, &across_rate) - radius * radius_rate;
        let (c, root) = if leaving.is_some() {
            (0.0, if b < 0.0 { -b } else { b })
        } else {
            // b² - a c without its cancellation, by Lagrange's identity.
            let growth = math::sub(
                &math::scale(&across_rate, radius),
                &math::scale(&across, radius_rate),
            );
            let twist = across.cross(across_rate);
            let discriminant = length_squared(&growth) - length_squared(&twist);
            // Also true for NaN.
            if !(discriminant >= 0.0) {
                return (None, None);
            }
            let c = length_squared(&across) - radius * radius;
            (c, P::sqrt(discriminant))
        };
        // The derivative at a root is twice the root of the discriminant: negative where the ray
        // enters the solid, positive where it leaves it, on both halves of a double cone.
        let (entry, exit) = if b > 0.0 {
            let q = -b - root;
            (q / a, c / q)
        } else {
            let q = root - b;
            (c / q, q / a)
        };
        let between_ends = |t: f32| {
            let along = along + t * along_rate;
            (0.0..=self.length).contains(&along).then_some(approach + t)
        };
        let entry = if leaving.is_none() && self.shows_outside() {
            between_ends(entry)
        } else {
            None
        };
        (entry, between_ends(exit))
    }
}

impl Shape for Frustum {
    type Setup = ();

    #[inline(always)]
    fn setup(_: &Ray) {}

    #[inline]
    fn intersect<P: Math>(&self, ray: &Ray, _: &(), leaving: Option<Side>) -> Option<f32> {
        // The far side of a double cone's other half has the exit before the entry.
        let (entry, exit) = self.roots::<P>(ray, leaving);
        let entry = entry.filter(|&t| ray.admits(t));
        let exit = exit.filter(|&t| ray.admits(t));
        match (entry, exit) {
            (Some(entry), Some(exit)) if exit < entry => Some(exit),
            (Some(entry), _) => Some(entry),
            (None, exit) => exit,
        }
    }

    #[inline]
    fn crossings<P: Math>(&self, ray: &Ray, _: &(), leaving: Option<Side>) -> u32 {
        let (entry, exit) = self.roots::<P>(ray, leaving);
        entry.is_some_and(|t| ray.admits(t)) as u32 + exit.is_some_and(|t| ray.admits(t)) as u32
    }

    /// The angle about the axis, and the share of the height, each from 0 to 1.
    #[inline]
    fn uv(&self, point: Vec3) -> (f32, f32) {
        let from_base = point - self.base;
        let (u, _) = mapping::around(from_base, self.axis);
        (u, dot(&from_base, &self.axis) / self.length)
    }

    #[inline]
    fn normal<P: Math>(&self, ray: &Ray, t: f32) -> Vec3 {
        let from_base = math::sub(&ray.at(t), &self.base);
        let along = dot(&from_base, &self.axis);
        let across = math::sub(&from_base, &math::scale(&self.axis, along));
        let square = length_squared(&across);
        // Also true for NaN. At the tip of a cone there is no direction across the axis.
        if !(square > 0.0) {
            return if self.slope > 0.0 {
                -self.axis
            } else {
                self.axis
            };
        }
        let across = across * P::sqrt_and_recip(square).1;
        let tilt = self.axis * self.slope;
        P::normalize(if self.shows_outside() {
            across - tilt
        } else {
            -across - tilt
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Exact;

    fn pipe() -> Frustum {
        Frustum::new(Vec3::ZERO, 1.0, Vec3::new(0.0, 4.0, 0.0), 1.0).unwrap()
    }

    fn cone() -> Frustum {
        Frustum::new(Vec3::ZERO, 1.0, Vec3::new(0.0, 2.0, 0.0), 0.0).unwrap()
    }

    fn meets(frustum: &Frustum, origin: Vec3, direction: Vec3) -> Option<f32> {
        frustum.intersect::<Exact>(&Ray::new(origin, direction), &(), None)
    }

    #[test]
    fn sides_are_met_and_ends_are_open() {
        let inside_only = Frustum::new(Vec3::ZERO, -1.0, Vec3::new(0.0, 4.0, 0.0), -1.0).unwrap();
        let slanted = Exact::normalize(Vec3::new(1.0, -1.0, 0.0));
        let cases = [
            (
                "pipe from outside",
                pipe(),
                Vec3::new(-3.0, 2.0, 0.0),
                Vec3::X,
                Some(2.0),
            ),
            (
                "pipe from inside",
                pipe(),
                Vec3::new(0.0, 2.0, 0.0),
                Vec3::X,
                Some(1.0),
            ),
            (
                "pipe along its axis",
                pipe(),
                Vec3::new(0.0, -1.0, 0.0),
                Vec3::Y,
                None,
            ),
            (
                "pipe along its side",
                pipe(),
                Vec3::new(1.0, -1.0, 0.0),
                Vec3::Y,
                None,
            ),
            (
                "pipe at its end",
                pipe(),
                Vec3::new(-3.0, 4.0, 0.0),
                Vec3::X,
                Some(2.0),
            ),
            (
                "pipe above its end",
                pipe(),
                Vec3::new(-3.0, 4.000_001, 0.0),
                Vec3::X,
                None,
            ),
            (
                "pipe inside only",
                inside_only,
                Vec3::new(-3.0, 2.0, 0.0),
                Vec3::X,
                Some(4.0),
            ),
            (
                "cone halfway up",
                cone(),
                Vec3::new(-3.0, 1.0, 0.0),
                Vec3::X,
                Some(2.5),
            ),
            (
                "cone's other half",
                cone(),
                Vec3::new(-3.0, 3.0, 0.0),
                Vec3::X,
                None,
            ),
            (
                "cone through its base",
                cone(),
                Vec3::new(0.0, -1.0, 0.0),
                Vec3::Y,
                Some(3.0),
            ),
        ];
        for (name, frustum, origin, direction, t) in cases {
            assert_eq!(meets(&frustum, origin, direction), t, "{name}");
        }
        let t = meets(&pipe(), Vec3::new(-2.0, 5.5, 0.0), slanted).unwrap();
        assert!(
            (t - 3.0 * core::f32::consts::SQRT_2).abs() < 1e-5,
            "through the open end: {t}"
        );
    }

    #[test]
    fn normals_stand_on_the_side() {
        let ray = Ray::new(Vec3::new(-3.0, 1.0, 0.0), Vec3::X);
        let normal = cone().normal::<Exact>(&ray, 2.5);
        assert!((normal - Exact::normalize(Vec3::new(-2.0, 1.0, 0.0))).length() < 1e-6);
        let tip = Ray::new(Vec3::new(0.0, 3.0, 0.0), Vec3::NEG_Y);
        assert_eq!(cone().normal::<Exact>(&tip, 1.0), Vec3::Y);
    }

    #[test]
    fn what_leaves_meets_only_the_other_side() {
        let ray = Ray::new(Vec3::new(1.0, 2.0, 0.0), Vec3::NEG_X);
        let meets = |side| pipe().intersect::<Exact>(&ray, &(), Some(side));
        assert_eq!(meets(Side::Inside), Some(2.0));
        assert_eq!(meets(Side::Outside), None);
        assert_eq!(pipe().crossings::<Exact>(&ray, &(), Some(Side::Inside)), 1);
        let through = Ray::new(Vec3::new(-3.0, 2.0, 0.0), Vec3::X);
        assert_eq!(pipe().crossings::<Exact>(&through, &(), None), 2);
    }

    #[test]
    fn degenerate_sides_are_refused() {
        let top = Vec3::Y;
        let cases = [
            (
                "one point",
                Frustum::new(top, 1.0, top, 1.0),
                FrustumError::ZeroLength,
            ),
            (
                "a line",
                Frustum::new(Vec3::ZERO, 0.0, top, 0.0),
                FrustumError::ZeroRadius,
            ),
            (
                "two signs",
                Frustum::new(Vec3::ZERO, 1.0, top, -1.0),
                FrustumError::MixedSigns,
            ),
            (
                "not a number",
                Frustum::new(Vec3::NAN, 1.0, top, 1.0),
                FrustumError::NotFinite,
            ),
        ];
        for (name, frustum, error) in cases {
            assert_eq!(frustum, Err(error), "{name}");
        }
    }
}
