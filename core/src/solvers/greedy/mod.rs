//! greedy: brute-force search over K amplitudes x L phases (Suzuki et al. 2021, Algorithm 2).
//!
//! One transducer after another takes, of K amplitudes times L phases, the drive that lowers eq. (7) most. The field at
//! the points is stored and updated (eq. 9), so that all takes O(K L M N). No matrix is stored: each row of G is
//! computed when it is used. The search compares *differences* of energies, because at N = 10^4 a transducer changes
//! the energy by less than the rounding of its sum in f32.
//!
//! Given a start, the last frame's drive, it replaces each transducer's wave by the best one within a bound on the
//! change of phase, see [`crate::solvers::common::coordinate_descent`].

pub(crate) mod by_energy;

use core::any::Any;

use crate::kernels::greedy::{Pass, Search, interleaved_pass};
use crate::kernels::{Candidates, L1, L2, PhaseRange, PointGroup, greedy, table};
use crate::scene::{OptionValue, Options, Value, words};
use crate::solvers::common::coordinate_descent::{CoordinateDescent, collect, moduli};
use crate::solvers::common::interleaved_batch::InterleavedBatch;
use crate::solvers::prelude::*;

/// The error of a point in the objective: squared or absolute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Objective {
    /// `sum w (t - |P|)^2`, the paper's eq. (7).
    L2,
    /// `sum w |t - |P||`, which the authors' code minimises.
    L1,
}

/// The order in which the transducers are updated.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Order {
    /// A random permutation from the seed.
    Random,
    /// The order of the index: x fastest on a grid.
    Rows,
    /// The order by x, then y (to 1 um): column after column from the (-x, -y) corner, the paper's fixed order.
    Columns,
    /// The caller's permutation of 0..N.
    Given(Vec<u32>),
}

options! {
    /// Greedy search. Time O(K L M N) a sweep, memory O(N + M + K L). From a start drive each transducer's wave is exchanged for the
    /// best one whose phase is within `change` of the old.
    pub struct Greedy {
        /// Phase quantization L, 2 to 65536, or a divisor of the device's: phases are 2 pi l/L.
        pub phases: u32 = 16,
        /// Amplitude quantization K, 1 to 256: amplitudes are (k+1)/K or as many of the device's, never off.
        pub amplitudes: u32 = 1,
        /// Objective: "l2" (squared errors, the paper's text) or "l1" (its authors' code).
        pub objective: Objective = Objective::L2,
        /// Order of the updates: "random", "rows", "columns" or a permutation of 0..N.
        pub order: Order = Order::Random,
        /// Seed of the random order, 0 to 2^64 - 1.
        pub seed: u64 = 0,
        /// Largest change of a phase from a start drive, in rad, 0 or above; below 2 pi/phases no phase changes.
        pub change: f64 = core::f64::consts::PI,
        /// Number of passes over all transducers, 1 to 1000. From the second on, each one is chosen again in the field of all
        /// others.
        pub sweeps: u32 = 1,
    }
}

/// Largest default K: a device's longer table is thinned to the paper's 16 amplitudes, because K multiplies the time.
const AMPLITUDES: usize = 16;

words!(Objective: "l2" = Self::L2, "l1" = Self::L1);

impl OptionValue for Order {
    const WORDS: &'static [&'static str] = &["random", "rows", "columns"];
    const LIST: bool = true;

    fn read(item: &str, value: &Value) -> Result<Self> {
        if let Value::Integers(list) = value {
            let order = list.iter().map(|&i| u32::try_from(i)).collect::<Result<_, _>>();
            return order.map(Self::Given).map_err(|_| not_a_permutation(value));
        }
        let cure = "give \"random\", \"rows\", \"columns\" or a permutation of 0..N";
        let words = [("random", Self::Random), ("rows", Self::Rows), ("columns", Self::Columns)];
        let found = words.into_iter().find(|(word, _)| matches!(value, Value::Text(text) if same_name(word, text)));
        found.map(|(_, order)| order).ok_or_else(|| Error::invalid(item, value, cure))
    }

    fn show(&self) -> Value {
        match self {
            Self::Random => Value::Text("random".into()),
            Self::Rows => Value::Text("rows".into()),
            Self::Columns => Value::Text("columns".into()),
            Self::Given(order) => Value::Integers(order.iter().map(|&i| i64::from(i)).collect()),
        }
    }
}

fn not_a_permutation(value: &Value) -> Error {
    Error::invalid("order", value, "give each transducer's index once: a permutation of 0..N")
}

