//! Leaders: the few loudest of many fields.

use crate::solvers::common::tiled::{Rows, Wave};
use crate::workspace::Workspace;

/// Largest number of fields.
pub(super) const MOST: usize = 3;

/// The fields and the level of their weakest targets.
pub(super) struct Leaders<'w> {
    fields: [Option<(f32, Wave<'w>)>; MOST],
    most: usize,
}

/// Fields count as the same field if the pressures at their weakest targets differ by less than this part.
const ALIKE: f32 = 1e-5;

impl<'w> Leaders<'w> {
    /// Creates an empty list for at most `most` fields.
    pub(super) fn new(most: usize) -> Self {
        Self { fields: [const { None }; MOST], most: most.min(MOST) }
    }

    /// Adds a copy of `wave` if there is room or if it is louder than another field, which it replaces.
    pub(super) fn offer(&mut self, wave: &Wave, rows: &Rows, work: &'w Workspace) {
        let lowest = wave.lowest(rows);
        let level = |field: &Option<(f32, Wave)>| field.as_ref().map_or(f32::NEG_INFINITY, |(level, _)| *level);
        if self.fields.iter().any(|field| (level(field) / lowest - 1.0).abs() <= ALIKE) {
            return;
        }
        let last = self.fields[..self.most].iter_mut().min_by(|a, b| level(a).total_cmp(&level(b)));
        if let Some(last) = last.filter(|last| level(last) < lowest) {
            let (_, mut own) = last.take().unwrap_or_else(|| (lowest, Wave::new(rows, work)));
            own.copy(wave);
            *last = Some((lowest, own));
        }
    }

    /// Returns the stored fields.
    pub(super) fn fields(&self) -> impl Iterator<Item = &Wave<'w>> {
        self.fields.iter().flatten().map(|(_, wave)| wave)
    }
}
