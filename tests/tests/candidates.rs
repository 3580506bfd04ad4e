//! What a ray's candidates leave out is never met: by rays that graze, from near and far.

use glam::DVec3;
use whitted::camera::Rays;
use whitted::*;
use whitted_tests::lab::random::{Point, Random, Stream};

const MATERIAL: Material = Material::matte(Vec3::ONE, 0.0, 1.0);

fn random(purpose: &str) -> Random {
    Random::new(Stream {
        seed: 1,
        purpose: Stream::purpose(["candidates", purpose]),
        cell: 0,
        chunk: 0,
    })
}

fn power(random: &mut Random, low: f64, high: f64) -> f64 {
    random.between(low, high).exp2()
}

/// A few units in the last place, or many.
fn some_units(random: &mut Random) -> f64 {
    random.signed() * power(random, -25.0, -16.0)
}

/// A sphere that a line touches at `distance` from its origin, but for some units in the last place:
/// on one side of the line, `aside`, unit length.
fn grazing(
    random: &mut Random,
    origin: DVec3,
    direction: DVec3,
    aside: DVec3,
    distance: f64,
) -> Sphere {
    let radius = distance * power(random, -14.0, 1.0);
    let units = some_units(random);
    let away = if random.unit() < 0.7 {
        radius * (1.0 + units) + distance * units
    } else {
        radius * random.between(0.0, 4.0)
    };
    let center = origin + direction * distance + aside * away;
    let sign = if random.unit() < 0.1 { -1.0 } else { 1.0 };
    Sphere {
        center: center.as_vec3(),
        radius: (radius * sign) as f32,
    }
}

fn across(random: &mut Random, direction: DVec3) -> DVec3 {
    DVec3::from(random.across(Point(direction.to_array())).0)
}

fn view(random: &mut Random) -> Option<View> {
    let scale = power(random, -20.0, 20.0);
    let eye = DVec3::from(random.vector(scale).0).as_vec3();
    let target = eye + (DVec3::from(random.direction().0) * scale).as_vec3();
    let up = DVec3::from(random.direction().0).as_vec3();
    let camera = if random.unit() < 0.5 {
        let tan = power(random, -20.0, 6.0) as f32;
        Camera::look_at(eye, target, up, tan, power(random, -2.0, 2.0) as f32)
    } else {
        // A part of a picture, often far aside.
        let mut edges = || {
            let size = power(random, -20.0, 15.0);
            let (a, b) = (size * random.signed(), size * random.signed());
            (a.min(b) as f32, a.max(b) as f32)
        };
        let ((left, right), (bottom, top)) = (edges(), edges());
        Camera::frustum(eye, target, up, left, right, bottom, top, 1.0)
    };
    let mut side = || 1 + random.below(100) as u32;
    camera.ok().map(|camera| View {
        camera,
        width: side(),
        height: side(),
    })
}

#[test]
fn beams_leave_out_nothing_that_is_met() {
    let mut random = random("beams");
    let (mut missed, mut left_out, mut met) = (0_u64, 0_u64, 0_u64);
    for _ in 0..60_000 {
        let Some(view) = view(&mut random) else {
            continue;
        };
        let row = random.below(view.height as usize) as u32;
        let eye = view.camera.eye.as_dvec3();
        let column = random.below(view.width as usize);
        let Some(ray) = view.rays(row).nth(column) else {
            continue;
        };
        let balls: [Object<Sphere>; 4] = [(); 4].map(|()| {
            let size = f64::from(view.camera.eye.abs().max_element());
            let distance = size * power(&mut random, -10.0, 10.0);
            let direction = ray.direction.as_dvec3();
            // Often above or below the row, or right beside its end.
            let aside = match random.below(3) {
                0 => across(&mut random, direction),
                1 => direction.cross(view.camera.right.as_dvec3()).normalize(),
                _ => view.camera.right.as_dvec3().normalize(),
            };
            let aside = if random.unit() < 0.5 { aside } else { -aside };
            Object {
                shape: grazing(&mut random, eye, direction, aside, distance),
                material: &MATERIAL,
            }
        });
        let culled = Culled(&balls);
        let rays: Rays = view.rays(row);
        for (ray, among) in rays.towards(&culled) {
            for (place, ball) in balls.iter().enumerate() {
                let meets = ball.shape.intersect::<Exact>(&ray, &(), None).is_some();
                let candidate = among.contain(place);
                assert!(candidate || !meets, "{view:?} row {row}: {ray:?} {ball:?}");
                met += u64::from(meets);
                missed += u64::from(!meets);
                left_out += u64::from(!candidate);
            }
        }
    }
    println!("{met} met, {missed} missed, {left_out} of them left out");
    assert!(met > 100_000 && left_out > 100_000);
}

