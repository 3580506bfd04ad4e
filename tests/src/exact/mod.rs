//! Where rays meet surfaces, exactly.
//!
//! Inputs are taken as the `f32` that they are. Signs of predicates are those of exact arithmetic, and
//! distances have at least 40 certain bits, which is 2^-16 of the unit in which errors are counted;
//! the formulas run in `f64` with a running error bound first and, where that decides nothing, in
//! binary floats of unlimited length ([`number`]). Nothing here is shared with `whitted`.
//!
//! Two measures judge an answer, both in units of `u = 2^-24`, the rounding of an `f32`:
//!
//! - The *backward error* of a distance: by what relative change of the inputs the surface would pass
//!   through the point at that distance. To first order that is the point's distance from the surface
//!   over `u (Σ |n_i| (|o_i| + |t d_i| + |c_i|) + r)`, with the unit normal `n` there, `c` and `r` what
//!   the surface is given by.
//! - The *band* of a wrong hit or miss: by what relative change of the inputs the answer would be right;
//!   that is, how far the ray is from the silhouette or the origin from the surface, in the same unit.
//!
//! They are computed in `f64` from exact differences; that their own error is below 1e-6 u is seen from
//! 29 bits that `f64` has more.

pub mod cuboid;
pub mod frustum;
pub mod grid;
pub mod number;
pub mod placed;
pub mod plane;
pub mod polygon;
pub mod quadric;
pub mod sphere;
pub mod torus;

use number::{Bounded, Exact};

/// The unit in which errors are counted: half a step of an `f32` at 1.
pub const U: f64 = 1.0 / 16_777_216.0;

/// A ray as it is; `direction` of any length.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// Where it starts.
    pub origin: [f32; 3],
    /// Where it goes.
    pub direction: [f32; 3],
}

/// What an exact intersection is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// Distance to the nearest point of the surface in front of the origin.
    pub t: Option<f64>,
    /// Whether a hit and a miss are both right: the ray passes exactly through the outline.
    pub either: bool,
}

/// What would have to change for another answer to be right, in u.
#[derive(Clone, Copy, Debug)]
pub struct Margins {
    /// Until the line meets the surface where it does not, or no more meets it where it does.
    pub line: f64,
    /// Whether the line meets the surface, taken as closed and without ends.
    pub meets: bool,
    /// The points where it does, or would after the least change.
    pub roots: [Option<Root>; 2],
}

/// A point where a line meets a surface, taken as closed and without ends.
#[derive(Clone, Copy, Debug)]
pub struct Root {
    /// Its distance.
    pub t: f64,
    /// Whether it is in front of the origin and between the ends.
    pub counts: bool,
    /// What would have to change for it to count where it does not, or not where it does; in u.
    pub margin: f64,
}

/// How good an answer is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verdict {
    /// Backward error in u; 0 where there is no distance to judge.
    pub backward: f64,
    /// Relative error of the distance, in u.
    pub forward: f64,
    /// The band in u, of a hit that is a miss or a miss that is a hit.
    pub wrong: Option<f64>,
}

impl Truth {
    const MISS: Self = Self {
        t: None,
        either: false,
    };

    /// A hit, unless it is so far that no `f32` holds its distance.
    fn hit(t: f64) -> Self {
        Self {
            t: (t <= f64::from(f32::MAX)).then_some(t),
            either: false,
        }
    }

    /// Holds it against what it is by hand, to within the rounding of an `f64`.
    #[cfg(test)]
    fn assert_is(&self, t: Option<f64>, either: bool, name: &str) {
        assert_eq!(self.t.is_some(), t.is_some(), "{name}");
        let error = self
            .t
            .zip(t)
            .map_or(0.0, |(found, t)| (found / t - 1.0).abs());
        assert!(error < 1e-14, "{name}: {self:?}");
        assert_eq!(self.either, either, "{name}");
    }
}

/// Judges an answer. `residual` is the backward error at a distance, `margins` what is near by.
pub fn judge(
    truth: &Truth,
    answer: Option<f32>,
    residual: impl Fn(f64) -> f64,
    margins: impl FnOnce() -> Margins,
) -> Verdict {
    let right = Verdict {
        backward: 0.0,
        forward: 0.0,
        wrong: None,
    };
    match (truth.t, answer.map(f64::from)) {
        // What is no distance is a wrong answer however the ray passes.
        (_, Some(answer)) if !(answer > 0.0 && answer.is_finite()) => Verdict {
            wrong: Some(f64::INFINITY),
            ..right
        },
        (Some(t), Some(answer)) => {
            let margins = margins();
            let backward = residual(answer);
            // Another root: right only when the first one is gone, or when the surface between them is.
            let backward = match margins.other(t, answer) {
                Some(other) => {
                    let band = margins.false_hit(true, answer, f64::INFINITY);
                    backward.max(band.min(residual(0.5 * (t + other))))
                }
                None => backward,
            };
            Verdict {
                backward,
                forward: (answer - t).abs() / (t * U),
                wrong: None,
            }
        }
        (None, None) => right,
        _ if truth.either => right,
        (None, Some(answer)) => Verdict {
            wrong: Some(margins().false_hit(false, answer, residual(answer))),
            ..right
        },
        (Some(_), None) => Verdict {
            wrong: Some(margins().false_miss()),
            ..right
        },
    }
}

