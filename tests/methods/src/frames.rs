//! Whole frames of the standard sphere scene: what the math policy, the depth and the contribution
//! threshold cost, and what they save.
//!
//! The scene is `tests/golden/spheres.toml`, written by `whitted bake --size 64x48` at some time; a test
//! holds its picture to that of the file.

use core::hash::Hasher;

use fnv::FnvHasher;
use glam::Vec3;
use whitted::{Exact, Math, Micro, Tracer, View, picture};

/// The scene.
pub mod spheres;

/// The most bounces.
pub const BOUNCES: usize = 8;

/// Contribution thresholds.
pub const THRESHOLDS: [f32; 7] = [
    0.0,
    1.0 / 512.0,
    1.0 / 256.0,
    1.0 / 128.0,
    1.0 / 64.0,
    1.0 / 32.0,
    1.0 / 16.0,
];

/// How roots and powers are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Policy {
    /// [`Exact`].
    Exact,
    /// [`Micro`].
    Micro,
}

/// How a frame is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// The arithmetic.
    pub policy: Policy,
    /// Secondary rays in a row; 0 is direct light only.
    pub bounces: usize,
    /// As in [`Tracer::threshold`].
    pub threshold: f32,
}

/// Every setting, the policies one after the other.
pub fn settings() -> impl Iterator<Item = Setting> {
    let of_depth = |policy, bounces| {
        THRESHOLDS.into_iter().map(move |threshold| Setting {
            policy,
            bounces,
            threshold,
        })
    };
    [Policy::Exact, Policy::Micro]
        .into_iter()
        .flat_map(move |policy| (0..=BOUNCES).flat_map(move |bounces| of_depth(policy, bounces)))
}

/// The frame that is priced.
pub const PRICED: View = spheres::VIEW;

impl Setting {
    /// Draws the scene as this view shows it, row by row.
    #[inline(never)]
    pub fn draw(&self, view: &View, pixel: &mut impl FnMut(Vec3)) {
        match self.policy {
            Policy::Exact => self.draw_by::<Exact>(view, pixel),
            Policy::Micro => self.draw_by::<Micro>(view, pixel),
        }
    }

    fn draw_by<P: Math>(&self, view: &View, pixel: &mut impl FnMut(Vec3)) {
        let mut tracer = Tracer::<{ BOUNCES + 1 }, P>::with(());
        tracer.depth = self.bounces + 1;
        tracer.threshold = self.threshold;
        for y in 0..view.height {
            for color in picture::row(&spheres::SCENE, view, y, &mut tracer) {
                pixel(color);
            }
        }
    }
}

/// Checksum of every setting's frame: that the part draws what the host judges.
pub fn checksum() -> u64 {
    let mut hash = FnvHasher::default();
    for setting in settings() {
        setting.draw(&PRICED, &mut |color| {
            for channel in color.to_array() {
                hash.write(&channel.to_bits().to_le_bytes());
            }
        });
    }
    hash.finish()
}
