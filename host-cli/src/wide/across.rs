//! As many rays as a vector has lanes, cast into every object: for scenes of few.
//!
//! The kernels are those of the blocks, with the roles exchanged: the object is the same in all lanes,
//! and each lane has a ray of its own. Rays need nothing in common. Objects that all rays are certain to
//! miss are passed over (`around`).

use fearless_simd::{Select, Simd, SimdBase, SimdMask};
use whitted::math::Transmittance;
use whitted::{Cuboid, Exact, Finish, Frustum, Plane, Sphere, Vec3};

use super::around::{Around, Passing};
use super::beams::{Beams, Set};
use super::blocks::Kind;
use super::lanes::{Lanes, Meeting, Vectors, fastest_of_each, mask_of};
use super::parts::Parts;
use super::rays::Needs;
use super::{cuboid, frustum, outline, sphere};

/// What there is to know of few objects, by place.
#[derive(Debug)]
pub struct Few<'a, M> {
    around: Vec<Around>,
    kernels: Vec<Kernel>,
    pub materials: Vec<&'a M>,
    /// Whether no light goes through.
    opaque: Vec<bool>,
}

/// By which kernel rays meet an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kernel {
    Sphere,
    Plane,
    Polygon,
    Triangle,
    Patch,
    Cuboid,
    Frustum,
}

impl<'a, M: Finish> Few<'a, M> {
    pub fn new(parts: &Parts<'a, M>) -> Self {
        let mut few = Self {
            around: Vec::with_capacity(parts.len()),
            kernels: Vec::with_capacity(parts.len()),
            materials: Vec::with_capacity(parts.len()),
            opaque: (0..parts.len()).map(|it| parts.is_opaque(it)).collect(),
        };
        macro_rules! add {
            ($($part:ident, $kernel:ident, |$shape:ident| $around:expr;)*) => {$(
                for it in parts.$part.objects {
                    let $shape = &it.shape;
                    few.around.push($around);
                    few.kernels.push(Kernel::$kernel);
                    few.materials.push(it.material);
                }
            )*};
        }
        add! {
            spheres, Sphere, |it| Around::sphere(it);
            planes, Plane, |_it| Around::ALL;
            polygons, Polygon, |it| Around::outline(it.vertices);
            triangles, Triangle, |it| Around::outline(&it.vertices);
            patches, Patch, |it| Around::outline(&it.vertices);
            cuboids, Cuboid, |it| Around::cuboid(it);
            frusta, Frustum, |_it| Around::ALL;
        }
        few
    }
}

impl<M> Few<'_, M> {
    /// Whether only its kernel knows an object's normal, though that is flat.
    #[inline(always)]
    pub fn is_patch(&self, place: usize) -> bool {
        self.kernels[place] == Kernel::Patch
    }
}

/// A place as a number that equals no other place's, nor itself where it is `u32::MAX`.
#[inline(always)]
fn number(place: u32) -> f32 {
    // From 1 to 2, without a conversion.
    f32::from_bits(place | 1.0_f32.to_bits())
}

/// How many places [`number`] tells apart.
pub const PLACES: usize = 1 << 23;

/// Which of few objects any of the rays may meet.
#[derive(Clone, Debug)]
pub struct Near {
    /// For each object, a bit a lane.
    pub lanes: Vec<u32>,
    /// For each 32 objects, a bit an object of which there is such a lane.
    pub objects: Vec<u32>,
}

impl Near {
    /// Room for as many objects.
    pub fn new(count: usize) -> Self {
        Self {
            lanes: vec![0; count],
            objects: vec![0; count.div_ceil(32)],
        }
    }

    /// Finds them, for the `open` lanes, and says whether there are any; `returning` is a bit a lane, whether
    /// its ray may meet the object that it leaves.
    ///
    /// Before all else: in this loop, whatever lives beyond it would take the registers of its own terms.
    #[inline(always)]
    pub fn find<S: Simd, V: Lanes<S>, M, const N: usize>(
        &mut self,
        simd: S,
        few: &Few<'_, M>,
        beams: &Beams<N>,
        open: u32,
        returning: u32,
    ) -> bool {
        let passing = Passing::<V>::new(simd, beams.origin.load(simd), beams.direction.load(simd));
        let leaves = beams.left != [u32::MAX; N];
        let left = V::from_slice(simd, &beams.left.map(number));
        let (mut place, mut found) = (0, 0);
        let arounds = few.around.chunks(32).zip(self.lanes.chunks_mut(32));
        for (objects, (arounds, lanes)) in self.objects.iter_mut().zip(arounds) {
            let mut any = 0;
            for (i, (around, lanes)) in arounds.iter().zip(lanes).enumerate() {
                let mut may = !(passing.misses(simd, around).to_bitmask() as u32);
                if leaves {
                    let left = left.simd_eq(V::simd_from(simd, number(place)));
                    let left = left.to_bitmask() as u32;
                    may = may & !left | left & returning;
                    place += 1;
                }
                *lanes = may & open;
                any |= u32::from(*lanes != 0) << i;
            }
            *objects = any;
            found |= any;
        }
        found != 0
    }

