//! AVX2 and FMA: two registers for 16 lanes (Haswell and Zen, and later).

#[allow(clippy::wildcard_imports, reason = "the intrinsics, whose names say where they are from")]
use core::arch::x86_64::*;

use crate::kernels::lanes::Lanes;
use crate::kernels::simd::doubles::{Doubles, EIGHT, ROOT};
use crate::kernels::simd::{Elementwise, Simd};

/// Token that proves that the CPU has AVX2 and FMA.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx2(());

impl Avx2 {
    /// # Safety
    /// The CPU has AVX2 and FMA.
    pub(crate) const unsafe fn assume() -> Self {
        Self(())
    }
}

type Pair = [__m256; 2];

/// Defines methods that apply one expression to both registers. (Closures would not be compiled for AVX2.)
macro_rules! operations {
    ($($name:ident($($argument:ident),*) = $body:expr;)*) => { operations! { Pair; $($name($($argument),*) = $body;)* } };
    ($pair:ty; $($name:ident($($argument:ident),*) = $body:expr;)*) => {$(
        #[inline(always)]
        fn $name(self, $($argument: $pair),*) -> $pair {
            // SAFETY: the token proves that the CPU has AVX2 and FMA.
            let first = unsafe {
                $(let $argument = $argument[0];)*
                $body
            };
            // SAFETY: the token proves that the CPU has AVX2 and FMA.
            let second = unsafe {
                $(let $argument = $argument[1];)*
                $body
            };
            [first, second]
        }
    )*};
}

impl Doubles for Avx2 {
    type D = [__m256d; 2];

    const WIDTH: usize = EIGHT;

    #[inline(always)]
    fn splat_double(self, x: f64) -> Self::D {
        // SAFETY: the token proves that the CPU has AVX2.
        [unsafe { _mm256_set1_pd(x) }; 2]
    }

    #[inline(always)]
    fn load_doubles(self, from: &[f64]) -> Self::D {
        let eight = from.first_chunk::<EIGHT>().expect("eight numbers");
        // SAFETY: 8 numbers fill two registers.
        unsafe { [_mm256_loadu_pd(eight.as_ptr()), _mm256_loadu_pd(eight.as_ptr().add(4))] }
    }

    #[inline(always)]
    fn store_doubles(self, d: Self::D, to: &mut [f64]) {
        let eight = to.first_chunk_mut::<EIGHT>().expect("eight numbers");
        // SAFETY: 8 numbers fill two registers.
        unsafe {
            _mm256_storeu_pd(eight.as_mut_ptr(), d[0]);
            _mm256_storeu_pd(eight.as_mut_ptr().add(4), d[1]);
        }
    }

    operations! { [__m256d; 2];
        add_doubles(a, b) = _mm256_add_pd(a, b);
        sub_doubles(a, b) = _mm256_sub_pd(a, b);
        mul_doubles(a, b) = _mm256_mul_pd(a, b);
        div_doubles(a, b) = _mm256_div_pd(a, b);
        sqrt_doubles(a) = _mm256_sqrt_pd(a);
        rsqrt_estimate_doubles(a) = _mm256_castsi256_pd(_mm256_sub_epi64(
            _mm256_set1_epi64x(ROOT as i64),
            _mm256_srli_epi64::<1>(_mm256_castpd_si256(a)),
        ));
        select_doubles(a, b, x, y) = _mm256_blendv_pd(y, x, _mm256_cmp_pd::<_CMP_LT_OQ>(a, b));
    }
}

impl Elementwise for Avx2 {
    type V = Pair;

    #[inline(always)]
    fn vectorize<R>(self, f: impl FnOnce() -> R) -> R {
        #[target_feature(enable = "avx2,fma")]
        fn inner<R>(f: impl FnOnce() -> R) -> R {
            f()
        }
        // SAFETY: the token proves that the CPU has AVX2 and FMA.
        unsafe { inner(f) }
    }

