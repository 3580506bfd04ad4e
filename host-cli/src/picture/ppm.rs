//! Portable pixmaps: P6, and P3 in plain text.
//!
//! <https://netpbm.sourceforge.net/doc/ppm.html>

use std::io::{self, Write};

use super::{Picture, PictureError, checked_size};

/// Writes pixels as text. Lines stay below the format's 70 characters.
pub(super) fn write_plain(sink: &mut impl Write, pixels: &[u8]) -> io::Result<()> {
    const PIXELS_A_LINE: usize = 5;
    let mut text = Vec::new();
    for line in pixels.chunks(3 * PIXELS_A_LINE) {
        for (index, sample) in line.iter().enumerate() {
            let separator = if index == 0 { "" } else { " " };
            write!(text, "{separator}{sample}")?;
        }
        text.push(b'\n');
    }
    sink.write_all(&text)
}

/// The bytes of a file, from where they are read on.
struct Cursor<'a> {
    rest: &'a [u8],
}

impl<'a> Cursor<'a> {
    /// The next byte; a comment counts as the end of its line.
    fn byte(&mut self) -> Option<u8> {
        let (&byte, rest) = self.rest.split_first()?;
        self.rest = rest;
        if byte != b'#' {
            return Some(byte);
        }
        let end = rest.iter().position(|it| matches!(it, b'\n' | b'\r'))?;
        self.rest = &rest[end + 1..];
        Some(b'\n')
    }

    /// The next number, and the one byte that ends it.
    fn number(&mut self, what: &'static str) -> Result<u64, PictureError> {
        let mut byte = self.byte();
        while byte.is_some_and(|it| it.is_ascii_whitespace()) {
            byte = self.byte();
        }
        let mut number: Option<u64> = None;
        while let Some(digit @ b'0'..=b'9') = byte {
            let digits = number.unwrap_or(0).saturating_mul(10);
            number = Some(digits.saturating_add(u64::from(digit - b'0')));
            byte = self.byte();
        }
        match (number, byte) {
            (Some(number), None) => Ok(number),
            (Some(number), Some(byte)) if byte.is_ascii_whitespace() => Ok(number),
            (None, None) => Err(PictureError::Ended(what)),
            (_, Some(byte)) => Err(PictureError::Unexpected {
                expected: what,
                found: char::from(byte).escape_debug().to_string(),
            }),
        }
    }
}

/// A picture of a file's bytes, which start with P3 or P6.
pub(super) fn decode(bytes: &[u8]) -> Result<Picture, PictureError> {
    let plain = bytes[1] == b'3';
    let mut cursor = Cursor { rest: &bytes[2..] };
    let width = cursor.number("the width")?;
    let height = cursor.number("the height")?;
    let (width, height) = checked_size(width, height)?;
    let max = cursor.number("the greatest value")?;
    let max = match u16::try_from(max) {
        Ok(max) if max > 0 => max,
        _ => return Err(PictureError::Max(max)),
    };
    let count = 3 * width * height;
    let samples = if plain {
        plain_samples(&mut cursor, count, max)?
    } else {
        binary_samples(&mut cursor, count, max)?
    };
    Ok(Picture {
        width,
        height,
        channels: 3,
        max,
        samples,
    })
}

fn plain_samples(
    cursor: &mut Cursor<'_>,
    count: usize,
    max: u16,
) -> Result<Vec<u16>, PictureError> {
    // Grows with the file, not with what the header promises.
    let mut samples = Vec::new();
    for _ in 0..count {
        samples.push(checked(cursor.number("a sample")?, max)?);
    }
    while let Some(byte) = cursor.byte() {
        if !byte.is_ascii_whitespace() {
            return Err(PictureError::Trailing(1 + cursor.rest.len()));
        }
    }
    Ok(samples)
}

fn binary_samples(
    cursor: &mut Cursor<'_>,
    count: usize,
    max: u16,
) -> Result<Vec<u16>, PictureError> {
    let width = if max < 256 { 1 } else { 2 };
    let Some(raster) = cursor.rest.get(..count * width) else {
        return Err(PictureError::Ended("the last sample"));
    };
    let trailing = cursor.rest.len() - raster.len();
    if trailing > 0 {
        return Err(PictureError::Trailing(trailing));
    }
    let number = |sample: &[u8]| sample.iter().fold(0, |sum, &it| sum << 8 | u64::from(it));
    raster
        .chunks_exact(width)
        .map(|sample| checked(number(sample), max))
        .collect()
}

