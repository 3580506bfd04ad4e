//! Everything that is measured of a program, from one binary.

use std::path::Path;

use anyhow::{Context, Result, bail};
use serde::{Deserialize, Serialize};

use super::expected::Expected;
use super::firmware::{self, Build, Kind, Options};
use super::image::Image;
use super::target::{CORTEX_M0, CORTEX_M3, CORTEX_M4F, Machine, TARGETS, Target};
use super::{cortex_m4, run, stack};

/// One program on one target.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The compiler that made it.
    pub compiler: String,
    /// How it was asked to.
    pub profile: String,
    /// As in [`Target::name`].
    pub target: String,
    /// The program's name.
    pub program: String,
    /// Bytes of flash over the empty program, without the support library.
    pub flash: i64,
    /// Bytes of the compiler's support library: arithmetic that the target has no instruction for.
    pub support: u64,
    /// Bytes of static RAM over the empty program.
    pub static_ram: i64,
    /// The deepest stack below the caller of the drawing function, by painting.
    pub stack: u64,
    /// The same by the code alone.
    pub stack_bound: u64,
    /// Instructions a pixel.
    pub instructions: f64,
    /// Estimated cycles a pixel, on the Cortex-M4F.
    pub cycles: Option<f64>,
    /// Checksum of the code.
    pub text: String,
    /// Checksum of the picture's floats, or of the panel's pixels.
    pub picture: String,
}

/// A way to build and measure all programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variant<'a> {
    /// What the table calls it.
    pub profile: &'static str,
    /// What it is for.
    pub target: Target,
    /// How it draws.
    pub kind: Kind,
    /// How it is compiled.
    pub options: Options<'a>,
}

/// All that the table has.
pub fn variants() -> Vec<Variant<'static>> {
    let plain = |target| Variant {
        profile: "speed",
        target,
        kind: Kind::Rows,
        options: Options::default(),
    };
    let with = |profile, target, options| Variant {
        profile,
        options,
        ..plain(target)
    };
    let small = Options {
        small: true,
        ..Options::default()
    };
    let libgcc = Options {
        features: &["libgcc"],
        ..Options::default()
    };
    let mut variants: Vec<Variant<'_>> = TARGETS
        .into_iter()
        .filter(|target| matches!(target.machine, Machine::Qemu(..)))
        .map(plain)
        .collect();
    variants.extend([
        Variant {
            profile: "panel",
            kind: Kind::Panel,
            ..plain(CORTEX_M4F)
        },
        with("size", CORTEX_M4F, small),
        with("libgcc", CORTEX_M0, libgcc),
        with("libgcc", CORTEX_M3, libgcc),
    ]);
    variants
}

impl Variant<'_> {
    /// Builds all programs and measures each.
    ///
    /// # Errors
    ///
    /// Where one cannot be built, run or read, or draws another picture than the host.
    pub fn measure(
        &self,
        compiler: &str,
        expected: &[(&'static str, Expected)],
        plugin: &Path,
    ) -> Result<Vec<Row>> {
        let programs = match firmware::build_with(&self.target, self.kind, self.options)? {
            Build::Programs(programs) => programs,
            Build::NoCompiler(why) => bail!(why),
        };
        let image = |name: &str| Image::read(programs.get(name).with_context(|| name.to_owned())?);
        let empty = image("empty")?;
        expected
            .iter()
            .map(|(name, expected)| {
                let row = self.row(compiler, name, &image(name)?, &empty, expected, plugin);
                row.with_context(|| format!("{name} on {}", self.target.name))
            })
            .collect()
    }

    fn row(
        &self,
        compiler: &str,
        name: &str,
        image: &Image,
        empty: &Image,
        expected: &Expected,
        plugin: &Path,
    ) -> Result<Row> {
        let root = self.kind.root();
        let (report, profiles) = run::run_counted(&self.target, image, &[root], plugin)?;
        expected.check(self.kind, &report)?;
        let profile = profiles.first().context("no profile")?;
        let per_pixel = |sum: u64| (sum as f64 / expected.pixels as f64 * 10.0).round() / 10.0;
        let over = |bytes: u64, empty: u64| bytes as i64 - empty as i64;
        let own_flash = |image: &Image| image.flash - image.support_bytes();
        let cycles = (self.target == CORTEX_M4F).then(|| cortex_m4::total(image, profile));
        Ok(Row {
            compiler: compiler.to_owned(),
            profile: self.profile.to_owned(),
            target: self.target.name.to_owned(),
            program: name.to_owned(),
            flash: over(own_flash(image), own_flash(empty)),
            support: image.support_bytes(),
            static_ram: over(image.static_ram, empty.static_ram),
            stack: report.get("stack").copied().context("no stack depth")?,
            stack_bound: stack::bound(image, root)?.bytes,
            instructions: per_pixel(profile.total()),
            cycles: cycles.transpose()?.map(|cycles| per_pixel(cycles.total())),
            text: format!("{:016x}", image.text_checksum()),
            picture: format!("{:016x}", expected.picture(self.kind)),
        })
    }
}
