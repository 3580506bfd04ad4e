//! Blocks of flat shapes: triangles, quadrilaterals, and one polygon of any size.
//!
//! S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013, for the
//! shear; the parity of crossings as in `whitted::shape::polygon`.

use fearless_simd::{Select, Simd, SimdMask};
use glam::Vec3;

use super::across::{Terms, turn};
use super::lanes::{Lanes, Meeting, Vectors, fastest_of_each, nothing};
use super::rays::{AXES, RayTerms};

/// `N` outlines of `CORNERS` vertices, filled even-odd.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct Outlines<const CORNERS: usize, const N: usize> {
    /// For each corner a row a coordinate. The fourth rows of the first three corners are the normal.
    corners: [[[f32; N]; 4]; CORNERS],
}

impl<const CORNERS: usize, const N: usize> Outlines<CORNERS, N> {
    pub fn new(outlines: impl Iterator<Item = ([Vec3; CORNERS], Vec3)>) -> Self {
        // What has no area is crossed twice or not at all.
        let mut corners = [[[0.0; N]; 4]; CORNERS];
        for (lane, (vertices, normal)) in outlines.enumerate() {
            for (corner, vertex) in corners.iter_mut().zip(vertices) {
                for (row, x) in corner.iter_mut().zip(vertex.to_array()) {
                    row[lane] = x;
                }
            }
            for (corner, x) in corners.iter_mut().zip(normal.to_array()) {
                corner[3][lane] = x;
            }
        }
        Self { corners }
    }

    /// As `Polygon::intersect`, for points before `limit`.
    #[inline(always)]
    pub fn meet<S: Simd, V: Lanes<S>>(
        &self,
        simd: S,
        terms: &RayTerms<'_>,
        limit: f32,
    ) -> Meeting<V, V::Mask> {
        let rays = Rays {
            origin: Vectors::splat(simd, terms.ray.origin),
            direction: Vectors::splat(simd, terms.ray.direction),
            shear: Shear::new(simd, terms),
            axes: terms.turned.axes,
            limit: V::simd_from(simd, limit),
        };
        self.cast(simd, &EachLane, &rays)
    }

    /// As `Polygon::intersect`, one of the outlines and a ray a lane; all rays are closest to this axis.
    #[inline(always)]
    pub fn meet_rays<S: Simd, V: Lanes<S>>(
        &self,
        simd: S,
        lane: usize,
        terms: &Terms<V, V::Mask>,
        axis: usize,
        limit: V,
    ) -> Meeting<V, V::Mask> {
        let rays = Rays {
            origin: terms.origin,
            direction: terms.direction,
            shear: Shear {
                origin: terms.turned[0],
                direction: terms.turned[1],
            },
            axes: AXES[axis],
            limit,
        };
        self.cast(simd, &OneLane(lane), &rays)
    }

    /// As [`meet`](Self::meet), of rows as they are to be loaded.
    #[inline(always)]
    fn cast<S: Simd, V: Lanes<S>>(
        &self,
        simd: S,
        row: &impl Load,
        rays: &Rays<V>,
    ) -> Meeting<V, V::Mask> {
        let zero = V::simd_from(simd, 0.0);
        let shear = &rays.shear;
        // The masks say what the compiler cannot see: that these are rows.
        let [a, b, c] = rays.axes;
        let (a, b, c) = (a & 3, b & 3, c & 3);
        let mut inside = V::Mask::splat(simd, false);
        let last = &self.corners[CORNERS - 1];
        let mut from = shear.place(row.vectors(simd, [&last[a], &last[b], &last[c]]));
        let mut from_is_above = from[1].simd_ge(zero);
        for corner in &self.corners {
            let to = shear.place(row.vectors(simd, [&corner[a], &corner[b], &corner[c]]));
            let to_is_above = to[1].simd_ge(zero);
            inside ^= crosses(from, from_is_above, to, to_is_above);
            (from, from_is_above) = (to, to_is_above);
        }
        if !inside.any_true() {
            return nothing(simd);
        }
        let [first, second, third] = [0, 1, 2].map(|it: usize| &self.corners[it]);
        let normal = row.vectors(simd, [&first[3], &second[3], &third[3]]);
        let point = row.vectors(simd, [&first[0], &first[1], &first[2]]);
        let rate = normal.dot(rays.direction);
        let mut t = normal.dot(point - rays.origin) / rate;
        let edge_on =
            rate.simd_lt(V::simd_from(simd, EDGE_ON)) & rate.simd_gt(V::simd_from(simd, -EDGE_ON));
        if (inside & edge_on).any_true() {
            t = edge_on.select(self.clamped(simd, row, shear, c, t), t);
        }
        Meeting {
            t,
            met: inside & t.simd_gt(zero) & t.simd_lt(rays.limit),
        }
    }

