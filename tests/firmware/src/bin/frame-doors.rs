//! A map with doors by columns, as `frame-columns`.
#![no_std]
#![no_main]

use whitted::grid::DoorGrid;
use whitted_firmware::scenes::castle::{COLUMNS_WITH_DOORS, VIEW_OF_DOORS};

whitted_firmware::columns_program!(COLUMNS_WITH_DOORS, VIEW_OF_DOORS, 2, u8, DoorGrid<'static>);
