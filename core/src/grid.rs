//! Maps of square cells, empty or solid, and the walk of rays from cell to cell.

use glam::Vec3;

use crate::ray::Side;

pub use doors::{Across, Door, DoorGrid, DoorWalk};

mod doors;

/// A map: cells of 1 by 1, from x = 0 and z = 0 on, seen from above with +x to the right and +z down.
///
/// Cells may be in flash, or in RAM, where a program may change them. With doors it is a [`DoorGrid`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid<'a> {
    /// Cells along x.
    pub width: u16,
    /// Cells along z.
    pub depth: u16,
    /// Row after row, each along x: 0 where a cell is empty, else 1 and the kind of wall. What the
    /// slice lacks is empty.
    pub cells: &'a [u8],
}

/// A side of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Face {
    /// Towards -x.
    West,
    /// Towards +x.
    East,
    /// Towards -z.
    North,
    /// Towards +z.
    South,
    /// At the height of 0.
    Floor,
    /// At the height of 1.
    Ceiling,
}

impl Face {
    /// All, in the order in which they are numbered.
    pub const ALL: [Self; 6] = [
        Self::West,
        Self::East,
        Self::North,
        Self::South,
        Self::Floor,
        Self::Ceiling,
    ];

    /// The side of the neighbor that is the same wall.
    #[inline(always)]
    pub fn opposite(self) -> Self {
        Self::ALL.get(self as usize ^ 1).copied().unwrap_or(self)
    }

    /// Out of a solid cell; of floors and ceilings, into the room between them.
    #[inline]
    pub fn normal(self) -> Vec3 {
        // A table, where a `match` may become a jump of which tools cannot tell where it leads.
        const NORMALS: [Vec3; 6] = [
            Vec3::NEG_X,
            Vec3::X,
            Vec3::NEG_Z,
            Vec3::Z,
            Vec3::Y,
            Vec3::NEG_Y,
        ];
        NORMALS.get(self as usize).copied().unwrap_or(Vec3::ZERO)
    }
}

/// Where a ray passes between an empty and a solid cell, or meets a door.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// In lengths of the direction; above 0.
    pub t: f32,
    /// The solid cell's, or the door's, place among [`Grid::cells`].
    pub cell: usize,
    /// The side of it; of a door the one from which the ray comes.
    pub face: Face,
}

/// A map that rays walk over: a [`Grid`], or one with doors. What a map's type does not have is not
/// compiled.
pub trait Plan<'a>: Copy {
    /// A ray on its way.
    type Walk: Way;

    /// Its size and its cells.
    fn grid(&self) -> &Grid<'a>;

    /// What a wall or a door looks like: 1 and the kind of wall; 0 of an empty cell.
    fn kind(&self, cell: usize) -> u8;

    /// The door in a cell.
    fn door(&self, cell: usize) -> Option<&'a Door>;

    /// As [`Grid::walk`].
    fn start(&self, origin: Vec3, direction: Vec3, t_max: f32) -> Option<Self::Walk>;

    /// The same from a side of a cell, or of a door, and not from where rounding has put the point.
    fn leave(
        &self,
        left: (usize, Face, Side),
        origin: Vec3,
        direction: Vec3,
        t_max: f32,
    ) -> Option<Self::Walk>;

    /// How far from the left edge of a side, seen from outside, a point on it is. The point is told as it
    /// lies in the cell.
    #[inline(always)]
    fn across(&self, (cell, face): (usize, Face), from_west: f32, from_north: f32) -> f32 {
        let (from_west, from_north) = match self.door(cell) {
            // A door takes along what it shows; less than closed is closed.
            Some(door) => {
                let open = door.open.max(0.0);
                (from_west - open, from_north - open)
            }
            None => (from_west, from_north),
        };
        match face {
            Face::West => from_north,
            Face::East => 1.0 - from_north,
            Face::North => 1.0 - from_west,
            _ => from_west,
        }
    }
}

/// A ray on its way over a [`Plan`].
pub trait Way {
    /// As [`Walk::cell`].
    fn cell(&self) -> usize;

    /// As [`Walk::ends_here`].
    fn ends_here(&self) -> bool;

    /// As [`Walk::next_wall`], or the next door, if that is nearer.
    fn next_wall(&mut self) -> Option<Meeting>;
}

