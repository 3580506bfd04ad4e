//! Vectors answer as the kernels do, to the bit.

use fearless_simd::Level;
use whitted::{
    Absorbing, Clip, Cuboid, Departure, Ends, Exact, Frustum, Geometry, Hit, Math, Mirror, Object,
    Patch, PhongReal, Plane, Polygon, Quadric, Ray, Shape, Side, Sphere, Torus, Triangle, Vec3,
};

use super::{Kinds, Wide, bounds, levels, lockstep};
use crate::paint::Paint;
use crate::scene::Material;

const fn stuff(transmittance: f32) -> Material {
    fog(transmittance, 0.0)
}

const fn fog(transmittance: f32, absorption: f32) -> Material {
    Material {
        color: Paint::Plain(Vec3::ONE),
        ambient: 0.0,
        diffuse: 1.0,
        highlight: PhongReal {
            specular: 0.0,
            shininess: 1.0,
        },
        reflection: Mirror { reflectance: 0.0 },
        transmission: Absorbing {
            tint: Vec3::splat(transmittance),
            ior: 1.5,
            absorption: Vec3::splat(absorption),
        },
    }
}

/// In which light weakens.
static FOG: Material = fog(0.9, 0.5);

static STUFF: [Material; 5] = [
    stuff(0.0),
    stuff(0.5),
    stuff(0.9),
    stuff(f32::NAN),
    stuff(-1.0),
];

/// Marsaglia's xorshift64*.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u32 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 32) as u32
    }

    fn below(&mut self, n: usize) -> usize {
        self.bits() as usize % n
    }

    /// From -1 to 1.
    fn signed(&mut self) -> f32 {
        (self.bits() as i32) as f32 / i32::MAX as f32
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }

    fn unit(&mut self) -> Vec3 {
        loop {
            let v = self.vector();
            if (0.01..1.0).contains(&v.length_squared()) {
                return Exact::normalize(v);
            }
        }
    }

    fn pick<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())]
    }
}

/// How a test's numbers come about.
#[derive(Clone, Copy, Debug)]
struct Style {
    name: &'static str,
    /// Objects of each kind.
    each: usize,
    /// Coordinates are whole multiples of this, so that ties abound; 0: they are not.
    grid: f32,
    /// Where the scene is.
    offset: Vec3,
    size: f32,
    /// Some objects are hollow, some twins of others, some odd.
    odd: bool,
}

const STYLES: [Style; 7] = [
    Style {
        name: "few",
        each: 3,
        grid: 0.0,
        offset: Vec3::ZERO,
        size: 0.6,
        odd: false,
    },
    Style {
        name: "many",
        each: 150,
        grid: 0.0,
        offset: Vec3::ZERO,
        size: 0.2,
        odd: false,
    },
    Style {
        name: "on a grid",
        each: 60,
        grid: 0.25,
        offset: Vec3::ZERO,
        size: 0.4,
        odd: true,
    },
    Style {
        name: "odd",
        each: 40,
        grid: 0.0,
        offset: Vec3::ZERO,
        size: 0.5,
        odd: true,
    },
    Style {
        name: "far from the origin",
        each: 80,
        grid: 0.0,
        offset: Vec3::new(3000.0, -70_000.0, 10.0),
        size: 0.3,
        odd: false,
    },
    Style {
        name: "tiny",
        each: 80,
        grid: 0.0,
        offset: Vec3::ZERO,
        size: 0.004,
        odd: false,
    },
    Style {
        name: "one inside another",
        each: 50,
        grid: 0.0,
        offset: Vec3::ZERO,
        size: 1.5,
        odd: true,
    },
];

/// A scene that owns its objects.
struct Owned {
    style: Style,
    spheres: Vec<Object<'static, Sphere, Material>>,
    planes: Vec<Object<'static, Plane, Material>>,
    polygons: Vec<Object<'static, Polygon<'static>, Material>>,
    triangles: Vec<Object<'static, Triangle, Material>>,
    patches: Vec<Object<'static, Patch, Material>>,
    cuboids: Vec<Object<'static, Cuboid, Material>>,
    frusta: Vec<Object<'static, Frustum, Material>>,
    quadrics: Vec<Object<'static, Quadric, Material>>,
    tori: Vec<Object<'static, Torus, Material>>,
}

