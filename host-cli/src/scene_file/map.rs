//! Maps: a plan of cells, what its walls look like, and who stands in it. The README describes every
//! field.

use std::collections::hash_map::Entry;
use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use ::toml::Spanned;
use serde::Deserialize;
use whitted::grid::{Across, Door};

use super::limits::{self, Range};
use super::texture::{Bitmap, COLORS, Texture, TextureFields, in_order, read_all, take};
use super::toml::{Checker, LightFields, MaterialFields, Places, Point, Real, too_many};
use super::{DEFAULT_DEPTH, Light, Located, Material, Place, Problem, SceneError, bytes};
use crate::scene_file::error::excerpt;

/// A map as its file describes it. Lengths count in cells; the plan's rows run along x, from one to the
/// next along z.
#[derive(Clone, Debug, PartialEq)]
pub struct MapFile {
    /// The file, for messages.
    pub path: PathBuf,
    /// Width and height of the picture in pixels, where the file asks for a size.
    pub size: Option<[u32; 2]>,
    /// Longest chain of rays, the eye ray counted as 1.
    pub depth: usize,
    /// What is seen above an open map.
    pub background: [f64; 3],
    /// Light that reaches every point alike.
    pub ambient: [f64; 3],
    /// In file order.
    pub lights: Vec<Light>,
    /// Cells along x and along z.
    pub cells: [u16; 2],
    /// Row after row: 0 where a cell is empty, else 1 and the place of its wall; from `first_door` on
    /// the places of doors.
    pub plan: Vec<u8>,
    /// What is in the cell of the first door, if there is one; more than any wall.
    pub first_door: u16,
    /// Row after row.
    pub doors: Vec<Door>,
    /// In file order, and then those of doors.
    pub walls: Vec<Wall>,
    /// What the floor is made of.
    pub floor: Material,
    /// What the ceiling is made of; `None` where the map is open above.
    pub ceiling: Option<Material>,
    /// Those of the file, and what walls show beside them.
    pub textures: Vec<Arc<Texture>>,
    /// In file order.
    pub sprites: Vec<Sprite>,
    /// Who looks.
    pub player: Player,
}

/// One kind of wall.
#[derive(Clone, Debug, PartialEq)]
pub struct Wall {
    /// What it is made of, where rays are traced.
    pub material: Material,
    /// What it shows to the west, east, north and south, as places among the textures.
    pub faces: [usize; 4],
    /// Which of these the file names; the others are of the material's color.
    pub is_textured: [bool; 4],
}

/// A bitmap that stands in the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sprite {
    /// The middle of its lower edge.
    pub position: [f64; 3],
    /// In cells.
    pub width: f64,
    /// In cells.
    pub height: f64,
    /// Its place among the textures.
    pub texture: usize,
}

/// Who looks at the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Player {
    /// Where in the file.
    pub place: Place,
    /// The eye.
    pub eye: [f64; 3],
    /// Along x and z, of any length but zero.
    pub direction: [f64; 2],
    /// Full angle between the picture's upper and lower edge, in degrees.
    pub fov: f64,
}

impl MapFile {
    /// The places of the textures that walls and doors show.
    pub fn shown_by_walls(&self) -> BTreeSet<usize> {
        self.walls.iter().flat_map(|it| it.faces).collect()
    }

    /// What a sprite shows; `None` of what has too many colors for one.
    pub fn bitmap(&self, texture: usize) -> Option<&Bitmap> {
        match &**self.textures.get(texture)? {
            Texture::Palette(bitmap) => Some(bitmap),
            Texture::High(_) => None,
        }
    }
}

