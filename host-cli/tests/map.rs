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
fn columns_and_rays_show_textures_and_shades_and_columns_sprites() {
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
    let without_sprite = |row: &str| row.replace("RR", "BB");
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

/// The bytes of its pixels.
fn pixels(picture: &[u8]) -> &[u8] {
    let start = picture.windows(4).position(|it| it == b"255\n").unwrap() + 4;
    &picture[start..]
}

#[test]
fn several_samples_a_pixel_are_the_mean_of_a_larger_picture() {
    let place = place();
    for kind in [&[][..], &["--trace"]] {
        let large = rendered(&place, &[kind, &["--size", "24x16"]].concat());
        let large: Vec<&[u8]> = pixels(&large).chunks(24 * 3).collect();
        let mean = |row: usize, column: usize, channel: usize| {
            let at =
                |y: usize, x: usize| u32::from(large[2 * row + y][(2 * column + x) * 3 + channel]);
            (at(0, 0) + at(0, 1) + at(1, 0) + at(1, 1) + 2) / 4
        };
        let expected: Vec<u8> = (0..8 * 12 * 3)
            .map(|it| mean(it / 36, it / 3 % 12, it % 3) as u8)
            .collect();
        let sampled = rendered(&place, &[kind, &["--samples", "2"]].concat());
        assert_eq!(pixels(&sampled), expected, "{kind:?}");
        let band = rendered(
            &place,
            &[kind, &["--samples", "2", "--rows", "3..5"]].concat(),
        );
        assert_eq!(pixels(&band), &expected[3 * 36..5 * 36], "{kind:?}");
    }
    let adaptive = |bound| {
        let arguments = ["--trace", "--samples", "8", "--adaptive", bound];
        let picture = rendered(&place, &arguments);
        let plain = letters(&picture, 12).concat();
        plain.chars().filter(|&it| it == '?').count()
    };
    // Edges are blends of corners, and of less where pixels are divided.
    assert!(adaptive("0") > 10, "{}", adaptive("0"));
}

#[test]
fn columns_and_rays_show_the_same_textures_on_walls_and_doors() {
    let place = place();
    // In 16 bits a pixel, and darker at other sides.
    let mut shades = "P3\n20 20\n255\n".to_owned();
    for i in 0..400 {
        shades += &format!("{} {} {}\n", i % 256, (i * 7) % 256, i / 2);
    }
    std::fs::write(place.path().join("shades.ppm"), shades).unwrap();
    for (open, doors) in [(0.0, 23), (0.25, 17), (0.5, 11), (0.9, 2)] {
        let map = format!(
            "size = [96, 72]\nambient = [1, 1, 1]\ndepth = 1\n\
             plan = '''\n########\n#.#....#\n#.D..#.#\n#.#..D.#\n#D####.#\n#......#\n########\n'''\n\
             floor = 'floor'\nceiling = 'roof'\n\
             player = {{ position = [4.3, 2.2], direction = [-1, 0.15], fov = 80 }}\n\
             [material.floor]\ncolor = [0, 1, 0]\n[material.roof]\ncolor = [0, 0, 1]\n\
             [texture.shades]\nfile = 'shades.ppm'\n\
             [texture.flag]\nrows = ['ab', 'cd', 'ba']\n\
             colors = {{ a = [1, 0, 0], b = [1, 0.5, 0], c = [1, 1, 0.5], d = [1, 0, 1] }}\n\
             [wall.'#']\nmaterial = 'floor'\ntexture = 'shades'\nshade = 0.5\n\
             [door.D]\nmaterial = 'floor'\ntexture = 'flag'\nopen = {open}\n"
        );
        std::fs::write(place.path().join("room.map"), map).unwrap();
        let (columns, traced) = (rendered(&place, &[]), rendered(&place, &["--trace"]));
        let (columns, traced) = (pixels(&columns), pixels(&traced));
        let pairs = columns.chunks(3).zip(traced.chunks(3));
        // Pixels at edges, which roundings may move, are not among these.
        let is_other = |(a, b): &(&[u8], &[u8])| (0..3).any(|i| a[i].abs_diff(b[i]) > 1);
        assert_eq!(pairs.filter(is_other).count(), 0, "{open}");
        let is_door = |it: &&[u8]| it[0] == 255;
        let seen = columns[36 * 96 * 3..37 * 96 * 3].chunks(3).filter(is_door);
        assert_eq!(seen.count(), doors, "{open}");
    }
}

#[test]
fn walls_of_the_last_kind_are_seen() {
    let place = place();
    let (room, _) = ROOM.split_once("[[sprite]]").unwrap();
    let mut map = room.replace("#...", "#..\u{1fd}");
    for sign in '\u{100}'..='\u{1fd}' {
        map += &format!("[wall.'{sign}']\nmaterial = 'green'\ntexture = 'red'\n");
    }
    std::fs::write(place.path().join("room.map"), map).unwrap();
    for kind in [&[][..], &["--trace"]] {
        let seen = letters(&rendered(&place, kind), 12);
        assert_eq!(seen[3], "rrrrrRRrrrrr", "{kind:?}");
    }
    let output = run(&place, &["inspect", "room.map"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("cells      4x3, 10 solid"), "{text}");
}

#[test]
fn rays_can_be_cast_into_maps() {
    use std::io::Write;
    let place = place();
    let map = ROOM.replace("#...", "#.D.") + "[door.D]\nmaterial = 'green'\nopen = 0.5\n";
    std::fs::write(place.path().join("room.map"), map).unwrap();
    let cast = |more: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_whitted"));
        let mut child = command
            .current_dir(&place)
            .args([&["cast", "room.map"], more].concat())
            .stdin(std::process::Stdio::piped())
            .stdout(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        let rays =
            b"1.5 0.5 1.75 2 0 0\n1.5 0.5 1.25 1 0 0\n1.5 0.5 1.5 0 0 -1\n1.5 0.5 1.5 0 -1 0\n";
        child.stdin.take().unwrap().write_all(rays).unwrap();
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success());
        String::from_utf8(output.stdout).unwrap()
    };
    let answers = cast(&[]);
    let mut lines = answers.lines();
    let mut next = |expected: &str| {
        let line = lines.next().unwrap();
        assert!(line.contains(expected), "{line}");
    };
    next(
        r#""t":0.5,"point":[2.5,0.5,1.75],"normal":[-1.0,0.0,0.0],"front":true,"shape":"door","index":6,"material":"green""#,
    );
    next(r#"{"hit":false}"#);
    next(
        r#""t":0.5,"point":[1.5,0.5,1.0],"normal":[0.0,0.0,1.0],"front":true,"shape":"wall","index":1,"material":"green""#,
    );
    next(r#""shape":"floor","index":5,"material":"green""#);
    let occluded = cast(&["--occluded"]);
    let occluded: Vec<_> = occluded.lines().map(|it| it.contains("true")).collect();
    assert_eq!(occluded, [true, false, true, true]);
}

#[test]
fn maps_are_inspected() {
    let place = place();
    let map = ROOM.replace("#...", "#.D.") + "[door.D]\nmaterial = 'green'\n";
    std::fs::write(place.path().join("room.map"), map).unwrap();
    let output = run(&place, &["inspect", "room.map"]);
    let text = String::from_utf8(output.stdout).unwrap();
    for line in [
        "cells      4x3, 9 solid",
        "doors      1",
        "kinds      2 of walls and doors",
        "textures   4, 0 of them without a palette",
        "sprites    1",
        "lights     0",
        "depth      5",
    ] {
        assert!(text.contains(line), "{line}: {text}");
    }
    let output = run(&place, &["inspect", "--json", "room.map"]);
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (&report["doors"], &report["cells"][1]),
        (&1.into(), &3.into())
    );
    let bytes = report["bytes"].as_array().unwrap();
    let of = |name: &str| {
        bytes
            .iter()
            .find(|it| it[0] == name)
            .map(|it| it[1].clone())
    };
    assert_eq!(of("CELLS"), Some(12.into()));
    assert_eq!(of("DOORS"), Some(8.into()));
    let all: u64 = bytes.iter().map(|it| it[1].as_u64().unwrap()).sum();
    assert_eq!(report["total"], all);
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
            &["room.map", "--adaptive", "0.1"],
            "error: --adaptive saves rays, and columns take one each; for a map, add --trace\n",
        ),
        (
            &["room.map", "--trace", "--adaptive", "0.1", "--samples", "3"],
            "error: --samples is 3: with --adaptive it is 2, 4, 8 or 16\n",
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
