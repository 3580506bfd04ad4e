//! Quadrics, as a file gives them.

use std::cell::RefCell;

use whitted::{Clip, Ends, QuadricError, Vec3};

use super::{Scale, direction};

/// What a quadric is given by. Lengths are in the file's unit.
#[derive(Clone, Debug, PartialEq)]
pub enum Quadric {
    /// Along the axes of the world.
    Ellipsoid {
        /// Its centre.
        center: [f64; 3],
        /// Half its extent along each axis.
        radii: [f64; 3],
    },
    /// A cylinder between two circles.
    Cylinder {
        /// Centre of the first circle.
        base: [f64; 3],
        /// Centre of the second circle.
        apex: [f64; 3],
        /// Of both.
        radius: f64,
    },
    /// A cone, or the part of one between two circles.
    Cone {
        /// Centre of the first circle.
        base: [f64; 3],
        /// Its radius.
        base_radius: f64,
        /// Centre of the second circle.
        apex: [f64; 3],
        /// Its radius; 0 for a pointed cone.
        apex_radius: f64,
    },
    /// A paraboloid from its tip to a circle.
    Paraboloid {
        /// The tip.
        tip: [f64; 3],
        /// Centre of the circle.
        end: [f64; 3],
        /// Its radius.
        radius: f64,
    },
    /// A hyperboloid of one sheet between two equal circles.
    Hyperboloid {
        /// Centre of the first circle.
        base: [f64; 3],
        /// Centre of the second circle.
        apex: [f64; 3],
        /// Of both circles.
        radius: f64,
        /// Least radius, in the middle.
        waist: f64,
    },
    /// A hyperboloid of two sheets between two equal circles.
    TwoSheets {
        /// Centre of the first circle.
        base: [f64; 3],
        /// Centre of the second circle.
        apex: [f64; 3],
        /// Of both circles.
        radius: f64,
        /// Between the tips.
        gap: f64,
    },
    /// By ten coefficients.
    General(Box<General>),
}

/// A quadric by its coefficients, in coordinates x, y and z from the centre, and what clips it.
#[derive(Clone, Debug, PartialEq)]
pub struct General {
    /// In world space.
    pub center: [f64; 3],
    /// Of x², y² and z².
    pub squares: [f64; 3],
    /// Of yz, zx and xy.
    pub products: [f64; 3],
    /// Of x, y and z.
    pub linear: [f64; 3],
    /// The rest.
    pub constant: f64,
    /// Least coordinates of what is seen, from the centre.
    pub min: [f64; 3],
    /// Greatest coordinates, from the centre.
    pub max: [f64; 3],
    /// Across two planes that clip it, of any length; 0 without.
    pub axis: [f64; 3],
    /// Along the axis from the centre to the first plane.
    pub from: f64,
    /// And to the second.
    pub to: f64,
}

/// A squared length, replaced as its root is: by a power of two, or rounded to the bits of an `f32`, which
/// holds it in other units than the root.
fn squared_length(square: f64, length: &impl Fn(f64) -> f64) -> f64 {
    let root = square.abs().sqrt();
    let factor = length(root) / root;
    // Zero has none.
    if !(factor > 0.0 && factor.is_finite()) {
        return square;
    }
    // T. J. Dekker, "A Floating-Point Technique for Extending the Available Precision", 1971.
    let wide = square * f64::from((1 << 29) + 1);
    let rounded = wide - (wide - square);
    rounded * factor.log2().round().exp2().powi(2)
}

impl Quadric {
    /// With every length and every direction replaced.
    pub fn map(
        &self,
        length: &impl Fn(f64) -> f64,
        vector: &impl Fn([f64; 3]) -> [f64; 3],
    ) -> Self {
        let point = |it: [f64; 3]| it.map(length);
        match *self {
            Self::Ellipsoid { center, radii } => Self::Ellipsoid {
                center: point(center),
                radii: point(radii),
            },
            Self::Cylinder { base, apex, radius } => Self::Cylinder {
                base: point(base),
                apex: point(apex),
                radius: length(radius),
            },
            Self::Cone {
                base,
                base_radius,
                apex,
                apex_radius,
            } => Self::Cone {
                base: point(base),
                base_radius: length(base_radius),
                apex: point(apex),
                apex_radius: length(apex_radius),
            },
            Self::Paraboloid { tip, end, radius } => Self::Paraboloid {
                tip: point(tip),
                end: point(end),
                radius: length(radius),
            },
            Self::Hyperboloid {
                base,
                apex,
                radius,
                waist,
            } => Self::Hyperboloid {
                base: point(base),
                apex: point(apex),
                radius: length(radius),
                waist: length(waist),
            },
            Self::TwoSheets {
                base,
                apex,
                radius,
                gap,
            } => Self::TwoSheets {
                base: point(base),
                apex: point(apex),
                radius: length(radius),
                gap: length(gap),
            },
            Self::General(ref it) => {
                let bound = |x: f64| if x.is_finite() { length(x) } else { x };
                Self::General(Box::new(General {
                    center: point(it.center),
                    // Squares of lengths times these are squares of lengths, so that the rest is one.
                    linear: point(it.linear),
                    constant: squared_length(it.constant, length),
                    min: it.min.map(bound),
                    max: it.max.map(bound),
                    axis: vector(it.axis),
                    from: bound(it.from),
                    to: bound(it.to),
                    ..**it
                }))
            }
        }
    }

