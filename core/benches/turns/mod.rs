//! Medians of the times of several pieces of work, measured in turns.

use std::hint::black_box;
use std::time::{Duration, Instant};

/// A measurement takes at least this long: the work is repeated.
const LEAST: Duration = Duration::from_micros(1500);

/// Work that is repeated a given number of times.
pub(crate) type Side<'a> = Box<dyn FnMut(usize) + 'a>;

pub(crate) fn side<'a, T>(mut work: impl FnMut() -> T + 'a) -> Side<'a> {
    Box::new(move |times| (0..times).for_each(|_| drop(black_box(work()))))
}

fn timed(side: &mut Side<'_>, times: usize) -> Duration {
    let start = Instant::now();
    side(times);
    start.elapsed()
}

/// Returns the median time of the work of each side, over rounds in which all sides alternate.
pub(crate) fn medians(sides: &mut [Side<'_>], rounds: usize) -> Vec<Duration> {
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
