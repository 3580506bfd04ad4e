//! A primitive that `core` knows nothing of.

use glam::Vec3;
use whitted::math::Math;
use whitted::{
    Light, Material, Mirror, Object, Objects, Phong, Plane, Ray, Scene, Shape, View, ray::Side,
};

use super::{Visitor, level_view};

/// A flat ring: what lies between two circles around one center.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Annulus {
    /// Of both circles, in world space.
    pub center: Vec3,
    /// Unit length; the outward side.
    pub normal: Vec3,
    /// In world units.
    pub inner_radius: f32,
    /// In world units.
    pub outer_radius: f32,
}

impl Annulus {
    fn plane(&self) -> Plane {
        Plane {
            point: self.center,
            normal: self.normal,
        }
    }
}

impl Shape for Annulus {
    type Setup = ();

    fn setup(_: &Ray) {}

    #[inline]
    fn intersect<P: Math>(&self, ray: &Ray, _: &(), leaving: Option<Side>) -> Option<f32> {
        let t = self.plane().intersect::<P>(ray, &(), leaving)?;
        let distance_squared = (ray.at(t) - self.center).length_squared();
        let inner = self.inner_radius * self.inner_radius;
        let outer = self.outer_radius * self.outer_radius;
        (distance_squared >= inner && distance_squared <= outer).then_some(t)
    }

    #[inline]
    fn normal<P: Math>(&self, _: &Ray, _: f32) -> Vec3 {
        self.normal
    }
}

type M = Material<Phong, Mirror>;

const fn brass(color: Vec3, reflectance: f32) -> M {
    Material {
        color,
        ambient: 0.125,
        diffuse: 0.625,
        highlight: Phong {
            specular: 0.5,
            shininess: 40,
        },
        reflection: Mirror { reflectance },
        transmission: (),
    }
}

static GOLD: M = brass(Vec3::new(0.875, 0.75, 0.25), 0.25);
static SLATE: M = brass(Vec3::new(0.25, 0.375, 0.375), 0.125);
static RINGS: [Object<Annulus, M>; 2] = [
    Object {
        shape: Annulus {
            center: Vec3::new(-0.75, 1.25, -2.0),
            normal: Vec3::Z,
            inner_radius: 0.625,
            outer_radius: 1.0,
        },
        material: &GOLD,
    },
    Object {
        shape: Annulus {
            center: Vec3::new(0.75, 1.0, -2.5),
            normal: Vec3::new(-0.6, 0.0, 0.8),
            inner_radius: 0.25,
            outer_radius: 0.75,
        },
        material: &GOLD,
    },
];
static FLOORS: [Object<Plane, M>; 1] = [Object {
    shape: Plane {
        point: Vec3::ZERO,
        normal: Vec3::Y,
    },
    material: &SLATE,
}];
static LIGHTS: [Light; 1] = [Light {
    position: Vec3::new(2.0, 5.0, 4.0),
    color: Vec3::ONE,
}];
static SCENE: Scene<'static, (Objects<Annulus, M>, Objects<Plane, M>)> = Scene {
    geometry: (&RINGS, &FLOORS),
    lights: &LIGHTS,
    background: Vec3::new(0.5, 0.625, 0.75),
    ambient: Vec3::ONE,
};
const VIEW: View = level_view(Vec3::new(0.0, 1.25, 2.0));

frame!(
    /// Rings above a plane, which mirrors them.
    Rings = &SCENE, VIEW, 3
);

pub(super) fn visit_all(visitor: &mut impl Visitor) {
    visitor.visit::<Rings>("outside");
}
