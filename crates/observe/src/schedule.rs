//! When to sample.

/// Sampling times `k interval`, `k = 0, 1, 2, ...`, each computed by one multiplication, so that neither rounding nor the
/// places where a caller stops build up.
///
/// ```
/// use corpuscle_observe::Schedule;
/// let mut schedule = Schedule::new(0.1);
/// let mut times = vec![];
/// while let Some(time) = schedule.due(0.25) {
///     times.push(time);
/// }
/// assert_eq!(times, [0.0, 0.1, 0.2]);
/// assert_eq!(schedule.due(0.3), None); // 3 x 0.1 is a hair above 0.3
/// ```
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Schedule {
    interval: f64,
    next: u64,
}

impl Schedule {
    /// Samples at 0, `interval`, 2 `interval`, ...; never, unless the interval is a positive number.
    pub const fn new(interval: f64) -> Self {
        Self { interval, next: 0 }
    }

    /// The same without the sample at time 0.
    #[must_use]
    pub const fn after_start(mut self) -> Self {
        self.next = 1;
        self
    }

    /// Interval between samples.
    pub const fn interval(&self) -> f64 {
        self.interval
    }

    /// The next sampling time, whether it is due or not.
    pub fn next(&self) -> f64 {
        self.next as f64 * self.interval
    }

    /// Number of sampling times handed out or skipped.
    pub const fn count(&self) -> u64 {
        self.next
    }

    /// Hands out the next sampling time if it is at most `to`. Call until there is none:
    /// `while let Some(time) = schedule.due(to) { engine.advance(time, ...)?; ... }`.
    pub fn due(&mut self, to: f64) -> Option<f64> {
        let time = self.next();
        (self.interval > 0.0 && time <= to).then(|| {
            self.next += 1;
            time
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_callers_stops_leave_no_trace() {
        let collect = |stops: &[f64]| {
            let mut schedule = Schedule::new(0.07);
            let mut times = vec![];
            for &to in stops {
                while let Some(time) = schedule.due(to) {
                    times.push(time.to_bits());
                }
            }
            times
        };
        let stops: Vec<f64> = (0..=1000).map(|k| f64::from(k) * 0.013).collect();
        assert_eq!(collect(&stops), collect(&[13.0]));
        assert_eq!(Schedule::new(0.0).due(1.0), None);
    }
}
