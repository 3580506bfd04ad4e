//! No scene: square roots of numbers of all sizes, each target's own way against the host's.

use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::pixelcolor::Rgb565;
use glam::Vec3;
use whitted::{Counters, View, math};

use super::{Frame, fill, level_view};

/// Each channel stands for the bits of many roots.
pub struct Roots;

/// How many roots a channel stands for.
const MANY: u32 = 16;

/// From zero almost to infinity, subnormal numbers among them; odd, for significands of all sorts.
const STEP: u32 = {
    let count = Roots::VIEW.width * Roots::VIEW.height * 3 * MANY;
    (f32::INFINITY.to_bits() / count - 1) | 1
};

fn pixel(x: u32, y: u32) -> Vec3 {
    let place = y * Roots::VIEW.width + x;
    let channel = |channel| {
        let first = (place * 3 + channel) * MANY;
        let roots = (first..first + MANY).map(|it| math::sqrt(f32::from_bits(it * STEP)));
        let mixed = roots.fold(0, |mixed: u32, root| mixed.rotate_left(5) ^ root.to_bits());
        (mixed >> 8) as f32 / (1 << 24) as f32
    };
    Vec3::new(channel(0), channel(1), channel(2))
}

impl Frame for Roots {
    const VIEW: View = level_view(Vec3::ZERO);

    fn row(y: u32, row: &mut [Vec3]) {
        for (x, color) in (0..).zip(row) {
            *color = pixel(x, y);
        }
    }

    fn draw<D: DrawTarget<Color = Rgb565>>(display: &mut D) -> Result<(), D::Error> {
        let View { width, height, .. } = Self::VIEW;
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| pixel(x, y)));
        fill(display, &Self::VIEW, pixels)
    }

    fn count() -> Counters {
        Counters::default()
    }
}