    inlined! {
        // SAFETY: the token proves that the CPU has AVX2.
        splat(self, x: f32) -> Pair = [unsafe { _mm256_set1_ps(x) }; 2];
        // SAFETY: 16 numbers fill two registers.
        load(self, lanes: &Lanes) -> Pair =
            unsafe { [_mm256_loadu_ps(lanes.as_ptr()), _mm256_loadu_ps(lanes.as_ptr().add(8))] };
        rsqrt(self, a: Pair) -> Pair = self.rsqrt_estimate(a);
        rsqrt_guess(self, a: Pair) -> (Pair, Pair) = (self.rsqrt_estimate(a), self.splat(0.0));
    }

    #[inline(always)]
    fn store(self, v: Pair, lanes: &mut Lanes) {
        // SAFETY: 16 numbers fill two registers.
        unsafe {
            _mm256_storeu_ps(lanes.as_mut_ptr(), v[0]);
            _mm256_storeu_ps(lanes.as_mut_ptr().add(8), v[1]);
        }
    }

    operations! {
        add(a, b) = _mm256_add_ps(a, b);
        sub(a, b) = _mm256_sub_ps(a, b);
        mul(a, b) = _mm256_mul_ps(a, b);
        div(a, b) = _mm256_div_ps(a, b);
        sqrt(a) = _mm256_sqrt_ps(a);
        fma(a, b, c) = _mm256_fmadd_ps(a, b, c);
        fnma(a, b, c) = _mm256_fnmadd_ps(a, b, c);
        min(a, b) = _mm256_min_ps(a, b);
        max(a, b) = _mm256_max_ps(a, b);
        abs(a) = _mm256_and_ps(a, _mm256_castsi256_ps(_mm256_set1_epi32(0x7fff_ffff)));
        round(a) = _mm256_round_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(a);
        floor(a) = _mm256_floor_ps(a);
        exp2(a) = {
            let exponent = _mm256_add_epi32(_mm256_cvtps_epi32(a), _mm256_set1_epi32(127));
            _mm256_castsi256_ps(_mm256_slli_epi32::<23>(exponent))
        };
        exponent(a) = {
            let biased = _mm256_srli_epi32::<23>(_mm256_castps_si256(a));
            _mm256_cvtepi32_ps(_mm256_sub_epi32(biased, _mm256_set1_epi32(127)))
        };
        // The estimate of AVX differs between manufacturers; a root and a quotient do not. In measurements, root and
        // quotient were also faster than an estimate from the exponent's bits with steps of Newton's method.
        rsqrt_estimate(a) = _mm256_div_ps(_mm256_set1_ps(1.0), _mm256_sqrt_ps(a));
        select_less(a, b, x, y) =
            _mm256_blendv_ps(y, x, _mm256_cmp_ps::<_CMP_LT_OQ>(a, b));
    }

    #[inline(always)]
    fn sqrt_rsqrt(self, a: Pair) -> (Pair, Pair) {
        // SAFETY: the token proves that the CPU has AVX.
        unsafe {
            let (first, second) = (_mm256_sqrt_ps(a[0]), _mm256_sqrt_ps(a[1]));
            let one = _mm256_set1_ps(1.0);
            ([first, second], [_mm256_div_ps(one, first), _mm256_div_ps(one, second)])
        }
    }

