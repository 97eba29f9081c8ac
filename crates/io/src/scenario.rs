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
//! Every key is known, typed and ranged; what is not is refused with its line and column, and a near miss is named.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use corpuscle_core::Invalid;
use corpuscle_experiments::{Experiment, Parameter, Settings, Simulation, Value};
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use crate::VERSION;
use crate::refusal::{Origin, Place, Refusal, one_of, quoted};

/// The experiments a scenario can name.
pub type Registry<'a> = &'a [&'static Experiment];

/// Seed of a run that asks for none: fixed, so that the same command gives the same result.
pub const DEFAULT_SEED: u64 = 1;

/// Longest scenario file read, in bytes: far more than any list of particles written by hand.
const LONGEST_FILE: u64 = 16 << 20;

/// The keys at the top of a file.
const KEYS: [&str; 4] = ["experiment", "seed", "duration", "parameters"];

/// What to run: an experiment, its parameters, the seed and for how long.
#[derive(Clone)]
pub struct Scenario {
    /// The experiment.
    pub experiment: &'static Experiment,
    /// Its parameters and the seed.
    pub settings: Settings,
    /// Physical time to run for, where it differs from what the experiment needs.
    pub duration: Option<f64>,
    file: Origin,
    origins: BTreeMap<String, Origin>,
}

impl Scenario {
    /// An experiment with its defaults.
    pub fn new(experiment: &'static Experiment) -> Self {
        let settings = Settings::new(experiment.parameters, DEFAULT_SEED);
        Self { experiment, settings, duration: None, file: Origin::default(), origins: BTreeMap::new() }
    }

    /// What a word on the command line means: the name of an experiment, or else a scenario file.
    ///
    /// # Errors
    /// [`Refusal`] when it is neither, or the file cannot be used.
    pub fn find(registry: Registry, word: &str) -> Result<Self, Refusal> {
        if let Some(experiment) = registry.iter().find(|experiment| experiment.name == word) {
            return Ok(Self::new(experiment));
        }
        let path = Path::new(word);
        let looks_like_a_file = word.contains(['/', '\\']) || path.extension().is_some() || path.exists();
        if looks_like_a_file {
            return Self::read(registry, path);
        }
        let expected = format!("a scenario file or {}", one_of(word, registry.iter().map(|experiment| experiment.name)));
        Err(Refusal::new(Origin::CommandLine, Invalid::new("experiment", word, expected)))
    }

    /// Reads a scenario file.
    ///
    /// # Errors
    /// [`Refusal`] when it cannot be read, or holds what cannot be used.
    pub fn read(registry: Registry, path: &Path) -> Result<Self, Refusal> {
        let origin = Origin::File(path.into(), None);
        let refuse = |value: String, expected: &str| Refusal::new(origin.clone(), Invalid::new("file", value, expected));
        let unreadable = |error: std::io::Error| refuse(error.to_string(), "a scenario file that can be read");
        let file = File::open(path).map_err(unreadable)?;
        if file.metadata().map_err(unreadable)?.is_dir() {
            return Err(refuse("a folder".into(), "a scenario file"));
        }
        let mut bytes = vec![];
        file.take(LONGEST_FILE + 1).read_to_end(&mut bytes).map_err(unreadable)?;
        if bytes.len() as u64 > LONGEST_FILE {
            return Err(refuse(format!("more than {LONGEST_FILE} bytes"), "a scenario file of at most 16 MiB"));
        }
        let text = String::from_utf8(bytes).map_err(|error| {
            let byte = error.utf8_error().valid_up_to();
            refuse(format!("byte {byte} is not UTF-8"), "a scenario file, which is text in UTF-8")
        })?;
        Self::parse(registry, &text, path)
    }

    /// Reads a scenario from the text of the file `path`.
    ///
    /// # Errors
    /// [`Refusal`] when the text holds what cannot be used.
    pub fn parse(registry: Registry, text: &str, path: &Path) -> Result<Self, Refusal> {
        let reader = Reader { text, path };
        let document = DeTable::parse(text).map_err(|error| {
            let place = error.span().map(|span| Place::of(text, span.start));
            let found = error.span().map_or_else(String::new, |span| reader.line(span.start));
            let invalid = Invalid::new("text", found, format!("TOML: {}", error.message().replace('\n', "; ")));
            Refusal::new(Origin::File(path.into(), place), invalid)
        })?;
        let document = document.get_ref();
        let name = document.get("experiment").ok_or_else(|| {
            let expected = one_of("", registry.iter().map(|experiment| experiment.name));
            Refusal::new(Origin::File(path.into(), None), Invalid::new("experiment", "(missing)", expected))
        })?;
        let experiment = name.get_ref().as_str().and_then(|name| registry.iter().find(|known| known.name == name));
        let experiment = experiment.ok_or_else(|| {
            let word = name.get_ref().as_str().unwrap_or_default();
            reader.refuse("experiment", name, one_of(word, registry.iter().map(|known| known.name)))
        })?;
        let mut scenario = Self { file: Origin::File(path.into(), None), ..Self::new(experiment) };
        for (key, value) in document {
            match key.get_ref().as_ref() {
                "experiment" => {}
                "seed" => {
                    let seed =
                        value_of(value.get_ref()).and_then(|value| if let Value::Whole(seed) = value { Some(seed) } else { None });
                    scenario.settings.seed = seed.ok_or_else(|| reader.refuse("seed", value, SEED))?;
                }
                "duration" => {
                    let duration = match value_of(value.get_ref()) {
                        Some(Value::Real(duration)) => Some(duration),
                        Some(Value::Whole(duration)) => Some(duration as f64),
                        _ => None,
                    };
                    let duration = duration.filter(|&duration| is_duration(duration));
                    scenario.duration = Some(duration.ok_or_else(|| reader.refuse("duration", value, DURATION))?);
                    scenario.origins.insert("duration".into(), reader.origin(value));
                }
                "parameters" => {
                    let table = value.get_ref().as_table();
                    let table = table.ok_or_else(|| reader.refuse("parameters", value, "a table, [parameters]"))?;
                    scenario.read_parameters(&reader, table)?;
                }
                other => return Err(reader.unknown(key, &top_level_keys(experiment, other))),
            }
        }
        Ok(scenario)
    }

    fn read_parameters(&mut self, reader: &Reader, table: &DeTable) -> Result<(), Refusal> {
        for (key, value) in table {
            let name = key.get_ref().as_ref();
            let Ok(parameter) = self.settings.declaration(name) else {
                return Err(reader.unknown(key, &one_of(name, names(self.experiment))));
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
        if self.settings.declaration(key).is_err() {
            return Err(refuse(Invalid::new(key, "(an unknown key)", one_of(key, names(self.experiment)))));
        }
        self.settings.set_text(key, text).map_err(refuse)?;
        self.origins.insert(key.into(), Origin::CommandLine);
        Ok(())
    }

    /// Sets the physical time to run for.
    ///
    /// # Errors
    /// [`Refusal`] when it is not a positive, finite number.
    pub fn set_duration(&mut self, duration: f64) -> Result<(), Refusal> {
        if !is_duration(duration) {
            return Err(Refusal::new(Origin::CommandLine, Invalid::new("duration", duration, DURATION)));
        }
        self.duration = Some(duration);
        self.origins.insert("duration".into(), Origin::CommandLine);
        Ok(())
    }

    /// All parameters with their values, and whether each was given rather than left at its default.
    pub fn parameters(&self) -> impl Iterator<Item = (&'static Parameter, &Value, bool)> {
        self.settings.iter().map(|(parameter, value)| (parameter, value, self.settings.is_given(parameter.name)))
    }

    /// Sets the system up.
    ///
    /// # Errors
    /// [`Refusal`] when the parameters do not go together; it points at the one that the experiment names.
    pub fn start(&self) -> Result<Box<dyn Simulation>, Refusal> {
        (self.experiment.start)(&self.settings).map_err(|invalid| {
            let origin = self.origins.get(&invalid.key).unwrap_or(&self.file).clone();
            Refusal::new(origin, invalid)
        })
    }

    /// The scenario as a file that gives the same run again, bit for bit: numbers are written with as many digits as
    /// they need to be read back exactly.
    ///
    /// Parameters left at their defaults stand there as comments: an experiment may ask which ones were given, so that
    /// naming all of them could change what it does.
    pub fn to_toml(&self) -> String {
        let mut text = format!(
            "# Corpuscle {VERSION}. To run it again: corpuscle run scenario.toml\nexperiment = {}\nseed = {}\n",
            toml_text(&Value::Word(self.experiment.name.into())),
            self.settings.seed
        );
        if let Some(duration) = self.duration {
            let _ = writeln!(text, "duration = {duration:?}");
        }
        text += "\n[parameters]\n";
        for (parameter, value, given) in self.parameters() {
            let unit = if parameter.unit.is_empty() { String::new() } else { format!(" # {}", parameter.unit) };
            let comment = if given { "" } else { "# " };
            let _ = writeln!(text, "{comment}{} = {}{unit}", parameter.name, toml_text(value));
        }
        text
    }
}

const SEED: &str = "a whole number from 0 to 18446744073709551615";
const DURATION: &str = "a positive number: the physical time to run for";

fn is_duration(duration: f64) -> bool {
    duration.is_finite() && duration > 0.0
}

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

/// A value as the declarations know it; none for tables, dates and mixed lists.
fn value_of(value: &DeValue) -> Option<Value> {
    let real = |value: &DeValue| match value_of(value)? {
        Value::Real(x) => Some(x),
        Value::Whole(n) => Some(n as f64),
        _ => None,
    };
    match value {
        DeValue::Integer(digits) => match u64::from_str_radix(digits.as_str(), digits.radix()) {
            Ok(n) => Some(Value::Whole(n)),
            // Negative, or beyond the whole numbers: as a real number it is still a number.
            Err(_) => digits.as_str().parse().ok().map(Value::Real),
        },
        DeValue::Float(digits) => digits.as_str().parse().ok().map(Value::Real),
        DeValue::String(word) => Some(Value::Word(word.clone().into_owned())),
        DeValue::Boolean(flag) => Some(Value::Flag(*flag)),
        DeValue::Array(items) => items.iter().map(|item| real(item.get_ref())).collect::<Option<_>>().map(Value::List),
        DeValue::Table(_) | DeValue::Datetime(_) => None,
    }
}

/// A value in TOML, with the digits needed to read it back exactly.
fn toml_text(value: &Value) -> String {
    match value {
        Value::Real(x) => format!("{x:?}"),
        Value::Word(word) => toml::Value::String(word.clone()).to_string(),
        Value::Whole(_) | Value::Flag(_) | Value::List(_) => value.to_string(),
    }
}

/// The text being read and its file: turns spans into places.
struct Reader<'a> {
    text: &'a str,
    path: &'a Path,
}

impl Reader<'_> {
    fn origin<T>(&self, item: &Spanned<T>) -> Origin {
        Origin::File(self.path.into(), Some(Place::of(self.text, item.span().start)))
    }

    fn refuse(&self, key: &str, value: &Spanned<DeValue>, expected: impl Into<String>) -> Refusal {
        Refusal::new(self.origin(value), Invalid::new(key, quoted(self.text, value.span()), expected))
    }

    fn unknown(&self, key: &Spanned<DeString>, expected: &str) -> Refusal {
        let name = quoted(self.text, key.span());
        Refusal::new(self.origin(key), Invalid::new(name, "(an unknown key)", expected))
    }

    /// The line a byte stands in, for quoting.
    fn line(&self, byte: usize) -> String {
        let byte = (0..=byte.min(self.text.len())).rev().find(|&byte| self.text.is_char_boundary(byte)).unwrap_or(0);
        let start = self.text[..byte].rfind('\n').map_or(0, |newline| newline + 1);
        let end = self.text[byte..].find('\n').map_or(self.text.len(), |newline| byte + newline);
        format!("`{}`", quoted(self.text, start..end).trim())
    }
}

#[cfg(test)]
mod tests;
