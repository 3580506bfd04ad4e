//! Light along rays: T. Whitted's illumination model without recursion.
//!
//! "An Improved Illumination Model for Shaded Display", CACM 23(6), 1980. At a hit point, with N turned
//! to the ray, L unit towards a light of intensity I, and R the view direction mirrored at N:
//!
//! `ambient·color·A + Σ [N·L > 0] S·I·(diffuse·color·(N·L) + specular·max(R·L, 0)^shininess)
//!  + reflectance·trace(reflected) + transmittance·trace(refracted)`
//!
//! S is the [transmittance](crate::Geometry::transmittance) between the point and the light. A ray that
//! meets nothing brings the background; one beyond the depth limit, nothing. At total internal
//! reflection the refracted share follows the mirrored ray, which then weighs both.

use core::marker::PhantomData;

use glam::Vec3;
use heapless::Vec;

use crate::candidates::Candidates;
use crate::geometry::Geometry;
use crate::material::{Finish, Highlight, Medium, MediumOf, Reflection, ShareOf, Transmission};
use crate::math::{self, Exact, Math, Weight, dot, length_squared};
use crate::pattern::{Pattern, Spot};
use crate::ray::{Departure, Hit, Ray};
use crate::scene::{LightSource, Scene};

/// Something that tracing counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// A ray from the camera.
    Primary,
    /// A mirrored ray, total internal reflection included.
    Reflected,
    /// A refracted ray.
    Refracted,
    /// A ray towards a light.
    Shadow,
    /// A hit by any but a shadow ray.
    Hit,
}

/// Who counts. `()` does not, and costs nothing.
pub trait Count {
    /// One more of these.
    fn count(&mut self, event: Event);
}

impl Count for () {
    #[inline(always)]
    fn count(&mut self, _: Event) {}
}

/// How many of each [`Event`] there were.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Rays from the camera.
    pub primary: u64,
    /// Mirrored rays.
    pub reflected: u64,
    /// Refracted rays.
    pub refracted: u64,
    /// Rays towards lights.
    pub shadow: u64,
    /// Hits by any but shadow rays.
    pub hits: u64,
}

impl Count for Counters {
    #[inline]
    fn count(&mut self, event: Event) {
        *match event {
            Event::Primary => &mut self.primary,
            Event::Reflected => &mut self.reflected,
            Event::Refracted => &mut self.refracted,
            Event::Shadow => &mut self.shadow,
            Event::Hit => &mut self.hits,
        } += 1;
    }
}

impl core::ops::AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        self.primary += other.primary;
        self.reflected += other.reflected;
        self.refracted += other.refracted;
        self.shadow += other.shadow;
        self.hits += other.hits;
    }
}

/// How far light is followed, and by which arithmetic.
///
/// `DEPTH` is the most rays from the eye to the last surface, the eye ray counted as 1: 1 is direct
/// light only. It sizes the stack, 40 bytes a level on a 32-bit machine, with [`Tinted`](crate::Tinted)
/// materials 48 and with [`Absorbing`](crate::Absorbing) ones 60.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tracer<const DEPTH: usize, P = Exact, C = ()> {
    /// The most rays from the eye to the last surface, up to `DEPTH`.
    pub depth: usize,
    /// What weighs no more than this in its pixel is not traced, a light or a secondary ray. A light
    /// weighs the sum of its channels, a surface's color 1 and a secondary ray as if it brought 1. With 0,
    /// the default, only what cannot change the picture is left out; by 1/512, nothing that would change
    /// an 8-bit pixel by more than half a step, where no more than 1 is brought.
    pub threshold: f32,
    /// Counts rays and hits; `()` where nobody asks.
    pub counters: C,
    policy: PhantomData<P>,
}

impl<const DEPTH: usize> Tracer<DEPTH> {
    /// The full depth, no threshold, exact arithmetic, nothing counted.
    pub const fn new() -> Self {
        Self::with(())
    }
}

impl<const DEPTH: usize> Default for Tracer<DEPTH> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const DEPTH: usize, P: Math, C> Tracer<DEPTH, P, C> {
    /// The full depth, no threshold, with counters and a [`Math`] policy of choice.
    ///
    /// ```
    /// use whitted::{Counters, Micro, Tracer};
    ///
    /// let counting = Tracer::<5, whitted::Exact, _>::with(Counters::default());
    /// let fast = Tracer::<5, Micro>::with(());
    /// # let _ = (counting, fast);
    /// ```
    pub const fn with(counters: C) -> Self {
        Self {
            depth: DEPTH,
            threshold: 0.0,
            counters,
            policy: PhantomData,
        }
    }
}

