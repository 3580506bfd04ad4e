//! Tori.

use core::fmt;

use glam::Vec3;

use super::cuboid::slab;
use super::{Closed, Shape, mapping, within};
use crate::math::{self, Math};
use crate::ray::{Ray, Side};

/// All points at `minor` from a circle of radius `major`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus {
    /// Of the circle, in world space.
    pub center: Vec3,
    /// Across the circle; unit length.
    pub axis: Vec3,
    /// Of the circle, in world units.
    pub major: f32,
    /// Of the tube; above 0 and below `major`.
    pub minor: f32,
}

/// Why some numbers are not a [`Torus`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum TorusError {
    /// A number is not finite.
    NotFinite,
    /// The axis has no direction.
    ZeroAxis,
    /// The minor radius is not above zero and below the major one.
    Radii,
}

impl fmt::Display for TorusError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "the numbers must be finite",
            Self::ZeroAxis => "the axis must not be zero",
            Self::Radii => "the minor radius must be above zero and below the major one",
        })
    }
}

impl core::error::Error for TorusError {}

/// Most steps of a scan for a root, of which a ray takes six at most. Five or six find a simple root; to a
/// double one each step halves the way, and all have gone as far as `f32` can tell.
const STEPS: u32 = 32;

/// A ray in the torus' frame, from where it is closest to the center. Distances count from there.
struct Frame {
    /// Along the axis, and how that changes along the ray.
    along: f32,
    along_rate: f32,
    /// Across it.
    across: Vec3,
    across_rate: Vec3,
    major: f32,
    minor: f32,
}

impl Frame {
    /// The squared distance from the circle less the squared minor radius, times `sign`, and half of how
    /// that changes along the ray.
    #[inline(always)]
    fn at<P: Math>(&self, t: f32, sign: f32, forward: bool) -> (f32, f32) {
        let along = self.along + t * self.along_rate;
        let across = self.across + self.across_rate * t;
        let radius = P::sqrt(across.length_squared());
        let off = radius - self.major;
        let value = off * off + (along - self.minor) * (along + self.minor);
        let radius_rate = if radius > 0.0 {
            across.dot(self.across_rate) / radius
        } else {
            // On the axis it depends on the way from there.
            let rate = P::sqrt(self.across_rate.length_squared());
            if forward { rate } else { -rate }
        };
        let rate = along * self.along_rate + off * radius_rate;
        (sign * value, sign * rate)
    }

    /// Where [`at`](Self::at) of this sign, convex between two distances, falls to zero, if it does, on the
    /// way from the first, where it is not below, to the second.
    ///
    /// Newton's method comes closer with every step and never goes too far, unless it passes the least
    /// value: then there is no zero.
    #[inline]
    fn fall<P: Math>(&self, start: f32, end: f32, sign: f32) -> Option<f32> {
        let forward = start < end;
        let mut t = start;
        for _ in 0..STEPS {
            let (value, rate) = self.at::<P>(t, sign, forward);
            let next = t - 0.5 * value / rate;
            let (falls, is_within, moves) = if forward {
                (rate < 0.0, next <= end, next > t)
            } else {
                (rate > 0.0, next >= end, next < t)
            };
            if value <= 0.0 {
                return Some(t);
            }
            // Also true for NaN.
            if !(falls && is_within) {
                return None;
            }
            if !moves {
                return Some(t);
            }
            t = next;
        }
        Some(t)
    }
}

/// The distances at which a ray crosses the surface, one after the other.
struct Walk {
    frame: Frame,
    /// Of the frame's zero, along the ray.
    approach: f32,
    /// Where the function of [`Frame::at`] turns from convex to concave and back, and where the ray ends.
    parts: [f32; 3],
    /// In which of these the walk is, and where.
    part: usize,
    place: f32,
    /// Whether it is outside of the tube.
    outside: bool,
    /// Whether it starts on the surface.
    leaving: bool,
}

