//! Dense: the whole matrix G, computed for some points at a time.

use crate::prelude::*;
use crate::propagation::Propagation;

/// The number of entries of the propagation matrix G that are computed together. The memory of a block is not touched
/// before the block is computed.
const ENTRIES_A_BLOCK: usize = 1 << 18;

impl Propagation {
    /// Returns the propagation matrix G (M, N) in Pa, point by point. The entries are those that the solvers use.
    ///
    /// # Errors
    /// A point on a transducer; more memory than allowed; a stop by the caller.
    pub fn matrix(&self, control: &mut Control) -> Result<Vec<Complex32>> {
        let n = self.transducers();
        control.room("the matrix G", [n, self.count], bytes(8, &[n, self.count]))?;
        self.reach(&mut Vec::new(), None, control)?;
        let mut matrix = Vec::with_capacity(n * self.count);
        let all: Vec<usize> = (0..self.count).collect();
        for chosen in all.chunks((ENTRIES_A_BLOCK / n).clamp(16, 256)) {
            let some = self.select(chosen);
            let (mut re, mut im) = (vec![0.0; some.lanes()], vec![0.0; some.lanes()]);
            let mut block = vec![Complex32::ZERO; n * chosen.len()];
            for i in 0..n {
                control.pulse()?;
                some.row(i, &mut re, &mut im);
                for j in 0..chosen.len() {
                    let g = Complex64::new(f64::from(re[j]), f64::from(im[j])) * self.reference();
                    block[j * n + i] = Complex32::new(g.re as f32, g.im as f32);
                }
            }
            matrix.extend_from_slice(&block);
        }
        Ok(matrix)
    }
}
