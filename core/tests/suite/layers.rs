//! Tests the layers of the core: a module uses only modules of lower layers, no two files import each other, and no method uses
//! a file of another method.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The modules of `core/src`, the lowest layer first. A module may use itself and the modules before it.
const CORE: &[&str] = &[
    "error",
    "threads",
    "control",
    "math",
    "rng",
    "kernels",
    "device",
    "workspace",
    "scene",
    "points",
    "linalg",
    "propagation",
    "problem",
    "solvers",
    "sequence",
    "flight",
    "touch",
    "session",
    "files",
    "lib",
];

/// The files of `core/src/solvers` that several methods use. Each other file or folder there is a method.
const SHARED: &[&str] = &[
    "amplitude_limit",
    "common",
    "even_field",
    "batching",
    "iterate",
    "last",
    "method",
    "options",
    "registry",
    "remark",
    "solve",
];

/// The text of each file under its module path, such as `kernels::simd`, without tests.
type Files = BTreeMap<String, String>;

fn sources(folder: &Path, module: &str, files: &mut Files) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path: PathBuf = entry.expect("an entry").path();
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let inside = if module.is_empty() { name.clone() } else { format!("{module}::{name}") };
        match path.is_dir() {
            true if name == "tests" => {}
            true => sources(&path, &inside, files),
            false => {
                let text = fs::read_to_string(&path).expect("text");
                let text = text.split("\n#[cfg(test)]\nmod tests {").next().unwrap_or_default().to_owned();
                files.insert(if name == "mod" { module.into() } else { inside }, text);
            }
        }
    }
}

fn tree(folder: &str) -> Files {
    let mut files = Files::new();
    sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), "", &mut files);
    files
}

/// Returns the paths at the beginning of a text, with braces expanded: `a::{b, c::{self, d}}` gives `a::b`, `a::c` and
/// `a::c::d`.
fn expanded(text: &str) -> Vec<String> {
    let head: String = text.chars().take_while(|c| c.is_alphanumeric() || "_:".contains(*c)).collect();
    let Some(braced) = text[head.len()..].strip_prefix('{') else { return vec![head] };
    let (mut depth, mut start, mut paths) = (0, 0, Vec::new());
    for (at, letter) in braced.char_indices() {
        match letter {
            '{' => depth += 1,
            ',' | '}' if depth == 0 => {
                let inner = expanded(braced[start..at].trim_start());
                paths.extend(inner.iter().map(|path| match path.as_str() {
                    "self" | "" => head.trim_end_matches("::").to_owned(),
                    path => format!("{head}{path}"),
                }));
                start = at + 1;
                if letter == '}' {
                    break;
                }
            }
            '}' => depth -= 1,
            _ => {}
        }
    }
    paths
}

/// Returns the modules that a file uses in `use crate::...` lines and other paths: for each, the longest part that is a file.
fn used(text: &str, files: &Files) -> BTreeSet<String> {
    let code: String = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n");
    // The path of a module may begin with `midair::` instead of `crate::`.
    let code = if files.contains_key("kernels") { code.replace("midair::", "crate::") } else { code };
    let paths = code.split("crate::").skip(1).flat_map(expanded).filter_map(|path| {
        let parts: Vec<&str> = path.split("::").collect();
        (1..=parts.len()).rev().map(|n| parts[..n].join("::")).find(|module| files.contains_key(module))
    });
    paths.collect()
}

type Uses<'a> = BTreeMap<&'a str, BTreeSet<String>>;

fn uses(files: &Files) -> Uses<'_> {
    files.iter().map(|(module, text)| (module.as_str(), used(text, files))).collect()
}

/// Returns each use of a module by a module of a lower layer.
fn upward(files: &Files, layers: &[&str]) -> Vec<String> {
    let layer = |module: &str| {
        let top = module.split("::").next().unwrap_or_default();
        layers.iter().position(|known| *known == top).unwrap_or_else(|| panic!("{top} is in no layer: list it"))
    };
    let mut found = Vec::new();
    for (module, used) in uses(files) {
        let above = used.iter().filter(|other| layer(other) > layer(module));
        found.extend(above.map(|other| format!("{module} uses {other}, which stands above it")));
    }
    found
}

/// Returns files that import each other.
fn circles(files: &Files) -> Vec<String> {
    let mut left = uses(files);
    // Removes files that use none of the remaining ones, or that none of them uses, until only circles remain.
    loop {
        let leaf = |module: &str, used: &BTreeSet<String>| !used.iter().any(|u| u != module && left.contains_key(&**u));
        let root = |module: &str| !left.iter().any(|(other, used)| *other != module && used.contains(module));
        let free = left.iter().find(|(module, used)| leaf(module, used) || root(module));
        let Some(module) = free.map(|(module, _)| *module) else { break };
        left.remove(module);
    }
    left.into_keys().map(str::to_owned).collect()
}

/// Returns methods that use a file of another method.
fn entangled(files: &Files) -> Vec<String> {
    let method = |module: &str| {
        let name = module.strip_prefix("solvers::")?.split("::").next()?.to_owned();
        (!SHARED.contains(&&*name)).then_some(name)
    };
    let mut found = Vec::new();
    for (module, used) in uses(files) {
        let Some(own) = method(module) else { continue };
        let others = used.iter().filter(|other| method(other).is_some_and(|other| other != own));
        found.extend(others.map(|other| format!("{module} uses {other}: share it in solvers/common")));
    }
    found
}

#[test]
fn modules_use_only_those_below_and_no_files_import_each_other() {
    let files = tree("src");
    assert!(files.len() > 60, "only {} files were found", files.len());
    for (module, text) in &files {
        assert!(!text.contains("use super::"), "{module}: name each import by its path from the crate");
    }
    assert_eq!(upward(&files, CORE), [""; 0]);
    assert_eq!(circles(&files), [""; 0]);
    assert_eq!(entangled(&files), [""; 0]);
}

#[test]
fn no_files_of_the_python_binding_import_each_other() {
    let files = tree("../python/src");
    assert!(files.len() > 30, "only {} files were found", files.len());
    assert_eq!(circles(&files), [""; 0]);
}

/// Returns the core's files with one line added to a file.
fn pasted(module: &str, line: &str) -> Files {
    let mut files = tree("src");
    files.get_mut(module).expect("a file of the core").push_str(line);
    files
}

#[test]
fn a_pasted_import_upward_is_found() {
    let files = pasted("kernels::grid", "use crate::{error::Error, solvers::{self, fast::Fast}};");
    let found = upward(&files, CORE);
    assert_eq!(found.len(), 2, "{found:?}");
    assert_eq!(found[1], "kernels::grid uses solvers::fast, which stands above it");
}

#[test]
fn a_pasted_circle_is_found() {
    assert_eq!(
        circles(&pasted("files::step", "use crate::files::{place, node::Node};")),
        ["files::json", "files::place", "files::step", "files::toml"]
    );
    assert!(!circles(&pasted("device::format", "use crate::device::boards::{autd3};")).is_empty());
}

#[test]
fn a_method_that_uses_another_is_found() {
    let files = pasted("solvers::naive", "use crate::solvers::{method::Solve, gs::Gs};");
    assert_eq!(entangled(&files), ["solvers::naive uses solvers::gs: share it in solvers/common"]);
}
