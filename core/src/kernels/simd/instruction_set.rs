//! The instruction set: chosen at run time and passed on as a value.

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
use crate::prelude::*;

/// The instruction set that the kernels use. A value exists only for a set that this machine has.
///
/// One set gives the same bits on every machine that has it. Results of different sets agree within f32 rounding.
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

/// The token of each set: a value that proves that the machine has its instructions.
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

/// Returns whether the machine has some instructions: checked at run time with `std`, known at compile time without.
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
    /// The set that every machine has: one number at a time. On 64-bit x86 it is SSE2, and in wasm compiled for simd128
    /// it is that set. Both give the same bits as single numbers, so that each kernel is compiled once.
    pub const SCALAR: Self = Self(Kind::Scalar(Fours(Plain)));

    /// Iterates over all sets that this machine has, from the slowest to the fastest.
    pub fn all() -> impl Iterator<Item = Self> {
        let sets = [
            Some(Self::SCALAR),
            #[cfg(target_arch = "x86_64")]
            Self::avx2(),
            #[cfg(target_arch = "x86_64")]
            Self::avx512(),
            #[cfg(target_arch = "aarch64")]
            // Every 64-bit ARM CPU has NEON.
            Some(Self(Kind::Neon(Fours(neon::Vectors)))),
        ];
        sets.into_iter().flatten()
    }

    /// Returns the fastest set of this machine.
    pub fn best() -> Self {
        Self::all().last().unwrap_or(Self::SCALAR)
    }

    /// Returns the set that the environment variable `MIDAIR_SIMD` names, else the fastest one. It is read once.
    ///
    /// # Errors
    /// A name that this machine does not have.
    #[cfg(feature = "std")]
    pub fn requested() -> Result<Self> {
        static NAME: std::sync::OnceLock<Option<String>> = std::sync::OnceLock::new();
        let name = NAME.get_or_init(|| std::env::var("MIDAIR_SIMD").ok().filter(|name| !name.is_empty()));
        let Some(name) = name else { return Ok(Self::best()) };
        Self::named(name).ok_or_else(|| {
            let known: Vec<&str> = Self::all().map(Self::name).collect();
            Error::invalid("MIDAIR_SIMD", name, format!("this machine has {}", known.join(", ")))
        })
    }

    /// Returns the set of this name if this machine has it. Upper and lower case, "-" and "_" make no difference.
    pub fn named(name: &str) -> Option<Self> {
        Self::all().find(|set| same_name(set.name(), name))
    }

    /// Returns the name: "scalar", "avx2", "avx512", "neon" or "simd128".
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

    /// Returns whether code for this set must be short, see [`SHORT`](crate::kernels::simd::Elementwise::SHORT).
    #[inline]
    pub(crate) fn is_short(self) -> bool {
        dispatch!(self, s => s.is_short())
    }

    #[cfg(target_arch = "x86_64")]
    #[allow(unsafe_code, reason = "the one place where a token comes into being")]
    fn avx2() -> Option<Self> {
        // SAFETY: `has!` checked the instructions whose presence the token proves.
        has!("avx2", "fma").then(|| Self(Kind::Avx2(unsafe { Avx2::assume() })))
    }

    #[cfg(target_arch = "x86_64")]
    #[allow(unsafe_code, reason = "the one place where a token comes into being")]
    fn avx512() -> Option<Self> {
        // SAFETY: `has!` checked the instructions whose presence the token proves.
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

/// Evaluates an expression of a token, compiled for a set: `dispatch!(set, simd => body)`.
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
