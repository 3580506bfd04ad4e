//! Doors: panels in the middle of their cells that slide aside.

use glam::Vec3;

use super::{Face, Grid, Meeting, Plan, Walk, Way};
use crate::ray::Side;

/// A panel without thickness across the middle of a cell, as in id Software's Wolfenstein 3D (1992).
///
/// It stands between two walls and slides towards +x or +z, into one of them. Its west or north edge
/// belongs to it; a ray along it does not meet it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Door {
    /// 1 and the kind of wall whose sides its own look like.
    pub kind: u8,
    /// How it stands.
    pub across: Across,
    /// By what share of its width it is open: 0 is closed, and from 1 on it is not there.
    pub open: f32,
}

/// The axis that something stands across.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Across {
    /// Its sides look to the west and to the east.
    X,
    /// Its sides look to the north and to the south.
    Z,
}

impl Door {
    /// Whether it covers a place, as a share of the cell's width from the west or the north.
    #[inline(always)]
    fn covers(&self, place: f32) -> bool {
        // A closed one leaves no gap for a place that is rounded to below 0. False for NaN.
        self.open <= 0.0 || (self.open < 1.0 && place >= self.open)
    }
}

/// A [`Grid`] some of whose cells have doors.
///
/// Who opens and closes doors keeps them in RAM: all but them stays where it is.
///
/// ```
/// use whitted::grid::{Across, Door, DoorGrid, Grid, Plan, Way};
/// use whitted::Vec3;
///
/// const MAP: Grid = Grid { width: 4, depth: 3, cells: &[1, 1, 1, 1, 1, 0, 2, 0, 1, 1, 1, 1] };
/// let mut doors = [Door { kind: 1, across: Across::X, open: 0.0 }];
/// let to_the_east = |doors: &[Door]| {
///     let map = DoorGrid { grid: MAP, first: 2, doors };
///     let mut walk = map.start(Vec3::new(1.5, 0.0, 1.25), Vec3::X, f32::INFINITY).unwrap();
///     walk.next_wall().map(|it| it.t)
/// };
/// assert_eq!(to_the_east(&doors), Some(1.0));
/// doors[0].open = 0.5;
/// assert_eq!(to_the_east(&doors), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoorGrid<'a> {
    /// The map.
    pub grid: Grid<'a>,
    /// What is in cells with the first door; from 1. Greater numbers are those of the next ones; where all
    /// that a byte tells are walls it is 256.
    pub first: u16,
    /// Those that the slice lacks are empty cells.
    pub doors: &'a [Door],
}

/// What is in a cell.
enum Content<'a> {
    Empty,
    Solid,
    Door(&'a Door),
}

impl<'a> DoorGrid<'a> {
    #[inline(always)]
    fn content(&self, cell: usize) -> Content<'a> {
        match self.grid.kind(cell) {
            0 => Content::Empty,
            it => match u16::from(it).checked_sub(self.first) {
                None => Content::Solid,
                Some(door) => match self.doors.get(door as usize) {
                    None => Content::Empty,
                    Some(door) => Content::Door(door),
                },
            },
        }
    }
}

impl<'a> Plan<'a> for DoorGrid<'a> {
    type Walk = DoorWalk<'a>;

    #[inline(always)]
    fn grid(&self) -> &Grid<'a> {
        &self.grid
    }

    #[inline(always)]
    fn kind(&self, cell: usize) -> u8 {
        match self.content(cell) {
            Content::Empty => 0,
            Content::Solid => self.grid.kind(cell),
            Content::Door(door) => door.kind,
        }
    }

    #[inline(always)]
    fn door(&self, cell: usize) -> Option<&'a Door> {
        match self.content(cell) {
            Content::Door(door) => Some(door),
            _ => None,
        }
    }

    #[inline]
    fn start(&self, origin: Vec3, direction: Vec3, t_max: f32) -> Option<DoorWalk<'a>> {
        Some(DoorWalk {
            plan: *self,
            walk: self.grid.walk(origin, direction, t_max)?,
            entry: Some(Entry::Start),
        })
    }

    #[inline]
    fn leave(
        &self,
        (cell, face, side): (usize, Face, Side),
        origin: Vec3,
        direction: Vec3,
        t_max: f32,
    ) -> Option<DoorWalk<'a>> {
        let is_panel = self.door(cell).is_some() && !matches!(face, Face::Floor | Face::Ceiling);
        // Both sides of a panel are in its cell.
        let side = if is_panel { Side::Inside } else { side };
        let left = (cell, face, side);
        Some(DoorWalk {
            plan: *self,
            walk: self.grid.walk_from(left, origin, direction, t_max)?,
            entry: (!is_panel).then_some(Entry::Start),
        })
    }
}