    /// `t`, between the distances at which the ray is as deep as the nearest and farthest corner.
    #[inline(always)]
    fn clamped<S: Simd, V: Lanes<S>>(
        &self,
        simd: S,
        row: &impl Load,
        shear: &Shear<V>,
        axis: usize,
        t: V,
    ) -> V {
        let mut low: V = row.load(simd, &self.corners[0][axis]);
        let mut high = low;
        for corner in &self.corners[1..] {
            let depth: V = row.load(simd, &corner[axis]);
            low = low.min(depth);
            high = high.max(depth);
        }
        // Subtraction and division are monotonic: what rounds to the least is the least.
        let (start, speed) = (shear.origin.z, shear.direction.z);
        let (low, high) = ((low - start) / speed, (high - start) / speed);
        between(t, low.min(high), low.max(high))
    }
}

impl<const CORNERS: usize, const N: usize> Outlines<CORNERS, N> {
    /// As `Polygon::intersect`, of each pair the block's lane, by the places of its bytes, and a ray; and the
    /// normals of the planes.
    #[inline(always)]
    pub fn meet_pairs<S: Simd, V: Lanes<S>>(
        &self,
        simd: S,
        lanes: V,
        origin: Vectors<V>,
        direction: Vectors<V>,
        limit: V,
    ) -> (Meeting<V, V::Mask>, Vectors<V>) {
        let axes = fastest_of_each(direction);
        let rays = RaysOfEach {
            origin,
            direction,
            axes,
            turned: [turn(axes, origin), turn(axes, direction)],
            limit,
        };
        let [a, b, c] = [0, 1, 2].map(|it: usize| &self.corners[it][3]);
        let normal = Vectors {
            x: V::from_slice(simd, a),
            y: V::from_slice(simd, b),
            z: V::from_slice(simd, c),
        };
        let corners = Picked {
            rows: &self.corners,
            lanes,
        };
        let normal = normal.pick(lanes);
        (meet_corners(simd, &corners, normal, &rays), normal)
    }
}

/// Rays, and what outlines ask about them.
struct Rays<V> {
    origin: Vectors<V>,
    direction: Vectors<V>,
    shear: Shear<V>,
    /// As [`Turned::axes`](super::rays::Turned).
    axes: [usize; 3],
    limit: V,
}

/// How vectors come from rows of numbers.
trait Load {
    fn load<S: Simd, V: Lanes<S>, const N: usize>(&self, simd: S, row: &[f32; N]) -> V;

    #[inline(always)]
    fn vectors<S: Simd, V: Lanes<S>, const N: usize>(
        &self,
        simd: S,
        [x, y, z]: [&[f32; N]; 3],
    ) -> Vectors<V> {
        Vectors {
            x: self.load(simd, x),
            y: self.load(simd, y),
            z: self.load(simd, z),
        }
    }
}

/// A lane a number.
struct EachLane;

impl Load for EachLane {
    #[inline(always)]
    fn load<S: Simd, V: Lanes<S>, const N: usize>(&self, simd: S, row: &[f32; N]) -> V {
        V::from_slice(simd, row)
    }
}

/// One of the numbers, in all lanes.
struct OneLane(usize);

impl Load for OneLane {
    #[inline(always)]
    fn load<S: Simd, V: Lanes<S>, const N: usize>(&self, simd: S, row: &[f32; N]) -> V {
        V::simd_from(simd, row[self.0 % N])
    }
}

/// Of cosines between a ray and a normal: below, the distance to a plane says little.
const EDGE_ON: f32 = 0.125;

/// `t` from `nearest` to `farthest`; NaN stays NaN.
#[inline(always)]
fn between<S: Simd, V: Lanes<S>>(t: V, nearest: V, farthest: V) -> V {
    let t_or_less = t.simd_gt(farthest).select(farthest, t);
    t.simd_lt(nearest).select(nearest, t_or_less)
}

/// The shear that turns a ray into an axis, as in `whitted::shape::polygon`, without its
/// multiplications by zero.
struct Shear<V> {
    /// The ray's, on the axes in order.
    origin: Vectors<V>,
    direction: Vectors<V>,
}

