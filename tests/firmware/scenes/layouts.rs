//! Layouts that others have measured ray tracers with, remade.
//!
//! They have the number and kind of objects, lights and bounces of the scenes that they are named
//! after, at about their places; colors and weights are our own.

use glam::Vec3;
use whitted::{
    Culled, Glass, Light, LightBuffer, Material, Mirror, Object, Phong, Plane, Scene, Sphere, View,
};

use super::checkerboard::Checkerboard;
use super::{Visitor, level_view};

type Buffer = LightBuffer<i8, 512>;

const fn ball<M>(center: Vec3, radius: f32, material: &M) -> Object<'_, Sphere, M> {
    Object {
        shape: Sphere { center, radius },
        material,
    }
}

const fn floor<M>(height: f32, material: &M) -> Object<'_, Plane, M> {
    let point = Vec3::new(0.0, height, 0.0);
    Object {
        shape: Plane {
            point,
            normal: Vec3::Y,
        },
        material,
    }
}

const fn light(position: Vec3, brightness: f32) -> Light {
    Light {
        position,
        color: Vec3::splat(brightness),
    }
}

/// Six spheres over a checkered plane, one light, mirrors and glass: 64×48 pixels, depth 4.
pub mod six_spheres {
    use super::*;

    type M = Material<Phong, Mirror, Glass>;

    const fn material(color: Vec3, diffuse: f32, shininess: u32, mirror: f32, clear: f32) -> M {
        Material {
            color,
            ambient: 0.125,
            diffuse,
            highlight: Phong {
                specular: 0.5,
                shininess,
            },
            reflection: Mirror {
                reflectance: mirror,
            },
            transmission: Glass {
                transmittance: clear,
                ior: 1.5,
            },
        }
    }

    static RED: M = material(Vec3::new(0.75, 0.125, 0.125), 0.75, 20, 0.0, 0.0);
    static GREEN: M = material(Vec3::new(0.25, 0.625, 0.25), 0.75, 50, 0.125, 0.0);
    static BLUE: M = material(Vec3::new(0.25, 0.375, 0.75), 0.75, 50, 0.0, 0.0);
    static SILVER: M = material(Vec3::new(0.875, 0.875, 0.875), 0.125, 200, 0.75, 0.0);
    static CRYSTAL: M = material(Vec3::new(0.875, 0.875, 0.875), 0.0, 200, 0.125, 0.75);
    static WHITE: M = material(Vec3::new(0.75, 0.75, 0.75), 0.75, 10, 0.0, 0.0);
    static BLACK: M = material(Vec3::new(0.125, 0.125, 0.125), 0.75, 10, 0.25, 0.0);

    static BALLS: [Object<Sphere, M>; 6] = [
        ball(Vec3::new(-1.75, 0.75, -3.0), 0.75, &RED),
        ball(Vec3::new(0.0, 1.0, -4.0), 1.0, &SILVER),
        ball(Vec3::new(1.75, 0.75, -3.5), 0.75, &GREEN),
        ball(Vec3::new(0.625, 0.5, -1.75), 0.5, &CRYSTAL),
        ball(Vec3::new(-0.75, 0.375, -1.5), 0.375, &BLUE),
        ball(Vec3::new(1.5, 0.25, -1.25), 0.25, &SILVER),
    ];
    const LAMP: Light = light(Vec3::new(-3.0, 6.0, 2.0), 1.0);
    static LIGHTS: [Buffer; 1] = [Buffer::new(LAMP, &BALLS)];

    type Geometry = (Culled<'static, Sphere, M, 6>, Checkerboard<'static, M>);
    /// Objects and lights.
    pub static SCENE: Scene<'static, Geometry, Buffer> = Scene {
        geometry: (
            Culled(&BALLS),
            Checkerboard {
                tiles: [floor(0.0, &WHITE)],
                others: &BLACK,
            },
        ),
        lights: &LIGHTS,
        background: Vec3::new(0.25, 0.5, 0.75),
        ambient: Vec3::ONE,
    };
    /// Where it is seen from.
    pub const VIEW: View = level_view(Vec3::new(0.0, 1.25, 2.0));
}

/// Four spheres, one of them so large that it is the floor, all mirrors, two lights: after the
/// scene that comes with John Tsiombikas's c-ray. Depth 5.
pub mod c_ray {
    use super::*;

    type M = Material<Phong, Mirror>;

    const fn material(color: Vec3, shininess: u32, reflectance: f32) -> M {
        Material {
            color,
            ambient: 0.0,
            diffuse: 1.0,
            highlight: Phong {
                specular: 1.0,
                shininess,
            },
            reflection: Mirror { reflectance },
            transmission: (),
        }
    }

    static ORANGE: M = material(Vec3::new(0.875, 0.25, 0.0625), 50, 0.25);
    static GREEN: M = material(Vec3::new(0.125, 0.75, 0.25), 60, 0.375);
    static GREY: M = material(Vec3::new(0.5, 0.5, 0.625), 40, 0.75);
    static GROUND: M = material(Vec3::new(0.125, 0.25, 0.5), 80, 0.75);

