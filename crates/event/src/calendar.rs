//! Which particle's event comes next: a calendar queue that looks into the plans instead of deleting.

/// A bounded-increasing priority queue (Paul, J. Comput. Phys. 221, 615 (2007), doi:10.1016/j.jcp.2006.06.042) with months
/// of several events.
///
/// Time is cut into months of equal width. Each month of this year has a list of particles that may have an event then;
/// only the events of the current month are sorted. Particles whose events come after the end of the year wait in one
/// list that is dealt out when the next year begins.
///
/// Nothing is ever deleted. When an event is planned the particle is noted in its month; whether the note still holds is
/// seen in the particle's plan (`due(particle)`: its next event and its rank) when the month begins, and once more when
/// the event comes up. So to schedule is to append one number to a list, at any distance from the present, and a month
/// that begins reads its particles' plans in one sweep, which memory can deliver side by side.
///
/// The queue relies on this: whenever `due(i)` changes, [`schedule`](Self::schedule) is called before the next
/// [`take`](Self::take). Every operation is `O(1)`, and none allocates once the lists have grown. Events at the same time
/// come in the order of their ranks, so the sequence of events depends on no detail of the queue.
#[derive(Clone, Debug)]
pub(crate) struct Calendar {
    /// Particles noted for each month of a year, a power of two, by the number of the month modulo their number.
    months: Vec<Vec<u32>>,
    far: Vec<u32>,
    /// The events of this month, the latest first.
    coming: Vec<Entry>,
    months_per_time: f64,
    month: u64,
    year_end: u64,
    /// How many notes lie in the months to come.
    noted: usize,
    /// Particles, and how many of their events a month is meant to hold.
    particles: usize,
    events_in_month: f64,
    /// Events taken since the months were last fitted, and the month it was.
    taken: u64,
    fitted: u64,
}

/// When an event is due, the rank of its particle, and the particle: in one number, so that it is compared at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Entry(u128);

impl Entry {
    #[inline]
    fn new(time: f64, rank: u32, particle: u32) -> Self {
        // The bits of numbers that are not negative are in the order of the numbers, those of negative ones the other way.
        let bits = (time + 0.0).to_bits() as i64;
        let ordered = (bits ^ ((bits >> 63) as u64 >> 1) as i64) as u64 ^ 1 << 63;
        Self(u128::from(ordered) << 64 | u128::from(rank) << 32 | u128::from(particle))
    }
    #[inline]
    fn time(self) -> f64 {
        let ordered = ((self.0 >> 64) as u64 ^ 1 << 63) as i64;
        f64::from_bits((ordered ^ ((ordered >> 63) as u64 >> 1) as i64) as u64)
    }
    #[inline]
    fn particle(self) -> u32 {
        self.0 as u32
    }
}

/// When the next event of a particle is due, infinity for never; and its rank.
pub(crate) type Due = (f64, u32);

impl Calendar {
    /// An empty calendar for this many particles.
    pub(crate) fn new(particles: usize) -> Self {
        // As in a radix sort of two passes: so both the lists' ends and a month's events stay in the processor's cache.
        let events_in_month = particles.isqrt().max(1);
        let months = (2 * particles / events_in_month).next_power_of_two().max(16);
        Self {
            months: vec![vec![]; months],
            far: vec![],
            coming: Vec::with_capacity(4 * events_in_month),
            months_per_time: 1.0,
            month: 0,
            year_end: months as u64,
            noted: 0,
            particles,
            events_in_month: events_in_month as f64,
            taken: 0,
            fitted: 0,
        }
    }

