//! Traps between two frames: as stiff as possible, with every phase within a bound of its values before and after.

use core::f64::consts::PI;

use crate::device::quantization::Quantization;
use crate::kernels::InstructionSet;
use crate::prelude::*;
use crate::propagation::forces::stiffness::Stiffness;
use crate::solvers::common::phase_descent::PhaseDescent;
use crate::solvers::common::tiled::Wave;
use crate::solvers::even_field::traps::foci::FixedFoci;
use crate::solvers::even_field::traps::on_grid;
use crate::solvers::even_field::traps::stiffest::{self, Softest, planes};
use crate::solvers::last::settled;
use crate::workspace::Workspace;

pub(crate) use crate::solvers::even_field::traps::within::carry_along;

/// The drives (N,) of the frames before and after, where there are such frames, and the bound on the change of a phase:
/// in rad, and in codes of a board.
pub(crate) struct Neighbours<'a> {
    pub(crate) beside: [Option<&'a [Complex32]>; 2],
    pub(crate) bound: f64,
    pub(crate) codes: usize,
}

impl Neighbours<'_> {
    /// Returns the middle of the arc of phases that drive i may have, and the arc's half width in rad.
    fn arc(&self, i: usize) -> (Complex32, f64) {
        if self.bound >= PI {
            return (Complex32::ONE, PI);
        }
        match self.beside.map(|row| row.map(|row| row[i])) {
            [Some(a), Some(b)] => {
                let turn = b * a.conj();
                let half = 0.5 * math::atan2(f64::from(turn.im), f64::from(turn.re));
                let middle = math::phasor(half);
                (a * Complex32::new(middle.re as f32, middle.im as f32), (self.bound - half.abs()).max(0.0))
            }
            [Some(a), None] | [None, Some(a)] => (a, self.bound),
            [None, None] => (Complex32::ONE, PI),
        }
    }
}

/// Improves the drives (N,) of a frame by steps of phase descent within the bound.
///
/// # Errors
/// More memory than allowed is needed, or a stop.
pub(crate) fn improve(
    traps: &Stiffness,
    neighbours: &Neighbours<'_>,
    (set, steps): (InstructionSet, usize),
    drive: &mut [Complex32],
    work: &Workspace,
    control: &mut Control,
) -> Result<(), Error> {
    let mut rows = stiffest::rows(traps, (set, drive.len()), work, control)?;
    let (middles, halves): (Vec<_>, Vec<_>) = (0..drive.len()).map(|i| neighbours.arc(i)).unzip();
    let mut arcs = [(); 2].map(|()| work.floats.take(rows.lanes));
    for (i, &half) in halves.iter().enumerate() {
        (arcs[0][i], arcs[1][i]) = (math::cos(half) as f32, math::sin(half) as f32);
    }
    let mut wave = Wave::new(&rows, work);
    wave.take(&rows, middles.iter().copied());
    rows.rotate(&wave.drive);
    wave.play(&rows, drive.iter().zip(&middles).map(|(q, middle)| q * middle.conj()));
    let fixed = FixedFoci::default();
    let cost = Softest::last((traps, &fixed), planes(&wave), None);
    let mut descent = PhaseDescent::within(arcs, wave, &cost, &rows, work);
    for _ in 0..steps {
        control.pulse()?;
        if !descent.step(&cost, &rows) {
            break;
        }
    }
    let [re, im] = &descent.wave.drive;
    for (i, q) in drive.iter_mut().enumerate().filter(|(i, q)| rows.tiles().reaches(*i) && **q != Complex32::ZERO) {
        *q = settled(settled(middles[i] * Complex32::new(re[i], im[i])));
    }
    Ok(())
}

/// Exchanges single phases of a board in the drives (N,) of a frame, if that lowers the cost of the traps.
pub(crate) fn exchange(
    traps: &Stiffness,
    neighbours: &Neighbours<'_>,
    (set, board): (InstructionSet, &Quantization),
    drive: &mut [Complex32],
) {
    let fixed = FixedFoci::default();
    let field = traps.field(drive);
    let before = field.each_ref().map(|plane| &plane[..]);
    let cost = Softest::last((traps, &fixed), before, None);
    let others: Vec<_> = neighbours.beside.iter().flatten().copied().collect();
    let mut changed = drive.to_vec();
    let codes = neighbours.codes as f32;
    on_grid::bring(set, (traps, &fixed, cost.unit), board, (&others, codes), (&mut changed, &mut || false));
    let after = traps.field(&changed);
    if cost.of_field([&after[0], &after[1]]) < cost.of_field(before) {
        drive.copy_from_slice(&changed);
    }
}
