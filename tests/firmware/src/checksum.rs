//! Checksums of a frame, the same on the host and on every target.

use core::hash::Hasher;
use fnv::FnvHasher;
use glam::Vec3;

/// FNV-1a (64 bits) of a frame's linear colors and of its 8-bit picture.
#[derive(Default)]
pub struct Checksums {
    float: FnvHasher,
    byte: FnvHasher,
}

impl Checksums {
    /// Takes in the next row.
    pub fn add_row(&mut self, row: &[Vec3]) {
        for color in row {
            for channel in color.to_array() {
                self.float.write(&channel.to_bits().to_le_bytes());
                self.byte.write(&[quantize(channel)]);
            }
        }
    }

    /// Of the bits of every channel, low byte first.
    pub fn float(&self) -> u64 {
        self.float.finish()
    }

    /// Of the channels in 8 bits.
    pub fn byte(&self) -> u64 {
        self.byte.finish()
    }
}

/// A linear channel clamped to 0..1 and rounded to the nearest of 256 levels.
fn quantize(channel: f32) -> u8 {
    // `as` saturates, and takes NaN to zero.
    (channel * 255.0 + 0.5) as u8
}
