//! Spheres, a plane and a sphere that is placed twice.
#![no_std]
#![no_main]

whitted_firmware::program!(whitted_firmware::scenes::ladder::WithInstances);
