//! Pictures that one can read, and checksums of those that one cannot.

use std::path::Path;

use whitted::picture::{row, to_rgb8};
use whitted::*;
use whitted_cli::scene_file::read;
use whitted_tests::comparison::render;

const RED: Vec3 = Vec3::new(0.9, 0.1, 0.1);
const BLUE: Vec3 = Vec3::new(0.1, 0.1, 0.9);
const WHITE: Vec3 = Vec3::new(0.9, 0.9, 0.9);
const SKY: Vec3 = Vec3::new(0.4, 0.6, 0.8);

/// The palette in which pictures are drawn.
const LETTERS: [(char, Vec3); 6] = [
    ('.', SKY),
    ('r', RED),
    ('b', BLUE),
    ('w', WHITE),
    ('#', Vec3::ZERO),
    ('+', Vec3::splat(0.45)),
];

/// A picture 24 pixels wide and 12 high: for each pixel, the letter of the colour that is nearest.
/// Characters are twice as high as wide, and so are these pixels.
fn drawn<G, L>(scene: &Scene<G, L>) -> Vec<String>
where
    G: Geometry<Material: Finish>,
    L: LightSource,
{
    let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 0.5, 1.0);
    let camera = camera.unwrap();
    let (width, height) = (24, 12);
    let view = View {
        camera,
        width,
        height,
    };
    let letter = |pixel: Vec3| {
        let far = |(_, color): &(char, Vec3)| pixel.distance_squared(*color);
        let nearest = LETTERS.into_iter().min_by(|a, b| far(a).total_cmp(&far(b)));
        nearest.map_or('?', |(letter, _)| letter)
    };
    let mut tracer = Tracer::<5>::new();
    let line = |y| row(scene, &view, y, &mut tracer).map(letter).collect();
    (0..height).map(line).collect()
}

fn assert_drawn<G, L>(scene: &Scene<G, L>, expected: [&str; 12])
where
    G: Geometry<Material: Finish>,
    L: LightSource,
{
    let drawn = drawn(scene);
    assert!(drawn == expected, "drawn:\n{}", drawn.join("\n"));
}

fn unlit(color: Vec3) -> Material {
    Material::matte(color, 1.0, 0.0)
}

fn ball<M>(x: f32, y: f32, z: f32, radius: f32, material: &M) -> Object<'_, Sphere, M> {
    let center = Vec3::new(x, y, z);
    Object {
        shape: Sphere { center, radius },
        material,
    }
}

/// Lit by nothing but ambient light.
fn flat<G>(geometry: G) -> Scene<'static, G> {
    Scene {
        geometry,
        lights: &[],
        background: SKY,
        ambient: Vec3::ONE,
    }
}

#[test]
fn the_nearer_of_two_balls_hides_the_other() {
    let (red, blue) = (unlit(RED), unlit(BLUE));
    let balls = [
        ball(0.5, 0.3, -5.0, 1.2, &blue),
        ball(-0.5, -0.2, -4.0, 1.0, &red),
    ];
    assert_drawn(
        &flat(balls.as_slice()),
        [
            "........................",
            "........................",
            "............bbbbb.......",
            "..........bbbbbbbbb.....",
            "....rrrrrrrrrbbbbbbb....",
            "...rrrrrrrrrrrrbbbbb....",
            "...rrrrrrrrrrrrbbbbb....",
            "...rrrrrrrrrrrrbbb......",
            "....rrrrrrrrrr..........",
            "......rrrrr.............",
            "........................",
            "........................",
        ],
    );
}

#[test]
fn outlines_may_be_concave() {
    let (red, blue) = (unlit(RED), unlit(BLUE));
    let at = |points: [(f32, f32); 6]| points.map(|(x, y)| Vec3::new(x, y, -4.0));
    let corner = at([
        (-1.8, -1.6),
        (0.4, -1.6),
        (0.4, -0.8),
        (-1.0, -0.8),
        (-1.0, 1.6),
        (-1.8, 1.6),
    ]);
    let arrow = at([
        (-0.3, -0.9),
        (1.0, 0.5),
        (1.4, -1.3),
        (1.7, 1.6),
        (0.9, 1.2),
        (0.0, 1.4),
    ]);
    let shapes = [&corner, &arrow].map(|outline| Polygon::new(outline).unwrap());
    let polygons = [
        Object {
            shape: shapes[0],
            material: &red,
        },
        Object {
            shape: shapes[1],
            material: &blue,
        },
    ];
    assert_drawn(
        &flat(polygons.as_slice()),
        [
            "........................",
            ".rrrrr...............b..",
            ".rrrrr......bbbbbbbbbb..",
            ".rrrrr......bbbbbbbbbb..",
            ".rrrrr.....bbbbbbbbbbb..",
            ".rrrrr.....bbbbb..bbb...",
            ".rrrrr.....bbb.....bb...",
            ".rrrrr.....b.......bb...",
            ".rrrrrrrrrrrrr......b...",
            ".rrrrrrrrrrrrr..........",
            ".rrrrrrrrrrrrr..........",
            "........................",
        ],
    );
}

