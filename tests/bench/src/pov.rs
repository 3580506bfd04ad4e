//! Scenes for POV-Ray, from the same scene files.

use std::fmt::Write;

use whitted_cli::scene_file::{Lens, Material, SceneFile, Shape};

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

/// POV-Ray weighs what is scattered by what a material does not transmit.
fn texture(it: &Material) -> String {
    let opacity = 1.0 - it.transmittance;
    let weigh = |x: f64| if opacity > 0.0 { x / opacity } else { 0.0 };
    let mut text = format!(
        "texture {{ pigment {{ rgb {} transmit {} }} finish {{ ambient {} diffuse {}",
        vector(it.color),
        it.transmittance,
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
        let _ = write!(text, " interior {{ ior {} }}", it.ior);
    }
    text
}

/// A scene without planes of its own; negative radii are drawn from both sides.
pub fn write(file: &SceneFile) -> Option<String> {
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
        let _ = writeln!(
            text,
            "light_source {{ {position} rgb {color}{shadowless} }}"
        );
    }
    // Faces of one piece of glass are one object to POV-Ray, or it would not know their inside.
    let mut open = None;
    for object in &file.objects {
        let material = &file.materials[object.material];
        let flat = !matches!(
            object.shape,
            Shape::Sphere { .. } | Shape::Box { .. } | Shape::Frustum { .. }
        );
        let in_union = (flat && material.transmittance > 0.0).then_some(object.material);
        if in_union != open {
            if let Some(material) = open {
                let _ = writeln!(text, "{} }}", texture(&file.materials[material]));
            }
            if in_union.is_some() {
                text.push_str("union {\n");
            }
            open = in_union;
        }
        let texture = if in_union.is_some() {
            String::new()
        } else {
            texture(material)
        };
        let list = |points: &[[f64; 3]]| points.iter().map(|&it| vector(it)).collect::<Vec<_>>();
        let _ = match &object.shape {
            Shape::Sphere { center, radius } => {
                writeln!(
                    text,
                    "sphere {{ {}, {} {texture} }}",
                    vector(*center),
                    radius.abs()
                )
            }
            Shape::Polygon { vertices } => {
                let mut closed = list(vertices);
                closed.push(closed[0].clone());
                writeln!(
                    text,
                    "polygon {{ {}, {} {texture} }}",
                    closed.len(),
                    closed.join(",")
                )
            }
            Shape::Triangle { vertices } => {
                writeln!(
                    text,
                    "triangle {{ {} {texture} }}",
                    list(vertices).join(",")
                )
            }
            Shape::Patch { vertices, normals } => {
                let both: Vec<_> = vertices
                    .iter()
                    .zip(normals)
                    .flat_map(|(&a, &b)| [a, b])
                    .collect();
                writeln!(
                    text,
                    "smooth_triangle {{ {} {texture} }}",
                    list(&both).join(",")
                )
            }
            Shape::Box { min, max } => {
                writeln!(
                    text,
                    "box {{ {}, {} {texture} }}",
                    vector(*min),
                    vector(*max)
                )
            }
            Shape::Frustum {
                base,
                base_radius,
                apex,
                apex_radius,
            } => writeln!(
                text,
                "cone {{ {}, {}, {}, {} open {texture} }}",
                vector(*base),
                base_radius.abs(),
                vector(*apex),
                apex_radius.abs()
            ),
            Shape::Plane { .. } => return None,
        };
    }
    if let Some(material) = open {
        let _ = writeln!(text, "{} }}", texture(&file.materials[material]));
    }
    Some(text)
}
