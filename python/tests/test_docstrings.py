"""Docstrings of public names: numpydoc sections that agree with the signatures, and examples that run."""

import dataclasses
import doctest
import inspect
import re
from collections.abc import Callable, Iterator
from types import ModuleType

import docstring_parser
import pytest

import midair
from midair._support.slips import DECLARED

#: The sections of numpydoc, in its order.
SECTIONS = [
    "Parameters",
    "Attributes",
    "Returns",
    "Yields",
    "Raises",
    "Warns",
    "See Also",
    "Notes",
    "Examples",
]

#: Names without a section Raises: functions that never raise, and classes that only midair makes.
REFUSE_NOTHING = {"Sequence.each_change", "grad.Gradient", "Connection", "View"}

#: Compiled functions that return nothing; compiled functions have no annotations.
RETURN_NOTHING = {"Scene.save", "Solver.restore"}

#: Functions and classes that show a page in a notebook: their examples need a build with the page.
SHOWN = {"view", "View"}

#: Names whose examples need an extra.
EXTRAS = {"torch": "torch", "jax": "jax"}


def public() -> dict[str, object]:
    """Returns all public names with their objects;
    names in public modules have the module's name in front.
    """
    things = {name: getattr(midair, name) for name in midair.__all__}
    for key, module in list(things.items()):
        if isinstance(module, ModuleType):
            things |= {f"{key}.{name}": getattr(module, name) for name in module.__all__}
    return {name: thing for name, thing in things.items() if not isinstance(thing, int | float)}


def members(owner: type) -> dict[str, object]:
    """Returns the public attributes of a class, its own and those inherited within the package."""
    bases = [base for base in owner.__mro__ if base.__module__.startswith("midair")]
    keys = [key for base in bases for key in vars(base) if not key.startswith("_")]
    fields = {field.name for field in dataclasses.fields(owner)} if dataclasses.is_dataclass(owner) else set()
    named = getattr(owner, "_fields", ())
    return {key: getattr(owner, key) for key in keys if key not in fields and key not in named}


def callables() -> Iterator[tuple[str, Callable[..., object]]]:
    """Yields every public function, method and class that takes arguments, without dataclasses and errors."""
    for name, thing in public().items():
        found = {name: thing}
        if isinstance(thing, type):
            made = not dataclasses.is_dataclass(thing) and not issubclass(thing, Exception)
            found = {f"{name}.{key}": member for key, member in members(thing).items()}
            found |= {name: thing} if made or name == "Dataset" else {}
        for key, one in found.items():
            if callable(one) and set(inspect.signature(one).parameters) - {"self"}:
                yield key, one


def sections(thing: object) -> dict[str, str]:
    """Returns the sections of a docstring by title; the summary has the title ""."""
    text = inspect.cleandoc(getattr(thing, "__doc__", None) or "")
    parts = re.split(r"^([A-Z][A-Za-z ]+)\n-{3,}\n", text, flags=re.MULTILINE)
    return {"": parts[0], **dict(zip(parts[1::2], parts[2::2], strict=True))}


def entries(thing: object) -> list[str]:
    """Returns the names of a docstring's parameters, one by one."""
    parsed = docstring_parser.parse(thing.__doc__ or "", style=docstring_parser.DocstringStyle.NUMPYDOC)
    listed = [one for one in parsed.params if one.args[0] == "param"]
    return [name for one in listed for name in one.arg_name.split(", ")]


CALLABLES = dict(callables())


@pytest.mark.parametrize("name", public())
def test_every_public_name_has_a_numpydoc_docstring(name: str) -> None:
    found = sections(public()[name])
    first, _, rest = found[""].partition("\n")
    assert re.match(r"[A-Z].*[.:]$", first), f"{first}: a summary of one line"
    assert not rest or rest.startswith("\n"), "an empty line after the summary"
    titles = [title for title in found if title]
    assert titles == sorted(titles, key=SECTIONS.index), "numpydoc's order"
    assert ">>> " in found["Examples"]
    skipped = "+SKIP" in found["Examples"]
    assert skipped == (name in SHOWN)


def test_every_member_has_a_docstring() -> None:
    for name, thing in public().items():
        for key, value in members(thing).items() if isinstance(thing, type) else ():
            first = (getattr(value, "__doc__", None) or "").partition("\n")[0]
            assert re.search(r"\S.*[.:;]$", first) or not callable(value), f"{name}.{key}: {first}"
            # None has no docstring of its own: the class explains such an attribute.
            assert first or value is None, f"{name}.{key}"


@pytest.mark.parametrize("name", CALLABLES)
def test_parameters_are_those_of_the_signature(name: str) -> None:
    thing = CALLABLES[name]
    stars = {inspect.Parameter.VAR_KEYWORD: "**", inspect.Parameter.VAR_POSITIONAL: "*"}
    taken = [f"{stars.get(one.kind, '')}{key}" for key, one in inspect.signature(thing).parameters.items()]
    given = entries(thing)
    if given and given[-1].removeprefix("**") in DECLARED:
        given = [*given[:-1], *DECLARED[given[-1].removeprefix("**")]]
    if name not in {"Connection", "View", "grad.Gradient"}:
        assert given == [one for one in taken if one != "self" and not one.startswith("_")]


@pytest.mark.parametrize("name", CALLABLES)
def test_what_a_call_returns_and_raises_is_described(name: str) -> None:
    thing, found = CALLABLES[name], sections(CALLABLES[name])
    assert ("Raises" in found) == (name not in REFUSE_NOTHING)
    nothing = inspect.signature(thing).return_annotation in (None, "None") or name in RETURN_NOTHING
    if not isinstance(thing, type):
        assert ("Returns" in found or "Yields" in found) == (not nothing)


def test_every_field_of_what_is_handed_out_is_described() -> None:
    for name, thing in public().items():
        own = [field.name for field in dataclasses.fields(thing)] if dataclasses.is_dataclass(thing) else []
        own += getattr(thing, "_fields", ())
        listed = re.findall(r"^(\w+(?:, \w+)*) :", sections(thing).get("Attributes", ""), re.MULTILINE)
        described = {one for entry in listed for one in entry.split(", ")}
        assert {one for one in own if not one.startswith("_")} <= described, name


@pytest.mark.slow
@pytest.mark.parametrize("name", public())
def test_examples_run(name: str) -> None:
    import matplotlib as mpl

    mpl.use("Agg")
    if extra := EXTRAS.get(name.partition(".")[0]):
        pytest.importorskip(extra)
    things = [public()[name]]
    things += members(things[0]).values() if isinstance(things[0], type) else []
    runner = doctest.DocTestRunner()
    for thing in things:
        text = inspect.cleandoc(getattr(thing, "__doc__", None) or "")
        example = doctest.DocTestParser().get_doctest(text, {}, name, None, 0)
        runner.run(example, clear_globs=False)
    assert runner.failures == 0
    assert runner.tries > 1