/// Some of a list twice, so that there are ties between objects far apart in it.
fn twins<T: Clone>(random: &mut Random, list: &mut Vec<T>) {
    for _ in 0..list.len() / 4 {
        let twin = list[random.below(list.len())].clone();
        let place = random.below(list.len());
        list.insert(place, twin);
    }
}

impl Owned {
    fn new(style: Style, random: &mut Random) -> Self {
        let mut scene = Self {
            style,
            spheres: Vec::new(),
            planes: Vec::new(),
            polygons: Vec::new(),
            triangles: Vec::new(),
            patches: Vec::new(),
            cuboids: Vec::new(),
            frusta: Vec::new(),
            quadrics: Vec::new(),
            tori: Vec::new(),
        };
        for _ in 0..style.each {
            scene.add(random);
        }
        if style.odd {
            scene.add_odd();
            scene.add_odd_surfaces();
            twins(random, &mut scene.spheres);
            twins(random, &mut scene.polygons);
            twins(random, &mut scene.triangles);
            twins(random, &mut scene.patches);
            twins(random, &mut scene.cuboids);
            twins(random, &mut scene.frusta);
            twins(random, &mut scene.quadrics);
            twins(random, &mut scene.tori);
        }
        scene
    }

    fn point(style: Style, random: &mut Random) -> Vec3 {
        let point = random.vector() * 2.0;
        let point = if style.grid > 0.0 {
            (point / style.grid).round() * style.grid
        } else {
            point
        };
        point + style.offset
    }

    /// A point around another.
    fn near(style: Style, random: &mut Random, point: Vec3) -> Vec3 {
        let step = random.vector() * style.size;
        point
            + if style.grid > 0.0 {
                (step / style.grid).round() * style.grid
            } else {
                step
            }
    }

    fn add(&mut self, random: &mut Random) {
        let style = self.style;
        let center = Self::point(style, random);
        let material = &STUFF[random.below(3)];
        let radius = if style.grid > 0.0 {
            style.grid
        } else {
            style.size * (0.2 + random.signed().abs())
        };
        let radius = if style.odd && random.below(3) == 0 {
            -radius
        } else {
            radius
        };
        self.spheres.push(Object {
            shape: Sphere { center, radius },
            material,
        });
        if self.planes.len() < 2 {
            let shape = Plane {
                point: style.offset + Vec3::NEG_Y * (2.5 + self.planes.len() as f32),
                normal: Vec3::Y,
            };
            self.planes.push(Object { shape, material });
        }
        let mut corner = || Self::near(style, random, center);
        let corners = [corner(), corner(), corner()];
        if let Ok(shape) = Triangle::new(corners) {
            self.triangles.push(Object { shape, material });
        }
        if let Ok(shape) = Patch::new(corners, [Vec3::X, Vec3::Y, Vec3::Z]) {
            self.patches.push(Object { shape, material });
        }
        // Regular outlines around a center, every other vertex drawn in.
        let count = 3 + random.below(17);
        let (u, v) = (random.unit(), random.unit());
        let inner = 0.3 + random.signed().abs();
        let vertices: Vec<_> = (0..count)
            .map(|i| {
                let angle = i as f32 / count as f32 * std::f32::consts::TAU;
                let radius = style.size * if i % 2 == 0 { 1.0 } else { inner };
                center + (u * angle.cos() + v * angle.sin()) * radius
            })
            .collect();
        if let Ok(polygon) = Polygon::new(vertices.leak()) {
            self.polygons.push(Object {
                shape: polygon,
                material,
            });
        }
        let other = Self::near(style, random, center);
        if let Ok(shape) = Cuboid::new(center.min(other), center.max(other)) {
            self.cuboids.push(Object { shape, material });
        }
        let tip = radius * random.pick(&[0.0, 0.5, 1.0, 3.0]);
        if let Ok(shape) = Frustum::new(center, radius, other, tip) {
            self.frusta.push(Object { shape, material });
        }
        let ends = random.pick(&[Ends::Open, Ends::Closed]);
        let (radius, tip) = (radius.abs(), tip.abs());
        let quadric = match random.below(6) {
            0 => Quadric::ellipsoid(center, (other - center).abs() + radius),
            1 => Quadric::cylinder(center, other, radius, ends),
            2 => Quadric::paraboloid(center, other, radius, ends),
            3 => Quadric::hyperboloid(center, other, radius, 0.5 * radius, ends),
            4 => Quadric::two_sheets(center, other, radius, 0.5 * (other - center).length(), ends),
            _ => Quadric::cone(center, radius, other, tip, ends),
        };
        if let Ok(shape) = quadric {
            self.quadrics.push(Object { shape, material });
        }
        if let Ok(shape) = Torus::new(center, other - center, radius, radius * 0.3) {
            self.tori.push(Object { shape, material });
        }
    }

