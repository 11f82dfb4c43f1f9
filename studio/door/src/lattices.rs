//! Lattices: caches the matrix G of places whose field is requested repeatedly, e.g. while a point is dragged.

use midair::{Array, Complex32, Control, FieldMatrix, Medium, Model, Result, field};

/// The largest number of entries of a stored G (64 MB), and the smallest for which storing saves time.
const MOST: usize = 1 << 23;
const LEAST: usize = 1 << 18;

/// A lattice is dropped when the fields of this many other lattices were computed since its last use.
const PATIENCE: usize = 4;

/// Places above an array, and their matrix G, which is stored from the second field on.
struct Lattice {
    array: Array,
    medium: Medium,
    places: Vec<[f64; 3]>,
    kept: Option<FieldMatrix>,
    /// The number of fields of other lattices since the last use.
    age: usize,
}

impl Lattice {
    fn entries(&self) -> usize {
        self.places.len() * self.array.len()
    }
}

/// The lattices that were used recently.
#[derive(Default)]
pub(crate) struct Lattices(Vec<Lattice>);

impl Lattices {
    /// Returns the field of a drive at places.
    pub(crate) fn field(&mut self, model: &Model, drive: &[Complex32], places: &[[f64; 3]]) -> Result<Vec<Complex32>> {
        let control = &mut Control::none();
        let (array, medium) = (model.array(), model.medium());
        let entries = array.len() * places.len();
        if !(LEAST..=MOST).contains(&entries) || !model.obstacles().is_empty() || array.reflecting() > 0.0 {
            return field(model, drive, places, control);
        }
        self.0.iter_mut().for_each(|each| each.age += 1);
        let known = |each: &Lattice| each.places == places && each.medium == medium && each.array == *array;
        self.0.retain(|each| each.age <= PATIENCE || known(each));
        let full: usize = self.0.iter().filter(|each| each.kept.is_some()).map(Lattice::entries).sum();
        let Some(lattice) = self.0.iter_mut().find(|each| known(each)) else {
            self.0.push(Lattice { array: array.clone(), medium, places: places.to_vec(), kept: None, age: 0 });
            return field(model, drive, places, control);
        };
        lattice.age = 0;
        if lattice.kept.is_none() && full + entries <= MOST {
            lattice.kept = Some(FieldMatrix::new(model, places, control)?);
        }
        match &lattice.kept {
            Some(kept) => kept.field(drive, control),
            None => field(model, drive, places, control),
        }
    }
}
