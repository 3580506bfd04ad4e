//! Wide nodes, and what a ray computes once to meet them.

use fearless_simd::{Simd, SimdMask};
use whitted::{Ray, Vec3};

use super::blocks::Kind;
use super::bounds::{Bounds, FAR, ROUNDING};
use super::lanes::{Lanes, Vectors};
use super::rays::fastest;
use super::tree::Search;

/// `N` boxes and what is in them: 32 bytes a child.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct Node<const N: usize> {
    /// For each axis the lower and the upper bounds; crossed where there is no child.
    planes: [[[f32; N]; 2]; 3],
    /// How far from each box a hit may be reported: see [`bounds`](super::bounds).
    spread: [f32; N],
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
    const KIND: u32 = 27;
    /// More nodes, or more blocks of a kind, cannot be told apart.
    pub const LIMIT: usize = 1 << Self::KIND;

    pub fn node(index: usize) -> Self {
        assert!(index < Self::LIMIT, "2^27 nodes are more than memory holds");
        Self(index as u32)
    }

    pub fn block(kind: Kind, index: usize) -> Self {
        assert!(
            index < Self::LIMIT,
            "2^27 blocks are more than memory holds"
        );
        Self(Self::BLOCK | (kind as u32) << Self::KIND | index as u32)
    }

    /// What a box holds and its distance, which is not negative, as one number: the less, the nearer.
    #[inline(always)]
    pub fn at(self, entry: f32) -> i64 {
        // Of such numbers the bits are in order, and those of -0 before all.
        i64::from(entry.to_bits() as i32) << 32 | i64::from(self.0)
    }

    /// The last of all that are no farther than a distance above zero.
    #[inline(always)]
    pub fn last_at(distance: f32) -> i64 {
        Self(u32::MAX).at(distance)
    }

    /// What a box holds again.
    #[inline(always)]
    pub fn of(place: i64) -> Self {
        Self(place as u32)
    }

    #[inline(always)]
    pub fn content(self) -> Content {
        if self.0 & Self::BLOCK == 0 {
            Content::Node(self.0 as usize)
        } else {
            let kind = Kind::of(self.0 >> Self::KIND & 15);
            Content::Block(kind, self.0 as usize & (Self::LIMIT - 1))
        }
    }
}

impl<const N: usize> Node<N> {
    /// No box is met, whatever the ray.
    pub const EMPTY: Self = Self {
        planes: [[[f32::INFINITY; N], [f32::NEG_INFINITY; N]]; 3],
        spread: [0.0; N],
        children: [Child(0); N],
    };

    pub fn set(&mut self, lane: usize, bounds: &Bounds, spread: f32, child: Child) {
        for (axis, [min, max]) in self.planes.iter_mut().enumerate() {
            min[lane] = bounds.min[axis];
            max[lane] = bounds.max[axis];
        }
        self.spread[lane] = spread;
        self.children[lane] = child;
    }

    /// A distance before which the ray meets nothing in each box, and a bit for each box in which it may
    /// meet something up to `limit`.
    ///
    /// As `SEARCH` says, all is met where its box is, or hits of outlines are [spread](super::bounds).
    #[inline(always)]
    pub fn meet<S: Simd, V: Lanes<S>, const SEARCH: u8>(
        &self,
        simd: S,
        terms: &NodeTerms,
        limit: f32,
    ) -> (V, u32) {
        let [x, y, z] = &self.planes;
        let x = terms.x.meet(simd, x);
        let y = terms.y.meet(simd, y);
        let z = terms.z.meet(simd, z);
        let spread = || V::from_slice(simd, &self.spread);
        let limit = V::simd_from(simd, limit);
        met::<S, V, SEARCH>(simd, [x, y, z], terms.axis, spread, limit)
    }

    /// The box round all of its boxes.
    pub fn bounds(&self) -> [Vec3; 2] {
        let least = |row: &[f32; N]| row.iter().copied().fold(f32::INFINITY, f32::min);
        let most = |row: &[f32; N]| row.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        [
            Vec3::from_array(self.planes.each_ref().map(|[low, _]| least(low))),
            Vec3::from_array(self.planes.each_ref().map(|[_, high]| most(high))),
        ]
    }

