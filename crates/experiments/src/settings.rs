//! The values of an experiment's parameters: given, settled by the chosen situation, or default.

use std::collections::BTreeMap;

use corpuscle_core::Invalid;

use crate::{Kind, Parameter, Value};

/// A complete, checked set of parameters, with the seed. A parameter that is not given has the value of the chosen
/// [`Situation`], or else its default.
#[derive(Clone, Debug)]
pub struct Settings {
    parameters: &'static [Parameter],
    given: BTreeMap<&'static str, Value>,
    /// What holds: the values given, and for the others those of situations and defaults.
    values: BTreeMap<&'static str, Value>,
    /// The parameters without influence, each with the one whose choice makes it so.
    unused: BTreeMap<&'static str, &'static Parameter>,
    /// Seed of all random numbers of the run.
    pub seed: u64,
}

impl Settings {
    /// The defaults of these parameters.
    pub fn new(parameters: &'static [Parameter], seed: u64) -> Self {
        let mut settings = Self { parameters, given: BTreeMap::new(), values: BTreeMap::new(), unused: BTreeMap::new(), seed };
        settings.settle();
        settings
    }

    /// Finds the values that hold, situation by situation in the order of their declaration. A choice without influence settles
    /// nothing, and an empty list leaves the values to the situation, if it has some.
    fn settle(&mut self) {
        self.values = self.parameters.iter().map(|parameter| (parameter.name, parameter.default())).collect();
        self.unused.clear();
        self.values.extend(self.given.iter().map(|(&key, value)| (key, value.clone())));
        for parameter in self.parameters {
            let Kind::Situation { options, .. } = parameter.kind else { continue };
            let chosen = options.iter().find(|situation| situation.name == self.word(parameter.name));
            let Some(chosen) = chosen.filter(|_| !self.unused.contains_key(parameter.name)) else { continue };
            for &(key, text) in chosen.sets {
                if self.given.get(key).is_some_and(|value| *value != Value::List(vec![])) {
                    continue;
                }
                // That declarations can be read is held by a test.
                if let Ok((known, value)) = self.declaration(key).and_then(|known| Ok((known, known.parse(text)?))) {
                    self.values.insert(known.name, value);
                }
            }
            for key in chosen.unused.iter().copied().flatten() {
                self.unused.entry(key).or_insert(parameter);
            }
        }
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
        self.given.insert(parameter.name, parameter.accept(value)?);
        self.settle();
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
        self.given.contains_key(key)
    }

    /// The value that would hold if this one were not given.
    ///
    /// # Errors
    /// As [`declaration`](Self::declaration).
    pub fn fallback(&self, key: &str) -> Result<Value, Invalid> {
        let parameter = self.declaration(key)?;
        let mut without = self.clone();
        without.given.remove(parameter.name);
        without.settle();
        Ok(without.values[parameter.name].clone())
    }

    /// The parameter whose choice leaves this one without influence on the run; none where it has some.
    pub fn idle_under(&self, key: &str) -> Option<&'static Parameter> {
        self.unused.get(key).copied()
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
    use crate::Situation;

    static SITUATIONS: &[Situation] =
        &[Situation::new("plain", &[&["masses"]]), Situation::new("heavy", &[]).with(&[("masses", "7, 8"), ("temperature", "3")])];

    static PARAMETERS: &[Parameter] = &[
        Parameter { name: "preset", unit: "", help: "", kind: Kind::Situation { default: "plain", options: SITUATIONS } },
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
            ("preset", "light"),
            ("masses", "1,2,3,4"),
            ("masses", "1,x"),
        ] {
            let error = settings.set_text(key, text).unwrap_err();
            assert_eq!((error.key.as_str(), error.value.as_str()), (key, text));
            assert!(!error.expected.is_empty());
        }
        assert!(settings.set_text("temprature", "1").unwrap_err().expected.contains("temperature"));
    }

    #[test]
    fn a_situation_settles_what_is_not_given() {
        let mut settings = Settings::new(PARAMETERS, 1);
        assert_eq!(settings.idle_under("masses").map(|by| by.name), Some("preset"));
        settings.set_text("preset", "heavy").unwrap();
        assert_eq!((settings.list("masses"), settings.real("temperature")), ([7.0, 8.0].as_slice(), 3.0));
        assert!(settings.idle_under("masses").is_none() && !settings.is_given("masses"));
        settings.set_text("masses", "1").unwrap();
        settings.set_text("temperature", "2").unwrap();
        assert_eq!((settings.list("masses"), settings.real("temperature")), ([1.0].as_slice(), 2.0));
        assert_eq!(settings.fallback("temperature").unwrap(), Value::Real(3.0));
        settings.set_text("masses", "").unwrap();
        assert_eq!(settings.list("masses"), [7.0, 8.0]);
        settings.set_text("preset", "plain").unwrap();
        assert_eq!((settings.list("masses"), settings.real("temperature")), ([].as_slice(), 2.0));
    }

    #[test]
    fn what_situations_declare_can_be_read() {
        for experiment in crate::REGISTRY {
            let settings = Settings::new(experiment.parameters, 1);
            for parameter in experiment.parameters {
                let Kind::Situation { options, .. } = parameter.kind else { continue };
                for situation in options {
                    for (key, text) in situation.sets {
                        settings.declaration(key).unwrap().parse(text).unwrap();
                    }
                    let unused = situation.unused.iter().copied().flatten();
                    assert!(unused.clone().all(|key| settings.declaration(key).is_ok()), "{}", situation.name);
                    assert!(situation.sets.iter().all(|(key, _)| unused.clone().all(|other| key != other)), "{}", situation.name);
                }
            }
        }
    }
}
