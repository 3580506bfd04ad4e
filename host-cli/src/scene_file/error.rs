//! What can be wrong with a scene file, and where.

use std::fmt;
use std::path::PathBuf;

use thiserror::Error;
use whitted::{
    CameraError, CuboidError, FrustumError, PatchError, PlacementError, PlaneError, PolygonError,
    QuadricError, SphereError, TorusError,
};

use super::limits::Range;

/// A place in a text file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// From 1.
    pub line: u32,
    /// In characters, from 1.
    pub column: u32,
}

impl Place {
    /// The place of a byte of a text. Lines end with a line feed.
    pub(crate) fn of(text: &[u8], offset: usize) -> Self {
        let before = &text[..offset.min(text.len())];
        let line_start = before
            .iter()
            .rposition(|&it| it == b'\n')
            .map_or(0, |it| it + 1);
        Self {
            line: 1 + before.iter().filter(|&&it| it == b'\n').count() as u32,
            column: 1 + characters(&before[line_start..]),
        }
    }
}

/// How many characters these bytes of UTF-8 begin.
pub(crate) fn characters(bytes: &[u8]) -> u32 {
    bytes.iter().filter(|&&it| it & 0xC0 != 0x80).count() as u32
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.line, self.column)
    }
}

/// Why a scene file cannot be used: `file:line:col: what and why`.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{}:{} {problem}", path.display(), place.map(|it| format!("{it}:")).unwrap_or_default())]
pub struct SceneError {
    /// The file.
    pub path: PathBuf,
    /// Where in it, unless the whole file is meant.
    pub place: Option<Place>,
    /// What is wrong there.
    pub problem: Problem,
}

/// A [`Problem`] whose file the caller knows.
pub(crate) type Located = (Place, Problem);

/// For `map_err`: puts a problem at a place.
pub(crate) fn at<P: Into<Problem>>(place: Place) -> impl FnOnce(P) -> Located {
    move |problem| (place, problem.into())
}

