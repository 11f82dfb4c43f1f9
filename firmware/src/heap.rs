//! Heap of a fixed size, which counts its allocations.

use core::alloc::{GlobalAlloc, Layout};
use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicUsize, Ordering};

use embedded_alloc::LlffHeap;

/// Size of the heap in bytes: half of the 128 kB of an STM32F407; else enough for `uniform` with 256 transducers and 8
/// points.
const SIZE: usize = if cfg!(feature = "stm32f407") { 64 << 10 } else { 160 << 10 };

static mut MEMORY: [MaybeUninit<u8>; SIZE] = [MaybeUninit::uninit(); SIZE];

#[global_allocator]
static HEAP: Counting = Counting { heap: LlffHeap::empty(), calls: AtomicUsize::new(0), most: AtomicUsize::new(0) };

struct Counting {
    heap: LlffHeap,
    calls: AtomicUsize,
    most: AtomicUsize,
}

// SAFETY: all blocks come from the inner heap.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // No atomic update is needed: there is one core, and no interrupt allocates.
        self.calls.store(self.calls.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
        // SAFETY: the caller meets the conditions of `alloc`.
        let block = unsafe { self.heap.alloc(layout) };
        self.most.store(self.most.load(Ordering::Relaxed).max(self.heap.used()), Ordering::Relaxed);
        block
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: the caller meets the conditions of `dealloc`.
        unsafe { self.heap.dealloc(block, layout) }
    }
}

/// Initialises the heap. Call this once, before anything is allocated.
pub fn begin() {
    // SAFETY: no other code uses the memory, and the heap itself panics if it is initialised twice.
    unsafe { HEAP.heap.init(&raw mut MEMORY as usize, SIZE) }
}

/// Returns the number of allocations.
pub fn allocations() -> usize {
    HEAP.calls.load(Ordering::Relaxed)
}

/// Returns the largest number of bytes that were in use.
pub fn most() -> usize {
    HEAP.most.load(Ordering::Relaxed)
}
