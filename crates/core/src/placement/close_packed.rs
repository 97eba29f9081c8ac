//! The lattice that packs equal spheres closest.

use crate::{Axis, Boundary, Invalid, Random, Vector};

/// Places for `count` spheres of one radius on the lattice that packs them closest: triangular in 2-D, face-centred
/// cubic in 3-D, stretched along the axes as far as the box asks for it.
///
/// Both are the points of a rectangular grid whose indices have an even sum. The grid is the coarsest with enough
/// points; which of them stay empty is drawn from `random`, the others come in the order of their places.
///
/// # Errors
/// When the box is too small: names how many would fit at most if it had the right shape.
pub fn close_packed<const D: usize>(
    boundary: &Boundary<D>,
    count: usize,
    radius: f64,
    random: &mut Random,
) -> Result<Vec<Vector<D>>, Invalid> {
    boundary.validate()?;
    let walls = boundary.axes.map(|axis| axis == Axis::Walls);
    let side = Vector::<D>::from_fn(|k| boundary.extent()[k] - if walls[k] { 2.0 * radius } else { 0.0 });
    let volume = boundary.volume();
    // Steps of the grid where neighbours are 1 apart: half a side and the height of the triangle, or half a diagonal.
    let shape = Vector::<D>::from_fn(|k| if D == 2 { [0.5, 0.75f64.sqrt()][k] } else { 0.5f64.sqrt() });
    let volume_of_one = 2.0 * shape.0.iter().product::<f64>();
    let mut distance = libm::pow(volume / (count.max(1) as f64 * volume_of_one), 1.0 / D as f64);
    while distance >= 2.0 * radius * (1.0 - 1e-12) && distance > 0.0 {
        // Around a periodic axis the number of points has to be even; between walls n points have n - 1 gaps.
        let least: [usize; D] = std::array::from_fn(|k| {
            let steps = side[k] / (distance * shape[k]) * (1.0 + 1e-12);
            if walls[k] { steps.max(0.0) as usize + 1 } else { 2 * (0.5 * steps).max(1.0) as usize }
        });
        // A few more along some of the axes may fit, too: small boxes are seldom of the right shape.
        for more in 0..1 << D {
            let points: [usize; D] = std::array::from_fn(|k| {
                least[k]
                    + if more >> k & 1 == 0 {
                        0
                    } else if walls[k] {
                        1
                    } else {
                        2
                    }
            });
            let step = Vector::from_fn(|k| side[k] / if walls[k] { (points[k] - 1).max(1) } else { points[k] } as f64);
            let start = Vector::from_fn(|k| boundary.lower[k] + if walls[k] { radius } else { 0.5 * step[k] });
            if points.iter().product::<usize>().div_ceil(2) >= count && fits(side, step, radius) {
                let mut sites = even_points(points, start, step);
                let mut empty: Vec<bool> = (0..sites.len()).map(|site| site >= count).collect();
                if sites.len() > count {
                    random.shuffle(&mut empty);
                }
                let mut empty = empty.into_iter();
                sites.retain(|_| empty.next() == Some(false));
                return Ok(sites);
            }
        }
        distance *= 0.998;
    }
    let most = (volume / (volume_of_one * libm::pow(2.0 * radius, D as f64))).floor();
    Err(Invalid::new("particles", count, format!("at most {most} of radius {radius}: the box is too small for more")))
}

/// Whether neighbours in a grid of this step keep clear of one another, and each of its own periodic images.
fn fits<const D: usize>(side: Vector<D>, step: Vector<D>, radius: f64) -> bool {
    let clear = 2.0 * radius * (1.0 - 1e-13);
    (0..D).all(|k| {
        let diagonals = (0..k).all(|l| step[k].hypot(step[l]) >= clear);
        diagonals && side[k] >= 0.0 && 2.0 * step[k] >= clear
    })
}

/// The points of the grid whose indices have an even sum.
fn even_points<const D: usize>(points: [usize; D], start: Vector<D>, step: Vector<D>) -> Vec<Vector<D>> {
    (0..points.iter().product::<usize>())
        .filter_map(|mut number| {
            let index: [usize; D] = std::array::from_fn(|k| {
                let index = number % points[k];
                number /= points[k];
                index
            });
            let even = index.iter().sum::<usize>() % 2 == 0;
            even.then(|| Vector::from_fn(|k| start[k] + index[k] as f64 * step[k]))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Particles;
    use crate::particles::ball_volume;

    /// Fills a periodic cube to this packing fraction and answers the least gap between surfaces over the diameter.
    fn gap<const D: usize>(count: usize, packing: f64) -> Result<f64, Invalid> {
        let side = libm::pow(count as f64 * ball_volume::<D>(0.5) / packing, 1.0 / D as f64);
        let boundary = Boundary::<D>::periodic(side);
        let mut particles = Particles::new();
        for place in close_packed(&boundary, count, 0.5, &mut Random::new(1, 0))? {
            particles.push(place, Vector::ZERO, 1.0, 0.5, 0);
        }
        assert_eq!(particles.len(), count);
        boundary.validate_particles(&particles).unwrap();
        particles.radius.fill(1.0); // everything closer than 2 counts as an overlap: the nearest pair is the deepest
        Ok(1.0 - boundary.largest_overlap(&particles))
    }

    #[test]
    fn perfect_numbers_fill_the_face_centred_lattice() {
        // Neighbours at L / (sqrt(2) c): at packing 0.5 they are (0.7405 / 0.5)^(1/3) apart.
        let close = std::f64::consts::PI / 18f64.sqrt();
        for c in [1usize, 2, 7] {
            let found = gap::<3>(4 * c.pow(3), 0.5).unwrap();
            assert!((found + 1.0 - (close / 0.5).cbrt()).abs() < 1e-12 || c == 1, "{c}: {found}");
            assert!(gap::<3>(4 * c.pow(3), 0.740).is_ok());
        }
    }

    #[test]
    fn any_number_is_placed_densely() {
        // Of few discs rows and columns do not come out even: 36 or 48 fit where 37 are asked for.
        for (count, discs) in [(37, 0.60), (400, 0.70), (1000, 0.70), (10_000, 0.70)] {
            assert!(gap::<2>(count, discs).is_ok(), "{count} discs");
            assert!(gap::<3>(count, 0.49).is_ok(), "{count} spheres");
        }
        assert!(gap::<3>(4000, 0.75).unwrap_err().expected.starts_with("at most"));
        assert!(gap::<2>(4000, 0.91).is_err());
    }

    #[test]
    fn walls_are_kept_clear() {
        let room = Boundary::<2>::new([0.0; 2], [20.0, 11.0], Axis::Walls);
        let mut particles = Particles::new();
        for place in close_packed(&room, 150, 0.5, &mut Random::new(1, 0)).unwrap() {
            particles.push(place, Vector::ZERO, 1.0, 0.5, 0);
        }
        room.validate_particles(&particles).unwrap();
    }
}