/// Most cells along one side of a plan.
const PLAN_SIDE: usize = 4096;
/// Most kinds of walls and doors, and of kinds of walls and doors together: what a byte tells.
const WALLS: usize = 255;
/// Most sprites.
pub const SPRITES: usize = 256;
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    plan: Spanned<String>,
    size: Option<Spanned<[u64; 2]>>,
    depth: Option<Spanned<u64>>,
    background: Option<Point>,
    ambient: Option<Point>,
    floor: Spanned<String>,
    ceiling: Option<Spanned<String>>,
    player: Spanned<PlayerFields>,
    #[serde(default)]
    light: Vec<Spanned<LightFields>>,
    #[serde(default)]
    material: HashMap<Spanned<String>, MaterialFields>,
    #[serde(default)]
    texture: HashMap<Spanned<String>, TextureFields>,
    #[serde(default)]
    wall: HashMap<Spanned<String>, WallFields>,
    #[serde(default)]
    door: HashMap<Spanned<String>, WallFields>,
    #[serde(default)]
    sprite: Vec<Spanned<SpriteFields>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PlayerFields {
    position: Spanned<[Real; 2]>,
    height: Option<Real>,
    direction: Spanned<[Real; 2]>,
    fov: Real,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WallFields {
    material: Spanned<String>,
    texture: Option<Spanned<String>>,
    west: Option<Spanned<String>>,
    east: Option<Spanned<String>>,
    north: Option<Spanned<String>>,
    south: Option<Spanned<String>>,
    shade: Option<Real>,
    /// Of doors.
    open: Option<Real>,
}

/// What a character of the plan is.
#[derive(Clone, Copy)]
enum Sign {
    Empty,
    Wall(u8),
    /// As the walls of this kind look, and by what share open.
    Door(u8, f32),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SpriteFields {
    texture: Spanned<String>,
    position: Spanned<[Real; 2]>,
    above: Option<Real>,
    width: Real,
    height: Real,
}

/// Whether a file is a map, by its name.
pub fn is_map(path: &Path) -> bool {
    let extension = path.extension();
    extension.is_some_and(|it| it.eq_ignore_ascii_case("map"))
}

/// Reads a map.
///
/// # Errors
///
/// When the file, or the picture of a texture, cannot be read, breaks the rules or goes beyond the
/// limits; with line and column where there is one.
pub fn read(path: &Path) -> Result<MapFile, SceneError> {
    let fail = |place, problem| SceneError {
        path: path.to_owned(),
        place,
        problem,
    };
    let bytes = bytes(path, limits::TOML_BYTES).map_err(|problem| fail(None, problem))?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let end = error.utf8_error().valid_up_to();
        fail(Some(Place::of(error.as_bytes(), end)), Problem::NotText)
    })?;
    parse(path, &text)
}

/// Makes a map of a file's text; `path` is for messages, and beside it the textures are.
///
/// # Errors
///
/// As [`read`]'s.
pub fn parse(path: &Path, text: &str) -> Result<MapFile, SceneError> {
    let places = Places::new(text);
    let fail = |(place, problem)| SceneError {
        path: path.to_owned(),
        place: Some(place),
        problem,
    };
    let document: Document = ::toml::from_str(text).map_err(|error| {
        let place = places.of(error.span().map_or(0, |it| it.start));
        fail((place, Problem::Toml(error.message().trim().to_owned())))
    })?;
    let reader = Reader {
        check: Checker { places: &places },
        text,
        folder: path.parent().unwrap_or(Path::new("")),
        document: &document,
    };
    reader.read(path).map_err(fail)
}

type Names = HashMap<String, usize>;

/// As in [`MapFile`].
struct Plan {
    cells: [u16; 2],
    plan: Vec<u8>,
    first_door: u16,
    doors: Vec<Door>,
}

/// The textures of the file, their shades, and the colors of plain walls.
struct Textures {
    all: Vec<Arc<Texture>>,
    /// By the place of what is shaded, and the bits of its shade.
    shades: HashMap<(usize, u64), usize>,
    /// How many pixels more there may be.
    allowed: usize,
}

impl Textures {
    /// The place of a texture's shade.
    fn shaded(&mut self, texture: usize, shade: f64) -> Result<usize, Problem> {
        if shade == 1.0 {
            return Ok(texture);
        }
        match self.shades.entry((texture, shade.to_bits())) {
            Entry::Occupied(known) => Ok(*known.get()),
            Entry::Vacant(new) => {
                let bright = &self.all[texture];
                let [width, height] = bright.size().map(usize::from);
                take(&mut self.allowed, width * height)?;
                self.all.push(Arc::new(bright.shaded(shade)));
                Ok(*new.insert(self.all.len() - 1))
            }
        }
    }
}

struct Reader<'a> {
    check: Checker<'a>,
    text: &'a str,
    folder: &'a Path,
    document: &'a Document,
}

