//! Keywords of a call: those of the air and the transducers, and the rest.

use midair::Medium;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyDictMethods};

use crate::array::Array;
use crate::error::refused;
use crate::parts;
use crate::read;

/// Keywords, taken out one by one.
pub(crate) struct Keywords<'py>(Bound<'py, PyDict>);

impl<'py> Keywords<'py> {
    pub(crate) fn of(py: Python<'py>, keywords: Option<&Bound<'py, PyDict>>) -> PyResult<Self> {
        keywords.map_or_else(|| Ok(PyDict::new(py)), PyDictMethods::copy).map(Self)
    }

    /// A keyword where None stands for leaving it out.
    pub(crate) fn take(&self, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        Ok(self.take_or_none(name)?.filter(|value| !value.is_none()))
    }

    /// A keyword that may be Python's None.
    pub(crate) fn take_or_none(&self, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        let value = self.0.get_item(name)?;
        if value.is_some() {
            self.0.del_item(name)?;
        }
        Ok(value)
    }

    /// The keywords that are left.
    pub(crate) fn rest(&self) -> &Bound<'py, PyDict> {
        &self.0
    }

    /// The refusal of the first one that is left; `known` are those of the call beside the air's and the array's.
    pub(crate) fn unknown(&self, what: &str, known: &[&str]) -> Option<midair::Error> {
        let left = self.0.keys().iter().next()?;
        let keys = Medium::KEYS.iter().chain(midair::Array::PART_KEYS).map(|key| key.name);
        let names = known.iter().copied().chain(keys);
        Some(midair::Error::unknown(what, left.to_string(), names))
    }

    /// A scene's medium, or that of an array, as the keywords change it.
    pub(crate) fn medium(&self, own: Option<Medium>, array: &Array) -> PyResult<Medium> {
        let mut given = Vec::new();
        for key in Medium::KEYS {
            if let Some(value) = self.take(key.name)? {
                given.push((key.name, read::real(key.name, &value)?));
            }
        }
        own.map_or_else(|| array.inner.medium(&given), |own| own.with(&given)).map_err(refused)
    }

    /// An array with the parts that the keywords give in place of its own.
    pub(crate) fn array(&self, array: Array) -> PyResult<Array> {
        array.with_parts(parts::given(|name| self.take(name))?)
    }
}
