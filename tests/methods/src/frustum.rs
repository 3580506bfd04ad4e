//! Ray and open cylinder or cone.
//!
//! `along` is how far along the axis from the base a point is, `across` what is left of it then. In `t`
//! the surface is `a t² + 2 b t + c = 0`, of which the roots between the ends count.

use glam::Vec3;
use whitted::math::sqrt;
use whitted::{Exact, Frustum, Ray, Shape};

use crate::Method;

/// Distance to the nearest point of the side that the ray admits.
pub type FrustumMethod = Method<fn(&Ray, &Frustum) -> Option<f32>>;

/// All methods.
pub const METHODS: &[FrustumMethod] = &[
    Method::new("core", core),
    Method::new("plain", plain),
    Method::new("plain, stable q", plain_stable),
    Method::new("shift", shift),
    Method::new("shift, triple product", shift_triple),
    Method::new("shift, Lagrange", shift_lagrange),
    Method::new("f64", double),
];

/// The kernel of `whitted`.
#[inline(never)]
pub fn core(ray: &Ray, frustum: &Frustum) -> Option<f32> {
    frustum.intersect::<Exact>(ray, &(), None)
}

/// A ray seen from the frustum: at `t` the point is `along + t * along_rate` along the axis, and so on.
struct Local {
    along: f32,
    along_rate: f32,
    across: Vec3,
    across_rate: Vec3,
    radius: f32,
    radius_rate: f32,
}

impl Local {
    #[inline(always)]
    fn new(from_base: Vec3, direction: Vec3, frustum: &Frustum) -> Self {
        let along = from_base.dot(frustum.axis);
        let along_rate = direction.dot(frustum.axis);
        Self {
            along,
            along_rate,
            across: from_base - frustum.axis * along,
            across_rate: direction - frustum.axis * along_rate,
            radius: frustum.base_radius + frustum.slope * along,
            radius_rate: frustum.slope * along_rate,
        }
    }

    #[inline(always)]
    fn quadratic(&self) -> (f32, f32, f32) {
        (
            self.across_rate.dot(self.across_rate) - self.radius_rate * self.radius_rate,
            self.across.dot(self.across_rate) - self.radius * self.radius_rate,
            self.across.dot(self.across) - self.radius * self.radius,
        )
    }

    /// The nearest of two roots that is between the ends, on the cone's own half and admitted.
    #[inline(always)]
    fn choose(&self, ray: &Ray, frustum: &Frustum, shift: f32, roots: [f32; 2]) -> Option<f32> {
        let mut nearest = None;
        for root in roots {
            let along = self.along + root * self.along_rate;
            let radius = self.radius + root * self.radius_rate;
            if along >= 0.0 && along <= frustum.length && radius >= 0.0 {
                let t = shift + root;
                if ray.admits(t) && nearest.is_none_or(|best| t < best) {
                    nearest = Some(t);
                }
            }
        }
        nearest
    }
}

#[inline(always)]
fn stable(a: f32, b: f32, c: f32, root: f32) -> [f32; 2] {
    let q = -(b + root.copysign(b));
    [q / a, c / q]
}

/// The quadratic from the ray's origin.
#[inline(never)]
pub fn plain(ray: &Ray, frustum: &Frustum) -> Option<f32> {
    let local = Local::new(ray.origin - frustum.base, ray.direction, frustum);
    let (a, b, c) = local.quadratic();
    let discriminant = b * b - a * c;
    if !(discriminant >= 0.0) {
        return None;
    }
    let root = sqrt(discriminant);
    local.choose(ray, frustum, 0.0, [(-b - root) / a, (-b + root) / a])
}

/// The same with a stable q.
#[inline(never)]
pub fn plain_stable(ray: &Ray, frustum: &Frustum) -> Option<f32> {
    let local = Local::new(ray.origin - frustum.base, ray.direction, frustum);
    let (a, b, c) = local.quadratic();
    let discriminant = b * b - a * c;
    if !(discriminant >= 0.0) {
        return None;
    }
    local.choose(ray, frustum, 0.0, stable(a, b, c, sqrt(discriminant)))
}

