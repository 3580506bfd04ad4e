//! What the firmware costs on bare targets: built by `tests/embedded.sh`, run in QEMU, counted,
//! priced, bounded, and compared with the host.

pub mod baked;
pub mod chart;
pub mod columns;
pub mod copy;
pub mod cortex_m4;
pub mod expected;
pub mod firmware;
pub mod hierarchy;
pub mod image;
pub mod instructions;
pub mod measure;
pub mod profile;
pub mod run;
pub mod stack;
pub mod target;

#[path = "../firmware/scenes/mod.rs"]
pub mod scenes;
