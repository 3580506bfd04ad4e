//! Hierarchies answer as the plain slice does, to the bit.
//!
//! Scenes made to be awkward (duplicates, dense overlaps, boxes on a grid, edge-on and warped
//! outlines, needles), rays made to be awkward (grazing, along axes, from far away, from surfaces,
//! not numbers), at four scales, from one seed.

use std::f32::consts::TAU;

use glam::{DVec3, Vec3};
use whitted::hierarchy::{Aabb, Ball, Bound, Node, Solid};
use whitted::{
    Cuboid, Exact, Frustum, Geometry, Glass, Hierarchy, Material, Math, Object, Patch, Polygon,
    Ray, Shape, Sphere, Triangle,
};
use whitted_cli::hierarchy::{Bounded, Bounds, Costs, Settings, Tree};

/// G. L. Steele, D. Lea, C. H. Flood, "Fast Splittable Pseudorandom Number Generators", OOPSLA 2014.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }

    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * ((self.next() >> 40) as f32 / (1 << 24) as f32)
    }

    /// Down to a ten-thousandth of `most`, all orders of magnitude alike.
    fn size(&mut self, most: f32) -> f32 {
        most * 10.0_f32.powf(self.between(-4.0, 0.0))
    }

    fn point(&mut self, reach: f32) -> Vec3 {
        Vec3::from_array(std::array::from_fn(|_| self.between(-reach, reach)))
    }

    fn unit(&mut self) -> Vec3 {
        loop {
            let v = self.point(1.0);
            if (0.01..1.0).contains(&v.length_squared()) {
                return Exact::normalize(v);
            }
        }
    }

    fn choose<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }
}

/// Shapes, and points of them at which to aim.
struct Scene<S> {
    shapes: Vec<S>,
    targets: Vec<Vec3>,
}

/// Of the scenes' extent: coordinates are up to about this.
const SCALES: [f32; 4] = [
    1.0,
    1.0 / (1_u64 << 40) as f32,
    (1_u64 << 30) as f32,
    1000.0,
];

const COUNT: usize = 60;

/// The first ten once more, so that there are ties.
fn repeat<S: Clone>(shapes: &mut Vec<S>) {
    shapes.extend_from_within(..10);
}

fn spheres(random: &mut Random, scale: f32) -> Scene<Sphere> {
    let spread = scale * random.choose(&[1.0, 0.1]);
    let mut shapes: Vec<_> = (0..COUNT)
        .map(|_| Sphere {
            center: random.point(spread),
            radius: random.size(0.5 * scale) * random.choose(&[1.0, 1.0, 1.0, -1.0]),
        })
        .collect();
    repeat(&mut shapes);
    let targets = shapes.iter().flat_map(|it| {
        let size = it.radius.abs();
        let top = it.center + Vec3::splat(size);
        [
            top,
            it.center + random.unit() * size,
            it.center + Vec3::X * size,
        ]
    });
    Scene {
        targets: targets.collect(),
        shapes,
    }
}

fn cuboids(random: &mut Random, scale: f32) -> Scene<Cuboid> {
    let mut shapes = Vec::new();
    for i in 0..COUNT {
        let min = random.point(scale);
        let mut size = (random.point(0.5) + 0.5) * random.size(0.5 * scale);
        if i % 5 == 0 {
            size.y = 0.0;
        }
        shapes.push(Cuboid {
            min,
            max: min + size,
        });
    }
    repeat(&mut shapes);
    // Neighbors that share faces, edges and corners.
    for i in 0..27 {
        let cell = Vec3::new((i % 3) as f32, (i / 3 % 3) as f32, (i / 9) as f32);
        shapes.push(Cuboid {
            min: cell * scale * 0.25,
            max: (cell + 1.0) * scale * 0.25,
        });
    }
    let targets = shapes.iter().flat_map(|it| {
        let middle = (it.min + it.max) * 0.5;
        let corner = Vec3::new(it.min.x, it.max.y, it.min.z);
        let edge = Vec3::new(it.min.x, middle.y, it.max.z);
        [it.min, it.max, middle, corner, edge]
    });
    Scene {
        targets: targets.collect(),
        shapes,
    }
}

