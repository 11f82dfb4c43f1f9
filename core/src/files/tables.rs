//! The tables of a scene file (`[medium]`, `[array]`, `[[points]]`, `[solver]`, `[plane]`), to a scene and back.

use alloc::collections::BTreeMap;
use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use crate::error::Error;
use crate::files::quantization::QuantizationTable;
use crate::scene::{Array, Choice, Directivity, Medium, Options, Origin, Plane, Request, Scene, Transducer, Value};
use crate::solvers::registry::configure;

/// How a scene was solved, written beside it so that a result can be replayed.
#[derive(Clone, Debug, Default, PartialEq)]
#[allow(clippy::exhaustive_structs, reason = "two remarks")]
pub struct Provenance {
    /// The version of midair.
    pub version: Option<String>,
    /// How the solve ended.
    pub status: Option<String>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneTable {
    #[serde(skip_serializing_if = "Option::is_none")]
    version: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    status: Option<String>,
    #[serde(default)]
    medium: MediumTable,
    array: ArrayTable,
    #[serde(skip_serializing_if = "Option::is_none")]
    solver: Option<SolverTable>,
    #[serde(skip_serializing_if = "Option::is_none")]
    plane: Option<PlaneTable>,
    #[serde(default)]
    points: Vec<PointTable>,
}

/// Exactly N numbers: an array type alone would take the first N of a longer list.
#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(try_from = "Vec<f64>", into = "Vec<f64>")]
struct Numbers<const N: usize>([f64; N]);

impl<const N: usize> TryFrom<Vec<f64>> for Numbers<N> {
    type Error = String;

    fn try_from(list: Vec<f64>) -> Result<Self, String> {
        let found = list.len();
        list.try_into().map(Self).map_err(|_| format!("invalid length {found}, expected {N} numbers"))
    }
}

impl<const N: usize> From<Numbers<N>> for Vec<f64> {
    fn from(numbers: Numbers<N>) -> Self {
        numbers.0.to_vec()
    }
}

/// Vectors as the core takes them.
fn plain<const N: usize>(list: Vec<Numbers<N>>) -> Vec<[f64; N]> {
    list.into_iter().map(|numbers| numbers.0).collect()
}

/// Vectors as the file holds them.
fn listed<const N: usize>(list: &[[f64; N]]) -> Vec<Numbers<N>> {
    list.iter().map(|&numbers| Numbers(numbers)).collect()
}

#[derive(Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct MediumTable {
    frequency: Option<f64>,
    sound_speed: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    temperature: Option<f64>,
    absorption: Option<f64>,
    density: Option<f64>,
}

#[derive(Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ArrayTable {
    #[serde(skip_serializing_if = "Option::is_none")]
    grid: Option<GridTable>,
    #[serde(skip_serializing_if = "Option::is_none")]
    preset: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tiles: Option<Vec<i64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    positions: Option<Vec<Numbers<3>>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    normals: Option<Vec<Numbers<3>>>,
    source_pressure: Option<f64>,
    directivity: Option<DirectivityTable>,
    #[serde(skip_serializing_if = "Option::is_none")]
    response: Option<Vec<Numbers<2>>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mask: Option<Vec<bool>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    quantization: Option<QuantizationTable>,
}

#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct GridTable {
    nx: i64,
    ny: i64,
    pitch: f64,
}

#[derive(Serialize, Deserialize)]
#[serde(untagged, expecting = "a name such as \"point\" or a table of one name and its parameter")]
enum DirectivityTable {
    Name(String),
    Parameter(BTreeMap<String, f64>),
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PointTable {
    position: Numbers<3>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pressure: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    weight: Option<f64>,
}

#[derive(Serialize, Deserialize)]
struct SolverTable {
    name: String,
    #[serde(flatten)]
    options: BTreeMap<String, ValueTable>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PlaneTable {
    z: Option<f64>,
    size: Option<f64>,
    pixels: Option<i64>,
    center: Option<Numbers<2>>,
}

#[derive(Serialize, Deserialize)]
#[serde(untagged, expecting = "a number, a word or a list of whole numbers")]
enum ValueTable {
    Bool(bool),
    Integer(i64),
    Large(u64),
    Real(f64),
    Text(String),
    Integers(Vec<i64>),
}

impl From<ValueTable> for Value {
    fn from(table: ValueTable) -> Self {
        match table {
            ValueTable::Bool(value) => Self::Bool(value),
            ValueTable::Integer(value) => Self::Integer(value.into()),
            ValueTable::Large(value) => Self::Integer(value.into()),
            ValueTable::Real(value) => Self::Real(value),
            ValueTable::Text(value) => Self::Text(value),
            ValueTable::Integers(values) => Self::Integers(values),
        }
    }
}

impl TryFrom<&Value> for ValueTable {
    type Error = Error;

