//! Pictures of the whole window, for the documentation and for whoever changes it: each experiment in each palette, size and
//! language that the arguments name.
//!
//! `cargo run --release -p corpuscle-lab --example pictures -- FOLDER [WORDS...]`, where words are names of experiments, `dark`,
//! `light`, `projector`, `small` (1280 x 800), `large` (1920 x 1080), `english`, `chinese`, `checks`, `honesty`, `notebook`,
//! `gallery`, `help`, `record`. What is not narrowed down is made in its first kind.

use std::path::PathBuf;
use std::process::ExitCode;

use corpuscle_experiments::REGISTRY;
use corpuscle_io::Scenario;
use corpuscle_lab::language::Language;
use corpuscle_lab::model::{Overlay, Tab};
use corpuscle_lab::theme::Theme;
use corpuscle_lab::{Preferences, Studio, StudioView};

fn main() -> ExitCode {
    let mut words = std::env::args().skip(1);
    let Some(folder) = words.next().map(PathBuf::from) else {
        eprintln!("the name of a folder is missing");
        return ExitCode::from(2);
    };
    let words: Vec<String> = words.collect();
    match draw(&folder, &words) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn chosen<T: Copy>(words: &[String], all: &[(&str, T)]) -> Vec<(String, T)> {
    let named: Vec<_> = all.iter().filter(|(name, _)| words.iter().any(|word| word == name)).collect();
    let kept = if named.is_empty() { all.iter().take(1).collect() } else { named };
    kept.into_iter().map(|(name, value)| ((*name).to_owned(), *value)).collect()
}

fn draw(folder: &std::path::Path, words: &[String]) -> Result<(), Box<dyn std::error::Error>> {
    std::fs::create_dir_all(folder)?;
    let experiments: Vec<_> = REGISTRY.iter().map(|experiment| (experiment.name, *experiment)).collect();
    let named = chosen(words, &experiments);
    let named = if words.iter().any(|word| experiments.iter().any(|(name, _)| name == word)) {
        named
    } else {
        chosen(&experiments.iter().map(|(name, _)| (*name).to_owned()).collect::<Vec<_>>(), &experiments)
    };
    let themes = chosen(words, &[("dark", Theme::Dark), ("light", Theme::Light), ("projector", Theme::Projector)]);
    let sizes = chosen(words, &[("small", [1280, 800]), ("large", [1920, 1080])]);
    let languages = chosen(words, &[("english", Language::English), ("chinese", Language::Chinese)]);
    let tabs =
        chosen(words, &[("charts", Tab::Charts), ("checks", Tab::Checks), ("honesty", Tab::Honesty), ("notebook", Tab::Notebook)]);
    let overlays = chosen(
        words,
        &[
            ("", Overlay::None),
            ("gallery", Overlay::Gallery),
            ("help", Overlay::Help),
            ("record", Overlay::Record),
            ("save", Overlay::Save),
        ],
    );
    for (name, experiment) in &named {
        for (theme_name, theme) in &themes {
            for (size_name, size) in &sizes {
                for (language_name, language) in &languages {
                    for (tab_name, tab) in &tabs {
                        for (overlay_name, overlay) in &overlays {
                            let preferences =
                                Preferences { language: *language, theme: *theme, hints_seen: 9, ..Preferences::default() };
                            let view = StudioView { size: *size, scale: 1.0, preferences, tab: *tab, overlay: *overlay };
                            let scenario = Scenario::new(experiment);
                            let mut simulation = scenario.start()?;
                            let mut studio = Studio::new(REGISTRY, scenario, view)?;
                            let part = if words.iter().any(|word| word == "end") { 1.0 } else { 0.35 };
                            let end = simulation.end() * part;
                            for look in 1..=120 {
                                simulation.advance(end * f64::from(look) / 120.0)?;
                                studio.look(simulation.as_ref());
                                if *tab == Tab::Notebook && look > 60 && look % 12 == 0 {
                                    studio.record_row(simulation.as_ref());
                                }
                            }
                            let file = format!("{name}-{theme_name}-{size_name}-{language_name}-{tab_name}{overlay_name}.png");
                            std::fs::write(folder.join(&file), studio.picture(simulation.as_ref(), true)?.to_png()?)?;
                            println!("{file}");
                        }
                    }
                }
            }
        }
    }
    Ok(())
}
