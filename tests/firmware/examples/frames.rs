//! Draws the lab's frame in every setting, each within a function of its own, to be counted there.
//!
//! Function `slot_7` is the eighth of the lab's `frames::settings`.

#![no_std]
#![no_main]

mod slots;

use core::hint::black_box;

use slots::Slots;
use whitted_methods::frames::{PRICED, checksum, settings};

whitted_firmware::entry!({
    let mut slots = Slots::new();
    for setting in settings() {
        slots.run(&mut || {
            black_box(setting).draw(&PRICED, &mut |color| {
                black_box(color);
            });
        });
    }
    slots.report();
    whitted_firmware::report("frames", checksum());
});
