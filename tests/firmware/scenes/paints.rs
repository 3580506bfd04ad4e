//! Scenes with colors that change along surfaces, and with glass that colors light: no rungs, but rows
//! beside that of highlights, and beside that of spheres, plane, mirror and glass.

use embedded_graphics::pixelcolor::Rgb888;
use glam::Vec3;
use whitted::columns::Texture;
use whitted::pattern::Bilinear;
use whitted::{
    Absorbing, Checker, ImageMap, Light, Material, Mirror, Object, Objects, Phong, Plane, Scene,
    Sphere, Stripes, Varying, pattern,
};

use super::Visitor;
use super::ladder::{BACKGROUND, BALLS, FLOOR, LIGHT, SHINY, VIEW};

static LIGHTS: [Light; 1] = [Light {
    position: LIGHT,
    color: Vec3::ONE,
}];
const DARK: Vec3 = Vec3::new(0.25, 0.25, 0.375);
const PALE: Vec3 = Vec3::new(0.875, 0.875, 0.75);

type Scenery<M> = (Objects<Sphere, M>, Objects<Plane, M>);

/// Three balls of three materials on a floor of a fourth.
macro_rules! scenery {
    ($material:ty, $balls:expr, $floor:expr) => {
        static MATERIALS: [$material; 4] = {
            let [a, b, c]: [$material; 3] = $balls;
            [a, b, c, $floor]
        };
        static ON_FLOOR: [Object<Sphere, $material>; 3] = [
            Object {
                shape: BALLS[0],
                material: &MATERIALS[0],
            },
            Object {
                shape: BALLS[1],
                material: &MATERIALS[1],
            },
            Object {
                shape: BALLS[2],
                material: &MATERIALS[2],
            },
        ];
        static FLOORS: [Object<Plane, $material>; 1] = [Object {
            shape: FLOOR,
            material: &MATERIALS[3],
        }];
        pub static SCENE: Scene<'static, Scenery<$material>> = Scene {
            geometry: (&ON_FLOOR, &FLOORS),
            lights: &LIGHTS,
            background: BACKGROUND,
            ambient: Vec3::ONE,
        };
    };
}

mod patterns {
    use super::*;

    /// Either.
    #[derive(Clone, Copy)]
    pub enum Paint {
        Checker(Checker),
        Stripes(Stripes),
    }

    impl Varying for Paint {
        fn at(&self, spot: &pattern::Spot) -> Vec3 {
            match self {
                Self::Checker(it) => it.at(spot),
                Self::Stripes(it) => it.at(spot),
            }
        }
    }

    type M = Material<Phong, (), (), Paint>;

    const fn material(color: Paint) -> M {
        Material {
            color,
            ambient: 0.125,
            diffuse: 0.75,
            highlight: SHINY,
            reflection: (),
            transmission: (),
        }
    }

    const fn cubes(size: f32) -> M {
        material(Paint::Checker(Checker {
            colors: [PALE, DARK],
            size,
        }))
    }

    const LAYERS: M = material(Paint::Stripes(Stripes {
        colors: [Vec3::new(0.75, 0.5, 0.25), Vec3::new(0.375, 0.25, 0.125)],
        direction: Vec3::new(0.6, 0.8, 0.0),
        size: 0.1875,
    }));

    scenery!(M, [LAYERS, cubes(0.375), LAYERS], cubes(0.5));
}

mod texture {
    use super::*;

    static TILES: Texture<'static, Rgb888> = Texture {
        width: 4,
        height: 3,
        texels: &[0, 1, 2, 1, 2, 3, 2, 3, 0, 3, 0, 1],
        palette: &[
            Rgb888::new(200, 60, 50),
            Rgb888::new(60, 160, 70),
            Rgb888::new(50, 70, 190),
            Rgb888::new(230, 220, 180),
        ],
    };

    type Image = ImageMap<'static, Texture<'static, Rgb888>, Bilinear>;
    type M = Material<Phong, (), (), Image>;

    const fn material(across: f32, up: f32) -> M {
        Material {
            color: ImageMap {
                image: &TILES,
                repeat: (across, up),
                filter: Bilinear,
            },
            ambient: 0.125,
            diffuse: 0.75,
            highlight: SHINY,
            reflection: (),
            transmission: (),
        }
    }

    scenery!(
        M,
        [material(1.0, 1.0), material(3.0, 2.0), material(4.0, 1.0)],
        material(0.5, 0.5)
    );
}

mod tinted {
    use super::*;

    type M = Material<Phong, Mirror, Absorbing>;

    const fn material(color: Vec3, diffuse: f32, reflectance: f32, transmission: Absorbing) -> M {
        Material {
            color,
            ambient: 0.125,
            diffuse,
            highlight: SHINY,
            reflection: Mirror { reflectance },
            transmission,
        }
    }

    const OPAQUE: Absorbing = Absorbing {
        tint: Vec3::ZERO,
        ior: 1.0,
        absorption: Vec3::ZERO,
    };
    const RED: Absorbing = Absorbing {
        tint: Vec3::new(0.875, 0.25, 0.125),
        ior: 1.5,
        absorption: Vec3::ZERO,
    };
    const AMBER: Absorbing = Absorbing {
        tint: Vec3::splat(0.875),
        ior: 1.25,
        absorption: Vec3::new(0.125, 0.5, 1.5),
    };

    scenery!(
        M,
        [
            material(Vec3::new(0.75, 0.25, 0.125), 0.0625, 0.0, RED),
            material(Vec3::new(0.75, 0.75, 0.875), 0.5, 0.5, OPAQUE),
            material(Vec3::ONE, 0.0, 0.0625, AMBER)
        ],
        material(Vec3::splat(0.5), 0.75, 0.0, OPAQUE)
    );
}

frame!(
    /// A checker and stripes.
    Patterns = &patterns::SCENE, VIEW, 1
);
frame!(
    /// An image on everything, its pixels blended.
    Textured = &texture::SCENE, VIEW, 1
);
frame!(
    /// A mirror, and glass that colors light at its surface and on the way inside.
    TintedGlass = &tinted::SCENE, VIEW, 5
);

pub(super) fn visit_all(visitor: &mut impl Visitor) {
    visitor.visit::<Patterns>("patterns");
    visitor.visit::<Textured>("texture");
    visitor.visit::<TintedGlass>("tinted-glass");
}
