//! Whole frames: against POV-Ray, against our shader on Embree, by threads, by builds, and the layouts of
//! c-ray.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use anyhow::Context;
use glam::Vec3;
use nix::sys::resource::{UsageWho, getrusage};
use rayon::ThreadPoolBuilder;
use whitted::{Counters, Exact, Scene, Tracer};
use whitted_cli::compare::Comparison;
use whitted_cli::picture::{Picture, Transfer};
use whitted_cli::render::{Settings, encode, render};
use whitted_cli::scene::{HostScene, Pool};
use whitted_cli::scene_file::{self, SceneFile, limits};

use crate::embree::Intersector;
use crate::pov;
use crate::report::{Report, ratio};
use crate::workload::Random;

/// The first argument with which this program is `whitted` itself.
pub const AS_WHITTED: &str = "--as-whitted";

const SIZE: u32 = 512;
/// So many rounds, for one in which a second processor, idle until then, is awake at once.
const AWAKE: usize = 20;
const SCENES: [&str; 7] = [
    "balls-4",
    "gears-2",
    "mount-4",
    "rings-3",
    "teapot-12",
    "tetra-6",
    "tree-8",
];

/// What the program makes of pixels.
fn develop(pixels: &[Vec3], bytes: &mut [[u8; 3]]) {
    encode(pixels, bytes, Transfer::Linear);
}

/// Seconds of all processors that a program takes, the system's work for it included.
fn cpu_seconds(command: &mut Command) -> anyhow::Result<f64> {
    let used = || -> anyhow::Result<f64> {
        let usage = getrusage(UsageWho::RUSAGE_CHILDREN)?;
        let times = [usage.user_time(), usage.system_time()];
        let seconds = times.map(|it| it.tv_sec() as f64 + it.tv_usec() as f64 * 1e-6);
        Ok(seconds.iter().sum())
    };
    let before = used()?;
    let status = command
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()?;
    anyhow::ensure!(status.success(), "{command:?}: {status}");
    Ok(used()? - before)
}

fn whitted(scene: &Path, output: &Path) -> anyhow::Result<Command> {
    let mut command = Command::new(std::env::current_exe()?);
    command.arg(AS_WHITTED);
    arguments(&mut command, scene, output);
    Ok(command)
}

fn arguments(command: &mut Command, scene: &Path, output: &Path) {
    command.arg("render").arg(scene).arg("-o").arg(output);
    command.args(["--size", &format!("{SIZE}x{SIZE}"), "--threads", "1"]);
}

/// The program, built for this very processor.
fn native() -> anyhow::Result<PathBuf> {
    let program = std::env::current_exe()?;
    let folder = program.parent().context("a program lies in a folder")?;
    let target = folder.join("native");
    eprintln!("building for this processor");
    let status = Command::new(env!("CARGO"))
        .args(["build", "--release", "--locked", "-p", "whitted-cli"])
        .arg("--target-dir")
        .arg(&target)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .env("RUSTFLAGS", "-Ctarget-cpu=native")
        .status()?;
    anyhow::ensure!(status.success(), "cargo: {status}");
    Ok(target.join("release/whitted"))
}

/// The share of channels that differ by at most one step of 255.
fn agreement(a: &Path, b: &Path) -> anyhow::Result<f64> {
    let comparison = Comparison::new(&Picture::read(a)?, &Picture::read(b)?)?;
    let beyond = comparison.channels_beyond(1) as f64;
    Ok(1.0 - beyond / comparison.all_channels() as f64)
}

