//! As many rays as a vector has lanes, a row a number.

use core::hint::black_box;

use fearless_simd::{Simd, SimdBase, SimdFrom, SimdMask, f32x4};
use whitted::{Departure, Ray, Side, Vec3};

use super::bounds::{FAR, ROUNDING};
use super::lanes::{Lanes, Vectors};
use super::rays::{INVERTIBLE, Needs};
use super::tree::{Tree, Vector};

/// A vector a lane, a coordinate a row, which no two lines of a cache share: else it would take twice as long
/// to load or store.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Rows<const N: usize>(pub [[f32; N]; 3]);

impl<const N: usize> Rows<N> {
    pub const ZERO: Self = Self([[0.0; N]; 3]);

    #[inline(always)]
    pub fn get(&self, lane: usize) -> Vec3 {
        let [x, y, z] = &self.0;
        Vec3::new(x[lane], y[lane], z[lane])
    }

    #[inline(always)]
    pub fn set(&mut self, lane: usize, v: Vec3) {
        for (row, x) in self.0.iter_mut().zip(v.to_array()) {
            row[lane] = x;
        }
    }

    #[inline(always)]
    pub fn load<S: Simd, V: Lanes<S>>(&self, simd: S) -> Vectors<V> {
        Vectors::load(simd, &self.0)
    }

    #[inline(always)]
    pub fn store<S: Simd, V: Lanes<S>>(&mut self, v: Vectors<V>) {
        let [x, y, z] = &mut self.0;
        v.x.store_slice(x);
        v.y.store_slice(y);
        v.z.store_slice(z);
    }
}

/// A ray a lane.
#[derive(Clone, Debug)]
pub struct Beams<const N: usize> {
    pub origin: Rows<N>,
    pub direction: Rows<N>,
    /// As `Ray::t_max`.
    pub end: [f32; N],
    /// The object that each leaves; `u32::MAX` for none.
    pub left: [u32; N],
    /// A bit a lane: whether it goes on inside of that.
    pub inward: u32,
}

impl<const N: usize> Beams<N> {
    pub const NONE: Self = Self {
        origin: Rows::ZERO,
        direction: Rows::ZERO,
        end: [f32::INFINITY; N],
        left: [u32::MAX; N],
        inward: 0,
    };

    /// Takes up to `N` rays, and says which lanes have one. Rays that leave none of the `len` objects leave
    /// none.
    #[inline(always)]
    pub fn take<S: Simd, V: Lanes<S>>(&mut self, simd: S, rays: &[Ray], len: usize) -> u32
    where
        Tree<N>: Vector<S, Lanes = V>,
    {
        let padded;
        let all: &[Ray; N] = match rays.first_chunk() {
            Some(all) => all,
            None => {
                padded = core::array::from_fn(|lane| rays[lane.min(rays.len() - 1)]);
                &padded
            }
        };
        let ends = self.take_rows(simd, all.each_ref(), |ray| {
            (ray.origin, ray.direction, ray.t_max)
        });
        ends.store_slice(&mut self.end);
        self.left = [u32::MAX; N];
        self.inward = 0;
        let leaves = (all.iter()).fold(false, |any, ray| any | ray.departure.is_some());
        if leaves {
            for (lane, ray) in all.iter().enumerate() {
                // No branch: some rays leave an object, and some do not.
                let (object, inward) = match ray.departure {
                    Some(departure) => (departure.object, departure.side == Side::Inside),
                    None => (usize::MAX, false),
                };
                let known = object < len;
                self.left[lane] = if known { object as u32 } else { u32::MAX };
                self.inward |= u32::from(inward & known) << lane;
            }
        }
        // Rows are to be loaded as they are: number by number, the compiler would carry all of them along.
        black_box(self);
        u32::MAX >> (32 - rays.len().min(N))
    }

