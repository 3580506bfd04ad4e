//! Spheres and a plane under an image.
#![no_std]
#![no_main]

whitted_firmware::program!(whitted_firmware::scenes::paints::Textured);
