//! whitted itself: by vectors, and the plain loop that firmware runs.

use whitted::{Geometry, Ray};
use whitted_cli::scene::Material;
use whitted_cli::wide::{Kinds, Wide, lockstep};

use crate::peer::Peer;
use crate::workload::{Answer, Shapes};

struct Ours<G> {
    name: String,
    geometry: G,
}

impl<G: Geometry<Material = Material>> Peer for Ours<G> {
    fn name(&self) -> String {
        self.name.clone()
    }

    fn nearest(&self, rays: &[Ray], answers: &mut [Answer]) {
        for (ray, answer) in rays.iter().zip(answers) {
            *answer = match self.geometry.closest_hit(ray) {
                None => Answer::MISS,
                Some(hit) => Answer {
                    t: hit.t,
                    normal: hit.normal,
                    object: hit.object as u32,
                    diffuse: hit.material.diffuse,
                },
            };
        }
    }

    fn any(&self, rays: &[Ray], answers: &mut [bool]) {
        for (ray, answer) in rays.iter().zip(answers) {
            *answer = self.geometry.occluded(ray);
        }
    }
}

/// All rays of a set in one call, which puts them in order where that helps, and casts neighbours together.
struct Together<'a>(Wide<'a, Material>);

impl Peer for Together<'_> {
    fn name(&self) -> String {
        "whitted, rays together".into()
    }

    fn nearest(&self, rays: &[Ray], answers: &mut [Answer]) {
        answers.fill(Answer::MISS);
        lockstep::closest_hits(&self.0, rays, |ray, hit| {
            answers[ray] = Answer {
                t: hit.t,
                normal: hit.normal,
                object: hit.object as u32,
                diffuse: hit.material.diffuse,
            };
        });
    }

    fn any(&self, rays: &[Ray], answers: &mut [bool]) {
        let mut passed = vec![0.0; rays.len()];
        lockstep::transmittances(&self.0, rays, &mut passed);
        for (passed, answer) in passed.iter().zip(answers) {
            // No object here is transparent.
            *answer = *passed == 0.0;
        }
    }
}

/// The host's geometry, asked about many rays at once.
pub fn together(shapes: &Shapes) -> Result<Box<dyn Peer + '_>, String> {
    Ok(Box::new(Together(Wide::new(shapes.kinds()))))
}

/// The host's geometry.
pub fn wide(shapes: &Shapes) -> Result<Box<dyn Peer + '_>, String> {
    Ok(Box::new(Ours {
        name: "whitted".into(),
        geometry: Wide::new(shapes.kinds()),
    }))
}

/// The host's geometry, restricted to the instructions before AVX-512.
pub fn wide_avx2(shapes: &Shapes) -> Result<Box<dyn Peer + '_>, String> {
    let levels = whitted_cli::wide::levels();
    let (_, level) = levels
        .into_iter()
        .find(|(name, _)| *name == "AVX2")
        .ok_or("this machine has no AVX2")?;
    Ok(Box::new(Ours {
        name: "whitted, AVX2".into(),
        geometry: Wide::with_level(shapes.kinds(), level),
    }))
}

/// The loop over a slice.
pub fn scalar(shapes: &Shapes) -> Result<Box<dyn Peer + '_>, String> {
    fn boxed<'a, G: Geometry<Material = Material> + 'a>(geometry: G) -> Box<dyn Peer + 'a> {
        Box::new(Ours {
            name: "whitted's scalar loop".into(),
            geometry,
        })
    }
    let kinds: Kinds<'_, Material> = shapes.kinds();
    Ok(match shapes {
        Shapes::Spheres(_) => boxed(kinds.0),
        Shapes::Triangles(_) => boxed(kinds.1.1.1.0),
        Shapes::Cuboids(_) => boxed(kinds.1.1.1.1.1.0),
    })
}
