//! Speed as ratios from one run: results are checked first, then the variants alternate in rounds, and medians are compared.
//!
//! `cargo bench -p midair --features parallel --bench side_by_side`. CPU frequency and other programs slow all variants alike,
//! so only the ratio counts. "textbook" is a direct implementation of Algorithm 2 of Suzuki et al. 2021. It uses complex f64,
//! computes |P + G q| as the complex modulus and each candidate's energy anew. Its G of eq. (5) is computed with the same libm
//! as ours.

mod turns;

use std::hint::black_box;
use std::sync::Arc;

use midair::solvers;
use midair::{
    Array, Complex32, Complex64, Control, InstructionSet, Medium, Metrics, Model, Options, Plane, Precision, Problem,
    Propagation, Request, Rng, Scene, Session, Setup, SolveRequest, Transducer, Value, Workspace,
};
use turns::{Side, medians, side};

/// Algorithm 2 of Suzuki et al. 2021, implemented directly.
fn textbook(scene: &Scene, targets: &[f64], phases: usize, order: &[u32]) -> Vec<Complex64> {
    let positions = scene.array().positions();
    let (strength, k) = (scene.array().transducer().source_pressure, scene.medium().wavenumber());
    let mut drive = vec![Complex64::ZERO; positions.len()];
    let mut field = vec![Complex64::ZERO; targets.len()];
    for &i in order {
        let from = positions[i as usize];
        let gain = |to: &[f64; 3]| {
            let r = (0..3).map(|axis| (to[axis] - from[axis]).powi(2)).sum::<f64>().sqrt();
            Complex64::from_polar(strength / r, k * r)
        };
        let row: Vec<Complex64> = scene.points().iter().map(gain).collect();
        let mut best = (f64::INFINITY, Complex64::ZERO);
        for l in 0..phases {
            let q = Complex64::cis(std::f64::consts::TAU * l as f64 / phases as f64);
            let mut energy = 0.0;
            for j in 0..targets.len() {
                let miss = targets[j] - (field[j] + row[j] * q).norm();
                energy += miss * miss;
            }
            if energy < best.0 {
                best = (energy, q);
            }
        }
        drive[i as usize] = best.1;
        for (p, g) in field.iter_mut().zip(row) {
            *p += g * best.1;
        }
    }
    drive
}

/// Points in a square of 200 mm, all with the target p1/sqrt(M); p1 is the pressure of all transducers at (0, 0, 150 mm).
fn scene(array: Array, count: usize) -> Scene {
    let mut rng = Rng::new(count as u64);
    let mut coordinate = || (2.0 * rng.uniform() - 1.0) * 0.1;
    let points = (0..count).map(|_| [coordinate(), coordinate(), 0.15]).collect();
    let focus = Scene::new(array.clone(), Medium::default(), vec![[0.0, 0.0, 0.15]], Request::default());
    let p1 = Problem::new(&focus.expect("a focus")).expect("a problem").targets_in_pascals()[0];
    let pressures = Some(vec![p1 / (count as f64).sqrt(); count]);
    Scene::new(array, Medium::default(), points, Request { pressures, ..Request::default() }).expect("a scene")
}

/// One of our methods, with its options and its instruction set.
struct Entrant {
    name: String,
    set: InstructionSet,
    configured: solvers::Configured,
}

impl Entrant {
    fn new(label: &str, name: &str, options: &[(&str, i128)], order: &[u32], set: InstructionSet) -> Self {
        let mut table: Options = options.iter().map(|&(name, value)| (name.into(), Value::Integer(value))).collect();
        if name == "greedy" {
            table.insert("order".into(), Value::Integers(order.iter().map(|&i| i.into()).collect()));
        }
        let configured = solvers::find(name).and_then(|entry| entry.configure(&table)).expect("a method");
        Self { name: format!("{label} at {set}"), set, configured }
    }

    /// Solves a scene, including G and the targets.
    fn solve(&self, scene: &Scene, work: &mut Workspace) -> Metrics {
        let propagation = Propagation::of(scene).with_instruction_set(self.set);
        let problem = Problem::with_propagation(propagation, Setup::of(scene.array(), scene.medium()), scene.request())
            .expect("a problem");
        let solution =
            midair::solve(&problem, &*self.configured.solver, false, work, &mut Control::none()).expect("a solution");
        let metrics = solution.metrics();
        solution.recycle(work);
        metrics
    }

