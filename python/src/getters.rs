//! Macros for classes: read-only properties, one per line, and hashes.

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

/// Makes the hash of a class of some of its parts.
macro_rules! hashed {
    ($class:ident: $this:ident => $parts:expr) => {
        impl std::hash::Hash for $class {
            fn hash<H: std::hash::Hasher>(&$this, state: &mut H) {
                std::hash::Hash::hash(&$parts, state);
            }
        }
    };
}

/// Returns what is hashed of a number. Equal values need equal hashes, and 0 equals -0: adding 0 turns -0 into 0.
pub(crate) fn bits(x: f64) -> u64 {
    (x + 0.0).to_bits()
}

pub(crate) use {getters, hashed};