impl<'a> Plan<'a> for Grid<'a> {
    type Walk = Walk<'a>;

    #[inline(always)]
    fn grid(&self) -> &Grid<'a> {
        self
    }

    #[inline(always)]
    fn kind(&self, cell: usize) -> u8 {
        Grid::kind(self, cell)
    }

    #[inline(always)]
    fn door(&self, _: usize) -> Option<&'a Door> {
        None
    }

    #[inline(always)]
    fn start(&self, origin: Vec3, direction: Vec3, t_max: f32) -> Option<Walk<'a>> {
        self.walk(origin, direction, t_max)
    }

    #[inline(always)]
    fn leave(
        &self,
        left: (usize, Face, Side),
        origin: Vec3,
        direction: Vec3,
        t_max: f32,
    ) -> Option<Walk<'a>> {
        self.walk_from(left, origin, direction, t_max)
    }
}

impl Way for Walk<'_> {
    #[inline(always)]
    fn cell(&self) -> usize {
        Walk::cell(self)
    }

    #[inline(always)]
    fn ends_here(&self) -> bool {
        Walk::ends_here(self)
    }

    #[inline(always)]
    fn next_wall(&mut self) -> Option<Meeting> {
        Walk::next_wall(self)
    }
}

impl<'a> Grid<'a> {
    /// What is at this place among the cells: 0 for an empty cell, else 1 and the kind of wall.
    #[inline(always)]
    pub fn kind(&self, cell: usize) -> u8 {
        self.cells.get(cell).copied().unwrap_or(0)
    }

    /// How many cells there are.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.width as usize * self.depth as usize
    }

    /// Whether there are none.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Walks from a point of the map; `None` from outside of it. Only x and z count. `direction` is of
    /// any length, in which t and `t_max` are counted.
    ///
    /// A point on a border lies in the cell towards +x or +z of it.
    ///
    /// ```
    /// use whitted::grid::{Face, Grid};
    /// use whitted::Vec3;
    ///
    /// let grid = Grid { width: 4, depth: 1, cells: &[0, 0, 0, 1] };
    /// let mut walk = grid.walk(Vec3::new(0.5, 0.0, 0.5), Vec3::X, f32::INFINITY).unwrap();
    /// let met = walk.next_wall().unwrap();
    /// assert_eq!((met.t, met.cell, met.face), (2.5, 3, Face::West));
    /// ```
    #[inline]
    pub fn walk(&self, origin: Vec3, direction: Vec3, t_max: f32) -> Option<Walk<'a>> {
        // False for NaN.
        let x = (origin.x >= 0.0 && origin.x < self.width as f32).then_some(origin.x as u16)?;
        let z = (origin.z >= 0.0 && origin.z < self.depth as f32).then_some(origin.z as u16)?;
        Walk::new(self, [x, z], origin, direction, t_max)
    }

    /// As [`walk`](Self::walk), from a side of a cell and not from where rounding has put the point.
    #[inline]
    pub(crate) fn walk_from(
        &self,
        (cell, face, side): (usize, Face, Side),
        origin: Vec3,
        direction: Vec3,
        t_max: f32,
    ) -> Option<Walk<'a>> {
        let width = self.width as usize;
        let (x, z) = (cell.checked_rem(width)? as u16, cell.checked_div(width)?);
        let (x, z) = match side {
            Side::Outside => {
                let [east, south] = *NEIGHBORS.get(face as usize)?;
                (
                    x.checked_add_signed(east)?,
                    z.checked_add_signed(south.into())?,
                )
            }
            Side::Inside => (x, z),
        };
        let is_inside = x < self.width && z < self.depth as usize;
        if is_inside {
            Walk::new(self, [x, z as u16], origin, direction, t_max)
        } else {
            None
        }
    }
}

/// The way through each face to the next cell, along x and z.
const NEIGHBORS: [[i16; 2]; 6] = [[-1, 0], [1, 0], [0, -1], [0, 1], [0, 0], [0, 0]];

/// A ray on its way from cell to cell.
///
/// J. Amanatides and A. Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", Eurographics 1987; but
/// the distance to each border is computed from the border, not summed up.
///
/// A ray through a corner or along a border is taken as if it were shifted towards +x by a distance that
/// is infinitely small, and towards +z by one that is infinitely smaller still: H. Edelsbrunner and
/// E. P. Mücke, "Simulation of Simplicity", ACM Transactions on Graphics 9(1), 1990. A shifted ray meets
/// no corner, so none slips between two walls that touch there, and the ray in the opposite direction
/// takes the same way back. Borders whose distances round to the same number count as a corner.
#[derive(Clone, Copy, Debug)]
pub struct Walk<'a> {
    grid: Grid<'a>,
    x: Axis,
    z: Axis,
    cell: usize,
    t_max: f32,
}

/// The borders across one axis.
#[derive(Clone, Copy, Debug)]
struct Axis {
    origin: f32,
    direction: f32,
    /// The next one, and how far it is.
    border: f32,
    t: f32,
    step: f32,
    stride: isize,
    /// Cells beyond it.
    left: u16,
}

