//! Rays a pixel against error, a line a method, a sheet a subject.

use std::path::Path;

use plotters::prelude::*;

use super::{Canvas, FAINT, FONT, FRONT, Failure, OTHER, OURS, number, sheet, style};
use crate::lab::sampling::Sampled;

/// Draws the scenes of a subject side by side.
pub fn draw(lines: &[Sampled], subject: &str, title: &str, path: &Path) -> Result<(), Failure> {
    let lines: Vec<_> = lines.iter().filter(|it| it.subject == subject).collect();
    let mut scenes: Vec<&str> = lines.iter().map(|it| it.scene.as_str()).collect();
    scenes.dedup();
    if scenes.is_empty() {
        return Ok(());
    }
    sheet(path, (620 * scenes.len() as u32, 460), |canvas| {
        let cells = canvas.split_evenly((1, scenes.len()));
        for (cell, scene) in cells.iter().zip(&scenes) {
            let of: Vec<_> = lines
                .iter()
                .filter(|it| it.scene == *scene)
                .copied()
                .collect();
            panel(cell, &format!("{title}: {scene}"), &of)?;
        }
        Ok(())
    })
}

fn panel(canvas: &Canvas<'_>, title: &str, lines: &[&Sampled]) -> Result<(), Failure> {
    let range = |value: fn(&Sampled) -> f64| {
        let values = || lines.iter().map(|it| value(it));
        let least = values().fold(f64::INFINITY, f64::min);
        (least, values().fold(0.0, f64::max))
    };
    let (rays, errors) = (range(|it| it.rays), range(|it| it.error));
    let mut chart = ChartBuilder::on(canvas)
        .caption(title, (FONT, 18))
        .margin(10)
        .x_label_area_size(40)
        .y_label_area_size(56)
        .build_cartesian_2d(
            (rays.0 * 0.8..rays.1 * 1.3).log_scale(),
            (errors.0 * 0.8..errors.1 * 1.3).log_scale(),
        )?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(FAINT.mix(0.5))
        .x_desc("rays a pixel, of all kinds")
        .y_desc("error, steps of 255 (root of the mean square)")
        .axis_desc_style((FONT, 13))
        .label_style((FONT, 12))
        .x_label_formatter(&number)
        .y_label_formatter(&number)
        .draw()?;
    let mut methods: Vec<&str> = Vec::new();
    for line in lines {
        if !methods.contains(&line.method.as_str()) {
            methods.push(&line.method);
        }
    }
    for (place, method) in methods.iter().enumerate() {
        let (color, width) = match *method {
            "regular" => (FRONT, 2),
            it if it.starts_with("adaptive") => (OURS, 2),
            _ => (OTHER, 1),
        };
        let filled = method.ends_with("everywhere") || place % 2 == 0;
        let of = lines.iter().filter(|it| it.method == *method);
        let points: Vec<_> = of.map(|it| (it.rays, it.error)).collect();
        chart.draw_series(LineSeries::new(points.clone(), color.stroke_width(width)))?;
        let inner = if filled { color } else { WHITE };
        for &point in &points {
            let spot = chart.backend_coord(&point);
            let (x, y) = canvas.get_base_pixel();
            let spot = (spot.0 - x, spot.1 - y);
            canvas.draw(&Circle::new(spot, 4, inner.filled()))?;
            canvas.draw(&Circle::new(spot, 4, color.stroke_width(1)))?;
        }
        let row = 320 - 18 * (methods.len() - place) as i32 + 80;
        canvas.draw(&Circle::new((84, row + 7), 4, inner.filled()))?;
        canvas.draw(&Circle::new((84, row + 7), 4, color.stroke_width(1)))?;
        canvas.draw(&Text::new(
            (*method).to_owned(),
            (94, row),
            style(12.5, &color),
        ))?;
    }
    Ok(())
}
