//! Scenes as the ray caster takes them: the type that names everything.
//!
//! A firmware's scene names what it uses and links nothing else. Here any scene has to fit, so there
//! is one type with every primitive and every term of the lighting model.

use std::collections::HashMap;

use glam::Vec3;
use whitted::area::{Disk, Outline, Rect, Samples};
use whitted::scene::Quantity;
use whitted::{
    Absorbing, AreaLight, Camera, Csg, Cuboid, Frustum, LightSource, Math, Mirror, Object, Patch,
    PhongReal, Placement, Plane, Polygon, Quadric, Ray, Scene, Sphere, Torus, Triangle, View,
};

use crate::paint::Paint;
use crate::scene_file::{
    self, Extent, Lens, Place, Problem, Scale, SceneError, SceneFile, Shape, Solid, at, direction,
    proportions,
};
use crate::whole::{HostSolid, Leaf, Placed, Solids, Tree, Whole};
use crate::wide;

/// A material that can do everything.
pub type Material = whitted::Material<PhongReal, Mirror, Absorbing, Paint>;

/// All objects of one kind.
pub type Kind<'a, S> = &'a [Object<'a, S, Material>];

/// A geometry of every kind of object. Which kinds come first decides ties and nothing else.
pub type HostGeometry<'a> = wide::Kinds<'a, Material>;

/// A scene of everything.
pub type AnyScene<'a> = Scene<'a, HostGeometry<'a>, Light>;

/// A light of any kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// As cast; the middle, where it is no point.
    pub position: Vec3,
    /// Linear RGB.
    pub color: Vec3,
    /// Whether objects block it.
    pub shadows: bool,
    /// What it is, unless a point or without shadows; as cast.
    pub area: Option<(Outline, Samples)>,
}

impl Light {
    /// Of a file that is cast at this scale.
    pub(crate) fn new(file: &scene_file::Light, scale: Scale) -> Self {
        let area = file.area.filter(|_| file.shadows).map(|it| {
            let extent = match it.extent {
                Extent::Rect { edges } => Outline::Rect(Rect {
                    edges: edges.map(|edge| scale.point(edge)),
                }),
                Extent::Disk { radius } => Outline::Disk(Disk {
                    radius: scale.length(radius),
                }),
            };
            (extent, it.samples)
        });
        Self {
            position: scale.point(file.position),
            color: color(file.color),
            shadows: file.shadows,
            area,
        }
    }
}

impl LightSource for Light {
    const IS_AREA: bool = true;

    fn position(&self) -> Vec3 {
        self.position
    }

    fn color(&self) -> Vec3 {
        self.color
    }

    fn casts_shadows(&self) -> bool {
        self.shadows
    }

    fn share<P: Math, V: Quantity>(
        &self,
        normal: Vec3,
        center: &Ray,
        mut passes: impl FnMut(&Ray) -> V,
    ) -> V {
        let Some((extent, samples)) = self.area else {
            return passes(center);
        };
        let light = AreaLight {
            position: self.position,
            color: self.color,
            extent,
            samples,
        };
        light.share::<P, V>(normal, center, passes)
    }
}

/// What a scene's objects borrow: materials, and the vertices of polygons.
#[derive(Clone, Debug)]
pub struct Pool {
    scale: Scale,
    /// Different ones only.
    materials: Vec<Material>,
    /// For each material of the file, which of these it is: by [`Units`], and `None` where no shape has those.
    material_of: Vec<[Option<usize>; 3]>,
    vertices: Vec<Vec3>,
    /// For each object of the file that is a polygon, in order, where its vertices end.
    ends: Vec<usize>,
}

impl Pool {
    /// Takes what is to be borrowed from a file.
    pub fn new(file: &SceneFile) -> Self {
        let scale = file.scale();
        let mut pool = Self {
            scale,
            materials: Vec::new(),
            material_of: Vec::with_capacity(file.materials.len()),
            vertices: Vec::new(),
            ends: Vec::new(),
        };
        let mut known = HashMap::new();
        let mut add = |index: usize, units: Units| {
            let mut material = self::material(&file.materials[index], scale);
            material.color.count_lengths(units, scale);
            *known.entry(bits(&material)).or_insert_with(|| {
                pool.materials.push(material);
                pool.materials.len() - 1
            })
        };
        for index in 0..file.materials.len() {
            let place = add(index, Units::Shares);
            pool.material_of.push([Some(place), None, None]);
        }
        for object in file.all_objects() {
            let units = Units::of(&object.shape);
            pool.material_of[object.material][units as usize]
                .get_or_insert_with(|| add(object.material, units));
            if let Shape::Polygon { vertices } = &object.shape {
                let vertices = vertices.iter().map(|&it| scale.point(it));
                pool.vertices.extend(vertices);
                pool.ends.push(pool.vertices.len());
            }
        }
        pool
    }

