//! What is written reads as the same tree, and JSON reads as another reader has it.

use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

use proptest::prelude::*;
use serde_json::Value;

use crate::files::node::Node;
use crate::files::{json, toml, write};

/// Every kind of value but null, which TOML does not know, in lists and tables.
fn nodes() -> impl Strategy<Value = Node> {
    let leaf = prop_oneof![
        any::<bool>().prop_map(Node::Bool),
        any::<i64>().prop_map(Node::Integer),
        (i64::MAX as u64 + 1..).prop_map(Node::Large),
        (proptest::num::f64::NORMAL | proptest::num::f64::ZERO | proptest::num::f64::SUBNORMAL).prop_map(Node::Real),
        any::<String>().prop_map(Node::Text),
        prop::collection::vec(proptest::num::f64::NORMAL, 0..4).prop_map(Node::Numbers),
    ];
    leaf.prop_recursive(3, 24, 4, |inner| {
        prop_oneof![
            // A list of nothing but numbers has another form.
            prop::collection::vec(inner.clone(), 1..4).prop_map(|mut list| {
                list.push(Node::Text("end".into()));
                Node::List(list)
            }),
            prop::collection::vec(table(inner.clone()), 1..4).prop_map(Node::List),
            table(inner),
        ]
    })
}

/// A table, its keys in the order in which TOML's reader gives them.
fn table(inner: impl Strategy<Value = Node>) -> impl Strategy<Value = Node> {
    prop::collection::btree_map(any::<String>(), inner, 0..4).prop_map(|table| Node::Table(table.into_iter().collect()))
}

fn told(node: &Node) -> Value {
    match node {
        Node::Null => Value::Null,
        Node::Bool(value) => (*value).into(),
        Node::Integer(value) => (*value).into(),
        Node::Large(value) => (*value).into(),
        Node::Real(value) => (*value).into(),
        Node::Text(text) => text.as_str().into(),
        Node::Numbers(numbers) => numbers.iter().copied().collect(),
        Node::List(list) => list.iter().map(told).collect(),
        Node::Table(entries) => entries.iter().map(|(key, node)| (key.clone(), told(node))).collect(),
    }
}

/// The text in JSON.
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
        prop_assert_eq!(value, told(&node));
        let mut text = String::new();
        write::toml("", &node, &mut text).expect("no null");
        prop_assert_eq!(toml::read(&text).ok(), Some(node), "{}", text);
    }

    #[test]
    fn a_number_or_word_is_refused_where_another_reader_refuses_it(text in r#"-?[0-9]{0,3}(\.[0-9]{0,30})?([eE][+-]?[0-9]{0,3})?|"[a\\/bu0-9dD"]{0,14}"?"#) {
        check(&text);
    }
}

/// Our reader and another say the same of a text.
fn check(text: &str) {
    let (own, other) = (json::read(text), serde_json::from_str::<Value>(text));
    assert_eq!(own.as_ref().ok().map(told_short), other.ok().map(|value| format!("{value}")), "{text}");
}

/// As the other reader's value is written: whole numbers of a list are no longer known as such.
fn told_short(node: &Node) -> String {
    format!("{}", told(node))
}

#[test]
fn a_document_is_refused_where_another_reader_refuses_it() {
    let texts = [
        r#"{"a": [true, false, null], "b": {"c": "d"}}"#,
        " [\n] \t\r",
        "[\"\\ud83d\\ude00 \\u00e9 \\/ \\b\\f\\n\\r\\t\"]",
        "[\"\\ud83d\"]",
        "[\"\\ude00\"]",
        "[\"\\ud83d\\u0041\"]",
        "[\"\\x41\"]",
        "[\"\\u+123\"]",
        "[\"a\nb\"]",
        "[1.5,]",
        "[1.5 2.5]",
        "[1.5}",
        "[1.5",
        "{\"a\": 1,}",
        "{\"a\" 1}",
        "{a: 1}",
        "{\"a\": 1} x",
        "truex",
        "nul",
        "[NaN]",
        "\u{a0}1",
        "",
        "18446744073709551615",
        "18446744073709551616",
        "-9223372036854775808",
        "-9223372036854775809",
        "-0",
        "1e400",
        "5e-324",
        "2.4703282292062327208e-324",
        "1.7976931348623158e308",
    ];
    for text in texts {
        check(text);
    }
    let nested = |depth: usize| [vec!["["; depth], vec!["]"; depth]].concat().concat();
    assert!(json::read(&nested(128)).is_ok() && json::read(&nested(129)).is_err());
    let members: Vec<String> = (0..257).map(|k| format!("\"k{k}\": 1")).collect();
    assert!(json::read(&format!("{{{}}}", members[1..].join(","))).is_ok());
    assert!(json::read(&format!("{{{}}}", members.join(","))).is_err());
}
