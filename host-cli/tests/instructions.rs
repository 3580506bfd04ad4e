//! Instructions that rays and frames take, counted by callgrind: a slower change shows on any machine,
//! however busy.
//!
//! `tests/charts/instructions.csv` holds them by compiler and profile. `WHITTED_COUNT=1` writes those of
//! this compiler and profile anew.

#[allow(dead_code)]
#[path = "../../tests/bench/src/workload.rs"]
mod workload;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;

use fearless_simd::Level;
use glam::Vec3;
use whitted::Geometry;
use whitted_cli::scene::{HostScene, Pool};
use whitted_cli::scene_file::{self, SceneFile};
use whitted_cli::wide::lockstep::{self, Job};
use whitted_cli::wide::{Wide, levels};
use workload::{Query, Workload};

/// More than this share up or down is a change.
const TOLERANCE: f64 = 0.02;

/// What valgrind knows of those that most machines have.
const LEVEL: &str = "AVX2";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn level() -> Option<Level> {
    levels().into_iter().find(|it| it.0 == LEVEL).map(|it| it.1)
}

/// Something to be counted, and by how many units.
struct Work {
    name: String,
    units: usize,
    run: Box<dyn FnMut()>,
}

fn all_work(level: Level) -> Vec<Work> {
    let mut all = Vec::new();
    for (name, shapes) in [
        ("8 spheres", workload::spheres(8)),
        ("64 spheres", workload::spheres(64)),
        ("16 boxes", workload::cuboids(16)),
        ("16 triangles", workload::triangles(16)),
        ("sphereflake", workload::flake(2)),
    ] {
        let workload: &Workload = Box::leak(Box::new(Workload::new(name, shapes, 48)));
        let wide: &Wide<'_, _> =
            Box::leak(Box::new(Wide::with_level(workload.shapes.kinds(), level)));
        for set in &workload.rays {
            let mut add = |how: &str, run: Box<dyn FnMut()>| {
                all.push(Work {
                    name: format!("{name}, {}, {how}", set.name),
                    units: set.rays.len(),
                    run,
                });
            };
            match set.query {
                Query::Nearest => {
                    add(
                        "one by one",
                        Box::new(|| {
                            for ray in &set.rays {
                                std::hint::black_box(wide.closest_hit(ray));
                            }
                        }),
                    );
                    add(
                        "together",
                        Box::new(|| {
                            lockstep::closest_hits(wide, &set.rays, |ray, hit| {
                                std::hint::black_box((ray, hit));
                            });
                        }),
                    );
                }
                Query::Any => {
                    let mut passed = vec![0.0; set.rays.len()];
                    add(
                        "one by one",
                        Box::new(|| {
                            for ray in &set.rays {
                                std::hint::black_box(wide.occluded(ray));
                            }
                        }),
                    );
                    add(
                        "together",
                        Box::new(move || lockstep::transmittances(wide, &set.rays, &mut passed)),
                    );
                }
            }
        }
    }
    for name in ["balls-3", "gears-1", "teapot-4"] {
        let path = root().join(format!("../shared/scenes/spd/{name}.nff"));
        if !path.is_file() {
            eprintln!("skipped: {name}, which is not here");
            continue;
        }
        const SIZE: u32 = 64;
        let file: &SceneFile = Box::leak(Box::new(scene_file::read(&path).unwrap()));
        let host = HostScene::new(file, Box::leak(Box::new(Pool::new(file)))).unwrap();
        let host: &HostScene<'_> = Box::leak(Box::new(host));
        let view = host.camera(SIZE, SIZE).unwrap().unwrap();
        let mut pixels = vec![Vec3::ZERO; (SIZE * SIZE) as usize];
        let run = move || {
            let scene = host.scene();
            let job = Job {
                geometry: &Wide::with_level(scene.geometry, level),
                lights: scene.lights,
                background: scene.background,
                ambient: scene.ambient,
                depth: file.depth,
                threshold: 0.0,
            };
            lockstep::tile(&job, &view, 0..SIZE, 0..SIZE, &mut pixels);
        };
        all.push(Work {
            name: format!("{name}, a frame of {SIZE}x{SIZE}"),
            units: 1,
            run: Box::new(run),
        });
    }
    all
}

