//! What pictures cost the graphics memory, counted where OpenGL is called.

use std::cell::Cell;

/// Bytes sent to the graphics memory and calls to draw, since [`Cost::take`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Bytes of vertices and texels; uniforms, some hundreds of bytes a picture, are not counted.
    pub bytes: u64,
    /// Calls to draw.
    pub draws: u32,
}

thread_local! {
    // A context belongs to a thread, and so does what it is asked for.
    static COST: Cell<Cost> = const { Cell::new(Cost { bytes: 0, draws: 0 }) };
}

impl Cost {
    /// What has been asked of OpenGL on this thread since the last call.
    pub fn take() -> Self {
        COST.take()
    }

    pub(super) fn sent(bytes: usize) {
        COST.set(Self { bytes: COST.get().bytes + bytes as u64, ..COST.get() });
    }

    pub(super) fn drawn() {
        COST.set(Self { draws: COST.get().draws + 1, ..COST.get() });
    }
}
