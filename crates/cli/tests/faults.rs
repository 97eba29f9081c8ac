//! What a run meets while it writes: spoilt checkpoints, a full disk, a disk that becomes read-only, a folder that vanishes,
//! signals. Each ends in one clear message and the right exit code, and loses nothing that had been kept.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::case_sensitive_file_extension_comparisons)] // in helpers too: a test that cannot go on has failed; names are our own

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use corpuscle_io::Checkpoints;
use serde_json::Value;

/// About two seconds of discs.
const GAS: &str = "engine = \"event\"\nduration = 3000.0\nobserve = [\"temperature\", \"pressure\"]\n[box]\nlower = [0.0, 0.0]\n\
                   upper = [40.0, 40.0]\nfaces = \"walls\"\n[[species]]\ncount = 500\nradius = 0.5\n";

fn corpuscle(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_corpuscle"));
    command.args(arguments).current_dir(folder).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// A folder with the scenario, and in `whole` what a run leaves that nothing disturbs.
fn prepared() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("gas.toml"), GAS).unwrap();
    let output = corpuscle(folder.path(), &["run", "gas.toml", "--out", "whole", "--no-pictures", "--quiet"]).output().unwrap();
    assert!(ran(&output), "{}", complaint(&output));
    assert!(!folder.path().join("whole/checkpoints").exists(), "a run that has finished needs no checkpoints");
    folder
}

fn start(folder: &Path, out: &str) -> Child {
    let often = ["--checkpoint-wall", "0.1", "--checkpoints", "2"];
    let child = corpuscle(folder, &[&["run", "gas.toml", "--out", out, "--no-pictures", "--quiet"][..], &often].concat()).spawn();
    let child = child.unwrap();
    wait_for(|| !Checkpoints::of(&folder.join(out)).files().is_empty());
    child
}