/// What callgrind counts.
#[inline(never)]
fn counted(work: &mut dyn FnMut()) {
    work();
}

#[test]
#[ignore = "is run under callgrind by `instructions_are_as_many_as_they_were`"]
fn work() {
    let Some(level) = level() else { return };
    for work in &mut all_work(level) {
        counted(&mut work.run);
    }
}

/// Of each piece of work, or why there is no counting.
fn count() -> Result<BTreeMap<String, f64>, String> {
    let level = level().ok_or(format!("this machine has no {LEVEL}"))?;
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("counts");
    let status = Command::new("valgrind")
        .args(["--tool=callgrind", "--toggle-collect=instructions::counted"])
        .args([
            "--dump-after=instructions::counted",
            "--read-inline-info=no",
        ])
        .arg(format!("--callgrind-out-file={}", output.display()))
        .arg(std::env::current_exe().unwrap())
        .args(["--ignored", "--exact", "work", "--test-threads=1"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .map_err(|_| "valgrind is not installed (Debian: valgrind)")?;
    if !status.success() {
        return Err(format!("valgrind: {status}"));
    }
    let counts = all_work(level).into_iter().enumerate().map(|(i, work)| {
        let path = format!("{}.{}", output.display(), i + 1);
        let text = std::fs::read_to_string(&path).unwrap();
        let total = text.lines().find_map(|it| it.strip_prefix("totals: "));
        let total: f64 = total.unwrap().trim().parse().unwrap();
        assert!(total > 0.0, "{}: nothing was counted", work.name);
        (work.name, total / work.units as f64)
    });
    Ok(counts.collect())
}

fn compiler() -> &'static str {
    static VERSION: OnceLock<String> = OnceLock::new();
    VERSION.get_or_init(|| {
        let rustc = std::env::var_os("RUSTC").unwrap_or("rustc".into());
        let output = Command::new(rustc).arg("--version").output().unwrap();
        String::from_utf8(output.stdout).unwrap().trim().to_owned()
    })
}

/// What the compiler inlines depends on whether it keeps parts for the next time.
fn profile() -> &'static str {
    match (cfg!(debug_assertions), option_env!("CARGO_INCREMENTAL")) {
        (true, Some("0")) => "dev in one go",
        (true, _) => "dev",
        (false, _) => "release",
    }
}

#[test]
fn instructions_are_as_many_as_they_were() {
    let path = root().join("tests/charts/instructions.csv");
    let table = std::fs::read_to_string(&path).unwrap_or_default();
    let key = format!("{},{},{LEVEL}", compiler(), profile());
    let mine = |line: &&str| line.starts_with(&format!("{key};"));
    let writes = std::env::var_os("WHITTED_COUNT").is_some();
    if !writes && !table.lines().any(|line| mine(&line)) {
        eprintln!("skipped: no counts of {key}");
        return;
    }
    let counts = match count() {
        Ok(counts) => counts,
        Err(why) => {
            eprintln!("skipped: {why}");
            return;
        }
    };
    if writes {
        let others = table.lines().skip(1).filter(|line| !mine(line));
        let mut lines: Vec<_> = others.map(str::to_owned).collect();
        lines.extend(
            counts
                .iter()
                .map(|(name, count)| format!("{key};{name};{count:.1}")),
        );
        let head = "compiler,profile,instructions;work;a ray or a frame\n";
        std::fs::write(&path, format!("{head}{}\n", lines.join("\n"))).unwrap();
        return;
    }
    let mut off = Vec::new();
    for line in table.lines().filter(mine) {
        let [_, name, before] = line.split(';').collect::<Vec<_>>()[..] else {
            panic!("{line}");
        };
        let before: f64 = before.parse().unwrap();
        // The standard scenes may not be here.
        if let Some(now) = counts.get(name)
            && (now / before - 1.0).abs() > TOLERANCE
        {
            off.push(format!("{name}: {now:.1}, was {before:.1}"));
        }
    }
    assert!(off.is_empty(), "{}", off.join("\n"));
}
