//! Copies of the project, to see what a change in `core` does to the firmware.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use super::firmware;

/// What firmware is built from, elsewhere.
#[derive(Debug)]
pub struct Copy {
    root: PathBuf,
}

/// A place in a project's file: the body of the function that comes after all of these, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Body {
    /// In the project.
    pub file: &'static str,
    /// Say, an `impl` and then a `fn`.
    pub after: &'static [&'static str],
}

impl Copy {
    /// Copies `core`, the firmware, what it is built from, and the script.
    ///
    /// # Errors
    ///
    /// Where files cannot be read or written.
    pub fn new(name: &str) -> Result<Self> {
        let root = firmware::build_directory().join("copies").join(name);
        if root.exists() {
            fs::remove_dir_all(&root)?;
        }
        let project = firmware::directory().join("../..");
        for directory in ["core", "tests/methods", "tests/firmware"] {
            copy_directory(&project.join(directory), &root.join(directory))?;
        }
        fs::copy(
            project.join("tests/embedded.sh"),
            root.join("tests/embedded.sh"),
        )?;
        // Of the workspace only what the firmware is built from.
        let manifest = fs::read_to_string(project.join("Cargo.toml"))?;
        let lines = manifest
            .lines()
            .filter(|line| !line.starts_with("default-members"));
        let lines = lines.map(|line| match line.split_once(" = ") {
            Some(("members", _)) => "members = [\"core\", \"tests/methods\"]",
            _ => line,
        });
        fs::write(
            root.join("Cargo.toml"),
            lines.collect::<Vec<_>>().join("\n"),
        )?;
        Ok(Self { root })
    }

    /// Where it is.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Puts statements at the start of a function's body, and hands back the file as it was.
    ///
    /// # Errors
    ///
    /// Where the file has no such place.
    pub fn insert(&self, body: &Body, statements: &str) -> Result<Original> {
        let path = self.root.join(body.file);
        let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
        let mut place = 0;
        for landmark in body.after.iter().chain(&[" {\n"]) {
            let found = text.get(place..).and_then(|rest| rest.find(landmark));
            let found = found.with_context(|| format!("{} has no {landmark:?}", body.file))?;
            place += found + landmark.len();
        }
        let changed = format!("{}{statements}\n{}", &text[..place], &text[place..]);
        fs::write(&path, changed)?;
        Ok(Original { path, text })
    }
}

/// A file before it was changed.
#[derive(Debug)]
pub struct Original {
    path: PathBuf,
    text: String,
}

impl Original {
    /// Takes the change back.
    ///
    /// # Errors
    ///
    /// Where the file cannot be written.
    pub fn restore(self) -> Result<()> {
        Ok(fs::write(self.path, self.text)?)
    }
}

fn copy_directory(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from).with_context(|| from.display().to_string())? {
        let entry = entry?;
        let copy = to.join(entry.file_name());
        if !entry.file_type()?.is_dir() {
            fs::copy(entry.path(), copy)?;
        } else if entry.file_name() != "target" {
            copy_directory(&entry.path(), &copy)?;
        }
    }
    Ok(())
}