    /// What no constructor accepts, or what is beyond all proportion.
    fn add_odd(&mut self) {
        let material = &STUFF[3];
        for (center, radius) in [
            (Vec3::ZERO, 0.0),
            (Vec3::NAN, 1.0),
            (Vec3::ZERO, f32::NAN),
            (Vec3::ZERO, f32::INFINITY),
            (Vec3::Y * -1e6, 1e6),
            (Vec3::Y * -1e25, 1e25),
            (Vec3::ONE, 1e-30),
        ] {
            self.spheres.push(Object {
                shape: Sphere { center, radius },
                material,
            });
        }
        for vertices in [
            [Vec3::ZERO, Vec3::X * 1e24, Vec3::Y],
            [Vec3::ZERO, Vec3::X * f32::INFINITY, Vec3::Y],
            [Vec3::ZERO, Vec3::NAN, Vec3::Y],
            [Vec3::ZERO, Vec3::X, Vec3::X],
            [Vec3::ZERO, Vec3::X, Vec3::new(0.5, 0.5, 0.5)],
        ] {
            for normal in [Vec3::Z, Vec3::ZERO, Vec3::Z * 3.0, Vec3::NAN] {
                let shape = Triangle { vertices, normal };
                self.triangles.push(Object { shape, material });
            }
        }
        for vertices in [&[] as &[Vec3], &[Vec3::ONE], &[Vec3::ZERO, Vec3::X]] {
            let normal = Vec3::Z;
            self.polygons.push(Object {
                shape: Polygon { vertices, normal },
                material,
            });
        }
        for (min, max) in [
            (Vec3::ONE, Vec3::ZERO),
            (Vec3::NAN, Vec3::ONE),
            (Vec3::splat(-1e30), Vec3::splat(1e30)),
            (Vec3::NEG_INFINITY, Vec3::INFINITY),
            (Vec3::ZERO, Vec3::new(1.0, 0.0, 1.0)),
        ] {
            self.cuboids.push(Object {
                shape: Cuboid { min, max },
                material,
            });
        }
        for (axis, length, base_radius, slope) in [
            (Vec3::Y * 2.0, 1.0, 0.5, 0.0),
            (Vec3::Y, 0.0, 0.5, 0.0),
            (Vec3::Y, 1.0, 0.5, 1000.0),
            (Vec3::Y, 0.001, 1.0, -40.0),
            (Vec3::Y, f32::INFINITY, 0.1, 0.1),
            (Vec3::NAN, 1.0, 0.1, 0.1),
        ] {
            let base = Vec3::new(0.5, -1.0, 0.25);
            self.frusta.push(Object {
                shape: Frustum {
                    base,
                    axis,
                    length,
                    base_radius,
                    slope,
                },
                material,
            });
        }
    }

    /// Surfaces without bounds, and numbers that no constructor accepts.
    fn add_odd_surfaces(&mut self) {
        let material = &STUFF[3];
        let endless = Quadric::new(
            Vec3::ZERO,
            Vec3::new(1.0, -1.0, 1.0),
            Vec3::ZERO,
            Vec3::ZERO,
            -0.25,
            Clip::NONE,
            Ends::Open,
        );
        let endless = endless.expect("a quadric");
        let beyond = Clip {
            min: Vec3::splat(-1e30),
            max: Vec3::splat(1e30),
            ..Clip::NONE
        };
        let clips = [Clip::NONE, beyond].map(|clip| Quadric { clip, ..endless });
        let center = Vec3::NAN;
        for shape in clips.into_iter().chain([Quadric { center, ..endless }]) {
            self.quadrics.push(Object { shape, material });
        }
        for (axis, major, minor) in [
            (Vec3::Y * 2.0, 1.0, 0.25),
            (Vec3::NAN, 1.0, 0.25),
            (Vec3::Y, f32::INFINITY, 0.25),
            (Vec3::Y, 0.25, 1.0),
            (Vec3::Y, -1.0, 0.25),
        ] {
            let center = Vec3::new(-0.5, 0.5, 0.25);
            self.tori.push(Object {
                shape: Torus {
                    center,
                    axis,
                    major,
                    minor,
                },
                material,
            });
        }
    }

