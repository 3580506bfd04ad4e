//! What stands in for a display: 128 by 160 pixels of 16 bits, of which two rows are in memory.

use core::convert::Infallible;
use core::hash::Hasher;

use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Size};
use embedded_graphics::pixelcolor::{IntoStorage, Rgb565};
use embedded_graphics::prelude::{Dimensions, Pixel, Point, PointsIter};
use embedded_graphics::primitives::Rectangle;
use fnv::FnvHasher;

const WIDTH: usize = 128;
const HEIGHT: usize = 160;

/// Takes windows of pixels, row by row: while one row fills, the one before it could be on its way.
/// Sending is taking into a checksum: FNV-1a of the window's corner and of the pixels, high byte first.
pub struct Panel {
    rows: [[u16; WIDTH]; 2],
    sent: u64,
}

impl Panel {
    /// A panel to which nothing has been sent.
    #[allow(clippy::new_without_default)]
    pub const fn new() -> Self {
        const OFFSET_BASIS: u64 = 0xcbf2_9ce4_8422_2325;
        Self {
            rows: [[0; WIDTH]; 2],
            sent: OFFSET_BASIS,
        }
    }

    /// Of all that was sent.
    pub fn checksum(&self) -> u64 {
        self.sent
    }

    fn send(&mut self, bytes: [u8; 2]) {
        let mut hasher = FnvHasher::with_key(self.sent);
        hasher.write(&bytes);
        self.sent = hasher.finish();
    }

    fn open_window(&mut self, corner: Point) {
        self.send([corner.x as u8, corner.y as u8]);
    }
}

impl OriginDimensions for Panel {
    fn size(&self) -> Size {
        Size::new(WIDTH as u32, HEIGHT as u32)
    }
}

impl DrawTarget for Panel {
    type Color = Rgb565;
    type Error = Infallible;

    fn draw_iter<I>(&mut self, pixels: I) -> Result<(), Infallible>
    where
        I: IntoIterator<Item = Pixel<Rgb565>>,
    {
        for Pixel(point, color) in pixels {
            if self.bounding_box().contains(point) {
                self.open_window(point);
                self.send(color.into_storage().to_be_bytes());
            }
        }
        Ok(())
    }

    fn fill_contiguous<I>(&mut self, area: &Rectangle, colors: I) -> Result<(), Infallible>
    where
        I: IntoIterator<Item = Rgb565>,
    {
        if self.bounding_box().intersection(area) != *area {
            return self.draw_iter(
                area.points()
                    .zip(colors)
                    .map(|(point, color)| Pixel(point, color)),
            );
        }
        self.open_window(area.top_left);
        let mut colors = colors.into_iter();
        for index in 0..area.size.height as usize {
            let row = &mut self.rows[index & 1];
            let mut filled = 0;
            for (slot, color) in row
                .iter_mut()
                .zip(colors.by_ref().take(area.size.width as usize))
            {
                *slot = color.into_storage();
                filled += 1;
            }
            for pixel in self.rows[index & 1].into_iter().take(filled) {
                self.send(pixel.to_be_bytes());
            }
        }
        Ok(())
    }
}
