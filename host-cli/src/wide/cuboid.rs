//! Blocks of boxes.

use core::ops::BitAnd;

use fearless_simd::{Select, Simd, SimdMask};
use glam::Vec3;
use whitted::{Cuboid, Ray};

use super::across::Terms;
use super::lanes::{Lanes, Meeting, Vectors};
use super::rays::RayTerms;

/// `N` axis-aligned boxes.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct Cuboids<const N: usize> {
    /// For each axis the lower and the upper bounds.
    bounds: [[[f32; N]; 2]; 3],
}

impl<const N: usize> Cuboids<N> {
    pub fn new(cuboids: impl Iterator<Item = Cuboid>) -> Self {
        // What has no extent is never met.
        let mut bounds = [[[f32::NAN; N]; 2]; 3];
        for (lane, cuboid) in cuboids.enumerate() {
            for (axis, rows) in bounds.iter_mut().enumerate() {
                rows[0][lane] = cuboid.min[axis];
                rows[1][lane] = cuboid.max[axis];
            }
        }
        Self { bounds }
    }

    /// As `Cuboid::intersect`, for points before `limit`. No reciprocal of the ray may be infinite
    /// unless the ray goes across its axis.
    #[inline(always)]
    pub fn meet<S: Simd, V: Lanes<S>>(
        &self,
        simd: S,
        terms: &RayTerms<'_>,
        limit: f32,
    ) -> Meeting<V, V::Mask> {
        let (o, d, r) = (terms.ray.origin, terms.ray.direction, terms.reciprocal);
        let [x, y, z] = &self.bounds;
        let mut inside = Inside::<V, V::Mask> {
            entry: V::simd_from(simd, f32::NEG_INFINITY),
            exit: V::simd_from(simd, f32::INFINITY),
            between: V::Mask::splat(simd, true),
        };
        inside.cut(simd, x, o.x, d.x, r.x);
        inside.cut(simd, y, o.y, d.y, r.y);
        inside.cut(simd, z, o.z, d.z, r.z);
        let Inside {
            entry,
            exit,
            between,
        } = inside;
        let met = between & entry.simd_le(exit);
        within(simd, entry, exit, met, V::simd_from(simd, limit))
    }
}

impl<const N: usize> Cuboids<N> {
    /// As `Cuboid::intersect` and `Cuboid::normal`, of each pair the block's lane, by the places of its bytes, and a
    /// ray, which does not go along the planes across an axis.
    #[inline(always)]
    pub fn meet_pairs<S: Simd, V: Lanes<S>>(
        &self,
        simd: S,
        lanes: V,
        origin: Vectors<V>,
        reciprocal: Vectors<V>,
        limit: V,
    ) -> (Meeting<V, V::Mask>, Vectors<V>) {
        let [x, y, z] = &self.bounds;
        let min = Vectors {
            x: V::from_slice(simd, &x[0]),
            y: V::from_slice(simd, &y[0]),
            z: V::from_slice(simd, &z[0]),
        };
        let max = Vectors {
            x: V::from_slice(simd, &x[1]),
            y: V::from_slice(simd, &y[1]),
            z: V::from_slice(simd, &z[1]),
        };
        let to_min = (min.pick(lanes) - origin) * reciprocal;
        let to_max = (max.pick(lanes) - origin) * reciprocal;
        let meeting = meet_planes(simd, to_min, to_max, limit);
        let none = V::Mask::splat(simd, false);
        let normals = faces(simd, to_min, to_max, [none; 3], meeting.t);
        (meeting, normals)
    }
}

/// Where a ray is within boxes, as far as they have been looked at.
struct Inside<V, M> {
    entry: V,
    exit: V,
    /// Whether it is between those planes across which it does not go.
    between: M,
}

impl<V, M> Inside<V, M> {
    /// Looks at the planes across another axis.
    #[inline(always)]
    fn cut<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        planes: &[[f32; N]; 2],
        origin: f32,
        direction: f32,
        reciprocal: f32,
    ) where
        V: Lanes<S, Mask = M>,
        M: Copy + BitAnd<Output = M> + Select<V>,
    {
        let origin = V::simd_from(simd, origin);
        // Also for NaN.
        if !(direction.abs() > 0.0) {
            let zero = V::simd_from(simd, 0.0);
            let to_min: V = V::from_slice(simd, &planes[0]) - origin;
            let to_max: V = V::from_slice(simd, &planes[1]) - origin;
            self.between = self.between & to_min.simd_le(zero) & to_max.simd_ge(zero);
            return;
        }
        // Chosen by place, not by a branch: where rays go all ways, half of those would be mispredicted.
        let near = V::from_slice(simd, &planes[usize::from(direction < 0.0)]) - origin;
        let far = V::from_slice(simd, &planes[usize::from(direction > 0.0)]) - origin;
        let reciprocal = V::simd_from(simd, reciprocal);
        let (near, far) = (near * reciprocal, far * reciprocal);
        self.entry = near.simd_gt(self.entry).select(near, self.entry);
        self.exit = far.simd_lt(self.exit).select(far, self.exit);
    }
}

