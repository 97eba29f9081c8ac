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
