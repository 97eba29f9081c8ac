//! What can be said of the numerical quality: nothing is hidden that could spoil a result.

use corpuscle_io::number::grouped;
use egui::Ui;

use super::widgets::{quiet, row, section};
use crate::language::Text;
use crate::model::Model;
use crate::number::significant;
use crate::runner::Snapshot;

pub(super) fn show(ui: &mut Ui, model: &mut Model, seen: &Snapshot) {
    let colours = model.preferences.theme.colours();
    let language = model.language();
    let honesty = &seen.measured.honesty;
    section(ui, &colours, model.text(Text::Engine));
    row(ui, model.text(Text::Engine), &language.phrase(&honesty.engine), colours.ink);
    row(ui, &language.phrase(honesty.work_unit), &grouped(honesty.work), colours.ink);
    let pace = if seen.playing { format!("{:.0} %", 100.0 * seen.pace.min(1.0)) } else { "—".into() };
    row(ui, model.text(Text::Pace), &pace, colours.ink).on_hover_text(model.text(Text::PaceHelp));

    section(ui, &colours, model.text(Text::Conservation));
    for (text, help, value) in [
        (Text::EnergyDrift, Text::EnergyDriftHelp, honesty.energy_drift),
        (Text::MomentumDrift, Text::MomentumDriftHelp, honesty.momentum_drift),
        (Text::AngularMomentumDrift, Text::AngularMomentumDriftHelp, honesty.angular_momentum_drift),
        (Text::LargestOverlap, Text::LargestOverlapHelp, honesty.largest_overlap),
    ] {
        let words = value.map_or_else(|| model.text(Text::NotConserved).into(), |value| significant(value, 3));
        let colour = if value.is_some() { colours.ink } else { colours.quiet };
        row(ui, model.text(text), &words, colour).on_hover_text(model.text(help));
    }

    section(ui, &colours, model.text(Text::Stability));
    let (words, colour) = match honesty.stability_number {
        Some(number) if number >= 2.0 => (language.fill(Text::Unstable, &[&significant(number, 3)]), colours.bad),
        Some(number) => (significant(number, 3), colours.ink),
        None => (model.text(Text::NoStep).into(), colours.quiet),
    };
    row(ui, model.text(Text::StabilityNumber), &words, colour).on_hover_text(model.text(Text::StabilityHelp));

    section(ui, &colours, model.text(Text::Reproducibility));
    row(ui, model.text(Text::Seed), &model.scenario.settings.seed.to_string(), colours.ink);
    quiet(ui, &colours, model.text(Text::SameBits));
    for table in &seen.measured.tables {
        let name = language.key(&table.name);
        if ui.button(language.fill(Text::SaveTable, &[&name])).clicked() {
            let file = format!("{}-{}.csv", model.scenario.name(), table.name);
            model.ask(crate::model::Job::Write(file.into(), corpuscle_io::csv::table(table)));
        }
    }
}