    fn try_from(value: &Value) -> Result<Self, Error> {
        Ok(match value {
            Value::Bool(value) => Self::Bool(*value),
            Value::Integer(number) => match (i64::try_from(*number), u64::try_from(*number)) {
                (Ok(number), _) => Self::Integer(number),
                (_, Ok(number)) => Self::Large(number),
                _ => return Err(Error::invalid("solver option", value, "give a number of at most 64 bits")),
            },
            Value::Real(value) => Self::Real(*value),
            Value::Text(value) => Self::Text(value.clone()),
            Value::Integers(values) => Self::Integers(values.clone()),
        })
    }
}

impl SceneTable {
    /// The table of a scene.
    pub(super) fn of(scene: &Scene, provenance: &Provenance) -> Result<Self, Error> {
        let (medium, request) = (scene.medium(), scene.request());
        let points = scene.points().iter().enumerate().map(|(j, &position)| PointTable {
            position: Numbers(position),
            pressure: request.pressures.as_ref().map(|pressures| pressures[j]),
            weight: request.weights.as_ref().map(|weights| weights[j]),
        });
        let solver = scene.solver.as_ref().map(|choice| {
            let options = choice.table().into_iter().map(|(key, value)| Ok((key, (&value).try_into()?)));
            Ok(SolverTable { name: choice.name.clone(), options: options.collect::<Result<_, Error>>()? })
        });
        Ok(SceneTable {
            version: provenance.version.clone(),
            status: provenance.status.clone(),
            medium: MediumTable {
                frequency: Some(medium.frequency),
                sound_speed: Some(medium.sound_speed),
                temperature: None,
                absorption: Some(medium.absorption),
                density: Some(medium.density),
            },
            array: ArrayTable::of(scene.array()),
            solver: solver.transpose()?,
            plane: scene.plane.map(|plane| PlaneTable {
                z: Some(plane.z),
                size: Some(plane.size),
                pixels: Some(plane.pixels as i64),
                center: Some(Numbers(plane.center)),
            }),
            points: points.collect(),
        })
    }

    /// The scene of a table.
    pub(super) fn scene(self) -> Result<Scene, Error> {
        let count = self.points.len();
        let given = self.points.iter().filter(|point| point.pressure.is_some()).count();
        if given != 0 && given != count {
            let without = self.points.iter().position(|point| point.pressure.is_none()).unwrap_or_default();
            let cure = format!("{given} of {count} points have one: give every point a pressure, or none");
            return Err(Error::invalid(format!("points[{without}].pressure"), "left out", cure));
        }
        let weighted = self.points.iter().any(|point| point.weight.is_some());
        let request = Request {
            pressures: self.points.iter().map(|point| point.pressure).collect::<Option<Vec<_>>>().filter(|_| given > 0),
            weights: weighted.then(|| self.points.iter().map(|point| point.weight.unwrap_or(1.0)).collect()),
        };
        let points: Vec<_> = self.points.iter().map(|point| point.position.0).collect();
        let mut scene = Scene::new(self.array.array()?, self.medium.medium()?, points, request)?;
        scene.plane = self.plane.map(|plane| plane.plane(scene.points())).transpose()?;
        if let Some(table) = self.solver {
            let options: Options = table.options.into_iter().map(|(name, value)| (name, value.into())).collect();
            let choice = Choice::new(table.name, options)?;
            configure(&choice, scene.array().quantization())?;
            scene.solver = Some(choice);
        }
        Ok(scene)
    }
}

impl MediumTable {
    fn medium(&self) -> Result<Medium, Error> {
        let default = Medium::default();
        let sound_speed = Medium::sound_speed(self.sound_speed, self.temperature)?;
        Ok(Medium {
            frequency: self.frequency.unwrap_or(default.frequency),
            sound_speed,
            absorption: self.absorption.unwrap_or(default.absorption),
            density: self.density.unwrap_or(default.density),
        })
    }
}

impl ArrayTable {
    fn of(array: &Array) -> Self {
        let origin = match array.origin() {
            Origin::Grid { nx, ny, pitch } => {
                let grid = GridTable { nx: *nx as i64, ny: *ny as i64, pitch: *pitch };
                Self { grid: Some(grid), ..Self::default() }
            }
            Origin::Preset { name, tiles } => {
                let tiles = tiles.map(|tiles| tiles as i64).to_vec();
                Self { preset: Some(name.clone()), tiles: Some(tiles), ..Self::default() }
            }
            Origin::Positions => {
                let (positions, normals) = (listed(array.positions()), listed(array.normals()));
                Self { positions: Some(positions), normals: Some(normals), ..Self::default() }
            }
        };
        let Transducer { source_pressure, directivity } = array.transducer();
        Self {
            source_pressure: Some(source_pressure),
            directivity: Some(match directivity.name() {
                (name, None) => DirectivityTable::Name(name.to_string()),
                (name, Some(parameter)) => DirectivityTable::Parameter([(name.to_string(), parameter)].into()),
            }),
            response: array.response().map(|response| response.iter().map(|c| Numbers([c.re, c.im])).collect()),
            mask: array.mask().map(<[_]>::to_vec),
            quantization: QuantizationTable::of(array),
            ..origin
        }
    }

