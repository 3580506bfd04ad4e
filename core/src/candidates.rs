//! Rays that share a point look only at what they can meet.
//!
//! The rays of a row's pixels share the eye, and all rays towards a light share the light. What of
//! the first objects no ray of a group can meet is found out once, for the group: of a [`Beam`], the
//! pixels of a stretch of a row, while it is drawn; of the rays that reach a light from one direction,
//! before the program is built, in a [`LightBuffer`]. With each ray then go the [`Candidates`] of its
//! group, and a [`Culled`] slice passes over all others.
//!
//! Nothing that is met is ever passed over, so that no picture changes by a bit. Scenes without a
//! [`Culled`] slice link none of this.

use glam::Vec3;

use crate::camera::Rays;
use crate::geometry::{Geometry, Object};
use crate::material::Finish;
use crate::math::{self, Exact, Math, Passage, dot, length_squared};
use crate::ray::{Departure, Ray, Side};
use crate::scene::{Light, LightSource};
use crate::shape::Shape;
use crate::shape::sphere::Sphere;

/// Which objects of a geometry a ray may meet: each of the first 31 by itself, and all others together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Candidates(
    /// Bit 31 stands for objects 31, 32, …: shifted right, it stays what it is.
    i32,
);

impl Candidates {
    /// Every object.
    pub const ALL: Self = Self(-1);

    /// These but for one object; the same where that is not one of the first 31.
    #[inline(always)]
    pub const fn without(self, object: usize) -> Self {
        if object < 31 {
            Self(self.0 & !(1 << object))
        } else {
            self
        }
    }

    /// These and one object; the same where that is not one of the first 31.
    #[inline(always)]
    pub const fn with(self, object: usize) -> Self {
        if object < 31 {
            Self(self.0 | 1 << object)
        } else {
            self
        }
    }

    /// What is among both.
    #[inline(always)]
    pub(crate) const fn and(self, others: Self) -> Self {
        Self(self.0 & others.0)
    }

    /// Whether an object is one of them.
    #[inline(always)]
    pub const fn contain(self, object: usize) -> bool {
        self.from(object) & 1 == 1
    }

    /// Bit 0 for `first`, bit 1 for the object after it, and so on.
    #[inline(always)]
    const fn from(self, first: usize) -> i32 {
        self.0 >> if first < 31 { first } else { 31 }
    }
}

/// The rays of some pixels next to each other in a row, and everything between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    eye: Vec3,
    /// Unit length, across the plane in which all rays lie.
    across: Vec3,
    /// Unit length, in that plane, away from the rays: where those are that lie left of all.
    left: Vec3,
    /// And right.
    right: Vec3,
}

/// How far, over its distance from the eye, a sphere may lie off what the planes of a beam say. Rounding
/// is 2^-16 at most, for a row that [`Fan::new`] accepts.
const BEAM_SLACK: f32 = 1.0 / 4096.0;

impl Beam {
    /// Whether no ray meets the sphere.
    #[inline]
    pub fn misses(&self, sphere: &Sphere) -> bool {
        let to_center = sphere.center - self.eye;
        let size = to_center.abs();
        let radius = sphere.radius.abs();
        let reach = radius + (size.x + size.y + size.z + radius) * BEAM_SLACK;
        dot(&to_center, &self.across).abs() > reach
            || dot(&to_center, &self.left) > reach
            || dot(&to_center, &self.right) > reach
    }
}

/// A row's rays, of which any stretch is a [`Beam`].
#[derive(Clone, Copy, Debug)]
struct Fan {
    eye: Vec3,
    start: Vec3,
    step: Vec3,
    across: Vec3,
}

