//! Ray and torus.
//!
//! From where the ray is closest to the center, its quartic is `t⁴ + p t² + q t + s` for a unit direction:
//! the term in t³ vanishes. Only `core` and sphere tracing do without it.

use glam::Vec3;
use libm::{acosf, cbrtf, cosf};
use whitted::math::sqrt;
use whitted::{Exact, Ray, Shape, Torus};

use crate::Method;

/// Distance to the nearest point of the torus that the ray admits.
pub type TorusMethod = Method<fn(&Ray, &Torus) -> Option<f32>>;

/// All methods.
pub const METHODS: &[TorusMethod] = &[
    Method::new("core", core),
    Method::new("Ferrari", ferrari),
    Method::new("Ferrari, Newton", ferrari_newton),
    Method::new("Sturm", sturm),
    Method::new("Bernstein", bernstein),
    Method::new("sphere tracing", sphere_tracing),
];

/// The kernel of `whitted`: Newton's method on the distance, in parts in which it is convex or concave.
#[inline(never)]
pub fn core(ray: &Ray, torus: &Torus) -> Option<f32> {
    torus.intersect::<Exact>(ray, &(), None)
}

struct Quartic {
    approach: f32,
    half_chord: f32,
    p: f32,
    q: f32,
    s: f32,
}

impl Quartic {
    #[inline(always)]
    fn new(ray: &Ray, torus: &Torus) -> Option<Self> {
        let to_center = torus.center - ray.origin;
        let approach = to_center.dot(ray.direction);
        let from_center = ray.direction * approach - to_center;
        let reach = torus.major + torus.minor;
        let square = from_center.length_squared();
        let half_chord_squared = reach * reach - square;
        if !(half_chord_squared >= 0.0) {
            return None;
        }
        let (along, rate) = (from_center.dot(torus.axis), ray.direction.dot(torus.axis));
        let across = from_center - torus.axis * along;
        let across_rate = ray.direction - torus.axis * rate;
        let scale = 4.0 * torus.major * torus.major;
        let sum = square + (torus.major - torus.minor) * (torus.major + torus.minor);
        Some(Self {
            approach,
            half_chord: sqrt(half_chord_squared),
            p: 2.0 * sum - scale * across_rate.length_squared(),
            q: -2.0 * scale * across.dot(across_rate),
            s: sum * sum - scale * across.length_squared(),
        })
    }

    #[inline(always)]
    fn at(&self, t: f32) -> f32 {
        ((t * t + self.p) * t + self.q) * t + self.s
    }

    #[inline(always)]
    fn slope(&self, t: f32) -> f32 {
        (4.0 * t * t + 2.0 * self.p) * t + self.q
    }

    /// All real roots, by way of a root of the cubic resolvent y³ + 2p y² + (p² - 4s) y - q²: L. Ferrari,
    /// in G. Cardano, Ars magna (1545), ch. 39.
    fn ferrari(&self) -> [f32; 4] {
        let Self { p, q, s, .. } = *self;
        let (b, c, d) = (2.0 * p, p * p - 4.0 * s, -q * q);
        // Depressed: z³ + 3 m z + 2 n with y = z - b / 3.
        let m = (3.0 * c - b * b) / 9.0;
        let n = (2.0 * b * b * b - 9.0 * b * c + 27.0 * d) / 54.0;
        let discriminant = n * n + m * m * m;
        let z = if discriminant >= 0.0 {
            let root = sqrt(discriminant);
            cbrtf(-n + root) + cbrtf(-n - root)
        } else {
            let angle = acosf((-n / sqrt(-m * m * m)).clamp(-1.0, 1.0));
            2.0 * sqrt(-m) * cosf(angle / 3.0)
        };
        let y = z - b / 3.0;
        let mut roots = [f32::NAN; 4];
        let halves = |u: f32, rest: f32| {
            let square = 0.25 * u * u - rest;
            let root = if square >= 0.0 {
                sqrt(square)
            } else {
                f32::NAN
            };
            [-0.5 * u - root, -0.5 * u + root]
        };
        let (one, two) = if y > 0.0 {
            let u = sqrt(y);
            let (sum, share) = (p + y, q / u);
            (
                halves(u, 0.5 * (sum - share)),
                halves(-u, 0.5 * (sum + share)),
            )
        } else {
            // Biquadratic.
            let square = p * p - 4.0 * s;
            let root = if square >= 0.0 {
                sqrt(square)
            } else {
                f32::NAN
            };
            (halves(0.0, 0.5 * (p - root)), halves(0.0, 0.5 * (p + root)))
        };
        roots[..2].copy_from_slice(&one);
        roots[2..].copy_from_slice(&two);
        roots
    }
}

