//! One declaration of a parameter serves the scenario file, the command line, the window's slider and the documentation.

use std::collections::BTreeMap;
use std::fmt::{self, Write};

use corpuscle_core::Invalid;

/// A parameter of an experiment.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Key: whole words, lower case, joined by underscores.
    pub name: &'static str,
    /// Unit; empty when reduced or dimensionless.
    pub unit: &'static str,
    /// What it means, in one sentence.
    pub help: &'static str,
    /// Type, default and range.
    pub kind: Kind,
}

/// Type, default and range of a parameter.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// A real number within `least..=most`.
    Real {
        /// Value when not given.
        default: f64,
        /// Smallest value accepted.
        least: f64,
        /// Largest value accepted.
        most: f64,
    },
    /// A whole number within `least..=most`.
    Whole {
        /// Value when not given.
        default: u64,
        /// Smallest value accepted.
        least: u64,
        /// Largest value accepted.
        most: u64,
    },
    /// One of several words.
    Choice {
        /// Value when not given.
        default: &'static str,
        /// The words accepted.
        options: &'static [&'static str],
    },
    /// Yes or no.
    Flag {
        /// Value when not given.
        default: bool,
    },
    /// Real numbers, each within `least..=most`; none at all means "as the preset says" or "choose".
    List {
        /// Values when not given.
        default: &'static [f64],
        /// Smallest value accepted.
        least: f64,
        /// Largest value accepted.
        most: f64,
        /// Longest list accepted.
        longest: usize,
    },
}

/// The value of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A real number.
    Real(f64),
    /// A whole number.
    Whole(u64),
    /// A word.
    Word(String),
    /// Yes or no.
    Flag(bool),
    /// Real numbers.
    List(Vec<f64>),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Real(x) => write!(f, "{x}"),
            Self::Whole(n) => write!(f, "{n}"),
            Self::Word(word) => write!(f, "{word}"),
            Self::Flag(flag) => write!(f, "{flag}"),
            Self::List(list) => write!(f, "{list:?}"),
        }
    }
}

impl Parameter {
    /// The value when none is given.
    pub fn default(&self) -> Value {
        match self.kind {
            Kind::Real { default, .. } => Value::Real(default),
            Kind::Whole { default, .. } => Value::Whole(default),
            Kind::Choice { default, .. } => Value::Word(default.into()),
            Kind::Flag { default } => Value::Flag(default),
            Kind::List { default, .. } => Value::List(default.into()),
        }
    }

    /// What is accepted, in words.
    pub fn expected(&self) -> String {
        match self.kind {
            Kind::Real { least, most, .. } => format!("a number from {least} to {most}"),
            Kind::Whole { least, most, .. } => format!("a whole number from {least} to {most}"),
            Kind::Choice { options, .. } => format!("one of {}", options.join(", ")),
            Kind::Flag { .. } => "true or false".into(),
            Kind::List { least, most, longest, .. } => format!("a list of at most {longest} numbers from {least} to {most}"),
        }
    }

    /// Checks a value's type and range. A whole number serves as a real one; a real one without fraction as a whole one.
    ///
    /// # Errors
    /// Names the key, the value and what was expected.
    pub fn accept(&self, value: Value) -> Result<Value, Invalid> {
        let refused = Invalid::new(self.name, &value, self.expected());
        let within = |x: f64, least: f64, most: f64| x.is_finite() && least <= x && x <= most;
        match (self.kind, value) {
            (Kind::Real { least, most, .. }, Value::Real(x)) if within(x, least, most) => Ok(Value::Real(x)),
            (Kind::Real { least, most, .. }, Value::Whole(n)) if within(n as f64, least, most) => Ok(Value::Real(n as f64)),
            (Kind::Whole { least, most, .. }, Value::Whole(n)) if least <= n && n <= most => Ok(Value::Whole(n)),
            (Kind::Whole { least, most, .. }, Value::Real(x)) if x.fract() == 0.0 && within(x, least as f64, most as f64) => {
                Ok(Value::Whole(x as u64))
            }
            (Kind::Choice { options, .. }, Value::Word(word)) if options.contains(&word.as_str()) => Ok(Value::Word(word)),
            (Kind::Choice { options, .. }, Value::Whole(n)) if options.contains(&n.to_string().as_str()) => {
                Ok(Value::Word(n.to_string()))
            }
            (Kind::Flag { .. }, Value::Flag(flag)) => Ok(Value::Flag(flag)),
            (Kind::List { least, most, longest, .. }, Value::List(list))
                if list.len() <= longest && list.iter().all(|&x| within(x, least, most)) =>
            {
                Ok(Value::List(list))
            }
            _ => Err(refused),
        }
    }

