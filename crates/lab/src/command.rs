//! Everything a person can do with one key, and the keys. The list behind `?` is made from this table.

use egui::{Key, Modifiers};

use crate::language::Text;

/// What one key or one button does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Let time pass, or stop it.
    TogglePlay,
    /// One step, and stop.
    Step,
    /// To the next collision, and stop.
    NextEvent,
    /// Reverse all velocities.
    Reverse,
    /// Turn all velocities by small random angles.
    Disturb,
    /// Take all plates out of the box.
    OpenPartitions,
    /// Velocities as arrows, or not.
    Arrows,
    /// Half as fast again.
    Faster,
    /// The other way.
    Slower,
    /// From the start, with the same seed.
    Restart,
    /// From the start, with another seed.
    NewSeed,
    /// Mark this moment on the timeline.
    Remember,
    /// Back to the moment remembered before this time.
    PreviousMoment,
    /// On to the moment remembered after this time.
    NextMoment,
    /// The whole system in view.
    Fit,
    /// Nearer.
    ZoomIn,
    /// Farther.
    ZoomOut,
    /// Other colours for the bodies.
    NextPaint,
    /// The next tool.
    NextTool,
    /// Start, stop and clear the stopwatch.
    Stopwatch,
    /// Record a row in the notebook.
    RecordRow,
    /// The experiment before this one.
    PreviousExperiment,
    /// The one after.
    NextExperiment,
    /// The gallery of experiments.
    Gallery,
    /// Charts.
    Charts,
    /// Checks.
    Checks,
    /// The honesty panel.
    Honesty,
    /// The notebook.
    Notebook,
    /// Show or hide all panels.
    Panels,
    /// Open a scenario file.
    Open,
    /// Save as a scenario file.
    Save,
    /// Record a picture or a film.
    Record,
    /// The next palette.
    Palette,
    /// The next language.
    Language,
    /// Larger text.
    Larger,
    /// Smaller text.
    Smaller,
    /// The list of keys.
    Help,
    /// Close what is open; with nothing open, nothing.
    Close,
    /// Leave.
    Quit,
}

/// A key and what it does.
pub struct Binding {
    /// The keys that do it, of which the first is shown.
    pub keys: &'static [Key],
    /// How the key is written.
    pub shown: &'static str,
    /// Whether Ctrl (Command on a Mac) is held as well.
    pub with_command: bool,
    /// What it does.
    pub command: Command,
    /// The same in words.
    pub text: Text,
}

const fn key(keys: &'static [Key], shown: &'static str, command: Command, text: Text) -> Binding {
    Binding { keys, shown, with_command: false, command, text }
}

const fn control(keys: &'static [Key], shown: &'static str, command: Command, text: Text) -> Binding {
    Binding { keys, shown, with_command: true, command, text }
}

