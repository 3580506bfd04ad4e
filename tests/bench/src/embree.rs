//! Intel's Embree, opened at run time: version 4 or Debian's 3.
//!
//! Built-in triangles and sphere points; spheres and boxes also as user geometry, which for spheres
//! is the faster of its two ways here.

use std::ffi::{c_char, c_int, c_uint, c_void};
use std::sync::OnceLock;

use glam::Vec3;
use libloading::Library;
use whitted::material::Transmission;
use whitted::math::Passage;
use whitted::{
    Candidates, Cuboid, Departure, Exact, Finish, Frustum, Math, Polygon, Ray, Shape, Side, Sphere,
};
use whitted_cli::hierarchy::Bounded;
use whitted_cli::scene::Material;
use whitted_cli::wide::Kinds;

use crate::peer::{Peer, START};
use crate::workload::{Answer, Shapes};

type Handle = *mut c_void;

const TYPE_TRIANGLE: c_int = 0;
const TYPE_SPHERE_POINT: c_int = 50;
const TYPE_USER: c_int = 120;
const BUFFER_INDEX: c_int = 0;
const BUFFER_VERTEX: c_int = 1;
const FORMAT_UINT3: c_int = 0x5003;
const FORMAT_FLOAT3: c_int = 0x9003;
const FORMAT_FLOAT4: c_int = 0x9004;
/// What Embree takes unless asked for more.
const MEDIUM: c_int = 1;
/// With spatial splits.
const HIGH: c_int = 2;
const INVALID: c_uint = u32::MAX;

/// `RTCRay` and `RTCHit` in a row; the hit with room for the fields that version 4 added.
#[repr(C, align(64))]
#[derive(Clone, Copy)]
struct RayHit {
    origin: [f32; 3],
    tnear: f32,
    direction: [f32; 3],
    time: f32,
    tfar: f32,
    mask: c_uint,
    id: c_uint,
    flags: c_uint,
    normal: [f32; 3],
    u: f32,
    v: f32,
    primitive: c_uint,
    geometry: c_uint,
    instance: [c_uint; 2],
}

/// The same for sixteen rays, a row a field.
#[repr(C, align(64))]
struct RayHit16 {
    origin: [[f32; 16]; 3],
    tnear: [f32; 16],
    direction: [[f32; 16]; 3],
    time: [f32; 16],
    tfar: [f32; 16],
    mask: [c_uint; 16],
    id: [c_uint; 16],
    flags: [c_uint; 16],
    normal: [[f32; 16]; 3],
    u: [f32; 16],
    v: [f32; 16],
    primitive: [c_uint; 16],
    geometry: [c_uint; 16],
    instance: [[c_uint; 16]; 2],
}

/// Version 3's `RTCIntersectContext`.
#[repr(C)]
struct Context {
    flags: c_uint,
    filter: Handle,
    instance: c_uint,
    min_width: f32,
}

#[repr(C)]
struct BoundsArguments {
    user: *const Objects,
    primitive: c_uint,
    time_step: c_uint,
    bounds: *mut [f32; 8],
}

/// Of both `RTCIntersectFunctionN` and `RTCOccludedFunctionN`, for one ray.
#[repr(C)]
struct CallArguments {
    valid: *const c_int,
    user: *const Objects,
    primitive: c_uint,
    context: Handle,
    ray: *mut RayHit,
    count: c_uint,
    geometry: c_uint,
}

/// What user geometry refers to.
enum Objects {
    Spheres(Vec<Sphere>),
    Boxes(Vec<[Vec3; 2]>),
    /// With their places in the scene.
    Any(Vec<(Solid, u32)>),
}

/// Whatever Embree has no kernel for.
enum Solid {
    Sphere(Sphere),
    Polygon(Vec<Vec3>, Vec3),
    Cuboid(Cuboid),
    Frustum(Frustum),
}

