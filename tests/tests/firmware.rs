//! The firmware, built for every target, run, and held against the host and against the table.
//!
//! Without a compiler or an emulator for a target its part is left out, and that is said:
//! `tests/embedded.sh` installs what is missing.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use anyhow::{Context, Result};
use rayon::prelude::*;
use whitted_tests::embedded::copy::{Body, Copy};
use whitted_tests::embedded::expected::Expected;
use whitted_tests::embedded::firmware::{self, Request};
use whitted_tests::embedded::hierarchy::{self, Saving};
use whitted_tests::embedded::image::Image;
use whitted_tests::embedded::measure::{self, Row, Variant};
use whitted_tests::embedded::target::{CORTEX_M4F, HOST, Machine, TARGETS, Target};
use whitted_tests::embedded::{baked, chart, columns, run};

/// What the host draws.
fn expected() -> &'static [(String, Expected)] {
    static EXPECTED: OnceLock<Vec<(String, Expected)>> = OnceLock::new();
    EXPECTED.get_or_init(Expected::all)
}

/// Says what is left out, and why; past the test harness, which would show it only on failure.
fn not_run(what: &str, why: &str) {
    let hint = "tests/embedded.sh setup installs what is missing";
    say(&format!("NOT RUN: {what}: {why}\n         {hint}"));
}

fn say(text: &str) {
    let _ = writeln!(io::stderr(), "\n{text}\n");
}

/// The compiler, if there is one.
fn compiler() -> Option<&'static str> {
    static COMPILER: OnceLock<Option<String>> = OnceLock::new();
    let compiler = COMPILER.get_or_init(|| firmware::compiler().unwrap());
    compiler.as_deref()
}

/// Whether a target's programs can be built and run here.
fn can_run(target: &Target) -> bool {
    if compiler().is_none() {
        not_run(target.name, "there is no compiler for it");
    } else if !run::is_available(target.machine) {
        let machine = format!("{:?} is not installed", target.machine);
        not_run(target.name, &machine);
    } else {
        return true;
    }
    false
}

fn has_arm_gcc() -> bool {
    run::is_available(Machine::Qemu("arm-none-eabi-gcc", &[]))
}

#[test]
fn every_program_is_a_frame() {
    let frames: BTreeSet<_> = expected().iter().map(|(name, _)| name.clone()).collect();
    let programs: BTreeSet<_> = firmware::names().unwrap().into_iter().collect();
    assert_eq!(frames, programs);
}

/// Programs that draw many frames, and what these are.
type Collections = BTreeMap<&'static str, Vec<(String, Expected)>>;

/// Bakes scenes into a directory, in one size or in the size that suits each.
fn collections(directory: &Path, size: Option<[u32; 2]>) -> Result<Collections> {
    let bake = |mut scenes: baked::Scenes| {
        if let Some(size) = size {
            scenes.iter_mut().for_each(|scene| scene.2 = size);
        }
        baked::write(&scenes, directory)
    };
    let mut collections = Collections::new();
    collections.insert("frames-baked", bake(baked::own()?)?);
    match baked::standard(&baked::STANDARD)? {
        Some(scenes) => drop(collections.insert("frames-standard", bake(scenes)?)),
        None => say("NOT RUN: the standard scenes, which are not beside the project"),
    }
    Ok(collections)
}

/// Builds programs that draw many frames for targets, runs them and compares all that they report.
fn draw_all(targets: &[Target], directory: &Path, collections: &Collections) -> Result<()> {
    let programs: Vec<_> = collections.keys().copied().collect();
    let is_standard = programs.contains(&"frames-standard");
    let request = Request {
        programs: &programs,
        features: if is_standard {
            &["own", "standard"]
        } else {
            &["own"]
        },
        baked: Some(directory),
        ..Request::default()
    };
    let built = firmware::build(targets, request)?;
    let mut runs = Vec::new();
    for (target, built) in targets.iter().zip(&built) {
        runs.extend(
            collections
                .iter()
                .map(|(program, frames)| (target, &built[*program], frames)),
        );
    }
    runs.into_par_iter()
        .try_for_each(|(target, program, frames)| {
            let report = run::run(target, program)?;
            for (name, expected) in frames {
                let checked = expected.check_all(name, &report);
                checked.with_context(|| format!("{name} on {}", target.name))?;
            }
            eprintln!("{}: {} frames as on the host", target.name, frames.len());
            Ok(())
        })
}

