//! The power of two by which a scene is shrunk before it is cast.
//!
//! The ray caster works on squares of lengths, which leave `f32` long before lengths do. A scene
//! whose lengths are extreme is therefore multiplied by a power of two when it is loaded, which
//! changes no digit of any number, and what is found in it is multiplied back.

use std::cell::Cell;

use glam::Vec3;

use super::{Area, Camera, Group, Instance, Lens, Light, Object, Pattern, SceneFile, Shape, Solid};

/// Lengths in a file are those that are cast times 2^`exponent`.
///
/// A scene is cast as it stands where its greatest coordinate and its least size lie within 2^±16,
/// for there the ray caster's bits do not depend on the scale. Any other is shrunk or stretched until
/// its greatest coordinate lies between 1 and 2, in the middle of what `f32` can square. Both rules
/// give the same picture to a scene and to the same scene with every length multiplied by 2^k: of
/// those copies either all fail the first rule, and are stretched to the same numbers, or the least
/// size is at least 2^-32 of the greatest coordinate, and all is in the range where bits do not
/// depend on the scale.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Scale {
    /// From -1022 to 127; 0: the scene is cast as it stands.
    pub exponent: i32,
}

/// Lengths from 2^-16 to 2^16 and what arises from them are the same at every scale.
const COMFORT: i32 = 16;

impl Scale {
    /// The scale at which this scene is cast.
    pub fn of(file: &SceneFile) -> Self {
        let greatest = Cell::new(0.0_f64);
        // Replacing lengths by themselves visits them all.
        let note = |length: f64| {
            greatest.set(greatest.get().max(length.abs()));
            length
        };
        let mut least = f64::INFINITY;
        for object in file.all_objects() {
            object.shape.map(&note, &|vector| vector);
            object.shape.sizes(&mut |size| {
                if size.abs() >= f64::MIN_POSITIVE {
                    least = least.min(size.abs());
                }
            });
        }
        for light in &file.lights {
            light.map(&note);
        }
        for length in file.instances.iter().flat_map(|it| it.translation) {
            note(length);
        }
        if let Some(camera) = &file.camera {
            camera.map(&note, &|vector| vector);
            let view = distance(camera.eye, camera.target);
            if view > 0.0 {
                least = least.min(view);
            }
        }
        let Some(exponent) = exponent(greatest.get()) else {
            return Self::default(); // All lengths are 0.
        };
        let comfortable = -COMFORT..=COMFORT;
        if comfortable.contains(&exponent) && least >= power_of_two(-COMFORT) {
            Self::default()
        } else {
            Self { exponent }
        }
    }

    /// A length of the file as it is cast.
    pub fn length(self, length: f64) -> f32 {
        (length * power_of_two(-self.exponent)) as f32
    }

    /// A point of the file as it is cast.
    pub fn point(self, point: [f64; 3]) -> Vec3 {
        Vec3::from_array(point.map(|it| self.length(it)))
    }

    /// What is counted over a length of the file, over one that is cast.
    pub fn per_length(self, number: f64) -> f32 {
        (number * power_of_two(self.exponent)) as f32
    }

    /// A length as it is cast, in the file's unit.
    pub fn unscaled(self, length: f32) -> f64 {
        f64::from(length) * power_of_two(self.exponent)
    }
}

/// A vector whose length does not matter, as it is cast: of ordinary length, so that its square is an
/// ordinary number.
pub fn direction(vector: [f64; 3]) -> Vec3 {
    Vec3::from_array(proportions(vector))
}

/// Numbers of which only the proportions matter, as they are cast: the greatest between 1 and 2.
pub fn proportions<const N: usize>(numbers: [f64; N]) -> [f32; N] {
    let factor = common_factor(numbers);
    numbers.map(|it| (it * factor) as f32)
}

