//! Trajectories by the real command, read back by the programs of those they are for; kills, resumed to the same bytes; starts
//! from them.

#![cfg(unix)]
#![allow(clippy::unwrap_used)] // in helpers too: a test that cannot go on has failed

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use corpuscle_core::Random;
use corpuscle_io::trajectory::{self, Snapshot};
use serde_json::Value;

/// Two species of discs between walls and a periodic face.
const DISCS: &str = "engine = \"event\"\nduration = 4.0\n[box]\nlower = [-3.0, 1.0]\nupper = [9.0, 11.0]\nfaces = [\"periodic\", \"walls\"]\n\
                     [[species]]\ncount = 20\nradius = 0.3\nname = \"light ones\"\n[[species]]\ncount = 5\nradius = 0.5\nmass = 4.0\nname = \"heavy\"\n";
/// A soft fluid.
const FLUID: &str = "engine = \"time\"\nduration = 1.0\n[integrator]\nname = \"velocity-verlet\"\ntime_step = 0.005\n[box]\n\
                     lower = [0.0, 0.0, 0.0]\nupper = [6.0, 7.0, 8.0]\nfaces = \"periodic\"\n[forces.wca]\n[[species]]\ncount = 100\nradius = 0.5\n";

/// Equal but for the last digit, which serde_json may read one off.
const EXACT: f64 = f64::EPSILON;

fn corpuscle(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_corpuscle"));
    command.args(arguments).current_dir(folder);
    command
}

fn output(folder: &Path, arguments: &[&str]) -> Output {
    corpuscle(folder, arguments).output().unwrap()
}

