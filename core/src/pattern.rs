//! Colors that change along a surface.
//!
//! A material's color is any [`Pattern`]: a plain [`Vec3`], [`Checker`] and [`Stripes`] that fill space, or
//! an [`ImageMap`], an image in flash laid over the surface by its shape's own
//! [coordinates](crate::Shape::uv). A scene that names none links none.

use embedded_graphics::pixelcolor::{Rgb565, Rgb888, RgbColor};
use glam::Vec3;

use crate::columns::{Texel, Texture};
use crate::math::dot;

/// A place on a surface, as patterns see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// In world space.
    pub point: Vec3,
    /// Unit normal of the outward side.
    pub outward: Vec3,
    /// As [`Shape::uv`](crate::Shape::uv); (0, 0) unless the pattern [asks](Varying::is_mapped) for it.
    pub uv: (f32, f32),
}

/// A color term of a [`Material`](crate::Material): a plain color, or a [`Varying`] one.
pub trait Pattern {
    /// What is kept of a look at it: `()` where the color is the same everywhere, and is read where it is
    /// needed: registers are few.
    type Look: Copy;

    /// Looks at it in one place, of which `spot` tells; [`Spot::uv`] if it is asked to.
    fn look(&self, spot: impl FnOnce(bool) -> Spot) -> Self::Look;

    /// The color that was seen: linear RGB, each from 0 to 1.
    fn seen(&self, look: Self::Look) -> Vec3;
}

impl Pattern for Vec3 {
    type Look = ();

    #[inline(always)]
    fn look(&self, _: impl FnOnce(bool) -> Spot) {}

    #[inline(always)]
    fn seen(&self, (): ()) -> Vec3 {
        *self
    }
}

/// A pattern that is not the same everywhere.
pub trait Varying {
    /// Whether it asks for [`Spot::uv`].
    #[inline(always)]
    fn is_mapped(&self) -> bool {
        false
    }

    /// Linear RGB, each from 0 to 1.
    fn at(&self, spot: &Spot) -> Vec3;
}

impl<V: Varying> Pattern for V {
    type Look = Vec3;

    #[inline(always)]
    fn look(&self, spot: impl FnOnce(bool) -> Spot) -> Vec3 {
        self.at(&spot(self.is_mapped()))
    }

    #[inline(always)]
    fn seen(&self, color: Vec3) -> Vec3 {
        color
    }
}

/// How far beneath a surface solid patterns are looked up, in cells.
///
/// A floor may lie in the boundary between two cells, where its points are rounded to either side. Beneath
/// it there is one cell: the color of such a surface is the one that its object has inside. A surface
/// parallel to the boundary is moved across it and not along it, so that no other boundary moves. This
/// holds where a hit point is off by less than this, for cells from 2^-10 of the coordinates on.
pub const BENEATH: f32 = 1.0 / 1024.0;

/// Which cell a coordinate lies in: the greatest whole number that is not above it, the last one of its
/// sign beyond 2^31, and 0 for NaN.
#[inline(always)]
fn cell(x: f32) -> i32 {
    let toward_zero = x as i32;
    // Also false for NaN.
    toward_zero.saturating_sub((toward_zero as f32 > x) as i32)
}

/// Cubes of two colors, of which each has six neighbors of the other color.
///
/// The first color is that of the cube from the origin to (`size`, `size`, `size`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Checker {
    /// Linear RGB, each from 0 to 1.
    pub colors: [Vec3; 2],
    /// Of a cube, in world units; above 0.
    pub size: f32,
}

impl Varying for Checker {
    #[inline]
    fn at(&self, spot: &Spot) -> Vec3 {
        let beneath = spot.point * (1.0 / self.size) - spot.outward * BENEATH;
        let sum = cell(beneath.x) ^ cell(beneath.y) ^ cell(beneath.z);
        self.colors[(sum & 1) as usize]
    }
}

/// Layers of two colors.
///
/// The first color is that of the layer that begins at the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stripes {
    /// Linear RGB, each from 0 to 1.
    pub colors: [Vec3; 2],
    /// Across the layers; unit length.
    pub direction: Vec3,
    /// Of a layer, in world units; above 0.
    pub size: f32,
}

impl Varying for Stripes {
    #[inline]
    fn at(&self, spot: &Spot) -> Vec3 {
        let along = dot(&spot.point, &self.direction) * (1.0 / self.size);
        let beneath = along - dot(&spot.outward, &self.direction) * BENEATH;
        self.colors[(cell(beneath) & 1) as usize]
    }
}

