//! Peers that are crates: obvhs, bvh, parry3d and tinybvh-rs.
//!
//! The first three bring hierarchies and leave spheres and boxes to their users, who get the plain
//! functions below, compiled into their traversal.

use std::time::Duration;

use ::bvh::aabb::{Aabb, Bounded};
use ::bvh::bounding_hierarchy::BHShape;
use ::bvh::bvh::Bvh;
use glam::{Vec3, Vec3A};
use nalgebra::{Point3, Vector3};
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::cwbvh::CwBvh;
use parry3d::bounding_volume::Aabb as ParryAabb;
use parry3d::partitioning::{Bvh as ParryBvh, BvhBuildStrategy, TraversalAction};
use parry3d::query::RayCast;
use parry3d::shape::{Ball, Cuboid as ParryCuboid, Triangle as ParryTriangle};
use tinybvh_rs::Intersector;
use whitted::Ray;

use crate::peer::{Peer, START};
use crate::workload::{Answer, Shapes};

/// What users of a hierarchy write for its leaves.
#[derive(Clone, Debug)]
enum Leaves {
    Spheres(Vec<(Vec3, f32)>),
    Triangles(Vec<obvhs::triangle::Triangle>),
    Boxes(Vec<[Vec3; 2]>),
}

impl Leaves {
    fn new(shapes: &Shapes) -> Self {
        match shapes {
            Shapes::Spheres(list) => Self::Spheres(
                list.iter()
                    .map(|it| (it.shape.center, it.shape.radius))
                    .collect(),
            ),
            Shapes::Triangles(list) => Self::Triangles(
                list.iter()
                    .map(|it| {
                        let [v0, v1, v2] = it.shape.vertices.map(Vec3A::from);
                        obvhs::triangle::Triangle { v0, v1, v2 }
                    })
                    .collect(),
            ),
            Shapes::Cuboids(_) => Self::Boxes(shapes.boxes()),
        }
    }
}

/// Distance to a sphere; infinite for a miss.
#[inline(always)]
fn sphere(center: Vec3, radius: f32, o: Vec3, d: Vec3, from: f32, to: f32) -> f32 {
    let to_center = center - o;
    let b = to_center.dot(d);
    let square = radius * radius - (to_center - d * b).length_squared();
    if square < 0.0 {
        return f32::INFINITY;
    }
    let half = square.sqrt();
    let t = if b - half > from { b - half } else { b + half };
    if t > from && t < to { t } else { f32::INFINITY }
}

/// Distance to a box; infinite for a miss.
#[inline(always)]
fn cuboid([min, max]: [Vec3; 2], o: Vec3, inverse: Vec3, from: f32, to: f32) -> f32 {
    let (a, b) = ((min - o) * inverse, (max - o) * inverse);
    let entry = a.min(b).max_element();
    let exit = a.max(b).min_element();
    let t = if entry > from { entry } else { exit };
    if entry <= exit && t > from && t < to {
        t
    } else {
        f32::INFINITY
    }
}

/// A normal, of any length, where an object was hit.
#[inline(always)]
fn normal(leaves: &Leaves, object: u32, ray: &Ray, t: f32) -> Vec3 {
    match leaves {
        Leaves::Spheres(list) => ray.at(t) - list[object as usize].0,
        Leaves::Triangles(list) => {
            let it = &list[object as usize];
            (it.v1 - it.v0).cross(it.v2 - it.v0).into()
        }
        Leaves::Boxes(list) => {
            let [min, max] = list[object as usize];
            let inverse = ray.direction.recip();
            let (a, b) = ((min - ray.origin) * inverse, (max - ray.origin) * inverse);
            let axis = (0..3).find(|&i| a[i] == t || b[i] == t).unwrap_or(0);
            Vec3::AXES[axis]
        }
    }
}

fn start(ray: &Ray) -> f32 {
    if ray.departure.is_some() { START } else { 0.0 }
}

fn answer(shapes: &Shapes, leaves: &Leaves, ray: &Ray, t: f32, object: u32) -> Answer {
    let normal = normal(leaves, object, ray, t);
    Answer::new(ray, t, object, normal, shapes.material(object))
}

// obvhs.