/// A ray from a surface, yet to be traced. What all such rays have in common takes no room.
#[derive(Clone, Copy)]
struct Path<W, I> {
    origin: Vec3,
    direction: Vec3,
    departure: Departure,
    /// What it brings is weighed by this.
    throughput: W,
    /// What it goes through.
    medium: I,
    /// How many rays lie between the eye and its end.
    depth: usize,
}

impl<W, I> Path<W, I> {
    #[inline(always)]
    fn ray(&self) -> Ray {
        Ray {
            departure: Some(self.departure),
            ..Ray::new(self.origin, self.direction)
        }
    }
}

/// The mirrored and the refracted ray.
type Children<M> = (Option<PathIn<M>>, Option<PathIn<M>>);

/// A path among objects of a material.
type PathIn<M> = Path<ShareOf<M>, MediumOf<M>>;

/// Looks at the color where a ray hits something.
#[inline(always)]
fn look<G, L>(
    scene: &Scene<'_, G, L>,
    hit: &Hit<'_, G::Material>,
) -> <<G::Material as Finish>::Color as Pattern>::Look
where
    G: Geometry<Material: Finish>,
{
    hit.material.color().look(|mapped| Spot {
        point: hit.point,
        outward: if hit.front { hit.normal } else { -hit.normal },
        uv: if mapped {
            scene.geometry.uv(hit.point, hit.object, 0)
        } else {
            (0.0, 0.0)
        },
    })
}

