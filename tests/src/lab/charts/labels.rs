//! Labels beside marks, where there is room.

/// A rectangle in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// Left edge.
    pub x: f64,
    /// Upper edge.
    pub y: f64,
    /// To the right.
    pub width: f64,
    /// Downwards.
    pub height: f64,
}

impl Area {
    fn overlap(&self, other: &Self) -> f64 {
        let span = |a: f64, a_size: f64, b: f64, b_size: f64| {
            ((a + a_size).min(b + b_size) - a.max(b)).max(0.0)
        };
        span(self.x, self.width, other.x, other.width)
            * span(self.y, self.height, other.y, other.height)
    }

    fn outside(&self, of: &Self) -> f64 {
        self.width * self.height - self.overlap(of)
    }
}

/// Places labels so that they cover neither marks nor each other, as far as that can be had.
#[derive(Clone, Debug)]
pub struct Labels {
    bounds: Area,
    font: f64,
    taken: Vec<Area>,
}

impl Labels {
    /// Labels within `bounds`, in a font of this size, that do not cover these points.
    pub fn new(bounds: Area, font: f64, marks: &[(f64, f64)]) -> Self {
        let taken = marks.iter().map(|&(x, y)| Area {
            x: x - 6.0,
            y: y - 6.0,
            width: 12.0,
            height: 12.0,
        });
        Self {
            bounds,
            font,
            taken: taken.collect(),
        }
    }

    /// The upper left corner of the label of a mark, and whether it is so far off that a line has to
    /// lead to it.
    pub fn place(&mut self, (x, y): (f64, f64), text: &str) -> ((f64, f64), bool) {
        let (width, height) = (Self::width(text, self.font), self.font * 1.15);
        let mut best: Option<(f64, Area, bool)> = None;
        for ring in 0..7 {
            let away = 9.0 + f64::from(ring) * self.font * 0.8;
            for (right, down) in [
                (1, 0),
                (-1, 0),
                (1, -1),
                (1, 1),
                (-1, -1),
                (-1, 1),
                (0, -1),
                (0, 1),
            ] {
                let area = Area {
                    x: match right {
                        1 => x + away,
                        -1 => x - away - width,
                        _ => x - width / 2.0,
                    },
                    y: match down {
                        1 => y + away * 0.7,
                        -1 => y - away * 0.7 - height,
                        _ => y - height / 2.0,
                    },
                    width,
                    height,
                };
                let covered: f64 = self.taken.iter().map(|other| area.overlap(other)).sum();
                let cost = covered + 4.0 * area.outside(&self.bounds) + away;
                if best.is_none_or(|(least, _, _)| cost < least) {
                    best = Some((cost, area, ring > 1));
                }
            }
        }
        let (_, area, far) = best.expect("some place was tried");
        self.taken.push(area);
        ((area.x, area.y), far)
    }

    /// About how wide a text is.
    pub fn width(text: &str, font: f64) -> f64 {
        text.chars().count() as f64 * font * 0.55
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_of_close_marks_do_not_overlap() {
        let bounds = Area {
            x: 0.0,
            y: 0.0,
            width: 400.0,
            height: 300.0,
        };
        let marks = [
            (200.0, 150.0),
            (204.0, 152.0),
            (198.0, 149.0),
            (390.0, 150.0),
        ];
        let mut labels = Labels::new(bounds, 12.0, &marks);
        for mark in marks {
            labels.place(mark, "a method");
        }
        let boxes = &labels.taken[4..];
        for (i, one) in boxes.iter().enumerate() {
            assert!(one.outside(&bounds) < 1e-9, "{one:?}");
            for other in &boxes[i + 1..] {
                assert_eq!(one.overlap(other), 0.0, "{one:?} {other:?}");
            }
        }
    }
}
