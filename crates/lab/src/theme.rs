//! Colours, sizes and fonts of the window: dark and light for screens, and one for projectors, where only contrast counts.
//!
//! Verdicts are never told by colour alone. Accents are those of Okabe and Ito, which colour-blind readers tell apart.

use std::sync::Arc;

use corpuscle_scene::{Colour, Palette};
use egui::{Color32, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, Margin, Stroke, TextStyle, Visuals, vec2};
use serde::{Deserialize, Serialize};

use crate::language::Text;

/// A set of colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Theme {
    /// Light ink on a dark ground.
    #[default]
    Dark,
    /// Dark ink on a light ground.
    Light,
    /// Black on white with strong lines and larger text.
    Projector,
}

/// The colours of a theme, by what they are for.
#[derive(Clone, Copy, Debug)]
pub struct Colours {
    /// Behind the stage and the charts.
    pub ground: Color32,
    /// Behind panels.
    pub panel: Color32,
    /// Behind what can be pressed.
    pub raised: Color32,
    /// The same under the pointer.
    pub hovered: Color32,
    /// Thin lines between things.
    pub line: Color32,
    /// Text.
    pub ink: Color32,
    /// Text of less weight.
    pub quiet: Color32,
    /// What is chosen or pressed.
    pub accent: Color32,
    /// Text on what is chosen.
    pub on_accent: Color32,
    /// A check that holds.
    pub good: Color32,
    /// A check that fails, an error.
    pub bad: Color32,
}

impl Theme {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Dark, Self::Light, Self::Projector];

    /// Its name.
    pub fn text(self) -> Text {
        match self {
            Self::Dark => Text::ThemeDark,
            Self::Light => Text::ThemeLight,
            Self::Projector => Text::ThemeProjector,
        }
    }

    /// The next one round.
    #[must_use]
    pub fn next(self) -> Self {
        match self {
            Self::Dark => Self::Light,
            Self::Light => Self::Projector,
            Self::Projector => Self::Dark,
        }
    }

    /// The stage's colours.
    pub fn palette(self) -> Palette {
        if self == Self::Dark { Palette::Dark } else { Palette::Light }
    }

    /// By how much everything is larger than asked for.
    pub fn enlargement(self) -> f32 {
        if self == Self::Projector { 1.15 } else { 1.0 }
    }

    /// A stage's colour by its role, as the window draws it.
    pub fn role(self, colour: Colour) -> Color32 {
        let [r, g, b, a] = self.palette().rgba(colour).map(|c| (255.0 * c).round() as u8);
        Color32::from_rgba_unmultiplied(r, g, b, a)
    }

    /// The window's colours.
    pub fn colours(self) -> Colours {
        let [r, g, b] = self.palette().ground().map(|c| (255.0 * c).round() as u8);
        let ground = Color32::from_rgb(r, g, b);
        let rgb = Color32::from_rgb;
        match self {
            Self::Dark => Colours {
                ground,
                panel: rgb(22, 26, 33),
                raised: rgb(38, 44, 54),
                hovered: rgb(50, 58, 70),
                line: rgb(46, 53, 64),
                ink: rgb(232, 236, 241),
                quiet: rgb(158, 168, 182),
                accent: rgb(86, 180, 233),
                on_accent: rgb(8, 20, 30),
                good: rgb(64, 196, 150),
                bad: rgb(255, 138, 80),
            },
            Self::Light => Colours {
                ground,
                panel: rgb(246, 247, 249),
                raised: rgb(230, 233, 238),
                hovered: rgb(216, 221, 229),
                line: rgb(214, 219, 226),
                ink: rgb(24, 28, 34),
                quiet: rgb(84, 93, 105),
                accent: rgb(0, 98, 155),
                on_accent: Color32::WHITE,
                good: rgb(0, 118, 86),
                bad: rgb(186, 74, 0),
            },
            Self::Projector => Colours {
                ground,
                panel: Color32::WHITE,
                raised: rgb(226, 229, 234),
                hovered: rgb(206, 212, 220),
                line: rgb(120, 128, 138),
                ink: Color32::BLACK,
                quiet: rgb(52, 58, 66),
                accent: rgb(0, 80, 140),
                on_accent: Color32::WHITE,
                good: rgb(0, 100, 70),
                bad: rgb(170, 60, 0),
            },
        }
    }

    /// Width of a line in a chart.
    pub fn stroke(self) -> f32 {
        if self == Self::Projector { 2.6 } else { 1.6 }
    }

    /// Dresses the window.
    pub fn apply(self, context: &egui::Context) {
        let colours = self.colours();
        context.set_theme(if self == Self::Dark { egui::Theme::Dark } else { egui::Theme::Light });
        context.all_styles_mut(|style| {
            style.visuals = self.visuals(&colours);
            style.text_styles = [
                (TextStyle::Small, FontId::new(11.5, FontFamily::Proportional)),
                (TextStyle::Body, FontId::new(13.5, FontFamily::Proportional)),
                (TextStyle::Button, FontId::new(13.5, FontFamily::Proportional)),
                (TextStyle::Monospace, FontId::new(13.0, FontFamily::Monospace)),
                (TextStyle::Heading, FontId::new(17.0, bold())),
            ]
            .into();
            let spacing = &mut style.spacing;
            spacing.item_spacing = vec2(8.0, 6.0);
            spacing.button_padding = vec2(9.0, 4.0);
            spacing.interact_size = vec2(28.0, 26.0);
            spacing.window_margin = Margin::same(14);
            spacing.slider_rail_height = 4.0;
            spacing.scroll = egui::style::ScrollStyle::thin();
            style.interaction.selectable_labels = false;
            style.animation_time = 0.08;
        });
    }

    fn visuals(self, c: &Colours) -> Visuals {
        let mut visuals = if self == Self::Dark { Visuals::dark() } else { Visuals::light() };
        visuals.panel_fill = c.panel;
        visuals.window_fill = c.panel;
        visuals.extreme_bg_color = c.ground;
        visuals.faint_bg_color = c.raised.gamma_multiply(0.5);
        visuals.window_stroke = Stroke::new(1.0, c.line);
        visuals.selection.bg_fill = c.accent;
        visuals.selection.stroke = Stroke::new(1.0, c.on_accent);
        visuals.hyperlink_color = c.accent;
        visuals.warn_fg_color = c.bad;
        visuals.error_fg_color = c.bad;
        visuals.slider_trailing_fill = true;
        visuals.handle_shape = egui::style::HandleShape::Circle;
        visuals.weak_text_color = Some(c.quiet);
        let radius = CornerRadius::same(5);
        let widgets = &mut visuals.widgets;
        for (state, fill, text) in [
            (&mut widgets.noninteractive, c.panel, c.ink),
            (&mut widgets.inactive, c.raised, c.ink),
            (&mut widgets.hovered, c.hovered, c.ink),
            (&mut widgets.active, c.accent, c.on_accent),
            (&mut widgets.open, c.hovered, c.ink),
        ] {
            (state.bg_fill, state.weak_bg_fill, state.corner_radius, state.expansion) = (fill, fill, radius, 0.0);
            state.fg_stroke = Stroke::new(1.0, text);
            state.bg_stroke = Stroke::NONE;
        }
        widgets.noninteractive.bg_stroke = Stroke::new(1.0, c.line);
        if self == Self::Projector {
            widgets.inactive.bg_stroke = Stroke::new(1.0, c.line);
        }
        // Where the keyboard is, must be seen.
        widgets.hovered.bg_stroke = Stroke::new(1.0, c.accent);
        visuals
    }
}

