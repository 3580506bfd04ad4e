//! Seeded inputs: the same on every machine, however many threads share the work.

use glam::Vec3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// A stream of numbers.
pub struct Random(ChaCha8Rng);

/// Where a stream belongs. Every field makes it another one.
#[derive(Clone, Copy, Debug)]
pub struct Stream {
    /// Of the whole run.
    pub seed: u64,
    /// What the numbers are for.
    pub purpose: u64,
    /// Which cell of it.
    pub cell: u64,
    /// Which part of the cell.
    pub chunk: u64,
}

impl Stream {
    /// Names as a number, FNV-1a.
    pub fn purpose(names: [&str; 2]) -> u64 {
        let bytes = names[0].bytes().chain([0]).chain(names[1].bytes());
        bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        })
    }
}

impl Random {
    /// The stream from its start.
    pub fn new(stream: Stream) -> Self {
        let words = [stream.seed, stream.purpose, stream.cell, stream.chunk];
        let mut seed = [0; 32];
        for (bytes, word) in seed.chunks_exact_mut(8).zip(words) {
            bytes.copy_from_slice(&word.to_le_bytes());
        }
        Self(ChaCha8Rng::from_seed(seed))
    }

    /// Whole numbers below `end`.
    pub fn below(&mut self, end: usize) -> usize {
        (self.unit() * end as f64) as usize
    }

    /// From 0 to below 1.
    pub fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// From `low` to below `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// From -1 to below 1.
    pub fn signed(&mut self) -> f64 {
        self.between(-1.0, 1.0)
    }

    /// Each component from -`size` to below `size`.
    pub fn vector(&mut self, size: f64) -> Point {
        Point([self.signed(), self.signed(), self.signed()]) * size
    }

    /// Uniform over the sphere, unit length.
    pub fn direction(&mut self) -> Point {
        loop {
            let v = self.vector(1.0);
            let square = v.dot(v);
            if square > 1e-3 && square < 1.0 {
                return v * (1.0 / square.sqrt());
            }
        }
    }

    /// Unit length, perpendicular to `to`.
    pub fn across(&mut self, to: Point) -> Point {
        loop {
            let v = to.cross(self.direction());
            let square = v.dot(v);
            if square > 1e-2 * to.dot(to) {
                return v * (1.0 / square.sqrt());
            }
        }
    }
}

/// A vector in `f64`: inputs are made in more digits than they have, and rounded once.
#[derive(Clone, Copy, Debug)]
pub struct Point(pub [f64; 3]);

impl Point {
    /// Takes a vector as it is.
    pub fn new(v: Vec3) -> Self {
        Self(v.to_array().map(f64::from))
    }

    /// The dot product.
    pub fn dot(self, other: Self) -> f64 {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        a * x + b * y + c * z
    }

    /// The cross product.
    pub fn cross(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([b * z - c * y, c * x - a * z, a * y - b * x])
    }

    /// Rounded to `f32`.
    pub fn round(self) -> Vec3 {
        self.0.map(|x| x as f32).into()
    }

    /// Rounded to `f32`, then given unit length in `f32`, as a ray caster's directions are: the length
    /// is 1 to within some rounding.
    pub fn unit(self) -> Vec3 {
        let v = self.round();
        v * (1.0 / v.length_squared().sqrt())
    }
}

impl std::ops::Add for Point {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a + x, b + y, c + z])
    }
}

impl std::ops::Sub for Point {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + other * -1.0
    }
}

impl std::ops::Mul<f64> for Point {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self(self.0.map(|x| x * factor))
    }
}
