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
    let (left, top) = canvas.get_base_pixel();
    for (place, method) in methods.iter().enumerate() {
        let look = Look::of(method);
        let of = || lines.iter().filter(|it| it.method == *method);
        let points = of().map(|it| (it.rays, it.error));
        chart.draw_series(LineSeries::new(points, look.color.stroke_width(look.width)))?;
        for line in of() {
            let (x, y) = chart.backend_coord(&(line.rays, line.error));
            let (x, y) = (x - left, y - top);
            look.mark(canvas, (x, y))?;
            // Regular and adaptive ones are to be compared.
            if !look.says {
                continue;
            }
            let text = &line.setting;
            let corner = (x - 6 - 5 * text.chars().count() as i32, y + 3);
            canvas.draw(&Text::new(text.clone(), corner, style(10.5, &look.color)))?;
        }
        let row = 400 - 18 * (methods.len() - place) as i32;
        look.mark(canvas, (84, row + 7))?;
        canvas.draw(&Text::new(
            (*method).to_owned(),
            (94, row),
            style(12.5, &look.color),
        ))?;
    }
    Ok(())
}

/// How a method is drawn.
struct Look {
    color: RGBColor,
    width: u32,
    is_round: bool,
    is_filled: bool,
    /// Whether its settings are written.
    says: bool,
}

impl Look {
    fn of(method: &str) -> Self {
        let (color, width, is_round, is_filled, says) = match method {
            "regular" => (FRONT, 3, true, true, true),
            "jittered everywhere" => (OTHER, 1, false, true, false),
            "jittered once" => (OTHER, 1, false, false, false),
            "adaptive, 4 × 4" | "adaptive, from 4 × 4" => (OURS, 3, true, true, true),
            _ => (OURS, 1, true, false, false),
        };
        Self {
            color,
            width,
            is_round,
            is_filled,
            says,
        }
    }

    fn mark(&self, canvas: &Canvas<'_>, (x, y): (i32, i32)) -> Result<(), Failure> {
        let inner = if self.is_filled { self.color } else { WHITE };
        for style in [inner.filled(), self.color.stroke_width(1)] {
            if self.is_round {
                canvas.draw(&Circle::new((x, y), 4, style))?;
            } else {
                canvas.draw(&Rectangle::new([(x - 4, y - 4), (x + 4, y + 4)], style))?;
            }
        }
        Ok(())
    }
}
