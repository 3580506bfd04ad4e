//! Geometries that are placed: moved, turned, scaled, mirrored, sheared; as often as a scene needs them.
//!
//! What is placed lies in flash once. A ray goes to the space of the object, at unit length, so that the
//! kernels in [`crate::shape`] are as exact there as anywhere, and the distance that they find goes back:
//! hit points, lights and colors stay in the world. So does what is said of
//! [departures](crate::Departure): objects count through all instances, and a placed sphere that a ray
//! leaves answers by its chord.
//!
//! An instance is a [`Geometry`], and so is a slice of them: instances of instances are written as types.
//!
//! # Accuracy
//!
//! A ray and what is reported of it lie off by about 4 u of the greatest coordinates in the object's
//! space, u = 2^-24, and by the kernels' error: in the world by as much times what the placement stretches.
//! The numbers of the inverse are rounded, each by u of itself.

use core::fmt;

use glam::Vec3;

use crate::candidates::Candidates;
use crate::geometry::Geometry;
use crate::material::Finish;
use crate::math::{self, Math, Passage, Scaled, dot, length_squared};
use crate::ray::Ray;

/// From an object's space to the world: an affine map that can be undone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Where the object's origin is, in world space.
    pub translation: Vec3,
    /// The rows of the matrix that takes directions of the world to the object's space.
    pub inverse: [Vec3; 3],
}

/// Why some numbers are not a [`Placement`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PlacementError {
    /// A number is not finite.
    NotFinite,
    /// The matrix cannot be undone: numbers that differ from its own by rounding to `f32` make one that is
    /// flat.
    Singular,
    /// The matrix, or its inverse, stretches by more than 2^62, all three axes together.
    Range,
}

impl fmt::Display for PlacementError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "the numbers of a placement must be finite",
            Self::Singular => "the matrix must not be flat: it cannot be undone",
            Self::Range => "the matrix must not stretch or shrink by more than 2^62",
        })
    }
}

impl core::error::Error for PlacementError {}

/// The greatest sum of the squares of a matrix, of its inverse too: its square is then in the range of
/// `f32`, whichever way a ray goes.
const MOST_SQUARES: f64 = (1_u128 << 124) as f64;

impl Placement {
    /// Leaves everything where it is.
    pub const IDENTITY: Self = Self {
        translation: Vec3::ZERO,
        inverse: [Vec3::X, Vec3::Y, Vec3::Z],
    };

    /// Takes the object's origin to `translation` and its axes to the vectors of `axes`, in order. In a
    /// `static`, an error is one of the build.
    ///
    /// ```
    /// use whitted::{Placement, PlacementError, Vec3};
    ///
    /// /// Twice as high, and 5 to the right.
    /// static TALL: Placement = match Placement::new([Vec3::X, Vec3::new(0.0, 2.0, 0.0), Vec3::Z], Vec3::new(5.0, 0.0, 0.0)) {
    ///     Ok(placement) => placement,
    ///     Err(_) => panic!("not a placement"),
    /// };
    /// assert_eq!(TALL.inverse[1], Vec3::Y * 0.5);
    /// let flat = Placement::new([Vec3::X, Vec3::Y, Vec3::ZERO], Vec3::ZERO);
    /// assert_eq!(flat, Err(PlacementError::Singular));
    /// ```
    ///
    /// # Errors
    ///
    /// Where a number is not finite, or the matrix is singular, nearly so or out of range; see
    /// [`PlacementError`].
    pub const fn new(axes: [Vec3; 3], translation: Vec3) -> Result<Self, PlacementError> {
        let [a, b, c] = axes;
        let [a, b, c] = [wide(a), wide(b), wide(c)];
        let t = wide(translation);
        // Sums that hold what is not finite are not zero times zero.
        if (sum(a) + sum(b) + sum(c) + sum(t)) * 0.0 != 0.0 {
            return Err(PlacementError::NotFinite);
        }
        // The rows of the inverse are these over the determinant. Products of two are exact.
        let rows = [cross(b, c), cross(c, a), cross(a, b)];
        let determinant = a[0] * rows[0][0] + a[1] * rows[0][1] + a[2] * rows[0][2];
        let (p, q, r) = (size(a), size(b), size(c));
        let most = p[0] * (q[1] * r[2] + q[2] * r[1])
            + p[1] * (q[2] * r[0] + q[0] * r[2])
            + p[2] * (q[0] * r[1] + q[1] * r[0]);
        // When each number changes by 2^-24 of itself, the determinant does by three times this.
        const ROUNDING: f64 = 4.0 / (1 << 24) as f64;
        // Also true for NaN.
        if !(determinant.abs() > ROUNDING * most) {
            return Err(PlacementError::Singular);
        }
        let inverse = [
            over(rows[0], determinant),
            over(rows[1], determinant),
            over(rows[2], determinant),
        ];
        let [x, y, z] = inverse;
        let squares = square(a) + square(b) + square(c);
        let inverse_squares = square(x) + square(y) + square(z);
        if !(squares <= MOST_SQUARES && inverse_squares <= MOST_SQUARES) {
            return Err(PlacementError::Range);
        }
        Ok(Self {
            translation,
            inverse: [narrow(x), narrow(y), narrow(z)],
        })
    }

