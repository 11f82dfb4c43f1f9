//! Puts the board's memory layout where the linker looks for it.

use std::path::Path;
use std::{env, fs};

fn main() {
    let out = env::var("OUT_DIR").expect("cargo sets OUT_DIR");
    println!("cargo:rerun-if-changed=boards/mps2_an386.x");
    fs::copy("boards/mps2_an386.x", Path::new(&out).join("memory.x")).expect("the layout is in boards/");
    println!("cargo:rustc-link-search={out}");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
    }
}