fn complaint(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn ran(output: &Output) {
    assert!(matches!(output.status.code(), Some(0 | 3)), "{}", complaint(output));
}

/// What a reader of its own community finds in a file.
fn found(reader: &str, file: &Path) -> Vec<Value> {
    let python = Path::new(env!("CARGO_BIN_EXE_corpuscle")).ancestors().nth(2).unwrap().join("readers/bin/python");
    assert!(python.is_file(), "{} is missing: run scripts/setup.sh test, as make test does", python.display());
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/readers/read.py");
    let output = Command::new(python).arg(script).arg(reader).arg(file).output().unwrap();
    assert!(output.status.success(), "{reader} cannot read {}:\n{}", file.display(), complaint(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    assert!(value.is_array(), "no list: {value}");
    let items = value.as_array().unwrap();
    items
        .iter()
        .flat_map(|item| item.as_array().map_or_else(|| vec![item.clone()], Clone::clone))
        .map(|x| x.as_f64().unwrap())
        .collect()
}

/// Equal within the rounding of the format.
fn same(what: &str, value: &Value, expected: &[f64], error: f64) {
    let numbers = numbers(value);
    assert_eq!(numbers.len(), expected.len(), "{what}");
    for (x, y) in numbers.iter().zip(expected) {
        assert!((x - y).abs() <= error * (1.0 + y.abs()), "{what}: {x} is not {y}");
    }
}

/// A frame of one of the systems above, as a reader found it, against the same frame of our own.
fn compare(frame: &Value, expected: &Snapshot, planar: bool, shift: [f64; 3], error: f64) {
    let place: Vec<f64> = expected.position.iter().flat_map(|r| [0, 1, 2].map(|k| r[k] - shift[k])).collect();
    let mut sides = if planar { [12.0, 10.0, 1.0] } else { [6.0, 7.0, 8.0] };
    if planar && frame.get("dimension").is_some() {
        sides[2] = 0.0;
    }
    same("position", &frame["position"], &place, error);
    if frame.get("dimension").is_some() || error == EXACT || !planar {
        same("box", &frame["box"], &sides, 1e-6);
    }
    if let Some(velocity) = frame.get("velocity") {
        same("velocity", velocity, &expected.velocity.as_ref().unwrap().iter().flat_map(|v| v.0).collect::<Vec<_>>(), error);
        same("mass", &frame["mass"], expected.mass.as_ref().unwrap(), error);
    }
    if let Some(radius) = frame.get("radius") {
        // OVITO keeps radii in single precision.
        same("radius", radius, expected.radius.as_ref().unwrap(), error.max(1e-6));
    }
    if let Some(time) = frame.get("time") {
        same("time", &Value::from(vec![time.clone()]), &[expected.time.unwrap()], error);
    }
    // GSD has no word for walls.
    if let Some(periodic) = frame.get("periodic").filter(|_| error == EXACT) {
        let axes: Vec<bool> = periodic.as_array().unwrap().iter().map(|axis| axis.as_bool().unwrap()).collect();
        assert_eq!(axes[..2], if planar { [true, false] } else { [true, true] });
    }
}

#[test]
fn each_format_is_read_by_its_community() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text, planar) in [("discs", DISCS, true), ("fluid", FLUID, false)] {
        fs::write(folder.path().join("system.toml"), text).unwrap();
        let mut files = vec![];
        for format in ["xyz", "dump", "gsd"] {
            let (out, file) = (format!("{name}-{format}"), format!("path.{format}"));
            let run = ["run", "system.toml", "--out", &out, "--trajectory", &file, "--no-pictures", "--quiet"];
            ran(&output(folder.path(), &run));
            files.push(folder.path().join(out).join(file));
        }
        let own: Vec<Snapshot> = (0..=100).map(|k| trajectory::read(&files[0], Some(k)).unwrap()).collect();
        assert!(trajectory::read(&files[0], Some(101)).is_err());
        let centre = if planar { [3.0, 6.0, 0.0] } else { [3.0, 3.5, 4.0] };
        for (reader, file, shift, error) in [
            ("ase", &files[0], [0.0; 3], EXACT),
            ("ovito", &files[0], [0.0; 3], EXACT),
            ("ase", &files[1], [0.0; 3], EXACT),
            ("ovito", &files[1], [0.0; 3], EXACT),
            ("gsd", &files[2], centre, 1e-6),
            ("ovito", &files[2], centre, 1e-6),
        ] {
            let frames = found(reader, file);
            assert_eq!(frames.len(), own.len(), "{reader} {}", file.display());
            for (number, (frame, expected)) in frames.iter().zip(&own).enumerate() {
                compare(frame, expected, planar, shift, error);
                if let Some(step) = frame.get("step") {
                    assert_eq!(step.as_u64(), Some(number as u64));
                }
            }
            if let Some(names) = frames[100].get("name").filter(|_| planar) {
                let expected = match file.extension().unwrap().to_str().unwrap() {
                    "xyz" => ("light_ones", "heavy"),
                    "dump" => ("type 1", "type 2"),
                    _ => ("light ones", "heavy"),
                };
                assert_eq!((names[0].as_str().unwrap(), names[24].as_str().unwrap()), expected, "{reader}");
            }
        }
        // Dump and XYZ have the same numbers.
        for number in [0, 50, 100] {
            let (xyz, dump) = (&own[number as usize], trajectory::read(&files[1], Some(number)).unwrap());
            assert_eq!(
                (&xyz.position, &xyz.velocity, &xyz.mass, &xyz.radius),
                (&dump.position, &dump.velocity, &dump.mass, &dump.radius)
            );
        }
    }
}

/// Killed in the middle, a file has whole frames only (the end of a text may be cut); resumed, it has the bytes of an unbroken run.
#[test]
fn a_killed_trajectory_is_whole_and_goes_on_to_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let long = FLUID.replace("duration = 1.0", "duration = 60.0");
    fs::write(folder.path().join("system.toml"), long).unwrap();
    let mut random = Random::new(std::process::id().into(), 0);
    for format in ["xyz", "dump", "gsd"] {
        let file = format!("path.{format}");
        // A kill may come before there is anything to go on with.
        let go_on = |out: &str| {
            let run = ["run", "system.toml", "--force", "--out", out, "--no-pictures", "--checkpoint-time", "2"];
            let filmed = ["--every", "0.25", "--trajectory", &file, "--quiet"];
            let begun = folder.path().join(out).join("scenario.toml").is_file();
            if begun {
                corpuscle(folder.path(), &["resume", out, "--quiet"])
            } else {
                corpuscle(folder.path(), &[&run[..], &filmed].concat())
            }
        };
        let clock = Instant::now();
        ran(&go_on("whole").output().unwrap());
        let whole = clock.elapsed();
        let expected = fs::read(folder.path().join("whole").join(&file)).unwrap();
        let path: PathBuf = folder.path().join("broken").join(&file);
        for _ in 0..6 {
            let mut command = go_on("broken");
            let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
            let end = whole.mul_f64(0.05 + 0.3 * random.uniform());
            std::thread::sleep(end.max(Duration::from_millis(20)));
            let finished = child.try_wait().unwrap().is_some();
            child.kill().unwrap();
            child.wait().unwrap();
            if finished {
                break;
            }
            let there = fs::read(&path).unwrap_or_default();
            let frames = match format {
                // Killed before there was a header.
                "gsd" if !there.starts_with(&0x65df_65df_65df_65df_u64.to_le_bytes()) => 0,
                "gsd" => found("gsd", &path).len(),
                _ => {
                    assert!(expected.starts_with(&there), "{format}: what is there is the beginning of the whole");
                    usize::from(trajectory::read(&path, None).is_ok())
                }
            };
            println!("{format}: killed with {} bytes, {frames} frames", there.len());
        }
        if !folder.path().join("broken/report.html").is_file() {
            ran(&go_on("broken").output().unwrap());
        }
        assert!(expected == fs::read(&path).unwrap(), "{format}: the bytes are others");
        if format != "dump" {
            assert_eq!(found(if format == "gsd" { "gsd" } else { "ase" }, &path).len(), 241);
        }
        for out in ["whole", "broken"] {
            fs::remove_dir_all(folder.path().join(out)).unwrap();
        }
    }
}