    /// The objects, in order.
    #[inline(always)]
    fn objects(&self) -> impl Iterator<Item = usize> {
        let words = self.words();
        words.flat_map(|(first, word)| Set(word).map(move |i| first + i))
    }

    /// A bit an object, by 32, and the place of the first of these.
    #[inline(always)]
    pub fn words(&self) -> impl Iterator<Item = (usize, u32)> {
        (0..).step_by(32).zip(self.objects.iter().copied())
    }

    /// Whether there is no object.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.objects.iter().all(|&it| it == 0)
    }
}

/// Rays, and what kernels need to know of them.
pub struct Terms<V, M> {
    pub origin: Vectors<V>,
    pub direction: Vectors<V>,
    /// Places of the objects that they leave.
    left: V,
    any_left: bool,
    /// Which go on inside of those.
    inward: M,
    /// Which are closest to the first axis, and which to the second.
    pub axes: [M; 2],
    /// Origin and direction with that axis last.
    pub turned: [Vectors<V>; 2],
    pub reciprocal: Vectors<V>,
    /// Whether any ray goes along the planes across an axis.
    pub any_along: bool,
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
    #[inline(always)]
    pub fn new<S: Simd, const N: usize>(simd: S, beams: &Beams<N>, needs: Needs) -> Self
    where
        V: Lanes<S, Mask = M>,
        M: SimdMask<S> + Select<V>,
    {
        let (origin, direction) = (beams.origin.load(simd), beams.direction.load::<S, V>(simd));
        let left = beams.left.map(number);
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
        let (mut reciprocal, mut any_along) = (none, false);
        if needs.reciprocal {
            let along = |x: V| x.simd_eq(zero);
            any_along = (along(direction.x) | along(direction.y) | along(direction.z)).any_true();
            reciprocal = Vectors {
                x: one / direction.x,
                y: one / direction.y,
                z: one / direction.z,
            };
        }
        Self {
            left: V::from_slice(simd, &left),
            any_left: beams.left != [u32::MAX; N],
            inward: M::from_bitmask(simd, beams.inward.into()),
            axes,
            turned,
            reciprocal,
            any_along,
            origin,
            direction,
        }
    }

    /// What rays meet of the object at this place, if they do not leave it.
    #[inline(always)]
    pub fn unless_left<S: Simd>(
        &self,
        simd: S,
        place: usize,
        mut meeting: Meeting<V, M>,
    ) -> Meeting<V, M>
    where
        V: Lanes<S, Mask = M>,
        M: SimdMask<S>,
    {
        meeting.met &= !self.leaves(simd, place);
        meeting
    }

    /// Which rays leave the object at this place.
    #[inline(always)]
    fn leaves<S: Simd>(&self, simd: S, place: usize) -> M
    where
        V: Lanes<S, Mask = M>,
        M: SimdMask<S>,
    {
        if self.any_left {
            self.left.simd_eq(V::simd_from(simd, number(place as u32)))
        } else {
            M::splat(simd, false)
        }
    }
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
        let chord = sphere::across(simd, center, origin, direction);
        let inside = terms.inward ^ V::Mask::splat(simd, !shows_outside);
        let zero = V::simd_from(simd, 0.0);
        let met = inside & chord.simd_gt(zero) & chord.simd_lt(limit);
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
    let returning = terms.inward ^ V::Mask::splat(simd, !frustum::shows_outside(shape));
    (meeting, (left & returning).to_bitmask() as u32)
}

