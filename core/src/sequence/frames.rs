//! Frames: the points of a whole sequence, their targets, and G of one transducer at all of them.

use crate::device::channels::Channels;
use crate::kernels::padded;
use crate::propagation::{Model, Propagation};
use crate::scene::check_places;
use crate::solvers::prelude::*;

/// Number of frames whose rows of G are computed together. Their points fill whole lane groups, whatever M is.
pub(super) const TOGETHER: usize = LANES;

/// Number of partial sums over the transducers, independent of the number of threads.
const PARTS: usize = 32;

/// M points in each of T frames.
pub(super) struct Frames<'a> {
    pub(super) model: &'a Model,
    /// T, the number of frames.
    pub(super) count: usize,
    /// M, the number of points in a frame.
    pub(super) points: usize,
    /// Number of columns of G: N transducers, or C channels of an array that has them.
    pub(super) transducers: usize,
    /// Targets (T, M) relative to the largest; 0 for an absent point.
    pub(super) targets: Vec<f32>,
    /// `sum_i |G_ji|` (T, M).
    pub(super) reach: Vec<f32>,
    /// G of [`TOGETHER`] frames in each block; an absent point has the place of another point.
    pub(super) blocks: Vec<Propagation>,
}

impl<'a> Frames<'a> {
    /// Checks points (T, M, 3) and targets (T, M), and computes G.
    pub(super) fn new(
        model: &'a Model,
        points: &[[f64; 3]],
        targets: &[f64],
        frames: usize,
        control: &mut Control,
    ) -> Result<Self> {
        if frames < 2 {
            return Err(Error::out_of_range("frames", frames, "give at least 2: a single one is solved by a solver"));
        }
        if points.is_empty() || !points.len().is_multiple_of(frames) {
            let value = format!("{} points", points.len());
            return Err(Error::invalid("points", value, format!("give as many in each of the {frames} frames")));
        }
        if targets.len() != points.len() {
            let cure = format!("give one for each of the {} points of all frames", points.len());
            return Err(Error::shape("targets", format!("{} values", targets.len()), cure));
        }
        let each = points.len() / frames;
        let name = |k: usize| format!("[{}, {}]", k / each, k % each);
        for (k, &target) in targets.iter().enumerate().filter(|(_, target)| !(0.0..f64::INFINITY).contains(*target)) {
            real(&format!("targets{}", name(k)), target, 0.0, false)?;
        }
        let largest = targets.iter().copied().fold(0.0, f64::max);
        let Some(first) = targets.iter().position(|&target| target > 0.0) else {
            let cure = "give a point of some frame one above 0";
            return Err(Error::new(ErrorCode::Silent, "targets", "0 everywhere", cure));
        };
        let medium = model.medium();
        for (k, point) in points.iter().enumerate().filter(|(k, _)| targets[*k] > 0.0) {
            check_places(model.array().centre(), medium, &format!("points{}", name(k)), "", &[*point])?;
            model.check_point(*point, || format!("points{}", name(k)))?;
        }
        let memory = bytes(model.bytes_a_point(), &[points.len()]);
        control.room("G of all frames, kept behind obstacles", [model.array().len(), points.len()], memory)?;
        let mut all = Self {
            model,
            count: frames,
            points: each,
            transducers: model.array().wiring().map_or(model.array().len(), Channels::count),
            targets: targets.iter().map(|target| (target / largest) as f32).collect(),
            reach: Vec::with_capacity(points.len()),
            blocks: Vec::with_capacity(frames.div_ceil(TOGETHER)),
        };
        let place = |k: usize| points[if targets[k] > 0.0 { k } else { first }];
        let mut reach = Vec::new();
        for begin in (0..points.len()).step_by(TOGETHER * each) {
            let end = points.len().min(begin + TOGETHER * each);
            // One propagation holds several frames, and a signature by point is that of one frame.
            let signature = model.signature().map(|one| one.repeated(model.array().len(), (end - begin) / each));
            let together = model.clone().with_signature(signature);
            let propagation = together.driven(&(begin..end).map(place).collect::<Vec<_>>())?;
            let named = |error: Error| match error.index {
                Some(point) => {
                    let mut error = error.about(format!("points{}", name(begin + point)));
                    error.index = Some((begin + point) / each);
                    error
                }
                None => error,
            };
            propagation.reach(&mut reach, None, control).map_err(named)?;
            all.reach.extend(reach.iter().map(|&reach| reach as f32));
            all.blocks.push(propagation);
        }
        let silent = |k: &usize| targets[*k] > 0.0 && (all.reach[*k].is_nan() || all.reach[*k] <= 0.0);
        if let Some(k) = (0..points.len()).find(silent) {
            let cure = "move it in front of the array, turn a normal or switch a transducer on";
            let item = format!("points{}", name(k));
            return Err(Error::new(ErrorCode::Unreached, item, "reached by no transducer", cure));
        }
        Ok(all)
    }

