//! Whole frames: what a math policy, a depth and a contribution threshold do to a picture, and what
//! they cost.

use std::path::Path;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use whitted::View;
use whitted::picture::to_rgb8;
use whitted_cli::scene_file::read;
use whitted_methods::frames::{BOUNCES, PRICED, Policy, Setting, settings};

use crate::comparison::{options, steps};
use crate::reference::{Options, Scene, quantize};

/// The scene that [`whitted_methods::frames`] has as statics.
const SCENE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/golden/spheres.toml");

/// A line of `frame-cycles.csv`: what a setting costs on the Cortex-M4F.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FramePrice {
    /// `Exact` or `Micro`.
    pub policy: String,
    /// Secondary rays in a row.
    pub bounces: usize,
    /// What weighs no more in its pixel is not traced.
    pub threshold: f32,
    /// Estimated, a pixel.
    pub cycles: f64,
    /// Counted, a pixel.
    pub instructions: f64,
}

/// A line of `frames.csv`: a setting's picture against that of the `f64` tracer, which follows light
/// through all bounces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// As in [`FramePrice`].
    pub policy: String,
    /// As in [`FramePrice`].
    pub bounces: usize,
    /// As in [`FramePrice`].
    pub threshold: f32,
    /// Of the picture.
    pub pixels: usize,
    /// Of them, those that are off by more than one step of 255.
    pub differing: usize,
    /// How far off the worst of them is, in steps.
    pub worst: u8,
}

impl FramePrice {
    /// Of a setting.
    pub fn new(setting: Setting, cycles: f64, instructions: f64) -> Self {
        Self {
            policy: name(setting.policy).into(),
            bounces: setting.bounces,
            threshold: setting.threshold,
            cycles,
            instructions,
        }
    }

    /// Whether it is that frame's price.
    pub fn is_of(&self, frame: &Frame) -> bool {
        (&self.policy, self.bounces, self.threshold)
            == (&frame.policy, frame.bounces, frame.threshold)
    }
}

fn name(policy: Policy) -> &'static str {
    match policy {
        Policy::Exact => "Exact",
        Policy::Micro => "Micro",
    }
}

/// Draws every setting's frame, `width` pixels wide, and holds it against the `f64` tracer's.
pub fn run(width: u32, progress: &(impl Fn(&str, &str) + Sync)) -> Vec<Frame> {
    progress("frames", "f64");
    let view = View {
        width,
        height: width * PRICED.height / PRICED.width,
        ..PRICED
    };
    let file = read(Path::new(SCENE)).expect("the standard scene");
    let scene = Scene::from_file(&file.rounded(), view.width, view.height).expect("a camera");
    let options = Options {
        depth: BOUNCES as u32 + 1,
        ..options(&file)
    };
    let truth: Vec<_> = scene
        .render(view.width, view.height, options)
        .into_iter()
        .map(quantize)
        .collect();
    progress("frames", "all settings");
    let all: Vec<Setting> = settings().collect();
    all.into_par_iter()
        .map(|setting| {
            let mut truth_of = truth.iter();
            let (mut differing, mut worst) = (0, 0);
            setting.draw(&view, &mut |color| {
                let truth = truth_of.next().expect("as many pixels");
                let off = steps(to_rgb8(color), *truth);
                differing += usize::from(off > 1);
                worst = worst.max(off);
            });
            Frame {
                policy: name(setting.policy).into(),
                bounces: setting.bounces,
                threshold: setting.threshold,
                pixels: truth.len(),
                differing,
                worst,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comparison::render;

    #[test]
    fn the_priced_scene_is_the_standard_one() {
        let file = read(Path::new(SCENE)).unwrap();
        let setting = Setting {
            policy: Policy::Exact,
            bounces: file.depth - 1,
            threshold: 0.0,
        };
        let mut pixels = Vec::new();
        setting.draw(&PRICED, &mut |color| pixels.push(color));
        assert_eq!(pixels, render(&file, PRICED.width, PRICED.height));
    }

    #[test]
    fn exact_frames_are_the_oracle_s_and_shortcuts_are_not() {
        let frames = run(96, &|_, _| {});
        assert_eq!(frames.len(), settings().count());
        let of = |policy: &str, bounces, threshold| {
            let is = |frame: &&Frame| {
                frame.policy == policy && frame.bounces == bounces && frame.threshold == threshold
            };
            frames.iter().find(is).expect("a setting")
        };
        assert!(of("Exact", BOUNCES, 0.0).differing <= 2);
        // Each bounce that is left out shows, and so does what weighs a sixteenth.
        assert!(of("Exact", 0, 0.0).differing > of("Exact", 2, 0.0).differing);
        assert!(of("Exact", 2, 0.0).differing > of("Exact", BOUNCES, 0.0).differing);
        assert!(of("Exact", BOUNCES, 1.0 / 16.0).differing > 100);
        assert!(of("Exact", BOUNCES, 1.0 / 512.0).worst <= 3);
        assert!(of("Micro", BOUNCES, 0.0).differing > 1000);
    }
}
