//! The quadric's sweeps.

use whitted::{Clip, Ends, Quadric, Ray, Vec3};
use whitted_methods::quadric::METHODS;

use super::line;
use super::random::{Point, Random};
use super::sweep::{Stage, Sweep};
use crate::exact::{self, Verdict};

/// Ray and open quadric.
pub struct Quadrics;

type Case = (Ray, Quadric);

/// A quadric as the oracle takes it.
pub fn exact_quadric(quadric: &Quadric) -> exact::quadric::Quadric {
    let clip = &quadric.clip;
    let (min, max) = (clip.min.to_array(), clip.max.to_array());
    let mut planes = [None; 8];
    for i in 0..3 {
        let mut axis = [0.0; 3];
        axis[i] = 1.0;
        planes[2 * i] = Some((axis, max[i]));
        planes[2 * i + 1] = Some((axis.map(|x| -x), -min[i]));
    }
    planes[6] = Some((clip.axis.to_array(), clip.to));
    planes[7] = Some(((-clip.axis).to_array(), -clip.from));
    exact::quadric::Quadric {
        center: quadric.center.to_array(),
        squares: quadric.squares.to_array(),
        products: quadric.products.to_array(),
        linear: quadric.linear.to_array(),
        constant: quadric.constant,
        planes: planes.map(|plane| plane.filter(|(_, distance)| distance.is_finite())),
        closed: quadric.ends == Ends::Closed,
    }
}

/// Any kind of quadric, of a size of about 1, `offset` from zero.
pub fn quadric(random: &mut Random, offset: f64, ends: Ends) -> Quadric {
    loop {
        let center = random.vector(3.0) + random.direction() * offset;
        let half = random.direction() * random.between(0.3, 1.5);
        let (base, apex) = ((center - half).round(), (center + half).round());
        let (radius, share) = (random.between(0.3, 1.3) as f32, random.between(0.1, 0.9));
        let length = (apex - base).length();
        let quadric = match random.below(8) {
            0 => Quadric::ellipsoid(center.round(), Vec3::new(radius, share as f32, length)),
            1 => Quadric::cylinder(base, apex, radius, ends),
            2 => Quadric::cone(base, radius, apex, 0.0, ends),
            3 => Quadric::cone(base, radius, apex, radius * share as f32, ends),
            4 => Quadric::paraboloid(base, apex, radius, ends),
            5 => Quadric::hyperboloid(base, apex, radius, radius * share as f32, ends),
            6 => Quadric::two_sheets(base, apex, radius, length * share as f32, ends),
            _ => {
                let clip = Clip {
                    min: random.vector(0.5).round() - Vec3::ONE,
                    max: random.vector(0.5).round() + Vec3::ONE,
                    ..Clip::NONE
                };
                Quadric::new(
                    center.round(),
                    random.vector(1.0).round(),
                    random.vector(2.0).round(),
                    random.vector(1.0).round(),
                    random.signed() as f32,
                    clip,
                    ends,
                )
            }
        };
        // A random direction may be shorter than a rounding of its ends.
        if let Ok(quadric) = quadric {
            return quadric;
        }
    }
}

fn value(quadric: &Quadric, q: Point) -> (f64, Point) {
    let ([xx, yy, zz], [yz, zx, xy]) = (
        Point::new(quadric.squares).0,
        Point::new(quadric.products).0,
    );
    let linear = Point::new(quadric.linear);
    let times = Point([
        Point([xx, xy, zx]).dot(q),
        Point([xy, yy, yz]).dot(q),
        Point([zx, yz, zz]).dot(q),
    ]);
    let value = times.dot(q) + 2.0 * linear.dot(q) + f64::from(quadric.constant);
    (value, times + linear)
}

/// A point near the clipped surface, from the center; and half the gradient there.
pub fn point_on(random: &mut Random, quadric: &Quadric) -> (Point, Point) {
    loop {
        let clip = &quadric.clip;
        let corner = |v: Vec3| Point::new(v.clamp(Vec3::splat(-3.0), Vec3::splat(3.0)));
        let (min, max) = (corner(clip.min), corner(clip.max));
        let mut q = Point([0, 1, 2].map(|i| random.between(min.0[i], max.0[i])));
        for _ in 0..8 {
            let (value, half_gradient) = value(quadric, q);
            let square = half_gradient.dot(half_gradient);
            if square > 0.0 {
                q = q - half_gradient * (0.5 * value / square);
            }
        }
        let along = Point::new(clip.axis).dot(q);
        let (value, half_gradient) = value(quadric, q);
        let is_inside = (0..3).all(|i| q.0[i] >= min.0[i] && q.0[i] <= max.0[i])
            && along >= f64::from(clip.from)
            && along <= f64::from(clip.to);
        if is_inside && value.abs() < 1e-9 && half_gradient.dot(half_gradient) > 1e-12 {
            return (q, half_gradient);
        }
        // Clips that hold none of the surface are drawn, too.
        if random.below(64) == 0 {
            return (q, half_gradient);
        }
    }
}

