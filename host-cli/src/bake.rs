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
use std::sync::Arc;

use embedded_graphics::pixelcolor::RgbColor;
use whitted::hierarchy::{Child, Node};
use whitted::{Camera, Closed, Csg, Light, Object, Placement, View};

use crate::scene::{self, HostGeometry, HostScene, Material};
use crate::scene_file::Step;
use crate::scene_file::texture::{Bitmap, HighBitmap, Texture};
use crate::whole::{HostSolid, Leaf, Placed, Tree, each_leaf};
use kind::{Baked, Kind, Nodes};
use soft::Soft;
use source::{VECTOR, WORD, number, vector, vectors};
use terms::Terms;

pub use map::bake_map;

mod kind;
mod map;
mod soft;
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
    let top = (scene.geometry(), scene.solids());
    let contents: Vec<_> = scene.groups().collect();
    for content in std::iter::once(&top).chain(&contents) {
        baker.note(content);
    }
    baker.content(&top);
    baker.groups(&contents, scene.placed());
    baker.materials();
    baker.lights(scene.scene().lights);
    baker.finish(scene, view)
}

/// Uses all objects of each kind.
macro_rules! each_kind {
    ($geometry:expr, $objects:ident => $use:expr) => {{
        let (spheres, (planes, (polygons, (triangles, (patches, (cuboids, curved)))))) = $geometry;
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

/// Of a light that knows what lies in which direction.
const MANY_CELLS: usize = 512;
/// Most lights that do: the compiler makes their cells.
const MOST_BUFFERS: usize = 16;
/// The same where all lights would take more than [`MOST_CELL_BYTES`] so.
const FEW_CELLS: usize = 64;
const MOST_CELL_BYTES: usize = 4096;
/// What a waiting box takes, as [`whitted::Hierarchy`] says.
const WAITING_BOX: usize = 8;

/// Objects and solids.
type Contents<'s> = (HostGeometry<'s>, &'s [HostSolid<'s>]);

/// One kind's part of the geometry.
struct Part {
    /// Its type's name.
    name: String,
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
    /// Before the names of what is in a group.
    prefix: String,
    /// Types of groups, and of what is in them.
    types: String,
    /// How many objects lights know the directions of: the first, culled ones.
    culled: usize,
    terms: Terms,
    /// Of the `whitted` crate.
    imports: BTreeSet<&'static str>,
    parts: Vec<Part>,
    /// Different ones, as source.
    materials: Vec<String>,
    known_materials: HashMap<String, usize>,
    images: Vec<Arc<Texture>>,
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

    /// A material's source, its image added.
    fn material_source(&mut self, material: &Material) -> String {
        let terms = std::mem::take(&mut self.terms);
        let source = terms.source(material, |it| self.image(it));
        self.terms = terms;
        source
    }

    /// The material's place among the different ones.
    fn material(&mut self, material: &Material) -> usize {
        let source = self.material_source(material);
        let next = self.materials.len();
        match self.known_materials.entry(source) {
            Entry::Occupied(known) => *known.get(),
            Entry::Vacant(new) => {
                self.materials.push(new.key().clone());
                *new.insert(next)
            }
        }
    }

    /// Adds an image, unless it is there, and tells its name.
    fn image(&mut self, texture: &Arc<Texture>) -> String {
        if let Some(known) = self.images.iter().position(|it| it == texture) {
            return format!("IMAGE_{known}");
        }
        let number = self.images.len();
        self.images.push(Arc::clone(texture));
        let array = format!("PIXELS_{number}");
        let (kind, value) = match &**texture {
            Texture::Palette(Bitmap {
                width,
                height,
                texels,
                palette,
            }) => {
                let colors = palette
                    .iter()
                    .map(|[red, green, blue]| format!("Rgb888::new({red}, {green}, {blue})"));
                let (colors, name) = (colors.collect::<Vec<_>>(), format!("COLORS_{number}"));
                self.array(&name, "Rgb888", colors.len(), 3 * colors.len(), &colors);
                let texels: Vec<u32> = texels.iter().map(|&it| it.into()).collect();
                self.numbers(&array, ("u8", 1), &texels);
                let size = format!("width: {width}, height: {height}");
                let value = format!("Texture {{ {size}, texels: &{array}, palette: &{name} }}");
                ("Texture<'static, Rgb888>", value)
            }
            Texture::High(HighBitmap {
                width,
                height,
                pixels,
            }) => {
                let colors = pixels.iter().map(|it| {
                    let (red, green, blue) = (it.r(), it.g(), it.b());
                    format!("Rgb565::new({red}, {green}, {blue})")
                });
                let colors: Vec<_> = colors.collect();
                self.array(&array, "Rgb565", colors.len(), 2 * colors.len(), &colors);
                let size = format!("width: {width}, height: {height}");
                let value = format!("HighColor {{ {size}, pixels: &{array} }}");
                ("HighColor<'static>", value)
            }
        };
        let name = format!("IMAGE_{number}");
        lines!(self.items, "\n#[rustfmt::skip]");
        lines!(self.items, "static {name}: {kind} = {value};");
        let pointers = if kind == "HighColor<'static>" { 2 } else { 4 };
        self.bytes.push((name.clone(), WORD + pointers * WORD));
        name
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

    /// The type's name of something of a group, or of none, and its arrays'.
    fn names(&self, name: &str) -> (String, String) {
        let (kind, array) = (self.prefix.clone(), self.prefix.to_uppercase());
        match array.is_empty() {
            true => (name.to_owned(), name.to_uppercase()),
            false => (
                format!("{kind}{name}"),
                format!("{array}_{}", name.to_uppercase()),
            ),
        }
    }

    /// Takes note of what materials have.
    fn note(&mut self, (geometry, solids): &Contents<'_>) {
        each_kind!(*geometry, objects => self.terms.note(objects));
        for leaf in solids.iter().flat_map(|it| &it.0.leaves) {
            each_leaf!(leaf, it => self.terms.note(std::slice::from_ref(it)));
        }
    }

    /// Adds objects and solids.
    fn content(&mut self, (geometry, solids): &Contents<'_>) {
        each_kind!(*geometry, objects => self.objects(objects));
        for (place, Csg(tree)) in solids.iter().enumerate() {
            self.solid(place, tree);
        }
    }

    /// Adds a solid.
    fn solid(&mut self, place: usize, tree: &Tree<'_>) {
        self.import(&["Csg", "Object"]);
        let (mut crossings, mut bytes) = (0, 0);
        let leaf = |place: usize| each_leaf!(&tree.leaves[place], it => self.leaf(it, &mut crossings, &mut bytes));
        let joined = Tree::fold(tree.steps, leaf, |step, left, right| {
            let operator = match step {
                Step::Union => "Union",
                Step::Intersection => "Intersection",
                _ => "Difference",
            };
            (
                format!("{operator}<{}, {}>", left.0, right.0),
                format!("{operator}({}, {})", left.1, right.1),
            )
        });
        let (kind, value) = joined.unwrap_or_default();
        for step in tree.steps {
            self.imports.extend(match step {
                Step::Leaf => None,
                Step::Union => Some("csg::Union"),
                Step::Intersection => Some("csg::Intersection"),
                Step::Difference => Some("csg::Difference"),
            });
        }
        let (name, item) = self.names(&format!("Solid{place}"));
        let kind = format!("Csg<{kind}, {crossings}>");
        self.item(&item, &kind, &format!("Csg({value})"));
        self.bytes.push((item.clone(), bytes));
        self.parts.push(Part {
            name,
            definition: format!("&'static {kind}"),
            value: format!("&{item}"),
            bytes: WORD,
        });
    }

    /// The type and the value of a leaf; counts how often a ray crosses it, and its bytes.
    fn leaf<S: Kind + Closed>(
        &mut self,
        Object { shape, material }: &Object<'_, S, Material>,
        crossings: &mut usize,
        bytes: &mut usize,
    ) -> (String, String) {
        self.import(&[S::TYPE]);
        self.import(S::IMPORTS);
        *crossings += S::CROSSINGS;
        *bytes += S::BYTES + WORD;
        let (shape, material) = (shape.source(), self.material(material));
        (
            format!("Object<'static, {}, SceneMaterial>", S::TYPE),
            format!("Object {{ shape: {shape}, material: &MATERIALS[{material}] }}"),
        )
    }

    /// Adds a static of its own.
    fn item(&mut self, name: &str, kind: &str, value: &str) {
        lines!(self.items, "\n#[rustfmt::skip]");
        lines!(self.items, "#[allow(clippy::approx_constant)]");
        lines!(self.items, "static {name}: {kind} = {value};");
    }

    /// Adds the groups that are placed, and where.
    fn groups(&mut self, contents: &[Contents<'_>], placed: &[Placed]) {
        for placed in placed.chunk_by(|a, b| a.group == b.group) {
            let group = placed[0].group;
            let top = std::mem::take(&mut self.parts);
            self.prefix = format!("Group{group}");
            self.content(&contents[group]);
            let (name, item) = (std::mem::take(&mut self.prefix), format!("GROUP{group}"));
            let parts = std::mem::replace(&mut self.parts, top);
            for part in &parts {
                lines!(self.types, "#[rustfmt::skip]");
                lines!(self.types, "type {} = {};", part.name, part.definition);
            }
            let kind = nested(&parts, |it| &it.name);
            lines!(self.types, "#[rustfmt::skip]");
            lines!(self.types, "type {name} = {kind};");
            self.item(&item, &name, &nested(&parts, |it| &it.value));
            self.bytes
                .push((item.clone(), parts.iter().map(|it| it.bytes).sum()));
            self.import(&["Instance", "Placement"]);
            let source = |it: &Placed| {
                let translation = vector(it.placement.translation);
                let inverse = vectors(&it.placement.inverse);
                format!(
                    "Instance {{ geometry: &{item}, placement: Placement {{ translation: \
                     {translation}, inverse: {inverse} }} }}"
                )
            };
            let sources: Vec<_> = placed.iter().map(source).collect();
            let array = format!("{item}_PLACED");
            let bytes = placed.len() * (size_of::<Placement>() + WORD);
            let kind = format!("Instance<'static, {name}>");
            self.array(&array, &kind, placed.len(), bytes, &sources);
            self.parts.push(Part {
                name: format!("{name}Placed"),
                definition: format!("&'static [{kind}]"),
                value: format!("&{array}"),
                bytes: 2 * WORD,
            });
        }
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
        let (name, array) = self.names(S::ALL);
        let kind = format!("Object<'static, {}, SceneMaterial>", S::TYPE);
        let layout = match self.layout {
            Layout::Fastest => {
                S::fastest(objects.len(), self.terms.reflects || self.terms.transmits)
            }
            layout => layout,
        };
        let layout = match layout {
            // Lights know directions in the world.
            Layout::Culled if !self.prefix.is_empty() && objects.len() > S::SLICE => {
                Layout::Hierarchies
            }
            Layout::Culled if !self.prefix.is_empty() => Layout::Slices,
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
                    name,
                    definition: format!("Culled<'static, {shape}, SceneMaterial, {count}>"),
                    value: format!("Culled(&{array})"),
                    bytes: WORD,
                });
            }
            None => {
                self.import(&["Objects"]);
                self.array(&array, &kind, sources.len(), bytes, &sources);
                self.parts.push(Part {
                    name,
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
        let (kind, slack) = (self.names(S::ALL).0, number(tree.slack));
        let name = self.names(S::NAME).1;
        self.numbers(&format!("{name}_PLACES"), index, &tree.places);
        self.numbers(&format!("{name}_SLOTS"), index, &tree.slots());
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
            name: kind,
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
        let (name, kind) = (
            format!("{}_NODES", self.names(S::NAME).1),
            format!("Node<{bound}>"),
        );
        self.array(&name, &kind, nodes.len(), size_of_val(nodes), &sources);
    }

    /// Adds the materials that objects have named.
    fn materials(&mut self) {
        self.import(&["Material"]);
        self.imports.extend(self.terms.imports());
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
        let soft = Soft::of(lights);
        // What a light with shadows is, and its bytes.
        let (light, size) = if let Some(soft) = soft {
            self.import(&["AreaLight", "area::Samples"]);
            self.import(soft.imports());
            soft.kind()
        } else if with_shadows == 0 {
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
            let source = match (soft, light.strip_prefix("LightBuffer")) {
                (Some(soft), _) => soft.source(it),
                (None, Some(kind)) => format!("LightBuffer::{kind}::new(Light {fields}, &SPHERES)"),
                (None, None) => format!("{light} {fields}"),
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
            let answer = match soft {
                Some(_) => {
                    self.import(&["LightSource", "Math", "Ray", "scene::Quantity"]);
                    SHARE
                }
                None => {
                    self.import(&["Candidates", "LightSource"]);
                    CANDIDATES
                }
            };
            let lamp = LAMP.replace("ANSWER", answer);
            self.items.push_str(&lamp.replace("LIGHT", &light));
        }
        self.light = kind.to_owned();
    }

    /// The whole module.
    fn finish(mut self, scene: &HostScene<'_>, view: Option<&View>) -> Module {
        if self.parts.is_empty() {
            self.import(&["Objects", "Sphere"]);
            self.parts.push(Part {
                name: "Nothing".to_owned(),
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
        let scene = scene.scene();
        let (background, ambient) = (vector(scene.background), vector(scene.ambient));
        lines!(text, "\n/// The scene.");
        let types = format!("Scene<'static, SceneGeometry, {}>", self.light);
        lines!(text, "#[rustfmt::skip]");
        lines!(text, "pub static SCENE: {types} = Scene {{");
        lines!(
            text,
            "    geometry: {},",
            nested(&self.parts, |it| &it.value)
        );
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
        lines!(
            text,
            "pub type SceneGeometry = {};",
            nested(&self.parts, |it| &it.name)
        );
        lines!(text, "");
        text.push_str(&self.types);
        for part in &self.parts {
            lines!(text, "#[rustfmt::skip]");
            lines!(text, "type {} = {};", part.name, part.definition);
        }
        text.push_str(VECTOR_HELPER);
        text.push_str(&self.terms.paint().unwrap_or_default());
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
        let bytes_of_rays = rays * self.terms.waiting_ray();
        let boxes = self.tree_depth;
        lines!(text, "//");
        lines!(
            text,
            "// Bytes of stack, at most, beside those of calls and registers:"
        );
        lines!(text, "//");
        lines!(text, "//   {rays:2} waiting rays  {bytes_of_rays:8}");
        lines!(
            text,
            "//   {boxes:2} waiting boxes {:8}",
            boxes * WAITING_BOX
        );
        text
    }
}

/// Something of each part, as pairs of pairs.
fn nested(parts: &[Part], item: fn(&Part) -> &str) -> String {
    let mut parts = parts.iter().rev().map(item);
    let last = parts.next().unwrap_or_default().to_owned();
    parts.fold(last, |inner, outer| format!("({outer}, {inner})"))
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
/// A light that casts shadows or not.
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

ANSWER}
";

const CANDIDATES: &str = "    fn candidates(&self, direction: Vec3, distance: f32) -> Candidates {
        self.light.candidates(direction, distance)
    }
";

const SHARE: &str = "    const IS_AREA: bool = true;

    fn share<P: Math, V: Quantity>(
        &self,
        normal: Vec3,
        center: &Ray,
        passes: impl FnMut(&Ray) -> V,
    ) -> V {
        self.light.share::<P, V>(normal, center, passes)
    }
";
