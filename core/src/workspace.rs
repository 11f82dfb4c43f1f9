//! Workspace: the memory of solves, taken and given back.

use alloc::vec::Vec;
use core::ops::{Deref, DerefMut};

use num_complex::Complex32;

use crate::kernels::PointGroup;

/// Numbers in a line of the cache.
const LINE: usize = 16;

/// Buffers of one kind that wait to be used again.
#[derive(Debug, Default)]
pub struct Pool<T> {
    free: Vec<Vec<T>>,
}

impl<T: Clone + Default> Pool<T> {
    /// A buffer of `len` defaults: the smallest free one that holds them, else a new one.
    pub fn take(&mut self, len: usize) -> Vec<T> {
        let mut buffer = self.empty(len);
        buffer.resize(len, T::default());
        buffer
    }

    /// An empty buffer that holds `len` without allocating.
    pub(crate) fn empty(&mut self, len: usize) -> Vec<T> {
        let mut buffer = self.fitting(len);
        buffer.clear();
        buffer
    }

    /// The same for what is written as a whole before it is read: it may hold anything.
    pub(crate) fn take_any(&mut self, len: usize) -> Vec<T> {
        let mut buffer = self.fitting(len);
        buffer.resize(len, T::default());
        buffer
    }

    fn fitting(&mut self, len: usize) -> Vec<T> {
        let fits = (0..self.free.len()).filter(|&k| self.free[k].capacity() >= len);
        match fits.min_by_key(|&k| self.free[k].capacity()) {
            Some(k) => self.free.swap_remove(k),
            None => Vec::with_capacity(len),
        }
    }

    /// Gives a buffer back.
    pub fn give(&mut self, buffer: Vec<T>) {
        if buffer.capacity() > 0 {
            self.free.push(buffer);
        }
    }

    /// Gives several back.
    pub fn give_all(&mut self, buffers: impl IntoIterator<Item = Vec<T>>) {
        buffers.into_iter().for_each(|buffer| self.give(buffer));
    }
}

/// Numbers that begin where a line of the cache does: of others, each group of lanes would lie across two.
#[derive(Debug)]
pub(crate) struct Aligned {
    memory: Vec<f32>,
    start: usize,
    len: usize,
}

impl Aligned {
    /// `len` numbers that may be anything.
    pub(crate) fn take(len: usize, work: &mut Workspace) -> Self {
        let memory = work.floats.take_any(len + LINE);
        let start = memory.as_ptr().align_offset(LINE * size_of::<f32>()).min(LINE);
        Self { memory, start, len }
    }

    pub(crate) fn give(self, work: &mut Workspace) {
        work.floats.give(self.memory);
    }
}

impl Deref for Aligned {
    type Target = [f32];

    fn deref(&self) -> &[f32] {
        &self.memory[self.start..self.start + self.len]
    }
}

impl DerefMut for Aligned {
    fn deref_mut(&mut self) -> &mut [f32] {
        &mut self.memory[self.start..self.start + self.len]
    }
}

/// The memory that solvers work in. The second solve of a size through one workspace allocates nothing, once
/// the first one's solution was given back with [`Workspace::recycle`].
#[derive(Debug, Default)]
#[non_exhaustive]
pub struct Workspace {
    /// Single-precision numbers.
    pub floats: Pool<f32>,
    /// Complex numbers.
    pub complexes: Pool<Complex32>,
    /// Indices of transducers.
    pub indices: Pool<u32>,
    /// What the greedy search keeps of its points.
    pub(crate) points: Pool<PointGroup>,
}

impl Workspace {
    /// An empty workspace.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }
}
