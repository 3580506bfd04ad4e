//! Constructive solid geometry: unions, intersections and differences of solids.
//!
//! An expression is a type, [`Difference<Intersection<A, B>, C>`](Difference) say, over leaves that are
//! [`Object`]s of [`Closed`] shapes; [`Csg`] makes a [`Geometry`] of it. After S. D. Roth, "Ray Casting for
//! Modeling Solids", Computer Graphics and Image Processing 18(2), 1982: a ray crosses the leaves at some
//! distances, and what it is inside of between them decides where the solid's surface is. The distances lie
//! in one buffer, whose size the compiler checks; the insides are one bit a leaf.
//!
//! Normal and material are those of the leaf that is met, the normal turned where the leaf is taken away.
//! Each leaf counts as one object, so that [`Departure`] names the surface that a ray leaves.
//!
//! # Faces that coincide
//!
//! Between crossings of two leaves that lie within rounding of each other, by faces that are parallel, there
//! is nothing: they count as one. So there is no film where a face of what is taken away lies in a face of
//! what it is taken from, and no wall where two parts of a union touch. Of the leaves that make such a
//! surface, the first in the expression lends it normal and material.
//!
//! What a ray leaves is not met again, nor is any face that it meets within rounding of where it starts.
//!
//! Rounding is [`SLACK`] times the greatest coordinate of the ray's origin and the distance, together,
//! measured across the faces: twice what two kernels in [`crate::shape`] may differ by where two faces are
//! the same. What two leaves leave thinner than that is not there. For rays that meet a face at less than
//! 1/4096, it is measured along the ray, and 4096 times as much.

use glam::Vec3;
use heapless::Vec;

use crate::candidates::Candidates;
use crate::geometry::{Geometry, Object};
use crate::hierarchy::SLACK;
use crate::material::Finish;
use crate::math::{self, Math, Passage, dot};
use crate::ray::{Departure, Ray, Side};
use crate::shape::Closed;

/// How a ray ends that has no end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crossed {
    /// A bit for each leaf, 1 where the ray ends inside of it.
    pub inside: u32,
    /// Whether it crosses any.
    pub any: bool,
}

/// Solids, joined.
///
/// Leaves count from 0, those of the left before those of the right. Bit i of a number stands for leaf i.
pub trait Expression {
    /// What all leaves are made of.
    type Material;
    /// How many leaves there are, at most.
    const LEAVES: usize;
    /// At how many points a ray crosses them, at most.
    const CROSSINGS: usize;

    /// How many leaves there are.
    fn leaves(&self) -> usize {
        Self::LEAVES
    }

    /// Whether what is inside of these leaves, and of no others, is inside of the whole.
    fn contains(&self, leaves: u32) -> bool;

    /// Whether the inside of the leaf is taken away: from an even number of times none.
    fn flips(&self, leaf: usize) -> bool;

    /// As [`Closed::cross`] for all leaves; `visit` is told which. What cannot change the whole may be left
    /// out.
    fn cross<P: Math>(
        &self,
        ray: &Ray,
        leaving: Option<(usize, Side)>,
        visit: &mut impl FnMut(f32, usize),
    ) -> Crossed;

    /// As [`Shape::uv`](crate::Shape::uv), of a leaf.
    fn uv(&self, point: Vec3, leaf: usize) -> (f32, f32);

    /// The leaf's own outward normal where the ray crosses it at `t`, and its material.
    fn surface<P: Math>(&self, ray: &Ray, t: f32, leaf: usize) -> Option<(Vec3, &Self::Material)>;
}

impl<S: Closed, M> Expression for Object<'_, S, M> {
    type Material = M;
    const LEAVES: usize = 1;
    const CROSSINGS: usize = S::CROSSINGS;

    #[inline(always)]
    fn contains(&self, leaves: u32) -> bool {
        leaves & 1 == 1
    }

    #[inline(always)]
    fn flips(&self, _: usize) -> bool {
        false
    }

    #[inline]
    fn cross<P: Math>(
        &self,
        ray: &Ray,
        leaving: Option<(usize, Side)>,
        visit: &mut impl FnMut(f32, usize),
    ) -> Crossed {
        let side = leaving.map(|it| it.1);
        let mut any = false;
        let inside = self.shape.cross::<P>(ray, side, &mut |t| {
            any = true;
            visit(t, 0);
        });
        Crossed {
            inside: inside as u32,
            any,
        }
    }

    #[inline(always)]
    fn uv(&self, point: Vec3, _: usize) -> (f32, f32) {
        self.shape.uv(point)
    }

    #[inline]
    fn surface<P: Math>(&self, ray: &Ray, t: f32, _: usize) -> Option<(Vec3, &M)> {
        Some((self.shape.normal::<P>(ray, t), self.material))
    }
}

