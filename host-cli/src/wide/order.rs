//! An order in which many rays find near at hand what the ones before them looked at.
//!
//! Where boxes and objects are more than the near caches hold, a ray waits for memory most of its time.
//! Rays that start in the same cell of a grid, and go about the same way, share what they wait for:
//! M. Pharr, C. Kolb, R. Gershbein, P. Hanrahan, "Rendering Complex Scenes with Memory-Coherent Ray
//! Tracing", SIGGRAPH 1997; B. Moon, Y. Byun, T.-J. Kim et al., "Cache-Oblivious Ray Reordering", ACM
//! Transactions on Graphics 29(3), 2010, for the order of cells.

use whitted::{Ray, Vec3};

/// Cells to an axis, as a power of two.
const CELLS: u32 = 6;

/// The rays' places, by cell along Morton's curve, in a cell by the signs of their directions, and among
/// those as they come. The grid fills a box; what starts outside, or nowhere, counts to some cell at its
/// edge.
pub fn by_cells(rays: &[Ray], [low, high]: [Vec3; 2]) -> Vec<u32> {
    let scale = (1 << CELLS) as f32 / (high - low);
    let last = (1_u32 << CELLS) - 1;
    let key = |ray: &Ray| {
        let cell = (ray.origin - low) * scale;
        // What is below zero or no number becomes zero.
        let cell = cell.to_array().map(|x| (x as u32).min(last));
        let mut key = 0;
        for bit in (0..CELLS).rev() {
            for x in cell {
                key = key << 1 | (x >> bit & 1);
            }
        }
        let signs = ray.direction.to_array().map(f32::is_sign_negative);
        signs.iter().fold(key, |key, &it| key << 1 | u32::from(it))
    };
    let keys = rays.iter().map(key).zip(0_u32..);
    let mut order: Vec<_> = keys
        .map(|(key, place)| u64::from(key) << 32 | u64::from(place))
        .collect();
    order.sort_unstable();
    order.into_iter().map(|it| it as u32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_of_a_cell_and_a_way_come_together() {
        let ray = |x: f32, z: f32| Ray::new(Vec3::new(x, 0.0, 0.0), Vec3::new(0.0, 0.0, z));
        let rays = [
            ray(15.9, 1.0),
            ray(0.1, -1.0),
            ray(15.5, 1.0),
            ray(0.0, 1.0),
            ray(16.0, -1.0),
            ray(0.2, 1.0),
        ];
        let grid = [Vec3::ZERO, Vec3::splat(16.0)];
        assert_eq!(by_cells(&rays, grid), [3, 5, 1, 2, 0, 4]);
    }

    #[test]
    fn cells_follow_the_curve_and_ways_all_signs() {
        let ray = |cell: [f32; 3], signs: [f32; 3]| {
            Ray::new(Vec3::from_array(cell) + 0.5, Vec3::from_array(signs))
        };
        let up = [1.0; 3];
        let rays = [
            ray([0.0, 32.0, 0.0], up),
            ray([1.0, 0.0, 0.0], up),
            ray([0.0, 1.0, 0.0], up),
            ray([0.0, 0.0, 1.0], up),
            ray([0.0; 3], [-1.0, 1.0, 1.0]),
            ray([0.0; 3], [1.0, -1.0, 1.0]),
            ray([0.0; 3], up),
        ];
        assert_eq!(
            by_cells(&rays, [Vec3::ZERO, Vec3::splat(64.0)]),
            [6, 5, 4, 3, 2, 1, 0]
        );
    }

    #[test]
    fn every_ray_comes_once_whatever_its_numbers() {
        let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -0.0];
        let rays = odd.map(|x| Ray::new(Vec3::splat(x), Vec3::splat(-x)));
        for grid in [[Vec3::ZERO, Vec3::ONE], [Vec3::ZERO; 2], [Vec3::NAN; 2]] {
            let mut order = by_cells(&rays, grid);
            order.sort_unstable();
            assert_eq!(order, [0, 1, 2, 3, 4]);
            assert!(by_cells(&[], grid).is_empty());
        }
    }
}
