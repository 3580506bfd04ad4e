//! What a query computes of a ray once, before it meets the first object.
//!
//! These are scalars, spread over lanes where they are used: a load does that for nothing, where
//! vectors that live through a whole query would have to be put aside.
//!
//! No closures and no combinators here and in the kernels: what handles vectors has to be inlined
//! into a function that is compiled for their instructions, and only `#[inline(always)]` makes sure.

use glam::Vec3;
use whitted::Ray;

/// Boxes are met by products with reciprocals, which are not to be infinite times zero: from what size on
/// a direction's component has one.
pub const INVERTIBLE: f32 = 4.0 / f32::MAX;

/// A ray and what kernels need to know of it.
#[derive(Clone, Copy)]
pub struct RayTerms<'a> {
    pub ray: &'a Ray,
    pub turned: Turned,
    /// The reciprocals of the direction's components.
    pub reciprocal: Vec3,
}

/// A ray on other axes: the last is the one along which it goes fastest.
#[derive(Clone, Copy)]
pub struct Turned {
    /// Which ones.
    pub axes: [usize; 3],
    pub origin: Vec3,
    pub direction: Vec3,
}

/// Which terms anything will ask for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    pub turned: bool,
    pub reciprocal: bool,
}

impl<'a> RayTerms<'a> {
    #[inline(always)]
    pub fn new(ray: &'a Ray, needs: Needs) -> Self {
        Self {
            ray,
            turned: if needs.turned {
                Turned::new(ray)
            } else {
                Turned {
                    axes: [0; 3],
                    origin: Vec3::ZERO,
                    direction: Vec3::ZERO,
                }
            },
            reciprocal: if needs.reciprocal {
                ray.direction.recip()
            } else {
                Vec3::ZERO
            },
        }
    }
}

impl Turned {
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let (o, d) = (ray.origin, ray.direction);
        match fastest(d) {
            0 => Self {
                axes: [1, 2, 0],
                origin: Vec3::new(o.y, o.z, o.x),
                direction: Vec3::new(d.y, d.z, d.x),
            },
            1 => Self {
                axes: [0, 2, 1],
                origin: Vec3::new(o.x, o.z, o.y),
                direction: Vec3::new(d.x, d.z, d.y),
            },
            _ => Self {
                axes: [0, 1, 2],
                origin: o,
                direction: d,
            },
        }
    }
}

/// The axis along which a direction goes furthest; of equal ones the last.
#[inline(always)]
pub fn fastest(direction: Vec3) -> usize {
    let size = direction.abs();
    if size.x > size.y && size.x > size.z {
        0
    } else if size.y > size.z {
        1
    } else {
        2
    }
}
