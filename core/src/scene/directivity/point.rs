//! A point source, as in Suzuki et al. 2021.

use crate::scene::directivity::law::{Directivity, Law, Shape, Taylor};

pub(super) static LAW: Law = Law {
    name: "point",
    parameter: None,
    about: "D = 1 everywhere, also behind: the paper's model",
    value: |_, _, _| 1.0,
    taylor: Taylor::Each(|_, _, _| [1.0, 0.0, 0.0, 0.0, 0.0]),
    sharpness: |_, _| 0.0,
    shape: Shape::Omnidirectional,
};

impl Directivity {
    /// D = 1 everywhere, also behind the transducer, as in Suzuki et al. 2021.
    pub const POINT: Self = Self { law: &LAW, parameter: 0.0 };
}
