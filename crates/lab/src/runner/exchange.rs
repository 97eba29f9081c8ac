//! The newest value, from one thread to another, without either waiting for the other.
//!
//! A triple buffer: the writer fills its own value, the reader looks at its own, and the third lies between them. The lock is
//! held for a swap of two pointers only. Values go round, so that their memory is used again.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What lies between the two, and whether the reader has not seen it yet.
struct Between<T> {
    value: Box<T>,
    fresh: bool,
}

/// The end that writes.
pub(crate) struct Writer<T> {
    own: Box<T>,
    between: Arc<Mutex<Between<T>>>,
}

/// The end that reads.
pub(crate) struct Reader<T> {
    own: Box<T>,
    between: Arc<Mutex<Between<T>>>,
}

/// Two ends that start with default values.
pub(crate) fn exchange<T: Default>() -> (Writer<T>, Reader<T>) {
    let between = Arc::new(Mutex::new(Between { value: Box::default(), fresh: false }));
    (Writer { own: Box::default(), between: between.clone() }, Reader { own: Box::default(), between })
}

/// Nothing under the lock can panic, so that what a poisoned one holds is whole.
fn lock<T>(between: &Mutex<Between<T>>) -> MutexGuard<'_, Between<T>> {
    between.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<T> Writer<T> {
    /// The value to fill next; what it holds is some older value.
    pub(crate) fn value(&mut self) -> &mut T {
        &mut self.own
    }

    /// Hands the value over, in place of an older one that nobody has looked at.
    pub(crate) fn publish(&mut self) {
        let mut between = lock(&self.between);
        std::mem::swap(&mut self.own, &mut between.value);
        between.fresh = true;
    }

    /// Whether the reader has taken what was published last.
    pub(crate) fn is_taken(&self) -> bool {
        !lock(&self.between).fresh
    }
}

impl<T> Reader<T> {
    /// Takes the newest value, if there is one that has not been seen; whether there was.
    pub(crate) fn refresh(&mut self) -> bool {
        let mut between = lock(&self.between);
        let fresh = std::mem::take(&mut between.fresh);
        if fresh {
            std::mem::swap(&mut self.own, &mut between.value);
        }
        fresh
    }

    /// The value last taken.
    pub(crate) fn value(&self) -> &T {
        &self.own
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reader_sees_the_newest_value_once() {
        let (mut writer, mut reader) = exchange::<u32>();
        assert!(!reader.refresh());
        for n in 1..=3 {
            *writer.value() = n;
            writer.publish();
        }
        assert!(!writer.is_taken());
        assert!(reader.refresh() && !reader.refresh());
        assert_eq!(*reader.value(), 3);
        assert!(writer.is_taken());
    }

    #[test]
    fn values_arrive_whole_and_in_order() {
        let (mut writer, mut reader) = exchange::<Vec<u64>>();
        let thread = std::thread::spawn(move || {
            for n in 0..20_000u64 {
                let value = writer.value();
                value.clear();
                value.extend([n; 16]);
                writer.publish();
            }
        });
        let mut last = 0;
        loop {
            let ended = thread.is_finished();
            if reader.refresh() {
                let value = reader.value();
                assert!(value.len() == 16 && value.iter().all(|&n| n == value[0]) && value[0] >= last);
                last = value[0];
            } else if ended {
                break;
            }
        }
        assert_eq!(last, 19_999);
    }
}
