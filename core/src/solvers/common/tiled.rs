//! G stored as tiles (`Rows`), and a drive with its field at the points (`Wave`).

use crate::kernels::lanes::BLOCK;
use crate::kernels::propagate::rows;
use crate::kernels::tiles::Tiles;
use crate::kernels::tiles::unit::{Arc, Arcs};
use crate::kernels::{InstructionSet, tiles};
use crate::linalg::Planar;
use crate::prelude::*;
use crate::problem::{Problem, Solution, Status};
use crate::workspace::{Aligned, Buffer, Workspace};

/// Largest factor by which a row is raised to the size of the largest target: squares stay within f32.
const MOST_RAISED: f32 = 1e12;

/// G as tiles of 16 transducers, with a row for each point.
pub(crate) struct Rows<'w> {
    /// The index of each row's point in the problem.
    pub(crate) order: Buffer<'w, u32>,
    /// Number of rows with a target. These are the first rows, except after [`Rows::new`].
    pub(crate) targeted: usize,
    /// Number of rows of G: the points, then rows of zeros.
    pub(crate) count: usize,
    /// Length of a vector over the transducers.
    pub(crate) lanes: usize,
    /// The factor that multiplied each row.
    pub(crate) scale: Buffer<'w, f32>,
    /// The largest target.
    pub(crate) target: f32,
    pub(crate) set: InstructionSet,
    planes: [Aligned<'w>; 2],
}

impl<'w> Rows<'w> {
    /// Creates the rows of G unchanged, in the problem's order of points.
    pub(crate) fn new(problem: &Problem, work: &'w Workspace, control: &mut Control) -> Result<Self> {
        Self::of(problem, work.counting(problem.propagation().points()), work, control)
    }

    /// Creates rows divided by their points' targets and multiplied by the largest target, so that all rows request the
    /// same pressure. The `quiet` points come last. Each of their rows is multiplied by its weight relative to the
    /// largest weight of a target, so that the same leak is allowed in all.
    pub(crate) fn alike(problem: &Problem, quiet: &[u32], work: &'w Workspace, control: &mut Control) -> Result<Self> {
        let (targets, weights) = (problem.targets(), problem.weights());
        let targeted = (0..problem.propagation().points() as u32).filter(|&j| targets[j as usize] > 0.0);
        let heaviest = targeted.clone().map(|j| weights[j as usize]).fold(f32::MIN_POSITIVE, f32::max);
        let mut points = work.indices.take(targeted.clone().count() + quiet.len());
        points.iter_mut().zip(targeted.chain(quiet.iter().copied())).for_each(|(own, j)| *own = j);
        let mut rows = Self::of(problem, points, work, control)?;
        for k in 0..rows.order.len() {
            control.pulse()?;
            let j = rows.order[k] as usize;
            let factor = if k < rows.targeted { rows.target / targets[j] } else { weights[j] / heaviest };
            if factor != 1.0 {
                rows.rescale(k, factor.clamp(1.0 / MOST_RAISED, MOST_RAISED));
            }
        }
        Ok(rows)
    }

    /// Creates the rows of G for the points `order`, in which points with a target come first.
    pub(crate) fn of(
        problem: &Problem,
        order: Buffer<'w, u32>,
        work: &'w Workspace,
        control: &mut Control,
    ) -> Result<Self> {
        let (propagation, targets) = (problem.propagation(), problem.targets());
        let (rows, transducers) = (propagation.rows(), propagation.transducers());
        let packed = Self::packed(propagation.instruction_set(), rows, transducers, order, work, control)?;
        let targeted = packed.order.iter().filter(|&&j| targets[j as usize] > 0.0).count();
        Ok(Self { targeted, target: targets.iter().copied().fold(0.0, f32::max), ..packed })
    }

