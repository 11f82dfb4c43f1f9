//! The search of the greedy method against energies in f64.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::TAU;

use super::super::{Candidates, L1, L2, Points, Term, best, padded, tolerance};
use super::{LENGTHS, ROUNDING, assert_near, numbers, wide};
use crate::rng::Rng;

/// The terms of eq. (7) in f64.
trait Reference: Term {
    fn term(miss: f64) -> f64;
}

impl Reference for L2 {
    fn term(miss: f64) -> f64 {
        miss * miss
    }
}

impl Reference for L1 {
    fn term(miss: f64) -> f64 {
        miss.abs()
    }
}

/// Some points in the middle of a search.
struct Scene {
    pressure: [Vec<f32>; 2],
    modulus: Vec<f32>,
    gain: [Vec<f32>; 2],
    target: Vec<f32>,
    weight: Vec<f32>,
    count: usize,
}

impl Scene {
    /// `loud` is how large the pressures are beside the gains and targets.
    fn new(seed: u64, count: usize, loud: f64) -> Self {
        let mut rng = Rng::new(seed);
        let pressure = [(); 2].map(|()| numbers(&mut rng, count, -loud, loud));
        let mut modulus = vec![0.0; padded(count)];
        super::super::modulus(&pressure[0], &pressure[1], &mut modulus);
        let gain = [(); 2].map(|()| numbers(&mut rng, count, -0.7, 0.7));
        let target = numbers(&mut rng, count, 0.0, 2.0);
        Self { pressure, modulus, gain, target, weight: numbers(&mut rng, count, 0.0, 1.0), count }
    }

    fn points(&self) -> Points<'_> {
        Points {
            pressure: [&self.pressure[0], &self.pressure[1]],
            modulus: &self.modulus,
            gain: [&self.gain[0], &self.gain[1]],
            target: &self.target,
            weight: &self.weight,
            count: self.count,
        }
    }

    /// The change of point j's term under the drive q.
    fn change<T: Reference>(&self, j: usize, [qr, qi]: [f64; 2]) -> f64 {
        let [pr, pi, gr, gi] =
            [&self.pressure[0], &self.pressure[1], &self.gain[0], &self.gain[1]].map(|x| wide(x[j]));
        let new = (pr + gr * qr - gi * qi).hypot(pi + gr * qi + gi * qr);
        let target = wide(self.target[j]);
        wide(self.weight[j]) * (T::term(target - new) - T::term(target - pr.hypot(pi)))
    }

    /// The most that a drive of modulus 1 may change point j's term by.
    fn bound<T: Reference>(&self, j: usize) -> f64 {
        let gain = wide(self.gain[0][j]).abs() + wide(self.gain[1][j]).abs();
        wide(self.weight[j]) * wide(T::bound(gain as f32, self.target[j] - self.modulus[j]))
    }

    fn greatest_bound<T: Reference>(&self) -> f64 {
        (0..self.count).map(|j| self.bound::<T>(j)).fold(0.0, f64::max)
    }
}

fn candidates(phases: usize, amplitudes: usize) -> Candidates {
    Candidates::new(phases, amplitudes, Vec::new(), Vec::new())
}

#[test]
fn tolerance_is_1e_7_of_a_true_bound() {
    fn check<T: Reference>(scene: &Scene) {
        let most = scene.greatest_bound::<T>();
        // Five roundings on the way to a bound and its share.
        assert_near(tolerance::<T>(scene.points()), 1e-7 * most, 5.0 * ROUNDING * 1e-7 * most, "tolerance");
        for j in 0..scene.count {
            for step in 0..32 {
                let (sin, cos) = (TAU * f64::from(step) / 32.0).sin_cos();
                let change = scene.change::<T>(j, [cos, sin]).abs();
                assert!(change <= scene.bound::<T>(j) * (1.0 + 1e-6), "{change} above its bound");
            }
        }
    }
    for count in LENGTHS {
        for loud in [0.0, 1e-3, 1.0, 30.0] {
            check::<L2>(&Scene::new(count as u64, count, loud));
            check::<L1>(&Scene::new(count as u64, count, loud));
        }
    }
    let mut deaf = Scene::new(1, 20, 1.0);
    deaf.gain.iter_mut().for_each(|part| part.fill(0.0));
    assert!(tolerance::<L2>(deaf.points()) == 0.0 && tolerance::<L1>(deaf.points()) == 0.0);
}

#[test]
fn candidates_are_amplitudes_times_phases_whatever_the_buffers_held() {
    for phases in LENGTHS {
        for amplitudes in [1, 2, 3, 16] {
            let count = phases * amplitudes;
            let dirty = |length: usize| vec![f32::NAN; length];
            let made = Candidates::new(phases, amplitudes, dirty(3), dirty(2 * count + 40));
            for k in 0..count {
                let amplitude = ((k / phases) as f64 + 1.0) / amplitudes as f64;
                let (sin, cos) = (TAU * (k % phases) as f64 / phases as f64).sin_cos();
                let [re, im] = made.drive(k);
                // Rounded once, from f64 numbers that are good to 1e-15.
                assert_near(re, amplitude * cos, ROUNDING, "re");
                assert_near(im, amplitude * sin, ROUNDING, "im");
            }
            let last = made.drive(count - 1);
            for (buffer, last) in made.into_buffers().iter().zip(last) {
                assert_eq!(buffer.len(), padded(count));
                assert!(buffer[count..].iter().all(|x| x.to_bits() == last.to_bits()), "spare lanes may win");
            }
        }
    }
}

