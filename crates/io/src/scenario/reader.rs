//! From the text of a scenario file to values, each with its place.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use corpuscle_core::Invalid;
use corpuscle_experiments::{Deed, Settings, Value, free};
use serde::Deserialize;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use super::{DEFAULT_SEED, Scenario, Subject, start};
use crate::refusal::{Origin, Place, Refusal, one_of, quoted};

const SEED: &str = "a whole number from 0 to 18446744073709551615";

/// The text being read and its file: turns spans into places.
pub(super) struct Reader<'a> {
    pub(super) text: &'a str,
    pub(super) path: &'a Path,
}

impl Reader<'_> {
    /// A system of the file's own.
    pub(super) fn free_system(&self, mut document: Spanned<DeTable>) -> Result<Scenario, Refusal> {
        let mut seed = DEFAULT_SEED;
        if let Some(value) = document.get_mut().remove("seed") {
            seed = self.seed(&value)?;
        }
        let mut origins = BTreeMap::new();
        self.collect("", document.get_ref(), &mut origins);
        let system = free::System::deserialize(toml::de::Deserializer::from(document))
            .map_err(|error| self.refused("system", &origins, &error))?;
        let scenario = Scenario::of(Subject::Free(Box::new(system)), Settings::new(&[], seed));
        let mut scenario = Scenario { file: Origin::File(self.path.into(), None), origins, ..scenario };
        if let Subject::Free(system) = &mut scenario.subject
            && let Some(start) = &system.start
        {
            match start::load(start, self.path.parent().unwrap_or(Path::new(""))) {
                Ok(imported) => system.imported = Some(Arc::new(imported)),
                Err(invalid) => return Err(Refusal::new(scenario.origin(&invalid.key), invalid)),
            }
        }
        Ok(scenario)
    }

    /// What is done to the system on the way.
    pub(super) fn deeds(&self, value: Spanned<DeValue>, origins: &mut BTreeMap<String, Origin>) -> Result<Vec<Deed>, Refusal> {
        self.collect_items("deed", value.get_ref(), origins);
        origins.insert("deed".into(), self.origin(&value));
        Vec::deserialize(toml::de::ValueDeserializer::from(value)).map_err(|error| self.refused("deed", origins, &error))
    }

    /// What serde says against the whole or a part of it, with its place and the key that stands there.
    fn refused(&self, whole: &str, origins: &BTreeMap<String, Origin>, error: &toml::de::Error) -> Refusal {
        let place = error.span().map(|span| Place::of(self.text, span.start));
        let found = error.span().map_or_else(|| "(incomplete)".into(), |span| quoted(self.text, span));
        let key = place.as_ref().and_then(|place| nearest(origins, place)).unwrap_or(whole);
        let message = error.message().replace('\n', "; ");
        let invalid = match unknown_word(&message) {
            Some((true, word, known)) => Invalid::new(word, "(an unknown key)", one_of(word, known)),
            Some((false, word, known)) => Invalid::new(key, found, one_of(word, known)),
            None => match message.strip_prefix("missing field `").and_then(|rest| rest.strip_suffix('`')) {
                Some(missing) if key == whole => Invalid::new(missing, "(missing)", "a value: this key is needed"),
                Some(missing) => Invalid::new(format!("{key}.{missing}"), "(missing)", "a value: this key is needed"),
                None => Invalid::new(key, found, what_was_expected(&message)),
            },
        };
        Refusal::new(Origin::File(self.path.into(), place), invalid)
    }

    /// Where the keys of a table and of the tables in it stand, as paths: `box.lower`, `species[0].radius`.
    fn collect(&self, prefix: &str, table: &DeTable, origins: &mut BTreeMap<String, Origin>) {
        for (key, value) in table {
            let path = format!("{prefix}{}", key.get_ref());
            match value.get_ref() {
                DeValue::Table(inner) => self.collect(&format!("{path}."), inner, origins),
                list => self.collect_items(&path, list, origins),
            }
            origins.insert(path, self.origin(value));
        }
    }

    /// Where the tables of a list and their keys stand.
    fn collect_items(&self, path: &str, list: &DeValue, origins: &mut BTreeMap<String, Origin>) {
        for (index, item) in list.as_array().into_iter().flatten().enumerate() {
            if let Some(inner) = item.get_ref().as_table() {
                self.collect(&format!("{path}[{index}]."), inner, origins);
                origins.insert(format!("{path}[{index}]"), self.origin(item));
            }
        }
    }

    pub(super) fn seed(&self, value: &Spanned<DeValue>) -> Result<u64, Refusal> {
        match value_of(value.get_ref()) {
            Some(Value::Whole(seed)) => Ok(seed),
            _ => Err(self.refuse("seed", value, SEED)),
        }
    }

    pub(super) fn origin<T>(&self, item: &Spanned<T>) -> Origin {
        Origin::File(self.path.into(), Some(Place::of(self.text, item.span().start)))
    }

    pub(super) fn refuse(&self, key: &str, value: &Spanned<DeValue>, expected: impl Into<String>) -> Refusal {
        Refusal::new(self.origin(value), Invalid::new(key, quoted(self.text, value.span()), expected))
    }

    pub(super) fn unknown(&self, key: &Spanned<DeString>, expected: &str) -> Refusal {
        let name = quoted(self.text, key.span());
        Refusal::new(self.origin(key), Invalid::new(name, "(an unknown key)", expected))
    }

    /// The line a byte stands in, for quoting.
    pub(super) fn line(&self, byte: usize) -> String {
        let byte = (0..=byte.min(self.text.len())).rev().find(|&byte| self.text.is_char_boundary(byte)).unwrap_or(0);
        let start = self.text[..byte].rfind('\n').map_or(0, |newline| newline + 1);
        let end = self.text[byte..].find('\n').map_or(self.text.len(), |newline| byte + newline);
        format!("`{}`", quoted(self.text, start..end).trim())
    }
}

