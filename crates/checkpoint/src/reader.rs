//! Taking up.

use rmp_serde::Deserializer;
use rmp_serde::decode::ReadReader;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::{Fault, Resume};

/// A state in MessagePack, being read. Whatever the bytes, it takes memory in proportion to their number at most.
pub struct Reader<'a>(Deserializer<ReadReader<&'a [u8]>>);

impl<'a> Reader<'a> {
    /// From the beginning.
    pub fn new(bytes: &'a [u8]) -> Self {
        let mut deserializer = Deserializer::new(bytes);
        // States are shallow; strangers' bytes need not be.
        deserializer.set_max_depth(64);
        Self(deserializer)
    }

    /// As many fields as are expected follow.
    ///
    /// # Errors
    /// When there are more or fewer, or something else is there.
    pub fn fields(&mut self, expected: usize) -> Result<(), Fault> {
        let found = rmp::decode::read_map_len(self.0.get_mut()).map_err(Fault::new)?;
        if found as usize == expected { Ok(()) } else { Err(Fault::new(format!("{found} fields where {expected} belong"))) }
    }

    /// As many items as are expected follow.
    ///
    /// # Errors
    /// When there are more or fewer, or something else is there.
    pub fn items(&mut self, expected: usize) -> Result<(), Fault> {
        let found = rmp::decode::read_array_len(self.0.get_mut()).map_err(Fault::new)?;
        if found as usize == expected { Ok(()) } else { Err(Fault::new(format!("{found} items where {expected} belong"))) }
    }

    /// A field that was written down whole.
    ///
    /// # Errors
    /// When a field of another name or something of another type is there.
    pub fn value<T: DeserializeOwned>(&mut self, name: &str) -> Result<T, Fault> {
        self.name(name)?;
        T::deserialize(&mut self.0).map_err(|error| Fault::new(error).within(name))
    }

    /// A field that knows itself what was written down.
    ///
    /// # Errors
    /// The part's, with its name; when a field of another name is there.
    pub fn part(&mut self, name: &str, part: &mut (impl Resume + ?Sized)) -> Result<(), Fault> {
        self.name(name)?;
        part.load(self).map_err(|fault| fault.within(name))
    }

    /// Nothing follows.
    ///
    /// # Errors
    /// When something does.
    pub fn end(mut self) -> Result<(), Fault> {
        let rest = self.0.get_mut().len();
        if rest == 0 { Ok(()) } else { Err(Fault::new(format!("{rest} bytes too many"))) }
    }

    fn name(&mut self, expected: &str) -> Result<(), Fault> {
        match String::deserialize(&mut self.0) {
            Ok(found) if found == expected => Ok(()),
            Ok(found) => Err(Fault::new(format!("the field `{found}` where this one belongs")).within(expected)),
            Err(error) => Err(Fault::new(error).within(expected)),
        }
    }
}
