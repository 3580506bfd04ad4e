//! What a query computes of a ray once, before it meets the first object.

use fearless_simd::Simd;
use glam::Vec3;
use whitted::Ray;

use super::lanes::{Lanes, Vectors};

/// A ray, the same in every lane.
#[derive(Clone, Copy)]
pub struct RayLanes<V> {
    pub origin: Vectors<V>,
    pub direction: Vectors<V>,
    pub shear: Shear<V>,
    pub slabs: [Slab<V>; 3],
}

/// The shear that turns the ray into an axis, as `whitted::shape::polygon::Shear`, without its
/// multiplications by one and by zero.
#[derive(Clone, Copy)]
pub struct Shear<V> {
    /// The two axes that are sheared and the one, along which the ray goes fastest, that they are
    /// sheared by.
    pub axes: [usize; 3],
    /// The origin's coordinates on these axes.
    pub origin: [V; 3],
    /// How far each of the first two axes moves along the third.
    pub slope: [V; 2],
}

/// How a ray crosses the space between two planes across an axis.
#[derive(Clone, Copy)]
pub struct Slab<V> {
    pub way: Way,
    pub origin: V,
    pub reciprocal: V,
}

/// Along an axis.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Way {
    Up,
    Down,
    /// Exactly across it.
    Across,
}

/// Which of a [`RayLanes`]'s terms anything will ask for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    pub shear: bool,
    pub slabs: bool,
}

impl<V: Copy> RayLanes<V> {
    #[inline(always)]
    pub fn new<S: Simd>(simd: S, ray: &Ray, needs: Needs) -> Self
    where
        V: Lanes<S>,
    {
        let origin = Vectors::splat(simd, ray.origin);
        let zero = V::simd_from(simd, 0.0);
        Self {
            origin,
            direction: Vectors::splat(simd, ray.direction),
            shear: if needs.shear {
                Shear::new(simd, ray)
            } else {
                Shear {
                    axes: [0; 3],
                    origin: [zero; 3],
                    slope: [zero; 2],
                }
            },
            slabs: if needs.slabs {
                let reciprocal = ray.direction.recip();
                [0, 1, 2].map(|axis| Slab {
                    way: Way::of(ray.direction[axis]),
                    origin: V::simd_from(simd, ray.origin[axis]),
                    reciprocal: V::simd_from(simd, reciprocal[axis]),
                })
            } else {
                [Slab {
                    way: Way::Across,
                    origin: zero,
                    reciprocal: zero,
                }; 3]
            },
        }
    }
}

impl Way {
    #[inline(always)]
    fn of(x: f32) -> Self {
        if x > 0.0 {
            Self::Up
        } else if x < 0.0 {
            Self::Down
        } else {
            Self::Across
        }
    }
}

impl<V: Copy> Shear<V> {
    #[inline(always)]
    fn new<S: Simd>(simd: S, ray: &Ray) -> Self
    where
        V: Lanes<S>,
    {
        let (o, d) = (ray.origin, ray.direction);
        let (axes, o, d) = match steepest(d) {
            0 => (
                [1, 2, 0],
                Vec3::new(o.y, o.z, o.x),
                Vec3::new(d.y, d.z, d.x),
            ),
            1 => (
                [0, 2, 1],
                Vec3::new(o.x, o.z, o.y),
                Vec3::new(d.x, d.z, d.y),
            ),
            _ => ([0, 1, 2], o, d),
        };
        Self {
            axes,
            origin: o.to_array().map(|x| V::simd_from(simd, x)),
            slope: [-d.x / d.z, -d.y / d.z].map(|x| V::simd_from(simd, x)),
        }
    }

    /// Where points go in the plane across the ray, from a row a coordinate.
    #[inline(always)]
    pub fn apply<S: Simd, const N: usize>(&self, simd: S, rows: &[[f32; N]; 4]) -> [V; 2]
    where
        V: Lanes<S>,
    {
        let [x, y, z] = [0, 1, 2].map(|i| {
            // The mask says to the compiler what it cannot see: that this is one of the rows.
            V::from_slice(simd, &rows[self.axes[i] & 3]) - self.origin[i]
        });
        [x + z * self.slope[0], y + z * self.slope[1]]
    }
}

/// The axis along which a direction goes furthest; of equal ones the last.
#[inline(always)]
fn steepest(direction: Vec3) -> usize {
    let size = direction.abs();
    if size.x > size.y && size.x > size.z {
        0
    } else if size.y > size.z {
        1
    } else {
        2
    }
}