fn triangles(random: &mut Random, scale: f32) -> Scene<Triangle> {
    let mut shapes = Vec::new();
    while shapes.len() < COUNT {
        let first = random.point(scale);
        let size = random.size(0.5 * scale);
        // Now and then a needle.
        let width = size * random.choose(&[1.0, 1.0, 1e-4]);
        let second = first + random.point(size);
        let third = second + random.point(width);
        shapes.extend(Triangle::new([first, second, third]));
    }
    repeat(&mut shapes);
    // A mesh with small waves, met edge-on by what skims it.
    let vertex = |i: usize, j: usize| {
        let height = ((i * 7 + j * 3) % 5) as f32 * 0.01;
        Vec3::new(i as f32 * 0.1, height, j as f32 * 0.1) * scale
    };
    for (i, j) in (0..25).map(|it| (it % 5, it / 5)) {
        let [a, b, c, d] =
            [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)].map(|(i, j)| vertex(i, j));
        shapes.extend(Triangle::new([a, b, c]));
        shapes.extend(Triangle::new([b, d, c]));
    }
    let targets = shapes.iter().flat_map(|it| {
        let [a, b, c] = it.vertices;
        [a, b, c, (a + b) * 0.5, (a + b + c) / 3.0]
    });
    Scene {
        targets: targets.collect(),
        shapes,
    }
}

fn patches(random: &mut Random, scale: f32) -> Scene<Patch> {
    let Scene { shapes, targets } = triangles(random, scale);
    let patch = |it: &Triangle| {
        let normals = [random.unit(), random.unit(), random.unit()];
        Patch::new(it.vertices, normals).unwrap()
    };
    Scene {
        shapes: shapes.iter().map(patch).collect(),
        targets,
    }
}

/// Stars with up to nine points, off their planes by as much as is accepted.
fn outlines(random: &mut Random, scale: f32) -> Vec<Vec<Vec3>> {
    let mut outlines = Vec::new();
    while outlines.len() < COUNT {
        let (center, x, size) = (random.point(scale), random.unit(), random.size(0.5 * scale));
        let y = Exact::normalize(x.cross(random.unit()));
        let count = 3 + random.below(7);
        let warp = random.choose(&[0.0, 2e-5]);
        let outline: Vec<_> = (0..count)
            .map(|i| {
                let (sin, cos) = (i as f32 * TAU / count as f32).sin_cos();
                let radius = size * random.between(0.3, 1.0);
                center + (x * cos + y * sin) * radius + random.point(warp * size)
            })
            .collect();
        if Polygon::new(&outline).is_ok() {
            outlines.push(outline);
        }
    }
    outlines
}

fn polygons(outlines: &[Vec<Vec3>]) -> Scene<Polygon<'_>> {
    let mut shapes: Vec<_> = outlines
        .iter()
        .map(|it| Polygon::new(it).unwrap())
        .collect();
    repeat(&mut shapes);
    let targets = outlines.iter().flat_map(|it| {
        let middle = (it[0] + it[1]) * 0.5;
        let center = it.iter().sum::<Vec3>() / it.len() as f32;
        it.iter().copied().chain([middle, center])
    });
    Scene {
        targets: targets.collect(),
        shapes,
    }
}

/// From needles to discs, cylinders, cones with tips, and hollow ones.
fn frusta(random: &mut Random, scale: f32) -> Scene<Frustum> {
    let mut shapes = Vec::new();
    while shapes.len() < COUNT {
        let base = random.point(scale);
        let (length, radius) = (random.size(0.5 * scale), random.size(0.5 * scale));
        let other = random.size(0.5 * scale);
        let other = random.choose(&[radius, 0.0, other, other]);
        let sign = random.choose(&[1.0, 1.0, 1.0, -1.0]);
        let axis = random.unit();
        let axis = random.choose(&[axis, axis, Vec3::Y]);
        shapes.extend(Frustum::new(
            base,
            sign * radius,
            base + axis * length,
            sign * other,
        ));
    }
    repeat(&mut shapes);
    let targets = shapes.iter().flat_map(|it| {
        let across = it.axis.any_orthonormal_vector();
        let apex = it.base + it.axis * it.length;
        let apex_radius = it.base_radius + it.slope * it.length;
        [
            apex,
            it.base + it.axis * (0.5 * it.length),
            it.base + across * it.base_radius,
            apex + across * apex_radius,
        ]
    });
    Scene {
        targets: targets.collect(),
        shapes,
    }
}