/// An image whose pixels can be asked for.
pub trait Image {
    /// Pixels in a row.
    fn width(&self) -> u32;
    /// Rows.
    fn height(&self) -> u32;
    /// The pixel of a column, from the left, and a row, from the top: linear RGB. Black where there is none.
    fn pixel(&self, column: u32, row: u32) -> Vec3;
}

/// Light of a display's color.
trait Lit {
    fn light(self) -> Vec3;
}

impl Lit for Rgb565 {
    #[inline(always)]
    fn light(self) -> Vec3 {
        let [red, green, blue] = [self.r(), self.g(), self.b()].map(f32::from);
        Vec3::new(
            red * (1.0 / 31.0),
            green * (1.0 / 63.0),
            blue * (1.0 / 31.0),
        )
    }
}

impl Lit for Rgb888 {
    #[inline(always)]
    fn light(self) -> Vec3 {
        [self.r(), self.g(), self.b()].light()
    }
}

/// Red, green, blue.
impl Lit for [u8; 3] {
    #[inline(always)]
    fn light(self) -> Vec3 {
        Vec3::from_array(self.map(f32::from)) * (1.0 / 255.0)
    }
}

/// A bitmap with a palette, a byte a pixel, or of colors.
impl<C: Lit, T: Texel<C>> Image for Texture<'_, C, T> {
    #[inline(always)]
    fn width(&self) -> u32 {
        self.width.into()
    }

    #[inline(always)]
    fn height(&self) -> u32 {
        self.height.into()
    }

    #[inline]
    fn pixel(&self, column: u32, row: u32) -> Vec3 {
        let place = column as usize * self.height as usize + row as usize;
        let texel = self.texels.get(place);
        let color = texel.and_then(|it| it.color(self.palette));
        color.map_or(Vec3::ZERO, |it| it.light())
    }
}

/// A bitmap of two bytes a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HighColor<'a> {
    /// In pixels; from 1.
    pub width: u16,
    /// In pixels; from 1.
    pub height: u16,
    /// Row after row from the top, each from the left.
    pub pixels: &'a [Rgb565],
}

impl Image for HighColor<'_> {
    #[inline(always)]
    fn width(&self) -> u32 {
        self.width.into()
    }

    #[inline(always)]
    fn height(&self) -> u32 {
        self.height.into()
    }

    #[inline]
    fn pixel(&self, column: u32, row: u32) -> Vec3 {
        let place = row as usize * self.width as usize + column as usize;
        self.pixels.get(place).map_or(Vec3::ZERO, |it| it.light())
    }
}

/// An image on a surface, repeated in both directions.
///
/// u runs to the right and v upwards; the image's lower left corner is at (0, 0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageMap<'a, I, F = Nearest> {
    /// What is shown.
    pub image: &'a I,
    /// How many copies there are in a unit of u and of v; negative: mirrored.
    pub repeat: (f32, f32),
    /// What is between pixels.
    pub filter: F,
}

/// What an [`ImageMap`] shows between the centers of pixels.
pub trait Filter {
    /// The image at a place from 0 to 1 from the left, and from the top.
    fn sample(&self, image: &impl Image, across: f32, down: f32) -> Vec3;
}

/// The nearest pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Nearest;

/// A blend of the four nearest pixels, over the edge too, where the next copy begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bilinear;

impl Filter for Nearest {
    #[inline]
    fn sample(&self, image: &impl Image, across: f32, down: f32) -> Vec3 {
        // The casts make zero of what is less, and of NaN. A product may be rounded up to the edge.
        let place = |share: f32, count: u32| {
            let place = (share * count as f32) as u32;
            place.min(count.saturating_sub(1))
        };
        image.pixel(place(across, image.width()), place(down, image.height()))
    }
}

impl Filter for Bilinear {
    #[inline]
    fn sample(&self, image: &impl Image, across: f32, down: f32) -> Vec3 {
        // Between which two pixels, and how far from the first; the one after the last is the first.
        let between = |share: f32, count: u32| {
            let place = share * count as f32 + (count as f32 - 0.5);
            let first = place as u32;
            let wrapped = |place: u32| place.checked_rem(count).unwrap_or(0);
            let rest = place - first as f32;
            (wrapped(first), wrapped(first.saturating_add(1)), rest)
        };
        let (left, right, across) = between(across, image.width());
        let (upper, lower, down) = between(down, image.height());
        let mix = |a: Vec3, b: Vec3, share: f32| a + (b - a) * share;
        let row = |row| mix(image.pixel(left, row), image.pixel(right, row), across);
        mix(row(upper), row(lower), down).map(crate::math::positive)
    }
}

