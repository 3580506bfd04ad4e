//! A primitive that `core` does not have.
#![no_std]
#![no_main]

whitted_firmware::program!(whitted_firmware::scenes::outside::Rings);
