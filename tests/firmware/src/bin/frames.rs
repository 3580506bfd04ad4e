//! Many frames, drawn in all ways.
#![no_std]
#![no_main]

whitted_firmware::entry!({
    whitted_firmware::frames(|frames| whitted_firmware::scenes::visit_varied(frames));
});
