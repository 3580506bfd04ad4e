//! Lights that are no points, and their soft shadows.
//!
//! A surface is lit as from the middle of the light, by the share S of it that the point sees: the mean,
//! over samples, of what passes along the ray to each. Samples lie in the middles of equal parts of the
//! light, the same ones for every point: nothing is random. A part of the light below the surface's
//! horizon adds nothing, and neither does a light whose middle is.

use core::f32::consts::FRAC_PI_4;

use glam::Vec3;

use crate::math::{Math, dot, length_squared};
use crate::ray::Ray;
use crate::scene::LightSource;
use crate::subdivision::{self, MOST, Quantity};

/// How many samples of an area light are taken: 4^n, by n.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Samples {
    /// As many, spread evenly, are taken everywhere; at least 1, for four, unless `most` is 0.
    pub least: u8,
    /// Where those differ, in the penumbra, more are taken between them, up to so many. At most 4, for
    /// 256; 0 is one sample, in the middle: a point light.
    pub most: u8,
}

/// What a light is, around its middle.
pub trait Extent {
    /// Half of its width and of its height, as seen from a point that it is in `direction` of, unit
    /// length.
    fn axes(&self, direction: Vec3) -> [Vec3; 2];

    /// Where a point of the square from -1 to 1 lies in the light, along those.
    fn place(&self, point: [f32; 2]) -> [f32; 2];
}

/// A rectangle or any other parallelogram; a line or a point where its edges are none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// Two edges that meet, in world units.
    pub edges: [Vec3; 2],
}

impl Extent for Rect {
    #[inline(always)]
    fn axes(&self, _: Vec3) -> [Vec3; 2] {
        self.edges.map(|edge| edge * 0.5)
    }

    #[inline(always)]
    fn place(&self, point: [f32; 2]) -> [f32; 2] {
        point
    }
}

/// What a ball is from everywhere: the disk across its middle that faces the point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    /// In world units; 0: a point.
    pub radius: f32,
}

impl Extent for Disk {
    /// T. Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017, listing 3; turned, so
    /// that the axes jump where the light is as high as the point, and not on a floor below it.
    #[inline(always)]
    fn axes(&self, direction: Vec3) -> [Vec3; 2] {
        let [z, x, y] = direction.to_array();
        let sign = 1.0_f32.copysign(x);
        let a = -1.0 / (sign + x);
        let b = y * z * a;
        [
            Vec3::new(sign * b, -sign * y, 1.0 + sign * y * y * a),
            Vec3::new(sign + z * z * a, -z, b),
        ]
        .map(|axis| axis * self.radius)
    }

    /// P. Shirley and K. Chiu, "A Low Distortion Map between Disk and Square", JGT 2(3), 1997: equal areas
    /// stay equal.
    #[inline(always)]
    fn place(&self, [u, v]: [f32; 2]) -> [f32; 2] {
        let is_steep = v.abs() > u.abs();
        let (radius, other) = if is_steep { (v, u) } else { (u, v) };
        let turn = other / radius;
        // Sine and cosine of a quarter of pi times the turn, to within 2^-21.
        let square = turn * turn;
        let sin = turn
            * (FRAC_PI_4
                + square * (-0.080_745_51 + square * (0.002_490_395 - square * 0.000_036_576_2)));
        let cos = 1.0
            + square
                * (-0.308_425_14
                    + square
                        * (0.015_854_344
                            + square * (-0.000_325_991_9 + square * 0.000_003_590_86)));
        let (along, across) = (radius * cos, radius * sin);
        if is_steep {
            [across, along]
        } else {
            [along, across]
        }
    }
}

/// Either, for scenes that have both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outline {
    /// A rectangle.
    Rect(Rect),
    /// A disk.
    Disk(Disk),
}

impl Extent for Outline {
    #[inline]
    fn axes(&self, direction: Vec3) -> [Vec3; 2] {
        match self {
            Self::Rect(it) => it.axes(direction),
            Self::Disk(it) => it.axes(direction),
        }
    }

