//! Spheres and a plane with adaptive anti-aliasing.
#![no_std]
#![no_main]

whitted_firmware::program!(whitted_firmware::scenes::ladder::Smooth);
