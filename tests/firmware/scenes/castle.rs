//! A map: as a maze for the tracer, and as textured columns.

use embedded_graphics::pixelcolor::Rgb565;
use glam::Vec3;
use whitted::columns::{Columns, Sprite, Texture};
use whitted::grid::{Across, Door, DoorGrid};
use whitted::pattern::Nearest;
use whitted::{Camera, Grid, ImageMap, Light, Material, Maze, Mirror, Scene, View};

use super::{Visitor, level_view};

const PLAN: &[u8; 80] = b"\
    ##########\
    #...#....#\
    #...#..%.#\
    #........#\
    ###.##...#\
    #.....%..#\
    #...#....#\
    ##########";

static CELLS: [u8; PLAN.len()] = {
    let mut cells = [0; PLAN.len()];
    let mut place = 0;
    while place < cells.len() {
        cells[place] = match PLAN[place] {
            b'#' => 1,
            b'%' => 2,
            _ => 0,
        };
        place += 1;
    }
    cells
};

const GRID: Grid = Grid {
    width: 10,
    depth: 8,
    cells: &CELLS,
};

type M = Material<(), Mirror>;

const fn stone(color: Vec3, reflectance: f32) -> M {
    Material {
        color,
        ambient: 0.25,
        diffuse: 0.75 * (1.0 - reflectance),
        highlight: (),
        reflection: Mirror { reflectance },
        transmission: (),
    }
}

static WALLS: [M; 2] = [
    stone(Vec3::new(0.625, 0.25, 0.125), 0.0),
    stone(Vec3::new(0.75, 0.75, 0.875), 0.75),
];
static FLOOR: M = stone(Vec3::new(0.375, 0.375, 0.25), 0.25);
static CEILING: M = stone(Vec3::new(0.25, 0.25, 0.375), 0.0);
static LIGHTS: [Light; 1] = [Light {
    position: Vec3::new(5.5, 0.875, 3.25),
    color: Vec3::ONE,
}];
static SCENE: Scene<'static, Maze<'static, M>> = Scene {
    geometry: Maze {
        grid: GRID,
        walls: &WALLS,
        floor: &FLOOR,
        ceiling: Some(&CEILING),
    },
    lights: &LIGHTS,
    background: Vec3::ZERO,
    ambient: Vec3::ONE,
};

frame!(
    /// Walls, floor and ceiling with shadows; pillars and the floor mirror.
    AsMaze = &SCENE, level_view(Vec3::new(7.5, 0.5, 6.75)), 4
);

/// Pixels to a side of all textures.
const SIDE: usize = 16;

/// Bricks: 0 is mortar.
static BRICKS: [u8; SIDE * SIDE] = {
    let mut texels = [0; SIDE * SIDE];
    let mut place = 0;
    while place < texels.len() {
        let (u, v) = (place / SIDE, place % SIDE);
        let shifted = u + 4 * (v / 4 % 2);
        if v % 4 != 0 && shifted % 8 != 0 {
            texels[place] = 1 + ((shifted / 8 + v / 4) % 2) as u8;
        }
        place += 1;
    }
    texels
};

/// A ball on a foot; what is around it is transparent.
static LAMP: [u8; SIDE * SIDE] = {
    let mut texels = [255; SIDE * SIDE];
    let mut place = 0;
    while place < texels.len() {
        let (u, v) = ((place / SIDE) as i32, (place % SIDE) as i32);
        let (x, y) = (2 * u - 15, 2 * v - 9);
        if x * x + y * y < 80 {
            texels[place] = (x + y > 0) as u8;
        } else if v > 8 && x * x < 10 + 20 * (v > 13) as i32 {
            texels[place] = 2;
        }
        place += 1;
    }
    texels
};

type Bitmap = Texture<'static, Rgb565>;

const fn bitmap(texels: &'static [u8], palette: &'static [Rgb565]) -> Bitmap {
    Texture {
        width: SIDE as u16,
        height: SIDE as u16,
        texels,
        palette,
    }
}

const fn rgb(red: u8, green: u8, blue: u8) -> Rgb565 {
    Rgb565::new(red, green, blue)
}

static BRICK: Bitmap = bitmap(&BRICKS, &[rgb(18, 34, 16), rgb(20, 14, 6), rgb(17, 12, 5)]);
static SHADED_BRICK: Bitmap = bitmap(&BRICKS, &[rgb(12, 22, 10), rgb(13, 9, 4), rgb(11, 8, 3)]);
static TILE: Bitmap = bitmap(&BRICKS, &[rgb(8, 16, 12), rgb(20, 44, 26), rgb(18, 40, 24)]);
static GLOBE: Bitmap = bitmap(&LAMP, &[rgb(31, 62, 24), rgb(28, 50, 12), rgb(8, 18, 9)]);
static SPRITES: [Sprite<'static, Rgb565>; 2] = [
    Sprite {
        position: Vec3::new(6.5, 0.0, 4.5),
        width: 0.5,
        height: 0.5,
        texture: &GLOBE,
    },
    Sprite {
        position: Vec3::new(3.5, 0.0, 3.5),
        width: 0.5,
        height: 0.5,
        texture: &GLOBE,
    },
];

