//! Tests of matrices over many orders of magnitude: every solver gives finite drives that can be played, and that are no worse
//! than usual.

use midair::solvers::SOLVERS;
use midair::{
    Complex32, Complex64, Control, Error, Metrics, Options, Problem, Propagation, Request, Rng, Session, Setup,
    Solution, Solve, SolveRequest, Workspace,
};

const POINTS: usize = 4;
const TRANSDUCERS: usize = 24;

/// Entries (M, N) with moduli around 1.
fn entries() -> Vec<Complex64> {
    let mut rng = Rng::new(7);
    let mut part = || 2.0 * rng.uniform() - 1.0;
    (0..POINTS * TRANSDUCERS).map(|_| Complex64::new(part(), part())).collect()
}

/// Multiplies each entry by a factor that depends on its row and column.
fn spread(factor: impl Fn(usize, usize) -> f64) -> Vec<Complex64> {
    let scaled = |(k, g): (usize, &Complex64)| g * factor(k / TRANSDUCERS, k % TRANSDUCERS);
    entries().iter().enumerate().map(scaled).collect()
}

fn problem(matrix: &[Complex64], pressures: Option<Vec<f64>>) -> Result<Problem, Error> {
    let propagation = Propagation::from_matrix(matrix, POINTS)?;
    Problem::with_propagation(propagation, Setup::default(), &Request { pressures, ..Request::default() })
}

fn reach(matrix: &[Complex64]) -> Vec<f64> {
    matrix.chunks(TRANSDUCERS).map(|row| row.iter().map(|g| g.norm()).sum()).collect()
}

fn solved(problem: &Problem, solver: &dyn Solve) -> Solution {
    midair::solve(problem, solver, false, &mut Workspace::new(), &mut Control::none()).expect("an answer")
}

fn is_finite(metrics: Metrics) -> bool {
    let Metrics { accuracy, sigma, uniformity, level, residual, leak } = metrics;
    [accuracy, sigma, uniformity, level, residual, leak].iter().all(|x| x.is_finite())
}

#[test]
fn no_spread_of_a_matrix_or_its_targets_makes_an_answer_unfit() {
    let row = |j: usize, low: f64| if j == 2 { low } else { 1.0 };
    let power = |e: f64| 10f64.powf(e);
    let far = |j: usize, i: usize| ((j * 7 + i * 5) % 13) as f64 / 6.0 - 1.0;
    let matrices: Vec<(&str, Vec<Complex64>)> = vec![
        ("rows over 24 orders", spread(|j, _| power(24.0 * j as f64 / 3.0 - 24.0))),
        ("a row of 1e-20", spread(|j, _| row(j, 1e-20))),
        ("a row of 1e-29", spread(|j, _| row(j, 1e-29))),
        ("a row of 1e-310", spread(|j, _| row(j, 1e-310))),
        ("a zero row", spread(|j, _| row(j, 0.0))),
        ("columns over 48 orders", spread(|_, i| power(-2.0 * i as f64))),
        ("entries over 24 orders", spread(|j, i| power(12.0 * far(j, i) - 12.0))),
        ("entries over 200 orders", spread(|j, i| power(100.0 * far(j, i) - 100.0))),
        ("a zero column", spread(|_, i| if i == 3 { 0.0 } else { 1.0 })),
        ("tiny", spread(|_, _| 1e-14)),
        ("huge", spread(|_, _| 1e14)),
        ("rank one", entries()[..TRANSDUCERS].repeat(POINTS)),
    ];
    for (name, matrix) in &matrices {
        let reach = reach(matrix);
        let most = reach.iter().copied().fold(0.0, f64::max);
        let requested = |part: f64| Some(reach.iter().map(|reach| part * reach).collect());
        let equal = Some(reach.iter().map(|&reach| if reach > 0.0 { 0.3 * most } else { 0.0 }).collect());
        let quiet = Some((0..POINTS).map(|j| if j == 2 { 0.0 } else { 0.3 * reach[j] }).collect());
        for (kind, pressures) in [
            ("left out", None),
            ("equal", equal),
            ("quiet", quiet),
            ("all", requested(0.4)),
            ("weak", requested(1e-12)),
        ] {
            // A point that no transducer reaches is an error.
            let Ok(problem) = problem(matrix, pressures) else { continue };
            assert!(problem.targets_in_pascals().iter().all(|target| target.is_finite()), "{name}, {kind}");
            for entry in SOLVERS {
                let solver = entry.configure(&Options::new()).expect("defaults").solver;
                let solution = solved(&problem, &*solver);
                let name = format!("{}: {name}, {kind}", entry.info.name);
                assert!(solution.drive.iter().all(|q| q.norm() <= 1.0 + 1e-6), "{name}: not a drive");
                assert!(solution.drive.iter().any(|q| q.norm() > 0.0), "{name}: silence");
                assert!(is_finite(solution.metrics()), "{name}: {:?}", solution.metrics());
            }
        }
    }
}

