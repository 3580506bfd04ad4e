//! Maps as the ray caster takes them: by columns, and as a maze to trace.

use std::collections::HashMap;
use std::ops::Range;

use embedded_graphics::pixelcolor::{Rgb888, RgbColor};
use glam::Vec3;
use whitted::columns::{Columns, Sprite, Texture};
use whitted::grid::{DoorGrid, Face, Plan};
use whitted::picture::quantize;
use whitted::{Camera, Counters, Grid, Maze, Scene, View};

use crate::render::{Sampling, Settings, supersample, trace_sampled};
use crate::scene::{self, Light, Material};
use crate::scene_file::map::{MapFile, SPRITES, Wall};
use crate::scene_file::texture::Bitmap;
use crate::scene_file::{Pattern, Scale, SceneError, proportions};

/// A map to trace.
pub type HostMaze<'a> = Maze<'a, Material, [Material; 4], DoorGrid<'a>>;

/// A map's materials and lights.
pub struct HostMap<'a> {
    file: &'a MapFile,
    walls: Vec<[Material; 4]>,
    floor: Material,
    ceiling: Option<Material>,
    lights: Vec<Light>,
}

impl<'a> HostMap<'a> {
    /// Takes them from a file.
    pub fn new(file: &'a MapFile) -> Self {
        Self {
            file,
            walls: file.walls.iter().map(|it| sides(file, it)).collect(),
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
    pub fn grid(&self) -> DoorGrid<'_> {
        let [width, depth] = self.file.cells;
        DoorGrid {
            grid: Grid {
                width,
                depth,
                cells: &self.file.plan,
            },
            first: self.file.first_door,
            doors: &self.file.doors,
        }
    }

    /// The maze, for tracing.
    pub fn scene(&self) -> Scene<'_, HostMaze<'_>, Light> {
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

    /// What a hit object is called, its cell, counted row after row, and its material's name.
    pub fn in_file(&self, object: usize) -> Option<(&'static str, usize, &'a str)> {
        let file = self.file;
        let (cell, face) = Maze::<Material>::place(object)?;
        let (kind, material) = match face {
            Face::Floor => ("floor", &file.floor),
            Face::Ceiling => ("ceiling", file.ceiling.as_ref()?),
            _ => {
                let grid = self.grid();
                let kind = usize::from(grid.kind(cell)).checked_sub(1)?;
                let name = match grid.door(cell) {
                    Some(_) => "door",
                    None => "wall",
                };
                (name, &file.walls.get(kind)?.material)
            }
        };
        Some((kind, cell, &material.name))
    }

    /// Draws rows of the picture by columns, `samples` × `samples` places a pixel, some whole rows at a
    /// time, for `develop` and `emit` as [`crate::render::render`] does: as linear RGB that is written as
    /// the bytes of the textures.
    ///
    /// # Errors
    ///
    /// What `emit` returns.
    pub fn draw<P: Clone + Default, E>(
        &self,
        view: &View,
        rows: Range<u32>,
        samples: u32,
        develop: impl Fn(&[Vec3], &mut [P]),
        mut emit: impl FnMut(&[P]) -> Result<(), E>,
    ) -> Result<(), E> {
        let shown: Vec<_> = (self.file.shown_by_walls().into_iter())
            .map(|place| {
                let texture = &self.file.textures[place];
                (place, texture.size(), texture.pixels())
            })
            .collect();
        let textures: HashMap<_, _> = (shown.iter())
            .map(|(place, [width, height], texels)| {
                let texture = Texture {
                    width: *width,
                    height: *height,
                    texels,
                    palette: &[],
                };
                (*place, texture)
            })
            .collect();
        let faces = |it: [usize; 4]| it.map(|place| &textures[&place]);
        let walls: Vec<_> = self.file.walls.iter().map(|it| faces(it.faces)).collect();
        let palettes: Vec<Vec<Rgb888>> = (self.file.sprites.iter())
            .map(|it| palette(self.file.bitmap(it.texture)))
            .collect();
        let bitmaps: Vec<_> = (self.file.sprites.iter().zip(&palettes))
            .filter_map(|(it, palette)| {
                let bitmap = self.file.bitmap(it.texture)?;
                Some(Texture {
                    width: bitmap.width,
                    height: bitmap.height,
                    texels: &bitmap.texels,
                    palette,
                })
            })
            .collect();
        let sprites = self.file.sprites.iter().zip(&bitmaps);
        let sprites = sprites.map(|(it, texture)| Sprite {
            position: vector(it.position),
            width: it.width as f32,
            height: it.height as f32,
            texture,
        });
        let sprites: Vec<_> = sprites.collect();
        let [floor, ceiling] = self.plain_colors();
        let columns: Columns<'_, Rgb888, SPRITES, _, _> = Columns {
            grid: self.grid(),
            walls: &walls,
            sprites: &sprites,
            floor,
            ceiling,
        };
        let lines =
            |view: &View, rows: Range<u32>, emit: &mut dyn FnMut(&[Vec3]) -> Result<(), E>| {
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
            };
        match samples {
            1 => lines(view, rows, &mut |pixels| {
                let mut developed = vec![P::default(); pixels.len()];
                develop(pixels, &mut developed);
                emit(&developed)
            }),
            _ => supersample(view, rows, samples, develop, emit, lines),
        }
    }

    /// Traces rows of the picture, as [`crate::render::render_sampled`] does.
    ///
    /// # Errors
    ///
    /// What `emit` returns.
    pub fn trace<P: Clone + Default + Send, E>(
        &self,
        view: &View,
        rows: Range<u32>,
        settings: Settings,
        sampling: Sampling,
        develop: impl Fn(&[Vec3], &mut [P]) + Sync,
        emit: impl FnMut(&[P]) -> Result<(), E>,
    ) -> Result<Counters, E> {
        trace_sampled(&self.scene(), view, rows, settings, sampling, develop, emit)
    }
}

/// What the sides of a wall are made of.
fn sides(file: &MapFile, wall: &Wall) -> [Material; 4] {
    std::array::from_fn(|side| {
        let mut material = wall.material.clone();
        if wall.is_textured[side] {
            material.pattern = Some(Pattern::Image {
                texture: file.textures[wall.faces[side]].clone(),
                repeat: [1.0; 2],
                blend: false,
            });
        }
        scene::material(&material, Scale::default())
    })
}

fn palette(bitmap: Option<&Bitmap>) -> Vec<Rgb888> {
    let colors = bitmap.into_iter().flat_map(|it| &it.palette);
    colors
        .map(|&[red, green, blue]| Rgb888::new(red, green, blue))
        .collect()
}

/// A point or a color, as it is cast.
pub(crate) fn vector(numbers: [f64; 3]) -> Vec3 {
    Vec3::from_array(numbers.map(|it| it as f32))
}

/// Most pixels that are held at a time.
const BATCH: usize = 1 << 20;
