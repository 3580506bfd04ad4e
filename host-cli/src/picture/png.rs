//! PNG, by the png crate.

use std::io::{self, Cursor, Write};

use ::png::{
    BitDepth, ColorType, Decoder, Encoder, EncodingError, Limits, ScaledFloat, SrgbRenderingIntent,
    StreamWriter, Transformations,
};

use super::{Picture, PictureError, Transfer, checked_size};

/// Writes a PNG's header.
pub(super) fn encode<W: Write + 'static>(
    sink: W,
    width: u32,
    height: u32,
    transfer: Transfer,
) -> io::Result<StreamWriter<'static, W>> {
    let mut encoder = Encoder::new(sink, width, height);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    match transfer {
        Transfer::Linear => encoder.set_source_gamma(ScaledFloat::new(1.0)),
        Transfer::Srgb => encoder.set_source_srgb(SrgbRenderingIntent::Perceptual),
    }
    encoder
        .write_header()
        .and_then(::png::Writer::into_stream_writer)
        .map_err(io_error)
}

/// The system's error behind the library's.
pub(super) fn io_error(error: EncodingError) -> io::Error {
    match error {
        EncodingError::IoError(error) => error,
        other => io::Error::other(other),
    }
}

/// A picture of a PNG file's bytes; of an animation, the first frame.
pub(super) fn decode(bytes: &[u8]) -> Result<Picture, PictureError> {
    let limits = Limits { bytes: 1 << 30 };
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), limits);
    // Palettes are looked up, transparency becomes a channel, few bits become 8.
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info()?;
    let (width, height) = (reader.info().width, reader.info().height);
    let (width, height) = checked_size(width.into(), height.into())?;
    let (color, depth) = reader.output_color_type();
    let mut raw = vec![0; reader.output_buffer_size().unwrap_or(0)];
    reader.next_frame(&mut raw)?;
    let raw: Vec<u16> = match depth {
        BitDepth::Sixteen => raw
            .chunks_exact(2)
            .map(|it| u16::from_be_bytes([it[0], it[1]]))
            .collect(),
        _ => raw.iter().map(|&it| it.into()).collect(),
    };
    let (channels, samples) = match color {
        ColorType::Grayscale => (3, raw.iter().flat_map(|&y| [y; 3]).collect()),
        ColorType::GrayscaleAlpha => {
            let pixels = raw.chunks_exact(2);
            (
                4,
                pixels.flat_map(|it| [it[0], it[0], it[0], it[1]]).collect(),
            )
        }
        ColorType::Rgba => (4, raw),
        // No indices: they are expanded.
        ColorType::Rgb | ColorType::Indexed => (3, raw),
    };
    Ok(Picture {
        width,
        height,
        channels,
        max: if depth == BitDepth::Sixteen {
            u16::MAX
        } else {
            255
        },
        samples,
    })
}

#[cfg(test)]
mod tests {
    use super::super::{Format, Writer};
    use super::*;

    /// A PNG of 2×1 pixels.
    fn file(color: ColorType, depth: BitDepth, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = Encoder::new(&mut bytes, 2, 1);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if color == ColorType::Indexed {
            encoder.set_palette(vec![1, 2, 3, 4, 5, 6]);
            encoder.set_trns(vec![9]);
        }
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(data).unwrap();
        writer.finish().unwrap();
        bytes
    }

    #[test]
    fn every_kind_of_pixel_is_spread_to_channels() {
        use BitDepth::*;
        use ColorType::*;
        type Case = (
            &'static str,
            ColorType,
            BitDepth,
            &'static [u8],
            usize,
            &'static [u16],
        );
        let cases: [Case; 7] = [
            (
                "rgb",
                Rgb,
                Eight,
                &[1, 2, 3, 4, 5, 6],
                3,
                &[1, 2, 3, 4, 5, 6],
            ),
            ("grey", Grayscale, Eight, &[7, 8], 3, &[7, 7, 7, 8, 8, 8]),
            (
                "one bit",
                Grayscale,
                One,
                &[0b0100_0000],
                3,
                &[0, 0, 0, 255, 255, 255],
            ),
            (
                "grey, alpha",
                GrayscaleAlpha,
                Eight,
                &[7, 1, 8, 2],
                4,
                &[7, 7, 7, 1, 8, 8, 8, 2],
            ),
            (
                "rgba",
                Rgba,
                Eight,
                &[1, 2, 3, 4, 5, 6, 7, 8],
                4,
                &[1, 2, 3, 4, 5, 6, 7, 8],
            ),
            (
                "palette",
                Indexed,
                Eight,
                &[1, 0],
                4,
                &[4, 5, 6, 255, 1, 2, 3, 9],
            ),
            (
                "wide",
                Grayscale,
                Sixteen,
                &[1, 2, 0, 3],
                3,
                &[258, 258, 258, 3, 3, 3],
            ),
        ];
        for (name, color, depth, data, channels, samples) in cases {
            let picture = Picture::decode(&file(color, depth, data)).unwrap();
            assert_eq!((picture.width, picture.height), (2, 1), "{name}");
            assert_eq!(
                (picture.channels, &picture.samples[..]),
                (channels, samples),
                "{name}"
            );
            assert_eq!(
                picture.max,
                if depth == Sixteen { 65535 } else { 255 },
                "{name}"
            );
        }
    }

    #[test]
    fn what_is_written_is_read_back() {
        let pixels: Vec<u8> = (0..24).collect();
        for (transfer, chunk) in [(Transfer::Linear, b"gAMA"), (Transfer::Srgb, b"sRGB")] {
            let sink = tempfile::NamedTempFile::new().unwrap();
            let file = sink.reopen().unwrap();
            let mut writer = Writer::new(file, Format::Png, 4, 2, transfer).unwrap();
            writer.rows(&pixels[..12]).unwrap();
            writer.rows(&pixels[12..]).unwrap();
            writer.finish().unwrap();
            let bytes = std::fs::read(sink.path()).unwrap();
            let picture = Picture::decode(&bytes).unwrap();
            assert!(picture.samples.iter().map(|&it| it as u8).eq(0..24));
            assert!(bytes.windows(4).any(|it| it == chunk));
        }
    }

    #[test]
    fn broken_files_are_refused() {
        let whole = file(ColorType::Rgb, BitDepth::Eight, &[1, 2, 3, 4, 5, 6]);
        for length in 8..whole.len() - 12 {
            // All but the end marker is needed.
            assert!(Picture::decode(&whole[..length]).is_err(), "{length} bytes");
        }
        let mut huge = whole.clone();
        huge[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 1, 0, 0]);
        assert!(Picture::decode(&huge).is_err());
        let mut flipped = whole;
        let middle = flipped.len() - 20;
        flipped[middle] ^= 1;
        assert!(Picture::decode(&flipped).is_err());
    }
}
