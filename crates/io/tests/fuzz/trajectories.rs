//! Trajectories: extended XYZ and LAMMPS dump.

use std::io::Cursor;
use std::time::{Duration, Instant};

use corpuscle_io::trajectory::Format;
use proptest::prelude::*;

use super::{cases, corpus, spoilt};

/// Reads the first and the last frame; answers whether both are there.
fn try_out(format: Format, bytes: &[u8]) -> bool {
    let started = Instant::now();
    let read = [Some(0), None].map(|frame| {
        let outcome = format.read(Cursor::new(bytes), frame);
        match &outcome {
            Ok(snapshot) => {
                let count = snapshot.position.len();
                // No more particles than there are bytes for, each with all it has to have.
                assert!(count >= 1 && 3 * count <= bytes.len() && snapshot.species.len() == count);
                assert!(snapshot.species.iter().all(|&species| usize::from(species) < snapshot.names.len()));
                assert!(snapshot.position.iter().all(|r| r.0.iter().all(|x| !x.is_nan())));
                assert!(snapshot.mass.as_ref().is_none_or(|mass| mass.len() == count && mass.iter().all(|&m| m >= 0.0)));
                assert!(snapshot.radius.as_ref().is_none_or(|radius| radius.len() == count));
                assert!(snapshot.velocity.as_ref().is_none_or(|velocity| velocity.len() == count));
            }
            Err(error) => assert!(error.to_string().len() < 300, "{error}"),
        }
        outcome.is_ok()
    });
    assert!(started.elapsed() < Duration::from_secs(5), "{:?}", String::from_utf8_lossy(bytes));
    read[0] && read[1]
}

fn kind(format: Format) -> &'static str {
    if format == Format::Xyz { "xyz" } else { "dump" }
}

#[test]
fn the_corpus() {
    for format in [Format::Xyz, Format::Dump] {
        let files = corpus(kind(format));
        for (name, bytes) in &files {
            let good = try_out(format, bytes);
            let fine = name.starts_with("good") || ["crlf.xyz", "scientific.xyz", "unknown-item.dump"].contains(&name.as_str());
            assert_eq!(good, fine, "{name}: {:?}", format.read(Cursor::new(bytes), None).map(|snapshot| snapshot.position));
        }
        println!("{}: {} files", kind(format), files.len());
    }
}

fn mutated(format: Format) -> impl Strategy<Value = Vec<u8>> {
    let words = [
        "0",
        "-1",
        "1e400",
        "nan",
        "\n",
        "\n\n",
        " ",
        "\"",
        "=",
        "ITEM: ",
        "ATOMS id x y z\n",
        "2000001",
        "1\n",
        ":R:3",
        "Properties=",
        "\u{0}",
        "id",
    ];
    spoilt(corpus(kind(format)).into_iter().map(|file| file.1).collect(), words.map(|word| word.as_bytes().to_vec()).to_vec())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn spoilt_xyz_is_read_or_refused(bytes in mutated(Format::Xyz)) {
        try_out(Format::Xyz, &bytes);
    }

    #[test]
    fn spoilt_dumps_are_read_or_refused(bytes in mutated(Format::Dump)) {
        try_out(Format::Dump, &bytes);
    }

    #[test]
    fn noise_is_refused(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        try_out(Format::Xyz, &bytes);
        try_out(Format::Dump, &bytes);
    }
}
