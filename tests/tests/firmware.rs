//! The firmware, built for every target, run, and held against the host and against the table.
//!
//! Without a compiler or an emulator for a target its part is left out, and that is said:
//! `tests/embedded.sh` installs what is missing.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

use anyhow::Result;
use whitted_tests::embedded::chart;
use whitted_tests::embedded::copy::{Body, Copy};
use whitted_tests::embedded::expected::Expected;
use whitted_tests::embedded::firmware::{self, Build, Kind, Options};
use whitted_tests::embedded::image::Image;
use whitted_tests::embedded::measure::{self, Row, Variant};
use whitted_tests::embedded::run;
use whitted_tests::embedded::target::{CORTEX_M4F, Machine, TARGETS, Target};

/// What the host draws.
fn expected() -> &'static [(&'static str, Expected)] {
    static EXPECTED: OnceLock<Vec<(&str, Expected)>> = OnceLock::new();
    EXPECTED.get_or_init(Expected::all)
}

/// Says what is left out, and why.
fn not_run(what: &str, why: &str) {
    eprintln!("\nNOT RUN: {what}: {why}\n         tests/embedded.sh installs what is missing\n");
}

/// Whether a target's programs can be built and run here.
fn can_run(target: &Target) -> bool {
    let missing = match firmware::compiler() {
        Ok(Some(_)) if run::is_available(target.machine) => return true,
        Ok(Some(_)) => format!("{:?} is not installed", target.machine),
        Ok(None) => "no compiler for it".to_owned(),
        Err(error) => error.to_string(),
    };
    not_run(target.name, &missing);
    false
}

#[test]
fn every_program_is_a_frame() {
    let frames: BTreeSet<_> = expected()
        .iter()
        .map(|(name, _)| (*name).to_owned())
        .collect();
    let programs: BTreeSet<_> = firmware::names().unwrap().into_iter().collect();
    assert_eq!(frames, programs);
}

#[test]
#[ignore = "builds firmware for minutes; tests/embedded.sh runs it"]
fn every_target_draws_what_the_host_draws() {
    for target in TARGETS.iter().filter(|target| can_run(target)) {
        for kind in [Kind::Rows, Kind::Panel, Kind::Counters] {
            let Build::Programs(programs) = firmware::build(target, kind).unwrap() else {
                panic!("the compiler has gone");
            };
            for (name, expected) in expected() {
                let report = run::run(target, &programs[*name]);
                let checked = report.and_then(|report| expected.check(kind, &report));
                if let Err(error) = checked {
                    panic!("{name} on {}, {kind:?}: {error:?}", target.name);
                }
            }
        }
        eprintln!(
            "{}: {} frames as on the host, in all three ways",
            target.name,
            expected().len()
        );
    }
}

/// All rows of the table, measured now; `None` where the tools for it are missing.
fn measured() -> Option<&'static [Row]> {
    static ROWS: OnceLock<Option<Vec<Row>>> = OnceLock::new();
    let rows = ROWS.get_or_init(|| {
        let compiler = firmware::compiler().unwrap()?;
        let plugin = run::build_plugin(&firmware::build_directory()).unwrap();
        let variants = measure::variants();
        let can_measure = |variant: &&Variant<'_>| {
            let needs_gcc = variant.options.features.contains(&"libgcc");
            let has_gcc = run::is_available(Machine::Qemu("arm-none-eabi-gcc", &[]));
            if needs_gcc && !has_gcc {
                not_run("libgcc", "arm-none-eabi-gcc is not installed");
            }
            can_run(&variant.target) && (has_gcc || !needs_gcc)
        };
        let rows = variants
            .iter()
            .filter(can_measure)
            .map(|variant| variant.measure(&compiler, expected(), &plugin).unwrap());
        Some(rows.flatten().collect())
    });
    rows.as_deref().filter(|rows| !rows.is_empty())
}

fn row<'a>(rows: &'a [Row], profile: &str, target: &str, program: &str) -> &'a Row {
    let is_it =
        |row: &&Row| row.profile == profile && row.target == target && row.program == program;
    rows.iter()
        .find(is_it)
        .unwrap_or_else(|| panic!("no {program} on {target}, {profile}"))
}

#[test]
#[ignore = "builds firmware for minutes; tests/embedded.sh runs it"]
fn the_table_is_what_is_measured() {
    let Some(rows) = measured() else {
        return not_run("the table", "nothing can be measured");
    };
    let table = chart::read().unwrap();
    let comparison = chart::compare(&table, rows);
    if comparison.compared < rows.len() {
        eprintln!(
            "\nNOT COMPARED: {} of {} rows of tests/charts/firmware.csv, which {} made; here it is {}\n",
            rows.len() - comparison.compared,
            rows.len(),
            table[0].compiler,
            rows[0].compiler,
        );
    }
    let differences = comparison.differences.join("\n");
    assert!(
        differences.is_empty(),
        "{differences}\nrun tests/embedded.sh table and look at it"
    );
}

