//! Where pictures are written: standard output, or a file that is replaced whole or not at all.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Stdout, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::NamedTempFile;

/// A file, pipe or device being written. What is dropped before [`commit`](Self::commit) leaves an
/// existing file as it was.
pub struct Output {
    kind: Kind,
}

enum Kind {
    Stdout,
    /// A pipe or a device: there is nothing to keep.
    Direct(File),
    /// Beside the file that it will replace, so that both are on one file system.
    Temporary {
        file: NamedTempFile,
        target: PathBuf,
        pending: Pending,
    },
}

/// The temporary file that exists at the moment: a command writes one picture at a time.
static PENDING: Mutex<Option<PathBuf>> = Mutex::new(None);

/// Unsets [`PENDING`] when it goes.
struct Pending;

impl Drop for Pending {
    fn drop(&mut self) {
        *pending() = None;
    }
}

fn pending() -> MutexGuard<'static, Option<PathBuf>> {
    PENDING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Lets an interrupted or terminated program remove its temporary file before it ends.
pub fn clean_up_when_interrupted() {
    // Without a handler the program still ends, and only leaves the file.
    let _ = ctrlc::set_handler(|| {
        if let Some(path) = pending().take() {
            let _ = fs::remove_file(path);
        }
        // What shells report for an interrupt.
        std::process::exit(130);
    });
}

/// Where an output's bytes go. Not buffered: whoever writes, writes much at a time.
pub enum Sink {
    /// Standard output.
    Stdout(Stdout),
    /// Anything else.
    File(File),
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Stdout(stdout) => stdout.write(bytes),
            Self::File(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Stdout(stdout) => stdout.flush(),
            Self::File(file) => file.flush(),
        }
    }
}

impl Output {
    /// Standard output for `-`; pipes and devices as they are; for any other path a temporary file in
    /// the same directory. A link is followed: what it names is replaced, the link stays.
    ///
    /// # Errors
    ///
    /// Where nothing could be written later: no such directory, no permission, a directory itself.
    pub fn create(path: &Path) -> io::Result<Self> {
        Ok(Self {
            kind: Kind::create(path)?,
        })
    }

    /// Where to write.
    ///
    /// # Errors
    ///
    /// Where the system has no more handles.
    pub fn sink(&self) -> io::Result<Sink> {
        Ok(match &self.kind {
            Kind::Stdout => Sink::Stdout(io::stdout()),
            Kind::Direct(file) => Sink::File(file.try_clone()?),
            Kind::Temporary { file, .. } => Sink::File(file.as_file().try_clone()?),
        })
    }

    /// Makes what was written the file's content.
    ///
    /// # Errors
    ///
    /// Where the file cannot be replaced.
    pub fn commit(self) -> io::Result<()> {
        match self.kind {
            Kind::Stdout | Kind::Direct(_) => Ok(()),
            Kind::Temporary {
                file,
                target,
                pending,
            } => {
                let replaced = file.persist(target);
                drop(pending);
                replaced.map(drop).map_err(|it| it.error)
            }
        }
    }
}

impl Kind {
    fn create(path: &Path) -> io::Result<Self> {
        if is_stdout(path) {
            return Ok(Self::Stdout);
        }
        let target = followed(path)?;
        match fs::metadata(&target) {
            Ok(metadata) if metadata.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
            Ok(metadata) if metadata.is_file() && !is_descriptor(&target) => {
                // A rename needs no permission to write the file that it replaces. Ask for it.
                OpenOptions::new().write(true).open(&target)?;
                let temporary = Self::temporary(target)?;
                if let Self::Temporary { file, .. } = &temporary {
                    file.as_file().set_permissions(metadata.permissions())?;
                }
                Ok(temporary)
            }
            // Without truncation: another program may own what was written before.
            Ok(_) => Ok(Self::Direct(OpenOptions::new().write(true).open(&target)?)),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Self::temporary(target),
            Err(error) => Err(error),
        }
    }

    fn temporary(target: PathBuf) -> io::Result<Self> {
        let directory = match target.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        let guard = Pending;
        let file = tempfile::Builder::new()
            .prefix(".whitted-")
            .suffix(".part")
            .make_in(directory, |path| {
                *pending() = Some(path.to_owned());
                // With the permissions of any new file: tempfile's own would be the user's alone.
                File::create_new(path)
            })?;
        Ok(Self::Temporary {
            file,
            target,
            pending: guard,
        })
    }
}

