//! Sets of objects, and the queries on them.
//!
//! A slice of one kind of object is a geometry, a pair of geometries is one, and so is a reference to
//! one. That is all a scene is made of; what its type does not name is not compiled.

use crate::candidates::{Beam, Candidates};
use crate::material::{AttenuationBy, Finish, ShareOf};
use crate::math::{self, Attenuation, Exact, Math, Passage, Weight, dot};
use crate::ray::{Departure, Hit, Ray, Side};
use crate::shape::Shape;
use glam::Vec3;

/// A shape and what it is made of.
#[derive(Debug, PartialEq)]
pub struct Object<'a, S, M = crate::material::Material> {
    /// The surface.
    pub shape: S,
    /// Its material; objects share it.
    pub material: &'a M,
}

impl<S: Clone, M> Clone for Object<'_, S, M> {
    fn clone(&self) -> Self {
        Self {
            shape: self.shape.clone(),
            material: self.material,
        }
    }
}

impl<S: Copy, M> Copy for Object<'_, S, M> {}

/// Objects of one kind, in flash: a leaf of a static scene.
pub type Objects<S, M = crate::material::Material> = &'static [Object<'static, S, M>];

/// Something that rays can be cast into.
///
/// [`closest_hit`](Self::closest_hit), [`occluded`](Self::occluded) and
/// [`transmittance`](Self::transmittance) are the queries; the methods before them are what a new
/// kind of geometry, say a hierarchy, implements. `first` is the place in the whole geometry at which
/// this part of it starts; objects are counted from there. `among` says which objects the ray may meet,
/// where that is known: all others are missed for sure, and need not be looked at.
pub trait Geometry {
    /// What all its objects are made of.
    type Material;

    /// How many objects there are.
    fn len(&self) -> usize;

    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Of some objects those that a ray of the beam may meet: all, by default. A part of a geometry takes
    /// out some of its own.
    #[inline(always)]
    fn candidates(&self, beam: &Beam, first: usize, among: Candidates) -> Candidates {
        let _ = (beam, first);
        among
    }

    /// The objects that a ray may meet which leaves a surface: all, by default.
    #[inline(always)]
    fn onward(&self, departure: Departure, first: usize) -> Candidates {
        let _ = (departure, first);
        Candidates::ALL
    }

    /// Finds the nearest point that the ray admits, makes its distance the ray's `t_max`, and tells
    /// which object it is. Of equally near ones the first, so a later one must be strictly nearer.
    fn nearest<P: Math>(&self, ray: &mut Ray, first: usize, among: Candidates) -> Option<usize>;

    /// The distance, to the bit, at which [`nearest`](Self::nearest) finds `object`, of which it is known
    /// that it does. By default it looks once more; who has the object at hand asks only that one.
    #[inline]
    fn distance<P: Math>(&self, ray: &Ray, object: usize, first: usize) -> Option<f32> {
        let mut nearest = *ray;
        let found = self.nearest::<P>(&mut nearest, first, Candidates::ALL)?;
        (found == object).then_some(nearest.t_max)
    }

    /// Unit normal of the outward side where [`nearest`](Self::nearest) found `object` at `t`, and the
    /// object's material; `None` where there is no such object.
    fn surface<P: Math>(
        &self,
        ray: &Ray,
        t: f32,
        object: usize,
        first: usize,
    ) -> Option<(Vec3, &Self::Material)>;

    /// Whether the ray admits any point of any object.
    fn blocks<P: Math>(&self, ray: &Ray, first: usize, among: Candidates) -> bool;

    /// Takes from `light` what each surface takes at each point that the ray admits, and what objects absorb
    /// between them; true as soon as nothing is left.
    fn absorbs<P: Math, L: Passage>(
        &self,
        ray: &Ray,
        first: usize,
        among: Candidates,
        light: &mut L,
    ) -> bool
    where
        Self::Material: Finish;

