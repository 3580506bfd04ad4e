//! A floor of two materials: a geometry of its own, made outside `core`.

use glam::Vec3;
use whitted::math::{Math, Passage};
use whitted::{Candidates, Finish, Geometry, Object, Plane, Ray, Shape};

/// A horizontal plane with square tiles of unit size, opaque.
pub struct Checkerboard<'a, M> {
    /// The plane, and the material of every other tile.
    pub tiles: [Object<'a, Plane, M>; 1],
    /// What the tiles between are made of.
    pub others: &'a M,
}

/// Whether a point lies on one of the other tiles. Beyond 1024 units from the origin all are alike.
fn is_other(point: Vec3) -> bool {
    const TO_POSITIVE: f32 = 1024.0;
    let (x, z) = (
        (point.x + TO_POSITIVE) as u32,
        (point.z + TO_POSITIVE) as u32,
    );
    (x ^ z) & 1 == 1
}

impl<M> Checkerboard<'_, M> {
    /// Where a ray meets the plane.
    #[inline(always)]
    fn meet<P: Math>(&self, ray: &Ray, first: usize) -> Option<f32> {
        let [tiles] = &self.tiles;
        let leaving = ray.leaves(first);
        tiles.shape.intersect::<P>(ray, &Plane::setup(ray), leaving)
    }
}

impl<M> Geometry for Checkerboard<'_, M> {
    type Material = M;

    #[inline(always)]
    fn len(&self) -> usize {
        1
    }

    #[inline(always)]
    fn nearest<P: Math>(&self, ray: &mut Ray, first: usize, among: Candidates) -> Option<usize> {
        let _ = among;
        ray.t_max = self.meet::<P>(ray, first)?;
        Some(first)
    }

    #[inline(always)]
    fn surface<P: Math>(
        &self,
        ray: &Ray,
        t: f32,
        object: usize,
        first: usize,
    ) -> Option<(Vec3, &M)> {
        let (normal, material) = self.tiles.as_slice().surface::<P>(ray, t, object, first)?;
        Some((
            normal,
            if is_other(ray.at(t)) {
                self.others
            } else {
                material
            },
        ))
    }

    #[inline(always)]
    fn blocks<P: Math>(&self, ray: &Ray, first: usize, among: Candidates) -> bool {
        let _ = among;
        self.meet::<P>(ray, first).is_some()
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
        M: Finish,
    {
        let _ = light;
        self.blocks::<P>(ray, first, among)
    }
}