impl Fan {
    /// `None` where the row is so wide, or seen so obliquely, that rounding would count.
    #[inline]
    fn new(eye: Vec3, start: Vec3, step: Vec3, width: u32) -> Option<Self> {
        // In units of the distance to the row's start.
        let recip = Exact::sqrt_and_recip(length_squared(&start)).1;
        let (start, step) = (start * recip, step * recip);
        let row = step * width as f32;
        let (size, across) = (length_squared(&row), start.cross(row));
        // The row's distance is above 1/32 of its length and of 1. Also false for NaN.
        const OBLIQUE: f32 = 1024.0;
        // In a shorter row, some 3e-5 of its distance, pixels lie as close as rounding.
        const SHORTEST_SQUARED: f32 = 1e-9;
        if size > SHORTEST_SQUARED && (1.0 + size) * size < OBLIQUE * length_squared(&across) {
            let across = Exact::normalize(across);
            Some(Self {
                eye,
                start,
                step,
                across,
            })
        } else {
            None
        }
    }

    /// From the left edge of pixel `from` to that of pixel `to`.
    #[inline]
    fn beam(&self, from: u32, to: u32) -> Beam {
        let at = |column: u32| self.start + self.step * column as f32;
        Beam {
            eye: self.eye,
            across: self.across,
            left: Exact::normalize(at(from).cross(self.across)),
            right: Exact::normalize(self.across.cross(at(to))),
        }
    }
}

/// How many pixels a beam spans. Fewer make narrower beams, more share the cost.
const SPAN: u32 = 16;

/// The rays of a row, each with its candidates in a geometry. See [`Rays::towards`].
#[derive(Clone, Debug)]
pub struct Aimed<'a, G> {
    rays: Rays,
    geometry: &'a G,
    fan: Option<Fan>,
    candidates: Candidates,
    /// The first column for which they do not hold.
    end: u32,
}

impl Rays {
    /// The same rays, each with its [`Candidates`] among the geometry's objects.
    #[inline]
    pub fn towards<G: Geometry>(self, geometry: &G) -> Aimed<'_, G> {
        let (start, step) = (self.start, self.step);
        Aimed {
            fan: Fan::new(self.eye, start, step, self.width),
            end: self.column,
            rays: self,
            geometry,
            candidates: Candidates::ALL,
        }
    }
}

impl<G: Geometry> Iterator for Aimed<'_, G> {
    type Item = (Ray, Candidates);

    #[inline]
    fn nth(&mut self, passed: usize) -> Option<Self::Item> {
        self.rays.pass(passed);
        self.next()
    }

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        let column = self.rays.column;
        let ray = self.rays.next()?;
        if column >= self.end {
            self.end = column.saturating_add(SPAN);
            if let Some(fan) = &self.fan {
                let beam = fan.beam(column, self.end);
                self.candidates = self.geometry.candidates(&beam, 0, Candidates::ALL);
            }
        }
        Some((ray, self.candidates))
    }

    #[inline]
    fn size_hint(&self) -> (usize, Option<usize>) {
        self.rays.size_hint()
    }
}

impl<G: Geometry> ExactSizeIterator for Aimed<'_, G> {}

/// Objects of one kind, at most 31, of which a ray tests its [`Candidates`] only.
///
/// Pays where there are more objects than a pixel shows. 31 spheres, with a [`LightBuffer`], take a
/// fifth of the plain slice's instructions and 0.4 of those of a [`Hierarchy`](crate::Hierarchy)'s
/// (`tests/charts/firmware-hierarchy.svg`), where nothing mirrors. The answers are the plain slice's.
#[derive(Debug, PartialEq)]
pub struct Culled<'a, S, M, const N: usize>(pub &'a [Object<'a, S, M>; N]);

impl<S, M, const N: usize> Clone for Culled<'_, S, M, N> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<S, M, const N: usize> Copy for Culled<'_, S, M, N> {}

impl<'a, S, M, const N: usize> Culled<'a, S, M, N> {
    #[inline(always)]
    fn among(&self, among: Candidates, first: usize) -> Among<'a, Object<'a, S, M>, N> {
        const { assert!(N <= 31, "a culled slice has at most 31 objects") };
        Among {
            objects: self.0,
            left: among.from(first) as u32 & ((1 << N) - 1),
        }
    }
}

/// The candidates of a slice.
struct Among<'a, T, const N: usize> {
    objects: &'a [T; N],
    /// A bit for each that is left.
    left: u32,
}

