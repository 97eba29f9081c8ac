//! Runs killed at random moments, as often as it pleases, and resumed: what they leave behind at last is what an unbroken run
//! leaves, to the last bit, in the state, in every series, in the trajectory and in the summary.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::case_sensitive_file_extension_comparisons)] // in helpers too: a test that cannot go on has failed; names are our own

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use corpuscle_core::Random;
use corpuscle_io::{Checkpoint, Checkpoints};
use serde_json::Value;

/// A second or two of either engine, with everything that is measured.
const SYSTEMS: [(&str, &str); 2] = [
    (
        "event",
        "engine = \"event\"\nduration = DURATION\nobserve = [\"temperature\", \"pressure\", \"speeds\", \"radial-distribution\", \
         \"mean-squared-displacement\"]\n[box]\nlower = [0.0, 0.0, 0.0]\nupper = [14.0, 14.0, 14.0]\nfaces = \"periodic\"\n\
         [[species]]\ncount = 2000\nradius = 0.5\n",
    ),
    (
        "time",
        "engine = \"time\"\nduration = DURATION\nobserve = [\"temperature\", \"pressure\", \"radial-distribution\"]\n[integrator]\n\
         name = \"velocity-verlet\"\ntime_step = 0.005\n[box]\nlower = [0.0, 0.0]\nupper = [40.0, 40.0]\nfaces = \"periodic\"\n\
         [forces.lennard_jones]\nepsilon = 1.0\nsigma = 1.0\ncutoff = 2.5\n[[species]]\ncount = 800\nradius = 0.5\ntemperature = 0.7\n",
    ),
];
/// How long each runs, the time between its checkpoints, of which the last is at its end, and its trajectory.
const TIMES: [Timing; 2] = [("30.0", "2.5", "path.gsd"), ("6.0", "0.5", "path.xyz")];
type Timing = (&'static str, &'static str, &'static str);

fn corpuscle(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_corpuscle"));
    command.args(arguments).current_dir(folder).stdout(Stdio::null()).stderr(Stdio::null());
    command
}

/// The run in this folder, or what goes on with it. A kill may come before there is a folder, or in the middle of a file.
fn go_on(folder: &Path, out: &str, (_, interval, trajectory): Timing) -> Command {
    let often = ["--checkpoint-time", interval, "--checkpoints", "2", "--no-pictures", "--quiet"];
    let begun = folder.join(out).join("scenario.toml").is_file();
    let every = (interval.parse::<f64>().unwrap() / 7.0).to_string();
    let filmed = ["run", "system.toml", "--force", "--out", out, "--trajectory", trajectory, "--every", &every];
    let what = if begun { &["resume", out][..] } else { &filmed };
    corpuscle(folder, &[what, &often].concat())
}

/// What a finished run left: its series, its summary without the clock, and the state at its end.
fn left_behind(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if [".csv", ".xyz", ".gsd"].iter().any(|end| name.ends_with(end)) || name == "scenario.toml" {
            files.insert(name, fs::read(&path).unwrap());
        } else if name == "summary.json" {
            let mut summary: Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
            let engine = summary["engine"].as_object_mut().unwrap();
            assert!(engine.remove("wall_s").is_some() && engine.remove("rate").is_some());
            files.insert(name, summary.to_string().into());
        } else {
            assert!(!name.starts_with('.'), "{name} is left over");
        }
    }
    let newest = Checkpoint::read(&Checkpoints::of(folder).files()[0]).unwrap();
    files.insert("state".into(), format!("t = {:?}: {}", newest.run.time, newest.digest().unwrap()).into());
    files
}

/// Kills a process some time after its start; false when it had ended by itself.
fn killed(mut child: Child, after: Duration) -> bool {
    let start = Instant::now();
    while start.elapsed() < after {
        if child.try_wait().unwrap().is_some() {
            return false;
        }
        std::thread::sleep(Duration::from_micros(200));
    }
    let alive = child.try_wait().unwrap().is_none();
    child.kill().unwrap();
    child.wait().unwrap();
    alive
}

/// So many kills of each engine, up to six a run.
fn survive(kills: u32) {
    let mut random = Random::new(std::process::id().into(), 0);
    for ((name, text), timing) in SYSTEMS.into_iter().zip(TIMES) {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("system.toml"), text.replace("DURATION", timing.0)).unwrap();
        let started = Instant::now();
        let status = go_on(folder.path(), "unbroken", timing).status().unwrap();
        assert!(matches!(status.code(), Some(0 | 3)), "{name}: {status}");
        let whole = started.elapsed();
        let expected = left_behind(&folder.path().join("unbroken"));
        let (mut done, mut runs, mut before) = (0, 0, 0);
        while done < kills {
            let out = format!("broken-{runs}");
            runs += 1;
            for _ in 0..6 {
                let child = go_on(folder.path(), &out, timing).spawn().unwrap();
                if !killed(child, whole.mul_f64(0.5 * random.uniform())) {
                    break;
                }
                done += 1;
                before += u32::from(Checkpoints::of(&folder.path().join(&out)).files().is_empty());
            }
            let finished = folder.path().join(&out).join("report.html").is_file();
            if !finished {
                let status = go_on(folder.path(), &out, timing).status().unwrap();
                assert!(matches!(status.code(), Some(0 | 3)), "{name}, run {runs}: {status}");
            }
            let found = left_behind(&folder.path().join(&out));
            for (file, bytes) in &expected {
                let words = |bytes: &[u8]| String::from_utf8_lossy(bytes).chars().take(3000).collect::<String>();
                let other = found.get(file).map(|found| words(found));
                assert!(found.get(file) == Some(bytes), "{name}, run {runs}: {file} is another\n{}\n{other:?}", words(bytes));
            }
            assert_eq!(expected.len(), found.len(), "{name}, run {runs}");
            fs::remove_dir_all(folder.path().join(&out)).unwrap();
        }
        println!(
            "{name}: {done} kills ({before} before the first checkpoint) in {runs} runs of {:.1} s, all the same",
            whole.as_secs_f64()
        );
    }
}

#[test]
fn a_run_survives_being_killed() {
    survive(10);
}

/// `make kill`
#[test]
#[ignore = "takes a quarter of an hour"]
fn a_run_survives_being_killed_a_hundred_times_by_either_engine() {
    survive(100);
}
