//! Equal hard spheres or discs in a periodic cube, from the lattice that packs them closest.

use corpuscle_core::placement::{close_packed, maxwell};
use corpuscle_core::{Boundary, Particles, Random, Vector};
use corpuscle_event::{EventDriven, Rules};
use corpuscle_experiments::{Kind, Parameter, Settings};
use corpuscle_observe::{VirialPressure, blocking, theory};

use super::gas;
use crate::{Case, Figure, SECONDS, Trouble};

pub(crate) static CASE: Case = Case {
    name: "hard-spheres",
    summary: "Equal hard spheres or discs in a periodic box, event-driven: collisions per second.",
    parameters: &[
        gas::DIMENSION,
        Parameter {
            name: "particles",
            unit: "",
            help: "Number of particles; 4 c^3 of them (1372, 10976, 87808, 1000188) fill the face-centred lattice.",
            kind: Kind::Whole { default: 10_976, least: 2, most: 100_000_000 },
        },
        Parameter {
            name: "packing",
            unit: "",
            help: "Packing fraction.",
            kind: Kind::Real { default: 0.49, least: 1e-6, most: 0.9 },
        },
        SECONDS,
    ],
    run: |settings| if settings.word("dimension") == "2" { run::<2>(settings) } else { run::<3>(settings) },
};

/// Time blocks of the virial, in mean free times; those that are correlated are joined in the analysis.
const BLOCK: f64 = 0.05;

fn run<const D: usize>(settings: &Settings) -> Result<Vec<Figure>, Trouble> {
    let (count, packing) = (settings.whole("particles"), settings.real("packing"));
    let boundary = Boundary::<D>::periodic(gas::side::<D>(count as f64 * gas::unit_ball::<D>(), packing));
    let volume = boundary.volume();
    let mut random = Random::new(settings.seed, 0);
    let mut particles = Particles::new();
    for place in close_packed(&boundary, count, 0.5, &mut random)? {
        particles.push(place, Vector::ZERO, 1.0, 0.5, 0);
    }
    maxwell(&mut particles, 1.0, true, &mut random);
    let mut engine = EventDriven::new(boundary, particles, Rules::default())?;

    let rate = theory::collision_rate::<D>(count as f64 / volume, 1.0, 1.0, 1.0);
    let mut virial = VirialPressure::<D>::new(count, volume, 1.0, BLOCK / rate);
    let mut figures = gas::measure(&mut engine, &mut virial, settings.real("seconds"), rate)?;

    let compressibility: Vec<f64> = virial.blocks().iter().map(|pressure| pressure * volume / count as f64).collect();
    // The equations of state are those of the fluid.
    let freezing = if D == 2 { 0.70 } else { 0.494 };
    let expected = (packing <= freezing).then(|| theory::compressibility::<D>(packing));
    figures.push(Figure::measured("compressibility_factor", blocking(&compressibility).trusted(), expected));
    Ok(figures)
}
