//! The program to which `core/FIRMWARE.md` leads, on a board whose display fails after three frames.
//!
//! The test that builds it puts the page's code into the file that `WHITTED_PAGE` names.
#![no_std]
#![no_main]

#[path = "../src/panel.rs"]
mod panel;

/// What an author's board has.
mod board {
    use embedded_graphics::Pixel;
    use embedded_graphics::draw_target::DrawTarget;
    use embedded_graphics::geometry::{OriginDimensions, Size};
    use embedded_graphics::pixelcolor::Rgb565;
    use embedded_graphics::primitives::Rectangle;
    use semihosting::sys::arm_compat;

    use crate::panel::Panel;

    /// A display that takes three frames.
    pub struct Display {
        panel: Panel,
        frames: u32,
    }

    pub fn display() -> Display {
        Display {
            panel: Panel::new(),
            frames: 0,
        }
    }

    impl OriginDimensions for Display {
        fn size(&self) -> Size {
            self.panel.size()
        }
    }

    impl DrawTarget for Display {
        type Color = Rgb565;
        type Error = ();

        fn draw_iter<I: IntoIterator<Item = Pixel<Rgb565>>>(&mut self, _: I) -> Result<(), ()> {
            Err(())
        }

        fn fill_contiguous<I>(&mut self, area: &Rectangle, colors: I) -> Result<(), ()>
        where
            I: IntoIterator<Item = Rgb565>,
        {
            if self.frames == 3 {
                return Err(());
            }
            self.frames += 1;
            let Ok(()) = self.panel.fill_contiguous(area, colors);
            Ok(())
        }
    }

    /// Tells what was sent, and ends.
    pub fn failed(display: &Display) -> ! {
        for &byte in b"565 " {
            arm_compat::sys_writec(byte);
        }
        for nibble in (0..16).rev() {
            let digit = (display.panel.checksum() >> (4 * nibble)) as u8 & 15;
            arm_compat::sys_writec(if digit < 10 {
                b'0' + digit
            } else {
                b'a' - 10 + digit
            });
        }
        arm_compat::sys_writec(b'\n');
        semihosting::process::exit(0)
    }
}

include!(env!("WHITTED_PAGE"));
