//! Spheres and a plane, a mirror, and glass that colors light.
#![no_std]
#![no_main]

whitted_firmware::program!(whitted_firmware::scenes::paints::TintedGlass);
