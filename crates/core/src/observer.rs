//! How an engine tells what happens: it pushes, the observer may stop it.

use std::ops::ControlFlow;

use crate::{Particles, Vector};

/// One partner of a contact, at the moment of the contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Party<const D: usize> {
    /// Index of the particle.
    pub index: usize,
    /// Mass of the particle.
    pub mass: f64,
    /// Position at the contact, in the primary box.
    pub position: Vector<D>,
    /// Velocity just before.
    pub before: Vector<D>,
    /// Velocity just after.
    pub after: Vector<D>,
}

/// Whom a particle met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Meeting<const D: usize> {
    /// Another particle.
    Pair(Party<D>),
    /// The lower (`upper == false`) or upper face of the box across `axis`.
    Face {
        /// Axis the face is perpendicular to.
        axis: usize,
        /// Which of the two faces.
        upper: bool,
    },
    /// The partition of the given index, on its flat side or at the edge of its hole.
    Partition {
        /// Index into [`Boundary::partitions`](crate::Boundary::partitions).
        index: usize,
    },
    /// The obstacle of the given index.
    Obstacle {
        /// Index into [`Boundary::obstacles`](crate::Boundary::obstacles).
        index: usize,
    },
    /// The piston.
    Piston {
        /// Its velocity along its axis just before.
        before: f64,
        /// Its velocity just after.
        after: f64,
    },
}

/// One collision, self-contained: the positions of all other particles are stale when it is reported.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<const D: usize> {
    /// Physical time.
    pub time: f64,
    /// The particle; in a pair, the first.
    pub first: Party<D>,
    /// What it met.
    pub with: Meeting<D>,
    /// Unit normal, from the first particle towards what it met.
    pub normal: Vector<D>,
    /// Impulse `J`: the first particle received `-J` along the normal. Where surfaces touch it pushes, `J >= 0`; at the edge
    /// of a square well it may pull, `J < 0`. (At a wall with a temperature it gets a new tangential velocity, too.)
    pub impulse: f64,
    /// Distance between the centres at the contact, or at the edge of a well; for a wall, from the centre to the wall.
    pub distance: f64,
}

/// Watches a run. Every method has an empty body, so an observer writes only what it needs; `()` watches nothing and
/// costs nothing, and a tuple of observers watches as all its members, in order.
pub trait Observer<const D: usize> {
    /// The run starts at `time` with these particles.
    fn begin(&mut self, time: f64, particles: &Particles<D>) {
        let _ = (time, particles);
    }

    /// A collision happened. `Break` ends the run right after it.
    #[inline]
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        let _ = contact;
        ControlFlow::Continue(())
    }

    /// A sampling time is reached; all particles are as of `time`.
    fn sample(&mut self, time: f64, particles: &Particles<D>) -> ControlFlow<()> {
        let _ = (time, particles);
        ControlFlow::Continue(())
    }

    /// The run ends at `time`.
    fn finish(&mut self, time: f64, particles: &Particles<D>) {
        let _ = (time, particles);
    }
}

impl<const D: usize> Observer<D> for () {}

impl<const D: usize, O: Observer<D> + ?Sized> Observer<D> for &mut O {
    fn begin(&mut self, time: f64, particles: &Particles<D>) {
        (**self).begin(time, particles);
    }
    #[inline]
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        (**self).contact(contact)
    }
    fn sample(&mut self, time: f64, particles: &Particles<D>) -> ControlFlow<()> {
        (**self).sample(time, particles)
    }
    fn finish(&mut self, time: f64, particles: &Particles<D>) {
        (**self).finish(time, particles);
    }
}

macro_rules! observe_as_tuple {
    ($($name:ident $index:tt),+) => {
        impl<const D: usize, $($name: Observer<D>),+> Observer<D> for ($($name,)+) {
            fn begin(&mut self, time: f64, particles: &Particles<D>) {
                $(self.$index.begin(time, particles);)+
            }
            #[inline]
            fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
                let mut flow = ControlFlow::Continue(());
                $(if self.$index.contact(contact).is_break() { flow = ControlFlow::Break(()); })+
                flow
            }
            fn sample(&mut self, time: f64, particles: &Particles<D>) -> ControlFlow<()> {
                let mut flow = ControlFlow::Continue(());
                $(if self.$index.sample(time, particles).is_break() { flow = ControlFlow::Break(()); })+
                flow
            }
            fn finish(&mut self, time: f64, particles: &Particles<D>) {
                $(self.$index.finish(time, particles);)+
            }
        }
    };
}

observe_as_tuple!(A 0);
observe_as_tuple!(A 0, B 1);
observe_as_tuple!(A 0, B 1, C 2);
observe_as_tuple!(A 0, B 1, C 2, E 3);
observe_as_tuple!(A 0, B 1, C 2, E 3, F 4);
