//! Spheres, a plane and a box of which a sphere is taken away.
#![no_std]
#![no_main]

whitted_firmware::program!(whitted_firmware::scenes::ladder::WithSolid);
