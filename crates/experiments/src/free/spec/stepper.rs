//! How time passes in a soft system.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Integrator, its step, and the heat bath it keeps the particles in.
#[derive(Clone, Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stepper {
    /// Name: one of `Integrator::NAMES`, or of a bath: `langevin`, `brownian`, `stochastic-rescaling`, `nose-hoover`.
    pub name: String,
    /// Time step; the adaptive integrators need none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_step: Option<f64>,
    /// Error of a step that an adaptive integrator allows itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// Temperature of the bath, `k_B T`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature: Option<f64>,
    /// Friction, a rate (`langevin`, `brownian`).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<f64>,
    /// Time in which heat is exchanged (`stochastic-rescaling`, `nose-hoover`).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relaxation_time: Option<f64>,
    /// Thermostats in the chain (`nose-hoover`); 3 when not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub links: Option<u32>,
}
