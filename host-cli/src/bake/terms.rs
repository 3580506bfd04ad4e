//! Materials, with the terms that a scene uses.

use std::mem::size_of;

use whitted::{Glass, Mirror, Object, Phong};

use super::source::{number, vector};
use crate::scene::Material;

/// The terms that the materials of the objects have.
#[derive(Default)]
pub struct Terms {
    shines: bool,
    has_real_exponents: bool,
    pub reflects: bool,
    pub transmits: bool,
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
            self.transmits |= material.transmission.transmittance > 0.0;
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
        self.transmits.then_some("Glass")
    }

    /// The material's type, without the terms at its end that nothing has.
    pub fn material(&self) -> String {
        let terms = [self.highlight(), self.reflection(), self.transmission()];
        let count = 3 - terms.iter().rev().take_while(|it| it.is_none()).count();
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
        if self.transmits {
            bytes += size_of::<Glass>();
        }
        bytes
    }

    /// A material's source.
    pub fn source(&self, material: &Material) -> String {
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
                let Glass { transmittance, ior } = material.transmission;
                let (transmittance, ior) = (number(transmittance), number(ior));
                format!("{kind} {{ transmittance: {transmittance}, ior: {ior} }}")
            }
        };
        format!(
            "Material {{ color: {}, ambient: {}, diffuse: {}, highlight: {highlight}, reflection: \
             {reflection}, transmission: {transmission} }}",
            vector(material.color),
            number(material.ambient),
            number(material.diffuse),
        )
    }
}
