//! Maps as Rust modules.

use std::collections::HashMap;
use std::fmt::Write;
use std::mem::size_of;

use embedded_graphics::pixelcolor::{Rgb565, Rgb888, RgbColor};
use whitted::{Object, Vec3, View};

use super::source::{VECTOR, WORD, number, vector};
use super::{Baker, Module, VECTOR_HELPER, view_source};
use crate::map::HostMap;
use crate::scene::Material;
use crate::scene_file::map::Sprite;
use crate::scene_file::texture::Bitmap;

/// Writes a map as Rust source, both to be drawn by columns and to be traced, with the camera and the
/// size of a view. Colors of columns are 16 bits, 5-6-5.
pub fn bake_map(map: &HostMap<'_>, view: &View) -> Module {
    let file = map.file();
    let scene = map.scene();
    let maze = &scene.geometry;
    let mut baker = Baker::default();
    let all: Vec<&Material> = maze
        .walls
        .iter()
        .chain([maze.floor])
        .chain(maze.ceiling)
        .collect();
    for &material in &all {
        let shape = ();
        baker.terms.note(&[Object { shape, material }]);
    }

    let cells: Vec<u32> = file.plan.iter().map(|&it| it.into()).collect();
    baker.numbers("CELLS", ("u8", 1), &cells);
    let bitmaps = used_bitmaps(map);
    textures(&mut baker, &bitmaps);
    let texture = |place: usize| {
        let place = bitmaps.iter().position(|&(it, _)| it == place);
        format!("&TEXTURES[{}]", place.unwrap_or_default())
    };
    let walls: Vec<_> = file
        .walls
        .iter()
        .map(|it| format!("[{}]", it.faces.map(texture).join(", ")))
        .collect();
    let kind = "[&Texture<'static, Rgb565>; 4]";
    baker.array("WALLS", kind, walls.len(), walls.len() * 4 * WORD, &walls);
    let sprite = |it: &Sprite| {
        let [x, y, z] = it.position.map(|it| it as f32);
        format!(
            "Sprite {{ position: {}, width: {}, height: {}, texture: {} }}",
            vector(Vec3::new(x, y, z)),
            number(it.width as f32),
            number(it.height as f32),
            texture(it.texture)
        )
    };
    let sprites: Vec<_> = file.sprites.iter().map(sprite).collect();
    let bytes = sprites.len() * (VECTOR + 2 * size_of::<f32>() + WORD);
    let kind = "Sprite<'static, Rgb565>";
    baker.array("SPRITES", kind, sprites.len(), bytes, &sprites);

    let sources: Vec<_> = (all.iter())
        .map(|it| baker.terms.source(it, None))
        .collect();
    let bytes = sources.len() * baker.terms.bytes();
    baker.array("MATERIALS", "SceneMaterial", sources.len(), bytes, &sources);
    baker.lights(scene.lights);
    baker.import(&[
        "Camera", "Grid", "Material", "Maze", "Scene", "Vec3", "View",
    ]);
    baker.imports.extend(baker.terms.imports());

    let depth = if baker.terms.reflects || baker.terms.transmits {
        file.depth
    } else {
        1
    };
    let mut text = baker.header(&file.path, depth);
    let walls = file.walls.len();
    let ceiling = match maze.ceiling {
        Some(_) => format!("Some(&MATERIALS[{}])", walls + 1),
        None => "None".to_owned(),
    };
    let (names, view) = (&baker.imports, view_source(view));
    let uses: String = names
        .iter()
        .map(|it| format!("use whitted::{it};\n"))
        .collect();
    let [width, cells_deep] = file.cells;
    let [floor, above] = map.plain_colors().map(color);
    let (background, ambient) = (vector(scene.background), vector(scene.ambient));
    let (light, material) = (baker.light, baker.terms.material());
    let sprites = file.sprites.len();
    let _ = write!(
        text,
        "
{uses}use whitted::columns::{{Columns, Sprite, Texture}};
use whitted::embedded_graphics::pixelcolor::Rgb565;

/// The map, to be drawn by columns.
pub static COLUMNS: Columns<'static, Rgb565, {sprites}> = Columns {{
    grid: GRID,
    walls: &WALLS,
    sprites: &SPRITES,
    floor: {floor},
    ceiling: {above},
}};

/// The map, to be traced.
#[rustfmt::skip]
pub static SCENE: Scene<'static, SceneGeometry, {light}> = Scene {{
    geometry: Maze {{
        grid: GRID,
        walls: MATERIALS.split_at({walls}).0,
        floor: &MATERIALS[{walls}],
        ceiling: {ceiling},
    }},
    lights: &LIGHTS,
    background: {background},
    ambient: {ambient},
}};
{view}
/// Longest chain of rays, the eye ray counted as 1.
pub const DEPTH: usize = {depth};

/// Lengths here, times 2 to this power, are those of the map's file.
pub const SCALE_EXPONENT: i32 = 0;

/// What all surfaces are made of.
pub type SceneMaterial = {material};

/// All surfaces.
pub type SceneGeometry = Maze<'static, SceneMaterial>;

const GRID: Grid<'static> = Grid {{
    width: {width},
    depth: {cells_deep},
    cells: &CELLS,
}};
{VECTOR_HELPER}"
    );
    text.push_str(COLOR_HELPER);
    text.push_str(&baker.items);
    Module {
        text,
        bytes: baker.bytes,
    }
}

/// The bitmaps that walls or sprites show, and their places.
fn used_bitmaps<'a>(map: &HostMap<'a>) -> Vec<(usize, &'a Bitmap)> {
    let file = map.file();
    let faces = file.walls.iter().flat_map(|it| it.faces);
    let mut used: Vec<_> = faces
        .chain(file.sprites.iter().map(|it| it.texture))
        .collect();
    used.sort_unstable();
    used.dedup();
    used.into_iter()
        .map(|it| (it, &file.textures[it]))
        .collect()
}

/// Adds palettes and texels, each once, and the textures that are made of them.
fn textures(baker: &mut Baker, bitmaps: &[(usize, &Bitmap)]) {
    let mut known = HashMap::new();
    let mut sources = Vec::new();
    for (number, (_, bitmap)) in bitmaps.iter().enumerate() {
        let colors = bitmap.palette.iter();
        let colors = colors.map(|&[red, green, blue]| color(Rgb888::new(red, green, blue)));
        let colors: Vec<_> = colors.collect();
        let palette = format!("PALETTE_{number}");
        baker.array(&palette, "Rgb565", colors.len(), 2 * colors.len(), &colors);
        let texels = &*known.entry(&bitmap.texels).or_insert_with(|| {
            let name = format!("TEXELS_{number}");
            let texels: Vec<u32> = bitmap.texels.iter().map(|&it| it.into()).collect();
            baker.numbers(&name, ("u8", 1), &texels);
            name
        });
        let (width, height) = (bitmap.width, bitmap.height);
        sources.push(format!(
            "Texture {{ width: {width}, height: {height}, texels: &{texels}, palette: &{palette} }}"
        ));
    }
    let bytes = sources.len() * (2 * size_of::<u16>() + 4 * WORD);
    let kind = "Texture<'static, Rgb565>";
    baker.array("TEXTURES", kind, sources.len(), bytes, &sources);
}

/// A display's color as source.
fn color(color: Rgb888) -> String {
    let color = Rgb565::from(color);
    format!("c({}, {}, {})", color.r(), color.g(), color.b())
}

const COLOR_HELPER: &str = "
const fn c(red: u8, green: u8, blue: u8) -> Rgb565 {
    Rgb565::new(red, green, blue)
}
";
