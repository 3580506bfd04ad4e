//! The command line.

use std::num::NonZeroUsize;
use std::ops::Range;
use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, Parser, Subcommand};
use whitted::antialiasing;

use crate::scene_file::limits;

/// Renders, compares, casts into, inspects and bakes scenes.
#[derive(Debug, Parser)]
#[command(name = "whitted", version)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What to do. Each command's documentation, which is its help, stands at its arguments.
#[derive(Debug, Subcommand)]
#[expect(missing_docs, reason = "it would take the place of that help")]
pub enum Command {
    Render(Render),
    Compare(Compare),
    Cast(Cast),
    Inspect(Inspect),
    Bake(Bake),
}

/// Render a scene to a picture
///
/// Writes PPM or PNG, by the name of OUT. OUT is replaced when the picture is complete, and stays as
/// it is when anything fails. The picture is the same, byte for byte, for any number of threads.
#[derive(Debug, Args)]
pub struct Render {
    /// Scene file, .nff or .toml, or .map; without one, the built-in scene
    ///
    /// A map is drawn by columns, with textures and sprites and without light, unless --trace is
    /// given.
    pub scene: Option<PathBuf>,

    /// Picture file, .ppm or .png; `-` writes a PPM to standard output
    #[arg(short, long, value_name = "OUT", default_value = "whitted.png")]
    pub output: PathBuf,

    /// Size in pixels [default: the scene's, or else 512x512]
    #[arg(long, value_name = "WxH")]
    pub size: Option<Size>,

    /// Longest chain of rays, the eye ray counted as 1 [default: the scene's]
    #[arg(long, value_name = "N", value_parser = depth)]
    pub depth: Option<usize>,

    /// Trace rays through a map, with its lights and materials; scenes always are traced
    #[arg(long)]
    pub trace: bool,

    /// Do not trace what weighs no more than this in its pixel; 1/512 = 0.00195 is below what 8 bits
    /// show
    #[arg(long, value_name = "WEIGHT", default_value = "0", value_parser = threshold)]
    pub threshold: f32,

    /// Rays a pixel, N to a side, averaged, from 1 to 16; with --adaptive, as many where the picture
    /// changes most: 2, 4, 8 or 16
    #[arg(long, value_name = "N", value_parser = samples)]
    pub samples: Option<u32>,

    /// More rays only where corners of a pixel, or of its quarters, differ by more than this, from 0 to
    /// 1; 1/32 is eight steps of an 8-bit channel; --samples 4 unless it says otherwise
    #[arg(long, value_name = "BOUND", value_parser = threshold)]
    pub adaptive: Option<f32>,

    /// Number of threads [default: one a processor]
    #[arg(long, value_name = "N", value_parser = threads)]
    pub threads: Option<NonZeroUsize>,

    /// Only the rows from A up to, not including, B, counted from the top
    ///
    /// They are written as a picture of their own, B-A rows high, with its own header. The pixels of
    /// bands that follow each other are, one after the other, the pixels of the whole picture.
    #[arg(long, value_name = "A..B")]
    pub rows: Option<Rows>,

    /// Encode for displays (the sRGB curve) instead of in proportion to light
    #[arg(long)]
    pub srgb: bool,

    /// Write a PPM as text (P3)
    #[arg(long)]
    pub ascii: bool,
}

/// Compare two pictures
///
/// Reads PPM (P3, P6) and PNG. Samples are compared as they are stored, whatever gamma a PNG states.
/// Where the greatest sample values of the two differ (8 against 16 bits, say), the samples of the
/// picture with the lower one are first scaled to the higher one and rounded to the nearest whole
/// number; differences are counted in steps of that. Alpha is compared as a fourth channel if either
/// has it; without it a picture is opaque.
///
/// Exits with 0 if the share of pixels with any channel more than --max-diff apart is at most
/// --max-differing; with 1 if not, or if the sizes differ; with 2 if a picture cannot be read.
#[derive(Debug, Args)]
pub struct Compare {
    /// A picture
    pub a: PathBuf,

    /// Another picture
    pub b: PathBuf,

    /// How far apart channels may be without counting as different
    #[arg(long, value_name = "N", default_value = "0")]
    pub max_diff: u16,

    /// Share of pixels, from 0 to 1, that may be further apart
    #[arg(long, value_name = "SHARE", default_value = "0", value_parser = share)]
    pub max_differing: f64,

    /// Write the differences as a picture, .ppm or .png, the largest difference white
    #[arg(long, value_name = "OUT")]
    pub diff: Option<PathBuf>,
}

/// Cast rays into a scene and report what they meet
///
/// Reads rays from standard input, one a line: `ox oy oz dx dy dz [t_max]`, origin, direction and
/// optionally how far. The direction need not be unit length; t counts in its units, from above 0 to
/// below t_max. Writes one line of JSON for each:
///
/// `{"hit":true,"t":1.0,"point":[x,y,z],"normal":[x,y,z],"front":true,"shape":"sphere","index":3,
/// "material":"…"}` or `{"hit":false}`
///
/// `normal` is unit length and turned to the ray's origin, `front` tells whether that is the outward
/// side, `index` counts the shapes of the file from 0. A line that is not a ray is answered by
/// {"error":"…","line":N}; the others are still answered, and the exit code is then 2. What lies
/// beyond the range of 32-bit floats is not met. Answers are written as soon as no further line
/// waits.
#[derive(Debug, Args)]
pub struct Cast {
    /// Scene file, .nff or .toml, or .map, of which `shape` is wall, door, floor or ceiling and `index`
    /// the cell, row after row
    pub scene: PathBuf,

