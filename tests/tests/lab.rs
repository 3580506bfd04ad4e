//! The methods that `whitted` uses against all others of the lab: counted, not timed.

use std::path::{Path, PathBuf};

use whitted_tests::lab::cycles::{Price, read};
use whitted_tests::lab::front::{Results, SUBJECTS, TARGET};
use whitted_tests::lab::{Plan, measure, pricing};

/// A tenth of the lab's quick pass, with which methods that differ at all differ already.
const PLAN: Plan = Plan {
    inputs: 2000,
    rays: 2000,
    our_rays: 20_000,
    ..Plan::QUICK
};

fn committed() -> Vec<Price> {
    let path: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("charts/cycles.csv");
    read(&path).unwrap()
}

/// What is wrong with the methods in use at these prices, and which of them have none.
fn complaints(results: &mut Results, prices: Vec<Price>) -> (Vec<String>, Vec<&'static str>) {
    results.prices = prices;
    (results.complaints(), results.unpriced())
}

#[test]
fn the_methods_in_use_are_on_the_front() {
    let mut results = measure(
        PLAN,
        |stage| !["frames", "sampling", "light buffer"].contains(&stage),
        &|_, _| {},
    );
    let (behind, unpriced) = complaints(&mut results, committed());
    assert_eq!(unpriced, [""; 0], "cycles.csv lacks their prices");
    assert!(behind.is_empty(), "{behind:#?}");

    // And it would tell: for a hundredth of what any other method costs, that one is in front.
    for subject in SUBJECTS {
        let mut prices = committed();
        let marks = results.marks(subject);
        let ours = marks.iter().find(|mark| mark.method == subject.winner);
        let error = ours.expect("a winner").error;
        let rival = marks.iter().find(|mark| {
            let is_other = mark.method != subject.winner;
            is_other && mark.sound && mark.error <= error && !mark.costs.is_empty()
        });
        let Some(rival) = rival.filter(|it| !subject.apart.contains(&it.method.as_str())) else {
            continue;
        };
        for price in &mut prices {
            if price.stage == subject.stage && price.method == rival.method {
                price.cycles = price.cycles.map(|cycles| cycles * 0.01);
            }
        }
        let (behind, _) = complaints(&mut results, prices);
        assert_eq!(
            behind.len(),
            1,
            "{}, {}: {behind:?}",
            subject.stage,
            rival.method
        );
    }
}

#[test]
fn the_committed_prices_are_those_of_the_code() {
    if !pricing::is_possible() {
        eprintln!(
            "NOT RUN: no compiler or no emulator; tests/embedded.sh installs what is missing"
        );
        return;
    }
    let committed = committed();
    let now = pricing::measure().unwrap();
    let is_same = |(then, now): (&Price, &Price)| {
        (&then.stage, &then.case, &then.method) == (&now.stage, &now.case, &now.method)
    };
    let same = committed.iter().zip(&now).all(is_same) && committed.len() == now.len();
    assert!(
        same,
        "other methods than in cycles.csv: lab --price rewrites it"
    );
    // Where a function begins moves its cycles by a few, and another compiler by more.
    let off = |(then, now): &(&Price, &Price)| {
        (now.instructions - then.instructions).abs() > 0.1 * then.instructions + 8.0
    };
    // What calls the compiler's own library costs what that does: of another, nothing is known.
    let is_known = |(then, now): &(&Price, &Price)| {
        then.compiler == now.compiler || !then.method.starts_with("f32::")
    };
    let priced = committed
        .iter()
        .zip(&now)
        .filter(|(it, _)| it.target == TARGET)
        .filter(is_known);
    let stale: Vec<_> = priced.filter(off).collect();
    assert!(
        stale.is_empty(),
        "lab --price rewrites cycles.csv: {stale:#?}"
    );
}
