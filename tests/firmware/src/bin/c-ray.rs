//! Four spheres after c-ray.
#![no_std]
#![no_main]

whitted_firmware::program!(whitted_firmware::scenes::layouts::CRay);
