#![allow(clippy::unwrap_used)] // in the helpers too: a test that cannot be set up has failed

use proptest::prelude::*;

use super::*;
use crate::Scenario;
use crate::example::OSCILLATOR;

fn started() -> Box<dyn Simulation> {
    Scenario::new(&OSCILLATOR).start().unwrap()
}

fn run() -> Run {
    let policy = Policy { wall: Some(60.0), time: None, work: Some(1000), keep: 2, stay: false, pictures: true };
    let pictures = vec![(0.0, "at rest".into())];
    Run { scenario: Scenario::new(&OSCILLATOR).to_toml(), time: 0.7, wall: 12.5, moments: 1, pictures, policy, trajectory: None }
}

fn good() -> Vec<u8> {
    let mut simulation = started();
    simulation.advance(0.7).unwrap();
    bytes(&run(), simulation.as_ref()).unwrap()
}

/// What reading these bytes comes to.
fn read(bytes: &[u8]) -> Result<Checkpoint, CheckpointError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.checkpoint");
    fs::write(&path, bytes).unwrap();
    Checkpoint::read(&path)
}

fn refusal(bytes: &[u8]) -> String {
    read(bytes).map(|_| ()).unwrap_err().to_string()
}

#[test]
fn a_checkpoint_brings_back_the_run_and_the_simulation() {
    let checkpoint = read(&good()).unwrap();
    assert_eq!(checkpoint.run, run());
    let mut simulation = started();
    checkpoint.load(simulation.as_mut()).unwrap();
    assert_eq!(simulation.time(), 0.7);
}

#[test]
fn no_byte_can_be_lost_or_changed_unseen() {
    let good = good();
    for end in 0..good.len() {
        assert!(read(&good[..end]).is_err(), "cut after {end} of {} bytes", good.len());
    }
    for at in 0..good.len() {
        for bit in [0x01, 0x80] {
            let mut bad = good.clone();
            bad[at] ^= bit;
            assert!(read(&bad).is_err(), "byte {at} is another");
        }
    }
    assert!(
        refusal(&[&good[..], b"\0"].concat()).contains("is cut off") || refusal(&[&good[..], b"\0"].concat()).contains("bytes")
    );
    assert_eq!(
        refusal(b"not a checkpoint at all, but long enough to be one, if only it began as one"),
        "is no checkpoint of Corpuscle"
    );
    let mut bad = good.clone();
    *bad.last_mut().unwrap() ^= 1;
    assert_eq!(refusal(&bad), "is damaged: its checksum is another");
}

/// Formats and versions are refused by name, though their checksums are right.
#[test]
fn other_versions_are_named() {
    let mut bad = good();
    bad[MAGIC.len()] = 7;
    assert!(refusal(&bad).starts_with("has the format 7; "), "{}", refusal(&bad));
    let body = &good()[HEAD..];
    let at = body.windows(VERSION.len()).position(|window| window == VERSION.as_bytes()).unwrap();
    let mut body = body.to_vec();
    body[at] = b'9';
    assert!(refusal(&seal(&body)).starts_with("was written by Corpuscle 9"), "{}", refusal(&seal(&body)));
}

#[test]
fn the_newest_are_kept_and_strangers_are_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let checkpoints = Checkpoints::of(folder.path());
    assert!(checkpoints.files().is_empty());
    checkpoints.write(b"one", 2).unwrap();
    fs::write(folder.path().join("checkpoints/notes.txt"), "mine").unwrap();
    fs::write(folder.path().join("checkpoints/last.checkpoint"), "mine").unwrap();
    for text in ["two", "three", "four"] {
        checkpoints.write(text.as_bytes(), 2).unwrap();
    }
    let files = checkpoints.files();
    let texts: Vec<_> = files.iter().map(|file| fs::read_to_string(file).unwrap()).collect();
    assert_eq!(texts, ["four", "three"]);
    assert!(files[0].ends_with("checkpoints/000004.checkpoint"));
    checkpoints.clear();
    assert_eq!(fs::read_dir(folder.path().join("checkpoints")).unwrap().count(), 2);
    fs::remove_dir_all(folder.path()).unwrap();
    assert!(checkpoints.write(b"five", 2).is_err(), "a folder that has vanished is not made anew");
}

proptest! {
    /// Whatever stands behind a right checksum is read or refused, and never believed to be longer than it is.
    #[test]
    fn strangers_bytes_are_read_or_refused(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..20), cut in any::<prop::sample::Index>()) {
        let mut body = good()[HEAD..].to_vec();
        for (at, byte) in &changes {
            let at = at.index(body.len());
            body[at] = *byte;
        }
        for body in [&body[..], &body[..cut.index(body.len())]] {
            if let Ok(checkpoint) = read(&seal(body)) {
                let _ = checkpoint.load(started().as_mut());
            }
        }
    }

    #[test]
    fn noise_is_no_checkpoint(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        prop_assert!(read(&bytes).is_err());
        let _ = read(&seal(&bytes));
    }
}
