//! Materials, with the terms that a scene uses.

use std::collections::BTreeSet;
use std::mem::size_of;
use std::sync::Arc;

use whitted::{Absorbing, Checker, Glass, Mirror, Object, Phong, Stripes, Tinted, Vec3};

use super::source::{WORD, number, vector};
use crate::paint::Paint;
use crate::scene::{Material, is_simple};
use crate::scene_file::texture::Texture;

/// The terms that the materials of the objects have.
#[derive(Default)]
pub struct Terms {
    shines: bool,
    has_real_exponents: bool,
    pub reflects: bool,
    pub transmits: bool,
    tints: bool,
    absorbs: bool,
    colors: BTreeSet<ColorKind>,
}

/// What colors can be in the source.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ColorKind {
    Plain,
    Checker,
    Stripes,
    Image { high: bool, blend: bool },
}

impl ColorKind {
    fn of(paint: &Paint) -> Self {
        match paint {
            Paint::Plain(_) => Self::Plain,
            Paint::Checker(_) => Self::Checker,
            Paint::Stripes(_) => Self::Stripes,
            Paint::Image { texture, blend, .. } => Self::Image {
                high: matches!(**texture, Texture::High(_)),
                blend: *blend,
            },
        }
    }

    /// Its type.
    fn source(self) -> &'static str {
        match self {
            Self::Plain => "Vec3",
            Self::Checker => "Checker",
            Self::Stripes => "Stripes",
            Self::Image { high, blend } => match (high, blend) {
                (false, false) => "ImageMap<'static, Texture<'static, Rgb888>, Nearest>",
                (false, true) => "ImageMap<'static, Texture<'static, Rgb888>, Bilinear>",
                (true, false) => "ImageMap<'static, HighColor<'static>, Nearest>",
                (true, true) => "ImageMap<'static, HighColor<'static>, Bilinear>",
            },
        }
    }

    /// As one of several.
    fn name(self) -> &'static str {
        match self {
            Self::Plain => "Plain",
            Self::Checker => "Checker",
            Self::Stripes => "Stripes",
            Self::Image { high, blend } => match (high, blend) {
                (false, false) => "Image",
                (false, true) => "BlendedImage",
                (true, false) => "HighImage",
                (true, true) => "BlendedHighImage",
            },
        }
    }

    /// What its source names of the `whitted` crate.
    fn imports(self) -> &'static [&'static str] {
        match self {
            Self::Plain => &[],
            Self::Checker => &["Checker"],
            Self::Stripes => &["Stripes"],
            Self::Image { high, blend } => match (high, blend) {
                (false, false) => &[
                    "ImageMap",
                    "columns::Texture",
                    "embedded_graphics::pixelcolor::Rgb888",
                    "pattern::Nearest",
                ],
                (false, true) => &[
                    "ImageMap",
                    "columns::Texture",
                    "embedded_graphics::pixelcolor::Rgb888",
                    "pattern::Bilinear",
                ],
                (true, false) => &[
                    "ImageMap",
                    "embedded_graphics::pixelcolor::Rgb565",
                    "pattern::HighColor",
                    "pattern::Nearest",
                ],
                (true, true) => &[
                    "ImageMap",
                    "embedded_graphics::pixelcolor::Rgb565",
                    "pattern::Bilinear",
                    "pattern::HighColor",
                ],
            },
        }
    }

    /// Where a pointer has 4.
    fn bytes(self) -> usize {
        match self {
            Self::Plain => size_of::<Vec3>(),
            Self::Checker => size_of::<Checker>(),
            Self::Stripes => size_of::<Stripes>(),
            Self::Image { .. } => WORD + 2 * size_of::<f32>(),
        }
    }
}