    fn kinds(&self) -> Kinds<'_, Material> {
        (
            &self.spheres,
            (
                &self.planes,
                (
                    &self.polygons,
                    (
                        &self.triangles,
                        (
                            &self.patches,
                            (&self.cuboids, (&self.frusta, (&self.quadrics, &self.tori))),
                        ),
                    ),
                ),
            ),
        )
    }

    /// A ray of one of many sorts.
    fn ray(&self, random: &mut Random) -> Ray {
        let style = self.style;
        let mut origin = Self::point(style, random);
        let mut direction = random.unit();
        match random.below(12) {
            0 => origin = style.offset + random.unit() * 1e5,
            1 => origin = style.offset + random.unit() * 30.0,
            2 => {
                direction = random.pick(&[Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::NEG_Z])
            }
            3 => direction = random.pick(&[Vec3::new(0.6, -0.0, 0.8), Vec3::new(-0.0, 0.8, -0.6)]),
            4 => direction = Exact::normalize(direction * Vec3::new(1.0, 1e-7, 1e-20)),
            5 => direction = random.pick(&[Vec3::NAN, Vec3::ZERO, Vec3::INFINITY, Vec3::X * 1e-30]),
            6 => direction *= random.pick(&[0.999, 1.001, 2.0, 1e10]),
            7 => origin = random.pick(&[Vec3::NAN, Vec3::INFINITY, Vec3::X * 1e30]),
            8 => direction = Vec3::new(1.0, f32::from_bits(1), -1e-39),
            _ => {}
        }
        if random.below(2) == 0 {
            // At something: its middle, or where it is touched.
            let sphere = random.below(self.spheres.len());
            let sphere = self.spheres[sphere].shape;
            let target = match random.below(5) {
                3 if !self.tori.is_empty() => {
                    // Where the box round it is touched.
                    let torus = self.tori[random.below(self.tori.len())].shape;
                    let way = random.pick(&Vec3::AXES) * random.pick(&[1.0, -1.0]);
                    let across = way - torus.axis * way.dot(torus.axis);
                    let ring = across.try_normalize().unwrap_or(Vec3::ZERO);
                    torus.center + ring * torus.major + way * torus.minor
                }
                4 if !self.quadrics.is_empty() => {
                    let quadric = self.quadrics[random.below(self.quadrics.len())].shape;
                    let share = Vec3::new(random.signed(), random.signed(), random.signed());
                    let (min, max) = (quadric.clip.min, quadric.clip.max);
                    let inside = min + (max - min) * (share * 0.5 + 0.5);
                    let (side, axis) = (random.pick(&[min, max]), random.below(3));
                    // At a side of the box round it.
                    let mut at = inside.to_array();
                    at[axis] = side.to_array()[axis];
                    quadric.center + Vec3::from_array(at)
                }
                0 => sphere.center,
                1 => sphere.center + random.unit() * sphere.radius,
                _ => {
                    let triangle = random.below(self.triangles.len().max(1));
                    let vertices = self.triangles.get(triangle).map(|it| it.shape.vertices);
                    let [a, b, c] = vertices.unwrap_or([Vec3::ZERO; 3]);
                    random.pick(&[a, (a + b) * 0.5, (a + b + c) / 3.0])
                }
            };
            let to_target = target - origin;
            if to_target.length_squared().is_normal() {
                direction = Exact::normalize(to_target);
            }
        }
        let t_max = match random.below(8) {
            0..4 => f32::INFINITY,
            4 => random.pick(&[0.0, -1.0, f32::NAN, f32::MAX, 1e-40]),
            _ => random.signed().abs() * 3.0,
        };
        let departure = (random.below(4) == 0).then(|| Departure {
            object: random.below(self.kinds().len() + 3),
            side: random.pick(&[Side::Inside, Side::Outside]),
        });
        Ray {
            origin,
            direction,
            t_max,
            departure,
        }
    }
}

