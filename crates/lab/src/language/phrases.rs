//! What experiments say of themselves, in Chinese. Looked up by the English words; what is missing stays English, so that a
//! new experiment works before anybody has translated it.

use std::collections::HashMap;
use std::sync::LazyLock;

/// The Chinese of an English phrase or of a key such as `packing_fraction`.
pub fn chinese(english: &str) -> Option<&'static str> {
    static INDEX: LazyLock<HashMap<&'static str, &'static str>> = LazyLock::new(|| entries().collect());
    INDEX.get(english).copied()
}

/// All pairs.
pub fn entries() -> impl Iterator<Item = (&'static str, &'static str)> {
    let lines = include_str!("phrases.tsv").lines();
    lines.filter(|line| !line.is_empty() && !line.starts_with('#')).filter_map(|line| line.split_once('\t'))
}

/// A sentence with `{}` in the places of its numbers, and these. Digits within a word are no numbers.
pub fn gaps(sentence: &str) -> (String, Vec<&str>) {
    let (mut pattern, mut numbers) = (String::new(), vec![]);
    let mut rest = sentence;
    let mut before = ' ';
    while let Some(first) = rest.chars().next() {
        let length = number_length(rest);
        if length > 0 && !before.is_alphanumeric() && !matches!(before, '_' | '.' | '^') {
            let (number, after) = rest.split_at(length);
            numbers.push(number);
            pattern += "{}";
            before = number.chars().next_back().unwrap_or(first);
            rest = after;
        } else {
            pattern.push(first);
            before = first;
            rest = &rest[first.len_utf8()..];
        }
    }
    (pattern, numbers)
}

/// How many bytes at the beginning of a text are a number such as `-1.5e-3`, `+7` or `3·10⁻⁴`.
fn number_length(text: &str) -> usize {
    let sign = text.chars().next().filter(|c| matches!(c, '-' | '−' | '+')).map_or(0, char::len_utf8);
    let digits = |text: &str| text.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(text.len());
    let mantissa = digits(&text[sign..]);
    let body = text[sign..sign + mantissa].trim_end_matches('.');
    if !body.starts_with(|c: char| c.is_ascii_digit()) {
        return 0;
    }
    let mut length = sign + body.len();
    if let Some(exponent) = text[length..].strip_prefix('e') {
        let signed = exponent.strip_prefix(['-', '+']).unwrap_or(exponent);
        let count = signed.find(|c: char| !c.is_ascii_digit()).unwrap_or(signed.len());
        if count > 0 {
            length += 1 + (exponent.len() - signed.len()) + count;
        }
    }
    length
}

/// A sentence with its gaps, written `{}`, filled in order.
pub fn filled(sentence: &str, parts: &[&str]) -> String {
    let mut parts = parts.iter();
    let mut filled = String::new();
    for (index, piece) in sentence.split("{}").enumerate() {
        if index > 0 {
            filled += parts.next().copied().unwrap_or_default();
        }
        filled += piece;
    }
    filled
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn every_line_is_a_pair_and_no_phrase_comes_twice() {
        let lines = include_str!("phrases.tsv").lines().filter(|line| !line.is_empty() && !line.starts_with('#')).count();
        let pairs: Vec<_> = entries().collect();
        assert_eq!(pairs.len(), lines, "a line has no tab");
        let mut seen = HashSet::new();
        for (english, chinese) in pairs {
            assert!(!english.trim().is_empty() && !chinese.trim().is_empty());
            assert!(seen.insert(english), "{english} comes twice");
        }
    }

    /// The paper's experiments speak Chinese: titles and summaries all, names and helps of parameters nine in ten, so that a new
    /// parameter does not wait for a translator.
    #[test]
    fn the_papers_experiments_speak_chinese() {
        let (mut missing, mut all) = (vec![], 0);
        for name in ["brownian", "entropy", "ideal-gas", "three-body", "wave"] {
            let experiment = corpuscle_experiments::find(name).unwrap();
            for phrase in [experiment.title, experiment.summary] {
                assert!(chinese(phrase).is_some(), "not in phrases.tsv: {phrase}");
            }
            let phrases = experiment.parameters.iter().flat_map(|parameter| [parameter.name, parameter.help]);
            missing.extend(phrases.filter(|phrase| chinese(phrase).is_none()));
            all += 2 * experiment.parameters.len();
        }
        assert!(10 * missing.len() <= all, "not in phrases.tsv: {missing:#?}");
    }
}
