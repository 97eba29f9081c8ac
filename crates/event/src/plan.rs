//! What a particle is going to do next.

/// The next events of one particle: its earliest collision with another, and what it meets alone.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Plan<const D: usize> {
    /// When it collides with `partner` in the periodic image `image`, if the partner's `stamp` is still the same.
    pub(crate) pair_time: f64,
    /// When it touches the fixed surface of index `surface`.
    pub(crate) surface_time: f64,
    /// When it leaves its cell.
    pub(crate) exit_time: f64,
    pub(crate) partner: u32,
    pub(crate) partner_stamp: u32,
    /// Counts the changes of this particle's flight.
    pub(crate) stamp: u32,
    pub(crate) surface: u32,
    /// How many contacts it has had at the same instant.
    pub(crate) stuck: u32,
    pub(crate) image: [i8; D],
    pub(crate) exit: Exit,
}

/// Through which face a particle leaves its cell.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Exit {
    pub(crate) axis: u8,
    pub(crate) up: bool,
    /// The face is a periodic face of the box.
    pub(crate) around: bool,
}

impl<const D: usize> Plan<D> {
    pub(crate) const IDLE: Self = Self {
        pair_time: f64::INFINITY,
        surface_time: f64::INFINITY,
        exit_time: f64::INFINITY,
        partner: u32::MAX,
        partner_stamp: 0,
        stamp: 0,
        surface: 0,
        stuck: 0,
        image: [0; D],
        exit: Exit { axis: 0, up: false, around: false },
    };

    /// Time of the earliest.
    #[inline]
    pub(crate) fn next_time(&self) -> f64 {
        self.pair_time.min(self.surface_time).min(self.exit_time)
    }
}
