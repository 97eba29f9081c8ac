//! One large particle among many small ones: sizes so unequal that a single width of cells suits neither.

use std::f64::consts::PI;
use std::ops::ControlFlow;

use corpuscle_core::particles::ball_volume;
use corpuscle_core::placement::{lattice, maxwell};
use corpuscle_core::{Boundary, Contact, Meeting, Observer, Particles, Random, Vector};
use corpuscle_event::{EventDriven, Rules};
use corpuscle_experiments::{Kind, Parameter, Settings};
use corpuscle_observe::{CollisionRate, theory};

use super::gas;
use crate::{Case, Figure, SECONDS, Trouble};

pub(crate) static CASE: Case = Case {
    name: "brownian",
    summary: "One large particle in a bath of small ones, event-driven: collisions per second.",
    parameters: &[
        gas::DIMENSION,
        Parameter {
            name: "particles",
            unit: "",
            help: "Number of particles of the bath.",
            kind: Kind::Whole { default: 100_000, least: 2, most: 100_000_000 },
        },
        Parameter {
            name: "packing",
            unit: "",
            help: "Packing fraction of all particles together.",
            kind: Kind::Real { default: 0.30, least: 1e-6, most: 0.6 },
        },
        Parameter {
            name: "radius_ratio",
            unit: "",
            help: "Radius of the large particle over that of the small ones; all are of one material.",
            kind: Kind::Real { default: 30.0, least: 1.0, most: 60.0 },
        },
        SECONDS,
    ],
    run: |settings| if settings.word("dimension") == "2" { run::<2>(settings) } else { run::<3>(settings) },
};

/// Index of the large particle.
const TRACER: usize = 0;

/// Counts the collisions of the large particle only.
struct OfTracer(CollisionRate);

impl<const D: usize> Observer<D> for OfTracer {
    fn begin(&mut self, time: f64, particles: &Particles<D>) {
        self.0.begin(time, particles);
    }

    #[inline]
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        match contact.with {
            Meeting::Pair(second) if contact.first.index == TRACER || second.index == TRACER => self.0.contact(contact),
            _ => ControlFlow::Continue(()),
        }
    }

    fn finish(&mut self, time: f64, particles: &Particles<D>) {
        self.0.finish(time, particles);
    }
}

fn run<const D: usize>(settings: &Settings) -> Result<Vec<Figure>, Trouble> {
    let (count, packing, ratio) = (settings.whole("particles"), settings.real("packing"), settings.real("radius_ratio"));
    let radius = 0.5 * ratio;
    let mass = ratio.powi(D as i32);
    let boundary = Boundary::<D>::periodic(gas::side::<D>((count as f64 + mass) * gas::unit_ball::<D>(), packing));
    let (volume, middle) = (boundary.volume(), (boundary.lower + boundary.upper) * 0.5);
    let mut random = Random::new(settings.seed, 0);
    let mut particles = Particles::new();
    particles.push(middle, Vector::ZERO, mass, radius, 1);
    let clear = |site| boundary.displacement(site, middle).norm() >= radius + 0.5;
    for place in lattice(&boundary, count, 0.5, &mut random, clear)? {
        particles.push(place, Vector::ZERO, 1.0, 0.5, 0);
    }
    maxwell(&mut particles, 1.0, true, &mut random);
    let mut engine = EventDriven::new(boundary, particles, Rules::default())?;

    let contact = radius + 0.5;
    let density = count as f64 / (volume - ball_volume::<D>(contact));
    let bath = theory::packing_fraction::<D>(density, 1.0);
    let chi = theory::contact_value_of_tracer::<D>(bath, 0.5, radius);
    // The flux n sqrt(kT / (2 pi mu)) of the relative motion through the sphere of contact.
    let surface = if D == 2 { 2.0 * PI * contact } else { 4.0 * PI * contact * contact };
    let expected = density * chi * surface * ((1.0 + 1.0 / mass) / (2.0 * PI)).sqrt();

    let rate = theory::collision_rate::<D>(density, 1.0, 1.0, 1.0);
    // A pair counts for two particles: this way each collision counts once.
    let mut tracer = OfTracer(CollisionRate::new(2, 4.0 / expected));
    let mut figures = gas::measure(&mut engine, &mut tracer, settings.real("seconds"), rate)?;
    figures.push(Figure::measured("collisions_of_large_particle_per_time", tracer.0.rate(), Some(expected)));
    Ok(figures)
}
