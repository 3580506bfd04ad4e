//! Boxes that hold every point at which a kernel can report a hit.
//!
//! A kernel's hit lies off its shape by rounding: by a few units u = 2^-24 of the coordinates of the
//! shape and of the ray's origin. What the shape contributes widens its box here, what the origin
//! contributes is added when a ray meets a node ([`super::nodes`]); the rounding of the node's own test
//! is within what both leave over.
//!
//! - A sphere, a frustum and a box report a point within 7 u of the sum of the coordinates' sizes from
//!   their surface; a frustum that gets wider by `slope` may overshoot its ends by a few u, and so its
//!   radius by `slope` times as much.
//! - A quadric's hits lie within its clip, as far as 7 u of the sum of the coordinates' sizes tell; a
//!   torus' within 7 u of its surface, and further only by as many u of the distance, which is the
//!   origin's share.
//! - An outline judges a ray's line by its shear: within 10 u, across the ray. The distance is that of
//!   its plane, with an error of 4 u, and how far the vertices are off the plane, over the cosine
//!   between ray and normal. Where that is below 1/8, the kernel keeps the distance between those at
//!   which the ray is as deep as the vertices, along the axis to which it is closest: only there is
//!   the point certain to lie within the box. Along the others it is off the box by no more than the
//!   ray goes while it is as deep as the outline, its [`spread`].

use glam::{Vec3, Vec3A};
use whitted::{Cuboid, Frustum, Quadric, Sphere, Torus};

/// 128 u of a coordinate: more than rounding moves a hit.
pub const ROUNDING: f32 = 1.0 / (1 << 17) as f32;

/// Beyond this coordinates and their reciprocals' products may leave the range of `f32`.
pub const FAR: f32 = (1_u64 << 60) as f32;

/// The steepest frustum whose overshoot [`super::nodes`] allows for.
pub const STEEP: f32 = 64.0;

/// An axis-aligned box.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    pub min: Vec3A,
    pub max: Vec3A,
}

impl Bounds {
    pub const EMPTY: Self = Self {
        min: Vec3A::INFINITY,
        max: Vec3A::NEG_INFINITY,
    };

    #[inline(always)]
    pub fn grow(&mut self, other: &Self) {
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
    }

    /// Half of the surface, which is in proportion to how many rays meet it.
    #[inline(always)]
    pub fn area(&self) -> f32 {
        let size = self.max - self.min;
        size.x * (size.y + size.z) + size.y * size.z
    }

    fn of(points: &[Vec3]) -> Self {
        let mut bounds = Self::EMPTY;
        for &point in points {
            let point = Vec3A::from(point);
            bounds.grow(&Self {
                min: point,
                max: point,
            });
        }
        bounds
    }

    fn reach(&self) -> f32 {
        self.min.abs().max(self.max.abs()).max_element()
    }

    /// Wider by `margin` everywhere; `None` where that is not well within the range of `f32`.
    fn widened(self, margin: Vec3A) -> Option<Self> {
        let bounds = Self {
            min: self.min - margin,
            max: self.max + margin,
        };
        (bounds.min.is_finite() && bounds.max.is_finite() && bounds.reach() < FAR).then_some(bounds)
    }
}

pub fn of_sphere(sphere: &Sphere) -> Option<Bounds> {
    let (center, radius) = (
        Vec3A::from(sphere.center),
        Vec3A::splat(sphere.radius.abs()),
    );
    let bounds = Bounds {
        min: center - radius,
        max: center + radius,
    };
    bounds.widened(Vec3A::splat(ROUNDING * bounds.reach()))
}

pub fn of_cuboid(cuboid: &Cuboid) -> Option<Bounds> {
    let bounds = Bounds {
        min: cuboid.min.into(),
        max: cuboid.max.into(),
    };
    if !cuboid.min.cmple(cuboid.max).all() {
        return None;
    }
    bounds.widened(Vec3A::splat(ROUNDING * bounds.reach()))
}

pub fn of_frustum(frustum: &Frustum) -> Option<Bounds> {
    let axis = Vec3A::from(frustum.axis);
    if !((axis.length_squared() - 1.0).abs() < ROUNDING && frustum.slope.abs() <= STEEP) {
        return None;
    }
    // How far a disc across the axis reaches along the coordinates.
    let across = sine(axis);
    let mut bounds = Bounds::EMPTY;
    let mut reach = 0.0_f32;
    for along in [0.0, frustum.length] {
        let center = Vec3A::from(frustum.base) + axis * along;
        let radius = (frustum.base_radius + frustum.slope * along).abs();
        bounds.grow(&Bounds {
            min: center - across * radius,
            max: center + across * radius,
        });
        reach = reach.max(center.abs().max_element() + radius);
    }
    let reach = reach + frustum.length;
    bounds.widened(Vec3A::splat(ROUNDING * reach * (1.0 + frustum.slope.abs())))
}

/// What its clip lets through, wherever the quadric is: a hit is compared with that.
pub fn of_quadric(quadric: &Quadric) -> Option<Bounds> {
    let center = Vec3A::from(quadric.center);
    let clip = &quadric.clip;
    if !clip.min.cmple(clip.max).all() {
        return None;
    }
    let bounds = Bounds {
        min: center + Vec3A::from(clip.min),
        max: center + Vec3A::from(clip.max),
    };
    // The sums are rounded.
    let reach = bounds.reach() + center.abs().max_element();
    bounds.widened(Vec3A::splat(ROUNDING * reach))
}

pub fn of_torus(torus: &Torus) -> Option<Bounds> {
    let axis = Vec3A::from(torus.axis);
    if !((axis.length_squared() - 1.0).abs() < ROUNDING) {
        return None;
    }
    let center = Vec3A::from(torus.center);
    let reach = sine(axis) * torus.major.abs() + torus.minor.abs();
    let bounds = Bounds {
        min: center - reach,
        max: center + reach,
    };
    let reach = center.abs().max_element() + torus.major.abs() + torus.minor.abs();
    bounds.widened(Vec3A::splat(ROUNDING * reach))
}

pub fn of_outline(vertices: &[Vec3], normal: Vec3) -> Option<Bounds> {
    let &point = vertices.first()?;
    let bounds = Bounds::of(vertices);
    let reach = bounds.reach();
    let unit = (normal.length_squared() - 1.0).abs() < ROUNDING;
    if !(unit && vertices.iter().all(|it| it.is_finite())) {
        return None;
    }
    // How far the vertices are off the plane that gives the distance.
    let height = vertices
        .iter()
        .map(|&vertex| normal.dot(vertex - point).abs())
        .fold(0.0, f32::max);
    bounds.widened(Vec3A::splat(ROUNDING * reach + 8.0 * height))
}

/// How far along a ray from the box round an outline its kernel may report a hit.
pub fn spread(bounds: &Bounds) -> f32 {
    // A unit vector's largest component is at least the reciprocal of the square root of 3, here rounded up.
    const AT_MOST: f32 = 1.733;
    AT_MOST * (bounds.max - bounds.min).max_element()
}

/// At least the sines of the angles between a unit vector and the axes.
fn sine(unit: Vec3A) -> Vec3A {
    let square = (Vec3A::ONE - unit * unit).max(Vec3A::ZERO) + ROUNDING;
    Vec3A::new(square.x.sqrt(), square.y.sqrt(), square.z.sqrt())
}
