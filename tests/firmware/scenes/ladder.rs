//! A ladder of scenes: each names one thing more than the one before it.
//!
//! Every rung has its own material type, and so its own statics; shapes and colors are shared.

use embedded_graphics::Drawable;
use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::pixelcolor::Rgb565;
use glam::Vec3;
use whitted::antialiasing::{self, Adaptive};
use whitted::area::{Rect, Samples};
use whitted::csg::Difference;
use whitted::{
    AreaLight, Clip, Counters, Csg, Cuboid, Ends, Exact, FillLight, Frustum, Geometry, Glass,
    Instance, Light, Material, Mirror, Object, Objects, Patch, Phong, PhongReal, Picture,
    Placement, Plane, Polygon, Quadric, Scene, Sphere, Torus, Tracer, Triangle, View,
};

use super::{Frame, Visitor, fill, level_view};

pub(super) const VIEW: View = level_view(Vec3::new(0.0, 1.25, 3.0));
pub(super) const BACKGROUND: Vec3 = Vec3::new(0.25, 0.375, 0.5);
const AMBIENT: Vec3 = Vec3::ONE;
pub(super) const LIGHT: Vec3 = Vec3::new(4.0, 6.0, 3.0);

pub(super) const BALLS: [Sphere; 3] = [
    Sphere {
        center: Vec3::new(-1.5, 0.75, -2.0),
        radius: 0.75,
    },
    Sphere {
        center: Vec3::new(0.25, 1.0, -3.0),
        radius: 1.0,
    },
    Sphere {
        center: Vec3::new(1.0, 0.5, -1.0),
        radius: 0.5,
    },
];
pub(super) const FLOOR: Plane = Plane {
    point: Vec3::ZERO,
    normal: Vec3::Y,
};
const SIGN: Polygon = Polygon {
    vertices: &[
        Vec3::new(-2.5, 1.0, -4.0),
        Vec3::new(-1.5, 1.0, -4.0),
        Vec3::new(-2.0, 1.75, -4.0),
        Vec3::new(-1.5, 2.5, -4.0),
        Vec3::new(-2.5, 2.5, -4.0),
    ],
    normal: Vec3::Z,
};
const CRATE: Cuboid = Cuboid {
    min: Vec3::new(1.75, 0.0, -4.0),
    max: Vec3::new(2.75, 1.5, -3.0),
};
const BUCKET: Frustum = Frustum {
    base: Vec3::new(-0.625, 0.0, -0.75),
    axis: Vec3::Y,
    length: 0.5,
    base_radius: 0.125,
    slope: 0.25,
};
/// A solid drum: x² + z² = 1/4 from the floor up.
const DRUM: Quadric = Quadric {
    center: Vec3::new(-0.5, 0.375, -0.75),
    squares: Vec3::new(1.0, 0.0, 1.0),
    products: Vec3::ZERO,
    linear: Vec3::ZERO,
    constant: -0.25,
    clip: Clip {
        min: Vec3::new(-0.53125, -0.375, -0.53125),
        max: Vec3::new(0.53125, 0.375, 0.53125),
        axis: Vec3::ZERO,
        from: f32::NEG_INFINITY,
        to: f32::INFINITY,
    },
    ends: Ends::Closed,
};
const RING: Torus = Torus {
    center: Vec3::new(-0.5, 0.25, -0.75),
    axis: Vec3::new(0.0, 0.8, 0.6),
    major: 0.5,
    minor: 0.1875,
};
/// A ball to place.
const EGG: Sphere = Sphere {
    center: Vec3::ZERO,
    radius: 1.0,
};
/// Standing on the floor, leaning and mirrored.
const EGG_PLACES: [Placement; 2] = [
    place(
        [
            Vec3::new(0.25, 0.125, 0.0),
            Vec3::new(-0.1875, 0.5, 0.0),
            Vec3::new(0.0, 0.0, 0.25),
        ],
        Vec3::new(-0.5, 0.5625, -0.75),
    ),
    place(
        [
            Vec3::new(-0.375, 0.0, 0.0),
            Vec3::new(0.0, 0.1875, 0.0),
            Vec3::new(0.0, 0.0, 0.375),
        ],
        Vec3::new(0.25, 0.1875, -0.5),
    ),
];
/// A block, and a bite of it.
const BLOCK: Cuboid = Cuboid {
    min: Vec3::new(-0.875, 0.0, -1.25),
    max: Vec3::new(0.0, 0.75, -0.5),
};
const BITE: Sphere = Sphere {
    center: Vec3::new(-0.25, 0.75, -0.5),
    radius: 0.5,
};