/// What `best` finds is within rounding of the least energy that f64 finds; with `stride` = L at phase 0.
fn assert_best<T: Reference>(mut scene: Scene, phases: usize, amplitudes: usize, stride: usize) {
    let candidates = candidates(phases, amplitudes);
    let change = |scene: &Scene, index: usize| {
        let drive = candidates.drive(index).map(wide);
        (0..scene.count).map(|j| scene.change::<T>(j, drive)).sum::<f64>()
    };
    let all = (0..phases * amplitudes).step_by(stride);
    let least = all.map(|index| change(&scene, index)).fold(f64::INFINITY, f64::min);
    let tolerance = tolerance::<T>(scene.points());
    // The tolerance itself, and a term's few roundings in the winner and in what it should have lost to.
    let bounds: f64 = (0..scene.count).map(|j| scene.bound::<T>(j)).sum();
    let allowed = wide(tolerance) + 8.0 * ROUNDING * bounds;
    // Padding takes no part in the search: what lies there must not matter.
    let count = scene.count;
    let lists = scene.pressure.iter_mut().chain(&mut scene.gain);
    for list in lists.chain([&mut scene.modulus, &mut scene.target, &mut scene.weight]) {
        list[count..].fill(f32::NAN);
    }
    let index = best::<T>(scene.points(), &candidates, stride, tolerance);
    assert_eq!(index % stride, 0, "a phase was searched");
    let regret = change(&scene, index) - least;
    assert!(
        regret <= allowed,
        "M = {count}, L = {phases}, K = {amplitudes}: regret {regret:e} > {allowed:e}"
    );
}

#[test]
fn best_finds_the_least_energy() {
    for count in LENGTHS {
        for loud in [1e-3, 1.0, 30.0] {
            for (phases, amplitudes) in [(count, 1), (16, 1), (5, 7), (2, 33)] {
                let scene = || Scene::new((100 * count + phases) as u64, count, loud);
                assert_best::<L2>(scene(), phases, amplitudes, 1);
                assert_best::<L1>(scene(), phases, amplitudes, 1);
            }
        }
    }
}

#[test]
fn best_with_a_stride_searches_the_amplitudes_alone() {
    for count in LENGTHS {
        for (phases, amplitudes) in [(count + 1, 2), (16, 1), (2, 16), (3, 17), (16, 40)] {
            let silence = || Scene::new((100 * count + phases) as u64, count, 0.0);
            assert_best::<L2>(silence(), phases, amplitudes, phases);
            assert_best::<L1>(silence(), phases, amplitudes, phases);
        }
    }
}

/// One point of pressure `old` at which a transducer makes the pressure 1, both of phase 0.
fn plain(old: f32, target: f32) -> Scene {
    let lone = |x: f32| {
        let mut list = vec![0.0; padded(1)];
        list[0] = x;
        list
    };
    Scene {
        pressure: [lone(old), lone(0.0)],
        modulus: lone(old),
        gain: [lone(1.0), lone(0.0)],
        target: lone(target),
        weight: lone(1.0),
        count: 1,
    }
}

#[test]
fn of_equal_candidates_the_first_wins() {
    fn check<T: Reference>() {
        let find = |scene: &Scene, phases, amplitudes, stride| {
            let tolerance = tolerance::<T>(scene.points());
            best::<T>(scene.points(), &candidates(phases, amplitudes), stride, tolerance)
        };
        // A loud point stays nearest to its target if the new wave comes from either side: of phases l and
        // L - l, which lie in different groups of lanes for most L, the first is taken.
        for phases in 3..=67 {
            let index = find(&plain(3.0, 3.1), phases, 1, 1);
            assert!((1..=phases / 2).contains(&index), "L = {phases}: {index}");
        }
        // From silence a target midway between two amplitudes takes the smaller; at K = 32 the two lie on either
        // side of a group's end.
        for (amplitudes, lower) in [(2_u8, 1_u8), (4, 2), (32, 16), (40, 17)] {
            let target = (f32::from(lower) + 0.5) / f32::from(amplitudes);
            let index = find(&plain(0.0, target), 6, usize::from(amplitudes), 6);
            assert_eq!(index, 6 * (usize::from(lower) - 1), "K = {amplitudes}");
        }
        // A transducer that reaches no point changes nothing by any candidate.
        let mut deaf = plain(3.0, 1.0);
        deaf.gain[0].fill(0.0);
        assert_eq!((find(&deaf, 50, 2, 1), find(&deaf, 50, 2, 50)), (0, 0));
    }
    check::<L2>();
    check::<L1>();
}

#[test]
fn a_later_candidate_wins_only_by_more_than_the_tolerance() {
    // Half a turn lowers |P| from 3 by 1, which saves 9 - 4 = 5 of (0 - |P|)^2; phase 0 costs 16 - 9 = 7.
    let scene = plain(3.0, 0.0);
    for (phases, half) in [(2, 1), (40, 20)] {
        let find = |tolerance| best::<L2>(scene.points(), &candidates(phases, 1), 1, tolerance);
        assert_eq!(find(0.0), half);
        assert_eq!(find(12.1), 0);
    }
    assert_eq!(best::<L2>(scene.points(), &candidates(2, 1), 1, 11.9), 1);
}