/// The family of headings and verdicts.
pub fn bold() -> FontFamily {
    FontFamily::Name("bold".into())
}

/// The fonts: Noto Sans SC, cut down to what the window says, and DejaVu Sans for mathematics and the world's other letters.
pub fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::empty();
    let mut add = |name: &str, bytes: &'static [u8]| {
        fonts.font_data.insert(name.into(), Arc::new(FontData::from_static(bytes)));
    };
    add("noto", include_bytes!("../fonts/NotoSansSC-Regular.subset.ttf"));
    add("noto-bold", include_bytes!("../fonts/NotoSansSC-SemiBold.subset.ttf"));
    add("dejavu", dejavu::sans::regular());
    let family = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect::<Vec<_>>();
    fonts.families.insert(FontFamily::Proportional, family(&["noto", "dejavu"]));
    fonts.families.insert(FontFamily::Monospace, family(&["noto", "dejavu"]));
    fonts.families.insert(bold(), family(&["noto-bold", "noto", "dejavu"]));
    fonts
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance and contrast as the Web Content Accessibility Guidelines 2.2 define them.
    fn contrast(a: Color32, b: Color32) -> f64 {
        let linear = |c: u8| {
            let c = f64::from(c) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        };
        let luminance = |c: Color32| 0.2126 * linear(c.r()) + 0.7152 * linear(c.g()) + 0.0722 * linear(c.b());
        let (high, low) = (luminance(a).max(luminance(b)), luminance(a).min(luminance(b)));
        (high + 0.05) / (low + 0.05)
    }

    #[test]
    fn all_text_can_be_read() {
        for theme in Theme::ALL {
            let c = theme.colours();
            for (text, ground) in [
                (c.ink, c.panel),
                (c.ink, c.raised),
                (c.ink, c.hovered),
                (c.quiet, c.panel),
                (c.quiet, c.ground),
                (c.on_accent, c.accent),
                (c.good, c.panel),
                (c.bad, c.panel),
                (c.accent, c.panel),
            ] {
                let ratio = contrast(text, ground);
                assert!(ratio >= 4.5, "{theme:?}: {text:?} on {ground:?} has a contrast of {ratio:.2}");
            }
        }
    }
}
