//! Memory: what a picture needs, what the machine has, what the program took.

use std::fs;

use whitted::film::Film;

/// The most memory a picture may need; a larger size is taken for a slip of the finger.
pub(crate) const MOST_BYTES: u128 = 16 << 30;

/// Bytes that a picture of this size needs until it is written: the film, its 8-bit form, and at
/// worst as much again as the finished file.
pub(crate) fn picture_bytes(width: u32, height: u32) -> u128 {
    Film::memory_bytes(width, height) + u128::from(width) * u128::from(height) * 6
}

/// Bytes that are kept of the pixels on the way to an error or a time, at least; those that are refined take about
/// twice as much.
pub(crate) fn goal_bytes(width: u32, height: u32) -> u128 {
    u128::from(width) * u128::from(height) * 100
}

/// The most memory the program has held so far, in bytes; unknown except on Linux.
pub(crate) fn peak() -> Option<u64> {
    kib_entry(&fs::read_to_string("/proc/self/status").ok()?, "VmHWM")
}

/// The memory that can be had without swapping, in bytes; unknown except on Linux.
pub(crate) fn available() -> Option<u64> {
    kib_entry(&fs::read_to_string("/proc/meminfo").ok()?, "MemAvailable")
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
    fn sizes_read_well() {
        assert_eq!(readable(3 << 29), "1.5 GiB");
        assert_eq!(readable(picture_bytes(u32::MAX, u32::MAX)), "3.780e11 GiB");
    }
}