    /// Forgets everything, notes all particles anew, and fits the width of the months to their events.
    pub(crate) fn fill(&mut self, now: f64, due: impl Fn(u32) -> Due) {
        // Waiting times are nearly exponential: their median is ln 2 of the mean.
        let mut waits: Vec<f64> =
            (0..self.particles as u32).map(|i| due(i).0 - now).filter(|wait| wait.is_finite() && *wait > 0.0).collect();
        if !waits.is_empty() {
            let (middle, count) = (waits.len() / 2, waits.len() as f64);
            let median = *waits.select_nth_unstable_by(middle, f64::total_cmp).1;
            let rate = count * std::f64::consts::LN_2 / median;
            self.months_per_time = (rate / self.events_in_month).clamp(1e-300, 1e300);
        }
        self.coming.clear();
        self.far.clear();
        self.months.iter_mut().for_each(Vec::clear);
        (self.noted, self.taken) = (0, 0);
        self.month = self.month_of(now);
        self.fitted = self.month;
        self.year_end = self.month.saturating_add(self.months.len() as u64);
        for i in 0..self.particles as u32 {
            self.note(i, due(i));
        }
        self.sort();
    }

    /// Says that the next event of a particle is now due at another time; infinity for never.
    #[inline]
    pub(crate) fn schedule(&mut self, i: u32, due: Due) {
        if self.month_of(due.0) <= self.month {
            let entry = Entry::new(due.0, due.1, i);
            let at = self.coming.partition_point(|&later| later > entry);
            self.coming.insert(at, entry);
        } else {
            self.note(i, due);
        }
    }

    /// Takes the earliest event if it is not later than `until`.
    #[inline]
    pub(crate) fn take(&mut self, until: f64, due: impl Fn(u32) -> Due) -> Option<(f64, u32)> {
        loop {
            while let Some(&entry) = self.coming.last() {
                let (time, i) = (entry.time(), entry.particle());
                // Particles are noted more than once, and have been given other plans.
                if due(i).0 != time {
                    self.coming.pop();
                    continue;
                }
                if time > until {
                    return None;
                }
                self.coming.pop();
                self.taken += 1;
                return Some((time, i));
            }
            if self.noted + self.far.len() == 0 || self.month >= self.month_of(until) {
                return None;
            }
            self.turn_the_page(&due);
        }
    }

    #[inline(never)]
    fn turn_the_page(&mut self, due: &impl Fn(u32) -> Due) {
        self.month = if self.noted == 0 { self.year_end } else { self.month + 1 };
        if self.month >= self.year_end {
            self.begin_year(due);
        }
        let slot = self.slot(self.month);
        let mut notes = std::mem::take(&mut self.months[slot]);
        self.noted -= notes.len();
        for &i in &notes {
            let (time, rank) = due(i);
            if self.month_of(time) == self.month {
                self.coming.push(Entry::new(time, rank, i));
            }
        }
        notes.clear();
        self.months[slot] = notes;
        self.sort();
    }

    /// Everything noted for the last year is over: what is due in the new one goes to its months.
    #[cold]
    fn begin_year(&mut self, due: &impl Fn(u32) -> Due) {
        let events = (self.month - self.fitted) as f64 * self.events_in_month;
        if self.taken as f64 > 4.0 * events || (4.0 * (self.taken as f64) < events && events > 4.0 * self.particles as f64) {
            // This month is over, and nothing is earlier.
            return self.fill(self.month as f64 / self.months_per_time, due);
        }
        let mut far = std::mem::take(&mut self.far);
        far.sort_unstable();
        far.dedup();
        // Straight on to the first event.
        let first = far.iter().map(|&i| due(i).0).fold(f64::INFINITY, f64::min);
        self.month = self.month.max(self.month_of(first));
        self.year_end = self.month.saturating_add(self.months.len() as u64);
        for i in far {
            self.note(i, due(i));
        }
    }

    /// Notes a particle for the month of its event.
    #[inline]
    fn note(&mut self, i: u32, due: Due) {
        if due.0 == f64::INFINITY {
            return;
        }
        let month = self.month_of(due.0);
        if month <= self.month {
            self.coming.push(Entry::new(due.0, due.1, i));
        } else if month < self.year_end {
            let slot = self.slot(month);
            let notes = &mut self.months[slot];
            if notes.len() == notes.capacity() {
                // Doubled, the lists would be half empty.
                notes.reserve_exact(notes.len() / 8 + 8);
            }
            notes.push(i);
            self.noted += 1;
        } else {
            self.far.push(i);
        }
    }

