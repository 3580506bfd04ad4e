//! Pairs of a ray and an object, one a lane: for rays that have little in common.
//!
//! Of rays that go all ways, a few come near each object, and each comes near one or two. A vector of sixteen rays
//! for each object is idle in most of its lanes. Here the lanes are those pairs alone that are near each other, as
//! in C. P. Gribble, K. Ramani, "Coherent Ray Tracing via Stream Filtering", IEEE/EG Symposium on Interactive Ray
//! Tracing, 2008. Both rays and the objects of a block are rows of as many numbers as a vector has lanes, so that
//! it takes one permutation to bring a number of each pair together.

use fearless_simd::{Simd, SimdMask};

use super::across::{Near, Terms};
use super::beams::{Beams, Rows, Set};
use super::blocks::{Blocks, Labels};
use super::lanes::{Lanes, Meeting, Vectors};
use super::tree::{Nearest, Tree, Vector};

/// An object that so many rays may meet, or fewer, is met in pairs.
const MOST_RAYS: u32 = 4;

/// Of so few such objects of a block, each is as soon met by all rays.
const FEW_OBJECTS: u32 = 4;

/// Rays of a group, and objects of a block that they may meet.
#[derive(Clone, Debug)]
pub struct Pairs<const N: usize> {
    /// For each 32 of few objects, a bit an object that may be met in pairs. Spheres are as soon met by all rays.
    objects: Vec<u32>,
    /// For each block of such objects, a bit a lane: which few rays may meet.
    sparse: Vec<u32>,
    /// Of each pair the ray's lane in the group and the object's in the block, both as [`LANES`] has them. After
    /// the last there are as many that mean nothing, but can be computed with.
    rays: [[f32; N]; ROOM],
    lanes: [[f32; N]; ROOM],
    count: usize,
}

/// Of how many vectors there is room: all pairs of a block, and some more.
const ROOM: usize = MOST_RAYS as usize + 1;

/// Of each lane the places of its bytes.
static LANES: [f32; 16] = {
    let mut lanes = [0.0; 16];
    let mut lane = 0;
    while lane < lanes.len() {
        lanes[lane] = f32::from_bits(0x0302_0100 + lane as u32 * 0x0404_0404);
        lane += 1;
    }
    lanes
};

/// The lane whose bytes have these places.
#[inline(always)]
fn lane_of(places: f32) -> usize {
    (places.to_bits() as u8 / 4).into()
}

impl<const N: usize> Pairs<N> {
    /// None yet, of as many objects, all in these blocks.
    pub fn new(blocks: &Blocks<N>, count: usize) -> Self {
        let mut objects = vec![0_u32; count.div_ceil(32)];
        for place in labels(blocks).flat_map(|it| it.objects) {
            if let Some(word) = objects.get_mut(place as usize / 32) {
                *word |= 1 << (place % 32);
            }
        }
        Self {
            objects,
            sparse: labels(blocks).map(|_| 0).collect(),
            rays: [[LANES[0]; N]; ROOM],
            lanes: [[LANES[0]; N]; ROOM],
            count: 0,
        }
    }

    /// Finds the near objects that few rays may meet, and says whether there are so many that pairs are worth
    /// while.
    #[inline(always)]
    pub fn find(&mut self, blocks: &Blocks<N>, near: &Near) -> bool {
        // Of fewer lanes, fewer are idle, and it takes more than an instruction to permute them.
        if N < LANES.len() {
            return false;
        }
        let mut count = 0;
        for (near, objects) in near.objects.iter().zip(&self.objects) {
            count += (near & objects).count_ones();
        }
        if count <= FEW_OBJECTS * self.sparse.len() as u32 {
            return false;
        }
        let mut any = false;
        for (sparse, labels) in self.sparse.iter_mut().zip(labels(blocks)) {
            *sparse = 0;
            for (lane, &place) in labels.objects.iter().enumerate() {
                // Lanes without an object are the last.
                let Some(rays) = near.lanes.get(place as usize) else {
                    break;
                };
                // No branch: nothing could foresee it.
                let few = (*rays != 0) & (rays.count_ones() <= MOST_RAYS);
                *sparse |= u32::from(few) << lane;
            }
            if sparse.count_ones() <= FEW_OBJECTS {
                *sparse = 0;
            }
            any |= *sparse != 0;
        }
        any
    }

