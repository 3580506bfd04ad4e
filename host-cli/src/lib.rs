//! The host side of whitted.

pub mod scene;
pub mod scene_file;
