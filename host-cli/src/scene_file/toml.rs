//! Scenes in TOML, for people to write. The README describes every field.

use std::collections::HashMap;
use std::fmt;
use std::path::Path;
use std::sync::Arc;

use ::toml::Spanned;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use whitted::area::Samples;

use super::limits::{self, Range};
use super::texture::{Texture, TextureFields, read_all};
use super::{
    Area, Camera, DEFAULT_DEPTH, Extent, General, Group, Instance, Lens, Light, Located, Material,
    Object, Pattern, Place, Problem, Quadric, SceneError, SceneFile, Shape, Solid, at, solid,
};
use crate::scene_file::error::excerpt;

/// Makes a scene of a file's text; `path` is for messages.
///
/// # Errors
///
/// Where the text is not TOML, a field is unknown, missing, of the wrong type or beyond the
/// [`limits`], or fields contradict each other.
pub fn parse(path: &Path, text: &str) -> Result<SceneFile, SceneError> {
    let places = Places::new(text);
    let fail = |place, problem| SceneError {
        path: path.to_owned(),
        place: Some(place),
        problem,
    };
    let document: Document = ::toml::from_str(text).map_err(|error| {
        let offset = error.span().map_or(0, |it| it.start);
        fail(
            places.of(offset),
            Problem::Toml(error.message().trim().to_owned()),
        )
    })?;
    let mut file = SceneFile::empty(path);
    document
        .fill(&mut file, &places)
        .map_err(|(place, problem)| fail(place, problem))?;
    Ok(file)
}

/// Where the lines of a text begin, so that places are found fast.
pub(super) struct Places<'a> {
    text: &'a str,
    lines: Vec<usize>,
}

impl<'a> Places<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        let after_feeds = text.bytes().enumerate().filter(|it| it.1 == b'\n');
        Self {
            text,
            lines: std::iter::once(0)
                .chain(after_feeds.map(|it| it.0 + 1))
                .collect(),
        }
    }

    pub(super) fn of(&self, offset: usize) -> Place {
        let line = self.lines.partition_point(|&start| start <= offset);
        let start = self.lines[line - 1];
        let in_line = Place::of(&self.text.as_bytes()[start..], offset - start);
        Place {
            line: line as u32,
            column: in_line.column,
        }
    }

    fn start<T>(&self, spanned: &Spanned<T>) -> Place {
        self.of(spanned.span().start)
    }
}

/// A number, written as a float or as an integer of any size.
#[derive(Clone, Copy)]
pub(super) struct Number(f64);

/// A [`Visitor`]'s methods for numbers of all sizes.
macro_rules! visit_numbers {
    ($value:ty, $new:expr) => {
        visit_numbers!(@ $value, $new, visit_f64 f64, visit_i64 i64, visit_u64 u64, visit_i128 i128,
            visit_u128 u128);
    };
    (@ $value:ty, $new:expr, $($method:ident $number:ty),*) => {
        $(fn $method<E>(self, number: $number) -> Result<$value, E> {
            Ok($new(number as f64))
        })*
    };
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NumberVisitor;

        impl Visitor<'_> for NumberVisitor {
            type Value = Number;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number")
            }

            visit_numbers!(Number, Number);
        }

        deserializer.deserialize_any(NumberVisitor)
    }
}

pub(super) type Real = Spanned<Number>;
pub(super) type Point = Spanned<[Number; 3]>;