fn wait_for(there: impl Fn() -> bool) {
    let start = Instant::now();
    while !there() {
        assert!(start.elapsed() < Duration::from_mins(1), "it does not come");
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn ran(output: &Output) -> bool {
    matches!(output.status.code(), Some(0 | 3))
}

fn complaint(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Series, and the summary without the clock.
fn left_behind(folder: &Path) -> BTreeMap<String, String> {
    let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let kept = names.filter(|name| name.ends_with(".csv") || name == "summary.json");
    let text = |name: &str| {
        let text = fs::read_to_string(folder.join(name)).unwrap();
        if name != "summary.json" {
            return text;
        }
        let mut summary: Value = serde_json::from_str(&text).unwrap();
        let engine = summary["engine"].as_object_mut().unwrap();
        assert!(engine.remove("wall_s").is_some() && engine.remove("rate").is_some());
        summary.to_string()
    };
    kept.map(|name| (name.clone(), text(&name))).collect()
}

/// Resumes to the end, and compares with what nothing disturbed.
fn goes_on(folder: &Path, out: &str) -> Output {
    let output = corpuscle(folder, &["resume", out, "--quiet"]).output().unwrap();
    assert!(ran(&output), "{}", complaint(&output));
    assert_eq!(left_behind(&folder.join("whole")), left_behind(&folder.join(out)));
    output
}

fn spoil(file: &Path, change: impl FnOnce(&mut Vec<u8>)) {
    let mut bytes = fs::read(file).unwrap();
    change(&mut bytes);
    fs::write(file, bytes).unwrap();
}

#[test]
fn a_spoilt_checkpoint_is_named_and_the_one_before_is_used() {
    let folder = prepared();
    let often = ["--checkpoint-time", "500", "--checkpoints", "3", "--no-pictures", "--quiet"];
    let output = corpuscle(folder.path(), &[&["run", "gas.toml", "--out", "out"][..], &often].concat()).output().unwrap();
    assert!(ran(&output));
    let files = Checkpoints::of(&folder.path().join("out")).files();
    assert_eq!(files.len(), 3);
    spoil(&files[0], |bytes| bytes[2000] ^= 4);
    let said = complaint(&goes_on(folder.path(), "out"));
    assert!(said.contains("000006.checkpoint is damaged: its checksum is another"), "{said}");

    let files = Checkpoints::of(&folder.path().join("out")).files();
    spoil(&files[0], |bytes| bytes.truncate(5000));
    spoil(&files[1], |bytes| bytes[21] = 9);
    let said = complaint(&goes_on(folder.path(), "out"));
    assert!(said.contains("is cut off: 5000 of") && said.contains("has the format 9; "), "{said}");

    for file in Checkpoints::of(&folder.path().join("out")).files() {
        spoil(&file, Vec::clear);
    }
    let output = corpuscle(folder.path(), &["resume", "out"]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(complaint(&output).contains("to begin again: corpuscle run out/scenario.toml"), "{}", complaint(&output));
}

/// An earlier run's checkpoints are not taken for those of one that is written over it.
#[test]
fn force_leaves_nothing_of_another_run() {
    let folder = prepared();
    let mut child = start(folder.path(), "out");
    child.kill().unwrap();
    child.wait().unwrap();
    let again = ["run", "gas.toml", "--out", "out", "--force", "--seed", "2", "--no-pictures", "--quiet"];
    assert_eq!(corpuscle(folder.path(), &again[..4]).output().unwrap().status.code(), Some(2), "not without --force");
    let mut child = corpuscle(folder.path(), &again).spawn().unwrap();
    wait_for(|| fs::read_to_string(folder.path().join("out/scenario.toml")).is_ok_and(|text| text.contains("seed = 2")));
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(Checkpoints::of(&folder.path().join("out")).files().is_empty());
}

#[test]
fn a_folder_that_vanishes_ends_the_run() {
    let folder = prepared();
    let child = start(folder.path(), "out");
    fs::rename(folder.path().join("out"), folder.path().join("elsewhere")).unwrap();
    let output = child.wait_with_output().unwrap();
    let said = complaint(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("cannot write out") && said.lines().count() == 1 && said.contains("the checkpoint of t ="), "{said}");
    assert!(!folder.path().join("out").exists());
    goes_on(folder.path(), "elsewhere");
}

/// Two processes in one folder: the second is told who is there, and changes nothing. A lock of the dead holds nobody.
#[test]
fn a_folder_in_use_is_refused() {
    let folder = prepared();
    let mut child = start(folder.path(), "out");
    let again = ["run", "gas.toml", "--out", "out", "--force", "--no-pictures", "--quiet"];
    for arguments in [&["resume", "out", "--quiet"][..], &again] {
        let output = corpuscle(folder.path(), arguments).output().unwrap();
        let said = complaint(&output);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(&format!("out: in use by process {}:", child.id())) && said.lines().count() == 1, "{said}");
    }
    assert!(child.try_wait().unwrap().is_none(), "and it goes on");
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(folder.path().join("out/.corpuscle-lock").exists());
    goes_on(folder.path(), "out");
    assert!(!folder.path().join("out/.corpuscle-lock").exists());
}

#[test]
fn standard_output_that_is_full_is_said() {
    let folder = prepared();
    let mut command = corpuscle(folder.path(), &["run", "gas.toml", "--out", "out", "--no-pictures"]);
    let output = command.stdout(fs::File::create("/dev/full").unwrap()).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(complaint(&output).starts_with("corpuscle: standard output: No space left"), "{}", complaint(&output));
}

fn signal(child: &Child, name: &str) {
    assert!(Command::new("kill").args([name, &child.id().to_string()]).status().unwrap().success());
}

#[test]
fn the_first_signal_leaves_a_checkpoint_and_a_report_and_the_run_goes_on() {
    let folder = prepared();
    for name in ["INT", "TERM"] {
        let child = start(folder.path(), name);
        signal(&child, &format!("-{name}"));
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(1));
        assert!(complaint(&output).contains(&format!("to go on: corpuscle resume {name}")), "{}", complaint(&output));
        let out = folder.path().join(name);
        assert!(fs::read_to_string(out.join("report.html")).unwrap().contains("This run was interrupted."));
        fs::rename(&out, folder.path().join("out")).unwrap();
        goes_on(folder.path(), "out");
        fs::remove_dir_all(folder.path().join("out")).unwrap();
    }
}

/// A system so large that one slice of it takes longer than the patience of a second signal.
#[test]
fn the_second_signal_ends_at_once() {
    let folder = prepared();
    let child = start(folder.path(), "out");
    signal(&child, "-INT");
    signal(&child, "-INT");
    let sent = Instant::now();
    let output = child.wait_with_output().unwrap();
    assert!(sent.elapsed() < Duration::from_secs(5));
    assert_eq!(output.status.code(), Some(1), "{}", complaint(&output));
    goes_on(folder.path(), "out");
}

/// A small disk of one's own, in a name space of one's own; none where the system does not allow that.
struct Disk {
    holder: Child,
    path: PathBuf,
}

impl Disk {
    fn mount(path: &Path) -> Option<Self> {
        fs::create_dir(path).unwrap();
        let script = format!("mount -t tmpfs -o size=4m tmpfs '{}' && echo mounted && exec sleep 600", path.display());
        let mut command = Command::new("unshare");
        command.args(["--user", "--map-root-user", "--mount", "sh", "-c", &script]).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut holder = command.spawn().ok()?;
        let mut line = String::new();
        std::io::BufRead::read_line(&mut std::io::BufReader::new(holder.stdout.take()?), &mut line).ok()?;
        if line.trim() == "mounted" {
            return Some(Self { holder, path: path.into() });
        }
        let _ = holder.wait();
        println!("not tried: this system gives no disk of one's own");
        None
    }

    /// Runs a script on it, as `$corpuscle`'s neighbour.
    fn script(&self, script: &str) -> Output {
        let process = self.holder.id().to_string();
        let arguments = ["--target", &process, "--user", "--mount", "--preserve-credentials", "sh", "-c", script];
        let mut command = Command::new("nsenter");
        command.args(arguments).env("corpuscle", env!("CARGO_BIN_EXE_corpuscle")).env("disk", &self.path);
        command.output().unwrap()
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        let _ = self.holder.kill();
        let _ = self.holder.wait();
    }
}

/// The disk is full, or read-only, after the first checkpoint: the run ends and says so, what had been kept is intact, and when
/// there is room again it goes on to the same end.
#[test]
fn a_disk_that_is_full_or_read_only() {
    let folder = prepared();
    let Some(disk) = Disk::mount(&folder.path().join("disk")) else { return };
    let gas = folder.path().join("gas.toml");
    for (spoil, mend, cause) in [
        ("head -c 9000000 /dev/zero > $disk/filling 2>/dev/null", "rm $disk/filling", "No space left on device"),
        ("mount -o remount,ro $disk", "mount -o remount,rw $disk", "Read-only file system"),
    ] {
        let script = format!(
            "cd $disk; $corpuscle run {} --out out --no-pictures --quiet --checkpoint-wall 0.1 2> /dev/shm/said.$$ & \
             run=$!; until ls out/checkpoints/*.checkpoint > /dev/null 2>&1; do sleep 0.01; done; \
             kill -STOP $run; {spoil}; kill -CONT $run; wait $run; echo code $?; \
             cat /dev/shm/said.$$; rm /dev/shm/said.$$; {mend}; $corpuscle resume out --quiet; echo resumed $?; cat out/*.csv | cksum; \
             rm -r out",
            gas.display()
        );
        let output = disk.script(&script);
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(said.contains("code 1\n") && said.contains(cause) && said.contains("the checkpoint of t ="), "{said}");
        assert!(said.contains("resumed 0") || said.contains("resumed 3"), "{said} {}", complaint(&output));
        let whole = Command::new("sh").args(["-c", "cat whole/*.csv | cksum"]).current_dir(folder.path()).output().unwrap();
        assert!(said.contains(String::from_utf8_lossy(&whole.stdout).trim()), "{said}");
    }
}