    /// Takes the rows of origins and directions from `numbers` of each of some, and returns the row of the
    /// third ones.
    ///
    /// Rows become whole before they are stored: in parts, they could not be loaded before the last had
    /// arrived.
    #[inline(always)]
    pub fn take_rows<S: Simd, V: Lanes<S>, T>(
        &mut self,
        simd: S,
        all: [&T; N],
        numbers: impl Fn(&T) -> (Vec3, Vec3, f32),
    ) -> V
    where
        Tree<N>: Vector<S, Lanes = V>,
    {
        // Numbers that lie together go together, by four. Nothing here maps arrays: where it is called from more
        // than one place, the compiler would not inline that, and it would not be compiled for vectors.
        let (fours, _) = all.as_chunks::<4>();
        macro_rules! rows {
            ($numbers:expr) => {{
                let a = columns(simd, fours[0], $numbers);
                let b = columns(simd, fours[1], $numbers);
                let (c, d) = if N > 8 {
                    (
                        columns(simd, fours[2], $numbers),
                        columns(simd, fours[3], $numbers),
                    )
                } else {
                    (a, b)
                };
                [
                    Tree::<N>::join([a[0], b[0], c[0], d[0]]),
                    Tree::<N>::join([a[1], b[1], c[1], d[1]]),
                    Tree::<N>::join([a[2], b[2], c[2], d[2]]),
                    Tree::<N>::join([a[3], b[3], c[3], d[3]]),
                ]
            }};
        }
        let [x, y, z, along_x] = rows!(|it: &T| {
            let (o, d, _) = numbers(it);
            [o.x, o.y, o.z, d.x]
        });
        let [_, along_y, along_z, last] = rows!(|it: &T| {
            let (_, d, last) = numbers(it);
            [d.x, d.y, d.z, last]
        });
        self.origin.store(Vectors { x, y, z });
        self.direction.store(Vectors {
            x: along_x,
            y: along_y,
            z: along_z,
        });
        last
    }

    /// Of which rays the lanes' answer is the kernels' own, as `Wide::takes_this`: a bit a lane.
    #[inline(always)]
    pub fn regular<S: Simd, V: Lanes<S>>(&self, simd: S, needs: Needs) -> u32
    where
        Tree<N>: Vector<S, Lanes = V>,
    {
        let o: Vectors<V> = self.origin.load(simd);
        let d: Vectors<V> = self.direction.load(simd);
        let off: V = (d.dot(d) - V::simd_from(simd, 1.0)).abs();
        let reach = o.x.abs() + o.y.abs() + o.z.abs();
        let mut regular =
            off.simd_lt(V::simd_from(simd, ROUNDING)) & reach.simd_lt(V::simd_from(simd, FAR));
        if needs.reciprocal {
            let (zero, least) = (V::simd_from(simd, 0.0), V::simd_from(simd, INVERTIBLE));
            for x in [d.x, d.y, d.z] {
                regular &= x.simd_eq(zero) | x.abs().simd_gt(least);
            }
        }
        regular.to_bitmask() as u32
    }

    /// On which side a lane's ray leaves the object that it leaves.
    #[inline(always)]
    pub fn side(&self, lane: usize) -> Side {
        if self.inward >> lane & 1 != 0 {
            Side::Inside
        } else {
            Side::Outside
        }
    }

    /// A lane's ray.
    #[inline(always)]
    pub fn ray(&self, lane: usize) -> Ray {
        let departure = Departure {
            object: self.left[lane] as usize,
            side: self.side(lane),
        };
        Ray {
            origin: self.origin.get(lane),
            direction: self.direction.get(lane),
            t_max: self.end[lane],
            departure: (self.left[lane] != u32::MAX).then_some(departure),
        }
    }
}

/// Four numbers of each of four rays, a number a vector.
#[inline(always)]
fn columns<S: Simd, T>(
    simd: S,
    [a, b, c, d]: [&T; 4],
    numbers: impl Fn(&T) -> [f32; 4],
) -> [f32x4<S>; 4] {
    // The compiler would rather shuffle all rays at once, in as many steps as that takes.
    let four = |ray: &T| black_box(f32x4::simd_from(simd, numbers(ray)));
    let (a, b, c, d) = (four(a), four(b), four(c), four(d));
    let (even, odd) = (a.zip_low(c), b.zip_low(d));
    let (last_even, last_odd) = (a.zip_high(c), b.zip_high(d));
    [
        even.zip_low(odd),
        even.zip_high(odd),
        last_even.zip_low(last_odd),
        last_even.zip_high(last_odd),
    ]
}

/// The lanes of a set, the least first.
#[derive(Clone, Copy)]
pub struct Set(pub u32);

impl Iterator for Set {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        if self.0 == 0 {
            return None;
        }
        let lane = self.0.trailing_zeros() as usize;
        self.0 &= self.0 - 1;
        Some(lane)
    }
}