    /// Whether v counts lengths on it, from its center, and not from one end to the other.
    pub(crate) fn is_endless(&self) -> bool {
        match self {
            // The tip cuts nothing off.
            Self::Paraboloid { .. } => true,
            Self::General(it) if it.axis == [0.0; 3] => !(it.max[1] - it.min[1]).is_finite(),
            Self::General(it) => !(it.to - it.from).is_finite(),
            _ => false,
        }
    }

    /// Visits the lengths that make it as large as it is.
    pub(super) fn sizes(&self, visit: &mut impl FnMut(f64)) {
        match *self {
            Self::Ellipsoid { radii, .. } => radii.into_iter().for_each(visit),
            Self::Cylinder { base, apex, radius } => {
                [super::scale::distance(base, apex), radius]
                    .into_iter()
                    .for_each(visit);
            }
            Self::Cone {
                base,
                base_radius,
                apex,
                apex_radius,
            } => [super::scale::distance(base, apex), base_radius, apex_radius]
                .into_iter()
                .for_each(visit),
            Self::Paraboloid { tip, end, radius } => {
                [super::scale::distance(tip, end), radius]
                    .into_iter()
                    .for_each(visit);
            }
            Self::Hyperboloid {
                base,
                apex,
                radius,
                waist: least,
            }
            | Self::TwoSheets {
                base,
                apex,
                radius,
                gap: least,
            } => [super::scale::distance(base, apex), radius, least]
                .into_iter()
                .for_each(visit),
            Self::General(ref it) => {
                for (min, max) in it.min.into_iter().zip(it.max) {
                    if (max - min).is_finite() {
                        visit(max - min);
                    }
                }
            }
        }
    }

    /// All its numbers, after which of these it is.
    pub(crate) fn numbers(&self) -> Vec<f64> {
        let kind = match self {
            Self::Ellipsoid { .. } => 0.0,
            Self::Cylinder { .. } => 1.0,
            Self::Cone { .. } => 2.0,
            Self::Paraboloid { .. } => 3.0,
            Self::Hyperboloid { .. } => 4.0,
            Self::TwoSheets { .. } => 5.0,
            Self::General(_) => 6.0,
        };
        let numbers = RefCell::new(vec![kind]);
        let note = |it: f64| {
            numbers.borrow_mut().push(it);
            it
        };
        self.map(&note, &|it| it.map(note));
        let mut numbers = numbers.into_inner();
        if let Self::General(it) = self {
            numbers.extend([it.squares, it.products].concat());
        }
        numbers
    }

    /// Balls whose hull holds it; none where it has no end.
    pub fn extent(&self) -> Vec<([f64; 3], f64)> {
        match *self {
            Self::Ellipsoid { center, radii } => [-1.0, 1.0]
                .map(|side| {
                    let corner = [0, 1, 2].map(|axis| center[axis] + side * radii[axis]);
                    (corner, 0.0)
                })
                .to_vec(),
            Self::Cylinder { base, apex, radius }
            | Self::Hyperboloid {
                base, apex, radius, ..
            }
            | Self::TwoSheets {
                base, apex, radius, ..
            } => vec![(base, radius), (apex, radius)],
            Self::Cone {
                base,
                base_radius,
                apex,
                apex_radius,
            } => vec![(base, base_radius), (apex, apex_radius)],
            Self::Paraboloid { tip, end, radius } => vec![(tip, 0.0), (end, radius)],
            Self::General(ref it) => {
                let corners = [it.min, it.max].map(|corner| {
                    let corner = [0, 1, 2].map(|axis| it.center[axis] + corner[axis]);
                    (corner, 0.0)
                });
                let is_finite = |it: &([f64; 3], f64)| it.0.iter().all(|x| x.is_finite());
                corners.into_iter().filter(is_finite).collect()
            }
        }
    }

    /// The quadric as it is cast.
    pub(crate) fn cast(
        &self,
        closed: bool,
        scale: Scale,
    ) -> Result<whitted::Quadric, QuadricError> {
        use whitted::Quadric as Cast;
        let ends = if closed { Ends::Closed } else { Ends::Open };
        let (point, length) = (|it| scale.point(it), |it| scale.length(it));
        match *self {
            Self::Ellipsoid { center, radii } => Cast::ellipsoid(point(center), point(radii)),
            Self::Cylinder { base, apex, radius } => {
                Cast::cylinder(point(base), point(apex), length(radius), ends)
            }
            Self::Cone {
                base,
                base_radius,
                apex,
                apex_radius,
            } => {
                let (base_radius, apex_radius) = (length(base_radius), length(apex_radius));
                Cast::cone(point(base), base_radius, point(apex), apex_radius, ends)
            }
            Self::Paraboloid { tip, end, radius } => {
                Cast::paraboloid(point(tip), point(end), length(radius), ends)
            }
            Self::Hyperboloid {
                base,
                apex,
                radius,
                waist,
            } => {
                let (radius, waist) = (length(radius), length(waist));
                Cast::hyperboloid(point(base), point(apex), radius, waist, ends)
            }
            Self::TwoSheets {
                base,
                apex,
                radius,
                gap,
            } => Cast::two_sheets(point(base), point(apex), length(radius), length(gap), ends),
            Self::General(ref it) => {
                let plain = |it: [f64; 3]| Vec3::from_array(it.map(|x| x as f32));
                let clip = Clip {
                    min: point(it.min),
                    max: point(it.max),
                    axis: direction(it.axis),
                    from: length(it.from),
                    to: length(it.to),
                };
                let constant = length(f64::from(length(it.constant)));
                Cast::new(
                    point(it.center),
                    plain(it.squares),
                    plain(it.products),
                    point(it.linear),
                    constant,
                    clip,
                    ends,
                )
            }
        }
    }
}
