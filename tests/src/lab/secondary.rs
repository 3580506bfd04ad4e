//! Secondary rays: points shadowed by the surface on which they lie, and light that leaks past what is
//! close to them.
//!
//! All answers are known: the light is in front of a convex or flat surface, so nothing of that surface
//! is in between; or an occluder is.

use whitted::{Cuboid, Exact, Frustum, Plane, Ray, Shape, Side, Sphere, Triangle, Vec3};
use whitted_methods::secondary::{Leaving, METHODS, Start};

use super::mesh::Mesh;
use super::random::{Point, Random};
use super::sweep::{Stage, Sweep};
use crate::exact::Verdict;

/// Rays that leave a surface.
pub struct Secondary;

/// A surface that is left, and what the ray to the light then meets.
pub struct Case {
    leaving: Leaving,
    own: Own,
    light: Vec3,
    question: Question,
}

enum Own {
    Sphere(Sphere),
    Plane(Plane),
    Triangle(Triangle),
    Cuboid(Cuboid),
    Frustum(Frustum),
}

/// How many kinds of them there are.
const KINDS: usize = 5;

enum Question {
    /// Whether the surface shadows itself; it does not.
    Own,
    /// Whether this plane is in between; it is.
    Occluder(Plane),
    /// Whether these other faces of a convex mesh are in between; they are not.
    Neighbours(Vec<Triangle>),
}

impl Own {
    fn meet(&self, ray: &Ray, leaving: Option<Side>) -> Option<f32> {
        match self {
            Self::Sphere(sphere) => sphere.intersect::<Exact>(ray, &(), leaving),
            Self::Plane(plane) => plane.intersect::<Exact>(ray, &(), leaving),
            Self::Triangle(triangle) => {
                triangle.intersect::<Exact>(ray, &Triangle::setup(ray), leaving)
            }
            Self::Cuboid(cuboid) => cuboid.intersect::<Exact>(ray, &Cuboid::setup(ray), leaving),
            Self::Frustum(frustum) => frustum.intersect::<Exact>(ray, &(), leaving),
        }
    }

    fn normal(&self, ray: &Ray, t: f32) -> Vec3 {
        match self {
            Self::Sphere(sphere) => sphere.normal::<Exact>(ray, t),
            Self::Plane(plane) => plane.normal,
            Self::Triangle(triangle) => triangle.normal,
            Self::Cuboid(cuboid) => cuboid.normal::<Exact>(ray, t),
            Self::Frustum(frustum) => frustum.normal::<Exact>(ray, t),
        }
    }

    /// What round ones are round of, and their radius; of the others a point on the face that has this
    /// normal.
    fn anchor(&self, normal: Vec3) -> (Vec3, f32) {
        match self {
            Self::Sphere(sphere) => (sphere.center, sphere.radius),
            Self::Plane(plane) => (plane.point, 0.0),
            Self::Triangle(triangle) => (triangle.vertices[0], 0.0),
            Self::Cuboid(cuboid) => {
                let corner = Vec3::select(normal.cmpgt(Vec3::ZERO), cuboid.max, cuboid.min);
                (corner, 0.0)
            }
            Self::Frustum(frustum) => {
                let most = frustum.base_radius + frustum.slope * frustum.length;
                (frustum.base, most)
            }
        }
    }
}

/// What the camera sees of a surface, or `None` if that rounds away.
fn look(own: &Own, eye: Point, aim: Point) -> Option<(Ray, f32, Vec3)> {
    let origin = eye.round();
    let ray = Ray::new(origin, (aim - Point::new(origin)).unit());
    let t = own.meet(&ray, None)?;
    let normal = own.normal(&ray, t);
    let normal = match (ray.direction.dot(normal) > 0.0, own) {
        // One side of its inside may shadow the other.
        (true, Own::Frustum(_)) => return None,
        (true, _) => -normal,
        (false, _) => normal,
    };
    Some((ray, t, normal))
}

/// A light that the side of the normal sees under an angle whose cosine is from 0.001 to 1.
fn light(random: &mut Random, point: Vec3, normal: Vec3, distance: f64) -> Vec3 {
    let normal = Point::new(normal);
    let cosine = 10.0_f64.powf(random.between(-3.0, 0.0));
    let side = random.across(normal) * (1.0 - cosine * cosine).sqrt();
    (Point::new(point) + (normal * cosine + side) * distance).round()
}

