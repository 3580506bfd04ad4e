//! Forty adversarial cases with exactly known answers: where the methods of ray casting fail.
//!
//! Every input is an exact `f32`. A distance is right to 2 ulp; where geometry leaves a choice, the
//! policy that the documentation states is what is checked. The numbers are those of the cases, C01
//! to C40; every geometric one asks `closest_hit` and `occluded` together.

use std::f32::consts::FRAC_1_SQRT_2;

use whitted::math::refract;
use whitted::*;

fn ray(origin: [f32; 3], direction: [f32; 3]) -> Ray {
    Ray::new(origin.into(), direction.into())
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

/// Whether a shape answers a ray as it should, alone and as the second of two of them.
fn check<S: Shape + Copy>(case: &str, shape: S, ray: Ray, t: Option<f64>, normal: Option<Vec3>) {
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
    match (hit, t) {
        (None, None) => {}
        (Some(hit), Some(t)) => {
            let error = ulps(hit.t, t);
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
        (hit, t) => panic!("{case}: {:?} where {t:?} is right", hit.map(|hit| hit.t)),
    }
}

#[test]
fn c01_to_c09_spheres() {
    let unit = |radius| Sphere {
        center: Vec3::ZERO,
        radius,
    };
    let along_z = |x, z| ray([x, 0.0, z], [0.0, 0.0, 1.0]);
    let ball = unit(1.0);
    let cases = [
        (
            "C01 touching counts",
            ball,
            along_z(1.0, -3.0),
            Some(3.0),
            Some(Vec3::X),
        ),
        (
            "C02 an ulp inside the silhouette",
            ball,
            along_z(1.0 - exp2(-24), -3.0),
            Some(2.999_654_733_022_14),
            None,
        ),
        (
            "C03 an ulp outside",
            ball,
            along_z(1.0 + exp2(-23), -3.0),
            None,
            None,
        ),
        (
            "C04 far away",
            ball,
            along_z(0.5, -1e4),
            Some(9_999.133_974_596_22),
            None,
        ),
        ("C05 far away, beside", ball, along_z(1.5, -1e4), None, None),
        (
            "C06 from the centre",
            unit(2.0),
            ray([0.0; 3], [0.0, 1.0, 0.0]),
            Some(2.0),
            Some(Vec3::NEG_Y),
        ),
        (
            "C07a off the surface, away",
            ball,
            ray([0.0, 0.0, -1.0], [0.0, 0.0, -1.0]),
            None,
            None,
        ),
        (
            "C07b across",
            ball,
            along_z(0.0, -1.0),
            Some(2.0),
            Some(Vec3::NEG_Z),
        ),
        (
            "C07c along the tangent",
            ball,
            ray([0.0, 0.0, -1.0], [1.0, 0.0, 0.0]),
            None,
            None,
        ),
        (
            "C08 through two points of a circle, direction made unit",
            Sphere {
                center: Vec3::new(6.0, 8.0, 0.0),
                radius: 5.0,
            },
            ray([0.0; 3], [0.6, 0.8, 0.0]),
            Some(5.0),
            None,
        ),
        (
            "C09 a ground of a million",
            Sphere {
                center: Vec3::new(0.0, -1e6, 0.0),
                radius: 1e6,
            },
            ray([0.0, 1.0, 0.0], [0.0, -1.0, 0.0]),
            Some(1.0),
            Some(Vec3::Y),
        ),
    ];
    for (case, sphere, ray, t, normal) in cases {
        check(case, sphere, ray, t, normal);
    }
}

#[test]
fn c07_a_ray_that_leaves_a_sphere_does_not_meet_it_where_it_starts() {
    let ball = [Object {
        shape: Sphere {
            center: Vec3::ZERO,
            radius: 1.0,
        },
        material: &(),
    }];
    let leaving = |direction, side| Ray {
        departure: Some(Departure { object: 0, side }),
        ..Ray::new(Vec3::NEG_Z, direction)
    };
    let cases = [
        ("away", leaving(Vec3::NEG_Z, Side::Outside), None),
        ("across", leaving(Vec3::Z, Side::Inside), Some(2.0)),
        (
            "along the tangent, outside",
            leaving(Vec3::X, Side::Outside),
            None,
        ),
        (
            "along the tangent, inside",
            leaving(Vec3::X, Side::Inside),
            None,
        ),
    ];
    for (case, ray, t) in cases {
        assert_eq!(
            ball.as_slice().closest_hit(&ray).map(|hit| hit.t),
            t,
            "{case}"
        );
        assert_eq!(ball.as_slice().occluded(&ray), t.is_some(), "{case}");
    }
}

#[test]
fn c11_a_sphere_without_radius_is_refused_and_never_makes_a_pixel_nan() {
    assert_eq!(Sphere::new(Vec3::ZERO, 0.0), Err(SphereError::ZeroRadius));
    let forced = Sphere {
        center: Vec3::ZERO,
        radius: 0.0,
    };
    check(
        "C11",
        forced,
        ray([0.0, 0.0, -3.0], [0.0, 0.0, 1.0]),
        None,
        None,
    );
    check(
        "C11 from inside",
        forced,
        ray([0.0; 3], [0.0, 0.0, 1.0]),
        None,
        None,
    );
    check(
        "C11 beside",
        forced,
        ray([exp2(-149), 0.0, -3.0], [0.0, 0.0, 1.0]),
        None,
        None,
    );
}

#[test]
fn c12_to_c16_planes() {
    let floor = Plane {
        point: Vec3::ZERO,
        normal: Vec3::Y,
    };
    let third = 1.0 / 3.0;
    let far = Vec3::splat(exp2(23));
    let tilted = Plane::new(far, Vec3::new(1.0, 2.0, 2.0)).unwrap();
    let cases = [
        (
            "C12 the horizon",
            floor,
            ray([0.0, 1.0, 0.0], [1.0, -exp2(-20), 0.0]),
            Some(1_048_576.0),
        ),
        (
            "C13a parallel",
            floor,
            ray([0.0, 1.0, 0.0], [1.0, 0.0, 0.0]),
            None,
        ),
        ("C13b within", floor, ray([0.0; 3], [1.0, 0.0, 0.0]), None),
        (
            "C14 far from the origin, direction made unit",
            tilted,
            Ray::new(
                far + Vec3::new(1.0, 2.0, 2.0),
                Vec3::new(-third, -2.0 * third, -2.0 * third),
            ),
            Some(3.0),
        ),
        (
            "C15 upwards",
            floor,
            ray([0.0, 1.0, 0.0], [0.0, 1.0, 0.0]),
            None,
        ),
        (
            "C15 from the plane itself",
            floor,
            ray([0.0; 3], [0.0, -1.0, 0.0]),
            None,
        ),
        (
            "C15 from the plane itself, -0",
            floor,
            ray([0.0, -0.0, 0.0], [0.0, -1.0, 0.0]),
            None,
        ),
        (
            "C16 beyond f32",
            floor,
            ray([0.0, 1.0, 0.0], [1.0, -exp2(-149), 0.0]),
            None,
        ),
    ];
    for (case, plane, ray, t) in cases {
        check(case, plane, ray, t, None);
    }
}

/// Points of the plane z = 0.
fn flat<const N: usize>(points: [[f32; 2]; N]) -> [Vec3; N] {
    points.map(|[x, y]| Vec3::new(x, y, 0.0))
}

/// From above, straight down to z = 0.
fn down(x: f32, y: f32) -> Ray {
    ray([x, y, 1.0], [0.0, 0.0, -1.0])
}

fn square(x: f32, y: f32) -> [Vec3; 4] {
    flat([[x, y], [x + 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.0]])
}

/// How many of some polygons a ray meets, each asked alone.
fn meets(outlines: &[&[Vec3]], ray: Ray) -> usize {
    let met = |outline: &&&[Vec3]| {
        let object = [Object {
            shape: Polygon::new(outline).unwrap(),
            material: &(),
        }];
        let hit = object.as_slice().closest_hit(&ray);
        assert_eq!(object.as_slice().occluded(&ray), hit.is_some());
        hit.is_some_and(|hit| hit.t == 1.0)
    };
    outlines.iter().filter(met).count()
}

#[test]
fn c17_and_c18_exactly_one_of_the_owners_of_an_edge_or_a_corner_is_hit() {
    let [a, b, c, d] = [
        square(0.0, 0.0),
        square(1.0, 0.0),
        square(0.0, 1.0),
        square(1.0, 1.0),
    ];
    assert_eq!(meets(&[&a, &b], down(1.0, 0.5)), 1, "C17");
    assert_eq!(meets(&[&a, &b, &c, &d], down(1.0, 1.0)), 1, "C18");
    for edge in [[1.0, 0.5], [1.0, 1.5], [0.5, 1.0], [1.5, 1.0]] {
        assert_eq!(
            meets(&[&a, &b, &c, &d], down(edge[0], edge[1])),
            1,
            "{edge:?}"
        );
    }
    // The same from below, and for the two triangles of which each square can be made.
    let up = ray([1.0, 1.0, -1.0], [0.0, 0.0, 1.0]);
    assert_eq!(meets(&[&a, &b, &c, &d], up), 1, "C18 from below");
    let halves = |s: [Vec3; 4]| [[s[0], s[1], s[2]], [s[0], s[2], s[3]]];
    let [left, right] = halves(a);
    assert_eq!(meets(&[&left, &right], down(0.5, 0.5)), 1, "diagonal");
}

#[test]
fn c19_to_c26_outlines() {
    let corner = flat([
        [2.0, 0.0],
        [2.0, 1.0],
        [1.0, 1.0],
        [1.0, 2.0],
        [0.0, 2.0],
        [0.0, 0.0],
    ]);
    let bow_tie = flat([[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]]);
    let collinear = flat([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]);
    let repeated = flat([[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    let tiny = flat([[0.0, 0.0], [exp2(-40), 0.0], [0.0, exp2(-40)]]);
    let diamond = flat([[0.0, 0.5], [0.5, 0.0], [1.0, 0.5], [0.5, 1.0]]);
    let cases: [(&str, &[Vec3], [f32; 2], bool); 15] = [
        ("C19 the notch of an L", &corner, [1.2, 1.2], false),
        ("C20 one arm", &corner, [0.5, 1.5], true),
        ("C20 the other arm", &corner, [1.5, 0.5], true),
        ("C21 a bow-tie, left", &bow_tie, [0.25, 1.0], true),
        ("C21 a bow-tie, right", &bow_tie, [1.75, 1.0], true),
        ("C21 a bow-tie, below", &bow_tie, [1.0, 0.25], false),
        ("C21 a bow-tie, above", &bow_tie, [1.0, 1.75], false),
        ("C22 starts along a line", &collinear, [1.0, 1.0], true),
        ("C23 a vertex twice", &repeated, [0.5, 0.5], true),
        ("C24 tiny", &tiny, [exp2(-42), exp2(-42)], true),
        ("C24 tiny, beside", &tiny, [exp2(-40), exp2(-40)], false),
        ("C26 vertices beside the ray", &diamond, [0.5, 0.5], true),
        ("C26 before both vertices", &diamond, [-0.5, 0.5], false),
        ("C26 behind both vertices", &diamond, [1.5, 0.5], false),
        ("C26 beside a vertex above", &diamond, [0.25, 1.0], false),
    ];
    for (case, outline, [x, y], hit) in cases {
        let polygon = Polygon::new(outline).unwrap();
        check(
            case,
            polygon,
            down(x, y),
            hit.then_some(1.0),
            hit.then_some(Vec3::Z),
        );
        if let &[a, b, c] = outline {
            check(
                case,
                Triangle::new([a, b, c]).unwrap(),
                down(x, y),
                hit.then_some(1.0),
                None,
            );
        }
    }
}

#[test]
fn c25_an_outline_without_area_is_refused_and_never_hit() {
    let line = flat([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]);
    assert_eq!(Polygon::new(&line), Err(PolygonError::ZeroArea));
    assert_eq!(Triangle::new(line), Err(PolygonError::ZeroArea));
    let patch = Patch::new(line, [Vec3::Z; 3]);
    assert_eq!(patch, Err(PatchError::Outline(PolygonError::ZeroArea)));
    for normal in [Vec3::Z, Vec3::ZERO, Vec3::NAN] {
        for x in [0.0, 0.5, 1.0, 2.0] {
            let case = format!("C25 at {x}, normal {normal}");
            check(
                &case,
                Polygon {
                    vertices: &line,
                    normal,
                },
                down(x, 0.0),
                None,
                None,
            );
            check(
                &case,
                Triangle {
                    vertices: line,
                    normal,
                },
                down(x, 0.0),
                None,
                None,
            );
        }
    }
}

#[test]
fn c27_to_c32_boxes() {
    let die = Cuboid {
        min: Vec3::NEG_ONE,
        max: Vec3::ONE,
    };
    let card = Cuboid::new(Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 0.0, 1.0)).unwrap();
    let half = FRAC_1_SQRT_2;
    let along_x = |x, y| ray([x, y, 0.0], [1.0, 0.0, 0.0]);
    let along_x_negative_zero = |x, y| ray([x, y, 0.0], [1.0, -0.0, 0.0]);
    let diagonal = |y| ray([0.0, y, 0.0], [half, half, 0.0]);
    let left = Some(Vec3::NEG_X);
    let cases = [
        (
            "C27 along an axis",
            die,
            along_x(-2.0, 0.0),
            Some(1.0),
            left,
        ),
        (
            "C27 along an axis, -0",
            die,
            along_x_negative_zero(-2.0, 0.0),
            Some(1.0),
            left,
        ),
        (
            "C28 within a face's plane",
            die,
            along_x(-2.0, 1.0),
            Some(1.0),
            left,
        ),
        (
            "C28 within a face's plane, -0",
            die,
            along_x_negative_zero(-2.0, 1.0),
            Some(1.0),
            left,
        ),
        (
            "C28 within the lower face's plane",
            die,
            along_x(-2.0, -1.0),
            Some(1.0),
            left,
        ),
        (
            "C29 an ulp above that plane",
            die,
            along_x(-2.0, 1.0 + exp2(-23)),
            None,
            None,
        ),
        (
            "C29 the same, -0",
            die,
            along_x_negative_zero(-2.0, 1.0 + exp2(-23)),
            None,
            None,
        ),
        ("C30 from inside", die, along_x(0.0, 0.0), Some(1.0), left),
        (
            "C31 through an edge",
            die,
            diagonal(-2.0),
            Some(1.0 / f64::from(half)),
            None,
        ),
        (
            "C31 past an edge",
            die,
            diagonal(-2.0 - exp2(-22)),
            None,
            None,
        ),
        (
            "C32 no thickness",
            card,
            ray([0.0, 1.0, 0.0], [0.0, -1.0, 0.0]),
            Some(1.0),
            Some(Vec3::Y),
        ),
    ];
    for (case, cuboid, ray, t, normal) in cases {
        check(case, cuboid, ray, t, normal);
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

/// Points of a shape's surface that the shape itself hides from a light above the tangent plane, out
/// of how many seen by a camera at four times its size.
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
                "frustum from outside",
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
            // A frustum's inside is seen too, and one side of it does shadow the other.
            if name != "frustum from outside" {
                assert_eq!(hidden, 0, "{name}, 2^{exponent}: of {seen} points");
            }
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
