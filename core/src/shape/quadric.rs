//! Quadrics: ellipsoids, closed or open cylinders and cones, paraboloids, hyperboloids, and all others.

use core::fmt;

use glam::Vec3;

use super::cuboid::slab;
use super::{Closed, Shape, mapping, within};
use crate::math::{self, Math, dot, length_squared};
use crate::ray::{Ray, Side};

/// All points at which a polynomial of degree two is zero and that the [`Clip`] holds; where it is
/// [closed](Ends::Closed), with flat faces that make it the surface of the solid in which the polynomial
/// is negative.
///
/// With q = (x, y, z) from the center, the polynomial is `squares·(x², y², z²) + 2 products·(yz, zx, xy) +
/// 2 linear·q + constant`. It is negative inside, and grows outward. One without zeros is never met.
///
/// The center is where digits survive: the ray's origin moves to the closest approach to it before
/// anything is squared. Put it in the middle of what is seen, or at the tip of a cone. Round an axis that
/// is not a coordinate axis, a cylinder sags by the rounding of its coefficients: at distance s from the
/// center by about 2^-25 s² over its radius. What is longer than a thousand radii is better a
/// [`Frustum`](crate::Frustum), which is open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadric {
    /// From which the polynomial and the clip are measured, in world space.
    pub center: Vec3,
    /// The coefficients of x², y² and z². Of these and the products, the greatest is from 1 to 2, so that
    /// the square of the discriminant stays in range.
    pub squares: Vec3,
    /// Half of those of yz, zx and xy.
    pub products: Vec3,
    /// Half of those of x, y and z.
    pub linear: Vec3,
    /// The coefficient without any.
    pub constant: f32,
    /// What holds the points that count.
    pub clip: Clip,
    /// Whether there are faces where the clip cuts the solid.
    pub ends: Ends,
}

/// A box and the space between two parallel planes: what is in both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clip {
    /// The corner with the least coordinates, from the quadric's center; negative infinity where there is
    /// no bound.
    pub min: Vec3,
    /// The corner with the greatest; infinity where there is no bound.
    pub max: Vec3,
    /// Across the planes; unit length, or zero where there are none.
    pub axis: Vec3,
    /// Of the plane where the space begins, its distance along the axis from the quadric's center.
    pub from: f32,
    /// And of the plane where it ends.
    pub to: f32,
}

/// Whether a clipped surface has faces where it is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// None: a pipe.
    Open,
    /// Flat ones: a solid.
    Closed,
}

/// Why some numbers are not a [`Quadric`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum QuadricError {
    /// A number is not finite, bounds of the clip apart, or what is computed of it is not.
    NotFinite,
    /// All coefficients of degree two are zero.
    NotQuadratic,
    /// The clip holds nothing, or a bound is not a number.
    EmptyClip,
    /// The ends are one point.
    ZeroLength,
    /// A radius is not above zero.
    Radius,
    /// The waist of a hyperboloid is not narrower than its ends.
    Waist,
    /// The gap between the two sheets of a hyperboloid is not shorter than the whole.
    Gap,
}

impl fmt::Display for QuadricError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "the numbers, and those that follow from them, must be finite",
            Self::NotQuadratic => "the squares and the products must not all be zero",
            Self::EmptyClip => "the clip must hold something",
            Self::ZeroLength => "the two ends must not be the same point",
            Self::Radius => "a radius must be above zero",
            Self::Waist => "the waist must be narrower than the ends",
            Self::Gap => "the gap must be above zero and shorter than the distance of the ends",
        })
    }
}

impl core::error::Error for QuadricError {}

impl Clip {
    /// Holds everything.
    pub const NONE: Self = Self {
        min: Vec3::NEG_INFINITY,
        max: Vec3::INFINITY,
        axis: Vec3::ZERO,
        from: f32::NEG_INFINITY,
        to: f32::INFINITY,
    };

    /// Where a ray whose origin is at `q` from the center is inside; `None` if it never is.
    #[inline(always)]
    fn span(&self, q: Vec3, direction: Vec3, reciprocal: &Vec3) -> Option<(f32, f32)> {
        let (d, r) = (direction, reciprocal);
        let x = slab(q.x, d.x, r.x, self.min.x, self.max.x)?;
        let y = slab(q.y, d.y, r.y, self.min.y, self.max.y)?;
        let z = slab(q.z, d.z, r.z, self.min.z, self.max.z)?;
        let (place, rate) = (dot(&self.axis, &q), dot(&self.axis, &d));
        let along = slab(place, rate, 1.0 / rate, self.from, self.to)?;
        let later = |a: f32, b: f32| if a > b { a } else { b };
        let earlier = |a: f32, b: f32| if a < b { a } else { b };
        let from = later(later(x.0, y.0), later(z.0, along.0));
        let to = earlier(earlier(x.1, y.1), earlier(z.1, along.1));
        // As for the box, NaN may have been passed over.
        let widths = (x.1 - x.0) + (y.1 - y.0) + (z.1 - z.0) + (along.1 - along.0);
        (from <= to && widths >= 0.0).then_some((from, to))
    }

