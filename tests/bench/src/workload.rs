//! Scenes and rays that everybody gets.

use glam::Vec3;
use whitted::math::Exact;
use whitted::{
    Absorbing, Camera, Cuboid, Geometry, Math, Mirror, Object, PhongReal, Ray, Sphere, Triangle,
    View,
};
use whitted_cli::paint::Paint;
use whitted_cli::scene::Material;
use whitted_cli::wide::Kinds;

/// What a renderer needs to know of a hit before it can shade: of a miss, `t` is infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// Distance.
    pub t: f32,
    /// Unit length, turned to the ray.
    pub normal: Vec3,
    /// Which object.
    pub object: u32,
    /// Out of the object's material.
    pub diffuse: f32,
}

impl Answer {
    /// Nothing was hit.
    pub const MISS: Self = Self {
        t: f32::INFINITY,
        normal: Vec3::ZERO,
        object: u32::MAX,
        diffuse: 0.0,
    };

    /// A hit on the surface with this normal, of any length and direction.
    #[inline(always)]
    pub fn new(ray: &Ray, t: f32, object: u32, normal: Vec3, material: &Material) -> Self {
        let normal = normal.normalize();
        Self {
            t,
            normal: if normal.dot(ray.direction) > 0.0 {
                -normal
            } else {
                normal
            },
            object,
            diffuse: material.diffuse,
        }
    }
}

/// Objects of a scene, all of one kind.
#[derive(Clone, Debug)]
pub enum Shapes {
    /// Spheres.
    Spheres(Vec<Object<'static, Sphere, Material>>),
    /// Triangles.
    Triangles(Vec<Object<'static, Triangle, Material>>),
    /// Boxes.
    Cuboids(Vec<Object<'static, Cuboid, Material>>),
}

/// A scene and the rays that are cast into it.
#[derive(Clone, Debug)]
pub struct Workload {
    /// For the report.
    pub name: String,
    /// The objects.
    pub shapes: Shapes,
    /// The sets of rays, by name.
    pub rays: Vec<RaySet>,
}

/// Rays of one sort.
#[derive(Clone, Debug)]
pub struct RaySet {
    /// `primary`, `incoherent` or `shadow`.
    pub name: &'static str,
    /// What is asked.
    pub query: Query,
    /// The rays.
    pub rays: Vec<Ray>,
}

/// What is asked about rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Query {
    /// The nearest hit.
    Nearest,
    /// Whether there is anything.
    Any,
}

impl Shapes {
    /// How many objects there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Spheres(list) => list.len(),
            Self::Triangles(list) => list.len(),
            Self::Cuboids(list) => list.len(),
        }
    }

    /// The objects as a geometry of every kind.
    pub fn kinds(&self) -> Kinds<'_, Material> {
        let mut kinds: Kinds<'_, Material> = (
            &[],
            (
                &[],
                (&[], (&[], (&[], (&[], (&[], (&[] as &[_], &[] as &[_])))))),
            ),
        );
        match self {
            Self::Spheres(list) => kinds.0 = list,
            Self::Triangles(list) => kinds.1.1.1.0 = list,
            Self::Cuboids(list) => kinds.1.1.1.1.1.0 = list,
        }
        kinds
    }

    /// For each object the lower and the upper corner of its box.
    pub fn boxes(&self) -> Vec<[Vec3; 2]> {
        match self {
            Self::Spheres(list) => list
                .iter()
                .map(|it| {
                    let radius = Vec3::splat(it.shape.radius);
                    [it.shape.center - radius, it.shape.center + radius]
                })
                .collect(),
            Self::Triangles(list) => list
                .iter()
                .map(|it| {
                    let [a, b, c] = it.shape.vertices;
                    [a.min(b).min(c), a.max(b).max(c)]
                })
                .collect(),
            Self::Cuboids(list) => list.iter().map(|it| [it.shape.min, it.shape.max]).collect(),
        }
    }

    /// An object's material.
    #[inline(always)]
    pub fn material(&self, object: u32) -> &Material {
        match self {
            Self::Spheres(list) => list[object as usize].material,
            Self::Triangles(list) => list[object as usize].material,
            Self::Cuboids(list) => list[object as usize].material,
        }
    }
}

/// Marsaglia's xorshift64*, the same on every machine.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// `seed` is not zero.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// From 0 to 1.
    pub fn unit(&mut self) -> f32 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 40) as f32 / (1_u32 << 24) as f32
    }

    /// In a cube from -1 to 1.
    pub fn cube(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }

    /// Of unit length.
    pub fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.cube();
            if (0.01..1.0).contains(&v.length_squared()) {
                return Exact::normalize(v);
            }
        }
    }
}

static MATERIALS: [Material; 16] = {
    const PLAIN: Material = Material {
        color: Paint::Plain(Vec3::ONE),
        ambient: 0.0,
        diffuse: 0.0,
        highlight: PhongReal {
            specular: 0.0,
            shininess: 1.0,
        },
        reflection: Mirror { reflectance: 0.0 },
        transmission: Absorbing {
            tint: Vec3::ZERO,
            ior: 1.0,
            absorption: Vec3::ZERO,
        },
    };
    let mut materials = [PLAIN; 16];
    let mut i = 0;
    while i < 16 {
        materials[i].diffuse = i as f32 / 16.0;
        i += 1;
    }
    materials
};

fn material(index: usize) -> &'static Material {
    &MATERIALS[index % 16]
}

/// The ratio of a cube's side to that of `count` cubes that fill it.
fn spacing(count: usize) -> f32 {
    (count as f32).cbrt().recip()
}

