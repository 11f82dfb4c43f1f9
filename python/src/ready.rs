//! Ready: an array prepared for a medium, stored beside the array and reused by the next scene with both.

use std::sync::{Mutex, PoisonError};

use midair::{InstructionSet, Medium, Notice, Obstacle, Workspace};

use crate::mesh::behind;
use crate::prelude::*;

/// Largest size in bytes of a workspace that is stored for the next solve. Allocating 1 MB costs as much time as G for 64
/// points.
const MOST_KEPT: usize = 32 << 20;

/// An array prepared for a medium, and probable mistakes in them. Preparing takes time O(N) or more, a scene only O(M).
pub(crate) struct Ready {
    pub(crate) model: Model,
    pub(crate) doubts: Vec<Notice>,
    /// The last obstacles and the model with them: computing what they reflect takes long.
    behind: Mutex<Option<(Vec<Obstacle>, Model)>>,
    shared: Arc<Shared>,
}

/// What scenes of an array share, whatever their medium.
#[derive(Default)]
struct Shared {
    /// The last array that has other parts instead of this array's, and its cache.
    changed: Mutex<Option<(midair::Array, Cache)>>,
    /// Workspace of the last solve, also of the arrays with other parts.
    work: Arc<Mutex<Option<Workspace>>>,
}

impl Ready {
    /// Returns the workspace of the last solve; a new one if there is none or another call uses it.
    pub(crate) fn workspace(&self) -> Workspace {
        self.shared.work.lock().unwrap_or_else(PoisonError::into_inner).take().unwrap_or_default()
    }

    /// Stores a workspace for the next solve, unless it is too large.
    pub(crate) fn keep(&self, work: Workspace) {
        if work.bytes() <= MOST_KEPT {
            *self.shared.work.lock().unwrap_or_else(PoisonError::into_inner) = Some(work);
        }
    }

    /// Returns the model with the optional parts of a scene.
    pub(crate) fn model_with(&self, py: Python<'_>, extras: Extras) -> PyResult<Model> {
        let Extras { signature, bead, obstacles, solver: _, plane: _ } = extras;
        Ok(self.behind(py, &obstacles)?.with_signature(signature).with_bead(bead))
    }

    /// Returns the model with these obstacles.
    fn behind(&self, py: Python<'_>, obstacles: &[Obstacle]) -> PyResult<Model> {
        if obstacles.is_empty() {
            return Ok(self.model.clone());
        }
        // Locked only for short operations that do not wait for the GIL, to avoid a deadlock.
        let cache = || self.behind.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, model)) = cache().as_ref().filter(|(known, _)| known == obstacles) {
            return Ok(model.clone());
        }
        let model = behind(py, &self.model, obstacles)?;
        *cache() = Some((obstacles.to_vec(), model.clone()));
        Ok(model)
    }
}

/// The last prepared form of an array. Copies share it.
#[derive(Clone, Default)]
pub(crate) struct Cache {
    ready: Arc<Mutex<Option<Arc<Ready>>>>,
    shared: Arc<Shared>,
}

impl Cache {
    pub(crate) fn of(ready: Arc<Ready>) -> Self {
        let shared = Arc::clone(&ready.shared);
        Self { ready: Arc::new(Mutex::new(Some(ready))), shared }
    }

    /// Returns the cache of an array with other parts than this cache's array. Equal arrays have the same.
    pub(crate) fn changed(&self, array: &midair::Array) -> Self {
        let mut changed = self.shared.changed.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, cache)) = changed.as_ref().filter(|(known, _)| known == array) {
            return cache.clone();
        }
        let shared = Shared { work: Arc::clone(&self.shared.work), ..Shared::default() };
        let cache = Self { shared: Arc::new(shared), ..Self::default() };
        changed.insert((array.clone(), cache)).1.clone()
    }

    /// Returns the array prepared for a medium.
    pub(crate) fn get(&self, array: &midair::Array, medium: Medium) -> PyResult<Arc<Ready>> {
        // Only a thread with the GIL takes this lock, so it is never locked when Python forks.
        let mut cache = self.ready.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(ready) = cache.as_ref().filter(|ready| ready.model.medium() == medium) {
            return Ok(Arc::clone(ready));
        }
        let model = Model::new(array, medium, InstructionSet::requested().map_err(refused)?).map_err(refused)?;
        let (doubts, shared) = (array.doubts(medium), Arc::clone(&self.shared));
        Ok(Arc::clone(cache.insert(Arc::new(Ready { model, doubts, behind: Mutex::default(), shared }))))
    }
}