impl Axis {
    #[inline(always)]
    fn new(origin: f32, direction: f32, cell: u16, count: u16, stride: usize) -> Self {
        let stride = stride as isize;
        let (border, step, stride, left) = if direction > 0.0 {
            let left = count.wrapping_sub(1).wrapping_sub(cell);
            (cell as f32 + 1.0, 1.0, stride, left)
        } else {
            (cell as f32, -1.0, -stride, cell)
        };
        Self {
            origin,
            direction,
            border,
            t: if direction != 0.0 {
                (border - origin) / direction
            } else {
                f32::INFINITY
            },
            step,
            stride,
            left,
        }
    }

    /// A border on which the ray starts, or behind which rounding has put its origin, is met at once.
    #[inline(always)]
    fn distance(&self) -> f32 {
        if self.t > 0.0 {
            self.t
        } else {
            f32::MIN_POSITIVE
        }
    }
}

impl<'a> Walk<'a> {
    /// `None` where the direction is not a number.
    #[inline(always)]
    fn new(
        grid: &Grid<'a>,
        [x, z]: [u16; 2],
        origin: Vec3,
        direction: Vec3,
        t_max: f32,
    ) -> Option<Self> {
        if (direction.x + direction.z).is_nan() {
            return None;
        }
        let width = grid.width as usize;
        Some(Self {
            grid: *grid,
            x: Axis::new(origin.x, direction.x, x, grid.width, 1),
            z: Axis::new(origin.z, direction.z, z, grid.depth, width),
            cell: z as usize * width + x as usize,
            t_max,
        })
    }

    /// Where it is, as a place among [`Grid::cells`].
    #[inline(always)]
    pub fn cell(&self) -> usize {
        self.cell
    }

    #[inline(always)]
    fn x_is_next(&self) -> bool {
        self.x.t < self.z.t || (self.x.t == self.z.t && self.x.direction > 0.0)
    }

    /// Whether the ray ends in the cell where it is.
    #[inline(always)]
    pub fn ends_here(&self) -> bool {
        let axis = if self.x_is_next() { &self.x } else { &self.z };
        !(axis.distance() < self.t_max)
    }

    /// Passes a border: its distance, and the side on which the next cell is entered. `None` where the
    /// ray ends, or leaves the map.
    #[inline(always)]
    pub fn step(&mut self) -> Option<(f32, Face)> {
        let (axis, forwards, backwards) = if self.x_is_next() {
            (&mut self.x, Face::West, Face::East)
        } else {
            (&mut self.z, Face::North, Face::South)
        };
        let t = axis.distance();
        if !(t < self.t_max) || axis.left == 0 {
            return None;
        }
        let face = if axis.direction > 0.0 {
            forwards
        } else {
            backwards
        };
        axis.left -= 1;
        axis.border += axis.step;
        axis.t = (axis.border - axis.origin) / axis.direction;
        self.cell = self.cell.wrapping_add_signed(axis.stride);
        Some((t, face))
    }

