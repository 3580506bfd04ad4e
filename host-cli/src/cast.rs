//! Rays as text, and what they meet as JSON: ray casting outside pictures.

use std::io::{self, BufRead, BufReader, Read, Write};

use glam::Vec3;
use serde::Serialize;
use thiserror::Error;
use whitted::{Geometry, Ray};

use crate::map::HostMap;
use crate::scene::HostScene;
use crate::scene_file::Scale;

/// What to answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Query {
    /// The nearest hit.
    Closest,
    /// Whether there is any.
    Occluded,
}

/// A ray as it is given: lengths in the scene file's unit, the direction of any length but 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GivenRay {
    /// In world space.
    pub origin: [f64; 3],
    /// Of any length but 0.
    pub direction: [f64; 3],
    /// In lengths of the direction; infinite without an end.
    pub t_max: f64,
}

/// Why a line is not a ray.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RayError {
    /// Too few or too many words.
    #[error("expected 6 or 7 numbers, found {0}")]
    Count(usize),
    /// A word that is no number.
    #[error("`{0}` is not a number")]
    NotANumber(String),
    /// A coordinate that is not finite in 32 bits.
    #[error("{0} is not a finite 32-bit float")]
    NotFinite(f64),
    /// No direction.
    #[error("the direction is zero")]
    NoDirection,
    /// An end that is not ahead.
    #[error("t_max is {0:?}: it must be above 0")]
    End(f64),
    /// A line that goes on and on.
    #[error("longer than {LONGEST_LINE} bytes")]
    TooLong,
    /// Bytes that are no text.
    #[error("not UTF-8 text")]
    NotText,
}

/// Longest line that is looked at, in bytes.
const LONGEST_LINE: usize = 4096;

impl GivenRay {
    /// A ray of a line of text.
    ///
    /// # Errors
    ///
    /// Where it is not `ox oy oz dx dy dz [t_max]`.
    pub fn parse(line: &str) -> Result<Self, RayError> {
        let mut numbers = Vec::new();
        for word in line.split_whitespace() {
            let number: f64 = word
                .parse()
                .map_err(|_| RayError::NotANumber(word.chars().take(32).collect()))?;
            numbers.push(number);
        }
        let (coordinates, t_max) = match numbers[..] {
            [ox, oy, oz, dx, dy, dz] => ([ox, oy, oz, dx, dy, dz], f64::INFINITY),
            [ox, oy, oz, dx, dy, dz, t_max] => ([ox, oy, oz, dx, dy, dz], t_max),
            _ => return Err(RayError::Count(numbers.len())),
        };
        if let Some(&number) = coordinates.iter().find(|it| !(**it as f32).is_finite()) {
            return Err(RayError::NotFinite(number));
        }
        let [ox, oy, oz, dx, dy, dz] = coordinates;
        let (origin, direction) = ([ox, oy, oz], [dx, dy, dz]);
        if length(direction) == 0.0 {
            return Err(RayError::NoDirection);
        }
        // Also true for NaN.
        if !(t_max > 0.0) {
            return Err(RayError::End(t_max));
        }
        Ok(Self {
            origin,
            direction,
            t_max,
        })
    }

    /// The ray that is cast: at the scene's scale, with a direction of unit length.
    fn cast(&self, scale: Scale) -> Ray {
        let unit = length(self.direction);
        // Beyond this t is no f32, and nothing is met.
        let t_max = self.t_max.min(f64::from(f32::MAX));
        Ray {
            t_max: scale.length(t_max * unit),
            ..Ray::new(
                scale.point(self.origin),
                Vec3::from_array(self.direction.map(|it| (it / unit) as f32)),
            )
        }
    }
}

fn length([x, y, z]: [f64; 3]) -> f64 {
    // The greatest f32's square is far from the greatest f64, and so is the least.
    (x * x + y * y + z * z).sqrt()
}

