//! Large systems: what the coming events are going to read is asked for in advance, so that nobody waits for memory.

use corpuscle_core::instructions::prefetch;

use crate::engine::EventDriven;
use crate::plan::Exit;
use crate::search::Neighbour;

/// How many events ahead each step is taken. Each step reads what the one before asked for.
const STEPS: [usize; 4] = [16, 12, 8, 4];

/// What the next event of a particle is going to look at.
enum Coming {
    /// All around these two.
    Pair(usize, usize),
    /// What is new beyond a face of this one's cell or box.
    Exit(usize, Exit),
    Other,
}

impl<const D: usize> EventDriven<D> {
    /// More is read than a processor's inner caches hold, so that asking in advance takes less time than it saves.
    pub(crate) fn is_large(&self) -> bool {
        self.flights.len() > 30_000
    }

    /// Asks for what the next events will need; called once an event.
    #[inline]
    pub(crate) fn ask_for_what_is_coming(&mut self) {
        if self.asked_for != self.calendar.month() {
            return self.begin_asking();
        }
        for (step, place) in STEPS.into_iter().enumerate() {
            self.ask(step, place);
        }
    }

    /// A month begins: nothing of its events has been asked for.
    #[inline(never)]
    fn begin_asking(&mut self) {
        self.asked_for = self.calendar.month();
        for (step, places) in STEPS.into_iter().enumerate() {
            (0..=places).for_each(|place| self.ask(step, place));
        }
    }

    /// Takes a step for the event that comes so many places after the next one.
    #[inline]
    fn ask(&mut self, step: usize, place: usize) {
        let Some(i) = self.calendar.coming(place) else { return };
        if step == 0 {
            return prefetch(&self.plans, i);
        }
        match self.coming(i) {
            Coming::Pair(i, j) => self.ask_for_both(step, i, j),
            Coming::Exit(i, exit) => self.ask_beyond(step, i, exit),
            Coming::Other => {}
        }
    }

    #[inline]
    fn coming(&self, i: usize) -> Coming {
        // Behind the particles is the piston.
        let Some(plan) = self.plans.get(i) else { return Coming::Other };
        let (j, time) = (plan.pair.neighbour.slot(), plan.due().0);
        if plan.pair.time == time && j < self.plans.len() {
            Coming::Pair(i, j)
        } else if plan.exit_time == time {
            Coming::Exit(i, plan.exit)
        } else {
            Coming::Other
        }
    }

    #[inline]
    fn ask_for_both(&mut self, step: usize, i: usize, j: usize) {
        match step {
            1 => {
                prefetch(&self.plans, j);
                for k in [i, j] {
                    prefetch(&self.flights, k);
                    self.neighbours.prefetch_place(k);
                }
            }
            2 => [i, j].into_iter().for_each(|k| self.neighbours.prefetch_around(k)),
            _ => {
                for k in [i, j] {
                    for &word in self.neighbours.candidates(k, &mut self.candidates) {
                        prefetch(&self.flights, Neighbour::from_word(word).slot());
                    }
                }
            }
        }
    }

    #[inline]
    fn ask_beyond(&mut self, step: usize, i: usize, exit: Exit) {
        match step {
            1 => {
                prefetch(&self.flights, i);
                self.neighbours.prefetch_place(i);
            }
            2 => self.neighbours.prefetch_beyond(i, exit),
            _ => {
                for &word in self.neighbours.candidates_beyond(i, exit, &mut self.candidates) {
                    self.neighbours.prefetch_candidate(Neighbour::from_word(word).slot(), &self.flights);
                }
            }
        }
    }
}