impl Terms {
    pub fn note<S>(&mut self, objects: &[Object<'_, S, Material>]) {
        for Object { material, .. } in objects {
            let highlight = &material.highlight;
            if highlight.specular > 0.0 {
                self.shines = true;
                self.has_real_exponents |= highlight.shininess as u32 as f32 != highlight.shininess;
            }
            self.reflects |= material.reflection.reflectance > 0.0;
            let Absorbing {
                tint, absorption, ..
            } = material.transmission;
            self.transmits |= tint.max_element() > 0.0;
            self.tints |= tint != Vec3::splat(tint.x);
            self.absorbs |= absorption != Vec3::ZERO;
            self.colors.insert(ColorKind::of(&material.color));
        }
    }

    pub fn highlight(&self) -> Option<&'static str> {
        match (self.shines, self.has_real_exponents) {
            (false, _) => None,
            (true, false) => Some("Phong"),
            (true, true) => Some("PhongReal"),
        }
    }

    pub fn reflection(&self) -> Option<&'static str> {
        self.reflects.then_some("Mirror")
    }

    pub fn transmission(&self) -> Option<&'static str> {
        let kind = match (self.absorbs, self.tints) {
            (true, _) => "Absorbing",
            (false, true) => "Tinted",
            (false, false) => "Glass",
        };
        self.transmits.then_some(kind)
    }

    /// What a waiting ray takes of the stack, as [`whitted::Tracer`] says: more where it has a color, and
    /// where it knows what it goes through.
    pub fn waiting_ray(&self) -> usize {
        match self.transmission() {
            Some("Absorbing") => 60,
            Some("Tinted") => 48,
            _ => 40,
        }
    }

    /// The type of colors, unless they are the same everywhere.
    fn color(&self) -> Option<&'static str> {
        let mut kinds = self.colors.iter();
        match (kinds.next(), kinds.next()) {
            (None | Some(ColorKind::Plain), None) => None,
            (Some(kind), None) => Some(kind.source()),
            _ => Some("Paint"),
        }
    }

    /// The terms and what colors are, as names of the `whitted` crate.
    pub fn imports(&self) -> impl Iterator<Item = &'static str> {
        let terms = [self.highlight(), self.reflection(), self.transmission()];
        let colors = self.colors.iter().flat_map(|it| it.imports());
        let several = if self.colors.len() > 1 {
            &["Varying", "pattern::Spot"][..]
        } else {
            &[]
        };
        let named = terms.into_iter().flatten().chain(colors.copied());
        named.chain(several.iter().copied())
    }

    /// The type of colors where there are several.
    pub fn paint(&self) -> Option<String> {
        if self.colors.len() < 2 {
            return None;
        }
        let each = |line: &dyn Fn(&ColorKind) -> String| {
            self.colors.iter().map(line).collect::<Vec<_>>().concat()
        };
        let variants = each(&|it| {
            let (name, kind) = (it.name(), it.source());
            format!("    /// Of some materials.\n    {name}({kind}),\n")
        });
        let mapped = each(&|it| {
            let name = it.name();
            match it {
                ColorKind::Image { .. } => format!("            Self::{name}(_) => true,\n"),
                _ => format!("            Self::{name}(_) => false,\n"),
            }
        });
        let seen = each(&|it| {
            let name = it.name();
            match it {
                ColorKind::Plain => format!("            Self::{name}(color) => *color,\n"),
                _ => format!("            Self::{name}(it) => it.at(spot),\n"),
            }
        });
        Some(format!(
            "\n/// What colors materials.\npub enum Paint {{\n{variants}}}\n\n\
             impl Varying for Paint {{\n    fn is_mapped(&self) -> bool {{\n        \
             match self {{\n{mapped}        }}\n    }}\n\n    \
             fn at(&self, spot: &Spot) -> Vec3 {{\n        match self {{\n{seen}        }}\n    \
             }}\n}}\n"
        ))
    }

    /// The material's type, without the terms at its end that nothing has.
    pub fn material(&self) -> String {
        let terms = [
            self.highlight(),
            self.reflection(),
            self.transmission(),
            self.color(),
        ];
        let count = 4 - terms.iter().rev().take_while(|it| it.is_none()).count();
        let named: Vec<_> = terms[..count].iter().map(|it| it.unwrap_or("()")).collect();
        match named[..] {
            [] => "Material".to_owned(),
            _ => format!("Material<{}>", named.join(", ")),
        }
    }

    /// Of one material.
    pub fn bytes(&self) -> usize {
        let mut bytes = size_of::<whitted::Material>();
        if self.shines {
            bytes += size_of::<Phong>();
        }
        if self.reflects {
            bytes += size_of::<Mirror>();
        }
        bytes += match self.transmission() {
            None => 0,
            Some("Glass") => size_of::<Glass>(),
            Some("Tinted") => size_of::<Tinted>(),
            Some(_) => size_of::<Absorbing>(),
        };
        let most = self.colors.iter().map(|it| it.bytes()).max();
        let tag = if self.colors.len() > 1 { WORD } else { 0 };
        bytes - size_of::<Vec3>() + most.unwrap_or(size_of::<Vec3>()) + tag
    }

    /// A material's source; `image` names its image, where it has one.
    pub fn source(
        &self,
        material: &Material,
        image: impl FnOnce(&Arc<Texture>) -> String,
    ) -> String {
        debug_assert!(self.color().is_some() || is_simple(material) || self.tints || self.absorbs);
        let kind = ColorKind::of(&material.color);
        let color = match &material.color {
            Paint::Plain(color) => vector(*color),
            Paint::Checker(Checker {
                colors: [a, b],
                size,
            }) => format!(
                "Checker {{ colors: [{}, {}], size: {} }}",
                vector(*a),
                vector(*b),
                number(*size)
            ),
            Paint::Stripes(Stripes {
                colors: [a, b],
                direction,
                size,
            }) => format!(
                "Stripes {{ colors: [{}, {}], direction: {}, size: {} }}",
                vector(*a),
                vector(*b),
                vector(*direction),
                number(*size)
            ),
            Paint::Image {
                texture,
                repeat: (across, along),
                blend,
            } => format!(
                "ImageMap {{ image: &{}, repeat: ({}, {}), filter: {} }}",
                image(texture),
                number(*across),
                number(*along),
                if *blend { "Bilinear" } else { "Nearest" }
            ),
        };
        let color = if self.colors.len() > 1 {
            format!("Paint::{}({color})", kind.name())
        } else {
            color
        };
        let highlight = match self.highlight() {
            None => "()".to_owned(),
            Some(kind) => {
                let specular = material.highlight.specular;
                // Nothing asks for the exponent of a highlight that is not there.
                let shininess = if specular > 0.0 {
                    material.highlight.shininess
                } else {
                    1.0
                };
                let shininess = match kind {
                    "Phong" => (shininess as u32).to_string(),
                    _ => number(shininess),
                };
                let specular = number(specular);
                format!("{kind} {{ specular: {specular}, shininess: {shininess} }}")
            }
        };
        let reflection = match self.reflection() {
            None => "()".to_owned(),
            Some(kind) => {
                let reflectance = number(material.reflection.reflectance);
                format!("{kind} {{ reflectance: {reflectance} }}")
            }
        };
        let transmission = match self.transmission() {
            None => "()".to_owned(),
            Some(kind) => {
                let Absorbing {
                    tint,
                    ior,
                    absorption,
                } = material.transmission;
                let ior = number(ior);
                match kind {
                    "Glass" => {
                        let transmittance = number(tint.x);
                        format!("Glass {{ transmittance: {transmittance}, ior: {ior} }}")
                    }
                    "Tinted" => format!("Tinted {{ tint: {}, ior: {ior} }}", vector(tint)),
                    _ => format!(
                        "Absorbing {{ tint: {}, ior: {ior}, absorption: {} }}",
                        vector(tint),
                        vector(absorption)
                    ),
                }
            }
        };
        format!(
            "Material {{ color: {color}, ambient: {}, diffuse: {}, highlight: {highlight}, reflection: \
             {reflection}, transmission: {transmission} }}",
            number(material.ambient),
            number(material.diffuse),
        )
    }
}
