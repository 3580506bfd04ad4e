//! Scene files as the oracle sees them: their numbers, all digits of them.

use std::sync::Arc;

use glam::{DMat3, DVec3};
use whitted_cli::scene_file::{self, Lens, SceneFile};

use super::solid::{Part, Placed, Solid};
use super::{Area, Camera, Extent, Finish, Light, Object, Pattern, Quadric, Scene, Shape};

impl Scene {
    /// A scene file, seen by its camera in a picture of this size; nothing if it has no camera.
    pub fn from_file(file: &SceneFile, width: u32, height: u32) -> Option<Self> {
        let aspect = f64::from(width) / f64::from(height);
        let camera = Camera::from_file(file.camera.as_ref()?, aspect);
        let finishes: Vec<_> = file.materials.iter().map(Finish::from).collect();
        let all = |objects: &[scene_file::Object], solids: &[scene_file::Solid]| {
            let mut all: Vec<_> = objects
                .iter()
                .map(|object| Object {
                    shape: Shape::from(&object.shape),
                    finish: finishes[object.material].clone(),
                })
                .collect();
            for solid in solids {
                let leaves = solid.leaves.iter().map(|it| Shape::from(&it.shape));
                let whole = Arc::new(Solid::new(leaves.collect(), solid.steps.clone()));
                all.extend(
                    solid
                        .leaves
                        .iter()
                        .enumerate()
                        .map(|(leaf, object)| Object {
                            shape: Shape::Part(Part {
                                solid: whole.clone(),
                                leaf,
                            }),
                            finish: finishes[object.material].clone(),
                        }),
                );
            }
            all
        };
        let mut objects = all(&file.objects, &file.solids);
        for instance in &file.instances {
            let group = &file.groups[instance.group];
            let placed = |Object { shape, finish }| Object {
                shape: Shape::Placed(Placed::new(shape, instance.axes, instance.translation)),
                finish,
            };
            objects.extend(all(&group.objects, &group.solids).into_iter().map(placed));
        }
        Some(Scene::new(
            camera,
            file.background.into(),
            file.ambient.into(),
            file.lights.iter().map(Light::from).collect(),
            objects,
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
            area: light.area.map(|it| Area {
                extent: match it.extent {
                    scene_file::Extent::Rect { edges } => Extent::Rect(edges.map(DVec3::from)),
                    scene_file::Extent::Disk { radius } => Extent::Disk(radius),
                },
                most: 1 << it.samples.most,
                least: 1 << it.samples.least,
            }),
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
            pattern: material.pattern.as_ref().map(Pattern::from),
            filter: material.filter.into(),
            absorption: material.absorption.into(),
        }
    }
}

impl From<&scene_file::Pattern> for Pattern {
    fn from(pattern: &scene_file::Pattern) -> Self {
        match *pattern {
            scene_file::Pattern::Checker { colors, size } => Pattern::Checker {
                colors: colors.map(DVec3::from),
                size,
            },
            scene_file::Pattern::Stripes {
                colors,
                direction,
                size,
            } => Pattern::Stripes {
                colors: colors.map(DVec3::from),
                direction: DVec3::from(direction).normalize(),
                size,
            },
            scene_file::Pattern::Image {
                ref texture,
                repeat,
                blend,
            } => Pattern::Image {
                texture: texture.clone(),
                repeat,
                blend,
            },
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
            File::Torus {
                center,
                axis,
                major,
                minor,
            } => Shape::Torus {
                center: center.into(),
                axis: DVec3::from(axis).normalize(),
                major,
                minor,
            },
            File::Quadric { ref form, closed } => Shape::Quadric(quadric(form, closed)),
        }
    }
}

/// A quadric by its polynomial.
fn quadric(form: &scene_file::Quadric, closed: bool) -> Quadric {
    use scene_file::Quadric as Form;
    // Between two circles, the squared radius in powers of the distance from a point of the axis.
    let between = |ends: [[f64; 3]; 2], radii: [f64; 2], origin: f64, squared: [f64; 3]| {
        let [base, apex] = ends.map(DVec3::from);
        let axis = (apex - base).normalize();
        let length = apex.distance(base);
        let center = base + axis * (origin * length);
        let mut quadric = Quadric::of_revolution(center, axis, squared);
        quadric.planes = vec![(axis, (1.0 - origin) * length), (-axis, origin * length)];
        quadric.closed = closed;
        let radius = radii[0].max(radii[1]);
        quadric.extent = Some((base.min(apex) - radius, base.max(apex) + radius));
        quadric
    };
    let square = |x: f64| x * x;
    let length = |a: [f64; 3], b: [f64; 3]| DVec3::from(a).distance(b.into());
    match *form {
        Form::Ellipsoid { center, radii } => {
            let (center, radii) = (DVec3::from(center), DVec3::from(radii));
            Quadric {
                center,
                matrix: DMat3::from_diagonal((radii * radii).recip()),
                linear: DVec3::ZERO,
                constant: -1.0,
                planes: Vec::new(),
                closed: false,
                extent: Some((center - radii, center + radii)),
            }
        }
        Form::Cylinder { base, apex, radius } => {
            between([base, apex], [radius; 2], 0.5, [radius * radius, 0.0, 0.0])
        }
        Form::Cone {
            base,
            base_radius,
            apex,
            apex_radius,
        } => {
            let slope = (apex_radius - base_radius) / length(base, apex);
            let squared = [square(base_radius), base_radius * slope, square(slope)];
            between([base, apex], [base_radius, apex_radius], 0.0, squared)
        }
        Form::Paraboloid { tip, end, radius } => {
            let growth = square(radius) / length(tip, end);
            between([tip, end], [0.0, radius], 0.0, [0.0, 0.5 * growth, 0.0])
        }
        Form::Hyperboloid {
            base,
            apex,
            radius,
            waist,
        } => {
            let half = 0.5 * length(base, apex);
            let growth = (square(radius) - square(waist)) / square(half);
            between([base, apex], [radius; 2], 0.5, [square(waist), 0.0, growth])
        }
        Form::TwoSheets {
            base,
            apex,
            radius,
            gap,
        } => {
            let (half, tip) = (0.5 * length(base, apex), 0.5 * gap);
            let growth = square(radius) / (square(half) - square(tip));
            between(
                [base, apex],
                [radius; 2],
                0.5,
                [-growth * square(tip), 0.0, growth],
            )
        }
        Form::General(ref it) => {
            let [x, y, z] = it.squares;
            let [yz, zx, xy] = it.products.map(|product| 0.5 * product);
            let center = DVec3::from(it.center);
            let mut planes = Vec::new();
            for (axis, normal) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().enumerate() {
                planes.extend([(normal, it.max[axis]), (-normal, -it.min[axis])]);
            }
            if let Some(axis) = DVec3::from(it.axis).try_normalize() {
                planes.extend([(axis, it.to), (-axis, -it.from)]);
            }
            planes.retain(|plane| plane.1.is_finite());
            let (min, max) = (center + DVec3::from(it.min), center + DVec3::from(it.max));
            Quadric {
                center,
                matrix: DMat3::from_cols_array(&[x, xy, zx, xy, y, yz, zx, yz, z]),
                linear: 0.5 * DVec3::from(it.linear),
                constant: it.constant,
                planes,
                closed,
                extent: (min.is_finite() && max.is_finite()).then_some((min, max)),
            }
        }
    }
}