impl Solid {
    /// By our own kernels. The object that a ray leaves is in the ray's `id`, less 1.
    #[inline(always)]
    fn meet(&self, place: u32, ray: &RayHit) -> Option<f32> {
        fn meet(shape: &impl Shape, ray: &Ray, left: Option<Side>) -> Option<f32> {
            let setup = shape_setup(shape, ray);
            shape.intersect::<Exact>(ray, &setup, left)
        }
        fn shape_setup<S: Shape>(_: &S, ray: &Ray) -> S::Setup {
            S::setup(ray)
        }
        let side = if ray.flags == 0 {
            Side::Outside
        } else {
            Side::Inside
        };
        let left = (ray.id == place + 1).then_some(side);
        let ray = Ray {
            t_max: ray.tfar,
            ..Ray::new(ray.origin.into(), ray.direction.into())
        };
        match self {
            Self::Sphere(it) => meet(it, &ray, left),
            Self::Cuboid(it) => meet(it, &ray, left),
            Self::Frustum(it) => meet(it, &ray, left),
            Self::Polygon(vertices, normal) => {
                let (vertices, normal) = (vertices.as_slice(), *normal);
                meet(&Polygon { vertices, normal }, &ray, left)
            }
        }
    }

    fn bounds(&self) -> [Vec3; 2] {
        let bounds = match self {
            Self::Sphere(it) => it.bounds(),
            Self::Cuboid(it) => it.bounds(),
            Self::Frustum(it) => it.bounds(),
            Self::Polygon(vertices, normal) => Polygon {
                vertices,
                normal: *normal,
            }
            .bounds(),
        };
        [bounds.min, bounds.max]
    }
}

macro_rules! interface {
    ($($name:ident: $type:ty = $symbol:literal;)*) => {
        /// The functions that are used here.
        #[allow(non_snake_case)]
        struct Interface {
            version: u32,
            $($name: $type,)*
            _library: Library,
        }

        impl Interface {
            fn open(library: Library, version: u32) -> Result<Self, libloading::Error> {
                // SAFETY: the types are those of the headers of version 3 and 4.
                unsafe {
                    Ok(Self {
                        version,
                        $($name: *library.get::<$type>($symbol)?,)*
                        _library: library,
                    })
                }
            }
        }
    };
}

/// Single and packet queries, whose arguments differ between the versions.
type Cast = unsafe extern "C" fn(Handle, *mut c_void, *mut c_void);
type CastPacket = unsafe extern "C" fn(*const c_int, Handle, *mut c_void, *mut c_void);

interface! {
    new_device: unsafe extern "C" fn(*const c_char) -> Handle = b"rtcNewDevice";
    new_scene: unsafe extern "C" fn(Handle) -> Handle = b"rtcNewScene";
    set_quality: unsafe extern "C" fn(Handle, c_int) = b"rtcSetSceneBuildQuality";
    new_geometry: unsafe extern "C" fn(Handle, c_int) -> Handle = b"rtcNewGeometry";
    new_buffer: unsafe extern "C" fn(Handle, c_int, c_uint, c_int, usize, usize) -> *mut c_void
        = b"rtcSetNewGeometryBuffer";
    set_count: unsafe extern "C" fn(Handle, c_uint) = b"rtcSetGeometryUserPrimitiveCount";
    set_user: unsafe extern "C" fn(Handle, *const Objects) = b"rtcSetGeometryUserData";
    set_bounds: unsafe extern "C" fn(
        Handle, unsafe extern "C" fn(*const BoundsArguments), *mut c_void
    ) = b"rtcSetGeometryBoundsFunction";
    set_intersect: unsafe extern "C" fn(Handle, unsafe extern "C" fn(*const CallArguments))
        = b"rtcSetGeometryIntersectFunction";
    set_occluded: unsafe extern "C" fn(Handle, unsafe extern "C" fn(*const CallArguments))
        = b"rtcSetGeometryOccludedFunction";
    commit_geometry: unsafe extern "C" fn(Handle) = b"rtcCommitGeometry";
    attach: unsafe extern "C" fn(Handle, Handle) -> c_uint = b"rtcAttachGeometry";
    release_geometry: unsafe extern "C" fn(Handle) = b"rtcReleaseGeometry";
    commit_scene: unsafe extern "C" fn(Handle) = b"rtcCommitScene";
    release_scene: unsafe extern "C" fn(Handle) = b"rtcReleaseScene";
    release_device: unsafe extern "C" fn(Handle) = b"rtcReleaseDevice";
    intersect: Cast = b"rtcIntersect1";
    occluded: Cast = b"rtcOccluded1";
    intersect16: CastPacket = b"rtcIntersect16";
    occluded16: CastPacket = b"rtcOccluded16";
}

// SAFETY: plain function pointers of a thread-safe library.
unsafe impl Send for Interface {}
// SAFETY: as above.
unsafe impl Sync for Interface {}