    /// Distance from the nearest of the planes, and its outward normal.
    #[inline]
    fn face(&self, q: Vec3) -> (f32, Vec3) {
        let place = dot(&self.axis, &q);
        let faces = [
            (q.x - self.min.x, Vec3::NEG_X),
            (q.x - self.max.x, Vec3::X),
            (q.y - self.min.y, Vec3::NEG_Y),
            (q.y - self.max.y, Vec3::Y),
            (q.z - self.min.z, Vec3::NEG_Z),
            (q.z - self.max.z, Vec3::Z),
            (place - self.from, -self.axis),
            (place - self.to, self.axis),
        ];
        let mut nearest = (f32::INFINITY, Vec3::ZERO);
        for (offset, normal) in faces {
            if offset.abs() < nearest.0 {
                nearest = (offset.abs(), normal);
            }
        }
        nearest
    }
}

/// A point of a ray, and the polynomial along the ray from there: `a t² + 2 b t + c`.
struct Line {
    q: Vec3,
    a: f32,
    b: f32,
    c: f32,
}

/// Where a ray enters a quadric and where it leaves it.
struct Roots {
    entry: f32,
    exit: f32,
}

/// What a polynomial without zeros is.
enum Sign {
    Outside,
    Inside,
}

impl Line {
    /// Whether the discriminant's terms leave digits when they cancel, or moving on to where the polynomial
    /// is extreme would not change that.
    #[inline(always)]
    fn is_sure(&self) -> bool {
        let (square, product) = (self.b * self.b, self.a * self.c);
        !(product > 0.75 * square && product < 2.0 * square)
    }

    #[inline(always)]
    fn roots<P: Math>(&self) -> Result<Roots, Sign> {
        let Self { a, b, c, .. } = *self;
        let constant = a == 0.0 && b == 0.0;
        let discriminant = b * b - a * c;
        if constant && c < 0.0 || a < 0.0 && discriminant < 0.0 {
            return Err(Sign::Inside);
        }
        // Also true for NaN.
        if constant || !(discriminant >= 0.0) {
            return Err(Sign::Outside);
        }
        let root = P::sqrt(discriminant);
        // The derivative at a root is twice the root of the discriminant: negative where the ray enters,
        // positive where it leaves, also where that comes first.
        let (entry, exit) = if b > 0.0 {
            let q = -b - root;
            (q / a, c / q)
        } else {
            let q = root - b;
            // Where b, c and so q are zero, both are.
            let near = if q > 0.0 { c / q } else { 0.0 };
            (near, q / a)
        };
        Ok(Roots { entry, exit })
    }

    /// To the nearest zero, where there is one.
    #[inline(always)]
    fn step<P: Math>(&self) -> f32 {
        let Self { a, b, c, .. } = *self;
        let discriminant = b * b - a * c;
        // Also false for NaN, and where this is an extreme.
        if discriminant > 0.0 {
            let root = P::sqrt(discriminant);
            -c / (b + if b < 0.0 { -root } else { root })
        } else {
            0.0
        }
    }
}

impl Quadric {
    /// The quadric `squares·(x², y², z²) + products·(yz, zx, xy) + linear·(x, y, z) + constant = 0`, with
    /// coordinates and the clip from the center. Multiples of all coefficients by a power of two give the
    /// same bits; the negative of all is the same surface inside out. The clip's axis is of any length.
    ///
    /// # Errors
    ///
    /// Where a number is not finite (of the clip's bounds, not a number), all coefficients of squares and
    /// products are zero, or the clip is empty.
    pub fn new(
        center: Vec3,
        squares: Vec3,
        products: Vec3,
        linear: Vec3,
        constant: f32,
        clip: Clip,
        ends: Ends,
    ) -> Result<Self, QuadricError> {
        let wide = |v: Vec3| v.to_array().map(f64::from);
        let half = |v: Vec3| wide(v).map(|x| 0.5 * x);
        let polynomial = Polynomial {
            squares: wide(squares),
            products: half(products),
            linear: half(linear),
            constant: f64::from(constant),
        };
        if !clip.axis.is_finite() {
            return Err(QuadricError::NotFinite);
        }
        let clip = match math::unit(wide(clip.axis)) {
            Some((_, axis)) => Clip { axis, ..clip },
            None => Clip {
                axis: Vec3::ZERO,
                from: f32::NEG_INFINITY,
                to: f32::INFINITY,
                ..clip
            },
        };
        polynomial.quadric(center, clip, ends)
    }

    /// An ellipsoid with its axes along those of the world; `radii` are half its extent.
    ///
    /// # Errors
    ///
    /// Where a number is not finite or a radius not above zero.
    pub fn ellipsoid(center: Vec3, radii: Vec3) -> Result<Self, QuadricError> {
        if !radii.is_finite() {
            return Err(QuadricError::NotFinite);
        }
        if !radii.cmpgt(Vec3::ZERO).all() {
            return Err(QuadricError::Radius);
        }
        let radii = radii.to_array().map(f64::from);
        let least = radii[0].min(radii[1]).min(radii[2]);
        let polynomial = Polynomial {
            squares: radii.map(|r| (least / r) * (least / r)),
            products: [0.0; 3],
            linear: [0.0; 3],
            constant: -least * least,
        };
        polynomial.quadric(center, bounds(radii.map(|r| [-r, r])), Ends::Open)
    }