    /// The different materials.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }
}

pub(crate) fn material(file: &scene_file::Material, scale: Scale) -> Material {
    let tint = file.filter.map(|it| it as f32 * file.transmittance as f32);
    Material {
        color: Paint::new(file, scale),
        ambient: file.ambient as f32,
        diffuse: file.diffuse as f32,
        highlight: PhongReal {
            specular: file.specular as f32,
            shininess: file.shininess as f32,
        },
        reflection: Mirror {
            reflectance: file.reflectance as f32,
        },
        transmission: Absorbing {
            tint: Vec3::from_array(tint),
            ior: file.ior as f32,
            absorption: Vec3::from_array(file.absorption.map(|it| scale.per_length(it))),
        },
    }
}

/// What u and v are on a shape, as [`whitted::Shape::uv`] has them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Units {
    /// Shares of its extent.
    Shares,
    /// Of v, lengths.
    Height,
    /// Of both.
    Lengths,
}

impl Units {
    fn of(shape: &Shape) -> Self {
        match shape {
            Shape::Plane { .. } | Shape::Polygon { .. } => Self::Lengths,
            Shape::Quadric { form, .. } if form.is_endless() => Self::Height,
            _ => Self::Shares,
        }
    }
}

pub(crate) fn color(rgb: [f64; 3]) -> Vec3 {
    Vec3::from_array(rgb.map(|it| it as f32))
}

/// All of a material, as something to compare and to hash.
fn bits(material: &Material) -> Vec<usize> {
    let Absorbing {
        tint,
        ior,
        absorption,
    } = material.transmission;
    let [red, green, blue] = tint.to_array();
    let [a, b, c] = absorption.to_array();
    let numbers = [
        material.ambient,
        material.diffuse,
        material.highlight.specular,
        material.highlight.shininess,
        material.reflection.reflectance,
        red,
        green,
        blue,
        ior,
        a,
        b,
        c,
    ];
    let mut bits = material.color.bits();
    bits.extend(numbers.map(|it| it.to_bits() as usize));
    bits
}

/// Whether vectors do all that materials like this ask for.
pub fn is_simple(material: &Material) -> bool {
    let Absorbing {
        tint, absorption, ..
    } = material.transmission;
    let is_gray = tint == Vec3::splat(tint.x) || tint.is_nan();
    material.color.plain().is_some() && is_gray && absorption == Vec3::ZERO
}

/// A scene file's objects, lights and camera, at the [scale](Scale) at which they are cast.
#[derive(Clone, Debug)]
pub struct HostScene<'a> {
    file: &'a SceneFile,
    scale: Scale,
    content: Content<'a>,
    groups: Vec<Content<'a>>,
    placed: Vec<Placed>,
    lights: Vec<Light>,
}

/// Objects and solids in one space: those that stand in the world, or those of a group.
#[derive(Clone, Debug, Default)]
struct Content<'a> {
    spheres: Vec<Object<'a, Sphere, Material>>,
    planes: Vec<Object<'a, Plane, Material>>,
    polygons: Vec<Object<'a, Polygon<'a>, Material>>,
    triangles: Vec<Object<'a, Triangle, Material>>,
    patches: Vec<Object<'a, Patch, Material>>,
    cuboids: Vec<Object<'a, Cuboid, Material>>,
    frusta: Vec<Object<'a, Frustum, Material>>,
    quadrics: Vec<Object<'a, Quadric, Material>>,
    tori: Vec<Object<'a, Torus, Material>>,
    solids: Vec<HostSolid<'a>>,
    /// For each object in geometry order, leaves of solids last, which of the file's it is.
    in_file: Vec<&'a scene_file::Object>,
}

