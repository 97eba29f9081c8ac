//! What the keys mean.

use winit::keyboard::{Key, NamedKey};

/// A wish of the viewer that concerns the simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Stop, or go on.
    TogglePause,
    /// One step while paused.
    Step,
    /// Back to the start.
    Reset,
    /// More physical time in a second.
    Faster,
    /// Less physical time in a second.
    Slower,
    /// Turn all velocities round.
    Reverse,
    /// The experiment before this one.
    Previous,
    /// The experiment after this one.
    Next,
}

/// What a key does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Command {
    Act(Action),
    Help,
    Palette,
    Fit,
    Leave,
}

/// The card that explains the keys.
pub(super) const HELP: &[(&str, &str)] = &[
    ("Space", "pause, go on"),
    (".  →", "one step"),
    ("+  −", "faster, slower"),
    ("b", "turn all velocities round"),
    ("r", "reset"),
    ("[  ]", "previous, next"),
    ("Wheel", "zoom about the cursor"),
    ("Drag", "shift the view; turn it in space"),
    ("f  Home", "whole view"),
    ("t", "dark, light"),
    ("h  ?", "this help"),
    ("q  Esc", "leave"),
];

/// The command of a key; while it is held down, only what makes sense again and again is repeated.
pub(super) fn command(key: &Key, repeat: bool) -> Option<Command> {
    let command = match key {
        Key::Named(NamedKey::Space) => Command::Act(Action::TogglePause),
        Key::Named(NamedKey::ArrowRight) => Command::Act(Action::Step),
        Key::Named(NamedKey::Home) => Command::Fit,
        Key::Named(NamedKey::Escape) => Command::Leave,
        Key::Character(text) => match text.as_str() {
            " " => Command::Act(Action::TogglePause),
            "." => Command::Act(Action::Step),
            "r" => Command::Act(Action::Reset),
            "+" | "=" => Command::Act(Action::Faster),
            "-" | "_" => Command::Act(Action::Slower),
            "b" => Command::Act(Action::Reverse),
            "[" => Command::Act(Action::Previous),
            "]" => Command::Act(Action::Next),
            "h" | "?" => Command::Help,
            "t" => Command::Palette,
            "f" => Command::Fit,
            "q" => Command::Leave,
            _ => return None,
        },
        _ => return None,
    };
    let again = matches!(command, Command::Act(Action::Step | Action::Faster | Action::Slower));
    (again || !repeat).then_some(command)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_held_key_steps_on_but_toggles_once() {
        let key = |text: &str| Key::Character(text.into());
        assert_eq!(command(&key("."), true), Some(Command::Act(Action::Step)));
        assert_eq!(command(&Key::Named(NamedKey::Space), true), None);
        assert_eq!(command(&Key::Named(NamedKey::Space), false), Some(Command::Act(Action::TogglePause)));
        assert_eq!(command(&key("?"), false), Some(Command::Help));
        assert_eq!(command(&key("x"), false), None);
    }
}
