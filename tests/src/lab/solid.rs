//! The sweeps of a box with a round hole, whose bottom or mouth meets a side.

use whitted::hierarchy::SLACK;
use whitted::{Cuboid, Ends, Quadric, Ray, Vec3};
use whitted_methods::solid::{Carved, METHODS};

use super::random::{Point, Random};
use super::sweep::{Stage, Sweep};
use crate::exact::{U, Verdict};

/// Ray and solid. A film over the hole is a wrong hit, and so is what lies behind a cover that is there.
pub struct Solids;

/// A ray, the solid, and what the hole is.
pub struct Case {
    ray: Ray,
    carved: Carved,
    hole: Hole,
}

/// A cylinder along an axis of coordinates.
#[derive(Clone, Copy)]
struct Hole {
    axis: usize,
    /// Whether its mouth is at the greater end.
    is_up: bool,
    radius: f32,
}

/// The nearest of numbers whose sums and halves are numbers, too.
fn whole(x: f64) -> f64 {
    (x * 1024.0).round() / 1024.0
}

/// A hole in one side of a box: open where `gap` is at least zero, else under a cover as thick as that. Seen
/// from `distance` away, at an angle of this sine to the side.
fn case(random: &mut Random, gap: f64, offset: f64, distance: f64, slope: f64) -> Case {
    let middle = random.vector(3.0) + random.direction() * offset;
    let middle = Point(middle.0.map(whole));
    let half = [(); 3].map(|()| whole(random.between(0.5, 1.5)));
    let hole = Hole {
        axis: random.below(3),
        is_up: random.below(2) == 1,
        radius: random.between(0.2, 0.5) as f32,
    };
    let mut up = Point([0.0; 3]);
    up.0[hole.axis] = if hole.is_up { 1.0 } else { -1.0 };
    let mouth = middle + up * half[hole.axis];
    let half = Point(half);
    let (min, max) = ((middle - half).round(), (middle + half).round());
    let radius = hole.radius;
    let ends = [middle, mouth + up * gap].map(Point::round);
    let inner = Quadric::cylinder(ends[0], ends[1], radius, Ends::Closed).expect("a hole");
    let mut aside = || 0.9 * f64::from(radius) * random.signed();
    let mut aim = mouth;
    aim.0[(hole.axis + 1) % 3] += aside();
    aim.0[(hole.axis + 2) % 3] += aside();
    let out = random.across(up) * (1.0 - slope * slope).sqrt() + up * slope;
    let ray = Ray::new((aim + out * distance).round(), (out * -1.0).unit());
    let carved = Carved::new(Cuboid { min, max }, inner);
    Case { ray, carved, hole }
}

impl Case {
    fn scaled(self, scale: f32) -> Self {
        let (outer, inner) = self.carved.parts();
        let outer = Cuboid {
            min: outer.min * scale,
            max: outer.max * scale,
        };
        let clip = &inner.clip;
        let inner = Quadric {
            center: inner.center * scale,
            constant: inner.constant * scale * scale,
            clip: whitted::Clip {
                min: clip.min * scale,
                max: clip.max * scale,
                from: clip.from * scale,
                to: clip.to * scale,
                ..*clip
            },
            ..inner
        };
        Self {
            ray: Ray::new(self.ray.origin * scale, self.ray.direction),
            carved: Carved::new(outer, inner),
            hole: Hole {
                radius: self.hole.radius * scale,
                ..self.hole
            },
        }
    }
}

/// Where a line is in something, and the normals with which it comes and goes.
type Inside = Option<[(f64, Point); 2]>;

fn later(a: Inside, b: Inside) -> Inside {
    let ([a, b], [c, d]) = (a?, b?);
    let enter = if a.0 > c.0 { a } else { c };
    let leave = if b.0 < d.0 { b } else { d };
    (enter.0 < leave.0).then_some([enter, leave])
}

/// Between two planes across an axis.
fn between(ray: &Ray, axis: usize, ends: [f64; 2]) -> Inside {
    let (o, d) = (
        Point::new(ray.origin).0[axis],
        Point::new(ray.direction).0[axis],
    );
    let mut normal = Point([0.0; 3]);
    normal.0[axis] = 1.0;
    let [a, b] = ends.map(|end| ((end - o) / d, normal));
    Some(if a.0 < b.0 { [a, b] } else { [b, a] })
}

/// In a box that is larger by so much.
fn in_box(ray: &Ray, outer: &Cuboid, grown: f64) -> Inside {
    let (min, max) = (Point::new(outer.min).0, Point::new(outer.max).0);
    let slab = |i: usize| between(ray, i, [min[i] - grown, max[i] + grown]);
    later(later(slab(0), slab(1)), slab(2))
}

/// In a hole between these places along its axis, wider by so much.
fn in_hole(ray: &Ray, hole: &Hole, center: Vec3, ends: [f64; 2], grown: f64) -> Inside {
    let mut o = Point::new(ray.origin) - Point::new(center);
    let mut d = Point::new(ray.direction);
    o.0[hole.axis] = 0.0;
    d.0[hole.axis] = 0.0;
    let (a, b) = (d.dot(d), o.dot(d));
    let miss = o - d * (b / a);
    let square = (f64::from(hole.radius) + grown).powi(2) - miss.dot(miss);
    if square <= 0.0 {
        return None;
    }
    let root = (square / a).sqrt();
    let at = |t: f64| {
        let out = o + d * t;
        (t, out * (1.0 / out.dot(out).sqrt()))
    };
    let side = Some([at(-b / a - root), at(-b / a + root)]);
    later(side, between(ray, hole.axis, ends))
}

