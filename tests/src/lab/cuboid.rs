//! The box's sweeps.

use whitted::{Cuboid, Ray, Vec3};
use whitted_methods::cuboid::{METHODS, Setup};

use super::line;
use super::random::{Point, Random};
use super::sweep::{Stage, Sweep};
use crate::exact::{self, Verdict};

/// Ray and box.
pub struct Cuboids;

type Case = (Ray, Cuboid);

fn cuboid(random: &mut Random, offset: f64) -> Cuboid {
    let center = random.vector(3.0) + random.direction() * offset;
    let half = Point([0, 1, 2].map(|_| random.between(0.3, 1.5)));
    Cuboid {
        min: (center - half).round(),
        max: (center + half).round(),
    }
}

/// A point given by its place in the box, 0 to 1 in each component.
fn within(cuboid: &Cuboid, place: [f64; 3]) -> Point {
    let (min, max) = (Point::new(cuboid.min), Point::new(cuboid.max));
    Point([0, 1, 2].map(|i| min.0[i] + (max.0[i] - min.0[i]) * place[i]))
}

fn toward(random: &mut Random, cuboid: Cuboid, aim: Point, distance: f64) -> Case {
    let direction = random.direction();
    let origin = aim - direction * distance;
    (Ray::new(origin.round(), direction.unit()), cuboid)
}

/// A point of an edge, moved by up to `x` of the box's size.
fn near_edge(random: &mut Random, cuboid: &Cuboid, x: f64) -> Point {
    let mut place = [0, 1, 2].map(|_| random.below(2) as f64);
    place[random.below(3)] = random.unit();
    within(cuboid, place) + random.vector(x)
}

impl Stage for Cuboids {
    const NAME: &'static str = "cuboid";
    type Case = Case;

