//! A [`Grid`] as a geometry: walls, floor and ceiling for rays in all directions.

use glam::Vec3;

use crate::candidates::Candidates;
use crate::geometry::Geometry;
use crate::grid::{Face, Grid};
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
pub struct Maze<'a, M = Material> {
    /// The map.
    pub grid: Grid<'a>,
    /// What walls are made of, by kind; a wall of a kind without material is not met.
    pub walls: &'a [M],
    /// What the floor is made of.
    pub floor: &'a M,
    /// What the ceiling is made of; `None` where the map is open above.
    pub ceiling: Option<&'a M>,
}

impl<M> Clone for Maze<'_, M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<M> Copy for Maze<'_, M> {}

/// Sides of a cell.
const FACES: usize = Face::ALL.len();

impl<'a, M> Maze<'a, M> {
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

    fn material(&self, cell: usize, face: Face) -> Option<&'a M> {
        match face {
            Face::Floor => Some(self.floor),
            Face::Ceiling => self.ceiling,
            _ => self
                .walls
                .get((self.grid.kind(cell) as usize).wrapping_sub(1)),
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
                Self::place(place)
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
            Some(left) => self.grid.walk_from(left, origin, direction, limit),
            None if origin.y >= 0.0 && origin.y <= 1.0 => self.grid.walk(origin, direction, limit),
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

impl<M> Geometry for Maze<'_, M> {
    type Material = M;

    #[inline]
    fn len(&self) -> usize {
        self.grid.len().wrapping_mul(FACES)
    }

    #[inline]
    fn nearest<P: Math>(&self, ray: &mut Ray, first: usize, _: Candidates) -> Option<usize> {
        let mut nearest = None;
        self.visit(&*ray, first, |t, (cell, face), _| {
            nearest = Some((t, Self::object(cell, face)));
            true
        });
        let (t, object) = nearest?;
        ray.t_max = t;
        Some(first + object)
    }

    #[inline]
    fn surface<P: Math>(&self, _: &Ray, _: f32, object: usize, first: usize) -> Option<(Vec3, &M)> {
        let (cell, face) = Self::place(object.wrapping_sub(first))?;
        Some((face.normal(), self.material(cell, face)?))
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
