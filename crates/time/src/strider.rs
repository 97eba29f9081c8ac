//! Forces that take whole strides: particles are moved while accelerations are found.

use corpuscle_core::{Boundary, Particles};

use crate::constraint::Held;
use crate::motion::Stride;

/// What moves, and what it must not leave.
pub struct State<'a, const D: usize> {
    pub(crate) boundary: &'a Boundary<D>,
    pub(crate) particles: &'a mut Particles<D>,
    /// How often each particle went through the upper minus the lower face of a periodic axis.
    pub(crate) images: &'a mut [[i64; D]],
    /// Coordinates that go where they have to be, in the order of their particles.
    pub(crate) held: &'a [Held],
}

/// How far strides came.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// How many were taken.
    pub(crate) taken: usize,
    /// What [`kick_and_drift`](crate::motion::kick_and_drift) tells, of all these strides together.
    pub(crate) finite: [bool; 2],
}

/// A force that takes strides, each by the accelerations at the positions before it. Bits are those of accelerations, kicks and drifts
/// one after the other.
pub trait Strider<const D: usize> {
    /// How many strides should be asked for at once, where nobody looks at the particles in between; 0 where none can be taken. The
    /// engine keeps a state every so often, and asks for no more than lead to the next. Neither positions nor velocities matter:
    /// it is found anew whenever something else has changed, before the next stride, and with it may be whatever else does not change.
    fn strides_at_once(&mut self, state: &State<'_, D>) -> usize;

    /// Takes these strides, or only the first of them.
    fn stride(&mut self, state: State<'_, D>, strides: &[Stride]) -> Progress;

    /// `v += a dt` but for held coordinates, by the accelerations at the positions, which are not kept; tells whether every `v` is finite.
    /// `None`, and nothing is done, where that takes no less time than if they are.
    fn kick(&mut self, _: State<'_, D>, _dt: f64) -> Option<bool> {
        None
    }
}