    /// Reads a value from the text of `--set key=value`; a list is written `1,2,3` or `[1, 2, 3]`.
    ///
    /// # Errors
    /// Names the key, the text and what was expected.
    pub fn parse(&self, text: &str) -> Result<Value, Invalid> {
        let refused = || Invalid::new(self.name, text, self.expected());
        let text = text.trim();
        let value = match self.kind {
            Kind::Real { .. } => Value::Real(text.parse().map_err(|_| refused())?),
            Kind::Whole { .. } => match text.parse::<u64>() {
                Ok(n) => Value::Whole(n),
                Err(_) => Value::Real(text.parse().map_err(|_| refused())?),
            },
            Kind::Choice { .. } => Value::Word(text.into()),
            Kind::Flag { .. } => Value::Flag(text.parse().map_err(|_| refused())?),
            Kind::List { .. } => {
                let items =
                    text.trim_start_matches('[').trim_end_matches(']').split(',').map(str::trim).filter(|item| !item.is_empty());
                Value::List(items.map(|item| item.parse().map_err(|_| refused())).collect::<Result<_, _>>()?)
            }
        };
        self.accept(value).map_err(|_| refused())
    }
}

/// The table of these parameters in Markdown: key, what it means, default, what is accepted.
pub fn table(parameters: &[Parameter]) -> String {
    let mut out = String::from("| key | meaning | default | accepted |\n|---|---|---|---|\n");
    for parameter in parameters {
        let Parameter { name, unit, help, .. } = parameter;
        let help = help.split_whitespace().collect::<Vec<_>>().join(" ").replace('|', "\\|");
        let default = match parameter.default() {
            Value::List(list) if list.is_empty() => "none".into(),
            Value::List(list) => list.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "),
            value => value.to_string(),
        };
        let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        let _ = writeln!(out, "| `{name}` | {help} | {default}{unit} | {} |", parameter.expected());
    }
    out
}

/// A complete, checked set of parameters, with the seed.
#[derive(Clone, Debug)]
pub struct Settings {
    parameters: &'static [Parameter],
    values: BTreeMap<&'static str, Value>,
    given: Vec<&'static str>,
    /// Seed of all random numbers of the run.
    pub seed: u64,
}

impl Settings {
    /// The defaults of these parameters.
    pub fn new(parameters: &'static [Parameter], seed: u64) -> Self {
        let values = parameters.iter().map(|parameter| (parameter.name, parameter.default())).collect();
        Self { parameters, values, given: vec![], seed }
    }