/// The map as columns.
pub static COLUMNS: Columns<'static, Rgb565, 2> = Columns {
    grid: GRID,
    walls: &[
        [&BRICK, &BRICK, &SHADED_BRICK, &SHADED_BRICK],
        [&TILE, &TILE, &TILE, &TILE],
    ],
    sprites: &SPRITES,
    floor: rgb(6, 14, 5),
    ceiling: rgb(5, 10, 9),
};

/// What is seen of it: across the rooms, along no axis.
pub const COLUMNS_VIEW: View = View {
    camera: Camera {
        eye: Vec3::new(8.25, 0.5, 6.5),
        corner: Vec3::new(-1.55, 0.75, -0.4),
        right: Vec3::new(1.6, 0.0, -1.2),
        down: Vec3::new(0.0, -1.5, 0.0),
    },
    width: 160,
    height: 120,
};

/// The same plan with two doors.
static CELLS_WITH_DOORS: [u8; PLAN.len()] = {
    let mut cells = CELLS;
    cells[4 * 10 + 3] = 4;
    cells[5 * 10 + 4] = 5;
    cells
};

/// One to the north, almost closed, and one to the east, half open.
static DOORS: [Door; 2] = [
    Door {
        kind: 3,
        across: Across::Z,
        open: 0.125,
    },
    Door {
        kind: 3,
        across: Across::X,
        open: 0.5,
    },
];

const GRID_WITH_DOORS: DoorGrid = DoorGrid {
    grid: Grid {
        cells: &CELLS_WITH_DOORS,
        ..GRID
    },
    first: 4,
    doors: &DOORS,
};

static PANEL: Bitmap = bitmap(&BRICKS, &[rgb(9, 12, 4), rgb(22, 32, 6), rgb(20, 28, 5)]);

/// The map with doors as columns.
pub static COLUMNS_WITH_DOORS: Columns<'static, Rgb565, 2, u8, DoorGrid<'static>> = Columns {
    grid: GRID_WITH_DOORS,
    walls: &[
        [&BRICK, &BRICK, &SHADED_BRICK, &SHADED_BRICK],
        [&TILE, &TILE, &TILE, &TILE],
        [&PANEL, &PANEL, &PANEL, &PANEL],
    ],
    sprites: &SPRITES,
    floor: rgb(6, 14, 5),
    ceiling: rgb(5, 10, 9),
};

/// Both doors, from within the room.
pub const VIEW_OF_DOORS: View = View {
    camera: Camera {
        eye: Vec3::new(1.5, 0.5, 6.5),
        corner: Vec3::new(0.4, 0.75, -1.55),
        right: Vec3::new(1.2, 0.0, 1.6),
        down: Vec3::new(0.0, -1.5, 0.0),
    },
    width: 160,
    height: 120,
};

type Paved = Material<(), Mirror, (), ImageMap<'static, Bitmap, Nearest>>;

const fn paved(image: &'static Bitmap, reflectance: f32) -> Paved {
    Material {
        color: ImageMap {
            image,
            repeat: (1.0, 1.0),
            filter: Nearest,
        },
        ambient: 0.25,
        diffuse: 0.75 * (1.0 - reflectance),
        highlight: (),
        reflection: Mirror { reflectance },
        transmission: (),
    }
}

static BRICK_WALL: Paved = paved(&BRICK, 0.0);
static SHADED_BRICK_WALL: Paved = paved(&SHADED_BRICK, 0.0);
static TILES: Paved = paved(&TILE, 0.25);
static WOOD: Paved = paved(&PANEL, 0.0);
static SCENE_WITH_DOORS: Scene<
    'static,
    Maze<'static, Paved, [&'static Paved; 4], DoorGrid<'static>>,
> = Scene {
    geometry: Maze {
        grid: GRID_WITH_DOORS,
        walls: &[
            [
                &BRICK_WALL,
                &BRICK_WALL,
                &SHADED_BRICK_WALL,
                &SHADED_BRICK_WALL,
            ],
            [&TILES; 4],
            [&WOOD; 4],
        ],
        floor: &TILES,
        ceiling: Some(&BRICK_WALL),
    },
    lights: &[Light {
        position: Vec3::new(3.25, 0.875, 5.25),
        color: Vec3::ONE,
    }],
    background: Vec3::ZERO,
    ambient: Vec3::ONE,
};

frame!(
    /// Doors, and textures on all sides of cells.
    WithDoors = &SCENE_WITH_DOORS, View { width: 64, height: 48, ..VIEW_OF_DOORS }, 4
);

/// Shows the frames to the visitor, by the names of their programs.
pub fn visit_all(visitor: &mut impl Visitor) {
    visitor.visit::<AsMaze>("maze");
    visitor.visit::<WithDoors>("doors");
}
