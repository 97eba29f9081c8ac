//! Hard disks and spheres of one size: structure, pressure and collisions. All but the kinetic relations are defined in two
//! and three dimensions only; other dimensions do not compile.

use std::f64::consts::PI;

use corpuscle_core::particles::ball_volume;

/// Packing fraction `eta = n v` of particles of this diameter at number density `n`: `n pi s^2/4` or `n pi s^3/6`.
pub fn packing_fraction<const D: usize>(density: f64, diameter: f64) -> f64 {
    density * ball_volume::<D>(0.5 * diameter)
}

/// Radial distribution at contact, `chi = g(s+)`, in the fluid.
///
/// 2-D: `(1 - 7 eta/16) / (1 - eta)^2`, 3-D: `(1 - eta/2) / (1 - eta)^3`: what the virial theorem makes of the equations
/// of state of [`compressibility`]. Good to about a per cent below freezing, `eta = 0.70` and `0.494`; no meaning above.
pub fn contact_value<const D: usize>(packing: f64) -> f64 {
    let free = 1.0 - packing;
    match const { two_or_three::<D>() } {
        2 => (1.0 - 7.0 * packing / 16.0) / (free * free),
        _ => (1.0 - 0.5 * packing) / (free * free * free),
    }
}

/// Compressibility factor `Z = P V / (N k T)` of the fluid.
///
/// 2-D: `(1 + eta^2/8) / (1 - eta)^2` (Henderson 1975, doi:10.1080/00268977500102511). 3-D:
/// `(1 + eta + eta^2 - eta^3) / (1 - eta)^3` (Carnahan and Starling 1969, doi:10.1063/1.1672048). The second virial
/// coefficient is exact in both; good to about a per cent below freezing.
pub fn compressibility<const D: usize>(packing: f64) -> f64 {
    let (eta, free) = (packing, 1.0 - packing);
    match const { two_or_three::<D>() } {
        2 => (1.0 + eta * eta / 8.0) / (free * free),
        _ => (1.0 + eta + eta * eta - eta * eta * eta) / (free * free * free),
    }
}

/// Reduced isothermal compressibility `chi_T = k T dn/dP = 1 / (d(eta Z)/d eta)` of the fluid: the variance of the number of
/// particles in a large part of it over that in an ideal gas (from the same equations of state as [`compressibility`]).
pub fn reduced_compressibility<const D: usize>(packing: f64) -> f64 {
    let (eta, free) = (packing, 1.0 - packing);
    match const { two_or_three::<D>() } {
        2 => free.powi(3) / (1.0 + eta + 0.375 * eta * eta - 0.125 * eta.powi(3)),
        _ => free.powi(4) / ((1.0 + 2.0 * eta).powi(2) - eta.powi(3) * (4.0 - eta)),
    }
}

/// What the `compressibility` factor of `count` particles in a periodic box has more than that of infinitely many: about
/// `(eta/2N) d ln chi_T/d eta`, negative, to order `1/N`.
///
/// A fixed number does not fluctuate. With `Xi = sum_N z^N Q_N = exp(P V/kT)`, free of surface terms in a periodic box, and
/// normal fluctuations of variance `N chi_T`, the free energy of exactly `N` is `F_N/kT = F/kT + (1/2) ln chi_T`; its slope is the
/// pressure. Thin gases have the `1 - 1/N` of their `N - 1` partners, `-2^(D-1) eta/N`; dense ones less than half that share of `Z - 1`.
/// It is as much for the virial of the collisions at fixed energy `E` and momentum, with `kT = 2 E/(D(N - 1))`: places are as in
/// equilibrium, and the mean square of relative velocities is `2 D kT/m` exactly. (Finite sizes in the plane: Kolafa and
/// Rottner 2006, doi:10.1080/00268970600967963.)
pub fn finite_size_shift<const D: usize>(packing: f64, count: usize) -> f64 {
    let (eta, free) = (packing, 1.0 - packing);
    // The polynomial of `reduced_compressibility` and its slope.
    let (power, polynomial, slope) = match const { two_or_three::<D>() } {
        2 => (3.0, 1.0 + eta + 0.375 * eta * eta - 0.125 * eta.powi(3), 1.0 + 0.75 * eta - 0.375 * eta * eta),
        _ => (4.0, (1.0 + 2.0 * eta).powi(2) - eta.powi(3) * (4.0 - eta), 4.0 + 8.0 * eta - 12.0 * eta * eta + 4.0 * eta.powi(3)),
    };
    -0.5 * eta / count as f64 * (power / free + slope / polynomial)
}

