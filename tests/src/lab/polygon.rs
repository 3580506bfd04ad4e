//! The polygon's sweeps.

use whitted::{Polygon, Ray, Triangle, Vec3};
use whitted_methods::polygon::{METHODS, Setup, ignores_normal};
use whitted_methods::triangle;

use super::line;
use super::random::{Point, Random};
use super::sweep::{Stage, Sweep};
use crate::exact::polygon::Facing;
use crate::exact::{self, Verdict};

/// Ray and polygon.
pub struct Polygons;

/// Ray and triangle.
pub struct Triangles;

/// A ray and an outline.
pub struct Case {
    ray: Ray,
    vertices: Vec<Vec3>,
    normal: Vec3,
}

/// A plane to draw on.
struct Canvas {
    center: Point,
    x: Point,
    y: Point,
}

impl Canvas {
    fn new(random: &mut Random, offset: f64) -> Self {
        let normal = random.direction();
        let x = random.across(normal);
        Self {
            center: random.vector(2.0) + random.direction() * offset,
            x,
            y: normal.cross(x),
        }
    }

    fn at(&self, x: f64, y: f64) -> Point {
        self.center + self.x * x + self.y * y
    }

    /// Corners of radii 0.6 to 1 at even angles: with any radii from 0.9 on they are convex.
    fn outline(&self, random: &mut Random, corners: usize, least: f64) -> Vec<Vec3> {
        (0..corners)
            .map(|i| {
                let (sin, cos) = (std::f64::consts::TAU * i as f64 / corners as f64).sin_cos();
                let radius = random.between(least, 1.0);
                self.at(radius * cos, radius * sin).round()
            })
            .collect()
    }

    /// An outline seen from a distance, at a point given on the canvas, never at a flat angle.
    fn seen(&self, random: &mut Random, vertices: Vec<Vec3>, aim: Point, distance: f64) -> Case {
        let across = self.x.cross(self.y);
        let direction = loop {
            let direction = random.direction();
            if direction.dot(across).abs() > 0.1 {
                break direction;
            }
        };
        let origin = aim - direction * distance;
        Case {
            ray: Ray::new(origin.round(), direction.unit()),
            normal: newell(&vertices),
            vertices,
        }
    }
}

/// The outline's unit normal, rounded once.
fn newell(vertices: &[Vec3]) -> Vec3 {
    let point = |i: usize| Point::new(vertices[i % vertices.len()]);
    let sum = (0..vertices.len()).fold(Point([0.0; 3]), |sum, i| {
        sum + (point(i) - point(0)).cross(point(i + 1) - point(0))
    });
    (sum * (1.0 / sum.dot(sum).sqrt())).round()
}

/// A point on the edge between two vertices, moved by up to `x`.
fn near_edge(random: &mut Random, vertices: &[Vec3], x: f64) -> Point {
    let i = random.below(vertices.len());
    let (a, b) = (
        Point::new(vertices[i]),
        Point::new(vertices[(i + 1) % vertices.len()]),
    );
    a + (b - a) * random.unit() + random.vector(x)
}

fn distance(name: &'static str, corners: usize) -> Sweep<Case> {
    Sweep::new(
        name,
        "distance of the origin / size",
        &LARGE,
        move |x, random| {
            let canvas = Canvas::new(random, 0.0);
            let vertices = canvas.outline(random, corners, 0.95);
            let aim = canvas.at(random.between(-1.2, 1.2), random.between(-1.2, 1.2));
            canvas.seen(random, vertices, aim, 2.0 * x)
        },
    )
}

const SMALL: [f64; 7] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7];
const LARGE: [f64; 7] = [1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6];

/// Aimed near an edge of a convex outline.
fn edge(name: &'static str, corners: usize) -> Sweep<Case> {
    Sweep::new(
        name,
        "distance from an edge / size",
        &SMALL,
        move |x, random| {
            let canvas = Canvas::new(random, 0.0);
            let vertices = canvas.outline(random, corners, 0.95);
            let aim = near_edge(random, &vertices, x);
            canvas.seen(random, vertices, aim, 10.0)
        },
    )
}

fn sliver() -> Sweep<Case> {
    Sweep::new(
        "sliver",
        "height / length of a triangle",
        &SMALL,
        |x, random| {
            let canvas = Canvas::new(random, 0.0);
            let vertices = [(-1.0, 0.0), (1.0, 0.0), (random.signed(), x)];
            let vertices = vertices.map(|(x, y)| canvas.at(x, y).round()).to_vec();
            let aim = canvas.at(random.signed(), x * random.between(-0.2, 1.2));
            canvas.seen(random, vertices, aim, 10.0)
        },
    )
}