/// What can be wrong with a scene file.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Problem {
    /// The system's words.
    #[error("cannot be read: {0}")]
    Unreadable(String),
    /// By its name.
    #[error("not a scene file: the name ends in neither .nff nor .toml")]
    UnknownFormat,
    /// In bytes.
    #[error("larger than {limit} bytes")]
    TooManyBytes {
        /// The most that is read.
        limit: u64,
    },
    /// Neither ASCII nor UTF-8.
    #[error("not UTF-8 text")]
    NotText,
    /// A first letter that NFF does not know.
    #[error("`{0}` is no entity of NFF: it has v, b, l, f, s, c, p and pp")]
    UnknownEntity(String),
    /// A word in place of another.
    #[error("expected {expected}, found `{found}`")]
    Unexpected {
        /// What should stand there.
        expected: String,
        /// What does.
        found: String,
    },
    /// The file stops in the middle of an entity.
    #[error("expected {expected}, found the end of the file")]
    Ended {
        /// What should stand there.
        expected: String,
    },
    /// In NFF, where `f` sets the material of what follows.
    #[error("a {0} before any material: no `f` precedes it")]
    NoMaterial(&'static str),
    /// Something that a file has once.
    #[error("a second {what}; the first is at {first}")]
    Repeated {
        /// What it is.
        what: &'static str,
        /// Where the first is.
        first: Place,
    },
    /// A number beyond what its field takes.
    #[error("{what} is {value:?}: {range}")]
    OutOfRange {
        /// The field.
        what: String,
        /// The number.
        value: f64,
        /// What the field takes.
        range: Range,
    },
    /// More of something than a limit allows.
    #[error("more than {limit} {what}")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// How much there may be.
        limit: usize,
    },
    /// A material's name that no material has.
    #[error("no material is named `{0}`")]
    UnknownMaterial(String),
    /// A texture's name that no texture has.
    #[error("no texture is named `{0}`")]
    UnknownTexture(String),
    /// A character of a plan.
    #[error("`{}` is neither a wall of the file nor empty, which `.` and a space are", .0.escape_debug())]
    UnknownCell(char),
    /// Rows that are not of one length.
    #[error("{found} cells in this row, {width} in the first")]
    Ragged {
        /// How many there are.
        found: usize,
        /// How many there should be.
        width: usize,
    },
    /// The picture of a texture cannot be used.
    #[error("texture {file}: {reason}")]
    Texture {
        /// Its file, as named.
        file: String,
        /// What is wrong with it.
        reason: String,
    },
    /// What TOML or its types have to say.
    #[error("{0}")]
    Toml(String),
    /// Fields that do not go together.
    #[error("{0}")]
    Contradiction(&'static str),
    /// A camera that shows nothing.
    #[error("camera: {0}")]
    Camera(#[from] CameraError),
    /// A sphere that is none.
    #[error("sphere: {0}")]
    Sphere(#[from] SphereError),
    /// A plane that is none.
    #[error("plane: {0}")]
    Plane(#[from] PlaneError),
    /// A polygon that is none.
    #[error("polygon: {0}")]
    Polygon(PolygonError),
    /// A triangle that is none.
    #[error("triangle: {0}")]
    Triangle(PolygonError),
    /// A patch that is none.
    #[error("patch: {0}")]
    Patch(#[from] PatchError),
    /// A box that is none.
    #[error("box: {0}")]
    Box(#[from] CuboidError),
    /// A frustum that is none.
    #[error("frustum: {0}")]
    Frustum(#[from] FrustumError),
    /// A quadric that is none.
    #[error("quadric: {0}")]
    Quadric(#[from] QuadricError),
    /// A placement that is none.
    #[error("instance: {0}")]
    Placement(#[from] PlacementError),
    /// A group's name that no group has.
    #[error("no group is named `{0}`")]
    UnknownGroup(String),
    /// A group that is part of itself.
    #[error("group `{0}` places itself")]
    Cycle(String),
    /// A solid's name that the expression's table does not have.
    #[error("no solid is named `{0}` here")]
    UnknownSolid(String),
    /// A solid that the expression does not name.
    #[error("solid `{0}` is not part of the expression")]
    UnusedSolid(String),
    /// A shape that has no inside.
    #[error("{0}")]
    NoInside(&'static str),
    /// A torus that is none.
    #[error("torus: {0}")]
    Torus(#[from] TorusError),
}

/// A word of the file for a message: short, and without control characters.
pub(crate) fn excerpt(bytes: &[u8]) -> String {
    const LONGEST: usize = 32;
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * LONGEST)]);
    let mut excerpt: String = text
        .chars()
        .take(LONGEST)
        .flat_map(char::escape_debug)
        .collect();
    if text.chars().nth(LONGEST).is_some() {
        excerpt.push('…');
    }
    excerpt
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_count_lines_and_characters() {
        let text = "ab\ncdé→f\n";
        let cases = [
            ("start", 0, (1, 1)),
            ("line end", 2, (1, 3)),
            ("next line", 3, (2, 1)),
            ("after wide characters", text.find('f').unwrap(), (2, 5)),
            ("end", text.len(), (3, 1)),
            ("past the end", 99, (3, 1)),
        ];
        for (name, offset, (line, column)) in cases {
            assert_eq!(
                Place::of(text.as_bytes(), offset),
                Place { line, column },
                "{name}"
            );
        }
    }

    #[test]
    fn excerpts_are_short_and_printable() {
        assert_eq!(excerpt(b"abc"), "abc");
        assert_eq!(excerpt(b"a\x1b[31m"), "a\\u{1b}[31m");
        assert_eq!(excerpt(b"\xff"), "\u{fffd}");
        assert_eq!(excerpt(&[b'x'; 1000]).chars().count(), 33);
    }
}
