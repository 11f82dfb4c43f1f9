"""Types of Python, for types of Rust and for types in numpydoc docstrings."""

import re
from collections import defaultdict

from source import Exported, split

#: Python's types by names in Rust; an argument may have a wider one.
KNOWN = {
    "()": "None",
    "bool": "bool",
    "f32": "float",
    "f64": "float",
    "str": "str",
    "String": "str",
    "Lossy": "str",
    "PathBuf": "pathlib.Path",
    "PyBytes": "bytes",
    "PyComplex": "complex",
    "PyDict": "dict[str, Any]",
    "PyErr": "SceneError",
    "PyTuple": "tuple[Any, ...]",
}

#: NumPy's types by those of Rust.
NUMBERS = {
    "bool": "bool_",
    "u8": "uint8",
    "u16": "uint16",
    "u32": "uint32",
    "usize": "uintp",
    "i64": "int64",
    "f32": "float32",
    "f64": "float64",
    "Complex32": "complex64",
    "Complex64": "complex128",
}

#: Types by words of docstrings.
WORDS = {
    "array_like": "ArrayLike",
    "callable": "Callable[..., object]",
    "mapping": "Mapping[str, Any]",
    "list": "Iterable[Any]",
    "path": "PathLike[str]",
    **{name: name for name in ("bool", "bytes", "float", "int", "str", "None")},
}


class Kinds:
    """Types of the declarations of one extension."""

    def __init__(self, exported: Exported) -> None:
        self._exported = exported
        owners = exported.classes.values()
        functions = [*exported.functions.values(), *(each for owner in owners for each in owner.methods)]
        usual: defaultdict[str, list[str]] = defaultdict(list)
        for doc in (each.doc for each in (*owners, *functions)):
            for name, kind in entries(doc, "Parameters").items():
                usual[name] += kind.split(" | ") if kind else []
        # The type of each parameter by its name, for docstrings that refer to another one.
        self._usual = {name: union(kinds) for name, kinds in usual.items()}

    def argument(self, name: str, kind: str, doc: str, owner: str) -> str:
        """Returns the type of a parameter: from the docstring, else from its Rust type."""
        stated = entries(doc, "Parameters").get(name)
        stated = self._usual[name] if stated == "" else stated
        return stated or self.known(kind, owner, taken=True) or "Any"

    def result(self, kind: str, doc: str, owner: str) -> str:
        """Returns the type of a result: from its Rust type, else from the docstring."""
        known = self.known(kind or "()", owner)
        if "Any" in (known or "Any"):
            known = documented("".join(section(doc, "Returns")[:1])) or known
        return known or "Any"

    def known(self, kind: str, owner: str, *, taken: bool = False) -> str:
        """Returns the Python type of a Rust type, "" if it may be any object."""
        # Without lifetimes, references and paths.
        kind = re.sub(r"'\w+(?:, )?|&(?:mut )?|\w+::", "", kind).strip()

        def of(kind: str) -> str:
            return self.known(kind, owner, taken=taken)

        if kind.startswith("(") and kind != "()":
            return f"tuple[{', '.join(of(each) or 'Any' for each in split(kind[1:-1]))}]"
        if kind.startswith("["):
            kind = f"Vec<{kind[1:-1].partition(';')[0]}>"
        name, _, inner = kind.partition("<")
        inner = next(iter(split(inner[:-1])), "")
        if name == "PyAny":
            return ""
        if name in ("Bound", "Py", "PyResult"):
            return of(inner)
        if name == "Option":
            return of(inner) and f"{of(inner)} | None"
        if name == "Vec":
            one = of(inner) or "Any"
            if inner == "u8":
                return "bytes"
            if taken:
                return "ArrayLike" if one in ("int", "float") else f"Sequence[{one}]"
            return f"list[{one}]"
        if re.match(r"(Py(Readonly|Readwrite)?)?Array[\dD]", name):
            return f"NDArray[np.{NUMBERS[inner]}]"
        if name == "Self":
            return owner
        if name == "PathBuf" and taken:
            return "str | PathLike[str]"
        if re.fullmatch(r"[iu](\d+|size)", name):
            return "int"
        if name in self._exported.classes:
            return name
        return KNOWN.get(name) or of(self._exported.aliases[name])


def section(doc: str, title: str) -> list[str]:
    """Returns the lines of a section of a docstring."""
    match = re.search(rf"^{title}\n-+\n(.*?)(?=^[^\n]*\n---|\Z)", doc, re.MULTILINE | re.DOTALL)
    return match[1].splitlines() if match else []


def entries(doc: str, title: str) -> dict[str, str]:
    """Returns the names in a section of a docstring, each with its type, "" if it states none."""
    lines = (line.partition(" : ") for line in section(doc, title) if line[:1].strip())
    return {name: documented(kind) for names, _, kind in lines for name in names.split(", ")}


def documented(kind: str) -> str:
    """Returns the type that a docstring names, such as `(N,) array_like or midair.Solution, optional`."""
    kind = kind.removesuffix(", optional")
    if kind.startswith("{"):
        return f"Literal[{kind.strip('{}')}]"
    if kind in ("(int, int)", "(float, float)"):
        return f"tuple[{kind.strip('()')}]"
    if kind.startswith("dict of str to "):
        return f"dict[str, {documented(kind.removeprefix('dict of str to '))}]"
    kinds = []
    for word, of in re.findall(r"([\w.]+)(?: of ([\w.]+))?", kind):
        if word == "ndarray":
            kinds.append(f"NDArray[np.{of}]" if of else "NDArray[Any]")
        elif word.startswith("midair."):
            kinds.append(word.removeprefix("midair."))
        elif word in WORDS:
            kinds.append(WORDS[word])
    return union(kinds)


def union(kinds: list[str]) -> str:
    """Returns the union of some types; an array may also be a number."""
    own = dict.fromkeys(kinds)
    return " | ".join(kind for kind in own if "ArrayLike" not in own or kind not in ("float", "int"))
