//! A [`Grid`] as a geometry: walls, floor and ceiling for rays in all directions.

use glam::Vec3;

use crate::candidates::Candidates;
use crate::geometry::Geometry;
use crate::grid::{Face, Grid, Plan, Way};
use crate::material::{Finish, Material};
use crate::math::{Math, Passage};
use crate::ray::{Departure, Ray};

/// The walls of a map, from its floor at y = 0 to its ceiling at y = 1.
///
/// A map is seen from inside: a ray that starts above, below or beside it meets nothing. Surfaces are
/// the sides between empty and solid cells, and the floor and the ceiling of all cells; a ray that is
/// inside of a wall meets its sides from there. Of equally near ones the floor or ceiling comes first.
///
/// It may be paired with other geometries, whose lengths then count in cells.
///
/// The generic parameters are the material; what the sides of a kind of wall have, [one](Sides) or four;
/// and the map: a [`Grid`], or a [`DoorGrid`](crate::grid::DoorGrid). A door has no thickness: its glass
/// neither bends nor absorbs light.
///
/// ```
/// use whitted::grid::Grid;
/// use whitted::{Geometry, Material, Maze, Ray, Vec3};
///
/// static STONE: Material = Material::matte(Vec3::ONE, 0.1, 0.9);
/// static MAZE: Maze = Maze {
///     grid: Grid { width: 4, depth: 1, cells: &[0, 0, 0, 1] },
///     walls: &[STONE],
///     floor: &STONE,
///     ceiling: None,
/// };
/// let hit = MAZE.closest_hit(&Ray::new(Vec3::new(0.5, 0.5, 0.5), Vec3::X)).unwrap();
/// assert_eq!((hit.t, hit.normal), (2.5, Vec3::NEG_X));
/// ```
#[derive(Debug, PartialEq)]
pub struct Maze<'a, M = Material, W = M, G = Grid<'a>> {
    /// The map.
    pub grid: G,
    /// What walls are made of, by kind; a wall of a kind without material is not met.
    pub walls: &'a [W],
    /// What the floor is made of.
    pub floor: &'a M,
    /// What the ceiling is made of; `None` where the map is open above.
    pub ceiling: Option<&'a M>,
}

impl<M, W, G: Copy> Clone for Maze<'_, M, W, G> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<M, W, G: Copy> Copy for Maze<'_, M, W, G> {}

/// What the sides of a kind of wall are made of: one material, or four.
pub trait Sides<M> {
    /// That of a side.
    fn side(&self, face: Face) -> &M;
}

impl<M> Sides<M> for M {
    #[inline(always)]
    fn side(&self, _: Face) -> &M {
        self
    }
}

/// To the west, east, north and south.
impl<M> Sides<M> for [M; 4] {
    #[inline(always)]
    fn side(&self, face: Face) -> &M {
        self.get(face as usize).unwrap_or(&self[0])
    }
}

/// To the west, east, north and south, of materials that walls share.
impl<M> Sides<M> for [&M; 4] {
    #[inline(always)]
    fn side(&self, face: Face) -> &M {
        self.get(face as usize).unwrap_or(&self[0])
    }
}

/// Sides of a cell.
const FACES: usize = Face::ALL.len();

impl<M> Maze<'_, M> {
    /// The cell, as a place among [`Grid::cells`], and its side, of an object; `None` where there is no
    /// such object. `object` counts from the first of the map.
    #[inline]
    pub fn place(object: usize) -> Option<(usize, Face)> {
        let face = Face::ALL.get(object % FACES)?;
        Some((object / FACES, *face))
    }

    /// The object that a side of a cell is.
    #[inline(always)]
    pub fn object(cell: usize, face: Face) -> usize {
        cell.wrapping_mul(FACES).wrapping_add(face as usize)
    }
}

