//! The first words: what the command says to a newcomer, and to arguments it cannot read.

use std::error::Error as _;
use std::fmt::Write;

use clap::Error;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use corpuscle_core::Invalid;
use corpuscle_io::{Origin, Refusal, Registry};

use crate::trouble::Trouble;

/// What to type first where there is no display for the window: `cause` says why.
pub(crate) fn welcome(registry: Registry, cause: &str) -> String {
    let names: Vec<&str> = registry.iter().map(|experiment| experiment.name).collect();
    let name = |place: usize| names.get(place % names.len().max(1)).copied().unwrap_or("FILE.toml");
    let examples = [
        ("list".into(), "the experiments there are"),
        (format!("view {} --screenshot a.png --at 5", name(3)), "a picture of the window, without a display"),
        (format!("run {}", name(0)), "run one, check it against theory, write its report"),
        (format!("record {} --out {}.mp4", name(4), name(4)), "make a film of one; needs no display"),
        (format!("check {}", name(1)), "its parameters and what they accept; runs nothing"),
    ];
    let width = examples.iter().map(|(example, _)| example.len()).max().unwrap_or(0);
    let mut out = String::from("Corpuscle, a physics laboratory: everything measured stands beside its theory.\n\n");
    for (example, meaning) in &examples {
        // Writing into a string cannot fail.
        let _ = writeln!(out, "  corpuscle {example:<width$}  {meaning}");
    }
    let _ = writeln!(out, "\nNo display ({cause}), so no window. On a desktop, `corpuscle` alone opens it.");
    let _ = writeln!(out, "Experiments: {}. A scenario file does as well.", names.join(", "));
    out + "All options: corpuscle --help, corpuscle run --help\n"
}

/// Arguments that cannot be read, in one line: the option, the value, and what was expected.
pub(crate) fn refusal(error: &Error) -> Trouble {
    let context = |kind| error.get(kind).map(words).filter(|words| !words.is_empty());
    if let (Some(argument), Some(value)) = (context(ContextKind::InvalidArg), context(ContextKind::InvalidValue)) {
        return Refusal::new(Origin::CommandLine, Invalid::new(key(&argument), value, expected(error))).into();
    }
    if let (ErrorKind::MissingSubcommand, Some(known)) = (error.kind(), context(ContextKind::ValidSubcommand)) {
        return Trouble::Usage(format!("a name is missing: expected one of {known}; --help shows what there is"));
    }
    let near = context(ContextKind::SuggestedArg).or_else(|| context(ContextKind::SuggestedSubcommand));
    let advice = near.map_or_else(|| "--help shows what there is".into(), |near| format!("did you mean `{near}`?"));
    Trouble::Usage(format!("{}; {advice}", first_sentence(error)))
}

/// `--seed <SEED>` is called `seed` in every other message.
fn key(argument: &str) -> &str {
    let name = argument.split([' ', '=']).next().unwrap_or(argument);
    name.strip_prefix("--").unwrap_or(name)
}

/// What the argument's own reader expected, or the words it knows.
fn expected(error: &Error) -> String {
    if let Some(source) = error.source() {
        let text = source.to_string();
        return text.strip_prefix("expected ").map_or(text.clone(), Into::into);
    }
    match error.get(ContextKind::ValidValue).map(words) {
        Some(known) if !known.is_empty() => format!("one of {known}"),
        _ => "a value".into(),
    }
}

fn words(value: &ContextValue) -> String {
    match value {
        ContextValue::Strings(words) => words.join(", "),
        value => value.to_string(),
    }
}

/// What clap has to say, without its advice.
fn first_sentence(error: &Error) -> String {
    let text = error.render().to_string();
    let sentence = text.split("\n\n").next().unwrap_or_default();
    let sentence: Vec<&str> = sentence.split_whitespace().collect();
    sentence.join(" ").trim_start_matches("error: ").to_owned()
}
