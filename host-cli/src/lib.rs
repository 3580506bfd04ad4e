//! The host side of whitted: scene files, pictures, and the commands of the `whitted` program.
//!
//! What is rendered and cast is [`whitted`], the same code that firmware links. This crate reads
//! [scene files](scene_file) into the [type that names everything](scene), [renders](render) on all
//! cores, and writes [pictures](picture) to files that are [replaced whole or not at all](output).

pub mod args;
pub mod bake;
pub mod cast;
pub mod commands;
pub mod compare;
pub mod hierarchy;
pub mod inspect;
pub mod map;
pub mod output;
pub mod paint;
pub mod picture;
pub mod render;
pub mod scene;
pub mod scene_file;
pub mod whole;
pub mod wide;
