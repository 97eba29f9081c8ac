//! Deeds written down: what a person did to a system, and when, done again at the same times.

use corpuscle_checkpoint::{Fault, Reader, Resume, Writer};
use corpuscle_core::{Failure, Invalid};
use corpuscle_observe::{Chart, Check};
use corpuscle_scene::Scene;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{Action, Frame, Honesty, Probed, Simulation, Table};

/// An action at a physical time.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Deed {
    /// When.
    pub at: f64,
    /// What.
    pub act: Action,
}

/// The simulation, with deeds done to it when their time comes; those of its start are done at once.
///
/// # Errors
/// When times are no numbers, negative or not in order, or a deed at the start cannot be done.
pub fn with_deeds(simulation: Box<dyn Simulation>, deeds: Vec<Deed>) -> Result<Box<dyn Simulation>, Invalid> {
    let mut before = 0.0;
    for (number, deed) in deeds.iter().enumerate() {
        if !(deed.at.is_finite() && deed.at >= before) {
            let expected = format!("a time, {before} or later: deeds stand in the order in which they are done");
            return Err(Invalid::new(format!("deed[{number}].at"), deed.at, expected));
        }
        before = deed.at;
    }
    let reached = simulation.time();
    let mut touched = Touched { simulation, deeds, done: 0, before: None, reached };
    touched.do_what_is_due(reached).map_err(|(number, refused)| Invalid { key: format!("deed[{number}].act"), ..refused })?;
    Ok(Box::new(touched))
}

/// A simulation under hands.
struct Touched {
    simulation: Box<dyn Simulation>,
    deeds: Vec<Deed>,
    /// How many have been done.
    done: usize,
    /// State just before the first of them, from where a checkpoint is taken up: what a hand leaves behind belongs to no
    /// measurement, and need not be known to those who write one down.
    before: Option<Vec<u8>>,
    /// The time asked for last.
    reached: f64,
}

impl Touched {
    /// Does the deeds due at the present time; or says which of them could not be done, and why.
    fn do_what_is_due(&mut self, now: f64) -> Result<(), (usize, Invalid)> {
        while let Some(deed) = self.deeds.get(self.done).filter(|deed| deed.at <= now) {
            if self.before.is_none()
                && let Some(state) = self.simulation.state()
            {
                let mut out = Writer::new();
                state.save(&mut out).map_err(|fault| (self.done, Invalid::new("state", fault, "one that can be written down")))?;
                self.before = Some(out.finish());
            }
            self.simulation.act(deed.act).map_err(|refused| (self.done, refused))?;
            self.done += 1;
        }
        Ok(())
    }
}

impl Resume for Touched {
    fn save(&self, out: &mut Writer) -> Result<(), Fault> {
        out.fields(2)?;
        if let Some(state) = &self.before {
            out.value("touched", &Some(self.reached))?;
            return out.value("before", state);
        }
        out.value("touched", &None::<f64>)?;
        out.part("now", self.simulation.state().ok_or_else(|| Fault::new("a simulation without a state"))?)
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Fault> {
        from.fields(2)?;
        let touched: Option<f64> = from.value("touched")?;
        let state = self.simulation.state_mut().ok_or_else(|| Fault::new("a simulation without a state"))?;
        (self.done, self.before) = (0, None);
        let Some(reached) = touched else {
            from.part("now", state)?;
            self.reached = self.simulation.time();
            return Ok(());
        };
        let before: Vec<u8> = from.value("before")?;
        let mut inner = Reader::new(&before);
        state.load(&mut inner)?;
        inner.end()?;
        self.reached = self.simulation.time();
        self.do_what_is_due(self.reached).map_err(|(number, refused)| Fault::new(format!("deed {number}: {refused}")))?;
        self.advance(reached).map_err(Fault::new)
    }
}

impl Simulation for Touched {
    fn time(&self) -> f64 {
        self.simulation.time()
    }

    fn end(&self) -> f64 {
        self.simulation.end()
    }

    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        while let Some(at) = self.deeds.get(self.done).map(|deed| deed.at).filter(|&at| at <= to) {
            self.simulation.advance(at)?;
            self.do_what_is_due(at).map_err(|(number, refused)| Failure {
                time: at,
                particle: None,
                cause: format!(
                    "deed {number}, to {}, cannot be done: expected {}",
                    self.deeds[number].act.name(),
                    refused.expected
                ),
            })?;
        }
        self.simulation.advance(to)?;
        self.reached = self.reached.max(to);
        Ok(())
    }

    fn draw(&self, scene: &mut Scene) {
        self.simulation.draw(scene);
    }

    fn charts(&self) -> Vec<Chart> {
        self.simulation.charts()
    }

    fn checks(&self) -> Vec<Check> {
        self.simulation.checks()
    }

    fn honesty(&self) -> Honesty {
        self.simulation.honesty()
    }

    fn tables(&self) -> Vec<Table> {
        self.simulation.tables()
    }

    fn moments(&self) -> Vec<f64> {
        self.simulation.moments()
    }

