//! Pictures of a [`Grid`] with one ray a column: textured walls, and sprites.
//!
//! What id Software's Wolfenstein 3D (1992) did: where the camera is level, a column of the picture shows
//! one wall, and that as high as it is near, measured along the view and not along the ray.

use embedded_graphics::Drawable;
use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Size};
use embedded_graphics::pixelcolor::{PixelColor, Rgb565, Rgb888};
use embedded_graphics::prelude::Point;
use embedded_graphics::primitives::Rectangle;
use glam::Vec3;
use heapless::Vec;

use crate::camera::View;
use crate::grid::{Grid, Meeting, Plan, Way};
use crate::math;

/// A bitmap in flash: 8 bits a pixel and a palette, or, where `T` says so, colors.
///
/// A wall in another shade is the same texels with another palette.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Texture<'a, C, T = u8> {
    /// In pixels; from 1.
    pub width: u16,
    /// In pixels; from 1.
    pub height: u16,
    /// Column after column from the left, each from the top: places in the palette, or colors. What the
    /// palette or the slice lacks is transparent.
    pub texels: &'a [T],
    /// Colors of the display; of texels that are colors themselves it is not asked.
    pub palette: &'a [C],
}

/// What a [`Texture`] of colors `C` is made of.
pub trait Texel<C>: Copy {
    /// The color, unless it is transparent.
    fn color(self, palette: &[C]) -> Option<C>;
}

impl<C: Copy> Texel<C> for u8 {
    #[inline(always)]
    fn color(self, palette: &[C]) -> Option<C> {
        palette.get(self as usize).copied()
    }
}

impl Texel<Self> for Rgb565 {
    #[inline(always)]
    fn color(self, _: &[Self]) -> Option<Self> {
        Some(self)
    }
}

impl Texel<Self> for Rgb888 {
    #[inline(always)]
    fn color(self, _: &[Self]) -> Option<Self> {
        Some(self)
    }
}

/// `None` where it is transparent.
impl<C: Copy> Texel<C> for Option<C> {
    #[inline(always)]
    fn color(self, _: &[C]) -> Self {
        self
    }
}

impl<'a, C, T> Texture<'a, C, T> {
    /// The column at `u`, which runs from 0 at the left to 1 at the right.
    #[inline]
    fn column(&self, u: f32) -> &'a [T] {
        // The cast makes zero of what is less, and of NaN.
        let column = (u * self.width as f32) as u16;
        let column = column.min(self.width.saturating_sub(1)) as usize;
        let height = self.height as usize;
        let start = column * height;
        self.texels.get(start..start + height).unwrap_or(&[])
    }
}

/// A bitmap that stands upright in the map and is always seen from its front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sprite<'a, C> {
    /// The middle of its lower edge.
    pub position: Vec3,
    /// In cells; above 0.
    pub width: f32,
    /// In cells; above 0.
    pub height: f32,
    /// What it shows.
    pub texture: &'a Texture<'a, C>,
}

/// A map as a picture that embedded-graphics can draw, column by column.
///
/// A column is one `fill_contiguous`, computed while it is sent: there is no frame buffer, and the only
/// memory is a list of `SPRITES` sprites. Of more than these in front of the camera the nearest are
/// drawn.
///
/// The camera is level: of what [`View`] says of it only the picture's horizontal extent to the sides,
/// and its vertical extent downwards counts. Walls reach from y = 0 to y = 1.
///
/// The last two generic parameters are what walls' textures are made of, and the map: a [`Grid`], or a
/// [`DoorGrid`](crate::grid::DoorGrid).
///
/// ```
/// use embedded_graphics::{Drawable, mock_display::MockDisplay, pixelcolor::Rgb565, prelude::*};
/// use whitted::columns::{Columns, Texture};
/// use whitted::{Camera, Grid, Vec3, View};
///
/// static BRICK: Texture<Rgb565> =
///     Texture { width: 1, height: 2, texels: &[0, 1], palette: &[Rgb565::RED, Rgb565::YELLOW] };
/// static ROOM: Columns<Rgb565, 0> = Columns {
///     grid: Grid { width: 3, depth: 3, cells: &[1, 1, 1, 1, 0, 1, 1, 1, 1] },
///     walls: &[[&BRICK; 4]],
///     sprites: &[],
///     floor: Rgb565::GREEN,
///     ceiling: Rgb565::BLUE,
/// };
/// let eye = Vec3::new(1.5, 0.5, 1.9);
/// let camera = Camera::look_at(eye, eye + Vec3::NEG_Z, Vec3::Y, 0.8, 1.25)?;
/// let mut display = MockDisplay::<Rgb565>::new();
/// ROOM.picture(&View { camera, width: 4, height: 6 }).draw(&mut display)?;
/// display.assert_pattern(&["RBBR", "RRRR", "RRRR", "YYYY", "YYYY", "YGGY"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Columns<'a, C, const SPRITES: usize, T = u8, G = Grid<'a>> {
    /// The map.
    pub grid: G,
    /// By kind of wall, its sides to the west, east, north and south, seen from there. A wall of a kind
    /// that is not here shows floor and ceiling.
    pub walls: &'a [[&'a Texture<'a, C, T>; 4]],
    /// What stands in it, in any order.
    pub sprites: &'a [Sprite<'a, C>],
    /// Of all that is below the horizon.
    pub floor: C,
    /// Of all that is above.
    pub ceiling: C,
}

