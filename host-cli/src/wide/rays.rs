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

/// For each axis, all of them with that one last.
pub const AXES: [[usize; 3]; 3] = [[1, 2, 0], [0, 2, 1], [0, 1, 2]];

impl Turned {
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        // By a table, not by branches: where rays go all ways, those would be mispredicted.
        let axes = AXES[fastest(ray.direction)];
        let [x, y, z] = axes;
        let (o, d) = (ray.origin.to_array(), ray.direction.to_array());
        Self {
            axes,
            origin: Vec3::new(o[x], o[y], o[z]),
            direction: Vec3::new(d[x], d[y], d[z]),
        }
    }
}

/// The axis along which a direction goes furthest; of equal ones the last.
#[inline(always)]
pub fn fastest(direction: Vec3) -> usize {
    let size = direction.abs();
    let along_x = (size.x > size.y) & (size.x > size.z);
    // No branch: see `Turned::new`.
    usize::from(!along_x) * (2 - usize::from(size.y > size.z))
}