/// The power of two that takes the greatest of some numbers to between 1 and 2.
fn common_factor<const N: usize>(numbers: [f64; N]) -> f64 {
    let greatest = numbers.iter().fold(0.0_f64, |most, it| most.max(it.abs()));
    exponent(greatest).map_or(1.0, |it| power_of_two(-it))
}

/// Numbers rounded as [`proportions`] rounds them, at their own size.
fn rounded_proportions<const N: usize>(numbers: [f64; N]) -> [f64; N] {
    let factor = common_factor(numbers);
    numbers.map(|it| f64::from((it * factor) as f32) / factor)
}

/// The exponent of a number's leading bit; `None` for 0, and for what is too small to matter.
fn exponent(number: f64) -> Option<i32> {
    (number >= f64::MIN_POSITIVE).then(|| (number.to_bits() >> 52) as i32 - 1023)
}

/// 2^`exponent`, for exponents from -1022 to 1023.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

pub(super) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let d = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt()
}

impl SceneFile {
    /// The scale at which this scene is cast.
    pub fn scale(&self) -> Scale {
        Scale::of(self)
    }

    /// The same scene with every number as the ray caster sees it: rounded to `f32`, lengths at the
    /// [scale](Self::scale) at which they are cast, and widened again. For judging its results by
    /// the very scene that it was given.
    pub fn rounded(&self) -> Self {
        let scale = self.scale();
        let length = |it| scale.unscaled(scale.length(it));
        let number = |it| f64::from(it as f32);
        let objects = |all: &[Object]| -> Vec<_> {
            all.iter()
                .map(|it| Object {
                    shape: it.shape.map(&length, &rounded_proportions),
                    ..*it
                })
                .collect()
        };
        let solids = |all: &[Solid]| -> Vec<_> {
            all.iter()
                .map(|it| Solid {
                    leaves: objects(&it.leaves),
                    ..it.clone()
                })
                .collect()
        };
        Self {
            camera: self.camera.map(|it| Camera {
                lens: it.lens.rounded(),
                ..it.map(&length, &rounded_proportions)
            }),
            background: self.background.map(number),
            ambient: self.ambient.map(number),
            materials: self
                .materials
                .iter()
                .map(|it| super::Material {
                    color: it.color.map(number),
                    ambient: number(it.ambient),
                    diffuse: number(it.diffuse),
                    specular: number(it.specular),
                    shininess: number(it.shininess),
                    reflectance: number(it.reflectance),
                    transmittance: number(it.transmittance),
                    ior: number(it.ior),
                    filter: it.filter.map(number),
                    absorption: it
                        .absorption
                        .map(|it| f64::from(scale.per_length(it)) * power_of_two(-scale.exponent)),
                    pattern: it.pattern.as_ref().map(|it| it.rounded(&number, &length)),
                    ..it.clone()
                })
                .collect(),
            lights: self
                .lights
                .iter()
                .map(|it| Light {
                    color: it.color.map(number),
                    ..it.map(&length)
                })
                .collect(),
            objects: objects(&self.objects),
            solids: solids(&self.solids),
            groups: self
                .groups
                .iter()
                .map(|it| Group {
                    objects: objects(&it.objects),
                    solids: solids(&it.solids),
                    ..it.clone()
                })
                .collect(),
            instances: self
                .instances
                .iter()
                .map(|it| Instance {
                    axes: it.axes.map(|it| it.map(number)),
                    translation: it.translation.map(length),
                    ..*it
                })
                .collect(),
            path: self.path.clone(),
            ..*self
        }
    }
}

impl Light {
    /// With every length replaced.
    fn map(&self, length: &impl Fn(f64) -> f64) -> Self {
        Self {
            position: self.position.map(length),
            area: self.area.map(|it| Area {
                extent: it.extent.map(length),
                ..it
            }),
            ..*self
        }
    }
}

