//! The plane's sweeps.

use whitted::{Plane, Ray, Vec3};
use whitted_methods::plane::{METHODS, PlaneForms};

use super::line;
use super::random::{Point, Random};
use super::sweep::{Stage, Sweep};
use crate::exact::{self, Verdict};

/// Ray and plane.
pub struct Planes;

/// A ray at a distance from where it meets the plane, at an angle whose sine is `slope`; the plane's
/// point at another distance from there, the scene `offset` from 0.
fn meet(
    random: &mut Random,
    distance: f64,
    slope: f64,
    point: f64,
    offset: f64,
) -> (Ray, PlaneForms) {
    let normal = random.direction();
    let within = random.across(normal);
    let hit = random.vector(1.0) + random.direction() * offset;
    let direction = within * (1.0 - slope * slope).sqrt() - normal * slope;
    let origin = hit - direction * distance;
    // The ray in front of the plane, or past it.
    let direction = if random.unit() < 0.8 {
        direction
    } else {
        direction * -1.0
    };
    let point = hit + random.across(normal) * point;
    let normal = normal.round();
    (
        Ray::new(origin.round(), direction.unit()),
        PlaneForms::new(Plane {
            point: point.round(),
            normal,
        }),
    )
}

impl Stage for Planes {
    const NAME: &'static str = "plane";
    type Case = (Ray, PlaneForms);

    fn sweeps() -> Vec<Sweep<Self::Case>> {
        let large = [1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6];
        vec![
            Sweep::new(
                "grazing",
                "sine of the angle between ray and plane",
                &[1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7],
                |x, random| {
                    let slope = x * random.between(0.5, 1.0);
                    meet(random, 10.0, slope, 1.0, 0.0)
                },
            ),
            Sweep::new("distance", "distance of the origin", &large, |x, random| {
                let slope = random.between(0.05, 1.0);
                meet(random, x, slope, 1.0, 0.0)
            }),
            Sweep::new(
                "far point",
                "distance of the plane's point",
                &large,
                |x, random| {
                    let slope = random.between(0.05, 1.0);
                    meet(random, 5.0, slope, x, 0.0)
                },
            ),
            Sweep::new(
                "world offset",
                "distance of the scene from 0",
                &large,
                |x, random| {
                    let slope = random.between(0.05, 1.0);
                    meet(random, 5.0, slope, 1.0, x)
                },
            ),
            Sweep::new(
                "near surface",
                "height of the origin over the plane",
                &[1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7],
                |x, random| {
                    let (_, plane) = meet(random, 1.0, 0.5, 3.0, 1.0);
                    let normal = Point::new(plane.plane.normal);
                    let foot =
                        Point::new(plane.plane.point) + random.across(normal) * random.unit();
                    let origin = foot + normal * (x * random.signed());
                    (Ray::new(origin.round(), random.direction().unit()), plane)
                },
            ),
            Sweep::new(
                "scale",
                "log2 of the size of everything",
                &[-60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0],
                |x, random| {
                    let slope = random.between(0.05, 1.0);
                    let (ray, plane) = meet(random, 5.0, slope, 1.0, 1.0);
                    let scale = |v: Vec3| v * x.exp2() as f32;
                    let Plane { point, normal } = plane.plane;
                    let plane = Plane {
                        point: scale(point),
                        normal,
                    };
                    (
                        Ray::new(scale(ray.origin), ray.direction),
                        PlaneForms::new(plane),
                    )
                },
            ),
        ]
    }

    fn methods() -> Vec<&'static str> {
        METHODS.iter().map(|method| method.name).collect()
    }

    fn ask((ray, plane): &Self::Case, judged: &mut dyn FnMut(usize, Verdict)) {
        let exact_ray = line(ray);
        let (point, normal) = (plane.plane.point.to_array(), plane.plane.normal.to_array());
        let truth = exact::plane::truth(&exact_ray, point, normal);
        for (i, method) in METHODS.iter().enumerate() {
            let verdict = exact::judge(
                &truth,
                (method.run)(ray, plane),
                |t| exact::plane::residual(&exact_ray, point, normal, t),
                || exact::plane::margins(&exact_ray, point, normal),
            );
            judged(i, verdict);
        }
    }
}
