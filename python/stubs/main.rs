//! Build script: writes the type stubs of the extension, from its Rust source and docstrings, to `_midair.pyi`.
//!
//! maturin puts the file beside the extension, in wheels and after `maturin develop`.

mod source;
mod types;
mod write;

use std::path::{Path, PathBuf};
use std::{env, fs};

use source::Source;

fn main() {
    // In this order: the Rust source; the methods that Python adds to classes; the solvers and their options.
    let [source, toolbox, keywords] = ["src", "midair/_toolbox.py", "midair/_keywords.pyi"];
    for path in ["stubs", source, toolbox, keywords] {
        println!("cargo::rerun-if-changed={path}");
    }
    let read = |path: &str| fs::read_to_string(path).unwrap();
    let stub = write::stub(&Source::read(Path::new(source)), &read(toolbox), &read(keywords));
    fs::write(PathBuf::from(env::var_os("OUT_DIR").unwrap()).join("_midair.pyi"), stub).unwrap();
}
