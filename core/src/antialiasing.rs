//! Several rays a pixel.
//!
//! A pixel of [`picture::row`] is what lies behind its middle. Here it is the mean of what lies behind its
//! area, of samples that are the same for every picture: nothing is random. A sample counts as it would
//! be shown, with channels of at most 1, so that the outline of a bright light is smooth, too.
//!
//! [`supersampled_row`] takes the same number of samples everywhere. [`Adaptive`] takes more where the
//! picture changes and about one a pixel where it does not: it looks at the corners of pixels, which
//! neighbors share. What passes between the corners unseen, a line thinner than a pixel, it may miss in
//! some pixels and see in others, as one sample a pixel does.

use embedded_graphics::Drawable;
use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Size};
use embedded_graphics::image::ImageDrawable;
use embedded_graphics::pixelcolor::{PixelColor, Rgb888};
use embedded_graphics::prelude::{Point, PointsIter};
use embedded_graphics::primitives::Rectangle;
use glam::Vec3;

use crate::camera::View;
use crate::candidates::Candidates;
use crate::geometry::Geometry;
use crate::material::Finish;
use crate::math::{Exact, Math};
use crate::picture::{self, Picture};
use crate::ray::Ray;
use crate::scene::{Light, LightSource, Scene};
use crate::subdivision;
use crate::trace::{Count, Tracer};

/// The most samples to a side of a pixel.
pub const MOST: u32 = 16;

/// What of a radiance a display shows.
#[inline(always)]
pub fn shown(radiance: Vec3) -> Vec3 {
    radiance.min(Vec3::ONE)
}

/// The view whose pixels are the samples of this one's: so many times as wide and as high.
pub fn magnified(view: &View, samples: u32) -> View {
    let samples = samples.clamp(1, MOST);
    View {
        width: view.width.saturating_mul(samples),
        height: view.height.saturating_mul(samples),
        ..*view
    }
}

/// Fills `pixels` with a row of a scene's picture, left to right: linear RGB, at most 1, each the mean of
/// `samples` × `samples` rays, from 1 to [`MOST`]. Rows count from the top.
///
/// The rays are those of [`magnified`]'s picture, and are added row by row, left to right.
pub fn supersampled_row<G, L, const DEPTH: usize, P, C>(
    scene: &Scene<'_, G, L>,
    view: &View,
    row: u32,
    samples: u32,
    tracer: &mut Tracer<DEPTH, P, C>,
    pixels: &mut [Vec3],
) where
    G: Geometry<Material: Finish>,
    L: LightSource,
    P: Math,
    C: Count,
{
    let samples = samples.clamp(1, MOST);
    let fine = magnified(view, samples);
    pixels.fill(Vec3::ZERO);
    for line in 0..samples {
        let line = row.saturating_mul(samples).saturating_add(line);
        let mut radiances = picture::row(scene, &fine, line, tracer);
        for pixel in &mut *pixels {
            for radiance in radiances.by_ref().take(samples as usize) {
                *pixel += shown(radiance);
            }
        }
    }
    let share = share(samples);
    for pixel in pixels {
        *pixel *= share;
    }
}

/// What each of `samples` × `samples` weighs.
pub fn share(samples: u32) -> f32 {
    1.0 / (samples * samples) as f32
}

/// What a sample is that is yet to be traced: no radiance is.
const UNKNOWN: Vec3 = Vec3::NAN;

