//! AVX-512 F and DQ: one register for 16 lanes (Skylake-X and later).

#[allow(clippy::wildcard_imports, reason = "the intrinsics, whose names say where they are from")]
use core::arch::x86_64::*;

use crate::kernels::lanes::{LANES, Lanes};
use crate::kernels::simd::doubles::{Doubles, EIGHT, ROOT};
use crate::kernels::simd::{Elementwise, Simd};

/// Token that proves that the CPU has AVX-512F and AVX-512DQ.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx512(());

impl Avx512 {
    /// # Safety
    /// The CPU has AVX-512F, AVX-512DQ, AVX2 and FMA.
    pub(crate) const unsafe fn assume() -> Self {
        Self(())
    }
}

/// Defines methods that are one expression of intrinsics.
macro_rules! operations {
    ($($name:ident($($argument:ident: $kind:ty),*) -> $result:ty = $body:expr;)*) => {$(
        #[inline(always)]
        fn $name(self, $($argument: $kind),*) -> $result {
            // SAFETY: the token proves that the CPU has AVX-512F; loads and stores are of whole `Lanes`.
            unsafe { $body }
        }
    )*};
}

impl Doubles for Avx512 {
    type D = __m512d;

    const WIDTH: usize = EIGHT;

    #[inline(always)]
    fn load_doubles(self, from: &[f64]) -> __m512d {
        let from = from.first_chunk::<EIGHT>().expect("eight numbers");
        // SAFETY: the token proves that the CPU has AVX-512F.
        unsafe { _mm512_loadu_pd(from.as_ptr()) }
    }

    #[inline(always)]
    fn store_doubles(self, d: __m512d, to: &mut [f64]) {
        let to = to.first_chunk_mut::<EIGHT>().expect("eight numbers");
        // SAFETY: the token proves that the CPU has AVX-512F.
        unsafe { _mm512_storeu_pd(to.as_mut_ptr(), d) }
    }

    operations! {
        splat_double(x: f64) -> __m512d = _mm512_set1_pd(x);
        add_doubles(a: __m512d, b: __m512d) -> __m512d = _mm512_add_pd(a, b);
        sub_doubles(a: __m512d, b: __m512d) -> __m512d = _mm512_sub_pd(a, b);
        mul_doubles(a: __m512d, b: __m512d) -> __m512d = _mm512_mul_pd(a, b);
        div_doubles(a: __m512d, b: __m512d) -> __m512d = _mm512_div_pd(a, b);
        sqrt_doubles(a: __m512d) -> __m512d = _mm512_sqrt_pd(a);
        rsqrt_estimate_doubles(a: __m512d) -> __m512d = _mm512_castsi512_pd(_mm512_sub_epi64(
            _mm512_set1_epi64(ROOT as i64),
            _mm512_srli_epi64::<1>(_mm512_castpd_si512(a)),
        ));
        select_doubles(a: __m512d, b: __m512d, x: __m512d, y: __m512d) -> __m512d =
            _mm512_mask_blend_pd(_mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, b), y, x);
    }
}

impl Elementwise for Avx512 {
    type V = __m512;

    #[inline(always)]
    fn vectorize<R>(self, f: impl FnOnce() -> R) -> R {
        #[target_feature(enable = "avx512f,avx512dq,avx2,fma")]
        fn inner<R>(f: impl FnOnce() -> R) -> R {
            f()
        }
        // SAFETY: the token proves that the CPU has these instruction sets.
        unsafe { inner(f) }
    }

