//! Runs every method of the lab, each within a function of its own, to be counted there.
//!
//! Function `slot_7` is what the lab's `price::all` shows eighth.

#![no_std]
#![no_main]

mod slots;

use slots::Slots;
use whitted_methods::price::{self, Entry, Meter};

/// Runs each entry in the next slot.
struct InSlots(Slots);

impl Meter for InSlots {
    #[inline(never)]
    fn measure(&mut self, _: Entry, mut run: impl FnMut()) {
        self.0.run(&mut run);
    }
}

whitted_firmware::entry!({
    let mut slots = InSlots(Slots::new());
    price::all(&mut slots);
    slots.0.report();
});
