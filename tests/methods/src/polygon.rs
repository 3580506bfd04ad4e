//! Ray and polygon.
//!
//! Most methods first find the point where the ray meets the plane, by the plane's point form, and ask
//! whether the outline goes round that point. The fans and the sheared forms look along the ray.

use core::f32::consts::{PI, TAU};

use glam::Vec3;
use whitted::{Exact, Polygon, Ray, Shape};

use crate::Method;
use crate::sphere::{difference, dot};

/// What the methods need to know of a ray, for all polygons.
#[derive(Clone, Copy, Debug)]
pub struct Setup {
    /// As `whitted` prepares it.
    pub core: <Polygon<'static> as Shape>::Setup,
    /// As Woop, Benthin and Wald do.
    pub shear: Shear,
}

/// A ray's dominant axis and its slopes against it.
#[derive(Clone, Copy, Debug)]
pub struct Shear {
    pub(crate) axis: Axis,
    pub(crate) x: f32,
    pub(crate) y: f32,
    z: f32,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum Axis {
    X,
    Y,
    Z,
}

/// Distance to the polygon if the ray admits it.
pub type PolygonMethod = Method<fn(&Ray, &Setup, &Polygon<'_>) -> Option<f32>>;

/// All methods.
pub const METHODS: &[PolygonMethod] = &[
    Method::new("core", core),
    Method::new("angles, acos", angles_acos),
    Method::new("angles, atan2", angles_atan2),
    Method::new("crossings", crossings),
    Method::new("winding", winding),
    Method::new("half-spaces", half_spaces),
    Method::new("Pluecker", pluecker),
    Method::new("fan, Moeller-Trumbore", fan_moller_trumbore),
    Method::new("fan, M.-T., 1e-6", fan_moller_trumbore_epsilon),
    Method::new("fan, Woop", fan_woop),
    Method::new("sheared crossings", sheared),
    Method::new("sheared, lazy", sheared_lazy),
    Method::new("sheared, plane first", sheared_plane_first),
    Method::new("f64 crossings", double),
];

/// Whether a method also finds its distance from the vertices, and not from the stored normal.
pub fn ignores_normal(name: &str) -> bool {
    name.starts_with("fan")
}

impl Setup {
    /// Both.
    #[inline(never)]
    pub fn new(ray: &Ray) -> Self {
        Self {
            core: setup_core(ray),
            shear: setup_shear(ray),
        }
    }
}

/// As `whitted` prepares a ray.
#[inline(never)]
pub fn setup_core(ray: &Ray) -> <Polygon<'static> as Shape>::Setup {
    Polygon::setup(ray)
}

/// As Woop, Benthin and Wald prepare it.
#[inline(never)]
pub fn setup_shear(ray: &Ray) -> Shear {
    let (d, size) = (ray.direction, ray.direction.abs());
    let axis = if size.x > size.y && size.x > size.z {
        Axis::X
    } else if size.y > size.z {
        Axis::Y
    } else {
        Axis::Z
    };
    let d = permute(axis, d);
    let z = 1.0 / d.z;
    Shear {
        axis,
        x: d.x / d.z,
        y: d.y / d.z,
        z,
    }
}

#[inline(always)]
pub(crate) fn permute(axis: Axis, v: Vec3) -> Vec3 {
    match axis {
        Axis::X => Vec3::new(v.y, v.z, v.x),
        Axis::Y => Vec3::new(v.z, v.x, v.y),
        Axis::Z => v,
    }
}

/// The kernel of `whitted`.
#[inline(never)]
pub fn core(ray: &Ray, setup: &Setup, polygon: &Polygon<'_>) -> Option<f32> {
    polygon.intersect::<Exact>(ray, &setup.core, None)
}

#[inline(always)]
fn plane_of(ray: &Ray, polygon: &Polygon<'_>) -> Option<f32> {
    plane(ray, *polygon.vertices.first()?, polygon.normal)
}

#[inline(always)]
pub(crate) fn plane(ray: &Ray, point: Vec3, normal: Vec3) -> Option<f32> {
    let rate = normal.dot(ray.direction);
    if rate == 0.0 {
        return None;
    }
    ray.admitted(normal.dot(point - ray.origin) / rate)
}

/// The outline's edges.
#[inline(always)]
fn edges<'a>(polygon: &Polygon<'a>) -> impl Iterator<Item = (Vec3, Vec3)> + use<'a> {
    let vertices = polygon.vertices;
    let before = vertices.last().into_iter().chain(vertices);
    before.copied().zip(vertices.iter().copied())
}

