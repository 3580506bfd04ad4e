//! Ray and box.
//!
//! Slabs, T. L. Kay and J. T. Kajiya, "Ray Tracing Complex Scenes", SIGGRAPH 1986, in all of them. They
//! differ in what they make of 0/0 and infinity, where a direction component is zero, and of ties.

use glam::Vec3;
use whitted::{Cuboid, Exact, Ray, Shape};

use crate::{Method, nearest};

/// What the methods need to know of a ray, for all boxes.
#[derive(Clone, Copy, Debug)]
pub struct Setup {
    /// As `whitted` prepares it.
    pub core: <Cuboid as Shape>::Setup,
    /// `1 / direction`.
    pub reciprocal: Vec3,
}

/// Distance to the nearest point of the box's surface that the ray admits.
pub type CuboidMethod = Method<fn(&Ray, &Setup, &Cuboid) -> Option<f32>>;

/// All methods.
pub const METHODS: &[CuboidMethod] = &[
    Method::new("core", core),
    Method::new("slabs, divide, swap", naive),
    Method::new("f32::min, f32::max", min_max),
    Method::new("SSE order", sse_order),
    Method::new("inclusive", inclusive),
    Method::new("by sign", by_sign),
    Method::new("by sign, 2 ulp", two_ulp),
    Method::new("o/d folded", folded),
    Method::new("fractions", fractions),
    Method::new("branch on zero", branch_on_zero),
    Method::new("f64", double),
];

impl Setup {
    /// Both.
    #[inline(never)]
    pub fn new(ray: &Ray) -> Self {
        Self {
            core: setup_core(ray),
            reciprocal: setup_reciprocal(ray),
        }
    }
}

/// As `whitted` prepares a ray.
#[inline(never)]
pub fn setup_core(ray: &Ray) -> <Cuboid as Shape>::Setup {
    Cuboid::setup(ray)
}

/// `1 / direction`.
#[inline(never)]
pub fn setup_reciprocal(ray: &Ray) -> Vec3 {
    ray.direction.recip()
}

/// The kernel of `whitted`.
#[inline(never)]
pub fn core(ray: &Ray, setup: &Setup, cuboid: &Cuboid) -> Option<f32> {
    cuboid.intersect::<Exact>(ray, &setup.core, None)
}

#[inline(always)]
fn axes(ray: &Ray, cuboid: &Cuboid) -> [[f32; 4]; 3] {
    let (o, d, min, max) = (ray.origin, ray.direction, cuboid.min, cuboid.max);
    [
        [o.x, d.x, min.x, max.x],
        [o.y, d.y, min.y, max.y],
        [o.z, d.z, min.z, max.z],
    ]
}

#[inline(always)]
fn ordered(ray: &Ray, entry: f32, exit: f32) -> Option<f32> {
    if entry <= exit {
        nearest(ray, entry, exit)
    } else {
        None
    }
}

// What MINSS and MAXSS compute: the second operand where one is NaN.
#[inline(always)]
fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// Two divisions a slab, exchanged where in the wrong order.
#[inline(never)]
pub fn naive(ray: &Ray, _: &Setup, cuboid: &Cuboid) -> Option<f32> {
    let (mut entry, mut exit) = (f32::NEG_INFINITY, f32::INFINITY);
    for [o, d, low, high] in axes(ray, cuboid) {
        let (mut near, mut far) = ((low - o) / d, (high - o) / d);
        if near > far {
            (near, far) = (far, near);
        }
        if near > entry {
            entry = near;
        }
        if far < exit {
            exit = far;
        }
        if !(entry <= exit) {
            return None;
        }
    }
    nearest(ray, entry, exit)
}

/// Rust's `min` and `max`, which drop a NaN.
#[inline(never)]
pub fn min_max(ray: &Ray, setup: &Setup, cuboid: &Cuboid) -> Option<f32> {
    let a = (cuboid.min - ray.origin) * setup.reciprocal;
    let b = (cuboid.max - ray.origin) * setup.reciprocal;
    let near = [a.x.min(b.x), a.y.min(b.y), a.z.min(b.z)];
    let far = [a.x.max(b.x), a.y.max(b.y), a.z.max(b.z)];
    let entry = near[0].max(near[1]).max(near[2]);
    let exit = far[0].min(far[1]).min(far[2]);
    ordered(ray, entry, exit)
}

/// Smaller and larger as SSE's instructions have them.
#[inline(never)]
pub fn sse_order(ray: &Ray, setup: &Setup, cuboid: &Cuboid) -> Option<f32> {
    let a = (cuboid.min - ray.origin) * setup.reciprocal;
    let b = (cuboid.max - ray.origin) * setup.reciprocal;
    let entry = max(min(a.z, b.z), max(min(a.y, b.y), min(a.x, b.x)));
    let exit = min(max(a.z, b.z), min(max(a.y, b.y), max(a.x, b.x)));
    ordered(ray, entry, exit)
}

/// The order of minima and maxima in which NaN constrains nothing: T. Barnes, "Fast, Branchless
/// Ray/Bounding Box Intersections, Part 3: Boundaries" (2022).
#[inline(never)]
pub fn inclusive(ray: &Ray, setup: &Setup, cuboid: &Cuboid) -> Option<f32> {
    let a = (cuboid.min - ray.origin) * setup.reciprocal;
    let b = (cuboid.max - ray.origin) * setup.reciprocal;
    let (mut entry, mut exit) = (f32::NEG_INFINITY, f32::INFINITY);
    for (a, b) in [(a.x, b.x), (a.y, b.y), (a.z, b.z)] {
        entry = min(max(a, entry), max(b, entry));
        exit = max(min(a, exit), min(b, exit));
    }
    ordered(ray, entry, exit)
}

