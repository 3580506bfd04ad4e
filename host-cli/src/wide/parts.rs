//! The objects themselves, by their place in the geometry.

use whitted::material::Transmission;
use whitted::math::Passage;
use whitted::{
    Candidates, Cuboid, Finish, Frustum, Geometry, Math, Object, Patch, Plane, Polygon, Quadric,
    Ray, Shape, Side, Sphere, Torus, Triangle, Vec3,
};

use super::blocks::Kind;
use super::bounds::STEEP;
use super::frustum;

/// Objects of one kind.
pub type Slice<'a, S, M> = &'a [Object<'a, S, M>];

/// Objects of every kind, in the order that decides ties.
pub type Kinds<'a, M> = (
    Slice<'a, Sphere, M>,
    (
        Slice<'a, Plane, M>,
        (
            Slice<'a, Polygon<'a>, M>,
            (
                Slice<'a, Triangle, M>,
                (
                    Slice<'a, Patch, M>,
                    (
                        Slice<'a, Cuboid, M>,
                        (
                            Slice<'a, Frustum, M>,
                            (Slice<'a, Quadric, M>, Slice<'a, Torus, M>),
                        ),
                    ),
                ),
            ),
        ),
    ),
);

/// [`Kinds`] with names, and the place of each kind's first object.
#[derive(Debug)]
pub struct Parts<'a, M> {
    pub kinds: Kinds<'a, M>,
    pub spheres: Part<'a, Sphere, M>,
    pub planes: Part<'a, Plane, M>,
    pub polygons: Part<'a, Polygon<'a>, M>,
    pub triangles: Part<'a, Triangle, M>,
    pub patches: Part<'a, Patch, M>,
    pub cuboids: Part<'a, Cuboid, M>,
    pub frusta: Part<'a, Frustum, M>,
    pub quadrics: Part<'a, Quadric, M>,
    pub tori: Part<'a, Torus, M>,
}

/// Objects of one kind, and the place of the first.
#[derive(Debug)]
pub struct Part<'a, S, M> {
    pub objects: Slice<'a, S, M>,
    pub first: usize,
}

impl<S, M> Clone for Part<'_, S, M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<S, M> Copy for Part<'_, S, M> {}

impl<M> Clone for Parts<'_, M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<M> Copy for Parts<'_, M> {}

impl<'a, S, M> Part<'a, S, M> {
    /// The objects after `self`'s.
    fn then<T>(&self, objects: Slice<'a, T, M>) -> Part<'a, T, M> {
        Part {
            objects,
            first: self.first + self.objects.len(),
        }
    }

    fn holds(&self, object: usize) -> bool {
        (self.first..self.first + self.objects.len()).contains(&object)
    }

    /// The object at a place, if it is one of these.
    #[inline(always)]
    pub fn get(&self, object: usize) -> Option<&'a Object<'a, S, M>> {
        self.objects.get(object.wrapping_sub(self.first))
    }
}

/// Calls `$use` with the part that holds an object and the object.
macro_rules! with_object {
    ($parts:expr, $object:expr, |$shape:ident| $use:expr) => {{
        let (parts, place) = ($parts, $object);
        macro_rules! in_part {
            ($name:ident) => {
                if let Some($shape) = parts.$name.get(place) {
                    return $use;
                }
            };
        }
        in_part!(spheres);
        in_part!(polygons);
        in_part!(triangles);
        in_part!(patches);
        in_part!(cuboids);
        in_part!(frusta);
        in_part!(planes);
        in_part!(quadrics);
        in_part!(tori);
    }};
}

impl<'a, M> Parts<'a, M> {
    pub fn new(kinds: Kinds<'a, M>) -> Self {
        let (spheres, (planes, (polygons, (triangles, (patches, (cuboids, curved)))))) = kinds;
        let (frusta, (quadrics, tori)) = curved;
        let spheres = Part {
            objects: spheres,
            first: 0,
        };
        let planes = spheres.then(planes);
        let polygons = planes.then(polygons);
        let triangles = polygons.then(triangles);
        let patches = triangles.then(patches);
        let cuboids = patches.then(cuboids);
        let frusta = cuboids.then(frusta);
        let quadrics = frusta.then(quadrics);
        let tori = quadrics.then(tori);
        Self {
            kinds,
            spheres,
            planes,
            polygons,
            triangles,
            patches,
            cuboids,
            frusta,
            quadrics,
            tori,
        }
    }

    pub fn len(&self) -> usize {
        self.tori.first + self.tori.objects.len()
    }