/// Pixels with more rays where the picture changes.
///
/// After J. T. Whitted, "An Improved Illumination Model for Shaded Display", CACM 23(6), 1980: where the
/// four corners of a pixel differ by more than a bound, it is divided into quarters, and those again, down
/// to (N - 1) × (N - 1) squares, where N is 3, 5, 9 or 17. What is not divided is the mean of its corners.
///
/// What pixels have in common is traced once, where there is memory for it: rows of pixels pass on to the
/// next as many samples as `shared` has room for. The corners take `width + 1`; another `width * (N - 2)`
/// keep all. The picture does not depend on it, nor on which pixels are asked for or in which order; going
/// through rows from the top, and through a row from the left, takes the fewest rays.
///
/// ```
/// use whitted::antialiasing::Adaptive;
/// use whitted::{Camera, Light, Material, Object, Scene, Sphere, Tracer, Vec3, View};
///
/// static RED: Material = Material::matte(Vec3::X, 1.0, 0.0);
/// static BALL: [Object<Sphere>; 1] =
///     [Object { shape: Sphere { center: Vec3::new(0.0, 0.0, -3.0), radius: 1.0 }, material: &RED }];
/// static SCENE: Scene<&[Object<Sphere>]> =
///     Scene { geometry: &BALL, lights: &[], background: Vec3::ZERO, ambient: Vec3::ONE };
///
/// let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 0.5, 1.0)?;
/// let view = View { camera, width: 16, height: 16 };
/// let mut shared = [Vec3::ZERO; 17];
/// let tracer = Tracer::<1>::new();
/// let mut adaptive = Adaptive::<_, _, _, _, 1, 5>::new(&SCENE, view, tracer, 1.0 / 32.0, &mut shared);
/// for row in 0..16 {
///     for pixel in adaptive.row(row) {
///         assert!((0.0..=1.0).contains(&pixel.x));
///     }
/// }
/// # Ok::<(), whitted::CameraError>(())
/// ```
#[derive(Debug)]
pub struct Adaptive<'a, G, L, P, C, const DEPTH: usize, const N: usize> {
    /// Traces and counts.
    pub tracer: Tracer<DEPTH, P, C>,
    scene: &'a Scene<'a, G, L>,
    eye: Vec3,
    corner: Vec3,
    /// One pixel to the right, and one down.
    steps: [Vec3; 2],
    width: u32,
    bound: f32,
    /// First the corners, then what lies between them: of the lower edges of pixels left of the last one,
    /// and of the upper edges of the others.
    shared: &'a mut [Vec3],
    /// The right edge of the last pixel.
    edge: [Vec3; N],
    /// The row that is drawn, from where, up to which pixel.
    row: u32,
    start: u32,
    end: u32,
    /// The columns whose upper edges are known.
    above: core::ops::Range<u32>,
}

