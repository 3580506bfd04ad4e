//! Rays and hits.

use glam::Vec3;

use crate::math;

/// A half-line, up to `t_max`, and the surface that it leaves, if it leaves one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// In world space.
    pub origin: Vec3,
    /// Unit length: what the intersection methods are exact for.
    pub direction: Vec3,
    /// Nothing at this distance or beyond is met; in world units. Infinity: no end.
    pub t_max: f32,
    /// The surface on which `origin` lies.
    pub departure: Option<Departure>,
}

/// A surface that a ray leaves. It is not met again at the point that is left.
///
/// This takes the place of an offset: no distance, however small or large the scene, has to be
/// chosen. `whitted` skips the root of the equation, not the object: glass is met again from inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Departure {
    /// As in [`Hit::object`].
    pub object: usize,
    /// Where the ray goes from there.
    pub side: Side,
}

/// A side of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Where the outward normal points.
    Outside,
    /// The other side.
    Inside,
}

impl Ray {
    /// A ray without end that leaves no surface. `direction` is unit length.
    #[inline]
    pub const fn new(origin: Vec3, direction: Vec3) -> Self {
        Self {
            origin,
            direction,
            t_max: f32::INFINITY,
            departure: None,
        }
    }

    /// The point at distance `t`.
    #[cfg_attr(soft_float, inline(never))]
    #[cfg_attr(not(soft_float), inline)]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }

    /// Whether `t` lies in the open interval from 0 to `t_max`; false for NaN.
    #[cfg_attr(soft_float, inline(never))]
    #[cfg_attr(not(soft_float), inline(always))]
    pub fn admits(&self, t: f32) -> bool {
        math::is_positive(t) && t < self.t_max
    }

    /// `t` where the ray [admits](Self::admits) it.
    #[inline(always)]
    pub fn admitted(&self, t: f32) -> Option<f32> {
        if self.admits(t) { Some(t) } else { None }
    }

    /// The side on which the ray leaves this object, if it leaves it.
    #[inline(always)]
    pub fn leaves(&self, object: usize) -> Option<Side> {
        match self.departure {
            Some(departure) if departure.object == object => Some(departure.side),
            _ => None,
        }
    }
}

/// Where a ray meets a surface.
#[derive(Debug, PartialEq)]
pub struct Hit<'a, M> {
    /// Distance from the ray's origin, in world units; above 0 and below the ray's `t_max`.
    pub t: f32,
    /// `ray.at(t)`.
    pub point: Vec3,
    /// Unit length, turned to the side from which the ray comes.
    pub normal: Vec3,
    /// Whether the ray comes from outside.
    pub front: bool,
    /// The object's place in its geometry: left of a pair first, then slice order.
    pub object: usize,
    /// The object's material.
    pub material: &'a M,
}

impl<M> Clone for Hit<'_, M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<M> Copy for Hit<'_, M> {}

impl<M> Hit<'_, M> {
    /// The side from which the ray came.
    #[inline]
    pub fn near_side(&self) -> Side {
        if self.front {
            Side::Outside
        } else {
            Side::Inside
        }
    }

    /// The side that the ray would enter.
    #[inline]
    pub fn far_side(&self) -> Side {
        if self.front {
            Side::Inside
        } else {
            Side::Outside
        }
    }

    /// A ray without end from the hit point, on the side from which the first ray came: a mirrored
    /// ray, or one to a light. `direction` is unit length.
    #[inline]
    pub fn back(&self, direction: Vec3) -> Ray {
        self.leave(direction, self.near_side())
    }

    /// A ray without end from the hit point into the other side: a refracted ray, or one that goes
    /// on. `direction` is unit length.
    #[inline]
    pub fn through(&self, direction: Vec3) -> Ray {
        self.leave(direction, self.far_side())
    }

    #[inline]
    fn leave(&self, direction: Vec3, side: Side) -> Ray {
        Ray {
            origin: self.point,
            direction,
            t_max: f32::INFINITY,
            departure: Some(Departure {
                object: self.object,
                side,
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_is_open_and_excludes_what_is_not_a_number() {
        let ray = Ray {
            t_max: 2.0,
            ..Ray::new(Vec3::ZERO, Vec3::X)
        };
        let cases = [
            ("origin", 0.0, false),
            ("negative zero", -0.0, false),
            ("smallest", f32::from_bits(1), true),
            ("inside", 1.0, true),
            ("end", 2.0, false),
            ("behind", -1.0, false),
            ("infinite", f32::INFINITY, false),
            ("not a number", f32::NAN, false),
        ];
        for (name, t, admitted) in cases {
            assert_eq!(ray.admits(t), admitted, "{name}");
        }
        assert!(!Ray::new(Vec3::ZERO, Vec3::X).admits(f32::INFINITY));
    }

    #[test]
    fn rays_from_a_hit_name_the_side_into_which_they_go() {
        let hit = Hit {
            t: 1.0,
            point: Vec3::X,
            normal: Vec3::NEG_X,
            front: true,
            object: 7,
            material: &(),
        };
        assert_eq!(hit.back(Vec3::NEG_X).leaves(7), Some(Side::Outside));
        assert_eq!(hit.through(Vec3::X).leaves(7), Some(Side::Inside));
        assert_eq!(hit.through(Vec3::X).leaves(6), None);
        let from_inside = Hit {
            front: false,
            ..hit
        };
        assert_eq!(from_inside.back(Vec3::NEG_X).leaves(7), Some(Side::Inside));
        assert_eq!(from_inside.through(Vec3::X).leaves(7), Some(Side::Outside));
    }
}