#[test]
#[ignore = "builds firmware for minutes; tests/embedded.sh runs it"]
fn goals_are_met() {
    let Some(rows) = measured() else {
        return not_run("the goals", "nothing can be measured");
    };
    let m4f = |program| row(rows, "speed", "Cortex-M4F", program);
    // Bytes of flash.
    for (program, most) in [
        ("query", 500),
        ("matte-shadows", 2048),
        ("everything", 10240),
    ] {
        assert!(
            m4f(program).flash <= most,
            "{program} takes {} bytes",
            m4f(program).flash
        );
    }
    // Bytes of stack: spheres, plane, mirror and glass at depth 5.
    assert!(m4f("spheres-and-plane").stack_bound <= 640);
    for (name, _) in expected() {
        let panel = row(rows, "panel", "Cortex-M4F", name);
        assert_eq!(
            panel.static_ram, 0,
            "{name} has static RAM beside the panel's rows"
        );
        let (m0, m4f) = (row(rows, "speed", "Cortex-M0", name), m4f(name));
        assert!(
            m0.flash * 10 <= m4f.flash * 13,
            "{name}: {} B on M0, {} on M4F",
            m0.flash,
            m4f.flash
        );
        assert_eq!(
            m4f.support, 0,
            "{name} does arithmetic in software on a part with FPU"
        );
    }
}

#[test]
#[ignore = "builds firmware for minutes; tests/embedded.sh runs it"]
fn painted_stacks_are_what_the_code_allows() {
    let Some(rows) = measured() else {
        return not_run("stacks", "nothing can be measured");
    };
    for row in rows {
        let Row {
            program,
            target,
            profile,
            stack,
            stack_bound,
            ..
        } = row;
        assert!(
            stack <= stack_bound,
            "{program} on {target}, {profile}: {stack} of {stack_bound}"
        );
        // Paths that no pixel of a frame takes need not be the deepest.
        assert!(
            stack_bound - stack <= stack_bound / 4 + 16,
            "{program} on {target}, {profile}: painted {stack}, bound {stack_bound}"
        );
    }
}

/// Builds for the Cortex-M4F from a copy of the project.
fn build_copy(copy: &Copy) -> Result<BTreeMap<String, u64>> {
    let options = Options {
        root: Some(copy.root()),
        ..Options::default()
    };
    match firmware::build_with(&CORTEX_M4F, Kind::Rows, options)? {
        Build::NoCompiler(why) => panic!("{why}"),
        Build::Programs(programs) => programs
            .into_iter()
            .map(|(name, path)| Ok((name, Image::read(&path)?.text_checksum())))
            .collect(),
    }
}

#[test]
#[ignore = "builds firmware for minutes; tests/embedded.sh runs it"]
fn a_planted_panic_does_not_link() {
    if !can_run(&CORTEX_M4F) {
        return;
    }
    let copy = Copy::new("panic").unwrap();
    let body = Body {
        file: "core/src/shape/sphere.rs",
        after: &["impl Shape for Sphere", "fn intersect"],
    };
    let index =
        "let planted = [0_u8; 4][core::hint::black_box(1)]; core::hint::black_box(planted);";
    copy.insert(&body, index).unwrap();
    let error = build_copy(&copy).unwrap_err().to_string();
    assert!(error.contains("a_panic_is_reachable"), "{error}");
}

/// Something in `core` that a program can do without.
struct Feature {
    name: &'static str,
    bodies: &'static [Body],
    /// Programs that name it.
    named_by: fn(&str) -> bool,
}

