//! Tests the layers of the core: a module uses only modules of lower layers, no two files use each other, and no method uses a
//! file of another method. The files of the other crates do not use each other in a circle either, and those of the browser's
//! binding, the C library and the firmware have layers.
//!
//! A path counts wherever it stands: in a `use`, in an expression or a type, from `crate`, `self`, `super`, a child module or an
//! imported name. A name that a file exports again counts as its file of origin, also a name of the crate's root. A file that
//! only exports names of its own folder does not use them.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The modules of `core/src`, the lowest layer first. A module may use itself and the modules before it.
const CORE: &[&str] = &[
    "error",
    "threads",
    "control",
    "math",
    "vec3",
    "rng",
    "prelude",
    "kernels",
    "device",
    "workspace",
    "linalg",
    "scene",
    "points",
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
    "prelude",
    "registry",
    "remark",
    "solve",
];

/// The modules of the bindings in other languages and of the firmware, the lowest layer first.
const OTHERS: &[(&str, &[&str])] = &[
    ("studio/door/src", &["catalogue", "lattices", "opened", "studio", "beads", "drawn", "play", "touch", "lib"]),
    (
        "capi/src",
        &[
            "abi",
            "instruction_set",
            "outcome",
            "memory",
            "version",
            "answer",
            "array",
            "option",
            "session",
            "board",
            "motion",
            "batch",
            "lib",
        ],
    ),
    ("firmware/src", &["board", "clock", "heap", "stack", "player", "mute", "measured", "lib", "bin"]),
];

/// A path of names, such as `[crate, kernels, LANES]`.
type Names = Vec<String>;

/// A file and the names in it. Its module's path, such as `[kernels, simd]`, is its key in [`Crate`].
#[derive(Default)]
struct File {
    /// Imported paths: the name in this file, and whether other files see it.
    imports: Vec<(Names, String, bool)>,
    /// Paths of two names or more in the rest of the code.
    paths: Vec<Names>,
    /// All single names of the rest of the code, and the first names of its paths.
    words: BTreeSet<String>,
}

/// The files of a crate by module.
type Crate = BTreeMap<Names, File>;

