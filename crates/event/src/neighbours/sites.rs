//! The neighbours of a cell: where they are, and in which image.

use corpuscle_core::Axis;

use crate::search::{Neighbour, home};

/// The ways from a cell to its neighbours: the same for all cells inside, and for all that are at the same faces of the box.
#[derive(Clone, Debug)]
pub(crate) struct Sites<const D: usize> {
    last: [u16; D],
    /// By number: two bits an axis, at its lower face and at its upper face. A single cell is at both.
    sites: Vec<Site<D>>,
}

/// The ways from one cell: to all around it, itself included, and to those that are new after a step down or up along an
/// axis into this cell.
#[derive(Clone, Debug)]
pub(crate) struct Site<const D: usize> {
    pub(crate) around: Vec<Way>,
    pub(crate) ahead: [[Vec<Way>; 2]; D],
    /// Some are in periodic images of the box.
    pub(crate) images: bool,
}

/// The way from a cell to one of its neighbours.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Way {
    /// What to add to the index of the cell.
    pub(crate) step: i32,
    /// What to add to the words of the particles there.
    pub(crate) away: u32,
}

impl<const D: usize> Sites<D> {
    /// For so many cells along each axis, whose indices are so far apart.
    pub(crate) fn new(axes: [Axis; D], cells: [u32; D], stride: [u32; D]) -> Self {
        let last = cells.map(|cells| (cells - 1) as u16);
        let sites = (0..1usize << (2 * D)).map(|number| Site::new(number, axes, cells, stride)).collect();
        Self { last, sites }
    }

    #[inline]
    pub(crate) fn of(&self, cell: [u16; D]) -> &Site<D> {
        let mut number = 0;
        for (k, (c, last)) in cell.iter().zip(&self.last).enumerate() {
            number |= (usize::from(*c == 0) | usize::from(c == last) << 1) << (2 * k);
        }
        &self.sites[number]
    }
}

impl<const D: usize> Site<D> {
    fn new(number: usize, axes: [Axis; D], cells: [u32; D], stride: [u32; D]) -> Self {
        let mut site = Self { around: vec![], ahead: std::array::from_fn(|_| [vec![], vec![]]), images: false };
        for neighbour in 0..3usize.pow(D as u32) {
            let layer: [usize; D] = std::array::from_fn(|k| neighbour / 3usize.pow(k as u32) % 3);
            let (mut way, mut image, mut digit, mut exists) = (Way { step: 0, away: 0 }, 0, 1, true);
            for k in 0..D {
                let faces = number >> (2 * k);
                let leaves = [faces & 1 == 1, false, faces & 2 == 2][layer[k]];
                let direction = layer[k] as i32 - 1;
                way.step += direction * stride[k] as i32;
                image += digit;
                if leaves {
                    exists &= axes[k] == Axis::Periodic;
                    way.step -= direction * (cells[k] * stride[k]) as i32;
                    image = (i32::from(image) + direction * i32::from(digit)) as u8;
                }
                digit *= 3;
            }
            if !exists {
                continue;
            }
            way.away = away::<D>(image);
            site.images |= way.away != 0;
            site.around.push(way);
            for (ahead, layer) in site.ahead.iter_mut().zip(layer) {
                match layer {
                    0 => ahead[0].push(way),
                    2 => ahead[1].push(way),
                    _ => {}
                }
            }
        }
        site
    }
}

/// What to add to the words of a cell that is seen in this image.
#[inline]
pub(super) fn away<const D: usize>(image: u8) -> u32 {
    Neighbour::new(0, image).word().wrapping_sub(Neighbour::new(0, home::<D>()).word())
}
