//! Tests of the JSON reader: which texts it accepts, which values it reads, and where it reports a value or an error.

use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec;

use proptest::prelude::*;

use crate::files::json::{find, read};
use crate::files::node::Node;
use crate::files::source::{Format, Source};
use crate::files::syntax::Step;

/// The error for a text, without its example.
fn refusal(text: &str) -> String {
    let flaw = read(text).map_err(|flaw| flaw.reported(text, Format::Json, Source::default()));
    let reported = flaw.expect_err(text).to_string();
    reported.split("; for example").next().unwrap_or_default().into()
}

#[test]
fn a_text_is_taken_where_the_standard_takes_it() {
    let good = [
        r#"{"a": [true, false, null], "b": {"c": "d"}}"#,
        " [\n] \t\r",
        "[\"\\ud83d\\ude00 \\u00e9 \\/ \\b\\f\\n\\r\\t\"]",
        "[\"\u{e9}\u{1f600}\u{7f}\"]",
        "\"\"",
        "{\"\": {}}",
        "[-0, 0.5, 1e5, 1E+5, 1.25e-5, 18446744073709551616, -9223372036854775809]",
        "1e-400",
    ];
    for text in good {
        assert!(read(text).is_ok(), "{text}");
    }
    let wrong = [
        "[\"\\ud83d\"]",
        "[\"\\ude00\"]",
        "[\"\\ud83d\\u0041\"]",
        "[\"\\x41\"]",
        "[\"\\u+123\"]",
        "[\"\\u12\"]",
        "[\"a\nb\"]",
        "[\"a\u{0}b\"]",
        "['a']",
        "[1.5,]",
        "[,1.5]",
        "[1.5 2.5]",
        "[1.5}",
        "[1.5",
        "{\"a\": 1,}",
        "{\"a\": 1,, \"b\": 2}",
        "{\"a\" 1}",
        "{a: 1}",
        "{1: 1}",
        "{\"a\": 1} x",
        "{} {}",
        "[] // end",
        "truex",
        "True",
        "nul",
        "NaN",
        "[Infinity]",
        "[-Infinity]",
        "[inf]",
        "\u{a0}1",
        "\u{b}1",
        "",
        "+1",
        "-",
        "01",
        "-01",
        ".5",
        "1.",
        "1.e5",
        "1e",
        "1e+",
        "0x10",
        "1_000",
        "1e400",
        "-1e999",
        "[1, 1e999]",
    ];
    for text in wrong {
        assert!(read(text).is_err(), "{text}");
    }
    assert!(read(&"9".repeat(400)).is_err());
}

#[test]
fn depth_and_keys_have_a_limit() {
    let nested = |depth: usize| [vec!["["; depth], vec!["]"; depth]].concat().concat();
    assert!(read(&nested(127)).is_ok() && read(&nested(129)).is_err());
    let tables = |depth: usize| format!("{}1{}", "{\"a\": ".repeat(depth), "}".repeat(depth));
    assert!(read(&tables(127)).is_ok() && read(&tables(129)).is_err());
    for deep in [nested(100_000), "[".repeat(100_000), "{\"a\":".repeat(100_000)] {
        assert!(refusal(&deep).contains("nested too deep"));
    }
    let members: vec::Vec<String> = (0..257).map(|k| format!("\"k{k}\": 1")).collect();
    assert!(read(&format!("{{{}}}", members[1..].join(","))).is_ok());
    let many = format!("{{{}}}", members.join(","));
    let column = many.find("\"k256\"").map_or(0, |at| at + 1);
    assert!(refusal(&many).contains(&format!("line 1, column {column}: a table has more keys")));
}

#[test]
fn a_key_written_twice_is_refused_where_it_is_written_again() {
    let doubled = [
        ("{\"a\": 1, \"a\": 2}", "line 1, column 10", "a"),
        ("{\"a\": 1,\n \"a\"  \n : 2}", "line 2, column 2", "a"),
        ("{\"a\": 1, \"\\u0061\": 2}", "line 1, column 10", "a"),
        ("[{\"\u{e9}\": [{\"b\": {}}, {\"c\": 1, \"b\": 3,\n\"b\": 4}]}]", "line 2, column 1", "b"),
        ("{\"\u{e9}\": 1, \"\u{e9}\": 2}", "line 1, column 10", "\u{e9}"),
        ("{\"a\\\"b\": 1, \"a\\\"b\": 2}", "line 1, column 13", "a\"b"),
        ("{\"\\\\\": 1, \"\\\\\": 2}", "line 1, column 11", "\\"),
        ("{\"\": 1, \"\": 2}", "line 1, column 9", ""),
        ("{\"a\": null, \"a\": null, \"a\"}", "line 1, column 13", "a"),
    ];
    for (text, place, key) in doubled {
        let reported = format!("scene file, {place}: the key \"{key}\" is written twice: keep one of them");
        assert_eq!(refusal(text), reported, "{text}");
    }
    assert!(read("{\"a\": {\"a\": 1}, \"b\": [{\"a\": 1}, {\"a\": 1}], \"A\": 1}").is_ok());
}