    /// A direction of the world, in the object's space.
    #[inline]
    fn turned(&self, v: Vec3) -> Vec3 {
        let [x, y, z] = &self.inverse;
        Vec3::new(dot(x, &v), dot(y, &v), dot(z, &v))
    }

    /// The ray in the object's space.
    #[inline]
    pub(crate) fn local<P: Math>(&self, ray: &Ray) -> Local {
        let direction = self.turned(ray.direction);
        let recip = P::sqrt_and_recip(length_squared(&direction)).1;
        Local {
            ray: Ray {
                // The difference first, so that digits survive far from the world's origin.
                origin: self.turned(ray.origin - self.translation),
                direction: direction * recip,
                t_max: end(ray.t_max, recip),
                departure: ray.departure,
            },
            recip,
        }
    }

    /// A normal in the world, unit length, by the inverse transpose: of the outward side, also where the
    /// placement mirrors.
    #[inline]
    fn normal<P: Math>(&self, normal: Vec3) -> Vec3 {
        let [x, y, z] = self.inverse;
        P::normalize(x * normal.x + y * normal.y + z * normal.z)
    }
}

const fn wide(v: Vec3) -> [f64; 3] {
    [v.x as f64, v.y as f64, v.z as f64]
}

const fn narrow(v: [f64; 3]) -> Vec3 {
    Vec3::new(v[0] as f32, v[1] as f32, v[2] as f32)
}

const fn sum(v: [f64; 3]) -> f64 {
    v[0] + v[1] + v[2]
}

const fn size(v: [f64; 3]) -> [f64; 3] {
    [v[0].abs(), v[1].abs(), v[2].abs()]
}

const fn square(v: [f64; 3]) -> f64 {
    v[0] * v[0] + v[1] * v[1] + v[2] * v[2]
}

const fn over(v: [f64; 3], divisor: f64) -> [f64; 3] {
    [v[0] / divisor, v[1] / divisor, v[2] / divisor]
}

const fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The least distance in the object's space that is not before `t_max` in the world: so that a ray meets
/// the same there and here, to the bit.
#[inline]
fn end(t_max: f32, recip: f32) -> f32 {
    let mut end = t_max / recip;
    // The quotient and the product round once each: two steps at most, either way.
    for _ in 0..2 {
        let before = f32::from_bits(end.to_bits().wrapping_sub(1));
        // Also false for NaN.
        if before * recip >= t_max && before > 0.0 {
            end = before;
        }
    }
    for _ in 0..2 {
        if end * recip < t_max {
            end = f32::from_bits(end.to_bits().wrapping_add(1));
        }
    }
    end
}

/// A ray in an object's space.
pub(crate) struct Local {
    pub(crate) ray: Ray,
    /// A distance in the world over that in the object's space.
    pub(crate) recip: f32,
}

