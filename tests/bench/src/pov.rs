//! Scenes for POV-Ray, from the same scene files.

use std::fmt::Write;
use std::io;
use std::path::Path;

use whitted_cli::scene_file::texture::{Bitmap, Texture};
use whitted_cli::scene_file::{
    Area, Extent, Lens, Material, Pattern, Quadric, SceneFile, Shape, Solid, Step,
};

fn vector(v: [f64; 3]) -> String {
    format!("<{:e},{:e},{:e}>", v[0], v[1], v[2])
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn times(v: [f64; 3], factor: f64) -> [f64; 3] {
    v.map(|it| it * factor)
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    times(v, v.map(|it| it * it).iter().sum::<f64>().sqrt().recip())
}

/// What takes a color's place. Solid patterns are looked up a little beneath flat surfaces.
fn pattern(it: &Pattern, clear: &str, outward: [f64; 3]) -> Option<String> {
    let (kind, size) = match it {
        Pattern::Checker {
            colors: [a, b],
            size,
        } => {
            let colors = [a, b].map(|it| format!("rgb {} {clear}", vector(*it)));
            (format!("checker {}", colors.join(", ")), *size)
        }
        Pattern::Stripes {
            colors: [a, b],
            direction,
            size,
        } => {
            let [a, b] = [a, b].map(|it| format!("rgb {} {clear}", vector(*it)));
            let direction = vector(unit(*direction));
            let colors = format!("color_map {{ [0.5 {a}] [0.5 {b}] }}");
            // One of its cells holds both layers.
            (format!("gradient {direction} {colors} scale 2"), *size)
        }
        Pattern::Image { .. } => return None,
    };
    let beneath = vector(times(outward, size / 1024.0));
    Some(format!("{kind} scale {size:e} translate {beneath}"))
}

/// POV-Ray weighs what is scattered by what a material does not transmit, and filters by its color: nothing
/// for another one.
fn texture(it: &Material, outward: [f64; 3]) -> Option<String> {
    let clear = match it.filter {
        [1.0, 1.0, 1.0] => format!("transmit {}", it.transmittance),
        filter if filter == it.color => format!("filter {}", it.transmittance),
        _ => return None,
    };
    let pigment = match &it.pattern {
        Some(it) => pattern(it, &clear, outward)?,
        None => format!("rgb {} {clear}", vector(it.color)),
    };
    Some(finished(it, &pigment))
}

/// A texture with a pigment.
fn finished(it: &Material, pigment: &str) -> String {
    let opacity = 1.0 - it.transmittance;
    let weigh = |x: f64| if opacity > 0.0 { x / opacity } else { 0.0 };
    let mut text = format!(
        "texture {{ pigment {{ {pigment} }} finish {{ ambient {} diffuse {}",
        weigh(it.ambient),
        weigh(it.diffuse)
    );
    if it.specular > 0.0 {
        let _ = write!(text, " phong {} phong_size {}", it.specular, it.shininess);
    }
    if it.reflectance > 0.0 {
        let _ = write!(text, " reflection {{ {} }}", it.reflectance);
    }
    text.push_str(" } }");
    if it.transmittance > 0.0 {
        let _ = write!(text, " interior {{ ior {}", it.ior);
        let most = it
            .absorption
            .iter()
            .fold(0.0, |most: f64, it| most.max(*it));
        if most > 0.0 {
            let color = vector(it.absorption.map(|it| 1.0 - it / most));
            let distance = 1.0 / most;
            let _ = write!(
                text,
                " fade_power 1001 fade_distance {distance:e} fade_color rgb {color}"
            );
        }
        text.push_str(" }");
    }
    text
}

/// Its name, for POV-Ray to find, of a material's image.
fn image_name(source: &Path, material: usize) -> String {
    let image = source.with_extension(format!("{material}.ppm"));
    image.display().to_string()
}

/// An image as a portable pixel map.
fn pixels(of: &Bitmap) -> Vec<u8> {
    let (width, height) = (usize::from(of.width), usize::from(of.height));
    let mut bytes = format!("P6\n{width} {height}\n255\n").into_bytes();
    for (row, column) in (0..height).flat_map(|row| (0..width).map(move |column| (row, column))) {
        let texel = of.texels[column * height + row];
        let color = of.palette.get(usize::from(texel)).copied();
        bytes.extend(color.unwrap_or_default());
    }
    bytes
}

/// An opaque object that shows an image, for the shapes that POV-Ray can lay one over as we do.
fn with_image(of: &Shape, it: &Material, image: &str) -> Option<String> {
    let Some(Pattern::Image {
        repeat,
        blend,
        texture,
    }) = &it.pattern
    else {
        return None;
    };
    if it.transmittance > 0.0 || matches!(**texture, Texture::High(_)) {
        return None;
    }
    // A copy of the image reaches from the origin along both.
    let placed = |kind: u8, [right, up, out, origin]: [[f64; 3]; 4]| {
        let blend = if *blend { "interpolate 2" } else { "" };
        let rows = [
            times(right, 1.0 / repeat[0]),
            times(up, 1.0 / repeat[1]),
            out,
            origin,
        ];
        let rows: Vec<_> = rows
            .as_flattened()
            .iter()
            .map(|x| format!("{x:e}"))
            .collect();
        let map = format!("image_map {{ ppm \"{image}\" gamma 1 map_type {kind} {blend} }}");
        finished(it, &format!("{map} matrix <{}>", rows.join(",")))
    };
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    match *of {
        // Its longitudes count from +x towards +z, ours the other way round, from -z.
        Shape::Sphere { center, .. } if *repeat == [1.0; 2] => {
            let axes = [times(z, -1.0), y, times(x, -1.0), center];
            shape(of, &placed(1, axes))
        }
        Shape::Plane { point, normal } => {
            let out = unit(normal);
            let right = if out[0] == 0.0 && out[2] == 0.0 {
                x
            } else {
                unit([out[2], 0.0, -out[0]])
            };
            shape(of, &placed(0, [right, cross(out, right), out, point]))
        }
        Shape::Box { min, max } => {
            let [width, height, depth] = minus(max, min);
            let (right, up, back) = (times(x, width), times(y, height), times(z, depth));
            let (left, ahead) = (times(right, -1.0), times(back, -1.0));
            let sum = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|i| a[i] + b[i]);
            let faces = [
                ([max[0], min[1], max[2]], ahead, up),
                (min, back, up),
                ([min[0], max[1], max[2]], right, ahead),
                (min, right, back),
                ([min[0], min[1], max[2]], right, up),
                ([max[0], min[1], min[2]], left, up),
            ];
            let faces = faces.map(|(corner, along, across)| {
                let (next, last) = (sum(corner, along), sum(corner, across));
                let vertices = vec![corner, next, sum(next, across), last];
                let out = unit(cross(along, across));
                let texture = placed(0, [along, across, out, corner]);
                shape(&Shape::Polygon { vertices }, &texture)
            });
            faces.into_iter().collect()
        }
        _ => None,
    }
}

