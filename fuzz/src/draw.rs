//! Draw: makes numbers, arrays, media, points, requests and solvers from a fuzzer's bytes: mostly usual, sometimes odd ones.

use arbitrary::Unstructured;
use midair::solvers::{Configured, SOLVERS};
use midair::{
    Aim, Array, Complex32, Complex64, Directivity, Error, Medium, Options, Parameter, Quantization, Request, Start,
    Transducer, Value,
};

/// Numbers at which arithmetic or a check may fail.
const ODD: [f64; 16] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    f64::MIN_POSITIVE,
    5e-324,
    1e-30,
    1e-15,
    1e15,
    1e30,
    0.5,
    2.0,
];

/// Words that some option accepts, and one that none accepts.
const WORDS: [&str; 12] =
    ["clamp", "normalize", "full", "l1", "l2", "random", "rows", "columns", "raw", "unit", "target", "none"];

/// Reads a fuzzer's bytes as the inputs of a test. After the last byte, all values are 0.
pub struct Draw<'a>(Unstructured<'a>);

impl<'a> Draw<'a> {
    /// Returns a reader at the first byte.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self(Unstructured::new(bytes))
    }

    /// Whether bytes are left.
    pub fn more(&self) -> bool {
        !self.0.is_empty()
    }

    /// Returns a whole number from `low` to `high`.
    pub fn whole(&mut self, low: usize, high: usize) -> usize {
        self.0.int_in_range(low..=high).unwrap_or(low)
    }

    /// Returns true or false.
    pub fn flag(&mut self) -> bool {
        self.byte() & 1 == 1
    }

    /// Returns a value or `None`.
    pub fn maybe<T>(&mut self, draw: impl FnOnce(&mut Self) -> T) -> Option<T> {
        self.flag().then(|| draw(self))
    }

    /// Returns one entry of a list.
    pub fn one<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.whole(0, list.len() - 1)]
    }

    /// Returns a number of the order of `scale`; one number in fifty is from `ODD` or arbitrary.
    pub fn real(&mut self, scale: f64) -> f64 {
        match self.byte() {
            255 => f64::from_bits(self.0.arbitrary().unwrap_or(0)),
            250..=254 => self.one(&ODD),
            _ => scale * f64::from(self.0.arbitrary::<i16>().unwrap_or(0)) / 32768.0,
        }
    }

    /// Returns a number of any order, from 1e-40 to 1e40.
    pub fn wide(&mut self) -> f64 {
        let exponent = self.whole(0, 80) as i32 - 40;
        self.real(1.0) * 10.0_f64.powi(exponent)
    }

    /// Returns a list of `count` values.
    pub fn list<T>(&mut self, count: usize, mut draw: impl FnMut(&mut Self) -> T) -> Vec<T> {
        (0..count).map(|_| draw(self)).collect()
    }

    /// Returns a place within about 0.1 m. Some places are on a coarse grid, so that some coincide.
    pub fn place(&mut self) -> [f64; 3] {
        let raster = self.flag();
        [(); 3].map(|()| if raster { 0.01 * (self.whole(0, 8) as f64 - 4.0) } else { self.real(0.1) })
    }

    /// Returns control points: beside the array, on it, at the same place, or far away.
    pub fn points(&mut self, most: usize) -> Vec<[f64; 3]> {
        let count = self.whole(1, most);
        let height = self.real(0.3).abs();
        let far = self.one(&[1.0, 1.0, 1.0, 1.0, 30.0, 1e3]);
        let mut points = self.list(count, Self::place);
        points.iter_mut().for_each(|[x, y, z]| (*x, *y, *z) = (far * *x, far * *y, far * (*z + height)));
        points
    }

    /// Returns the quantization of a board.
    pub fn quantization(&mut self) -> Result<Quantization, Error> {
        let phases = self.maybe(|draw| draw.one(&[0, 1, 2, 3, 4, 16, 32, 63, 64, 255, 256, 1024, 65536, 65537]));
        let amplitudes = self.maybe(|draw| match draw.whole(0, 4) {
            0 => vec![1.0],
            1 => vec![0.0, 1.0],
            2 => (0..=255).map(|k| f64::from(k) / 255.0).collect(),
            3 => vec![1e-12, 0.3, 1.0],
            _ => {
                let count = draw.whole(0, 4);
                let mut table = draw.list(count, |draw| draw.real(1.0).abs());
                table.push(1.0);
                table
            }
        });
        Quantization::new(phases, amplitudes)
    }

    /// Returns an array: a grid or any transducers, with or without responses, mask and quantization.
    pub fn array(&mut self) -> Result<Array, Error> {
        let array = if self.flag() {
            let (nx, ny) = (self.whole(0, 9), self.whole(1, 9));
            Array::grid(nx, ny, self.real(0.02).abs())?
        } else {
            let count = self.whole(0, 20);
            let positions = self.list(count, Self::place);
            let normals = self.maybe(|draw| draw.list(count, |draw| [(); 3].map(|()| draw.real(1.0))));
            Array::new(positions, normals)?
        };
        let parameter = self.real(0.02);
        let laws: Vec<Directivity> = Directivity::all().collect();
        // Half of the arrays have point sources, the first law.
        let law = laws[self.whole(0, 2 * laws.len() - 1).saturating_sub(laws.len())];
        let scale = |own: Parameter| if own.length { 1.0 } else { 500.0 };
        let directivity = Directivity::named(law.name().0, law.parameter().map(|own| scale(own) * parameter))?;
        let source_pressure = self.one(&[4.386, 4.386, 1e-3, 1.0, 1e-12, 1e12, 0.0]);
        let array = array.with_transducer(Transducer { source_pressure, directivity })?;
        let count = array.len();
        let response = self.maybe(|draw| {
            let unit = draw.wide();
            draw.list(count, |draw| Complex64::new(draw.real(1.0), draw.real(1.0)) * unit)
        });
        let mask = self.maybe(|draw| draw.list(count, Self::flag));
        let quantization = self.maybe(Self::quantization).transpose()?;
        Ok(array.with_response(response)?.with_mask(mask)?.with_quantization(quantization))
    }

    /// Returns a medium, mostly the default; each given key has its example as value, or an odd one.
    pub fn medium(&mut self) -> Result<Medium, Error> {
        let mut given = Vec::new();
        for key in Medium::KEYS {
            if self.whole(0, 7) == 7 {
                let usual: f64 = key.example.parse().unwrap_or_default();
                given.push((key.name, usual * self.one(&[1.0, 0.6, 25.0, 2.5e4, 2.5e-8, 0.0, 1e-300, -1.0])));
            }
        }
        Medium::default().with(&given)
    }

    /// Returns targets and weights for `count` points.
    pub fn request(&mut self, count: usize) -> Request {
        let scale = self.one(&[1.0, 100.0, 1e4, 1e-6, 1e-20, 1e20]);
        // Some of the points are quiet.
        let value = |draw: &mut Self| if draw.whole(0, 5) == 5 { 0.0 } else { draw.real(scale).abs() };
        let pressures = self.maybe(|draw| draw.list(count, value));
        Request {
            pressures,
            weights: self.maybe(|draw| draw.list(count, |draw| draw.real(1.0).abs())),
            ..Request::default()
        }
    }

    /// Returns a start for iterative methods.
    pub fn start(&mut self, transducers: usize, points: usize) -> Start {
        if self.flag() {
            Start::Phases(self.list(points, |draw| draw.real(7.0)))
        } else {
            Start::Drive(self.drive(transducers))
        }
    }

    /// Returns a drive with |q| <= 1, except for some unusual numbers.
    pub fn drive(&mut self, transducers: usize) -> Vec<Complex32> {
        self.list(transducers, |draw| Complex32::new(draw.real(0.7) as f32, draw.real(0.7) as f32))
    }

    /// Returns an aim.
    pub fn aim(&mut self) -> Aim {
        self.one(&[Aim::Target, Aim::Max])
    }

    /// Returns a solver of the registry with some options, for an array with this quantization and `transducers`.
    pub fn solver(&mut self, quantization: Option<&Quantization>, transducers: usize) -> Result<Configured, Error> {
        let entry = &SOLVERS[self.whole(0, SOLVERS.len() - 1)];
        let mut options = Options::new();
        for info in entry.options() {
            // Options that determine the time are always set, to small values.
            let value = match (info.name, &info.default) {
                ("steps", _) => Value::Integer(self.whole(0, 12) as i128),
                ("starts", _) => Value::Integer(self.whole(0, 5) as i128),
                ("sweeps", _) => Value::Integer(self.whole(0, 3) as i128),
                ("amplitudes", _) => Value::Integer(self.one(&[1, 2, 3, 4, 0, 8])),
                ("phases", _) => Value::Integer(self.one(&[16, 2, 3, 4, 5, 15, 17, 63, 64, 65, 128, 256, 0])),
                (_, Value::Integer(_)) if self.flag() => Value::Integer(i128::from(self.real(16.0) as i64)),
                (_, Value::Real(_)) if self.flag() => Value::Real(self.real(1.0)),
                (_, Value::Bool(_)) if self.flag() => Value::Bool(self.flag()),
                ("order", _) if self.flag() => Value::Integers(self.order(transducers)),
                (_, Value::Text(_)) if self.flag() => Value::Text(self.one(&WORDS).into()),
                _ => continue,
            };
            options.insert(info.name.into(), value);
        }
        entry.configure_for(&options, quantization)
    }

    /// Returns a permutation of 0..`count`, sometimes with an error.
    fn order(&mut self, count: usize) -> Vec<i64> {
        let mut order: Vec<i64> = (0..count as i64).collect();
        for _ in 0..self.whole(0, 3) {
            let (a, b) = (self.whole(0, count - 1), self.whole(0, count - 1));
            order.swap(a, b);
        }
        if self.whole(0, 9) == 9 {
            order[0] = self.whole(0, count) as i64 - 1;
        }
        order
    }

    fn byte(&mut self) -> u8 {
        self.0.arbitrary().unwrap_or(0)
    }
}