    /// As [`Shape::uv`] of an object; (0, 0), by default.
    #[inline]
    fn uv(&self, point: Vec3, object: usize, first: usize) -> (f32, f32) {
        let _ = (point, object, first);
        (0.0, 0.0)
    }

    /// The nearest hit in the ray's open interval, by the [`Exact`] policy.
    ///
    /// ```
    /// use whitted::{Geometry, Object, Ray, Sphere, Vec3};
    ///
    /// let balls = [Object { shape: Sphere { center: Vec3::ZERO, radius: 1.0 }, material: &() }];
    /// let hit = balls.as_slice().closest_hit(&Ray::new(Vec3::Z * 3.0, Vec3::NEG_Z)).unwrap();
    /// assert_eq!((hit.t, hit.normal, hit.front), (2.0, Vec3::Z, true));
    /// ```
    #[inline]
    fn closest_hit(&self, ray: &Ray) -> Option<Hit<'_, Self::Material>> {
        self.closest_hit_by::<Exact>(ray, Candidates::ALL)
    }

    /// [`closest_hit`](Self::closest_hit) by a policy of choice, of the candidates.
    #[inline]
    fn closest_hit_by<P: Math>(
        &self,
        ray: &Ray,
        among: Candidates,
    ) -> Option<Hit<'_, Self::Material>> {
        let mut nearest = *ray;
        let object = self.nearest::<P>(&mut nearest, 0, among)?;
        let t = nearest.t_max;
        let (outward, material) = self.surface::<P>(ray, t, object, 0)?;
        let front = math::decided(dot(&outward, &ray.direction) <= 0.0);
        Some(Hit {
            t,
            point: ray.at(t),
            normal: if front {
                outward
            } else {
                core::hint::cold_path();
                -outward
            },
            front,
            object,
            material,
        })
    }

    /// Whether anything, transparent or not, lies in the ray's open interval.
    #[inline]
    fn occluded(&self, ray: &Ray) -> bool {
        self.blocks::<Exact>(ray, 0, Candidates::ALL)
    }

    /// Share of light that passes along the ray, from 0 to 1: the product of the transmittance of all
    /// surfaces in its open interval, each as often as it is crossed, and of what is absorbed between them.
    /// Its bits do not depend on the order of the objects.
    #[inline]
    fn transmittance(&self, ray: &Ray) -> ShareOf<Self::Material>
    where
        Self::Material: Finish,
    {
        self.transmittance_by::<Exact>(ray, Candidates::ALL)
    }

    /// [`transmittance`](Self::transmittance) by a policy of choice, of the candidates.
    #[inline]
    fn transmittance_by<P: Math>(&self, ray: &Ray, among: Candidates) -> ShareOf<Self::Material>
    where
        Self::Material: Finish,
    {
        let mut light = AttenuationBy::<Self::Material>::default();
        if self.absorbs::<P, _>(ray, 0, among, &mut light) {
            Weight::splat(0.0)
        } else {
            light.share()
        }
    }
}

/// The address at which the object that the ray leaves would lie in this slice, and the side. It is in
/// the slice only if the object is one of these; addresses are what loops over a slice have at hand.
#[inline(always)]
fn departure<T>(objects: &[T], ray: &Ray, first: usize) -> (*const T, Side) {
    match ray.departure {
        Some(Departure { object, side }) => {
            let place = object.wrapping_sub(first);
            (math::forget(objects.as_ptr().wrapping_add(place)), side)
        }
        None => (math::forget(core::ptr::null()), Side::Outside),
    }
}

/// The side on which `object` is left, if it is the one.
#[inline(always)]
fn leaves<T>((left, side): (*const T, Side), object: &T) -> Option<Side> {
    core::ptr::eq(left, object).then_some(side)
}