    fn sweeps() -> Vec<Sweep<Case>> {
        let large = [1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6];
        let small = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7];
        vec![
            Sweep::new(
                "distance",
                "distance of the origin / size",
                &large,
                |x, random| {
                    let cuboid = cuboid(random, 0.0);
                    let place = [0, 1, 2].map(|_| random.between(-0.3, 1.3));
                    toward(random, cuboid, within(&cuboid, place), 3.0 * x)
                },
            ),
            Sweep::new(
                "edge",
                "distance from an edge / size",
                &small,
                |x, random| {
                    let cuboid = cuboid(random, 0.0);
                    let aim = near_edge(random, &cuboid, x);
                    toward(random, cuboid, aim, 10.0)
                },
            ),
            Sweep::new(
                "near surface",
                "distance of the origin from a face / size",
                &small,
                {
                    |x, random| {
                        let cuboid = cuboid(random, 0.0);
                        let mut place = [0, 1, 2].map(|_| random.unit());
                        place[random.below(3)] = random.below(2) as f64 + x * random.signed();
                        let origin = within(&cuboid, place).round();
                        (Ray::new(origin, random.direction().unit()), cuboid)
                    }
                },
            ),
            // Whole numbers, so that faces, edges and origins are met exactly.
            Sweep::new(
                "lattice",
                "direction components that are zero",
                &[0.0, 1.0, 2.0],
                {
                    |x, random| {
                        let whole = |random: &mut Random| (random.below(9) as f32) - 4.0;
                        let corner = Vec3::from([0; 3].map(|_| whole(random)));
                        let size = Vec3::from([0; 3].map(|_| random.below(4) as f32));
                        let cuboid = Cuboid {
                            min: corner,
                            max: corner + size,
                        };
                        let origin = Vec3::from([0; 3].map(|_| whole(random)));
                        loop {
                            let zeros = [0; 3].map(|_| random.below(3));
                            let d: [f32; 3] = [0, 1, 2].map(|i| {
                                let sign = [-1.0, 1.0][random.below(2)];
                                if zeros[i] == 0 {
                                    0.0 * sign
                                } else {
                                    zeros[i] as f32 * sign
                                }
                            });
                            if d.iter().filter(|&&d| d == 0.0).count() == x as usize {
                                // Not of unit length: so it stays whole.
                                return (Ray::new(origin, d.into()), cuboid);
                            }
                        }
                    }
                },
            ),
            Sweep::new(
                "along a face",
                "distance of the origin / size",
                &large,
                |x, random| {
                    // A direction without one component, from a slab's plane or a step beside it.
                    let cuboid = cuboid(random, 0.0);
                    let place = [0, 1, 2].map(|_| random.between(-0.3, 1.3));
                    let (axis, high) = (random.below(3), random.below(2) == 1);
                    let mut direction = random.direction();
                    direction.0[axis] = 0.0;
                    let mut origin = (within(&cuboid, place) - direction * (3.0 * x)).round();
                    let plane = if high {
                        cuboid.max[axis]
                    } else {
                        cuboid.min[axis]
                    };
                    origin[axis] = match random.below(3) {
                        0 => plane.next_down(),
                        1 => plane,
                        _ => plane.next_up(),
                    };
                    let mut direction = direction.unit();
                    direction[axis] = [-0.0, 0.0][random.below(2)];
                    (Ray::new(origin, direction), cuboid)
                },
            ),
            Sweep::new(
                "thin",
                "thickness / size",
                &[1.0, 1e-2, 1e-4, 1e-6, 0.0],
                |x, random| {
                    let mut cuboid = cuboid(random, 0.0);
                    let axis = random.below(3);
                    cuboid.max[axis] = cuboid.min[axis] + x as f32;
                    let place = [0, 1, 2].map(|_| random.between(-0.3, 1.3));
                    let aim = within(&cuboid, place);
                    toward(random, cuboid, aim, 10.0)
                },
            ),
            Sweep::new("inside", "size of the box", &large, |x, random| {
                let half = Point([0, 1, 2].map(|_| x * random.between(0.3, 1.0)));
                let center = random.vector(1.0);
                let cuboid = Cuboid {
                    min: (center - half).round(),
                    max: (center + half).round(),
                };
                let place = [0, 1, 2].map(|_| random.unit());
                let origin = within(&cuboid, place).round();
                (Ray::new(origin, random.direction().unit()), cuboid)
            }),
            Sweep::new(
                "world offset",
                "distance of the scene from 0 / size",
                &large,
                |x, random| {
                    let cuboid = cuboid(random, x);
                    let place = [0, 1, 2].map(|_| random.between(-0.3, 1.3));
                    toward(random, cuboid, within(&cuboid, place), 10.0)
                },
            ),
            Sweep::new(
                "scale",
                "log2 of the size of everything",
                &[-60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0],
                |x, random| {
                    let cuboid = cuboid(random, 0.0);
                    let aim = near_edge(random, &cuboid, 1.0);
                    let (ray, cuboid) = toward(random, cuboid, aim, 10.0);
                    let scale = x.exp2() as f32;
                    let Cuboid { min, max } = cuboid;
                    let ray = Ray::new(ray.origin * scale, ray.direction);
                    (
                        ray,
                        Cuboid {
                            min: min * scale,
                            max: max * scale,
                        },
                    )
                },
            ),
        ]
    }

    fn methods() -> Vec<&'static str> {
        METHODS.iter().map(|method| method.name).collect()
    }

    fn ask((ray, cuboid): &Case, judged: &mut dyn FnMut(usize, Verdict)) {
        let exact_ray = line(ray);
        let (min, max) = (cuboid.min.to_array(), cuboid.max.to_array());
        let truth = exact::cuboid::truth(&exact_ray, min, max);
        let setup = Setup::new(ray);
        for (i, method) in METHODS.iter().enumerate() {
            let verdict = exact::judge(
                &truth,
                (method.run)(ray, &setup, cuboid),
                |t| exact::cuboid::residual(&exact_ray, min, max, t),
                || exact::cuboid::margins(&exact_ray, min, max),
            );
            judged(i, verdict);
        }
    }
}
