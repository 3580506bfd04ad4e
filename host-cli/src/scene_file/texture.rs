//! Textures: pictures for walls, sprites and other surfaces.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use ::toml::Spanned;
use embedded_graphics::pixelcolor::{Rgb565, Rgb888, RgbColor};
use serde::Deserialize;

use super::limits::{self, Range};
use super::toml::{Checker, Point, too_many};
use super::{Located, Problem};
use crate::picture::Picture;
use crate::scene_file::error::excerpt;

/// A picture with a palette, in the bytes of a display.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bitmap {
    /// In pixels.
    pub width: u16,
    /// In pixels.
    pub height: u16,
    /// Column after column, each from the top: places in the palette, beyond it what is transparent.
    pub texels: Vec<u8>,
    /// Red, green, blue.
    pub palette: Vec<[u8; 3]>,
}

/// A picture without a palette, in 16 bits a pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HighBitmap {
    /// In pixels.
    pub width: u16,
    /// In pixels.
    pub height: u16,
    /// Row after row from the top.
    pub pixels: Vec<Rgb565>,
}

/// A picture to be laid over surfaces.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Texture {
    /// Of few colors.
    Palette(Bitmap),
    /// Of many.
    High(HighBitmap),
}

/// Most pixels along one side of a texture.
pub(super) const TEXTURE_SIDE: usize = 1024;
/// Most colors of a texture: one byte's value is left for what is transparent.
pub(super) const COLORS: usize = 255;
/// What a texel is that is transparent.
pub(super) const CLEAR: u8 = 255;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TextureFields {
    file: Option<Spanned<String>>,
    rows: Option<Spanned<Vec<Spanned<String>>>>,
    #[serde(default)]
    colors: HashMap<Spanned<String>, Point>,
}

/// A table by name, in the order of the file.
pub(super) fn in_order<T>(table: &HashMap<Spanned<String>, T>) -> Vec<(&Spanned<String>, &T)> {
    let mut entries: Vec<_> = table.iter().collect();
    entries.sort_by_key(|(name, _)| name.span().start);
    entries
}

/// All textures of a file by name, in its order. Takes their pixels from those that the file may have.
pub(super) fn read_all<'a>(
    table: &'a HashMap<Spanned<String>, TextureFields>,
    check: &Checker<'_>,
    folder: &Path,
    allowed: &mut usize,
) -> Result<Vec<(&'a str, Arc<Texture>)>, Located> {
    let mut textures = Vec::new();
    for (name, fields) in in_order(table) {
        if textures.len() == limits::TEXTURES {
            return Err((check.start(name), too_many("textures", limits::TEXTURES)));
        }
        let texture = fields.read(check, folder, name, allowed)?;
        textures.push((name.get_ref().as_str(), Arc::new(texture)));
    }
    Ok(textures)
}

/// A texture's pixels, `None` where they are transparent, and their number.
struct Pixels<'a> {
    width: usize,
    height: usize,
    at: Box<dyn Fn(usize, usize) -> Option<[u8; 3]> + 'a>,
}

impl TextureFields {
    /// What is to be laid over surfaces, black where it is transparent, or what a sprite shows. Takes its
    /// pixels from those that the file may have.
    pub(super) fn read(
        &self,
        check: &Checker<'_>,
        folder: &Path,
        name: &Spanned<String>,
        allowed: &mut usize,
    ) -> Result<Texture, Located> {
        let pixels = self.pixels(check, folder, name, allowed)?;
        Ok(match Bitmap::new(&pixels) {
            Some(bitmap) => Texture::Palette(bitmap),
            None => Texture::High(HighBitmap::new(&pixels)),
        })
    }

    fn pixels(
        &self,
        check: &Checker<'_>,
        folder: &Path,
        name: &Spanned<String>,
        allowed: &mut usize,
    ) -> Result<Pixels<'static>, Located> {
        let (place, pixels) = match (&self.file, &self.rows) {
            (Some(file), None) => (check.start(file), Self::of_file(check, folder, file)?),
            (None, Some(rows)) => (check.start(rows), self.of_rows(check, rows)?),
            _ => {
                let problem = "a texture has either `file` or `rows`";
                return Err((check.start(name), Problem::Contradiction(problem)));
            }
        };
        if pixels.width.max(pixels.height) > TEXTURE_SIDE {
            return Err((
                place,
                too_many("pixels to a side of a texture", TEXTURE_SIDE),
            ));
        }
        take(allowed, pixels.width * pixels.height).map_err(|problem| (place, problem))?;
        Ok(pixels)
    }

    fn of_file(
        check: &Checker<'_>,
        folder: &Path,
        file: &Spanned<String>,
    ) -> Result<Pixels<'static>, Located> {
        let place = check.start(file);
        let picture = Picture::read(&folder.join(file.get_ref())).map_err(|error| {
            let file = excerpt(file.get_ref().as_bytes());
            let reason = error.to_string();
            (place, Problem::Texture { file, reason })
        })?;
        let Picture {
            width,
            height,
            channels,
            max,
            samples,
        } = picture;
        let to_byte = move |sample: u16| {
            let (sample, max) = (u32::from(sample), u32::from(max));
            ((sample * 255 + max / 2) / max) as u8
        };
        let at = move |x: usize, y: usize| {
            let pixel = &samples[(y * width + x) * channels..][..channels];
            let is_clear = channels == 4 && to_byte(pixel[3]) < 128;
            (!is_clear).then(|| [0, 1, 2].map(|i| to_byte(pixel[i])))
        };
        Ok(Pixels {
            width,
            height,
            at: Box::new(at),
        })
    }

    fn of_rows(
        &self,
        check: &Checker<'_>,
        rows: &Spanned<Vec<Spanned<String>>>,
    ) -> Result<Pixels<'static>, Located> {
        let mut known = HashMap::new();
        for (name, color) in in_order(&self.colors) {
            let mut sign = name.get_ref().chars();
            let (Some(sign), None) = (sign.next(), sign.next()) else {
                let problem = "the name of a texture's color is one character, as in its rows";
                return Err((check.start(name), Problem::Contradiction(problem)));
            };
            let color = check.triple("a component of the colour", color, Range::Share)?;
            known.insert(sign, to_bytes(color));
        }
        let signs: Vec<Vec<char>> = rows
            .get_ref()
            .iter()
            .map(|row| row.get_ref().chars().collect())
            .collect();
        let width = signs.first().map_or(0, Vec::len);
        if width == 0 {
            let problem = "the texture has no pixels";
            return Err((check.start(rows), Problem::Contradiction(problem)));
        }
        for (row, signs) in rows.get_ref().iter().zip(&signs) {
            let found = signs.len();
            if found != width {
                return Err((check.start(row), Problem::Ragged { found, width }));
            }
        }
        Ok(Pixels {
            width,
            height: signs.len(),
            at: Box::new(move |x, y| known.get(&signs[y][x]).copied()),
        })
    }
}

