//! The method lab: every method of every stage over sweeps of difficulty, against exact answers.

pub mod cuboid;
pub mod frustum;
pub mod plane;
pub mod polygon;
pub mod random;
pub mod sphere;
pub mod sweep;
pub mod tally;

use whitted::Ray;

use crate::exact::Line;

/// A ray as the oracle takes it.
fn line(ray: &Ray) -> Line {
    Line {
        origin: ray.origin.to_array(),
        direction: ray.direction.to_array(),
    }
}
