//! Six spheres over a checkered plane.
#![no_std]
#![no_main]

whitted_firmware::program!(whitted_firmware::scenes::layouts::SixSpheres);