impl<'a> HostScene<'a> {
    /// Builds every object. `pool` is this file's.
    ///
    /// # Errors
    ///
    /// Where a shape or the camera is impossible as such; with its place in the file.
    pub fn new(file: &'a SceneFile, pool: &'a Pool) -> Result<Self, SceneError> {
        let mut scene = Self {
            file,
            scale: pool.scale,
            content: Content::default(),
            groups: Vec::new(),
            placed: Vec::new(),
            lights: Vec::new(),
        };
        scene
            .objects(pool)
            .map_err(|(place, problem)| file.error(place, problem))?;
        scene.lights = file
            .lights
            .iter()
            .map(|it| Light::new(it, pool.scale))
            .collect();
        // For its errors: every command refuses a camera that shows nothing.
        scene.camera(1, 1)?;
        Ok(scene)
    }

    fn objects(&mut self, pool: &'a Pool) -> Result<(), (Place, Problem)> {
        let file = self.file;
        let mut polygons = 0;
        self.content = Content::new(&file.objects, &file.solids, pool, &mut polygons)?;
        for group in &file.groups {
            let content = Content::new(&group.objects, &group.solids, pool, &mut polygons)?;
            self.groups.push(content);
        }
        let mut first = self.content.in_file.len();
        for instance in &file.instances {
            let axes = instance
                .axes
                .map(|it| Vec3::from_array(it.map(|it| it as f32)));
            let translation = self.scale.point(instance.translation);
            let placement = Placement::new(axes, translation).map_err(at(instance.place))?;
            let group = instance.group;
            self.placed.push(Placed {
                group,
                placement,
                first,
            });
            first += self.groups[group].in_file.len();
        }
        Ok(())
    }

    /// The scene, for tracing and casting.
    pub fn scene(&self) -> AnyScene<'_> {
        Scene {
            geometry: self.geometry(),
            lights: &self.lights,
            background: color(self.file.background),
            ambient: color(self.file.ambient),
        }
    }

    /// The objects that are neither placed nor solids; what the renderer runs on where there are no others.
    pub fn geometry(&self) -> HostGeometry<'_> {
        self.content.kinds()
    }

    /// Whether [`geometry`](Self::geometry) is all.
    pub fn is_plain(&self) -> bool {
        self.placed.is_empty() && self.content.solids.is_empty()
    }

    /// All of the scene; `build` makes a geometry of objects.
    pub fn whole<'s, G>(&'s self, build: impl Fn(HostGeometry<'s>) -> G) -> Whole<'s, G> {
        let content = |it: &'s Content<'a>| (build(it.kinds()), Solids(&it.solids));
        Whole {
            top: content(&self.content),
            groups: self.groups.iter().map(content).collect(),
            placed: &self.placed,
        }
    }

    /// The solids that are not placed; then, for each group, its objects and solids.
    pub fn solids(&self) -> &[HostSolid<'a>] {
        &self.content.solids
    }

    /// Of each group, its objects and its solids.
    pub fn groups(&self) -> impl Iterator<Item = (HostGeometry<'_>, &[HostSolid<'a>])> {
        self.groups.iter().map(|it| (it.kinds(), &it.solids[..]))
    }

    /// The groups where they are placed.
    pub fn placed(&self) -> &[Placed] {
        &self.placed
    }

    /// The file that this is the scene of.
    pub fn file(&self) -> &'a SceneFile {
        self.file
    }

    /// The scale at which everything here is.
    pub fn scale(&self) -> Scale {
        self.scale
    }

    /// The object of the file that [`whitted::Hit::object`] names.
    pub fn in_file(&self, object: usize) -> &'a scene_file::Object {
        if let Some(object) = self.content.in_file.get(object) {
            return object;
        }
        let after = self.placed.partition_point(|it| it.first <= object);
        let placed = &self.placed[after - 1];
        self.groups[placed.group].in_file[object - placed.first]
    }

    /// The camera for a picture of some size in pixels; `None` where the file has none.
    ///
    /// # Errors
    ///
    /// Where it shows nothing.
    pub fn camera(&self, width: u32, height: u32) -> Result<Option<View>, SceneError> {
        let Some(camera) = &self.file.camera else {
            return Ok(None);
        };
        let (eye, target) = (
            self.scale.point(camera.eye),
            self.scale.point(camera.target),
        );
        let up = direction(camera.up);
        let tan_half = |degrees: f64| libm::tan(degrees.to_radians() / 2.0) as f32;
        let view = match camera.lens {
            Lens::Vertical { degrees } => {
                let aspect = width as f32 / height as f32;
                Camera::look_at(eye, target, up, tan_half(degrees), aspect)
            }
            Lens::Both { degrees } => Camera::look_at(eye, target, up, tan_half(degrees), 1.0),
            Lens::Frustum {
                left,
                right,
                bottom,
                top,
                distance,
            } => {
                let [left, right, bottom, top, distance] =
                    proportions([left, right, bottom, top, distance]);
                Camera::frustum(eye, target, up, left, right, bottom, top, distance)
            }
        };
        match view {
            Ok(camera) => Ok(Some(View {
                camera,
                width,
                height,
            })),
            Err(error) => Err(self.file.error(camera.place, error.into())),
        }
    }
}

