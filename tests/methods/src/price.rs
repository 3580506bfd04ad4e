//! The same calls for everyone who prices the methods.
//!
//! A firmware implements [`Meter`], counts what runs between the start and the end of each closure that
//! it is given, and subtracts what it counted for the method [`EMPTY`] of the same stage and case: the
//! loop, and the call of a function that does nothing. What is left, over `calls`, goes as a line into
//! `tests/charts/cycles.csv`, whose columns are
//!
//! `stage,case,method,target,cycles,instructions,bytes`
//!
//! where `bytes` is the size of all functions that ran for the method and not for the empty one.

use core::hint::black_box;

use glam::Vec3;
use whitted::pattern::Spot;
use whitted::{
    Checker, Cuboid, Ends, Exact, Frustum, Grid, Math, Plane, Polygon, Quadric, Ray, Sphere, Torus,
    Triangle,
};

use crate::grid::Course;
use crate::instance::Placed;
use crate::plane::PlaneForms;
use crate::secondary::{Leaving, Start};
use crate::solid::Carved;
use crate::{
    Method, checker, cuboid, frustum, grid, instance, plane, polygon, power, quadric, roots,
    secondary, solid, sphere, torus, triangle,
};

/// Name of the method that is subtracted.
pub const EMPTY: &str = "empty";

/// Inputs of a case: a method is called this often in a closure.
pub const CALLS: usize = 16;

/// What is called in a closure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// As in the charts: `sphere`, `polygon`, ….
    pub stage: &'static str,
    /// Which inputs: `hit`, `miss`, ….
    pub case: &'static str,
    /// As in the stage's table, or [`EMPTY`], which comes before those from which it is subtracted.
    pub method: &'static str,
    /// How often it is called.
    pub calls: u32,
}

/// Whoever counts.
pub trait Meter {
    /// Runs `run` once and counts.
    fn measure(&mut self, entry: Entry, run: impl FnMut());
}

/// Shows every method of every stage but those of [`joined`] to `meter`, on inputs that depend on nothing.
///
/// The functions that this calls are not inlined: the inputs of all of them at once do not fit on the
/// stack of a small part.
pub fn all(meter: &mut impl Meter) {
    for case in ["hit", "miss"] {
        let hit = case == "hit";
        price_spheres(meter, case, hit);
        price_triangles(meter, case, hit);
        price_polygons(meter, case, hit);
        price_cuboids(meter, case, hit);
        price_frusta(meter, case, hit);
        price_quadrics(meter, case, hit);
        price_tori(meter, case, hit);
    }
    price_planes(meter);
    price_grids(meter);
    price_checkers(meter);
    price_setups(meter);
    price_secondary(meter);
    price_roots(meter);
    price_powers(meter);
}

/// Shows what joins kernels that are priced one by one: in a program of its own, for who calls a kernel
/// from one more place changes what is inlined.
pub fn joined(meter: &mut impl Meter) {
    for case in ["hit", "miss"] {
        let hit = case == "hit";
        price_instances(meter, case, hit);
        price_solids(meter, case, hit);
    }
}

