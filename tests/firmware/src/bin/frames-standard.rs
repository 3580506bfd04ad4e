//! Baked standard scenes, drawn in all ways.
#![no_std]
#![no_main]

whitted_firmware::entry!({
    whitted_firmware::frames(|frames| whitted_firmware::baked::standard::visit_all(frames));
});
