//! Build script: `stubs` writes the type stubs of the package and of its extension, from the Rust source and docstrings.

use std::env;
use std::process::Command;

fn main() {
    for path in
        ["stubs", "src", "midair/_toolbox.py", "../core/src/problem", "../core/src/scene", "../core/src/solvers"]
    {
        println!("cargo::rerun-if-changed={path}");
    }
    let folder = env::var_os("OUT_DIR").unwrap();
    // A container that builds wheels may have an old `python3` beside newer ones. -B: no compiled files beside the source.
    let others = ["python3", "python3.11", "python3.12", "python3.13", "python"];
    let written = pyo3_build_config::get().executable().into_iter().chain(others).any(|python| {
        let status = Command::new(python).args(["-B", "stubs"]).arg(&folder).status();
        status.is_ok_and(|status| status.success())
    });
    assert!(written, "the type stubs need Python 3.11 or newer");
}
