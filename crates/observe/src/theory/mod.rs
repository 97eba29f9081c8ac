//! The formulas that measurements are held against, each with its source and its limits.

mod brownian;
pub mod hard_discs;
mod hard_spheres;
mod waves;

pub use brownian::{
    closed_box_displacement, contact_value_of_tracer, diffusion_coefficient, initial_friction, ornstein_uhlenbeck_displacement,
    ornstein_uhlenbeck_velocity_correlation,
};
pub use hard_spheres::{
    closed_flux_factor, collision_rate, compressibility, contact_value, excess_chemical_potential, finite_size_shift,
    mean_free_path, mean_speed, packing_fraction, reduced_compressibility, self_diffusion, speed_of_sound, speed_through_hole,
    wall_hit_rate,
};
pub use waves::{
    chain_dispersion, chain_energy_reflection, chain_group_velocity, chain_wave_number, long_wave_speed, membrane_frequency,
    reflection, transmission, verlet_frequency,
};