/// The last frame of one run is the start of another, which then goes on like the first: the same places and velocities, to the bit.
#[test]
fn a_run_starts_from_a_trajectory_and_takes_it_along() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("system.toml"), DISCS).unwrap();
    let run = |scenario: &str, out: &str, file: &str| {
        output(
            folder.path(),
            &[
                "run",
                scenario,
                "--out",
                out,
                "--trajectory",
                file,
                "--every",
                "1",
                "--no-pictures",
                "--quiet",
                "--checkpoints",
                "1",
            ],
        )
    };
    let empty = DISCS.split("[[species]]").next().unwrap();
    for file in ["path.xyz", "path.dump"] {
        ran(&run("system.toml", "first", file));
        let first = trajectory::read(&folder.path().join("first").join(file), Some(2)).unwrap();
        fs::rename(folder.path().join("first").join(file), folder.path().join(file)).unwrap();
        fs::write(folder.path().join("again.toml"), format!("{empty}[start]\nfile = \"{file}\"\nframe = 2\n")).unwrap();
        ran(&run("again.toml", "second", "path.xyz"));
        let second = trajectory::read(&folder.path().join("second/path.xyz"), Some(0)).unwrap();
        assert_eq!(
            (&first.position, &first.velocity, &first.mass, &first.radius),
            (&second.position, &second.velocity, &second.mass, &second.radius)
        );
        // The folder of a run needs nothing else: not the file it came from.
        fs::remove_file(folder.path().join(file)).unwrap();
        ran(&output(
            folder.path(),
            &["run", "second/scenario.toml", "--out", "third", "--trajectory", "path.xyz", "--every", "1", "--no-pictures"],
        ));
        let paths = ["second", "third"].map(|out| fs::read_to_string(folder.path().join(out).join("path.xyz")).unwrap());
        assert_eq!(paths[0], paths[1]);
        // But that file it needs, as it was.
        let start = folder.path().join("second/start.xyz");
        fs::write(&start, fs::read_to_string(&start).unwrap().replacen("0.3", "0.2", 1)).unwrap();
        let refused = output(folder.path(), &["resume", "second", "--quiet"]);
        assert!(complaint(&refused).contains("start.blake3"), "{}", complaint(&refused));
        for out in ["first", "second", "third"] {
            fs::remove_dir_all(folder.path().join(out)).unwrap();
        }
    }
}

#[test]
fn what_cannot_be_started_from_is_refused_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let empty = DISCS.split("[[species]]").next().unwrap();
    fs::write(folder.path().join("points.xyz"), "2\n\nA 1 2 0\nB 3 4 0\n").unwrap();
    fs::write(folder.path().join("tilted.xyz"), "2\n\nA 1 2 0\nB 3 4 1\n").unwrap();
    fs::write(folder.path().join("outside.xyz"), "1\n\nA 1 200 0\n").unwrap();
    fs::create_dir(folder.path().join("folder.xyz")).unwrap();
    let rest = "radius = 0.1\nmass = 1\ntemperature = 1\n";
    for (keys, expected) in [
        ("file = \"none.xyz\"\n", "again.toml:8:8: start.file = none.xyz: cannot be read: No such file"),
        ("file = \"../points.xyz\"\n", "expected a file in the folder of the scenario, or below it"),
        ("file = \"/etc/passwd\"\n", "expected a file in the folder of the scenario, or below it"),
        ("file = \"again.toml\"\n", "start.file = again.toml: cannot be read: a name that ends in .xyz"),
        ("file = \"folder.xyz\"\n", "it is no file"),
        (
            "file = \"points.xyz\"\n",
            "start.temperature = missing: expected a number, 0 for a start at rest: points.xyz has no velocities",
        ),
        ("file = \"points.xyz\"\ntemperature = 1\n", "start.mass = missing"),
        ("file = \"points.xyz\"\nframe = 1\n", "again.toml:9:9: start.frame = 1: expected one of the 1 whole frames, from 0"),
        ("file = \"points.xyz\"\nradius = -1\nmass = 1\ntemperature = 1\n", "again.toml:9:10: start.radius = -1"),
        ("file = \"points.xyz\"\nradus = 1\n", "did you mean `radius`?"),
        ("file = \"tilted.xyz\"\nREST", "expected particles in a plane"),
        ("file = \"outside.xyz\"\nREST", "start.file = position of particle 0"),
        ("file = \"points.xyz\"\nREST[[species]]\ncount = 1\nradius = 0.1\n", "nothing beside [start]"),
    ] {
        fs::write(folder.path().join("again.toml"), format!("{empty}[start]\n{}", keys.replace("REST", rest))).unwrap();
        let output = output(folder.path(), &["check", "again.toml"]);
        assert_eq!(output.status.code(), Some(2), "{keys}");
        assert!(complaint(&output).contains(expected), "{}\nbut expected {expected}", complaint(&output));
    }
    fs::write(folder.path().join("again.toml"), format!("{empty}[start]\nfile = \"points.xyz\"\n{rest}")).unwrap();
    let output = output(folder.path(), &["check", "again.toml"]);
    assert!(output.status.success(), "{}", complaint(&output));
}