/// How a cell was entered.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Entry {
    Start,
    Over(Across),
}

/// A ray on its way over a [`DoorGrid`].
///
/// A panel is met by the rules of the borders, see [`Walk`].
#[derive(Clone, Copy, Debug)]
pub struct DoorWalk<'a> {
    plan: DoorGrid<'a>,
    walk: Walk<'a>,
    /// Of the cell where it is; `None` if it has met, or leaves, the panel there.
    entry: Option<Entry>,
}

impl DoorWalk<'_> {
    /// Where the ray meets the panel of the cell where it is.
    #[inline]
    fn panel(&self, door: &Door, entry: Entry) -> Option<Meeting> {
        let Walk { x, z, .. } = &self.walk;
        let is_across_x = door.across == Across::X;
        let (axis, along) = if is_across_x { (x, z) } else { (z, x) };
        let middle = axis.border - 0.5 * axis.step;
        // No number where it runs along the panel, and then before nothing.
        let t = (middle - axis.origin) / axis.direction;
        // As [`Walk::x_is_next`] says it.
        let wins = (x.direction > 0.0) == is_across_x;
        let is_before = |border: f32| t < border || (t == border && wins);
        let is_behind = match entry {
            Entry::Start if axis.direction > 0.0 => axis.origin >= middle,
            Entry::Start => axis.origin < middle,
            Entry::Over(across) if across == door.across => false,
            Entry::Over(_) => {
                is_before((along.border - along.step - along.origin) / along.direction)
            }
        };
        if axis.direction == 0.0 || is_behind || !is_before(along.t) {
            return None;
        }
        let t = if t > 0.0 { t } else { f32::MIN_POSITIVE };
        // In the cell that it is in: rounding may put the point into the next.
        let start = along.border - (0.5 + 0.5 * along.step);
        let place = (along.origin - start) + t * along.direction;
        let face = match (door.across, axis.direction > 0.0) {
            (Across::X, true) => Face::West,
            (Across::X, false) => Face::East,
            (Across::Z, true) => Face::North,
            (Across::Z, false) => Face::South,
        };
        let cell = self.walk.cell;
        (t < self.walk.t_max && door.covers(place)).then_some(Meeting { t, cell, face })
    }
}

