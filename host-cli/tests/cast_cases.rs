//! Rays whose exact answers are known, in the places where ray casters go wrong.

use std::path::Path;

use serde_json::Value;
use whitted_cli::cast::{Query, cast_lines};
use whitted_cli::scene::{HostScene, Pool};
use whitted_cli::scene_file::toml;

/// What a ray must be answered.
#[derive(Clone, Copy, Debug)]
enum Expected {
    /// At this t, to 2 units in the last place; a normal, exactly, where it is given.
    Hit(f64, Option<[f64; 3]>),
    Miss,
    /// Either, but if a hit then at this t.
    AtMost(f64),
}

use Expected::{AtMost, Hit, Miss};

fn answers(shapes: &str, rays: &str, query: Query) -> Vec<Value> {
    let text = format!("[material.m]\n{shapes}");
    let file = toml::parse(Path::new("case.toml"), &text).unwrap();
    let pool = Pool::new(&file);
    let scene = HostScene::new(&file, &pool).unwrap();
    let mut output = Vec::new();
    let lines = cast_lines(&scene, query, rays.as_bytes(), &mut output).unwrap();
    assert_eq!(lines.bad, 0, "{rays}");
    let text = String::from_utf8(output).unwrap();
    text.lines()
        .map(|it| serde_json::from_str(it).unwrap())
        .collect()
}

/// One scene, some rays, their answers; `closest_hit` and `occluded` have to agree.
fn check(name: &str, shapes: &str, cases: &[(&str, Expected)]) {
    for &(ray, expected) in cases {
        let closest = &answers(shapes, ray, Query::Closest)[0];
        let occluded = answers(shapes, ray, Query::Occluded)[0]["occluded"]
            .as_bool()
            .unwrap();
        let hit = closest["hit"].as_bool().unwrap();
        assert_eq!(hit, occluded, "{name}, {ray}: closest and occluded");
        match expected {
            Miss => assert!(!hit, "{name}, {ray}: {closest}"),
            Hit(..) => assert!(hit, "{name}, {ray}: missed"),
            AtMost(_) => {}
        }
        if let (true, Hit(t, _) | AtMost(t)) = (hit, expected) {
            let found = closest["t"].as_f64().unwrap();
            let ulp = f64::from((t as f32).next_up()) - f64::from(t as f32);
            assert!(
                (found - t).abs() <= 2.0 * ulp,
                "{name}, {ray}: {found}, not {t}"
            );
        }
        if let Hit(_, Some(normal)) = expected {
            let found = [0, 1, 2].map(|it| closest["normal"][it].as_f64().unwrap());
            assert_eq!(found, normal, "{name}, {ray}");
        }
    }
}

fn sphere(center: &str, radius: &str) -> String {
    format!("[[sphere]]\nmaterial = 'm'\ncenter = [{center}]\nradius = {radius}\n")
}

fn plane(point: &str, normal: &str) -> String {
    format!("[[plane]]\nmaterial = 'm'\npoint = [{point}]\nnormal = [{normal}]\n")
}

fn cuboid(min: &str, max: &str) -> String {
    format!("[[box]]\nmaterial = 'm'\nmin = [{min}]\nmax = [{max}]\n")
}

/// A polygon in z = 0.
fn polygon(corners: &[[f64; 2]]) -> String {
    let corners: Vec<_> = corners
        .iter()
        .map(|[x, y]| format!("[{x:e}, {y:e}, 0]"))
        .collect();
    format!(
        "[[polygon]]\nmaterial = 'm'\nvertices = [{}]\n",
        corners.join(", ")
    )
}

/// A ray down on z = 0 from a height of 1.
fn down(x: f64, y: f64) -> String {
    format!("{x:e} {y:e} 1 0 0 -1")
}

fn check_down(name: &str, shapes: &str, cases: &[(f64, f64, bool)]) {
    for &(x, y, hit) in cases {
        let expected = if hit {
            Hit(1.0, Some([0.0, 0.0, 1.0]))
        } else {
            Miss
        };
        check(name, shapes, &[(&down(x, y), expected)]);
    }
}

