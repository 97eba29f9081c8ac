//! Which particle's event comes next: a calendar queue with one entry a particle.

use crate::lanes::prefetch;

const NONE: u32 = u32::MAX;
/// Stands for the previous entry of one that is in no list.
const OUT: u32 = u32::MAX - 1;

/// A bounded-increasing priority queue (Paul, J. Comput. Phys. 221, 615 (2007), doi:10.1016/j.jcp.2006.06.042).
///
/// Time is cut into days of equal width, about one event each. The events of each day of this year form an unsorted list,
/// threaded through the particles; only those of today are sorted. Events after the end of the year wait in one list that
/// is dealt out when the next year begins. Every operation is `O(1)` and allocates nothing. Events at the same time come
/// in the order of their particles' ranks, so the sequence of events depends on no detail of the queue.
#[derive(Clone, Debug)]
pub(crate) struct Calendar {
    entries: Vec<Entry>,
    /// Decides among events at the same time.
    ranks: Vec<u32>,
    /// First particle of each day's list, then of the list of far events.
    heads: Vec<u32>,
    /// Today's events, the latest first.
    today: Vec<(f64, u32)>,
    days_per_time: f64,
    day: u64,
    year_end: u64,
    /// How many events lie in lists of days, and how many beyond them.
    near: usize,
    far: usize,
    /// Events taken since the days were last fitted, and the day it was.
    taken: u64,
    fitted: u64,
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    time: f64,
    next: u32,
    previous: u32,
}

impl Calendar {
    /// An empty calendar for this many particles.
    pub(crate) fn new(particles: usize) -> Self {
        let days = (2 * particles).next_power_of_two().clamp(64, 1 << 30);
        Self {
            entries: vec![Entry { time: f64::INFINITY, next: NONE, previous: OUT }; particles],
            ranks: (0..particles as u32).collect(),
            heads: vec![NONE; days + 1],
            today: Vec::with_capacity(64),
            days_per_time: 1.0,
            day: 0,
            year_end: days as u64,
            near: 0,
            far: 0,
            taken: 0,
            fitted: 0,
        }
    }

    /// Replaces all entries by these times and ranks, and fits the width of the days to them: one event a day on average.
    pub(crate) fn fill(&mut self, now: f64, times: impl Iterator<Item = (f64, u32)>) {
        for ((entry, rank), (time, its_rank)) in self.entries.iter_mut().zip(&mut self.ranks).zip(times) {
            *rank = its_rank;
            // Adding zero turns a negative zero into a positive one.
            entry.time = time + 0.0;
        }
        self.fit(now);
    }

    fn fit(&mut self, now: f64) {
        // Waiting times are nearly exponential: their median is ln 2 of the mean.
        let mut waits: Vec<f64> =
            self.entries.iter().map(|e| e.time - now).filter(|wait| wait.is_finite() && *wait > 0.0).collect();
        if !waits.is_empty() {
            let (middle, count) = (waits.len() / 2, waits.len() as f64);
            let median = *waits.select_nth_unstable_by(middle, f64::total_cmp).1;
            self.days_per_time = (count * std::f64::consts::LN_2 / median).clamp(1e-300, 1e300);
        }
        self.today.clear();
        self.heads.fill(NONE);
        (self.near, self.far, self.taken) = (0, 0, 0);
        self.day = self.day_of(now);
        self.fitted = self.day;
        self.year_end = self.day.saturating_add(self.days());
        for i in 0..self.entries.len() {
            let time = self.entries[i].time;
            if time < f64::INFINITY && self.day_of(time) <= self.day {
                self.entries[i].previous = NONE;
                self.today.push((time, i as u32));
            } else {
                self.place(i as u32);
            }
        }
        self.sort_today();
    }

    /// Sets the time of a particle's next event; infinity for none.
    #[inline]
    pub(crate) fn schedule(&mut self, i: u32, time: f64) {
        self.unlink(i);
        self.entries[i as usize].time = time + 0.0;
        self.place(i);
    }