    /// A cylinder between two circles.
    ///
    /// # Errors
    ///
    /// Where a number is not finite, the radius not above zero, or the ends are the same point.
    pub fn cylinder(base: Vec3, apex: Vec3, radius: f32, ends: Ends) -> Result<Self, QuadricError> {
        let axis = Axis::new(base, apex)?;
        let radius = positive(radius)?;
        axis.centered(ends, [radius; 2], [radius * radius, 0.0])
    }

    /// A cone, or the part of one between two circles. The narrower end is the center.
    ///
    /// # Errors
    ///
    /// Where a number is not finite, a radius negative or both are zero, or the ends are the same point.
    pub fn cone(
        base: Vec3,
        base_radius: f32,
        apex: Vec3,
        apex_radius: f32,
        ends: Ends,
    ) -> Result<Self, QuadricError> {
        if !(base_radius.is_finite() && apex_radius.is_finite()) {
            return Err(QuadricError::NotFinite);
        }
        let (narrow, wide) = if apex_radius < base_radius {
            ((apex, apex_radius), (base, base_radius))
        } else {
            ((base, base_radius), (apex, apex_radius))
        };
        if !(narrow.1 >= 0.0 && wide.1 > 0.0) {
            return Err(QuadricError::Radius);
        }
        let axis = Axis::new(narrow.0, wide.0)?;
        let [narrow_radius, wide_radius] = [narrow.1, wide.1].map(f64::from);
        let slope = (wide_radius - narrow_radius) / axis.length;
        let squared_radius = [
            narrow_radius * narrow_radius,
            narrow_radius * slope,
            slope * slope,
        ];
        axis.revolution(
            narrow.0,
            ends,
            [0.0, axis.length],
            [narrow_radius, wide_radius],
            squared_radius,
        )
    }

    /// A paraboloid from its tip to the circle round `end`.
    ///
    /// # Errors
    ///
    /// Where a number is not finite, the radius not above zero, or tip and end are the same point.
    pub fn paraboloid(tip: Vec3, end: Vec3, radius: f32, ends: Ends) -> Result<Self, QuadricError> {
        let axis = Axis::new(tip, end)?;
        let radius = positive(radius)?;
        let squared_radius = [0.0, 0.5 * radius * radius / axis.length, 0.0];
        let mut paraboloid =
            axis.revolution(tip, ends, [0.0, axis.length], [radius; 2], squared_radius)?;
        // There is nothing to cut at the tip.
        paraboloid.clip.from = f32::NEG_INFINITY;
        Ok(paraboloid)
    }

    /// A hyperboloid of one sheet between two equal circles, narrowest in the middle.
    ///
    /// # Errors
    ///
    /// Where a number is not finite, a radius not above zero, the waist not narrower than the ends, or the
    /// ends are the same point.
    pub fn hyperboloid(
        base: Vec3,
        apex: Vec3,
        radius: f32,
        waist: f32,
        ends: Ends,
    ) -> Result<Self, QuadricError> {
        let axis = Axis::new(base, apex)?;
        let (radius, waist) = (positive(radius)?, positive(waist)?);
        if !(waist < radius) {
            return Err(QuadricError::Waist);
        }
        let half = 0.5 * axis.length;
        let growth = (radius - waist) * (radius + waist) / (half * half);
        axis.centered(ends, [radius; 2], [waist * waist, growth])
    }

    /// A hyperboloid of two sheets: two cups between two equal circles, their tips `gap` apart.
    ///
    /// # Errors
    ///
    /// Where a number is not finite, the radius not above zero, the gap not above zero and below the
    /// distance of the ends, or the ends are the same point.
    pub fn two_sheets(
        base: Vec3,
        apex: Vec3,
        radius: f32,
        gap: f32,
        ends: Ends,
    ) -> Result<Self, QuadricError> {
        let axis = Axis::new(base, apex)?;
        let radius = positive(radius)?;
        let gap = f64::from(gap);
        if !(gap > 0.0 && gap < axis.length) {
            return Err(QuadricError::Gap);
        }
        let growth = 4.0 * radius * radius / ((axis.length - gap) * (axis.length + gap));
        axis.centered(ends, [radius; 2], [-0.25 * growth * gap * gap, growth])
    }

    /// The part of the polynomial that is of degree two, times `v` as a symmetric matrix.
    #[inline(always)]
    fn times(&self, v: Vec3) -> Vec3 {
        let p = self.products;
        Vec3::new(
            self.squares.x * v.x + (p.z * v.y + p.y * v.z),
            self.squares.y * v.y + (p.z * v.x + p.x * v.z),
            self.squares.z * v.z + (p.y * v.x + p.x * v.y),
        )
    }

    /// Half of the polynomial's gradient, and its value.
    #[inline(always)]
    fn at(&self, q: Vec3) -> (Vec3, f32) {
        let half_gradient = self.times(q) + self.linear;
        let value = dot(&q, &(half_gradient + self.linear)) + self.constant;
        (half_gradient, value)
    }

    #[inline(always)]
    fn line(&self, q: Vec3, direction: Vec3, a: f32) -> Line {
        let (half_gradient, c) = self.at(q);
        let b = dot(&half_gradient, &direction);
        Line { q, a, b, c }
    }

