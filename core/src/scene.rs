//! Scenes and their lights.

use glam::Vec3;

use crate::candidates::Candidates;
use crate::math::Math;
use crate::ray::Ray;
pub use crate::subdivision::Quantity;

/// Everything that is lit and everything that lights it: plain data, so that it can be a `static`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scene<'a, G, L = Light> {
    /// The objects.
    pub geometry: G,
    /// The lights, all of one kind.
    pub lights: &'a [L],
    /// What a ray sees that meets nothing, mirrored and refracted rays too; linear RGB, at least 0.
    pub background: Vec3,
    /// Light that reaches every point alike; linear RGB, at least 0.
    pub ambient: Vec3,
}

/// Something that lights a scene, with no falloff by distance: a point, unless it says otherwise.
pub trait LightSource {
    /// Whether it is more than a point, so that [`share`](Self::share) says what of it arrives.
    const IS_AREA: bool = false;

    /// In world space; the middle, where it is no point.
    fn position(&self) -> Vec3;
    /// Linear RGB, at least 0.
    fn color(&self) -> Vec3;
    /// Whether objects block it. A constant here keeps shadow rays out of scenes without shadows.
    fn casts_shadows(&self) -> bool;

    /// The objects that may lie between the light and a point at `distance` from it, from where
    /// `direction`, unit length, leads to the light.
    #[inline(always)]
    fn candidates(&self, direction: Vec3, distance: f32) -> Candidates {
        let _ = (direction, distance);
        Candidates::ALL
    }

    /// Of what is more than a point the share that arrives at a point of a surface with this normal: the
    /// mean of what `passes` along rays to parts of it. `center` is the ray to its position.
    #[inline(always)]
    fn share<P: Math, V: Quantity>(
        &self,
        normal: Vec3,
        center: &Ray,
        mut passes: impl FnMut(&Ray) -> V,
    ) -> V {
        let _ = normal;
        passes(center)
    }
}

/// A point light that casts shadows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// In world space.
    pub position: Vec3,
    /// Linear RGB, at least 0.
    pub color: Vec3,
}

impl LightSource for Light {
    #[inline(always)]
    fn position(&self) -> Vec3 {
        self.position
    }

    #[inline(always)]
    fn color(&self) -> Vec3 {
        self.color
    }

    #[inline(always)]
    fn casts_shadows(&self) -> bool {
        true
    }
}

/// A point light that casts no shadows. A scene with no other lights links no shadow rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FillLight {
    /// In world space.
    pub position: Vec3,
    /// Linear RGB, at least 0.
    pub color: Vec3,
}

impl LightSource for FillLight {
    #[inline(always)]
    fn position(&self) -> Vec3 {
        self.position
    }

    #[inline(always)]
    fn color(&self) -> Vec3 {
        self.color
    }

    #[inline(always)]
    fn casts_shadows(&self) -> bool {
        false
    }
}
