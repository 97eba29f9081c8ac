//! What a checkpoint keeps of something that is set up again before it goes on.
//!
//! A system is described by its scenario, from which it is set up; while it runs, some of it changes. A checkpoint holds
//! what has changed, each field under its name, in MessagePack (<https://msgpack.org>): any reader of that format can
//! look into it, and every `f64` has its 64 bits. To go on, the system is set up again and then put where the checkpoint
//! left it.
//!
//! [`resume!`] writes both directions from one list of fields, in which every field has to stand:
//!
//! ```
//! use corpuscle_checkpoint::{Reader, Resume, Writer, resume};
//!
//! struct Walk { step: f64, places: Vec<f64> }
//! resume!(Walk { values: [places], set_up: [step] });
//!
//! let mut out = Writer::new();
//! out.part("walk", &Walk { step: 0.5, places: vec![0.0, 0.5, 1.0] })?;
//! let mut again = Walk { step: 0.5, places: vec![] };
//! Reader::new(&out.finish()).part("walk", &mut again)?;
//! assert_eq!(again.places, [0.0, 0.5, 1.0]);
//! # Ok::<(), corpuscle_checkpoint::Fault>(())
//! ```

mod reader;
mod writer;

use std::collections::VecDeque;

pub use reader::Reader;
pub use writer::Writer;

/// Why a state could not be written down or taken up.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{path}: {cause}")]
pub struct Fault {
    /// The names of the fields on the way there, joined by dots.
    pub path: String,
    /// What is wrong.
    pub cause: String,
}

impl Fault {
    /// A fault found by the owner of the field being read or written.
    #[allow(clippy::needless_pass_by_value, reason = "errors are handed over as they come")]
    pub fn new(cause: impl ToString) -> Self {
        Self { path: String::new(), cause: cause.to_string() }
    }

    fn within(mut self, name: &str) -> Self {
        let dot = if self.path.is_empty() { "" } else { "." };
        self.path = format!("{name}{dot}{}", self.path);
        self
    }
}

/// Something that is set up from its description, and then put where a checkpoint left it.
///
/// Usually written by [`resume!`].
pub trait Resume {
    /// Writes down what has changed since the set-up.
    ///
    /// # Errors
    /// When it holds what cannot be written down.
    fn save(&self, out: &mut Writer) -> Result<(), Fault>;

    /// Takes up what [`save`](Self::save) wrote of one that was set up alike. After an error `self` is of no use.
    ///
    /// # Errors
    /// When what stands there is not that.
    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Fault>;
}

/// Implements [`Resume`] from a list of all fields: `values` that change and are written down whole, `parts` that are
/// [`Resume`] themselves, and what stays as it was `set_up` or is worked out again, by the method `then` if there is one, which
/// answers `Result<(), Fault>`. A field that is in no list does not compile.
#[macro_export]
macro_rules! resume {
    ($type:ident $(<const $d:ident>)? { values: [$($value:ident),* $(,)?] $(, parts: [$($part:ident),* $(,)?])?
        $(, set_up: [$($constant:ident),* $(,)?])? $(, then: $then:ident)? $(,)? }) => {
        impl $(<const $d: usize>)? $crate::Resume for $type $(<$d>)? {
            fn save(&self, out: &mut $crate::Writer) -> Result<(), $crate::Fault> {
                let Self { $($value,)* $($($part,)*)? $($($constant: _,)*)? } = self;
                let names: &[&str] = &[$(stringify!($value),)* $($(stringify!($part),)*)?];
                out.fields(names.len())?;
                $(out.value(stringify!($value), $value)?;)*
                $($(out.part(stringify!($part), $part)?;)*)?
                Ok(())
            }

            fn load(&mut self, from: &mut $crate::Reader<'_>) -> Result<(), $crate::Fault> {
                let Self { $($value,)* $($($part,)*)? $($($constant: _,)*)? } = self;
                let names: &[&str] = &[$(stringify!($value),)* $($(stringify!($part),)*)?];
                from.fields(names.len())?;
                $(*$value = from.value(stringify!($value))?;)*
                $($(from.part(stringify!($part), $part)?;)*)?
                $(self.$then()?;)?
                Ok(())
            }
        }
    };
}

macro_rules! sequences {
    ($($type:ident),*) => {$(
        /// As many as were set up, each in its turn.
        impl<T: Resume> Resume for $type<T> {
            fn save(&self, out: &mut Writer) -> Result<(), Fault> {
                out.items(self.len())?;
                self.iter().enumerate().try_for_each(|(i, item)| item.save(out).map_err(|fault| fault.within(&i.to_string())))
            }

            fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Fault> {
                from.items(self.len())?;
                self.iter_mut().enumerate().try_for_each(|(i, item)| item.load(from).map_err(|fault| fault.within(&i.to_string())))
            }
        }
    )*};
}
sequences!(Vec, VecDeque);

/// Something and its label, which is set up.
impl<L, T: Resume> Resume for (L, T) {
    fn save(&self, out: &mut Writer) -> Result<(), Fault> {
        self.1.save(out)
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Fault> {
        self.1.load(from)
    }
}

impl<T: Resume + ?Sized> Resume for Box<T> {
    fn save(&self, out: &mut Writer) -> Result<(), Fault> {
        (**self).save(out)
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Fault> {
        (**self).load(from)
    }
}

#[cfg(test)]
mod tests;