/// A normal by Newell's method.
fn newell(vertices: &[[f64; 3]]) -> [f64; 3] {
    let next = vertices.iter().cycle().skip(1);
    let mut normal = [0.0; 3];
    for (&a, &b) in vertices.iter().zip(next) {
        let part = cross(a, b);
        normal = [0, 1, 2].map(|i| normal[i] + part[i]);
    }
    unit(normal)
}

/// A quadric, in POV-Ray's own words where it has some.
fn quadric(form: &Quadric, closed: bool, texture: &str) -> String {
    let open = if closed { "" } else { "open" };
    match *form {
        Quadric::Ellipsoid { center, radii } => format!(
            "sphere {{ 0, 1 scale {} translate {} {texture} }}",
            vector(radii),
            vector(center)
        ),
        Quadric::Cylinder { base, apex, radius } => {
            let (base, apex) = (vector(base), vector(apex));
            format!("cylinder {{ {base}, {apex}, {radius:e} {open} {texture} }}")
        }
        Quadric::Cone {
            base,
            base_radius,
            apex,
            apex_radius,
        } => format!(
            "cone {{ {}, {base_radius:e}, {}, {apex_radius:e} {open} {texture} }}",
            vector(base),
            vector(apex)
        ),
        Quadric::Paraboloid { tip, end, radius } => {
            let way = minus(end, tip);
            let length = norm(way);
            let squared = [0.0, radius * radius / length, 0.0];
            revolution(tip, unit(way), squared, [0.0, length], closed, texture)
        }
        Quadric::Hyperboloid {
            base,
            apex,
            radius,
            waist,
        } => {
            let (center, axis, half) = middle(base, apex);
            let growth = (radius * radius - waist * waist) / (half * half);
            let squared = [waist * waist, 0.0, growth];
            revolution(center, axis, squared, [-half, half], closed, texture)
        }
        Quadric::TwoSheets {
            base,
            apex,
            radius,
            gap,
        } => {
            let (center, axis, half) = middle(base, apex);
            let growth = radius * radius / (half * half - 0.25 * gap * gap);
            let squared = [-0.25 * growth * gap * gap, 0.0, growth];
            revolution(center, axis, squared, [-half, half], closed, texture)
        }
        Quadric::General(ref it) => {
            let mut planes = Vec::new();
            for axis in 0..3 {
                let mut normal = [0.0; 3];
                normal[axis] = 1.0;
                planes.push((normal, it.max[axis]));
                planes.push((times(normal, -1.0), -it.min[axis]));
            }
            if it.axis != [0.0; 3] {
                let axis = unit(it.axis);
                planes.push((axis, it.to));
                planes.push((times(axis, -1.0), -it.from));
            }
            planes.retain(|plane| plane.1.is_finite());
            let [yz, zx, xy] = it.products;
            let coefficients = [it.squares, [xy, zx, yz], it.linear];
            clipped(
                it.center,
                coefficients,
                it.constant,
                &planes,
                closed,
                texture,
            )
        }
    }
}