/// Every frame by every means.
pub fn run(report: &mut Report, rounds: usize, quick: bool) -> anyhow::Result<()> {
    let folder = tempfile::tempdir()?;
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes/spd");
    let native = if quick { None } else { native().ok() };
    let mut rows = Vec::new();
    let mut shader = Vec::new();
    for name in SCENES.iter().take(if quick { 1 } else { SCENES.len() }) {
        let path = scenes.join(format!("{name}.nff"));
        if !path.is_file() {
            report.note(&format!("{name}: the scene is not here"));
            continue;
        }
        let file = scene_file::read(&path)?;
        rows.push(processes(
            name,
            &path,
            &file,
            folder.path(),
            native.as_deref(),
            rounds,
        )?);
        shader.push(intersectors(name, &file, rounds.max(AWAKE))?);
        eprintln!("{name}: {:?} {:?}", rows.last(), shader.last());
    }
    report.table(
        &format!("Whole processes, {SIZE}x{SIZE}, one thread, CPU seconds"),
        &[
            "scene",
            "POV-Ray / whitted",
            "channels within 1/255",
            "built for this processor / plain",
        ],
        &rows,
    );
    report.table(
        &format!("The same frames in one process, {SIZE}x{SIZE}"),
        &[
            "scene",
            "our shader on Embree / whitted, one thread",
            "one thread / two threads",
        ],
        &shader,
    );
    cray(report, rounds)
}

fn processes(
    name: &str,
    path: &Path,
    file: &SceneFile,
    folder: &Path,
    native: Option<&Path>,
    rounds: usize,
) -> anyhow::Result<Vec<String>> {
    let [ours, theirs, scene] = ["ours.ppm", "theirs.ppm", "scene.pov"].map(|it| folder.join(it));
    pov::write(file, &scene)?;
    let mut best = [f64::INFINITY; 3];
    let mut missing = "";
    for _ in 0..rounds {
        best[0] = best[0].min(cpu_seconds(&mut whitted(path, &ours)?)?);
        if missing.is_empty() {
            let mut command = Command::new("povray");
            command.arg(format!("+I{}", scene.display()));
            command.arg(format!("+O{}", theirs.display()));
            command.args(["+FP", "File_Gamma=1.0", "-A", "-D", "+WT1"]);
            command.args([format!("+W{SIZE}"), format!("+H{SIZE}")]);
            match cpu_seconds(&mut command) {
                Ok(seconds) => best[1] = best[1].min(seconds),
                Err(_) => missing = "not installed (Debian: povray)",
            }
        }
        if let Some(native) = native {
            let mut command = Command::new(native);
            arguments(&mut command, path, &folder.join("native.ppm"));
            best[2] = best[2].min(cpu_seconds(&mut command)?);
        }
    }
    let agrees = if missing.is_empty() {
        format!("{:.2} %", 100.0 * agreement(&ours, &theirs)?)
    } else {
        missing.into()
    };
    Ok(vec![
        name.into(),
        if missing.is_empty() {
            ratio(best[1] / best[0])
        } else {
            missing.into()
        },
        agrees,
        if native.is_some() {
            ratio(best[2] / best[0])
        } else {
            "not built".into()
        },
    ])
}

fn intersectors(name: &str, file: &SceneFile, rounds: usize) -> anyhow::Result<Vec<String>> {
    let pool = Pool::new(file);
    let host = HostScene::new(file, &pool)?;
    let view = host.camera(SIZE, SIZE)?.context("no camera")?;
    let scene = host.scene();
    let settings = Settings {
        depth: file.depth,
        threshold: 0.0,
    };
    let frame = || {
        let rows = 0..SIZE;
        render(&scene, &view, rows, settings, develop, |_| Ok::<_, ()>(()))
    };
    let threads = [1, 2].map(|it| ThreadPoolBuilder::new().num_threads(it).build());
    let [one, two] = threads;
    let (one, two) = (one?, two?);
    let embree = Intersector::new(scene.geometry);
    let mut best = [f64::INFINITY; 3];
    for _ in 0..rounds {
        let start = Instant::now();
        let _ = one.install(frame);
        best[0] = best[0].min(start.elapsed().as_secs_f64());
        let start = Instant::now();
        let _ = two.install(frame);
        best[1] = best[1].min(start.elapsed().as_secs_f64());
        if embree.is_ok() {
            let start = Instant::now();
            // The tree is built anew, as for our frames.
            let scene = Scene {
                geometry: Intersector::new(scene.geometry).map_err(anyhow::Error::msg)?,
                lights: scene.lights,
                background: scene.background,
                ambient: scene.ambient,
            };
            let mut tracer = Tracer::<{ limits::DEPTH }, Exact, _>::with(Counters::default());
            tracer.depth = file.depth;
            let mut sum = Vec3::ZERO;
            for row in 0..SIZE {
                for ray in view.rays(row) {
                    sum += tracer.radiance(&scene, ray);
                }
            }
            std::hint::black_box(sum);
            best[2] = best[2].min(start.elapsed().as_secs_f64());
        }
    }
    let on_embree = match embree {
        Ok(_) => ratio(best[2] / best[0]),
        Err(why) => why,
    };
    Ok(vec![name.into(), on_embree, ratio(best[0] / best[1])])
}

