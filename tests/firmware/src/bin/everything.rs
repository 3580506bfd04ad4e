//! And all there is besides.
#![no_std]
#![no_main]

whitted_firmware::program!(whitted_firmware::scenes::ladder::Everything);
