//! Who may use whom: every room of `core/src` uses those below it and no other, and no files import each other.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The rooms from the ground up; one may use what stands before it, and itself.
const FLOORS: [&str; 17] = [
    "error",
    "threads",
    "control",
    "math",
    "rng",
    "kernels",
    "device",
    "workspace",
    "scene",
    "linalg",
    "propagation",
    "problem",
    "solvers",
    "motion",
    "session",
    "files",
    "lib",
];

/// Every source file but tests, by its module path: `kernels::simd`.
fn sources(folder: &Path, module: &str, found: &mut BTreeMap<String, String>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path: PathBuf = entry.expect("an entry").path();
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let inside = if module.is_empty() { name.clone() } else { format!("{module}::{name}") };
        match path.is_dir() {
            true if name == "tests" => {}
            true => sources(&path, &inside, found),
            false => {
                let text = fs::read_to_string(&path).expect("text");
                let text = text.split("\n#[cfg(test)]\nmod tests {").next().unwrap_or_default().to_owned();
                found.insert(if name == "mod" { module.into() } else { inside }, text);
            }
        }
    }
}

/// The modules that a file's `use crate::...` lines and paths name: the longest part of each that is a file.
fn used(text: &str, files: &BTreeMap<String, String>) -> BTreeSet<String> {
    let code: String = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n");
    // `midair::` is the crate by its name, as solvers may write it.
    let code = code.replace("midair::", "crate::");
    let paths = code.split("crate::").skip(1).map(|rest| {
        let path: String = rest.chars().take_while(|c| c.is_alphanumeric() || "_:".contains(*c)).collect();
        let parts: Vec<&str> = path.split("::").collect();
        (1..=parts.len()).rev().map(|n| parts[..n].join("::")).find(|module| files.contains_key(module))
    });
    paths.flatten().collect()
}

fn floor(module: &str) -> usize {
    let room = module.split("::").next().unwrap_or_default();
    FLOORS.iter().position(|known| *known == room).unwrap_or_else(|| panic!("{room} has no floor"))
}

#[test]
fn rooms_use_only_what_stands_below_and_no_files_import_each_other() {
    let mut files = BTreeMap::new();
    sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), "", &mut files);
    assert!(files.len() > 60, "only {} files were found", files.len());
    let uses: BTreeMap<&String, BTreeSet<String>> =
        files.iter().map(|(module, text)| (module, used(text, &files))).collect();
    for (module, text) in &files {
        assert!(!text.contains("use super::"), "{module}: name what is used by its path from the crate");
    }
    for (module, used) in &uses {
        for other in used {
            assert!(floor(other) <= floor(module), "{module} uses {other}, which stands above it");
        }
    }
    // What uses nothing that is left is taken away; a circle stays.
    let mut left = uses;
    while let Some(free) =
        left.iter().find(|(module, used)| !used.iter().any(|u| u != **module && left.contains_key(u))).map(|(m, _)| *m)
    {
        left.remove(free);
    }
    assert!(left.is_empty(), "these files import each other: {:?}", left.keys());
}
