//! What a scene needs of whoever renders it, and what may be wrong with it.

use std::collections::BTreeMap;
use std::fmt;
use std::mem::size_of;

use serde::Serialize;
use whitted::area::{Disk, Outline, Rect};
use whitted::{
    Absorbing, AreaLight, Checker, Cuboid, Frustum, Glass, Light, Mirror, Patch, Phong, Placement,
    Plane, Quadric, Sphere, Stripes, Tinted, Torus, Triangle, Vec3,
};

use crate::paint::Paint;
use crate::scene::{HostScene, Material, Pool};
use crate::scene_file::{Extent, Object, Place, SceneFile, Shape, Solid};

pub use map::{MapReport, inspect_map};

mod coincidence;
mod map;

/// What [`inspect`] found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// The file's name.
    pub file: String,
    /// How many shapes of each kind.
    pub shapes: BTreeMap<&'static str, usize>,
    /// Corners of all polygons together.
    pub polygon_corners: usize,
    /// Solids that are joined of others.
    pub solids: usize,
    /// Groups of shapes, whose shapes count once.
    pub groups: usize,
    /// Groups that are placed, those in groups counted.
    pub instances: usize,
    /// The lights.
    pub lights: Lights,
    /// The materials.
    pub materials: Materials,
    /// Chains of rays.
    pub depth: Depth,
    /// The least and the greatest coordinates of all shapes but planes.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// Lengths are cast after division by 2 to this power.
    pub scale_exponent: i32,
    /// The types that a firmware for this scene names; it links nothing for any other.
    pub features: Vec<&'static str>,
    /// Size as constants of a 32-bit firmware.
    pub bytes: Bytes,
    /// What may be wrong.
    pub warnings: Vec<Warning>,
}

/// How many lights there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Lights {
    /// In all.
    pub all: usize,
    /// That cast shadows.
    pub with_shadows: usize,
    /// Parallelograms that cast soft ones.
    pub rects: usize,
    /// Disks that do.
    pub disks: usize,
}

/// How many different materials there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Materials {
    /// In all.
    pub all: usize,
    /// With a highlight.
    pub shining: usize,
    /// With a highlight whose exponent is no whole number.
    pub with_real_exponents: usize,
    /// Mirrors.
    pub reflecting: usize,
    /// Glass.
    pub refracting: usize,
    /// Glass that colors what passes its surface or its inside.
    pub tinting: usize,
    /// Glass in which light weakens.
    pub absorbing: usize,
    /// With a checker for a color.
    pub checkered: usize,
    /// With stripes.
    pub striped: usize,
    /// With an image.
    pub with_images: usize,
}

/// How long chains of rays get.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Depth {
    /// What the scene asks for.
    pub limit: usize,
    /// What its materials can reach within the limit.
    pub reach: usize,
    /// What of this weighs more than 1/512 in its pixel: deeper rays change 8 bits by half a step at
    /// most, each.
    pub visible: usize,
}

/// Sizes in bytes, where a pointer has 4.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Bytes {
    /// Objects, and the vertices of polygons.
    pub objects: usize,
    /// Materials.
    pub materials: usize,
    /// Lights.
    pub lights: usize,
    /// Together.
    pub total: usize,
}

/// Something that may be wrong with a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Warning {
    /// Where in the file, if at one place.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<u32>,
    /// In that line.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub column: Option<u32>,
    /// What it is.
    pub message: String,
}

impl Warning {
    fn new(place: Option<Place>, message: String) -> Self {
        Self {
            line: place.map(|it| it.line),
            column: place.map(|it| it.column),
            message,
        }
    }
}

