//! Compares boards with quantization to unlimited drives, and real transducers to point sources: ratios from one run, also for
//! the few points on a hand. Then the slowest of 100,000 calls with points that move like a hand.
//!
//! `cargo bench -p midair --features parallel --bench boards`. Measures session calls with moving points and batches of 1024,
//! on one thread, N = 996. Results are checked first; then all variants alternate, and their medians are compared. On an idle
//! core the 99th percentile of calls is only slightly above the median; longer calls are caused by the machine.

mod turns;

use std::hint::black_box;
use std::time::{Duration, Instant};

use midair::{
    Array, Complex32, Control, Directivity, InstructionSet, Medium, Metrics, Model, Options, Quantization, Request,
    Rng, Session, SolveRequest, Threads, Transducer, Value, solvers,
};
use turns::{Side, medians, side};

/// The number of scenes that a session solves in turn.
const SCENES: usize = 8;

/// A method with a label for the table.
struct Method {
    label: &'static str,
    name: &'static str,
    options: &'static [(&'static str, i128)],
}

const FAST: Method = Method { label: "fast", name: "fast", options: &[] };
const UNIFORM: Method = Method { label: "uniform", name: "uniform", options: &[] };

/// Returns greedy with fixed options, so that it makes the same search for any board.
const fn greedy(label: &'static str, options: &'static [(&'static str, i128)]) -> Method {
    Method { label, name: "greedy", options }
}

const GREEDY_16: Method = greedy("greedy, 16 phases", &[("phases", 16), ("amplitudes", 1)]);
const GREEDY_32: Method = greedy("greedy, 32 phases", &[("phases", 32), ("amplitudes", 1)]);
const GREEDY_256: Method = greedy("greedy, 256 phases", &[("phases", 256), ("amplitudes", 1)]);

impl Method {
    fn session(&self, array: &Array) -> Session {
        let model = Model::new(array, Medium::default(), InstructionSet::best()).expect("an array");
        let options: Options = self.options.iter().map(|&(name, value)| (name.into(), Value::Integer(value))).collect();
        let made = solvers::find(self.name).and_then(|entry| entry.configure_for(&options, array.quantization()));
        let made = made.expect("a method");
        Session::new(model, made.solver, made.info.balance)
    }
}

/// Returns scenes of this many points in a square of 100 mm at a height of 200 mm, with the aim of the highest level.
fn scenes(count: usize, points: usize) -> Vec<SolveRequest> {
    let mut rng = Rng::new(points as u64);
    let mut coordinate = || 0.1 * rng.uniform() - 0.05;
    let mut scene = || (0..points).map(|_| [coordinate(), coordinate(), 0.2]).collect();
    (0..count).map(|_| SolveRequest { points: scene(), ..SolveRequest::default() }).collect()
}

/// Returns the metrics of the first scene. Checks that the drive is one that the board can play.
fn checked(session: &mut Session, array: &Array, ask: &SolveRequest) -> Metrics {
    let solution = session.solve(ask, &mut Control::none()).expect("an answer");
    if let Some(quantization) = array.quantization() {
        assert!(solution.drive.iter().all(|&q| quantization.nearest(q) == q), "not on the grid");
    }
    solution.metrics()
}

/// Returns the times of single calls: for the first array in us, for the others relative to the first.
fn calls(arrays: &[Array], method: &Method, points: usize, rounds: usize) -> Vec<f64> {
    let scenes = scenes(SCENES, points);
    let mut sessions: Vec<Session> = arrays.iter().map(|array| method.session(array)).collect();
    let pairs = sessions.iter_mut().zip(arrays);
    let metrics: Vec<Metrics> = pairs.map(|(session, array)| checked(session, array, &scenes[0])).collect();
    // Rounding to 16 phases loses 2 % of the pressure, and in an uneven field it may lose more.
    assert!(metrics.iter().all(|m| m.accuracy > 0.8 * metrics[0].accuracy), "{}: {metrics:?}", method.label);
    let call = |mut session: Session| -> Side<'_> {
        let (scenes, mut next) = (&scenes, 0);
        side(move || {
            black_box(session.solve(&scenes[next % SCENES], &mut Control::none()).expect("an answer"));
            next += 1;
        })
    };
    over_first(&mut sessions.into_iter().map(call).collect::<Vec<_>>(), 1, rounds)
}

/// Returns the times of one problem of a batch: for the first array in us, for the others relative to the first.
fn batches(arrays: &[Array], method: &Method, (count, points): (usize, usize), rounds: usize) -> Vec<f64> {
    let scenes = scenes(count, points);
    let ask = |k: usize, ask: &mut SolveRequest| {
        ask.points.clone_from(&scenes[k].points);
        Ok(())
    };
    let batch = |array: &Array| -> Side<'_> {
        let (mut session, mut drives) = (method.session(array), vec![Complex32::ZERO; count * array.len()]);
        let ask = &ask;
        side(move || {
            let control = &mut Control::none().on(Threads::default().at_most(1));
            black_box(session.solve_batch(count, points, ask, &mut drives, control).expect("answers"));
        })
    };
    over_first(&mut arrays.iter().map(batch).collect::<Vec<_>>(), count, rounds)
}

