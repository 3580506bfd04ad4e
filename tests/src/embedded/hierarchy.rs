//! What a hierarchy in flash saves on the Cortex-M4F, and from how many objects on.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow};
use plotters::prelude::*;
use serde::{Deserialize, Serialize};
use whitted_cli::bake::Layout;
use whitted_cli::scene_file::{self, SceneFile};

use super::expected::{Expected, Kind};
use super::firmware::{self, Request};
use super::image::Image;
use super::target::CORTEX_M4F;
use super::{baked, cortex_m4, run};
use crate::lab::{
    self,
    random::{Random, Stream},
};

/// Instructions and estimated cycles a pixel for a scene of so many objects.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Saving {
    /// The compiler that made the program.
    pub compiler: String,
    /// What the objects are, or the scene's name.
    pub scene: String,
    /// How many they are.
    pub objects: usize,
    /// Instructions, as a plain slice.
    pub flat: f64,
    /// Instructions, as a slice that passes over what a ray cannot meet.
    pub culled: Option<f64>,
    /// Instructions, in a hierarchy.
    pub tree: f64,
    /// Cycles, as a plain slice.
    pub flat_cycles: f64,
    /// Cycles, as a slice that passes over what a ray cannot meet.
    pub culled_cycles: Option<f64>,
    /// Cycles, in a hierarchy.
    pub tree_cycles: f64,
}

/// From few objects to many.
pub const COUNTS: [usize; 10] = [2, 4, 6, 8, 10, 12, 16, 24, 31, 64];
/// What is culled, and up to how many.
const CULLED: &str = "spheres";
const MOST_CULLED: usize = 31;
const STREWN: [&str; 2] = ["spheres", "triangles"];
const SIZE: [u32; 2] = [32, 24];

fn path(extension: &str) -> PathBuf {
    let charts = Path::new(env!("CARGO_MANIFEST_DIR")).join("charts");
    charts.join(format!("firmware-hierarchy.{extension}"))
}

/// What `tests/charts/firmware-hierarchy.csv` says.
///
/// # Errors
///
/// Where it cannot be read.
pub fn read() -> Result<Vec<Saving>> {
    let mut reader = csv::Reader::from_path(path("csv"))?;
    Ok(reader.deserialize().collect::<Result<_, _>>()?)
}

/// Writes that file, and the chart beside it.
///
/// # Errors
///
/// Where they cannot be written.
pub fn write(savings: &[Saving]) -> Result<()> {
    lab::table(&path("csv"), savings)?;
    draw(savings).map_err(|error| anyhow!("{error}"))
}

/// Instructions a pixel over the number of objects.
fn draw(savings: &[Saving]) -> Result<(), Box<dyn std::error::Error>> {
    let path = path("svg");
    let canvas = SVGBackend::new(&path, (760, 420)).into_drawing_area();
    canvas.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&canvas)
        .caption(
            "Objects strewn over the picture, Cortex-M4F: slices and hierarchies",
            ("sans-serif", 18),
        )
        .margin(10)
        .margin_right(190)
        .x_label_area_size(42)
        .y_label_area_size(70)
        .build_cartesian_2d((2.0..64.0).log_scale(), (100.0..20_000.0).log_scale())?;
    chart
        .configure_mesh()
        .x_desc("objects")
        .y_desc("instructions a pixel")
        .x_label_formatter(&|x| format!("{x}"))
        .y_label_formatter(&|y| format!("{y}"))
        .light_line_style(TRANSPARENT)
        .label_style(("sans-serif", 12))
        .draw()?;
    let colors = [RGBColor(200, 30, 45), RGBColor(30, 60, 120)];
    for (kind, color) in STREWN.into_iter().zip(colors) {
        type Cost = fn(&Saving) -> Option<f64>;
        let series: [(_, Cost, _); 3] = [
            ("as a slice", |it| Some(it.flat), 1),
            ("as a culled slice", |it| it.culled, 2),
            ("in a hierarchy", |it| Some(it.tree), 3),
        ];
        for (name, cost, width) in series {
            let is_slice = width == 1;
            let of_kind = savings.iter().filter(|saving| saving.scene == kind);
            let points: Vec<_> = of_kind
                .filter_map(|saving| Some((saving.objects as f64, cost(saving)?)))
                .collect();
            let Some(&last) = points.last() else { continue };
            let style = color.stroke_width(width);
            chart.draw_series(LineSeries::new(points, style).point_size(width + 1))?;
            let (x, y) = chart.backend_coord(&last);
            let font = ("sans-serif", 13).into_font().color(&color);
            // The hierarchies end close to each other.
            let y = if is_slice || kind == STREWN[1] {
                y - 12
            } else {
                y
            };
            canvas.draw(&Text::new(format!("{kind} {name}"), (x + 10, y), font))?;
        }
    }
    Ok(canvas.present()?)
}

