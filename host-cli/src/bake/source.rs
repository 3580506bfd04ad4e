//! Numbers as source, and what they take.

use std::mem::size_of;

use whitted::Vec3;

/// What a pointer or a length has on the targets.
pub const WORD: usize = 4;
/// What a vector has.
pub const VECTOR: usize = size_of::<Vec3>();

/// A number that reads back to the same bits: the shortest.
pub fn number(x: f32) -> String {
    debug_assert!(!x.is_nan(), "scenes are made of numbers");
    if x.is_finite() {
        format!("{x:?}")
    } else if x > 0.0 {
        "f32::INFINITY".to_owned()
    } else {
        "f32::NEG_INFINITY".to_owned()
    }
}

pub fn vector(v: Vec3) -> String {
    let [x, y, z] = v.to_array().map(number);
    format!("v({x}, {y}, {z})")
}

pub fn vectors(vectors: &[Vec3]) -> String {
    let all: Vec<_> = vectors.iter().copied().map(vector).collect();
    format!("[{}]", all.join(", "))
}