const fn place(axes: [Vec3; 3], translation: Vec3) -> Placement {
    match Placement::new(axes, translation) {
        Ok(placement) => placement,
        Err(_) => panic!("not a placement"),
    }
}

const FLAG: Triangle = Triangle {
    vertices: [
        Vec3::new(1.25, 1.75, -4.0),
        Vec3::new(2.25, 2.0, -4.0),
        Vec3::new(1.25, 2.5, -4.0),
    ],
    normal: Vec3::Z,
};
const SAIL: Patch = Patch {
    vertices: [
        Vec3::new(-0.5, 2.25, -4.0),
        Vec3::new(1.0, 2.25, -4.0),
        Vec3::new(0.25, 3.0, -4.0),
    ],
    normals: [
        Vec3::new(-0.6, 0.0, 0.8),
        Vec3::new(0.6, 0.0, 0.8),
        Vec3::new(0.0, 0.6, 0.8),
    ],
    normal: Vec3::Z,
};

/// What the terms of a rung's materials are; `()` is none.
struct Terms<H, R, T> {
    highlight: H,
    plain: R,
    mirror: R,
    opaque: T,
    clear: T,
}

/// Colors by what they are on. The second ball mirrors and the third is clear where a rung can.
#[derive(Clone, Copy)]
enum Paint {
    Red,
    Silver,
    Clear,
    Stone,
    Wood,
}

const fn material<H: Copy, R: Copy, T: Copy>(
    paint: Paint,
    terms: &Terms<H, R, T>,
) -> Material<H, R, T> {
    let (color, diffuse, reflection, transmission) = match paint {
        Paint::Red => (
            Vec3::new(0.75, 0.25, 0.125),
            0.75,
            terms.plain,
            terms.opaque,
        ),
        Paint::Silver => (
            Vec3::new(0.75, 0.75, 0.875),
            0.5,
            terms.mirror,
            terms.opaque,
        ),
        Paint::Clear => (Vec3::new(0.5, 0.875, 0.625), 0.25, terms.plain, terms.clear),
        Paint::Stone => (Vec3::new(0.5, 0.5, 0.5), 0.75, terms.plain, terms.opaque),
        Paint::Wood => (Vec3::new(0.625, 0.5, 0.25), 0.75, terms.plain, terms.opaque),
    };
    Material {
        color,
        ambient: 0.125,
        diffuse,
        highlight: terms.highlight,
        reflection,
        transmission,
    }
}

