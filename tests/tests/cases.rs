//! Forty adversarial cases with exactly known answers: where the methods of ray casting fail.
//!
//! Every input is an exact `f32`. A distance is right to 2 ulp; where geometry leaves a choice, the
//! policy that the documentation states is what is checked. The numbers are those of the cases, C01
//! to C40; every geometric one asks `closest_hit` and `occluded` together, and `whitted cast`.

use std::path::Path;

use whitted::math::refract;
use whitted::*;
use whitted_cli::cast::{self, Cast, GivenRay, Query};
use whitted_cli::scene::{HostScene, Pool};
use whitted_cli::scene_file::toml;

/// A ray as a case gives it: the direction need not have unit length, and `t` counts in lengths of it.
#[derive(Clone, Copy)]
struct Line {
    origin: [f32; 3],
    direction: [f32; 3],
}

fn line(origin: [f32; 3], direction: [f32; 3]) -> Line {
    Line { origin, direction }
}

impl Line {
    fn length(&self) -> f64 {
        self.direction
            .iter()
            .map(|&x| f64::from(x).powi(2))
            .sum::<f64>()
            .sqrt()
    }

    /// With a direction of unit length.
    fn ray(&self) -> Ray {
        let unit = self
            .direction
            .map(|x| (f64::from(x) / self.length()) as f32);
        Ray::new(self.origin.into(), unit.into())
    }
}

/// 2 to a whole power.
fn exp2(exponent: i32) -> f32 {
    f32::powi(2.0, exponent)
}

/// How far a number is from the exact one, in units of the last place of the latter.
fn ulps(x: f32, exact: f64) -> f64 {
    let nearest = exact.abs() as f32;
    (f64::from(x) - exact).abs() / f64::from(nearest.next_up() - nearest)
}

/// A shape as a scene file in TOML has it.
trait InFile: Shape + Copy {
    fn toml(&self) -> String;
}

fn numbers(v: Vec3) -> String {
    format!("{:?}", v.to_array().map(f64::from))
}

fn list(vertices: &[Vec3]) -> String {
    let vertices: Vec<_> = vertices.iter().map(|&v| numbers(v)).collect();
    vertices.join(", ")
}

impl InFile for Sphere {
    fn toml(&self) -> String {
        let (center, radius) = (numbers(self.center), f64::from(self.radius));
        format!("[[sphere]]\ncenter = {center}\nradius = {radius:?}")
    }
}

impl InFile for Plane {
    fn toml(&self) -> String {
        let (point, normal) = (numbers(self.point), numbers(self.normal));
        format!("[[plane]]\npoint = {point}\nnormal = {normal}")
    }
}

impl InFile for Polygon<'_> {
    fn toml(&self) -> String {
        format!("[[polygon]]\nvertices = [{}]", list(self.vertices))
    }
}

impl InFile for Triangle {
    fn toml(&self) -> String {
        format!("[[triangle]]\nvertices = [{}]", list(&self.vertices))
    }
}

impl InFile for Cuboid {
    fn toml(&self) -> String {
        format!(
            "[[box]]\nmin = {}\nmax = {}",
            numbers(self.min),
            numbers(self.max)
        )
    }
}

/// What is right: how far in lengths of the direction, and which normal if it is exactly known.
type Answer = Option<(f64, Option<Vec3>)>;

/// Whether a shape answers a ray as it should: to `closest_hit` and `occluded`, alone and as the
/// first of two equal ones, and in a scene file to `whitted cast`.
fn check(case: &str, shape: impl InFile, line: Line, right: Answer) {
    check_in_core(case, shape, line, right);
    check_in_file(case, shape, line, right);
}

/// The part of [`check`] that asks `whitted cast`.
fn check_in_file(case: &str, shape: impl InFile, line: Line, right: Answer) {
    let text = format!("[material.any]\n{}\nmaterial = \"any\"", shape.toml());
    let file = toml::parse(Path::new(case), &text).unwrap();
    let pool = Pool::new(&file);
    let scene = HostScene::new(&file, &pool).unwrap();
    let given = GivenRay {
        origin: line.origin.map(f64::from),
        direction: line.direction.map(f64::from),
        t_max: f64::INFINITY,
    };
    let occluded = scene.cast(&given, Query::Occluded);
    let right_occluded = cast::Answer::Occluded {
        occluded: right.is_some(),
    };
    assert_eq!(occluded, right_occluded, "{case}: cast --occluded");
    match (scene.cast(&given, Query::Closest), right) {
        (cast::Answer::Miss { .. }, None) => {}
        (
            cast::Answer::Hit {
                t,
                normal: cast_normal,
                ..
            },
            Some((right_t, normal)),
        ) => {
            assert!(
                ulps(t, right_t) <= 2.0,
                "{case}: cast's t is {t}, not {right_t}"
            );
            if let Some(normal) = normal {
                assert_eq!(Vec3::from(cast_normal), normal, "{case}: cast's normal");
            }
        }
        (answer, right) => panic!("{case}: cast answers {answer:?} where {right:?} is right"),
    }
}