/// As the tracer's: towards the light, up to it.
fn to_light(light: &impl LightSource, point: Vec3) -> (Ray, Candidates) {
    let to_light = light.position() - point;
    let (distance, recip) = Exact::sqrt_and_recip(to_light.length_squared());
    let ray = Ray {
        t_max: distance,
        ..Ray::new(point, to_light * recip)
    };
    (ray, light.candidates(ray.direction, distance))
}

#[test]
fn light_buffers_leave_out_nothing_that_is_met() {
    let mut random = random("lights");
    let (mut missed, mut left_out, mut met) = (0_u64, 0_u64, 0_u64);
    for _ in 0..1_000 {
        let scale = power(&mut random, -20.0, 20.0);
        let position = DVec3::from(random.vector(scale).0);
        let light = Light {
            position: position.as_vec3(),
            color: Vec3::ONE,
        };
        let position = light.position.as_dvec3();
        // Some lights stand among the objects, some far from all of them.
        let spread = power(&mut random, -8.0, 2.0);
        let middle = DVec3::from(random.direction().0);
        let mut towards = || (middle + DVec3::from(random.vector(spread).0)).normalize();
        let directions = [(); 12].map(|()| towards());
        let balls: [Object<Sphere>; 12] = directions.map(|direction| {
            let distance = scale * power(&mut random, -8.0, 4.0);
            let aside = across(&mut random, direction);
            Object {
                shape: grazing(&mut random, position, direction, aside, distance),
                material: &MATERIAL,
            }
        });
        let lights = (
            LightBuffer::<i8, 64>::new(light, &balls),
            LightBuffer::<i16, 512>::new(light, &balls),
        );
        for _ in 0..200 {
            let place = random.below(12);
            let sphere = balls[place].shape;
            // Beyond the sphere's edge, or where it was aimed at, or anywhere.
            let direction = match random.below(3) {
                0 => {
                    let to_center = sphere.center.as_dvec3() - position;
                    let radius = f64::from(sphere.radius).abs() * (1.0 + some_units(&mut random));
                    (to_center + across(&mut random, to_center) * radius).normalize()
                }
                1 => directions[place],
                _ => DVec3::from(random.direction().0),
            };
            let distance = scale * power(&mut random, -8.0, 14.0);
            let point = (position + direction * distance).as_vec3();
            for (ray, among) in [to_light(&lights.0, point), to_light(&lights.1, point)] {
                for (place, ball) in balls.iter().enumerate() {
                    let meets = ball.shape.intersect::<Exact>(&ray, &(), None).is_some();
                    let candidate = among.contain(place);
                    assert!(candidate || !meets, "{light:?} {ray:?} {ball:?}");
                    met += u64::from(meets);
                    missed += u64::from(!meets);
                    left_out += u64::from(!candidate);
                }
            }
        }
    }
    println!("{met} met, {missed} missed, {left_out} of them left out");
    assert!(met > 100_000 && left_out > 900_000);
}

/// Six spheres round the light, so that its cells take in every direction, and one more.
fn round(light: DVec3, one: Sphere) -> [Object<'static, Sphere>; 7] {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let around = |it: usize| Sphere {
        center: (light + axes[it % 3] * if it < 3 { 4.0 } else { -4.0 }).as_vec3(),
        radius: 1.9,
    };
    std::array::from_fn(|it| Object {
        shape: if it < 6 { around(it) } else { one },
        material: &MATERIAL,
    })
}