#[inline(always)]
fn nearest(ray: &Ray, distances: impl IntoIterator<Item = f32>) -> Option<f32> {
    let admitted = distances.into_iter().filter(|&t| ray.admits(t));
    admitted.reduce(f32::min)
}

/// The closed form.
#[inline(never)]
pub fn ferrari(ray: &Ray, torus: &Torus) -> Option<f32> {
    let quartic = Quartic::new(ray, torus)?;
    nearest(ray, quartic.ferrari().map(|t| quartic.approach + t))
}

/// The closed form, and two steps of Newton's method on the quartic.
#[inline(never)]
pub fn ferrari_newton(ray: &Ray, torus: &Torus) -> Option<f32> {
    let quartic = Quartic::new(ray, torus)?;
    let polished = quartic.ferrari().map(|mut t| {
        for _ in 0..2 {
            let next = t - quartic.at(t) / quartic.slope(t);
            if next.is_finite() {
                t = next;
            }
        }
        quartic.approach + t
    });
    nearest(ray, polished)
}

/// Sturm's chain counts the roots, halving isolates the first and bisection finds it: at most 48 halvings.
///
/// D. G. Hook and P. R. McAree, "Using Sturm Sequences to Bracket Real Roots of Polynomial Equations",
/// Graphics Gems (1990).
#[inline(never)]
pub fn sturm(ray: &Ray, torus: &Torus) -> Option<f32> {
    let quartic = Quartic::new(ray, torus)?;
    let Quartic { p, q, s, .. } = quartic;
    // Remainders of t⁴ + p t² + q t + s and 4 t³ + 2 p t + q, with their signs turned.
    let second = [-s, -0.75 * q, -0.5 * p];
    let third = {
        // Of 4 t³ + 2 p t + q by a t² + b t + c.
        let [c, b, a] = second;
        let lead = -4.0 * b / a;
        [-(q - lead * c / a), -(2.0 * p - 4.0 * c / a - lead * b / a)]
    };
    let fourth = {
        let [c, b, a] = second;
        let t = -third[0] / third[1];
        -((a * t + b) * t + c)
    };
    let changes = |t: f32| {
        let values = [
            quartic.at(t),
            quartic.slope(t),
            (second[2] * t + second[1]) * t + second[0],
            third[1] * t + third[0],
            fourth,
        ];
        let (mut count, mut before) = (0, 0.0);
        for value in values {
            if value * before < 0.0 {
                count += 1;
            }
            if value != 0.0 {
                before = value;
            }
        }
        count
    };
    let mut low = -quartic.half_chord;
    if -quartic.approach > low {
        low = -quartic.approach;
    }
    let mut high = quartic.half_chord;
    let (at_low, mut at_high) = (changes(low), changes(high));
    if at_low <= at_high {
        return None;
    }
    for _ in 0..48 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        let at_middle = changes(middle);
        if at_low > at_middle {
            (high, at_high) = (middle, at_middle);
        } else {
            low = middle;
        }
    }
    let _ = at_high;
    ray.admitted(quartic.approach + high)
}

