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
        root.join("tests/gallery/quadrics.toml"),
        root.join("tests/gallery/tori.toml"),
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

/// Mirrors, glass and dull things of every kind that is in blocks, side by side above a floor, and, where `loose`,
/// between two planes, which are in none; under two lights: what a ray meets here sends others all ways.
fn mirrors(loose: bool) -> SceneFile {
    let mut text = String::from(
        "background = [0.1, 0.2, 0.3]\nambient = [0.1, 0.1, 0.1]\n\
         [camera]\neye = [2, -9, 7]\ntarget = [0, 0, 0]\nup = [0, 0, 1]\nfov = 50\n\
         [[light]]\nposition = [6, -9, 9]\n\
         [[light]]\nposition = [-8, -5, 6]\n\
         [material.floor]\ncolor = [0.9, 0.8, 0.6]\ndiffuse = 0.6\nreflectance = 0.3\nspecular = 0.3\nshininess = 9\n\
         [material.mirror]\ncolor = [0.9, 0.3, 0.2]\ndiffuse = 0.3\nreflectance = 0.7\n\
         [material.glass]\ndiffuse = 0.1\nreflectance = 0.1\ntransmittance = 0.8\nior = 1.4\n\
         [material.dull]\ncolor = [0.2, 0.7, 0.9]\ndiffuse = 0.8\n\
         [[polygon]]\nmaterial = \"floor\"\n\
         vertices = [[-9, -9, -1], [9, -9, -1], [9, 9, -1], [-9, 9, -1]]\n",
    );
    if loose {
        text += "[[plane]]\nmaterial = \"mirror\"\npoint = [0, 8, 0]\nnormal = [0, -1, 0.1]\n\
                 [[plane]]\nmaterial = \"dull\"\npoint = [-7, 0, 0]\nnormal = [1, 0, 0]\n";
    }
    for place in 0..132 {
        let [x, y, z] = [place % 12 - 6, place / 12 - 5, place * 7 % 5].map(f64::from);
        let z = z * 0.3;
        let sides = [
            [0.5, 0.0],
            [0.2, 0.5],
            [-0.4, 0.3],
            [-0.4, -0.3],
            [0.2, -0.5],
        ];
        let sides = sides.map(|[u, v]| format!("[{}, {}, {}]", x + u, y + v, z + u));
        let three = sides[..3].join(", ");
        let frustum = format!(
            "[[frustum]]\nbase = [{x}, {y}, {z}]\napex = [{x}, {y}, {}]\n",
            z + 0.9
        );
        let shape = match place % 11 {
            0 | 5 => format!("[[sphere]]\ncenter = [{x}, {y}, {z}]\nradius = 0.55\n"),
            1 => format!("[[sphere]]\ncenter = [{x}, {y}, {z}]\nradius = -0.6\n"),
            2 => format!("{frustum}base_radius = 0.5\napex_radius = 0.2\n"),
            3 => format!("{frustum}base_radius = -0.5\napex_radius = -0.3\n"),
            4 => format!("[[triangle]]\nvertices = [{three}]\n"),
            6 => format!("[[polygon]]\nvertices = [{}]\n", sides.join(", ")),
            7 => format!(
                "[[patch]]\nvertices = [{three}]\n\
                 normals = [[-0.6, 0.1, 0.8], [-0.5, -0.2, 0.8], [-0.7, 0, 0.6]]\n"
            ),
            8 => format!(
                "[[box]]\nmin = [{x}, {y}, {z}]\nmax = [{}, {}, {}]\n",
                x + 0.4,
                y + 0.5,
                z + 0.7
            ),
            9 => format!(
                "[[torus]]\ncenter = [{x}, {y}, {z}]\naxis = [0.3, 0.1, 1]\nmajor = 0.4\nminor = 0.15\n"
            ),
            _ => format!("[[ellipsoid]]\ncenter = [{x}, {y}, {z}]\nradii = [0.5, 0.4, 0.6]\n"),
        };
        let finish = ["mirror", "glass", "dull"][(place % 7 % 3) as usize];
        text += &format!("{shape}material = \"{finish}\"\n");
    }
    scene_file::toml::parse(Path::new("mirrors.toml"), &text).unwrap()
}

/// Rays that part go on with others of their tile: each still adds to its own pixel, in its own order.
#[test]
fn rays_that_part_have_the_bits_of_the_plain_slices() {
    let files = [mirrors(false), mirrors(true)];
    // With one light, rays are not gathered where they hit.
    for (file, lights) in [(&files[0], 2), (&files[0], 1), (&files[1], 2)] {
        let pool = Pool::new(file);
        let host = HostScene::new(file, &pool).unwrap();
        let scene = host.scene();
        let view = host.camera(70, 50).unwrap().unwrap();
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
                counters.refracted > 200 && counters.reflected > 1000,
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
