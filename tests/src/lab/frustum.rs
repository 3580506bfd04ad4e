//! The frustum's sweeps.

use whitted::{Frustum, Ray};
use whitted_methods::frustum::METHODS;

use super::line;
use super::random::{Point, Random};
use super::sweep::{Stage, Sweep};
use crate::exact::{self, Verdict};

/// Ray and open cylinder or cone.
pub struct Frusta;

type Case = (Ray, Frustum);

/// A cylinder, a cone or something between.
fn frustum(random: &mut Random, offset: f64) -> Frustum {
    let (length, radius) = (random.between(0.5, 2.5), random.between(0.3, 1.3));
    let shrinks = match random.below(4) {
        0 => 0.0,
        1 => 1.0,
        _ => random.unit(),
    };
    Frustum {
        base: (random.vector(3.0) + random.direction() * offset).round(),
        axis: random.direction().round(),
        length: length as f32,
        base_radius: ((1.0 - shrinks) * radius) as f32,
        slope: (shrinks * radius / length) as f32,
    }
}

/// A ray that passes the axis `miss` of the radius away, `place` of the length from the base.
fn past(random: &mut Random, frustum: Frustum, place: f64, miss: f64, distance: f64) -> Case {
    let axis = Point::new(frustum.axis);
    let direction = random.direction();
    let side = random.across(axis);
    // Perpendicular to both, so that it is tangent to a cylinder where it misses by the radius.
    let side = {
        let cross = direction.cross(axis);
        let length = cross.dot(cross).sqrt();
        if length > 1e-3 {
            cross * (1.0 / length)
        } else {
            side
        }
    };
    let along = place * f64::from(frustum.length);
    let radius = f64::from(frustum.base_radius) + f64::from(frustum.slope) * along;
    let aim = Point::new(frustum.base) + axis * along + side * (radius * miss);
    let origin = aim - direction * distance;
    (Ray::new(origin.round(), direction.unit()), frustum)
}

fn scale(name: &'static str, exponents: &[f64]) -> Sweep<Case> {
    Sweep::new(
        name,
        "log2 of the size of everything",
        exponents,
        |x, random| {
            let frustum = frustum(random, 0.0);
            let (place, miss) = (random.between(-0.1, 1.1), random.between(0.0, 1.2));
            let (ray, frustum) = past(random, frustum, place, miss, 10.0);
            let scale = x.exp2() as f32;
            let ray = Ray::new(ray.origin * scale, ray.direction);
            let frustum = Frustum {
                base: frustum.base * scale,
                length: frustum.length * scale,
                base_radius: frustum.base_radius * scale,
                ..frustum
            };
            (ray, frustum)
        },
    )
}

impl Stage for Frusta {
    const NAME: &'static str = "frustum";
    type Case = Case;

