//! Speed as ratios from one run: results are checked first, then the variants alternate in rounds, and medians are compared.
//!
//! `cargo bench -p midair --features parallel --bench side_by_side`. CPU frequency and other programs slow all variants alike,
//! so only the ratio counts. "textbook" is a direct implementation of Algorithm 2 of Suzuki et al. 2021. It uses complex f64,
//! computes |P + G q| as the complex modulus and each candidate's energy anew. Its G of eq. (5) is computed with the same libm
//! as ours.

use std::hint::black_box;
use std::time::{Duration, Instant};

use midair::solvers;
use midair::{
    Array, Complex32, Complex64, Control, InstructionSet, Medium, Metrics, Model, Options, Plane, Precision, Problem,
    Propagation, Request, Rng, Scene, Setup, Transducer, Value, Workspace,
};

/// A measurement takes at least this long: the work is repeated.
const LEAST: Duration = Duration::from_micros(1500);

/// Work that is repeated a given number of times.
type Side<'a> = Box<dyn FnMut(usize) + 'a>;

fn side<'a, T>(mut work: impl FnMut() -> T + 'a) -> Side<'a> {
    Box::new(move |times| (0..times).for_each(|_| drop(black_box(work()))))
}

fn timed(side: &mut Side<'_>, times: usize) -> Duration {
    let start = Instant::now();
    side(times);
    start.elapsed()
}

/// Returns the median time of the work of each side, over rounds in which all sides alternate.
fn medians(sides: &mut [Side<'_>], rounds: usize) -> Vec<Duration> {
    let enough = |side: &mut Side<'_>| (LEAST.as_nanos() / timed(side, 2).as_nanos().max(1) * 2).max(1) as usize;
    let counts: Vec<usize> = sides.iter_mut().map(enough).collect();
    let mut times = vec![Vec::new(); sides.len()];
    for round in 0..rounds {
        for k in 0..sides.len() {
            let k = (k + round) % sides.len();
            times[k].push(timed(&mut sides[k], counts[k]) / counts[k] as u32);
        }
    }
    let median = |mut times: Vec<Duration>| {
        times.sort_unstable();
        times[rounds / 2]
    };
    times.into_iter().map(median).collect()
}

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
        field();
    } else {
        against_the_textbook(&grid(4), 2, 1);
    }
}
