//! What is measured: something that answers about rays.

use whitted::Ray;

use crate::workload::{Answer, Shapes};

/// A ray caster with a scene in it.
pub trait Peer {
    /// Its name, and that of the mode.
    fn name(&self) -> String;

    /// Answers about every ray.
    fn nearest(&self, rays: &[Ray], answers: &mut [Answer]);

    /// Says of every ray whether it hits anything.
    fn any(&self, rays: &[Ray], answers: &mut [bool]);
}

/// How a peer takes a scene; `Err` says why it does not.
pub type Builder = for<'a> fn(&'a Shapes) -> Result<Box<dyn Peer + 'a>, String>;

/// A peer's hit may lie a little off the surface; shadow rays of peers, which do not know the surface
/// that they leave, start so far beyond it.
pub const START: f32 = 1e-4;
