//! Lights that are no points.

use std::mem::size_of;

use glam::Vec3;
use whitted::AreaLight;
use whitted::area::{Disk, Outline, Rect, Samples};

use super::source::{number, vector};
use crate::scene::Light;

/// What the lights of a scene are, one of which is no point. The points among them are lights of the same
/// type that are looked at once, in the middle.
#[derive(Clone, Copy)]
pub enum Soft {
    Rects,
    Disks,
    Both,
}

impl Soft {
    pub fn of(lights: &[Light]) -> Option<Self> {
        let any = |wanted: fn(&Outline) -> bool| {
            let outlines = lights.iter().filter_map(|it| it.area.as_ref());
            outlines.map(|it| &it.0).any(wanted)
        };
        let rects = any(|it| matches!(it, Outline::Rect(_)));
        match (rects, any(|it| matches!(it, Outline::Disk(_)))) {
            (false, false) => None,
            (true, false) => Some(Self::Rects),
            (false, true) => Some(Self::Disks),
            (true, true) => Some(Self::Both),
        }
    }

    pub fn imports(self) -> &'static [&'static str] {
        match self {
            Self::Rects => &["area::Rect"],
            Self::Disks => &["area::Disk"],
            Self::Both => &["area::Disk", "area::Outline", "area::Rect"],
        }
    }

    /// The type, and its bytes.
    pub fn kind(self) -> (String, usize) {
        let (extent, size) = match self {
            Self::Rects => ("Rect", size_of::<AreaLight<Rect>>()),
            Self::Disks => ("Disk", size_of::<AreaLight<Disk>>()),
            Self::Both => ("Outline", size_of::<AreaLight<Outline>>()),
        };
        (format!("AreaLight<{extent}>"), size)
    }

    pub fn source(self, light: &Light) -> String {
        let none = (
            match self {
                Self::Rects => Outline::Rect(Rect {
                    edges: [Vec3::ZERO; 2],
                }),
                Self::Disks | Self::Both => Outline::Disk(Disk { radius: 0.0 }),
            },
            Samples { least: 0, most: 0 },
        );
        let (outline, Samples { least, most }) = light.area.unwrap_or(none);
        let extent = match outline {
            Outline::Rect(Rect { edges: [a, b] }) => {
                let extent = format!("Rect {{ edges: [{}, {}] }}", vector(a), vector(b));
                self.wrapped("Rect", extent)
            }
            Outline::Disk(Disk { radius }) => {
                let extent = format!("Disk {{ radius: {} }}", number(radius));
                self.wrapped("Disk", extent)
            }
        };
        let (position, color) = (vector(light.position), vector(light.color));
        format!(
            "AreaLight {{ position: {position}, color: {color}, extent: {extent}, samples: Samples {{ \
             least: {least}, most: {most} }} }}"
        )
    }

    fn wrapped(self, kind: &str, extent: String) -> String {
        match self {
            Self::Both => format!("Outline::{kind}({extent})"),
            Self::Rects | Self::Disks => extent,
        }
    }
}
