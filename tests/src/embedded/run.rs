//! Runs programs on their machines, within a time limit.

use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use anyhow::{Context, Result, bail, ensure};
use wait_timeout::ChildExt;

use super::image::Image;
use super::profile::Profile;
use super::target::{Machine, Target};

/// Longer than any frame here takes, also on a busy machine.
const TIME_LIMIT: Duration = Duration::from_secs(600);

/// What a program reported: numbers by name.
pub type Report = BTreeMap<String, u64>;

/// Whether the machine's program is installed.
pub fn is_available(machine: Machine) -> bool {
    let Some((program, _)) = emulator(machine) else {
        return true;
    };
    Command::new(program)
        .arg("--version")
        .stdout(Stdio::null())
        .status()
        .is_ok()
}

/// Runs a program and reads its report.
///
/// # Errors
///
/// Where it does not end in time and with success.
pub fn run(target: &Target, program: &Path) -> Result<Report> {
    parse_report(&output_of(&mut command(target.machine, program))?)
}

/// Runs a program in QEMU and counts what happens within calls of the given functions.
///
/// # Errors
///
/// Where it does not end in time and with success, or lacks a function.
pub fn run_counted(
    target: &Target,
    image: &Image,
    functions: &[&str],
    plugin: &Path,
) -> Result<(Report, Vec<Profile>)> {
    let counts = image.path.with_extension("counts");
    let mut argument = format!("{},out={}", plugin.display(), counts.display());
    for function in functions {
        argument += &format!(",function={:#x}", image.address(function)?);
    }
    let mut command = command(target.machine, &image.path);
    command.args(["-plugin", &argument]);
    let report = parse_report(&output_of(&mut command)?)?;
    let text = std::fs::read_to_string(&counts).with_context(|| counts.display().to_string())?;
    Ok((report, Profile::parse(&text, functions.len())?))
}

/// Builds the counting plugin.
///
/// # Errors
///
/// Where there is no C compiler, or it fails.
pub fn build_plugin(directory: &Path) -> Result<PathBuf> {
    std::fs::create_dir_all(directory)?;
    let plugin = directory.join("icount.so");
    let source = super::firmware::directory().join("icount.c");
    let status = Command::new("gcc")
        .args([
            "-O2", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", "-o",
        ])
        .arg(&plugin)
        .arg(source)
        .status()
        .context("gcc")?;
    ensure!(status.success(), "gcc could not build the counting plugin");
    Ok(plugin)
}

/// What runs a machine's programs, and how.
fn emulator(machine: Machine) -> Option<(&'static str, &'static [&'static str])> {
    match machine {
        Machine::Qemu(program, arguments) => Some((program, arguments)),
        Machine::Node => Some(("node", &[])),
        Machine::Native => None,
    }
}

fn command(machine: Machine, program: &Path) -> Command {
    let Some((emulator, arguments)) = emulator(machine) else {
        return Command::new(program);
    };
    let mut command = Command::new(emulator);
    command.args(arguments);
    if machine == Machine::Node {
        command.arg(super::firmware::directory().join("run.mjs"));
    } else {
        command.args([
            "-nographic",
            "-semihosting-config",
            "enable=on,target=native",
            "-kernel",
        ]);
    }
    command.arg(program);
    command
}

/// Standard output and standard error, on which QEMU writes semihosting's console.
fn output_of(command: &mut Command) -> Result<String> {
    let shown = format!("{command:?}");
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .with_context(|| shown.clone())?;
    // A report is far shorter than a pipe's buffer, so that it can be read after the end.
    let Some(status) = child.wait_timeout(TIME_LIMIT)? else {
        child.kill()?;
        child.wait()?;
        bail!("no end after {TIME_LIMIT:?}: {shown}");
    };
    let mut text = String::new();
    if let Some(mut out) = child.stdout.take() {
        out.read_to_string(&mut text)?;
    }
    if let Some(mut error) = child.stderr.take() {
        error.read_to_string(&mut text)?;
    }
    ensure!(status.success(), "{status}: {shown}\n{text}");
    Ok(text)
}

/// Lines of a name and a number in hexadecimal; other lines are the emulator's.
fn parse_report(text: &str) -> Result<Report> {
    let lines = text.lines().filter_map(|line| {
        let (name, value) = line.split_once(' ')?;
        (value.len() == 16).then_some(())?;
        Some((name.to_owned(), u64::from_str_radix(value, 16).ok()?))
    });
    let report: Report = lines.collect();
    ensure!(!report.is_empty(), "no report in: {text}");
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reports_are_read_among_other_lines() {
        let text =
            "Timer with period zero, disabling\nstack 00000000000001c0\nf32 aa0a305e835b8d02\n";
        let report = parse_report(text).unwrap();
        assert_eq!(report.get("stack"), Some(&448));
        assert_eq!(report.get("f32"), Some(&0xaa0a_305e_835b_8d02));
        assert_eq!(report.len(), 2);
        assert!(parse_report("panicked at").is_err());
    }

    #[test]
    fn failure_is_reported() {
        let error = output_of(Command::new("sh").args(["-c", "echo no; exit 7"])).unwrap_err();
        assert!(error.to_string().contains('7'), "{error}");
    }
}
