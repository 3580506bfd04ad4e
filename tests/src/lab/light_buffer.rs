//! Bytes against tests that shadow rays are saved: by light buffers, of bits and of lists, and by hierarchies.
//!
//! The shadow rays of whole pictures are taken down, and each method is asked about all of them.

use std::array::from_ref;
use std::cell::{Cell, RefCell};

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};
use whitted::hierarchy::{Ball, BallProbe, Bound, Child};
use whitted::material::{AttenuationBy, ShareOf};
use whitted::math::{Attenuation, Passage};
use whitted::picture::row;
use whitted::{
    Camera, Candidates, Culled, Exact, Finish, Geometry, Hierarchy, Light, LightBuffer,
    LightSource, Material, Math, Node, Object, Plane, Ray, Scene, Shape, Side, Sphere, Tracer,
    View,
};
use whitted_cli::hierarchy::{Bounded, Costs, Settings, Tree};

use super::random::{Random, Stream};
use crate::comparison::DEPTH;
use crate::embedded::scenes::layouts::{c_ray, six_spheres, tiny};

/// A line of `light-buffer.csv`: what a method takes, and what is left to test for a shadow ray.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Buffered {
    /// Whose shadow rays.
    pub scene: String,
    /// Of the scene.
    pub spheres: usize,
    /// Of the scene.
    pub lights: usize,
    /// How they are saved.
    pub method: String,
    /// Of each light.
    pub cells: usize,
    /// Of flash, for all lights, over what a plain slice takes.
    pub bytes: usize,
    /// Shadow rays of the picture.
    pub rays: usize,
    /// Spheres that are tested, a ray.
    pub tests: f64,
    /// Bounds that are tested, a ray.
    pub bounds: f64,
    /// Share of the plain slice's tests that are saved, where tests of bounds are tests, too.
    pub saved: f64,
    /// Share of the rays for which no sphere is tested.
    pub idle: f64,
}

/// Without any help.
pub const PLAIN: &str = "every sphere";
/// What `whitted` has.
pub const BITS: &str = "bits";
/// As in the paper.
pub const LISTS: &str = "lists by distance";
/// What `whitted` has for many objects.
pub const TREE: &str = "hierarchy of balls";

/// All scenes.
pub fn run(progress: &(impl Fn(&str, &str) + Sync)) -> Vec<Buffered> {
    let mut lines = Vec::new();
    let mut add = |name: &str, of: Vec<Buffered>| {
        progress("light buffer", name);
        lines.extend(of);
    };
    let scene = &six_spheres::SCENE;
    let of = study("six spheres", scene.geometry.0.0, scene, &six_spheres::VIEW);
    add("six spheres", of);
    let scene = &c_ray::SCENE;
    let of = study("c-ray", scene.geometry.0, scene, &c_ray::VIEW);
    add("c-ray", of);
    let scene = &tiny::SCENE;
    let of = study("tinyraytracer", scene.geometry.0.0, scene, &tiny::VIEW);
    add("tinyraytracer", of);
    add("strewn", made("strewn", &strewn(31), &LAMP[..1], -1.5));
    for (name, levels) in [("balls", 1), ("balls", 2), ("balls", 3)] {
        let mut balls = Vec::new();
        grow(&mut balls, Vec3::ZERO, Vec3::Y, 0.5, levels);
        add(name, made(name, &balls, &LAMP, -0.5));
    }
    lines
}

const CHALK: Material = Material::matte(Vec3::ONE, 0.0, 1.0);

const fn lamp(x: f32, y: f32, z: f32) -> Light {
    Light {
        position: Vec3::new(x, y, z),
        color: Vec3::ONE,
    }
}

const LAMP: [Light; 3] = [
    lamp(4.0, 6.0, 8.0),
    lamp(-4.0, 8.0, 1.0),
    lamp(1.0, 3.0, -5.0),
];

fn ball(center: Vec3, radius: f32) -> Object<'static, Sphere> {
    Object {
        shape: Sphere { center, radius },
        material: &CHALK,
    }
}

/// Spheres all over a cube that fills the picture.
fn strewn(count: u64) -> Vec<Object<'static, Sphere>> {
    let mut random = Random::new(Stream {
        seed: 0,
        purpose: Stream::purpose(["light buffer", "strewn"]),
        cell: count,
        chunk: 0,
    });
    let radius = 0.8 / (count as f64).sqrt();
    (0..count)
        .map(|_| ball(random.vector(1.0).round(), radius as f32))
        .collect()
}

