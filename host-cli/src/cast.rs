//! Rays as text, and what they meet as JSON: ray casting outside pictures.

use std::io::{self, BufRead, BufReader, Read, Write};

use glam::Vec3;
use serde::Serialize;
use thiserror::Error;
use whitted::{Geometry, Ray};

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
        /// [`crate::scene_file::Shape::name`].
        shape: &'static str,
        /// [`crate::scene_file::Object::index`].
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

/// Casts one ray.
pub fn cast<'a>(scene: &HostScene<'a>, given: &GivenRay, query: Query) -> Answer<'a> {
    let ray = given.cast(scene.scale());
    if query == Query::Occluded {
        return Answer::Occluded {
            occluded: scene.geometry().occluded(&ray),
        };
    }
    let geometry = scene.geometry();
    let Some(hit) = geometry.closest_hit(&ray) else {
        return Answer::Miss { hit: false };
    };
    let scale = scene.scale();
    let t = (scale.unscaled(hit.t) / length(given.direction)) as f32;
    let point = hit.point.to_array().map(|it| scale.unscaled(it) as f32);
    if !t.is_finite() || !point.iter().all(|it| it.is_finite()) {
        return Answer::Miss { hit: false };
    }
    let object = scene.in_file(hit.object);
    Answer::Hit {
        hit: true,
        t,
        point,
        normal: hit.normal.to_array(),
        front: hit.front,
        shape: object.shape.name(),
        index: object.index,
        material: &scene.file().materials[object.material].name,
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
    scene: &HostScene<'_>,
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
            Ok(ray) => cast(scene, &ray, query),
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
