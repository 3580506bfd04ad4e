//! Functions by number, for the tools to count in.

use core::hint::black_box;

use whitted_methods::price::{Entry, Meter};

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

/// Runs one thing after the other, each in the next slot: the eighth in `slot_7`.
pub struct Slots(usize);

impl Slots {
    /// Before the first.
    pub const fn new() -> Self {
        Self(0)
    }

    /// Calls `run` in the next slot.
    #[inline(never)]
    pub fn run(&mut self, run: &mut dyn FnMut()) {
        if let Some(slot) = SLOTS.get(self.0) {
            slot(run);
        }
        // After the call, so that the slot returns to here: the end of what is counted.
        self.0 = black_box(self.0 + 1);
    }

    /// Reports how many there were.
    pub fn report(&self) {
        whitted_firmware::report("entries", self.0 as u64);
    }
}

/// Runs each entry in the next slot.
impl Meter for Slots {
    #[inline(never)]
    fn measure(&mut self, _: Entry, mut run: impl FnMut()) {
        self.run(&mut run);
    }
}
