//! A map by columns. Not a frame like the others: its pixels are those of a display, column by column.
#![no_std]
#![no_main]

use whitted_firmware::scenes::castle::{COLUMNS, COLUMNS_VIEW};

whitted_firmware::columns_program!(COLUMNS, COLUMNS_VIEW, 2);
