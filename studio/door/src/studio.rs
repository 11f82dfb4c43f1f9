//! Studio: the buffers between the page and the core, and what a page may do with a scene.

use midair::{Complex32, Control, Error, InstructionSet, Metrics, Status, bound, field};

use crate::opened::Opened;

/// One scene, its session and the buffers.
#[derive(Default)]
#[allow(missing_debug_implementations, reason = "a session has none")]
pub struct Studio {
    pub(crate) text_in: Vec<u8>,
    pub(crate) numbers_in: Vec<f64>,
    pub(crate) text: String,
    pub(crate) numbers: Vec<f64>,
    pub(crate) drive: Vec<Complex32>,
    pub(crate) pressures: Vec<Complex32>,
    pub(crate) bytes: Vec<u8>,
    /// The drives of all frames (T, N) that were followed.
    pub(crate) frames: Vec<Complex32>,
    /// What supply or modulation multiply the drive by.
    scale: f32,
    opened: Option<Opened>,
}

impl Studio {
    /// Does the work of a function: its refusal is the text.
    pub(crate) fn work(&mut self, work: impl FnOnce(&mut Self) -> Result<(), Error>) -> u32 {
        self.text.clear();
        match work(self) {
            Ok(()) => 0,
            Err(error) => {
                self.text = error.to_string();
                1
            }
        }
    }

    pub(crate) fn open(&mut self, toml: bool, scalar: bool) -> Result<(), Error> {
        let set = if scalar { InstructionSet::SCALAR } else { InstructionSet::best() };
        self.frames.clear();
        self.drive.clear();
        let opened = self.opened.insert(Opened::read(&self.text_in, toml, set)?);
        self.text = lines(opened.scene.doubts());
        Ok(())
    }

    pub(crate) fn opened(&mut self) -> Result<&mut Opened, Error> {
        self.opened.as_mut().ok_or_else(|| Error::invalid("scene", "none", "open one first"))
    }

    pub(crate) fn save(&mut self, toml: bool) -> Result<(), Error> {
        self.text = self.opened()?.write(toml)?;
        Ok(())
    }

    pub(crate) fn array(&mut self) -> Result<(), Error> {
        let array = self.opened()?.scene.array();
        let numbers = array.positions().iter().chain(array.normals()).flatten().copied().collect();
        self.numbers = numbers;
        Ok(())
    }

    pub(crate) fn solve(&mut self) -> Result<(), Error> {
        let Opened { session, ask, .. } = self.opened.as_mut().ok_or_else(none)?;
        let solution = session.solve(ask, &mut Control::none())?;
        self.drive.clear();
        self.drive.extend_from_slice(&solution.drive);
        self.scale = solution.scale as f32;
        self.numbers.clear();
        self.numbers.extend(listed(solution.metrics()));
        let status = match solution.status {
            Status::Done => 0.0,
            Status::OutOfSteps => 1.0,
            _ => 2.0,
        };
        self.numbers.extend([solution.scale, status, solution.steps as f64]);
        for (target, p) in solution.targets().iter().zip(&solution.pressures) {
            self.numbers.extend([*target, f64::from(p.re), f64::from(p.im)]);
        }
        self.text = lines(session.remarks());
        Ok(())
    }

    pub(crate) fn judge(&mut self) -> Result<(), Error> {
        let problem = self.opened()?.problem()?;
        let metrics = problem.judge(&played(&self.drive, self.scale), &mut Control::none())?;
        self.numbers = listed(metrics).to_vec();
        Ok(())
    }

    pub(crate) fn load(&mut self) -> Result<(), Error> {
        let (count, given) = (self.opened()?.scene.array().len(), self.numbers_in.as_chunks().0);
        if given.len() != count {
            let cure = format!("the array has {count} transducers: give as many");
            return Err(Error::invalid("drive", format!("{} values", given.len()), cure));
        }
        self.drive = given.iter().map(|&[re, im]| Complex32::new(re as f32, im as f32)).collect();
        self.scale = 1.0;
        Ok(())
    }

    pub(crate) fn field(&mut self) -> Result<(), Error> {
        let drive = played(&self.drive, self.scale);
        let Opened { model, .. } = self.opened.as_mut().ok_or_else(none)?;
        self.pressures = field(model, &drive, self.numbers_in.as_chunks().0, &mut Control::none())?;
        Ok(())
    }

    pub(crate) fn bound(&mut self) -> Result<(), Error> {
        let problem = self.opened()?.problem()?;
        self.numbers = vec![bound(&problem, &mut Control::none())?];
        Ok(())
    }

    /// A drive of a frame, which needs no scale.
    pub(crate) fn take(&mut self, drive: Vec<Complex32>) {
        self.drive = drive;
        self.scale = 1.0;
    }
}

fn none() -> Error {
    Error::invalid("scene", "none", "open one first")
}

fn played(drive: &[Complex32], scale: f32) -> Vec<Complex32> {
    drive.iter().map(|q| q * scale).collect()
}

fn listed(metrics: Metrics) -> [f64; 6] {
    let Metrics { accuracy, sigma, uniformity, level, residual, leak } = metrics;
    [accuracy, sigma, uniformity, level, residual, leak]
}

fn lines(said: impl IntoIterator<Item = impl ToString>) -> String {
    said.into_iter().map(|line| line.to_string()).collect::<Vec<_>>().join("\n")
}
