//! The picture oracle: a plain, recursive Whitted tracer in `f64`.
//!
//! It is written to be read beside the formula, not to be fast, and shares no code with the
//! renderer that it judges: other intersection methods, another arithmetic, recursion instead of a
//! stack, a tree instead of slices.
//!
//! T. Whitted, "An Improved Illumination Model for Shaded Display", CACM 23(6), 1980.

mod area;
mod hierarchy;
mod pattern;
mod quadric;
mod scene_file;
mod shape;
mod solid;
mod torus;

use glam::DVec3;
use rayon::prelude::*;

pub use area::{Area, Extent};
use hierarchy::Hierarchy;
pub use pattern::Pattern;
pub use quadric::Quadric;
pub use shape::Shape;
pub(crate) use torus::roots as torus_roots;

/// What to trace: objects under lights, before a background.
#[derive(Clone, Debug)]
pub struct Scene {
    camera: Camera,
    background: DVec3,
    ambient: DVec3,
    lights: Vec<Light>,
    objects: Vec<Object>,
    hierarchy: Hierarchy,
}

/// The image plane as it lies in the world, seen from the eye.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// Where all primary rays start.
    pub eye: DVec3,
    /// From the eye to the upper left corner of the picture.
    pub corner: DVec3,
    /// Along the upper edge of the picture, all of it.
    pub right: DVec3,
    /// Along the left edge of the picture, all of it.
    pub down: DVec3,
}

/// What shines, without falloff.
#[derive(Clone, Copy, Debug)]
pub struct Light {
    /// In world space; the middle, where it is no point.
    pub position: DVec3,
    /// Linear RGB intensity.
    pub color: DVec3,
    /// Whether surfaces in between matter.
    pub shadows: bool,
    /// What it is, unless a point.
    pub area: Option<Area>,
}

/// A shape and how its surface answers light.
#[derive(Clone, Debug)]
pub struct Object {
    /// Where the surface is.
    pub shape: Shape,
    /// What it looks like.
    pub finish: Finish,
}

/// The coefficients of Whitted's formula for one surface.
#[derive(Clone, Debug)]
pub struct Finish {
    /// Linear RGB.
    pub color: DVec3,
    /// What takes its place.
    pub pattern: Option<Pattern>,
    /// Share of the ambient light that is given back.
    pub ambient: f64,
    /// Lambert's coefficient.
    pub diffuse: f64,
    /// Phong's coefficient.
    pub specular: f64,
    /// Phong's exponent.
    pub shininess: f64,
    /// Weight of the mirrored ray.
    pub mirror: f64,
    /// Weight of the refracted ray, and of light that passes on its way to another surface.
    pub transmittance: f64,
    /// Refractive index of the inside; 1 outside.
    pub ior: f64,
    /// What colors light that passes the surface.
    pub filter: DVec3,
    /// How fast light weakens inside: `e^(-absorption·distance)` is left.
    pub absorption: DVec3,
}

/// What the tracer is asked to do.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Longest path, counting the primary ray as 1. What lies deeper is black.
    pub depth: u32,
    /// Weight of the ray inside glass after total internal reflection.
    pub total_reflection: TotalReflection,
    /// 0, or how far to move each hit point off its surface, towards where the ray came from, as a
    /// share of the size of its coordinates: what rounding does to it, exaggerated or not.
    pub lift: f64,
}

/// Who gets the light that glass would transmit, but cannot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TotalReflection {
    /// The mirrored ray, besides what it has: weight Kr + T. No energy is made or lost.
    KeepsEnergy,
    /// The mirrored ray, with weight 1 whatever the finish says: POV-Ray's rule.
    IsPerfect,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            depth: 5,
            total_reflection: TotalReflection::KeepsEnergy,
            lift: 0.0,
        }
    }
}

/// A ray and the object whose surface it leaves; that one of its roots is not met again.
#[derive(Clone, Copy)]
struct Ray {
    origin: DVec3,
    /// Unit length.
    direction: DVec3,
    leaves: Option<usize>,
    /// How what it goes through absorbs, as far as the surface that it leaves tells.
    absorption: DVec3,
}

