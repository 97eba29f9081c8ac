//! How much memory a scenario needs, and whether there is as much: said before it starts, not by the system in the middle.

use std::fs;
use std::io;
use std::path::Path;

use corpuscle_core::Invalid;
use corpuscle_experiments::Value;
use corpuscle_io::scenario::Subject;
use corpuscle_io::{Origin, Refusal, Scenario};

/// Bytes a particle needs at most: state, plans, lists of neighbours, a snapshot and a checkpoint being written. Twice what was
/// measured: docs/reliability.md.
const PARTICLE: f64 = 1500.0;
/// Bytes of a cell of a map of fates at most: 44 were measured.
const CELL: f64 = 100.0;
/// What the program itself and the drawing of pictures need.
const PROGRAM: f64 = 100e6;
/// What a checkpoint takes in memory in units of its size: its bytes, the simulation put where they say, and one to spare.
const UNPACKED: f64 = 3.0;

/// Bytes a scenario needs, about.
pub(crate) fn needed(scenario: &Scenario) -> f64 {
    PROGRAM + PARTICLE * particles(scenario)
}

/// Particles in all systems of a scenario together.
fn particles(scenario: &Scenario) -> f64 {
    if let Subject::Free(system) = &scenario.subject {
        return system.species.iter().map(|group| group.count as f64).sum::<f64>()
            + (system.particles.len() + system.imported.as_ref().map_or(0, |start| start.particles.len())) as f64;
    }
    let value = |key: &str| scenario.parameters().find(|(parameter, ..)| parameter.name == key).map(|(_, value, _)| value);
    let is = |key: &str, wanted: &str| matches!(value(key), Some(Value::Word(word)) if word == wanted);
    let length = |key: &str| if let Some(Value::List(list)) = value(key) { list.len() as f64 } else { 0.0 };
    let whole = |key: &str| if let Some(Value::Whole(count)) = value(key) { Some(*count as f64) } else { None };
    let all = |keys: &[&str]| keys.iter().filter_map(|key| whole(key)).sum::<f64>();
    // Of an experiment with a sweep, each point is a system; of one without replicas, there is one.
    let points = whole("points").map_or(2.0, |points| 3.0 * points);
    let sweeps = [("mass", "masses"), ("radius", "radii")];
    let kinds = sweeps.iter().find(|(word, _)| is("sweep", word)).map_or(1.0, |(_, list)| length(list));
    let systems = whole("replicas").unwrap_or(1.0) * points * kinds;
    // A cell of a map is a grain of a few numbers.
    let cells = if is("show", "basins") { whole("resolution").map_or(0.0, |side| side * side * CELL / PARTICLE) } else { 0.0 };
    all(&["particles", "heavy_particles", "scatterers", "masses"]) * systems + all(&["crowd", "grains"]) + cells
}

/// Bytes there are for us, where the system tells: free memory, and no more than a container or a process (`ulimit -v`) may have.
pub(crate) fn available() -> Option<f64> {
    let free = fs::read_to_string("/proc/meminfo").ok()?;
    let line = free.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let free = 1024.0 * line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok()?;
    let limit = fs::read_to_string("/sys/fs/cgroup/memory.max").ok().and_then(|text| text.trim().parse::<f64>().ok());
    let of_process = fs::read_to_string("/proc/self/limits").ok().and_then(|text| address_space(&text));
    Some([limit, of_process].into_iter().flatten().fold(free, f64::min))
}

/// The soft limit of the address space in the words of `/proc/self/limits`; none when there is none.
fn address_space(limits: &str) -> Option<f64> {
    limits.lines().find_map(|line| line.strip_prefix("Max address space"))?.split_whitespace().next()?.parse().ok()
}

/// Refuses what asks for more memory than there is.
pub(crate) fn admit(scenario: &Scenario) -> Result<(), Refusal> {
    let needed = needed(scenario);
    match available() {
        Some(available) if needed > available => {
            let (value, expected) = (format!("about {}", bytes(needed)), format!("at most the {} there are", bytes(available)));
            Err(Refusal::new(Origin::default(), Invalid::new("memory", value, format!("{expected}: fewer particles"))))
        }
        _ => Ok(()),
    }
}

/// Refuses to read a file for which there is no room: what it holds takes several times its bytes.
pub(crate) fn admit_file(path: &Path) -> io::Result<()> {
    let needed = UNPACKED * fs::metadata(path)?.len() as f64;
    match available() {
        Some(available) if needed > available => {
            let (needed, available) = (bytes(needed), bytes(available));
            Err(io::Error::other(format!("it would take about {needed} of memory, and there are {available}")))
        }
        _ => Ok(()),
    }
}

/// `3.2 GB`.
pub(crate) fn bytes(count: f64) -> String {
    if count < 1e9 { format!("{:.0} MB", count / 1e6) } else { format!("{:.1} GB", count / 1e9) }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)] // a test that cannot go on has failed

    use super::*;

    /// Of these experiments only the particles of the first kind, or none, were once counted.
    #[test]
    fn all_that_an_experiment_puts_somewhere_is_counted() {
        let needed = |name: &str, values: &[(&str, &str)]| {
            let mut scenario = Scenario::new(corpuscle_experiments::find(name).unwrap());
            for (key, text) in values {
                scenario.set(key, text).unwrap();
            }
            needed(&scenario)
        };
        assert!(needed("atmosphere", &[("particles", "1"), ("heavy_particles", "20000"), ("replicas", "1000")]) > 20e9);
        assert!(needed("billiard", &[("particles", "2"), ("scatterers", "5000"), ("replicas", "10000")]) > 50e9);
        assert!(needed("granular", &[("particles", "10"), ("crowd", "200000"), ("replicas", "2")]) > 300e6);
        // 758 MB were measured.
        assert!((0.76e9..4e9).contains(&needed("three-body", &[("show", "basins"), ("resolution", "4000")])));
        assert_eq!(needed("three-body", &[("grains", "0"), ("resolution", "4000")]), PROGRAM);
        let sweep = [("replicas", "2"), ("particles", "100"), ("masses", "10,20,30")];
        let kinds = |sweeping: &str| needed("brownian", &[&sweep[..], &[("sweep", sweeping)]].concat()) - PROGRAM;
        assert_eq!(kinds("mass"), 3.0 * kinds("none"));
    }

    #[test]
    fn a_limit_of_the_process_is_read() {
        let limits =
            |soft: &str| format!("Limit  Soft Limit  Hard Limit  Units\nMax address space     {soft}     unlimited     bytes\n");
        assert_eq!(address_space(&limits("1536000000")), Some(1_536_000_000.0));
        assert_eq!(address_space(&limits("unlimited")), None);
    }
}