macro_rules! operator {
    ($(#[$doc:meta])* $name:ident, $join:expr, flips $flips:literal, empty $empty:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name<A, B>(
            /// The first leaves.
            pub A,
            /// And those after them.
            pub B,
        );

        impl<A, B> Expression for $name<A, B>
        where
            A: Expression,
            B: Expression<Material = A::Material>,
        {
            type Material = A::Material;
            const LEAVES: usize = A::LEAVES + B::LEAVES;
            const CROSSINGS: usize = A::CROSSINGS + B::CROSSINGS;

            #[inline(always)]
            fn leaves(&self) -> usize {
                self.0.leaves() + self.1.leaves()
            }

            #[inline(always)]
            fn contains(&self, leaves: u32) -> bool {
                let join: fn(bool, bool) -> bool = $join;
                let right = leaves.checked_shr(self.0.leaves() as u32).unwrap_or(0);
                join(self.0.contains(leaves), self.1.contains(right))
            }

            #[inline(always)]
            fn flips(&self, leaf: usize) -> bool {
                match leaf.checked_sub(self.0.leaves()) {
                    None => self.0.flips(leaf),
                    Some(leaf) => self.1.flips(leaf) != $flips,
                }
            }

            #[inline]
            fn cross<P: Math>(
                &self,
                ray: &Ray,
                leaving: Option<(usize, Side)>,
                visit: &mut impl FnMut(f32, usize),
            ) -> Crossed {
                let first = self.0.leaves();
                let left = leaving.filter(|it| it.0 < first);
                let left = self.0.cross::<P>(ray, left, visit);
                // Without the left there is nothing, all along the ray.
                if $empty && !left.any && !self.0.contains(left.inside) {
                    return left;
                }
                let right = match leaving {
                    Some((leaf, side)) => leaf.checked_sub(first).map(|leaf| (leaf, side)),
                    None => None,
                };
                let visit = &mut |t, leaf| visit(t, first + leaf);
                let right = self.1.cross::<P>(ray, right, visit);
                let above = right.inside.checked_shl(first as u32).unwrap_or(0);
                Crossed {
                    inside: left.inside | above,
                    any: left.any || right.any,
                }
            }

            #[inline(always)]
            fn uv(&self, point: Vec3, leaf: usize) -> (f32, f32) {
                match leaf.checked_sub(self.0.leaves()) {
                    None => self.0.uv(point, leaf),
                    Some(leaf) => self.1.uv(point, leaf),
                }
            }

            #[inline]
            fn surface<P: Math>(
                &self,
                ray: &Ray,
                t: f32,
                leaf: usize,
            ) -> Option<(Vec3, &A::Material)> {
                match leaf.checked_sub(self.0.leaves()) {
                    None => self.0.surface::<P>(ray, t, leaf),
                    Some(leaf) => self.1.surface::<P>(ray, t, leaf),
                }
            }
        }
    };
}

operator!(
    /// What is in either.
    Union,
    |a, b| a || b,
    flips false,
    empty false
);
operator!(
    /// What is in both. Rays that miss the left are not tested against the right: the smaller is better
    /// the left.
    Intersection,
    |a, b| a && b,
    flips false,
    empty true
);
operator!(
    /// What is in the left, but not in the right. Rays that miss the left are not tested against the
    /// right.
    Difference,
    |a, b| a && !b,
    flips true,
    empty true
);

/// The surface of a solid, of which a ray crosses the leaves `N` times at most: twice for a sphere or a box,
/// four times for a torus or a quadric, once for a plane. There are 32 leaves at most. An expression that
/// does not fit does not compile.
///
/// ```
/// use whitted::csg::{Csg, Difference};
/// use whitted::{Cuboid, Geometry, Material, Object, Ray, Sphere, Vec3};
///
/// static CLAY: Material = Material::matte(Vec3::new(0.8, 0.3, 0.2), 0.1, 0.9);
/// type Bowl = Difference<Object<'static, Cuboid>, Object<'static, Sphere>>;
/// static BOWL: Csg<Bowl, 4> = Csg(Difference(
///     Object { shape: Cuboid { min: Vec3::NEG_ONE, max: Vec3::ONE }, material: &CLAY },
///     Object { shape: Sphere { center: Vec3::Y, radius: 0.5 }, material: &CLAY },
/// ));
/// let hit = BOWL.closest_hit(&Ray::new(Vec3::Y * 3.0, Vec3::NEG_Y)).unwrap();
/// assert_eq!((hit.t, hit.normal, hit.object), (2.5, Vec3::Y, 1));
/// ```
///
/// ```compile_fail,E0080
/// use whitted::csg::{Csg, Union};
/// use whitted::{Geometry, Object, Ray, Sphere, Vec3};
///
/// let ball = Object { shape: Sphere { center: Vec3::ZERO, radius: 1.0 }, material: &() };
/// // A ray may cross the two four times.
/// let solid: Csg<_, 3> = Csg(Union(ball, ball));
/// solid.closest_hit(&Ray::new(Vec3::ZERO, Vec3::X));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Csg<E, const N: usize>(pub E);

