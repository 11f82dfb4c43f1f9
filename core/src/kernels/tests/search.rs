//! The search of the greedy method compared with energies in f64.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::TAU;

use crate::kernels::greedy::candidates::Candidates;
use crate::kernels::greedy::candidates::{L1, L2, Term};
use crate::kernels::greedy::point_group::PointGroup;
use crate::kernels::greedy::search;
use crate::kernels::greedy::search::Points;
use crate::kernels::lanes::{LANES, groups, padded};
use crate::kernels::simd::instruction_set::{InstructionSet, dispatch};
use crate::kernels::tests::{LENGTHS, ROUNDING, assert_near, numbers, wide};
use crate::rng::Rng;

/// The terms of the energy in f64.
pub(super) trait Reference: Term {
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

/// Points in the middle of a search: their pressures, and G of the transducer.
pub(super) struct Scene {
    pressure: [Vec<f32>; 2],
    pub(super) gain: [Vec<f32>; 2],
    pub(super) target: Vec<f32>,
    pub(super) weight: Vec<f32>,
    pub(super) count: usize,
}

impl Scene {
    /// Creates random points. `loud` is the size of the pressures relative to G and the targets.
    pub(super) fn new(seed: u64, count: usize, loud: f64) -> Self {
        let mut rng = Rng::new(seed);
        let mut list = |low: f64, high: f64| numbers(&mut rng, count, low, high);
        let pressure = [list(-loud, loud), list(-loud, loud)];
        let gain = [list(-0.7, 0.7), list(-0.7, 0.7)];
        Self { pressure, gain, target: list(0.0, 2.0), weight: list(0.0, 1.0), count }
    }

    /// Returns the point groups as a pass stores them (the pressures are added to 0), and the energy.
    pub(super) fn state(&self, set: InstructionSet) -> (Vec<PointGroup>, f32) {
        let [re, im] = [0, 1].map(|part| groups(&self.pressure[part]));
        let requested = groups(&self.target).iter().zip(groups(&self.weight));
        let mut energy = 0.0;
        let state = requested.zip(re.iter().zip(im)).map(|((target, weight), (re, im))| {
            dispatch!(set, s => {
                let mut group = PointGroup::silent(s, target, weight);
                energy += s.reduce_add(group.add(s, [re, im], [s.splat(1.0), s.splat(0.0)]));
                group
            })
        });
        (state.collect(), energy)
    }

    pub(super) fn points<'a>(&'a self, state: &'a [PointGroup]) -> Points<'a> {
        Points { groups: state, row: [&self.gain[0], &self.gain[1]], count: self.count }
    }

    /// Returns the pressure P and the gain G of point j: real and imaginary parts.
    pub(super) fn numbers(&self, j: usize) -> [f64; 4] {
        [&self.pressure[0], &self.pressure[1], &self.gain[0], &self.gain[1]].map(|x| wide(x[j]))
    }

    /// Returns the change of point j's term by the drive q.
    pub(super) fn change<T: Reference>(&self, j: usize, [qr, qi]: [f64; 2]) -> f64 {
        let [pr, pi, gr, gi] = self.numbers(j);
        let new = (pr + gr * qr - gi * qi).hypot(pi + gr * qi + gi * qr);
        let target = wide(self.target[j]);
        wide(self.weight[j]) * (T::term(target - new) - T::term(target - pr.hypot(pi)))
    }

    pub(super) fn total<T: Reference>(&self, drive: [f32; 2]) -> f64 {
        (0..self.count).map(|j| self.change::<T>(j, drive.map(wide))).sum()
    }