    fn frame(&self) -> Option<Frame> {
        self.simulation.frame()
    }

    fn state(&self) -> Option<&dyn Resume> {
        self.simulation.state().map(|_| self as &dyn Resume)
    }

    fn state_mut(&mut self) -> Option<&mut dyn Resume> {
        if self.simulation.state().is_some() { Some(self) } else { None }
    }

    fn next_event(&self) -> Option<f64> {
        let collision = self.simulation.next_event();
        let deed = self.deeds.get(self.done).map(|deed| deed.at);
        // A deed changes what collides next.
        deed.filter(|&at| collision.is_none_or(|time| at <= time)).or(collision)
    }

    fn probe(&mut self, corners: Option<[[f64; 2]; 2]>) {
        self.simulation.probe(corners);
    }

    fn probed(&self) -> Option<Probed> {
        self.simulation.probed()
    }

    fn refusal(&self, action: Action) -> Option<&'static str> {
        self.simulation.refusal(action)
    }

    fn act(&mut self, action: Action) -> Result<(), Invalid> {
        self.simulation.act(action)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)] // a test that cannot go on has failed

    use super::*;
    use crate::{Settings, find};

    const DEEDS: [Deed; 3] = [
        Deed { at: 0.0, act: Action::Disturb { strength: 0.1, seed: 3 } },
        Deed { at: 2.5, act: Action::Reverse },
        Deed { at: 4.0, act: Action::Throw { body: 1, velocity: [2.0, 0.5, 0.0] } },
    ];

    fn started(name: &str) -> Box<dyn Simulation> {
        let experiment = find(name).unwrap();
        (experiment.start)(&Settings::new(experiment.parameters, 4)).unwrap()
    }

    fn seen(simulation: &dyn Simulation) -> String {
        let mut scene = Scene::default();
        simulation.draw(&mut scene);
        format!("{:?} {:?} {:?}", scene.bodies, simulation.charts(), simulation.checks())
    }

    /// By hand, from the list, and however the way is cut up: the same bits.
    #[test]
    fn deeds_are_done_when_their_time_comes() {
        for name in ["entropy", "brownian", "three-body"] {
            let mut by_hand = started(name);
            for deed in DEEDS {
                by_hand.advance(deed.at).unwrap();
                by_hand.act(deed.act).unwrap();
            }
            by_hand.advance(6.0).unwrap();
            let mut at_once = with_deeds(started(name), DEEDS.to_vec()).unwrap();
            at_once.advance(6.0).unwrap();
            let mut in_pieces = with_deeds(started(name), DEEDS.to_vec()).unwrap();
            (1..=60).for_each(|piece| in_pieces.advance(0.1 * f64::from(piece)).unwrap());
            let [by_hand, at_once, in_pieces] = [&by_hand, &at_once, &in_pieces].map(|simulation| seen(&**simulation));
            assert_eq!(by_hand, at_once, "{name}");
            assert_eq!(at_once, in_pieces, "{name}");
        }
    }

    /// Before, between and after the deeds.
    #[test]
    fn a_checkpoint_is_taken_up_with_what_hands_did() {
        for name in ["entropy", "brownian", "three-body"] {
            let late = DEEDS[1..].to_vec();
            let mut unbroken = with_deeds(started(name), late.clone()).unwrap();
            unbroken.advance(7.0).unwrap();
            for at in [1.0, 3.0, 5.0] {
                let mut first = with_deeds(started(name), late.clone()).unwrap();
                first.advance(at).unwrap();
                let mut out = Writer::new();
                first.state().unwrap().save(&mut out).unwrap();
                let bytes = out.finish();
                let mut second = with_deeds(started(name), late.clone()).unwrap();
                let mut from = Reader::new(&bytes);
                second.state_mut().unwrap().load(&mut from).unwrap();
                from.end().unwrap();
                assert_eq!(second.time(), first.time(), "{name} at {at}");
                second.advance(7.0).unwrap();
                assert_eq!(seen(&*second), seen(&*unbroken), "{name} at {at}");
            }
        }
    }

    #[test]
    fn deeds_out_of_order_or_out_of_reach_are_refused() {
        let refused = |deeds: Vec<Deed>| with_deeds(started("entropy"), deeds).err().unwrap().key;
        assert_eq!(refused(vec![DEEDS[2], DEEDS[1]]), "deed[1].at");
        assert_eq!(refused(vec![Deed { at: -1.0, ..DEEDS[0] }]), "deed[0].at");
        assert_eq!(refused(vec![DEEDS[0], Deed { at: 0.0, act: Action::Throw { body: 9999, velocity: [0.0; 3] } }]), "deed[1].act");
        let impossible = Deed { at: 1.0, act: Action::Push { velocity: [1.0, 0.0, 0.0] } };
        let mut simulation = with_deeds(started("entropy"), vec![impossible]).unwrap();
        let failure = simulation.advance(2.0).unwrap_err();
        assert_eq!((failure.time, simulation.time()), (1.0, 1.0));
        assert!(failure.cause.contains("deed 0, to push the piston, cannot be done"), "{failure}");
    }
}
