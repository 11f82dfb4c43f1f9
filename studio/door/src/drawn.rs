//! Drawn: points along contours, spaced so that there are at most a given number.

use midair::points::{along, fitted};
use midair::{Error, Result};

use crate::studio::Studio;

impl Studio {
    pub(crate) fn along(&mut self, most: usize) -> Result<()> {
        let (mut contours, mut left) = (Vec::new(), &self.numbers_in[..]);
        while let Some((&count, rest)) = left.split_first() {
            let vertices = rest.split_at_checked(3 * count as usize);
            let (vertices, rest) = vertices.ok_or_else(|| wrong("give each contour its number of vertices first"))?;
            contours.push(vertices.as_chunks().0.to_vec());
            left = rest;
        }
        self.numbers = fitted(most, |step| along(&contours, step))?.into_flattened();
        Ok(())
    }
}

fn wrong(cure: &str) -> Error {
    Error::invalid("numbers", "of another count", cure)
}