    /// The outward normal of the face on which a point of the surface lies, if that is on one.
    #[inline]
    fn face<P: Math>(&self, q: Vec3) -> Option<Vec3> {
        if self.ends == Ends::Open {
            return None;
        }
        let (distance, normal) = self.clip.face(q);
        let (half_gradient, value) = self.at(q);
        // The quadric's distance is its value over its gradient, to first order.
        let steepness = 2.0 * P::sqrt(length_squared(&half_gradient));
        (value.abs() > steepness * distance).then_some(normal)
    }

    /// Two pairs of points where the ray is on the surface, whether or not it admits them; NaN in the
    /// place of those that are not.
    #[inline]
    fn meets<P: Math>(&self, ray: &Ray, reciprocal: &Vec3, leaving: Option<Side>) -> [f32; 4] {
        const NOTHING: [f32; 4] = [f32::NAN; 4];
        let direction = ray.direction;
        let origin = ray.origin - self.center;
        let Some((mut from, to)) = self.clip.span(origin, direction, reciprocal) else {
            return NOTHING;
        };
        if !(to > 0.0) {
            return NOTHING;
        }
        // A ray that leaves a point off the surface may find a root before it enters.
        if leaving.is_none() && !(from < ray.t_max) {
            return NOTHING;
        }
        let a = dot(&self.times(direction), &direction) + 0.0;
        let (shift, line) = match leaving {
            None => {
                // The origin moves to the ray's closest approach before anything is squared, as for the
                // sphere, and from there, where the discriminant cancels, to where the polynomial is
                // extreme.
                let approach = -dot(&origin, &direction);
                let line = self.line(origin + direction * approach, direction, a);
                if line.is_sure() {
                    (approach, line)
                } else {
                    let further = -line.b / a;
                    let q = line.q + direction * further;
                    (approach + further, self.line(q, direction, a))
                }
            }
            Some(side) => {
                // What leaves is not before the clip.
                from = if from < 0.0 { from } else { 0.0 };
                let mut line = self.line(origin, direction, a);
                match (self.face::<P>(origin), side) {
                    // All is on the other side of a face.
                    (Some(_), Side::Outside) => return NOTHING,
                    // The ray starts in the quadric.
                    (Some(_), Side::Inside) => line.c = -math::positive(-line.c),
                    // It starts on the quadric and goes to that side.
                    (None, Side::Outside) => (line.b, line.c) = (line.b.abs(), 0.0),
                    (None, Side::Inside) => (line.b, line.c) = (-line.b.abs(), 0.0),
                }
                (0.0, line)
            }
        };
        let Roots { entry, exit } = match line.roots::<P>() {
            Ok(roots) => roots,
            Err(Sign::Inside) if self.ends == Ends::Closed => {
                return [from, to, f32::NAN, f32::NAN];
            }
            Err(_) => return NOTHING,
        };
        // The coefficients were those of a point that may be far from the root, against the size of the
        // quadric; from the root itself, what is left to go has all its digits.
        let refined = |root: f32| {
            // What the ray leaves stays behind it.
            if leaving.is_some() && !(root > 0.0) {
                return root;
            }
            let there = self.line(line.q + direction * root, direction, a);
            let near = root + there.step::<P>();
            shift + if near.is_finite() { near } else { root }
        };
        let (entry, exit) = (refined(entry), refined(exit));
        if self.ends == Ends::Open {
            let within = |t: f32| if from <= t && t <= to { t } else { f32::NAN };
            return [within(entry), within(exit), f32::NAN, f32::NAN];
        }
        let begin = if entry > from { entry } else { from };
        let end = if exit < to { exit } else { to };
        let pair = |begin: f32, end: f32| {
            if begin <= end {
                [begin, end]
            } else {
                [f32::NAN; 2]
            }
        };
        let ([b0, e0], [b1, e1]) = if a < 0.0 {
            // Inside far away.
            (pair(from, end), pair(begin, to))
        } else {
            (pair(begin, end), [f32::NAN; 2])
        };
        [b0, e0, b1, e1]
    }
}

impl Shape for Quadric {
    /// The reciprocals of the direction's components.
    type Setup = Vec3;

    #[inline]
    fn setup(ray: &Ray) -> Vec3 {
        ray.direction.recip()
    }

    #[inline]
    fn intersect<P: Math>(
        &self,
        ray: &Ray,
        reciprocal: &Vec3,
        leaving: Option<Side>,
    ) -> Option<f32> {
        let mut nearest = None;
        let mut before = ray.t_max;
        for t in self.meets::<P>(ray, reciprocal, leaving) {
            if t > 0.0 && t < before {
                before = t;
                nearest = Some(t);
            }
        }
        nearest
    }

    #[inline]
    fn crossings<P: Math>(&self, ray: &Ray, reciprocal: &Vec3, leaving: Option<Side>) -> u32 {
        let met = self.meets::<P>(ray, reciprocal, leaving);
        met.iter().filter(|&&t| ray.admits(t)).count() as u32
    }

    /// Through a clip without faces light enters and leaves unnoticed: inside is what lies between two points
    /// that are met.
    #[inline]
    fn inside<P: Math>(&self, ray: &Ray, reciprocal: &Vec3, leaving: Option<Side>) -> f32 {
        let [b0, e0, b1, e1] = self.meets::<P>(ray, reciprocal, leaving);
        within(ray, b0, e0) + within(ray, b1, e1)
    }

