//! The window's side of a running experiment. The simulation runs on its own thread: the window never waits for it.

use std::ops::ControlFlow;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, TryRecvError, channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use corpuscle_io::{Registry, Scenario};
use corpuscle_render::window::{Action, Options, WindowApp, view};
use corpuscle_scene::Scene;

use super::driver::Driver;
use crate::console;
use crate::trouble::Trouble;

/// What the simulation takes at most between two pictures, where it can stop: slow engines still show that they live,
/// and hear what the viewer asks for.
const BUDGET: Duration = Duration::from_millis(30);
/// Most of the viewer's time that passes between two pictures: after a sleep of the machine the film goes on, not ahead.
const LONGEST: f64 = 0.25;
/// How long the window waits for its first picture before it opens empty.
const PATIENCE: Duration = Duration::from_secs(2);

/// Opens a window on a scenario and returns when it is closed.
pub(super) fn open(registry: Registry, scenario: Scenario, options: Options) -> Result<(), Trouble> {
    Ok(view(options, Stage::new(Driver::new(registry, scenario)?)?)?)
}

/// What the window asks of the simulation.
enum Order {
    /// The next picture.
    Picture,
    /// What the viewer wants.
    Act(Action),
}

/// The simulation's thread as the window sees it.
struct Stage {
    orders: Sender<Order>,
    scenes: Receiver<Scene>,
    worker: Option<JoinHandle<()>>,
    /// A picture has been ordered and has not come.
    waiting: bool,
    /// Said on the terminal when the window is there.
    greeting: Option<String>,
}

impl Stage {
    fn new(driver: Driver) -> Result<Self, Trouble> {
        let scenario = driver.scenario();
        let greeting = format!("{}, seed {}; h shows the keys\n", scenario.name(), scenario.settings.seed);
        let (orders, inbox) = channel();
        let (outbox, scenes) = channel();
        let worker = thread::Builder::new().name("simulation".into()).spawn(move || work(driver, &inbox, &outbox));
        let worker = worker.map_err(|error| Trouble::Interrupted(format!("no thread for the simulation: {error}")))?;
        Ok(Self { orders, scenes, worker: Some(worker), waiting: false, greeting: Some(greeting) })
    }

    /// The simulation's thread has ended, which it does by itself only when it panics: so does this one.
    fn mourn(&mut self) -> ControlFlow<()> {
        if let Some(Err(panic)) = self.worker.take().map(JoinHandle::join) {
            std::panic::resume_unwind(panic);
        }
        ControlFlow::Break(())
    }
}

/// The simulation's thread, until the window is gone. Time passes by the clock, from one picture to the next.
fn work(mut driver: Driver, orders: &Receiver<Order>, scenes: &Sender<Scene>) {
    let mut scene = Scene::default();
    let mut last = None;
    for order in orders {
        match order {
            Order::Act(action) => {
                driver.act(action);
                if !driver.notice().is_empty() {
                    console::complain(driver.notice());
                }
            }
            Order::Picture => {
                let now = Instant::now();
                let elapsed = last.replace(now).map_or(0.0, |last| (now - last).as_secs_f64());
                driver.pass(elapsed.min(LONGEST), || now.elapsed() > BUDGET);
                driver.draw(&mut scene);
                if scenes.send(scene.clone()).is_err() {
                    return;
                }
            }
        }
    }
}

impl WindowApp for Stage {
    fn frame(&mut self, _: f64, scene: &mut Scene) -> ControlFlow<()> {
        let first = self.greeting.take();
        if let Some(greeting) = &first
            && console::print(greeting).is_err()
        {
            return ControlFlow::Break(());
        }
        if !self.waiting && self.orders.send(Order::Picture).is_err() {
            return self.mourn();
        }
        self.waiting = true;
        let news = match first {
            Some(_) => self.scenes.recv_timeout(PATIENCE).map_err(|error| error == RecvTimeoutError::Disconnected),
            None => self.scenes.try_recv().map_err(|error| error == TryRecvError::Disconnected),
        };
        match news {
            Ok(fresh) => {
                *scene = fresh;
                // The next one is made while this one is drawn.
                self.waiting = self.orders.send(Order::Picture).is_ok();
            }
            Err(true) => return self.mourn(),
            Err(false) => {}
        }
        ControlFlow::Continue(())
    }

    fn act(&mut self, action: Action) {
        // A thread that has gone is noticed at the next picture.
        let _ = self.orders.send(Order::Act(action));
    }
}
