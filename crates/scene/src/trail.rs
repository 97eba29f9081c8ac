//! The path a body leaves behind.

use std::collections::VecDeque;

use crate::Colour;

/// One point of a trail.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct TrailPoint {
    /// Where the body was.
    pub position: [f64; 3],
    /// When.
    pub time: f64,
}

/// The newest points of a path, and how many there ever were: a renderer that remembers how many it has uploaded sends
/// only the rest to the graphics memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Trail {
    /// Identity from frame to frame.
    pub key: u32,
    /// Colour of the newest end; the oldest fades out.
    pub colour: Colour,
    /// Width in points of the screen.
    pub width: f32,
    capacity: usize,
    total: u64,
    points: VecDeque<TrailPoint>,
}

impl Trail {
    /// A time so long ago that whatever bears it has faded; finite, also in single precision.
    pub const LONG_AGO: f64 = -1e30;

    /// An empty trail that keeps the newest `capacity` points (at least 2).
    pub fn new(key: u32, capacity: usize, colour: Colour) -> Self {
        Self { key, colour, width: 1.5, capacity: capacity.max(2), total: 0, points: VecDeque::new() }
    }

    /// Adds the newest point; the oldest goes when the trail is full.
    pub fn push(&mut self, point: TrailPoint) {
        if self.points.len() == self.capacity {
            self.points.pop_front();
        }
        self.points.push_back(point);
        self.total += 1;
    }

    /// Adds the newest point without a line to it from the one before: a path that leaves a periodic box through one face
    /// and comes back through the other.
    ///
    /// Both ends of the gap are points of [`LONG_AGO`](Self::LONG_AGO), which has faded.
    pub fn jump(&mut self, point: TrailPoint) {
        if let Some(last) = self.points.back().map(|last| last.position) {
            self.push(TrailPoint { position: last, time: Self::LONG_AGO });
            self.push(TrailPoint { position: point.position, time: Self::LONG_AGO });
        }
        self.push(point);
    }

    /// Time of the oldest point kept, the ends of gaps left aside.
    pub fn oldest_time(&self) -> Option<f64> {
        self.points.iter().map(|point| point.time).find(|&time| time > Self::LONG_AGO)
    }

    /// Number of points ever added.
    pub fn total(&self) -> u64 {
        self.total
    }

    /// Number of points kept at most.
    pub fn capacity(&self) -> usize {
        self.capacity
    }

    /// The points kept, oldest first; the last has the number `total() - 1`.
    pub fn points(&self) -> &VecDeque<TrailPoint> {
        &self.points
    }

    /// The points added since there were `seen` of them, as far as they are still kept.
    pub fn since(&self, seen: u64) -> impl Iterator<Item = &TrailPoint> {
        let fresh = usize::try_from(self.total.saturating_sub(seen)).unwrap_or(usize::MAX).min(self.points.len());
        self.points.range(self.points.len() - fresh..)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_new_points_are_handed_out() {
        let mut trail = Trail::new(0, 3, Colour::Ink);
        for step in 0..5 {
            trail.push(TrailPoint { position: [0.0; 3], time: f64::from(step) });
        }
        let times = |seen| trail.since(seen).map(|p| p.time).collect::<Vec<_>>();
        assert_eq!(times(4), [4.0]);
        assert_eq!(times(0), [2.0, 3.0, 4.0]);
        assert!(times(5).is_empty());
    }

    #[test]
    fn a_jump_leaves_a_gap_between_faded_points() {
        let mut trail = Trail::new(0, 10, Colour::Ink);
        let point = |x: f64, time| TrailPoint { position: [x, 0.0, 0.0], time };
        trail.push(point(9.0, 1.0));
        trail.jump(point(0.5, 2.0));
        let seen: Vec<(f64, bool)> = trail.points().iter().map(|p| (p.position[0], p.time == Trail::LONG_AGO)).collect();
        assert_eq!(seen, [(9.0, false), (9.0, true), (0.5, true), (0.5, false)]);
        assert_eq!(trail.oldest_time(), Some(1.0));
    }
}
