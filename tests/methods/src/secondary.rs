//! Where a ray that leaves a surface starts, so that it does not meet that surface again.

use glam::Vec3;

use crate::Method;

/// A hit, and what leaves it.
#[derive(Clone, Copy, Debug)]
pub struct Leaving {
    /// Origin of the ray that arrived.
    pub eye: Vec3,
    /// Its direction times the distance.
    pub way: Vec3,
    /// Where it met the surface.
    pub point: Vec3,
    /// Unit normal of the surface, on the side that is left to.
    pub normal: Vec3,
    /// A point of the primitive: the center of a sphere.
    pub anchor: Vec3,
    /// Radius of a sphere, 0 for flat ones.
    pub radius: f32,
}

/// Where to start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// The new origin.
    pub origin: Vec3,
    /// Nothing nearer counts.
    pub t_min: f32,
    /// The primitive that is left is not asked for the root that is left.
    pub skips: bool,
}

/// A strategy.
pub type SecondaryMethod = Method<fn(&Leaving) -> Start>;

/// All strategies.
pub const METHODS: &[SecondaryMethod] = &[
    Method::new("core", skip),
    Method::new("nothing", nothing),
    Method::new("t_min 1e-3", t_min_3),
    Method::new("t_min 1e-4", t_min_4),
    Method::new("normal 1e-3", normal_3),
    Method::new("normal 1e-4", normal_4),
    Method::new("relative 2^-20", relative),
    Method::new("Waechter-Binder", waechter_binder),
    Method::new("error bound", error_bound),
    Method::new("skip, error bound", skip_error_bound),
    Method::new("skip, outward", skip_outward),
];

impl Start {
    #[inline(always)]
    fn at(origin: Vec3) -> Self {
        Self {
            origin,
            t_min: 0.0,
            skips: false,
        }
    }
}

/// As `whitted` does: the ray names the surface and the side, and that root is skipped.
#[inline(never)]
pub fn skip(leaving: &Leaving) -> Start {
    Start {
        skips: true,
        ..Start::at(leaving.point)
    }
}

/// From the point itself.
#[inline(never)]
pub fn nothing(leaving: &Leaving) -> Start {
    Start::at(leaving.point)
}

/// A fixed least distance.
#[inline(never)]
pub fn t_min_3(leaving: &Leaving) -> Start {
    Start {
        t_min: 1e-3,
        ..Start::at(leaving.point)
    }
}

/// A fixed least distance.
#[inline(never)]
pub fn t_min_4(leaving: &Leaving) -> Start {
    Start {
        t_min: 1e-4,
        ..Start::at(leaving.point)
    }
}

/// A fixed way along the normal.
#[inline(never)]
pub fn normal_3(leaving: &Leaving) -> Start {
    Start::at(leaving.point + leaving.normal * 1e-3)
}

/// A fixed way along the normal.
#[inline(never)]
pub fn normal_4(leaving: &Leaving) -> Start {
    Start::at(leaving.point + leaving.normal * 1e-4)
}

/// A way along the normal in proportion to the largest coordinate of the point or of the way to it.
#[inline(never)]
pub fn relative(leaving: &Leaving) -> Start {
    let size = |v: Vec3| {
        let v = v.abs();
        let xy = if v.x > v.y { v.x } else { v.y };
        if xy > v.z { xy } else { v.z }
    };
    let (point, way) = (size(leaving.point), size(leaving.way));
    let largest = if point > way { point } else { way };
    Start::at(leaving.point + leaving.normal * (largest / 1_048_576.0))
}

/// Whole steps of each coordinate away from 0, a fixed way near 0: C. Wächter, N. Binder, "A Fast and
/// Robust Method for Avoiding Self-Intersection", Ray Tracing Gems (2019), ch. 6.
#[inline(never)]
pub fn waechter_binder(leaving: &Leaving) -> Start {
    let offset = |p: f32, n: f32| {
        if p.abs() < 1.0 / 32.0 {
            return p + n / 65_536.0;
        }
        let steps = (256.0 * n) as i32;
        let steps = if p < 0.0 { -steps } else { steps };
        f32::from_bits(p.to_bits().wrapping_add_signed(steps))
    };
    let (p, n) = (leaving.point, leaving.normal);
    Start::at(Vec3::new(
        offset(p.x, n.x),
        offset(p.y, n.y),
        offset(p.z, n.z),
    ))
}

/// Four times the error that the intersection can have made, along the normal: the bound of M. Pharr,
/// W. Jakob, G. Humphreys, Physically Based Rendering, 4th ed. (2023), 6.8, in the units of the
/// backward error.
#[inline(never)]
pub fn error_bound(leaving: &Leaving) -> Start {
    let reach = leaving.eye.abs() + leaving.way.abs() + leaving.anchor.abs();
    let scale = leaving.normal.abs().dot(reach) + leaving.radius;
    Start::at(leaving.point + leaving.normal * (scale * (4.0 / 16_777_216.0)))
}

/// Both: what is left is skipped, and its neighbours are cleared.
#[inline(never)]
pub fn skip_error_bound(leaving: &Leaving) -> Start {
    Start {
        skips: true,
        ..error_bound(leaving)
    }
}

/// What is left is skipped; from a flat surface the ray starts on the outer side of it, for the sake of
/// its neighbours: as far up as the point lies too low, and by twice what placing it there can round.
#[inline(never)]
pub fn skip_outward(leaving: &Leaving) -> Start {
    let skips = Start {
        skips: true,
        ..Start::at(leaving.point)
    };
    let (point, normal) = (leaving.point, leaving.normal);
    let height = normal.dot(point - leaving.anchor);
    if leaving.radius > 0.0 || height >= 0.0 {
        return skips;
    }
    let rounding = normal.abs().dot(point.abs()) * (2.0 / 16_777_216.0);
    Start {
        origin: point + normal * (rounding - height),
        ..skips
    }
}
