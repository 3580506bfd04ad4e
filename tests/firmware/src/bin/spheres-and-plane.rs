//! Spheres and a plane that mirror and refract.
#![no_std]
#![no_main]

whitted_firmware::program!(whitted_firmware::scenes::ladder::SpheresAndPlane);
