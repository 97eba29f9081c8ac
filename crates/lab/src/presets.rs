//! Situations worth a look, by name: sets of parameters of the experiments.

use corpuscle_io::{Refusal, Scenario};

/// A named set of parameters; those it does not name are at their defaults.
pub struct Preset {
    /// Its name.
    pub name: &'static str,
    /// Parameters and their values, as one would write them on the command line.
    pub values: &'static [(&'static str, &'static str)],
}

const fn preset(name: &'static str, values: &'static [(&'static str, &'static str)]) -> Preset {
    Preset { name, values }
}

/// What each experiment offers, the defaults first. Where an experiment has a parameter `preset` of its own there is no more.
const PRESETS: &[(&str, &[Preset])] = &[
    (
        "brownian",
        &[
            preset("dilute bath", &[]),
            preset("barely heavier", &[("mass", "5")]),
            preset("very heavy", &[("mass", "200")]),
            preset("big in a crowd", &[("packing_fraction", "0.3"), ("radius", "5")]),
            preset("between walls", &[("boundary", "walls")]),
            preset("several masses", &[("sweep", "mass")]),
            preset("several radii", &[("sweep", "radius")]),
            preset("in space", &[("dimension", "3")]),
        ],
    ),
    (
        "entropy",
        &[
            preset("free expansion", &[]),
            preset("mixing of two", &[("process", "mixing")]),
            preset("leak through a hole", &[("hole_width", "3")]),
            preset("four particles", &[("particles", "4"), ("cells", "2")]),
            preset("no reversal", &[("reverse_at", "0")]),
            preset("effusion", &[("process", "effusion")]),
            preset("Loschmidt's echo", &[("process", "echo")]),
            preset("recurrence of few", &[("process", "recurrence")]),
            preset("from equal speeds", &[("process", "relaxation")]),
            preset("from two temperatures", &[("process", "relaxation"), ("start", "two-temperatures")]),
            preset("Maxwell's demon", &[("process", "demon")]),
            preset("demon of temperatures", &[("process", "demon"), ("rule", "fast")]),
        ],
    ),
    (
        "ideal-gas",
        &[
            preset("nearly ideal", &[]),
            preset("three times as dense", &[("packing_fraction", "0.03")]),
            preset("twice as hot", &[("temperature", "2")]),
            preset("heavy molecules", &[("mass", "20")]),
            preset("isotherms", &[("process", "isotherms")]),
            preset("pressure held", &[("process", "isobars")]),
            preset("adiabat", &[("process", "adiabat")]),
            preset("swinging piston", &[("process", "piston")]),
            preset("warm walls", &[("process", "warm-walls")]),
            preset("mixture", &[("process", "mixture")]),
            preset("in space", &[("dimension", "3")]),
        ],
    ),
    (
        "galton",
        &[
            preset("lively balls", &[]),
            preset("tired balls that roll", &[("restitution", "0.4")]),
            preset("nearly forgetful", &[("ball_radius", "0.11"), ("restitution", "0.68")]),
            preset("two thousand balls", &[("balls", "2000")]),
        ],
    ),
    (
        "diffusion",
        &[
            preset("a drop in the plane", &[]),
            preset("thin gas, long flights", &[("packing_fraction", "0.02")]),
            preset("nearly a liquid", &[("packing_fraction", "0.55")]),
            preset("in space", &[("dimension", "3")]),
        ],
    ),
    (
        "engines",
        &[
            preset("hard discs and nearly hard ones", &[]),
            preset("a hundred times as hard", &[("hardness", "1000000")]),
            preset("steps that are too long", &[("steps_per_contact", "2"), ("hardness", "1000")]),
            preset("a thin gas", &[("packing_fraction", "0.02")]),
        ],
    ),
    (
        "hard-disk-melting",
        &[
            preset("between liquid and crystal", &[]),
            preset("liquid", &[("packing_fraction", "0.66")]),
            preset("crystal", &[("packing_fraction", "0.74")]),
            preset("grains without order", &[("packing_fraction", "0.73"), ("begin", "disorder")]),
        ],
    ),
];

/// The presets of an experiment.
pub fn of(experiment: &str) -> &'static [Preset] {
    PRESETS.iter().find(|(name, _)| *name == experiment).map_or(&[], |(_, presets)| presets)
}

impl Preset {
    /// A scenario with these values, and the seed of another.
    ///
    /// # Errors
    /// [`Refusal`] when the experiment does not take a value.
    pub fn scenario(&self, like: &Scenario) -> Result<Scenario, Refusal> {
        let corpuscle_io::scenario::Subject::Experiment(experiment) = like.subject else { return Ok(like.clone()) };
        let mut scenario = Scenario::new(experiment);
        scenario.settings.seed = like.settings.seed;
        for (key, value) in self.values {
            scenario.set(key, value)?;
        }
        Ok(scenario)
    }

    /// Whether a scenario has these values and no others.
    pub fn is_set(&self, scenario: &Scenario) -> bool {
        let given = scenario.parameters().filter(|(_, _, given)| *given);
        let mut count = 0;
        let all = given.map(|(parameter, value, _)| (parameter.name, value.to_string())).all(|(name, value)| {
            count += 1;
            self.values.iter().any(|(key, wanted)| *key == name && *wanted == value)
        });
        all && count == self.values.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_experiments::find;

    #[test]
    fn every_preset_starts_and_is_known_again() {
        for (name, presets) in PRESETS {
            let blank = Scenario::new(find(name).unwrap());
            for preset in *presets {
                let mut scenario = preset.scenario(&blank).unwrap();
                assert!(preset.is_set(&scenario), "{name}: {}", preset.name);
                assert_eq!(presets.iter().filter(|other| other.is_set(&scenario)).count(), 1);
                scenario.set("replicas", "3").unwrap();
                scenario.start().unwrap();
                assert!(!preset.is_set(&scenario));
            }
        }
    }
}