    fn sweeps() -> Vec<Sweep<Case>> {
        let small = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7];
        vec![
            Sweep::new(
                "distance",
                "distance of the origin / size",
                &[1.5, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6],
                |x, random| {
                    let frustum = frustum(random, 0.0);
                    let (place, miss) = (random.between(-0.1, 1.1), random.between(0.0, 1.2));
                    past(random, frustum, place, miss, x)
                },
            ),
            Sweep::new(
                "grazing",
                "distance from the silhouette / radius",
                &small,
                |x, random| {
                    let frustum = frustum(random, 0.0);
                    let (place, miss) = (random.unit(), 1.0 + x * random.signed());
                    past(random, frustum, place, miss, 10.0)
                },
            ),
            Sweep::new(
                "end",
                "distance from an end / length",
                &small,
                |x, random| {
                    // Aimed at the rim.
                    let frustum = frustum(random, 0.0);
                    let axis = Point::new(frustum.axis);
                    let along =
                        (random.below(2) as f64 + x * random.signed()) * f64::from(frustum.length);
                    let radius = f64::from(frustum.base_radius) + f64::from(frustum.slope) * along;
                    let rim =
                        Point::new(frustum.base) + axis * along + random.across(axis) * radius;
                    let direction = random.direction();
                    let origin = rim - direction * 10.0;
                    (Ray::new(origin.round(), direction.unit()), frustum)
                },
            ),
            Sweep::new(
                "near surface",
                "height over the surface / radius",
                &small,
                |x, random| {
                    let frustum = frustum(random, 0.0);
                    let axis = Point::new(frustum.axis);
                    let along = random.unit() * f64::from(frustum.length);
                    let radius = f64::from(frustum.base_radius) + f64::from(frustum.slope) * along;
                    let out = random.across(axis) * (radius * (1.0 + x * random.signed()));
                    let origin = Point::new(frustum.base) + axis * along + out;
                    (Ray::new(origin.round(), random.direction().unit()), frustum)
                },
            ),
            Sweep::new(
                "along the axis",
                "sine of the angle to the axis",
                &small,
                |x, random| {
                    let frustum = frustum(random, 0.0);
                    let axis = Point::new(frustum.axis);
                    let direction = axis + random.across(axis) * x;
                    let aim = random.unit() * f64::from(frustum.length);
                    let radius = frustum.base_radius + frustum.slope * frustum.length;
                    let miss = random.between(0.0, 1.1) * f64::from(radius);
                    let aim = Point::new(frustum.base) + axis * aim + random.across(axis) * miss;
                    let origin = aim - direction * 6.0;
                    (Ray::new(origin.round(), direction.unit()), frustum)
                },
            ),
            Sweep::new(
                "along the side",
                "sine of the angle to the side",
                &small,
                |x, random| {
                    let frustum = frustum(random, 0.0);
                    let axis = Point::new(frustum.axis);
                    let out = random.across(axis);
                    let side = axis + out * f64::from(frustum.slope);
                    let direction = side + random.direction() * x;
                    let place = random.unit() * f64::from(frustum.length);
                    let radius = f64::from(frustum.base_radius) + f64::from(frustum.slope) * place;
                    let shift = random.across(axis) * (x * random.signed());
                    let aim = Point::new(frustum.base) + axis * place + out * radius + shift;
                    let origin = aim - direction * 6.0;
                    (Ray::new(origin.round(), direction.unit()), frustum)
                },
            ),
            Sweep::new(
                "apex",
                "distance from the apex / length",
                &small,
                |x, random| {
                    let mut frustum = frustum(random, 0.0);
                    frustum.base_radius = 0.0;
                    let (place, miss) = (x * random.signed(), random.between(0.0, 1.2));
                    past(random, frustum, place, miss, 10.0)
                },
            ),
            Sweep::new(
                "world offset",
                "distance of the scene from 0 / size",
                &[1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6],
                |x, random| {
                    let frustum = frustum(random, x);
                    let (place, miss) = (random.between(-0.1, 1.1), random.between(0.0, 1.2));
                    past(random, frustum, place, miss, 10.0)
                },
            ),
            scale("scale", &[-40.0, -20.0, 0.0, 20.0, 40.0, 60.0]),
            // Squares of what differs by a tenth of the size are no normal numbers.
            scale("scale, extreme", &[-60.0]),
        ]
    }

    fn methods() -> Vec<&'static str> {
        METHODS.iter().map(|method| method.name).collect()
    }

    fn ask((ray, frustum): &Case, judged: &mut dyn FnMut(usize, Verdict)) {
        let exact_ray = line(ray);
        let side = exact::frustum::Side {
            base: frustum.base.to_array(),
            axis: frustum.axis.to_array(),
            length: frustum.length,
            base_radius: frustum.base_radius,
            slope: frustum.slope,
        };
        let truth = exact::frustum::truth(&exact_ray, &side);
        for (i, method) in METHODS.iter().enumerate() {
            let verdict = exact::judge(
                &truth,
                (method.run)(ray, frustum),
                |t| exact::frustum::residual(&exact_ray, &side, t),
                || exact::frustum::margins(&exact_ray, &side),
            );
            judged(i, verdict);
        }
    }
}
