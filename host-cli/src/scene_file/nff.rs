//! The Neutral File Format of the Standard Procedural Databases.
//!
//! White space separates tokens and means nothing else; `#` starts a comment that ends with its line.
//! What the databases assume beyond the format's description is done here: a material's Ks is the
//! weight of its highlight and of its mirror; every light is sqrt(n)/(2n) bright, for n lights,
//! unless it has a colour of its own; there is no ambient light; rays go five deep.
//!
//! E. Haines, "A Proposal for Standard Graphics Environments", IEEE CG&A 7(11), 1987.

use std::collections::HashMap;
use std::path::Path;

use super::limits::{self, Range};
use super::{
    Camera, Lens, Light, Located, Material, Object, Place, Problem, SceneError, SceneFile, Shape,
    at,
};
use crate::scene_file::error::{characters, excerpt};

/// Makes a scene of a file's bytes; `path` is for messages.
///
/// # Errors
///
/// At the first token that is not what the format has in its place, or beyond the
/// [`limits`].
pub fn parse(path: &Path, bytes: &[u8]) -> Result<SceneFile, SceneError> {
    let mut parser = Parser {
        tokens: Tokens::new(bytes),
        file: SceneFile::empty(path),
        background: None,
        plain_lights: Vec::new(),
        fills: 0,
        material: None,
        known_materials: HashMap::new(),
        shapes: 0,
    };
    match parser.file() {
        Ok(()) => Ok(parser.file),
        Err((place, problem)) => Err(parser.file.error(place, problem)),
    }
}

/// A word of the file.
#[derive(Clone, Copy)]
struct Token<'a> {
    bytes: &'a [u8],
    place: Place,
}

impl Token<'_> {
    fn number(&self) -> Option<f64> {
        fast_float2::parse(self.bytes).ok()
    }

    fn unexpected(&self, expected: &str) -> Located {
        let problem = Problem::Unexpected {
            expected: expected.to_owned(),
            found: excerpt(self.bytes),
        };
        (self.place, problem)
    }
}

/// The words of a file, one ahead.
struct Tokens<'a> {
    bytes: &'a [u8],
    next: usize,
    /// Where `counted` bytes of the file lead; counted on from there, or a long line would be counted
    /// again for each of its tokens.
    place: Place,
    counted: usize,
    peeked: Option<Token<'a>>,
}