#[test]
fn a_fault_is_reported_with_its_place_and_cure() {
    let cases = [
        ("{\"a\": 1,\n \"b\": NaN}", "line 2, column 7: no JSON here (a value is missing"),
        ("{\"\u{e9}\u{e9}\u{e9}\": ?}", "line 1, column 9: no JSON here (a value is missing"),
        ("{\"a\": 1}\n x", "line 2, column 2: no JSON here (text after the end of the table)"),
        ("{\"a\": 1,\n}", "line 2, column 1: no JSON here (a comma before a closing bracket)"),
        ("{\"a\": 1\r\n\"b\": 2}", "line 2, column 1: no JSON here (a comma or a closing bracket is missing)"),
        ("{\"a\": 1,\nb: 2}", "line 2, column 1: no JSON here (a key without double quotes)"),
        ("{\n\"a\" 2}", "line 2, column 5: no JSON here (a colon is missing after a key)"),
        ("{\"a\": \"x\ty\"}", "line 1, column 9: no JSON here (a line break or tab within quotes)"),
        ("{\"a\": [1", "line 1, column 8: no JSON here (the text ends before its last bracket, brace or quote"),
        ("{\"a\": [1\n", "line 1, column 9: no JSON here (the text ends before its last bracket, brace or quote"),
        ("{\"a\": \"\u{e9}", "line 1, column 8: no JSON here (the text ends before its last bracket, brace or quote"),
        ("{\"a\":\n [1e999]}", "line 2, column 3: a number too large for any computer: give fewer digits"),
        ("{\"a\": -1e999}", "line 1, column 7: a number too large for any computer: give fewer digits"),
        ("{\"a\":\n [1.]}", "line 2, column 3: no JSON here (a number that JSON does not know: a digit before"),
        ("[2, 01]", "line 1, column 5: no JSON here (a number that JSON does not know: a digit before"),
        ("[-]", "line 1, column 2: no JSON here (a number that JSON does not know: a digit before"),
        ("{\"a\":\n [\"\\x\"]}", "line 2, column "),
        ("{\"a\":\n [\"\\x\"]}", ": no JSON here (a backslash that escapes nothing)"),
        ("{\"a\":\n [\"\\ud83d\"]}", ": no JSON here (a backslash that escapes nothing)"),
        ("\u{e9}", "line 1, column 1: no JSON, but TOML as it looks: name it .toml"),
    ];
    for (text, reported) in cases {
        assert!(refusal(text).contains(reported), "{text}: {}", refusal(text));
    }
}

#[test]
fn values_and_keys_are_found_by_their_steps() {
    let text = " {\"a\": [10, {\"b\" :\n \"x\"}, [1.5, -2]], \"\\u0063\": {\"d\\\"\": null}, \"a\\\\\": 3}\n";
    let (a, b) = (Step::Key("a"), Step::Key("b"));
    let at = |part: &str| text.find(part).expect("a part");
    // For each path: how many steps lead to a value, and the offsets of the last value and of its key.
    let cases: [(&[Step<'_>], usize, usize, usize); 9] = [
        (&[], 0, 1, 1),
        (&[a], 1, at("[10"), at("\"a\"")),
        (&[a, Step::Index(0)], 2, at("10"), at("10")),
        (&[a, Step::Index(1), b], 3, at("\"x\""), at("\"b\"")),
        (&[a, Step::Index(2), Step::Index(1)], 3, at("-2"), at("-2")),
        (&[a, Step::Index(7), b], 1, at("[10"), at("\"a\"")),
        (&[a, b], 1, at("[10"), at("\"a\"")),
        (&[Step::Key("c"), Step::Key("d\"")], 2, at("null"), at("\"d")),
        (&[Step::Key("a\\")], 1, at("3}"), at("\"a\\\\")),
    ];
    for (steps, depth, value, key) in cases {
        let place = find(text, steps);
        assert_eq!((place.steps, place.value, place.key), (depth, value, key));
    }
}

/// Reads a number or a string by the rules of RFC 8259, letter by letter: the reference for the reader.
fn by_the_standard(text: &str) -> Option<Node> {
    if let Some(rest) = text.strip_prefix('"') {
        return word(rest.strip_suffix('"')?).map(Node::Text);
    }
    let digits = |part: &str| !part.is_empty() && part.bytes().all(|digit| digit.is_ascii_digit());
    let unsigned = text.strip_prefix('-').unwrap_or(text);
    let (mantissa, exponent) = unsigned.split_once(['e', 'E']).map_or((unsigned, "0"), |parts| parts);
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, "0"));
    let good = digits(whole)
        && (whole == "0" || !whole.starts_with('0'))
        && digits(fraction)
        && digits(exponent.strip_prefix(['+', '-']).unwrap_or(exponent));
    let is_whole = !unsigned.contains(['.', 'e', 'E']) && text != "-0";
    let integer = || text.parse().ok().map(Node::Integer).filter(|_| is_whole);
    let large = || text.parse().ok().map(Node::Large).filter(|_| is_whole);
    let real = || text.parse().ok().filter(|value: &f64| value.is_finite()).map(Node::Real);
    good.then(|| integer().or_else(large).or_else(real)).flatten()
}

