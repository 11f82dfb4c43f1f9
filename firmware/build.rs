//! Copies the board's memory layout to the folder where the linker searches for it.

use std::path::Path;
use std::{env, fs};

fn main() {
    let out = env::var("OUT_DIR").expect("cargo sets OUT_DIR");
    let board = if env::var_os("CARGO_FEATURE_STM32F407").is_some() { "stm32f407" } else { "mps2_an386" };
    let layout = format!("boards/{board}.x");
    println!("cargo:rerun-if-changed={layout}");
    fs::copy(layout, Path::new(&out).join("memory.x")).expect("the layout is in boards/");
    println!("cargo:rustc-link-search={out}");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
    }
}
