//! Spheres round objects: a few fused terms tell which of many rays surely miss which of few objects.
//!
//! With `c` and `R` of a sphere that holds an object, and a ray from `o` along `d`, the ray's line is
//! closest to `c` at `b = c.d - o.d`, and misses the sphere where `b^2 < (c.c - R^2) + o.o - 2 c.o`. Where
//! the right side is above zero, the ray starts outside, and where also `b` is below, the sphere is behind.
//! These forms cost few operations and much accuracy, for which they pay with a margin:
//!
//! - Each of the sums, in any order, is off by less than 8 u of the product of the vectors' lengths
//!   (u = 2^-24), and both sides together by less than 64 u of `c.c + o.o + R^2`.
//! - A direction's square is off 1 by at most 2^-17 = 128 u: `b^2` stands for up to 129 u more of
//!   `|c - o|^2 <= 2 (c.c + o.o)`.
//! - What a kernel reports is as far from its object as 128 u of the object's coordinates, which are in
//!   `R`, and 128 u of the sum of the ray's, which is at most 384 u of `|o|` ([`bounds`](super::bounds)):
//!   `(R + 384 u |o|)^2 <= (1 + M) R^2 + (1 + 1 / M) (384 u)^2 o.o`.
//!
//! With `M` = 2^-14 = 1024 u, the last is 145 u of `o.o`, and `M R^2` is what it takes of `R^2`. A ray that
//! misses has `R^2 < |c - o|^2`, so that all errors together are less than `M (c.c + o.o)`. Of an outline that
//! holds for the ray's line only, not for the point on it. Objects so small, and so near the origin, that
//! squares lose digits at the end of the range are not passed over.

use fearless_simd::Simd;
use glam::{DVec3, Vec3};
use whitted::{Cuboid, Sphere};

use super::bounds::ROUNDING;
use super::lanes::{Lanes, Vectors};

/// `M`.
const MARGIN: f64 = 1.0 / (1 << 14) as f64;

/// Squares of what is larger are far from the end of the range: 2^-40.
const TINY: f64 = 1.0 / (1_u64 << 40) as f64;

/// A sphere round an object.
#[derive(Clone, Copy, Debug)]
pub struct Around {
    center: Vec3,
    /// `c.c - R^2`, less the margin.
    power: f32,
    /// Zero; of an outline, of which only the ray's line is certain, minus infinity.
    least: f32,
}

/// What rays, one a lane, compute once to meet all spheres.
#[derive(Clone, Copy)]
pub struct Passing<V> {
    direction: Vectors<V>,
    /// `-2 o`.
    from: Vectors<V>,
    /// `-o.d`.
    before: V,
    /// `o.o`, less the margin.
    square: V,
}

impl Around {
    /// No ray is certain to miss it.
    pub const ALL: Self = Self {
        center: Vec3::ZERO,
        power: f32::NEG_INFINITY,
        least: 0.0,
    };

    pub fn sphere(sphere: &Sphere) -> Self {
        Self::new(sphere.center, f64::from(sphere.radius.abs()))
    }

    pub fn cuboid(cuboid: &Cuboid) -> Self {
        Self::points(&[cuboid.min, cuboid.max])
    }

    pub fn outline(vertices: &[Vec3]) -> Self {
        Self {
            least: f32::NEG_INFINITY,
            ..Self::points(vertices)
        }
    }

    fn points(points: &[Vec3]) -> Self {
        let Some(&first) = points.first() else {
            return Self::ALL;
        };
        // Towards the farthest point, by less and less: M. Badoiu, K. L. Clarkson, "Smaller Core-Sets for
        // Balls", SODA 2003.
        let squared = |center: Vec3, point: &Vec3| point.as_dvec3().distance_squared(center.into());
        let mut center = first;
        // The radius is that of the center that this ends with.
        for step in 1..17 {
            let far = |a: &&Vec3, b: &&Vec3| squared(center, a).total_cmp(&squared(center, b));
            let farthest = points.iter().max_by(far).unwrap_or(&first);
            center += (farthest - center) / (step + 1) as f32;
        }
        let square = points.iter().map(|it| squared(center, it));
        Self::new(center, square.fold(0.0, f64::max).sqrt())
    }

    fn new(center: Vec3, radius: f64) -> Self {
        let center64: DVec3 = center.as_dvec3();
        let reach = center64.abs().max_element() + radius;
        if reach < TINY {
            return Self::ALL;
        }
        // Along each of three coordinates.
        let radius = radius + 2.0 * f64::from(ROUNDING) * reach;
        let power = center64.length_squared() * (1.0 - MARGIN) - radius * radius * (1.0 + MARGIN);
        Self {
            center,
            power: power as f32,
            least: 0.0,
        }
    }
}

impl<V: Copy> Passing<V> {
    #[inline(always)]
    pub fn new<S: Simd>(simd: S, origin: Vectors<V>, direction: Vectors<V>) -> Self
    where
        V: Lanes<S>,
    {
        let rest = V::simd_from(simd, (1.0 - MARGIN) as f32);
        Self {
            direction,
            from: origin * V::simd_from(simd, -2.0),
            before: -origin.dot(direction),
            square: origin.dot(origin) * rest,
        }
    }

    /// Which rays surely miss an object.
    #[inline(always)]
    pub fn misses<S: Simd>(&self, simd: S, around: &Around) -> V::Mask
    where
        V: Lanes<S>,
    {
        let c = Vectors::<V>::splat(simd, around.center);
        let (d, from) = (self.direction, self.from);
        let b =
            c.x.mul_add(d.x, c.y.mul_add(d.y, c.z.mul_add(d.z, self.before)));
        let square = self.square + V::simd_from(simd, around.power);
        let power =
            c.x.mul_add(from.x, c.y.mul_add(from.y, c.z.mul_add(from.z, square)));
        let b = b.max(V::simd_from(simd, around.least));
        (b * b).simd_lt(power)
    }
}