#[test]
fn rows_in_other_units_are_solved_as_well_as_in_one() {
    // Three of the four rows are outside of the range in which squares fit into f32; one is at its edge.
    let units = [1e-22, 1e-12, 1.0, 1e-17];
    let (plain, spread) = (entries(), spread(|j, _| units[j]));
    let targets = |matrix: &[Complex64]| Some(reach(matrix).iter().map(|reach| 0.3 * reach).collect());
    let (plain, spread) = (problem(&plain, targets(&plain)), problem(&spread, targets(&spread)));
    let (plain, spread) = (plain.expect("a problem"), spread.expect("a problem"));
    for name in ["gspat", "uniform", "best", "wgs", "lm", "naive"] {
        let solver = midair::solvers::find(name).and_then(|entry| entry.configure(&Options::new())).expect("listed");
        let misses = [&plain, &spread].map(|problem| {
            let solution = solved(problem, &*solver.solver);
            let ratios = solution.pressures.iter().zip(solution.targets());
            ratios.map(|(p, target)| (f64::from(p.norm()) / target - 1.0).abs()).fold(0.0, f64::max)
        });
        // A row is only rescaled by a power of two, so its last digits and its weight are different, and the results are not
        // the same.
        assert!(misses[1] <= misses[0].mul_add(1.5, 0.1), "{name}: {misses:?}");
    }
}

/// A solver whose drives are all `q`.
struct Stuck(Complex32);

impl Solve for Stuck {
    fn solve(&self, problem: &Problem, work: &mut Workspace, control: &mut Control) -> Result<Solution, Error> {
        let drive = vec![self.0; problem.propagation().transducers()];
        Solution::new(problem, drive, (midair::Status::Done, 1), 1, work, control)
    }
}

#[test]
fn a_drive_that_cannot_be_played_never_comes_out() {
    let matrix = entries();
    for (q, said) in [
        (Complex32::new(f32::NAN, 0.0), "drive is not finite: "),
        (Complex32::new(0.0, f32::INFINITY), "drive is not finite: "),
        (Complex32::new(0.8, 0.8), "drive[0] is 0.8+0.8i: "),
    ] {
        let problem = problem(&matrix, None).expect("a problem");
        let alone = midair::solve(&problem, &Stuck(q), false, &mut Workspace::new(), &mut Control::none());
        let alone = alone.map(|_| ()).expect_err("refused").to_string();
        assert!(alone.starts_with(said) && !alone.contains('\n'), "{alone}");
        let propagation = Propagation::from_matrix(&matrix, POINTS).expect("a matrix");
        let stuck: Box<dyn Solve + Send + Sync> = Box::new(Stuck(q));
        let session = Session::with_propagation(propagation, Setup::default(), stuck, false);
        let mut session = session.expect("a session");
        let mut drives = vec![Complex32::ZERO; 2 * TRANSDUCERS];
        let ask = |_: usize, _: &mut SolveRequest| Ok(());
        let batch = session.solve_batch(2, POINTS, &ask, &mut drives, &mut Control::none().with_threads(3));
        let batch = batch.map(|_| ()).expect_err("refused").to_string();
        assert!(batch.starts_with("problems[0]: drive"), "{batch}");
        assert!(drives.iter().all(|q| *q == Complex32::ZERO));
    }
}
