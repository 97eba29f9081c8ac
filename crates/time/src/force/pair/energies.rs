//! Energy and virial of pairs.

use super::kernel::{Law, Meeting, Pairs, Sum, add_up, largest_of, terms};
use crate::exact::{BITS, Quantum};
use crate::lanes::{InLanes, LANES, Lanes};

/// Energy and virial of a share, in the finer quanta, every pair twice; and the largest terms of each.
pub(super) struct Totals {
    pub(super) total: [i128; 2],
    pub(super) largest: [f64; 2],
}

/// Adds up energy and virial of every pair of a share.
pub(super) struct AddEnergies<'a, L, const D: usize> {
    pub(super) pairs: Pairs<'a, L, D>,
    /// Of each sum, and of what its terms leave.
    pub(super) quanta: [[Quantum; 2]; 2],
    /// Whether energies are shifted to vanish at the range.
    pub(super) shifted: bool,
}

/// Energy and virial of a block, as sums of bits.
struct Energies<V: Lanes> {
    shifted: bool,
    magic: [[V; 2]; 2],
    bits: [[V::Integers; 2]; 2],
    most: [V::Integers; 2],
}

impl<V: Lanes, const D: usize> Sum<V, D> for Energies<V> {
    const HOT: bool = false;

    #[inline(always)]
    fn add<L: Law, const N: usize>(&mut self, meeting: &Meeting<V, L, D, N>) {
        for n in 0..N {
            let r_squared = meeting.r_squared[n];
            let terms = [meeting.energy(n, self.shifted), r_squared.mul(meeting.force_over_distance(n))];
            for number in 0..2 {
                // Out of range the square may be infinite, and its product with zero no number.
                let term = terms[number].where_less(r_squared, V::splat(f64::INFINITY));
                self.most[number] = term.larger_bits(self.most[number]);
                let mut left = term;
                for level in 0..2 {
                    let shifted = left.add(self.magic[number][level]);
                    self.bits[number][level] = shifted.add_bits(self.bits[number][level]);
                    left = left.sub(shifted.sub(self.magic[number][level]));
                }
            }
        }
    }
}

impl<L: Law, const D: usize> InLanes for AddEnergies<'_, L, D> {
    type Output = Totals;

    #[inline(always)]
    fn run<V: Lanes>(self) -> Totals {
        let Self { pairs, quanta, shifted } = self;
        let image = pairs.image.in_lanes::<V>();
        let magic = quanta.map(|levels| [V::splat(levels[0].magic()), V::splat(levels[1].magic())]);
        let (mut total, mut most) = ([0; 2], [V::zeros(); 2]);
        for (block, near) in (pairs.rows.first..).zip(pairs.rows.iter()) {
            let mut sum = Energies { shifted, magic, bits: [[V::zeros(); 2]; 2], most };
            add_up::<V, L, _, D>(&pairs, &image, block, &near, &mut sum);
            most = sum.most;
            let terms = terms(&near);
            for number in 0..2 {
                let [coarse, fine] = sum.bits[number].map(V::integers);
                for lane in 0..LANES {
                    total[number] += i128::from(coarse[lane].wrapping_sub(quanta[number][0].bias(terms))) << BITS;
                    total[number] += i128::from(fine[lane].wrapping_sub(quanta[number][1].bias(terms)));
                }
            }
        }
        Totals { total, largest: most.map(|most| largest_of(V::integers(most))) }
    }
}
