//! Polygons with any simple outline, and the test that they share with triangles.

use core::fmt;

use glam::Vec3;

use super::{Shape, mapping, plane};
use crate::math::{self, Math};
use crate::ray::{Ray, Side};

/// A flat outline, convex or not, filled even-odd.
///
/// The vertices lie elsewhere, so that polygons of any size are one type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polygon<'a> {
    /// In world space, in order along the outline; the last is joined to the first.
    pub vertices: &'a [Vec3],
    /// Unit length; the side on which the outline runs counterclockwise.
    pub normal: Vec3,
}

/// Why some vertices are not a [`Polygon`] or a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PolygonError {
    /// The outline encloses no area; fewer than three vertices never do.
    ZeroArea,
    /// This vertex, counted from 0, is not finite.
    NotFinite(usize),
    /// This vertex, counted from 0, is off the plane of the others.
    NotPlanar(usize),
}

impl fmt::Display for PolygonError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ZeroArea => f.write_str("the outline encloses no area"),
            Self::NotFinite(vertex) => write!(f, "vertex {vertex} (from 0) is not finite"),
            Self::NotPlanar(vertex) => {
                write!(f, "vertex {vertex} (from 0) is off the plane of the others")
            }
        }
    }
}

impl core::error::Error for PolygonError {}

impl<'a> Polygon<'a> {
    /// A polygon with its normal by Newell's method: any simple outline, also one that starts with
    /// collinear vertices or has repeated ones.
    ///
    /// # Errors
    ///
    /// Where a vertex is not finite, the outline encloses no area, or a vertex is further from the
    /// plane of the others than 2^-14 of the outline's size and than its coordinates' rounding.
    pub fn new(vertices: &'a [Vec3]) -> Result<Self, PolygonError> {
        let normal = newell(vertices)?;
        Ok(Self { vertices, normal })
    }
}

/// Unit normal of an outline.
///
/// M. E. Newell's sum over edges, taken over vertices relative to the first: I. E. Sutherland,
/// R. F. Sproull, R. A. Schumacker, "A Characterization of Ten Hidden-Surface Algorithms", ACM
/// Computing Surveys 6(1), 1974, credits it.
pub(super) fn newell(vertices: &[Vec3]) -> Result<Vec3, PolygonError> {
    if let Some(vertex) = vertices.iter().position(|v| !v.is_finite()) {
        return Err(PolygonError::NotFinite(vertex));
    }
    let Some((&first, rest)) = vertices.split_first() else {
        return Err(PolygonError::ZeroArea);
    };
    let mut sum = [0.0_f64; 3];
    let mut largest = [0.0_f64; 3];
    let mut previous = [0.0_f64; 3];
    let mut size = 0.0_f64;
    for &vertex in rest {
        let current = math::difference(vertex, first);
        let area = math::cross(previous, current);
        for (sum, area) in sum.iter_mut().zip(area) {
            *sum += area;
        }
        if square(area) > square(largest) {
            largest = area;
        }
        for x in current {
            size = if x.abs() > size { x.abs() } else { size };
        }
        previous = current;
    }
    // Products of differences of `f32` are nearly exact in f64: what is left of an outline without
    // area is smaller than this share of its square by far.
    const NO_AREA: f64 = 1.0 / (1_u64 << 45) as f64;
    let no_area = NO_AREA * size * size;
    if square(sum) <= no_area * no_area {
        // A bow-tie, whose halves cancel, still has a plane; a line has none.
        sum = largest;
    }
    let (length, normal) = math::unit(sum).ok_or(PolygonError::ZeroArea)?;
    if length <= no_area {
        return Err(PolygonError::ZeroArea);
    }
    const NOT_PLANAR: f64 = 1.0 / (1_u64 << 14) as f64;
    const ROUNDING: f64 = 8.0 / (1_u64 << 24) as f64;
    for (index, &vertex) in vertices.iter().enumerate() {
        let offset = math::difference(vertex, first);
        let (mut height, mut rounding) = (0.0, 0.0);
        for i in 0..3 {
            height += sum[i] / length * offset[i];
            rounding += (sum[i] / length * f64::from(vertex.to_array()[i])).abs();
        }
        if height.abs() > NOT_PLANAR * size + ROUNDING * rounding {
            return Err(PolygonError::NotPlanar(index));
        }
    }
    Ok(normal)
}