    /// Creates some rows of a matrix, without targets.
    pub(crate) fn packed(
        set: InstructionSet,
        rows: rows::Rows,
        transducers: usize,
        order: Buffer<'w, u32>,
        work: &'w Workspace,
        control: &mut Control,
    ) -> Result<Self> {
        let mut scale = work.floats.take_any(order.len());
        scale.fill(1.0);
        let (count, lanes) = (tiles::height(order.len()), tiles::lanes(transducers));
        control.room("the matrix G", [transducers, order.len()], bytes(8, &[tiles::size(count, lanes)]))?;
        let mut planes = [(); 2].map(|()| Aligned::take(tiles::size(count, lanes), work));
        let [re, im] = &mut planes;
        tiles::pack(set, rows, 0..transducers, &order, [re, im], control)?;
        Ok(Self { order, targeted: 0, count, lanes, scale, target: 0.0, set, planes })
    }

    /// Writes the complex conjugate of row `k` of G over the transducers.
    pub(crate) fn conjugate(&self, k: usize, [out_re, out_im]: [&mut [f32]; 2]) {
        let [re, im] = self.tiles().rows(k / BLOCK);
        let tiles = re.iter().zip(im).flat_map(|(re, im)| re[k % BLOCK].iter().zip(&im[k % BLOCK]));
        for ((re, im), (out_re, out_im)) in tiles.zip(out_re.iter_mut().zip(out_im)) {
            (*out_re, *out_im) = (*re, -im);
        }
    }

    /// Returns the number of real equations of an even field: one for each targeted point, two for each quiet one.
    pub(crate) fn equations(&self) -> usize {
        2 * self.order.len() - self.targeted
    }

    /// Multiplies the column of each transducer by its q; drives are then relative to these q.
    pub(crate) fn rotate(&mut self, [re, im]: &[Buffer<'_, f32>; 2]) {
        tiles::rotate_columns(self.set, self.planes.each_mut().map(|plane| &mut plane[..]), [re, im]);
    }

    /// Multiplies row `k` by `factor`.
    pub(crate) fn rescale(&mut self, k: usize, factor: f32) {
        self.scale[k] *= factor;
        for plane in &mut self.planes {
            tiles::rescale(plane, self.lanes, k, factor);
        }
    }

    /// Returns the same arc for each drive.
    pub(crate) fn arcs(&self, arc: Arc, work: &'w Workspace) -> [Buffer<'w, f32>; 2] {
        arc.map(|part| {
            let mut list = work.floats.take_any(self.lanes);
            list.fill(part);
            list
        })
    }

    pub(crate) fn tiles(&self) -> Tiles<'_> {
        let [re, im] = &self.planes;
        Tiles { planes: [re, im], lanes: self.lanes }
    }
}

