//! Pictures without a frame buffer: rows for a caller's buffer, pixels for a display.

use core::marker::PhantomData;

use embedded_graphics::Drawable;
use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Size};
use embedded_graphics::image::ImageDrawable;
use embedded_graphics::pixelcolor::{PixelColor, Rgb888};
use embedded_graphics::prelude::Point;
use embedded_graphics::primitives::Rectangle;
use glam::Vec3;

use crate::camera::View;
use crate::geometry::Geometry;
use crate::material::Finish;
use crate::math::{Exact, Math};
use crate::scene::{Light, LightSource, Scene};
use crate::trace::{Count, Tracer};

/// An 8-bit channel from a linear one: clamped to 0 and 1, then to the nearest of 256 steps; 0 for NaN.
#[inline]
pub fn quantize(channel: f32) -> u8 {
    // The cast saturates, and makes 0 of NaN.
    (channel * 255.0 + 0.5) as u8
}

/// [`quantize`] for red, green and blue.
#[inline]
pub fn to_rgb8(radiance: Vec3) -> [u8; 3] {
    radiance.to_array().map(quantize)
}

/// The pixels of one row of a scene's picture, left to right: linear RGB. Rows count from the top.
///
/// Collect them, stream them, or [`zip`](Iterator::zip) them into a buffer.
#[inline]
pub fn row<'a, G, L, const DEPTH: usize, P, C>(
    scene: &'a Scene<'a, G, L>,
    view: &View,
    row: u32,
    tracer: &'a mut Tracer<DEPTH, P, C>,
) -> impl ExactSizeIterator<Item = Vec3> + use<'a, G, L, DEPTH, P, C>
where
    G: Geometry<Material: Finish>,
    L: LightSource,
    P: Math,
    C: Count,
{
    view.rays(row)
        .towards(&scene.geometry)
        .map(move |(ray, among)| tracer.radiance_among(scene, ray, among))
}

/// A picture that embedded-graphics can draw, computed while it is drawn.
///
/// As a `Drawable` it fills its rectangle at the origin of the target in one `fill_contiguous`; as an
/// `ImageDrawable` it can be placed by `Image` and cut by `sub_image`, and only what is drawn is traced.
/// `Color` is the target's, converted from `Rgb888`.
///
/// ```
/// use embedded_graphics::mock_display::MockDisplay;
/// use embedded_graphics::{Drawable, pixelcolor::Rgb565};
/// use whitted::{Camera, Light, Material, Object, Picture, Scene, Sphere, Vec3, View};
///
/// static RED: Material = Material::matte(Vec3::X, 1.0, 0.0);
/// static BALL: [Object<Sphere>; 1] =
///     [Object { shape: Sphere { center: Vec3::new(0.0, 0.0, -3.0), radius: 1.0 }, material: &RED }];
/// static SCENE: Scene<&[Object<Sphere>]> =
///     Scene { geometry: &BALL, lights: &[], background: Vec3::ZERO, ambient: Vec3::ONE };
///
/// let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 0.5, 1.0)?;
/// let picture = Picture::<_, _, 1>::new(&SCENE, View { camera, width: 5, height: 5 });
/// let mut display = MockDisplay::<Rgb565>::new();
/// picture.draw(&mut display)?;
/// display.assert_pattern(&["KKKKK", "KRRRK", "KRRRK", "KRRRK", "KKKKK"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a, G, Color, const DEPTH: usize, L = Light, P = Exact> {
    /// What is seen.
    pub scene: &'a Scene<'a, G, L>,
    /// From where, and how large.
    pub view: View,
    /// How far light is followed.
    pub tracer: Tracer<DEPTH, P>,
    color: PhantomData<Color>,
}

impl<'a, G, Color, const DEPTH: usize, L, P: Math> Picture<'a, G, Color, DEPTH, L, P> {
    /// A picture with all of `DEPTH` and no threshold.
    pub const fn new(scene: &'a Scene<'a, G, L>, view: View) -> Self {
        Self {
            scene,
            view,
            tracer: Tracer::with(()),
            color: PhantomData,
        }
    }
}

impl<G, Color, const DEPTH: usize, L, P> OriginDimensions for Picture<'_, G, Color, DEPTH, L, P> {
    fn size(&self) -> Size {
        Size::new(self.view.width, self.view.height)
    }
}

impl<G, Color, const DEPTH: usize, L, P> Picture<'_, G, Color, DEPTH, L, P>
where
    G: Geometry<Material: Finish>,
    Color: PixelColor + From<Rgb888>,
    L: LightSource,
    P: Math,
{
    /// The pixels of a part of the picture, row by row.
    #[inline]
    fn pixels(&self, area: Rectangle) -> impl Iterator<Item = Color> {
        let (left, top) = (area.top_left.x as u32, area.top_left.y as u32);
        let (width, height) = (area.size.width, area.size.height);
        let mut tracer = Tracer::<DEPTH, P>::with(());
        tracer.depth = self.tracer.depth;
        tracer.threshold = self.tracer.threshold;
        (top..top + height)
            .flat_map(move |row| {
                let rays = self.view.rays(row).towards(&self.scene.geometry);
                rays.skip(left as usize).take(width as usize)
            })
            .map(move |(ray, among)| {
                let radiance = tracer.radiance_among(self.scene, ray, among);
                let [red, green, blue] = to_rgb8(radiance);
                Color::from(Rgb888::new(red, green, blue))
            })
    }
}

impl<G, Color, const DEPTH: usize, L, P> ImageDrawable for Picture<'_, G, Color, DEPTH, L, P>
where
    G: Geometry<Material: Finish>,
    Color: PixelColor + From<Rgb888>,
    L: LightSource,
    P: Math,
{
    type Color = Color;

    fn draw<D: DrawTarget<Color = Color>>(&self, target: &mut D) -> Result<(), D::Error> {
        self.draw_sub_image(target, &Rectangle::new(Point::zero(), self.size()))
    }

    fn draw_sub_image<D: DrawTarget<Color = Color>>(
        &self,
        target: &mut D,
        area: &Rectangle,
    ) -> Result<(), D::Error> {
        let area = area.intersection(&Rectangle::new(Point::zero(), self.size()));
        if area.is_zero_sized() {
            return Ok(());
        }
        let placed = Rectangle::new(Point::zero(), area.size);
        target.fill_contiguous(&placed, self.pixels(area))
    }
}

impl<G, Color, const DEPTH: usize, L, P> Drawable for Picture<'_, G, Color, DEPTH, L, P>
where
    G: Geometry<Material: Finish>,
    Color: PixelColor + From<Rgb888>,
    L: LightSource,
    P: Math,
{
    type Color = Color;
    type Output = ();

    fn draw<D: DrawTarget<Color = Color>>(&self, target: &mut D) -> Result<(), D::Error> {
        ImageDrawable::draw(self, target)
    }
}
