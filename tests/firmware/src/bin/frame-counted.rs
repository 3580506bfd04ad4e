//! A baked scene alone.
#![no_std]
#![no_main]

whitted_firmware::program!(whitted_firmware::baked::counted::scene::Baked);