impl<'a> Tokens<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        let mut tokens = Self {
            bytes: bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes),
            next: 0,
            place: Place { line: 1, column: 1 },
            counted: 0,
            peeked: None,
        };
        tokens.peeked = tokens.scan();
        tokens
    }

    /// The place of the next byte to be scanned.
    fn place(&mut self) -> Place {
        self.place.column += characters(&self.bytes[self.counted..self.next]);
        self.counted = self.next;
        self.place
    }

    fn scan(&mut self) -> Option<Token<'a>> {
        let mut comment = false;
        while let Some(&byte) = self.bytes.get(self.next) {
            match byte {
                b'\n' => {
                    comment = false;
                    self.place = Place {
                        line: self.place.line + 1,
                        column: 1,
                    };
                    self.counted = self.next + 1;
                }
                b'#' => comment = true,
                _ if comment || byte.is_ascii_whitespace() => {}
                _ => break,
            }
            self.next += 1;
        }
        let rest = &self.bytes[self.next..];
        let ends = |byte: &u8| byte.is_ascii_whitespace() || *byte == b'#';
        let length = rest.iter().position(ends).unwrap_or(rest.len());
        if length == 0 {
            return None;
        }
        let place = self.place();
        self.next += length;
        Some(Token {
            bytes: &rest[..length],
            place,
        })
    }

    fn peek(&self) -> Option<Token<'a>> {
        self.peeked
    }

    fn next(&mut self) -> Option<Token<'a>> {
        let next = self.scan();
        std::mem::replace(&mut self.peeked, next)
    }

    fn expect(&mut self, expected: &str) -> Result<Token<'a>, Located> {
        self.next().ok_or_else(|| {
            let problem = Problem::Ended {
                expected: expected.to_owned(),
            };
            (self.place(), problem)
        })
    }

    fn word(&mut self, word: &str) -> Result<(), Located> {
        let expected = format!("`{word}`");
        let token = self.expect(&expected)?;
        if token.bytes == word.as_bytes() {
            Ok(())
        } else {
            Err(token.unexpected(&expected))
        }
    }

    fn number(&mut self, what: &str, range: Range) -> Result<f64, Located> {
        let token = self.expect(what)?;
        let number = token.number().ok_or_else(|| token.unexpected(what))?;
        range.check(what, number).map_err(at(token.place))
    }

    fn numbers(&mut self, what: &str, range: Range) -> Result<[f64; 3], Located> {
        Ok([
            self.number(what, range)?,
            self.number(what, range)?,
            self.number(what, range)?,
        ])
    }

    /// A whole number from `least` to `most`; beyond, a problem of the caller's choice.
    fn count(
        &mut self,
        what: &str,
        least: usize,
        most: usize,
        too_many: impl FnOnce() -> Problem,
    ) -> Result<usize, Located> {
        let token = self.expect(what)?;
        let digits = !token.bytes.is_empty() && token.bytes.iter().all(u8::is_ascii_digit);
        let number = if digits {
            // Too many digits for usize are too many of anything.
            std::str::from_utf8(token.bytes)
                .ok()
                .map(|it| it.parse().unwrap_or(usize::MAX))
        } else {
            None
        };
        match number {
            Some(number) if number > most => Err((token.place, too_many())),
            Some(number) if number >= least => Ok(number),
            _ => Err(token.unexpected(what)),
        }
    }
}

struct Parser<'a> {
    tokens: Tokens<'a>,
    file: SceneFile,
    background: Option<Place>,
    /// Lights without a colour of their own.
    plain_lights: Vec<usize>,
    /// How many materials were set.
    fills: usize,
    /// The one that is.
    material: Option<usize>,
    /// By the bits of their parameters.
    known_materials: HashMap<[u64; 8], usize>,
    /// How many shapes were read.
    shapes: usize,
}

