"""Invalid arguments: the message has one line and names the argument and its value."""

import sys
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
import pytest

import midair
from scenes import usable

SOLVERS = sorted(midair.solvers())
ARRAY = midair.Array.grid(4, 4, pitch=0.01)
POINT = [[0, 0, 0.1]]
NAN, INF = float("nan"), float("inf")

#: Values that are neither a real number nor a list of real numbers: of another type, or of another shape.
NO_NUMBER: Mapping[str, Any] = {
    "text": "1",
    "text with a line break": "1\n2",
    "bytes": b"1",
    "object": object(),
    "bool": True,
    "numpy bool": np.True_,
    "complex": 1j,
    "numpy complex": np.complex64(1),
    "dictionary": {"a": 1},
    "list of None": [None],
    "list of text": ["1"],
    "list of bools": [True],
    "list of complex": [1 + 0j],
    "ragged list": [[1, 2], [3]],
    "array of objects": np.array([1.0, None]),
    "array of text": np.array(["a"]),
    "date": np.array(["2020-01-01"], dtype="datetime64[D]"),
    "matrix": np.ones((2, 2)),
    "empty": [],
}
NOT_FINITE = {"NaN": NAN, "infinite": INF, "minus infinite": -INF}


#: Code and item of each error of a test.
HEARD: list[str] = []


@pytest.fixture(autouse=True)
def codes(kept: Callable[..., None]) -> Iterator[None]:
    """Compares the codes of a test's errors with refusals/: programs rely on them."""
    HEARD.clear()
    yield
    if HEARD:
        kept(*dict.fromkeys(HEARD))


def refused(call: Callable[[], object], *words: str) -> str:
    """Checks that `call` raises SceneError with a message of one line with these words,
    and returns the message.
    """
    with pytest.raises(midair.SceneError) as caught:
        call()
    text = str(caught.value)
    assert len(text.splitlines()) == 1, repr(text)
    for word in words:
        assert word in text
    HEARD.append(f"{caught.value.code} {caught.value.item}")
    return text


def scene(**arguments: Any) -> midair.Scene:
    """Returns a scene of one point above 4 x 4 transducers, unless others are given."""
    return midair.Scene(arguments.pop("array", ARRAY), arguments.pop("points", POINT), **arguments)


TWO = [[0, 0, 0.1], [0.01, 0, 0.1]]
#: Calls that read a real number (a list for `pressures` and `weights`), by the name in the error message.
REALS: dict[str, Callable[[Any], object]] = {
    **{
        item: lambda value, item=item: scene(**{item: value})
        for item in (
            "frequency", "sound_speed", "absorption", "density", "source_pressure", "temperature",
        )
    },
    "pitch": lambda value: midair.Array.grid(2, 2, value),
    "plane.size": lambda value: midair.Plane(0.1, value),
    "plane.pixels": lambda value: midair.Plane(0.1, 0.1, value),
    "plane z": lambda value: midair.Plane(value, 0.1),
    "plane center": lambda value: midair.Plane(0.1, 0.1, center=(0, value)),
}  # fmt: skip
VECTORS: dict[str, Callable[[Any], object]] = {
    "points": lambda value: scene(points=value),
    "positions": lambda value: midair.Array(value),
    "normals": lambda value: midair.Array([[0, 0, 0]], value),
    "field points": lambda value: midair.field(scene(), np.ones(16), value),
}


@pytest.mark.parametrize("bad", [*NO_NUMBER, *NOT_FINITE])
def test_what_is_no_number_is_refused_by_name(bad: str) -> None:
    value = (NO_NUMBER | NOT_FINITE)[bad]
    for item, call in REALS.items():
        refused(lambda call=call: call(value), *item.split())
    refused(lambda: midair.Plane(0.1, 0.1, center=value), "plane.center")
    if bad in NO_NUMBER:
        for item, call in VECTORS.items():
            refused(lambda call=call: call(value), item)


@pytest.mark.parametrize("item", ["frequency", "sound_speed", "absorption", "density", "source_pressure"])
def test_real_out_of_range_is_refused_by_name(item: str) -> None:
    for value in (0, -1, -1e-300):
        if (item, value) == ("absorption", 0):
            assert scene(absorption=0).absorption == 0
        else:
            refused(lambda value=value: scene(**{item: value}), item, "-" if value else "0")


