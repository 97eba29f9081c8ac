//! Who is in whose well.

/// Pairs inside their wells, as a list for each particle: some tens at most, so that looking through one is quick.
///
/// Particles go by the numbers they are known by outside, which do not change when memory is sorted.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bonds(Vec<Vec<u32>>);

impl Bonds {
    /// No bonds among this many particles.
    pub(crate) fn none(particles: usize) -> Self {
        Self(vec![vec![]; particles])
    }

    #[inline]
    pub(crate) fn holds(&self, i: u32, j: u32) -> bool {
        self.0[i as usize].contains(&j)
    }

    /// Sets whether two particles are in each other's well.
    pub(crate) fn set(&mut self, i: u32, j: u32, inside: bool) {
        for (one, other) in [(i, j), (j, i)] {
            let partners = &mut self.0[one as usize];
            match partners.iter().position(|&partner| partner == other) {
                None if inside => partners.push(other),
                Some(place) if !inside => _ = partners.swap_remove(place),
                _ => {}
            }
        }
    }

    /// Loosens all.
    pub(crate) fn clear(&mut self) {
        self.0.iter_mut().for_each(Vec::clear);
    }

    /// All pairs, each once.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = (u32, u32)> {
        let of = |(i, partners): (usize, &Vec<u32>)| partners.iter().map(move |&j| (i as u32, j)).collect::<Vec<_>>();
        self.0.iter().enumerate().flat_map(of).filter(|(i, j)| i < j)
    }

    /// Number of pairs.
    pub(crate) fn count(&self) -> usize {
        self.0.iter().map(Vec::len).sum::<usize>() / 2
    }

    /// Bytes held.
    pub(crate) fn memory(&self) -> usize {
        self.0.capacity() * size_of::<Vec<u32>>() + self.0.iter().map(|partners| partners.capacity() * 4).sum::<usize>()
    }
}
