//! Everything that is measured of a program, from one binary.

use std::path::Path;

use anyhow::{Context, Result};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::expected::{Expected, Kind};
use super::firmware::{self, Programs, Request};
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
    /// The same by the code alone; none for C, plain or in GCC's library.
    pub stack_bound: Option<u64>,
    /// Instructions a pixel.
    pub instructions: f64,
    /// Estimated cycles a pixel, on the Cortex-M4F.
    pub cycles: Option<f64>,
    /// Checksum of the code.
    pub text: String,
    /// Checksum of the picture's floats, or of the panel's pixels.
    pub picture: String,
}

/// The scenes that are also drawn by plain C.
pub const PEERS: [&str; 3] = ["six-spheres", "c-ray", "tiny"];

/// The program in plain C that draws this scene.
pub fn in_c(scene: &str) -> String {
    format!("{scene}-in-c")
}

/// A program and what it has to draw.
pub type Frames = [(String, Expected)];

/// A way to build and measure programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variant<'a> {
    /// What the table calls it.
    pub profile: &'static str,
    /// What it is for.
    pub target: Target,
    /// How it draws.
    pub kind: Kind,
    /// How it is compiled; all programs are.
    pub request: Request<'a>,
}

/// The ways that the table has, but for those of the programs in plain C.
pub fn variants() -> Vec<Variant<'static>> {
    let plain = |target| Variant {
        profile: "speed",
        target,
        kind: Kind::Rows,
        request: Request::default(),
    };
    let with = |profile, target, features, rustflags| Variant {
        profile,
        request: Request {
            features,
            rustflags,
            ..Request::default()
        },
        ..plain(target)
    };
    let mut variants: Vec<Variant<'_>> = TARGETS
        .into_iter()
        .filter(|target| matches!(target.machine, Machine::Qemu(..)))
        .map(plain)
        .collect();
    variants.extend([
        Variant {
            kind: Kind::Panel,
            ..with("panel", CORTEX_M4F, &["panel"], &[])
        },
        with("size", CORTEX_M4F, &[], &["-Ctarget-feature=-slowfpvmlx"]),
        with("size", CORTEX_M0, &[], &["-Copt-level=s"]),
        with("libgcc", CORTEX_M0, &["libgcc"], &[]),
        with("libgcc", CORTEX_M3, &["libgcc"], &[]),
    ]);
    variants
}

/// Measures programs, one of which is `empty`, built in some ways.
///
/// # Errors
///
/// Where one cannot be built, run or read, or draws another picture than the host.
pub fn measure(
    variants: &[Variant<'_>],
    frames: &Frames,
    compiler: &str,
    plugin: &Path,
) -> Result<Vec<Row>> {
    let names: Vec<_> = frames.iter().map(|(name, _)| name.as_str()).collect();
    let mut rows = Vec::new();
    // Those that differ in nothing but the target are built at once.
    let is_same =
        |a: &Variant<'_>, b: &Variant<'_>| (a.profile, a.request) == (b.profile, b.request);
    for variants in variants.chunk_by(is_same) {
        let targets: Vec<_> = variants.iter().map(|variant| variant.target).collect();
        let request = Request {
            programs: &names,
            ..variants[0].request
        };
        let built = firmware::build(&targets, request)?;
        for (variant, programs) in variants.iter().zip(&built) {
            rows.extend(variant.measure(programs, frames, compiler, plugin)?);
        }
    }
    Ok(rows)
}

impl Variant<'_> {
    fn measure(
        &self,
        programs: &Programs,
        frames: &Frames,
        compiler: &str,
        plugin: &Path,
    ) -> Result<Vec<Row>> {
        let image = |name: &str| Image::read(programs.get(name).with_context(|| name.to_owned())?);
        let empty = image("empty")?;
        let rows = frames.par_iter().map(|(name, expected)| {
            let row = self.row(compiler, name, &image(name)?, &empty, expected, plugin);
            row.with_context(|| format!("{name} on {}, {}", self.target.name, self.profile))
        });
        rows.collect()
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
        // Plain C recurses, and GCC's library jumps to computed places.
        let is_bounded = !name.ends_with(&in_c("")) && !self.request.features.contains(&"libgcc");
        let bound = is_bounded.then(|| stack::bound(image, root));
        Ok(Row {
            compiler: compiler.to_owned(),
            profile: self.profile.to_owned(),
            target: self.target.name.to_owned(),
            program: name.to_owned(),
            flash: over(own_flash(image), own_flash(empty)),
            support: image.support_bytes(),
            static_ram: over(image.static_ram, empty.static_ram),
            stack: report.get("stack").copied().context("no stack depth")?,
            stack_bound: bound.transpose()?.map(|bound| bound.bytes),
            instructions: per_pixel(profile.total()),
            cycles: cycles.transpose()?.map(|cycles| per_pixel(cycles.total())),
            text: format!("{:016x}", image.text_checksum()),
            picture: format!("{:016x}", expected.picture(self.kind)),
        })
    }
}

/// Rows of the programs in plain C, where the parts are those of Arm, for which there is a compiler.
///
/// # Errors
///
/// As [`measure`].
pub fn measure_peers(
    targets: &[Target],
    rustflags: &[&str],
    compiler: &str,
    plugin: &Path,
) -> Result<Vec<Row>> {
    let peers = |target: &Target| Variant {
        profile: "speed",
        target: *target,
        kind: Kind::Rows,
        request: Request {
            features: &["peer"],
            rustflags,
            ..Request::default()
        },
    };
    let arm = targets
        .iter()
        .filter(|target| target.triple.starts_with("thumb"));
    let variants: Vec<_> = arm.map(peers).collect();
    let frames = Expected::all().into_iter().filter_map(|(name, expected)| {
        let is_peer = PEERS.contains(&name.as_str());
        let program = if is_peer { in_c(&name) } else { name };
        (is_peer || program == "empty").then_some((program, expected))
    });
    let frames: Vec<_> = frames.collect();
    let mut rows = measure(&variants, &frames, compiler, plugin)?;
    rows.retain(|row| row.program != "empty");
    Ok(rows)
}

/// All rows of the table.
///
/// # Errors
///
/// As [`measure`].
pub fn table(compiler: &str, plugin: &Path) -> Result<Vec<Row>> {
    let mut rows = measure(&variants(), &Expected::all(), compiler, plugin)?;
    rows.extend(measure_peers(&TARGETS, &[], compiler, plugin)?);
    Ok(rows)
}
