//! Whole pictures: the same bits by vectors, on any number of threads, as object by object.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use glam::Vec3;
use rayon::ThreadPoolBuilder;
use whitted::antialiasing::{Adaptive, supersampled_row};
use whitted::{Counters, Exact, Scene, Tracer, View};
use whitted_cli::render::{Sampling, Settings, keep, render_at, render_sampled};
use whitted_cli::scene::{AnyScene, HostScene, Pool};
use whitted_cli::scene_file::{self, SceneFile, limits};
use whitted_cli::wide::lockstep::{self, Job};
use whitted_cli::wide::{Wide, levels};

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

/// Mirrors, glass and dull things of every kind that has lanes, side by side above a floor, under two
/// lights: what a ray meets here sends others all ways.
fn mirrors() -> SceneFile {
    let mut nff = String::from(
        "b 0.1 0.2 0.3\n\
         v\nfrom 3 -13 7\nat 0 0 0\nup 0 0 1\nangle 50\nhither 1\nresolution 4 4\n\
         l 6 -9 9\nl -8 -5 6\n\
         f 0.9 0.8 0.6 0.6 0.3 9 0 1\np 4\n-9 -9 -1\n9 -9 -1\n9 9 -1\n-9 9 -1\n",
    );
    let finishes = [
        "f 0.9 0.3 0.2 0.3 0.7 30 0 1",
        "f 1 1 1 0.1 0.2 50 0.8 1.4",
        "f 0.2 0.7 0.9 0.8 0 1 0 1",
    ];
    for place in 0..120 {
        let (x, y) = (place % 12 - 6, place / 12 - 5);
        let z = f64::from(place * 7 % 5) * 0.3;
        let shape = match place % 4 {
            0 | 1 => format!("s {x} {y} {z} 0.55"),
            2 => format!("c\n{x} {y} {z} 0.5\n{x} {y} {} 0.2", z + 0.9),
            _ => format!(
                "p 3\n{x} {y} {z}\n{} {y} {z}\n{x} {} {}",
                x + 1,
                y + 1,
                z + 1.0
            ),
        };
        let finish = finishes[(place % 7 % 3) as usize];
        nff += &format!("{finish}\n{shape}\n");
    }
    scene_file::nff::parse(Path::new("mirrors.nff"), nff.as_bytes()).unwrap()
}

/// Rays that part go on with others of their tile: each still adds to its own pixel, in its own order.
#[test]
fn rays_that_part_have_the_bits_of_the_plain_slices() {
    let file = mirrors();
    let pool = Pool::new(&file);
    let host = HostScene::new(&file, &pool).unwrap();
    let scene = host.scene();
    let view = host.camera(70, 50).unwrap().unwrap();
    // With one light, rays are not gathered where they hit.
    for lights in [2, 1] {
        let lights = &scene.lights[..lights];
        let scene = Scene { lights, ..scene };
        for depth in [2, 6] {
            let settings = Settings {
                depth,
                threshold: 0.001,
            };
            let (plain, counters) = plainly(&scene, &view, settings);
            for (name, level) in levels() {
                let job = Job {
                    geometry: &Wide::with_level(scene.geometry, level),
                    lights: scene.lights,
                    background: scene.background,
                    ambient: scene.ambient,
                    depth,
                    threshold: settings.threshold,
                };
                // All at once, and by tiles that end within groups; over what was there before.
                for [height, width] in [[50, 70], [21, 33], [4, 70], [1, 1]] {
                    let mut counted = Counters::default();
                    for top in (0..view.height).step_by(height) {
                        for left in (0..view.width).step_by(width) {
                            let rows = top..view.height.min(top + height as u32);
                            let columns = left..view.width.min(left + width as u32);
                            let mut pixels = vec![Vec3::ONE; rows.len() * columns.len()];
                            counted += lockstep::tile(
                                &job,
                                &view,
                                rows.clone(),
                                columns.clone(),
                                &mut pixels,
                            );
                            for (row, pixels) in rows.zip(pixels.chunks(columns.len())) {
                                let start = row as usize * view.width as usize + left as usize;
                                let expected = &plain[start..start + pixels.len()];
                                assert!(
                                    bits(pixels) == bits(expected),
                                    "{name}, depth {depth}, {width}x{height} at {left}, {row}"
                                );
                            }
                        }
                    }
                    assert_eq!(counted, counters, "{name}, {width}x{height}");
                }
            }
            assert!(
                counters.refracted > 300 && counters.reflected > 2000,
                "{counters:?}"
            );
        }
    }
}

/// A light so close to a point that its squared distance is zero: what it adds is no number, unless nothing is
/// asked of it. The tracer asks where something shines, though nothing scatters.
#[test]
fn a_light_too_near_for_numbers_counts_as_in_the_plain_slices() {
    let file = scene_file::toml::parse(
        Path::new("near.toml"),
        "ambient = [1, 1, 1]\n\
         [camera]\neye = [0, 0, 1]\ntarget = [0, 0, 0]\nfov = 1\n\
         [[light]]\nposition = [0, 0, 1]\n\
         [material.shiny]\ndiffuse = 0\nspecular = 0.5\n\
         [[plane]]\nmaterial = \"shiny\"\npoint = [0, 0, 0]\nnormal = [0.36, 0.48, 0.8]\n",
    );
    let file = file.unwrap();
    let pool = Pool::new(&file);
    let host = HostScene::new(&file, &pool).unwrap();
    let scene = host.scene();
    let view = host.camera(1, 1).unwrap().unwrap();
    for threshold in [0.0, 0.001] {
        let settings = Settings {
            depth: 1,
            threshold,
        };
        let pictures = [1e-25, 1.0].map(|near| {
            let mut light = scene.lights[0];
            light.position = Vec3::splat(near);
            let lights = &[light];
            let scene = Scene { lights, ..scene };
            let plain = bits(&plainly(&scene, &view, settings).0);
            for (name, level) in levels() {
                let mut pixels = Vec::new();
                let emit = |it: &[Vec3]| {
                    pixels.extend_from_slice(it);
                    Ok::<_, ()>(())
                };
                render_at(level, &scene, &view, 0..1, settings, keep, emit).unwrap();
                assert_eq!(bits(&pixels), plain, "{name}, {threshold}, {near}");
            }
            plain
        });
        // No number is shown as black.
        let is_black = pictures.map(|it| it == [[0; 3]]);
        assert_eq!(is_black, [threshold == 0.0, false]);
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
