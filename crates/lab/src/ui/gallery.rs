//! The experiments, each with a picture of itself.

use corpuscle_io::Scenario;
use corpuscle_render::View;
use egui::{Color32, FontId, Rect, RichText, ScrollArea, Sense, Stroke, StrokeKind, Ui, UiBuilder, pos2, vec2};

use super::{Canvas, Easel};
use crate::language::Text;
use crate::model::Model;
use crate::previews::Previews;
use crate::theme::bold;

/// Narrowest card, in points.
const WIDTH: f32 = 250.0;
const GAP: f32 = 14.0;
/// Height of the words below a picture.
const WORDS: f32 = 96.0;

pub(super) fn show(ui: &mut Ui, model: &mut Model, previews: &Previews, easel: &mut dyn Easel) {
    let area = ui.available_rect_before_wrap().shrink(18.0);
    let mut chosen = None;
    ui.scope_builder(UiBuilder::new().max_rect(area), |ui| {
        ui.label(RichText::new(model.text(Text::GalleryTitle)).font(FontId::new(20.0, bold())));
        ui.add_space(8.0);
        ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
            let width = ui.available_width() - 6.0;
            let registry = model.registry.clone();
            let most = ((width + GAP) / (WIDTH + GAP)).floor().max(1.0) as usize;
            // As many rows as that takes, and in each of them about the same number of cards, all in view where there is room.
            let rows = registry.len().div_ceil(most).max(1);
            let columns = registry.len().div_ceil(rows).max(1);
            let card = (width - GAP * (columns - 1) as f32) / columns as f32;
            let room = (ui.available_height() - GAP * rows as f32) / rows as f32;
            let size = vec2(card, (0.62 * card).min((room - WORDS).max(0.45 * WIDTH)).round() + WORDS);
            for (row, experiments) in registry.chunks(columns).enumerate() {
                ui.horizontal(|ui| {
                    ui.spacing_mut().item_spacing.x = GAP;
                    for (column, experiment) in experiments.iter().enumerate() {
                        let (rect, response) = ui.allocate_exact_size(size, Sense::click());
                        let title = model.language().phrase(experiment.title).into_owned();
                        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &title));
                        let index = row * columns + column;
                        if ui.is_rect_visible(rect) {
                            let lit = response.hovered() || response.has_focus();
                            one(ui, model, rect, index, &title, lit, previews, easel);
                        }
                        if response.clicked() {
                            chosen = Some(Scenario::new(experiment));
                        }
                    }
                });
                ui.add_space(GAP - 6.0);
            }
        });
    });
    if let Some(scenario) = chosen {
        model.run(scenario);
    }
}

#[allow(clippy::too_many_arguments, reason = "private: what a card shows")]
fn one(ui: &Ui, model: &Model, rect: Rect, index: usize, title: &str, lit: bool, previews: &Previews, easel: &mut dyn Easel) {
    let theme = model.preferences.theme;
    let colours = theme.colours();
    let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
    painter.rect_filled(rect, 7.0, colours.panel);
    let picture = Rect::from_min_max(rect.min, pos2(rect.right(), rect.bottom() - WORDS)).shrink(1.0);
    if let Some(scene) = previews.scene(index) {
        let pixels = ui.ctx().pixels_per_point();
        let size = (picture.size() * pixels).round();
        let mut view = View::new((size.x as u32).max(1), (size.y as u32).max(1)).palette(theme.palette());
        (view.scale, view.overlay) = (pixels, false);
        if let Some(texture) = easel.paint(Canvas::Card(index), 0, scene, &view) {
            painter.image(texture, picture, Rect::from_min_max(pos2(0.0, 1.0), pos2(1.0, 0.0)), Color32::WHITE);
        }
    }
    let edge = if lit { Stroke::new(2.0, colours.accent) } else { Stroke::new(1.0, colours.line) };
    painter.rect_stroke(rect, 7.0, edge, StrokeKind::Inside);
    let left = rect.left() + 12.0;
    let heading = painter.layout_no_wrap(title.to_owned(), FontId::new(15.0, bold()), colours.ink);
    let top = picture.bottom() + 9.0;
    painter.galley(pos2(left, top), heading.clone(), colours.ink);
    let summary = model.language().phrase(model.registry[index].summary).into_owned();
    let mut job = egui::text::LayoutJob::simple(summary, FontId::proportional(12.0), colours.quiet, rect.width() - 24.0);
    job.wrap.max_rows = 3;
    let galley = painter.layout_job(job);
    painter.galley(pos2(left, top + heading.size().y + 4.0), galley, colours.quiet);
}
