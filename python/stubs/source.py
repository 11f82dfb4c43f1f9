"""What the extension exports, read from its Rust source, which rustfmt has formatted."""

import ast
import json
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from textwrap import dedent

#: Doc comments and attributes before an item.
BEFORE = r"(?P<before>(?:^ *(?:///[^\n]*|#\[(?:[^\[\]]|\[[^\]]*\])*\])\n)*)^ *(?:pub(?:\(crate\))? )?"

FUNCTION = re.compile(BEFORE + r"fn (\w+)(?:<[^(]*>)?\((.*?)\)(?: -> ([^{]*?))? \{$", re.MULTILINE | re.DOTALL)
STRUCT = re.compile(BEFORE + r"struct (\w+)(?: \{(.*?)^\}|.*?;$)", re.MULTILINE | re.DOTALL)
METHODS = re.compile(r"^#\[pymethods\]\nimpl (\w+) \{\n(.*?)^\}", re.MULTILINE | re.DOTALL)
FIELD = re.compile(BEFORE + r"(\w+): (.*),$", re.MULTILINE)
GETTERS = re.compile(r"^getters! \{\n    (\w+):\n(.*?)^\}", re.MULTILINE | re.DOTALL)
GETTER = re.compile(BEFORE + r"(\w+)\(\w+(?:, _?py)?\) -> (.*?) =\s", re.MULTILINE)
BODIES = re.compile(r"^bodies! \{\n(.*?)^\}", re.MULTILINE | re.DOTALL)
BODY = re.compile(BEFORE + r"(\w+) \{\n(.*?)^    \}", re.MULTILINE | re.DOTALL)
METRIC = re.compile(BEFORE + r"(\w+)$", re.MULTILINE)
EXCEPTION = re.compile(
    r'^pyo3::create_exception!\(\s*midair,\s*(\w+),\s*[\w:]*::Py(\w+),\s*("(?:[^"\\]|\\.)*")', re.MULTILINE
)
ALIAS = re.compile(r"^(?:pub\(crate\) )?type (\w+)(?:<.*?>)? =\s*(.*?);$", re.MULTILINE | re.DOTALL)
EXPORTED = re.compile(r"#\[pymodule_export\]\n *use ([^;]*);")
CONSTANT = re.compile(BEFORE + r"const (\w+): (.*?) =", re.MULTILINE)


@dataclass
class Argument:
    """An argument: its name, its Rust type, its default in Rust, and whether it is `*`, `**` or neither."""

    name: str
    kind: str
    default: str | None = None
    by: str = ""


@dataclass
class Function:
    """A function or a method; `first` is its argument "self" or "cls", if it has one."""

    name: str
    doc: str
    first: str
    arguments: list[Argument]
    returns: str


@dataclass
class Property:
    """A property of a class, or a constant."""

    name: str
    kind: str
    doc: str


@dataclass
class Class:
    """A class: its docstring, the words of its `pyclass`, and its members."""

    doc: str = ""
    options: str = ""
    properties: list[Property] = field(default_factory=list)
    methods: list[Function] = field(default_factory=list)


@dataclass
class Exported:
    """All declarations by their names in Rust, and the exported names in order."""

    names: list[str] = field(default_factory=list)
    constants: list[Property] = field(default_factory=list)
    exceptions: dict[str, tuple[str, str]] = field(default_factory=dict)
    classes: dict[str, Class] = field(default_factory=dict)
    functions: dict[str, Function] = field(default_factory=dict)
    #: Each `type Name = ...`.
    aliases: dict[str, str] = field(default_factory=dict)


def read(crate: Path) -> Exported:
    """Returns the declarations of the crate."""
    exported = Exported()
    for path in sorted((crate / "src").glob("*.rs")):
        _add(exported, path.read_text(encoding="utf-8"))
    core = (crate.parent / "core" / "src" / "problem" / "metrics.rs").read_text(encoding="utf-8")
    metrics = core.partition("$define! {\n")[2].partition("        }\n")[0]
    for owner, kind in (("Metrics", "f64"), ("BatchMetrics", "PyArray1<f64>")):
        found = METRIC.findall(metrics)
        exported.classes[owner].properties += [Property(name, kind, _doc(about)) for about, name in found]
    return exported