/// A value as the declarations know it; none for tables, dates and mixed lists.
pub(super) fn value_of(value: &DeValue) -> Option<Value> {
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

/// The key whose value begins at this place, or is the last to begin before it: an item of a list has none of its own.
fn nearest<'a>(origins: &'a BTreeMap<String, Origin>, place: &Place) -> Option<&'a str> {
    let before = origins.iter().filter_map(|(key, origin)| match origin {
        Origin::File(_, Some(begins)) if (begins.line, begins.column) <= (place.line, place.column) => {
            Some(((begins.line, begins.column, key.len()), key.as_str()))
        }
        _ => None,
    });
    before.max().map(|(_, key)| key)
}

/// What serde expected, in the words of a person.
fn what_was_expected(message: &str) -> String {
    let Some((_, expected)) = message.split_once(", expected ").filter(|_| message.starts_with("invalid ")) else {
        return message.to_owned();
    };
    match expected {
        "f64" => "a number".into(),
        "a string" => "text, in quotes".into(),
        "a boolean" => "true or false".into(),
        "a sequence" => "a list".into(),
        word if word.starts_with('u') && word[1..].chars().all(|c| c.is_ascii_digit() || "size".contains(c)) => {
            "a whole number, zero or more".into()
        }
        word if word.starts_with("struct ") => "a table".into(),
        other => other.to_owned(),
    }
}

/// What serde says of a word it does not know, taken apart: whether it is a key, the word, and the known ones. Its message is
/// "unknown field `raduis`, expected one of `radius`, `mass`", or "unknown variant" of the same form.
fn unknown_word(message: &str) -> Option<(bool, &str, Vec<&str>)> {
    let key = message.starts_with("unknown field ");
    let mut quoted = message.split('`').skip(1).step_by(2);
    let word = quoted.next()?;
    (key || message.starts_with("unknown variant ")).then(|| (key, word, quoted.collect()))
}
