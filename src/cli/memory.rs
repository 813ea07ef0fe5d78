//! Memory: what a picture needs, what the machine has, what the program took.

use std::fs;

use anyhow::anyhow;
use whitted::film::Film;

use super::failure::Failure;

/// The most memory a picture may need; a larger size is taken for a slip of the finger.
pub(crate) const MOST_BYTES: u128 = 16 << 30;

/// Bytes that a picture of this size needs until it is written: the film, its 8-bit form, and at
/// worst as much again as the finished file.
pub(crate) fn picture_bytes(width: u32, height: u32) -> u128 {
    Film::memory_bytes(width, height) + u128::from(width) * u128::from(height) * 6
}

/// Bytes that are kept of the pixels on the way to an error or a time, about; those in smooth parts take less, those
/// that are refined twice as much.
pub(crate) fn goal_bytes(width: u32, height: u32) -> u128 {
    u128::from(width) * u128::from(height) * 110
}

/// Bytes that an object and its part of the tree need while that is built, which is when they need most.
const OBJECT_BYTES: u128 = 240;

/// Addresses that an object needs then, and what the threads reserve besides. Few systems limit them.
const OBJECT_ADDRESSES: u128 = 300;
const THREADS_ADDRESSES: u128 = 256 << 20;

/// So many objects are refused before they are made, if the memory at hand does not hold them.
pub(crate) fn check_objects(objects: u32) -> Result<(), Failure> {
    objects_fit(objects, free(), addresses_left())
}

fn objects_fit(objects: u32, free: Option<u64>, addresses: Option<u64>) -> Result<(), Failure> {
    let needed = u128::from(objects) * OBJECT_BYTES;
    let reserved = u128::from(objects) * OBJECT_ADDRESSES + THREADS_ADDRESSES;
    for (needed, available) in [(needed, free), (reserved, addresses)] {
        if let Some(available) = available.map(u128::from)
            && needed > available
        {
            Err(anyhow!(
                "{objects} objects need {} of memory, of which {} are free; choose a smaller --objects",
                readable(needed),
                readable(available),
            ))?;
        }
    }
    Ok(())
}

/// The most memory the program has held so far, in bytes; unknown except on Linux.
pub(crate) fn peak() -> Option<u64> {
    kib_entry(&fs::read_to_string("/proc/self/status").ok()?, "VmHWM")
}

/// The memory that can be had without swapping, and within the limit of the shell, in bytes; unknown except on Linux.
pub(crate) fn available() -> Option<u64> {
    [free(), addresses_left()].into_iter().flatten().min()
}

/// The memory that can be had without swapping.
fn free() -> Option<u64> {
    kib_entry(&fs::read_to_string("/proc/meminfo").ok()?, "MemAvailable")
}

/// The addresses that can be had, if their number is limited.
fn addresses_left() -> Option<u64> {
    let table = |name: &str| fs::read_to_string(format!("/proc/self/{name}")).ok();
    addresses_within(&table("limits")?, &table("status")?)
}

/// The addresses that a process with these limits and of this status may add; `None` if it may have as many as it likes.
fn addresses_within(limits: &str, status: &str) -> Option<u64> {
    let limit = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let limit: u64 = limit.split_whitespace().next()?.parse().ok()?;
    Some(limit.saturating_sub(kib_entry(status, "VmSize")?))
}

/// The value of a line such as `VmHWM:     5432 kB`, in bytes.
fn kib_entry(table: &str, name: &str) -> Option<u64> {
    let line = table.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(':'))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

/// Bytes for reading: `23.5 GiB`.
pub(crate) fn readable(bytes: u128) -> String {
    let gib = bytes as f64 / f64::from(1 << 30);
    if gib >= 1000.0 { format!("{gib:.3e} GiB") } else { format!("{gib:.1} GiB") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_found_by_their_whole_name() {
        let table = "Name:\tVmHWM\nVmHWMx:\t 1 kB\nVmHWM:\t    5432 kB\nVmRSS:\t 2 kB\n";
        assert_eq!(kib_entry(table, "VmHWM"), Some(5432 * 1024));
        assert_eq!(kib_entry(table, "VmRSS"), Some(2048));
        assert_eq!(kib_entry(table, "VmPeak"), None);
        assert_eq!(kib_entry("VmHWM: many kB", "VmHWM"), None);
    }

    /// Oracle: the test itself holds 64 MiB when it asks.
    #[cfg(target_os = "linux")]
    #[test]
    fn peak_counts_what_was_held() {
        let held = vec![1_u8; 64 << 20];
        assert!(peak().expect("known on Linux") >= held.len() as u64);
        assert!(available().expect("known on Linux") > 0);
    }

    #[test]
    fn a_limit_on_addresses_counts_what_is_used() {
        let limits =
            "Limit   Soft Limit  Hard Limit  Units\nMax address space   {}   unlimited   bytes\n";
        let left = |limit| addresses_within(&limits.replace("{}", limit), "VmSize:\t  2 kB\n");
        assert_eq!(left("unlimited"), None);
        assert_eq!(left("5000"), Some(5000 - 2048));
        assert_eq!(left("1000"), Some(0));
    }

    #[test]
    fn objects_that_no_memory_holds_are_refused() {
        let fit = |free, addresses| objects_fit(10_000_000, free, addresses);
        let (enough, addresses) = (Some(2_400_000_000), Some(3_300_000_000));
        assert!(fit(None, None).is_ok() && fit(enough, addresses).is_ok());
        let error = fit(enough.map(|free| free - 1), addresses).expect_err("too many").to_string();
        assert_eq!(
            error,
            "10000000 objects need 2.2 GiB of memory, of which 2.2 GiB are free; choose a smaller --objects"
        );
        assert!(fit(enough, Some(3_200_000_000)).is_err());
    }

    #[test]
    fn sizes_read_well() {
        assert_eq!(readable(3 << 29), "1.5 GiB");
        assert_eq!(readable(picture_bytes(u32::MAX, u32::MAX)), "3.780e11 GiB");
    }
}
