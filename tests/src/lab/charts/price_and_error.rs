//! Cost against worst error: one mark a method, the front as a staircase.

use plotters::prelude::*;

use super::labels::{Area, Labels};
use super::{Canvas, FAINT, FONT, FRONT, Failure, OTHER, OURS, number, style};
use crate::lab::front::{Mark, Measure, Subject};

/// Room for the methods without a price.
const STRIP: i32 = 170;
const LABEL: f64 = 12.5;

/// Draws a subject's chart.
pub fn draw(
    canvas: &Canvas<'_>,
    subject: &Subject,
    marks: &[Mark],
    source: &str,
) -> Result<(), Failure> {
    let priced: Vec<&Mark> = marks.iter().filter(|mark| !mark.costs.is_empty()).collect();
    let unpriced: Vec<&Mark> = marks.iter().filter(|mark| mark.costs.is_empty()).collect();
    let (width, height) = canvas.dim_in_pixel();
    let strip = if unpriced.is_empty() { 0 } else { STRIP };
    let (x, y) = ranges(subject, marks, &priced);

    let misses = marks.iter().any(|mark| mark.costs.len() > 1) && subject.measure != Measure::Steps;
    let what = if misses { "a hit / a miss" } else { "a call" };
    let x_desc = format!("estimated cycles of {what} on a Cortex-M4F, {source}");
    let mut chart = ChartBuilder::on(canvas)
        .caption(subject.title, (FONT, 19))
        .margin(10)
        .margin_right(14 + strip)
        .x_label_area_size(40)
        .y_label_area_size(62)
        .build_cartesian_2d((x.0..x.1).log_scale(), (y.0..y.1).log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(FAINT.mix(0.5))
        .x_desc(x_desc)
        .y_desc(subject.measure.label())
        .axis_desc_style((FONT, 13))
        .label_style((FONT, 12))
        .x_labels(6)
        .x_label_formatter(&number)
        .y_label_formatter(&number)
        .draw()?;

    if let Some((rule, _)) = rule(subject.measure) {
        chart.draw_series(LineSeries::new(
            [(x.0, rule), (x.1, rule)],
            OTHER.mix(0.7).stroke_width(2),
        ))?;
    }
    let front = front(&priced);
    let mut stairs = Vec::new();
    for (i, mark) in front.iter().enumerate() {
        let (cycles, error) = place(mark, y.0);
        stairs.push((
            cycles,
            if i == 0 {
                y.1
            } else {
                place(front[i - 1], y.0).1
            },
        ));
        stairs.push((cycles, error));
        if i + 1 == front.len() {
            stairs.push((x.1, error));
        }
    }
    chart.draw_series(LineSeries::new(stairs, FRONT.mix(0.45).stroke_width(2)))?;

    // Everything else in pixels: labels need to know what is near.
    let (origin_x, origin_y) = canvas.get_base_pixel();
    let pixel = |point: (f64, f64)| {
        let (x, y) = chart.backend_coord(&point);
        (f64::from(x - origin_x), f64::from(y - origin_y))
    };
    let bounds = Area {
        x: 72.0,
        y: 34.0,
        width: f64::from(width) - 90.0 - f64::from(strip),
        height: f64::from(height) - 86.0,
    };
    let spots: Vec<(f64, f64)> = priced.iter().map(|mark| pixel(place(mark, y.0))).collect();
    let mut labels = Labels::new(bounds, LABEL, &spots);
    let is_front = |mark: &Mark| front.iter().any(|one| one.method == mark.method);
    // The ones that matter choose their labels' places first.
    let mut order: Vec<usize> = (0..priced.len()).collect();
    order.sort_by_key(|&i| (priced[i].method != subject.winner, !is_front(priced[i])));
    for i in order {
        let mark = priced[i];
        if let Some(cost) = mark.costs.first().filter(|cost| cost.prepared > cost.call) {
            let end = pixel((cost.prepared.min(x.1), mark.error.clamp(y.0, y.1)));
            line(canvas, spots[i], end, &OTHER)?;
        }
        let text = label(subject, mark);
        let (corner, far) = labels.place(spots[i], &text);
        if far {
            let near = (
                corner
                    .0
                    .max(spots[i].0.min(corner.0 + Labels::width(&text, LABEL))),
                corner.1 + 7.0,
            );
            line(canvas, spots[i], near, &FAINT)?;
        }
        let color = color(subject, mark, is_front(mark));
        dot(canvas, spots[i], mark, &color)?;
        write(canvas, corner, &text, &color)?;
    }
    if let Some((rule, name)) = rule(subject.measure).filter(|(rule, _)| *rule > y.0) {
        let (_, height) = pixel((x.0, rule));
        let at = (
            bounds.x + bounds.width - Labels::width(name, LABEL),
            height - 16.0,
        );
        let taken = labels.place(
            (at.0 + Labels::width(name, LABEL) / 2.0, height - 2.0),
            name,
        );
        write(canvas, taken.0, name, &OTHER)?;
    }
    strip_of(canvas, subject, &unpriced, width, |mark| {
        pixel((x.0, mark.error.clamp(y.0, y.1))).1
    })
}

/// The methods without a price: at the height of their error, beside the chart.
fn strip_of(
    canvas: &Canvas<'_>,
    subject: &Subject,
    unpriced: &[&Mark],
    width: u32,
    height_of: impl Fn(&Mark) -> f64,
) -> Result<(), Failure> {
    if unpriced.is_empty() {
        return Ok(());
    }
    let left = f64::from(width as i32 - STRIP);
    write(canvas, (left, 22.0), "not priced", &OTHER)?;
    let mut sorted: Vec<(f64, &&Mark)> = unpriced
        .iter()
        .map(|mark| (height_of(mark), mark))
        .collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Lines of text from the top, pushed down where they would overlap, then up from the floor.
    let step = LABEL + 2.0;
    let mut lines: Vec<f64> = sorted.iter().map(|(height, _)| *height).collect();
    for i in 1..lines.len() {
        lines[i] = lines[i].max(lines[i - 1] + step);
    }
    let floor = f64::from(canvas.dim_in_pixel().1) - 56.0;
    if let Some(last) = lines.last_mut() {
        *last = last.min(floor);
    }
    for i in (1..lines.len()).rev() {
        lines[i - 1] = lines[i - 1].min(lines[i] - step);
    }
    for ((height, mark), text_height) in sorted.iter().zip(lines) {
        let spot = (left + 6.0, *height);
        line(canvas, spot, (left + 20.0, text_height), &FAINT)?;
        let color = color(subject, mark, false);
        dot(canvas, spot, mark, &color)?;
        write(
            canvas,
            (left + 22.0, text_height - 7.0),
            &label(subject, mark),
            &color,
        )?;
    }
    Ok(())
}

fn ranges(subject: &Subject, marks: &[Mark], priced: &[&Mark]) -> ((f64, f64), (f64, f64)) {
    let costs = || priced.iter().filter_map(|mark| mark.costs.first());
    let least = costs().map(|cost| cost.call).fold(f64::INFINITY, f64::min);
    let most = costs().map(|cost| cost.prepared).fold(0.0, f64::max);
    let x = if least < most {
        ((least * 0.75).max(1.0), most * 1.7)
    } else {
        (10.0, 1000.0)
    };
    let finite = |error: f64| if error.is_finite() { error } else { 1e9 };
    let top = marks
        .iter()
        .map(|mark| finite(mark.error))
        .fold(0.0, f64::max);
    let y = match subject.measure {
        Measure::Backward | Measure::Relative => (0.2, top.clamp(5.0, 1e9) * 4.0),
        Measure::Steps => (1e-6, 255.0),
        Measure::Wrong => (1e-5, 1.5),
    };
    (x, y)
}

/// The line below which nobody sees a difference.
fn rule(measure: Measure) -> Option<(f64, &'static str)> {
    match measure {
        Measure::Backward | Measure::Relative => Some((1.0, "1 u: the inputs' own rounding")),
        Measure::Steps => Some((0.5, "half a step")),
        Measure::Wrong => None,
    }
}

fn place(mark: &Mark, floor: f64) -> (f64, f64) {
    let cycles = mark.costs.first().map_or(f64::NAN, |cost| cost.call);
    // What costs nothing has no place on a logarithmic axis.
    (cycles.max(1.0), mark.error.clamp(floor, 1e9))
}

/// The sound methods than which none is both cheaper and better, by price.
fn front<'a>(priced: &[&'a Mark]) -> Vec<&'a Mark> {
    let mut sorted: Vec<&Mark> = priced.iter().copied().filter(|mark| mark.sound).collect();
    sorted.sort_by(|a, b| {
        place(a, 0.0)
            .partial_cmp(&place(b, 0.0))
            .expect("all have prices")
    });
    let mut best = f64::INFINITY;
    sorted.retain(|mark| {
        let better = mark.error < best;
        best = best.min(mark.error);
        better
    });
    sorted
}

