//! Channels: transducers that are wired together, so that one output of a board drives them.

use crate::prelude::*;

/// Drives on one channel may differ by this much.
const ALIKE: f32 = 1e-6;

/// The channel of each transducer (N,), 0 to C - 1. All transducers i of a channel c have the same drive q_c, so
/// `p_j = sum_c (sum_i G_ji) q_c`, and solvers see C columns.
///
/// ```
/// use midair::{Array, Control, Medium, Problem, Request, Scene, Workspace, solvers};
///
/// // Two rows of four, each row on a channel.
/// let array = Array::grid(4, 2, 10e-3)?.with_channels(Some(vec![0, 0, 0, 0, 1, 1, 1, 1]))?;
/// let scene = Scene::new(array, Medium::default(), vec![[0.0, 0.02, 0.1]], Request::default())?;
/// let problem = Problem::new(&scene)?;
/// assert_eq!(problem.propagation().transducers(), 2);
/// let fast = solvers::find("fast")?.configure(&[].into())?;
/// let solution = midair::solve(&problem, &*fast.solver, false, &mut Workspace::new(), &mut Control::none())?;
/// assert_eq!(solution.drive.len(), 8);
/// assert!(solution.drive[0] == solution.drive[3] && solution.drive[0] != solution.drive[4]);
/// # Ok::<(), midair::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Channels {
    of: Arc<[usize]>,
    /// The first transducer of each channel.
    first: Arc<[usize]>,
}

impl Channels {
    /// Returns the channels for the channel of each transducer (N,). Returns `None` if they are 0 to N - 1 in order, because
    /// each transducer then has its own.
    ///
    /// # Errors
    /// Another number of entries, a channel of N or above, a channel without transducers below the highest one.
    pub fn new(channels: Vec<usize>, transducers: usize) -> Result<Option<Self>> {
        one_each("array.channels", channels.len(), "values", transducers, "transducers")?;
        if let Some((i, channel)) = channels.iter().enumerate().find(|(_, channel)| **channel >= transducers) {
            let cure = format!("give 0 to {}: there are no more channels than transducers", transducers - 1);
            return Err(Error::out_of_range(format!("array.channels[{i}]"), channel, cure));
        }
        let count = channels.iter().max().map_or(0, |most| most + 1);
        let mut first = vec![None; count];
        channels.iter().enumerate().rev().for_each(|(i, &channel)| first[channel] = Some(i));
        if let Some(gap) = first.iter().position(Option::is_none) {
            let cure = format!("number them 0 to C - 1: no transducer is on channel {gap}");
            return Err(Error::invalid("array.channels", format!("up to {}", count - 1), cure));
        }
        let identity = channels.iter().enumerate().all(|(i, &channel)| i == channel);
        Ok((!identity).then(|| Self { of: channels.into(), first: first.into_iter().flatten().collect() }))
    }

    /// The channel of each transducer (N,).
    pub fn of(&self) -> &[usize] {
        &self.of
    }

    /// The number of channels C.
    pub fn count(&self) -> usize {
        self.first.len()
    }

    /// The indices of the transducers of a channel.
    pub(crate) fn members(&self, channel: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.of.len()).filter(move |&i| self.of[i] == channel)
    }

    /// Converts a value for each channel (C,) to one for each transducer (N,).
    pub(crate) fn spread<T: Copy>(&self, values: &[T]) -> Vec<T> {
        self.of.iter().map(|&channel| values[channel]).collect()
    }

    /// Returns for each channel (C,) the value of its first transducer, from values (N,).
    pub(crate) fn gather<T: Copy>(&self, values: &[T]) -> Vec<T> {
        self.first.iter().map(|&i| values[i]).collect()
    }

    /// Returns for each channel (C,) the sum over its transducers, from values (N,).
    pub(crate) fn sums<T: Copy + core::ops::AddAssign + Default>(&self, values: &[T]) -> Vec<T> {
        let mut sums = vec![T::default(); self.count()];
        self.of.iter().zip(values).for_each(|(&channel, value)| sums[channel] += *value);
        sums
    }

    /// Returns the drive of each channel (C,) from checked drives (N,).
    ///
    /// # Errors
    /// Two different drives on one channel.
    pub(crate) fn drives(&self, drive: &[Complex32]) -> Result<Vec<Complex32>> {
        let other = |i: usize| self.first[self.of[i]];
        match (0..drive.len()).find(|&i| (drive[i] - drive[other(i)]).norm_sqr() > ALIKE * ALIKE) {
            None => Ok(self.gather(drive)),
            Some(i) => {
                let (first, channel) = (other(i), self.of[i]);
                let cure = format!("drive[{first}] on the same channel {channel} is {}: give both one", drive[first]);
                Err(Error::invalid(format!("drive[{i}]"), drive[i], cure))
            }
        }
    }

    /// The mean position (C, 3) of each channel's transducers, from `positions` (N, 3).
    pub(crate) fn middles(&self, positions: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let sums = [0, 1, 2].map(|axis| self.sums(&positions.iter().map(|place| place[axis]).collect::<Vec<_>>()));
        let counts = self.sums(&vec![1.0; positions.len()]);
        (0..self.count()).map(|channel| sums.each_ref().map(|sum| sum[channel] / counts[channel])).collect()
    }
}