    /// Casts rays into the objects that were found, and takes these out of `near`. No ray leaves one of them, nor
    /// goes along the planes across an axis if there are boxes. Gives the outward normals of what is nearest, of
    /// patches those of their planes.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    pub fn cast<S: Simd, V: Lanes<S>>(
        &mut self,
        simd: S,
        blocks: &Blocks<N>,
        near: &mut Near,
        terms: &Terms<V, V::Mask>,
        beams: &Beams<N>,
        nearest: &mut [Nearest; N],
        outward: &mut Rows<N>,
    ) where
        Tree<N>: Vector<S, Lanes = V>,
    {
        let ends = V::from_slice(simd, &beams.end);
        let mut index = 0;
        macro_rules! each {
            ($shelf:ident, |$block:ident, $rays:ident, $lanes:ident, $limit:ident| $meeting:expr) => {
                for ($block, labels) in blocks.$shelf.blocks.iter().zip(&blocks.$shelf.labels) {
                    let sparse = self.sparse[index];
                    index += 1;
                    if sparse == 0 {
                        continue;
                    }
                    self.take::<S, V>(simd, sparse, labels, near);
                    for vector in 0..self.count.div_ceil(N) {
                        let $rays = V::from_slice(simd, &self.rays[vector]);
                        let $lanes = V::from_slice(simd, &self.lanes[vector]);
                        let $limit = ends.pick($rays);
                        self.offer(vector, $meeting, labels, nearest, outward);
                    }
                }
            };
        }
        each!(triangles, |it, rays, lanes, limit| {
            let (origin, direction) = (terms.origin.pick(rays), terms.direction.pick(rays));
            it.meet_pairs(simd, lanes, origin, direction, limit)
        });
        each!(quads, |it, rays, lanes, limit| {
            let (origin, direction) = (terms.origin.pick(rays), terms.direction.pick(rays));
            it.meet_pairs(simd, lanes, origin, direction, limit)
        });
        each!(cuboids, |it, rays, lanes, limit| {
            let (origin, reciprocal) = (terms.origin.pick(rays), terms.reciprocal.pick(rays));
            it.meet_pairs(simd, lanes, origin, reciprocal, limit)
        });
    }

    /// Takes the pairs of some of a block's objects.
    #[inline(always)]
    fn take<S: Simd, V: Lanes<S>>(
        &mut self,
        simd: S,
        sparse: u32,
        labels: &Labels<N>,
        near: &mut Near,
    ) where
        Tree<N>: Vector<S, Lanes = V>,
    {
        let all = V::from_slice(simd, &LANES[..N]);
        let (to_rays, to_lanes) = (self.rays.as_flattened_mut(), self.lanes.as_flattened_mut());
        self.count = 0;
        for lane in Set(sparse) {
            let place = labels.objects[lane % N] as usize;
            let rays = core::mem::take(&mut near.lanes[place]);
            let (to_rays, to_lanes) = (&mut to_rays[self.count..], &mut to_lanes[self.count..]);
            let mask = V::Mask::from_bitmask(simd, rays.into());
            all.compress(mask).store_slice(&mut to_rays[..N]);
            V::simd_from(simd, LANES[lane % N]).store_slice(&mut to_lanes[..N]);
            self.count += rays.count_ones() as usize;
        }
        // Not one by one: each would wait for the one before.
        let count = near.objects.iter().map(|it| it.count_ones());
        if count.sum::<u32>() == sparse.count_ones() {
            near.objects.fill(0);
            return;
        }
        for (first, objects) in (0..).step_by(32).zip(&mut near.objects) {
            for i in Set(*objects) {
                let none = near.lanes[first + i] == 0;
                *objects &= !(u32::from(none) << i);
            }
        }
    }

    /// Offers the rays of a vector of pairs what they meet.
    #[inline(always)]
    fn offer<S: Simd, V: Lanes<S>>(
        &self,
        vector: usize,
        (meeting, normals): (Meeting<V, V::Mask>, Vectors<V>),
        labels: &Labels<N>,
        nearest: &mut [Nearest; N],
        outward: &mut Rows<N>,
    ) {
        let real = u32::MAX >> (32 - (self.count - vector * N).min(N));
        let met = meeting.met.to_bitmask() as u32 & real;
        if met == 0 {
            return;
        }
        let mut t = [0.0; N];
        meeting.t.store_slice(&mut t);
        let mut rows = Rows::<N>::ZERO;
        rows.store(normals);
        for pair in Set(met) {
            let ray = lane_of(self.rays[vector][pair % N]) % N;
            let lane = lane_of(self.lanes[vector][pair % N]) % N;
            let object = labels.objects[lane];
            nearest[ray].offer(t[pair % N], object);
            if nearest[ray].object == object {
                outward.set(ray, rows.get(pair % N));
            }
        }
    }
}

/// Of all blocks whose objects may be met in pairs, what they are.
#[inline(always)]
fn labels<const N: usize>(blocks: &Blocks<N>) -> impl Iterator<Item = &Labels<N>> {
    let flat = blocks.triangles.labels.iter().chain(&blocks.quads.labels);
    flat.chain(&blocks.cuboids.labels)
}
