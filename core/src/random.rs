//! Numbers for tests: the same every time, and on every machine.

use glam::Vec3;

/// Numbers that are spread evenly from -1 to 1.
pub(crate) fn numbers(seed: u32) -> impl Iterator<Item = f32> {
    let mut state = seed;
    core::iter::repeat_with(move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 23) as f32 - 1.0
    })
}

/// Points in the cube of such coordinates.
pub(crate) fn vectors(seed: u32) -> impl Iterator<Item = Vec3> {
    let mut numbers = numbers(seed);
    core::iter::from_fn(move || {
        let [x, y, z] = core::array::from_fn(|_| numbers.next().unwrap());
        Some(Vec3::new(x, y, z))
    })
}
