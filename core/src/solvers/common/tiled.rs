//! G stored as tiles (`Rows`), and a drive with its field at the points (`Wave`).

use alloc::vec::Vec;

use num_complex::Complex32;

use crate::control::{Control, bytes};
use crate::error::Error;
use crate::kernels::InstructionSet;
use crate::kernels::tiles;
use crate::kernels::tiles::Tiles;
use crate::math::sqrtf;
use crate::problem::Problem;
use crate::workspace::{Aligned, Buffer, Workspace};

/// The most that a target may be raised to the largest one's size: squares stay within f32.
const MOST_RAISED: f32 = 1e12;

/// G as tiles of 16 transducers, a row a point.
pub(crate) struct Rows<'w> {
    /// The problem's point of each row.
    pub(crate) order: Buffer<'w, u32>,
    /// Rows of points with a target, where these come first.
    pub(crate) targeted: usize,
    /// Rows of G: the points, and zeros.
    pub(crate) count: usize,
    /// Length of a vector over the transducers.
    pub(crate) lanes: usize,
    /// Factor of each row.
    pub(crate) scale: Buffer<'w, f32>,
    /// The largest target.
    pub(crate) target: f32,
    pub(crate) set: InstructionSet,
    planes: [Aligned<'w>; 2],
}

impl<'w> Rows<'w> {
    /// G as it is, point by point.
    pub(crate) fn new(problem: &Problem, work: &'w Workspace, control: &mut Control) -> Result<Self, Error> {
        Self::ordered(problem, 0..problem.propagation().points() as u32, work, control)
    }

    /// Each row divided by its point's target and multiplied by the largest, so that all points ask for the same; the quiet
    /// ones come last, as they are.
    pub(crate) fn alike(problem: &Problem, work: &'w Workspace, control: &mut Control) -> Result<Self, Error> {
        let targets = problem.targets();
        let targeted = |j: &u32| targets[*j as usize] > 0.0;
        let all = 0..problem.propagation().points() as u32;
        let points = all.clone().filter(targeted).chain(all.filter(|j| !targeted(j)));
        let mut rows = Self::ordered(problem, points, work, control)?;
        for k in 0..rows.targeted {
            let own = targets[rows.order[k] as usize];
            if own < rows.target {
                rows.rescale(k, (rows.target / own).min(MOST_RAISED));
            }
        }
        Ok(rows)
    }

    /// The points' rows of G in an order of theirs.
    fn ordered(
        problem: &Problem,
        points: impl Iterator<Item = u32>,
        work: &'w Workspace,
        control: &mut Control,
    ) -> Result<Self, Error> {
        let (propagation, targets) = (problem.propagation(), problem.targets());
        let mut order = work.indices.take(propagation.points());
        order.iter_mut().zip(points).for_each(|(own, j)| *own = j);
        let mut scale = work.floats.take(propagation.points());
        scale.fill(1.0);
        let (count, lanes) = (tiles::height(propagation.points()), tiles::lanes(propagation.transducers()));
        let sides = [propagation.transducers(), propagation.points()];
        control.room("the matrix G", sides, bytes(8, &[tiles::size(count, lanes)]))?;
        let mut planes = [(); 2].map(|()| Aligned::take(tiles::size(count, lanes), work));
        let [re, im] = &mut planes;
        let members = 0..propagation.transducers();
        tiles::pack(propagation.instruction_set(), propagation.rows(), members, &order, [re, im], control)?;
        let targeted = targets.iter().filter(|&&target| target > 0.0).count();
        let target = targets.iter().copied().fold(0.0, f32::max);
        Ok(Self { order, targeted, count, lanes, scale, target, set: propagation.instruction_set(), planes })
    }

    /// Real equations of even fields: one a targeted point, two a quiet one.
    pub(crate) fn equations(&self) -> usize {
        2 * self.order.len() - self.targeted
    }

    /// Multiplies row `k` by `factor`.
    pub(crate) fn rescale(&mut self, k: usize, factor: f32) {
        self.scale[k] *= factor;
        for plane in &mut self.planes {
            tiles::rescale(plane, self.lanes, k, factor);
        }
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
    /// |P|.
    pub(crate) moduli: Buffer<'w, f32>,
}

impl<'w> Wave<'w> {
    /// A wave to write: only its moduli are set, to 0.
    pub(crate) fn new(rows: &Rows, work: &'w Workspace) -> Self {
        let pair = |size: usize| [(); 2].map(|()| work.floats.take_any(size));
        let (drive, field) = (pair(rows.lanes), pair(rows.count));
        Self { drive, field, moduli: work.floats.take(rows.count) }
    }

    /// What a kernel makes of it, and the moduli.
    pub(crate) fn set(&mut self, kernel: impl FnOnce(tiles::Wave<'_>)) {
        let [drive, field] = [&mut self.drive, &mut self.field].map(|pair| pair.each_mut().map(|plane| &mut plane[..]));
        kernel(tiles::Wave { drive, field });
        for (modulus, (re, im)) in self.moduli.iter_mut().zip(self.field[0].iter().zip(&self.field[1])) {
            *modulus = sqrtf(re * re + im * im);
        }
    }

    /// Takes another `drive`, 0 for transducers without effect, and P = G q of it.
    pub(crate) fn play(&mut self, rows: &Rows, drive: impl Iterator<Item = Complex32>) {
        self.take(rows, drive);
        self.hear(rows);
    }

    /// P = G q of its own drive.
    pub(crate) fn hear(&mut self, rows: &Rows) {
        self.set(|wave| tiles::play(rows.set, rows.tiles(), wave));
    }

    /// As [`Wave::play`], with every |q| made 1, 0 staying 0.
    pub(crate) fn play_at_full(&mut self, rows: &Rows, drive: impl Iterator<Item = Complex32>) {
        self.take(rows, drive);
        tiles::normalise(rows.set, self.drive.each_mut().map(|plane| &mut plane[..]));
        self.hear(rows);
    }

    fn take(&mut self, rows: &Rows, drive: impl Iterator<Item = Complex32>) {
        let [re, im] = &mut self.drive;
        re.fill(0.0);
        im.fill(0.0);
        for (i, q) in drive.enumerate().filter(|(i, _)| rows.tiles().reaches(*i)) {
            (re[i], im[i]) = (q.re, q.im);
        }
    }

    /// Rotates each q of the wave `from` by the phase atan(`factor` `rotations`) at |q| = 1, 0 staying 0, and P = G q.
    pub(crate) fn rotate(&mut self, rows: &Rows, from: &Wave<'_>, rotations: &[f32], factor: f32) {
        let [re, im] = &from.drive;
        self.set(|wave| tiles::turn(rows.set, rows.tiles(), [re, im], rotations, factor, wave));
    }

    pub(crate) fn copy(&mut self, other: &Wave<'_>) {
        let own = self.drive.iter_mut().chain(&mut self.field).chain([&mut self.moduli]);
        let others = other.drive.iter().chain(&other.field).chain([&other.moduli]);
        own.zip(others).for_each(|(own, other)| own.copy_from_slice(other));
    }

    /// The drives of `count` transducers.
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