impl Margins {
    /// The root that is much nearer to `answer` than the one at `t` is.
    fn other(&self, t: f64, answer: f64) -> Option<f64> {
        let distance = |root: f64| (root - answer).abs();
        let mut others = self.roots.iter().flatten().map(|root| root.t);
        others.find(|&other| distance(other) < 0.5 * distance(t))
    }

    /// What has to change for a miss to be right: all roots that count have to go, or the line.
    fn false_miss(&self) -> f64 {
        let roots = self.roots.iter().flatten().filter(|root| root.counts);
        roots
            .map(|root| root.margin)
            .fold(0.0, f64::max)
            .min(self.line)
    }

    /// What has to change for a hit at `answer`, `off` the surface, to be right. `hit` is whether there
    /// is another hit.
    fn false_hit(&self, hit: bool, answer: f64, off: f64) -> f64 {
        let roots = || self.roots.iter().flatten();
        let distance = |root: &Root| (root.t - answer).abs();
        let Some(met) = roots().min_by(|a, b| distance(a).total_cmp(&distance(b))) else {
            return self.line;
        };
        // The nearest root has to count, or the surface to come to the answer; and what is nearer to
        // the origin has to go.
        let counts = if met.counts { 0.0 } else { met.margin.min(off) };
        let nearer = roots().filter(|root| root.counts && root.t < met.t);
        let change = nearer.map(|root| root.margin).fold(counts, f64::max);
        match (self.meets, hit) {
            (false, _) => change.max(self.line),
            // At the silhouette both roots are one.
            (true, true) => change.min(self.line),
            (true, false) => change,
        }
    }
}

/// The difference of two inputs: exact where their exponents are less than 29 apart, and nearly so
/// where not.
fn difference(a: [f32; 3], b: [f32; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| f64::from(a[i]) - f64::from(b[i]))
}

fn wide(v: [f32; 3]) -> [f64; 3] {
    v.map(f64::from)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// `a + b * t`.
fn along(a: [f64; 3], b: [f64; 3], t: f64) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] + b[i] * t)
}

/// `Σ |n_i| (|o_i| + |t d_i| + |c_i|)`, by how much of themselves the inputs move a point along `n`.
fn reach(normal: [f64; 3], ray: &Line, t: f64, anchor: [f32; 3]) -> f64 {
    let (o, d, c) = (wide(ray.origin), wide(ray.direction), wide(anchor));
    (0..3)
        .map(|i| normal[i].abs() * (o[i].abs() + (t * d[i]).abs() + c[i].abs()))
        .sum()
}

