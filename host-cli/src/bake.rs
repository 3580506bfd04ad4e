//! Scenes as Rust modules of `static`s, for firmware.
//!
//! A module's types name what the scene uses and nothing else: the kinds of its objects, the terms of
//! its materials, whether lights cast shadows, how deep light is followed. Its numbers are the ones
//! that are rendered with here, to the bit, and so are its pictures.

use std::collections::hash_map::Entry;
use std::collections::{BTreeSet, HashMap};
use std::fmt::Write;
use std::mem::size_of;
use std::path::Path;

use whitted::hierarchy::{Child, Node};
use whitted::{Camera, Light, Object, View};

use crate::scene::{self, HostScene, Material};
use kind::{Baked, Kind, Nodes};
use source::{VECTOR, WORD, number, vector};
use terms::Terms;

pub use map::bake_map;

mod kind;
mod map;
mod source;
mod terms;

/// A scene as Rust source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Module {
    /// The source. It needs the `whitted` crate alone.
    pub text: String,
    /// Each array's name, and its bytes where a pointer has 4.
    pub bytes: Vec<(String, usize)>,
}

impl Module {
    /// Bytes of all arrays. The code that renders them comes on top.
    pub fn flash(&self) -> usize {
        self.bytes.iter().map(|it| it.1).sum()
    }
}

/// Writes a scene as Rust source, with the camera and the size of a view if there is one.
pub fn bake(scene: &HostScene<'_>, view: Option<&View>) -> Module {
    bake_with(scene, view, Layout::Fastest)
}

/// How the objects of a kind are put into flash.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layout {
    /// As takes the fewest instructions of a Cortex-M4F.
    #[default]
    Fastest,
    /// As plain slices.
    Slices,
    /// As slices that pass over what a ray cannot meet, where their kind and number allow.
    Culled,
    /// In hierarchies, where there are two objects at least.
    Hierarchies,
}

/// [`bake`] with a layout of choice.
pub fn bake_with(scene: &HostScene<'_>, view: Option<&View>, layout: Layout) -> Module {
    let mut baker = Baker {
        layout,
        ..Baker::default()
    };
    macro_rules! each_kind {
        ($objects:ident => $use:expr) => {{
            let (spheres, (planes, (polygons, (triangles, (patches, (cuboids, curved)))))) =
                scene.geometry();
            let (frusta, (quadrics, tori)) = curved;
            each_kind!($objects => $use; spheres planes polygons triangles patches cuboids frusta
                quadrics tori);
        }};
        ($objects:ident => $use:expr; $($kind:ident)*) => {
            $({
                let $objects = $kind;
                $use;
            })*
        };
    }
    each_kind!(objects => baker.terms.note(objects));
    each_kind!(objects => baker.objects(objects));
    baker.materials();
    baker.lights(scene.scene().lights);
    baker.finish(scene, view)
}

/// What a waiting ray takes of the stack, as [`whitted::Tracer`] says.
const WAITING_RAY: usize = 40;
/// Of a light that knows what lies in which direction.
const MANY_CELLS: usize = 512;
/// Most lights that do: the compiler makes their cells.
const MOST_BUFFERS: usize = 16;
/// The same where all lights would take more than [`MOST_CELL_BYTES`] so.
const FEW_CELLS: usize = 64;
const MOST_CELL_BYTES: usize = 4096;
/// What a waiting box takes, as [`whitted::Hierarchy`] says.
const WAITING_BOX: usize = 8;

/// One kind's part of the geometry.
struct Part {
    /// Its type's name.
    name: &'static str,
    /// Its type.
    definition: String,
    value: String,
    /// Of the part itself, where a pointer has 4.
    bytes: usize,
}

/// The module while it is written.
#[derive(Default)]
struct Baker {
    layout: Layout,
    /// How many objects lights know the directions of: the first, culled ones.
    culled: usize,
    terms: Terms,
    /// Of the `whitted` crate.
    imports: BTreeSet<&'static str>,
    parts: Vec<Part>,
    /// Different ones, as source.
    materials: Vec<String>,
    known_materials: HashMap<String, usize>,
    /// What hierarchies are made of.
    bounds: BTreeSet<&'static str>,
    /// The longest path through any tree; 0 without trees.
    tree_depth: usize,
    light: String,
    /// What comes after the scene itself.
    items: String,
    bytes: Vec<(String, usize)>,
}

