//! Baked scenes are what the scene files say: built into a program of their own, against `whitted`
//! alone, they show the bits of the host's pictures.

use std::convert::Infallible;
use std::fmt::Write as _;
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::process::Command;

use whitted::Vec3;
use whitted::embedded_graphics::pixelcolor::{IntoStorage, Rgb565, Rgb888};
use whitted_cli::bake::{Module, bake, bake_map};
use whitted_cli::map::HostMap;
use whitted_cli::render::{Sampling, Settings, keep, render_whole};
use whitted_cli::scene::{HostScene, Pool};
use whitted_cli::scene_file::map::{self, MapFile};
use whitted_cli::scene_file::{self, SceneFile};

const WIDTH: u32 = 40;
const HEIGHT: u32 = 30;

/// A scene, baked, and what its picture is.
struct Baked {
    name: String,
    module: Module,
    checksum: u64,
}

impl Baked {
    fn new(name: &str, file: &SceneFile) -> Self {
        let pool = Pool::new(file);
        let scene = HostScene::new(file, &pool).unwrap();
        let view = scene.camera(WIDTH, HEIGHT).unwrap().unwrap();
        let settings = Settings {
            depth: file.depth,
            threshold: 0.0,
        };
        let mut checksum = FNV_OFFSET;
        let emit = |pixels: &[Vec3]| {
            for channel in pixels.iter().flat_map(|it| it.to_array()) {
                checksum = fnv(checksum, channel);
            }
            Ok::<_, Infallible>(())
        };
        let Ok(_) = render_whole(&scene, &view, 0..HEIGHT, settings, keep, emit);
        Self {
            name: name.to_owned(),
            module: bake(&scene, Some(&view)),
            checksum,
        }
    }

    fn toml(name: &str, text: &str) -> Self {
        Self::new(
            name,
            &scene_file::toml::parse(Path::new(name), text).unwrap(),
        )
    }

    /// Has all of these words in its source, and none of those.
    fn assert_names(&self, these: &[&str], not_those: &[&str]) {
        let code = self
            .module
            .text
            .lines()
            .filter(|it| !it.trim_start().starts_with("//"));
        let code: Vec<_> = code.collect();
        let code = code.join("\n");
        let words: Vec<_> = code.split(|it: char| !it.is_alphanumeric()).collect();
        for word in these {
            assert!(words.contains(word), "{} does not name {word}", self.name);
        }
        for word in not_those {
            assert!(!words.contains(word), "{} names {word}", self.name);
        }
    }
}

const FNV_OFFSET: u64 = 0xcbf2_9ce4_8422_2325;