/// Spheres on spheres, nine on each, a third as large, to a depth of `levels`: the figure of `balls` in
/// E. Haines, "A Proposal for Standard Graphics Environments", IEEE CG&A 7(11), 1987, with other axes.
fn grow(
    balls: &mut Vec<Object<'static, Sphere>>,
    center: Vec3,
    up: Vec3,
    radius: f32,
    levels: u32,
) {
    balls.push(ball(center, radius));
    if levels == 0 {
        return;
    }
    const SIN_60: f32 = 0.866_025_4;
    // A hexagon round the equator, and three above where they touch each other.
    let (third, high) = (0.577_350_3, 0.816_496_6);
    let ways = [
        [1.0, 0.0, 0.0],
        [0.5, SIN_60, 0.0],
        [-0.5, SIN_60, 0.0],
        [-1.0, 0.0, 0.0],
        [-0.5, -SIN_60, 0.0],
        [0.5, -SIN_60, 0.0],
        [0.0, third, high],
        [-0.5, -0.5 * third, high],
        [0.5, -0.5 * third, high],
    ];
    let (right, ahead) = up.any_orthonormal_pair();
    for [x, y, z] in ways {
        let way = right * x + ahead * y + up * z;
        let center = center + way * (radius * (4.0 / 3.0));
        grow(balls, center, way, radius / 3.0, levels - 1);
    }
}

/// Chalk on a floor.
fn made(
    name: &str,
    balls: &[Object<'static, Sphere>],
    lights: &[Light],
    floor: f32,
) -> Vec<Buffered> {
    let floor = [Object {
        shape: Plane {
            point: Vec3::Y * floor,
            normal: Vec3::Y,
        },
        material: &CHALK,
    }];
    let camera = Camera::look_at(Vec3::new(0.0, 1.0, 5.0), Vec3::ZERO, Vec3::Y, 0.5, 1.0);
    let view = View {
        camera: camera.expect("a camera"),
        width: 48,
        height: 48,
    };
    let scene = Scene {
        geometry: (balls, &floor[..]),
        lights,
        background: Vec3::ZERO,
        ambient: Vec3::ZERO,
    };
    study(name, balls, &scene, &view)
}

/// Takes down what it is asked by shadow rays.
struct Recorder<'a, G> {
    inner: &'a G,
    rays: RefCell<Vec<Ray>>,
}

impl<G: Geometry> Geometry for Recorder<'_, G> {
    type Material = G::Material;

    fn len(&self) -> usize {
        self.inner.len()
    }

    fn nearest<P: Math>(&self, ray: &mut Ray, first: usize, among: Candidates) -> Option<usize> {
        self.inner.nearest::<P>(ray, first, among)
    }

    fn surface<P: Math>(
        &self,
        ray: &Ray,
        t: f32,
        object: usize,
        first: usize,
    ) -> Option<(Vec3, &G::Material)> {
        self.inner.surface::<P>(ray, t, object, first)
    }

    fn blocks<P: Math>(&self, ray: &Ray, first: usize, among: Candidates) -> bool {
        self.rays.borrow_mut().push(*ray);
        self.inner.blocks::<P>(ray, first, among)
    }

    fn absorbs<P: Math, L: Passage>(
        &self,
        ray: &Ray,
        first: usize,
        among: Candidates,
        light: &mut L,
    ) -> bool
    where
        G::Material: Finish,
    {
        self.rays.borrow_mut().push(*ray);
        self.inner.absorbs::<P, L>(ray, first, among, light)
    }
}

thread_local! {
    /// Tests of spheres, and of bounds.
    static TESTS: [Cell<usize>; 2] = const { [Cell::new(0), Cell::new(0)] };
}

fn count(which: usize) {
    TESTS.with(|tests| tests[which].update(|it| it + 1));
}

/// Counts how often it is tested.
#[derive(Clone, Copy)]
struct Counted<T>(T);

impl Shape for Counted<Sphere> {
    type Setup = ();

    fn setup(_: &Ray) {}

    fn intersect<P: Math>(&self, ray: &Ray, _: &(), leaving: Option<Side>) -> Option<f32> {
        count(0);
        self.0.intersect::<P>(ray, &(), leaving)
    }

    fn crossings<P: Math>(&self, ray: &Ray, _: &(), leaving: Option<Side>) -> u32 {
        count(0);
        self.0.crossings::<P>(ray, &(), leaving)
    }

    fn normal<P: Math>(&self, ray: &Ray, t: f32) -> Vec3 {
        self.0.normal::<P>(ray, t)
    }
}