/// What a ray is answered.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Answer<'a> {
    /// The nearest hit.
    Hit {
        /// True.
        hit: bool,
        /// In lengths of the given direction.
        t: f32,
        /// In the file's unit.
        point: [f32; 3],
        /// Unit length, turned to the ray's origin.
        normal: [f32; 3],
        /// Whether that is the outward side.
        front: bool,
        /// [`crate::scene_file::Shape::name`]; of a map `wall`, `door`, `floor` or `ceiling`.
        shape: &'static str,
        /// [`crate::scene_file::Object::index`]; of a map the cell, row after row.
        index: usize,
        /// [`crate::scene_file::Material::name`].
        material: &'a str,
    },
    /// There is none.
    Miss {
        /// False.
        hit: bool,
    },
    /// Whether anything is in between.
    Occluded {
        /// Whether it is.
        occluded: bool,
    },
    /// The line is not a ray.
    Error {
        /// Why.
        error: String,
        /// Which line, from 1.
        line: u64,
    },
}

/// Something that answers rays.
pub trait Cast {
    /// Answers one.
    fn cast(&self, given: &GivenRay, query: Query) -> Answer<'_>;
}

impl Cast for HostScene<'_> {
    fn cast(&self, given: &GivenRay, query: Query) -> Answer<'_> {
        cast(&self.whole(|it| it), self.scale(), given, query, |object| {
            let object = self.in_file(object);
            let material = &self.file().materials[object.material].name;
            Some((object.shape.name(), object.index, material.as_str()))
        })
    }
}

/// Walls, doors, floor and ceiling; they are counted by cells.
impl Cast for HostMap<'_> {
    fn cast(&self, given: &GivenRay, query: Query) -> Answer<'_> {
        let maze = self.scene().geometry;
        cast(&maze, Scale::default(), given, query, |it| self.in_file(it))
    }
}

/// Casts one ray; `named` tells an object's shape, its index and its material's name.
fn cast<'a>(
    geometry: &impl Geometry,
    scale: Scale,
    given: &GivenRay,
    query: Query,
    named: impl FnOnce(usize) -> Option<(&'static str, usize, &'a str)>,
) -> Answer<'a> {
    let ray = given.cast(scale);
    if query == Query::Occluded {
        return Answer::Occluded {
            occluded: geometry.occluded(&ray),
        };
    }
    let Some(hit) = geometry.closest_hit(&ray) else {
        return Answer::Miss { hit: false };
    };
    let t = (scale.unscaled(hit.t) / length(given.direction)) as f32;
    let point = hit.point.to_array().map(|it| scale.unscaled(it) as f32);
    // Beyond the range of f32, or on a surface so small that its points are one.
    let is_told = t.is_finite() && point.iter().all(|it| it.is_finite()) && hit.normal.is_finite();
    match named(hit.object).filter(|_| is_told) {
        None => Answer::Miss { hit: false },
        Some((shape, index, material)) => Answer::Hit {
            hit: true,
            t,
            point,
            normal: hit.normal.to_array(),
            front: hit.front,
            shape,
            index,
            material,
        },
    }
}

/// How many lines there were.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lines {
    /// In all.
    pub all: u64,
    /// That were not rays.
    pub bad: u64,
}

/// Answers each line of `input` by a line of `output`; at once where no further line waits.
///
/// # Errors
///
/// Where reading or writing fails.
pub fn cast_lines(
    scene: &impl Cast,
    query: Query,
    input: impl Read,
    output: &mut impl Write,
) -> io::Result<Lines> {
    let mut input = BufReader::with_capacity(1 << 16, input);
    let mut lines = Lines::default();
    let mut line = Vec::new();
    while let Some(complete) = read_line(&mut input, &mut line)? {
        lines.all += 1;
        let ray = match std::str::from_utf8(&line) {
            _ if !complete => Err(RayError::TooLong),
            Ok(text) => GivenRay::parse(text),
            Err(_) => Err(RayError::NotText),
        };
        let answer = match ray {
            Ok(ray) => scene.cast(&ray, query),
            Err(error) => {
                lines.bad += 1;
                Answer::Error {
                    error: error.to_string(),
                    line: lines.all,
                }
            }
        };
        serde_json::to_writer(&mut *output, &answer)?;
        output.write_all(b"\n")?;
        if !input.buffer().contains(&b'\n') {
            output.flush()?;
        }
    }
    output.flush()?;
    Ok(lines)
}

