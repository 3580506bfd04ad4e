//! Maps as Rust modules.

use std::collections::{BTreeSet, HashMap};
use std::fmt::Write;
use std::mem::{size_of, size_of_val};

use embedded_graphics::pixelcolor::{Rgb565, Rgb888, RgbColor};
use whitted::grid::{Door, DoorGrid};
use whitted::{Grid, Object, Vec3, View};

use super::source::{VECTOR, WORD, number, vector};
use super::{Baker, Module, VECTOR_HELPER, view_source};
use crate::map::{HostMap, HostMaze};
use crate::scene::Material;
use crate::scene_file::map::{MapFile, Sprite};

/// Writes a map as Rust source, both to be drawn by columns and to be traced, with the camera and the
/// size of a view. Colors of columns are 16 bits, 5-6-5.
pub fn bake_map(map: &HostMap<'_>, view: &View) -> Module {
    let file = map.file();
    let scene = map.scene();
    let mut baker = Baker::default();
    let cells: Vec<u32> = file.plan.iter().map(|&it| it.into()).collect();
    baker.numbers("CELLS", ("u8", 1), &cells);
    let (grid_type, grid) = grid(&mut baker, map);
    let texel = columns(&mut baker, file);
    let maze = maze(&mut baker, &scene.geometry);
    baker.lights(scene.lights);
    baker.import(&["Camera", "Grid", "Maze", "Scene", "Vec3", "View"]);

    let depth = if baker.terms.reflects || baker.terms.transmits {
        file.depth
    } else {
        1
    };
    let mut text = baker.header(&file.path, depth);
    let view = view_source(view);
    let uses: String = (baker.imports.iter())
        .map(|it| format!("use whitted::{it};\n"))
        .collect();
    // Without those at the end that are not named: a map costs what it has.
    let plain = ["u8", "Grid<'static>"];
    let named = match [texel, grid_type] {
        types if types == plain => String::new(),
        [texel, grid] if grid == plain[1] => format!(", {texel}"),
        [texel, grid] => format!(", {texel}, {grid}"),
    };
    let columns = format!("Columns<'static, Rgb565, {}{named}>", file.sprites.len());
    let [floor, above] = map.plain_colors().map(color);
    let (background, ambient) = (vector(scene.background), vector(scene.ambient));
    let (light, material) = (baker.light, baker.terms.material());
    let geometry = match (maze.sides, grid_type) {
        (None, "Grid<'static>") => String::new(),
        (None, grid) => format!(", SceneMaterial, {grid}"),
        (Some(sides), "Grid<'static>") => format!(", {sides}"),
        (Some(sides), grid) => format!(", {sides}, {grid}"),
    };
    let Surfaces {
        walls,
        floor: below,
        ceiling,
        ..
    } = maze;
    let paint = baker.terms.paint().unwrap_or_default();
    let _ = write!(
        text,
        "
{uses}
/// The map, to be drawn by columns.
#[rustfmt::skip]
pub static COLUMNS: {columns} = Columns {{
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
        walls: {walls},
        floor: {below},
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
#[rustfmt::skip]
pub type SceneMaterial = {material};

/// All surfaces.
#[rustfmt::skip]
pub type SceneGeometry = Maze<'static, SceneMaterial{geometry}>;

{grid}{VECTOR_HELPER}"
    );
    text.push_str(COLOR_HELPER);
    text.push_str(&paint);
    text.push_str(&baker.items);
    Module {
        text,
        bytes: baker.bytes,
    }
}

/// Adds the doors, if there are any; the map's type and its constant.
fn grid(baker: &mut Baker, map: &HostMap<'_>) -> (&'static str, String) {
    let DoorGrid { grid, first, doors } = map.grid();
    let Grid { width, depth, .. } = grid;
    if doors.is_empty() {
        let source = format!(
            "const GRID: Grid<'static> = Grid {{\n    width: {width},\n    depth: {depth},\n    \
             cells: &CELLS,\n}};\n"
        );
        return ("Grid<'static>", source);
    }
    baker.import(&["grid::Across", "grid::Door", "grid::DoorGrid"]);
    let source = |it: &Door| {
        let (kind, across, open) = (it.kind, it.across, number(it.open));
        format!("Door {{ kind: {kind}, across: Across::{across:?}, open: {open} }}")
    };
    let sources: Vec<_> = doors.iter().map(source).collect();
    baker.bytes.push(("DOORS".to_owned(), size_of_val(doors)));
    let lines = sources.join(",\n    ");
    let count = doors.len();
    let source = format!(
        "/// As the file has them. Who opens and closes them has a copy in RAM, and draws\n\
         /// `Columns {{ grid: DoorGrid {{ doors: &copy, ..COLUMNS.grid }}, ..COLUMNS }}`.\n\
         #[rustfmt::skip]\npub static DOORS: [Door; {count}] = [\n    {lines},\n];\n\n\
         const GRID: DoorGrid<'static> = DoorGrid {{\n    grid: Grid {{\n        width: {width},\n        \
         depth: {depth},\n        cells: &CELLS,\n    }},\n    first: {first},\n    doors: &DOORS,\n}};\n"
    );
    ("DoorGrid<'static>", source)
}

/// Adds textures, walls and sprites; what the texels of walls are.
fn columns(baker: &mut Baker, file: &MapFile) -> &'static str {
    baker.import(&[
        "columns::Columns",
        "columns::Sprite",
        "columns::Texture",
        "embedded_graphics::pixelcolor::Rgb565",
    ]);
    let of_walls: Vec<_> = file.shown_by_walls().into_iter().collect();
    let of_sprites = used(file.sprites.iter().map(|it| it.texture));
    let all = used(of_walls.iter().chain(&of_sprites).copied());
    let has_palettes = of_walls.iter().all(|&it| file.bitmap(it).is_some());
    let (kind, array, of_walls, of_sprites) = if has_palettes {
        textures(baker, file, &all);
        ("u8", "TEXTURES", &all, &all)
    } else {
        textures(baker, file, &of_sprites);
        let kind = high_textures(baker, file, &of_walls);
        (kind, "WALL_TEXTURES", &of_walls, &of_sprites)
    };
    let texture = |place: usize| {
        let place = of_walls.iter().position(|&it| it == place);
        format!("&{array}[{}]", place.unwrap_or_default())
    };
    let walls: Vec<_> = (file.walls.iter())
        .map(|it| format!("[{}]", it.faces.map(texture).join(", ")))
        .collect();
    let texel = if kind == "u8" {
        String::new()
    } else {
        format!(", {kind}")
    };
    let element = format!("[&Texture<'static, Rgb565{texel}>; 4]");
    let bytes = walls.len() * 4 * WORD;
    baker.array("WALLS", &element, walls.len(), bytes, &walls);
    let sprite = |it: &Sprite| {
        let [x, y, z] = it.position.map(|it| it as f32);
        let place = of_sprites.iter().position(|&place| place == it.texture);
        format!(
            "Sprite {{ position: {}, width: {}, height: {}, texture: &TEXTURES[{}] }}",
            vector(Vec3::new(x, y, z)),
            number(it.width as f32),
            number(it.height as f32),
            place.unwrap_or_default()
        )
    };
    let sprites: Vec<_> = file.sprites.iter().map(sprite).collect();
    let bytes = sprites.len() * (VECTOR + 2 * size_of::<f32>() + WORD);
    let element = "Sprite<'static, Rgb565>";
    baker.array("SPRITES", element, sprites.len(), bytes, &sprites);
    kind
}

/// Each once, in order.
fn used(textures: impl Iterator<Item = usize>) -> Vec<usize> {
    textures.collect::<BTreeSet<_>>().into_iter().collect()
}

/// Source of the parts of a maze.
struct Surfaces {
    walls: String,
    floor: String,
    ceiling: String,
    /// What walls have, if not one material each.
    sides: Option<&'static str>,
}

/// Adds materials, each once, and which walls have them.
fn maze(baker: &mut Baker, maze: &HostMaze<'_>) -> Surfaces {
    let note = |material| {
        baker.terms.note(&[Object {
            shape: (),
            material,
        }])
    };
    let others = [maze.floor].into_iter().chain(maze.ceiling);
    maze.walls.iter().flatten().chain(others).for_each(note);
    baker.import(&["Material"]);
    let is_uniform = |sides: &[Material; 4]| sides.iter().all(|it| *it == sides[0]);
    let (walls, sides) = if maze.walls.iter().all(is_uniform) {
        // In a slice of their own.
        for sides in maze.walls {
            let source = baker.material_source(&sides[0]);
            baker.materials.push(source);
        }
        let count = maze.walls.len();
        (format!("MATERIALS.split_at({count}).0"), None)
    } else {
        let source = |sides: &[Material; 4]| {
            let sides = sides.each_ref().map(|it| baker.material(it));
            let sides = sides.map(|it| format!("&MATERIALS[{it}]"));
            format!("[{}]", sides.join(", "))
        };
        let sources: Vec<_> = maze.walls.iter().map(source).collect();
        let bytes = sources.len() * 4 * WORD;
        let kind = "[&SceneMaterial; 4]";
        baker.array("SIDES", kind, sources.len(), bytes, &sources);
        ("&SIDES".to_owned(), Some("[&'static SceneMaterial; 4]"))
    };
    let floor = format!("&MATERIALS[{}]", baker.material(maze.floor));
    let ceiling = match maze.ceiling {
        Some(ceiling) => format!("Some(&MATERIALS[{}])", baker.material(ceiling)),
        None => "None".to_owned(),
    };
    baker.materials();
    Surfaces {
        walls,
        floor,
        ceiling,
        sides,
    }
}

/// Adds palettes and texels, each once, and the textures that are made of them.
fn textures(baker: &mut Baker, file: &MapFile, places: &[usize]) {
    let mut known = HashMap::new();
    let mut sources = Vec::new();
    let bitmaps = places.iter().filter_map(|&it| file.bitmap(it));
    for (number, bitmap) in bitmaps.enumerate() {
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
    let bytes = sources.len() * TEXTURE;
    let kind = "Texture<'static, Rgb565>";
    baker.array("TEXTURES", kind, sources.len(), bytes, &sources);
}

/// Adds textures without palettes; what their texels are.
fn high_textures(baker: &mut Baker, file: &MapFile, places: &[usize]) -> &'static str {
    let all: Vec<_> = (places.iter())
        .map(|&it| (file.textures[it].size(), file.textures[it].pixels()))
        .collect();
    let is_whole = all.iter().all(|it| it.1.iter().all(Option::is_some));
    let (kind, size) = match is_whole {
        true => ("Rgb565", 2),
        false => ("Option<Rgb565>", 4),
    };
    let mut sources = Vec::new();
    for (number, ([width, height], pixels)) in all.iter().enumerate() {
        let source = |it: &Option<Rgb888>| match (it.map(color), is_whole) {
            (Some(color), true) => color,
            (Some(color), false) => format!("Some({color})"),
            (None, _) => "None".to_owned(),
        };
        let lines: Vec<_> = (pixels.chunks(8))
            .map(|it| it.iter().map(source).collect::<Vec<_>>().join(", "))
            .collect();
        let name = format!("WALL_TEXELS_{number}");
        baker.array(&name, kind, pixels.len(), size * pixels.len(), &lines);
        sources.push(format!(
            "Texture {{ width: {width}, height: {height}, texels: &{name}, palette: &[] }}"
        ));
    }
    let element = format!("Texture<'static, Rgb565, {kind}>");
    let bytes = sources.len() * TEXTURE;
    baker.array("WALL_TEXTURES", &element, sources.len(), bytes, &sources);
    kind
}

/// Bytes of a texture beside its texels and its palette.
const TEXTURE: usize = 2 * size_of::<u16>() + 4 * WORD;

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
