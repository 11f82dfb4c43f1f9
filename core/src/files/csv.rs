//! Tables of numbers: text with columns, lists in JSON, or .npy. Columns are found by name or by their number.

use crate::error::one_line;
use crate::files::{json, npy};
use crate::prelude::*;

/// The name of a unit, and its size in SI.
type Unit = (&'static str, f64);

/// The units that the name of a column may have, the columns that have them, and their size in SI.
const UNITS: &[(&[&str], &[Unit])] = &[
    (&["x", "y", "z"], &[("m", 1.0), ("cm", 1e-2), ("mm", 1e-3), ("um", 1e-6), ("\u{b5}m", 1e-6)]),
    (&["phase"], &[("rad", 1.0), ("deg", PI / 180.0)]),
    (&["pressure"], &[("pa", 1.0), ("kpa", 1e3)]),
    (&["t"], &[("s", 1.0), ("ms", 1e-3)]),
];

/// The columns that a kind of file may have.
#[derive(Clone, Copy, Debug)]
pub struct Columns<'a> {
    /// Alternative lists of column names, the shorter first.
    pub choices: &'a [&'a [&'a str]],
    /// Columns that may follow; their value is NaN where they are missing.
    pub optional: &'a [&'a str],
    /// The units, for error messages: `in metres`.
    pub units: &'a str,
    /// A correct row, for error messages.
    pub example: &'a str,
    /// The unit of columns x, y and z whose names have none: m, cm, mm or um.
    pub length: &'a str,
}

/// The numbers of a file; the columns are in the order of the chosen list of names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// The line of each row, counted from 1.
    pub lines: Vec<usize>,
    /// Rows of finite numbers, all of the same length; NaN for an optional column that is missing.
    pub rows: Vec<Vec<f64>>,
}