fn checked(sample: u64, max: u16) -> Result<u16, PictureError> {
    match u16::try_from(sample) {
        Ok(sample) if sample <= max => Ok(sample),
        _ => Err(PictureError::Sample { sample, max }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(bytes: &[u8]) -> Result<Vec<u16>, String> {
        match Picture::decode(bytes) {
            Ok(picture) => Ok(picture.samples),
            Err(error) => Err(error.to_string()),
        }
    }

    #[test]
    fn headers_come_in_many_forms() {
        let cases: [(&str, &[u8]); 7] = [
            ("short", b"P6 1 1 255 abc"),
            ("lines", b"P6\n1\n1\n255\nabc"),
            ("comments", b"P6 # a\n#b\n1#c\n1\n# d\n255\nabc"),
            ("comment before the raster", b"P6 1 1 255# d\nabc"),
            ("plain", b"P3 1 1 255 97 98 99"),
            (
                "plain with comments",
                b"P3 1 1 255 97 # red\n98 99 # end\n\n",
            ),
            (
                "plain, comment at the very end",
                b"P3 1 1 255 97 98 99 # end",
            ),
        ];
        for (name, bytes) in cases {
            assert_eq!(samples(bytes), Ok(vec![97, 98, 99]), "{name}");
        }
    }

    #[test]
    fn the_raster_starts_one_byte_after_the_greatest_value() {
        assert_eq!(samples(b"P6 1 1 255 \n#9"), Ok(vec![10, 35, 57]));
    }

    #[test]
    fn wide_samples_are_big_endian() {
        let picture = Picture::decode(b"P6 1 1 65535 \x01\x02\x00\x03\xff\xff").unwrap();
        assert_eq!((picture.max, picture.samples), (65535, vec![258, 3, 65535]));
        assert_eq!(samples(b"P6 1 1 256 \0\x01\x01\0\0\0"), Ok(vec![1, 256, 0]));
    }

    #[test]
    fn broken_files_are_refused() {
        let cases: [(&[u8], &str); 16] = [
            (b"", "neither a PPM (P3 or P6) nor a PNG picture"),
            (
                b"P5 1 1 255 a",
                "neither a PPM (P3 or P6) nor a PNG picture",
            ),
            (b"P6", "the file ends before the width"),
            (b"P6 # 1 1", "the file ends before the width"),
            (b"P6 1", "the file ends before the height"),
            (b"P6 1 1\n", "the file ends before the greatest value"),
            (b"P6 -1 1 255\n", "expected the width, found `-`"),
            (b"P6 1x 1 255\n", "expected the width, found `x`"),
            (
                b"P6 0 1 255\n",
                "0x1 pixels: there must be some, and at most 67108864",
            ),
            (
                b"P6 99999999999999999999 2 255\n",
                "18446744073709551615x2 pixels: there must be some, and at most 67108864",
            ),
            (
                b"P6 1 1 0\nabc",
                "the greatest value is 0: not between 1 and 65535",
            ),
            (
                b"P6 1 1 65536\nabc",
                "the greatest value is 65536: not between 1 and 65535",
            ),
            (
                b"P6 8192 8192 255\nabc",
                "the file ends before the last sample",
            ),
            (
                b"P6 1 1 255\nabcd",
                "1 bytes follow the picture: another one?",
            ),
            (
                b"P6 1 1 97\nabc",
                "a sample is 98, above the greatest value 97",
            ),
            (
                b"P3 1 1 255 1 2 256",
                "a sample is 256, above the greatest value 255",
            ),
        ];
        for (bytes, message) in cases {
            assert_eq!(samples(bytes), Err(message.to_owned()), "{message}");
        }
        assert_eq!(
            samples(b"P3 8192 8192 255 1 2"),
            Err("the file ends before a sample".into())
        );
        let more = Err("2 bytes follow the picture: another one?".to_owned());
        assert_eq!(samples(b"P3 1 1 255 1 2 3 P3"), more);
    }

    #[test]
    fn plain_lines_are_short() {
        let mut text = Vec::new();
        write_plain(&mut text, &[255; 3 * 7]).unwrap();
        let text = String::from_utf8(text).unwrap();
        let lengths: Vec<_> = text.lines().map(str::len).collect();
        assert_eq!(lengths, [59, 23]);
    }
}