/// What rays meet of one object that is in a block, even those that leave it.
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
    match kind {
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

/// What rays meet of one of few objects, and its normal.
#[inline(always)]
fn one_of_few<'a, S: Simd, V: Lanes<S>, M>(
    simd: S,
    parts: &Parts<'a, M>,
    kernel: Kernel,
    place: usize,
    terms: &Terms<V, V::Mask>,
    limit: V,
) -> (Meeting<V, V::Mask>, Apart, Outward<'a>) {
    let left = terms.leaves(simd, place);
    macro_rules! of {
        ($part:ident, |$it:ident| $meet:expr, $normal:expr) => {{
            let $it = &parts.$part.objects[place - parts.$part.first].shape;
            let (meeting, apart) = $meet;
            (meeting, apart, $normal)
        }};
    }
    match kernel {
        Kernel::Sphere => of!(
            spheres,
            |it| sphere(simd, it, terms, left, limit),
            Outward::Center(it.center, !(it.radius > 0.0))
        ),
        Kernel::Plane => of!(
            planes,
            |it| plane(simd, it, terms, left, limit),
            Outward::Flat(it.normal)
        ),
        Kernel::Polygon => of!(
            polygons,
            |it| flat(simd, it.vertices, it.normal, terms, left, limit),
            Outward::Flat(it.normal)
        ),
        Kernel::Triangle => of!(
            triangles,
            |it| flat(simd, &it.vertices, it.normal, terms, left, limit),
            Outward::Flat(it.normal)
        ),
        Kernel::Patch => of!(
            patches,
            |it| flat(simd, &it.vertices, it.normal, terms, left, limit),
            Outward::Unknown
        ),
        Kernel::Cuboid => of!(
            cuboids,
            |it| cuboid(simd, it, terms, left, limit),
            Outward::Faces(it)
        ),
        Kernel::Frustum => of!(
            frusta,
            |it| frustum(simd, it, terms, left, limit),
            Outward::Unknown
        ),
    }
}

/// The nearest hits of rays.
pub struct Nearest<V> {
    /// Distances; where nothing is met, what the limit was.
    pub t: V,
    /// Places, in the last bits: see [`PLACES`].
    pub object: V,
    /// Outward normals.
    pub outward: Vectors<V>,
    /// A bit a lane: of which the kernels have to say the normal.
    pub unknown: u32,
}

/// The nearest hit of each ray before its limit.
#[inline(always)]
pub fn nearest<S: Simd, V: Lanes<S>, M, const N: usize>(
    simd: S,
    parts: &Parts<'_, M>,
    few: &Few<'_, M>,
    near: &Near,
    terms: &Terms<V, V::Mask>,
    beams: &Beams<N>,
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
    for place in near.objects() {
        let (meeting, mut apart, normal) =
            one_of_few(simd, parts, few.kernels[place], place, terms, t);
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
        let all = met | apart;
        if all == 0 {
            continue;
        }
        t = meeting.met.select(meeting.t, t);
        let number = V::simd_from(simd, number(place as u32));
        object = V::Mask::from_bitmask(simd, all.into()).select(number, object);
        (round, hollow, unknown) = (round & !all, hollow & !all, unknown & !all | apart);
        let normals = match normal {
            Outward::Center(center, inside) => {
                round |= met;
                hollow |= if inside { met } else { 0 };
                Vectors::splat(simd, center)
            }
            Outward::Flat(normal) => Vectors::splat(simd, normal),
            Outward::Faces(cuboid) => cuboid::normals(simd, cuboid, terms, meeting.t),
            Outward::Unknown => {
                unknown |= met;
                continue;
            }
        };
        outward = mask_of(meeting.met, normals, outward);
    }
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
    near: &Near,
    terms: &Terms<V, V::Mask>,
    beams: &Beams<N>,
    set: u32,
) -> [f32; N] {
    let mut light = [Transmittance::default(); N];
    let (mut open, mut dimmed) = (set, 0);
    let dark = V::simd_from(simd, f32::NEG_INFINITY);
    let ends = V::from_slice(simd, &beams.end);
    let mut limit = V::Mask::from_bitmask(simd, open.into()).select(ends, dark);
    for place in near.objects() {
        if near.lanes[place] & open == 0 {
            continue;
        }
        let (meeting, apart, _) = one_of_few(simd, parts, few.kernels[place], place, terms, limit);
        let mut met = meeting.met.to_bitmask() as u32;
        let before = open;
        if few.opaque[place] {
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
            break;
        }
        if open != before {
            limit = V::Mask::from_bitmask(simd, open.into()).select(limit, dark);
        }
    }
    let open = V::Mask::from_bitmask(simd, open.into());
    let (one, none) = (V::simd_from(simd, 1.0), V::simd_from(simd, 0.0));
    let mut passed = [0.0; N];
    open.select(one, none).store_slice(&mut passed);
    for lane in Set(dimmed & open.to_bitmask() as u32) {
        passed[lane] = light[lane].product();
    }
    passed
}