    /// Only tell whether anything is in between, transparent or not: {"occluded":true}
    #[arg(long)]
    pub occluded: bool,
}

/// Tell what a scene needs
#[derive(Debug, Args)]
pub struct Inspect {
    /// Scene file, .nff or .toml, or .map
    pub scene: PathBuf,

    /// Write JSON
    #[arg(long)]
    pub json: bool,
}

/// Write a scene as a Rust module for firmware
///
/// Everything in the module is a `static` or a constant, made of the types of the `whitted` crate that
/// the scene needs and of no others: `SCENE`, `VIEW`, its camera and size, and `DEPTH`, how far light
/// is to be followed. Firmware built from it shows the same bits as `whitted render`. OUT is
/// replaced as a whole or stays as it is.
#[derive(Debug, Args)]
pub struct Bake {
    /// Scene file, .nff or .toml, or .map
    ///
    /// A map's module has both `COLUMNS`, to be drawn by columns, and `SCENE`, to be traced.
    pub scene: PathBuf,

    /// Rust file; `-` writes to standard output
    #[arg(short, long, value_name = "OUT", default_value = "-")]
    pub output: PathBuf,

    /// Size of the picture in pixels [default: the scene's, or else 512x512]
    #[arg(long, value_name = "WxH")]
    pub size: Option<Size>,

    /// Refuse a scene whose arrays take more bytes of flash; code is not counted
    #[arg(long, value_name = "BYTES")]
    pub max_flash: Option<usize>,
}

/// Width and height of a picture, in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// From 1 to [`limits::SIDE`].
    pub width: u32,
    /// From 1 to [`limits::SIDE`].
    pub height: u32,
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let sides = text.split_once(['x', 'X']).and_then(|(width, height)| {
            let side = |it: &str| it.parse().ok().filter(|it| (1..=limits::SIDE).contains(it));
            Some((side(width)?, side(height)?))
        });
        match sides {
            Some((width, height)) => Ok(Self { width, height }),
            None => Err(format!(
                "expected two numbers from 1 to {}, as in 640x480",
                limits::SIDE
            )),
        }
    }
}

/// A band of a picture: its first row, and the one after its last.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rows(pub Range<u32>);

impl FromStr for Rows {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let ends = text.split_once("..").and_then(|(start, end)| {
            let (start, end): (u32, u32) = (start.parse().ok()?, end.parse().ok()?);
            (start < end).then_some(start..end)
        });
        ends.map(Self)
            .ok_or_else(|| "expected two rows, the second greater, as in 0..64".to_owned())
    }
}

fn depth(text: &str) -> Result<usize, String> {
    let number = text.parse().ok();
    number
        .filter(|it| (1..=limits::DEPTH).contains(it))
        .ok_or_else(|| format!("expected a number from 1 to {}", limits::DEPTH))
}

fn samples(text: &str) -> Result<u32, String> {
    let number = text.parse().ok();
    number
        .filter(|it| (1..=antialiasing::MOST).contains(it))
        .ok_or_else(|| format!("expected a number from 1 to {}", antialiasing::MOST))
}

fn threshold(text: &str) -> Result<f32, String> {
    let number = text.parse().ok();
    number
        .filter(|it| (0.0..=1.0).contains(it))
        .ok_or_else(|| "expected a number from 0 to 1".to_owned())
}

fn share(text: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    number
        .filter(|it| (0.0..=1.0).contains(it))
        .ok_or_else(|| "expected a number from 0 to 1".to_owned())
}

fn threads(text: &str) -> Result<NonZeroUsize, String> {
    const MOST: usize = 1024;
    let number: Option<NonZeroUsize> = text.parse().ok();
    number
        .filter(|it| it.get() <= MOST)
        .ok_or_else(|| format!("expected a number from 1 to {MOST}"))
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_definition_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn sizes_are_two_numbers_within_limits() {
        let size = |width, height| Some(Size { width, height });
        let cases = [
            ("640x480", size(640, 480)),
            ("1x16384", size(1, 16384)),
            ("2X3", size(2, 3)),
            ("0x1", None),
            ("1x16385", None),
            ("640", None),
            ("640x", None),
            ("-1x5", None),
            ("1x1x1", None),
            ("99999999999x1", None),
        ];
        for (text, size) in cases {
            assert_eq!(text.parse().ok(), size, "{text}");
        }
    }

    #[test]
    fn bands_have_rows() {
        let cases = [
            ("0..64", Some(Rows(0..64))),
            ("5..6", Some(Rows(5..6))),
            ("6..6", None),
            ("6..5", None),
            ("..5", None),
            ("5..", None),
            ("0..=5", None),
            ("x", None),
        ];
        for (text, rows) in cases {
            assert_eq!(text.parse().ok(), rows, "{text}");
        }
    }

    #[test]
    fn numbers_stay_within_their_ranges() {
        assert_eq!(
            ["0", "1", "32", "33", "x"].map(|it| depth(it).is_ok()),
            [false, true, true, false, false]
        );
        assert_eq!(
            ["0", "1", "16", "17", "x"].map(|it| samples(it).is_ok()),
            [false, true, true, false, false]
        );
        assert_eq!(
            ["-0.1", "0", "1e-3", "1.5", "nan"].map(|it| threshold(it).is_ok()),
            [false, true, true, false, false]
        );
        assert_eq!(
            ["-0.1", "0", "1", "1.5", "inf"].map(|it| share(it).is_ok()),
            [false, true, true, false, false]
        );
        assert_eq!(
            ["0", "1", "1024", "1025", "-1"].map(|it| threads(it).is_ok()),
            [false, true, true, false, false]
        );
    }
}
