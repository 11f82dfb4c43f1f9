//! Keyword arguments of a call: those of air and transducers, and the rest.

use midair::Medium;

use crate::array::Array;
use crate::bead::read_bead;
use crate::bodies::read_obstacles;
use crate::parts;
use crate::prelude::*;
use crate::signature::read_signature;

/// Keyword arguments, which are taken out one by one.
pub(crate) struct Keywords<'py>(Bound<'py, PyDict>);

impl<'py> Keywords<'py> {
    pub(crate) fn of(py: Python<'py>, keywords: Option<&Bound<'py, PyDict>>) -> PyResult<Self> {
        keywords.map_or_else(|| Ok(PyDict::new(py)), PyDictMethods::copy).map(Self)
    }

    /// Adds the keywords that have a value.
    pub(crate) fn with<'a>(self, values: impl IntoIterator<Item = (&'static str, Argument<'a, 'py>)>) -> PyResult<Self>
    where
        'py: 'a,
    {
        let mut given = values.into_iter().filter_map(|(name, value)| Some((name, value?)));
        given.try_for_each(|(name, value)| self.0.set_item(name, value))?;
        Ok(self)
    }

    /// Takes a keyword out; None counts as not given.
    pub(crate) fn take(&self, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        Ok(self.take_or_none(name)?.filter(|value| !value.is_none()))
    }

    /// Takes a keyword out; it may be Python's None.
    pub(crate) fn take_or_none(&self, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        let value = self.0.get_item(name)?;
        if value.is_some() {
            self.0.del_item(name)?;
        }
        Ok(value)
    }

    /// Returns the keywords that were not taken.
    pub(crate) fn rest(&self) -> &Bound<'py, PyDict> {
        &self.0
    }

    /// Returns the error about the first keyword that was not taken. `known` are the names of the call itself.
    pub(crate) fn unknown(&self, what: &str, known: &[&str]) -> Option<midair::Error> {
        let left = self.0.keys().iter().next()?;
        let keys = Medium::KEYS.iter().chain(midair::Array::PART_KEYS).map(|key| key.name);
        let names = known.iter().copied().chain(keys);
        Some(midair::Error::unknown(what, left.to_string(), names))
    }

    /// Returns the scene's medium, or the array's, with the changes that the keywords give.
    pub(crate) fn medium(&self, base: Option<Medium>, array: &Array) -> PyResult<Medium> {
        let mut numbers = Vec::new();
        for key in Medium::KEYS {
            if let Some(value) = self.take(key.name)? {
                numbers.push((key.name, read::real(key.name, &value)?));
            }
        }
        base.map_or_else(|| array.inner.medium(&numbers), |base| base.with(&numbers)).map_err(refused)
    }

    /// Writes the optional parts that the keywords give over those of a scene. None removes a signature, and leaves a bead as it
    /// is.
    pub(crate) fn write_extras(&self, extras: &mut Extras, transducers: usize) -> PyResult<()> {
        if let Some(signature) = self.take_or_none("signature")? {
            let some = !signature.is_none();
            extras.signature = some.then(|| read_signature(&signature, transducers)).transpose()?;
        }
        if let Some(bead) = self.take("bead")? {
            extras.bead = read_bead(&bead)?;
        }
        if let Some(obstacles) = self.take_or_none("obstacles")? {
            extras.obstacles = read_obstacles(&obstacles)?;
        }
        Ok(())
    }

    /// Returns the array with the parts that the keywords give instead of its own.
    pub(crate) fn array(&self, array: Array) -> PyResult<Array> {
        array.with_parts(parts::values(|name| self.take(name))?)
    }
}