/// The first point in front of the origin at which the line comes into the box without the hole, or leaves it.
fn first(outer: Inside, inner: Inside) -> Option<(f64, Point)> {
    let [enter, leave] = outer?;
    let pieces = match inner {
        Some([from, to]) => [
            [enter, if from.0 < leave.0 { from } else { leave }],
            [if to.0 > enter.0 { to } else { enter }, leave],
        ],
        None => [[enter, leave], [leave, leave]],
    };
    let pieces = pieces.into_iter().filter(|[from, to]| from.0 < to.0);
    pieces.flatten().find(|(t, _)| *t > 0.0)
}

/// By how much surfaces may be off, in u: what a ray meets within that of an edge is either.
const EDGE: f64 = 32.0;

/// Whether an answer is what there is, but for rounding; or, of a cover that is thinner than `whitted`
/// promises to see, what there would be without.
fn is_right(Case { ray, carved, hole }: &Case, answer: Option<f32>) -> bool {
    let (outer, inner) = carved.parts();
    let far = f64::from(ray.origin.abs().max_element());
    let axis = hole.axis;
    let (clip, middle) = (&inner.clip, f64::from(inner.center[axis]));
    let reach = far + first(in_box(ray, &outer, 0.0), None).map_or(0.0, |it| it.0);
    let (edge, slack) = (EDGE * U * reach, f64::from(SLACK) * reach);
    // The axis runs to the mouth.
    let sign = if hole.is_up { 1.0 } else { -1.0 };
    let (bottom, mouth) = (
        middle + sign * f64::from(clip.from),
        middle + sign * f64::from(clip.to),
    );
    let side = f64::from(if hole.is_up { outer.max } else { outer.min }[axis]);
    // Beyond the side, however far that is moved, or under a cover.
    let open = side + sign * 2.0 * edge;
    let over = (mouth - side) * sign;
    let mouths = if over >= 0.0 {
        vec![open]
    } else if -over <= slack {
        vec![mouth, open]
    } else {
        vec![mouth]
    };
    let fits = |truth: Option<(f64, Point)>| match (truth, answer) {
        (None, None) => true,
        (Some((t, normal)), Some(answer)) => {
            let steep = normal.dot(Point::new(ray.direction)).abs();
            (f64::from(answer) - t).abs() * steep <= 2.0 * edge
        }
        _ => false,
    };
    let moved = [-edge, 0.0, edge];
    mouths.into_iter().any(|mouth| {
        let ends = if hole.is_up {
            [bottom, mouth]
        } else {
            [mouth, bottom]
        };
        moved.into_iter().any(|wider| {
            let outer = in_box(ray, &outer, wider);
            moved.into_iter().any(|rounder| {
                let inner = in_hole(ray, hole, inner.center, ends, rounder);
                fits(first(outer, inner))
            })
        })
    })
}

impl Stage for Solids {
    const NAME: &'static str = "solid";
    type Case = Case;

    fn sweeps() -> Vec<Sweep<Case>> {
        let small = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7];
        let steep = |random: &mut Random| random.between(0.3, 0.9);
        vec![
            Sweep::new(
                "distance",
                "distance of the origin / size, faces that coincide",
                &[2.5, 1e1, 1e2, 1e3],
                move |x, random| {
                    let slope = steep(random);
                    case(random, 0.0, 0.0, x, slope)
                },
            ),
            Sweep::new(
                "open",
                "distance between faces / size",
                &small,
                move |x, random| {
                    let slope = steep(random);
                    case(random, x, 0.0, 10.0, slope)
                },
            ),
            Sweep::new(
                "cover",
                "thickness of the cover / size",
                &small,
                move |x, random| {
                    let slope = steep(random);
                    case(random, -x, 0.0, 10.0, slope)
                },
            ),
            Sweep::new(
                "slope",
                "sine of the angle to faces that coincide",
                &[0.7, 1e-1, 1e-2, 1e-3],
                |x, random| case(random, 0.0, 0.0, 10.0, x),
            ),
            Sweep::new(
                "world offset",
                "distance of the scene from 0 / size, faces that coincide",
                &[1.0, 1e1, 1e2, 1e3],
                move |x, random| {
                    let slope = steep(random);
                    case(random, 0.0, x, 10.0, slope)
                },
            ),
            Sweep::new(
                "scale",
                "log2 of the size of everything, faces that coincide",
                &[-40.0, -20.0, 0.0, 20.0, 40.0],
                move |x, random| {
                    let slope = steep(random);
                    case(random, 0.0, 0.0, 10.0, slope).scaled(x.exp2() as f32)
                },
            ),
        ]
    }

    fn methods() -> Vec<&'static str> {
        METHODS.iter().map(|method| method.name).collect()
    }

    fn ask(case: &Case, judged: &mut dyn FnMut(usize, Verdict)) {
        for (i, method) in METHODS.iter().enumerate() {
            let is_right = is_right(case, (method.run)(&case.ray, &case.carved));
            judged(
                i,
                Verdict {
                    backward: 0.0,
                    forward: 0.0,
                    wrong: (!is_right).then_some(0.0),
                },
            );
        }
    }
}