    /// Takes the earliest event if it is not later than `until`.
    #[inline]
    pub(crate) fn take(&mut self, until: f64) -> Option<(f64, u32)> {
        loop {
            if let Some(&(time, i)) = self.today.last() {
                if time > until {
                    return None;
                }
                self.today.pop();
                self.entries[i as usize].previous = OUT;
                self.taken += 1;
                return Some((time, i));
            }
            if self.near + self.far == 0 || self.day >= self.day_of(until) {
                return None;
            }
            self.turn_the_page();
        }
    }

    #[inline]
    pub(crate) fn day(&self) -> u64 {
        self.day
    }

    /// Visits particles whose events come up on a day of this year: what to get ready.
    #[inline]
    pub(crate) fn scout(&self, day: u64, mut visit: impl FnMut(usize)) {
        let mut i = self.heads[(day & (self.days() - 1)) as usize];
        for _ in 0..4 {
            if i == NONE {
                break;
            }
            visit(i as usize);
            i = self.entries[i as usize].next;
        }
    }

    /// Asks for the first entry of a day.
    #[inline]
    pub(crate) fn prefetch(&self, day: u64) {
        let head = self.heads[(day & (self.days() - 1)) as usize];
        if head != NONE {
            prefetch(&self.entries, head as usize);
        }
    }

    #[inline]
    fn turn_the_page(&mut self) {
        self.day = if self.near == 0 { self.year_end } else { self.day + 1 };
        if self.day >= self.year_end {
            self.begin_year();
        }
        let slot = (self.day & (self.days() - 1)) as usize;
        let mut i = std::mem::replace(&mut self.heads[slot], NONE);
        while i != NONE {
            let entry = self.entries[i as usize];
            self.today.push((entry.time, i));
            self.near -= 1;
            i = entry.next;
        }
        self.sort_today();
    }

