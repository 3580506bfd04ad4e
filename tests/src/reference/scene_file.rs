//! Scene files as the oracle sees them: their numbers, all digits of them.

use glam::DVec3;
use whitted_cli::scene_file::{self, Lens, SceneFile};

use super::{Camera, Finish, Light, Object, Scene, Shape};

impl Scene {
    /// A scene file, seen by its camera in a picture of this size; nothing if it has no camera.
    pub fn from_file(file: &SceneFile, width: u32, height: u32) -> Option<Self> {
        let aspect = f64::from(width) / f64::from(height);
        let camera = Camera::from_file(file.camera.as_ref()?, aspect);
        let finishes: Vec<_> = file.materials.iter().map(Finish::from).collect();
        let objects = file.objects.iter().map(|object| Object {
            shape: Shape::from(&object.shape),
            finish: finishes[object.material],
        });
        Some(Scene::new(
            camera,
            file.background.into(),
            file.ambient.into(),
            file.lights.iter().map(Light::from).collect(),
            objects.collect(),
        ))
    }
}

impl Camera {
    /// `aspect` is the picture's width over its height.
    fn from_file(camera: &scene_file::Camera, aspect: f64) -> Self {
        let eye = DVec3::from(camera.eye);
        let forward = (DVec3::from(camera.target) - eye).normalize();
        let right = forward.cross(camera.up.into()).normalize();
        let up = right.cross(forward);
        let half = |degrees: f64| (0.5 * degrees.to_radians()).tan();
        // The picture's edges in the plane at distance 1.
        let [left_edge, right_edge, lower_edge, upper_edge] = match camera.lens {
            Lens::Vertical { degrees } => {
                let y = half(degrees);
                [-aspect * y, aspect * y, -y, y]
            }
            Lens::Both { degrees } => {
                let half = half(degrees);
                [-half, half, -half, half]
            }
            Lens::Frustum {
                left,
                right,
                bottom,
                top,
                distance,
            } => [left, right, bottom, top].map(|edge| edge / distance),
        };
        Camera {
            eye,
            corner: forward + left_edge * right + upper_edge * up,
            right: (right_edge - left_edge) * right,
            down: (lower_edge - upper_edge) * up,
        }
    }
}

impl From<&scene_file::Light> for Light {
    fn from(light: &scene_file::Light) -> Self {
        Light {
            position: light.position.into(),
            color: light.color.into(),
            shadows: light.shadows,
        }
    }
}

impl From<&scene_file::Material> for Finish {
    fn from(material: &scene_file::Material) -> Self {
        Finish {
            color: material.color.into(),
            ambient: material.ambient,
            diffuse: material.diffuse,
            specular: material.specular,
            shininess: material.shininess,
            mirror: material.reflectance,
            transmittance: material.transmittance,
            ior: material.ior,
        }
    }
}

impl From<&scene_file::Shape> for Shape {
    fn from(shape: &scene_file::Shape) -> Self {
        use scene_file::Shape as File;
        match *shape {
            File::Sphere { center, radius } => Shape::Sphere {
                center: center.into(),
                radius,
            },
            File::Plane { point, normal } => Shape::Plane {
                point: point.into(),
                normal: normal.into(),
            },
            File::Polygon { ref vertices } => Shape::Polygon {
                vertices: vertices.iter().copied().map(DVec3::from).collect(),
            },
            File::Triangle { vertices } => Shape::Polygon {
                vertices: vertices.map(DVec3::from).into(),
            },
            File::Patch { vertices, normals } => Shape::Patch {
                vertices: vertices.map(DVec3::from),
                normals: normals.map(DVec3::from),
            },
            File::Box { min, max } => Shape::Cuboid {
                min: min.into(),
                max: max.into(),
            },
            File::Frustum {
                base,
                base_radius,
                apex,
                apex_radius,
            } => Shape::Frustum {
                base: base.into(),
                apex: apex.into(),
                base_radius,
                apex_radius,
            },
        }
    }
}
