//! Tests that the header is what cbindgen generates for the crate; `make generated` writes it.

use std::fs;
use std::path::Path;

#[test]
fn the_header_is_that_of_the_crate() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(root.join("cbindgen.toml")).expect("a configuration");
    let mut made = Vec::new();
    cbindgen::generate_with_config(root, config).expect("a header").write(&mut made);
    let path = root.join("include/midair.h");
    if std::env::var("MIDAIR_HEADER").is_ok_and(|what| what == "write") {
        fs::write(&path, made).expect("written");
    } else {
        let kept = fs::read(&path).expect("a header");
        assert!(kept == made, "capi/include/midair.h is not what capi/src says: run `make generated`");
    }
}

/// cbindgen does not expand macros, so capi/src repeats the texts of the metrics.
#[test]
fn the_metrics_are_described_as_in_the_core() {
    let header = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("include/midair.h")).expect("a header");
    macro_rules! check {
        ($(#[doc = $text:literal] $name:ident)*) => {
            $(
                let lines = concat!("    //", $text, "\n    double ", stringify!($name), ";\n");
                assert!(header.contains(lines), "capi/src/answer.rs says otherwise than the core:\n{lines}");
            )*
        };
    }
    midair::metrics!(check);
}
