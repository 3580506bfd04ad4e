//! The sphere's sweeps.

use whitted::{Ray, Sphere, Vec3};
use whitted_methods::sphere::METHODS;

use super::line;
use super::random::{Point, Random};
use super::sweep::{Stage, Sweep};
use crate::exact::{self, Verdict};

/// Ray and sphere.
pub struct Spheres;

/// A sphere of about unit size that is not centred anywhere special.
fn sphere(random: &mut Random, offset: f64) -> (Point, f64) {
    let center = random.vector(3.0) + random.direction() * offset;
    (center, random.between(0.5, 1.5))
}

/// A ray that starts at a distance and passes the center at a distance, rounded.
fn past(
    random: &mut Random,
    (center, radius): (Point, f64),
    start: f64,
    miss: f64,
) -> (Ray, Sphere) {
    let direction = random.direction();
    let side = random.across(direction);
    let back = (start * start - miss * miss).max(0.0).sqrt();
    let origin = center + side * miss - direction * back;
    (
        Ray::new(origin.round(), direction.unit()),
        Sphere {
            center: center.round(),
            radius: radius as f32,
        },
    )
}

impl Stage for Spheres {
    const NAME: &'static str = "sphere";
    type Case = (Ray, Sphere);

    fn sweeps() -> Vec<Sweep<Self::Case>> {
        let small = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7];
        vec![
            Sweep::new(
                "distance",
                "distance of the origin / radius",
                &[1.5, 3.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6],
                |x, random| {
                    let sphere = sphere(random, 0.0);
                    let miss = random.between(0.0, 1.3) * sphere.1;
                    past(random, sphere, x * sphere.1, miss)
                },
            ),
            Sweep::new(
                "grazing",
                "distance from the silhouette / radius",
                &small,
                |x, random| {
                    let sphere = sphere(random, 0.0);
                    let miss = (1.0 + x * random.signed()) * sphere.1;
                    past(random, sphere, 10.0 * sphere.1, miss)
                },
            ),
            Sweep::new(
                "near surface",
                "height of the origin over the surface / radius",
                &small,
                |x, random| {
                    let (center, radius) = sphere(random, 0.0);
                    let height = (1.0 + x * random.signed()) * radius;
                    let origin = center + random.direction() * height;
                    let ray = Ray::new(origin.round(), random.direction().unit());
                    let radius = radius as f32;
                    (
                        ray,
                        Sphere {
                            center: center.round(),
                            radius,
                        },
                    )
                },
            ),
            Sweep::new(
                "ground",
                "radius / height of the origin over the surface",
                &[1e1, 1e2, 1e3, 1e4, 1e5, 1e6],
                |x, random| {
                    let up = random.direction();
                    let origin = up * random.between(0.5, 1.5);
                    let ray = Ray::new(origin.round(), random.direction().unit());
                    let center = (up * -x).round();
                    (
                        ray,
                        Sphere {
                            center,
                            radius: x as f32,
                        },
                    )
                },
            ),
            Sweep::new(
                "world offset",
                "distance of the scene from 0 / radius",
                &[1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6],
                |x, random| {
                    let sphere = sphere(random, x);
                    let miss = random.between(0.0, 1.3) * sphere.1;
                    past(random, sphere, 5.0 * sphere.1, miss)
                },
            ),
            Sweep::new(
                "scale",
                "log2 of the size of everything",
                &[-60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0],
                |x, random| {
                    let sphere = sphere(random, 0.0);
                    let miss = random.between(0.0, 1.3) * sphere.1;
                    let (ray, sphere) = past(random, sphere, 5.0 * sphere.1, miss);
                    let scale = x.exp2() as f32;
                    (
                        Ray::new(ray.origin * scale, ray.direction),
                        Sphere {
                            center: sphere.center * scale,
                            radius: sphere.radius * scale,
                        },
                    )
                },
            ),
            Sweep::new(
                "along an axis",
                "distance of the origin / radius",
                // Beyond, the rounding of the distance alone is a backward error of 16 u.
                &[1.5, 1e1, 1e2, 1e3, 1e4, 1e5],
                |x, random| {
                    // Directions near an axis, shorter than 1 by u.
                    let (center, radius) = sphere(random, 0.0);
                    let side = Vec3::new(random.signed() as f32, random.signed() as f32, 0.0);
                    let tilt =
                        Vec3::new(random.signed() as f32, random.signed() as f32, 0.0) * 1e-4;
                    let origin =
                        center.round() + side * 1.1 - (Vec3::Z + tilt) * (x * radius) as f32;
                    let sphere = Sphere {
                        center: center.round(),
                        radius: radius as f32,
                    };
                    let direction = (Vec3::Z + tilt) * (1.0 - f32::EPSILON * 0.5);
                    (Ray::new(origin, direction), sphere)
                },
            ),
        ]
    }

    fn methods() -> Vec<&'static str> {
        METHODS.iter().map(|method| method.name).collect()
    }

    fn ask((ray, sphere): &Self::Case, judged: &mut dyn FnMut(usize, Verdict)) {
        let (exact_ray, center, radius) = (line(ray), sphere.center.to_array(), sphere.radius);
        let truth = exact::sphere::truth(&exact_ray, center, radius);
        for (i, method) in METHODS.iter().enumerate() {
            let verdict = exact::judge(
                &truth,
                (method.run)(ray, sphere),
                |t| exact::sphere::residual(&exact_ray, center, radius, t),
                || exact::sphere::margins(&exact_ray, center, radius),
            );
            judged(i, verdict);
        }
    }
}
