//! Scenario files: whatever the bytes, the reader answers with a scenario or with a refusal, and so does what sets a small system
//! up.

use std::path::Path;
use std::time::{Duration, Instant};

use corpuscle_experiments::{REGISTRY, free::System};
use corpuscle_io::scenario::Subject;
use corpuscle_io::{Origin, Scenario};
use proptest::prelude::*;

use super::{cases, corpus};

const GAS: &str = "engine = \"event\"\nduration = 2.0\n[box]\nlower = [0.0, 0.0]\nupper = [9.0, 9.0]\nfaces = \"periodic\"\n\
                   [[species]]\ncount = 9\nradius = 0.4\n";

/// The corpus as text.
fn texts() -> Vec<String> {
    corpus("scenario").into_iter().map(|(_, bytes)| String::from_utf8(bytes).unwrap()).collect()
}

/// Reads, and sets up what is small; answers whether it was accepted.
fn try_out(text: &str) -> bool {
    let started = Instant::now();
    let outcome = Scenario::parse(REGISTRY, text, Path::new("stranger.toml"));
    let accepted = match outcome {
        Err(refusal) => {
            // The place it points at is one that is there.
            if let Origin::File(_, Some(place)) = &refusal.origin {
                assert!(place.line >= 1 && place.line <= text.matches('\n').count() + 1 && place.column >= 1, "{refusal}");
            }
            assert!(refusal.to_string().len() < 2000, "{refusal}");
            false
        }
        Ok(scenario) => {
            let small = |system: &System| system.species.iter().map(|group| group.count).fold(0, usize::saturating_add) < 200;
            if let Subject::Free(system) = &scenario.subject
                && small(system)
                && let Ok(mut simulation) = scenario.start()
            {
                // What can be set up can begin, or says why not.
                let _ = simulation.advance(1e-3 * simulation.end().min(1.0));
                let again = Scenario::parse(REGISTRY, &scenario.to_toml(), Path::new("again.toml")).unwrap();
                assert_eq!(again.to_toml(), scenario.to_toml());
            }
            true
        }
    };
    assert!(started.elapsed() < Duration::from_secs(30), "{text}");
    accepted
}

#[test]
fn the_corpus() {
    let texts = texts();
    let accepted = texts.iter().filter(|text| try_out(text)).count();
    println!("scenarios: {accepted} of {} accepted", texts.len());
    // Some are sentences that make sense, and are refused only when they are set up.
    assert!(accepted < texts.len() / 2);
    assert!(try_out(GAS) && try_out("experiment = \"wave\""));
    // Long and deep, but not for ever.
    for text in
        ["[".repeat(100_000), "x = ".to_owned() + &"[".repeat(100_000), "a = 1\n".repeat(50_000), "a.".repeat(50_000) + "b = 1"]
    {
        assert!(!try_out(&text));
    }
}

/// Files as they might be, with pieces of others in them.
fn mutated() -> impl Strategy<Value = String> {
    let words = prop::sample::select(vec![
        "0",
        "-1",
        "1e400",
        "nan",
        "-0.0",
        "1e-310",
        "\"\"",
        "\"walls\"",
        "true",
        "[]",
        "[[1]]",
        "{}",
        "\n",
        "=",
        "[box]",
        "[[species]]",
        "count = 5\n",
        "radius = 0.1\n",
        "field = [0.0, -1.0]\n",
        "title = \"\\u202e\"\n",
        "observe = [\"pressure\"]\n",
        "#",
        "'",
        "\u{0}",
    ]);
    let more = [GAS, "experiment = \"wave\"\nseed = 3\n[parameters]\nmasses = 20\n"].map(String::from);
    let files = prop::sample::select([texts(), more.to_vec()].concat());
    let edits = prop::collection::vec((any::<prop::sample::Index>(), words, 0usize..12), 1..6);
    (files, edits).prop_map(|(file, edits)| {
        let mut text: Vec<char> = file.chars().collect();
        for (at, word, cut) in edits {
            let at = at.index(text.len() + 1);
            let end = (at + cut).min(text.len());
            text.splice(at..end, word.chars());
        }
        text.into_iter().collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mutated_files_are_read_or_refused(text in mutated()) {
        try_out(&text);
    }

    #[test]
    fn noise_is_refused(text in "\\PC{0,200}") {
        try_out(&text);
    }
}