/// [`Geometry::nearest`] for some objects of a slice.
#[inline(always)]
fn nearest_of<'o, 'm, S: Shape, M, P: Math>(
    all: &'o [Object<'m, S, M>],
    among: impl Iterator<Item = &'o Object<'m, S, M>>,
    ray: &mut Ray,
    first: usize,
) -> Option<usize> {
    let setup = S::setup(ray);
    let left = departure(all, ray, first);
    let mut nearest = None;
    for object in among {
        math::keep_rolled();
        let leaving = leaves(left, object);
        if let Some(t) = object.shape.intersect::<P>(ray, &setup, leaving) {
            ray.t_max = t;
            nearest = Some(object);
        }
    }
    Some(first + all.element_offset(nearest?)?)
}

/// [`Geometry::blocks`] for some objects of a slice.
#[inline(always)]
fn any_blocks<'o, 'm, S: Shape, M, P: Math>(
    all: &'o [Object<'m, S, M>],
    mut among: impl Iterator<Item = &'o Object<'m, S, M>>,
    ray: &Ray,
    first: usize,
) -> bool {
    let setup = S::setup(ray);
    let left = departure(all, ray, first);
    among.any(|object| {
        math::keep_rolled();
        let leaving = leaves(left, object);
        object.shape.intersect::<P>(ray, &setup, leaving).is_some()
    })
}

/// [`Geometry::absorbs`] for some objects of a slice.
#[inline(always)]
fn any_absorbs<'o, 'm, S: Shape, M: Finish, P: Math, L: Passage>(
    all: &'o [Object<'m, S, M>],
    mut among: impl Iterator<Item = &'o Object<'m, S, M>>,
    ray: &Ray,
    first: usize,
    light: &mut L,
) -> bool {
    let setup = S::setup(ray);
    let left = departure(all, ray, first);
    among.any(|object| {
        math::keep_rolled();
        let leaving = leaves(left, object);
        let times = object.shape.crossings::<P>(ray, &setup, leaving);
        let inside = || object.shape.inside::<P>(ray, &setup, leaving);
        light.pass(object.material.transmission(), times, inside)
    })
}

