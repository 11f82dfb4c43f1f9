//! Speed as ratios in one run: the answer is checked first, then rounds alternate, and medians are compared.
//!
//! `cargo bench -p midair --features parallel`. CPU frequency and neighbours move both sides alike; the ratio is
//! what counts. "textbook" is Algorithm 2 as one writes it down: complex f64, |P + G q| by the complex modulus,
//! energies summed anew for each candidate, G precomputed. Ours reads a stored G here, too.

use std::hint::black_box;
use std::time::{Duration, Instant};

use midair::solvers::{Greedy, Order};
use midair::{
    Array, Complex32, Complex64, Control, Gains, Medium, Plane, Problem, Request, Rng, Scene, Solve,
    Workspace,
};

/// Algorithm 2, by the book.
fn textbook(gains: &[Vec<Complex64>], targets: &[f64], phases: usize, order: &[u32]) -> Vec<Complex64> {
    let mut drive = vec![Complex64::ZERO; gains.len()];
    let mut field = vec![Complex64::ZERO; targets.len()];
    for &i in order {
        let row = &gains[i as usize];
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

fn median(mut times: Vec<Duration>) -> Duration {
    times.sort_unstable();
    times[times.len() / 2]
}

fn timed<T>(work: impl FnOnce() -> T) -> Duration {
    let start = Instant::now();
    black_box(work());
    start.elapsed()
}

fn scene(side: usize, points: usize) -> Scene {
    let mut rng = Rng::new(points as u64);
    let half = side as f64 * 5e-3;
    let mut coordinate = || (2.0 * rng.uniform() - 1.0) * half;
    let points = (0..points).map(|_| [coordinate(), coordinate(), 0.15]).collect();
    let array = Array::grid(side, side, 10e-3).expect("a grid");
    Scene::new(array, Medium::default(), points, Request::default()).expect("a scene")
}

/// Greedy, K = 1, against the textbook.
fn greedy(side: usize, points: usize, phases: usize) {
    let scene = scene(side, points);
    let (count, whole) = (scene.array().len(), Problem::new(&scene).expect("a problem"));
    let exact = |i: usize| (0..points).map(|j| whole.gains().exact(j, i)).collect::<Vec<_>>();
    let gains: Vec<Vec<Complex64>> = (0..count).map(exact).collect();
    let matrix: Vec<Complex64> = (0..points * count).map(|k| gains[k % count][k / count]).collect();
    let stored = Gains::from_matrix(&matrix, points).expect("a matrix");
    let request = Request { pressures: Some(whole.pressures().to_vec()), weights: None };
    let problem = Problem::with_gains(stored, &request).expect("a problem");
    let order = Rng::new(0).permutation(count as u32);
    let method = Greedy { phases: phases as u32, order: Order::Given(order.clone()), ..Greedy::default() };
    let mut work = Workspace::new();
    let mut ours = || method.solve(&problem, &mut work, &mut Control::none()).expect("a solution");

    let theirs = textbook(&gains, whole.pressures(), phases, &order);
    let theirs: Vec<Complex32> = theirs.iter().map(|q| Complex32::new(q.re as f32, q.im as f32)).collect();
    let (a, b) = (ours().metrics(), whole.judge(&theirs).expect("a drive"));
    assert!((a.accuracy - b.accuracy).abs() < 5e-3, "different answers: {a:?} {b:?}");

    let (mut mine, mut book) = (Vec::new(), Vec::new());
    for _ in 0..15 {
        mine.push(timed(&mut ours));
        book.push(timed(|| textbook(&gains, whole.pressures(), phases, &order)));
    }
    let (mine, book) = (median(mine), median(book));
    let per = |t: Duration| t.as_secs_f64() * 1e9 / (count * points * phases) as f64;
    println!(
        "greedy N={count} M={points} L={phases}: {mine:.2?} ({:.2} ns a candidate and point), textbook {book:.2?} ({:.2} ns), ratio {:.1}",
        per(mine),
        per(book),
        book.as_secs_f64() / mine.as_secs_f64()
    );
}

/// A field of 500 x 500 pixels.
fn field() {
    let scene = scene(36, 38);
    let drive = vec![Complex32::ONE; scene.array().len()];
    let pixels = Plane::new(0.15, 0.1, 500, [0.0, 0.0]).expect("a plane").points();
    let draw = || midair::field(&scene, &drive, &pixels, &mut Control::none()).expect("a field");
    let time = median((0..3).map(|_| timed(draw)).collect());
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    println!("field 500 x 500 from 1296 transducers on {threads} threads: {time:.2?}");
}

fn main() {
    // `cargo test` runs benches too, to see that they work; it asks for no figures.
    if std::env::args().any(|argument| argument == "--bench") {
        greedy(36, 38, 16);
        for (points, phases) in [(4, 16), (16, 16), (64, 16), (64, 256)] {
            greedy(20, points, phases);
        }
        field();
    } else {
        greedy(4, 4, 16);
    }
}