/// All keys, in the order of the list.
pub static BINDINGS: &[Binding] = &[
    key(&[Key::Space], "Space", Command::TogglePlay, Text::DoTogglePlay),
    key(&[Key::Period, Key::ArrowRight], ". →", Command::Step, Text::DoStep),
    key(&[Key::C], "C", Command::NextEvent, Text::DoNextEvent),
    key(&[Key::V], "V", Command::Reverse, Text::DoReverse),
    key(&[Key::D], "D", Command::Disturb, Text::DoDisturb),
    key(&[Key::Plus, Key::Equals], "+", Command::Faster, Text::DoFaster),
    key(&[Key::Minus], "−", Command::Slower, Text::DoSlower),
    key(&[Key::R], "R", Command::Restart, Text::DoRestart),
    key(&[Key::S], "S", Command::NewSeed, Text::DoNewSeed),
    key(&[Key::M], "M", Command::Remember, Text::DoRemember),
    key(&[Key::Comma, Key::ArrowLeft], ", ←", Command::PreviousMoment, Text::DoPreviousMoment),
    key(&[Key::Slash], "/", Command::NextMoment, Text::DoNextMoment),
    key(&[Key::F], "F", Command::Fit, Text::DoFit),
    key(&[Key::PageUp], "PgUp", Command::ZoomIn, Text::DoZoomIn),
    key(&[Key::PageDown], "PgDn", Command::ZoomOut, Text::DoZoomOut),
    key(&[Key::K], "K", Command::NextPaint, Text::DoNextPaint),
    key(&[Key::A], "A", Command::Arrows, Text::DoArrows),
    key(&[Key::O], "O", Command::OpenPartitions, Text::DoOpenPartitions),
    key(&[Key::T], "T", Command::NextTool, Text::DoNextTool),
    key(&[Key::W], "W", Command::Stopwatch, Text::DoStopwatch),
    key(&[Key::N], "N", Command::RecordRow, Text::DoRecordRow),
    key(&[Key::OpenBracket], "[", Command::PreviousExperiment, Text::DoPreviousExperiment),
    key(&[Key::CloseBracket], "]", Command::NextExperiment, Text::DoNextExperiment),
    key(&[Key::G], "G", Command::Gallery, Text::DoGallery),
    key(&[Key::Num1], "1", Command::Charts, Text::DoCharts),
    key(&[Key::Num2], "2", Command::Checks, Text::DoChecks),
    key(&[Key::Num3], "3", Command::Honesty, Text::DoHonesty),
    key(&[Key::Num4], "4", Command::Notebook, Text::DoNotebook),
    key(&[Key::B], "B", Command::Panels, Text::DoPanels),
    control(&[Key::O], "Ctrl O", Command::Open, Text::DoOpen),
    control(&[Key::S], "Ctrl S", Command::Save, Text::DoSave),
    control(&[Key::R], "Ctrl R", Command::Record, Text::DoRecord),
    key(&[Key::P], "P", Command::Palette, Text::DoPalette),
    key(&[Key::L], "L", Command::Language, Text::DoLanguage),
    control(&[Key::Plus, Key::Equals], "Ctrl +", Command::Larger, Text::DoLarger),
    control(&[Key::Minus], "Ctrl −", Command::Smaller, Text::DoSmaller),
    key(&[Key::Questionmark, Key::H, Key::F1], "? H", Command::Help, Text::DoHelp),
    key(&[Key::Escape], "Esc", Command::Close, Text::DoClose),
    control(&[Key::Q], "Ctrl Q", Command::Quit, Text::DoQuit),
];

impl Command {
    /// How its key is written; empty where there is none.
    pub fn key(self) -> &'static str {
        BINDINGS.iter().find(|binding| binding.command == self).map_or("", |binding| binding.shown)
    }
}

/// Takes the commands whose keys were pressed since the last frame.
///
/// Keys held with other modifiers are not meant; Shift only makes other letters of some keys. While something is typed, only
/// `Esc` is meant; while a button or a slider has the keyboard, space and arrows belong to it.
pub fn pressed(context: &egui::Context) -> Vec<Command> {
    let typing = context.text_edit_focused();
    let focused = context.egui_wants_keyboard_input();
    let meant = |binding: &Binding, key: Key| {
        let to_widget = matches!(key, Key::Space | Key::ArrowLeft | Key::ArrowRight);
        (!typing || binding.command == Command::Close) && !(focused && to_widget)
    };
    context.input(|input| {
        let mut found = vec![];
        for event in &input.events {
            let egui::Event::Key { key, pressed: true, modifiers, repeat, .. } = event else { continue };
            let binding = BINDINGS.iter().find(|binding| {
                binding.keys.contains(key)
                    && binding.with_command == modifiers.command
                    && !modifiers.alt
                    && right_slash(*key, *modifiers)
            });
            if let Some(binding) = binding
                && meant(binding, *key)
                && (!repeat || binding.command.may_repeat())
            {
                found.push(binding.command);
            }
        }
        found
    })
}

/// `?` is Shift with `/` on many keyboards, and some systems report it as such.
fn right_slash(key: Key, modifiers: Modifiers) -> bool {
    key != Key::Slash || !modifiers.shift
}

impl Command {
    /// Whether a key held down does it again and again.
    fn may_repeat(self) -> bool {
        matches!(self, Self::Step | Self::NextEvent | Self::Faster | Self::Slower | Self::ZoomIn | Self::ZoomOut)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_key_does_two_things() {
        for (place, a) in BINDINGS.iter().enumerate() {
            for b in &BINDINGS[place + 1..] {
                assert!(a.command != b.command, "{:?} is bound twice", a.command);
                let shared = a.keys.iter().find(|key| b.keys.contains(key));
                assert!(shared.is_none() || a.with_command != b.with_command, "{shared:?}");
            }
        }
    }
}