impl Walk {
    /// The next crossing. A part has two at most: there are two scans of it.
    #[inline]
    fn next<P: Math>(&mut self) -> Option<f32> {
        while let Some(&end) = self.parts.get(self.part) {
            // What ends before it begins is no part.
            if !(self.place < end) {
                self.part += 1;
                continue;
            }
            let sign = if self.part == 1 { -1.0 } else { 1.0 };
            let leaving = core::mem::replace(&mut self.leaving, false);
            if self.outside == (sign > 0.0) {
                // The function is above zero. What leaves does so upwards, and a convex function does not
                // come back.
                let met = match leaving {
                    true => None,
                    false => self.frame.fall::<P>(self.place, end, sign),
                };
                if let Some(t) = met {
                    self.place = t;
                    self.outside = !self.outside;
                    return Some(self.approach + t);
                }
                self.place = end;
                self.part += 1;
                continue;
            }
            // It is below, and rises over zero once or not at all.
            let begin = core::mem::replace(&mut self.place, end);
            self.part += 1;
            if self.frame.at::<P>(end, sign, false).0 > 0.0 {
                self.outside = !self.outside;
                let t = self.frame.fall::<P>(end, begin, sign);
                return Some(self.approach + t.unwrap_or(begin));
            }
        }
        None
    }
}

impl Torus {
    /// A torus round an axis of any length.
    ///
    /// # Errors
    ///
    /// Where a number is not finite, the axis is zero, or the minor radius is not between zero and the
    /// major one.
    pub fn new(center: Vec3, axis: Vec3, major: f32, minor: f32) -> Result<Self, TorusError> {
        let radii_are_finite = major.is_finite() && minor.is_finite();
        if !(center.is_finite() && axis.is_finite() && radii_are_finite) {
            return Err(TorusError::NotFinite);
        }
        let (_, axis) = math::unit(axis.to_array().map(f64::from)).ok_or(TorusError::ZeroAxis)?;
        if !(minor > 0.0 && minor < major) {
            return Err(TorusError::Radii);
        }
        Ok(Self {
            center,
            axis,
            major,
            minor,
        })
    }

    /// The ray's way through, as far as it may meet the surface.
    ///
    /// The squared distance from the circle is `|q|² + major² - 2 major ρ`, where `|q|²` is quadratic along
    /// the ray and ρ, the distance from the axis, is `sqrt(A s² + m²)`, s being measured from where that is
    /// least, m. So its second derivative is least there, and changes its sign at most twice, at known
    /// places: between them the function is concave, elsewhere it is convex, and has two zeros at most in
    /// each part.
    #[inline]
    fn walk<P: Math>(&self, ray: &Ray, leaving: Option<Side>) -> Option<Walk> {
        let from_center = ray.origin - self.center;
        let approach = -from_center.dot(ray.direction);
        let q = from_center + ray.direction * approach;
        let (along, along_rate) = (q.dot(self.axis), ray.direction.dot(self.axis));
        let frame = Frame {
            along,
            along_rate,
            across: q - self.axis * along,
            across_rate: ray.direction - self.axis * along_rate,
            major: self.major,
            minor: self.minor,
        };
        // Everything is in a ball and between two planes. Both are a little wider, for rounding.
        const WIDER: f32 = 1.0 + 1.0 / 256.0;
        let reach = (self.major + self.minor) * WIDER;
        let half_chord_squared = reach * reach - q.length_squared();
        // Also true for NaN.
        if !(half_chord_squared > 0.0) {
            return None;
        }
        let half_chord = P::sqrt(half_chord_squared);
        let height = self.minor * WIDER;
        let (enters, exits) = slab(along, along_rate, 1.0 / along_rate, -height, height)?;
        let enters = if enters > -half_chord {
            enters
        } else {
            -half_chord
        };
        let exits = if exits < half_chord {
            exits
        } else {
            half_chord
        };
        let origin = -approach;
        // Also true for NaN.
        if !(enters < exits && origin < exits) {
            return None;
        }
        // A ray that leaves a point off the surface may find a root before it enters.
        if leaving.is_none() && !(approach + enters < ray.t_max) {
            return None;
        }
        let (place, outside) = match leaving {
            Some(side) => (origin, side == Side::Outside),
            None if origin > enters => {
                let (value, rate) = frame.at::<P>(origin, 1.0, true);
                (origin, value > 0.0 || value == 0.0 && rate >= 0.0)
            }
            None => (enters, true),
        };
        // A and m² of above, in units of the major radius, where the powers below are the same at every
        // scale.
        let a = frame.across_rate.length_squared();
        let middle = -frame.across.dot(frame.across_rate) / a;
        let least = (frame.across + frame.across_rate * middle) / self.major;
        let least_squared = least.length_squared();
        // (A m²)^(2/3), against m²: where A / ρ³ m² is 1 / major.
        let bend = math::two_thirds_power(a * least_squared) - least_squared;
        let half_width = self.major * P::sqrt(math::positive(bend / a));
        let clamped = |t: f32| if t < exits { t } else { exits };
        let parts = if middle.is_finite() {
            [
                clamped(middle - half_width),
                clamped(middle + half_width),
                exits,
            ]
        } else {
            // Parallel to the axis there is nothing concave.
            [exits; 3]
        };
        Some(Walk {
            frame,
            approach,
            parts,
            part: 0,
            place,
            outside,
            leaving: leaving.is_some(),
        })
    }
}

