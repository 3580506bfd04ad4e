//! Programs that draw a scene on a bare target and report its checksums.
//!
//! The report is made without `core::fmt`, and the panic handler calls a function that does not
//! exist: a program links only if no panic can be reached from it. So one binary is at once what
//! is measured (flash, stack, instructions), what is proved free of panics, and what draws the
//! picture that is compared.
//!
//! A program draws its scene in one of two ways. Plain: rows of floats in a buffer of one row. With
//! the feature `panel`: through embedded-graphics onto the stand-in of a display. The program `frames`
//! draws many scenes, each in both ways, and counts its rays and hits.

#![no_std]

#[cfg(native)]
extern crate std;

#[cfg_attr(native, path = "platform/native.rs")]
#[cfg_attr(
    any(target_arch = "arm", target_arch = "riscv32"),
    path = "platform/semihosting.rs"
)]
#[cfg_attr(target_arch = "wasm32", path = "platform/wasm.rs")]
pub mod platform;
#[cfg(not(any(native, target_arch = "wasm32")))]
mod stack;

mod checksum;
pub mod panel;
#[macro_use]
#[path = "../scenes/mod.rs"]
pub mod scenes;
#[cfg(feature = "baked")]
pub mod baked;

pub use embedded_graphics::pixelcolor::Rgb565;
pub use glam::Vec3;
pub use whitted::columns;
pub use whitted::math::sqrt;

use core::hash::Hasher;
use core::hint::black_box;

use embedded_graphics::pixelcolor::IntoStorage;
use fnv::FnvHasher;

use checksum::Checksums;
use panel::Panel;
use scenes::{Frame, Visitor};

/// The deepest stack of some calls.
#[derive(Default)]
struct Depth(usize);

impl Depth {
    /// Calls `draw`, and keeps how deep the stack became below this function's frame.
    #[inline(always)]
    fn of(&mut self, draw: impl FnOnce()) {
        #[cfg(not(any(native, target_arch = "wasm32")))]
        let paint = stack::Paint::below_here();
        draw();
        #[cfg(not(any(native, target_arch = "wasm32")))]
        {
            self.0 = self.0.max(paint.depth());
        }
    }

    fn report(&self) {
        report("stack", self.0 as u64);
    }
}

/// Draws a frame with `render_row` and reports its checksums.
///
/// `row` is what a display driver would send from; it lives in the program's static memory.
#[inline(always)]
pub fn draw_rows<F: Frame>(row: &mut [Vec3], render_row: impl Fn(u32, &mut [Vec3])) {
    let mut checksums = Checksums::default();
    let mut depth = Depth::default();
    for y in 0..F::VIEW.height {
        // What is measured knows neither where the row lies nor what becomes of it.
        depth.of(|| render_row(y, black_box(&mut *row)));
        checksums.add_row(black_box(row));
    }
    depth.report();
    report("f32", checksums.float());
    report("8-bit", checksums.byte());
}

/// Draws a frame onto a panel with `render` and reports the panel's checksum.
#[inline(always)]
pub fn draw_panel(panel: &mut Panel, render: impl Fn(&mut Panel)) {
    let mut depth = Depth::default();
    depth.of(|| render(black_box(&mut *panel)));
    depth.report();
    report("565", panel.checksum());
}

/// Draws a picture column by column, and reports the checksum of its pixels.
#[inline(always)]
pub fn draw_columns<T, const HEIGHT: usize>(
    width: u32,
    start: impl FnOnce() -> T,
    mut render_column: impl FnMut(&T, u32) -> [Rgb565; HEIGHT],
) {
    let mut depth = Depth::default();
    let mut sent = FnvHasher::default();
    let mut picture = None;
    depth.of(|| picture = Some(start()));
    for x in 0..width {
        depth.of(|| {
            if let Some(picture) = &picture {
                for pixel in render_column(picture, x) {
                    sent.write(&pixel.into_storage().to_be_bytes());
                }
            }
        });
    }
    depth.report();
    report("565", sent.finish());
}

/// Makes the program that draws `$columns`, column by column; what follows the view are the generic
/// parameters from the number of sprites on.
#[macro_export]
macro_rules! columns_program {
    ($columns:expr, $view:expr, $($parameter:tt)*) => {
        type Picture = $crate::columns::ColumnPicture<'static, $crate::Rgb565, $($parameter)*>;
        type Column = [$crate::Rgb565; $view.height as usize];

        /// What is done once a frame.
        #[unsafe(no_mangle)]
        #[inline(never)]
        fn start_picture(picture: &mut Option<Picture>) {
            *picture = Some($columns.picture(&$view));
        }

        /// And for each column; a display's driver would send it from here.
        #[unsafe(no_mangle)]
        #[inline(never)]
        fn render_column(picture: &Picture, x: u32, column: &mut Column) {
            for (pixel, color) in column.iter_mut().zip(picture.pixels(x)) {
                *pixel = color;
            }
        }

        $crate::entry!({
            let mut column = [$columns.floor; $view.height as usize];
            $crate::draw_columns(
                $view.width,
                || {
                    let mut picture = None;
                    start_picture(&mut picture);
                    core::hint::black_box(picture)
                },
                |picture, x| {
                    if let Some(picture) = picture {
                        render_column(picture, x, core::hint::black_box(&mut column));
                    }
                    column
                },
            );
        });
    };
}

