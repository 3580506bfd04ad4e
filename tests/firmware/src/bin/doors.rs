//! A map with doors and textures, traced.
#![no_std]
#![no_main]

whitted_firmware::program!(whitted_firmware::scenes::castle::WithDoors);