/// A point where a ray crosses a leaf.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    t: f32,
    leaf: u8,
}

impl Crossing {
    /// Of its leaf.
    #[inline(always)]
    fn bit(self) -> u32 {
        1_u32.checked_shl(self.leaf.into()).unwrap_or(0)
    }
}

/// The side of the whole on a side of a leaf, and the other way round.
#[inline(always)]
fn turned(side: Side, flips: bool) -> Side {
    match (side, flips) {
        (Side::Outside, false) | (Side::Inside, true) => Side::Outside,
        (Side::Inside, false) | (Side::Outside, true) => Side::Inside,
    }
}

/// Over how much of the slack crossings may coincide, of rays along a face.
const FLATTEST: f32 = 4096.0;
/// The least cosine between two faces that are one: of 2.5 degrees.
const PARALLEL: f32 = 1023.0 / 1024.0;

impl<E: Expression, const N: usize> Csg<E, N> {
    /// The leaf's normal where the ray crosses it, and how steeply it does.
    #[inline]
    fn steepness<P: Math>(&self, ray: &Ray, crossing: Crossing) -> Option<(Vec3, f32)> {
        let (normal, _) = self.0.surface::<P>(ray, crossing.t, crossing.leaf.into())?;
        Some((normal, dot(&normal, &ray.direction).abs()))
    }

    /// Whether the ray crosses the face that it leaves once more: another leaf's, in the same place.
    #[inline]
    fn is_left<P: Math>(&self, ray: &Ray, crossing: Crossing, slack: f32) -> bool {
        let gap = crossing.t;
        gap <= slack * FLATTEST
            && self
                .steepness::<P>(ray, crossing)
                .is_some_and(|(_, cos)| gap * cos <= slack)
    }

    /// Whether two faces are the same where the ray crosses both.
    #[inline]
    fn coincide<P: Math>(&self, ray: &Ray, a: Crossing, b: Crossing, slack: f32) -> bool {
        let gap = b.t - a.t;
        // A leaf's own two ends are as far apart as its kernel says, and faces that meet in an edge are two.
        a.leaf != b.leaf
            && gap <= slack * FLATTEST
            && match (self.steepness::<P>(ray, a), self.steepness::<P>(ray, b)) {
                (Some((m, cos)), Some((n, _))) => {
                    dot(&m, &n).abs() > PARALLEL && gap * cos <= slack
                }
                _ => false,
            }
    }

    /// Calls `visit` with the distances at which the ray, without end, crosses the surface, in order, and
    /// the leaves that are met, and whether it enters; until it is true. The leaves that the ray then stays
    /// in for good, if that is inside of the whole: a bit each.
    #[inline]
    fn surfaces<P: Math>(
        &self,
        ray: &Ray,
        first: usize,
        mut visit: impl FnMut(f32, usize, bool) -> bool,
    ) -> u32 {
        const {
            assert!(E::LEAVES <= 32, "an expression has at most 32 leaves");
            assert!(
                E::CROSSINGS <= N,
                "a ray may cross this more often than its buffer holds"
            );
        };
        let ray = Ray {
            t_max: f32::INFINITY,
            ..*ray
        };
        let left = match ray.departure {
            Some(Departure { object, side }) => {
                let leaf = object.wrapping_sub(first);
                (leaf < self.0.leaves()).then(|| (leaf, turned(side, self.0.flips(leaf))))
            }
            None => None,
        };
        let mut crossings = Vec::<Crossing, N>::new();
        let ends = self.0.cross::<P>(&ray, left, &mut |t, leaf| {
            let leaf = leaf as u8;
            let fits = crossings.push(Crossing { t, leaf }).is_ok();
            debug_assert!(fits, "a ray crosses more often than it may");
            // To its place, behind equal ones.
            for at in (1..crossings.len()).rev() {
                match crossings.get_mut(at - 1..=at) {
                    Some([before, after]) if after.t < before.t => core::mem::swap(before, after),
                    _ => break,
                }
            }
        });
        // Every surface is crossed on the way from where the ray starts to where it ends.
        let mut inside = ends.inside;
        for crossing in &crossings {
            inside ^= crossing.bit();
        }
        let size = math::max_component(ray.origin.abs());
        let slack = |t: f32| SLACK * (size + t);
        let mut at = 0;
        if let Some((leaf, _)) = left {
            // Faces that coincide with the one that is left are left with it.
            while let Some(&it) = crossings.get(at)
                && usize::from(it.leaf) != leaf
                && self.is_left::<P>(&ray, it, slack(it.t))
            {
                inside ^= it.bit();
                at += 1;
            }
        }
        while let Some(&crossing) = crossings.get(at) {
            // All that coincide, each with the one before it.
            let (start, before, mut last) = (at, inside, crossing);
            inside ^= crossing.bit();
            at += 1;
            while let Some(&it) = crossings.get(at)
                && self.coincide::<P>(&ray, last, it, slack(it.t))
            {
                inside ^= it.bit();
                at += 1;
                last = it;
            }
            let enters = self.0.contains(inside);
            if self.0.contains(before) == enters {
                continue;
            }
            // Each leaf is in the expression once: where the whole is entered, a leaf is that counts, or is
            // left that is taken away.
            let alike = crossings.get(start..at).unwrap_or_default();
            let met = alike.iter().filter(|it| {
                let is_in = inside & it.bit() != 0;
                (before & it.bit() != 0) != is_in
                    && (is_in != self.0.flips(it.leaf.into())) == enters
            });
            if let Some(met) = met.min_by_key(|it| it.leaf)
                && visit(met.t, met.leaf.into(), enters)
            {
                return 0;
            }
        }
        if self.0.contains(inside) { inside } else { 0 }
    }
}