/// FNV-1a of a number's bits, added to a checksum.
fn fnv(checksum: u64, number: f32) -> u64 {
    let bytes = number.to_bits().to_le_bytes();
    bytes.iter().fold(checksum, |checksum, &byte| {
        (checksum ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

const CAMERA: &str = "[camera]\neye = [2, 1.5, 6]\ntarget = [0, 0.5, 0]\nfov = 40\n";

/// One matte ball, lit without shadows.
fn matte() -> Baked {
    let scene = "[[light]]\nposition = [3, 5, 4]\ncolor = [1, 1, 1]\nshadows = false\n\
                 [material.clay]\ncolor = [0.8, 0.3, 0.2]\n\
                 [[sphere]]\ncenter = [0, 0.5, 0]\nradius = 1\nmaterial = 'clay'\n";
    Baked::toml("matte", &format!("{CAMERA}{scene}"))
}

/// Mirrors with whole exponents; enough balls and boxes for hierarchies, some of them the same twice.
fn crowd() -> Baked {
    let mut scene = format!(
        "depth = 4\nbackground = [0.1, 0.2, 0.3]\nambient = [0.1, 0.1, 0.1]\n{CAMERA}\
         [[light]]\nposition = [3, 5, 4]\ncolor = [0.9, 0.8, 0.7]\n\
         [material.red]\ncolor = [0.9, 0.1, 0.1]\nspecular = 0.5\nshininess = 40\nreflectance = 0.3\n\
         [material.blue]\ncolor = [0.1, 0.1, 0.9]\nspecular = 0.2\nshininess = 7\n\
         [[plane]]\npoint = [0, -0.5, 0]\nnormal = [0, 1, 0]\nmaterial = 'blue'\n"
    );
    for i in 0..40 {
        let (x, z) = (
            (i * 7 % 11) as f32 * 0.3 - 1.5,
            (i * 5 % 13) as f32 * 0.25 - 1.5,
        );
        let material = ["red", "blue"][i % 3 / 2];
        for material in [material, "blue"] {
            let _ = writeln!(
                scene,
                "[[sphere]]\ncenter = [{x}, 0, {z}]\nradius = 0.17\nmaterial = '{material}'"
            );
        }
        let _ = writeln!(
            scene,
            "[[box]]\nmin = [{x}, 0.5, {z}]\nmax = [{}, 0.6, {}]\nmaterial = '{material}'",
            x + 0.2,
            z + 0.15
        );
    }
    Baked::toml("crowd", &scene)
}

/// Light with and without shadows through glass, real exponents, lengths of 2^-40.
fn tiny() -> Baked {
    let scene = "[camera]\neye = [2e-12, 1.5e-12, 6e-12]\ntarget = [0, 0.5e-12, 0]\nfov = 40\n\
                 [[light]]\nposition = [3e-12, 5e-12, 4e-12]\ncolor = [1, 0.9, 0.8]\n\
                 [[light]]\nposition = [-3e-12, 5e-12, 4e-12]\ncolor = [0.2, 0.2, 0.3]\nshadows = false\n\
                 [material.glass]\ncolor = [1, 1, 1]\ndiffuse = 0.1\nspecular = 0.4\nshininess = 33.5\n\
                 transmittance = 0.8\nior = 1.4\n\
                 [material.chalk]\ncolor = [0.7, 0.7, 0.6]\n\
                 [[frustum]]\nbase = [1e-12, -0.5e-12, 0]\nbase_radius = 0.5e-12\n\
                 apex = [1e-12, 0.7e-12, 0]\napex_radius = 0.1e-12\nmaterial = 'chalk'\n\
                 [[sphere]]\ncenter = [0, 0.5e-12, 1e-12]\nradius = 0.6e-12\nmaterial = 'glass'\n\
                 [[polygon]]\nvertices = [[-3e-12, -0.5e-12, 3e-12], [3e-12, -0.5e-12, 3e-12], \
                 [3e-12, -0.5e-12, -3e-12], [-3e-12, -0.5e-12, -3e-12]]\nmaterial = 'chalk'\n";
    Baked::toml("tiny", scene)
}

/// A few balls of glass and chalk, one of them so large that it is the floor, under lights with
/// shadows and without.
fn few() -> Baked {
    let mut scene = format!(
        "depth = 4\nbackground = [0.1, 0.2, 0.3]\n{CAMERA}\
         [[light]]\nposition = [3, 5, 4]\ncolor = [0.9, 0.8, 0.7]\n\
         [[light]]\nposition = [-300, 500, 100]\ncolor = [0.2, 0.2, 0.4]\n\
         [[light]]\nposition = [0, 0.2, 0.2]\ncolor = [0.2, 0.3, 0.2]\nshadows = false\n\
         [material.glass]\ncolor = [1, 1, 1]\ndiffuse = 0.1\ntransmittance = 0.8\nior = 1.4\n\
         [material.chalk]\ncolor = [0.7, 0.7, 0.6]\n\
         [[sphere]]\ncenter = [0, -100, 0]\nradius = 99.5\nmaterial = 'chalk'\n"
    );
    for i in 0..8 {
        let (x, y) = (i as f32 * 0.35 - 1.4, (i * 5 % 7) as f32 * 0.2);
        let (z, material) = ((i * 3 % 8) as f32 * 0.2 - 0.8, ["chalk", "glass"][i % 2]);
        let _ = writeln!(
            scene,
            "[[sphere]]\ncenter = [{x}, {y}, {z}]\nradius = 0.25\nmaterial = '{material}'"
        );
    }
    Baked::toml("few", &scene)
}

/// Groups, one of them with a hierarchy, placed in each other and in the world; solids in both.
fn workshop() -> Baked {
    let mut scene = format!(
        "depth = 4\nbackground = [0.1, 0.2, 0.3]\n{CAMERA}\
         [[light]]\nposition = [3, 5, 4]\ncolor = [0.9, 0.8, 0.7]\n\
         [material.red]\ncolor = [0.9, 0.1, 0.1]\nreflectance = 0.3\n\
         [material.glass]\ndiffuse = 0.1\ntransmittance = 0.8\nior = 1.4\n\
         [[plane]]\npoint = [0, -0.5, 0]\nnormal = [0, 1, 0]\nmaterial = 'red'\n\
         [[csg]]\nexpression = 'a & b - (c + d)'\n\
         solid.a.box = {{ material = 'red', min = [-2, -0.5, -1], max = [-1, 0.5, 0] }}\n\
         solid.b.sphere = {{ material = 'red', center = [-1.5, 0, -0.5], radius = 0.6 }}\n\
         solid.c.cylinder = {{ material = 'glass', base = [-1.5, 0, -2], apex = [-1.5, 0, 2], \
         radius = 0.25, closed = true }}\n\
         solid.d.plane = {{ material = 'red', point = [0, 0.3, 0], normal = [0, -1, 0] }}\n\
         [[group.cup.csg]]\nexpression = 'ball - hollow'\n\
         solid.ball.sphere = {{ material = 'glass', center = [0, 0, 0], radius = 0.5 }}\n\
         solid.hollow.torus = {{ material = 'glass', center = [0, 0.5, 0], axis = [0, 1, 0], \
         major = 0.3, minor = 0.2 }}\n\
         [[group.row.instance]]\nof = 'cup'\ntranslate = [0.5, 0.7, 0]\nscale = 0.5\n\
         [[group.row.box]]\nmaterial = 'red'\nmin = [0, 0, 0]\nmax = [1, 0.1, 0.2]\n\
         [[instance]]\nof = 'row'\nrotate = [10, 20, 30]\ntranslate = [0, 0.5, 0.5]\n\
         [[instance]]\nof = 'row'\nscale = [-1, 2, 1]\ntranslate = [1.5, -0.4, 0]\n"
    );
    for i in 0..20 {
        let (x, z) = (i as f32 * 0.06, (i * 7 % 5) as f32 * 0.1);
        let _ = writeln!(
            scene,
            "[[group.row.sphere]]\ncenter = [{x}, 0.2, {z}]\nradius = 0.08\nmaterial = 'red'"
        );
    }
    Baked::toml("workshop", &scene)
}

/// Soft lights of both kinds, a point and a light without shadows, through glass.
fn soft() -> Baked {
    let scene = "[[light]]\nposition = [3, 5, 4]\nedges = [[1, 0, 0], [0, 0.5, -1]]\nsamples = 4\n\
                 [[light]]\nposition = [-3, 5, 4]\nradius = 0.5\nsamples = 8\nadaptive = 2\n\
                 [[light]]\nposition = [-3, 1, 4]\ncolor = [0.2, 0.2, 0.3]\n\
                 [[light]]\nposition = [0, 1, 4]\ncolor = [0.1, 0.1, 0.1]\nshadows = false\n\
                 [material.clay]\ncolor = [0.8, 0.3, 0.2]\n\
                 [material.glass]\ntransmittance = 0.5\n\
                 [[plane]]\npoint = [0, -0.5, 0]\nnormal = [0, 1, 0]\nmaterial = 'clay'\n\
                 [[sphere]]\ncenter = [0, 0.5, 0]\nradius = 0.7\nmaterial = 'clay'\n\
                 [[sphere]]\ncenter = [1, 0.5, 0]\nradius = 0.5\nmaterial = 'glass'\n";
    Baked::toml("soft", &format!("{CAMERA}{scene}"))
}

/// One panel, and nothing else that shines.
fn panel() -> Baked {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/gallery/panel.toml");
    Baked::new("panel", &scene_file::read(&path).unwrap())
}

fn nothing() -> Baked {
    Baked::toml(
        "nothing",
        &format!("background = [0.5, 0.25, 0.125]\n{CAMERA}"),
    )
}

fn castle_path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/castle.map")
}

/// A map some of whose walls have more colors than a palette, and holes.
fn hall() -> MapFile {
    let folder = tempfile::tempdir().unwrap();
    let mut shades = "P3\n20 15\n255\n".to_owned();
    for i in 0..300 {
        let _ = writeln!(shades, "{} {} {}", i % 256, (i * 7) % 256, i / 2);
    }
    fs::write(folder.path().join("shades.ppm"), shades).unwrap();
    let text = "ambient = [0.5, 0.5, 0.5]\nplan = '''\n#####\n#.D.%\n#####\n'''\nfloor = 'stone'\n\
        player = { position = [1.1, 1.4], direction = [1, 0.1], fov = 70 }\n\
        [[light]]\nposition = [1.5, 0.9, 1.5]\n\
        [material.stone]\ncolor = [0.5, 0.25, 1]\n\
        [texture.shades]\nfile = 'shades.ppm'\n\
        [texture.net]\nrows = ['a.', '.a']\ncolors = { a = [1, 0, 0] }\n\
        [wall.'#']\nmaterial = 'stone'\ntexture = 'shades'\nsouth = 'net'\n\
        [wall.'%']\nmaterial = 'stone'\n\
        [door.D]\nmaterial = 'stone'\ntexture = 'shades'\nopen = 0.5\n\
        [[sprite]]\ntexture = 'net'\nposition = [1.7, 1.3]\nwidth = 0.2\nheight = 0.5\n";
    map::parse(&folder.path().join("hall.map"), text).unwrap()
}

/// A map whose walls show the same on all sides, to rays too.
fn alike() -> MapFile {
    let text = "ambient = [1, 1, 1]\nplan = '''\n####\n#..#\n####\n'''\nfloor = 'stone'\n\
        player = { position = [1.1, 1.4], direction = [1, 0.1], fov = 70 }\n\
        [material.stone]\ncolor = [0.5, 0.25, 1]\n\
        [texture.t]\nrows = ['ab', 'ba']\ncolors = { a = [1, 0, 0], b = [1, 1, 0] }\n\
        [wall.'#']\nmaterial = 'stone'\ntexture = 't'\nshade = 1\n";
    map::parse(Path::new("alike.map"), text).unwrap()
}

/// A map of as many kinds of walls as there can be, whose last one is seen.
fn kinds() -> MapFile {
    let sign = |it: u32| char::from_u32(0x100 + it).unwrap();
    let (first, last) = (sign(0), sign(254));
    let mut text = format!(
        "ambient = [1, 1, 1]\nplan = '''\n{first}{first}{first}\n{first}.{last}\n{first}{first}{first}\n\
         '''\nfloor = 'stone'\n\
         player = {{ position = [1.1, 1.4], direction = [1, 0.1], fov = 70 }}\n\
         [material.stone]\ncolor = [0.5, 0.25, 1]\n[material.last]\ncolor = [0.25, 1, 0]\n"
    );
    for it in 0..255 {
        let material = if it == 254 { "last" } else { "stone" };
        let _ = writeln!(text, "[wall.'{}']\nmaterial = '{material}'", sign(it));
    }
    map::parse(Path::new("kinds.map"), &text).unwrap()
}

fn castle() -> MapFile {
    map::read(&castle_path()).unwrap()
}

/// A map, traced.
fn traced(name: &str, file: &MapFile) -> Baked {
    let host = HostMap::new(file);
    let view = host.view(WIDTH, HEIGHT).unwrap();
    let settings = Settings {
        depth: file.depth,
        threshold: 0.0,
    };
    let mut checksum = FNV_OFFSET;
    let emit = |pixels: &[Vec3]| {
        for channel in pixels.iter().flat_map(|it| it.to_array()) {
            checksum = fnv(checksum, channel);
        }
        Ok::<_, Infallible>(())
    };
    let Ok(_) = host.trace(&view, 0..HEIGHT, settings, Sampling::Middle, keep, emit);
    Baked {
        name: name.to_owned(),
        module: bake_map(&host, &view),
        checksum,
    }
}

/// The same map by columns: the pixels of a display, row by row.
fn by_columns(file: &MapFile) -> u64 {
    let host = HostMap::new(file);
    let view = host.view(WIDTH, HEIGHT).unwrap();
    let mut checksum = FNV_OFFSET;
    let emit = |pixels: &[Vec3]| {
        for pixel in pixels {
            let [red, green, blue] = whitted::picture::to_rgb8(*pixel);
            let color = Rgb565::from(Rgb888::new(red, green, blue));
            checksum = fnv(checksum, color.into_storage().into());
        }
        Ok::<_, Infallible>(())
    };
    let Ok(()) = host.draw(&view, 0..HEIGHT, 1, keep, emit);
    checksum
}

fn builtin() -> Baked {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/builtin.toml");
    Baked::new("builtin", &scene_file::read(&path).unwrap())
}

/// The standard scenes that the firmware draws, where they are.
fn standard() -> Vec<Baked> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/scenes/spd");
    if !directory.exists() {
        // Not printed: the harness keeps what passing tests print.
        let _ = writeln!(
            io::stderr(),
            "NOT RUN: the standard scenes, for {} is not there",
            directory.display()
        );
        return Vec::new();
    }
    [
        "balls-2", "mount-2", "gears-1", "rings-1", "teapot-2", "tetra-3", "tree-4",
    ]
    .map(|name| {
        let path = directory.join(format!("{name}.nff"));
        Baked::new(&name.replace('-', "_"), &scene_file::read(&path).unwrap())
    })
    .into()
}

#[test]
fn types_name_what_the_scene_uses() {
    let secondary = ["Mirror", "Glass"];
    matte().assert_names(
        &["Sphere", "FillLight"],
        &[
            &secondary[..],
            &["Phong", "PhongReal", "Plane", "Hierarchy", "Light", "Lamp"],
        ]
        .concat(),
    );
    crowd().assert_names(
        &[
            "Sphere",
            "Plane",
            "Cuboid",
            "Hierarchy",
            "Phong",
            "Mirror",
            "Light",
        ],
        &["PhongReal", "Glass", "FillLight", "Polygon"],
    );
    tiny().assert_names(
        &["PhongReal", "Glass", "Lamp", "Frustum"],
        &["Mirror", "Phong", "Hierarchy", "Triangle"],
    );
    few().assert_names(
        &["Culled", "LightBuffer", "Lamp", "i16", "512", "Glass"],
        &["Hierarchy", "FillLight", "Mirror"],
    );
    workshop().assert_names(
        &[
            "Csg",
            "Difference",
            "Instance",
            "Placement",
            "Torus",
            "Quadric",
        ],
        &["Culled", "PhongReal"],
    );
    few().assert_names(&[], &["Csg", "Instance", "Placement"]);
    soft().assert_names(
        &[
            "AreaLight",
            "Outline",
            "Rect",
            "Disk",
            "Samples",
            "Lamp",
            "Quantity",
        ],
        &["Light", "LightBuffer", "FillLight", "Candidates"],
    );
    panel().assert_names(
        &["AreaLight", "Rect", "Samples"],
        &["Outline", "Disk", "Lamp", "Light", "FillLight", "Quantity"],
    );
    for (baked, depth) in [(matte(), 1), (crowd(), 4), (tiny(), 5)] {
        let line = format!("pub const DEPTH: usize = {depth};");
        assert!(baked.module.text.contains(&line), "{}", baked.name);
    }
    let scale = "pub const SCALE_EXPONENT: i32 = -38;";
    assert!(tiny().module.text.contains(scale), "{}", tiny().module.text);
}

#[test]
fn baking_twice_gives_the_same() {
    assert_eq!(crowd().module, crowd().module);
}

#[test]
fn what_each_array_takes_is_said() {
    let crowd = crowd().module;
    let bytes = |name: &str| crowd.bytes.iter().find(|it| it.0 == name).unwrap().1;
    assert_eq!(bytes("SPHERES"), 80 * (16 + 4));
    assert_eq!(bytes("CUBOIDS"), 40 * (24 + 4));
    assert_eq!(bytes("PLANES"), 24 + 4);
    assert_eq!(bytes("SPHERE_PLACES"), 80);
    assert_eq!(bytes("LIGHTS"), 24);
    assert_eq!(bytes("MATERIALS"), 2 * (12 + 8 + 8 + 4));
    let few = few().module;
    let lights = few.bytes.iter().find(|it| it.0 == "LIGHTS").unwrap().1;
    // A light, a window, a reach, cells of two bytes, and whether it casts shadows.
    assert_eq!(lights, 3 * (24 + 24 + 4 + 512 * 2 + 4));
    let all: usize = crowd.bytes.iter().map(|it| it.1).sum();
    assert_eq!(crowd.flash(), all);
    for (name, bytes) in &crowd.bytes {
        let line = format!("//   {name:16} {bytes:8}\n");
        assert!(crowd.text.contains(&line), "{name}");
    }
}

/// Where the program is built: kept from one run to the next, so that only what changed is.
fn place() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("baked")
}

fn cargo() -> Command {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
    cargo
        .current_dir(place())
        .env("CARGO_TARGET_DIR", place().join("target"));
    // Set by the cargo that runs this test, for its own package.
    for (name, _) in std::env::vars_os() {
        if name.to_string_lossy().starts_with("CARGO_PKG_") {
            cargo.env_remove(name);
        }
    }
    cargo
}

#[test]
fn baked_scenes_show_the_bits_of_their_files() {
    let mut scenes = vec![
        matte(),
        crowd(),
        tiny(),
        few(),
        workshop(),
        soft(),
        panel(),
        nothing(),
        builtin(),
    ];
    let maps = [
        ("castle", castle()),
        ("hall", hall()),
        ("alike", alike()),
        ("kinds", kinds()),
    ];
    scenes.extend(maps.iter().map(|(name, file)| traced(name, file)));
    scenes.extend(standard());
    let source = place().join("src");
    fs::create_dir_all(&source).unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let core = root.join("core");
    fs::write(
        place().join("Cargo.toml"),
        format!(
            "[package]\nname = \"baked\"\nversion = \"0.0.0\"\nedition = \"2024\"\n\n[workspace]\n\n\
             [dependencies]\nwhitted = {{ path = {core:?} }}\n\n[profile.dev]\nopt-level = 1\n"
        ),
    )
    .unwrap();
    // The versions that are here already: nothing has to be fetched.
    fs::copy(root.join("Cargo.lock"), place().join("Cargo.lock")).unwrap();
    let mut main = MAIN.to_owned();
    for Baked { name, module, .. } in &scenes {
        fs::write(source.join(format!("{name}.rs")), &module.text).unwrap();
        let _ = writeln!(main, "mod {name};");
    }
    main.push_str("\nfn main() {\n");
    for Baked { name, .. } in &scenes {
        let _ = writeln!(main, "    show!({name});");
    }
    for (name, _) in &maps {
        let _ = writeln!(main, "    columns!({name});");
    }
    main.push_str("}\n");
    fs::write(source.join("main.rs"), main).unwrap();

    let output = cargo()
        .args(["run", "--quiet", "--offline"])
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    assert_eq!(errors, "", "no warnings either");
    let mut expected: String = scenes
        .iter()
        .map(|it| format!("{} {:016x}\n", it.name, it.checksum))
        .collect();
    for (name, file) in &maps {
        let _ = writeln!(expected, "{name} by columns {:016x}", by_columns(file));
    }
    assert_eq!(String::from_utf8_lossy(&output.stdout), expected);
    assert_formatted(&source, &scenes);
}

const MAIN: &str = "\
fn fnv(checksum: u64, number: f32) -> u64 {
    let bytes = number.to_bits().to_le_bytes();
    bytes.iter().fold(checksum, |checksum, &byte| {
        (checksum ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

macro_rules! show {
    ($scene:ident) => {{
        let _ = $scene::SCALE_EXPONENT;
        let mut tracer = whitted::Tracer::<{ $scene::DEPTH }>::new();
        let mut checksum = 0xcbf2_9ce4_8422_2325;
        for row in 0..$scene::VIEW.height {
            for color in whitted::picture::row(&$scene::SCENE, &$scene::VIEW, row, &mut tracer) {
                checksum = color.to_array().into_iter().fold(checksum, fnv);
            }
        }
        println!(\"{} {checksum:016x}\", stringify!($scene));
    }};
}

macro_rules! columns {
    ($map:ident) => {{
        use whitted::embedded_graphics::pixelcolor::IntoStorage;

        let picture = $map::COLUMNS.picture(&$map::VIEW);
        let mut checksum = 0xcbf2_9ce4_8422_2325;
        for row in 0..$map::VIEW.height {
            for column in 0..$map::VIEW.width {
                if let Some(color) = picture.pixels(column).nth(row as usize) {
                    checksum = fnv(checksum, color.into_storage().into());
                }
            }
        }
        println!(\"{} by columns {checksum:016x}\", stringify!($map));
    }};
}

";

/// The modules are as rustfmt would have them.
fn assert_formatted(source: &Path, scenes: &[Baked]) {
    if Command::new("rustfmt").arg("--version").output().is_err() {
        println!("skipped: the modules' format, for there is no rustfmt");
        return;
    }
    for Baked { name, .. } in scenes {
        let file = source.join(format!("{name}.rs"));
        let check = Command::new("rustfmt")
            .args(["--edition", "2024", "--check", "--config-path", "/dev/null"])
            .arg(file)
            .output()
            .unwrap();
        assert!(
            check.status.success(),
            "{}",
            String::from_utf8_lossy(&check.stdout)
        );
    }
}

#[test]
fn the_limit_of_flash_is_kept() {
    let directory = tempfile::tempdir().unwrap();
    let (scene, output) = (
        directory.path().join("s.nff"),
        directory.path().join("s.rs"),
    );
    fs::write(
        &scene,
        "v from 0 0 4 at 0 0 0 up 0 1 0 angle 30 hither 1 resolution 8 8\nf 1 1 1 1 0 0 0 1\ns 0 0 0 1\n",
    )
    .unwrap();
    fs::write(&output, "// kept\n").unwrap();
    let bake = |limit: &str| {
        Command::new(env!("CARGO_BIN_EXE_whitted"))
            .arg("bake")
            .arg(&scene)
            .arg("-o")
            .arg(&output)
            .args(["--max-flash", limit, "--size", "8x6"])
            .output()
            .unwrap()
    };
    let refused = bake("50");
    assert_eq!(refused.status.code(), Some(2));
    let message = String::from_utf8(refused.stderr).unwrap();
    let ending = "bytes of flash, --max-flash allows 50\n";
    assert!(
        message.starts_with("error: ") && message.ends_with(ending),
        "{message}"
    );
    assert_eq!(fs::read_to_string(&output).unwrap(), "// kept\n");
    let done = bake("5000");
    assert!(
        done.status.success(),
        "{}",
        String::from_utf8_lossy(&done.stderr)
    );
    let text = fs::read_to_string(&output).unwrap();
    assert!(
        text.contains("width: 8") && text.contains("height: 6"),
        "{text}"
    );
}
