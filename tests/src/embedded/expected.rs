//! What the programs have to report: the same frames, drawn here.

use std::hash::Hasher;

use anyhow::{Context, Result, ensure};
use embedded_graphics::pixelcolor::{IntoStorage, Rgb565, Rgb888};
use fnv::FnvHasher;
use glam::Vec3;
use whitted::{Counters, picture};

use super::firmware::Kind;
use super::run::Report;
use super::scenes::{self, Frame, Visitor};

/// What a frame's programs report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Expected {
    /// FNV-1a of the bits of every channel of every pixel, low byte first.
    pub float: u64,
    /// FNV-1a of the channels in 8 bits.
    pub byte: u64,
    /// What a panel takes in: its window's corner, then 5-6-5 pixels, high byte first.
    pub panel: u64,
    /// Rays and hits.
    pub counters: Counters,
    /// Pixels of the frame.
    pub pixels: u64,
}

impl Expected {
    /// Draws a frame.
    pub fn of<F: Frame>() -> Self {
        let (mut float, mut byte, mut panel) = (
            FnvHasher::default(),
            FnvHasher::default(),
            FnvHasher::default(),
        );
        panel.write(&[0, 0]);
        let mut row = vec![Vec3::ZERO; F::VIEW.width as usize];
        for y in 0..F::VIEW.height {
            F::row(y, &mut row);
            for color in &row {
                for channel in color.to_array() {
                    float.write(&channel.to_bits().to_le_bytes());
                }
                let [red, green, blue] = picture::to_rgb8(*color);
                byte.write(&[red, green, blue]);
                let color = Rgb565::from(Rgb888::new(red, green, blue));
                panel.write(&color.into_storage().to_be_bytes());
            }
        }
        Self {
            float: float.finish(),
            byte: byte.finish(),
            panel: panel.finish(),
            counters: F::count(),
            pixels: u64::from(F::VIEW.width) * u64::from(F::VIEW.height),
        }
    }

    /// Holds a program's report against it.
    ///
    /// # Errors
    ///
    /// Where a number is missing or another.
    pub fn check(&self, kind: Kind, report: &Report) -> Result<()> {
        let counters = &self.counters;
        let numbers: &[_] = match kind {
            Kind::Rows => &[("f32", self.float), ("8-bit", self.byte)],
            Kind::Panel => &[("565", self.panel)],
            Kind::Counters => &[
                ("primary", counters.primary),
                ("reflected", counters.reflected),
                ("refracted", counters.refracted),
                ("shadow", counters.shadow),
                ("hits", counters.hits),
            ],
        };
        for &(name, number) in numbers {
            let reported = report
                .get(name)
                .with_context(|| format!("no {name} in {report:x?}"))?;
            ensure!(
                *reported == number,
                "{name} is {reported:x}, on the host {number:x}"
            );
        }
        Ok(())
    }

    /// Checksum of what this kind of program draws.
    pub fn picture(&self, kind: Kind) -> u64 {
        if kind == Kind::Panel {
            self.panel
        } else {
            self.float
        }
    }

    /// All frames by the name of their program, in the order of the scenes.
    pub fn all() -> Vec<(&'static str, Self)> {
        struct All(Vec<(&'static str, Expected)>);
        impl Visitor for All {
            fn visit<F: Frame>(&mut self, name: &'static str) {
                self.0.push((name, Expected::of::<F>()));
            }
        }
        let mut all = All(Vec::new());
        scenes::visit_all(&mut all);
        all.0
    }
}
