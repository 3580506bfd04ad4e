//! Scene files: what they say, as they say it.
//!
//! [`read`] takes a file in either of two formats, [NFF](nff) and [TOML](toml), to one plain model.
//! Numbers are kept in `f64`, as they were read; the file's order is kept; every entity knows where
//! it stands. [`crate::scene`] makes of this what the ray caster takes, [`SceneFile::rounded`] tells
//! which numbers it sees.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use whitted::area::Samples;

mod error;
pub mod limits;
pub mod map;
pub mod nff;
mod quadric;
mod scale;
mod solid;
pub mod texture;
pub mod toml;

pub(crate) use error::{Located, at};
pub use error::{Place, Problem, SceneError};
pub use quadric::{General, Quadric};
pub use scale::{Scale, direction, proportions};
pub use solid::{Group, Instance, Solid, Step};
use texture::Texture;

/// A scene as a file describes it. Lengths share one unit of the file's choice; colours are linear.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneFile {
    /// The file, for messages.
    pub path: PathBuf,
    /// A scene without a camera can be inspected and cast into, not rendered.
    pub camera: Option<Camera>,
    /// Width and height of the picture in pixels, where the file asks for a size.
    pub size: Option<[u32; 2]>,
    /// Longest chain of rays, the eye ray counted as 1.
    pub depth: usize,
    /// What a ray sees that meets nothing.
    pub background: [f64; 3],
    /// Light that reaches every point alike.
    pub ambient: [f64; 3],
    /// In file order; of NFF's, which have no names, equal ones are one.
    pub materials: Vec<Material>,
    /// In file order.
    pub lights: Vec<Light>,
    /// In file order.
    pub objects: Vec<Object>,
    /// In file order.
    pub solids: Vec<Solid>,
    /// In file order.
    pub groups: Vec<Group>,
    /// By group, and in file order; what groups place in groups is placed in the world.
    pub instances: Vec<Instance>,
}

/// Who looks at the scene, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where in the file.
    pub place: Place,
    /// Where all primary rays start.
    pub eye: [f64; 3],
    /// A point straight ahead.
    pub target: [f64; 3],
    /// Points upwards in the picture; neither unit length nor perpendicular to the view.
    pub up: [f64; 3],
    /// Which part of the view the picture shows.
    pub lens: Lens,
}

/// The part of the view that the picture shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// The full angle between upper and lower edge, in degrees. Pixels are square: the width of the
    /// picture decides how far it reaches to the sides.
    Vertical {
        /// Above 0, below 180.
        degrees: f64,
    },
    /// The full angle between opposite edges, in degrees, the same both ways whatever the picture's
    /// size: NFF's rule. Pixels of a picture that is not square are not square either.
    Both {
        /// Above 0, below 180.
        degrees: f64,
    },
    /// A window in the plane at `distance` ahead, measured from the point straight ahead.
    Frustum {
        /// Left edge, along the picture's right; mostly negative.
        left: f64,
        /// Right edge, above `left`.
        right: f64,
        /// Lower edge, along the picture's up; mostly negative.
        bottom: f64,
        /// Upper edge, above `bottom`.
        top: f64,
        /// Above 0.
        distance: f64,
    },
}

/// A light without falloff.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Where in the file.
    pub place: Place,
    /// In world space; the middle, where it is no point.
    pub position: [f64; 3],
    /// Linear RGB.
    pub color: [f64; 3],
    /// Whether objects block it.
    pub shadows: bool,
    /// What it is, unless a point.
    pub area: Option<Area>,
}

/// What a light is that casts soft shadows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// Around its middle.
    pub extent: Extent,
    /// How closely it is looked at.
    pub samples: Samples,
}

/// What there is of a light around its middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extent {
    /// A parallelogram, by two edges that meet.
    Rect {
        /// In world space.
        edges: [[f64; 3]; 2],
    },
    /// A disk that faces each point: a ball.
    Disk {
        /// At least 0.
        radius: f64,
    },
}

impl Extent {
    /// With every length replaced.
    fn map(self, length: &impl Fn(f64) -> f64) -> Self {
        match self {
            Self::Rect { edges } => Self::Rect {
                edges: edges.map(|it| it.map(length)),
            },
            Self::Disk { radius } => Self::Disk {
                radius: length(radius),
            },
        }
    }
}