#[test]
fn every_target_draws_what_the_host_draws() {
    let all = TARGETS.into_iter().chain([HOST]);
    let targets: Vec<_> = all.filter(can_run).collect();
    let directory = firmware::build_directory().join("baked");
    let mut collections = collections(&directory, None).unwrap();
    collections.insert("frames", Expected::varied());
    draw_all(&targets, &directory, &collections).unwrap();
}

/// The code of the page for firmware's authors, as one program: the scene, the start, the panic handler.
fn page() -> String {
    let page = include_str!("../../core/FIRMWARE.md");
    let blocks: Vec<_> = page.split("```").skip(1).step_by(2).collect();
    let with = |what: &str| {
        let block = blocks.iter().find(|block| block.contains(what));
        // After the language's name; what `#` hides is rustdoc's, and the program's attributes come first.
        let lines = block.expect(what).lines().skip(1);
        let code = lines.filter(|line| !line.starts_with("# ") && !line.starts_with("#!["));
        code.collect::<Vec<_>>().join("\n")
    };
    ["fn frame<", "cortex_m_rt::entry", "#[panic_handler]"]
        .map(with)
        .join("\n\n")
}

#[test]
fn the_page_for_authors_is_a_program_that_draws_on_every_arm_part() {
    let has_runtime = |target: &Target| target.triple.starts_with("thumb") && can_run(target);
    let targets: Vec<_> = TARGETS.into_iter().filter(has_runtime).collect();
    let file = firmware::build_directory().join("page.rs");
    std::fs::create_dir_all(firmware::build_directory()).unwrap();
    baked::write_changed(&file, &page()).unwrap();
    let request = Request {
        programs: &["page"],
        features: &["page"],
        page: Some(&file),
        ..Request::default()
    };
    // It links only if no panic can be reached from it.
    let built = firmware::build(&targets, request).unwrap();
    let drawn: BTreeSet<_> = targets
        .iter()
        .zip(&built)
        .map(|(target, built)| run::run(target, &built["page"]).unwrap()["565"])
        .collect();
    assert!(drawn.len() == targets.len().min(1), "{drawn:x?}");
}

#[test]
fn every_target_draws_the_columns_of_the_host() {
    let all = TARGETS.into_iter().chain([HOST]);
    let targets: Vec<_> = all.filter(can_run).collect();
    columns::check(&targets).unwrap();
}

#[test]
fn columns_take_what_the_chart_says() {
    if !can_run(&CORTEX_M4F) {
        return;
    }
    let compiler = compiler().unwrap();
    let table = columns::read().unwrap();
    for cost in columns::measure(&[CORTEX_M4F], compiler, plugin()).unwrap() {
        assert_stack_is_bounded("columns", cost.stack, cost.stack_bound);
        let is_same = |known: &&columns::Cost| {
            (&known.program, &known.target) == (&cost.program, &cost.target)
        };
        let known = table.iter().find(is_same);
        let known = known.unwrap();
        if known.compiler == compiler {
            assert_eq!(&cost, known, "run tests/embedded.sh table and look at it");
        } else {
            say(&format!("NOT COMPARED: {} made {known:?}", known.compiler));
        }
    }
}

#[test]
#[ignore = "draws for many minutes: cargo test -p whitted-tests --test firmware -- --ignored"]
fn every_target_draws_large_pictures_as_the_host_does() {
    let targets: Vec<_> = TARGETS.into_iter().filter(can_run).collect();
    let directory = firmware::build_directory().join("baked-large");
    let collections = collections(&directory, Some([128, 128])).unwrap();
    draw_all(&targets, &directory, &collections).unwrap();
}

/// Of all programs those that the quick checks look at: nothing, little, the goals', everything.
const SAMPLE: [&str; 5] = ["empty", "matte", "shadows", "six-spheres", "everything"];

