//! Setup: the properties of an array that a problem needs: medium, quantization, positions, bead and channels.

use alloc::borrow::Cow;

use crate::device::channels::Channels;
use crate::device::quantization::Quantization;
use crate::error::one_each;
use crate::prelude::*;
use crate::propagation::{Model, Propagation};
use crate::scene::{Array, Bead, Medium, check_drive, check_positions};

/// The inputs of a problem besides the propagation matrix G and the request. They are useful with any G, also a measured one:
/// the quantization of a board, positions for methods that order the transducers, and a medium for radiation pressures.
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
pub struct Setup {
    /// The air; its density and sound speed give radiation pressures.
    pub medium: Medium,
    /// The phases and amplitudes that the board can play; `None` for any drive.
    pub quantization: Option<Arc<Quantization>>,
    /// The position in m of each column of the propagation matrix G, if known, for methods that order the columns. For a
    /// channel it is the middle of its transducers.
    pub positions: Option<Arc<[[f64; 3]]>>,
    /// The bead that traps are made for.
    pub bead: Bead,
    /// The channels, if each column of the propagation matrix G is a channel; `None` if each column is a transducer.
    pub channels: Option<Channels>,
}

impl Setup {
    /// Returns the setup of a model: its array in its medium, and its bead.
    pub fn of_model(model: &Model) -> Self {
        Self { bead: model.bead(), ..Self::of(model.array(), model.medium()) }
    }

    /// Returns the setup of an array in a medium, with the default bead.
    pub fn of(array: &Array, medium: Medium) -> Self {
        let (positions, quantization) = array.shared();
        let channels = array.wiring().cloned();
        let middles = channels.as_ref().map(|channels| channels.middles(&positions).into());
        Self { medium, quantization, positions: middles.or(Some(positions)), bead: Bead::default(), channels }
    }

    /// Checks that the parts fit the propagation matrix G.
    pub(crate) fn check(&self, propagation: &Propagation) -> Result<(), Error> {
        self.medium.check()?;
        let columns = propagation.transducers();
        if let Some(channels) = &self.channels {
            one_each("columns of G", columns, "of them", channels.count(), "channels")?;
        }
        self.positions.as_ref().map_or(Ok(()), |positions| check_positions(positions, columns))
    }

    /// The number of transducers N, for a propagation matrix G with this many columns.
    pub(crate) fn transducers(&self, columns: usize) -> usize {
        self.channels.as_ref().map_or(columns, |channels| channels.of().len())
    }

    /// Checks a drive (N,), and returns the value of each column of the propagation matrix G.
    ///
    /// # Errors
    /// A drive that the array cannot play.
    pub(crate) fn columns<'a>(&self, drive: &'a [Complex32], columns: usize) -> Result<Cow<'a, [Complex32]>, Error> {
        match &self.channels {
            None => check_drive(drive, columns).map(|()| Cow::Borrowed(drive)),
            Some(channels) => {
                check_drive(drive, channels.of().len())?;
                channels.drives(drive).map(Cow::Owned)
            }
        }
    }
}
