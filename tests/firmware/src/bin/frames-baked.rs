//! Our baked scenes, drawn in all ways.
#![no_std]
#![no_main]

whitted_firmware::entry!({
    whitted_firmware::frames(|frames| whitted_firmware::baked::own::visit_all(frames));
});
