//! Blocks of flat shapes: triangles, quadrilaterals, and one polygon of any size.
//!
//! S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013, for the
//! shear; the parity of crossings as in `whitted::shape::polygon`.

use fearless_simd::{Simd, SimdMask};
use glam::Vec3;
use whitted::Ray;

use super::lanes::{Lanes, Meeting, Vectors, nothing};
use super::rays::RayLanes;

/// `N` outlines of `CORNERS` vertices, filled even-odd.
#[derive(Clone, Debug)]
#[repr(C, align(32))]
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

    /// As `Polygon::intersect`, for points up to `limit`.
    #[inline(always)]
    pub fn meet<S: Simd, V: Lanes<S>>(
        &self,
        simd: S,
        ray: &RayLanes<V>,
        limit: V,
    ) -> Meeting<V, V::Mask> {
        let zero = V::simd_from(simd, 0.0);
        let sheared = self.corners.each_ref().map(|it| ray.shear.apply(simd, it));
        let above = sheared.map(|[_, y]| y.simd_ge(zero));
        let mut inside = V::Mask::splat(simd, false);
        for to in 0..CORNERS {
            let from = (to + CORNERS - 1) % CORNERS;
            inside ^= crosses(sheared[from], above[from], sheared[to], above[to]);
        }
        if !inside.any_true() {
            return nothing(simd);
        }
        let normal = Vectors {
            x: V::from_slice(simd, &self.corners[0][3]),
            y: V::from_slice(simd, &self.corners[1][3]),
            z: V::from_slice(simd, &self.corners[2][3]),
        };
        let [x, y, z, _] = &self.corners[0];
        let point = Vectors {
            x: V::from_slice(simd, x),
            y: V::from_slice(simd, y),
            z: V::from_slice(simd, z),
        };
        let t = normal.dot(point - ray.origin) / normal.dot(ray.direction);
        Meeting {
            t,
            met: inside & t.simd_gt(zero) & t.simd_le(limit),
        }
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
    let right = (a_is_above & downward.simd_gt(upward)) | (b_is_above & upward.simd_gt(downward));
    (a_is_above ^ b_is_above) & right
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

    /// As `Polygon::intersect`, for a point up to `limit`.
    #[inline(always)]
    pub fn meet<S: Simd, V: Lanes<S>, const N: usize>(
        &self,
        simd: S,
        ray: &Ray,
        lanes: &RayLanes<V>,
        limit: f32,
    ) -> Option<f32> {
        let zero = V::simd_from(simd, 0.0);
        let shear = &lanes.shear;
        let rows = shear.axes.map(|axis| self.rows[axis].as_slice());
        let apply = |at: usize| {
            let [x, y, z] =
                [0, 1, 2].map(|i| V::from_slice(simd, &rows[i][at..at + N]) - shear.origin[i]);
            [x + z * shear.slope[0], y + z * shear.slope[1]]
        };
        let mut inside = V::Mask::splat(simd, false);
        for at in (0..rows[0].len() - 1).step_by(N) {
            let (from, to) = (apply(at), apply(at + 1));
            inside ^= crosses(from, from[1].simd_ge(zero), to, to[1].simd_ge(zero));
        }
        if inside.to_bitmask().count_ones() % 2 == 0 {
            return None;
        }
        let t = self.normal.dot(self.point - ray.origin) / self.normal.dot(ray.direction);
        (t > 0.0 && t <= limit).then_some(t)
    }
}