impl<const DEPTH: usize, P: Math, C: Count> Tracer<DEPTH, P, C> {
    /// Light that arrives along `ray`, from a camera: linear RGB, at least zero, with no upper bound.
    #[inline]
    pub fn radiance<G, L>(&mut self, scene: &Scene<'_, G, L>, ray: Ray) -> Vec3
    where
        G: Geometry<Material: Finish>,
        L: LightSource,
    {
        self.radiance_among(scene, ray, Candidates::ALL)
    }

    /// [`radiance`](Self::radiance) along a ray that meets none but these objects.
    pub fn radiance_among<G, L>(
        &mut self,
        scene: &Scene<'_, G, L>,
        ray: Ray,
        among: Candidates,
    ) -> Vec3
    where
        G: Geometry<Material: Finish>,
        L: LightSource,
    {
        self.counters.count(Event::Primary);
        let mut radiance = Vec3::ZERO;
        // Of two children one is followed in place and one waits. A depth leaves at most one waiting
        // ray, and the deepest has no children, so that DEPTH entries always suffice.
        let mut waiting = Vec::<PathIn<G::Material>, DEPTH>::new();
        let (mut ray, mut among, mut depth) = (ray, among, 1);
        let mut throughput = ShareOf::<G::Material>::splat(1.0);
        let mut medium = MediumOf::<G::Material>::EMPTY;
        // A path ends within `depth` rays, and each ray has at most two children.
        loop {
            let (reflected, refracted) = match scene.geometry.closest_hit_by::<P>(&ray, among) {
                None => {
                    throughput = medium.weigh(throughput, f32::INFINITY);
                    radiance += throughput.weigh(scene.background);
                    (None, None)
                }
                Some(hit) => {
                    self.counters.count(Event::Hit);
                    medium = medium.at_hit(hit.near_side(), hit.material.transmission());
                    throughput = medium.weigh(throughput, hit.t);
                    let mirrored = math::mirror(ray.direction, hit.normal);
                    radiance += self.direct(scene, &hit, mirrored, throughput);
                    self.children(&hit, ray.direction, mirrored, throughput, depth)
                }
            };
            let path = match (reflected, refracted) {
                (Some(reflected), Some(refracted)) => {
                    let fits = waiting.push(refracted).is_ok();
                    debug_assert!(fits, "more than one ray waits at a depth");
                    reflected
                }
                (Some(child), None) | (None, Some(child)) => child,
                (None, None) => match waiting.pop() {
                    Some(path) => path,
                    // Materials and lights may bring what is not a number; a picture has none.
                    None => return radiance.map(math::positive),
                },
            };
            (ray, throughput, depth) = (path.ray(), path.throughput, path.depth);
            medium = path.medium;
            among = scene.geometry.onward(path.departure, 0);
        }
    }

    /// Light that the point scatters by itself, weighed by `throughput`.
    #[inline]
    fn direct<G, L>(
        &mut self,
        scene: &Scene<'_, G, L>,
        hit: &Hit<'_, G::Material>,
        mirrored: Vec3,
        throughput: ShareOf<G::Material>,
    ) -> Vec3
    where
        G: Geometry<Material: Finish>,
        L: LightSource,
    {
        let material = hit.material;
        let color = look(scene, hit);
        let share = throughput.scaled(material.ambient());
        let mut light = share.weigh(material.color().seen(color) * scene.ambient);
        let onward = scene.geometry.onward(
            Departure {
                object: hit.object,
                side: hit.near_side(),
            },
            0,
        );
        for source in scene.lights {
            let to_light = math::sub(&source.position(), &hit.point);
            let height = dot(&hit.normal, &to_light);
            // Also false for NaN, and for a light at the point itself.
            if !math::is_positive(height) {
                continue;
            }
            let (distance, recip) = P::sqrt_and_recip(length_squared(&to_light));
            let direction = math::scale(&to_light, recip);
            // No shadow ray for what cannot be seen, and no power for what lies in shadow.
            let cos = dot(&mirrored, &direction);
            let diffuse = material.diffuse() * (height * recip);
            // A bound from scalars: see `threshold`. Lights are taken not to be black.
            let seen = if self.threshold == 0.0 {
                math::is_positive(diffuse) || math::is_positive(material.highlight().peak(cos))
            } else {
                let weight = throughput.weigh(source.color());
                let most = (diffuse + material.highlight().peak(cos)) * weight.element_sum();
                most > self.threshold
            };
            if !seen {
                continue;
            }
            let mut passed = ShareOf::<G::Material>::splat(1.0);
            if source.casts_shadows() {
                if !L::IS_AREA {
                    self.counters.count(Event::Shadow);
                }
                let mut shadow = hit.back(direction);
                shadow.t_max = distance;
                let among = if P::EXACT {
                    // The surface that is left may lie beside the point where rounding has put that.
                    source
                        .candidates(direction, distance)
                        .with(hit.object)
                        .and(onward)
                } else {
                    Candidates::ALL
                };
                if L::IS_AREA {
                    passed = self.share(scene, source, hit, &shadow);
                } else if <G::Material as Finish>::Transmission::TRANSMITS {
                    passed = scene.geometry.transmittance_by::<P>(&shadow, among);
                } else if scene.geometry.blocks::<P>(&shadow, 0, among) {
                    passed = Weight::splat(0.0);
                }
                if !passed.exceeds(0.0) {
                    continue;
                }
            }
            let mut term = material.color().seen(color) * diffuse;
            if <G::Material as Finish>::Highlight::SHINES {
                term += Vec3::splat(material.highlight().brightness::<P>(cos));
            }
            light += passed.weigh(term * throughput.weigh(source.color()));
        }
        light
    }

    /// Share of an area light that arrives; `center` is the ray to its middle.
    #[inline(always)]
    fn share<G, L>(
        &mut self,
        scene: &Scene<'_, G, L>,
        source: &L,
        hit: &Hit<'_, G::Material>,
        center: &Ray,
    ) -> ShareOf<G::Material>
    where
        G: Geometry<Material: Finish>,
        L: LightSource,
    {
        source.share::<P, _>(hit.normal, center, |shadow| {
            self.counters.count(Event::Shadow);
            if <G::Material as Finish>::Transmission::TRANSMITS {
                scene
                    .geometry
                    .transmittance_by::<P>(shadow, Candidates::ALL)
            } else if scene.geometry.blocks::<P>(shadow, 0, Candidates::ALL) {
                Weight::splat(0.0)
            } else {
                Weight::splat(1.0)
            }
        })
    }

    /// The mirrored and the refracted ray, where they weigh enough.
    #[inline]
    fn children<M: Finish>(
        &mut self,
        hit: &Hit<'_, M>,
        direction: Vec3,
        mirrored: Vec3,
        throughput: ShareOf<M>,
        depth: usize,
    ) -> Children<M> {
        if !(M::Reflection::REFLECTS || M::Transmission::TRANSMITS)
            || depth >= self.depth
            || depth >= DEPTH
        {
            return (None, None);
        }
        let child = |direction, side, share: ShareOf<M>| {
            let throughput = throughput * share;
            throughput.exceeds(self.threshold).then_some(Path {
                origin: hit.point,
                direction,
                departure: Departure {
                    object: hit.object,
                    side,
                },
                throughput,
                medium: MediumOf::<M>::beyond(side, hit.material.transmission()),
                depth: depth + 1,
            })
        };
        let mut reflectance = ShareOf::<M>::splat(hit.material.reflection().reflectance());
        let mut refracted = None;
        if M::Transmission::TRANSMITS {
            let glass = hit.material.transmission();
            let transmittance = ShareOf::<M>::through(glass);
            // Also where refracted light would weigh too little: all of it may be mirrored.
            if transmittance.exceeds(0.0) {
                let eta = if hit.front {
                    1.0 / glass.ior()
                } else {
                    glass.ior()
                };
                match math::refract::<P>(direction, hit.normal, eta) {
                    Some(bent) => refracted = child(bent, hit.far_side(), transmittance),
                    // Total internal reflection.
                    None => reflectance = reflectance + transmittance,
                }
            }
        }
        let reflected = child(math::renormalize(mirrored), hit.near_side(), reflectance);
        if reflected.is_some() {
            self.counters.count(Event::Reflected);
        }
        if refracted.is_some() {
            self.counters.count(Event::Refracted);
        }
        (reflected, refracted)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Object;
    use crate::material::{Absorbing, Glass, Material, Mirror, Tinted};
    use crate::scene::Light;
    use crate::shape::plane::Plane;
    use crate::shape::sphere::Sphere;

    const UP: Ray = Ray::new(Vec3::new(0.0, 0.5, 0.0), Vec3::Y);

    fn mirror(ambient: f32, reflectance: f32) -> Material<(), Mirror> {
        Material {
            color: Vec3::ONE,
            ambient,
            diffuse: 0.0,
            highlight: (),
            reflection: Mirror { reflectance },
            transmission: (),
        }
    }

    #[test]
    fn mirrors_end_at_the_depth_limit_in_black() {
        let silver = mirror(0.125, 0.5);
        let at = |y| Object {
            shape: Plane {
                point: Vec3::Y * y,
                normal: Vec3::Y,
            },
            material: &silver,
        };
        let walls = [at(0.0), at(1.0)];
        let scene = Scene {
            geometry: walls.as_slice(),
            lights: &[] as &[Light],
            background: Vec3::ONE,
            ambient: Vec3::ONE,
        };
        // The series 0.125 (1 + 1/2 + 1/4 …), a term a ray.
        let mut tracer = Tracer::<5, Exact, _>::with(Counters::default());
        assert_eq!(
            tracer.radiance(&scene, UP),
            Vec3::splat(0.125 * (2.0 - 1.0 / 16.0))
        );
        assert_eq!((tracer.counters.reflected, tracer.counters.hits), (4, 5));
        tracer.depth = 1;
        assert_eq!(tracer.radiance(&scene, UP), Vec3::splat(0.125));
        tracer.depth = 9;
        assert_eq!(
            tracer.radiance(&scene, UP),
            Vec3::splat(0.242_187_5),
            "at most DEPTH"
        );
        tracer.threshold = 0.25;
        assert_eq!(
            tracer.radiance(&scene, UP),
            Vec3::splat(0.187_5),
            "1 and 1/2 are above 1/4"
        );
    }

    #[test]
    fn rays_that_meet_nothing_bring_the_background() {
        let silver = mirror(0.0, 0.5);
        let floor = [Object {
            shape: Plane {
                point: Vec3::ZERO,
                normal: Vec3::Y,
            },
            material: &silver,
        }];
        let scene = Scene {
            geometry: floor.as_slice(),
            lights: &[] as &[Light],
            background: Vec3::new(0.2, 0.4, 0.8),
            ambient: Vec3::ONE,
        };
        let mut tracer = Tracer::<2>::new();
        let down = Ray::new(Vec3::Y, Vec3::NEG_Y);
        assert_eq!(tracer.radiance(&scene, UP), scene.background);
        assert_eq!(tracer.radiance(&scene, down), scene.background * 0.5);
    }

    fn glass(transmittance: f32, ior: f32) -> Material<(), (), Glass> {
        Material {
            color: Vec3::ONE,
            ambient: 0.0,
            diffuse: 0.0,
            highlight: (),
            reflection: (),
            transmission: Glass { transmittance, ior },
        }
    }

    fn ball<M>(material: &M) -> Object<'_, Sphere, M> {
        Object {
            shape: Sphere {
                center: Vec3::ZERO,
                radius: 1.0,
            },
            material,
        }
    }

    /// Objects in front of a white background, which is all the light there is.
    fn in_the_open<G: ?Sized>(geometry: &G) -> Scene<'static, &G> {
        Scene {
            geometry,
            lights: &[],
            background: Vec3::ONE,
            ambient: Vec3::ZERO,
        }
    }

