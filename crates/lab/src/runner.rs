//! The simulation on its own thread: orders go in, snapshots come out, and the window never waits for either.

pub mod beside;
pub(crate) mod driver;
mod exchange;
pub mod paint;
pub(crate) mod sight;
pub mod snapshot;

use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use corpuscle_io::{Refusal, Scenario};

pub use beside::Side;
use driver::Driver;
pub use driver::Order;
use exchange::{Reader, Writer, exchange};
pub use paint::Paint;
pub use snapshot::{Fault, Measured, Snapshot};

/// What the simulation takes at most between two looks for orders, where it can stop.
const BUDGET: Duration = Duration::from_millis(12);
/// Between two pictures when the engine is ahead of its time.
const FRAME: Duration = Duration::from_millis(15);
/// Most of the viewer's time that passes between two looks: after a sleep of the machine the film goes on, not ahead.
const LONGEST: f64 = 0.1;
/// Between two measurements, at least.
const MEASURE: Duration = Duration::from_millis(250);
/// A measurement may take one part in so many of the time.
const SHARE: u32 = 8;
/// How fast the shown pace follows the measured one, each look.
const SMOOTHING: f64 = 0.08;

/// The simulation's thread as the window sees it.
pub struct Runner {
    orders: Option<Sender<Order>>,
    snapshots: Reader<Snapshot>,
    worker: Option<JoinHandle<()>>,
}

impl Runner {
    /// Starts a scenario on a thread of its own; `wake` is called when there is something new to see.
    ///
    /// # Errors
    /// [`Refusal`] when the scenario cannot be started.
    pub fn start(scenario: Scenario, wake: impl Fn() + Send + 'static) -> Result<Self, Refusal> {
        let mut driver = Driver::new(scenario)?;
        let (orders, inbox) = channel();
        let (mut writer, mut snapshots) = exchange();
        show(&mut driver, &mut writer);
        snapshots.refresh();
        let worker = thread::Builder::new().name("simulation".into()).spawn(move || work(driver, &inbox, writer, &wake));
        // A system without threads left has nothing to run a window with either; the snapshot stays as it is.
        Ok(Self { orders: Some(orders), snapshots, worker: worker.ok() })
    }

    /// Gives an order; it is obeyed when the thread gets to it.
    pub fn order(&self, order: Order) {
        if let Some(orders) = &self.orders {
            // A thread that has gone is noticed by `is_alive`.
            let _ = orders.send(order);
        }
    }

    /// Takes the newest snapshot; whether there was one that had not been seen.
    pub fn refresh(&mut self) -> bool {
        self.snapshots.refresh()
    }

    /// The snapshot last taken.
    pub fn snapshot(&self) -> &Snapshot {
        self.snapshots.value()
    }

    /// Whether the thread still runs; it ends by itself only by a fault of the program.
    pub fn is_alive(&self) -> bool {
        self.worker.as_ref().is_some_and(|worker| !worker.is_finished())
    }
}

impl Drop for Runner {
    fn drop(&mut self) {
        self.orders = None;
        if let Some(worker) = self.worker.take() {
            let _ = worker.join();
        }
    }
}

fn show(driver: &mut Driver, writer: &mut Writer<Snapshot>) {
    driver.look();
    writer.value().copy(driver.seen());
    writer.publish();
}

/// The simulation's thread, until the window is gone.
fn work(mut driver: Driver, orders: &Receiver<Order>, mut writer: Writer<Snapshot>, wake: &dyn Fn()) {
    let mut last = Instant::now();
    let mut measured = Instant::now();
    let mut measuring = Duration::ZERO;
    let mut pace = 1.0;
    let mut waited = Duration::ZERO;
    loop {
        let order =
            if driver.is_busy() { orders.recv_timeout(waited) } else { orders.recv().map_err(|_| RecvTimeoutError::Disconnected) };
        let idle = !driver.is_busy();
        match order {
            Ok(order) => {
                if idle {
                    last = Instant::now();
                }
                driver.obey(order);
                while let Ok(order) = orders.try_recv() {
                    driver.obey(order);
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return,
        }
        let now = Instant::now();
        let elapsed = (now - std::mem::replace(&mut last, now)).as_secs_f64();
        let share = driver.pass(elapsed.min(LONGEST), || now.elapsed() > BUDGET);
        pace += SMOOTHING * (share * (LONGEST / elapsed).min(1.0) - pace);
        driver.set_pace(if driver.travels() { 1.0 } else { pace });
        if driver.is_busy() && measured.elapsed() > MEASURE.max(measuring * SHARE) {
            let started = Instant::now();
            driver.measure();
            measured = Instant::now();
            measuring = measured - started;
        }
        if writer.is_taken() || !driver.is_busy() {
            show(&mut driver, &mut writer);
            wake();
        }
        waited = FRAME.saturating_sub(now.elapsed());
        if driver.travels() {
            waited = Duration::ZERO;
        }
    }
}