fn grazing(corners: usize) -> Sweep<Case> {
    Sweep::new(
        "grazing",
        "sine of the angle between ray and plane",
        &SMALL,
        move |x, random| {
            let canvas = Canvas::new(random, 0.0);
            let vertices = canvas.outline(random, corners, 0.95);
            let aim = canvas.at(random.between(-1.2, 1.2), random.between(-1.2, 1.2));
            let across = canvas.x.cross(canvas.y);
            let direction = random.across(across) + across * (x * random.between(0.5, 1.0));
            let origin = aim - direction * 10.0;
            Case {
                ray: Ray::new(origin.round(), direction.unit()),
                normal: newell(&vertices),
                vertices,
            }
        },
    )
}

fn world_offset(corners: usize) -> Sweep<Case> {
    Sweep::new(
        "world offset",
        "distance of the scene from 0 / size",
        &LARGE,
        move |x, random| {
            let canvas = Canvas::new(random, x);
            let vertices = canvas.outline(random, corners, 0.95);
            let aim = near_edge(random, &vertices, 0.3);
            canvas.seen(random, vertices, aim, 10.0)
        },
    )
}

fn scale(corners: usize) -> Sweep<Case> {
    let sizes = [-60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0];
    Sweep::new(
        "scale",
        "log2 of the size of everything",
        &sizes,
        move |x, random| {
            let canvas = Canvas::new(random, 0.0);
            let vertices = canvas.outline(random, corners, 0.95);
            let aim = near_edge(random, &vertices, 0.3);
            let case = canvas.seen(random, vertices, aim, 10.0);
            let scale = x.exp2() as f32;
            Case {
                ray: Ray::new(case.ray.origin * scale, case.ray.direction),
                vertices: case.vertices.iter().map(|&v| v * scale).collect(),
                ..case
            }
        },
    )
}

/// Near the plane, and above or below the outline's middle or its edge.
fn near_surface(corners: usize) -> Sweep<Case> {
    Sweep::new(
        "near surface",
        "height of the origin over the plane / size",
        &SMALL,
        move |x, random| {
            let canvas = Canvas::new(random, 0.0);
            let vertices = canvas.outline(random, corners, 0.95);
            let foot = canvas.at(random.between(-1.0, 1.0), random.between(-1.0, 1.0));
            let origin = foot + canvas.x.cross(canvas.y) * (x * random.signed());
            Case {
                ray: Ray::new(origin.round(), random.direction().unit()),
                normal: newell(&vertices),
                vertices,
            }
        },
    )
}

/// Whole numbers: rays along one axis or in the plane of two, with zeros of both signs, that pass
/// exactly through corners and edges.
fn lattice() -> Sweep<Case> {
    Sweep::new(
        "lattice",
        "direction components that are zero",
        &[1.0, 2.0],
        |x, random| {
            let z = random.below(3);
            let turned = |v: [f32; 3]| Vec3::from([0, 1, 2].map(|i| v[(i + 3 - z) % 3]));
            let whole = |random: &mut Random| random.below(7) as f32 - 3.0;
            let side = random.below(3) as f32 + 1.0;
            let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
            let vertices = corners
                .map(|[a, b]| turned([a * side, b * side, 0.0]))
                .to_vec();
            let zero = |random: &mut Random| [-0.0, 0.0][random.below(2)];
            let slant = match x {
                1.0 => [-1.0, 1.0][random.below(2)],
                _ => zero(random),
            };
            let direction = [slant, zero(random), [-1.0, 1.0][random.below(2)]];
            let origin = [whole(random), whole(random), whole(random)];
            Case {
                ray: Ray::new(turned(origin), turned(direction)),
                normal: turned([0.0, 0.0, 1.0]),
                vertices,
            }
        },
    )
}

/// Outlines that are out of their plane.
fn warp() -> Sweep<Case> {
    Sweep::new(
        "warped",
        "distance of the corners from a plane / size",
        // As far as the constructor allows.
        &[1e-7, 1e-6, 1e-5, 6e-5],
        |x, random| {
            let canvas = Canvas::new(random, 0.0);
            let mut vertices = canvas.outline(random, 6, 0.95);
            for vertex in &mut vertices {
                *vertex = (Point::new(*vertex) + random.vector(x)).round();
            }
            let aim = near_edge(random, &vertices, x);
            canvas.seen(random, vertices, aim, 10.0)
        },
    )
}