/// How a surface answers light.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Where in the file.
    pub place: Place,
    /// The file's name for it; `f1`, `f2`, … in NFF, which has none.
    pub name: String,
    /// Linear RGB; white where there is a pattern.
    pub color: [f64; 3],
    /// What takes the color's place, where it is not the same everywhere.
    pub pattern: Option<Pattern>,
    /// Share of the ambient light given back.
    pub ambient: f64,
    /// Share of a light that is scattered evenly.
    pub diffuse: f64,
    /// Brightness of a light's highlight.
    pub specular: f64,
    /// Exponent of the highlight, whole or not.
    pub shininess: f64,
    /// Weight of the mirrored ray, from 0 to 1.
    pub reflectance: f64,
    /// Weight of the refracted ray, from 0 to 1.
    pub transmittance: f64,
    /// Index of refraction inside over outside; above 0, and 1 where nothing is transmitted.
    pub ior: f64,
    /// What passes the surface is multiplied by this, beside the transmittance; from 0 to 1 each.
    pub filter: [f64; 3],
    /// How fast light weakens inside, over a length of the file's unit.
    pub absorption: [f64; 3],
}

/// A color that changes along a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum Pattern {
    /// Cubes of two colors.
    Checker {
        /// Linear RGB; the first from the origin to (`size`, `size`, `size`).
        colors: [[f64; 3]; 2],
        /// Of a cube.
        size: f64,
    },
    /// Layers of two colors.
    Stripes {
        /// Linear RGB; the first from the origin on.
        colors: [[f64; 3]; 2],
        /// Across the layers, of any length.
        direction: [f64; 3],
        /// Of a layer.
        size: f64,
    },
    /// A picture.
    Image {
        /// The picture.
        texture: Arc<Texture>,
        /// How many copies there are in a unit of the surface's coordinates.
        repeat: [f64; 2],
        /// Whether pixels are blended.
        blend: bool,
    },
}

/// A shape made of a material.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Where in the file.
    pub place: Place,
    /// Which shape of the file this is, counted from 0 over all kinds. Only patches that were cut
    /// from one outline share it.
    pub index: usize,
    /// Index into [`SceneFile::materials`].
    pub material: usize,
    /// What it looks like.
    pub shape: Shape,
}

/// The outline of an object, in world space.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// All points at one distance from another.
    Sphere {
        /// The point.
        center: [f64; 3],
        /// The distance; negative: only the inside is visible.
        radius: f64,
    },
    /// A plane without end.
    Plane {
        /// Any point of it.
        point: [f64; 3],
        /// Perpendicular to it, of any length; points to the outward side.
        normal: [f64; 3],
    },
    /// A planar outline, concave or not.
    Polygon {
        /// In order; the last is joined to the first.
        vertices: Vec<[f64; 3]>,
    },
    /// A flat triangle.
    Triangle {
        /// The corners.
        vertices: [[f64; 3]; 3],
    },
    /// A triangle that is shaded as if it were bent.
    Patch {
        /// The corners.
        vertices: [[f64; 3]; 3],
        /// Normals at the corners, of any length.
        normals: [[f64; 3]; 3],
    },
    /// A box whose faces are parallel to the axes.
    Box {
        /// Its least corner.
        min: [f64; 3],
        /// Its greatest corner.
        max: [f64; 3],
    },
    /// The side of a cone or cylinder between two circles, open at both ends.
    Frustum {
        /// Centre of the first circle.
        base: [f64; 3],
        /// Its radius; negative, as the other: only the inside is visible.
        base_radius: f64,
        /// Centre of the second circle.
        apex: [f64; 3],
        /// Its radius; 0 for a pointed cone.
        apex_radius: f64,
    },
    /// A surface of degree two.
    Quadric {
        /// Which.
        form: Quadric,
        /// Whether it is a solid with flat faces where it is cut.
        closed: bool,
    },
    /// A tube round a circle.
    Torus {
        /// Of the circle.
        center: [f64; 3],
        /// Across the circle, of any length.
        axis: [f64; 3],
        /// Radius of the circle.
        major: f64,
        /// Radius of the tube.
        minor: f64,
    },
}

impl Shape {
    /// The kind, in one word.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Sphere { .. } => "sphere",
            Self::Plane { .. } => "plane",
            Self::Polygon { .. } => "polygon",
            Self::Triangle { .. } => "triangle",
            Self::Patch { .. } => "patch",
            Self::Box { .. } => "box",
            Self::Frustum { .. } => "frustum",
            Self::Quadric { .. } => "quadric",
            Self::Torus { .. } => "torus",
        }
    }
}

