//! What holds every hit that the kernels report on a shape.

use glam::{BVec3, DVec3, Vec3};
use whitted::hierarchy::SLACK;
use whitted::{Cuboid, Frustum, Patch, Polygon, Quadric, Sphere, Torus, Triangle};

/// A box round all points at which rays can be met by a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Least coordinates.
    pub min: Vec3,
    /// Greatest coordinates.
    pub max: Vec3,
    /// How far off the box hits may be reported: times the greatest coordinate of the ray's origin and
    /// of the box. [`SLACK`] is twice what the shapes of [`whitted::shape`] need, but for steep cones.
    pub slack: f32,
}

/// A shape that has bounds.
pub trait Bounded {
    /// The box that holds it.
    fn bounds(&self) -> Bounds;

    /// Balls whose convex hull holds it, each a center and a radius; none where hits are not
    /// reported where the surface is, as for outlines.
    fn balls(&self) -> Vec<(DVec3, f64)> {
        Vec::new()
    }
}

impl Bounds {
    /// Round a box in `f64`, outwards.
    fn around(min: [f64; 3], max: [f64; 3], slack: f32) -> Self {
        let below = |x: f64| {
            let near = x as f32;
            if f64::from(near) > x {
                near.next_down()
            } else {
                near
            }
        };
        Self {
            min: Vec3::from_array(min.map(below)),
            max: Vec3::from_array(max.map(|x| -below(-x))),
            slack,
        }
    }

    /// Of an outline in the plane with this normal.
    fn of_outline(vertices: &[Vec3], normal: Vec3) -> Self {
        let (mut min, mut max) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
        let normal = normal.as_dvec3();
        for vertex in vertices {
            let vertex = vertex.as_dvec3();
            for (axis, x) in vertex.to_array().into_iter().enumerate() {
                min[axis] = min[axis].min(x);
                max[axis] = max[axis].max(x);
            }
            let height = normal.dot(vertex);
            lowest = lowest.min(height);
            highest = highest.max(height);
        }
        // The plane through one vertex is met, which the others may be off. A ray goes up to 8 times
        // as far between the two before it counts as edge-on.
        let warp = 8.0 * (highest - lowest);
        Self::around(min.map(|x| x - warp), max.map(|x| x + warp), SLACK)
    }
}

impl Bounded for Sphere {
    fn bounds(&self) -> Bounds {
        let (center, radius) = (self.center.to_array(), f64::from(self.radius.abs()));
        Bounds::around(
            center.map(|x| f64::from(x) - radius),
            center.map(|x| f64::from(x) + radius),
            SLACK,
        )
    }

    fn balls(&self) -> Vec<(DVec3, f64)> {
        vec![(self.center.as_dvec3(), f64::from(self.radius.abs()))]
    }
}

impl Bounded for Polygon<'_> {
    fn bounds(&self) -> Bounds {
        Bounds::of_outline(self.vertices, self.normal)
    }
}

impl Bounded for Triangle {
    fn bounds(&self) -> Bounds {
        Bounds::of_outline(&self.vertices, self.normal)
    }
}

impl Bounded for Patch {
    fn bounds(&self) -> Bounds {
        Bounds::of_outline(&self.vertices, self.normal)
    }
}

impl Bounded for Cuboid {
    fn bounds(&self) -> Bounds {
        Bounds {
            min: self.min,
            max: self.max,
            slack: SLACK,
        }
    }

    fn balls(&self) -> Vec<(DVec3, f64)> {
        let (min, max) = (self.min.as_dvec3(), self.max.as_dvec3());
        let corner = |corner: u8| {
            let is_max = |axis: u8| corner & 1 << axis != 0;
            (
                DVec3::select(BVec3::new(is_max(0), is_max(1), is_max(2)), max, min),
                0.0,
            )
        };
        (0..8).map(corner).collect()
    }
}

impl Bounded for Torus {
    fn bounds(&self) -> Bounds {
        let (major, minor) = (f64::from(self.major), f64::from(self.minor));
        let (center, axis) = (self.center.to_array(), self.axis.to_array());
        let reach = axis.map(|x| {
            let across = (1.0 - f64::from(x) * f64::from(x)).max(0.0).sqrt();
            across * major + minor
        });
        let corner = |side: f64| [0, 1, 2].map(|i| f64::from(center[i]) + side * reach[i]);
        Bounds::around(corner(-1.0), corner(1.0), SLACK)
    }

    fn balls(&self) -> Vec<(DVec3, f64)> {
        let reach = f64::from(self.major) + f64::from(self.minor);
        vec![(self.center.as_dvec3(), reach)]
    }
}

/// What its clip lets through, wherever the quadric is: a hit is compared with that.
impl Bounded for Quadric {
    fn bounds(&self) -> Bounds {
        let center = self.center.as_dvec3();
        let (min, max) = (self.clip.min.as_dvec3(), self.clip.max.as_dvec3());
        Bounds::around((center + min).to_array(), (center + max).to_array(), SLACK)
    }

    fn balls(&self) -> Vec<(DVec3, f64)> {
        let Bounds { min, max, .. } = self.bounds();
        Cuboid { min, max }.balls()
    }
}

impl Bounded for Frustum {
    fn bounds(&self) -> Bounds {
        let axis = self.axis.as_dvec3().to_array();
        let stray = stray(self);
        let (mut min, mut max) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for (center, radius) in ends(self) {
            for (i, x) in center.to_array().into_iter().enumerate() {
                // A circle reaches as far along a coordinate axis as that is across its own.
                let across = (1.0 - axis[i] * axis[i]).max(0.0).sqrt();
                let reach = across * radius + stray;
                min[i] = min[i].min(x - reach);
                max[i] = max[i].max(x + reach);
            }
        }
        // Just beyond an end, a steep cone is wider by its slope.
        Bounds::around(min, max, SLACK * (1.0 + self.slope.abs()))
    }

    fn balls(&self) -> Vec<(DVec3, f64)> {
        let stray = stray(self);
        ends(self)
            .map(|(center, radius)| (center, radius + stray))
            .to_vec()
    }
}

/// Centers and radii of both ends.
fn ends(frustum: &Frustum) -> [(DVec3, f64); 2] {
    let length = f64::from(frustum.length);
    let base_radius = f64::from(frustum.base_radius);
    let apex_radius = base_radius + f64::from(frustum.slope) * length;
    let base = frustum.base.as_dvec3();
    let apex = base + frustum.axis.as_dvec3() * length;
    [(base, base_radius.abs()), (apex, apex_radius.abs())]
}

/// How far off its side a frustum may be met by a ray that is parallel to it there, if its base is the
/// wider end: the kernel's quadratic is then nearly linear, and what it leaves is not small against the
/// radius at that point, only its root against the whole frustum. Constructors put the narrower end
/// first, but fields are public.
fn stray(frustum: &Frustum) -> f64 {
    let [base, apex] = ends(frustum).map(|it| it.1);
    let size = f64::from(frustum.length) + base.max(apex);
    size * (1.0 + f64::from(frustum.slope.abs())) / 2048.0
}
