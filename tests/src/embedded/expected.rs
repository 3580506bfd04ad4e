//! What the programs have to report: the same frames, drawn here.

use std::hash::Hasher;

use anyhow::{Context, Result, ensure};
use embedded_graphics::pixelcolor::{IntoStorage, Rgb565, Rgb888};
use fnv::FnvHasher;
use glam::Vec3;
use whitted::{Counters, picture};

use super::run::Report;
use super::scenes::{self, Frame, Visitor};

/// How a program draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Rows of floats, in a buffer of one row.
    Rows,
    /// Through embedded-graphics onto a display's stand-in.
    Panel,
}

impl Kind {
    /// The function that draws, which is what is measured.
    pub fn root(self) -> &'static str {
        match self {
            Self::Rows => "render_row",
            Self::Panel => "render_panel",
        }
    }
}

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
        let mut pixels = vec![Vec3::ZERO; (F::VIEW.width * F::VIEW.height) as usize];
        for (y, row) in (0..).zip(pixels.chunks_exact_mut(F::VIEW.width as usize)) {
            F::row(y, row);
        }
        Self::of_pixels(&pixels, F::count())
    }

    /// For a picture, row by row, and what was counted.
    pub fn of_pixels(pixels: &[Vec3], counters: Counters) -> Self {
        let [mut float, mut byte, mut panel] = [(); 3].map(|()| FnvHasher::default());
        panel.write(&[0, 0]);
        for color in pixels {
            for channel in color.to_array() {
                float.write(&channel.to_bits().to_le_bytes());
            }
            let [red, green, blue] = picture::to_rgb8(*color);
            byte.write(&[red, green, blue]);
            let color = Rgb565::from(Rgb888::new(red, green, blue));
            panel.write(&color.into_storage().to_be_bytes());
        }
        Self {
            float: float.finish(),
            byte: byte.finish(),
            panel: panel.finish(),
            counters,
            pixels: pixels.len() as u64,
        }
    }

    /// Holds the report of a program that draws in one way against it.
    ///
    /// # Errors
    ///
    /// Where a number is missing or another.
    pub fn check(&self, kind: Kind, report: &Report) -> Result<()> {
        match kind {
            Kind::Rows => check("", &[("f32", self.float), ("8-bit", self.byte)], report),
            Kind::Panel => check("", &[("565", self.panel)], report),
        }
    }

    /// Holds the report of a program that draws this frame and others in all ways against it.
    ///
    /// # Errors
    ///
    /// Where a number is missing or another.
    pub fn check_all(&self, name: &str, report: &Report) -> Result<()> {
        let counters = &self.counters;
        let numbers = [
            ("f32", self.float),
            ("8-bit", self.byte),
            ("565", self.panel),
            ("primary", counters.primary),
            ("reflected", counters.reflected),
            ("refracted", counters.refracted),
            ("shadow", counters.shadow),
            ("hits", counters.hits),
        ];
        check(&format!("{name}/"), &numbers, report)
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
    pub fn all() -> Vec<(String, Self)> {
        let mut all = All(Vec::new());
        scenes::visit_all(&mut all);
        all.0
    }

    /// The frames of the program that draws many, by name.
    pub fn varied() -> Vec<(String, Self)> {
        let mut varied = All(Vec::new());
        scenes::visit_varied(&mut varied);
        varied.0
    }
}

struct All(Vec<(String, Expected)>);

impl Visitor for All {
    fn visit<F: Frame>(&mut self, name: &'static str) {
        self.0.push((name.to_owned(), Expected::of::<F>()));
    }
}

/// Holds numbers, whose names start with `prefix` there, against a report.
fn check(prefix: &str, numbers: &[(&str, u64)], report: &Report) -> Result<()> {
    for (name, number) in numbers {
        let name = format!("{prefix}{name}");
        let reported = report.get(&name);
        let reported = reported.with_context(|| format!("no {name} in {report:x?}"))?;
        ensure!(
            reported == number,
            "{name} is {reported:x}, on the host {number:x}"
        );
    }
    Ok(())
}