#[test]
fn a_box_stands_on_a_floor_beside_a_cone() {
    let (red, blue, grey) = (unlit(RED), unlit(BLUE), unlit(Vec3::splat(0.45)));
    let floor = Plane::new(Vec3::NEG_Y, Vec3::Y).unwrap();
    let die = Cuboid::new(Vec3::new(-1.8, -1.0, -5.0), Vec3::new(-0.4, 0.5, -4.0)).unwrap();
    let foot = Vec3::new(1.0, -1.0, -5.0);
    let cone = Frustum::new(foot, 0.9, foot + Vec3::Y * 2.4, 0.0).unwrap();
    let floor = [Object {
        shape: floor,
        material: &grey,
    }];
    let die = [Object {
        shape: die,
        material: &red,
    }];
    let cone = [Object {
        shape: cone,
        material: &blue,
    }];
    let all = (floor.as_slice(), (die.as_slice(), cone.as_slice()));
    assert_drawn(
        &flat(all),
        [
            "........................",
            "........................",
            "........................",
            "................b.......",
            ".rrrrrrrrr.....bbb......",
            ".rrrrrrrrr.....bbbb.....",
            "+rrrrrrrrr++++bbbbbb++++",
            "+rrrrrrrrr+++bbbbbbbb+++",
            "+rrrrrrrrr+++bbbbbbbb+++",
            "++++++++++++++++++++++++",
            "++++++++++++++++++++++++",
            "++++++++++++++++++++++++",
        ],
    );
}

#[test]
fn a_ball_throws_a_shadow_and_has_a_dark_side() {
    let chalk = Material::matte(Vec3::ONE, 0.0, 0.95);
    let floor = Plane::new(Vec3::NEG_Y, Vec3::Y).unwrap();
    let floor = [Object {
        shape: floor,
        material: &chalk,
    }];
    let balls = [ball(-0.3, 0.2, -4.0, 0.7, &chalk)];
    let scene = Scene {
        geometry: (floor.as_slice(), balls.as_slice()),
        lights: &[Light {
            position: Vec3::new(-4.0, 9.0, -4.0),
            color: Vec3::ONE,
        }],
        background: SKY,
        ambient: Vec3::ZERO,
    };
    assert_drawn(
        &scene,
        [
            "........................",
            "........................",
            "........................",
            "........w.++............",
            "......++++####..........",
            "......########..........",
            "+++++++#######++++++++++",
            "wwwwwwwwww#wwwwwwwwwwwww",
            "wwwwwwwwwwwwwwwwwwwwwwww",
            "wwwwwwwww#########wwwwww",
            "wwwwwwwwwwwwwwwwwwwwwwww",
            "wwwwwwwwwwwwwwwwwwwwwwww",
        ],
    );
    // A light without shadows leaves the floor as it is.
    let scene = Scene {
        geometry: scene.geometry,
        lights: &[FillLight {
            position: Vec3::new(-4.0, 9.0, -4.0),
            color: Vec3::ONE,
        }],
        background: SKY,
        ambient: Vec3::ZERO,
    };
    assert_drawn(
        &scene,
        [
            "........................",
            "........................",
            "........................",
            "........w.++............",
            "......++++####..........",
            "......########..........",
            "+++++++#######++++++++++",
            "wwwwwwwwww#wwwwwwwwwwwww",
            "wwwwwwwwwwwwwwwwwwwwwwww",
            "wwwwwwwwwwwwwwwwwwwwwwww",
            "wwwwwwwwwwwwwwwwwwwwwwww",
            "wwwwwwwwwwwwwwwwwwwwwwww",
        ],
    );
}