/// The part of [`check`] that asks core, also for shapes which no constructor makes.
fn check_in_core<S: Shape + Copy>(case: &str, shape: S, line: Line, right: Answer) {
    let ray = line.ray();
    let object = Object {
        shape,
        material: &(),
    };
    let (one, two) = ([object], [object, object]);
    let hit = one.as_slice().closest_hit(&ray);
    assert_eq!(
        one.as_slice().occluded(&ray),
        hit.is_some(),
        "{case}: occluded"
    );
    assert_eq!(
        two.as_slice().closest_hit(&ray),
        hit,
        "{case}: the first of two equal ones"
    );
    match (hit, right) {
        (None, None) => {}
        (Some(hit), Some((t, normal))) => {
            let error = ulps(hit.t, t * line.length());
            assert!(error <= 2.0, "{case}: t is {}, {error} ulp from {t}", hit.t);
            assert!(
                (hit.normal.length() - 1.0).abs() < 1e-6,
                "{case}: normal {}",
                hit.normal
            );
            assert!(
                hit.normal.dot(ray.direction) <= 0.0,
                "{case}: turned to the ray"
            );
            if let Some(normal) = normal {
                assert_eq!(hit.normal, normal, "{case}: normal");
            }
            let short = Ray {
                t_max: hit.t,
                ..ray
            };
            assert!(
                !one.as_slice().occluded(&short),
                "{case}: the interval is open"
            );
        }
        (hit, right) => panic!(
            "{case}: {:?} where {right:?} is right",
            hit.map(|hit| hit.t)
        ),
    }
}

/// A ray with a direction of unit length, or what a case has in its place.
fn ray(origin: [f32; 3], direction: [f32; 3]) -> Ray {
    Ray::new(origin.into(), direction.into())
}

const X: Vec3 = Vec3::X;
const Y: Vec3 = Vec3::Y;
const Z: Vec3 = Vec3::Z;

/// A hit whose normal is known.
fn hit(t: f64, normal: Vec3) -> Answer {
    Some((t, Some(normal)))
}

/// A hit whose normal is not a short number.
fn at(t: f64) -> Answer {
    Some((t, None))
}

const MISS: Answer = None;

#[test]
#[rustfmt::skip]
fn c01_to_c10_spheres() {
    let sphere = |x, y, z, radius| Sphere { center: Vec3::new(x, y, z), radius };
    let ball = sphere(0.0, 0.0, 0.0, 1.0);
    let along_z = |x, z| line([x, 0.0, z], [0.0, 0.0, 1.0]);
    let tiny = exp2(-80);
    let cases = [
        ("C01 touching counts", ball, along_z(1.0, -3.0), hit(3.0, X)),
        ("C02 an ulp inside the silhouette", ball, along_z(1.0 - exp2(-24), -3.0), at(2.999_654_733_022_14)),
        ("C03 an ulp outside", ball, along_z(1.0 + exp2(-23), -3.0), MISS),
        ("C04 far away", ball, along_z(0.5, -1e4), at(9_999.133_974_596_22)),
        ("C05 far away, beside", ball, along_z(1.5, -1e4), MISS),
        ("C06 from the centre", sphere(0.0, 0.0, 0.0, 2.0), line([0.0; 3], [0.0, 1.0, 0.0]), hit(2.0, -Y)),
        ("C07a off the surface, away", ball, line([0.0, 0.0, -1.0], [0.0, 0.0, -1.0]), MISS),
        ("C07b across", ball, along_z(0.0, -1.0), hit(2.0, -Z)),
        ("C07c along the tangent", ball, line([0.0, 0.0, -1.0], [1.0, 0.0, 0.0]), MISS),
        ("C08 a direction of length 5", sphere(6.0, 8.0, 0.0, 5.0), line([0.0; 3], [3.0, 4.0, 0.0]), at(1.0)),
        ("C09 a ground of a million", sphere(0.0, -1e6, 0.0, 1e6), line([0.0, 1.0, 0.0], [0.0, -1.0, 0.0]), hit(1.0, Y)),
    ];
    for (case, sphere, line, right) in cases {
        check(case, sphere, line, right);
    }
    // Squares of such lengths are no `f32`: only a scene file, which is cast at another scale, tells.
    let tiny_ball = sphere(0.0, 0.0, 0.0, tiny);
    let t = f64::from(exp2(-79));
    check_in_file("C10 tiny", tiny_ball, along_z(0.0, -3.0 * tiny), hit(t, -Z));
    check_in_file("C10 beside", tiny_ball, along_z(1.25 * tiny, -3.0 * tiny), MISS);
}