/// A drive q and its field P = G q at the rows.
pub(crate) struct Wave<'w> {
    pub(crate) drive: [Buffer<'w, f32>; 2],
    pub(crate) field: [Buffer<'w, f32>; 2],
    /// |P| at the rows.
    pub(crate) moduli: Buffer<'w, f32>,
}

impl<'w> Wave<'w> {
    /// Creates a wave to be written. Its moduli are 0; drive and field are not set.
    pub(crate) fn new(rows: &Rows, work: &'w Workspace) -> Self {
        let pair = |size: usize| [(); 2].map(|()| work.floats.take_any(size));
        let (drive, field) = (pair(rows.lanes), pair(rows.count));
        Self { drive, field, moduli: work.floats.take(rows.count) }
    }

    /// Sets the wave to the result of a kernel, and computes its moduli.
    pub(crate) fn set(&mut self, kernel: impl FnOnce(tiles::Wave<'_>)) {
        let [drive, field] = [&mut self.drive, &mut self.field].map(|pair| pair.each_mut().map(|plane| &mut plane[..]));
        kernel(tiles::Wave { drive, field });
        self.measure();
    }

    /// Computes the moduli from the field.
    pub(crate) fn measure(&mut self) {
        for (modulus, (re, im)) in self.moduli.iter_mut().zip(self.field[0].iter().zip(&self.field[1])) {
            *modulus = sqrtf(re * re + im * im);
        }
    }

    /// Sets the drive, 0 for transducers without effect, and P = G q.
    pub(crate) fn play(&mut self, rows: &Rows, drive: impl Iterator<Item = Complex32>) {
        self.take(rows, drive);
        self.hear(rows);
    }

    /// Computes P = G q of the wave's drive.
    pub(crate) fn hear(&mut self, rows: &Rows) {
        self.set(|wave| tiles::play(rows.set, rows.tiles(), wave));
    }

    /// Does the same as [`Wave::play`] with every |q| set to 1; 0 stays 0.
    pub(crate) fn play_at_full(&mut self, rows: &Rows, drive: impl Iterator<Item = Complex32>) {
        self.take(rows, drive);
        tiles::unit::normalise(rows.set, self.drive.each_mut().map(|plane| &mut plane[..]));
        self.hear(rows);
    }

    /// Sets the drive, 0 for transducers without effect. The field remains that of the old drive.
    pub(crate) fn take(&mut self, rows: &Rows, drive: impl Iterator<Item = Complex32>) {
        let [re, im] = &mut self.drive;
        re.fill(0.0);
        im.fill(0.0);
        for (i, q) in drive.enumerate().filter(|(i, _)| rows.tiles().reaches(*i)) {
            (re[i], im[i]) = (q.re, q.im);
        }
    }

    /// Does the same as [`Wave::take`] for a list times a factor, which is 0 for transducers without effect.
    pub(crate) fn scaled(&mut self, rows: &Rows, list: &[Complex32], factor: f32) {
        tiles::unit::scaled(rows.set, list, factor, self.drive.each_mut().map(|plane| &mut plane[..]));
    }

    /// Does the same as [`Wave::take`] for a list times the conjugates of another list.
    pub(crate) fn relate(&mut self, rows: &Rows, list: &[Complex32], to: &[Complex32]) {
        tiles::unit::relative(rows.set, [list, to], self.drive.each_mut().map(|plane| &mut plane[..]));
    }

    /// Rotates each q of the wave `from` by the phase atan(`factor` `rotations`) at |q| = 1 (0 stays 0), and computes P
    /// = G q.
    pub(crate) fn rotate(&mut self, rows: &Rows, from: &Wave<'_>, rotations: &[f32], factor: f32) {
        let [re, im] = &from.drive;
        self.set(|wave| tiles::unit::turn(rows.set, rows.tiles(), [re, im], rotations, factor, wave));
    }

    /// Does the same as [`Wave::rotate`] with factor 1, and each q within its arc around 1.
    pub(crate) fn rotate_within(&mut self, rows: &Rows, from: &Wave<'_>, rotations: &[f32], arcs: Arcs<'_>) {
        let [re, im] = &from.drive;
        self.set(|wave| tiles::unit::turn_within(rows.set, rows.tiles(), [re, im], rotations, arcs, wave));
    }

    pub(crate) fn copy(&mut self, other: &Wave<'_>) {
        let own = self.drive.iter_mut().chain(&mut self.field).chain([&mut self.moduli]);
        let others = other.drive.iter().chain(&other.field).chain([&other.moduli]);
        own.zip(others).for_each(|(own, other)| own.copy_from_slice(other));
    }

    /// Returns the wave as a solver's solution; the rows are those of the problem, unchanged. The pair is the status
    /// and the number of steps taken, of `steps`.
    pub(crate) fn solution(
        &self,
        problem: &Problem,
        (status, step): (Status, usize),
        steps: usize,
        work: &Workspace,
        control: &mut Control,
    ) -> Result<Solution> {
        let propagation = problem.propagation();
        let mut field = Planar::zeros(1, propagation.lanes(), work);
        for (to, from) in [&mut field.re, &mut field.im].into_iter().zip(&self.field) {
            to.iter_mut().zip(from).for_each(|(to, from)| *to = *from);
        }
        let drive = self.drives(propagation.transducers(), work);
        let mut solution = Solution::of_field(problem, drive, &field, status, step, work, control)?;
        solution.tell(problem, steps, control);
        Ok(solution)
    }

    /// Returns the drives of `count` transducers.
    pub(crate) fn drives(&self, count: usize, work: &Workspace) -> Vec<Complex32> {
        let mut drive = work.complexes.take(count);
        for (q, (&re, &im)) in drive.iter_mut().zip(self.drive[0].iter().zip(&self.drive[1])) {
            *q = Complex32::new(re, im);
        }
        drive.into_vec()
    }
}

#[cfg(test)]
#[path = "tests/tiled.rs"]
pub(crate) mod tests;
