//! Studio: the buffers between the page and the core, and the page's operations on a scene.

use midair::files::{read_array, read_drive, write_drive};
use midair::flight::Course;
use midair::touch::Touch;
use midair::{Array, Complex32, Control, Error, Moving, Notice, Precision, Result, bound, spl};
use serde_json::{Value, json};

use crate::lattices::Lattices;
use crate::opened::Opened;

/// One scene, its session and the buffers.
#[derive(Default)]
pub struct Studio {
    pub(crate) text_in: Vec<u8>,
    pub(crate) numbers_in: Vec<f64>,
    pub(crate) text: String,
    pub(crate) numbers: Vec<f64>,
    pub(crate) drive: Vec<Complex32>,
    pub(crate) pressures: Vec<Complex32>,
    pub(crate) bytes: Vec<u8>,
    /// The drives (T, N) of all frames that `follow` has solved.
    pub(crate) frames: Vec<Complex32>,
    /// The motion of the skin under these frames, once it was predicted.
    pub(crate) touch: Option<Touch>,
    /// Their points (T, M, 3) in m; and their knots in time, made for the first bead.
    pub(crate) places: Vec<[f64; 3]>,
    pub(crate) course: Option<Course>,
    /// The factor that the supply voltage or modulation must apply to the drive.
    scale: f32,
    opened: Option<Opened>,
    lattices: Lattices,
}

impl Studio {
    /// Returns the address of a result, by the number that [`crate::studio_result`] explains, and its number of entries.
    pub(crate) fn result(&self, kind: u32) -> (*const u8, usize) {
        match kind {
            0 => (self.text.as_ptr(), self.text.len()),
            1 => (self.numbers.as_ptr().cast(), self.numbers.len()),
            2 => (self.drive.as_ptr().cast(), self.drive.len()),
            3 => (self.pressures.as_ptr().cast(), self.pressures.len()),
            _ => (self.bytes.as_ptr(), self.bytes.len()),
        }
    }

    /// Runs the work of a function; writes its error to the text and returns 1 if it fails, else returns 0.
    pub(crate) fn work(&mut self, work: impl FnOnce(&mut Self) -> Result<()>) -> u32 {
        self.text.clear();
        match work(self) {
            Ok(()) => 0,
            Err(error) => {
                self.text = notice(&error).to_string();
                1
            }
        }
    }

    pub(crate) fn open(&mut self, toml: bool) -> Result<()> {
        self.frames.clear();
        self.touch = None;
        self.course = None;
        self.drive.clear();
        let opened = self.opened.insert(Opened::read(&self.text_in, toml)?);
        let moving = opened.moving.iter().flat_map(Moving::doubts);
        self.text = notices(opened.scene.doubts().into_iter().chain(moving)).to_string();
        Ok(())
    }

    pub(crate) fn opened(&mut self) -> Result<&mut Opened> {
        self.opened.as_mut().ok_or_else(|| Error::invalid("scene", "none", "open one first"))
    }

    pub(crate) fn save(&mut self, toml: bool) -> Result<()> {
        self.text = self.opened()?.write(toml)?;
        Ok(())
    }

    pub(crate) fn array(&mut self) -> Result<()> {
        self.numbers = placed(self.opened()?.scene.array());
        Ok(())
    }

    pub(crate) fn read_array(&mut self) -> Result<()> {
        let (name, text) = self.named();
        let array = read_array(text, &name)?;
        if let Some(doubt) = array.doubts(array.medium(&[])?).first() {
            return Err(Error::of(doubt.clone()).inside(name));
        }
        self.numbers = placed(&array);
        Ok(())
    }

    pub(crate) fn read_drive(&mut self) -> Result<()> {
        let (name, text) = self.named();
        let drive = read_drive(text, &name)?;
        self.take(drive);
        Ok(())
    }

    pub(crate) fn write_drive(&mut self) -> Result<()> {
        let array = self.opened.as_ref().ok_or_else(none)?.scene.array();
        self.text = write_drive(Some(array.positions()), &self.drive);
        Ok(())
    }

    /// Returns the first line of the text buffer, which is the name of a file, and the file's content after it.
    fn named(&self) -> (String, &[u8]) {
        let end = self.text_in.iter().position(|&byte| byte == b'\n').unwrap_or(self.text_in.len());
        let text = self.text_in.get(end + 1..).unwrap_or_default();
        (String::from_utf8_lossy(&self.text_in[..end]).into_owned(), text)
    }

