//! Pictures in files: written row by row, read whole.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

use thiserror::Error;

use crate::output;

mod png;
mod ppm;

/// A picture as a file stores it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// In pixels.
    pub width: usize,
    /// In pixels.
    pub height: usize,
    /// Red, green, blue, and alpha where the file has it.
    pub channels: usize,
    /// The sample that stands for full brightness.
    pub max: u16,
    /// Row by row from the top, pixel by pixel from the left; none above `max`.
    pub samples: Vec<u16>,
}

/// Most pixels of a picture that is read, since it is held in memory.
pub const PIXELS: usize = 1 << 26;
/// Largest file that is read.
const BYTES: u64 = 1 << 30;

/// Why a file is no picture.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The system's word.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// Neither PPM nor PNG by its first bytes.
    #[error("neither a PPM (P3 or P6) nor a PNG picture")]
    UnknownFormat,
    /// In bytes.
    #[error("larger than {BYTES} bytes")]
    TooManyBytes,
    /// Width and height are 0, or too large together.
    #[error("{width}x{height} pixels: there must be some, and at most {PIXELS}")]
    Size {
        /// In pixels.
        width: u64,
        /// In pixels.
        height: u64,
    },
    /// A header or sample of a PPM that is no number.
    #[error("expected {expected}, found `{found}`")]
    Unexpected {
        /// What should stand there.
        expected: &'static str,
        /// What does.
        found: String,
    },
    /// The file is shorter than its header says.
    #[error("the file ends before {0}")]
    Ended(&'static str),
    /// A greatest value that PPM does not have.
    #[error("the greatest value is {0}: not between 1 and 65535")]
    Max(u64),
    /// A sample above the greatest value.
    #[error("a sample is {sample}, above the greatest value {max}")]
    Sample {
        /// The sample.
        sample: u64,
        /// The greatest value.
        max: u16,
    },
    /// The file is longer than its header says.
    #[error("{0} bytes follow the picture: another one?")]
    Trailing(usize),
    /// What the PNG library says.
    #[error("broken PNG: {0}")]
    Png(#[from] ::png::DecodingError),
}

impl Picture {
    /// Reads a PPM (P3 or P6) or PNG file, whatever it is called.
    ///
    /// Grey is spread to three channels, a palette is looked up, fewer than 8 bits are scaled to 8.
    /// Samples are taken as they are stored, without regard to gamma.
    ///
    /// # Errors
    ///
    /// Where the file is no such picture, not all of one, or more than one.
    pub fn read(path: &Path) -> Result<Self, PictureError> {
        let mut bytes = Vec::new();
        File::open(path)?.take(BYTES + 1).read_to_end(&mut bytes)?;
        if bytes.len() as u64 > BYTES {
            return Err(PictureError::TooManyBytes);
        }
        Self::decode(&bytes)
    }

    /// [`read`](Self::read), of a file's bytes.
    ///
    /// # Errors
    ///
    /// As there.
    pub fn decode(bytes: &[u8]) -> Result<Self, PictureError> {
        match bytes {
            [b'P', b'3' | b'6', ..] => ppm::decode(bytes),
            [0x89, b'P', b'N', b'G', ..] => png::decode(bytes),
            _ => Err(PictureError::UnknownFormat),
        }
    }
}

/// Width and height as `usize`, unless there are no pixels or too many.
fn checked_size(width: u64, height: u64) -> Result<(usize, usize), PictureError> {
    match width.checked_mul(height) {
        Some(pixels) if pixels > 0 && pixels <= PIXELS as u64 => {
            Ok((width as usize, height as usize))
        }
        _ => Err(PictureError::Size { width, height }),
    }
}

/// How pictures are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// PPM, P6.
    Ppm,
    /// PPM as text, P3.
    PlainPpm,
    /// PNG, 8 bits a channel.
    Png,
}

/// A file name that tells no format.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("cannot tell the format of {0}: the name ends in neither .ppm nor .png")]
pub struct UnknownExtension(String);

impl Format {
    /// The format that a file's name asks for. Standard output, pipes and devices have no such name:
    /// PPM.
    ///
    /// # Errors
    ///
    /// For names with another ending, or none.
    pub fn of(path: &Path) -> Result<Self, UnknownExtension> {
        let extension = path.extension().map(|it| it.to_ascii_lowercase());
        match extension.as_ref().and_then(|it| it.to_str()) {
            Some("ppm") => Ok(Self::Ppm),
            Some("png") => Ok(Self::Png),
            _ if output::is_special(path) => Ok(Self::Ppm),
            _ => Err(UnknownExtension(path.display().to_string())),
        }
    }
}

/// How 8-bit samples stand for light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transfer {
    /// In proportion.
    Linear,
    /// By the curve of IEC 61966-2-1, which displays expect.
    Srgb,
}

/// A picture being written, row by row from the top.
pub enum Writer<W: Write + 'static> {
    /// See [`Format::Ppm`].
    Ppm(W),
    /// See [`Format::PlainPpm`].
    PlainPpm(W),
    /// See [`Format::Png`].
    Png(Box<::png::StreamWriter<'static, W>>),
}

impl<W: Write + 'static> Writer<W> {
    /// Writes the header. A PNG's says how its samples stand for light; PPM has no room for that.
    ///
    /// # Errors
    ///
    /// Where `sink` fails.
    pub fn new(
        mut sink: W,
        format: Format,
        width: u32,
        height: u32,
        transfer: Transfer,
    ) -> io::Result<Self> {
        match format {
            Format::Ppm => {
                write!(sink, "P6\n{width} {height}\n255\n")?;
                Ok(Self::Ppm(sink))
            }
            Format::PlainPpm => {
                write!(sink, "P3\n{width} {height}\n255\n")?;
                Ok(Self::PlainPpm(sink))
            }
            Format::Png => Ok(Self::Png(Box::new(png::encode(
                sink, width, height, transfer,
            )?))),
        }
    }

    /// Writes whole rows of pixels, three bytes a pixel.
    ///
    /// # Errors
    ///
    /// Where the sink fails.
    pub fn rows(&mut self, pixels: &[u8]) -> io::Result<()> {
        match self {
            Self::Ppm(sink) => sink.write_all(pixels),
            Self::PlainPpm(sink) => ppm::write_plain(sink, pixels),
            Self::Png(sink) => sink.write_all(pixels),
        }
    }

    /// Writes what comes after the last row.
    ///
    /// # Errors
    ///
    /// Where the sink fails.
    pub fn finish(self) -> io::Result<()> {
        match self {
            Self::Ppm(mut sink) | Self::PlainPpm(mut sink) => sink.flush(),
            Self::Png(sink) => sink.finish().map_err(png::io_error),
        }
    }
}
