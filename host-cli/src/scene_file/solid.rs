//! Groups, their instances, and solids that are joined of others.

use super::error::{Located, excerpt};
use super::{Object, Place, Problem, Quadric, Shape, limits};

/// Objects in a space of their own.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Where in the file.
    pub place: Place,
    /// The file's name for it.
    pub name: String,
    /// In file order.
    pub objects: Vec<Object>,
    /// In file order.
    pub solids: Vec<Solid>,
}

/// A group that is placed in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// Where in the file.
    pub place: Place,
    /// Index into [`SceneFile::groups`](super::SceneFile::groups).
    pub group: usize,
    /// To what the group's axes become.
    pub axes: [[f64; 3]; 3],
    /// To where its origin goes.
    pub translation: [f64; 3],
}

/// A solid that is joined of closed shapes.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// Where in the file.
    pub place: Place,
    /// In the order of the expression, each as often as it is named there.
    pub leaves: Vec<Object>,
    /// What is done to them; operands first.
    pub steps: Vec<Step>,
}

/// A step of an expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// The next leaf.
    Leaf,
    /// The two last, in one.
    Union,
    /// What is in both of the two last.
    Intersection,
    /// The last but one without the last.
    Difference,
}

/// The map that does first what is `inner`, then what is `outer`.
pub(super) fn compose(
    (outer_axes, outer_translation): ([[f64; 3]; 3], [f64; 3]),
    (inner_axes, inner_translation): ([[f64; 3]; 3], [f64; 3]),
) -> ([[f64; 3]; 3], [f64; 3]) {
    let turned = |v: [f64; 3]| -> [f64; 3] {
        std::array::from_fn(|i| (0..3).map(|axis| outer_axes[axis][i] * v[axis]).sum())
    };
    let moved = turned(inner_translation);
    (
        inner_axes.map(turned),
        std::array::from_fn(|i| moved[i] + outer_translation[i]),
    )
}

/// The axes after turns by some degrees round x, then y, then z, by the right hand.
pub(super) fn rotation(degrees: [f64; 3]) -> [[f64; 3]; 3] {
    let mut axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for (axis, degrees) in degrees.into_iter().enumerate() {
        let (sin, cos) = sin_cos(degrees);
        let (y, z) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut turn = [[0.0; 3]; 3];
        turn[axis][axis] = 1.0;
        (turn[y][y], turn[y][z]) = (cos, sin);
        (turn[z][y], turn[z][z]) = (-sin, cos);
        axes = compose((turn, [0.0; 3]), (axes, [0.0; 3])).0;
    }
    axes
}

/// Of multiples of a right angle exactly.
fn sin_cos(degrees: f64) -> (f64, f64) {
    let turn = degrees.rem_euclid(360.0);
    let quarter = (turn / 90.0).floor();
    let (sin, cos) = match (turn - 90.0 * quarter).to_radians() {
        0.0 => (0.0, 1.0),
        rest => (libm::sin(rest), libm::cos(rest)),
    };
    match quarter as u8 {
        1 => (cos, -sin),
        2 => (-sin, -cos),
        3 => (-cos, sin),
        _ => (sin, cos),
    }
}

/// Why a shape is no leaf of a solid, if it is none.
pub(super) fn lacks_inside(shape: &Shape) -> Option<Problem> {
    let reason = match shape {
        &Shape::Sphere { radius, .. } if radius <= 0.0 => "the radius of a solid sphere is above 0",
        Shape::Frustum { .. } => "a solid must be closed: add `closed = true`",
        Shape::Quadric {
            form: Quadric::Ellipsoid { .. },
            ..
        } => return None,
        Shape::Quadric { closed: false, .. } => "a solid must be closed: add `closed = true`",
        _ => return None,
    };
    Some(Problem::NoInside(reason))
}

/// Reads an expression: names joined by `+` and `-`, and by `&`, which binds tighter, and parentheses.
/// Gives the steps and the names, in order.
pub(super) fn expression(text: &str, place: Place) -> Result<(Vec<Step>, Vec<&str>), Located> {
    let mut reader = Reader {
        rest: text,
        place,
        steps: Vec::new(),
        names: Vec::new(),
        depth: 0,
    };
    reader.sum()?;
    match reader.next() {
        None => Ok((reader.steps, reader.names)),
        Some(found) => Err(reader.unexpected("an operator, `+`, `-` or `&`, or the end", found)),
    }
}

struct Reader<'a> {
    rest: &'a str,
    place: Place,
    steps: Vec<Step>,
    names: Vec<&'a str>,
    depth: usize,
}

