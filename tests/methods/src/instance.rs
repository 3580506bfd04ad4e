//! Ray and sphere that is placed by an affine map.
//!
//! The methods differ in where they meet: the ray goes to the sphere's space, or the sphere comes to the
//! world, as an ellipsoid.

use glam::Vec3;
use whitted::{
    Candidates, Clip, Ends, Exact, Geometry, Instance, Math, Object, Placement, Quadric, Ray,
    Shape, Side, Sphere,
};

use crate::{Method, sphere};

/// A sphere that is placed, and all that the methods ask for beforehand.
#[derive(Clone, Copy, Debug)]
pub struct Placed {
    /// To what the axes become.
    pub axes: [Vec3; 3],
    /// The sphere where it is not placed yet.
    pub object: [Object<'static, Sphere, ()>; 1],
    /// The same, for rays whose direction is of any length.
    pub any: [Object<'static, AnyLength, ()>; 1],
    /// Where it is put.
    pub placement: Placement,
    /// Where the world's origin is in the sphere's space.
    pub world: Vec3,
    /// The surface in the world.
    pub quadric: Quadric,
    /// The rows of the inverse, hardly rounded.
    pub inverse: [[f64; 3]; 3],
}

impl Placed {
    /// `None` where that cannot be.
    pub fn new(axes: [Vec3; 3], translation: Vec3, sphere: Sphere) -> Option<Self> {
        let placement = Placement::new(axes, translation).ok()?;
        let [a, b, c] = axes.map(wide);
        let rows = [cross(b, c), cross(c, a), cross(a, b)];
        let determinant = sphere::dot(a, rows[0]);
        let inverse = rows.map(|row| row.map(|it| it / determinant));
        let place = wide(translation);
        let world = inverse.map(|row| -sphere::dot(row, place) as f32);
        // |M (x - c)|² = r², from the center in the world.
        let middle = wide(sphere.center);
        let center = [0, 1, 2].map(|i| {
            let turned = a[i] * middle[0] + b[i] * middle[1] + c[i] * middle[2];
            (place[i] + turned) as f32
        });
        let product =
            |i: usize, j: usize| -> f64 { inverse.iter().map(|row| row[i] * row[j]).sum() };
        let squares = [0, 1, 2].map(|i| product(i, i) as f32);
        let products = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| 2.0 * product(i, j) as f32);
        let constant = -sphere.radius * sphere.radius;
        let quadric = Quadric::new(
            center.into(),
            squares.into(),
            products.into(),
            Vec3::ZERO,
            constant,
            Clip::NONE,
            Ends::Open,
        );
        Some(Self {
            axes,
            object: [Object {
                shape: sphere,
                material: &(),
            }],
            any: [Object {
                shape: AnyLength(sphere),
                material: &(),
            }],
            placement,
            world: world.into(),
            quadric: quadric.ok()?,
            inverse,
        })
    }
}

/// A sphere by a kernel for directions of any length.
#[derive(Clone, Copy, Debug)]
pub struct AnyLength(pub Sphere);

impl Shape for AnyLength {
    type Setup = ();

    fn setup(_: &Ray) {}

    #[inline(always)]
    fn intersect<P: Math>(&self, ray: &Ray, _: &(), leaving: Option<Side>) -> Option<f32> {
        match leaving {
            Some(Side::Inside) => {
                let to_center = self.0.center - ray.origin;
                let (d, chord) = (ray.direction, 2.0 * to_center.dot(ray.direction));
                ray.admitted(chord / d.dot(d))
            }
            Some(Side::Outside) => None,
            None => sphere::by_any_length(ray, &self.0),
        }
    }

    fn normal<P: Math>(&self, ray: &Ray, t: f32) -> Vec3 {
        (ray.at(t) - self.0.center) / self.0.radius
    }
}

/// As in an instance, where there may be more than one.
#[inline(always)]
fn met(geometry: &(impl Geometry + ?Sized), mut ray: Ray) -> Option<f32> {
    geometry.nearest::<Exact>(&mut ray, 0, Candidates::ALL)?;
    Some(ray.t_max)
}

fn wide(v: Vec3) -> [f64; 3] {
    v.to_array().map(f64::from)
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Distance to the nearest point of the placed sphere that the ray admits.
pub type InstanceMethod = Method<fn(&Ray, &Placed) -> Option<f32>>;

/// All methods.
pub const METHODS: &[InstanceMethod] = &[
    Method::new("core", core),
    Method::new("direction as it is", as_it_is),
    Method::new("4 x 4 matrix", matrix),
    Method::new("quadric in the world", in_world),
    Method::new("f64", double),
];

/// The way of `whitted`: to the object's space, at unit length, and the distance back.
#[inline(never)]
pub fn core(ray: &Ray, placed: &Placed) -> Option<f32> {
    let instance = Instance {
        geometry: placed.object.as_slice(),
        placement: placed.placement,
    };
    met(&instance, *ray)
}

/// A direction of the world in the sphere's space.
#[inline(always)]
fn turned(placed: &Placed, v: Vec3) -> Vec3 {
    let [x, y, z] = placed.placement.inverse;
    Vec3::new(x.dot(v), y.dot(v), z.dot(v))
}

/// The direction is not made unit length there, so that distances are the world's: every kernel has to
/// take directions of any length.
#[inline(never)]
pub fn as_it_is(ray: &Ray, placed: &Placed) -> Option<f32> {
    let local = Ray {
        origin: turned(placed, ray.origin - placed.placement.translation),
        direction: turned(placed, ray.direction),
        ..*ray
    };
    met(placed.any.as_slice(), local)
}

/// The origin by a matrix that moves, too, as the direction by the same without.
#[inline(always)]
fn by_matrix(ray: &Ray, placed: &Placed) -> Ray {
    Ray {
        origin: turned(placed, ray.origin) + placed.world,
        direction: turned(placed, ray.direction),
        ..*ray
    }
}

/// As text books have it.
#[inline(never)]
pub fn matrix(ray: &Ray, placed: &Placed) -> Option<f32> {
    met(placed.any.as_slice(), by_matrix(ray, placed))
}

/// No ray is moved: what is placed is another shape, for each instance once.
#[inline(never)]
pub fn in_world(ray: &Ray, placed: &Placed) -> Option<f32> {
    let quadric = &placed.quadric;
    quadric.intersect::<Exact>(ray, &Quadric::setup(ray), None)
}

/// In `f64`, from the ray's origin.
#[inline(never)]
pub fn double(ray: &Ray, placed: &Placed) -> Option<f32> {
    let dot = sphere::dot;
    let turned = |v: [f64; 3]| placed.inverse.map(|row| dot(row, v));
    let Sphere { center, radius } = placed.object[0].shape;
    let origin = turned(sphere::difference(ray.origin, placed.placement.translation));
    let (d, center) = (turned(wide(ray.direction)), wide(center));
    let f = [0, 1, 2].map(|i| center[i] - origin[i]);
    let (a, b) = (dot(d, d), dot(f, d));
    let miss = [0, 1, 2].map(|i| f[i] - d[i] * (b / a));
    let square = f64::from(radius) * f64::from(radius) - dot(miss, miss);
    if !(square >= 0.0) {
        return None;
    }
    let root = libm::sqrt(square / a);
    crate::nearest(ray, (b / a - root) as f32, (b / a + root) as f32)
}