    /// The latest first, each once.
    fn sort(&mut self) {
        self.coming.sort_unstable_by(|a, b| b.cmp(a));
        self.coming.dedup();
    }

    #[inline]
    fn slot(&self, month: u64) -> usize {
        (month & (self.months.len() as u64 - 1)) as usize
    }

    #[inline]
    fn month_of(&self, time: f64) -> u64 {
        (time * self.months_per_time) as u64
    }

    /// The number of the current month.
    #[inline]
    pub(crate) fn month(&self) -> u64 {
        self.month
    }

    /// The particle of the event so many places after the next one, if it comes this month.
    #[inline]
    pub(crate) fn coming(&self, places: usize) -> Option<usize> {
        let at = self.coming.len().checked_sub(1 + places)?;
        Some(self.coming[at].particle() as usize)
    }

    /// Bytes held.
    pub(crate) fn memory(&self) -> usize {
        let notes = self.far.capacity() + self.months.iter().map(Vec::capacity).sum::<usize>();
        notes * size_of::<u32>() + self.months.capacity() * size_of::<Vec<u32>>() + self.coming.capacity() * size_of::<Entry>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_core::Random;

    /// Against a plain search through all events, with waits over twelve orders of magnitude, ties and infinities.
    #[test]
    fn events_come_in_order_whatever_their_spacing() {
        let mut random = Random::new(1, 0);
        for n in [1usize, 2, 7, 100, 1000] {
            let mut draw = |now: f64| match random.below(8) {
                0 => f64::INFINITY,
                1 => now,
                2 => now.ceil(),
                3 => now + 1e6 * random.uniform(),
                4 => now + 1e-6 * random.uniform(),
                _ => now + random.uniform(),
            };
            let mut times: Vec<f64> = (0..n).map(|_| draw(-3.0)).collect();
            let mut calendar = Calendar::new(n);
            // Ranks in the opposite order.
            let due = |times: &[f64], i: u32| (times[i as usize], (n as u32) - i);
            calendar.fill(-3.0, |i| due(&times, i));
            let mut now = -3.0;
            for step in 0..20_000 {
                let until = if step % 3 == 0 { now + 0.01 } else { f64::MAX };
                let first = (0..n).rev().min_by(|&a, &b| times[a].total_cmp(&times[b])).unwrap();
                let expected = (times[first] <= until).then_some((times[first], first as u32));
                assert_eq!(calendar.take(until, |i| due(&times, i)), expected, "step {step} of {n} particles");
                now = if expected.is_some() { times[first] } else { now };
                for i in [first, step % n] {
                    if i != first || expected.is_some() {
                        times[i] = draw(now);
                        calendar.schedule(i as u32, due(&times, i as u32));
                    }
                }
                if times.iter().all(|t| t.is_infinite()) {
                    times[0] = now + 1.0;
                    calendar.schedule(0, due(&times, 0));
                }
            }
        }
    }

    #[test]
    fn entries_are_in_the_order_of_times_and_then_of_ranks() {
        let times = [-1e300, -2.0, -1.0, -1e-300, 0.0, 1e-300, 1.0, 1.0f64.next_up(), 1e300, f64::INFINITY];
        for pair in times.windows(2) {
            assert!(Entry::new(pair[0], 7, 9) < Entry::new(pair[1], 3, 1));
            assert!(Entry::new(pair[0], 3, 9) < Entry::new(pair[0], 7, 1));
            assert_eq!(Entry::new(pair[0], 7, 9).time(), pair[0]);
        }
        assert_eq!(Entry::new(-0.0, 1, 2), Entry::new(0.0, 1, 2));
    }
}