    /// The declaration of a parameter.
    ///
    /// # Errors
    /// Names the nearest key, or all of them.
    pub fn declaration(&self, key: &str) -> Result<&'static Parameter, Invalid> {
        self.parameters.iter().find(|parameter| parameter.name == key).ok_or_else(|| {
            let names: Vec<&str> = self.parameters.iter().map(|parameter| parameter.name).collect();
            Invalid::new(key, "(an unknown key)", format!("one of {}", names.join(", ")))
        })
    }

    /// Sets a value.
    ///
    /// # Errors
    /// Names the key, the value and what was expected.
    pub fn set(&mut self, key: &str, value: Value) -> Result<(), Invalid> {
        let parameter = self.declaration(key)?;
        self.values.insert(parameter.name, parameter.accept(value)?);
        self.given.push(parameter.name);
        Ok(())
    }

    /// Sets a value from the text of `--set key=value`.
    ///
    /// # Errors
    /// Names the key, the text and what was expected.
    pub fn set_text(&mut self, key: &str, text: &str) -> Result<(), Invalid> {
        let value = self.declaration(key)?.parse(text)?;
        self.set(key, value)
    }

    /// Whether the user gave this value (and so did not leave it to the default or a preset).
    pub fn is_given(&self, key: &str) -> bool {
        self.given.contains(&key)
    }

    /// All values in the order of their declaration.
    pub fn iter(&self) -> impl Iterator<Item = (&'static Parameter, &Value)> {
        self.parameters.iter().map(|parameter| (parameter, &self.values[parameter.name]))
    }

    /// Value of a real parameter.
    ///
    /// # Panics
    /// When the experiment did not declare it as such: a mistake in the program, not in the input.
    pub fn real(&self, key: &str) -> f64 {
        match self.values.get(key) {
            Some(&Value::Real(x)) => x,
            other => undeclared(key, other),
        }
    }

    /// Value of a whole-number parameter.
    ///
    /// # Panics
    /// As [`real`](Settings::real).
    pub fn whole(&self, key: &str) -> usize {
        match self.values.get(key) {
            Some(&Value::Whole(n)) => n as usize,
            other => undeclared(key, other),
        }
    }

    /// Value of a choice.
    ///
    /// # Panics
    /// As [`real`](Settings::real).
    pub fn word(&self, key: &str) -> &str {
        match self.values.get(key) {
            Some(Value::Word(word)) => word,
            other => undeclared(key, other),
        }
    }

    /// Value of a flag.
    ///
    /// # Panics
    /// As [`real`](Settings::real).
    pub fn flag(&self, key: &str) -> bool {
        match self.values.get(key) {
            Some(&Value::Flag(flag)) => flag,
            other => undeclared(key, other),
        }
    }

    /// Value of a list.
    ///
    /// # Panics
    /// As [`real`](Settings::real).
    pub fn list(&self, key: &str) -> &[f64] {
        match self.values.get(key) {
            Some(Value::List(list)) => list,
            other => undeclared(key, other),
        }
    }

    /// An error about one of these values, for relations between several that no single range can express.
    pub fn invalid(&self, key: &str, expected: impl Into<String>) -> Invalid {
        Invalid::new(key, self.values.get(key).map(ToString::to_string).unwrap_or_default(), expected)
    }
}

#[allow(clippy::panic)] // the program asks for what it did not declare: nothing a user can cause
fn undeclared(key: &str, found: Option<&Value>) -> ! {
    panic!("parameter `{key}` is not declared with the type asked for (found {found:?})")
}

#[cfg(test)]
mod tests {
    use super::*;

    static PARAMETERS: &[Parameter] = &[
        Parameter { name: "temperature", unit: "", help: "", kind: Kind::Real { default: 1.0, least: 0.0, most: 10.0 } },
        Parameter { name: "particles", unit: "", help: "", kind: Kind::Whole { default: 10, least: 1, most: 100 } },
        Parameter { name: "dimension", unit: "", help: "", kind: Kind::Choice { default: "2", options: &["2", "3"] } },
        Parameter { name: "masses", unit: "", help: "", kind: Kind::List { default: &[], least: 0.0, most: 9.0, longest: 3 } },
    ];

    #[test]
    fn values_are_read_from_text() {
        let mut settings = Settings::new(PARAMETERS, 1);
        for (key, text) in [("temperature", "2.5"), ("particles", "1e2"), ("dimension", "3"), ("masses", "[3, 4,5]")] {
            settings.set_text(key, text).unwrap();
        }
        assert_eq!((settings.real("temperature"), settings.whole("particles")), (2.5, 100));
        assert_eq!((settings.word("dimension"), settings.list("masses")), ("3", [3.0, 4.0, 5.0].as_slice()));
        assert!(settings.is_given("masses"));
    }

    #[test]
    fn nonsense_is_refused_by_name() {
        let mut settings = Settings::new(PARAMETERS, 1);
        for (key, text) in [
            ("temperature", "NaN"),
            ("temperature", "-1"),
            ("temperature", "warm"),
            ("particles", "0"),
            ("particles", "-3"),
            ("particles", "2.5"),
            ("dimension", "4"),
            ("masses", "1,2,3,4"),
            ("masses", "1,x"),
        ] {
            let error = settings.set_text(key, text).unwrap_err();
            assert_eq!((error.key.as_str(), error.value.as_str()), (key, text));
            assert!(!error.expected.is_empty());
        }
        assert!(settings.set_text("temprature", "1").unwrap_err().expected.contains("temperature"));
    }
}