/// Near and far plane of each slab by the sign of the reciprocal, which -0.0 has too: A. Williams et
/// al., "An Efficient and Robust Ray-Box Intersection Algorithm", JGT 10(1), 2005. In all comparisons
/// NaN constrains nothing.
#[inline(always)]
fn by_sign_roots(ray: &Ray, setup: &Setup, cuboid: &Cuboid) -> (f32, f32) {
    #[inline(always)]
    fn slab(o: f32, reciprocal: f32, low: f32, high: f32) -> (f32, f32) {
        let (near, far) = if reciprocal > 0.0 {
            (low, high)
        } else {
            (high, low)
        };
        ((near - o) * reciprocal, (far - o) * reciprocal)
    }
    let (o, r, low, high) = (ray.origin, setup.reciprocal, cuboid.min, cuboid.max);
    let x = slab(o.x, r.x, low.x, high.x);
    let y = slab(o.y, r.y, low.y, high.y);
    let z = slab(o.z, r.z, low.z, high.z);
    let entry = max(z.0, max(y.0, max(x.0, f32::NEG_INFINITY)));
    let exit = min(z.1, min(y.1, min(x.1, f32::INFINITY)));
    (entry, exit)
}

/// By sign.
#[inline(never)]
pub fn by_sign(ray: &Ray, setup: &Setup, cuboid: &Cuboid) -> Option<f32> {
    let (entry, exit) = by_sign_roots(ray, setup, cuboid);
    ordered(ray, entry, exit)
}

/// By sign, the exit moved out by two steps so that no hierarchy loses a ray: T. Ize, "Robust BVH Ray
/// Traversal", JCGT 2(2), 2013.
#[inline(never)]
pub fn two_ulp(ray: &Ray, setup: &Setup, cuboid: &Cuboid) -> Option<f32> {
    let (entry, exit) = by_sign_roots(ray, setup, cuboid);
    ordered(ray, entry, exit * (1.0 + 2.0 * f32::EPSILON))
}

/// `min·(1/d) - o·(1/d)`, with the second product made once a ray: what fused multiply-add is for.
#[inline(never)]
pub fn folded(ray: &Ray, setup: &Setup, cuboid: &Cuboid) -> Option<f32> {
    let offset = ray.origin * setup.reciprocal;
    let a = cuboid.min * setup.reciprocal - offset;
    let b = cuboid.max * setup.reciprocal - offset;
    let entry = max(min(a.z, b.z), max(min(a.y, b.y), min(a.x, b.x)));
    let exit = min(max(a.z, b.z), min(max(a.y, b.y), max(a.x, b.x)));
    ordered(ray, entry, exit)
}

/// Entries and exits compared as fractions; one division, of the one that is met.
#[inline(never)]
pub fn fractions(ray: &Ray, _: &Setup, cuboid: &Cuboid) -> Option<f32> {
    // Numerator over a positive denominator; the first slab that is no slab's sets both.
    let (mut entry, mut exit) = ((f32::NEG_INFINITY, 1.0), (f32::INFINITY, 1.0));
    for [o, d, low, high] in axes(ray, cuboid) {
        let (to_low, to_high) = (low - o, high - o);
        let (near, far) = if d > 0.0 {
            ((to_low, d), (to_high, d))
        } else if d < 0.0 {
            ((-to_high, -d), (-to_low, -d))
        } else if to_low <= 0.0 && to_high >= 0.0 {
            continue;
        } else {
            return None;
        };
        if near.0 * entry.1 > entry.0 * near.1 {
            entry = near;
        }
        if far.0 * exit.1 < exit.0 * far.1 {
            exit = far;
        }
    }
    if !(entry.0 * exit.1 <= exit.0 * entry.1) {
        return None;
    }
    let (numerator, denominator) = if entry.0 > 0.0 { entry } else { exit };
    ray.admitted(numerator / denominator)
}

/// Two divisions a slab; directions along a slab apart.
#[inline(never)]
pub fn branch_on_zero(ray: &Ray, _: &Setup, cuboid: &Cuboid) -> Option<f32> {
    let (mut entry, mut exit) = (f32::NEG_INFINITY, f32::INFINITY);
    for [o, d, low, high] in axes(ray, cuboid) {
        let (near, far) = if d > 0.0 {
            ((low - o) / d, (high - o) / d)
        } else if d < 0.0 {
            ((high - o) / d, (low - o) / d)
        } else if o >= low && o <= high {
            continue;
        } else {
            return None;
        };
        entry = max(near, entry);
        exit = min(far, exit);
    }
    ordered(ray, entry, exit)
}

/// The same in `f64`, rounded at the end.
#[inline(never)]
pub fn double(ray: &Ray, _: &Setup, cuboid: &Cuboid) -> Option<f32> {
    let (mut entry, mut exit) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in axes(ray, cuboid) {
        let [o, d, low, high] = axis.map(f64::from);
        let (near, far) = if d > 0.0 {
            ((low - o) / d, (high - o) / d)
        } else if d < 0.0 {
            ((high - o) / d, (low - o) / d)
        } else if o >= low && o <= high {
            continue;
        } else {
            return None;
        };
        entry = if near > entry { near } else { entry };
        exit = if far < exit { far } else { exit };
    }
    if entry <= exit {
        nearest(ray, entry as f32, exit as f32)
    } else {
        None
    }
}