/// Shows the empty method, then all others.
fn stage<F: Copy, I, O>(
    meter: &mut impl Meter,
    names: [&'static str; 2],
    methods: &[Method<F>],
    empty: F,
    inputs: &[I; CALLS],
    call: impl Fn(F, &I) -> O + Copy,
) {
    each(meter, names, &Method::new(EMPTY, empty), inputs, call);
    for method in methods {
        each(meter, names, method, inputs, call);
    }
}

#[inline(never)]
fn each<F: Copy, I, O>(
    meter: &mut impl Meter,
    [stage, case]: [&'static str; 2],
    method: &Method<F>,
    inputs: &[I; CALLS],
    call: impl Fn(F, &I) -> O,
) {
    let entry = Entry {
        stage,
        case,
        method: method.name,
        calls: CALLS as u32,
    };
    let run = black_box(method.run);
    meter.measure(entry, || {
        for input in inputs {
            black_box(call(run, input));
        }
    });
}

#[inline(never)]
fn price_spheres(meter: &mut impl Meter, case: &'static str, hit: bool) {
    let (methods, inputs) = (sphere::METHODS, spheres(hit));
    stage(
        meter,
        ["sphere", case],
        methods,
        |_, _| None,
        &inputs,
        |f, (ray, sphere)| f(ray, sphere).is_some(),
    );
}

#[inline(never)]
fn price_triangles(meter: &mut impl Meter, case: &'static str, hit: bool) {
    let inputs = outlines(3, hit).map(|([a, b, c, ..], normal, ray)| {
        let vertices = [a, b, c];
        let triangle = Triangle { vertices, normal };
        (ray, polygon::Setup::new(&ray), triangle)
    });
    let (methods, empty) = (triangle::METHODS, |_: &_, _: &_, _: &_| None);
    stage(
        meter,
        ["triangle", case],
        methods,
        empty,
        &inputs,
        |f, (ray, setup, triangle)| f(ray, setup, triangle).is_some(),
    );
}

#[inline(never)]
fn price_polygons(meter: &mut impl Meter, case: &'static str, hit: bool) {
    let outlines = outlines(6, hit);
    let inputs = outlines.each_ref().map(|(vertices, normal, ray)| {
        let (vertices, normal) = (vertices.as_slice(), *normal);
        (*ray, polygon::Setup::new(ray), Polygon { vertices, normal })
    });
    let (methods, empty) = (polygon::METHODS, |_: &_, _: &_, _: &Polygon<'_>| None);
    stage(
        meter,
        ["polygon", case],
        methods,
        empty,
        &inputs,
        |f, (ray, setup, polygon)| f(ray, setup, polygon).is_some(),
    );
}

#[inline(never)]
fn price_cuboids(meter: &mut impl Meter, case: &'static str, hit: bool) {
    let (methods, inputs) = (cuboid::METHODS, cuboids(hit));
    let empty = |_: &_, _: &_, _: &_| None;
    stage(
        meter,
        ["cuboid", case],
        methods,
        empty,
        &inputs,
        |f, (ray, setup, cuboid)| f(ray, setup, cuboid).is_some(),
    );
}

#[inline(never)]
fn price_frusta(meter: &mut impl Meter, case: &'static str, hit: bool) {
    let (methods, inputs) = (frustum::METHODS, frusta(hit));
    stage(
        meter,
        ["frustum", case],
        methods,
        |_, _| None,
        &inputs,
        |f, (ray, frustum)| f(ray, frustum).is_some(),
    );
}

#[inline(never)]
fn price_quadrics(meter: &mut impl Meter, case: &'static str, hit: bool) {
    let (methods, inputs) = (quadric::METHODS, quadrics(hit));
    stage(
        meter,
        ["quadric", case],
        methods,
        |_, _| None,
        &inputs,
        |f, (ray, quadric)| f(ray, quadric).is_some(),
    );
}

#[inline(never)]
fn price_tori(meter: &mut impl Meter, case: &'static str, hit: bool) {
    let (methods, inputs) = (torus::METHODS, tori(hit));
    stage(
        meter,
        ["torus", case],
        methods,
        |_, _| None,
        &inputs,
        |f, (ray, torus)| f(ray, torus).is_some(),
    );
}

#[inline(never)]
fn price_instances(meter: &mut impl Meter, case: &'static str, hit: bool) {
    let (methods, inputs) = (instance::METHODS, instances(hit));
    stage(
        meter,
        ["instance", case],
        methods,
        |_, _| None,
        &inputs,
        |f, (ray, placed)| f(ray, placed).is_some(),
    );
}

#[inline(never)]
fn price_solids(meter: &mut impl Meter, case: &'static str, hit: bool) {
    let (methods, inputs) = (solid::METHODS, solids(hit));
    stage(
        meter,
        ["solid", case],
        methods,
        |_, _| None,
        &inputs,
        |f, (ray, carved)| f(ray, carved).is_some(),
    );
}

#[inline(never)]
fn price_planes(meter: &mut impl Meter) {
    let (methods, inputs) = (plane::METHODS, planes());
    stage(
        meter,
        ["plane", "hit"],
        methods,
        |_, _| None,
        &inputs,
        |f, (ray, plane)| f(ray, plane).is_some(),
    );
}

#[inline(never)]
fn price_grids(meter: &mut impl Meter) {
    let (methods, inputs) = (grid::METHODS, courses());
    let empty: grid::Walks = (|_| 0.0, |_, _| ());
    stage(meter, ["grid", ""], methods, empty, &inputs, |f, it| {
        f.0(it)
    });
}

#[inline(never)]
fn price_checkers(meter: &mut impl Meter) {
    let mut random = Random(13);
    let inputs: [(Checker, Spot); CALLS] = core::array::from_fn(|_| {
        let checker = Checker {
            colors: [Vec3::ZERO, Vec3::ONE],
            size: 0.5 + random.unit(),
        };
        let spot = Spot {
            point: random.vector() * 10.0,
            outward: random.direction(),
            uv: (0.0, 0.0),
        };
        (checker, spot)
    });
    stage(
        meter,
        ["checker", ""],
        checker::METHODS,
        |_, spot| spot.point,
        &inputs,
        |f, (checker, spot)| f(checker, spot),
    );
}

/// What a ray costs once for all polygons or boxes. Each returns another type; of all of them a vector
/// is subtracted.
#[inline(never)]
fn price_setups(meter: &mut impl Meter) {
    fn setup<T>(
        meter: &mut impl Meter,
        name: &'static str,
        run: fn(&Ray) -> T,
        inputs: &[Ray; CALLS],
    ) {
        let method = Method::new(name, run);
        each(meter, ["setup", ""], &method, inputs, |f, ray| f(ray));
    }
    let mut random = Random(9);
    let inputs = core::array::from_fn(|_| Ray::new(Vec3::ZERO, random.direction()));
    setup(meter, EMPTY, |ray| ray.direction, &inputs);
    setup(meter, "cuboid core", cuboid::setup_core, &inputs);
    setup(
        meter,
        "cuboid reciprocal",
        cuboid::setup_reciprocal,
        &inputs,
    );
    setup(meter, "polygon core", polygon::setup_core, &inputs);
    setup(meter, "polygon shear", polygon::setup_shear, &inputs);
}

#[inline(never)]
fn price_secondary(meter: &mut impl Meter) {
    let inputs = leavings();
    let nothing = |leaving: &Leaving| Start {
        origin: leaving.point,
        t_min: 0.0,
        skips: false,
    };
    let methods = secondary::METHODS;
    stage(
        meter,
        ["secondary", ""],
        methods,
        nothing,
        &inputs,
        |f, leaving| f(leaving),
    );
}

#[inline(never)]
fn price_roots(meter: &mut impl Meter) {
    let mut random = Random(1);
    let inputs: [f32; CALLS] = core::array::from_fn(|_| 1.0 + 9.0 * random.unit());
    stage(
        meter,
        ["sqrt", ""],
        roots::SQRT,
        |x| x,
        &inputs,
        |f, x| f(*x),
    );
    stage(
        meter,
        ["rsqrt", ""],
        roots::RSQRT,
        |x| x,
        &inputs,
        |f, x| f(*x),
    );
    let inputs: [Vec3; CALLS] = core::array::from_fn(|_| random.vector() * 10.0);
    stage(
        meter,
        ["normalize", ""],
        roots::NORMALIZE,
        |v| v,
        &inputs,
        |f, v| f(*v),
    );
}

#[inline(never)]
fn price_powers(meter: &mut impl Meter) {
    let mut random = Random(1);
    let bases: [f32; CALLS] = core::array::from_fn(|_| random.unit());
    for (case, n) in [("n = 50", 50.0), ("n = 1000", 1000.0)] {
        stage(
            meter,
            ["power", case],
            power::WHOLE,
            |x, _| x,
            &bases,
            |f, x| f(*x, n),
        );
    }
    let (methods, n) = (power::REAL, 50.5);
    stage(
        meter,
        ["power, real", "n = 50.5"],
        methods,
        |x, _| x,
        &bases,
        |f, x| f(*x, n),
    );
}

/// G. Marsaglia, "Xorshift RNGs", Journal of Statistical Software 8(14), 2003.
struct Random(u32);

impl Random {
    fn next(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0
    }

    /// From 0 to below 1.
    fn unit(&mut self) -> f32 {
        (self.next() >> 8) as f32 / 16_777_216.0
    }

    /// Components from -1 to below 1.
    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - Vec3::ONE
    }

    fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.vector();
            if v.length_squared() > 0.1 {
                return Exact::normalize(v);
            }
        }
    }
}