/// Reads a table: text, or a list of rows in JSON, or an .npy of shape (N, C).
///
/// In text, semicolons, tabs, commas or spaces separate the cells; without commas between them, numbers may have decimal commas.
/// In JSON a row is a list, or a table of names.
/// If the first row contains names, they identify the columns; otherwise the number of columns does. A name may have a unit, as
/// `x (mm)` or `x_mm`; the numbers are converted to SI. Skips empty lines and lines that begin with #, % or //. Ignores columns
/// with other names.
///
/// # Errors
/// Text that is neither UTF-8 nor UTF-16, no row; a column that is missing or there twice, an unknown unit, a first column
/// that counts the rows; a cell that is not a finite number. Each error names the file and, where there is one, the line.
///
/// ```
/// use midair::files::{Columns, read_table};
///
/// let (choices, example): (&[&[_]], _) = (&[&["x", "y", "z"]], "0.01,0.0,0.0");
/// let columns = Columns { choices, optional: &[], units: "in metres", example, length: "mm" };
/// let table = read_table(b"z (m);x;y\n0.1;0.0;200", "bowl.csv", columns)?;
/// assert_eq!(table.rows, [[0.0, 0.2, 0.1]]);
/// # Ok::<(), midair::Error>(())
/// ```
pub fn read_table(bytes: &[u8], name: &str, columns: Columns<'_>) -> Result<Table> {
    length(columns.length)?;
    let none = |value: &str| {
        let (row, units) = (columns.choices[0].join(","), columns.units);
        let cure = format!("give rows {row} {units}, for example {}", columns.example);
        fault(name, None, unreadable("", value, cure))
    };
    if let Some(array) = npy::read(bytes) {
        let array = array.map_err(|cure| fault(name, None, unreadable("", "no table", cure)))?;
        let (&[_, width], false) = (&*array.shape, array.numbers.is_empty()) else {
            return Err(none(&format!("an array of shape {:?}", array.shape)));
        };
        return columns
            .plain(array.numbers.chunks(width).map(<[f64]>::to_vec).collect(), name)
            .ok_or_else(|| none("empty"))?;
    }
    let Some(text) = decoded(bytes) else { return Err(none("not text")) };
    let text = text.trim_start_matches('\u{feff}').replace("\r\n", "\n").replace('\r', "\n");
    if text.trim_start().starts_with('[') {
        let wrong = |error| fault(name, None, error);
        let (names, mut rows) =
            json::rows(&text).map_err(|reason| wrong(unreadable("", &reason, "give [[x, y, z], ...]".into())))?;
        if !names.is_empty() {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let chosen = columns.named(&names).map_err(wrong)?;
            for (k, row) in rows.iter_mut().enumerate() {
                if let Some(column) = chosen.iter().find(|column| column.at.is_some_and(|at| !row[at].is_finite())) {
                    let item = format!("{} of row {k}", column.name);
                    return Err(wrong(unreadable(&item, "no number", "give a number".into())));
                }
                *row = chosen.iter().map(|column| column.at.map_or(f64::NAN, |at| row[at] * column.unit)).collect();
            }
            return Ok(Table { lines: (1..=rows.len()).collect(), rows });
        }
        return columns.plain(rows, name).ok_or_else(|| none("empty"))?;
    }
    let mut table = Table::default();
    // The chosen columns, found in the first row; and the number of names.
    let mut chosen: Option<Vec<Column<'_>>> = None;
    let mut named = usize::MAX;
    for (index, line) in text.split('\n').enumerate() {
        if ["#", "%", "//"].iter().any(|mark| line.trim_start().starts_with(mark)) || is_separator(index, line) {
            continue;
        }
        let refused = |mut error: Error| {
            error.cure = format!("{}, for example {}", error.cure, columns.example);
            fault(name, Some(index + 1), error)
        };
        // A unit stays with its name where spaces separate the names.
        let line = line.replace(" (", "(").replace(" [", "[");
        let cells = cells(&line);
        if cells.is_empty() {
            continue;
        }
        if chosen.is_none() {
            let header = decimal(cells[0]).is_none();
            let choice = if header { columns.named(&cells) } else { columns.counted(cells.len()) };
            chosen = Some(choice.map_err(refused)?);
            if header {
                named = cells.len();
                continue;
            }
        }
        if cells.len() > named {
            let value = format!("{} cells under {named} names", cells.len());
            return Err(refused(unreadable("", &value, "name each column".into())));
        }
        let number = |column: &Column<'_>| {
            let Some(at) = column.at else { return Ok(f64::NAN) };
            let cell = cells.get(at).copied().unwrap_or_default();
            let number = decimal(cell).filter(|number| number.is_finite());
            let wrong = || refused(unreadable(column.name, &format!("\"{cell}\""), "give a number".into()));
            number.map(|number| number * column.unit).ok_or_else(wrong)
        };
        table.rows.push(chosen.iter().flatten().map(number).collect::<Result<_, _>>()?);
        table.lines.push(index + 1);
    }
    refuse_if!(table.rows.is_empty(), none("empty"));
    if named == usize::MAX {
        columns.check_first(&table.rows, name)?;
    }
    Ok(table)
}

/// The text of a file in UTF-8, or in UTF-16 with a byte order mark, as Excel writes it.
fn decoded(bytes: &[u8]) -> Option<String> {
    let of = |rest: &[u8], unit: fn([u8; 2]) -> u16| {
        let (pairs, odd) = rest.as_chunks();
        let text = char::decode_utf16(pairs.iter().map(|&pair| unit(pair))).collect::<Result<_, _>>().ok();
        text.filter(|_| odd.is_empty())
    };
    match bytes {
        [0xff, 0xfe, rest @ ..] => of(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => of(rest, u16::from_be_bytes),
        _ => core::str::from_utf8(bytes).ok().map(ToString::to_string),
    }
}

/// Whether a line is the first of a file and names its separator, as Excel writes it: sep=;
fn is_separator(index: usize, line: &str) -> bool {
    index == 0 && line.trim_matches(['\u{feff}', '"', ' ']).to_ascii_lowercase().starts_with("sep=")
}

/// A column that is read: its name, its index in the file if it is there, and its unit in SI.
struct Column<'a> {
    name: &'a str,
    at: Option<usize>,
    unit: f64,
}

