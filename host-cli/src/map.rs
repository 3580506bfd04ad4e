//! Maps as the ray caster takes them: by columns, and as a maze to trace.

use std::ops::Range;

use embedded_graphics::pixelcolor::{Rgb888, RgbColor};
use glam::Vec3;
use rayon::prelude::*;
use whitted::columns::{Columns, Sprite, Texture};
use whitted::picture::{quantize, row};
use whitted::{Camera, Counters, Exact, Grid, Maze, Scene, Tracer, View};

use crate::render::Settings;
use crate::scene::{self, Light, Material};
use crate::scene_file::Scale;
use crate::scene_file::limits;
use crate::scene_file::map::{MapFile, SPRITES};
use crate::scene_file::texture::Bitmap;
use crate::scene_file::{SceneError, proportions};

/// A map's colors, materials and lights.
pub struct HostMap<'a> {
    file: &'a MapFile,
    palettes: Vec<Vec<Rgb888>>,
    walls: Vec<Material>,
    floor: Material,
    ceiling: Option<Material>,
    lights: Vec<Light>,
}

impl<'a> HostMap<'a> {
    /// Takes them from a file.
    pub fn new(file: &'a MapFile) -> Self {
        let color = |&[red, green, blue]: &[u8; 3]| Rgb888::new(red, green, blue);
        let palette = |it: &Bitmap| it.palette.iter().map(color).collect();
        Self {
            file,
            palettes: file.textures.iter().map(palette).collect(),
            walls: file
                .walls
                .iter()
                .map(|it| scene::material(&it.material, Scale::default()))
                .collect(),
            floor: scene::material(&file.floor, Scale::default()),
            ceiling: (file.ceiling.as_ref()).map(|it| scene::material(it, Scale::default())),
            lights: file
                .lights
                .iter()
                .map(|it| Light::new(it, Scale::default()))
                .collect(),
        }
    }