    /// Returns the mean over the frames of the variance of |P_j|/t_j, relative to its squared mean, for a field (T, M).
    pub(super) fn unevenness(&self, [re, im]: &[Vec<f32>; 2]) -> f64 {
        let frame = |first: usize| {
            let there = (first..first + self.points).filter(|&k| self.targets[k] > 0.0);
            let parts = there.map(|k| math::hypot(f64::from(re[k]), f64::from(im[k])) / f64::from(self.targets[k]));
            let sums = parts.fold([0.0; 3], |[n, sum, squares], x| [n + 1.0, sum + x, squares + x * x]);
            let [n, sum, squares] = sums;
            if sum > 0.0 { (n * squares / (sum * sum) - 1.0).max(0.0) } else { 0.0 }
        };
        (0..self.count).map(|t| frame(t * self.points)).sum::<f64>() / self.count as f64
    }

    pub(super) fn set(&self) -> InstructionSet {
        self.blocks[0].instruction_set()
    }

    /// Returns the length of a row over all points of all frames: T M padded to 16.
    pub(super) fn lanes(&self) -> usize {
        padded(self.count * self.points)
    }

    /// Returns whether a transducer, or any transducer of a channel, radiates.
    pub(super) fn is_on(&self, i: usize) -> bool {
        let array = self.model.array();
        let on = |i: usize| array.effect(i) != Complex64::ZERO;
        array.wiring().map_or_else(|| on(i), |channels| channels.members(i).any(on))
    }

    /// Returns G at some points of a frame.
    pub(super) fn propagation(&self, frame: usize, chosen: &[usize]) -> Propagation {
        let first = frame % TOGETHER * self.points;
        let chosen: Vec<usize> = chosen.iter().map(|j| first + j).collect();
        self.blocks[frame / TOGETHER].select(&chosen)
    }

    /// Writes G of transducer `i` at the points of all frames.
    fn row(&self, i: usize, [re, im]: [&mut [f32]; 2]) {
        let width = TOGETHER * self.points;
        for ((block, re), im) in self.blocks.iter().zip(re.chunks_mut(width)).zip(im.chunks_mut(width)) {
            block.row(i, re, im);
        }
    }

    /// Calls `each` with every transducer that is on, its G, its codes (T,) and a sum to which it adds, on all threads.
    /// Returns the total (T, M). `codes` (N, T) are ordered by transducers. The partial sums do not depend on the
    /// number of threads.
    pub(super) fn gather<W>(
        &self,
        codes: &mut [u16],
        worker: &(dyn Fn() -> W + Sync),
        each: &(dyn Fn(&mut W, Visit<'_>, &mut Control) -> Result<()> + Sync),
        control: &mut Control,
    ) -> Result<[Vec<f32>; 2]> {
        let share = self.transducers.div_ceil(PARTS);
        let count = self.transducers.div_ceil(share);
        let lanes = self.lanes();
        control.room("the parts of the field", [self.transducers, self.points], bytes(8, &[count + 1, lanes]))?;
        let mut sums = vec![[vec![0.0_f32; lanes], vec![0.0_f32; lanes]]; count];
        let mut parts: Vec<_> = codes
            .chunks_mut(share * self.count)
            .zip(&mut sums)
            .enumerate()
            .map(|(k, part)| (k * share, part))
            .collect();
        let a_thread = count.div_ceil(control.threads().min(count));
        let mut hands = Vec::new();
        while !parts.is_empty() {
            hands.push(parts.drain(..a_thread.min(parts.len())).collect::<Vec<_>>());
        }
        control.each(hands, &|parts, control| {
            let mut state = worker();
            let mut row = [vec![0.0; lanes], vec![0.0; lanes]];
            for (first, (codes, [re, im])) in parts {
                for (k, codes) in codes.chunks_mut(self.count).enumerate().filter(|(k, _)| self.is_on(first + k)) {
                    control.pulse()?;
                    self.row(first + k, row.each_mut().map(|plane| &mut plane[..]));
                    let visit = Visit { row: [&row[0], &row[1]], codes, sum: [re, im] };
                    each(&mut state, visit, control)?;
                }
            }
            Ok(())
        })?;
        Ok(sums
            .into_iter()
            .reduce(|[mut re, mut im], [part_re, part_im]| {
                re.iter_mut().zip(part_re).for_each(|(sum, part)| *sum += part);
                im.iter_mut().zip(part_im).for_each(|(sum, part)| *sum += part);
                [re, im]
            })
            .expect("at least one transducer"))
    }
}

/// The data of one transducer that [`Frames::gather`] passes to its closure.
pub(super) struct Visit<'a> {
    /// G over the points of all frames.
    pub(super) row: [&'a [f32]; 2],
    /// One code for each frame.
    pub(super) codes: &'a mut [u16],
    /// The partial sum to add to.
    pub(super) sum: [&'a mut [f32]; 2],
}
