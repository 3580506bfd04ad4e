//! A map by columns. Not a frame like the others: its pixels are those of a display, column by column.
#![no_std]
#![no_main]

use core::hint::black_box;

use embedded_graphics::pixelcolor::Rgb565;
use whitted::columns::ColumnPicture;
use whitted_firmware::scenes::castle::{COLUMNS, COLUMNS_VIEW};

type Picture = ColumnPicture<'static, Rgb565, 2>;
type Column = [Rgb565; COLUMNS_VIEW.height as usize];

/// What is done once a frame.
#[unsafe(no_mangle)]
#[inline(never)]
fn start_picture(picture: &mut Option<Picture>) {
    *picture = Some(COLUMNS.picture(&COLUMNS_VIEW));
}

/// And for each column; a display's driver would send it from here.
#[unsafe(no_mangle)]
#[inline(never)]
fn render_column(picture: &Picture, x: u32, column: &mut Column) {
    for (pixel, color) in column.iter_mut().zip(picture.pixels(x)) {
        *pixel = color;
    }
}

whitted_firmware::entry!({
    let mut column = [COLUMNS.floor; COLUMNS_VIEW.height as usize];
    whitted_firmware::draw_columns(
        COLUMNS_VIEW.width,
        || {
            let mut picture = None;
            start_picture(&mut picture);
            black_box(picture)
        },
        |picture, x| {
            if let Some(picture) = picture {
                render_column(picture, x, black_box(&mut column));
            }
            column
        },
    );
});
