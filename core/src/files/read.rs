//! Conversion of the tables of a scene file (`[medium]`, `[array]`, `[[points]]`, shapes, `[[obstacles]]`, `[solver]`, `[plane]`) to a scene.

use crate::device::quantization::Quantization;
use crate::files::csv;
use crate::files::drawn::{self, Drawn, drawn, mesh};
use crate::files::item::{Fault, Item, Read, Table};
use crate::files::positions::{self, Point};
use crate::files::{Draw, Drawing, Node, Source};
use crate::prelude::*;
use crate::scene::{
    Array, Axis, Bead, Body, Choice, Directivity, Extras, Key, Medium, Mesh, Obstacle, OptionValue, Options, Part,
    PartKind, PartValue, Particle, Plane, Pose, Request, Scene, Signature, Surface, Value,
};
use crate::solvers::registry;

/// Returns the scene of a document.
pub(super) fn scene(document: &Node, source: Source<'_>, draw: &mut Draw<'_>) -> Read<Scene> {
    let root = Item::root(document).table()?;
    if let Some(motion) = root.get("motion") {
        let cure = "midair motion solves it and midair play plays it";
        return Err(Fault::at("motion", Error::invalid("motion", motion.node, format!("its points move: {cure}"))));
    }
    let listed = root.read("points", |points| {
        points.each(|item| listed(item, source), "give tables, each with a position, or a file")
    })?;
    let (points, owners) = joined(listed.unwrap_or_default().concat(), drawn(&root, draw)?);
    let request = request(&points, &owners)?;
    let places = points.into_iter().map(|(position, ..)| position).collect();
    at(&root, places, request, source, draw)
}

/// Returns the scene with these points, from the other tables of a document.
pub(super) fn at(
    root: &Table<'_>,
    places: Vec<[f64; 3]>,
    request: Request,
    source: Source<'_>,
    draw: &mut Draw<'_>,
) -> Read<Scene> {
    let array = array(&root.need("array")?.table()?, source, draw)?;
    let medium = root.read("medium", |item| Ok(array.medium(&item.table()?.reals(Medium::KEYS)?)?))?;
    let scene = Scene::new(array, medium, places, request)?;
    let extras = Extras {
        signature: root.read("signature", signature)?,
        bead: root.read("bead", bead)?.unwrap_or_default(),
        obstacles: root.get("obstacles").map_or_else(|| Ok(Vec::new()), |all| obstacles(&all, draw))?,
        plane: root.read("plane", |item| plane(&item.table()?, &scene))?,
        solver: root.read("solver", |item| choice(&item.open_table()?, scene.array().quantization()))?,
    };
    Ok(scene.with_extras(extras)?)
}

/// Reads a point, or those of a file; the pressure, phase and weight of the table replace missing ones of the file.
fn listed(item: &Item<'_>, source: Source<'_>) -> Read<Vec<Point>> {
    let table = item.table()?;
    let real = |key: &str| table.read(key, Item::real);
    let own = [real("pressure")?, real("phase")?, real("weight")?];
    let unit = unit(table.get("unit"))?;
    let Some(file) = table.get("file") else {
        let place: [f64; 3] = table.need("position")?.numbers()?;
        return Ok(vec![(place.map(|x| x * unit.1), own)]);
    };
    refuse_if!(table.get("position").is_some(), file.refused("a position is given, too: give one of them"));
    let points =
        positions::points(file.text()?, unit.0, source).map_err(|error| Fault::at(file.path.as_str(), error))?;
    let given = |(place, numbers): Point| (place, [0, 1, 2].map(|k| numbers[k].or(own[k])));
    Ok(points.into_iter().map(given).collect())
}

/// The unit of a table's positions, by default m, and its size in m.
fn unit(item: Option<Item<'_>>) -> Read<(&str, f64)> {
    let Some(item) = item else { return Ok(("m", 1.0)) };
    let name = item.text()?;
    Ok((name, csv::length(name).map_err(|error| Fault::at(item.path.as_str(), error))?))
}