    #[inline]
    fn place(&self, point: [f32; 2]) -> [f32; 2] {
        match self {
            Self::Rect(it) => it.place(point),
            Self::Disk(it) => it.place(point),
        }
    }
}

/// A light with an extent, which casts soft shadows.
///
/// ```
/// use whitted::{AreaLight, Vec3, area::{Rect, Samples}};
///
/// static LIGHTS: [AreaLight<Rect>; 1] = [AreaLight {
///     position: Vec3::new(3.0, 5.0, 0.0),
///     color: Vec3::ONE,
///     extent: Rect { edges: [Vec3::X, Vec3::Z] },
///     // 4 shadow rays where they agree, else up to 64.
///     samples: Samples { least: 1, most: 3 },
/// }];
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaLight<E> {
    /// Its middle, in world space.
    pub position: Vec3,
    /// Linear RGB, at least 0: of all of it together.
    pub color: Vec3,
    /// What it is.
    pub extent: E,
    /// How closely it is looked at.
    pub samples: Samples,
}

impl<E: Extent> LightSource for AreaLight<E> {
    const IS_AREA: bool = true;

    #[inline(always)]
    fn position(&self) -> Vec3 {
        self.position
    }

    #[inline(always)]
    fn color(&self) -> Vec3 {
        self.color
    }

    #[inline(always)]
    fn casts_shadows(&self) -> bool {
        true
    }