impl<E: Expression, const N: usize> Geometry for Csg<E, N> {
    type Material = E::Material;

    #[inline(always)]
    fn len(&self) -> usize {
        self.0.leaves()
    }

    #[inline]
    fn nearest<P: Math>(&self, ray: &mut Ray, first: usize, _: Candidates) -> Option<usize> {
        let mut nearest = None;
        self.surfaces::<P>(ray, first, |t, leaf, _| {
            nearest = Some((t, leaf));
            true
        });
        let (t, leaf) = nearest?;
        ray.t_max = ray.admitted(t)?;
        Some(first + leaf)
    }

    #[inline]
    fn surface<P: Math>(
        &self,
        ray: &Ray,
        t: f32,
        object: usize,
        first: usize,
    ) -> Option<(Vec3, &E::Material)> {
        let leaf = object.checked_sub(first)?;
        let (outward, material) = self.0.surface::<P>(ray, t, leaf)?;
        let normal = if self.0.flips(leaf) {
            -outward
        } else {
            outward
        };
        Some((normal, material))
    }

    #[inline]
    fn blocks<P: Math>(&self, ray: &Ray, first: usize, among: Candidates) -> bool {
        self.nearest::<P>(&mut { *ray }, first, among).is_some()
    }

    #[inline]
    fn absorbs<P: Math, L: Passage>(
        &self,
        ray: &Ray,
        first: usize,
        _: Candidates,
        light: &mut L,
    ) -> bool
    where
        E::Material: Finish,
    {
        let (mut ends, mut entry, mut entered) = (false, 0.0, None);
        let inside = self.surfaces::<P>(ray, first, |t, leaf, enters| {
            let is_beyond = t >= ray.t_max;
            // What a ray leaves tells what it went through.
            let inside = match enters {
                true => 0.0,
                false if is_beyond => ray.t_max - entry,
                false => t - entry,
            };
            (entry, entered) = (t, Some(leaf));
            if let Some((_, material)) = self.0.surface::<P>(ray, t, leaf) {
                let times = ray.admits(t) as u32;
                ends = light.pass(material.transmission(), times, || inside);
            }
            ends || is_beyond
        });
        // What has no end, a half-space, is not left: there it is what the ray entered by, or what it is in.
        let is_in = |leaf: &usize| inside >> leaf & 1 == 1 && !self.0.flips(*leaf);
        let held = || (0..self.0.leaves()).find(is_in);
        if inside != 0
            && let Some(leaf) = entered.or_else(held)
            && let Some((_, material)) = self.0.surface::<P>(ray, entry, leaf)
        {
            ends = light.pass(material.transmission(), 0, || ray.t_max - entry);
        }
        ends
    }

