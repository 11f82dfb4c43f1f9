//! Setup: the array behind G, as far as a problem needs it (medium, quantization, positions).

use alloc::sync::Arc;

use crate::device::quantization::Quantization;
use crate::error::Error;
use crate::propagation::Propagation;
use crate::scene::{Array, Medium, check_positions};

/// What a problem takes beside G and the request. Whatever array G was computed or measured from, it can have a
/// board's quantization, positions for an order of its transducers, and a medium for radiation pressures.
///
/// ```
/// use midair::{Complex64, Control, Problem, Propagation, Quantization, Request, Setup, Workspace, solvers::Greedy};
///
/// // A measured matrix of 2 points and 3 transducers, played by a board of 8 phases.
/// let matrix = [1.0, 2.0, 3.0, 3.0, 2.0, 1.0].map(|re| Complex64::new(re, 0.0));
/// let setup = Setup { quantization: Some(Quantization::new(Some(8), None)?.into()), ..Setup::default() };
/// let problem = Problem::with_propagation(Propagation::from_matrix(&matrix, 2)?, setup, &Request::default())?;
/// let greedy = Greedy { phases: 8, ..Greedy::default() };
/// let solution = midair::solve(&problem, &greedy, false, &mut Workspace::new(), &mut Control::none())?;
/// assert!(solution.metrics().accuracy > 0.9);
/// # Ok::<(), midair::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[allow(clippy::exhaustive_structs, reason = "checked where a problem is made of it")]
pub struct Setup {
    /// The air: density and sound speed give radiation pressures.
    pub medium: Medium,
    /// What the board can play; `None` for any drive.
    pub quantization: Option<Arc<Quantization>>,
    /// The transducers' positions (N, 3) in m, where they are known: for an order of columns.
    pub positions: Option<Arc<[[f64; 3]]>>,
}

impl Setup {
    /// That of an array in a medium.
    #[must_use]
    pub fn of(array: &Array, medium: Medium) -> Self {
        let (positions, quantization) = array.shared();
        Self { medium, quantization, positions: Some(positions) }
    }

    /// Refuses what does not fit G.
    pub(crate) fn check(&self, propagation: &Propagation) -> Result<(), Error> {
        self.medium.check()?;
        self.positions.as_ref().map_or(Ok(()), |positions| check_positions(positions, propagation.transducers()))
    }
}
