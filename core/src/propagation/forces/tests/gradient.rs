//! Tests of `gradient` by central differences in double precision. Their p = G q is summed over the transducers in plain loops.

use super::*;
use crate::rng::Rng;
use crate::scene::{Array, Directivity, Particle, Surface, Transducer};

/// The steps of the differences: for lengths in m, for drives and normals, and for the sound speed in m/s. They are small,
/// because the second derivatives of measured directivities jump.
const STEPS: [f64; 3] = [1e-6, 1e-5, 1e-3];

/// The largest allowed error of a gradient, relative to the largest number of the same gradient.
const WORST: f64 = 1e-5;

/// All inputs that a value depends on.
#[derive(Clone)]
struct Setting {
    positions: Vec<[f64; 3]>,
    normals: Vec<[f64; 3]>,
    directivity: Directivity,
    response: Vec<Complex64>,
    medium: Medium,
    walls: Vec<Obstacle>,
    drive: Vec<Complex64>,
    points: Vec<[f64; 3]>,
}

impl Setting {
    /// Returns the random scene number `seed`. The seed also selects the directivity, the absorption and the number
    /// of walls (0 to 2).
    fn random(seed: usize) -> Self {
        let mut rng = Rng::new(seed as u64);
        let mut uniform = move || 2.0 * rng.uniform() - 1.0;
        let laws: Vec<_> = Directivity::all()
            .chain([
                Directivity::piston(11e-3),
                Directivity::sinc(2e-3),
                Directivity::cos(2.0),
                Directivity::piston(60e-3),
            ])
            .collect();
        let count = 5 + seed % 13;
        let mut vectors = |count: usize, size: [f64; 3], at: f64| -> Vec<[f64; 3]> {
            (0..count).map(|_| [size[0] * uniform(), size[1] * uniform(), at + size[2] * uniform()]).collect()
        };
        let positions = vectors(count, [0.08, 0.08, 0.01], 0.0);
        let normals = vectors(count, [0.4, 0.4, 0.2], 1.0);
        let points = vectors(1 + seed % 4, [0.06, 0.06, 0.05], 0.15);
        let complex = |of: &[[f64; 3]]| of.iter().map(|v| Complex64::new(v[0], v[1])).collect::<Vec<_>>();
        let (drive, response) = (complex(&vectors(count, [0.7; 3], 0.0)), complex(&vectors(count, [1.2; 3], 0.0)));
        let [[frequency, speed, absorption]] = vectors(1, [3e3, 20.0, 0.1], 0.12)[..] else { unreachable!() };
        let absorption = if seed.is_multiple_of(2) { absorption } else { 0.0 };
        let medium =
            Medium { frequency: 40e3 + frequency, sound_speed: 340.0 + speed, absorption, ..Medium::default() };
        let wall = |point, normal, kind| Obstacle::Wall { point, normal, kind };
        let walls = [
            wall([0.13, 0.0, 0.0], [-1.0, 0.0, 0.0], Surface::Rigid),
            wall([0.0, 0.0, 0.4], [0.0, 0.0, 1.0], Surface::Soft),
        ];
        let walls = walls[..seed / 3 % 3].to_vec();
        Self { positions, normals, directivity: laws[seed % laws.len()], response, medium, walls, drive, points }
    }

    fn model(&self) -> Model {
        let array = Array::new(self.positions.clone(), Some(self.normals.clone())).expect("an array");
        let transducer = Transducer { directivity: self.directivity, ..Transducer::default() };
        let array =
            array.with_transducer(transducer).and_then(|array| array.with_response(Some(self.response.clone())));
        let array = array.expect("transducers");
        let model = Model::new(&array, self.medium, InstructionSet::best()).expect("a model");
        model.with_obstacles(&self.walls).expect("walls")
    }

    /// The scalar L whose gradient is tested.
    fn value(&self, quantity: Quantity, cotangent: &[f64]) -> f64 {
        if let Some(particle) = quantity.particle() {
            return self.of_particle(quantity, particle, cotangent);
        }
        let g = self.model().propagation(&self.points).expect("points");
        let mut sum = 0.0;
        for (j, cotangent) in cotangent.chunks(quantity.width()).enumerate() {
            let p: Complex64 = self.drive.iter().enumerate().map(|(i, q)| g.exact(j, i) * q).sum();
            sum += match quantity {
                Quantity::Pressure => cotangent[0] * p.re + cotangent[1] * p.im,
                Quantity::Amplitude => cotangent[0] * p.norm(),
                Quantity::Radiation => {
                    cotangent[0] * p.norm_sqr() / (self.medium.density * self.medium.sound_speed.powi(2))
                }
                _ => unreachable!("gorkov computes what a particle feels"),
            };
        }
        sum
    }