    /// For each axis the lower and the upper bounds.
    #[inline(always)]
    pub fn planes(&self) -> &[[[f32; N]; 2]; 3] {
        &self.planes
    }

    /// How far from each box a hit may be reported.
    #[inline(always)]
    pub fn spread(&self) -> &[f32; N] {
        &self.spread
    }
}

/// What [`Node::meet`] returns, from where each axis' planes are entered and left.
#[inline(always)]
pub fn met<S: Simd, V: Lanes<S>, const SEARCH: u8>(
    simd: S,
    [x, y, z]: [(V, V); 3],
    axis: usize,
    spread: impl FnOnce() -> V,
    limit: V,
) -> (V, u32) {
    let zero = V::simd_from(simd, 0.0);
    // In pairs: what is not needed at once does not wait for each other.
    let (entry, exit) = (x.0.max(y.0), x.1.min(y.1));
    if SEARCH == Search::SolidBoxes as u8 {
        let (entry, exit) = (entry.max(z.0.max(zero)), exit.min(z.1.min(limit)));
        return (entry, entry.simd_le(exit).to_bitmask() as u32);
    }
    let (entry, exit) = (entry.max(z.0), exit.min(z.1));
    let (near, far) = match axis {
        0 => x,
        1 => y,
        _ => z,
    };
    let spread = spread();
    let near = (entry - spread).max(near.max(zero));
    // Of what is no number, as a limit may be, the last one.
    let far = (exit + spread).min(far.min(limit));
    let met = entry.simd_le(exit) & near.simd_le(far);
    (near, met.to_bitmask() as u32)
}

/// The terms with which a ray meets boxes.
#[derive(Clone, Copy)]
pub struct NodeTerms {
    x: SlabTerms,
    y: SlabTerms,
    z: SlabTerms,
    /// To which the ray is closest.
    axis: usize,
}

/// The terms for planes across an axis: distances are `plane * reciprocal - near` and
/// `plane * reciprocal - far`, the latter two moved apart by what rounding may do to hits.
#[derive(Clone, Copy)]
struct SlabTerms {
    down: bool,
    reciprocal: f32,
    near: f32,
    far: f32,
}

impl NodeTerms {
    /// `slack` is how many coordinates of the origin hits may lie outside the boxes.
    #[inline(always)]
    pub fn new(ray: &Ray, slack: f32) -> Self {
        let (o, d) = (ray.origin, ray.direction);
        let slack = slack * reach(ray);
        Self {
            x: SlabTerms::new(o.x, d.x, slack),
            y: SlabTerms::new(o.y, d.y, slack),
            z: SlabTerms::new(o.z, d.z, slack),
            axis: fastest(d),
        }
    }
}

/// At least the greatest coordinate of a ray's origin.
#[inline(always)]
fn reach(ray: &Ray) -> f32 {
    let size = ray.origin.abs();
    size.x + size.y + size.z
}

/// As [`NodeTerms`], a ray a lane.
pub struct NodeTermsOfEach<const N: usize> {
    /// For each axis the reciprocals, and what is to be taken off where planes are near and far.
    axes: [[[f32; N]; 3]; 3],
}

impl<const N: usize> NodeTermsOfEach<N> {
    /// From the terms of each axis.
    #[inline(always)]
    pub fn new<S: Simd, V: Lanes<S>>(terms: &[SlabTermsOfEach<V>; 3]) -> Self {
        let mut axes = [[[0.0; N]; 3]; 3];
        for (rows, terms) in axes.iter_mut().zip(terms) {
            terms.reciprocal.store_slice(&mut rows[0]);
            terms.near.store_slice(&mut rows[1]);
            terms.far.store_slice(&mut rows[2]);
        }
        Self { axes }
    }

