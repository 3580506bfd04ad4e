//! The `whitted` program.
fn main() {}