impl Camera {
    /// The unit direction through the centre of a pixel, counted from the upper left.
    pub fn center(&self, x: u32, y: u32, width: u32, height: u32) -> DVec3 {
        let across = (f64::from(x) + 0.5) / f64::from(width);
        let along = (f64::from(y) + 0.5) / f64::from(height);
        (self.corner + across * self.right + along * self.down).normalize()
    }
}

impl Scene {
    /// Sorts the objects for tracing; their order decides which of two coincident surfaces is seen.
    pub fn new(
        camera: Camera,
        background: DVec3,
        ambient: DVec3,
        lights: Vec<Light>,
        objects: Vec<Object>,
    ) -> Self {
        let hierarchy = Hierarchy::new(&objects);
        Scene {
            camera,
            background,
            ambient,
            lights,
            objects,
            hierarchy,
        }
    }

    /// Where the picture is taken from.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Linear RGB of every pixel centre, row by row from the top.
    pub fn render(&self, width: u32, height: u32, options: Options) -> Vec<DVec3> {
        (0..height)
            .into_par_iter()
            .flat_map_iter(|y| (0..width).map(move |x| (x, y)))
            .map(|(x, y)| self.seen(self.camera.center(x, y, width, height), options))
            .collect()
    }

    /// Linear RGB that the eye sees in a direction of unit length.
    pub fn seen(&self, direction: DVec3, options: Options) -> DVec3 {
        let ray = Ray {
            origin: self.camera.eye,
            direction,
            leaves: None,
            absorption: DVec3::ZERO,
        };
        self.radiance(ray, 1, options)
    }

    /// Light that comes back along `ray`, which is the `depth`-th of its path.
    fn radiance(&self, ray: Ray, depth: u32, options: Options) -> DVec3 {
        if depth > options.depth {
            return DVec3::ZERO;
        }
        let Some((index, t)) = self.nearest(ray) else {
            return left(ray.absorption, f64::INFINITY) * self.background;
        };
        let Object { shape, finish } = &self.objects[index];
        let point = ray.origin + t * ray.direction;
        let outward = shape.normal(ray.origin, ray.direction, t);
        let front = ray.direction.dot(outward) < 0.0;
        let normal = if front { outward } else { -outward };
        let point = point + options.lift * point.abs().max_element() * normal;
        let child = |direction: DVec3| Ray {
            origin: point,
            direction,
            leaves: Some(index),
            absorption: if direction.dot(outward) < 0.0 {
                finish.absorption
            } else {
                DVec3::ZERO
            },
        };
        let medium = if ray.absorption == DVec3::ZERO && !front {
            finish.absorption
        } else {
            ray.absorption
        };
        let plain = match &finish.pattern {
            Some(pattern) => pattern.color(shape, point, outward),
            None => finish.color,
        };

        let mut color = plain * finish.ambient * self.ambient;
        for light in &self.lights {
            color += self.reflected_light(light, child(ray.direction), normal, plain, finish);
        }

        let mut mirror = DVec3::splat(finish.mirror);
        let tint = finish.transmittance * finish.filter;
        if finish.transmittance > 0.0 {
            let eta = if front { 1.0 / finish.ior } else { finish.ior };
            match refract(ray.direction, normal, eta) {
                Some(direction) => {
                    let transmitted = self.radiance(child(direction), depth + 1, options);
                    color += tint * transmitted;
                }
                None => {
                    mirror = match options.total_reflection {
                        TotalReflection::KeepsEnergy => mirror + tint,
                        TotalReflection::IsPerfect => DVec3::ONE,
                    }
                }
            }
        }
        if mirror.max_element() > 0.0 {
            let direction = reflect(ray.direction, normal);
            color += mirror * self.radiance(child(direction), depth + 1, options);
        }
        left(medium, t) * color
    }

