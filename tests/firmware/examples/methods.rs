//! Runs every method of the lab, each within a function of its own, to be counted there.
//!
//! Function `slot_7` is what the lab's `price::all` shows eighth.

#![no_std]
#![no_main]

use core::hint::black_box;

use whitted_methods::price::{self, Entry, Meter};

type Slot = fn(run: &mut dyn FnMut());

seq_macro::seq!(N in 0..256 {
    #(
        #[unsafe(no_mangle)]
        #[inline(never)]
        fn slot_~N(run: &mut dyn FnMut()) {
            // No two are alike, or the compiler makes one of them.
            black_box(N);
            run();
        }
    )*

    static SLOTS: [Slot; 256] = [#(slot_~N,)*];
});

/// Runs each entry in the next slot.
struct Slots(usize);

impl Meter for Slots {
    #[inline(never)]
    fn measure(&mut self, _: Entry, mut run: impl FnMut()) {
        if let Some(slot) = SLOTS.get(self.0) {
            slot(&mut run);
        }
        // After the call, so that the slot returns to here: the end of what is counted.
        self.0 = black_box(self.0 + 1);
    }
}

whitted_firmware::entry!({
    let mut slots = Slots(0);
    price::all(&mut slots);
    whitted_firmware::report("entries", slots.0 as u64);
});
