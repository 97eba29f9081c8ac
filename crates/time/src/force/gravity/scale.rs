//! Units of length in which squares of distances fit single precision.

use corpuscle_core::Vector;
use corpuscle_core::instructions::{Instructions, Kernel, larger};

use super::lanes::LANES;

/// A power of two by which lengths are multiplied: the largest coordinate becomes about `2^60`, and distances down to `2^-123`
/// of it count. Powers of two round nothing, so results do not depend on the choice.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    /// What lengths are multiplied by.
    pub(super) length: f64,
}

impl Scale {
    /// A coordinate outside every system.
    pub(super) const OUTSIDE: f64 = power_of_two(62);

    /// The scale that suits these positions.
    pub(super) fn new<const D: usize>(softening: f64, positions: &[Vector<D>], instructions: Instructions) -> Self {
        let largest = instructions.run(Largest(Vector::components(positions))).max(softening);
        let exponent = ((largest.to_bits() >> 52) & 0x7ff) as i32 - 1023;
        Self { length: if largest > 0.0 { power_of_two((60 - exponent).clamp(-500, 500)) } else { 1.0 } }
    }

    /// That of a system a million times as large.
    pub(super) fn with_room(self) -> Self {
        Self { length: self.length * power_of_two(-20) }
    }

    /// What accelerations `G m r / r^3` of scaled lengths are multiplied by.
    pub(super) fn acceleration(self) -> f64 {
        self.length * self.length
    }
}

const fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

/// The largest magnitude; what is no number is passed over.
struct Largest<'a>(&'a [f64]);

impl Kernel for Largest<'_> {
    type Output = f64;

    #[inline(always)]
    fn run(self) -> f64 {
        let (chunks, rest) = self.0.as_chunks::<LANES>();
        let mut largest = [0.0; LANES];
        for chunk in chunks {
            for lane in 0..LANES {
                largest[lane] = larger(chunk[lane].abs(), largest[lane]);
            }
        }
        largest.iter().chain(rest).fold(0.0, |largest, x| larger(x.abs(), largest))
    }
}