impl<'a, M, W: Sides<M>, G: Plan<'a>> Maze<'a, M, W, G> {
    fn material(&self, cell: usize, face: Face) -> Option<&'a M> {
        match face {
            Face::Floor => Some(self.floor),
            Face::Ceiling => self.ceiling,
            _ => self
                .walls
                .get((self.grid.kind(cell) as usize).wrapping_sub(1))
                .map(|sides| sides.side(face)),
        }
    }

    /// Calls `meet` with the distance of each surface that the ray admits and what it is, from the
    /// nearest on, until it says that this is enough.
    #[inline(always)]
    fn visit(
        &self,
        ray: &Ray,
        first: usize,
        mut meet: impl FnMut(f32, (usize, Face), &'a M) -> bool,
    ) {
        let (origin, direction) = (ray.origin, ray.direction);
        let left = match ray.departure {
            Some(Departure { object, side }) => {
                let place = object.wrapping_sub(first);
                let is_here = place < Geometry::len(self);
                Maze::<M>::place(place)
                    .filter(|_| is_here)
                    .map(|(cell, face)| (cell, face, side))
            }
            None => None,
        };
        let (level, end) = if direction.y > 0.0 {
            (Face::Ceiling, (1.0 - origin.y) / direction.y)
        } else if direction.y < 0.0 {
            (Face::Floor, (0.0 - origin.y) / direction.y)
        } else if direction.y == 0.0 {
            (Face::Floor, f32::INFINITY)
        } else {
            return;
        };
        // From a surface, rounding may have put the point behind the next one, which is then met at once.
        let end = if end > 0.0 { end } else { f32::MIN_POSITIVE };
        let limit = if end < ray.t_max { end } else { ray.t_max };
        let walk = match left {
            // Out of the map.
            Some((_, face, _)) if face == level && direction.y != 0.0 => return,
            Some(left) => self.grid.leave(left, origin, direction, limit),
            None if origin.y >= 0.0 && origin.y <= 1.0 => self.grid.start(origin, direction, limit),
            None => return,
        };
        let Some(mut walk) = walk else { return };
        while let Some(met) = walk.next_wall() {
            let is_left = left.is_some_and(|(cell, face, _)| (cell, face) == (met.cell, met.face));
            if is_left {
                continue;
            }
            if let Some(material) = self.material(met.cell, met.face)
                && meet(met.t, (met.cell, met.face), material)
            {
                return;
            }
        }
        if walk.ends_here()
            && ray.admits(end)
            && let Some(material) = self.material(walk.cell(), level)
        {
            meet(end, (walk.cell(), level), material);
        }
    }
}

