//! Oracles, lab and benchmarks of whitted.

pub mod comparison;
pub mod embedded;
pub mod reference;
