//! Conversion of a scene to the tables of its file.

use crate::files::node::Node;
use crate::prelude::*;
use crate::scene::{Array, Axis, Bead, Key, Obstacle, Origin, PartValue, Plane, Scene, Signature, Surface, Value};

/// Information about a solve, written beside the scene so that a result can be reproduced.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Provenance {
    /// The version of midair.
    pub version: Option<String>,
    /// The status at the end of the solve.
    pub status: Option<String>,
}

/// Returns the document of a scene as a tree of values.
pub(super) fn document(scene: &Scene, provenance: &Provenance) -> Result<Node> {
    let (medium, request) = (scene.medium(), scene.request());
    let points = scene.points().iter().enumerate().map(|(j, position)| {
        let number = |list: &Option<Vec<f64>>| list.as_ref().map_or(Node::Null, |list| Node::Real(list[j]));
        table([
            ("position", numbers(position)),
            ("pressure", number(&request.pressures)),
            ("phase", number(&request.phases)),
            ("weight", number(&request.weights)),
        ])
    });
    let solver = scene.solver.as_ref().map(|choice| {
        let mut entries = Vec::from([("name".to_string(), text(&choice.name))]);
        for (key, value) in choice.table() {
            entries.push((key, option(&value)?));
        }
        Ok(Node::Table(entries))
    });
    let signature = scene.signature().map(|signature| {
        let cure = "files know trap, twin and vortex: take the factors away and give them to the scene that is read";
        if let Signature::Each(each) = signature {
            return Ok(Node::List(each.iter().filter_map(Signature::name).map(text).collect()));
        }
        signature.name().map(text).ok_or_else(|| Error::invalid("signature", "a list of factors", cure))
    });
    let bead = (scene.bead() != Bead::default()).then(|| bead(scene.bead()));
    let obstacles: Vec<Node> = scene.obstacles().iter().map(obstacle).collect();
    Ok(table([
        ("version", maybe(provenance.version.as_deref().map(text))),
        ("status", maybe(provenance.status.as_deref().map(text))),
        ("signature", maybe(signature.transpose()?)),
        ("bead", maybe(bead)),
        ("medium", Node::Table(medium.numbers().map(|(name, value)| (name.into(), Node::Real(value))).collect())),
        ("array", array(scene.array())),
        ("solver", maybe(solver.transpose()?)),
        ("plane", maybe(scene.plane.map(plane))),
        ("obstacles", if obstacles.is_empty() { Node::Null } else { Node::List(obstacles) }),
        ("points", Node::List(points.collect())),
    ]))
}

fn bead(Bead { particle, gravity }: Bead) -> Node {
    table(particle.numbers().map(|(name, value)| (name, Node::Real(value))).chain([("gravity", numbers(&gravity))]))
}

fn array(array: &Array) -> Node {
    let [mut grid, mut preset, mut tiles, mut positions, mut normals] = [const { Node::Null }; 5];
    match array.origin() {
        Origin::Grid { nx, ny, pitch } => {
            grid = table([("nx", count(*nx)), ("ny", count(*ny)), ("pitch", Node::Real(*pitch))]);
        }
        Origin::Preset { name, tiles: along } => {
            (preset, tiles) = (text(name), Node::List(along.map(count).to_vec()));
        }
        Origin::Positions => (positions, normals) = (vectors(array.positions()), vectors(array.normals())),
    }
    let places = [("grid", grid), ("preset", preset), ("tiles", tiles), ("positions", positions), ("normals", normals)];
    table(places.into_iter().chain(array.stated().map(|(name, value)| (name, part(value)))))
}

fn part(value: PartValue) -> Node {
    match value {
        PartValue::Real(number) => Node::Real(number),
        PartValue::Directivity(law) => match law.name() {
            (name, None) => text(name),
            (name, Some(parameter)) => table([(name, Node::Real(parameter))]),
        },
        PartValue::Complexes(list) => Node::List(list.iter().map(|c| numbers(&[c.re, c.im])).collect()),
        PartValue::Flags(list) => Node::List(list.into_iter().map(Node::Bool).collect()),
        PartValue::Indices(list) => Node::List(list.into_iter().map(count).collect()),
        PartValue::Quantization(board) => table([
            ("phases", maybe(board.phases().map(|phases| Node::Integer(phases.into())))),
            ("amplitudes", maybe(board.amplitudes().map(numbers))),
            ("pulses", maybe(board.ticks().map(numbers))),
        ]),
    }
}

fn obstacle(obstacle: &Obstacle) -> Node {
    let kind = |kind: Surface| ("kind".to_string(), text(kind.name()));
    if let Obstacle::Mesh(mesh) = obstacle {
        let face = |face: &[u32; 3]| Node::List(face.map(|corner| Node::Integer(corner.into())).to_vec());
        let faces = Node::List(mesh.faces().iter().map(face).collect());
        let parts = [("vertices".into(), vectors(mesh.vertices())), ("faces".into(), faces)];
        return Node::Table([kind(mesh.kind())].into_iter().chain(parts).collect());
    }
    let described = Obstacle::BODIES.iter().find_map(|body| Some((body, (body.read)(obstacle)?)));
    described.map_or(Node::Null, |(body, (parts, surface))| {
        let part = |((key, count), part): (&(Key, usize), &Vec<f64>)| {
            (key.name.to_string(), if *count == 1 { Node::Real(part[0]) } else { numbers(part) })
        };
        Node::Table([kind(surface)].into_iter().chain(body.parts.iter().zip(&parts).map(part)).collect())
    })
}

fn plane(plane: Plane) -> Node {
    let Plane { axis, at, size, pixels, center } = plane;
    let (axis, at, z) = match axis {
        Axis::Z => (Node::Null, Node::Null, Node::Real(at)),
        _ => (text(&axis.to_string()), Node::Real(at), Node::Null),
    };
    table([
        ("axis", axis),
        ("at", at),
        ("z", z),
        ("size", Node::Real(size)),
        ("pixels", count(pixels)),
        ("center", numbers(&center)),
    ])
}

/// Converts the value of an option.
fn option(value: &Value) -> Result<Node> {
    Ok(match value {
        Value::Bool(value) => Node::Bool(*value),
        Value::Integer(number) => match (i64::try_from(*number), u64::try_from(*number)) {
            (Ok(number), _) => Node::Integer(number),
            (_, Ok(number)) => Node::Large(number),
            _ => {
                return Err(Error::out_of_range("solver option", value, "give a number of at most 64 bits"));
            }
        },
        Value::Real(value) => Node::Real(*value),
        Value::Text(value) => text(value),
        Value::Integers(values) => Node::List(values.iter().copied().map(Node::Integer).collect()),
    })
}

/// Returns a table. Entries that are null will not be written.
fn table<'a>(entries: impl IntoIterator<Item = (&'a str, Node)>) -> Node {
    // The loop is separate, because it takes kilobytes of code if it is compiled once for each table.
    let entries: Vec<_> = entries.into_iter().collect();
    Node::Table(entries.into_iter().map(|(key, node)| (key.to_string(), node)).collect())
}

fn maybe(node: Option<Node>) -> Node {
    node.unwrap_or(Node::Null)
}

fn text(words: &str) -> Node {
    Node::Text(words.into())
}

fn count(number: usize) -> Node {
    Node::Integer(number as i64)
}

fn numbers(list: &[f64]) -> Node {
    Node::Numbers(list.to_vec())
}

fn vectors(list: &[[f64; 3]]) -> Node {
    Node::List(list.iter().map(|vector| numbers(vector)).collect())
}
