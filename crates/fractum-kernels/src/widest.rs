/// A function compiled twice: for any processor, and for those with vectors of 256 bits and fused products (AVX2, FMA).
///
/// Both do the same operations, hence give the same bits: `mul_add` is rounded once everywhere, by one instruction or by
/// the `fma` of the C library, which is slow but exact by its standard. Bodies are `#[inline(always)]` functions, and so
/// is what they call in their loops; `mul_add` belongs in no other code.
///
/// ```
/// #[inline(always)]
/// fn add_multiple(y: &mut [f64], x: &[f64], factor: f64) {
///     y.iter_mut().zip(x).for_each(|(y, x)| *y = x.mul_add(factor, *y));
/// }
/// fractum_kernels::widest! {
///     /// y ← y + factor x.
///     fn add_multiple_fast(y: &mut [f64], x: &[f64], factor: f64) = add_multiple;
/// }
/// let mut y = [1.0, 2.0];
/// add_multiple_fast(&mut y, &[1.0, 1.0], 0.5);
/// assert_eq!(y, [1.5, 2.5]);
/// ```
///
/// A long body may name a short one of the same bits, `= long, otherwise short`, for processors of this family without those vectors: they are
/// old and slow anyway, and the long body need not be compiled for them.
#[macro_export]
macro_rules! widest {
    (
        $(#[$attribute:meta])*
        $visible:vis fn $name:ident$(<$law:ident: $bound:path $(, const $number:ident: $kind:ty)*>)?
            ($($argument:ident: $type:ty),* $(,)?) $(-> $result:ty)? = $body:path;
    ) => {
        $crate::widest! {
            $(#[$attribute])*
            $visible fn $name$(<$law: $bound $(, const $number: $kind)*>)?($($argument: $type),*) $(-> $result)?
                = $body, otherwise $body;
        }
    };
    (
        $(#[$attribute:meta])*
        $visible:vis fn $name:ident$(<$law:ident: $bound:path $(, const $number:ident: $kind:ty)*>)?
            ($($argument:ident: $type:ty),* $(,)?) $(-> $result:ty)? = $body:path, otherwise $short:path;
    ) => {
        $(#[$attribute])*
        $visible fn $name$(<$law: $bound $(, const $number: $kind)*>)?($($argument: $type),*) $(-> $result)? {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2,fma")]
                fn wide$(<$law: $bound $(, const $number: $kind)*>)?($($argument: $type),*) $(-> $result)? {
                    $body($($argument),*)
                }
                if $crate::has_wide_vectors() {
                    // SAFETY: the instruction sets were found on this machine.
                    #[allow(unsafe_code)]
                    return unsafe { wide$(::<$law $(, $number)*>)?($($argument),*) };
                }
                $short($($argument),*)
            }
            #[cfg(not(target_arch = "x86_64"))]
            {
                $body($($argument),*)
            }
        }
    };
}

/// Whether this processor has vectors of 256 bits and fused products (AVX2, FMA); unknown, hence not used, without the standard library.
#[inline(always)]
pub fn has_wide_vectors() -> bool {
    #[cfg(all(feature = "std", target_arch = "x86_64"))]
    return std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma");
    #[cfg(not(all(feature = "std", target_arch = "x86_64")))]
    return false;
}

#[cfg(test)]
mod tests {
    use std::process::Command;

    /// What a fused product may not do: round the product first, or the sum twice where it is subnormal.
    fn hard_cases() -> Vec<[f64; 3]> {
        let mut cases = vec![
            [1.0 + f64::EPSILON, 1.0 - f64::EPSILON / 2.0, -1.0],
            [f64::MIN_POSITIVE, 0.5 + f64::EPSILON, f64::from_bits(1)],
            [f64::MIN_POSITIVE * 1.5, 0.25 + f64::EPSILON, -f64::from_bits(3)],
            [1e200, 1e200, f64::NEG_INFINITY],
            [f64::MAX, 2.0, -f64::MAX],
            [-0.0, 3.0, 0.0],
        ];
        let mut state = 11u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            f64::from_bits(state >> 12 | 1023 << 52) * 2f64.powi((state >> 8) as i32 % 5 - 2)
        };
        for _ in 0..20_000 {
            let (a, b) = (next(), next());
            // The sum cancels most of the product.
            cases.extend([[a, b, -a * b], [a, b, -a * b * next()], [a * 1e-160, b * 1e-160, next() * 1e-320]]);
        }
        cases
    }

    #[test]
    fn fused_products_of_the_c_library_are_exact() {
        for [a, b, c] in hard_cases().into_iter().map(std::hint::black_box) {
            assert_eq!(a.mul_add(b, c).to_bits(), libm::fma(a, b, c).to_bits(), "{a:e} {b:e} {c:e}");
        }
        // Once more where the C library may not use the instruction.
        const HIDDEN: (&str, &str) = ("GLIBC_TUNABLES", "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX2_Usable,-FMA_Usable");
        if std::env::var(HIDDEN.0).is_err() {
            let program = std::env::current_exe().unwrap();
            let this = "widest::tests::fused_products_of_the_c_library_are_exact";
            let output = Command::new(program).args([this, "--exact"]).env(HIDDEN.0, HIDDEN.1).output().unwrap();
            let text = String::from_utf8_lossy(&output.stdout);
            assert!(output.status.success() && text.contains("1 passed"), "{text}");
        }
    }
}
