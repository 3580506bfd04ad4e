//! Share of wrong answers against difficulty, one line a method, a panel a sweep.

use std::path::Path;

use plotters::prelude::*;

use super::{Canvas, FAINT, FONT, Failure, OTHER, OURS, number, sheet, style};
use crate::lab::front::{Results, Subject};
use crate::lab::tally::Row;

const PANEL: (u32, u32) = (600, 330);
const FONT_SIZE: f64 = 12.0;
/// At most this many panels: the sweeps that tell most.
const PANELS: usize = 6;

/// Draws the sweeps of a stage in which some method is wrong; nothing if there is none.
pub fn draw(results: &Results, subject: &Subject, path: &Path) -> Result<(), Failure> {
    let rows: Vec<&Row> = results
        .rows
        .iter()
        .filter(|row| row.stage == subject.stage)
        .collect();
    let mut sweeps: Vec<(&str, u64)> = Vec::new();
    for row in &rows {
        // What is further than 1 u from the silhouette is the method's own fault.
        let fault = row.beyond + row.wrong.min(1);
        match sweeps.iter_mut().find(|(name, _)| *name == row.sweep) {
            Some((_, worst)) => *worst = (*worst).max(fault),
            None => sweeps.push((&row.sweep, fault)),
        }
    }
    sweeps.retain(|&(name, fault)| fault > 0 && !name.ends_with("extreme"));
    let mut faults: Vec<u64> = sweeps.iter().map(|&(_, fault)| fault).collect();
    faults.sort_unstable_by(|a, b| b.cmp(a));
    if let Some(&least) = faults.get(PANELS - 1) {
        sweeps.retain(|&(_, fault)| fault >= least);
        sweeps.truncate(PANELS);
    }
    if sweeps.is_empty() {
        return Ok(());
    }
    let rows_of_panels = sweeps.len().div_ceil(2);
    let size = (2 * PANEL.0, PANEL.1 * rows_of_panels as u32 + 30);
    sheet(path, size, |canvas| {
        let title = format!(
            "{}: share of wrong answers against difficulty",
            subject.title
        );
        let (heading, body) = canvas.split_vertically(30);
        heading.draw(&Text::new(title, (14, 8), style(18.0, &BLACK)))?;
        for (panel, (sweep, _)) in body.split_evenly((rows_of_panels, 2)).iter().zip(&sweeps) {
            let rows: Vec<&Row> = rows
                .iter()
                .copied()
                .filter(|row| row.sweep == *sweep)
                .collect();
            draw_panel(panel, subject, sweep, &rows)?;
        }
        Ok(())
    })
}

/// One method's shares, in the order of the cells.
struct Line {
    names: Vec<String>,
    shares: Vec<f64>,
}

