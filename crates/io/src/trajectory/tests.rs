#![allow(clippy::unwrap_used)] // in the helpers too: a test that cannot go on has failed

use corpuscle_core::{Particles, Vector};

use super::*;

/// So many particles at a time, of which each has its own number.
fn frame(time: f64) -> Frame {
    let mut particles = Particles::<3>::new();
    for i in 0..7 {
        let x = time + f64::from(i);
        particles.push(Vector([x, -x, 0.0]), Vector([0.1 * x, 0.0, 0.0]), 1.0, 0.5, u16::from(i == 3));
    }
    let names = vec!["a".into(), "b c".into()];
    Frame {
        time,
        dimension: 2,
        lower: [0.0, -5.0, -0.5],
        upper: [10.0, 5.0, 0.5],
        periodic: [true, false, false],
        names,
        particles,
    }
}

fn written(folder: &Path, file: &str, frames: std::ops::Range<u64>, trajectory: Option<Trajectory>) -> Trajectory {
    let begin = || Trajectory::begin(folder, Plan::new(file, 0.5, 1e4).unwrap()).unwrap();
    let mut trajectory = trajectory.unwrap_or_else(begin);
    for number in frames {
        assert_eq!(trajectory.next_time(), 0.5 * number as f64);
        trajectory.add(&frame(0.5 * number as f64)).unwrap();
    }
    trajectory
}

/// Over several moves of the index of a GSD file, flushed often or seldom, and broken off after any number of frames.
#[test]
fn what_goes_on_has_the_same_bytes() {
    for file in ["path.xyz", "path.dump", "path.gsd"] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(file);
        written(folder.path(), file, 0..300, None).flush().unwrap();
        let whole = fs::read(&path).unwrap();
        for kept_at in [0, 1, 29, 30, 31, 32, 61, 62, 200] {
            let mut trajectory = written(folder.path(), file, 0..kept_at, None);
            trajectory.flush().unwrap();
            let kept = trajectory.kept();
            // What comes then is flushed in part, and lost.
            let mut trajectory = written(folder.path(), file, kept_at..kept_at + 40, Some(trajectory));
            trajectory.flush().unwrap();
            drop(written(folder.path(), file, kept_at + 40..kept_at + 45, Some(trajectory)));
            let mut again = Trajectory::again(folder.path(), kept).unwrap();
            for number in kept_at..300 {
                again.add(&frame(0.5 * number as f64)).unwrap();
                if number % 17 == 0 {
                    again.flush().unwrap();
                }
            }
            again.flush().unwrap();
            assert!(whole == fs::read(&path).unwrap(), "{file} from frame {kept_at}");
        }
    }
}

/// What a stranger's checkpoint says of a trajectory is not believed.
#[test]
fn what_cannot_be_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for file in ["path.xyz", "path.gsd"] {
        let mut trajectory = written(folder.path(), file, 0..5, None);
        trajectory.flush().unwrap();
        let kept = trajectory.kept();
        let bytes = kept.bytes;
        for wrong in [
            Kept { file: "../path.xyz".into(), ..kept.clone() },
            Kept { file: "/etc/passwd.xyz".into(), ..kept.clone() },
            Kept { file: "gone.xyz".into(), ..kept.clone() },
            Kept { file: "path.dump".into(), ..kept.clone() },
            Kept { bytes: bytes + 1, ..kept.clone() },
            Kept { bytes: u64::MAX, ..kept.clone() },
            Kept { every: 0.0, ..kept.clone() },
            Kept { every: f64::NAN, ..kept.clone() },
            Kept { file: if file == "path.gsd" { "path.xyz" } else { "path.gsd" }.into(), ..kept.clone() },
        ] {
            assert!(Trajectory::again(folder.path(), wrong.clone()).is_err(), "{wrong:?}");
        }
        assert_eq!(fs::metadata(folder.path().join(file)).unwrap().len(), bytes, "and nothing was changed");
        Trajectory::again(folder.path(), kept).unwrap();
    }
}

#[test]
fn a_name_that_leads_elsewhere_is_no_plan() {
    for name in ["", ".xyz", "a/b.xyz", "..", "../a.xyz", "/a.xyz", "C:a.xyz", "a\\b.xyz", "a.pdb", "a"] {
        assert!(Plan::new(name, 1.0, 10.0).is_err(), "{name}");
    }
    assert!(Plan::new("a.xyz", 1e-6, 10.0).is_err() && Plan::new("a.xyz", f64::INFINITY, 10.0).is_err());
    assert!(Plan::new("a b.gsd", 1e-5, 10.0).is_ok());
}