fn norm(v: [f64; 3]) -> f64 {
    v.map(|it| it * it).iter().sum::<f64>().sqrt()
}

/// The middle between two points, the way from one to the other, and half of its length.
fn middle(base: [f64; 3], apex: [f64; 3]) -> ([f64; 3], [f64; 3], f64) {
    let way = minus(apex, base);
    let center = [0, 1, 2].map(|i| 0.5 * (base[i] + apex[i]));
    (center, unit(way), 0.5 * norm(way))
}

/// The surface whose squared radius is this polynomial of the distance along an axis.
fn revolution(
    center: [f64; 3],
    n: [f64; 3],
    [constant, linear, growth]: [f64; 3],
    [from, to]: [f64; 2],
    closed: bool,
    texture: &str,
) -> String {
    let factor = 1.0 + growth;
    let coefficients = [
        n.map(|x| 1.0 - factor * x * x),
        [n[0] * n[1], n[0] * n[2], n[1] * n[2]].map(|x| -2.0 * factor * x),
        times(n, -linear),
    ];
    let planes = [(n, to), (times(n, -1.0), -from)];
    clipped(center, coefficients, -constant, &planes, closed, texture)
}

/// A quadric behind some planes.
fn clipped(
    center: [f64; 3],
    coefficients: [[f64; 3]; 3],
    constant: f64,
    planes: &[([f64; 3], f64)],
    closed: bool,
    texture: &str,
) -> String {
    let coefficients = coefficients.map(vector).join(", ");
    let planes: String = planes
        .iter()
        .map(|(normal, distance)| format!("plane {{ {}, {distance:e} }} ", vector(*normal)))
        .collect();
    let quadric = format!("quadric {{ {coefficients}, {constant:e}");
    let center = vector(center);
    match (closed, planes.is_empty()) {
        (true, false) => {
            format!("intersection {{ {quadric} }} {planes} translate {center} {texture} }}")
        }
        (_, true) => format!("{quadric} translate {center} {texture} }}"),
        (false, false) => format!(
            "{quadric} clipped_by {{ intersection {{ {planes} }} }} translate {center} {texture} }}"
        ),
    }
}

