//! Tiles compared with plain f64 loops, for every instruction set.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::TAU;

use num_complex::Complex64;

use crate::control::Control;
use crate::kernels::lanes::{LANES, padded};
use crate::kernels::propagate::rows::Rows;
use crate::kernels::simd::instruction_set::InstructionSet;
use crate::kernels::tests::{LENGTHS, ROUNDING, assert_near, numbers, wide};
use crate::kernels::tiles;
use crate::kernels::tiles::{Tiles, Wave, height, lanes, size};
use crate::kernels::tiles::{phases, products};
use crate::rng::Rng;

/// G as tiles: the points are in reverse order, and the rows of every second point are multiplied by two.
pub(super) struct Scene {
    points: usize,
    transducers: usize,
    pub(super) planes: [Vec<f32>; 2],
    /// The entries of G in the tiles, point by point.
    pub(super) matrix: Vec<Vec<Complex64>>,
}

impl Scene {
    pub(super) fn new(points: usize, transducers: usize, set: InstructionSet) -> Self {
        let mut rng = Rng::new((1000 * points + transducers) as u64);
        let wide_row = padded(points);
        let mut stored = [(); 2].map(|()| Vec::new());
        for plane in &mut stored {
            for _ in 0..transducers {
                plane.extend(numbers(&mut rng, points, -1.0, 1.0));
            }
        }
        let order: Vec<u32> = (0..points as u32).rev().collect();
        let scale: Vec<f32> = (0..points).map(|k| if k % 2 == 0 { 1.0 } else { 2.0 }).collect();
        let mut planes = [(); 2].map(|()| vec![f32::NAN; size(height(points), lanes(transducers))]);
        let [re, im] = &mut planes;
        let rows = Rows::Stored { re: &stored[0], im: &stored[1] };
        tiles::pack(set, rows, 0..transducers, &order, [re, im], &mut Control::none()).expect("it is not stopped");
        for plane in [re, im] {
            (0..points).for_each(|k| tiles::rescale(plane, lanes(transducers), k, scale[k]));
        }
        let entry = |k: usize, i: usize| {
            let at = i * wide_row + points - 1 - k;
            Complex64::new(wide(stored[0][at]), wide(stored[1][at])) * wide(scale[k])
        };
        let matrix = (0..points).map(|k| (0..transducers).map(|i| entry(k, i)).collect()).collect();
        Self { points, transducers, planes, matrix }
    }

    pub(super) fn tiles(&self) -> Tiles<'_> {
        Tiles { planes: [&self.planes[0], &self.planes[1]], lanes: lanes(self.transducers) }
    }

    /// Runs a kernel and returns its drive and field. Asserts that their padding is 0 and that the field is G times the
    /// drive.
    pub(super) fn play(&self, kernel: impl FnOnce(Wave<'_>)) -> [Vec<Complex64>; 2] {
        let dirty = |size: usize| [(); 2].map(|()| vec![f32::NAN; size]);
        let (mut drive, mut field) = (dirty(lanes(self.transducers)), dirty(height(self.points)));
        let [drive_, field_] = [&mut drive, &mut field].map(|pair| pair.each_mut().map(Vec::as_mut_slice));
        kernel(Wave { drive: drive_, field: field_ });
        let join = |[re, im]: &[Vec<f32>; 2]| -> Vec<Complex64> {
            re.iter().zip(im).map(|(&re, &im)| Complex64::new(wide(re), wide(im))).collect()
        };
        let (drive, field) = (join(&drive), join(&field));
        assert!(drive[self.transducers..].iter().chain(&field[self.points..]).all(|z| z.norm() == 0.0));
        // The allowed error: the field is a sum of terms of at most 2 sqrt 2.
        let allowed = 4.0 * ROUNDING * 3.0 * self.transducers as f64;
        for (received, row) in field.iter().zip(&self.matrix) {
            let want: Complex64 = row.iter().zip(&drive).map(|(g, q)| g * q).sum();
            assert!((received - want).norm() <= allowed, "{received} for {want}");
        }
        [drive, field]
    }
}

fn complex(rng: &mut Rng, count: usize) -> [Vec<f32>; 2] {
    [(); 2].map(|()| numbers(rng, count, -1.0, 1.0))
}

/// Returns random numbers over the transducers, and zeros in the padding.
fn over(rng: &mut Rng, transducers: usize) -> Vec<f32> {
    let mut list = numbers(rng, transducers, -1.0, 1.0);
    list.resize(lanes(transducers), 0.0);
    list
}

fn each(test: impl Fn(InstructionSet, usize, &mut Rng)) {
    for set in InstructionSet::all() {
        for count in LENGTHS {
            test(set, count, &mut Rng::new(count as u64));
        }
    }
}