/// Draws frames in all ways, one after the other, into memory that is there once.
pub fn frames(visit_all: impl FnOnce(&mut Frames)) {
    static mut FRAMES: Frames = Frames::new();
    // SAFETY: called once by a program, which has one thread.
    visit_all(unsafe { &mut *(&raw mut FRAMES) });
}

/// See [`frames`].
pub struct Frames {
    row: [Vec3; 128],
    panel: Panel,
}

impl Frames {
    /// None drawn yet.
    #[allow(clippy::new_without_default)]
    pub const fn new() -> Self {
        Self {
            row: [Vec3::ZERO; 128],
            panel: Panel::new(),
        }
    }
}

impl Visitor for Frames {
    fn visit<F: Frame>(&mut self, name: &'static str) {
        let report = |what: &str, value| {
            put_all(name);
            platform::put(b'/');
            report(what, value);
        };
        let mut checksums = Checksums::default();
        let width = F::VIEW.width as usize;
        for y in 0..F::VIEW.height {
            if let Some(row) = self.row.get_mut(..width) {
                F::row(y, row);
                checksums.add_row(row);
            }
        }
        report("f32", checksums.float());
        report("8-bit", checksums.byte());
        self.panel = Panel::new();
        let Ok(()) = F::draw(&mut self.panel);
        report("565", self.panel.checksum());
        let counters = F::count();
        report("primary", counters.primary);
        report("reflected", counters.reflected);
        report("refracted", counters.refracted);
        report("shadow", counters.shadow);
        report("hits", counters.hits);
    }
}

fn put_all(text: &str) {
    for &byte in text.as_bytes() {
        platform::put(byte);
    }
}

/// Writes `name`, a space, `value` in hexadecimal and a line break.
pub fn report(name: &str, value: u64) {
    put_all(name);
    platform::put(b' ');
    for nibble in (0..16).rev() {
        let digit = (value >> (4 * nibble)) as u8 & 15;
        platform::put(if digit < 10 {
            b'0' + digit
        } else {
            b'a' - 10 + digit
        });
    }
    platform::put(b'\n');
}

/// Makes the program that draws `$frame`.
///
/// `render_row`, or `render_panel`, keeps its name and is not inlined: it is what the tools count,
/// price and bound.
#[cfg(not(feature = "panel"))]
#[macro_export]
macro_rules! program {
    ($frame:ty) => {
        #[unsafe(no_mangle)]
        #[inline(never)]
        extern "C" fn render_row(y: u32, row: &mut [$crate::Vec3; WIDTH]) {
            <$frame as $crate::scenes::Frame>::row(y, row);
        }

        const WIDTH: usize = <$frame as $crate::scenes::Frame>::VIEW.width as usize;
        static mut ROW: [$crate::Vec3; WIDTH] = [$crate::Vec3::ZERO; WIDTH];

        $crate::entry!({
            // SAFETY: the program starts once and has one thread.
            let row = unsafe { &mut *(&raw mut ROW) };
            $crate::draw_rows::<$frame>(row, |y, row| {
                if let Ok(row) = row.try_into() {
                    render_row(y, row);
                }
            });
        });
    };
}

/// As the plain form.
#[cfg(feature = "panel")]
#[macro_export]
macro_rules! program {
    ($frame:ty) => {
        #[unsafe(no_mangle)]
        #[inline(never)]
        extern "C" fn render_panel(panel: &mut $crate::panel::Panel) {
            let Ok(()) = <$frame as $crate::scenes::Frame>::draw(panel);
        }

        static mut PANEL: $crate::panel::Panel = $crate::panel::Panel::new();

        $crate::entry!({
            // SAFETY: the program starts once and has one thread.
            let panel = unsafe { &mut *(&raw mut PANEL) };
            $crate::draw_panel(panel, |panel| render_panel(panel));
        });
    };
}

/// Makes the program that draws `$frame` by a `render_row` in plain C; an empty one where there is no
/// `arm-none-eabi-gcc` for the target.
#[cfg(not(target_arch = "arm"))]
#[macro_export]
macro_rules! peer {
    ($frame:ty) => {
        $crate::entry!({});
    };
}

/// As the empty form.
#[cfg(target_arch = "arm")]
#[macro_export]
macro_rules! peer {
    ($frame:ty) => {
        const WIDTH: usize = <$frame as $crate::scenes::Frame>::VIEW.width as usize;
        static mut ROW: [$crate::Vec3; WIDTH] = [$crate::Vec3::ZERO; WIDTH];

        $crate::entry!({
            unsafe extern "C" {
                fn render_row(y: u32, row: *mut $crate::Vec3);
            }
            // SAFETY: the program starts once and has one thread.
            let row = unsafe { &mut *(&raw mut ROW) };
            $crate::draw_rows::<$frame>(row, |y, row| {
                // SAFETY: it writes as many pixels as the frame, and so the row, is wide.
                unsafe { render_row(y, row.as_mut_ptr()) }
            });
        });

        /// GCC calls it where the part has no instruction.
        #[unsafe(no_mangle)]
        extern "C" fn sqrtf(x: f32) -> f32 {
            $crate::sqrt(x)
        }
    };
}

#[cfg(not(native))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    unsafe extern "C" {
        safe fn a_panic_is_reachable() -> !;
    }
    a_panic_is_reachable()
}
