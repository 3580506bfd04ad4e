//! Scenes that `whitted bake` wrote, in the directory that the variable WHITTED_BAKED names.

use crate::scenes::{Frame, Visitor, count, trace_row};

macro_rules! baked {
    ($($module:ident = $name:literal;)*) => {
        $(
            #[doc = concat!("`", $name, "`.")]
            pub mod $module {
                mod scene {
                    include!(concat!(env!("WHITTED_BAKED"), "/", $name, ".rs"));
                }

                frame!(
                    /// The scene, as its file shows it.
                    Baked = &scene::SCENE, scene::VIEW, { scene::DEPTH }
                );
            }
        )*

        /// Shows every frame to the visitor.
        pub fn visit_all(visitor: &mut impl Visitor) {
            $(visitor.visit::<$module::Baked>($name);)*
        }
    };
}

/// Our own.
#[cfg(feature = "own")]
pub mod own {
    use super::*;

    baked! {
        ball = "ball";
        builtin = "builtin";
        pyramid = "pyramid";
        gear = "gear";
        grove = "grove";
        hills = "hills";
    }
}

/// Of Eric Haines's Standard Procedural Databases.
#[cfg(feature = "standard")]
pub mod standard {
    use super::*;

    baked! {
        balls_2 = "balls-2";
        gears_1 = "gears-1";
        mount_2 = "mount-2";
        rings_1 = "rings-1";
        teapot_2 = "teapot-2";
        tree_4 = "tree-4";
    }
}

/// Whatever is to be counted.
#[cfg(feature = "counted")]
pub mod counted {
    use super::*;

    baked! {
        scene = "counted";
    }
}
