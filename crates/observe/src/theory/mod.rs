//! The formulas that measurements are held against, each with its source and its limits.

mod brownian;
mod hard_spheres;

pub use brownian::{
    closed_box_displacement, diffusion_coefficient, initial_friction, ornstein_uhlenbeck_displacement,
    ornstein_uhlenbeck_velocity_correlation,
};
pub use hard_spheres::{
    collision_rate, compressibility, contact_value, mean_free_path, mean_speed, packing_fraction, speed_through_hole, wall_hit_rate,
};
