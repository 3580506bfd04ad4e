//! As many rays as a vector has lanes, a row a number.

use fearless_simd::{Simd, SimdBase, SimdInterleaved, f32x4};
use whitted::{Departure, Ray, Side, Vec3};

use super::lanes::{Lanes, Vectors};

/// A vector a lane, a coordinate a row.
#[derive(Clone, Copy, Debug)]
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
    pub fn take<S: Simd, V: Lanes<S>>(&mut self, simd: S, rays: &[Ray], len: usize) -> u32 {
        let padded;
        let all: &[Ray; N] = match rays.first_chunk() {
            Some(all) => all,
            None => {
                padded = core::array::from_fn(|lane| rays[lane.min(rays.len() - 1)]);
                &padded
            }
        };
        // Numbers that lie together go together, by four; rows become whole before they are stored, as
        // number by number they could not be loaded before the last had arrived.
        let mut rows = [[0.0; N]; 7];
        for (four, rays) in all.as_chunks::<4>().0.iter().enumerate() {
            let place = 4 * four..4 * four + 4;
            let [x, y, z, dx] = columns(simd, rays, |ray| {
                let (o, d) = (ray.origin, ray.direction);
                [o.x, o.y, o.z, d.x]
            });
            let [_, dy, dz, end] = columns(simd, rays, |ray| {
                let d = ray.direction;
                [d.x, d.y, d.z, ray.t_max]
            });
            for (row, four) in rows.iter_mut().zip([x, y, z, dx, dy, dz, end]) {
                four.store_slice(&mut row[place.clone()]);
            }
        }
        let [x, y, z, dx, dy, dz, end] = rows.map(|row| V::from_slice(simd, &row));
        self.origin.store(Vectors { x, y, z });
        self.direction.store(Vectors {
            x: dx,
            y: dy,
            z: dz,
        });
        end.store_slice(&mut self.end);
        self.left = [u32::MAX; N];
        self.inward = 0;
        let leaves = all
            .iter()
            .fold(false, |any, ray| any | ray.departure.is_some());
        if leaves {
            for (lane, ray) in all.iter().enumerate() {
                if let Some(departure) = ray.departure
                    && departure.object < len
                {
                    self.left[lane] = departure.object as u32;
                    self.inward |= u32::from(departure.side == Side::Inside) << lane;
                }
            }
        }
        u32::MAX >> (32 - rays.len().min(N))
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
fn columns<S: Simd>(simd: S, rays: &[Ray; 4], numbers: impl Fn(&Ray) -> [f32; 4]) -> [f32x4<S>; 4] {
    let [a, b, c, d] = rays;
    let rows = [numbers(a), numbers(b), numbers(c), numbers(d)];
    f32x4::load_four_interleaved(simd, rows.as_flattened())
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