    /// The angle about the clip's axis, or y where it has none, from 0 to 1, and the height along it: from 0 to
    /// 1 between the planes, or between the faces of the box if the axis is y; else in world units.
    #[inline]
    fn uv(&self, point: Vec3) -> (f32, f32) {
        let Clip {
            min,
            max,
            axis,
            from,
            to,
        } = self.clip;
        let q = point - self.center;
        let (axis, from, to) = if axis == Vec3::ZERO {
            (Vec3::Y, min.y, max.y)
        } else {
            (axis, from, to)
        };
        let height = dot(&q, &axis);
        let share = (height - from) / (to - from);
        let v = if (to - from).is_finite() {
            share
        } else {
            height
        };
        (mapping::around(q, axis).0, v)
    }

    #[inline]
    fn normal<P: Math>(&self, ray: &Ray, t: f32) -> Vec3 {
        let q = ray.at(t) - self.center;
        if let Some(normal) = self.face::<P>(q) {
            return normal;
        }
        let (half_gradient, _) = self.at(q);
        if length_squared(&half_gradient) > 0.0 {
            P::normalize(half_gradient)
        } else {
            // At the tip of a cone there is no direction.
            -ray.direction
        }
    }
}

impl Closed for Quadric {
    const CROSSINGS: usize = 4;

    #[inline]
    fn cross<P: Math>(
        &self,
        ray: &Ray,
        leaving: Option<Side>,
        visit: &mut impl FnMut(f32),
    ) -> bool {
        let mut ends_inside = false;
        for t in self.meets::<P>(ray, &Self::setup(ray), leaving) {
            // Where there is no end, the ray leaves at infinity.
            ends_inside |= t == f32::INFINITY;
            if ray.admits(t) {
                visit(t);
            }
        }
        ends_inside
    }
}

/// A [`Quadric`] before it is rounded.
struct Polynomial {
    squares: [f64; 3],
    products: [f64; 3],
    linear: [f64; 3],
    constant: f64,
}

impl Polynomial {
    fn quadric(self, center: Vec3, clip: Clip, ends: Ends) -> Result<Quadric, QuadricError> {
        let second = self.squares.iter().chain(&self.products);
        let greatest = second.fold(
            0.0,
            |most: f64, x| if x.abs() > most { x.abs() } else { most },
        );
        // Exactly a power of two, so that no digit is lost.
        let scale = libm::ldexp(1.0, 1 - libm::frexp(greatest).1);
        let narrow = |v: [f64; 3]| Vec3::from_array(v.map(|x| (x * scale) as f32));
        let quadric = Quadric {
            center,
            squares: narrow(self.squares),
            products: narrow(self.products),
            linear: narrow(self.linear),
            constant: (self.constant * scale) as f32,
            clip,
            ends,
        };
        let vectors = [center, quadric.squares, quadric.products, quadric.linear];
        if !(vectors.iter().all(|v| v.is_finite()) && quadric.constant.is_finite()) {
            return Err(QuadricError::NotFinite);
        }
        if greatest == 0.0 {
            return Err(QuadricError::NotQuadratic);
        }
        // Also true for NaN.
        if !(clip.min.cmple(clip.max).all() && clip.from <= clip.to) {
            return Err(QuadricError::EmptyClip);
        }
        Ok(quadric)
    }
}

/// A radius, and whether it is one.
fn positive(radius: f32) -> Result<f64, QuadricError> {
    if !radius.is_finite() {
        Err(QuadricError::NotFinite)
    } else if radius > 0.0 {
        Ok(f64::from(radius))
    } else {
        Err(QuadricError::Radius)
    }
}

/// A clip that cuts nothing of what reaches from the first to the second number along each axis: it lets
/// rays pass by, and tells builders of hierarchies how large the quadric is.
fn bounds(reach: [[f64; 2]; 3]) -> Clip {
    const MARGIN: f64 = 1.0 / (1 << 20) as f64;
    let wider = |[least, greatest]: [f64; 2]| {
        let margin = MARGIN * (greatest - least);
        [(least - margin) as f32, (greatest + margin) as f32]
    };
    let [x, y, z] = reach.map(wider);
    Clip {
        min: Vec3::new(x[0], y[0], z[0]),
        max: Vec3::new(x[1], y[1], z[1]),
        ..Clip::NONE
    }
}

/// The axis of a surface of revolution.
struct Axis {
    base: Vec3,
    apex: Vec3,
    length: f64,
    /// Unit length.
    direction: [f64; 3],
}

impl Axis {
    fn new(base: Vec3, apex: Vec3) -> Result<Self, QuadricError> {
        if !(base.is_finite() && apex.is_finite()) {
            return Err(QuadricError::NotFinite);
        }
        let way = math::difference(apex, base);
        let length = libm::sqrt(way.iter().map(|x| x * x).sum());
        if length == 0.0 {
            return Err(QuadricError::ZeroLength);
        }
        Ok(Self {
            base,
            apex,
            length,
            direction: way.map(|x| x / length),
        })
    }

    /// A surface whose squared radius is `constant + growth * s²` at a distance s from the middle.
    fn centered(
        &self,
        ends: Ends,
        radii: [f64; 2],
        [constant, growth]: [f64; 2],
    ) -> Result<Quadric, QuadricError> {
        let half = 0.5 * self.length;
        let center = self.base * 0.5 + self.apex * 0.5;
        self.revolution(center, ends, [-half, half], radii, [constant, 0.0, growth])
    }