impl Case {
    /// The camera 4 sizes away, the light 3, everything `offset` sizes from the origin.
    fn own(kind: usize, size: f64, offset: f64, random: &mut Random) -> Self {
        loop {
            let center = (random.vector(2.0) + random.direction() * offset) * size;
            let toward = random.direction();
            let (own, aim) = match kind {
                0 => {
                    let radius = size * random.between(0.5, 1.0);
                    let sphere = Sphere {
                        center: center.round(),
                        radius: radius as f32,
                    };
                    let miss = random.across(toward) * (radius * random.between(0.0, 0.99));
                    (Own::Sphere(sphere), center + miss)
                }
                1 => {
                    let normal = random.direction();
                    let plane = Plane {
                        point: center.round(),
                        normal: normal.round(),
                    };
                    let aim = center + random.across(normal) * (size * random.unit());
                    (Own::Plane(plane), aim)
                }
                2 => {
                    let normal = random.direction();
                    let x = random.across(normal);
                    let y = normal.cross(x);
                    let corner = |a: f64| center + (x * a.cos() + y * a.sin()) * size;
                    let vertices = [0.0, 2.1, 4.2].map(|a| corner(a).round());
                    let Ok(triangle) = Triangle::new(vertices) else {
                        continue;
                    };
                    (
                        Own::Triangle(triangle),
                        center + x * (size * 0.4 * random.unit()),
                    )
                }
                3 => {
                    let half = Point([0; 3].map(|_| size * random.between(0.2, 0.6)));
                    let (min, max) = ((center - half).round(), (center + half).round());
                    let aim = center + random.vector(0.5 * size);
                    (Own::Cuboid(Cuboid { min, max }), aim)
                }
                _ => {
                    let axis = random.direction() * (0.5 * size);
                    let radii = [0; 2].map(|_| (size * random.between(0.0, 0.5)) as f32);
                    let ends = [center - axis, center + axis].map(Point::round);
                    let Ok(frustum) = Frustum::new(ends[0], radii[0], ends[1], radii[1]) else {
                        continue;
                    };
                    (Own::Frustum(frustum), center + random.vector(0.3 * size))
                }
            };
            let eye = aim - toward * (4.0 * size);
            let Some((ray, t, normal)) = look(&own, eye, aim) else {
                continue;
            };
            let (anchor, radius) = own.anchor(normal);
            let leaving = Leaving {
                eye: ray.origin,
                way: ray.direction * t,
                point: ray.at(t),
                normal,
                anchor,
                radius,
            };
            let light = light(random, leaving.point, normal, 3.0 * size);
            // Rounded to the other side, it lights nothing.
            if (light - leaving.point).dot(normal) > 0.0 {
                return Self {
                    leaving,
                    own,
                    light,
                    question: Question::Own,
                };
            }
        }
    }

    /// The same with an occluder parallel to the surface, `gap` sizes above the point.
    fn leak(size: f64, gap: f64, random: &mut Random) -> Self {
        let case = Self::own(random.below(KINDS), size, 0.0, random);
        let (point, normal) = (
            Point::new(case.leaving.point),
            Point::new(case.leaving.normal),
        );
        // The light above it.
        let height = (Point::new(case.light) - point).dot(normal);
        if height < 2.0 * gap * size {
            return Self::leak(size, gap, random);
        }
        let occluder = Plane {
            point: (point + normal * (gap * size)).round(),
            normal: case.leaving.normal,
        };
        // The same for the rounded plane, and not below the rounded point.
        if (Point::new(occluder.point) - point).dot(normal) < 0.5 * gap * size {
            return Self::leak(size, gap, random);
        }
        Self {
            question: Question::Occluder(occluder),
            ..case
        }
    }

