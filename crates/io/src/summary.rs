//! `summary.json`: the run in numbers, for programs. Everything that depends on the clock stands in `engine.wall_s` and
//! `engine.rate`; without those two, equal runs have equal summaries.

use corpuscle_experiments::{Honesty, Value};
use corpuscle_observe::Check;
use serde::ser::{Serialize, SerializeMap, Serializer};

use crate::scenario::Subject;
use crate::{Record, Scenario, VERSION};

/// The summary as JSON. Values that are not finite become `null`.
pub fn json(record: &Record) -> String {
    let honesty = &record.honesty;
    let summary = Summary {
        experiment: record.scenario.name(),
        version: VERSION,
        seed: record.scenario.settings.seed,
        parameters: Parameters(record.scenario),
        ending: record.ending.word(),
        failure: if let crate::Ending::Failed(failure) = &record.ending { Some(failure.to_string()) } else { None },
        time: record.time,
        end: record.end,
        engine: Engine {
            name: &honesty.engine,
            work: Work { unit: honesty.work_unit, amount: honesty.work },
            wall_s: record.wall.as_secs_f64(),
            rate: record.rate(),
            energy_drift: honesty.energy_drift,
        },
        honesty: Quality::of(honesty),
        passed: record.checks.iter().all(|check| check.passed),
        checks: &record.checks,
    };
    // Strings, numbers and maps with text keys: nothing serde_json could refuse.
    serde_json::to_string_pretty(&summary).unwrap_or_default() + "\n"
}

#[derive(serde::Serialize)]
struct Summary<'a> {
    experiment: &'a str,
    version: &'a str,
    seed: u64,
    parameters: Parameters<'a>,
    ending: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    failure: Option<String>,
    time: f64,
    end: f64,
    engine: Engine<'a>,
    honesty: Quality,
    passed: bool,
    checks: &'a [Check],
}

#[derive(serde::Serialize)]
struct Engine<'a> {
    name: &'a str,
    #[serde(flatten)]
    work: Work<'a>,
    wall_s: f64,
    rate: Option<f64>,
    energy_drift: Option<f64>,
}

/// `"collisions": 1200` or `"steps": 1200`.
struct Work<'a> {
    unit: &'a str,
    amount: u64,
}

impl Serialize for Work<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(1))?;
        map.serialize_entry(if self.unit.is_empty() { "work" } else { self.unit }, &self.amount)?;
        map.end()
    }
}

/// What `engine` does not already say.
#[derive(serde::Serialize)]
struct Quality {
    momentum_drift: Option<f64>,
    angular_momentum_drift: Option<f64>,
    largest_overlap: Option<f64>,
    stability_number: Option<f64>,
    rejected_events: Option<u64>,
    precision_horizon: Option<f64>,
}

impl Quality {
    fn of(honesty: &Honesty) -> Self {
        Self {
            momentum_drift: honesty.momentum_drift,
            angular_momentum_drift: honesty.angular_momentum_drift,
            largest_overlap: honesty.largest_overlap,
            stability_number: honesty.stability_number,
            rejected_events: honesty.rejected_events,
            precision_horizon: honesty.precision_horizon,
        }
    }
}

/// All parameters in the order of their declaration, those at their defaults included; the description of a free system.
struct Parameters<'a>(&'a Scenario);

impl Serialize for Parameters<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if let Subject::Free(system) = &self.0.subject {
            return system.serialize(serializer);
        }
        let mut map = serializer.serialize_map(None)?;
        for (parameter, value, _) in self.0.parameters() {
            match value {
                Value::Real(x) => map.serialize_entry(parameter.name, x)?,
                Value::Whole(n) => map.serialize_entry(parameter.name, n)?,
                Value::Word(word) => map.serialize_entry(parameter.name, word)?,
                Value::Flag(flag) => map.serialize_entry(parameter.name, flag)?,
                Value::List(list) => map.serialize_entry(parameter.name, list)?,
            }
        }
        map.end()
    }
}
