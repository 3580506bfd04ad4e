//! Which methods are worth their price, and whether `whitted` uses such ones.

use super::cycles::{self, Cost, Price};
use super::frames::{Frame, FramePrice};
use super::light_buffer::Buffered;
use super::sampling::Sampled;
use super::special::Outcome;
use super::tally::Row;
use super::watertight::Leaks;

/// What is compared in a chart, and which method `whitted` uses there.
#[derive(Clone, Copy, Debug)]
pub struct Subject {
    /// As in the rows.
    pub stage: &'static str,
    /// Above the chart.
    pub title: &'static str,
    /// What the error is counted in.
    pub measure: Measure,
    /// The method of the table that `whitted` uses. Its entry calls the code of `whitted` itself, so
    /// that there is one place to change when that changes.
    pub winner: &'static str,
    /// Methods that do not compete with the winner: the same written once more for the lab, or what would
    /// need another copy of every kernel.
    pub apart: &'static [&'static str],
}

/// What an error is counted in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// The larger of backward error and band, in u.
    Backward,
    /// Error of the result, in u.
    Relative,
    /// Error of the result, in steps of an 8-bit channel.
    Steps,
    /// Share of wrong answers.
    Wrong,
}

/// All of them, in the order of a ray's way.
pub const SUBJECTS: &[Subject] = &[
    subject("sphere", "Ray and sphere", Measure::Backward, &[]),
    // The same but for the question whether the ray leaves the plane.
    subject("plane", "Ray and plane", Measure::Backward, &["point"]),
    subject("triangle", "Ray and triangle", Measure::Backward, &[]),
    subject("polygon", "Ray and hexagon", Measure::Backward, &[]),
    subject("cuboid", "Ray and box", Measure::Backward, &[]),
    subject("frustum", "Ray and cone", Measure::Backward, &[]),
    subject("quadric", "Ray and quadric", Measure::Backward, &[]),
    subject("torus", "Ray and torus", Measure::Backward, &[]),
    // The kernels of `whitted` take directions of unit length.
    subject(
        "instance",
        "Ray and sphere that is placed",
        Measure::Backward,
        &["direction as it is", "4 x 4 matrix"],
    ),
    subject(
        "grid",
        "Walk over 32 borders of a grid",
        Measure::Backward,
        &[],
    ),
    subject(
        "solid",
        "Ray and box with a round hole",
        Measure::Wrong,
        &[],
    ),
    subject(
        "checker",
        "Checker on a surface in a boundary",
        Measure::Wrong,
        &[],
    ),
    subject("secondary", "Start of a secondary ray", Measure::Wrong, &[]),
    subject("sqrt", "Square root", Measure::Relative, &[]),
    subject("rsqrt", "Reciprocal square root", Measure::Relative, &[]),
    subject("normalize", "Unit vector", Measure::Relative, &[]),
    subject("power", "Whole power", Measure::Steps, &[]),
    subject("power, real", "Real power", Measure::Steps, &[]),
];

const fn subject(
    stage: &'static str,
    title: &'static str,
    measure: Measure,
    apart: &'static [&'static str],
) -> Subject {
    Subject {
        stage,
        title,
        measure,
        winner: "core",
        apart,
    }
}

/// The part whose price counts.
pub const TARGET: &str = "cortex-m4f";

/// So many cycles the same function takes more or less where it lies elsewhere in flash: other registers,
/// and branches that are aligned or not.
pub const PLACEMENT: f64 = 3.0;

/// A method's place in a chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// The method.
    pub method: String,
    /// The worst error in all cells, in units of the subject's measure.
    pub error: f64,
    /// What it costs, by inputs, the ones that are charted first; empty where that was not counted.
    pub costs: Vec<Cost>,
    /// Whether it answers all special inputs, and leaves no holes.
    pub sound: bool,
}