#[test]
fn a_mirror_shows_what_is_behind_the_viewer() {
    let term = |color, ambient, reflectance| Material {
        color,
        ambient,
        diffuse: 0.0,
        highlight: (),
        reflection: Mirror { reflectance },
        transmission: (),
    };
    let (red, blue, silver) = (
        term(RED, 1.0, 0.0),
        term(BLUE, 1.0, 0.0),
        term(WHITE, 0.0, 0.6),
    );
    let behind = [
        ball(2.0, -0.2, 5.0, 2.0, &red),
        ball(-1.5, 1.0, 6.0, 1.5, &blue),
    ];
    let wall = [(-1.7, -1.3), (1.6, -1.1), (1.7, 1.3), (-1.6, 1.1)];
    let wall = wall.map(|(x, y)| Vec3::new(x, y, -4.0));
    let wall = [Object {
        shape: Polygon::new(&wall).unwrap(),
        material: &silver,
    }];
    assert_drawn(
        &flat((behind.as_slice(), wall.as_slice())),
        [
            "........................",
            "........................",
            ".........+++++++++++++..",
            "..++++++++++++++++++++..",
            "..+++++bbbbb++rrr+++++..",
            "..+++++bbbbbrrrrrrr+++..",
            "..++++++++++rrrrrrrr++..",
            "..+++++++++++rrrrr++++..",
            "..++++++++++++++++++++..",
            "..+++++++++++++.........",
            "........................",
            "........................",
        ],
    );
}

#[test]
fn a_glass_ball_turns_what_is_behind_it_upside_down() {
    let term = |color, ambient, transmittance| Material {
        color,
        ambient,
        diffuse: 0.0,
        highlight: (),
        reflection: (),
        transmission: Glass {
            transmittance,
            ior: 1.5,
        },
    };
    let (red, blue, glass) = (
        term(RED, 1.0, 0.0),
        term(BLUE, 1.0, 0.0),
        term(WHITE, 0.0, 1.0),
    );
    let wall = |low, high| Cuboid {
        min: Vec3::new(-9.0, low, -9.0),
        max: Vec3::new(9.0, high, -8.0),
    };
    let walls = [
        Object {
            shape: wall(0.0, 9.0),
            material: &red,
        },
        Object {
            shape: wall(-9.0, 0.0),
            material: &blue,
        },
    ];
    let lens = [ball(0.0, 0.0, -4.0, 1.4, &glass)];
    assert_drawn(
        &flat((lens.as_slice(), walls.as_slice())),
        [
            "rrrrrrrrrrrrrrrrrrrrrrrr",
            "rrrrrrrrrrrrrrrrrrrrrrrr",
            "rrrrrrbbbbbbbbbbbbrrrrrr",
            "rrrrrbbbbbbbbbbbbbbrrrrr",
            "rrrrbbbbbbbrrbbbbbbbrrrr",
            "rrrbbbbbbrrrrrrbbbbbbrrr",
            "bbbrrrrrrbbbbbbrrrrrrbbb",
            "bbbbrrrrrrrbbrrrrrrrbbbb",
            "bbbbbrrrrrrrrrrrrrrbbbbb",
            "bbbbbbrrrrrrrrrrrrbbbbbb",
            "bbbbbbbbbbbbbbbbbbbbbbbb",
            "bbbbbbbbbbbbbbbbbbbbbbbb",
        ],
    );
}

/// Scenes of this repository, and checksums of their pictures: of the bits of linear `f32` channels,
/// and of 8-bit channels. The same on every host, in debug and in release.
const CHECKSUMS: [(&str, u64, u64); 2] = [
    (
        "../host-cli/scenes/builtin.toml",
        0x0e62_75d6_9794_65ae,
        0xf622_5f29_115e_dea9,
    ),
    (
        "golden/spheres.toml",
        0xc0f2_e47d_7def_dda0,
        0x7265_0afb_6867_0307,
    ),
];

/// FNV-1a, so that no hasher's choice of words matters: G. Fowler, L. C. Noll, K.-P. Vo.
fn checksum(bytes: impl IntoIterator<Item = u8>) -> u64 {
    let step = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    bytes.into_iter().fold(0xcbf2_9ce4_8422_2325, step)
}

#[test]
fn whole_frames_keep_their_checksums() {
    let mut found = Vec::new();
    for (name, ..) in CHECKSUMS {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
        let pixels = render(&read(&path).unwrap(), 96, 72);
        let bits = pixels.iter().flat_map(|pixel| pixel.to_array());
        let bits = checksum(bits.flat_map(|channel| channel.to_bits().to_le_bytes()));
        let bytes = checksum(pixels.iter().flat_map(|&pixel| to_rgb8(pixel)));
        found.push((name, bits, bytes));
    }
    assert!(found == CHECKSUMS, "these are: {found:#018x?}");
}
