//! Options of a session by name: medium, bead, transducers, mask, quantization, and those of the method.

use midair::solvers::{DEFAULT, find};
use midair::{
    Aim, Array, Bead, Board, Choice, Complex64, Directivity, Error, ErrorCode, Extras, InstructionSet, Medium, Model,
    OptionValue, Options, PartKind, PartValue, Quantization, Result, Scene, Session, Transducer, Value, word,
};

/// A value that a C program passes.
#[derive(Clone, Copy)]
pub(crate) enum Input<'a> {
    Text(&'a str),
    Number(f64),
    Numbers(&'a [f64]),
}

/// The settings of a session: its array, medium, obstacles and method.
#[derive(Clone)]
pub(crate) struct Setting {
    array: Array,
    /// `before` is the medium of the scene from which the session was made, if any. `given` has the keys set since then.
    /// `medium` is the result of both.
    before: Option<Medium>,
    keys: Vec<(&'static str, f64)>,
    medium: Medium,
    extras: Extras,
    choice: Choice,
}

impl Setting {
    /// Returns the settings for an array with its default medium, and a method by its name.
    pub(crate) fn new(array: Array, method: &str) -> Result<Self> {
        let choice = Choice::new(find(method)?.info.name.into(), Options::new())?;
        let (medium, keys) = (array.medium(&[])?, Vec::new());
        Ok(Self { array, before: None, keys, medium, extras: Extras::default(), choice })
    }

    /// Returns the settings of a scene: its array, medium, obstacles and method.
    pub(crate) fn of_scene(scene: &Scene) -> Result<Self> {
        let default = || Choice::new(DEFAULT.into(), Options::new());
        Ok(Self {
            array: scene.array().clone(),
            before: Some(scene.medium()),
            keys: Vec::new(),
            medium: scene.medium(),
            extras: scene.extras(),
            choice: scene.solver.clone().map_or_else(default, Ok)?,
        })
    }

    /// Makes the model and the session.
    pub(crate) fn open(&self) -> Result<(Model, Session)> {
        let set: InstructionSet = InstructionSet::requested()?;
        let Extras { signature, bead, obstacles, solver: _, plane: _ } = self.extras.clone();
        let model = Model::new(&self.array, self.medium, set)?.with_signature(signature).with_bead(bead);
        let model = if obstacles.is_empty() { model } else { model.with_obstacles(&obstacles)? };
        let session = Session::chosen(model.clone(), Some(&self.choice)).map_err(with_own_names)?;
        Ok((model, session))
    }

    /// Returns the boards of this kind for the array.
    pub(crate) fn board(&self, kind: &str) -> Result<Board> {
        self.array.board(kind)
    }

    /// Returns the aim, if it was set; `None` stands for the aim of the request.
    pub(crate) fn aim(&self) -> Option<Aim> {
        self.choice.aim
    }

    /// Returns probable mistakes in array and medium, one line for each.
    pub(crate) fn doubts(&self) -> Vec<String> {
        self.array.doubts(self.medium).iter().map(ToString::to_string).collect()
    }

    /// Sets an option, or replaces its earlier value.
    pub(crate) fn set(&mut self, name: &str, input: Input<'_>) -> Result<()> {
        let value = |item: &str| input.number(item);
        if let Some(law) = name.strip_prefix("directivity.") {
            let law = Directivity::named(law, Some(value(&format!("directivity.{law}"))?))?;
            let transducer = Transducer { directivity: law, ..self.array.transducer() };
            self.array = self.array.clone().with_transducer(transducer)?;
            return Ok(());
        }
        if let Some(key) = Medium::key(name) {
            return self.breathe(key.name, value(&format!("medium.{}", key.name))?);
        }
        if let Some(key) = name.strip_prefix("bead.") {
            return self.weigh(key, input);
        }
        let Some(part) = Array::part(name) else { return self.choose(name, input) };
        let value = input.part(&format!("array.{}", part.name), part.kind())?;
        self.array = part.put(self.array.clone(), value)?;
        Ok(())
    }

    /// Sets a key of the medium. Sound speed and temperature replace each other; the last one counts.
    fn breathe(&mut self, key: &'static str, value: f64) -> Result<()> {
        let instead = |other: &str| [[key, other], [other, key]].contains(&["sound_speed", "temperature"]);
        let mut keys = self.keys.clone();
        keys.retain(|(other, _)| *other != key && !instead(other));
        keys.push((key, value));
        self.medium = self.before.map_or_else(|| self.array.medium(&keys), |scene| scene.with(&keys))?;
        self.keys = keys;
        Ok(())
    }

    /// Sets a key of the bead.
    fn weigh(&mut self, key: &str, input: Input<'_>) -> Result<()> {
        let (item, bead) = (format!("bead.{key}"), self.extras.bead);
        self.extras.bead = if key == "gravity" {
            let list = input.numbers(&item)?;
            let wrong = |_| Error::invalid(&*item, format!("{} numbers", list.len()), "give x, y and z in m/s^2");
            bead.with(&[], Some(list.try_into().map_err(wrong)?))?
        } else {
            bead.with(&[(key, input.number(&item)?)], None)?
        };
        Ok(())
    }

    /// Sets an option of the method.
    fn choose(&mut self, name: &str, input: Input<'_>) -> Result<()> {
        let value = input.value(name)?;
        let one = Choice::new(self.choice.name.clone(), [(name.into(), value)].into())?;
        self.choice.options.extend(find(&one.name)?.spelled(&one.options)?);
        self.choice.balance = one.balance.or(self.choice.balance);
        self.choice.aim = one.aim.or(self.choice.aim);
        Ok(())
    }
}

/// Adds the names of options of the session to an error about an unknown option of the method.
fn with_own_names(mut error: Error) -> Error {
    if error.code != ErrorCode::Unknown {
        return error;
    }
    let with_parameter = Directivity::all().filter(|directivity| directivity.parameter().is_some());
    let laws: Vec<String> = with_parameter.map(|directivity| format!("directivity.{}", directivity.name().0)).collect();
    let beads: Vec<String> = Bead::KEYS.iter().map(|key| format!("bead.{}", key.name)).collect();
    let all = Medium::KEYS.iter().map(|key| key.name).chain(Array::PARTS.iter().map(|part| part.name));
    let names: Vec<&str> = all.chain(laws.iter().chain(&beads).map(String::as_str)).chain(["balance", "aim"]).collect();
    if error.hint.is_empty() {
        let hinted = Error::unknown("", &*error.value, names.iter().copied());
        error.hint.clone_from(&hinted.hint);
    }
    error.cure = format!("{}, {}", error.cure, names.join(", "));
    error
}

/// Returns a number as an integer if it is whole, and within the range in which f64 contains all whole numbers.
fn whole(number: f64) -> Option<i64> {
    (number.fract() == 0.0 && number.abs() <= 9_007_199_254_740_992.0).then_some(number as i64)
}

impl Input<'_> {
    /// Returns the value as an option of a method.
    fn value(self, item: &str) -> Result<Value> {
        Ok(match self {
            Self::Text("true") => Value::Bool(true),
            Self::Text("false") => Value::Bool(false),
            Self::Text(text) => Value::Text(text.into()),
            Self::Number(number) => whole(number).map_or(Value::Real(number), |whole| Value::Integer(whole.into())),
            Self::Numbers(list) => Value::Integers(entries(item, list, "give whole numbers", whole)?),
        })
    }

    /// Returns the value as a part of the array. For a quantization it is the name of a board, or "none".
    fn part(self, item: &str, kind: PartKind) -> Result<PartValue> {
        Ok(match kind {
            PartKind::Real => PartValue::Real(self.number(item)?),
            PartKind::Directivity => PartValue::Directivity(Directivity::named(self.text(item)?, None)?),
            PartKind::Complexes => PartValue::Complexes(self.complexes(item)?),
            PartKind::Flags => PartValue::Flags(self.flags(item)?),
            PartKind::Indices => PartValue::Indices(self.indices(item)?),
            PartKind::Quantization => {
                let board = self.text(item)?;
                let none = word(item, &Value::Text(board.into()), &[("none", ())]).is_ok();
                let steps = if none { Quantization::new(None, None) } else { Board::new(board, 1)?.quantization() };
                PartValue::Quantization(steps?)
            }
        })
    }

    fn number(self, item: &str) -> Result<f64> {
        match self {
            Self::Text(text) => Err(Error::new(ErrorCode::Type, item, text, "set it with midair_session_set_number")),
            _ => f64::read(item, &self.value(item)?),
        }
    }

    fn text(&self, item: &str) -> Result<&str> {
        match self {
            Self::Text(text) => Ok(text),
            _ => Err(Error::new(ErrorCode::Type, item, "no text", "set it with midair_session_set_text")),
        }
    }

    fn numbers(&self, item: &str) -> Result<&[f64]> {
        match self {
            Self::Numbers(list) => Ok(list),
            _ => Err(Error::new(ErrorCode::Type, item, "no list", "set it with midair_session_set_numbers")),
        }
    }

    fn flags(&self, item: &str) -> Result<Vec<bool>> {
        let flag = |number| (number == 0.0 || number == 1.0).then_some(number == 1.0);
        entries(item, self.numbers(item)?, "give 0 for off or 1 for on", flag)
    }

    fn indices(&self, item: &str) -> Result<Vec<usize>> {
        let index = |number| whole(number).and_then(|whole| usize::try_from(whole).ok());
        entries(item, self.numbers(item)?, "give whole numbers of 0 or above", index)
    }

    fn complexes(&self, item: &str) -> Result<Vec<Complex64>> {
        let (pairs, rest) = self.numbers(item)?.as_chunks();
        if !rest.is_empty() {
            let count = 2 * pairs.len() + 1;
            return Err(Error::invalid(item, format!("{count} numbers"), "give re and im of each transducer"));
        }
        Ok(pairs.iter().map(|&[re, im]| Complex64::new(re, im)).collect())
    }
}

/// Converts each number of a list by `read`; `cure` is the cure in the error for a number that `read` rejects.
fn entries<T>(item: &str, list: &[f64], cure: &str, read: impl Fn(f64) -> Option<T>) -> Result<Vec<T>> {
    let refused = |i, number| Error::invalid(format!("{item}[{i}]"), format_args!("{number:?}"), cure);
    list.iter().enumerate().map(|(i, &number)| read(number).ok_or_else(|| refused(i, number))).collect()
}