impl<'a> Reader<'a> {
    /// The next word, without taking it.
    fn next(&self) -> Option<&'a str> {
        let rest = self.rest.trim_start();
        let first = rest.chars().next()?;
        let end = match is_of_name(first) {
            true => rest.find(|it| !is_of_name(it)).unwrap_or(rest.len()),
            false => first.len_utf8(),
        };
        Some(&rest[..end])
    }

    fn take(&mut self, word: &str) {
        self.rest = &self.rest.trim_start()[word.len()..];
    }

    fn unexpected(&self, expected: &str, found: &str) -> Located {
        let (expected, found) = (expected.to_owned(), excerpt(found.as_bytes()));
        (self.place, Problem::Unexpected { expected, found })
    }

    fn ended(&self, expected: &str) -> Located {
        (
            self.place,
            Problem::Unexpected {
                expected: expected.to_owned(),
                found: "the end of the expression".to_owned(),
            },
        )
    }

    fn sum(&mut self) -> Result<(), Located> {
        self.product()?;
        while let Some(word @ ("+" | "-")) = self.next() {
            self.take(word);
            self.product()?;
            self.steps.push(match word {
                "+" => Step::Union,
                _ => Step::Difference,
            });
        }
        Ok(())
    }

    fn product(&mut self) -> Result<(), Located> {
        self.operand()?;
        while let Some(word @ "&") = self.next() {
            self.take(word);
            self.operand()?;
            self.steps.push(Step::Intersection);
        }
        Ok(())
    }

    fn operand(&mut self) -> Result<(), Located> {
        const OPERAND: &str = "the name of a solid or `(`";
        let Some(word) = self.next() else {
            return Err(self.ended(OPERAND));
        };
        if word == "(" {
            // Each is around at least a leaf, unless parentheses are doubled.
            self.depth += 1;
            if self.depth > 2 * limits::LEAVES {
                let (what, limit) = ("parentheses in each other", 2 * limits::LEAVES);
                return Err((self.place, Problem::TooMany { what, limit }));
            }
            self.take(word);
            self.sum()?;
            self.depth -= 1;
            return match self.next() {
                Some(word @ ")") => {
                    self.take(word);
                    Ok(())
                }
                Some(found) => Err(self.unexpected("an operator or `)`", found)),
                None => Err(self.ended("an operator or `)`")),
            };
        }
        if !word.starts_with(is_of_name) {
            return Err(self.unexpected(OPERAND, word));
        }
        self.take(word);
        if self.names.len() == limits::LEAVES {
            let (what, limit) = ("solids in an expression", limits::LEAVES);
            return Err((self.place, Problem::TooMany { what, limit }));
        }
        self.steps.push(Step::Leaf);
        self.names.push(word);
        Ok(())
    }
}

fn is_of_name(it: char) -> bool {
    it.is_alphanumeric() || it == '_'
}

#[cfg(test)]
mod tests {
    use super::*;

    const START: Place = Place { line: 1, column: 1 };

    #[test]
    fn expressions_are_read_by_precedence_and_from_the_left() {
        use Step::{Difference as D, Intersection as I, Leaf as L, Union as U};
        let cases: [(&str, &[Step]); 8] = [
            ("a", &[L]),
            ("a + b", &[L, L, U]),
            ("a-b-c", &[L, L, D, L, D]),
            ("a - (b - c)", &[L, L, L, D, D]),
            ("a & b + c & d", &[L, L, I, L, L, I, U]),
            ("a & (b + c)", &[L, L, L, U, I]),
            ("((a)) & a1_b", &[L, L, I]),
            (" a+b&c - d ", &[L, L, L, I, U, L, D]),
        ];
        for (text, steps) in cases {
            assert_eq!(expression(text, START).unwrap().0, steps, "{text}");
        }
        assert_eq!(expression("b & a - b", START).unwrap().1, ["b", "a", "b"]);
    }

    #[test]
    fn what_is_no_expression_is_refused() {
        let operand = "expected the name of a solid or `(`, found ";
        let end = "the end of the expression";
        let many = vec!["a"; limits::LEAVES + 1].join("+");
        let deep = "(".repeat(2 * limits::LEAVES + 1);
        let cases = [
            ("", format!("{operand}`{end}`")),
            ("a +", format!("{operand}`{end}`")),
            ("+ a", format!("{operand}`+`")),
            (
                "a b",
                "expected an operator, `+`, `-` or `&`, or the end, found `b`".to_owned(),
            ),
            ("(a", format!("expected an operator or `)`, found `{end}`")),
            ("(a b)", "expected an operator or `)`, found `b`".to_owned()),
            (
                "a)",
                "expected an operator, `+`, `-` or `&`, or the end, found `)`".to_owned(),
            ),
            (
                "a * b",
                "expected an operator, `+`, `-` or `&`, or the end, found `*`".to_owned(),
            ),
            (&many, "more than 32 solids in an expression".to_owned()),
            (&deep, "more than 64 parentheses in each other".to_owned()),
        ];
        for (text, message) in cases {
            assert_eq!(expression(text, START).unwrap_err().1.to_string(), message);
        }
        assert!(expression(&vec!["a"; limits::LEAVES].join("+"), START).is_ok());
    }

    #[test]
    fn turns_are_by_the_right_hand_and_in_order() {
        let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
        let minus = |v: [f64; 3]| v.map(|it| 0.0 - it);
        assert_eq!(rotation([90.0, 0.0, 0.0]), [x, z, minus(y)]);
        assert_eq!(rotation([0.0, 90.0, 0.0]), [minus(z), y, x]);
        assert_eq!(rotation([0.0, 0.0, 90.0]), [y, minus(x), z]);
        // First round x: y goes to z, then round y to x.
        assert_eq!(rotation([90.0, 90.0, 0.0])[1], x);
        assert_eq!(rotation([-270.0, 450.0, 360.0])[1], x);
        let half = rotation([0.0, 0.0, 45.0]);
        assert!((half[0][0] - 0.5_f64.sqrt()).abs() < 1e-15);
    }
}
