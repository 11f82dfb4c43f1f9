//! The Python binding: NumPy in, NumPy out, the GIL released. It reads arguments and calls the core once.

#![allow(clippy::too_many_arguments, reason = "they are keywords in Python")]

mod array;
mod batch;
mod bead;
mod bodies;
mod chosen;
mod codec;
mod ctrl_c;
mod draw;
mod error;
mod field;
mod files;
mod flight;
mod function;
mod getters;
mod give;
mod gorkov;
mod gradient;
mod judge;
mod keywords;
mod limits;
mod mesh;
mod metrics;
mod motion;
mod moving;
mod names;
mod node;
mod numbers;
mod out;
mod parts;
mod path;
mod pickle;
mod plane;
mod points;
mod prelude;
mod propagation;
mod quantization;
mod read;
mod ready;
mod scene;
mod setting;
mod signature;
mod skin;
mod solution;
mod solve;
mod solver;
mod solvers;
mod subject;
mod toolbox;

use pyo3::prelude::*;

/// The compiled core of midair; import `midair` instead.
#[pymodule]
mod _midair {
    use midair::touch;
    use numpy::PyArray1;
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::{
        array::{Array, PresetInfo, directivities, presets},
        batch::{Batch, solve_batch},
        bead::Bead,
        bodies::bodies,
        codec::Codec,
        error::{SceneError, SceneWarning, restated, stated, unknown_name},
        field::{Field, field},
        files::{drive_from_csv, drive_to_csv, placed, read_sweep, scene_files, scene_keys, sweep_keys, table},
        flight::{Course, Response},
        gorkov::{Gorkov, Rest, gorkov, rest},
        gradient::gradient,
        judge::{bound, judge},
        limits::memory_limit,
        mesh::{Boundary, Mesh},
        metrics::{BatchMetrics, Metrics},
        motion::Motion,
        moving::{Horizon, Moving, bound_of, check_together, frame_rate, paced},
        names::{nearest, preset_name, solver_name},
        numbers::checked,
        parts::array_parts,
        path::Path,
        plane::Plane,
        points::{along, rotation, shape_points},
        propagation::Propagation,
        scene::{Reach, Scene},
        skin::{
            Membrane, Pushes, Shifted, decibels, demodulate, excess, felt_width, hand, live_lines, steady, strength,
            threshold,
        },
        solution::{Solution, about},
        solve::solve,
        solver::Solver,
        solvers::{OptionInfo, SolverInfo, solvers},
        toolbox::register,
    };

    /// Felt force over the force that the channel of pressure passes, fitted once.
    #[pymodule_export]
    const GAIN: f64 = touch::GAIN;

    /// Highest frequency in Hz that the model of the skin counts.
    #[pymodule_export]
    const HIGHEST: f64 = touch::HIGHEST;

    /// Distance in m over which the slow channel senses the slope of the skin.
    #[pymodule_export]
    const REACH: f64 = touch::REACH;

    /// The membrane of a fingertip: wave speed in m/s, loss factor and mass in kg/m^2.
    #[pymodule_export]
    const SKIN: (f64, f64, f64) = (touch::Membrane::SKIN[0], touch::Membrane::SKIN[1], touch::Membrane::SKIN[2]);

    /// Default distance in m between points of a shape.
    #[pymodule_export]
    const STEP: f64 = midair::points::STEP;

    /// Largest number of points of a shape.
    #[pymodule_export]
    const MOST_POINTS: usize = midair::points::MOST;

    /// Largest coordinate of a point in m.
    #[pymodule_export]
    const FARTHEST: f64 = midair::points::FARTHEST;

    /// The first array makes the numpy crate import NumPy, which panics if Ctrl-C comes at that moment. Making one array
    /// during the import of midair avoids this, because an import may be interrupted.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        super::bodies::add_bodies(module)?;
        super::error::add_parts(module.py())?;
        module.py().import("numpy")?;
        PyArray1::<f64>::zeros(module.py(), 0, false);
        Ok(())
    }
}
