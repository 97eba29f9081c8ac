//! How the chain on show starts.

use corpuscle_core::Invalid;

use super::chain::{Design, Polarisation};
use super::theory::Modes;
use super::{Start, Wave};
use crate::Settings;

impl Wave {
    /// Displacements and velocities at the start.
    pub(super) fn initial(
        settings: &Settings,
        design: &Design,
        start: Start,
        amplitude: f64,
        c: f64,
        x: f64,
    ) -> Result<(Vec<f64>, Vec<f64>), Invalid> {
        let (count, ratio) = (design.count(), settings.real("density_ratio"));
        let places: Vec<f64> = (0..count).map(|n| design.place(n)).collect();
        let (displacement, velocity, strain): (Vec<f64>, Vec<f64>, f64) = match start {
            Start::Pulse { width } => {
                if 20.0 * width > design.length() {
                    let most = design.length() / (20.0 * design.spacing);
                    return Err(
                        settings.invalid("pulse_width", format!("at most a twentieth of the chain, {most}, to start clear"))
                    );
                }
                let u = |x_n: f64| amplitude * libm::exp(-0.5 * (x_n - x) * (x_n - x) / (width * width));
                let displacement = places.iter().map(|&p| u(p)).collect();
                // d'Alembert's wave to the right, u(x - c t): its velocity is -c du/dx.
                let velocity = places.iter().map(|&p| c * (p - x) / (width * width) * u(p)).collect();
                (displacement, velocity, 1.3 * amplitude / width * ratio.sqrt().max(1.0))
            }
            Start::Mode(j) => {
                if ratio != 1.0 {
                    return Err(settings.invalid("density_ratio", "1 for a start in a normal mode, whose shape is then a sine"));
                }
                let highest = Modes::of(design).map_or(0, |modes| modes.highest());
                let modes = Modes::of(design).filter(|_| j <= highest);
                let Some(modes) = modes else {
                    return Err(settings.invalid("mode", format!("a whole number from 1 to {highest}")));
                };
                let displacement = modes.shape(j).iter().map(|s| amplitude * s).collect();
                (displacement, vec![0.0; count], amplitude * modes.phase(j) / design.spacing)
            }
            Start::Drive { angular_frequency } => {
                (vec![0.0; count], vec![0.0; count], 2.0 * amplitude * angular_frequency / c * ratio.sqrt().max(1.0))
            }
        };
        if design.polarisation == Polarisation::Longitudinal && strain >= 1.0 {
            let most = amplitude / strain;
            return Err(settings.invalid("amplitude", format!("less than {most:.4}: longitudinal masses must keep their order")));
        }
        Ok((displacement, velocity))
    }
}