/// Excess chemical potential over `k T` of the fluid, `int_0^eta (Z - 1)/eta d eta + Z - 1`: by the equations of state of
/// [`compressibility`], `-(7/8) ln(1 - eta) + (9/8) eta/(1 - eta) + Z - 1` in 2-D and
/// `(4 eta - 3 eta^2)/(1 - eta)^2 + Z - 1` in 3-D.
pub fn excess_chemical_potential<const D: usize>(packing: f64) -> f64 {
    let (eta, free) = (packing, 1.0 - packing);
    let energy = match const { two_or_three::<D>() } {
        2 => -7.0 / 8.0 * libm::log1p(-eta) + 9.0 / 8.0 * eta / free,
        _ => (4.0 * eta - 3.0 * eta * eta) / (free * free),
    };
    energy + compressibility::<D>(eta) - 1.0
}

/// Speed of sound `c = sqrt((dP/d rho)_S)` in the fluid: `c^2 = (kT/m) (d(eta Z)/d eta + (2/D) Z^2)`, since
/// `(dP/d rho)_S = (dP/d rho)_T + T (dP/dT)^2 / (rho^2 c_V)` with `P = n kT Z(eta)` and `c_V = D k/(2 m)`. An ideal gas has
/// `c^2 = (1 + 2/D) kT/m`.
pub fn speed_of_sound<const D: usize>(packing: f64, temperature: f64, mass: f64) -> f64 {
    let z = compressibility::<D>(packing);
    (temperature / mass * (1.0 / reduced_compressibility::<D>(packing) + 2.0 / D as f64 * z * z)).sqrt()
}

/// Collisions a particle suffers per time in a gas of one species, Enskog: `2 n s chi sqrt(pi kT/m)` in 2-D,
/// `4 n s^2 chi sqrt(pi kT/m)` in 3-D (Chapman and Cowling, The Mathematical Theory of Non-uniform Gases, chapter 16).
/// It is exact in equilibrium, given the true contact value.
pub fn collision_rate<const D: usize>(density: f64, diameter: f64, temperature: f64, mass: f64) -> f64 {
    let chi = contact_value::<D>(packing_fraction::<D>(density, diameter));
    let speed = (PI * temperature / mass).sqrt();
    match const { two_or_three::<D>() } {
        2 => 2.0 * density * diameter * chi * speed,
        _ => 4.0 * density * diameter * diameter * chi * speed,
    }
}

/// Mean free path, the mean speed over the collision rate: `1/(2 sqrt2 n s chi)` in 2-D, `1/(sqrt2 pi n s^2 chi)` in 3-D.
pub fn mean_free_path<const D: usize>(density: f64, diameter: f64) -> f64 {
    mean_speed::<D>(1.0, 1.0) / collision_rate::<D>(density, diameter, 1.0, 1.0)
}

/// Mean speed in equilibrium: `sqrt(pi kT/(2m))` in 2-D, `sqrt(8 kT/(pi m))` in 3-D.
pub fn mean_speed<const D: usize>(temperature: f64, mass: f64) -> f64 {
    match const { two_or_three::<D>() } {
        2 => (0.5 * PI * temperature / mass).sqrt(),
        _ => (8.0 * temperature / (PI * mass)).sqrt(),
    }
}

/// Coefficient of self-diffusion in Enskog's first approximation, `(1/(2 n s chi)) sqrt(kT/(pi m))` of discs and
/// `(3/(8 n s^2 chi)) sqrt(kT/(pi m))` of spheres (Chapman and Cowling, chapters 10 and 16): `kT/m` over the friction
/// `2 nu/D` of the first collision of each particle, `nu` being the rate of collisions. The sum of Sonine's series is 1.029
/// (1.019) times as much.
pub fn self_diffusion<const D: usize>(density: f64, diameter: f64, temperature: f64, mass: f64) -> f64 {
    let friction = 2.0 / D as f64 * collision_rate::<D>(density, diameter, temperature, mass);
    temperature / (mass * friction)
}

/// Hits per area and time on a wall, or passages through a hole, of a gas of number density `n` at the wall:
/// `n sqrt(kT/(2 pi m))`, in any dimension. For hard spheres the density of centres at the wall is `P/(kT)`.
pub fn wall_hit_rate(density: f64, temperature: f64, mass: f64) -> f64 {
    density * (temperature / (2.0 * PI * mass)).sqrt()
}

/// Flux of a gas at constant energy over that of [`wall_hit_rate`] at the same temperature `kT = 2E/f`: the mean of one of `f`
/// velocity components uniform on a sphere is `sqrt(f/2) Gamma(f/2)/Gamma((f + 1)/2)` times the normal one, about `1 + 1/(4f)`.
pub fn closed_flux_factor(freedom: f64) -> f64 {
    let half = 0.5 * freedom;
    half.sqrt() * libm::exp(libm::lgamma(half) - libm::lgamma(half + 0.5))
}