#[test]
fn spheres() {
    let unit = sphere("0, 0, 0", "1");
    let inside = 1.0 - 2.0_f64.powi(-24);
    let outside = 1.0 + 2.0_f64.powi(-23);
    check(
        "silhouette",
        &unit,
        &[
            ("1 0 -3 0 0 1", AtMost(3.0)),
            (
                &format!("{inside:e} 0 -3 0 0 1"),
                Hit(2.999_654_733_022_14, None),
            ),
            (&format!("{outside:e} 0 -3 0 0 1"), Miss),
        ],
    );
    check(
        "far away",
        &unit,
        &[
            ("0.5 0 -10000 0 0 1", Hit(9_999.133_974_596_22, None)),
            ("1.5 0 -10000 0 0 1", Miss),
        ],
    );
    let from_center = Hit(2.0, Some([0.0, -1.0, 0.0]));
    check(
        "from the centre",
        &sphere("0, 0, 0", "2"),
        &[("0 0 0 0 1 0", from_center)],
    );
    check(
        "from the surface",
        &unit,
        &[
            ("0 0 -1 0 0 -1", Miss),
            ("0 0 -1 0 0 1", Hit(2.0, None)),
            ("0 0 -1 1 0 0", Miss),
        ],
    );
    check(
        "not a unit direction",
        &sphere("6, 8, 0", "5"),
        &[("0 0 0 3 4 0", Hit(1.0, None))],
    );
    check(
        "the ground as a sphere",
        &sphere("0, -1e6, 0", "1e6"),
        &[("0 1 0 0 -1 0", Hit(1.0, Some([0.0, 1.0, 0.0])))],
    );
    let tiny = 2.0_f64.powi(-80);
    check(
        "squares below the least float",
        &sphere("0, 0, 0", &format!("{tiny:e}")),
        &[(
            &format!("0 0 {:e} 0 0 1", -3.0 * tiny),
            Hit(2.0 * tiny, None),
        )],
    );
    check(
        "inside only",
        &sphere("0, 0, 0", "-1"),
        &[
            ("0 0 -3 0 0 1", Hit(4.0, Some([0.0, 0.0, -1.0]))),
            ("0 0 0 0 0 1", Hit(1.0, None)),
        ],
    );
}

#[test]
fn planes() {
    let floor = plane("0, 0, 0", "0, 1, 0");
    let shallow = 2.0_f64.powi(-20);
    check(
        "nearly and exactly along it",
        &floor,
        &[
            (&format!("0 1 0 1 {:e} 0", -shallow), Hit(1_048_576.0, None)),
            ("0 1 0 1 0 0", Miss),
            ("0 0 0 1 0 0", Miss),
            ("0 1 0 0 1 0", Miss),
            ("0 0 0 0 -1 0", Miss),
            // It meets it at 2^149, which is no 32-bit float.
            ("0 1 0 1 -1.4e-45 0", Miss),
        ],
    );
    check(
        "far from the origin",
        &plane("8388608, 8388608, 8388608", "1, 2, 2"),
        &[("8388609 8388610 8388610 -1 -2 -2", Hit(1.0, None))],
    );
}

#[test]
fn polygons() {
    let square =
        |x: f64, y: f64| polygon(&[[x, y], [x + 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.0]]);
    let pair = square(0.0, 0.0) + &square(1.0, 0.0);
    check_down("a shared edge", &pair, &[(1.0, 0.5, true)]);
    let four = pair.clone() + &square(0.0, 1.0) + &square(1.0, 1.0);
    check_down("a shared corner", &four, &[(1.0, 1.0, true)]);
    // Exactly one owner of an edge or corner is hit: alone, they answer once in all.
    let alone = |squares: &[(f64, f64)], x: f64, y: f64| {
        let hits = squares.iter().filter(|it| {
            answers(&square(it.0, it.1), &down(x, y), Query::Closest)[0]["hit"] == true
        });
        hits.count()
    };
    assert_eq!(alone(&[(0.0, 0.0), (1.0, 0.0)], 1.0, 0.5), 1);
    assert_eq!(
        alone(&[(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)], 1.0, 1.0),
        1
    );

    let notched = polygon(&[[2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.], [0., 0.]]);
    let cases = [(1.2, 1.2, false), (0.5, 1.5, true), (1.5, 0.5, true)];
    check_down("concave", &notched, &cases);
    let collinear = polygon(&[[0., 0.], [1., 0.], [2., 0.], [2., 2.], [0., 2.]]);
    check_down("collinear start", &collinear, &[(1.0, 1.0, true)]);
    let repeated = polygon(&[[0., 0.], [0., 0.], [1., 0.], [1., 1.], [0., 1.]]);
    check_down("repeated corner", &repeated, &[(0.5, 0.5, true)]);
    let bow_tie = polygon(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]]);
    let cases = [
        (0.25, 1.0, true),
        (1.75, 1.0, true),
        (1.0, 0.25, false),
        (1.0, 1.75, false),
    ];
    check_down("crossing itself", &bow_tie, &cases);
    let small = 2.0_f64.powi(-40);
    let tiny = polygon(&[[0.0, 0.0], [small, 0.0], [0.0, small]]);
    check_down("tiny", &tiny, &[(small / 4.0, small / 4.0, true)]);
    let diamond = polygon(&[[0., 0.5], [0.5, 0.], [1., 0.5], [0.5, 1.]]);
    let cases = [(0.5, 0.5, true), (-0.5, 0.5, false), (1.5, 0.5, false)];
    check_down("corners on the scan line", &diamond, &cases);
}

