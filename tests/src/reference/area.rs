//! Lights that are no points: the share of them that a point sees.

use std::f64::consts::FRAC_PI_4;

use glam::DVec3;

use super::{Ray, Scene};

/// What a light is around its middle, and how closely it is looked at.
#[derive(Clone, Copy, Debug)]
pub struct Area {
    /// Its form.
    pub extent: Extent,
    /// How many samples to a side are taken where those between them may differ.
    pub most: u32,
    /// How many are taken everywhere.
    pub least: u32,
}

/// The form of a light.
#[derive(Clone, Copy, Debug)]
pub enum Extent {
    /// A parallelogram of these edges.
    Rect([DVec3; 2]),
    /// A disk of this radius that faces whoever looks.
    Disk(f64),
}

impl Extent {
    /// Where, from the middle, something is whose place in the square from -1 to 1 is (u, v).
    fn at(self, [u, v]: [f64; 2], towards: DVec3) -> DVec3 {
        match self {
            Extent::Rect([a, b]) => 0.5 * (u * a + v * b),
            Extent::Disk(radius) => {
                // The upright axis is turned to `towards` the short way, or away from it, and takes the
                // level ones along.
                let upright = DVec3::new(0.0, 1.0_f64.copysign(towards.y), 0.0);
                let both = towards + upright;
                let turned =
                    |axis: DVec3| axis - both * (axis.dot(towards) / (1.0 + towards.dot(upright)));
                let (a, b) = (turned(DVec3::Z), upright.y * turned(DVec3::X));
                // Squares around the middle become circles, and stay evenly filled.
                let (along, across) = if v.abs() > u.abs() {
                    let (sin, cos) = (FRAC_PI_4 * u / v).sin_cos();
                    (v * sin, v * cos)
                } else {
                    let (sin, cos) = (FRAC_PI_4 * v / u).sin_cos();
                    (u * cos, u * sin)
                };
                radius * (along * a + across * b)
            }
        }
    }
}

impl Scene {
    /// Share of a light that arrives where `shadow` starts, which points to its middle.
    pub(super) fn seen_share(
        &self,
        position: DVec3,
        area: &Area,
        shadow: Ray,
        normal: DVec3,
    ) -> DVec3 {
        if area.most == 1 {
            return self.transmittance(shadow, shadow.origin.distance(position));
        }
        let sample = |x: u32, y: u32| {
            let place = [x, y].map(|it| 2.0 * (f64::from(it) + 0.5) / f64::from(area.most) - 1.0);
            let target = position + area.extent.at(place, shadow.direction);
            let distance = shadow.origin.distance(target);
            let direction = (target - shadow.origin) / distance;
            if normal.dot(direction) > 0.0 {
                let ray = Ray {
                    direction,
                    ..shadow
                };
                self.transmittance(ray, distance)
            } else {
                DVec3::ZERO
            }
        };
        mean(&sample, [0, 0], area.most, area)
    }
}

/// The mean of a square's samples, `side` to a side from one corner on: that of its four corners where
/// they are alike and lie as closely as is asked for everywhere, else that of its four quarters.
fn mean(sample: &impl Fn(u32, u32) -> DVec3, [x, y]: [u32; 2], side: u32, area: &Area) -> DVec3 {
    let last = side - 1;
    let corners = [
        sample(x, y),
        sample(x + last, y),
        sample(x, y + last),
        sample(x + last, y + last),
    ];
    let alike = corners.iter().all(|it| *it == corners[0]);
    if side == 2 || (alike && area.least * side <= 2 * area.most) {
        return corners.iter().sum::<DVec3>() / 4.0;
    }
    let half = side / 2;
    let quarters = [[x, y], [x + half, y], [x, y + half], [x + half, y + half]];
    let means = quarters.map(|quarter| mean(sample, quarter, half, area));
    means.iter().sum::<DVec3>() / 4.0
}
