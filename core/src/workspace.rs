//! Workspace: memory that solves reuse.

use core::cell::{Cell, RefCell};
use core::mem;
use core::ops::{Deref, DerefMut};

use crate::kernels::PointGroup;
use crate::prelude::*;

/// The number of f32 in a cache line.
const LINE: usize = 16;

/// The largest number of buffers for whose return a pool reserves space. Lists that leave it in solutions may never return.
const MOST_OUT: usize = 256;

/// Unused buffers of one type, ready to be used again.
#[derive(Debug, Default)]
pub struct Pool<T> {
    free: RefCell<Vec<Vec<T>>>,
    /// The number of buffers allocated so far; all of them may be returned to the pool.
    made: Cell<usize>,
}

impl<T: Clone + Default> Pool<T> {
    /// Returns a buffer of `len` default values: the smallest unused one that is large enough, or a new one. It returns to the
    /// pool when it is dropped.
    pub fn take(&self, len: usize) -> Buffer<'_, T> {
        let mut list = self.empty(len);
        list.resize(len, T::default());
        Buffer { list, pool: self }
    }

    /// Returns a buffer whose contents are arbitrary, for a list that is written completely before it is read.
    pub(crate) fn take_any(&self, len: usize) -> Buffer<'_, T> {
        let mut list = self.fitting(len);
        list.resize(len, T::default());
        Buffer { list, pool: self }
    }

    /// Returns an empty list with a capacity of at least `len`.
    pub(crate) fn empty(&self, len: usize) -> Vec<T> {
        let mut list = self.fitting(len);
        list.clear();
        list
    }
}

impl<T> Pool<T> {
    /// The bytes of all unused buffers.
    fn bytes(&self) -> usize {
        self.free.borrow().iter().map(|list| list.capacity() * size_of::<T>()).sum()
    }

    fn fitting(&self, len: usize) -> Vec<T> {
        if len == 0 {
            // An empty list needs no memory, so all unused buffers remain available.
            return Vec::new();
        }
        let mut free = self.free.borrow_mut();
        let fits = (0..free.len()).filter(|&k| free[k].capacity() >= len);
        if let Some(k) = fits.min_by_key(|&k| free[k].capacity()) {
            return free.swap_remove(k);
        }
        self.made.set(self.made.get() + 1);
        let room = self.made.get().saturating_sub(free.len());
        free.reserve(room.min(MOST_OUT));
        Vec::with_capacity(len)
    }

    /// Returns a list to the pool that was taken out of its buffer by [`Buffer::into_vec`].
    pub fn give(&self, list: Vec<T>) {
        if list.capacity() > 0 {
            self.free.borrow_mut().push(list);
        }
    }
}

/// A slice from a [`Pool`], to which it returns when it is dropped.
#[derive(Debug)]
pub struct Buffer<'w, T> {
    list: Vec<T>,
    pool: &'w Pool<T>,
}

impl<T> Buffer<'_, T> {
    /// Takes the list out of the buffer; [`Pool::give`] returns it.
    pub fn into_vec(mut self) -> Vec<T> {
        mem::take(&mut self.list)
    }
}

impl<T> Drop for Buffer<'_, T> {
    fn drop(&mut self) {
        self.pool.give(mem::take(&mut self.list));
    }
}

impl<T> Deref for Buffer<'_, T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.list
    }
}

impl<T> DerefMut for Buffer<'_, T> {
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.list
    }
}

impl<'a, T> IntoIterator for &'a Buffer<'_, T> {
    type Item = &'a T;
    type IntoIter = core::slice::Iter<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl<'a, T> IntoIterator for &'a mut Buffer<'_, T> {
    type Item = &'a mut T;
    type IntoIter = core::slice::IterMut<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter_mut()
    }
}

/// Numbers that begin at the start of a cache line. Otherwise each group of SIMD lanes would lie across two lines.
#[derive(Debug)]
pub(crate) struct Aligned<'w> {
    memory: Buffer<'w, f32>,
    start: usize,
    len: usize,
}

impl<'w> Aligned<'w> {
    /// Returns `len` numbers with arbitrary contents.
    pub(crate) fn take(len: usize, work: &'w Workspace) -> Self {
        let memory = work.floats.take_any(len + LINE);
        let start = memory.as_ptr().align_offset(LINE * size_of::<f32>()).min(LINE);
        Self { memory, start, len }
    }
}

impl Deref for Aligned<'_> {
    type Target = [f32];

    fn deref(&self) -> &[f32] {
        &self.memory[self.start..self.start + self.len]
    }
}

impl DerefMut for Aligned<'_> {
    fn deref_mut(&mut self) -> &mut [f32] {
        &mut self.memory[self.start..self.start + self.len]
    }
}

/// The memory that solvers use. The second solve with the same sizes allocates nothing, if the solution of the first was
/// returned by [`crate::Solution::recycle`].
#[derive(Debug, Default)]
#[non_exhaustive]
pub struct Workspace {
    /// Single-precision numbers.
    pub floats: Pool<f32>,
    /// Double-precision numbers.
    pub doubles: Pool<f64>,
    /// Complex numbers.
    pub complexes: Pool<Complex32>,
    /// Indices of transducers.
    pub indices: Pool<u32>,
    /// Point values that the greedy search stores.
    pub(crate) points: Pool<PointGroup>,
    /// The largest transducers and points for which the steps of an even field have taken their memory.
    pub(crate) even: Cell<[usize; 2]>,
}

impl Workspace {
    /// Returns an empty workspace.
    pub fn new() -> Self {
        Self::default()
    }

    /// The bytes of unused memory, ready for the next solve.
    pub fn bytes(&self) -> usize {
        let Self { floats, doubles, complexes, indices, points, .. } = self;
        floats.bytes() + doubles.bytes() + complexes.bytes() + indices.bytes() + points.bytes()
    }

    /// Returns the indices 0, 1, 2, ... in a buffer.
    pub(crate) fn counting(&self, len: usize) -> Buffer<'_, u32> {
        let mut indices = self.indices.take(len);
        indices.iter_mut().zip(0..).for_each(|(index, k)| *index = k);
        indices
    }
}