/// Inspects a scene; `pool` is its materials.
pub fn inspect(scene: &HostScene<'_>, pool: &Pool) -> Report {
    let file = scene.file();
    let mut shapes = BTreeMap::new();
    let mut polygon_corners = 0;
    for object in file.all_objects() {
        *shapes.entry(object.shape.name()).or_insert(0) += 1;
        if let Shape::Polygon { vertices } = &object.shape {
            polygon_corners += vertices.len();
        }
    }
    let soft = |wanted: fn(&Extent) -> bool| {
        let lights = file.lights.iter().filter(|it| it.shadows);
        let areas = lights.filter_map(|it| it.area.as_ref());
        areas.filter(|it| wanted(&it.extent)).count()
    };
    let lights = Lights {
        all: file.lights.len(),
        with_shadows: file.lights.iter().filter(|it| it.shadows).count(),
        rects: soft(|it| matches!(it, Extent::Rect { .. })),
        disks: soft(|it| matches!(it, Extent::Disk { .. })),
    };
    let materials = count_materials(pool.materials());
    let bounds = bounds(file);
    Report {
        file: file.path.display().to_string(),
        features: features(file, &shapes, &materials, &lights),
        bytes: bytes(
            &shapes,
            polygon_corners,
            &materials,
            &lights,
            file.instances.len(),
        ),
        shapes,
        polygon_corners,
        solids: file.solids.len() + file.groups.iter().map(|it| it.solids.len()).sum::<usize>(),
        groups: file.groups.len(),
        instances: file.instances.len(),
        lights,
        materials,
        depth: depth(file),
        bounds,
        scale_exponent: scene.scale().exponent,
        warnings: warnings(file, bounds),
    }
}

fn count_materials(materials: &[Material]) -> Materials {
    let count = |wanted: fn(&&Material) -> bool| materials.iter().filter(wanted).count();
    Materials {
        all: materials.len(),
        shining: count(|it| it.highlight.specular > 0.0),
        with_real_exponents: count(|it| {
            it.highlight.specular > 0.0 && it.highlight.shininess.fract() != 0.0
        }),
        reflecting: count(|it| it.reflection.reflectance > 0.0),
        refracting: count(|it| it.transmission.tint.max_element() > 0.0),
        tinting: count(|it| it.transmission.tint != Vec3::splat(it.transmission.tint.x)),
        absorbing: count(|it| it.transmission.absorption != Vec3::ZERO),
        checkered: count(|it| matches!(it.color, Paint::Checker(_))),
        striped: count(|it| matches!(it.color, Paint::Stripes(_))),
        with_images: count(|it| matches!(it.color, Paint::Image { .. })),
    }
}

fn features(
    file: &SceneFile,
    shapes: &BTreeMap<&'static str, usize>,
    materials: &Materials,
    lights: &Lights,
) -> Vec<&'static str> {
    let mut features: Vec<_> = shapes
        .keys()
        .map(|&kind| match kind {
            "sphere" => "Sphere",
            "plane" => "Plane",
            "polygon" => "Polygon",
            "triangle" => "Triangle",
            "patch" => "Patch",
            "box" => "Cuboid",
            "quadric" => "Quadric",
            "torus" => "Torus",
            _ => "Frustum",
        })
        .collect();
    if !file.solids.is_empty() || file.groups.iter().any(|it| !it.solids.is_empty()) {
        features.push("Csg");
    }
    if !file.instances.is_empty() {
        features.push("Instance");
    }
    if materials.with_real_exponents > 0 {
        features.push("PhongReal");
    } else if materials.shining > 0 {
        features.push("Phong");
    }
    if materials.reflecting > 0 {
        features.push("Mirror");
    }
    if materials.refracting > 0 {
        features.push(match (materials.absorbing, materials.tinting) {
            (0, 0) => "Glass",
            (0, _) => "Tinted",
            _ => "Absorbing",
        });
    }
    let patterns = [
        ("Checker", materials.checkered),
        ("Stripes", materials.striped),
        ("ImageMap", materials.with_images),
    ];
    features.extend(patterns.iter().filter(|it| it.1 > 0).map(|it| it.0));
    if lights.rects + lights.disks > 0 {
        features.push("AreaLight");
    } else if lights.with_shadows > 0 {
        features.push("Light");
    }
    if lights.rects > 0 {
        features.push("Rect");
    }
    if lights.disks > 0 {
        features.push("Disk");
    }
    if lights.all > lights.with_shadows {
        features.push("FillLight");
    }
    features
}

