//! Build script: `stubs` writes the type stubs of the extension, from its Rust source and docstrings, to `_midair.pyi`.

use std::env;
use std::path::Path;
use std::process::Command;

fn main() {
    for path in ["stubs", "src", "midair/_toolbox.py", "midair/_keywords.pyi", "../core/src/problem/metrics.rs"] {
        println!("cargo::rerun-if-changed={path}");
    }
    let stub = Path::new(&env::var_os("OUT_DIR").unwrap()).join("_midair.pyi");
    let python = pyo3_build_config::get().executable().unwrap_or("python3");
    // -B: no compiled files beside the source.
    let status = Command::new(python).args(["-B", "stubs"]).arg(stub).status();
    assert!(status.is_ok_and(|status| status.success()), "{python} wrote no stubs");
}