impl Order {
    /// Writes the order of all transducers to `out`, which contains 0..N.
    fn write(&self, seed: u64, positions: Option<&[[f64; 3]]>, out: &mut [u32]) -> Result<()> {
        match self {
            Self::Rows => {}
            Self::Random => Rng::new(seed).shuffle(out),
            Self::Columns => {
                let positions = positions.ok_or_else(|| {
                    Error::invalid(
                        "order",
                        "\"columns\"",
                        "a matrix has no positions: give them, or \"rows\", \"random\" or a permutation",
                    )
                })?;
                // The cast rounds: positions are far below 2^63 um. This function is called about N log N times.
                let micron = |x: f64| (x * 1e6 + 0.5_f64.copysign(x)) as i64;
                let key = |i: u32| positions[i as usize].map(micron);
                // Unstable sorting needs no memory; the index makes the order unique.
                out.sort_unstable_by(|&a, &b| {
                    let ([ax, ay, _], [bx, by, _]) = (key(a), key(b));
                    (ax, ay, a).cmp(&(bx, by, b))
                });
            }
            Self::Given(order) => {
                let fault = || not_a_permutation(&self.show());
                refuse_if!(order.len() != out.len(), fault());
                // Marks every index of the order in `out`, which still contains 0..N, before overwriting it.
                for &i in order {
                    match out.get_mut(i as usize) {
                        Some(mark) if *mark == i => *mark = u32::MAX,
                        _ => return Err(fault()),
                    }
                }
                out.copy_from_slice(order);
            }
        }
        Ok(())
    }
}

impl Method for Greedy {
    const INFO: Info = Info::new(
        "greedy",
        "greedy with brute-force search over phases and amplitudes",
        "Suzuki et al., IEEE Trans. Haptics 14(4), 2021, Algorithm 2",
    )
    .with_start()
    .within(0.02);

    fn device_defaults(quantization: &Quantization) -> Options {
        let phases = quantization.phases().map(|count| ("phases".into(), count.show()));
        let on = quantization.on().len().min(AMPLITUDES) as u32;
        let amplitudes = (on > 0).then(|| ("amplitudes".into(), on.show()));
        phases.into_iter().chain(amplitudes).collect()
    }

    fn check(&self) -> Result<()> {
        let sizes = [
            ("phases", self.phases, 2..=65_536),
            ("amplitudes", self.amplitudes, 1..=256),
            ("sweeps", self.sweeps, 1..=1000),
        ];
        for (item, value, range) in sizes {
            if !range.contains(&value) {
                let cure = format!("give {} to {}", range.start(), range.end());
                return Err(Error::out_of_range(item, value, cure));
            }
        }
        real("change", self.change, 0.0, false).map(|_| ())
    }
}

impl Greedy {
    /// Returns the transducers in the order of their updates, and the candidates of each.
    pub(crate) fn search<'w>(&self, problem: &Problem, work: &'w Workspace) -> Result<(Buffer<'w, u32>, Candidates)> {
        self.check()?;
        Ok((self.order(problem, work)?, self.candidates(problem, work)?))
    }

    /// Returns the indices of the transducers in the order of their updates.
    fn order<'w>(&self, problem: &Problem, work: &'w Workspace) -> Result<Buffer<'w, u32>> {
        let mut order = work.counting(problem.propagation().transducers());
        self.order.write(self.seed, problem.setup().positions.as_deref(), &mut order)?;
        Ok(order)
    }

    /// Returns the candidates on this problem's device.
    fn candidates(&self, problem: &Problem, work: &Workspace) -> Result<Candidates> {
        let (phases, amplitudes) = (self.phases as usize, self.amplitudes as usize);
        let on = problem.quantization().map(Quantization::on).unwrap_or_default();
        if let Some(known) = problem.quantization().and_then(Quantization::phases)
            && !known.is_multiple_of(self.phases)
        {
            let cure = format!("the device has {known} phases: give a number that divides it");
            return Err(Error::invalid("phases", self.phases, cure));
        }
        if !on.is_empty() && amplitudes > on.len() {
            let cure = format!("the device has {} amplitudes above 0: give at most as many", on.len());
            return Err(Error::out_of_range("amplitudes", self.amplitudes, cure));
        }
        // The amplitudes are evenly spaced in the table, and contain full drive.
        let value = |k: usize| match on {
            [] => (k as f64 + 1.0) / amplitudes as f64,
            table => table[((k + 1) * table.len()).div_ceil(amplitudes) - 1],
        };
        let buffers = [table(phases), table(phases), amplitudes].map(|len| work.floats.take(len).into_vec());
        Ok(Candidates::grid(phases, (0..amplitudes).map(value), buffers))
    }
}

impl Solve for Greedy {
    facts!(computes_rows = true);

