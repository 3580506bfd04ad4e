//! Prices of all methods on the parts: builds `tests/firmware/examples/methods.rs`, runs it in QEMU
//! and counts.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result, ensure};
use whitted_methods::price::{self, EMPTY, Entry, Meter};

use super::cycles::Price;
use crate::embedded::image::Image;
use crate::embedded::profile::Profile;
use crate::embedded::target::{CORTEX_M0, CORTEX_M4F, Target};
use crate::embedded::{cortex_m4, firmware, run};

/// What the firmware runs, in its order.
struct Entries(Vec<Entry>);

impl Meter for Entries {
    fn measure(&mut self, entry: Entry, _: impl FnMut()) {
        self.0.push(entry);
    }
}

/// Prices everything.
///
/// # Errors
///
/// Where the firmware cannot be built, run or counted; `tests/embedded.sh setup` installs what that
/// takes.
pub fn measure() -> Result<Vec<Price>> {
    let mut entries = Entries(Vec::new());
    price::all(&mut entries);
    let plugin = run::build_plugin(&firmware::build_directory())?;
    let mut prices = Vec::new();
    for (name, target) in [("cortex-m4f", CORTEX_M4F), ("cortex-m0", CORTEX_M0)] {
        let image = Image::read(&build(&target)?)?;
        let slots: Vec<String> = (0..entries.0.len()).map(|i| format!("slot_{i}")).collect();
        let slots: Vec<&str> = slots.iter().map(String::as_str).collect();
        let (report, profiles) = run::run_counted(&target, &image, &slots, &plugin)?;
        let ran = report.get("entries").copied();
        ensure!(
            ran == Some(slots.len() as u64),
            "the firmware ran {ran:?} entries"
        );
        let mut empty = None;
        for (entry, profile) in entries.0.iter().zip(&profiles) {
            ensure!(profile.calls == 1, "{entry:?} ran {} times", profile.calls);
            let count = Count::of(&image, profile, target == CORTEX_M4F)?;
            if entry.method == EMPTY {
                empty = Some(count);
            } else {
                let empty = empty.as_ref().context("the empty method comes first")?;
                prices.push(count.price(entry, empty, name, &image));
            }
        }
    }
    Ok(prices)
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

    fn price(&self, entry: &Entry, empty: &Self, target: &str, image: &Image) -> Price {
        let each = |all: u64, empty: u64| (all as f64 - empty as f64) / f64::from(entry.calls);
        let own = self.functions.difference(&empty.functions);
        Price {
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

fn build(target: &Target) -> Result<PathBuf> {
    let root = firmware::directory().join("../..");
    let directory = firmware::build_directory().join("methods");
    let status = Command::new(root.join("tests/embedded.sh"))
        .args([
            "build",
            target.triple,
            "--example",
            "methods",
            "--target-dir",
        ])
        .arg(&directory)
        .status()
        .context("tests/embedded.sh")?;
    ensure!(
        status.success(),
        "tests/embedded.sh could not build the methods"
    );
    Ok(directory
        .join(target.triple)
        .join("release/examples/methods"))
}
