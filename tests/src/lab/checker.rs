//! The sweeps of a checker on surfaces in, or near, the boundaries of its cells.

use whitted::pattern::Spot;
use whitted::{Checker, Exact, Plane, Ray, Shape, Vec3};
use whitted_methods::checker::METHODS;

use super::random::{Point, Random};
use super::sweep::{Stage, Sweep};
use crate::exact::Verdict;

/// Two points of one square of a flat surface. An answer is wrong where they get two colors: a speck.
pub struct Checkers;

/// The rays that meet the points, the surface, and the size of cells.
pub struct Case {
    rays: [Ray; 2],
    plane: Plane,
    size: f32,
}

/// A surface that is off a boundary by so much of a cell, at an angle to it of this sine, and so many cells
/// away from the origin, as seen from `distance` cells away.
fn case(random: &mut Random, height: f64, slope: f64, offset: f64, distance: f64) -> Case {
    let size = random.between(0.5, 2.0) as f32;
    let axis = random.below(3);
    let sign = [1.0, -1.0][random.below(2)];
    let mut up = Point([0.0; 3]);
    up.0[axis] = sign;
    let side = random.across(up);
    let normal = up * (1.0 - slope * slope).sqrt() + side * slope;
    // Somewhere in a cell, and at the boundary along the axis.
    let mut place = random.vector(3.0) + random.direction() * offset;
    place.0[axis] = place.0[axis].round() + height;
    let cell = f64::from(size);
    let plane = Plane {
        point: (place * cell).round(),
        normal: normal.unit(),
    };
    let plane = match slope {
        0.0 => Plane {
            normal: up.round(),
            ..plane
        },
        _ => plane,
    };
    let across = random.across(normal);
    let along = normal.cross(across);
    let mut ray = || {
        let aim = place + across * (0.5 * random.signed()) + along * (0.5 * random.signed());
        let direction = random.direction() + normal * 1.2;
        let direction = direction * (1.0 / direction.dot(direction).sqrt());
        let eye = (aim + direction * distance) * cell;
        Ray::new(eye.round(), (direction * -1.0).unit())
    };
    Case {
        rays: [ray(), ray()],
        plane,
        size,
    }
}

impl Case {
    fn scaled(self, scale: f32) -> Self {
        let ray = |it: Ray| Ray::new(it.origin * scale, it.direction);
        Self {
            rays: self.rays.map(ray),
            plane: Plane {
                point: self.plane.point * scale,
                ..self.plane
            },
            size: self.size * scale,
        }
    }

    /// Where the ray really meets the plane, in which cell; of a boundary in which the plane lies, beneath.
    fn cell(&self, ray: &Ray) -> [i64; 3] {
        let normal = Point::new(self.plane.normal);
        let (origin, direction) = (Point::new(ray.origin), Point::new(ray.direction));
        let height = normal.dot(Point::new(self.plane.point) - origin);
        let at = origin + direction * (height / normal.dot(direction));
        let beneath = at * (1.0 / f64::from(self.size)) - normal * 1e-9;
        beneath.0.map(|x| x.floor() as i64)
    }
}

impl Stage for Checkers {
    const NAME: &'static str = "checker";
    type Case = Case;

    fn sweeps() -> Vec<Sweep<Case>> {
        let small = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7];
        let distance = "distance of the eye / cell, of a surface in a boundary";
        let offset = "distance of the scene from 0 / cell, of a surface in a boundary";
        let (near, far) = ([1.0, 1e1, 1e2, 1e3], [1e4, 1e5, 1e6]);
        // Cells as small as that, over the coordinates, are beyond what is promised.
        vec![
            Sweep::new("distance", distance, &near, |x, random| {
                case(random, 0.0, 0.0, 0.0, x)
            }),
            Sweep::new("distance, extreme", distance, &far, |x, random| {
                case(random, 0.0, 0.0, 0.0, x)
            }),
            Sweep::new("world offset", offset, &near, |x, random| {
                case(random, 0.0, 0.0, x, 10.0)
            }),
            Sweep::new("world offset, extreme", offset, &far, |x, random| {
                case(random, 0.0, 0.0, x, 10.0)
            }),
            Sweep::new(
                "height",
                "height of the surface over a boundary / cell",
                &small,
                |x, random| {
                    let height = x * random.signed();
                    case(random, height, 0.0, 0.0, 10.0)
                },
            ),
            Sweep::new(
                "slope",
                "sine of the angle of the surface to a boundary",
                &[0.7, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7],
                |x, random| case(random, 0.0, x, 0.0, 10.0),
            ),
            Sweep::new(
                "scale",
                "log2 of the size of everything",
                &[-40.0, -20.0, 0.0, 20.0, 40.0],
                |x, random| case(random, 0.0, 0.0, 0.0, 10.0).scaled(x.exp2() as f32),
            ),
        ]
    }

    fn methods() -> Vec<&'static str> {
        METHODS.iter().map(|method| method.name).collect()
    }

    fn ask(case: &Case, judged: &mut dyn FnMut(usize, Verdict)) {
        let checker = Checker {
            colors: [Vec3::ZERO, Vec3::ONE],
            size: case.size,
        };
        let [one, other] = case.rays.each_ref().map(|ray| {
            let t = case.plane.intersect::<Exact>(ray, &(), None);
            Spot {
                point: ray.at(t.unwrap_or(f32::NAN)),
                outward: case.plane.normal,
                uv: (0.0, 0.0),
            }
        });
        let [a, b] = case.rays.each_ref().map(|ray| case.cell(ray));
        for (i, method) in METHODS.iter().enumerate() {
            let differ = (method.run)(&checker, &one) != (method.run)(&checker, &other);
            judged(
                i,
                Verdict {
                    backward: 0.0,
                    forward: 0.0,
                    // A band in u says nothing of specks.
                    wrong: (a == b && differ).then_some(0.0),
                },
            );
        }
    }
}
