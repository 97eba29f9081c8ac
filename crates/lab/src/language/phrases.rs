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

    /// The paper's five experiments are wholly translated: titles, summaries, names and helps of parameters.
    #[test]
    fn the_papers_experiments_speak_chinese() {
        let mut missing = vec![];
        for name in ["brownian", "entropy", "ideal-gas", "three-body", "wave"] {
            let experiment = corpuscle_experiments::find(name).unwrap();
            let mut need = vec![experiment.title, experiment.summary];
            for parameter in experiment.parameters {
                need.extend([parameter.name, parameter.help]);
            }
            missing.extend(need.into_iter().filter(|phrase| chinese(phrase).is_none()));
        }
        assert!(missing.is_empty(), "not in phrases.tsv: {missing:#?}");
    }
}