def test_waves_of_no_length_are_refused() -> None:
    for item in ("frequency", "sound_speed"):
        for value in (1e-300, 1e300):
            refused(lambda item=item, value=value: scene(**{item: value}), "medium.frequency", "wavelength")


@pytest.mark.parametrize("bad", [*NO_NUMBER, *NOT_FINITE, "negative", "all 0", "too many", "too few"])
def test_pressures_and_weights_are_refused_by_name(bad: str) -> None:
    more = {"negative": [1, -1e-3], "all 0": 0, "too many": [1, 1, 1], "too few": [1]}
    values = {"NaN": [1, NAN], "infinite": [INF, 1], "minus infinite": [1, -INF]}
    value = (NO_NUMBER | more | values)[bad]
    matrix = midair.Propagation(np.ones((2, 3)))
    # Complex pressures are allowed; test_complex.py tests them.
    for item in ("weights",) if bad in ("complex", "numpy complex") else ("pressures", "weights"):
        given = {item: value}
        word = f"points[{int(bad != 'infinite')}].{item[:-1]}" if bad in [*NOT_FINITE, "negative"] else item
        refused(lambda given=given: scene(points=TWO, **given), word)
        # A matrix in place of a scene is checked in the same way.
        refused(lambda given=given: midair.solve(matrix, **given), word)
        judged = {"pressures": 1, **given}
        refused(lambda judged=judged: midair.judge(matrix, np.ones(3), **judged), word)


@pytest.mark.parametrize("mixed", [[True, 2.0], [2, False], [np.True_, 1.5]], ids=repr)
def test_bool_among_numbers_is_no_number(mixed: list) -> None:
    refused(lambda: scene(points=TWO, pressures=mixed), "pressures")
    refused(lambda: scene(points=[[0, 0, 0.1], [0.01, mixed[0], mixed[1]]]), "points")


def test_weights_that_leave_nothing_requested_are_refused() -> None:
    refused(lambda: scene(points=TWO, pressures=[0, 1], weights=[1, 0]), "pressures", "all 0")
    refused(lambda: scene(points=TWO, weights=0), "weights", "all 0")


WALL, BALL = midair.Wall([0, 0, 0.15], [0, 0, -1]), midair.Sphere([0, 0, 0.2], 0.01)
#: Scenes that physics forbids, or that are probably mistakes, by code and item.
OUT_OF_PLACE: dict[str, dict[str, Any]] = {
    "blocked points[0].position": {"points": [[0, 0, 0.2]], "obstacles": [WALL]},
    "crosses-array obstacles[0]": {"obstacles": [midair.Wall([0.01, 0, 0], [1, 0, 0])]},
    "crosses-array obstacles[1]": {"obstacles": [WALL, midair.Wall([0.01, 0, 0], [1, 0, 0])]},
    "sphere-among obstacles[1]": {"obstacles": [WALL, BALL]},
    "sphere-size obstacles[0].radius": {"obstacles": [midair.Sphere([0, 0, 1.2], 0.9)]},
    "behind points[0].position": {"points": [[0, 0, -0.1]]},
    "in-plane points[0].position": {"points": [[0.1, 0, 0]]},
    "contrary points[0].pressure": {"points": [[0, 0, 0.1], [0, 0, 0.1001]], "pressures": [1, 100]},
    "too-near points[0].position": {"points": [[0.005, 0.005, 1e-3]]},
    "too-far points[0].position": {"points": [[0, 0, 6]]},
    "too-far points[1].position": {"points": [[0, 0, 0.1], [0, 0, 1e3]]},
    "doubtful medium.frequency": {"frequency": 40},
}


@pytest.mark.filterwarnings("error::midair.SceneWarning")
@pytest.mark.parametrize("code", OUT_OF_PLACE)
def test_what_is_out_of_place_has_its_code(code: str) -> None:
    with pytest.raises((midair.SceneError, midair.SceneWarning)) as caught:
        scene(**OUT_OF_PLACE[code])
    assert f"{caught.value.code} {caught.value.item}" == code


def test_pressure_outside_every_unit_is_refused() -> None:
    for value in (1e300, 1e-300):
        refused(lambda value=value: midair.solve(scene(pressures=value)), "points[0].pressure")