    /// L from `gorkov`. This function takes drives in single precision, so the drives are given as the array's
    /// responses.
    fn of_particle(&self, quantity: Quantity, particle: Particle, cotangent: &[f64]) -> f64 {
        let count = self.drive.len();
        let mut array = self.model().array().clone();
        let played: Vec<Complex64> = (0..count).map(|i| self.response[i] * self.drive[i]).collect();
        array = array.with_response(Some(played)).expect("drives");
        let model = Model::new(&array, self.medium, InstructionSet::best()).expect("a model");
        let model = model.with_obstacles(&self.walls).expect("walls");
        let ones = vec![crate::Complex32::ONE; count];
        let trap = crate::gorkov(&model, &ones, &self.points, particle, &mut Control::none()).expect("forces");
        let each = |j: usize| -> f64 {
            let (cotangent, h) = (&cotangent[j * quantity.width()..], trap.hessian[j]);
            match quantity {
                Quantity::Potential(_) => cotangent[0] * trap.potential[j],
                Quantity::Force(_) => (0..3).map(|axis| cotangent[axis] * trap.force[j][axis]).sum(),
                _ => (0..3).map(|axis| cotangent[axis] * h[axis][axis]).sum(),
            }
        };
        (0..self.points.len()).map(each).sum()
    }

    /// The central difference of L, of fourth order, where `change` moves one input.
    fn difference(&self, quantity: Quantity, cotangent: &[f64], step: f64, change: impl Fn(&mut Self, f64)) -> f64 {
        let at = |by: f64| {
            let mut moved = self.clone();
            change(&mut moved, by);
            moved.value(quantity, cotangent)
        };
        (8.0 * (at(step) - at(-step)) - (at(2.0 * step) - at(-2.0 * step))) / (12.0 * step)
    }
}

/// The largest difference between found and wanted numbers, relative to the largest wanted one.
fn off(value: &[f64], exact: &[f64]) -> f64 {
    let most = exact.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let far = value.iter().zip(exact).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
    assert_eq!(value.len(), exact.len());
    if far == 0.0 { 0.0 } else { far / most }
}

/// The largest error of each gradient of a quantity over some scenes.
fn worst(quantity: Quantity, seeds: core::ops::Range<usize>) -> [f64; 5] {
    let mut worst = [0.0_f64; 5];
    for seed in seeds {
        let setting = Setting::random(seed);
        let mut rng = Rng::new(seed as u64 + 1000);
        let cotangent: Vec<f64> = (0..setting.points.len() * quantity.width()).map(|_| rng.uniform() - 0.3).collect();
        let control = &mut Control::none();
        let by = gradient(&setting.model(), &setting.drive, &setting.points, quantity, &cotangent, control);
        let by = by.expect("a gradient");
        let difference =
            |step, change: &dyn Fn(&mut Setting, f64)| setting.difference(quantity, &cotangent, step, change);
        let each = |count: usize, step: f64, change: fn(&mut Setting, usize, usize, f64)| -> Vec<f64> {
            let slope = |(i, axis): (usize, usize)| difference(step, &|setting, by| change(setting, i, axis, by));
            (0..count).flat_map(|i| [(i, 0), (i, 1), (i, 2)]).map(slope).collect()
        };
        let [length, number, speed] = STEPS;
        let parts = |i: usize| {
            let re = difference(number, &|setting, by| setting.drive[i].re += by);
            [re, difference(number, &|setting, by| setting.drive[i].im += by)]
        };
        let count = setting.drive.len();
        let drive: Vec<f64> = (0..count).flat_map(parts).collect();
        let by_drive = by.drive.iter().flat_map(|q| [q.re, q.im]).collect::<Vec<_>>();
        let points = each(setting.points.len(), length, |setting, j, axis, by| setting.points[j][axis] += by);
        let positions = each(count, length, |setting, i, axis, by| setting.positions[i][axis] += by);
        // Derivatives by the unit normals, which the array computes from the given normals.
        let mut unit = setting.clone();
        unit.normals = setting.model().array().normals().to_vec();
        let turned = |i: usize, axis: usize| {
            unit.difference(quantity, &cotangent, number, |setting, by| setting.normals[i][axis] += by)
        };
        let normals: Vec<f64> = (0..count).flat_map(|i| [0, 1, 2].map(|axis| turned(i, axis))).collect();
        let sound = [difference(speed, &|setting, by| setting.medium.sound_speed += by)];
        let pairs = [
            (by_drive, drive),
            (by.points.as_flattened().to_vec(), points),
            (by.positions.as_flattened().to_vec(), positions),
            (by.normals.as_flattened().to_vec(), normals),
            (vec![by.sound_speed], sound.to_vec()),
        ];
        for (k, (value, exact)) in pairs.iter().enumerate() {
            let off = off(value, exact);
            assert!(off < WORST, "scene {seed}, {quantity:?}, gradient {k}, {:?}: {off:e}", setting.directivity);
            worst[k] = worst[k].max(off);
        }
    }
    worst
}

