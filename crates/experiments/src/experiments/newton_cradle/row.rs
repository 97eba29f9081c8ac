//! The row of pendulums, from contact to contact.

use std::f64::consts::TAU;

use corpuscle_checkpoint::resume;
use corpuscle_core::{Failure, Invalid};

/// Contacts within a millionth of a period after which the row counts as stuck.
const STUCK: u32 = 1_000_000;

/// Most that a hand lifts a ball, in diameters: about the length of its string.
const FARTHEST: f64 = 8.0;

/// Pendulums of period 1 whose balls have diameter 1, at rest a gap apart. Displacements count from each ball's own place.
#[derive(Clone)]
pub(super) struct Row {
    masses: Vec<f64>,
    restitution: f64,
    gap: f64,
    /// Displacements and velocities at the time `since` of the last contact.
    displacement: Vec<f64>,
    velocity: Vec<f64>,
    since: f64,
    now: f64,
    contacts: u64,
    /// Speed with which the last ball left first.
    last_speed: f64,
    overlap: f64,
    crowd: u32,
}

resume!(Row {
    values: [displacement, velocity, since, now, contacts, last_speed, overlap, crowd],
    set_up: [masses, restitution, gap]
});

impl Row {
    /// Balls let go at these displacements.
    pub(super) fn new(masses: Vec<f64>, displacement: Vec<f64>, gap: f64, restitution: f64) -> Self {
        let velocity = vec![0.0; masses.len()];
        Self {
            masses,
            restitution,
            gap,
            displacement,
            velocity,
            since: 0.0,
            now: 0.0,
            contacts: 0,
            last_speed: 0.0,
            overlap: 0.0,
            crowd: 0,
        }
    }

    pub(super) fn masses(&self) -> &[f64] {
        &self.masses
    }

    pub(super) fn restitution(&self) -> f64 {
        self.restitution
    }

    pub(super) fn time(&self) -> f64 {
        self.now
    }

    pub(super) fn contacts(&self) -> u64 {
        self.contacts
    }

    pub(super) fn last_speed(&self) -> f64 {
        self.last_speed
    }

    /// Deepest overlap seen, over the diameter.
    pub(super) fn overlap(&self) -> f64 {
        self.overlap
    }

    /// Displacement and velocity of a ball so long after the last contact: `x cos + (v/omega) sin`.
    fn swung(&self, ball: usize, delay: f64) -> (f64, f64) {
        let (x, v) = (self.displacement[ball], self.velocity[ball]);
        let (sine, cosine) = libm::sincos(TAU * delay);
        (x * cosine + v / TAU * sine, v * cosine - TAU * x * sine)
    }

    pub(super) fn places(&self) -> Vec<f64> {
        (0..self.masses.len()).map(|ball| self.swung(ball, self.now - self.since).0).collect()
    }

    pub(super) fn velocities(&self) -> Vec<f64> {
        (0..self.masses.len()).map(|ball| self.swung(ball, self.now - self.since).1).collect()
    }

    /// `sum m (v^2 + omega^2 x^2)/2`: the same at any time between two contacts.
    pub(super) fn energy(&self) -> f64 {
        let of_ball = |i: usize| self.velocity[i] * self.velocity[i] + TAU * TAU * self.displacement[i] * self.displacement[i];
        0.5 * (0..self.masses.len()).map(|i| self.masses[i] * of_ball(i)).sum::<f64>()
    }

    /// The same of the centre of mass with all mass.
    pub(super) fn centre_energy(&self) -> f64 {
        let mass: f64 = self.masses.iter().sum();
        let mean = |values: &[f64]| values.iter().zip(&self.masses).map(|(x, m)| m * x).sum::<f64>() / mass;
        let (x, v) = (mean(&self.displacement), mean(&self.velocity));
        0.5 * mass * (v * v + TAU * TAU * x * x)
    }

    /// Brings all balls to the present, as at a contact.
    fn settle(&mut self) {
        (self.displacement, self.velocity) = (self.places(), self.velocities());
        (self.since, self.crowd) = (self.now, 0);
    }

    /// Carries a ball to a displacement, as far as its neighbours let it.
    ///
    /// # Errors
    /// For a ball that is not there or a displacement that is no number.
    pub(super) fn place(&mut self, ball: usize, displacement: f64) -> Result<(), Invalid> {
        self.known(ball, displacement)?;
        self.settle();
        let least = if ball == 0 { -FARTHEST } else { self.displacement[ball - 1] - self.gap };
        let most = if ball + 1 == self.masses.len() { FARTHEST } else { self.displacement[ball + 1] + self.gap };
        self.displacement[ball] = displacement.max(least).min(most);
        Ok(())
    }

    /// Gives a ball another velocity.
    ///
    /// # Errors
    /// As [`place`](Self::place).
    pub(super) fn throw(&mut self, ball: usize, velocity: f64) -> Result<(), Invalid> {
        self.known(ball, velocity)?;
        self.settle();
        self.velocity[ball] = velocity;
        Ok(())
    }