#[test]
fn what_cannot_be_written_is_refused_before_the_run() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("system.toml"), DISCS).unwrap();
    for (arguments, expected) in [
        (&["--trajectory", "../path.xyz"][..], "expected the name of a file, which is written into the folder of the run"),
        (&["--trajectory", "/tmp/path.xyz"], "expected the name of a file"),
        (&["--trajectory", ".xyz"], "expected the name of a file"),
        (&["--trajectory", "path.pdb"], "expected a name that ends in .xyz"),
        (&["--trajectory", "path.xyz", "--every", "1e-9"], "a million frames in all"),
        (&["--every", "1"], "trajectory"),
    ] {
        let output = output(folder.path(), &[&["run", "system.toml"], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{}", complaint(&output));
        assert!(complaint(&output).contains(expected), "{}\nbut expected {expected}", complaint(&output));
    }
    assert!(!folder.path().join("results").exists());
}

/// A checkpoint for other programs; a trajectory that is gone is missed, and a link in its place not followed.
#[test]
fn checkpoints_are_exported_and_lost_trajectories_are_missed() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("system.toml"), DISCS).unwrap();
    let run = [
        "run",
        "system.toml",
        "--out",
        "out",
        "--trajectory",
        "path.xyz",
        "--checkpoints",
        "2",
        "--checkpoint-time",
        "3",
        "--no-pictures",
    ];
    ran(&output(folder.path(), &run));
    for file in ["one.xyz", "one.dump", "one.gsd"] {
        let exported = output(folder.path(), &["export", "out", "--out", file]);
        assert!(
            exported.status.success() && String::from_utf8_lossy(&exported.stdout).contains("25 particles at t = 3"),
            "{}",
            complaint(&exported)
        );
        assert_eq!(output(folder.path(), &["export", "out", "--out", file]).status.code(), Some(2), "not twice without --force");
    }
    let of_run = trajectory::read(&folder.path().join("out/path.xyz"), Some(75)).unwrap();
    let exported = trajectory::read(&folder.path().join("one.xyz"), None).unwrap();
    assert_eq!((of_run.position, of_run.velocity), (exported.position, exported.velocity));
    assert_eq!(found("gsd", &folder.path().join("one.gsd")).len(), 1);

    fs::rename(folder.path().join("out/path.xyz"), folder.path().join("kept.xyz")).unwrap();
    let missed = output(folder.path(), &["resume", "out", "--quiet"]);
    assert_eq!(missed.status.code(), Some(2));
    assert!(complaint(&missed).contains("put it back, or go on with --no-trajectory"), "{}", complaint(&missed));
    std::os::unix::fs::symlink(folder.path().join("kept.xyz"), folder.path().join("out/path.xyz")).unwrap();
    assert!(complaint(&output(folder.path(), &["resume", "out", "--quiet"])).contains("something that is no file"));
    ran(&output(folder.path(), &["resume", "out", "--quiet", "--no-trajectory"]));
}

/// The registered experiments, too, write what is on show.
#[test]
fn an_experiment_writes_its_particles() {
    let folder = tempfile::tempdir().unwrap();
    let run = [
        "run",
        "newton-cradle",
        "--set",
        "balls=4",
        "--duration",
        "2",
        "--out",
        "out",
        "--trajectory",
        "path.xyz",
        "--every",
        "0.5",
    ];
    ran(&output(folder.path(), &[&run[..], &["--no-pictures", "--quiet"]].concat()));
    let file = folder.path().join("out/path.xyz");
    let frames = found("ase", &file);
    assert_eq!(frames.len(), 5);
    for (k, frame) in frames.iter().enumerate() {
        let own = trajectory::read(&file, Some(k as u64)).unwrap();
        assert_eq!((own.position.len(), own.time), (4, Some(0.5 * k as f64)));
        same("position", &frame["position"], &own.position.iter().flat_map(|r| r.0).collect::<Vec<_>>(), EXACT);
    }
}