/// A ray to a point near the surface, `slant` of the way from tangent to perpendicular, which passes
/// `height` over the surface.
fn to_surface(
    random: &mut Random,
    quadric: Quadric,
    distance: f64,
    slant: f64,
    height: f64,
) -> Case {
    let (q, gradient) = point_on(random, &quadric);
    let normal = gradient * (1.0 / gradient.dot(gradient).sqrt());
    let tangent = random.across(if normal.dot(normal) > 0.5 {
        normal
    } else {
        Point([0.0, 1.0, 0.0])
    });
    let direction = tangent - normal * slant;
    let direction = direction * (1.0 / direction.dot(direction).sqrt());
    let aim = Point::new(quadric.center) + q + normal * height;
    let origin = aim - direction * distance;
    (Ray::new(origin.round(), direction.unit()), quadric)
}

/// A ray somewhere by.
fn past(random: &mut Random, quadric: Quadric, distance: f64) -> Case {
    let direction = random.direction();
    let aim = Point::new(quadric.center) + random.vector(1.0);
    (
        Ray::new((aim - direction * distance).round(), direction.unit()),
        quadric,
    )
}

fn scale(name: &'static str, exponents: &[f64]) -> Sweep<Case> {
    Sweep::new(
        name,
        "log2 of the size of everything",
        exponents,
        |x, random| {
            let quadric = quadric(random, 0.0, Ends::Open);
            let (ray, quadric) = past(random, quadric, 10.0);
            let scale = x.exp2() as f32;
            let clip = Clip {
                min: quadric.clip.min * scale,
                max: quadric.clip.max * scale,
                axis: quadric.clip.axis,
                from: quadric.clip.from * scale,
                to: quadric.clip.to * scale,
            };
            let quadric = Quadric {
                center: quadric.center * scale,
                linear: quadric.linear * scale,
                constant: quadric.constant * scale * scale,
                clip,
                ..quadric
            };
            (Ray::new(ray.origin * scale, ray.direction), quadric)
        },
    )
}

impl Stage for Quadrics {
    const NAME: &'static str = "quadric";
    type Case = Case;

    fn sweeps() -> Vec<Sweep<Case>> {
        let small = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7];
        vec![
            Sweep::new(
                "distance",
                "distance of the origin / size",
                &[1.5, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6],
                |x, random| {
                    let quadric = quadric(random, 0.0, Ends::Open);
                    past(random, quadric, x)
                },
            ),
            Sweep::new(
                "grazing",
                "height over the surface / size",
                &small,
                |x, random| {
                    let quadric = quadric(random, 0.0, Ends::Open);
                    let height = x * random.signed();
                    to_surface(random, quadric, 10.0, 0.0, height)
                },
            ),
            Sweep::new(
                "near surface",
                "height over the surface / size",
                &small,
                |x, random| {
                    let quadric = quadric(random, 0.0, Ends::Open);
                    let (height, slant) = (x * random.signed(), random.signed());
                    to_surface(random, quadric, 0.0, slant, height)
                },
            ),
            Sweep::new(
                "asymptote",
                "sine of the angle to a direction without a square",
                &small,
                |x, random| {
                    let quadric = quadric(random, 0.0, Ends::Open);
                    // Of two directions with opposite signs of a, one between them has none.
                    let a = |d: Point| {
                        let (value, _) = value(
                            &Quadric {
                                linear: Vec3::ZERO,
                                constant: 0.0,
                                ..quadric
                            },
                            d,
                        );
                        value
                    };
                    let (mut p, mut n) = (random.direction(), random.direction());
                    for _ in 0..20 {
                        let more = random.direction();
                        if a(more) > a(p) {
                            p = more;
                        }
                        if a(more) < a(n) {
                            n = more;
                        }
                    }
                    if a(p) > 0.0 && a(n) < 0.0 {
                        for _ in 0..60 {
                            let middle = (p + n) * 0.5;
                            if a(middle) > 0.0 {
                                p = middle;
                            } else {
                                n = middle;
                            }
                        }
                    }
                    let direction = n * (1.0 / n.dot(n).sqrt()) + random.direction() * x;
                    let (q, _) = point_on(random, &quadric);
                    let aim = Point::new(quadric.center) + q + random.vector(0.1);
                    let origin = aim - direction * 6.0;
                    (Ray::new(origin.round(), direction.unit()), quadric)
                },
            ),
            Sweep::new(
                "clip",
                "distance from where it is cut / size",
                &small,
                |x, random| {
                    let quadric = quadric(random, 0.0, Ends::Open);
                    let (q, _) = point_on(random, &quadric);
                    // The nearest plane across the axis, or else of the box, moves to the point.
                    let axis = Point::new(quadric.clip.axis);
                    let place = axis.dot(q) + x * random.signed();
                    let clip = if axis.dot(axis) > 0.0 {
                        Clip {
                            to: place as f32,
                            ..quadric.clip
                        }
                    } else {
                        let height = (q.0[1] + x * random.signed()) as f32;
                        Clip {
                            max: quadric.clip.max.with_y(height),
                            ..quadric.clip
                        }
                    };
                    let direction = random.direction();
                    let origin = Point::new(quadric.center) + q - direction * 10.0;
                    (
                        Ray::new(origin.round(), direction.unit()),
                        Quadric { clip, ..quadric },
                    )
                },
            ),
            Sweep::new(
                "flat",
                "least radius of an ellipsoid / greatest",
                &[1.0, 1e-1, 1e-2, 1e-3, 1e-4],
                |x, random| {
                    let mut radii = [1.0, x, (x * random.between(0.0, 1.0).exp()).min(1.0)];
                    radii.rotate_left(random.below(3));
                    let center = random.vector(3.0).round();
                    let quadric = Quadric::ellipsoid(center, Point(radii).round()).expect("radii");
                    let (slant, height) = (random.unit(), 0.0);
                    to_surface(random, quadric, 10.0, slant, height)
                },
            ),
            Sweep::new(
                "world offset",
                "distance of the scene from 0 / size",
                &[1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6],
                |x, random| {
                    let quadric = quadric(random, x, Ends::Open);
                    past(random, quadric, 10.0)
                },
            ),
            scale("scale", &[-40.0, -20.0, 0.0, 20.0, 40.0]),
        ]
    }

    fn methods() -> Vec<&'static str> {
        METHODS.iter().map(|method| method.name).collect()
    }

    fn ask((ray, quadric): &Case, judged: &mut dyn FnMut(usize, Verdict)) {
        let exact_ray = line(ray);
        let exact_quadric = exact_quadric(quadric);
        let truth = exact::quadric::truth(&exact_ray, &exact_quadric);
        for (i, method) in METHODS.iter().enumerate() {
            let verdict = exact::judge(
                &truth,
                (method.run)(ray, quadric),
                |t| exact::quadric::residual(&exact_ray, &exact_quadric, t),
                || exact::quadric::margins(&exact_ray, &exact_quadric),
            );
            judged(i, verdict);
        }
    }
}

