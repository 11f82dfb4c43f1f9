//! greedy with an energy of your own instead of eq. (7): the search of Algorithm 2 (Suzuki et al. 2021).
//!
//! Each transducer's turn evaluates all candidates at once; a sweep has N turns. Nothing is known about the energy, so
//! there are no shortcuts: a turn takes O(K L M) plus the time of the energy itself.

use crate::math::modulus;
use crate::solvers::greedy::Greedy;
use crate::solvers::prelude::*;

/// The least advantage with which a later candidate wins, relative to the largest value: the rounding of sums in f32.
const ROUNDING: f64 = 1e-7;

/// Energy of candidates, written by the caller; the candidate with the lowest is taken.
pub trait Energy: Send + Sync {
    /// Writes the values (K,) of K candidates. `fields` (K, M) are the pressures p_j in Pa that each candidate would
    /// make, one candidate after another.
    ///
    /// # Errors
    /// Any error that ends the solve; the best drive so far is then lost.
    fn evaluate(&self, fields: &[Complex32], request: &ActiveRequest, values: &mut [f64]) -> Result<()>;
}

/// Targets and weights of the M points whose weight is above 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ActiveRequest {
    /// Targets (M,) in Pa.
    pub targets: Vec<f64>,
    /// Weights (M,), the largest 1.
    pub weights: Vec<f64>,
}

/// Greedy search by an [`Energy`]: phases, amplitudes, order, seed and sweeps of `greedy`, from silence.
///
/// ```
/// use midair::solvers::{ActiveRequest, Energy, Greedy, GreedyBy};
/// use midair::{Array, Complex32, Control, Error, Medium, Problem, Request, Scene, Workspace};
///
/// /// As loud as possible, at any place.
/// struct Loud;
/// impl Energy for Loud {
///     fn evaluate(&self, fields: &[Complex32], request: &ActiveRequest, values: &mut [f64]) -> Result<(), Error> {
///         for (value, field) in values.iter_mut().zip(fields.chunks(request.targets.len())) {
///             *value = -field.iter().map(|p| f64::from(p.norm_sqr())).sum::<f64>();
///         }
///         Ok(())
///     }
/// }
///
/// let array = Array::grid(8, 8, 0.01)?;
/// let scene = Scene::new(array, Medium::default(), vec![[0.0, 0.0, 0.1]], Request::default())?;
/// let solver = GreedyBy::new(Greedy::default(), Box::new(Loud));
/// let problem = Problem::new(&scene)?;
/// let solution = midair::solve(&problem, &solver, false, &mut Workspace::new(), &mut Control::none())?;
/// assert!(solution.metrics().level > 0.98);
/// # Ok::<(), Error>(())
/// ```
pub struct GreedyBy {
    greedy: Greedy,
    energy: Box<dyn Energy>,
}

impl GreedyBy {
    /// Name, summary and source of the method.
    pub const INFO: Info = Info::new(
        "greedy",
        "greedy with brute-force search by an energy of your own",
        "Suzuki et al., IEEE Trans. Haptics 14(4), 2021, Algorithm 2 and section VI",
    );

    /// Creates the search of `greedy` by an energy in place of its `objective`.
    pub fn new(greedy: Greedy, energy: Box<dyn Energy>) -> Self {
        Self { greedy, energy }
    }
}

impl Solve for GreedyBy {
    fn solve(&self, problem: &Problem, work: &mut Workspace, control: &mut Control) -> Result<Solution> {
        let greedy = &self.greedy;
        let propagation = problem.propagation();
        let (points, lanes) = (propagation.points(), propagation.lanes());
        let (order, candidates) = greedy.search(problem, work)?;
        let request = ActiveRequest {
            targets: problem.active_targets_in_pascals().collect(),
            weights: problem.weights()[..points].iter().map(|&weight| weight.into()).collect(),
        };
        let unit = propagation.reference();
        let candidates_bytes = bytes(16, &[candidates.count(), points]);
        control.room("the fields of the candidates", [propagation.transducers(), points], candidates_bytes)?;
        let [mut re, mut im] = [(); 2].map(|()| work.floats.take(lanes));
        let mut drive = work.complexes.take(propagation.transducers());
        let mut field = vec![Complex32::ZERO; points];
        let mut fields = vec![Complex32::ZERO; candidates.count() * points];
        let mut values = vec![0.0; candidates.count()];
        let (mut status, mut steps, all) = (Status::Done, 0, order.len() * greedy.sweeps as usize);
        for &i in (0..greedy.sweeps).flat_map(|_| &*order) {
            let i = i as usize;
            propagation.row(i, &mut re, &mut im);
            let g = |j: usize| Complex32::new((f64::from(re[j]) * unit) as f32, (f64::from(im[j]) * unit) as f32);
            // A transducer without effect stays off.
            if (0..points).any(|j| g(j) != Complex32::ZERO) {
                for (j, p) in field.iter_mut().enumerate() {
                    *p -= g(j) * drive[i];
                }
                let silent = field.iter().all(|&p| p == Complex32::ZERO);
                for (k, chunk) in fields.chunks_mut(points).enumerate() {
                    let [re, im] = candidates.drive(k);
                    chunk.iter_mut().enumerate().for_each(|(j, p)| *p = field[j] + g(j) * Complex32::new(re, im));
                }
                self.energy.evaluate(&fields, &request, &mut values)?;
                // While all pressures are 0, all phases give the same energy, so that only phase 0 is tried.
                let step = if silent { candidates.phases } else { 1 };
                let best = best(&values, step)?;
                let [re, im] = candidates.drive(best);
                drive[i] = Complex32::new(re, im);
                field.copy_from_slice(&fields[best * points..][..points]);
            }
            steps += 1;
            let moduli = || field.iter().map(|&p| modulus(p) / unit).chain((points..lanes).map(|_| 0.0));
            if control.step(steps, all, || problem.residual_of(moduli())).is_break() {
                status = Status::Stopped;
                break;
            }
        }
        for buffer in candidates.into_buffers() {
            work.floats.give(buffer);
        }
        let drive = drive.into_vec();
        // The steps were reported during the search, so the solution reports none.
        Ok(Solution::new(problem, drive, (status, steps), all, work, &mut Control::none())?.on_grid())
    }
}

/// Returns the index of the lowest of every `step`th value; of equal values the first.
fn best(values: &[f64], step: usize) -> Result<usize> {
    if let Some(k) = values.iter().position(|value| !value.is_finite()) {
        let cure = "give a finite number for each candidate";
        return Err(Error::invalid(format!("objective[{k}]"), format!("{:?}", values[k]), cure));
    }
    let slack = ROUNDING * values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let better = |best: usize, k: usize| if values[k] < values[best] - slack { k } else { best };
    Ok((0..values.len()).step_by(step).fold(0, better))
}