/// Distance to what a leaf of one of obvhs's trees names.
#[inline(always)]
fn obvhs_leaf(leaves: &Leaves, ray: &obvhs::ray::Ray, object: usize) -> f32 {
    let (o, d) = (ray.origin.into(), ray.direction.into());
    match leaves {
        Leaves::Spheres(list) => {
            let (center, radius) = list[object];
            sphere(center, radius, o, d, ray.tmin, ray.tmax)
        }
        Leaves::Triangles(list) => list[object].intersect(ray),
        Leaves::Boxes(list) => cuboid(
            list[object],
            o,
            ray.inv_direction.into(),
            ray.tmin,
            ray.tmax,
        ),
    }
}

struct Obvhs<'a, T> {
    name: &'static str,
    tree: T,
    /// In the tree's order.
    leaves: Leaves,
    /// The object of each leaf.
    objects: Vec<u32>,
    shapes: &'a Shapes,
}

fn reordered(leaves: &Leaves, objects: &[u32]) -> Leaves {
    fn pick<T: Copy>(list: &[T], objects: &[u32]) -> Vec<T> {
        objects.iter().map(|&it| list[it as usize]).collect()
    }
    match leaves {
        Leaves::Spheres(list) => Leaves::Spheres(pick(list, objects)),
        Leaves::Triangles(list) => Leaves::Triangles(pick(list, objects)),
        Leaves::Boxes(list) => Leaves::Boxes(pick(list, objects)),
    }
}

fn obvhs_boxes(shapes: &Shapes) -> Vec<obvhs::aabb::Aabb> {
    let boxes = shapes.boxes();
    let aabb = |[min, max]: [Vec3; 2]| obvhs::aabb::Aabb::new(min.into(), max.into());
    boxes.into_iter().map(aabb).collect()
}

macro_rules! obvhs_peer {
    ($tree:ty, $build:ident, $build_triangles:expr, $name:literal, $function:ident) => {
        impl Peer for Obvhs<'_, $tree> {
            fn name(&self) -> String {
                self.name.into()
            }

            fn nearest(&self, rays: &[Ray], answers: &mut [Answer]) {
                for (ray, to) in rays.iter().zip(answers) {
                    let cast = obvhs::ray::Ray::new(
                        ray.origin.into(),
                        ray.direction.into(),
                        start(ray),
                        ray.t_max,
                    );
                    let mut hit = obvhs::ray::RayHit::none();
                    let met = self.tree.ray_traverse(cast, &mut hit, |ray, leaf| {
                        obvhs_leaf(&self.leaves, ray, leaf)
                    });
                    *to = if met {
                        let object = self.objects[hit.primitive_id as usize];
                        let leaf = hit.primitive_id;
                        let normal = normal(&self.leaves, leaf, ray, hit.t);
                        Answer::new(ray, hit.t, object, normal, self.shapes.material(object))
                    } else {
                        Answer::MISS
                    };
                }
            }

            fn any(&self, rays: &[Ray], answers: &mut [bool]) {
                for (ray, to) in rays.iter().zip(answers) {
                    let cast = obvhs::ray::Ray::new(
                        ray.origin.into(),
                        ray.direction.into(),
                        start(ray),
                        ray.t_max,
                    );
                    *to = !self
                        .tree
                        .ray_traverse_miss(cast, |ray, leaf| obvhs_leaf(&self.leaves, ray, leaf));
                }
            }
        }

        /// Its tree by its own builder.
        pub fn $function(shapes: &Shapes) -> Result<Box<dyn Peer + '_>, String> {
            let leaves = Leaves::new(shapes);
            let parameters = BvhBuildParams::slow_build();
            let mut time = Duration::ZERO;
            let tree = match &leaves {
                Leaves::Triangles(list) => $build_triangles(list, parameters, &mut time),
                _ => $build(&obvhs_boxes(shapes), parameters, &mut time),
            };
            let objects = tree.primitive_indices.clone();
            Ok(Box::new(Obvhs {
                name: $name,
                leaves: reordered(&leaves, &objects),
                objects,
                tree,
                shapes,
            }))
        }
    };
}

use obvhs::bvh2::builder::{build_bvh2, build_bvh2_from_tris};
use obvhs::cwbvh::builder::{build_cwbvh, build_cwbvh_from_tris};

obvhs_peer!(
    Bvh2,
    build_bvh2,
    build_bvh2_from_tris,
    "obvhs, BVH2",
    obvhs_bvh2
);
obvhs_peer!(
    CwBvh,
    build_cwbvh,
    build_cwbvh_from_tris,
    "obvhs, CWBVH",
    obvhs_cwbvh
);

// bvh.

struct BvhLeaf {
    bounds: Aabb<f32, 3>,
    object: usize,
    node: usize,
}

impl Bounded<f32, 3> for BvhLeaf {
    fn aabb(&self) -> Aabb<f32, 3> {
        self.bounds
    }
}

