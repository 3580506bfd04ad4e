//! Oracles, lab and benchmarks of whitted.