    #[test]
    fn a_ray_through_a_lens_s_center_goes_straight_and_is_weighed_twice() {
        let clear = glass(0.5, 1.5);
        let lens = [ball(&clear)];
        let scene = in_the_open(lens.as_slice());
        let ray = Ray::new(Vec3::Z * 4.0, Vec3::NEG_Z);
        let mut tracer = Tracer::<5, Exact, _>::with(Counters::default());
        assert_eq!(tracer.radiance(&scene, ray), Vec3::splat(0.25));
        assert_eq!(
            (tracer.counters.refracted, tracer.counters.reflected),
            (2, 0)
        );
    }

    fn water(tint: Vec3, absorption: Vec3) -> Material<(), (), Absorbing> {
        Material {
            color: Vec3::ONE,
            ambient: 0.0,
            diffuse: 0.0,
            highlight: (),
            reflection: (),
            transmission: Absorbing {
                tint,
                ior: 1.0,
                absorption,
            },
        }
    }

    /// Without rounding.
    fn left(absorption: Vec3, distance: f64) -> Vec3 {
        absorption.map(|rate| libm::exp(-f64::from(rate) * distance) as f32)
    }

    #[test]
    fn glass_colors_what_is_seen_through_it_and_what_it_shades() {
        let red = Material {
            color: Vec3::ONE,
            ambient: 0.0,
            diffuse: 0.0,
            highlight: (),
            reflection: (),
            transmission: Tinted {
                tint: Vec3::new(1.0, 0.5, 0.25),
                ior: 1.5,
            },
        };
        let lens = [ball(&red)];
        let scene = in_the_open(lens.as_slice());
        let through = Vec3::new(1.0, 0.25, 0.0625);
        let ray = Ray::new(Vec3::Z * 4.0, Vec3::NEG_Z);
        assert_eq!(Tracer::<5>::new().radiance(&scene, ray), through);
        assert_eq!(lens.as_slice().transmittance(&ray), through);
        // Total internal reflection keeps all channels.
        let trapped = Ray::new(Vec3::new(0.9, 0.0, 0.0), Vec3::Y);
        assert_eq!(Tracer::<6>::new().radiance(&scene, trapped), Vec3::ZERO);
    }