    operations! {
        splat(x: f32) -> __m512 = _mm512_set1_ps(x);
        load(lanes: &Lanes) -> __m512 = _mm512_loadu_ps(lanes.as_ptr());
        store(v: __m512, lanes: &mut Lanes) -> () = _mm512_storeu_ps(lanes.as_mut_ptr(), v);
        add(a: __m512, b: __m512) -> __m512 = _mm512_add_ps(a, b);
        sub(a: __m512, b: __m512) -> __m512 = _mm512_sub_ps(a, b);
        mul(a: __m512, b: __m512) -> __m512 = _mm512_mul_ps(a, b);
        div(a: __m512, b: __m512) -> __m512 = _mm512_div_ps(a, b);
        sqrt(a: __m512) -> __m512 = _mm512_sqrt_ps(a);
        fma(a: __m512, b: __m512, c: __m512) -> __m512 = _mm512_fmadd_ps(a, b, c);
        fnma(a: __m512, b: __m512, c: __m512) -> __m512 = _mm512_fnmadd_ps(a, b, c);
        min(a: __m512, b: __m512) -> __m512 = _mm512_min_ps(a, b);
        max(a: __m512, b: __m512) -> __m512 = _mm512_max_ps(a, b);
        abs(a: __m512) -> __m512 = _mm512_abs_ps(a);
        round(a: __m512) -> __m512 = _mm512_roundscale_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(a);
        floor(a: __m512) -> __m512 = _mm512_roundscale_ps::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(a);
        fract(a: __m512) -> __m512 = _mm512_reduce_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(a);
        exp2(a: __m512) -> __m512 = _mm512_scalef_ps(_mm512_set1_ps(1.0), a);
        exponent(a: __m512) -> __m512 = _mm512_getexp_ps(a);
        rsqrt_estimate(a: __m512) -> __m512 = _mm512_rsqrt14_ps(a);
        select_less(a: __m512, b: __m512, x: __m512, y: __m512) -> __m512 =
            _mm512_mask_blend_ps(_mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b), y, x);
        less(a: __m512, b: __m512) -> u32 = u32::from(_mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b));
        gather(table: &Lanes, index: __m512) -> __m512 =
            _mm512_permutexvar_ps(_mm512_castps_si512(index), _mm512_loadu_ps(table.as_ptr()));
    }

    #[inline(always)]
    fn gather_list(self, list: &[f32], index: __m512) -> __m512 {
        let last = list.len().checked_sub(1).expect("a list is not empty") as i32;
        // SAFETY: the token proves that the CPU has AVX-512F. No index is beyond the last: one below 0 counts as a
        // large one.
        unsafe {
            let place = _mm512_min_epu32(_mm512_cvtps_epi32(index), _mm512_set1_epi32(last));
            _mm512_i32gather_ps::<4>(place, list.as_ptr())
        }
    }

    #[inline(always)]
    fn quarters(self, [a, b, c, d]: [f32; 4]) -> __m512 {
        // SAFETY: the token proves that the CPU has AVX-512F.
        unsafe {
            let two = _mm512_mask_broadcastss_ps(_mm512_set1_ps(a), 0x00f0, _mm_set_ss(b));
            let three = _mm512_mask_broadcastss_ps(two, 0x0f00, _mm_set_ss(c));
            _mm512_mask_broadcastss_ps(three, 0xf000, _mm_set_ss(d))
        }
    }
}

impl Simd for Avx512 {
    operations! {
        reduce_add(a: __m512) -> f32 = {
            let eight = _mm512_add_ps(a, _mm512_shuffle_f32x4::<0b01_00_11_10>(a, a));
            let four = _mm512_add_ps(eight, _mm512_shuffle_f32x4::<0b10_11_00_01>(eight, eight));
            let two = _mm512_add_ps(four, _mm512_shuffle_ps::<0b01_00_11_10>(four, four));
            let one = _mm512_add_ps(two, _mm512_shuffle_ps::<0b10_11_00_01>(two, two));
            _mm512_cvtss_f32(one)
        };
        reduce_min(a: __m512) -> __m512 = {
            let eight = _mm512_min_ps(a, _mm512_shuffle_f32x4::<0b01_00_11_10>(a, a));
            let four = _mm512_min_ps(eight, _mm512_shuffle_f32x4::<0b10_11_00_01>(eight, eight));
            let two = _mm512_min_ps(four, _mm512_shuffle_ps::<0b01_00_11_10>(four, four));
            _mm512_min_ps(two, _mm512_shuffle_ps::<0b10_11_00_01>(two, two))
        };
        reduce_max(a: __m512) -> f32 = {
            let eight = _mm512_max_ps(a, _mm512_shuffle_f32x4::<0b01_00_11_10>(a, a));
            let four = _mm512_max_ps(eight, _mm512_shuffle_f32x4::<0b10_11_00_01>(eight, eight));
            let two = _mm512_max_ps(four, _mm512_shuffle_ps::<0b01_00_11_10>(four, four));
            _mm512_cvtss_f32(_mm512_max_ps(two, _mm512_shuffle_ps::<0b10_11_00_01>(two, two)))
        };
    }

    #[inline(always)]
    fn swap<const DISTANCE: usize>(self, a: __m512) -> __m512 {
        // SAFETY: the token proves that the CPU has AVX-512F.
        unsafe {
            match DISTANCE {
                8 => _mm512_shuffle_f32x4::<0b01_00_11_10>(a, a),
                4 => _mm512_shuffle_f32x4::<0b10_11_00_01>(a, a),
                2 => _mm512_permute_ps::<0b01_00_11_10>(a),
                _ => _mm512_permute_ps::<0b10_11_00_01>(a),
            }
        }
    }

    #[inline(always)]
    fn pick<const DISTANCE: usize>(self, low: __m512, high: __m512) -> __m512 {
        // SAFETY: the token proves that the CPU has AVX-512F.
        unsafe {
            match DISTANCE {
                8 => _mm512_mask_blend_ps(0xff00, low, high),
                4 => _mm512_mask_blend_ps(0xf0f0, low, high),
                2 => _mm512_mask_blend_ps(0xcccc, low, high),
                _ => _mm512_mask_blend_ps(0xaaaa, low, high),
            }
        }
    }

