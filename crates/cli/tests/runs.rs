//! Whole runs through the real command: what they leave behind, that they can be repeated to the bit, and how they end.

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;

/// A free system small enough for a test, with collisions, random starts, and checks.
const GAS: &str = "engine = \"event\"\nduration = 20.0\nobserve = [\"temperature\", \"pressure\"]\n[box]\nlower = [0.0, 0.0]\n\
                   upper = [20.0, 20.0]\nfaces = \"walls\"\n[[species]]\ncount = 60\nradius = 0.3\n";

fn corpuscle(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_corpuscle")).args(arguments).current_dir(folder).output().expect("the command starts")
}

/// The summary without what depends on the clock.
fn summary(folder: &Path) -> Value {
    let bytes = fs::read(folder.join("summary.json")).expect("there is a summary");
    let mut summary: Value = serde_json::from_slice(&bytes).expect("the summary is JSON");
    let engine = summary["engine"].as_object_mut().expect("it has an engine");
    assert!(engine.remove("wall_s").is_some() && engine.remove("rate").is_some());
    summary
}

fn ran(output: &Output) -> bool {
    // 3: it ran, and a check failed; on short runs that is no concern of these tests.
    matches!(output.status.code(), Some(0 | 3))
}

#[test]
fn every_experiment_is_listed_and_its_defaults_are_valid() {
    let folder = tempfile::tempdir().unwrap();
    let output = corpuscle(folder.path(), &["list", "--json"]);
    let list: Vec<Value> = serde_json::from_slice(&output.stdout).unwrap();
    let names: Vec<&str> = list.iter().map(|experiment| experiment["name"].as_str().unwrap()).collect();
    let text = String::from_utf8(corpuscle(folder.path(), &["list"]).stdout).unwrap();
    for name in &names {
        assert!(text.contains(name));
        let output = corpuscle(folder.path(), &["check", name]);
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(String::from_utf8(output.stdout).unwrap().ends_with("Valid. Nothing was written.\n"));
    }
    for name in ["brownian", "entropy", "ideal-gas", "three-body", "wave"] {
        assert!(names.contains(&name), "{name} is not listed");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn check_tells_what_a_file_would_run() {
    let folder = tempfile::tempdir().unwrap();
    let text = "engine = \"event\"\nduration = 60.0\n[box]\nlower = [0.0, 0.0]\nupper = [40.0, 40.0]\nfaces = \"walls\"\n\
                [[species]]\ncount = 500\nradius = 0.5\n";
    fs::write(folder.path().join("discs.toml"), text).unwrap();
    let told = String::from_utf8(corpuscle(folder.path(), &["check", "discs.toml"]).stdout).unwrap();
    for line in [
        "engine      event-driven",
        "particles   500, which fill 0.245 of the box",
        "memory      about 101 MB",
        "time        about ",
    ] {
        assert!(told.contains(line), "{told}");
    }
}

#[test]
fn a_run_leaves_a_report_and_is_repeated_by_its_scenario() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("gas.toml"), GAS).unwrap();
    let output = corpuscle(folder.path(), &["run", "gas.toml", "--seed", "11", "--no-pictures"]);
    assert!(ran(&output), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8(output.stdout).unwrap().contains("seed 11"));
    let first = folder.path().join("results/free");
    let page = fs::read_to_string(first.join("report.html")).unwrap();
    assert!(page.starts_with("<!doctype html>") && page.trim_end().ends_with("</html>"));
    assert!(page.contains("<svg") && !page.contains("http://") && !page.contains("https://"));

    let again = corpuscle(folder.path(), &["run", "results/free/scenario.toml", "--no-pictures", "--quiet"]);
    assert!(ran(&again));
    assert_eq!(String::from_utf8(again.stdout).unwrap().lines().count(), 1);
    let second = folder.path().join("results/free-2");
    assert_eq!(summary(&first), summary(&second));
    let mut series = 0;
    for entry in fs::read_dir(&first).unwrap() {
        let name = entry.unwrap().file_name();
        if Path::new(&name).extension().is_some_and(|extension| extension == "csv" || extension == "toml") {
            assert_eq!(fs::read(first.join(&name)).unwrap(), fs::read(second.join(&name)).unwrap(), "{name:?}");
            series += 1;
        }
    }
    assert!(series > 1);
    assert!(corpuscle(folder.path(), &["run", "gas.toml", "--out", "results/free", "--no-pictures"]).status.code() == Some(2));
    assert!(ran(&corpuscle(folder.path(), &["run", "gas.toml", "--out", "results/free", "--force", "--no-pictures"])));
    assert_ne!(summary(&first), summary(&second), "another seed, another run");
}

#[test]
fn threads_do_not_change_a_bit() {
    let folder = tempfile::tempdir().unwrap();
    let run = |threads: &str, out: &str| {
        let arguments = [
            "run",
            "brownian",
            "--set",
            "replicas=4",
            "--duration",
            "8",
            "--set",
            "particles=100",
            "--threads",
            threads,
            "--out",
            out,
            "--no-pictures",
        ];
        let output = corpuscle(folder.path(), &arguments);
        assert!(ran(&output), "{}", String::from_utf8_lossy(&output.stderr));
        summary(&folder.path().join(out))
    };
    assert_eq!(run("1", "one"), run("2", "two"));
}

#[test]
fn a_reader_that_goes_away_is_no_fault() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("gas.toml"), GAS).unwrap();
    for arguments in [&["list"][..], &["check", "brownian"], &["run", "gas.toml", "--no-pictures", "--out", "out"]] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_corpuscle"))
            .args(arguments)
            .current_dir(folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert!(ran(&output), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(!String::from_utf8_lossy(&output.stderr).contains("panicked"));
    }
    assert!(folder.path().join("out/report.html").exists());
}

#[cfg(unix)]
#[test]
fn a_signal_ends_a_run_cleanly_with_its_report() {
    for signal in ["-INT", "-TERM"] {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("gas.toml"), GAS.replace("duration = 20.0", "duration = 1e7\nsample_interval = 1e3")).unwrap();
        let mut child = Command::new(env!("CARGO_BIN_EXE_corpuscle"))
            .args(["run", "gas.toml", "--no-pictures", "--out", "out"])
            .current_dir(folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let out = folder.path().join("out");
        // Its first line tells that it runs; a moment later it listens.
        let mut stdout = BufReader::new(child.stdout.take().unwrap());
        let mut text = String::new();
        stdout.read_line(&mut text).unwrap();
        std::thread::sleep(std::time::Duration::from_secs(1));
        assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
        stdout.read_to_string(&mut text).unwrap();
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{signal}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(String::from_utf8_lossy(&output.stderr).contains("stopping cleanly"));
        assert!(text.contains("interrupted at t ="), "{text}");
        let summary = summary(&out);
        assert_eq!(summary["ending"], "interrupted");
        assert!(fs::read_to_string(out.join("report.html")).unwrap().contains("This run was interrupted."));
    }
}
