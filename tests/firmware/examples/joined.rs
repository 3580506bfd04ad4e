//! Runs those methods of the lab that join others, each within a function of its own, to be counted there.
//!
//! Function `slot_7` is what the lab's `price::joined` shows eighth.

#![no_std]
#![no_main]

mod slots;

use slots::Slots;
use whitted_methods::price;

whitted_firmware::entry!({
    let mut slots = Slots::new();
    price::joined(&mut slots);
    slots.report();
});