    /// The file that this is the map of.
    pub fn file(&self) -> &'a MapFile {
        self.file
    }

    /// What the player sees, for a picture of some size in pixels.
    ///
    /// # Errors
    ///
    /// Where that is no picture.
    pub fn view(&self, width: u32, height: u32) -> Result<View, SceneError> {
        let player = &self.file.player;
        let eye = vector(player.eye);
        let [x, z] = proportions(player.direction);
        let tan_half = libm::tan(player.fov.to_radians() / 2.0) as f32;
        let aspect = width as f32 / height as f32;
        // Seen from the corner of the map: a target near a far eye has lost digits.
        let level = Camera::look_at(Vec3::ZERO, Vec3::new(x, 0.0, z), Vec3::Y, tan_half, aspect);
        match level {
            Ok(camera) => Ok(View {
                camera: Camera { eye, ..camera },
                width,
                height,
            }),
            Err(error) => Err(SceneError {
                path: self.file.path.clone(),
                place: Some(player.place),
                problem: error.into(),
            }),
        }
    }

    /// The plan.
    pub fn grid(&self) -> Grid<'_> {
        let [width, depth] = self.file.cells;
        Grid {
            width,
            depth,
            cells: &self.file.plan,
        }
    }

    /// The maze, for tracing.
    pub fn scene(&self) -> Scene<'_, Maze<'_, Material>, Light> {
        Scene {
            geometry: Maze {
                grid: self.grid(),
                walls: &self.walls,
                floor: &self.floor,
                ceiling: self.ceiling.as_ref(),
            },
            lights: &self.lights,
            background: vector(self.file.background),
            ambient: vector(self.file.ambient),
        }
    }

    /// The color of the floor, and of what is above, by columns.
    pub fn plain_colors(&self) -> [Rgb888; 2] {
        let above = self.file.ceiling.as_ref();
        let above = above.map_or(self.file.background, |it| it.color);
        [self.file.floor.color, above].map(|it| {
            let [red, green, blue] = it.map(|it| quantize(it as f32));
            Rgb888::new(red, green, blue)
        })
    }

    /// Draws rows of the picture by columns and gives them to `emit`, in order, some whole rows at a
    /// time, as linear RGB that is written as the bytes of the textures.
    ///
    /// # Errors
    ///
    /// What `emit` returns.
    pub fn draw<E>(
        &self,
        view: &View,
        rows: Range<u32>,
        mut emit: impl FnMut(&[Vec3]) -> Result<(), E>,
    ) -> Result<(), E> {
        let textures: Vec<_> = self
            .file
            .textures
            .iter()
            .zip(&self.palettes)
            .map(|(bitmap, palette)| Texture {
                width: bitmap.width,
                height: bitmap.height,
                texels: &bitmap.texels,
                palette,
            })
            .collect();
        let faces = |it: [usize; 4]| it.map(|place| &textures[place]);
        let walls: Vec<_> = self.file.walls.iter().map(|it| faces(it.faces)).collect();
        let sprites = self.file.sprites.iter().map(|it| Sprite {
            position: vector(it.position),
            width: it.width as f32,
            height: it.height as f32,
            texture: &textures[it.texture],
        });
        let sprites: Vec<_> = sprites.collect();
        let [floor, ceiling] = self.plain_colors();
        let columns: Columns<'_, Rgb888, SPRITES> = Columns {
            grid: self.grid(),
            walls: &walls,
            sprites: &sprites,
            floor,
            ceiling,
        };
        let picture = columns.picture(view);
        let width = view.width as usize;
        let mut start = rows.start;
        while start < rows.end {
            let height = (BATCH / width).clamp(1, (rows.end - start) as usize);
            let mut pixels = vec![Vec3::ZERO; width * height];
            for column in 0..view.width {
                let band = picture.pixels(column).skip(start as usize).take(height);
                for (row, color) in band.enumerate() {
                    let bytes = [color.r(), color.g(), color.b()].map(f32::from);
                    pixels[row * width + column as usize] = Vec3::from_array(bytes) / 255.0;
                }
            }
            emit(&pixels)?;
            start += height as u32;
        }
        Ok(())
    }

    /// Traces rows of the picture and gives them to `emit`, as [`crate::render::render`] does.
    ///
    /// # Errors
    ///
    /// What `emit` returns.
    pub fn trace<E>(
        &self,
        view: &View,
        rows: Range<u32>,
        settings: Settings,
        row_done: impl Fn() + Sync,
        mut emit: impl FnMut(&[Vec3]) -> Result<(), E>,
    ) -> Result<Counters, E> {
        let scene = self.scene();
        let width = view.width as usize;
        let mut counters = Counters::default();
        let mut pixels = Vec::new();
        let mut start = rows.start;
        while start < rows.end {
            let height = (BATCH / width).clamp(1, (rows.end - start) as usize);
            pixels.resize(width * height, Vec3::ZERO);
            let band = pixels
                .par_chunks_mut(width)
                .zip(start..start + height as u32);
            let counted = band.map(|(pixels, y)| {
                let counters = Counters::default();
                let mut tracer = Tracer::<{ limits::DEPTH }, Exact, _>::with(counters);
                tracer.depth = settings.depth;
                tracer.threshold = settings.threshold;
                for (pixel, color) in pixels.iter_mut().zip(row(&scene, view, y, &mut tracer)) {
                    *pixel = color;
                }
                row_done();
                tracer.counters
            });
            counters += counted.reduce(Counters::default, |mut sum, more| {
                sum += more;
                sum
            });
            emit(&pixels)?;
            start += height as u32;
        }
        Ok(counters)
    }
}

/// A point or a color, as it is cast.
pub(crate) fn vector(numbers: [f64; 3]) -> Vec3 {
    Vec3::from_array(numbers.map(|it| it as f32))
}

/// Most pixels that are held at a time.
const BATCH: usize = 1 << 20;
