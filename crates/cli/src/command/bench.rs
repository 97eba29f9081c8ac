//! `corpuscle bench`: an engine timed by the clock, its physics beside its speed.

use std::fmt::Write;
use std::process::ExitCode;

use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches};
use corpuscle_bench::{Case, Figure, Parameter, REGISTRY, Settings};
use corpuscle_io::number::{plain, rounded, significant};
use corpuscle_io::{Origin, Refusal};
use serde_json::{Map, Value, json};

use crate::console;
use crate::table::{Align, table};
use crate::trouble::Trouble;

/// A case and its settings. Each case is a subcommand with options of its own, made from its declaration.
pub(crate) struct Arguments {
    case: &'static Case,
    settings: Settings,
    json: bool,
}

impl Args for Arguments {
    fn augment_args(command: Command) -> Command {
        command
            .subcommand_required(true)
            .disable_help_subcommand(true)
            .subcommand_value_name("CASE")
            .subcommand_help_heading("Cases")
            .subcommands(REGISTRY.iter().map(|case| {
                let options = case.parameters.iter().map(option);
                let seed = Arg::new("seed").long("seed").value_name("SEED").default_value("1").allow_hyphen_values(true);
                Command::new(case.name)
                    .about(case.summary)
                    .args(options)
                    .arg(seed.value_parser(super::seed).help("Seed of all random numbers"))
                    .arg(Arg::new("json").long("json").action(ArgAction::SetTrue).help("Print as JSON, for programs"))
            }))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

/// The option of a parameter, with its default and range.
fn option(parameter: &'static Parameter) -> Arg {
    let read = move |text: &str| match parameter.parse(text) {
        Ok(_) => Ok(text.to_owned()),
        Err(invalid) => Err(format!("expected {}", invalid.expected)),
    };
    let help = format!("{} Accepts {}", parameter.help, parameter.expected());
    Arg::new(parameter.name)
        .long(parameter.name.replace('_', "-"))
        .value_name(parameter.name.to_uppercase())
        .default_value(parameter.default().to_string())
        .allow_hyphen_values(true)
        .value_parser(read)
        .help(help)
}

impl FromArgMatches for Arguments {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let missing = || clap::Error::new(clap::error::ErrorKind::MissingSubcommand);
        let (name, matches) = matches.subcommand().ok_or_else(missing)?;
        let case = REGISTRY.iter().find(|case| case.name == name).ok_or_else(missing)?;
        let mut settings = Settings::new(case.parameters, matches.get_one("seed").copied().unwrap_or(1));
        for parameter in case.parameters {
            if let Some(text) = matches.get_one::<String>(parameter.name) {
                // The option's reader has accepted it.
                settings.set_text(parameter.name, text).map_err(|_| missing())?;
            }
        }
        Ok(Self { case, settings, json: matches.get_flag("json") })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

pub(crate) fn bench(arguments: &Arguments) -> Result<ExitCode, Trouble> {
    let figures = (arguments.case.run)(&arguments.settings).map_err(|trouble| match trouble {
        corpuscle_bench::Trouble::Refused(invalid) => Trouble::from(Refusal::new(Origin::CommandLine, invalid)),
        corpuscle_bench::Trouble::Failed(failure) => Trouble::from(failure),
    })?;
    console::print(&if arguments.json { arguments.for_programs(&figures) } else { arguments.for_people(&figures) })?;
    Ok(ExitCode::SUCCESS)
}

impl Arguments {
    /// One object: the figures at the top, `_standard_error` and `_theory` beside the value they belong to.
    fn for_programs(&self, figures: &[Figure]) -> String {
        let parameters: Map<String, Value> =
            self.settings.iter().map(|(parameter, value)| (parameter.name.into(), number_or_word(value))).collect();
        let mut object = Map::new();
        object.insert("case".into(), json!(self.case.name));
        object.insert("version".into(), json!(env!("CARGO_PKG_VERSION")));
        object.insert("parameters".into(), Value::Object(parameters));
        object.insert("seed".into(), json!(self.settings.seed));
        object.insert("clock".into(), json!(self.case.clock(&self.settings).name()));
        for figure in figures {
            object.insert(figure.key.into(), json!(figure.value));
            for (of, value) in [("standard_error", figure.standard_error), ("theory", figure.theory)] {
                if let Some(value) = value {
                    object.insert(format!("{}_{of}", figure.key), json!(value));
                }
            }
        }
        format!("{:#}\n", Value::Object(object))
    }

    fn for_people(&self, figures: &[Figure]) -> String {
        let mut out = format!("{}, seed {}\n", self.case.name, self.settings.seed);
        // Writing into a string cannot fail.
        let values: Vec<String> = self
            .settings
            .iter()
            .map(|(parameter, value)| format!("{} {value}{}", words(parameter.name), unit(parameter)))
            .collect();
        let _ = writeln!(out, "{}; {}\n", values.join(", "), self.case.clock(&self.settings).name());
        let rows: Vec<Vec<String>> = figures
            .iter()
            .map(|figure| {
                let value = match figure.standard_error {
                    Some(error) if error.is_finite() => plain(&rounded(figure.value, Some(error))),
                    Some(_) => format!("{} (too short for an error)", significant(figure.value, 4)),
                    None => significant(figure.value, 4),
                };
                let theory = figure.theory.map_or(String::new(), |theory| format!("theory {}", significant(theory, 5)));
                vec![words(figure.key), value, theory]
            })
            .collect();
        out + &table(&[Align::Left, Align::Left, Align::Left], &rows)
    }
}

fn words(key: &str) -> String {
    key.replace('_', " ")
}

fn unit(parameter: &Parameter) -> String {
    if parameter.unit.is_empty() { String::new() } else { format!(" {}", parameter.unit) }
}

/// Choices such as the dimension are numbers to a program where they look like one.
fn number_or_word(value: &corpuscle_bench::Value) -> Value {
    let text = value.to_string();
    serde_json::from_str(&text).unwrap_or_else(|_| json!(text))
}