    /// The terms of one.
    #[inline(always)]
    pub fn get(&self, lane: usize, direction: Vec3) -> NodeTerms {
        let [x, y, z] = &self.axes;
        let terms = |[reciprocal, near, far]: &[[f32; N]; 3]| SlabTerms {
            down: reciprocal[lane] < 0.0,
            reciprocal: reciprocal[lane],
            near: near[lane],
            far: far[lane],
        };
        NodeTerms {
            x: terms(x),
            y: terms(y),
            z: terms(z),
            axis: fastest(direction),
        }
    }
}

/// As [`SlabTerms`], a ray a lane.
#[derive(Clone, Copy)]
pub struct SlabTermsOfEach<V> {
    pub reciprocal: V,
    pub near: V,
    pub far: V,
}

impl<V: Copy> SlabTermsOfEach<V> {
    /// Across each axis; `slack` is that of [`NodeTerms::new`].
    #[inline(always)]
    pub fn of_axes<S: Simd>(
        simd: S,
        origin: Vectors<V>,
        direction: Vectors<V>,
        slack: f32,
    ) -> [Self; 3]
    where
        V: Lanes<S>,
    {
        let slack = (origin.x.abs() + origin.y.abs() + origin.z.abs()) * V::simd_from(simd, slack);
        [
            Self::new(simd, origin.x, direction.x, slack),
            Self::new(simd, origin.y, direction.y, slack),
            Self::new(simd, origin.z, direction.z, slack),
        ]
    }

    /// As [`SlabTerms::new`].
    #[inline(always)]
    fn new<S: Simd>(simd: S, origin: V, direction: V, slack: V) -> Self
    where
        V: Lanes<S>,
    {
        // As there: no infinite reciprocals.
        let reciprocal = (V::simd_from(simd, 1.0) / direction)
            .max(V::simd_from(simd, -FAR))
            .min(V::simd_from(simd, FAR));
        let (start, moved) = (origin * reciprocal, reciprocal.abs() * slack);
        Self {
            reciprocal,
            near: start + moved,
            far: start - moved,
        }
    }

    /// Where each ray enters the space between two planes, and where it leaves it: of each, the plane that
    /// it comes to first is given first.
    #[inline(always)]
    pub fn meet<S: Simd>(&self, near: V, far: V) -> (V, V)
    where
        V: Lanes<S>,
    {
        (
            near.mul_sub(self.reciprocal, self.near),
            far.mul_sub(self.reciprocal, self.far),
        )
    }
}

impl SlabTerms {
    #[inline(always)]
    fn new(origin: f32, direction: f32, slack: f32) -> Self {
        // In a direction of which there is next to nothing, the ray stays between two planes or
        // outside of them, for all distances that occur.
        let reciprocal = (1.0 / direction).clamp(-FAR, FAR);
        let (start, moved) = (origin * reciprocal, reciprocal.abs() * slack);
        Self {
            down: reciprocal < 0.0,
            reciprocal,
            near: start + moved,
            far: start - moved,
        }
    }

    /// Where the ray enters the space between planes, and where it leaves it.
    #[inline(always)]
    fn meet<S: Simd, V: Lanes<S>, const N: usize>(
        &self,
        simd: S,
        planes: &[[f32; N]; 2],
    ) -> (V, V) {
        let near = V::from_slice(simd, &planes[usize::from(self.down)]);
        let far = V::from_slice(simd, &planes[usize::from(!self.down)]);
        let reciprocal = V::simd_from(simd, self.reciprocal);
        (
            near.mul_sub(reciprocal, V::simd_from(simd, self.near)),
            far.mul_sub(reciprocal, V::simd_from(simd, self.far)),
        )
    }
}

/// Whether boxes decide rightly about a ray: its direction has unit length, and its origin is within
/// the range of products.
#[inline(always)]
pub fn is_regular(ray: &Ray) -> bool {
    // Also false for NaN.
    ((ray.direction.length_squared() - 1.0).abs() < ROUNDING) & (reach(ray) < FAR)
}
