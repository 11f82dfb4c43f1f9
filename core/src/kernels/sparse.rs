//! Sparse complex symmetric systems (A + s B) x = b with a diagonal B, for several shifts s at once, one in each lane.
//!
//! The matrices of all shifts have the same pattern of non-zero entries. Each entry of the factor L in A + s B = L D
//! L^T is a vector of lanes, and each index is read once for all shifts. There is no pivoting, so no pivot may vanish.
//!
//! The method is that of T. A. Davis, "Direct Methods for Sparse Linear Systems" (SIAM 2006), chapters 4 and 6:
//! elimination tree, left-looking factorisation.

use crate::kernels::prelude::*;

/// Number of shifts whose systems are solved at once.
pub(crate) const SHIFTS: usize = 8;

/// One complex number for each shift: real and imaginary parts.
pub(crate) type Wide = [[f32; SHIFTS]; 2];

const NONE: usize = usize::MAX;

/// Pattern of a lower triangle without its diagonal: the rows of column j are `rows[starts[j]..starts[j + 1]]`,
/// ascending.
#[derive(Clone, Debug)]
pub(crate) struct Columns {
    pub(crate) starts: Vec<usize>,
    pub(crate) rows: Vec<u32>,
}

impl Columns {
    /// Returns the pattern of the factor L of a symmetric matrix with this pattern.
    pub(crate) fn of_factor(&self) -> Self {
        let count = self.starts.len() - 1;
        let (mut starts, mut rows) = (vec![0], Vec::<u32>::new());
        let mut seen_by = vec![NONE; count];
        // For each column j, the columns of L whose first row is j. The other rows of these columns are rows of column
        // j, too.
        let mut children = vec![Vec::new(); count];
        for j in 0..count {
            let first = rows.len();
            seen_by[j] = j;
            let mut add = |rows: &mut Vec<u32>, row: u32| {
                if core::mem::replace(&mut seen_by[row as usize], j) != j {
                    rows.push(row);
                }
            };
            self.rows[self.starts[j]..self.starts[j + 1]].iter().for_each(|&row| add(&mut rows, row));
            for child in core::mem::take(&mut children[j]) {
                let [from, to]: [usize; 2] = [starts[child], starts[child + 1]];
                for k in from..to {
                    let row = rows[k];
                    add(&mut rows, row);
                }
            }
            rows[first..].sort_unstable();
            starts.push(rows.len());
            if let Some(&parent) = rows.get(first) {
                children[parent as usize].push(j);
            }
        }
        Self { starts, rows }
    }
}

/// c -= a b for each shift.
#[inline(always)]
fn subtract_product(c: &mut Wide, a: &Wide, b: &Wide) {
    for lane in 0..SHIFTS {
        let [ar, ai, br, bi] = [a[0][lane], a[1][lane], b[0][lane], b[1][lane]];
        c[0][lane] -= ar * br - ai * bi;
        c[1][lane] -= ar * bi + ai * br;
    }
}

/// Returns a b for each shift.
#[inline(always)]
fn product(a: &Wide, b: &Wide) -> Wide {
    let mut negative = [[0.0; SHIFTS]; 2];
    subtract_product(&mut negative, a, b);
    negative.map(|part| part.map(|x| -x))
}

/// Returns 1/a for each shift.
#[inline(always)]
fn inverse(a: &Wide) -> Wide {
    let mut quotient = [[0.0; SHIFTS]; 2];
    for lane in 0..SHIFTS {
        let square = a[0][lane] * a[0][lane] + a[1][lane] * a[1][lane];
        quotient[0][lane] = a[0][lane] / square;
        quotient[1][lane] = -a[1][lane] / square;
    }
    quotient
}

/// A matrix A + s B: the pattern and the `values` of A's lower triangle, A's `diagonal`, and that of B (`shares`).
pub(crate) struct Matrix<'a> {
    pub(crate) columns: &'a Columns,
    pub(crate) values: &'a [f32],
    pub(crate) diagonal: &'a [f32],
    pub(crate) shares: &'a [f32],
}

/// Replaces b (V,) by the solution x of (A + s B) x = b. It is given the pattern of the factor L, and memory with one
/// entry for each entry of L.
///
/// # Errors
/// A requested stop, which is checked once a column.
pub(crate) fn solve(
    set: InstructionSet,
    matrix: &Matrix,
    pattern: &Columns,
    factor: &mut [Wide],
    shifts: &Wide,
    b: &mut [Wide],
    control: &mut Control,
) -> Result<()> {
    let count = b.len();
    let none = [[0.0; SHIFTS]; 2];
    let [mut pivots, mut inverses, mut column] = [(); 3].map(|()| vec![none; count]);
    // Linked lists of columns: `head[j]` is the first column whose next row is j, `next[k]` the column after column k
    // in its list, and `at[k]` the index of the next entry of column k.
    let (mut head, mut next, mut at) = (vec![NONE; count], vec![NONE; count], vec![0; count]);
    for j in 0..count {
        control.pulse()?;
        dispatch!(set, _s => {
            column[j] = shifts.map(|part| part.map(|s| s * matrix.shares[j]));
            column[j][0].iter_mut().for_each(|x| *x += matrix.diagonal[j]);
            let range = matrix.columns.starts[j]..matrix.columns.starts[j + 1];
            for (&row, &value) in matrix.columns.rows[range.clone()].iter().zip(&matrix.values[range]) {
                column[row as usize][0] = [value; SHIFTS];
            }
            let mut k = head[j];
            while k != NONE {
                let (from, to) = (at[k], pattern.starts[k + 1]);
                let scaled = product(&factor[from], &pivots[k]);
                for (&row, entry) in pattern.rows[from..to].iter().zip(&factor[from..to]) {
                    subtract_product(&mut column[row as usize], entry, &scaled);
                }
                let following = next[k];
                at[k] = from + 1;
                if at[k] < to {
                    let row = pattern.rows[at[k]] as usize;
                    (next[k], head[row]) = (head[row], k);
                }
                k = following;
            }
            pivots[j] = core::mem::replace(&mut column[j], none);
            inverses[j] = inverse(&pivots[j]);
            let range = pattern.starts[j]..pattern.starts[j + 1];
            for (&row, entry) in pattern.rows[range.clone()].iter().zip(&mut factor[range.clone()]) {
                *entry = product(&core::mem::replace(&mut column[row as usize], none), &inverses[j]);
            }
            if let Some(&row) = pattern.rows[range.clone()].first() {
                at[j] = range.start;
                (next[j], head[row as usize]) = (head[row as usize], j);
            }
        });
    }
    dispatch!(set, _s => {
        for j in 0..count {
            let range = pattern.starts[j]..pattern.starts[j + 1];
            let x = b[j];
            for (&row, entry) in pattern.rows[range.clone()].iter().zip(&factor[range]) {
                subtract_product(&mut b[row as usize], entry, &x);
            }
        }
        for j in (0..count).rev() {
            let range = pattern.starts[j]..pattern.starts[j + 1];
            let mut x = product(&b[j], &inverses[j]);
            for (&row, entry) in pattern.rows[range.clone()].iter().zip(&factor[range]) {
                subtract_product(&mut x, entry, &b[row as usize]);
            }
            b[j] = x;
        }
    });
    Ok(())
}
