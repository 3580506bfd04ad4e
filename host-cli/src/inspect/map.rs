//! What a map needs.

use std::fmt;

use serde::Serialize;
use whitted::View;

use crate::bake::bake_map;
use crate::map::HostMap;
use crate::scene_file::texture::Texture;

/// What [`inspect_map`] found.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct MapReport {
    /// The file's name.
    pub file: String,
    /// Along x and z.
    pub cells: [u16; 2],
    /// Cells that are solid.
    pub solid: usize,
    /// Cells that have doors.
    pub doors: usize,
    /// Kinds of walls and doors.
    pub kinds: usize,
    /// Textures of walls and sprites, their shades counted.
    pub textures: usize,
    /// Those of them that have no palette.
    pub without_palette: usize,
    /// Bitmaps that stand in the map.
    pub sprites: usize,
    /// Lights, for traced pictures.
    pub lights: usize,
    /// Longest chain of rays that the map asks for.
    pub depth: usize,
    /// The arrays that `whitted bake` writes, and their bytes where a pointer has 4.
    pub bytes: Vec<(String, usize)>,
    /// Of all of these; a program that only draws columns, or only traces, links less.
    pub total: usize,
}

/// Inspects a map as it is seen.
pub fn inspect_map(map: &HostMap<'_>, view: &View) -> MapReport {
    let file = map.file();
    let module = bake_map(map, view);
    let is_solid = |it: &&u8| (1..file.first_door).contains(&u16::from(**it));
    let is_high = |it: &&_| matches!(**it, Texture::High(_));
    MapReport {
        file: file.path.display().to_string(),
        cells: file.cells,
        solid: file.plan.iter().filter(is_solid).count(),
        doors: file.doors.len(),
        kinds: file.walls.len(),
        textures: file.textures.len(),
        without_palette: file.textures.iter().map(|it| &**it).filter(is_high).count(),
        sprites: file.sprites.len(),
        lights: file.lights.len(),
        depth: file.depth,
        total: module.flash(),
        bytes: module.bytes,
    }
}

impl fmt::Display for MapReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [width, depth] = self.cells;
        writeln!(f, "{}", self.file)?;
        writeln!(f, "  cells      {width}x{depth}, {} solid", self.solid)?;
        writeln!(f, "  doors      {}", self.doors)?;
        writeln!(f, "  kinds      {} of walls and doors", self.kinds)?;
        let (textures, high) = (self.textures, self.without_palette);
        writeln!(
            f,
            "  textures   {textures}, {high} of them without a palette"
        )?;
        writeln!(f, "  sprites    {}", self.sprites)?;
        writeln!(f, "  lights     {}", self.lights)?;
        writeln!(f, "  depth      {}", self.depth)?;
        writeln!(
            f,
            "  bytes      {} of flash for columns and rays",
            self.total
        )
    }
}