impl<'a, C: PixelColor, const SPRITES: usize, T, G> Columns<'a, C, SPRITES, T, G> {
    /// The map as seen by a camera; to be drawn, or taken column by column.
    pub fn picture(&'a self, view: &View) -> ColumnPicture<'a, C, SPRITES, T, G> {
        let screen = Screen::new(view);
        let mut visible: Vec<Visible<'a, C>, SPRITES> = Vec::new();
        for sprite in self.sprites {
            let Some(seen) = screen.project(sprite) else {
                continue;
            };
            let place = visible.iter().position(|it| seen.depth < it.depth);
            let place = place.unwrap_or(visible.len());
            if visible.is_full() && place < visible.len() {
                visible.pop();
            }
            // Full of nearer ones, or there is room now.
            let _ = visible.insert(place, seen);
        }
        ColumnPicture {
            columns: self,
            screen,
            sprites: visible,
        }
    }
}

/// A [`Columns`] as seen by a camera.
pub struct ColumnPicture<'a, C, const SPRITES: usize, T = u8, G = Grid<'a>> {
    columns: &'a Columns<'a, C, SPRITES, T, G>,
    screen: Screen,
    /// From the nearest on.
    sprites: Vec<Visible<'a, C>, SPRITES>,
}

/// A view, as columns need it. Depths count in lengths of the horizontal part of the vector from the eye
/// to the screen.
#[derive(Clone, Copy, Debug)]
struct Screen {
    eye: Vec3,
    /// From the eye to the picture's left edge, and from column to column; level.
    start: Vec3,
    step: Vec3,
    /// From the eye to the upper edge, and from row to row; upwards.
    top: f32,
    down: f32,
    width: u32,
    height: u32,
}

/// A sprite on the screen.
struct Visible<'a, C> {
    depth: f32,
    /// Where its left edge is, in columns, and the share of its width that a column shows.
    left: f32,
    share: f32,
    low: f32,
    high: f32,
    texture: &'a Texture<'a, C>,
}

/// What a column shows of a texture.
struct Slice<'a, C, T = u8> {
    texels: &'a [T],
    palette: &'a [C],
    /// The first row, and the one after the last.
    first: u32,
    end: u32,
    /// Where in the column the first row is, and how far on the next; in units of 2^-16 texels.
    v: i32,
    dv: i32,
}

impl<C: PixelColor, T: Texel<C>> Slice<'_, C, T> {
    /// The color in a row, unless it is transparent there.
    #[inline(always)]
    fn color(&self, row: u32) -> Option<C> {
        if row < self.first || row >= self.end {
            return None;
        }
        let rows = (row - self.first) as i32;
        let v = self.v.wrapping_add(self.dv.wrapping_mul(rows)) >> 16;
        // The last row's center may be rounded to the lower edge.
        let v = (v.max(0) as usize).min(self.texels.len().saturating_sub(1));
        self.texels.get(v)?.color(self.palette)
    }
}

/// How many rows' numbers are at most `place`.
#[inline(always)]
fn rows_up_to(place: f32) -> u32 {
    // Also false for NaN. The cast saturates.
    if place >= 0.0 {
        (place as u32).saturating_add(1)
    } else {
        0
    }
}

