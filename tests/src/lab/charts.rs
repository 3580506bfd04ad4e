//! The lab's pictures.
//!
//! Of each stage, cost against worst error (`price_and_error`) and wrong answers against difficulty
//! (`difficulty`); of the polygons also what leaks through closed meshes (`leaks`); and of whole frames,
//! cost against pixels that are off (`frames`), and rays against error (`sampling`); of shadow rays, bytes
//! against tests (`light_buffer`). Marks and lines carry their names, where there is room for them.

mod difficulty;
mod frames;
mod labels;
mod leaks;
mod light_buffer;
mod price_and_error;
mod sampling;

use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::*;

use super::front::{Results, SUBJECTS};

/// What can go wrong in drawing: files that cannot be written, mostly.
pub type Failure = Box<dyn std::error::Error>;

type Canvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// What `whitted` uses.
const OURS: RGBColor = RGBColor(200, 30, 45);
/// Other methods on the front.
const FRONT: RGBColor = RGBColor(30, 60, 120);
/// Everything else.
const OTHER: RGBColor = RGBColor(110, 110, 110);
/// Rules.
const FAINT: RGBColor = RGBColor(205, 205, 205);

const FONT: &str = "sans-serif";

/// Writes all charts into a folder.
///
/// # Errors
///
/// Where a file cannot be written.
pub fn draw_all(results: &Results, folder: &Path) -> Result<(), Failure> {
    let name = |stage: &str| stage.replace(", ", "-");
    for subject in SUBJECTS {
        let marks = results.marks(subject);
        if marks.is_empty() {
            continue;
        }
        let path = folder.join(format!("{}.svg", name(subject.stage)));
        sheet(&path, (760, 460), |canvas| {
            price_and_error::draw(canvas, subject, &marks, results.source())
        })?;
        difficulty::draw(
            results,
            subject,
            &folder.join(format!("{}-difficulty.svg", name(subject.stage))),
        )?;
    }
    overview(results, &folder.join("overview.svg"))?;
    frames::draw(results, &folder.join("frames.svg"))?;
    let sampled = &results.sampling;
    for (subject, title) in [("pixels", "Anti-aliasing"), ("lights", "Soft shadows")] {
        let path = folder.join(format!("sampling-{subject}.svg"));
        sampling::draw(sampled, subject, title, &path)?;
    }
    light_buffer::draw(&results.buffers, &folder.join("light-buffer.svg"))?;
    leaks::draw(&results.leaks, &folder.join("watertight.svg"))
}

/// Draws a sheet of this size and writes it, all of it or nothing.
fn sheet(
    path: &Path,
    size: (u32, u32),
    draw: impl FnOnce(&Canvas<'_>) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let mut text = String::new();
    let canvas = SVGBackend::with_string(&mut text, size).into_drawing_area();
    canvas.fill(&WHITE)?;
    draw(&canvas)?;
    canvas.present()?;
    drop(canvas);
    Ok(super::save(path, text.as_bytes())?)
}

/// Cost against error of the intersections, on one sheet.
fn overview(results: &Results, path: &Path) -> Result<(), Failure> {
    let stages = [
        "sphere", "plane", "triangle", "polygon", "cuboid", "frustum", "quadric", "torus",
    ];
    let subject = |stage| SUBJECTS.iter().find(|subject| subject.stage == stage);
    let subjects: Vec<_> = stages.into_iter().filter_map(subject).collect();
    let marks: Vec<_> = subjects.iter().map(|it| results.marks(it)).collect();
    if marks.iter().all(Vec::is_empty) {
        return Ok(());
    }
    sheet(path, (1240, 1600), |canvas| {
        let cells = canvas.split_evenly((4, 2));
        for ((cell, subject), marks) in cells.iter().zip(subjects).zip(&marks) {
            if !marks.is_empty() {
                price_and_error::draw(cell, subject, marks, results.source())?;
            }
        }
        Ok(())
    })
}

/// Numbers of a logarithmic axis: plain where short, powers of ten where not.
fn number(x: &f64) -> String {
    if *x == 0.0 || (0.01..10_000.0).contains(&x.abs()) {
        format!("{x}")
    } else {
        format!("{x:.0e}")
    }
}

fn style(size: f64, color: &RGBColor) -> TextStyle<'static> {
    (FONT, size).into_font().color(color)
}
