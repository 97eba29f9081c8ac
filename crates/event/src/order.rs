//! The order of particles in memory: along a curve that stays near what it has passed.

use corpuscle_core::{Boundary, Vector};

/// Bits of a place along each axis.
const BITS: u32 = 16;

/// Place of a point along the Hilbert curve through the box.
///
/// Neighbours along the curve are neighbours in space, and mostly the other way round (Skilling, AIP Conf. Proc. 707, 381
/// (2004), doi:10.1063/1.1751381).
pub(crate) fn place_on_curve<const D: usize>(boundary: &Boundary<D>, r: Vector<D>) -> u64 {
    let side = boundary.extent().0.into_iter().fold(0.0, f64::max);
    let scale = f64::from(1u32 << BITS) / side;
    let mut x: [u32; D] = std::array::from_fn(|k| ((r[k] - boundary.lower[k]) * scale).clamp(0.0, 65_535.0) as u32);
    // Undo the excess work of the rotations, from the coarsest bit down.
    let mut bit = 1 << (BITS - 1);
    while bit > 1 {
        let below = bit - 1;
        for k in 0..D {
            if x[k] & bit == 0 {
                let difference = (x[0] ^ x[k]) & below;
                x[0] ^= difference;
                x[k] ^= difference;
            } else {
                x[0] ^= below;
            }
        }
        bit >>= 1;
    }
    // Gray code.
    for k in 1..D {
        x[k] ^= x[k - 1];
    }
    let mut flip = 0;
    let mut bit = 1 << (BITS - 1);
    while bit > 1 {
        if x[D - 1] & bit != 0 {
            flip ^= bit - 1;
        }
        bit >>= 1;
    }
    for coordinate in &mut x {
        *coordinate ^= flip;
    }
    // The bits of the axes in turn, the coarsest first.
    let mut place = 0;
    for bit in (0..BITS).rev() {
        for coordinate in x {
            place = place << 1 | u64::from(coordinate >> bit & 1);
        }
    }
    place
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_core::Axis;

    /// In a grid of 2^m cells a side the curve visits every cell, and goes from each to one that shares a face.
    #[test]
    fn the_curve_goes_from_cell_to_cell() {
        fn check<const D: usize>(side: usize) {
            let boundary = Boundary::<D>::new([0.0; D], [side as f64; D], Axis::Periodic);
            let mut cells: Vec<Vector<D>> = (0..side.pow(D as u32))
                .map(|number| Vector::from_fn(|k| (number / side.pow(k as u32) % side) as f64 + 0.5))
                .collect();
            cells.sort_by_key(|&r| place_on_curve(&boundary, r));
            assert!(cells.windows(2).all(|pair| (pair[1] - pair[0]).norm() == 1.0));
        }
        check::<2>(16);
        check::<3>(8);
    }
}