fn square(v: [f64; 3]) -> f64 {
    v[0] * v[0] + v[1] * v[1] + v[2] * v[2]
}

/// An axis of the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// The first.
    X,
    /// The second.
    Y,
    /// The third.
    Z,
}

impl Axis {
    /// That to which the ray is closest.
    #[inline(always)]
    pub(crate) fn along(ray: &Ray) -> Self {
        let size = ray.direction.abs();
        if size.x > size.y && size.x > size.z {
            Self::X
        } else if size.y > size.z {
            Self::Y
        } else {
            Self::Z
        }
    }

    /// What `f` makes of it, by code of its own for each axis, unless float operations are calls: then one
    /// more for the place of a coordinate costs little.
    #[inline(always)]
    pub(crate) fn apart<T>(self, f: impl Fn(Self) -> T) -> T {
        if cfg!(soft_float) {
            return f(self);
        }
        match self {
            Self::X => f(Self::X),
            Self::Y => f(Self::Y),
            Self::Z => f(Self::Z),
        }
    }

    /// The point on it with this coordinate.
    #[inline(always)]
    pub(crate) fn at(self, coordinate: f32) -> Vec3 {
        match self {
            Self::X => Vec3::X.with_x(coordinate),
            Self::Y => Vec3::Y.with_y(coordinate),
            Self::Z => Vec3::Z.with_z(coordinate),
        }
    }

    /// This coordinate of a vector.
    #[inline(always)]
    pub(crate) fn of(self, v: &Vec3) -> f32 {
        let v: &[f32; 3] = v.as_ref();
        v[self as usize]
    }
}

/// How far the line through `vertex` along the ray is off the ray along an axis: one function of the
/// vertex alone, whichever outline it belongs to. `depth` is the axis to which the ray is closest.
///
/// S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013; but all is
/// scaled by the direction along `depth`, which decides nothing and takes no division. Where speed
/// counts, code for each axis takes the place of the paper's permutation: callers there name a constant.
#[cfg_attr(soft_float, inline(never))]
#[cfg_attr(not(soft_float), inline(always))]
fn shear(ray: &Ray, across: Axis, depth: Axis, vertex: &Vec3) -> f32 {
    let (origin, direction) = (&ray.origin, &ray.direction);
    let offset = (
        across.of(vertex) - across.of(origin),
        depth.of(vertex) - depth.of(origin),
    );
    offset.0 * depth.of(direction) - offset.1 * across.of(direction)
}

/// [`shear`] along the first of the other axes.
#[inline(always)]
pub(super) fn x(ray: &Ray, depth: Axis, vertex: &Vec3) -> f32 {
    let across = match depth {
        Axis::X => Axis::Y,
        Axis::Y | Axis::Z => Axis::X,
    };
    shear(ray, across, depth, vertex)
}

/// [`shear`] along the second of the other axes.
#[inline(always)]
pub(super) fn y(ray: &Ray, depth: Axis, vertex: &Vec3) -> f32 {
    let across = match depth {
        Axis::X | Axis::Y => Axis::Z,
        Axis::Z => Axis::Y,
    };
    // Never -0: vertices on the x axis lie on one side of it.
    shear(ray, across, depth, vertex) + 0.0
}

/// Whether the ray's line passes within an outline: an odd number of its edges cross the positive x
/// half-axis.
#[inline(always)]
fn meets(ray: &Ray, depth: Axis, vertices: &[Vec3]) -> bool {
    let Some(last) = vertices.last() else {
        return false;
    };
    let mut a = (last, y(ray, depth, last));
    let mut inside = false;
    for vertex in vertices {
        math::keep_rolled();
        let b = (vertex, y(ray, depth, vertex));
        if differ(a.1, b.1) {
            inside ^= crosses((x(ray, depth, a.0), a.1), (x(ray, depth, b.0), b.1));
        }
        a = b;
    }
    inside
}