/// A ray at the shapes, or past them.
fn ray(random: &mut Random, targets: &[Vec3], scale: f32) -> Ray {
    let target = random.choose(targets);
    let target = match random.below(4) {
        0 => random.point(scale),
        1 => target,
        2 => target + random.point(1e-6 * scale),
        _ => target + random.point(1e-3 * scale),
    };
    let far = scale * random.choose(&[1e6, 1e3, 10.0, 1.5]);
    let mut origin = match random.below(4) {
        0 => random.point(scale),
        1 => random.choose(targets),
        _ => random.unit() * far,
    };
    let mut direction = target - origin;
    match random.below(12) {
        0 => direction.x = 0.0,
        1 => direction.y = -0.0,
        2 => (direction.x, direction.z) = (-0.0, 0.0),
        3 => direction = random.unit(),
        4 => {
            direction = random.choose(&[Vec3::X, Vec3::NEG_Y, Vec3::Z]);
            origin = target - direction * far;
        }
        _ => {}
    }
    if direction == Vec3::ZERO || !direction.is_finite() {
        direction = Vec3::X;
    }
    // At small scales squares leave the range.
    let mut ray = Ray::new(
        origin,
        Exact::normalize(direction / direction.abs().max_element()),
    );
    if random.below(3) == 0 {
        ray.t_max = (target - origin).length() * random.between(0.2, 1.7);
    }
    match random.below(300) {
        0 => ray.origin.x = f32::NAN,
        1 => ray.direction.y = f32::NAN,
        2 => ray.origin.z = f32::INFINITY,
        3 => ray.t_max = f32::NAN,
        4 => ray.direction = Vec3::NAN,
        _ => {}
    }
    ray
}

type Clear = Material<(), (), Glass>;

/// Rays that the two geometries answer differently, of how many, and how many hits there were.
#[derive(Debug, Default)]
struct Tally {
    rays: usize,
    hits: usize,
    differing: usize,
}

/// Casts rays, and from where they hit others, into the plain slice and into the hierarchy.
fn compare<S, B>(
    name: &str,
    scene: &Scene<S>,
    scale: f32,
    rays: usize,
    random: &mut Random,
    nodes: impl Fn(&mut Tree, &[S]) -> Vec<Node<B>>,
) -> Tally
where
    S: Shape + Bounded + Copy,
    B: Bound<S> + Copy,
{
    let clear = |transmittance| Clear {
        color: Vec3::ONE,
        ambient: 0.0,
        diffuse: 0.0,
        highlight: (),
        reflection: (),
        transmission: Glass {
            transmittance,
            ior: 1.5,
        },
    };
    let materials = [0.0, 1.0, 0.5, 0.9, 0.25].map(clear);
    let object = |(i, &shape): (usize, &S)| Object {
        shape,
        material: &materials[if i % 7 == 0 { 0 } else { 1 + i % 4 }],
    };
    let objects: Vec<_> = scene.shapes.iter().enumerate().map(object).collect();
    let mut tree = tree_of(&scene.shapes, settings(4, 64)).unwrap();
    let nodes = nodes(&mut tree, &scene.shapes);
    let in_leaves: Vec<_> = tree.places.iter().map(|&it| objects[it as usize]).collect();
    let places: Vec<usize> = tree.places.iter().map(|&it| it as usize).collect();
    let slots: Vec<usize> = tree.slots().iter().map(|&it| it as usize).collect();
    let hierarchy =
        Hierarchy::<_, _, _, 64, usize>::new(&nodes, &in_leaves, &places, &slots, tree.slack)
            .unwrap();
    // Behind others, so that places are counted from 3.
    let elsewhere = [Object {
        shape: Sphere {
            center: Vec3::splat(1e9 * scale),
            radius: scale,
        },
        material: &materials[0],
    }; 3];
    let flat = (elsewhere.as_slice(), objects.as_slice());
    let tree = (elsewhere.as_slice(), hierarchy);

    let mut tally = Tally::default();
    while tally.rays < rays {
        let mut ray = ray(random, &scene.targets, scale);
        for _ in 0..4 {
            tally.rays += 1;
            let (a, b) = (flat.closest_hit(&ray), tree.closest_hit(&ray));
            let bits = |v: Vec3| v.to_array().map(f32::to_bits);
            let same_hit = match (&a, &b) {
                (Some(a), Some(b)) => {
                    a.t.to_bits() == b.t.to_bits()
                        && (a.object, a.front) == (b.object, b.front)
                        && bits(a.normal) == bits(b.normal)
                        && std::ptr::eq(a.material, b.material)
                }
                (None, None) => true,
                _ => false,
            };
            let light = [flat.transmittance(&ray), tree.transmittance(&ray)];
            if !same_hit
                || flat.occluded(&ray) != tree.occluded(&ray)
                || light[0].to_bits() != light[1].to_bits()
            {
                tally.differing += 1;
                if tally.differing < 3 {
                    let hits = [a, b].map(|it| it.map(|it| (it.t, it.object)));
                    println!("{name}: {ray:?} meets {hits:?}, light {light:?}");
                }
            }
            let Some(hit) = a else { break };
            tally.hits += 1;
            let direction = random.unit();
            ray = if direction.dot(hit.normal) > 0.0 {
                hit.back(direction)
            } else {
                hit.through(direction)
            };
            if random.below(2) == 0 {
                ray.t_max = random.between(0.0, 2.0 * scale);
            }
        }
    }
    tally
}