/// Reads a string without its quotes. Surrogates must occur in pairs.
fn word(text: &str) -> Option<String> {
    let (mut units, mut letters) = (vec![], text.chars());
    while let Some(letter) = letters.next() {
        let unit = match letter {
            '"' | '\0'..='\x1f' => return None,
            '\\' => match letters.next()? {
                letter @ ('"' | '\\' | '/') => letter as u16,
                'b' => 8,
                'f' => 12,
                'n' => 10,
                'r' => 13,
                't' => 9,
                'u' => (0..4).try_fold(0, |code, _| Some(code * 16 + letters.next()?.to_digit(16)? as u16))?,
                _ => return None,
            },
            letter => {
                units.extend(letter.encode_utf16(&mut [0; 2]).iter());
                continue;
            }
        };
        units.push(unit);
    }
    String::from_utf16(&units).ok()
}

/// The number that a text contains; `None` if it contains anything else.
fn number(text: &str) -> Option<f64> {
    read(text).ok()?.real()
}

proptest! {
    #[test]
    fn a_number_is_the_nearest_f64(bits in any::<u64>(), digits in "[1-9][0-9]{0,40}", point in 0..40usize, exponent in -360..360i32) {
        let value = f64::from_bits(bits);
        if value.is_finite() {
            for text in [format!("{value:?}"), format!("{value:e}"), format!("{value:.17e}"), format!("{value:.30e}")] {
                prop_assert_eq!(number(&text).map(f64::to_bits), Some(bits), "{}", text);
            }
            // Numbers with very many digits, also of values exactly halfway between two f64.
            let exact = format!("{value:.800e}");
            prop_assert_eq!(number(&exact).map(f64::to_bits), Some(bits), "{}", exact);
        }
        let (whole, fraction) = digits.split_at(point.min(digits.len()));
        let whole = if whole.is_empty() { "0" } else { whole };
        let fraction = if fraction.is_empty() { "0" } else { fraction };
        let text = format!("{whole}.{fraction}e{exponent}");
        let nearest = text.parse().ok().filter(|value: &f64| value.is_finite());
        prop_assert_eq!(number(&text).map(f64::to_bits), nearest.map(f64::to_bits), "{}", text);
    }

    #[test]
    fn a_whole_number_of_64_bits_is_read_to_the_last_digit(value in any::<i64>(), large in i64::MAX as u64 + 1..) {
        prop_assert_eq!(read(&value.to_string()).ok(), Some(Node::Integer(value)));
        prop_assert_eq!(read(&large.to_string()).ok(), Some(Node::Large(large)));
        let beyond = format!("{large}0");
        prop_assert_eq!(read(&beyond).ok(), beyond.parse().ok().map(Node::Real));
    }

    #[test]
    fn a_number_or_word_is_read_as_the_standard_has_it(text in r#"-?[0-9]{0,3}(\.[0-9]{0,30})?([eE][+-]?[0-9]{0,3})?|"[a\\/bu0-9dD"]{0,14}"?|"(\\u[dD][89abcdABCD][0-9a-f]{2}|\\[bfnrt\\/"]|[ -~]|é){0,8}""#) {
        prop_assert_eq!(read(&text).ok(), by_the_standard(&text), "{}", text);
    }

    #[test]
    fn no_text_at_all_makes_it_panic(text in "[\\[\\]{}\",:\\\\u0-9eE.+\\- \n\u{e9}a-f]{0,40}") {
        let reported = read(&text).map_err(|flaw| flaw.reported(&text, Format::Json, Source::default()).to_string());
        prop_assert!(reported.is_ok() || reported.is_err_and(|reported| !reported.contains('\n')));
    }
}

#[test]
fn numbers_between_two_are_rounded_as_they_should_be() {
    let cases = [
        ("-0", (-0.0f64).to_bits()),
        ("-0.0", (-0.0f64).to_bits()),
        ("5e-324", 1),
        ("2.4703282292062327208e-324", 0),
        ("2.4703282292062328e-324", 1),
        ("1.7976931348623158e308", f64::MAX.to_bits()),
        ("9007199254740993.0", 9_007_199_254_740_992f64.to_bits()),
        ("9007199254740993.00000000000000000000000000000000001", 9_007_199_254_740_994f64.to_bits()),
        ("2.2250738585072011e-308", 0x000f_ffff_ffff_ffff),
        ("0.1", 0.1f64.to_bits()),
        ("6929495644600919.5", 6_929_495_644_600_920f64.to_bits()),
        ("3.518437208883201171875e13", 35_184_372_088_832.016_f64.to_bits()),
    ];
    for (text, bits) in cases {
        assert_eq!(number(text).map(f64::to_bits), Some(bits), "{text}");
        let known: f64 = text.parse().expect("a number");
        assert_eq!(known.to_bits(), bits, "{text}");
    }
}
