//! Spheres, a plane and a quadric.
#![no_std]
#![no_main]

whitted_firmware::program!(whitted_firmware::scenes::ladder::WithQuadric);
