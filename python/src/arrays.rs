//! Numbers as the bytes of arrays, which cost one copy, and back.

use fractum_math::Vec3;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// Three numbers for each of `count` entries.
pub(crate) fn vectors<'py>(py: Python<'py>, count: usize, of: impl Fn(usize) -> Vec3) -> PyResult<Bound<'py, PyBytes>> {
    numbers::<3>(py, count, |i| of(i).into())
}

/// `N` numbers for each of `count` entries.
pub(crate) fn numbers<'py, const N: usize>(
    py: Python<'py>,
    count: usize,
    of: impl Fn(usize) -> [f64; N],
) -> PyResult<Bound<'py, PyBytes>> {
    PyBytes::new_with(py, size_of::<[f64; N]>() * count, |bytes| {
        for (i, entry) in bytes.chunks_exact_mut(size_of::<[f64; N]>()).enumerate() {
            for (slot, value) in entry.chunks_exact_mut(size_of::<f64>()).zip(of(i)) {
                slot.copy_from_slice(&value.to_ne_bytes());
            }
        }
        Ok(())
    })
}

/// Whole numbers.
pub(crate) fn indices<'py>(py: Python<'py>, values: impl Iterator<Item = u32>) -> Bound<'py, PyBytes> {
    let bytes: Vec<u8> = values.flat_map(u32::to_ne_bytes).collect();
    PyBytes::new(py, &bytes)
}

/// Flags, a byte each.
pub(crate) fn flags<'py>(py: Python<'py>, values: impl Iterator<Item = bool>) -> Bound<'py, PyBytes> {
    let bytes: Vec<u8> = values.map(u8::from).collect();
    PyBytes::new(py, &bytes)
}

/// The whole numbers that bytes of an array hold.
pub(crate) fn to_indices(bytes: &[u8]) -> Vec<u32> {
    let whole = bytes.as_chunks().0;
    whole.iter().map(|bytes| u32::from_ne_bytes(*bytes)).collect()
}
