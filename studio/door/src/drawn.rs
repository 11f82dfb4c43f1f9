//! Drawn: points along circles and contours, spaced so that they are few enough.

use midair::Error;
use midair::points::{Curve, along, fitted};

use crate::studio::Studio;

impl Studio {
    pub(crate) fn circle(&mut self, most: usize) -> Result<(), Error> {
        let &[x, y, z, radius] = &self.numbers_in[..] else { return Err(wrong("give a center and a radius")) };
        let circle = Curve::circle([x, y, z], radius, [0.0, 0.0, 1.0], 0.0)?;
        self.draw(most, |step| circle.points(step))
    }

    pub(crate) fn along(&mut self, most: usize) -> Result<(), Error> {
        let (mut contours, mut left) = (Vec::new(), &self.numbers_in[..]);
        while let Some((&count, rest)) = left.split_first() {
            let vertices = rest.split_at_checked(3 * count as usize);
            let (vertices, rest) = vertices.ok_or_else(|| wrong("give each contour its number of vertices first"))?;
            contours.push(vertices.as_chunks().0.to_vec());
            left = rest;
        }
        self.draw(most, |step| along(&contours, step))
    }

    fn draw(&mut self, most: usize, make: impl FnMut(f64) -> Result<Vec<[f64; 3]>, Error>) -> Result<(), Error> {
        self.numbers = fitted(most, make)?.into_flattened();
        Ok(())
    }
}

fn wrong(cure: &str) -> Error {
    Error::invalid("numbers", "of another count", cure)
}
