//! Particles of several masses or radii, each in baths of its own: what friction and diffusion depend on.
//!
//! By Enskog's friction a heavy particle's `D = kT/(M gamma)` goes as the inverse of the contact distance `a` in the plane and of
//! its square in space, and hardly depends on its mass: `gamma` falls as `1/M`, but for the reduced mass.

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::{Failure, Invalid};
use corpuscle_observe::chart::{Axis, Series, Style};
use corpuscle_observe::{Chart, Check, Estimate};
use corpuscle_scene::Scene;

use super::path::Brownian;
use super::set::Set;
use crate::{Action, Frame, Honesty, Probed, Settings, Simulation};

/// Kinds of particles side by side; all are watched for as many relaxation times of their own, on the clock of the first.
pub(super) struct Sweep<const D: usize> {
    kinds: Vec<Brownian<D>>,
    /// Whether the mass is varied, rather than the radius.
    of_mass: bool,
}

resume!(Sweep<const D> { values: [], parts: [kinds], set_up: [of_mass] });

impl<const D: usize> Sweep<D> {
    pub(super) fn new(settings: &Settings, of_mass: bool) -> Result<Self, Invalid> {
        let (key, radius, mass) = (if of_mass { "masses" } else { "radii" }, settings.real("radius"), settings.real("mass"));
        let values = settings.list(key);
        if values.is_empty() {
            return Err(settings.invalid(key, "at least one number"));
        }
        let kind = |(index, &value): (usize, &f64)| {
            let (radius, mass) = if of_mass { (radius, value) } else { (value, mass) };
            Brownian::new(Set::new(settings, radius, mass)?, settings, (index as u64) << 32)
        };
        Ok(Self { kinds: values.iter().enumerate().map(kind).collect::<Result<_, _>>()?, of_mass })
    }

    /// What a kind is known by: its mass, or its contact distance with the bath.
    fn abscissa(&self, set: &Set<D>) -> f64 {
        if self.of_mass { set.mass } else { set.radius + set.bath_radius }
    }

    fn chart(
        &self,
        name: &str,
        title: &str,
        label: &str,
        expected: impl Fn(&Set<D>) -> f64,
        measured: impl Fn(&Brownian<D>) -> Option<Estimate>,
    ) -> Chart {
        let x = if self.of_mass { "mass M" } else { "contact distance a" };
        let points = self.kinds.iter().filter_map(|kind| {
            let value = measured(kind)?;
            Some((self.abscissa(&kind.set), value.mean, value.standard_error))
        });
        let theory = self.kinds.iter().map(|kind| (self.abscissa(&kind.set), expected(&kind.set)));
        Chart::new(name, title, Axis::logarithmic(x, ""), Axis::logarithmic(label, ""))
            .with(Series::new("theory", Style::Theory, theory))
            .with(Series::with_errors("measured", Style::Points, points))
    }
}

impl<const D: usize> Simulation for Sweep<D> {
    fn state(&self) -> Option<&dyn Resume> {
        Some(self)
    }

    fn state_mut(&mut self) -> Option<&mut dyn Resume> {
        Some(self)
    }

    fn time(&self) -> f64 {
        self.kinds[0].time()
    }

    fn end(&self) -> f64 {
        self.kinds[0].end()
    }

    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        let clock = self.kinds[0].end();
        self.kinds.iter_mut().try_for_each(|kind| {
            let end = kind.end();
            // The end is reached exactly, whatever rounding the ratio of the clocks brings.
            kind.advance(if to == clock { end } else { to * (end / clock) })
        })
    }

    fn draw(&self, scene: &mut Scene) {
        self.kinds[0].draw(scene);
    }

    fn frame(&self) -> Option<Frame> {
        self.kinds[0].frame()
    }

    fn charts(&self) -> Vec<Chart> {
        let (diffusion, friction) = if self.of_mass {
            (
                "Heavier particles are slower but more persistent: D hardly depends on the mass.",
                "The friction γ of the velocity falls as the mass grows.",
            )
        } else {
            (
                "A larger particle is hit more often: D falls with its circumference, in space with its surface.",
                "The friction grows with the circumference, in space with the surface.",
            )
        };
        let mut charts = vec![
            self.chart("sweep-diffusion", "Diffusion coefficient", "D", Set::diffusion, Brownian::diffusion).noting(diffusion),
            self.chart(
                "sweep-friction",
                "Friction from the kicks",
                "γ",
                |set| set.friction * set.closed_system_factor(),
                |kind| (kind.elapsed() > 0.0).then(|| kind.friction()),
            )
            .noting(friction),
        ];
        charts.extend(self.kinds[0].charts());
        charts
    }

    fn checks(&self) -> Vec<Check> {
        let names = |check: &mut Check, set: &Set<D>| {
            let (what, value) = if self.of_mass { ("M", set.mass) } else { ("R", set.radius) };
            check.quantity = format!("{what} = {value}: {}", check.quantity);
        };
        let of_kind = |kind: &Brownian<D>| {
            let mut checks = kind.checks();
            for check in &mut checks {
                names(check, &kind.set);
            }
            checks
        };
        self.kinds.iter().flat_map(of_kind).collect()
    }

    fn honesty(&self) -> Honesty {
        let mut all = self.kinds[0].honesty();
        for other in self.kinds[1..].iter().map(Simulation::honesty) {
            all.work += other.work;
            all.rejected_events = all.rejected_events.zip(other.rejected_events).map(|(a, b)| a + b);
            let largest = |a: Option<f64>, b: Option<f64>| a.zip(b).map(|(a, b)| if b > a || b.is_nan() { b } else { a });
            all.energy_drift = largest(all.energy_drift, other.energy_drift);
            all.momentum_drift = largest(all.momentum_drift, other.momentum_drift);
            all.largest_overlap = largest(all.largest_overlap, other.largest_overlap);
        }
        all
    }

    fn moments(&self) -> Vec<f64> {
        self.kinds[0].moments()
    }

    fn next_event(&self) -> Option<f64> {
        self.kinds[0].next_event()
    }

    fn probe(&mut self, corners: Option<[[f64; 2]; 2]>) {
        self.kinds[0].probe(corners);
    }

    fn probed(&self) -> Option<Probed> {
        self.kinds[0].probed()
    }

    fn refusal(&self, action: Action) -> Option<&'static str> {
        self.kinds[0].refusal(action)
    }

    fn act(&mut self, action: Action) -> Result<(), Invalid> {
        self.kinds[0].act(action)
    }
}
