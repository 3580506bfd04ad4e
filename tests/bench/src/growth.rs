//! Cost against the size of the scene, ours and the peers'.

use std::collections::BTreeMap;
use std::time::Instant;

use anyhow::Context;
use plotters::prelude::*;
use rayon::ThreadPoolBuilder;

use crate::peer::{Builder, Peer};
use crate::report::{Report, chart, ratio};
use crate::workload::{Query, Shapes, Workload, spheres, surface, triangles};
use crate::{crates, embree, ours};

const PEERS: [Builder; 7] = [
    ours::wide,
    embree::medium,
    crates::obvhs_cwbvh,
    crates::bvh,
    crates::parry,
    crates::tiny,
    crates::tiny8,
];

/// Seconds to build and to answer, least of the rounds, by peer and size.
type Costs = BTreeMap<(usize, &'static str, String), Vec<(usize, f64)>>;

type Make = fn(usize) -> Shapes;

const KINDS: [(&str, Make); 3] = [
    ("spheres", spheres),
    ("triangles", triangles),
    ("surface", surface),
];

/// Measures, writes the numbers and draws the charts.
pub fn run_all(report: &mut Report, rounds: usize, quick: bool) -> anyhow::Result<()> {
    let sizes: &[usize] = if quick {
        &[10, 100, 1000, 10_000]
    } else {
        &[10, 100, 1000, 10_000, 100_000, 1_000_000]
    };
    let one = ThreadPoolBuilder::new().num_threads(1).build()?;
    let mut costs = Costs::new();
    for (kind, (name, make)) in KINDS.iter().enumerate() {
        for &size in sizes {
            if *name == "surface" && size < 100 {
                continue;
            }
            let workload = Workload::new(*name, make(size), 256);
            // Whoever could build with more threads has one.
            one.install(|| measure(&workload, kind, size, rounds, &mut costs));
            eprintln!("{name}, {size}");
        }
    }
    let mut text = String::from("scene,what,peer,objects,cost\n");
    for ((kind, what, peer), points) in &costs {
        let base = base(&costs, *kind, what);
        for (size, cost) in points {
            text += &format!(
                "{},{what},{peer},{size},{:.4}\n",
                KINDS[*kind].0,
                cost / base
            );
        }
    }
    std::fs::write(chart("bench.csv"), text)?;
    for what in ["build", "primary", "incoherent"] {
        draw(&costs, what)?;
    }
    table(report, &costs);
    Ok(())
}

fn measure(workload: &Workload, kind: usize, size: usize, rounds: usize, costs: &mut Costs) {
    let mut best = BTreeMap::new();
    let sets = &workload.rays;
    let builds = if size > 100_000 { 2 } else { rounds };
    let mut peers: Vec<(usize, Box<dyn Peer + '_>)> = Vec::new();
    for round in 0..builds {
        for (place, builder) in PEERS.iter().enumerate() {
            let start = Instant::now();
            let Ok(peer) = builder(&workload.shapes) else {
                continue;
            };
            let time = start.elapsed().as_secs_f64();
            let least = best.entry((place, "build")).or_insert(f64::INFINITY);
            *least = least.min(time);
            if round == 0 {
                peers.push((place, peer));
            }
        }
    }
    let (places, peers): (Vec<_>, Vec<_>) = peers.into_iter().unzip();
    for set in sets.iter().filter(|set| set.query == Query::Nearest) {
        for (&place, (time, _)) in places
            .iter()
            .zip(crate::measure(&peers, workload, set, rounds))
        {
            best.insert((place, set.name), time / set.rays.len() as f64);
        }
    }
    for (place, peer) in places.iter().zip(&peers) {
        for what in ["build", "primary", "incoherent"] {
            if let Some(&cost) = best.get(&(*place, what)) {
                let points = costs.entry((kind, what, peer.name())).or_default();
                points.push((size, cost));
            }
        }
    }
}

/// What everything is told in: our cost of the smallest scene of this kind.
fn base(costs: &Costs, kind: usize, what: &'static str) -> f64 {
    costs[&(kind, what, "whitted".to_owned())][0].1
}

fn table(report: &mut Report, costs: &Costs) {
    let mut rows = Vec::new();
    for ((kind, what, peer), points) in costs {
        if peer == "whitted" {
            continue;
        }
        let ours = &costs[&(*kind, *what, "whitted".to_owned())];
        let mut row = vec![format!("{}, {what}", KINDS[*kind].0), peer.clone()];
        for size in [10, 100, 1000, 10_000, 100_000, 1_000_000] {
            let of = |points: &[(usize, f64)]| points.iter().find(|it| it.0 == size).map(|it| it.1);
            row.push(match (of(points), of(ours)) {
                (Some(theirs), Some(ours)) => ratio(theirs / ours),
                _ => String::new(),
            });
        }
        rows.push(row);
    }
    let head = [
        "scene",
        "peer / whitted",
        "10",
        "100",
        "1,000",
        "10,000",
        "100,000",
        "1,000,000",
    ];
    report.table("By the number of objects, rays one by one", &head, &rows);
    let ours = costs
        .iter()
        .filter(|((_, what, peer), _)| *what == "build" && peer == "whitted");
    let rows: Vec<_> = ours
        .flat_map(|((kind, ..), points)| {
            let large = points.iter().filter(|it| it.0 >= 10_000);
            large.map(|(size, time)| {
                let time = format!("{:.1}", time * 1e3);
                vec![KINDS[*kind].0.to_owned(), size.to_string(), time]
            })
        })
        .collect();
    let head = ["scene", "objects", "ms"];
    report.table("whitted's construction, one thread", &head, &rows);
}

fn draw(costs: &Costs, what: &'static str) -> anyhow::Result<()> {
    let path = chart(&format!("bench-{what}.svg"));
    let root = SVGBackend::new(&path, (1200, 460)).into_drawing_area();
    root.fill(&WHITE)?;
    for ((kind, (name, _)), area) in KINDS.iter().enumerate().zip(root.split_evenly((1, 3))) {
        let base = base(costs, kind, what);
        let lines: Vec<_> = costs
            .iter()
            .filter(|(key, _)| key.0 == kind && key.1 == what)
            .map(|((_, _, peer), points)| {
                let points = points
                    .iter()
                    .map(|&(size, cost)| (size as f64, cost / base));
                (peer.clone(), points.collect::<Vec<_>>())
            })
            .collect();
        let all = || lines.iter().flat_map(|it| it.1.iter().copied());
        let most = |x: fn((f64, f64)) -> f64| all().map(x).fold(0.0, f64::max);
        let low = all().map(|it| it.1).fold(f64::INFINITY, f64::min);
        let mut chart = ChartBuilder::on(&area)
            .caption(format!("{name}: {what}"), ("sans-serif", 18))
            .margin(8)
            .margin_right(24)
            .x_label_area_size(36)
            .y_label_area_size(56)
            .build_cartesian_2d(
                (10.0..most(|it| it.0)).log_scale(),
                (low * 0.8..most(|it| it.1) * 1.3).log_scale(),
            )?;
        let whole = |x: &f64| match x.log10().round() as i32 {
            power if power < 5 => format!("{:.0}", x),
            power => format!("1e{power}"),
        };
        chart
            .configure_mesh()
            .x_desc("objects")
            .y_desc("cost; whitted, smallest scene: 1")
            .x_label_formatter(&whole)
            .draw()?;
        for (place, (peer, points)) in lines.iter().enumerate() {
            let ours = peer == "whitted";
            let color = if ours {
                BLACK.to_rgba()
            } else {
                Palette99::pick(place).to_rgba()
            };
            let style = color.stroke_width(if ours { 3 } else { 2 });
            chart
                .draw_series(LineSeries::new(points.iter().copied(), style).point_size(3))?
                .label(peer.as_str())
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 14, y)], style));
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperLeft)
            .background_style(WHITE.mix(0.8))
            .border_style(BLACK.mix(0.3))
            .label_font(("sans-serif", 11))
            .draw()?;
    }
    root.present().context("cannot write the chart")?;
    Ok(())
}