/// All that a run measured, and the prices.
#[derive(Clone, Debug, Default)]
pub struct Results {
    /// The sweeps.
    pub rows: Vec<Row>,
    /// The special inputs.
    pub special: Vec<Outcome>,
    /// The meshes.
    pub leaks: Vec<Leaks>,
    /// Ways to sample pixels and lights.
    pub sampling: Vec<Sampled>,
    /// What shadow rays are saved.
    pub buffers: Vec<Buffered>,
    /// The frames.
    pub frames: Vec<Frame>,
    /// The methods' prices.
    pub prices: Vec<Price>,
    /// The frames' prices.
    pub frame_prices: Vec<FramePrice>,
    /// Whether the prices were counted in this run, or are the committed ones.
    pub counted: bool,
}

impl Results {
    /// Every method of a subject, in the order of its table.
    pub fn marks(&self, subject: &Subject) -> Vec<Mark> {
        let rows = || self.rows.iter().filter(|row| row.stage == subject.stage);
        let mut methods: Vec<&str> = Vec::new();
        for row in rows() {
            if !methods.contains(&row.method.as_str()) {
                methods.push(&row.method);
            }
        }
        let mark = |&method: &&str| Mark {
            method: method.into(),
            error: rows()
                // Beyond the documented range.
                .filter(|row| row.method == method && !row.sweep.ends_with("extreme"))
                .map(|row| subject.measure.of(row))
                .fold(0.0, f64::max),
            costs: cycles::costs(&self.prices, TARGET, subject.stage, method),
            sound: self.is_sound(subject.stage, method),
        };
        methods.iter().map(mark).collect()
    }

    fn is_sound(&self, stage: &str, method: &str) -> bool {
        let fails = |one: &Outcome| one.stage == stage && one.method == method && !one.pass;
        let leaks = |one: &Leaks| one.method == method && one.holes + one.doubles > 0;
        let leaky = stage == "polygon" && self.leaks.iter().any(leaks);
        !(leaky || self.special.iter().any(fails))
    }

    /// What is wrong with the methods that `whitted` uses; nothing if all lie on the front.
    ///
    /// Everything here is counted: no clock has a say.
    pub fn complaints(&self) -> Vec<String> {
        let mut complaints = Vec::new();
        for subject in SUBJECTS {
            let marks = self.marks(subject);
            let Some(winner) = marks.iter().find(|mark| mark.method == subject.winner) else {
                continue;
            };
            if !winner.sound {
                complaints.push(format!(
                    "{}: `{}` fails special inputs or leaks",
                    subject.title, winner.method
                ));
            }
            for other in marks
                .iter()
                .filter(|mark| !subject.apart.contains(&mark.method.as_str()))
            {
                if other.dominates(winner) {
                    complaints.push(format!(
                        "{}: whitted's method, {}, is behind `{}`, {}",
                        subject.title,
                        winner.describe(subject),
                        other.method,
                        other.describe(subject)
                    ));
                }
            }
        }
        complaints
    }

    /// Where the prices come from, for the charts.
    pub fn source(&self) -> &'static str {
        match self.counted {
            true => "traced in QEMU",
            false => "committed figures",
        }
    }

    /// The subjects whose winner has no price yet.
    pub fn unpriced(&self) -> Vec<&'static str> {
        let is_unpriced = |subject: &&Subject| {
            let marks = self.marks(subject);
            let mut winner = marks.iter().filter(|mark| mark.method == subject.winner);
            winner.any(|mark| mark.costs.is_empty())
        };
        SUBJECTS
            .iter()
            .filter(is_unpriced)
            .map(|subject| subject.stage)
            .collect()
    }
}

impl Measure {
    fn of(self, row: &Row) -> f64 {
        match self {
            Self::Backward => row.backward.max(row.band),
            // What is not finite is as wrong as can be.
            Self::Relative | Self::Steps => row.backward.max(row.band),
            Self::Wrong => row.wrong as f64 / row.n as f64,
        }
    }