impl<'a, G, L, P, C, const DEPTH: usize, const N: usize> Adaptive<'a, G, L, P, C, DEPTH, N>
where
    G: Geometry<Material: Finish>,
    L: LightSource,
    P: Math,
    C: Count,
{
    const LEVELS: u8 = (N - 1).ilog2() as u8;

    /// Draws a view of a scene, with squares divided where channels of their corners, of at most 1, differ
    /// by more than `bound`.
    pub fn new(
        scene: &'a Scene<'a, G, L>,
        view: View,
        tracer: Tracer<DEPTH, P, C>,
        bound: f32,
        shared: &'a mut [Vec3],
    ) -> Self {
        const {
            assert!(
                N == 3 || N == 5 || N == 9 || N == 17,
                "a pixel is halved one to four times"
            );
        }
        let camera = &view.camera;
        Self {
            tracer,
            scene,
            eye: camera.eye,
            corner: camera.corner,
            steps: [
                camera.right / view.width as f32,
                camera.down / view.height as f32,
            ],
            width: view.width,
            bound,
            shared,
            edge: [UNKNOWN; N],
            row: 0,
            start: 0,
            end: 0,
            above: 0..0,
        }
    }

    /// The pixels of a row, left to right: linear RGB, at most 1. Rows count from the top.
    #[inline]
    pub fn row(
        &mut self,
        row: u32,
    ) -> impl ExactSizeIterator<Item = Vec3> + use<'_, 'a, G, L, P, C, DEPTH, N> {
        (0..self.width).map(move |column| self.pixel(column, row))
    }

    /// A pixel: linear RGB, at most 1.
    pub fn pixel(&mut self, column: u32, row: u32) -> Vec3 {
        self.turn_to(column, row);
        let mut samples = [[UNKNOWN; N]; N];
        if self.above.contains(&column) {
            for (x, sample) in samples[0].iter_mut().enumerate() {
                let known = Self::place(self.width, column, x).and_then(|it| self.shared.get(it));
                *sample = known.copied().unwrap_or(UNKNOWN);
            }
        }
        // The left edge is the last pixel's right one.
        for (line, known) in samples.iter_mut().zip(self.edge) {
            if !known.x.is_nan() {
                line[0] = known;
            }
        }
        let bound = self.bound;
        let mean = subdivision::mean(
            Self::LEVELS,
            true,
            |x, y| {
                let Some(sample) = samples
                    .get_mut(usize::from(y))
                    .and_then(|line| line.get_mut(usize::from(x)))
                else {
                    return Vec3::ZERO;
                };
                if sample.x.is_nan() {
                    *sample = self.sample(column, row, x, y);
                }
                *sample
            },
            |[a, b, c, d], _| {
                let range = a.max(*b).max(c.max(*d)) - a.min(*b).min(c.min(*d));
                range.max_element() > bound
            },
        );
        for (x, sample) in samples[N - 1].iter().enumerate() {
            let place = Self::place(self.width, column, x);
            if let Some(kept) = place.and_then(|it| self.shared.get_mut(it)) {
                *kept = *sample;
            }
        }
        for (kept, line) in self.edge.iter_mut().zip(&samples) {
            *kept = line[N - 1];
        }
        mean
    }

    /// Forgets what is not known of a pixel's edges.
    #[inline]
    fn turn_to(&mut self, column: u32, row: u32) {
        if (column, row) != (self.end, self.row) || self.start == self.end {
            let follows = self.row.checked_add(1) == Some(row);
            self.above = if follows { self.start..self.end } else { 0..0 };
            self.edge = [UNKNOWN; N];
            self.start = column;
            self.row = row;
        }
        self.end = column.saturating_add(1);
    }

    /// Where a sample of a horizontal edge is kept.
    #[inline]
    fn place(width: u32, column: u32, x: usize) -> Option<usize> {
        let (width, column) = (width as usize, column as usize);
        let place = if x == 0 {
            column
        } else if x == N - 1 {
            column + 1
        } else {
            (N - 2).checked_mul(column)?.checked_add(width + x)?
        };
        Some(place)
    }

    fn sample(&mut self, column: u32, row: u32, x: u8, y: u8) -> Vec3 {
        let at = |pixel: u32, part: u8| pixel as f32 + f32::from(part) * (1.0 / (N - 1) as f32);
        let [right, down] = self.steps;
        let start = self.corner + down * at(row, y);
        let direction = Exact::normalize(start + right * at(column, x));
        let ray = Ray::new(self.eye, direction);
        shown(self.tracer.radiance_among(self.scene, ray, Candidates::ALL))
    }
}

/// A [`Picture`] whose pixels are [`Adaptive`]'s. Room for `SHARED` samples is on the stack while it is
/// drawn.
#[derive(Clone, Copy, Debug)]
pub struct Smooth<
    'a,
    G,
    Color,
    const DEPTH: usize,
    const N: usize,
    const SHARED: usize,
    L = Light,
    P = Exact,
> {
    /// Of what, and how light is followed.
    pub picture: Picture<'a, G, Color, DEPTH, L, P>,
    /// By how much channels may differ within a pixel that is not looked at more closely.
    pub bound: f32,
}

impl<G, Color, const DEPTH: usize, const N: usize, const SHARED: usize, L, P> OriginDimensions
    for Smooth<'_, G, Color, DEPTH, N, SHARED, L, P>
{
    fn size(&self) -> Size {
        self.picture.size()
    }
}

impl<G, Color, const DEPTH: usize, const N: usize, const SHARED: usize, L, P> ImageDrawable
    for Smooth<'_, G, Color, DEPTH, N, SHARED, L, P>
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
        let mut shared = [UNKNOWN; SHARED];
        let Picture { scene, view, .. } = self.picture;
        let mut tracer = Tracer::<DEPTH, P>::with(());
        tracer.depth = self.picture.tracer.depth;
        tracer.threshold = self.picture.tracer.threshold;
        let mut adaptive =
            Adaptive::<_, _, _, _, DEPTH, N>::new(scene, view, tracer, self.bound, &mut shared);
        let placed = Rectangle::new(Point::zero(), area.size);
        let colors = area.points().map(|at| {
            let radiance = adaptive.pixel(at.x as u32, at.y as u32);
            let [red, green, blue] = picture::to_rgb8(radiance);
            Color::from(Rgb888::new(red, green, blue))
        });
        target.fill_contiguous(&placed, colors)
    }
}