fn draw_panel(
    panel: &Canvas<'_>,
    subject: &Subject,
    sweep: &str,
    rows: &[&Row],
) -> Result<(), Failure> {
    let n = rows.first().map_or(1, |row| row.n) as f64;
    let floor = 0.3 / n;
    let mut x: Vec<f64> = rows.iter().map(|row| row.x).collect();
    x.dedup();
    x.sort_by(f64::total_cmp);
    x.dedup();
    let axis = results_axis(rows);
    // From easy to hard: small gaps and angles are harder.
    let falls = axis.falls;
    if falls {
        x.reverse();
    }
    let cells = x.len();
    let mut lines: Vec<Line> = Vec::new();
    let mut methods: Vec<&str> = rows.iter().map(|row| row.method.as_str()).collect();
    methods.dedup();
    let mut seen = Vec::new();
    for method in methods {
        if seen.contains(&method) {
            continue;
        }
        seen.push(method);
        let share = |x: &f64| {
            let row = rows.iter().find(|row| row.method == method && row.x == *x);
            row.map_or(floor, |row| (row.wrong as f64 / row.n as f64).max(floor))
        };
        let shares: Vec<f64> = x.iter().map(share).collect();
        let name = if method == subject.winner {
            "whitted".to_string()
        } else {
            method.to_string()
        };
        let alike = |line: &&mut Line| {
            let mut pairs = line.shares.iter().zip(&shares);
            pairs.all(|(a, b)| a.max(*b) / a.min(*b) < 1.6 || a.max(*b) < 4.0 / n)
        };
        match lines.iter_mut().find(alike) {
            Some(line) => line.names.push(name),
            None => lines.push(Line {
                names: vec![name],
                shares,
            }),
        }
    }
    let mut chart = ChartBuilder::on(panel)
        .caption(sweep, (FONT, 15))
        .margin(8)
        .margin_right(190)
        .x_label_area_size(36)
        .y_label_area_size(58)
        .build_cartesian_2d(-0.3..cells as f64 - 0.7, (floor * 0.6..1.5).log_scale())?;
    let tick = |at: &f64| {
        let index = at.round();
        let is_cell = (at - index).abs() < 0.01 && index >= 0.0;
        x.get(index as usize)
            .filter(|_| is_cell)
            .map_or(String::new(), number)
    };
    let share = |share: &f64| {
        if *share < 0.99 / n {
            String::new()
        } else {
            number(share)
        }
    };
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(FAINT.mix(0.5))
        .x_labels(cells * 2)
        .x_label_formatter(&tick)
        .y_label_formatter(&share)
        .x_desc(axis.label)
        .axis_desc_style((FONT, 12))
        .label_style((FONT, 11))
        .draw()?;
    // "0 of N" is a result, not an absence.
    chart.draw_series(LineSeries::new(
        [(-0.3, floor), (cells as f64 - 0.7, floor)],
        OTHER.mix(0.5).stroke_width(1),
    ))?;
    let (base_x, base_y) = panel.get_base_pixel();
    let mut ends = Vec::new();
    for line in &lines {
        let ours = line.names.iter().any(|name| name == "whitted");
        let color = if ours { OURS } else { OTHER };
        let points = line
            .shares
            .iter()
            .enumerate()
            .map(|(i, &share)| (i as f64, share));
        let width = if ours { 3 } else { 1 };
        chart.draw_series(LineSeries::new(points, color.stroke_width(width)))?;
        let last = (cells as f64 - 1.0, *line.shares.last().unwrap_or(&floor));
        let (x, y) = chart.backend_coord(&last);
        ends.push((
            f64::from(y - base_y),
            f64::from(x - base_x),
            name(line),
            color,
        ));
    }
    let (x0, y0) = chart.backend_coord(&(-0.3, floor));
    let note = format!("0 of {n}");
    panel.draw(&Text::new(
        note,
        (x0 - base_x + 4, y0 - base_y - 14),
        style(11.0, &OTHER),
    ))?;
    // Names at the lines' ends, one below the other.
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut heights: Vec<f64> = ends.iter().map(|end| end.0).collect();
    let step = FONT_SIZE + 1.5;
    for i in 1..heights.len() {
        heights[i] = heights[i].max(heights[i - 1] + step);
    }
    let bottom = f64::from(panel.dim_in_pixel().1) - 30.0;
    if let Some(last) = heights.last_mut() {
        *last = last.min(bottom);
    }
    for i in (1..heights.len()).rev() {
        heights[i - 1] = heights[i - 1].min(heights[i] - step);
    }
    for ((end, x, name, color), height) in ends.iter().zip(heights) {
        let from = (*x as i32 + 3, *end as i32);
        let to = (*x as i32 + 22, height as i32);
        panel.draw(&PathElement::new(
            [from, to],
            color.mix(0.4).stroke_width(1),
        ))?;
        let at = (to.0 + 3, to.1 - 7);
        panel.draw(&Text::new(name.clone(), at, style(FONT_SIZE, color)))?;
    }
    Ok(())
}

struct Axis {
    label: String,
    falls: bool,
}

/// What a sweep's numbers mean, and whether they fall as it gets harder.
fn results_axis(rows: &[&Row]) -> Axis {
    let label = rows.first().map_or(String::new(), |row| row.axis.clone());
    let xs = || rows.iter().map(|row| row.x);
    let (least, most) = (xs().fold(f64::INFINITY, f64::min), xs().fold(0.0, f64::max));
    // Cells are written from easy to hard.
    let falls = rows
        .first()
        .is_some_and(|row| row.x == most && most > least);
    Axis { label, falls }
}

fn name(line: &Line) -> String {
    let mut names: Vec<&str> = line.names.iter().map(String::as_str).collect();
    names.sort_by_key(|name| *name != "whitted");
    match names.as_slice() {
        [one] => (*one).to_string(),
        [one, other] => format!("{one}; {other}"),
        [one, other, rest @ ..] => format!("{one}; {other}; {} more", rest.len()),
        [] => String::new(),
    }
}