impl Shape for Torus {
    type Setup = ();

    #[inline(always)]
    fn setup(_: &Ray) {}

    #[inline]
    fn intersect<P: Math>(&self, ray: &Ray, _: &(), leaving: Option<Side>) -> Option<f32> {
        let mut walk = self.walk::<P>(ray, leaving)?;
        loop {
            let t = walk.next::<P>()?;
            if t > 0.0 {
                return ray.admitted(t);
            }
        }
    }

    #[inline]
    fn crossings<P: Math>(&self, ray: &Ray, _: &(), leaving: Option<Side>) -> u32 {
        let Some(mut walk) = self.walk::<P>(ray, leaving) else {
            return 0;
        };
        let mut count = 0;
        while let Some(t) = walk.next::<P>() {
            count += ray.admits(t) as u32;
        }
        count
    }

    #[inline]
    fn inside<P: Math>(&self, ray: &Ray, _: &(), leaving: Option<Side>) -> f32 {
        let Some(mut walk) = self.walk::<P>(ray, leaving) else {
            return 0.0;
        };
        let (mut sum, mut entry) = (0.0, if walk.outside { ray.t_max } else { 0.0 });
        while let Some(t) = walk.next::<P>() {
            if walk.outside {
                sum += within(ray, entry, t);
                entry = ray.t_max;
            } else {
                entry = t;
            }
        }
        sum + within(ray, entry, ray.t_max)
    }

    /// The angle about the axis, and that about the circle, each from 0 to 1; v is 1/2 farthest from the axis.
    #[inline]
    fn uv(&self, point: Vec3) -> (f32, f32) {
        let q = point - self.center;
        let (u, across) = mapping::around(q, self.axis);
        (u, mapping::turn(q.dot(self.axis), across - self.major))
    }

    #[inline]
    fn normal<P: Math>(&self, ray: &Ray, t: f32) -> Vec3 {
        let q = ray.at(t) - self.center;
        let along = q.dot(self.axis);
        let across = q - self.axis * along;
        let square = across.length_squared();
        let outward = if square > 0.0 {
            across * P::sqrt_and_recip(square).1
        } else {
            Vec3::ZERO
        };
        // From the nearest point of the circle.
        P::normalize(q - outward * self.major)
    }
}

impl Closed for Torus {
    const CROSSINGS: usize = 4;