impl SceneFile {
    /// An error where what a pattern repeats vanishes, or has no end, at the scale at which the scene is cast.
    fn check_patterns(&self) -> Result<(), Located> {
        // Found out only where there is one: all objects are looked at.
        let mut scale = None;
        for material in &self.materials {
            let (Some(Pattern::Checker { size, .. }) | Some(Pattern::Stripes { size, .. })) =
                material.pattern
            else {
                continue;
            };
            let cast = scale.get_or_insert_with(|| self.scale()).length(size);
            if !(cast > 0.0 && cast.is_finite()) {
                let problem = "what a pattern repeats is out of all proportion to the scene";
                return Err((material.place, Problem::Contradiction(problem)));
            }
        }
        Ok(())
    }

    /// A scene of nothing, with the defaults of both formats.
    pub(crate) fn empty(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            camera: None,
            size: None,
            depth: DEFAULT_DEPTH,
            background: [0.0; 3],
            ambient: [0.0; 3],
            materials: Vec::new(),
            lights: Vec::new(),
            objects: Vec::new(),
            solids: Vec::new(),
            groups: Vec::new(),
            instances: Vec::new(),
        }
    }

    /// All objects, in the order in which the scene's geometry has them: leaves of solids count, and
    /// those of groups count once.
    pub fn all_objects(&self) -> impl Iterator<Item = &Object> {
        let of_groups = self
            .groups
            .iter()
            .flat_map(|it| all(&it.objects, &it.solids));
        all(&self.objects, &self.solids).chain(of_groups)
    }

    /// An error about this file.
    pub(crate) fn error(&self, place: Place, problem: Problem) -> SceneError {
        SceneError {
            path: self.path.clone(),
            place: Some(place),
            problem,
        }
    }
}

fn all<'a>(objects: &'a [Object], solids: &'a [Solid]) -> impl Iterator<Item = &'a Object> {
    objects
        .iter()
        .chain(solids.iter().flat_map(|it| &it.leaves))
}

/// [`SceneFile::depth`] of files that do not say: what the standard databases were made for.
pub const DEFAULT_DEPTH: usize = 5;

/// Reads a scene file; its extension, `.nff` or `.toml`, tells the format.
///
/// # Errors
///
/// When the file cannot be read, breaks its format's rules or goes beyond the [`limits`]; with line
/// and column where there is one. Shapes and cameras that are impossible as such, say a triangle on
/// one line, come out where [`crate::scene`] builds them.
pub fn read(path: &Path) -> Result<SceneFile, SceneError> {
    let fail = |problem| SceneError {
        path: path.to_owned(),
        place: None,
        problem,
    };
    let extension = path.extension().map(|it| it.to_ascii_lowercase());
    match extension.as_ref().and_then(|it| it.to_str()) {
        Some("nff") => nff::parse(path, &bytes(path, limits::NFF_BYTES).map_err(fail)?),
        Some("toml") => {
            let bytes = bytes(path, limits::TOML_BYTES).map_err(fail)?;
            let text = String::from_utf8(bytes).map_err(|error| SceneError {
                path: path.to_owned(),
                place: Some(Place::of(
                    error.as_bytes(),
                    error.utf8_error().valid_up_to(),
                )),
                problem: Problem::NotText,
            })?;
            toml::parse(path, &text)
        }
        _ => Err(fail(Problem::UnknownFormat)),
    }
}

/// The file's bytes, unless there are more than `limit`: it may be a device without end.
fn bytes(path: &Path, limit: u64) -> Result<Vec<u8>, Problem> {
    let unreadable = |error: io::Error| Problem::Unreadable(error.to_string());
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(unreadable)?;
    file.take(limit + 1)
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    if bytes.len() as u64 > limit {
        return Err(Problem::TooManyBytes { limit });
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_read_is_named() {
        let cases = [
            ("no-such.nff", "no-such.nff: cannot be read: No such file"),
            ("no-such.toml", "no-such.toml: cannot be read: No such file"),
            (
                "scene.obj",
                "scene.obj: not a scene file: the name ends in neither .nff nor .toml",
            ),
            (
                "scene",
                "scene: not a scene file: the name ends in neither .nff nor .toml",
            ),
        ];
        for (path, message) in cases {
            let error = read(Path::new(path)).unwrap_err().to_string();
            assert!(error.starts_with(message), "{error}");
        }
    }

    #[test]
    fn a_file_without_end_is_refused() {
        if Path::new("/dev/zero").exists() {
            assert_eq!(
                bytes(Path::new("/dev/zero"), 1000),
                Err(Problem::TooManyBytes { limit: 1000 })
            );
        }
    }
}
