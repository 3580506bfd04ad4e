//! Oracles, lab and benchmarks of whitted.

pub mod reference;
