//! Exact intersections with a polygon: an outline seen along the ray, filled even-odd, at the distance
//! of a plane.

use std::cmp::Ordering;

use super::number::{Number, Vector};
use super::{
    Line, Margins, Root, Truth, U, cross, difference, dot, first_sure, plane, reach, wide,
};

/// The plane that gives a polygon's distance.
#[derive(Clone, Copy, Debug)]
pub enum Facing {
    /// Through the first vertex, across this vector, taken as it is.
    Normal([f32; 3]),
    /// Through the vertices themselves, in triangles from the first: where they are not flat, any of
    /// these.
    Fan,
}

/// The point of the polygon in front of the origin. Exactly on the outline a hit and a miss are both
/// right; a ray along the plane misses.
pub fn truth(ray: &Line, vertices: &[[f32; 3]], facing: Facing) -> Truth {
    let inside = first_sure!(surrounds(ray, vertices));
    let Some(inside) = inside else {
        let t = distance(ray, vertices, facing).t;
        return Truth { t, either: true };
    };
    if inside {
        distance(ray, vertices, facing)
    } else {
        Truth::MISS
    }
}

/// Whether the outline goes round the ray; `Some(None)` where the ray passes through it, `None` where
/// the arithmetic does not decide.
pub(super) fn surrounds<N: Number>(ray: &Line, vertices: &[[f32; 3]]) -> Option<Option<bool>> {
    // The ray's longest component, so that it is not zero, and the two others.
    let d = ray.direction;
    let z = if d[0].abs() > d[1].abs() && d[0].abs() > d[2].abs() {
        0
    } else if d[1].abs() > d[2].abs() {
        1
    } else {
        2
    };
    let (x, y) = ((z + 1) % 3, (z + 2) % 3);
    // Where the vertex is when the ray is looked along, times the longest component.
    let place = |v: &[f32; 3]| {
        let to = |i: usize| N::new(v[i]) - N::new(ray.origin[i]);
        let at = |i: usize| to(i) * N::new(d[z]) - to(z) * N::new(d[i]);
        (at(x), at(y))
    };
    let places: Vec<_> = vertices.iter().map(place).collect();
    let mut inside = false;
    for (i, b) in places.iter().enumerate() {
        let a = &places[(i + places.len() - 1) % places.len()];
        let (a_y, b_y) = (a.1.sign()?, b.1.sign()?);
        let side = (a.0.clone() * b.1.clone() - a.1.clone() * b.0.clone()).sign()?;
        if side == Ordering::Equal {
            let between = |a: Ordering, b: Ordering| a != b || a == Ordering::Equal;
            if between(a_y, b_y) && between(a.0.sign()?, b.0.sign()?) {
                return Some(None);
            }
        }
        let (a_above, b_above) = (a_y != Ordering::Less, b_y != Ordering::Less);
        if a_above != b_above && (side == Ordering::Greater) == b_above {
            inside = !inside;
        }
    }
    Some(Some(inside))
}

fn distance(ray: &Line, vertices: &[[f32; 3]], facing: Facing) -> Truth {
    match facing {
        Facing::Normal(normal) => plane::truth(ray, vertices[0], normal),
        Facing::Fan => first_sure!(by_vertices(ray, vertices)),
    }
}

fn by_vertices<N: Number>(ray: &Line, vertices: &[[f32; 3]]) -> Option<Truth> {
    let to = |i: usize, from: [f32; 3]| Vector::<N>::new(vertices[i]).minus(&Vector::new(from));
    let normal = to(1, vertices[0]).cross(&to(2, vertices[0]));
    let rate = normal.dot(&Vector::new(ray.direction));
    let height = normal.dot(&to(0, ray.origin));
    let (rate_sign, height_sign) = (rate.sign()?, height.sign()?);
    if rate_sign == Ordering::Equal || height_sign != rate_sign {
        return Some(Truth::MISS);
    }
    Some(Truth::hit(height.over(rate).value()?))
}

/// The planes that a distance may be of, by their unit normals through the first vertex.
fn normals(vertices: &[[f32; 3]], facing: Facing) -> Vec<[f64; 3]> {
    let triangle = |ends: &[[f32; 3]]| {
        let to = |i: usize| difference(ends[i], vertices[0]);
        let normal = cross(to(0), to(1));
        let length = dot(normal, normal).sqrt();
        normal.map(|x| x / length)
    };
    match facing {
        Facing::Normal(normal) => vec![wide(normal)],
        Facing::Fan => vertices[1..].windows(2).map(triangle).collect(),
    }
}

/// Backward error of a distance, in u.
pub fn residual(ray: &Line, vertices: &[[f32; 3]], facing: Facing, t: f64) -> f64 {
    let point = super::along(difference(ray.origin, vertices[0]), wide(ray.direction), t);
    let of = |normal: [f64; 3]| dot(normal, point).abs() / (U * reach(normal, ray, t, vertices[0]));
    normals(vertices, facing)
        .into_iter()
        .map(of)
        .fold(f64::INFINITY, f64::min)
}