impl Reader<'_> {
    fn read(&self, path: &Path) -> Result<MapFile, Located> {
        let (check, document) = (&self.check, self.document);
        let mut materials = Vec::new();
        let mut material_names = Names::new();
        for (name, fields) in in_order(&document.material) {
            let material = fields.read(check, name, &HashMap::new())?;
            material_names.insert(name.get_ref().clone(), materials.len());
            materials.push(material);
        }
        let material = |name: &Spanned<String>| match material_names.get(name.get_ref()) {
            Some(&place) => Ok(materials[place].clone()),
            None => {
                let name_there = excerpt(name.get_ref().as_bytes());
                Err((check.start(name), Problem::UnknownMaterial(name_there)))
            }
        };
        let mut allowed = limits::TEXELS;
        let named = read_all(&document.texture, check, self.folder, &mut allowed)?;
        let (texture_names, all): (Vec<_>, Vec<_>) = named.into_iter().unzip();
        let mut textures = Textures {
            all,
            shades: HashMap::new(),
            allowed,
        };
        let texture_names: HashMap<_, _> = texture_names.into_iter().zip(0..).collect();
        let texture = |name: &Spanned<String>| {
            let place = texture_names.get(name.get_ref().as_str()).copied();
            place.ok_or_else(|| {
                let name_there = excerpt(name.get_ref().as_bytes());
                (check.start(name), Problem::UnknownTexture(name_there))
            })
        };
        let mut walls = Vec::new();
        let mut signs = HashMap::from([('.', Sign::Empty), (' ', Sign::Empty)]);
        let kinds = [&document.wall, &document.door];
        for (is_door, (name, fields)) in (kinds.iter().zip([false, true]))
            .flat_map(|(kinds, is_door)| in_order(kinds).into_iter().map(move |it| (is_door, it)))
        {
            let contradiction = |problem| Err((check.start(name), Problem::Contradiction(problem)));
            if walls.len() == WALLS {
                return Err((check.start(name), too_many("kinds of walls", WALLS)));
            }
            let mut sign = name.get_ref().chars();
            let (Some(sign), None) = (sign.next(), sign.next()) else {
                return contradiction("the name of a wall is one character, as in the plan");
            };
            let wall = self.wall((name, fields), &material, &texture, &mut textures)?;
            let glass = &wall.material;
            let bends = glass.transmittance > 0.0 && glass.ior != 1.0;
            if is_door && (bends || glass.absorption != [0.0; 3]) {
                return contradiction("a door is too thin for glass that bends or absorbs light");
            }
            walls.push(wall);
            let kind = walls.len() as u8;
            let meaning = match (&fields.open, is_door) {
                (Some(open), false) => {
                    let problem = Problem::Contradiction("`open` is for doors, not for walls");
                    return Err((check.start(open), problem));
                }
                (None, false) => Sign::Wall(kind),
                (open, true) => {
                    let open = check.real_or("the opening of the door", open, Range::Share, 0.0)?;
                    Sign::Door(kind, open as f32)
                }
            };
            if let Some(Sign::Wall(_) | Sign::Door(..)) = signs.insert(sign, meaning) {
                return contradiction("a wall and a door have the same name");
            }
        }
        let Plan {
            cells,
            plan,
            first_door,
            doors,
        } = self.plan(&signs)?;
        let mut sprites = Vec::new();
        for sprite in &document.sprite {
            if sprites.len() == SPRITES {
                return Err((check.start(sprite), too_many("sprites", SPRITES)));
            }
            sprites.push(self.sprite(sprite.get_ref(), &texture, &textures.all)?);
        }
        let mut lights = Vec::new();
        for light in &document.light {
            if lights.len() == limits::LIGHTS {
                return Err((check.start(light), too_many("lights", limits::LIGHTS)));
            }
            lights.push(light.get_ref().read(check, check.start(light), true)?);
        }
        let size = document.size.as_ref();
        let depth = document.depth.as_ref();
        Ok(MapFile {
            path: path.to_owned(),
            size: size.map(|it| check.size(it)).transpose()?,
            depth: depth.map_or(Ok(DEFAULT_DEPTH), |it| check.depth(it))?,
            background: check.color("a component of the background", &document.background, 0.0)?,
            ambient: check.color("a component of the ambient light", &document.ambient, 0.0)?,
            lights,
            player: self.player(cells, |cell| (1..first_door).contains(&plan[cell].into()))?,
            cells,
            plan,
            first_door,
            doors,
            walls,
            floor: material(&document.floor)?,
            ceiling: document.ceiling.as_ref().map(material).transpose()?,
            textures: textures.all,
            sprites,
        })
    }

    fn plan(&self, signs: &HashMap<char, Sign>) -> Result<Plan, Located> {
        let (check, plan) = (&self.check, &self.document.plan);
        let start = check.start(plan);
        // Where the text starts after a line break, and says nothing in other words, its lines are
        // those of the file.
        let raw = &self.text[plan.span()];
        let breaks = ["\"\"\"\n", "'''\n", "\"\"\"\r\n", "'''\r\n"];
        let is_plain = breaks.iter().any(|it| raw.starts_with(it)) && !raw.contains('\\');
        let place = |row: usize, column: usize| match is_plain {
            true => Place {
                line: start.line + 1 + row as u32,
                column: 1 + column as u32,
            },
            false => start,
        };
        let rows: Vec<&str> = plan.get_ref().lines().collect();
        let width = rows.first().map_or(0, |row| row.chars().count());
        if width == 0 {
            return Err((start, Problem::Contradiction("the plan has no cells")));
        }
        if width.max(rows.len()) > PLAN_SIDE {
            return Err((start, too_many("cells to a side", PLAN_SIDE)));
        }
        let mut cells = Vec::with_capacity(width * rows.len());
        for (number, row) in rows.iter().enumerate() {
            for (column, sign) in row.chars().enumerate() {
                let unknown = (place(number, column), Problem::UnknownCell(sign));
                cells.push(*signs.get(&sign).ok_or(unknown)?);
            }
            let found = row.chars().count();
            if found != width {
                let problem = Problem::Ragged { found, width };
                return Err((place(number, found.min(width)), problem));
            }
        }
        let is_wall = |column: usize, row: usize| {
            let is_inside = column < width && row < rows.len();
            is_inside && matches!(cells[row * width + column], Sign::Wall(_))
        };
        let kinds = signs.values().filter(|it| matches!(it, Sign::Wall(_)));
        let kinds = kinds.count() as u8;
        let mut doors = Vec::new();
        let mut plan = Vec::with_capacity(cells.len());
        for (cell, sign) in cells.iter().enumerate() {
            plan.push(match *sign {
                Sign::Empty => 0,
                Sign::Wall(kind) => kind,
                Sign::Door(kind, open) => {
                    let (column, row) = (cell % width, cell / width);
                    let [before, after] = [usize::wrapping_sub, usize::wrapping_add];
                    let between = |step: fn(usize, usize) -> usize| {
                        [is_wall(column, step(row, 1)), is_wall(step(column, 1), row)]
                    };
                    let across = match [between(before), between(after)] {
                        [[true, _], [true, _]] => Across::X,
                        [[_, true], [_, true]] => Across::Z,
                        _ => {
                            let problem = "a door is between two walls, to its north and south, or \
                                           to its west and east";
                            return Err((place(row, column), Problem::Contradiction(problem)));
                        }
                    };
                    if usize::from(kinds) + doors.len() == WALLS {
                        let problem = too_many("kinds of walls and doors", WALLS);
                        return Err((place(row, column), problem));
                    }
                    doors.push(Door { kind, across, open });
                    kinds + doors.len() as u8
                }
            });
        }
        Ok(Plan {
            cells: [width as u16, rows.len() as u16],
            plan,
            first_door: u16::from(kinds) + 1,
            doors,
        })
    }

    fn wall(
        &self,
        (name, fields): (&Spanned<String>, &WallFields),
        material: &impl Fn(&Spanned<String>) -> Result<Material, Located>,
        texture: &impl Fn(&Spanned<String>) -> Result<usize, Located>,
        textures: &mut Textures,
    ) -> Result<Wall, Located> {
        let material = material(&fields.material)?;
        let shade = self
            .check
            .real_or("the shade", &fields.shade, Range::Share, 0.75)?;
        let base = match &fields.texture {
            Some(name) => texture(name)?,
            None => {
                let plain = Texture::plain(material.color);
                textures.all.push(Arc::new(plain));
                textures.all.len() - 1
            }
        };
        let sides = [&fields.west, &fields.east, &fields.north, &fields.south];
        let shades = [1.0, 1.0, shade, shade];
        let mut faces = [base; 4];
        for ((face, side), shade) in faces.iter_mut().zip(sides).zip(shades) {
            *face = match side {
                Some(name) => texture(name)?,
                None => (textures.shaded(base, shade))
                    .map_err(|problem| (self.check.start(name), problem))?,
            };
        }
        let is_textured = sides.map(|it| it.is_some() || fields.texture.is_some());
        Ok(Wall {
            material,
            faces,
            is_textured,
        })
    }

    fn sprite(
        &self,
        fields: &SpriteFields,
        texture: &impl Fn(&Spanned<String>) -> Result<usize, Located>,
        textures: &[Arc<Texture>],
    ) -> Result<Sprite, Located> {
        let check = &self.check;
        let shown = texture(&fields.texture)?;
        if let Texture::High(_) = *textures[shown] {
            let problem = too_many("colours in the texture of a sprite", COLORS);
            return Err((check.start(&fields.texture), problem));
        }
        let length = |what: &str, number: &Real| {
            let length = check.length(what, number)?;
            // As it is drawn.
            if length as f32 > 0.0 {
                return Ok(length);
            }
            let problem = Problem::Contradiction("a sprite is wider and higher than 0");
            Err((check.start(number), problem))
        };
        let above = fields.above.as_ref();
        let above = above.map_or(Ok(0.0), |it| check.length("the height above", it))?;
        let [x, z] = self.pair("a coordinate of the sprite", &fields.position)?;
        Ok(Sprite {
            position: [x, above, z],
            width: length("the width", &fields.width)?,
            height: length("the height", &fields.height)?,
            texture: shown,
        })
    }

    fn pair(&self, what: &str, numbers: &Spanned<[Real; 2]>) -> Result<[f64; 2], Located> {
        let [a, b] = numbers.get_ref();
        Ok([self.check.length(what, a)?, self.check.length(what, b)?])
    }

    fn player(&self, cells: [u16; 2], is_wall: impl Fn(usize) -> bool) -> Result<Player, Located> {
        let (check, fields) = (&self.check, self.document.player.get_ref());
        let contradiction = |place, problem| Err((place, Problem::Contradiction(problem)));
        let [x, z] = self.pair("a coordinate of the player", &fields.position)?;
        // As it is cast.
        let cell = [(x as f32, cells[0]), (z as f32, cells[1])].map(|(at, count)| {
            let is_inside = at >= 0.0 && at < f32::from(count);
            is_inside.then_some(at as usize)
        });
        let [Some(column), Some(row)] = cell else {
            let place = check.start(&fields.position);
            return contradiction(place, "the player is not on the plan");
        };
        if is_wall(row * usize::from(cells[0]) + column) {
            let place = check.start(&fields.position);
            return contradiction(place, "the player stands in a wall");
        }
        let height = check.real_or("the height of the eye", &fields.height, Range::Share, 0.5)?;
        let direction = self.pair("a component of the direction", &fields.direction)?;
        if direction.map(|it| it as f32) == [0.0; 2] {
            let place = check.start(&fields.direction);
            return contradiction(place, "the player's direction is zero");
        }
        Ok(Player {
            place: check.start(&self.document.player),
            eye: [x, height, z],
            direction,
            fov: check.real("the field of view", &fields.fov, Range::Angle)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use embedded_graphics::pixelcolor::{Rgb565, RgbColor};

    use super::*;
    use crate::scene_file::texture::{CLEAR, HighBitmap, TEXTURE_SIDE};

    const ROOM: &str = "plan = '''\n\
        ####\n\
        #..#\n\
        ####\n\
        '''\n\
        floor = 'stone'\n\
        player = { position = [1.5, 1.5], direction = [1, 0], fov = 60 }\n\
        [material.stone]\n\
        color = [0.5, 0.25, 1]\n\
        [texture.flag]\n\
        rows = ['ab', 'a.']\n\
        colors = { a = [1, 0, 0], b = [0, 0, 1] }\n\
        [wall.'#']\n\
        material = 'stone'\n";

    fn read(text: &str) -> Result<MapFile, String> {
        parse(Path::new("t.map"), text).map_err(|it| it.to_string())
    }

    #[test]
    fn plans_textures_and_shades_are_read() {
        let text = ROOM.replace(
            "material = 'stone'\n",
            "material = 'stone'\ntexture = 'flag'\nshade = 0.5\nwest = 'flag'\n\
             [[sprite]]\ntexture = 'flag'\nposition = [2, 1.5]\nwidth = 0.5\nheight = 1\n",
        );
        let map = read(&text).unwrap();
        assert_eq!((map.cells, map.depth, map.size), ([4, 3], 5, None));
        assert_eq!(map.plan, [1, 1, 1, 1, 1, 0, 0, 1, 1, 1, 1, 1]);
        let wall = &map.walls[0];
        let [west, east, north, south] = wall.faces.map(|it| map.bitmap(it).unwrap());
        assert_eq!((west, north), (east, south));
        assert_eq!(west.texels, [0, 0, 1, CLEAR], "column after column");
        assert_eq!(west.palette, [[255, 0, 0], [0, 0, 255]]);
        assert_eq!(north.palette, [[128, 0, 0], [0, 0, 128]]);
        assert_eq!(wall.is_textured, [true; 4]);
        assert_eq!(map.sprites[0].position, [2.0, 0.0, 1.5]);
        assert_eq!(map.player.eye, [1.5, 0.5, 1.5]);
        assert_eq!(map.ceiling, None);

        let plain = read(ROOM).unwrap();
        let [_, _, north, _] = plain.walls[0].faces.map(|it| plain.bitmap(it).unwrap());
        assert_eq!(
            north.palette,
            [[96, 48, 191]],
            "three quarters, if nothing is said"
        );
    }

    const HOUSE: &str = "plan = '''\n\
        ##D##\n\
        #.#.#\n\
        #.D.#\n\
        ##W##\n\
        '''\n\
        floor = 'stone'\n\
        player = { position = [2.5, 2.25], direction = [1, 0], fov = 60 }\n\
        [material.stone]\n\
        [wall.'#']\n\
        material = 'stone'\n\
        [wall.'W']\n\
        material = 'stone'\n\
        [door.D]\n\
        material = 'stone'\n\
        open = 0.25\n";

    #[test]
    fn each_door_of_the_plan_opens_by_itself() {
        let map = read(HOUSE).unwrap();
        let door = |across| Door {
            kind: 3,
            across,
            open: 0.25,
        };
        // The player may stand in one.
        assert_eq!(map.doors, [door(Across::Z), door(Across::X)]);
        assert_eq!((map.first_door, map.walls.len()), (3, 3));
        assert_eq!(map.plan[..10], [1, 1, 3, 1, 1, 1, 0, 1, 0, 1]);
        assert_eq!(map.plan[10..], [1, 0, 4, 0, 1, 1, 1, 2, 1, 1]);
    }

    #[test]
    fn errors_of_doors_name_the_place_and_the_reason() {
        let with = |from: &str, to: &str| {
            assert!(HOUSE.contains(from), "{from}");
            HOUSE.replacen(from, to, 1)
        };
        let between =
            "a door is between two walls, to its north and south, or to its west and east";
        let glass = |fields: &str| {
            let pane = format!("[material.pane]\ntransmittance = 0.5\n{fields}\n[wall.'#']");
            with("[wall.'#']", &pane).replace(
                "[door.D]\nmaterial = 'stone'",
                "[door.D]\nmaterial = 'pane'",
            )
        };
        let thin = "17:7: a door is too thin for glass that bends or absorbs light";
        let long = |doors: usize| {
            let rows = ["#".repeat(doors), "D".repeat(doors), "#".repeat(doors)].join("\n");
            with("##D##\n#.#.#\n#.D.#\n##W##", &rows).replace("[2.5, 2.25]", "[2.5, 1.5]")
        };
        let cases = [
            (with("##D##", "#.D##"), format!("2:3: {between}")),
            (
                with("#.#.#\n#.D.#", "#...#\n#.D.#"),
                format!("4:3: {between}"),
            ),
            (
                with("#.D.#\n##W##", "#.D.#\n##D##"),
                format!("4:3: {between}"),
            ),
            (with("##D##", "D####"), format!("2:1: {between}")),
            (
                with("open = 0.25", "open = 1.5"),
                "16:8: the opening of the door is 1.5: not between 0 and 1".to_owned(),
            ),
            (
                with("open = 0.25", "open = -0.5"),
                "16:8: the opening of the door is -0.5: not between 0 and 1".to_owned(),
            ),
            (
                with("open = 0.25", "open = nan"),
                "16:8: the opening of the door is NaN: not between 0 and 1".to_owned(),
            ),
            (
                with(
                    "[wall.'W']\nmaterial = 'stone'",
                    "[wall.'W']\nmaterial = 'stone'\nopen = 0",
                ),
                "14:8: `open` is for doors, not for walls".to_owned(),
            ),
            (
                with("[door.D]", "[door.W]"),
                "14:7: a wall and a door have the same name".to_owned(),
            ),
            (
                with("[door.D]", "[door.DD]"),
                "14:7: the name of a wall is one character, as in the plan".to_owned(),
            ),
            (glass(""), thin.to_owned()),
            (
                glass("ior = 1\nabsorption = [1, 0, 0]"),
                thin.replace("17:", "18:"),
            ),
            (
                long(254),
                "3:254: more than 255 kinds of walls and doors".to_owned(),
            ),
        ];
        for (text, message) in cases {
            let error = read(&text).err().unwrap_or_default();
            assert_eq!(error, format!("t.map:{message}"), "{text:.300}");
        }
        assert!(read(&glass("ior = 1")).is_ok());
        assert_eq!(read(&long(253)).unwrap().doors.len(), 253);
    }

    #[test]
    fn a_byte_tells_255_kinds_of_walls() {
        let walls = |count: u32| {
            let sign = |it| char::from_u32(0x100 + it).unwrap();
            let each = |it| format!("[wall.'{}']\nmaterial = 'stone'\n", sign(it));
            let walls: String = (0..count).map(each).collect();
            let plan = ROOM.replace("#..#", &format!("#..{}", sign(count - 1)));
            plan + &walls
        };
        let map = read(&walls(254)).unwrap();
        assert_eq!((map.plan[7], map.first_door), (255, 256));
        let inside = walls(254).replace("[1.5, 1.5]", "[3.5, 1.5]");
        let error = "t.map:7:23: the player stands in a wall";
        assert_eq!(read(&inside).unwrap_err(), error);
        let error = "t.map:523:7: more than 255 kinds of walls";
        assert_eq!(read(&walls(255)).unwrap_err(), error);
    }

    #[test]
    fn textures_are_shaded_once_and_where_they_are_seen() {
        let wall = |sign: char, shade: f64, more: &str| {
            format!(
                "[wall.{sign}]\nmaterial = 'stone'\ntexture = 'flag'\nshade = {shade}\n{more}\n"
            )
        };
        let hidden = wall('c', 0.25, "north = 'flag'\nsouth = 'flag'");
        let all = [
            ROOM,
            &wall('a', 0.5, ""),
            &wall('b', 0.5, ""),
            &hidden,
            &wall('d', 1.0, ""),
        ];
        let map = read(&all.concat()).unwrap();
        // The file's, two of the plain walls, and a shade.
        assert_eq!(map.textures.len(), 4);
        let faces: Vec<_> = map.walls[1..].iter().map(|it| it.faces).collect();
        assert_eq!(faces, [[0, 0, 3, 3], [0, 0, 3, 3], [0; 4], [0; 4]]);
        let plain = ROOM.to_owned()
            + "[[sprite]]\ntexture = 'flag'\nposition = [2, 1.5]\nwidth = 1\nheight = 1\n";
        let shown = read(&plain).unwrap().shown_by_walls();
        assert_eq!(shown, BTreeSet::from([1, 2]), "not what only sprites show");
    }

    #[test]
    fn shades_count_among_the_pixels() {
        let row = format!("'{}',", "a".repeat(TEXTURE_SIDE));
        let rows = format!("rows = [{}]", row.repeat(TEXTURE_SIDE));
        let large = ROOM.replace("rows = ['ab', 'a.']", &rows);
        let walls = |count: u32, shade: &dyn Fn(u32) -> u32| {
            let wall = |it| {
                let (sign, shade) = (char::from_u32(0x100 + it).unwrap(), shade(it));
                format!(
                    "[wall.'{sign}']\nmaterial = 'stone'\ntexture = 'flag'\nshade = 0.{shade}\n"
                )
            };
            large.clone() + &(0..count).map(wall).collect::<String>()
        };
        // Beside the texture and its shades there is the one pixel of a plain wall's shade.
        let fit = (limits::TEXELS / TEXTURE_SIDE.pow(2)) as u32 - 2;
        assert!(read(&walls(fit, &|it| 10 + it)).is_ok());
        assert!(read(&walls(fit + 2, &|_| 5)).is_ok());
        let error = read(&walls(fit + 1, &|it| 10 + it)).unwrap_err();
        let line = 15 + 4 * fit;
        let message = "more than 67108864 pixels in all textures";
        assert_eq!(error, format!("t.map:{line}:7: {message}"));
    }

    #[test]
    fn errors_name_the_place_and_the_reason() {
        let with = |from: &str, to: &str| {
            assert!(ROOM.contains(from), "{from}");
            ROOM.replacen(from, to, 1)
        };
        let sprite = |fields: &str| {
            format!("{ROOM}[[sprite]]\ntexture = 'flag'\nposition = [1, 1]\n{fields}")
        };
        let long = "#".repeat(PLAN_SIDE + 1);
        let rows = format!("['{}']", "a".repeat(TEXTURE_SIDE + 1));
        let cases = [
            (
                with("plan", "plans"),
                "1:1: unknown field `plans`, expected one of `plan`, `size`, `depth`, `background`, `ambient`, `floor`, `ceiling`, `player`, `light`, `material`, `texture`, `wall`, `door`, `sprite`",
            ),
            (with("floor = 'stone'", ""), "1:1: missing field `floor`"),
            (
                with("#..#", "#.M#"),
                "3:3: `M` is neither a wall of the file nor empty, which `.` and a space are",
            ),
            (
                with("#..#", "#.#"),
                "3:4: 3 cells in this row, 4 in the first",
            ),
            (
                with("#..#", "#...#"),
                "3:5: 5 cells in this row, 4 in the first",
            ),
            (
                with("\n#..#\n", "\\n#..#\\n")
                    .replace("'''", "\"\"\"")
                    .replacen("#..#", "#.M#", 1),
                "1:8: `M` is neither a wall of the file nor empty, which `.` and a space are",
            ),
            (with("####\n#..#\n####\n", ""), "1:8: the plan has no cells"),
            (
                with("####\n#..#\n####\n", &long),
                "1:8: more than 4096 cells to a side",
            ),
            (
                with("floor = 'stone'", "floor = 'ston'"),
                "6:9: no material is named `ston`",
            ),
            (
                with("position = [1.5, 1.5]", "position = [-1, 1.5]"),
                "7:23: the player is not on the plan",
            ),
            (
                with("position = [1.5, 1.5]", "position = [1.5, 2.5]"),
                "7:23: the player stands in a wall",
            ),
            (
                with("direction = [1, 0]", "direction = [0, 0]"),
                "7:47: the player's direction is zero",
            ),
            (
                with("fov = 60", "fov = 180"),
                "7:61: the field of view is 180.0: not between 0 and 180 degrees",
            ),
            (
                with("fov = 60", "fov = 60, height = 1.5"),
                "7:74: the height of the eye is 1.5: not between 0 and 1",
            ),
            (
                with("rows = ['ab', 'a.']", ""),
                "10:10: a texture has either `file` or `rows`",
            ),
            (
                with("rows = ['ab', 'a.']", "rows = []"),
                "11:8: the texture has no pixels",
            ),
            (
                with("rows = ['ab', 'a.']", "rows = ['ab', 'a']"),
                "11:15: 1 cells in this row, 2 in the first",
            ),
            (
                with("rows = ['ab', 'a.']", &format!("rows = {rows}")),
                "11:8: more than 1024 pixels to a side of a texture",
            ),
            (
                with(
                    "rows = ['ab', 'a.']\ncolors = { a = [1, 0, 0], b = [0, 0, 1] }",
                    "file = 'no.png'",
                ),
                "11:8: texture no.png: No such file or directory (os error 2)",
            ),
            (
                with("a = [1, 0, 0]", "ab = [1, 0, 0]"),
                "12:12: the name of a texture's color is one character, as in its rows",
            ),
            (
                with("a = [1, 0, 0]", "a = [2, 0, 0]"),
                "12:16: a component of the colour is 2.0: not between 0 and 1",
            ),
            (
                with("[wall.'#']", "[wall.'##']"),
                "13:7: the name of a wall is one character, as in the plan",
            ),
            (
                format!("{ROOM}texture = 'brick'"),
                "15:11: no texture is named `brick`",
            ),
            (
                format!("{ROOM}north = 'brick'"),
                "15:9: no texture is named `brick`",
            ),
            (
                format!("{ROOM}shade = -1"),
                "15:9: the shade is -1.0: not between 0 and 1",
            ),
            (
                sprite("width = 0\nheight = 1"),
                "18:9: a sprite is wider and higher than 0",
            ),
            (
                sprite("width = 1\nheight = -1"),
                "19:10: a sprite is wider and higher than 0",
            ),
            (
                sprite("width = 1\nheight = 1").replace("texture = 'flag'", "texture = 'x'"),
                "16:11: no texture is named `x`",
            ),
            (
                format!(
                    "{ROOM}{}",
                    sprite("width = 1\nheight = 1")[ROOM.len()..]
                        .repeat(SPRITES + 1)
                        .replace("height = 1", "height = 1\n")
                ),
                "1295:1: more than 256 sprites",
            ),
        ];
        for (text, message) in cases {
            let error = read(&text).err().unwrap_or_default();
            assert_eq!(error, format!("t.map:{message}"), "{text:.300}");
        }
    }

    #[test]
    fn pictures_become_palettes_or_colors() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, pixels: usize| {
            let colors = (0..pixels).map(|it| format!("{} {} 9\n", it % 256, it / 256));
            let text = format!("P3\n{pixels} 1\n255\n{}", colors.collect::<String>());
            std::fs::write(folder.path().join(name), text).unwrap();
        };
        write("few.ppm", 255);
        write("many.ppm", 256);
        std::fs::write(folder.path().join("none.ppm"), "P3\n0 1\n255\n").unwrap();
        let sprite = "[[sprite]]\ntexture = 'flag'\nposition = [2, 1.5]\nwidth = 1\nheight = 1\n";
        let read_with = |name: &str, more: &str| {
            let rows = "rows = ['ab', 'a.']\ncolors = { a = [1, 0, 0], b = [0, 0, 1] }";
            let text = ROOM.replace(rows, &format!("file = '{name}'")) + more;
            parse(&folder.path().join("t.map"), &text)
        };
        let read = |name: &str| read_with(name, "");
        let shown = read_with("many.ppm", sprite).unwrap_err().to_string();
        let message = "t.map:15:11: more than 255 colours in the texture of a sprite";
        assert!(shown.ends_with(message), "{shown}");
        assert!(read_with("few.ppm", sprite).is_ok());
        let few = read("few.ppm").unwrap();
        assert_eq!(
            (
                few.bitmap(0).unwrap().width,
                few.bitmap(0).unwrap().palette[7]
            ),
            (255, [7, 0, 9])
        );
        // Walls may have more colors, as 16 bits a pixel, darker ones too.
        let many = read("many.ppm").unwrap();
        assert_eq!(many.bitmap(0), None);
        let Texture::High(high) = &*many.textures[0] else {
            panic!("{:?}", many.textures[0]);
        };
        assert_eq!((high.width, high.pixels[255].r()), (256, 31));
        let half = Rgb565::new(31, 40, 5);
        let darker = Texture::High(HighBitmap {
            width: 1,
            height: 1,
            pixels: vec![half],
        })
        .shaded(0.5);
        assert_eq!(darker.pixels(), [Some(Rgb565::new(16, 20, 3).into())]);
        let none = read("none.ppm").unwrap_err().to_string();
        assert!(
            none.contains("11:8: texture none.ppm: 0x1 pixels"),
            "{none}"
        );
    }
}
