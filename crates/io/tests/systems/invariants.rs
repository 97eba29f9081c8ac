//! What any system keeps, whatever it is.

use corpuscle_experiments::Frame;
use corpuscle_experiments::free::{System, spec};

use crate::{Sample, draft};

/// What a sound run did.
pub(crate) struct Outcome {
    /// Collisions or steps.
    pub(crate) work: u64,
    /// How often its steps had to be halved.
    pub(crate) halvings: u32,
}

/// Halvings of the step that may be needed.
const MOST_HALVINGS: u32 = 10;

/// Runs a system and looks at everything it should keep, or says what it did not.
///
/// What an integrator does to the energy is its error, which the command reports, and no fault: with the step it goes to zero. So a
/// soft system has to come below the bound of its check as its step is halved, again and again; a force that is not the slope of its
/// energy, or a wall that gives some, never would.
pub(crate) fn hold(mut sample: Sample) -> Result<Outcome, String> {
    for halvings in 0.. {
        let (text, soft) = (sample.text.clone(), sample.system().engine == spec::EngineKind::Time);
        match run(sample) {
            Ok(work) => return Ok(Outcome { work, halvings }),
            Err(Broken::Step(_)) if soft && halvings < MOST_HALVINGS => {
                let steps = |halvings: u32| format!("time_step = {}", draft::TIME_STEP / f64::from(1_u32 << halvings));
                sample =
                    Sample::new(text.replace(&steps(halvings), &steps(halvings + 1))).map_err(|refusal| refusal.to_string())?;
            }
            Err(Broken::Step(broken) | Broken::Other(broken)) => return Err(broken),
        }
    }
    unreachable!("it returns when no halvings are left")
}

/// What is not as it should be.
enum Broken {
    /// What shorter steps may mend: the energy, by more than its check allows, or a particle faster than the box is wide.
    Step(String),
    Other(String),
}

impl From<String> for Broken {
    fn from(what: String) -> Self {
        Self::Other(what)
    }
}

/// Runs a system in uneven pieces. Answers its collisions or steps.
fn run(mut sample: Sample) -> Result<u64, Broken> {
    let mut before = 0.0;
    for piece in 1..=6 {
        let to = 1.5 * f64::from(piece * piece) / 36.0;
        sample.simulation.advance(to).map_err(|failure| match failure.to_string() {
            cause if cause.ends_with("use a smaller dt") => Broken::Step(cause),
            cause => Broken::Other(cause),
        })?;
        let time = sample.simulation.time();
        if time <= before {
            return Err(format!("the clock stands still at {before}").into());
        }
        before = time;
        all_in_the_box(sample.system(), &sample.simulation.frame().unwrap())?;
        if let Some(broken) = sample.simulation.honesty().broken() {
            return Err(broken.into());
        }
    }
    // Energy, with what walls gave, and momentum. Statistical checks are of no use on so short a run.
    if let Some(check) = sample.simulation.checks().into_iter().find(|check| check.z.is_none() && !check.passed) {
        let broken = format!("{}: {:e}, at most {:e}", check.quantity, check.measured, check.expected);
        return Err(if check.quantity.contains("energy") { Broken::Step(broken) } else { Broken::Other(broken) });
    }
    Ok(sample.simulation.honesty().work)
}

/// No particle is anywhere it cannot be.
fn all_in_the_box(system: &System, frame: &Frame) -> Result<(), String> {
    let particles = &frame.particles;
    for k in 0..frame.dimension {
        let walls = match &system.room.faces {
            spec::Faces::All(face) => *face,
            spec::Faces::Each(faces) => faces[k],
        } == spec::Face::Walls;
        let (lower, upper) = (system.room.lower[k], system.room.upper[k]);
        let open = |side: spec::Side| {
            let of_axis = system.walls.iter().find(|wall| wall.axis as usize == k && wall.side == side);
            of_axis.is_some_and(|wall| wall.opened_at.is_some_and(|opened| opened <= frame.time))
        };
        for (i, r) in particles.position.iter().enumerate() {
            if !(r[k].is_finite() && particles.velocity[i][k].is_finite()) {
                return Err(format!("particle {i} is nowhere at t = {}", frame.time));
            }
            if !frame.periodic[k] && !walls {
                continue;
            }
            // Walls hold surfaces, up to rounding.
            let margin = if walls { particles.radius[i] - 1e-9 } else { 0.0 };
            let low = r[k] >= lower + margin || walls && open(spec::Side::Lower);
            let high = r[k] <= upper - margin || walls && open(spec::Side::Upper);
            if !(low && high) {
                return Err(format!("particle {i} at {:?} is outside at t = {}", r.0, frame.time));
            }
        }
    }
    Ok(())
}
