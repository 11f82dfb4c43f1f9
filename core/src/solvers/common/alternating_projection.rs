//! Between transducers and points: back, forward, and the two in turn as Gerchberg-Saxton's methods do it.

use alloc::vec::Vec;

use num_complex::Complex32;

use crate::kernels;
use crate::kernels::simd::instruction_set::InstructionSet;
use crate::linalg::Planar;
use crate::math;
use crate::math::sqrtf;
use crate::problem::Problem;
use crate::propagation::Propagation;
use crate::workspace::Workspace;

/// G stored, a drive of |q| = 1, and its field.
pub(crate) struct Projector {
    set: InstructionSet,
    propagation: Planar,
    count: usize,
    drive: Vec<Complex32>,
    field: Planar,
    modulus: Vec<f32>,
    before: Vec<f32>,
}

impl Projector {
    /// Starts from the problem's start, else from q = 1.
    pub(crate) fn new(problem: &Problem, work: &mut Workspace) -> Self {
        let propagation = problem.propagation();
        let lanes = propagation.lanes();
        let mut projector = Self {
            set: propagation.instruction_set(),
            propagation: Planar::stored(propagation, work),
            count: propagation.points(),
            drive: work.complexes.take(propagation.transducers()),
            field: Planar::zeros(1, lanes, work),
            modulus: work.floats.take(lanes),
            before: work.floats.take(lanes),
        };
        match problem.start_drive() {
            Some(drive) => projector.drive.copy_from_slice(drive),
            None => projector.drive.fill(Complex32::ONE),
        }
        projector.forward(problem.targets());
        if problem.start_phases().is_some() {
            let mut wanted = start_phasors(problem, work);
            for (j, &target) in problem.targets().iter().enumerate() {
                wanted.re[j] *= target;
                wanted.im[j] *= target;
            }
            projector.back(&wanted);
            projector.forward(problem.targets());
            wanted.give(work);
        }
        projector
    }

    pub(crate) fn drive(&self) -> &[Complex32] {
        &self.drive
    }

    /// |p| of the present drive.
    pub(crate) fn modulus(&self) -> &[f32] {
        &self.modulus
    }

    /// The present phases at the points with other moduli; phase 0 where there is silence.
    pub(crate) fn wanted(&self, moduli: &[f32], out: &mut Planar) {
        for j in 0..self.count {
            let scale = if self.modulus[j] > 0.0 { moduli[j] / self.modulus[j] } else { 0.0 };
            out.re[j] = if scale > 0.0 { self.field.re[j] * scale } else { moduli[j] };
            out.im[j] = self.field.im[j] * scale;
        }
    }

    /// q = G^H p, every |q| made 1; a transducer without effect gets 0.
    pub(crate) fn back(&mut self, wanted: &Planar) {
        let Self { propagation, drive, .. } = self;
        kernels::correlate_rows(self.set, [&propagation.re, &propagation.im], wanted.row(0), |i, q| {
            drive[i] = unit(q)
        });
    }

    /// p = G q. Returns the largest change of a |p| relative to its target.
    pub(crate) fn forward(&mut self, targets: &[f32]) -> f32 {
        core::mem::swap(&mut self.modulus, &mut self.before);
        let Planar { re, im, .. } = &mut self.field;
        kernels::combine_rows(self.set, [&self.propagation.re, &self.propagation.im], &self.drive, [re, im]);
        kernels::modulus(self.set, &self.field.re, &self.field.im, &mut self.modulus);
        let changes = self.modulus.iter().zip(&self.before).zip(targets);
        changes
            .filter(|(_, target)| **target > 0.0)
            .fold(0.0, |most, ((now, before), target)| f32::max(most, (now - before).abs() / target))
    }

    /// Gives the memory back and the drive away.
    pub(crate) fn end(self, work: &mut Workspace) -> Vec<Complex32> {
        let Self { propagation, drive, field, modulus, before, .. } = self;
        propagation.give(work);
        field.give(work);
        work.floats.give_all([modulus, before]);
        drive
    }
}

/// z/|z|, 0 for 0. By the larger part first, so that no square under- or overflows.
pub(crate) fn unit(z: Complex32) -> Complex32 {
    let larger = f32::max(z.re.abs(), z.im.abs());
    if larger == 0.0 {
        return Complex32::ZERO;
    }
    let z = Complex32::new(z.re / larger, z.im / larger);
    z / sqrtf(z.re * z.re + z.im * z.im)
}

/// q_i = factor_i sum_j conj(G_ji) p_j, rows computed on the way.
pub(crate) fn back_project(
    propagation: &Propagation,
    phasors: &Planar,
    factor: impl Fn(usize) -> f32,
    work: &mut Workspace,
) -> Vec<Complex32> {
    let mut drive = work.complexes.take(propagation.transducers());
    let mut row = Planar::zeros(1, propagation.lanes(), work);
    for (i, q) in drive.iter_mut().enumerate() {
        propagation.row(i, &mut row.re, &mut row.im);
        let [re, im] = kernels::correlate(propagation.instruction_set(), row.row(0), phasors.row(0));
        *q = Complex32::new(re, im) * factor(i);
    }
    row.give(work);
    drive
}

/// The unit phasors at the points that a problem's start gives; 1 where there is none, or silence.
pub(crate) fn start_phasors(problem: &Problem, work: &mut Workspace) -> Planar {
    let propagation = problem.propagation();
    let mut phasors = Planar::zeros(1, propagation.lanes(), work);
    phasors.re[..propagation.points()].fill(1.0);
    if let Some(phases) = problem.start_phases() {
        for (j, phase) in phases.enumerate() {
            (phasors.re[j], phasors.im[j]) = (math::cos(phase) as f32, math::sin(phase) as f32);
        }
    }
    if let Some(drive) = problem.start_drive() {
        let [mut row, mut field] = [(); 2].map(|()| Planar::zeros(1, propagation.lanes(), work));
        for (i, q) in drive.iter().enumerate() {
            propagation.row(i, &mut row.re, &mut row.im);
            kernels::accumulate(
                propagation.instruction_set(),
                row.row(0),
                [q.re, q.im],
                &mut field.re,
                &mut field.im,
            );
        }
        for j in 0..propagation.points() {
            let modulus = sqrtf(field.re[j] * field.re[j] + field.im[j] * field.im[j]);
            if modulus > 0.0 {
                (phasors.re[j], phasors.im[j]) = (field.re[j] / modulus, field.im[j] / modulus);
            }
        }
        row.give(work);
        field.give(work);
    }
    phasors
}
