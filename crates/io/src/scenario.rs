//! A scenario: everything a run depends on, in a file a person can read and change.
//!
//! ```toml
//! experiment = "brownian"
//! seed = 7            # optional
//! duration = 40.0     # optional: the experiment knows how long it needs
//!
//! [parameters]
//! temperature = 2.0
//! ```
//!
//! A file without the key `experiment` describes a system of its own (box, particles, forces, engine), as
//! [`corpuscle_experiments::free`] declares it; `seed` is a key of both.
//!
//! Every key is known, typed and ranged; what is not is refused with its line and column, and a near miss is named.

mod reader;
mod source;
mod start;

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use corpuscle_core::Invalid;
use corpuscle_experiments::{Action, Deed, Experiment, Parameter, Settings, Simulation, Value, free, with_deeds};
use reader::{Reader, value_of};
use serde::Serialize;
use toml::de::DeTable;

use crate::VERSION;
use crate::refusal::{Origin, Place, Refusal, one_of};
use crate::trajectory::START;

/// The experiments a scenario can name.
pub type Registry<'a> = &'a [&'static Experiment];

/// Seed of a run that asks for none: fixed, so that the same command gives the same result.
pub const DEFAULT_SEED: u64 = 1;

/// The word for standard input, and how messages call it.
const STANDARD_INPUT: (&str, &str) = ("-", "standard input");

/// The keys at the top of a file.
const KEYS: [&str; 5] = ["experiment", "seed", "duration", "parameters", "deed"];

/// What a scenario runs.
#[derive(Clone)]
pub enum Subject {
    /// One of the registered experiments.
    Experiment(&'static Experiment),
    /// A system described by the file itself.
    Free(Box<free::System>),
}

/// What to run: an experiment, its parameters, the seed and for how long.
#[derive(Clone)]
pub struct Scenario {
    /// What to run.
    pub subject: Subject,
    /// Its parameters, of which a free system has none, and the seed.
    pub settings: Settings,
    /// Physical time to stop at, where it differs from what the experiment needs and is not one of its parameters.
    pub duration: Option<f64>,
    /// What is done to the system on the way, in the order of time.
    pub deeds: Vec<Deed>,
    file: Origin,
    origins: BTreeMap<String, Origin>,
}

impl Scenario {
    /// An experiment with its defaults.
    pub fn new(experiment: &'static Experiment) -> Self {
        Self::of(Subject::Experiment(experiment), Settings::new(experiment.parameters, DEFAULT_SEED))
    }

    fn of(subject: Subject, settings: Settings) -> Self {
        Self { subject, settings, duration: None, deeds: vec![], file: Origin::default(), origins: BTreeMap::new() }
    }

    /// Name of the experiment; `free` for a system of the file's own.
    pub fn name(&self) -> &str {
        match &self.subject {
            Subject::Experiment(experiment) => experiment.name,
            Subject::Free(_) => "free",
        }
    }

    /// Its title.
    pub fn title(&self) -> &str {
        match &self.subject {
            Subject::Experiment(experiment) => experiment.title,
            Subject::Free(system) => &system.title,
        }
    }

    /// What it shows.
    pub fn summary(&self) -> &str {
        match &self.subject {
            Subject::Experiment(experiment) => experiment.summary,
            Subject::Free(_) => "A system described by its own scenario file, measured beside the theory that applies.",
        }
    }

    /// What a word on the command line means: the name of an experiment, `-` for standard input, or else a scenario file.
    ///
    /// # Errors
    /// [`Refusal`] when it is neither, or the file cannot be used.
    pub fn find(registry: Registry, word: &str) -> Result<Self, Refusal> {
        if let Some(experiment) = registry.iter().find(|experiment| experiment.name == word) {
            return Ok(Self::new(experiment));
        }
        if word == STANDARD_INPUT.0 {
            let path = Path::new(STANDARD_INPUT.1);
            let text = source::read_standard_input();
            let text = text.map_err(|invalid| Refusal::new(Origin::File(path.into(), None), invalid))?;
            return Self::parse(registry, &text, path);
        }
        let path = Path::new(word);
        let looks_like_a_file = word.contains(['/', '\\']) || path.extension().is_some() || path.exists();
        if looks_like_a_file {
            return Self::read(registry, path);
        }
        let expected = format!("a scenario file or {}", one_of(word, registry.iter().map(|experiment| experiment.name)));
        Err(Refusal::new(Origin::CommandLine, Invalid::new("experiment", word, expected)))
    }

    /// Reads a scenario file, or a pipe that somebody writes into.
    ///
    /// # Errors
    /// [`Refusal`] when it cannot be read, takes too long, or holds what cannot be used.
    pub fn read(registry: Registry, path: &Path) -> Result<Self, Refusal> {
        let text = source::read(path).map_err(|invalid| Refusal::new(Origin::File(path.into(), None), invalid))?;
        Self::parse(registry, &text, path)
    }

    /// Reads a scenario from the text of the file `path`.
    ///
    /// # Errors
    /// [`Refusal`] when the text holds what cannot be used.
    pub fn parse(registry: Registry, text: &str, path: &Path) -> Result<Self, Refusal> {
        let reader = Reader { text, path };
        let mut document = DeTable::parse(text).map_err(|error| {
            let place = error.span().map(|span| Place::of(text, span.start));
            let found = error.span().map_or_else(String::new, |span| reader.line(span.start));
            let invalid = Invalid::new("text", found, format!("TOML: {}", error.message().replace('\n', "; ")));
            Refusal::new(Origin::File(path.into(), place), invalid)
        })?;
        let mut origins = BTreeMap::new();
        let deeds = match document.get_mut().remove("deed") {
            Some(deeds) => reader.deeds(deeds, &mut origins)?,
            None => vec![],
        };
        let keys = document.get_ref();
        if !keys.contains_key("experiment") && (keys.contains_key("engine") || keys.contains_key("box")) {
            let mut scenario = reader.free_system(document)?;
            (scenario.deeds, scenario.origins) = (deeds, scenario.origins.into_iter().chain(origins).collect());
            return Ok(scenario);
        }
        let document = document.get_ref();
        let name = document.get("experiment").ok_or_else(|| {
            let expected = one_of("", registry.iter().map(|experiment| experiment.name));
            let expected = format!("{expected}; or engine, box, particles and so on of a system of your own");
            Refusal::new(Origin::File(path.into(), None), Invalid::new("experiment", "(missing)", expected))
        })?;
        let experiment = name.get_ref().as_str().and_then(|name| registry.iter().find(|known| known.name == name));
        let experiment = experiment.ok_or_else(|| {
            let word = name.get_ref().as_str().unwrap_or_default();
            reader.refuse("experiment", name, one_of(word, registry.iter().map(|known| known.name)))
        })?;
        let mut scenario = Self { file: Origin::File(path.into(), None), deeds, origins, ..Self::new(experiment) };
        for (key, value) in document {
            match key.get_ref().as_ref() {
                "experiment" => {}
                "seed" => scenario.settings.seed = reader.seed(value)?,
                "duration" => {
                    let duration = match value_of(value.get_ref()) {
                        Some(Value::Real(duration)) => duration,
                        Some(Value::Whole(duration)) => duration as f64,
                        _ => return Err(reader.refuse("duration", value, DURATION)),
                    };
                    let last = scenario.last(duration);
                    last.map_err(|invalid| reader.refuse("duration", value, invalid.expected))?;
                    scenario.origins.insert("duration".into(), reader.origin(value));
                }
                "parameters" => {
                    let table = value.get_ref().as_table();
                    let table = table.ok_or_else(|| reader.refuse("parameters", value, "a table, [parameters]"))?;
                    scenario.read_parameters(&reader, table, experiment)?;
                }
                other => return Err(reader.unknown(key, &top_level_keys(experiment, other))),
            }
        }
        Ok(scenario)
    }

    fn read_parameters(&mut self, reader: &Reader, table: &DeTable, experiment: &'static Experiment) -> Result<(), Refusal> {
        for (key, value) in table {
            let name = key.get_ref().as_ref();
            let Ok(parameter) = self.settings.declaration(name) else {
                return Err(reader.unknown(key, &one_of(name, names(experiment))));
            };
            let accepted = value_of(value.get_ref()).and_then(|value| self.settings.set(name, value).ok());
            accepted.ok_or_else(|| reader.refuse(name, value, parameter.expected()))?;
            self.origins.insert(name.into(), reader.origin(value));
        }
        Ok(())
    }

    /// Sets a parameter from the text of `--set key=value`.
    ///
    /// # Errors
    /// [`Refusal`] when the key is unknown or the value not accepted.
    pub fn set(&mut self, key: &str, text: &str) -> Result<(), Refusal> {
        let refuse = |invalid| Refusal::new(Origin::CommandLine, invalid);
        let Subject::Experiment(experiment) = self.subject else {
            return Err(refuse(Invalid::new(key, text, "no --set with a free system, whose file is to be changed instead")));
        };
        if self.settings.declaration(key).is_err() {
            return Err(refuse(Invalid::new(key, "(an unknown key)", one_of(key, names(experiment)))));
        }
        self.settings.set_text(key, text).map_err(refuse)?;
        self.origins.insert(key.into(), Origin::CommandLine);
        Ok(())
    }

    /// Sets for how long to run: the parameter `duration` of an experiment that declares one, in its unit, the physical
    /// time to stop at otherwise.
    ///
    /// # Errors
    /// [`Refusal`] when it is not accepted.
    pub fn set_duration(&mut self, duration: f64) -> Result<(), Refusal> {
        self.last(duration).map_err(|invalid| Refusal::new(Origin::CommandLine, invalid))?;
        self.origins.insert("duration".into(), Origin::CommandLine);
        Ok(())
    }

    fn last(&mut self, duration: f64) -> Result<(), Invalid> {
        if !(duration.is_finite() && duration > 0.0) {
            return Err(Invalid::new("duration", duration, DURATION));
        }
        match &mut self.subject {
            Subject::Experiment(_) if self.settings.declaration("duration").is_ok() => {
                return self.settings.set("duration", Value::Real(duration));
            }
            Subject::Experiment(_) => self.duration = Some(duration),
            Subject::Free(system) => system.duration = duration,
        }
        Ok(())
    }

    /// All parameters with their values, and whether each was given rather than left at its default.
    pub fn parameters(&self) -> impl Iterator<Item = (&'static Parameter, &Value, bool)> {
        self.settings.iter().map(|(parameter, value)| (parameter, value, self.settings.is_given(parameter.name)))
    }

    /// Sets the system up.
    ///
    /// # Errors
    /// [`Refusal`] when the values do not go together; it points at the one that is named as the cause.
    pub fn start(&self) -> Result<Box<dyn Simulation>, Refusal> {
        let started = match &self.subject {
            Subject::Experiment(experiment) => (experiment.start)(&self.settings),
            Subject::Free(system) => free::start(system, self.settings.seed),
        };
        let started = match self.deeds[..] {
            [] => started,
            _ => started.and_then(|simulation| with_deeds(simulation, self.deeds.clone())),
        };
        started.map_err(|invalid| Refusal::new(self.origin(&invalid.key), invalid))
    }

    /// Where the value of a key came from, or if it was not given, the nearest table around it: `species[0].radius`, then
    /// `species[0]`, then the file.
    fn origin(&self, key: &str) -> Origin {
        let mut around = std::iter::successors(Some(key), |key| key.rsplit_once('.').map(|(table, _)| table));
        around.find_map(|key| self.origins.get(key)).unwrap_or(&self.file).clone()
    }

    /// The scenario for a folder of its own, and the file that has to be there beside it, if it starts from one: that frame alone,
    /// under a name of its own and with its sum.
    #[must_use]
    pub fn portable(mut self) -> (Self, Option<(&'static str, Vec<u8>)>) {
        let Subject::Free(system) = &mut self.subject else { return (self, None) };
        let Some((start, file)) = start::pack(system) else { return (self, None) };
        system.start = Some(start);
        (self, Some((START, file)))
    }

    /// The scenario as a file that gives the same run again, bit for bit: numbers are written with as many digits as
    /// they need to be read back exactly.
    ///
    /// Parameters left at their defaults stand there as comments: an experiment may ask which ones were given, so that
    /// naming all of them could change what it does.
    pub fn to_toml(&self) -> String {
        let head = format!("# Corpuscle {VERSION}. To run it again: corpuscle run scenario.toml\n");
        let seed = format!("seed = {}\n", self.settings.seed);
        let subject = match &self.subject {
            // What was read from TOML can be written as TOML.
            Subject::Free(system) => seed + &toml::to_string(system.as_ref()).unwrap_or_default(),
            Subject::Experiment(experiment) => {
                format!("experiment = {}\n", toml_text(&Value::Word(experiment.name.into()))) + &seed + &self.parameters_toml()
            }
        };
        head + &subject + &self.deeds_toml()
    }

    fn deeds_toml(&self) -> String {
        #[derive(Serialize)]
        struct Deeds<'a> {
            deed: &'a [Deed],
        }
        if self.deeds.is_empty() {
            return String::new();
        }
        format!("\n{}", toml::to_string(&Deeds { deed: &self.deeds }).unwrap_or_default())
    }

    /// The scenario with more that was done, at the times given in their order: after what the file has for the same time.
    #[must_use]
    pub fn with_deeds(&self, more: &[(f64, Action)]) -> Self {
        let mut scenario = self.clone();
        scenario.deeds.extend(more.iter().map(|&(at, act)| Deed { at, act }));
        scenario.deeds.sort_by(|one, other| one.at.total_cmp(&other.at));
        scenario
    }

    fn parameters_toml(&self) -> String {
        let mut text = self.duration.map(|duration| format!("duration = {duration:?}\n")).unwrap_or_default();
        text += "\n[parameters]\n";
        for (parameter, value, given) in self.parameters() {
            let unit = if parameter.unit.is_empty() { String::new() } else { format!(" # {}", parameter.unit) };
            let comment = if given { "" } else { "# " };
            let _ = writeln!(text, "{comment}{} = {}{unit}", parameter.name, toml_text(value));
        }
        text
    }
}

const DURATION: &str = "a positive number: the physical time to run for";

fn names(experiment: &'static Experiment) -> impl Iterator<Item = &'static str> {
    experiment.parameters.iter().map(|parameter| parameter.name)
}

/// What to say of an unknown key at the top of a file: it may be a parameter in the wrong place.
fn top_level_keys(experiment: &'static Experiment, key: &str) -> String {
    if names(experiment).any(|name| name == key) {
        return format!("it below [parameters], as a parameter of {}", experiment.name);
    }
    one_of(key, KEYS)
}

/// A value in TOML, with the digits needed to read it back exactly.
fn toml_text(value: &Value) -> String {
    match value {
        Value::Real(x) => format!("{x:?}"),
        Value::Word(word) => toml::Value::String(word.clone()).to_string(),
        Value::Whole(_) | Value::Flag(_) | Value::List(_) => value.to_string(),
    }
}

#[cfg(test)]
mod tests;
