//! What the firmware draws. The host compiles this same file for the picture to expect.

use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::pixelcolor::{Rgb565, Rgb888, RgbColor};
use embedded_graphics::prelude::{Point, Size};
use embedded_graphics::primitives::Rectangle;
use glam::Vec3;
use whitted::{
    Camera, Counters, Exact, Finish, Geometry, LightSource, Scene, Tracer, View, picture,
};

/// A picture that a program draws.
pub trait Frame {
    /// Camera and size.
    const VIEW: View;

    /// Draws row `y`, counted from the top.
    fn row(y: u32, row: &mut [Vec3]);

    /// Draws all of it onto a display.
    ///
    /// # Errors
    ///
    /// The display's own.
    fn draw<D: DrawTarget<Color = Rgb565>>(display: &mut D) -> Result<(), D::Error>;

    /// Traces all of it and counts.
    fn count() -> Counters;
}

/// What goes through all frames.
pub trait Visitor {
    /// Called for each.
    fn visit<F: Frame>(&mut self, name: &'static str);
}

/// A frame of a static scene, whose light is followed to `$depth`.
macro_rules! frame {
    ($(#[$doc:meta])* $frame:ident = $scene:expr, $view:expr, $depth:expr) => {
        $(#[$doc])*
        pub struct $frame;

        impl super::Frame for $frame {
            const VIEW: whitted::View = $view;

            #[inline(always)]
            fn row(y: u32, row: &mut [glam::Vec3]) {
                super::trace_row::<_, _, $depth>($scene, &$view, y, row);
            }

            #[inline(always)]
            fn draw<D>(display: &mut D) -> Result<(), D::Error>
            where
                D: embedded_graphics::draw_target::DrawTarget<
                        Color = embedded_graphics::pixelcolor::Rgb565,
                    >,
            {
                let picture = whitted::Picture::<_, _, $depth, _>::new($scene, $view);
                embedded_graphics::Drawable::draw(&picture, display)
            }

            fn count() -> whitted::Counters {
                super::count::<_, _, $depth>($scene, &$view)
            }
        }
    };
}

pub mod castle;
pub mod checkerboard;
pub mod ladder;
pub mod layouts;
pub mod outside;
pub mod paints;
pub mod roots;

/// Shows every frame to the visitor, by the name of its program.
pub fn visit_all(visitor: &mut impl Visitor) {
    visitor.visit::<Empty>("empty");
    ladder::visit_all(visitor);
    layouts::visit_all(visitor);
    outside::visit_all(visitor);
    castle::visit_all(visitor);
    paints::visit_all(visitor);
}

/// Shows enough frames to the visitor to meet everything that `core` can draw, and one of what it computes by
/// other means on other targets.
pub fn visit_varied(visitor: &mut impl Visitor) {
    visitor.visit::<ladder::Matte>("matte");
    visitor.visit::<ladder::Everything>("everything");
    visitor.visit::<ladder::WithQuadric>("quadric");
    visitor.visit::<ladder::WithTorus>("torus");
    visitor.visit::<ladder::Soft>("soft");
    visitor.visit::<ladder::Smooth>("smooth");
    visitor.visit::<ladder::WithInstances>("instance");
    visitor.visit::<ladder::WithSolid>("csg");
    layouts::visit_all(visitor);
    outside::visit_all(visitor);
    castle::visit_all(visitor);
    paints::visit_all(visitor);
    visitor.visit::<roots::Roots>("roots");
}

#[inline(always)]
pub(crate) fn trace_row<G, L, const DEPTH: usize>(
    scene: &'static Scene<'static, G, L>,
    view: &View,
    y: u32,
    row: &mut [Vec3],
) where
    G: Geometry<Material: Finish>,
    L: LightSource,
{
    let mut tracer = Tracer::<DEPTH>::new();
    for (pixel, color) in row
        .iter_mut()
        .zip(picture::row(scene, view, y, &mut tracer))
    {
        *pixel = color;
    }
}

pub(crate) fn count<G, L, const DEPTH: usize>(scene: &Scene<'_, G, L>, view: &View) -> Counters
where
    G: Geometry<Material: Finish>,
    L: LightSource,
{
    let mut tracer = Tracer::<DEPTH, Exact, _>::with(Counters::default());
    for y in 0..view.height {
        for ray in view.rays(y) {
            // Through memory, so that the light is not left out where only counts are used.
            core::hint::black_box(tracer.radiance(scene, ray));
        }
    }
    tracer.counters
}

/// Draws pixels of a view, from the top left, row by row.
#[inline(always)]
pub(crate) fn fill<D: DrawTarget<Color = Rgb565>>(
    display: &mut D,
    view: &View,
    pixels: impl Iterator<Item = Vec3>,
) -> Result<(), D::Error> {
    let colors = pixels.map(|color| {
        let [red, green, blue] = picture::to_rgb8(color);
        Rgb565::from(Rgb888::new(red, green, blue))
    });
    let area = Rectangle::new(Point::zero(), Size::new(view.width, view.height));
    display.fill_contiguous(&area, colors)
}

/// A camera that looks along -z. Its picture is wider than high, and shows a little more below the
/// eye's height than above it; no trigonometry and no rotation needed.
pub const fn level_view(eye: Vec3) -> View {
    View {
        camera: Camera {
            eye,
            corner: Vec3::new(-1.0, 0.625, -1.75),
            right: Vec3::new(2.0, 0.0, 0.0),
            down: Vec3::new(0.0, -1.5, 0.0),
        },
        width: 64,
        height: 48,
    }
}

/// No renderer at all: what a program costs that draws nothing.
pub struct Empty;

impl Frame for Empty {
    const VIEW: View = level_view(Vec3::ZERO);

    fn row(_: u32, row: &mut [Vec3]) {
        // Or even the call would be left out.
        core::hint::black_box(row);
    }

    fn draw<D: DrawTarget<Color = Rgb565>>(display: &mut D) -> Result<(), D::Error> {
        let area = Rectangle::new(
            Point::zero(),
            Size::new(Self::VIEW.width, Self::VIEW.height),
        );
        display.fill_contiguous(&area, core::iter::repeat(Rgb565::BLACK))
    }

    fn count() -> Counters {
        Counters::default()
    }
}