#[test]
fn c07_a_ray_that_leaves_a_sphere_does_not_meet_it_where_it_starts() {
    let ball = [Object {
        shape: Sphere::new(Vec3::ZERO, 1.0).unwrap(),
        material: &(),
    }];
    let cases = [
        ("away", -Z, Side::Outside, None),
        ("across", Z, Side::Inside, Some(2.0)),
        ("along the tangent, outside", X, Side::Outside, None),
        ("along the tangent, inside", X, Side::Inside, None),
    ];
    for (case, direction, side, t) in cases {
        let ray = Ray {
            departure: Some(Departure { object: 0, side }),
            ..Ray::new(-Z, direction)
        };
        let hit = ball.as_slice().closest_hit(&ray);
        assert_eq!(hit.map(|hit| hit.t), t, "{case}");
        assert_eq!(ball.as_slice().occluded(&ray), t.is_some(), "{case}");
    }
}

#[test]
fn a_direction_a_rounding_short_does_not_lose_a_sphere_a_million_radii_away() {
    // The closest approach that such a direction finds is an eighth of the radius off, along the ray.
    let short = Vec3::Z * (1.0 - exp2(-24));
    let ball = Sphere::new(Vec3::ZERO, 1.0).unwrap();
    let object = [Object {
        shape: ball,
        material: &(),
    }];
    for (miss, is_met) in [(0.0, true), (0.995, true), (1.005, false)] {
        let ray = Ray::new(Vec3::new(miss, 0.0, -exp2(20)), short);
        let hit = object.as_slice().closest_hit(&ray);
        assert_eq!(hit.is_some(), is_met, "{miss} off the center");
        assert_eq!(object.as_slice().occluded(&ray), is_met, "{miss}: occluded");
        if let Some(hit) = hit {
            let half_chord = (1.0 - f64::from(miss).powi(2)).sqrt();
            let t = (f64::from(exp2(20)) - half_chord) / f64::from(short.z);
            assert!(ulps(hit.t, t) <= 2.0, "{miss}: t is {}, not {t}", hit.t);
        }
    }
}

#[test]
fn c11_a_sphere_without_radius_is_refused_and_never_hit() {
    assert_eq!(Sphere::new(Vec3::ZERO, 0.0), Err(SphereError::ZeroRadius));
    let forced = Sphere {
        center: Vec3::ZERO,
        radius: 0.0,
    };
    let up = [0.0, 0.0, 1.0];
    check_in_core("C11", forced, line([0.0, 0.0, -3.0], up), MISS);
    check_in_core("C11 from the centre", forced, line([0.0; 3], up), MISS);
    check_in_core(
        "C11 beside",
        forced,
        line([exp2(-149), 0.0, -3.0], up),
        MISS,
    );
}

#[test]
#[rustfmt::skip]
fn c12_to_c16_planes() {
    let floor = Plane::new(Vec3::ZERO, Y).unwrap();
    let far = Vec3::splat(exp2(23));
    let tilt = Vec3::new(1.0, 2.0, 2.0);
    let tilted = Plane::new(far, tilt).unwrap();
    let over = (far + tilt).to_array();
    let cases = [
        ("C12 the horizon", floor, line([0.0, 1.0, 0.0], [1.0, -exp2(-20), 0.0]), hit(1_048_576.0, Y)),
        ("C13a parallel", floor, line([0.0, 1.0, 0.0], [1.0, 0.0, 0.0]), MISS),
        ("C13b within", floor, line([0.0; 3], [1.0, 0.0, 0.0]), MISS),
        ("C14 far from the origin", tilted, line(over, [-1.0, -2.0, -2.0]), at(1.0)),
        ("C15 upwards", floor, line([0.0, 1.0, 0.0], [0.0, 1.0, 0.0]), MISS),
        ("C15 from the plane itself", floor, line([0.0; 3], [0.0, -1.0, 0.0]), MISS),
        ("C15 from the plane itself, -0", floor, line([0.0, -0.0, 0.0], [0.0, -1.0, 0.0]), MISS),
        ("C16 beyond f32", floor, line([0.0, 1.0, 0.0], [1.0, -exp2(-149), 0.0]), MISS),
    ];
    for (case, plane, line, right) in cases {
        check(case, plane, line, right);
    }
}

/// Points of the plane z = 0.
fn flat<const N: usize>(points: [[f32; 2]; N]) -> [Vec3; N] {
    points.map(|[x, y]| Vec3::new(x, y, 0.0))
}

/// From above, straight down to z = 0.
fn down(x: f32, y: f32) -> Line {
    line([x, y, 1.0], [0.0, 0.0, -1.0])
}

fn square(x: f32, y: f32) -> [Vec3; 4] {
    flat([[x, y], [x + 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.0]])
}

/// How many of some polygons a ray meets, each asked alone.
fn meets(outlines: &[&[Vec3]], line: Line) -> usize {
    let met = |outline: &&&[Vec3]| {
        let shape = Polygon::new(outline).unwrap();
        let object = [Object {
            shape,
            material: &(),
        }];
        let hit = object.as_slice().closest_hit(&line.ray());
        let right = hit.map(|hit| (1.0, Some(hit.normal)));
        check("one of several polygons", shape, line, right);
        hit.is_some()
    };
    outlines.iter().filter(met).count()
}

