//! Large arrays in large pages.
//!
//! The events of a large system are all over its memory. In pages of 4 KiB most of them first have to look up where
//! their pages are; in pages of 2 MiB few do. Measured: docs/performance.md.

/// An empty array with room for so many items, for which the system is asked to use large pages.
pub(crate) fn with_large_pages<T>(capacity: usize) -> Vec<T> {
    let items = Vec::with_capacity(capacity);
    #[cfg(target_os = "linux")]
    advise(&items);
    items
}

/// So many copies of an item.
pub(crate) fn filled<T: Clone>(item: T, count: usize) -> Vec<T> {
    let mut items = with_large_pages(count);
    items.resize(count, item);
    items
}

#[cfg(target_os = "linux")]
fn advise<T>(items: &Vec<T>) {
    /// Of smaller arrays all pages are known to the processor.
    const WORTH_WHILE: usize = 4 << 20;
    const PAGE: usize = 4096;
    let bytes = items.capacity() * size_of::<T>();
    if bytes < WORTH_WHILE {
        return;
    }
    let start = items.as_ptr().addr();
    let inside = start.next_multiple_of(PAGE) - start;
    let whole = (bytes - inside) / PAGE * PAGE;
    #[allow(unsafe_code, reason = "advice to the system; measured in docs/performance.md")]
    // SAFETY: the pages lie inside of the array's own memory, and this advice changes no content. Where the system does
    // not know it nothing happens.
    let _ = unsafe {
        rustix::mm::madvise(items.as_ptr().wrapping_byte_add(inside).cast_mut().cast(), whole, rustix::mm::Advice::LinuxHugepage)
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_arrays_are_arrays_like_others() {
        for count in [0, 1, 1000, 3_000_001] {
            let items = filled(7u64, count);
            assert!(items.len() == count && items.iter().all(|&item| item == 7));
        }
    }
}
