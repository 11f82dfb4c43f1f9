//! SplitMix64, the seeded generator behind every random choice.
//!
//! `SplitMix64` (Steele, Lea and Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014) has eight bytes of
//! state, no bad seeds, and the same numbers on every platform. Results depend on the seed, so a change of this file is a
//! breaking change. `golden/` and a test of the first values detect it.

/// A `SplitMix64` generator.
///
/// ```
/// let mut rng = midair::Rng::new(1);
/// let order = rng.permutation(4);
/// let mut sorted = order.clone();
/// sorted.sort_unstable();
/// assert_eq!(sorted, [0, 1, 2, 3]);
/// assert_eq!(order, midair::Rng::new(1).permutation(4));
/// ```
#[derive(Clone, Debug)]
pub struct Rng(u64);

impl Rng {
    /// Returns a generator that depends only on `seed`.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Returns the next 64 random bits.
    pub fn next_u64(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Returns a number in `0..bound`: the high half of a 128-bit product. The bias is at most `bound` in 2^64.
    pub fn below(&mut self, bound: u64) -> u64 {
        ((u128::from(self.next_u64()) * u128::from(bound)) >> 64) as u64
    }

    /// Returns a number in [0, 1) with 53 random bits.
    pub fn uniform(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Shuffles `items` (Fisher and Yates, from the last item to the second).
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for last in (1..items.len()).rev() {
            items.swap(last, self.below(last as u64 + 1) as usize);
        }
    }

    /// Returns the numbers `0..count` in random order.
    pub fn permutation(&mut self, count: u32) -> alloc::vec::Vec<u32> {
        let mut order: alloc::vec::Vec<u32> = (0..count).collect();
        self.shuffle(&mut order);
        order
    }
}
