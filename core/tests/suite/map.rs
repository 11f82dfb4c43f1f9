//! docs/map.md lists the source files of core, bindings, package and studio with their first lines; `make generated` writes it again.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

const HEAD: &str = "# Map of the sources\n\nThe source files of the core, its bindings, the package and the studio, each with its first line. `make generated`\nwrites this page.\n\n";

/// The first line of a file, which describes its contents.
fn first_line(path: &Path) -> String {
    let text = fs::read_to_string(path).expect("text");
    let line = text.lines().next().unwrap_or_default();
    let begun = line.trim_start_matches("//!").trim_start_matches("\"\"\"").trim_start_matches("/**");
    begun.trim_end_matches("\"\"\"").trim_end_matches("*/").trim().to_owned()
}

/// Writes a folder and its subfolders to the map, files first, one line for each file.
fn draw(root: &Path, folder: &str, map: &mut String) {
    let mut paths: Vec<PathBuf> =
        fs::read_dir(root.join(folder)).expect("a folder").map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    writeln!(map, "{folder}/").expect("text");
    let name = |path: &Path| path.file_name().expect("a name").to_string_lossy().into_owned();
    for path in paths
        .iter()
        .filter(|path| path.extension().is_some_and(|kind| ["rs", "py", "ts"].iter().any(|known| kind == *known)))
    {
        let line = first_line(path);
        let known = line.len() > 10 && line.ends_with(['.', ':']) || name(path) == "__init__.py";
        assert!(known, "{}: begin with a line that says what is in it, ended by a full stop", path.display());
        writeln!(map, "  {:24} {line}", name(path)).expect("text");
    }
    for path in paths.iter().filter(|path| path.is_dir() && !["tests", "__pycache__", "built"].contains(&&*name(path)))
    {
        draw(root, &format!("{folder}/{}", name(path)), map);
    }
}

#[test]
fn the_map_names_every_file_and_what_is_in_it() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("a folder");
    let mut map = String::from("```text\n");
    for folder in
        ["core/src", "python/src", "python/stubs", "capi/src", "python/midair", "studio/door/src", "studio/src"]
    {
        draw(root, folder, &mut map);
    }
    map.push_str("```\n");
    let (page, map) = (root.join("docs/map.md"), format!("{HEAD}{map}"));
    if std::env::var("MIDAIR_MAP").is_ok_and(|what| what == "write") {
        fs::write(&page, map).expect("written");
    } else if fs::read_to_string(&page).ok().is_none_or(|found| found.replace('\r', "") != map) {
        panic!("docs/map.md does not list the sources as they are: run `make generated` and commit docs/map.md");
    }
}

#[test]
fn each_code_of_errors_is_listed() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/errors.md");
    let text = fs::read_to_string(&page).expect("docs/errors.md").replace('\r', "");
    let (head, table) = text.split_at(text.find("| code |").expect("a table of codes"));
    let end = table.find("\n\n").map_or(table.len(), |end| end + 1);
    let mut own = String::from("| code | meaning |\n|---|---|\n");
    for (_, code, meaning) in midair::ErrorCode::ALL {
        writeln!(own, "| `{code}` | {} |", meaning.trim_end_matches('.').replace('|', "\\|")).expect("text");
    }
    if std::env::var("MIDAIR_MAP").is_ok_and(|what| what == "write") {
        fs::write(&page, format!("{head}{own}{}", &table[end..])).expect("written");
    } else {
        assert!(
            table[..end] == own,
            "docs/errors.md does not list the codes as they are: run `make generated` and commit it"
        );
    }
}
