//! A plain window on a scene that an application keeps in motion.

mod keys;
mod screen;

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use corpuscle_scene::{Camera, Palette, Scene};
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalPosition;
use winit::event::{ElementState, KeyEvent, MouseButton, MouseScrollDelta, WindowEvent};
use winit::event_loop::{ActiveEventLoop, EventLoop};
use winit::window::WindowId;

pub use keys::Action;
use keys::{Command, HELP};
use screen::Screen;

use crate::navigate::{dragged, zoomed};
use crate::{Projection, RenderError, View, platform};

/// How a window opens.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Text of the title bar.
    pub title: String,
    /// Width in points.
    pub width: u32,
    /// Height in points.
    pub height: u32,
    /// Colours, until the viewer changes them.
    pub palette: Palette,
}

impl Default for Options {
    fn default() -> Self {
        Self { title: "Corpuscle".into(), width: 1280, height: 800, palette: Palette::Dark }
    }
}

/// What goes on in the window: usually a simulation.
pub trait WindowApp {
    /// Brings `scene` up to date, `elapsed_wall` seconds of the viewer's time after the last call; `Break` closes the
    /// window. The first call, with 0, fills the scene.
    fn frame(&mut self, elapsed_wall: f64, scene: &mut Scene) -> ControlFlow<()>;

    /// The viewer has asked for something that concerns the simulation.
    fn act(&mut self, action: Action);
}

/// Time between two pictures where the screen does not set the pace.
const INTERVAL: Duration = Duration::from_micros(16_667);

/// Whether there is a display, and whether the libraries are there that windows are made with: toolkits panic over some.
///
/// # Errors
/// [`RenderError::NoDisplay`] where there is no screen; [`RenderError::Missing`] names a library to install.
pub fn check() -> Result<(), RenderError> {
    platform::display::check_libraries()
}

/// Opens a window and returns when it is closed.
///
/// # Errors
/// [`RenderError::NoDisplay`] where there is no screen; [`RenderError::Missing`] names a library to install;
/// [`RenderError::Context`] when there is no OpenGL; and whatever drawing meets.
pub fn view(options: Options, app: impl WindowApp) -> Result<(), RenderError> {
    check()?;
    let events = EventLoop::new().map_err(|fault| RenderError::NoDisplay { cause: fault.to_string() })?;
    let palette = options.palette;
    let mut viewer = Viewer {
        options,
        app,
        scene: Scene::default(),
        view: View::new(1, 1).palette(palette),
        screen: None,
        cursor: [0.0; 2],
        dragging: false,
        last: None,
        next: Instant::now(),
        fault: None,
    };
    events.run_app(&mut viewer).map_err(|fault| RenderError::Context(fault.to_string()))?;
    viewer.fault.map_or(Ok(()), Err)
}

struct Viewer<A> {
    options: Options,
    app: A,
    scene: Scene,
    view: View,
    screen: Option<Screen>,
    cursor: [f64; 2],
    dragging: bool,
    /// When the last picture was begun.
    last: Option<Instant>,
    /// When the next one is due.
    next: Instant,
    fault: Option<RenderError>,
}

impl<A: WindowApp> ApplicationHandler for Viewer<A> {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.screen.is_none() {
            match Screen::open(events, &self.options) {
                Ok(screen) => self.screen = Some(screen),
                Err(fault) => self.give_up(events, fault),
            }
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        match event {
            WindowEvent::CloseRequested => events.exit(),
            WindowEvent::RedrawRequested => self.draw(events),
            WindowEvent::KeyboardInput { event: KeyEvent { logical_key, state: ElementState::Pressed, repeat, .. }, .. } => {
                if let Some(command) = keys::command(&logical_key, repeat) {
                    self.obey(events, command);
                }
            }
            WindowEvent::CursorMoved { position: PhysicalPosition { x, y }, .. } => {
                let way = [x - self.cursor[0], y - self.cursor[1]];
                self.cursor = [x, y];
                if self.dragging {
                    self.steer(|camera, projection| dragged(camera, projection, way));
                }
            }
            WindowEvent::MouseInput { state, button: MouseButton::Left, .. } => self.dragging = state == ElementState::Pressed,
            WindowEvent::CursorLeft { .. } => self.dragging = false,
            WindowEvent::MouseWheel { delta, .. } => {
                let notches = match delta {
                    MouseScrollDelta::LineDelta(_, lines) => f64::from(lines),
                    MouseScrollDelta::PixelDelta(way) => way.y / 60.0,
                };
                let cursor = self.cursor;
                self.steer(|camera, projection| zoomed(camera, projection, cursor, 1.2f64.powf(notches)));
            }
            _ => {}
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        let Some(screen) = &self.screen else { return };
        if Instant::now() >= self.next {
            screen.ask_for_a_picture();
        } else {
            events.set_control_flow(winit::event_loop::ControlFlow::WaitUntil(self.next));
        }
    }

    fn exiting(&mut self, _: &ActiveEventLoop) {
        // The context has to go before the display does.
        self.screen = None;
    }
}

impl<A: WindowApp> Viewer<A> {
    fn draw(&mut self, events: &ActiveEventLoop) {
        let now = Instant::now();
        let elapsed = self.last.map_or(0.0, |last| (now - last).as_secs_f64());
        self.last = Some(now);
        self.next = now + INTERVAL;
        if self.app.frame(elapsed, &mut self.scene).is_break() {
            events.exit();
            return;
        }
        // A camera of another kind was meant for another scene.
        let kind = |camera: &Camera| std::mem::discriminant(camera);
        self.view.camera = self.view.camera.filter(|camera| kind(camera) == kind(&self.scene.camera));
        if let Some(screen) = &mut self.screen {
            [self.view.width, self.view.height] = screen.size();
            self.view.scale = screen.scale();
            if let Err(fault) = screen.show(&self.scene, &self.view) {
                self.give_up(events, fault);
            }
        }
    }

    fn obey(&mut self, events: &ActiveEventLoop, command: Command) {
        match command {
            Command::Act(action) => self.app.act(action),
            Command::Help => self.view.card = if self.view.card.is_empty() { HELP } else { &[] },
            Command::Palette => {
                self.view.palette = match self.view.palette {
                    Palette::Dark => Palette::Light,
                    Palette::Light => Palette::Dark,
                };
            }
            Command::Fit => self.view.camera = None,
            Command::Leave => events.exit(),
        }
    }

    fn steer(&mut self, step: impl FnOnce(Camera, &Projection) -> Camera) {
        if let Some(screen) = &self.screen {
            let projection = screen.projection(&self.scene, &self.view);
            self.view.camera = Some(step(self.view.camera.unwrap_or(self.scene.camera), &projection));
        }
    }

    fn give_up(&mut self, events: &ActiveEventLoop, fault: RenderError) {
        self.fault = Some(fault);
        events.exit();
    }
}
