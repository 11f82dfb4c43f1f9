//! Time and memory of every method for different M and N, to compare with the growth that the documentation states.
//!
//! `cargo bench -p midair --bench methods`. Medians of a few solves with one workspace, including G. The memory is the largest
//! amount allocated at one time. Each result is checked before the time is measured.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::time::{Duration, Instant};

use midair::solvers::{Entry, SOLVERS};
use midair::{Array, Control, Medium, Options, Problem, Request, Rng, Scene, Workspace};

static KEPT: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

struct Counting;

#[allow(unsafe_code, reason = "a global allocator cannot be had otherwise; it only counts and passes on")]
// SAFETY: every call is passed on to the system allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        MOST.fetch_max(KEPT.fetch_add(layout.size(), Relaxed) + layout.size(), Relaxed);
        // SAFETY: the caller's guarantees are passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        KEPT.fetch_sub(layout.size(), Relaxed);
        // SAFETY: the caller's guarantees are passed on.
        unsafe { System.dealloc(block, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn problem(side: usize, count: usize) -> Problem {
    let mut rng = Rng::new(count as u64);
    let half = side as f64 * 5e-3;
    let mut coordinate = || (2.0 * rng.uniform() - 1.0) * half;
    let points = (0..count).map(|_| [coordinate(), coordinate(), 0.15]).collect();
    let array = Array::grid(side, side, 10e-3).expect("a grid");
    Problem::new(&Scene::new(array, Medium::default(), points, Request::default()).expect("a scene"))
        .expect("a problem")
}

/// Returns the median time, the number of steps and the memory of one solve.
fn measured(entry: &Entry, problem: &Problem) -> (Duration, usize, usize) {
    let solver = entry.configure(&Options::new()).expect("defaults").solver;
    let before = KEPT.load(Relaxed);
    MOST.store(before, Relaxed);
    let mut work = Workspace::new();
    let mut solved = || {
        let start = Instant::now();
        let solution = midair::solve(problem, &*solver, false, &mut work, &mut Control::none()).expect("an answer");
        let (time, steps) = (start.elapsed(), solution.steps);
        assert!(solution.metrics().accuracy > 0.05, "{} gives no answer", entry.info.name);
        solution.recycle(&work);
        (time, steps)
    };
    let (first, steps) = solved();
    let memory = MOST.load(Relaxed) - before;
    let repeats = if first > Duration::from_secs(1) { 0 } else { 4 };
    let mut times: Vec<Duration> = (0..repeats).map(|_| solved().0).chain([first]).collect();
    times.sort_unstable();
    (times[times.len() / 2], steps, memory)
}

fn sweep(title: &str, sizes: &[(usize, usize)]) {
    println!("\n{title}: time, (steps), memory");
    let problems: Vec<Problem> = sizes.iter().map(|&(side, count)| problem(side, count)).collect();
    print!("{:9}", "");
    for &(side, count) in sizes {
        print!("{:>28}", format!("N={} M={count}", side * side));
    }
    println!();
    for entry in SOLVERS {
        print!("{:9}", entry.info.name);
        for problem in &problems {
            let (time, steps, memory) = measured(entry, problem);
            print!("{:>28}", format!("{:.3} ms ({steps}) {} KiB", time.as_secs_f64() * 1e3, memory / 1024));
        }
        println!();
    }
}

fn main() {
    // `cargo test` runs benches too, without this argument; a short run is then enough.
    if std::env::args().any(|argument| argument == "--bench") {
        sweep("over M", &[(20, 4), (20, 16), (20, 64), (20, 256)]);
        sweep("over N", &[(10, 64), (20, 64), (36, 64), (64, 64)]);
    } else {
        sweep("small", &[(4, 3)]);
    }
}
