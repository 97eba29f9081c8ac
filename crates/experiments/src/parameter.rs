//! One declaration of a parameter serves the scenario file, the command line, the window's slider and the documentation.

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
    /// One of several words, each of which settles a whole situation.
    Situation {
        /// Value when not given.
        default: &'static str,
        /// The situations that can be chosen.
        options: &'static [Situation],
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

/// What a word means for the other parameters. The run reads it and the window shows it: there is no second copy.
#[derive(Clone, Copy, Debug)]
pub struct Situation {
    /// The word.
    pub name: &'static str,
    /// Values that hold in this situation where none are given, as one would write them on the command line.
    pub sets: &'static [(&'static str, &'static str)],
    /// Parameters that have no influence in it, in groups.
    pub unused: &'static [&'static [&'static str]],
}

impl Situation {
    /// A situation that leaves all other parameters as they are, but for those that have no influence in it.
    pub(crate) const fn new(name: &'static str, unused: &'static [&'static [&'static str]]) -> Self {
        Self { name, sets: &[], unused }
    }

    /// The same with values of its own.
    pub(crate) const fn with(self, sets: &'static [(&'static str, &'static str)]) -> Self {
        Self { sets, ..self }
    }
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
            Kind::Choice { default, .. } | Kind::Situation { default, .. } => Value::Word(default.into()),
            Kind::Flag { default } => Value::Flag(default),
            Kind::List { default, .. } => Value::List(default.into()),
        }
    }

    /// The words to choose from; none of a parameter that is no choice.
    pub fn words(&self) -> Vec<&'static str> {
        match self.kind {
            Kind::Choice { options, .. } => options.to_vec(),
            Kind::Situation { options, .. } => options.iter().map(|situation| situation.name).collect(),
            _ => vec![],
        }
    }

    /// What is accepted, in words.
    pub fn expected(&self) -> String {
        match self.kind {
            Kind::Real { least, most, .. } => format!("a number from {least} to {most}"),
            Kind::Whole { least, most, .. } => format!("a whole number from {least} to {most}"),
            Kind::Choice { .. } | Kind::Situation { .. } => format!("one of {}", self.words().join(", ")),
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
            (Kind::Choice { .. } | Kind::Situation { .. }, Value::Word(word)) if self.words().contains(&word.as_str()) => {
                Ok(Value::Word(word))
            }
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
            Kind::Choice { .. } | Kind::Situation { .. } => Value::Word(text.into()),
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

/// The table of these parameters in Markdown: key, what it means, default, what is accepted; and what situations set.
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
    out + &situations(parameters)
}

/// The table of what situations set; nothing where they set nothing.
fn situations(parameters: &[Parameter]) -> String {
    let mut out = String::new();
    for parameter in parameters {
        let Kind::Situation { options, .. } = parameter.kind else { continue };
        let mut setting = options.iter().filter(|situation| !situation.sets.is_empty()).peekable();
        if setting.peek().is_some() {
            let _ = writeln!(out, "\n| `{}` | sets, unless given |\n|---|---|", parameter.name);
        }
        for situation in setting {
            let sets: Vec<String> = situation.sets.iter().map(|(key, text)| format!("`{key}` = {text}")).collect();
            let _ = writeln!(out, "| {} | {} |", situation.name, sets.join(", "));
        }
    }
    out
}
