//! What each method costs on a part, as counted there: `tests/charts/cycles.csv`.
//!
//! A firmware counts what [`whitted_methods::price`] runs and writes a line for each entry. The charts
//! need no cross toolchain: they read the committed lines.

use std::path::Path;

use serde::de::DeserializeOwned;

/// A line of `cycles.csv`.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Price {
    /// By which compiler, and with which core library.
    pub compiler: String,
    /// As in [`whitted_methods::price::Entry`].
    pub stage: String,
    /// Which inputs.
    pub case: String,
    /// By which method.
    pub method: String,
    /// On which part: `cortex-m4f`, `cortex-m0`.
    pub target: String,
    /// Estimated, a call; only where there is a model of the part.
    pub cycles: Option<f64>,
    /// Counted, a call.
    pub instructions: f64,
    /// Size of all functions that ran.
    pub bytes: u64,
}

/// All lines of a table; none if there is no such file.
///
/// # Errors
///
/// Where the file is there and cannot be read.
pub fn read<L: DeserializeOwned>(path: &Path) -> Result<Vec<L>, csv::Error> {
    if path.exists() {
        csv::Reader::from_path(path)?.deserialize().collect()
    } else {
        Ok(Vec::new())
    }
}

/// What is prepared once a ray for a method, as named in the stage `setup`.
pub fn setup(stage: &str, method: &str) -> Option<&'static str> {
    match (stage, method) {
        ("polygon" | "triangle", "core") => Some("polygon core"),
        (
            "polygon",
            "fan, Woop" | "sheared crossings" | "sheared, lazy" | "sheared, plane first",
        ) => Some("polygon shear"),
        ("triangle", "Woop" | "sheared crossings" | "sheared, lazy") => Some("polygon shear"),
        ("cuboid", "core") => Some("cuboid core"),
        ("cuboid", "slabs, divide, swap" | "fractions" | "branch on zero" | "f64") => None,
        ("cuboid", _) => Some("cuboid reciprocal"),
        _ => None,
    }
}

/// Estimated cycles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Of a call.
    pub call: f64,
    /// Of a call and what is prepared for it.
    pub prepared: f64,
}

/// What a method costs on a part, for each case in the order of the file; none where it lacks one.
pub fn costs(prices: &[Price], target: &str, stage: &str, method: &str) -> Vec<Cost> {
    let of = |stage: &str, method: &str| -> Vec<f64> {
        let is = |price: &&Price| {
            (price.target.as_str(), price.stage.as_str()) == (target, stage)
                && price.method == method
        };
        prices
            .iter()
            .filter(is)
            .filter_map(|price| price.cycles)
            .collect()
    };
    let setup = match setup(stage, method) {
        Some(setup) => match of("setup", setup)[..] {
            [cycles] => cycles,
            _ => return Vec::new(),
        },
        None => 0.0,
    };
    let cost = |call: f64| Cost {
        call,
        prepared: call + setup,
    };
    of(stage, method).into_iter().map(cost).collect()
}