/// The first arithmetic that decides.
macro_rules! first_sure {
    ($solve:ident($($argument:expr),*)) => {
        $solve::<$crate::exact::Bounded>($($argument),*).unwrap_or_else(|| {
            $solve::<$crate::exact::Exact>($($argument),*).expect("exact arithmetic decides")
        })
    };
}
use first_sure;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::random::{Random, Stream};

    const MARGINS: Margins = Margins {
        line: 7.0,
        meets: true,
        roots: [
            Some(Root {
                t: 1.0,
                counts: true,
                margin: 3.0,
            }),
            Some(Root {
                t: 5.0,
                counts: true,
                margin: 4.0,
            }),
        ],
    };

    fn verdict(t: Option<f64>, answer: Option<f32>, margins: Margins) -> Verdict {
        let truth = Truth { t, either: false };
        // Off the surface by a tenth in the middle.
        let residual = |t: f64| if t == 1.0 || t == 5.0 { 0.0 } else { 0.1 };
        judge(&truth, answer, residual, || margins)
    }

    #[test]
    fn verdicts() {
        assert_eq!(verdict(Some(1.0), Some(1.0), MARGINS).backward, 0.0);
        assert_eq!(verdict(Some(1.0), Some(1.5), MARGINS).backward, 0.1);
        assert_eq!(verdict(Some(1.0), Some(1.5), MARGINS).forward, 0.5 / U);
        // A miss: both roots have to go, or the line. A hit where none is: the nearest root has to
        // count.
        assert_eq!(verdict(Some(1.0), None, MARGINS).wrong, Some(4.0));
        let near = Margins {
            line: 2.0,
            ..MARGINS
        };
        assert_eq!(verdict(Some(1.0), None, near).wrong, Some(2.0));
        let behind = Margins {
            roots: MARGINS.roots.map(|root| {
                root.map(|root| Root {
                    counts: false,
                    ..root
                })
            }),
            ..MARGINS
        };
        assert_eq!(verdict(None, Some(5.0), behind).wrong, Some(0.0));
        assert_eq!(verdict(None, Some(5.5), behind).wrong, Some(0.1));
        assert_eq!(verdict(None, None, behind).wrong, None);
        // No distance at all.
        for answer in [f32::NAN, f32::INFINITY, -1.0, 0.0] {
            assert_eq!(
                verdict(Some(1.0), Some(answer), MARGINS).wrong,
                Some(f64::INFINITY)
            );
        }
        let either = Truth {
            t: Some(1.0),
            either: true,
        };
        assert_eq!(judge(&either, None, |_| 0.0, || MARGINS).wrong, None);
    }

    #[test]
    fn another_root_is_wrong_by_what_lies_between() {
        // Between the roots the surface is a tenth away: less than what removes the first.
        assert_eq!(verdict(Some(1.0), Some(5.0), MARGINS).backward, 0.1);
    }

    /// In both arithmetics on inputs as the sweeps have them: near everything that is hard.
    #[test]
    fn the_filter_agrees_with_exact_arithmetic() {
        let mut random = Random::new(Stream {
            seed: 1,
            purpose: 2,
            cell: 3,
            chunk: 4,
        });
        let (mut decided, mut left) = (0, 0);
        let mut compare = |fast: Option<Truth>, slow: Option<Truth>| {
            let slow = slow.expect("exact arithmetic decides");
            let Some(fast) = fast else {
                left += 1;
                return;
            };
            decided += 1;
            assert_eq!(fast.either, slow.either);
            assert_eq!(fast.t.is_some(), slow.t.is_some());
            let error = fast
                .t
                .zip(slow.t)
                .map_or(0.0, |(fast, slow)| (fast / slow - 1.0).abs());
            assert!(error < 2.0_f64.powi(-39), "{fast:?} {slow:?}");
        };
        for i in 0..2000 {
            let distance = 10.0_f64.powf(random.between(0.0, 6.0));
            let direction = random.direction();
            let side = random.across(direction);
            // Within few roundings of the silhouette, or exactly through corners on a lattice.
            let miss = 1.0 + random.signed() * U * distance;
            let ray = |aim: crate::lab::random::Point| Line {
                origin: (aim - direction * distance).round().to_array(),
                direction: direction.unit().to_array(),
            };
            let tangent = ray(side * miss);
            compare(
                sphere::solve::<Bounded>(&tangent, [0.0; 3], 1.0),
                sphere::solve::<Exact>(&tangent, [0.0; 3], 1.0),
            );
            let plane = side.cross(direction).round().to_array();
            compare(
                plane::solve::<Bounded>(&tangent, [0.0; 3], plane),
                plane::solve::<Exact>(&tangent, [0.0; 3], plane),
            );
            let frustum = frustum::Side {
                base: [0.0; 3],
                axis: direction.cross(side).round().to_array(),
                length: 1.0,
                base_radius: 1.0,
                slope: (i % 3) as f32 * 0.5,
            };
            compare(
                frustum::solve::<Bounded>(&tangent, &frustum),
                frustum::solve::<Exact>(&tangent, &frustum),
            );
            let solid = crate::lab::quadric::quadric(&mut random, 0.0, whitted::Ends::Closed);
            let solid = crate::lab::quadric::exact_quadric(&solid);
            compare(
                quadric::solve::<Bounded>(&tangent, &solid),
                quadric::solve::<Exact>(&tangent, &solid),
            );
            let mut whole = || [0; 3].map(|_| random.below(5) as f32 - 2.0);
            let lattice = Line {
                origin: whole(),
                direction: whole(),
            };
            compare(
                cuboid::solve::<Bounded>(&lattice, [-1.0; 3], [1.0; 3]),
                cuboid::solve::<Exact>(&lattice, [-1.0; 3], [1.0; 3]),
            );
            let triangle = [whole(), whole(), whole()];
            if let Some(fast) = polygon::surrounds::<Bounded>(&lattice, &triangle) {
                assert_eq!(Some(fast), polygon::surrounds::<Exact>(&lattice, &triangle));
            }
        }
        assert!(
            decided > 5000 && left > 500,
            "{decided} decided, {left} left"
        );
    }
}
