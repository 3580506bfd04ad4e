//! Spheres.

use core::fmt;

use glam::Vec3;

use super::{Closed, Shape, mapping, within};
use crate::candidates::Beam;
use crate::math::{self, Math, dot, length_squared};
use crate::ray::{Ray, Side};

/// All points at `radius` from `center`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// In world space.
    pub center: Vec3,
    /// In world units; negative: only the inside is visible. Not zero.
    pub radius: f32,
}

/// Why some numbers are not a [`Sphere`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SphereError {
    /// The center or the radius is not finite.
    NotFinite,
    /// The radius is zero.
    ZeroRadius,
}

impl fmt::Display for SphereError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "the center and the radius must be finite",
            Self::ZeroRadius => "the radius must not be zero",
        })
    }
}

impl core::error::Error for SphereError {}

impl Sphere {
    /// A sphere that has a surface.
    ///
    /// # Errors
    ///
    /// Where a number is not finite or the radius is zero.
    pub fn new(center: Vec3, radius: f32) -> Result<Self, SphereError> {
        if !(center.is_finite() && radius.is_finite()) {
            Err(SphereError::NotFinite)
        } else if radius == 0.0 {
            Err(SphereError::ZeroRadius)
        } else {
            Ok(Self { center, radius })
        }
    }

    /// Entry and exit, in that order, whether or not the ray admits them; with `AHEAD`, `None` also where both
    /// surely lie behind.
    #[cfg_attr(soft_float, inline(never))]
    #[cfg_attr(not(soft_float), inline(always))]
    fn roots<P: Math, const AHEAD: bool>(&self, ray: &Ray) -> Option<(f32, f32)> {
        // The origin moves to the ray's closest approach before anything is squared, and the small
        // quadratic is solved there: I. Wald, "Improving Numerical Precision in Intersection
        // Programs", Ray Tracing Gems II (2021), ch. 34.
        let to_center = math::sub(&self.center, &ray.origin);
        let approach = dot(&to_center, &ray.direction);
        let distance_squared = length_squared(&to_center);
        let radius_squared = self.radius * self.radius;
        // What surely misses goes first: the textbook discriminant, whose terms and those below are
        // each off by less than 2^-20 of `distance_squared`. Nothing that is met below stops here.
        const CERTAIN: f32 = 1.0 - 1.0 / (1_u32 << 18) as f32;
        // From outside, of what the ray leaves behind, both roots are below zero by more than rounding.
        let clearance = distance_squared * CERTAIN - radius_squared;
        if approach * approach < clearance || (AHEAD && approach < 0.0 && clearance > 0.0) {
            return None;
        }
        let miss = math::sub(&math::scale(&ray.direction, approach), &to_center);
        let along = dot(&miss, &ray.direction);
        let half_chord_squared = radius_squared - length_squared(&miss) + along * along;
        // Also false for NaN. What has no radius has no surface.
        if half_chord_squared >= 0.0 && radius_squared > 0.0 {
            let half_chord = P::sqrt(half_chord_squared);
            // Small terms first.
            Some((
                approach - (half_chord + along),
                approach + (half_chord - along),
            ))
        } else {
            None
        }
    }

    /// The other end of the chord that a ray from the surface cuts.
    #[inline(always)]
    fn chord(&self, ray: &Ray, side: Side) -> Option<f32> {
        // Where only the inside is visible, that is the outward side.
        if (side == Side::Inside) == self.shows_outside() {
            ray.admitted(2.0 * dot(&math::sub(&self.center, &ray.origin), &ray.direction))
        } else {
            None
        }
    }

    /// [`Shape::intersect`], either way.
    #[inline(always)]
    fn first<P: Math, const AHEAD: bool>(&self, ray: &Ray, leaving: Option<Side>) -> Option<f32> {
        if let Some(side) = leaving {
            return self.chord(ray, side);
        }
        // The entry is never the farther one: where it is not before the end, nor is the exit.
        let (entry, exit) = self.roots::<P, AHEAD>(ray)?;
        let enters = math::is_positive(entry) && self.shows_outside();
        ray.admitted(if enters { entry } else { exit })
    }

    #[inline(always)]
    fn shows_outside(&self) -> bool {
        self.radius > 0.0
    }
}