/// Joins the listed points and the drawn ones. Also returns, for each drawn table, the index of its first point and its path.
fn joined(mut points: Vec<Point>, tables: Vec<Drawn>) -> (Vec<Point>, Vec<(usize, String)>) {
    let mut owners = Vec::new();
    for Drawn { path, points: places, request } in tables {
        owners.push((points.len(), path));
        let Request { pressures, phases, weights } = &request;
        let number = |list: &Option<Vec<f64>>, j: usize| list.as_ref().and_then(|list| list.get(j).copied());
        let each = places.into_iter().enumerate();
        points.extend(each.map(|(j, place)| (place, [pressures, phases, weights].map(|list| number(list, j)))));
    }
    (points, owners)
}

fn request(points: &[Point], owners: &[(usize, String)]) -> Read<Request> {
    let count = points.iter().filter(|(_, [pressure, ..])| pressure.is_some()).count();
    if count != 0 && count != points.len() {
        let without = points.iter().position(|(_, [pressure, ..])| pressure.is_none()).unwrap_or_default();
        let owner = owners.iter().rev().find(|(first, _)| *first <= without);
        let item = owner.map_or_else(|| format!("points[{without}]"), |(_, path)| path.clone());
        let cure = format!("{count} of {} points have one: give every point a pressure, or none", points.len());
        return Err(Error::missing(format!("{item}.pressure"), "left out", cure).into());
    }
    // If one point has the number (a pressure, phase or weight), the other points get the default.
    let list = |key: usize, default: f64| {
        let any = points.iter().any(|(_, numbers)| numbers[key].is_some());
        any.then(|| points.iter().map(|(_, numbers)| numbers[key].unwrap_or(default)).collect())
    };
    Ok(Request { pressures: list(0, 0.0), phases: list(1, 0.0), weights: list(2, 1.0) })
}

fn obstacles(all: &Item<'_>, draw: &mut Draw<'_>) -> Read<Vec<Obstacle>> {
    let cure = "give tables, each of a wall, a sphere or a mesh";
    let items = all.each(|one| Ok(Item { path: one.path.clone(), node: one.node }), cure)?;
    items.iter().map(|item| obstacle(item, draw)).collect()
}

/// The keys of a mesh: either listed in the document, or in a file.
const MESH: [&[&str]; 2] = [&["vertices", "faces"], &["file", "scale", "offset", "rotation", "up"]];

/// Reads a wall or sphere or mesh; the given keys decide which.
fn obstacle(item: &Item<'_>, draw: &mut Draw<'_>) -> Read<Obstacle> {
    let table = item.table()?;
    let keys: Vec<&str> = table.entries.iter().map(|(key, _)| &**key).filter(|key| *key != "kind").collect();
    let keys: Vec<&str> = keys.into_iter().filter(|key| table.get(key).is_some()).collect();
    let all_of = |known: &[&str]| !keys.is_empty() && keys.iter().all(|key| known.contains(key));
    let names = |body: &Body| body.parts.iter().map(|(key, _)| key.name).collect::<Vec<_>>();
    // Kinds may share keys: the kind with the fewest missing parameters is chosen.
    let body = Obstacle::BODIES.iter().filter(|body| all_of(&names(body))).min_by_key(|body| body.parts.len());
    let [listed, filed] = MESH.map(all_of);
    if body.is_none() && !listed && !filed {
        let bodies = Obstacle::BODIES.iter().map(|body| format!("{} of a {}", names(body).join(" and "), body.noun));
        let cure = format!("give {}, or vertices and faces or a file of a mesh", bodies.collect::<Vec<_>>().join(", "));
        let value = if keys.is_empty() { "not described" } else { "described in two ways" };
        return Err(Error::invalid(item.path.as_str(), value, cure).into());
    }
    let kind = table.read("kind", |kind| {
        let known = Surface::read(&kind.path, &Value::Text(kind.text()?.into()));
        known.map_err(|error| Fault::at(kind.path.as_str(), error))
    })?;
    let kind = kind.unwrap_or_default();
    if let Some(body) = body {
        let part = |(key, count): &(Key, usize)| {
            let item = table.need(key.name)?;
            if *count == 1 { Ok([item.real()?].into()) } else { item.some(*count) }
        };
        let parts = body.parts.iter().map(part).collect::<Read<Vec<_>>>()?;
        return Ok((body.make)(&parts, kind));
    }
    let (vertices, faces) = if listed {
        (table.need("vertices")?.vectors()?, table.need("faces")?.each(face, "give a list of lists of three indices")?)
    } else {
        table.need("file")?.text()?;
        mesh(item, draw)?
    };
    let made = Mesh::new(vertices, faces, kind).map_err(|error| of_obstacle(error, item))?;
    Ok(Obstacle::Mesh(Arc::new(made)))
}

