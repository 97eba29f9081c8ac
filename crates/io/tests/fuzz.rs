//! Scenario files from strangers: whatever the bytes, the reader answers with a scenario or with a refusal, soon and in little
//! memory, and so does what sets a small system up.

#![allow(clippy::unwrap_used)] // in the helpers too: a test that cannot be set up has failed

use std::path::Path;
use std::time::{Duration, Instant};

use corpuscle_experiments::{REGISTRY, free::System};
use corpuscle_io::scenario::Subject;
use corpuscle_io::{Origin, Scenario};
use proptest::prelude::*;

const GAS: &str = "engine = \"event\"\nduration = 2.0\n[box]\nlower = [0.0, 0.0]\nupper = [9.0, 9.0]\nfaces = \"periodic\"\n\
                   [[species]]\ncount = 9\nradius = 0.4\n";

/// What has been tried by hand, and what has once been trouble.
const CORPUS: &[&str] = &[
    "",
    "\u{feff}experiment = \"wave\"",
    "experiment",
    "experiment = ",
    "experiment = 7",
    "experiment = \"wave\"\nexperiment = \"wave\"",
    "experiment = \"wäve\"",
    "seed = -1\nexperiment = \"wave\"",
    "seed = 18446744073709551616\nexperiment = \"wave\"",
    "seed = 0x1p3\nexperiment = \"wave\"",
    "duration = nan\nexperiment = \"wave\"",
    "duration = inf\nexperiment = \"wave\"",
    "duration = 1e-320\nexperiment = \"wave\"",
    "duration = 1e999\nexperiment = \"wave\"",
    "parameters = 3\nexperiment = \"wave\"",
    "[parameters]\nexperiment = \"wave\"",
    "experiment = \"brownian\"\n[parameters]\nparticles = 1e300",
    "experiment = \"brownian\"\n[parameters]\nparticles = [[[[1]]]]",
    "experiment = \"ideal-gas\"\n[parameters]\ndense_packings = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20]",
    "experiment = \"three-body\"\n[parameters]\nmasses = [0, 0, 0]",
    "engine = \"event\"",
    "engine = \"event\"\nbox = 1\nduration = 1",
    "engine = \"event\"\nduration = 1\n[box]\nlower = []\nupper = []\nfaces = \"walls\"",
    "engine = \"event\"\nduration = 1\n[box]\nlower = [0, 0, 0, 0]\nupper = [1, 1, 1, 1]\nfaces = \"walls\"",
    "engine = \"event\"\nduration = 1\n[box]\nlower = [0.0, 0.0]\nupper = [1e308, 1e308]\nfaces = \"periodic\"\n[[species]]\ncount = 2\nradius = 1e-300",
    "engine = \"event\"\nduration = 1\n[box]\nlower = [-1e308, 0.0]\nupper = [1e308, 1.0]\nfaces = \"periodic\"\n[[species]]\ncount = 1\nradius = 0.1",
    "engine = \"event\"\nduration = 1\n[box]\nlower = [0.0, 0.0]\nupper = [1.0, 1.0]\nfaces = [\"walls\"]\n[[species]]\ncount = 1\nradius = 0.1",
    "engine = \"event\"\nduration = 1\n[box]\nlower = [0.0, 0.0]\nupper = [1.0, 1.0]\nfaces = \"walls\"\n[[species]]\ncount = 9223372036854775807\nradius = 0.0",
    "engine = \"event\"\nduration = 1\n[box]\nlower = [0.0, 0.0]\nupper = [1.0, 1.0]\nfaces = \"walls\"\n[[species]]\ncount = 3\nradius = nan",
    "engine = \"time\"\nduration = 1\n[integrator]\nname = \"velocity-verlet\"\ntime_step = 5e-324\n[box]\nlower = [0.0, 0.0]\nupper = [1.0, 1.0]\nfaces = \"open\"\n[[particle]]\nposition = [0.5, 0.5]",
    "engine = \"time\"\nduration = 1\n[box]\nlower = [0.0, 0.0]\nupper = [1.0, 1.0]\nfaces = \"open\"\n[[particle]]\nposition = [0.5, 0.5]\n[[spring]]\nfirst = 0\nsecond = 18446744073709551615\nstiffness = 1",
    "engine = \"time\"\nduration = 1\n[box]\nlower = [0.0, 0.0]\nupper = [1.0, 1.0]\nfaces = \"open\"\n[[particle]]\nposition = [0.5, 0.5]\n[forces.gravity]\nconstant = -inf",
    "a.b.c.d.e.f.g.h = 1",
    "[[[[",
    "\"\\u0000\" = 1",
    "x = '''",
    "x = 2020-13-45T99:99:99",
];

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
    let accepted = CORPUS.iter().filter(|text| try_out(text)).count();
    println!("{accepted} of {} accepted", CORPUS.len());
    // Some are sentences that make sense, and are refused only when they are set up.
    assert!(accepted < CORPUS.len() / 2);
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
    let files = prop::sample::select([&[GAS, "experiment = \"wave\"\nseed = 3\n[parameters]\nmasses = 20\n"], CORPUS].concat());
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

fn cases() -> u32 {
    std::env::var("FUZZ_CASES").ok().and_then(|count| count.parse().ok()).unwrap_or(2000)
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