/// Distance to the plane of an outline within which the ray's line passes, where the ray admits it; where
/// the outline is seen edge-on, no farther and no nearer than its vertices.
///
/// Edge-on, the plane's equation says little about the distance, and the point could lie far outside the
/// outline. The axis to which the ray is closest always tells it well; so what is met lies within the box
/// round the vertices along that axis, and hierarchies that know lose nothing.
#[cfg_attr(soft_float, inline(never))]
#[cfg_attr(not(soft_float), inline(always))]
pub(super) fn distance(ray: &Ray, axis: Axis, vertices: &[Vec3], normal: Vec3) -> Option<f32> {
    const EDGE_ON: f32 = 0.125;
    let (height, rate) = plane::approach(ray, *vertices.first()?, normal);
    let t = height / rate;
    ray.admitted(if rate < EDGE_ON && rate > -EDGE_ON {
        clamp(ray, axis, vertices, t)
    } else {
        t
    })
}

/// `t`, between the distances at which the ray is as deep as its nearest and farthest vertex.
#[cold]
#[inline(never)]
fn clamp(ray: &Ray, axis: Axis, vertices: &[Vec3], t: f32) -> f32 {
    let speed = axis.of(&ray.direction);
    let mut nearest = f32::INFINITY;
    let mut farthest = f32::NEG_INFINITY;
    for vertex in vertices {
        math::keep_rolled();
        let distance = (axis.of(vertex) - axis.of(&ray.origin)) / speed;
        if distance < nearest {
            nearest = distance;
        }
        if distance > farthest {
            farthest = distance;
        }
    }
    // NaN, from a ray in the plane itself, stays NaN.
    if t < nearest {
        nearest
    } else if t > farthest {
        farthest
    } else {
        t
    }
}

/// Whether two vertices lie on different sides of the x axis, by the signs of their y. NaN has any; no
/// edge with one crosses anything.
#[inline(always)]
pub(super) fn differ(a_y: f32, b_y: f32) -> bool {
    ((a_y.to_bits() ^ b_y.to_bits()) as i32) < 0
}

/// Whether an edge crosses the positive x half-axis; its ends [differ] in their side of that axis.
///
/// Both owners of an edge decide alike, since it is always looked at from its lower end. So parities
/// over the faces of a closed mesh add up, whatever the rounding: no ray passes between faces, and
/// none meets both owners of an edge.
#[inline(always)]
pub(super) fn crosses((a_x, a_y): (f32, f32), (b_x, b_y): (f32, f32)) -> bool {
    let (from_a, from_b) = (a_x * b_y, b_x * a_y);
    if a_y.is_sign_negative() {
        from_a > from_b
    } else {
        from_b > from_a
    }
}

