//! The time of one call of a session, and of the slowest calls: 100,000 solves of moving points.
//!
//! `cargo bench -p midair --bench latency`. On an idle core the 99th percentile is only slightly above the median. Longer calls
//! are caused by the machine.

use std::time::Instant;

use midair::{
    Array, Control, InstructionSet, Medium, Model, Options, Request, Rng, Session, SolveRequest, Transducer, solvers,
};

/// Returns the time of each of `calls` solves in nanoseconds.
fn measured(tiles: [usize; 2], points: usize, name: &str, calls: usize) -> Vec<u64> {
    let array = Array::preset("autd3", tiles).expect("boards").with_quantization(None);
    let array = array.with_transducer(Transducer::default()).expect("point sources");
    let model = Model::new(&array, Medium::default(), InstructionSet::best()).expect("an array");
    let configured = solvers::find(name).and_then(|entry| entry.configure(&Options::new())).expect("a method");
    let mut session = Session::new(model, configured.solver, configured.info.balance);
    let request = Request { pressures: Some(vec![500.0; points]), ..Request::default() };
    let mut rng = Rng::new(points as u64);
    let points = (0..points).map(|_| [0.1 * rng.uniform() - 0.05, 0.1 * rng.uniform() - 0.05, 0.15]).collect();
    let mut ask = SolveRequest { points, request, ..SolveRequest::default() };
    let mut times = Vec::with_capacity(calls);
    for call in 0..calls + 100 {
        for point in &mut ask.points {
            // Up to half a millimetre in each call: a hand moves at 0.5 m/s with 1000 calls per second.
            point[0] += 1e-3 * (rng.uniform() - 0.5);
        }
        let start = Instant::now();
        let solution = session.solve(&ask, &mut Control::none()).expect("an answer");
        let took = start.elapsed().as_nanos() as u64;
        assert!(solution.drive.iter().all(|q| q.norm() < 1.0 + 1e-6));
        if call >= 100 {
            times.push(took);
        }
    }
    times.sort_unstable();
    times
}

fn main() {
    let calls = if std::env::args().any(|argument| argument == "--bench") { 100_000 } else { 10 };
    println!("{:8} {:>5} {:>3} {:>9} {:>9} {:>9} us", "method", "N", "M", "p50", "p99", "p99.9");
    for name in ["fast", "greedy", "uniform"] {
        for (tiles, transducers) in [([1, 1], 249), ([2, 2], 996)] {
            for points in [4, 16] {
                let times = measured(tiles, points, name, calls);
                let part = |share: f64| times[((times.len() - 1) as f64 * share) as usize] as f64 / 1e3;
                println!(
                    "{name:8} {transducers:>5} {points:>3} {:9.1} {:9.1} {:9.1}",
                    part(0.5),
                    part(0.99),
                    part(0.999)
                );
            }
        }
    }
}
