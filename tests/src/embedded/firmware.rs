//! Builds the programs of `tests/firmware` for targets.

use std::collections::BTreeMap;
use std::env;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;

use anyhow::{Context, Result, bail};

use super::target::{Machine, Target};

/// Executables by name.
pub type Programs = BTreeMap<String, PathBuf>;

/// What to build, and how.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Request<'a> {
    /// Names of programs.
    pub programs: &'a [&'a str],
    /// Features of the firmware.
    pub features: &'a [&'a str],
    /// Compiler flags beyond the target's.
    pub rustflags: &'a [&'a str],
    /// Where `whitted bake` has put scenes.
    pub baked: Option<&'a Path>,
    /// Where the code of the page for firmware's authors is.
    pub page: Option<&'a Path>,
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

/// Builds the same programs for each target, those with the same flags at once.
///
/// # Errors
///
/// Where there is no compiler, or it or the linker refuses.
pub fn build(targets: &[Target], request: Request<'_>) -> Result<Vec<Programs>> {
    // Cargo holds a build directory for one build; waiting for it would count against time limits.
    static BUILDING: Mutex<()> = Mutex::new(());
    let _building = BUILDING.lock();

    let mut groups: BTreeMap<(bool, Vec<&str>), Vec<Target>> = BTreeMap::new();
    for target in targets {
        let flags = [target.rustflags, request.rustflags].concat();
        let is_native = target.machine == Machine::Native;
        groups.entry((is_native, flags)).or_default().push(*target);
    }
    let mut built = BTreeMap::new();
    for ((_, flags), targets) in &groups {
        let directory = build_group(targets, flags, &request)?;
        for target in targets {
            built.insert(target.name, keep(target, &directory, &request)?);
        }
    }
    let all = targets.iter().map(|target| built[target.name].clone());
    Ok(all.collect())
}

/// Builds for targets with the same flags, and tells where.
fn build_group(targets: &[Target], flags: &[&str], request: &Request<'_>) -> Result<PathBuf> {
    let workspace = workspace();
    let mut command = script(request.root.unwrap_or(&workspace));
    let triples: Vec<_> = targets.iter().map(|target| target.triple).collect();
    command.args(["build", &triples.join(",")]);
    command.args(["--features", &request.features.join(",")]);
    for program in request.programs {
        command.args(["--bin", program]);
    }
    if !flags.is_empty() {
        let list: Vec<_> = flags.iter().map(|flag| format!("{flag:?}")).collect();
        let list = list.join(",");
        for triple in triples {
            command.args(["--config", &format!("target.{triple}.rustflags=[{list}]")]);
        }
    }
    if let Some(baked) = request.baked {
        command.env("WHITTED_BAKED", baked);
    }
    if let Some(page) = request.page {
        command.env("WHITTED_PAGE", page);
    }
    // Flags go into every crate, also into the compiler's own: apart, or all of them would be built
    // again each time that the flags change.
    let apart = flags.join("").replace(['=', ','], "");
    let directory = build_directory().join(apart);
    command.arg("--target-dir").arg(&directory);
    let output = command.output().context("tests/embedded.sh")?;
    if !output.status.success() {
        bail!("{command:?}:\n{}", String::from_utf8_lossy(&output.stderr));
    }
    Ok(directory)
}

/// Copies a target's programs to where the next build does not overwrite them.
fn keep(target: &Target, directory: &Path, request: &Request<'_>) -> Result<Programs> {
    let built = match target.machine {
        Machine::Native => directory.join("release"),
        _ => directory.join(target.triple).join("release"),
    };
    let kept = request
        .root
        .unwrap_or(directory)
        .join("programs")
        .join(target.name)
        .join(request.features.join("-"));
    fs::create_dir_all(&kept)?;
    let mut programs = Programs::new();
    for name in request.programs {
        let file = match target.machine {
            Machine::Qemu(..) | Machine::Native => (*name).to_owned(),
            Machine::Node => format!("{name}.wasm"),
        };
        let program = kept.join(&file);
        fs::copy(built.join(&file), &program).with_context(|| file.clone())?;
        programs.insert((*name).to_owned(), program);
    }
    Ok(programs)
}

/// Names of the programs that draw one frame and need no feature.
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
    names.retain(|name| !name.starts_with("frame"));
    names.sort();
    Ok(names)
}
