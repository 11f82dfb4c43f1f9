//! From a scene to the tables of its file, as they are written.

use alloc::collections::BTreeMap;
use alloc::string::{String, ToString};
use alloc::vec::Vec;

use serde::Serialize;

use crate::error::Error;
use crate::files::quantization::QuantizationTable;
use crate::scene::{Array, Axis, Obstacle, Origin, Plane, Scene, Surface, Transducer, Value};

/// How a scene was solved, written beside it so that a result can be replayed.
#[derive(Clone, Debug, Default, PartialEq)]
#[allow(clippy::exhaustive_structs, reason = "two remarks")]
pub struct Provenance {
    /// The version of midair.
    pub version: Option<String>,
    /// How the solve ended.
    pub status: Option<String>,
}

#[derive(Serialize)]
pub(super) struct SceneTable {
    #[serde(skip_serializing_if = "Option::is_none")]
    version: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    status: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    signature: Option<String>,
    medium: MediumTable,
    array: ArrayTable,
    #[serde(skip_serializing_if = "Option::is_none")]
    solver: Option<SolverTable>,
    #[serde(skip_serializing_if = "Option::is_none")]
    plane: Option<PlaneTable>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    obstacles: Vec<ObstacleTable>,
    points: Vec<PointTable>,
}

/// N numbers, which serde knows as an array of some lengths only.
#[derive(Clone, Copy, Serialize)]
#[serde(into = "Vec<f64>")]
struct Numbers<const N: usize>([f64; N]);

impl<const N: usize> From<Numbers<N>> for Vec<f64> {
    fn from(numbers: Numbers<N>) -> Self {
        numbers.0.to_vec()
    }
}

/// Vectors as the file holds them.
fn listed<const N: usize>(list: &[[f64; N]]) -> Vec<Numbers<N>> {
    list.iter().map(|&numbers| Numbers(numbers)).collect()
}

#[derive(Default, Serialize)]
struct MediumTable {
    frequency: Option<f64>,
    sound_speed: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    temperature: Option<f64>,
    absorption: Option<f64>,
    density: Option<f64>,
}

#[derive(Default, Serialize)]
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

#[derive(Clone, Copy, Serialize)]
struct GridTable {
    nx: i64,
    ny: i64,
    pitch: f64,
}

#[derive(Serialize)]
#[serde(untagged)]
enum DirectivityTable {
    Name(String),
    Parameter(BTreeMap<String, f64>),
}

#[derive(Default, Serialize)]
struct ObstacleTable {
    kind: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    point: Option<Numbers<3>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    normal: Option<Numbers<3>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    center: Option<Numbers<3>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    radius: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    vertices: Option<Vec<Numbers<3>>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    faces: Option<Vec<Vec<u32>>>,
}

#[derive(Serialize)]
struct PointTable {
    position: Numbers<3>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pressure: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    phase: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    weight: Option<f64>,
}

#[derive(Serialize)]
struct SolverTable {
    name: String,
    #[serde(flatten)]
    options: BTreeMap<String, ValueTable>,
}

#[derive(Serialize)]
struct PlaneTable {
    #[serde(skip_serializing_if = "Option::is_none")]
    axis: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    at: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    z: Option<f64>,
    size: Option<f64>,
    pixels: Option<i64>,
    center: Option<Numbers<2>>,
}

#[derive(Serialize)]
#[serde(untagged)]
enum ValueTable {
    Bool(bool),
    Integer(i64),
    Large(u64),
    Real(f64),
    Text(String),
    Integers(Vec<i64>),
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
            phase: request.phases.as_ref().map(|phases| phases[j]),
            weight: request.weights.as_ref().map(|weights| weights[j]),
        });
        let solver = scene.solver.as_ref().map(|choice| {
            let options = choice.table().into_iter().map(|(key, value)| Ok((key, (&value).try_into()?)));
            Ok(SolverTable { name: choice.name.clone(), options: options.collect::<Result<_, Error>>()? })
        });
        let signature = scene.signature().map(|signature| {
            let cure =
                "files know trap, twin and vortex: take the factors away and give them to the scene that is read";
            signature.name().map(Into::into).ok_or_else(|| Error::invalid("signature", "a list of factors", cure))
        });
        Ok(SceneTable {
            version: provenance.version.clone(),
            status: provenance.status.clone(),
            signature: signature.transpose()?,
            medium: MediumTable {
                frequency: Some(medium.frequency),
                sound_speed: Some(medium.sound_speed),
                temperature: None,
                absorption: Some(medium.absorption),
                density: Some(medium.density),
            },
            array: ArrayTable::of(scene.array()),
            solver: solver.transpose()?,
            plane: scene.plane.map(PlaneTable::of),
            obstacles: scene.obstacles().iter().map(ObstacleTable::of).collect(),
            points: points.collect(),
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
                Self { preset: Some((*name).into()), tiles: Some(tiles), ..Self::default() }
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
}

impl ObstacleTable {
    fn of(obstacle: &Obstacle) -> Self {
        let of = |kind: Surface| Self { kind: kind.name().into(), ..Self::default() };
        match obstacle {
            Obstacle::Wall { point, normal, kind } => {
                Self { point: Some(Numbers(*point)), normal: Some(Numbers(*normal)), ..of(*kind) }
            }
            Obstacle::Sphere { center, radius, kind } => {
                Self { center: Some(Numbers(*center)), radius: Some(*radius), ..of(*kind) }
            }
            Obstacle::Mesh(mesh) => Self {
                vertices: Some(listed(mesh.vertices())),
                faces: Some(mesh.faces().iter().map(|face| face.to_vec()).collect()),
                ..of(mesh.kind())
            },
        }
    }
}

impl PlaneTable {
    fn of(plane: Plane) -> Self {
        let Plane { axis, at, size, pixels, center } = plane;
        let (axis, at, z) = match axis {
            Axis::Z => (None, None, Some(at)),
            _ => (Some(axis.to_string()), Some(at), None),
        };
        Self { axis, at, z, size: Some(size), pixels: Some(pixels as i64), center: Some(Numbers(center)) }
    }
}
