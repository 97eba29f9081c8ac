//! The parts of a step, one by one, for the benches: what each costs alone. No part of the interface.

use crate::calendar::Calendar;
use crate::engine::EventDriven;
use crate::law::{Free, Hard};
use crate::neighbours::Neighbours;
use crate::plan::Exit;
use corpuscle_core::Random;

/// Searches all neighbours of a particle for its next collision.
pub fn search<const D: usize>(engine: &mut EventDriven<D>, i: usize) {
    engine.plan_pair::<Free<Hard>>(i);
}

/// Finds when and where a particle leaves its cell or box.
pub fn exit<const D: usize>(engine: &mut EventDriven<D>, i: usize) {
    engine.plan_exit::<Free<Hard>>(i);
}

/// Gives a particle another place in the grid and collects who is new around it, or gives it a new box and a new list.
pub fn step<const D: usize>(engine: &mut EventDriven<D>, i: usize, up: bool) {
    let place = engine.flights[i].position;
    match &mut engine.neighbours {
        Neighbours::Cells(cells) => {
            let exit = Exit::new(0, 0, up, false);
            cells.step(i, exit);
            cells.collect_new(i, exit, &mut engine.candidates);
        }
        Neighbours::Lists(lists) => lists.move_box(i, place, &engine.images, &mut engine.candidates),
    }
}

/// A calendar on its own: of as many events, with exponential waits.
pub struct Queue {
    calendar: Calendar,
    due: Vec<f64>,
    waits: Vec<f64>,
    taken: usize,
}

impl Queue {
    /// One event for each particle.
    pub fn new(particles: usize) -> Self {
        let mut random = Random::new(1, 0);
        let waits: Vec<f64> = (0..65_536).map(|_| -libm::log(random.uniform())).collect();
        let mut calendar = Calendar::new(particles);
        let due: Vec<f64> = waits.iter().copied().cycle().take(particles).collect();
        calendar.fill(0.0, |i| (due[i as usize], i));
        Self { calendar, due, waits, taken: 0 }
    }

    /// Takes the earliest event and schedules another, and moves the event of a second particle.
    pub fn step(&mut self) {
        let due = &mut self.due;
        if let Some((now, i)) = self.calendar.take(f64::MAX, |i| (due[i as usize], i)) {
            self.taken += 1;
            let wait = |number: usize| self.waits[number % self.waits.len()];
            let (first, second) = (now + wait(self.taken), now + wait(self.taken + 7));
            for (i, time) in [(i, first), ((i + 1) % due.len() as u32, second)] {
                due[i as usize] = time;
                self.calendar.schedule(i, (time, i));
            }
        }
    }
}
