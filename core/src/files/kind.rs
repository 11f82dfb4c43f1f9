//! Kinds: tables whose key `kind` determines their other keys.

use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

use crate::error::Error;
use crate::files::fault::Fault;
use crate::files::item::{Item, Table};
use crate::files::node::Node;

/// A kind: its name, the keys that must be there, and those that may.
pub(super) type Kind = (&'static str, &'static [&'static str], &'static [&'static str]);

/// The kind of a table, which has no key that is not its own or `common`.
pub(super) fn of<'a>(item: &Item<'a>, kinds: &[Kind], common: &[&str]) -> Result<(&'static str, Table<'a>), Fault> {
    let table = item.table()?;
    let names = || kinds.iter().map(|(name, ..)| *name).collect::<Vec<_>>().join(", ");
    let Some(given) = table.get("kind") else { return Err(left_out(item, "kind", format!("give one of {}", names()))) };
    let name = given.text()?;
    let Some(&(name, needed, others)) = kinds.iter().find(|(known, ..)| *known == name) else {
        return Err(given.refused(&format!("give one of {}", names())));
    };
    let own: Vec<&str> = needed.iter().chain(others).copied().collect();
    for (key, _) in table.entries.iter().filter(|(_, node)| *node != Node::Null) {
        if key != "kind" && !common.contains(&&**key) && !own.contains(&&**key) {
            let cure = format!("{name} has {}, leave it out", [&own, common].concat().join(", "));
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
    Fault::at(path.as_str(), Error::invalid(path.as_str(), "left out", cure))
}
