//! Step of a path into a document, and the place after several steps.

/// The depth to which a path leads into a document: where its last value there begins, and the key of that, after so
/// many steps.
pub(super) struct Place {
    pub(super) value: usize,
    pub(super) key: usize,
    pub(super) steps: usize,
}

/// One step into a document.
#[derive(Clone, Copy)]
pub(super) enum Step<'a> {
    Key(&'a str),
    Index(usize),
}