/// Spheres strewn in a cube from -1 to 1.
pub fn spheres(count: usize) -> Shapes {
    let mut random = Random::new(0x5eed + count as u64);
    let size = spacing(count);
    let list = (0..count).map(|i| Object {
        shape: Sphere {
            center: random.cube(),
            radius: size * (0.3 + 0.4 * random.unit()),
        },
        material: material(i),
    });
    Shapes::Spheres(list.collect())
}

/// Boxes strewn in a cube from -1 to 1.
pub fn cuboids(count: usize) -> Shapes {
    let mut random = Random::new(0xb0c5 + count as u64);
    let size = spacing(count);
    let list = (0..count).map(|i| {
        let center = random.cube();
        let half = (random.cube() * 0.3 + 0.4) * size;
        Object {
            shape: Cuboid {
                min: center - half,
                max: center + half,
            },
            material: material(i),
        }
    });
    Shapes::Cuboids(list.collect())
}

/// Triangles strewn in a cube from -1 to 1.
pub fn triangles(count: usize) -> Shapes {
    let mut random = Random::new(0x7419 + count as u64);
    let size = spacing(count);
    let mut list = Vec::with_capacity(count);
    while list.len() < count {
        let center = random.cube();
        let vertices = [(); 3].map(|()| center + random.cube() * size);
        if let Ok(shape) = Triangle::new(vertices) {
            let material = material(list.len());
            list.push(Object { shape, material });
        }
    }
    Shapes::Triangles(list)
}

/// A bumpy ball of about `count` triangles that share their edges.
pub fn surface(count: usize) -> Shapes {
    let rings = ((count / 4) as f32).sqrt() as usize;
    let point = |ring: usize, step: usize| {
        let (sin_u, cos_u) = (std::f32::consts::PI * ring as f32 / rings as f32).sin_cos();
        let turn = std::f32::consts::TAU * (step % (2 * rings)) as f32 / (2 * rings) as f32;
        let (sin_v, cos_v) = turn.sin_cos();
        let radius = 0.8 + 0.1 * (9.0 * turn).sin() * sin_u * sin_u + 0.05 * (13.0 * cos_u).cos();
        Vec3::new(sin_u * cos_v, cos_u, sin_u * sin_v) * radius
    };
    let mut list = Vec::new();
    for ring in 0..rings {
        for step in 0..2 * rings {
            let [a, b] = [point(ring, step), point(ring, step + 1)];
            let [c, d] = [point(ring + 1, step), point(ring + 1, step + 1)];
            for vertices in [[a, c, b], [b, c, d]] {
                if let Ok(shape) = Triangle::new(vertices) {
                    let material = material(list.len());
                    list.push(Object { shape, material });
                }
            }
        }
    }
    Shapes::Triangles(list)
}

/// Spheres on spheres, nine on each, a third as large, to a depth of `levels`: the figure of the
/// databases' `balls` (E. Haines, "A Proposal for Standard Graphics Environments", IEEE CG&A 7(11),
/// 1987) with another choice of axes.
pub fn flake(levels: u32) -> Shapes {
    let mut list = Vec::new();
    grow(&mut list, Vec3::ZERO, Vec3::Y, 0.5, levels);
    Shapes::Spheres(list)
}

fn grow(
    list: &mut Vec<Object<'static, Sphere, Material>>,
    center: Vec3,
    up: Vec3,
    radius: f32,
    levels: u32,
) {
    let material = material(list.len());
    list.push(Object {
        shape: Sphere { center, radius },
        material,
    });
    if levels == 0 {
        return;
    }
    let (right, ahead) = up.any_orthonormal_pair();
    for i in 0..9 {
        // Six round the equator, three above, as seen from the ball below.
        let (turn, height): (f32, f32) = if i < 6 {
            (i as f32 / 6.0, 0.0)
        } else {
            ((i as f32 - 5.5) / 3.0, 0.815)
        };
        let (sin, cos) = (turn * std::f32::consts::TAU).sin_cos();
        let flat = (1.0 - height * height).sqrt();
        let direction = up * height + (right * cos + ahead * sin) * flat;
        let center = center + direction * (radius * 4.0 / 3.0);
        grow(list, center, direction, radius / 3.0, levels - 1);
    }
}

impl Workload {
    /// Rays of every set for some shapes: `side` squared primary ones.
    pub fn new(name: impl Into<String>, shapes: Shapes, side: u32) -> Self {
        let eye = Vec3::new(1.9, 1.3, 2.9);
        let camera = Camera::look_at(eye, Vec3::ZERO, Vec3::Y, 0.36, 1.0);
        let view = View {
            camera: camera.expect("the eye is not at the target"),
            width: side,
            height: side,
        };
        let primary: Vec<_> = (0..side).flat_map(|row| view.rays(row)).collect();
        let mut random = Random::new(0xca57);
        let incoherent = (0..side * side)
            .map(|_| Ray::new(random.cube(), random.direction()))
            .collect();
        let light = Vec3::new(-2.0, 4.0, 3.0);
        let wide = whitted_cli::wide::Wide::new(shapes.kinds());
        let shadow = primary
            .iter()
            .filter_map(|ray| {
                let hit = wide.closest_hit(ray)?;
                let to_light = light - hit.point;
                let shadow = hit.back(Exact::normalize(to_light));
                // As a renderer asks: only where the surface faces the light.
                (hit.normal.dot(to_light) > 0.0).then_some(Ray {
                    t_max: to_light.length(),
                    ..shadow
                })
            })
            .collect();
        let set = |name, query, rays| RaySet { name, query, rays };
        Self {
            name: name.into(),
            rays: vec![
                set("primary", Query::Nearest, primary),
                set("incoherent", Query::Nearest, incoherent),
                set("shadow", Query::Any, shadow),
            ],
            shapes,
        }
    }
}