/// A shape, in POV-Ray's words.
fn shape(of: &Shape, texture: &str) -> Option<String> {
    let list = |points: &[[f64; 3]]| points.iter().map(|&it| vector(it)).collect::<Vec<_>>();
    let text = match of {
        Shape::Sphere { center, radius } => {
            format!(
                "sphere {{ {}, {} {texture} }}",
                vector(*center),
                radius.abs()
            )
        }
        Shape::Polygon { vertices } => {
            let mut closed = list(vertices);
            closed.push(closed[0].clone());
            format!(
                "polygon {{ {}, {} {texture} }}",
                closed.len(),
                closed.join(",")
            )
        }
        Shape::Triangle { vertices } => {
            format!("triangle {{ {} {texture} }}", list(vertices).join(","))
        }
        Shape::Patch { vertices, normals } => {
            let both: Vec<_> = vertices
                .iter()
                .zip(normals)
                .flat_map(|(&a, &b)| [a, b])
                .collect();
            format!("smooth_triangle {{ {} {texture} }}", list(&both).join(","))
        }
        Shape::Box { min, max } => {
            format!("box {{ {}, {} {texture} }}", vector(*min), vector(*max))
        }
        Shape::Frustum {
            base,
            base_radius,
            apex,
            apex_radius,
        } => format!(
            "cone {{ {}, {}, {}, {} open {texture} }}",
            vector(*base),
            base_radius.abs(),
            vector(*apex),
            apex_radius.abs()
        ),
        Shape::Quadric { form, closed } => quadric(form, *closed, texture),
        &Shape::Torus {
            center,
            axis,
            major,
            minor,
        } => {
            // POV-Ray's lies round the second axis of the world.
            let axis = unit(axis);
            let least = (0..3).min_by(|&a, &b| axis[a].abs().total_cmp(&axis[b].abs()));
            let mut other = [0.0; 3];
            other[least.unwrap_or(0)] = 1.0;
            let u = unit(cross(axis, other));
            let rows = [u, axis, cross(u, axis), center].concat();
            let rows: Vec<_> = rows.iter().map(|x| format!("{x:e}")).collect();
            format!(
                "torus {{ {major:e}, {minor:e} sturm matrix <{}> {texture} }}",
                rows.join(",")
            )
        }
        Shape::Plane { point, normal } => {
            let (normal, point) = (vector(unit(*normal)), vector(*point));
            format!("plane {{ {normal}, 0 translate {point} {texture} }}")
        }
    };
    Some(text)
}

/// A solid, in POV-Ray's words.
fn solid(file: &SceneFile, of: &Solid) -> Option<String> {
    let mut materials = of.leaves.iter().map(|it| it.material);
    let first = materials.next()?;
    // Glass is one piece.
    let is_one = materials.all(|it| it == first);
    let mut waiting: Vec<String> = Vec::new();
    let mut leaves = of.leaves.iter();
    for step in &of.steps {
        let word = match step {
            Step::Leaf => {
                let leaf = leaves.next()?;
                let texture = match is_one {
                    true => String::new(),
                    false => texture(&file.materials[leaf.material], [0.0; 3])?,
                };
                waiting.push(match leaf.shape {
                    Shape::Plane { point, normal } => {
                        let normal = unit(normal);
                        let distance: f64 = (0..3).map(|i| point[i] * normal[i]).sum();
                        format!("plane {{ {}, {distance:e} {texture} }}", vector(normal))
                    }
                    ref other => shape(other, &texture)?,
                });
                continue;
            }
            // Without the walls inside.
            Step::Union => "merge",
            Step::Intersection => "intersection",
            Step::Difference => "difference",
        };
        let (right, left) = (waiting.pop()?, waiting.pop()?);
        waiting.push(format!("{word} {{ {left} {right} }}"));
    }
    let texture = match is_one {
        true => texture(&file.materials[first], [0.0; 3])?,
        false => String::new(),
    };
    Some(format!("union {{ {} {texture} }}", waiting.pop()?))
}

/// POV-Ray's samples lie on the edges, too: its light is smaller, so that they lie where ours do. On a
/// disk they lie elsewhere: POV-Ray pulls a square's corners in along the diagonals.
fn area_light(area: &Area) -> String {
    let samples = f64::from(1 << area.samples.most);
    let inner = (samples - 1.0) / samples;
    let ([a, b], kind) = match area.extent {
        Extent::Rect { edges } => (edges, ""),
        Extent::Disk { radius } => {
            let width = 2.0 * radius;
            ([[width, 0.0, 0.0], [0.0, width, 0.0]], " circular orient")
        }
    };
    let [a, b] = [a, b].map(|edge| vector(times(edge, inner)));
    let adaptive = match area.samples.least {
        least if least < area.samples.most => format!(" adaptive {}", least.max(1) - 1),
        _ => String::new(),
    };
    format!(" area_light {a}, {b}, {samples}, {samples}{adaptive}{kind}")
}

