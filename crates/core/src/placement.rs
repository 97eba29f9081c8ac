//! How systems start: places without overlap, velocities at a temperature.

mod close_packed;

pub use close_packed::close_packed;

use crate::{Axis, Boundary, Invalid, Particles, Random, Vector};

/// Sites searched, beyond a few a particle, before a region counts as full: point particles would allow any number.
const MOST_SITES: usize = 1 << 20;

/// Places for `count` spheres of one radius on a square (cubic) lattice that fills the box evenly.
///
/// The lattice is the coarsest with at least `count` sites; which sites stay empty is drawn from `random`.
/// `keep` refuses sites, for instance those inside another body.
///
/// # Errors
/// When the box is too small for the lattice: names how many would fit.
pub fn lattice<const D: usize>(
    boundary: &Boundary<D>,
    count: usize,
    radius: f64,
    random: &mut Random,
    mut keep: impl FnMut(Vector<D>) -> bool,
) -> Result<Vec<Vector<D>>, Invalid> {
    boundary.validate()?;
    let room = Vector::<D>::from_fn(|k| boundary.extent()[k] - if boundary.axes[k] == Axis::Walls { 2.0 * radius } else { 0.0 });
    // Across walls the outermost sites may touch them: n sites need (n - 1) spacings. Periodic images need all n.
    let sites_along = |k: usize, spacing: f64| -> f64 {
        let free = if boundary.axes[k] == Axis::Walls { room[k] + spacing } else { room[k] };
        (free / spacing * (1.0 + 1e-12)).floor()
    };
    let most: f64 = (0..D).map(|k| if room[k] < 0.0 { 0.0 } else { sites_along(k, 2.0 * radius.max(1e-9)) }).product();
    let volume: f64 = boundary.volume();
    // The volume of a box may overflow where its sides do not.
    let longest = boundary.extent().0.into_iter().fold(0.0, f64::max);
    let mut spacing = libm::pow(volume / count.max(1) as f64, 1.0 / D as f64).min(longest);
    while spacing >= 2.0 * radius && spacing > 0.0 {
        let sides: [usize; D] = std::array::from_fn(|k| sites_along(k, spacing).max(0.0) as usize);
        let sites = sides.iter().try_fold(1usize, |product, &n| product.checked_mul(n)).unwrap_or(usize::MAX);
        if sites > MOST_SITES.saturating_add(count.saturating_mul(4)) {
            break;
        }
        if sites >= count {
            let mut sites = lattice_sites(boundary, room, radius, sides);
            sites.retain(|&site| keep(site));
            if sites.len() >= count {
                random.shuffle(&mut sites);
                sites.truncate(count);
                return Ok(sites);
            }
        }
        if spacing <= 2.0 * radius {
            break;
        }
        spacing = (spacing * 0.99).max(2.0 * radius);
    }
    let expected = if most < count as f64 {
        format!("at most about {most:?} of radius {radius:?}: the box is too small for more")
    } else {
        "fewer, or another box: this one is too long and thin for so many, or too full of other things".into()
    };
    Err(Invalid::new("particles", count, expected))
}

fn lattice_sites<const D: usize>(boundary: &Boundary<D>, room: Vector<D>, radius: f64, sides: [usize; D]) -> Vec<Vector<D>> {
    let total: usize = sides.iter().product();
    (0..total)
        .map(|mut number| {
            Vector::from_fn(|k| {
                let (n, place) = (sides[k], number % sides[k]);
                number /= n;
                let walls = boundary.axes[k] == Axis::Walls;
                if walls && n > 1 {
                    boundary.lower[k] + radius + room[k] * place as f64 / (n - 1) as f64
                } else {
                    let start = boundary.lower[k] + if walls { radius } else { 0.0 };
                    start + room[k] * (place as f64 + 0.5) / n as f64
                }
            })
        })
        .collect()
}

/// Gives every particle with mass a velocity from the Maxwell distribution at `temperature`: each component normal with
/// variance `T / m`.
///
/// With `exact`, total momentum is then set to zero and the kinetic temperature to exactly `temperature`, with
/// `D (N - 1)` degrees of freedom: the start of a microcanonical run in a periodic box.
pub fn maxwell<const D: usize>(particles: &mut Particles<D>, temperature: f64, exact: bool, random: &mut Random) {
    for (velocity, &mass) in particles.velocity.iter_mut().zip(&particles.mass) {
        let spread = if mass > 0.0 { (temperature / mass).sqrt() } else { 0.0 };
        *velocity = Vector::from_fn(|_| spread * random.normal());
    }
    if exact && particles.len() > 1 {
        stop_drift(particles);
        let scale = (temperature / particles.temperature(D * (particles.len() - 1))).sqrt();
        if scale.is_finite() {
            particles.velocity.iter_mut().for_each(|v| *v = *v * scale);
        }
    }
}

/// Takes the velocity of the centre of mass off every particle.
pub fn stop_drift<const D: usize>(particles: &mut Particles<D>) {
    let mass: f64 = particles.mass.iter().sum();
    let drift = particles.momentum() / mass;
    if drift.is_finite() {
        particles.velocity.iter_mut().for_each(|v| *v -= drift);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lattices_do_not_overlap_up_to_close_square_packing() {
        for (walls, count) in [(Axis::Walls, 100), (Axis::Periodic, 100), (Axis::Walls, 37), (Axis::Periodic, 1)] {
            let room = Boundary::<2>::new([0.0; 2], [10.0; 2], walls);
            let places = lattice(&room, count, 0.5, &mut Random::new(1, 0), |_| true).unwrap();
            let mut particles = Particles::new();
            for place in places {
                particles.push(place, Vector::ZERO, 1.0, 0.5, 0);
            }
            assert_eq!(particles.len(), count);
            room.validate_particles(&particles).unwrap();
        }
    }

    #[test]
    fn a_box_too_small_is_refused_with_the_number_that_fits() {
        let room = Boundary::<2>::new([0.0; 2], [10.0; 2], Axis::Walls);
        let error = lattice(&room, 101, 0.5, &mut Random::new(1, 0), |_| true).unwrap_err();
        assert!(error.expected.contains("100"), "{error}");
    }

    /// It once said that more would fit than were asked for.
    #[test]
    fn a_box_too_thin_for_a_lattice_is_not_called_too_small() {
        let room = Boundary::<2>::new([0.0; 2], [1e300, 40.0], Axis::Walls);
        let error = lattice(&room, 200, 0.5, &mut Random::new(1, 0), |_| true).unwrap_err();
        assert!(error.expected.contains("long and thin"), "{error}");
    }

    #[test]
    fn exact_maxwell_has_no_drift_and_the_temperature_asked_for() {
        let mut particles = Particles::<3>::new();
        for i in 0..50 {
            particles.push(Vector::ZERO, Vector::ZERO, 1.0 + f64::from(i % 3), 0.5, 0);
        }
        maxwell(&mut particles, 2.5, true, &mut Random::new(3, 0));
        assert!(particles.momentum().norm() < 1e-12);
        assert!((particles.temperature(3 * 49) - 2.5).abs() < 1e-13);
    }
}