impl<'a, T, const N: usize> Among<'a, T, N> {
    /// The one at this place, if it is a candidate.
    #[inline(always)]
    fn at(&self, place: usize) -> Option<(usize, &'a T)> {
        if self.left >> place & 1 == 1 {
            Some((place, self.objects.get(place)?))
        } else {
            None
        }
    }
}

impl<'a, T, const N: usize> Iterator for Among<'a, T, N> {
    type Item = (usize, &'a T);

    #[inline(always)]
    fn next(&mut self) -> Option<(usize, &'a T)> {
        math::keep_rolled();
        if self.left == 0 {
            return None;
        }
        let place = self.left.trailing_zeros() as usize;
        self.left &= self.left - 1;
        Some((place, self.objects.get(place)?))
    }
}

/// The side on which the object at this place is left, if it is the one.
#[inline(always)]
fn leaving(place: usize, left: usize, side: Side) -> Option<Side> {
    if place == left {
        core::hint::cold_path();
        Some(side)
    } else {
        None
    }
}

/// Where in a slice the object lies that the ray leaves, and the side; far out of it if that is no such one.
#[inline(always)]
fn departure(ray: &Ray, first: usize) -> (usize, Side) {
    let (place, side) = match ray.departure {
        Some(left) => (left.object.wrapping_sub(first), left.side),
        None => (usize::MAX, Side::Outside),
    };
    (math::forget_number(place), side)
}

/// Looks for the nearest point that a ray meets.
struct Search<'r, S: Shape> {
    ray: &'r mut Ray,
    setup: S::Setup,
    /// See [`departure`].
    departure: (usize, Side),
    /// Where the object lies that is nearest so far.
    nearest: usize,
}

impl<S: Shape> Search<'_, S> {
    #[inline(always)]
    fn ask<M, P: Math>(&mut self, candidate: Option<(usize, &Object<'_, S, M>)>) {
        let Some((place, object)) = candidate else {
            return;
        };
        let (left, side) = self.departure;
        let leaving = leaving(place, left, side);
        let shape = &object.shape;
        if let Some(t) = shape.intersect_ahead::<P>(self.ray, &self.setup, leaving) {
            self.ray.t_max = t;
            self.nearest = place;
        }
    }
}

impl<S: Shape, M, const N: usize> Geometry for Culled<'_, S, M, N> {
    type Material = M;

    #[inline(always)]
    fn len(&self) -> usize {
        N
    }

    #[inline]
    fn candidates(&self, beam: &Beam, first: usize, mut among: Candidates) -> Candidates {
        for (place, object) in (first..31).zip(self.0) {
            math::keep_rolled();
            if object.shape.is_missed(beam) {
                among = among.without(place);
            }
        }
        among
    }

    #[inline(always)]
    fn onward(&self, departure: Departure, first: usize) -> Candidates {
        match self.0.get(departure.object.wrapping_sub(first)) {
            Some(object) if object.shape.is_left_for_good(departure.side) => {
                Candidates::ALL.without(departure.object)
            }
            _ => Candidates::ALL,
        }
    }

    #[inline]
    fn nearest<P: Math>(&self, ray: &mut Ray, first: usize, among: Candidates) -> Option<usize> {
        let mut search = Search {
            setup: S::setup(ray),
            departure: departure(ray, first),
            nearest: N,
            ray,
        };
        let among = self.among(among, first);
        if N <= 4 {
            // To go on to the next takes a loop a quarter of a test; each copy of it, some 350 bytes.
            search.ask::<M, P>(among.at(0));
            search.ask::<M, P>(among.at(1));
            search.ask::<M, P>(among.at(2));
            search.ask::<M, P>(among.at(3));
        } else {
            among.for_each(|it| search.ask::<M, P>(Some(it)));
        }
        let nearest = search.nearest;
        (nearest < N).then_some(first + nearest)
    }

    #[inline]
    fn surface<P: Math>(
        &self,
        ray: &Ray,
        t: f32,
        object: usize,
        first: usize,
    ) -> Option<(Vec3, &M)> {
        self.0.as_slice().surface::<P>(ray, t, object, first)
    }

    #[inline(always)]
    fn uv(&self, point: Vec3, object: usize, first: usize) -> (f32, f32) {
        self.0.as_slice().uv(point, object, first)
    }

    #[inline]
    fn blocks<P: Math>(&self, ray: &Ray, first: usize, among: Candidates) -> bool {
        let setup = S::setup(ray);
        let (left, side) = departure(ray, first);
        self.among(among, first).any(|(place, object)| {
            let leaving = leaving(place, left, side);
            let met = object.shape.intersect_ahead::<P>(ray, &setup, leaving);
            met.is_some()
        })
    }

    #[inline]
    fn absorbs<P: Math, L: Passage>(
        &self,
        ray: &Ray,
        first: usize,
        among: Candidates,
        light: &mut L,
    ) -> bool
    where
        M: Finish,
    {
        let setup = S::setup(ray);
        let (left, side) = departure(ray, first);
        self.among(among, first).any(|(place, object)| {
            let leaving = leaving(place, left, side);
            let times = object.shape.crossings::<P>(ray, &setup, leaving);
            let inside = || object.shape.inside::<P>(ray, &setup, leaving);
            light.pass(object.material.transmission(), times, inside)
        })
    }
}

