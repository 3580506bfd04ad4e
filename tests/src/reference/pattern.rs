//! Colors that change along a surface.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use embedded_graphics::pixelcolor::RgbColor;
use glam::DVec3;
use whitted_cli::scene_file::texture::Texture;

use super::Shape;

/// What takes a color's place.
#[derive(Clone, Debug)]
pub enum Pattern {
    /// Cubes of two colors.
    Checker {
        /// The first from the origin on.
        colors: [DVec3; 2],
        /// Of a cube.
        size: f64,
    },
    /// Layers of two colors.
    Stripes {
        /// The first from the origin on.
        colors: [DVec3; 2],
        /// Across the layers; unit length.
        direction: DVec3,
        /// Of a layer.
        size: f64,
    },
    /// A picture.
    Image {
        /// The picture.
        texture: Arc<Texture>,
        /// Copies in a unit of each coordinate.
        repeat: [f64; 2],
        /// Whether pixels are blended.
        blend: bool,
    },
}

/// Solid patterns are looked up beneath the surface, by this share of a cell.
const BENEATH: f64 = 1.0 / 1024.0;

impl Pattern {
    /// At a point of a surface.
    pub fn color(&self, shape: &Shape, point: DVec3, outward: DVec3) -> DVec3 {
        let is_second = |cells: f64| cells.rem_euclid(2.0) >= 1.0;
        match self {
            Self::Checker { colors, size } => {
                let cells = (point / size - BENEATH * outward).floor();
                colors[usize::from(is_second(cells.element_sum()))]
            }
            Self::Stripes {
                colors,
                direction,
                size,
            } => {
                let along = (point / size - BENEATH * outward).dot(*direction);
                colors[usize::from(is_second(along.floor()))]
            }
            Self::Image {
                texture,
                repeat,
                blend,
            } => {
                let [u, v] = coordinates(shape, point, outward);
                // In pixels from the upper left, of endless copies.
                let (width, height) = size(texture);
                let x = u * repeat[0] * width as f64;
                let y = -v * repeat[1] * height as f64;
                let pixel = |column: f64, row: f64| {
                    let column = column.rem_euclid(width as f64) as usize;
                    pixel(texture, column, row.rem_euclid(height as f64) as usize)
                };
                if !blend {
                    return pixel(x.floor(), y.floor());
                }
                let (left, upper) = ((x - 0.5).floor(), (y - 0.5).floor());
                let (across, down) = (x - 0.5 - left, y - 0.5 - upper);
                let row = |row| pixel(left, row).lerp(pixel(left + 1.0, row), across);
                row(upper).lerp(row(upper + 1.0), down)
            }
        }
    }
}

fn size(texture: &Texture) -> (usize, usize) {
    let (width, height) = match texture {
        Texture::Palette(it) => (it.width, it.height),
        Texture::High(it) => (it.width, it.height),
    };
    (width.into(), height.into())
}

fn pixel(texture: &Texture, column: usize, row: usize) -> DVec3 {
    let (width, height) = size(texture);
    match texture {
        Texture::Palette(it) => {
            let place = usize::from(it.texels[column * height + row]);
            let bytes = it.palette.get(place).copied().unwrap_or_default();
            DVec3::from_array(bytes.map(f64::from)) / 255.0
        }
        Texture::High(it) => {
            let color = it.pixels[row * width + column];
            let parts = [color.r(), color.g(), color.b()].map(f64::from);
            DVec3::from_array(parts) / DVec3::new(31.0, 63.0, 31.0)
        }
    }
}

/// Level, to the right for who looks at a surface.
fn right(normal: DVec3) -> DVec3 {
    let level = DVec3::Y.cross(normal);
    level.try_normalize().unwrap_or(DVec3::X)
}

/// As the README lays images over shapes.
fn coordinates(shape: &Shape, point: DVec3, outward: DVec3) -> [f64; 2] {
    let turn = |angle: f64| 0.5 + angle / TAU;
    match shape {
        Shape::Sphere { center, radius } => {
            let d = (point - *center) / radius.abs();
            [turn(d.x.atan2(d.z)), 0.5 + d.y.clamp(-1.0, 1.0).asin() / PI]
        }
        Shape::Plane {
            point: zero,
            normal,
        } => {
            let normal = normal.normalize();
            let d = point - *zero;
            [d.dot(right(normal)), d.dot(normal.cross(right(normal)))]
        }
        Shape::Cuboid { min, max } => {
            let d = (point - *min) / (*max - *min);
            let side = right(outward);
            let up = outward.cross(side);
            let along = |way: DVec3| {
                let share = way.dot(d);
                // From the end where it starts.
                if way.element_sum() < 0.0 {
                    1.0 + share
                } else {
                    share
                }
            };
            [along(side), along(up)]
        }
        Shape::Torus {
            center,
            axis,
            major,
            ..
        } => {
            let axis = axis.normalize();
            let d = point - *center;
            let front = right(axis).cross(axis);
            let (x, z) = (d.dot(right(axis)), d.dot(front));
            [
                turn(x.atan2(z)),
                turn(d.dot(axis).atan2(x.hypot(z) - major)),
            ]
        }
        other => unimplemented!("images on {other:?}"),
    }
}
