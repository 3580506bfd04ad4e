//! Spheres and a plane under a light that casts soft shadows.
#![no_std]
#![no_main]

whitted_firmware::program!(whitted_firmware::scenes::ladder::Soft);