/// Coefficients in Bernstein's basis bound the number of roots by their changes of sign; halves until there
/// is one or none, and bisects: at most 48 halvings of at most 4 pieces at a time.
///
/// G. E. Collins and A. G. Akritas, "Polynomial Real Root Isolation Using Descartes' Rule of Signs", SYMSAC
/// 1976; J. M. Lane and R. F. Riesenfeld, "Bounds on a Polynomial", BIT 21 (1981).
#[inline(never)]
pub fn bernstein(ray: &Ray, torus: &Torus) -> Option<f32> {
    let quartic = Quartic::new(ray, torus)?;
    let Quartic { p, q, s, .. } = quartic;
    let mut low = -quartic.half_chord;
    if -quartic.approach > low {
        low = -quartic.approach;
    }
    let width = quartic.half_chord - low;
    // In powers of x, t = low + width x.
    let w2 = width * width;
    let powers = [
        quartic.at(low),
        quartic.slope(low) * width,
        (6.0 * low * low + p) * w2,
        4.0 * low * w2 * width,
        w2 * w2,
    ];
    let [a, b, c, d, e] = powers;
    let _ = (q, s);
    let whole = [
        a,
        a + b / 4.0,
        a + b / 2.0 + c / 6.0,
        a + 0.75 * b + c / 2.0 + d / 4.0,
        a + b + c + d + e,
    ];
    const DEPTH: usize = 48;
    let mut waiting = [([0.0; 5], 0.0, 0.0); DEPTH];
    waiting[0] = (whole, 0.0_f32, 1.0_f32);
    let mut count = 1_usize;
    // Every piece is halved once and its right half waits.
    for _ in 0..4 * DEPTH {
        count = count.checked_sub(1)?;
        let &(piece, from, size) = waiting.get(count)?;
        let mut changes = 0;
        for pair in piece.windows(2) {
            changes += i32::from(pair[0] * pair[1] < 0.0 || pair[0] != 0.0 && pair[1] == 0.0);
        }
        if changes == 0 {
            continue;
        }
        let half = 0.5 * size;
        if from + half <= from || half < 1.0 / (1 << 23) as f32 {
            let t = quartic.approach + low + width * from;
            if ray.admits(t) {
                return Some(t);
            }
            continue;
        }
        // De Casteljau.
        let (mut left, mut right) = (piece, piece);
        for level in 1..5 {
            for i in (level..5).rev() {
                left[i] = 0.5 * (left[i - 1] + left[i]);
            }
            for i in 0..5 - level {
                right[i] = 0.5 * (right[i] + right[i + 1]);
            }
        }
        if let Some(next) = waiting.get_mut(count..count + 2) {
            next.copy_from_slice(&[(right, from + half, half), (left, from, half)]);
            count += 2;
        }
    }
    None
}

/// Steps as far as the distance from the surface, at most 256 times: J. C. Hart, "Sphere Tracing", The
/// Visual Computer 12 (1996).
#[inline(never)]
pub fn sphere_tracing(ray: &Ray, torus: &Torus) -> Option<f32> {
    let to_center = torus.center - ray.origin;
    let approach = to_center.dot(ray.direction);
    let from_center = ray.direction * approach - to_center;
    let reach = torus.major + torus.minor;
    let half_chord_squared = reach * reach - from_center.length_squared();
    if !(half_chord_squared >= 0.0) {
        return None;
    }
    let half_chord = sqrt(half_chord_squared);
    let near_enough = torus.minor * (1.0 / (1 << 21) as f32);
    let mut t = if -approach > -half_chord {
        -approach
    } else {
        -half_chord
    };
    let distance = |t: f32| {
        let q: Vec3 = from_center + ray.direction * t;
        let along = q.dot(torus.axis);
        let off = sqrt((q - torus.axis * along).length_squared()) - torus.major;
        sqrt(off * off + along * along) - torus.minor
    };
    for _ in 0..256 {
        let step = distance(t).abs();
        if step < near_enough {
            return ray.admitted(approach + t);
        }
        t += step;
        if !(t <= half_chord) {
            return None;
        }
    }
    None
}
