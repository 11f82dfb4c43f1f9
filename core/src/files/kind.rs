//! Kind: tables whose key `kind` determines which other keys they have.

use crate::files::fault::Fault;
use crate::files::item::{Item, Table};
use crate::files::node::Node;
use crate::prelude::*;

/// A kind: its name, its required keys, and its optional keys.
pub(super) type Kind = (&'static str, &'static [&'static str], &'static [&'static str]);

/// Returns the kind of a table, and the table. All its keys must belong to the kind or be `common` to all kinds.
pub(super) fn of<'a>(item: &Item<'a>, kinds: &[Kind], common: &[&str]) -> Result<(&'static str, Table<'a>), Fault> {
    let table = item.table()?;
    let names = || kinds.iter().map(|(name, ..)| *name).collect::<Vec<_>>().join(", ");
    let Some(kind) = table.get("kind") else { return Err(left_out(item, "kind", format!("give one of {}", names()))) };
    let name = kind.text()?;
    let Some(&(name, needed, others)) = kinds.iter().find(|(known, ..)| *known == name) else {
        return Err(kind.refused(&format!("give one of {}", names())));
    };
    let keys: Vec<&str> = needed.iter().chain(others).copied().collect();
    for (key, _) in table.entries.iter().filter(|(_, node)| *node != Node::Null) {
        if key != "kind" && !common.contains(&&**key) && !keys.contains(&&**key) {
            let cure = format!("{name} has {}, leave it out", [&keys, common].concat().join(", "));
            return Err(table.need(key)?.refused(&cure));
        }
    }
    match needed.iter().find(|key| table.get(key).is_none()) {
        Some(key) => Err(left_out(item, key, format!("{name} needs {}", needed.join(", ")))),
        None => Ok((name, table)),
    }
}

fn left_out(item: &Item<'_>, key: &str, cure: String) -> Fault {
    let path = format!("{}.{key}", item.path);
    Fault::at(path.as_str(), Error::missing(path.as_str(), "left out", cure))
}