/// The angles from the point to the ends of the edges add up to a full turn, to within 1e-3: the
/// definition, as lecture slides have it.
#[inline(never)]
pub fn angles_acos(ray: &Ray, _: &Setup, polygon: &Polygon<'_>) -> Option<f32> {
    let t = plane_of(ray, polygon)?;
    let point = ray.at(t);
    let mut sum = 0.0;
    for (a, b) in edges(polygon) {
        let (a, b) = (a - point, b - point);
        let cos = a.dot(b) / whitted::math::sqrt(a.dot(a) * b.dot(b));
        sum += libm::acosf(cos.clamp(-1.0, 1.0));
    }
    ((sum - TAU).abs() < 1e-3).then_some(t)
}

/// The same with signs, so that outlines may be concave.
#[inline(never)]
pub fn angles_atan2(ray: &Ray, _: &Setup, polygon: &Polygon<'_>) -> Option<f32> {
    let t = plane_of(ray, polygon)?;
    let point = ray.at(t);
    let mut sum = 0.0;
    for (a, b) in edges(polygon) {
        let (a, b) = (a - point, b - point);
        sum += libm::atan2f(polygon.normal.dot(a.cross(b)), a.dot(b));
    }
    (sum.abs() > PI).then_some(t)
}

/// The plane's dominant axis, dropped.
#[inline(always)]
fn flatten(normal: Vec3) -> impl Fn(Vec3) -> (f32, f32) {
    let size = normal.abs();
    let (x, y) = (size.x > size.y && size.x > size.z, size.y > size.z);
    move |v| match (x, y) {
        (true, _) => (v.y, v.z),
        (false, true) => (v.z, v.x),
        _ => (v.x, v.y),
    }
}

/// Even-odd crossings with a half-line in the plane's dominant projection: E. Haines, "Point in
/// Polygon Strategies", Graphics Gems IV (1994).
#[inline(never)]
pub fn crossings(ray: &Ray, _: &Setup, polygon: &Polygon<'_>) -> Option<f32> {
    let t = plane_of(ray, polygon)?;
    let flat = flatten(polygon.normal);
    let (x, y) = flat(ray.at(t));
    let mut inside = false;
    for (a, b) in edges(polygon) {
        let ((ax, ay), (bx, by)) = (flat(a), flat(b));
        let (ax, ay, bx, by) = (ax - x, ay - y, bx - x, by - y);
        if (ay >= 0.0) != (by >= 0.0) && (ax * by - bx * ay > 0.0) == (by >= 0.0) {
            inside = !inside;
        }
    }
    inside.then_some(t)
}

/// The winding number in the same projection: D. Sunday, "Inclusion of a Point in a Polygon" (2001).
#[inline(never)]
pub fn winding(ray: &Ray, _: &Setup, polygon: &Polygon<'_>) -> Option<f32> {
    let t = plane_of(ray, polygon)?;
    let flat = flatten(polygon.normal);
    let (x, y) = flat(ray.at(t));
    let mut winding = 0;
    for (a, b) in edges(polygon) {
        let ((ax, ay), (bx, by)) = (flat(a), flat(b));
        let left = (bx - ax) * (y - ay) - (x - ax) * (by - ay);
        if ay <= y {
            if by > y && left > 0.0 {
                winding += 1;
            }
        } else if by <= y && left < 0.0 {
            winding -= 1;
        }
    }
    (winding != 0).then_some(t)
}

/// On the same side of all edges; convex outlines only.
#[inline(never)]
pub fn half_spaces(ray: &Ray, _: &Setup, polygon: &Polygon<'_>) -> Option<f32> {
    let t = plane_of(ray, polygon)?;
    let point = ray.at(t);
    let (mut left, mut right) = (true, true);
    for (a, b) in edges(polygon) {
        let side = polygon.normal.dot((b - a).cross(point - a));
        left &= side >= 0.0;
        right &= side <= 0.0;
    }
    (left || right).then_some(t)
}