/// How far the ray is from meeting the polygon otherwise.
pub fn margins(ray: &Line, vertices: &[[f32; 3]], facing: Facing) -> Margins {
    let inside = first_sure!(surrounds(ray, vertices));
    let (d, o) = (wide(ray.direction), ray.origin);
    let square = dot(d, d);
    let mut line = f64::INFINITY;
    for (i, &b) in vertices.iter().enumerate() {
        let a = vertices[(i + vertices.len() - 1) % vertices.len()];
        // Where the edge is closest to the ray: its interior or an end.
        let (edge, to_a) = (difference(b, a), difference(a, o));
        let across = cross(d, edge);
        let length = dot(across, across).sqrt();
        let s = -dot(cross(d, to_a), across) / (length * length);
        let (anchor, way) = if length > 0.0 && (0.0..=1.0).contains(&s) {
            (None, dot(to_a, across).abs() / length)
        } else {
            let anchor = if s > 1.0 { b } else { a };
            let miss = cross(difference(anchor, o), d);
            (Some(anchor), (dot(miss, miss) / square).sqrt())
        };
        let (normal, anchor, t) = match anchor {
            None => {
                let at = [0, 1, 2].map(|i| to_a[i] + s * edge[i]);
                (across.map(|x| x / length), a, dot(at, d) / square)
            }
            Some(anchor) => {
                let to = difference(anchor, o);
                let t = dot(to, d) / square;
                let miss = super::along(to, d, -t);
                (
                    miss.map(|x| if way > 0.0 { x / way } else { 0.5 }),
                    anchor,
                    t,
                )
            }
        };
        let margin = way / (U * reach(normal, ray, t, anchor));
        line = line.min(if way == 0.0 { 0.0 } else { margin });
    }
    let normal = normals(vertices, facing)[0];
    let t = dot(normal, difference(vertices[0], o)) / dot(normal, d);
    let margin = residual(ray, vertices, facing, 0.0);
    Margins {
        line,
        // Exactly through the outline is as near to the one as to the other.
        meets: inside.unwrap_or(true),
        roots: [
            Some(Root {
                t,
                counts: t > 0.0,
                margin,
            }),
            None,
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Outline<'a> = &'a [(f32, f32)];

    const FACING: Facing = Facing::Normal([0.0, 0.0, 1.0]);

    fn ask(outline: Outline<'_>, (x, y): (f32, f32)) -> Truth {
        let vertices: Vec<_> = outline.iter().map(|&(x, y)| [x, y, 0.0]).collect();
        let ray = Line {
            origin: [x, y, 1.0],
            direction: [0.0, 0.0, -1.0],
        };
        truth(&ray, &vertices, FACING)
    }

    #[test]
    fn known_answers() {
        let bent = [
            (2.0, 0.0),
            (2.0, 1.0),
            (1.0, 1.0),
            (1.0, 2.0),
            (0.0, 2.0),
            (0.0, 0.0),
        ];
        let bow = [(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0)];
        let straight = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)];
        let repeated = [(0.0, 0.0), (0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        let diamond = [(0.0, 0.5), (0.5, 0.0), (1.0, 0.5), (0.5, 1.0)];
        let small = 2.0_f32.powi(-40);
        let cases: [(Outline<'_>, (f32, f32), bool); 14] = [
            (&bent, (1.2, 1.2), false),
            (&bent, (0.5, 1.5), true),
            (&bent, (1.5, 0.5), true),
            (&bow, (0.25, 1.0), true),
            (&bow, (1.75, 1.0), true),
            (&bow, (1.0, 0.25), false),
            (&bow, (1.0, 1.75), false),
            (&straight, (1.0, 1.0), true),
            (&repeated, (0.5, 0.5), true),
            (
                &[(0.0, 0.0), (small, 0.0), (0.0, small)],
                (small / 4.0, small / 4.0),
                true,
            ),
            (&diamond, (0.5, 0.5), true),
            (&diamond, (-0.5, 0.5), false),
            (&diamond, (1.5, 0.5), false),
            (&bent, (1.0 + f32::EPSILON, 1.5), false),
        ];
        for (outline, point, inside) in cases {
            let truth = ask(outline, point);
            assert_eq!(truth.t, inside.then_some(1.0), "{outline:?} {point:?}");
            assert!(!truth.either, "{outline:?} {point:?}");
        }
    }

    #[test]
    fn on_the_outline_either_is_right() {
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        for point in [(1.0, 0.5), (0.5, 0.0), (1.0, 1.0), (0.0, 0.0)] {
            assert!(ask(&square, point).either, "{point:?}");
        }
        // On an edge's line, beyond its ends.
        assert!(!ask(&square, (2.0, 0.0)).either);
    }
}