/// Changes an error about a `mesh` to one about this obstacle.
fn of_obstacle(error: Error, item: &Item<'_>) -> Fault {
    let path = error.item.replacen("mesh", &item.path, 1);
    Fault::at(item.path.as_str(), error.about(path))
}

/// Reads three indices of vertices.
fn face(item: &Item<'_>) -> Read<[u32; 3]> {
    let corners: [f64; 3] = item.numbers()?;
    if corners.iter().any(|corner| corner.fract() != 0.0 || !(0.0..=f64::from(u32::MAX)).contains(corner)) {
        return Err(item.refused("give three indices of vertices"));
    }
    Ok(corners.map(|corner| corner as u32))
}

/// Reads one signature for all points, or a list with a name for each point.
fn signature(item: &Item<'_>) -> Read<Signature> {
    let read = |path: &str, one: Result<Signature>| one.map_err(|error| Fault::at(path, error));
    if let Node::List(_) = item.node {
        let one = |item: &Item<'_>| read(&item.path, Signature::of_point(item.text()?));
        return Ok(Signature::Each(item.each(one, "give a name for each point")?.into()));
    }
    read("signature", Signature::named(item.text()?))
}

fn bead(item: &Item<'_>) -> Read<Bead> {
    let table = item.table()?;
    Ok(Bead::default().with(&table.reals(Particle::KEYS)?, table.read("gravity", Item::numbers)?)?)
}

fn array(table: &Table<'_>, source: Source<'_>, draw: &mut Draw<'_>) -> Read<Array> {
    let has = |key: &str| table.get(key).is_some();
    let ways = ["grid", "preset", "positions", "part"].into_iter().filter(|key| has(key)).count();
    if ways != 1 {
        let cure = "give exactly one of grid, preset, positions and part";
        return Err(Error::invalid("array", format!("described {ways} times"), cure).into());
    }
    for (key, with) in [("tiles", "preset"), ("normals", "positions"), ("unit", "positions")] {
        if has(key) && !has(with) {
            let cure = "tiles go with a preset, normals and unit with positions";
            return Err(Error::conflict(format!("array.{key}"), "given", cure).into());
        }
    }
    let array = if let Some(grid) = table.get("grid") {
        let grid = grid.table()?;
        Array::grid(grid.need("nx")?.count()?, grid.need("ny")?.count()?, grid.need("pitch")?.real()?)?
    } else if let Some(preset) = table.get("preset") {
        let tiles = table.read("tiles", tiles)?.unwrap_or([1, 1]);
        Array::preset(preset.text()?, tiles).map_err(|error| match error.code {
            ErrorCode::Unknown => Fault::at("array.preset", error),
            _ => error.into(),
        })?
    } else if let Some(parts) = table.get("part") {
        let tables = parts.each(Item::table, "give tables, each of an array")?;
        let mut one = |part: &Table<'_>| array(part, source, draw).map_err(|fault| fault.within("array", &part.path));
        let joined = Array::join(&tables.iter().map(&mut one).collect::<Result<Vec<_>, _>>()?);
        joined.map_err(|error| Fault::from(error).within("arrays", &parts.path))?
    } else {
        placed(table, source, draw)?
    };
    // A missing part keeps the preset's value, or the default.
    let array = Array::PARTS.iter().try_fold(array, |array, part| match table.get(part.name) {
        None => Ok(array),
        Some(item) => Ok::<_, Fault>(part.put(array, value_of(part, &item)?)?),
    })?;
    let rotation = table.read("rotation", |item| match item.node.reals() {
        Some(numbers) => Ok(numbers.into_owned()),
        None => Ok(item.vectors::<3>()?.into_flattened()),
    })?;
    let translation = table.read("translation", Item::numbers)?.unwrap_or_default();
    let pose = Pose::new(&rotation.unwrap_or_default(), translation);
    Ok(pose.and_then(|pose| array.moved(&pose)).map_err(|error| {
        let item = if error.item.starts_with("array") { error.item.clone() } else { format!("array.{}", error.item) };
        error.about(item)
    })?)
}