/// As `Cuboid::normal`, without branches: rays that go all ways meet any face.
#[inline(always)]
pub fn normal(shape: &Cuboid, ray: &Ray, t: f32) -> Vec3 {
    const FACES: [Vec3; 6] = [
        Vec3::NEG_X,
        Vec3::X,
        Vec3::NEG_Y,
        Vec3::Y,
        Vec3::NEG_Z,
        Vec3::Z,
    ];
    let (o, d, reciprocal) = (ray.origin, ray.direction, ray.direction.recip());
    let to_min = (shape.min - o) * reciprocal;
    let to_max = (shape.max - o) * reciprocal;
    let met = u32::from((to_min.x == t) & (d.x != 0.0))
        | u32::from((to_max.x == t) & (d.x != 0.0)) << 1
        | u32::from((to_min.y == t) & (d.y != 0.0)) << 2
        | u32::from((to_max.y == t) & (d.y != 0.0)) << 3
        | u32::from((to_min.z == t) & (d.z != 0.0)) << 4;
    // The first that is met, or the last.
    FACES[(met | 1 << 5).trailing_zeros() as usize]
}

/// As `Cuboid::intersect`, a ray a lane.
#[inline(always)]
pub fn meet_rays<S: Simd, V: Lanes<S>>(
    simd: S,
    shape: &Cuboid,
    terms: &Terms<V, V::Mask>,
    limit: V,
) -> Meeting<V, V::Mask> {
    let zero = V::simd_from(simd, 0.0);
    let mut entry = V::simd_from(simd, f32::NEG_INFINITY);
    let mut exit = V::simd_from(simd, f32::INFINITY);
    let mut met = V::Mask::splat(simd, true);
    let (o, d, r) = (terms.origin, terms.direction, terms.reciprocal);
    let min = Vectors::<V>::splat(simd, shape.min);
    let max = Vectors::<V>::splat(simd, shape.max);
    if !terms.any_along {
        return meet_planes(simd, (min - o) * r, (max - o) * r, limit);
    }
    for (o, d, r, min, max) in [
        (o.x, d.x, r.x, min.x, max.x),
        (o.y, d.y, r.y, min.y, max.y),
        (o.z, d.z, r.z, min.z, max.z),
    ] {
        let (to_min, to_max): (V, V) = (min - o, max - o);
        let (up, along) = (d.simd_gt(zero), d.simd_eq(zero));
        let near: V = up.select(to_min, to_max) * r;
        let far: V = up.select(to_max, to_min) * r;
        entry = (near.simd_gt(entry) & !along).select(near, entry);
        exit = (far.simd_lt(exit) & !along).select(far, exit);
        met &= !along | (to_min.simd_le(zero) & to_max.simd_ge(zero));
    }
    within(simd, entry, exit, met & entry.simd_le(exit), limit)
}

/// As `Cuboid::intersect`, from the distances to the lower and the upper bounds, of rays that do not go along the
/// planes across an axis.
#[inline(always)]
fn meet_planes<S: Simd, V: Lanes<S>>(
    simd: S,
    to_min: Vectors<V>,
    to_max: Vectors<V>,
    limit: V,
) -> Meeting<V, V::Mask> {
    // Rounding is monotonic: what comes first is the lesser product.
    let near = |a: V, b: V| a.min(b);
    let far = |a: V, b: V| a.max(b);
    let entry = near(to_min.x, to_max.x)
        .max(near(to_min.y, to_max.y))
        .max(near(to_min.z, to_max.z));
    let exit = far(to_min.x, to_max.x)
        .min(far(to_min.y, to_max.y))
        .min(far(to_min.z, to_max.z));
    within(simd, entry, exit, entry.simd_le(exit), limit)
}

/// The first of the points at which a ray enters and leaves that lies between its ends.
#[inline(always)]
fn within<S: Simd, V: Lanes<S>>(
    simd: S,
    entry: V,
    exit: V,
    met: V::Mask,
    limit: V,
) -> Meeting<V, V::Mask> {
    let zero = V::simd_from(simd, 0.0);
    let t = entry.simd_gt(zero).select(entry, exit);
    Meeting {
        t,
        met: met & t.simd_gt(zero) & t.simd_lt(limit),
    }
}

/// As `Cuboid::normal`, a ray a lane; of rays that meet the box at `t`.
#[inline(always)]
pub fn normals<S: Simd, V: Lanes<S>>(
    simd: S,
    shape: &Cuboid,
    terms: &Terms<V, V::Mask>,
    t: V,
) -> Vectors<V> {
    let zero = V::simd_from(simd, 0.0);
    let (o, d, r) = (terms.origin, terms.direction, terms.reciprocal);
    let to_min = (Vectors::splat(simd, shape.min) - o) * r;
    let to_max = (Vectors::splat(simd, shape.max) - o) * r;
    let along = [d.x.simd_eq(zero), d.y.simd_eq(zero), d.z.simd_eq(zero)];
    faces(simd, to_min, to_max, along, t)
}

/// The normals of the faces at `t`, from the distances to the lower and the upper bounds, and which rays go along
/// the planes across each axis.
#[inline(always)]
fn faces<S: Simd, V: Lanes<S>>(
    simd: S,
    to_min: Vectors<V>,
    to_max: Vectors<V>,
    along: [V::Mask; 3],
    t: V,
) -> Vectors<V> {
    let (zero, one) = (V::simd_from(simd, 0.0), V::simd_from(simd, 1.0));
    let on = |near: V, far: V, along: V::Mask| (near.simd_eq(t) & !along, far.simd_eq(t) & !along);
    let (left, right) = on(to_min.x, to_max.x, along[0]);
    let (bottom, top) = on(to_min.y, to_max.y, along[1]);
    let (back, _) = on(to_min.z, to_max.z, along[2]);
    // The first that is met, or the last.
    let face = |lower: V::Mask, upper: V| lower.select(-one, upper);
    let sideways = left | right;
    let upright = !sideways & (bottom | top);
    Vectors {
        x: face(left, right.select(one, zero)),
        y: upright.select(face(bottom, one), zero),
        z: (sideways | upright).select(zero, face(back, one)),
    }
}
