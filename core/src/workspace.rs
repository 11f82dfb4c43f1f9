//! Workspace: reusable memory of solves.

use alloc::vec::Vec;
use core::cell::{Cell, RefCell};
use core::mem;
use core::ops::{Deref, DerefMut};

use num_complex::Complex32;

use crate::kernels::PointGroup;

/// Numbers in a line of the cache.
const LINE: usize = 16;

/// Buffers of one kind that wait to be used again.
#[derive(Debug, Default)]
pub struct Pool<T> {
    free: RefCell<Vec<Vec<T>>>,
    /// The number of buffers that it has made and can take back.
    made: Cell<usize>,
}

impl<T: Clone + Default> Pool<T> {
    /// A buffer of `len` defaults: the smallest free one that holds them, else a new one. It goes back when dropped.
    pub fn take(&self, len: usize) -> Buffer<'_, T> {
        let mut list = self.empty(len);
        list.resize(len, T::default());
        Buffer { list, pool: self }
    }

    /// Memory for a list that is written as a whole before it is read: it may hold anything.
    pub(crate) fn take_any(&self, len: usize) -> Buffer<'_, T> {
        let mut list = self.fitting(len);
        list.resize(len, T::default());
        Buffer { list, pool: self }
    }

    /// An empty list that holds `len` without allocating.
    pub(crate) fn empty(&self, len: usize) -> Vec<T> {
        let mut list = self.fitting(len);
        list.clear();
        list
    }
}

impl<T> Pool<T> {
    /// Bytes of the buffers that wait.
    fn bytes(&self) -> usize {
        self.free.borrow().iter().map(|list| list.capacity() * size_of::<T>()).sum()
    }

    fn fitting(&self, len: usize) -> Vec<T> {
        if len == 0 {
            // The buffer must not be one that another user could take.
            return Vec::new();
        }
        let mut free = self.free.borrow_mut();
        let fits = (0..free.len()).filter(|&k| free[k].capacity() >= len);
        if let Some(k) = fits.min_by_key(|&k| free[k].capacity()) {
            return free.swap_remove(k);
        }
        self.made.set(self.made.get() + 1);
        let room = self.made.get().saturating_sub(free.len());
        free.reserve(room);
        Vec::with_capacity(len)
    }

    /// Gives a list back that was taken out of its buffer.
    pub fn give(&self, list: Vec<T>) {
        if list.capacity() > 0 {
            self.free.borrow_mut().push(list);
        }
    }
}

/// A slice on loan from a [`Pool`], given back when dropped.
#[derive(Debug)]
pub struct Buffer<'w, T> {
    list: Vec<T>,
    pool: &'w Pool<T>,
}

impl<T> Buffer<'_, T> {
    /// The list itself, to be kept: [`Pool::give`] gives it back.
    #[must_use]
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

/// Numbers that begin where a line of the cache does: of others, each group of lanes would lie across two.
#[derive(Debug)]
pub(crate) struct Aligned<'w> {
    memory: Buffer<'w, f32>,
    start: usize,
    len: usize,
}

impl<'w> Aligned<'w> {
    /// `len` numbers that may be anything.
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

/// The memory that solvers work in. The second solve of a size through one workspace allocates nothing, once
/// the first one's solution was given back with [`crate::Solution::recycle`].
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
    /// Values of its points that the greedy search keeps.
    pub(crate) points: Pool<PointGroup>,
}

impl Workspace {
    /// An empty workspace.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Bytes of memory that waits for the next solve.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let Self { floats, doubles, complexes, indices, points } = self;
        floats.bytes() + doubles.bytes() + complexes.bytes() + indices.bytes() + points.bytes()
    }

    /// 0, 1, 2 and so on.
    pub(crate) fn counting(&self, len: usize) -> Buffer<'_, u32> {
        let mut indices = self.indices.take(len);
        indices.iter_mut().zip(0..).for_each(|(index, k)| *index = k);
        indices
    }
}
