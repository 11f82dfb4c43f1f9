//! Heap: of fixed size, which counts its allocations.

use core::alloc::{GlobalAlloc, Layout};
use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicUsize, Ordering};

use embedded_alloc::LlffHeap;

/// Bytes of it: enough for `uniform` at 256 transducers and 8 points; of a chip of 128 kB the half.
const SIZE: usize = if cfg!(feature = "stm32f407") { 64 << 10 } else { 160 << 10 };

static mut MEMORY: [MaybeUninit<u8>; SIZE] = [MaybeUninit::uninit(); SIZE];

#[global_allocator]
static HEAP: Counting = Counting { heap: LlffHeap::empty(), calls: AtomicUsize::new(0), most: AtomicUsize::new(0) };

struct Counting {
    heap: LlffHeap,
    calls: AtomicUsize,
    most: AtomicUsize,
}

// SAFETY: blocks are those of the heap within.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // Read and written separately: there is one core, and no interrupt allocates.
        self.calls.store(self.calls.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
        // SAFETY: the caller's.
        let block = unsafe { self.heap.alloc(layout) };
        self.most.store(self.most.load(Ordering::Relaxed).max(self.heap.used()), Ordering::Relaxed);
        block
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: the caller's.
        unsafe { self.heap.dealloc(block, layout) }
    }
}

/// Makes the heap ready: once, before anything is allocated.
pub fn begin() {
    // SAFETY: no other code names the memory, and the heap itself refuses to begin twice.
    unsafe { HEAP.heap.init(&raw mut MEMORY as usize, SIZE) }
}

/// The number of allocations.
#[must_use]
pub fn allocations() -> usize {
    HEAP.calls.load(Ordering::Relaxed)
}

/// The most bytes that were in use.
#[must_use]
pub fn most() -> usize {
    HEAP.most.load(Ordering::Relaxed)
}