/// The library, the newest that is installed, or the one that `WHITTED_EMBREE` names.
fn interface() -> Result<&'static Interface, String> {
    static LOADED: OnceLock<Result<Interface, String>> = OnceLock::new();
    let load = || {
        let named = std::env::var("WHITTED_EMBREE").ok();
        let names = named.iter().map(String::as_str);
        for name in names.chain(["libembree4.so.4", "libembree3.so.3"]) {
            // SAFETY: loading runs Embree's initialisers only.
            let Ok(library) = (unsafe { Library::new(name) }) else {
                continue;
            };
            let version = if name.contains("embree3") { 3 } else { 4 };
            return Interface::open(library, version).map_err(|error| error.to_string());
        }
        Err("not installed (Debian: libembree3-3)".into())
    };
    LOADED.get_or_init(load).as_ref().map_err(Clone::clone)
}

struct Embree {
    interface: &'static Interface,
    device: Handle,
    scene: Handle,
    /// What user geometry refers to; kept where it is.
    objects: Option<Box<Objects>>,
}

impl Drop for Embree {
    fn drop(&mut self) {
        // SAFETY: both are alive and used by nobody else.
        unsafe {
            (self.interface.release_scene)(self.scene);
            (self.interface.release_device)(self.device);
        }
        self.objects = None;
    }
}

/// How the scene is given to Embree.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Geometry {
    BuiltIn,
    User,
}

impl Embree {
    /// A scene without objects.
    fn empty(quality: c_int) -> Result<Self, String> {
        let interface = interface()?;
        // SAFETY: the calls and their order are those of the manual.
        unsafe {
            let device = (interface.new_device)(c"threads=1,set_affinity=0".as_ptr());
            if device.is_null() {
                return Err("no device".into());
            }
            let scene = (interface.new_scene)(device);
            (interface.set_quality)(scene, quality);
            Ok(Self {
                interface,
                device,
                scene,
                objects: None,
            })
        }
    }

    fn new(shapes: &Shapes, geometry: Geometry, quality: c_int) -> Result<Self, String> {
        let mut embree = Self::empty(quality)?;
        let (interface, device, scene) = (embree.interface, embree.device, embree.scene);
        // SAFETY: the calls and their order are those of the manual; buffers are filled to the length
        // that they were asked for, in the layout of their format.
        unsafe {
            let made = match (shapes, geometry) {
                (Shapes::Triangles(list), Geometry::BuiltIn) => {
                    let made = (interface.new_geometry)(device, TYPE_TRIANGLE);
                    let count = 3 * list.len();
                    let vertices: Vec<_> = list.iter().flat_map(|it| it.shape.vertices).collect();
                    let indices: Vec<_> = (0..count as u32).collect();
                    embree.fill(made, BUFFER_VERTEX, FORMAT_FLOAT3, 12, count, &vertices);
                    embree.fill(made, BUFFER_INDEX, FORMAT_UINT3, 12, list.len(), &indices);
                    made
                }
                (Shapes::Spheres(list), Geometry::BuiltIn) => {
                    let made = (interface.new_geometry)(device, TYPE_SPHERE_POINT);
                    let points: Vec<_> = list
                        .iter()
                        .map(|it| it.shape.center.extend(it.shape.radius).to_array())
                        .collect();
                    embree.fill(made, BUFFER_VERTEX, FORMAT_FLOAT4, 16, list.len(), &points);
                    made
                }
                (Shapes::Spheres(list), Geometry::User) => {
                    let spheres = list.iter().map(|it| it.shape).collect();
                    embree.user(Objects::Spheres(spheres), list.len())
                }
                (Shapes::Cuboids(list), Geometry::User) => {
                    embree.user(Objects::Boxes(shapes.boxes()), list.len())
                }
                _ => return Err("has no such geometry".into()),
            };
            (interface.commit_geometry)(made);
            (interface.attach)(scene, made);
            (interface.release_geometry)(made);
            (interface.commit_scene)(scene);
            Ok(embree)
        }
    }

    /// # Safety
    ///
    /// `values` is as many bytes as the buffer.
    unsafe fn fill<T>(
        &self,
        geometry: Handle,
        buffer: c_int,
        format: c_int,
        stride: usize,
        count: usize,
        values: &[T],
    ) {
        assert_eq!(size_of_val(values), stride * count);
        // SAFETY: Embree allocates count * stride bytes, padded.
        unsafe {
            let to = (self.interface.new_buffer)(geometry, buffer, 0, format, stride, count);
            std::ptr::copy_nonoverlapping(values.as_ptr().cast(), to.cast::<u8>(), stride * count);
        }
    }