impl Shape for Polygon<'_> {
    type Setup = Axis;

    #[inline(always)]
    fn setup(ray: &Ray) -> Axis {
        Axis::along(ray)
    }

    #[inline(never)]
    fn intersect<P: Math>(&self, ray: &Ray, &axis: &Axis, leaving: Option<Side>) -> Option<f32> {
        if leaving.is_some() {
            return None;
        }
        if axis.apart(|axis| meets(ray, axis, self.vertices)) {
            distance(ray, axis, self.vertices, self.normal)
        } else {
            None
        }
    }

    /// From the first vertex in world units: u along the level direction, v along what is upwards, or along -z.
    #[inline]
    fn uv(&self, point: Vec3) -> (f32, f32) {
        match self.vertices.first() {
            Some(&first) => mapping::flat(point - first, self.normal),
            None => (0.0, 0.0),
        }
    }

    #[inline(always)]
    fn normal<P: Math>(&self, _: &Ray, _: f32) -> Vec3 {
        self.normal
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Exact;

    fn flat<const N: usize>(outline: [(f32, f32); N]) -> [Vec3; N] {
        outline.map(|(x, y)| Vec3::new(x, y, 0.0))
    }

    /// Which of a grid of rays straight down meet the outline, a row a line, top row first.
    fn drawn(vertices: &[Vec3], size: i32) -> Vec<String> {
        let polygon = Polygon::new(vertices).unwrap();
        (0..size)
            .rev()
            .map(|y| {
                (0..size)
                    .map(|x| {
                        let origin = Vec3::new(x as f32 + 0.5, y as f32 + 0.5, 1.0);
                        let ray = Ray::new(origin, Vec3::NEG_Z);
                        let hit = polygon.intersect::<Exact>(&ray, &Polygon::setup(&ray), None);
                        assert!(hit.is_none() || hit == Some(1.0));
                        if hit.is_some() { '#' } else { '.' }
                    })
                    .collect()
            })
            .collect()
    }

    extern crate std;
    use std::string::String;
    use std::vec::Vec;

    #[test]
    fn outlines_are_filled() {
        let notched = flat([(0.0, 0.0), (6.0, 0.0), (6.0, 6.0), (3.0, 3.5), (0.0, 6.0)]);
        assert_eq!(
            drawn(&notched, 6),
            ["#....#", "##..##", "######", "######", "######", "######"]
        );
        let bow_tie = flat([(0.0, 0.0), (4.0, 4.0), (4.0, 0.0), (0.0, 4.0)]);
        let filled = Polygon::new(&bow_tie).unwrap();
        for (x, y, inside) in [
            (0.5, 2.0, true),
            (3.5, 2.0, true),
            (2.0, 0.5, false),
            (2.0, 3.5, false),
        ] {
            let ray = Ray::new(Vec3::new(x, y, 1.0), Vec3::NEG_Z);
            assert_eq!(
                filled
                    .intersect::<Exact>(&ray, &Polygon::setup(&ray), None)
                    .is_some(),
                inside
            );
        }
    }

    #[test]
    fn repeated_and_collinear_vertices_change_nothing() {
        let square = flat([(0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (0.0, 3.0)]);
        let awkward = flat([
            (0.0, 0.0),
            (0.0, 0.0),
            (1.0, 0.0),
            (2.0, 0.0),
            (3.0, 0.0),
            (3.0, 3.0),
            (0.0, 3.0),
        ]);
        assert_eq!(drawn(&awkward, 4), drawn(&square, 4));
        assert_eq!(Polygon::new(&awkward).unwrap().normal, Vec3::Z);
    }

    #[test]
    fn what_has_no_area_is_refused() {
        let line = flat([(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)]);
        assert_eq!(Polygon::new(&line), Err(PolygonError::ZeroArea));
        assert_eq!(Polygon::new(&line[..2]), Err(PolygonError::ZeroArea));
        assert_eq!(Polygon::new(&[]), Err(PolygonError::ZeroArea));
        let mut holed = flat([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]);
        holed[2].y = f32::INFINITY;
        assert_eq!(Polygon::new(&holed), Err(PolygonError::NotFinite(2)));
        let mut bent = flat([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]);
        bent[2].z = 0.1;
        assert!(matches!(
            Polygon::new(&bent),
            Err(PolygonError::NotPlanar(_))
        ));
    }

    #[test]
    fn what_is_seen_edge_on_is_met_where_it_is() {
        // A vertex off the plane by half of what is accepted puts the plane's own distance anywhere.
        let height = 1.0 / 32_768.0;
        let outline = [
            Vec3::ZERO,
            Vec3::X,
            Vec3::new(1.0, 0.0, 1.0),
            Vec3::new(0.0, height, 1.0),
        ];
        let polygon = Polygon::new(&outline).unwrap();
        let mut hits = 0;
        for i in 0..10_000 {
            let from = Vec3::new(
                -9.0,
                height * (i as f32 / 5_000.0 - 0.5),
                0.25 + (i % 100) as f32 / 200.0,
            );
            let ray = Ray::new(
                from,
                Exact::normalize(Vec3::new(1.0, 1e-7 * (i % 7) as f32, 0.0)),
            );
            if let Some(t) = polygon.intersect::<Exact>(&ray, &Polygon::setup(&ray), None) {
                assert!((9.0 - 1e-5..=10.0 + 1e-5).contains(&t), "{i}: {t}");
                hits += 1;
            }
        }
        assert!(hits > 100, "{hits} hits say nothing");
    }

    #[test]
    fn normals_survive_every_scale() {
        for exponent in -60..=60 {
            let scale = f32::from_bits(((127 + exponent) as u32) << 23);
            let outline = flat([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]).map(|v| v * scale);
            assert_eq!(
                Polygon::new(&outline).unwrap().normal,
                Vec3::Z,
                "2^{exponent}"
            );
        }
    }
}