NO_VECTORS: Mapping[str, Any] = {
    "None": None,
    "one point": [0, 0, 0.1],
    "pairs": [[0, 0.1]],
    "cube": np.zeros((1, 1, 3)),
    "scalar": 0.1,
}


@pytest.mark.parametrize("bad", NO_VECTORS)
def test_vectors_of_another_shape_are_refused_by_name(bad: str) -> None:
    value = NO_VECTORS[bad]
    # Normals and the points of a field are optional.
    for item in ("points", "positions") if value is None else VECTORS:
        refused(lambda item=item: VECTORS[item](value), item)


@pytest.mark.parametrize(("axis", "value"), [(0, NAN), (1, INF), (2, -INF), (2, 1e9)])
def test_vector_that_is_not_finite_or_far_away_is_named_by_its_index(axis: int, value: float) -> None:
    vectors = np.array([[0, 0, 0.1], [0.01, 0, 0.1]])
    vectors[1, axis] = value
    text = refused(lambda: scene(points=vectors), "points[1].position")
    assert str(value).lower()[:3] in text.lower()
    refused(lambda: midair.field(scene(), np.ones(16), vectors), "field points[1]")
    if not np.isfinite(value):
        refused(lambda: midair.Array(vectors), "array.positions[1]")
        refused(lambda: midair.Array(np.zeros((2, 3)), vectors), "array.normals[1]")
    else:
        # The middle between two transducers is equally far from both, so the message names the first.
        refused(lambda: scene(array=midair.Array(vectors)), "array.positions[0]")


@pytest.mark.parametrize("bad", ["text", "bool", "list of None", "too many", "scalar", "NaN", "infinite", "1e300"])
def test_response_is_refused_by_name(bad: str) -> None:
    more = {"too many": [1, 1], "scalar": 1, "NaN": [NAN], "infinite": [complex(0, INF)], "1e300": [1e300]}
    refused(lambda: midair.Array([[0, 0, 0]], response=(NO_NUMBER | more)[bad]), "response")


def test_normals_need_a_direction_and_a_transducer_each() -> None:
    refused(lambda: midair.Array(np.zeros((2, 3)), [[0, 0, 1], [0, 0, 0]]), "array.normals[1]")
    refused(lambda: midair.Array(np.zeros((2, 3)), [[0, 0, 1]]), "array.normals", "2 positions")


@pytest.mark.parametrize("bad", [0, -1, 2.0, NAN, "2", None, True, [2], 2**20 + 1, 10**30, np.True_, 1j], ids=repr)
def test_counts_are_refused_by_name(bad: object) -> None:
    for item in ("nx", "ny"):
        given = {"nx": 2, "ny": 2, "pitch": 0.01, item: bad}
        refused(lambda given=given: midair.Array.grid(**given), item)
    refused(lambda: midair.Array.preset("autd3", tiles=(1, bad)), "tiles")


def test_tiles_are_two_counts() -> None:
    for tiles in (2, (1,), (1, 2, 3), "ab", np.ones((3, 3)), object(), {1: 2}):
        refused(lambda tiles=tiles: midair.Array.preset("autd3", tiles=tiles), "tiles")


def test_array_of_a_million_and_one_transducers_is_refused_before_it_is_made() -> None:
    refused(lambda: midair.Array.grid(2**32, 2**32, pitch=0.01), "nx", "1048576")
    refused(lambda: midair.Array.preset("autd3", tiles=(2**40, 2**40)), "tiles", "1048576")
    refused(lambda: midair.Array.preset("paper20", tiles=(2, 1)), "tiles", "one piece")


def test_pitch_is_above_0() -> None:
    for pitch in (0, -0.01):
        refused(lambda pitch=pitch: midair.Array.grid(2, 2, pitch), "pitch")


DIRECTIVITIES: dict[str, list[object]] = {
    "no name": ["pistn", "Pint", "", "pi\nston"],
    "neither name nor dictionary": [4, True, object(), [], ["piston"]],
    "no such key": [{}, {"pistn": 1}, {"pis\nton": 1}, {1: 1}, {"point": 1}, {"t4010a1": 1},
                    {"piston": 1e-3, "cos": 1}],
    "no such value": [{"piston": bad} for bad in (-1, 0, NAN, None, "1", True, 4.5)]
                     + [{"cos": -0.1}, {"sinc": [1]}],
}  # fmt: skip


