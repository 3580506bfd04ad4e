//! As many rays as a vector has lanes, cast into every object: for scenes of few.
//!
//! The kernels are those of the blocks, with the roles exchanged: the object is the same in all lanes,
//! and each lane has a ray of its own. Rays need nothing in common. Objects that all rays are certain to
//! miss are passed over (`around`).

use fearless_simd::{Select, Simd, SimdBase, SimdMask};
use whitted::material::Transmission;
use whitted::math::Transmittance;
use whitted::{Cuboid, Exact, Finish, Frustum, Plane, Sphere, Vec3};

use super::around::{Around, Passing};
use super::beams::{Beams, Set};
use super::blocks::Kind;
use super::bounds::{FAR, ROUNDING};
use super::lanes::{Lanes, Meeting, Vectors, fastest_of_each, mask_of};
use super::parts::Parts;
use super::rays::{INVERTIBLE, Needs};
use super::{cuboid, frustum, outline, sphere};

/// What there is to know of few objects, by place.
#[derive(Debug)]
pub struct Few<'a, M> {
    around: Vec<Around>,
    pub materials: Vec<&'a M>,
}

impl<'a, M> Few<'a, M> {
    pub fn new(parts: &Parts<'a, M>) -> Self {
        let mut few = Self {
            around: Vec::with_capacity(parts.len()),
            materials: Vec::with_capacity(parts.len()),
        };
        macro_rules! add {
            ($($part:ident: $it:ident => $around:expr),*) => {$(
                for $it in parts.$part.objects {
                    few.around.push($around);
                    few.materials.push($it.material);
                }
            )*};
        }
        add!(
            spheres: it => Around::sphere(&it.shape),
            planes: it => Around::ALL,
            polygons: it => Around::points(it.shape.vertices),
            triangles: it => Around::points(&it.shape.vertices),
            patches: it => Around::points(&it.shape.vertices),
            cuboids: it => Around::cuboid(&it.shape),
            frusta: it => Around::ALL
        );
        few
    }
}

/// Rays, and what kernels need to know of them.
pub struct Terms<V, M> {
    pub origin: Vectors<V>,
    pub direction: Vectors<V>,
    /// Places of the objects that they leave.
    left: V,
    any_left: bool,
    /// A bit a lane: which may meet the object that they leave.
    returning: u32,
    pub passing: Passing<V>,
    /// Which go on inside of those.
    inward: M,
    /// Which are closest to the first axis, and which to the second.
    pub axes: [M; 2],
    /// Origin and direction with that axis last.
    pub turned: [Vectors<V>; 2],
    pub reciprocal: Vectors<V>,
}

/// [`Terms`] of vectors of this type.
pub type TermsOf<S, V> = Terms<V, <V as SimdBase<S>>::Mask>;

/// `v` with the axis last to which a ray is closest.
#[inline(always)]
pub fn turn<S: Simd, V: Lanes<S>>(axes: [V::Mask; 2], v: Vectors<V>) -> Vectors<V> {
    let [x, y] = axes;
    Vectors {
        x: x.select(v.y, v.x),
        y: (x | y).select(v.z, v.y),
        z: x.select(v.x, y.select(v.y, v.z)),
    }
}

impl<V: Copy, M: Copy> Terms<V, M> {
    /// `returning` is a bit a lane: which may meet the object that they leave.
    #[inline(always)]
    pub fn new<S: Simd, const N: usize>(
        simd: S,
        beams: &Beams<N>,
        needs: Needs,
        returning: u32,
    ) -> Self
    where
        V: Lanes<S, Mask = M>,
        M: SimdMask<S> + Select<V>,
    {
        let (origin, direction) = (beams.origin.load(simd), beams.direction.load::<S, V>(simd));
        let left = beams.left.map(|it| it as f32);
        let (zero, one) = (V::simd_from(simd, 0.0), V::simd_from(simd, 1.0));
        let none = Vectors {
            x: zero,
            y: zero,
            z: zero,
        };
        let (mut axes, mut turned) = ([M::splat(simd, false); 2], [none; 2]);
        if needs.turned {
            axes = fastest_of_each(direction);
            turned = [turn(axes, origin), turn(axes, direction)];
        }
        let mut reciprocal = none;
        if needs.reciprocal {
            reciprocal = Vectors {
                x: one / direction.x,
                y: one / direction.y,
                z: one / direction.z,
            };
        }
        Self {
            left: V::from_slice(simd, &left),
            any_left: beams.left != [u32::MAX; N],
            returning,
            passing: Passing::new(simd, origin, direction),
            inward: M::from_bitmask(simd, beams.inward.into()),
            axes,
            turned,
            reciprocal,
            origin,
            direction,
        }
    }