fn label(subject: &Subject, mark: &Mark) -> String {
    let name = if mark.method == subject.winner {
        "whitted"
    } else {
        &mark.method
    };
    let cycles: Vec<String> = mark
        .costs
        .iter()
        .map(|cost| format!("{:.0}", cost.call))
        .collect();
    format!("{name} {}", cycles.join("/"))
}

fn color(subject: &Subject, mark: &Mark, front: bool) -> RGBColor {
    match (mark.method == subject.winner, front) {
        (true, _) => OURS,
        (false, true) => FRONT,
        (false, false) => OTHER,
    }
}

fn pixels((x, y): (f64, f64)) -> (i32, i32) {
    (x.round() as i32, y.round() as i32)
}

fn line(
    canvas: &Canvas<'_>,
    from: (f64, f64),
    to: (f64, f64),
    color: &RGBColor,
) -> Result<(), Failure> {
    Ok(canvas.draw(&PathElement::new(
        [pixels(from), pixels(to)],
        color.stroke_width(1),
    ))?)
}

/// Hollow where the method fails a special input.
fn dot(canvas: &Canvas<'_>, at: (f64, f64), mark: &Mark, color: &RGBColor) -> Result<(), Failure> {
    let inner = if mark.sound { color } else { &WHITE };
    canvas.draw(&Circle::new(pixels(at), 5, inner.filled()))?;
    Ok(canvas.draw(&Circle::new(pixels(at), 5, color.stroke_width(2)))?)
}

fn write(canvas: &Canvas<'_>, at: (f64, f64), text: &str, color: &RGBColor) -> Result<(), Failure> {
    Ok(canvas.draw(&Text::new(
        text.to_string(),
        pixels(at),
        style(LABEL, color),
    ))?)
}