    #[test]
    fn light_weakens_with_every_length_inside() {
        let absorption = Vec3::new(0.5, 0.0, 2.0);
        let deep = water(Vec3::ONE, absorption);
        let balls = [ball(&deep)];
        let geometry = balls.as_slice();
        let close = |a: Vec3, b: Vec3| assert!((a - b).abs().max_element() < 1e-6, "{a} {b}");
        let ray = Ray::new(Vec3::Z * 4.0, Vec3::NEG_Z);
        let scene = in_the_open(geometry);
        close(
            Tracer::<5>::new().radiance(&scene, ray),
            left(absorption, 2.0),
        );
        close(geometry.transmittance(&ray), left(absorption, 2.0));
        // A light, or a camera, within.
        let ends = Ray { t_max: 3.5, ..ray };
        close(geometry.transmittance(&ends), left(absorption, 0.5));
        let within = Ray::new(Vec3::ZERO, Vec3::NEG_Z);
        close(
            Tracer::<5>::new().radiance(&scene, within),
            left(absorption, 1.0),
        );
        close(geometry.transmittance(&within), left(absorption, 1.0));
        let both = Ray {
            t_max: 0.25,
            ..within
        };
        close(geometry.transmittance(&both), left(absorption, 0.25));
    }

    #[test]
    fn light_that_never_leaves_a_medium_is_absorbed_but_where_nothing_absorbs() {
        let deep = water(Vec3::ONE, Vec3::new(1e-30, 0.0, f32::NAN));
        let sea = [Object {
            shape: Plane {
                point: Vec3::ZERO,
                normal: Vec3::Y,
            },
            material: &deep,
        }];
        let scene = in_the_open(sea.as_slice());
        let down = Ray::new(Vec3::Y, Vec3::NEG_Y);
        let expected = Vec3::new(0.0, 1.0, 1.0);
        assert_eq!(Tracer::<5>::new().radiance(&scene, down), expected);
        assert_eq!(sea.as_slice().transmittance(&down), expected);
    }

