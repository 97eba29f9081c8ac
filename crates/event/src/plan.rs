//! What a particle is going to do next.

use crate::calendar::Due;
use crate::piston::MovingPiston;
use crate::search::Meet;

/// The next events of one particle: its earliest collision with another, and what it meets alone.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Plan {
    /// Its earliest collision, if the partner's own time is still `since`: then its flight has not changed.
    pub(crate) pair: Meet,
    pub(crate) since: f64,
    /// When it touches a surface: which one the engine notes apart, where there are any.
    pub(crate) surface_time: f64,
    /// When it leaves its cell, or its box.
    pub(crate) exit_time: f64,
    pub(crate) exit: Exit,
    /// How many contacts it has had at the same instant.
    pub(crate) stuck: u16,
    /// Counts the changes of this particle's flight.
    pub(crate) stamp: u32,
    /// Who the particle is to the outside, and its mass: kept here since every contact reads this line.
    pub(crate) id: u32,
    pub(crate) mass: f64,
}

impl Plan {
    pub(crate) fn idle(id: usize, mass: f64) -> Self {
        Self {
            pair: Meet::NEVER,
            since: 0.0,
            surface_time: f64::INFINITY,
            exit_time: f64::INFINITY,
            exit: Exit(0),
            stuck: 0,
            stamp: 0,
            id: id as u32,
            mass,
        }
    }

    /// When its earliest event is due, and its rank among events at the same time.
    #[inline]
    pub(crate) fn due(&self) -> Due {
        (self.next_time(), self.id)
    }

    #[inline]
    fn next_time(&self) -> f64 {
        let alone = if self.exit_time < self.surface_time { self.exit_time } else { self.surface_time };
        if self.pair.time < alone { self.pair.time } else { alone }
    }
}

/// When the next event of each particle is due, and behind the particles that of the piston: what the calendar asks.
#[inline]
pub(crate) fn due<'a>(plans: &'a [Plan], piston: Option<&'a MovingPiston>) -> impl Fn(u32) -> Due + use<'a> {
    move |i| match plans.get(i as usize) {
        Some(plan) => plan.due(),
        None => (piston.map_or(f64::INFINITY, MovingPiston::next_time), i),
    }
}

/// Through which face a particle leaves its cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exit(u16);

impl Exit {
    /// `level`: the class of sizes in whose grid the cell is; `around`: the face is a periodic face of the box.
    #[inline]
    pub(crate) fn new(level: usize, axis: usize, up: bool, around: bool) -> Self {
        Self((level << 8 | axis << 2 | usize::from(up) << 1 | usize::from(around)) as u16)
    }
    #[inline]
    pub(crate) fn level(self) -> usize {
        usize::from(self.0 >> 8)
    }
    #[inline]
    pub(crate) fn axis(self) -> usize {
        usize::from(self.0 >> 2 & 0x3f)
    }
    #[inline]
    pub(crate) fn up(self) -> bool {
        self.0 & 2 != 0
    }
    #[inline]
    pub(crate) fn around(self) -> bool {
        self.0 & 1 != 0
    }
}