/// What the host draws in these.
fn sample() -> Vec<(String, Expected)> {
    let frames = expected().iter();
    frames
        .filter(|frame| SAMPLE.contains(&frame.0.as_str()))
        .cloned()
        .collect()
}

/// Rows of the table, measured now; none where the tools for it are missing.
fn measure(variants: &[Variant<'_>], frames: &[(String, Expected)]) -> Vec<Row> {
    let can_measure = |variant: &&Variant<'_>| {
        let needs_gcc = variant.request.features.contains(&"libgcc");
        if needs_gcc && !has_arm_gcc() {
            not_run("libgcc", "arm-none-eabi-gcc is not installed");
        }
        can_run(&variant.target) && (has_arm_gcc() || !needs_gcc)
    };
    let variants: Vec<_> = variants.iter().filter(can_measure).copied().collect();
    let (Some(compiler), false) = (compiler(), variants.is_empty()) else {
        not_run("the table", "nothing can be measured");
        return Vec::new();
    };
    measure::measure(&variants, frames, compiler, plugin()).unwrap()
}

/// The counting plugin.
fn plugin() -> &'static Path {
    static PLUGIN: OnceLock<PathBuf> = OnceLock::new();
    PLUGIN.get_or_init(|| run::build_plugin(&firmware::build_directory()).unwrap())
}

/// The rows on which the goals are, measured once.
fn measured() -> &'static [Row] {
    static ROWS: OnceLock<Vec<Row>> = OnceLock::new();
    ROWS.get_or_init(|| {
        let on_m4f = |profiles: &[&str]| {
            let mut variants = measure::variants();
            variants.retain(|it| it.target == CORTEX_M4F && profiles.contains(&it.profile));
            variants
        };
        let mut rows = measure(&on_m4f(&["speed"]), expected());
        rows.extend(measure(&on_m4f(&["size", "panel"]), &sample()));
        if !rows.is_empty() && has_arm_gcc() {
            let compiler = &rows[0].compiler;
            let peers = measure::measure_peers(&[CORTEX_M4F], &[], compiler, plugin());
            rows.extend(peers.unwrap());
        } else {
            not_run("plain C", "arm-none-eabi-gcc is not installed");
        }
        rows
    })
}

fn row<'a>(rows: &'a [Row], profile: &str, target: &str, program: &str) -> &'a Row {
    let is_it =
        |row: &&Row| row.profile == profile && row.target == target && row.program == program;
    rows.iter()
        .find(is_it)
        .unwrap_or_else(|| panic!("no {program} on {target}, {profile}"))
}

fn assert_in_table(rows: &[Row]) {
    let table = chart::read().unwrap();
    let comparison = chart::compare(&table, rows);
    if comparison.compared < rows.len() {
        say(&format!(
            "NOT COMPARED: {} of {} rows of tests/charts/firmware.csv, which {} made; here it is {}",
            rows.len() - comparison.compared,
            rows.len(),
            table[0].compiler,
            rows[0].compiler,
        ));
    }
    let differences = comparison.differences.join("\n");
    assert!(
        differences.is_empty(),
        "{differences}\nrun tests/embedded.sh table and look at it"
    );
}

#[test]
fn the_table_is_what_is_measured() {
    assert_in_table(measured());
}

#[test]
#[ignore = "builds and counts for many minutes: cargo test -p whitted-tests --test firmware -- --ignored"]
fn the_whole_table_is_what_is_measured() {
    assert_in_table(&measure(&measure::variants(), expected()));
}

