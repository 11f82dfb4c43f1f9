//! Model of G: an array in a medium, prepared once for control points that change.

use alloc::sync::Arc;

use crate::error::Error;
use crate::kernels::InstructionSet;
use crate::propagation::Propagation;
use crate::propagation::sources::Sources;
use crate::scene::{Array, Medium, Scene, Signature, check_array};

/// An array in a medium, made ready once for points that change: what a scene is for points that do not.
///
/// ```
/// use midair::{Array, InstructionSet, Medium, Model};
///
/// let model = Model::new(&Array::grid(8, 8, 10e-3)?, Medium::default(), InstructionSet::best())?;
/// let propagation = model.propagation(&[[0.0, 0.0, 0.1]])?;
/// assert_eq!((propagation.points(), propagation.transducers()), (1, 64));
/// # Ok::<(), midair::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Model {
    pub(crate) sources: Arc<Sources>,
    pub(crate) set: InstructionSet,
    signature: Option<Signature>,
}

impl Model {
    /// Makes an array ready.
    ///
    /// # Errors
    /// As [`Scene::new`]: a medium out of range, a beam too narrow or a transducer too far away for f32 phases.
    pub fn new(array: &Array, medium: Medium, set: InstructionSet) -> Result<Self, Error> {
        check_array(array, medium)?;
        Ok(Self { sources: Arc::new(Sources::new(array, medium)), set, signature: None })
    }

    /// That of a scene, which has been checked.
    #[must_use]
    pub fn of(scene: &Scene, set: InstructionSet) -> Self {
        Self {
            sources: Arc::new(Sources::new(scene.array(), scene.medium())),
            set,
            signature: scene.signature().cloned(),
        }
    }

    /// The same under a signature: what it is solved with. The field of a drive is that of the array itself.
    #[must_use]
    pub fn with_signature(self, signature: Option<Signature>) -> Self {
        Self { signature, ..self }
    }

    /// G at some points (M, 3) in m, times the factors of the signature if there is one.
    ///
    /// # Errors
    /// No point, a coordinate that is not finite or too far away; factors that do not fit, and more than 2^20 entries under
    /// a signature.
    pub fn propagation(&self, points: &[[f64; 3]]) -> Result<Propagation, Error> {
        self.sources.check_points(points)?;
        let sources = Arc::clone(&self.sources);
        match &self.signature {
            None => Ok(Propagation::at(sources, points.into(), self.set)),
            Some(signature) => Propagation::signed(sources, points.into(), signature.clone(), self.set),
        }
    }

    /// The array.
    #[must_use]
    pub fn array(&self) -> &Array {
        &self.sources.array
    }

    /// The signature.
    #[must_use]
    pub fn signature(&self) -> Option<&Signature> {
        self.signature.as_ref()
    }

    /// The medium.
    #[must_use]
    pub fn medium(&self) -> Medium {
        self.sources.medium
    }
}