#[test]
fn boxes() {
    let unit = cuboid("-1, -1, -1", "1, 1, 1");
    let beyond = 1.0 + 2.0_f64.powi(-23);
    let below = -2.0 - 2.0_f64.powi(-22);
    let left = Some([-1.0, 0.0, 0.0]);
    check(
        "along an axis",
        &unit,
        &[
            ("-2 0 0 1 0 0", Hit(1.0, left)),
            ("-2 0 0 1 -0.0 0.0", Hit(1.0, left)),
            ("-2 1 0 1 0 0", Hit(1.0, None)),
            ("-2 1 0 1 -0.0 0", Hit(1.0, None)),
            (&format!("-2 {beyond:e} 0 1 0 0"), Miss),
            ("0 0 0 1 0 0", Hit(1.0, left)),
        ],
    );
    check(
        "through an edge",
        &unit,
        &[
            ("0 -2 0 1 1 0", Hit(1.0, None)),
            (&format!("0 {below:e} 0 1 1 0"), Miss),
        ],
    );
    let flat = cuboid("-1, 0, -1", "1, 0, 1");
    check(
        "flat",
        &flat,
        &[("0 1 0 0 -1 0", Hit(1.0, Some([0.0, 1.0, 0.0])))],
    );
}

#[test]
fn frusta() {
    let cone = "[[cone]]\nmaterial = 'm'\nbase = [0, 0, 0]\nbase_radius = 1\napex = [0, 2, 0]\n";
    check(
        "a cone",
        cone,
        &[
            ("-3 1 0 1 0 0", Hit(2.5, None)),
            ("-3 3 0 1 0 0", Miss),
            ("-3 -0.5 0 1 0 0", Miss),
            ("0 -1 0 0 1 0", AtMost(3.0)),
            ("0 1 0 1 0 0", Hit(0.5, None)),
        ],
    );
    let pipe = "[[cylinder]]\nmaterial = 'm'\nbase = [0, 0, 0]\napex = [0, 2, 0]\nradius = -1\n";
    check(
        "a pipe that shows its inside",
        pipe,
        &[
            ("-3 1 0 1 0 0", Hit(4.0, Some([-1.0, 0.0, 0.0]))),
            ("0 -1 0 0 1 0", Miss),
            ("-3 1 1.5 1 0 0", Miss),
        ],
    );
}

#[test]
fn the_first_of_equals_wins() {
    let twins = sphere("0, 0, 0", "1") + &sphere("0, 0, 0", "1");
    assert_eq!(
        answers(&twins, "0 0 3 0 0 -1", Query::Closest)[0]["index"],
        0
    );
    let square = polygon(&[[0., 0.], [1., 0.], [1., 1.], [0., 1.]]);
    let squares = square.clone() + &square;
    for index in 0..100 {
        let ray = down(f64::from(index) / 100.0 + 0.005, 0.3);
        assert_eq!(
            answers(&squares, &ray, Query::Closest)[0]["index"],
            0,
            "{ray}"
        );
    }
}
