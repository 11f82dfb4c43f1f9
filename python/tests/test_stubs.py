"""Typed overloads: they list what the core's solver table has, and a type checker rejects wrong calls."""

import ast
import inspect
import re
from pathlib import Path

import pytest
from mypy import api

import midair

ROOT = Path(__file__).parents[2]
PACKAGE = Path(midair.__file__).parent

#: Calls: a type checker must reject the lines with `# wrong` and accept all others.
CALLS = """
from typing import Any, Literal
import numpy as np
import midair

array = midair.Array.preset("paper20")
scene = midair.Scene(array, [[0, 0, 0.15]])
points = np.zeros((2, 1, 3))
midair.solve(scene, "greedy", phases=16, objective="l1", order=[1, 0], balance=True, trace=True).drive
midair.solve(scene, "sdp", lambda_=0.5, steps=None)
midair.solve(scene, phases=16)
midair.solve(midair.Propagation([[1.0]]), "lm", pressures=[1.0], seed=3)
midair.Solver(array, "fast", points=4, temperature=25.0)(np.zeros((1, 3)))
midair.solve_batch(array, points, None, "gspat", limit="full").drives
midair.solve_batch(array, points, solver="uniform", aim="max", threads=1)

def conjugate(propagation: Any, targets: Any, weights: Any, gain: float) -> Any:
    return gain * propagation[0].conj()

midair.solve(scene, conjugate, gain=0.5, balance=True).drive

def later(name: str, either: Literal["lm", "gs"], options: dict[str, Any]) -> None:
    midair.solve(scene, name, balance=True, **options)
    midair.solve(scene, either, steps=3)
    midair.Solver(array, name, **options)
    midair.solve_batch(array, points, solver=name, **options)

def own(propagation: Any, targets: Any, weights: Any, share: float = 1.0) -> Any:
    return share * propagation.conj().T @ targets

midair.solve(scene, own, share=0.5, balance=True).metrics
midair.solve(scene, "greedy", ofset=1)  # wrong: misspelt
midair.solve(scene, "greedy", phases="many")  # wrong: no number
midair.solve(scene, "gspat", limit="clmp")  # wrong: no such word
midair.solve(scene, "naive", phases=16)  # wrong: another solver's
midair.solve(scene, ofset=1)  # wrong: unknown
midair.Solver(scene, own)  # wrong: a function solves one scene at a time
midair.Solver(array, "greedy", tolerance=1.0)  # wrong: another solver's
midair.solve_batch(array, points, None, "greedy", ofset=1)  # wrong: misspelt
midair.solve_batch(array, points, solver="lm", phases=16)  # wrong: another solver's
"""


def test_the_stubs_of_keywords_are_what_the_core_declares() -> None:
    stub = ast.parse((PACKAGE / "_keywords.pyi").read_text("utf-8"))
    classes = {one.name: one.body for one in stub.body if isinstance(one, ast.ClassDef)}

    def declared(name: str) -> dict[str, tuple[str, str]]:
        """Returns the type and the meaning of each key of a class."""
        fields = zip(classes[name], classes[name][1:], strict=False)
        return {
            field.target.id.rstrip("_"): (ast.unparse(field.annotation), ast.literal_eval(about.value))
            for field, about in fields
            if isinstance(field, ast.AnnAssign) and isinstance(about, ast.Expr)
        }

    keys, parts = midair._midair.scene_keys(), midair._midair.array_parts()
    assert declared("Air") == {name: ("float | None", about) for name, (_, about) in keys["medium"].items()}
    assert [about for _, about in declared("Parts").values()] == [keys["array"][name][1] for name in parts]
    for name, info in midair.solvers().items():
        own = declared(name.title())
        assert ast.literal_eval(classes[name.title()][0].value) == f"{info.summary}."
        assert {key: about for key, (_, about) in own.items()} == {
            key: option.doc for key, option in info.options.items()
        }
        for key, option in info.options.items():
            kind = own[key][0]
            words = re.findall(r"'(\w+)'", kind)
            assert words == option.words, (name, key)
            assert kind.startswith("Literal" if words else type(option.default).__name__)
            assert ("Sequence[int]" in kind) == option.list


def test_the_stubs_of_the_extension_have_its_docstrings() -> None:
    stub = ast.parse((PACKAGE / "_midair.pyi").read_text("utf-8"))
    documented = {one.name: ast.get_docstring(one) for one in stub.body if hasattr(one, "name")}
    for name in ("Gorkov", "solvers", "Rest", "Metrics"):
        assert documented[name] == inspect.getdoc(getattr(midair._midair, name))


@pytest.mark.slow
def test_a_type_checker_knows_every_solvers_options(tmp_path: Path) -> None:
    path = tmp_path / "calls.py"
    path.write_text(CALLS, "utf-8")
    out, err, _ = api.run(["--strict", "--cache-dir", str(ROOT / ".mypy_cache"), str(path)])
    assert not err
    wrong = {number for number, line in enumerate(CALLS.splitlines(), 1) if "# wrong" in line}
    assert {int(line) for line in re.findall(r"calls\.py:(\d+): error", out)} == wrong, out


def test_an_option_tells_the_words_that_it_takes() -> None:
    array = midair.Array.grid(2, 2, 0.01)
    scene = midair.Scene(array, [[0.0, 0.0, 0.1]])
    for name, info in midair.solvers().items():
        for key, option in info.options.items():
            assert (option.default in option.words) == isinstance(option.default, str)
            for word in option.words:
                midair.solve(scene, name, **{key: word})
            if option.list:
                midair.solve(scene, name, **{key: [3, 1, 0, 2]})
