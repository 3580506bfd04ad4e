//! A fixed-function ray caster for machines with tens of KiB.
//!
//! `no_std`, no heap, no recursion, no panics. A scene is plain data that can lie in flash, and its
//! type names what it uses: the primitives, whether anything mirrors or refracts, whether lights
//! cast shadows. What the type does not name is not compiled. Every result has the same bits on
//! every target.
//!
//! ```
//! use whitted::{Camera, Light, Material, Object, Plane, Scene, Sphere, Tracer, Vec3, View};
//!
//! static CLAY: Material = Material::matte(Vec3::new(0.8, 0.3, 0.2), 0.1, 0.9);
//! static STONE: Material = Material::matte(Vec3::new(0.5, 0.5, 0.5), 0.1, 0.9);
//! static BALLS: [Object<Sphere>; 1] = [Object {
//!     shape: Sphere { center: Vec3::new(0.0, 1.0, -4.0), radius: 1.0 },
//!     material: &CLAY,
//! }];
//! static FLOOR: [Object<Plane>; 1] = [Object {
//!     shape: Plane { point: Vec3::ZERO, normal: Vec3::Y },
//!     material: &STONE,
//! }];
//! static LIGHTS: [Light; 1] = [Light { position: Vec3::new(3.0, 5.0, 0.0), color: Vec3::ONE }];
//! static SCENE: Scene<(&[Object<Sphere>], &[Object<Plane>])> = Scene {
//!     geometry: (&BALLS, &FLOOR),
//!     lights: &LIGHTS,
//!     background: Vec3::new(0.2, 0.3, 0.5),
//!     ambient: Vec3::ONE,
//! };
//!
//! let camera = Camera::look_at(Vec3::Y, Vec3::new(0.0, 1.0, -4.0), Vec3::Y, 0.5, 1.0)?;
//! let view = View { camera, width: 16, height: 16 };
//! let mut tracer = Tracer::<1>::new();
//! let red = view.rays(8).map(|ray| tracer.radiance(&SCENE, ray).x).fold(0.0, f32::max);
//! assert!(red > 0.5);
//! # Ok::<(), whitted::CameraError>(())
//! ```
//!
//! [`firmware`] leads from nothing to a picture on a panel.
//!
//! # Policies
//!
//! These hold on every target and for every input, also for input that no constructor accepts.
//!
//! - A ray meets what lies in the open interval `0 < t < t_max`; the nearest wins, and of equals the
//!   first in geometry order (left of a pair, then slice order).
//! - Touching a sphere, a frustum, a quadric or a box counts as a hit. Of two polygons that share an edge, a ray
//!   through the edge meets exactly one.
//! - A surface left by a ray is not met again at the point that it leaves, however the arithmetic
//!   rounds: [`Ray::departure`] says which surface, and on which side.
//! - Whatever is not a number is not hit, and lights nothing.
//!
//! # Range
//!
//! Pictures do not change by a bit when every length is multiplied by 2^k for |k| up to 40, for
//! scenes whose sizes and distances lie within 2^-8 to 2^16 before that. Beyond this range squares
//! of lengths leave `f32`: what is then missed or hit is unspecified, though never a panic.

#![no_std]
#![deny(missing_docs)]
// One exception, `math`: inline assembly, most of it for square roots.
#![deny(unsafe_code)]

pub mod antialiasing;
pub mod area;
pub mod camera;
pub mod candidates;
pub mod columns;
pub mod csg;
#[doc = include_str!("../FIRMWARE.md")]
pub mod firmware {}
pub mod geometry;
pub mod grid;
pub mod hierarchy;
pub mod instance;
pub mod material;
pub mod math;
pub mod maze;
pub mod pattern;
pub mod picture;
#[cfg(test)]
mod random;
pub mod ray;
pub mod scene;
pub mod shape;
mod subdivision;
pub mod trace;

pub use embedded_graphics;

pub use area::AreaLight;
pub use camera::{Camera, CameraError, View};
pub use candidates::{Beam, Candidates, Culled, LightBuffer};
pub use csg::Csg;
pub use geometry::{Geometry, Object, Objects};
pub use glam::Vec3;
pub use grid::Grid;
pub use hierarchy::{Hierarchy, Node};
pub use instance::{Instance, Placement, PlacementError};
pub use material::{Absorbing, Finish, Glass, Material, Mirror, Phong, PhongReal, Tinted};
pub use math::{Exact, Math, Micro};
pub use maze::Maze;
pub use pattern::{Checker, ImageMap, Pattern, Stripes, Varying};
pub use picture::Picture;
pub use ray::{Departure, Hit, Ray, Side};
pub use scene::{FillLight, Light, LightSource, Scene};
pub use shape::cuboid::{Cuboid, CuboidError};
pub use shape::frustum::{Frustum, FrustumError};
pub use shape::patch::{Patch, PatchError};
pub use shape::plane::{Plane, PlaneError};
pub use shape::polygon::{Polygon, PolygonError};
pub use shape::quadric::{Clip, Ends, Quadric, QuadricError};
pub use shape::sphere::{Sphere, SphereError};
pub use shape::torus::{Torus, TorusError};
pub use shape::triangle::Triangle;
pub use shape::{Closed, Shape};
pub use trace::{Count, Counters, Event, Tracer};