/// Writes a scene, and beside it the images in it.
///
/// # Errors
///
/// Where the system has one, or POV-Ray cannot draw this: images of more colors than a palette has or on other
/// shapes than whole spheres, planes and boxes, and glass that filters by another color than its own.
pub fn write(file: &SceneFile, source: &Path) -> io::Result<()> {
    for (index, material) in file.materials.iter().enumerate() {
        if let Some(Pattern::Image { texture, .. }) = &material.pattern
            && let Texture::Palette(bitmap) = &**texture
        {
            std::fs::write(image_name(source, index), pixels(bitmap))?;
        }
    }
    let text = scene(file, source);
    let text = text.ok_or_else(|| io::Error::other("POV-Ray cannot draw this"))?;
    std::fs::write(source, text)
}

/// Negative radii are drawn from both sides.
fn scene(file: &SceneFile, source: &Path) -> Option<String> {
    let camera = file.camera.as_ref()?;
    // Square pictures: both angles are the same.
    let (Lens::Vertical { degrees } | Lens::Both { degrees }) = camera.lens else {
        return None;
    };
    let forward = unit(minus(camera.target, camera.eye));
    let right = unit(cross(forward, camera.up));
    let up = cross(right, forward);
    let height = 2.0 * (degrees.to_radians() / 2.0).tan();
    let mut text = format!(
        "#version 3.7;\nglobal_settings {{ assumed_gamma 1 max_trace_level {} adc_bailout 0 \
         ambient_light rgb {} }}\nbackground {{ rgb {} }}\n\
         camera {{ perspective location {} direction {} right {} up {} }}\n",
        file.depth,
        vector(file.ambient),
        vector(file.background),
        vector(camera.eye),
        vector(forward),
        vector(times(right, height)),
        vector(times(up, height)),
    );
    for light in &file.lights {
        let shadowless = if light.shadows { "" } else { " shadowless" };
        let (position, color) = (vector(light.position), vector(light.color));
        let area = light.area.as_ref().map_or(String::new(), area_light);
        let _ = writeln!(
            text,
            "light_source {{ {position} rgb {color}{area}{shadowless} }}"
        );
    }
    // Faces of one piece of glass are one object to POV-Ray, or it would not know their inside.
    let mut open = None;
    for object in &file.objects {
        let material = &file.materials[object.material];
        if let Some(Pattern::Image { .. }) = material.pattern {
            let image = image_name(source, object.material);
            let _ = writeln!(text, "{}", with_image(&object.shape, material, &image)?);
            continue;
        }
        let flat = !matches!(
            object.shape,
            Shape::Sphere { .. }
                | Shape::Box { .. }
                | Shape::Frustum { .. }
                | Shape::Quadric { .. }
                | Shape::Torus { .. }
        );
        let in_union = (flat && material.transmittance > 0.0).then_some(object.material);
        if in_union != open {
            if let Some(material) = open {
                let _ = writeln!(text, "{} }}", texture(&file.materials[material], [0.0; 3])?);
            }
            if in_union.is_some() {
                text.push_str("union {\n");
            }
            open = in_union;
        }
        let outward = match &object.shape {
            Shape::Plane { normal, .. } => unit(*normal),
            Shape::Polygon { vertices } => newell(vertices),
            _ => [0.0; 3],
        };
        let texture = if in_union.is_some() {
            String::new()
        } else {
            texture(material, outward)?
        };
        let _ = writeln!(text, "{}", shape(&object.shape, &texture)?);
    }
    if let Some(material) = open {
        let _ = writeln!(text, "{} }}", texture(&file.materials[material], [0.0; 3])?);
    }
    for of in &file.solids {
        let _ = writeln!(text, "{}", solid(file, of)?);
    }
    for instance in &file.instances {
        let group = &file.groups[instance.group];
        let rows = [instance.axes.concat(), instance.translation.to_vec()].concat();
        let rows: Vec<_> = rows.iter().map(|x| format!("{x:e}")).collect();
        let shapes = group.objects.iter().map(|it| {
            let material = &file.materials[it.material];
            // POV-Ray's patterns are placed with the shape.
            let texture = material
                .pattern
                .is_none()
                .then(|| texture(material, [0.0; 3]))??;
            shape(&it.shape, &texture)
        });
        for it in shapes.chain(group.solids.iter().map(|it| solid(file, it))) {
            let _ = writeln!(text, "union {{ {} matrix <{}> }}", it?, rows.join(","));
        }
    }
    Some(text)
}