#[inline(always)]
fn shifted(ray: &Ray, frustum: &Frustum) -> (f32, Local) {
    let to_base = frustum.base - ray.origin;
    let approach = to_base.dot(ray.direction);
    let from_base = ray.direction * approach - to_base;
    (approach, Local::new(from_base, ray.direction, frustum))
}

/// The quadratic from where the ray is closest to the base's center, as Wald shifts the sphere's.
#[inline(never)]
pub fn shift(ray: &Ray, frustum: &Frustum) -> Option<f32> {
    let (approach, local) = shifted(ray, frustum);
    let (a, b, c) = local.quadratic();
    let discriminant = b * b - a * c;
    if !(discriminant >= 0.0) {
        return None;
    }
    local.choose(ray, frustum, approach, stable(a, b, c, sqrt(discriminant)))
}

/// The discriminant by Lagrange's identity, the cross product taken as one number along the axis.
#[inline(never)]
pub fn shift_triple(ray: &Ray, frustum: &Frustum) -> Option<f32> {
    let (approach, local) = shifted(ray, frustum);
    let (a, b, c) = local.quadratic();
    let growth = local.across_rate * local.radius - local.across * local.radius_rate;
    let twist = frustum.axis.dot(local.across.cross(local.across_rate));
    let discriminant = growth.dot(growth) - twist * twist;
    if !(discriminant >= 0.0) {
        return None;
    }
    local.choose(ray, frustum, approach, stable(a, b, c, sqrt(discriminant)))
}

/// The discriminant by Lagrange's identity: b² - a c = |radius across' - radius' across|² -
/// |across x across'|², where what cancels in the former is left out.
#[inline(never)]
pub fn shift_lagrange(ray: &Ray, frustum: &Frustum) -> Option<f32> {
    let (approach, local) = shifted(ray, frustum);
    let (a, b, c) = local.quadratic();
    let growth = local.across_rate * local.radius - local.across * local.radius_rate;
    let twist = local.across.cross(local.across_rate);
    let discriminant = growth.dot(growth) - twist.dot(twist);
    if !(discriminant >= 0.0) {
        return None;
    }
    local.choose(ray, frustum, approach, stable(a, b, c, sqrt(discriminant)))
}

/// The same in `f64`, from the ray's origin.
#[inline(never)]
pub fn double(ray: &Ray, frustum: &Frustum) -> Option<f32> {
    let dot = crate::sphere::dot;
    let wide = |v: Vec3| v.to_array().map(f64::from);
    let (axis, d) = (wide(frustum.axis), wide(ray.direction));
    let from_base = crate::sphere::difference(ray.origin, frustum.base);
    let (along, along_rate) = (dot(from_base, axis), dot(d, axis));
    let across = [0, 1, 2].map(|i| from_base[i] - along * axis[i]);
    let across_rate = [0, 1, 2].map(|i| d[i] - along_rate * axis[i]);
    let slope = f64::from(frustum.slope);
    let (radius, radius_rate) = (
        f64::from(frustum.base_radius) + slope * along,
        slope * along_rate,
    );
    let a = dot(across_rate, across_rate) - radius_rate * radius_rate;
    let b = dot(across, across_rate) - radius * radius_rate;
    let c = dot(across, across) - radius * radius;
    let growth = [0, 1, 2].map(|i| across_rate[i] * radius - across[i] * radius_rate);
    let twist = [
        across[1] * across_rate[2] - across[2] * across_rate[1],
        across[2] * across_rate[0] - across[0] * across_rate[2],
        across[0] * across_rate[1] - across[1] * across_rate[0],
    ];
    let discriminant = dot(growth, growth) - dot(twist, twist);
    if !(discriminant >= 0.0) {
        return None;
    }
    let q = -(b + libm::sqrt(discriminant).copysign(b));
    let mut nearest = None;
    for root in [q / a, c / q] {
        let along = along + root * along_rate;
        let radius = radius + root * radius_rate;
        if along >= 0.0 && along <= f64::from(frustum.length) && radius >= 0.0 {
            let t = root as f32;
            if ray.admits(t) && nearest.is_none_or(|best| t < best) {
                nearest = Some(t);
            }
        }
    }
    nearest
}
