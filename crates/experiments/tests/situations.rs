//! What a situation declares of the parameters holds: one that it calls unused changes no bit of the run, every other one does.

#![allow(clippy::unwrap_used, clippy::panic)] // in the helpers too: a test that cannot be set up has failed

use corpuscle_experiments::{Experiment, Kind, Parameter, REGISTRY, Settings, Simulation, Value};
use corpuscle_scene::Scene;
use rayon::prelude::*;

/// Part of the run that is compared.
fn part(experiment: &str) -> f64 {
    match experiment {
        "wave" => 0.002,
        "three-body" => 0.2,
        "billiard" => 0.5,
        _ => 0.02,
    }
}

/// Values that make runs short, or let what a parameter does be seen early.
const QUICK: &[(&str, &[(&str, &str)])] = &[
    ("brownian", &[("particles", "60"), ("replicas", "2"), ("duration", "4")]),
    ("entropy", &[("particles", "12"), ("replicas", "2"), ("cells", "4"), ("reverse_at", "5"), ("perturbations", "1e-3")]),
    ("ideal-gas", &[("particles", "20"), ("replicas", "3"), ("points", "3"), ("dense_packings", "0.05"), ("speeds", "0.8, 3.2")]),
    ("three-body", &[("resolution", "16"), ("duration", "1"), ("grains", "3")]),
    ("billiard", &[("replicas", "2"), ("particles", "4"), ("duration", "4")]),
];

fn seen(simulation: &dyn Simulation) -> String {
    let mut scene = Scene::default();
    simulation.draw(&mut scene);
    let honesty = simulation.honesty();
    let measured = (simulation.charts(), simulation.checks(), simulation.tables());
    let (frame, moments, end) = (simulation.frame(), simulation.moments(), simulation.end());
    format!("{scene:?} {frame:?} {measured:?} {honesty:?} {moments:?} {end:?}")
}

/// What is seen at a time of a run with these settings; or the key whose value is refused, of a run that breaks down none.
fn run(experiment: &Experiment, settings: &Settings, until: Option<f64>) -> Result<(String, f64), String> {
    let mut simulation = (experiment.start)(settings).map_err(|refused| refused.key)?;
    let until = until.unwrap_or(part(experiment.name) * simulation.end());
    simulation.advance(until).map_err(|_| String::new())?;
    Ok((seen(&*simulation), until))
}

/// Other values of a parameter.
fn others(parameter: &Parameter, value: &Value) -> Vec<Value> {
    let candidates = match value {
        Value::Real(x) if *x == 0.0 => [0.02, 0.6, 7.0, 500.0].map(Value::Real).to_vec(),
        Value::Real(x) => [1.25, 0.75, 1.01].map(|factor| Value::Real(factor * x)).to_vec(),
        Value::Whole(n) => vec![Value::Whole(n + 1), Value::Whole(n + 2), Value::Whole(n / 2)],
        Value::Flag(on) => vec![Value::Flag(!on)],
        Value::Word(word) => parameter.words().iter().filter(|w| *w != word).map(|w| Value::Word((*w).into())).collect(),
        Value::List(list) if list.is_empty() => vec![Value::List(vec![0.3, 0.2])],
        Value::List(list) => {
            let first = |factor: f64| list.iter().enumerate().map(move |(k, x)| if k == 0 { factor * x } else { *x }).collect();
            vec![Value::List(first(1.25)), Value::List(first(0.75))]
        }
    };
    candidates.into_iter().filter_map(|value| parameter.accept(value).ok()).collect()
}

/// Whether a parameter has an influence in the situation of these settings.
fn matters(experiment: &Experiment, settings: &Settings, parameter: &Parameter, plain: &(String, f64)) -> bool {
    let (_, value) = settings.iter().find(|(known, _)| known.name == parameter.name).unwrap();
    let idle = settings.idle_under(parameter.name).is_some();
    others(parameter, value).into_iter().any(|other| {
        let mut changed = settings.clone();
        changed.set(parameter.name, other).unwrap();
        match run(experiment, &changed, Some(plain.1)) {
            Ok((now, _)) => now != plain.0,
            // Refused because of something else, it has said nothing of its own influence.
            Err(key) => idle || key == parameter.name,
        }
    })
}

/// What is said wrongly of the parameters in a situation, and of how many anything is said.
fn judge(experiment: &Experiment, choice: &Parameter, situation: &str) -> (Vec<String>, usize) {
    let quick = QUICK.iter().find(|(name, _)| *name == experiment.name).map_or(&[][..], |(_, values)| values);
    let mut settings = Settings::new(experiment.parameters, 3);
    for (key, text) in quick {
        settings.set_text(key, text).unwrap();
    }
    settings.set_text(choice.name, situation).unwrap();
    if (experiment.name, choice.name) == ("wave", "start") {
        settings.set_text("density_ratio", "1").unwrap();
    }
    let plain = run(experiment, &settings, None);
    let plain = plain.unwrap_or_else(|key| panic!("{} with {situation}: {key}", experiment.name));
    let judge = |other: &Parameter| {
        let declared = settings.idle_under(other.name).is_some();
        let says = if declared { "matters after all" } else { "does not matter" };
        let wrong = matters(experiment, &settings, other, &plain) == declared;
        wrong.then(|| format!("{} {situation}: {} {says}", experiment.name, other.name))
    };
    (experiment.parameters.iter().filter_map(judge).collect(), experiment.parameters.len())
}

#[test]
fn what_a_situation_calls_unused_is_unused_and_nothing_else() {
    let mut situations = vec![];
    for experiment in REGISTRY {
        for choice in experiment.parameters {
            if let Kind::Situation { options, .. } = choice.kind {
                situations.extend(options.iter().map(|situation| (experiment, choice, situation.name)));
            }
        }
    }
    let judged: Vec<_> =
        situations.par_iter().map(|(experiment, choice, situation)| judge(experiment, choice, situation)).collect();
    assert!(judged.iter().map(|(_, compared)| compared).sum::<usize>() > 500);
    let wrong: Vec<String> = judged.into_iter().flat_map(|(wrong, _)| wrong).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