/// A point light that knows which objects lie in which direction.
///
/// After E. A. Haines and D. P. Greenberg, "The Light Buffer: A Shadow-Testing Accelerator", IEEE
/// Computer Graphics and Applications 6(9), 1986, with two changes for small scenes. The candidates of
/// a cell are bits, not a list. And the cells are those of a cube of directions themselves, not of
/// faces on which they are projected: a unit vector's cell takes no division, and where all objects
/// lie within a few degrees, as seen from a far light, the cells divide just these.
///
/// Where the light or a sphere moves, it has to be made anew: else shadows would be missing.
///
/// `C` is `i8`, `i16` or `i32`, for geometries whose first 7, 15 or 31 objects count one by one. There
/// are `N` cells, 64 or 512: with fewer, more objects share one.
///
/// ```
/// use whitted::{Culled, Light, LightBuffer, Material, Object, Scene, Sphere, Vec3};
///
/// static CLAY: Material = Material::matte(Vec3::new(0.8, 0.3, 0.2), 0.1, 0.9);
/// static BALLS: [Object<Sphere>; 2] = [
///     Object { shape: Sphere { center: Vec3::new(0.0, 1.0, -4.0), radius: 1.0 }, material: &CLAY },
///     Object { shape: Sphere { center: Vec3::new(3.0, 1.0, -4.0), radius: 1.0 }, material: &CLAY },
/// ];
/// const LAMP: Light = Light { position: Vec3::new(3.0, 5.0, 0.0), color: Vec3::ONE };
/// static LIGHTS: [LightBuffer<i8, 64>; 1] = [LightBuffer::<i8, 64>::new(LAMP, &BALLS)];
/// static SCENE: Scene<Culled<Sphere, Material, 2>, LightBuffer<i8, 64>> = Scene {
///     geometry: Culled(&BALLS),
///     lights: &LIGHTS,
///     background: Vec3::ZERO,
///     ambient: Vec3::ONE,
/// };
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LightBuffer<C, const N: usize> {
    light: Light,
    /// To where a direction lies among the cells.
    window: Window,
    /// The greatest distance from the light at which a lit point may lie.
    reach: f32,
    cells: [C; N],
}

/// Cell `i` along an axis holds the directions for which `offset + scale·d` is `ROUND + i`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Window {
    scale: Vec3,
    offset: Vec3,
}

/// At this size, floats are whole numbers, and their lowest bits the number's.
const ROUND: f32 = 12_582_912.0;

