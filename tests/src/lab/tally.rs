//! What is kept of many answers: extremes and counts, never an average.

use crate::exact::Verdict;

/// Counts of numbers by size, 32 classes an octave.
#[derive(Clone, Debug)]
struct Histogram {
    counts: Vec<u64>,
}

impl Histogram {
    const PER_OCTAVE: f64 = 32.0;
    const LEAST_EXPONENT: f64 = -24.0;
    const CLASSES: usize = 32 * 96;

    fn new() -> Self {
        Self {
            counts: vec![0; Self::CLASSES],
        }
    }

    fn add(&mut self, x: f64) {
        // The cast saturates: what is below the least class, zero too, is in it.
        let class = ((x.log2() - Self::LEAST_EXPONENT) * Self::PER_OCTAVE) as usize;
        self.counts[class.min(Self::CLASSES - 1)] += 1;
    }

    fn merge(&mut self, other: &Self) {
        for (count, more) in self.counts.iter_mut().zip(&other.counts) {
            *count += more;
        }
    }

    /// A number that this share of all does not exceed, and hardly less than that: to 2 %.
    fn quantile(&self, share: f64) -> f64 {
        let total: u64 = self.counts.iter().sum();
        let enough = (total as f64 * share).ceil() as u64;
        let mut sum = 0;
        let class = self.counts.iter().position(|&count| {
            sum += count;
            sum >= enough
        });
        match class {
            Some(class) if total > 0 => {
                ((class + 1) as f64 / Self::PER_OCTAVE + Self::LEAST_EXPONENT).exp2()
            }
            _ => 0.0,
        }
    }
}

/// Answers of one method in one cell. The order of answers and of merging does not matter.
#[derive(Clone, Debug)]
pub struct Tally {
    n: u64,
    backward: f64,
    backward_classes: Histogram,
    forward: f64,
    wrong: u64,
    beyond: u64,
    band: f64,
}

impl Tally {
    /// No answers.
    pub fn new() -> Self {
        Self {
            n: 0,
            backward: 0.0,
            backward_classes: Histogram::new(),
            forward: 0.0,
            wrong: 0,
            beyond: 0,
            band: 0.0,
        }
    }

    /// One more answer.
    pub fn add(&mut self, verdict: &Verdict) {
        self.n += 1;
        match verdict.wrong {
            Some(band) => {
                self.wrong += 1;
                self.beyond += u64::from(band > 1.0);
                self.band = self.band.max(band);
            }
            None => {
                self.backward = self.backward.max(verdict.backward);
                self.backward_classes.add(verdict.backward);
                self.forward = self.forward.max(verdict.forward);
            }
        }
    }

    /// All answers of both.
    pub fn merge(&mut self, other: &Self) {
        self.n += other.n;
        self.backward = self.backward.max(other.backward);
        self.backward_classes.merge(&other.backward_classes);
        self.forward = self.forward.max(other.forward);
        self.wrong += other.wrong;
        self.beyond += other.beyond;
        self.band = self.band.max(other.band);
    }

    /// As a line of the report. `sweep` is its name and what its numbers mean.
    pub fn row(&self, stage: &str, sweep: [&str; 2], x: f64, method: &str) -> Row {
        Row {
            stage: stage.into(),
            sweep: sweep[0].into(),
            axis: sweep[1].into(),
            x,
            method: method.into(),
            n: self.n,
            backward: self.backward,
            backward_999: self.backward_classes.quantile(0.999).min(self.backward),
            forward: self.forward,
            wrong: self.wrong,
            beyond: self.beyond,
            band: self.band,
        }
    }
}

impl Default for Tally {
    fn default() -> Self {
        Self::new()
    }
}

/// A line of `sweeps.csv`: one method in one cell. Errors are in u = 2^-24.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Row {
    /// What is computed.
    pub stage: String,
    /// What makes it hard.
    pub sweep: String,
    /// What the next number means.
    pub axis: String,
    /// How hard.
    pub x: f64,
    /// By which method.
    pub method: String,
    /// Answers.
    pub n: u64,
    /// Largest backward error.
    pub backward: f64,
    /// Backward error that 99.9 % of answers do not exceed.
    pub backward_999: f64,
    /// Largest forward error.
    pub forward: f64,
    /// Hits that are misses and misses that are hits.
    pub wrong: u64,
    /// Those of them that were further than 1 u from the silhouette.
    pub beyond: u64,
    /// How far from the silhouette the worst of them was.
    pub band: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answer(backward: f64) -> Verdict {
        Verdict {
            backward,
            forward: 0.0,
            wrong: None,
        }
    }

    #[test]
    fn a_quantile_leaves_out_the_rare() {
        let mut tally = Tally::new();
        for i in 0..2000 {
            tally.add(&answer(if i == 7 { 1e6 } else { 1.5 }));
        }
        let row = tally.row("", [""; 2], 0.0, "");
        assert_eq!(row.backward, 1e6);
        assert!(
            (1.5..1.55).contains(&row.backward_999),
            "{}",
            row.backward_999
        );
    }

    #[test]
    fn merging_is_adding() {
        let (mut one, mut other, mut both) = (Tally::new(), Tally::new(), Tally::new());
        for i in 0..100 {
            let verdict = answer(f64::from(i) * 0.1);
            let half = if i % 3 == 0 { &mut one } else { &mut other };
            half.add(&verdict);
            both.add(&verdict);
        }
        one.merge(&other);
        assert_eq!(
            one.row("", [""; 2], 0.0, ""),
            both.row("", [""; 2], 0.0, "")
        );
    }
}
