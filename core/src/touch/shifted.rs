//! Sparse systems (A + s B) x = b with a real symmetric A and a diagonal B, for many complex shifts s.

use crate::kernels::InstructionSet;
use crate::kernels::sparse::{Columns, Matrix, SHIFTS, Wide, solve};
use crate::prelude::*;

/// Systems (A + s B) x = b of finite elements: A is a stiffness (V, V), B a diagonal of masses, one for each corner
/// (V,).
///
/// Each matrix A + s B is factored as L D L^T without pivoting. This is possible where A is positive semidefinite, all
/// masses are positive, and s is positive or not real.
#[derive(Clone, Debug)]
pub struct Shifted {
    columns: Columns,
    values: Vec<f32>,
    diagonal: Vec<f32>,
    shares: Vec<f32>,
    factor: Columns,
}

impl Shifted {
    /// Creates the systems from the columns of A: the rows of column j, ascending, are `rows[starts[j]..starts[j +
    /// 1]]`, and `values` has an entry for each row. `shares` (V,) is the diagonal of B. Of the entries only the
    /// diagonal and the lower triangle are used. The caller chooses an order of the corners that keeps the factor
    /// sparse.
    ///
    /// # Errors
    /// Lengths that do not fit, a row that is out of range or not in order, a value that is not finite.
    pub fn new(starts: &[usize], rows: &[u32], values: &[f64], shares: &[f64]) -> Result<Self> {
        let count = shares.len();
        let fits = starts.len() == count + 1 && rows.len() == values.len() && starts.last() == Some(&rows.len());
        if !fits || !starts.is_sorted() {
            let sizes = format!("{} columns and {} entries", starts.len().saturating_sub(1), rows.len());
            return Err(Error::invalid("starts", sizes, format!("give {count} columns that contain all entries")));
        }
        let mut system = Self {
            columns: Columns { starts: vec![0], rows: Vec::new() },
            values: Vec::new(),
            diagonal: vec![0.0; count],
            shares: shares.iter().map(|&share| share as f32).collect(),
            factor: Columns { starts: vec![0], rows: Vec::new() },
        };
        for j in 0..count {
            let column = starts[j]..starts[j + 1];
            if !rows[column.clone()].is_sorted_by(|a, b| a < b)
                || rows[column.clone()].iter().any(|&row| row as usize >= count)
            {
                let cure = format!("give rows below {count} in order");
                return Err(Error::invalid(format!("column {j}"), "not sorted", cure));
            }
            for k in column {
                let (row, value) = (rows[k] as usize, values[k]);
                refuse_if!(!value.is_finite(), Error::invalid(format!("values[{k}]"), value, "give finite values"));
                if row == j {
                    system.diagonal[j] = value as f32;
                } else if row > j {
                    system.columns.rows.push(rows[k]);
                    system.values.push(value as f32);
                }
            }
            system.columns.starts.push(system.columns.rows.len());
        }
        system.factor = system.columns.of_factor();
        Ok(system)
    }

    /// Solves one system for each shift in single precision: returns x (L, V) for `shifts` (L,) and right sides `loads`
    /// (L, V).
    ///
    /// The time is O(L sum_j n_j^2), n_j the number of entries in column j of the factor. Groups of 8 shifts need 64
    /// bytes of memory for each entry of the factor.
    ///
    /// # Errors
    /// Loads of another length; more memory than allowed; a stop.
    pub fn solve(
        &self,
        set: InstructionSet,
        shifts: &[Complex64],
        loads: &[Complex32],
        control: &mut Control,
    ) -> Result<Vec<Complex32>> {
        let count = self.shares.len();
        if loads.len() != shifts.len() * count {
            let cure = format!("give {count} for each of the {} shifts", shifts.len());
            return Err(Error::shape("loads", format!("{} numbers", loads.len()), cure));
        }
        control.room("the factors", [count, self.factor.rows.len()], bytes(8 * SHIFTS, &[self.factor.rows.len()]))?;
        let matrix =
            Matrix { columns: &self.columns, values: &self.values, diagonal: &self.diagonal, shares: &self.shares };
        let mut solutions = vec![Complex32::default(); loads.len()];
        let [mut factor, mut wide] = [self.factor.rows.len(), count].map(|length| vec![[[0.0; SHIFTS]; 2]; length]);
        for (group, some) in shifts.chunks(SHIFTS).enumerate() {
            let first = group * SHIFTS;
            // Lanes without a shift repeat the first shift of the group, so that no pivot is 0.
            let shift = |lane: usize| some.get(lane).unwrap_or(&some[0]);
            let lanes: Wide = [
                core::array::from_fn(|lane| shift(lane).re as f32),
                core::array::from_fn(|lane| shift(lane).im as f32),
            ];
            for (row, wide) in wide.iter_mut().enumerate() {
                *wide = [[0.0; SHIFTS]; 2];
                for lane in 0..some.len() {
                    let load = loads[(first + lane) * count + row];
                    (wide[0][lane], wide[1][lane]) = (load.re, load.im);
                }
            }
            solve(set, &matrix, &self.factor, &mut factor, &lanes, &mut wide, control)?;
            for (row, wide) in wide.iter().enumerate() {
                for lane in 0..some.len() {
                    solutions[(first + lane) * count + row] = Complex32::new(wide[0][lane], wide[1][lane]);
                }
            }
        }
        Ok(solutions)
    }
}

#[cfg(test)]
#[path = "tests/shifted.rs"]
mod tests;
