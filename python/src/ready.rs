//! Ready: an array prepared for a medium, stored beside the array for the next scene of both.

use std::sync::{Arc, Mutex, PoisonError};

use midair::{Doubt, Medium, Model, Obstacle, Workspace};
use pyo3::prelude::*;

use crate::error::refused;
use crate::instruction_set::instruction_set;
use crate::mesh::behind;

/// Bytes of a workspace that is kept for the next solve at most: new memory of 1 MB costs as much as G at 64 points.
const MOST_KEPT: usize = 32 << 20;

/// An array prepared for a medium, and what is probably a mistake of the two: both take O(N) and more, a scene of them O(M).
pub(crate) struct Ready {
    pub(crate) model: Model,
    pub(crate) doubts: Vec<Doubt>,
    /// The last obstacles, and the model behind them: what a body sends on takes long to find.
    behind: Mutex<Option<(Vec<Obstacle>, Model)>>,
    /// The memory of the last solve.
    work: Mutex<Option<Workspace>>,
}

impl Ready {
    /// The memory of the last solve, or new memory while that is in use.
    pub(crate) fn workspace(&self) -> Workspace {
        self.work.lock().unwrap_or_else(PoisonError::into_inner).take().unwrap_or_default()
    }

    /// Keeps memory for the next solve.
    pub(crate) fn keep(&self, work: Workspace) {
        if work.bytes() <= MOST_KEPT {
            *self.work.lock().unwrap_or_else(PoisonError::into_inner) = Some(work);
        }
    }

    /// The model behind obstacles.
    pub(crate) fn behind(&self, py: Python<'_>, obstacles: &[Obstacle]) -> PyResult<Model> {
        if obstacles.is_empty() {
            return Ok(self.model.clone());
        }
        // Never locked while others may want the GIL.
        let kept = || self.behind.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, model)) = kept().as_ref().filter(|(own, _)| own == obstacles) {
            return Ok(model.clone());
        }
        let model = behind(py, &self.model, obstacles)?;
        *kept() = Some((obstacles.to_vec(), model.clone()));
        Ok(model)
    }
}

/// The last preparation of an array. Copies share it.
#[derive(Clone, Default)]
pub(crate) struct Kept(Arc<Mutex<Option<Arc<Ready>>>>);

impl Kept {
    pub(crate) fn of(ready: Arc<Ready>) -> Self {
        Self(Arc::new(Mutex::new(Some(ready))))
    }

    /// The prepared data of the array.
    pub(crate) fn get(&self, array: &midair::Array, medium: Medium) -> PyResult<Arc<Ready>> {
        // Locked with the GIL taken, and so free whenever Python forks.
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(ready) = kept.as_ref().filter(|ready| ready.model.medium() == medium) {
            return Ok(Arc::clone(ready));
        }
        let model = Model::new(array, medium, instruction_set()?).map_err(refused)?;
        let ready =
            Arc::new(Ready { model, doubts: array.doubts(medium), behind: Mutex::default(), work: Mutex::default() });
        Ok(Arc::clone(kept.insert(ready)))
    }
}