/// Takes pixels from those that there may be.
pub(super) fn take(allowed: &mut usize, pixels: usize) -> Result<(), Problem> {
    let left = allowed.checked_sub(pixels);
    *allowed = left.ok_or_else(|| too_many("pixels in all textures", limits::TEXELS))?;
    Ok(())
}

/// A linear color as a display takes it.
fn to_bytes(color: [f64; 3]) -> [u8; 3] {
    color.map(|it| whitted::picture::quantize(it as f32))
}

impl Bitmap {
    /// Of pixels, [`TEXTURE_SIDE`] to a side at most; `None` of what has more than [`COLORS`].
    fn new(pixels: &Pixels<'_>) -> Option<Self> {
        let Pixels { width, height, .. } = *pixels;
        let mut bitmap = Self {
            width: width as u16,
            height: height as u16,
            texels: Vec::with_capacity(width * height),
            palette: Vec::new(),
        };
        let mut places = HashMap::new();
        for (x, y) in (0..width).flat_map(|x| (0..height).map(move |y| (x, y))) {
            let Some(color) = (pixels.at)(x, y) else {
                bitmap.texels.push(CLEAR);
                continue;
            };
            let next = bitmap.palette.len();
            let place = *places.entry(color).or_insert(next);
            if place == next {
                if next == COLORS {
                    return None;
                }
                bitmap.palette.push(color);
            }
            bitmap.texels.push(place as u8);
        }
        Some(bitmap)
    }
}

impl Texture {
    /// One pixel.
    pub(super) fn plain(color: [f64; 3]) -> Self {
        Self::Palette(Bitmap {
            width: 1,
            height: 1,
            texels: vec![0],
            palette: vec![to_bytes(color)],
        })
    }

    /// The same, darker.
    pub(super) fn shaded(&self, shade: f64) -> Self {
        let darken = |byte: u8| (f64::from(byte) * shade).round() as u8;
        match self {
            Self::Palette(bitmap) => Self::Palette(Bitmap {
                palette: bitmap.palette.iter().map(|it| it.map(darken)).collect(),
                ..bitmap.clone()
            }),
            Self::High(bitmap) => {
                let [red, green, blue] = [Rgb565::r, Rgb565::g, Rgb565::b]
                    .map(|channel| move |it: &Rgb565| darken(channel(it)));
                let darker = |it: &Rgb565| Rgb565::new(red(it), green(it), blue(it));
                Self::High(HighBitmap {
                    pixels: bitmap.pixels.iter().map(darker).collect(),
                    ..bitmap.clone()
                })
            }
        }
    }

    /// Pixels to a side.
    pub fn size(&self) -> [u16; 2] {
        match self {
            Self::Palette(it) => [it.width, it.height],
            Self::High(it) => [it.width, it.height],
        }
    }

    /// Column after column, each from the top; `None` where it is transparent.
    pub fn pixels(&self) -> Vec<Option<Rgb888>> {
        match self {
            Self::Palette(it) => {
                let color = |&[red, green, blue]: &[u8; 3]| Rgb888::new(red, green, blue);
                let at = |&texel: &u8| it.palette.get(usize::from(texel)).map(color);
                it.texels.iter().map(at).collect()
            }
            Self::High(it) => {
                let (width, height) = (usize::from(it.width), usize::from(it.height));
                let places = (0..width).flat_map(|x| (0..height).map(move |y| y * width + x));
                places.map(|place| Some(it.pixels[place].into())).collect()
            }
        }
    }
}

impl HighBitmap {
    /// Of pixels no more than a [`Bitmap`] may have.
    fn new(pixels: &Pixels<'_>) -> Self {
        let Pixels { width, height, .. } = *pixels;
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let color = |(x, y)| {
            let [red, green, blue] = (pixels.at)(x, y).unwrap_or_default();
            Rgb565::from(Rgb888::new(red, green, blue))
        };
        Self {
            width: width as u16,
            height: height as u16,
            pixels: places.map(color).collect(),
        }
    }
}