#[test]
fn a_sweep_sets_every_drive_and_computes_the_field() {
    each(|set, count, rng| {
        for transducers in [1, 16, 37] {
            let scene = Scene::new(count, transducers, set);
            let mut target = complex(rng, count);
            for plane in &mut target {
                plane.resize(height(count).max(plane.len()), 0.0);
            }
            let mut memory = vec![f32::NAN; tiles::unit::sweep_floats(height(count))];
            let [drive, _] = scene.play(|wave| {
                tiles::unit::sweep(set, scene.tiles(), [&target[0], &target[1]], wave, &mut memory);
            });
            for i in 0..transducers {
                let part =
                    |k: usize| scene.matrix[k][i].conj() * Complex64::new(wide(target[0][k]), wide(target[1][k]));
                let want: Complex64 = (0..count).map(part).sum();
                // The allowed error: that of sums of terms below 4, relative to their modulus, and a few roundings of
                // the root.
                let allowed = 8.0 * ROUNDING + 4.0 * ROUNDING * 4.0 * count as f64 / want.norm();
                assert!((drive[i] - want / want.norm()).norm() <= allowed, "{set} {count}: {}", drive[i]);
            }
        }
    });
}

#[test]
fn a_drive_is_played_as_it_is_and_made_full() {
    each(|set, count, rng| {
        let scene = Scene::new(count, 37, set);
        let planes = [(); 2].map(|()| over(rng, 37));
        let copy = |wave: &mut Wave<'_>| {
            wave.drive.iter_mut().zip(&planes).for_each(|(part, plane)| part.copy_from_slice(plane));
        };
        let [plain, _] = scene.play(|mut wave| {
            copy(&mut wave);
            tiles::play(set, scene.tiles(), wave);
        });
        let [full, _] = scene.play(|mut wave| {
            copy(&mut wave);
            let [re, im] = &mut wave.drive;
            tiles::unit::normalise(set, [re, im]);
            tiles::play(set, scene.tiles(), wave);
        });
        for i in 0..37 {
            let q = Complex64::new(wide(planes[0][i]), wide(planes[1][i]));
            assert_eq!(plain[i], q);
            assert!((full[i] - q / q.norm()).norm() <= 8.0 * ROUNDING, "{set} {count}: {}", full[i]);
        }
    });
}

#[test]
fn a_transducer_reaches_points_unless_its_column_is_0() {
    each(|set, count, _| {
        let mut scene = Scene::new(count, 37, set);
        assert!((0..37).all(|i| scene.tiles().reaches(i)));
        // Transducer 20 is in lane 4 of the second tile.
        for plane in &mut scene.planes {
            for block in plane.chunks_exact_mut(4 * LANES).skip(1).step_by(lanes(37) / LANES + 1) {
                block.chunks_exact_mut(LANES).for_each(|row| row[4] = 0.0);
            }
        }
        assert!((0..37).all(|i| scene.tiles().reaches(i) == (i != 20)), "{set} {count}");
    });
}

#[test]
fn a_turn_is_a_change_of_phase() {
    each(|set, count, rng| {
        let transducers = 5 + count;
        let scene = Scene::new(count, transducers, set);
        let mut from = [(); 2].map(|()| vec![0.0; lanes(transducers)]);
        // The first transducer is off, and stays off.
        for i in 1..transducers {
            let phase = TAU * rng.uniform();
            (from[0][i], from[1][i]) = (libm::cos(phase) as f32, libm::sin(phase) as f32);
        }
        let turns = over(rng, transducers);
        let [drive, _] =
            scene.play(|wave| tiles::unit::turn(set, scene.tiles(), [&from[0], &from[1]], &turns, 0.5, wave));
        assert_eq!(drive[0], Complex64::ZERO);
        for i in 1..transducers {
            let angle = libm::atan(0.5 * wide(turns[i]));
            let want = Complex64::new(wide(from[0][i]), wide(from[1][i])) * Complex64::from_polar(1.0, angle);
            assert!((drive[i] - want).norm() <= 8.0 * ROUNDING, "{set} {count}: {} for {want}", drive[i]);
        }
    });
}

