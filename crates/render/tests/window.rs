//! A window where there is no screen.
#![cfg(feature = "window")]

use std::ops::ControlFlow;

use corpuscle_render::RenderError;
use corpuscle_render::window::{Action, Options, WindowApp, view};
use corpuscle_scene::Scene;

struct Nothing;

impl WindowApp for Nothing {
    fn frame(&mut self, _: f64, _: &mut Scene) -> ControlFlow<()> {
        ControlFlow::Break(())
    }

    fn act(&mut self, _: Action) {}
}

#[test]
#[cfg(target_os = "linux")]
fn without_a_screen_there_is_a_reason_and_no_panic() {
    if ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"].iter().all(|name| std::env::var_os(name).is_none()) {
        let refused = view(Options::default(), Nothing);
        assert!(matches!(&refused, Err(RenderError::NoDisplay { .. })), "{refused:?}");
    }
}