    /// Which rays leave the object at this place.
    #[inline(always)]
    fn leaves<S: Simd>(&self, simd: S, place: usize) -> M
    where
        V: Lanes<S, Mask = M>,
        M: SimdMask<S>,
    {
        if self.any_left {
            self.left.simd_eq(V::simd_from(simd, place as f32))
        } else {
            M::splat(simd, false)
        }
    }
}

/// Of which rays the lanes' answer is the kernels' own, as `Wide::takes_this`.
#[inline(always)]
pub fn regular<S: Simd, V: Lanes<S>>(
    simd: S,
    origin: Vectors<V>,
    direction: Vectors<V>,
) -> V::Mask {
    let d = direction;
    let off = (d.dot(d) - V::simd_from(simd, 1.0)).abs();
    let reach = origin.x.abs() + origin.y.abs() + origin.z.abs();
    let (zero, least) = (V::simd_from(simd, 0.0), V::simd_from(simd, INVERTIBLE));
    let mut regular =
        off.simd_lt(V::simd_from(simd, ROUNDING)) & reach.simd_lt(V::simd_from(simd, FAR));
    for x in [d.x, d.y, d.z] {
        regular &= x.simd_eq(zero) | x.abs().simd_gt(least);
    }
    regular
}

/// What of an object's answer the kernels themselves have to give: of the rays in this set.
type Apart = u32;

#[inline(always)]
fn sphere<S: Simd, V: Lanes<S>>(
    simd: S,
    shape: &Sphere,
    terms: &Terms<V, V::Mask>,
    left: V::Mask,
    limit: V,
) -> (Meeting<V, V::Mask>, Apart) {
    let center = Vectors::splat(simd, shape.center);
    let square = shape.radius * shape.radius;
    // What has no radius has no surface.
    let square = if square > 0.0 {
        square
    } else {
        f32::NEG_INFINITY
    };
    let square = V::simd_from(simd, square);
    let (origin, direction) = (terms.origin, terms.direction);
    let shows_outside = shape.radius > 0.0;
    let mut meeting = if shows_outside {
        sphere::meet::<S, V, false>(simd, center, square, origin, direction, limit)
    } else {
        sphere::meet::<S, V, true>(simd, center, square, origin, direction, limit)
    };
    if terms.any_left && left.any_true() {
        // The other end of the chord.
        let chord = (center - origin).dot(direction) * V::simd_from(simd, 2.0);
        let across = terms.inward ^ V::Mask::splat(simd, !shows_outside);
        let zero = V::simd_from(simd, 0.0);
        let met = across & chord.simd_gt(zero) & chord.simd_lt(limit);
        meeting.t = left.select(chord, meeting.t);
        meeting.met = (left & met) | (!left & meeting.met);
    }
    (meeting, 0)
}

#[inline(always)]
fn plane<S: Simd, V: Lanes<S>>(
    simd: S,
    shape: &Plane,
    terms: &Terms<V, V::Mask>,
    left: V::Mask,
    limit: V,
) -> (Meeting<V, V::Mask>, Apart) {
    let normal = Vectors::splat(simd, shape.normal);
    let height = normal.dot(Vectors::splat(simd, shape.point) - terms.origin);
    let t = height / normal.dot(terms.direction);
    let met = t.simd_gt(V::simd_from(simd, 0.0)) & t.simd_lt(limit) & !left;
    (Meeting { t, met }, 0)
}

#[inline(always)]
fn flat<S: Simd, V: Lanes<S>>(
    simd: S,
    vertices: &[Vec3],
    normal: Vec3,
    terms: &Terms<V, V::Mask>,
    left: V::Mask,
    limit: V,
) -> (Meeting<V, V::Mask>, Apart) {
    let mut meeting = outline::meet_rays(simd, vertices, normal, terms, limit);
    meeting.met &= !left;
    (meeting, 0)
}