/// The bits of everything that can be asked about a ray.
#[derive(Debug, PartialEq)]
struct Answers {
    /// Distance, object, normal and side.
    hit: Option<(u32, usize, [u32; 3], bool)>,
    occluded: bool,
    transmittance: u32,
}

fn bits(hit: Option<Hit<'_, Material>>) -> Option<(u32, usize, [u32; 3], bool)> {
    hit.map(|hit| {
        let normal = hit.normal.to_array().map(f32::to_bits);
        (hit.t.to_bits(), hit.object, normal, hit.front)
    })
}

fn answers(geometry: &impl Geometry<Material = Material>, ray: &Ray) -> Answers {
    Answers {
        hit: bits(geometry.closest_hit(ray)),
        occluded: geometry.occluded(ray),
        transmittance: geometry.transmittance(ray).x.to_bits(),
    }
}

/// How many rays hit, pass unhindered, and are dimmed.
fn compare(scene: &Owned, level: Level, flat: usize, rays: usize, random: &mut Random) -> [u32; 3] {
    let kinds = scene.kinds();
    let wide = Wide::with(kinds, level, flat);
    assert_eq!(wide.len(), kinds.len());
    // As the right part of a pair, all places are shifted.
    let before = [Object {
        shape: Sphere {
            center: Vec3::splat(1e4),
            radius: 1.0,
        },
        material: &STUFF[0],
    }];
    let before = before.as_slice();
    let mut counts = [0; 3];
    for _ in 0..rays {
        let mut ray = scene.ray(random);
        for _ in 0..3 {
            let expected = answers(&kinds, &ray);
            assert_eq!(answers(&wide, &ray), expected, "{:?} {ray:?}", scene.style);
            let (narrow, wide) = ((before, kinds), (before, &wide));
            assert_eq!(answers(&wide, &ray), answers(&narrow, &ray), "{ray:?}");
            let light = kinds.transmittance(&ray).x;
            counts[0] += u32::from(kinds.closest_hit(&ray).is_some());
            counts[1] += u32::from(light == 1.0);
            counts[2] += u32::from(light > 0.0 && light < 1.0);
            // On from there, mirrored or through.
            let Some(hit) = kinds.closest_hit(&ray) else {
                break;
            };
            let direction = random.unit();
            ray = if direction.dot(hit.normal) > 0.0 {
                hit.back(direction)
            } else {
                hit.through(direction)
            };
        }
    }
    counts
}

#[test]
fn every_level_answers_as_the_kernels_do() {
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    for style in STYLES {
        let scene = Owned::new(style, &mut random);
        for (name, level) in levels() {
            for flat in [0, usize::MAX] {
                let [hits, free, dimmed] = compare(&scene, level, flat, 1500, &mut random);
                assert!(
                    hits > 200 && free > 50 && dimmed > 20,
                    "{name}, {}: {hits} hits, {free} free, {dimmed} dimmed say nothing",
                    style.name
                );
            }
        }
    }
}

impl Owned {
    /// Rays of which some go about the same way and some all ways, as many as do not fill every vector.
    fn bundle(&self, random: &mut Random) -> Vec<Ray> {
        let mut rays = Vec::new();
        for _ in 0..4 {
            let first = self.ray(random);
            let spread = random.pick(&[0.0, 1e-3, 0.05, 4.0]);
            let back = random.pick(&[0.0, 0.0, 1e4, 1e6]);
            for _ in 0..1 + random.below(24) {
                let direction = first.direction + random.vector() * spread;
                // One may start far behind the others.
                let back = random.pick(&[0.0, 0.0, back]);
                rays.push(Ray {
                    origin: first.origin - first.direction * back,
                    direction: Exact::normalize(direction),
                    ..first
                });
            }
        }
        rays
    }