/// A geometry that is placed.
///
/// ```
/// use whitted::{Geometry, Instance, Material, Object, Placement, Ray, Sphere, Vec3};
///
/// static CLAY: Material = Material::matte(Vec3::new(0.8, 0.3, 0.2), 0.1, 0.9);
/// static BALL: [Object<Sphere>; 1] = [Object {
///     shape: Sphere { center: Vec3::ZERO, radius: 1.0 },
///     material: &CLAY,
/// }];
/// const fn lens(x: f32) -> Instance<'static, [Object<'static, Sphere>]> {
///     let axes = [Vec3::X, Vec3::Y, Vec3::new(0.0, 0.0, 0.25)];
///     match Placement::new(axes, Vec3::new(x, 0.0, 0.0)) {
///         Ok(placement) => Instance { geometry: &BALL, placement },
///         Err(_) => panic!("not a placement"),
///     }
/// }
/// static LENSES: [Instance<[Object<Sphere>]>; 2] = [lens(0.0), lens(3.0)];
/// let hit = LENSES.as_slice().closest_hit(&Ray::new(Vec3::new(3.0, 0.0, 2.0), Vec3::NEG_Z)).unwrap();
/// assert_eq!((hit.t, hit.normal, hit.object), (1.75, Vec3::Z, 1));
/// ```
#[derive(Debug, PartialEq)]
pub struct Instance<'a, G: ?Sized> {
    /// In its own space.
    pub geometry: &'a G,
    /// From there to the world.
    pub placement: Placement,
}

impl<G: ?Sized> Clone for Instance<'_, G> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<G: ?Sized> Copy for Instance<'_, G> {}

impl<'a, G: Geometry + ?Sized> Instance<'a, G> {
    /// As [`Geometry::surface`]; the material outlives the instance.
    #[inline]
    pub fn into_surface<P: Math>(
        self,
        ray: &Ray,
        object: usize,
        first: usize,
    ) -> Option<(Vec3, &'a G::Material)> {
        let Local { ray: local, .. } = self.placement.local::<P>(ray);
        // Shapes may tell by the bits of the distance what was met, and those cannot be had back from the
        // world's.
        let t = self.geometry.distance::<P>(&local, object, first)?;
        let (normal, material) = self.geometry.surface::<P>(&local, t, object, first)?;
        Some((self.placement.normal::<P>(normal), material))
    }
}

impl<G: Geometry + ?Sized> Geometry for Instance<'_, G> {
    type Material = G::Material;

    #[inline(always)]
    fn len(&self) -> usize {
        self.geometry.len()
    }

    #[inline]
    fn nearest<P: Math>(&self, ray: &mut Ray, first: usize, _: Candidates) -> Option<usize> {
        let Local {
            ray: mut local,
            recip,
        } = self.placement.local::<P>(ray);
        let all = Candidates::ALL;
        let object = self.geometry.nearest::<P>(&mut local, first, all)?;
        // What is nearer there is not farther here.
        ray.t_max = ray.admitted(local.t_max * recip)?;
        Some(object)
    }

    #[inline]
    fn distance<P: Math>(&self, ray: &Ray, object: usize, first: usize) -> Option<f32> {
        let Local { ray: local, recip } = self.placement.local::<P>(ray);
        let t = self.geometry.distance::<P>(&local, object, first)?;
        ray.admitted(t * recip)
    }

    #[inline]
    fn surface<P: Math>(
        &self,
        ray: &Ray,
        _: f32,
        object: usize,
        first: usize,
    ) -> Option<(Vec3, &G::Material)> {
        self.into_surface::<P>(ray, object, first)
    }

    #[inline]
    fn uv(&self, point: Vec3, object: usize, first: usize) -> (f32, f32) {
        let point = self.placement.turned(point - self.placement.translation);
        self.geometry.uv(point, object, first)
    }

    #[inline]
    fn blocks<P: Math>(&self, ray: &Ray, first: usize, _: Candidates) -> bool {
        let local = self.placement.local::<P>(ray).ray;
        self.geometry.blocks::<P>(&local, first, Candidates::ALL)
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
        G::Material: Finish,
    {
        let Local { ray: local, recip } = self.placement.local::<P>(ray);
        let mut light = Scaled {
            light,
            factor: recip,
        };
        let all = Candidates::ALL;
        self.geometry
            .absorbs::<P, _>(&local, first, all, &mut light)
    }
}

