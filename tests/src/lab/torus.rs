//! The torus' sweeps.

use whitted::{Ray, Torus};
use whitted_methods::torus::METHODS;

use super::line;
use super::random::{Point, Random};
use super::sweep::{Stage, Sweep};
use crate::exact::{self, Verdict};
use crate::reference::torus_roots;

/// Ray and torus.
pub struct Tori;

type Case = (Ray, Torus);

/// A torus of this ratio of its radii.
fn torus(random: &mut Random, offset: f64, ratio: f64) -> Torus {
    let major = random.between(0.5, 1.5);
    Torus {
        center: (random.vector(3.0) + random.direction() * offset).round(),
        axis: random.direction().unit(),
        major: major as f32,
        minor: (major * ratio) as f32,
    }
}

fn ratio(random: &mut Random) -> f64 {
    random.between(0.05, 0.95)
}

/// To a point at `height` over the surface, as a share of the minor radius, `slant` of the way from tangent
/// to perpendicular.
fn to_surface(random: &mut Random, torus: Torus, distance: f64, slant: f64, height: f64) -> Case {
    let axis = Point::new(torus.axis);
    let outward = random.across(axis);
    let around = axis.cross(outward);
    let (sin, cos) = random.between(0.0, std::f64::consts::TAU).sin_cos();
    let normal = outward * cos + axis * sin;
    let (major, minor) = (f64::from(torus.major), f64::from(torus.minor));
    let aim = Point::new(torus.center) + outward * major + normal * (minor * (1.0 + height));
    // Tangents along the tube and round it, and all between.
    let tangent = around * random.signed() + random.across(normal);
    let direction = tangent * (1.0 / tangent.dot(tangent).sqrt()) - normal * slant;
    let direction = direction * (1.0 / direction.dot(direction).sqrt());
    let origin = aim - direction * distance;
    (Ray::new(origin.round(), direction.unit()), torus)
}

/// A ray somewhere by.
fn past(random: &mut Random, torus: Torus, distance: f64) -> Case {
    let direction = random.direction();
    let aim = Point::new(torus.center) + random.vector(f64::from(torus.major));
    let origin = aim - direction * distance;
    (Ray::new(origin.round(), direction.unit()), torus)
}

impl Stage for Tori {
    const NAME: &'static str = "torus";
    type Case = Case;

    fn sweeps() -> Vec<Sweep<Case>> {
        let small = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7];
        vec![
            Sweep::new(
                "distance",
                "distance of the origin / size",
                &[1.5, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6],
                |x, random| {
                    let ratio = ratio(random);
                    let torus = torus(random, 0.0, ratio);
                    past(random, torus, x)
                },
            ),
            Sweep::new(
                "grazing",
                "height over the surface / minor radius",
                &small,
                |x, random| {
                    let ratio = ratio(random);
                    let torus = torus(random, 0.0, ratio);
                    let height = x * random.signed();
                    to_surface(random, torus, 10.0, 0.0, height)
                },
            ),
            Sweep::new(
                "near surface",
                "height over the surface / minor radius",
                &small,
                |x, random| {
                    let ratio = ratio(random);
                    let torus = torus(random, 0.0, ratio);
                    let (height, slant) = (x * random.signed(), random.signed());
                    to_surface(random, torus, 0.0, slant, height)
                },
            ),
            Sweep::new(
                "thin",
                "minor radius / major radius",
                &[0.9, 0.3, 0.1, 1e-2, 1e-3, 1e-4],
                |x, random| {
                    let torus = torus(random, 0.0, x);
                    let (height, slant) = (0.5 * random.signed(), random.unit());
                    to_surface(random, torus, 10.0, slant, height)
                },
            ),
            Sweep::new(
                "through the axis",
                "distance from the center / size",
                &small,
                |x, random| {
                    let ratio = ratio(random);
                    let torus = torus(random, 0.0, ratio);
                    let direction = random.direction();
                    let aim = Point::new(torus.center) + random.vector(x);
                    let origin = aim - direction * 5.0;
                    (Ray::new(origin.round(), direction.unit()), torus)
                },
            ),
            Sweep::new(
                "along the axis",
                "sine of the angle to the axis",
                &small,
                |x, random| {
                    let ratio = ratio(random);
                    let torus = torus(random, 0.0, ratio);
                    let axis = Point::new(torus.axis);
                    let direction = axis + random.direction() * x;
                    let across =
                        random.across(axis) * (f64::from(torus.major) * random.between(0.0, 2.0));
                    let origin = Point::new(torus.center) + across - direction * 5.0;
                    (Ray::new(origin.round(), direction.unit()), torus)
                },
            ),
            Sweep::new(
                "world offset",
                "distance of the scene from 0 / size",
                &[1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6],
                |x, random| {
                    let ratio = ratio(random);
                    let torus = torus(random, x, ratio);
                    past(random, torus, 10.0)
                },
            ),
            Sweep::new(
                "scale",
                "log2 of the size of everything",
                &[-40.0, -20.0, 0.0, 20.0, 40.0],
                |x, random| {
                    let ratio = ratio(random);
                    let torus = torus(random, 0.0, ratio);
                    let (ray, torus) = past(random, torus, 10.0);
                    let scale = x.exp2() as f32;
                    let torus = Torus {
                        center: torus.center * scale,
                        major: torus.major * scale,
                        minor: torus.minor * scale,
                        ..torus
                    };
                    (Ray::new(ray.origin * scale, ray.direction), torus)
                },
            ),
        ]
    }

    fn methods() -> Vec<&'static str> {
        METHODS.iter().map(|method| method.name).collect()
    }

    fn ask((ray, torus): &Case, judged: &mut dyn FnMut(usize, Verdict)) {
        let exact_ray = line(ray);
        let exact_torus = exact::torus::Torus {
            center: torus.center.to_array(),
            axis: torus.axis.to_array(),
            major: torus.major,
            minor: torus.minor,
        };
        let roots = torus_roots(
            ray.origin.as_dvec3() - torus.center.as_dvec3(),
            ray.direction.as_dvec3(),
            torus.axis.as_dvec3(),
            torus.major.into(),
            torus.minor.into(),
        );
        let mut ahead: Vec<f64> = roots.into_iter().filter(|&t| t > 0.0).collect();
        ahead.sort_by(f64::total_cmp);
        let (mut count, mut margin) = (None, None);
        let mut band =
            || *margin.get_or_insert_with(|| exact::torus::least_margin(&exact_ray, &exact_torus));
        for (i, method) in METHODS.iter().enumerate() {
            let answer = (method.run)(ray, torus).map(f64::from);
            let mut verdict = Verdict {
                backward: 0.0,
                forward: 0.0,
                wrong: None,
            };
            if let Some(t) = answer {
                verdict.backward = exact::torus::residual(&exact_ray, &exact_torus, t);
                let first = ahead.first().copied();
                verdict.forward = first.map_or(0.0, |it| (t - it).abs() / (it * exact::U));
                // Another root than the first: right only if that one may be none.
                let nearer = |it: &f64| (it - t).abs() < 0.5 * (ahead[0] - t).abs();
                if ahead.iter().skip(1).any(nearer) {
                    verdict.wrong = Some(band());
                }
            }
            if answer.is_some() == ahead.is_empty() {
                // Of what `f64` says only what is exact counts.
                let count =
                    *count.get_or_insert_with(|| exact::torus::count(&exact_ray, &exact_torus));
                if answer.is_some() != (count > 0) {
                    verdict.wrong = Some(band());
                }
            }
            judged(i, verdict);
        }
    }
}