/// A ray that passes `center` at a distance.
fn ray_past(random: &mut Random, center: Vec3, distance: f32) -> Ray {
    let direction = random.direction();
    let side = Exact::normalize(direction.cross(Vec3::new(-direction.y, direction.z, direction.x)));
    Ray::new(center + side * distance - direction * 6.0, direction)
}

/// Rays that hit, or miss, spheres of radius 1.
pub fn spheres(hit: bool) -> [(Ray, Sphere); CALLS] {
    let mut random = Random(2);
    core::array::from_fn(|_| {
        let center = random.vector() * 4.0;
        let miss = if hit {
            0.9 * random.unit()
        } else {
            1.2 + random.unit()
        };
        let ray = ray_past(&mut random, center, miss);
        (
            ray,
            Sphere {
                center,
                radius: 1.0,
            },
        )
    })
}

/// Rays that hit, or pass, boxes.
pub fn cuboids(hit: bool) -> [(Ray, cuboid::Setup, Cuboid); CALLS] {
    let mut random = Random(3);
    core::array::from_fn(|_| {
        let center = random.vector() * 4.0;
        let half = Vec3::ONE + random.vector() * 0.5;
        let miss = if hit {
            0.5 * random.unit()
        } else {
            2.6 + random.unit()
        };
        let ray = ray_past(&mut random, center, miss);
        let cuboid = Cuboid {
            min: center - half,
            max: center + half,
        };
        (ray, cuboid::Setup::new(&ray), cuboid)
    })
}