    fn array(self) -> Result<Array, Error> {
        let ways = [self.grid.is_some(), self.preset.is_some(), self.positions.is_some()];
        let ways = ways.into_iter().filter(|&given| given).count();
        if ways != 1 {
            let cure = "give exactly one of grid, preset and positions";
            return Err(Error::invalid("array", format!("described {ways} times"), cure));
        }
        for (item, given, belongs) in [
            ("array.tiles", self.tiles.is_some(), self.preset.is_some()),
            ("array.normals", self.normals.is_some(), self.positions.is_some()),
        ] {
            if given && !belongs {
                return Err(Error::invalid(item, "given", "tiles go with a preset, normals with positions"));
            }
        }
        let array = match (self.grid, self.preset, self.positions) {
            (Some(grid), ..) => {
                Array::grid(whole("array.grid.nx", grid.nx)?, whole("array.grid.ny", grid.ny)?, grid.pitch)?
            }
            (_, Some(preset), _) => {
                let tiles = self.tiles.unwrap_or_else(|| [1, 1].to_vec());
                let [x, y] = tiles[..] else {
                    let value = format!("{tiles:?}");
                    return Err(Error::invalid("array.tiles", value, "give two numbers, boards along x and y"));
                };
                Array::preset(&preset, [whole("array.tiles[0]", x)?, whole("array.tiles[1]", y)?])?
            }
            (.., positions) => Array::new(plain(positions.unwrap_or_default()), self.normals.map(plain))?,
        };
        let default = array.transducer();
        let array = array.with_transducer(Transducer {
            source_pressure: self.source_pressure.unwrap_or(default.source_pressure),
            directivity: self.directivity.map_or(Ok(default.directivity), |table| table.directivity())?,
        })?;
        let response =
            self.response.map(|list| plain(list).into_iter().map(|[re, im]| Complex64::new(re, im)).collect());
        let array = array.with_response(response)?.with_mask(self.mask)?;
        // A preset has its own quantization unless the table says otherwise.
        Ok(match self.quantization {
            Some(table) => array.with_quantization(Some(table.quantization()?)),
            None => array,
        })
    }
}

/// A count; what is 0 or less is named before anything is made of it.
fn whole(item: &str, value: i64) -> Result<usize, Error> {
    usize::try_from(value).map_err(|_| Error::invalid(item, value, "give at least 1"))
}

impl DirectivityTable {
    fn directivity(&self) -> Result<Directivity, Error> {
        match self {
            Self::Name(name) => Directivity::named(name, None),
            Self::Parameter(table) => match table.iter().next() {
                Some((name, &parameter)) if table.len() == 1 => Directivity::named(name, Some(parameter)),
                _ => Err(Error::invalid(
                    "array.directivity",
                    format!("{} keys", table.len()),
                    "give one, such as { piston = 4.5e-3 }",
                )),
            },
        }
    }
}

impl PlaneTable {
    fn plane(&self, points: &[[f64; 3]]) -> Result<Plane, Error> {
        let around = Plane::around(points);
        // A size of the user's own is meant around the array's axis; one that follows the points follows them.
        let center = if self.size.is_some() { [0.0, 0.0] } else { around.center };
        Plane::new(
            self.z.unwrap_or(around.z),
            self.size.unwrap_or(around.size),
            self.pixels.map_or(Ok(around.pixels), |pixels| whole("plane.pixels", pixels))?,
            self.center.map_or(center, |center| center.0),
        )
    }
}
