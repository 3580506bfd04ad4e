//! Bytes against tests a shadow ray, a panel a scene.

use std::path::Path;

use plotters::prelude::*;

use super::{Canvas, FAINT, FONT, FRONT, Failure, OTHER, OURS, number, sheet, style};
use crate::lab::light_buffer::{BITS, Buffered, LISTS, PLAIN, TREE};

/// Draws all scenes.
pub fn draw(lines: &[Buffered], path: &Path) -> Result<(), Failure> {
    let mut scenes: Vec<&[Buffered]> = lines
        .chunk_by(|a, b| (&a.scene, a.spheres) == (&b.scene, b.spheres))
        .collect();
    if scenes.is_empty() {
        return Ok(());
    }
    scenes.truncate(7);
    sheet(path, (1480, 760), |canvas| {
        let cells = canvas.split_evenly((2, 4));
        for (cell, scene) in cells.iter().zip(&scenes) {
            panel(cell, scene)?;
        }
        match cells.get(scenes.len()) {
            Some(cell) => key(cell),
            None => Ok(()),
        }
    })
}

fn color(method: &str) -> RGBColor {
    match method {
        BITS => OURS,
        LISTS => FRONT,
        _ => OTHER,
    }
}

fn panel(canvas: &Canvas<'_>, lines: &[Buffered]) -> Result<(), Failure> {
    let all = |it: &Buffered| it.tests + it.bounds;
    let values = || lines.iter().flat_map(|it| [it.tests, all(it)]);
    let least = values().fold(f64::INFINITY, f64::min);
    let most = values().fold(0.0, f64::max);
    let bytes = lines.iter().map(|it| it.bytes as f64).fold(0.0, f64::max);
    let first = &lines[0];
    let lights = if first.lights == 1 { "light" } else { "lights" };
    let title = format!(
        "{}: {} spheres, {} {lights}",
        first.scene, first.spheres, first.lights
    );
    let x = 20.0..bytes * 1.5;
    let mut chart = ChartBuilder::on(canvas)
        .caption(title, (FONT, 16))
        .margin(8)
        .x_label_area_size(36)
        .y_label_area_size(52)
        .build_cartesian_2d(
            x.clone().log_scale(),
            (least * 0.8..most * 1.25).log_scale().base(2.0),
        )?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(FAINT.mix(0.5))
        .x_labels(6)
        .y_labels(6)
        .x_desc("bytes")
        .y_desc("tests a shadow ray")
        .axis_desc_style((FONT, 12))
        .label_style((FONT, 11))
        .x_label_formatter(&number)
        .y_label_formatter(&number)
        .draw()?;
    for method in [PLAIN, LISTS, BITS, TREE] {
        let of = lines.iter().filter(|it| it.method == method);
        let points: Vec<_> = of.clone().map(|it| (it.bytes as f64, all(it))).collect();
        let color = color(method);
        if method == PLAIN {
            let ends = [(x.start, most), (x.end, most)].map(|(x, _)| (x, points[0].1));
            chart.draw_series(LineSeries::new(ends, color.stroke_width(1)))?;
            continue;
        }
        if method == TREE {
            // Down to its tests of spheres alone.
            let ends = of.map(|it| [(it.bytes as f64, all(it)), (it.bytes as f64, it.tests)]);
            for ends in ends {
                chart.draw_series(LineSeries::new(ends, BLACK.stroke_width(1)))?;
            }
            let mark = |&it: &(f64, f64)| TriangleMarker::new(it, 6, BLACK.filled());
            chart.draw_series(points.iter().map(mark))?;
            continue;
        }
        chart.draw_series(LineSeries::new(points.clone(), color.stroke_width(2)))?;
        let mark = |&it: &(f64, f64)| Circle::new(it, 4, color.filled());
        chart.draw_series(points.iter().map(mark))?;
    }
    Ok(())
}

fn key(canvas: &Canvas<'_>) -> Result<(), Failure> {
    let mut y = 60;
    let mut say = |text: &str, color: &RGBColor| {
        let drawn = canvas.draw(&Text::new(text.to_owned(), (60, y), style(13.0, color)));
        y += 19;
        drawn
    };
    say("What is tested for a shadow ray", &BLACK)?;
    say("", &BLACK)?;
    say("bits: whitted's LightBuffer, 8 to 4,096 cells,", &OURS)?;
    say("each a bit for each of the first 31 spheres", &OURS)?;
    say("", &BLACK)?;
    say("lists by distance on the faces of a cube,", &FRONT)?;
    say("6 to 6,144 cells: Haines and Greenberg 1986", &FRONT)?;
    say("", &BLACK)?;
    say("hierarchy of balls: its balls and spheres,", &BLACK)?;
    say("and, at the end of the line, spheres alone", &BLACK)?;
    say("", &BLACK)?;
    say("gray line: every sphere, until one blocks", &OTHER)?;
    canvas.draw(&TriangleMarker::new(
        (46, 60 + 8 * 19 + 9),
        6,
        BLACK.filled(),
    ))?;
    canvas.draw(&Circle::new((46, 60 + 2 * 19 + 7), 4, OURS.filled()))?;
    canvas.draw(&Circle::new((46, 60 + 5 * 19 + 7), 4, FRONT.filled()))?;
    Ok(())
}