#[test]
fn c17_and_c18_exactly_one_of_the_owners_of_an_edge_or_a_corner_is_hit() {
    let tiles = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(x, y)| square(x, y));
    let [a, b, c, d] = &tiles;
    assert_eq!(meets(&[a, b], down(1.0, 0.5)), 1, "C17");
    assert_eq!(meets(&[a, b, c, d], down(1.0, 1.0)), 1, "C18");
    for (x, y) in [(1.0, 0.5), (1.0, 1.5), (0.5, 1.0), (1.5, 1.0)] {
        assert_eq!(meets(&[a, b, c, d], down(x, y)), 1, "edge at {x}, {y}");
    }
    let up = line([1.0, 1.0, -1.0], [0.0, 0.0, 1.0]);
    assert_eq!(meets(&[a, b, c, d], up), 1, "C18 from below");
    let [left, right] = [[a[0], a[1], a[2]], [a[0], a[2], a[3]]];
    assert_eq!(
        meets(&[&left, &right], down(0.5, 0.5)),
        1,
        "the diagonal of a square"
    );
}

#[test]
#[rustfmt::skip]
fn c19_to_c26_outlines() {
    let corner = flat([[2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0], [0.0, 0.0]]);
    let bow_tie = flat([[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]]);
    let collinear = flat([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]);
    let repeated = flat([[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    let tiny = flat([[0.0, 0.0], [exp2(-40), 0.0], [0.0, exp2(-40)]]);
    let diamond = flat([[0.0, 0.5], [0.5, 0.0], [1.0, 0.5], [0.5, 1.0]]);
    let cases: [(&str, &[Vec3], Line, bool); 15] = [
        ("C19 the notch of an L", &corner, down(1.2, 1.2), false),
        ("C20 one arm", &corner, down(0.5, 1.5), true),
        ("C20 the other arm", &corner, down(1.5, 0.5), true),
        ("C21 a bow-tie, left", &bow_tie, down(0.25, 1.0), true),
        ("C21 a bow-tie, right", &bow_tie, down(1.75, 1.0), true),
        ("C21 a bow-tie, below", &bow_tie, down(1.0, 0.25), false),
        ("C21 a bow-tie, above", &bow_tie, down(1.0, 1.75), false),
        ("C22 starts along a line", &collinear, down(1.0, 1.0), true),
        ("C23 a vertex twice", &repeated, down(0.5, 0.5), true),
        ("C24 tiny", &tiny, down(exp2(-42), exp2(-42)), true),
        ("C24 tiny, beside", &tiny, down(exp2(-40), exp2(-40)), false),
        ("C26 vertices beside the ray", &diamond, down(0.5, 0.5), true),
        ("C26 before both vertices", &diamond, down(-0.5, 0.5), false),
        ("C26 behind both vertices", &diamond, down(1.5, 0.5), false),
        ("C26 beside a vertex above", &diamond, down(0.25, 1.0), false),
    ];
    for (case, outline, line, inside) in cases {
        let right = if inside { at(1.0) } else { MISS };
        check(case, Polygon::new(outline).unwrap(), line, right);
        if let &[a, b, c] = outline {
            check(case, Triangle::new([a, b, c]).unwrap(), line, right);
        }
    }
}

#[test]
fn c25_an_outline_without_area_is_refused_and_never_hit() {
    let edge = flat([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]);
    assert_eq!(Polygon::new(&edge), Err(PolygonError::ZeroArea));
    assert_eq!(Triangle::new(edge), Err(PolygonError::ZeroArea));
    let patch = Patch::new(edge, [Z; 3]);
    assert_eq!(patch, Err(PatchError::Outline(PolygonError::ZeroArea)));
    for normal in [Z, Vec3::ZERO, Vec3::NAN] {
        for x in [0.0, 0.5, 1.0, 2.0] {
            let case = format!("C25 at {x}, normal {normal}");
            let polygon = Polygon {
                vertices: &edge,
                normal,
            };
            let triangle = Triangle {
                vertices: edge,
                normal,
            };
            check_in_core(&case, polygon, down(x, 0.0), MISS);
            check_in_core(&case, triangle, down(x, 0.0), MISS);
        }
    }
}

#[test]
#[rustfmt::skip]
fn c27_to_c32_boxes() {
    let die = Cuboid::new(Vec3::NEG_ONE, Vec3::ONE).unwrap();
    let card = Cuboid::new(Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 0.0, 1.0)).unwrap();
    let along = |x, y| line([x, y, 0.0], [1.0, 0.0, 0.0]);
    let along_signed = |x, y| line([x, y, 0.0], [1.0, -0.0, 0.0]);
    let diagonal = |y| line([0.0, y, 0.0], [1.0, 1.0, 0.0]);
    let above = 1.0 + exp2(-23);
    let cases = [
        ("C27 along an axis", die, along(-2.0, 0.0), hit(1.0, -X)),
        ("C27 along an axis, -0", die, along_signed(-2.0, 0.0), hit(1.0, -X)),
        ("C28 within a face's plane", die, along(-2.0, 1.0), hit(1.0, -X)),
        ("C28 within a face's plane, -0", die, along_signed(-2.0, 1.0), hit(1.0, -X)),
        ("C28 within the lower face's plane", die, along(-2.0, -1.0), hit(1.0, -X)),
        ("C29 an ulp above that plane", die, along(-2.0, above), MISS),
        ("C29 an ulp above that plane, -0", die, along_signed(-2.0, above), MISS),
        ("C30 from inside", die, along(0.0, 0.0), hit(1.0, -X)),
        ("C31 through an edge", die, diagonal(-2.0), at(1.0)),
        ("C31 past an edge", die, diagonal(-2.0 - exp2(-22)), MISS),
        ("C32 no thickness", card, line([0.0, 1.0, 0.0], [0.0, -1.0, 0.0]), hit(1.0, Y)),
    ];
    for (case, cuboid, line, right) in cases {
        check(case, cuboid, line, right);
    }
}

/// The `i`-th of points that fill a unit cube evenly: multiples of the powers of the generalised
/// golden ratio, M. Roberts's R3 sequence.
fn even(i: u32) -> [f32; 3] {
    [0.819_172_5, 0.671_043_6, 0.549_700_5]
        .map(|step: f64| (0.5 + f64::from(i) * step).fract() as f32)
}

/// A unit vector within the hemisphere round `axis` whose cosine with it is `cosine`.
fn around(axis: Vec3, cosine: f32, turn: f32) -> Vec3 {
    let side = axis.any_orthonormal_vector();
    let (sin, cos) = (turn * std::f32::consts::TAU).sin_cos();
    let across = side * cos + axis.cross(side) * sin;
    (axis * cosine + across * (1.0 - cosine * cosine).sqrt()).normalize()
}

/// Of the points of a shape's outer side that a camera at four times its size sees, how many, and how
/// many the shape itself hides from a light above their tangent plane.
fn own_shadows<S: Shape + Copy>(shape: S, size: f32) -> (usize, usize) {
    let object = [Object {
        shape,
        material: &(),
    }];
    let (mut seen, mut hidden) = (0, 0);
    for i in 0..2000 {
        let [a, b, c] = even(i);
        let eye = around(Vec3::new(1.0, 2.0, 2.0) / 3.0, a, b) * (4.0 * size);
        let target = (Vec3::new(c, a + b, b + c).fract() - 0.5) * size;
        let primary = Ray::new(eye, (target - eye).normalize());
        let Some(hit) = object.as_slice().closest_hit(&primary) else {
            continue;
        };
        if !hit.front {
            continue; // One side of an open frustum's inside does shadow the other.
        }
        seen += 1;
        let cosine = 0.001_f32.powf(1.0 - c);
        let mut shadow = hit.back(around(hit.normal, cosine, a + c));
        shadow.t_max = 3.0 * size;
        // Rounding may have put the direction below the horizon; then no shadow ray is cast.
        if hit.normal.dot(shadow.direction) > 0.0 {
            hidden += usize::from(object.as_slice().occluded(&shadow));
        }
    }
    (seen, hidden)
}

#[test]
fn c33_nothing_shadows_itself_at_any_scale() {
    for exponent in [-40, -20, -10, 0, 10, 20, 40] {
        let size = exp2(exponent);
        let [u, v] = [
            Vec3::new(2.0, -2.0, 1.0) / 3.0,
            Vec3::new(2.0, 1.0, -2.0) / 3.0,
        ];
        let corners = [u, v, -u, -v].map(|corner| corner * size);
        let triangle = [corners[0], corners[1], corners[2]];
        let middle = Vec3::splat(0.1 * size);
        let half = Vec3::splat(0.4 * size);
        let results = [
            (
                "plane",
                own_shadows(Plane::new(Vec3::ZERO, u.cross(v)).unwrap(), size),
            ),
            (
                "polygon",
                own_shadows(Polygon::new(&corners).unwrap(), size),
            ),
            (
                "triangle",
                own_shadows(Triangle::new(triangle).unwrap(), size),
            ),
            (
                "patch",
                own_shadows(Patch::new(triangle, [u.cross(v); 3]).unwrap(), size),
            ),
            (
                "sphere",
                own_shadows(Sphere::new(middle, 0.5 * size).unwrap(), size),
            ),
            (
                "box",
                own_shadows(Cuboid::new(middle - half, middle + half).unwrap(), size),
            ),
            (
                "frustum",
                own_shadows(
                    Frustum::new(-half, 0.5 * size, half, 0.2 * size).unwrap(),
                    size,
                ),
            ),
        ];
        for (name, (seen, hidden)) in results {
            assert!(
                seen > 200,
                "{name}, 2^{exponent}: {seen} points prove nothing"
            );
            assert_eq!(hidden, 0, "{name}, 2^{exponent}: of {seen} points");
        }
    }
}

#[test]
fn c34_no_light_leaks_through_a_narrow_gap() {
    let chalk = Material::matte(Vec3::ONE, 0.0, 1.0);
    let floor = Object {
        shape: Plane {
            point: Vec3::ZERO,
            normal: Vec3::Y,
        },
        material: &chalk,
    };
    let light = [Light {
        position: Vec3::Y * 10.0,
        color: Vec3::ONE,
    }];
    for exponent in [-10, -15, -20, -23, -40] {
        let gap = exp2(exponent);
        let lid = Object {
            shape: Plane {
                point: Vec3::Y * gap,
                normal: Vec3::Y,
            },
            material: &chalk,
        };
        let below_lid = Ray::new(Vec3::Y * (0.5 * gap), Vec3::NEG_Y);
        let radiance = |geometry: &[Object<Plane>]| {
            let scene = Scene {
                geometry,
                lights: &light,
                background: Vec3::ONE,
                ambient: Vec3::ONE,
            };
            Tracer::<1>::new().radiance(&scene, below_lid)
        };
        assert_eq!(radiance(&[floor]), Vec3::ONE, "gap 2^{exponent}, no lid");
        assert_eq!(radiance(&[floor, lid]), Vec3::ZERO, "gap 2^{exponent}");
        assert_eq!(
            radiance(&[lid, floor]),
            Vec3::ZERO,
            "gap 2^{exponent}, lid first"
        );
    }
}

#[test]
fn c35_at_the_critical_angle_light_is_refracted_along_the_surface_or_reflected() {
    let direction = Vec3::new(0.8, -0.6, 0.0);
    if let Some(refracted) = refract::<Exact>(direction, Vec3::Y, 1.25) {
        assert!(refracted.is_finite());
        assert!(refracted.angle_between(Vec3::X) <= exp2(-11), "{refracted}");
    }
    // A cosine a little above and below it, in steps of an ulp of its sine: never NaN.
    let mut outcomes = [0; 2];
    let mut sine = 0.8_f32 - exp2(-18);
    while sine < 0.8 + exp2(-18) {
        let direction = Vec3::new(sine, -(1.0 - sine * sine).sqrt(), 0.0);
        let refracted = refract::<Exact>(direction, Vec3::Y, 1.25);
        assert!(refracted.is_none_or(|it| it.is_finite() && (it.length() - 1.0).abs() < 1e-6));
        outcomes[usize::from(refracted.is_some())] += 1;
        sine = sine.next_up();
    }
    assert!(
        outcomes.iter().all(|&count| count > 50),
        "reflected, refracted: {outcomes:?}"
    );
}

#[test]
fn c36_two_mirrors_stop_at_the_depth_limit() {
    let silver = Material {
        color: Vec3::ONE,
        ambient: 0.125,
        diffuse: 0.0,
        highlight: (),
        reflection: Mirror { reflectance: 0.5 },
        transmission: (),
    };
    let mirror = |y| Object {
        shape: Plane {
            point: Vec3::Y * y,
            normal: Vec3::Y,
        },
        material: &silver,
    };
    let mirrors = [mirror(0.0), mirror(1.0)];
    let scene = Scene {
        geometry: mirrors.as_slice(),
        lights: &[] as &[Light],
        background: Vec3::ONE,
        ambient: Vec3::ONE,
    };
    // The eye's ray and four bounces.
    let up = Ray::new(Vec3::Y * 0.5, Vec3::Y);
    let radiance = Tracer::<5>::new().radiance(&scene, up);
    assert_eq!(radiance, Vec3::splat(0.242_187_5));
    assert_eq!(whitted::picture::to_rgb8(radiance), [62; 3]);
}

/// What a ray sees of one object, in a scene with all that a material can do.
fn seen<S: Shape>(shape: S, ray: Ray) -> Vec3 {
    let finish = Material {
        color: Vec3::ONE,
        ambient: 0.5,
        diffuse: 0.5,
        highlight: PhongReal {
            specular: 0.5,
            shininess: 7.5,
        },
        reflection: Mirror { reflectance: 0.25 },
        transmission: Glass {
            transmittance: 0.25,
            ior: 1.5,
        },
    };
    let object = [Object {
        shape,
        material: &finish,
    }];
    let light = [Light {
        position: Vec3::new(3.0, 5.0, 7.0),
        color: Vec3::ONE,
    }];
    let scene = Scene {
        geometry: object.as_slice(),
        lights: &light,
        background: BACKGROUND,
        ambient: Vec3::ONE,
    };
    Tracer::<5>::new().radiance(&scene, ray)
}

const BACKGROUND: Vec3 = Vec3::new(0.25, 0.5, 0.75);

#[test]
fn c37_what_is_not_a_number_is_background() {
    let (nan, inf) = (f32::NAN, f32::INFINITY);
    let rays = [
        ("no direction", ray([0.0, 0.0, -3.0], [0.0; 3])),
        ("direction NaN", ray([0.0, 0.0, -3.0], [nan, 0.0, 1.0])),
        ("direction all NaN", ray([0.0, 0.0, -3.0], [nan; 3])),
        ("origin infinite", ray([inf, 0.0, 0.0], [0.0, 0.0, 1.0])),
        (
            "origin infinite, from the other side",
            ray([-inf, 0.0, 0.0], [1.0, 0.0, 0.0]),
        ),
        ("origin NaN", ray([nan, 0.0, -3.0], [0.0, 0.0, 1.0])),
    ];
    let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let square = flat(square);
    let triangle = [square[0], square[1], square[2]];
    for (case, ray) in rays {
        let pictures = [
            ("sphere", seen(Sphere::new(Vec3::ZERO, 1.0).unwrap(), ray)),
            ("plane", seen(Plane::new(Vec3::ZERO, Vec3::Z).unwrap(), ray)),
            ("polygon", seen(Polygon::new(&square).unwrap(), ray)),
            ("triangle", seen(Triangle::new(triangle).unwrap(), ray)),
            (
                "patch",
                seen(Patch::new(triangle, [Vec3::Z; 3]).unwrap(), ray),
            ),
            (
                "box",
                seen(Cuboid::new(Vec3::NEG_ONE, Vec3::ONE).unwrap(), ray),
            ),
            (
                "frustum",
                seen(Frustum::new(Vec3::NEG_Z, 1.0, Vec3::Z, 0.5).unwrap(), ray),
            ),
        ];
        for (shape, color) in pictures {
            assert_eq!(color, BACKGROUND, "{case}, {shape}");
        }
    }

    let fine = ray([0.0, 0.0, -3.0], [0.0, 0.0, 1.0]);
    for bad in [nan, inf] {
        assert_eq!(Sphere::new(Vec3::ZERO, bad), Err(SphereError::NotFinite));
        let mut outline = square;
        outline[2].y = bad;
        assert_eq!(Polygon::new(&outline), Err(PolygonError::NotFinite(2)));
        let normal = Vec3::Z;
        let forced = [
            (
                "radius",
                seen(
                    Sphere {
                        center: Vec3::ZERO,
                        radius: bad,
                    },
                    fine,
                ),
            ),
            (
                "center",
                seen(
                    Sphere {
                        center: Vec3::X * bad,
                        radius: 1.0,
                    },
                    fine,
                ),
            ),
            (
                "point",
                seen(
                    Plane {
                        point: Vec3::Z * bad,
                        normal,
                    },
                    fine,
                ),
            ),
            (
                "normal",
                seen(
                    Plane {
                        point: Vec3::ZERO,
                        normal: Vec3::splat(nan),
                    },
                    fine,
                ),
            ),
            (
                "polygon's normal",
                seen(
                    Polygon {
                        vertices: &square,
                        normal: Vec3::NAN,
                    },
                    fine,
                ),
            ),
        ];
        for (field, color) in forced {
            assert_eq!(color, BACKGROUND, "{field} {bad}");
        }
        assert!(
            seen(
                Polygon {
                    vertices: &outline,
                    normal
                },
                fine
            )
            .is_finite(),
            "vertex {bad}"
        );
    }
}

#[test]
fn c38_lights_at_behind_and_beside_a_surface_add_nothing() {
    let shiny = Material {
        color: Vec3::ONE,
        ambient: 0.0,
        diffuse: 1.0,
        highlight: Phong {
            specular: 1.0,
            shininess: 1,
        },
        reflection: (),
        transmission: (),
    };
    let floor = [Object {
        shape: Plane {
            point: Vec3::ZERO,
            normal: Vec3::Y,
        },
        material: &shiny,
    }];
    // So flat that the mirrored view is 30 degrees from a light just below the horizon.
    let flat = ray([-(0.75_f32.sqrt()), 0.5, 0.0], [0.75_f32.sqrt(), -0.5, 0.0]);
    let cases = [
        ("C38a at the point", Vec3::ZERO, 0.0),
        (
            "C38b behind, though the mirrored view sees it",
            Vec3::new(1.0, -0.1, 0.0),
            0.0,
        ),
        ("C38c in the plane", Vec3::new(1.0, 0.0, 0.0), 0.0),
        (
            "where the mirrored view goes",
            Vec3::new(0.75_f32.sqrt(), 0.5, 0.0),
            1.5,
        ),
    ];
    for (case, position, expected) in cases {
        let lights = [Light {
            position,
            color: Vec3::ONE,
        }];
        let scene = Scene {
            geometry: floor.as_slice(),
            lights: &lights,
            background: Vec3::ONE,
            ambient: Vec3::ONE,
        };
        let straight = Ray::new(Vec3::Y, Vec3::NEG_Y);
        let color = Tracer::<1>::new().radiance(&scene, flat);
        assert!(
            (color - Vec3::splat(expected)).length() < 1e-6,
            "{case}: {color}"
        );
        if expected == 0.0 {
            assert_eq!(color, Vec3::ZERO, "{case}");
            assert_eq!(
                Tracer::<1>::new().radiance(&scene, straight),
                Vec3::ZERO,
                "{case}"
            );
        }
    }
}

#[test]
fn c39_degenerate_cameras_are_refused() {
    use CameraError::*;
    let (eye, target, up) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(0.0, 2.0, 3.0), Vec3::Y);
    let tangent = |degrees: f32| (0.5 * degrees).to_radians().tan();
    let look = |target, up, degrees| Camera::look_at(eye, target, up, tangent(degrees), 1.0).err();
    let window = |left, right, bottom, top, distance| {
        Camera::frustum(eye, target, up, left, right, bottom, top, distance).err()
    };
    let cases = [
        ("none", look(target, up, 60.0), None),
        (
            "up along the view",
            look(target, Vec3::X, 60.0),
            Some(UpAlongView),
        ),
        (
            "up against the view",
            look(target, Vec3::NEG_X, 60.0),
            Some(UpAlongView),
        ),
        ("no up", look(target, Vec3::ZERO, 60.0), Some(UpAlongView)),
        ("0 degrees", look(target, up, 0.0), Some(FieldOfView)),
        ("180 degrees", look(target, up, 180.0), Some(FieldOfView)),
        ("NaN degrees", look(target, up, f32::NAN), Some(FieldOfView)),
        (
            "more than 180 degrees",
            look(target, up, 200.0),
            Some(FieldOfView),
        ),
        ("eye at target", look(eye, up, 60.0), Some(NoDirection)),
        ("target NaN", look(Vec3::NAN, up, 60.0), Some(NotFinite)),
        (
            "up infinite",
            look(target, Vec3::INFINITY, 60.0),
            Some(NotFinite),
        ),
        ("no width", window(1.0, 1.0, -1.0, 1.0, 1.0), Some(NoExtent)),
        (
            "no height",
            window(-1.0, 1.0, 1.0, 1.0, 1.0),
            Some(NoExtent),
        ),
        (
            "image plane behind",
            window(-1.0, 1.0, -1.0, 1.0, -1.0),
            Some(Distance),
        ),
        (
            "edge NaN",
            window(f32::NAN, 1.0, -1.0, 1.0, 1.0),
            Some(NotFinite),
        ),
    ];
    for (case, error, expected) in cases {
        assert_eq!(error, expected, "{case}");
    }
    let camera = Camera::look_at(eye, target, up, tangent(60.0), 1.0).unwrap();
    assert_eq!(
        View {
            camera,
            width: 0,
            height: 5
        }
        .rays(0)
        .count(),
        0
    );
    assert!(
        View {
            camera,
            width: 5,
            height: 0
        }
        .rays(0)
        .len()
            == 5,
        "rows are the caller's"
    );
}

#[test]
fn c40_of_equal_hits_the_first_object_wins_everywhere() {
    let sphere = |material| Object {
        shape: Sphere {
            center: Vec3::new(0.1, 0.2, -3.0),
            radius: 0.9,
        },
        material,
    };
    let outline = square(-0.5, -0.5).map(|v| v - Vec3::Z * 2.5);
    let tile = |material| Object {
        shape: Polygon::new(&outline).unwrap(),
        material,
    };
    let (spheres, tiles) = ([sphere(&0), sphere(&1)], [tile(&2), tile(&3)]);
    let (one, other) = spheres.split_at(1);
    let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 0.5, 1.0).unwrap();
    let view = View {
        camera,
        width: 64,
        height: 64,
    };
    let mut hits = [0; 4];
    for ray in (0..64).flat_map(|row| view.rays(row)) {
        if let Some(hit) = spheres.as_slice().closest_hit(&ray) {
            assert_eq!((hit.object, *hit.material), (0, 0));
            hits[0] += 1;
        }
        if let Some(hit) = tiles.as_slice().closest_hit(&ray) {
            assert_eq!((hit.object, *hit.material), (0, 2));
            hits[1] += 1;
        }
        if let Some(hit) = (one, other).closest_hit(&ray) {
            assert_eq!(
                (hit.object, *hit.material),
                (0, 0),
                "left of the pair first"
            );
            hits[2] += 1;
        }
        // The whole set twice: what stands further back never wins.
        let all = (spheres.as_slice(), tiles.as_slice());
        if let (Some(hit), Some(twice)) = (all.closest_hit(&ray), (all, all).closest_hit(&ray)) {
            assert_eq!(hit, twice);
            hits[3] += 1;
        }
    }
    assert!(
        hits.iter().all(|&count| count > 500),
        "{hits:?} hits prove nothing"
    );
}
