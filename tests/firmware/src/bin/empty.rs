//! Draws nothing: what the others are compared with.
#![no_std]
#![no_main]

whitted_firmware::program!(whitted_firmware::scenes::Empty);
