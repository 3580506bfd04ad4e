//! The `whitted` program from outside: what it prints, writes and returns.

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use tempfile::TempDir;

/// A directory with a small scene of mirrors, glass and shadows in it.
struct Place {
    directory: TempDir,
}

const SCENE: &str = "\
b 0.1 0.2 0.4
v
from 3 2 4
at 0 0 0
up 0 1 0
angle 40
hither 0.1
resolution 24 16
l 5 5 5
l -5 5 3
f 1 0.8 0.4 0.7 0 0 0 0
p 4
4 -1 -4
-4 -1 -4
-4 -1 4
4 -1 4
f 0.9 0.2 0.1 0.5 0.5 20 0 0
s 0 0 0 1
f 1 1 1 0.05 0.1 90 0.85 1.5
s 1 0.2 1.5 0.5
c -1 -1 1 0.3 -1 0.5 1 0.1
";

impl Place {
    fn new() -> Self {
        let directory = tempfile::tempdir().unwrap();
        fs::write(directory.path().join("scene.nff"), SCENE).unwrap();
        Self { directory }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.directory.path().join(name)
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_whitted"));
        command.current_dir(self.directory.path()).args(arguments);
        command
    }

    fn run(&self, arguments: &[&str]) -> Output {
        self.command(arguments)
            .stdin(Stdio::null())
            .output()
            .unwrap()
    }

    /// Runs with rays on standard input.
    fn cast(&self, arguments: &[&str], rays: &str) -> Output {
        let mut child = self
            .command(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        child
            .stdin
            .take()
            .unwrap()
            .write_all(rays.as_bytes())
            .unwrap();
        child.wait_with_output().unwrap()
    }

    /// Renders, and gives the picture's bytes.
    fn render(&self, arguments: &[&str]) -> Vec<u8> {
        let output = self.run(&[&["render", "scene.nff", "-o", "-"], arguments].concat());
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        output.stdout
    }

    /// The names in the directory.
    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.directory.path()).unwrap();
        let mut names: Vec<_> = entries
            .map(|it| it.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }
}

fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// The pixels of a P6 picture.
fn raster(picture: &[u8], width: usize, height: usize) -> &[u8] {
    let header = format!("P6\n{width} {height}\n255\n");
    let raster = picture.strip_prefix(header.as_bytes());
    raster.unwrap_or_else(|| panic!("no {width}x{height} picture"))
}

#[test]
fn the_size_is_the_scene_s_or_the_one_asked_for() {
    let place = Place::new();
    assert_eq!(raster(&place.render(&[]), 24, 16).len(), 24 * 16 * 3);
    assert_eq!(
        raster(&place.render(&["--size", "7x5"]), 7, 5).len(),
        7 * 5 * 3
    );
}

#[test]
fn the_bytes_do_not_depend_on_threads() {
    let place = Place::new();
    let one = place.render(&["--size", "61x47", "--threads", "1"]);
    for threads in ["2", "4", "64"] {
        assert_eq!(
            one,
            place.render(&["--size", "61x47", "--threads", threads]),
            "{threads}"
        );
    }
    assert_eq!(one, place.render(&["--size", "61x47"]));
}

#[test]
fn bands_concatenate_to_the_whole() {
    let place = Place::new();
    let whole = place.render(&[]);
    let mut bands = Vec::new();
    for (rows, height) in [("0..1", 1), ("1..9", 8), ("9..16", 7)] {
        bands.extend_from_slice(raster(&place.render(&["--rows", rows]), 24, height));
    }
    assert!(raster(&whole, 24, 16) == bands);
}

#[test]
fn text_and_binary_ppm_and_png_are_the_same_picture() {
    let place = Place::new();
    for (name, option) in [("a.ppm", None), ("b.ppm", Some("--ascii")), ("c.png", None)] {
        let mut arguments = vec!["render", "scene.nff", "-o", name];
        arguments.extend(option);
        assert_eq!(code(&place.run(&arguments)), 0);
    }
    assert!(
        fs::read(place.path("b.ppm"))
            .unwrap()
            .starts_with(b"P3\n24 16\n255\n")
    );
    assert!(
        fs::read(place.path("c.png"))
            .unwrap()
            .starts_with(b"\x89PNG")
    );
    for other in ["b.ppm", "c.png"] {
        let output = place.run(&["compare", "a.ppm", other]);
        assert_eq!(code(&output), 0, "{}", stdout(&output));
        assert!(stdout(&output).contains("PSNR: infinite"));
    }
}

