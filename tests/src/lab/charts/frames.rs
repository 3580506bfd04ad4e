//! Whole frames: cycles a pixel against the share of pixels that are off, by policy, depth and
//! threshold.

use std::path::Path;

use plotters::prelude::*;

use super::labels::{Area, Labels};
use super::{FAINT, FONT, FRONT, Failure, OTHER, OURS, number, sheet, style};
use crate::lab::frames::Frame;
use crate::lab::front::Results;

const LABEL: f64 = 12.5;

/// A setting's place.
struct Mark<'a> {
    frame: &'a Frame,
    cycles: f64,
    share: f64,
}

/// Draws all settings whose price is known: those of one depth after the other without a threshold, and
/// of one threshold after the other at full depth, as two lines a policy; all others as dots.
pub fn draw(results: &Results, path: &Path) -> Result<(), Failure> {
    let Some(pixels) = results.frames.first().map(|frame| frame.pixels) else {
        return Ok(());
    };
    let floor = 0.3 / pixels as f64;
    let mark = |frame| {
        let mut prices = results.frame_prices.iter();
        let price = prices.find(|price| price.is_of(frame))?;
        let share = (frame.differing as f64 / pixels as f64).max(floor);
        let cycles = price.cycles;
        Some(Mark {
            frame,
            cycles,
            share,
        })
    };
    let marks: Vec<Mark<'_>> = results.frames.iter().filter_map(mark).collect();
    let cycles = || marks.iter().map(|mark| mark.cycles);
    let (least, most) = (
        cycles().fold(f64::INFINITY, f64::min),
        cycles().fold(0.0, f64::max),
    );
    let Some(deepest) = marks.iter().map(|mark| mark.frame.bounces).max() else {
        return Ok(());
    };
    let x = (least * 0.93, most * 1.04);
    let (width, height) = (900, 560);
    sheet(path, (width, height), |canvas| {
        let title = "Whole frames: the standard sphere scene, by policy, bounces and threshold";
        let mut chart = ChartBuilder::on(canvas)
            .caption(title, (FONT, 19))
            .margin(10)
            .margin_right(20)
            .x_label_area_size(40)
            .y_label_area_size(62)
            .build_cartesian_2d(x.0..x.1, (floor * 0.5..1.5).log_scale())?;
        let share = |share: &f64| match *share < 0.99 / pixels as f64 {
            true => String::new(),
            false => number(share),
        };
        let x_desc = format!(
            "estimated cycles a pixel on a Cortex-M4F, {}",
            results.source()
        );
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(FAINT.mix(0.5))
            .x_desc(x_desc)
            .y_desc("share of pixels off by more than a step of 255 from the f64 tracer")
            .axis_desc_style((FONT, 13))
            .label_style((FONT, 12))
            .x_label_formatter(&|x| format!("{x:.0}"))
            .y_label_formatter(&share)
            .draw()?;
        let rule = [(x.0, floor), (x.1, floor)];
        chart.draw_series(LineSeries::new(rule, OTHER.mix(0.5).stroke_width(1)))?;
        chart.draw_series(LineSeries::new(
            stairs(&marks, x.1),
            OTHER.mix(0.4).stroke_width(2),
        ))?;
        let dots = marks
            .iter()
            .map(|mark| Circle::new((mark.cycles, mark.share), 2, FAINT.filled()));
        chart.draw_series(dots)?;

        let mut labelled = Vec::new();
        for (policy, color) in [("Exact", OURS), ("Micro", FRONT)] {
            let of = || marks.iter().filter(|mark| mark.frame.policy == policy);
            let by_depth: Vec<_> = of().filter(|mark| mark.frame.threshold == 0.0).collect();
            let by_threshold: Vec<_> = of().filter(|it| it.frame.bounces == deepest).collect();
            for (line, width) in [(&by_depth, 3), (&by_threshold, 1)] {
                let points = line.iter().map(|mark| (mark.cycles, mark.share));
                chart.draw_series(LineSeries::new(points, color.stroke_width(width)))?;
            }
            labelled.extend(by_depth.iter().map(|mark| {
                let bounces = mark.frame.bounces;
                let text = match bounces {
                    0 => format!("{policy}, no bounces"),
                    1 => "1 bounce".to_owned(),
                    _ if bounces == deepest => format!("{policy}, {bounces} bounces"),
                    _ => bounces.to_string(),
                };
                (*mark, text, color, true)
            }));
            labelled.extend(by_threshold[1..].iter().map(|mark| {
                // Where nothing is gained, there is nothing to name.
                let text = match policy {
                    "Exact" => format!("1/{:.0}", 1.0 / mark.frame.threshold),
                    _ => String::new(),
                };
                (*mark, text, color, false)
            }));
        }
        let pixel = |mark: &Mark<'_>| {
            let (x, y) = chart.backend_coord(&(mark.cycles, mark.share));
            (f64::from(x), f64::from(y))
        };
        let spots: Vec<_> = labelled.iter().map(|(mark, ..)| pixel(mark)).collect();
        let bounds = Area {
            x: 74.0,
            y: 36.0,
            width: f64::from(width) - 96.0,
            height: f64::from(height) - 90.0,
        };
        let mut labels = Labels::new(bounds, LABEL, &spots);
        for ((_, text, color, filled), spot) in labelled.iter().zip(&spots) {
            let round = |(x, y): (f64, f64)| (x.round() as i32, y.round() as i32);
            let inner = if *filled { *color } else { WHITE };
            canvas.draw(&Circle::new(round(*spot), 4, inner.filled()))?;
            canvas.draw(&Circle::new(round(*spot), 4, color.stroke_width(2)))?;
            let (corner, far) = labels.place(*spot, text);
            if far {
                let end = (corner.0, corner.1 + 7.0);
                canvas.draw(&PathElement::new(
                    [round(*spot), round(end)],
                    FAINT.stroke_width(1),
                ))?;
            }
            canvas.draw(&Text::new(text.clone(), round(corner), style(LABEL, color)))?;
        }
        for (line, filled, text) in [
            (0, true, "so many bounces, all light in them".to_owned()),
            (
                1,
                false,
                format!("{deepest} bounces, of the light what weighs more than this in its pixel"),
            ),
        ] {
            let (x, y) = (92, height as i32 - 150 + 20 * line);
            let inner = if filled { OTHER } else { WHITE };
            canvas.draw(&Circle::new((x, y), 4, inner.filled()))?;
            canvas.draw(&Circle::new((x, y), 4, OTHER.stroke_width(2)))?;
            canvas.draw(&Text::new(text, (x + 10, y - 7), style(LABEL, &OTHER)))?;
        }
        let (left, bottom) = chart.backend_coord(&(x.0, floor));
        canvas.draw(&Text::new(
            format!("0 of {pixels} pixels"),
            (left + 6, bottom + 4),
            style(12.0, &OTHER),
        ))?;
        Ok(())
    })
}

/// The front: none is both cheaper and nearer to the truth.
fn stairs(marks: &[Mark<'_>], right: f64) -> Vec<(f64, f64)> {
    let mut sorted: Vec<_> = marks.iter().map(|mark| (mark.cycles, mark.share)).collect();
    sorted.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    let mut best = 1.5;
    let mut stairs = Vec::new();
    for (cycles, share) in sorted {
        if share < best {
            stairs.extend([(cycles, best), (cycles, share)]);
            best = share;
        }
    }
    stairs.push((right, best));
    stairs
}