/// A table that may hold shapes of all kinds beside its own fields.
macro_rules! with_shapes {
    ($(#[$meta:meta])* struct $name:ident { $($fields:tt)* }) => {
        $(#[$meta])*
        struct $name {
            $($fields)*
            #[serde(default)]
            sphere: Vec<Spanned<SphereFields>>,
            #[serde(default)]
            plane: Vec<Spanned<PlaneFields>>,
            #[serde(default)]
            polygon: Vec<Spanned<PolygonFields>>,
            #[serde(default)]
            triangle: Vec<Spanned<TriangleFields>>,
            #[serde(default)]
            patch: Vec<Spanned<PatchFields>>,
            #[serde(default, rename = "box")]
            cuboid: Vec<Spanned<BoxFields>>,
            #[serde(default)]
            frustum: Vec<Spanned<FrustumFields>>,
            #[serde(default)]
            cylinder: Vec<Spanned<CylinderFields>>,
            #[serde(default)]
            cone: Vec<Spanned<ConeFields>>,
            #[serde(default)]
            ellipsoid: Vec<Spanned<EllipsoidFields>>,
            #[serde(default)]
            paraboloid: Vec<Spanned<ParaboloidFields>>,
            #[serde(default)]
            hyperboloid: Vec<Spanned<HyperboloidFields>>,
            #[serde(default)]
            quadric: Vec<Spanned<QuadricFields>>,
            #[serde(default)]
            torus: Vec<Spanned<TorusFields>>,
            #[serde(default)]
            csg: Vec<Spanned<CsgFields>>,
            #[serde(default)]
            instance: Vec<Spanned<InstanceFields>>,
        }

        impl $name {
            /// Its shapes, in no order.
            fn gather<'f>(
                &'f self,
                check: &Checker<'_>,
                found: &mut Vec<Entry<'f>>,
            ) -> Result<(), Located> {
                check.gather(&self.sphere, found)?;
                check.gather(&self.plane, found)?;
                check.gather(&self.polygon, found)?;
                check.gather(&self.triangle, found)?;
                check.gather(&self.patch, found)?;
                check.gather(&self.cuboid, found)?;
                check.gather(&self.frustum, found)?;
                check.gather(&self.cylinder, found)?;
                check.gather(&self.cone, found)?;
                check.gather(&self.ellipsoid, found)?;
                check.gather(&self.paraboloid, found)?;
                check.gather(&self.hyperboloid, found)?;
                check.gather(&self.quadric, found)?;
                check.gather(&self.torus, found)?;
                Ok(())
            }
        }
    };
}

with_shapes! {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Document {
        size: Option<Spanned<[u64; 2]>>,
        depth: Option<Spanned<u64>>,
        #[serde(default = "yes")]
        shadows: bool,
        background: Option<Point>,
        ambient: Option<Point>,
        camera: Option<Spanned<CameraFields>>,
        #[serde(default)]
        light: Vec<Spanned<LightFields>>,
        #[serde(default)]
        material: HashMap<Spanned<String>, MaterialFields>,
        #[serde(default)]
        texture: HashMap<Spanned<String>, TextureFields>,
        #[serde(default)]
        group: HashMap<Spanned<String>, GroupFields>,
    }
}

with_shapes! {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct GroupFields {}
}

/// A solid that is joined of others.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CsgFields {
    expression: Spanned<String>,
    solid: HashMap<Spanned<String>, SolidFields>,
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum SolidFields {
    Sphere(SphereFields),
    Plane(PlaneFields),
    Box(BoxFields),
    Frustum(FrustumFields),
    Cylinder(CylinderFields),
    Cone(ConeFields),
    Ellipsoid(EllipsoidFields),
    Paraboloid(ParaboloidFields),
    Hyperboloid(HyperboloidFields),
    Quadric(Box<QuadricFields>),
    Torus(TorusFields),
}

impl SolidFields {
    fn fields(&self) -> &dyn ShapeFields {
        match self {
            Self::Sphere(it) => it,
            Self::Plane(it) => it,
            Self::Box(it) => it,
            Self::Frustum(it) => it,
            Self::Cylinder(it) => it,
            Self::Cone(it) => it,
            Self::Ellipsoid(it) => it,
            Self::Paraboloid(it) => it,
            Self::Hyperboloid(it) => it,
            Self::Quadric(it) => &**it,
            Self::Torus(it) => it,
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct InstanceFields {
    of: Spanned<String>,
    scale: Option<Spanned<Factors>>,
    rotate: Option<Point>,
    translate: Option<Point>,
    matrix: Option<Spanned<[[Number; 4]; 3]>>,
}

/// Three numbers, or one for three.
struct Factors([Number; 3]);

impl<'de> Deserialize<'de> for Factors {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct FactorsVisitor;

        impl<'de> Visitor<'de> for FactorsVisitor {
            type Value = Factors;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number or three numbers")
            }

            visit_numbers!(Factors, |number| Factors([Number(number); 3]));

            fn visit_seq<A: SeqAccess<'de>>(self, numbers: A) -> Result<Factors, A::Error> {
                let numbers = SeqAccessDeserializer::new(numbers);
                <[Number; 3]>::deserialize(numbers).map(Factors)
            }
        }

        deserializer.deserialize_any(FactorsVisitor)
    }
}

fn yes() -> bool {
    true
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraFields {
    eye: Point,
    target: Point,
    up: Option<Point>,
    fov: Option<Real>,
    frustum: Option<WindowFields>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WindowFields {
    left: Real,
    right: Real,
    bottom: Real,
    top: Real,
    distance: Real,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LightFields {
    position: Point,
    color: Option<Point>,
    #[serde(default = "yes")]
    shadows: bool,
    edges: Option<Spanned<[Point; 2]>>,
    radius: Option<Real>,
    samples: Option<Spanned<u64>>,
    adaptive: Option<Spanned<u64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MaterialFields {
    color: Option<Point>,
    ambient: Option<Real>,
    diffuse: Option<Real>,
    specular: Option<Real>,
    shininess: Option<Real>,
    reflectance: Option<Real>,
    transmittance: Option<Real>,
    ior: Option<Real>,
    filter: Option<Point>,
    absorption: Option<Point>,
    checker: Option<Spanned<CheckerFields>>,
    stripes: Option<Spanned<StripesFields>>,
    image: Option<Spanned<ImageFields>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CheckerFields {
    colors: [Point; 2],
    size: Real,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StripesFields {
    colors: [Point; 2],
    direction: Point,
    size: Real,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ImageFields {
    texture: Spanned<String>,
    repeat: Option<Spanned<[Number; 2]>>,
    #[serde(default)]
    blend: bool,
}

/// A shape as it stands in the file.
struct Entry<'a> {
    start: usize,
    material: &'a Spanned<String>,
    shape: Shape,
}

/// The fields of one kind of shape.
trait ShapeFields {
    fn material(&self) -> &Spanned<String>;
    fn shape(&self, check: &Checker<'_>) -> Result<Shape, Located>;
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SphereFields {
    material: Spanned<String>,
    center: Point,
    radius: Real,
}

impl ShapeFields for SphereFields {
    fn material(&self) -> &Spanned<String> {
        &self.material
    }

    fn shape(&self, check: &Checker<'_>) -> Result<Shape, Located> {
        Ok(Shape::Sphere {
            center: check.point("a coordinate of the centre", &self.center)?,
            radius: check.length("the radius", &self.radius)?,
        })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PlaneFields {
    material: Spanned<String>,
    point: Point,
    normal: Point,
}

impl ShapeFields for PlaneFields {
    fn material(&self) -> &Spanned<String> {
        &self.material
    }

    fn shape(&self, check: &Checker<'_>) -> Result<Shape, Located> {
        Ok(Shape::Plane {
            point: check.point("a coordinate of the point", &self.point)?,
            normal: check.point("a component of the normal", &self.normal)?,
        })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PolygonFields {
    material: Spanned<String>,
    vertices: Spanned<Vec<Point>>,
}

impl ShapeFields for PolygonFields {
    fn material(&self) -> &Spanned<String> {
        &self.material
    }

    fn shape(&self, check: &Checker<'_>) -> Result<Shape, Located> {
        let vertices = self.vertices.get_ref();
        if vertices.len() > limits::VERTICES {
            let place = check.places.start(&vertices[limits::VERTICES]);
            return Err((place, too_many("corners", limits::VERTICES)));
        }
        if vertices.len() < 3 {
            let problem = Problem::Contradiction("a polygon has at least 3 vertices");
            return Err((check.places.start(&self.vertices), problem));
        }
        let vertices = vertices
            .iter()
            .map(|it| check.point("a coordinate of a vertex", it));
        Ok(Shape::Polygon {
            vertices: vertices.collect::<Result<_, _>>()?,
        })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TriangleFields {
    material: Spanned<String>,
    vertices: [Point; 3],
}

impl ShapeFields for TriangleFields {
    fn material(&self) -> &Spanned<String> {
        &self.material
    }

    fn shape(&self, check: &Checker<'_>) -> Result<Shape, Located> {
        Ok(Shape::Triangle {
            vertices: check.points("a coordinate of a vertex", &self.vertices)?,
        })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PatchFields {
    material: Spanned<String>,
    vertices: [Point; 3],
    normals: [Point; 3],
}

impl ShapeFields for PatchFields {
    fn material(&self) -> &Spanned<String> {
        &self.material
    }

    fn shape(&self, check: &Checker<'_>) -> Result<Shape, Located> {
        Ok(Shape::Patch {
            vertices: check.points("a coordinate of a vertex", &self.vertices)?,
            normals: check.points("a component of a normal", &self.normals)?,
        })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BoxFields {
    material: Spanned<String>,
    min: Point,
    max: Point,
}

impl ShapeFields for BoxFields {
    fn material(&self) -> &Spanned<String> {
        &self.material
    }

    fn shape(&self, check: &Checker<'_>) -> Result<Shape, Located> {
        Ok(Shape::Box {
            min: check.point("a coordinate of min", &self.min)?,
            max: check.point("a coordinate of max", &self.max)?,
        })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FrustumFields {
    material: Spanned<String>,
    base: Point,
    base_radius: Real,
    apex: Point,
    apex_radius: Real,
    #[serde(default)]
    closed: bool,
}

impl ShapeFields for FrustumFields {
    fn material(&self) -> &Spanned<String> {
        &self.material
    }

    fn shape(&self, check: &Checker<'_>) -> Result<Shape, Located> {
        Ok(frustum(
            check.point("a coordinate of the base", &self.base)?,
            check.length("the base radius", &self.base_radius)?,
            check.point("a coordinate of the apex", &self.apex)?,
            check.length("the apex radius", &self.apex_radius)?,
            self.closed,
        ))
    }
}

/// The side of a cone or cylinder, or all of it.
fn frustum(
    base: [f64; 3],
    base_radius: f64,
    apex: [f64; 3],
    apex_radius: f64,
    closed: bool,
) -> Shape {
    if !closed {
        return Shape::Frustum {
            base,
            base_radius,
            apex,
            apex_radius,
        };
    }
    let form = if base_radius == apex_radius {
        Quadric::Cylinder {
            base,
            apex,
            radius: base_radius,
        }
    } else {
        Quadric::Cone {
            base,
            base_radius,
            apex,
            apex_radius,
        }
    };
    Shape::Quadric { form, closed }
}

/// A frustum of equal radii.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CylinderFields {
    material: Spanned<String>,
    base: Point,
    apex: Point,
    radius: Real,
    #[serde(default)]
    closed: bool,
}

impl ShapeFields for CylinderFields {
    fn material(&self) -> &Spanned<String> {
        &self.material
    }

    fn shape(&self, check: &Checker<'_>) -> Result<Shape, Located> {
        let base = check.point("a coordinate of the base", &self.base)?;
        let apex = check.point("a coordinate of the apex", &self.apex)?;
        let radius = check.length("the radius", &self.radius)?;
        Ok(frustum(base, radius, apex, radius, self.closed))
    }
}

/// A frustum that ends in a point.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ConeFields {
    material: Spanned<String>,
    base: Point,
    base_radius: Real,
    apex: Point,
    #[serde(default)]
    closed: bool,
}

impl ShapeFields for ConeFields {
    fn material(&self) -> &Spanned<String> {
        &self.material
    }

    fn shape(&self, check: &Checker<'_>) -> Result<Shape, Located> {
        let base = check.point("a coordinate of the base", &self.base)?;
        let base_radius = check.length("the base radius", &self.base_radius)?;
        let apex = check.point("a coordinate of the apex", &self.apex)?;
        Ok(frustum(base, base_radius, apex, 0.0, self.closed))
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct EllipsoidFields {
    material: Spanned<String>,
    center: Point,
    radii: Point,
}

impl ShapeFields for EllipsoidFields {
    fn material(&self) -> &Spanned<String> {
        &self.material
    }

    fn shape(&self, check: &Checker<'_>) -> Result<Shape, Located> {
        let form = Quadric::Ellipsoid {
            center: check.point("a coordinate of the centre", &self.center)?,
            radii: check.point("a radius", &self.radii)?,
        };
        Ok(Shape::Quadric {
            form,
            closed: false,
        })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ParaboloidFields {
    material: Spanned<String>,
    tip: Point,
    end: Point,
    radius: Real,
    #[serde(default)]
    closed: bool,
}

impl ShapeFields for ParaboloidFields {
    fn material(&self) -> &Spanned<String> {
        &self.material
    }

    fn shape(&self, check: &Checker<'_>) -> Result<Shape, Located> {
        let form = Quadric::Paraboloid {
            tip: check.point("a coordinate of the tip", &self.tip)?,
            end: check.point("a coordinate of the end", &self.end)?,
            radius: check.length("the radius", &self.radius)?,
        };
        Ok(Shape::Quadric {
            form,
            closed: self.closed,
        })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HyperboloidFields {
    material: Spanned<String>,
    base: Point,
    apex: Point,
    radius: Real,
    waist: Option<Real>,
    gap: Option<Real>,
    #[serde(default)]
    closed: bool,
}

impl ShapeFields for HyperboloidFields {
    fn material(&self) -> &Spanned<String> {
        &self.material
    }

    fn shape(&self, check: &Checker<'_>) -> Result<Shape, Located> {
        let base = check.point("a coordinate of the base", &self.base)?;
        let apex = check.point("a coordinate of the apex", &self.apex)?;
        let radius = check.length("the radius", &self.radius)?;
        let form = match (&self.waist, &self.gap) {
            (Some(waist), None) => Quadric::Hyperboloid {
                base,
                apex,
                radius,
                waist: check.length("the waist", waist)?,
            },
            (None, Some(gap)) => Quadric::TwoSheets {
                base,
                apex,
                radius,
                gap: check.length("the gap", gap)?,
            },
            _ => {
                let problem =
                    "a hyperboloid has either a `waist`, for one sheet, or a `gap`, for two";
                let place = check.places.start(&self.base);
                return Err((place, Problem::Contradiction(problem)));
            }
        };
        Ok(Shape::Quadric {
            form,
            closed: self.closed,
        })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct QuadricFields {
    material: Spanned<String>,
    center: Point,
    squares: Option<Point>,
    products: Option<Point>,
    linear: Option<Point>,
    constant: Option<Real>,
    min: Option<Point>,
    max: Option<Point>,
    axis: Option<Point>,
    from: Option<Real>,
    to: Option<Real>,
    #[serde(default)]
    closed: bool,
}

impl ShapeFields for QuadricFields {
    fn material(&self) -> &Spanned<String> {
        &self.material
    }

    fn shape(&self, check: &Checker<'_>) -> Result<Shape, Located> {
        let point_or = |what, point: &Option<Point>, default: f64| {
            let point = point.as_ref();
            point.map_or(Ok([default; 3]), |it| check.point(what, it))
        };
        let length_or = |what, number: &Option<Real>, default: f64| {
            let number = number.as_ref();
            number.map_or(Ok(default), |it| check.length(what, it))
        };
        if let (None, Some(plane)) = (&self.axis, self.from.as_ref().or(self.to.as_ref())) {
            let problem = "planes at `from` and `to` need an `axis`";
            let place = check.places.start(plane);
            return Err((place, Problem::Contradiction(problem)));
        }
        let infinity = f64::INFINITY;
        let form = Quadric::General(Box::new(General {
            center: check.point("a coordinate of the centre", &self.center)?,
            squares: point_or("a coefficient of the squares", &self.squares, 0.0)?,
            products: point_or("a coefficient of the products", &self.products, 0.0)?,
            linear: point_or("a linear coefficient", &self.linear, 0.0)?,
            constant: length_or("the constant", &self.constant, 0.0)?,
            min: point_or("a coordinate of min", &self.min, -infinity)?,
            max: point_or("a coordinate of max", &self.max, infinity)?,
            axis: point_or("a component of the axis", &self.axis, 0.0)?,
            from: length_or("the distance of the first plane", &self.from, -infinity)?,
            to: length_or("the distance of the second plane", &self.to, infinity)?,
        }));
        Ok(Shape::Quadric {
            form,
            closed: self.closed,
        })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TorusFields {
    material: Spanned<String>,
    center: Point,
    axis: Point,
    major: Real,
    minor: Real,
}

impl ShapeFields for TorusFields {
    fn material(&self) -> &Spanned<String> {
        &self.material
    }

    fn shape(&self, check: &Checker<'_>) -> Result<Shape, Located> {
        Ok(Shape::Torus {
            center: check.point("a coordinate of the centre", &self.center)?,
            axis: check.point("a component of the axis", &self.axis)?,
            major: check.length("the major radius", &self.major)?,
            minor: check.length("the minor radius", &self.minor)?,
        })
    }
}

/// Checks numbers and remembers where they stand.
pub(super) struct Checker<'a> {
    pub(super) places: &'a Places<'a>,
}

impl Checker<'_> {
    pub(super) fn real(&self, what: &str, number: &Real, range: Range) -> Result<f64, Located> {
        range
            .check(what, number.get_ref().0)
            .map_err(at(self.places.start(number)))
    }

    pub(super) fn length(&self, what: &str, number: &Real) -> Result<f64, Located> {
        self.real(what, number, Range::Length)
    }

    pub(super) fn real_or(
        &self,
        what: &str,
        number: &Option<Real>,
        range: Range,
        default: f64,
    ) -> Result<f64, Located> {
        number
            .as_ref()
            .map_or(Ok(default), |it| self.real(what, it, range))
    }

    pub(super) fn triple(
        &self,
        what: &str,
        numbers: &Point,
        range: Range,
    ) -> Result<[f64; 3], Located> {
        for number in numbers.get_ref() {
            range
                .check(what, number.0)
                .map_err(at(self.places.start(numbers)))?;
        }
        Ok(numbers.get_ref().map(|it| it.0))
    }

    fn point(&self, what: &str, point: &Point) -> Result<[f64; 3], Located> {
        self.triple(what, point, Range::Length)
    }

    pub(super) fn color(
        &self,
        what: &str,
        color: &Option<Point>,
        default: f64,
    ) -> Result<[f64; 3], Located> {
        color.as_ref().map_or(Ok([default; 3]), |it| {
            self.triple(what, it, Range::Brightness)
        })
    }

    fn points(&self, what: &str, points: &[Point; 3]) -> Result<[[f64; 3]; 3], Located> {
        let [a, b, c] = points;
        Ok([
            self.point(what, a)?,
            self.point(what, b)?,
            self.point(what, c)?,
        ])
    }

    /// Adds the shapes of one kind to those found.
    fn gather<'f, F: ShapeFields>(
        &self,
        entries: &'f [Spanned<F>],
        found: &mut Vec<Entry<'f>>,
    ) -> Result<(), Located> {
        for entry in entries {
            found.push(Entry {
                start: entry.span().start,
                material: entry.get_ref().material(),
                shape: entry.get_ref().shape(self)?,
            });
        }
        Ok(())
    }

    /// Instances, and the groups that they name.
    fn instances(
        &self,
        all: &[Spanned<InstanceFields>],
        groups: &HashMap<&str, usize>,
    ) -> Result<Vec<Instance>, Located> {
        all.iter()
            .map(|it| {
                let (place, fields) = (self.places.start(it), it.get_ref());
                let name = fields.of.get_ref().as_str();
                let group = *groups.get(name).ok_or_else(|| {
                    let problem = Problem::UnknownGroup(excerpt(name.as_bytes()));
                    (self.places.start(&fields.of), problem)
                })?;
                let (axes, translation) = fields.read(self)?;
                Ok(Instance {
                    place,
                    group,
                    axes,
                    translation,
                })
            })
            .collect()
    }

    /// Where something stands.
    pub(super) fn start<T>(&self, spanned: &Spanned<T>) -> Place {
        self.places.start(spanned)
    }

    /// Width and height of a picture.
    pub(super) fn size(&self, size: &Spanned<[u64; 2]>) -> Result<[u32; 2], Located> {
        let limit = limits::SIDE as usize;
        let side = |it| self.whole("pixels to a side", it, limit, self.start(size));
        let [width, height] = *size.get_ref();
        Ok([side(width)? as u32, side(height)? as u32])
    }

    /// How many rays a chain has.
    pub(super) fn depth(&self, depth: &Spanned<u64>) -> Result<usize, Located> {
        let place = self.start(depth);
        self.whole("rays in a chain", *depth.get_ref(), limits::DEPTH, place)
    }

    fn whole(
        &self,
        what: &'static str,
        number: u64,
        most: usize,
        place: Place,
    ) -> Result<usize, Located> {
        match usize::try_from(number) {
            Ok(0) => Err((
                place,
                Problem::Unexpected {
                    expected: format!("a number of {what} from 1 on"),
                    found: "0".to_owned(),
                },
            )),
            Ok(number) if number <= most => Ok(number),
            _ => Err((place, Problem::TooMany { what, limit: most })),
        }
    }
}

impl Document {
    fn fill(self, file: &mut SceneFile, places: &Places<'_>) -> Result<(), Located> {
        let check = Checker { places };
        if let Some(size) = &self.size {
            file.size = Some(check.size(size)?);
        }
        file.depth = match &self.depth {
            Some(depth) => check.depth(depth)?,
            None => DEFAULT_DEPTH,
        };
        file.background = check.color("a component of the background", &self.background, 0.0)?;
        file.ambient = check.color("a component of the ambient light", &self.ambient, 0.0)?;
        if let Some(camera) = &self.camera {
            file.camera = Some(camera.get_ref().read(&check, places.start(camera))?);
        }
        if self.light.len() > limits::LIGHTS {
            let place = places.start(&self.light[limits::LIGHTS]);
            return Err((place, too_many("lights", limits::LIGHTS)));
        }
        for light in &self.light {
            let light = light
                .get_ref()
                .read(&check, places.start(light), self.shadows)?;
            file.lights.push(light);
        }
        let names = self.read_materials(file, &check)?;
        self.read_objects(file, &check, &names)
    }

    /// The materials, and which of them each name means.
    fn read_materials(
        &self,
        file: &mut SceneFile,
        check: &Checker<'_>,
    ) -> Result<HashMap<String, usize>, Located> {
        let mut materials: Vec<_> = self.material.iter().collect();
        materials.sort_by_key(|(name, _)| name.span().start);
        if materials.len() > limits::MATERIALS {
            let place = check.places.start(materials[limits::MATERIALS].0);
            return Err((place, too_many("materials", limits::MATERIALS)));
        }
        let folder = file.path.parent().unwrap_or(Path::new(""));
        let textures = read_all(&self.texture, check, folder, &mut { limits::TEXELS })?;
        let textures = textures.into_iter().collect();
        let mut names = HashMap::new();
        for (name, fields) in materials {
            let material = fields.read(check, name, &textures)?;
            names.insert(name.get_ref().clone(), file.materials.len());
            file.materials.push(material);
        }
        Ok(names)
    }

    fn read_objects(
        &self,
        file: &mut SceneFile,
        check: &Checker<'_>,
        names: &HashMap<String, usize>,
    ) -> Result<(), Located> {
        let mut reader = ObjectReader {
            check,
            names,
            count: 0,
        };
        let mut found = Vec::new();
        self.gather(check, &mut found)?;
        file.objects = reader.objects(found)?;
        file.solids = reader.solids(&self.csg)?;
        let mut groups: Vec<_> = self.group.iter().collect();
        groups.sort_by_key(|(name, _)| name.span().start);
        let places: HashMap<_, _> = (groups.iter().enumerate())
            .map(|(place, (name, _))| (name.get_ref().as_str(), place))
            .collect();
        let mut within = Vec::new();
        for (name, fields) in groups {
            let mut found = Vec::new();
            fields.gather(check, &mut found)?;
            within.push(check.instances(&fields.instance, &places)?);
            file.groups.push(Group {
                place: check.places.start(name),
                name: name.get_ref().clone(),
                objects: reader.objects(found)?,
                solids: reader.solids(&fields.csg)?,
            });
        }
        let top = check.instances(&self.instance, &places)?;
        file.instances = placed(&file.groups, &within, top)?;
        file.check_patterns()
    }
}

/// Makes objects of what stands in the file.
struct ObjectReader<'a> {
    check: &'a Checker<'a>,
    /// Which material each name means.
    names: &'a HashMap<String, usize>,
    /// Of objects so far.
    count: usize,
}

impl ObjectReader<'_> {
    fn object(&mut self, entry: Entry<'_>) -> Result<Object, Located> {
        if self.count == limits::OBJECTS {
            let place = self.check.places.of(entry.start);
            return Err((place, too_many("objects", limits::OBJECTS)));
        }
        let name = entry.material;
        let material = *self.names.get(name.get_ref()).ok_or_else(|| {
            let problem = Problem::UnknownMaterial(excerpt(name.get_ref().as_bytes()));
            (self.check.places.start(name), problem)
        })?;
        let index = self.count;
        self.count += 1;
        Ok(Object {
            place: self.check.places.of(entry.start),
            index,
            material,
            shape: entry.shape,
        })
    }

    /// In file order.
    fn objects(&mut self, mut found: Vec<Entry<'_>>) -> Result<Vec<Object>, Located> {
        found.sort_by_key(|it| it.start);
        found.into_iter().map(|it| self.object(it)).collect()
    }

    fn solids(&mut self, all: &[Spanned<CsgFields>]) -> Result<Vec<Solid>, Located> {
        all.iter()
            .map(|it| self.solid(it.get_ref(), self.check.places.start(it)))
            .collect()
    }

    fn solid(&mut self, fields: &CsgFields, place: Place) -> Result<Solid, Located> {
        let at = self.check.places.start(&fields.expression);
        let (steps, names) = solid::expression(fields.expression.get_ref(), at)?;
        let unused = fields
            .solid
            .keys()
            .filter(|it| !names.contains(&it.get_ref().as_str()));
        if let Some(name) = unused.min_by_key(|it| it.span().start) {
            let problem = Problem::UnusedSolid(excerpt(name.get_ref().as_bytes()));
            return Err((self.check.places.start(name), problem));
        }
        let mut leaves = Vec::new();
        for name in names {
            let (key, fields) = (fields.solid)
                .get_key_value(name)
                .ok_or_else(|| (at, Problem::UnknownSolid(excerpt(name.as_bytes()))))?;
            let fields = fields.fields();
            let entry = Entry {
                start: key.span().start,
                material: fields.material(),
                shape: fields.shape(self.check)?,
            };
            if let Some(problem) = solid::lacks_inside(&entry.shape) {
                return Err((self.check.places.start(key), problem));
            }
            leaves.push(self.object(entry)?);
        }
        Ok(Solid {
            place,
            leaves,
            steps,
        })
    }
}

/// All instances in the world, of those that stand in it and those in each group.
fn placed(
    groups: &[Group],
    within: &[Vec<Instance>],
    top: Vec<Instance>,
) -> Result<Vec<Instance>, Located> {
    // A group whose groups are all sorted out is, too; what is left over places itself.
    let mut users = vec![Vec::new(); groups.len()];
    let mut open: Vec<_> = within.iter().map(Vec::len).collect();
    for (group, instances) in within.iter().enumerate() {
        instances.iter().for_each(|it| users[it.group].push(group));
    }
    let mut done: Vec<_> = (0..groups.len()).filter(|&it| open[it] == 0).collect();
    while let Some(group) = done.pop() {
        for &user in &users[group] {
            open[user] -= 1;
            if open[user] == 0 {
                done.push(user);
            }
        }
    }
    // Of those that are left over, one that is only on the way to a circle has a group beyond it.
    if let Some(start) = open.iter().position(|&it| it > 0) {
        let mut group = start;
        for _ in 0..groups.len() {
            let next = within[group].iter().find(|it| open[it.group] > 0);
            group = next.map_or(group, |it| it.group);
        }
        let Group { place, name, .. } = &groups[group];
        return Err((*place, Problem::Cycle(excerpt(name.as_bytes()))));
    }
    // Each with the place of the one in the world that brings it.
    let mut waiting: Vec<_> = top.into_iter().rev().map(|it| (it.place, it)).collect();
    let mut placed = Vec::new();
    let mut count = 0;
    while let Some((top, it)) = waiting.pop() {
        count += 1;
        if count > limits::INSTANCES {
            return Err((top, too_many("instances", limits::INSTANCES)));
        }
        let outer = (it.axes, it.translation);
        for inner in within[it.group].iter().rev() {
            let (axes, translation) = solid::compose(outer, (inner.axes, inner.translation));
            for &number in axes.as_flattened().iter().chain(&translation) {
                let what = "a number of a placement in a placement";
                Range::Length.check(what, number).map_err(at(top))?;
            }
            let inner = Instance {
                axes,
                translation,
                ..*inner
            };
            waiting.push((top, inner));
        }
        let group = &groups[it.group];
        if !(group.objects.is_empty() && group.solids.is_empty()) {
            placed.push(it);
        }
    }
    // A geometry has the instances of a group next to each other.
    placed.sort_by_key(|it| it.group);
    Ok(placed)
}

impl InstanceFields {
    /// The axes and the translation: scaled, then turned, then moved.
    fn read(&self, check: &Checker<'_>) -> Result<([[f64; 3]; 3], [f64; 3]), Located> {
        if let Some(matrix) = &self.matrix {
            let parts = [
                self.scale.is_some(),
                self.rotate.is_some(),
                self.translate.is_some(),
            ];
            let place = check.places.start(matrix);
            if parts.contains(&true) {
                let problem = "an instance has a `matrix`, or `scale`, `rotate` and `translate`";
                return Err((place, Problem::Contradiction(problem)));
            }
            let rows = matrix.get_ref();
            for Number(number) in rows.iter().flatten() {
                let what = "a number of the matrix";
                Range::Length.check(what, *number).map_err(at(place))?;
            }
            let column = |axis: usize| rows.map(|row| row[axis].0);
            return Ok(([column(0), column(1), column(2)], column(3)));
        }
        let mut axes = [[0.0; 3]; 3];
        for (axis, column) in axes.iter_mut().enumerate() {
            column[axis] = match &self.scale {
                Some(scale) => Range::Length
                    .check("a factor", scale.get_ref().0[axis].0)
                    .map_err(at(check.places.start(scale)))?,
                None => 1.0,
            };
        }
        let point = |what, point: &Option<Point>| match point {
            Some(point) => check.point(what, point),
            None => Ok([0.0; 3]),
        };
        let turn = solid::rotation(point("an angle", &self.rotate)?);
        let translation = point("a component of the translation", &self.translate)?;
        Ok(solid::compose((turn, translation), (axes, [0.0; 3])))
    }
}

impl CameraFields {
    fn read(&self, check: &Checker<'_>, place: Place) -> Result<Camera, Located> {
        let lens = match (&self.fov, &self.frustum) {
            (Some(fov), None) => Lens::Vertical {
                degrees: check.real("the field of view", fov, Range::Angle)?,
            },
            (None, Some(window)) => {
                let edge = |it| check.length("an edge of the frustum", it);
                Lens::Frustum {
                    left: edge(&window.left)?,
                    right: edge(&window.right)?,
                    bottom: edge(&window.bottom)?,
                    top: edge(&window.top)?,
                    distance: check.length("the distance", &window.distance)?,
                }
            }
            (None, None) => {
                let problem = "a camera needs either `fov` or `frustum`";
                return Err((place, Problem::Contradiction(problem)));
            }
            (Some(fov), Some(_)) => {
                let problem = "a camera has either `fov` or `frustum`, not both";
                return Err((check.places.start(fov), Problem::Contradiction(problem)));
            }
        };
        let up = self.up.as_ref();
        Ok(Camera {
            place,
            eye: check.point("a coordinate of the eye", &self.eye)?,
            target: check.point("a coordinate of the target", &self.target)?,
            up: up.map_or(Ok([0.0, 1.0, 0.0]), |it| {
                check.point("a component of up", it)
            })?,
            lens,
        })
    }
}

impl LightFields {
    /// `shadows` is whether lights cast any.
    pub(super) fn read(
        &self,
        check: &Checker<'_>,
        place: Place,
        shadows: bool,
    ) -> Result<Light, Located> {
        Ok(Light {
            place,
            position: check.point("a coordinate of the light", &self.position)?,
            color: check.color("a component of the light's colour", &self.color, 1.0)?,
            shadows: shadows && self.shadows,
            area: self.area(check)?,
        })
    }

    fn area(&self, check: &Checker<'_>) -> Result<Option<Area>, Located> {
        fn fail<T>(place: Place, problem: &'static str) -> Result<T, Located> {
            Err((place, Problem::Contradiction(problem)))
        }
        let extent = match (&self.edges, &self.radius) {
            (None, None) => {
                if let Some(it) = self.samples.as_ref().or(self.adaptive.as_ref()) {
                    let problem =
                        "`samples` and `adaptive` are for lights with `edges` or a `radius`";
                    return fail(check.start(it), problem);
                }
                return Ok(None);
            }
            (Some(edges), None) => {
                let [a, b] = edges.get_ref();
                let edge = |it| check.point("a component of an edge", it);
                Extent::Rect {
                    edges: [edge(a)?, edge(b)?],
                }
            }
            (None, Some(radius)) => Extent::Disk {
                radius: check.real("the radius of the light", radius, Range::Radius)?,
            },
            (Some(edges), Some(_)) => {
                let problem = "a light has either `edges` or a `radius`, not both";
                return fail(check.start(edges), problem);
            }
        };
        // How often a side is halved.
        let levels = |it: &Option<Spanned<u64>>, default| match it {
            None => Ok(default),
            Some(it) if [1, 2, 4, 8, 16].contains(it.get_ref()) => Ok(it.get_ref().ilog2() as u8),
            Some(it) => fail(
                check.start(it),
                "a light has 1, 2, 4, 8 or 16 samples to a side",
            ),
        };
        let most = levels(&self.samples, 3)?;
        let least = levels(&self.adaptive, most)?;
        match &self.adaptive {
            Some(it) if least > most => fail(check.start(it), "`adaptive` is more than `samples`"),
            _ => Ok(Some(Area {
                extent,
                samples: Samples { least, most },
            })),
        }
    }
}

impl MaterialFields {
    /// `textures` are those that there are, by name.
    pub(super) fn read(
        &self,
        check: &Checker<'_>,
        name: &Spanned<String>,
        textures: &HashMap<&str, Arc<Texture>>,
    ) -> Result<Material, Located> {
        use Range::{Brightness, Exponent, Refraction, Share};
        let transmittance = check.real_or("the transmittance", &self.transmittance, Share, 0.0)?;
        let ior = check.real_or("the index of refraction", &self.ior, Refraction, 1.5)?;
        let filter = self.filter.as_ref();
        let absorption = self.absorption.as_ref();
        if let (Some(needless), false) = (filter.or(absorption), transmittance > 0.0) {
            let problem = "what lets nothing through has neither `filter` nor `absorption`";
            return Err((check.start(needless), Problem::Contradiction(problem)));
        }
        Ok(Material {
            place: check.start(name),
            name: name.get_ref().clone(),
            pattern: self.pattern(check, name, textures)?,
            filter: filter.map_or(Ok([1.0; 3]), |it| {
                check.triple("a component of the filter", it, Share)
            })?,
            absorption: absorption.map_or(Ok([0.0; 3]), |it| {
                check.triple("a component of the absorption", it, Brightness)
            })?,
            color: check.color("a component of the colour", &self.color, 1.0)?,
            ambient: check.real_or("the ambient share", &self.ambient, Brightness, 1.0)?,
            diffuse: check.real_or("the diffuse share", &self.diffuse, Brightness, 1.0)?,
            specular: check.real_or("the specular share", &self.specular, Brightness, 0.0)?,
            shininess: check.real_or("the shininess", &self.shininess, Exponent, 50.0)?,
            reflectance: check.real_or("the reflectance", &self.reflectance, Share, 0.0)?,
            transmittance,
            ior: if transmittance > 0.0 { ior } else { 1.0 },
        })
    }
}

impl MaterialFields {
    fn pattern(
        &self,
        check: &Checker<'_>,
        name: &Spanned<String>,
        textures: &HashMap<&str, Arc<Texture>>,
    ) -> Result<Option<Pattern>, Located> {
        let colors = |[a, b]: &[Point; 2]| {
            let color = |it| check.triple("a component of a colour", it, Range::Brightness);
            Ok([color(a)?, color(b)?])
        };
        let size = |number: &Real| {
            let size = check.length("the size", number)?;
            if size > 0.0 {
                return Ok(size);
            }
            let problem = "what a pattern repeats is larger than 0";
            Err((check.start(number), Problem::Contradiction(problem)))
        };
        match (&self.color, &self.checker, &self.stripes, &self.image) {
            (_, None, None, None) => Ok(None),
            (None, Some(checker), None, None) => {
                let fields = checker.get_ref();
                Ok(Some(Pattern::Checker {
                    colors: colors(&fields.colors)?,
                    size: size(&fields.size)?,
                }))
            }
            (None, None, Some(stripes), None) => {
                let fields = stripes.get_ref();
                let direction = check.point("a component of the direction", &fields.direction)?;
                if direction.map(|it| it as f32) == [0.0; 3] {
                    let problem = "the direction of stripes is zero";
                    let place = check.start(&fields.direction);
                    return Err((place, Problem::Contradiction(problem)));
                }
                Ok(Some(Pattern::Stripes {
                    colors: colors(&fields.colors)?,
                    direction,
                    size: size(&fields.size)?,
                }))
            }
            (None, None, None, Some(image)) => {
                let ImageFields {
                    texture: wanted,
                    repeat,
                    blend,
                } = image.get_ref();
                let found = textures.get(wanted.get_ref().as_str());
                let texture = found.ok_or_else(|| {
                    let name = excerpt(wanted.get_ref().as_bytes());
                    (check.start(wanted), Problem::UnknownTexture(name))
                })?;
                let mut copies = [1.0; 2];
                if let Some(repeat) = repeat {
                    copies = repeat.get_ref().map(|it| it.0);
                    for count in copies {
                        let checked = Range::Length.check("the number of copies", count);
                        checked.map_err(at(check.start(repeat)))?;
                    }
                }
                Ok(Some(Pattern::Image {
                    texture: texture.clone(),
                    repeat: copies,
                    blend: *blend,
                }))
            }
            _ => {
                let problem = "a material has one of `color`, `checker`, `stripes` and `image`";
                Err((check.start(name), Problem::Contradiction(problem)))
            }
        }
    }
}

pub(super) fn too_many(what: &'static str, limit: usize) -> Problem {
    Problem::TooMany { what, limit }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene_file::texture::in_order;

    fn read(text: &str) -> Result<SceneFile, String> {
        parse(Path::new("t.toml"), text).map_err(|it| it.to_string())
    }

    #[test]
    fn groups_are_placed_in_the_world() {
        let ball = "material = 'a'\ncenter = [0, 0, 0]\nradius = 1\n";
        let file = read(&format!(
            "[material.a]\n[[group.ball.sphere]]\n{ball}\
             [[group.pair.instance]]\nof = 'ball'\ntranslate = [1, 0, 0]\n\
             [[group.pair.instance]]\nof = 'ball'\nscale = [1, 2, 3]\n\
             [[group.pair.sphere]]\n{ball}\
             [[instance]]\nof = 'pair'\nscale = 2\nrotate = [0, 0, 90]\ntranslate = [5, 6, 7]\n\
             [[instance]]\nof = 'ball'\nmatrix = [[1, 2, 3, 4], [5, 6, 7, 8], [9, 10, 11, 12]]\n\
             [[sphere]]\n{ball}",
        ))
        .unwrap();
        let names: Vec<_> = file.groups.iter().map(|it| it.name.as_str()).collect();
        assert_eq!(names, ["ball", "pair"]);
        let indices: Vec<_> = file.all_objects().map(|it| it.index).collect();
        assert_eq!(indices, [0, 1, 2]);
        let (y, x) = ([0.0, 2.0, 0.0], [-2.0, 0.0, 0.0]);
        let placed: Vec<_> = file
            .instances
            .iter()
            .map(|it| (it.group, it.axes, it.translation))
            .collect();
        let expected = [
            // To the right of the pair is above in the world.
            (0, [y, x, [0.0, 0.0, 2.0]], [5.0, 8.0, 7.0]),
            (0, [y, [-4.0, 0.0, 0.0], [0.0, 0.0, 6.0]], [5.0, 6.0, 7.0]),
            (
                0,
                [[1.0, 5.0, 9.0], [2.0, 6.0, 10.0], [3.0, 7.0, 11.0]],
                [4.0, 8.0, 12.0],
            ),
            (1, [y, x, [0.0, 0.0, 2.0]], [5.0, 6.0, 7.0]),
        ];
        assert_eq!(placed, expected);
    }

    #[test]
    fn solids_have_their_leaves_in_the_order_of_the_expression() {
        let file = read(
            "[material.a]\n[[csg]]\nexpression = 'ring - (ball + floor) & ball'\n\
             solid.ball.sphere = { material = 'a', center = [0, 0, 0], radius = 1 }\n\
             solid.floor.plane = { material = 'a', point = [0, 0, 0], normal = [0, 1, 0] }\n\
             [csg.solid.ring.torus]\nmaterial = 'a'\ncenter = [0, 0, 0]\naxis = [0, 1, 0]\n\
             major = 2\nminor = 1\n",
        )
        .unwrap();
        let [solid] = &file.solids[..] else {
            panic!("{:?}", file.solids);
        };
        let names: Vec<_> = solid.leaves.iter().map(|it| it.shape.name()).collect();
        assert_eq!(names, ["torus", "sphere", "plane", "sphere"]);
        use crate::scene_file::Step::{Difference, Intersection, Leaf, Union};
        assert_eq!(
            solid.steps,
            [Leaf, Leaf, Leaf, Union, Leaf, Intersection, Difference]
        );
    }

    #[test]
    fn groups_and_solids_that_are_none_are_errors_at_their_place() {
        let ball = "sphere = { material = 'a', center = [0, 0, 0], radius = 1 }";
        let csg = |rest: &str| format!("[material.a]\n[[csg]]\n{rest}");
        let mut doubling = format!("[material.a]\n[[group.g0.{}", "sphere]]\nmaterial = 'a'\n");
        doubling += "center = [0, 0, 0]\nradius = 1\n";
        for i in 1..20 {
            for _ in 0..2 {
                doubling += &format!("[[group.g{i}.instance]]\nof = 'g{}'\n", i - 1);
            }
        }
        doubling += "[[instance]]\nof = 'g19'\n";
        let cases = [
            (
                "[[instance]]\nof = 'b'".to_owned(),
                "2:6: no group is named `b`",
            ),
            (
                "[group.b]\n[[group.c.instance]]\nof = 'd'".to_owned(),
                "3:6: no group is named `d`",
            ),
            (
                "[[group.b.instance]]\nof = 'b'".to_owned(),
                "1:9: group `b` places itself",
            ),
            (
                "[[group.b.instance]]\nof = 'c'\n[[group.c.instance]]\nof = 'd'\n\
                 [[group.d.instance]]\nof = 'e'\n[[group.d.instance]]\nof = 'c'\n[group.e]"
                    .to_owned(),
                "5:9: group `d` places itself",
            ),
            (doubling, "82:1: more than 65536 instances"),
            (
                "[group.b]\n[[instance]]\nof = 'b'\nscale = [1, 2]".to_owned(),
                "4:9: invalid length 2, expected an array of length 3",
            ),
            (
                "[group.b]\n[[instance]]\nof = 'b'\nscale = 'x'".to_owned(),
                "4:9: invalid type: string \"x\", expected a number or three numbers",
            ),
            (
                "[group.b]\n[[instance]]\nof = 'b'\nscale = inf".to_owned(),
                "4:9: a factor is inf: not a finite 32-bit float",
            ),
            (
                "[group.b]\n[[group.c.instance]]\nof = 'b'\nscale = 1e30\n\
                 [[instance]]\nof = 'c'\nscale = 1e30"
                    .to_owned(),
                "5:1: a number of a placement in a placement is 1.0000000000000001e60: not a finite 32-bit float",
            ),
            (
                "[group.b]\n[[instance]]\nof = 'b'\nrotate = [0, nan, 0]".to_owned(),
                "4:10: an angle is NaN: not a finite 32-bit float",
            ),
            (
                "[group.b]\n[[instance]]\nof = 'b'\ntranslate = [0, 1e39, 0]".to_owned(),
                "4:13: a component of the translation is 1e39: not a finite 32-bit float",
            ),
            (
                "[group.b]\n[[instance]]\nof = 'b'\n\
                 matrix = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, nan, 0]]"
                    .to_owned(),
                "4:10: a number of the matrix is NaN: not a finite 32-bit float",
            ),
            (
                "[group.b]\n[[instance]]\nof = 'b'\nscale = 2\n\
                 matrix = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]"
                    .to_owned(),
                "5:10: an instance has a `matrix`, or `scale`, `rotate` and `translate`",
            ),
            (
                csg(&format!("expression = 'b + c'\nsolid.b.{ball}")),
                "3:14: no solid is named `c` here",
            ),
            (
                csg(&format!("expression = 'b'\nsolid.b.{ball}\nsolid.c.{ball}")),
                "5:7: solid `c` is not part of the expression",
            ),
            (
                csg(&format!("expression = 'b +'\nsolid.b.{ball}")),
                "3:14: expected the name of a solid or `(`, found `the end of the expression`",
            ),
            (
                csg("expression = 'b'\n\
                     solid.b.sphere = { material = 'c', center = [0, 0, 0], radius = 1 }"),
                "4:31: no material is named `c`",
            ),
            (
                csg("expression = 'b'\n\
                     solid.b.sphere = { material = 'a', center = [0, 0, 0], radius = -1 }"),
                "4:7: the radius of a solid sphere is above 0",
            ),
            (
                csg(
                    "expression = 'b'\nsolid.b.cylinder = { material = 'a', base = [0, 0, 0], \
                     apex = [0, 1, 0], radius = 1 }",
                ),
                "4:7: a solid must be closed: add `closed = true`",
            ),
            (
                csg(
                    "expression = 'b'\nsolid.b.paraboloid = { material = 'a', tip = [0, 0, 0], \
                     end = [0, 1, 0], radius = 1 }",
                ),
                "4:7: a solid must be closed: add `closed = true`",
            ),
            (
                csg("expression = 'b'\nsolid.b.triangle = {}"),
                "4:9: unknown variant `triangle`, expected one of `sphere`, `plane`, `box`, \
                 `frustum`, `cylinder`, `cone`, `ellipsoid`, `paraboloid`, `hyperboloid`, \
                 `quadric`, `torus`",
            ),
        ];
        for (text, message) in cases {
            assert_eq!(
                read(&text).unwrap_err(),
                format!("t.toml:{message}"),
                "{text}"
            );
        }
    }

    #[test]
    fn shapes_of_all_kinds_keep_their_order_in_the_file() {
        let file = read(
            "[material.a]\n\
             [[cone]]\nmaterial='a'\nbase=[0,0,0]\nbase_radius=1\napex=[0,1,0]\n\
             [[sphere]]\nmaterial='a'\ncenter=[0,0,0]\nradius=1\n\
             [[cone]]\nmaterial='a'\nbase=[0,0,0]\nbase_radius=2\napex=[0,1,0]\n",
        )
        .unwrap();
        let found: Vec<_> = file
            .objects
            .iter()
            .map(|it| (it.index, it.shape.name(), it.place.line))
            .collect();
        assert_eq!(
            found,
            [(0, "frustum", 2), (1, "sphere", 7), (2, "frustum", 11)]
        );
    }

    #[test]
    fn defaults_are_those_of_the_readme() {
        let file = read("[material.a]\n[[light]]\nposition=[1,2,3]\n[camera]\neye=[0,0,1]\ntarget=[0,0,0]\nfov=40").unwrap();
        assert_eq!(file.materials[0].color, [1.0; 3]);
        let it = &file.materials[0];
        assert_eq!(
            (it.ambient, it.diffuse, it.specular, it.shininess),
            (1.0, 1.0, 0.0, 50.0)
        );
        assert_eq!((it.reflectance, it.transmittance, it.ior), (0.0, 0.0, 1.0));
        assert_eq!(
            (file.lights[0].color, file.lights[0].shadows),
            ([1.0; 3], true)
        );
        let camera = file.camera.unwrap();
        assert_eq!(
            (camera.up, camera.lens),
            ([0.0, 1.0, 0.0], Lens::Vertical { degrees: 40.0 })
        );
        assert_eq!((file.depth, file.size), (5, None));
        assert_eq!((file.background, file.ambient), ([0.0; 3], [0.0; 3]));
    }

    #[test]
    fn shadows_are_off_for_all_lights_or_for_one() {
        let lights = "[[light]]\nposition=[1,2,3]\n[[light]]\nposition=[1,2,3]\nshadows=false";
        let of = |text: &str| -> Vec<bool> {
            read(text)
                .unwrap()
                .lights
                .iter()
                .map(|it| it.shadows)
                .collect()
        };
        assert_eq!(of(lights), [true, false]);
        assert_eq!(of(&format!("shadows=false\n{lights}")), [false, false]);
    }

    #[test]
    fn lights_may_have_an_extent() {
        let area = |fields: &str| {
            let text = format!("[[light]]\nposition = [1, 2, 3]\n{fields}");
            read(&text).unwrap().lights[0].area
        };
        assert_eq!(area(""), None);
        let disk = |least, most| {
            Some(Area {
                extent: Extent::Disk { radius: 2.0 },
                samples: Samples { least, most },
            })
        };
        assert_eq!(area("radius = 2"), disk(3, 3));
        assert_eq!(area("radius = 2\nsamples = 16"), disk(4, 4));
        assert_eq!(area("radius = 2\nsamples = 16\nadaptive = 2"), disk(1, 4));
        assert_eq!(area("radius = 2\nsamples = 1"), disk(0, 0));
        let edges = [[1.0, 0.0, 0.5], [0.0, 2.0, 0.0]];
        let found = area("edges = [[1, 0, 0.5], [0, 2, 0]]").unwrap();
        assert_eq!(found.extent, Extent::Rect { edges });
    }

    #[test]
    fn textures_share_the_pixels_that_a_file_may_have() {
        let text = "[texture.a]\nrows = ['rr', 'rr']\n[texture.b]\nrows = ['r']";
        let document: Document = ::toml::from_str(text).unwrap();
        let places = Places::new(text);
        let check = Checker { places: &places };
        let mut allowed = 5;
        for ((name, fields), left) in in_order(&document.texture).into_iter().zip([1, 0]) {
            let read = fields.read(&check, Path::new(""), name, &mut allowed);
            assert!(read.is_ok() && allowed == left);
        }
        let (name, fields) = in_order(&document.texture)[1];
        let (place, problem) = fields
            .read(&check, Path::new(""), name, &mut allowed)
            .unwrap_err();
        assert_eq!(
            format!("{place}: {problem}"),
            "4:8: more than 67108864 pixels in all textures"
        );
    }

    #[test]
    fn errors_name_the_place_and_the_reason() {
        let camera = |fields: &str| format!("[camera]\neye = [0, 0, 1]\n{fields}");
        let shape = |kind: &str, fields: &str| format!("[[{kind}]]\nmaterial = 'a'\n{fields}");
        let cases = [
            (
                "colour = 1",
                "1:1: unknown field `colour`, expected one of `size`, `depth`, `shadows`, \
                 `background`, `ambient`, `camera`, `light`, `material`, `texture`, `group`, \
                 `sphere`, `plane`, \
                 `polygon`, `triangle`, `patch`, `box`, `frustum`, `cylinder`, `cone`, `ellipsoid`, \
                 `paraboloid`, `hyperboloid`, `quadric`, `torus`, `csg`, `instance`",
            ),
            ("depth = 2\ndepth = 3", "2:1: duplicate key"),
            ("background = [1, 2", "1:19: unclosed array, expected `]`"),
            (
                "background = [1, 2]",
                "1:14: invalid length 2, expected an array of length 3",
            ),
            (
                "ambient = [1, 2, '']",
                "1:18: invalid type: string \"\", expected a number",
            ),
            (
                "ambient = [1, 2, nan]",
                "1:11: a component of the ambient light is NaN: not between 0 and 1048576",
            ),
            (
                "size = [0, 4]",
                "1:8: expected a number of pixels to a side from 1 on, found `0`",
            ),
            ("size = [4, 99999]", "1:8: more than 16384 pixels to a side"),
            (
                "size = [4, -9]",
                "1:12: invalid value: integer `-9`, expected u64",
            ),
            ("depth = 33", "1:9: more than 32 rays in a chain"),
            (
                "shadows = 1",
                "1:11: invalid type: integer `1`, expected a boolean",
            ),
            (&camera(""), "1:1: missing field `target`"),
            (
                &camera("target = [0, 0, 0]"),
                "1:1: a camera needs either `fov` or `frustum`",
            ),
            (
                &camera("target = [0, 0, 0]\nfov = 180"),
                "4:7: the field of view is 180.0: not between 0 and 180 degrees",
            ),
            (
                &camera(
                    "target = [0, 0, 0]\nfov = 18\n\
                     frustum = { left = 0, right = 1, bottom = 0, top = 1, distance = 1 }",
                ),
                "4:7: a camera has either `fov` or `frustum`, not both",
            ),
            (
                &camera("target = [0, 0, 0]\nzoom = 3"),
                "4:1: unknown field `zoom`, expected one of `eye`, `target`, `up`, `fov`, `frustum`",
            ),
            ("[material.a]\n[material.a]", "2:11: duplicate key"),
            (
                "[material.a]\nreflectance = 1.5",
                "2:15: the reflectance is 1.5: not between 0 and 1",
            ),
            (
                "[material.a]\nglow = 1",
                "2:1: unknown field `glow`, expected one of `color`, `ambient`, `diffuse`, \
                 `specular`, `shininess`, `reflectance`, `transmittance`, `ior`, `filter`, \
                 `absorption`, `checker`, `stripes`, `image`",
            ),
            (
                "[material.a]\ncolor = [1, 1, 1]\nchecker = { colors = [[0, 0, 0], [1, 1, 1]], size = 1 }",
                "1:11: a material has one of `color`, `checker`, `stripes` and `image`",
            ),
            (
                "[material.a]\nchecker = { colors = [[0, 0, 0], [1, 1, 1]], size = 0 }",
                "2:53: what a pattern repeats is larger than 0",
            ),
            (
                "[material.a]\nchecker = { colors = [[1, 1, 1], [0, 0, 0]], size = 1e-30 }\n\
                 [[sphere]]\nmaterial = 'a'\ncenter = [0, 0, 0]\nradius = 1e30",
                "1:11: what a pattern repeats is out of all proportion to the scene",
            ),
            (
                "[material.a]\nstripes = { colors = [[1, 1, 1], [0, 0, 0]], \
                 direction = [1, 0, 0], size = 1e30 }\n\
                 [[sphere]]\nmaterial = 'a'\ncenter = [0, 0, 0]\nradius = 1e-30",
                "1:11: what a pattern repeats is out of all proportion to the scene",
            ),
            (
                "[material.a]\nchecker = { colors = [[0, 0, 0], [1, 1, -1]], size = 1 }",
                "2:34: a component of a colour is -1.0: not between 0 and 1048576",
            ),
            (
                "[material.a]\nchecker = { colors = [[0, 0, 0]], size = 1 }",
                "2:22: invalid length 1, expected an array of length 2",
            ),
            (
                "[material.a]\nstripes = { colors = [[0, 0, 0], [1, 1, 1]], direction = [0, 0, 0], size = 1 }",
                "2:58: the direction of stripes is zero",
            ),
            (
                "[material.a]\nimage = { texture = 'wood' }",
                "2:21: no texture is named `wood`",
            ),
            (
                "[texture.t]\nrows = ['a']\n[material.a]\nimage = { texture = 't', repeat = [1, inf] }",
                "4:35: the number of copies is inf: not a finite 32-bit float",
            ),
            (
                "[texture.t]\nfile = 'none.png'\nrows = ['a']",
                "1:10: a texture has either `file` or `rows`",
            ),
            ("[texture.t]\nrows = []", "2:8: the texture has no pixels"),
            (
                "[texture.t]\nfile = 'none.bmp'",
                "2:8: texture none.bmp: No such file or directory (os error 2)",
            ),
            (
                "[material.a]\nfilter = [1, 0, 0]",
                "2:10: what lets nothing through has neither `filter` nor `absorption`",
            ),
            (
                "[material.a]\ntransmittance = 1\nfilter = [1, 2, 0]",
                "3:10: a component of the filter is 2.0: not between 0 and 1",
            ),
            (
                "[material.a]\ntransmittance = 1\nabsorption = [1, -2, 0]",
                "3:14: a component of the absorption is -2.0: not between 0 and 1048576",
            ),
            (
                &shape("sphere", "center = [0, 0, 0]"),
                "1:1: missing field `radius`",
            ),
            (
                &shape("sphere", "center = [0, 0, 0]\nradius = 1"),
                "2:12: no material is named `a`",
            ),
            (
                &shape("sphere", "center = [0, 0, 0]\nradius = 1e39"),
                "4:10: the radius is 1e39: not a finite 32-bit float",
            ),
            (
                &shape("sphere", "center = [0, 0, 0]\nradius = 1\nheight = 1"),
                "5:1: unknown field `height`, expected one of `material`, `center`, `radius`",
            ),
            (
                &shape("polygon", "vertices = [[0, 0, 0], [1, 0, 0]]"),
                "3:12: a polygon has at least 3 vertices",
            ),
            (
                &shape("triangle", "vertices = [[0, 0, 0], [1, 0, 0]]"),
                "3:12: invalid length 2, expected an array of length 3",
            ),
            (
                &shape(
                    "hyperboloid",
                    "base = [0, 0, 0]\napex = [0, 1, 0]\nradius = 1\nwaist = 0.5\ngap = 0.5",
                ),
                "3:8: a hyperboloid has either a `waist`, for one sheet, or a `gap`, for two",
            ),
            (
                &shape(
                    "hyperboloid",
                    "base = [0, 0, 0]\napex = [0, 1, 0]\nradius = 1",
                ),
                "3:8: a hyperboloid has either a `waist`, for one sheet, or a `gap`, for two",
            ),
            (
                &shape("quadric", "center = [0, 0, 0]\nsquares = [1, 1, 1]\nto = 1"),
                "5:6: planes at `from` and `to` need an `axis`",
            ),
            (
                &shape("quadric", "center = [0, 0, 0]\nmax = [inf, 0, 0]"),
                "4:7: a coordinate of max is inf: not a finite 32-bit float",
            ),
            (
                &shape(
                    "torus",
                    "center = [0, 0, 0]\naxis = [0, 1, 0]\nmajor = 1\nminor = nan",
                ),
                "6:9: the minor radius is NaN: not a finite 32-bit float",
            ),
            (
                &shape("ellipsoid", "center = [0, 0, 0]\nradius = 1"),
                "4:1: unknown field `radius`, expected one of `material`, `center`, `radii`",
            ),
            (
                "[[light]]\nposition = [0, 0, 0]\nsamples = 4",
                "3:11: `samples` and `adaptive` are for lights with `edges` or a `radius`",
            ),
            (
                "[[light]]\nposition = [0, 0, 0]\nadaptive = 4",
                "3:12: `samples` and `adaptive` are for lights with `edges` or a `radius`",
            ),
            (
                "[[light]]\nposition = [0, 0, 0]\nedges = [[1, 0, 0], [0, 1, 0]]\nradius = 1",
                "3:9: a light has either `edges` or a `radius`, not both",
            ),
            (
                "[[light]]\nposition = [0, 0, 0]\nedges = [[1, 0, 0]]",
                "3:9: invalid length 1, expected an array of length 2",
            ),
            (
                "[[light]]\nposition = [0, 0, 0]\nedges = [[1, 0, 0], [0, nan, 0]]",
                "3:21: a component of an edge is NaN: not a finite 32-bit float",
            ),
            (
                "[[light]]\nposition = [0, 0, 0]\nradius = -1",
                "3:10: the radius of the light is -1.0: not a finite 32-bit float from 0 on",
            ),
            (
                "[[light]]\nposition = [0, 0, 0]\nradius = 1\nsamples = 0",
                "4:11: a light has 1, 2, 4, 8 or 16 samples to a side",
            ),
            (
                "[[light]]\nposition = [0, 0, 0]\nradius = 1\nadaptive = 32",
                "4:12: a light has 1, 2, 4, 8 or 16 samples to a side",
            ),
            (
                "[[light]]\nposition = [0, 0, 0]\nradius = 1\nsamples = 4\nadaptive = 8",
                "5:12: `adaptive` is more than `samples`",
            ),
            (
                "[sphere]\nradius = 1",
                "1:1: invalid type: map, expected a sequence",
            ),
        ];
        for (text, message) in cases {
            let error = read(text).err().unwrap_or_default();
            assert_eq!(error, format!("t.toml:{message}"), "{text}");
        }
    }

    #[test]
    fn numbers_may_be_integers_of_any_size() {
        let file = read("[[light]]\nposition = [1, -100000000000000000000, 2.5]").unwrap();
        assert_eq!(file.lights[0].position, [1.0, -1e20, 2.5]);
    }
}
