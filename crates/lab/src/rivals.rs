//! Other ways to compute what runs: another integrator, or for hard spheres the other engine with a steep potential.

use corpuscle_experiments::Kind;
use corpuscle_experiments::free::spec::{Contact, EngineKind, Forces, Stepper, System};
use corpuscle_io::Scenario;
use corpuscle_io::scenario::Subject;

/// The same system in other hands.
pub struct Rival {
    /// What computes it: a word that [`crate::language::Language::choice`] translates.
    pub name: String,
    /// The same scenario but for that.
    pub scenario: Scenario,
}

/// Integrators offered beside that of a system of a scenario file.
const INTEGRATORS: [&str; 5] = ["velocity-verlet", "yoshida-4", "runge-kutta-4", "symplectic-euler", "gauss-radau-15"];
/// Steepness of the potential that stands for a hard core, over the temperature: two that meet head-on come nearer than the
/// diameter by `sqrt(2 kT / (57 epsilon))`, half a hundredth of it.
const STEEPNESS: f64 = 1000.0;
/// Curvature of the repulsive potential at its cutoff, in `epsilon / sigma^2`: `36 x 2^(2/3)`.
const CURVATURE: f64 = 57.146_436_466_941_4;
/// Step over the inverse frequency of a contact.
const FINENESS: f64 = 0.1;

/// Every other way there is.
pub fn of(scenario: &Scenario) -> Vec<Rival> {
    match &scenario.subject {
        Subject::Experiment(_) => of_experiment(scenario),
        Subject::Free(system) => match system.engine {
            EngineKind::Time => of_soft(scenario, system),
            EngineKind::Event => of_hard(scenario, system).into_iter().collect(),
        },
    }
}

fn of_experiment(scenario: &Scenario) -> Vec<Rival> {
    let Ok(parameter) = scenario.settings.declaration("integrator") else { return vec![] };
    let Kind::Choice { options, .. } = parameter.kind else { return vec![] };
    let own = scenario.settings.word("integrator");
    let other = |name: &&&str| {
        let mut other = scenario.clone();
        other.set("integrator", name).ok()?;
        Some(Rival { name: (**name).to_owned(), scenario: other })
    };
    options.iter().filter(|name| **name != own).filter_map(|name| other(&name)).collect()
}

fn of_soft(scenario: &Scenario, system: &System) -> Vec<Rival> {
    // In a heat bath none gives the same path, nor should it.
    let Some(stepper) = system.integrator.as_ref().filter(|stepper| stepper.temperature.is_none()) else { return vec![] };
    let with = |name: &str| {
        let time_step = if name == "gauss-radau-15" { None } else { Some(stepper.time_step?) };
        let integrator = Some(Stepper { name: name.to_owned(), time_step, ..Stepper::default() });
        Some(rival(scenario, name, System { integrator, ..system.clone() }))
    };
    INTEGRATORS.into_iter().filter(|name| *name != stepper.name).filter_map(with).collect()
}

/// Plain hard spheres of one size, as soft ones that are nearly hard: `epsilon (...)` cut off at the diameter.
fn of_hard(scenario: &Scenario, system: &System) -> Option<Rival> {
    let plain = system.collisions.is_none()
        && system.partitions.is_empty()
        && system.walls.is_empty()
        && system.obstacles.is_empty()
        && system.piston.is_none()
        && system.growth.is_none();
    let radii = || system.species.iter().map(|kind| kind.radius).chain(system.particles.iter().map(|one| one.radius));
    let radius = radii().next().filter(|&radius| radius > 0.0 && radii().all(|other| other == radius))?;
    if !plain {
        return None;
    }
    let of_singles = system.particles.iter().map(|one| one.mass * one.velocity.iter().map(|v| v * v).sum::<f64>());
    let temperature = system.species.iter().map(|kind| kind.temperature).chain(of_singles).fold(0.0, f64::max);
    let mass = system.species.iter().map(|kind| kind.mass).chain(system.particles.iter().map(|one| one.mass));
    let mass = mass.fold(f64::INFINITY, f64::min);
    let epsilon = STEEPNESS * if temperature > 0.0 { temperature } else { 1.0 };
    let sigma = 2.0 * radius / 2f64.powf(1.0 / 6.0);
    // Two of them swing about each other with the frequency sqrt(2 k / m).
    let frequency = (2.0 * CURVATURE * epsilon / mass).sqrt() / sigma;
    let forces = Forces { wca: Some(Contact { epsilon, sigma, ..Contact::default() }), ..Forces::default() };
    let integrator = Stepper { name: "velocity-verlet".into(), time_step: Some(FINENESS / frequency), ..Stepper::default() };
    let soft = System { engine: EngineKind::Time, forces: Some(forces), integrator: Some(integrator), ..system.clone() };
    Some(rival(scenario, "steep-potential", soft))
}

fn rival(scenario: &Scenario, name: &str, system: System) -> Rival {
    let mut other = scenario.clone();
    other.subject = Subject::Free(Box::new(system));
    Rival { name: name.to_owned(), scenario: other }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_experiments::{REGISTRY, find};
    use std::path::Path;

    #[test]
    fn every_rival_starts_with_the_same_bodies() {
        let gas = "engine = 'event'\nduration = 5.0\n[box]\nlower = [0.0, 0.0]\nupper = [12.0, 9.0]\nfaces = 'periodic'\n\
                   [[species]]\ncount = 20\nradius = 0.3\n";
        let read = |text: &str| Scenario::parse(REGISTRY, text, Path::new("gas.toml")).unwrap();
        let soft = gas.replace("'event'", "'time'") + "[forces.wca]\n[integrator]\nname = 'velocity-verlet'\ntime_step = 0.001\n";
        let own = [Scenario::new(find("three-body").unwrap()), read(gas), read(&soft)];
        for scenario in own {
            let rivals = of(&scenario);
            assert!(!rivals.is_empty(), "{}", scenario.title());
            let bodies = |scenario: &Scenario| {
                let mut scene = corpuscle_scene::Scene::default();
                scenario.start().unwrap().draw(&mut scene);
                scene.bodies.iter().map(|body| (body.position, body.velocity)).collect::<Vec<_>>()
            };
            for rival in rivals {
                assert_eq!(bodies(&rival.scenario), bodies(&scenario), "{}", rival.name);
            }
        }
    }

    #[test]
    fn what_the_other_engine_cannot_do_has_no_rival() {
        let pegs = "engine = 'event'\nduration = 5.0\n[box]\nlower = [0.0, 0.0]\nupper = [12.0, 9.0]\nfaces = 'walls'\n\
                    [[species]]\ncount = 20\nradius = 0.3\n[[obstacle]]\ncentre = [6.0, 4.0]\nradius = 0.5\n";
        let scenario = Scenario::parse(REGISTRY, pegs, Path::new("pegs.toml")).unwrap();
        assert!(of(&scenario).is_empty());
        assert!(of(&Scenario::new(find("brownian").unwrap())).is_empty());
    }
}