/// A sphere as seen from a light, in f64.
#[derive(Clone, Copy)]
struct Seen {
    distance: f64,
    /// To its center, unit length.
    direction: [f64; 3],
    /// How far a unit vector that meets it, or what lies around it by rounding, may lie from that one.
    chord: f64,
    /// Whether it takes so much of the sky that it is a candidate everywhere. Also where it is not a
    /// number.
    is_everywhere: bool,
}

/// By how much a sphere is taken larger, over its distance from the light: rays towards the light, and
/// hits, lie off by 2^-20 of the distances in question.
const LIGHT_SLACK: f64 = 1.0 / 2048.0;

impl Seen {
    const fn new(light: &Light, sphere: &Sphere) -> Self {
        let (l, c) = (light.position, sphere.center);
        let center = [
            c.x as f64 - l.x as f64,
            c.y as f64 - l.y as f64,
            c.z as f64 - l.z as f64,
        ];
        let distance = sqrt(center[0] * center[0] + center[1] * center[1] + center[2] * center[2]);
        let radius = (sphere.radius as f64).abs();
        let sine = (radius + (distance + radius) * LIGHT_SLACK) / distance;
        Self {
            distance,
            direction: [
                center[0] / distance,
                center[1] / distance,
                center[2] / distance,
            ],
            // Up to a sine of 1/2 it is at most 1.0353 times the sine.
            chord: 1.036 * sine,
            is_everywhere: !(sine < 0.5),
        }
    }

    /// Whether any direction of the cell, between `low` and `high` along each axis, may meet it.
    const fn touches(&self, low: [f64; 3], high: [f64; 3]) -> bool {
        let mut apart_squared = 0.0;
        let mut axis = 0;
        while axis < 3 {
            let it = self.direction[axis];
            let apart = f64::max(f64::max(low[axis] - it, it - high[axis]), 0.0);
            apart_squared += apart * apart;
            axis += 1;
        }
        apart_squared <= self.chord * self.chord
    }
}

/// The square root by Newton's method, which comes down to it from above, up to rounding. 300 rounds are
/// enough for any square of an f32.
const fn sqrt(x: f64) -> f64 {
    if !(x > 0.0) {
        return x;
    }
    let mut root = if x > 1.0 { x } else { 1.0 };
    let mut rounds = 0;
    while rounds < 300 {
        let next = 0.5 * (root + x / root);
        if !(next < root) {
            break;
        }
        root = next;
        rounds += 1;
    }
    root
}

impl<C, const N: usize> LightBuffer<C, N> {
    /// Along an axis there are 2^`BITS`.
    const BITS: u32 = N.ilog2() / 3;
    const SIDE: usize = 1 << Self::BITS;