/// Returns the words and signs of a source, without comments, texts and the tests at its end.
fn tokens(source: &str) -> Vec<String> {
    let source = source.split("\n#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let mut tokens = Vec::new();
    let mut rest = source;
    while let Some(letter) = rest.chars().next() {
        let named = |c: char| c.is_alphanumeric() || c == '_';
        let skipped = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if letter == '"' {
            let mut letters = rest.char_indices().skip(1);
            loop {
                match letters.next() {
                    Some((_, '\\')) => _ = letters.next(),
                    Some((end, '"')) => break end + 1,
                    None => break rest.len(),
                    _ => {}
                }
            }
        } else if rest.starts_with("r\"") || rest.starts_with("r#\"") {
            let fence = if rest.starts_with("r#") { "\"#" } else { "\"" };
            rest[fence.len() + 1..].find(fence).map_or(rest.len(), |end| end + 1 + 2 * fence.len())
        } else if letter == '\'' {
            // A letter in quotes ends by a quote, a lifetime does not.
            let mut letters = rest[1..].char_indices();
            match (letters.next(), letters.next()) {
                (Some((_, '\\')), Some((second, _))) => {
                    rest[1 + second + 1..].find('\'').map_or(rest.len(), |end| second + 3 + end)
                }
                (Some(_), Some((second, '\''))) => second + 2,
                _ => 1,
            }
        } else {
            let length = match rest.find(|c| !named(c)).unwrap_or(rest.len()) {
                0 if rest.starts_with("::") => 2,
                0 => letter.len_utf8(),
                length => length,
            };
            if !letter.is_whitespace() {
                tokens.push(rest[..length].to_owned());
            }
            length
        };
        rest = &rest[skipped..];
    }
    tokens
}

/// Reads the tree of a `use` from its first token, and adds each path with its name in the file. Returns the token after it.
fn tree(tokens: &[String], mut at: usize, mut path: Names, found: &mut Vec<(Names, String)>) -> usize {
    while at < tokens.len() {
        match &*tokens[at] {
            "{" => {
                at += 1;
                while tokens[at] != "}" {
                    at = tree(tokens, at, path.clone(), found);
                    at += usize::from(tokens[at] == ",");
                }
                return at + 1;
            }
            "::" => at += 1,
            "as" => {
                found.push((path, tokens[at + 1].clone()));
                return at + 2;
            }
            "," | ";" | "}" => break,
            "self" if !path.is_empty() => at += 1,
            word => {
                path.push(word.to_owned());
                at += 1;
            }
        }
    }
    let name = path.last().cloned().unwrap_or_default();
    found.push((path, name));
    at
}

fn read(source: &str) -> File {
    let tokens = tokens(source);
    let word = |at: usize| tokens.get(at).is_some_and(|t| t.starts_with(|c: char| c.is_alphabetic() || c == '_'));
    let mut file = File::default();
    let mut at = 0;
    while at < tokens.len() {
        if tokens[at] == "use" && word(at + 1) {
            let exported = at > 0 && (tokens[at - 1] == "pub" || tokens[at - 1] == ")");
            let mut found = Vec::new();
            at = tree(&tokens, at + 1, Vec::new(), &mut found);
            file.imports.extend(found.into_iter().map(|(path, name)| (path, name, exported)));
        } else if tokens[at] == "mod" {
            at += 2;
        } else if word(at) {
            let mut path = vec![tokens[at].clone()];
            while tokens.get(at + 1).is_some_and(|t| t == "::") && word(at + 2) {
                at += 2;
                path.push(tokens[at].clone());
            }
            file.words.insert(path[0].clone());
            if path.len() > 1 {
                file.paths.push(path);
            }
            at += 1;
        } else {
            at += 1;
        }
    }
    file
}

/// Returns the sources of a folder by module, without those of tests.
fn sources(folder: &Path, module: &[String], texts: &mut BTreeMap<Names, String>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let inside = [module, std::slice::from_ref(&name)].concat();
        if path.is_dir() {
            if name != "tests" {
                sources(&path, &inside, texts);
            }
        } else if path.extension().is_some_and(|kind| kind == "rs") {
            let own = ["mod", "lib", "main"].contains(&&*name);
            texts.insert(if own { module.to_vec() } else { inside }, fs::read_to_string(&path).expect("text"));
        }
    }
}

/// Returns the sources of a crate by module.
fn texts(folder: &Path) -> BTreeMap<Names, String> {
    let mut texts = BTreeMap::new();
    sources(folder, &[], &mut texts);
    texts
}

