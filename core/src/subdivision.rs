//! Means over squares, sampled closely only where corners differ.

use core::ops::{Add, Mul};

use heapless::Vec;

/// What has a mean.
pub trait Quantity:
    Copy + Default + PartialEq + Add<Output = Self> + Mul<f32, Output = Self>
{
}

impl<V> Quantity for V where
    V: Copy + Default + PartialEq + Add<Output = Self> + Mul<f32, Output = Self>
{
}

/// The most times that a square is divided.
pub(crate) const MOST: u8 = 4;

/// A square that waits, and its corner that is known.
#[derive(Clone, Copy)]
struct Square<V> {
    x: u8,
    y: u8,
    level: u8,
    corner: u8,
    known: V,
}

/// The mean over a square of 2^`levels` steps to a side, at most 2^[`MOST`].
///
/// `sample` is asked for the square's four corners, at steps of (x, y); where it `splits` them at a level,
/// from 0, for those of its four quarters, and so on. What is not divided counts as the mean of its
/// corners. With `between`, samples lie at the marks between steps, so that quarters share corners;
/// without, in the middle of steps, and the last square has two steps to a side.
///
/// J. T. Whitted, "An Improved Illumination Model for Shaded Display", CACM 23(6), 1980, divides pixels so.
#[inline(always)]
pub(crate) fn mean<V: Quantity>(
    levels: u8,
    between: bool,
    mut sample: impl FnMut(u8, u8) -> V,
    mut splits: impl FnMut(&[V; 4], u8) -> bool,
) -> V {
    // Of four quarters one is followed in place and three wait; the smallest have none.
    let mut waiting = Vec::<Square<V>, { 3 * MOST as usize }>::new();
    let levels = levels.min(MOST);
    let (last, inset) = if between {
        (levels, 0)
    } else {
        (levels.saturating_sub(1), 1)
    };
    let mut square = Square {
        x: 0,
        y: 0,
        level: 0,
        // None.
        corner: 4,
        known: V::default(),
    };
    let mut sum = V::default();
    // Each of at most 4^MOST smallest squares is reached once.
    loop {
        let side = 1 << (levels - square.level);
        let far = side - inset;
        let mut corners = [square.known; 4];
        for (corner, value) in (0..).zip(&mut corners) {
            if corner != square.corner {
                *value = sample(
                    square.x + (corner & 1) * far,
                    square.y + (corner >> 1) * far,
                );
            }
        }
        if square.level < last && splits(&corners, square.level) {
            let half = side / 2;
            let quarter = |corner: u8, known| Square {
                x: square.x + (corner & 1) * half,
                y: square.y + (corner >> 1) * half,
                level: square.level + 1,
                corner,
                known,
            };
            let [first, second, third, fourth] = corners;
            for (corner, known) in [(3, fourth), (2, third), (1, second)] {
                let fits = waiting.push(quarter(corner, known)).is_ok();
                debug_assert!(fits, "more than three squares wait at a level");
            }
            square = quarter(0, first);
        } else {
            let [a, b, c, d] = corners;
            // 4^-(level + 1), exact.
            let share = f32::from_bits((125 - 2 * u32::from(square.level)) << 23);
            sum = sum + (a + b + (c + d)) * share;
            match waiting.pop() {
                Some(next) => square = next,
                None => return sum,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    extern crate std;
    use std::collections::HashMap;

    fn count(
        levels: u8,
        between: bool,
        value: impl Fn(u8, u8) -> f32,
    ) -> (f32, HashMap<(u8, u8), u32>) {
        let mut seen = HashMap::new();
        let found = mean(
            levels,
            between,
            |x, y| {
                *seen.entry((x, y)).or_default() += 1;
                value(x, y)
            },
            |corners, _| corners.iter().any(|it| *it != corners[0]),
        );
        (found, seen)
    }

    #[test]
    fn what_is_alike_at_the_corners_is_sampled_there_alone() {
        for between in [false, true] {
            let (found, seen) = count(4, between, |_, _| 0.75);
            assert_eq!((found, seen.len()), (0.75, 4));
            let far = if between { 16 } else { 15 };
            assert_eq!(seen[&(far, far)], 1);
        }
    }

    #[test]
    fn in_the_middle_of_steps_each_is_sampled_once_and_weighs_the_same() {
        for levels in 1..=MOST {
            let side = 1 << levels;
            // Every square has corners that differ.
            let (found, seen) = count(levels, false, |x, y| f32::from(x) + 16.0 * f32::from(y));
            let middle = 0.5 * f32::from(side - 1);
            assert_eq!(found, 17.0 * middle);
            assert_eq!(seen.len(), usize::from(side) * usize::from(side));
            assert!(seen.values().all(|&times| times == 1));
            assert!(seen.keys().all(|it| it.0 < side && it.1 < side));
        }
    }

    #[test]
    fn an_edge_is_followed_to_the_smallest_squares() {
        // Black left of 3/16 and white from there on: one column of the smallest squares is half and half.
        let (found, seen) = count(4, true, |x, _| f32::from(u8::from(x >= 3)));
        assert_eq!(found, 13.5 / 16.0);
        assert!(seen.len() < 17 * 17 / 2, "{}", seen.len());
        assert!(seen.keys().all(|it| it.0 <= 16 && it.1 <= 16));
    }

    #[test]
    fn levels_end_at_the_most() {
        let (found, seen) = count(255, true, |x, _| f32::from(x));
        assert_eq!((found, seen.len()), (8.0, 17 * 17));
    }
}
