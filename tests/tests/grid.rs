//! Maps: the cells that rays walk against exact arithmetic, and columns against traced rays.

use embedded_graphics::pixelcolor::Rgb888;
use embedded_graphics::prelude::RgbColor;
use whitted::columns::{Columns, Texture};
use whitted::grid::{Across, Door, DoorGrid, Face, Grid, Plan, Way};
use whitted::{Camera, Geometry, Material, Maze, Ray, Vec3, View};
use whitted_tests::exact::Line;
use whitted_tests::exact::grid::{self, Panel};
use whitted_tests::lab::random::{Random, Stream};

fn random(purpose: &str) -> Random {
    Random::new(Stream {
        seed: 6,
        purpose: Stream::purpose(["maps", purpose]),
        cell: 0,
        chunk: 0,
    })
}

fn line(origin: Vec3, direction: Vec3) -> Line {
    Line {
        origin: origin.to_array(),
        direction: direction.to_array(),
    }
}

/// The cells of a walk over an empty map.
fn walked(origin: Vec3, direction: Vec3, size: u16) -> Vec<[u32; 2]> {
    let grid = Grid {
        width: size,
        depth: size,
        cells: &[],
    };
    let Some(mut walk) = grid.walk(origin, direction, f32::INFINITY) else {
        return Vec::new();
    };
    let cell = |at: usize| [at % usize::from(size), at / usize::from(size)].map(|it| it as u32);
    let mut cells = vec![cell(walk.cell())];
    while walk.step().is_some() {
        cells.push(cell(walk.cell()));
    }
    cells
}

#[test]
fn rays_of_few_digits_walk_exactly_the_cells_of_the_oracle() {
    let mut random = random("few digits");
    let mut corners = 0;
    for round in 0..20_000 {
        // With the last, products and differences still fit an f32.
        let size = [4, 16, 100, 1000][round % 4];
        let parts = [1.0, 2.0, 4.0, 16.0][round / 4 % 4];
        let mut place = || random.below(size * parts as usize) as f32 / parts;
        let origin = Vec3::new(place(), 0.0, place());
        let mut slope =
            || [0.0, -0.0, 1.0, -1.0, 2.0, 3.0, -7.0, 0.125, -0.001_953_125][random.below(9)];
        let direction = Vec3::new(slope(), 0.0, slope());
        let expected = grid::cells(&line(origin, direction), [size as u32; 2]);
        let found = walked(origin, direction, size as u16);
        assert!(found == expected, "{origin} {direction}");
        corners += expected
            .windows(3)
            .filter(|it| it[2][0] != it[0][0] && it[2][1] != it[0][1])
            .count();

        // And the same way back, from a point that is not on a border.
        let end = origin + direction * 0.125;
        let is_inside = |x: f32| x.fract() != 0.0 && x > 0.0 && x < size as f32;
        if is_inside(end.x) && is_inside(end.z) && is_inside(origin.x) && is_inside(origin.z) {
            let mut there = walked(origin, direction, size as u16);
            let mut back = walked(end, -direction, size as u16);
            let last = [end.x as u32, end.z as u32];
            let first = [origin.x as u32, origin.z as u32];
            there.truncate(1 + there.iter().position(|it| *it == last).unwrap());
            back.truncate(1 + back.iter().position(|it| *it == first).unwrap());
            back.reverse();
            assert!(there == back, "{origin} {direction}");
        }
    }
    assert!(corners > 10_000, "{corners}");
}

#[test]
fn all_other_rays_do_so_but_for_corners_within_a_rounding() {
    let mut random = random("all digits");
    for round in 0..20_000 {
        let size = [8, 100, 1000, 60_000][round % 4];
        let most = f64::from(size) - 0.01;
        let mut point = || {
            Vec3::new(
                random.between(0.0, most) as f32,
                0.0,
                random.between(0.0, most) as f32,
            )
        };
        let (origin, aim) = (point(), point());
        let aim = if round % 3 == 0 { aim.round() } else { aim };
        let direction = aim - origin;
        let ray = line(origin, direction);
        let found = walked(origin, direction, size);
        if round % 4 == 3 && round % 64 != 3 {
            continue;
        }
        let expected = grid::cells(&ray, [u32::from(size); 2]);
        for (pair, other) in found.windows(2).zip(expected.windows(2)) {
            if pair[0] == other[0] && pair[1] != other[1] {
                let band = grid::band(&ray, grid::borders_ahead(&ray, pair[0]));
                assert!(band < 1.0, "{origin} {direction}: {band} u");
            }
        }
        assert!(
            found.len().abs_diff(expected.len()) <= 1,
            "{origin} {direction}"
        );
    }
}