fn core() -> BTreeMap<Names, String> {
    texts(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"))
}

fn names(path: &str) -> Names {
    path.split("::").filter(|name| !name.is_empty()).map(str::to_owned).collect()
}

fn parsed(texts: &BTreeMap<Names, String>) -> Crate {
    let mut files: Crate = texts.iter().map(|(module, text)| (module.clone(), read(text))).collect();
    // A macro that is exported is a name of the crate's root.
    let exported = texts.iter().filter(|(module, _)| !module.is_empty()).flat_map(|(module, text)| {
        text.split("#[macro_export]").skip(1).filter_map(|rest| {
            let name = rest.split("macro_rules! ").nth(1)?.split([' ', '{']).next()?;
            Some(([module.clone(), vec![name.to_owned()]].concat(), name.to_owned()))
        })
    });
    let exported: Vec<_> = exported.collect();
    if let Some(root) = files.get_mut(&Vec::new()) {
        root.imports
            .extend(exported.into_iter().map(|(path, name)| ([vec!["crate".into()], path].concat(), name, true)));
    }
    files
}

/// Returns the path from the crate's root of a path in a module. `None` if it begins with a name of no module.
fn absolute(files: &Crate, module: &[String], path: &[String]) -> Option<Names> {
    let mut base = module.to_vec();
    let mut rest = path;
    match &*path[0] {
        "crate" | "midair" if path[0] == "crate" || files.contains_key(&vec!["kernels".to_owned()]) => {
            base.clear();
            rest = &rest[1..];
        }
        "self" => rest = &rest[1..],
        "super" => {
            while rest.first().is_some_and(|name| name == "super") {
                base.pop();
                rest = &rest[1..];
            }
        }
        name => {
            let child = [module, std::slice::from_ref(&path[0])].concat();
            if !files.contains_key(&child) {
                let imports = &files[module].imports;
                let (origin, ..) = imports.iter().find(|(origin, known, _)| known == name && origin[0] != *name)?;
                base = absolute(files, module, origin)?;
                rest = &rest[1..];
            }
        }
    }
    base.extend_from_slice(rest);
    Some(base)
}

/// Returns the module whose file defines a path from the crate's root.
fn home(files: &Crate, path: &[String]) -> Names {
    let mut module = Vec::new();
    for (at, name) in path.iter().enumerate() {
        module.push(name.clone());
        if !files.contains_key(&module) {
            module.pop();
            let imports = &files[&module].imports;
            // All names of a module are those of its own file.
            let origin = imports.iter().find(|(_, known, _)| known == name && name != "*");
            let origin = origin.and_then(|(origin, ..)| absolute(files, &module, origin));
            return match origin {
                Some(origin) if origin != path[..=at] => home(files, &[origin, path[at + 1..].to_vec()].concat()),
                _ => module,
            };
        }
    }
    module
}

/// The modules that each module uses.
type Uses = BTreeMap<String, BTreeSet<String>>;

fn uses(texts: &BTreeMap<Names, String>) -> Uses {
    let files = parsed(texts);
    let shown = |module: &[String]| if module.is_empty() { "lib".to_owned() } else { module.join("::") };
    let mut uses = Uses::new();
    for (module, file) in &files {
        let of_folder = |path: &Names| path.starts_with(module);
        let imports = file.imports.iter().filter_map(|(path, name, exported)| {
            let path = absolute(&files, module, path)?;
            let facade = *exported && of_folder(&path) && !file.words.contains(name);
            (!facade).then_some(path)
        });
        let paths = file.paths.iter().filter_map(|path| absolute(&files, module, path));
        let used = imports.chain(paths).map(|path| home(&files, &path)).filter(|home| home != module);
        uses.insert(shown(module), used.map(|home| shown(&home)).collect());
    }
    uses
}

/// Returns each use of a module by a module of a lower layer.
fn upward(uses: &Uses, layers: &[&str]) -> Vec<String> {
    let layer = |module: &str| {
        let top = module.split("::").next().unwrap_or_default();
        layers.iter().position(|known| *known == top).unwrap_or_else(|| panic!("{top} is in no layer: list it"))
    };
    let mut above = Vec::new();
    for (module, used) in uses {
        let higher = used.iter().filter(|other| layer(other) > layer(module));
        above.extend(higher.map(|other| format!("{module} uses {other}, which stands above it")));
    }
    above
}

/// Returns the files that use themselves by way of others.
fn circles(uses: &Uses) -> Vec<String> {
    let circular = |module: &&String| {
        let mut reached = BTreeSet::new();
        let mut next: Vec<&String> = uses[*module].iter().collect();
        while let Some(other) = next.pop() {
            if reached.insert(other) {
                next.extend(&uses[other]);
            }
        }
        reached.contains(module)
    };
    uses.keys().filter(circular).cloned().collect()
}

/// Returns methods that use a file of another method.
fn entangled(uses: &Uses) -> Vec<String> {
    let method = |module: &str| {
        let name = module.strip_prefix("solvers::")?.split("::").next()?.to_owned();
        (!SHARED.contains(&&*name)).then_some(name)
    };
    let mut found = Vec::new();
    for (module, used) in uses {
        let Some(own) = method(module) else { continue };
        let others = used.iter().filter(|other| method(other).is_some_and(|other| other != own));
        found.extend(others.map(|other| format!("{module} uses {other}: share it in solvers/common")));
    }
    found
}

/// Returns the folders with the sources of all crates except the core.
fn crates() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("a folder");
    let folders = |folder: &Path| {
        let entries = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
        entries.filter(|path| path.is_dir() && !path.ends_with("target")).collect::<Vec<_>>()
    };
    let outer = folders(root);
    let inner = outer.iter().filter(|path| !path.ends_with("core")).flat_map(|path| folders(path));
    let all =
        inner.chain(outer.iter().cloned()).filter(|path| !path.ends_with("core") && path.join("Cargo.toml").exists());
    all.map(|path| path.join("src")).filter(|path| path.is_dir()).collect()
}