impl<V: Copy> Shear<V> {
    #[inline(always)]
    fn new<S: Simd>(simd: S, terms: &RayTerms<'_>) -> Self
    where
        V: Lanes<S>,
    {
        Self {
            origin: Vectors::splat(simd, terms.turned.origin),
            direction: Vectors::splat(simd, terms.turned.direction),
        }
    }

    /// Where points go in the plane across the last axis, from a row for each axis.
    #[inline(always)]
    fn apply<S: Simd>(&self, simd: S, a: &[f32], b: &[f32], c: &[f32]) -> [V; 2]
    where
        V: Lanes<S>,
    {
        self.place(Vectors {
            x: V::from_slice(simd, a),
            y: V::from_slice(simd, b),
            z: V::from_slice(simd, c),
        })
    }

    /// The same, from points on the turned axes.
    #[inline(always)]
    fn place<S: Simd>(&self, point: Vectors<V>) -> [V; 2]
    where
        V: Lanes<S>,
    {
        let Vectors { x, y, z } = point - self.origin;
        let Vectors {
            x: dx,
            y: dy,
            z: dz,
        } = self.direction;
        [x * dz - z * dx, y * dz - z * dy]
    }
}

/// Whether edges cross the positive x half-axis, each looked at from its lower end.
#[inline(always)]
fn crosses<S: Simd, V: Lanes<S>>(
    [ax, ay]: [V; 2],
    a_is_above: V::Mask,
    [bx, by]: [V; 2],
    b_is_above: V::Mask,
) -> V::Mask {
    let (upward, downward) = (ax * by, bx * ay);
    let (more, less) = (
        a_is_above.select(downward, upward),
        a_is_above.select(upward, downward),
    );
    (a_is_above ^ b_is_above) & more.simd_gt(less)
}

/// One polygon of any size, whose edges are the lanes.
#[derive(Clone, Debug)]
pub struct Outline {
    /// A row a coordinate: the last vertex, then all, then the last until a block is full. An edge
    /// between equal vertices crosses nothing.
    rows: [Vec<f32>; 3],
    normal: Vec3,
    /// The point through which its plane goes: the first vertex.
    point: Vec3,
    /// For each axis the least and the greatest coordinate.
    depths: [[f32; 2]; 3],
}

impl Outline {
    pub fn new<const N: usize>(vertices: &[Vec3], normal: Vec3) -> Self {
        let last = vertices.last().copied().unwrap_or(Vec3::NAN);
        let length = vertices.len().next_multiple_of(N) + 1;
        let rows = [0, 1, 2].map(|axis| {
            let mut row = Vec::with_capacity(length);
            row.push(last[axis]);
            row.extend(vertices.iter().map(|it| it[axis]));
            row.resize(length, last[axis]);
            row
        });
        Self {
            depths: [0, 1, 2].map(|axis: usize| {
                let coordinates = || vertices.iter().map(|it| it[axis]);
                [
                    coordinates().fold(f32::INFINITY, f32::min),
                    coordinates().fold(f32::NEG_INFINITY, f32::max),
                ]
            }),
            rows,
            normal,
            point: vertices.first().copied().unwrap_or(Vec3::NAN),
        }
    }

    /// The bytes of the vertices.
    pub fn bytes(&self) -> usize {
        self.rows
            .iter()
            .map(|row| size_of_val(row.as_slice()))
            .sum()
    }

    /// As `Polygon::intersect`, for a point before `limit`.
    #[inline(always)]
    pub fn meet<S: Simd, V: Lanes<S>, const N: usize>(
        &self,
        simd: S,
        terms: &RayTerms<'_>,
        limit: f32,
    ) -> Option<f32> {
        let zero = V::simd_from(simd, 0.0);
        let (ray, [x, y, z]) = (terms.ray, terms.turned.axes);
        let rate = self.normal.dot(ray.direction);
        let mut t = self.normal.dot(self.point - ray.origin) / rate;
        let edge_on = rate < EDGE_ON && rate > -EDGE_ON;
        // The plane turns most rays away, before any edge is looked at.
        if !(edge_on || t > 0.0 && t < limit) {
            return None;
        }
        let shear = Shear::<V>::new(simd, terms);
        let rows = (&self.rows[x][..], &self.rows[y][..], &self.rows[z][..]);
        let mut inside = V::Mask::splat(simd, false);
        let mut at = 0;
        while at + N < rows.0.len() {
            let (now, next) = (at..at + N, at + 1..at + 1 + N);
            let from = shear.apply(
                simd,
                &rows.0[now.clone()],
                &rows.1[now.clone()],
                &rows.2[now],
            );
            let to = shear.apply(
                simd,
                &rows.0[next.clone()],
                &rows.1[next.clone()],
                &rows.2[next],
            );
            inside ^= crosses(from, from[1].simd_ge(zero), to, to[1].simd_ge(zero));
            at += N;
        }
        if inside.to_bitmask().count_ones() % 2 == 0 {
            return None;
        }
        if edge_on {
            let (start, speed) = (terms.turned.origin.z, terms.turned.direction.z);
            let ends = self.depths[z].map(|depth| (depth - start) / speed);
            let [nearest, farthest] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
            if t < nearest {
                t = nearest;
            } else if t > farthest {
                t = farthest;
            }
        }
        (t > 0.0 && t < limit).then_some(t)
    }
}

/// As `Polygon::intersect`, a ray a lane.
#[inline(always)]
pub fn meet_rays<S: Simd, V: Lanes<S>>(
    simd: S,
    vertices: &[Vec3],
    normal: Vec3,
    terms: &Terms<V, V::Mask>,
    limit: V,
) -> Meeting<V, V::Mask> {
    if vertices.is_empty() {
        return nothing(simd);
    }
    let rays = RaysOfEach {
        origin: terms.origin,
        direction: terms.direction,
        axes: terms.axes,
        turned: terms.turned,
        limit,
    };
    meet_corners(simd, vertices, Vectors::splat(simd, normal), &rays)
}

/// As [`Rays`], each closest to an axis of its own.
struct RaysOfEach<V, M> {
    origin: Vectors<V>,
    direction: Vectors<V>,
    /// As [`Terms::axes`], and [`Terms::turned`].
    axes: [M; 2],
    turned: [Vectors<V>; 2],
    limit: V,
}

/// The corners of an outline a lane.
trait Corners<S: Simd, V: Lanes<S>> {
    /// How many there are; not zero.
    fn count(&self) -> usize;

