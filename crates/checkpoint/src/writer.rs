//! Writing down.

use rmp_serde::Serializer;
use rmp_serde::config::{DefaultConfig, StructMapConfig};
use serde::Serialize;

use crate::{Fault, Resume};

/// A state in MessagePack, growing.
pub struct Writer(Serializer<Vec<u8>, StructMapConfig<DefaultConfig>>);

impl Default for Writer {
    fn default() -> Self {
        Self::new()
    }
}

impl Writer {
    /// Nothing written yet.
    pub fn new() -> Self {
        Self(Serializer::new(vec![]).with_struct_map())
    }

    /// What was written.
    pub fn finish(self) -> Vec<u8> {
        self.0.into_inner()
    }

    /// This many fields follow: values or parts.
    ///
    /// # Errors
    /// None but those of the format: more than 2^32.
    pub fn fields(&mut self, count: usize) -> Result<(), Fault> {
        let count = u32::try_from(count).map_err(Fault::new)?;
        rmp::encode::write_map_len(self.0.get_mut(), count).map(|_| ()).map_err(Fault::new)
    }

    /// This many items follow, without names.
    ///
    /// # Errors
    /// As [`fields`](Self::fields).
    pub fn items(&mut self, count: usize) -> Result<(), Fault> {
        let count = u32::try_from(count).map_err(Fault::new)?;
        rmp::encode::write_array_len(self.0.get_mut(), count).map(|_| ()).map_err(Fault::new)
    }

    /// A field that is written down whole.
    ///
    /// # Errors
    /// When its type has no place in MessagePack.
    pub fn value(&mut self, name: &str, value: &(impl Serialize + ?Sized)) -> Result<(), Fault> {
        name.serialize(&mut self.0).map_err(Fault::new)?;
        value.serialize(&mut self.0).map_err(|error| Fault::new(error).within(name))
    }

    /// A field that knows itself what to write down.
    ///
    /// # Errors
    /// The part's, with its name.
    pub fn part(&mut self, name: &str, part: &(impl Resume + ?Sized)) -> Result<(), Fault> {
        name.serialize(&mut self.0).map_err(Fault::new)?;
        part.save(self).map_err(|fault| fault.within(name))
    }
}