#[inline(always)]
fn cuboid<S: Simd, V: Lanes<S>>(
    simd: S,
    shape: &Cuboid,
    terms: &Terms<V, V::Mask>,
    left: V::Mask,
    limit: V,
) -> (Meeting<V, V::Mask>, Apart) {
    let mut meeting = cuboid::meet_rays(simd, shape, terms, limit);
    meeting.met &= !left;
    (meeting, left.to_bitmask() as u32)
}

#[inline(always)]
fn frustum<S: Simd, V: Lanes<S>>(
    simd: S,
    shape: &Frustum,
    terms: &Terms<V, V::Mask>,
    left: V::Mask,
    limit: V,
) -> (Meeting<V, V::Mask>, Apart) {
    let mut meeting = frustum::meet_rays(simd, shape, terms, limit);
    meeting.met &= !left;
    (meeting, left.to_bitmask() as u32)
}

/// What rays meet of one object that is in a block, and that they do not leave.
#[inline(always)]
pub fn object<S: Simd, V: Lanes<S>, M>(
    simd: S,
    parts: &Parts<'_, M>,
    kind: Kind,
    object: usize,
    terms: &Terms<V, V::Mask>,
    limit: V,
) -> Meeting<V, V::Mask> {
    let none = V::Mask::splat(simd, false);
    let mut meeting = match kind {
        Kind::Sphere | Kind::HollowSphere => {
            let part = &parts.spheres;
            let shape = &part.objects[object - part.first].shape;
            sphere(simd, shape, terms, none, limit).0
        }
        Kind::Triangle | Kind::Quad | Kind::Outline => {
            let (vertices, normal) = parts.outline(object);
            flat(simd, vertices, normal, terms, none, limit).0
        }
        Kind::Cuboid => {
            let part = &parts.cuboids;
            let shape = &part.objects[object - part.first].shape;
            cuboid(simd, shape, terms, none, limit).0
        }
        Kind::Frustum | Kind::HollowFrustum => {
            let part = &parts.frusta;
            let shape = &part.objects[object - part.first].shape;
            frustum(simd, shape, terms, none, limit).0
        }
        Kind::Other => unreachable!("its kernel takes one ray"),
    };
    meeting.met &= !terms.leaves(simd, object);
    meeting
}

/// How many objects are looked at before the first is met.
const AHEAD: usize = 32;

impl<M> Few<'_, M> {
    /// Which of the lanes may meet each of up to [`AHEAD`] objects from this place on, a bit a lane, and
    /// of which objects any may, a bit an object.
    #[inline(always)]
    fn near<S: Simd, V: Lanes<S>, const SOLID: bool>(
        &self,
        simd: S,
        place: usize,
        count: usize,
        terms: &Terms<V, V::Mask>,
        open: u32,
        lanes: &mut [u32; AHEAD],
    ) -> u32 {
        let mut near = 0;
        let arounds = &self.around[place..place + count];
        for (i, (around, lanes)) in arounds.iter().zip(lanes).enumerate() {
            let mut may = !(terms.passing.misses::<S, SOLID>(simd, around).to_bitmask() as u32);
            if terms.any_left {
                let left = terms.leaves(simd, place + i).to_bitmask() as u32;
                may = may & !left | left & terms.returning;
            }
            *lanes = may & open;
            near |= u32::from(*lanes != 0) << i;
        }
        near
    }
}

/// What an object's outward normal comes from.
enum Outward<'a> {
    /// A sphere's center, and whether it is visible from inside only.
    Center(Vec3, bool),
    /// The same everywhere.
    Flat(Vec3),
    Faces(&'a Cuboid),
    /// The kernel.
    Unknown,
}