    /// Rays that all go their own ways.
    fn strewn(&self, random: &mut Random) -> Vec<Ray> {
        (0..40).map(|_| self.ray(random)).collect()
    }
}

/// Some rays into a scene.
type Rays = fn(&Owned, &mut Random) -> Vec<Ray>;

/// Whether rays together are answered as the kernels do, by all levels; how many rays hit and how many are
/// dimmed, by the one of which those are the fewest.
fn compare_together(
    scene: &Owned,
    flat: usize,
    (bundles, bundle): (usize, Rays),
    random: &mut Random,
    wanted: impl Fn(&Wide<'_, Material>, &Ray) -> bool,
) -> [u32; 2] {
    let kinds = scene.kinds();
    let mut least = [u32::MAX; 2];
    for (name, level) in levels() {
        let wide = Wide::with(kinds, level, flat);
        let [mut met, mut dimmed] = [0, 0];
        for _ in 0..bundles {
            let mut rays = bundle(scene, random);
            rays.retain(|ray| wanted(&wide, ray));
            let mut hits = vec![None; rays.len()];
            let mut passed = vec![f32::NAN; rays.len()];
            lockstep::closest_hits(&wide, &rays, |ray, hit| hits[ray] = Some(hit));
            lockstep::transmittances(&wide, &rays, &mut passed);
            for ((ray, hit), passed) in rays.iter().zip(hits).zip(passed) {
                let expected = kinds.closest_hit(ray);
                let more = |hit: Option<Hit<'_, Material>>| {
                    let point = |it: Hit<'_, _>| it.point.to_array().map(f32::to_bits);
                    hit.map(|it| (point(it), it.material as *const Material))
                };
                let same = more(hit) == more(expected) && bits(hit) == bits(expected);
                assert!(
                    same,
                    "{name} {:?} {ray:?}: {hit:?}, not {expected:?}",
                    scene.style
                );
                let light = kinds.transmittance(ray).x;
                let same = passed.to_bits() == light.to_bits();
                assert!(
                    same,
                    "{name} {:?} {ray:?}: {passed}, not {light}",
                    scene.style
                );
                met += u32::from(hit.is_some());
                dimmed += u32::from(light > 0.0 && light < 1.0);
            }
        }
        least = [least[0].min(met), least[1].min(dimmed)];
    }
    least
}

#[test]
fn rays_together_are_answered_as_the_kernels_do() {
    let mut random = Random(0x2545_f491_4f6c_dd1d);
    for style in STYLES {
        let mut scene = Owned::new(style, &mut random);
        for flat in [0, usize::MAX] {
            let [met, dimmed] =
                compare_together(&scene, flat, (200, Owned::bundle), &mut random, |_, _| true);
            assert!(met > 400 && dimmed > 20, "{style:?}: {met}, {dimmed}");
        }
        // Without the odd rays, each of which keeps its group from being cast as one.
        let regular = |wide: &Wide<'_, Material>, ray: &Ray| wide.takes_this(ray);
        let [met, _] = compare_together(&scene, 0, (100, Owned::bundle), &mut random, regular);
        assert!(met > 200, "{style:?}: {met}");
        // And without objects that every ray is cast into apart, what it leaves among them.
        scene.tame();
        scene.planes.clear();
        let [met, dimmed] = compare_together(&scene, 0, (200, Owned::bundle), &mut random, regular);
        assert!(met > 400 && dimmed > 20, "{style:?}: {met}, {dimmed}");
        // Where light weakens on its way.
        scene.spheres[0].material = &FOG;
        let [met, dimmed] = compare_together(&scene, 0, (100, Owned::bundle), &mut random, regular);
        assert!(met > 200 && dimmed > 20, "{style:?}: {met}, {dimmed}");
    }
}

