//! From cell to cell of a grid: which border comes next, and how far it is.
//!
//! The walk is that of J. Amanatides and A. Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing",
//! Eurographics 1987, with several ways to the distances.

use glam::Vec3;
use whitted::Grid;
use whitted::grid::Face;

use crate::Method;

/// A ray over an empty map.
#[derive(Clone, Copy, Debug)]
pub struct Course {
    /// Its cells do not matter.
    pub grid: Grid<'static>,
    /// On the map.
    pub origin: Vec3,
    /// Of any length.
    pub direction: Vec3,
    /// Borders after which the walk ends, on the map or not.
    pub steps: u32,
}

/// A walk, and the same that tells of each border its distance, and whether it lies across x.
pub type Walks = (fn(&Course) -> f32, fn(&Course, &mut dyn FnMut(f32, bool)));

/// A walk's distances.
pub type GridMethod = Method<Walks>;

/// All methods.
pub const METHODS: &[GridMethod] = &[
    Method::new("core", (core, core_telling)),
    Method::new("summed", (walk::<Summed>, telling::<Summed>)),
    Method::new("multiples", (walk::<Multiples>, telling::<Multiples>)),
    Method::new("reciprocal", (walk::<Reciprocal>, telling::<Reciprocal>)),
    Method::new("f64", (walk::<Double>, telling::<Double>)),
];

/// The walk of `whitted`.
#[inline(never)]
fn core(course: &Course) -> f32 {
    let mut last = 0.0;
    core_steps(course, |t, _| last = t);
    last
}

fn core_telling(course: &Course, tell: &mut dyn FnMut(f32, bool)) {
    core_steps(course, tell);
}

#[inline(always)]
fn core_steps(course: &Course, mut tell: impl FnMut(f32, bool)) {
    let Course {
        grid,
        origin,
        direction,
        steps,
    } = *course;
    let Some(mut walk) = grid.walk(origin, direction, f32::INFINITY) else {
        return;
    };
    for _ in 0..steps {
        let Some((t, face)) = walk.step() else { return };
        tell(t, matches!(face, Face::West | Face::East));
    }
}

/// Distances to the borders across one axis, one after the other.
trait Distances {
    /// Before the border next to a cell.
    fn new(origin: f32, direction: f32, cell: f32) -> Self;
    /// The distance to the next border.
    fn t(&self) -> f32;
    /// Passes it.
    fn pass(&mut self);
}

/// The border ahead of a cell, and the way to the one after it.
fn ahead(direction: f32, cell: f32) -> (f32, f32) {
    if direction > 0.0 {
        (cell + 1.0, 1.0)
    } else {
        (cell, -1.0)
    }
}

/// As the paper has it: each distance is the one before and what lies between two.
struct Summed {
    t: f32,
    delta: f32,
}

impl Distances for Summed {
    fn new(origin: f32, direction: f32, cell: f32) -> Self {
        let (border, _) = ahead(direction, cell);
        Self {
            t: (border - origin) / direction,
            delta: 1.0 / direction.abs(),
        }
    }

    fn t(&self) -> f32 {
        self.t
    }

    fn pass(&mut self) {
        self.t += self.delta;
    }
}

/// The first distance, and so many times what lies between two.
struct Multiples {
    first: f32,
    delta: f32,
    count: f32,
}

impl Distances for Multiples {
    fn new(origin: f32, direction: f32, cell: f32) -> Self {
        let Summed { t, delta } = Summed::new(origin, direction, cell);
        Self {
            first: t,
            delta,
            count: 0.0,
        }
    }

    fn t(&self) -> f32 {
        self.first + self.count * self.delta
    }

    fn pass(&mut self) {
        self.count += 1.0;
    }
}

/// From the border, by the reciprocal of the direction.
struct Reciprocal {
    origin: f32,
    reciprocal: f32,
    border: f32,
    step: f32,
}

impl Distances for Reciprocal {
    fn new(origin: f32, direction: f32, cell: f32) -> Self {
        let (border, step) = ahead(direction, cell);
        Self {
            origin,
            reciprocal: 1.0 / direction,
            border,
            step,
        }
    }

    fn t(&self) -> f32 {
        (self.border - self.origin) * self.reciprocal
    }

    fn pass(&mut self) {
        self.border += self.step;
    }
}

/// As `whitted`, in `f64`, and rounded in the end.
struct Double {
    origin: f64,
    direction: f64,
    border: f64,
    step: f64,
}

impl Distances for Double {
    fn new(origin: f32, direction: f32, cell: f32) -> Self {
        let (border, step) = ahead(direction, cell);
        Self {
            origin: origin.into(),
            direction: direction.into(),
            border: border.into(),
            step: step.into(),
        }
    }

    fn t(&self) -> f32 {
        ((self.border - self.origin) / self.direction) as f32
    }

    fn pass(&mut self) {
        self.border += self.step;
    }
}

#[inline(never)]
fn walk<D: Distances>(course: &Course) -> f32 {
    let mut last = 0.0;
    steps::<D>(course, |t, _| last = t);
    last
}

fn telling<D: Distances>(course: &Course, tell: &mut dyn FnMut(f32, bool)) {
    steps::<D>(course, tell);
}

/// The axis to go along next, as `whitted` decides at corners.
#[inline(always)]
fn steps<D: Distances>(course: &Course, mut tell: impl FnMut(f32, bool)) {
    let Course {
        grid,
        origin,
        direction,
        steps,
    } = *course;
    let start = [origin.x as u16, origin.z as u16];
    let left = |direction: f32, cell: u16, count: u16| {
        if direction > 0.0 {
            count.wrapping_sub(1).wrapping_sub(cell)
        } else {
            cell
        }
    };
    let mut left = [
        left(direction.x, start[0], grid.width),
        left(direction.z, start[1], grid.depth),
    ];
    let mut x = D::new(origin.x, direction.x, start[0].into());
    let mut z = D::new(origin.z, direction.z, start[1].into());
    let distance = |axis: &D, direction: f32| {
        if direction != 0.0 {
            axis.t()
        } else {
            f32::INFINITY
        }
    };
    let mut next = [distance(&x, direction.x), distance(&z, direction.z)];
    for _ in 0..steps {
        let is_x = next[0] < next[1] || (next[0] == next[1] && direction.x > 0.0);
        let (axis, place) = if is_x { (&mut x, 0) } else { (&mut z, 1) };
        let t = next[place];
        if !(t < f32::INFINITY) || left[place] == 0 {
            return;
        }
        left[place] -= 1;
        axis.pass();
        next[place] = axis.t();
        tell(t, is_x);
    }
}
