//! The order of directions of discs.

use corpuscle_core::Vector;
use corpuscle_event::EventDriven;

/// `psi_6 = (1/6) sum exp(6 i theta)` over the six nearest neighbours of a disc, or a mean of such: a complex number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Order([f64; 2]);

impl Order {
    pub(super) fn modulus(&self) -> f64 {
        (self.0[0] * self.0[0] + self.0[1] * self.0[1]).sqrt()
    }

    /// Direction of the bonds against the horizontal in degrees, between -30 and 30, where it repeats itself.
    pub(super) fn direction(&self) -> f64 {
        libm::atan2(self.0[1], self.0[0]).to_degrees() / 6.0
    }

    pub(super) fn mean(orders: &[Self]) -> Self {
        let sum = orders.iter().fold([0.0; 2], |sum, order| [sum[0] + order.0[0], sum[1] + order.0[1]]);
        Self(sum.map(|part| part / orders.len().max(1) as f64))
    }

    /// Of the bonds to the nearest six of these.
    fn of_bonds(bonds: &mut Vec<(f64, Vector<2>)>) -> Self {
        bonds.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        bonds.truncate(6);
        let sixths = bonds.iter().map(|&(square, bond)| {
            // exp(6 i theta) = (z^2/|z|^2)^3.
            let second = [(bond[0] * bond[0] - bond[1] * bond[1]) / square, 2.0 * bond[0] * bond[1] / square];
            Self(product(second, product(second, second)))
        });
        Self::mean(&sixths.collect::<Vec<_>>())
    }
}

/// Product of two complex numbers.
fn product(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

/// The order of each disc in a periodic box, now.
pub(super) fn of_discs(engine: &EventDriven<2>) -> Vec<Order> {
    let count = engine.particle_count();
    let places: Vec<_> = (0..count).map(|i| engine.position(i)).collect();
    let boundary = engine.boundary();
    let extent = boundary.extent();
    // Six neighbours are within twice the distance of a crystal's, but for voids that do not occur at these densities.
    let reach = 2.2 * (extent[0] * extent[1] / count as f64).sqrt();
    let cells: [usize; 2] = std::array::from_fn(|k| ((extent[k] / reach) as usize).max(1));
    let cell = |place: Vector<2>| -> [usize; 2] {
        std::array::from_fn(|k| ((place[k] / extent[k] * cells[k] as f64) as usize).min(cells[k] - 1))
    };
    let mut members = vec![vec![]; cells[0] * cells[1]];
    for (i, &place) in places.iter().enumerate() {
        let [x, y] = cell(place);
        members[y * cells[0] + x].push(i);
    }
    let around = |at: usize, k: usize| -> Vec<usize> {
        let n = cells[k];
        if n < 3 { (0..n).collect() } else { vec![(at + n - 1) % n, at, (at + 1) % n] }
    };
    let of_one = |(i, &place): (usize, &Vector<2>)| {
        let [x, y] = cell(place);
        let mut bonds = vec![];
        for (row, column) in around(y, 1).into_iter().flat_map(|row| around(x, 0).into_iter().map(move |column| (row, column))) {
            for &j in members[row * cells[0] + column].iter().filter(|&&j| j != i) {
                let bond = boundary.displacement(place, places[j]);
                bonds.push((bond.norm_squared(), bond));
            }
        }
        Order::of_bonds(&mut bonds)
    };
    places.iter().enumerate().map(of_one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hexagon of neighbours, turned: its direction is the turn, modulo 60 degrees; further discs do not count.
    #[test]
    fn six_neighbours_tell_their_direction() {
        for turn in [-29.0f64, 0.0, 12.5, 70.0] {
            let mut bonds: Vec<(f64, Vector<2>)> = (0..12)
                .map(|k| {
                    let angle = (turn + 60.0 * f64::from(k)).to_radians();
                    let length = if k < 6 { 1.0 } else { 1.9 };
                    (length * length, Vector([length * angle.cos(), length * angle.sin() + if k < 6 { 0.0 } else { 0.7 }]))
                })
                .collect();
            let order = Order::of_bonds(&mut bonds);
            assert!((order.modulus() - 1.0).abs() < 1e-12);
            assert!((order.direction() - (turn - 60.0 * (turn / 60.0).round())).abs() < 1e-10, "{turn}: {}", order.direction());
        }
    }

    #[test]
    fn a_square_of_neighbours_and_two_across_have_little() {
        let mut bonds: Vec<(f64, Vector<2>)> =
            [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]].map(|bond| (1.0, Vector(bond))).to_vec();
        // exp(6 i theta) is 1, 1, -1, -1.
        assert!(Order::of_bonds(&mut bonds).modulus() < 1e-15);
    }
}
