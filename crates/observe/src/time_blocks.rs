//! Sums over consecutive time blocks of equal length, of whatever happens at single instants.

/// Most blocks kept. Beyond it neighbours are joined, so that memory stays bounded however long the run.
const MOST_BLOCKS: usize = 1 << 14;

/// What happened in each of the consecutive time blocks since the start. Where a run is stopped and continued has no
/// influence: the block boundaries are multiples of the length, and only blocks that are over count.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct TimeBlocks {
    start: Option<f64>,
    length: f64,
    /// Blocks that are over.
    sums: Vec<f64>,
    /// The block under way.
    current: f64,
}

impl TimeBlocks {
    /// Blocks of this length, which may double in a long run.
    pub(crate) fn new(length: f64) -> Self {
        Self { length, ..Self::default() }
    }

    /// Time goes on to `time`: blocks that end before are closed. The first call sets the start.
    #[inline]
    pub(crate) fn advance(&mut self, time: f64) {
        let start = *self.start.get_or_insert(time);
        while start + (self.sums.len() + 1) as f64 * self.length <= time {
            self.sums.push(std::mem::take(&mut self.current));
            if self.sums.len() == MOST_BLOCKS {
                self.sums = self.sums.chunks_exact(2).map(|pair| pair[0] + pair[1]).collect();
                self.length *= 2.0;
            }
        }
    }

    /// Something worth `value` happened at `time`.
    #[inline]
    pub(crate) fn add(&mut self, time: f64, value: f64) {
        self.advance(time);
        self.current += value;
    }

    /// Rates in the blocks that are over: sums over the block's length.
    pub(crate) fn rates(&self) -> Vec<f64> {
        self.sums.iter().map(|sum| sum / self.length).collect()
    }

    /// Total over the blocks that are over.
    pub(crate) fn total(&self) -> f64 {
        self.sums.iter().sum()
    }

    /// Time covered by the blocks that are over.
    pub(crate) fn duration(&self) -> f64 {
        self.sums.len() as f64 * self.length
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stops_leave_no_trace_and_joined_blocks_keep_the_total() {
        let mut once = TimeBlocks::new(0.5);
        let mut often = TimeBlocks::new(0.5);
        once.advance(0.0);
        often.advance(0.0);
        for k in 0..40_000 {
            let time = 0.3 * f64::from(k) + 0.1;
            once.add(time, f64::from(k % 7));
            often.advance(time - 0.05);
            often.add(time, f64::from(k % 7));
        }
        once.advance(12_001.0);
        often.advance(12_001.0);
        assert_eq!(once, often);
        assert_eq!((once.length, once.sums.len(), once.duration()), (1.0, 12_001, 12_001.0));
        assert_eq!(once.total(), (0..40_000).map(|k| f64::from(k % 7)).sum::<f64>());
    }
}
