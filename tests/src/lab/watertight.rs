//! Rays aimed at the shared edges and corners of closed meshes.

use rayon::prelude::*;
use whitted::{Polygon, Ray, Vec3};
use whitted_methods::polygon::{METHODS, PolygonMethod, Setup};

use super::mesh::Mesh;
use super::random::{Point, Random, Stream};

/// A line of `watertight.csv`.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Leaks {
    /// Which closed mesh.
    pub mesh: String,
    /// `edge` or `corner`.
    pub target: String,
    /// By which method.
    pub method: String,
    /// How many were aimed.
    pub rays: u64,
    /// Rays that met no face.
    pub holes: u64,
    /// Rays that met more than one.
    pub doubles: u64,
}

/// A mesh with a place from which each of its points is seen through one face.
struct Target {
    name: &'static str,
    mesh: Mesh,
    normals: Vec<Vec3>,
    outlines: Vec<Vec<Vec3>>,
    edges: Vec<[usize; 2]>,
    /// Faces at either end of an edge.
    rings: Vec<Vec<usize>>,
    view: View,
}

#[derive(Clone, Copy)]
enum View {
    /// From near this point, which sees all of the mesh from inside.
    Inside(Point, f64),
    /// From outside, along the surface's normal.
    Outside,
}

impl Target {
    fn new(name: &'static str, mesh: Mesh, view: View) -> Self {
        let outline = |face: &Vec<usize>| face.iter().map(|&i| mesh.vertices[i]).collect();
        let outlines: Vec<Vec<Vec3>> = mesh.faces.iter().map(outline).collect();
        let edges = mesh.edges();
        let ring = |edge: &[usize; 2]| {
            let touches = |face: &[usize]| face.iter().any(|corner| edge.contains(corner));
            (0..mesh.faces.len())
                .filter(|&i| touches(&mesh.faces[i]))
                .collect()
        };
        Self {
            name,
            normals: outlines
                .iter()
                .map(|outline| newell(outline).round())
                .collect(),
            rings: edges.iter().map(ring).collect(),
            outlines,
            edges,
            view,
            mesh,
        }
    }

    fn ray(&self, random: &mut Random, corner: bool) -> (usize, Ray) {
        let index = random.below(self.edges.len());
        let [a, b] = self.edges[index].map(|i| Point::new(self.mesh.vertices[i]));
        let aim = a + (b - a) * if corner { 0.0 } else { random.unit() };
        let origin = match self.view {
            View::Inside(center, spread) => (center + random.vector(spread)).round(),
            View::Outside => {
                let normals = self.rings[index]
                    .iter()
                    .map(|&face| Point::new(self.normals[face]));
                let sum = normals.fold(Point([0.0; 3]), |sum, normal| sum + normal);
                let normal = sum * (1.0 / sum.dot(sum).sqrt());
                (aim + (normal + random.vector(0.1)) * 0.5).round()
            }
        };
        (index, Ray::new(origin, (aim - Point::new(origin)).unit()))
    }

    /// How many faces at either end of an edge the ray meets.
    fn count(&self, edge: usize, ray: &Ray, setup: &Setup, method: &PolygonMethod) -> usize {
        let meets = |&&face: &&usize| {
            let polygon = Polygon {
                vertices: &self.outlines[face],
                normal: self.normals[face],
            };
            (method.run)(ray, setup, &polygon).is_some()
        };
        self.rings[edge].iter().filter(meets).count()
    }
}

/// Newell's normal, outward for outlines that run counterclockwise; of unit length.
fn newell(outline: &[Vec3]) -> Point {
    let point = |i: usize| Point::new(outline[i % outline.len()]) - Point::new(outline[0]);
    let sum = (0..outline.len()).fold(Point([0.0; 3]), |sum, i| sum + point(i).cross(point(i + 1)));
    sum * (1.0 / sum.dot(sum).sqrt())
}

/// The six meshes.
fn targets() -> Vec<Target> {
    let center = |spread| View::Inside(Point([0.0; 3]), spread);
    let ball = Mesh::icosphere(2);
    let offset = 1e5;
    let far = Point([offset, -0.7 * offset, 0.4 * offset]);
    vec![
        Target::new("convex", ball.clone(), center(0.1)),
        Target::new("concave", Mesh::star(), center(0.1)),
        Target::new("warped", Mesh::warped(), center(0.1)),
        Target::new("ring", Mesh::torus(), View::Outside),
        Target::new(
            "squashed 1e-7",
            ball.moved([1.0, 1.0, 1e-7], 0.0),
            center(0.0),
        ),
        Target::new(
            "offset 1e5",
            ball.moved([1.0; 3], offset),
            View::Inside(far, 0.1),
        ),
    ]
}

const CHUNK: u64 = 1000;

/// Aims `rays` at the edges and as many at the corners of each mesh, for the methods that `of` names.
pub fn run(
    seed: u64,
    rays: u64,
    of: impl Fn(&str) -> bool,
    progress: &(impl Fn(&str, &str) + Sync),
) -> Vec<Leaks> {
    let methods: Vec<_> = METHODS.iter().filter(|method| of(method.name)).collect();
    let mut lines = Vec::new();
    for target in targets() {
        progress("watertight", target.name);
        for (at, corner) in [("edge", false), ("corner", true)] {
            let none = || vec![[0_u64; 2]; methods.len()];
            let counts = (0..rays.div_ceil(CHUNK))
                .into_par_iter()
                .map(|chunk| {
                    let mut random = Random::new(Stream {
                        seed,
                        purpose: Stream::purpose(["watertight", target.name]),
                        cell: u64::from(corner),
                        chunk,
                    });
                    let mut counts = none();
                    for _ in 0..CHUNK.min(rays - chunk * CHUNK) {
                        let (edge, ray) = target.ray(&mut random, corner);
                        let setup = Setup::new(&ray);
                        for (count, method) in counts.iter_mut().zip(&methods) {
                            match target.count(edge, &ray, &setup, method) {
                                0 => count[0] += 1,
                                1 => {}
                                _ => count[1] += 1,
                            }
                        }
                    }
                    counts
                })
                .reduce(none, |mut counts, more| {
                    for (count, more) in counts.iter_mut().zip(more) {
                        *count = [count[0] + more[0], count[1] + more[1]];
                    }
                    counts
                });
            for (method, [holes, doubles]) in methods.iter().zip(counts) {
                lines.push(Leaks {
                    mesh: target.name.into(),
                    target: at.into(),
                    method: method.name.into(),
                    rays,
                    holes,
                    doubles,
                });
            }
        }
    }
    lines
}
