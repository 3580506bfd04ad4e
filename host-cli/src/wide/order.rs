//! An order in which many rays find near at hand what the ones before them looked at.
//!
//! Where boxes and objects are more than the near caches hold, a ray waits for memory most of its time.
//! Rays that start in the same cell of a grid, and go about the same way, share what they wait for:
//! M. Pharr, C. Kolb, R. Gershbein, P. Hanrahan, "Rendering Complex Scenes with Memory-Coherent Ray
//! Tracing", SIGGRAPH 1997; B. Moon, Y. Byun, T.-J. Kim et al., "Cache-Oblivious Ray Reordering", ACM
//! Transactions on Graphics 29(3), 2010, for the order of cells. And those that come one after the other have
//! the most in common, where they are to go together.

use whitted::{Ray, Vec3};

use super::rays::fastest;

/// The rays' places, by cell along Morton's curve, in a cell by the signs of their directions, and among
/// those as they come. The grid fills a box; what starts outside, or nowhere, counts to some cell at its
/// edge.
pub fn by_cells_and_ways(rays: &[Ray], bounds: [Vec3; 2]) -> Vec<u32> {
    let grid = Grid::<6>::new(bounds);
    sorted(
        rays.iter()
            .map(|ray| grid.cell(ray.origin) << 3 | signs(ray.direction)),
    )
}

/// As [`by_cells_and_ways`], of rays that are given by origin and direction: by the signs of the direction, then
/// by the axis that it is closest to, then by coarser cells, and as they come.
pub fn by_ways_and_cells(rays: impl Iterator<Item = [Vec3; 2]>, bounds: [Vec3; 2]) -> Vec<u32> {
    let grid = Grid::<3>::new(bounds);
    sorted(rays.map(|[origin, direction]| {
        let way = signs(direction) << 2 | fastest(direction) as u32;
        // In two bytes: sorting goes by bytes.
        (way << 9 | grid.cell(origin)) as u16
    }))
}

/// As [`by_cells_and_ways`], of points, by cells a little coarser.
pub fn by_cells(points: impl Iterator<Item = Vec3>, bounds: [Vec3; 2]) -> Vec<u32> {
    let grid = Grid::<5>::new(bounds);
    // In two bytes.
    sorted(points.map(|point| grid.cell(point) as u16))
}

/// A box, parted along each axis into so many cells, as a power of two.
struct Grid<const CELLS: u32> {
    low: Vec3,
    scale: Vec3,
}

impl<const CELLS: u32> Grid<CELLS> {
    fn new([low, high]: [Vec3; 2]) -> Self {
        const { assert!(1 << CELLS <= SPREAD.len()) };
        let scale = (1 << CELLS) as f32 / (high - low);
        Self { low, scale }
    }

    /// The place of a point's cell on Morton's curve.
    #[inline(always)]
    fn cell(&self, point: Vec3) -> u32 {
        let last = (1_u32 << CELLS) - 1;
        let cell = (point - self.low) * self.scale;
        // What is below zero or no number becomes zero.
        let cell = cell.to_array().map(|x| (x as u32).min(last));
        let [x, y, z] = cell.map(|x| SPREAD[x as usize]);
        x << 2 | y << 1 | z
    }
}

/// Of each number its bits, three places apart.
static SPREAD: [u32; 64] = {
    let mut spread = [0; 64];
    let mut number = 0;
    while number < spread.len() {
        let mut bit = 0;
        while bit < 6 {
            spread[number] |= (number as u32 >> bit & 1) << (3 * bit);
            bit += 1;
        }
        number += 1;
    }
    spread
};

/// A bit for each axis that a direction goes down.
#[inline(always)]
fn signs(direction: Vec3) -> u32 {
    let signs = direction.to_array().map(f32::is_sign_negative);
    (signs.iter()).fold(0, |signs, &it| signs << 1 | u32::from(it))
}

/// The places of keys in their order, and of equal ones as they come.
///
/// By `radsort`, as the standard library's stable sort takes two to four times as long for such keys.
fn sorted<K: Copy + radsort::Key>(keys: impl Iterator<Item = K>) -> Vec<u32> {
    let mut order: Vec<_> = keys.zip(0_u32..).collect();
    radsort::sort_by_key(&mut order, |&(key, _)| key);
    order.into_iter().map(|(_, place)| place).collect()
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
        assert_eq!(by_cells_and_ways(&rays, grid), [3, 5, 1, 2, 0, 4]);
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
            by_cells_and_ways(&rays, [Vec3::ZERO, Vec3::splat(64.0)]),
            [6, 5, 4, 3, 2, 1, 0]
        );
    }

    #[test]
    fn rays_of_a_way_come_together_and_among_them_those_of_a_cell() {
        let far = Vec3::splat(15.0);
        let [along_z, down_z] = [1.0, -1.0].map(|z| Vec3::new(0.1, 0.2, z));
        let along_x = Vec3::new(1.0, 0.1, 0.2);
        let rays = [
            [far, down_z],
            [Vec3::ZERO, along_z],
            [far, along_x],
            [Vec3::ONE, down_z],
            [far, along_z],
            [Vec3::ZERO, along_x],
            [Vec3::ONE, along_z],
        ];
        let order = by_ways_and_cells(rays.into_iter(), [Vec3::ZERO, Vec3::splat(16.0)]);
        assert_eq!(order, [5, 2, 1, 6, 4, 3, 0]);
    }

    #[test]
    fn every_ray_comes_once_whatever_its_numbers() {
        let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -0.0];
        let rays = odd.map(|x| Ray::new(Vec3::splat(x), Vec3::splat(-x)));
        for grid in [[Vec3::ZERO, Vec3::ONE], [Vec3::ZERO; 2], [Vec3::NAN; 2]] {
            let mut order = by_cells_and_ways(&rays, grid);
            order.sort_unstable();
            assert_eq!(order, [0, 1, 2, 3, 4]);
            assert!(by_cells_and_ways(&[], grid).is_empty());
            let ways = rays.iter().map(|ray| [ray.origin, ray.direction]);
            let mut order = by_ways_and_cells(ways, grid);
            order.sort_unstable();
            assert_eq!(order, [0, 1, 2, 3, 4]);
            let mut order = by_cells(rays.iter().map(|ray| ray.origin), grid);
            order.sort_unstable();
            assert_eq!(order, [0, 1, 2, 3, 4]);
        }
    }

    #[test]
    fn points_of_a_cell_come_together() {
        // Two apart, cells of a grid from 0 to 64; along z first, then y, then x.
        let points = [
            [4.0, 0.0, 0.0],
            [1.9, 1.0, 1.0],
            [0.0, 2.0, 0.0],
            [0.0, 0.0, 3.0],
            [0.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [64.0, 70.0, 64.0],
        ];
        let points = points.map(Vec3::from_array).into_iter();
        let order = by_cells(points, [Vec3::ZERO, Vec3::splat(64.0)]);
        assert_eq!(order, [1, 4, 3, 2, 5, 0, 6]);
    }
}