    /// What a surface sends back of one light, diffuse and as a highlight. `ray` starts at the
    /// surface and goes on where the viewer looked.
    fn reflected_light(
        &self,
        light: &Light,
        ray: Ray,
        normal: DVec3,
        color: DVec3,
        finish: &Finish,
    ) -> DVec3 {
        let distance = ray.origin.distance(light.position);
        let to_light = (light.position - ray.origin) / distance;
        let cosine = normal.dot(to_light);
        // Light at the surface itself has no direction: its cosine is NaN, and it adds nothing.
        if cosine.is_nan() || cosine <= 0.0 {
            return DVec3::ZERO;
        }
        let shadow = Ray {
            direction: to_light,
            ..ray
        };
        let passed = match (light.shadows, &light.area) {
            (true, None) => self.transmittance(shadow, distance),
            (true, Some(area)) => self.seen_share(light.position, area, shadow, normal),
            (false, _) => DVec3::ONE,
        };
        let highlight = reflect(ray.direction, normal)
            .dot(to_light)
            .max(0.0)
            .powf(finish.shininess);
        let diffuse = color * finish.diffuse * cosine;
        passed * light.color * (diffuse + finish.specular * highlight)
    }

    /// The object met first and where; of two at the same place, the first in order.
    fn nearest(&self, ray: Ray) -> Option<(usize, f64)> {
        let mut best = (usize::MAX, f64::INFINITY);
        self.hierarchy
            .visit(ray.origin, ray.direction, &mut |index| {
                for t in self.crossings(index, ray).filter(|&t| t > 0.0) {
                    if t < best.1 || (t == best.1 && index < best.0) {
                        best = (index, t);
                    }
                }
                best.1
            });
        (best.1 < f64::INFINITY).then_some(best)
    }

    /// Share of light that passes every surface within `distance`: T for each that it crosses; and what
    /// is not absorbed in between.
    fn transmittance(&self, ray: Ray, distance: f64) -> DVec3 {
        let mut passed = DVec3::ONE;
        self.hierarchy
            .visit(ray.origin, ray.direction, &mut |index| {
                let between = |t: &f64| 0.0 < *t && *t < distance;
                let finish = &self.objects[index].finish;
                for _ in self.crossings(index, ray).filter(between) {
                    passed *= finish.transmittance * finish.filter;
                }
                if finish.absorption != DVec3::ZERO {
                    passed *= left(finish.absorption, self.inside(index, ray, distance));
                }
                if passed == DVec3::ZERO { 0.0 } else { distance }
            });
        passed
    }

    /// How much of the way to `distance` lies in a solid: what comes before each point where the ray
    /// leaves it, back to where it enters.
    fn inside(&self, index: usize, ray: Ray, distance: f64) -> f64 {
        let shape = &self.objects[index].shape;
        if !shape.is_solid() {
            return 0.0;
        }
        let mut ahead: Vec<_> = self.crossings(index, ray).filter(|&t| t > 0.0).collect();
        ahead.sort_by(f64::total_cmp);
        let leaves = |t| {
            shape
                .normal(ray.origin, ray.direction, t)
                .dot(ray.direction)
                > 0.0
        };
        let mut sum = 0.0;
        let mut entry = 0.0_f64;
        let mut is_inside = match ahead.first() {
            Some(&first) => leaves(first),
            None => shape.is_beyond(ray.origin, ray.direction, ray.leaves == Some(index)),
        };
        for t in ahead.into_iter().chain([f64::INFINITY]) {
            if is_inside {
                sum += t.min(distance) - entry.min(distance);
            }
            (entry, is_inside) = (t, !is_inside);
        }
        sum
    }

    fn crossings(&self, index: usize, ray: Ray) -> impl Iterator<Item = f64> {
        let leaving = ray.leaves == Some(index);
        self.objects[index]
            .shape
            .crossings(ray.origin, ray.direction, leaving)
    }
}

/// What is left of light after a distance, by Beer's law.
fn left(absorption: DVec3, distance: f64) -> DVec3 {
    // Nothing is absorbed over an infinite distance either where nothing absorbs.
    let channel = |rate: f64| {
        if rate > 0.0 {
            (-rate * distance).exp()
        } else {
            1.0
        }
    };
    DVec3::from_array(absorption.to_array().map(channel))
}