    /// How much faster than along its axis the radius of any frustum grows, up to a limit.
    pub fn steepness(&self) -> f32 {
        let slopes = self.frusta.objects.iter().map(|it| it.shape.slope.abs());
        slopes.filter(|&it| it <= STEEP).fold(0.0, f32::max)
    }

    /// The vertices of a flat object and its normal; none for other objects.
    pub fn outline(&self, object: usize) -> (&'a [Vec3], Vec3) {
        if let Some(it) = self.triangles.get(object) {
            (&it.shape.vertices, it.shape.normal)
        } else if let Some(it) = self.patches.get(object) {
            (&it.shape.vertices, it.shape.normal)
        } else if let Some(it) = self.polygons.get(object) {
            (it.shape.vertices, it.shape.normal)
        } else {
            (&[], Vec3::ZERO)
        }
    }

    /// Whether no light goes through an object; also true for a transmittance that is no number.
    pub fn is_opaque(&self, object: usize) -> bool
    where
        M: Finish,
    {
        with_object!(self, object, |it| {
            !(it.material.transmission().transmittance() > 0.0)
        });
        true
    }

    /// Whether no light weakens in an object, however far it goes there.
    pub fn is_clear(&self, object: usize) -> bool
    where
        M: Finish,
    {
        with_object!(self, object, |it| {
            it.material.transmission().absorption() == Vec3::ZERO
        });
        true
    }

    /// Where the ray meets one of the objects; `first` is where they start in the geometry that the
    /// ray's departure counts by.
    pub fn intersect<P: Math>(&self, ray: &Ray, object: usize, first: usize) -> Option<f32> {
        with_object!(self, object, |it| meet::<_, _, P>(it, ray, first + object));
        None
    }

    /// A kind by whose kernel to cast many rays into an object that is in a block.
    pub fn kind(&self, object: usize) -> Kind {
        if self.spheres.holds(object) {
            Kind::Sphere
        } else if self.cuboids.holds(object) {
            Kind::Cuboid
        } else if self.frusta.holds(object) {
            Kind::Frustum
        } else if object >= self.quadrics.first {
            Kind::Other
        } else {
            Kind::Outline
        }
    }

    /// Whether an object is flat: no ray that leaves it meets it again, and none meets it twice.
    #[inline(always)]
    pub fn is_flat(&self, object: usize) -> bool {
        (self.planes.first..self.cuboids.first).contains(&object)
    }

    /// Whether a ray from this side of an object surely does not meet it again, as its kernel has it: the
    /// object is flat, it curves away, or its other surface is not visible from there.
    #[inline(always)]
    pub fn is_left_for_good(&self, object: usize, side: Side) -> bool {
        let outside = side == Side::Outside;
        if let Some(sphere) = self.spheres.get(object) {
            return outside == (sphere.shape.radius > 0.0);
        }
        if let Some(frustum) = self.frusta.get(object) {
            return outside == frustum::shows_outside(&frustum.shape);
        }
        self.is_flat(object) || outside && self.cuboids.holds(object)
    }

    /// As [`absorbs`](Self::absorbs), of an object that the ray meets.
    #[inline]
    pub fn absorbs_met<P: Math, L: Passage>(
        &self,
        ray: &Ray,
        object: usize,
        first: usize,
        light: &mut L,
    ) -> bool
    where
        M: Finish,
    {
        if self.is_flat(object) {
            self.absorbs_once(object, light)
        } else {
            self.absorbs::<P, L>(ray, object, first, light)
        }
    }

    /// As [`absorbs`](Self::absorbs), of an object whose surface the ray crosses once, and in which light does
    /// not weaken.
    #[inline]
    pub fn absorbs_once<L: Passage>(&self, object: usize, light: &mut L) -> bool
    where
        M: Finish,
    {
        with_object!(self, object, |it| {
            let transmission = it.material.transmission();
            light.pass(transmission, 1, || 0.0)
        });
        false
    }

    /// As [`Geometry::absorbs`] of one of the objects alone.
    pub fn absorbs<P: Math, L: Passage>(
        &self,
        ray: &Ray,
        object: usize,
        first: usize,
        light: &mut L,
    ) -> bool
    where
        M: Finish,
    {
        with_object!(self, object, |it| core::slice::from_ref(it)
            .absorbs::<P, L>(ray, first + object, Candidates::ALL, light));
        false
    }
}

fn meet<S: Shape, M, P: Math>(object: &Object<'_, S, M>, ray: &Ray, place: usize) -> Option<f32> {
    object
        .shape
        .intersect::<P>(ray, &S::setup(ray), ray.leaves(place))
}