fn bytes(
    shapes: &BTreeMap<&'static str, usize>,
    polygon_corners: usize,
    materials: &Materials,
    lights: &Lights,
    instances: usize,
) -> Bytes {
    const POINTER: usize = 4;
    const VECTOR: usize = size_of::<Vec3>();
    let object = |kind: &str| {
        POINTER
            + match kind {
                "sphere" => size_of::<Sphere>(),
                "plane" => size_of::<Plane>(),
                // A slice, and the normal.
                "polygon" => 2 * POINTER + VECTOR,
                "triangle" => size_of::<Triangle>(),
                "patch" => size_of::<Patch>(),
                "box" => size_of::<Cuboid>(),
                "quadric" => size_of::<Quadric>(),
                "torus" => size_of::<Torus>(),
                _ => size_of::<Frustum>(),
            }
    };
    let objects: usize = shapes
        .iter()
        .map(|(kind, count)| object(kind) * count)
        .sum();
    let placed = instances * (POINTER + size_of::<Placement>());
    let objects = objects + polygon_corners * VECTOR + placed;
    let mut material = size_of::<whitted::Material>();
    if materials.shining > 0 {
        material += size_of::<Phong>();
    }
    if materials.reflecting > 0 {
        material += size_of::<Mirror>();
    }
    if materials.refracting > 0 {
        material += match (materials.absorbing, materials.tinting) {
            (0, 0) => size_of::<Glass>(),
            (0, _) => size_of::<Tinted>(),
            _ => size_of::<Absorbing>(),
        };
    }
    let kinds = [
        (materials.checkered, size_of::<Checker>()),
        (materials.striped, size_of::<Stripes>()),
        // A pointer, and how often; its pixels are `whitted bake`'s to count.
        (materials.with_images, POINTER + 2 * size_of::<f32>()),
    ];
    let varying: usize = kinds.iter().map(|it| it.0).sum();
    if varying > 0 {
        let named = kinds.iter().filter(|it| it.0 > 0);
        let is_mixed = varying < materials.all || named.clone().count() > 1;
        let most = named.map(|it| it.1).max().unwrap_or_default();
        // Of several kinds, a word tells which.
        material += if is_mixed { POINTER } else { 0 };
        material += most.max(if varying < materials.all { VECTOR } else { 0 });
        material -= VECTOR;
    }
    let materials = materials.all * material;
    let light = match (lights.rects, lights.disks) {
        (0, 0) => size_of::<Light>(),
        (_, 0) => size_of::<AreaLight<Rect>>(),
        (0, _) => size_of::<AreaLight<Disk>>(),
        _ => size_of::<AreaLight<Outline>>(),
    };
    let lights = lights.all * light;
    Bytes {
        objects,
        materials,
        lights,
        total: objects + materials + lights,
    }
}

fn depth(file: &SceneFile) -> Depth {
    let limit = file.depth;
    let mut secondary = file.all_objects().filter(|it| {
        let material = &file.materials[it.material];
        material.reflectance > 0.0 || material.transmittance > 0.0
    });
    let reach = match (secondary.next(), secondary.next()) {
        (None, _) => 1,
        (Some(object), None)
            if file.solids.is_empty()
                && file.groups.is_empty()
                && file.materials[object.material].transmittance == 0.0
                && !sees_itself(&object.shape, file.camera.map(|it| it.eye)) =>
        {
            2
        }
        _ => limit,
    };
    let reach = reach.min(limit);
    // After total internal reflection the mirrored ray weighs as much as both.
    let heaviest = file
        .all_objects()
        .map(|it| &file.materials[it.material])
        .map(|it| it.reflectance + it.transmittance)
        .fold(0.0, f64::max);
    let visible = (1..=reach)
        .take_while(|&depth| heaviest.powi(depth as i32 - 1) > 1.0 / 512.0)
        .count();
    Depth {
        limit,
        reach,
        visible,
    }
}