fn over_first(sides: &mut [Side<'_>], count: usize, rounds: usize) -> Vec<f64> {
    let times: Vec<f64> = medians(sides, rounds).iter().map(Duration::as_secs_f64).collect();
    let first = times[0];
    times.iter().enumerate().map(|(k, time)| if k == 0 { time * 1e6 / count as f64 } else { time / first }).collect()
}

/// Prints a table: one row for each method, one group of columns for each number of points.
fn table(title: &str, methods: &[&Method], points: &[usize], cells: impl Fn(&Method, usize) -> Vec<f64>) {
    println!("\n{title}");
    for method in methods {
        print!("{:19}", method.label);
        for &points in points {
            let cells = cells(method, points);
            print!("| {:7.1}", cells[0]);
            cells[1..].iter().for_each(|ratio| print!(" {ratio:5.2}"));
            print!(" ");
        }
        println!();
    }
}

/// Returns the sorted times in us of `calls` solves of points at 500 Pa, each of which moves by up to half a millimetre between
/// calls: a hand moves at 0.5 m/s with 1000 calls per second.
fn latencies(array: &Array, method: &Method, points: usize, calls: usize) -> Vec<f64> {
    let (mut session, mut ask, mut rng) = (method.session(array), scenes(1, points).remove(0), Rng::new(0));
    ask.request = Request { pressures: Some(vec![500.0; points]), ..Request::default() };
    let mut call = || {
        ask.points.iter_mut().for_each(|point| point[0] += 1e-3 * (rng.uniform() - 0.5));
        let start = Instant::now();
        let solution = session.solve(&ask, &mut Control::none()).expect("an answer");
        let took = start.elapsed().as_secs_f64() * 1e6;
        assert!(solution.drive.iter().all(|q| q.norm() < 1.0 + 1e-6));
        took
    };
    let mut times: Vec<f64> = (0..calls + 100).map(|_| call()).skip(100).collect();
    times.sort_by(f64::total_cmp);
    times
}

fn main() {
    // `cargo test` runs benches too, without this argument; a short run is then enough.
    let full = std::env::args().any(|argument| argument == "--bench");
    let (tiles, rounds, few) = if full { ([2, 2], 15, 5) } else { ([1, 1], 1, 1) };
    let (hand, count) = if full { (&[1, 4, 8, 16, 64][..], 1024) } else { (&[3][..], 20) };
    let (some, one_group) = if full { (&[4, 16, 64][..], &[4, 16][..]) } else { (&[3][..], &[3][..]) };
    let board = Array::preset("autd3", tiles).expect("boards");
    let board = board.with_transducer(Transducer::default()).expect("point sources");
    let free = board.clone().with_quantization(None);
    let coarse = Quantization::new(Some(32), Some(vec![0.0, 1.0])).expect("a grid");
    let coarse = free.clone().with_quantization(Some(coarse));
    let heading = |what: &str, points: &[usize]| format!("{what}, N = {}, M = {points:?}", free.len());
    for (name, grid, greedy) in [("256 x 256", board, GREEDY_256), ("32 phases, on/off", coarse, GREEDY_32)] {
        let (arrays, methods) = ([free.clone(), grid], [&FAST, &GREEDY_16, &greedy, &UNIFORM]);
        let title = heading(&format!("any drive in us, then how many times that with {name}"), hand);
        table(&title, &methods, hand, |method, points| calls(&arrays, method, points, rounds));
        let title = heading(&format!("the same, a problem of a batch of {count}"), one_group);
        table(&title, &methods, one_group, |method, points| batches(&arrays, method, (count, points), few));
    }

    let radiates = |name| {
        let directivity = Directivity::named(name, None).expect("a directivity");
        free.clone().with_transducer(Transducer { directivity, ..free.transducer() }).expect("a transducer")
    };
    let real = ["piston", "sinc", "cos", "t4010a1"];
    let beams: Vec<Array> = [free.clone()].into_iter().chain(real.map(radiates)).collect();
    let title = heading("point sources in us, then how many times that with piston, sinc, cos and t4010a1", some);
    table(&title, &[&FAST, &GREEDY_16, &UNIFORM], some, |method, points| calls(&beams, method, points, rounds));
    let (calls, pair) = if full { (100_000, &[4, 16][..]) } else { (10, &[3][..]) };
    let title = heading("median of a call in us, then how many times that in 1 of 100 and of 1000 calls", pair);
    table(&title, &[&FAST, &GREEDY_16, &UNIFORM], pair, |method, points| {
        let times = latencies(&free, method, points, calls);
        let part = |share: f64| times[((times.len() - 1) as f64 * share) as usize];
        vec![part(0.5), part(0.99) / part(0.5), part(0.999) / part(0.5)]
    });
}
