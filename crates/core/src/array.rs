//! Arrays of any fixed length for serde, which itself knows only certain lengths: `#[serde(with = "corpuscle_core::array")]`.

use std::fmt;
use std::marker::PhantomData;

use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Visitor};
use serde::ser::{Serialize, SerializeTuple, Serializer};

/// Writes the items one after the other.
///
/// # Errors
/// The serializer's.
pub fn serialize<S: Serializer, T: Serialize, const N: usize>(array: &[T; N], serializer: S) -> Result<S::Ok, S::Error> {
    let mut tuple = serializer.serialize_tuple(N)?;
    array.iter().try_for_each(|item| tuple.serialize_element(item))?;
    tuple.end()
}

/// Reads exactly as many items.
///
/// # Errors
/// The deserializer's, and when there are fewer.
pub fn deserialize<'de, D: Deserializer<'de>, T: Deserialize<'de> + Default, const N: usize>(
    deserializer: D,
) -> Result<[T; N], D::Error> {
    struct Items<T, const N: usize>(PhantomData<T>);
    impl<'de, T: Deserialize<'de> + Default, const N: usize> Visitor<'de> for Items<T, N> {
        type Value = [T; N];

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            write!(f, "{N} items")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<[T; N], A::Error> {
            let mut array = std::array::from_fn(|_| T::default());
            for (found, place) in array.iter_mut().enumerate() {
                *place = items.next_element()?.ok_or_else(|| A::Error::invalid_length(found, &self))?;
            }
            Ok(array)
        }
    }
    deserializer.deserialize_tuple(N, Items(PhantomData))
}