    fn get(&self, simd: S, corner: usize) -> Vectors<V>;
}

/// The same outline in each lane.
impl<S: Simd, V: Lanes<S>> Corners<S, V> for [Vec3] {
    #[inline(always)]
    fn count(&self) -> usize {
        self.len()
    }

    #[inline(always)]
    fn get(&self, simd: S, corner: usize) -> Vectors<V> {
        Vectors::splat(simd, self[corner])
    }
}

/// In each lane one of a block's.
struct Picked<'a, V, const CORNERS: usize, const N: usize> {
    rows: &'a [[[f32; N]; 4]; CORNERS],
    lanes: V,
}

impl<S: Simd, V: Lanes<S>, const CORNERS: usize, const N: usize> Corners<S, V>
    for Picked<'_, V, CORNERS, N>
{
    #[inline(always)]
    fn count(&self) -> usize {
        CORNERS
    }

    #[inline(always)]
    fn get(&self, simd: S, corner: usize) -> Vectors<V> {
        let [x, y, z, _] = &self.rows[corner];
        let corner = Vectors {
            x: V::from_slice(simd, x),
            y: V::from_slice(simd, y),
            z: V::from_slice(simd, z),
        };
        corner.pick(self.lanes)
    }
}

/// As `Polygon::intersect`, an outline and a ray a lane.
#[inline(always)]
fn meet_corners<S: Simd, V: Lanes<S>>(
    simd: S,
    corners: &(impl Corners<S, V> + ?Sized),
    normal: Vectors<V>,
    rays: &RaysOfEach<V, V::Mask>,
) -> Meeting<V, V::Mask> {
    let zero = V::simd_from(simd, 0.0);
    let rate = normal.dot(rays.direction);
    let mut t = normal.dot(corners.get(simd, 0) - rays.origin) / rate;
    let edge_on =
        rate.simd_lt(V::simd_from(simd, EDGE_ON)) & rate.simd_gt(V::simd_from(simd, -EDGE_ON));
    if !(edge_on | (t.simd_gt(zero) & t.simd_lt(rays.limit))).any_true() {
        return nothing(simd);
    }
    let shear = Shear {
        origin: rays.turned[0],
        direction: rays.turned[1],
    };
    let mut inside = V::Mask::splat(simd, false);
    let last = corners.get(simd, corners.count() - 1);
    let mut from = shear.place(turn(rays.axes, last));
    let mut from_is_above = from[1].simd_ge(zero);
    for corner in 0..corners.count() {
        let to = shear.place(turn(rays.axes, corners.get(simd, corner)));
        let to_is_above = to[1].simd_ge(zero);
        inside ^= crosses(from, from_is_above, to, to_is_above);
        (from, from_is_above) = (to, to_is_above);
    }
    if (inside & edge_on).any_true() {
        let mut low = turn(rays.axes, corners.get(simd, 0)).z;
        let mut high = low;
        for corner in 1..corners.count() {
            let depth = turn(rays.axes, corners.get(simd, corner)).z;
            (low, high) = (low.min(depth), high.max(depth));
        }
        let (start, speed) = (shear.origin.z, shear.direction.z);
        let (low, high) = ((low - start) / speed, (high - start) / speed);
        t = edge_on.select(between(t, low.min(high), low.max(high)), t);
    }
    Meeting {
        t,
        met: inside & t.simd_gt(zero) & t.simd_lt(rays.limit),
    }
}
