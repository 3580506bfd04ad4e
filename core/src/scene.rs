//! Scenes and their lights.

use glam::Vec3;

use crate::candidates::Candidates;

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

/// A point that lights a scene, with no falloff by distance.
pub trait LightSource {
    /// In world space.
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