/// One rung: the statics that its geometry names, and the frame.
macro_rules! rung {
    (
        $(#[$doc:meta])* $module:ident::$frame:ident,
        Material<$highlight:ty, $reflection:ty, $transmission:ty> = $terms:expr,
        $light:ident, depth $depth:literal,
        $geometry:ty = $value:expr
    ) => {
        // A rung names some of the statics; the others do not reach the binary.
        #[allow(dead_code)]
        mod $module {
            use super::*;

            pub type M = Material<$highlight, $reflection, $transmission>;
            const TERMS: Terms<$highlight, $reflection, $transmission> = $terms;
            static RED: M = material(Paint::Red, &TERMS);
            static SILVER: M = material(Paint::Silver, &TERMS);
            static CLEAR: M = material(Paint::Clear, &TERMS);
            static STONE: M = material(Paint::Stone, &TERMS);
            static WOOD: M = material(Paint::Wood, &TERMS);

            pub static BALLS: [Object<Sphere, M>; 3] = [
                Object { shape: super::BALLS[0], material: &RED },
                Object { shape: super::BALLS[1], material: &SILVER },
                Object { shape: super::BALLS[2], material: &CLEAR },
            ];
            pub static FLOORS: [Object<Plane, M>; 1] = [Object { shape: FLOOR, material: &STONE }];
            pub static SIGNS: [Object<Polygon, M>; 1] = [Object { shape: SIGN, material: &WOOD }];
            pub static CRATES: [Object<Cuboid, M>; 1] = [Object { shape: CRATE, material: &WOOD }];
            pub static BUCKETS: [Object<Frustum, M>; 1] = [Object { shape: BUCKET, material: &RED }];
            pub static DRUMS: [Object<Quadric, M>; 1] = [Object { shape: DRUM, material: &RED }];
            pub static RINGS: [Object<Torus, M>; 1] = [Object { shape: RING, material: &RED }];
            static EGG: [Object<Sphere, M>; 1] = [Object { shape: super::EGG, material: &RED }];
            pub static EGGS: [Instance<[Object<Sphere, M>]>; 2] = [
                Instance { geometry: &EGG, placement: EGG_PLACES[0] },
                Instance { geometry: &EGG, placement: EGG_PLACES[1] },
            ];
            pub static BITTEN: Csg<Bitten<M>, 4> = Csg(Difference(
                Object { shape: BLOCK, material: &WOOD },
                Object { shape: BITE, material: &RED },
            ));
            pub static FLAGS: [Object<Triangle, M>; 1] = [Object { shape: FLAG, material: &RED }];
            pub static SAILS: [Object<Patch, M>; 1] = [Object { shape: SAIL, material: &STONE }];

            static LIGHTS: [$light; 1] = [$light { position: LIGHT, color: Vec3::ONE }];
            pub static SCENE: Scene<'static, $geometry, $light> = Scene {
                geometry: $value,
                lights: &LIGHTS,
                background: BACKGROUND,
                ambient: AMBIENT,
            };
        }
        frame!($(#[$doc])* $frame = &$module::SCENE, VIEW, $depth);
    };
}

const MATTE: Terms<(), (), ()> = Terms {
    highlight: (),
    plain: (),
    mirror: (),
    opaque: (),
    clear: (),
};
pub(super) const SHINY: Phong = Phong {
    specular: 0.5,
    shininess: 30,
};
const GLOSSY: Terms<Phong, (), ()> = Terms {
    highlight: SHINY,
    plain: (),
    mirror: (),
    opaque: (),
    clear: (),
};
const DULL: Mirror = Mirror { reflectance: 0.0 };
const BRIGHT: Mirror = Mirror { reflectance: 0.5 };
const MIRRORING: Terms<Phong, Mirror, ()> = Terms {
    highlight: SHINY,
    plain: DULL,
    mirror: BRIGHT,
    opaque: (),
    clear: (),
};
const OPAQUE: Glass = Glass {
    transmittance: 0.0,
    ior: 1.0,
};
const CLEAR: Glass = Glass {
    transmittance: 0.75,
    ior: 1.5,
};
const REFRACTING: Terms<Phong, Mirror, Glass> = Terms {
    highlight: SHINY,
    plain: DULL,
    mirror: BRIGHT,
    opaque: OPAQUE,
    clear: CLEAR,
};
const EVERYTHING: Terms<PhongReal, Mirror, Glass> = Terms {
    highlight: PhongReal {
        specular: 0.5,
        shininess: 30.5,
    },
    plain: DULL,
    mirror: BRIGHT,
    opaque: OPAQUE,
    clear: CLEAR,
};

rung!(
    /// Spheres under a light that casts no shadows.
    matte::Matte, Material<(), (), ()> = MATTE, FillLight, depth 1,
    Objects<Sphere, M> = &BALLS
);
rung!(
    /// The spheres with shadows, and nothing else: no rung, but a goal of its own.
    matte_shadows::MatteShadows, Material<(), (), ()> = MATTE, Light, depth 1,
    Objects<Sphere, M> = &BALLS
);
rung!(
    /// And a plane.
    floor::Floor, Material<(), (), ()> = MATTE, FillLight, depth 1,
    (Objects<Sphere, M>, Objects<Plane, M>) = (&BALLS, &FLOORS)
);
rung!(
    /// And shadows.
    shadows::Shadows, Material<(), (), ()> = MATTE, Light, depth 1,
    (Objects<Sphere, M>, Objects<Plane, M>) = (&BALLS, &FLOORS)
);
rung!(
    /// And highlights.
    highlight::Highlight, Material<Phong, (), ()> = GLOSSY, Light, depth 1,
    (Objects<Sphere, M>, Objects<Plane, M>) = (&BALLS, &FLOORS)
);
rung!(
    /// And a polygon.
    polygon::WithPolygon, Material<Phong, (), ()> = GLOSSY, Light, depth 1,
    ((Objects<Sphere, M>, Objects<Plane, M>), Objects<Polygon<'static>, M>) =
        ((&BALLS, &FLOORS), &SIGNS)
);
rung!(
    /// And a box.
    cuboid::WithCuboid, Material<Phong, (), ()> = GLOSSY, Light, depth 1,
    (
        ((Objects<Sphere, M>, Objects<Plane, M>), Objects<Polygon<'static>, M>),
        Objects<Cuboid, M>
    ) = (((&BALLS, &FLOORS), &SIGNS), &CRATES)
);

type FiveKinds<M> = (
    (
        (Objects<Sphere, M>, Objects<Plane, M>),
        Objects<Polygon<'static>, M>,
    ),
    (Objects<Cuboid, M>, Objects<Frustum, M>),
);

rung!(
    /// And a frustum.
    frustum::WithFrustum, Material<Phong, (), ()> = GLOSSY, Light, depth 1,
    FiveKinds<M> = (((&BALLS, &FLOORS), &SIGNS), (&CRATES, &BUCKETS))
);
rung!(
    /// And mirrors.
    mirrors::Mirrors, Material<Phong, Mirror, ()> = MIRRORING, Light, depth 5,
    FiveKinds<M> = (((&BALLS, &FLOORS), &SIGNS), (&CRATES, &BUCKETS))
);
rung!(
    /// And glass.
    refraction::Refraction, Material<Phong, Mirror, Glass> = REFRACTING, Light, depth 5,
    FiveKinds<M> = (((&BALLS, &FLOORS), &SIGNS), (&CRATES, &BUCKETS))
);
rung!(
    /// And all there is besides: triangles, patches, exponents that are not whole.
    everything::Everything, Material<PhongReal, Mirror, Glass> = EVERYTHING, Light, depth 5,
    (FiveKinds<M>, (Objects<Triangle, M>, Objects<Patch, M>)) = (
        (((&BALLS, &FLOORS), &SIGNS), (&CRATES, &BUCKETS)),
        (&FLAGS, &SAILS)
    )
);
rung!(
    /// Spheres, a plane, mirrors and glass: no rung, but the stack's goal.
    spheres_and_plane::SpheresAndPlane, Material<Phong, Mirror, Glass> = REFRACTING, Light, depth 5,
    (Objects<Sphere, M>, Objects<Plane, M>) = (&BALLS, &FLOORS)
);

rung!(
    /// Spheres, a plane, shadows, highlights and a quadric: no rung, but one beside that of the polygon.
    quadric::WithQuadric, Material<Phong, (), ()> = GLOSSY, Light, depth 1,
    ((Objects<Sphere, M>, Objects<Plane, M>), Objects<Quadric, M>) = ((&BALLS, &FLOORS), &DRUMS)
);
rung!(
    /// The same with a torus.
    torus::WithTorus, Material<Phong, (), ()> = GLOSSY, Light, depth 1,
    ((Objects<Sphere, M>, Objects<Plane, M>), Objects<Torus, M>) = ((&BALLS, &FLOORS), &RINGS)
);

type Placed<M> = &'static [Instance<'static, [Object<'static, Sphere, M>]>];
type Bitten<M> = Difference<Object<'static, Cuboid, M>, Object<'static, Sphere, M>>;

rung!(
    /// The same with a sphere that is placed twice.
    instance::WithInstances, Material<Phong, (), ()> = GLOSSY, Light, depth 1,
    ((Objects<Sphere, M>, Objects<Plane, M>), Placed<M>) = ((&BALLS, &FLOORS), &EGGS)
);
rung!(
    /// The same with a box of which a sphere is taken away.
    csg::WithSolid, Material<Phong, (), ()> = GLOSSY, Light, depth 1,
    ((Objects<Sphere, M>, Objects<Plane, M>), &'static Csg<Bitten<M>, 4>) =
        ((&BALLS, &FLOORS), &BITTEN)
);

/// The rung with highlights under a panel in place of its light.
mod soft {
    use super::*;
    use highlight::{BALLS, FLOORS, M};

    static LIGHTS: [AreaLight<Rect>; 1] = [AreaLight {
        position: LIGHT,
        color: Vec3::ONE,
        extent: Rect {
            edges: [Vec3::new(1.5, 0.0, 0.0), Vec3::new(0.0, -0.75, 1.0)],
        },
        samples: Samples { least: 1, most: 3 },
    }];
    type Geometry = (Objects<Sphere, M>, Objects<Plane, M>);
    pub static SCENE: Scene<'static, Geometry, AreaLight<Rect>> = Scene {
        geometry: (&BALLS, &FLOORS),
        lights: &LIGHTS,
        background: BACKGROUND,
        ambient: AMBIENT,
    };
}
frame!(
    /// Spheres, a plane and highlights under a light that casts soft shadows: no rung, but one beside that
    /// of highlights.
    Soft = &soft::SCENE, VIEW, 1
);

/// Spheres, a plane and highlights with adaptive anti-aliasing: no rung, but one beside that of
/// highlights. Rows are drawn each by itself, and share no samples; a display's picture is drawn as a whole.
pub struct Smooth;

impl Smooth {
    /// 32 steps of a channel of 8 bits.
    const BOUND: f32 = 1.0 / 8.0;
}

impl Frame for Smooth {
    const VIEW: View = VIEW;

    #[inline(always)]
    fn row(y: u32, row: &mut [Vec3]) {
        let (scene, tracer) = (&highlight::SCENE, Tracer::<1>::new());
        let mut adaptive =
            Adaptive::<_, _, _, _, 1, 5>::new(scene, VIEW, tracer, Self::BOUND, &mut []);
        for (pixel, color) in row.iter_mut().zip(adaptive.row(y)) {
            *pixel = color;
        }
    }

    fn draw<D: DrawTarget<Color = Rgb565>>(display: &mut D) -> Result<(), D::Error> {
        let picture = antialiasing::Smooth::<_, _, 1, 5, 65> {
            picture: Picture::new(&highlight::SCENE, VIEW),
            bound: Self::BOUND,
        };
        Drawable::draw(&picture, display)
    }

    fn count() -> Counters {
        let mut shared = [Vec3::ZERO; 65];
        let tracer = Tracer::<1, Exact, _>::with(Counters::default());
        let mut adaptive = Adaptive::<_, _, _, _, 1, 5>::new(
            &highlight::SCENE,
            VIEW,
            tracer,
            Self::BOUND,
            &mut shared,
        );
        for y in 0..VIEW.height {
            // Through memory, so that the light is not left out where only counts are used.
            adaptive.row(y).for_each(|pixel| {
                core::hint::black_box(pixel);
            });
        }
        adaptive.tracer.counters
    }
}

/// A frame made from the rays alone.
macro_rules! ray_frame {
    ($(#[$doc:meta])* $frame:ident = $color:expr) => {
        $(#[$doc])*
        pub struct $frame;

        impl Frame for $frame {
            const VIEW: View = VIEW;

            #[inline(always)]
            fn row(y: u32, row: &mut [Vec3]) {
                for (pixel, ray) in row.iter_mut().zip(VIEW.rays(y)) {
                    *pixel = $color(&ray);
                }
            }

            fn draw<D: DrawTarget<Color = Rgb565>>(display: &mut D) -> Result<(), D::Error> {
                let rays = (0..VIEW.height).flat_map(|y| VIEW.rays(y));
                fill(display, &VIEW, rays.map(|ray| $color(&ray)))
            }

            fn count() -> Counters {
                Counters::default()
            }
        }
    };
}

ray_frame!(
    /// The camera alone: the directions of its rays.
    Rays = |ray: &whitted::Ray| ray.direction
);
ray_frame!(
    /// The geometry query alone: how far away one sphere is.
    Query = |ray: &whitted::Ray| {
        static BALL: [Object<Sphere, ()>; 1] = [Object { shape: BALLS[1], material: &() }];
        Vec3::splat(BALL.as_slice().closest_hit(ray).map_or(0.0, |hit| hit.t))
    }
);

pub(super) fn visit_all(visitor: &mut impl Visitor) {
    visitor.visit::<Rays>("rays");
    visitor.visit::<Query>("query");
    visitor.visit::<Matte>("matte");
    visitor.visit::<Floor>("floor");
    visitor.visit::<Shadows>("shadows");
    visitor.visit::<Highlight>("highlight");
    visitor.visit::<WithPolygon>("polygon");
    visitor.visit::<WithCuboid>("cuboid");
    visitor.visit::<WithFrustum>("frustum");
    visitor.visit::<Mirrors>("mirrors");
    visitor.visit::<Refraction>("glass");
    visitor.visit::<Everything>("everything");
    visitor.visit::<MatteShadows>("matte-shadows");
    visitor.visit::<SpheresAndPlane>("spheres-and-plane");
    visitor.visit::<WithQuadric>("quadric");
    visitor.visit::<WithTorus>("torus");
    visitor.visit::<WithInstances>("instance");
    visitor.visit::<WithSolid>("csg");
    visitor.visit::<Soft>("soft");
    visitor.visit::<Smooth>("smooth");
}
