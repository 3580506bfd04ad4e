//! Ray and a box with a round hole.
//!
//! All methods ask the kernels of `whitted` where the ray crosses the box and the cylinder. They differ in how
//! they join that: where a face of one lies in a face of the other, rounding says which comes first.

use glam::Vec3;
use whitted::csg::{Csg, Difference};
use whitted::{Candidates, Closed, Cuboid, Exact, Geometry, Object, Quadric, Ray};

use crate::{Method, quadric};

type Bored = Difference<Object<'static, Cuboid, ()>, Object<'static, Quadric, ()>>;

/// A box from which a closed quadric is taken away.
#[derive(Clone, Copy, Debug)]
pub struct Carved(pub Csg<Bored, 6>);

impl Carved {
    /// These two.
    pub const fn new(outer: Cuboid, inner: Quadric) -> Self {
        Self(Csg(Difference(
            Object {
                shape: outer,
                material: &(),
            },
            Object {
                shape: inner,
                material: &(),
            },
        )))
    }

    /// What is left, and what is taken away.
    pub const fn parts(&self) -> (Cuboid, Quadric) {
        let Csg(Difference(outer, inner)) = &self.0;
        (outer.shape, inner.shape)
    }

    fn contains(&self, point: Vec3) -> bool {
        let (outer, inner) = self.parts();
        let (min, max) = (point.cmpge(outer.min), point.cmple(outer.max));
        min.all() && max.all() && !quadric::contains(&inner, point)
    }
}

/// Distance to the nearest point of the surface that the ray admits.
pub type SolidMethod = Method<fn(&Ray, &Carved) -> Option<f32>>;

/// All methods.
pub const METHODS: &[SolidMethod] = &[
    Method::new("core", core),
    Method::new("intervals", intervals),
    Method::new("points, 1e-4 aside", points),
    Method::new("points, 1e-5 t aside", points_relative),
    Method::new("256 steps, halved", steps),
];

/// The way of `whitted`: all crossings in order, of which those that coincide count as one.
#[inline(never)]
pub fn core(ray: &Ray, carved: &Carved) -> Option<f32> {
    let mut ray = *ray;
    carved.0.nearest::<Exact>(&mut ray, 0, Candidates::ALL)?;
    Some(ray.t_max)
}

/// Where the ray crosses what is left and what is taken away, in order; infinity for what it does not cross.
#[inline(always)]
fn crossings(ray: &Ray, carved: &Carved) -> [(f32, bool); 6] {
    let (outer, inner) = carved.parts();
    let mut all = [(f32::INFINITY, false); 6];
    let mut places = all.iter_mut();
    outer.cross::<Exact>(ray, None, &mut |t| {
        if let Some(place) = places.next() {
            *place = (t, false);
        }
    });
    inner.cross::<Exact>(ray, None, &mut |t| {
        if let Some(place) = places.next() {
            *place = (t, true);
        }
    });
    all.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    all
}

/// Ends of intervals, compared as they are: S. D. Roth, "Ray Casting for Modeling Solids", Computer Graphics
/// and Image Processing 18(2), 1982. None of the rays ends inside.
#[inline(never)]
pub fn intervals(ray: &Ray, carved: &Carved) -> Option<f32> {
    let all = crossings(ray, carved);
    let odd = |inner: bool| {
        all.iter()
            .filter(|it| it.0.is_finite() && it.1 == inner)
            .count()
            % 2
            == 1
    };
    let (mut outside, mut inside) = (odd(false), odd(true));
    let was = outside && !inside;
    let mut changed = None;
    for (t, is_inner) in all {
        // What is crossed at one distance is crossed at once.
        if changed.is_some_and(|it| it < t) || !ray.admits(t) {
            break;
        }
        if is_inner {
            inside = !inside;
        } else {
            outside = !outside;
        }
        changed = ((outside && !inside) != was).then_some(t);
    }
    changed
}

#[inline(always)]
fn by_points(ray: &Ray, carved: &Carved, aside: impl Fn(f32) -> f32) -> Option<f32> {
    for (t, _) in crossings(ray, carved) {
        if !ray.admits(t) {
            break;
        }
        let aside = aside(t);
        if carved.contains(ray.at(t - aside)) != carved.contains(ray.at(t + aside)) {
            return Some(t);
        }
    }
    None
}

/// Of all crossings the first before and behind which points differ.
#[inline(never)]
pub fn points(ray: &Ray, carved: &Carved) -> Option<f32> {
    by_points(ray, carved, |_| 1e-4)
}

/// The same with points that lie the farther aside the farther the crossing is away.
#[inline(never)]
pub fn points_relative(ray: &Ray, carved: &Carved) -> Option<f32> {
    by_points(ray, carved, |t| 1e-5 * t)
}

/// Points alone: the first step at which they differ, halved 20 times.
#[inline(never)]
pub fn steps(ray: &Ray, carved: &Carved) -> Option<f32> {
    let (outer, _) = carved.parts();
    let (mut start, mut end) = (f32::INFINITY, 0.0);
    outer.cross::<Exact>(ray, None, &mut |t| {
        start = if t < start { t } else { start };
        end = t;
    });
    let step = (end - start) * (1.0 / 256.0);
    if !(step > 0.0) {
        return None;
    }
    let mut low = start - step;
    let was = carved.contains(ray.at(low));
    for count in 0..258 {
        let mut high = start + step * count as f32;
        if carved.contains(ray.at(high)) == was {
            low = high;
            continue;
        }
        for _ in 0..20 {
            let middle = 0.5 * (low + high);
            if carved.contains(ray.at(middle)) == was {
                low = middle;
            } else {
                high = middle;
            }
        }
        return ray.admitted(high);
    }
    None
}