/// Adds lines to a string.
macro_rules! lines {
    ($text:expr, $($format:tt)*) => {
        // A string takes everything.
        let _ = writeln!($text, $($format)*);
    };
}

impl Baker {
    fn import(&mut self, names: &[&'static str]) {
        self.imports.extend(names);
    }

    /// The material's place among the different ones.
    fn material(&mut self, material: &Material) -> usize {
        let source = self.terms.source(material);
        let next = self.materials.len();
        match self.known_materials.entry(source) {
            Entry::Occupied(known) => *known.get(),
            Entry::Vacant(new) => {
                self.materials.push(new.key().clone());
                *new.insert(next)
            }
        }
    }

    /// Adds an array of `count` elements, which may share lines.
    fn array(&mut self, name: &str, kind: &str, count: usize, bytes: usize, elements: &[String]) {
        self.bytes.push((name.to_owned(), bytes));
        lines!(self.items, "\n#[rustfmt::skip]");
        lines!(self.items, "#[allow(clippy::approx_constant)]");
        lines!(self.items, "static {name}: [{kind}; {count}] = [");
        for line in elements {
            lines!(self.items, "    {line},");
        }
        lines!(self.items, "];");
    }

    /// Adds an array of whole numbers.
    fn numbers(&mut self, name: &str, (kind, size): (&str, usize), numbers: &[u32]) {
        let lines: Vec<_> = numbers
            .chunks(16)
            .map(|it| it.iter().map(u32::to_string).collect::<Vec<_>>().join(", "))
            .collect();
        self.array(name, kind, numbers.len(), numbers.len() * size, &lines);
    }

    /// Adds all objects of a kind.
    fn objects<S: Kind>(&mut self, objects: &[Object<'_, S, Material>]) {
        if objects.is_empty() {
            return;
        }
        self.import(&["Object", S::TYPE.trim_end_matches("<'static>")]);
        self.import(S::IMPORTS);
        let sources: Vec<_> = objects
            .iter()
            .map(|Object { shape, material }| {
                let (shape, material) = (shape.source(), self.material(material));
                format!("Object {{ shape: {shape}, material: &MATERIALS[{material}] }}")
            })
            .collect();
        let elsewhere: usize = objects.iter().map(|it| it.shape.bytes_elsewhere()).sum();
        let bytes = objects.len() * (S::BYTES + WORD) + elsewhere;
        let array = S::ALL.to_uppercase();
        let kind = format!("Object<'static, {}, SceneMaterial>", S::TYPE);
        let layout = match self.layout {
            Layout::Fastest => {
                S::fastest(objects.len(), self.terms.reflects || self.terms.transmits)
            }
            layout => layout,
        };
        let hierarchy = match layout {
            Layout::Hierarchies => S::hierarchy(objects),
            _ => None,
        };
        match hierarchy {
            None if layout == Layout::Culled && S::CULLED.contains(&objects.len()) => {
                debug_assert!(self.parts.is_empty(), "lights count from the first object");
                self.culled = objects.len();
                self.import(&["Culled"]);
                self.array(&array, &kind, sources.len(), bytes, &sources);
                let (shape, count) = (S::TYPE, objects.len());
                self.parts.push(Part {
                    name: S::ALL,
                    definition: format!("Culled<'static, {shape}, SceneMaterial, {count}>"),
                    value: format!("Culled(&{array})"),
                    bytes: WORD,
                });
            }
            None => {
                self.import(&["Objects"]);
                self.array(&array, &kind, sources.len(), bytes, &sources);
                self.parts.push(Part {
                    name: S::ALL,
                    definition: format!("Objects<{}, SceneMaterial>", S::TYPE),
                    value: format!("&{array}"),
                    bytes: 2 * WORD,
                });
            }
            Some(baked) => {
                let place = |&it: &u32| sources[it as usize].clone();
                let sources: Vec<_> = baked.tree.places.iter().map(place).collect();
                self.array(&array, &kind, sources.len(), bytes, &sources);
                self.hierarchy::<S>(&array, &baked);
            }
        }
    }

    /// Adds a hierarchy over the array of this name.
    fn hierarchy<S: Kind>(&mut self, array: &str, Baked { tree, nodes }: &Baked) {
        self.import(&["Hierarchy"]);
        self.tree_depth = self.tree_depth.max(tree.depth);
        let bound = match nodes {
            Nodes::Boxes(nodes) => {
                self.nodes::<S, _>("Aabb", nodes, |it| {
                    format!("c({}, {}", vector(it.center), vector(it.half))
                });
                "Aabb"
            }
            Nodes::Balls(nodes) => {
                self.nodes::<S, _>("Ball", nodes, |it| {
                    format!("b({}, {}", vector(it.center), number(it.radius))
                });
                "Ball"
            }
        };
        let index = match tree.places.len() {
            0..=0x100 => ("u8", 1),
            0x101..=0x1_0000 => ("u16", 2),
            _ => ("usize", WORD),
        };
        self.numbers(&format!("{}_PLACES", S::NAME), index, &tree.places);
        self.numbers(&format!("{}_SLOTS", S::NAME), index, &tree.slots());
        let (name, kind, slack) = (S::NAME, S::ALL, number(tree.slack));
        let arrays = format!("&{name}_NODES, &{array}, &{name}_PLACES, &{name}_SLOTS, {slack}");
        lines!(self.items, "\n#[rustfmt::skip]");
        lines!(
            self.items,
            "const {name}_TREE: {kind} = match Hierarchy::new({arrays}) {{"
        );
        lines!(self.items, "    Ok(tree) => tree,");
        lines!(
            self.items,
            "    Err(_) => panic!(\"the arrays do not make a tree\"),"
        );
        lines!(self.items, "}};");
        let (shape, index) = (S::TYPE, index.0);
        self.parts.push(Part {
            name: S::ALL,
            definition: format!(
                "Hierarchy<'static, {shape}, SceneMaterial, {bound}, TREE_DEPTH, {index}>"
            ),
            value: format!("{name}_TREE"),
            bytes: 9 * WORD,
        });
    }

    /// Adds the nodes of a hierarchy; `source` is that of a bound, up to its link.
    fn nodes<S: Kind, B>(
        &mut self,
        bound: &'static str,
        nodes: &[Node<B>],
        source: impl Fn(&B) -> String,
    ) {
        self.bounds.insert(bound);
        let child = |it: &Child<B>| format!("{}, {:#x})", source(&it.bound), it.link.bits());
        let node = |Node([a, b]): &Node<B>| format!("Node([{}, {}])", child(a), child(b));
        let sources: Vec<_> = nodes.iter().map(node).collect();
        let (name, kind) = (format!("{}_NODES", S::NAME), format!("Node<{bound}>"));
        self.array(&name, &kind, nodes.len(), size_of_val(nodes), &sources);
    }

    /// Adds the materials that objects have named.
    fn materials(&mut self) {
        self.import(&["Material"]);
        let terms = [
            self.terms.highlight(),
            self.terms.reflection(),
            self.terms.transmission(),
        ];
        self.imports.extend(terms.into_iter().flatten());
        let materials = std::mem::take(&mut self.materials);
        if !materials.is_empty() {
            let bytes = materials.len() * self.terms.bytes();
            let count = materials.len();
            self.array("MATERIALS", "SceneMaterial", count, bytes, &materials);
        }
    }

    fn lights(&mut self, lights: &[scene::Light]) {
        let with_shadows = lights.iter().filter(|it| it.shadows).count();
        let mixed = with_shadows > 0 && with_shadows < lights.len();
        let point = size_of::<Light>();
        // What a light with shadows is, and its bytes.
        let (light, size) = if with_shadows == 0 {
            self.import(&["FillLight"]);
            ("FillLight".to_owned(), point)
        } else if self.culled > 0 && with_shadows <= MOST_BUFFERS {
            self.import(&["Light", "LightBuffer"]);
            let (cell, size) = match self.culled {
                0..=7 => ("i8", 1),
                8..=15 => ("i16", 2),
                _ => ("i32", 4),
            };
            let cells = match lights.len() * size * MANY_CELLS {
                ..=MOST_CELL_BYTES => MANY_CELLS,
                _ => FEW_CELLS,
            };
            // Beside the cells, a window and a reach.
            let size = point + 2 * VECTOR + WORD + cells * size;
            (format!("LightBuffer<{cell}, {cells}>"), size)
        } else {
            self.import(&["Light"]);
            ("Light".to_owned(), point)
        };
        let source = |it: &scene::Light| {
            let (position, color) = (vector(it.position), vector(it.color));
            let fields = format!("{{ position: {position}, color: {color} }}");
            let source = match light.strip_prefix("LightBuffer") {
                Some(kind) => format!("LightBuffer::{kind}::new(Light {fields}, &SPHERES)"),
                None => format!("{light} {fields}"),
            };
            match mixed {
                true => format!("Lamp {{ light: {source}, shadows: {} }}", it.shadows),
                false => source,
            }
        };
        let sources: Vec<_> = lights.iter().map(source).collect();
        let (kind, size) = match mixed {
            true => ("Lamp", size + WORD),
            false => (light.as_str(), size),
        };
        self.array("LIGHTS", kind, lights.len(), lights.len() * size, &sources);
        if mixed {
            self.import(&["Candidates", "LightSource"]);
            self.items.push_str(&LAMP.replace("LIGHT", &light));
        }
        self.light = kind.to_owned();
    }

    /// The whole module.
    fn finish(mut self, scene: &HostScene<'_>, view: Option<&View>) -> Module {
        if self.parts.is_empty() {
            self.import(&["Objects", "Sphere"]);
            self.parts.push(Part {
                name: "Nothing",
                definition: "Objects<Sphere, SceneMaterial>".to_owned(),
                value: "&[]".to_owned(),
                bytes: 2 * WORD,
            });
        }
        self.import(&["Scene", "Vec3"]);
        let parts_bytes: usize = self.parts.iter().map(|it| it.bytes).sum();
        let scene_bytes = parts_bytes + 2 * WORD + 2 * VECTOR;
        self.bytes.insert(0, ("SCENE".to_owned(), scene_bytes));
        let file = scene.file();
        let depth = if self.terms.reflects || self.terms.transmits {
            file.depth
        } else {
            1
        };
        let mut text = self.header(&file.path, depth);

        if view.is_some() {
            self.import(&["Camera", "View"]);
        }
        lines!(text, "");
        for name in &self.imports {
            lines!(text, "use whitted::{name};");
        }
        if self.tree_depth > 0 {
            let bounds: Vec<_> = self.bounds.iter().copied().collect();
            let bounds = bounds.join(", ");
            lines!(
                text,
                "use whitted::hierarchy::{{{bounds}, Child, Link, Node}};"
            );
        }
        let pair = |inner: String, outer: &str| format!("({outer}, {inner})");
        let nested = |item: fn(&Part) -> &str| {
            let mut parts = self.parts.iter().rev().map(item);
            let last = parts.next().unwrap_or_default().to_owned();
            parts.fold(last, pair)
        };
        let scene = scene.scene();
        let (background, ambient) = (vector(scene.background), vector(scene.ambient));
        lines!(text, "\n/// The scene.");
        let types = format!("Scene<'static, SceneGeometry, {}>", self.light);
        lines!(text, "#[rustfmt::skip]");
        lines!(text, "pub static SCENE: {types} = Scene {{");
        lines!(text, "    geometry: {},", nested(|it| &it.value));
        lines!(text, "    lights: &LIGHTS,");
        lines!(text, "    background: {background},");
        lines!(text, "    ambient: {ambient},");
        lines!(text, "}};");
        if let Some(view) = view {
            text.push_str(&view_source(view));
        }
        lines!(
            text,
            "\n/// Longest chain of rays, the eye ray counted as 1."
        );
        lines!(text, "pub const DEPTH: usize = {depth};");
        lines!(
            text,
            "\n/// Lengths here, times 2 to this power, are those of the scene file."
        );
        let exponent = file.scale().exponent;
        lines!(text, "pub const SCALE_EXPONENT: i32 = {exponent};");
        lines!(text, "\n/// What all objects are made of.");
        lines!(text, "pub type SceneMaterial = {};", self.terms.material());
        lines!(text, "\n/// All objects.");
        lines!(text, "#[rustfmt::skip]");
        lines!(text, "pub type SceneGeometry = {};", nested(|it| it.name));
        lines!(text, "");
        for part in &self.parts {
            lines!(text, "type {} = {};", part.name, part.definition);
        }
        text.push_str(VECTOR_HELPER);
        if self.tree_depth > 0 {
            lines!(text, "\n/// Most nodes on the way to an object.");
            lines!(text, "const TREE_DEPTH: usize = {};", self.tree_depth);
        }
        if self.bounds.contains("Aabb") {
            text.push_str(BOX_HELPER);
        }
        if self.bounds.contains("Ball") {
            text.push_str(BALL_HELPER);
        }
        text.push_str(&self.items);
        Module {
            text,
            bytes: self.bytes,
        }
    }

    /// What it is, and what it takes.
    fn header(&self, path: &Path, depth: usize) -> String {
        let mut text = String::new();
        let name = path
            .file_name()
            .unwrap_or(path.as_os_str())
            .to_string_lossy();
        // A name can hold anything, also the end of a line.
        let name: String = name.chars().filter(|it| !it.is_control()).collect();
        lines!(text, "// {name} as data for firmware, by `whitted bake`.");
        lines!(text, "//");
        lines!(
            text,
            "// Bytes of flash where a pointer has 4, code not counted:"
        );
        lines!(text, "//");
        for (name, bytes) in &self.bytes {
            lines!(text, "//   {name:16} {bytes:8}");
        }
        let flash: usize = self.bytes.iter().map(|it| it.1).sum();
        lines!(text, "//   {:16} {flash:8}", "together");
        let rays = if depth > 1 { depth } else { 0 };
        let boxes = self.tree_depth;
        lines!(text, "//");
        lines!(
            text,
            "// Bytes of stack, at most, beside those of calls and registers:"
        );
        lines!(text, "//");
        lines!(text, "//   {rays:2} waiting rays  {:8}", rays * WAITING_RAY);
        lines!(
            text,
            "//   {boxes:2} waiting boxes {:8}",
            boxes * WAITING_BOX
        );
        text
    }
}

/// A view as a constant.
fn view_source(view: &View) -> String {
    let mut text = String::new();
    let Camera {
        eye,
        corner,
        right,
        down,
    } = view.camera;
    lines!(text, "\n/// The camera, and the size of the picture.");
    lines!(text, "#[allow(clippy::approx_constant)]");
    lines!(text, "pub const VIEW: View = View {{");
    lines!(text, "    camera: Camera {{");
    lines!(text, "        eye: {},", vector(eye));
    lines!(text, "        corner: {},", vector(corner));
    lines!(text, "        right: {},", vector(right));
    lines!(text, "        down: {},", vector(down));
    lines!(text, "    }},");
    lines!(text, "    width: {},", view.width);
    lines!(text, "    height: {},", view.height);
    lines!(text, "}};");
    text
}

const VECTOR_HELPER: &str = "
const fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}
";

const BOX_HELPER: &str = "
const fn c(center: Vec3, half: Vec3, link: u32) -> Child<Aabb> {
    let bound = Aabb { center, half };
    let link = Link::from_bits(link);
    Child { bound, link }
}
";

const BALL_HELPER: &str = "
const fn b(center: Vec3, radius: f32, link: u32) -> Child<Ball> {
    let bound = Ball { center, radius };
    let link = Link::from_bits(link);
    Child { bound, link }
}
";

const LAMP: &str = "
/// A point light that casts shadows or not.
pub struct Lamp {
    light: LIGHT,
    shadows: bool,
}

impl LightSource for Lamp {
    fn position(&self) -> Vec3 {
        self.light.position()
    }

    fn color(&self) -> Vec3 {
        self.light.color()
    }

    fn casts_shadows(&self) -> bool {
        self.shadows
    }

    fn candidates(&self, direction: Vec3, distance: f32) -> Candidates {
        self.light.candidates(direction, distance)
    }
}
";