/// Mean of the velocity component through the hole of those that pass it: `sqrt(pi kT/(2m))`.
pub fn speed_through_hole(temperature: f64, mass: f64) -> f64 {
    (0.5 * PI * temperature / mass).sqrt()
}

const fn two_or_three<const D: usize>() -> usize {
    assert!(D == 2 || D == 3, "known in two and three dimensions only");
    D
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The textbook forms, of thin gases.
    #[test]
    fn thin_gases_diffuse_as_chapman_and_enskog_say() {
        let (n, s, kt, m) = (1e-9, 0.7, 1.3, 2.0);
        let speed = (kt / (PI * m)).sqrt();
        assert!((self_diffusion::<2>(n, s, kt, m) * 2.0 * n * s / speed - 1.0).abs() < 1e-8);
        assert!((self_diffusion::<3>(n, s, kt, m) * 8.0 * n * s * s / (3.0 * speed) - 1.0).abs() < 1e-8);
    }

    /// The virial theorem with the mean impulse of a contact: `Z = 1 + 2^(D-1) eta chi`.
    #[test]
    fn pressure_and_contact_value_fulfil_the_virial_theorem() {
        for eta in [0.0, 0.1, 0.3, 0.45] {
            assert!((compressibility::<3>(eta) - 1.0 - 4.0 * eta * contact_value::<3>(eta)).abs() < 1e-13);
            assert!((compressibility::<2>(eta) - 1.0 - 2.0 * eta * contact_value::<2>(eta)).abs() < 1e-13);
        }
    }

    /// The closed forms are the derivative of the equation of state: central differences, exact to `O(h^2)` with the third
    /// derivative of `eta Z` below `10^3` here.
    #[test]
    fn reduced_compressibility_is_the_derivative_of_the_pressure() {
        let h = 1e-5;
        for eta in [0.01, 0.1, 0.3, 0.45] {
            let slope2 = ((eta + h) * compressibility::<2>(eta + h) - (eta - h) * compressibility::<2>(eta - h)) / (2.0 * h);
            let slope3 = ((eta + h) * compressibility::<3>(eta + h) - (eta - h) * compressibility::<3>(eta - h)) / (2.0 * h);
            assert!((reduced_compressibility::<2>(eta) * slope2 - 1.0).abs() < 1e-7, "{eta}");
            assert!((reduced_compressibility::<3>(eta) * slope3 - 1.0).abs() < 1e-7, "{eta}");
        }
    }

    /// Central differences of `ln chi_T`; and the second virial coefficient of `N` particles, which have `N - 1` partners each.
    #[test]
    fn a_few_particles_have_the_pressure_of_a_fixed_number() {
        let h = 1e-5;
        for eta in [0.01, 0.1, 0.3, 0.45] {
            let flat = (reduced_compressibility::<2>(eta + h) / reduced_compressibility::<2>(eta - h)).ln() / (2.0 * h);
            let round = (reduced_compressibility::<3>(eta + h) / reduced_compressibility::<3>(eta - h)).ln() / (2.0 * h);
            assert!((finite_size_shift::<2>(eta, 50) / (0.01 * eta * flat) - 1.0).abs() < 1e-7, "{eta}");
            assert!((finite_size_shift::<3>(eta, 50) / (0.01 * eta * round) - 1.0).abs() < 1e-7, "{eta}");
        }
        assert!((finite_size_shift::<2>(1e-6, 10) / -2e-7 - 1.0).abs() < 1e-5);
        assert!((finite_size_shift::<3>(1e-6, 10) / -4e-7 - 1.0).abs() < 1e-5);
    }

    /// Gibbs and Duhem: `d mu = dP / n`, so that the slope of the whole chemical potential is `1 / (eta chi_T)`.
    #[test]
    fn chemical_potential_and_pressure_fulfil_gibbs_and_duhem() {
        let h = 1e-5;
        for eta in [0.01, 0.1, 0.3, 0.45] {
            let flat = (excess_chemical_potential::<2>(eta + h) - excess_chemical_potential::<2>(eta - h)) / (2.0 * h);
            let round = (excess_chemical_potential::<3>(eta + h) - excess_chemical_potential::<3>(eta - h)) / (2.0 * h);
            assert!((flat + 1.0 / eta - 1.0 / (eta * reduced_compressibility::<2>(eta))).abs() < 1e-5 * flat, "{eta}");
            assert!((round + 1.0 / eta - 1.0 / (eta * reduced_compressibility::<3>(eta))).abs() < 1e-5 * round, "{eta}");
        }
    }

    /// An adiabat: along `d ln T / d ln rho = (2/D) Z` the pressure changes by `c^2 d rho`.
    #[test]
    fn sound_is_the_slope_of_the_adiabat() {
        let (eta, h) = (0.3, 1e-5);
        let temperature = |eta_at: f64| (2.0 / 3.0 * compressibility::<3>(eta) * (eta_at / eta - 1.0)) + 1.0;
        let pressure = |eta: f64| eta * compressibility::<3>(eta) * temperature(eta);
        let slope = (pressure(eta + h) - pressure(eta - h)) / (2.0 * h);
        assert!((speed_of_sound::<3>(eta, 1.0, 1.0).powi(2) / slope - 1.0).abs() < 1e-7);
        assert!((speed_of_sound::<2>(0.0, 1.5, 2.0).powi(2) - 1.5).abs() < 1e-14);
    }

    /// Virial coefficients known exactly: `Z = 1 + 2 eta + 3.128 eta^2` in 2-D (`B_3/B_2^2 = 4/3 - sqrt3/pi`), and
    /// `1 + 4 eta + 10 eta^2` in 3-D. Both equations of state round the third in 2-D (to 3.125).
    #[test]
    fn low_densities_have_the_exact_virial_coefficients() {
        let eta = 1e-4;
        let second = |z: f64| (z - 1.0) / eta;
        let exact = 4.0 * (4.0 / 3.0 - 3f64.sqrt() / PI);
        assert!((second(compressibility::<2>(eta)) - 2.0 - 3.125 * eta).abs() < 1e-7 && (exact - 3.125).abs() < 0.004);
        assert!((second(compressibility::<3>(eta)) - 4.0 - 10.0 * eta).abs() < 1e-6);
    }

    /// The rate of collisions from the flux of relative velocities: `n chi` times the cross-section (`2 s`, `pi s^2`) times the
    /// mean relative speed, which is `sqrt2` times the mean speed.
    #[test]
    fn collision_rate_is_density_times_cross_section_times_relative_speed() {
        let (n, s, t, m) = (0.2, 1.1, 1.7, 0.6);
        let flat = n * contact_value::<2>(n * PI * s * s / 4.0) * 2.0 * s * 2f64.sqrt() * mean_speed::<2>(t, m);
        let round = n * contact_value::<3>(n * PI * s * s * s / 6.0) * PI * s * s * 2f64.sqrt() * mean_speed::<3>(t, m);
        assert!((collision_rate::<2>(n, s, t, m) / flat - 1.0).abs() < 1e-14);
        assert!((collision_rate::<3>(n, s, t, m) / round - 1.0).abs() < 1e-14);
    }

    /// The collisions' own virial: each transfers `s m |v.k|` on average `s sqrt(pi m kT)`, so that
    /// `Z - 1 = (rate/2) s sqrt(pi m kT) / (D kT)`: an independent road from the rate to the pressure.
    #[test]
    fn collision_rate_and_pressure_belong_together() {
        let (n, s, t, m) = (0.3, 1.0, 1.3, 2.0);
        let virial = |rate: f64, d: f64| 0.5 * rate * s * (PI * m * t).sqrt() / (d * t);
        let z2 = compressibility::<2>(packing_fraction::<2>(n, s)) - 1.0;
        let z3 = compressibility::<3>(packing_fraction::<3>(n, s)) - 1.0;
        assert!((virial(collision_rate::<2>(n, s, t, m), 2.0) / z2 - 1.0).abs() < 1e-13);
        assert!((virial(collision_rate::<3>(n, s, t, m), 3.0) / z3 - 1.0).abs() < 1e-13);
    }

    #[test]
    fn pressure_is_the_wall_hit_rate_times_the_mean_impulse() {
        let (n, t, m) = (0.7, 1.9, 0.4);
        assert!((wall_hit_rate(n, t, m) * 2.0 * m * speed_through_hole(t, m) / (n * t) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn one_particle_alone_in_the_plane_has_its_whole_speed() {
        // <|cos|> = 2/pi on the circle of radius sqrt(2), against sqrt(2/pi) of a normal component.
        let exact = 2.0 / PI * 2f64.sqrt() / (2.0 / PI).sqrt();
        assert!((closed_flux_factor(2.0) - exact).abs() < 1e-14);
        assert!((closed_flux_factor(1e6) - 1.0 - 0.25e-6).abs() < 1e-8);
    }

    #[test]
    fn mean_free_paths_are_the_textbook_ones() {
        let (n, s) = (0.05, 1.0);
        let flat = 1.0 / (2.0 * 2f64.sqrt() * n * s * contact_value::<2>(packing_fraction::<2>(n, s)));
        let round = 1.0 / (2f64.sqrt() * PI * n * s * s * contact_value::<3>(packing_fraction::<3>(n, s)));
        assert!((mean_free_path::<2>(n, s) / flat - 1.0).abs() < 1e-14 && (mean_free_path::<3>(n, s) / round - 1.0).abs() < 1e-14);
    }
}