    #[inline(always)]
    fn gather_pairs(self, list: &[f32], zero: i32, x: __m512) -> __m512 {
        let last = (list.len() / 2).checked_sub(1).expect("a list has a pair") as i32;
        // SAFETY: the token proves that the CPU has AVX-512F. No index is beyond the last pair: one below 0 counts as a
        // large one, and NaN becomes -2^31. Odd lanes are set to 0, so that each even lane begins a 64-bit index.
        unsafe {
            let floor = _mm512_cvt_roundps_epi32::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(x);
            let place = _mm512_min_epu32(_mm512_add_epi32(floor, _mm512_set1_epi32(zero)), _mm512_set1_epi32(last));
            let place = _mm512_and_si512(place, _mm512_set1_epi64(0xffff_ffff));
            _mm512_castpd_ps(_mm512_i64gather_pd::<8>(place, list.as_ptr().cast()))
        }
    }

    #[inline(always)]
    fn reduce_add_each(self, vectors: &[__m512; LANES]) -> __m512 {
        // Each fold adds the halves of two vectors, then quarters, pairs and neighbours, until 16 vectors have become
        // one. The order of the vectors is such that the sum of vector k is in lane k. (Closures would not be compiled
        // for AVX-512.)
        macro_rules! fold {
            ($shuffle:ident, $low:expr, $high:expr, $a:expr, $b:expr) => {{
                let (a, b) = ($a, $b);
                // SAFETY: the token proves that the CPU has AVX-512F.
                unsafe { _mm512_add_ps($shuffle::<{ $low }>(a, b), $shuffle::<{ $high }>(a, b)) }
            }};
        }
        macro_rules! eights {
            ($a:expr, $b:expr) => {
                fold!(_mm512_shuffle_f32x4, 0b01_00_01_00, 0b11_10_11_10, vectors[$a], vectors[$b])
            };
        }
        macro_rules! fours {
            ($a:expr) => {
                fold!(_mm512_shuffle_f32x4, 0b10_00_10_00, 0b11_01_11_01, eights!($a, $a + 4), eights!($a + 8, $a + 12))
            };
        }
        macro_rules! twos {
            ($a:expr) => {
                fold!(_mm512_shuffle_ps, 0b01_00_01_00, 0b11_10_11_10, fours!($a), fours!($a + 1))
            };
        }
        fold!(_mm512_shuffle_ps, 0b10_00_10_00, 0b11_01_11_01, twos!(0), twos!(2))
    }

    #[inline(always)]
    fn transpose(self, v: [__m512; LANES]) -> [__m512; LANES] {
        // First transposes four vectors within each quarter of a register, then the quarters of four registers.
        let (mut fours, mut out) = (v, v);
        // SAFETY: the token proves that the CPU has AVX-512F.
        unsafe {
            for k in [0, 4, 8, 12] {
                let (low, high) = (_mm512_unpacklo_ps(v[k], v[k + 1]), _mm512_unpackhi_ps(v[k], v[k + 1]));
                let (also_low, also_high) =
                    (_mm512_unpacklo_ps(v[k + 2], v[k + 3]), _mm512_unpackhi_ps(v[k + 2], v[k + 3]));
                fours[k] = _mm512_shuffle_ps::<0b01_00_01_00>(low, also_low);
                fours[k + 1] = _mm512_shuffle_ps::<0b11_10_11_10>(low, also_low);
                fours[k + 2] = _mm512_shuffle_ps::<0b01_00_01_00>(high, also_high);
                fours[k + 3] = _mm512_shuffle_ps::<0b11_10_11_10>(high, also_high);
            }
            for k in 0..4 {
                let [a, b, c, d] = [fours[k], fours[k + 4], fours[k + 8], fours[k + 12]];
                let (low, high) =
                    (_mm512_shuffle_f32x4::<0b01_00_01_00>(a, b), _mm512_shuffle_f32x4::<0b11_10_11_10>(a, b));
                let (also_low, also_high) =
                    (_mm512_shuffle_f32x4::<0b01_00_01_00>(c, d), _mm512_shuffle_f32x4::<0b11_10_11_10>(c, d));
                out[k] = _mm512_shuffle_f32x4::<0b10_00_10_00>(low, also_low);
                out[k + 4] = _mm512_shuffle_f32x4::<0b11_01_11_01>(low, also_low);
                out[k + 8] = _mm512_shuffle_f32x4::<0b10_00_10_00>(high, also_high);
                out[k + 12] = _mm512_shuffle_f32x4::<0b11_01_11_01>(high, also_high);
            }
        }
        out
    }
}