#[cfg(test)]
mod tests {
    use whitted::{Exact, Shape};

    use super::*;
    use crate::lab::random::Stream;

    /// Of solids, of which the methods above know only the open part.
    #[test]
    fn closed_quadrics_are_met_where_they_are() {
        let (mut hits, mut worst, mut band) = (0, 0.0_f64, 0.0_f64);
        for (cell, size) in (0..).zip([1.0, 1e-2, 1e-4, 1e-6]) {
            let mut random = Random::new(Stream {
                seed: 4,
                purpose: Stream::purpose(["quadric", "closed"]),
                cell,
                chunk: 0,
            });
            for i in 0..20_000 {
                let solid = quadric(&mut random, 0.0, Ends::Closed);
                let (ray, solid) = match i % 3 {
                    0 => past(&mut random, solid, 10.0),
                    1 => {
                        let (slant, height) = (random.signed(), size * random.signed());
                        to_surface(&mut random, solid, 0.0, slant, height)
                    }
                    _ => {
                        let (slant, height) = (random.signed() * size, size * random.signed());
                        to_surface(&mut random, solid, 10.0, slant, height)
                    }
                };
                let (exact_ray, exact_solid) = (line(&ray), exact_quadric(&solid));
                let truth = exact::quadric::truth(&exact_ray, &exact_solid);
                let setup = Quadric::setup(&ray);
                let met = solid.intersect::<Exact>(&ray, &setup, None);
                let normal = met.map(|t| solid.normal::<Exact>(&ray, t));
                assert!(normal.is_none_or(|it| (it.length() - 1.0).abs() < 1e-6));
                // Solids without a clip reach to infinity.
                let is_bounded = solid.clip.max.is_finite();
                let residual =
                    |t: f32| exact::quadric::residual(&exact_ray, &exact_solid, t.into());
                if let Some(t) = met {
                    hits += 1;
                    worst = worst.max(residual(t));
                }
                let near = truth.t.zip(met).is_some_and(|(truth, met)| {
                    // On the same part of the surface: what lies between is on it, too.
                    (truth - f64::from(met)).abs() < 1e-3
                        || residual((0.5 * (truth + f64::from(met))) as f32) < 2.0
                });
                let is_right = truth.either || truth.t.is_none() && met.is_none() || near;
                if !is_right {
                    let margin = exact::quadric::least_margin(&exact_ray, &exact_solid);
                    band = band.max(margin);
                    assert!(
                        margin < 1.5,
                        "{margin} u: {truth:?} {met:?} {ray:?} {solid:?}"
                    );
                }
                let crossings = solid.crossings::<Exact>(&ray, &setup, None);
                let is_outside = residual(0.0) > 4.0 && {
                    let back = Ray::new(ray.origin, -ray.direction);
                    let behind = solid.crossings::<Exact>(&back, &Quadric::setup(&back), None);
                    behind % 2 == 0
                };
                assert!(
                    !(is_bounded && is_outside) || crossings % 2 == 0,
                    "{ray:?} {solid:?}"
                );
            }
        }
        assert!(hits > 20_000, "{hits}");
        // As with planes: of a face the distance is a quotient of two sums of three products.
        assert!(worst < 2.5, "{worst} u");
        eprintln!("{hits} hits, {worst} u, wrong within {band} u");
    }
}
