//! How much memory is left, so that what cannot fit is refused with its size instead of ending the program.

use std::fs;

use crate::number::significant;

/// What needs more memory than there is.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{what} needs about {} of memory, and {} are free", bytes(*needed), bytes(*available))]
pub struct TooLarge {
    /// What needs it, in the user's words.
    pub what: String,
    /// How much [bytes].
    pub needed: u64,
    /// How much is left [bytes].
    pub available: u64,
}

/// Makes sure that `needed` more bytes fit into memory; where the system does not tell, they do.
///
/// # Errors
/// [`TooLarge`].
pub fn require(needed: u64, what: impl Into<String>) -> Result<(), TooLarge> {
    match available() {
        Some(available) if needed > available => Err(TooLarge { what: what.into(), needed, available }),
        _ => Ok(()),
    }
}

/// Bytes that this process may still take, by the free memory of the machine, the limit of its control group and that of
/// its address space (`ulimit -v`); none where the system tells nothing, as others than Linux.
pub fn available() -> Option<u64> {
    let read = |path: &str| fs::read_to_string(path).ok();
    let free = read("/proc/meminfo").and_then(|text| {
        // Swapped memory is slow but memory.
        Some(1024 * (field(&text, "MemAvailable:")? + field(&text, "SwapFree:").unwrap_or(0)))
    });
    let status = read("/proc/self/status").unwrap_or_default();
    let own = |name| 1024 * field(&status, name).unwrap_or(0);
    let space = read("/proc/self/limits").and_then(|text| field(&text, "Max address space"));
    let group = read("/proc/self/cgroup").and_then(|text| {
        let path = text.lines().find_map(|line| line.strip_prefix("0::"))?.to_owned();
        let limit = read(&format!("/sys/fs/cgroup{path}/memory.max")).or_else(|| read("/sys/fs/cgroup/memory.max"))?;
        limit.trim().parse::<u64>().ok()
    });
    let space = space.map(|limit| limit.saturating_sub(own("VmSize:")));
    let group = group.map(|limit| limit.saturating_sub(own("VmRSS:")));
    [free, space, group].into_iter().flatten().min()
}

/// The whole number behind a name in a file of the system.
fn field(text: &str, name: &str) -> Option<u64> {
    let rest = text.lines().find_map(|line| line.strip_prefix(name))?;
    rest.split_whitespace().next()?.parse().ok()
}

/// A number of bytes as people read it.
fn bytes(count: u64) -> String {
    let names = [(1u64 << 40, "TiB"), (1 << 30, "GiB"), (1 << 20, "MiB"), (1 << 10, "KiB")];
    match names.into_iter().find(|(size, _)| count >= *size) {
        Some((size, name)) => format!("{} {name}", significant(count as f64 / size as f64, 3)),
        None => format!("{count} bytes"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn what_no_machine_has_is_refused_with_both_numbers() {
        assert!(require(1 << 20, "a little").is_ok());
        let error = require(1 << 60, "a mesh of 10^15 tetrahedra").unwrap_err();
        let said = error.to_string();
        assert!(said.starts_with("a mesh of 10^15 tetrahedra needs about "), "{said}");
        assert!(said.contains(" TiB of memory, and ") && said.ends_with(" are free"), "{said}");
    }

    #[test]
    fn fields_of_the_system_are_found_by_name() {
        let text = "MemTotal: 24 kB\nMemAvailable:   7 kB\nMax address space         unlimited  unlimited  bytes\n";
        assert_eq!((field(text, "MemAvailable:"), field(text, "SwapFree:")), (Some(7), None));
        assert_eq!(field(text, "Max address space"), None);
        assert_eq!([bytes(12), bytes(3 << 30), bytes(1536)], ["12 bytes", "3 GiB", "1.5 KiB"]);
    }
}
