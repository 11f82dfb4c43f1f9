//! Recipe: the parts of a stored propagation matrix G, where no kernel computes it: obstacles, a signature, channels.

use crate::device::channels::Channels;
use crate::prelude::*;
use crate::propagation::forces::stiffness::Stiffness;
use crate::propagation::scattering::Scattering;
use crate::propagation::sources::Sources;
use crate::propagation::taylor::add_exact;
use crate::scene::signature::frame;
use crate::scene::{Bead, Signature};

/// The most entries of a stored propagation matrix G. Computing so many takes a tenth of a second and a few MB. If
/// each entry is the sum of more than eight waves, the limit is lower in proportion.
const MOST_ENTRIES: usize = 1 << 20;

/// The propagation matrix G column by column, or the error that prevents it.
pub(crate) type Matrix = Result<Arc<[Complex64]>>;

/// The points and the entries of an earlier propagation matrix G that differs only in the points. Columns of points
/// that have not moved are copied from it. Both lists are empty if there is no earlier matrix.
#[derive(Clone, Copy, Default)]
pub(crate) struct Known<'a> {
    pub(crate) points: &'a [[f64; 3]],
    pub(crate) entries: &'a [Complex64],
}

/// The functions that compute the results of a [`Recipe`], as function pointers. A program without obstacles and
/// signatures is then not linked with them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Make {
    /// Computes the propagation matrix G, by [`Recipe::matrix`].
    pub(crate) matrix: fn(&Recipe, Known<'_>) -> Matrix,
    /// Computes the stiffness of traps, by [`Recipe::stiffness`].
    pub(crate) stiffness: fn(&Recipe, Bead, &mut Control) -> Result<Option<Stiffness>>,
}

/// The parameters of a stored propagation matrix G.
#[derive(Clone, Debug)]
pub(crate) struct Recipe {
    pub(crate) sources: Arc<Sources>,
    pub(crate) points: Arc<[[f64; 3]]>,
    pub(crate) scattering: Option<Arc<Scattering>>,
    pub(crate) signature: Option<Signature>,
    /// The channels: the columns of transducers on one channel are summed.
    pub(crate) channels: Option<Channels>,
    pub(crate) make: Make,
}

impl PartialEq for Recipe {
    fn eq(&self, other: &Self) -> bool {
        let same = self.sources.array == other.sources.array && self.sources.medium == other.sources.medium;
        let obstacles = [self, other].map(|recipe| recipe.scattering.as_ref().map(|scattering| &scattering.obstacles));
        same && self.points == other.points
            && obstacles[0] == obstacles[1]
            && self.signature == other.signature
            && self.channels == other.channels
    }
}

impl Recipe {
    pub(crate) const MAKE: Make = Make { matrix: Self::matrix, stiffness: Self::stiffness };

    /// The functions for channels alone, without obstacles and signature.
    pub(crate) const BARE: Make = Make { matrix: Self::bare, stiffness: |_, _, _| Ok(None) };

    /// Computes the propagation matrix G in Pa, column by column (N or C, M).
    ///
    /// # Errors
    /// Points inside obstacles, a signature that does not fit, more entries than can be stored.
    fn matrix(&self, known: Known<'_>) -> Matrix {
        let array = &self.sources.array;
        self.signature.as_ref().map_or(Ok(()), |signature| signature.check(array.len(), self.points.len()))?;
        let (waves, why) = match (&self.scattering, &self.signature) {
            (Some(scattering), _) => (scattering.cost(), "obstacles"),
            (None, Some(_)) => (1, "a signature"),
            (None, None) => (1, "channels"),
        };
        self.columns(waves, why, known, |chosen, points, rows| {
            if let Some(scattering) = &self.scattering {
                scattering.check()?;
                let check = |(&j, &point): (&usize, &[f64; 3])| {
                    scattering.obstacles.check_point(point, || format!("points[{j}].position"))
                };
                chosen.iter().zip(points).try_for_each(check)?;
            }
            let scattering = self.scattering.as_deref();
            let images = scattering.map_or(&[][..], |all| &all.images);
            let sources = core::iter::once(&*self.sources).chain(images);
            let Some(signature) = &self.signature else {
                sources.for_each(|one| add_exact(one, points, rows));
                if let Some(all) = scattering {
                    all.add(&self.sources, points, rows);
                }
                return Ok(());
            };
            let waves = |add: &dyn Fn(&mut [Vec<Complex64>])| {
                let mut waves = vec![vec![Complex64::ZERO; array.len()]; points.len()];
                add(&mut waves);
                waves
            };
            let direct =
                sources.map(|one| (waves(&|rows| add_exact(one, points, rows)), one.array.positions().to_vec()));
            let bodies = scattering
                .and_then(|all| Some((all, all.centre()?)))
                .map(|(all, centre)| (waves(&|rows| all.add(&self.sources, points, rows)), vec![centre; array.len()]));
            let (frame, mut above) = (frame(array.normals()), rows.to_vec());
            for (waves, places) in direct.chain(bodies) {
                for (k, (i, &place)) in (0..points.len()).flat_map(|k| places.iter().enumerate().map(move |at| (k, at)))
                {
                    rows[k][i] += waves[k][i];
                    if (Vec3(place) - points[k]).dot(frame[2]) > 0.0 {
                        above[k][i] += waves[k][i];
                    }
                }
            }
            for (k, (row, (&j, &point))) in rows.iter_mut().zip(chosen.iter().zip(points)).enumerate() {
                let factors = signature.factors((array, &frame), (j, point), [row, &above[k]]);
                row.iter_mut().zip(factors).for_each(|(g, s)| *g *= s);
            }
            Ok(())
        })
    }

