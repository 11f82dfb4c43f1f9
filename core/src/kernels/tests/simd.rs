//! The operations of the kernels, one by one, for every instruction set.

use core::array::from_fn;

use crate::kernels::lanes::{LANES, Lanes};
use crate::kernels::simd::WHOLE;
use crate::kernels::simd::doubles::{EIGHT, V, runs};
use crate::kernels::simd::instruction_set::{InstructionSet, dispatch};
use crate::kernels::tests::ROUNDING;
use crate::rng::Rng;

fn lanes(rng: &mut Rng, low: f64, high: f64) -> Lanes {
    from_fn(|_| (low + (high - low) * rng.uniform()) as f32)
}

/// Evaluates an expression of lanes with an instruction set, and returns the values of the lanes.
macro_rules! stored {
    ($set:expr, $s:ident => $body:expr) => {
        dispatch!($set, $s => {
            let mut out: Lanes = [f32::NAN; LANES];
            $s.store($body, &mut out);
            out
        })
    };
}

#[test]
fn inverse_roots_are_accurate_and_the_same_for_every_set() {
    let numbers = [1e-300, 3e-9, 0.25, 0.999, 1.0, 2.0, 7.3, 1e200];
    let exact = numbers.map(|x: f64| 1.0 / x.sqrt());
    let mut first = None;
    for set in InstructionSet::all() {
        let mut roots = [0.0; EIGHT];
        dispatch!(set, s => {
            for at in runs(s) {
                V::of(s, &numbers[at..]).inverse_root().put(&mut roots[at..]);
            }
        });
        let off = roots.iter().zip(exact).map(|(root, exact)| (root / exact - 1.0).abs()).fold(0.0, f64::max);
        assert!(off < 3e-12, "{set}: {off:e}");
        assert_eq!(roots, *first.get_or_insert(roots));
    }
}

#[test]
fn operations_are_those_of_each_lane() {
    for set in InstructionSet::all() {
        let mut rng = Rng::new(1);
        for _ in 0..200 {
            let [a, b, c] = [(); 3].map(|()| lanes(&mut rng, -3.0, 3.0));
            let each = |f: &dyn Fn(usize) -> f32| -> Lanes { from_fn(f) };
            assert_eq!(stored!(set, s => s.add(s.load(&a), s.load(&b))), each(&|l| a[l] + b[l]));
            assert_eq!(stored!(set, s => s.sub(s.load(&a), s.load(&b))), each(&|l| a[l] - b[l]));
            assert_eq!(stored!(set, s => s.mul(s.load(&a), s.load(&b))), each(&|l| a[l] * b[l]));
            assert_eq!(stored!(set, s => s.min(s.load(&a), s.load(&b))), each(&|l| a[l].min(b[l])));
            assert_eq!(stored!(set, s => s.max(s.load(&a), s.load(&b))), each(&|l| a[l].max(b[l])));
            assert_eq!(stored!(set, s => s.abs(s.load(&a))), each(&|l| a[l].abs()));
            assert_eq!(stored!(set, s => s.round(s.load(&a))), each(&|l| a[l].round_ties_even()));
            assert_eq!(stored!(set, s => s.fract(s.load(&a))), each(&|l| a[l] - a[l].round_ties_even()));
            assert_eq!(stored!(set, s => s.swap::<8>(s.load(&a))), each(&|l| a[l ^ 8]));
            assert_eq!(stored!(set, s => s.swap::<4>(s.load(&a))), each(&|l| a[l ^ 4]));
            assert_eq!(stored!(set, s => s.swap::<2>(s.load(&a))), each(&|l| a[l ^ 2]));
            assert_eq!(stored!(set, s => s.swap::<1>(s.load(&a))), each(&|l| a[l ^ 1]));
            macro_rules! two {
                ($d:literal) => {{
                    let picked = stored!(set, s => s.pick::<$d>(s.load(&a), s.load(&b)));
                    assert_eq!(picked, each(&|l| if l & $d == 0 { a[l] } else { b[l] }), "{set}");
                    let folded = stored!(set, s => s.fold::<$d>(s.load(&a), s.load(&b)));
                    assert_eq!(folded, each(&|l| if l & $d == 0 { a[l] + a[l ^ $d] } else { b[l] + b[l ^ $d] }), "{set}");
                }};
            }
            two!(8);
            two!(4);
            two!(2);
            two!(1);
            assert_eq!(stored!(set, s => s.quarters([a[0], a[1], a[2], a[3]])), each(&|l| a[l / 4]));
            let select = stored!(set, s => s.select_less(s.load(&a), s.load(&b), s.load(&c), s.load(&a)));
            assert_eq!(select, each(&|l| if a[l] < b[l] { c[l] } else { a[l] }));
            let bits = (0..LANES).fold(0, |bits, l| bits | u32::from(a[l] < b[l]) << l);
            assert_eq!(dispatch!(set, s => s.less(s.load(&a), s.load(&b))), bits);
            let fused = stored!(set, s => s.fma(s.load(&a), s.load(&b), s.load(&c)));
            let minus = stored!(set, s => s.fnma(s.load(&a), s.load(&b), s.load(&c)));
            for l in 0..LANES {
                let [a, b, c] = [a[l], b[l], c[l]].map(f64::from);
                assert!((f64::from(fused[l]) - (a * b + c)).abs() <= 2.0 * ROUNDING * 12.0);
                assert!((f64::from(minus[l]) - (c - a * b)).abs() <= 2.0 * ROUNDING * 12.0);
            }
        }
    }
}

