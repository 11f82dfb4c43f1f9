//! The instruction set: chosen at run time, handed down as a value.

use core::fmt;

use crate::error::same_name;
#[cfg(target_arch = "x86_64")]
use crate::kernels::simd::avx2::Avx2;
#[cfg(target_arch = "x86_64")]
use crate::kernels::simd::avx512::Avx512;
use crate::kernels::simd::fours::Fours;
#[cfg(target_arch = "aarch64")]
use crate::kernels::simd::neon::{self, Neon};
#[cfg(not(any(
    all(target_arch = "wasm32", target_feature = "simd128"),
    all(target_arch = "x86_64", target_feature = "sse2")
)))]
use crate::kernels::simd::scalar::Numbers as Plain;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
use crate::kernels::simd::simd128::Vectors as Plain;
#[cfg(all(target_arch = "x86_64", target_feature = "sse2"))]
use crate::kernels::simd::sse2::Vectors as Plain;

/// The instructions that the kernels use: a value exists only for a set that this machine has.
///
/// One set gives the same bits on every machine that has it. Between sets numbers agree to f32 rounding.
///
/// ```
/// use midair::InstructionSet;
///
/// assert!(InstructionSet::all().any(|set| set == InstructionSet::SCALAR));
/// assert_eq!(InstructionSet::named("scalar"), Some(InstructionSet::SCALAR));
/// assert!(InstructionSet::all().any(|set| set == InstructionSet::best()));
/// ```
#[derive(Clone, Copy)]
pub struct InstructionSet(pub(crate) Kind);

/// The tokens of the sets.
#[derive(Clone, Copy)]
pub(crate) enum Kind {
    Scalar(Fours<Plain>),
    #[cfg(target_arch = "x86_64")]
    Avx2(Avx2),
    #[cfg(target_arch = "x86_64")]
    Avx512(Avx512),
    #[cfg(target_arch = "aarch64")]
    Neon(Neon),
}

/// Whether the machine has some instructions: checked at run time with `std`, known at compile time without.
#[cfg(target_arch = "x86_64")]
macro_rules! has {
    ($($feature:tt),*) => {{
        #[cfg(feature = "std")]
        let has = true $(&& std::arch::is_x86_feature_detected!($feature))*;
        #[cfg(not(feature = "std"))]
        let has = true $(&& cfg!(target_feature = $feature))*;
        has
    }};
}

impl InstructionSet {
    /// No instructions but those that every machine of the kind has: numbers one by one; on 64-bit x86 SSE2, and where wasm is
    /// compiled for simd128 that set, which give the same bits, so that no kernel is there twice.
    pub const SCALAR: Self = Self(Kind::Scalar(Fours(Plain)));

    /// Every set this machine has, from the slowest.
    pub fn all() -> impl Iterator<Item = Self> {
        let sets = [
            Some(Self::SCALAR),
            #[cfg(target_arch = "x86_64")]
            Self::avx2(),
            #[cfg(target_arch = "x86_64")]
            Self::avx512(),
            #[cfg(target_arch = "aarch64")]
            // Every 64-bit ARM has it.
            Some(Self(Kind::Neon(Fours(neon::Vectors)))),
        ];
        sets.into_iter().flatten()
    }

    /// The fastest set of this machine.
    #[must_use]
    pub fn best() -> Self {
        Self::all().last().unwrap_or(Self::SCALAR)
    }

    /// The set of that name, whatever its case, "-" and "_", if this machine has it.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::all().find(|set| same_name(set.name(), name))
    }

    /// "scalar", "avx2", "avx512", "neon" or "simd128".
    #[must_use]
    pub fn name(self) -> &'static str {
        match self.0 {
            Kind::Scalar(_) if cfg!(target_feature = "simd128") => "simd128",
            Kind::Scalar(_) => "scalar",
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2(_) => "avx2",
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512(_) => "avx512",
            #[cfg(target_arch = "aarch64")]
            Kind::Neon(_) => "neon",
        }
    }

    /// Whether its code must be short: [`Elementwise::SHORT`] of its token.
    #[inline]
    pub(crate) fn is_short(self) -> bool {
        dispatch!(self, s => s.is_short())
    }

    #[cfg(target_arch = "x86_64")]
    #[allow(unsafe_code, reason = "the one place where a token comes into being")]
    fn avx2() -> Option<Self> {
        // SAFETY: what the token promises has just been checked.
        has!("avx2", "fma").then(|| Self(Kind::Avx2(unsafe { Avx2::assume() })))
    }

    #[cfg(target_arch = "x86_64")]
    #[allow(unsafe_code, reason = "the one place where a token comes into being")]
    fn avx512() -> Option<Self> {
        // SAFETY: what the token promises has just been checked.
        has!("avx512f", "avx512dq", "avx2", "fma").then(|| Self(Kind::Avx512(unsafe { Avx512::assume() })))
    }
}

impl PartialEq for InstructionSet {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl Eq for InstructionSet {}

impl fmt::Debug for InstructionSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl fmt::Display for InstructionSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Runs an expression of a token compiled for a set: `dispatch!(set, simd => body)`.
macro_rules! dispatch {
    ($set:expr, $simd:ident => $body:expr) => {{
        use crate::kernels::simd::instruction_set::Kind;
        #[allow(unused_imports, reason = "a body may need no more than the one of them")]
        use crate::kernels::simd::{Elementwise, Simd};
        match $set.0 {
            Kind::Scalar($simd) => $simd.vectorize(
                #[inline(always)]
                || $body,
            ),
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2($simd) => $simd.vectorize(
                #[inline(always)]
                || $body,
            ),
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512($simd) => $simd.vectorize(
                #[inline(always)]
                || $body,
            ),
            #[cfg(target_arch = "aarch64")]
            Kind::Neon($simd) => $simd.vectorize(
                #[inline(always)]
                || $body,
            ),
        }
    }};
}
pub(crate) use dispatch;