/// On the same side of all edges as lines in space, in world coordinates; convex outlines only:
/// K. Shoemake, "Plücker Coordinate Tutorial", Ray Tracing News 11(1), 1998.
#[inline(never)]
pub fn pluecker(ray: &Ray, _: &Setup, polygon: &Polygon<'_>) -> Option<f32> {
    let moment = ray.origin.cross(ray.direction);
    let (mut left, mut right) = (true, true);
    for (a, b) in edges(polygon) {
        let side = ray.direction.dot(a.cross(b)) + moment.dot(b - a);
        left &= side >= 0.0;
        right &= side <= 0.0;
    }
    if left || right {
        plane_of(ray, polygon)
    } else {
        None
    }
}

/// A fan of triangles from the first vertex; convex outlines only.
#[inline(always)]
fn fan(polygon: &Polygon<'_>, triangle: impl Fn(Vec3, Vec3, Vec3) -> Option<f32>) -> Option<f32> {
    let (&first, rest) = polygon.vertices.split_first()?;
    rest.iter()
        .zip(rest.get(1..)?)
        .find_map(|(&b, &c)| triangle(first, b, c))
}

#[inline(always)]
pub(crate) fn moller_trumbore(ray: &Ray, [a, b, c]: [Vec3; 3], least: f32) -> Option<f32> {
    let (edge1, edge2) = (b - a, c - a);
    let p = ray.direction.cross(edge2);
    let determinant = edge1.dot(p);
    if determinant.abs() <= least {
        return None;
    }
    let inverse = 1.0 / determinant;
    let from_a = ray.origin - a;
    let u = from_a.dot(p) * inverse;
    if !(0.0..=1.0).contains(&u) {
        return None;
    }
    let q = from_a.cross(edge1);
    let v = ray.direction.dot(q) * inverse;
    if !(v >= 0.0 && u + v <= 1.0) {
        return None;
    }
    ray.admitted(edge2.dot(q) * inverse)
}

/// T. Möller, B. Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", JGT 2(1), 1997, both
/// sides, only a determinant of zero counted as parallel.
#[inline(never)]
pub fn fan_moller_trumbore(ray: &Ray, _: &Setup, polygon: &Polygon<'_>) -> Option<f32> {
    fan(polygon, |a, b, c| moller_trumbore(ray, [a, b, c], 0.0))
}

/// The same with the paper's epsilon.
#[inline(never)]
pub fn fan_moller_trumbore_epsilon(ray: &Ray, _: &Setup, polygon: &Polygon<'_>) -> Option<f32> {
    fan(polygon, |a, b, c| moller_trumbore(ray, [a, b, c], 1e-6))
}

/// Where a vertex is in the space in which the ray starts at 0 and goes along z.
#[inline(always)]
pub(crate) fn place(ray: &Ray, shear: &Shear, v: Vec3) -> Vec3 {
    let v = permute(shear.axis, v - ray.origin);
    Vec3::new(v.x - shear.x * v.z, v.y - shear.y * v.z, v.z)
}

#[inline(always)]
pub(crate) fn woop(ray: &Ray, shear: &Shear, [a, b, c]: [Vec3; 3]) -> Option<f32> {
    let u = c.x * b.y - c.y * b.x;
    let v = a.x * c.y - a.y * c.x;
    let w = b.x * a.y - b.y * a.x;
    if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
        return None;
    }
    let determinant = u + v + w;
    if determinant == 0.0 {
        return None;
    }
    ray.admitted(shear.z * (u * a.z + v * b.z + w * c.z) / determinant)
}

/// S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013, without the
/// fallback to `f64`.
#[inline(never)]
pub fn fan_woop(ray: &Ray, setup: &Setup, polygon: &Polygon<'_>) -> Option<f32> {
    let place = |v: Vec3| place(ray, &setup.shear, v);
    fan(polygon, |a, b, c| {
        woop(ray, &setup.shear, [place(a), place(b), place(c)])
    })
}

/// Whether an edge crosses the positive x half-axis, seen from its lower end.
#[inline(always)]
pub(crate) fn crosses(a: (f32, f32), b: (f32, f32)) -> bool {
    let above = a.1 >= 0.0;
    if above == (b.1 >= 0.0) {
        return false;
    }
    let (low, high) = if above { (b, a) } else { (a, b) };
    low.0 * high.1 > high.0 * low.1
}

/// Even-odd crossings of the outline seen along the ray, sheared as Woop does, axes permuted.
#[inline(never)]
pub fn sheared(ray: &Ray, setup: &Setup, polygon: &Polygon<'_>) -> Option<f32> {
    let place = |v: Vec3| {
        let v = place(ray, &setup.shear, v);
        (v.x, v.y)
    };
    let mut previous = place(*polygon.vertices.last()?);
    let mut inside = false;
    for &vertex in polygon.vertices {
        let current = place(vertex);
        inside ^= crosses(previous, current);
        previous = current;
    }
    if inside { plane_of(ray, polygon) } else { None }
}

