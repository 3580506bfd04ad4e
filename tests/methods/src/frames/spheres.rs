// spheres.toml as data for firmware, by `whitted bake`.
//
// Bytes of flash where a pointer has 4, code not counted:
//
//   SCENE                  48
//   SPHERES               100
//   PLANES                 28
//   MATERIALS             200
//   LIGHTS                 48
//   together              424
//
// Bytes of stack, at most, beside those of calls and registers:
//
//    4 waiting rays       192
//    0 waiting boxes        0

use whitted::Camera;
use whitted::Glass;
use whitted::Light;
use whitted::Material;
use whitted::Mirror;
use whitted::Object;
use whitted::Objects;
use whitted::Phong;
use whitted::Plane;
use whitted::Scene;
use whitted::Sphere;
use whitted::Vec3;
use whitted::View;

/// The scene.
#[rustfmt::skip]
pub static SCENE: Scene<'static, SceneGeometry, Light> = Scene {
    geometry: (&SPHERES, &PLANES),
    lights: &LIGHTS,
    background: v(0.35, 0.5, 0.8),
    ambient: v(1.0, 1.0, 1.0),
};

/// The camera, and the size of the picture.
#[allow(clippy::approx_constant)]
pub const VIEW: View = View {
    camera: Camera {
        eye: v(0.0, 1.6, 6.0),
        corner: v(-0.5522847, 0.29554233, -1.0412625),
        right: v(1.1045694, -0.0, 0.0),
        down: v(-0.0, -0.82284606, 0.09599871),
    },
    width: 64,
    height: 48,
};

/// Longest chain of rays, the eye ray counted as 1.
pub const DEPTH: usize = 4;

/// Lengths here, times 2 to this power, are those of the scene file.
pub const SCALE_EXPONENT: i32 = 0;

/// What all objects are made of.
pub type SceneMaterial = Material<Phong, Mirror, Glass>;

/// All objects.
pub type SceneGeometry = (Spheres, Planes);

type Spheres = Objects<Sphere, SceneMaterial>;
type Planes = Objects<Plane, SceneMaterial>;

const fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

#[rustfmt::skip]
#[allow(clippy::approx_constant)]
static SPHERES: [Object<'static, Sphere, SceneMaterial>; 5] = [
    Object { shape: Sphere { center: v(0.0, 1.0, -1.0), radius: 1.0 }, material: &MATERIALS[0] },
    Object { shape: Sphere { center: v(-1.9, 0.7, 0.2), radius: 0.7 }, material: &MATERIALS[1] },
    Object { shape: Sphere { center: v(1.8, 0.75, -0.3), radius: 0.75 }, material: &MATERIALS[2] },
    Object { shape: Sphere { center: v(0.75, 0.5, 1.4), radius: 0.5 }, material: &MATERIALS[3] },
    Object { shape: Sphere { center: v(-0.6, 0.3, 1.7), radius: 0.3 }, material: &MATERIALS[1] },
];

#[rustfmt::skip]
#[allow(clippy::approx_constant)]
static PLANES: [Object<'static, Plane, SceneMaterial>; 1] = [
    Object { shape: Plane { point: v(0.0, 0.0, 0.0), normal: v(0.0, 1.0, 0.0) }, material: &MATERIALS[4] },
];

#[rustfmt::skip]
#[allow(clippy::approx_constant)]
static MATERIALS: [SceneMaterial; 5] = [
    Material { color: v(0.9, 0.9, 0.9), ambient: 0.02, diffuse: 0.1, highlight: Phong { specular: 0.8, shininess: 50 }, reflection: Mirror { reflectance: 0.8 }, transmission: Glass { transmittance: 0.0, ior: 1.0 } },
    Material { color: v(0.9, 0.2, 0.15), ambient: 0.1, diffuse: 0.8, highlight: Phong { specular: 0.5, shininess: 50 }, reflection: Mirror { reflectance: 0.0 }, transmission: Glass { transmittance: 0.0, ior: 1.0 } },
    Material { color: v(0.2, 0.3, 0.9), ambient: 0.1, diffuse: 0.7, highlight: Phong { specular: 0.6, shininess: 50 }, reflection: Mirror { reflectance: 0.2 }, transmission: Glass { transmittance: 0.0, ior: 1.0 } },
    Material { color: v(1.0, 1.0, 1.0), ambient: 1.0, diffuse: 0.02, highlight: Phong { specular: 0.7, shininess: 50 }, reflection: Mirror { reflectance: 0.08 }, transmission: Glass { transmittance: 0.88, ior: 1.5 } },
    Material { color: v(0.7, 0.7, 0.6), ambient: 0.15, diffuse: 0.8, highlight: Phong { specular: 0.0, shininess: 1 }, reflection: Mirror { reflectance: 0.15 }, transmission: Glass { transmittance: 0.0, ior: 1.0 } },
];

#[rustfmt::skip]
#[allow(clippy::approx_constant)]
static LIGHTS: [Light; 2] = [
    Light { position: v(-6.0, 8.0, 6.0), color: v(0.7, 0.7, 0.65) },
    Light { position: v(5.0, 4.0, 3.0), color: v(0.3, 0.3, 0.4) },
];