    /// Reverses all velocities.
    pub(super) fn reverse(&mut self) {
        self.settle();
        self.velocity.iter_mut().for_each(|v| *v = -*v);
    }

    fn known(&self, ball: usize, number: f64) -> Result<(), Invalid> {
        if ball >= self.masses.len() {
            return Err(Invalid::new("body", ball, format!("an index below {}", self.masses.len())));
        }
        if number.is_finite() { Ok(()) } else { Err(Invalid::new("place", number, "a finite number")) }
    }

    /// Delay from the last contact to the next one of a ball with its right neighbour: the gap is
    /// `G + a cos + b sin = G + R cos(omega t - delta)`, and closes where `omega t = delta + arccos(-G/R)`.
    fn delay(&self, left: usize) -> Option<f64> {
        let a = self.displacement[left + 1] - self.displacement[left];
        let b = (self.velocity[left + 1] - self.velocity[left]) / TAU;
        // Rounding left them touching: they meet at once if they approach, by more than rounding.
        if self.gap + a <= 1e-15 && b < 0.0 {
            return Some(0.0);
        }
        let r = (a * a + b * b).sqrt();
        if r <= self.gap {
            return None;
        }
        let angle = libm::atan2(b, a) + libm::acos(-self.gap / r);
        let angle = if angle <= 0.0 {
            angle + TAU
        } else if angle > TAU {
            angle - TAU
        } else {
            angle
        };
        Some(angle / TAU)
    }

    /// The next contact: its delay, and the left one of the two.
    fn next(&self) -> Option<(f64, usize)> {
        let delays = (0..self.masses.len() - 1).filter_map(|left| Some((self.delay(left)?, left)));
        delays.min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Time of the next contact.
    pub(super) fn next_contact(&self) -> Option<f64> {
        self.next().map(|(delay, _)| self.since + delay)
    }

    /// # Errors
    /// [`Failure`] when contacts do not come to an end.
    pub(super) fn advance(&mut self, to: f64) -> Result<(), Failure> {
        while let Some((delay, left)) = self.next().filter(|(delay, _)| self.since + delay <= to) {
            let state: Vec<(f64, f64)> = (0..self.masses.len()).map(|ball| self.swung(ball, delay)).collect();
            for (ball, (x, v)) in state.into_iter().enumerate() {
                (self.displacement[ball], self.velocity[ball]) = (x, v);
            }
            self.since += delay;
            self.crowd = if delay < 1e-6 { self.crowd + 1 } else { 0 };
            if self.crowd > STUCK {
                return Err(Failure {
                    time: self.since,
                    particle: Some(left),
                    cause: "contacts without end: raise the restitution or the gap".into(),
                });
            }
            self.meet(left);
        }
        self.now = to.max(self.now);
        Ok(())
    }

    fn meet(&mut self, left: usize) {
        let (m, w) = (self.masses[left], self.masses[left + 1]);
        let approach = self.velocity[left] - self.velocity[left + 1];
        let impulse = (1.0 + self.restitution) * m * w / (m + w) * approach;
        self.velocity[left] -= impulse / m;
        self.velocity[left + 1] += impulse / w;
        self.contacts += 1;
        self.overlap = self.overlap.max(-(self.gap + self.displacement[left + 1] - self.displacement[left]));
        if left + 2 == self.masses.len() && self.last_speed == 0.0 {
            self.last_speed = self.velocity[left + 1];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two equal pendulums far apart in gap: the first contact is where both have swung to, half a diameter each.
    #[test]
    fn a_contact_is_where_the_gap_closes() {
        let mut row = Row::new(vec![1.0, 1.0], vec![-1.0, 1.0], 1.0, 1.0);
        let time = row.next_contact().unwrap();
        // 1 + 2 cos(omega t) = 0 at omega t = 2 pi/3.
        assert!((time - 1.0 / 3.0).abs() < 1e-15);
        row.advance(time).unwrap();
        assert!((row.places()[0] - 0.5).abs() < 1e-15 && row.velocities()[0] < 0.0);
    }

    #[test]
    fn stops_on_the_way_change_nothing() {
        let start = || Row::new(vec![1.0, 2.0, 1.0, 3.0], vec![-2.0, 0.0, 0.0, 0.5], 0.01, 0.9);
        let (mut whole, mut pieces) = (start(), start());
        whole.advance(3.0).unwrap();
        (1..=300).for_each(|k| pieces.advance(f64::from(k) * 0.01).unwrap());
        assert_eq!((whole.places(), whole.velocities()), (pieces.places(), pieces.velocities()));
    }

    #[test]
    fn without_restitution_all_stick_and_swing_on() {
        let mut row = Row::new(vec![1.0; 5], vec![-1.0, 0.0, 0.0, 0.0, 0.0], 1e-6, 0.0);
        row.advance(20.0).unwrap();
        // Each time they come together, velocities even out by halves from ball to ball, down to rounding.
        let excess = row.energy() / row.centre_energy() - 1.0;
        assert!(excess.abs() < 1e-9 && row.contacts() < 20 * 1000, "{excess:e}, {} contacts", row.contacts());
    }
}
