//! Macro for the read-only properties of a Python class, one per line.

/// Declares properties of a class. Each has documentation, a name, `py` if it needs it, a type and a value.
macro_rules! getters {
    ($class:ident: $( $(#[$about:meta])* $name:ident($this:ident $(, $py:ident)?) -> $type:ty = $value:expr; )+) => {
        #[pymethods]
        impl $class {
            $(
                $(#[$about])*
                #[getter]
                #[allow(clippy::extra_unused_lifetimes, clippy::elidable_lifetime_names, reason = "some types have no 'py")]
                fn $name<'py>(&$this $(, $py: Python<'py>)?) -> $type {
                    $value
                }
            )+
        }
    };
}

pub(crate) use getters;