    /// The same, measured with a workspace of its own.
    fn side<'a>(&'a self, scene: &'a Scene) -> Side<'a> {
        let mut work = Workspace::new();
        side(move || self.solve(scene, &mut work))
    }
}

/// Compares greedy and `fast`, for each instruction set, with the textbook implementation.
fn against_the_textbook(array: &Array, points: usize, rounds: usize) {
    let scene = scene(array.clone(), points);
    let count = array.len();
    let order = Rng::new(0).permutation(count as u32);
    let targets = Problem::new(&scene).expect("a problem").targets_in_pascals().to_vec();
    let mut entrants = Vec::new();
    for set in InstructionSet::all() {
        let plain = [("phases", 16), ("amplitudes", 1)];
        entrants.push(Entrant::new("greedy K=1 L=16", "greedy", &plain, &order, set));
        let fine = [("phases", 256), ("amplitudes", 16)];
        entrants.push(Entrant::new("greedy K=16 L=256", "greedy", &fine, &order, set));
        entrants.push(Entrant::new("fast", "fast", &[], &order, set));
        entrants.push(Entrant::new("uniform", "uniform", &[], &order, set));
    }
    let book = || textbook(&scene, &targets, 16, &order);
    let drive: Vec<Complex32> = book().iter().map(|q| Complex32::new(q.re as f32, q.im as f32)).collect();
    let theirs = Problem::new(&scene)
        .expect("a problem")
        .judge(&drive, Precision::Double, &mut Control::none())
        .expect("a drive");
    let mut work = Workspace::new();
    for entrant in &entrants {
        let ours = entrant.solve(&scene, &mut work);
        // Greedy makes the same choices except for near-ties. The accuracy of the other methods is at most 0.08 lower.
        let same = entrant.name.starts_with("greedy K=1 ");
        let apart = ours.accuracy - theirs.accuracy;
        assert!(if same { apart.abs() < 1e-2 } else { apart > -0.08 }, "{}: {ours:?} for {theirs:?}", entrant.name);
    }
    let mut sides = vec![side(book)];
    sides.extend(entrants.iter().map(|entrant| entrant.side(&scene)));
    let mut medians = medians(&mut sides, rounds).into_iter();
    let book = medians.next().expect("the textbook");
    println!("N={count} M={points}: textbook f64 {book:.2?}");
    for (entrant, time) in entrants.iter().zip(medians) {
        let each = time.as_secs_f64() * 1e9 / (count * points) as f64;
        let ratio = book.as_secs_f64() / time.as_secs_f64();
        println!("  {:28} {time:>9.2?}  {each:7.3} ns a transducer and point  {ratio:6.1} times", entrant.name);
    }
}

/// Compares greedy's search among 4096 candidates with that among 16.
fn many_candidates(array: &Array, points: usize, rounds: usize) {
    let scene = scene(array.clone(), points);
    let order = Rng::new(0).permutation(array.len() as u32);
    let greedy = |phases, amplitudes| {
        Entrant::new("", "greedy", &[("phases", phases), ("amplitudes", amplitudes)], &order, InstructionSet::best())
    };
    let entrants = [greedy(16, 1), greedy(256, 16)];
    let mut work = Workspace::new();
    let [few, many] = entrants.each_ref().map(|entrant| entrant.solve(&scene, &mut work).residual);
    assert!(many < 1.2 * few, "a finer grid serves no worse: {many} for {few}");
    let medians = medians(&mut entrants.each_ref().map(|entrant| entrant.side(&scene)), rounds);
    let (few, many) = (medians[0], medians[1]);
    let ratio = many.as_secs_f64() / few.as_secs_f64();
    println!("greedy N={} M={points}: K=16 L=256 {many:.2?}, {ratio:.2} times K=1 L=16, {few:.2?}", array.len());
}

