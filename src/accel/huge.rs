//! Memory in large pages, so that a ray through gigabytes does not wait for the tables of small ones, and memory given
//! back.
#![allow(unsafe_code, reason = "the advice to the system is a foreign function")]

/// An empty vector with room for `count` elements, in large pages where the system has some.
pub(crate) fn vec_with_capacity<T>(count: usize) -> Vec<T> {
    let vec: Vec<T> = Vec::with_capacity(count);
    advise(&vec);
    vec
}

/// Asks for large pages for a vector's memory, none of which has been written to; what the allocator has zeroed has
/// not.
pub(super) fn advise<T>(vec: &Vec<T>) {
    #[cfg(target_os = "linux")]
    linux::advise(vec.as_ptr().addr(), vec.capacity() * size_of::<T>());
}

/// Gives back to the system what the allocator keeps of memory that is free; GNU's keeps tens of megabytes.
pub(super) fn give_back() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    linux::trim();
}

#[cfg(target_os = "linux")]
mod linux {
    use std::ffi::{c_int, c_void};

    /// The size of a large page; where it is another, the advice covers a little less or is refused.
    const PAGE: usize = 1 << 21;

    const MADV_HUGEPAGE: c_int = 14;

    unsafe extern "C" {
        fn madvise(address: *mut c_void, length: usize, advice: c_int) -> c_int;
        #[cfg(target_env = "gnu")]
        fn malloc_trim(pad: usize) -> c_int;
    }

    /// Has the allocator give back all free memory.
    #[cfg(target_env = "gnu")]
    pub(super) fn trim() {
        // SAFETY: the function takes the allocator's own locks and touches no memory that is in use.
        let _ = unsafe { malloc_trim(0) };
    }

    /// Asks for large pages in the part of the memory at `start` that they can cover.
    pub(super) fn advise(start: usize, length: usize) {
        let (first, end) = (start.next_multiple_of(PAGE), (start + length) / PAGE * PAGE);
        if first < end {
            let address = std::ptr::without_provenance_mut(first);
            // SAFETY: the advice changes by what pages memory is backed, not what is in it, and it is the vector's own
            // memory. If it is refused, nothing happens.
            let _ = unsafe { madvise(address, end - first, MADV_HUGEPAGE) };
        }
    }
}