    /// A surface round the axis whose squared radius is `constant + 2 linear * s + growth * s²` at a
    /// distance s from the center, between these two; nowhere wider than these radii.
    fn revolution(
        &self,
        center: Vec3,
        ends: Ends,
        [from, to]: [f64; 2],
        radii: [f64; 2],
        [constant, linear, growth]: [f64; 3],
    ) -> Result<Quadric, QuadricError> {
        let n = self.direction;
        let factor = 1.0 + growth;
        let polynomial = Polynomial {
            squares: n.map(|x| 1.0 - factor * x * x),
            products: [n[1] * n[2], n[2] * n[0], n[0] * n[1]].map(|x| -factor * x),
            linear: n.map(|x| -linear * x),
            constant: -constant,
        };
        let clip = Clip {
            axis: Vec3::from_array(n.map(|x| x as f32)),
            from: from as f32,
            to: to as f32,
            ..bounds(n.map(|x| {
                // A circle reaches as far along a coordinate axis as that is across its own.
                let across = libm::sqrt(1.0 - if x * x < 1.0 { x * x } else { 1.0 });
                let [least, greatest] = [-across, across]
                    .map(|across| [x * from + across * radii[0], x * to + across * radii[1]]);
                [least[0].min(least[1]), greatest[0].max(greatest[1])]
            }))
        };
        polynomial.quadric(center, clip, ends)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use crate::math::Exact;

    const UP: Vec3 = Vec3::new(0.0, 2.0, 0.0);

    fn cylinder(ends: Ends) -> Quadric {
        Quadric::cylinder(Vec3::ZERO, UP, 1.0, ends).unwrap()
    }

    fn cone(ends: Ends) -> Quadric {
        Quadric::cone(Vec3::ZERO, 1.0, UP, 0.0, ends).unwrap()
    }

    fn cups(ends: Ends) -> Quadric {
        Quadric::two_sheets(-UP, UP, 1.0, 2.0, ends).unwrap()
    }

    fn ray(origin: [f32; 3], direction: [f32; 3]) -> Ray {
        Ray::new(
            Vec3::from_array(origin),
            Exact::normalize(Vec3::from_array(direction)),
        )
    }

    /// All points where the ray is on the surface, and the normals there.
    fn meets(quadric: &Quadric, ray: &Ray, leaving: Option<Side>) -> std::vec::Vec<(f32, Vec3)> {
        let setup = Quadric::setup(ray);
        let (mut found, mut before) = (std::vec::Vec::new(), *ray);
        let mut met = quadric.meets::<Exact>(ray, &setup, leaving);
        met.sort_by(f32::total_cmp);
        for t in met.into_iter().filter(|&t| ray.admits(t)) {
            found.push((t, quadric.normal::<Exact>(ray, t)));
        }
        let nearest = found.first().map(|it| it.0);
        assert_eq!(quadric.intersect::<Exact>(ray, &setup, leaving), nearest);
        let count = found.len() as u32;
        assert_eq!(quadric.crossings::<Exact>(ray, &setup, leaving), count);
        // The end of a ray is open.
        before.t_max = nearest.unwrap_or(1.0);
        assert_eq!(quadric.intersect::<Exact>(&before, &setup, leaving), None);
        found
    }

    fn distances(quadric: &Quadric, ray: &Ray) -> std::vec::Vec<f32> {
        meets(quadric, ray, None)
            .into_iter()
            .map(|it| it.0)
            .collect()
    }

    #[test]
    fn open_and_closed_shapes_are_met() {
        use Ends::{Closed, Open};
        let across = |y: f32| ray([-3.0, y, 0.0], [1.0, 0.0, 0.0]);
        let up = |x: f32| ray([x, -3.0, 0.0], [0.0, 1.0, 0.0]);
        let bowl = |ends| Quadric::paraboloid(Vec3::ZERO, UP, 1.0, ends).unwrap();
        let waisted = |ends| Quadric::hyperboloid(-UP, UP, 2.0, 1.0, ends).unwrap();
        let egg = Quadric::ellipsoid(Vec3::ZERO, Vec3::new(1.0, 2.0, 0.5)).unwrap();
        let cases: [(&str, Quadric, Ray, &[f32]); 24] = [
            ("egg, across", egg, across(0.0), &[2.0, 4.0]),
            ("egg, up", egg, up(0.0), &[1.0, 5.0]),
            ("egg, touched", egg, across(2.0), &[3.0, 3.0]),
            ("egg, passed", egg, across(2.000_001), &[]),
            ("pipe, across", cylinder(Open), across(1.0), &[2.0, 4.0]),
            ("pipe, at its end", cylinder(Open), across(2.0), &[2.0, 4.0]),
            ("pipe, above", cylinder(Open), across(2.000_001), &[]),
            ("pipe, along its axis", cylinder(Open), up(0.0), &[]),
            ("pipe, along its side", cylinder(Open), up(1.0), &[]),
            ("can, across", cylinder(Closed), across(1.0), &[2.0, 4.0]),
            (
                "can, along its axis",
                cylinder(Closed),
                up(0.5),
                &[3.0, 5.0],
            ),
            ("can, beside it", cylinder(Closed), up(1.000_001), &[]),
            ("funnel, across", cone(Open), across(1.0), &[2.5, 3.5]),
            ("funnel, up", cone(Open), up(0.5), &[4.0]),
            ("funnel, other half", cone(Open), across(2.5), &[]),
            ("solid cone, up", cone(Closed), up(0.5), &[3.0, 4.0]),
            ("bowl, across", bowl(Open), across(0.5), &[2.5, 3.5]),
            ("bowl, up", bowl(Open), up(0.5), &[3.5]),
            ("full bowl, up", bowl(Closed), up(0.5), &[3.5, 5.0]),
            ("waist, across", waisted(Open), across(0.0), &[2.0, 4.0]),
            ("waist, up", waisted(Closed), up(0.5), &[1.0, 5.0]),
            ("cups, between", cups(Open), across(0.0), &[]),
            ("cups, up", cups(Open), up(0.0), &[2.0, 4.0]),
            (
                "full cups, up",
                cups(Closed),
                up(0.0),
                &[1.0, 2.0, 4.0, 5.0],
            ),
        ];
        for (name, quadric, ray, expected) in cases {
            let found = distances(&quadric, &ray);
            assert_eq!(found.len(), expected.len(), "{name}: {found:?}");
            for (t, expected) in found.iter().zip(expected) {
                assert!((t - expected).abs() < 1e-6, "{name}: {found:?}");
            }
        }
    }

    #[test]
    fn a_clip_by_a_box_lets_rays_through_to_the_far_side() {
        let bowl = Clip {
            max: Vec3::new(9.0, 0.25, 9.0),
            ..Clip::NONE
        };
        let sphere = |ends| {
            Quadric::new(
                Vec3::ZERO,
                Vec3::ONE,
                Vec3::ZERO,
                Vec3::ZERO,
                -1.0,
                bowl,
                ends,
            )
            .unwrap()
        };
        let down = ray([0.0, 3.0, 0.0], [0.0, -1.0, 0.0]);
        assert_eq!(
            meets(&sphere(Ends::Open), &down, None),
            [(4.0, Vec3::NEG_Y)]
        );
        let both = [(2.75, Vec3::Y), (4.0, Vec3::NEG_Y)];
        assert_eq!(meets(&sphere(Ends::Closed), &down, None), both);
    }

    #[test]
    fn directions_without_a_square_are_like_any_other() {
        // z = x y: along both rulings and the axis of the saddle there is one root or none.
        let half = Vec3::new(0.0, 0.0, 1.0);
        let saddle = Quadric::new(
            Vec3::ZERO,
            Vec3::ZERO,
            half,
            Vec3::NEG_Z,
            0.0,
            Clip::NONE,
            Ends::Open,
        )
        .unwrap();
        let cases: [(&str, Ray, &[f32]); 5] = [
            ("down", ray([2.0, 3.0, 10.0], [0.0, 0.0, -1.0]), &[4.0]),
            ("ruling", ray([0.0, 1.0, 3.0], [1.0, 0.0, 0.0]), &[3.0]),
            ("behind", ray([0.0, 1.0, -3.0], [1.0, 0.0, 0.0]), &[]),
            ("beside", ray([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]), &[]),
            ("within", ray([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]), &[]),
        ];
        for (name, ray, expected) in cases {
            assert_eq!(distances(&saddle, &ray), expected, "{name}");
        }
    }

    #[test]
    fn the_origin_may_lie_anywhere() {
        let can = cylinder(Ends::Closed);
        let inside = ray([0.5, 1.0, 0.0], [1.0, 0.0, 0.0]);
        assert_eq!(meets(&can, &inside, None), [(0.5, Vec3::X)]);
        let behind = ray([3.0, 1.0, 0.0], [1.0, 0.0, 0.0]);
        assert_eq!(meets(&can, &behind, None), []);
        let on = ray([-1.0, 1.0, 0.0], [1.0, 0.0, 0.0]);
        assert_eq!(meets(&can, &on, None), [(2.0, Vec3::X)]);
        let at_the_tip = ray([0.0, 2.0, 0.0], [0.0, 1.0, 0.0]);
        assert_eq!(meets(&cone(Ends::Closed), &at_the_tip, None), []);
        let to_the_tip = ray([0.0, 4.0, 0.0], [0.0, -1.0, 0.0]);
        assert_eq!(
            meets(&cone(Ends::Open), &to_the_tip, None)[0],
            (2.0, Vec3::Y)
        );
    }

    #[test]
    fn what_leaves_meets_only_other_points() {
        use Side::{Inside, Outside};
        let can = cylinder(Ends::Closed);
        let left = |quadric: &Quadric, ray: &Ray, side| -> std::vec::Vec<f32> {
            let found = meets(quadric, ray, Some(side));
            found.into_iter().map(|it| it.0).collect()
        };
        let side = ray([1.0, 1.0, 0.0], [-1.0, 0.0, 0.0]);
        assert_eq!(left(&can, &side, Inside), [2.0]);
        assert!(left(&can, &side, Outside).is_empty());
        let top = ray([0.5, 2.0, 0.0], [0.0, -1.0, 0.0]);
        assert_eq!(left(&can, &top, Inside), [2.0]);
        assert!(left(&can, &top, Outside).is_empty());
        // From one cup to the other, and from inside one through its face.
        let tip = ray([0.0, -1.0, 0.0], [0.0, 1.0, 0.0]);
        assert_eq!(left(&cups(Ends::Open), &tip, Outside), [2.0]);
        assert_eq!(left(&cups(Ends::Closed), &tip, Outside), [2.0, 3.0]);
        let down = ray([0.0, -1.0, 0.0], [0.0, -1.0, 0.0]);
        assert_eq!(left(&cups(Ends::Closed), &down, Inside), [1.0]);
        let base = ray([0.0, -2.0, 0.0], [0.0, 1.0, 0.0]);
        assert_eq!(left(&cups(Ends::Closed), &base, Inside), [1.0, 3.0, 4.0]);
    }

    #[test]
    fn multiples_of_the_coefficients_have_the_same_bits() {
        let of = |exponent: i32| {
            let scale = libm::ldexpf(1.0, exponent);
            Quadric::new(
                Vec3::ONE,
                Vec3::new(1.0, -0.5, 0.25) * scale,
                Vec3::new(0.1, 0.2, 0.3) * scale,
                Vec3::new(-0.3, 0.1, 0.0) * scale,
                -0.7 * scale,
                Clip::NONE,
                Ends::Open,
            )
        };
        for exponent in [-60, -1, 1, 60] {
            assert_eq!(of(exponent), of(0), "2^{exponent}");
        }
    }

    #[test]
    fn degenerate_quadrics_are_refused() {
        use QuadricError as E;
        let general = |squares, constant, clip| {
            Quadric::new(
                Vec3::ZERO,
                squares,
                Vec3::ZERO,
                Vec3::X,
                constant,
                clip,
                Ends::Open,
            )
        };
        let inverted = Clip {
            min: Vec3::ONE,
            max: Vec3::ZERO,
            ..Clip::NONE
        };
        let between = |from, to| Clip {
            axis: Vec3::X,
            from,
            to,
            ..Clip::NONE
        };
        let (zero, open) = (Vec3::ZERO, Ends::Open);
        let cases = [
            ("plane", general(zero, 1.0, Clip::NONE), E::NotQuadratic),
            ("NaN", general(Vec3::NAN, 1.0, Clip::NONE), E::NotFinite),
            (
                "out of range",
                general(Vec3::splat(1e-30), 1e30, Clip::NONE),
                E::NotFinite,
            ),
            (
                "inverted box",
                general(Vec3::ONE, 1.0, inverted),
                E::EmptyClip,
            ),
            (
                "inverted planes",
                general(Vec3::ONE, 1.0, between(1.0, 0.0)),
                E::EmptyClip,
            ),
            (
                "no plane",
                general(Vec3::ONE, 1.0, between(f32::NAN, 0.0)),
                E::EmptyClip,
            ),
            (
                "flat",
                Quadric::ellipsoid(zero, Vec3::new(1.0, 0.0, 1.0)),
                E::Radius,
            ),
            (
                "infinite",
                Quadric::ellipsoid(zero, Vec3::INFINITY),
                E::NotFinite,
            ),
            (
                "no length",
                Quadric::cylinder(UP, UP, 1.0, open),
                E::ZeroLength,
            ),
            (
                "no radius",
                Quadric::cylinder(zero, UP, 0.0, open),
                E::Radius,
            ),
            ("a line", Quadric::cone(zero, 0.0, UP, 0.0, open), E::Radius),
            (
                "two signs",
                Quadric::cone(zero, 1.0, UP, -1.0, open),
                E::Radius,
            ),
            (
                "nowhere",
                Quadric::paraboloid(zero, Vec3::NAN, 1.0, open),
                E::NotFinite,
            ),
            (
                "barrel",
                Quadric::hyperboloid(zero, UP, 1.0, 1.0, open),
                E::Waist,
            ),
            (
                "no gap",
                Quadric::two_sheets(zero, UP, 1.0, 0.0, open),
                E::Gap,
            ),
            (
                "all gap",
                Quadric::two_sheets(zero, UP, 1.0, 2.0, open),
                E::Gap,
            ),
        ];
        for (name, quadric, error) in cases {
            assert_eq!(quadric, Err(error), "{name}");
        }
    }

    #[test]
    fn what_is_not_a_number_is_not_met() {
        let can = cylinder(Ends::Closed);
        let straight = ray([-3.0, 1.0, 0.0], [1.0, 0.0, 0.0]);
        let nowhere = Ray::new(Vec3::NAN, Vec3::X);
        assert_eq!(meets(&can, &nowhere, None), []);
        assert_eq!(meets(&can, &Ray::new(straight.origin, Vec3::NAN), None), []);
        assert_eq!(
            meets(&can, &Ray::new(straight.origin, Vec3::ZERO), None),
            []
        );
        let vectors = [
            Quadric {
                center: Vec3::NAN,
                ..can
            },
            Quadric {
                squares: Vec3::NAN,
                ..can
            },
            Quadric {
                products: Vec3::NAN,
                ..can
            },
            Quadric {
                linear: Vec3::NAN,
                ..can
            },
            Quadric {
                constant: f32::NAN,
                ..can
            },
            Quadric {
                clip: Clip {
                    to: f32::NAN,
                    ..can.clip
                },
                ..can
            },
        ];
        for quadric in vectors {
            assert_eq!(meets(&quadric, &straight, None), [], "{quadric:?}");
        }
    }
}
