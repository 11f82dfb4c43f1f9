//! Getters: the properties of a Python class, one a line.

/// Properties of a class, each with its documentation: a name, whether it needs `py`, its type and its value.
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
