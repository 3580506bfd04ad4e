//! Rays of a tile that are yet to be traced.
//!
//! What mirrors and lenses send on from neighbouring pixels soon goes all ways. Such rays wait until all of
//! a tile has come as far, and go on in groups of those that have more in common: S. Boulos, I. Wald, C.
//! Benthin, "Adaptive Ray Packet Reordering", IEEE Symposium on Interactive Ray Tracing, 2008.
//!
//! Of each pixel one ray is on its way at a time, and the next one is the tracer's: so its terms are added
//! up in the tracer's order, whoever its ray goes with.

use whitted::Vec3;

use super::order::by_ways_and_cells;

/// A ray yet to be traced.
#[derive(Clone, Copy)]
pub struct Path {
    pub origin: Vec3,
    pub direction: Vec3,
    pub left: u32,
    pub inward: bool,
    pub throughput: f32,
    pub depth: u32,
    /// Its place in the tile.
    pub pixel: u32,
}

/// The rays yet to be traced of a tile's pixels.
pub struct Paths {
    /// Those that go on with others: of a pixel at most one.
    parted: Vec<Path>,
    /// Refracted rays, which wait until all that is reflected where they start has been traced; and of
    /// each the place of the one that its pixel will trace after it.
    refracted: Vec<(Path, u32)>,
    /// For each pixel the place of the one that it will trace first.
    next: Vec<u32>,
    /// A place that has become free; there, in place of the next ray, is the next such place.
    free: u32,
}

/// There is no other.
const NONE: u32 = u32::MAX;

impl Paths {
    pub fn of(pixels: usize) -> Self {
        Self {
            parted: Vec::new(),
            refracted: Vec::new(),
            next: vec![NONE; pixels],
            free: NONE,
        }
    }

    /// Takes a refracted ray, to be traced before those of its pixel that wait already.
    #[inline(always)]
    pub fn refract(&mut self, path: Path) {
        let next = &mut self.next[path.pixel as usize];
        let waiting = (path, *next);
        match self.refracted.get_mut(self.free as usize) {
            Some(place) => {
                *next = self.free;
                self.free = place.1;
                *place = waiting;
            }
            None => {
                *next = self.refracted.len() as u32;
                self.refracted.push(waiting);
            }
        }
    }

    /// The refracted ray that a pixel is to trace next.
    #[inline(always)]
    pub fn refracted(&mut self, pixel: u32) -> Option<Path> {
        let next = &mut self.next[pixel as usize];
        let (path, after) = self.refracted.get_mut(*next as usize)?;
        let path = *path;
        let place = core::mem::replace(next, *after);
        *after = core::mem::replace(&mut self.free, place);
        Some(path)
    }

    /// Takes a ray that is to go on with others.
    #[inline(always)]
    pub fn part(&mut self, path: Path) {
        self.parted.push(path);
    }

    /// All rays that are to go on with others, and an order in which neighbours have much in common;
    /// `bounds` are those of what they may meet.
    pub fn gather(&mut self, bounds: [Vec3; 2]) -> (Vec<Path>, Vec<u32>) {
        let parted = core::mem::take(&mut self.parted);
        let ways = parted.iter().map(|it| [it.origin, it.direction]);
        let order = by_ways_and_cells(ways, bounds);
        (parted, order)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(pixel: u32, depth: u32) -> Path {
        Path {
            origin: Vec3::ZERO,
            direction: Vec3::Z,
            left: u32::MAX,
            inward: false,
            throughput: 1.0,
            depth,
            pixel,
        }
    }

    #[test]
    fn refracted_rays_of_a_pixel_come_last_in_first_out() {
        let mut paths = Paths::of(3);
        let take = |paths: &mut Paths, pixel| {
            let path = paths.refracted(pixel)?;
            assert_eq!(path.pixel, pixel);
            Some(path.depth)
        };
        for (pixel, depth) in [(0, 1), (2, 2), (0, 3), (2, 4), (0, 5)] {
            paths.refract(path(pixel, depth));
        }
        assert_eq!(take(&mut paths, 1), None);
        assert_eq!(take(&mut paths, 0), Some(5));
        assert_eq!(take(&mut paths, 2), Some(4));
        // Into places that have become free, and one more.
        for (pixel, depth) in [(1, 6), (2, 7), (1, 8)] {
            paths.refract(path(pixel, depth));
        }
        assert_eq!(paths.refracted.len(), 6);
        for (pixel, depth) in [(2, 7), (1, 8), (0, 3), (1, 6), (2, 2), (0, 1)] {
            assert_eq!(take(&mut paths, pixel), Some(depth));
        }
        for pixel in 0..3 {
            assert_eq!(take(&mut paths, pixel), None);
        }
        // All places are free again.
        for depth in 0..6 {
            paths.refract(path(1, depth));
        }
        assert_eq!(paths.refracted.len(), 6);
    }

    #[test]
    fn parted_rays_are_gathered_once() {
        let mut paths = Paths::of(2);
        for (pixel, z) in [(0, -1.0), (1, 1.0)] {
            let direction = Vec3::new(0.0, 0.0, z);
            paths.part(Path {
                direction,
                ..path(pixel, 1)
            });
        }
        let (parted, order) = paths.gather([Vec3::ZERO, Vec3::ONE]);
        let pixels: Vec<_> = parted.iter().map(|it| it.pixel).collect();
        assert_eq!((pixels, order), (vec![0, 1], vec![1, 0]));
        assert!(paths.gather([Vec3::ZERO, Vec3::ONE]).0.is_empty());
    }
}
