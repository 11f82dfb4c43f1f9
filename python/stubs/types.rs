//! Types: those of Python for types of Rust, and for types in numpydoc docstrings.

use std::collections::BTreeMap;

use syn::{GenericArgument, PathArguments, Type};

use crate::source::{Source, text};

/// Direction of a value between Python and Rust.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Way {
    /// An argument, of which Rust accepts more than one type.
    In,
    /// A result.
    Out,
}

/// Types of one extension.
pub(crate) struct Types<'a> {
    source: &'a Source,
    /// The type of each parameter by its name, for docstrings that refer to another one.
    usual: BTreeMap<String, String>,
}

impl<'a> Types<'a> {
    pub(crate) fn of(source: &'a Source) -> Self {
        let classes = source.classes.values();
        let methods = classes.clone().flat_map(|class| &class.methods).chain(source.functions.values());
        let docs = classes.map(|class| &class.doc).chain(methods.map(|function| &function.doc));
        let mut usual = BTreeMap::<String, Vec<String>>::new();
        for (name, kind) in docs.flat_map(|doc| parameters(doc)) {
            usual.entry(name).or_default().extend(kind.iter().flat_map(|kind| kind.split(" | ")).map(Into::into));
        }
        let usual = usual.into_iter().filter_map(|(name, kinds)| Some((name, union(kinds)?))).collect();
        Self { source, usual }
    }

    /// Returns the type of a parameter: from the docstring, else from its Rust type.
    pub(crate) fn argument(&self, name: &str, kind: &Type, doc: &str, class: &str) -> String {
        let stated = parameters(doc).into_iter().find(|(known, _)| known == name);
        let stated = stated.and_then(|(_, kind)| kind.or_else(|| self.usual.get(name).cloned()));
        stated.or_else(|| self.known(kind, Way::In, class)).unwrap_or_else(|| "Any".into())
    }

    /// Returns the type of a result: from its Rust type, else from the docstring.
    pub(crate) fn result(&self, kind: Option<&Type>, doc: &str, class: &str) -> String {
        let Some(kind) = kind else { return "None".into() };
        let known = self.known(kind, Way::Out, class);
        let vague = known.as_ref().is_none_or(|known| known.contains("Any"));
        let stated = section(doc, "Returns").first().and_then(|line| documented(line)).filter(|_| vague);
        stated.or(known).unwrap_or_else(|| "Any".into())
    }

    /// Returns the Python type of a Rust type, or None if it may be any object.
    pub(crate) fn known(&self, kind: &Type, way: Way, class: &str) -> Option<String> {
        let any = |kind: &Type| self.known(kind, way, class).unwrap_or_else(|| "Any".into());
        let several = |inner: &Type| match way {
            _ if text(inner) == "u8" => Some("bytes".into()),
            Way::In if matches!(&*any(inner), "int" | "float") => Some("ArrayLike".into()),
            Way::In => Some(format!("Sequence[{}]", any(inner))),
            Way::Out => Some(format!("list[{}]", any(inner))),
        };
        let path = match kind {
            Type::Reference(kind) => return self.known(&kind.elem, way, class),
            Type::Array(kind) => return several(&kind.elem),
            Type::Slice(kind) => return several(&kind.elem),
            Type::Tuple(kind) if kind.elems.is_empty() => return Some("None".into()),
            Type::Tuple(kind) => {
                return Some(format!("tuple[{}]", kind.elems.iter().map(any).collect::<Vec<_>>().join(", ")));
            }
            Type::Path(kind) => kind.path.segments.last()?,
            _ => return None,
        };
        let inner = match &path.arguments {
            PathArguments::AngleBracketed(all) => all.args.iter().find_map(|one| match one {
                GenericArgument::Type(kind) => Some(kind),
                _ => None,
            }),
            _ => None,
        };
        let name = path.ident.to_string();
        match (name.as_str(), inner) {
            ("PyAny", _) => None,
            ("Bound" | "Py" | "PyResult", Some(inner)) => self.known(inner, way, class),
            ("Option", Some(inner)) => Some(format!("{} | None", self.known(inner, way, class)?)),
            ("Vec", Some(inner)) => several(inner),
            (array, Some(inner)) if array.starts_with("PyArray") || array.starts_with("PyReadonlyArray") => {
                Some(format!("NDArray[np.{}]", number(&text(inner))))
            }
            ("Self", _) => Some(class.into()),
            ("f32" | "f64", _) => Some("float".into()),
            ("bool", _) => Some("bool".into()),
            ("String" | "str", _) => Some("str".into()),
            ("PathBuf", _) => Some(if way == Way::In { "str | PathLike[str]" } else { "pathlib.Path" }.into()),
            ("PyErr", _) => Some("SceneError".into()),
            ("PyBytes", _) => Some("bytes".into()),
            ("PyComplex", _) => Some("complex".into()),
            ("PyDict", _) => Some("dict[str, Any]".into()),
            ("PyTuple", _) => Some("tuple[Any, ...]".into()),
            (integer, _) if integer.starts_with(['i', 'u']) => Some("int".into()),
            (class, _) if self.source.classes.contains_key(class) => Some(class.into()),
            (alias, _) => match self.source.aliases.get(alias) {
                Some(kind) => self.known(kind, way, class),
                None => panic!("{alias} has no type in Python: add it to python/stubs/types.rs"),
            },
        }
    }
}