impl Pattern {
    fn rounded(&self, number: &impl Fn(f64) -> f64, length: &impl Fn(f64) -> f64) -> Self {
        match *self {
            Self::Checker { colors, size } => Self::Checker {
                colors: colors.map(|it| it.map(number)),
                size: length(size),
            },
            Self::Stripes {
                colors,
                direction,
                size,
            } => Self::Stripes {
                colors: colors.map(|it| it.map(number)),
                direction,
                size: length(size),
            },
            Self::Image {
                ref texture,
                repeat,
                blend,
            } => Self::Image {
                texture: texture.clone(),
                repeat: repeat.map(number),
                blend,
            },
        }
    }
}

impl Camera {
    /// With every length and every direction replaced, but not the lens.
    fn map(&self, length: &impl Fn(f64) -> f64, vector: &impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        Self {
            eye: self.eye.map(length),
            target: self.target.map(length),
            up: vector(self.up),
            ..*self
        }
    }
}

impl Lens {
    /// An angle stays: its tangent is taken before anything is rounded.
    fn rounded(self) -> Self {
        let Self::Frustum {
            left,
            right,
            bottom,
            top,
            distance,
        } = self
        else {
            return self;
        };
        let [left, right, bottom, top, distance] =
            rounded_proportions([left, right, bottom, top, distance]);
        Self::Frustum {
            left,
            right,
            bottom,
            top,
            distance,
        }
    }
}

impl Shape {
    /// With every length and every direction replaced.
    fn map(&self, length: &impl Fn(f64) -> f64, vector: &impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        let point = |it: [f64; 3]| it.map(length);
        match *self {
            Self::Sphere { center, radius } => Self::Sphere {
                center: point(center),
                radius: length(radius),
            },
            Self::Plane {
                point: anchor,
                normal,
            } => Self::Plane {
                point: point(anchor),
                normal: vector(normal),
            },
            Self::Polygon { ref vertices } => Self::Polygon {
                vertices: vertices.iter().map(|&it| point(it)).collect(),
            },
            Self::Triangle { vertices } => Self::Triangle {
                vertices: vertices.map(point),
            },
            Self::Patch { vertices, normals } => Self::Patch {
                vertices: vertices.map(point),
                normals: normals.map(vector),
            },
            Self::Box { min, max } => Self::Box {
                min: point(min),
                max: point(max),
            },
            Self::Frustum {
                base,
                base_radius,
                apex,
                apex_radius,
            } => Self::Frustum {
                base: point(base),
                base_radius: length(base_radius),
                apex: point(apex),
                apex_radius: length(apex_radius),
            },
            Self::Quadric { ref form, closed } => Self::Quadric {
                form: form.map(length, vector),
                closed,
            },
            Self::Torus {
                center,
                axis,
                major,
                minor,
            } => Self::Torus {
                center: point(center),
                axis: vector(axis),
                major: length(major),
                minor: length(minor),
            },
        }
    }

    /// Visits the lengths that make this shape as large as it is: what is squared in casting it.
    fn sizes(&self, visit: &mut impl FnMut(f64)) {
        match *self {
            Self::Sphere { radius, .. } => visit(radius),
            Self::Plane { .. } => {}
            Self::Polygon { ref vertices } => visit(extent(vertices)),
            Self::Triangle { vertices } | Self::Patch { vertices, .. } => visit(extent(&vertices)),
            Self::Box { min, max } => (0..3).for_each(|axis| visit(max[axis] - min[axis])),
            Self::Frustum {
                base,
                base_radius,
                apex,
                apex_radius,
            } => [distance(base, apex), base_radius, apex_radius]
                .into_iter()
                .for_each(visit),
            Self::Quadric { ref form, .. } => form.sizes(visit),
            Self::Torus { major, minor, .. } => [major, minor].into_iter().for_each(visit),
        }
    }
}

