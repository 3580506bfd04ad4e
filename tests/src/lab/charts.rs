//! The lab's pictures.
//!
//! Of each stage, cost against worst error (`price_and_error`) and wrong answers against difficulty
//! (`difficulty`); of the polygons also what leaks through closed meshes (`leaks`). Marks and lines
//! carry their names: there are no legends to look up.

mod difficulty;
mod labels;
mod leaks;
mod price_and_error;

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
        let canvas = SVGBackend::new(&path, (760, 460)).into_drawing_area();
        canvas.fill(&WHITE)?;
        price_and_error::draw(&canvas, subject, &marks)?;
        canvas.present()?;
        difficulty::draw(
            results,
            subject,
            &folder.join(format!("{}-difficulty.svg", name(subject.stage))),
        )?;
    }
    overview(results, &folder.join("overview.svg"))?;
    leaks::draw(&results.leaks, &folder.join("watertight.svg"))
}

/// Cost against error of the intersections, on one sheet.
fn overview(results: &Results, path: &Path) -> Result<(), Failure> {
    let stages = [
        "sphere", "plane", "triangle", "polygon", "cuboid", "frustum",
    ];
    let canvas = SVGBackend::new(path, (1240, 1200)).into_drawing_area();
    canvas.fill(&WHITE)?;
    let cells = canvas.split_evenly((3, 2));
    for (cell, stage) in cells.iter().zip(stages) {
        let Some(subject) = SUBJECTS.iter().find(|subject| subject.stage == stage) else {
            continue;
        };
        let marks = results.marks(subject);
        if !marks.is_empty() {
            price_and_error::draw(cell, subject, &marks)?;
        }
    }
    Ok(canvas.present()?)
}

/// Numbers of a logarithmic axis: plain where short, powers of ten where not.
fn number(x: &f64) -> String {
    if (0.01..10_000.0).contains(x) {
        format!("{x}")
    } else {
        format!("{x:.0e}")
    }
}

fn style(size: f64, color: &RGBColor) -> TextStyle<'static> {
    (FONT, size).into_font().color(color)
}