impl Case {
    /// Judges each of `answers`, of which the flagged ones do not know the stored normal.
    fn judge(
        &self,
        answers: impl Iterator<Item = (bool, Option<f32>)>,
        judged: &mut dyn FnMut(usize, Verdict),
    ) {
        let ray = line(&self.ray);
        let vertices: Vec<[f32; 3]> = self.vertices.iter().map(|v| v.to_array()).collect();
        let by = |facing| (facing, exact::polygon::truth(&ray, &vertices, facing));
        let (stored, fan) = (by(Facing::Normal(self.normal.to_array())), by(Facing::Fan));
        for (i, (ignores_normal, answer)) in answers.enumerate() {
            let (facing, truth) = if ignores_normal { fan } else { stored };
            let verdict = exact::judge(
                &truth,
                answer,
                |t| exact::polygon::residual(&ray, &vertices, facing, t),
                || exact::polygon::margins(&ray, &vertices, facing),
            );
            judged(i, verdict);
        }
    }
}

impl Stage for Polygons {
    const NAME: &'static str = "polygon";
    type Case = Case;

    fn sweeps() -> Vec<Sweep<Case>> {
        vec![
            distance("distance, hexagon", 6),
            distance("distance, decagon", 10),
            edge("edge, hexagon", 6),
            Sweep::new(
                "edge, concave",
                "distance from an edge / size",
                &SMALL,
                |x, random| {
                    // A star: every second corner drawn in.
                    let canvas = Canvas::new(random, 0.0);
                    let mut vertices = canvas.outline(random, 10, 0.9);
                    for vertex in vertices.iter_mut().step_by(2) {
                        let corner = Point::new(*vertex);
                        *vertex = (corner + (canvas.center - corner) * 0.6).round();
                    }
                    let aim = near_edge(random, &vertices, x);
                    canvas.seen(random, vertices, aim, 10.0)
                },
            ),
            Sweep::new(
                "edge, warped",
                "distance from an edge / size",
                &SMALL,
                |x, random| {
                    // Out of its plane by 1e-5 of its size, as files with few digits have it.
                    let canvas = Canvas::new(random, 0.0);
                    let mut vertices = canvas.outline(random, 4, 0.9);
                    for vertex in &mut vertices {
                        *vertex = (Point::new(*vertex) + random.vector(1e-5)).round();
                    }
                    let aim = near_edge(random, &vertices, x);
                    canvas.seen(random, vertices, aim, 10.0)
                },
            ),
            warp(),
            lattice(),
            sliver(),
            grazing(6),
            near_surface(6),
            world_offset(6),
            scale(6),
        ]
    }

    fn methods() -> Vec<&'static str> {
        METHODS.iter().map(|method| method.name).collect()
    }

    fn ask(case: &Case, judged: &mut dyn FnMut(usize, Verdict)) {
        let setup = Setup::new(&case.ray);
        let polygon = Polygon {
            vertices: &case.vertices,
            normal: case.normal,
        };
        let answers = METHODS.iter().map(|method| {
            (
                ignores_normal(method.name),
                (method.run)(&case.ray, &setup, &polygon),
            )
        });
        case.judge(answers, judged);
    }
}

impl Stage for Triangles {
    const NAME: &'static str = "triangle";
    type Case = Case;

    fn sweeps() -> Vec<Sweep<Case>> {
        vec![
            distance("distance", 3),
            edge("edge", 3),
            sliver(),
            grazing(3),
            near_surface(3),
            world_offset(3),
            scale(3),
        ]
    }

    fn methods() -> Vec<&'static str> {
        triangle::METHODS.iter().map(|method| method.name).collect()
    }

    fn ask(case: &Case, judged: &mut dyn FnMut(usize, Verdict)) {
        let setup = Setup::new(&case.ray);
        let [a, b, c] = case.vertices[..] else {
            unreachable!("all sweeps are of three corners");
        };
        let triangle = Triangle {
            vertices: [a, b, c],
            normal: case.normal,
        };
        let answers = triangle::METHODS.iter().map(|method| {
            (
                triangle::ignores_normal(method.name),
                (method.run)(&case.ray, &setup, &triangle),
            )
        });
        case.judge(answers, judged);
    }
}
