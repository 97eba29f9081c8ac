//! A hand on the chain: plucking and striking.
//!
//! Who plucks a string holds it at one place, and the rest of it goes straight from there to the ends: so much is added to what
//! runs on the chain already, which is linear. A stroke gives one mass another velocity.

use corpuscle_core::{Failure, Invalid};

use super::Wave;
use super::chain::{Chain, Polarisation};
use super::picture::Drawn;
use crate::Action;

/// A copy of the chain in a hand.
pub(super) struct Held {
    pub(super) chain: Chain,
    /// Time of its start, on the measured chain's clock.
    since: f64,
}

impl Held {
    /// Advances to a time on the measured chain's clock.
    ///
    /// # Errors
    /// As [`Chain::advance`].
    pub(super) fn advance(&mut self, to: f64) -> Result<(), Failure> {
        self.chain.advance(to - self.since).map_err(|failure| Failure { time: failure.time + self.since, ..failure })
    }
}

impl Wave {
    /// The chain that is drawn.
    pub(super) fn on_show(&self) -> &Chain {
        self.in_hand.as_ref().map_or(&self.chain, |held| &held.chain)
    }

    /// Plucks or strikes a mass, known by its body in the picture, whose places and velocities are larger than the chain's.
    pub(super) fn touch(&mut self, action: Action) -> Result<(), Invalid> {
        let shown = self.on_show();
        let count = shown.design().count();
        let (mut displacement, mut velocity) = (shown.displacements(), (0..count).map(|n| shown.velocity(n)).collect::<Vec<_>>());
        match action {
            Action::Place { body, at } => {
                let Drawn { mass, axis, rest, scale } = self.drawn(body)?;
                let by = finite((at[axis] - rest) / scale)? - displacement[mass];
                displacement.iter_mut().enumerate().for_each(|(n, u)| *u += by * tent(n, mass, count));
            }
            Action::Throw { body, velocity: thrown } => {
                let Drawn { mass, axis, scale, .. } = self.drawn(body)?;
                velocity[mass] = finite(thrown[axis] / scale)?;
            }
            _ => return action.refused("free particles: the masses of this chain are held by their springs"),
        }
        let design = shown.design().clone();
        let along = design.polarisation == Polarisation::Longitudinal;
        if along && displacement.windows(2).any(|pair| pair[1] - pair[0] <= -design.spacing) {
            return Err(Invalid::new("place", "(on the chain)", "one that leaves the masses in their order"));
        }
        self.in_hand = Some(Held { chain: Chain::new(design, &displacement, &velocity)?, since: self.chain.time() });
        // It is the measured chain's solution.
        self.dalembert = None;
        Ok(())
    }
}

/// Straight from 0 a spacing before the first mass up to 1 at the one that is held, and down again.
fn tent(n: usize, held: usize, count: usize) -> f64 {
    if n <= held { (n + 1) as f64 / (held + 1) as f64 } else { (count - n) as f64 / (count - held) as f64 }
}

fn finite(x: f64) -> Result<f64, Invalid> {
    if x.is_finite() { Ok(x) } else { Err(Invalid::new("place", x, "finite numbers")) }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)] // a test that cannot go on has failed

    use corpuscle_scene::Scene;

    use crate::{Action, Settings, Simulation, find};

    fn started(values: &[(&str, &str)]) -> Box<dyn Simulation> {
        let experiment = find("wave").unwrap();
        let mut settings = Settings::new(experiment.parameters, 1);
        for (key, text) in values {
            settings.set_text(key, text).unwrap();
        }
        (experiment.start)(&settings).unwrap()
    }

    fn heights(simulation: &dyn Simulation) -> Vec<f64> {
        let mut scene = Scene::default();
        simulation.draw(&mut scene);
        scene.bodies.iter().map(|body| body.position[1]).collect()
    }

    /// A plucked mass is where the hand let it go, half a period later it is on the other side of the middle, mirrored
    /// (d'Alembert), and what is measured has not changed by a bit.
    #[test]
    fn a_plucked_string_swings_to_its_mirror_image() {
        let values = [("preset", "fixed-end"), ("masses", "199"), ("pulse_width", "10")];
        let (mut plucked, mut left) = (started(&values), started(&values));
        let body = 149;
        let mut scene = Scene::default();
        plucked.draw(&mut scene);
        let at = [scene.bodies[body].position[0], 0.1 * scene.bodies[198].position[0], 0.0];
        plucked.act(Action::Place { body, at }).unwrap();
        let before = heights(&*plucked);
        assert!((before[body] - at[1]).abs() < 1e-12 * at[1] && (before[99] / at[1] - 2.0 / 3.0).abs() < 0.01);
        // c = 1, the length 200: a period of 400.
        plucked.advance(200.0).unwrap();
        left.advance(200.0).unwrap();
        let after = heights(&*plucked);
        // Only the kink, where the lattice disperses short waves, is blunter by a little.
        let worst = (0..199).map(|n| (after[n] + before[198 - n]).abs()).fold(0.0, f64::max);
        assert!(worst < 0.08 * at[1], "{worst} of {}", at[1]);
        assert_eq!(format!("{:?}", plucked.checks()), format!("{:?}", left.checks()));
    }

    #[test]
    fn longitudinal_masses_keep_their_order_and_shakers_go_on() {
        let mut along = started(&[("preset", "longitudinal")]);
        let places = heights(&*along).len();
        assert!(along.act(Action::Place { body: 10, at: [1e3, 1e5, 0.0] }).is_err());
        assert!(along.act(Action::Place { body: places, at: [0.0; 3] }).is_err());
        along.act(Action::Throw { body: 10, velocity: [0.0, 1.0, 0.0] }).unwrap();
        along.advance(5.0).unwrap();
        let mut driven = started(&[("preset", "shaker")]);
        assert!(driven.act(Action::Place { body: 1, at: [0.0; 3] }).unwrap_err().expected.contains("shaker"));
    }
}