impl Way for DoorWalk<'_> {
    #[inline(always)]
    fn cell(&self) -> usize {
        self.walk.cell
    }

    #[inline(always)]
    fn ends_here(&self) -> bool {
        self.walk.ends_here()
    }

    #[inline]
    fn next_wall(&mut self) -> Option<Meeting> {
        loop {
            let from = self.walk.cell;
            let content = self.plan.content(from);
            if let (Content::Door(door), Some(entry)) = (&content, self.entry.take())
                && let Some(met) = self.panel(door, entry)
            {
                return Some(met);
            }
            let from_solid = matches!(content, Content::Solid);
            let (t, face) = self.walk.step()?;
            let across = match face {
                Face::West | Face::East => Across::X,
                _ => Across::Z,
            };
            self.entry = Some(Entry::Over(across));
            let is_solid = matches!(self.plan.content(self.walk.cell), Content::Solid);
            if is_solid != from_solid {
                let (cell, face) = if from_solid {
                    (from, face.opposite())
                } else {
                    (self.walk.cell, face)
                };
                return Some(Meeting { t, cell, face });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::numbers;

    fn at(x: f32, z: f32) -> Vec3 {
        Vec3::new(x, 0.0, z)
    }

    /// A passage to the east with a door in its middle, and the same to the south.
    const PASSAGES: [(Across, Grid); 2] = [
        (
            Across::X,
            Grid {
                width: 5,
                depth: 3,
                cells: &[1, 1, 1, 1, 1, 1, 0, 2, 0, 1, 1, 1, 1, 1, 1],
            },
        ),
        (
            Across::Z,
            Grid {
                width: 3,
                depth: 5,
                cells: &[1, 1, 1, 1, 0, 1, 1, 2, 1, 1, 0, 1, 1, 1, 1],
            },
        ),
    ];

    /// In the passage to the east.
    type Found = Option<(f32, [usize; 2], Face)>;

    /// The first that a ray meets in both passages; what it meets in the other one, as seen in the first.
    fn first(open: f32, origin: Vec3, direction: Vec3, t_max: f32) -> [Found; 2] {
        PASSAGES.map(|(across, grid)| {
            let doors = [Door {
                kind: 1,
                across,
                open,
            }];
            let plan = DoorGrid {
                grid,
                first: 2,
                doors: &doors,
            };
            let is_east = across == Across::X;
            let turned = |v: Vec3| if is_east { v } else { at(v.z, v.x) };
            let mut walk = plan.start(turned(origin), turned(direction), t_max)?;
            let met = walk.next_wall()?;
            let width = usize::from(grid.width);
            let (x, z) = (met.cell % width, met.cell / width);
            let back = |face: Face| Face::ALL[face as usize ^ 2];
            Some(match is_east {
                true => (met.t, [x, z], met.face),
                false => (met.t, [z, x], back(met.face)),
            })
        })
    }

    #[test]
    fn panels_are_met_in_the_middle_of_their_cells_where_they_are_not_open() {
        let door = |t, face| Some((t, [2, 1], face));
        let (east, west) = (Vec3::X, Vec3::NEG_X);
        let least = f32::MIN_POSITIVE;
        let below_half = 1.5 - f32::EPSILON;
        let far = |t| Some((t, [4, 1], Face::West));
        let cases = [
            ("closed", 0.0, at(1.5, 1.5), east, door(1.0, Face::West)),
            (
                "from behind",
                0.0,
                at(3.5, 1.25),
                west,
                door(1.0, Face::East),
            ),
            (
                "of any length",
                0.0,
                at(1.5, 1.5),
                east * 4.0,
                door(0.25, Face::West),
            ),
            ("half open, beside", 0.5, at(1.5, 1.25), east, far(2.5)),
            (
                "half open, its edge",
                0.5,
                at(1.5, 1.5),
                east,
                door(1.0, Face::West),
            ),
            (
                "just beside its edge",
                0.5,
                at(1.5, below_half),
                east,
                far(2.5),
            ),
            (
                "half open, the panel",
                0.5,
                at(1.5, 1.75),
                east,
                door(1.0, Face::West),
            ),
            ("open", 1.0, at(1.5, 1.999), east, far(2.5)),
            ("more than open", 7.0, at(1.5, 1.5), east, far(2.5)),
            (
                "less than closed",
                -0.5,
                at(1.5, 1.01),
                east,
                door(1.0, Face::West),
            ),
            ("no number", f32::NAN, at(1.5, 1.5), east, far(2.5)),
            (
                "in its cell, before it",
                0.0,
                at(2.25, 1.5),
                east,
                door(0.25, Face::West),
            ),
            (
                "in its cell, beyond it",
                0.0,
                at(2.75, 1.5),
                east,
                far(1.25),
            ),
            (
                "in its cell, back",
                0.0,
                at(2.75, 1.5),
                west,
                door(0.25, Face::East),
            ),
            (
                "in the panel, which is shifted away",
                0.0,
                at(2.5, 1.5),
                east,
                far(1.5),
            ),
            (
                "in the panel, back",
                0.0,
                at(2.5, 1.5),
                west,
                door(least, Face::East),
            ),
            (
                "along the panel",
                0.0,
                at(2.5, 1.5),
                at(0.0, 1.0),
                Some((0.5, [2, 2], Face::North)),
            ),
            (
                "beside the panel",
                0.0,
                at(2.25, 1.5),
                at(0.0, -1.0),
                Some((0.5, [2, 0], Face::South)),
            ),
            (
                "through the gap at an angle, to the side of the cell",
                0.5,
                at(2.0, 1.5),
                at(1.0, -0.625),
                Some((0.8, [2, 0], Face::South)),
            ),
            (
                "through the edge at an angle",
                0.5,
                at(2.0, 1.75),
                at(1.0, -0.5),
                door(0.5, Face::West),
            ),
            (
                "the wall before the panel",
                0.0,
                at(2.0, 1.5),
                at(1.0, 2.0),
                Some((0.25, [2, 2], Face::North)),
            ),
        ];
        for (name, open, origin, direction, expected) in cases {
            let found = first(open, origin, direction, f32::INFINITY);
            assert_eq!(found, [expected; 2], "{name}");
            if let Some((t, ..)) = expected {
                let short = first(open, origin, direction, t);
                assert_eq!(short, [None; 2], "{name}: the interval is open");
            }
        }
    }

    #[test]
    fn what_rounding_puts_beside_the_cell_meets_closed_doors_and_no_open_ones() {
        let covers = |open, place| {
            let (kind, across) = (1, Across::X);
            Door { kind, across, open }.covers(place)
        };
        assert!(covers(0.0, -f32::EPSILON) && covers(0.0, 1.0 + f32::EPSILON));
        assert!(!covers(1.0, 1.0) && !covers(1.0, 1.0 + f32::EPSILON));
        assert!(!covers(0.25, -f32::EPSILON) && covers(0.25, 1.0 + f32::EPSILON));
    }

    #[test]
    fn where_panel_and_wall_meet_the_rule_of_corners_holds() {
        let panel = |face| Some((0.5, [2, 1], face));
        let wall = |z, face| Some((0.5, [2, z], face));
        // The passage to the south sees these rays turned: there the other one is first.
        let cases = [
            (
                at(2.0, 1.5),
                at(1.0, 1.0),
                [panel(Face::West), wall(2, Face::North)],
            ),
            (
                at(2.0, 1.5),
                at(1.0, -1.0),
                [panel(Face::West), panel(Face::West)],
            ),
            (
                at(3.0, 1.5),
                at(-1.0, 1.0),
                [wall(2, Face::North), wall(2, Face::North)],
            ),
            (
                at(3.0, 1.5),
                at(-1.0, -1.0),
                [wall(0, Face::South), panel(Face::East)],
            ),
        ];
        for (origin, direction, expected) in cases {
            let found = first(0.0, origin, direction, f32::INFINITY);
            assert_eq!(found, expected, "{origin} {direction}");
        }
    }

    #[test]
    fn closed_doors_let_nothing_through() {
        // From the room between two doors, to their edges, corners and beyond.
        let doors = [Across::X, Across::Z].map(|across| Door {
            kind: 1,
            across,
            open: 0.0,
        });
        let plan = DoorGrid {
            grid: Grid {
                width: 5,
                depth: 5,
                cells: &[
                    0, 0, 0, 0, 0, //
                    0, 1, 3, 1, 0, //
                    0, 2, 0, 2, 0, //
                    0, 1, 3, 1, 0, //
                    0, 0, 0, 0, 0,
                ],
            },
            first: 2,
            doors: &doors,
        };
        let mut numbers = numbers(7);
        let mut next = || 0.5 + 0.5 * numbers.next().unwrap();
        let mut at_edges = 0;
        for round in 0..60_000 {
            let origin = match round % 3 {
                0 => at(2.0 + next(), 2.0 + next()),
                1 => at(1.5 + 2.0 * next(), 2.0 + next()),
                _ => at(
                    2.0 + (8.0 * next()) as u8 as f32 / 8.0,
                    2.0 + (8.0 * next()) as u8 as f32 / 8.0,
                ),
            };
            let edge = [
                at(1.5, 2.0),
                at(1.5, 3.0),
                at(3.5, 2.0),
                at(3.0, 1.5),
                at(2.0, 3.5),
            ];
            let direction = match round % 2 {
                0 => (edge[round % 5] - origin) * (0.001 + next()),
                _ => at(next() - 0.5, next() - 0.5),
            };
            if direction == Vec3::ZERO {
                continue;
            }
            let mut walk = plan.start(origin, direction, f32::INFINITY).unwrap();
            let met = walk.next_wall();
            let met = met.unwrap_or_else(|| panic!("{origin} {direction}"));
            let point = origin + direction * met.t;
            let off = (point - at(2.5, 2.5)).abs().max_element();
            assert!(off < 1.0 + 1e-6, "{origin} {direction}: {met:?}");
            at_edges += usize::from(off > 1.0 - 1e-6);
        }
        assert!(at_edges > 10_000, "{at_edges}");
    }

    #[test]
    fn no_number_is_a_surprise() {
        let numbers = [
            0.0,
            -0.0,
            1.0,
            2.5,
            -2.5,
            1e-45,
            -1e-38,
            3e38,
            -3e38,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::NAN,
        ];
        let (across, grid) = PASSAGES[0];
        for open in numbers {
            // One of them is not there, and the first one is in a cell of 2.
            for first in [0, 1, 2, 3, 255] {
                let doors = [Door {
                    kind: 9,
                    across,
                    open,
                }];
                let plan = DoorGrid {
                    grid,
                    first,
                    doors: &doors,
                };
                for place in 0..numbers.len().pow(4) {
                    let number = |i: u32| numbers[place / numbers.len().pow(i) % numbers.len()];
                    let (origin, direction) = (at(number(0), number(1)), at(number(2), number(3)));
                    let Some(mut walk) = plan.start(origin, direction, f32::INFINITY) else {
                        continue;
                    };
                    let mut steps = 0;
                    while let Some(met) = walk.next_wall() {
                        assert!(met.t > 0.0, "{origin} {direction} {open}");
                        steps += 1;
                    }
                    assert!(steps < 10, "{origin} {direction} {open}");
                }
            }
        }
    }
}
