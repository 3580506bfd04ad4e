//! Whole pictures: the same bits by vectors, on any number of threads, as object by object.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use glam::Vec3;
use rayon::ThreadPoolBuilder;
use whitted::antialiasing::{Adaptive, supersampled_row};
use whitted::{Counters, Exact, Tracer, View};
use whitted_cli::render::{Sampling, Settings, keep, render_at, render_sampled};
use whitted_cli::scene::{AnyScene, HostScene, Pool};
use whitted_cli::scene_file::{self, limits};
use whitted_cli::wide::levels;

/// All scenes that there are.
fn scenes() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let mut scenes = vec![
        root.join("host-cli/scenes/builtin.toml"),
        root.join("tests/golden/spheres.toml"),
        root.join("tests/gallery/panel.toml"),
        root.join("tests/gallery/globe.toml"),
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
                        render_at(level, &scene, &view, rows, settings, keep, |it| {
                            pixels.extend_from_slice(it);
                            Ok::<_, ()>(())
                        })
                    });
                    assert!(bits(&pixels) == plain, "{what}");
                    assert_eq!(counted, Ok(counters), "{what}");
                }
            }
        }
    }
}

#[test]
fn sampled_pictures_have_the_bits_of_the_core_s_own() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    for name in ["host-cli/scenes/builtin.toml", "tests/gallery/panel.toml"] {
        let file = scene_file::read(&root.join(name)).unwrap();
        let pool = Pool::new(&file);
        let host = HostScene::new(&file, &pool).unwrap();
        let scene = host.scene();
        let view = host.camera(23, 37).unwrap().unwrap();
        let settings = Settings {
            depth: file.depth,
            threshold: 0.0,
        };
        let tracer = || {
            let mut tracer = Tracer::<{ limits::DEPTH }, Exact, _>::with(Counters::default());
            tracer.depth = settings.depth;
            tracer
        };
        let regular = |samples| {
            let mut row = [Vec3::ZERO; 23];
            let rows = (0..view.height).flat_map(|y| {
                supersampled_row(&scene, &view, y, samples, &mut tracer(), &mut row);
                row
            });
            rows.collect::<Vec<_>>()
        };
        let adaptive = |bound| {
            let mut shared = [Vec3::ZERO; 24];
            let mut adaptive =
                Adaptive::<_, _, _, _, _, 5>::new(&scene, view, tracer(), bound, &mut shared);
            let rows = (0..view.height).flat_map(|y| adaptive.row(y).collect::<Vec<_>>());
            rows.collect::<Vec<_>>()
        };
        let levels = 2;
        let cases = [
            (Sampling::Regular(1), regular(1)),
            (Sampling::Regular(3), regular(3)),
            (Sampling::Adaptive { bound: 0.1, levels }, adaptive(0.1)),
            (Sampling::Adaptive { bound: 0.0, levels }, adaptive(0.0)),
        ];
        for (sampling, expected) in cases {
            for (threads, rows) in [(1, 0..37), (2, 0..37), (2, 5..30), (1, 36..37)] {
                let pool = ThreadPoolBuilder::new().num_threads(threads);
                let mut pixels = Vec::new();
                let counted = pool.build().unwrap().install(|| {
                    let emit = |it: &[Vec3]| {
                        pixels.extend_from_slice(it);
                        Ok::<_, ()>(())
                    };
                    let rows = rows.clone();
                    render_sampled(&host, &view, rows, settings, sampling, keep, emit)
                });
                let expected = &expected[23 * rows.start as usize..23 * rows.end as usize];
                assert!(
                    bits(&pixels) == bits(expected),
                    "{name}, {sampling:?}, {rows:?}"
                );
                let primary = counted.unwrap().primary;
                match sampling {
                    Sampling::Regular(samples) => {
                        let all = u64::from(samples * samples) * pixels.len() as u64;
                        assert_eq!(primary, all);
                    }
                    _ => assert!(primary < 25 * pixels.len() as u64, "{primary}"),
                }
            }
        }
    }
}