    #[inline]
    fn cross<P: Math>(
        &self,
        ray: &Ray,
        leaving: Option<Side>,
        visit: &mut impl FnMut(f32),
    ) -> bool {
        if let Some(mut walk) = self.walk::<P>(ray, leaving) {
            // As many as a walk has.
            while let Some(t) = walk.next::<P>() {
                if ray.admits(t) {
                    visit(t);
                }
            }
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Exact;

    const RING: Torus = Torus {
        center: Vec3::ZERO,
        axis: Vec3::Y,
        major: 2.0,
        minor: 0.5,
    };

    fn meets(torus: &Torus, origin: [f32; 3], direction: [f32; 3]) -> (Option<f32>, u32) {
        let direction = Exact::normalize(Vec3::from_array(direction));
        let ray = Ray::new(Vec3::from_array(origin), direction);
        let t = torus.intersect::<Exact>(&ray, &(), None);
        (t, torus.crossings::<Exact>(&ray, &(), None))
    }

    #[test]
    fn the_tube_is_met_and_the_hole_is_not() {
        let (x, y) = ([1.0, 0.0, 0.0], [0.0, -1.0, 0.0]);
        let cases = [
            ("across", [-5.0, 0.0, 0.0], x, Some(2.5), 4),
            ("from far", [-1e6, 0.0, 0.0], x, Some(1e6 - 2.5), 4),
            ("beside the hole", [-5.0, 0.0, 2.0], x, Some(3.5), 2),
            ("over it", [-5.0, 0.501, 0.0], x, None, 0),
            ("down through the tube", [2.0, 5.0, 0.0], y, Some(4.5), 2),
            ("down through the hole", [1.0, 5.0, 0.0], y, None, 0),
            ("along the axis", [0.0, 5.0, 0.0], y, None, 0),
            ("past it", [3.0, 5.0, 0.0], y, None, 0),
            ("from the center", [0.0, 0.0, 0.0], x, Some(1.5), 2),
            ("in the tube", [2.0, 0.0, 0.0], x, Some(0.5), 1),
            (
                "in the tube, inward",
                [2.0, 0.0, 0.0],
                [-1.0, 0.0, 0.0],
                Some(0.5),
                3,
            ),
            ("behind", [5.0, 0.0, 0.0], x, None, 0),
            ("on top", [-5.0, 0.5, 0.0], x, Some(3.0), 4),
        ];
        for (name, origin, direction, t, count) in cases {
            let (found, crossings) = meets(&RING, origin, direction);
            assert_eq!(found.is_some(), t.is_some(), "{name}: {found:?}");
            let off = found.zip(t).map_or(0.0, |(found, t)| (found - t).abs() / t);
            assert!(off < 2e-4, "{name}: {found:?}");
            // What touches is met once, twice or never.
            assert!(
                crossings == count || name == "on top",
                "{name}: {crossings}"
            );
        }
    }

    #[test]
    fn normals_stand_on_the_tube() {
        let ray = Ray::new(Vec3::new(-5.0, 0.0, 0.0), Vec3::X);
        assert_eq!(RING.normal::<Exact>(&ray, 2.5), Vec3::NEG_X);
        assert_eq!(RING.normal::<Exact>(&ray, 3.5), Vec3::X);
        let down = Ray::new(Vec3::new(0.0, 5.0, 2.0), Vec3::NEG_Y);
        assert_eq!(RING.normal::<Exact>(&down, 4.5), Vec3::Y);
    }

    #[test]
    fn what_leaves_meets_only_other_points() {
        let left = |origin: [f32; 3], direction: Vec3, side| {
            let ray = Ray::new(Vec3::from_array(origin), direction);
            let t = RING.intersect::<Exact>(&ray, &(), Some(side));
            (t, RING.crossings::<Exact>(&ray, &(), Some(side)))
        };
        use Side::{Inside, Outside};
        assert_eq!(left([-2.5, 0.0, 0.0], Vec3::NEG_X, Outside), (None, 0));
        let (t, count) = left([-2.5, 0.0, 0.0], Vec3::X, Inside);
        assert!(
            (t.unwrap() - 1.0).abs() < 1e-6 && count == 3,
            "{t:?} {count}"
        );
        let (t, count) = left([-1.5, 0.0, 0.0], Vec3::X, Outside);
        assert!(
            (t.unwrap() - 3.0).abs() < 1e-6 && count == 2,
            "{t:?} {count}"
        );
        let (t, count) = left([1.5, 0.0, 0.0], Vec3::X, Inside);
        assert!(
            (t.unwrap() - 1.0).abs() < 1e-6 && count == 1,
            "{t:?} {count}"
        );
    }

    #[test]
    fn degenerate_tori_are_refused() {
        let torus = |axis, major, minor| Torus::new(Vec3::ZERO, axis, major, minor);
        assert_eq!(torus(Vec3::ZERO, 2.0, 0.5), Err(TorusError::ZeroAxis));
        assert_eq!(torus(Vec3::Y, 2.0, 0.0), Err(TorusError::Radii));
        assert_eq!(torus(Vec3::Y, 2.0, 2.0), Err(TorusError::Radii));
        assert_eq!(
            torus(Vec3::Y, f32::INFINITY, 1.0),
            Err(TorusError::NotFinite)
        );
        assert_eq!(torus(Vec3::Y * 9.0, 2.0, 0.5), Ok(RING));
    }

    #[test]
    fn what_is_not_a_number_is_not_met() {
        let ray = Ray::new(Vec3::new(-5.0, 0.0, 0.0), Vec3::X);
        let tori = [
            Torus {
                center: Vec3::NAN,
                ..RING
            },
            Torus {
                axis: Vec3::NAN,
                ..RING
            },
            Torus {
                major: f32::NAN,
                ..RING
            },
            Torus {
                minor: f32::NAN,
                ..RING
            },
        ];
        for torus in tori {
            assert_eq!(torus.intersect::<Exact>(&ray, &(), None), None, "{torus:?}");
        }
        for ray in [
            Ray::new(Vec3::NAN, Vec3::X),
            Ray::new(Vec3::X * -5.0, Vec3::NAN),
        ] {
            assert_eq!(RING.intersect::<Exact>(&ray, &(), None), None);
        }
    }
}