/// Objects strewn over a cube that fills the picture, lit with shadows.
fn strewn(kind: &str, count: usize) -> Result<SceneFile> {
    let mut text = String::from(
        "background = [0.5, 0.5, 0.5]\n\
         [camera]\neye = [0, 0, 5]\ntarget = [0, 0, 0]\nfov = 30\n\
         [[light]]\nposition = [4, 6, 8]\n[material.chalk]\n",
    );
    let mut random = Random::new(Stream {
        seed: 0,
        purpose: Stream::purpose(["strewn", kind]),
        cell: count as u64,
        chunk: 0,
    });
    let mut point =
        |around: [f64; 3], by: f64| around.map(|x| x + by * (2.0 * random.unit() - 1.0));
    // About as much of the picture is covered by many as by few.
    let size = 0.8 / (count as f64).sqrt();
    for _ in 0..count {
        let center = point([0.0; 3], 1.0);
        let _ = match kind {
            "spheres" => writeln!(
                text,
                "[[sphere]]\nmaterial = 'chalk'\ncenter = {center:?}\nradius = {size}"
            ),
            _ => {
                let corners = [(); 3].map(|()| point(center, 2.0 * size));
                writeln!(
                    text,
                    "[[triangle]]\nmaterial = 'chalk'\nvertices = {corners:?}"
                )
            }
        };
    }
    Ok(scene_file::toml::parse(Path::new(kind), &text)?)
}

/// Scenes with how many objects they have; standard ones where they are beside the project.
fn scenes(counts: &[usize]) -> Result<baked::Scenes> {
    let mut scenes = baked::Scenes::new();
    for kind in STREWN {
        for &count in counts {
            scenes.push((format!("{kind}-{count}"), strewn(kind, count)?, SIZE));
        }
    }
    if let Some(standard) = baked::standard(&["balls-3"])? {
        scenes.extend(
            standard
                .into_iter()
                .map(|(name, file, _)| (name, file, SIZE)),
        );
    }
    Ok(scenes)
}

/// Draws scenes of so many objects, with hierarchies and without, and counts.
///
/// # Errors
///
/// Where a program cannot be built, run or counted, or draws another picture than the host.
pub fn measure(counts: &[usize], compiler: &str, plugin: &Path) -> Result<Vec<Saving>> {
    let mut savings = Vec::new();
    for scene in scenes(counts)? {
        let cost = |layout| Alone::build(scene.clone(), layout)?.cost(plugin);
        let [flat, flat_cycles] = cost(Layout::Slices)?;
        let [tree, tree_cycles] = cost(Layout::Hierarchies)?;
        let is_culled = scene.0.starts_with(CULLED) && scene.1.objects.len() <= MOST_CULLED;
        let culled = is_culled.then(|| cost(Layout::Culled)).transpose()?;
        let (name, file, _) = scene;
        let kind = STREWN.into_iter().find(|kind| name.starts_with(kind));
        savings.push(Saving {
            compiler: compiler.to_owned(),
            scene: kind.map_or(name, str::to_owned),
            objects: file.objects.len(),
            flat,
            culled: culled.map(|it| it[0]),
            tree,
            flat_cycles,
            culled_cycles: culled.map(|it| it[1]),
            tree_cycles,
        });
    }
    Ok(savings)
}

/// Bytes of flash that a standard scene's program takes in all; none where the scene is not beside the
/// project.
///
/// # Errors
///
/// Where it cannot be built.
pub fn flash_of(name: &'static str) -> Result<Option<u64>> {
    let Some(scenes) = baked::standard(&[name])? else {
        return Ok(None);
    };
    let (name, file, _) = scenes.into_iter().next().context("no scene")?;
    Ok(Some(
        Alone::build((name, file, SIZE), Layout::Fastest)?
            .image
            .flash,
    ))
}

/// A scene in a program of its own: what else is in it would change what is inlined.
struct Alone {
    image: Image,
    expected: Expected,
}

impl Alone {
    /// Bakes and builds a scene.
    fn build((_, file, size): (String, SceneFile, [u32; 2]), layout: Layout) -> Result<Self> {
        let directory = firmware::build_directory().join("baked-counted");
        let scene = ("counted".to_owned(), file, size);
        let baked = baked::write_with(&vec![scene], &directory, layout)?;
        let request = Request {
            programs: &["frame-counted"],
            features: &["counted"],
            baked: Some(&directory),
            ..Request::default()
        };
        let built = firmware::build(&[CORTEX_M4F], request)?;
        Ok(Self {
            image: Image::read(&built[0]["frame-counted"])?,
            expected: baked[0].1,
        })
    }

    /// Instructions and cycles a pixel.
    fn cost(&self, plugin: &Path) -> Result<[f64; 2]> {
        let functions = [Kind::Rows.root()];
        let (report, profiles) = run::run_counted(&CORTEX_M4F, &self.image, &functions, plugin)?;
        self.expected.check(Kind::Rows, &report)?;
        let cycles = cortex_m4::total(&self.image, &profiles[0])?.total();
        let pixels = self.expected.pixels as f64;
        let per_pixel = |sum: u64| (sum as f64 / pixels * 10.0).round() / 10.0;
        Ok([per_pixel(profiles[0].total()), per_pixel(cycles)])
    }
}
