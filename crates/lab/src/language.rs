//! The window's words, in every language it speaks, from one table.
//!
//! Words of the window itself are [`Text`]s: the compiler holds that each has every language. What experiments say of
//! themselves (titles, helps, names of parameters) comes in English and is looked up in [`phrases`]; what is not found there
//! stays English.

pub mod phrases;
mod table;

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

pub use table::Text;

/// A language of the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Language {
    /// English.
    #[default]
    English,
    /// Simplified Chinese.
    Chinese,
}

impl Language {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::English, Self::Chinese];

    /// Its own name for itself.
    pub fn name(self) -> &'static str {
        match self {
            Self::English => "English",
            Self::Chinese => "简体中文",
        }
    }

    /// The next one round.
    #[must_use]
    pub fn next(self) -> Self {
        match self {
            Self::English => Self::Chinese,
            Self::Chinese => Self::English,
        }
    }

    /// The language that the system's environment asks for: Chinese for `zh...`, English otherwise.
    pub fn of_the_system() -> Self {
        let asked = ["LC_ALL", "LC_MESSAGES", "LANG"].iter().find_map(|name| std::env::var(name).ok().filter(|v| !v.is_empty()));
        if asked.is_some_and(|locale| locale.starts_with("zh")) { Self::Chinese } else { Self::English }
    }

    /// A word of the window.
    pub fn text(self, text: Text) -> &'static str {
        text.entry()[match self {
            Self::English => 0,
            Self::Chinese => 1,
        }]
    }

    /// A sentence of the window with its gaps, written `{}`, filled in order.
    pub fn fill(self, text: Text, parts: &[&str]) -> String {
        phrases::filled(self.text(text), parts)
    }

    /// What an experiment says of itself. A sentence with numbers in it is looked up with gaps in their places, written `{}`.
    pub fn phrase(self, english: &str) -> Cow<'_, str> {
        let Self::Chinese = self else { return english.into() };
        if let Some(chinese) = phrases::chinese(english) {
            return chinese.into();
        }
        let (pattern, numbers) = phrases::gaps(english);
        let Some(chinese) = phrases::chinese(&pattern).filter(|_| !numbers.is_empty()) else { return english.into() };
        phrases::filled(chinese, &numbers).into()
    }

    /// The name of an experiment's parameter: `wave.masses` may be called otherwise than `masses`.
    pub fn parameter(self, experiment: &str, key: &str) -> String {
        let own = format!("{experiment}.{key}");
        match (self, phrases::chinese(&own)) {
            (Self::Chinese, Some(name)) => name.to_owned(),
            _ => self.key(key),
        }
    }

    /// The name of a choice such as `gauss-radau-15`.
    pub fn choice(self, word: &str) -> String {
        if let (Self::Chinese, Some(name)) = (self, phrases::chinese(word)) {
            return name.to_owned();
        }
        named_after_people(word).map_or_else(|| capitalised(word), str::to_owned)
    }

    /// The name of a key such as `packing_fraction`: its words.
    pub fn key(self, key: &str) -> String {
        if let (Self::Chinese, Some(name)) = (self, phrases::chinese(key)) {
            return name.to_owned();
        }
        capitalised(&key.replace(['_', '-'], " "))
    }
}

fn capitalised(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

/// Choices whose names hold those of people.
fn named_after_people(word: &str) -> Option<&'static str> {
    Some(match word {
        "explicit-euler" => "Explicit Euler",
        "symplectic-euler" => "Symplectic Euler",
        "velocity-verlet" => "Velocity Verlet",
        "yoshida-4" => "Yoshida 4",
        "yoshida-6" => "Yoshida 6",
        "yoshida-8" => "Yoshida 8",
        "runge-kutta-4" => "Runge–Kutta 4",
        "dormand-prince-8" => "Dormand–Prince 8(5,3)",
        "gauss-radau-15" => "Gauss–Radau 15",
        "wisdom-holman" => "Wisdom–Holman",
        "nose-hoover" => "Nosé–Hoover",
        "sun-earth-moon" => "Sun, Earth and Moon",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_the_same_in_every_language() {
        for text in Text::ALL {
            let [english, chinese] = text.entry();
            assert!(!english.is_empty() && !chinese.is_empty(), "{text:?}");
            assert_eq!(english.matches("{}").count(), chinese.matches("{}").count(), "{text:?}");
        }
    }

    #[test]
    fn sentences_are_filled_in_order() {
        assert_eq!(Language::English.fill(Text::ChecksHold, &["3", "4"]), "3 of 4 checks hold");
        assert!(Language::Chinese.fill(Text::ChecksHold, &["3", "4"]).contains('3'));
    }

    #[test]
    fn numbers_are_gaps_and_words_with_digits_are_none() {
        let (pattern, numbers) = phrases::gaps("k_B T = 1.5e-3 at S₀, V2 and −7 of 10, x1.2");
        assert_eq!(pattern, "k_B T = {} at S₀, V2 and {} of {}, x1.2");
        assert_eq!(numbers, ["1.5e-3", "−7", "10"]);
        let said = Language::Chinese.phrase("400 left, 12 right");
        assert!(said.contains("400") && said.contains("12") && !said.contains("left"), "{said}");
        assert_eq!(Language::Chinese.phrase("nobody has translated 3"), "nobody has translated 3");
    }

    #[test]
    fn keys_become_words() {
        assert_eq!(Language::English.key("packing_fraction"), "Packing fraction");
        assert_eq!(Language::Chinese.key("packing_fraction"), "填充率");
        assert_eq!(Language::Chinese.key("no_such_key"), "No such key");
        assert_eq!(Language::English.choice("runge-kutta-4"), "Runge–Kutta 4");
        assert_eq!(Language::English.choice("periodic"), "Periodic");
    }
}