/// The same; a loop for each axis, x only for edges that cross the x axis, and sides told by the bits
/// of signs.
#[inline(never)]
pub fn sheared_lazy(ray: &Ray, setup: &Setup, polygon: &Polygon<'_>) -> Option<f32> {
    let (shear, vertices) = (&setup.shear, polygon.vertices);
    let inside = match shear.axis {
        Axis::X => surrounds(ray, shear, vertices, |v| permute(Axis::X, v)),
        Axis::Y => surrounds(ray, shear, vertices, |v| permute(Axis::Y, v)),
        Axis::Z => surrounds(ray, shear, vertices, |v| permute(Axis::Z, v)),
    };
    if inside { plane_of(ray, polygon) } else { None }
}

/// The same; the plane's distance first.
#[inline(never)]
pub fn sheared_plane_first(ray: &Ray, setup: &Setup, polygon: &Polygon<'_>) -> Option<f32> {
    let t = plane_of(ray, polygon)?;
    let (shear, vertices) = (&setup.shear, polygon.vertices);
    let inside = match shear.axis {
        Axis::X => surrounds(ray, shear, vertices, |v| permute(Axis::X, v)),
        Axis::Y => surrounds(ray, shear, vertices, |v| permute(Axis::Y, v)),
        Axis::Z => surrounds(ray, shear, vertices, |v| permute(Axis::Z, v)),
    };
    inside.then_some(t)
}

#[inline(always)]
fn surrounds(ray: &Ray, shear: &Shear, vertices: &[Vec3], permute: impl Fn(Vec3) -> Vec3) -> bool {
    let Some(&last) = vertices.last() else {
        return false;
    };
    let origin = permute(ray.origin);
    let y = |v: Vec3| {
        let v = permute(v);
        (v.y - origin.y) - shear.y * (v.z - origin.z)
    };
    let x = |v: Vec3| {
        let v = permute(v);
        (v.x - origin.x) - shear.x * (v.z - origin.z)
    };
    let mut inside = false;
    let mut a = last;
    let mut a_y = y(a);
    for &b in vertices {
        // Or the loop is unrolled four times, for each axis: 2 KiB of flash, and slower for triangles.
        core::hint::black_box(());
        let b_y = y(b);
        if ((a_y.to_bits() ^ b_y.to_bits()) as i32) < 0 {
            // Looked at from the lower end: both owners of an edge compare the same products alike.
            let (from_a, from_b) = (x(a) * b_y, x(b) * a_y);
            inside ^= if a_y < 0.0 {
                from_a > from_b
            } else {
                from_b > from_a
            };
        }
        (a, a_y) = (b, b_y);
    }
    inside
}

/// The crossings in the plane's dominant projection, in `f64`.
#[inline(never)]
pub fn double(ray: &Ray, _: &Setup, polygon: &Polygon<'_>) -> Option<f32> {
    let wide = |v: Vec3| v.to_array().map(f64::from);
    let (normal, d, o) = (wide(polygon.normal), wide(ray.direction), wide(ray.origin));
    let rate = dot(normal, d);
    if rate == 0.0 {
        return None;
    }
    let t = dot(normal, difference(*polygon.vertices.first()?, ray.origin)) / rate;
    let size = normal.map(f64::abs);
    let flat = |v: [f64; 3]| {
        if size[0] > size[1] && size[0] > size[2] {
            (v[1], v[2])
        } else if size[1] > size[2] {
            (v[2], v[0])
        } else {
            (v[0], v[1])
        }
    };
    let (x, y) = flat([0, 1, 2].map(|i| o[i] + t * d[i]));
    let mut inside = false;
    for (a, b) in edges(polygon) {
        let ((ax, ay), (bx, by)) = (flat(wide(a)), flat(wide(b)));
        let (ax, ay, bx, by) = (ax - x, ay - y, bx - x, by - y);
        if (ay >= 0.0) != (by >= 0.0) && (ax * by - bx * ay > 0.0) == (by >= 0.0) {
            inside = !inside;
        }
    }
    if inside { ray.admitted(t as f32) } else { None }
}