#[test]
fn slopes_products_and_sums_are_those_of_the_jacobian() {
    each(|set, count, rng| {
        let (transducers, loud) = (37, count / 2);
        let size = 2 * count - loud;
        let scene = Scene::new(count, transducers, set);
        let drive = [(); 2].map(|()| over(rng, transducers));
        let rows = height(size);
        let mut factors = [(); 2].map(|()| vec![0.0; rows]);
        for f in &mut factors {
            f[..size].copy_from_slice(&numbers(rng, size, -1.0, 1.0)[..size]);
        }
        let across = lanes(transducers);
        let mut slopes = vec![f32::NAN; tiles::size(rows, across)];
        let split = [&factors[0][..], &factors[1]];
        let equations = (0..count).chain(loud..count);
        let drives = [&drive[0][..], &drive[1]];
        tiles::slopes(set, scene.tiles(), drives, split, equations, &mut slopes, &mut Control::none())
            .expect("no stop");
        let j = |e: usize, i: usize| {
            let point = if e < count { e } else { e - count + loud };
            let wave = scene.matrix[point][i] * Complex64::new(wide(drive[0][i]), wide(drive[1][i]));
            wide(factors[0][e]) * wave.re + wide(factors[1][e]) * wave.im
        };
        for e in 0..size {
            for i in 0..transducers {
                let block = e / 4 * (across / LANES + 1) + i / LANES;
                let got = slopes[(4 * block + e % 4) * LANES + i % LANES];
                assert_near(got, j(e, i), 32.0 * ROUNDING, "slope");
            }
        }
        let mut matrix = vec![f32::NAN; size * padded(size)];
        products::products(set, &slopes, across, size, &mut matrix, &mut Control::none()).expect("it is not stopped");
        // The allowed error: a term is at most 16, the product of two factors of at most 4, each with the error above.
        let allowed = 300.0 * ROUNDING * transducers as f64;
        for k in 0..size {
            for l in k..size {
                let want = (0..transducers).map(|i| j(k, i) * j(l, i)).sum();
                assert_near(matrix[k * padded(size) + l], want, allowed, "product");
            }
        }
        let mut sums = vec![f32::NAN; across];
        let most = tiles::combine(set, &slopes, &factors[0], &mut sums);
        for i in 0..transducers {
            let want = (0..size).map(|e| wide(factors[0][e]) * j(e, i)).sum();
            assert_near(sums[i], want, 100.0 * ROUNDING * size as f64, "sum");
        }
        assert_eq!(most, sums.iter().fold(0.0, |most: f32, x| most.max(x.abs())));
    });
}

#[test]
fn weights_multiply_the_columns() {
    each(|set, count, rng| {
        let mut scene = Scene::new(count, 37, set);
        let factors = over(rng, 37);
        let before = scene.planes[0].clone();
        tiles::weigh(set, &mut scene.planes[0], &factors);
        // The plane contains tile after tile, each with four rows.
        for (k, block) in before.chunks_exact(4 * LANES).enumerate() {
            let tile = k % (lanes(37) / LANES + 1);
            for (at, x) in block.iter().enumerate().filter(|_| tile < lanes(37) / LANES) {
                let want = wide(*x) * wide(factors[tile * LANES + at % LANES]);
                assert_near(scene.planes[0][4 * LANES * k + at], want, 4.0 * ROUNDING, "weighed");
            }
        }
    });
}

#[test]
fn couplings_are_products_of_rows() {
    each(|set, count, _| {
        // A run of the kernel has 32 tiles: 33 tiles need a second run.
        for transducers in [37, 33 * LANES] {
            let scene = Scene::new(count, transducers, set);
            let mut matrix = [(); 2].map(|()| vec![0.0; count * count]);
            let [re, im] = &mut matrix;
            let all = 0..lanes(transducers) / LANES;
            products::couplings(set, scene.tiles(), all, count, [re, im], &mut Control::none())
                .expect("it is not stopped");
            let mut powers = vec![f32::NAN; count];
            products::powers(set, scene.tiles(), &mut powers);
            // The allowed error: for each transducer a product of two numbers below 2 sqrt 2 has about four roundings.
            let allowed = 4.0 * ROUNDING * 8.0 * transducers as f64;
            for k in 0..count {
                for l in k..count {
                    let pairs = scene.matrix[k].iter().zip(&scene.matrix[l]);
                    let want: Complex64 = pairs.map(|(a, b)| a * b.conj()).sum();
                    let alone = products::coupling(set, scene.tiles(), k, l);
                    for [real, imag] in [[re[k * count + l], im[k * count + l]], alone] {
                        assert_near(real, want.re, allowed, "re");
                        assert_near(imag, want.im, allowed, "im");
                    }
                }
                let want = scene.matrix[k].iter().map(Complex64::norm_sqr).sum();
                assert_near(powers[k], want, allowed, "power");
            }
        }
    });
}

