//! Shapes: where a ray meets them, and which way they face there.

use glam::Vec3;

use crate::candidates::Beam;
use crate::math::{self, Math};
use crate::ray::{Ray, Side};

pub mod cuboid;
pub mod frustum;
mod mapping;
pub mod patch;
pub mod plane;
pub mod polygon;
pub mod quadric;
pub mod sphere;
pub mod torus;
pub mod triangle;

/// A surface that rays can meet.
///
/// A firmware adds its own by implementing this; a slice of [`Object`](crate::Object)s of it is then
/// a [`Geometry`](crate::Geometry) like any other.
///
/// The methods are generic over the [`Math`] policy, so that one binary can hold both; where a shape
/// takes no root it ignores it.
///
/// ```
/// use whitted::{Math, Ray, Shape, Side, Vec3};
///
/// /// A disc that lies in y = 0.
/// struct Disc { radius: f32 }
///
/// impl Shape for Disc {
///     type Setup = ();
///
///     fn setup(_: &Ray) {}
///
///     fn intersect<P: Math>(&self, ray: &Ray, _: &(), leaving: Option<Side>) -> Option<f32> {
///         if leaving.is_some() {
///             return None; // A flat surface is not met again by what leaves it.
///         }
///         let t = ray.admitted(-ray.origin.y / ray.direction.y)?;
///         (ray.at(t).length_squared() <= self.radius * self.radius).then_some(t)
///     }
///
///     fn normal<P: Math>(&self, _: &Ray, _: f32) -> Vec3 {
///         Vec3::Y
///     }
/// }
/// ```
pub trait Shape {
    /// What all shapes of this kind need to know of a ray, computed once a ray and slice; `()` where
    /// there is nothing.
    type Setup;

    /// Prepares a ray. Reads its origin and direction only.
    fn setup(ray: &Ray) -> Self::Setup;

    /// Distance to the nearest point that the ray [admits](Ray::admits).
    ///
    /// `leaving` is set where the ray's origin lies on this very surface, and says on which side of it
    /// the ray goes on; the point that it leaves must then not be met, whatever rounding makes of it.
    fn intersect<P: Math>(
        &self,
        ray: &Ray,
        setup: &Self::Setup,
        leaving: Option<Side>,
    ) -> Option<f32>;

    /// The same as [`intersect`](Self::intersect), for rays of which many leave the shape behind, as those do
    /// that [`Culled`](crate::Culled) is asked about: what tells that early costs others more than it saves.
    #[inline(always)]
    fn intersect_ahead<P: Math>(
        &self,
        ray: &Ray,
        setup: &Self::Setup,
        leaving: Option<Side>,
    ) -> Option<f32> {
        self.intersect::<P>(ray, setup, leaving)
    }

    /// Whether no ray that leaves it to this side meets it again. No, by default, which is always right.
    #[inline(always)]
    fn is_left_for_good(&self, side: Side) -> bool {
        let _ = side;
        false
    }

    /// How many points of the surface the ray admits. Shadow rays count what they cross.
    ///
    /// The default is right for flat surfaces; one that a ray can cross twice must count.
    #[inline]
    fn crossings<P: Math>(&self, ray: &Ray, setup: &Self::Setup, leaving: Option<Side>) -> u32 {
        self.intersect::<P>(ray, setup, leaving).is_some() as u32
    }

    /// Whether surely none of these rays meets it: what [`Culled`](crate::Culled) passes over. No, by
    /// default.
    #[inline(always)]
    fn is_missed(&self, beam: &Beam) -> bool {
        let _ = beam;
        false
    }

    /// How far the ray goes inside, between its origin and its end, which is in world units: for media that
    /// absorb light. 0, by default: what encloses nothing has no inside, nor has a shape of which only the
    /// inside is visible.
    #[inline]
    fn inside<P: Math>(&self, ray: &Ray, setup: &Self::Setup, leaving: Option<Side>) -> f32 {
        let _ = (ray, setup, leaving);
        0.0
    }

    /// Coordinates of a point of the surface, for images: u to the right and v upwards, for who looks from
    /// outside. Each shape says in which units. (0, 0), by default.
    #[inline]
    fn uv(&self, point: Vec3) -> (f32, f32) {
        let _ = point;
        (0.0, 0.0)
    }

    /// Unit normal of the outward side, where [`intersect`](Self::intersect) put this ray's hit.
    fn normal<P: Math>(&self, ray: &Ray, t: f32) -> Vec3;
}

/// How much of what a ray goes through from `entry` to `exit` lies before its end and not behind it; 0 for
/// NaN.
#[inline]
fn within(ray: &Ray, entry: f32, exit: f32) -> f32 {
    if !(entry <= exit) {
        return 0.0;
    }
    let start = if entry > 0.0 { entry } else { 0.0 };
    let end = if exit < ray.t_max { exit } else { ray.t_max };
    math::positive(end - start)
}

/// A shape that parts what is inside of it from what is outside: a leaf of [solid
/// geometry](crate::csg).
///
/// Spheres, whose radius must be above zero, boxes, tori, planes, inside of which is what lies behind them,
/// and quadrics that are ellipsoids or have no open ends.
pub trait Closed: Shape {
    /// At how many points a ray crosses it, at most.
    const CROSSINGS: usize;

    /// Calls `visit` with each distance above 0 and below infinity at which the ray, which has no end,
    /// crosses the surface, and tells whether it is inside in the end. `leaving` is as for
    /// [`intersect`](Shape::intersect).
    fn cross<P: Math>(&self, ray: &Ray, leaving: Option<Side>, visit: &mut impl FnMut(f32))
    -> bool;
}