/// Reads the value of a part.
fn value_of(part: &Part, item: &Item<'_>) -> Read<PartValue> {
    Ok(match part.kind() {
        PartKind::Real => PartValue::Real(item.real()?),
        PartKind::Directivity => PartValue::Directivity(directivity(item)?),
        PartKind::Complexes => {
            PartValue::Complexes(item.vectors()?.into_iter().map(|[re, im]| Complex64::new(re, im)).collect())
        }
        PartKind::Flags => PartValue::Flags(item.flags()?),
        PartKind::Indices => PartValue::Indices(item.indices()?),
        PartKind::Quantization => PartValue::Quantization(quantization(item)?),
    })
}

fn tiles(item: &Item<'_>) -> Read<[usize; 2]> {
    let numbers: [f64; 2] = item.numbers()?;
    if numbers.iter().any(|number| number.fract() != 0.0 || *number < 0.0) {
        return Err(item.refused("give two whole numbers, boards along x and y"));
    }
    Ok(numbers.map(|number| number as usize))
}

/// Reads an array of positions, listed in the document or in a file beside it.
fn placed(table: &Table<'_>, source: Source<'_>, draw: &mut Draw<'_>) -> Read<Array> {
    let item = table.need("positions")?;
    let normals = table.read("normals", Item::vectors)?;
    if !matches!(item.node, Node::Table(_)) {
        let (places, (_, unit)): (Vec<[f64; 3]>, _) = (item.vectors()?, unit(table.get("unit"))?);
        return Ok(Array::new(places.into_iter().map(|place| place.map(|x| x * unit)).collect(), normals)?);
    }
    let file = item.table()?;
    let (name, own) = (file.need("file")?, file.get("unit").or_else(|| table.get("unit")));
    if !positions::is_table(name.text()?) {
        let keys = [("file", Some(&name)), ("unit", own.as_ref())];
        let keys = keys.into_iter().filter_map(|(key, item)| Some((key.into(), item?.node.clone())));
        let keys = Node::Table(keys.collect());
        return match drawn::one("array.positions", &Item { path: item.path.clone(), node: &keys }, draw)? {
            Drawing::Array(array) if normals.is_none() => Ok(array),
            Drawing::Array(_) => Err(item.refused("the file has normals: leave array.normals out")),
            _ => Err(item.refused("it is drawn as points: an array is wanted")),
        };
    }
    let file =
        positions::read(name.text()?, unit(own)?.0, source).map_err(|error| Fault::at(name.path.as_str(), error))?;
    if normals.is_some() && file.normals.is_some() {
        let cure = "the file has columns nx, ny, nz: leave one of them out";
        return Err(Error::invalid("array.normals", "given twice", cure).into());
    }
    Ok(Array::new(file.positions, normals.or(file.normals))?)
}

