//! Colors of every kind, in one type.

use std::sync::Arc;

use whitted::pattern::{Bilinear, Filter, HighColor, Image, Nearest, Spot};
use whitted::{Checker, ImageMap, Stripes, Varying, Vec3, columns};

use crate::scene::{Units, color};
use crate::scene_file::texture::{Bitmap, HighBitmap, Texture};
use crate::scene_file::{self, Scale, direction};

/// A color, or what takes its place.
#[derive(Clone, Debug, PartialEq)]
pub enum Paint {
    /// The same everywhere.
    Plain(Vec3),
    /// As the ray caster has it.
    Checker(Checker),
    /// As the ray caster has it.
    Stripes(Stripes),
    /// An image.
    Image {
        /// Its pixels, which materials share.
        texture: Arc<Texture>,
        /// As [`ImageMap::repeat`].
        repeat: (f32, f32),
        /// Whether pixels are blended.
        blend: bool,
    },
}

impl Paint {
    /// What a file's material asks for.
    pub fn new(file: &scene_file::Material, scale: Scale) -> Self {
        use scene_file::Pattern;
        match &file.pattern {
            None => Self::Plain(color(file.color)),
            Some(Pattern::Checker { colors, size }) => Self::Checker(Checker {
                colors: colors.map(color),
                size: scale.length(*size),
            }),
            Some(Pattern::Stripes {
                colors,
                direction: across,
                size,
            }) => Self::Stripes(Stripes {
                colors: colors.map(color),
                direction: unit(direction(*across)),
                size: scale.length(*size),
            }),
            Some(Pattern::Image {
                texture,
                repeat,
                blend,
            }) => Self::Image {
                texture: Arc::clone(texture),
                repeat: (repeat[0] as f32, repeat[1] as f32),
                blend: *blend,
            },
        }
    }

    /// Repeats an image as often over lengths, which are cast at this scale.
    pub(crate) fn count_lengths(&mut self, units: Units, scale: Scale) {
        if let Self::Image { repeat: (u, v), .. } = self {
            let scaled = |copies: &mut f32| *copies = scale.per_length(f64::from(*copies));
            match units {
                Units::Shares => {}
                Units::Height => scaled(v),
                Units::Lengths => [u, v].into_iter().for_each(scaled),
            }
        }
    }

    /// The color, if it is the same everywhere.
    pub fn plain(&self) -> Option<Vec3> {
        match self {
            Self::Plain(color) => Some(*color),
            _ => None,
        }
    }

    /// All of it, as something to compare and to hash; of an image, which one it is.
    pub(crate) fn bits(&self) -> Vec<usize> {
        let colors = |[a, b]: [Vec3; 2]| [a.to_array(), b.to_array()].concat();
        let (mut bits, numbers) = match self {
            Self::Plain(color) => (vec![0], color.to_array().to_vec()),
            Self::Checker(it) => (vec![1], [colors(it.colors), vec![it.size]].concat()),
            Self::Stripes(it) => {
                let across = it.direction.to_array().to_vec();
                (vec![2], [colors(it.colors), across, vec![it.size]].concat())
            }
            Self::Image {
                texture,
                repeat: (across, along),
                blend,
            } => {
                let which = Arc::as_ptr(texture).addr();
                (vec![3, which, usize::from(*blend)], vec![*across, *along])
            }
        };
        bits.extend(numbers.iter().map(|it| it.to_bits() as usize));
        bits
    }
}

/// In f64, as the constructors of shapes do.
fn unit(v: Vec3) -> Vec3 {
    let [x, y, z] = v.to_array().map(f64::from);
    let length = libm::sqrt(x * x + y * y + z * z);
    Vec3::from_array([x, y, z].map(|it| (it / length) as f32))
}

/// What an image shows in one place.
fn shown(image: &impl Image, repeat: (f32, f32), blend: bool, spot: &Spot) -> Vec3 {
    fn by(image: &impl Image, repeat: (f32, f32), filter: impl Filter, spot: &Spot) -> Vec3 {
        let map = ImageMap {
            image,
            repeat,
            filter,
        };
        map.at(spot)
    }
    match blend {
        true => by(image, repeat, Bilinear, spot),
        false => by(image, repeat, Nearest, spot),
    }
}

impl Varying for Paint {
    fn is_mapped(&self) -> bool {
        matches!(self, Self::Image { .. })
    }

    fn at(&self, spot: &Spot) -> Vec3 {
        match self {
            Self::Plain(color) => *color,
            Self::Checker(it) => it.at(spot),
            Self::Stripes(it) => it.at(spot),
            Self::Image {
                texture,
                repeat,
                blend,
            } => match &**texture {
                Texture::Palette(Bitmap {
                    width,
                    height,
                    texels,
                    palette,
                }) => {
                    let image = columns::Texture {
                        width: *width,
                        height: *height,
                        texels,
                        palette,
                    };
                    shown(&image, *repeat, *blend, spot)
                }
                Texture::High(HighBitmap {
                    width,
                    height,
                    pixels,
                }) => {
                    let image = HighColor {
                        width: *width,
                        height: *height,
                        pixels,
                    };
                    shown(&image, *repeat, *blend, spot)
                }
            },
        }
    }
}