#[test]
fn modules_use_only_those_below_and_no_files_use_each_other() {
    let texts = core();
    assert!(texts.len() > 60, "only {} files were found", texts.len());
    for (module, text) in &texts {
        assert!(!text.contains("use super::"), "{module:?}: name each import by its path from the crate");
    }
    let uses = uses(&texts);
    assert_eq!(upward(&uses, CORE), [""; 0]);
    assert_eq!(circles(&uses), [""; 0]);
    assert_eq!(entangled(&uses), [""; 0]);
}

#[test]
fn no_files_of_another_crate_use_each_other() {
    let crates = crates();
    for known in ["python/src", "capi/src", "studio/door/src", "firmware/src", "fuzz/src"] {
        assert!(crates.iter().any(|path| path.ends_with(known)), "{known} was not found");
    }
    for folder in crates {
        assert_eq!(circles(&uses(&texts(&folder))), [""; 0], "{}", folder.display());
    }
}

/// Returns the uses of a crate's modules with a line before one of them; `folder` is its path from the root.
fn pasted_to(folder: &str, module: &str, line: &str) -> Uses {
    let mut texts = texts(&Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder));
    texts.get_mut(&names(module)).unwrap_or_else(|| panic!("{folder} has no {module}")).insert_str(0, line);
    uses(&texts)
}

#[test]
fn modules_of_other_crates_use_only_those_below() {
    for (folder, layers) in OTHERS {
        assert_eq!(upward(&pasted_to(folder, layers[0], ""), layers), [""; 0], "{folder}");
    }
}

#[test]
fn an_import_upward_or_in_a_circle_is_found_in_each_crate() {
    // `memory` is used by `session`, and so on; nothing uses the last module.
    for (folder, low, user, top) in [
        ("studio/door/src", "lattices", "studio", "play"),
        ("capi/src", "memory", "session", "batch"),
        ("firmware/src", "player", "measured", "measured"),
    ] {
        let layers = OTHERS.iter().find(|(known, _)| *known == folder).expect("layers").1;
        for (other, circular) in [(user, true), (top, false)] {
            for form in ["use crate::NAME::X;", "use crate::{NAME::{self as a}};", "fn x() { super::NAME::X; }"] {
                let line = form.replace("NAME", other);
                let uses = pasted_to(folder, low, &line);
                let found = format!("{low} uses {other}, which stands above it");
                assert!(upward(&uses, layers).contains(&found), "{folder}: {line}");
                assert!(!circular || circles(&uses).contains(&low.to_owned()), "{folder}: {line}");
            }
        }
    }
    for (folder, low) in [("python/src", "read"), ("fuzz/src", "answer")] {
        let uses = pasted_to(folder, low, "use crate::scene::X;");
        assert!(circles(&uses).contains(&"scene".to_owned()), "{folder}");
    }
}

/// Returns the uses upward after a line is added to `kernels::grid`.
fn pasted(line: &str) -> Vec<String> {
    let mut texts = core();
    texts.get_mut(&names("kernels::grid")).expect("a file of the core").push_str(line);
    upward(&uses(&texts), CORE)
}

