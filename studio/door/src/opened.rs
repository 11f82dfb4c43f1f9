//! Opened: a scene that was read, with its model and the session of its solver.

use midair::files::{self, Format, Provenance, Source};
use midair::{Complex32, Control, Error, InstructionSet, Model, Moving, Problem, Result, Scene, Session, SolveRequest};

/// A scene and its session.
pub(crate) struct Opened {
    pub(crate) scene: Scene,
    pub(crate) model: Model,
    pub(crate) session: Session,
    pub(crate) ask: SolveRequest,
    /// The frames of a scene file with `[motion]`.
    pub(crate) moving: Option<Moving>,
}

fn format(toml: bool) -> Format {
    if toml { Format::Toml } else { Format::Json }
}

impl Opened {
    /// Reads the text of a scene file.
    pub(crate) fn read(text: &[u8], toml: bool) -> Result<Self> {
        let set = InstructionSet::best();
        let (scene, moving) = files::open(text, format(toml), Source::default(), set)?;
        let model = Model::of(&scene, set);
        let session = Session::chosen(model.clone(), scene.solver.as_ref())?;
        let ask = SolveRequest::of_scene(&scene);
        Ok(Self { scene, model, session, ask, moving })
    }

    /// Moves the points of the scene, with these pressures or, if there are none, the old ones.
    pub(crate) fn set_points(&mut self, points: Vec<[f64; 3]>, pressures: Option<Vec<f64>>) -> Result<()> {
        self.moving = None;
        let mut request = self.scene.request().clone();
        request.pressures = pressures.or(request.pressures);
        self.scene = self.scene.clone().with_points(points, request)?;
        self.ask = SolveRequest::of_scene(&self.scene);
        Ok(())
    }

    /// Returns |p| of a drive at points with these targets; for a trap, that of its foci around the point.
    pub(crate) fn moduli(&self, drive: &[Complex32], points: &[[f64; 3]], targets: Option<&[f64]>) -> Result<Vec<f64>> {
        let control = &mut Control::none();
        if self.scene.signature().is_none() || drive.iter().all(|&q| q == Complex32::ZERO) {
            let field = midair::field(&self.model, drive, points, control)?;
            return Ok(field.iter().map(|p| f64::from(p.norm())).collect());
        }
        let mut request = self.scene.request().clone();
        request.pressures = targets.map(<[f64]>::to_vec).or(request.pressures);
        let problem = Problem::of_model(&self.model, points, &request, control)?;
        Ok(problem.pressures(drive, control)?.iter().map(|p| p.norm()).collect())
    }

    /// Returns the scene as the command line writes it. A motion has no other text than its own.
    pub(crate) fn write(&self, toml: bool) -> Result<String> {
        if let Some(moving) = &self.moving {
            let cure = "its points move: midair motion solves it and midair play plays it";
            return Err(Error::invalid("motion", format!("one of {} frames", moving.frames()), cure));
        }
        let version = Some(env!("CARGO_PKG_VERSION").into());
        files::write(&self.scene, format(toml), &Provenance { version, status: None })
    }

    /// Returns the problem of the scene.
    pub(crate) fn problem(&self) -> Result<Problem> {
        Problem::of_scene(&self.scene, InstructionSet::best(), &mut Control::none())
    }
}
