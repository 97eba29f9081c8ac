//! Checkpoints: as they are, which the sum protects, and with the sum made good again, as a stranger would.

use std::path::Path;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use corpuscle_experiments::{REGISTRY, Simulation};
use corpuscle_io::checkpoint::{Policy, Run, bytes};
use corpuscle_io::{Checkpoint, Scenario};
use proptest::prelude::*;

use super::{cases, spoilt};

const SYSTEMS: [&str; 3] = [
    "engine = \"event\"\nduration = 2.0\n[box]\nlower = [0.0, 0.0]\nupper = [9.0, 9.0]\nfaces = \"walls\"\n[[face]]\naxis = \"y\"\n\
     side = \"lower\"\ntemperature = 1.0\n[piston]\naxis = \"x\"\nposition = 4.0\nmass = 3.0\n[[species]]\ncount = 9\nradius = 0.4\n",
    "engine = \"event\"\nduration = 2.0\n[box]\nlower = [0.0, 0.0, 0.0]\nupper = [5.0, 5.0, 5.0]\nfaces = \"periodic\"\n\
     [collisions]\nwell = { range = 1.5, depth = 1.0 }\n[[species]]\ncount = 40\nradius = 0.5\n",
    "engine = \"time\"\nduration = 2.0\n[integrator]\nname = \"velocity-verlet\"\ntime_step = 0.01\n[box]\nlower = [0.0, 0.0]\n\
     upper = [9.0, 9.0]\nfaces = \"periodic\"\n[forces.wca]\n[[species]]\ncount = 20\nradius = 0.5\n",
];
/// Magic line, format, length and sum.
const HEAD: usize = 21 + 8 + 8 + 32;

fn started(system: &str) -> (Scenario, Box<dyn Simulation>) {
    let scenario = Scenario::parse(REGISTRY, system, Path::new("system.toml")).unwrap();
    let simulation = scenario.start().unwrap();
    (scenario, simulation)
}

/// Good checkpoints, one of each system.
fn good() -> &'static [Vec<u8>] {
    static GOOD: OnceLock<Vec<Vec<u8>>> = OnceLock::new();
    GOOD.get_or_init(|| {
        let checkpoint = |system: &&str| {
            let (scenario, mut simulation) = started(system);
            simulation.advance(1.0).unwrap();
            let policy = Policy { wall: None, time: Some(1.0), work: None, keep: 2, stay: false, pictures: false };
            let run =
                Run { scenario: scenario.to_toml(), time: 1.0, wall: 0.5, moments: 1, pictures: vec![], policy, trajectory: None };
            bytes(&run, simulation.as_ref()).unwrap()
        };
        SYSTEMS.iter().map(checkpoint).collect()
    })
}

/// Reads and takes up; answers whether it could.
fn try_out(bytes: &[u8]) -> bool {
    let started_at = Instant::now();
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), bytes).unwrap();
    let taken = Checkpoint::read(file.path()).map_err(|error| error.to_string()).and_then(|checkpoint| {
        // What is too large to set up is refused by the command before it begins.
        let system = SYSTEMS.into_iter().find(|system| started(system).0.to_toml() == checkpoint.run.scenario);
        let Some(system) = system else { return Err("another scenario".into()) };
        checkpoint.load(started(system).1.as_mut()).map_err(|error| error.to_string())
    });
    assert!(started_at.elapsed() < Duration::from_secs(10));
    match taken {
        Ok(()) => true,
        Err(error) => {
            assert!(error.len() < 2000, "{error}");
            false
        }
    }
}

/// A body with the head that belongs to it.
fn sealed(head: &[u8], body: &[u8]) -> Vec<u8> {
    [&head[..29], &(body.len() as u64).to_le_bytes(), blake3::hash(body).as_bytes(), body].concat()
}

#[test]
fn good_ones_are_taken_up() {
    assert!(good().iter().all(|bytes| try_out(bytes)));
    assert!(good().iter().all(|bytes| try_out(&sealed(bytes, &bytes[HEAD..]))));
}

proptest! {
    // Each sets a system up.
    #![proptest_config(ProptestConfig { cases: cases().div_ceil(4), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn spoilt_ones_are_refused(bytes in spoilt(good().to_vec(), vec![vec![0]])) {
        prop_assert!(!try_out(&bytes) || good().contains(&bytes));
    }

    /// Lengths, types and numbers of any kind under a sum that is right.
    #[test]
    fn forged_ones_are_read_or_refused(
        bytes in spoilt(good().to_vec(), [0xc0, 0xcb, 0xdd, 0xdf, 0xff].into_iter().map(|byte| vec![byte; 5]).chain([vec![0xcb, 0x7f, 0xf8, 0, 0, 0, 0, 0, 0], vec![0xcb, 0x7f, 0xe0, 0, 0, 0, 0, 0, 0]]).collect()),
    ) {
        if bytes.len() > HEAD {
            try_out(&sealed(&good()[0], &bytes[HEAD..]));
        }
    }

    #[test]
    fn noise_is_refused(noise in prop::collection::vec(any::<u8>(), 0..300)) {
        prop_assert!(!try_out(&noise));
        prop_assert!(!try_out(&sealed(&good()[0], &noise)));
    }
}
