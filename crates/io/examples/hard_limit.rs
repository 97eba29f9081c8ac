//! Remakes the charts of `docs/hard-limit.md`: `cargo run --release -p corpuscle-io --example hard_limit -- docs/pictures`.

#[path = "../../time/tests/engine/common/mod.rs"]
mod common;

use std::path::PathBuf;

use common::{barker_henderson, extrapolate, hard_compressibility, missed, missed_by_events, soft_compressibility};
use corpuscle_observe::chart::Axis;
use corpuscle_observe::{Chart, Scale, Series, Style};

const PACKING: f64 = 0.3;
const PAIRS: u32 = 20_000;

fn main() -> std::io::Result<()> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| ".".to_owned()));
    for chart in [limit(), tunnelling()] {
        let path = folder.join(format!("{}.svg", chart.name));
        std::fs::write(&path, corpuscle_io::report::chart_file(&chart))?;
        println!("{}", path.display());
    }
    Ok(())
}

/// `Z` against `1/n`.
fn limit() -> Chart {
    let measure = |&exponent: &u8| {
        let z = soft_compressibility(exponent, PACKING, 200.0, 5);
        println!("n = {exponent}: Z = {:.4} +- {:.4}", z.mean, z.standard_error);
        (1.0 / f64::from(exponent), z.mean, z.standard_error)
    };
    let soft: Vec<(f64, f64, f64)> = [20, 24, 32, 48, 72, 128, 255].iter().map(measure).collect();
    let hard = hard_compressibility(PACKING, 10_000.0, 6);
    let end = extrapolate(&soft);
    let z = (end.mean - hard.mean) / end.standard_error.hypot(hard.standard_error);
    println!("limit {:.4} +- {:.4}, hard {:.4} +- {:.4}, z = {z:.2}", end.mean, end.standard_error, hard.mean, hard.standard_error);
    let x = Axis::linear("inverse exponent 1/n", "");
    let y = Axis::linear("compressibility factor Z", "");
    let theory = |x: f64| barker_henderson(1.0 / x, PACKING);
    Chart::new("hard-limit", "Steep repulsion approaches hard spheres", x, y)
        .with(Series::theory("hard spheres of Barker and Henderson's diameter", 1e-3, 0.05, 60, Scale::Linear, theory))
        .with(Series::with_errors("U = kT (s/r)^n, time-driven", Style::Points, soft))
        .with(Series::with_errors("hard spheres, event-driven", Style::Points, [(0.0, hard.mean, hard.standard_error)]))
}

/// Shares of encounters against the step.
fn tunnelling() -> Chart {
    let steps: Vec<f64> = (0..=24).map(|i| 1e-3 * 10f64.powf(f64::from(i) / 8.0)).collect();
    let share = |count: u32| f64::from(count) / f64::from(PAIRS);
    let y = Axis::linear("share of head-on encounters", "");
    let mut chart =
        Chart::new("tunnelling", "What a fixed step does to hard collisions", Axis::logarithmic("time step dt", "s sqrt(m/kT)"), y);
    for exponent in [12, 48, 192u8] {
        let counts: Vec<[u32; 2]> = steps.iter().map(|&dt| missed(exponent, dt, PAIRS, 7)).collect();
        println!("n = {exponent}: {counts:?}");
        let series =
            |kind: usize| steps.iter().zip(&counts).map(move |(&dt, counts)| (dt, share(counts[kind]))).collect::<Vec<_>>();
        chart = chart.with(Series::new(format!("passed through, n = {exponent}"), Style::Line, series(0))).with(Series::new(
            format!("energy off by 10 %, n = {exponent}"),
            Style::Line,
            series(1),
        ));
    }
    let events = missed_by_events(PAIRS, 7);
    println!("event-driven: {events:?} of {PAIRS}");
    let none = steps.iter().step_by(4).map(|&dt| (dt, share(events[0] + events[1]))).collect::<Vec<_>>();
    chart.with(Series::new("event-driven, either", Style::Points, none))
}