#[test]
fn light_buffers_hold_at_the_borders_of_cells() {
    let mut random = random("cells");
    let mut met = 0;
    for _ in 0..2_000 {
        let light = Light {
            position: DVec3::from(random.vector(1.0).0).as_vec3(),
            color: Vec3::ONE,
        };
        let position = light.position.as_dvec3();
        let direction = DVec3::from(random.direction().0);
        let aside = across(&mut random, direction);
        // Where a small sphere is a candidate no more is a border.
        let probe = Sphere {
            center: (position + direction * 4.0).as_vec3(),
            radius: 0.01,
        };
        let buffer = LightBuffer::<i8, 512>::new(light, &round(position, probe));
        let turned = |by: f64| (direction + aside * by).normalize();
        let is_candidate = |by| buffer.candidates(-turned(by).as_vec3(), 1.0).contain(6);
        let (mut inside, mut outside) = (0.0, 2.0);
        assert!(is_candidate(inside) && !is_candidate(outside));
        for _ in 0..40 {
            let middle = 0.5 * (inside + outside);
            *(if is_candidate(middle) {
                &mut inside
            } else {
                &mut outside
            }) = middle;
        }
        let border = turned(inside);
        let sine = power(&mut random, -22.0, -1.5);
        let beside = border * (1.0 - sine * sine).sqrt()
            + border.cross(direction.cross(aside)).normalize() * sine * random.signed().signum();
        let radius = 4.0 * sine * (1.0 + some_units(&mut random));
        let sphere = Sphere {
            center: (position + beside * 4.0).as_vec3(),
            radius: radius as f32,
        };
        let buffer = LightBuffer::<i8, 512>::new(light, &round(position, sphere));
        for _ in 0..50 {
            let size = some_units(&mut random);
            let noise = DVec3::from(random.vector(size).0);
            let distance = 4.0 * power(&mut random, 0.0, 9.0);
            let point = (position + (border + noise) * distance).as_vec3();
            let (ray, among) = to_light(&buffer, point);
            let meets = sphere.intersect::<Exact>(&ray, &(), None).is_some();
            assert!(among.contain(6) || !meets, "{light:?} {ray:?} {sphere:?}");
            met += u32::from(meets);
        }
    }
    assert!((10_000..90_000).contains(&met), "{met} met");
}

/// Seen from very far, points lie farther off a small sphere than any slack allows for, and a shadow ray
/// may leave it into its inside without ever coming near.
#[test]
fn what_a_shadow_ray_leaves_is_always_a_candidate() {
    let mut random = random("departures");
    let mut lit = 0;
    for _ in 0..400 {
        let balls: [Object<Sphere>; 6] = std::array::from_fn(|it| Object {
            shape: Sphere {
                center: random.vector(if it == 0 { 0.0 } else { 0.1 }).round(),
                radius: -0.01,
            },
            material: &MATERIAL,
        });
        let distance = random.between(0.03, 0.09);
        let light = Light {
            position: (random.direction() * distance).round(),
            color: Vec3::ONE,
        };
        let eye = (random.direction() * 20_000.0).round();
        let Ok(camera) = Camera::look_at(eye, Vec3::ZERO, Vec3::Y, 5e-6, 1.0) else {
            continue;
        };
        let view = View {
            camera,
            width: 48,
            height: 48,
        };
        let plain = Scene {
            geometry: balls.as_slice(),
            lights: &[light],
            background: Vec3::ZERO,
            ambient: Vec3::ZERO,
        };
        let culled = Scene {
            geometry: Culled(&balls),
            lights: &[LightBuffer::<i8, 512>::new(light, &balls)],
            background: Vec3::ZERO,
            ambient: Vec3::ZERO,
        };
        for row in 0..view.height {
            let (mut one, mut other) = (Tracer::<1>::new(), Tracer::<1>::new());
            let expected = picture::row(&plain, &view, row, &mut one);
            let pixels = picture::row(&culled, &view, row, &mut other);
            for (expected, pixel) in expected.zip(pixels) {
                assert_eq!(expected, pixel, "{view:?} {light:?} {balls:?}");
                lit += u32::from(expected != Vec3::ZERO);
            }
        }
    }
    assert!(lit > 30, "{lit} pixels are lit");
}