#[test]
fn goals_are_met() {
    let rows = measured();
    if rows.is_empty() {
        return;
    }
    let m4f = |program| row(rows, "speed", "Cortex-M4F", program);
    // Bytes of flash.
    let goals = [
        ("speed", "query", 500),
        ("speed", "matte-shadows", 2048),
        ("speed", "everything", 10240),
    ];
    for (profile, program, most) in goals {
        let flash = row(rows, profile, "Cortex-M4F", program).flash;
        assert!(flash <= most, "{program} for {profile} takes {flash} bytes");
    }
    // Hundredths of plain C's cycles.
    if has_arm_gcc() {
        for (program, most) in [("six-spheres", 75.0), ("c-ray", 75.0), ("tiny", 75.0)] {
            let in_c = measure::in_c(program);
            let row = |name| row(rows, "speed", "Cortex-M4F", name);
            let [ours, theirs] = [program, &in_c].map(|it| row(it).cycles.unwrap());
            assert!(
                ours * 100.0 <= theirs * most,
                "{program}: {ours} to {theirs}"
            );
        }
        let pixels_a_megahertz = 1e6 / m4f("six-spheres").cycles.unwrap();
        assert!(pixels_a_megahertz >= 850.0, "{pixels_a_megahertz}");
    }
    // A part without FPU, where each float operation is a call; the support library not counted.
    let table = chart::read().unwrap();
    // What little there is without shadows is the camera, the root and what they share, most of all.
    let little = ["empty", "rays", "query", "matte", "floor"];
    let mut compared = 0;
    for hard in &table {
        let Row { program, flash, .. } = hard;
        let is_ours = !program.ends_with(&measure::in_c("")) && !little.contains(&program.as_str());
        if is_ours && (&*hard.profile, &*hard.target) == ("speed", "Cortex-M4F") {
            let soft = row(&table, "speed", "Cortex-M0", program).flash;
            assert!(
                soft * 100 <= flash * 125,
                "{program}: {soft} to {flash} bytes"
            );
            compared += 1;
        }
    }
    assert!(compared > 20, "{compared} programs compared");
    // Bytes of stack: spheres, plane, mirror and glass at depth 5.
    let stack = m4f("spheres-and-plane").stack_bound;
    assert!(stack.is_some_and(|bytes| bytes <= 640), "{stack:?}");
    for row in rows {
        assert_eq!(row.static_ram, 0, "{} has static RAM", row.program);
        let is_ours = !row.program.ends_with(&measure::in_c(""));
        // embedded-graphics has memory copied.
        let is_bare = row.profile != "panel";
        assert!(
            !(is_ours && is_bare) || row.support == 0,
            "{} does arithmetic in software on a part with FPU",
            row.program
        );
    }
}

#[test]
fn painted_stacks_are_what_the_code_allows() {
    for row in measured() {
        let Row {
            program,
            target,
            profile,
            stack,
            ..
        } = row;
        let Some(bound) = row.stack_bound else {
            continue;
        };
        assert_stack_is_bounded(&format!("{program} on {target}, {profile}"), *stack, bound);
    }
}

fn assert_stack_is_bounded(what: &str, painted: u64, bound: u64) {
    assert!(painted <= bound, "{what}: {painted} of {bound}");
    // Paths that no pixel of a frame takes need not be the deepest.
    assert!(
        bound - painted <= bound / 4 + 16,
        "{what}: painted {painted}, bound {bound}"
    );
}

#[test]
fn hierarchies_save_what_the_chart_says() {
    if !can_run(&CORTEX_M4F) {
        return;
    }
    let compiler = compiler().unwrap();
    let table = hierarchy::read().unwrap();
    let savings = hierarchy::measure(&[31], compiler, plugin()).unwrap();
    for saving in &savings {
        let known = table
            .iter()
            .find(|known| (&known.scene, known.objects) == (&saving.scene, saving.objects));
        let known = known.unwrap();
        if known.compiler == compiler {
            assert_eq!(saving, known, "run tests/embedded.sh table and look at it");
        } else {
            say(&format!("NOT COMPARED: {} made {known:?}", known.compiler));
        }
    }
    let few = table.iter().filter(|it| it.objects < 31);
    for saving in savings.iter().chain(few) {
        let Saving {
            flat, culled, tree, ..
        } = saving;
        // Few spheres are met sooner than any bound of them; many objects never are.
        match (saving.scene.as_str(), saving.objects) {
            ("spheres", 4) => assert!(flat < tree, "{saving:?}"),
            ("spheres", 31) => assert!(culled.unwrap() * 2.0 < *tree, "{saving:?}"),
            ("triangles", 31) => assert!(tree * 2.0 < *flat, "{saving:?}"),
            ("balls-3", _) => assert!(tree * 15.0 < *flat, "{saving:?}"),
            _ => {}
        }
    }
    match hierarchy::flash_of("balls-4").unwrap() {
        Some(flash) => assert!(flash <= 512 * 1024, "balls-4 takes {flash} bytes"),
        None => say("NOT RUN: balls-3 and balls-4, which are not beside the project"),
    }
}