const SIDE: usize = 24;

/// A map with walls here and there, and around it.
fn map(random: &mut Random) -> Vec<u8> {
    let mut cells = vec![0; SIDE * SIDE];
    for (place, cell) in cells.iter_mut().enumerate() {
        let (x, z) = (place % SIDE, place / SIDE);
        let is_edge = x == 0 || z == 0 || x == SIDE - 1 || z == SIDE - 1;
        if is_edge || random.unit() < 0.15 {
            *cell = 1;
        }
    }
    cells
}

fn grid_of(cells: &[u8]) -> Grid<'_> {
    Grid {
        width: SIDE as u16,
        depth: SIDE as u16,
        cells,
    }
}

/// Puts doors between walls, or next to none, here and there, and in some cells round an eye.
fn add_doors(random: &mut Random, cells: &mut [u8], eye: [usize; 2]) -> Vec<Door> {
    let mut doors = Vec::new();
    for _ in 0..90 {
        let is_near = random.below(3) == 0;
        let mut place = |eye: usize| match is_near {
            true => eye - 3 + random.below(6),
            false => 1 + random.below(SIDE - 2),
        };
        let [x, z] = eye.map(&mut place);
        let across = [Across::X, Across::Z][random.below(2)];
        let cell = z * SIDE + x;
        let beside = if across == Across::X { SIDE } else { 1 };
        if random.below(4) > 0 {
            cells[cell - beside] = 1;
            cells[cell + beside] = 1;
        }
        cells[cell] = 2 + doors.len() as u8;
        doors.push(Door {
            kind: 1,
            across,
            open: [0.0, 0.25, 0.5, 0.75, 0.9, 1.0, random.unit() as f32][random.below(7)],
        });
    }
    doors
}

const FLOOR: Rgb888 = Rgb888::new(1, 0, 0);
const CEILING: Rgb888 = Rgb888::new(2, 0, 0);
const WALL: Rgb888 = Rgb888::new(3, 0, 0);

/// Views from an eye, along the axes and along diagonals; with few digits, so that many columns run
/// exactly through corners, or along borders.
fn views(eye: Vec3) -> Vec<View> {
    let mut views = Vec::new();
    for (x, z) in [
        (1.0, 0.0),
        (-1.0, 0.0),
        (0.0, 1.0),
        (0.0, -1.0),
        (1.0, 1.0),
        (-1.0, 1.0),
        (-1.0, -1.0),
        (1.0, -1.0),
    ] {
        let (forward, right) = (Vec3::new(x, 0.0, z), Vec3::new(-z, 0.0, x));
        // The middle column of an odd number looks straight ahead.
        for width in [16, 17] {
            let camera = Camera {
                eye,
                corner: forward - right + Vec3::Y * 0.75,
                right: right * 2.0,
                down: Vec3::NEG_Y * 1.5,
            };
            views.push(View {
                camera,
                width,
                height: 13,
            });
        }
    }
    views
}

/// How near a corner, or an edge of a door, a ray passes, in u.
fn nearest_corner<'a>(ray: &Line, plan: &impl Plan<'a>) -> f64 {
    let cells = grid::cells(ray, [SIDE as u32; 2]);
    let is_slanted = ray.direction[0] != 0.0 && ray.direction[2] != 0.0;
    let corners = (cells.iter())
        .filter(|_| is_slanted)
        .map(|&cell| grid::band(ray, grid::borders_ahead(ray, cell)));
    let panels = (cells.iter()).filter_map(|&cell| Some(panel(plan, cell)?.band(ray)));
    corners.chain(panels).fold(f64::INFINITY, f64::min)
}

fn panel<'a>(plan: &impl Plan<'a>, cell: [u32; 2]) -> Option<Panel> {
    let width = u32::from(plan.grid().width);
    let door = plan.door((cell[1] * width + cell[0]) as usize)?;
    Some(Panel {
        cell,
        across: usize::from(door.across == Across::Z),
        open: door.open,
    })
}

/// What was compared.
#[derive(Debug, Default)]
struct Compared {
    pixels: usize,
    /// Columns that show a door.
    doors: usize,
    /// Columns exactly through a corner, or along a border.
    at_corners: usize,
    /// Pixels whose traced rays meet another wall, all within a rounding of a corner.
    at_other_walls: usize,
    /// Pixels that show a wall here and the floor or the ceiling there, all where both are within a
    /// rounding.
    at_edges: usize,
}