#[test]
fn an_import_upward_is_found_in_each_form() {
    let found = |file: &str| [format!("kernels::grid uses {file}, which stands above it")];
    for line in [
        "use crate::solvers::{fast::Fast};",
        "use crate::{\n    error::Error,\n    solvers::{self, fast::Fast as Other},\n};\nuse Other::x;",
        "use crate::\n    solvers::fast;",
        "fn above() { super::super::solvers::fast::Fast::default(); }",
        "type Above = crate::solvers::fast::Fast;",
        "use midair::solvers::fast::*;",
        "use crate::solvers as all;\ntype Above = all::Fast;",
    ] {
        assert!(pasted(line).contains(&found("solvers::fast")[0]), "{line}: {:?}", pasted(line));
    }
    for line in [
        "use crate::Session;",
        "use crate::{Session, solve};",
        "pub use midair::Session;",
        "use super::super::Session;",
    ] {
        assert!(pasted(line).contains(&found("session")[0]), "{line}: {:?}", pasted(line));
    }
    for line in
        ["// use crate::Session;", "/// [`crate::Session`]\nfn own() {}", "const TEXT: &str = \"use crate::Session;\";"]
    {
        assert_eq!(pasted(line), [""; 0], "{line}");
    }
}

/// Returns the circle of the files of a small crate, each a module with its text.
fn circle(files: &[(&str, &str)]) -> Vec<String> {
    circles(&uses(&files.iter().map(|(module, text)| (names(module), (*text).to_owned())).collect()))
}

#[test]
fn a_circle_is_found_in_each_form() {
    let part = "use crate::other::Other;\npub struct Part(Other);";
    for other in [
        "use crate::part::Part;\npub struct Other(Part);",
        "pub struct Other(crate::part::Part);",
        "pub struct Other(super::part::Part);",
        "pub struct Other(super::super::part::Part);",
        "use crate::part;\npub struct Other(part::Part);",
        "use crate::{\n    part::{self},\n};\npub struct Other;",
        "pub use crate::part::Part;\npub struct Other;",
        "use crate::Part;\npub struct Other(Part);",
        "use crate::Alias;\npub struct Other(Alias);",
        "use crate::all::Part;\npub struct Other(Part);",
        "pub struct Other(crate::all::Part);",
    ] {
        let root = "mod all;\nmod other;\nmod part;\npub use part::{Part, Part as Alias};";
        let found = circle(&[("", root), ("all", "pub use crate::part::Part;"), ("other", other), ("part", part)]);
        assert_eq!(found, ["other", "part"], "{other}");
    }
}

#[test]
fn a_folder_may_export_its_files_but_not_use_them_if_they_use_it() {
    let child = "use crate::room::Room;\npub struct Child(Room);";
    for (room, expected) in [
        ("mod child;\npub use child::Child;\npub struct Room;", &[][..]),
        ("mod child;\npub use child::Child;\npub struct Room(Option<Child>);", &["room", "room::child"]),
        ("mod child;\nuse child::Child;\npub struct Room;", &["room", "room::child"]),
        ("mod child;\npub struct Room;\nfn make() { child::Child; }", &["room", "room::child"]),
        ("mod child;\npub struct Room;\nfn make() { self::child::Child; }", &["room", "room::child"]),
    ] {
        assert_eq!(circle(&[("", "mod room;"), ("room", room), ("room::child", child)]), expected, "{room}");
    }
}

#[test]
fn a_method_that_uses_another_is_found() {
    for line in ["use crate::solvers::{method::Solve, gs::Gs};", "use crate::solvers::Gs;"] {
        let mut texts = core();
        texts.get_mut(&names("solvers::naive")).expect("a method").push_str(line);
        assert_eq!(entangled(&uses(&texts)), ["solvers::naive uses solvers::gs: share it in solvers/common"]);
    }
}