/// Builds programs for the Cortex-M4F from a copy of the project: checksums of their code.
fn build_copy(copy: &Copy, programs: &[&str]) -> Result<BTreeMap<String, u64>> {
    let request = Request {
        programs,
        root: Some(copy.root()),
        ..Request::default()
    };
    let built = firmware::build(&[CORTEX_M4F], request)?;
    let checksums = built[0].iter().map(|(name, path)| {
        let image = Image::read(path)?;
        Ok((name.clone(), image.text_checksum()))
    });
    checksums.collect()
}

#[test]
fn a_planted_panic_does_not_link() {
    if compiler().is_none() {
        return not_run("the planted panic", "there is no compiler for it");
    }
    let copy = Copy::new("panic").unwrap();
    let body = Body {
        file: "core/src/shape/sphere.rs",
        after: &["impl Shape for Sphere", "fn intersect"],
    };
    let index =
        "let planted = [0_u8; 4][core::hint::black_box(1)]; core::hint::black_box(planted);";
    copy.insert(&body, index).unwrap();
    let error = build_copy(&copy, &["matte"]).unwrap_err().to_string();
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
        // What lists of candidates and slices have in common.
        bodies: &[body("core/src/shape/sphere.rs", &["fn roots<"])],
        named_by: |program| !is_one_of(program, &["empty", "rays", "outside", "maze", "doors"]),
    },
    Feature {
        name: "planes",
        bodies: &[intersect("core/src/shape/plane.rs")],
        named_by: |program| {
            let others = [
                "spheres-and-plane",
                "six-spheres",
                "tiny",
                "outside",
                "quadric",
                "torus",
                "instance",
                "csg",
                "soft",
                "smooth",
                "patterns",
                "texture",
                "tinted-glass",
            ];
            is_on_or_above(program, "floor") || is_one_of(program, &others)
        },
    },
    Feature {
        name: "shadows",
        bodies: &[
            body(
                "core/src/geometry.rs",
                &["Geometry for [Object", "fn blocks<"],
            ),
            // Culled slices have loops of their own: those of c-ray's layout.
            body("core/src/candidates.rs", &["fn blocks<"]),
        ],
        named_by: |program| {
            let opaque = [
                "matte-shadows",
                "c-ray",
                "outside",
                "quadric",
                "torus",
                "instance",
                "csg",
                "soft",
                "smooth",
                "patterns",
                "texture",
            ];
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
                "quadric",
                "torus",
                "instance",
                "csg",
                "soft",
                "smooth",
                "patterns",
                "texture",
                "tinted-glass",
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
        // What is met and what solids cut have in common.
        bodies: &[body("core/src/shape/cuboid.rs", &["fn roots("])],
        named_by: |program| is_on_or_above(program, "cuboid") || program == "csg",
    },
    Feature {
        name: "frusta",
        bodies: &[intersect("core/src/shape/frustum.rs")],
        named_by: |program| is_on_or_above(program, "frustum"),
    },
    Feature {
        name: "quadrics",
        bodies: &[body("core/src/shape/quadric.rs", &["fn meets<"])],
        named_by: |program| program == "quadric",
    },
    Feature {
        name: "tori",
        bodies: &[body("core/src/shape/torus.rs", &["fn walk<"])],
        named_by: |program| program == "torus",
    },
    Feature {
        name: "instances",
        bodies: &[body("core/src/instance.rs", &["fn local<"])],
        named_by: |program| program == "instance",
    },
    Feature {
        name: "solids that are joined",
        bodies: &[body("core/src/csg.rs", &["fn surfaces<"])],
        named_by: |program| program == "csg",
    },
    Feature {
        name: "soft shadows",
        bodies: &[body("core/src/area.rs", &["for AreaLight<E>", "fn share<"])],
        named_by: |program| program == "soft",
    },
    Feature {
        name: "adaptive anti-aliasing",
        bodies: &[body("core/src/antialiasing.rs", &["pub fn pixel("])],
        named_by: |program| program == "smooth",
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
                "maze",
                "doors",
                "tinted-glass",
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
            let others = ["spheres-and-plane", "six-spheres", "tiny", "tinted-glass"];
            is_on_or_above(program, "glass") || is_one_of(program, &others)
        },
    },
    Feature {
        name: "glass that colors light",
        bodies: &[body(
            "core/src/math.rs",
            &["impl Passage for Transmittances", "fn pass("],
        )],
        named_by: |program| program == "tinted-glass",
    },
    Feature {
        name: "checkers",
        bodies: &[body(
            "core/src/pattern.rs",
            &["impl Varying for Checker", "fn at("],
        )],
        named_by: |program| program == "patterns",
    },
    Feature {
        name: "images",
        bodies: &[body(
            "core/src/pattern.rs",
            &["impl Filter for Bilinear", "fn sample("],
        )],
        named_by: |program| program == "texture",
    },
    Feature {
        name: "maps",
        bodies: &[body("core/src/grid.rs", &["impl<'a> Walk<'a>", "fn step("])],
        named_by: |program| is_one_of(program, &["maze", "doors"]),
    },
    Feature {
        name: "doors",
        bodies: &[body(
            "core/src/grid/doors.rs",
            &["impl Way for DoorWalk", "fn next_wall("],
        )],
        named_by: |program| program == "doors",
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
    let programs: Vec<_> = before.keys().map(String::as_str).collect();
    let after = build_copy(copy, &programs).unwrap();
    for original in originals {
        original.restore().unwrap();
    }
    before
        .keys()
        .filter(|name| after[*name] != before[*name])
        .cloned()
        .collect()
}