/// Rays that have little in common, among few objects: they meet most in pairs.
#[test]
fn pairs_are_answered_as_the_kernels_do() {
    let mut random = Random(0x6a09_e667_f3bc_c908);
    for style in STYLES {
        let mut scene = Owned::new(
            Style {
                each: 9,
                odd: false,
                ..style
            },
            &mut random,
        );
        // Ties, with others of the kind and of another.
        twins(&mut random, &mut scene.triangles);
        twins(&mut random, &mut scene.cuboids);
        let shape = scene.patches[0].shape;
        scene.triangles[1].shape = Triangle::new(shape.vertices).unwrap();
        // Of these, not all would be tested.
        scene.quadrics.clear();
        scene.tori.clear();
        let strewn: (_, Rays) = (100, Owned::strewn);
        let regular = |wide: &Wide<'_, Material>, ray: &Ray| {
            assert!(wide.few.is_some());
            wide.takes_this(ray)
        };
        let [met, dimmed] = compare_together(&scene, usize::MAX, strewn, &mut random, regular);
        assert!(met > 400 && dimmed > 20, "{style:?}: {met}, {dimmed}");
        // One that leaves an object and may meet it again keeps its group from that.
        let free =
            |wide: &Wide<'_, Material>, ray: &Ray| regular(wide, ray) && ray.departure.is_none();
        let [met, _] = compare_together(&scene, usize::MAX, strewn, &mut random, free);
        assert!(met > 200, "{style:?}: {met}");
        // And without those that all rays are cast into.
        scene.planes.clear();
        scene.frusta.clear();
        let [met, _] = compare_together(&scene, usize::MAX, strewn, &mut random, free);
        assert!(met > 200, "{style:?}: {met}");
    }
}

#[test]
fn rays_put_in_order_are_answered_as_the_kernels_do() {
    let mut random = Random(0xbb67_ae85_84ca_a73b);
    for style in STYLES {
        let scene = Owned::new(style, &mut random);
        let kinds = scene.kinds();
        // The last group is not whole.
        let rays: Vec<_> = (0..5001).map(|_| scene.ray(&mut random)).collect();
        for (name, level) in levels() {
            let mut wide = Wide::with(kinds, level, 0);
            // As if there were more.
            wide.is_far = true;
            wide.bounds = Some([style.offset - 2.0, style.offset + 2.0]);
            let mut hits = vec![None; rays.len()];
            let (mut last, mut turns) = (0, 0);
            lockstep::closest_hits(&wide, &rays, |ray, hit| {
                assert!(hits[ray].replace(hit).is_none(), "{ray} comes twice");
                turns += u32::from(ray < last);
                last = ray;
            });
            assert!(
                turns > 100,
                "{name} {style:?}: the order is that of the rays"
            );
            for (ray, hit) in rays.iter().zip(hits) {
                let expected = kinds.closest_hit(ray);
                assert_eq!(bits(hit), bits(expected), "{name} {style:?} {ray:?}");
            }
            // All of them at a time, and so many that some are left.
            for is_far in [true, false] {
                wide.is_far = is_far;
                // One place less than there are rays.
                let mut passed = vec![f32::NAN; rays.len() - 1];
                lockstep::transmittances(&wide, &rays, &mut passed);
                for (ray, passed) in rays.iter().zip(passed) {
                    let light = kinds.transmittance(ray).x;
                    assert_eq!(
                        passed.to_bits(),
                        light.to_bits(),
                        "{name} {style:?} {ray:?}"
                    );
                }
            }
        }
    }
}

impl Owned {
    /// Without what the lanes leave to the kernels.
    fn tame(&mut self) {
        self.spheres
            .retain(|it| bounds::of_sphere(&it.shape).is_some());
        self.polygons
            .retain(|it| bounds::of_outline(it.shape.vertices, it.shape.normal).is_some());
        self.triangles
            .retain(|it| bounds::of_outline(&it.shape.vertices, it.shape.normal).is_some());
        self.cuboids
            .retain(|it| bounds::of_cuboid(&it.shape).is_some());
        self.frusta
            .retain(|it| bounds::of_frustum(&it.shape).is_some());
        self.quadrics.clear();
        self.tori.clear();
    }
}

#[test]
fn rays_across_the_lanes_are_answered_as_the_kernels_do() {
    let mut random = Random(0x6a09_e667_f3bc_c908);
    for style in STYLES {
        let mut scene = Owned::new(style, &mut random);
        scene.tame();
        let wanted = |wide: &Wide<'_, Material>, ray: &Ray| {
            assert!(wide.few.is_some());
            wide.takes_this(ray)
        };
        let [met, dimmed] = compare_together(
            &scene,
            usize::MAX,
            (100, Owned::bundle),
            &mut random,
            wanted,
        );
        assert!(met > 400 && dimmed > 40, "{style:?}: {met}, {dimmed}");
        // Where light weakens on its way.
        scene.planes[0].material = &FOG;
        let [met, dimmed] =
            compare_together(&scene, usize::MAX, (50, Owned::bundle), &mut random, wanted);
        assert!(met > 200 && dimmed > 40, "{style:?}: {met}, {dimmed}");
    }
}