    /// # Safety
    ///
    /// `count` is the number of objects.
    unsafe fn user(&mut self, objects: Objects, count: usize) -> Handle {
        let objects = Box::new(objects);
        // SAFETY: the box outlives the scene.
        unsafe {
            let made = (self.interface.new_geometry)(self.device, TYPE_USER);
            (self.interface.set_count)(made, count as c_uint);
            (self.interface.set_user)(made, &*objects);
            (self.interface.set_bounds)(made, bounds, std::ptr::null_mut());
            (self.interface.set_intersect)(made, intersect);
            (self.interface.set_occluded)(made, occluded);
            self.objects = Some(objects);
            made
        }
    }

    #[inline(always)]
    fn cast(&self, query: Cast, ray: &mut RayHit) {
        let mut context = CONTEXT;
        let (context, ray): (*mut c_void, *mut c_void) =
            ((&raw mut context).cast(), (&raw mut *ray).cast());
        // SAFETY: the layouts are Embree's.
        unsafe {
            if self.interface.version == 3 {
                query(self.scene, context, ray);
            } else {
                query(self.scene, ray, std::ptr::null_mut());
            }
        }
    }

    #[inline(always)]
    fn cast16(&self, query: CastPacket, valid: &[c_int; 16], ray: &mut RayHit16) {
        #[repr(align(64))]
        struct Valid([c_int; 16]);
        let valid = Valid(*valid);
        let mut context = CONTEXT;
        let (context, ray): (*mut c_void, *mut c_void) =
            ((&raw mut context).cast(), (&raw mut *ray).cast());
        // SAFETY: as above.
        unsafe {
            if self.interface.version == 3 {
                query(valid.0.as_ptr(), self.scene, context, ray);
            } else {
                query(valid.0.as_ptr(), self.scene, ray, std::ptr::null_mut());
            }
        }
    }
}

const CONTEXT: Context = Context {
    flags: 0,
    filter: std::ptr::null_mut(),
    instance: INVALID,
    min_width: 0.0,
};

/// # Safety
///
/// Called by Embree.
unsafe extern "C" fn bounds(arguments: *const BoundsArguments) {
    // SAFETY: Embree's pointers are valid, and the user's is what was given to it.
    let (arguments, objects) = unsafe { (&*arguments, &*(*arguments).user) };
    let [min, max] = match objects {
        Objects::Boxes(list) => list[arguments.primitive as usize],
        Objects::Spheres(list) => {
            let sphere = list[arguments.primitive as usize];
            [sphere.center - sphere.radius, sphere.center + sphere.radius]
        }
        Objects::Any(list) => list[arguments.primitive as usize].0.bounds(),
    };
    // SAFETY: as above.
    unsafe { *arguments.bounds = [min.x, min.y, min.z, 0.0, max.x, max.y, max.z, 0.0] };
}

/// Distance to an object and a normal there, of any length.
#[inline(always)]
fn meet(objects: &Objects, primitive: u32, ray: &RayHit) -> Option<(f32, Vec3)> {
    let (o, d) = (Vec3::from(ray.origin), Vec3::from(ray.direction));
    let admits = |t: f32| t > ray.tnear && t < ray.tfar;
    match objects {
        Objects::Any(list) => {
            let (solid, place) = &list[primitive as usize];
            Some((solid.meet(*place, ray)?, Vec3::ZERO))
        }
        Objects::Spheres(list) => {
            let sphere = &list[primitive as usize];
            let to_center = sphere.center - o;
            let b = to_center.dot(d);
            let miss = to_center - d * b;
            let square = sphere.radius * sphere.radius - miss.length_squared();
            if square < 0.0 {
                return None;
            }
            let half = square.sqrt();
            let t = if admits(b - half) { b - half } else { b + half };
            admits(t).then(|| (t, o + d * t - sphere.center))
        }
        Objects::Boxes(list) => {
            let [min, max] = list[primitive as usize];
            let inverse = d.recip();
            let (a, b) = ((min - o) * inverse, (max - o) * inverse);
            let (near, far) = (a.min(b), a.max(b));
            let (entry, exit) = (near.max_element(), far.min_element());
            if entry > exit {
                return None;
            }
            let t = if admits(entry) { entry } else { exit };
            admits(t).then(|| {
                let on = if t == entry { near } else { far };
                let axis = (0..3).find(|&i| on[i] == t).unwrap_or(0);
                (t, Vec3::AXES[axis])
            })
        }
    }
}