    #[inline(always)]
    fn share<P: Math, V: Quantity>(
        &self,
        normal: Vec3,
        center: &Ray,
        mut passes: impl FnMut(&Ray) -> V,
    ) -> V {
        let most = self.samples.most.min(MOST);
        if most == 0 {
            return passes(center);
        }
        let [right, up] = self.extent.axes(center.direction);
        let to_light = self.position - center.origin;
        // 2^(1 - most): the square of the samples is from -1 to 1.
        let step = f32::from_bits((128 - u32::from(most)) << 23);
        let at = |place: u8| (f32::from(place) + 0.5) * step - 1.0;
        subdivision::mean(
            most,
            false,
            |x, y| {
                let [x, y] = self.extent.place([at(x), at(y)]);
                let to_sample = to_light + (right * x + up * y);
                // Also true for NaN, and for a sample at the point itself.
                if !(dot(&normal, &to_sample) > 0.0) {
                    return V::default();
                }
                let (distance, recip) = P::sqrt_and_recip(length_squared(&to_sample));
                passes(&Ray {
                    direction: to_sample * recip,
                    t_max: distance,
                    ..*center
                })
            },
            |[a, b, c, d], level| level + 1 < self.samples.least || a != b || a != c || a != d,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Object;
    use crate::material::{Glass, Material};
    use crate::math::Exact;
    use crate::scene::{Light, Scene};
    use crate::shape::cuboid::Cuboid;
    use crate::shape::plane::Plane;
    use crate::trace::{Counters, Tracer};

    const CHALK: Material<(), (), Glass> = Material {
        color: Vec3::ONE,
        ambient: 0.0,
        diffuse: 1.0,
        highlight: (),
        reflection: (),
        transmission: Glass {
            transmittance: 0.0,
            ior: 1.0,
        },
    };
    const GLASS: Material<(), (), Glass> = Material {
        transmission: Glass {
            transmittance: 0.5,
            ior: 1.0,
        },
        ..CHALK
    };
    const FULL: Samples = Samples { least: 4, most: 4 };
    const ADAPTIVE: Samples = Samples { least: 1, most: 4 };

    /// A light 4 above the origin.
    fn lamp<E>(extent: E, samples: Samples) -> AreaLight<E> {
        AreaLight {
            position: Vec3::Y * 4.0,
            color: Vec3::ONE,
            extent,
            samples,
        }
    }

    /// Light that a floor at y = 0 sends back from a point, with a plate above all x < 0 at half the
    /// light's height; and the shadow rays that it took.
    fn lit<L: LightSource>(light: &L, x: f32, plate: &Material<(), (), Glass>) -> (f32, u64) {
        let floor = [Object {
            shape: Plane {
                point: Vec3::ZERO,
                normal: Vec3::Y,
            },
            material: &CHALK,
        }];
        let half = [Object {
            shape: Cuboid {
                min: Vec3::new(-100.0, 2.0, -100.0),
                max: Vec3::new(0.0, 2.001, 100.0),
            },
            material: plate,
        }];
        let scene = Scene {
            geometry: (floor.as_slice(), half.as_slice()),
            lights: core::slice::from_ref(light),
            background: Vec3::ZERO,
            ambient: Vec3::ZERO,
        };
        let mut tracer = Tracer::<1, Exact, _>::with(Counters::default());
        let ray = Ray::new(Vec3::new(x, 0.001, 0.0), Vec3::NEG_Y);
        (tracer.radiance(&scene, ray).x, tracer.counters.shadow)
    }

    #[test]
    fn shadows_soften_by_the_share_of_the_light_that_is_seen() {
        let rect = Rect {
            edges: [Vec3::X, Vec3::Z],
        };
        // From x, the outline at x = 0 halfway up covers what of the light is left of -x.
        for (x, seen) in [
            (-0.75, 0.0),
            (-0.25, 0.25),
            (0.0, 0.5),
            (0.25, 0.75),
            (0.75, 1.0),
        ] {
            let height = 4.0 / f32::hypot(4.0, x);
            for samples in [FULL, ADAPTIVE] {
                let (found, rays) = lit(&lamp(rect, samples), x, &CHALK);
                let wrong = (found - seen * height).abs();
                assert!(wrong < 1e-3 + 1.0 / 16.0, "{x}: {found}, not {seen}");
                match (seen, samples) {
                    (0.0 | 1.0, ADAPTIVE) => assert_eq!(rays, 4, "{x}"),
                    (_, ADAPTIVE) => assert!((12..160).contains(&rays), "{x}: {rays}"),
                    _ => assert_eq!(rays, 256, "{x}"),
                }
            }
            let (full, _) = lit(&lamp(rect, FULL), x, &CHALK);
            assert_eq!(
                full,
                lit(&lamp(rect, ADAPTIVE), x, &CHALK).0,
                "a straight outline"
            );
        }
    }

    #[test]
    fn through_glass_comes_a_share_of_the_share() {
        let rect = Rect {
            edges: [Vec3::X, Vec3::Z],
        };
        // All of it is behind both faces of the plate.
        let (found, rays) = lit(&lamp(rect, ADAPTIVE), -1.0, &GLASS);
        let height = 4.0 / f32::hypot(4.0, 1.0);
        assert!((found - 0.25 * height).abs() < 1e-4, "{found}");
        assert_eq!(rays, 4);
    }

    #[test]
    fn a_light_without_extent_is_a_point() {
        let point = Light {
            position: Vec3::Y * 4.0,
            color: Vec3::ONE,
        };
        for x in [-1.0, 0.5] {
            let (expected, rays) = lit(&point, x, &CHALK);
            assert_eq!(rays, 1);
            let none = [Vec3::ZERO; 2];
            for samples in [FULL, ADAPTIVE, Samples { least: 9, most: 0 }] {
                let found = [
                    lit(&lamp(Rect { edges: none }, samples), x, &CHALK),
                    lit(&lamp(Disk { radius: 0.0 }, samples), x, &CHALK),
                    lit(
                        &lamp(Outline::Disk(Disk { radius: 0.0 }), samples),
                        x,
                        &CHALK,
                    ),
                ];
                for (found, rays) in found {
                    assert_eq!(found, expected);
                    let taken = [1, 4, 256];
                    let index = usize::from(samples.most > 0) + usize::from(samples == FULL);
                    assert_eq!(rays, taken[index]);
                }
            }
        }
        // A line, seen end to end across the outline.
        let line = Rect {
            edges: [Vec3::X, Vec3::ZERO],
        };
        assert_eq!(lit(&lamp(line, FULL), 0.0, &CHALK).0, 0.5);
    }

    #[test]
    fn numbers_of_samples_have_bounds() {
        let rect = Rect {
            edges: [Vec3::X, Vec3::Z],
        };
        let many = Samples {
            least: 255,
            most: 255,
        };
        assert_eq!(lit(&lamp(rect, many), 0.0, &CHALK).1, 256);
        let few = Samples { least: 0, most: 1 };
        assert_eq!(lit(&lamp(rect, few), 0.0, &CHALK).1, 4);
    }

    #[test]
    fn what_is_below_the_horizon_or_at_the_point_adds_nothing() {
        let upright = |edges: [Vec3; 2], height| AreaLight {
            position: Vec3::Y * height,
            ..lamp(Rect { edges }, FULL)
        };
        // Upright, 3/4 of it above the floor; of what is lit as from the middle, that share.
        let wall = upright([Vec3::Y * 2.0, Vec3::Z * 1e-3], 0.5);
        assert_eq!(
            lit(&wall, 5.0, &CHALK).0,
            0.75 * (0.5 / f32::hypot(0.5, 5.0))
        );
        assert_eq!(lit(&wall, 5.0, &CHALK).1, 192, "no ray for what is below");
        // The middle is below.
        let low = upright([Vec3::Y * 2.0, Vec3::Z], -0.5);
        assert_eq!(lit(&low, 5.0, &CHALK), (0.0, 0));
        // The point lies within the light, or its middle does.
        let round = AreaLight {
            position: Vec3::Y,
            ..lamp(Disk { radius: 10.0 }, FULL)
        };
        let (found, _) = lit(&round, 5.0, &CHALK);
        assert!(found > 0.0 && found <= 1.0, "{found}");
        let middle = AreaLight {
            position: Vec3::new(5.0, 0.0, 0.0),
            ..round
        };
        assert_eq!(lit(&middle, 5.0, &CHALK), (0.0, 0));
    }

    #[test]
    fn what_is_not_a_number_lights_nothing() {
        let bad = [f32::NAN, f32::INFINITY];
        for x in bad {
            let rect = Rect {
                edges: [Vec3::X * x, Vec3::Z],
            };
            let found = lit(&lamp(rect, ADAPTIVE), 0.5, &CHALK).0;
            assert!((0.0..=1.0).contains(&found), "{x}: {found}");
            let found = lit(&lamp(Disk { radius: x }, FULL), 0.5, &CHALK).0;
            assert!((0.0..=1.0).contains(&found), "{x}: {found}");
            let nowhere = AreaLight {
                position: Vec3::splat(x),
                ..lamp(Disk { radius: 1.0 }, FULL)
            };
            assert_eq!(lit(&nowhere, 0.5, &CHALK).0, 0.0);
        }
    }

    #[test]
    fn a_disk_faces_the_point_and_is_evenly_filled() {
        let disk = Disk { radius: 2.0 };
        for direction in [
            Vec3::Y,
            Vec3::NEG_Y,
            Vec3::X,
            Vec3::NEG_Z,
            Vec3::new(0.6, -0.8, 0.0),
            Vec3::new(-0.48, 0.6, 0.64),
        ] {
            let [a, b] = disk.axes(direction);
            for (found, expected) in [
                (a.dot(b), 0.0),
                (a.dot(direction), 0.0),
                (b.dot(direction), 0.0),
                (a.length(), 2.0),
                (b.length(), 2.0),
            ] {
                assert!((found - expected).abs() < 1e-6, "{direction}: {found}");
            }
        }
        // By angle, in eighths of a turn, and by distance from the middle, in halves of the area.
        let mut sectors = [[0; 2]; 8];
        for y in 0..64 {
            for x in 0..64 {
                let at = |it: i32| (it as f32 + 0.5) / 32.0 - 1.0;
                let [x, y] = disk.place([at(x), at(y)]);
                let (angle, square) = (f64::from(y).atan2(x.into()), x * x + y * y);
                assert!(square < 1.0);
                // Turned, for many samples lie on the diagonals.
                let eighth = (angle / core::f64::consts::FRAC_PI_4 + 0.3).floor() as i32 & 7;
                sectors[eighth as usize][usize::from(square > 0.5)] += 1;
            }
        }
        for halves in sectors {
            for samples in halves {
                assert!((240..=272).contains(&samples), "{sectors:?}");
            }
        }
    }
}