impl<'a> Columns<'a> {
    /// The size in SI of the unit of a column whose name states none.
    fn own(&self, name: &str) -> f64 {
        if UNITS[0].0.contains(&name) { length(self.length).unwrap_or(1.0) } else { 1.0 }
    }

    fn or(&self) -> String {
        self.choices.iter().map(|names| names.join(",")).collect::<Vec<_>>().join(" or ")
    }

    /// A table of rows without names; `None` if it is empty.
    fn plain(&self, mut rows: Vec<Vec<f64>>, name: &str) -> Option<Result<Table>> {
        let count = rows.first()?.len();
        let wrong = |row: &Vec<f64>| row.len() != count || row.iter().any(|x| !x.is_finite());
        if let Some(index) = rows.iter().position(wrong) {
            let error = unreadable(
                &format!("row {index}"),
                &format!("{:?}", rows[index]),
                format!("give {count} finite numbers"),
            );
            return Some(Err(fault(name, None, error)));
        }
        let chosen = self.counted(count).map_err(|error| fault(name, None, error));
        Some(chosen.and_then(|chosen| {
            for row in &mut rows {
                row.resize(chosen.len(), f64::NAN);
                row.iter_mut().zip(&chosen).for_each(|(number, column)| *number *= column.unit);
            }
            self.check_first(&rows, name)?;
            Ok(Table { lines: (1..=rows.len()).collect(), rows })
        }))
    }

    /// Checks that the first column of a table without names is x, and does not count the rows, as that of pandas does.
    fn check_first(&self, rows: &[Vec<f64>], name: &str) -> Result<()> {
        let counts = |first| rows.iter().zip(first..).all(|(row, k)| row[0] == f64::from(k) * self.own("x"));
        let count = rows[0].iter().filter(|x| !x.is_nan()).count();
        let spare = self.choices[0].first() == Some(&"x") && self.counted(count - 1).is_ok();
        if spare && rows.len() > 1 && (counts(0) || counts(1)) {
            let cure = format!("name the columns {}, or leave it out", self.or());
            return Err(fault(name, None, unreadable("", "a table whose first column counts the rows", cure)));
        }
        Ok(())
    }

    /// The columns of a table without names, by their number.
    fn counted(&self, count: usize) -> Result<Vec<Column<'a>>> {
        let fits = |names: &&&[&str]| (names.len()..=names.len() + self.optional.len()).contains(&count);
        let Some(names) = self.choices.iter().rev().find(fits) else {
            return Err(unreadable("", &format!("{count} columns"), format!("give {} {}", self.or(), self.units)));
        };
        let all = names.iter().chain(self.optional).enumerate();
        Ok(all.map(|(at, &name)| Column { name, at: (at < count).then_some(at), unit: self.own(name) }).collect())
    }

    /// The columns of a table whose first row is `cells`, a row of names.
    fn named(&self, cells: &[&str]) -> Result<Vec<Column<'a>>> {
        let places = |name: &str| {
            let each = cells.iter().enumerate();
            let all: Vec<_> = each.filter_map(|(at, cell)| Some((at, unit(cell, name, self.own(name))?))).collect();
            // Beside x, a column such as x_error is another one.
            let known = all.iter().any(|(_, unit)| unit.is_ok());
            all.into_iter().filter(|(_, unit)| unit.is_ok() || !known).collect::<Vec<_>>()
        };
        // Whether the first row contains a name that no shorter list of names has. Lists are tried from the longest
        // down.
        let begun = |names: &&&[&str]| {
            names.last().is_some()
                && names.iter().any(|name| {
                    !places(name).is_empty()
                        && !self.choices.iter().any(|other| other.len() < names.len() && other.contains(name))
                })
        };
        let names = self.choices.iter().rev().find(begun).unwrap_or(&self.choices[0]);
        let mut chosen = Vec::new();
        for &name in names.iter().chain(self.optional) {
            let cure = || format!("name them {}, {}", self.or(), self.units);
            match &*places(name) {
                [] if self.optional.contains(&name) => chosen.push(Column { name, at: None, unit: 1.0 }),
                [] => {
                    let error = Notice::new(ErrorCode::Unreadable, "columns", cells.join(", "), cure());
                    return Err(Error::of(error.verb("are")));
                }
                [(at, Ok(unit))] => chosen.push(Column { name, at: Some(*at), unit: *unit }),
                [(at, Err(()))] => {
                    let units =
                        UNITS.iter().find(|(names, _)| names.contains(&name)).map_or(&[][..], |(_, units)| units);
                    let units = units.iter().map(|(unit, _)| *unit).collect::<Vec<_>>().join(", ");
                    let cure = if units.is_empty() { "give it without a unit".into() } else { format!("give {units}") };
                    return Err(unreadable("column", &format!("\"{}\", whose unit is unknown", cells[*at]), cure));
                }
                _ => return Err(unreadable(&format!("column \"{name}\""), "there twice", cure())),
            }
        }
        Ok(chosen)
    }
}

