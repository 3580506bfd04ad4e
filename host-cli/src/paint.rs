//! Colors of every kind, in one type.

use std::sync::Arc;

use embedded_graphics::pixelcolor::{Rgb565, Rgb888};
use whitted::columns::Texture;
use whitted::pattern::{Bilinear, Filter, HighColor, Image, Nearest, Spot};
use whitted::{Checker, ImageMap, Stripes, Varying, Vec3};

use crate::scene::color;
use crate::scene_file::{self, Scale, direction, texture};

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
        /// Its pixels.
        sheet: Arc<Sheet>,
        /// As [`ImageMap::repeat`].
        repeat: (f32, f32),
        /// Whether pixels are blended.
        blend: bool,
    },
}

/// The pixels of an image, as firmware has them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Sheet {
    /// As [`Texture`].
    Palette {
        /// In pixels.
        width: u16,
        /// In pixels.
        height: u16,
        /// As [`Texture::texels`].
        texels: Vec<u8>,
        /// As [`Texture::palette`].
        palette: Vec<Rgb888>,
    },
    /// As [`HighColor`].
    High {
        /// In pixels.
        width: u16,
        /// In pixels.
        height: u16,
        /// As [`HighColor::pixels`].
        pixels: Vec<Rgb565>,
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
                sheet: Arc::new(Sheet::new(texture)),
                repeat: (repeat[0] as f32, repeat[1] as f32),
                blend: *blend,
            },
        }
    }

    /// The color, if it is the same everywhere.
    pub fn plain(&self) -> Option<Vec3> {
        match self {
            Self::Plain(color) => Some(*color),
            _ => None,
        }
    }

    /// All of it, as something to compare and to hash.
    pub(crate) fn bits(&self) -> Vec<u32> {
        let colors = |[a, b]: [Vec3; 2]| [a.to_array(), b.to_array()].concat();
        let (kind, numbers) = match self {
            Self::Plain(color) => (0, color.to_array().to_vec()),
            Self::Checker(it) => (1, [colors(it.colors), vec![it.size]].concat()),
            Self::Stripes(it) => {
                let across = it.direction.to_array().to_vec();
                (2, [colors(it.colors), across, vec![it.size]].concat())
            }
            Self::Image {
                sheet,
                repeat: (across, along),
                blend,
            } => {
                let mut bits = vec![3, u32::from(*blend), across.to_bits(), along.to_bits()];
                sheet.note(&mut bits);
                return bits;
            }
        };
        let bits = numbers.into_iter().map(f32::to_bits);
        std::iter::once(kind).chain(bits).collect()
    }
}

/// In f64, as the constructors of shapes do.
fn unit(v: Vec3) -> Vec3 {
    let [x, y, z] = v.to_array().map(f64::from);
    let length = libm::sqrt(x * x + y * y + z * z);
    Vec3::from_array([x, y, z].map(|it| (it / length) as f32))
}

impl Sheet {
    fn new(texture: &texture::Texture) -> Self {
        match texture {
            texture::Texture::Palette(it) => Self::Palette {
                width: it.width,
                height: it.height,
                texels: it.texels.clone(),
                palette: (it.palette.iter())
                    .map(|&[red, green, blue]| Rgb888::new(red, green, blue))
                    .collect(),
            },
            texture::Texture::High(it) => Self::High {
                width: it.width,
                height: it.height,
                pixels: it.pixels.clone(),
            },
        }
    }

    fn note(&self, bits: &mut Vec<u32>) {
        use embedded_graphics::pixelcolor::IntoStorage;
        match self {
            Self::Palette {
                width,
                height,
                texels,
                palette,
            } => {
                bits.extend([0, (*width).into(), (*height).into()]);
                bits.extend(texels.iter().map(|&it| u32::from(it)));
                bits.extend(palette.iter().map(|it| it.into_storage()));
            }
            Self::High {
                width,
                height,
                pixels,
            } => {
                bits.extend([1, (*width).into(), (*height).into()]);
                bits.extend(pixels.iter().map(|it| u32::from(it.into_storage())));
            }
        }
    }
}

/// What an image shows in one place.
fn shown(image: &impl Image, repeat: (f32, f32), filter: impl Filter, spot: &Spot) -> Vec3 {
    let map = ImageMap {
        image,
        repeat,
        filter,
    };
    map.at(spot)
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
            &Self::Image {
                ref sheet,
                repeat,
                blend,
            } => match **sheet {
                Sheet::Palette {
                    width,
                    height,
                    ref texels,
                    ref palette,
                } => {
                    let image = Texture {
                        width,
                        height,
                        texels,
                        palette,
                    };
                    match blend {
                        true => shown(&image, repeat, Bilinear, spot),
                        false => shown(&image, repeat, Nearest, spot),
                    }
                }
                Sheet::High {
                    width,
                    height,
                    ref pixels,
                } => {
                    let image = HighColor {
                        width,
                        height,
                        pixels,
                    };
                    match blend {
                        true => shown(&image, repeat, Bilinear, spot),
                        false => shown(&image, repeat, Nearest, spot),
                    }
                }
            },
        }
    }
}