/// # Safety
///
/// Called by Embree.
unsafe extern "C" fn intersect(arguments: *const CallArguments) {
    // SAFETY: as in `bounds`; single rays only are cast into user geometry.
    let (arguments, objects, valid, ray) = unsafe {
        let arguments = &*arguments;
        (
            arguments,
            &*arguments.user,
            *arguments.valid,
            &mut *arguments.ray,
        )
    };
    if valid != 0
        && let Some((t, normal)) = meet(objects, arguments.primitive, ray)
    {
        ray.tfar = t;
        ray.normal = normal.to_array();
        ray.primitive = arguments.primitive;
        ray.geometry = arguments.geometry;
        ray.instance[0] = INVALID;
    }
}

/// # Safety
///
/// Called by Embree.
unsafe extern "C" fn occluded(arguments: *const CallArguments) {
    // SAFETY: as in `intersect`; of the ray's fields only those of `RTCRay` are there.
    unsafe {
        let arguments = &*arguments;
        let ray: *mut RayHit = arguments.ray;
        if *arguments.valid == 0 {
            return;
        }
        let copy = RayHit {
            origin: (*ray).origin,
            tnear: (*ray).tnear,
            direction: (*ray).direction,
            tfar: (*ray).tfar,
            id: (*ray).id,
            flags: (*ray).flags,
            ..EMPTY
        };
        if meet(&*arguments.user, arguments.primitive, &copy).is_some() {
            (*ray).tfar = f32::NEG_INFINITY;
        }
    }
}

const EMPTY: RayHit = RayHit {
    origin: [0.0; 3],
    tnear: 0.0,
    direction: [0.0; 3],
    time: 0.0,
    tfar: 0.0,
    mask: u32::MAX,
    id: 0,
    flags: 0,
    normal: [0.0; 3],
    u: 0.0,
    v: 0.0,
    primitive: INVALID,
    geometry: INVALID,
    instance: [INVALID; 2],
};

/// Rays one at a time.
struct Single<'a> {
    embree: Embree,
    shapes: &'a Shapes,
    geometry: Geometry,
}

/// Rays by sixteen.
struct Packets<'a>(Single<'a>);

impl Single<'_> {
    #[inline(always)]
    fn answer(&self, ray: &Ray, t: f32, primitive: u32, normal: Vec3) -> Answer {
        if primitive == INVALID {
            return Answer::MISS;
        }
        Answer::new(ray, t, primitive, normal, self.shapes.material(primitive))
    }
}

fn start(ray: &Ray) -> f32 {
    if ray.departure.is_some() { START } else { 0.0 }
}

impl Peer for Single<'_> {
    fn name(&self) -> String {
        let user = match (self.geometry, self.shapes) {
            (Geometry::User, Shapes::Spheres(_)) => ", user geometry",
            _ => "",
        };
        format!("Embree {}{user}", self.embree.interface.version)
    }

    fn nearest(&self, rays: &[Ray], answers: &mut [Answer]) {
        let query = self.embree.interface.intersect;
        for (ray, answer) in rays.iter().zip(answers) {
            let mut cast = RayHit {
                origin: ray.origin.to_array(),
                tnear: start(ray),
                direction: ray.direction.to_array(),
                tfar: ray.t_max,
                ..EMPTY
            };
            self.embree.cast(query, &mut cast);
            *answer = self.answer(ray, cast.tfar, cast.primitive, cast.normal.into());
        }
    }

    fn any(&self, rays: &[Ray], answers: &mut [bool]) {
        let query = self.embree.interface.occluded;
        for (ray, answer) in rays.iter().zip(answers) {
            let mut cast = RayHit {
                origin: ray.origin.to_array(),
                tnear: start(ray),
                direction: ray.direction.to_array(),
                tfar: ray.t_max,
                ..EMPTY
            };
            self.embree.cast(query, &mut cast);
            *answer = cast.tfar < 0.0;
        }
    }
}