    #[inline(always)]
    fn less(self, a: Pair, b: Pair) -> u32 {
        // SAFETY: the token proves that the CPU has AVX.
        unsafe {
            let low = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(a[0], b[0]));
            let high = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(a[1], b[1]));
            (low | high << 8) as u32
        }
    }

    #[inline(always)]
    fn quarters(self, [a, b, c, d]: [f32; 4]) -> Pair {
        // SAFETY: the token proves that the CPU has AVX.
        unsafe { [_mm256_set_m128(_mm_set1_ps(b), _mm_set1_ps(a)), _mm256_set_m128(_mm_set1_ps(d), _mm_set1_ps(c))] }
    }

    #[inline(always)]
    fn gather(self, table: &Lanes, index: Pair) -> Pair {
        let [first, second] = self.load(table);
        macro_rules! look {
            ($index:expr) => {{
                // SAFETY: the token proves that the CPU has AVX2.
                unsafe {
                    let place = _mm256_castps_si256($index);
                    let a = _mm256_permutevar8x32_ps(first, place);
                    let b = _mm256_permutevar8x32_ps(second, place);
                    // Bit 3 of the index selects the half of the table; it is moved to the sign bit.
                    _mm256_blendv_ps(a, b, _mm256_castsi256_ps(_mm256_slli_epi32::<28>(place)))
                }
            }};
        }
        [look!(index[0]), look!(index[1])]
    }

    #[inline(always)]
    fn gather_list(self, list: &[f32], index: Pair) -> Pair {
        let last = list.len().checked_sub(1).expect("a list is not empty") as i32;
        macro_rules! look {
            ($index:expr) => {{
                // SAFETY: the token proves that the CPU has AVX2. No index is beyond the last: one below 0 counts as a
                // large one.
                unsafe {
                    let place = _mm256_min_epu32(_mm256_cvtps_epi32($index), _mm256_set1_epi32(last));
                    _mm256_i32gather_ps::<4>(list.as_ptr(), place)
                }
            }};
        }
        [look!(index[0]), look!(index[1])]
    }
}

impl Simd for Avx2 {
    #[inline(always)]
    fn swap<const DISTANCE: usize>(self, [low, high]: Pair) -> Pair {
        if DISTANCE == 8 {
            return [high, low];
        }
        macro_rules! swapped {
            ($half:expr) => {{
                // SAFETY: the token proves that the CPU has AVX.
                unsafe {
                    match DISTANCE {
                        4 => _mm256_permute2f128_ps::<1>($half, $half),
                        2 => _mm256_permute_ps::<0b01_00_11_10>($half),
                        _ => _mm256_permute_ps::<0b10_11_00_01>($half),
                    }
                }
            }};
        }
        [swapped!(low), swapped!(high)]
    }

    #[inline(always)]
    fn pick<const DISTANCE: usize>(self, low: Pair, high: Pair) -> Pair {
        if DISTANCE == 8 {
            return [low[0], high[1]];
        }
        macro_rules! picked {
            ($half:literal) => {{
                // SAFETY: the token proves that the CPU has AVX.
                unsafe {
                    match DISTANCE {
                        4 => _mm256_blend_ps::<0xf0>(low[$half], high[$half]),
                        2 => _mm256_blend_ps::<0xcc>(low[$half], high[$half]),
                        _ => _mm256_blend_ps::<0xaa>(low[$half], high[$half]),
                    }
                }
            }};
        }
        [picked!(0), picked!(1)]
    }

    #[inline(always)]
    fn reduce_add(self, [low, high]: Pair) -> f32 {
        // SAFETY: the token proves that the CPU has AVX.
        unsafe {
            let eight = _mm256_add_ps(low, high);
            let four = _mm_add_ps(_mm256_castps256_ps128(eight), _mm256_extractf128_ps::<1>(eight));
            let two = _mm_add_ps(four, _mm_movehl_ps(four, four));
            _mm_cvtss_f32(_mm_add_ss(two, _mm_shuffle_ps::<1>(two, two)))
        }
    }

    #[inline(always)]
    fn reduce_max(self, [low, high]: Pair) -> f32 {
        // SAFETY: the token proves that the CPU has AVX.
        unsafe {
            let eight = _mm256_max_ps(low, high);
            let four = _mm_max_ps(_mm256_castps256_ps128(eight), _mm256_extractf128_ps::<1>(eight));
            let two = _mm_max_ps(four, _mm_movehl_ps(four, four));
            _mm_cvtss_f32(_mm_max_ps(two, _mm_shuffle_ps::<1>(two, two)))
        }
    }
}
