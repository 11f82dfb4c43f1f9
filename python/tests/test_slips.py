"""Misspelled keywords: every public callable names the unknown keyword and suggests the nearest known one."""

import inspect
import pickle
from collections.abc import Callable, Iterator
from types import FunctionType, MethodDescriptorType, ModuleType
from typing import Any

import numpy as np
import pytest

import midair

ARRAY = midair.Array.grid(8, 8, 0.01)
SCENE = midair.Scene(ARRAY, [[0, 0, 0.1]])


def walked(module: ModuleType) -> Iterator[tuple[str, Callable[..., Any]]]:
    """Yields the public callables of a module by name."""
    for key in module.__all__:
        value, name = getattr(module, key), f"{module.__name__}.{key}"
        if isinstance(value, ModuleType):
            yield from walked(value)
        elif isinstance(value, type):
            for method in [*vars(value)]:
                getattr(value, method)  # loads a lazy method, which is a plain function afterwards
            own = {**vars(value)}
            if "_new" in own or isinstance(own.get("__init__"), FunctionType):
                yield name, value
            for method, function in own.items():
                kinds = FunctionType | MethodDescriptorType | staticmethod | classmethod
                if not method.startswith("_") and isinstance(function, kinds):
                    yield f"{name}.{method}", getattr(value, method)
        elif callable(value):
            yield name, value


CALLABLES = dict(walked(midair))


def test_the_walk_finds_functions_classes_and_methods() -> None:
    assert len(CALLABLES) > 120
    assert {
        "midair.solve",
        "midair.path.circle",
        "midair.Scene",
        "midair.Ear",
        "midair.Array.from_file",
        "midair.Solution.gorkov",
        "midair.path.Path.then",
        "midair.shape.text",
    } <= set(CALLABLES)


@pytest.mark.parametrize("name", CALLABLES)
def test_a_slipped_keyword_is_named_with_what_was_meant(name: str) -> None:
    parameters = inspect.signature(CALLABLES[name]).parameters.values()
    known = [each.name for each in parameters if each.kind in (each.POSITIONAL_OR_KEYWORD, each.KEYWORD_ONLY)]
    known = [each for each in known if each != "self" and not each.startswith("_")]
    if not known:
        with pytest.raises(TypeError) as refusal:
            CALLABLES[name](nosuch=1)
        assert str(refusal.value) == f'{name} takes no keywords: leave "nosuch" out'
        return
    for meant in known:
        with pytest.raises(TypeError) as refusal:
            CALLABLES[name](**{meant + "q": 1})
        reported = str(refusal.value)
        assert reported.startswith(f'unknown argument of {name} "{meant}q": did you mean '), reported
        assert reported.endswith(f"known are {', '.join(known)}")
        # For names as short as `x` and `y`, and for `bead` beside `beads`, another one is equally near.
        near = len(meant) < 3 or f"{meant}s" in known
        assert f"did you mean {meant}? " in reported or near, reported


SLIPS = {
    "solve(SCENE, method='greedy')": 'option of uniform "method": did you mean solver?',
    "Solver(SCENE, method='greedy')": 'option of uniform "method": did you mean solver?',
    "Solver(SCENE)([[0, 0, 0.1]], starts=1)": 'argument of midair.Solver "starts": did you mean start?',
    "solve(SCENE, iterations=4)": 'option of uniform "iterations": did you mean steps?',
    "sequence(ARRAY, [], rates=4)": 'argument of midair.sequence "rates": did you mean rate?',
    "solve(SCENE).play('null', secnds=1)": 'argument of midair.connect "secnds": did you mean seconds?',
    "Scene(ARRAY, [], pressure=5)": 'argument of midair.Scene "pressure": did you mean pressures?',
    "path.circle([0, 0, 1], 1, freq=3)": 'argument of midair.path.circle "freq": did you mean frequency?',
    "image('x', px=3)": 'argument of midair.image "px": did you mean pixels?',
    "SCENE.replace(pressure=5)": 'part of a scene "pressure": did you mean pressures?',
    "solve(SCENE, temprature=3)": 'option of uniform "temprature": did you mean temperature of a midair.Sc',
    "Solver(ARRAY, 'fast', temprature=30)": 'option of fast "temprature": did you mean temperature?',
    "sweep({'scene': SCENE})": 'key of sweep "scene": did you mean scenes?',
    "solve(SCENE, 'greedy', stepz=4)": 'option of greedy "stepz": known are ',
}