    static BALLS: [Object<Sphere, M>; 4] = [
        ball(Vec3::new(-1.5, -0.25, -3.5), 0.75, &ORANGE),
        ball(Vec3::new(1.5, -0.375, -4.5), 0.625, &GREEN),
        ball(Vec3::new(0.0, -1000.0, -5.0), 999.0, &GROUND),
        ball(Vec3::new(0.0, 0.0, -6.0), 1.0, &GREY),
    ];
    const LAMPS: [Light; 2] = [
        light(Vec3::new(-50.0, 100.0, 50.0), 1.0),
        light(Vec3::new(40.0, 40.0, 150.0), 0.5),
    ];
    static LIGHTS: [Buffer; 2] = [Buffer::new(LAMPS[0], &BALLS), Buffer::new(LAMPS[1], &BALLS)];
    /// Objects and lights.
    pub static SCENE: Scene<'static, Culled<Sphere, M, 4>, Buffer> = Scene {
        geometry: Culled(&BALLS),
        lights: &LIGHTS,
        background: Vec3::new(0.0, 0.0, 0.0),
        ambient: Vec3::ZERO,
    };
    /// Where it is seen from.
    pub const VIEW: View = level_view(Vec3::new(0.0, 0.5, 1.0));
}

/// Four spheres of ivory, glass, rubber and mirror over a checkered floor, three lights: after
/// Dmitry Sokolov's tinyraytracer, whose floor ends where ours does not. Depth 4.
pub mod tiny {
    use super::*;

    type M = Material<Phong, Mirror, Glass>;

    const fn material(
        color: Vec3,
        [diffuse, specular, mirror, clear]: [f32; 4],
        shininess: u32,
    ) -> M {
        Material {
            color,
            ambient: 0.0,
            diffuse,
            highlight: Phong {
                specular,
                shininess,
            },
            reflection: Mirror {
                reflectance: mirror,
            },
            transmission: Glass {
                transmittance: clear,
                ior: 1.5,
            },
        }
    }

    static IVORY: M = material(Vec3::new(0.375, 0.375, 0.25), [0.625, 0.25, 0.125, 0.0], 50);
    static GLASS: M = material(Vec3::new(0.625, 0.75, 0.75), [0.0, 0.5, 0.125, 0.75], 125);
    static RUBBER: M = material(Vec3::new(0.25, 0.125, 0.125), [0.875, 0.125, 0.0, 0.0], 10);
    static MIRROR: M = material(Vec3::new(1.0, 1.0, 1.0), [0.0, 0.875, 0.75, 0.0], 1000);
    static WHITE: M = material(Vec3::new(0.25, 0.25, 0.25), [1.0, 0.0, 0.0, 0.0], 1);
    static AMBER: M = material(Vec3::new(0.25, 0.1875, 0.0625), [1.0, 0.0, 0.0, 0.0], 1);

    static BALLS: [Object<Sphere, M>; 4] = [
        ball(Vec3::new(-3.0, 0.0, -16.0), 2.0, &IVORY),
        ball(Vec3::new(-1.0, -1.5, -12.0), 2.0, &GLASS),
        ball(Vec3::new(1.5, -0.5, -18.0), 3.0, &RUBBER),
        ball(Vec3::new(7.0, 5.0, -18.0), 4.0, &MIRROR),
    ];
    const LAMPS: [Light; 3] = [
        light(Vec3::new(-20.0, 20.0, 20.0), 1.5),
        light(Vec3::new(30.0, 50.0, -25.0), 1.75),
        light(Vec3::new(30.0, 20.0, 30.0), 1.75),
    ];
    static LIGHTS: [Buffer; 3] = [
        Buffer::new(LAMPS[0], &BALLS),
        Buffer::new(LAMPS[1], &BALLS),
        Buffer::new(LAMPS[2], &BALLS),
    ];

    type Geometry = (Culled<'static, Sphere, M, 4>, Checkerboard<'static, M>);
    /// Objects and lights.
    pub static SCENE: Scene<'static, Geometry, Buffer> = Scene {
        geometry: (
            Culled(&BALLS),
            Checkerboard {
                tiles: [floor(-4.0, &WHITE)],
                others: &AMBER,
            },
        ),
        lights: &LIGHTS,
        background: Vec3::new(0.25, 0.625, 0.75),
        ambient: Vec3::ZERO,
    };
    /// Where it is seen from.
    pub const VIEW: View = level_view(Vec3::ZERO);
}

frame!(
    /// See [`six_spheres`].
    SixSpheres = &six_spheres::SCENE, six_spheres::VIEW, 4
);
frame!(
    /// See [`c_ray`].
    CRay = &c_ray::SCENE, c_ray::VIEW, 5
);
frame!(
    /// See [`tiny`].
    Tiny = &tiny::SCENE, tiny::VIEW, 4
);

pub(super) fn visit_all(visitor: &mut impl Visitor) {
    visitor.visit::<SixSpheres>("six-spheres");
    visitor.visit::<CRay>("c-ray");
    visitor.visit::<Tiny>("tiny");
}