    /// How far from the light its candidates hold: rounding grows with the distance of the lit point,
    /// and the slack with that of the sphere.
    const fn reach<M>(light: &Light, spheres: &[Object<'_, Sphere, M>]) -> f32 {
        let mut reach = f64::INFINITY;
        let mut place = 0;
        while place < spheres.len() {
            let seen = Seen::new(light, &spheres[place].shape);
            if !seen.is_everywhere {
                reach = f64::min(reach, seen.distance * 256.0);
            }
            place += 1;
        }
        reach as f32
    }

    /// The least window with all directions in which anything is met that is not met everywhere.
    const fn window<M>(light: &Light, spheres: &[Object<'_, Sphere, M>]) -> Window {
        let (mut low, mut high) = ([1.0; 3], [-1.0; 3]);
        let mut place = 0;
        while place < spheres.len() {
            let seen = Seen::new(light, &spheres[place].shape);
            place += 1;
            if seen.is_everywhere {
                continue;
            }
            let apart = seen.chord;
            let mut axis = 0;
            while axis < 3 {
                let middle = seen.direction[axis];
                low[axis] = f64::min(low[axis], f64::max(middle - apart, -1.0));
                high[axis] = f64::max(high[axis], f64::min(middle + apart, 1.0));
                axis += 1;
            }
        }
        let (mut scale, mut offset) = ([0.0; 3], [0.0; 3]);
        let mut axis = 0;
        while axis < 3 {
            let width = high[axis] - low[axis];
            if width > 0.0 {
                // A whole offset leaves up to one cell unused, and a little room for unit vectors along
                // the axis, which rounding makes longer. Else it moves directions by less than the slack.
                scale[axis] = ((Self::SIDE as f64 - 1.125) / width) as f32;
                let least = 0.0625 - 0.5 - low[axis] * scale[axis] as f64;
                offset[axis] = ROUND + (least as i64 + (least > 0.0) as i64) as f32;
            }
            axis += 1;
        }
        Window {
            scale: Vec3::from_array(scale),
            offset: Vec3::from_array(offset),
        }
    }

    /// Which cell the direction from the light is in. Of those outside the window any: nothing is met
    /// there, so that all candidates are right.
    #[inline(always)]
    fn cell(&self, direction: Vec3) -> usize {
        let at = self.window.offset + self.window.scale * direction;
        let mask = Self::SIDE as u32 - 1;
        let [x, y, z] = at.to_array().map(|it| it.to_bits() & mask);
        (x | y << Self::BITS | z << (2 * Self::BITS)) as usize
    }
}

macro_rules! cells {
    ($($width:ty: $most:literal),*) => {$(
        impl<const N: usize> LightBuffer<$width, N> {
            /// A light whose candidates are known: made before the program is built, in a `static`.
            ///
            /// `spheres` are the first objects of the scene's geometry, in order; what comes after them is
            /// a candidate everywhere. Shadows of others would be missing.
            pub const fn new<M>(light: Light, spheres: &[Object<'_, Sphere, M>]) -> Self {
                const { assert!(N == 1 << (3 * Self::BITS), "the cells do not make a cube") };
                Self {
                    cells: Self::cells(&light, spheres),
                    window: Self::window(&light, spheres),
                    reach: Self::reach(&light, spheres),
                    light,
                }
            }

            const fn cells<M>(light: &Light, spheres: &[Object<'_, Sphere, M>]) -> [$width; N] {
                let window = Self::window(light, spheres);
                let (scale, offset) = (window.scale.to_array(), window.offset.to_array());
                let mut seen = [None; $most];
                let mut place = 0;
                while place < spheres.len() && place < $most {
                    let it = Seen::new(light, &spheres[place].shape);
                    if !it.is_everywhere {
                        seen[place] = Some(it);
                    }
                    place += 1;
                }
                let mut cells = [-1; N];
                let mut cell = 0;
                while cell < N {
                    // The cell's directions; the whole range along an axis that is not divided.
                    let (mut low, mut high) = ([-1.0; 3], [1.0; 3]);
                    let (mut nearest, mut farthest) = (0.0, 0.0);
                    let mut axis = 0;
                    while axis < 3 {
                        let place = cell >> (axis as u32 * Self::BITS) & (Self::SIDE - 1);
                        let (scale, offset) = (scale[axis] as f64, (offset[axis] - ROUND) as f64);
                        if scale > 0.0 {
                            let middle = place as f64 - offset;
                            low[axis] = (middle - 0.5) / scale;
                            high[axis] = (middle + 0.5) / scale;
                        }
                        let (low, high) = (low[axis], high[axis]);
                        let least = f64::max(f64::max(low, -high), 0.0);
                        let most = f64::max(-low, high);
                        nearest += least * least;
                        farthest += most * most;
                        axis += 1;
                    }
                    // Most cells of a cube hold no unit vector.
                    let is_empty = nearest > 1.001 || farthest < 0.999;
                    let mut place = 0;
                    while place < $most {
                        if let Some(seen) = &seen[place]
                            && (is_empty || !seen.touches(low, high))
                        {
                            cells[cell] &= !(1 << place);
                        }
                        place += 1;
                    }
                    cell += 1;
                }
                cells
            }
        }
    )*};
}

cells!(i8: 7, i16: 15, i32: 31);

impl<C: Copy + Into<i32>, const N: usize> LightSource for LightBuffer<C, N> {
    #[inline(always)]
    fn position(&self) -> Vec3 {
        self.light.position
    }

    #[inline(always)]
    fn color(&self) -> Vec3 {
        self.light.color
    }

    #[inline(always)]
    fn casts_shadows(&self) -> bool {
        true
    }

    #[inline(always)]
    fn candidates(&self, direction: Vec3, distance: f32) -> Candidates {
        match self.cells.get(self.cell(-direction)) {
            // The narrower widths keep the sign: their last bit, too, is for all others. Of numbers above
            // zero the bits compare as they do.
            Some(&cell) if distance.to_bits() < self.reach.to_bits() => Candidates(cell.into()),
            _ => Candidates::ALL,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Camera, View};
    use crate::material::Material;
    use crate::random::vectors;

    const CHALK: Material = Material::matte(Vec3::ONE, 0.0, 1.0);

    fn ball(x: f32, z: f32) -> Object<'static, Sphere> {
        Object {
            shape: Sphere {
                center: Vec3::new(x, 0.0, z),
                radius: 0.5,
            },
            material: &CHALK,
        }
    }

    #[test]
    fn objects_from_31_on_count_as_one() {
        let some = Candidates::ALL
            .without(0)
            .without(30)
            .without(31)
            .without(99);
        let found: [bool; 5] = [0, 1, 30, 31, 99].map(|it| some.contain(it));
        assert_eq!(found, [false, true, false, true, true]);
        assert_eq!(some.from(29), -2 & !2 | 1);
        assert_eq!(Candidates::ALL.from(1_000_000), -1);
    }

    #[test]
    fn a_culled_slice_answers_as_the_plain_one() {
        let balls = [
            ball(-2.0, -5.0),
            ball(0.0, -9.0),
            ball(0.0, -5.0),
            ball(2.0, -5.0),
        ];
        let (plain, culled) = (balls.as_slice(), Culled(&balls));
        let ray = Ray::new(Vec3::ZERO, Vec3::NEG_Z);
        assert_eq!(culled.closest_hit(&ray), plain.closest_hit(&ray));
        assert_eq!(culled.len(), 4);
        // What is no candidate is not looked at, even where it would be met.
        let blind = Candidates::ALL.without(3);
        let pair = (&balls[..1], culled);
        let hit = |among| {
            pair.closest_hit_by::<Exact>(&ray, among)
                .map(|hit| hit.object)
        };
        let passes = |among| pair.transmittance_by::<Exact>(&ray, among);
        assert_eq!(hit(Candidates::ALL), Some(3));
        assert_eq!(hit(blind), Some(2));
        assert!(pair.blocks::<Exact>(&ray, 0, blind));
        assert_eq!(passes(blind), 0.0);
        let blinder = blind.without(2);
        assert!(!pair.blocks::<Exact>(&ray, 0, blinder));
        assert_eq!(passes(blinder), 1.0);
    }

    /// Those that are asked one by one, and those of a loop, in either order.
    #[test]
    fn culled_slices_of_any_length_answer_as_plain_ones() {
        fn agree<const N: usize>(balls: [Object<'_, Sphere>; N], ray: &Ray) -> bool {
            let (plain, culled) = (balls.as_slice(), Culled(&balls));
            let hit = culled.closest_hit(ray);
            assert_eq!(hit, plain.closest_hit(ray), "{ray:?}");
            assert_eq!(culled.occluded(ray), hit.is_some(), "{ray:?}");
            hit.is_some()
        }
        let mut met = [0; 3];
        let directions = vectors(3).map(Exact::normalize);
        for (i, (origin, direction)) in vectors(4).zip(directions).take(2_000).enumerate() {
            // They overlap, and two are the same.
            let at = |place: usize| ball([-0.75, 0.25, 1.0, 0.25, -0.5][place], 0.0);
            let side = [Side::Inside, Side::Outside][i / 6 % 2];
            let departure = (i % 6 < 5).then_some(Departure {
                object: i % 6,
                side,
            });
            let ray = Ray {
                departure,
                ..Ray::new(origin * 2.0, direction)
            };
            met[0] += agree([at(0), at(1), at(2)], &ray) as usize;
            met[1] += agree([at(3), at(2), at(1), at(0)], &ray) as usize;
            met[2] += agree([0, 1, 2, 3, 4].map(at), &ray) as usize;
        }
        assert!(met.iter().all(|&it| it > 300 && it < 1_700), "{met:?}");
    }

    #[test]
    fn what_leaves_a_sphere_outward_does_not_look_at_it_again() {
        let hollow = |z| {
            let mut ball = ball(0.0, z);
            ball.shape.radius = -0.5;
            ball
        };
        let balls = [ball(0.0, 0.0), hollow(3.0)];
        let pair = (&balls[..1], Culled(&balls));
        let onward = |object, side| {
            let among = pair.onward(Departure { object, side }, 0);
            [0, 1, 2].map(|it| among.contain(it))
        };
        assert_eq!(onward(1, Side::Outside), [true, false, true]);
        assert_eq!(onward(1, Side::Inside), [true; 3]);
        assert_eq!(onward(2, Side::Outside), [true; 3], "met again from within");
        assert_eq!(onward(0, Side::Outside), [true; 3], "not culled");
    }

    #[test]
    fn a_row_carries_what_each_stretch_may_meet() {
        let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 0.5, 1.0).unwrap();
        let view = View {
            camera,
            width: 64,
            height: 64,
        };
        let balls = [ball(-2.0, -5.0), ball(0.0, -9.0), ball(2.0, -5.0)];
        let culled = Culled(&balls);
        let bits = |row, column| {
            let (_, among) = view.rays(row).towards(&culled).nth(column).unwrap();
            [0, 1, 2].map(|it| among.contain(it))
        };
        assert_eq!(bits(0, 0), [false; 3]);
        assert_eq!(bits(31, 0), [true, false, false]);
        assert_eq!(bits(31, 31), [false, true, false]);
        assert_eq!(bits(32, 63), [false, false, true]);
        assert_eq!(view.rays(0).towards(&culled).len(), 64);
        assert_eq!(view.rays(0).towards(&culled).nth(64), None);
        // On the right of a pair, where places are counted on.
        let pair = ([ball(0.0, 0.0)], culled);
        let pair = (pair.0.as_slice(), pair.1);
        let (_, among) = view.rays(31).towards(&pair).next().unwrap();
        let found: [bool; 4] = [0, 1, 2, 3].map(|it| among.contain(it));
        assert_eq!(found, [true, true, false, false]);
    }

    #[test]
    fn a_light_knows_what_lies_in_each_direction() {
        let balls = [ball(-2.0, 0.0), ball(2.0, 0.0)];
        let lamp = Light {
            position: Vec3::ZERO,
            color: Vec3::ONE,
        };
        let buffer = LightBuffer::<i8, 64>::new(lamp, &balls);
        let towards = |x: f32, distance| {
            let candidates = buffer.candidates(Vec3::new(x, 0.0, 0.0), distance);
            [0, 1, 2].map(|it| candidates.contain(it))
        };
        assert_eq!(
            towards(1.0, 5.0),
            [true, false, true],
            "what comes after, too"
        );
        assert_eq!(towards(-1.0, 5.0), [false, true, true]);
        assert_eq!(towards(-1.0, 1e6), [true; 3], "too far to be sure");
        assert_eq!(towards(f32::NAN, f32::NAN), [true; 3]);
        // A sphere round the light, and one that is nowhere.
        let odd = [ball(0.0, 0.1), ball(f32::NAN, 0.0)];
        let buffer = LightBuffer::<i16, 512>::new(lamp, &odd);
        assert_eq!(buffer.candidates(Vec3::Y, 1.0), Candidates::ALL);
    }
}
