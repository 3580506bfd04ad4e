//! Whatever stands in a file or on a line: an error or an answer, never a panic, never a NaN.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use whitted_cli::cast::{Query, cast_lines};
use whitted_cli::inspect::inspect;
use whitted_cli::picture::Picture;
use whitted_cli::render::{Settings, keep, render_whole as render};
use whitted_cli::scene::{HostScene, Pool};
use whitted_cli::scene_file::{SceneError, SceneFile, nff, toml};

/// A small generator of numbers that look random: Knuth's MMIX congruence.
struct Dice(u64);

impl Dice {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % bound
    }
}

const NFF: &str = "\
b .1 .2 .4
v from 3 2 4 at 0 0 0 up 0 1 0 angle 40 hither 1 resolution 6 4
l 5 5 5
l -5 5 3 .5 .5 1
f 1 .8 .4 .7 0 0 0 0
p 5 4 -1 -4 -4 -1 -4 -4 -1 4 0 -1 5 4 -1 4
f .9 .2 .1 .5 .5 3.5 .3 1.5
s 0 0 0 1
c -1 -1 1 .3 -1 .5 1 .1
p 3 0 0 0 1 0 0 0 1 0
pp 3 0 0 0 0 0 1 1 0 0 0 1 1 0 1 0 1 0 1
";

/// Words that break what they are put into.
const WORDS: [&str; 24] = [
    "nan",
    "inf",
    "-inf",
    "0",
    "-0",
    "-1",
    "1e38",
    "-1e38",
    "3.5e38",
    "1e-45",
    "1e-30",
    "1e-300",
    "1e30",
    "16777217",
    "0.9999999",
    "99999999999999999999",
    "p",
    "s",
    "[",
    "]",
    "\"",
    "=",
    "#",
    "\n",
];

/// Some of a text's words replaced, dropped, doubled or exchanged. Of TOML, `separator` keeps its form.
fn broken(text: &str, dice: &mut Dice) -> String {
    let mut words: Vec<&str> = text.split_inclusive([' ', ',', '\n', '[', ']']).collect();
    for _ in 0..=dice.below(3) {
        let (at, other) = (dice.below(words.len()), dice.below(words.len()));
        match dice.below(8) {
            0 => {
                words.remove(at);
            }
            1 => words.insert(at, words[other]),
            2 => words.swap(at, other),
            3 => words.truncate(words.len() - dice.below(words.len() / 4)),
            _ => {
                // The old word's separator stays.
                words[at] = words[at].trim_start_matches(|it: char| !" ,\n[]".contains(it));
                words.insert(at, WORDS[dice.below(WORDS.len())]);
            }
        }
    }
    words.concat()
}

/// Does all that can be done with a scene, if it is one.
fn exercise(file: Result<SceneFile, SceneError>) -> bool {
    let Ok(file) = file else {
        return false;
    };
    let pool = Pool::new(&file);
    let Ok(scene) = HostScene::new(&file, &pool) else {
        return false;
    };
    let report = inspect(&scene, &pool);
    assert!(!report.to_string().is_empty());
    serde_json::to_string(&report).unwrap();
    if let Some(view) = scene.camera(3, 2).unwrap() {
        let settings = Settings {
            depth: 4,
            threshold: 0.0,
        };
        let rendered = render(&scene, &view, 0..2, settings, keep, |pixels| {
            if pixels.iter().any(|it| it.is_nan()) {
                Err(())
            } else {
                Ok(())
            }
        });
        assert!(rendered.is_ok(), "a pixel is not a number");
    }
    let rays = b"0 0 9 0 0 -1\n3 2 4 -3 -2 -4\n1e38 0 0 -1e-45 0 0\n1e-40 0 0 1 1e-38 0\n";
    let mut answers = Vec::new();
    let lines = cast_lines(&scene, Query::Closest, &rays[..], &mut answers).unwrap();
    let answers = String::from_utf8(answers).unwrap();
    // What JSON makes of numbers that are not finite.
    assert!(lines.bad == 0 && !answers.contains("null"), "{answers}");
    true
}

fn exercise_many(text: &str, parse: impl Fn(&str) -> Result<SceneFile, SceneError>, seed: u64) {
    assert!(
        exercise(parse(text)),
        "the text is a scene before it is broken"
    );
    let mut dice = Dice(seed);
    let mut scenes = 0;
    const ROUNDS: usize = 3000;
    for _ in 0..ROUNDS {
        let text = broken(text, &mut dice);
        // To be seen if this panics.
        let scene = catch_unwind(AssertUnwindSafe(|| exercise(parse(&text))));
        scenes += usize::from(scene.unwrap_or_else(|_| panic!("by this file:\n{text}")));
    }
    // Most files should be refused, and many not.
    assert!(
        scenes > ROUNDS / 20 && scenes < ROUNDS,
        "{scenes} of {ROUNDS} were scenes"
    );
}

#[test]
fn broken_nff_is_refused_or_cast() {
    exercise_many(NFF, |it| nff::parse(Path::new("t.nff"), it.as_bytes()), 1);
}

#[test]
fn broken_toml_is_refused_or_cast() {
    let readme = include_str!("../../README.md");
    let start = readme.find("```toml\n").unwrap() + 8;
    let example = &readme[start..start + readme[start..].find("```").unwrap()];
    exercise_many(example, |it| toml::parse(Path::new("t.toml"), it), 2);
}

#[test]
fn broken_bytes_are_no_panic() {
    let png = {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 5, 4);
        encoder.set_color(png::ColorType::Rgba);
        encoder
            .write_header()
            .unwrap()
            .write_image_data(&[77; 80])
            .unwrap();
        bytes
    };
    let files = [
        NFF.as_bytes().to_vec(),
        b"P6 # x\n3 2 255\n..................".to_vec(),
        b"P3\n2 2 300\n1 2 3 4 5 6 7 8 9 10 11 12\n".to_vec(),
        png,
    ];
    let mut dice = Dice(3);
    for _ in 0..3000 {
        for file in &files {
            let mut bytes = file.clone();
            for _ in 0..=dice.below(4) {
                let at = dice.below(bytes.len());
                bytes[at] = dice.below(256) as u8;
            }
            bytes.truncate(bytes.len() - dice.below(bytes.len() / 2));
            let _ = nff::parse(Path::new("t"), &bytes);
            let _ = toml::parse(Path::new("t"), &String::from_utf8_lossy(&bytes));
            let _ = Picture::decode(&bytes);
        }
    }
}