static PLAIN: Texture<Rgb888> = Texture {
    width: 1,
    height: 1,
    texels: &[0],
    palette: &[WALL],
};

static WALLS: [[&Texture<Rgb888>; 4]; 1] = [[&PLAIN; 4]];

static STONE: Material = Material::matte(Vec3::ONE, 0.0, 1.0);

/// A map of walls that all look alike.
fn plain<'a, G>(grid: G) -> Columns<'a, Rgb888, 0, u8, G> {
    Columns {
        grid,
        walls: &WALLS,
        sprites: &[],
        floor: FLOOR,
        ceiling: CEILING,
    }
}

fn compare<'a, G: Plan<'a>>(
    columns: &'a Columns<'a, Rgb888, 0, u8, G>,
    view: &View,
    compared: &mut Compared,
) {
    let plan = columns.grid;
    let maze = Maze {
        grid: plan,
        walls: std::slice::from_ref(&STONE),
        floor: &STONE,
        ceiling: Some(&STONE),
    };
    let picture = columns.picture(view);
    let eye = view.camera.eye;
    for column in 0..view.width {
        let step = view.camera.right / view.width as f32;
        let direction = view.camera.corner + step * (column as f32 + 0.5);
        let level = Vec3::new(direction.x, 0.0, direction.z);
        let met = picture.wall(column).unwrap();
        let wall = (met.cell, met.face);
        // The very same ray.
        let hit = maze.closest_hit(&Ray::new(eye, level)).unwrap();
        assert_eq!(
            Maze::<Material>::place(hit.object),
            Some(wall),
            "{eye} {level}"
        );
        assert_eq!(hit.t, met.t);

        compared.doors += usize::from(plan.door(met.cell).is_some());
        let corner = nearest_corner(&line(eye, level), &plan);
        let along_x = level.z == 0.0 && eye.z.fract() == 0.0;
        let along_z = level.x == 0.0 && eye.x.fract() == 0.0;
        compared.at_corners += usize::from(corner == 0.0 || along_x || along_z);
        for (row, color) in picture.pixels(column).enumerate() {
            compared.pixels += 1;
            let ray = view.rays(row as u32).nth(column as usize).unwrap();
            let hit = maze.closest_hit(&ray).unwrap();
            let place = Maze::<Material>::place(hit.object).unwrap();
            let seen = match place.1 {
                Face::Floor => FLOOR,
                Face::Ceiling => CEILING,
                _ => WALL,
            };
            if seen == WALL && place != wall {
                assert!(
                    corner < 2.0,
                    "{eye} {level}, row {row}: {place:?}, {wall:?}, {corner} u"
                );
                compared.at_other_walls += 1;
            } else if seen != color {
                let down = view.camera.down.y / view.height as f32;
                let slope = view.camera.corner.y + down * (row as f32 + 0.5);
                let height = f64::from(eye.y) + f64::from(met.t) * f64::from(slope);
                let off = height.abs().min((1.0 - height).abs());
                assert!(
                    off < 1e-6 || corner < 2.0,
                    "{eye} {level}, row {row}: {}, {off}",
                    color.r()
                );
                compared.at_edges += 1;
            }
        }
    }
}

/// Views from round the corner of a cell, and one from anywhere in it, to anywhere.
fn views_near(random: &mut Random, [x, z]: [usize; 2], round: usize) -> Vec<View> {
    let (x, z) = (x as f32, z as f32);
    let eyes = [
        Vec3::new(x + 0.5, 0.5, z + 0.5),
        Vec3::new(x, 0.5, z + 0.5),
        Vec3::new(x + 0.25, 0.25, z),
        Vec3::new(x, 0.75, z),
    ];
    let mut views = views(eyes[round % 4]);
    let eye = Vec3::new(x + random.unit() as f32, 0.4, z + random.unit() as f32);
    let to = random.direction();
    let to = Vec3::new(to.0[0] as f32, 0.0, to.0[2] as f32);
    views.push(View {
        camera: Camera::look_at(eye, eye + to, Vec3::Y, 0.75, 4.0 / 3.0).unwrap(),
        width: 40,
        height: 30,
    });
    views
}