fn packet(rays: &[Ray]) -> (RayHit16, [c_int; 16]) {
    let mut packet = RayHit16 {
        origin: [[0.0; 16]; 3],
        tnear: [0.0; 16],
        direction: [[0.0; 16]; 3],
        time: [0.0; 16],
        tfar: [0.0; 16],
        mask: [u32::MAX; 16],
        id: [0; 16],
        flags: [0; 16],
        normal: [[0.0; 16]; 3],
        u: [0.0; 16],
        v: [0.0; 16],
        primitive: [INVALID; 16],
        geometry: [INVALID; 16],
        instance: [[INVALID; 16]; 2],
    };
    let mut valid = [0; 16];
    for (lane, ray) in rays.iter().enumerate() {
        for axis in 0..3 {
            packet.origin[axis][lane] = ray.origin[axis];
            packet.direction[axis][lane] = ray.direction[axis];
        }
        packet.tnear[lane] = start(ray);
        packet.tfar[lane] = ray.t_max;
        valid[lane] = -1;
    }
    (packet, valid)
}

impl Peer for Packets<'_> {
    fn name(&self) -> String {
        format!("Embree {}, packets of 16", self.0.embree.interface.version)
    }

    fn nearest(&self, rays: &[Ray], answers: &mut [Answer]) {
        let query = self.0.embree.interface.intersect16;
        for (rays, answers) in rays.chunks(16).zip(answers.chunks_mut(16)) {
            let (mut packet, valid) = packet(rays);
            self.0.embree.cast16(query, &valid, &mut packet);
            for (lane, (ray, answer)) in rays.iter().zip(answers).enumerate() {
                let normal = packet.normal.map(|row| row[lane]);
                *answer = self.0.answer(
                    ray,
                    packet.tfar[lane],
                    packet.primitive[lane],
                    normal.into(),
                );
            }
        }
    }

    fn any(&self, rays: &[Ray], answers: &mut [bool]) {
        let query = self.0.embree.interface.occluded16;
        for (rays, answers) in rays.chunks(16).zip(answers.chunks_mut(16)) {
            let (mut packet, valid) = packet(rays);
            self.0.embree.cast16(query, &valid, &mut packet);
            for (answer, t) in answers.iter_mut().zip(packet.tfar) {
                *answer = t < 0.0;
            }
        }
    }
}

fn single_with(shapes: &Shapes, geometry: Geometry, quality: c_int) -> Result<Single<'_>, String> {
    Ok(Single {
        embree: Embree::new(shapes, geometry, quality)?,
        shapes,
        geometry,
    })
}

/// One ray at a time; boxes, which Embree has not, as user geometry.
pub fn single(shapes: &Shapes) -> Result<Box<dyn Peer + '_>, String> {
    let geometry = match shapes {
        Shapes::Cuboids(_) => Geometry::User,
        _ => Geometry::BuiltIn,
    };
    Ok(Box::new(single_with(shapes, geometry, HIGH)?))
}

/// One ray at a time, in the hierarchy that Embree builds unless asked for a better one.
pub fn medium(shapes: &Shapes) -> Result<Box<dyn Peer + '_>, String> {
    Ok(Box::new(single_with(shapes, Geometry::BuiltIn, MEDIUM)?))
}

/// Spheres by our own function.
pub fn user(shapes: &Shapes) -> Result<Box<dyn Peer + '_>, String> {
    match shapes {
        Shapes::Spheres(_) => Ok(Box::new(single_with(shapes, Geometry::User, HIGH)?)),
        _ => Err("is for spheres".into()),
    }
}

/// Sixteen rays at a time.
pub fn packets(shapes: &Shapes) -> Result<Box<dyn Peer + '_>, String> {
    match shapes {
        Shapes::Cuboids(_) => Err("boxes are user geometry, asked ray by ray".into()),
        _ => Ok(Box::new(Packets(single_with(
            shapes,
            Geometry::BuiltIn,
            HIGH,
        )?))),
    }
}

/// A scene of many kinds on Embree: triangles as its own, all else by our kernels in its hierarchy.
pub struct Intersector<'a> {
    embree: Embree,
    kinds: Kinds<'a, Material>,
    /// For each of its geometries, the places of our objects.
    places: [Vec<u32>; 2],
}

