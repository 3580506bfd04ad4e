//! The sweeps of walks over grids.

use whitted::{Grid, Vec3};
use whitted_methods::grid::{Course, METHODS};

use super::random::Random;
use super::sweep::{Stage, Sweep};
use crate::exact::{Line, Verdict, grid};

/// Walks over grids, to the end of the map. A walk is wrong where it takes any two borders in the wrong
/// order.
pub struct Grids;

/// A walk from one point of a square map through another.
fn course(size: f64, from: [f64; 2], to: [f64; 2]) -> Course {
    let origin = Vec3::new(from[0] as f32, 0.0, from[1] as f32);
    let way = [0, 1].map(|i| to[i] - f64::from([origin.x, origin.z][i]));
    let length = way[0].hypot(way[1]);
    let direction = way.map(|it| (it / length) as f32);
    Course {
        grid: Grid {
            width: size as u16,
            depth: size as u16,
            cells: &[],
        },
        origin,
        direction: Vec3::new(direction[0], 0.0, direction[1]),
        steps: u32::MAX,
    }
}

fn point(random: &mut Random, size: f64) -> [f64; 2] {
    [random.between(0.0, size), random.between(0.0, size)].map(|it| it.min(size - 0.001))
}

impl Stage for Grids {
    const NAME: &'static str = "grid";
    type Case = Course;

    fn sweeps() -> Vec<Sweep<Course>> {
        let sizes = [16.0, 64.0, 256.0, 1024.0, 4096.0];
        let axis = "cells along a side of the map";
        vec![
            Sweep::new("anywhere", axis, &sizes, |size, random| {
                course(size, point(random, size), point(random, size))
            }),
            Sweep::new("corners", axis, &sizes[..4], |size, random| {
                let corner = point(random, size).map(f64::round);
                course(size, point(random, size), corner)
            }),
            // All that is subtracted and divided has few digits: exactly through corners.
            Sweep::new("exact corners", axis, &sizes[..4], |size, random| {
                let start = point(random, size).map(|it| (it * 4.0).floor() / 4.0);
                let mut part = || (1 + random.below(8)) as f64 * [0.25, -0.25][random.below(2)];
                let way = [part(), part()];
                let mut course = course(size, start, start);
                course.direction = Vec3::new(way[0] as f32, 0.0, way[1] as f32);
                course
            }),
            Sweep::new(
                "nearly along an axis",
                "log2 of the slope",
                &[-4.0, -8.0, -12.0, -16.0, -20.0, -24.0, -40.0],
                |slope, random| {
                    let start = point(random, 1024.0);
                    let border = start.map(f64::round);
                    let start = [[start[0], border[1]], [border[0], start[1]]][random.below(2)];
                    let slope = slope.exp2() * random.signed();
                    let way = [[1.0, slope], [slope, -1.0]][random.below(2)];
                    course(1024.0, start, [start[0] + way[0], start[1] + way[1]])
                },
            ),
        ]
    }

    fn methods() -> Vec<&'static str> {
        METHODS.iter().map(|method| method.name).collect()
    }

    fn ask(course: &Course, judged: &mut dyn FnMut(usize, Verdict)) {
        let ray = Line {
            origin: course.origin.to_array(),
            direction: course.direction.to_array(),
        };
        let forwards = [ray.direction[0] > 0.0, ray.direction[2] > 0.0];
        let start = grid::cell(ray.origin);
        for (i, method) in METHODS.iter().enumerate() {
            let mut verdict = Verdict {
                backward: 0.0,
                forward: 0.0,
                wrong: None,
            };
            let mut borders = grid::borders_ahead(&ray, start);
            let (_, tell) = method.run;
            tell(course, &mut |t, is_x| {
                if grid::is_x_first(&ray, borders) != is_x {
                    let band = grid::band(&ray, borders);
                    verdict.wrong = Some(verdict.wrong.unwrap_or(0.0).max(band));
                }
                let axis = usize::from(!is_x);
                let residual = grid::residual(&ray, 2 * axis, borders[axis], t);
                verdict.backward = verdict.backward.max(residual);
                borders[axis] += if forwards[axis] { 1.0 } else { -1.0 };
            });
            judged(i, verdict);
        }
    }
}
