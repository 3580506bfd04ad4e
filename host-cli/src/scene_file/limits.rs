//! How much a scene file may ask for, so that a small file cannot ask for a large machine.

use std::fmt;

use super::Problem;

/// Largest NFF file.
pub const NFF_BYTES: u64 = 256 << 20;
/// Largest TOML file: its parser keeps more per byte.
pub const TOML_BYTES: u64 = 16 << 20;
/// Most objects.
pub const OBJECTS: usize = 1 << 22;
/// Most leaves of a solid.
pub const LEAVES: usize = 32;
/// Most instances, those of instances counted.
pub const INSTANCES: usize = 1 << 16;
/// Most different materials.
pub const MATERIALS: usize = 1 << 20;
/// Most textures.
pub const TEXTURES: usize = 1 << 12;
/// Most pixels of all textures together.
pub const TEXELS: usize = 1 << 26;
/// Most lights.
pub const LIGHTS: usize = 1 << 12;
/// Most corners of a polygon.
pub const VERTICES: usize = 1 << 16;
/// Largest width, and largest height, of a picture.
pub const SIDE: u32 = 1 << 14;
/// Longest chain of rays.
pub const DEPTH: usize = 32;

/// What a number may be. Rounded to `f32`, it has to stay within.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Range {
    /// A coordinate or radius: any number that `f32` can hold.
    Length,
    /// The radius of a light: what `f32` can hold from 0 on.
    Radius,
    /// Brightness, of a light or colour: from 0 to 2^20, so that sums of products stay finite.
    Brightness,
    /// A share of what arrives: from 0 to 1.
    Share,
    /// A highlight's exponent: from 0 to 2^24, up to which `f32` has all whole numbers.
    Exponent,
    /// An index of refraction: from 1/16 to 16.
    Refraction,
    /// An angle between opposite edges of a picture, in degrees: above 0, below 180.
    Angle,
}

impl Range {
    /// The number, if it lies in the range; `what` names its field.
    pub(crate) fn check(self, what: &str, value: f64) -> Result<f64, Problem> {
        // As f32, because a number just inside may round to one outside. False for NaN.
        let rounded = value as f32;
        let admitted = match self {
            Self::Length => rounded.is_finite(),
            Self::Radius => (0.0..=f32::MAX).contains(&rounded),
            Self::Brightness => (0.0..=1_048_576.0).contains(&rounded),
            Self::Share => (0.0..=1.0).contains(&rounded),
            Self::Exponent => (0.0..=16_777_216.0).contains(&rounded),
            Self::Refraction => (0.0625..=16.0).contains(&rounded),
            Self::Angle => rounded > 0.0 && rounded < 180.0,
        };
        // A tiny negative share rounds to -0, which is in the range.
        let sign_kept = matches!(self, Self::Length) || value >= 0.0;
        if admitted && sign_kept {
            Ok(value)
        } else {
            Err(Problem::OutOfRange {
                what: what.to_owned(),
                value,
                range: self,
            })
        }
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Length => "not a finite 32-bit float",
            Self::Radius => "not a finite 32-bit float from 0 on",
            Self::Brightness => "not between 0 and 1048576",
            Self::Share => "not between 0 and 1",
            Self::Exponent => "not between 0 and 16777216",
            Self::Refraction => "not between 0.0625 and 16",
            Self::Angle => "not between 0 and 180 degrees",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_end_where_they_say() {
        use Range::*;
        let cases = [
            (Length, -3.4e38, true),
            (Length, 3.5e38, false),
            (Length, 1e-300, true),
            (Length, f64::NAN, false),
            (Length, f64::INFINITY, false),
            (Radius, 0.0, true),
            (Radius, -1e-300, false),
            (Radius, 3.5e38, false),
            (Radius, f64::NAN, false),
            (Brightness, 0.0, true),
            (Brightness, -1e-300, false),
            (Brightness, 1_048_576.0, true),
            (Brightness, 1_048_577.0, false),
            (Brightness, f64::NAN, false),
            (Share, 1.0, true),
            (Share, 1.001, false),
            (Share, -0.1, false),
            (Exponent, 100_000.0, true),
            (Exponent, -1.0, false),
            (Exponent, 1e8, false),
            (Refraction, 0.0, false),
            (Refraction, 1.5, true),
            (Refraction, 17.0, false),
            (Angle, 0.0, false),
            (Angle, 1e-60, false),
            (Angle, 45.0, true),
            (Angle, 180.0, false),
            (Angle, f64::NAN, false),
        ];
        for (range, value, admitted) in cases {
            assert_eq!(
                range.check("x", value).is_ok(),
                admitted,
                "{range:?} {value}"
            );
        }
    }
}
