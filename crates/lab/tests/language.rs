//! What the paper's experiments say while they run, in Chinese: captions, charts and checks, met as the window meets them.

#![allow(clippy::unwrap_used, clippy::panic)] // in the helpers too: a test that cannot be set up has failed

use std::collections::BTreeSet;

use corpuscle_experiments::{REGISTRY, find};
use corpuscle_io::Scenario;
use corpuscle_lab::language::{Language, phrases};
use corpuscle_scene::{Colouring, Scene};

/// What an experiment says in the course of a run, as it is looked up: with gaps in the places of numbers.
fn said(name: &str) -> BTreeSet<String> {
    let mut scenario = Scenario::new(find(name).unwrap());
    if scenario.settings.declaration("replicas").is_ok() {
        scenario.set("replicas", "3").unwrap();
    }
    let mut simulation = scenario.start().unwrap();
    let mut words = BTreeSet::new();
    for part in [0.01, 0.5, 1.0] {
        simulation.advance(part * simulation.end()).unwrap();
        let mut scene = Scene::default();
        simulation.draw(&mut scene);
        words.extend(scene.caption.split("  ").map(|part| part.trim_matches([' ', '·']).to_owned()));
        if let Colouring::Species(names) = scene.colouring {
            words.extend(names);
        }
        for chart in simulation.charts() {
            words.extend([chart.title, chart.x.label, chart.y.label, chart.note]);
            words.extend(chart.series.into_iter().map(|series| series.name));
        }
        words.extend(simulation.checks().into_iter().map(|check| check.quantity));
    }
    words.into_iter().filter(|text| text.split(|c: char| !c.is_ascii_alphabetic()).any(|word| word.len() > 3)).collect()
}

/// All but one in twenty, so that a new sentence does not wait for a translator.
#[test]
fn the_papers_experiments_speak_chinese_while_they_run() {
    let (mut missing, mut all) = (vec![], 0);
    for name in ["brownian", "entropy", "ideal-gas", "three-body", "wave"] {
        assert!(REGISTRY.iter().any(|experiment| experiment.name == name));
        for words in said(name) {
            all += 1;
            if Language::Chinese.phrase(&words) == words {
                missing.push(format!("{name}: {}", phrases::gaps(&words).0));
            }
        }
    }
    println!("{} of {all} missing", missing.len());
    assert!(20 * missing.len() <= all, "not in phrases.tsv: {missing:#?}");
}

/// What experiments say when they refuse a hand, and the words for it.
#[test]
fn every_refusal_of_a_hand_is_translated() {
    let situations: &[(&str, &str, &[&str])] = &[
        ("wave", "preset", &["shaker", "resonance", "dispersion", "solitons", "doppler"]),
        ("three-body", "preset", &["restricted"]),
        ("three-body", "show", &["basins"]),
    ];
    let plain = REGISTRY.iter().map(|experiment| (experiment.name, None));
    let chosen = situations.iter().flat_map(|&(name, key, words)| words.iter().map(move |&word| (name, Some((key, word)))));
    for (name, set) in plain.chain(chosen) {
        let mut scenario = Scenario::new(find(name).unwrap());
        for (key, value) in set.into_iter().chain([("replicas", "3"), ("particles", "250"), ("resolution", "16")]) {
            if scenario.settings.declaration(key).is_ok() {
                scenario.set(key, value).unwrap();
            }
        }
        let simulation = scenario.start().unwrap();
        for action in corpuscle_experiments::Action::EXAMPLES {
            let Some(needs) = simulation.refusal(action) else { continue };
            assert_ne!(Language::Chinese.phrase(needs), needs, "{name} {set:?}");
        }
    }
}