impl<'a> Content<'a> {
    /// `polygons` is how many there are before.
    fn new(
        objects: &'a [scene_file::Object],
        solids: &'a [Solid],
        pool: &'a Pool,
        polygons: &mut usize,
    ) -> Result<Self, (Place, Problem)> {
        let mut content = Self::default();
        content.objects(objects, pool, polygons)?;
        for solid in solids {
            let leaf = |it| leaf(it, pool);
            let leaves = solid.leaves.iter().map(leaf).collect::<Result<_, _>>()?;
            content.in_file.extend(&solid.leaves);
            content.solids.push(Csg(Tree {
                leaves,
                steps: &solid.steps,
            }));
        }
        Ok(content)
    }

    fn objects(
        &mut self,
        objects: &'a [scene_file::Object],
        pool: &'a Pool,
        polygons: &mut usize,
    ) -> Result<(), (Place, Problem)> {
        let scale = pool.scale;
        let mut origins: [Vec<&'a scene_file::Object>; 9] = Default::default();
        for object in objects {
            let place = object.place;
            let units = Units::of(&object.shape);
            let place_of = pool.material_of[object.material][units as usize];
            let material = &pool.materials[place_of.expect("the pool was made for these objects")];
            if let Paint::Image { repeat, .. } = material.color
                && !(repeat.0.is_finite() && repeat.1.is_finite())
            {
                let problem = "the copies of its image are out of all proportion to the scene";
                return Err((place, Problem::Contradiction(problem)));
            }
            let kind = match object.shape {
                Shape::Sphere { center, radius } => {
                    let shape = Sphere::new(scale.point(center), scale.length(radius))
                        .map_err(at(place))?;
                    self.spheres.push(Object { shape, material });
                    0
                }
                Shape::Plane { point, normal } => {
                    let shape =
                        Plane::new(scale.point(point), direction(normal)).map_err(at(place))?;
                    self.planes.push(Object { shape, material });
                    1
                }
                Shape::Polygon { .. } => {
                    let start = match polygons.checked_sub(1) {
                        None => 0,
                        Some(before) => pool.ends[before],
                    };
                    let vertices = &pool.vertices[start..pool.ends[*polygons]];
                    let shape =
                        Polygon::new(vertices).map_err(|error| (place, Problem::Polygon(error)))?;
                    self.polygons.push(Object { shape, material });
                    *polygons += 1;
                    2
                }
                Shape::Triangle { vertices } => {
                    let shape = Triangle::new(vertices.map(|it| scale.point(it)))
                        .map_err(|error| (place, Problem::Triangle(error)))?;
                    self.triangles.push(Object { shape, material });
                    3
                }
                Shape::Patch { vertices, normals } => {
                    let vertices = vertices.map(|it| scale.point(it));
                    let shape = Patch::new(vertices, normals.map(direction)).map_err(at(place))?;
                    self.patches.push(Object { shape, material });
                    4
                }
                Shape::Box { min, max } => {
                    let shape =
                        Cuboid::new(scale.point(min), scale.point(max)).map_err(at(place))?;
                    self.cuboids.push(Object { shape, material });
                    5
                }
                Shape::Frustum {
                    base,
                    base_radius,
                    apex,
                    apex_radius,
                } => {
                    let shape = Frustum::new(
                        scale.point(base),
                        scale.length(base_radius),
                        scale.point(apex),
                        scale.length(apex_radius),
                    )
                    .map_err(at(place))?;
                    self.frusta.push(Object { shape, material });
                    6
                }
                Shape::Quadric { ref form, closed } => {
                    let shape = form.cast(closed, scale).map_err(at(place))?;
                    self.quadrics.push(Object { shape, material });
                    7
                }
                Shape::Torus {
                    center,
                    axis,
                    major,
                    minor,
                } => {
                    let (major, minor) = (scale.length(major), scale.length(minor));
                    let shape = Torus::new(scale.point(center), direction(axis), major, minor)
                        .map_err(at(place))?;
                    self.tori.push(Object { shape, material });
                    8
                }
            };
            origins[kind].push(object);
        }
        self.in_file = origins.concat();
        Ok(())
    }

    fn kinds(&self) -> HostGeometry<'_> {
        let curved = (&self.frusta[..], (&self.quadrics[..], &self.tori[..]));
        let solids = (&self.patches[..], (&self.cuboids[..], curved));
        let flat = (&self.polygons[..], (&self.triangles[..], solids));
        (&self.spheres[..], (&self.planes[..], flat))
    }
}