/// Whether a ray from the eye that is mirrored at this shape can meet it again.
fn sees_itself(shape: &Shape, eye: Option<[f64; 3]>) -> bool {
    match (shape, eye) {
        (Shape::Plane { .. } | Shape::Polygon { .. }, _)
        | (Shape::Triangle { .. } | Shape::Patch { .. }, _) => false,
        (&Shape::Sphere { center, radius }, Some(eye)) => {
            let squared: f64 = (0..3).map(|axis| (eye[axis] - center[axis]).powi(2)).sum();
            // Of a hollow one only the inside is visible.
            radius < 0.0 || squared <= radius * radius
        }
        (&Shape::Box { min, max }, Some(eye)) => {
            (0..3).all(|axis| (min[axis]..=max[axis]).contains(&eye[axis]))
        }
        _ => true,
    }
}

/// The least and the greatest coordinates of some objects, without planes.
fn bounds_of<'a>(objects: impl Iterator<Item = &'a Object>) -> Option<[[f64; 3]; 2]> {
    let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    let mut include = |point: [f64; 3], radius: f64| {
        for axis in 0..3 {
            bounds[0][axis] = bounds[0][axis].min(point[axis] - radius.abs());
            bounds[1][axis] = bounds[1][axis].max(point[axis] + radius.abs());
        }
    };
    for object in objects {
        match object.shape {
            Shape::Sphere { center, radius } => include(center, radius),
            Shape::Plane { .. } => {}
            Shape::Polygon { ref vertices } => vertices.iter().for_each(|&it| include(it, 0.0)),
            Shape::Triangle { vertices } | Shape::Patch { vertices, .. } => {
                vertices.iter().for_each(|&it| include(it, 0.0));
            }
            Shape::Box { min, max } => [min, max].iter().for_each(|&it| include(it, 0.0)),
            // A little more than its ends need, for a frustum that is not parallel to an axis.
            Shape::Frustum {
                base,
                base_radius,
                apex,
                apex_radius,
            } => {
                include(base, base_radius);
                include(apex, apex_radius);
            }
            Shape::Torus {
                center,
                major,
                minor,
                ..
            } => include(center, major + minor),
            Shape::Quadric { ref form, .. } => {
                form.extent()
                    .into_iter()
                    .for_each(|(center, radius)| include(center, radius));
            }
        }
    }
    (bounds[0][0] <= bounds[1][0]).then_some(bounds)
}

fn leaves(solids: &[Solid]) -> impl Iterator<Item = &Object> {
    solids.iter().flat_map(|it| &it.leaves)
}

fn bounds(file: &SceneFile) -> Option<[[f64; 3]; 2]> {
    let top = bounds_of(file.objects.iter().chain(leaves(&file.solids)));
    let groups: Vec<_> = file
        .groups
        .iter()
        .map(|it| bounds_of(it.objects.iter().chain(leaves(&it.solids))))
        .collect();
    // Of each instance, all that its group's box may reach.
    let placed = file.instances.iter().filter_map(|it| {
        let box_of_group = groups[it.group]?;
        let reach = |to: usize, pick: fn(f64, f64) -> f64| -> f64 {
            (0..3)
                .map(|axis| {
                    let [a, b] = box_of_group.map(|end| end[axis] * it.axes[axis][to]);
                    pick(a, b)
                })
                .sum()
        };
        let end = |pick| std::array::from_fn(|to| it.translation[to] + reach(to, pick));
        Some([end(f64::min), end(f64::max)])
    });
    top.into_iter().chain(placed).reduce(|a, b| {
        let join = |end: usize, pick: fn(f64, f64) -> f64| {
            std::array::from_fn(|axis| pick(a[end][axis], b[end][axis]))
        };
        [join(0, f64::min), join(1, f64::max)]
    })
}

