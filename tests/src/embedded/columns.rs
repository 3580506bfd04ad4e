//! What a map by columns takes on the parts: a picture of 160×120 pixels, with textures and sprites.

use std::hash::Hasher;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use embedded_graphics::pixelcolor::{IntoStorage, Rgb565};
use fnv::FnvHasher;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use whitted::columns::ColumnPicture;
use whitted::grid::Plan;

use super::firmware::{self, Request};
use super::image::Image;
use super::scenes::castle::{COLUMNS, COLUMNS_VIEW, COLUMNS_WITH_DOORS, VIEW_OF_DOORS};
use super::target::{CORTEX_M4F, Machine, TARGETS, Target};
use super::{cortex_m4, run, stack};
use crate::lab;

/// The programs: a map, and one with doors.
pub const PROGRAMS: [&str; 2] = ["frame-columns", "frame-doors"];

/// What they do once a frame, and for each column.
const FUNCTIONS: [&str; 2] = ["start_picture", "render_column"];

/// The picture on one target.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// Of [`PROGRAMS`].
    pub program: String,
    /// The compiler that made the program.
    pub compiler: String,
    /// As in [`Target::name`].
    pub target: String,
    /// Bytes of flash over the empty program, map and textures included, without the support library.
    pub flash: i64,
    /// Bytes of the compiler's support library.
    pub support: u64,
    /// The deepest stack below the caller, by painting.
    pub stack: u64,
    /// What it can be at most, from the instructions.
    pub stack_bound: u64,
    /// Instructions a frame.
    pub instructions: u64,
    /// Estimated cycles a frame, on the Cortex-M4F.
    pub cycles: Option<u64>,
    /// Checksum of the pixels.
    pub picture: String,
}

/// Checksum of the pixels that the host computes, column by column, high byte first.
pub fn expected(program: &str) -> u64 {
    if program == PROGRAMS[0] {
        checksum(&COLUMNS.picture(&COLUMNS_VIEW), COLUMNS_VIEW.width)
    } else {
        let picture = COLUMNS_WITH_DOORS.picture(&VIEW_OF_DOORS);
        checksum(&picture, VIEW_OF_DOORS.width)
    }
}

fn checksum<G>(picture: &ColumnPicture<'static, Rgb565, 2, u8, G>, width: u32) -> u64
where
    G: Plan<'static>,
{
    let mut hasher = FnvHasher::default();
    for pixel in (0..width).flat_map(|column| picture.pixels(column)) {
        hasher.write(&pixel.into_storage().to_be_bytes());
    }
    hasher.finish()
}

/// Those on which instructions can be counted.
pub fn targets() -> Vec<Target> {
    let is_counted = |target: &Target| matches!(target.machine, Machine::Qemu(..));
    TARGETS.into_iter().filter(is_counted).collect()
}

/// Draws the pictures on each target and compares them with the host's.
///
/// # Errors
///
/// Where a program cannot be built or run, or draws another picture.
pub fn check(targets: &[Target]) -> Result<()> {
    let request = Request {
        programs: &PROGRAMS,
        ..Request::default()
    };
    let built = firmware::build(targets, request)?;
    for (target, built) in targets.iter().zip(&built) {
        for program in PROGRAMS {
            let report = run::run(target, &built[program])?;
            check_report(program, &report)
                .with_context(|| format!("{program}, {}", target.name))?;
        }
    }
    Ok(())
}

fn check_report(program: &str, report: &run::Report) -> Result<()> {
    let (reported, expected) = (report.get("565").copied(), expected(program));
    ensure!(
        reported == Some(expected),
        "the pixels' checksum is {reported:x?}, on the host {expected:x}"
    );
    Ok(())
}

/// Measures the programs on QEMU's targets.
///
/// # Errors
///
/// As [`check`], and where it cannot be read.
pub fn measure(targets: &[Target], compiler: &str, plugin: &Path) -> Result<Vec<Cost>> {
    let request = Request {
        programs: &["empty", PROGRAMS[0], PROGRAMS[1]],
        ..Request::default()
    };
    let built = firmware::build(targets, request)?;
    let all = PROGRAMS.iter().flat_map(|&program| {
        let targets = targets.iter().zip(&built);
        targets.map(move |(target, programs)| (program, target, programs))
    });
    let all: Vec<_> = all.collect();
    let costs = all.into_par_iter().map(|(program, target, programs)| {
        let (empty, image) = (
            Image::read(&programs["empty"])?,
            Image::read(&programs[program])?,
        );
        let (report, profiles) = run::run_counted(target, &image, &FUNCTIONS, plugin)?;
        check_report(program, &report).with_context(|| target.name)?;
        let bounds = FUNCTIONS.map(|function| stack::bound(&image, function));
        let bounds = bounds.into_iter().collect::<Result<Vec<_>>>()?;
        let mut cost = Cost {
            program: program.to_owned(),
            compiler: compiler.to_owned(),
            target: target.name.to_owned(),
            flash: own_flash(&image) - own_flash(&empty),
            support: image.support_bytes(),
            stack: report.get("stack").copied().context("no stack depth")?,
            stack_bound: bounds.iter().map(|it| it.bytes).max().unwrap_or(0),
            instructions: profiles.iter().map(|profile| profile.total()).sum(),
            cycles: None,
            picture: format!("{:016x}", expected(program)),
        };
        if *target == CORTEX_M4F {
            let totals = profiles
                .iter()
                .map(|profile| cortex_m4::total(&image, profile));
            let totals = totals.collect::<Result<Vec<_>>>()?;
            cost.cycles = Some(totals.iter().map(|total| total.total()).sum());
        }
        Ok(cost)
    });
    costs.collect()
}

fn own_flash(image: &Image) -> i64 {
    image.flash as i64 - image.support_bytes() as i64
}

fn path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("charts/firmware-columns.csv")
}

/// What `tests/charts/firmware-columns.csv` says.
///
/// # Errors
///
/// Where it cannot be read.
pub fn read() -> Result<Vec<Cost>> {
    let mut reader = csv::Reader::from_path(path())?;
    Ok(reader.deserialize().collect::<Result<_, _>>()?)
}

/// Writes that file.
///
/// # Errors
///
/// Where it cannot be written.
pub fn write(costs: &[Cost]) -> Result<()> {
    Ok(lab::table(&path(), costs)?)
}
