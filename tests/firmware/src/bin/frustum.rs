//! And a frustum.
#![no_std]
#![no_main]

whitted_firmware::program!(whitted_firmware::scenes::ladder::WithFrustum);