impl Bound<Counted<Sphere>> for Counted<Ball> {
    type Probe = BallProbe;

    fn probe(ray: &Ray, slack: f32) -> BallProbe {
        <Ball as Bound<Sphere>>::probe(ray, slack)
    }

    fn enter(&self, probe: &BallProbe, t_max: f32) -> Option<f32> {
        count(1);
        <Ball as Bound<Sphere>>::enter(&self.0, probe, t_max)
    }
}

/// The spheres that a ray towards a light tests, in this order.
type Order<'a> = Box<dyn Fn(usize, &Ray) -> Vec<usize> + 'a>;

/// A direction cube of lists: E. A. Haines and D. P. Greenberg, "The Light Buffer: A Shadow-Testing
/// Accelerator", IEEE Computer Graphics and Applications 6(9), 1986.
struct Cube {
    light: DVec3,
    /// Cells along an edge.
    side: usize,
    /// Spheres and the distance before which none of their points is, by that distance.
    cells: Vec<Vec<(f64, usize)>>,
}

impl Cube {
    /// By how much spheres are taken larger, over their distance: as in `whitted`.
    const SLACK: f64 = 1.0 / 2048.0;

    fn new<M>(light: Vec3, balls: &[Object<'_, Sphere, M>], side: usize) -> Self {
        let light = light.as_dvec3();
        let seen = |ball: &Object<'_, Sphere, M>| {
            let center = ball.shape.center.as_dvec3() - light;
            let (distance, radius) = (center.length(), f64::from(ball.shape.radius.abs()));
            let reach = radius + (distance + radius) * Self::SLACK;
            (center, reach, distance - reach)
        };
        let mut cells = vec![Vec::new(); 6 * side * side];
        for (place, ball) in balls.iter().enumerate() {
            let (center, reach, near) = seen(ball);
            for (index, cell) in cells.iter_mut().enumerate() {
                if Self::touches(side, index, center, reach) {
                    cell.push((near, place));
                }
            }
        }
        for cell in &mut cells {
            cell.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        Self { light, side, cells }
    }

    /// Along the axis of a face, and along its two edges.
    fn turned(face: usize, v: DVec3) -> [f64; 3] {
        let axis = face / 2;
        let sign = if face.is_multiple_of(2) { 1.0 } else { -1.0 };
        [sign * v[axis], v[(axis + 1) % 3], v[(axis + 2) % 3]]
    }

    /// Whether the sphere is not wholly beyond one of the four planes of a cell.
    fn touches(side: usize, cell: usize, center: DVec3, reach: f64) -> bool {
        let face = cell / (side * side);
        let [w, u, v] = Self::turned(face, center);
        let places = [cell % side, cell / side % side];
        w >= -reach
            && [u, v].into_iter().zip(places).all(|(x, place)| {
                let edge = |place: usize| 2.0 * place as f64 / side as f64 - 1.0;
                let (low, high) = (edge(place), edge(place + 1));
                x - high * w <= reach * (1.0 + high * high).sqrt()
                    && low * w - x <= reach * (1.0 + low * low).sqrt()
            })
    }

    fn cell(&self, from_light: DVec3) -> usize {
        let size = from_light.abs();
        let axis = (0..3).fold(0, |most, it| if size[it] > size[most] { it } else { most });
        let face = 2 * axis + usize::from(from_light[axis] < 0.0);
        let [w, u, v] = Self::turned(face, from_light);
        let place = |x: f64| (((x / w + 1.0) * 0.5 * self.side as f64) as usize).min(self.side - 1);
        (face * self.side + place(v)) * self.side + place(u)
    }

    fn order<M>(&self, balls: &[Object<'_, Sphere, M>], ray: &Ray) -> Vec<usize> {
        let cell = &self.cells[self.cell(ray.origin.as_dvec3() - self.light)];
        let distance = f64::from(ray.t_max);
        let before = cell.iter().take_while(|it| it.0 <= distance);
        let mut order: Vec<usize> = before.map(|it| it.1).collect();
        // As in `whitted`, what is left is looked at, unless it cannot be met again.
        if let Some(left) = ray.departure {
            order.retain(|&it| it != left.object);
            let ball = balls.get(left.object);
            if ball.is_some_and(|it| !it.shape.is_left_for_good(left.side)) {
                order.push(left.object);
            }
        }
        order
    }

    /// Where each list ends, the lists, and each sphere's distance, which is the same in all cells.
    fn bytes(&self, spheres: usize) -> usize {
        let entries: usize = self.cells.iter().map(Vec::len).sum();
        2 * (self.cells.len() + 1) + entries * index(spheres) + spheres * size_of::<f32>()
    }
}

/// Bytes of a sphere's number.
fn index(spheres: usize) -> usize {
    if spheres <= 256 { 1 } else { 2 }
}

/// Whether nothing of a light gets through, or how much; and how many spheres were tested.
fn passes<M: Finish>(
    balls: &[Object<'_, Sphere, M>],
    order: &[usize],
    ray: &Ray,
) -> (Option<ShareOf<M>>, usize) {
    let mut light = AttenuationBy::<M>::default();
    let mut tests = 0;
    for &place in order {
        let Some(ball) = balls.get(place) else {
            continue;
        };
        tests += 1;
        let leaving = ray.leaves(place);
        let times = ball.shape.crossings::<Exact>(ray, &(), leaving);
        let inside = || ball.shape.inside::<Exact>(ray, &(), leaving);
        if light.pass(ball.material.transmission(), times, inside) {
            return (None, tests);
        }
    }
    (Some(light.share()), tests)
}

/// All methods on one scene, of which the first objects are these spheres.
fn study<M: Finish, G: Geometry<Material = M>, L: LightSource>(
    name: &str,
    balls: &[Object<'_, Sphere, M>],
    scene: &Scene<'_, G, L>,
    view: &View,
) -> Vec<Buffered>
where
    ShareOf<M>: PartialEq,
{
    let recorded = Scene {
        geometry: Recorder {
            inner: &scene.geometry,
            rays: RefCell::default(),
        },
        lights: scene.lights,
        background: scene.background,
        ambient: scene.ambient,
    };
    let mut tracer = Tracer::<DEPTH, Exact>::new();
    tracer.depth = 4;
    for y in 0..view.height {
        row(&recorded, view, y, &mut tracer).for_each(drop);
    }
    let towards = |ray: Ray| {
        let off = |light: &L| (ray.at(ray.t_max) - light.position()).length_squared();
        let lights = scene.lights.iter().map(off).enumerate();
        let (light, _) = lights.min_by(|a, b| a.1.total_cmp(&b.1)).expect("a light");
        (light, ray)
    };
    let rays: Vec<_> = recorded.geometry.rays.into_inner();
    let rays: Vec<(usize, Ray)> = rays.into_iter().map(towards).collect();
    let lights: Vec<Light> = scene
        .lights
        .iter()
        .map(|it| Light {
            position: it.position(),
            color: it.color(),
        })
        .collect();

    let all: Vec<usize> = (0..balls.len()).collect();
    let plain: Vec<_> = rays.iter().map(|it| passes(balls, &all, &it.1)).collect();
    let every: usize = plain.iter().map(|it| it.1).sum();
    let mut lines = Vec::new();
    let mut line = |method: &str, cells, bytes, tests: &[[usize; 2]]| {
        let sum = |which: usize| tests.iter().map(|it| it[which]).sum::<usize>() as f64;
        let idle = tests.iter().filter(|it| it[0] == 0).count() as f64;
        let share = |part: f64, of: usize| (part / of as f64 * 1e4).round() / 1e4;
        lines.push(Buffered {
            scene: name.into(),
            spheres: balls.len(),
            lights: lights.len(),
            method: method.into(),
            cells,
            bytes,
            rays: rays.len(),
            tests: share(sum(0), rays.len()),
            bounds: share(sum(1), rays.len()),
            saved: share(every as f64 - sum(0) - sum(1), every),
            idle: share(idle, rays.len()),
        });
    };
    let tests: Vec<_> = plain.iter().map(|it| [it.1, 0]).collect();
    line(PLAIN, 0, 0, &tests);
    for (method, cells, bytes, order) in orders(balls, &lights) {
        let tests = rays.iter().zip(&plain).map(|((light, ray), plain)| {
            let (passed, tests) = passes(balls, &order(*light, ray), ray);
            assert!(passed == plain.0, "{name}, {method}: {ray:?}");
            [tests, 0]
        });
        line(method, cells, bytes, &tests.collect::<Vec<_>>());
    }
    let (bytes, tests) = by_tree(balls, rays.iter().map(|it| &it.1), &plain);
    line(TREE, 0, bytes, &tests);
    lines
}

/// Light buffers of both kinds, of several sizes.
fn orders<'a, M>(
    balls: &'a [Object<'_, Sphere, M>],
    lights: &[Light],
) -> Vec<(&'static str, usize, usize, Order<'a>)> {
    let mut all = Vec::new();
    macro_rules! bits {
        ($width:ty: $($cells:literal),*) => {{$(
            let new = |light: &Light| LightBuffer::<$width, $cells>::new(*light, balls);
            let buffers: Vec<_> = lights.iter().map(new).collect();
            let bytes = size_of_val(&buffers[0]) - size_of::<Light>();
            let order: Order<'a> = Box::new(move |light, ray| {
                let mut among = buffers[light].candidates(ray.direction, ray.t_max);
                let mut onward = Candidates::ALL;
                // As the tracer does.
                if let Some(left) = ray.departure {
                    among = among.with(left.object);
                    if let Some(ball) = balls.get(left.object) {
                        onward = Culled(from_ref(ball)).onward(left, left.object);
                    }
                }
                let is_tested = |&it: &usize| among.contain(it) && onward.contain(it);
                (0..balls.len()).filter(is_tested).collect()
            });
            all.push((BITS, $cells, lights.len() * bytes, order));
        )*}};
    }
    match balls.len() {
        ..=7 => bits!(i8: 8, 64, 512, 4096),
        8..=15 => bits!(i16: 8, 64, 512, 4096),
        _ => bits!(i32: 8, 64, 512, 4096),
    }
    for side in [1, 2, 4, 8, 16, 32] {
        let cube = |light: &Light| Cube::new(light.position, balls, side);
        let cubes: Vec<_> = lights.iter().map(cube).collect();
        let bytes = cubes.iter().map(|it| it.bytes(balls.len())).sum();
        let order: Order<'a> = Box::new(move |light, ray| cubes[light].order(balls, ray));
        all.push((LISTS, 6 * side * side, bytes, order));
    }
    all
}