@pytest.mark.parametrize("call", SLIPS)
def test_slips_of_users(call: str) -> None:
    with pytest.raises((TypeError, midair.SceneError)) as refusal:
        eval(call, {**vars(midair), "SCENE": SCENE, "ARRAY": ARRAY})
    assert str(refusal.value).startswith(f"unknown {SLIPS[call]}")
    assert "\n" not in str(refusal.value)


def test_a_name_of_a_board_leads_to_its_array() -> None:
    with pytest.raises(AttributeError, match=r'no attribute .AUTD3.: give midair.Array.preset\("autd3"\)'):
        midair.AUTD3  # noqa: B018


@pytest.mark.parametrize("keyword", ["radius", "density", "sound_speed", "gravity"])
@pytest.mark.parametrize(
    "call",
    [
        "midair.gorkov(SCENE, DRIVE",
        "midair.rest(SCENE, DRIVE",
        "midair.solve(SCENE).gorkov(",
        "midair.solve(SCENE).rest(",
        "midair.fly(None",
        "midair.path.fastest(POINTS, SCENE",
        "midair.grad.gorkov(SCENE, DRIVE",
        "midair.grad.force(SCENE, DRIVE",
        "midair.grad.stiffness(SCENE, DRIVE",
    ],
)
def test_a_parameter_of_a_bead_is_named_as_one(call: str, keyword: str) -> None:
    names = {"midair": midair, "SCENE": SCENE, "DRIVE": np.ones(SCENE.array.positions.shape[0]), "POINTS": []}
    with pytest.raises(TypeError, match=f'takes "{keyword}" as a part of bead: give bead=') as refusal:
        eval(f"{call}{'' if call.endswith('(') else ', '}{keyword}=1e-3)", names)
    assert "\n" not in str(refusal.value)


def test_other_errors_stay_as_they_are() -> None:
    def mine(*_: object) -> None:
        raise TypeError("mine")

    with pytest.raises(TypeError, match=r"^mine$"):
        midair.solve(SCENE, "greedy", phases=4, progress=mine)
    with pytest.raises(TypeError, match=r"^midair\.Scene: missing a required argument: 'points'$"):
        midair.Scene(ARRAY)
    with pytest.raises(TypeError, match=r"not Array: midair\.Scene\(array, points\) makes one"):
        midair.field(ARRAY, np.ones(64))
    with pytest.raises(midair.SceneError, match="did you mean sonicsurface"):
        midair.connect("sonic-surface")


def test_functions_stay_what_they_were() -> None:
    assert pickle.loads(pickle.dumps(midair.solve)) is midair.solve
    assert pickle.loads(pickle.dumps(midair.path.circle)) is midair.path.circle
    assert list(inspect.signature(midair.Wall).parameters) == ["point", "normal", "kind"]
    assert str(inspect.signature(midair.shape.circle)).startswith("(center")
    assert (midair.solve.__name__, midair.solve.__doc__[:5]) == ("solve", "Find ")


def test_a_warning_points_at_the_line_of_the_caller() -> None:
    with pytest.warns(midair.SceneWarning, match="array.positions is 30 m wide: give m") as warned:
        wide = midair.Array.grid(4, 4, pitch=10)
    with pytest.warns(midair.SceneWarning, match="array.grid.pitch is 10 m") as again:
        midair.Scene(wide, [[0, 0, 0.15]])
    assert {warned[0].filename, again[0].filename} == {__file__}