    /// What the axis says.
    pub fn label(self) -> &'static str {
        match self {
            Self::Backward => "worst backward error or band, u = 2^-24",
            Self::Relative => "worst error, u = 2^-24",
            Self::Steps => "worst error, steps of 8 bits",
            Self::Wrong => "worst share of wrong answers",
        }
    }
}

impl Mark {
    /// Whether nothing speaks for `other`: this is no worse in price or error and better in one.
    ///
    /// It has to be no dearer for any inputs, hits and misses, alone and with what is prepared once a
    /// ray: in a scene with many primitives the one matters, with few the other. It is cheaper only by
    /// more than [`PLACEMENT`].
    pub fn dominates(&self, other: &Self) -> bool {
        if !self.sound || self.costs.is_empty() || self.costs.len() != other.costs.len() {
            return false;
        }
        let pairs = || self.costs.iter().zip(&other.costs);
        let no_dearer =
            pairs().all(|(mine, its)| mine.call <= its.call && mine.prepared <= its.prepared);
        let cheaper = pairs().any(|(mine, its)| mine.call + PLACEMENT < its.call);
        no_dearer && self.error <= other.error && (cheaper || self.error < other.error)
    }

    fn describe(&self, subject: &Subject) -> String {
        let costs: Vec<String> = self
            .costs
            .iter()
            .map(|cost| format!("{:.0} cycles ({:.0} with set-up)", cost.call, cost.prepared))
            .collect();
        format!(
            "{}, {:.3e} ({})",
            costs.join(", "),
            self.error,
            subject.measure.label()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mark(call: f64, error: f64) -> Mark {
        let prepared = call + 10.0;
        Mark {
            method: String::new(),
            error,
            costs: vec![Cost { call, prepared }; 2],
            sound: true,
        }
    }

    #[test]
    fn only_what_is_no_worse_in_anything_dominates() {
        assert!(mark(70.0, 1.0).dominates(&mark(80.0, 1.0)));
        assert!(mark(80.0, 0.9).dominates(&mark(80.0, 1.0)));
        assert!(!mark(70.0, 1.1).dominates(&mark(80.0, 1.0)));
        assert!(!mark(80.0, 1.0).dominates(&mark(80.0, 1.0)));
        let unsound = Mark {
            sound: false,
            ..mark(1.0, 0.0)
        };
        assert!(!unsound.dominates(&mark(80.0, 1.0)));
        let unpriced = Mark {
            costs: Vec::new(),
            ..mark(1.0, 0.0)
        };
        assert!(!unpriced.dominates(&mark(80.0, 1.0)));
        let mut costly_setup = mark(70.0, 1.0);
        costly_setup.costs[1].prepared = 200.0;
        assert!(!costly_setup.dominates(&mark(80.0, 1.0)));
    }

    #[test]
    fn a_winner_behind_the_front_is_complained_about() {
        let row = |method: &str, backward| Row {
            stage: "sphere".into(),
            sweep: "distance".into(),
            axis: String::new(),
            x: 1.0,
            method: method.into(),
            n: 1,
            backward,
            backward_999: backward,
            forward: 0.0,
            wrong: 0,
            beyond: 0,
            band: 0.0,
        };
        let price = |method: &str, cycles| Price {
            compiler: "rustc 1".into(),
            stage: "sphere".into(),
            case: "hit".into(),
            method: method.into(),
            target: TARGET.into(),
            cycles: Some(cycles),
            instructions: cycles,
            bytes: 0,
        };
        let mut results = Results {
            rows: vec![row("core", 1.7), row("tangent", 30_000.0)],
            prices: vec![price("core", 81.0), price("tangent", 68.0)],
            ..Results::default()
        };
        assert_eq!(results.complaints(), [""; 0]);
        results.rows.push(row("better", 1.6));
        results.prices.push(price("better", 80.0));
        let complaints = results.complaints();
        assert_eq!(complaints.len(), 1);
        assert!(complaints[0].contains("better"), "{}", complaints[0]);
        assert!(results.unpriced().is_empty());
    }
}