impl Parser<'_> {
    fn file(&mut self) -> Result<(), Located> {
        while let Some(token) = self.tokens.next() {
            match token.bytes {
                b"v" => self.viewpoint(token.place)?,
                b"b" => self.background(token.place)?,
                b"l" => self.light(token.place)?,
                b"f" => self.fill(token.place)?,
                b"s" => self.sphere(token.place)?,
                b"c" => self.frustum(token.place)?,
                b"p" => self.polygon(token.place)?,
                b"pp" => self.patch(token.place)?,
                other => return Err((token.place, Problem::UnknownEntity(excerpt(other)))),
            }
        }
        let n = self.file.lights.len() as f64;
        for &light in &self.plain_lights {
            self.file.lights[light].color = [n.sqrt() / (2.0 * n); 3];
        }
        Ok(())
    }

    fn viewpoint(&mut self, place: Place) -> Result<(), Located> {
        if let Some(first) = &self.file.camera {
            return Err((place, repeated("viewpoint `v`", first.place)));
        }
        let tokens = &mut self.tokens;
        tokens.word("from")?;
        let eye = tokens.numbers("a coordinate of `from`", Range::Length)?;
        tokens.word("at")?;
        let target = tokens.numbers("a coordinate of `at`", Range::Length)?;
        tokens.word("up")?;
        let up = tokens.numbers("a coordinate of `up`", Range::Length)?;
        tokens.word("angle")?;
        let degrees = tokens.number("the angle", Range::Angle)?;
        tokens.word("hither")?;
        tokens.number("the hither distance", Range::Length)?;
        tokens.word("resolution")?;
        let mut size = [0; 2];
        for side in &mut size {
            let too_large = || Problem::TooMany {
                what: "pixels to a side",
                limit: limits::SIDE as usize,
            };
            let limit = limits::SIDE as usize;
            *side = tokens.count("a number of pixels from 1 on", 1, limit, too_large)? as u32;
        }
        self.file.size = Some(size);
        self.file.camera = Some(Camera {
            place,
            eye,
            target,
            up,
            lens: Lens::Both { degrees },
        });
        Ok(())
    }

    fn background(&mut self, place: Place) -> Result<(), Located> {
        if let Some(first) = self.background.replace(place) {
            return Err((place, repeated("background `b`", first)));
        }
        self.file.background = self
            .tokens
            .numbers("a component of the background", Range::Brightness)?;
        Ok(())
    }

    fn light(&mut self, place: Place) -> Result<(), Located> {
        let position = self
            .tokens
            .numbers("a coordinate of the light", Range::Length)?;
        let mut color = [0.0; 3];
        if self.tokens.peek().is_some_and(|it| it.number().is_some()) {
            color = self
                .tokens
                .numbers("a component of the light's colour", Range::Brightness)?;
        } else {
            self.plain_lights.push(self.file.lights.len());
        }
        if self.file.lights.len() == limits::LIGHTS {
            return Err((place, too_many("lights", limits::LIGHTS)));
        }
        self.file.lights.push(Light {
            place,
            position,
            color,
            shadows: true,
            area: None,
        });
        Ok(())
    }

    fn fill(&mut self, place: Place) -> Result<(), Located> {
        let tokens = &mut self.tokens;
        let color = tokens.numbers("a component of the colour", Range::Brightness)?;
        let diffuse = tokens.number("Kd", Range::Brightness)?;
        let specular = tokens.number("Ks (of mirror and highlight)", Range::Share)?;
        let shininess = tokens.number("the shininess", Range::Exponent)?;
        let transmittance = tokens.number("the transmittance", Range::Share)?;
        // Files write 0 where nothing is transmitted.
        let ior_range = if transmittance > 0.0 {
            Range::Refraction
        } else {
            Range::Length
        };
        let ior = tokens.number("the index of refraction", ior_range)?;
        let ior = if transmittance > 0.0 { ior } else { 1.0 };
        self.fills += 1;
        let [r, g, b] = color;
        let key = [r, g, b, diffuse, specular, shininess, transmittance, ior].map(|it| {
            // So that -0 is 0.
            (it + 0.0).to_bits()
        });
        let materials = &mut self.file.materials;
        let index = *self.known_materials.entry(key).or_insert_with(|| {
            materials.push(Material {
                place,
                name: format!("f{}", self.fills),
                color,
                ambient: 0.0,
                diffuse,
                specular,
                shininess,
                reflectance: specular,
                transmittance,
                ior,
                pattern: None,
                filter: [1.0; 3],
                absorption: [0.0; 3],
            });
            materials.len() - 1
        });
        if materials.len() > limits::MATERIALS {
            return Err((place, too_many("materials", limits::MATERIALS)));
        }
        self.material = Some(index);
        Ok(())
    }

    fn sphere(&mut self, place: Place) -> Result<(), Located> {
        let center = self
            .tokens
            .numbers("a coordinate of the centre", Range::Length)?;
        let radius = self.tokens.number("the radius", Range::Length)?;
        self.object(place, [Shape::Sphere { center, radius }])
    }

    fn frustum(&mut self, place: Place) -> Result<(), Located> {
        let tokens = &mut self.tokens;
        let base = tokens.numbers("a coordinate of the base", Range::Length)?;
        let base_radius = tokens.number("the base radius", Range::Length)?;
        let apex = tokens.numbers("a coordinate of the apex", Range::Length)?;
        let apex_radius = tokens.number("the apex radius", Range::Length)?;
        let shape = Shape::Frustum {
            base,
            base_radius,
            apex,
            apex_radius,
        };
        self.object(place, [shape])
    }

    fn corners(&mut self) -> Result<usize, Located> {
        let limit = limits::VERTICES;
        self.tokens
            .count("a number of corners from 3 on", 3, limit, || {
                too_many("corners", limit)
            })
    }

    fn polygon(&mut self, place: Place) -> Result<(), Located> {
        let corners = self.corners()?;
        // Grows with the file, not with what the file promises.
        let mut vertices = Vec::new();
        for _ in 0..corners {
            vertices.push(
                self.tokens
                    .numbers("a coordinate of a corner", Range::Length)?,
            );
        }
        let shape = match vertices[..] {
            [a, b, c] => Shape::Triangle {
                vertices: [a, b, c],
            },
            _ => Shape::Polygon { vertices },
        };
        self.object(place, [shape])
    }

    /// Outlines of more than three corners are cut into a fan, which is right for convex ones.
    fn patch(&mut self, place: Place) -> Result<(), Located> {
        let corners = self.corners()?;
        let mut vertices = Vec::new();
        for _ in 0..corners {
            let vertex = self
                .tokens
                .numbers("a coordinate of a corner", Range::Length)?;
            let normal = self
                .tokens
                .numbers("a component of a normal", Range::Length)?;
            vertices.push((vertex, normal));
        }
        let first = vertices[0];
        let fan = vertices[1..].windows(2).map(|pair| Shape::Patch {
            vertices: [first.0, pair[0].0, pair[1].0],
            normals: [first.1, pair[0].1, pair[1].1],
        });
        self.object(place, fan)
    }

    /// Adds one shape of the file, in one or more pieces.
    fn object(
        &mut self,
        place: Place,
        pieces: impl IntoIterator<Item = Shape>,
    ) -> Result<(), Located> {
        for shape in pieces {
            let Some(material) = self.material else {
                return Err((place, Problem::NoMaterial(shape.name())));
            };
            if self.file.objects.len() == limits::OBJECTS {
                return Err((place, too_many("objects", limits::OBJECTS)));
            }
            self.file.objects.push(Object {
                place,
                index: self.shapes,
                material,
                shape,
            });
        }
        self.shapes += 1;
        Ok(())
    }
}