/// How many rows' numbers are less than `place`.
#[inline(always)]
fn rows_before(place: f32) -> u32 {
    let whole = place as u32;
    let is_part = (whole as f32) < place;
    whole.saturating_add(is_part as u32)
}

/// The component upwards of the cross product of vectors that are level.
#[inline(always)]
fn cross(a: Vec3, b: Vec3) -> f32 {
    a.z * b.x - a.x * b.z
}

impl Screen {
    fn new(view: &View) -> Self {
        let camera = &view.camera;
        Self {
            eye: camera.eye,
            start: camera.corner,
            step: camera.right / view.width as f32,
            top: camera.corner.y,
            down: camera.down.y / view.height as f32,
            width: view.width,
            height: view.height,
        }
    }

    /// From the eye to the middle of a column.
    #[inline(always)]
    fn direction(&self, column: u32) -> Vec3 {
        self.start + self.step * (column as f32 + 0.5)
    }

    /// Rows above the horizon.
    fn horizon(&self) -> u32 {
        rows_before(-self.top / self.down - 0.5)
    }

    /// The rows that show heights from `low` to `high` at some depth, both excluded.
    #[inline(always)]
    fn slice<'a, C, T>(
        &self,
        depth: f32,
        low: f32,
        high: f32,
        texels: &'a [T],
        palette: &'a [C],
    ) -> Slice<'a, C, T> {
        let row = |height: f32| ((height - self.eye.y) / depth - self.top) / self.down - 0.5;
        let (upper, lower) = (row(high), row(low));
        let first = rows_up_to(upper);
        // A row is `-down * depth` high in the map.
        let dv = texels.len() as f32 * (-self.down * depth / (high - low));
        let fixed = |texels: f32| (texels * 65536.0) as i32;
        Slice {
            texels,
            palette,
            first,
            end: rows_before(lower),
            v: fixed((first as f32 - upper) * dv),
            dv: fixed(dv),
        }
    }

    /// Where a sprite is seen; `None` behind the eye, or where something is not a number.
    fn project<'a, C>(&self, sprite: &Sprite<'a, C>) -> Option<Visible<'a, C>> {
        let Sprite {
            position,
            width,
            height,
            texture,
        } = *sprite;
        // It is at `depth * (start + column * step)`: Cramer's rule.
        let to_sprite = position - self.eye;
        let area = cross(self.start, self.step);
        let depth = cross(to_sprite, self.step) / area;
        let column = cross(self.start, to_sprite) / (area * depth);
        let (x, z) = (self.step.x, self.step.z);
        let columns = width / (depth * math::sqrt(x * x + z * z));
        let is_seen = columns > 0.0 && column.is_finite();
        is_seen.then_some(Visible {
            depth,
            left: column - columns * 0.5,
            share: 1.0 / columns,
            low: position.y,
            high: position.y + height,
            texture,
        })
    }
}

impl<'a, C, const SPRITES: usize, T, G> ColumnPicture<'a, C, SPRITES, T, G>
where
    C: PixelColor,
    T: Texel<C>,
    G: Plan<'a>,
{
    /// What the ray of a column meets, and at what depth: what lies `depth` times as far as the screen.
    #[inline]
    pub fn wall(&self, column: u32) -> Option<Meeting> {
        let direction = self.screen.direction(column);
        let grid = &self.columns.grid;
        grid.start(self.screen.eye, direction, f32::INFINITY)?
            .next_wall()
    }

    /// The pixels of a column, from the top.
    #[inline]
    pub fn pixels(&self, column: u32) -> impl Iterator<Item = C> {
        let (screen, columns) = (&self.screen, self.columns);
        let met = self.wall(column);
        let depth = met.map_or(f32::INFINITY, |it| it.t);
        // As many as there are.
        let mut slices: Vec<Slice<'a, C>, SPRITES> = Vec::new();
        for sprite in &self.sprites {
            let u = (column as f32 + 0.5 - sprite.left) * sprite.share;
            if sprite.depth < depth && (0.0..1.0).contains(&u) {
                let texels = sprite.texture.column(u);
                let palette = sprite.texture.palette;
                let slice = screen.slice(sprite.depth, sprite.low, sprite.high, texels, palette);
                let fits = slices.push(slice).is_ok();
                debug_assert!(fits, "more sprites in a column than in the picture");
            }
        }
        let wall = met.and_then(|met| {
            let kind = columns.grid.kind(met.cell) as usize;
            let texture = *columns
                .walls
                .get(kind.wrapping_sub(1))?
                .get(met.face as usize)?;
            let u = self.across(column, &met);
            Some(screen.slice(met.t, 0.0, 1.0, texture.column(u), texture.palette))
        });
        let horizon = screen.horizon();
        (0..screen.height).map(move |row| {
            let sprite = slices.iter().find_map(|it| it.color(row));
            let color = sprite.or_else(|| wall.as_ref()?.color(row));
            color.unwrap_or(if row < horizon {
                columns.ceiling
            } else {
                columns.floor
            })
        })
    }

    /// How far from the left edge of a wall, seen from outside, a column's ray meets it.
    #[inline(always)]
    fn across(&self, column: u32, met: &Meeting) -> f32 {
        let (direction, eye) = (self.screen.direction(column), self.screen.eye);
        let grid = &self.columns.grid;
        let width = (grid.grid().width as usize).max(1);
        let (x, z) = (met.cell % width, met.cell / width);
        // In the cell that was met: rounding may put the point into the next.
        let from_west = (eye.x - x as f32) + met.t * direction.x;
        let from_north = (eye.z - z as f32) + met.t * direction.z;
        grid.across((met.cell, met.face), from_west, from_north)
    }
}