/// In a copy of the project, which no other test may have, adds or cuts each feature.
fn features_change_only_programs_that_name_them(
    copy: &str,
    features: &[&Feature],
    programs: &[&str],
) {
    if compiler().is_none() {
        return not_run("features", "there is no compiler for it");
    }
    let copy = Copy::new(copy).unwrap();
    let before = build_copy(&copy, programs).unwrap();
    let mut others = Vec::new();
    for feature in features {
        let changed = changed_by(&copy, &before, feature);
        let named_by: BTreeSet<_> = before
            .keys()
            .filter(|program| (feature.named_by)(program))
            .cloned()
            .collect();
        let difference: Vec<_> = changed.symmetric_difference(&named_by).cloned().collect();
        if !difference.is_empty() {
            others.push((feature.name, difference));
        }
    }
    assert!(others.is_empty(), "not as named: {others:?}");

    // And a feature that is not named but used all the same is found.
    let sphere = intersect("core/src/shape/sphere.rs");
    let use_of_cuboid = "core::hint::black_box(
        super::cuboid::Cuboid { min: self.center, max: ray.origin }
            .intersect::<P>(ray, &ray.direction, leaving),
    );";
    copy.insert(&sphere, use_of_cuboid).unwrap();
    let before = build_copy(&copy, &["matte"]).unwrap();
    let cuboid = FEATURES
        .iter()
        .find(|feature| feature.name == "boxes")
        .unwrap();
    assert!(changed_by(&copy, &before, cuboid).contains("matte"));
}

#[test]
fn what_is_new_or_not_named_changes_no_program() {
    // New code, and code that some programs name.
    let some = FEATURES
        .iter()
        .filter(|it| ["what no program here names", "boxes"].contains(&it.name));
    features_change_only_programs_that_name_them("features", &some.collect::<Vec<_>>(), &SAMPLE);
}

#[test]
#[ignore = "builds for many minutes: cargo test -p whitted-tests --test firmware -- --ignored"]
fn no_feature_changes_programs_that_do_not_name_it() {
    let all: Vec<_> = FEATURES.iter().collect();
    let names = firmware::names().unwrap();
    let names: Vec<_> = names.iter().map(String::as_str).collect();
    features_change_only_programs_that_name_them("all-features", &all, &names);
}