/// The longest side of the box round some points.
fn extent(points: &[[f64; 3]]) -> f64 {
    (0..3)
        .map(|axis| {
            let along = || points.iter().map(|it| it[axis]);
            along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
        })
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::nff;
    use super::*;

    /// A small scene with every length, and no other number, times 2^`k`.
    fn scaled(k: i32) -> SceneFile {
        let text = "v from 3 1 2 at 0 0 0 up 0 0 1 angle 45 hither 1 resolution 8 8\n\
                    l 5 5 5\nf .9 .5 .1 .7 .3 5 0 1\ns 0.1 0.2 -0.3 .7\n\
                    p 3 -2 -2 -1 2 -2 -1 0 2 -1\nc 0 0 0 .1 0 0 1.3 .05\n\
                    pp 3 1 0 0 0 0 1 0 1 0 0 0 1 1 1 0 0 0 1\n";
        let file = nff::parse(Path::new("t.nff"), text.as_bytes()).unwrap();
        let factor = power_of_two(k);
        SceneFile {
            camera: file.camera.map(|it| it.map(&|x| x * factor, &|it| it)),
            lights: file
                .lights
                .iter()
                .map(|it| it.map(&|x| x * factor))
                .collect(),
            objects: file
                .objects
                .iter()
                .map(|it| Object {
                    shape: it.shape.map(&|x| x * factor, &|it| it),
                    ..*it
                })
                .collect(),
            ..file
        }
    }

    #[test]
    fn ordinary_scenes_are_cast_as_they_stand() {
        for k in [-11, -3, 0, 1, 14] {
            assert_eq!(scaled(k).scale().exponent, 0, "2^{k}");
        }
    }

    #[test]
    fn extreme_scenes_are_cast_with_coordinates_of_about_one() {
        for k in [-200, -60, -40, -20, 15, 40, 60, 120] {
            let scale = scaled(k).scale();
            assert_eq!(scale.exponent, k + 2, "2^{k}"); // The light is at 5.
            assert_eq!(scale.length(5.0 * power_of_two(k)), 1.25);
            assert_eq!(scale.unscaled(1.25), 5.0 * power_of_two(k));
        }
    }

    #[test]
    fn a_speck_in_an_ordinary_scene_makes_it_extreme_at_every_scale() {
        for k in -60..=60 {
            let mut file = scaled(k);
            file.objects[0].shape = Shape::Sphere {
                center: [0.0; 3],
                radius: power_of_two(k - 35),
            };
            assert_eq!(file.scale().exponent, k + 2, "2^{k}");
        }
    }

    #[test]
    fn the_numbers_that_are_cast_do_not_depend_on_the_scale() {
        let ordinary = scaled(0).rounded();
        for k in -60..=60 {
            let back = |it: f64| it * power_of_two(-k);
            let rounded = scaled(k).rounded();
            for (a, b) in ordinary.objects.iter().zip(&rounded.objects) {
                assert_eq!(a.shape, b.shape.map(&back, &|it| it), "2^{k}");
            }
            assert_eq!(
                ordinary.lights[0].position,
                rounded.lights[0].position.map(back)
            );
            assert_eq!(
                ordinary.camera,
                rounded.camera.map(|it| it.map(&back, &|it| it))
            );
        }
    }

    #[test]
    fn rounding_gives_what_f32_holds() {
        let rounded = scaled(0).rounded();
        let Shape::Sphere { center, radius } = rounded.objects[0].shape else {
            panic!("the first object is the sphere");
        };
        assert_eq!(center, [0.1_f32, 0.2, -0.3].map(f64::from));
        assert_eq!(radius, f64::from(0.7_f32));
        assert_eq!(rounded.materials[0].diffuse, f64::from(0.7_f32));
    }

    #[test]
    fn directions_of_any_length_are_cast_at_an_ordinary_one() {
        for factor in [1e-300, 1e-30, 1.0, 1e30] {
            let cast = direction([0.0, -3.0 * factor, 4.0 * factor]);
            assert!(
                cast.length() > 0.5 && cast.length() < 4.0,
                "{factor}: {cast}"
            );
        }
        assert_eq!(direction([0.0; 3]), Vec3::ZERO);
    }
}
