//! Sweeps of difficulty, run on all cores.

use rayon::prelude::*;

use super::random::{Random, Stream};
use super::tally::{Row, Tally};
use crate::exact::Verdict;

/// A series of cells, each harder than the one before.
pub struct Sweep<C> {
    /// What makes it hard.
    pub name: &'static str,
    /// What its cells' numbers mean.
    pub axis: &'static str,
    /// The cells.
    pub cells: Vec<Cell<C>>,
}

/// Inputs of one difficulty.
pub struct Cell<C> {
    /// How hard, in units of the sweep's axis.
    pub x: f64,
    draw: Box<dyn Fn(&mut Random) -> C + Sync>,
}

impl<C> Sweep<C> {
    /// A sweep over these difficulties; `draw` makes an input.
    pub fn new<F>(name: &'static str, axis: &'static str, x: &[f64], draw: F) -> Self
    where
        F: Fn(f64, &mut Random) -> C + Sync + Clone + 'static,
    {
        let cell = |&x: &f64| {
            let draw = draw.clone();
            Cell {
                x,
                draw: Box::new(move |random: &mut Random| draw(x, random)),
            }
        };
        Self {
            name,
            axis,
            cells: x.iter().map(cell).collect(),
        }
    }
}

impl<C> Cell<C> {
    /// The next input of a stream.
    pub fn draw(&self, random: &mut Random) -> C {
        (self.draw)(random)
    }
}

/// A question that methods answer.
pub trait Stage {
    /// As in the charts.
    const NAME: &'static str;
    /// An input.
    type Case;

    /// What makes it hard.
    fn sweeps() -> Vec<Sweep<Self::Case>>;

    /// Names of the methods.
    fn methods() -> Vec<&'static str>;

    /// Asks each method and judges its answer, in the order of [`Stage::methods`].
    fn ask(case: &Self::Case, judged: &mut dyn FnMut(usize, Verdict));
}

/// How much to run.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Of all inputs.
    pub seed: u64,
    /// Inputs a cell.
    pub n: u64,
}

const CHUNK: u64 = 1000;

/// Runs all sweeps of a stage.
pub fn run<S: Stage>(effort: Effort, progress: &(impl Fn(&str, &str) + Sync)) -> Vec<Row> {
    let methods = S::methods();
    let mut rows = Vec::new();
    for sweep in S::sweeps() {
        progress(S::NAME, sweep.name);
        for (index, cell) in sweep.cells.iter().enumerate() {
            let tallies = run_cell::<S>(effort, sweep.name, index as u64, cell);
            for (tally, method) in tallies.iter().zip(&methods) {
                rows.push(tally.row(S::NAME, [sweep.name, sweep.axis], cell.x, method));
            }
        }
    }
    rows
}

fn run_cell<S: Stage>(effort: Effort, sweep: &str, index: u64, cell: &Cell<S::Case>) -> Vec<Tally> {
    let none = || vec![Tally::new(); S::methods().len()];
    (0..effort.n.div_ceil(CHUNK))
        .into_par_iter()
        .fold(none, |mut tallies, chunk| {
            let mut random = Random::new(Stream {
                seed: effort.seed,
                purpose: Stream::purpose([S::NAME, sweep]),
                cell: index,
                chunk,
            });
            for _ in 0..CHUNK.min(effort.n - chunk * CHUNK) {
                let case = cell.draw(&mut random);
                S::ask(&case, &mut |method, verdict| tallies[method].add(&verdict));
            }
            tallies
        })
        .reduce(none, |mut tallies, more| {
            for (tally, more) in tallies.iter_mut().zip(&more) {
                tally.merge(more);
            }
            tallies
        })
}