impl<'a> Intersector<'a> {
    /// Builds Embree's hierarchy.
    pub fn new(kinds: Kinds<'a, Material>) -> Result<Self, String> {
        let (spheres, (planes, (polygons, (triangles, (patches, (cuboids, curved)))))) = kinds;
        let (frusta, (quadrics, tori)) = curved;
        if !(planes.is_empty() && quadrics.is_empty() && tori.is_empty()) {
            return Err("planes, quadrics and tori are not for its hierarchy".into());
        }
        let mut solids: Vec<(Solid, u32)> = Vec::new();
        let (mut corners, mut faces) = (Vec::new(), Vec::new());
        let mut opaque = true;
        let mut place = 0;
        macro_rules! each {
            ($list:ident, $it:ident => $solid:expr) => {
                for $it in $list {
                    opaque &= !($it.material.transmission.transmittance() > 0.0);
                    solids.push(($solid, place));
                    place += 1;
                }
            };
            ($list:ident) => {
                for it in $list {
                    opaque &= !(it.material.transmission.transmittance() > 0.0);
                    corners.extend(it.shape.vertices);
                    faces.push(place);
                    place += 1;
                }
            };
        }
        each!(spheres, it => Solid::Sphere(it.shape));
        each!(polygons, it => Solid::Polygon(it.shape.vertices.to_vec(), it.shape.normal));
        each!(triangles);
        each!(patches);
        each!(cuboids, it => Solid::Cuboid(it.shape));
        each!(frusta, it => Solid::Frustum(it.shape));
        if !opaque {
            return Err("glass, which needs every hit".into());
        }
        // Its construction is part of the frame.
        let mut embree = Embree::empty(MEDIUM)?;
        let interface = embree.interface;
        let places = [solids.iter().map(|it| it.1).collect(), faces];
        // SAFETY: as in `Embree::new`. Both geometries are attached, in this order, even if empty.
        unsafe {
            let count = solids.len();
            let user = embree.user(Objects::Any(solids), count);
            let made = (interface.new_geometry)(embree.device, TYPE_TRIANGLE);
            let indices: Vec<_> = (0..corners.len() as u32).collect();
            let faces = corners.len() / 3;
            embree.fill(
                made,
                BUFFER_VERTEX,
                FORMAT_FLOAT3,
                12,
                corners.len(),
                &corners,
            );
            embree.fill(made, BUFFER_INDEX, FORMAT_UINT3, 12, faces, &indices);
            for geometry in [user, made] {
                (interface.commit_geometry)(geometry);
                (interface.attach)(embree.scene, geometry);
                (interface.release_geometry)(geometry);
            }
            (interface.commit_scene)(embree.scene);
        }
        Ok(Self {
            embree,
            kinds,
            places,
        })
    }

    fn ray(ray: &Ray) -> RayHit {
        let (id, flags) = match ray.departure {
            Some(Departure { object, side }) => (object as u32 + 1, side == Side::Inside),
            None => (0, false),
        };
        RayHit {
            origin: ray.origin.to_array(),
            tnear: start(ray),
            direction: ray.direction.to_array(),
            tfar: ray.t_max,
            id,
            flags: flags.into(),
            ..EMPTY
        }
    }
}

impl whitted::Geometry for Intersector<'_> {
    type Material = Material;

    fn len(&self) -> usize {
        self.kinds.len()
    }

    fn nearest<P: Math>(&self, ray: &mut Ray, first: usize, _: Candidates) -> Option<usize> {
        let mut cast = Self::ray(ray);
        self.embree.cast(self.embree.interface.intersect, &mut cast);
        if cast.primitive == INVALID {
            return None;
        }
        ray.t_max = cast.tfar;
        let places = &self.places[cast.geometry as usize & 1];
        Some(first + places[cast.primitive as usize] as usize)
    }

    fn surface<P: Math>(
        &self,
        ray: &Ray,
        t: f32,
        object: usize,
        first: usize,
    ) -> Option<(Vec3, &Material)> {
        self.kinds.surface::<P>(ray, t, object, first)
    }

    fn blocks<P: Math>(&self, ray: &Ray, _: usize, _: Candidates) -> bool {
        let mut cast = Self::ray(ray);
        self.embree.cast(self.embree.interface.occluded, &mut cast);
        cast.tfar < 0.0
    }

    fn absorbs<P: Math, L: Passage>(
        &self,
        ray: &Ray,
        first: usize,
        _: Candidates,
        _: &mut L,
    ) -> bool
    where
        Material: Finish,
    {
        self.blocks::<P>(ray, first, Candidates::ALL)
    }
}