impl Shape for Sphere {
    type Setup = ();

    #[inline(always)]
    fn setup(_: &Ray) {}

    #[inline(always)]
    fn intersect<P: Math>(&self, ray: &Ray, _: &(), leaving: Option<Side>) -> Option<f32> {
        self.first::<P, false>(ray, leaving)
    }

    #[inline(always)]
    fn intersect_ahead<P: Math>(&self, ray: &Ray, _: &(), leaving: Option<Side>) -> Option<f32> {
        self.first::<P, true>(ray, leaving)
    }

    #[inline(always)]
    fn is_left_for_good(&self, side: Side) -> bool {
        side == Side::Outside && self.shows_outside()
    }

    #[inline]
    fn crossings<P: Math>(&self, ray: &Ray, _: &(), leaving: Option<Side>) -> u32 {
        if let Some(side) = leaving {
            return self.chord(ray, side).is_some() as u32;
        }
        match self.roots::<P, false>(ray) {
            Some((entry, exit)) => {
                (self.shows_outside() && ray.admits(entry)) as u32 + ray.admits(exit) as u32
            }
            None => 0,
        }
    }

    #[inline]
    fn is_missed(&self, beam: &Beam) -> bool {
        beam.misses(self)
    }

    #[inline]
    fn inside<P: Math>(&self, ray: &Ray, _: &(), leaving: Option<Side>) -> f32 {
        if let Some(side) = leaving {
            // Of a hollow one the inside is the outward side.
            let chord = 2.0 * dot(&math::sub(&self.center, &ray.origin), &ray.direction);
            let enters = side == Side::Inside && self.shows_outside();
            return if enters { within(ray, 0.0, chord) } else { 0.0 };
        }
        match self.roots::<P, false>(ray) {
            Some((entry, exit)) if self.shows_outside() => within(ray, entry, exit),
            _ => 0.0,
        }
    }

    /// Longitude and latitude, each from 0 to 1: u is 1/2 towards +z and grows towards +x, v from the pole at
    /// -y to that at +y.
    #[inline]
    fn uv(&self, point: Vec3) -> (f32, f32) {
        let outward = point - self.center;
        let (u, across) = mapping::around(outward, Vec3::Y);
        // From pole to pole it is half a turn.
        (u, 2.0 * mapping::turn(outward.y, across) - 0.5)
    }

    #[inline(always)]
    fn normal<P: Math>(&self, ray: &Ray, t: f32) -> Vec3 {
        // Not divided by the radius: seen from far, the point is off the surface by its own rounding.
        let outward = P::normalize(math::sub(&ray.at(t), &self.center));
        if self.shows_outside() {
            outward
        } else {
            -outward
        }
    }
}

impl Closed for Sphere {
    const CROSSINGS: usize = 2;