#[test]
fn srgb_brightens_and_depth_and_threshold_cut() {
    let place = Place::new();
    let brightness = |arguments: &[&str]| -> u64 {
        let picture = place.render(arguments);
        raster(&picture, 24, 16)
            .iter()
            .map(|&it| u64::from(it))
            .sum()
    };
    let whole = brightness(&[]);
    assert!(brightness(&["--srgb"]) > whole);
    assert!(brightness(&["--depth", "1"]) < whole);
    assert!(brightness(&["--threshold", "0.5"]) < whole);
    assert_eq!(brightness(&["--depth", "5"]), whole);
}

#[test]
fn samples_make_outlines_smooth() {
    let place = Place::new();
    let plain = place.render(&[]);
    let brightness = |picture: &[u8]| -> f64 {
        let channels = raster(picture, 24, 16).iter();
        channels.map(|&it| f64::from(it)).sum()
    };
    let mut pictures = vec![plain.clone()];
    for sampling in [
        &["--samples", "4"][..],
        &["--adaptive", "0.02"],
        &["--adaptive", "0.02", "--samples", "16"],
    ] {
        let picture = place.render(sampling);
        assert!(!pictures.contains(&picture), "{sampling:?}");
        let ratio = brightness(&picture) / brightness(&plain);
        assert!((0.9..1.1).contains(&ratio), "{sampling:?}: {ratio}");
        pictures.push(picture);
    }
    // One sample is the middle.
    assert_eq!(place.render(&["--samples", "1"]), plain);
    // Bands put together are the whole.
    for sampling in [&["--samples", "3"][..], &["--adaptive", "0"]] {
        let band = |rows: &str| place.render(&[sampling, &["--rows", rows]].concat());
        let whole = place.render(sampling);
        let (upper, lower) = (band("0..5"), band("5..16"));
        let bands = [raster(&upper, 24, 5), raster(&lower, 24, 11)].concat();
        assert_eq!(raster(&whole, 24, 16), bands, "{sampling:?}");
    }
}

#[test]
fn the_summary_counts_rays() {
    let place = Place::new();
    let output = place.run(&["render", "scene.nff", "-o", "out.ppm"]);
    let summary = stderr(&output);
    assert!(summary.starts_with("24x16 in "), "{summary}");
    assert!(summary.contains(": 384 primary, "), "{summary}");
    assert!(summary.trim_end().ends_with(" million rays/s"), "{summary}");
    assert_eq!(summary.lines().count(), 1, "{summary}");
    assert_eq!(stdout(&output), "");
}

