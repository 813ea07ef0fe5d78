//! The instructions of x86-64.
//!
//! The lanes of single precision are the same eight for all; AVX-512 does those of double precision, which the compiler
//! makes of loops, eight at a time.
#![allow(unsafe_code, reason = "instructions that not every machine has")]

use std::arch::x86_64::{
    __m256, _CMP_LE_OQ, _MM_HINT_T0, _mm_prefetch, _mm256_add_ps, _mm256_and_ps, _mm256_cmp_ps,
    _mm256_div_ps, _mm256_fmadd_ps, _mm256_fmsub_ps, _mm256_fnmadd_ps, _mm256_loadu_ps,
    _mm256_max_ps, _mm256_min_ps, _mm256_movemask_ps, _mm256_mul_ps, _mm256_set1_ps,
    _mm256_sqrt_ps, _mm256_storeu_ps, _mm256_sub_ps, _mm256_xor_ps,
};

#[cfg(test)]
use super::simd::Isa;
use super::simd::{Kernel, Lanes, Simd};

/// A method that is one intrinsic.
macro_rules! operations {
    ($($name:ident($($arg:ident),+) = $intrinsic:ident($($given:ident),+);)+) => { $(
        #[inline(always)]
        fn $name(self, $($arg: __m256),+) -> __m256 {
            // SAFETY: `self` proves that the machine has AVX2 and FMA.
            unsafe { $intrinsic($($given),+) }
        }
    )+ };
}

/// An instruction set: its features as the compiler names them, all together and one by one.
macro_rules! instructions {
    ($(#[$doc:meta])* $name:ident: $features:literal = $($feature:tt)and+) => {
        $(#[$doc])*
        ///
        /// Only `detect` makes one, so that a value proves the machine has all; this is what every `unsafe` here relies
        /// on.
        #[derive(Clone, Copy, Debug)]
        pub(super) struct $name(());

        impl $name {
            /// The proof, if the machine has the instructions (asked once by the standard library, then remembered).
            #[inline(always)]
            pub(super) fn detect() -> Option<Self> {
                ($(is_x86_feature_detected!($feature))&&+).then_some(Self(()))
            }
        }

        impl Simd for $name {
            type F = __m256;

            #[cfg(test)]
            const ISA: Isa = Isa::$name;

            #[inline(always)]
            fn vectorize<K: Kernel>(self, kernel: K) -> K::Output {
                #[target_feature(enable = $features)]
                #[inline(never)]
                fn compiled<K: Kernel>(simd: $name, kernel: K) -> K::Output {
                    kernel.run(simd)
                }
                // SAFETY: `self` proves that the machine has these features.
                unsafe { compiled(self, kernel) }
            }

            #[inline(always)]
            fn prefetch<T>(self, x: &T) {
                let start = std::ptr::from_ref(x).cast::<i8>();
                for line in 0..size_of::<T>().div_ceil(64) {
                    // SAFETY: a prefetch reads nothing; it may be of any address, and this one is within `x`.
                    unsafe { _mm_prefetch::<_MM_HINT_T0>(start.add(64 * line)) };
                }
            }

            #[inline(always)]
            fn splat(self, x: f32) -> __m256 {
                // SAFETY: `self` proves that the machine has these features.
                unsafe { _mm256_set1_ps(x) }
            }

            #[inline(always)]
            fn load(self, x: &[f32; 8]) -> __m256 {
                // SAFETY: as above; the reference is good for eight numbers, and no alignment is asked for.
                unsafe { _mm256_loadu_ps(x.as_ptr()) }
            }

            #[inline(always)]
            fn store(self, x: __m256) -> Lanes {
                let mut lanes = Lanes([0.0; 8]);
                // SAFETY: as above; `lanes` has room for eight numbers.
                unsafe { _mm256_storeu_ps(lanes.0.as_mut_ptr(), x) };
                lanes
            }

            operations! {
                add(a, b) = _mm256_add_ps(a, b);
                sub(a, b) = _mm256_sub_ps(a, b);
                mul(a, b) = _mm256_mul_ps(a, b);
                div(a, b) = _mm256_div_ps(a, b);
                mul_add(a, b, c) = _mm256_fmadd_ps(a, b, c);
                mul_sub(a, b, c) = _mm256_fmsub_ps(a, b, c);
                neg_mul_add(a, b, c) = _mm256_fnmadd_ps(a, b, c);
                min(a, b) = _mm256_min_ps(a, b);
                max(a, b) = _mm256_max_ps(a, b);
                sqrt(a) = _mm256_sqrt_ps(a);
            }

            #[inline(always)]
            fn toggle_sign(self, a: __m256, b: __m256) -> __m256 {
                // SAFETY: `self` proves that the machine has these features.
                unsafe { _mm256_xor_ps(a, _mm256_and_ps(b, _mm256_set1_ps(-0.0))) }
            }

            #[inline(always)]
            fn le(self, a: __m256, b: __m256) -> u32 {
                // SAFETY: `self` proves that the machine has these features.
                unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(a, b)) as u32 }
            }
        }
    };
}

instructions! {
    /// AVX2 and FMA.
    Avx2: "avx2,fma" = "avx2" and "fma"
}

instructions! {
    /// AVX-512, with vectors of all lengths.
    Avx512: "avx2,fma,avx512f,avx512vl,avx512dq,avx512bw" =
        "avx2" and "fma" and "avx512f" and "avx512vl" and "avx512dq" and "avx512bw"
}
