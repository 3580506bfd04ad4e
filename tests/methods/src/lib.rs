//! Methods for every stage of a ray caster, those of `whitted` among them, to be compared.
//!
//! Each is a plain `f32` function written from the paper that it cites: the lab (`whitted-tests`,
//! binary `lab`) measures what it gets wrong, on the host; a firmware prices it on the part. Both run
//! this code, and [`price`] gives both the same inputs. `no_std`, no heap.
//!
//! A stage is a module with a table of its [`Method`]s: adding a method is a function and a line of
//! the table. What a ray needs once for all primitives of a kind is prepared outside of the methods
//! and priced as a stage of its own.
#![no_std]
#![forbid(unsafe_code)]

pub mod checker;
pub mod compensated;
pub mod cuboid;
pub mod frames;
pub mod frustum;
pub mod grid;
pub mod instance;
pub mod plane;
pub mod polygon;
pub mod power;
pub mod price;
pub mod quadric;
pub mod roots;
pub mod secondary;
pub mod solid;
pub mod sphere;
pub mod torus;
pub mod triangle;

/// A function that answers a stage's question, by name.
#[derive(Clone, Copy, Debug)]
pub struct Method<F> {
    /// As in the charts and in `cycles.csv`.
    pub name: &'static str,
    /// The function.
    pub run: F,
}

impl<F> Method<F> {
    /// A method of this name.
    pub const fn new(name: &'static str, run: F) -> Self {
        Self { name, run }
    }
}

/// The nearer of two distances, `near <= far`, that the ray admits.
#[inline(always)]
fn nearest(ray: &whitted::Ray, near: f32, far: f32) -> Option<f32> {
    if ray.admits(near) {
        Some(near)
    } else {
        ray.admitted(far)
    }
}
