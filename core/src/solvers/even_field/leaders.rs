//! Leaders: the loudest few of many fields.

use crate::solvers::common::tiled::{Rows, Wave};
use crate::workspace::Workspace;

/// Fields at most.
pub(super) const MOST: usize = 3;

/// The weakest target of each field, and the field.
pub(super) struct Leaders<'w> {
    fields: [Option<(f32, Wave<'w>)>; MOST],
    most: usize,
}

/// Fields whose weakest targets agree to this part are one field.
const ALIKE: f32 = 1e-5;

impl<'w> Leaders<'w> {
    /// Of at most `most`.
    pub(super) fn new(most: usize) -> Self {
        Self { fields: [const { None }; MOST], most: most.min(MOST) }
    }

    /// Keeps a copy of `wave` if it is louder than another, or there is room.
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

    /// The fields kept.
    pub(super) fn fields(&self) -> impl Iterator<Item = &Wave<'w>> {
        self.fields.iter().flatten().map(|(_, wave)| wave)
    }
}
