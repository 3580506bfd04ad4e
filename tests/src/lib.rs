//! Oracles, lab and benchmarks of whitted.

pub mod comparison;
pub mod embedded;
pub mod exact;
pub mod lab;
pub mod reference;

/// The code in the README.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
pub mod readme {}