impl<S: Shape, M> Geometry for [Object<'_, S, M>] {
    type Material = M;

    #[inline(always)]
    fn len(&self) -> usize {
        <[Object<'_, S, M>]>::len(self)
    }

    #[inline]
    fn nearest<P: Math>(&self, ray: &mut Ray, first: usize, _: Candidates) -> Option<usize> {
        nearest_of::<_, _, P>(self, math::rolled(self), ray, first)
    }

    #[inline]
    fn distance<P: Math>(&self, ray: &Ray, object: usize, first: usize) -> Option<f32> {
        let shape = &self.get(object.wrapping_sub(first))?.shape;
        shape.intersect::<P>(ray, &S::setup(ray), ray.leaves(object))
    }

    #[inline]
    fn surface<P: Math>(
        &self,
        ray: &Ray,
        t: f32,
        object: usize,
        first: usize,
    ) -> Option<(Vec3, &M)> {
        let object = self.get(object.wrapping_sub(first))?;
        Some((object.shape.normal::<P>(ray, t), object.material))
    }

    #[inline(always)]
    fn uv(&self, point: Vec3, object: usize, first: usize) -> (f32, f32) {
        match self.get(object.wrapping_sub(first)) {
            Some(object) => object.shape.uv(point),
            None => (0.0, 0.0),
        }
    }

    #[inline]
    fn blocks<P: Math>(&self, ray: &Ray, first: usize, _: Candidates) -> bool {
        any_blocks::<_, _, P>(self, math::rolled(self), ray, first)
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
        M: Finish,
    {
        any_absorbs::<_, _, P, L>(self, self.iter(), ray, first, light)
    }
}

impl<A: Geometry, B: Geometry<Material = A::Material>> Geometry for (A, B) {
    type Material = A::Material;

    #[inline(always)]
    fn len(&self) -> usize {
        self.0.len() + self.1.len()
    }

    #[inline(always)]
    fn candidates(&self, beam: &Beam, first: usize, among: Candidates) -> Candidates {
        let among = self.0.candidates(beam, first, among);
        self.1.candidates(beam, first + self.0.len(), among)
    }

    #[inline(always)]
    fn onward(&self, departure: Departure, first: usize) -> Candidates {
        let right = first + self.0.len();
        if departure.object < right {
            self.0.onward(departure, first)
        } else {
            self.1.onward(departure, right)
        }
    }

    #[inline(always)]
    fn nearest<P: Math>(&self, ray: &mut Ray, first: usize, among: Candidates) -> Option<usize> {
        let left = self.0.nearest::<P>(ray, first, among);
        let right = self.1.nearest::<P>(ray, first + self.0.len(), among);
        right.or(left)
    }

    #[inline(always)]
    fn distance<P: Math>(&self, ray: &Ray, object: usize, first: usize) -> Option<f32> {
        let right = first + self.0.len();
        if object < right {
            self.0.distance::<P>(ray, object, first)
        } else {
            self.1.distance::<P>(ray, object, right)
        }
    }

    #[inline(always)]
    fn surface<P: Math>(
        &self,
        ray: &Ray,
        t: f32,
        object: usize,
        first: usize,
    ) -> Option<(Vec3, &A::Material)> {
        let right = first + self.0.len();
        if object < right {
            self.0.surface::<P>(ray, t, object, first)
        } else {
            self.1.surface::<P>(ray, t, object, right)
        }
    }

    #[inline(always)]
    fn uv(&self, point: Vec3, object: usize, first: usize) -> (f32, f32) {
        let right = first + self.0.len();
        if object < right {
            self.0.uv(point, object, first)
        } else {
            self.1.uv(point, object, right)
        }
    }

    #[inline(always)]
    fn blocks<P: Math>(&self, ray: &Ray, first: usize, among: Candidates) -> bool {
        self.0.blocks::<P>(ray, first, among)
            || self.1.blocks::<P>(ray, first + self.0.len(), among)
    }

    #[inline(always)]
    fn absorbs<P: Math, L: Passage>(
        &self,
        ray: &Ray,
        first: usize,
        among: Candidates,
        light: &mut L,
    ) -> bool
    where
        A::Material: Finish,
    {
        self.0.absorbs::<P, L>(ray, first, among, light)
            || self
                .1
                .absorbs::<P, L>(ray, first + self.0.len(), among, light)
    }
}

impl<G: Geometry + ?Sized> Geometry for &G {
    type Material = G::Material;

    #[inline(always)]
    fn len(&self) -> usize {
        (**self).len()
    }

    #[inline(always)]
    fn candidates(&self, beam: &Beam, first: usize, among: Candidates) -> Candidates {
        (**self).candidates(beam, first, among)
    }

    #[inline(always)]
    fn onward(&self, departure: Departure, first: usize) -> Candidates {
        (**self).onward(departure, first)
    }

    #[inline(always)]
    fn nearest<P: Math>(&self, ray: &mut Ray, first: usize, among: Candidates) -> Option<usize> {
        (**self).nearest::<P>(ray, first, among)
    }

    #[inline(always)]
    fn distance<P: Math>(&self, ray: &Ray, object: usize, first: usize) -> Option<f32> {
        (**self).distance::<P>(ray, object, first)
    }

    #[inline(always)]
    fn surface<P: Math>(
        &self,
        ray: &Ray,
        t: f32,
        object: usize,
        first: usize,
    ) -> Option<(Vec3, &G::Material)> {
        (**self).surface::<P>(ray, t, object, first)
    }

    #[inline(always)]
    fn uv(&self, point: Vec3, object: usize, first: usize) -> (f32, f32) {
        (**self).uv(point, object, first)
    }

    #[inline(always)]
    fn blocks<P: Math>(&self, ray: &Ray, first: usize, among: Candidates) -> bool {
        (**self).blocks::<P>(ray, first, among)
    }

    #[inline(always)]
    fn absorbs<P: Math, L: Passage>(
        &self,
        ray: &Ray,
        first: usize,
        among: Candidates,
        light: &mut L,
    ) -> bool
    where
        G::Material: Finish,
    {
        (**self).absorbs::<P, L>(ray, first, among, light)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Glass, Material};
    use crate::shape::plane::Plane;
    use crate::shape::sphere::Sphere;

    const RED: Material = Material::matte(Vec3::X, 0.0, 1.0);
    const BLUE: Material = Material::matte(Vec3::Z, 0.0, 1.0);

    fn ball(z: f32, material: &Material) -> Object<'_, Sphere> {
        let center = Vec3::new(0.0, 0.0, z);
        Object {
            shape: Sphere {
                center,
                radius: 1.0,
            },
            material,
        }
    }

    #[test]
    fn the_nearest_wins_and_of_equals_the_first() {
        let balls = [ball(-9.0, &RED), ball(-5.0, &BLUE), ball(-5.0, &RED)];
        let wall = [Object {
            shape: Plane {
                point: Vec3::NEG_Z * 4.0,
                normal: Vec3::Z,
            },
            material: &RED,
        }];
        let ray = Ray::new(Vec3::ZERO, Vec3::NEG_Z);
        let hit = balls.as_slice().closest_hit(&ray).unwrap();
        assert_eq!((hit.t, hit.object, hit.material), (4.0, 1, &BLUE));
        let pair = (balls.as_slice(), wall.as_slice());
        assert_eq!(
            pair.closest_hit(&ray).unwrap().object,
            1,
            "left of the pair first"
        );
        let pair = (wall.as_slice(), balls.as_slice());
        let hit = pair.closest_hit(&ray).unwrap();
        assert_eq!((hit.object, hit.material), (0, &RED));
        assert_eq!(pair.len(), 4);
    }

    #[test]
    fn places_count_across_pairs() {
        let (left, right) = ([ball(-5.0, &RED)], [ball(-20.0, &RED), ball(-9.0, &BLUE)]);
        let pair = (left.as_slice(), right.as_slice());
        let from_first = Ray {
            departure: Some(Departure {
                object: 0,
                side: Side::Outside,
            }),
            ..Ray::new(Vec3::new(0.0, 0.0, -6.0), Vec3::NEG_Z)
        };
        let hit = pair.closest_hit(&from_first).unwrap();
        assert_eq!((hit.t, hit.object), (2.0, 2));
        let from_last = hit.through(Vec3::NEG_Z);
        assert_eq!(
            pair.closest_hit(&from_last).unwrap().object,
            2,
            "met again from inside"
        );
        assert_eq!(pair.surface::<Exact>(&from_last, 1.0, 3, 0), None);
    }

    #[test]
    fn occluded_counts_glass_and_transmittance_weighs_it() {
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
        let opaque = Material {
            transmission: Glass {
                transmittance: 0.0,
                ..glass.transmission
            },
            ..glass
        };
        let at = |z, material| Object {
            shape: Sphere {
                center: Vec3::new(0.0, 0.0, z),
                radius: 1.0,
            },
            material,
        };
        let ray = Ray {
            t_max: 20.0,
            ..Ray::new(Vec3::ZERO, Vec3::NEG_Z)
        };
        let one = [at(-5.0, &glass)];
        assert!(one.as_slice().occluded(&ray));
        assert_eq!(one.as_slice().transmittance(&ray), 0.25);
        let short = Ray { t_max: 5.0, ..ray };
        assert_eq!(one.as_slice().transmittance(&short), 0.5);
        let two = [at(-5.0, &glass), at(-9.0, &opaque)];
        assert_eq!(two.as_slice().transmittance(&ray), 0.0);
        let beyond = [at(-25.0, &opaque)];
        assert!(!beyond.as_slice().occluded(&ray));
        assert_eq!(beyond.as_slice().transmittance(&ray), 1.0);
    }
}