/// Whether this path means standard output.
pub fn is_stdout(path: &Path) -> bool {
    ["-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"]
        .iter()
        .any(|it| path == Path::new(it))
}

/// Whether this path names no file of its own but whatever a program has open.
fn is_descriptor(path: &Path) -> bool {
    path.starts_with("/proc") || path.starts_with("/dev/fd")
}

/// Whether there is something at this path to which bytes can go that is not a file: a pipe or a
/// device.
pub fn is_special(path: &Path) -> bool {
    is_stdout(path) || fs::metadata(path).is_ok_and(|it| !it.is_file() && !it.is_dir())
}

/// The path behind symbolic links, whether there is anything there or not.
fn followed(path: &Path) -> io::Result<PathBuf> {
    const MOST_LINKS: usize = 40;
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        // What /proc shows as a link may name a file that is gone.
        if is_descriptor(&path) {
            return Ok(path);
        }
        match fs::symlink_metadata(&path) {
            Ok(metadata) if metadata.is_symlink() => {
                let next = fs::read_link(&path)?;
                path = match path.parent() {
                    Some(parent) => parent.join(next),
                    None => next,
                };
            }
            _ => return Ok(path),
        }
    }
    Err(io::Error::other("too many symbolic links"))
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::{PermissionsExt, symlink};

    use super::*;

    fn mode(path: &Path) -> u32 {
        fs::metadata(path).unwrap().permissions().mode() & 0o777
    }

    fn write(path: &Path, bytes: &[u8]) {
        let output = Output::create(path).unwrap();
        output.sink().unwrap().write_all(bytes).unwrap();
        output.commit().unwrap();
    }

    /// The names in a directory, and that nothing temporary is left there.
    fn names(directory: &Path) -> Vec<String> {
        let entries = fs::read_dir(directory).unwrap();
        let mut names: Vec<_> = entries
            .map(|it| it.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_changes_only_when_it_is_committed() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a");
        fs::write(&path, "old").unwrap();
        let output = Output::create(&path).unwrap();
        output.sink().unwrap().write_all(b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"old");
        drop(output);
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(directory.path()), ["a"]);
        write(&path, b"new");
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(names(directory.path()), ["a"]);
    }

    #[test]
    fn permissions_are_those_of_the_file_or_of_any_new_file() {
        let directory = tempfile::tempdir().unwrap();
        let (old, new, plain) = (
            directory.path().join("old"),
            directory.path().join("new"),
            directory.path().join("plain"),
        );
        fs::write(&old, "").unwrap();
        fs::set_permissions(&old, fs::Permissions::from_mode(0o640)).unwrap();
        write(&old, b"x");
        assert_eq!(mode(&old), 0o640);
        File::create(&plain).unwrap();
        write(&new, b"x");
        assert_eq!(mode(&new), mode(&plain));
    }

    #[test]
    fn links_stay_and_what_they_name_is_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let path = |name: &str| directory.path().join(name);
        fs::create_dir(path("far")).unwrap();
        fs::write(path("far/file"), "old").unwrap();
        symlink("far/file", path("link")).unwrap();
        symlink("far/missing", path("dangling")).unwrap();
        write(&path("link"), b"new");
        write(&path("dangling"), b"new");
        assert!(fs::symlink_metadata(path("link")).unwrap().is_symlink());
        assert!(fs::symlink_metadata(path("dangling")).unwrap().is_symlink());
        assert_eq!(names(&path("far")), ["file", "missing"]);
        assert_eq!(fs::read(path("far/file")).unwrap(), b"new");
        assert_eq!(fs::read(path("far/missing")).unwrap(), b"new");
        symlink("circle", path("circle")).unwrap();
        assert!(Output::create(&path("circle")).is_err());
    }

    #[test]
    fn devices_are_written_as_they_are() {
        write(Path::new("/dev/null"), b"new");
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
        assert!(is_special(Path::new("/dev/null")));
        assert!(!is_special(Path::new("/dev")));
    }

    #[test]
    fn messages_do_not_name_the_temporary_file() {
        let cases = [
            ("/no/such/place", "No such file or directory (os error 2)"),
            ("/", "is a directory"),
            ("/dev/null/x", "Not a directory (os error 20)"),
        ];
        for (path, message) in cases {
            let error = Output::create(Path::new(path)).err().unwrap();
            assert_eq!(error.to_string(), message, "{path}");
        }
    }
}
