//! Step: one key or index of a path into a document; Place: where a path leads.

/// Where a path leads in the text of a document: the offset of the last value that exists, the offset of its key, and how many
/// steps of the path lead there.
pub(super) struct Place {
    pub(super) value: usize,
    pub(super) key: usize,
    pub(super) steps: usize,
}

/// One step of a path: a key of a table or an index of a list.
#[derive(Clone, Copy)]
pub(super) enum Step<'a> {
    Key(&'a str),
    Index(usize),
}