impl<G, Color, const DEPTH: usize, const N: usize, const SHARED: usize, L, P> Drawable
    for Smooth<'_, G, Color, DEPTH, N, SHARED, L, P>
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

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec;
    use std::vec::Vec;

    use embedded_graphics::image::{Image, ImageDrawableExt};
    use embedded_graphics::mock_display::MockDisplay;
    use embedded_graphics::pixelcolor::Rgb565;

    use super::*;
    use crate::camera::Camera;
    use crate::geometry::Object;
    use crate::material::Material;
    use crate::shape::sphere::Sphere;
    use crate::trace::Counters;

    const WHITE: Material = Material::matte(Vec3::ONE, 1.0, 0.0);
    const BRIGHT: Material = Material::matte(Vec3::splat(100.0), 1.0, 0.0);
    type Balls<'a> = &'a [Object<'a, Sphere>];

    fn ball(x: f32, radius: f32, material: &Material) -> Object<'_, Sphere> {
        Object {
            shape: Sphere {
                center: Vec3::new(x, 0.0, -4.0),
                radius,
            },
            material,
        }
    }

    fn scene<'a>(balls: Balls<'a>) -> Scene<'a, Balls<'a>> {
        Scene {
            geometry: balls,
            lights: &[],
            background: Vec3::ZERO,
            ambient: Vec3::ONE,
        }
    }

    fn view(width: u32, height: u32) -> View {
        let aspect = width as f32 / height as f32;
        let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 0.5, aspect).unwrap();
        View {
            camera,
            width,
            height,
        }
    }

    fn counting() -> Tracer<1, Exact, Counters> {
        Tracer::with(Counters::default())
    }

    /// All pixels, and how many rays they took, with room for so many samples.
    fn adaptive<const N: usize>(
        balls: Balls<'_>,
        view: View,
        bound: f32,
        room: usize,
    ) -> (Vec<f32>, u64) {
        let scene = scene(balls);
        let mut shared = vec![Vec3::ONE; room];
        let mut adaptive =
            Adaptive::<_, _, _, _, 1, N>::new(&scene, view, counting(), bound, &mut shared);
        let mut pixels = Vec::new();
        for row in 0..view.height {
            let row = adaptive.row(row);
            assert_eq!(row.len(), view.width as usize);
            pixels.extend(row.map(|it| it.x));
        }
        (pixels, adaptive.tracer.counters.primary)
    }

    #[test]
    fn where_nothing_changes_a_pixel_takes_one_ray() {
        let view = view(20, 10);
        let (pixels, rays) = adaptive::<9>(&[], view, 0.0, 21);
        assert!(pixels.iter().all(|it| *it == 0.0));
        assert_eq!(rays, 21 * 11);
        // Without memory, rows share nothing; a row's pixels still do.
        assert_eq!(adaptive::<9>(&[], view, 0.0, 0).1, 10 * 2 * 21);
        // All differences are below the bound, and to what is not a number nothing compares.
        let balls = [ball(0.0, 1.0, &WHITE)];
        for bound in [1.0, f32::INFINITY, f32::NAN] {
            assert_eq!(adaptive::<9>(&balls, view, bound, 21).1, 21 * 11);
        }
    }

    #[test]
    fn neither_memory_nor_order_changes_a_bit() {
        let balls = [ball(-0.4, 0.7, &WHITE), ball(0.9, 0.3, &BRIGHT)];
        let view = view(17, 11);
        let (expected, most) = adaptive::<5>(&balls, view, 0.1, 0);
        let mut rays = most;
        for room in [5, 18, 48, 18 + 17 * 3] {
            let (found, fewer) = adaptive::<5>(&balls, view, 0.1, room);
            assert_eq!(found, expected, "{room}");
            assert!(fewer < rays, "{room}: {fewer}, not below {rays}");
            rays = fewer;
        }
        let all = adaptive::<5>(&balls, view, 0.1, 500).1;
        assert_eq!(all, rays, "no more to keep");
        let scene = scene(&balls);
        let mut shared = [Vec3::ONE; 40];
        let mut adaptive =
            Adaptive::<_, _, _, _, 1, 5>::new(&scene, view, counting(), 0.1, &mut shared);
        let mut check = |column: u32, row: u32| {
            let found = adaptive.pixel(column, row).x;
            let expected = expected[(row * 17 + column) as usize];
            assert_eq!(found, expected, "{column}, {row}");
        };
        // Backwards, across, some pixels twice; parts of rows.
        for place in (0..17 * 11).rev() {
            check(place % 17, place / 17);
        }
        for step in 0..2000_u32 {
            let place = step.wrapping_mul(2_654_435_769) >> 16;
            check(place % 17, place / 17 % 11);
            check(place % 17, place / 17 % 11);
        }
        let parts = [
            (3, 4..9),
            (4, 4..9),
            (5, 2..12),
            (6, 7..8),
            (7, 0..17),
            (8, 5..17),
        ];
        for (row, columns) in parts {
            columns.for_each(|column| check(column, row));
        }
        // Beyond the picture there is more of the scene, and no panic.
        adaptive.pixel(u32::MAX, u32::MAX);
        adaptive.pixel(17, 3);
        adaptive.pixel(0, u32::MAX);
    }

    #[test]
    fn outlines_become_what_a_pixel_is_covered_by() {
        let balls = [ball(0.0, 1.0, &WHITE)];
        let view = view(24, 24);
        let mut exact = vec![Vec3::ZERO; 24];
        let (found, rays) = adaptive::<9>(&balls, view, 0.0, 24 * 8 + 1);
        assert!(rays < 24 * 24 * 4, "{rays}");
        let mut worst = 0.0_f32;
        for row in 0..24 {
            supersampled_row(&scene(&balls), &view, row, 16, &mut counting(), &mut exact);
            for (exact, found) in exact.iter().zip(&found[24 * row as usize..]) {
                worst = worst.max((exact.x - found).abs());
            }
        }
        // An edge is off by up to half of one of the smallest squares, in each of their eight rows.
        assert!((0.0..0.0625).contains(&worst), "{worst}");
    }

    #[test]
    fn samples_are_the_pixels_of_a_larger_picture() {
        let balls = [ball(0.2, 1.0, &WHITE), ball(-0.9, 0.4, &BRIGHT)];
        let scene = scene(&balls);
        let view = view(7, 5);
        let fine = magnified(&view, 3);
        assert_eq!((fine.width, fine.height), (21, 15));
        let larger: Vec<Vec<Vec3>> = (0..15)
            .map(|row| picture::row(&scene, &fine, row, &mut counting()).collect())
            .collect();
        // Longer than the picture is wide.
        let mut pixels = [Vec3::ONE; 8];
        for row in 0..5 {
            let mut tracer = counting();
            supersampled_row(&scene, &view, row, 3, &mut tracer, &mut pixels);
            assert_eq!(tracer.counters.primary, 7 * 9);
            for (column, pixel) in pixels[..7].iter().enumerate() {
                let mut sum = Vec3::ZERO;
                for line in &larger[3 * row as usize..][..3] {
                    for radiance in &line[3 * column..][..3] {
                        sum += radiance.min(Vec3::ONE);
                    }
                }
                assert_eq!(*pixel, sum * (1.0 / 9.0), "{column}, {row}");
            }
            assert_eq!(pixels[7], Vec3::ZERO);
        }
    }

    #[test]
    fn numbers_of_samples_have_bounds() {
        let balls = [ball(0.2, 1.0, &WHITE)];
        let scene = scene(&balls);
        let view = view(3, 2);
        for (samples, taken) in [(0, 1), (1, 1), (16, 256), (u32::MAX, 256)] {
            let mut tracer = counting();
            let mut pixels = [Vec3::ZERO; 3];
            supersampled_row(&scene, &view, 1, samples, &mut tracer, &mut pixels);
            assert_eq!(tracer.counters.primary, 3 * taken);
        }
        // One sample is the middle, as in a plain picture.
        let mut pixels = [Vec3::ZERO; 3];
        supersampled_row(&scene, &view, 0, 1, &mut counting(), &mut pixels);
        let mut tracer = counting();
        assert!(picture::row(&scene, &view, 0, &mut tracer).eq(pixels));
        // No rows, no columns.
        supersampled_row(&scene, &view, u32::MAX, 16, &mut counting(), &mut pixels);
        supersampled_row(&scene, &view, 0, 4, &mut counting(), &mut []);
    }

    #[test]
    fn one_pixel_is_a_picture() {
        let balls = [ball(0.0, 0.5, &BRIGHT)];
        let one = view(1, 1);
        // Its corners are black: what lies between them is not seen.
        assert_eq!(adaptive::<3>(&balls, one, 0.0, 2), (vec![0.0], 4));
        // The ball covers two of them.
        let balls = [ball(2.0, 2.0, &BRIGHT)];
        let (pixels, rays) = adaptive::<17>(&balls, one, 0.0, 2 + 15);
        assert!((0.3..0.5).contains(&pixels[0]), "{pixels:?}");
        assert!(rays < 17 * 17, "{rays}");
    }

    #[test]
    fn what_lies_between_corners_is_seen_by_regular_samples_alone() {
        // A row of balls, each in the middle of a pixel.
        let view = view(8, 8);
        let step = 4.0 / 8.0;
        let balls: Vec<_> = (0..8)
            .map(|i| {
                let mut ball = ball((i as f32 - 3.5) * step, 0.1, &WHITE);
                ball.shape.center.y = 0.5 * step;
                ball
            })
            .collect();
        let (pixels, rays) = adaptive::<5>(&balls, view, 0.0, 9);
        assert_eq!((rays, pixels.iter().sum::<f32>()), (81, 0.0));
        let mut row = [Vec3::ZERO; 8];
        supersampled_row(&scene(&balls), &view, 3, 4, &mut counting(), &mut row);
        assert!(row.iter().all(|it| it.x > 0.0));
    }

    #[test]
    fn displays_show_smooth_pictures_and_parts_of_them() {
        let balls = [ball(0.3, 0.9, &WHITE)];
        let scene = scene(&balls);
        let view = view(9, 7);
        let picture = Smooth::<_, _, 1, 5, 10> {
            picture: Picture::new(&scene, view),
            bound: 0.05,
        };
        let expected: Vec<_> = {
            let (pixels, _) = adaptive::<5>(&balls, view, 0.05, 0);
            let color = |x: f32| {
                let [red, green, blue] = picture::to_rgb8(Vec3::splat(x));
                Rgb565::from(Rgb888::new(red, green, blue))
            };
            pixels.into_iter().map(color).collect()
        };
        let mut display = MockDisplay::<Rgb565>::new();
        Drawable::draw(&picture, &mut display).unwrap();
        let part = Rectangle::new(Point::new(2, 1), Size::new(4, 5));
        let mut cut = MockDisplay::<Rgb565>::new();
        Image::new(&picture.sub_image(&part), Point::new(2, 1))
            .draw(&mut cut)
            .unwrap();
        for y in 0..7 {
            for x in 0..9 {
                let at = Point::new(x, y);
                let color = expected[(y * 9 + x) as usize];
                assert_eq!(display.get_pixel(at), Some(color), "{at}");
                let in_part = part.contains(at).then_some(color);
                assert_eq!(cut.get_pixel(at), in_part, "{at}");
            }
        }
        // Nothing of it.
        let outside = Rectangle::new(Point::new(20, 1), Size::new(4, 5));
        let mut empty = MockDisplay::<Rgb565>::new();
        picture.draw_sub_image(&mut empty, &outside).unwrap();
        assert_eq!(empty, MockDisplay::new());
    }
}
