//! Runs methods of the lab, each within a function of its own, to be counted there.
//!
//! Function `slot_7` is what the lab's `price::all` shows eighth.

#![no_std]
#![no_main]

mod slots;

use slots::Slots;
use whitted_methods::price;

whitted_firmware::entry!({
    let mut slots = Slots::new();
    price::all(&mut slots);
    slots.report();
});