impl<'a, M, W: Sides<M>, G: Plan<'a>> Geometry for Maze<'a, M, W, G> {
    type Material = M;

    #[inline]
    fn len(&self) -> usize {
        self.grid.grid().len().wrapping_mul(FACES)
    }

    #[inline]
    fn nearest<P: Math>(&self, ray: &mut Ray, first: usize, _: Candidates) -> Option<usize> {
        let mut nearest = None;
        self.visit(&*ray, first, |t, (cell, face), _| {
            nearest = Some((t, Maze::<M>::object(cell, face)));
            true
        });
        let (t, object) = nearest?;
        ray.t_max = t;
        Some(first + object)
    }

    #[inline]
    fn surface<P: Math>(&self, _: &Ray, _: f32, object: usize, first: usize) -> Option<(Vec3, &M)> {
        let (cell, face) = Maze::<M>::place(object.wrapping_sub(first))?;
        Some((face.normal(), self.material(cell, face)?))
    }

    /// From the left lower corner of a wall's side to its right upper one, seen from outside; both below 1.
    /// Of floors and ceilings x and -z.
    #[inline]
    fn uv(&self, point: Vec3, object: usize, first: usize) -> (f32, f32) {
        let Some((cell, face)) = Maze::<M>::place(object.wrapping_sub(first)) else {
            return (0.0, 0.0);
        };
        if matches!(face, Face::Floor | Face::Ceiling) {
            return (point.x, 0.0 - point.z);
        }
        let width = (self.grid.grid().width as usize).max(1);
        let (x, z) = (cell % width, cell / width);
        let across = (self.grid).across((cell, face), point.x - x as f32, point.z - z as f32);
        // Rounding may have put the point over the edge.
        let below_one = |place: f32| place.clamp(0.0, 1.0 - 0.5 * f32::EPSILON);
        (below_one(across), below_one(point.y))
    }

    #[inline]
    fn blocks<P: Math>(&self, ray: &Ray, first: usize, _: Candidates) -> bool {
        let mut met = false;
        self.visit(ray, first, |_, _, _| {
            met = true;
            true
        });
        met
    }

    #[inline]
    fn absorbs<P: Math, L: Passage>(
        &self,
        ray: &Ray,
        first: usize,
        _: Candidates,
        light: &mut L,
    ) -> bool
    where
        M: Finish,
    {
        let mut is_opaque = false;
        self.visit(ray, first, |_, _, material| {
            is_opaque = light.pass(material.transmission(), 1, || 0.0);
            is_opaque
        });
        is_opaque
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Across, Door, DoorGrid};
    use crate::material::Glass;
    use crate::ray::Hit;

    const RED: Material = Material::matte(Vec3::X, 0.0, 1.0);
    const BLUE: Material = Material::matte(Vec3::Z, 0.0, 1.0);
    const WHITE: Material = Material::matte(Vec3::ONE, 0.0, 1.0);

    /// Seen from above; # and O are walls of two kinds.
    const ROOM: Maze = Maze {
        grid: Grid {
            width: 5,
            depth: 4,
            cells: &[
                1, 1, 1, 1, 1, //
                1, 0, 0, 0, 1, //
                1, 0, 2, 0, 1, //
                1, 1, 1, 1, 1,
            ],
        },
        walls: &[RED, BLUE],
        floor: &WHITE,
        ceiling: None,
    };

    fn met<M>(hit: Option<Hit<'_, M>>) -> Option<(f32, Vec3, (usize, Face))> {
        hit.map(|it| (it.t, it.normal, Maze::<M>::place(it.object).unwrap()))
    }

    #[test]
    fn walls_floor_and_ceiling_are_met_from_inside_the_map() {
        let eye = Vec3::new(1.5, 0.5, 1.5);
        let slope = |x, y| Vec3::new(x, y, 0.0);
        let open = ROOM;
        let closed = Maze {
            ceiling: Some(&BLUE),
            ..ROOM
        };
        let cases = [
            (
                "wall",
                open,
                eye,
                Vec3::X,
                Some((2.5, Vec3::NEG_X, (9, Face::West))),
            ),
            (
                "wall of another kind",
                open,
                eye + Vec3::Z,
                Vec3::X,
                Some((0.5, Vec3::NEG_X, (12, Face::West))),
            ),
            (
                "floor",
                open,
                eye,
                slope(0.5, -0.5),
                Some((1.0, Vec3::Y, (6, Face::Floor))),
            ),
            (
                "straight down",
                open,
                eye,
                Vec3::NEG_Y,
                Some((0.5, Vec3::Y, (6, Face::Floor))),
            ),
            (
                "down from the floor",
                open,
                Vec3::new(1.5, 0.0, 1.5),
                Vec3::NEG_Y,
                Some((f32::MIN_POSITIVE, Vec3::Y, (6, Face::Floor))),
            ),
            ("sky", open, eye, slope(0.5, 0.5), None),
            (
                "ceiling",
                closed,
                eye,
                slope(0.5, 0.5),
                Some((1.0, Vec3::NEG_Y, (6, Face::Ceiling))),
            ),
            (
                "where wall and floor meet",
                open,
                eye,
                slope(2.5, -0.5),
                Some((1.0, Vec3::Y, (8, Face::Floor))),
            ),
            ("above the map", closed, eye + Vec3::Y, Vec3::NEG_Y, None),
            ("below the map", closed, eye - Vec3::Y, Vec3::Y, None),
            ("beside the map", closed, eye - Vec3::X * 9.0, Vec3::X, None),
            (
                "from a border, which lies in the wall east of it",
                open,
                Vec3::new(4.0, 0.5, 1.5),
                Vec3::NEG_X,
                Some((f32::MIN_POSITIVE, Vec3::X, (9, Face::West))),
            ),
            (
                "inside of a wall",
                open,
                Vec3::new(2.5, 0.5, 2.5),
                Vec3::X,
                Some((0.5, Vec3::NEG_X, (12, Face::East))),
            ),
            (
                "not a number along x",
                closed,
                eye,
                Vec3::new(f32::NAN, -0.6, 0.8),
                None,
            ),
            (
                "not a number along y",
                closed,
                eye,
                Vec3::new(0.6, f32::NAN, 0.8),
                None,
            ),
            (
                "not a number along z",
                closed,
                eye,
                Vec3::new(0.6, -0.8, f32::NAN),
                None,
            ),
            ("nowhere", closed, Vec3::NAN, Vec3::X, None),
        ];
        for (name, maze, origin, direction, expected) in cases {
            let ray = Ray::new(origin, direction);
            assert_eq!(met(maze.closest_hit(&ray)), expected, "{name}");
            assert_eq!(maze.occluded(&ray), expected.is_some(), "{name}");
            if let Some((t, ..)) = expected {
                let short = Ray { t_max: t, ..ray };
                assert!(!maze.occluded(&short), "{name}: the interval is open");
                assert_eq!(maze.closest_hit(&short), None, "{name}");
            }
        }
    }

    #[test]
    fn what_leaves_a_face_starts_in_its_cell_wherever_rounding_puts_it() {
        let hit = ROOM
            .closest_hit(&Ray::new(Vec3::new(1.5, 0.5, 1.5), Vec3::X))
            .unwrap();
        for slip in [0.0, 1e-6, -1e-6] {
            let slipped = Hit {
                point: hit.point + Vec3::X * slip,
                ..hit
            };
            let back = slipped.back(Vec3::NEG_X);
            let (t, normal, place) = met(ROOM.closest_hit(&back)).unwrap();
            assert!((t - 3.0).abs() < 2e-6, "{t}");
            assert_eq!((normal, place), (Vec3::X, (5, Face::East)));
            // Never the face itself; the wall's inside ends at the map's.
            assert_eq!(met(ROOM.closest_hit(&slipped.through(Vec3::X))), None);
            assert_eq!(met(ROOM.closest_hit(&slipped.back(Vec3::X))), None);
            // In the corner, towards the other wall, from behind it by rounding.
            let corner = Hit {
                point: Vec3::new(4.0, 0.5, 1.0 - slip),
                ..hit
            };
            let (t, _, place) = met(ROOM.closest_hit(&corner.back(Vec3::NEG_Z))).unwrap();
            assert!(t > 0.0 && t < 2e-6, "{t}");
            assert_eq!(place, (3, Face::South));
        }
    }

    #[test]
    fn what_leaves_the_floor_does_not_meet_it_again() {
        let hit = ROOM
            .closest_hit(&Ray::new(Vec3::new(1.5, 0.5, 1.5), Vec3::NEG_Y))
            .unwrap();
        assert_eq!(met(ROOM.closest_hit(&hit.back(Vec3::Y))), None);
        assert_eq!(met(ROOM.closest_hit(&hit.back(Vec3::NEG_Y))), None);
        let along = met(ROOM.closest_hit(&hit.back(Vec3::X)));
        assert_eq!(along, Some((2.5, Vec3::NEG_X, (9, Face::West))));
    }

    #[test]
    fn light_is_weakened_at_each_side_of_glass_walls() {
        let glass = Material {
            color: Vec3::ONE,
            ambient: 0.0,
            diffuse: 0.0,
            highlight: (),
            reflection: (),
            transmission: Glass {
                transmittance: 0.5,
                ior: 1.0,
            },
        };
        let opaque = Material {
            transmission: Glass {
                transmittance: 0.0,
                ior: 1.0,
            },
            ..glass
        };
        let maze = Maze {
            grid: ROOM.grid,
            walls: &[opaque, glass],
            floor: &opaque,
            ceiling: None,
        };
        let ray = Ray::new(Vec3::new(1.5, 0.5, 2.5), Vec3::X);
        let to = |t_max| maze.transmittance(&Ray { t_max, ..ray });
        assert_eq!([0.5, 1.5, 2.5, 3.0].map(to), [1.0, 0.5, 0.25, 0.0]);
        let first = maze.closest_hit(&ray).unwrap();
        let second = maze.closest_hit(&first.through(Vec3::X)).unwrap();
        assert_eq!((second.t, second.front), (1.0, false));
    }

    #[test]
    fn doors_are_met_and_left_on_both_sides() {
        let glass = |transmittance| Material {
            color: Vec3::ONE,
            ambient: 0.0,
            diffuse: 0.0,
            highlight: (),
            reflection: (),
            transmission: Glass {
                transmittance,
                ior: 1.0,
            },
        };
        let (stone, pane) = (glass(0.0), glass(0.5));
        let doors = [Door {
            kind: 2,
            across: Across::X,
            open: 0.25,
        }];
        let maze = Maze {
            grid: DoorGrid {
                grid: Grid {
                    width: 5,
                    depth: 3,
                    cells: &[1, 1, 1, 1, 1, 1, 0, 3, 0, 1, 1, 1, 1, 1, 1],
                },
                first: 3,
                doors: &doors,
            },
            walls: &[stone, pane],
            floor: &stone,
            ceiling: None,
        };
        let ray = Ray::new(Vec3::new(1.5, 0.5, 1.5), Vec3::X);
        let first = maze.closest_hit(&ray).unwrap();
        let place = Maze::<Material>::object(7, Face::West);
        assert_eq!(
            (first.t, first.normal, first.object),
            (1.0, Vec3::NEG_X, place)
        );
        let t = |ray: Ray| maze.closest_hit(&ray).map(|it| it.t);
        assert_eq!(t(first.through(Vec3::X)), Some(1.5));
        assert_eq!(t(first.back(Vec3::NEG_X)), Some(1.5));
        for slip in [1e-6, -1e-6] {
            let slipped = Hit {
                point: first.point + Vec3::X * slip,
                ..first
            };
            for (ray, t) in [
                (slipped.through(Vec3::X), 1.5 - slip),
                (slipped.back(Vec3::NEG_X), 1.5 + slip),
            ] {
                let found = maze.closest_hit(&ray).unwrap();
                assert!(
                    (found.t - t).abs() < 1e-6 && found.object % 6 < 2,
                    "{found:?}"
                );
            }
        }
        // To the side of the door's own cell.
        let aside = maze.closest_hit(&first.back(Vec3::new(-0.25, 0.0, 1.0)));
        let place = Maze::<Material>::object(12, Face::North);
        assert_eq!(aside.map(|it| it.object), Some(place));
        // Back from the far wall: the other side of the panel, and then the near wall.
        let far = maze.closest_hit(&first.through(Vec3::X)).unwrap();
        let behind = maze.closest_hit(&far.back(Vec3::NEG_X)).unwrap();
        assert_eq!((behind.t, behind.normal), (1.5, Vec3::X));
        assert_eq!(behind.object, Maze::<Material>::object(7, Face::East));
        assert_eq!(t(behind.through(Vec3::NEG_X)), Some(1.5));
        // Through the gap, and down on the floor below the panel, from either side of it.
        let beside = Ray::new(Vec3::new(1.5, 0.5, 1.125), Vec3::X);
        assert_eq!(t(beside), Some(2.5));
        for x in [2.25, 2.75] {
            let down = Ray::new(Vec3::new(x, 0.5, 1.5), Vec3::NEG_Y);
            let floor = maze.closest_hit(&down).unwrap();
            let place = Maze::<Material>::object(7, Face::Floor);
            assert_eq!((floor.t, floor.object), (0.5, place));
            assert_eq!(
                t(floor.back(Vec3::X)),
                Some(if x < 2.5 { 0.25 } else { 1.25 })
            );
        }
        // A pane is crossed once.
        let to = |t_max| maze.transmittance(&Ray { t_max, ..ray });
        assert_eq!([1.0, 1.25, 2.5, 2.625].map(to), [1.0, 0.5, 0.5, 0.0]);
        assert_eq!(maze.transmittance(&beside), 0.0);
        let within = Ray {
            t_max: 2.25,
            ..beside
        };
        assert_eq!(maze.transmittance(&within), 1.0);
    }

    #[test]
    fn sides_have_materials_and_places_of_their_own() {
        let doors = [Door {
            kind: 1,
            across: Across::Z,
            open: 0.25,
        }];
        // A door to the south, in a wall.
        let maze = Maze {
            grid: DoorGrid {
                grid: Grid {
                    width: 3,
                    depth: 4,
                    cells: &[1, 1, 1, 1, 0, 1, 1, 2, 1, 1, 1, 1],
                },
                first: 2,
                doors: &doors,
            },
            walls: &[[1, 2, 3, 4]],
            floor: &5,
            ceiling: Some(&6),
        };
        let eye = Vec3::new(1.375, 0.5, 1.25);
        let cases = [
            (Vec3::NEG_X, 2, (0.75, 0.5)),
            (Vec3::X, 1, (0.25, 0.5)),
            (Vec3::NEG_Z, 4, (0.375, 0.5)),
            // The door takes its picture along.
            (Vec3::Z, 3, (0.875, 0.5)),
            (Vec3::new(0.0, -0.5, 0.25), 5, (1.375, -1.5)),
            (Vec3::new(0.0, 0.5, 0.25), 6, (1.375, -1.5)),
        ];
        for (direction, material, (u, v)) in cases {
            let hit = maze.closest_hit(&Ray::new(eye, direction)).unwrap();
            let uv = maze.uv(hit.point, hit.object, 0);
            assert_eq!(*hit.material, material, "{direction}");
            assert!(
                (uv.0 - u).abs() < 1e-6 && (uv.1 - v).abs() < 1e-6,
                "{direction}: {uv:?}"
            );
        }
        let wall = Maze::<u8>::object(5, Face::West);
        let above = maze.uv(Vec3::new(2.0, 1.000_1, 2.000_1), 7 + wall, 7);
        let edge = 1.0 - 0.5 * f32::EPSILON;
        assert_eq!(above, (edge, edge), "as if it were on the wall");
    }

    #[test]
    fn objects_are_counted_from_the_first_of_the_map() {
        let nothing: [crate::Object<'_, crate::Sphere>; 0] = [];
        let ball = [crate::Object {
            shape: crate::Sphere {
                center: Vec3::new(2.5, 0.5, 1.5),
                radius: 0.25,
            },
            material: &BLUE,
        }];
        let pair = (ball.as_slice(), (ROOM, nothing.as_slice()));
        let ray = Ray::new(Vec3::new(1.5, 0.5, 1.5), Vec3::X);
        let hit = pair.closest_hit(&ray).unwrap();
        assert_eq!((hit.t, hit.object), (0.75, 0));
        let wall = pair.closest_hit(&hit.through(Vec3::X)).unwrap();
        assert_eq!(wall.object, 0, "the other side of the ball");
        let wall = pair.closest_hit(&wall.back(Vec3::X)).unwrap();
        assert_eq!(wall.object, 1 + Maze::<Material>::object(9, Face::West));
        let back = pair.closest_hit(&wall.back(Vec3::NEG_X)).unwrap();
        assert_eq!((back.t, back.object), (1.25, 0));
        assert_eq!(
            pair.surface::<crate::Exact>(&ray, 1.0, 1 + pair.len(), 0),
            None
        );
    }
}