    fn solve(&self, problem: &Problem, work: &mut Workspace, control: &mut Control) -> Result<Solution> {
        self.check()?;
        if problem.start_phases().is_some() {
            return Err(Error::invalid(
                "start",
                "point phases",
                "greedy goes on from a drive: give one value a transducer",
            ));
        }
        let propagation = problem.propagation();
        let (count, lanes) = (propagation.transducers(), propagation.lanes());
        let order = self.order(problem, work)?;
        let candidates = self.candidates(problem, work)?;
        if let Some(last) = problem.start_drive() {
            let descent = CoordinateDescent {
                candidates: &candidates,
                order: &order,
                change: self.change,
                sweeps: self.sweeps as usize,
            };
            let solution = match self.objective {
                Objective::L2 => descent.solve::<L2>(problem, last, work, control),
                Objective::L1 => descent.solve::<L1>(problem, last, work, control),
            };
            for buffer in candidates.into_buffers() {
                work.floats.give(buffer);
            }
            return solution;
        }
        let mut floats = work.floats.take(greedy::floats(candidates.phases));
        let mut indices = work.indices.take(greedy::indices(lanes, candidates.phases));
        let mut groups = work.points.take(lanes / LANES);
        let mut rows = work.floats.take(4 * lanes);
        let mut drive = work.complexes.take(count);
        let mut field = Planar::zeros(1, lanes, work);
        let pass = Pass {
            rows: problem.rows(),
            target: problem.targets(),
            weight: problem.weights(),
            count: propagation.points(),
            order: &order,
            groups: &mut groups,
            memory: &mut rows,
        };
        let search = Search { candidates: &candidates, floats: &mut floats, indices: &mut indices };
        let (mut status, all) = (Status::Done, self.sweeps as usize * count);
        let mut report = |updates: usize, points: &[PointGroup]| {
            let go = control.step(updates, all, || problem.residual_of(moduli(points))).is_continue();
            if !go {
                status = Status::Stopped;
            }
            go
        };
        let pressures = [&mut field.re[..], &mut field.im[..]];
        let (set, drives) = (propagation.instruction_set(), &mut drive[..]);
        let mut steps = match self.objective {
            Objective::L2 => greedy::pass::<L2>(set, pass, search, drives, pressures, &mut report),
            Objective::L1 => greedy::pass::<L1>(set, pass, search, drives, pressures, &mut report),
        };
        if self.sweeps > 1 && status == Status::Done {
            let sweeps = self.sweeps as usize - 1;
            let again = CoordinateDescent { candidates: &candidates, order: &order, change: self.change, sweeps };
            let whole = |_: usize| Some(PhaseRange::whole(candidates.phases));
            let steps_of = [steps, all];
            (status, steps) = match self.objective {
                Objective::L2 => again.sweep::<L2>(problem, &mut drive, &mut groups, whole, steps_of, work, control),
                Objective::L1 => again.sweep::<L1>(problem, &mut drive, &mut groups, whole, steps_of, work, control),
            };
            collect(&groups, &mut field);
        }
        for buffer in candidates.into_buffers() {
            work.floats.give(buffer);
        }
        // The candidates are on the device's grid.
        Ok(Solution::of_field(problem, drive.into_vec(), &field, status, steps, work, control)?.on_grid())
    }

    fn interleaved(&self) -> Option<&dyn Any> {
        Some(self)
    }

    fn bound(&self) -> Option<f64> {
        Some(self.change)
    }
}

impl Greedy {
    /// Solves several problems of one model at once, or returns `None` if that saves no work.
    pub(super) fn solve_interleaved(&self, problems: &[Problem], work: &mut Workspace) -> Option<Vec<Solution>> {
        self.check().ok()?;
        let first = problems.first()?;
        let fits = interleaved_pass::fits(self.phases as usize, self.amplitudes as usize);
        if self.objective != Objective::L2 || self.sweeps > 1 || !fits || problems.iter().any(Problem::has_start) {
            return None;
        }
        let mut batch = InterleavedBatch::of(problems, work)?;
        let candidates = self.candidates(first, work).ok()?;
        let order = self.order(first, work).ok()?;
        let lanes = batch.target.len();
        let mut floats = work.floats.take(interleaved_pass::floats(lanes, &candidates));
        let mut groups = work.points.take(lanes / LANES);
        let mut rows = work.floats.take(4 * lanes);
        let mut indices = work.indices.take(greedy::indices(LANES, candidates.phases));
        let pass = Pass {
            rows: batch.points.rows(),
            target: &batch.target,
            weight: &batch.weight,
            count: lanes,
            order: &order,
            groups: &mut groups,
            memory: &mut rows,
        };
        let search = Search { candidates: &candidates, floats: &mut floats, indices: &mut indices };
        let [re, im] = &mut batch.pressures;
        interleaved_pass::pass(batch.points.set, pass, search, problems.len(), &mut batch.drives, [re, im]);
        for buffer in candidates.into_buffers() {
            work.floats.give(buffer);
        }
        let steps = order.len();
        let solutions = batch.solutions(problems, steps, work)?;
        Some(solutions.into_iter().map(Solution::on_grid).collect())
    }
}