    fn bare(&self, known: Known<'_>) -> Matrix {
        self.columns(1, "channels", known, |_, points, rows| {
            for (row, &point) in rows.iter_mut().zip(points) {
                row.iter_mut().enumerate().for_each(|(i, g)| *g = self.sources.exact(i, point));
            }
            Ok(())
        })
    }

    /// Computes the columns of the propagation matrix G. Each entry is the sum of `waves` waves; `why` explains in
    /// the error why G is stored. `add` gets the indices and positions of the points that are not known, and one row
    /// of zeros for each, to which it adds the waves.
    fn columns(
        &self,
        waves: usize,
        why: &str,
        known: Known<'_>,
        add: impl Fn(&[usize], &[[f64; 3]], &mut [Vec<Complex64>]) -> Result<()>,
    ) -> Matrix {
        let (transducers, count) = (self.sources.array.len(), self.points.len());
        let most = (8 * MOST_ENTRIES / waves.max(8) / transducers).max(1);
        if count > most {
            let cure = format!("with {why} G is kept: give at most {most}");
            return Err(Error::shape("points", format!("{count} of them"), cure));
        }
        let columns = self.channels.as_ref().map_or(transducers, Channels::count);
        let alike = known.points.len() == count;
        let stays = |j: usize| alike && known.points[j] == self.points[j];
        let chosen: Vec<usize> = (0..count).filter(|&j| !stays(j)).collect();
        let points: Vec<[f64; 3]> = chosen.iter().map(|&j| self.points[j]).collect();
        let mut rows = vec![vec![Complex64::ZERO; transducers]; chosen.len()];
        add(&chosen, &points, &mut rows)?;
        let mut matrix = if alike { known.entries.to_vec() } else { vec![Complex64::ZERO; columns * count] };
        for (&j, mut row) in chosen.iter().zip(rows) {
            if let Some(channels) = &self.channels {
                row = channels.sums(&row);
            }
            row.into_iter().enumerate().for_each(|(i, g)| matrix[i * count + j] = g);
        }
        Ok(matrix.into())
    }

    /// The stiffness for a bead of the points that are traps, without the signature; the other points are foci. `None` where derivatives of
    /// the field are unknown, as on the surface of a sphere or a mesh.
    ///
    /// # Errors
    /// More memory than allowed, a stop by the caller.
    fn stiffness(&self, bead: Bead, control: &mut Control) -> Result<Option<Stiffness>> {
        let trap = |j: &usize| self.signature.as_ref().is_some_and(|signature| *signature.of(*j) == Signature::Trap);
        let (traps, foci): (Vec<usize>, _) = (0..self.points.len()).partition(trap);
        let (scattering, channels) = (self.scattering.as_deref(), self.channels.as_ref());
        Stiffness::of(bead, &self.sources, scattering, channels, &self.points, [traps, foci], control)
    }

    /// Returns the parameters for some of the points, by their indices.
    pub(crate) fn select(&self, chosen: &[usize]) -> Self {
        let signature = self.signature.as_ref().map(|signature| signature.select(chosen));
        Self { points: chosen.iter().map(|&j| self.points[j]).collect(), signature, ..self.clone() }
    }
}