/// Evaluates `$use` with what the rays meet of each object that those `$open` do not surely miss, in order,
/// before `$limit`.
macro_rules! each_object {
    ($simd:ident, $parts:ident, $few:ident, $terms:ident, $open:expr, $limit:expr,
        |$place:ident, $it:ident, $found:ident, $outward:ident| $use:expr) => {
        each_object!(@ true, $simd, $parts.spheres, $few, $terms, $open,
            |$place, $it, $found, $outward| $use,
            left => sphere($simd, &$it.shape, $terms, left, $limit),
            Outward::Center($it.shape.center, !($it.shape.radius > 0.0)));
        each_object!(@ true, $simd, $parts.planes, $few, $terms, $open,
            |$place, $it, $found, $outward| $use,
            left => plane($simd, &$it.shape, $terms, left, $limit),
            Outward::Flat($it.shape.normal));
        each_object!(@ false, $simd, $parts.polygons, $few, $terms, $open,
            |$place, $it, $found, $outward| $use,
            left => flat($simd, $it.shape.vertices, $it.shape.normal, $terms, left, $limit),
            Outward::Flat($it.shape.normal));
        each_object!(@ false, $simd, $parts.triangles, $few, $terms, $open,
            |$place, $it, $found, $outward| $use,
            left => flat($simd, &$it.shape.vertices, $it.shape.normal, $terms, left, $limit),
            Outward::Flat($it.shape.normal));
        each_object!(@ false, $simd, $parts.patches, $few, $terms, $open,
            |$place, $it, $found, $outward| $use,
            left => flat($simd, &$it.shape.vertices, $it.shape.normal, $terms, left, $limit),
            Outward::Unknown);
        each_object!(@ true, $simd, $parts.cuboids, $few, $terms, $open,
            |$place, $it, $found, $outward| $use,
            left => cuboid($simd, &$it.shape, $terms, left, $limit),
            Outward::Faces(&$it.shape));
        each_object!(@ true, $simd, $parts.frusta, $few, $terms, $open,
            |$place, $it, $found, $outward| $use,
            left => frustum($simd, &$it.shape, $terms, left, $limit),
            Outward::Unknown);
    };
    (@ $solid:literal, $simd:ident, $parts:ident.$part:ident, $few:ident, $terms:ident, $open:expr,
        |$place:ident, $it:ident, $found:ident, $outward:ident| $use:expr,
        $left:ident => $meet:expr, $normal:expr) => {
        for (n, objects) in $parts.$part.objects.chunks(AHEAD).enumerate() {
            let first = $parts.$part.first + n * AHEAD;
            let mut lanes = [0; AHEAD];
            let near = $few.near::<S, V, $solid>(
                $simd, first, objects.len(), $terms, $open, &mut lanes);
            for i in Set(near) {
                if lanes[i] & $open != 0 {
                    let ($place, $it) = (first + i, &objects[i]);
                    let $left = $terms.leaves($simd, $place);
                    let $found: (Meeting<V, V::Mask>, Apart) = $meet;
                    let $outward = $normal;
                    $use
                }
            }
        }
    };
}

/// The nearest hits of rays.
pub struct Nearest<V> {
    /// Distances; where nothing is met, what the limit was.
    pub t: V,
    /// Places.
    pub object: V,
    /// Outward normals.
    pub outward: Vectors<V>,
    /// A bit a lane: of which the kernels have to say the normal.
    pub unknown: u32,
}