def _add(exported: Exported, text: str) -> None:
    classes = exported.classes
    for before, name, fields in STRUCT.findall(text):
        if "#[pyclass" in before:
            owner = classes.setdefault(name, Class())
            owner.doc, owner.options = _doc(before), before.partition("#[pyclass(")[2].partition(")]")[0]
            owner.properties += [
                Property(each, kind, _doc(about))
                for about, each, kind in FIELD.findall(fields)
                if "get_all" in owner.options or "#[pyo3(get)]" in about
            ]
    for name, body in METHODS.findall(text):
        owner = classes.setdefault(name, Class())
        for match in FUNCTION.finditer(dedent(body)):
            function = _function(*match.groups(""))
            if "#[getter]" in match["before"]:
                owner.properties.append(Property(function.name, function.returns, function.doc))
            else:
                owner.methods.append(function)
    for name, body in GETTERS.findall(text):
        owner = classes.setdefault(name, Class())
        owner.properties += [Property(each, kind, _doc(about)) for about, each, kind in GETTER.findall(body)]
    for bodies in BODIES.findall(text):
        for before, name, fields in BODY.findall(bodies):
            exported.names.append(name)
            parts = [Property(each, kind, _doc(about)) for about, each, kind in FIELD.findall(fields)]
            parts.append(Property("kind", "str", '"rigid" or "soft".'))
            arguments = [Argument(part.name, part.kind) for part in parts]
            arguments[-1].default = '"rigid"'
            new = Function("_new", "", "", arguments, "Self")
            classes[name] = Class(_doc(before), "eq, hash", parts, [new])
    for name, base, doc in EXCEPTION.findall(text):
        exported.exceptions[name] = (base, json.loads(doc, strict=False))
    exported.aliases |= dict(ALIAS.findall(text))
    for match in FUNCTION.finditer(text):
        if "#[pyfunction" in match["before"]:
            exported.functions[match[2]] = _function(*match.groups(""))
    for tree in EXPORTED.findall(text):
        exported.names += re.findall(r"\w+(?!\w|::)", tree)
    exported.constants += [
        Property(name, kind, _doc(before))
        for before, name, kind in CONSTANT.findall(text)
        if "#[pymodule_export]" in before
    ]


def _doc(before: str) -> str:
    """Returns the text of doc comments."""
    return "\n".join(re.findall(r"^ */// ?(.*)$", before, re.MULTILINE)).strip()


def _function(before: str, name: str, inputs: str, returns: str) -> Function:
    kinds = dict(input.split(": ", 1) for input in split(inputs) if ": " in input)
    first = "self" if "slf" in kinds or re.match(r"&?(mut )?self", inputs.strip()) else ""
    kinds = {name.removeprefix("mut "): kind for name, kind in kinds.items() if name not in ("slf", "py")}
    options = "".join(re.findall(r"#\[(?:pyo3|pyfunction)\((.*?)\)\]", before, re.DOTALL))
    if named := re.search(r'(?<!\w)name = "(\w+)"', options):
        name = named[1]
    if "#[new]" in before:
        name = "_new"
    stated = re.search(r'text_signature = "\((.*)\)"', options)
    stated = stated or re.search(r"signature = \((.*)\)", options, re.DOTALL)
    if stated is None:
        arguments = [Argument(*each) for each in kinds.items()]
    else:
        # A name without a type is one of `**keys`.
        arguments = [Argument(name, kinds.get(name, "PyAny"), *how) for name, *how in _stated(stated[1])]
    return Function(name, _doc(before), first, arguments, returns)


def _stated(signature: str) -> Iterator[tuple[str, str | None, str]]:
    """Yields name, default and passing of each argument of a signature, which Python can parse."""
    text = f"def f({' '.join(signature.split())}): ..."
    (function,) = ast.parse(text).body
    assert isinstance(function, ast.FunctionDef)
    all_ = function.args
    places: list[ast.expr | None] = [None] * (len(all_.args) - len(all_.defaults))
    for group, defaults, by in (
        (all_.args, places + all_.defaults, ""),
        (all_.kwonlyargs, all_.kw_defaults, "*"),
        ([all_.kwarg] if all_.kwarg else [], [None], "**"),
    ):
        for one, default in zip(group, defaults, strict=False):
            yield one.arg, default and ast.get_source_segment(text, default), by


def split(text: str) -> list[str]:
    """Returns the parts of a list of Rust's arguments or types."""
    parts, depth = [""], 0
    for letter in text:
        depth += (letter in "<([{") - (letter in ">)]}")
        if letter == "," and not depth:
            parts.append("")
        else:
            parts[-1] += letter
    return [" ".join(part.split()) for part in parts if part.strip()]