impl<C, const SPRITES: usize, T, G> OriginDimensions for ColumnPicture<'_, C, SPRITES, T, G> {
    fn size(&self) -> Size {
        Size::new(self.screen.width, self.screen.height)
    }
}

impl<'a, C, const SPRITES: usize, T, G> Drawable for ColumnPicture<'a, C, SPRITES, T, G>
where
    C: PixelColor,
    T: Texel<C>,
    G: Plan<'a>,
{
    type Color = C;
    type Output = ();

    fn draw<D: DrawTarget<Color = C>>(&self, target: &mut D) -> Result<(), D::Error> {
        for column in 0..self.screen.width {
            let area = Rectangle::new(
                Point::new(column as i32, 0),
                Size::new(1, self.screen.height),
            );
            target.fill_contiguous(&area, self.pixels(column))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;
    use crate::grid::{Across, Door, DoorGrid};
    use embedded_graphics::mock_display::MockDisplay;
    use embedded_graphics::pixelcolor::RgbColor;

    type Bitmap = Texture<'static, Rgb565>;

    /// Two columns, red to the left.
    const FLAG: Bitmap = Texture {
        width: 2,
        height: 1,
        texels: &[0, 1],
        palette: &[Rgb565::RED, Rgb565::YELLOW],
    };
    const PLAIN: Bitmap = Texture {
        width: 1,
        height: 1,
        texels: &[0],
        palette: &[Rgb565::MAGENTA],
    };
    /// A room of one cell and its four walls.
    const CELL: Grid = Grid {
        width: 3,
        depth: 3,
        cells: &[1, 1, 1, 1, 0, 1, 1, 1, 1],
    };
    const MIDDLE: Vec3 = Vec3::new(1.5, 0.5, 1.5);

    fn view(eye: Vec3, to: Vec3, width: u32, height: u32, tan_half_fov: f32) -> View {
        let aspect = width as f32 / height as f32;
        let camera = Camera::look_at(eye, eye + to, Vec3::Y, tan_half_fov, aspect).unwrap();
        View {
            camera,
            width,
            height,
        }
    }

    fn draw<const SPRITES: usize>(
        columns: &Columns<'_, Rgb565, SPRITES>,
        view: &View,
    ) -> MockDisplay<Rgb565> {
        let mut display = MockDisplay::new();
        columns.picture(view).draw(&mut display).unwrap();
        display
    }

    const ROOM: Columns<Rgb565, 0> = Columns {
        grid: CELL,
        walls: &[[&FLAG, &FLAG, &FLAG, &FLAG]],
        sprites: &[],
        floor: Rgb565::GREEN,
        ceiling: Rgb565::BLUE,
    };

    #[test]
    fn walls_read_from_left_to_right_on_each_side() {
        for to in [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z] {
            // The wall ahead fills three quarters of the height and just the width.
            let display = draw(&ROOM, &view(MIDDLE, to, 4, 8, 2.0));
            let wall = [
                "BBBB", "BBBB", "RRYY", "RRYY", "RRYY", "RRYY", "GGGG", "GGGG",
            ];
            display.assert_pattern(&wall);
        }
    }

    #[test]
    fn a_wall_across_the_view_is_as_high_at_the_sides_as_in_the_middle() {
        let hall = Columns {
            grid: Grid {
                width: 16,
                depth: 2,
                cells: &[1; 16],
            },
            ..ROOM
        };
        let eye = Vec3::new(8.0, 0.5, 1.75);
        let view = view(eye, Vec3::NEG_Z, 64, 48, 1.0);
        let picture = hall.picture(&view);
        for column in 0..64 {
            assert_eq!(picture.wall(column).map(|it| it.t), Some(0.75), "{column}");
            let open = [ROOM.floor, ROOM.ceiling];
            let walls = picture.pixels(column).filter(|it| !open.contains(it));
            assert_eq!(walls.count(), 32, "{column}");
        }
    }

    fn sprite(z: f32, x: f32, texture: &'static Bitmap) -> Sprite<'static, Rgb565> {
        Sprite {
            position: Vec3::new(x, 0.0, z),
            width: 0.5,
            height: 0.5,
            texture,
        }
    }

    #[test]
    fn sprites_hide_each_other_and_are_hidden_by_depth() {
        // A frame around nothing, and two plain sprites.
        static FRAME: Bitmap = Texture {
            width: 3,
            height: 3,
            texels: &[0, 0, 0, 0, 255, 0, 0, 0, 0],
            palette: &[Rgb565::WHITE],
        };
        static BLACK: Bitmap = Texture {
            palette: &[Rgb565::BLACK],
            ..PLAIN
        };
        let near = sprite(2.5, 1.5, &FRAME);
        let far = sprite(1.5, 1.5, &BLACK);
        let behind = sprite(4.5, 1.5, &BLACK);
        let in_the_wall = sprite(0.5, 1.5, &BLACK);
        let hall = Grid {
            width: 3,
            depth: 5,
            cells: &[1, 1, 1, 1, 0, 1, 1, 0, 1, 1, 0, 1, 1, 1, 1],
        };
        let view = view(Vec3::new(1.5, 0.25, 3.5), Vec3::NEG_Z, 6, 6, 0.25);
        let both = ["WWWWWW", "WWWWWW", "WWKKWW", "WWKKWW", "WWWWWW", "WWWWWW"];
        let orders = [
            [near, far, behind, in_the_wall],
            [in_the_wall, behind, far, near],
        ];
        for sprites in &orders {
            let scene = Columns::<_, 4> {
                grid: hall,
                walls: &[[&PLAIN; 4]],
                sprites,
                floor: Rgb565::GREEN,
                ceiling: Rgb565::BLUE,
            };
            draw(&scene, &view).assert_pattern(&both);
            // Room for the nearest only: the far one is left out, and the wall is seen.
            let scene = Columns::<_, 1> {
                grid: hall,
                walls: &[[&PLAIN; 4]],
                sprites,
                floor: Rgb565::GREEN,
                ceiling: Rgb565::BLUE,
            };
            let one = ["WWWWWW", "WWWWWW", "WWMMWW", "WWMMWW", "WWWWWW", "WWWWWW"];
            draw(&scene, &view).assert_pattern(&one);
        }
        let hidden = Columns::<_, 4> {
            grid: hall,
            walls: &[[&PLAIN; 4]],
            sprites: &[near, in_the_wall],
            floor: Rgb565::GREEN,
            ceiling: Rgb565::BLUE,
        };
        let one = ["WWWWWW", "WWWWWW", "WWMMWW", "WWMMWW", "WWWWWW", "WWWWWW"];
        draw(&hidden, &view).assert_pattern(&one);
    }

    #[test]
    fn doors_slide_aside_with_what_they_show_and_hide_sprites() {
        static BLACK: Bitmap = Texture {
            palette: &[Rgb565::BLACK],
            ..PLAIN
        };
        let seen = |open: f32, sprite: Sprite<'static, Rgb565>| {
            let doors = [Door {
                kind: 2,
                across: Across::X,
                open,
            }];
            let scene = Columns::<_, 1, _, _> {
                grid: DoorGrid {
                    grid: Grid {
                        width: 5,
                        depth: 3,
                        cells: &[1, 1, 1, 1, 1, 1, 0, 3, 0, 1, 1, 1, 1, 1, 1],
                    },
                    first: 3,
                    doors: &doors,
                },
                walls: &[[&PLAIN; 4], [&FLAG; 4]],
                sprites: &[sprite],
                floor: Rgb565::GREEN,
                ceiling: Rgb565::BLUE,
            };
            // Just the width of the door, half a cell away, at the height of sprites.
            let ahead = view(Vec3::new(2.0, 0.25, 1.5), Vec3::X, 8, 1, 0.125);
            let mut display = MockDisplay::new();
            scene.picture(&ahead).draw(&mut display).unwrap();
            let row = (0..8).map(|x| display.get_pixel(Point::new(x, 0)).unwrap());
            let letter = |color| match color {
                Rgb565::RED => 'R',
                Rgb565::YELLOW => 'Y',
                Rgb565::MAGENTA => 'M',
                Rgb565::BLACK => 'K',
                _ => '?',
            };
            row.map(letter).collect::<Vec<char, 8>>()
        };
        let nowhere = sprite(1.5, -9.0, &BLACK);
        for (open, row) in [
            (-0.25, "RRRRYYYY"),
            (0.0, "RRRRYYYY"),
            (0.25, "MMRRRRYY"),
            (0.5, "MMMMRRRR"),
            (1.0, "MMMMMMMM"),
        ] {
            let found = seen(open, nowhere);
            assert!(found.iter().copied().eq(row.chars()), "{open}: {found:?}");
        }
        let behind = sprite(1.5, 3.0, &BLACK);
        let before = sprite(1.5, 2.25, &BLACK);
        let found = seen(0.5, behind);
        assert!(found.iter().copied().eq("MMMKRRRR".chars()), "{found:?}");
        let found = seen(0.5, before);
        assert!(found.iter().copied().eq("KKKKKKKK".chars()), "{found:?}");
    }

    #[test]
    fn walls_may_be_of_colors_without_a_palette() {
        static HIGH: Texture<Rgb565, Rgb565> = Texture {
            width: 2,
            height: 1,
            texels: &[Rgb565::RED, Rgb565::YELLOW],
            palette: &[],
        };
        let high = Columns::<_, 0, _> {
            grid: CELL,
            walls: &[[&HIGH; 4]],
            sprites: &[],
            floor: Rgb565::GREEN,
            ceiling: Rgb565::BLUE,
        };
        let view = view(MIDDLE, Vec3::new(1.0, 0.0, 0.375), 16, 12, 1.0);
        let mut display = MockDisplay::new();
        high.picture(&view).draw(&mut display).unwrap();
        display.assert_eq(&draw(&ROOM, &view));
    }

    #[test]
    fn nothing_panics_and_what_is_missing_shows_floor_and_ceiling() {
        let numbers = [0.0, -1.0, 1e-38, 3e38, f32::INFINITY, f32::NAN];
        let sprites = [sprite(1.0, f32::NAN, &PLAIN), sprite(1.2, 1.5, &FLAG)];
        let broken = Columns::<Rgb565, 2> {
            grid: CELL,
            walls: &[],
            sprites: &sprites,
            floor: Rgb565::GREEN,
            ceiling: Rgb565::BLUE,
        };
        let empty: Bitmap = Texture {
            texels: &[],
            ..PLAIN
        };
        let faces = [[&empty, &FLAG, &PLAIN, &PLAIN]];
        let other = Columns {
            walls: &faces,
            ..broken
        };
        for number in numbers {
            for place in 0..12 {
                let mut view = view(MIDDLE, Vec3::X, 5, 4, 1.0);
                let camera = &mut view.camera;
                let vectors = [
                    &mut camera.eye,
                    &mut camera.corner,
                    &mut camera.right,
                    &mut camera.down,
                ];
                for (index, vector) in vectors.into_iter().enumerate() {
                    if index == place / 3 {
                        vector[place % 3] = number;
                    }
                }
                draw(&broken, &view);
                draw(&other, &view);
            }
        }
        let ahead = view(Vec3::new(1.5, 0.5, 1.1), Vec3::X, 4, 4, 1.0);
        draw(&broken, &ahead).assert_pattern(&["BBBB", "BBBB", "GGGG", "GGGG"]);
    }
}
