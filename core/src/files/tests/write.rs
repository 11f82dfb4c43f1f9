//! Tests that a tree, written in either format, is read as the same tree.

use alloc::string::String;

use proptest::prelude::*;
use serde_json::Value;

use crate::files::node::Node;
use crate::files::{json, toml, write};

/// Generates every kind of value except null, which TOML does not have, in lists and tables.
fn nodes() -> impl Strategy<Value = Node> {
    let leaf = prop_oneof![
        any::<bool>().prop_map(Node::Bool),
        any::<i64>().prop_map(Node::Integer),
        (i64::MAX as u64 + 1..).prop_map(Node::Large),
        (proptest::num::f64::NORMAL | proptest::num::f64::ZERO | proptest::num::f64::SUBNORMAL).prop_map(Node::Real),
        any::<String>().prop_map(Node::Text),
        prop::collection::vec(proptest::num::f64::NORMAL, 1..4).prop_map(Node::Numbers),
        prop::collection::vec(any::<i64>().prop_map(Node::Integer), 0..4).prop_map(Node::List),
    ];
    leaf.prop_recursive(3, 24, 4, |inner| {
        prop_oneof![
            // The text at the end keeps these lists from having the compact form `Numbers`, which contains only numbers.
            prop::collection::vec(inner.clone(), 1..4).prop_map(|mut list| {
                list.push(Node::Text("end".into()));
                Node::List(list)
            }),
            prop::collection::vec(table(inner.clone()), 1..4).prop_map(Node::List),
            table(inner),
        ]
    })
}

/// Generates a table with sorted keys.
fn table(inner: impl Strategy<Value = Node>) -> impl Strategy<Value = Node> {
    prop::collection::btree_map(any::<String>(), inner, 0..4).prop_map(|table| Node::Table(table.into_iter().collect()))
}

/// Sorts the keys of all tables, because TOML writes plain values before tables.
fn sorted(node: Node) -> Node {
    match node {
        Node::List(list) => Node::List(list.into_iter().map(sorted).collect()),
        Node::Table(mut entries) => {
            entries.sort_by(|(one, _), (other, _)| one.cmp(other));
            Node::Table(entries.into_iter().map(|(key, node)| (key, sorted(node))).collect())
        }
        other => other,
    }
}

fn reported(node: &Node) -> Value {
    match node {
        Node::Null => Value::Null,
        Node::Bool(value) => (*value).into(),
        Node::Integer(value) => (*value).into(),
        Node::Large(value) => (*value).into(),
        Node::Real(value) => (*value).into(),
        Node::Text(text) => text.as_str().into(),
        Node::Numbers(numbers) => numbers.iter().copied().collect(),
        Node::List(list) => list.iter().map(reported).collect(),
        Node::Table(entries) => entries.iter().map(|(key, node)| (key.clone(), reported(node))).collect(),
    }
}

/// Writes a tree as JSON.
fn in_json(node: &Node) -> String {
    let mut text = String::new();
    write::json(node, "\n", &mut text);
    text
}

proptest! {
    #[test]
    fn a_written_tree_reads_as_the_same_tree(node in table(nodes())) {
        let text = in_json(&node);
        prop_assert_eq!(json::read(&text).ok(), Some(node.clone()), "{}", text);
        let value: Value = serde_json::from_str(&text).expect("JSON");
        prop_assert_eq!(value, reported(&node));
        let mut text = String::new();
        write::toml("", &node, &mut text).expect("no null");
        prop_assert_eq!(toml::read(&text).ok().map(sorted), Some(node), "{}", text);
    }
}