/// The direction after a mirror; all unit length.
fn reflect(direction: DVec3, normal: DVec3) -> DVec3 {
    direction - 2.0 * direction.dot(normal) * normal
}

/// Snell's law: the direction beyond a surface, `eta` being the refractive index on this side over
/// that on the other; nothing where all light is reflected. `normal` is turned to the ray.
fn refract(direction: DVec3, normal: DVec3, eta: f64) -> Option<DVec3> {
    let cosine = -direction.dot(normal);
    let cosine_squared = 1.0 - eta * eta * (1.0 - cosine * cosine);
    (cosine_squared >= 0.0)
        .then(|| (eta * direction + (eta * cosine - cosine_squared.sqrt()) * normal).normalize())
}

/// 8-bit steps of linear RGB: clamped and rounded to the nearest.
pub fn quantize(color: DVec3) -> [u8; 3] {
    (color.clamp(DVec3::ZERO, DVec3::ONE) * 255.0)
        .round()
        .to_array()
        .map(|channel| channel as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CLEAR: Finish = Finish {
        color: DVec3::ONE,
        ambient: 0.0,
        diffuse: 0.0,
        specular: 0.0,
        shininess: 1.0,
        mirror: 0.0,
        transmittance: 0.5,
        ior: 1.5,
        pattern: None,
        filter: DVec3::ONE,
        absorption: DVec3::ZERO,
    };
    const CHALK: Finish = Finish {
        diffuse: 1.0,
        transmittance: 0.0,
        ..CLEAR
    };

    fn ball(x: f64, y: f64, z: f64, finish: Finish) -> Object {
        Object {
            shape: Shape::Sphere {
                center: DVec3::new(x, y, z),
                radius: 1.0,
            },
            finish,
        }
    }

    fn wall(y: f64, finish: Finish) -> Object {
        Object {
            shape: Shape::Plane {
                point: DVec3::Y * y,
                normal: DVec3::Y,
            },
            finish,
        }
    }

    fn scene(objects: Vec<Object>, lights: &[DVec3]) -> Scene {
        let camera = Camera {
            eye: DVec3::ZERO,
            corner: DVec3::new(-1.0, 1.0, -1.0),
            right: DVec3::X * 2.0,
            down: DVec3::NEG_Y * 2.0,
        };
        let light = |&position| Light {
            position,
            color: DVec3::ONE,
            shadows: true,
            area: None,
        };
        let lights = lights.iter().map(light).collect();
        Scene::new(
            camera,
            DVec3::new(0.25, 0.5, 1.0),
            DVec3::ONE,
            lights,
            objects,
        )
    }

    fn radiance(scene: &Scene, origin: DVec3, direction: DVec3, options: Options) -> f64 {
        scene
            .radiance(
                Ray {
                    origin,
                    direction,
                    leaves: None,
                    absorption: DVec3::ZERO,
                },
                1,
                options,
            )
            .z
    }

    #[test]
    fn light_through_glass_is_weighed_at_each_surface() {
        let lens = ball(0.0, 0.0, -5.0, CLEAR);
        let lit = scene(vec![lens.clone()], &[]);
        let ahead = |scene, options| radiance(scene, DVec3::ZERO, DVec3::NEG_Z, options);
        assert_eq!(ahead(&lit, Options::default()), 0.25);
        assert_eq!(
            ahead(
                &lit,
                Options {
                    depth: 2,
                    ..Options::default()
                }
            ),
            0.0
        );
        // A shadow ray crosses it twice.
        let shaded = scene(vec![lens, wall(-8.0, CHALK)], &[DVec3::new(0.0, 2.0, -5.0)]);
        let below = DVec3::new(0.0, -4.0, -5.0);
        assert_eq!(
            radiance(&shaded, below, DVec3::NEG_Y, Options::default()),
            0.25
        );
    }

    #[test]
    fn total_reflection_moves_the_transmitted_share_to_the_mirror() {
        // Along a chord beyond the critical angle: only the depth ends the path.
        let trap = scene(
            vec![ball(
                0.0,
                0.0,
                0.0,
                Finish {
                    ambient: 1.0,
                    ..CLEAR
                },
            )],
            &[],
        );
        let inside = DVec3::new(0.9, 0.0, 0.0);
        let weighed = |total_reflection| {
            radiance(
                &trap,
                inside,
                DVec3::Y,
                Options {
                    depth: 3,
                    total_reflection,
                    lift: 0.0,
                },
            )
        };
        assert_eq!(weighed(TotalReflection::KeepsEnergy), 1.0 + 0.5 + 0.25);
        assert_eq!(weighed(TotalReflection::IsPerfect), 3.0);
    }

    #[test]
    fn light_weakens_with_every_length_inside() {
        // A ball of water, 2 across: a ray through its middle, and a light in it and beyond it.
        let absorption = DVec3::new(0.5, 0.0, 1.0);
        let water = Finish {
            transmittance: 1.0,
            ior: 1.0,
            absorption,
            ..CLEAR
        };
        let ball = ball(0.0, 0.0, -5.0, water);
        let scene = scene(vec![ball, wall(-8.0, CHALK)], &[]);
        let seen = scene.seen(DVec3::NEG_Z, Options::default());
        let expected = scene.background * DVec3::new((-1.0f64).exp(), 1.0, (-2.0f64).exp());
        assert!(seen.distance(expected) < 1e-15, "{seen}");
        let shadow = |y: f64| {
            let ray = Ray {
                origin: DVec3::new(0.0, -8.0, -5.0),
                direction: DVec3::Y,
                leaves: Some(1),
                absorption: DVec3::ZERO,
            };
            scene.transmittance(ray, y + 8.0)
        };
        let expected = |distance: f64| left(absorption, distance);
        assert!(shadow(0.5).distance(expected(1.5)) < 1e-15);
        assert!(shadow(3.0).distance(expected(2.0)) < 1e-15);
        assert_eq!(shadow(-2.0), DVec3::ONE);
    }

    #[test]
    fn two_mirrors_add_a_series() {
        let silver = Finish {
            ambient: 0.125,
            mirror: 0.5,
            transmittance: 0.0,
            ..CLEAR
        };
        let hall = scene(vec![wall(0.0, silver.clone()), wall(1.0, silver)], &[]);
        let up = radiance(&hall, DVec3::Y * 0.5, DVec3::Y, Options::default());
        assert_eq!(up, 0.242_187_5);
    }

    #[test]
    fn surfaces_turned_away_from_a_light_or_hidden_from_it_are_dark() {
        let down = |objects, light| {
            let scene = scene(objects, &[light]);
            radiance(&scene, DVec3::Y, DVec3::NEG_Y, Options::default())
        };
        let floor = || wall(0.0, CHALK);
        assert_eq!(down(vec![floor()], DVec3::new(0.0, 5.0, 0.0)), 1.0);
        assert!((down(vec![floor()], DVec3::new(3.0, 4.0, 0.0)) - 0.8).abs() < 1e-15);
        assert_eq!(down(vec![floor()], DVec3::new(0.0, -5.0, 0.0)), 0.0);
        assert_eq!(down(vec![floor()], DVec3::ZERO), 0.0);
        let lid = ball(3.0, 4.0, 0.0, CHALK);
        assert_eq!(down(vec![floor(), lid], DVec3::new(6.0, 8.0, 0.0)), 0.0);
    }

    #[test]
    fn pixels_are_seen_through_their_centres() {
        let camera = scene(vec![], &[]).camera;
        let direction = camera.center(1, 0, 3, 2);
        assert_eq!(direction, DVec3::new(0.0, 0.5, -1.0).normalize());
    }

    #[test]
    fn channels_are_clamped_and_rounded() {
        let color = DVec3::new(-0.5, 0.5 / 255.0, 7.0);
        assert_eq!(quantize(color), [0, 1, 255]);
    }
}