@pytest.mark.parametrize("kind", DIRECTIVITIES)
def test_directivity_is_refused_by_name(kind: str) -> None:
    for bad in DIRECTIVITIES[kind]:
        refused(lambda bad=bad: midair.Array([[0, 0, 0]], directivity=bad), "directivity")
        refused(lambda bad=bad: scene(directivity=bad), "directivity")


def test_unknown_names_list_the_known_ones() -> None:
    refused(lambda: midair.solve(scene(), "gredy"), "solver", '"gredy"', *SOLVERS)
    options = midair.solvers()["greedy"].options
    refused(lambda: midair.solve(scene(), "greedy", phasse=4), "greedy", '"phasse"', *options)
    refused(lambda: midair.Array.preset("autd4"), "preset", '"autd4"', *midair.Array.presets())
    patterns = ["point", "piston", "sinc", "cos", "t4010a1"]
    refused(lambda: midair.Array([[0, 0, 0]], directivity="pistn"), '"pistn"', *patterns)


@pytest.mark.parametrize("text", ["a\nb", "a\u2028b"], ids=ascii)
def test_text_with_line_breaks_is_refused_in_one_line(text: str) -> None:
    refused(lambda: midair.solve(scene(), text), "solver")
    refused(lambda: midair.solve(scene(), "greedy", **{text: 1}), "option")
    refused(lambda: midair.solve(scene(), "greedy", seed=text), "seed")
    refused(lambda: midair.solve(scene(), "greedy", objective=text), "objective")
    refused(lambda: midair.solve(scene(), "greedy", balance=text), "balance")
    refused(lambda: midair.Array.preset(text), "preset")
    refused(lambda: midair.plot(midair.field(scene(), np.ones(16)), quantity=text), "quantity")


def test_names_are_text() -> None:
    for bad in (4, True, b"greedy", np.ones((3, 3)), object()):
        refused(lambda bad=bad: midair.solve(scene(), bad), "solver")
        refused(lambda bad=bad: midair.Array.preset(bad), "preset")


OPTIONS: dict[str, list[object]] = {
    "phases": [1, 65537, 2.5, 4.0, NAN, "x", "16", True, [4], 10**30, np.True_, object(), {}, 1j],
    "amplitudes": [0, -1, 257, 1.5, "x", False, [[1]]],
    "objective": ["l3", "L22", 2, True, NAN],
    "change": [-0.1, NAN, np.inf, "x", True, [1.0]],
    "seed": [-1, 2**64, 10**30, 0.5, "x", True, NAN],
    "order": ["row", "", 3, True, [], [0] * 16, range(1, 17), range(15), range(17), [-1, *range(15)],
              [2**40, *range(15)], np.arange(16.0), [[*range(16)]], ["a"] * 16, [True] * 16],
}  # fmt: skip


@pytest.mark.parametrize("option", OPTIONS)
def test_option_of_greedy_is_refused_by_name(option: str) -> None:
    for bad in OPTIONS[option]:
        refused(lambda bad=bad: midair.solve(scene(), "greedy", **{option: bad}), option)


def test_options_at_the_ends_of_their_ranges_are_taken() -> None:
    edges = {
        "phases": [2, 65536],
        "amplitudes": [1, 256],
        "seed": [0, 2**64 - 1],
        "order": [range(16)],
        "change": [0, 1e9],
    }
    for option, values in edges.items():
        for value in values:
            assert usable(midair.solve(scene(), "greedy", **{option: value}))
    assert usable(midair.solve(scene(), "greedy", phases=np.uint8(8), order=np.arange(16, dtype=np.uint16)))


def test_keywords_that_a_solver_does_not_use_are_refused() -> None:
    for solver in ("fast", "naive"):
        for given in ({"start": np.ones(16)}, {"start": midair.solve(scene())}, {"aim": "max"}):
            refused(lambda solver=solver, given=given: midair.solve(scene(), solver, **given), *given, solver)


def test_balance_is_yes_no_or_left_out() -> None:
    for bad in (1, 0, "yes", np.ones((3, 3)), object()):
        refused(lambda bad=bad: midair.solve(scene(), balance=bad), "balance")


