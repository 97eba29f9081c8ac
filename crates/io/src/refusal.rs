//! Input that cannot be used: what it was, where it stood, and what would have been accepted.

use std::fmt;
use std::ops::Range;
use std::path::PathBuf;

use corpuscle_core::Invalid;

/// A place in a text file, both counted from one; columns count characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Line.
    pub line: usize,
    /// Column.
    pub column: usize,
}

impl Place {
    /// The place of a byte of `text`.
    pub fn of(text: &str, byte: usize) -> Self {
        let before = text.get(..byte.min(text.len())).unwrap_or(text);
        let start = before.rfind('\n').map_or(0, |newline| newline + 1);
        Self { line: before.matches('\n').count() + 1, column: before[start..].chars().count() + 1 }
    }
}

/// Where a value came from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Origin {
    /// From nowhere in particular: a default, or the program's arguments as a whole.
    #[default]
    Unknown,
    /// From the command line.
    CommandLine,
    /// From a file, and if known from this place in it.
    File(PathBuf, Option<Place>),
}

/// An input that was refused, with the place it came from.
///
/// ```
/// use corpuscle_core::Invalid;
/// use corpuscle_io::{Origin, Place, Refusal};
/// let place = Place { line: 4, column: 10 };
/// let refusal = Refusal::new(Origin::File("gas.toml".into(), Some(place)), Invalid::new("radius", -1, "a positive number"));
/// assert_eq!(refusal.to_string(), "gas.toml:4:10: radius = -1: expected a positive number");
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// Where it came from.
    pub origin: Origin,
    /// What was refused, and what would have been accepted.
    pub invalid: Invalid,
}

impl Refusal {
    /// A refusal of what came from `origin`.
    pub fn new(origin: Origin, invalid: Invalid) -> Self {
        Self { origin, invalid }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.origin {
            Origin::Unknown => {}
            Origin::CommandLine => write!(f, "on the command line: ")?,
            Origin::File(path, None) => write!(f, "{}: ", path.display())?,
            Origin::File(path, Some(Place { line, column })) => write!(f, "{}:{line}:{column}: ", path.display())?,
        }
        write!(f, "{}", self.invalid)
    }
}

impl std::error::Error for Refusal {}

/// `one of a, b, c`, and where the word looks like a slip of one of them, which.
pub fn one_of<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let known: Vec<&str> = known.into_iter().collect();
    let list = if known.is_empty() { "nothing here".to_owned() } else { format!("one of {}", known.join(", ")) };
    match nearest(word, &known) {
        Some(near) => format!("{list}; did you mean `{near}`?"),
        None => list,
    }
}

/// The known word nearest to a misspelt one, when near enough to be worth suggesting.
fn nearest<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    let similarity = |candidate: &str| strsim::normalized_damerau_levenshtein(word, candidate);
    // Words longer than any key are no slips of one, and the distance takes time quadratic in the length.
    (word.len() <= 64).then_some(())?;
    let best = known.iter().copied().max_by(|a, b| similarity(a).total_cmp(&similarity(b)))?;
    (similarity(best) >= 0.6).then_some(best)
}

/// The source text of a value as it is quoted in a message: one line, and not too long.
pub(crate) fn quoted(text: &str, span: Range<usize>) -> String {
    const LONGEST: usize = 60;
    let raw = text.get(span).unwrap_or_default();
    let line: String = raw.chars().map(|c| if c.is_control() { ' ' } else { c }).take(LONGEST).collect();
    if raw.chars().nth(LONGEST).is_some() { line + "…" } else { line }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_is_recognised_and_a_stranger_is_not() {
        let known = ["temperature", "particles", "packing_fraction"];
        assert!(one_of("temprature", known).ends_with("did you mean `temperature`?"));
        assert!(one_of("packing", known).starts_with("one of"));
        assert!(!one_of("zebra", known).contains("did you mean"));
        assert_eq!(one_of("zebra", []), "nothing here");
    }

    #[test]
    fn places_count_characters_from_one() {
        let text = "a = 1\nπ = x";
        assert_eq!(Place::of(text, 0), Place { line: 1, column: 1 });
        assert_eq!(Place::of(text, text.find('x').unwrap()), Place { line: 2, column: 5 });
        assert_eq!(Place::of(text, 1000), Place { line: 2, column: 6 });
    }
}