    #[inline]
    fn cross<P: Math>(
        &self,
        ray: &Ray,
        leaving: Option<Side>,
        visit: &mut impl FnMut(f32),
    ) -> bool {
        let (entry, exit) = match leaving {
            Some(side) => (None, self.chord(ray, side)),
            None => match self.roots::<P, false>(ray) {
                Some((entry, exit)) => (ray.admitted(entry), ray.admitted(exit)),
                None => (None, None),
            },
        };
        entry.into_iter().chain(exit).for_each(visit);
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Exact;
    use crate::random::{numbers, vectors};

    const BALL: Sphere = Sphere {
        center: Vec3::new(0.0, 0.0, -5.0),
        radius: 1.0,
    };

    #[test]
    fn rays_meet_the_nearest_point_they_admit() {
        let out = Ray::new(Vec3::ZERO, Vec3::NEG_Z);
        let cases = [
            ("from outside", BALL, out, Some(4.0)),
            (
                "from inside",
                BALL,
                Ray::new(BALL.center, Vec3::NEG_X),
                Some(1.0),
            ),
            ("ends short", BALL, Ray { t_max: 4.0, ..out }, None),
            ("behind", BALL, Ray::new(Vec3::ZERO, Vec3::Z), None),
            ("touches", BALL, Ray::new(Vec3::X, Vec3::NEG_Z), Some(5.0)),
            (
                "passes",
                BALL,
                Ray::new(Vec3::X * 1.000_001, Vec3::NEG_Z),
                None,
            ),
            (
                "inside only",
                Sphere {
                    radius: -1.0,
                    ..BALL
                },
                out,
                Some(6.0),
            ),
            (
                "not a number",
                Sphere {
                    radius: f32::NAN,
                    ..BALL
                },
                out,
                None,
            ),
            ("no direction", BALL, Ray::new(Vec3::ZERO, Vec3::NAN), None),
        ];
        for (name, ball, ray, t) in cases {
            assert_eq!(ball.intersect::<Exact>(&ray, &(), None), t, "{name}");
        }
    }

    /// Rays from just outside and just inside, past the sphere and away from it.
    #[test]
    fn what_is_known_early_to_lie_behind_is_never_met() {
        let mut numbers = numbers(7);
        let mut number = move || numbers.next().unwrap();
        let (mut met, mut behind) = (0, 0);
        for (spot, other) in vectors(1).zip(vectors(2)).take(200_000) {
            let outward = Exact::normalize(spot);
            let across = outward.any_orthonormal_vector() * number().signum();
            // A few units in the last place, or many.
            let height = 1.0 + number() / (1_u32 << (8 + (number().abs() * 15.0) as u32)) as f32;
            let along = number() / (1_u32 << (number().abs() * 24.0) as u32) as f32;
            let ball = Sphere {
                center: other * 4.0,
                radius: 1.0,
            };
            let origin = ball.center + outward * height;
            let ray = Ray::new(origin, Exact::normalize(across + outward * along));
            let expected = ball.intersect::<Exact>(&ray, &(), None);
            let found = ball.intersect_ahead::<Exact>(&ray, &(), None);
            assert_eq!(found, expected, "{ball:?} {ray:?}");
            if dot(&(ball.center - origin), &ray.direction) < 0.0 {
                *if expected.is_some() {
                    &mut met
                } else {
                    &mut behind
                } += 1;
            }
        }
        assert!(met > 10_000 && behind > 10_000, "{met} {behind}");
    }

    #[test]
    fn what_leaves_meets_only_the_other_end_of_its_chord() {
        let from_top = Ray::new(BALL.center + Vec3::Y, Vec3::NEG_Y);
        assert_eq!(
            BALL.intersect::<Exact>(&from_top, &(), Some(Side::Inside)),
            Some(2.0)
        );
        assert_eq!(
            BALL.intersect::<Exact>(&from_top, &(), Some(Side::Outside)),
            None
        );
        assert_eq!(
            BALL.crossings::<Exact>(&from_top, &(), Some(Side::Inside)),
            1
        );
    }

    #[test]
    fn a_ray_through_glass_crosses_twice() {
        let ray = Ray::new(Vec3::ZERO, Vec3::NEG_Z);
        let inside_only = Sphere {
            radius: -1.0,
            ..BALL
        };
        assert_eq!(BALL.crossings::<Exact>(&ray, &(), None), 2);
        assert_eq!(
            BALL.crossings::<Exact>(&Ray { t_max: 5.0, ..ray }, &(), None),
            1
        );
        assert_eq!(inside_only.crossings::<Exact>(&ray, &(), None), 1);
    }

    #[test]
    fn normals_point_outward_or_to_the_visible_inside() {
        let ray = Ray::new(Vec3::ZERO, Vec3::NEG_Z);
        assert_eq!(BALL.normal::<Exact>(&ray, 4.0), Vec3::Z);
        let inside_only = Sphere {
            radius: -1.0,
            ..BALL
        };
        assert_eq!(inside_only.normal::<Exact>(&ray, 6.0), Vec3::Z);
    }

    #[test]
    fn degenerate_spheres_are_refused() {
        assert_eq!(Sphere::new(Vec3::ZERO, 0.0), Err(SphereError::ZeroRadius));
        assert_eq!(Sphere::new(Vec3::NAN, 1.0), Err(SphereError::NotFinite));
        assert_eq!(
            Sphere::new(Vec3::ZERO, f32::INFINITY),
            Err(SphereError::NotFinite)
        );
        assert!(Sphere::new(Vec3::ZERO, -1.0).is_ok());
    }
}