/// Returns NumPy's name of a type of numbers.
fn number(kind: &str) -> String {
    match kind.rsplit(' ').next().unwrap_or(kind) {
        "f32" => "float32".into(),
        "f64" => "float64".into(),
        "Complex32" => "complex64".into(),
        "Complex64" => "complex128".into(),
        "bool" => "bool_".into(),
        "usize" => "uintp".into(),
        integer => integer.replace('i', "int").replace('u', "uint"),
    }
}

/// Returns the lines of a section of a docstring.
fn section<'a>(doc: &'a str, title: &str) -> Vec<&'a str> {
    let lines: Vec<_> = doc.lines().collect();
    let is_rule = |k: usize| lines.get(k).is_some_and(|line| line.starts_with("---"));
    let Some(first) = (0..lines.len()).find(|&k| lines[k] == title && is_rule(k + 1)) else { return Vec::new() };
    (first + 2..lines.len()).take_while(|&k| !is_rule(k + 1)).map(|k| lines[k]).collect()
}

fn parameters(doc: &str) -> Vec<(String, Option<String>)> {
    entries(doc, "Parameters")
}

/// Returns the names in a section of a docstring, each with its type if it is stated.
pub(crate) fn entries(doc: &str, title: &str) -> Vec<(String, Option<String>)> {
    let lines = section(doc, title).into_iter().filter(|line| !line.is_empty() && !line.starts_with(' '));
    let each = lines.flat_map(|line| {
        let (names, kind) = line.split_once(" : ").unwrap_or((line, ""));
        names.split(", ").map(move |name| (name.to_owned(), documented(kind)))
    });
    each.collect()
}

/// Returns the type that a docstring names, such as `(N,) array_like or midair.Solution, optional`.
fn documented(kind: &str) -> Option<String> {
    let kind = kind.trim_end_matches(", optional");
    if let Some(words) = kind.strip_prefix('{') {
        return Some(format!("Literal[{}]", words.trim_end_matches('}')));
    }
    if let "(int, int)" | "(float, float)" = kind {
        return Some(format!("tuple[{}]", kind.trim_matches(['(', ')'])));
    }
    if let Some(value) = kind.strip_prefix("dict of str to ") {
        return Some(format!("dict[str, {}]", documented(value)?));
    }
    let mut words = kind.split(|c: char| !c.is_alphanumeric() && c != '.' && c != '_').peekable();
    let mut kinds: Vec<String> = Vec::new();
    while let Some(word) = words.next() {
        let of = if words.peek() == Some(&"of") { words.nth(1) } else { None };
        kinds.push(match word {
            "array_like" => "ArrayLike".into(),
            "ndarray" => format!("NDArray[{}]", of.map_or_else(|| "Any".into(), |of| format!("np.{of}"))),
            "callable" => "Callable[..., object]".into(),
            "mapping" => "Mapping[str, Any]".into(),
            "list" => "Iterable[Any]".into(),
            "path" => "PathLike[str]".into(),
            "bool" | "bytes" | "float" | "int" | "str" | "None" => word.into(),
            _ => match word.strip_prefix("midair.") {
                Some(class) => class.into(),
                None => continue,
            },
        });
    }
    union(kinds)
}

/// Returns the union of some types, or None if there are none.
fn union(kinds: Vec<String>) -> Option<String> {
    let any_number = kinds.iter().any(|kind| kind == "ArrayLike");
    let mut all: Vec<String> = Vec::new();
    for kind in kinds {
        let is_number = any_number && matches!(&*kind, "float" | "int");
        if !is_number && !all.contains(&kind) {
            all.push(kind);
        }
    }
    (!all.is_empty()).then(|| all.join(" | "))
}