#[test]
fn phases_set_on_the_rows_are_those_set_on_their_products() {
    each(|set, count, rng| {
        let scene = Scene::new(count, 37, set);
        let weights = numbers(rng, count, 0.5, 1.0)[..count].to_vec();
        let mut powers = vec![0.0; count];
        products::powers(set, scene.tiles(), &mut powers);
        let visits: Vec<u32> = (0..count as u32).rev().collect();
        let dirty = |size: usize| [(); 2].map(|()| vec![f32::NAN; size]);
        let (mut vector, mut wave) = (dirty(count), dirty(lanes(37)));
        let [[re, im], [wave_re, wave_im]] = [&mut vector, &mut wave];
        let lists = (&weights[..], &powers[..]);
        let reported = phases::align_rows(
            set,
            scene.tiles(),
            lists,
            &visits,
            2,
            [re, im],
            [wave_re, wave_im],
            &mut Control::none(),
        )
        .expect("it is not stopped");
        let mut want = vec![Complex64::ZERO; count];
        let mut energy = 0.0;
        for round in 0..2 {
            for k in (0..count).rev() {
                let coupling = |l: usize| -> Complex64 {
                    scene.matrix[k].iter().zip(&scene.matrix[l]).map(|(a, b)| a * b.conj()).sum()
                };
                let sum: Complex64 = (0..count).filter(|&l| l != k).map(|l| coupling(l) * want[l]).sum();
                let share = wide(weights[k]);
                want[k] = if sum.norm() > 0.0 { sum / sum.norm() * share } else { share.into() };
                energy += if round == 1 { share * sum.norm() } else { 0.0 };
            }
        }
        // Rounding turns a sum's phase by the error relative to the sum, which is about the root of the number of terms
        // at least. A turn also affects the points after it.
        for (k, want) in want.iter().enumerate() {
            let miss = (Complex64::new(wide(re[k]), wide(im[k])) - want).norm();
            assert!(miss <= 1e-3, "{set} {count}: point {k} by {miss}");
        }
        assert!((wide(reported) - energy).abs() <= 1e-4 * energy.max(1.0), "{set} {count}: {reported} for {energy}");
    });
}

#[test]
fn aligning_raises_the_energy_and_keeps_the_moduli() {
    each(|set, count, rng| {
        let scene = Scene::new(count, 37, set);
        let mut matrix = [(); 2].map(|()| vec![0.0; count * count]);
        let coupling = |k: usize, l: usize| -> Complex64 {
            scene.matrix[k].iter().zip(&scene.matrix[l]).map(|(a, b)| a * b.conj()).sum()
        };
        for k in 0..count {
            for l in (0..count).filter(|&l| l != k) {
                (matrix[0][k * count + l], matrix[1][k * count + l]) =
                    (coupling(k, l).re as f32, coupling(k, l).im as f32);
            }
        }
        let shares = numbers(rng, count, 0.5, 1.0)[..count].to_vec();
        let turns = numbers(rng, count * LANES, -1.0, 1.0);
        let mut vectors = [(); 2].map(|()| vec![f32::NAN; count * LANES]);
        let [re, im] = &mut vectors;
        phases::phasors(set, &turns, &shares, [re, im]);
        let energy = |[re, im]: &[Vec<f32>; 2], s: usize| -> f64 {
            let v = |k: usize| Complex64::new(wide(re[k * LANES + s]), wide(im[k * LANES + s]));
            let pairs = (0..count).flat_map(|k| (0..count).filter(move |&l| l != k).map(move |l| (k, l)));
            pairs.map(|(k, l)| (v(k).conj() * coupling(k, l) * v(l)).re).sum()
        };
        let before: Vec<f64> = (0..LANES).map(|s| energy(&vectors, s)).collect();
        let visits: Vec<u32> = (0..count as u32).collect();
        let planes = [&matrix[0][..], &matrix[1]];
        let mut reported = [0.0; LANES];
        for _ in 0..40 {
            let [re, im] = &mut vectors;
            reported = phases::align(set, planes, &shares, &visits, 1, [re, im], &mut Control::none())
                .expect("it is not stopped");
        }
        let scale = coupling(0, 0).re * (count * count) as f64;
        for s in 0..LANES {
            let after = energy(&vectors, s);
            assert!(after >= before[s] - 1e-5 * scale, "{set} {count}: {after} from {}", before[s]);
            // The kernel sums the energy while the vectors still change a little.
            assert!(
                (wide(reported[s]) - after).abs() <= 1e-2 * scale,
                "{set} {count}: stated {}, is {after}",
                reported[s]
            );
            for k in 0..count {
                let modulus = libm::hypot(wide(vectors[0][k * LANES + s]), wide(vectors[1][k * LANES + s]));
                assert!((modulus - wide(shares[k])).abs() < 1e-6, "{set} {count}: {modulus}");
            }
        }
    });
}
