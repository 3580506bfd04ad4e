//! Closed meshes of polygons.

use std::collections::HashMap;
use std::f64::consts::TAU;

use whitted::Vec3;

use super::random::{Point, Random, Stream};

/// Faces by the indices of their corners: faces that share an edge share its ends, to the bit.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// Corners.
    pub vertices: Vec<Vec3>,
    /// Outlines.
    pub faces: Vec<Vec<usize>>,
}

impl Mesh {
    /// An icosahedron whose faces are cut in four as often as this, on the unit sphere.
    pub fn icosphere(cuts: u32) -> Self {
        let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
        let mut vertices = Vec::new();
        for (a, b) in [
            (1.0, golden),
            (-1.0, golden),
            (1.0, -golden),
            (-1.0, -golden),
        ] {
            vertices.extend([[0.0, a, b], [a, b, 0.0], [b, 0.0, a]].map(Point));
        }
        // Neighbours are 2 apart, all others further.
        let is_edge = |a: usize, b: usize| {
            let way = vertices[a] - vertices[b];
            way.dot(way) < 4.5
        };
        let mut faces = Vec::new();
        for a in 0..12 {
            for b in a + 1..12 {
                for c in b + 1..12 {
                    if is_edge(a, b) && is_edge(b, c) && is_edge(c, a) {
                        // Counterclockwise from outside.
                        let across = (vertices[b] - vertices[a]).cross(vertices[c] - vertices[a]);
                        let outward = across.dot(vertices[a]) > 0.0;
                        faces.push(if outward {
                            vec![a, b, c]
                        } else {
                            vec![a, c, b]
                        });
                    }
                }
            }
        }
        for _ in 0..cuts {
            let mut middles = HashMap::new();
            let mut middle = |a: usize, b: usize| {
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    vertices.push(vertices[a] + vertices[b]);
                    vertices.len() - 1
                })
            };
            let mut cut = Vec::new();
            for face in &faces {
                let [a, b, c] = [face[0], face[1], face[2]];
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                cut.extend([
                    vec![a, ab, ca],
                    vec![ab, b, bc],
                    vec![ca, bc, c],
                    vec![ab, bc, ca],
                ]);
            }
            faces = cut;
            for vertex in &mut vertices {
                *vertex = *vertex * (1.0 / vertex.dot(*vertex).sqrt());
            }
        }
        let size = 1.0 / vertices[0].dot(vertices[0]).sqrt();
        Self::rounded(
            &vertices.iter().map(|&v| v * size).collect::<Vec<_>>(),
            faces,
        )
    }

    /// A cube of quadrilaterals, inflated to a sphere and dented: no face is flat.
    pub fn warped() -> Self {
        const N: i32 = 4;
        let mut random = Random::new(Stream {
            seed: 0,
            purpose: 0,
            cell: 0,
            chunk: 0,
        });
        let mut places = HashMap::new();
        let mut vertices = Vec::new();
        let mut faces = Vec::new();
        for axis in 0..3 {
            for side in [-N, N] {
                for (i, j) in (0..N * N).map(|k| (2 * (k % N) - N, 2 * (k / N) - N)) {
                    let corners = [(i, j), (i + 2, j), (i + 2, j + 2), (i, j + 2)];
                    let mut face = Vec::new();
                    for (u, v) in corners {
                        let mut place = [0; 3];
                        place[axis] = side;
                        place[(axis + 1) % 3] = u;
                        place[(axis + 2) % 3] = v;
                        face.push(*places.entry(place).or_insert_with(|| {
                            let v = Point(place.map(f64::from));
                            let radius = 1.0 + 0.1 * random.signed();
                            vertices.push(v * (radius / v.dot(v).sqrt()));
                            vertices.len() - 1
                        }));
                    }
                    faces.push(face);
                }
            }
        }
        Self::rounded(&vertices, faces)
    }

    /// A prism over a star: concave faces with ten corners at both ends.
    pub fn star() -> Self {
        let corner = |i: usize, z: f64| {
            let (sin, cos) = (TAU * (i as f64 + 0.3) / 10.0).sin_cos();
            let radius = if i.is_multiple_of(2) { 1.0 } else { 0.45 };
            Point([radius * cos, radius * sin, z])
        };
        let ends = [-0.5, 0.5].map(|z| (0..10).map(move |i| corner(i, z)));
        let vertices: Vec<Point> = ends.into_iter().flatten().collect();
        let mut faces = vec![(0..10).collect(), (10..20).collect()];
        faces.extend((0..10).map(|i| vec![i, (i + 1) % 10, 10 + (i + 1) % 10, 10 + i]));
        Self::rounded(&vertices, faces)
    }

    /// A ring of quadrilaterals, nowhere convex on its inner half.
    pub fn torus() -> Self {
        let (around, across) = (20, 10);
        let corner = |i: usize, j: usize| {
            let (sin, cos) = (TAU * i as f64 / around as f64).sin_cos();
            let (height, out) = (TAU * (j as f64 + 0.5) / across as f64).sin_cos();
            let radius = 1.0 + 0.4 * out;
            Point([radius * cos, radius * sin, 0.4 * height])
        };
        let index = |i: usize, j: usize| (i % around) * across + j % across;
        let all = (0..around).flat_map(|i| (0..across).map(move |j| (i, j)));
        let vertices: Vec<Point> = all.clone().map(|(i, j)| corner(i, j)).collect();
        let faces = all.map(|(i, j)| {
            vec![
                index(i, j),
                index(i + 1, j),
                index(i + 1, j + 1),
                index(i, j + 1),
            ]
        });
        Self::rounded(&vertices, faces.collect())
    }

    /// The mesh stretched along each axis, then moved; rounded once.
    pub fn moved(&self, stretch: [f64; 3], offset: f64) -> Self {
        let shift = Point([offset, -0.7 * offset, 0.4 * offset]);
        let place = |v: &Vec3| {
            let v = Point::new(*v).0;
            Point([0, 1, 2].map(|i| v[i] * stretch[i])) + shift
        };
        Self::rounded(
            &self.vertices.iter().map(place).collect::<Vec<_>>(),
            self.faces.clone(),
        )
    }

    fn rounded(vertices: &[Point], faces: Vec<Vec<usize>>) -> Self {
        Self {
            vertices: vertices.iter().map(|v| v.round()).collect(),
            faces,
        }
    }

    /// Each edge once, by the indices of its ends.
    pub fn edges(&self) -> Vec<[usize; 2]> {
        let mut edges: Vec<[usize; 2]> = self
            .faces
            .iter()
            .flat_map(|face| (0..face.len()).map(|i| [face[i], face[(i + 1) % face.len()]]))
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_meshes_are_closed() {
        let meshes = [
            Mesh::icosphere(2),
            Mesh::warped(),
            Mesh::star(),
            Mesh::torus(),
        ];
        for (mesh, faces) in meshes.iter().zip([320, 96, 12, 200]) {
            assert_eq!(mesh.faces.len(), faces);
            let edges = mesh.edges();
            let corners: usize = mesh.faces.iter().map(Vec::len).sum();
            assert_eq!(2 * edges.len(), corners, "every edge has two owners");
        }
        let euler = |mesh: &Mesh| {
            mesh.vertices.len() as i64 - mesh.edges().len() as i64 + mesh.faces.len() as i64
        };
        assert_eq!(meshes.map(|mesh| euler(&mesh)), [2, 2, 2, 0]);
    }
}