    /// The latest first.
    #[inline]
    fn sort_today(&mut self) {
        if self.today.len() > 16 {
            let ranks = &self.ranks;
            self.today.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then_with(|| ranks[b.1 as usize].cmp(&ranks[a.1 as usize])));
            return;
        }
        for sorted in 1..self.today.len() {
            let mut at = sorted;
            while at > 0 && self.before(self.today[at - 1], self.today[at]) {
                self.today.swap(at - 1, at);
                at -= 1;
            }
        }
    }

    #[inline]
    fn before(&self, a: (f64, u32), b: (f64, u32)) -> bool {
        a.0 < b.0 || (a.0 == b.0 && self.ranks[a.1 as usize] < self.ranks[b.1 as usize])
    }

    /// Every far event lies at or beyond the end of the last year: those of the new year go to their days.
    #[cold]
    fn begin_year(&mut self) {
        let days = self.day - self.fitted;
        if self.taken > 4 * days || (4 * self.taken < days && days > 4 * self.entries.len() as u64) {
            // Today is empty, and nothing is earlier.
            self.fit(self.day as f64 / self.days_per_time);
            return;
        }
        let last = self.heads.len() - 1;
        let mut i = std::mem::replace(&mut self.heads[last], NONE);
        if self.near == 0 {
            // Nothing in between: straight on to the first far event.
            let mut first = f64::INFINITY;
            let mut j = i;
            while j != NONE {
                first = first.min(self.entries[j as usize].time);
                j = self.entries[j as usize].next;
            }
            self.day = self.day.max(self.day_of(first));
        }
        self.year_end = self.day.saturating_add(self.days());
        self.far = 0;
        while i != NONE {
            let next = self.entries[i as usize].next;
            self.place(i);
            i = next;
        }
    }

    #[inline]
    fn days(&self) -> u64 {
        self.heads.len() as u64 - 1
    }

    #[inline]
    fn day_of(&self, time: f64) -> u64 {
        (time * self.days_per_time) as u64
    }

    #[inline]
    fn place(&mut self, i: u32) {
        let time = self.entries[i as usize].time;
        if time == f64::INFINITY {
            self.entries[i as usize].previous = OUT;
            return;
        }
        let day = self.day_of(time);
        if day <= self.day {
            self.entries[i as usize].previous = NONE;
            let at = if self.today.len() > 16 {
                self.today.partition_point(|&later| !self.before(later, (time, i)))
            } else {
                let mut at = self.today.len();
                while at > 0 && self.before(self.today[at - 1], (time, i)) {
                    at -= 1;
                }
                at
            };
            self.today.insert(at, (time, i));
            return;
        }
        let list = if day < self.year_end {
            self.near += 1;
            (day & (self.days() - 1)) as usize
        } else {
            self.far += 1;
            self.heads.len() - 1
        };
        let next = std::mem::replace(&mut self.heads[list], i);
        if next != NONE {
            self.entries[next as usize].previous = i;
        }
        let entry = &mut self.entries[i as usize];
        (entry.next, entry.previous) = (next, NONE);
    }

    #[inline]
    fn unlink(&mut self, i: u32) {
        let Entry { time, next, previous } = self.entries[i as usize];
        if previous == OUT {
            return;
        }
        let day = self.day_of(time);
        if day <= self.day {
            if let Some(at) = self.today.iter().rposition(|&(_, j)| j == i) {
                self.today.remove(at);
            }
            return;
        }
        if next != NONE {
            self.entries[next as usize].previous = previous;
        }
        let near = day < self.year_end;
        if previous != NONE {
            self.entries[previous as usize].next = next;
        } else if near {
            let slot = (day & (self.days() - 1)) as usize;
            self.heads[slot] = next;
        } else {
            let last = self.heads.len() - 1;
            self.heads[last] = next;
        }
        if near {
            self.near -= 1;
        } else {
            self.far -= 1;
        }
    }

    /// Particles it has room for.
    pub(crate) fn len(&self) -> usize {
        self.entries.len()
    }

    /// Bytes held.
    pub(crate) fn memory(&self) -> usize {
        self.entries.capacity() * size_of::<Entry>() + (self.ranks.capacity() + self.heads.capacity()) * size_of::<u32>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_core::Random;

    /// Against a plain search through all entries, with waits over twelve orders of magnitude, ties and infinities.
    #[test]
    fn events_come_in_order_whatever_their_spacing() {
        let mut random = Random::new(1, 0);
        for n in [1usize, 2, 7, 100] {
            let mut draw = |now: f64| match random.below(8) {
                0 => f64::INFINITY,
                1 => now,
                2 => now.ceil(),
                3 => now + 1e6 * random.uniform(),
                4 => now + 1e-6 * random.uniform(),
                _ => now + random.uniform(),
            };
            let mut times: Vec<f64> = (0..n).map(|_| draw(0.0)).collect();
            let mut calendar = Calendar::new(n);
            calendar.fill(0.0, times.iter().copied().zip(0..));
            let mut now = 0.0;
            for step in 0..20_000 {
                let until = if step % 3 == 0 { now + 0.01 } else { f64::MAX };
                let first = (0..n).min_by(|&a, &b| times[a].total_cmp(&times[b])).unwrap();
                let expected = (times[first] <= until).then_some((times[first], first as u32));
                assert_eq!(calendar.take(until), expected, "step {step} of {n} particles");
                now = if expected.is_some() { times[first] } else { now };
                for i in [first, step % n] {
                    if i != first || expected.is_some() {
                        times[i] = draw(now);
                        calendar.schedule(i as u32, times[i]);
                    }
                }
                if times.iter().all(|t| t.is_infinite()) {
                    times[0] = now + 1.0;
                    calendar.schedule(0, times[0]);
                }
            }
        }
    }
}
