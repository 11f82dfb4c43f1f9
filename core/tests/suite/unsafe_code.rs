//! Tests where unsafe code is: only for special CPU instructions, an allocator, a bare machine, and the interfaces to C and to
//! a web page.

use std::fs;
use std::path::{Path, PathBuf};

/// All files with unsafe code.
const ALLOWED: [&str; 23] = [
    "capi/src/array.rs",
    "capi/src/batch.rs",
    "capi/src/board.rs",
    "capi/src/memory.rs",
    "capi/src/motion.rs",
    "capi/src/outcome.rs",
    "capi/src/session.rs",
    "capi/src/tests/outcome.rs",
    "capi/src/tests/session.rs",
    "capi/src/version.rs",
    "core/src/kernels/simd/avx2.rs",
    "core/src/kernels/simd/avx512.rs",
    "core/src/kernels/simd/instruction_set.rs",
    "core/src/kernels/simd/neon.rs",
    "core/src/kernels/simd/simd128.rs",
    "core/src/kernels/simd/sse2.rs",
    "core/tests/allocations.rs",
    "core/tests/no_std/src/main.rs",
    "firmware/src/board/mps2_an386.rs",
    "firmware/src/board/stm32f407.rs",
    "firmware/src/heap.rs",
    "firmware/src/stack.rs",
    "studio/door/src/lib.rs",
];

/// Finds every Rust file in a folder and its subfolders, except for build results.
fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        if path.is_dir() && !["target", "node_modules"].contains(&&*name) && !name.starts_with('.') {
            files(&path, found);
        } else if path.extension().is_some_and(|kind| kind == "rs") {
            found.push(path);
        }
    }
}

/// Whether the code, without comments and strings, contains the keyword.
fn has_unsafe(text: &str) -> bool {
    let code = text.lines().map(|line| line.split("//").next().unwrap_or_default());
    let mut words = code.flat_map(|line| line.split(|c: char| !c.is_alphanumeric() && c != '_' && c != '"'));
    words.any(|word| word == "unsafe")
}

#[test]
fn unsafe_code_stands_in_few_files() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("a folder");
    let mut paths = Vec::new();
    for folder in ["core", "python", "capi", "firmware", "fuzz", "studio"] {
        files(&root.join(folder), &mut paths);
    }
    assert!(paths.len() > 150, "only {} files were found", paths.len());
    let with = paths.iter().filter(|path| has_unsafe(&fs::read_to_string(path).expect("text")));
    let mut with: Vec<_> =
        with.map(|path| path.strip_prefix(root).expect("inside").display().to_string().replace('\\', "/")).collect();
    with.sort();
    assert_eq!(with, ALLOWED);
}