/// The nearest hit of each ray of a set before its limit.
#[inline(always)]
pub fn nearest<S: Simd, V: Lanes<S>, M, const N: usize>(
    simd: S,
    parts: &Parts<'_, M>,
    few: &Few<'_, M>,
    terms: &Terms<V, V::Mask>,
    beams: &Beams<N>,
    set: u32,
    limit: V,
) -> Nearest<V> {
    let zero = V::simd_from(simd, 0.0);
    let (mut t, mut object) = (limit, zero);
    let mut outward = Vectors {
        x: zero,
        y: zero,
        z: zero,
    };
    // Of spheres, the center stands for the normal.
    let (mut round, mut hollow, mut unknown) = (0_u32, 0_u32, 0_u32);
    each_object!(
        simd,
        parts,
        few,
        terms,
        set,
        t,
        |place, it, found, normal| {
            let (meeting, mut apart) = found;
            if apart != 0 {
                // Behind all before it, as it is in order.
                let mut ts = [0.0; N];
                t.store_slice(&mut ts);
                let mut nearer = 0;
                for lane in Set(apart) {
                    let ray = beams.ray(lane);
                    match parts.intersect::<Exact>(&ray, place, 0) {
                        Some(at) if at < ts[lane] => {
                            ts[lane] = at;
                            nearer |= 1 << lane;
                        }
                        _ => {}
                    }
                }
                apart = nearer;
                t = V::from_slice(simd, &ts);
            }
            let met = meeting.met.to_bitmask() as u32;
            if met | apart != 0 {
                t = meeting.met.select(meeting.t, t);
                let changed = V::Mask::from_bitmask(simd, (met | apart).into());
                object = changed.select(V::simd_from(simd, place as f32), object);
                let kept = !(met | apart);
                (round, hollow, unknown) = (round & kept, hollow & kept, unknown & kept | apart);
                match normal {
                    Outward::Center(center, inside) => {
                        outward = mask_of(meeting.met, Vectors::splat(simd, center), outward);
                        round |= met;
                        hollow |= if inside { met } else { 0 };
                    }
                    Outward::Flat(normal) => {
                        outward = mask_of(meeting.met, Vectors::splat(simd, normal), outward);
                    }
                    Outward::Faces(cuboid) => {
                        let normals = cuboid::normals(simd, cuboid, terms, meeting.t);
                        outward = mask_of(meeting.met, normals, outward);
                    }
                    Outward::Unknown => unknown |= met,
                }
            }
            let _ = it;
        }
    );
    if round != 0 {
        let point = terms.origin + terms.direction * t;
        let unit = away(simd, point, outward, hollow);
        let round = V::Mask::from_bitmask(simd, round.into());
        outward = mask_of(round, unit, outward);
    }
    Nearest {
        t,
        object,
        outward,
        unknown,
    }
}

/// As `Sphere::normal`, from points and centers; `hollow` is a bit a lane.
#[inline(always)]
pub fn away<S: Simd, V: Lanes<S>>(
    simd: S,
    point: Vectors<V>,
    center: Vectors<V>,
    hollow: u32,
) -> Vectors<V> {
    let from_center = point - center;
    let unit = from_center * (V::simd_from(simd, 1.0) / from_center.dot(from_center).sqrt());
    mask_of(V::Mask::from_bitmask(simd, hollow.into()), -unit, unit)
}

/// What the objects leave of a light, for each ray of a set.
#[inline(always)]
pub fn transmittance<S: Simd, V: Lanes<S>, M: Finish, const N: usize>(
    simd: S,
    parts: &Parts<'_, M>,
    few: &Few<'_, M>,
    terms: &Terms<V, V::Mask>,
    beams: &Beams<N>,
    set: u32,
    passed: &mut [f32; N],
) {
    let mut light = [Transmittance::default(); N];
    let (mut open, mut dimmed) = (set, 0);
    let dark = V::simd_from(simd, f32::NEG_INFINITY);
    let ends = V::from_slice(simd, &beams.end);
    let mut limit = V::Mask::from_bitmask(simd, open.into()).select(ends, dark);
    'all: {
        each_object!(
            simd,
            parts,
            few,
            terms,
            open,
            limit,
            |place, it, found, _normal| {
                let (meeting, apart) = found;
                let mut met = meeting.met.to_bitmask() as u32;
                let before = open;
                // Also true for NaN.
                if !(it.material.transmission().transmittance() > 0.0) {
                    open &= !met;
                    met = 0;
                }
                for lane in Set(met & open) {
                    let ray = beams.ray(lane);
                    dimmed |= 1 << lane;
                    if parts.absorbs_met::<Exact, _>(&ray, place, 0, &mut light[lane]) {
                        open &= !(1 << lane);
                    }
                }
                for lane in Set(apart & open) {
                    let ray = beams.ray(lane);
                    dimmed |= 1 << lane;
                    if parts.absorbs::<Exact, _>(&ray, place, 0, &mut light[lane]) {
                        open &= !(1 << lane);
                    }
                }
                if open == 0 {
                    break 'all;
                }
                if open != before {
                    limit = V::Mask::from_bitmask(simd, open.into()).select(limit, dark);
                }
            }
        );
    }
    for lane in Set(set) {
        passed[lane] = if open >> lane & 1 == 0 {
            0.0
        } else if dimmed >> lane & 1 != 0 {
            light[lane].product()
        } else {
            1.0
        };
    }
}
