//! Every kind of input that cannot be used ends with exit code 2 and one line that says what is wrong; nothing is written.

#![allow(clippy::unwrap_used)] // in the helpers too: a test that cannot be set up has failed

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// The command, in a folder of its own.
fn corpuscle(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_corpuscle")).args(arguments).current_dir(folder).output().expect("the command starts")
}

/// The command alone, where there is no display.
fn without_display(folder: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_corpuscle"));
    command.current_dir(folder).env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET");
    command.output().expect("the command starts")
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

/// A row: the arguments, and what the one line has to name.
type Row<'a> = (&'a [&'a str], &'a [&'a str]);

#[test]
fn values_on_the_command_line() {
    let rows: &[Row] = &[
        (&["brownian", "--set", "radius=-1"], &["on the command line", "radius = -1", "a number from"]),
        (&["brownian", "--set", "radius=NaN"], &["on the command line", "radius = NaN"]),
        (&["brownian", "--set", "temperature=-1"], &["temperature = -1", "a number from"]),
        (&["brownian", "--set", "temperature=1e999"], &["temperature = ", "a number from"]),
        (&["brownian", "--set", "particles=0"], &["on the command line", "particles = 0"]),
        (&["brownian", "--set", "particles="], &["on the command line", "a whole number"]),
        (&["brownian", "--set", "particles=1e9"], &["particles = 1e9", "a whole number from"]),
        (&["brownian", "--set", "particles=1000000000000"], &["particles = 1000000000000", "a whole number from"]),
        (&["brownian", "--set", "particles=99999999999999999999999"], &["particles = 9999", "a whole number from"]),
        (&["brownian", "--set", "partcles=5"], &["partcles = (an unknown key)", "did you mean `particles`?"]),
        (&["brownian", "--set", "nosuch=1"], &["nosuch", "one of", "temperature"]),
        (&["brownian", "--set", "=1"], &["set = =1", "KEY=VALUE"]),
        (&["brownian", "--set", "no-equals-sign"], &["set = no-equals-sign", "KEY=VALUE"]),
        (&["three-body", "--set", "masses=1,2"], &["masses = [1.0, 2.0]", "three"]),
        (&["three-body", "--set", "masses=1,2,x"], &["masses = "]),
        (&["three-body", "--set", "preset=foo"], &["preset = foo", "figure-eight"]),
        (&["three-body", "--set", "preset=figure-ate"], &["preset = figure-ate", "figure-eight"]),
        (&["wave", "--seed", "abc"], &["seed = abc", "a whole number from 0"]),
        (&["wave", "--seed", "-1"], &["seed = -1", "a whole number from 0"]),
        (&["wave", "--seed", "18446744073709551616"], &["seed = 18446744073709551616", "a whole number from 0"]),
        (&["wave", "--threads", "0"], &["threads = 0", "1..=1024"]),
        (&["wave", "--duration", "NaN"], &["duration = NaN", "a number above 0"]),
        (&["wave", "--duration", "-1"], &["duration = -1", "a number above 0"]),
        (&["wave", "--duration", "1e300"], &["duration = 1", "a number from"]),
        (&["wave", "--out", ""], &["out", "a value"]),
        (&["wave", "--force"], &["--out"]),
        (&["wave", "entropy"], &["entropy"]),
        (&["wave", "--frobnicate"], &["--frobnicate", "--help"]),
        (&["wave", "--sed", "3"], &["--sed", "did you mean `--se"]),
        (&["nosuch"], &["experiment = nosuch", "a scenario file or one of", "three-body"]),
        (&[""], &["experiment = ", "a scenario file"]),
        (&[], &["NAME|FILE"]),
    ];
    for (arguments, parts) in rows {
        refused(None, &[&["run"], *arguments].concat(), parts);
    }
}

#[test]
fn arguments_of_pictures_and_clips() {
    let rows: &[Row] = &[
        (&["view", "wave", "--size", "0x0"], &["size = 0x0", "WIDTHxHEIGHT"]),
        (&["view", "wave", "--size", "-5x5"], &["size = -5x5", "WIDTHxHEIGHT"]),
        (&["view", "wave", "--size", "large"], &["size = large", "WIDTHxHEIGHT"]),
        (&["view", "wave", "--screenshot", "a.png", "--size", "99999x99999"], &["99999", "from 1 to"]),
        (&["view", "wave", "--screenshot", "a.png", "--at", "-1s"], &["at = -1s", "a time from 0"]),
        (&["view", "wave", "--screenshot", "a.png", "--at", "soon"], &["at = soon", "as in 2.5s"]),
        (&["view", "wave", "--screenshot", "a.png", "--at", "1sss"], &["at = 1sss", "as in 2.5s"]),
        (&["view", "wave", "--screenshot", "a.png", "--at", "inf"], &["at = inf", "a time"]),
        (&["view", "wave", "--screenshot", "a.jpg"], &["screenshot = a.jpg", ".png"]),
        (&["view", "wave", "--screenshot", "none/a.png"], &["screenshot = none/a.png", "a folder that exists"]),
        (&["view", "wave", "--palette", "pink"], &["palette = pink", "dark, light"]),
        (&["record", "wave"], &["--out"]),
        (&["record", "wave", "--out", "c.mp4", "--fps", "0"], &["fps = 0", "a number above 0"]),
        (&["record", "wave", "--out", "c.mp4", "--fps", "-3"], &["fps = -3", "a number above 0"]),
        (&["record", "wave", "--out", "c.mp4", "--fps", "1e9"], &["fps = 1000000000", "at most 1000"]),
        (&["record", "wave", "--out", "c.gif", "--fps", "60"], &["fps = 60", "at most 50"]),
        (&["record", "wave", "--out", "c.mp4", "--speed", "0"], &["speed = 0", "a number above 0"]),
        (&["record", "wave", "--out", "c.mp4", "--speed", "1e-9"], &["speed = 1e-9", "at most 100000 pictures"]),
        (&["record", "wave", "--out", "c.mp4", "--speed", "1e-320"], &["speed = ", "at most 100000 pictures"]),
        (&["record", "wave", "--out", "c.mp4", "--size", "641x480"], &["c.mp4", "even"]),
        (&["record", "wave", "--out", "c.mp4", "--size", "99999x99998"], &["size = 99999x99998", "3840x2160"]),
        (&["record", "wave", "--out", "c.mp4", "--size", "2x2"], &["size = 2x2", "from 16"]),
        (&["record", "wave", "--out", "c.gif", "--size", "99999x99998"], &["99999", "from 1 to"]),
        (&["record", "wave", "--out", "c.gif", "--from", "2", "--to", "1"], &["to = 1", "after the first picture"]),
        (&["record", "wave", "--out", "c.exe"], &["out = c.exe", ".mp4 or .gif"]),
        (&["record", "wave", "--out", "c.png"], &["out = c.png", "--screenshot"]),
        (&["record", "wave", "--out", "none/c.gif"], &["out = none/c.gif", "a folder that exists"]),
        (&["record", "wave", "--out", ".."], &["out = .."]),
        (&["record", "wave", "--out", "/"], &["out = /"]),
    ];
    for (arguments, parts) in rows {
        refused(None, arguments, parts);
    }
}

#[test]
fn commands_there_are_not() {
    refused(None, &["fly"], &["unrecognized subcommand 'fly'", "--help"]);
    refused(None, &["runn", "wave"], &["did you mean `run`?"]);
    refused(None, &["list", "more"], &["more"]);
    refused(None, &["check"], &["NAME|FILE"]);
    refused(None, &["check", "nosuch"], &["experiment = nosuch"]);
}

#[test]
fn a_newcomer_is_told_where_to_start() {
    let folder = tempfile::tempdir().unwrap();
    let output = without_display(folder.path());
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(output.stderr.is_empty());
    assert!(text.lines().count() < 15, "short: {text}");
    assert!(text.contains("No display") && text.contains("DISPLAY"), "it says why there is no window: {text}");
    for part in ["corpuscle list", "corpuscle view", "corpuscle run", "corpuscle record", "--help", "brownian", "wave"] {
        assert!(text.contains(part), "{text}");
    }
    // What it tells to type can be typed.
    for line in text.lines().filter_map(|line| line.strip_prefix("  corpuscle ")) {
        let words: Vec<&str> = line.split("  ").next().unwrap().split(' ').collect();
        if words[0] == "list" || words[0] == "check" {
            assert!(corpuscle(folder.path(), &words).status.success(), "{line}");
        }
    }
    for arguments in [&["--help"][..], &["run", "--help"], &["help", "view"], &["--version"]] {
        let output = corpuscle(folder.path(), arguments);
        assert!(output.status.success() && output.stderr.is_empty() && !output.stdout.is_empty(), "{arguments:?}");
    }
}

/// Places the system itself refuses, for root as well.
#[cfg(target_os = "linux")]
#[test]
fn a_place_that_cannot_be_written() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [
        &["run", "wave", "--out", "/proc/corpuscle"][..],
        &["record", "wave", "--out", "/proc/clip.gif"],
        &["record", "wave", "--out", "/proc/pictures/"],
        &["view", "wave", "--screenshot", "/proc/wave.png"],
    ] {
        let output = corpuscle(folder.path(), arguments);
        let complaint = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {complaint}");
        assert_eq!(complaint.lines().count(), 1, "{complaint}");
        assert!(complaint.contains(arguments[3].trim_end_matches('/')), "{complaint}");
        assert!(!complaint.contains("partial") && !complaint.contains(".tmp"), "{complaint}");
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
    let gas = |rest: &str| file(&format!("[[species]]\ncount = 3\nradius = 0.5\n{rest}"));
    for (rest, parts) in [
        (
            "[[face]]\naxis = 'x'\nside = 'upper'\ntemperature = -2.0\n",
            ["scenario.toml:13:15", "face[0].temperature = -2", "a positive number"],
        ),
        ("[[face]]\naxis = 'x'\nside = 'left'\n", ["scenario.toml:12:8", "left", "one of lower, upper"]),
        (
            "[[face]]\naxis = 'x'\nside = 'upper'\ntemprature = 1.0\n",
            ["scenario.toml:13:1", "temprature", "did you mean `temperature`?"],
        ),
        (
            "[[face]]\naxis = 'x'\nside = 'upper'\npath = [[0.0, 99.0]]\n",
            ["scenario.toml:13:8", "face[0].path = between 99 and 99", "a motion within the box"],
        ),
        (
            "[[obstacle]]\ncentre = [99.0, 0.0]\nradius = 1.0\n",
            ["scenario.toml:11:10", "obstacle[0].centre = [99.0, 0.0]", "a place in the box"],
        ),
        ("[piston]\naxis = 'x'\nposition = 1.0\nmass = -1.0\n", ["scenario.toml:13:8", "piston.mass = -1", "a positive number"]),
        (
            "[collisions]\nwell = { range = 0.5, depth = 1.0 }\n",
            ["scenario.toml:11:18", "collisions.well.range = 0.5", "a number above 1"],
        ),
        (
            "[collisions.viscoelastic]\nstiffness = 1.0\n",
            ["scenario.toml:10:1", "collisions.viscoelastic.dissipation_time = (missing)", "this key is needed"],
        ),
        ("[growth]\nrate = 7.0\n", ["scenario.toml:11:8", "growth.rate = 7", "a number from 0.0001 to 1"]),
    ] {
        refused_file(&gas(rest), &parts);
    }
}

#[test]
fn an_output_that_is_taken() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("taken");
    fs::write(&file, "keep me").unwrap();
    fs::create_dir(folder.path().join("full")).unwrap();
    fs::write(folder.path().join("full/mine.txt"), "keep me").unwrap();
    for (out, part) in [("taken", "this is a file"), ("taken/sub", "this is a file"), ("full", "the folder is not empty")] {
        let output = corpuscle(folder.path(), &["run", "wave", "--out", out]);
        assert_eq!(output.status.code(), Some(2));
        assert!(String::from_utf8_lossy(&output.stderr).contains(part));
    }
    for arguments in [
        &["record", "wave", "--out", "full/mine.txt"][..],
        &["record", "wave", "--out", "full"],
        &["record", "wave", "--out", "full", "--force"],
        &["record", "wave", "--out", "taken"],
        &["record", "wave", "--out", "taken", "--force"],
        &["view", "wave", "--screenshot", "full"],
        &["view", "wave", "--screenshot", "taken"],
    ] {
        assert_eq!(corpuscle(folder.path(), arguments).status.code(), Some(2), "{arguments:?}");
    }
    assert_eq!(fs::read_to_string(&file).unwrap(), "keep me");
    assert_eq!(fs::read_dir(folder.path().join("full")).unwrap().count(), 1);
}