const fn body(file: &'static str, after: &'static [&'static str]) -> Body {
    Body { file, after }
}

const fn intersect(file: &'static str) -> Body {
    body(file, &["impl Shape for", "fn intersect<"])
}

/// From which rung of the ladder on a program stands; `None` for those beside it.
fn rung(program: &str) -> Option<usize> {
    const LADDER: [&str; 13] = [
        "empty",
        "rays",
        "query",
        "matte",
        "floor",
        "shadows",
        "highlight",
        "polygon",
        "cuboid",
        "frustum",
        "mirrors",
        "glass",
        "everything",
    ];
    LADDER.iter().position(|&name| name == program)
}

fn is_on_or_above(program: &str, first: &str) -> bool {
    rung(program).is_some_and(|place| Some(place) >= rung(first))
}

fn is_one_of(program: &str, names: &[&str]) -> bool {
    names.contains(&program)
}

/// Each is changed in a way that no compiler leaves out, and then shows in the programs that name it.
const FEATURES: &[Feature] = &[
    Feature {
        name: "what no program here names",
        bodies: &[
            body("core/src/math.rs", &["impl Math for Micro", "fn sqrt("]),
            body(
                "core/src/trace.rs",
                &["impl Count for Counters", "fn count("],
            ),
            body("core/src/picture.rs", &["fn draw_sub_image<"]),
            body("core/src/camera.rs", &["pub fn look_at("]),
            body("core/src/shape/frustum.rs", &["pub fn new("]),
            body("core/src/shape/polygon.rs", &["pub fn new("]),
        ],
        named_by: |_| false,
    },
    Feature {
        name: "spheres",
        bodies: &[intersect("core/src/shape/sphere.rs")],
        named_by: |program| !is_one_of(program, &["empty", "rays", "outside"]),
    },
    Feature {
        name: "planes",
        bodies: &[intersect("core/src/shape/plane.rs")],
        named_by: |program| {
            let others = ["spheres-and-plane", "six-spheres", "tiny", "outside"];
            is_on_or_above(program, "floor") || is_one_of(program, &others)
        },
    },
    Feature {
        name: "shadows",
        bodies: &[body(
            "core/src/geometry.rs",
            &["Geometry for [Object", "fn blocks<"],
        )],
        named_by: |program| {
            let opaque = ["matte-shadows", "c-ray", "outside"];
            is_on_or_above(program, "shadows") && !is_on_or_above(program, "glass")
                || is_one_of(program, &opaque)
        },
    },
    Feature {
        name: "highlights",
        bodies: &[body(
            "core/src/material.rs",
            &["impl Highlight for Phong ", "fn brightness<"],
        )],
        named_by: |program| {
            let others = [
                "spheres-and-plane",
                "six-spheres",
                "c-ray",
                "tiny",
                "outside",
            ];
            is_on_or_above(program, "highlight") && program != "everything"
                || is_one_of(program, &others)
        },
    },
    Feature {
        name: "polygons",
        bodies: &[intersect("core/src/shape/polygon.rs")],
        named_by: |program| is_on_or_above(program, "polygon"),
    },
    Feature {
        name: "boxes",
        bodies: &[intersect("core/src/shape/cuboid.rs")],
        named_by: |program| is_on_or_above(program, "cuboid"),
    },
    Feature {
        name: "frusta",
        bodies: &[intersect("core/src/shape/frustum.rs")],
        named_by: |program| is_on_or_above(program, "frustum"),
    },
    Feature {
        name: "mirrors",
        bodies: &[body(
            "core/src/material.rs",
            &["impl Reflection for Mirror", "fn reflectance("],
        )],
        named_by: |program| {
            let others = [
                "spheres-and-plane",
                "six-spheres",
                "c-ray",
                "tiny",
                "outside",
            ];
            is_on_or_above(program, "mirrors") || is_one_of(program, &others)
        },
    },
    Feature {
        name: "glass",
        bodies: &[
            body("core/src/math.rs", &["pub fn refract<"]),
            body(
                "core/src/geometry.rs",
                &["Geometry for [Object", "fn absorbs<"],
            ),
        ],
        named_by: |program| {
            let others = ["spheres-and-plane", "six-spheres", "tiny"];
            is_on_or_above(program, "glass") || is_one_of(program, &others)
        },
    },
    Feature {
        name: "triangles, patches, exponents that are not whole",
        bodies: &[
            intersect("core/src/shape/triangle.rs"),
            intersect("core/src/shape/patch.rs"),
            body(
                "core/src/material.rs",
                &["impl Highlight for PhongReal", "fn brightness<"],
            ),
        ],
        named_by: |program| program == "everything",
    },
];

/// Programs whose code is another after the change of a feature.
fn changed_by(copy: &Copy, before: &BTreeMap<String, u64>, feature: &Feature) -> BTreeSet<String> {
    let change = |body| copy.insert(body, "core::hint::black_box(0_u8);").unwrap();
    let originals: Vec<_> = feature.bodies.iter().map(change).collect();
    let after = build_copy(copy).unwrap();
    for original in originals {
        original.restore().unwrap();
    }
    before
        .keys()
        .filter(|name| after[*name] != before[*name])
        .cloned()
        .collect()
}

#[test]
#[ignore = "builds firmware for minutes; tests/embedded.sh runs it"]
fn features_change_only_programs_that_name_them() {
    if !can_run(&CORTEX_M4F) {
        return;
    }
    let copy = Copy::new("features").unwrap();
    let before = build_copy(&copy).unwrap();
    for feature in FEATURES {
        let changed = changed_by(&copy, &before, feature);
        let named_by: BTreeSet<_> = before
            .keys()
            .filter(|program| (feature.named_by)(program))
            .cloned()
            .collect();
        assert_eq!(changed, named_by, "{}", feature.name);
    }

    // And a feature that is not named but used all the same is found.
    let sphere = intersect("core/src/shape/sphere.rs");
    let use_of_cuboid = "core::hint::black_box(
        super::cuboid::Cuboid { min: self.center, max: ray.origin }
            .intersect::<P>(ray, &ray.direction, leaving),
    );";
    copy.insert(&sphere, use_of_cuboid).unwrap();
    let before = build_copy(&copy).unwrap();
    let cuboid = FEATURES
        .iter()
        .find(|feature| feature.name == "boxes")
        .unwrap();
    assert!(changed_by(&copy, &before, cuboid).contains("matte"));
}