/// Where a ray's line enters the box round some points, and where it leaves it; the latter first where it passes by.
fn inside(points: &[Vec3], ray: &Ray) -> (f64, f64) {
    let (mut entry, mut exit) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        let times = points.iter().map(|it| {
            (f64::from(it[axis]) - f64::from(ray.origin[axis])) / f64::from(ray.direction[axis])
        });
        entry = entry.max(times.clone().fold(f64::INFINITY, f64::min));
        exit = exit.min(times.fold(f64::NEG_INFINITY, f64::max));
    }
    (entry, exit)
}

/// An outline that is seen edge-on may be reported before the ray enters its box, and then hides what lies
/// between; or ahead of a ray that starts beyond its box.
#[test]
fn what_is_reported_off_its_box_is_not_passed_over() {
    const CLEAR: f64 = 0.02;
    let mut random = Random(0xbb67_ae85_84ca_a73b);
    let mut counts = [[0; 2]; 3];
    for _ in 0..2_000_000 {
        // All corners lie in a plane with the ray, as well as rounding allows.
        let ray = Ray::new(random.vector(), random.unit());
        let across = Exact::normalize(random.unit().cross(ray.direction));
        let (ahead, more) = (random.pick(&[0.0, 3.0]), random.below(3));
        let corners = [(); 5].map(|()| {
            ray.origin + ray.direction * (ahead + random.signed()) + across * random.signed()
        });
        let Ok(outline) = Polygon::new(&corners[..3 + more]) else {
            continue;
        };
        let Some(t) = outline.intersect::<Exact>(&ray, &Polygon::setup(&ray), None) else {
            continue;
        };
        let (entry, exit) = inside(outline.vertices, &ray);
        let is_early = f64::from(t) + CLEAR < entry;
        if entry > exit || !(is_early || exit < -CLEAR) {
            continue;
        }
        counts[more][usize::from(is_early)] += 1;
        // Where the ray starts beyond the box, also with all boxes behind it.
        let between = if is_early {
            (t + entry as f32) * 0.5
        } else {
            random.pick(&[t + 1.0, exit as f32 - 0.1])
        };
        let balls = [Object {
            shape: Sphere {
                center: ray.origin + ray.direction * (between + 0.005),
                radius: 0.005,
            },
            material: &STUFF[0],
        }];
        let outlines = [Object {
            shape: outline,
            material: &STUFF[0],
        }];
        let mut kinds: Kinds<'_, Material> = Default::default();
        kinds.0 = &balls;
        kinds.1.1.0 = &outlines;
        let expected = answers(&kinds, &ray);
        assert_eq!(expected.hit.map(|it| it.1), Some(1));
        let d = ray.direction;
        let turned = Ray::new(ray.origin, Vec3::new(d.y, d.z, d.x).abs() * d.signum());
        for (name, level) in levels() {
            let wide = Wide::with(kinds, level, 0);
            assert_eq!(
                answers(&wide, &ray),
                expected,
                "{name}: {ray:?}, {outline:?}"
            );
            // Alone, and among rays that are closest to another axis in spite of the same signs.
            for other in [ray, turned] {
                let rays: [_; 16] =
                    core::array::from_fn(|lane| if lane % 2 == 0 { other } else { ray });
                let mut hits = [None; 16];
                lockstep::closest_hits(&wide, &rays, |ray, hit| hits[ray] = Some(hit));
                for (ray, hit) in rays.iter().zip(hits) {
                    let expected = bits(kinds.closest_hit(ray));
                    assert_eq!(bits(hit), expected, "{name}: {ray:?}, {outline:?}");
                }
            }
        }
    }
    assert!(
        counts.as_flattened().iter().all(|&it| it > 30),
        "{counts:?} cases say nothing"
    );
}