/// Rays that hit, or pass, frusta. All aim at the middle of the axis: at most through both ends.
pub fn frusta(hit: bool) -> [(Ray, Frustum); CALLS] {
    let mut random = Random(4);
    core::array::from_fn(|_| {
        let (center, axis) = (random.vector() * 4.0, random.direction());
        let frustum = Frustum {
            base: center - axis * 2.0,
            axis,
            length: 4.0,
            base_radius: 1.0 + random.unit(),
            slope: -0.2 * random.unit(),
        };
        loop {
            let miss = if hit {
                0.5 * random.unit()
            } else {
                3.0 + random.unit()
            };
            let ray = ray_past(&mut random, center, miss);
            if ray.direction.dot(axis).abs() < 0.6 {
                return (ray, frustum);
            }
        }
    })
}

/// Rays that hit, or pass, open quadrics of six kinds, at up to twice their size from the center.
pub fn quadrics(hit: bool) -> [(Ray, Quadric); CALLS] {
    let mut random = Random(10);
    core::array::from_fn(|i| {
        loop {
            let (center, axis) = (random.vector() * 4.0, random.direction());
            let (base, apex) = (center - axis, center + axis);
            let (radius, share) = (1.0 + 0.5 * random.unit(), 0.2 + 0.6 * random.unit());
            let quadric = match i % 6 {
                0 => Quadric::ellipsoid(center, Vec3::new(radius, share, 1.0)),
                1 => Quadric::cylinder(base, apex, share, Ends::Open),
                2 => Quadric::cone(base, radius, apex, 0.0, Ends::Open),
                3 => Quadric::paraboloid(base, apex, radius, Ends::Open),
                4 => Quadric::hyperboloid(base, apex, radius, share, Ends::Open),
                _ => Quadric::two_sheets(base, apex, radius, share, Ends::Open),
            };
            let distance = 2.0 * random.unit();
            let ray = ray_past(&mut random, center, distance);
            match quadric {
                Ok(it) if quadric::double(&ray, &it).is_some() == hit => return (ray, it),
                _ => {}
            }
        }
    })
}

/// Rays that hit, or pass, tori, at up to twice their size from the center.
pub fn tori(hit: bool) -> [(Ray, Torus); CALLS] {
    let mut random = Random(11);
    core::array::from_fn(|_| {
        loop {
            let torus = Torus {
                center: random.vector() * 4.0,
                axis: random.direction(),
                major: 1.0,
                minor: 0.1 + 0.6 * random.unit(),
            };
            let distance = 2.0 * (torus.major + torus.minor) * random.unit();
            let ray = ray_past(&mut random, torus.center, distance);
            if torus::core(&ray, &torus).is_some() == hit {
                return (ray, torus);
            }
        }
    })
}

