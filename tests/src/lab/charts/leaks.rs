//! Rays that pass between the faces of closed meshes, or meet two.

use std::path::Path;

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::{FAINT, FONT, FRONT, Failure, OTHER, OURS, number, sheet, style};
use crate::lab::watertight::Leaks;

/// Draws the worst share of holes and of double hits over all meshes, a line a method.
pub fn draw(leaks: &[Leaks], path: &Path) -> Result<(), Failure> {
    let mut methods: Vec<&str> = Vec::new();
    for one in leaks {
        if !methods.contains(&one.method.as_str()) {
            methods.push(&one.method);
        }
    }
    if methods.is_empty() {
        return Ok(());
    }
    let worst = |method: &str, count: fn(&Leaks) -> u64| {
        let of = leaks.iter().filter(|one| one.method == method);
        of.map(|one| count(one) as f64 / one.rays as f64)
            .fold(0.0, f64::max)
    };
    let holes = |method: &str| worst(method, |one| one.holes);
    let doubles = |method: &str| worst(method, |one| one.doubles);
    methods.sort_by(|a, b| (holes(a) + doubles(a)).total_cmp(&(holes(b) + doubles(b))));
    let rays = |method: &str| {
        let of = leaks.iter().filter(|one| one.method == method);
        of.map(|one| one.rays).max().unwrap_or(1)
    };
    let most = methods.iter().map(|method| rays(method)).max().unwrap_or(1) as f64;
    let height = 120 + 26 * methods.len() as u32;
    sheet(path, (760, height), |canvas| {
        let title = "Polygons: rays at shared edges and corners of six closed meshes";
        let mut chart = ChartBuilder::on(canvas)
            .caption(title, (FONT, 18))
            .margin(10)
            .margin_right(24)
            .x_label_area_size(42)
            .y_label_area_size(170)
            .build_cartesian_2d(
                (0.1 / most..2.0).log_scale(),
                methods.len() as f64 - 0.4..-0.6,
            )?;
        chart
            .configure_mesh()
            .disable_y_mesh()
            .disable_y_axis()
            .light_line_style(TRANSPARENT)
            .bold_line_style(FAINT.mix(0.6))
            .x_desc("worst share of rays: holes (filled), double hits (hollow)")
            .x_label_formatter(&number)
            .axis_desc_style((FONT, 13))
            .label_style((FONT, 12))
            .draw()?;
        for (i, method) in methods.iter().enumerate() {
            let ours = *method == "core";
            let color = if ours { OURS } else { FRONT };
            let y = i as f64;
            // None of so many: drawn where less than one would be.
            let floor = 0.3 / rays(method) as f64;
            let (holes, doubles) = (holes(method).max(floor), doubles(method).max(floor));
            chart.draw_series(LineSeries::new([(holes, y), (doubles, y)], OTHER.mix(0.4)))?;
            chart.draw_series([
                Circle::new((doubles, y), 6, WHITE.filled()),
                Circle::new((doubles, y), 6, color.stroke_width(2)),
                Circle::new((holes, y), 4, color.filled()),
            ])?;
            let (x, height) = chart.backend_coord(&(holes, y));
            let name = if ours { "whitted" } else { method };
            let right = style(13.0, &color).pos(Pos::new(HPos::Right, VPos::Center));
            canvas.draw(&Text::new(name.to_string(), (170, height), right))?;
            if doubles <= floor {
                let note = style(12.0, &color).pos(Pos::new(HPos::Left, VPos::Center));
                canvas.draw(&Text::new(
                    format!("0 of {}, 0 of {}", rays(method), rays(method)),
                    (x + 12, height),
                    note,
                ))?;
            }
        }
        Ok(())
    })
}