#[test]
fn without_a_scene_the_builtin_one_is_rendered() {
    let place = Place::new();
    let output = place.run(&["render", "--size", "40x30", "-o", "out.png"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    assert_eq!(place.names(), ["out.png", "scene.nff"]);
}

#[test]
fn bad_input_touches_no_output() {
    let place = Place::new();
    fs::write(place.path("old.ppm"), "old").unwrap();
    fs::write(place.path("bad.nff"), "b 0 0 0\ns 0 0\n").unwrap();
    fs::write(place.path("bad.toml"), "[camera]\neye = [0, 0, 0]\n").unwrap();
    fs::write(
        place.path("flat.nff"),
        "f 1 1 1 1 0 0 0 0\n\n  p 3 0 0 0 1 1 1 2 2 2",
    )
    .unwrap();
    fs::write(place.path("blind.nff"), "b 0 0 0\n").unwrap();
    fs::write(place.path("scene.obj"), "").unwrap();
    fs::create_dir(place.path("directory.ppm")).unwrap();
    let out = "old.ppm";
    let cases: [(&[&str], &str); 17] = [
        (
            &["missing.nff", "-o", out],
            "error: missing.nff: cannot be read: No such file",
        ),
        (
            &["scene.obj", "-o", out],
            "error: scene.obj: not a scene file: ",
        ),
        (
            &["bad.nff", "-o", out],
            "error: bad.nff:3:1: expected a coordinate of the centre, found ",
        ),
        (
            &["bad.toml", "-o", out],
            "error: bad.toml:1:1: missing field `target`",
        ),
        (&["flat.nff", "-o", out], "error: flat.nff:3:3: triangle: "),
        (
            &["blind.nff", "-o", out],
            "error: blind.nff: the scene has no camera",
        ),
        (
            &["scene.nff", "-o", "out.jpg"],
            "error: cannot tell the format of out.jpg: ",
        ),
        (
            &["scene.nff", "-o", "no/out.ppm"],
            "error: cannot write no/out.ppm: No such file",
        ),
        (
            &["scene.nff", "-o", "directory.ppm"],
            "error: cannot write directory.ppm: is a directory",
        ),
        (
            &["scene.nff", "-o", "out.png", "--ascii"],
            "error: --ascii is for PPM; out.png is a PNG",
        ),
        (
            &["scene.nff", "-o", out, "--rows", "8..17"],
            "error: --rows ends at 17, but ",
        ),
        (
            &["scene.nff", "-o", out, "--size", "0x9"],
            "error: invalid value '0x9' for '--size ",
        ),
        (
            &["scene.nff", "-o", out, "--depth", "33"],
            "error: invalid value '33' for '--depth ",
        ),
        (
            &["scene.nff", "-o", out, "--samples", "17"],
            "error: invalid value '17' for '--samples ",
        ),
        (
            &["scene.nff", "-o", out, "--adaptive", "2"],
            "error: invalid value '2' for '--adaptive ",
        ),
        (
            &[
                "scene.nff",
                "-o",
                out,
                "--adaptive",
                "0.1",
                "--samples",
                "3",
            ],
            "error: --samples is 3: with --adaptive it is 2, 4, 8 or 16",
        ),
        (
            &["scene.nff", "-o", out, "--colour"],
            "error: unexpected argument '--colour' found",
        ),
    ];
    let names = place.names();
    for (arguments, message) in cases {
        let output = place.run(&[&["render"], arguments].concat());
        assert_eq!(code(&output), 2, "{arguments:?}");
        assert!(
            stderr(&output).starts_with(message),
            "{arguments:?}: {}",
            stderr(&output)
        );
        assert_eq!(
            fs::read_to_string(place.path("old.ppm")).unwrap(),
            "old",
            "{arguments:?}"
        );
        assert_eq!(place.names(), names, "{arguments:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error() {
    let place = Place::new();
    let full = Path::new("/dev/full");
    if !full.exists() {
        println!("skipped: there is no /dev/full");
        return;
    }
    let output = place.run(&["render", "scene.nff", "-o", "/dev/full"]);
    assert_eq!(code(&output), 2);
    assert!(stderr(&output).starts_with("error: cannot write /dev/full: No space left"));
    let commands: [&[&str]; 4] = [
        &["render", "scene.nff", "-o", "-"],
        &["inspect", "scene.nff"],
        &["inspect", "scene.nff", "--json"],
        &["compare", "scene.ppm", "scene.ppm"],
    ];
    fs::write(place.path("scene.ppm"), place.render(&[])).unwrap();
    for arguments in commands {
        let stdout = fs::File::create(full).unwrap();
        let output = place.command(arguments).stdout(stdout).output().unwrap();
        assert_eq!(code(&output), 2, "{arguments:?}");
        assert!(
            stderr(&output).contains("No space left"),
            "{}",
            stderr(&output)
        );
    }
    let mut command = place.command(&["cast", "scene.nff"]);
    let rays = place.path("rays");
    fs::write(&rays, "0 0 9 0 0 -1\n").unwrap();
    command.stdin(fs::File::open(rays).unwrap());
    let output = command
        .stdout(fs::File::create(full).unwrap())
        .output()
        .unwrap();
    assert_eq!(code(&output), 2);
    assert!(
        stderr(&output).contains("No space left"),
        "{}",
        stderr(&output)
    );
}

#[cfg(unix)]
#[test]
fn devices_are_written_as_they_are() {
    let place = Place::new();
    for device in ["/dev/null", "/dev/stdout"] {
        let output = place.run(&["render", "scene.nff", "-o", device]);
        assert_eq!(code(&output), 0, "{device}: {}", stderr(&output));
    }
    let output = place.run(&["render", "scene.nff", "-o", "/dev/stdout"]);
    assert!(output.stdout == place.render(&[]));
    assert_eq!(place.names(), ["scene.nff"]);

    // What was written to a file before is kept, as a shell's >> asks for.
    fs::write(place.path("log"), "before").unwrap();
    let log = fs::File::options()
        .append(true)
        .open(place.path("log"))
        .unwrap();
    let mut command = place.command(&["render", "scene.nff", "-o", "/dev/stdout"]);
    assert!(
        command
            .stdout(log)
            .stderr(Stdio::null())
            .status()
            .unwrap()
            .success()
    );
    let log = fs::read(place.path("log")).unwrap();
    assert!(log.strip_prefix(b"before") == Some(&output.stdout));
}

#[cfg(unix)]
#[test]
fn a_file_that_must_not_be_written_is_kept() {
    use std::os::unix::fs::PermissionsExt;
    let place = Place::new();
    let path = place.path("kept.ppm");
    fs::write(&path, "old").unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o444)).unwrap();
    if fs::File::options().write(true).open(&path).is_ok() {
        println!("skipped: nothing is forbidden to this user");
        return;
    }
    let output = place.run(&["render", "scene.nff", "-o", "kept.ppm"]);
    assert_eq!(code(&output), 2);
    let message = "error: cannot write kept.ppm: Permission denied";
    assert!(stderr(&output).starts_with(message), "{}", stderr(&output));
    assert_eq!(fs::read_to_string(path).unwrap(), "old");
}

#[cfg(unix)]
#[test]
fn an_interrupted_render_leaves_nothing_behind() {
    let place = Place::new();
    fs::write(place.path("out.ppm"), "old").unwrap();
    let mut child = place
        .command(&[
            "render",
            "scene.nff",
            "-o",
            "out.ppm",
            "--size",
            "16384x16384",
        ])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    while place.names().len() < 3 {
        assert!(child.try_wait().unwrap().is_none(), "it cannot be done yet");
        thread::sleep(Duration::from_millis(1));
    }
    let kill = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(kill.unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert_eq!(place.names(), ["out.ppm", "scene.nff"]);
    assert_eq!(fs::read_to_string(place.path("out.ppm")).unwrap(), "old");
}

#[test]
fn a_closed_pipe_is_success() {
    let place = Place::new();
    let commands: [&[&str]; 3] = [
        &["render", "scene.nff", "-o", "-", "--size", "400x300"],
        &["inspect", "scene.nff"],
        &["compare", "scene.ppm", "scene.ppm"],
    ];
    fs::write(place.path("scene.ppm"), place.render(&[])).unwrap();
    for arguments in commands {
        let mut child = place
            .command(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(code(&output), 0, "{arguments:?}: {}", stderr(&output));
        assert!(
            !stderr(&output).contains("error"),
            "{arguments:?}: {}",
            stderr(&output)
        );
    }
}

#[test]
fn compare_judges_by_what_is_allowed() {
    let place = Place::new();
    let picture = |name: &str, text: &str| fs::write(place.path(name), text).unwrap();
    picture("a.ppm", "P3 2 2 255  0 0 0  9 9 9  7 7 7  1 1 1");
    picture("b.ppm", "P3 2 2 255  0 1 2  9 9 9  7 4 7  1 1 1");
    picture(
        "wide.ppm",
        "P3 2 2 65535  0 0 0  2313 2313 2313  1799 1799 1799  257 257 257",
    );
    picture("small.ppm", "P3 1 2 255  0 0 0  9 9 9");
    picture("broken.ppm", "P3 2 2 255  0 0 0  9 9");
    let cases: [(&[&str], i32); 10] = [
        (&["a.ppm", "a.ppm"], 0),
        (&["a.ppm", "wide.ppm"], 0),
        (&["a.ppm", "b.ppm"], 1),
        (&["a.ppm", "b.ppm", "--max-diff", "2"], 1),
        (&["a.ppm", "b.ppm", "--max-diff", "3"], 0),
        (&["a.ppm", "b.ppm", "--max-differing", "0.4"], 1),
        (&["a.ppm", "b.ppm", "--max-differing", "0.5"], 0),
        (
            &[
                "a.ppm",
                "b.ppm",
                "--max-differing",
                "0.25",
                "--max-diff",
                "2",
            ],
            0,
        ),
        (&["a.ppm", "small.ppm"], 1),
        (&["a.ppm", "broken.ppm"], 2),
    ];
    for (arguments, expected) in cases {
        let output = place.run(&[&["compare"], arguments].concat());
        assert_eq!(
            code(&output),
            expected,
            "{arguments:?}: {}",
            stdout(&output)
        );
    }
    let output = place.run(&["compare", "a.ppm", "b.ppm", "--max-diff", "2"]);
    assert_eq!(
        stdout(&output),
        "PSNR: 47.46 dB\nlargest channel difference: 3 of 255\n\
         pixels that differ: 2 of 4 (50.0000 %)\nchannels that differ: 3 of 12 (25.0000 %)\n\
         pixels that differ by more than 2: 1 of 4 (25.0000 %)\n\
         channels that differ by more than 2: 1 of 12 (8.3333 %)\n"
    );
    let output = place.run(&["compare", "a.ppm", "broken.ppm"]);
    assert_eq!(
        stderr(&output),
        "error: broken.ppm: the file ends before a sample\n"
    );
    let output = place.run(&["compare", "a.ppm", "missing.ppm"]);
    assert!(stderr(&output).starts_with("error: missing.ppm: No such file"));
}

#[test]
fn compare_writes_the_differences() {
    let place = Place::new();
    fs::write(place.path("a.ppm"), "P3 2 1 255  0 0 0  9 9 9").unwrap();
    fs::write(place.path("b.ppm"), "P3 2 1 255  0 1 2  9 9 9").unwrap();
    let output = place.run(&["compare", "a.ppm", "b.ppm", "--diff", "d.ppm"]);
    assert_eq!(code(&output), 1);
    let picture = fs::read(place.path("d.ppm")).unwrap();
    assert_eq!(raster(&picture, 2, 1), [0, 128, 255, 0, 0, 0]);
    let output = place.run(&["compare", "a.ppm", "b.ppm", "--diff", "no/d.ppm"]);
    assert_eq!(code(&output), 2);
    assert!(stderr(&output).starts_with("error: cannot write no/d.ppm: "));
}

#[test]
fn cast_answers_every_line() {
    let place = Place::new();
    let rays = "0 0 9 0 0 -2\n0 0 9 0 0 -2 3\nnonsense\n0 9 0 0 1 0\n";
    let output = place.cast(&["cast", "scene.nff"], rays);
    assert_eq!(code(&output), 2);
    assert_eq!(stderr(&output), "error: 1 of 4 lines were not rays\n");
    assert_eq!(
        stdout(&output),
        "{\"hit\":true,\"t\":4.0,\"point\":[0.0,0.0,1.0],\"normal\":[0.0,0.0,1.0],\"front\":true,\
         \"shape\":\"sphere\",\"index\":1,\"material\":\"f2\"}\n{\"hit\":false}\n\
         {\"error\":\"`nonsense` is not a number\",\"line\":3}\n{\"hit\":false}\n"
    );
    let output = place.cast(
        &["cast", "scene.nff", "--occluded"],
        "0 0 9 0 0 -1\n0 9 0 0 1 0",
    );
    assert_eq!(code(&output), 0);
    assert_eq!(
        stdout(&output),
        "{\"occluded\":true}\n{\"occluded\":false}\n"
    );
}

#[test]
fn cast_answers_before_the_next_ray_is_known() {
    let place = Place::new();
    let mut child = place
        .command(&["cast", "scene.nff"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut rays = child.stdin.take().unwrap();
    let answers = BufReader::new(child.stdout.take().unwrap());
    let (sender, receiver) = mpsc::channel();
    thread::spawn(move || answers.lines().try_for_each(|it| sender.send(it)));
    // Without the answer the test would wait for ever.
    let patience = Duration::from_secs(60);
    for _ in 0..3 {
        rays.write_all(b"0 0 9 0 0 -1\n").unwrap();
        rays.flush().unwrap();
        assert!(receiver.recv_timeout(patience).is_ok(), "no answer yet");
    }
    drop(rays);
    assert!(child.wait().unwrap().success());
    assert!(
        receiver.recv_timeout(patience).is_err(),
        "an answer too many"
    );
}

#[test]
fn cast_stops_when_nobody_listens() {
    let place = Place::new();
    let mut child = place
        .command(&["cast", "scene.nff"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let mut rays = child.stdin.take().unwrap();
    // Until the program is gone, and its end of this pipe too.
    while rays.write_all(b"0 0 9 0 0 -1\n").is_ok() {}
    let output = child.wait_with_output().unwrap();
    assert_eq!((code(&output), stderr(&output)), (0, String::new()));
}

#[test]
fn inspect_reports_as_text_and_as_json() {
    let place = Place::new();
    let output = place.run(&["inspect", "scene.nff"]);
    assert_eq!(code(&output), 0);
    assert_eq!(
        stdout(&output),
        "scene.nff\n  shapes     1 frustum, 1 polygon (4 corners), 2 spheres\n  \
         lights     2, 2 with shadows\n  \
         materials  3, 2 with highlights (0 with real exponents), 2 reflecting, 1 refracting\n  \
         depth      5 of 5, 5 by weight of 1/512\n  \
         bounds     [-4.0, -1.3, -4.0] to [4.0, 1.0, 4.0]\n  \
         features   Frustum, Polygon, Sphere, Phong, Mirror, Glass, Light\n  \
         bytes      320 (objects 152, materials 120, lights 48)\n"
    );
    let output = place.run(&["inspect", "scene.nff", "--json"]);
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["shapes"]["sphere"], 2);
    assert_eq!(report["bytes"]["total"], 320);
    assert_eq!(report["warnings"].as_array().unwrap().len(), 0);
    let output = place.run(&["inspect", "missing.nff"]);
    assert_eq!(code(&output), 2);
}

#[test]
fn pictures_do_not_depend_on_the_scale_of_the_scene() {
    let place = Place::new();
    let ordinary = place.render(&[]);
    for k in [-60, -41, -17, -3, 1, 16, 40, 60] {
        let unit = 2.0_f64.powi(k);
        // The lengths of the scene above: of a viewpoint, lights and shapes all but angle and colours.
        let mut keep = 0;
        let scaled: Vec<String> = SCENE
            .split_whitespace()
            .map(|word| match (word, word.parse::<f64>()) {
                (_, Ok(number)) if keep == 0 => format!("{:e}", number * unit),
                (_, Ok(_)) => {
                    keep -= 1;
                    word.to_owned()
                }
                (name, Err(_)) => {
                    keep = match name {
                        "b" | "up" => 3,
                        "angle" | "p" => 1,
                        "resolution" => 2,
                        "f" => 8,
                        _ => 0,
                    };
                    word.to_owned()
                }
            })
            .collect();
        fs::write(place.path("scaled.nff"), scaled.join("\n")).unwrap();
        let output = place.run(&["render", "scaled.nff", "-o", "-"]);
        assert_eq!(code(&output), 0, "2^{k}: {}", stderr(&output));
        assert!(output.stdout == ordinary, "2^{k}");
    }
}

#[test]
fn help_and_version_are_there() {
    let place = Place::new();
    for arguments in [&["--help"][..], &["--version"], &["render", "--help"]] {
        assert_eq!(code(&place.run(arguments)), 0, "{arguments:?}");
    }
    assert_eq!(code(&place.run(&[])), 2);
}
