//! Random problems with stored rows, each alone and all interleaved, and checks of the results of sweeps and passes.

use alloc::vec::Vec;

use num_complex::Complex64;

use crate::kernels::lanes::LANES;
use crate::kernels::propagate::rows::Rows;
use crate::kernels::simd::instruction_set::InstructionSet;
use crate::kernels::tests::{numbers, wide};
use crate::rng::Rng;

/// Rows of G of all transducers, one after another, with targets and weights.
pub(super) struct Lists {
    gain: [Vec<f32>; 2],
    pub(super) target: Vec<f32>,
    pub(super) weight: Vec<f32>,
    pub(super) points: usize,
}

impl Lists {
    pub(super) fn rows(&self) -> Rows<'_> {
        Rows::Stored { re: &self.gain[0], im: &self.gain[1] }
    }

    /// Returns the length of a row.
    pub(super) fn lanes(&self) -> usize {
        self.target.len()
    }

    /// Returns G of transducer i at point j.
    pub(super) fn gain(&self, i: usize, j: usize) -> Complex64 {
        let at = i * self.lanes() + j;
        Complex64::new(wide(self.gain[0][at]), wide(self.gain[1][at]))
    }

    /// Asserts that the field is the f64 sum of the waves, within the rounding of as many sums in f32.
    pub(super) fn assert_field(&self, drive: &[Complex64], re: &[f32], im: &[f32]) {
        for j in 0..self.points {
            let want: Complex64 = (0..drive.len()).map(|i| self.gain(i, j) * drive[i]).sum();
            let miss = (want - Complex64::new(wide(re[j]), wide(im[j]))).norm();
            assert!(miss <= 1e-6 * drive.len() as f64, "point {j}: off by {miss:e}");
        }
    }
}

/// Up to 16 problems, some with one point less or with a quiet point, and all of them interleaved.
pub(super) struct Batch {
    pub(super) problems: Vec<Lists>,
    pub(super) all: Lists,
}

pub(super) const TRANSDUCERS: usize = 45;

impl Batch {
    pub(super) fn new(problems: usize, points: usize) -> Self {
        let mut rng = Rng::new((100 * points + problems) as u64);
        let problems: Vec<Lists> = (0..problems)
            .map(|k| {
                let points = if k % 3 == 2 && points > 1 { points - 1 } else { points };
                let mut plane =
                    || -> Vec<f32> { (0..TRANSDUCERS).flat_map(|_| numbers(&mut rng, points, -1.0, 1.0)).collect() };
                let gain = [plane(), plane()];
                let mut target = numbers(&mut rng, points, 0.5, 12.0);
                if k % 4 == 1 && points > 1 {
                    target[points / 2] = 0.0;
                }
                Lists { gain, target, weight: numbers(&mut rng, points, 0.2, 2.0), points }
            })
            .collect();
        // A point that a problem lacks may have any gain; its target and weight are 0.
        let list = |take: &dyn Fn(&Lists, usize) -> f32, missing: f32| -> Vec<f32> {
            (0..points)
                .flat_map(|j| (0..LANES).map(move |lane| (j, lane)))
                .map(|(j, lane)| match problems.get(lane) {
                    Some(lists) if j < lists.points => take(lists, j),
                    _ => missing,
                })
                .collect()
        };
        let plane = |part: usize| -> Vec<f32> {
            (0..TRANSDUCERS).flat_map(|i| list(&|lists, j| lists.gain[part][i * lists.lanes() + j], 0.3)).collect()
        };
        let gain = [plane(0), plane(1)];
        let (target, weight) = (list(&|lists, j| lists.target[j], 0.0), list(&|lists, j| lists.weight[j], 0.0));
        let all = Lists { gain, target, weight, points: points * LANES };
        Self { problems, all }
    }

    /// Asserts that an interleaved batch (`drives` and `fields`) and the single solve of problem `lane` gave the same bits.
    pub(super) fn assert_same(
        &self,
        lane: usize,
        drive: &[num_complex::Complex32],
        [re, im]: [&[f32]; 2],
        drives: &[f32],
        fields: [&[f32]; 2],
    ) {
        let of = |list: &[f32], k: usize| list[k * LANES + lane].to_bits();
        for (i, q) in drive.iter().enumerate() {
            let other = [of(drives, 2 * i), of(drives, 2 * i + 1)];
            assert_eq!([q.re.to_bits(), q.im.to_bits()], other, "drive {i} of problem {lane}");
        }
        for j in 0..self.problems[lane].points {
            let other = [of(fields[0], j), of(fields[1], j)];
            assert_eq!([re[j].to_bits(), im[j].to_bits()], other, "point {j} of problem {lane}");
        }
    }
}

/// Calls `test` for every instruction set, with batches of several sizes.
pub(super) fn each(test: impl Fn(InstructionSet, &Batch, usize)) {
    for set in InstructionSet::all() {
        for points in [1, 2, 3, 4, 7, 8, 9, 15, 16] {
            for problems in [1, 5, 16] {
                test(set, &Batch::new(problems, points), points);
            }
        }
    }
}

/// Returns the drive in f64.
pub(super) fn widened(drive: &[num_complex::Complex32]) -> Vec<Complex64> {
    drive.iter().map(|q| Complex64::new(wide(q.re), wide(q.im))).collect()
}
