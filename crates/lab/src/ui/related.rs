//! Which chart a check is about.

use corpuscle_observe::{Chart, Check};

/// Words that say what is done, not what it is done to.
const COMMON: [&str; 22] = [
    "the", "of", "and", "from", "with", "over", "after", "by", "in", "at", "to", "a", "against", "time", "theory", "measured",
    "relative", "largest", "error", "base", "state", "mean",
];
/// A word in the title counts as much as so many in axes and series.
const TITLE: usize = 3;

/// The name of the chart that shares most words with a check; none that shares none with it. A check of conservation, which
/// every experiment has, belongs to a chart of the same quantity only.
pub(super) fn chart<'a>(charts: &'a [Chart], check: &Check) -> Option<&'a str> {
    let wanted = words(&check.quantity);
    let shared = |text: &str| words(text).iter().filter(|word| wanted.contains(word)).count();
    let score = |chart: &Chart| {
        let axes = shared(&chart.x.label) + shared(&chart.y.label);
        TITLE * shared(&chart.title) + axes + chart.series.iter().map(|series| shared(&series.name)).sum::<usize>()
    };
    let scored = charts.iter().map(|chart| (score(chart), chart)).filter(|(score, _)| *score > 0);
    // Of equals the first: it is the more telling.
    scored.rev().max_by_key(|(score, _)| *score).map(|(_, chart)| chart.name.as_str())
}

/// The telling words of a text, in lower case and without a plural.
fn words(text: &str) -> Vec<String> {
    let separate = |c: char| !c.is_alphanumeric();
    let words = text.split(separate).map(|word| word.to_lowercase().trim_end_matches('s').to_owned());
    words.filter(|word| word.chars().count() > 2 && !COMMON.contains(&word.as_str())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_experiments::{Settings, find};

    #[test]
    fn checks_lead_to_the_chart_of_their_quantity() {
        for (name, check, chart) in [
            ("brownian", "diffusion coefficient D, Einstein", "diffusion"),
            ("brownian", "k_B T by Perrin's way, from the displacement", "displacement"),
            ("entropy", "entropy of free expansion ΔS", "entropy-expansion"),
        ] {
            let experiment = find(name).unwrap();
            let mut settings = Settings::new(experiment.parameters, 1);
            settings.set_text("replicas", "3").unwrap();
            let mut simulation = (experiment.start)(&settings).unwrap();
            simulation.advance(0.2 * simulation.end()).unwrap();
            let charts = simulation.charts();
            let names: Vec<&str> = charts.iter().map(|chart| chart.name.as_str()).collect();
            let found = super::chart(&charts, &Check::at_most(check, 0.0, 1.0, ""));
            assert_eq!(found, Some(chart), "{check} among {names:?}");
        }
    }

    #[test]
    fn a_check_that_no_chart_shows_leads_nowhere() {
        let axis = || corpuscle_observe::chart::Axis::linear("time t", "");
        let charts = [Chart::new("a", "Pressure on the walls", axis(), axis())];
        assert_eq!(chart(&charts, &Check::at_most("relative energy drift", 0.0, 1.0, "")), None);
        assert_eq!(chart(&charts, &Check::at_most("pressure P", 0.0, 1.0, "")), Some("a"));
    }
}
