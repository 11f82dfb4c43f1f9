//! Times autd3's crates: "call" reuses foci and buffers, "full" makes them from arrays of numbers.
//!
//! The protocol is that of `bench/workers/serve.py`: a line of JSON per request, a line of JSON per reply. The CPU time
//! of this process is measured around the calls alone.

use std::error::Error;
use std::f64::consts::TAU;
use std::io::Write;

use autd3_rs_core::common::Length;
use autd3_rs_core::common::units::{m, s};
use autd3_rs_core::geometry::{Autd3, Geometry, Point3, UnitQuaternion};
use autd3_rs_core::value::{Intensity, Phase};
use autd3_rs_pattern_holo::{
    AmplitudeTarget, GreedyOption, GsOption, GspatOption, HoloError, NaiveOption, NalgebraBackend, Pa, greedy, gs,
    gspat, naive,
};
use rustix::time::{ClockId, clock_gettime};
use serde::Deserialize;
use serde_json::json;

const METHODS: [&str; 4] = ["naive", "gs", "gspat", "greedy 16 phases"];

/// A request, without the fields of `serve.py` that this program does not need.
#[derive(Deserialize)]
struct Task {
    method: String,
    form: String,
    tiles: [usize; 2],
    sound_speed: f32,
    points: Vec<[f64; 3]>,
    pressures: Vec<f64>,
    seed: u64,
    repeat: u32,
}

/// The geometry of the boards, the order in which greedy visits transducers, and the buffers of a call.
struct Bench {
    geometry: Geometry,
    wavelength: Length,
    order: Vec<usize>,
    full: Vec<Vec<Intensity>>,
    phases: Vec<Vec<Phase>>,
    intensities: Vec<Vec<Intensity>>,
}

impl Bench {
    fn new(task: &Task) -> Self {
        let geometry = boards(task.tiles);
        let mut order: Vec<usize> = (0..geometry.num_transducers()).collect();
        fastrand::Rng::with_seed(task.seed).shuffle(&mut order);
        let mut full = geometry.intensity_buffer();
        full.iter_mut().for_each(|board| board.fill(Intensity::MAX));
        Self {
            wavelength: autd3_rs_pattern::wavelength(task.sound_speed * m / s),
            order,
            phases: geometry.phase_buffer(),
            intensities: full.clone(),
            full,
            geometry,
        }
    }

    fn foci(task: &Task) -> Vec<AmplitudeTarget> {
        let mm = |[x, y, z]: [f64; 3]| Point3::new(x as f32 * 1e3, y as f32 * 1e3, z as f32 * 1e3);
        let pairs = task.points.iter().zip(&task.pressures);
        pairs.map(|(&point, &pressure)| AmplitudeTarget { point: mm(point), amplitude: pressure as f32 * Pa }).collect()
    }

    /// Runs a method with its defaults: 100 steps, clamped amplitudes, 16 phases.
    fn call(&mut self, method: &str, foci: &[AmplitudeTarget]) -> Result<(), HoloError> {
        let Self { geometry, wavelength, order, full, phases, intensities } = self;
        macro_rules! by {
            ($method:ident, $option:ident) => {
                $method(&NalgebraBackend, geometry, foci, *wavelength, &$option::default(), phases, intensities)
            };
        }
        match method {
            "naive" => by!(naive, NaiveOption),
            "gs" => by!(gs, GsOption),
            "gspat" => by!(gspat, GspatOption),
            _ => greedy(geometry, foci, *wavelength, &*full, order, &GreedyOption::default(), phases),
        }
    }

    fn once(&mut self, task: &Task, ready: &[AmplitudeTarget]) -> Result<(), HoloError> {
        if task.form == "full" {
            self.phases = self.geometry.phase_buffer();
            self.intensities.clone_from(&self.full);
            self.call(&task.method, &Self::foci(task))
        } else {
            self.call(&task.method, ready)
        }
    }

    fn answer(&self) -> serde_json::Value {
        let played = self.phases.iter().flatten().zip(self.intensities.iter().flatten());
        let drive = played.map(|(phase, amplitude)| (TAU * f64::from(phase.0) / 256.0, f64::from(amplitude.0) / 255.0));
        let (re, im): (Vec<f64>, Vec<f64>) = drive.map(|(turn, a)| (a * turn.cos(), a * turn.sin())).unzip();
        let places = self.geometry.iter().flat_map(|board| board.positions());
        let positions: Vec<[f64; 3]> =
            places.map(|at| [at.x, at.y, at.z].map(|length| f64::from(length) * 1e-3)).collect();
        json!({ "drive": [re, im], "positions": positions })
    }
}

/// Returns the boards, x fastest, with the middle of all transducers at the origin, as in midair's preset.
fn boards([columns, rows]: [usize; 2]) -> Geometry {
    let corner = |tiles: usize, tile: usize, size: f32, sites: u32| {
        let span = (tiles - 1) as f32 * size + (sites - 1) as f32 * Autd3::PITCH_MM;
        tile as f32 * size - span / 2.0
    };
    Geometry::new((0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))).map(|(x, y)| {
        let across = corner(columns, x, Autd3::DEVICE_WIDTH, Autd3::GRID_X);
        let along = corner(rows, y, Autd3::DEVICE_HEIGHT, Autd3::GRID_Y);
        Autd3::new(Point3::new(across, along, 0.0), UnitQuaternion::identity())
    }))
}

/// Returns the CPU time of this process in ns.
fn cpu() -> i64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec * 1_000_000_000 + time.tv_nsec
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut out = std::io::stdout().lock();
    let hello = json!({ "version": "0.13.0", "methods": METHODS, "forms": ["call", "full"] });
    writeln!(out, "{hello}")?;
    out.flush()?;
    for line in std::io::stdin().lines() {
        let task: Task = serde_json::from_str(&line?)?;
        let (mut bench, ready) = (Bench::new(&task), Bench::foci(&task));
        bench.once(&task, &ready)?;
        let answer = if task.repeat == 0 {
            bench.answer()
        } else {
            let start = cpu();
            for _ in 0..task.repeat {
                bench.once(&task, &ready)?;
            }
            json!({ "ns": (cpu() - start) as f64 / f64::from(task.repeat) })
        };
        writeln!(out, "{answer}")?;
        out.flush()?;
    }
    Ok(())
}
