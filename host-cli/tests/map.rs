//! Maps, from the file to the picture.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

/// A room with a window to the east, in which a sign hangs.
const ROOM: &str = "size = [12, 8]\nambient = [1, 1, 1]\nbackground = [0, 0, 1]\n\
    plan = '''\n####\n#...\n####\n'''\n\
    floor = 'green'\n\
    player = { position = [1.5, 1.5], direction = [1, 0], fov = 90 }\n\
    [material.green]\ncolor = [0, 1, 0]\n\
    [texture.red]\nfile = 'red.ppm'\n\
    [wall.'#']\nmaterial = 'green'\ntexture = 'red'\nshade = 0.5\n\
    [[sprite]]\ntexture = 'red'\nposition = [2.5, 1.5]\nabove = 0.25\nwidth = 0.5\nheight = 0.5\n";

fn place() -> TempDir {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("room.map"), ROOM).unwrap();
    std::fs::write(directory.path().join("red.ppm"), "P3\n1 1\n255\n255 0 0\n").unwrap();
    directory
}

fn run(place: &TempDir, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_whitted"));
    command.current_dir(place).args(arguments).output().unwrap()
}

fn rendered(place: &TempDir, arguments: &[&str]) -> Vec<u8> {
    let output = run(
        place,
        &[&["render", "room.map", "-o", "-"], arguments].concat(),
    );
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    output.stdout
}

/// A picture in letters, dark red a small one.
fn letters(picture: &[u8], width: usize) -> Vec<String> {
    let start = picture.windows(4).position(|it| it == b"255\n").unwrap() + 4;
    let letter = |pixel: &[u8]| match pixel {
        [255, 0, 0] => 'R',
        [0, 255, 0] => 'G',
        [0, 0, 255] => 'B',
        [128, 0, 0] => 'r',
        _ => '?',
    };
    let pixels: Vec<char> = picture[start..].chunks(3).map(letter).collect();
    pixels
        .chunks(width)
        .map(|row| row.iter().collect())
        .collect()
}

#[test]
fn columns_show_textures_shades_and_sprites_and_rays_materials() {
    let place = place();
    let columns = [
        "rrBBBBBBBBrr",
        "rrrBBBBBBrrr",
        "rrrrBBBBrrrr",
        "rrrrrRRrrrrr",
        "rrrrrRRrrrrr",
        "rrrrGGGGrrrr",
        "rrrGGGGGGrrr",
        "rrGGGGGGGGrr",
    ];
    assert_eq!(letters(&rendered(&place, &[]), 12), columns);
    let without_sprite = |row: &str| row.replace("RR", "BB").replace('r', "R");
    let traced = columns.map(without_sprite);
    assert_eq!(letters(&rendered(&place, &["--trace"]), 12), traced);
}

#[test]
fn bands_of_both_kinds_are_those_of_the_whole() {
    let place = place();
    for kind in [&[][..], &["--trace"]] {
        let whole = letters(&rendered(&place, kind), 12);
        let bands = ["0..3", "3..4", "4..8"];
        let bands =
            bands.map(|it| letters(&rendered(&place, &[kind, &["--rows", it]].concat()), 12));
        assert_eq!(bands.concat(), whole, "{kind:?}");
    }
}

#[test]
fn errors_are_told_and_nothing_is_written() {
    let place = place();
    let cases = [
        (
            &["room.map", "--depth", "3"][..],
            "error: --depth and --threshold are for traced pictures; for a map, add --trace\n",
        ),
        (
            &["room.map", "--threshold", "0.5"],
            "error: --depth and --threshold are for traced pictures; for a map, add --trace\n",
        ),
        (
            &["room.map", "--trace", "--samples", "2"],
            "error: --samples and --adaptive are for scenes, not for maps\n",
        ),
        (
            &["room.map", "--adaptive", "0.1"],
            "error: --samples and --adaptive are for scenes, not for maps\n",
        ),
        (
            &["room.map", "--rows", "0..9"],
            "error: --rows ends at 9, but the picture has 8 rows\n",
        ),
        (
            &["none.map"],
            "error: none.map: cannot be read: No such file or directory (os error 2)\n",
        ),
        (&["bad.map"], "error: bad.map:1:1: missing field `plan`\n"),
        (&["bytes.map"], "error: bytes.map:1:9: not UTF-8 text\n"),
    ];
    std::fs::write(place.path().join("bad.map"), "floor = 'x'").unwrap();
    std::fs::write(place.path().join("bytes.map"), b"plan = '\xff'").unwrap();
    for (arguments, message) in cases {
        let output = run(&place, &[&["render", "-o", "out.png"], arguments].concat());
        assert_eq!(String::from_utf8_lossy(&output.stderr), message);
        assert_eq!(output.status.code(), Some(2));
        assert!(!place.path().join("out.png").exists());
    }
}

#[test]
fn the_example_that_the_readme_names_is_drawn() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let castle: PathBuf = root.join("scenes/castle.map");
    let place = place();
    let path = castle.to_str().unwrap();
    for kind in [&[][..], &["--trace"]] {
        let picture = [&["render", path, "-o", "-", "--size", "40x30"], kind].concat();
        let output = run(&place, &picture);
        assert!(output.status.success());
        let colors: std::collections::BTreeSet<_> = output.stdout[13..].chunks(3).collect();
        assert!(colors.len() > 12, "{}", colors.len());
    }
}