impl<I: Image, F: Filter> Varying for ImageMap<'_, I, F> {
    #[inline(always)]
    fn is_mapped(&self) -> bool {
        true
    }

    #[inline]
    fn at(&self, spot: &Spot) -> Vec3 {
        // Beyond 2^31 there are no cells. NaN stays what it is.
        let fraction = |x: f32| (x - cell(x) as f32).clamp(0.0, 1.0);
        let across = fraction(spot.uv.0 * self.repeat.0);
        let up = fraction(spot.uv.1 * self.repeat.1);
        self.filter.sample(self.image, across, 1.0 - up)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Geometry, Object};
    use crate::ray::Ray;
    use crate::shape::plane::Plane;

    const BLACK: Vec3 = Vec3::ZERO;
    const WHITE: Vec3 = Vec3::ONE;
    const BOARD: Checker = Checker {
        colors: [WHITE, BLACK],
        size: 0.5,
    };

    fn on_floor(x: f32, y: f32, z: f32) -> Spot {
        Spot {
            point: Vec3::new(x, y, z),
            outward: Vec3::Y,
            uv: (0.0, 0.0),
        }
    }

    #[test]
    fn cells_change_at_whole_multiples_of_their_size() {
        let cases = [
            // Beneath the floor at 0 there is the second color.
            ((0.1, 0.0, 0.1), BLACK),
            ((0.6, 0.0, 0.1), WHITE),
            ((-0.1, 0.0, 0.1), WHITE),
            ((-0.1, 0.0, -0.1), BLACK),
            ((0.1, 0.5, 0.1), WHITE),
            ((0.0, 0.0, 0.0), BLACK),
            ((0.5, 0.0, 0.0), WHITE),
            ((-0.5, 0.0, 0.0), WHITE),
        ];
        for ((x, y, z), color) in cases {
            assert_eq!(BOARD.at(&on_floor(x, y, z)), color, "{x} {y} {z}");
        }
        let layers = Stripes {
            colors: [WHITE, BLACK],
            direction: Vec3::Y,
            size: 2.0,
        };
        let heights = [(0.0, BLACK), (1.0, WHITE), (2.0, WHITE), (2.1, BLACK)];
        for (y, color) in heights {
            assert_eq!(layers.at(&on_floor(0.0, y, 0.0)), color, "{y}");
        }
    }

    #[test]
    fn a_surface_in_the_boundary_of_cells_has_no_specks() {
        // Floors at whole multiples of a cell, near and far from the origin: every point of a cell has one
        // color, however its height is rounded.
        let mut off = 0;
        for (size, cells) in [(0.5, 0), (1.0, 7), (0.1, 30), (0.3, 640), (1.0, -999)] {
            let board = Checker {
                colors: [WHITE, BLACK],
                size,
            };
            let height = cells as f32 * size;
            let floor = [Object {
                shape: Plane {
                    point: Vec3::Y * height,
                    normal: Vec3::Y,
                },
                material: &(),
            }];
            for i in 0_i32..40_000 {
                // Rays from all about to the middle half of a cell.
                let [a, b, c, d] = [7, 31, 57, 97].map(|it| (i * it % 101) as f32 / 101.0);
                let (column, row) = (i % 23 - 11, i % 19 - 9);
                let target = Vec3::new(
                    (column as f32 + 0.25 + 0.5 * a) * size,
                    height,
                    (row as f32 + 0.25 + 0.5 * b) * size,
                );
                let origin = target + Vec3::new(c - 0.5, 0.01 + d, b - a) * (60.0 * size);
                let ray = Ray::new(origin, (target - origin).normalize());
                let hit = floor.as_slice().closest_hit(&ray).unwrap();
                off += (hit.point.y != height) as u32;
                let spot = Spot {
                    point: hit.point,
                    outward: hit.normal,
                    uv: (0.0, 0.0),
                };
                let second = (column + row + cells - 1).rem_euclid(2) == 1;
                let color = if second { BLACK } else { WHITE };
                assert_eq!(board.at(&spot), color, "{size} {cells} {ray:?}");
            }
        }
        assert!(off > 2_000, "{off} points were rounded off their floors");
    }

    #[test]
    fn nothing_is_a_surprise_in_what_is_no_number_or_has_no_size() {
        let odd = [
            0.0,
            -0.0,
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            1e30,
            -1e30,
        ];
        let image = HighColor {
            width: 1,
            height: 1,
            pixels: &[Rgb565::WHITE],
        };
        let empty = HighColor {
            width: 0,
            height: 0,
            pixels: &[],
        };
        let short = HighColor {
            width: 3,
            height: 2,
            pixels: &[Rgb565::WHITE],
        };
        for a in odd {
            for b in odd {
                let spot = Spot {
                    point: Vec3::new(a, b, a),
                    outward: Vec3::new(b, a, b),
                    uv: (a, b),
                };
                for size in odd {
                    let colors = [WHITE, BLACK];
                    let direction = Vec3::new(a, b, size);
                    let stripes = Stripes {
                        colors,
                        direction,
                        size,
                    };
                    assert!(colors.contains(&Checker { colors, size }.at(&spot)));
                    assert!(colors.contains(&stripes.at(&spot)));
                }
                for image in [&image, &empty, &short] {
                    let repeat = (1.0, b);
                    let filter = Nearest;
                    let nearest = ImageMap {
                        image,
                        repeat,
                        filter,
                    };
                    assert!([WHITE, BLACK].contains(&nearest.at(&spot)), "{spot:?}");
                    let filter = Bilinear;
                    let blended = ImageMap {
                        image,
                        repeat,
                        filter,
                    };
                    let color = blended.at(&spot);
                    assert!(color.cmpge(Vec3::ZERO).all(), "{spot:?}: {color}");
                    assert!(color.cmple(Vec3::ONE).all(), "{spot:?}: {color}");
                }
            }
        }
    }

    /// Red, green over blue, white.
    const FOUR: HighColor = HighColor {
        width: 2,
        height: 2,
        pixels: &[Rgb565::RED, Rgb565::GREEN, Rgb565::BLUE, Rgb565::WHITE],
    };

    #[test]
    fn images_stand_upright_and_repeat() {
        let palette: Texture<Rgb888> = Texture {
            width: 2,
            height: 2,
            texels: &[0, 2, 1, 3],
            palette: &[Rgb888::RED, Rgb888::GREEN, Rgb888::BLUE, Rgb888::WHITE],
        };
        let cases = [
            ((0.25, 0.25), Vec3::Z),
            ((0.75, 0.25), Vec3::ONE),
            ((0.25, 0.75), Vec3::X),
            ((0.75, 0.75), Vec3::Y),
            ((7.75, -3.25), Vec3::Y),
            ((-1e-9, 0.25), Vec3::ONE),
        ];
        for (uv, color) in cases {
            let spot = Spot {
                uv,
                ..on_floor(0.0, 0.0, 0.0)
            };
            let (repeat, filter) = ((1.0, 1.0), Nearest);
            let image = &FOUR;
            let map = ImageMap {
                image,
                repeat,
                filter,
            };
            assert_eq!(map.at(&spot), color, "{uv:?}");
            let image = &palette;
            let map = ImageMap {
                image,
                repeat,
                filter,
            };
            assert_eq!(map.at(&spot), color, "{uv:?}");
        }
    }

    #[test]
    fn blends_have_the_pixels_colors_at_their_centers() {
        let map = ImageMap {
            image: &FOUR,
            repeat: (1.0, 1.0),
            filter: Bilinear,
        };
        let cases = [
            ((0.25, 0.25), Vec3::Z),
            ((0.75, 0.75), Vec3::Y),
            ((0.5, 0.75), Vec3::new(0.5, 0.5, 0.0)),
            // Over the edge.
            ((0.0, 0.75), Vec3::new(0.5, 0.5, 0.0)),
            ((0.5, 0.5), Vec3::new(0.5, 0.5, 0.5)),
            ((0.5, 1.0), Vec3::new(0.5, 0.5, 0.5)),
        ];
        for (uv, color) in cases {
            let spot = Spot {
                uv,
                ..on_floor(0.0, 0.0, 0.0)
            };
            assert_eq!(map.at(&spot), color, "{uv:?}");
        }
    }
}
