//! Prices on the parts: builds `tests/firmware/examples`, runs them in QEMU and counts.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result, ensure};
use whitted_methods::frames::{PRICED, Setting, checksum, settings};
use whitted_methods::price::{self, EMPTY, Entry, Meter};

use super::cycles::Price;
use super::frames::FramePrice;
use super::front::TARGET;
use crate::embedded::image::Image;
use crate::embedded::profile::Profile;
use crate::embedded::run::Report;
use crate::embedded::target::{CORTEX_M0, CORTEX_M4F, Target};
use crate::embedded::{cortex_m4, firmware, run};

/// What the firmware runs, in its order.
struct Entries(Vec<Entry>);

impl Meter for Entries {
    fn measure(&mut self, entry: Entry, _: impl FnMut()) {
        self.0.push(entry);
    }
}

/// Whether the compiler and the emulator for that are here.
pub fn is_possible() -> bool {
    matches!(firmware::compiler(), Ok(Some(_))) && run::is_available(CORTEX_M4F.machine)
}

/// What ran in the slots of one of the firmware's examples.
struct Counted {
    image: Image,
    report: Report,
    profiles: Vec<Profile>,
}

impl Counted {
    /// Builds an example for a part and runs it there, with `slots` things to count.
    fn run(example: &str, target: &Target, slots: usize) -> Result<Self> {
        let plugin = run::build_plugin(&firmware::build_directory())?;
        let image = Image::read(&build(example, target)?)?;
        let names: Vec<String> = (0..slots).map(|i| format!("slot_{i}")).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let (report, profiles) = run::run_counted(target, &image, &names, &plugin)?;
        let ran = report.get("entries").copied();
        ensure!(ran == Some(slots as u64), "{example} ran {ran:?} entries");
        ensure!(
            profiles.iter().all(|profile| profile.calls == 1),
            "an entry of {example} did not run once"
        );
        Ok(Self {
            image,
            report,
            profiles,
        })
    }
}

type Show = fn(&mut Entries);

/// The programs, and what they run.
const PROGRAMS: [(&str, Show); 2] = [("methods", price::all), ("joined", price::joined)];

/// Prices all methods.
///
/// # Errors
///
/// Where the firmware cannot be built, run or counted; `tests/embedded.sh setup` installs what that
/// takes.
pub fn measure() -> Result<Vec<Price>> {
    let compiler = firmware::compiler()?.context("no compiler")?;
    let mut prices = Vec::new();
    for (name, target) in [(TARGET, CORTEX_M4F), ("cortex-m0", CORTEX_M0)] {
        for (program, show) in PROGRAMS {
            let mut entries = Entries(Vec::new());
            show(&mut entries);
            let counted = Counted::run(program, &target, entries.0.len())?;
            let mut empty = None;
            for (entry, profile) in entries.0.iter().zip(&counted.profiles) {
                let count = Count::of(&counted.image, profile, target == CORTEX_M4F)?;
                if entry.method == EMPTY {
                    empty = Some(count);
                } else {
                    let empty = empty.as_ref().context("the empty method comes first")?;
                    prices.push(count.price(entry, empty, &compiler, name, &counted.image));
                }
            }
        }
    }
    Ok(prices)
}

/// Prices the standard scene's frame in every setting, on the Cortex-M4F.
///
/// # Errors
///
/// As [`measure`], and where the part draws another picture than the host.
pub fn frames() -> Result<Vec<FramePrice>> {
    let settings: Vec<Setting> = settings().collect();
    let counted = Counted::run("frames", &CORTEX_M4F, settings.len())?;
    let (there, here) = (counted.report.get("frames").copied(), checksum());
    ensure!(
        there == Some(here),
        "the frames' checksum is {there:x?}, on the host {here:x}"
    );
    let pixels = f64::from(PRICED.width * PRICED.height);
    let price = |(setting, profile): (Setting, &Profile)| {
        let count = Count::of(&counted.image, profile, true)?;
        let cycles = count.cycles.context("no model of the part")?;
        let each = |all: u64| (all as f64 / pixels * 10.0).round() / 10.0;
        Ok(FramePrice::new(
            setting,
            each(cycles),
            each(count.instructions),
        ))
    };
    settings
        .into_iter()
        .zip(&counted.profiles)
        .map(price)
        .collect()
}

/// What ran in one slot.
struct Count {
    instructions: u64,
    cycles: Option<u64>,
    /// Addresses of the functions that ran.
    functions: BTreeSet<u64>,
}

impl Count {
    fn of(image: &Image, profile: &Profile, estimate: bool) -> Result<Self> {
        let function = |address: u64| {
            let (start, function) = image.functions.range(..=address).next_back()?;
            (address < start + function.size).then_some(*start)
        };
        let cycles = match estimate {
            true => Some(cortex_m4::total(image, profile)?.total()),
            false => None,
        };
        Ok(Self {
            instructions: profile.total(),
            cycles,
            functions: profile
                .instructions
                .keys()
                .filter_map(|place| function(place.address))
                .collect(),
        })
    }

    fn price(
        &self,
        entry: &Entry,
        empty: &Self,
        compiler: &str,
        target: &str,
        image: &Image,
    ) -> Price {
        let each = |all: u64, empty: u64| (all as f64 - empty as f64) / f64::from(entry.calls);
        let own = self.functions.difference(&empty.functions);
        Price {
            compiler: compiler.into(),
            stage: entry.stage.into(),
            case: entry.case.into(),
            method: entry.method.into(),
            target: target.into(),
            cycles: self
                .cycles
                .zip(empty.cycles)
                .map(|(all, empty)| each(all, empty)),
            instructions: each(self.instructions, empty.instructions),
            bytes: own.map(|start| image.functions[start].size).sum(),
        }
    }
}

fn build(example: &str, target: &Target) -> Result<PathBuf> {
    let root = firmware::directory().join("../..");
    let directory = firmware::build_directory().join("methods");
    let status = Command::new(root.join("tests/embedded.sh"))
        .args(["build", target.triple, "--example", example, "--target-dir"])
        .arg(&directory)
        .status()
        .context("tests/embedded.sh")?;
    ensure!(
        status.success(),
        "tests/embedded.sh could not build {example}"
    );
    Ok(directory
        .join(target.triple)
        .join("release/examples")
        .join(example))
}