/// c-ray's two layouts, remade: a few mirrors on a large sphere, and a fractal of 189 spheres. Nanoseconds
/// a pixel are what c-ray prints, and so what is printed here.
fn cray(report: &mut Report, rounds: usize) -> anyhow::Result<()> {
    let mut rows = Vec::new();
    for (name, spheres) in [("4 spheres", few()), ("189 spheres", fractal())] {
        let text = cray_scene(&spheres);
        let file = scene_file::toml::parse(Path::new("c-ray.toml"), &text)?;
        let pool = Pool::new(&file);
        let host = HostScene::new(&file, &pool)?;
        let view = host.camera(800, 600)?.context("no camera")?;
        let scene = host.scene();
        let settings = Settings {
            depth: 5,
            threshold: 0.0,
        };
        let one = ThreadPoolBuilder::new().num_threads(1).build()?;
        let mut best = f64::INFINITY;
        for _ in 0..rounds.max(5) {
            let start = Instant::now();
            let _ = one.install(|| {
                render(
                    &scene,
                    &view,
                    0..600,
                    settings,
                    develop,
                    |_| Ok::<_, ()>(()),
                )
            });
            best = best.min(start.elapsed().as_secs_f64());
        }
        rows.push(vec![
            name.into(),
            format!("{:.0}", best / (800.0 * 600.0) * 1e9),
        ]);
    }
    report.table(
        "c-ray's layouts, 800x600, depth 5, one thread, the hierarchy's construction included",
        &["layout", "ns a pixel"],
        &rows,
    );
    Ok(())
}

type Balls = Vec<(Vec3, f32)>;

fn few() -> Balls {
    vec![
        (Vec3::new(-1.5, -0.3, -1.0), 0.7),
        (Vec3::new(1.5, -0.4, 0.0), 0.6),
        (Vec3::new(0.0, -1000.0, 2.0), 999.0),
        (Vec3::new(0.0, 0.0, 2.0), 1.0),
    ]
}

/// One ball on the ground, and on each ball smaller ones, until there are 189.
fn fractal() -> Balls {
    let mut balls = vec![(Vec3::new(0.0, -1000.0, 0.0), 999.0), (Vec3::ZERO, 1.0)];
    let mut random = Random::new(0xc4a1);
    let mut parent = 1;
    while balls.len() < 189 {
        let (center, radius): (Vec3, f32) = balls[parent];
        for _ in 0..6 {
            let mut way = random.direction();
            way.y = way.y.abs();
            if balls.len() < 189 {
                balls.push((center + way * (radius * 1.4), radius * 0.4));
            }
        }
        parent += 1;
    }
    balls
}

fn cray_scene(balls: &Balls) -> String {
    let mut text = String::from(
        "depth = 5\n[camera]\neye = [0, 6, -17]\ntarget = [0, -1, 0]\nfov = 45\n\
         [[light]]\nposition = [-50, 100, -50]\n[[light]]\nposition = [40, 40, 150]\n\
         [material.mirror]\ncolor = [1, 0.5, 0.1]\nspecular = 1\nshininess = 60\nreflectance = 0.7\n\
         [material.ground]\ncolor = [0.2, 0.35, 0.5]\nspecular = 1\nshininess = 80\nreflectance = 0.4\n",
    );
    for &(center, radius) in balls {
        let material = if radius > 100.0 { "ground" } else { "mirror" };
        text += &format!(
            "[[sphere]]\nmaterial = \"{material}\"\ncenter = [{:?}, {:?}, {:?}]\nradius = {radius:?}\n",
            center.x, center.y, center.z
        );
    }
    text
}