impl BHShape<f32, 3> for BvhLeaf {
    fn set_bh_node_index(&mut self, index: usize) {
        self.node = index;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}

struct BvhCrate<'a> {
    tree: Bvh<f32, 3>,
    list: Vec<BvhLeaf>,
    leaves: Leaves,
    shapes: &'a Shapes,
}

/// Distance to an object; infinite for a miss.
#[inline(always)]
fn leaf(leaves: &Leaves, object: usize, o: Vec3, d: Vec3, from: f32, to: f32) -> f32 {
    match leaves {
        Leaves::Spheres(list) => {
            let (center, radius) = list[object];
            sphere(center, radius, o, d, from, to)
        }
        Leaves::Triangles(list) => {
            let ray = obvhs::ray::Ray {
                origin: o.into(),
                direction: d.into(),
                inv_direction: Vec3A::ZERO,
                tmin: from,
                tmax: to,
            };
            list[object].intersect(&ray)
        }
        Leaves::Boxes(list) => cuboid(list[object], o, d.recip(), from, to),
    }
}

impl BvhCrate<'_> {
    fn ray(ray: &Ray) -> ::bvh::ray::Ray<f32, 3> {
        ::bvh::ray::Ray::new(
            Point3::from(ray.origin.to_array()),
            Vector3::from(ray.direction.to_array()),
        )
    }
}

impl Peer for BvhCrate<'_> {
    fn name(&self) -> String {
        "bvh".into()
    }

    fn nearest(&self, rays: &[Ray], answers: &mut [Answer]) {
        for (ray, to) in rays.iter().zip(answers) {
            let cast = Self::ray(ray);
            let (mut t, mut object) = (ray.t_max, u32::MAX);
            for it in self.tree.traverse_iterator(&cast, &self.list) {
                let (o, d) = (ray.origin, ray.direction);
                let distance = leaf(&self.leaves, it.object, o, d, start(ray), t);
                if distance < t {
                    (t, object) = (distance, it.object as u32);
                }
            }
            *to = if object == u32::MAX {
                Answer::MISS
            } else {
                answer(self.shapes, &self.leaves, ray, t, object)
            };
        }
    }

    fn any(&self, rays: &[Ray], answers: &mut [bool]) {
        for (ray, to) in rays.iter().zip(answers) {
            let cast = Self::ray(ray);
            *to = self.tree.traverse_iterator(&cast, &self.list).any(|it| {
                let (o, d) = (ray.origin, ray.direction);
                leaf(&self.leaves, it.object, o, d, start(ray), ray.t_max) < ray.t_max
            });
        }
    }
}

/// The bvh crate, by the iterator without a heap.
pub fn bvh(shapes: &Shapes) -> Result<Box<dyn Peer + '_>, String> {
    let mut list: Vec<_> = shapes
        .boxes()
        .into_iter()
        .enumerate()
        .map(|(object, [min, max])| BvhLeaf {
            bounds: Aabb::with_bounds(min.to_array().into(), max.to_array().into()),
            object,
            node: 0,
        })
        .collect();
    Ok(Box::new(BvhCrate {
        tree: Bvh::build(&mut list),
        list,
        leaves: Leaves::new(shapes),
        shapes,
    }))
}

// parry3d.

type ParryVector = parry3d::math::Vector;

fn parry_vector(v: Vec3) -> ParryVector {
    ParryVector::new(v.x, v.y, v.z)
}

fn parry_ray(ray: &Ray) -> parry3d::query::Ray {
    parry3d::query::Ray::new(parry_vector(ray.origin), parry_vector(ray.direction))
}

struct Parry<'a> {
    tree: ParryBvh,
    leaves: Leaves,
    shapes: &'a Shapes,
}

