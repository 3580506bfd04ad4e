//! The kinds of shapes, and whether a hierarchy over them pays.

use std::mem::size_of;
use std::ops::RangeInclusive;

use whitted::hierarchy::{Aabb, Ball, Node};
use whitted::{
    Cuboid, Ends, Frustum, Object, Patch, Plane, Polygon, Quadric, Sphere, Torus, Triangle,
};

use super::Layout;
use super::source::{VECTOR, WORD, number, vector, vectors};
use crate::hierarchy::{Bounded, Costs, Settings, Tree};
use crate::scene::Material;

/// A kind of shape, as it is named in the source.
pub trait Kind {
    /// The type.
    const TYPE: &'static str;
    /// The start of its arrays' names.
    const NAME: &'static str;
    /// The type of all its objects.
    const ALL: &'static str;
    /// Bytes of one, but for what it points to.
    const BYTES: usize;
    /// How many objects may be a slice that passes over what a ray cannot meet.
    const CULLED: RangeInclusive<usize> = RangeInclusive::new(1, 0);
    /// Most objects that are a plain slice; with more, a hierarchy takes fewer instructions of a Cortex-M4F
    /// (`tests/charts/firmware-hierarchy.svg`). Triangles were measured, and the rest costs about as
    /// much or more. A hierarchy's code takes flash too, which two objects are not worth.
    const SLICE: usize = 2;
    /// What else its source names.
    const IMPORTS: &'static [&'static str] = &[];

    /// What takes the fewest instructions for so many; `bounces` where rays leave surfaces, for which
    /// nothing is known of what they miss.
    fn fastest(count: usize, bounces: bool) -> Layout {
        if Self::CULLED.contains(&count) && !(bounces && count > Self::SLICE) {
            Layout::Culled
        } else if count > Self::SLICE {
            Layout::Hierarchies
        } else {
            Layout::Slices
        }
    }

    /// Its source.
    fn source(&self) -> String;

    /// Bytes of what it points to.
    fn bytes_elsewhere(&self) -> usize {
        0
    }

    /// A hierarchy of such shapes, where there can be one.
    fn hierarchy(_: &[Object<'_, Self, Material>]) -> Option<Baked>
    where
        Self: Sized,
    {
        None
    }
}

/// A hierarchy as it is put into flash.
pub struct Baked {
    pub tree: Tree,
    pub nodes: Nodes,
}

pub enum Nodes {
    Boxes(Vec<Node<Aabb>>),
    Balls(Vec<Node<Ball>>),
}

/// The hierarchy over some objects that is expected to take the least instructions of a Cortex-M4F, of
/// which one object takes `object`; `None` where there are fewer than two.
fn hierarchy<S: Bounded>(objects: &[Object<'_, S, Material>], object: f32) -> Option<Baked> {
    let bounds: Vec<_> = objects.iter().map(|it| it.shape.bounds()).collect();
    let least_depth = objects.len().next_power_of_two().ilog2() as usize;
    let tree = |costs| {
        let (leaf, depth) = (16, least_depth + 4);
        Tree::new(&bounds, Settings { costs, leaf, depth })
    };
    let (ray, node) = BOX_INSTRUCTIONS;
    let costs = Costs { ray, node, object };
    let tree_of_boxes = tree(costs)?;
    let boxes = tree_of_boxes.boxes();
    let areas = boxes.iter().map(|it| it.0.map(|it| box_area(&it.bound)));
    let cost_of_boxes = tree_of_boxes.cost(areas, costs);
    let (ray, node) = BALL_INSTRUCTIONS;
    let costs = Costs { ray, node, object };
    let tree_of_balls = tree(costs)?;
    if let Some(balls) = tree_of_balls.balls(|place| objects[place].shape.balls()) {
        let areas = balls.iter().map(|it| it.0.map(|it| ball_area(&it.bound)));
        if tree_of_balls.cost(areas, costs) < cost_of_boxes {
            return Some(Baked {
                tree: tree_of_balls,
                nodes: Nodes::Balls(balls),
            });
        }
    }
    Some(Baked {
        tree: tree_of_boxes,
        nodes: Nodes::Boxes(boxes),
    })
}

/// What a ray takes, and what a node takes with both its bounds and all that follows from them, in
/// instructions of a Cortex-M4F: estimates, like those of objects below. They decide how a tree is built,
/// never what is met.
const BOX_INSTRUCTIONS: (f32, f32) = (70.0, 130.0);
const BALL_INSTRUCTIONS: (f32, f32) = (25.0, 95.0);

fn box_area(bound: &Aabb) -> f64 {
    let [x, y, z] = bound.half.to_array().map(f64::from);
    8.0 * (x * y + y * z + z * x)
}

fn ball_area(bound: &Ball) -> f64 {
    4.0 * std::f64::consts::PI * f64::from(bound.radius).powi(2)
}

impl Kind for Sphere {
    const TYPE: &'static str = "Sphere";
    const NAME: &'static str = "SPHERE";
    const ALL: &'static str = "Spheres";
    const BYTES: usize = size_of::<Self>();
    const CULLED: RangeInclusive<usize> = 2..=31;
    const SLICE: usize = 12;

    fn source(&self) -> String {
        let (center, radius) = (vector(self.center), number(self.radius));
        format!("Sphere {{ center: {center}, radius: {radius} }}")
    }

    fn hierarchy(objects: &[Object<'_, Self, Material>]) -> Option<Baked> {
        hierarchy(objects, 30.0)
    }
}

impl Kind for Plane {
    const TYPE: &'static str = "Plane";
    const NAME: &'static str = "PLANE";
    const ALL: &'static str = "Planes";
    const BYTES: usize = size_of::<Self>();

    fn source(&self) -> String {
        let (point, normal) = (vector(self.point), vector(self.normal));
        format!("Plane {{ point: {point}, normal: {normal} }}")
    }
}

impl Kind for Polygon<'_> {
    const TYPE: &'static str = "Polygon<'static>";
    const NAME: &'static str = "POLYGON";
    const ALL: &'static str = "Polygons";
    const BYTES: usize = 2 * WORD + VECTOR;

    fn source(&self) -> String {
        let (vertices, normal) = (vectors(self.vertices), vector(self.normal));
        format!("Polygon {{ vertices: &{vertices}, normal: {normal} }}")
    }

    fn bytes_elsewhere(&self) -> usize {
        self.vertices.len() * VECTOR
    }

    fn hierarchy(objects: &[Object<'_, Self, Material>]) -> Option<Baked> {
        let vertices: usize = objects.iter().map(|it| it.shape.vertices.len()).sum();
        let vertices_each = vertices as f32 / objects.len().max(1) as f32;
        hierarchy(objects, 30.0 + 25.0 * vertices_each)
    }
}

impl Kind for Triangle {
    const TYPE: &'static str = "Triangle";
    const NAME: &'static str = "TRIANGLE";
    const ALL: &'static str = "Triangles";
    const BYTES: usize = size_of::<Self>();

    fn source(&self) -> String {
        let (vertices, normal) = (vectors(&self.vertices), vector(self.normal));
        format!("Triangle {{ vertices: {vertices}, normal: {normal} }}")
    }

    fn hierarchy(objects: &[Object<'_, Self, Material>]) -> Option<Baked> {
        hierarchy(objects, 90.0)
    }
}

impl Kind for Patch {
    const TYPE: &'static str = "Patch";
    const NAME: &'static str = "PATCH";
    const ALL: &'static str = "Patches";
    const BYTES: usize = size_of::<Self>();

    fn source(&self) -> String {
        let [vertices, normals] = [&self.vertices, &self.normals].map(|it| vectors(it));
        let normal = vector(self.normal);
        format!("Patch {{ vertices: {vertices}, normals: {normals}, normal: {normal} }}")
    }

    fn hierarchy(objects: &[Object<'_, Self, Material>]) -> Option<Baked> {
        hierarchy(objects, 90.0)
    }
}

impl Kind for Cuboid {
    const TYPE: &'static str = "Cuboid";
    const NAME: &'static str = "CUBOID";
    const ALL: &'static str = "Cuboids";
    const BYTES: usize = size_of::<Self>();

    fn source(&self) -> String {
        let (min, max) = (vector(self.min), vector(self.max));
        format!("Cuboid {{ min: {min}, max: {max} }}")
    }

    fn hierarchy(objects: &[Object<'_, Self, Material>]) -> Option<Baked> {
        hierarchy(objects, 60.0)
    }
}

impl Kind for Frustum {
    const TYPE: &'static str = "Frustum";
    const NAME: &'static str = "FRUSTUM";
    const ALL: &'static str = "Frusta";
    const BYTES: usize = size_of::<Self>();

    fn source(&self) -> String {
        let Self {
            base,
            axis,
            length,
            base_radius,
            slope,
        } = *self;
        let ([base, axis], [length, base_radius, slope]) = (
            [base, axis].map(vector),
            [length, base_radius, slope].map(number),
        );
        format!(
            "Frustum {{ base: {base}, axis: {axis}, length: {length}, base_radius: {base_radius}, \
             slope: {slope} }}"
        )
    }

    fn hierarchy(objects: &[Object<'_, Self, Material>]) -> Option<Baked> {
        hierarchy(objects, 100.0)
    }
}

impl Kind for Quadric {
    const TYPE: &'static str = "Quadric";
    const NAME: &'static str = "QUADRIC";
    const ALL: &'static str = "Quadrics";
    const BYTES: usize = size_of::<Self>();
    const IMPORTS: &'static [&'static str] = &["Clip", "Ends"];

    fn source(&self) -> String {
        let Self {
            center,
            squares,
            products,
            linear,
            constant,
            clip,
            ends,
        } = *self;
        let [center, squares, products, linear] = [center, squares, products, linear].map(vector);
        let [min, max, axis] = [clip.min, clip.max, clip.axis].map(vector);
        let [constant, from, to] = [constant, clip.from, clip.to].map(number);
        let ends = match ends {
            Ends::Open => "Open",
            Ends::Closed => "Closed",
        };
        format!(
            "Quadric {{ center: {center}, squares: {squares}, products: {products}, \
             linear: {linear}, constant: {constant}, clip: Clip {{ min: {min}, max: {max}, \
             axis: {axis}, from: {from}, to: {to} }}, ends: Ends::{ends} }}"
        )
    }

    fn hierarchy(objects: &[Object<'_, Self, Material>]) -> Option<Baked> {
        let has_end = |it: &Object<'_, Self, Material>| {
            it.shape.clip.min.is_finite() && it.shape.clip.max.is_finite()
        };
        // Of what has no end there are no bounds.
        objects
            .iter()
            .all(has_end)
            .then(|| hierarchy(objects, 200.0))?
    }
}

impl Kind for Torus {
    const TYPE: &'static str = "Torus";
    const NAME: &'static str = "TORUS";
    const ALL: &'static str = "Tori";
    const BYTES: usize = size_of::<Self>();

    fn source(&self) -> String {
        let [center, axis] = [self.center, self.axis].map(vector);
        let [major, minor] = [self.major, self.minor].map(number);
        format!("Torus {{ center: {center}, axis: {axis}, major: {major}, minor: {minor} }}")
    }

    fn hierarchy(objects: &[Object<'_, Self, Material>]) -> Option<Baked> {
        hierarchy(objects, 300.0)
    }
}