fn repeated(what: &'static str, first: Place) -> Problem {
    Problem::Repeated { what, first }
}

fn too_many(what: &'static str, limit: usize) -> Problem {
    Problem::TooMany { what, limit }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<SceneFile, String> {
        parse(Path::new("t.nff"), text.as_bytes()).map_err(|it| it.to_string())
    }

    const VIEW: &str = "v from 1 2 3 at 0 0 0 up 0 0 1 angle 45 hither 1 resolution 6 4";
    const FILL: &str = "f 1 .5 0 .8 .2 3.5 0 0\n";

    #[test]
    fn every_entity_is_read() {
        let text = format!(
            "# a comment\nb .1 .2 .3\n{VIEW}\nl 1 2 3\nl 4 5 6 .7 .8 .9 # coloured\n{FILL}\
             s 1 2 3 -.5\nc 0 0 0 1\n  0 0 2 .5\np 3 0 0 0 1 0 0 0 1 0\n\
             p 4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\npp 3 0 0 0 0 0 1 1 0 0 0 0 2 0 1 0 0 1 1"
        );
        let file = read(&text).unwrap();
        assert_eq!(file.background, [0.1, 0.2, 0.3]);
        assert_eq!(file.ambient, [0.0; 3]);
        assert_eq!(file.size, Some([6, 4]));
        assert_eq!(file.depth, 5);
        let camera = file.camera.unwrap();
        assert_eq!((camera.eye, camera.target), ([1.0, 2.0, 3.0], [0.0; 3]));
        assert_eq!(camera.up, [0.0, 0.0, 1.0]);
        assert_eq!(camera.lens, Lens::Both { degrees: 45.0 });
        assert_eq!(file.lights[0].color, [2.0_f64.sqrt() / 4.0; 3]);
        assert_eq!(file.lights[1].position, [4.0, 5.0, 6.0]);
        assert_eq!(file.lights[1].color, [0.7, 0.8, 0.9]);
        let material = &file.materials[0];
        assert_eq!((material.specular, material.reflectance), (0.2, 0.2));
        assert_eq!((material.ambient, material.diffuse), (0.0, 0.8));
        assert_eq!((material.shininess, material.ior), (3.5, 1.0));
        let names: Vec<_> = file.objects.iter().map(|it| it.shape.name()).collect();
        assert_eq!(names, ["sphere", "frustum", "triangle", "polygon", "patch"]);
        let indices: Vec<_> = file.objects.iter().map(|it| it.index).collect();
        assert_eq!(indices, [0, 1, 2, 3, 4]);
        assert_eq!(
            file.objects[1].shape,
            Shape::Frustum {
                base: [0.0; 3],
                base_radius: 1.0,
                apex: [0.0, 0.0, 2.0],
                apex_radius: 0.5
            }
        );
        assert_eq!(file.objects[1].place, Place { line: 8, column: 1 });
    }

    #[test]
    fn lines_mean_nothing() {
        let spread = format!("{VIEW} b 0 0 1 {FILL} s 0 0 0 1").replace(' ', "\r\n\t");
        let dense = format!("{VIEW}#\nb 0 0 1#x\n{FILL}s 0 0 0 1#");
        let (spread, dense) = (read(&spread).unwrap(), read(&dense).unwrap());
        assert_eq!(spread.objects[0].shape, dense.objects[0].shape);
        assert_eq!(spread.background, dense.background);
        assert_eq!(spread.camera.unwrap().lens, dense.camera.unwrap().lens);
    }

    #[test]
    fn equal_materials_are_one() {
        let file = read(
            "f 1 1 1 1 0 9 0 0 s 0 0 0 1 f 1 1 0 1 0 9 0 0 s 0 0 0 1 f 1 1 1 1 0 9 0 1 s 0 0 0 1",
        )
        .unwrap();
        let materials: Vec<_> = file.objects.iter().map(|it| it.material).collect();
        assert_eq!(materials, [0, 1, 0]);
        assert_eq!(file.materials[1].name, "f2");
    }

    #[test]
    fn patches_of_many_corners_are_one_shape_in_pieces() {
        let file = read(&format!(
            "{FILL}pp 4 0 0 0 0 0 1 1 0 0 0 0 1 1 1 0 0 0 1 0 1 0 0 0 1 s 0 0 0 1"
        ))
        .unwrap();
        let indices: Vec<_> = file.objects.iter().map(|it| it.index).collect();
        assert_eq!(indices, [0, 0, 1]);
        let Shape::Patch { vertices, .. } = file.objects[1].shape else {
            panic!("a piece of a patch is a patch");
        };
        assert_eq!(vertices, [[0.0; 3], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    }

    #[test]
    fn a_byte_order_mark_is_no_token() {
        assert!(read("\u{feff}b 0 0 0").is_ok());
    }

    #[test]
    fn errors_name_the_place_and_the_reason() {
        let view = |tail: &str| format!("v from 1 2 3 at 0 0 0 up 0 0 1 {tail}");
        let cases = [
            (
                "x 1",
                "1:1: `x` is no entity of NFF: it has v, b, l, f, s, c, p and pp",
            ),
            (
                "b 0 0 0\n  7",
                "2:3: `7` is no entity of NFF: it has v, b, l, f, s, c, p and pp",
            ),
            (
                "b 0 0",
                "1:6: expected a component of the background, found the end of the file",
            ),
            (
                "b 0 0 # 0\n",
                "2:1: expected a component of the background, found the end of the file",
            ),
            (
                "b 0 0 l",
                "1:7: expected a component of the background, found `l`",
            ),
            (
                "b 0 0 -1",
                "1:7: a component of the background is -1.0: not between 0 and 1048576",
            ),
            (
                "b 0 0 0 b 1 1 1",
                "1:9: a second background `b`; the first is at 1:1",
            ),
            (
                "s 0 0 0 1",
                "1:1: a sphere before any material: no `f` precedes it",
            ),
            (
                "l 1 2 3 4 5",
                "1:12: expected a component of the light's colour, found the end of the file",
            ),
            (
                "l 1 2 nan",
                "1:7: a coordinate of the light is NaN: not a finite 32-bit float",
            ),
            (
                "l 1 2 1e39",
                "1:7: a coordinate of the light is 1e39: not a finite 32-bit float",
            ),
            (
                "l 1 2 -inf",
                "1:7: a coordinate of the light is -inf: not a finite 32-bit float",
            ),
            (
                "f 1 1 1 .5 1.5 0 0 0",
                "1:12: Ks (of mirror and highlight) is 1.5: not between 0 and 1",
            ),
            (
                "f 1 1 1 .5 .5 -3 0 0",
                "1:15: the shininess is -3.0: not between 0 and 16777216",
            ),
            (
                "f 1 1 1 .5 .5 3 2 1",
                "1:17: the transmittance is 2.0: not between 0 and 1",
            ),
            (
                "f 1 1 1 .5 .5 3 .5 0",
                "1:20: the index of refraction is 0.0: not between 0.0625 and 16",
            ),
            (
                "f 1 1 1 1 0 1 0 0 p 2 0 0 0 1 1 1",
                "1:21: expected a number of corners from 3 on, found `2`",
            ),
            (
                "f 1 1 1 1 0 1 0 0 p 1e3 0 0 0",
                "1:21: expected a number of corners from 3 on, found `1e3`",
            ),
            (
                "f 1 1 1 1 0 1 0 0 p -4 0 0 0",
                "1:21: expected a number of corners from 3 on, found `-4`",
            ),
            ("f 1 1 1 1 0 1 0 0 p 65537", "1:21: more than 65536 corners"),
            (
                "f 1 1 1 1 0 1 0 0 p 99999999999999999999999999",
                "1:21: more than 65536 corners",
            ),
            (
                "f 1 1 1 1 0 1 0 0 p 65536 0 0 0",
                "1:32: expected a coordinate of a corner, found the end of the file",
            ),
            (VIEW, ""),
            (
                &format!("{VIEW}\n{VIEW}"),
                "2:1: a second viewpoint `v`; the first is at 1:1",
            ),
            ("v at 0 0 0", "1:3: expected `from`, found `at`"),
            (
                &view("angle 0"),
                "1:38: the angle is 0.0: not between 0 and 180 degrees",
            ),
            (
                &view("angle 180"),
                "1:38: the angle is 180.0: not between 0 and 180 degrees",
            ),
            (&view("hither 1"), "1:32: expected `angle`, found `hither`"),
            (
                &view("angle 4 hither 1 resolution 0 4"),
                "1:60: expected a number of pixels from 1 on, found `0`",
            ),
            (
                &view("angle 4 hither 1 resolution 4 16385"),
                "1:62: more than 16384 pixels to a side",
            ),
        ];
        for (text, message) in cases {
            let error = read(text).err().map_or(String::new(), |it| it);
            let expected = match message {
                "" => String::new(),
                message => format!("t.nff:{message}"),
            };
            assert_eq!(error, expected, "{text}");
        }
    }

    #[test]
    fn bytes_that_are_no_text_are_quoted_or_skipped() {
        let parse = |bytes: &[u8]| parse(Path::new("t.nff"), bytes);
        assert!(parse(b"b 0 0 0 # \xff\xfe").is_ok());
        let error = parse(b"\xe9t\xe9 1").unwrap_err();
        assert!(
            error
                .to_string()
                .starts_with("t.nff:1:1: `\u{fffd}t\u{fffd}` is no entity")
        );
    }
}