    #[inline]
    fn uv(&self, point: Vec3, object: usize, first: usize) -> (f32, f32) {
        self.0.uv(point, object.wrapping_sub(first))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Objects;
    use crate::math::Exact;
    use crate::random::vectors;
    use crate::ray::Hit;
    use crate::shape::cuboid::Cuboid;
    use crate::shape::plane::Plane;
    use crate::shape::quadric::{Ends, Quadric};
    use crate::shape::sphere::Sphere;
    use crate::shape::torus::Torus;

    type Leaf<S> = Object<'static, S, u8>;

    fn v(x: f32, y: f32, z: f32) -> Vec3 {
        Vec3::new(x, y, z)
    }

    const fn ball(center: Vec3, radius: f32) -> Leaf<Sphere> {
        Object {
            shape: Sphere { center, radius },
            material: &1,
        }
    }

    const fn die(min: Vec3, max: Vec3) -> Leaf<Cuboid> {
        Object {
            shape: Cuboid { min, max },
            material: &2,
        }
    }

    const UNIT: Leaf<Cuboid> = die(Vec3::NEG_ONE, Vec3::ONE);

    /// Distance, leaf, whether it is met from outside; and that all queries agree.
    fn meet<E: Expression<Material = u8>, const N: usize>(
        solid: &Csg<E, N>,
        ray: &Ray,
    ) -> Option<(f32, usize, bool)> {
        let hit = solid.closest_hit(ray);
        assert_eq!(solid.occluded(ray), hit.is_some());
        hit.map(|it| (it.t, it.object, it.front))
    }

    fn from<E: Expression<Material = u8>, const N: usize>(
        solid: Csg<E, N>,
        origin: Vec3,
        direction: Vec3,
    ) -> Option<(f32, usize, bool)> {
        meet(&solid, &Ray::new(origin, direction))
    }

    /// What a ray that goes straight on meets, up to eight times.
    fn all<E: Expression<Material = u8>, const N: usize>(
        solid: Csg<E, N>,
        origin: Vec3,
        direction: Vec3,
    ) -> ([usize; 8], usize) {
        let (mut ray, mut met, mut count) = (Ray::new(origin, direction), [99; 8], 0);
        while let Some(hit) = solid.closest_hit(&ray) {
            assert_eq!(hit.front, count % 2 == 0, "{met:?}");
            met[count] = hit.object;
            count += 1;
            ray = hit.through(direction);
        }
        (met, count)
    }

    #[test]
    fn each_operator_is_met_where_its_surface_is() {
        let (x, y) = (Vec3::X, Vec3::Y);
        let other = ball(v(1.0, 0.0, 0.0), 0.5);
        let (left, right) = (v(-5.0, 0.0, 0.0), v(5.0, 0.0, 0.0));
        let union = Csg::<_, 4>(Union(UNIT, other));
        let both = Csg::<_, 4>(Intersection(UNIT, other));
        let dent = Csg::<_, 4>(Difference(UNIT, other));
        let cases = [
            ("union, left", from(union, left, x), Some((4.0, 0, true))),
            ("union, right", from(union, right, -x), Some((3.5, 1, true))),
            (
                "union, inside",
                from(union, Vec3::ZERO, x),
                Some((1.5, 1, false)),
            ),
            ("union, missed", from(union, v(-5.0, 2.0, 0.0), x), None),
            ("both, left", from(both, left, x), Some((5.5, 1, true))),
            ("both, right", from(both, right, -x), Some((4.0, 0, true))),
            (
                "both, inside",
                from(both, v(0.75, 0.0, 0.0), x),
                Some((0.25, 0, false)),
            ),
            ("both, only the die", from(both, v(0.0, -5.0, 0.0), y), None),
            ("dent, left", from(dent, left, x), Some((4.0, 0, true))),
            ("dent, right", from(dent, right, -x), Some((4.5, 1, true))),
            (
                "dent, inside",
                from(dent, Vec3::ZERO, x),
                Some((0.5, 1, false)),
            ),
            (
                "dent, in the cavity",
                from(dent, v(0.9, 0.0, 0.0), -x),
                Some((0.4, 1, true)),
            ),
            (
                "dent, out of the cavity",
                from(dent, v(0.9, 0.0, 0.0), x),
                None,
            ),
            ("nowhere", from(dent, Vec3::NAN, x), None),
            ("no direction", from(dent, left, Vec3::NAN), None),
        ];
        for (name, met, expected) in cases {
            let near = |(t, leaf, front): (f32, usize, bool)| {
                let (at, of, from) = expected.unwrap_or((f32::NAN, 0, false));
                (t - at).abs() < 1e-6 && (leaf, front) == (of, from)
            };
            assert_eq!(met.is_some(), expected.is_some(), "{name}: {met:?}");
            assert!(met.is_none_or(near), "{name}: {met:?}");
        }
        let hit = dent.closest_hit(&Ray::new(right, -x)).unwrap();
        assert_eq!((hit.normal, *hit.material), (x, 1));
        let short = Ray {
            t_max: 4.5,
            ..Ray::new(right, -x)
        };
        assert_eq!(meet(&dent, &short), None);
    }

    #[test]
    fn all_faces_of_a_solid_are_met_in_order() {
        let (x, far) = (Vec3::X, v(-9.0, 0.0, 0.0));
        let ring = Object {
            shape: Torus::new(Vec3::ZERO, Vec3::Y, 2.0, 0.5).unwrap(),
            material: &3,
        };
        let half = Object {
            shape: Plane {
                point: Vec3::ZERO,
                normal: Vec3::X,
            },
            material: &4,
        };
        let rod = Quadric::cylinder(v(-4.0, 0.0, 0.0), v(4.0, 0.0, 0.0), 0.25, Ends::Closed);
        let rod = Object {
            shape: rod.unwrap(),
            material: &5,
        };
        assert_eq!(
            all(Csg::<_, 4>(ring), far, x),
            ([0, 0, 0, 0, 99, 99, 99, 99], 4)
        );
        let cut = Csg::<_, 5>(Intersection(ring, half));
        assert_eq!(all(cut, far, x), ([0, 0, 99, 99, 99, 99, 99, 99], 2));
        assert_eq!(all(cut, -far, -x).1, 2);
        let rest = Csg::<_, 5>(Difference(ring, half));
        assert_eq!(
            all(rest, far, x),
            all(cut, far, x),
            "only a plane's back is solid"
        );
        let skewer = Csg::<_, 8>(Union(ring, rod));
        assert_eq!(all(skewer, far, x), ([1, 1, 99, 99, 99, 99, 99, 99], 2));
        let bored = Csg::<_, 8>(Difference(ring, rod));
        assert_eq!(all(bored, far, x).1, 0);
        assert_eq!(all(bored, far + Vec3::Y * 0.375, x).1, 4);
        let cut_rod = Csg::<_, 5>(Difference(rod, half));
        assert_eq!(all(cut_rod, far, x), ([1, 0, 99, 99, 99, 99, 99, 99], 2));
        assert_eq!(from(cut_rod, Vec3::X * 9.0, -x), Some((5.0, 0, true)));
    }

    #[test]
    fn faces_that_coincide_follow_the_policy() {
        let right = die(v(1.0, -1.0, -1.0), v(3.0, 1.0, 1.0));
        let half = die(v(0.0, -1.0, -1.0), v(1.0, 1.0, 1.0));
        let (out, x) = (v(-5.0, 0.25, 0.125), Vec3::X);
        let none = ([99; 8], 0);
        // No wall where two touch.
        assert_eq!(
            all(Csg::<_, 4>(Union(UNIT, right)), out, x),
            ([0, 1, 99, 99, 99, 99, 99, 99], 2)
        );
        assert_eq!(all(Csg::<_, 4>(Intersection(UNIT, right)), out, x), none);
        assert_eq!(
            all(Csg::<_, 4>(Difference(UNIT, right)), out, x),
            ([0, 0, 99, 99, 99, 99, 99, 99], 2)
        );
        // No film where half is taken away, from any side.
        let rest = Csg::<_, 4>(Difference(UNIT, half));
        assert_eq!(all(rest, out, x), ([0, 1, 99, 99, 99, 99, 99, 99], 2));
        assert_eq!(
            all(rest, v(5.0, 0.25, 0.125), -x),
            ([1, 0, 99, 99, 99, 99, 99, 99], 2)
        );
        assert_eq!(all(rest, v(0.5, 5.0, 0.125), Vec3::NEG_Y), none);
        assert_eq!(all(rest, v(-0.5, 5.0, 0.125), Vec3::NEG_Y).1, 2);
        // The first of equal faces is met.
        assert_eq!(
            all(Csg::<_, 4>(Union(UNIT, UNIT)), out, x),
            ([0, 0, 99, 99, 99, 99, 99, 99], 2)
        );
        assert_eq!(all(Csg::<_, 4>(Intersection(UNIT, UNIT)), out, x).1, 2);
        assert_eq!(
            all(Csg::<_, 4>(Union(half, UNIT)), v(5.0, 0.25, 0.125), -x).0[0],
            0
        );
        // Where one leaf ends and the whole begins, what begins is met.
        let away = ball(v(0.0, 9.0, 0.0), 1.0);
        let handed = Csg::<_, 6>(Union(Intersection(UNIT, away), right));
        assert_eq!(all(handed, out, x).0[..2], [2, 2]);
        // Nothing is left of a thing without itself, or without more.
        let whole = die(Vec3::splat(-2.0), Vec3::splat(2.0));
        let mut vectors = vectors(5);
        for _ in 0..10_000 {
            let origin = vectors.next().unwrap() * 4.0;
            let direction = Exact::normalize(vectors.next().unwrap());
            let ray = Ray::new(origin, direction);
            assert_eq!(meet(&Csg::<_, 4>(Difference(UNIT, UNIT)), &ray), None);
            assert_eq!(meet(&Csg::<_, 4>(Difference(UNIT, whole)), &ray), None);
            let egg = ball(Vec3::X, 1.5);
            assert_eq!(meet(&Csg::<_, 4>(Difference(egg, egg)), &ray), None);
        }
    }

    #[test]
    fn solids_that_touch_meet_nowhere() {
        let (left, right) = (ball(v(-1.0, 0.0, 0.0), 1.0), ball(v(1.0, 0.0, 0.0), 1.0));
        let (out, x) = (v(-5.0, 0.0, 0.0), Vec3::X);
        assert_eq!(
            all(Csg::<_, 4>(Union(left, right)), out, x),
            ([0, 1, 99, 99, 99, 99, 99, 99], 2)
        );
        assert_eq!(all(Csg::<_, 4>(Intersection(left, right)), out, x).1, 0);
        assert_eq!(all(Csg::<_, 4>(Difference(left, right)), out, x).1, 2);
        // As without operators, a ray that touches a leaf meets it.
        let grazing = Ray::new(v(-5.0, 1.0, 0.0), x);
        let touched = meet(&Csg::<_, 4>(Union(left, right)), &grazing);
        assert_eq!(touched, Some((4.0, 0, true)));
        // A ray along a face of both, and in the plane where they touch.
        let pair = Csg::<_, 4>(Union(UNIT, die(v(-1.0, 1.0, -1.0), v(1.0, 2.0, 1.0))));
        assert_eq!(all(pair, v(-5.0, 1.0, 0.0), x).1, 2);
    }

    /// A cross of two planks whose tops lie in one plane, with a hole that ends where they do.
    type Planks = Difference<Union<Leaf<Cuboid>, Leaf<Cuboid>>, Leaf<Quadric>>;

    fn planks(scale: f32) -> Csg<Planks, 8> {
        let at = |x, y, z| v(x, y, z) * scale;
        let hole = Quadric::cylinder(
            at(0.0, -1.0, 0.0),
            at(0.0, 1.0, 0.0),
            0.5 * scale,
            Ends::Closed,
        );
        Csg(Difference(
            Union(
                die(at(-3.0, -1.0, -0.7), at(3.0, 1.0, 0.7)),
                die(at(-0.9, -1.0, -3.0), at(0.9, 1.0, 3.0)),
            ),
            Object {
                shape: hole.unwrap(),
                material: &3,
            },
        ))
    }

    /// By the planks' numbers: whether a point is inside.
    fn is_in_planks(p: Vec3) -> bool {
        let a = p.abs();
        let long = a.x < 3.0 && a.y < 1.0 && a.z < 0.7;
        let wide = a.x < 0.9 && a.y < 1.0 && a.z < 3.0;
        (long || wide) && p.x * p.x + p.z * p.z > 0.25
    }

    #[test]
    fn between_two_hits_a_ray_is_inside_or_outside() {
        let solid = planks(1.0);
        let mut vectors = vectors(5);
        let mut met = 0;
        for _ in 0..20_000 {
            let origin = vectors.next().unwrap() * 6.0;
            let direction = Exact::normalize(vectors.next().unwrap() * 2.0 - origin);
            let mut ray = Ray::new(origin, direction);
            let (mut from, mut inside) = (0.0, is_in_planks(origin));
            loop {
                let hit = solid.closest_hit(&ray);
                let to = hit.map_or(20.0, |it| from + it.t);
                for step in 1..20 {
                    let t = from + (to - from) * step as f32 / 20.0;
                    let near = (t - from).min(to - t);
                    let is_in = is_in_planks(origin + direction * t);
                    assert!(is_in == inside || near < 1e-4, "{origin} {direction} {t}");
                }
                let Some(hit) = hit else { break };
                assert_eq!(hit.front, !inside);
                met += 1;
                (from, inside, ray) = (to, !inside, hit.through(direction));
            }
        }
        assert!(met > 10_000, "{met}");
    }

    #[test]
    fn what_leaves_a_face_does_not_meet_one_that_coincides() {
        let solid = planks(1.0);
        let mut vectors = vectors(5);
        let (mut tops, mut holes) = (0, 0);
        for _ in 0..20_000 {
            let origin = vectors.next().unwrap() * 3.0 + Vec3::Y * 5.0;
            let aim = vectors.next().unwrap() * 0.9 + Vec3::Y;
            let Some(hit) = solid.closest_hit(&Ray::new(origin, Exact::normalize(aim - origin)))
            else {
                continue;
            };
            let away = vectors.next().unwrap();
            let up: Vec3 = Exact::normalize(v(away.x, away.y.abs() + 1e-3, away.z));
            if hit.normal == Vec3::Y {
                tops += 1;
                // Above the tops there is nothing, below is wood.
                assert_eq!(meet(&solid, &hit.back(up)), None);
                let below = solid.closest_hit(&hit.through(-up));
                assert!(
                    below.is_some_and(|it: Hit<'_, u8>| !it.front),
                    "{:?}",
                    hit.point
                );
            } else if hit.object == 2 {
                holes += 1;
                // In the hole: steeply up and down leads out of it.
                let [up, down] = [0.2, -0.2].map(|y| hit.normal * 0.01 + Vec3::Y * y);
                assert_eq!(meet(&solid, &hit.back(Exact::normalize(up))), None);
                assert_eq!(meet(&solid, &hit.back(Exact::normalize(down))), None);
                let wood = solid.closest_hit(&hit.through(-hit.normal)).unwrap();
                assert!(!wood.front);
            }
        }
        assert!(tops > 5_000 && holes > 500, "{tops} {holes}");
    }

    #[test]
    fn a_union_of_what_is_apart_has_the_bits_of_a_slice() {
        static BALLS: Objects<Sphere, u8> = &[ball(Vec3::X, 0.75), ball(Vec3::NEG_X, 0.5)];
        let solid = Csg::<_, 4>(Union(BALLS[0], BALLS[1]));
        let mut vectors = vectors(5);
        for _ in 0..20_000 {
            let origin = vectors.next().unwrap() * 4.0;
            let direction = Exact::normalize(vectors.next().unwrap() - origin);
            let ray = Ray::new(origin, direction);
            assert_eq!(solid.closest_hit(&ray), BALLS.closest_hit(&ray));
        }
    }

    #[test]
    fn bits_do_not_depend_on_the_scale() {
        let mut vectors = vectors(5);
        for _ in 0..1_000 {
            let origin = vectors.next().unwrap() * 6.0;
            let direction = Exact::normalize(vectors.next().unwrap() - origin);
            let expected = meet(&planks(1.0), &Ray::new(origin, direction));
            for exponent in [-40, -9, 23, 40] {
                let scale = libm::ldexpf(1.0, exponent);
                let met = meet(&planks(scale), &Ray::new(origin * scale, direction));
                assert_eq!(
                    met,
                    expected.map(|(t, leaf, front)| (t * scale, leaf, front))
                );
            }
        }
    }

    #[test]
    fn media_without_end_absorb_up_to_where_a_ray_ends() {
        use crate::material::{Absorbing, Material};
        use crate::math::{Attenuation, Transmittances};
        let water = |color| Material {
            color: Vec3::ONE,
            ambient: 0.0,
            diffuse: 0.0,
            highlight: (),
            reflection: (),
            transmission: Absorbing {
                tint: Vec3::ONE,
                ior: 1.0,
                absorption: color,
            },
        };
        let (red, green) = (water(Vec3::X), water(Vec3::Y));
        let below = |y: f32, material| Object {
            shape: Plane {
                point: Vec3::Y * y,
                normal: Vec3::Y,
            },
            material,
        };
        fn passed(solid: impl Geometry<Material: Finish>, from: f32, to: f32) -> Vec3 {
            let ray = Ray {
                t_max: (to - from).abs(),
                ..Ray::new(Vec3::Y * from, Vec3::Y * (to - from).signum())
            };
            let mut light = Transmittances::default();
            assert!(!solid.absorbs::<Exact, _>(&ray, 0, Candidates::ALL, &mut light));
            light.share()
        }
        let near = |a: Vec3, b: Vec3| assert!((a - b).abs().max_element() < 1e-6, "{a} {b}");
        let left = |x: f32, y: f32| v((-x).exp(), (-y).exp(), 1.0);
        // Down into it, up out of it, and to and fro in it.
        let sea = Csg::<_, 2>(Intersection(below(0.0, &red), below(1.0, &green)));
        near(passed(&sea, 2.0, -1.5), left(1.5, 0.0));
        near(passed(&sea, -1.5, 2.0), left(1.5, 0.0));
        near(passed(&sea, -1.0, -3.0), left(2.0, 0.0));
        near(passed(&sea, -3.0, -1.0), left(2.0, 0.0));
        near(passed(&sea, 3.0, 0.5), left(0.0, 0.0));
        // What is taken away has no share where no ray crosses its surface.
        let sea = Csg::<_, 2>(Difference(below(0.0, &red), below(-4.0, &green)));
        near(passed(&sea, -3.0, -1.0), left(2.0, 0.0));
        near(passed(&sea, -6.0, -5.0), left(0.0, 0.0));
    }

    #[test]
    fn glass_is_crossed_where_the_solid_ends() {
        use crate::material::{Glass, Material};
        let glass = Material {
            color: Vec3::ONE,
            ambient: 0.0,
            diffuse: 0.0,
            highlight: (),
            reflection: (),
            transmission: Glass {
                transmittance: 0.5,
                ior: 1.5,
            },
        };
        let at = |x: f32, radius| Object {
            shape: Sphere {
                center: Vec3::X * x,
                radius,
            },
            material: &glass,
        };
        let ray = Ray {
            t_max: 10.0,
            ..Ray::new(v(-5.0, 0.0, 0.0), Vec3::X)
        };
        let joined = Csg::<_, 4>(Union(at(0.0, 1.0), at(1.0, 1.0)));
        assert_eq!(joined.transmittance(&ray), 0.25);
        let shell = Csg::<_, 4>(Difference(at(0.0, 1.0), at(0.0, 0.5)));
        assert_eq!(shell.transmittance(&ray), 0.0625);
        let inside = Ray { t_max: 5.0, ..ray };
        assert_eq!(shell.transmittance(&inside), 0.25);
        // From the wall of the shell into the cavity, and from there into the wall.
        let entry = shell.closest_hit(&ray).unwrap();
        let cavity = shell.closest_hit(&entry.through(Vec3::X)).unwrap();
        assert_eq!(
            (cavity.object, cavity.front, cavity.normal),
            (1, false, Vec3::NEG_X)
        );
        let back = shell.closest_hit(&cavity.through(Vec3::X)).unwrap();
        assert_eq!((back.t, back.object, back.front), (1.0, 1, true));
        // A mirror in the cavity: to and fro, never out.
        let mirrored = shell.closest_hit(&back.back(Vec3::NEG_X)).unwrap();
        assert_eq!(
            (mirrored.t, mirrored.object, mirrored.front),
            (1.0, 1, true)
        );
    }
}