    /// The next passage between an empty and a solid cell, in either direction. At most as many steps
    /// as the map is wide and deep.
    #[inline]
    pub fn next_wall(&mut self) -> Option<Meeting> {
        let from_solid = self.grid.kind(self.cell) != 0;
        loop {
            let from = self.cell;
            let (t, face) = self.step()?;
            if (self.grid.kind(self.cell) != 0) != from_solid {
                let (cell, face) = if from_solid {
                    (from, face.opposite())
                } else {
                    (self.cell, face)
                };
                return Some(Meeting { t, cell, face });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f32, z: f32) -> Vec3 {
        Vec3::new(x, 0.0, z)
    }

    /// Cells on the way of a ray over an empty map of 4 by 4, as rows of a picture.
    fn way(origin: Vec3, direction: Vec3) -> [[u8; 4]; 4] {
        let grid = Grid {
            width: 4,
            depth: 4,
            cells: &[],
        };
        let mut picture = [*b"...."; 4];
        let mut walk = grid.walk(origin, direction, f32::INFINITY).unwrap();
        for number in b'0'.. {
            picture[walk.cell() / 4][walk.cell() % 4] = number;
            if walk.step().is_none() {
                break;
            }
        }
        picture
    }

    #[test]
    fn rays_through_corners_and_along_borders_are_shifted_to_the_east_and_less_to_the_south() {
        let cases = [
            (
                "no corner",
                (at(0.5, 0.5), at(1.0, 0.4)),
                [b"01..", b".234", b"....", b"...."],
            ),
            (
                "south-east",
                (at(0.5, 0.5), at(1.0, 1.0)),
                [b"01..", b".23.", b"..45", b"...6"],
            ),
            (
                "north-west",
                (at(3.5, 3.5), at(-1.0, -1.0)),
                [b"65..", b".43.", b"..21", b"...0"],
            ),
            (
                "north-east",
                (at(0.5, 3.5), at(1.0, -1.0)),
                [b"...6", b"..45", b".23.", b"01.."],
            ),
            (
                "south-west",
                (at(3.5, 0.5), at(-1.0, 1.0)),
                [b"...0", b"..21", b".43.", b"65.."],
            ),
            (
                "along a border south",
                (at(2.0, 0.5), at(0.0, 1.0)),
                [b"..0.", b"..1.", b"..2.", b"..3."],
            ),
            (
                "along a border west",
                (at(3.5, 2.0), at(-1.0, 0.0)),
                [b"....", b"....", b"3210", b"...."],
            ),
            (
                "negative zero",
                (at(3.5, 2.0), at(-1.0, -0.0)),
                [b"....", b"....", b"3210", b"...."],
            ),
            (
                "from a border west",
                (at(2.0, 1.5), at(-1.0, 0.0)),
                [b"....", b"210.", b"....", b"...."],
            ),
            (
                "from a corner",
                (at(2.0, 2.0), at(-1.0, -1.0)),
                [b"43..", b".21.", b"..0.", b"...."],
            ),
            (
                "nowhere",
                (at(1.5, 1.5), at(0.0, 0.0)),
                [b"....", b".0..", b"....", b"...."],
            ),
        ];
        for (name, (origin, direction), expected) in cases {
            assert_eq!(way(origin, direction), expected.map(|row| *row), "{name}");
        }
    }

    #[test]
    fn no_ray_slips_between_walls_that_touch_at_a_corner() {
        // A ring of eight walls of which four touch the others at corners only.
        let grid = Grid {
            width: 5,
            depth: 5,
            cells: b"\0\x01\x01\x01\0\x01\0\0\0\x01\x01\0\0\0\x01\x01\0\0\0\x01\0\x01\x01\x01\0",
        };
        let mut numbers = crate::random::numbers(1);
        let mut next = || 0.5 + 0.5 * numbers.next().unwrap();
        for round in 0..40_000 {
            let origin = at(1.0 + 3.0 * next(), 1.0 + 3.0 * next());
            let corner = [at(1.0, 1.0), at(4.0, 1.0), at(1.0, 4.0), at(4.0, 4.0)][round % 4];
            let direction = (corner - origin) * (0.001 + next());
            let mut walk = grid.walk(origin, direction, f32::INFINITY).unwrap();
            let met = walk.next_wall().expect("a wall");
            assert_eq!(grid.kind(met.cell), 1, "{origin} {direction}");
        }
    }

    #[test]
    fn walls_are_met_from_outside_and_left_from_inside() {
        let grid = Grid {
            width: 5,
            depth: 1,
            cells: &[0, 1, 2, 0, 1],
        };
        let mut walk = grid.walk(at(0.5, 0.5), Vec3::X, f32::INFINITY).unwrap();
        let mut met = || walk.next_wall().map(|it| (it.t, it.cell, it.face));
        assert_eq!(met(), Some((0.5, 1, Face::West)));
        // Walls of two kinds that stand together have no surface between them.
        assert_eq!(met(), Some((2.5, 2, Face::East)));
        assert_eq!(met(), Some((3.5, 4, Face::West)));
        assert_eq!(met(), None);
        assert!(!walk.ends_here(), "it left the map");
        let mut short = grid.walk(at(0.5, 0.5), Vec3::X, 2.5).unwrap();
        assert!(short.next_wall().is_some());
        assert!(short.next_wall().is_none(), "the interval is open");
        assert!(short.ends_here());
        assert_eq!(short.cell(), 2);
    }

    #[test]
    fn every_number_ends_the_walk_in_time() {
        let numbers = [
            0.0,
            -0.0,
            1.0,
            -1.0,
            2.5,
            1e-45,
            1e-38,
            3e38,
            16_777_216.0,
            65_535.0,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::NAN,
        ];
        let grid = Grid {
            width: u16::MAX,
            depth: u16::MAX,
            cells: &[],
        };
        for x in numbers {
            for z in numbers {
                for dx in numbers {
                    for dz in numbers {
                        let walk = grid.walk(at(x, z), at(dx, dz), f32::INFINITY);
                        let Some(mut walk) = walk else { continue };
                        let mut steps = 0;
                        while walk.step().is_some() {
                            steps += 1;
                        }
                        assert!(steps < 2 * 65_535, "{x} {z} {dx} {dz}");
                        assert!(walk.step().is_none());
                    }
                }
            }
        }
        assert!(
            Grid { width: 0, ..grid }
                .walk(Vec3::ZERO, Vec3::X, 1.0)
                .is_none()
        );
    }
}