/// Reads a line, without its end; `None` at the end of the input. False: it was too long, and is only
/// in part there.
fn read_line(input: &mut impl BufRead, line: &mut Vec<u8>) -> io::Result<Option<bool>> {
    line.clear();
    let limit = LONGEST_LINE as u64 + 1;
    if input.by_ref().take(limit).read_until(b'\n', line)? == 0 {
        return Ok(None);
    }
    if line.last() == Some(&b'\n') {
        line.pop();
        return Ok(Some(true));
    }
    if line.len() <= LONGEST_LINE {
        return Ok(Some(true)); // The last line, unfinished.
    }
    loop {
        let waiting = input.fill_buf()?;
        let end = waiting.iter().position(|&it| it == b'\n');
        let (length, ended) = match end {
            Some(end) => (end + 1, true),
            None => (waiting.len(), waiting.is_empty()),
        };
        input.consume(length);
        if ended {
            return Ok(Some(false));
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::scene::Pool;
    use crate::scene_file::{SceneFile, toml};

    /// A ball of radius 1 at the origin, a floor below and a box beside, all lengths times 2^`k`.
    fn file(k: i32) -> SceneFile {
        let unit = 2.0_f64.powi(k);
        let text = format!(
            "[material.wood]\n[material.glass]\ntransmittance = 0.9\n\
             [[plane]]\nmaterial = 'wood'\npoint = [0, {floor:e}, 0]\nnormal = [0, 5, 0]\n\
             [[sphere]]\nmaterial = 'glass'\ncenter = [0, 0, 0]\nradius = {unit:e}\n\
             [[box]]\nmaterial = 'wood'\nmin = [{near:e}, {low:e}, {low:e}]\n\
             max = [{far:e}, {unit:e}, {unit:e}]\n",
            floor = -3.0 * unit,
            low = -unit,
            near = 4.0 * unit,
            far = 6.0 * unit,
        );
        toml::parse(Path::new("t.toml"), &text).unwrap()
    }

    fn answers(file: &SceneFile, query: Query, input: &[u8]) -> (Vec<String>, Lines) {
        let pool = Pool::new(file);
        let scene = HostScene::new(file, &pool).unwrap();
        let mut output = Vec::new();
        let lines = cast_lines(&scene, query, input, &mut output).unwrap();
        let text = String::from_utf8(output).unwrap();
        (text.lines().map(str::to_owned).collect(), lines)
    }

    fn answer(ray: &str) -> String {
        let (answers, lines) = answers(&file(0), Query::Closest, ray.as_bytes());
        assert_eq!((answers.len(), lines.all), (1, 1));
        answers[0].clone()
    }

    #[test]
    fn a_hit_is_told_in_full() {
        assert_eq!(
            answer("0 0 3 0 0 -1"),
            r#"{"hit":true,"t":2.0,"point":[0.0,0.0,1.0],"normal":[0.0,0.0,1.0],"front":true,"shape":"sphere","index":1,"material":"glass"}"#
        );
        assert_eq!(
            answer("0 0 0 0 0 -1"),
            r#"{"hit":true,"t":1.0,"point":[0.0,0.0,-1.0],"normal":[-0.0,-0.0,1.0],"front":false,"shape":"sphere","index":1,"material":"glass"}"#
        );
        assert!(answer("9 0.5 0 -1 0 0").contains(r#""t":3.0,"point":[6.0,0.5,0.0]"#));
        assert!(answer("9 0 9 0 -1 0").contains(r#""shape":"plane","index":0,"material":"wood""#));
        assert_eq!(answer("0 0 3 0 0 1"), r#"{"hit":false}"#);
    }

    #[test]
    fn hits_of_instances_and_solids_name_what_is_in_the_file() {
        // Two balls on a shelf, which stands on its end; the bitten one is made of two.
        let text = "[material.wood]\n[material.red]\n\
                    [[plane]]\nmaterial = 'wood'\npoint = [0, -9, 0]\nnormal = [0, 1, 0]\n\
                    [[group.shelf.sphere]]\nmaterial = 'red'\ncenter = [2, 0, 0]\nradius = 1\n\
                    [[group.shelf.csg]]\nexpression = 'ball - bite'\n\
                    solid.ball.sphere = { material = 'wood', center = [-2, 0, 0], radius = 1 }\n\
                    solid.bite.box = { material = 'red', min = [-4, -2, 0.5], max = [0, 2, 2] }\n\
                    [[instance]]\nof = 'shelf'\nrotate = [0, 0, 90]\ntranslate = [5, 0, 0]\n\
                    [[instance]]\nof = 'shelf'\nscale = [1, 1, -2]\n";
        let file = toml::parse(Path::new("t.toml"), text).unwrap();
        let rays = b"5 2 9 0 0 -1\n5 -2 9 0 0 -1\n-2 0 -9 0 0 1\n-2 0 9 0 0 -1\n5 0 9 0 -1 0\n";
        let expected = [
            r#""t":8.0,"point":[5.0,2.0,1.0],"normal":[0.0,0.0,1.0],"front":true,"shape":"sphere","index":1,"material":"red""#,
            r#""t":8.5,"point":[5.0,-2.0,0.5],"normal":[0.0,0.0,1.0],"front":true,"shape":"box","index":3,"material":"red""#,
            r#""t":8.0,"point":[-2.0,0.0,-1.0],"normal":[0.0,0.0,-1.0],"front":true,"shape":"box","index":3,"material":"red""#,
            r#""t":7.0,"point":[-2.0,0.0,2.0],"normal":[0.0,0.0,1.0],"front":true,"shape":"sphere","index":2,"material":"wood""#,
            r#""shape":"plane","index":0,"material":"wood""#,
        ];
        let (answers, _) = answers(&file, Query::Closest, rays);
        assert_eq!(answers.len(), expected.len());
        for (answer, expected) in answers.iter().zip(expected) {
            // The signs of zeros are those of the matrix.
            assert!(answer.replace("-0.0", "0.0").contains(expected), "{answer}");
        }
    }

    #[test]
    fn t_counts_lengths_of_the_direction() {
        for (ray, t) in [
            ("0 0 3 0 0 -0.5", "4.0"),
            ("0 0 3 0 0 -8", "0.25"),
            ("0 0 3 0 0 -1e30", "2e-30"),
            ("0 0 3 0 0 -1e-30", "2e+30"),
            ("3 4 0 -3 -4 0", "0.8"),
        ] {
            assert!(
                answer(ray).contains(&format!("\"t\":{t},")),
                "{ray}: {}",
                answer(ray)
            );
        }
    }

    #[test]
    fn the_end_is_excluded_and_in_lengths_of_the_direction() {
        for (ray, hit) in [
            ("0 0 3 0 0 -1 2", false),
            ("0 0 3 0 0 -1 2.0001", true),
            ("0 0 3 0 0 -0.5 4", false),
            ("0 0 3 0 0 -0.5 4.0001", true),
            ("0 0 3 0 0 -1 inf", true),
        ] {
            assert_eq!(answer(ray).contains("\"hit\":true"), hit, "{ray}");
            let (answers, _) = answers(&file(0), Query::Occluded, ray.as_bytes());
            assert_eq!(answers, [format!("{{\"occluded\":{hit}}}")], "{ray}");
        }
    }

    #[test]
    fn what_no_32_bit_float_can_tell_is_not_met() {
        // The horizon at 3·2^149, and the near side by a direction too short.
        for ray in ["0 0 3 1 -1.4e-45 0", "0 0 3 0 0 -1e-39"] {
            assert_eq!(answer(ray), r#"{"hit":false}"#, "{ray}");
            let (answers, _) = answers(&file(0), Query::Occluded, ray.as_bytes());
            assert_eq!(answers, [r#"{"occluded":false}"#], "{ray}");
        }
        assert!(answer("0 0 3 0 0 -1e-38").contains("\"t\":2e+38"));
    }

    #[test]
    fn answers_scale_with_the_scene() {
        let ordinary: Vec<serde_json::Value> = {
            let rays = "0.25 0.5 3 0.1 -0.2 -1\n9 0.5 0.25 -1 0 0.01\n0 0 0 1 -1 0";
            let (answers, _) = answers(&file(0), Query::Closest, rays.as_bytes());
            answers
                .iter()
                .map(|it| serde_json::from_str(it).unwrap())
                .collect()
        };
        for k in [-100, -60, -17, 3, 40, 60, 100] {
            let unit = 2.0_f64.powi(k);
            let rays: String = [
                ([0.25, 0.5, 3.0], [0.1, -0.2, -1.0]),
                ([9.0, 0.5, 0.25], [-1.0, 0.0, 0.01]),
                ([0.0, 0.0, 0.0], [1.0, -1.0, 0.0]),
            ]
            .iter()
            .map(|(o, d)| {
                let [x, y, z] = o.map(|it| it * unit);
                let [dx, dy, dz] = d;
                format!("{x:e} {y:e} {z:e} {dx} {dy} {dz}\n")
            })
            .collect();
            let (answers, _) = answers(&file(k), Query::Closest, rays.as_bytes());
            for (answer, ordinary) in answers.iter().zip(&ordinary) {
                let answer: serde_json::Value = serde_json::from_str(answer).unwrap();
                let f32 = |it: &serde_json::Value| it.as_f64().unwrap() as f32;
                let scaled = f32(&ordinary["t"]) as f64 * unit;
                assert_eq!(f32(&answer["t"]), scaled as f32, "2^{k}");
                for axis in 0..3 {
                    let scaled = f32(&ordinary["point"][axis]) as f64 * unit;
                    assert_eq!(f32(&answer["point"][axis]), scaled as f32, "2^{k}");
                }
                assert_eq!(answer["normal"], ordinary["normal"], "2^{k}");
                assert_eq!(answer["index"], ordinary["index"], "2^{k}");
            }
        }
    }

    #[test]
    fn lines_that_are_not_rays_are_answered_by_errors() {
        let long = [b"0 ".repeat(3000), b"\n".to_vec()].concat();
        let longest = [b"0 0 3 0 0 -1".to_vec(), b" ".repeat(4084), b"\n".to_vec()].concat();
        let cases: [(&[u8], &str); 10] = [
            (b"\n", r#""expected 6 or 7 numbers, found 0""#),
            (b"1 2 3\n", r#""expected 6 or 7 numbers, found 3""#),
            (
                b"1 2 3 4 5 6 7 8\n",
                r#""expected 6 or 7 numbers, found 8""#,
            ),
            (b"1 2 3 4 x\"y 6\n", r#""`x\"y` is not a number""#),
            (b"1 2 nan 4 5 6\n", r#""NaN is not a finite 32-bit float""#),
            (b"1 2 3 4 1e39 6\n", r#" is not a finite 32-bit float""#),
            (b"1 2 3 0 0 0\n", r#""the direction is zero""#),
            (
                b"1 2 3 0 0 1 -2\n",
                r#""t_max is -2.0: it must be above 0""#,
            ),
            (b"1 2 3 \xff 0 1\n", r#""not UTF-8 text""#),
            (&long, r#""longer than 4096 bytes""#),
        ];
        for (line, error) in cases {
            let input = [b"0 0 3 0 0 -1\r\n", line, &longest, b"0 0 3 0 0 1"].concat();
            let (answers, lines) = answers(&file(0), Query::Closest, &input);
            assert_eq!(lines, Lines { all: 4, bad: 1 }, "{error}");
            assert!(answers[0].contains("\"hit\":true"), "{error}");
            assert!(answers[1].contains(error), "{error}: {}", answers[1]);
            assert!(
                answers[1].ends_with(",\"line\":2}"),
                "{error}: {}",
                answers[1]
            );
            assert!(answers[2].contains("\"hit\":true"), "{error}");
            assert_eq!(answers[3], r#"{"hit":false}"#, "{error}");
        }
    }
}
