//! The panels, one a file. Each takes the model, and what there is to see, and draws itself; none knows OpenGL.

mod bar;
mod chart;
mod charts;
mod checks;
mod dialogs;
mod gallery;
mod hands;
mod help;
mod hints;
mod honesty;
pub(crate) mod icons;
mod legend;
mod notebook;
mod parameters;
mod related;
mod stage;
mod time;
mod toolbar;
mod widgets;

use corpuscle_render::View;
use corpuscle_scene::Scene;
use egui::{CentralPanel, Frame, Margin, Panel, ScrollArea, TextureId, Ui};

use crate::command;
use crate::model::{Model, Overlay, Tab};
use crate::previews::Previews;
use crate::runner::Snapshot;

/// Who paints the stage: OpenGL in a window or without one, nobody in tests of the panels.
pub trait Easel {
    /// A picture of a scene, in the texture of this name; none where nobody paints. `look` numbers what is in the scene:
    /// under the same number it is the same.
    fn paint(&mut self, canvas: Canvas, look: u64, scene: &Scene, view: &View) -> Option<TextureId>;
}

/// One of the pictures that a window holds at the same time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Canvas {
    /// The stage.
    Stage,
    /// The same computed another way, beside it.
    Beside,
    /// A card of the gallery.
    Card(usize),
}

/// An easel without a painter.
pub struct Blank;

impl Easel for Blank {
    fn paint(&mut self, _: Canvas, _: u64, _: &Scene, _: &View) -> Option<TextureId> {
        None
    }
}

/// Width of the panel with the parameters, in points.
const LEFT: f32 = 268.0;
/// Narrowest and widest panel with the charts.
const RIGHT: (f32, f32) = (390.0, 620.0);
/// Share of the window's width that the charts get.
const SHARE: f32 = 0.315;

/// Draws the window, and lets keys and pointer change the model.
pub fn show(ui: &mut Ui, model: &mut Model, seen: &Snapshot, previews: &Previews, easel: &mut dyn Easel) {
    for command in command::pressed(ui.ctx()) {
        model.obey(command, seen);
    }
    let colours = model.preferences.theme.colours();
    let panel = Frame::new().fill(colours.panel);
    let edge = |left: i8, right: i8, top: i8, bottom: i8| panel.inner_margin(Margin { left, right, top, bottom });

    Panel::top("bar").frame(edge(14, 10, 7, 7)).show(ui, |ui| bar::show(ui, model, seen));
    Panel::bottom("time").frame(edge(14, 14, 8, 8)).show(ui, |ui| time::show(ui, model, seen));
    if model.panels && model.overlay != Overlay::Gallery {
        let width = (SHARE * ui.ctx().content_rect().width()).clamp(RIGHT.0, RIGHT.1);
        Panel::left("parameters").exact_size(LEFT).resizable(false).frame(edge(14, 8, 10, 8)).show(ui, |ui| {
            parameters::show(ui, model, seen);
        });
        Panel::right("measurement").exact_size(width).resizable(false).frame(edge(12, 10, 10, 8)).show(ui, |ui| {
            checks::tabs(ui, model, seen);
            match model.tab {
                Tab::Charts => charts::show(ui, model, seen),
                Tab::Checks => scrolled(ui, "checks", |ui| checks::show(ui, model, seen)),
                Tab::Honesty => scrolled(ui, "honesty", |ui| honesty::show(ui, model, seen)),
                Tab::Notebook => scrolled(ui, "notebook", |ui| notebook::show(ui, model, seen)),
            }
        });
    }
    CentralPanel::default().frame(Frame::new().fill(colours.ground)).show(ui, |ui| {
        if model.overlay == Overlay::Gallery {
            gallery::show(ui, model, previews, easel);
        } else {
            stage::show(ui, model, seen, easel);
        }
    });
    match model.overlay {
        Overlay::None | Overlay::Gallery => {}
        Overlay::Help => help::show(ui, model),
        Overlay::Open => dialogs::open(ui, model),
        Overlay::Save => dialogs::save(ui, model, seen),
        Overlay::Record => dialogs::record(ui, model, seen),
    }
}

fn scrolled(ui: &mut Ui, name: &str, contents: impl FnOnce(&mut Ui)) {
    ScrollArea::vertical().id_salt(name).auto_shrink([false, false]).show(ui, contents);
}