fn settings(leaf: usize, depth: usize) -> Settings {
    let costs = Costs {
        ray: 0.0,
        node: 1.0,
        object: 1.0,
    };
    Settings { costs, leaf, depth }
}

fn tree_of<S: Bounded>(shapes: &[S], settings: Settings) -> Option<Tree> {
    let bounds: Vec<_> = shapes.iter().map(|it| it.bounds()).collect();
    Tree::new(&bounds, settings)
}

fn boxes<S>(tree: &mut Tree, _: &[S]) -> Vec<Node<Aabb>> {
    tree.boxes()
}

fn balls<S: Bounded + Solid>(tree: &mut Tree, shapes: &[S]) -> Vec<Node<Ball>> {
    tree.balls(|place| shapes[place].balls()).unwrap()
}

const RAYS: usize = 40_000;

/// At every scale, in `B`s.
fn assert_same<S, B>(
    name: &str,
    scene: impl Fn(&mut Random, f32) -> Scene<S>,
    nodes: impl Fn(&mut Tree, &[S]) -> Vec<Node<B>> + Copy,
) where
    S: Shape + Bounded + Copy,
    B: Bound<S> + Copy,
{
    for (seed, scale) in (1..).zip(SCALES) {
        let random = &mut Random(seed);
        let scene = scene(random, scale);
        let tally = compare(name, &scene, scale, RAYS, random, nodes);
        assert_eq!(tally.differing, 0, "{name} at {scale:e}: {tally:?}");
        assert!(
            tally.hits > tally.rays / 10,
            "{name} at {scale:e}: hardly anything is hit: {tally:?}"
        );
    }
}

#[test]
fn spheres_in_boxes_and_balls() {
    assert_same("sphere, box", spheres, boxes);
    assert_same("sphere, ball", spheres, balls);
}

#[test]
fn cuboids_in_boxes_and_balls() {
    assert_same("cuboid, box", cuboids, boxes);
    assert_same("cuboid, ball", cuboids, balls);
}

#[test]
fn frusta_in_boxes_and_balls() {
    assert_same("frustum, box", frusta, boxes);
    assert_same("frustum, ball", frusta, balls);
}

#[test]
fn triangles_in_boxes() {
    assert_same("triangle", triangles, boxes);
}

#[test]
fn patches_in_boxes() {
    assert_same("patch", patches, boxes);
}

#[test]
fn polygons_in_boxes() {
    for (seed, scale) in (1..).zip(SCALES) {
        let random = &mut Random(seed);
        let outlines = outlines(random, scale);
        let tally = compare("polygon", &polygons(&outlines), scale, RAYS, random, boxes);
        assert_eq!(tally.differing, 0, "polygon at {scale:e}: {tally:?}");
        assert!(tally.hits > tally.rays / 10, "{tally:?}");
    }
}

/// The margins are what keeps the promise: without them rays are answered differently.
#[test]
fn without_margins_hits_are_lost() {
    let random = &mut Random(1);
    let bare_boxes = |tree: &mut Tree, _: &[Cuboid]| {
        tree.slack = 0.0;
        tree.boxes()
    };
    let tally = compare(
        "bare boxes",
        &cuboids(random, 1.0),
        1.0,
        RAYS,
        random,
        bare_boxes,
    );
    assert!(tally.differing > 10, "{tally:?}");
    let bare_balls = |tree: &mut Tree, shapes: &[Sphere]| {
        tree.slack = 0.0;
        balls(tree, shapes)
    };
    let tally = compare(
        "bare balls",
        &spheres(random, 1.0),
        1.0,
        RAYS,
        random,
        bare_balls,
    );
    assert!(tally.differing > 10, "{tally:?}");
}

/// How far the ray's line passes from a box, by the greatest coordinate.
fn line_to_box(ray: &Ray, bounds: &Bounds) -> f64 {
    let beside = |t: f64| outside(ray.origin.as_dvec3() + ray.direction.as_dvec3() * t, bounds);
    let reach = ray.origin.as_dvec3().abs().max_element() + greatest(bounds);
    // The distance is a convex function of t, and least near the box.
    let (mut low, mut high) = (-4.0 * reach, 4.0 * reach);
    for _ in 0..200 {
        let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if beside(a) < beside(b) {
            high = b;
        } else {
            low = a;
        }
    }
    beside((low + high) / 2.0)
}

