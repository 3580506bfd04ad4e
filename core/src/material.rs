//! What surfaces are made of.
//!
//! A material's type says what it can do: a scene whose materials have no [`Mirror`] and no
//! [`Glass`] links no secondary rays, one whose materials have no highlight links no power.

use glam::Vec3;

use crate::math::Math;

/// The terms of Phong's and Whitted's lighting model that a scene's materials share.
///
/// - `H`: `()` for no highlight, [`Phong`] or [`PhongReal`];
/// - `R`: `()` for no mirror, or [`Mirror`];
/// - `T`: `()` for opaque, or [`Glass`].
///
/// B. T. Phong, "Illumination for Computer Generated Pictures", CACM 18(6), 1975; T. Whitted, "An
/// Improved Illumination Model for Shaded Display", CACM 23(6), 1980.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material<H = (), R = (), T = ()> {
    /// Linear RGB, each from 0 to 1.
    pub color: Vec3,
    /// Share of the scene's ambient light that is given back, from 0 to 1.
    pub ambient: f32,
    /// Share of a light that is scattered evenly, from 0 to 1.
    pub diffuse: f32,
    /// The highlight that a light leaves.
    pub highlight: H,
    /// What is mirrored.
    pub reflection: R,
    /// What is let through.
    pub transmission: T,
}

impl Material {
    /// A surface without highlight, mirror or transparency.
    pub const fn matte(color: Vec3, ambient: f32, diffuse: f32) -> Self {
        Self {
            color,
            ambient,
            diffuse,
            highlight: (),
            reflection: (),
            transmission: (),
        }
    }
}

/// A highlight with a whole exponent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phong {
    /// Brightness at the highlight's centre, for a light of 1; at least 0.
    pub specular: f32,
    /// The exponent.
    pub shininess: u32,
}

/// A highlight with any exponent. Costs more than [`Phong`], and has the same bits where the
/// exponent is a whole number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhongReal {
    /// Brightness at the highlight's centre, for a light of 1; at least 0.
    pub specular: f32,
    /// The exponent, at least 0.
    pub shininess: f32,
}

/// A mirror.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror {
    /// Share of the light from the mirrored direction, from 0 to 1.
    pub reflectance: f32,
}

/// A clear medium behind the surface's outward side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glass {
    /// Share of the light that one crossing of the surface lets through, from 0 to 1.
    pub transmittance: f32,
    /// Index of refraction of what lies inside over that of what lies outside; above 0.
    pub ior: f32,
}

/// A highlight term of a [`Material`].
pub trait Highlight {
    /// Whether there is one.
    const SHINES: bool;

    /// No less than its brightness at this angle, at hardly any cost.
    fn peak(&self, cos: f32) -> f32;

    /// Its brightness where the mirrored view direction and the light's are `cos` apart.
    fn brightness<P: Math>(&self, cos: f32) -> f32;
}

impl Highlight for () {
    const SHINES: bool = false;

    #[inline(always)]
    fn peak(&self, _: f32) -> f32 {
        0.0
    }

    #[inline(always)]
    fn brightness<P: Math>(&self, _: f32) -> f32 {
        0.0
    }
}

impl Highlight for Phong {
    const SHINES: bool = true;

    #[inline(always)]
    fn peak(&self, cos: f32) -> f32 {
        if cos > 0.0 { self.specular } else { 0.0 }
    }

    #[inline]
    fn brightness<P: Math>(&self, cos: f32) -> f32 {
        // Also false for NaN. Where nothing shines, no power is taken.
        if cos > 0.0 && self.specular > 0.0 {
            self.specular * P::powi(cos, self.shininess)
        } else {
            0.0
        }
    }
}

impl Highlight for PhongReal {
    const SHINES: bool = true;

    #[inline(always)]
    fn peak(&self, cos: f32) -> f32 {
        if cos > 0.0 { self.specular } else { 0.0 }
    }

    #[inline]
    fn brightness<P: Math>(&self, cos: f32) -> f32 {
        if cos > 0.0 && self.specular > 0.0 {
            self.specular * P::powf(cos, self.shininess)
        } else {
            0.0
        }
    }
}

/// A mirror term of a [`Material`].
pub trait Reflection {
    /// Whether there is one.
    const REFLECTS: bool;

    /// As [`Mirror::reflectance`].
    fn reflectance(&self) -> f32;
}

impl Reflection for () {
    const REFLECTS: bool = false;

    #[inline(always)]
    fn reflectance(&self) -> f32 {
        0.0
    }
}

impl Reflection for Mirror {
    const REFLECTS: bool = true;

    #[inline(always)]
    fn reflectance(&self) -> f32 {
        self.reflectance
    }
}

/// A transparency term of a [`Material`].
pub trait Transmission {
    /// Whether there is one.
    const TRANSMITS: bool;

    /// As [`Glass::transmittance`].
    fn transmittance(&self) -> f32;

    /// As [`Glass::ior`].
    fn ior(&self) -> f32;
}

impl Transmission for () {
    const TRANSMITS: bool = false;

    #[inline(always)]
    fn transmittance(&self) -> f32 {
        0.0
    }

    #[inline(always)]
    fn ior(&self) -> f32 {
        1.0
    }
}

impl Transmission for Glass {
    const TRANSMITS: bool = true;

    #[inline(always)]
    fn transmittance(&self) -> f32 {
        self.transmittance
    }

    #[inline(always)]
    fn ior(&self) -> f32 {
        self.ior
    }
}

/// What tracing asks of a material. [`Material`] answers it; a firmware's own type may as well.
pub trait Finish {
    /// Its highlight.
    type Highlight: Highlight;
    /// Its mirror.
    type Reflection: Reflection;
    /// Its transparency.
    type Transmission: Transmission;

    /// As [`Material::color`].
    fn color(&self) -> Vec3;
    /// As [`Material::ambient`].
    fn ambient(&self) -> f32;
    /// As [`Material::diffuse`].
    fn diffuse(&self) -> f32;
    /// As [`Material::highlight`].
    fn highlight(&self) -> &Self::Highlight;
    /// As [`Material::reflection`].
    fn reflection(&self) -> &Self::Reflection;
    /// As [`Material::transmission`].
    fn transmission(&self) -> &Self::Transmission;
}

impl<H: Highlight, R: Reflection, T: Transmission> Finish for Material<H, R, T> {
    type Highlight = H;
    type Reflection = R;
    type Transmission = T;

    #[inline(always)]
    fn color(&self) -> Vec3 {
        self.color
    }

    #[inline(always)]
    fn ambient(&self) -> f32 {
        self.ambient
    }

    #[inline(always)]
    fn diffuse(&self) -> f32 {
        self.diffuse
    }

    #[inline(always)]
    fn highlight(&self) -> &H {
        &self.highlight
    }

    #[inline(always)]
    fn reflection(&self) -> &R {
        &self.reflection
    }

    #[inline(always)]
    fn transmission(&self) -> &T {
        &self.transmission
    }
}
