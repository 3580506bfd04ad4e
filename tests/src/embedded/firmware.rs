//! Builds the programs of `tests/firmware` for a target.

use std::collections::BTreeMap;
use std::env;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;

use anyhow::{Context, Result, bail};

use super::target::{Machine, Target};

/// How a program is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Rows of floats, in a buffer of one row.
    Rows,
    /// Through embedded-graphics onto a display's stand-in.
    Panel,
    /// Counting rays and hits.
    Counters,
}

impl Kind {
    /// What is measured: the function that draws.
    pub fn root(self) -> &'static str {
        match self {
            Self::Rows => "render_row",
            Self::Panel => "render_panel",
            Self::Counters => "main",
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Rows => "rows",
            Self::Panel => "panel",
            Self::Counters => "counters",
        }
    }
}

/// The result of a build.
#[derive(Clone, Debug)]
pub enum Build {
    /// Programs by name.
    Programs(BTreeMap<String, PathBuf>),
    /// There is no compiler for the target here; why, in words.
    NoCompiler(String),
}

/// More for one build.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options<'a> {
    /// Further features of the firmware.
    pub features: &'a [&'a str],
    /// Further compiler flags.
    pub rustflags: &'a [&'a str],
    /// For size instead of speed.
    pub small: bool,
    /// Build the project at this root instead: a copy of it.
    pub root: Option<&'a Path>,
}

/// Where the firmware's sources are.
pub fn directory() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("firmware")
}

/// Where builds, and what is measured of them, go.
pub fn build_directory() -> PathBuf {
    let target =
        env::var_os("CARGO_TARGET_DIR").map_or_else(|| workspace().join("target"), PathBuf::from);
    workspace().join(target).join("firmware")
}

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The compiler that builds, and whether it comes with `core`; `None` where there is none.
///
/// # Errors
///
/// Where the script cannot be run.
pub fn compiler() -> Result<Option<String>> {
    let output = script(&workspace())
        .arg("compiler")
        .output()
        .context("tests/embedded.sh")?;
    let text = String::from_utf8(output.stdout)?;
    Ok(output.status.success().then(|| text.trim().to_owned()))
}

fn script(root: &Path) -> Command {
    Command::new(root.join("tests/embedded.sh"))
}

/// Builds all programs for a target.
///
/// # Errors
///
/// Where the compiler or the linker refuses.
pub fn build(target: &Target, kind: Kind) -> Result<Build> {
    build_with(target, kind, Options::default())
}

/// Builds all programs for a target, with options.
///
/// # Errors
///
/// Where the compiler or the linker refuses.
pub fn build_with(target: &Target, kind: Kind, options: Options<'_>) -> Result<Build> {
    // Builds of one target share their directory: one at a time.
    static BUILDING: Mutex<()> = Mutex::new(());
    let _building = BUILDING.lock();

    let workspace = workspace();
    let mut features = options.features.to_vec();
    if kind != Kind::Rows {
        features.push(kind.name());
    }
    let mut command = script(options.root.unwrap_or(&workspace));
    command.args([
        "build",
        target.triple,
        "--bins",
        "--features",
        &features.join(","),
    ]);
    let flags = [target.rustflags, options.rustflags].concat();
    if !flags.is_empty() {
        let list = flags
            .iter()
            .map(|flag| format!("{flag:?}"))
            .collect::<Vec<_>>()
            .join(",");
        command.args([
            "--config",
            &format!("target.{}.rustflags=[{list}]", target.triple),
        ]);
    }
    if options.small {
        command.args(["--config", "profile.release.opt-level=\"s\""]);
    }
    // Flags go into every crate, also into the compiler's own: apart, or all of them would be built
    // again each time that the flags change.
    let mut apart = flags.join("").replace(['=', ','], "");
    if options.small {
        apart += "-small";
    }
    let directory = build_directory().join(apart);
    command.arg("--target-dir").arg(&directory);
    let output = command.output().context("tests/embedded.sh")?;
    let said = String::from_utf8_lossy(&output.stderr);
    match output.status.code() {
        Some(0) => {}
        Some(77) => return Ok(Build::NoCompiler(said.into_owned())),
        _ => bail!("{command:?}:\n{said}"),
    }

    let built = directory.join(target.triple).join("release");
    let kept = directory
        .join("programs")
        .join(target.name)
        .join(features.join("-"));
    fs::create_dir_all(&kept)?;
    let mut programs = BTreeMap::new();
    for name in names()? {
        let file = match target.machine {
            Machine::Qemu(..) => name.clone(),
            Machine::Node => format!("{name}.wasm"),
        };
        let program = kept.join(&file);
        // The next kind's build overwrites this one's.
        fs::copy(built.join(&file), &program).with_context(|| file.clone())?;
        programs.insert(name, program);
    }
    Ok(Build::Programs(programs))
}

/// Names of the programs.
///
/// # Errors
///
/// Where their directory cannot be read.
pub fn names() -> Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(directory().join("src/bin"))? {
        let path = entry?.path();
        if path.extension() == Some(OsStr::new("rs")) {
            names.extend(path.file_stem().and_then(OsStr::to_str).map(str::to_owned));
        }
    }
    names.sort();
    Ok(names)
}