/// How far a point is outside of a box, by its greatest coordinate.
fn outside(point: DVec3, bounds: &Bounds) -> f64 {
    let (below, above) = (bounds.min.as_dvec3() - point, point - bounds.max.as_dvec3());
    below.max(above).max_element().max(0.0)
}

fn greatest(bounds: &Bounds) -> f64 {
    f64::from(bounds.min.abs().max(bounds.max.abs()).max_element())
}

/// What the proof in `whitted::hierarchy` rests on: how far off its bounds a shape is met, in shares of
/// the slack. The worst over rays that are aimed at where methods fail.
fn worst_share<S: Shape + Bounded + Copy>(
    solid: bool,
    scenes: impl Fn(&mut Random, f32) -> Scene<S>,
) -> f64 {
    let mut worst = 0.0_f64;
    let mut hits = 0;
    for seed in 1..=40 {
        let random = &mut Random(seed);
        let scene = scenes(random, 1.0);
        for _ in 0..10_000 {
            let index = random.below(scene.shapes.len());
            let shape = scene.shapes[index];
            // Each shape has as many targets as any other, in the same order.
            let each = scene.targets.len() / scene.shapes.len();
            let ray = ray(random, &scene.targets[index * each..][..each], 1.0);
            let Some(t) = shape.intersect::<Exact>(&ray, &S::setup(&ray), None) else {
                continue;
            };
            hits += 1;
            let bounds = shape.bounds();
            let start = ray.origin.as_dvec3();
            let point = start + ray.direction.as_dvec3() * f64::from(t);
            let off = if solid {
                outside(point, &bounds)
            } else {
                // Only along the axis to which the ray is closest.
                let steps = ray.direction.abs();
                let axis = (0..3)
                    .max_by(|&a, &b| steps[a].total_cmp(&steps[b]))
                    .unwrap();
                let (low, high) = (f64::from(bounds.min[axis]), f64::from(bounds.max[axis]));
                let along = (low - point[axis]).max(point[axis] - high).max(0.0);
                along.max(line_to_box(&ray, &bounds))
            };
            let allowed = f64::from(bounds.slack) * (start.abs().max_element() + greatest(&bounds));
            worst = worst.max(off / allowed);
        }
    }
    assert!(hits > 40_000, "{hits} hits say little");
    worst
}

#[test]
fn hits_lie_within_half_the_slack_of_the_bounds() {
    let worst = [
        ("sphere", worst_share(true, spheres)),
        ("cuboid", worst_share(true, cuboids)),
        ("frustum", worst_share(true, frusta)),
        ("triangle", worst_share(false, triangles)),
        ("patch", worst_share(false, patches)),
    ];
    println!("share of the slack that is used: {worst:.4?}");
    for (name, share) in worst {
        assert!(share < 0.5, "{name}: {share}");
    }
}

#[test]
fn trees_hold_each_object_once_in_boxes_that_hold_it() {
    let random = &mut Random(7);
    let scene = spheres(random, 1.0);
    for leaf in [1, 4, 127] {
        let build = || tree_of(&scene.shapes, settings(leaf, 64)).unwrap();
        let tree = build();
        let mut places = tree.places.clone();
        places.sort_unstable();
        assert!(places.iter().copied().eq(0..scene.shapes.len() as u32));
        for branch in tree.nodes.iter().flatten() {
            let Some(slots) = branch.link.objects() else {
                continue;
            };
            assert!(slots.len() <= leaf);
            for &place in &tree.places[slots] {
                let bounds = scene.shapes[place as usize].bounds();
                assert!(branch.min.cmple(bounds.min).all() && bounds.max.cmple(branch.max).all());
            }
        }
        assert_eq!(tree, build(), "built twice");
    }
}

#[test]
fn trees_stay_as_shallow_as_asked() {
    // Each is twice as far as the one before: the heuristic alone takes them off one by one.
    let row: Vec<_> = (0..100)
        .map(|i| Sphere {
            center: Vec3::X * 1.2_f32.powi(i),
            radius: 0.01,
        })
        .collect();
    let same = vec![row[0]; 100];
    let build = |spheres: &[Sphere], depth| tree_of(spheres, settings(1, depth)).unwrap().depth;
    assert!(build(&row, 64) > 12, "not a hard case");
    assert_eq!(build(&row, 9), 9);
    assert_eq!(build(&row, 7), 7);
    assert_eq!(build(&row, 1), 7, "no tree of 100 is shallower");
    assert_eq!(build(&same, 64), 7);
    assert_eq!(tree_of(&row[..1], settings(1, 9)), None);
}
