//! Four spheres and a floor after tinyraytracer.
#![no_std]
#![no_main]

whitted_firmware::program!(whitted_firmware::scenes::layouts::Tiny);