def test_point_on_a_transducer_names_both_and_their_distance() -> None:
    on = scene(points=[[0, 0, 0.1], [0.005, 0.005, 6e-5]])
    for call in (lambda: midair.solve(on), on.propagation, lambda: midair.judge(on, np.ones(16))):
        text = refused(call, "points[1]", "transducer 10", "8.5")
        assert "6.000e-5 m" in text
    # At slightly more than the smallest allowed distance there is only a warning.
    with pytest.warns(
        midair.SceneWarning, match="8.6e-5 m from transducer 10: nearer than a quarter of the wavelength"
    ):
        near = scene(points=[[0.005, 0.005, 8.6e-5]])
    assert usable(midair.solve(near))


@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
def test_point_that_nothing_reaches_is_named() -> None:
    for array in (
        midair.Array.grid(4, 4, pitch=0.01, directivity="piston"),
        midair.Array.grid(4, 4, pitch=0.01, directivity="t4010a1"),
    ):
        behind = scene(array=array, points=[[0, 0, 0.1], [0, 0, -0.1]])
        refused(lambda behind=behind: midair.solve(behind), "points[1]", "reached")
        quiet = scene(array=array, points=[[0, 0, 0.1], [0, 0, -0.1]], pressures=[1e3, 0])
        assert midair.solve(quiet).pressures[1] == 0
    dead = midair.Array([[0, 0, 0]], response=[0])
    refused(lambda: midair.solve(midair.Scene(dead, POINT)), "points[0]", "reached")


DRIVES: dict[str, Any] = {
    "text": "x", "bools": [True] * 16, "None": None, "objects": [None] * 16, "scalar": 1.0, "empty": [],
    "matrix": np.ones((1, 16)), "too few": np.ones(15), "too many": np.ones(17), "NaN": [NAN] * 16,
    "infinite": [INF] * 16, "above 1": np.full(16, 1 + 3e-6), "diagonal": np.full(16, 0.8 + 0.8j),
    "beyond f32": np.full(16, 1e300),
}  # fmt: skip


@pytest.mark.parametrize("bad", DRIVES)
def test_drive_is_refused_by_name(bad: str) -> None:
    # A table with a single row is an allowed drive, so the case "matrix" has two rows.
    refused(lambda: midair.judge(scene(), DRIVES[bad] if bad != "matrix" else np.ones((2, 15))), "drive")
    refused(lambda: midair.field(scene(), DRIVES[bad]), "drive")


def test_plane_out_of_range_is_refused_by_name() -> None:
    for size in (0, -0.1):
        refused(lambda size=size: midair.Plane(0.1, size), "plane.size")
    for pixels in (0, 1, -1, 2.5, 8193):
        refused(lambda pixels=pixels: midair.Plane(0.1, 0.1, pixels), "plane.pixels")
    for center in (0, (0,), (0, 0, 0), np.ones((3, 3))):
        refused(lambda center=center: midair.Plane(0.1, 0.1, center=center), "plane.center")


def test_first_argument_of_the_wrong_class_is_a_type_error() -> None:
    drive = np.ones(16)
    for bad in (None, 4, "scene.toml", POINT, np.ones((2, 2))):
        for call in (midair.solve, lambda x: midair.judge(x, drive), lambda x: midair.field(x, drive)):
            with pytest.raises(TypeError, match="Scene"):
                call(bad)
        with pytest.raises(TypeError, match="Array"):
            midair.Scene(bad, POINT)


def test_file_that_cannot_be_read_or_written_is_its_os_error(tmp_path) -> None:
    with pytest.raises(FileNotFoundError) as caught:
        midair.Scene.load(tmp_path / "none.toml")
    assert str(caught.value.filename) == str(tmp_path / "none.toml")
    is_folder = PermissionError if sys.platform == "win32" else IsADirectoryError
    with pytest.raises(is_folder):
        midair.Scene.load(tmp_path)
    with pytest.raises(FileNotFoundError):
        scene().save(tmp_path / "none" / "scene.toml")
    with pytest.raises(is_folder):
        scene().save(tmp_path)
    with pytest.raises(TypeError, match="path"):
        midair.Scene.load(4)
    assert list(tmp_path.parent.glob("*.part")) == list(tmp_path.iterdir()) == []