/// Bytes, and tests of spheres and of bounds for each ray.
fn by_tree<'r, M: Finish>(
    balls: &[Object<'_, Sphere, M>],
    rays: impl Iterator<Item = &'r Ray>,
    plain: &[(Option<ShareOf<M>>, usize)],
) -> (usize, Vec<[usize; 2]>)
where
    ShareOf<M>: PartialEq,
{
    let bounds: Vec<_> = balls.iter().map(|it| it.shape.bounds()).collect();
    // As `whitted bake` builds them.
    let costs = Costs {
        ray: 25.0,
        node: 95.0,
        object: 30.0,
    };
    let settings = Settings {
        costs,
        leaf: 16,
        depth: 16,
    };
    let tree = Tree::new(&bounds, settings).expect("some spheres");
    let nodes = tree.balls(|it| balls[it].shape.balls()).expect("balls");
    let bytes = size_of_val(&*nodes) + 2 * balls.len() * index(balls.len());
    let child = |it: &Child<Ball>| Child {
        bound: Counted(it.bound),
        link: it.link,
    };
    let nodes: Vec<_> = nodes
        .iter()
        .map(|it| Node(it.0.each_ref().map(child)))
        .collect();
    let counted = |&place: &u32| {
        let ball = &balls[place as usize];
        Object {
            shape: Counted(ball.shape),
            material: ball.material,
        }
    };
    let objects: Vec<_> = tree.places.iter().map(counted).collect();
    let wide = |it: Vec<u32>| -> Vec<usize> { it.into_iter().map(|it| it as usize).collect() };
    let (places, slots) = (wide(tree.places.clone()), wide(tree.slots()));
    let tree = Hierarchy::<_, _, _, 16, usize>::new(&nodes, &objects, &places, &slots, tree.slack)
        .expect("a tree");
    let tests = rays.zip(plain).map(|(ray, plain)| {
        TESTS.with(|it| it.iter().for_each(|it| it.set(0)));
        let mut light = AttenuationBy::<M>::default();
        let ends = tree.absorbs::<Exact, _>(ray, 0, Candidates::ALL, &mut light);
        let passed = (!ends).then(|| light.share());
        assert!(passed == plain.0, "by the hierarchy: {ray:?}");
        TESTS.with(|it| it.each_ref().map(Cell::get))
    });
    let tests = tests.collect();
    (bytes, tests)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the lab has committed is what it measures, and whose answers differ it does not survive.
    #[test]
    fn the_committed_table_is_what_is_counted() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/charts/light-buffer.csv");
        let committed: Vec<Buffered> =
            crate::lab::cycles::read(std::path::Path::new(path)).expect("a table");
        assert_eq!(run(&|_, _| {}), committed, "lab rewrites it");
    }
}