/// Compares a batch on one thread with a loop of single solves; both make each problem anew.
fn batch(array: &Array, name: &str, points: usize, count: usize, rounds: usize) {
    let model = Model::new(array, Medium::default(), InstructionSet::best()).expect("an array with a medium");
    let mut rng = Rng::new(points as u64);
    let mut coordinate = || (2.0 * rng.uniform() - 1.0) * 0.1;
    let places: Vec<Vec<[f64; 3]>> =
        (0..count).map(|_| (0..points).map(|_| [coordinate(), coordinate(), 0.15]).collect()).collect();
    let setup = Arc::new(Setup::of(array, Medium::default()));
    let problem =
        |k: usize| Problem::with_propagation(model.propagation(&places[k])?, Arc::clone(&setup), &Request::default());
    let solver = solvers::find(name).and_then(|entry| entry.configure(&Options::new())).expect("a method");
    let balance = solver.info.balance;
    let mut work = Workspace::new();
    let mut single = |out: &mut [Complex32]| {
        for (k, out) in out.chunks_mut(array.len()).enumerate() {
            let problem = problem(k).expect("a problem");
            let solution =
                midair::solve(&problem, &*solver.solver, balance, &mut work, &mut Control::none()).expect("a solution");
            out.copy_from_slice(&solution.drive);
            black_box(solution.metrics());
            solution.recycle(&work);
        }
    };
    let ask = |k: usize, ask: &mut SolveRequest| {
        ask.points.clone_from(&places[k]);
        Ok(())
    };
    let same = solvers::find(name).and_then(|entry| entry.configure(&Options::new())).expect("a method");
    let mut session = Session::new(model.clone(), same.solver, balance);
    let mut together =
        |out: &mut [Complex32]| session.solve_batch(count, points, &ask, out, &mut Control::none()).expect("answers");
    let mut drives = [(); 2].map(|()| vec![Complex32::ZERO; count * array.len()]);
    single(&mut drives[0]);
    together(&mut drives[1]);
    assert_eq!(drives[0], drives[1], "a batch is single solves");
    let [first, second] = &mut drives;
    let make = side(|| (0..count).for_each(|k| drop(black_box(problem(k)))));
    let sides = &mut [make, side(|| single(first)), side(|| together(second))];
    let each: Vec<_> = medians(sides, rounds).iter().map(|&time| time / count as u32).collect();
    let (made, single, together) = (each[0], each[1], each[2]);
    println!(
        "batch of {count}, {name}, N={} M={points}, one problem: alone {single:.2?}, together {together:.2?} ({:.2} times); \
         making it is {made:.2?} of both",
        array.len(),
        single.as_secs_f64() / together.as_secs_f64()
    );
}

/// Measures a field of 500 x 500 pixels.
fn field() {
    let scene = scene(Array::grid(36, 36, 10e-3).expect("a grid"), 38);
    let drive = vec![Complex32::ONE; scene.array().len()];
    let pixels = Plane::new(0.15, 0.1, 500, [0.0, 0.0]).expect("a plane").points();
    let draw = || {
        midair::field(&Model::of(&scene, InstructionSet::best()), &drive, &pixels, &mut Control::none())
            .expect("a field")
    };
    let time = medians(&mut [side(draw)], 3)[0];
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    println!("field 500 x 500 from 1296 transducers on {threads} threads: {time:.2?}");
}

fn main() {
    let grid = |side| Array::grid(side, side, 10e-3).expect("a grid");
    // `cargo test` runs benches too, without this argument; a short run is then enough.
    if std::env::args().any(|argument| argument == "--bench") {
        for points in [4, 16, 64] {
            against_the_textbook(&grid(20), points, 15);
        }
        let boards = Array::preset("autd3", [2, 2]).expect("boards").with_quantization(None);
        let boards = boards.with_transducer(Transducer::default()).expect("point sources");
        against_the_textbook(&boards, 64, 9);
        against_the_textbook(&grid(36), 38, 9);
        for (array, points) in [&grid(20), &boards].into_iter().flat_map(|a| [32, 64, 128, 256].map(|m| (a, m))) {
            many_candidates(array, points, 31);
        }
        for (name, points) in [("greedy", 4), ("greedy", 16), ("fast", 4), ("fast", 16)] {
            batch(&grid(20), name, points, 1024, 9);
        }
        field();
    } else {
        against_the_textbook(&grid(4), 2, 1);
        many_candidates(&grid(4), 2, 1);
        batch(&grid(4), "greedy", 2, 20, 1);
        batch(&grid(4), "fast", 2, 20, 1);
    }
}