    #[test]
    fn colored_shadows_do_not_depend_on_the_order_of_objects() {
        let stuff = [
            water(Vec3::new(0.9, 0.3, 0.77), Vec3::new(0.1, 0.7, 0.31)),
            water(Vec3::new(0.51, 0.99, 0.2), Vec3::new(0.9, 0.0, 0.13)),
        ];
        let at = |z: f32, i: usize| Object {
            shape: Sphere {
                center: Vec3::new(0.3, 0.1, z),
                radius: 1.0,
            },
            material: &stuff[i],
        };
        // Two of them overlap.
        let mut balls = [at(0.0, 0), at(-1.5, 1), at(-5.0, 0), at(-9.0, 1)];
        let ray = Ray::new(Vec3::Z * 4.0, Vec3::NEG_Z);
        let forward = balls.as_slice().transmittance(&ray);
        balls.reverse();
        assert_eq!(balls.as_slice().transmittance(&ray), forward);
        assert!(forward.min_element() > 0.0);
        let opaque = water(Vec3::ZERO, Vec3::ONE);
        let wall = [ball(&opaque)];
        let pair = (balls.as_slice(), wall.as_slice());
        assert_eq!(pair.transmittance(&ray), Vec3::ZERO);
    }

    #[test]
    fn total_internal_reflection_keeps_the_transmitted_share() {
        let clear = glass(0.5, 1.5);
        let lens = [ball(&clear)];
        let scene = in_the_open(lens.as_slice());
        // From inside, beyond the critical angle at every bounce: trapped until the depth ends.
        let trapped = Ray::new(Vec3::new(0.9, 0.0, 0.0), Vec3::Y);
        let mut tracer = Tracer::<6, Exact, _>::with(Counters::default());
        assert_eq!(tracer.radiance(&scene, trapped), Vec3::ZERO);
        assert_eq!(
            (tracer.counters.reflected, tracer.counters.refracted),
            (5, 0)
        );
    }

    #[test]
    fn the_threshold_weighs_what_total_internal_reflection_mirrors_as_a_whole() {
        let clear = Material {
            color: Vec3::ONE,
            ambient: 0.0,
            diffuse: 0.0,
            highlight: (),
            reflection: Mirror { reflectance: 0.25 },
            transmission: Glass {
                transmittance: 0.25,
                ior: 1.5,
            },
        };
        let lens = [ball(&clear)];
        let scene = in_the_open(lens.as_slice());
        let trapped = Ray::new(Vec3::new(0.9, 0.0, 0.0), Vec3::Y);
        let mut tracer = Tracer::<6, Exact, _>::with(Counters::default());
        // Each share is below, both together are not, once.
        tracer.threshold = 0.375;
        tracer.radiance(&scene, trapped);
        assert_eq!(
            (tracer.counters.reflected, tracer.counters.refracted),
            (1, 0)
        );
    }

    #[test]
    fn lights_behind_a_surface_or_at_it_light_nothing() {
        let chalk = Material::matte(Vec3::ONE, 0.0, 1.0);
        let floor = [Object {
            shape: Plane {
                point: Vec3::ZERO,
                normal: Vec3::Y,
            },
            material: &chalk,
        }];
        let light = |x, y| Light {
            position: Vec3::new(x, y, 0.0),
            color: Vec3::ONE,
        };
        let cases = [
            ("above", light(0.0, 3.0), Vec3::ONE, 1),
            ("below", light(0.0, -3.0), Vec3::ZERO, 0),
            ("beside", light(5.0, 0.0), Vec3::ZERO, 0),
            ("at the point", light(0.0, 0.0), Vec3::ZERO, 0),
            ("not a number", light(f32::NAN, 1.0), Vec3::ZERO, 0),
        ];
        for (name, light, expected, shadows) in cases {
            let scene = Scene {
                geometry: floor.as_slice(),
                lights: &[light],
                background: Vec3::ZERO,
                ambient: Vec3::ZERO,
            };
            let mut tracer = Tracer::<1, Exact, _>::with(Counters::default());
            let ray = Ray::new(Vec3::Y, Vec3::NEG_Y);
            assert_eq!(tracer.radiance(&scene, ray), expected, "{name}");
            assert_eq!(tracer.counters.shadow, shadows, "{name}");
        }
    }
}