fn warnings(file: &SceneFile, bounds: Option<[[f64; 3]; 2]>) -> Vec<Warning> {
    let mut warnings = Vec::new();
    if file.camera.is_none() {
        warnings.push(Warning::new(
            None,
            "there is no camera to render it".to_owned(),
        ));
    }
    if file.lights.is_empty() && file.ambient == [0.0; 3] {
        warnings.push(Warning::new(None, "nothing lights it".to_owned()));
    }
    warnings.extend(bounds.and_then(far_from_origin));
    warnings.extend(against_winding(file));
    warnings.extend(coincidence::find(&file.objects).map(|found| {
        let [first, second] = found.first;
        let of = |index: usize| &file.objects[index];
        let more = match found.pairs {
            1 => String::new(),
            pairs => format!("; {pairs} such pairs in all"),
        };
        let message = format!(
            "this {} coincides with the {} at {}, so that rounding decides which is seen{more}",
            of(second).shape.name(),
            of(first).shape.name(),
            of(first).place,
        );
        Warning::new(Some(of(second).place), message)
    }));
    warnings
}

/// A scene far from the origin leaves few digits for its own size.
fn far_from_origin([min, max]: [[f64; 3]; 2]) -> Option<Warning> {
    const FAR: f64 = 1000.0;
    let size = (0..3).map(|axis| max[axis] - min[axis]).fold(0.0, f64::max);
    let coordinates = min.iter().chain(&max);
    let greatest = coordinates.fold(0.0_f64, |most, it| most.max(it.abs()));
    let times = greatest / size;
    (size > 0.0 && times > FAR).then(|| {
        let digits = (24.0 - times.log2()).max(0.0);
        let message = format!(
            "coordinates reach {times:.0} times the scene's size: of 24 bits, {digits:.0} are left \
             for its shape; move it to the origin"
        );
        Warning::new(None, message)
    })
}

/// Normals decide which side of a patch is outside; they are likely wrong where its winding says
/// otherwise.
fn against_winding(file: &SceneFile) -> Option<Warning> {
    let mut against = file.objects.iter().filter(|it| {
        let Shape::Patch { vertices, normals } = it.shape else {
            return false;
        };
        let [a, b, c] = vertices;
        let wound = cross(difference(b, a), difference(c, a));
        normals.iter().any(|&normal| dot(normal, wound) < 0.0)
    });
    let first = against.next()?;
    let more = match against.count() {
        0 => String::new(),
        more => format!(", and of {more} more"),
    };
    let message = format!("normals of this patch{more} point against the winding");
    Some(Warning::new(Some(first.place), message))
}

fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.file)?;
        let plural = |count: usize, one: &str, many: &str| {
            format!("{count} {}", if count == 1 { one } else { many })
        };
        let mut shapes: Vec<_> = self
            .shapes
            .iter()
            .map(|(kind, &count)| match *kind {
                "polygon" => {
                    let corners = self.polygon_corners;
                    format!("{} ({corners} corners)", plural(count, kind, "polygons"))
                }
                "frustum" => plural(count, kind, "frusta"),
                "torus" => plural(count, kind, "tori"),
                "box" | "patch" => plural(count, kind, &format!("{kind}es")),
                _ => plural(count, kind, &format!("{kind}s")),
            })
            .collect();
        if shapes.is_empty() {
            shapes.push("none".to_owned());
        }
        writeln!(f, "  shapes     {}", shapes.join(", "))?;
        if self.solids > 0 {
            writeln!(f, "  solids     {}", self.solids)?;
        }
        if self.groups > 0 {
            writeln!(
                f,
                "  groups     {}, placed {} times",
                self.groups, self.instances
            )?;
        }
        let lights = &self.lights;
        let (all, with_shadows) = (lights.all, lights.with_shadows);
        write!(f, "  lights     {all}, {with_shadows} with shadows")?;
        match lights.rects + lights.disks {
            0 => writeln!(f)?,
            soft => writeln!(f, ", {soft} of them soft")?,
        }
        let materials = &self.materials;
        writeln!(
            f,
            "  materials  {}, {} with highlights ({} with real exponents), {} reflecting, {} \
             refracting",
            materials.all,
            materials.shining,
            materials.with_real_exponents,
            materials.reflecting,
            materials.refracting
        )?;
        let depth = &self.depth;
        writeln!(
            f,
            "  depth      {} of {}, {} by weight of 1/512",
            depth.reach, depth.limit, depth.visible
        )?;
        if let Some([min, max]) = self.bounds {
            let [min, max] = [min, max].map(|it| it.map(|it| it as f32));
            writeln!(f, "  bounds     {min:?} to {max:?}")?;
        }
        if self.scale_exponent != 0 {
            writeln!(
                f,
                "  scale      cast after division by 2^{}",
                self.scale_exponent
            )?;
        }
        writeln!(f, "  features   {}", self.features.join(", "))?;
        let bytes = &self.bytes;
        writeln!(
            f,
            "  bytes      {} (objects {}, materials {}, lights {})",
            bytes.total, bytes.objects, bytes.materials, bytes.lights
        )?;
        for warning in &self.warnings {
            match (warning.line, warning.column) {
                (Some(line), Some(column)) => {
                    let file = &self.file;
                    writeln!(f, "warning: {file}:{line}:{column}: {}", warning.message)?;
                }
                _ => writeln!(f, "warning: {}: {}", self.file, warning.message)?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::scene_file::{nff, toml};

    #[test]
    fn groups_and_solids_are_counted() {
        let text = "[material.a]\n[[group.b.sphere]]\nmaterial = 'a'\ncenter = [0, 0, 0]\nradius = 1\n\
                    [[instance]]\nof = 'b'\nscale = [2, 1, 1]\ntranslate = [9, 0, 0]\n\
                    [[instance]]\nof = 'b'\nrotate = [0, 0, 90]\n\
                    [[csg]]\nexpression = 'c - d'\n\
                    solid.c.box = { material = 'a', min = [-3, 0, 0], max = [-2, 1, 1] }\n\
                    solid.d.sphere = { material = 'a', center = [-2, 0, 0], radius = 0.5 }\n";
        let report = report(&toml::parse(Path::new("t.toml"), text).unwrap());
        assert_eq!((report.solids, report.groups, report.instances), (1, 1, 2));
        assert_eq!((report.shapes["sphere"], report.shapes["box"]), (2, 1));
        assert_eq!(report.bounds, Some([[-3.0, -1.0, -1.0], [11.0, 1.0, 1.0]]));
        assert_eq!(report.features, ["Cuboid", "Sphere", "Csg", "Instance"]);
        // Two instances, three shapes.
        assert_eq!(report.bytes.objects, 2 * (48 + 4) + 2 * (16 + 4) + (24 + 4));
        let text = report.to_string();
        assert!(
            text.contains("  solids     1\n  groups     1, placed 2 times\n"),
            "{text}"
        );
    }

    fn report(file: &SceneFile) -> Report {
        let pool = Pool::new(file);
        inspect(&HostScene::new(file, &pool).unwrap(), &pool)
    }

    fn nff_report(text: &str) -> Report {
        report(&nff::parse(Path::new("t.nff"), text.as_bytes()).unwrap())
    }

    fn toml_report(text: &str) -> Report {
        report(&toml::parse(Path::new("t.toml"), text).unwrap())
    }

    const MATTE: &str = "f 1 1 1 1 0 0 0 0\n";
    const VIEW: &str = "v from 9 9 9 at 0 0 0 up 0 0 1 angle 45 hither 1 resolution 6 4\nl 9 9 9\n";

    #[test]
    fn shapes_and_what_they_need_are_counted() {
        let report = nff_report(&format!(
            "{VIEW}f 1 1 1 .5 .5 3.5 0 0\ns 0 0 0 1\ns 5 0 0 1\n{MATTE}\
             p 4 0 0 -1 1 0 -1 1 1 -1 0 1 -1\np 3 0 0 -2 1 0 -2 1 1 -2"
        ));
        let shapes: Vec<_> = report.shapes.into_iter().collect();
        assert_eq!(shapes, [("polygon", 1), ("sphere", 2), ("triangle", 1)]);
        assert_eq!(report.polygon_corners, 4);
        assert_eq!(
            report.materials,
            Materials {
                all: 2,
                shining: 1,
                with_real_exponents: 1,
                reflecting: 1,
                refracting: 0,
                tinting: 0,
                absorbing: 0,
                checkered: 0,
                striped: 0,
                with_images: 0,
            }
        );
        assert_eq!(
            report.features,
            [
                "Polygon",
                "Sphere",
                "Triangle",
                "PhongReal",
                "Mirror",
                "Light"
            ]
        );
        // Spheres of 4 floats, a triangle of 12, a polygon of 3 and a slice of 2 words, each with a
        // pointer; 4 corners of 3 floats. Materials of 5 + 2 + 1 floats; a light of 6.
        let objects = 4 * (2 * 5 + 13 + 6 + 4 * 3);
        let bytes = Bytes {
            objects,
            materials: 2 * 8 * 4,
            lights: 24,
            total: objects + 64 + 24,
        };
        assert_eq!(report.bytes, bytes);
        assert_eq!(report.bounds, Some([[-1.0, -1.0, -2.0], [6.0, 1.0, 1.0]]));
        assert_eq!(report.warnings, []);
    }

    #[test]
    fn lights_are_told_apart() {
        let light = "[[light]]\nposition = [0, 9, 0]\n";
        let of = |fields: &[&str]| {
            let lights: Vec<_> = fields.iter().map(|it| format!("{light}{it}\n")).collect();
            toml_report(&lights.concat())
        };
        let (rect, disk) = ("edges = [[1, 0, 0], [0, 0, 1]]", "radius = 1");
        let unlit = "radius = 1\nshadows = false";
        let cases = [
            (
                of(&["", unlit]),
                vec!["Light", "FillLight"],
                24,
                "2, 1 with shadows",
            ),
            (
                of(&[rect]),
                vec!["AreaLight", "Rect"],
                52,
                "1, 1 with shadows, 1 of them soft",
            ),
            (
                of(&["", disk]),
                vec!["AreaLight", "Disk"],
                32,
                "2, 2 with shadows, 1 of them soft",
            ),
            (
                of(&[rect, disk]),
                vec!["AreaLight", "Rect", "Disk"],
                56,
                "2, 2 with shadows, 2 of them soft",
            ),
        ];
        for (report, features, size, line) in cases {
            assert_eq!(report.features, features);
            assert_eq!(report.bytes.lights, report.lights.all * size);
            let text = report.to_string();
            assert!(text.contains(&format!("  lights     {line}\n")), "{text}");
        }
    }

    #[test]
    fn depth_is_what_mirrors_and_glass_can_reach() {
        let mirror = "f 1 1 1 .5 .5 3 0 0\n";
        let cases = [
            ("matte", format!("{VIEW}{MATTE}s 0 0 0 1"), 1, 1),
            ("a ball", format!("{VIEW}{mirror}s 0 0 0 1"), 2, 2),
            (
                "a flat mirror",
                format!("{mirror}p 3 0 0 0 1 0 0 0 1 0"),
                2,
                2,
            ),
            (
                "a ball round the eye",
                format!("{VIEW}{mirror}s 0 0 0 99"),
                5,
                5,
            ),
            ("a hollow ball", format!("{VIEW}{mirror}s 0 0 0 -1"), 5, 5),
            ("a pipe", format!("{VIEW}{mirror}c 0 0 0 1 0 0 1 1"), 5, 5),
            (
                "two balls",
                format!("{VIEW}{mirror}s 0 0 0 1 s 3 0 0 1"),
                5,
                5,
            ),
            (
                "glass",
                format!("{VIEW}f 1 1 1 0 0 0 .9 1.5 s 0 0 0 1"),
                5,
                5,
            ),
            (
                "weak",
                format!("{VIEW}f 1 1 1 1 .05 9 0 0 s 0 0 0 1 s 3 0 0 1"),
                5,
                3,
            ),
        ];
        for (name, text, reach, visible) in cases {
            let depth = nff_report(&text).depth;
            assert_eq!((depth.reach, depth.visible), (reach, visible), "{name}");
        }
    }

    fn messages(report: Report) -> Vec<String> {
        let text = report.to_string();
        text.lines()
            .filter_map(|it| it.strip_prefix("warning: "))
            .map(str::to_owned)
            .collect()
    }

    #[test]
    fn dark_and_unseen_scenes_are_warned_of() {
        assert_eq!(
            messages(nff_report(&format!("{MATTE}s 0 0 0 1"))),
            [
                "t.nff: there is no camera to render it",
                "t.nff: nothing lights it"
            ]
        );
    }

    #[test]
    fn patches_wound_the_other_way_are_warned_of() {
        let patch = |normal: &str| format!("pp 3 0 0 0 {normal} 1 0 0 0 0 1 0 1 0 0 0 1\n");
        assert_eq!(
            messages(nff_report(&format!("{VIEW}{MATTE}{}", patch("0 .5 .5")))),
            [""; 0]
        );
        let text = format!("{VIEW}{MATTE}{}{}", patch("0 0 -1"), patch("0 .5 -.1"));
        assert_eq!(
            messages(nff_report(&text))[0],
            "t.nff:4:1: normals of this patch, and of 1 more point against the winding"
        );
    }

    #[test]
    fn scenes_far_from_the_origin_are_warned_of() {
        let at = |x: f64| format!("{VIEW}{MATTE}s {x} 0 0 1");
        assert_eq!(messages(nff_report(&at(1990.0))), [""; 0]);
        assert_eq!(
            messages(nff_report(&at(65535.0))),
            [
                "t.nff: coordinates reach 32768 times the scene's size: of 24 bits, 9 are left for its \
              shape; move it to the origin"
            ]
        );
    }

    #[test]
    fn surfaces_in_one_another_are_warned_of() {
        let warned = |shapes: &str| messages(nff_report(&format!("{VIEW}{MATTE}{shapes}")));
        let clean = [
            "s 0 0 0 1\ns 0 0 0 2",
            "p 4 0 0 0 1 0 0 1 1 0 0 1 0\np 4 1 0 0 2 0 0 2 1 0 1 1 0",
            "p 4 0 0 0 1 0 0 1 1 0 0 1 0\np 4 0 0 .1 1 0 .1 1 1 .1 0 1 .1",
            "p 4 0 0 0 1 0 0 1 1 0 0 1 0\np 4 0 0 0 1 0 0 1 0 1 0 0 1",
        ];
        for shapes in clean {
            assert_eq!(warned(shapes), [""; 0], "{shapes}");
        }
        let coincide = |this: &str, that: &str| {
            format!(
                "t.nff:5:1: this {this} coincides with the {that} at 4:1, so that rounding decides \
                 which is seen"
            )
        };
        let cases = [
            ("s 0 0 0 1\ns 0 -0 0 1", coincide("sphere", "sphere")),
            (
                "c 0 0 0 1 0 0 1 1\nc 0 0 0 1 0 0 1 1",
                coincide("frustum", "frustum"),
            ),
            (
                "p 4 0 0 0 1 0 0 1 1 0 0 1 0\np 3 0 1 0 1 1 0 .5 .5 0",
                coincide("triangle", "polygon"),
            ),
            (
                "p 3 0 0 0 1 2 2 0 1 1\npp 3 0 0 0 1 0 0 0 1 1 1 0 0 1 2 2 1 0 0",
                coincide("patch", "triangle"),
            ),
        ];
        for (shapes, message) in cases {
            assert_eq!(warned(shapes), [message], "{shapes}");
        }
        let three = warned("s 0 0 0 1\ns 0 0 0 1\ns 0 0 0 1");
        assert!(three[0].ends_with("; 2 such pairs in all"), "{three:?}");
        let floor = "[material.a]\n[[plane]]\nmaterial='a'\npoint=[7,1,7]\nnormal=[0,-2,0]\n\
                     [[triangle]]\nmaterial='a'\nvertices=[[0,1,0],[1,1,0],[0,1,1]]\n\
                     [[box]]\nmaterial='a'\nmin=[0,1,0]\nmax=[1,2,1]";
        let warned = messages(toml_report(floor));
        assert!(warned[2].starts_with("t.toml:6:1: this triangle coincides with the plane at 2:1"));
        assert_eq!(warned.len(), 3, "{warned:?}");
    }
}
