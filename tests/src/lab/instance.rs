//! The sweeps of spheres that are placed.

use whitted::{Ray, Sphere, Vec3};
use whitted_methods::instance::{METHODS, Placed};

use super::line;
use super::random::{Point, Random};
use super::sweep::{Stage, Sweep};
use crate::exact::{self, Verdict, placed};

/// Ray and sphere that an affine map places.
pub struct Instances;

type Case = (Ray, Placed);

/// Three directions that are not nearly in a plane.
fn frame(random: &mut Random) -> [Point; 3] {
    loop {
        let axes = [(); 3].map(|()| random.direction());
        if axes[0].dot(axes[1].cross(axes[2])).abs() > 0.3 {
            return axes;
        }
    }
}

/// Axes at right angles.
fn square(random: &mut Random) -> [Point; 3] {
    let a = random.direction();
    let b = random.across(a);
    [a, b, a.cross(b)]
}

/// A sphere of about unit size, placed by axes that can be undone, `offset` from zero.
fn placed(
    random: &mut Random,
    offset: f64,
    mut axes: impl FnMut(&mut Random) -> [Point; 3],
) -> Placed {
    loop {
        let translation = random.vector(3.0) + random.direction() * offset;
        let sphere = Sphere {
            center: random.vector(1.0).round(),
            radius: random.between(0.5, 1.5) as f32,
        };
        let axes = axes(random).map(Point::round);
        if let Some(placed) = Placed::new(axes, translation.round(), sphere) {
            return placed;
        }
    }
}

fn any(random: &mut Random, offset: f64) -> Placed {
    placed(random, offset, |random| {
        frame(random).map(|it| it * random.between(0.5, 2.0))
    })
}

/// Where a point of the sphere's space lies.
fn carried(placed: &Placed, v: Point) -> Point {
    let [a, b, c] = placed.axes.map(Point::new);
    a * v.0[0] + b * v.0[1] + c * v.0[2]
}

fn center(placed: &Placed) -> Point {
    let center = Point::new(placed.object[0].shape.center);
    Point::new(placed.placement.translation) + carried(placed, center)
}

fn through(aim: Point, direction: Point, distance: f64, placed: Placed) -> Case {
    let direction = direction * (1.0 / direction.dot(direction).sqrt());
    let origin = aim - direction * distance;
    (Ray::new(origin.round(), direction.unit()), placed)
}

/// To a point at `height` over the surface, over the radius, `slant` of the way from tangent to
/// perpendicular in the sphere's space.
fn to_surface(random: &mut Random, placed: Placed, distance: f64, slant: f64, height: f64) -> Case {
    let normal = random.direction();
    let radius = f64::from(placed.object[0].shape.radius);
    let aim = center(&placed) + carried(&placed, normal * (radius * (1.0 + height)));
    let direction = random.across(normal) - normal * slant;
    through(aim, carried(&placed, direction), distance, placed)
}

/// A ray somewhere by.
fn past(random: &mut Random, placed: Placed, distance: f64) -> Case {
    let aim = center(&placed) + carried(&placed, random.vector(1.2));
    through(aim, random.direction(), distance, placed)
}

impl Stage for Instances {
    const NAME: &'static str = "instance";
    type Case = Case;

    fn sweeps() -> Vec<Sweep<Case>> {
        let small = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7];
        let flat = [1.0, 1e-1, 1e-2, 1e-3, 1e-4];
        vec![
            Sweep::new(
                "distance",
                "distance of the origin / size",
                &[3.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6],
                |x, random| {
                    let placed = any(random, 0.0);
                    past(random, placed, x)
                },
            ),
            Sweep::new(
                "grazing",
                "height over the surface / radius",
                &small,
                |x, random| {
                    let (placed, height) = (any(random, 0.0), x * random.signed());
                    to_surface(random, placed, 10.0, 0.0, height)
                },
            ),
            Sweep::new(
                "near surface",
                "height over the surface / radius",
                &small,
                |x, random| {
                    let placed = any(random, 0.0);
                    let (height, slant) = (x * random.signed(), random.signed());
                    to_surface(random, placed, 0.0, slant, height)
                },
            ),
            Sweep::new(
                "stretched",
                "least factor of three at right angles / greatest",
                &flat,
                |x, random| {
                    let placed = placed(random, 0.0, |random| {
                        let factors = [1.0, x, x.powf(random.unit())];
                        let frame = square(random);
                        // Turned before, too.
                        let [p, q, r] = square(random);
                        [0, 1, 2].map(|i| {
                            let part = |axis: Point, j: usize| frame[j] * (axis.0[i] * factors[j]);
                            part(p, 0) + part(q, 1) + part(r, 2)
                        })
                    });
                    let (slant, height) = (random.unit(), 0.5 * random.signed());
                    to_surface(random, placed, 10.0, slant, height)
                },
            ),
            Sweep::new(
                "sheared",
                "sine of the angle of an axis to the plane of the others",
                &flat,
                |x, random| {
                    let placed = placed(random, 0.0, |random| {
                        let [a, b, up] = square(random);
                        [a, b, a * random.signed() + b * random.signed() + up * x]
                    });
                    let (slant, height) = (random.unit(), 0.5 * random.signed());
                    to_surface(random, placed, 10.0, slant, height)
                },
            ),
            Sweep::new(
                "world offset",
                "distance of the scene from 0 / size",
                &[1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6],
                |x, random| {
                    let placed = any(random, x);
                    past(random, placed, 10.0)
                },
            ),
            Sweep::new(
                "scale",
                "log2 of the size of everything",
                &[-40.0, -20.0, 0.0, 20.0, 40.0],
                |x, random| {
                    let placed = any(random, 0.0);
                    let (ray, placed) = past(random, placed, 10.0);
                    let scale = x.exp2() as f32;
                    let grown = Placed::new(
                        placed.axes.map(|it| it * scale),
                        placed.placement.translation * scale,
                        placed.object[0].shape,
                    );
                    let ray = Ray::new(ray.origin * scale, ray.direction);
                    (ray, grown.expect("a size in range"))
                },
            ),
        ]
    }

    fn methods() -> Vec<&'static str> {
        METHODS.iter().map(|method| method.name).collect()
    }

    fn ask((ray, it): &Case, judged: &mut dyn FnMut(usize, Verdict)) {
        let exact_ray = line(ray);
        let placement = placed::Placement {
            axes: it.axes.map(|axis: Vec3| axis.to_array()),
            translation: it.placement.translation.to_array(),
        };
        let Sphere { center, radius } = it.object[0].shape;
        let center = center.to_array();
        let truth = placed::truth(&exact_ray, &placement, center, radius);
        for (i, method) in METHODS.iter().enumerate() {
            let verdict = exact::judge(
                &truth,
                (method.run)(ray, it),
                |t| placed::residual(&exact_ray, &placement, center, radius, t),
                || placed::margins(&exact_ray, &placement, center, radius),
            );
            judged(i, verdict);
        }
    }
}
