//! What the hot loop is compiled for: a law of flight and a law of pairs, chosen once per `advance`.
//!
//! Laws are types without a size, so that each has a copy of the loop in which nothing is asked twice, and hard spheres
//! in free flight pay for no other.

use std::marker::PhantomData;

/// Free flight or a field, and what pairs do.
pub(crate) trait Law {
    /// Whether there is a uniform field.
    const FIELD: bool;
    /// What pairs do.
    const PAIRS: Pairs;
}

/// What pairs do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pairs {
    /// They collide.
    Hard,
    /// They pass the edges of wells, too.
    InWells,
    /// They collide, and grow.
    Growing,
}

/// One of [`Pairs`], as a type.
pub(crate) trait PairLaw {
    const PAIRS: Pairs;
}

pub(crate) struct Hard;
pub(crate) struct InWells;
pub(crate) struct Growing;

impl PairLaw for Hard {
    const PAIRS: Pairs = Pairs::Hard;
}

impl PairLaw for InWells {
    const PAIRS: Pairs = Pairs::InWells;
}

impl PairLaw for Growing {
    const PAIRS: Pairs = Pairs::Growing;
}

/// Straight lines.
pub(crate) struct Free<P>(PhantomData<P>);

/// Parabolas.
pub(crate) struct InField<P>(PhantomData<P>);

impl<P: PairLaw> Law for Free<P> {
    const FIELD: bool = false;
    const PAIRS: Pairs = P::PAIRS;
}

impl<P: PairLaw> Law for InField<P> {
    const FIELD: bool = true;
    const PAIRS: Pairs = P::PAIRS;
}

/// Calls a method of an engine in the copy compiled for its law.
macro_rules! under_its_law {
    ($engine:ident.$method:ident($($argument:expr),*)) => {{
        use $crate::law::{Free, Growing, Hard, InField, InWells, Pairs};
        match ($engine.rules.field == Vector::ZERO, $engine.pairs.law()) {
            (true, Pairs::Hard) => $engine.$method::<Free<Hard>>($($argument),*),
            (true, Pairs::InWells) => $engine.$method::<Free<InWells>>($($argument),*),
            (true, Pairs::Growing) => $engine.$method::<Free<Growing>>($($argument),*),
            (false, Pairs::Hard) => $engine.$method::<InField<Hard>>($($argument),*),
            (false, Pairs::InWells) => $engine.$method::<InField<InWells>>($($argument),*),
            (false, Pairs::Growing) => $engine.$method::<InField<Growing>>($($argument),*),
        }
    }};
}
pub(crate) use under_its_law;
