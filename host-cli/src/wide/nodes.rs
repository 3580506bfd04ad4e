//! Wide nodes, and what a ray computes once to meet them.

use fearless_simd::{Simd, SimdMask};
use whitted::Ray;

use super::blocks::Kind;
use super::bounds::{Bounds, FAR, ROUNDING};
use super::lanes::Lanes;

/// `N` boxes and what is in them: 28 bytes a child.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct Node<const N: usize> {
    /// For each axis the lower and the upper bounds; crossed where there is no child.
    planes: [[[f32; N]; 2]; 3],
    pub children: [Child; N],
}

/// What a box holds: another node, or one block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub struct Child(u32);

/// A [`Child`], unpacked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    Node(usize),
    Block(Kind, usize),
}

impl Child {
    const BLOCK: u32 = 1 << 31;
    const KIND: u32 = 28;
    /// More nodes, or more blocks of a kind, cannot be told apart.
    pub const LIMIT: usize = 1 << Self::KIND;

    pub fn node(index: usize) -> Self {
        assert!(index < Self::LIMIT, "2^28 nodes are more than memory holds");
        Self(index as u32)
    }

    pub fn block(kind: Kind, index: usize) -> Self {
        assert!(
            index < Self::LIMIT,
            "2^28 blocks are more than memory holds"
        );
        Self(Self::BLOCK | (kind as u32) << Self::KIND | index as u32)
    }

    #[inline(always)]
    pub fn content(self) -> Content {
        if self.0 & Self::BLOCK == 0 {
            Content::Node(self.0 as usize)
        } else {
            let kind = Kind::ALL[(self.0 >> Self::KIND) as usize & 7];
            Content::Block(kind, self.0 as usize & (Self::LIMIT - 1))
        }
    }
}

impl<const N: usize> Node<N> {
    /// No box is met, whatever the ray.
    pub const EMPTY: Self = Self {
        planes: [[[f32::INFINITY; N], [f32::NEG_INFINITY; N]]; 3],
        children: [Child(0); N],
    };

    pub fn set(&mut self, lane: usize, bounds: &Bounds, child: Child) {
        for (axis, [min, max]) in self.planes.iter_mut().enumerate() {
            min[lane] = bounds.min[axis];
            max[lane] = bounds.max[axis];
        }
        self.children[lane] = child;
    }

    /// Where the ray enters each box, and a bit for each box that it meets before `limit`.
    #[inline(always)]
    pub fn meet<S: Simd, V: Lanes<S>>(&self, simd: S, ray: &NodeRay<V>, limit: V) -> (V, u32) {
        let near = |axis: usize| {
            V::from_slice(simd, &self.planes[axis][usize::from(ray.down[axis])])
                .mul_sub(ray.reciprocal[axis], ray.near[axis])
        };
        let far = |axis: usize| {
            V::from_slice(simd, &self.planes[axis][usize::from(!ray.down[axis])])
                .mul_sub(ray.reciprocal[axis], ray.far[axis])
        };
        let zero = V::simd_from(simd, 0.0);
        let entry = larger(larger(near(0), near(1)), larger(near(2), zero));
        let exit = smaller(smaller(far(0), far(1)), smaller(far(2), limit));
        (entry, entry.simd_le(exit).to_bitmask() as u32)
    }
}

#[inline(always)]
fn larger<S: Simd, V: Lanes<S>>(a: V, b: V) -> V {
    a.max(b)
}

#[inline(always)]
fn smaller<S: Simd, V: Lanes<S>>(a: V, b: V) -> V {
    a.min(b)
}

/// The terms with which a ray meets boxes: distances are `plane * reciprocal - near` and
/// `plane * reciprocal - far`, the latter two moved apart by what rounding may do to hits.
#[derive(Clone, Copy)]
pub struct NodeRay<V> {
    down: [bool; 3],
    reciprocal: [V; 3],
    near: [V; 3],
    far: [V; 3],
}

impl<V: Copy> NodeRay<V> {
    /// `slack` is how many coordinates of the origin hits may lie outside the boxes.
    #[inline(always)]
    pub fn new<S: Simd>(simd: S, ray: &Ray, slack: f32) -> Self
    where
        V: Lanes<S>,
    {
        let (o, d) = (ray.origin, ray.direction);
        let slack = slack * o.abs().max_element();
        // In a direction of which there is next to nothing, the ray stays between two planes or
        // outside of them, for all distances that occur.
        const STEEPEST: f32 = FAR;
        let reciprocal = [d.x, d.y, d.z].map(|x| {
            if x.abs() < 1.0 / STEEPEST {
                STEEPEST.copysign(x)
            } else {
                1.0 / x
            }
        });
        let terms = |sign: f32| {
            [0, 1, 2].map(|axis| {
                let r: f32 = reciprocal[axis];
                V::simd_from(simd, o[axis] * r + sign * slack * r.abs())
            })
        };
        Self {
            down: reciprocal.map(|r| r < 0.0),
            reciprocal: reciprocal.map(|r| V::simd_from(simd, r)),
            near: terms(1.0),
            far: terms(-1.0),
        }
    }
}

/// Whether boxes decide rightly about a ray: its direction has unit length, and its numbers are
/// neither beyond the range of products nor, where they are not zero, of reciprocals.
#[inline(always)]
pub fn is_regular(ray: &Ray) -> bool {
    let (o, d) = (ray.origin.abs(), ray.direction.abs());
    let unit = (d.length_squared() - 1.0).abs() < ROUNDING;
    let invertible = |x: f32| x == 0.0 || x > 1.0 / (f32::MAX / 4.0);
    // Also false for NaN.
    unit && o.max_element() < FAR
        && o.x + o.y + o.z < f32::INFINITY
        && invertible(d.x)
        && invertible(d.y)
        && invertible(d.z)
}