#[test]
fn a_transpose_swaps_lanes_and_vectors() {
    let lists: [Lanes; LANES] = from_fn(|k| from_fn(|l| (k * LANES + l) as f32));
    for set in InstructionSet::all() {
        let turned = dispatch!(set, s => {
            let mut vectors = [s.splat(0.0); LANES];
            for (vector, list) in vectors.iter_mut().zip(&lists) {
                *vector = s.load(list);
            }
            let mut turned = [[f32::NAN; LANES]; LANES];
            for (list, vector) in turned.iter_mut().zip(s.transpose(vectors)) {
                s.store(vector, list);
            }
            turned
        });
        assert_eq!(turned, from_fn(|k| from_fn(|l| lists[l][k])), "{set}");
    }
}

#[test]
fn sums_follow_one_tree_in_every_set() {
    let mut rng = Rng::new(2);
    for _ in 0..if cfg!(miri) { 3 } else { 200 } {
        let vectors: [Lanes; LANES] = from_fn(|_| lanes(&mut rng, -1.0, 1.0));
        let tree: Lanes = from_fn(|k| crate::kernels::simd::reduce_add(&vectors[k]));
        let greatest = vectors[0].into_iter().fold(f32::MIN, f32::max);
        for set in InstructionSet::all() {
            assert_eq!(from_fn(|k| dispatch!(set, s => s.reduce_add(s.load(&vectors[k])))), tree, "{set}");
            assert_eq!(
                stored!(set, s => s.reduce_add_each(&core::array::from_fn(|k| s.load(&vectors[k])))),
                tree,
                "{set}"
            );
            assert_eq!(dispatch!(set, s => s.reduce_max(s.load(&vectors[0]))), greatest, "{set}");
        }
    }
}

#[test]
fn roots_are_within_two_roundings() {
    for set in InstructionSet::all() {
        for exponent in -92..=126 {
            let x: Lanes = from_fn(|l| 2.0_f32.powi(exponent) * (1.0 + l as f32 / 16.0));
            let root = stored!(set, s => s.sqrt_rsqrt(s.load(&x)).0);
            let inverse = stored!(set, s => s.sqrt_rsqrt(s.load(&x)).1);
            let alone = stored!(set, s => s.rsqrt(s.load(&x)));
            let guess = stored!(set, s => s.rsqrt_estimate(s.load(&x)));
            for l in 0..LANES {
                let exact = f64::from(x[l]).sqrt();
                assert_eq!(stored!(set, s => s.sqrt(s.load(&x)))[l], x[l].sqrt());
                assert_eq!(stored!(set, s => s.div(s.load(&x), s.splat(7.0)))[l], x[l] / 7.0);
                // Without fused products the remainder itself is rounded.
                assert!((f64::from(root[l]) / exact - 1.0).abs() <= 3.0 * ROUNDING, "{set}: sqrt {}", x[l]);
                assert!((f64::from(inverse[l]) * exact - 1.0).abs() <= 3.0 * ROUNDING, "{set}: {}", x[l]);
                assert!((f64::from(alone[l]) * exact - 1.0).abs() <= 3.0 * ROUNDING, "{set}: {}", x[l]);
                assert!((f64::from(guess[l]) * exact - 1.0).abs() <= 7e-5, "{set}: guess of {}", x[l]);
            }
        }
    }
}

#[test]
fn powers_and_tables() {
    for set in InstructionSet::all() {
        for start in (-126..=96).step_by(16) {
            let whole: Lanes = from_fn(|l| start as f32 + l as f32);
            assert_eq!(stored!(set, s => s.exp2(s.load(&whole))), whole.map(|x| 2.0_f32.powi(x as i32)));
        }
        let table: Lanes = from_fn(|l| 100.0 + l as f32);
        for turn in 0..LANES {
            let index: Lanes = from_fn(|l| WHOLE + ((5 * l + turn) as f32 - 32.0));
            assert_eq!(
                stored!(set, s => s.gather(&table, s.load(&index))),
                from_fn(|l| 100.0 + ((5 * l + turn) % 16) as f32)
            );
            let parts = index.map(|x| 0.25 * x - 2.0);
            assert_eq!(stored!(set, s => s.floor(s.load(&parts))), parts.map(f32::floor));
            let list: Vec<f32> = (0..100).map(|k| 0.5 * k as f32).collect();
            let index: Lanes = from_fn(|l| (7 * l + turn) as f32);
            let beyond = index.map(|x| 0.5 * x.min(99.0));
            assert_eq!(stored!(set, s => s.gather_list(&list, s.load(&index))), beyond);
            // Odd lanes may have any content. There are 50 pairs; some indices are outside of them, and one is NaN.
            let mut noisy: Lanes = from_fn(|l| if l % 2 == 0 { 0.75 * index[l] - 40.0 } else { -3.5e9 });
            noisy[2 * (turn / 2)] = f32::NAN;
            for zero in [0, 20, 45] {
                let pairs: Lanes = from_fn(|l| {
                    let x = noisy[l & !1];
                    let at = x.floor() as i32 + zero;
                    let place = if (0..50).contains(&at) && !x.is_nan() { at } else { 49 };
                    0.5 * (2 * place + (l % 2) as i32) as f32
                });
                assert_eq!(stored!(set, s => s.gather_pairs(&list, zero, s.load(&noisy))), pairs, "{set}");
            }
        }
    }
}
