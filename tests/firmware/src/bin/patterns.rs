//! Spheres and a plane in a checker and stripes.
#![no_std]
#![no_main]

whitted_firmware::program!(whitted_firmware::scenes::paints::Patterns);