#[test]
fn columns_show_the_walls_that_traced_rays_meet() {
    let mut random = random("views");
    let mut compared = Compared::default();
    for round in 0..60 {
        let mut cells = map(&mut random);
        let (x, z) = (3 + random.below(SIDE - 6), 3 + random.below(SIDE - 6));
        // Of cells that meet at the eye all are empty.
        for place in [x, x - 1].into_iter().flat_map(|x| [[x, z], [x, z - 1]]) {
            cells[place[1] * SIDE + place[0]] = 0;
        }
        for view in views_near(&mut random, [x, z], round) {
            compare(&plain(grid_of(&cells)), &view, &mut compared);
        }
    }
    assert!(compared.at_corners > 1000, "{compared:?}");
    assert!(
        compared.at_other_walls * 100 < compared.pixels,
        "{compared:?}"
    );
}

#[test]
fn columns_show_the_doors_that_traced_rays_meet() {
    let mut random = random("doors");
    let mut compared = Compared::default();
    for round in 0..60 {
        let mut cells = map(&mut random);
        let (x, z) = (4 + random.below(SIDE - 8), 4 + random.below(SIDE - 8));
        let doors = add_doors(&mut random, &mut cells, [x, z]);
        for place in [x, x - 1].into_iter().flat_map(|x| [[x, z], [x, z - 1]]) {
            let cell = &mut cells[place[1] * SIDE + place[0]];
            // The eye may be in the cell of a door.
            *cell = if *cell == 1 { 0 } else { *cell };
        }
        let plan = DoorGrid {
            grid: grid_of(&cells),
            first: 2,
            doors: &doors,
        };
        for view in views_near(&mut random, [x, z], round) {
            compare(&plain(plan), &view, &mut compared);
        }
    }
    assert!(compared.doors > 2000, "{compared:?}");
    assert!(
        compared.at_other_walls * 100 < compared.pixels,
        "{compared:?}"
    );
}

#[test]
fn rays_meet_exactly_the_doors_of_the_oracle() {
    let mut random = random("panels");
    let (mut met_doors, mut close) = (0, 0);
    for round in 0..40_000 {
        let mut cells = map(&mut random);
        let (x, z) = (4 + random.below(SIDE - 8), 4 + random.below(SIDE - 8));
        let doors = add_doors(&mut random, &mut cells, [x, z]);
        let plan = DoorGrid {
            grid: grid_of(&cells),
            first: 2,
            doors: &doors,
        };
        // With few digits, through edges and corners exactly; or with all, towards an edge of a door.
        let is_short = round % 2 == 0;
        let origin = match is_short {
            true => [x, z].map(|it| it as f32 + random.below(8) as f32 / 8.0),
            false => [x, z].map(|it| it as f32 + random.unit() as f32),
        };
        let mut slope = || [0.0, 0.25, 0.5, -0.5, 1.0, -1.0, 2.0, -3.0][random.below(8)];
        let mut direction = [slope(), slope()];
        if !is_short {
            let panels = (0..cells.len()).filter(|&it| cells[it] >= 2);
            let steps = |it: &usize| (it % SIDE).abs_diff(x) + (it / SIDE).abs_diff(z);
            let cell = panels.min_by_key(steps).unwrap();
            let door = doors[usize::from(cells[cell]) - 2];
            let mut edge = [(cell % SIDE) as f32, (cell / SIDE) as f32];
            let across = usize::from(door.across == Across::Z);
            edge[across] += 0.5;
            edge[1 - across] += door.open;
            direction = [0, 1].map(|i| edge[i] - origin[i]);
        }
        let origin = Vec3::new(origin[0], 0.0, origin[1]);
        let direction = Vec3::new(direction[0], 0.0, direction[1]);
        let ray = line(origin, direction);
        let at = |cell: [u32; 2]| cells[cell[1] as usize * SIDE + cell[0] as usize];
        if at(grid::cell(ray.origin)) == 1 {
            continue;
        }
        let expected = grid::first(
            &ray,
            [SIDE as u32; 2],
            |cell| at(cell) == 1,
            |cell| panel(&plan, cell),
        );
        let mut walk = plan.start(origin, direction, f32::INFINITY).unwrap();
        let met = walk.next_wall();
        met_doors += usize::from(met.is_some_and(|it| plan.door(it.cell).is_some()));
        let found = met.map(|met| {
            let cell = [met.cell % SIDE, met.cell / SIDE].map(|it| it as u32);
            (
                cell,
                usize::from(!matches!(met.face, Face::West | Face::East)),
            )
        });
        if found != expected {
            let corner = nearest_corner(&ray, &plan);
            assert!(
                !is_short && corner < 1.5,
                "{origin} {direction}: {found:?}, {corner} u"
            );
            close += 1;
        }
    }
    assert!(met_doors > 5_000 && close < 500, "{met_doors} {close}");
}