    pub(crate) fn solve(&mut self) -> Result<()> {
        let Opened { session, ask, .. } = self.opened.as_mut().ok_or_else(none)?;
        let solution = session.solve(ask, &mut Control::none())?;
        self.drive.clear();
        self.drive.extend_from_slice(&solution.drive);
        self.scale = solution.scale as f32;
        self.numbers.clear();
        self.numbers.extend(solution.metrics().values());
        self.numbers.extend([solution.scale, solution.steps as f64]);
        let status = solution.status.name();
        for (target, p) in solution.targets().iter().zip(&solution.pressures) {
            self.numbers.extend([*target, f64::from(p.re), f64::from(p.im)]);
        }
        let said = notices(session.remarks().map(|remark| remark.notice()));
        self.text = json!({ "status": status, "said": said }).to_string();
        Ok(())
    }

    pub(crate) fn set_points(&mut self, points: usize) -> Result<()> {
        let given = core::mem::take(&mut self.numbers_in);
        let (places, pressures) = given.split_at_checked(3 * points).unwrap_or((&given, &[]));
        let pressures = (!pressures.is_empty()).then(|| pressures.to_vec());
        self.opened()?.set_points(places.as_chunks().0.to_vec(), pressures)
    }

    pub(crate) fn judge(&mut self) -> Result<()> {
        let problem = self.opened()?.problem()?;
        let (drive, control) = (played(&self.drive, self.scale), &mut Control::none());
        self.numbers = problem.judge(&drive, Precision::Double, control)?.values().to_vec();
        self.pressures =
            problem.pressures(&drive, control)?.iter().map(|p| Complex32::new(p.re as f32, p.im as f32)).collect();
        Ok(())
    }

    pub(crate) fn load(&mut self, scale: f32) -> Result<()> {
        let (count, given) = (self.opened()?.scene.array().len(), self.numbers_in.as_chunks().0);
        if given.len() != count {
            let cure = format!("the array has {count} transducers: give as many");
            return Err(Error::invalid("drive", format!("{} values", given.len()), cure));
        }
        if let Some(at) = self.numbers_in.iter().position(|part| !part.is_finite()) {
            return Err(Error::not_finite(format!("drive[{}]", at / 2), self.numbers_in[at]));
        }
        if !(0.0..=f32::MAX).contains(&scale) {
            return Err(Error::out_of_range("scale", scale, "give a finite number of at least 0"));
        }
        self.drive = given.iter().map(|&[re, im]| Complex32::new(re as f32, im as f32)).collect();
        self.scale = scale;
        Ok(())
    }

    pub(crate) fn field(&mut self) -> Result<()> {
        let drive = played(&self.drive, self.scale);
        let Opened { model, .. } = self.opened.as_mut().ok_or_else(none)?;
        self.pressures = self.lattices.field(model, &drive, self.numbers_in.as_chunks().0)?;
        Ok(())
    }

    pub(crate) fn probe(&mut self) -> Result<()> {
        self.field()?;
        let medium = self.opened.as_ref().ok_or_else(none)?.scene.medium();
        self.numbers.clear();
        for p in &self.pressures {
            let peak = f64::from(p.norm());
            self.numbers.extend([f64::from(p.re), f64::from(p.im), spl(peak), medium.radiation(peak)]);
        }
        Ok(())
    }

    pub(crate) fn bound(&mut self) -> Result<()> {
        let problem = self.opened()?.problem()?;
        self.numbers = vec![bound(&problem, &mut Control::none())?];
        Ok(())
    }

    /// Sets the drive of a frame, which needs no scale.
    pub(crate) fn take(&mut self, drive: Vec<Complex32>) {
        self.drive = drive;
        self.scale = 1.0;
    }
}

/// Returns the positions, then the normals.
fn placed(array: &Array) -> Vec<f64> {
    array.positions().iter().chain(array.normals()).flatten().copied().collect()
}

fn none() -> Error {
    Error::invalid("scene", "none", "open one first")
}

fn played(drive: &[Complex32], scale: f32) -> Vec<Complex32> {
    drive.iter().map(|q| q * scale).collect()
}

/// Returns errors or warnings as JSON, with the names of `Notice` in studio/src/state/notice.ts.
fn notices(all: impl IntoIterator<Item = Notice>) -> Value {
    all.into_iter().map(|each| notice(&each)).collect()
}

fn notice(given: &Notice) -> Value {
    let Notice { code, place, item, value, cure, other, index, .. } = given;
    let mut plain = given.clone();
    plain.place.clear();
    plain.example.clear();
    json!({
        "code": code.name(),
        "text": given.to_string(),
        "plain": plain.to_string(),
        "place": place,
        "put": { "item": item, "value": value, "cure": cure, "other": other, "point": index.map(|index| index + 1) },
    })
}
