//! Tables of numbers as text: rows with commas, semicolons or tabs. Columns are found by name or by their number.

use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;

use crate::error::{Error, ErrorCode, Notice, one_line};

/// The columns that a kind of file may have.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::exhaustive_structs, reason = "the words of a kind of file")]
pub struct Columns<'a> {
    /// Alternative lists of column names, the shorter first.
    pub choices: &'a [&'a [&'a str]],
    /// The units, for error messages: `in metres`.
    pub units: &'a str,
    /// A correct row, for error messages.
    pub example: &'a str,
}

/// The numbers of a file; the columns are in the order of the chosen list of names.
#[derive(Clone, Debug, Default, PartialEq)]
#[allow(clippy::exhaustive_structs, reason = "the two parts of a table")]
pub struct Table {
    /// The line of each row, counted from 1.
    pub lines: Vec<usize>,
    /// Rows of finite numbers, all of the same length.
    pub rows: Vec<Vec<f64>>,
}

/// Reads a table. If the first row contains names, they identify the columns; otherwise the number of columns does. Skips empty
/// lines and lines that begin with #. Ignores columns with other names.
///
/// # Errors
/// Text that is not UTF-8, no row; a column that is missing or there twice; a cell that is not a finite number. Each error
/// names the file and, where there is one, the line.
///
/// ```
/// use midair::files::{Columns, read_table};
///
/// let columns = Columns { choices: &[&["x", "y", "z"]], units: "in metres", example: "0.01,0.0,0.0" };
/// let table = read_table(b"z;x;y\n0.1;0.0;0.2", "bowl.csv", columns)?;
/// assert_eq!(table.rows, [[0.0, 0.2, 0.1]]);
/// # Ok::<(), midair::Error>(())
/// ```
pub fn read_table(bytes: &[u8], name: &str, columns: Columns<'_>) -> Result<Table, Error> {
    let Ok(text) = core::str::from_utf8(bytes) else {
        let (row, units) = (columns.choices[0].join(","), columns.units);
        let cure = format!("give rows of {row} {units}, for example {}", columns.example);
        return Err(fault(name, None, unreadable("", "not text", cure)));
    };
    let text = text.trim_start_matches('\u{feff}').replace("\r\n", "\n").replace('\r', "\n");
    let mut table = Table::default();
    // The chosen names and the index of each column, found in the first row.
    let mut chosen: Option<Chosen<'_>> = None;
    for (index, line) in text.split('\n').enumerate() {
        if line.trim().is_empty() || line.trim_start().starts_with('#') {
            continue;
        }
        let refused = |mut error: Error| {
            error.cure = format!("{}, for example {}", error.cure, columns.example);
            fault(name, Some(index + 1), error)
        };
        let cells = cells(line);
        if chosen.is_none() {
            let header = cells[0].parse::<f64>().is_err();
            let choice = if header { columns.named(&cells) } else { columns.counted(cells.len()) };
            chosen = Some(choice.map_err(refused)?);
            if header {
                continue;
            }
        }
        let number = |(name, column): &(&str, usize)| {
            let cell = cells.get(*column).copied().unwrap_or_default();
            let number = cell.parse::<f64>().ok().filter(|number| number.is_finite());
            number.ok_or_else(|| refused(unreadable(name, &format!("\"{cell}\""), "give a number".into())))
        };
        table.rows.push(chosen.iter().flatten().map(number).collect::<Result<_, _>>()?);
        table.lines.push(index + 1);
    }
    if table.rows.is_empty() {
        let row = columns.choices[0].join(",");
        let cure = format!("give rows {row} {}, for example {}", columns.units, columns.example);
        return Err(fault(name, None, unreadable("", "empty", cure)));
    }
    Ok(table)
}

/// The names that are read, each with the index of its column.
type Chosen<'a> = Vec<(&'a str, usize)>;

impl<'a> Columns<'a> {
    fn or(&self) -> String {
        self.choices.iter().map(|names| names.join(",")).collect::<Vec<_>>().join(" or ")
    }

    /// The columns of a table without names, by their number.
    fn counted(&self, count: usize) -> Result<Chosen<'a>, Error> {
        let fits = self.choices.iter().find(|names| names.len() == count);
        let fits = fits.map(|names| names.iter().copied().zip(0..).collect());
        let cure = || format!("give {} {}", self.or(), self.units);
        fits.ok_or_else(|| unreadable("", &format!("{count} columns"), cure()))
    }

    /// The columns of a table whose first row is `cells`, a row of names.
    fn named(&self, cells: &[&str]) -> Result<Chosen<'a>, Error> {
        let places =
            |name: &str| (0..cells.len()).filter(|&at| cells[at].eq_ignore_ascii_case(name)).collect::<Vec<_>>();
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
        for &name in *names {
            let cure = || format!("name them {}, {}", self.or(), self.units);
            match places(name).as_slice() {
                [] => {
                    let error = Notice::new(ErrorCode::Unreadable, "columns", cells.join(", "), cure());
                    return Err(Error::of(error.verb("are")));
                }
                [place] => chosen.push((name, *place)),
                _ => return Err(unreadable(&format!("column \"{name}\""), "there twice", cure())),
            }
        }
        Ok(chosen)
    }
}

fn cells(line: &str) -> Vec<&str> {
    let separator = [';', '\t'].into_iter().find(|separator| line.contains(*separator)).unwrap_or(',');
    line.split(separator).map(|cell| cell.trim().trim_matches('"').trim()).collect()
}

/// Returns an error in a file, in a line of it if that is known.
pub(super) fn fault(name: &str, line: Option<usize>, error: Error) -> Error {
    let place = line.map_or_else(|| name.to_string(), |line| format!("{name}, line {line}"));
    error.inside(one_line(&place))
}

pub(super) fn unreadable(item: &str, value: &str, cure: String) -> Error {
    Error::unreadable(item, value, cure)
}