impl Peer for Parry<'_> {
    fn name(&self) -> String {
        "parry3d, Bvh".into()
    }

    fn nearest(&self, rays: &[Ray], answers: &mut [Answer]) {
        for (ray, to) in rays.iter().zip(answers) {
            let cast = parry_ray(ray);
            let t_max = ray.t_max.min(f32::MAX);
            let hit = self.tree.cast_ray(&cast, t_max, |object, t_max| {
                let (o, d) = (ray.origin, ray.direction);
                let t = leaf(&self.leaves, object as usize, o, d, start(ray), t_max);
                (t < t_max).then_some(t)
            });
            *to = match hit {
                None => Answer::MISS,
                Some((object, t)) => answer(self.shapes, &self.leaves, ray, t, object),
            };
        }
    }

    fn any(&self, rays: &[Ray], answers: &mut [bool]) {
        for (ray, to) in rays.iter().zip(answers) {
            let cast = parry_ray(ray);
            let t_max = ray.t_max.min(f32::MAX);
            let mut met = false;
            self.tree.traverse(|node| {
                if node.cast_ray(&cast, t_max) >= t_max {
                    return TraversalAction::Prune;
                }
                if let Some(object) = node.leaf_data() {
                    let (o, d) = (ray.origin, ray.direction);
                    if leaf(&self.leaves, object as usize, o, d, start(ray), t_max) < t_max {
                        met = true;
                        return TraversalAction::EarlyExit;
                    }
                }
                TraversalAction::Continue
            });
            *to = met;
        }
    }
}

/// parry3d's hierarchy.
pub fn parry(shapes: &Shapes) -> Result<Box<dyn Peer + '_>, String> {
    let boxes: Vec<_> = shapes
        .boxes()
        .into_iter()
        .map(|[min, max]| ParryAabb::new(parry_vector(min), parry_vector(max)))
        .collect();
    Ok(Box::new(Parry {
        tree: ParryBvh::from_leaves(BvhBuildStrategy::Binned, &boxes),
        leaves: Leaves::new(shapes),
        shapes,
    }))
}

/// parry3d's own shapes, one after the other: what it offers without a heap.
struct ParryFlat<'a> {
    list: ParryList,
    shapes: &'a Shapes,
}

enum ParryList {
    Spheres(Vec<(ParryVector, Ball)>),
    Triangles(Vec<ParryTriangle>),
    Boxes(Vec<(ParryVector, ParryCuboid)>),
}

impl ParryFlat<'_> {
    /// Calls `visit` with each object's distance and normal, up to what `visit` returned last.
    #[inline(always)]
    fn visit(&self, ray: &Ray, mut visit: impl FnMut(u32, f32, Vec3) -> Option<f32>) {
        let mut cast = parry_ray(ray);
        let from = start(ray);
        let mut t_max = ray.t_max.min(f32::MAX);
        macro_rules! each {
            ($list:expr, $item:pat => $center:expr, $shape:expr) => {
                for (object, $item) in $list.iter().enumerate() {
                    cast.origin = parry_vector(ray.origin) - $center;
                    let hit = $shape.cast_local_ray_and_get_normal(&cast, t_max, false);
                    if let Some(hit) = hit
                        && hit.time_of_impact > from
                    {
                        let normal = Vec3::from_array(hit.normal.to_array());
                        match visit(object as u32, hit.time_of_impact, normal) {
                            Some(nearer) => t_max = nearer,
                            None => return,
                        }
                    }
                }
            };
        }
        match &self.list {
            ParryList::Spheres(list) => each!(list, (center, ball) => *center, ball),
            ParryList::Triangles(list) => each!(list, it => ParryVector::ZERO, it),
            ParryList::Boxes(list) => each!(list, (center, cuboid) => *center, cuboid),
        }
    }
}

impl Peer for ParryFlat<'_> {
    fn name(&self) -> String {
        "parry3d, loop".into()
    }

    fn nearest(&self, rays: &[Ray], answers: &mut [Answer]) {
        for (ray, to) in rays.iter().zip(answers) {
            let mut nearest = (f32::INFINITY, u32::MAX, Vec3::ZERO);
            self.visit(ray, |object, t, normal| {
                if t < nearest.0 {
                    nearest = (t, object, normal);
                }
                Some(nearest.0)
            });
            let (t, object, normal) = nearest;
            *to = if object == u32::MAX {
                Answer::MISS
            } else {
                Answer::new(ray, t, object, normal, self.shapes.material(object))
            };
        }
    }

    fn any(&self, rays: &[Ray], answers: &mut [bool]) {
        for (ray, to) in rays.iter().zip(answers) {
            let mut met = false;
            self.visit(ray, |_, _, _| {
                met = true;
                None
            });
            *to = met;
        }
    }
}