/// The one of some geometries, next to each other from `first` on, that holds an object, and its first
/// object.
#[inline]
fn holder<G: Geometry>(all: &[G], object: usize, mut first: usize) -> Option<(&G, usize)> {
    for geometry in all {
        let end = first + geometry.len();
        if object < end {
            return Some((geometry, first));
        }
        first = end;
    }
    None
}

impl<G: Geometry + ?Sized> Geometry for [Instance<'_, G>] {
    type Material = G::Material;

    #[inline]
    fn len(&self) -> usize {
        self.iter().map(Geometry::len).sum()
    }

    #[inline]
    fn nearest<P: Math>(&self, ray: &mut Ray, mut first: usize, _: Candidates) -> Option<usize> {
        let mut nearest = None;
        for instance in self {
            math::keep_rolled();
            let all = Candidates::ALL;
            nearest = instance.nearest::<P>(ray, first, all).or(nearest);
            first += instance.len();
        }
        nearest
    }

    #[inline]
    fn distance<P: Math>(&self, ray: &Ray, object: usize, first: usize) -> Option<f32> {
        let (instance, first) = holder(self, object, first)?;
        instance.distance::<P>(ray, object, first)
    }

    #[inline]
    fn surface<P: Math>(
        &self,
        ray: &Ray,
        t: f32,
        object: usize,
        first: usize,
    ) -> Option<(Vec3, &G::Material)> {
        let (instance, first) = holder(self, object, first)?;
        instance.surface::<P>(ray, t, object, first)
    }

    #[inline]
    fn uv(&self, point: Vec3, object: usize, first: usize) -> (f32, f32) {
        match holder(self, object, first) {
            Some((instance, first)) => instance.uv(point, object, first),
            None => (0.0, 0.0),
        }
    }

    #[inline]
    fn blocks<P: Math>(&self, ray: &Ray, mut first: usize, _: Candidates) -> bool {
        self.iter().any(|instance| {
            math::keep_rolled();
            let at = first;
            first += instance.len();
            instance.blocks::<P>(ray, at, Candidates::ALL)
        })
    }

    #[inline]
    fn absorbs<P: Math, L: Passage>(
        &self,
        ray: &Ray,
        mut first: usize,
        _: Candidates,
        light: &mut L,
    ) -> bool
    where
        G::Material: Finish,
    {
        self.iter().any(|instance| {
            math::keep_rolled();
            let at = first;
            first += instance.len();
            instance.absorbs::<P, L>(ray, at, Candidates::ALL, light)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Object;
    use crate::math::Exact;
    use crate::random::{numbers, vectors};
    use crate::ray::{Hit, Side};
    use crate::shape::cuboid::Cuboid;
    use crate::shape::sphere::Sphere;

    static BALL: &[Object<'static, Sphere, u8>] = &[Object {
        shape: Sphere {
            center: Vec3::ZERO,
            radius: 1.0,
        },
        material: &7,
    }];
    static DIE: &[Object<'static, Cuboid, u8>] = &[Object {
        shape: Cuboid {
            min: Vec3::NEG_ONE,
            max: Vec3::ONE,
        },
        material: &8,
    }];

    fn placed<G: ?Sized>(geometry: &G, axes: [Vec3; 3], translation: Vec3) -> Instance<'_, G> {
        Instance {
            geometry,
            placement: Placement::new(axes, translation).unwrap(),
        }
    }

    fn v(x: f32, y: f32, z: f32) -> Vec3 {
        Vec3::new(x, y, z)
    }

    /// What a hit is, and that all queries say the same.
    fn hit<G: Geometry<Material = u8> + ?Sized>(
        geometry: &G,
        origin: Vec3,
        direction: Vec3,
    ) -> Option<(f32, Vec3, usize)> {
        let ray = Ray::new(origin, direction);
        let found = geometry.closest_hit(&ray);
        assert_eq!(geometry.occluded(&ray), found.is_some());
        found.map(|it| (it.t, it.normal, it.object))
    }

    #[test]
    fn what_is_placed_is_met_in_the_world() {
        let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
        let far = v(0.0, 0.0, -5.0);
        let half = Exact::sqrt(0.5);
        let turned = [v(half, half, 0.0), v(-half, half, 0.0), z];
        let cases = [
            ("moved", [x, y, z], far, Vec3::ZERO, -z, Some((4.0, z))),
            (
                "grown",
                [x * 2.0, y * 2.0, z * 2.0],
                far,
                Vec3::ZERO,
                -z,
                Some((3.0, z)),
            ),
            (
                "flattened",
                [x, y, z * 0.5],
                far,
                Vec3::ZERO,
                -z,
                Some((4.5, z)),
            ),
            ("mirrored", [x, y, -z], far, Vec3::ZERO, -z, Some((4.0, z))),
            ("from inside", [x, y, -z], far, far, -z, Some((1.0, z))),
            (
                "swapped",
                [y, z * 4.0, x],
                far,
                Vec3::ZERO,
                -z,
                Some((1.0, z)),
            ),
            ("turned", turned, far, Vec3::ZERO, -z, Some((4.0, z))),
            ("beside", turned, far, v(1.5, 0.0, 0.0), -z, None),
            ("nowhere", [x, y, z], far, Vec3::NAN, -z, None),
            ("no direction", [x, y, z], far, Vec3::ZERO, Vec3::NAN, None),
        ];
        for (name, axes, place, origin, direction, expected) in cases {
            let found = hit(&placed(DIE, axes, place), origin, direction);
            assert_eq!(found.map(|it| (it.0, it.1)), expected, "{name}");
        }
        // The edge of a die that is turned by an eighth.
        let (t, ..) = hit(&placed(DIE, turned, Vec3::ZERO), x * 3.0, -x).unwrap();
        assert!((t - (3.0 - 2.0 * half)).abs() < 1e-6, "{t}");
        // (1, 1)/√2 of an ellipsoid twice as long as wide, by the gradient.
        let egg = placed(BALL, [x * 2.0, y, z], Vec3::ZERO);
        let (t, normal, _) = hit(&egg, v(2.0 * half, 5.0, 0.0), -y).unwrap();
        assert!((t - (5.0 - half)).abs() < 1e-6, "{t}");
        assert!(
            normal.distance(v(1.0, 2.0, 0.0).normalize()) < 1e-6,
            "{normal}"
        );
    }

    #[test]
    fn faces_are_told_apart_however_distances_round() {
        let mut vectors = vectors(1);
        let mut met = 0;
        for _ in 0..20_000 {
            let axes: [Vec3; 3] = core::array::from_fn(|_| vectors.next().unwrap() * 3.0);
            let Ok(placement) = Placement::new(axes, vectors.next().unwrap()) else {
                continue;
            };
            let [a, b, c] = axes.map(Vec3::normalize);
            if a.dot(b.cross(c)).abs() < 0.1 {
                continue;
            }
            let die = Instance {
                geometry: DIE,
                placement,
            };
            let origin = vectors.next().unwrap() * 20.0;
            let direction = Exact::normalize(vectors.next().unwrap() - origin * 0.1);
            let Some((t, normal, _)) = hit(&die, origin, direction) else {
                continue;
            };
            met += 1;
            // The normal of a face is across two of the axes, and a hit lies on the face's plane.
            let [a, b, c] = axes;
            let planes = [(b.cross(c), a), (c.cross(a), b), (a.cross(b), c)];
            let (_, out) = planes
                .into_iter()
                .max_by(|p, q| {
                    let along = |(n, _): &(Vec3, Vec3)| n.normalize().dot(normal).abs();
                    along(p).total_cmp(&along(q))
                })
                .unwrap();
            let from_center = origin + direction * t - placement.translation;
            let (height, face) = (from_center.dot(normal).abs(), out.dot(normal).abs());
            assert!((height - face).abs() < 1e-4, "{height} for {face}");
        }
        assert!(met > 1_000, "{met}");
    }

    #[test]
    fn a_ray_ends_there_where_it_ends_here() {
        let mut numbers = numbers(1);
        for _ in 0..100_000 {
            let [a, b] = core::array::from_fn(|_| numbers.next().unwrap().abs() + 1e-3);
            let (t_max, recip) = (a * 1e3, b * b);
            let end = end(t_max, recip);
            assert!(end * recip >= t_max, "{t_max} {recip}");
            let before = f32::from_bits(end.to_bits() - 1);
            assert!(before * recip < t_max, "{t_max} {recip}");
        }
        assert_eq!(end(f32::INFINITY, 0.5), f32::INFINITY);
        assert_eq!(end(0.0, 0.5), 0.0);
        assert!(end(f32::NAN, 0.5).is_nan());
    }

    #[test]
    fn of_equal_instances_the_first_wins() {
        let place = |at| placed(BALL, [v(0.3, 0.1, 0.0), Vec3::Y, Vec3::Z], at);
        let pair = [place(Vec3::X), place(Vec3::X), place(Vec3::ZERO)];
        let mut vectors = vectors(1);
        for _ in 0..10_000 {
            let origin = vectors.next().unwrap() * 9.0;
            let direction = Exact::normalize(vectors.next().unwrap() - origin);
            if let Some((.., object)) = hit(pair.as_slice(), origin, direction) {
                assert_ne!(object, 1);
            }
        }
        assert_eq!(Geometry::len(pair.as_slice()), 3);
    }

    #[test]
    fn instances_of_instances_count_through_and_compose() {
        let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
        let group = (BALL, DIE);
        let twice = [
            placed(&group, [x, y, z], x * 2.0),
            placed(&group, [x, y, z], x * -2.0),
        ];
        // Turned by a quarter round z: what was right is above.
        let four = [
            placed(twice.as_slice(), [y, -x, z], z * 9.0),
            placed(twice.as_slice(), [y * 2.0, -x * 2.0, z * 2.0], z * -9.0),
        ];
        let all = four.as_slice();
        assert_eq!(Geometry::len(all), 8);
        // The die that is round the ball comes first.
        assert_eq!(hit(all, v(0.0, 2.0, 0.0), z), Some((8.0, -z, 0)));
        assert_eq!(hit(all, v(0.5, -2.0, 0.0), z), Some((8.0, -z, 3)));
        assert_eq!(hit(all, v(1.5, 4.0, 0.0), -z), Some((7.0, z, 5)));
        let die = all.closest_hit(&Ray::new(v(1.5, 4.0, 0.0), -z)).unwrap();
        // The ball in the die, then its other side, then the die's.
        let mut at = die;
        for expected in [(4, true), (4, false), (5, false)] {
            at = all.closest_hit(&at.through(-z)).unwrap();
            assert_eq!((at.object, at.front), expected);
        }
        assert_eq!(all.surface::<Exact>(&Ray::new(x, y), 1.0, 8, 0), None);
    }

    #[test]
    fn what_leaves_a_placed_surface_does_not_meet_it_again() {
        let mut vectors = vectors(1);
        let (mut left, mut through) = (0, 0);
        for round in 0..20_000 {
            let size = [1.0, 1e-3, 1e3][round % 3];
            let axes: [Vec3; 3] = core::array::from_fn(|_| vectors.next().unwrap() * size);
            let Ok(placement) = Placement::new(axes, vectors.next().unwrap() * 10.0) else {
                continue;
            };
            let ball = Instance {
                geometry: BALL,
                placement,
            };
            let origin = vectors.next().unwrap() * 100.0;
            let aim = placement.translation + vectors.next().unwrap() * (0.2 * size);
            let direction = Exact::normalize(aim - origin);
            let Some(hit) = ball.closest_hit(&Ray::new(origin, direction)) else {
                continue;
            };
            if !hit.front {
                continue;
            }
            let away = vectors.next().unwrap();
            let away = Exact::normalize(away * away.dot(hit.normal).signum());
            left += 1;
            assert_eq!(ball.closest_hit(&hit.back(away)), None, "{axes:?}");
            assert!(!ball.occluded(&hit.back(away)));
            if let Some(exit) = ball.closest_hit(&hit.through(direction)) {
                through += 1;
                assert!(!exit.front);
                assert_eq!(exit.object, 0);
                let beyond: Option<Hit<'_, u8>> = ball.closest_hit(&exit.through(direction));
                assert_eq!(beyond, None);
                assert_eq!(exit.far_side(), Side::Outside);
            }
        }
        assert!(left > 10_000 && through > left / 2, "{left} {through}");
    }

    #[test]
    fn bits_do_not_depend_on_the_scale() {
        let axes = [v(0.7, 0.2, -0.1), v(0.1, -1.3, 0.4), v(-0.3, 0.2, 0.6)];
        let place = v(0.3, -0.2, -5.0);
        let mut vectors = vectors(1);
        for _ in 0..2_000 {
            let origin = vectors.next().unwrap() * 3.0;
            let direction = Exact::normalize(vectors.next().unwrap() + Vec3::NEG_Z * 3.0);
            let expected = hit(&placed(DIE, axes, place), origin, direction);
            for exponent in [-60, -40, -7, 13, 40, 60] {
                // Either what is placed grows, or the matrix does.
                let scale = libm::ldexpf(1.0, exponent);
                let grown = expected.map(|(t, normal, object)| (t * scale, normal, object));
                let by_matrix = placed(DIE, axes.map(|it| it * scale), place * scale);
                assert_eq!(hit(&by_matrix, origin * scale, direction), grown);
                let die = [Object {
                    shape: Cuboid {
                        min: Vec3::NEG_ONE * scale,
                        max: Vec3::ONE * scale,
                    },
                    material: &8,
                }];
                let by_shape = placed(die.as_slice(), axes, place * scale);
                assert_eq!(hit(&by_shape, origin * scale, direction), grown);
            }
        }
    }

    #[test]
    fn matrices_that_cannot_be_undone_are_refused() {
        use PlacementError::{NotFinite, Range, Singular};
        let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
        let grown = |exponent| libm::ldexpf(1.0, exponent);
        let cases = [
            ("zero", [Vec3::ZERO; 3], Vec3::ZERO, Err(Singular)),
            ("flat", [x, y, Vec3::ZERO], Vec3::ZERO, Err(Singular)),
            ("twice the same", [x, y, x], Vec3::ZERO, Err(Singular)),
            (
                "in one plane",
                [v(1.0, 4.0, 7.0), v(2.0, 5.0, 8.0), v(3.0, 6.0, 9.0)],
                Vec3::ZERO,
                Err(Singular),
            ),
            (
                "in one plane, but for rounding",
                [v(0.1, 0.2, 0.3), v(0.4, 0.5, 0.6), v(0.7, 0.8, 0.9)],
                Vec3::ZERO,
                Err(Singular),
            ),
            (
                "flat within rounding",
                [x, y, x + y + z * f32::EPSILON * 0.25],
                Vec3::ZERO,
                Ok(()),
            ),
            (
                "a slope within rounding",
                [v(1.0, 1.0, 0.0), v(1.0, 1.0 + f32::EPSILON, 0.0), z],
                Vec3::ZERO,
                Err(Singular),
            ),
            (
                "nearly flat",
                [v(1.0, 1.0, 0.0), v(1.0, 1.0 + 16.0 * f32::EPSILON, 0.0), z],
                Vec3::ZERO,
                Ok(()),
            ),
            (
                "large",
                [x * grown(60), y * grown(60), z * grown(60)],
                x,
                Ok(()),
            ),
            (
                "small",
                [x * grown(-60), y * grown(-60), z * grown(-60)],
                x,
                Ok(()),
            ),
            ("both", [x * grown(60), y, z * grown(-60)], x, Ok(())),
            ("too large", [x * grown(63), y, z], x, Err(Range)),
            ("too small", [x * grown(-63), y, z], x, Err(Range)),
            ("subnormal", [x * f32::from_bits(1), y, z], x, Err(Range)),
            (
                "greatest",
                [x * f32::MAX, y * f32::MAX, z * f32::MAX],
                x,
                Err(Range),
            ),
            (
                "infinite",
                [x * f32::INFINITY, y, z],
                Vec3::ZERO,
                Err(NotFinite),
            ),
            (
                "not a number",
                [x, Vec3::NAN, z],
                Vec3::ZERO,
                Err(NotFinite),
            ),
            ("nowhere", [x, y, z], Vec3::INFINITY, Err(NotFinite)),
        ];
        for (name, axes, translation, expected) in cases {
            let placement = Placement::new(axes, translation);
            assert_eq!(placement.map(|_| ()), expected, "{name}");
        }
        assert_eq!(
            Placement::new([x, y, z], Vec3::ZERO),
            Ok(Placement::IDENTITY)
        );
    }
}