/// The size in m of a unit of length.
///
/// # Errors
/// An unknown unit.
pub fn length(unit: &str) -> Result<f64> {
    let (_, units) = UNITS[0];
    let found = units.iter().find(|(name, _)| *name == unit);
    found.map(|(_, size)| *size).ok_or_else(|| Error::unknown("unit", unit, units[..4].iter().map(|(name, _)| *name)))
}

/// The unit in SI of a cell that names a column, as `x`, `X (mm)`, `x_mm` or `x in mm`, its `own` if it states none; `None` if it
/// names another column, an error if its unit is unknown.
fn unit(cell: &str, name: &str, own: f64) -> Option<Result<f64, ()>> {
    let (start, rest) = cell.split_at_checked(name.len())?;
    if !start.eq_ignore_ascii_case(name) || !(rest.is_empty() || rest.starts_with([' ', '(', '[', '_', '/'])) {
        return None;
    }
    let bare = rest.trim_matches([' ', '(', ')', '[', ']', '_', '/', '.']).to_lowercase();
    let bare = bare.strip_prefix("in ").unwrap_or(&bare);
    if bare.is_empty() {
        return Some(Ok(own));
    }
    let mut units = UNITS.iter().filter(|(names, _)| names.contains(&name)).flat_map(|(_, units)| *units);
    Some(units.find(|(unit, _)| *unit == bare).map(|(_, size)| *size).ok_or(()))
}

/// Reads a number, which may have a decimal comma.
fn decimal(cell: &str) -> Option<f64> {
    let comma = || if cell.contains('.') { None } else { cell.replacen(',', ".", 1).parse().ok() };
    cell.parse().ok().or_else(comma)
}

/// The cells of a line, without empty ones at its end.
fn cells(line: &str) -> Vec<&str> {
    let spaced = || line.split_whitespace();
    let separator = [';', '\t', ','].into_iter().find(|separator| line.contains(*separator));
    let mut cells: Vec<&str> = match separator {
        // Decimal commas between spaces; "1, 2, 3" has commas at the ends instead.
        Some(',') if spaced().count() > 1 && spaced().all(|cell| !cell.starts_with(',') && decimal(cell).is_some()) => {
            spaced().collect()
        }
        Some(separator) => line.split(separator).map(|cell| cell.trim().trim_matches('"').trim()).collect(),
        None => spaced().map(|cell| cell.trim_matches('"')).collect(),
    };
    while cells.last().is_some_and(|cell| cell.is_empty()) {
        cells.pop();
    }
    cells
}

/// Returns an error in a file, in a line of it if that is known.
pub(super) fn fault(name: &str, line: Option<usize>, error: Error) -> Error {
    let place = line.map_or_else(|| name.to_string(), |line| format!("{name}, line {line}"));
    error.inside(one_line(&place))
}

pub(super) fn unreadable(item: &str, value: &str, cure: String) -> Error {
    Error::unreadable(item, value, cure)
}