/// Rays that hit, or pass, spheres that are placed, at up to twice their size.
pub fn instances(hit: bool) -> [(Ray, Placed); CALLS] {
    let mut random = Random(12);
    core::array::from_fn(|_| {
        loop {
            let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| axis + random.vector() * 0.5);
            let sphere = Sphere {
                center: random.vector(),
                radius: 1.0,
            };
            let Some(placed) = Placed::new(axes, random.vector() * 4.0, sphere) else {
                continue;
            };
            let distance = 2.0 * random.unit();
            let ray = ray_past(&mut random, placed.quadric.center, distance);
            if instance::double(&ray, &placed).is_some() == hit {
                return (ray, placed);
            }
        }
    })
}

/// Rays that hit, or pass, boxes with a round hole down to the middle.
pub fn solids(hit: bool) -> [(Ray, Carved); CALLS] {
    let mut random = Random(14);
    core::array::from_fn(|_| {
        loop {
            let (center, half) = (random.vector() * 4.0, Vec3::ONE + random.vector() * 0.5);
            let outer = Cuboid {
                min: center - half,
                max: center + half,
            };
            let radius = 0.2 + 0.2 * random.unit();
            let top = center.with_y(outer.max.y);
            let Ok(inner) = Quadric::cylinder(center, top, radius, Ends::Closed) else {
                continue;
            };
            let distance = if hit { 0.5 } else { 2.6 } * random.unit();
            let ray = ray_past(&mut random, center, distance);
            let carved = Carved::new(outer, inner);
            if solid::core(&ray, &carved).is_some() == hit {
                return (ray, carved);
            }
        }
    })
}

/// Rays that hit planes.
pub fn planes() -> [(Ray, PlaneForms); CALLS] {
    let mut random = Random(5);
    core::array::from_fn(|_| {
        let (point, normal) = (random.vector() * 4.0, random.direction());
        loop {
            let distance = 1.0 + random.unit();
            let ray = ray_past(&mut random, point, distance);
            if ray.direction.dot(normal).abs() > 0.3 {
                return (ray, PlaneForms::new(Plane { point, normal }));
            }
        }
    })
}

/// Walks over 32 borders of a map that they do not leave.
pub fn courses() -> [Course; CALLS] {
    let mut random = Random(8);
    let grid = Grid {
        width: 80,
        depth: 80,
        cells: &[],
    };
    core::array::from_fn(|_| Course {
        grid,
        origin: Vec3::splat(40.0) + random.vector(),
        direction: random.direction(),
        steps: 32,
    })
}

/// The corners of a regular outline with 3 or 6 of them and circumradius 1 (of the array, the first
/// ones), its normal, and a ray that hits it or passes it in its plane.
pub fn outlines(corners: usize, hit: bool) -> [([Vec3; 6], Vec3, Ray); CALLS] {
    const SIN_60: f32 = 0.866_025_4;
    let circle = [
        (1.0, 0.0),
        (0.5, SIN_60),
        (-0.5, SIN_60),
        (-1.0, 0.0),
        (-0.5, -SIN_60),
        (0.5, -SIN_60),
    ];
    let step = if corners == 3 { 2 } else { 1 };
    let mut random = Random(6);
    core::array::from_fn(|_| {
        let (center, normal) = (random.vector() * 4.0, random.direction());
        let x = Exact::normalize(normal.cross(Vec3::new(-normal.y, normal.z, normal.x)));
        let y = normal.cross(x);
        let vertices = core::array::from_fn(|i| {
            let (cos, sin) = circle[i * step % 6];
            center + x * cos + y * sin
        });
        // The inscribed circle of a triangle has half the radius.
        let distance = if hit {
            0.45 * random.unit()
        } else {
            1.1 + 0.5 * random.unit()
        };
        let (cos, sin) = circle[random.next() as usize % 6];
        let aim = center + (x * cos + y * sin) * distance;
        loop {
            let direction = random.direction();
            if direction.dot(normal).abs() > 0.3 {
                return (vertices, normal, Ray::new(aim - direction * 6.0, direction));
            }
        }
    })
}

/// Hits on flat surfaces, a rounding below them, to be left.
pub fn leavings() -> [Leaving; CALLS] {
    let mut random = Random(7);
    core::array::from_fn(|_| {
        let (eye, direction, normal) = (random.vector(), random.direction(), random.direction());
        let way = direction * (1.0 + random.unit());
        let point = eye + way;
        Leaving {
            eye,
            way,
            point,
            normal,
            anchor: point + normal * 1e-6,
            radius: 0.0,
        }
    })
}