    /// Returns the largest change of point j's term by a drive of modulus 1.
    pub(super) fn bound<T: Reference>(&self, j: usize) -> f64 {
        let [pr, pi, gr, gi] = self.numbers(j);
        let (gain, gap) = (gr.abs() + gi.abs(), (wide(self.target[j]) - pr.hypot(pi)).abs());
        wide(self.weight[j]) * if T::SQUARE { gain * (gain + 2.0 * gap) } else { gain }
    }
}

pub(super) fn candidates(phases: usize, amplitudes: usize) -> Candidates {
    Candidates::new(phases, amplitudes, [const { Vec::new() }; 3])
}

pub(super) fn tolerance<T: Term>(set: InstructionSet, scene: &Scene) -> f32 {
    let (state, _) = scene.state(set);
    dispatch!(set, s => search::tolerance::<_, T>(s, scene.points(&state)))
}

fn best<T: Term>(set: InstructionSet, scene: &Scene, candidates: &Candidates, silent: bool, tolerance: f32) -> usize {
    let (state, _) = scene.state(set);
    dispatch!(set, s => search::best::<_, T>(s, scene.points(&state), candidates, silent, tolerance))
}

/// Returns the least energy that f64 finds; only phase 0 is tried if `silent`.
pub(super) fn least<T: Reference>(scene: &Scene, candidates: &Candidates, silent: bool) -> f64 {
    let step = if silent { candidates.phases } else { 1 };
    let all = (0..candidates.phases * candidates.amplitudes).step_by(step);
    all.map(|index| scene.total::<T>(candidates.drive(index))).fold(f64::INFINITY, f64::min)
}

#[test]
fn tolerance_is_1e_7_of_a_true_bound() {
    fn check<T: Reference>(set: InstructionSet, scene: &Scene) {
        let most = (0..scene.count).map(|j| scene.bound::<T>(j)).fold(0.0, f64::max);
        // The allowed error: nine roundings in a bound and its part of 1e-7, four of them in the modulus.
        assert_near(tolerance::<T>(set, scene), 1e-7 * most, 9.0 * ROUNDING * 1e-7 * most, "tolerance");
        for j in 0..scene.count {
            for step in 0..32 {
                let (sin, cos) = (TAU * f64::from(step) / 32.0).sin_cos();
                let change = scene.change::<T>(j, [cos, sin]).abs();
                assert!(change <= scene.bound::<T>(j) * (1.0 + 1e-6), "{change} above its bound");
            }
        }
    }
    for set in InstructionSet::all() {
        for count in LENGTHS {
            for loud in [0.0, 1e-3, 1.0, 30.0] {
                check::<L2>(set, &Scene::new(count as u64, count, loud));
                check::<L1>(set, &Scene::new(count as u64, count, loud));
            }
        }
        let mut deaf = Scene::new(1, 20, 1.0);
        deaf.gain.iter_mut().for_each(|part| part.fill(0.0));
        assert!(tolerance::<L2>(set, &deaf) == 0.0 && tolerance::<L1>(set, &deaf) == 0.0);
    }
}

#[test]
fn candidates_are_amplitudes_times_phases_for_any_buffers() {
    for phases in LENGTHS {
        for amplitudes in [1, 2, 3, 16] {
            let dirty = [3, 2 * phases + 40, 1].map(|length| vec![f32::NAN; length]);
            let made = Candidates::new(phases, amplitudes, dirty);
            for k in 0..phases * amplitudes {
                let amplitude = ((k / phases) as f64 + 1.0) / amplitudes as f64;
                let (sin, cos) = (TAU * (k % phases) as f64 / phases as f64).sin_cos();
                let [re, im] = made.drive(k);
                // The allowed error: cosine, amplitude and their product are each rounded once.
                assert_near(re, amplitude * cos, 3.0 * ROUNDING, "re");
                assert_near(im, amplitude * sin, 3.0 * ROUNDING, "im");
            }
            for l in 0..phases {
                let [cos, sin] = made.sixteen(l);
                for lane in 0..LANES {
                    assert_eq!([cos[lane], sin[lane]], made.phasor((l + lane) % phases), "phase {l}");
                }
            }
        }
    }
}

/// Asserts that the energy that `best` finds is within rounding of the least energy that f64 finds.
fn assert_best<T: Reference>(set: InstructionSet, scene: &mut Scene, phases: usize, amplitudes: usize, silent: bool) {
    let candidates = candidates(phases, amplitudes);
    let tolerance = tolerance::<T>(set, scene);
    // The allowed loss: the tolerance itself, and a term's few roundings in the candidate found and in the best one.
    let bounds: f64 = (0..scene.count).map(|j| scene.bound::<T>(j)).sum();
    let allowed = wide(tolerance) + 12.0 * ROUNDING * bounds;
    let count = scene.count;
    let index = best::<T>(set, scene, &candidates, silent, tolerance);
    assert!(!silent || index.is_multiple_of(phases), "a phase was searched");
    let regret = scene.total::<T>(candidates.drive(index)) - least::<T>(scene, &candidates, silent);
    assert!(regret <= allowed, "{set}: M = {count}, L = {phases}, K = {amplitudes}: {regret:e} > {allowed:e}");
}

#[test]
fn best_finds_the_least_energy() {
    for set in InstructionSet::all() {
        for count in LENGTHS {
            for loud in [0.0, 1e-3, 1.0, 30.0] {
                for (phases, amplitudes) in [(count + 1, 1), (16, 1), (5, 7), (2, 33)] {
                    let scene = &mut Scene::new((100 * count + phases) as u64, count, loud);
                    assert_best::<L2>(set, scene, phases, amplitudes, loud == 0.0);
                    assert_best::<L1>(set, scene, phases, amplitudes, loud == 0.0);
                }
            }
        }
    }
}

/// Returns one point of pressure `old` at which a transducer makes the pressure 1, both of phase 0.
fn plain(old: f32, target: f32) -> Scene {
    let single = |x: f32| {
        let mut list = vec![0.0; padded(1)];
        list[0] = x;
        list
    };
    Scene {
        pressure: [single(old), single(0.0)],
        gain: [single(1.0), single(0.0)],
        target: single(target),
        weight: single(1.0),
        count: 1,
    }
}

#[test]
fn of_equal_candidates_the_first_wins() {
    fn check<T: Reference>(set: InstructionSet) {
        let find = |scene: &Scene, phases, amplitudes, silent| {
            best::<T>(set, scene, &candidates(phases, amplitudes), silent, tolerance::<T>(set, scene))
        };
        // The new wave can bring a loud point nearest to its target at phase l or at L - l, which are in different lane
        // groups for most L. The search takes the first.
        for phases in 3..=67 {
            let index = find(&plain(3.0, 3.1), phases, 1, false);
            assert!((1..=phases / 2).contains(&index), "L = {phases}: {index}");
        }
        // From silence, a target midway between two amplitudes takes the smaller one. At K = 32 the two are in
        // different lane groups.
        for (amplitudes, lower) in [(2_u8, 1_u8), (4, 2), (32, 16), (40, 17)] {
            let target = (f32::from(lower) + 0.5) / f32::from(amplitudes);
            let index = find(&plain(0.0, target), 6, usize::from(amplitudes), true);
            assert_eq!(index, 6 * (usize::from(lower) - 1), "K = {amplitudes}");
        }
        // No candidate has an effect if the transducer reaches no point.
        let mut deaf = plain(3.0, 1.0);
        deaf.gain[0].fill(0.0);
        assert_eq!((find(&deaf, 50, 2, false), find(&deaf, 50, 2, true)), (0, 0));
    }
    for set in InstructionSet::all() {
        check::<L2>(set);
        check::<L1>(set);
    }
}

#[test]
fn a_later_candidate_wins_only_by_more_than_the_tolerance() {
    for set in InstructionSet::all() {
        // Half a turn lowers |P| from 3 to 2, which lowers (0 - |P|)^2 by 9 - 4 = 5; phase 0 raises it by 16 - 9 = 7.
        let scene = plain(3.0, 0.0);
        for (phases, half) in [(2, 1), (40, 20)] {
            let find = |tolerance| best::<L2>(set, &scene, &candidates(phases, 1), false, tolerance);
            assert_eq!(find(0.0), half);
            assert_eq!(find(12.1), 0);
        }
        assert_eq!(best::<L2>(set, &scene, &candidates(2, 1), false, 11.9), 1);
    }
}