    /// A point of a convex mesh, `offset` sizes from the origin.
    fn neighbours(offset: f64, random: &mut Random) -> Self {
        let mesh = Mesh::icosphere(1);
        let shift = random.direction() * offset;
        let faces: Vec<Triangle> = mesh
            .faces
            .iter()
            .filter_map(|face| {
                let corner = |i: usize| (Point::new(mesh.vertices[face[i]]) + shift).round();
                Triangle::new([corner(0), corner(1), corner(2)]).ok()
            })
            .collect();
        loop {
            let index = random.below(faces.len());
            let own = Own::Triangle(faces[index]);
            let corners = faces[index].vertices.map(Point::new);
            let [u, v] = [random.unit(), random.unit()];
            let (u, v) = if u + v > 1.0 {
                (1.0 - u, 1.0 - v)
            } else {
                (u, v)
            };
            let aim = corners[0] + (corners[1] - corners[0]) * u + (corners[2] - corners[0]) * v;
            let outward = Point::new(faces[index].normal);
            let eye = aim + (outward + random.vector(0.5)) * 4.0;
            let Some((ray, t, normal)) = look(&own, eye, aim) else {
                continue;
            };
            let leaving = Leaving {
                eye: ray.origin,
                way: ray.direction * t,
                point: ray.at(t),
                normal,
                anchor: faces[index].vertices[0],
                radius: 0.0,
            };
            let light = light(random, leaving.point, normal, 3.0);
            if normal.dot(faces[index].normal) > 0.0 && (light - leaving.point).dot(normal) > 0.0 {
                let mut others = faces;
                others.swap_remove(index);
                return Self {
                    leaving,
                    own,
                    light,
                    question: Question::Neighbours(others),
                };
            }
        }
    }

    /// Whether this start of the ray gets it wrong.
    fn is_wrong(&self, start: Start) -> bool {
        let to_light = self.light - start.origin;
        let distance = to_light.length();
        let mut ray = Ray::new(start.origin, to_light / distance);
        ray.t_max = distance;
        let counts = |t: Option<f32>| t.is_some_and(|t| t > start.t_min);
        match &self.question {
            Question::Own => {
                // Solids are seen from outside, and the sides of the others do not matter.
                let leaving = start.skips.then_some(Side::Outside);
                counts(self.own.meet(&ray, leaving))
            }
            Question::Occluder(plane) => !counts(plane.intersect::<Exact>(&ray, &(), None)),
            Question::Neighbours(faces) => {
                let setup = Triangle::setup(&ray);
                faces
                    .iter()
                    .any(|face| counts(face.intersect::<Exact>(&ray, &setup, None)))
            }
        }
    }
}

impl Stage for Secondary {
    const NAME: &'static str = "secondary";
    type Case = Case;

    fn sweeps() -> Vec<Sweep<Case>> {
        let small = 1.0 / (1_u64 << 40) as f64;
        let sizes = [small, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1.0 / small];
        let gaps = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7];
        let offsets = [0.0, 1.0, 1e1, 1e2, 1e3, 1e4];
        let own = |kind| move |x: f64, random: &mut Random| Case::own(kind, x, 0.0, random);
        let leak = |size| move |x: f64, random: &mut Random| Case::leak(size, x, random);
        let (size, gap) = ("size of everything", "gap / size");
        vec![
            Sweep::new(
                "neighbour",
                "distance from 0 / size",
                &offsets,
                Case::neighbours,
            ),
            Sweep::new("leak, size 1", gap, &gaps, leak(1.0)),
            Sweep::new("leak, size 1e-6", gap, &gaps, leak(1e-6)),
            Sweep::new("acne, plane", size, &sizes, own(1)),
            Sweep::new("acne, sphere", size, &sizes, own(0)),
            Sweep::new(
                "acne, offset",
                "distance from 0 / size",
                &offsets,
                |x, random| {
                    let kind = random.below(KINDS);
                    Case::own(kind, 1.0, x, random)
                },
            ),
            Sweep::new("acne, triangle", size, &sizes, own(2)),
            Sweep::new("acne, box", size, &sizes, own(3)),
            Sweep::new("acne, cone", size, &sizes, own(4)),
            Sweep::new("leak, size 1e6", gap, &gaps, leak(1e6)),
            Sweep::new("leak, size 2^-40", gap, &gaps, leak(small)),
            Sweep::new("leak, size 2^40", gap, &gaps, leak(1.0 / small)),
        ]
    }

    fn methods() -> Vec<&'static str> {
        METHODS.iter().map(|method| method.name).collect()
    }

    fn ask(case: &Case, judged: &mut dyn FnMut(usize, Verdict)) {
        for (i, method) in METHODS.iter().enumerate() {
            let wrong = case.is_wrong((method.run)(&case.leaving));
            let verdict = Verdict {
                backward: 0.0,
                forward: 0.0,
                wrong: wrong.then_some(0.0),
            };
            judged(i, verdict);
        }
    }
}
