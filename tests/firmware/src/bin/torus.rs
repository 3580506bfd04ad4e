//! Spheres, a plane and a torus.
#![no_std]
#![no_main]

whitted_firmware::program!(whitted_firmware::scenes::ladder::WithTorus);
