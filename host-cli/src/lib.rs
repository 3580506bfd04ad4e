//! The host side of whitted.