fn directivity(item: &Item<'_>) -> Read<Directivity> {
    let named = match item.node {
        Node::Text(name) => Directivity::named(name, None),
        Node::Table(table) if table.len() == 1 => {
            let (name, node) = &table[0];
            let parameter = Item { path: format!("{}.{name}", item.path), node };
            Directivity::named(name, Some(parameter.real()?))
        }
        _ => return Err(item.refused("give a name such as \"point\", or a table of one name and its parameter")),
    };
    named.map_err(|error| match error.code {
        ErrorCode::Unknown => Fault::at(item.path.as_str(), error),
        _ => error.into(),
    })
}

/// Reads a quantization; an empty table allows any drive.
fn quantization(item: &Item<'_>) -> Read<Quantization> {
    let table = item.table()?;
    let phases = table
        .read("phases", |phases| u32::try_from(phases.integer()?).map_err(|_| phases.refused("give 2 to 65536")))?;
    let amplitudes = table.read("amplitudes", Item::reals)?;
    match table.read("pulses", Item::reals)? {
        None => Ok(Quantization::new(phases, amplitudes)?),
        Some(ticks) => Ok(Quantization::of_pulses(&ticks)?.agreeing(phases, amplitudes.as_deref())?),
    }
}

fn choice(table: &Table<'_>, board: Option<&Quantization>) -> Read<Choice> {
    let name = table.need("name")?;
    let entry = registry::find(name.text()?).map_err(|error| Fault::at("solver.name", error))?;
    let mut options = Options::new();
    for (key, node) in table.entries.iter().filter(|(key, node)| key != "name" && *node != Node::Null) {
        let item = Item { path: format!("solver.{key}"), node };
        options.insert(key.clone(), value(&item)?);
    }
    let mut choice = Choice::new(entry.info.name.into(), options)?;
    choice.options = entry.spelled(&choice.options)?;
    registry::configure(&choice, board).map_err(|error| match error.code {
        ErrorCode::Unknown => Fault::key("solver", error.value.clone(), error),
        _ => error.into(),
    })?;
    Ok(choice)
}

/// Reads the value of an option.
pub(super) fn value(item: &Item<'_>) -> Read<Value> {
    Ok(match item.node {
        Node::Bool(value) => Value::Bool(*value),
        Node::Integer(value) => Value::Integer((*value).into()),
        Node::Large(value) => Value::Integer((*value).into()),
        Node::Real(value) => Value::Real(*value),
        Node::Text(value) => Value::Text(value.clone()),
        list => match list.reals() {
            Some(values) if values.iter().all(|value| value.fract() == 0.0 && value.abs() < 1e15) => {
                Value::Integers(values.iter().map(|&value| value as i64).collect())
            }
            _ => return Err(item.refused("give a number, a word or a list of whole numbers")),
        },
    })
}

fn plane(table: &Table<'_>, scene: &Scene) -> Read<Plane> {
    let axis = table.read("axis", |axis| Axis::named(axis.text()?).map_err(|error| Fault::at("plane.axis", error)))?;
    let (z, at) = (table.read("z", Item::real)?, table.read("at", Item::real)?);
    let size = table.read("size", Item::real)?;
    let (points, wavelength) = (scene.points(), scene.medium().wavelength());
    let around = match axis.or(z.or(at).map(|_| Axis::Z)) {
        None => Plane::around(points, wavelength)[0],
        Some(axis) => Plane::layers(axis, points, wavelength)[0],
    };
    // With a given size, the default center is the array's axis. Without it, size and center follow the points.
    let center = match (size, around.axis) {
        (None, _) => around.center,
        (Some(_), Axis::Z) => [0.0, 0.0],
        (Some(_), _) => [0.0, around.center[1]],
    };
    Ok(Plane::normal_to(
        around.axis,
        Plane::place(around.axis, z, at)?.unwrap_or(around.at),
        size.unwrap_or(around.size),
        table.read("pixels", Item::count)?.unwrap_or(around.pixels),
        table.read("center", Item::numbers)?.unwrap_or(center),
    )?)
}
