//! Every kind of input that cannot be used ends with exit code 2 and one line that says what is wrong; nothing is written.

#![allow(clippy::unwrap_used)] // in the helpers too: a test that cannot be set up has failed

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// The command, in a folder of its own.
fn corpuscle(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_corpuscle")).args(arguments).current_dir(folder).output().expect("the command starts")
}

/// Runs with these arguments, after writing `file` as scenario.toml, and asserts refusal: exit code 2, one line on standard
/// error with every one of `parts`, nothing on standard output, nothing written.
fn refused(file: Option<&[u8]>, arguments: &[&str], parts: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    if let Some(bytes) = file {
        fs::write(folder.path().join("scenario.toml"), bytes).unwrap();
    }
    let before = fs::read_dir(folder.path()).unwrap().count();
    let output = corpuscle(folder.path(), arguments);
    let complaint = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {complaint}");
    assert_eq!(complaint.lines().count(), 1, "{complaint}");
    assert!(output.stdout.is_empty());
    for part in parts {
        assert!(complaint.contains(part), "{arguments:?}: {complaint}does not say {part}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), before, "{arguments:?} left something behind");
}

fn refused_file(text: &str, parts: &[&str]) {
    for command in ["run", "check", "view"] {
        refused(Some(text.as_bytes()), &[command, "scenario.toml"], parts);
    }
    refused(Some(text.as_bytes()), &["record", "scenario.toml", "--out", "clip.gif"], parts);
}

#[test]
fn what_is_no_scenario_at_all() {
    refused(None, &["run", "none.toml"], &["none.toml", "a scenario file that can be read"]);
    refused(None, &["run", "."], &["a folder", "expected a scenario file"]);
    refused(None, &["run", "brownain"], &["experiment = brownain", "did you mean `brownian`?"]);
    refused(Some(b"\x7fELF\x02\xff\xfe\x00"), &["run", "scenario.toml"], &["scenario.toml", "not UTF-8"]);
    refused_file("", &["scenario.toml", "experiment = (missing)"]);
    refused_file("experiment = \"brownian\"\nseed = = 3\n", &["scenario.toml:2:", "TOML"]);
    refused_file("experiment = \"teleportation\"\n", &["scenario.toml:1:14", "teleportation", "brownian"]);
}

#[test]
fn keys_and_values_of_an_experiment() {
    let file = |line: &str| format!("experiment = \"brownian\"\n[parameters]\n{line}\n");
    refused_file(&file("temprature = 1.0"), &["scenario.toml:3:1", "temprature", "did you mean `temperature`?"]);
    refused_file(&file("radius = -1.0"), &["scenario.toml:3:10", "radius = -1.0", "a number from"]);
    refused_file(&file("temperature = nan"), &["scenario.toml:3:15", "temperature = nan"]);
    refused_file(&file("particles = 0"), &["scenario.toml:3:13", "particles = 0", "a whole number from"]);
    refused_file(&file("particles = \"many\""), &["scenario.toml:3:13", "particles = \"many\""]);
    refused_file("experiment = \"brownian\"\ntemperature = 1.0\n", &["scenario.toml:2:1", "below [parameters]"]);
    refused_file("experiment = \"brownian\"\nseed = 1.5\n", &["scenario.toml:2:8", "seed = 1.5"]);
    refused_file("experiment = \"brownian\"\nduration = -1\n", &["scenario.toml:2:12", "duration = -1"]);
}

#[test]
fn values_on_the_command_line() {
    for (assignment, parts) in [
        ("radius=-1", ["on the command line", "radius = -1"]),
        ("radius=NaN", ["on the command line", "radius = NaN"]),
        ("particles=0", ["on the command line", "particles = 0"]),
        ("particles=", ["on the command line", "a whole number"]),
        ("partcles=5", ["partcles = (an unknown key)", "did you mean `particles`?"]),
    ] {
        refused(None, &["run", "brownian", "--set", assignment], &parts);
    }
}

#[test]
fn arguments_that_make_no_sense() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [
        &["run"][..],
        &["fly"],
        &["run", "wave", "--set", "no-equals-sign"],
        &["run", "wave", "--seed", "-1"],
        &["run", "wave", "--threads", "0"],
        &["run", "wave", "--duration", "NaN"],
        &["view", "wave", "--size", "0x10"],
        &["view", "wave", "--at", "soon"],
        &["record", "wave"],
        &["record", "wave", "--out", "clip.mp4", "--fps", "0"],
        &["record", "wave", "--out", "clip.exe"],
        &["record", "wave", "--out", "clip.mp4", "--size", "641x480"],
        &["record", "wave", "--out", "clip.gif", "--from", "2", "--to", "1"],
    ] {
        let output = corpuscle(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(!output.stderr.is_empty());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "{arguments:?} left something behind");
    }
}

#[test]
fn systems_that_cannot_be() {
    let file = |particles: &str| {
        format!("engine = \"event\"\nduration = 1.0\n[box]\nlower = [0.0, 0.0]\nupper = [4.0, 4.0]\nfaces = \"walls\"\n{particles}")
    };
    refused_file(&file("[[species]]\ncount = 100\nradius = 0.5\n"), &["scenario.toml:", "species[0].count = 100"]);
    refused_file(&file("[[species]]\ncount = 3\nradius = -0.5\n"), &["scenario.toml:9:10", "species[0].radius = -0.5"]);
    refused_file(&file("[[species]]\ncount = 0\nradius = 0.5\n"), &["scenario.toml:", "0"]);
    let two = "[[particle]]\nposition = [1.0, 1.0]\nradius = 0.5\n[[particle]]\nposition = [1.5, 1.0]\nradius = 0.5\n";
    refused_file(&file(two), &["scenario.toml", "particles 0 and 1", "overlapping"]);
    refused_file(&file("[[particle]]\nposition = [nan, 1.0]\nradius = 0.5\n"), &["scenario.toml", "NaN"]);
}

#[test]
fn an_output_that_is_taken() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("taken");
    fs::write(&file, "keep me").unwrap();
    fs::create_dir(folder.path().join("full")).unwrap();
    fs::write(folder.path().join("full/mine.txt"), "keep me").unwrap();
    for (out, part) in [("taken", "this is a file"), ("full", "the folder is not empty")] {
        let output = corpuscle(folder.path(), &["run", "wave", "--out", out]);
        assert_eq!(output.status.code(), Some(2));
        assert!(String::from_utf8_lossy(&output.stderr).contains(part));
    }
    let output = corpuscle(folder.path(), &["record", "wave", "--out", "full/mine.txt"]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(fs::read_to_string(&file).unwrap(), "keep me");
    assert_eq!(fs::read_dir(folder.path().join("full")).unwrap().count(), 1);
}
