/// Asks the processor for an item of a list before a loop comes to it: a hint without effect on results, and without any at all past the end
/// of the list and on processors other than x86-64.
///
/// It pays where a loop computes long on each item and the processor does not look ahead as far as the next ones: in the one over bonds, where it
/// halves the time of large bodies, and not in those over cells of solids (0 to 4 %).
#[inline(always)]
pub fn prefetch<T>(items: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    if let Some(item) = items.get(index) {
        use core::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        const LINE: usize = 64;
        let mut byte = 0;
        while byte < size_of::<T>() {
            // SAFETY: the hint reads nothing.
            #[allow(unsafe_code)]
            unsafe {
                _mm_prefetch::<_MM_HINT_T0>(core::ptr::from_ref(item).cast::<i8>().wrapping_add(byte));
            }
            byte += LINE;
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (items, index);
}