/// All quantities, for a bead that is heavy enough to move less than the air.
fn all() -> [Quantity; 6] {
    let bead = Particle { radius: 0.8e-3, density: 100.0, sound_speed: 1100.0 };
    ["pressure", "amplitude", "radiation", "gorkov", "force", "stiffness"]
        .map(|name| Quantity::named(name, bead).expect("a quantity"))
}

#[test]
fn gradients_are_central_differences() {
    for quantity in all() {
        worst(quantity, 0..12);
    }
}

#[test]
#[ignore = "slow"]
fn gradients_are_central_differences_in_fifty_scenes() {
    for quantity in all() {
        worst(quantity, 12..50);
    }
}

#[test]
#[ignore = "slow"]
fn gradients_are_central_differences_in_two_hundred_scenes_at_length() {
    for quantity in all() {
        println!(
            "{quantity:?}: drive, points, positions, normals, sound speed {:?}",
            worst(quantity, 0..200).map(|x| format!("{x:.1e}"))
        );
    }
}

#[test]
fn bits_are_those_of_every_instruction_set_and_number_of_threads() {
    let setting = Setting::random(4);
    // There are so many points that a second thread is used.
    let count = (SPREAD / setting.drive.len() + 1) as u32;
    let points: Vec<[f64; 3]> = (0..count).map(|k| [0.001 * f64::from(k % 61), -0.02, 0.15]).collect();
    let cotangent: Vec<f64> = (0..count).map(|k| f64::from(k % 7) - 2.0).collect();
    let model = setting.model();
    let of = |set, threads: usize| {
        let mut control = Control::none().with_threads(threads);
        let mut model = model.clone();
        model.set = set;
        gradient(&model, &setting.drive, &points, Quantity::Radiation, &cotangent, &mut control).expect("a gradient")
    };
    let one = of(InstructionSet::best(), 1);
    for set in InstructionSet::all() {
        assert_eq!(of(set, 2), one);
    }
    let alone = Quantity::Radiation.value(&model, &setting.drive, &points, &mut Control::none());
    assert_eq!(alone.expect("values"), one.value);
}

#[test]
fn what_has_no_gradient_is_refused() {
    let setting = Setting::random(1);
    let refused = |setting: &Setting, cotangent: &[f64]| {
        let control = &mut Control::none();
        let by = gradient(&setting.model(), &setting.drive, &setting.points, Quantity::Amplitude, cotangent, control);
        by.expect_err("a refusal").to_string()
    };
    assert_eq!(refused(&setting, &[1.0]), "cotangent is 1 numbers: give one for each of the 2 numbers of the value");
    assert_eq!(refused(&setting, &[1.0, f64::NAN]), "cotangent[1] is NaN: give finite numbers");
    let mut near = setting.clone();
    near.points[1] = near.positions[3];
    assert!(refused(&near, &[1.0; 2]).starts_with("points[1] is 0.000e0 m from transducer 3"));
    let mut sphere = setting.clone();
    sphere.walls = vec![Obstacle::Sphere { center: [0.0, 0.0, 0.3], radius: 5e-3, kind: Surface::Rigid }];
    assert_eq!(
        refused(&sphere, &[1.0; 2]),
        "obstacles[0] is a sphere: gradients are known beside walls alone: leave it out"
    );
}