/// parry3d without its hierarchy.
pub fn parry_flat(shapes: &Shapes) -> Result<Box<dyn Peer + '_>, String> {
    let list = match shapes {
        Shapes::Spheres(list) => ParryList::Spheres(
            list.iter()
                .map(|it| (parry_vector(it.shape.center), Ball::new(it.shape.radius)))
                .collect(),
        ),
        Shapes::Triangles(list) => ParryList::Triangles(
            list.iter()
                .map(|it| {
                    let [a, b, c] = it.shape.vertices.map(parry_vector);
                    ParryTriangle::new(a, b, c)
                })
                .collect(),
        ),
        Shapes::Cuboids(list) => ParryList::Boxes(
            list.iter()
                .map(|it| {
                    let (min, max) = (it.shape.min, it.shape.max);
                    let half = parry_vector((max - min) * 0.5);
                    (parry_vector((min + max) * 0.5), ParryCuboid::new(half))
                })
                .collect(),
        ),
    };
    Ok(Box::new(ParryFlat { list, shapes }))
}

// tinybvh.

struct TinyBvh<'a, T> {
    name: &'static str,
    tree: T,
    leaves: Leaves,
    shapes: &'a Shapes,
}

impl<T: Intersector> TinyBvh<'_, T> {
    #[inline(always)]
    fn cast(&self, ray: &Ray) -> tinybvh_rs::Intersection {
        // Its rays start at 0: theirs is moved instead.
        let from = start(ray);
        let origin = ray.origin + ray.direction * from;
        // tinybvh's own rays are longer than those of its crate, and it writes to what they lack.
        #[repr(C, align(64))]
        struct Padded(tinybvh_rs::Ray, [u8; 192]);
        let cast = tinybvh_rs::Ray::new(origin.to_array(), ray.direction.to_array());
        let mut cast = std::hint::black_box(Padded(cast, [0; 192]));
        cast.0.hit.t = (ray.t_max - from).min(tinybvh_rs::INFINITE);
        cast.0.hit.prim = u32::MAX;
        self.tree.intersect(&mut cast.0);
        std::hint::black_box(&cast.1);
        cast.0.hit
    }
}

impl<T: Intersector> Peer for TinyBvh<'_, T> {
    fn name(&self) -> String {
        self.name.into()
    }

    fn nearest(&self, rays: &[Ray], answers: &mut [Answer]) {
        for (ray, to) in rays.iter().zip(answers) {
            let hit = self.cast(ray);
            *to = if hit.prim == u32::MAX {
                Answer::MISS
            } else {
                answer(self.shapes, &self.leaves, ray, hit.t, hit.prim)
            };
        }
    }

    fn any(&self, rays: &[Ray], answers: &mut [bool]) {
        for (ray, to) in rays.iter().zip(answers) {
            *to = self.cast(ray).prim != u32::MAX;
        }
    }
}

/// tinybvh's corners, leaked: its trees refer to them, and a run builds few.
fn tiny_corners(shapes: &Shapes) -> Result<&'static [[f32; 4]], String> {
    match shapes {
        Shapes::Triangles(list) => {
            let corners = list.iter().flat_map(|it| it.shape.vertices);
            let corners: Vec<_> = corners.map(|it| it.extend(0.0).to_array()).collect();
            Ok(corners.leak())
        }
        _ => Err("takes triangles only".into()),
    }
}

/// tinybvh's binary tree.
pub fn tiny(shapes: &Shapes) -> Result<Box<dyn Peer + '_>, String> {
    let corners = tiny_corners(shapes)?;
    let tree = tinybvh_rs::bvh::BVH::new_hq(corners.into()).map_err(|it| it.to_string())?;
    Ok(Box::new(TinyBvh {
        name: "tinybvh, BVH",
        tree,
        leaves: Leaves::new(shapes),
        shapes,
    }))
}

/// tinybvh's tree for AVX2, which its crate offers to programs compiled for AVX2.
#[cfg(target_feature = "avx2")]
pub fn tiny8(shapes: &Shapes) -> Result<Box<dyn Peer + '_>, String> {
    let corners = tiny_corners(shapes)?;
    let fail = |it: tinybvh_rs::Error| it.to_string();
    let mut binary = tinybvh_rs::bvh::BVH::new_hq(corners.into()).map_err(fail)?;
    binary.split_leaves(4);
    let wide = tinybvh_rs::mbvh::BVH::new(&binary);
    let tree = tinybvh_rs::bvh8_cpu::BVH::new(&wide).map_err(fail)?;
    Ok(Box::new(TinyBvh {
        name: "tinybvh, BVH8_CPU",
        tree,
        leaves: Leaves::new(shapes),
        shapes,
    }))
}

/// Not in this build.
#[cfg(not(target_feature = "avx2"))]
pub fn tiny8(_: &Shapes) -> Result<Box<dyn Peer + '_>, String> {
    Err("BVH8_CPU needs a build with -C target-cpu=native".into())
}
