//! Whole pictures: the same bits by vectors, on any number of threads, as object by object.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use glam::Vec3;
use rayon::ThreadPoolBuilder;
use whitted::{Counters, Exact, Tracer, View};
use whitted_cli::render::{Settings, render_at};
use whitted_cli::scene::{AnyScene, HostScene, Pool};
use whitted_cli::scene_file::{self, limits};
use whitted_cli::wide::levels;

/// All scenes that there are.
fn scenes() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let mut scenes = vec![
        root.join("host-cli/scenes/builtin.toml"),
        root.join("tests/golden/spheres.toml"),
    ];
    match root.join("../shared/scenes/spd").read_dir() {
        Ok(files) => scenes.extend(files.map(|file| file.unwrap().path())),
        Err(_) => {
            // Not printed: the harness keeps what passing tests print.
            let _ = writeln!(
                io::stderr(),
                "NOT RUN: the standard scenes, which are not here"
            );
        }
    }
    scenes
}

/// A picture of the flat slices, whose kernels know nothing of vectors.
fn plainly(scene: &AnyScene<'_>, view: &View, settings: Settings) -> (Vec<Vec3>, Counters) {
    let mut tracer = Tracer::<{ limits::DEPTH }, Exact, _>::with(Counters::default());
    (tracer.depth, tracer.threshold) = (settings.depth, settings.threshold);
    let pixels = (0..view.height)
        .flat_map(|row| view.rays(row))
        .map(|ray| tracer.radiance(scene, ray))
        .collect();
    (pixels, tracer.counters)
}

fn bits(pixels: &[Vec3]) -> Vec<[u32; 3]> {
    let bits = |it: &Vec3| it.to_array().map(f32::to_bits);
    pixels.iter().map(bits).collect()
}

#[test]
fn every_picture_has_the_bits_of_the_plain_slices() {
    for path in scenes() {
        let file = scene_file::read(&path).unwrap();
        let pool = Pool::new(&file);
        let host = HostScene::new(&file, &pool).unwrap();
        let scene = host.scene();
        // No multiple of a vector's or a tile's sides.
        let view = host.camera(39, 29).unwrap().unwrap();
        for threshold in [0.0, 0.02] {
            let settings = Settings {
                depth: file.depth,
                threshold,
            };
            let (plain, counters) = plainly(&scene, &view, settings);
            let plain = bits(&plain);
            for (name, level) in levels() {
                for threads in [1, 2] {
                    let what = format!("{}, {name}, {threads} threads", path.display());
                    let pool = ThreadPoolBuilder::new().num_threads(threads);
                    let mut pixels = Vec::new();
                    let counted = pool.build().unwrap().install(|| {
                        let rows = 0..view.height;
                        render_at(
                            level,
                            &scene,
                            &view,
                            rows,
                            settings,
                            || {},
                            |it| {
                                pixels.extend_from_slice(it);
                                Ok::<_, ()>(())
                            },
                        )
                    });
                    assert!(bits(&pixels) == plain, "{what}");
                    assert_eq!(counted, Ok(counters), "{what}");
                }
            }
        }
    }
}
