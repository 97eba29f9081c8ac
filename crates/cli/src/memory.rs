//! How much memory a scenario needs, and whether there is as much: said before it starts, not by the system in the middle.

use std::fs;

use corpuscle_core::Invalid;
use corpuscle_experiments::Value;
use corpuscle_io::scenario::Subject;
use corpuscle_io::{Origin, Refusal, Scenario};

/// Bytes a particle needs at most: state, plans, lists of neighbours, a snapshot and a checkpoint being written. Twice what was
/// measured: docs/reliability.md.
const PARTICLE: f64 = 1500.0;
/// What the program itself and the drawing of pictures need.
const PROGRAM: f64 = 100e6;

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
    let whole = |key: &str| {
        let mut values = scenario.parameters().filter(|(parameter, ..)| parameter.name == key);
        values.next().and_then(|(_, value, _)| if let Value::Whole(count) = value { Some(*count as f64) } else { None })
    };
    // Of an experiment with a sweep, each point is a system; of one without replicas, there is one.
    let systems = whole("replicas").unwrap_or(1.0) * whole("points").map_or(2.0, |points| 3.0 * points);
    whole("particles").or(whole("masses")).unwrap_or(0.0) * systems
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

/// `3.2 GB`.
pub(crate) fn bytes(count: f64) -> String {
    if count < 1e9 { format!("{:.0} MB", count / 1e6) } else { format!("{:.1} GB", count / 1e9) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_of_the_process_is_read() {
        let limits =
            |soft: &str| format!("Limit  Soft Limit  Hard Limit  Units\nMax address space     {soft}     unlimited     bytes\n");
        assert_eq!(address_space(&limits("1536000000")), Some(1_536_000_000.0));
        assert_eq!(address_space(&limits("unlimited")), None);
    }
}
