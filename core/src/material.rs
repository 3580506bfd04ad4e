//! What surfaces are made of.
//!
//! A material's type says what it can do: a scene whose materials have no [`Mirror`] and no
//! [`Glass`] links no secondary rays, one whose materials have no highlight links no power.

use glam::Vec3;

use crate::math::{Attenuation, Math, Transmittance, Transmittances, Weight, max_component};
use crate::pattern::Pattern;
use crate::ray::Side;

/// The terms of Phong's and Whitted's lighting model that a scene's materials share.
///
/// - `H`: `()` for no highlight, [`Phong`] or [`PhongReal`];
/// - `R`: `()` for no mirror, or [`Mirror`];
/// - `T`: `()` for opaque, [`Glass`], [`Tinted`] or [`Absorbing`];
/// - `C`: a color, or another [`Pattern`].
///
/// B. T. Phong, "Illumination for Computer Generated Pictures", CACM 18(6), 1975; T. Whitted, "An
/// Improved Illumination Model for Shaded Display", CACM 23(6), 1980.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material<H = (), R = (), T = (), C = Vec3> {
    /// Linear RGB, each from 0 to 1.
    pub color: C,
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

impl<C> Material<(), (), (), C> {
    /// A surface without highlight, mirror or transparency.
    pub const fn matte(color: C, ambient: f32, diffuse: f32) -> Self {
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

/// [`Glass`] that colors what passes its surface, also light on its way to what lies behind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tinted {
    /// As [`Glass::transmittance`], of each channel.
    pub tint: Vec3,
    /// As [`Glass::ior`].
    pub ior: f32,
}

/// [`Tinted`] glass that also weakens light on its way inside, by Beer's law.
///
/// A ray that leaves a surface into its inside travels there up to what it meets next; so does one that
/// leaves no surface, a camera's, and meets one from inside. Of a medium in another one light counts where
/// it travels in the inner one, and not from there to where it leaves the outer one. Shadow rays count all
/// that lies in a shape's [inside](crate::Shape::inside), also where shapes overlap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Absorbing {
    /// As [`Tinted::tint`].
    pub tint: Vec3,
    /// As [`Glass::ior`].
    pub ior: f32,
    /// How fast light of each channel weakens: `e^(-absorption·distance)` is left. One over a length in
    /// world units, at least 0.
    pub absorption: Vec3,
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
    /// What is left of light that passes.
    type Attenuation: Attenuation;
    /// What rays have to know of it while they are inside: `()`, or how it absorbs.
    type Medium: Medium;

    /// As [`Glass::transmittance`]; of the channels the greatest.
    fn transmittance(&self) -> f32;

    /// As [`Tinted::tint`].
    #[inline(always)]
    fn tint(&self) -> Vec3 {
        Vec3::splat(self.transmittance())
    }

    /// As [`Absorbing::absorption`].
    #[inline(always)]
    fn absorption(&self) -> Vec3 {
        Vec3::ZERO
    }

    /// As [`Glass::ior`].
    fn ior(&self) -> f32;
}

/// What a ray knows of what it is in.
pub trait Medium: Copy {
    /// Nothing that absorbs.
    const EMPTY: Self;

    /// What lies on a side of such a surface, as far as the surface tells.
    fn beyond(side: Side, surface: &impl Transmission) -> Self;

    /// Where nothing was known of it, what a surface tells that is met from that side.
    fn at_hit(self, side: Side, surface: &impl Transmission) -> Self;

    /// Weighs what arrives after a distance.
    fn weigh<W: Weight>(self, share: W, distance: f32) -> W;
}

impl Medium for () {
    const EMPTY: Self = ();

    #[inline(always)]
    fn beyond(_: Side, _: &impl Transmission) -> Self {}

    #[inline(always)]
    fn at_hit(self, _: Side, _: &impl Transmission) -> Self {}

    #[inline(always)]
    fn weigh<W: Weight>(self, share: W, _: f32) -> W {
        share
    }
}

impl Medium for Vec3 {
    const EMPTY: Self = Vec3::ZERO;

    #[inline(always)]
    fn beyond(side: Side, surface: &impl Transmission) -> Self {
        match side {
            Side::Inside => surface.absorption(),
            Side::Outside => Self::EMPTY,
        }
    }

    #[inline(always)]
    fn at_hit(self, side: Side, surface: &impl Transmission) -> Self {
        if self == Self::EMPTY {
            Self::beyond(side, surface)
        } else {
            self
        }
    }

    #[inline]
    fn weigh<W: Weight>(self, share: W, distance: f32) -> W {
        share * W::absorbed(self, distance)
    }
}

impl Transmission for () {
    const TRANSMITS: bool = false;
    type Attenuation = Transmittance;
    type Medium = ();

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
    type Attenuation = Transmittance;
    type Medium = ();

    #[inline(always)]
    fn transmittance(&self) -> f32 {
        self.transmittance
    }

    #[inline(always)]
    fn ior(&self) -> f32 {
        self.ior
    }
}

impl Transmission for Tinted {
    const TRANSMITS: bool = true;
    type Attenuation = Transmittances;
    type Medium = ();

    #[inline(always)]
    fn transmittance(&self) -> f32 {
        max_component(self.tint)
    }

    #[inline(always)]
    fn tint(&self) -> Vec3 {
        self.tint
    }

    #[inline(always)]
    fn ior(&self) -> f32 {
        self.ior
    }
}

impl Transmission for Absorbing {
    const TRANSMITS: bool = true;
    type Attenuation = Transmittances;
    type Medium = Vec3;

    #[inline(always)]
    fn transmittance(&self) -> f32 {
        max_component(self.tint)
    }

    #[inline(always)]
    fn tint(&self) -> Vec3 {
        self.tint
    }

    #[inline(always)]
    fn absorption(&self) -> Vec3 {
        self.absorption
    }

    #[inline(always)]
    fn ior(&self) -> f32 {
        self.ior
    }
}

/// What shadow rays gather on their way through objects of a material.
pub type AttenuationBy<M> = <<M as Finish>::Transmission as Transmission>::Attenuation;

/// What rays know of the inside of objects of a material.
pub type MediumOf<M> = <<M as Finish>::Transmission as Transmission>::Medium;

/// What weighs light that objects of a material let through.
pub type ShareOf<M> = <AttenuationBy<M> as Attenuation>::Share;

/// What tracing asks of a material. [`Material`] answers it; a firmware's own type may as well.
pub trait Finish {
    /// Its color.
    type Color: Pattern;
    /// Its highlight.
    type Highlight: Highlight;
    /// Its mirror.
    type Reflection: Reflection;
    /// Its transparency.
    type Transmission: Transmission;

    /// As [`Material::color`].
    fn color(&self) -> &Self::Color;
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

impl<H: Highlight, R: Reflection, T: Transmission, C: Pattern> Finish for Material<H, R, T, C> {
    type Color = C;
    type Highlight = H;
    type Reflection = R;
    type Transmission = T;

    #[inline(always)]
    fn color(&self) -> &C {
        &self.color
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