/// A leaf of a solid.
fn leaf<'a>(object: &'a scene_file::Object, pool: &'a Pool) -> Result<Leaf<'a>, (Place, Problem)> {
    let polygons = &mut 0;
    let mut one = Content::default();
    one.objects(std::slice::from_ref(object), pool, polygons)?;
    let leaf = match (&one.spheres[..], &one.planes[..], &one.cuboids[..]) {
        ([it], ..) => Leaf::Sphere(*it),
        (_, [it], _) => Leaf::Plane(*it),
        (.., [it]) => Leaf::Cuboid(*it),
        _ => match (&one.quadrics[..], &one.tori[..]) {
            ([it], _) => Leaf::Quadric(*it),
            (_, [it]) => Leaf::Torus(*it),
            // A file has no others.
            _ => return Err((object.place, Problem::NoInside("this shape has no inside"))),
        },
    };
    Ok(leaf)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use whitted::pattern::Spot;
    use whitted::{
        CameraError, CuboidError, FrustumError, Geometry, PatchError, PlacementError, PlaneError,
        PolygonError, QuadricError, Ray, SphereError, TorusError, Varying,
    };

    use super::*;
    use crate::scene_file::{nff, toml};

    fn nff_file(text: &str) -> SceneFile {
        nff::parse(Path::new("t.nff"), text.as_bytes()).unwrap()
    }

    #[test]
    fn images_count_lengths_at_every_scale() {
        let text = |exponent: i32| {
            let length = |it: f64| it * 2_f64.powi(exponent);
            let (x, size, copies) = (length(7.0), length(3.0), 2_f64.powi(-exponent) / 3.0);
            let (far, square) = (length(40.0), size * size);
            format!(
                "[texture.pair]\nrows = ['rg', 'gr']\ncolors = {{ r = [1, 0, 0], g = [0, 1, 0] }}\n\
                 [material.a]\nimage = {{ texture = 'pair', repeat = [{copies}, {copies}] }}\n\
                 [[plane]]\nmaterial = 'a'\npoint = [{x}, {size}, 0]\nnormal = [0, 1, 0.5]\n\
                 [material.b]\nimage = {{ texture = 'pair', repeat = [3, 3] }}\n\
                 [[sphere]]\nmaterial = 'b'\ncenter = [0, 0, 0]\nradius = {size}\n\
                 [material.c]\nimage = {{ texture = 'pair', repeat = [5, {copies}] }}\n\
                 [[quadric]]\nmaterial = 'c'\ncenter = [{far}, 0, 0]\nsquares = [1, 0, 1]\n\
                 constant = -{square}\n\
                 [[paraboloid]]\nmaterial = 'c'\ntip = [-{far}, 0, 0]\n\
                 end = [-{far}, {far}, 0]\nradius = {size}"
            )
        };
        let colors = |exponent| {
            let file = toml::parse(Path::new("t.toml"), &text(exponent)).unwrap();
            let (scale, pool) = (file.scale(), Pool::new(&file));
            assert_eq!(scale.exponent == 0, exponent == 0);
            let scene = HostScene::new(&file, &pool).unwrap();
            let geometry = scene.geometry();
            let seen = |origin: [f64; 3], direction| {
                let origin = scale.point(origin.map(|it| it * 2_f64.powi(exponent)));
                let hit = geometry.closest_hit(&Ray::new(origin, direction)).unwrap();
                hit.material.color.at(&Spot {
                    point: hit.point,
                    outward: hit.normal,
                    uv: geometry.uv(hit.point, hit.object, 0),
                })
            };
            let at = |i: i32| f64::from(i * 7 % 23);
            let from_above = (0..200).map(|i| seen([at(i), 50.0, at(i / 3)], Vec3::NEG_Y));
            let ahead = |x: f64| (0..200).map(move |i| [x, 5.0 + at(i), 50.0]);
            let round = ahead(40.0).chain(ahead(-40.0));
            from_above
                .chain(round.map(|it| seen(it, Vec3::NEG_Z)))
                .collect::<Vec<_>>()
        };
        let expected = colors(0);
        assert!(expected.contains(&Vec3::X) && expected.contains(&Vec3::Y));
        assert_eq!(colors(60), expected);
        assert_eq!(colors(-60), expected);
    }

    #[test]
    fn materials_share_the_pixels_of_an_image() {
        let text = "[texture.dot]\nrows = ['r']\ncolors = { r = [1, 0, 0] }\n\
            [material.a]\nimage = { texture = 'dot' }\n\
            [material.b]\nimage = { texture = 'dot' }\nambient = 0\n\
            [material.c]\nimage = { texture = 'dot' }";
        let file = toml::parse(Path::new("t.toml"), text).unwrap();
        let pool = Pool::new(&file);
        let textures = pool.materials().iter().map(|it| match &it.color {
            Paint::Image { texture, .. } => std::sync::Arc::as_ptr(texture),
            other => panic!("{other:?}"),
        });
        // The third is the first.
        assert_eq!(textures.clone().count(), 2);
        assert_eq!(textures.collect::<std::collections::HashSet<_>>().len(), 1);
    }

    #[test]
    fn impossible_shapes_and_cameras_are_errors_at_their_place() {
        let shape = |fields: &str| format!("[material.a]\n[[{fields}\nmaterial = 'a'");
        let placed = |instances: &str| {
            let plane = "[[group.a.plane]]\nmaterial = 'b'\npoint = [0, 0, 0]\nnormal = [0, 1, 0]";
            format!("[group.a]\n{instances}\n{plane}\n[material.b]")
        };
        let camera = |fields: &str| format!("\n[camera]\nup = [0, 0, 1]\n{fields}");
        let cases = [
            (
                shape("sphere]]\ncenter = [0, 0, 0]\nradius = 0"),
                Problem::Sphere(SphereError::ZeroRadius),
            ),
            (
                // Too small beside the other numbers for a 32-bit float.
                shape("sphere]]\ncenter = [1e30, 0, 0]\nradius = 1e-30"),
                Problem::Sphere(SphereError::ZeroRadius),
            ),
            (
                shape("plane]]\npoint = [0, 0, 0]\nnormal = [0, 0, 0]"),
                Problem::Plane(PlaneError::ZeroNormal),
            ),
            (
                shape("polygon]]\nvertices = [[0, 0, 0], [1, 0, 0], [2, 0, 0]]"),
                Problem::Polygon(PolygonError::ZeroArea),
            ),
            (
                shape("polygon]]\nvertices = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 1]]"),
                Problem::Polygon(PolygonError::NotPlanar(1)),
            ),
            (
                shape("triangle]]\nvertices = [[0, 0, 0], [1, 1, 1], [2, 2, 2]]"),
                Problem::Triangle(PolygonError::ZeroArea),
            ),
            (
                shape(
                    "patch]]\nvertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\n\
                     normals = [[0, 0, 1], [0, 0, 0], [0, 0, 1]]",
                ),
                Problem::Patch(PatchError::Normal(1)),
            ),
            (
                shape("box]]\nmin = [0, 0, 0]\nmax = [1, -1, 1]"),
                Problem::Box(CuboidError::Inverted),
            ),
            (
                shape("cylinder]]\nbase = [0, 0, 0]\napex = [0, 0, 0]\nradius = 1"),
                Problem::Frustum(FrustumError::ZeroLength),
            ),
            (
                shape("cylinder]]\nbase = [0, 0, 0]\napex = [0, 0, 1]\nradius = 0"),
                Problem::Frustum(FrustumError::ZeroRadius),
            ),
            (
                shape(
                    "frustum]]\nbase = [0, 0, 0]\nbase_radius = 1\napex = [0, 0, 1]\n\
                     apex_radius = -1",
                ),
                Problem::Frustum(FrustumError::MixedSigns),
            ),
            (
                shape("torus]]\ncenter = [0, 0, 0]\naxis = [0, 1, 0]\nmajor = 1\nminor = 1"),
                Problem::Torus(TorusError::Radii),
            ),
            (
                shape("torus]]\ncenter = [0, 0, 0]\naxis = [0, 0, 0]\nmajor = 1\nminor = 0.5"),
                Problem::Torus(TorusError::ZeroAxis),
            ),
            (
                shape("ellipsoid]]\ncenter = [0, 0, 0]\nradii = [1, 0, 1]"),
                Problem::Quadric(QuadricError::Radius),
            ),
            (
                shape(
                    "cone]]\nbase = [0, 0, 0]\nbase_radius = -1\napex = [0, 0, 1]\nclosed = true",
                ),
                Problem::Quadric(QuadricError::Radius),
            ),
            (
                shape("paraboloid]]\ntip = [0, 0, 0]\nend = [0, 0, 0]\nradius = 1"),
                Problem::Quadric(QuadricError::ZeroLength),
            ),
            (
                shape("hyperboloid]]\nbase = [0, 0, 0]\napex = [0, 0, 1]\nradius = 1\nwaist = 2"),
                Problem::Quadric(QuadricError::Waist),
            ),
            (
                shape("hyperboloid]]\nbase = [0, 0, 0]\napex = [0, 0, 1]\nradius = 1\ngap = 1"),
                Problem::Quadric(QuadricError::Gap),
            ),
            (
                shape("quadric]]\ncenter = [0, 0, 0]\nlinear = [1, 0, 0]"),
                Problem::Quadric(QuadricError::NotQuadratic),
            ),
            (
                shape(
                    "quadric]]\ncenter = [0, 0, 0]\nsquares = [1, 0, 0]\nmin = [1, 1, 1]\nmax = [0, 2, 2]",
                ),
                Problem::Quadric(QuadricError::EmptyClip),
            ),
            (
                placed("[[instance]]\nof = 'a'\nscale = [1, 0, 1]"),
                Problem::Placement(PlacementError::Singular),
            ),
            (
                placed("[[instance]]\nof = 'a'\nscale = [1, 1e30, 1]"),
                Problem::Placement(PlacementError::Range),
            ),
            (
                camera("eye = [1, 2, 3]\ntarget = [1, 2, 3]\nfov = 30"),
                Problem::Camera(CameraError::NoDirection),
            ),
            (
                camera("eye = [1, 2, 3]\ntarget = [1, 2, 9]\nfov = 30"),
                Problem::Camera(CameraError::UpAlongView),
            ),
            (
                camera(
                    "eye = [0, 1, 0]\ntarget = [1, 0, 0]\n\
                     frustum = { left = 1, right = 1, bottom = 0, top = 1, distance = 1 }",
                ),
                Problem::Camera(CameraError::NoExtent),
            ),
            (
                camera(
                    "eye = [0, 1, 0]\ntarget = [1, 0, 0]\n\
                     frustum = { left = 0, right = 1, bottom = 0, top = 1, distance = -1 }",
                ),
                Problem::Camera(CameraError::Distance),
            ),
        ];
        for (text, problem) in cases {
            let file = toml::parse(Path::new("t.toml"), &text).unwrap();
            let pool = Pool::new(&file);
            let error = HostScene::new(&file, &pool).err().unwrap();
            assert_eq!(error.place, Some(Place { line: 2, column: 1 }), "{text}");
            assert_eq!(error.problem, problem, "{text}");
        }
    }

    #[test]
    fn impossible_surfaces_and_placements_are_told_in_words() {
        let cases: [(Problem, &str); 13] = [
            (
                QuadricError::NotFinite.into(),
                "quadric: the numbers, and those that follow from them, must be finite",
            ),
            (
                QuadricError::NotQuadratic.into(),
                "quadric: the squares and the products must not all be zero",
            ),
            (
                QuadricError::EmptyClip.into(),
                "quadric: the clip must hold something",
            ),
            (
                QuadricError::ZeroLength.into(),
                "quadric: the two ends must not be the same point",
            ),
            (
                QuadricError::Radius.into(),
                "quadric: a radius must be above zero",
            ),
            (
                QuadricError::Waist.into(),
                "quadric: the waist must be narrower than the ends",
            ),
            (
                QuadricError::Gap.into(),
                "quadric: the gap must be above zero and shorter than the distance of the ends",
            ),
            (
                TorusError::NotFinite.into(),
                "torus: the numbers must be finite",
            ),
            (
                TorusError::ZeroAxis.into(),
                "torus: the axis must not be zero",
            ),
            (
                TorusError::Radii.into(),
                "torus: the minor radius must be above zero and below the major one",
            ),
            (
                PlacementError::NotFinite.into(),
                "instance: the numbers of a placement must be finite",
            ),
            (
                PlacementError::Singular.into(),
                "instance: the matrix must not be flat: it cannot be undone",
            ),
            (
                PlacementError::Range.into(),
                "instance: the matrix must not stretch or shrink by more than 2^62",
            ),
        ];
        for (problem, text) in cases {
            assert_eq!(problem.to_string(), text);
        }
    }

    #[test]
    fn equal_materials_of_different_names_are_one() {
        let file = toml::parse(
            Path::new("t.toml"),
            "[material.a]\n[material.b]\n[material.c]\ndiffuse = 0.5",
        )
        .unwrap();
        assert_eq!(file.materials.len(), 3);
        assert_eq!(Pool::new(&file).materials().len(), 2);
    }

    #[test]
    fn hits_name_objects_of_the_file() {
        let file = nff_file(
            "f 1 1 1 1 0 0 0 0\np 3 0 0 0 1 0 0 0 1 0\ns 9 0 0 1\n\
             pp 4 0 0 3 0 0 1 1 0 3 0 0 1 1 1 3 0 0 1 0 1 3 0 0 1\ns 5 0 0 1\n\
             p 4 0 0 -1 1 0 -1 1 1 -1 0 1 -1",
        );
        let pool = Pool::new(&file);
        let scene = HostScene::new(&file, &pool).unwrap();
        let geometry = scene.geometry();
        assert_eq!(geometry.len(), 6);
        let of_kind: Vec<_> = (0..6).map(|it| scene.in_file(it).index).collect();
        assert_eq!(of_kind, [1, 3, 4, 0, 2, 2]);
    }

    #[test]
    fn angles_are_vertical_or_the_same_both_ways() {
        let file = nff_file("v from 0 0 5 at 0 0 0 up 0 1 0 angle 90 hither 1 resolution 8 8");
        let half_extent = |file: &SceneFile| {
            let pool = Pool::new(file);
            let scene = HostScene::new(file, &pool).unwrap();
            let camera = scene.camera(200, 100).unwrap().unwrap().camera;
            [camera.right.length() / 2.0, camera.down.length() / 2.0]
        };
        assert_eq!(half_extent(&file), [1.0, 1.0]);
        let camera = "[camera]\neye = [0, 0, 5]\ntarget = [0, 0, 0]\n";
        let parse = |lens: &str| toml::parse(Path::new("t"), &format!("{camera}{lens}")).unwrap();
        assert_eq!(half_extent(&parse("fov = 90")), [2.0, 1.0]);
        let window = "frustum = { left = -4e-30, right = 4e-30, bottom = -1e-30, top = 1e-30, \
                      distance = 2e-30 }";
        let [width, height] = half_extent(&parse(window));
        assert!(
            (width / height - 4.0).abs() < 1e-6,
            "the window is stretched to the picture"
        );
    }

    #[test]
    fn scenes_without_a_camera_have_none() {
        let file = nff_file("b 0 0 0");
        let pool = Pool::new(&file);
        assert_eq!(HostScene::new(&file, &pool).unwrap().camera(8, 8), Ok(None));
    }
}
