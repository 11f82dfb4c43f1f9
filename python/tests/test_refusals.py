"""Input that cannot be meant is refused, in one line that names it and its value."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest

import midair
from scenes import usable

SOLVERS = sorted(midair.solvers())
ARRAY = midair.Array.grid(4, 4, pitch=0.01)
POINT = [[0, 0, 0.1]]
NAN, INF = float("nan"), float("inf")

#: What is no real number, by name: of another kind, or of another shape than a scalar or a list has.
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


def refused(call: Callable[[], object], *words: str) -> str:
    """The one line that `call` is refused with; it has these words."""
    with pytest.raises(midair.SceneError) as caught:
        call()
    text = str(caught.value)
    assert len(text.splitlines()) == 1, repr(text)
    for word in words:
        assert word in text
    return text


def scene(**arguments: Any) -> midair.Scene:
    """A scene of one point above 4 x 4 transducers, unless told otherwise."""
    return midair.Scene(arguments.pop("array", ARRAY), arguments.pop("points", POINT), **arguments)


@pytest.mark.parametrize("bad", [*NO_NUMBER, *NOT_FINITE])
@pytest.mark.parametrize(
    "item", ["frequency", "sound_speed", "absorption", "density", "source_pressure", "temperature"]
)
def test_real_of_a_scene_is_refused_by_name(item: str, bad: str) -> None:
    refused(lambda: scene(**{item: (NO_NUMBER | NOT_FINITE)[bad]}), item)


@pytest.mark.parametrize("item", ["frequency", "sound_speed", "absorption", "density", "source_pressure"])
@pytest.mark.parametrize("value", [0, -1, -1e-300])
def test_real_out_of_range_is_refused_by_name(item: str, value: float) -> None:
    if (item, value) == ("absorption", 0):
        assert scene(absorption=0).absorption == 0
    else:
        refused(lambda: scene(**{item: value}), item, "-" if value else "0")


@pytest.mark.parametrize("value", [1e-300, 1e300])
@pytest.mark.parametrize("item", ["frequency", "sound_speed"])
def test_waves_of_no_length_are_refused(item: str, value: float) -> None:
    refused(lambda: scene(**{item: value}), "medium.frequency", "wavelength")


@pytest.mark.parametrize("item", ["pressures", "weights"])
@pytest.mark.parametrize("bad", [*NO_NUMBER, *NOT_FINITE, "negative", "all 0", "too many", "too few"])
def test_pressures_and_weights_are_refused_by_name(item: str, bad: str) -> None:
    more = {"negative": [1, -1e-3], "all 0": 0, "too many": [1, 1, 1], "too few": [1]}
    values = {"NaN": [1, NAN], "infinite": [INF, 1], "minus infinite": [1, -INF]}
    value = (NO_NUMBER | more | values)[bad]
    two = [[0, 0, 0.1], [0.01, 0, 0.1]]
    word = f"points[{int(bad != 'infinite')}].{item[:-1]}" if bad in [*NOT_FINITE, "negative"] else item
    refused(lambda: scene(points=two, **{item: value}), word)
    # And the same where they go with propagation.
    refused(lambda: midair.solve(midair.Propagation(np.ones((2, 3))), **{item: value}), word)
    judged = {"pressures": 1, item: value}
    refused(lambda: midair.judge(midair.Propagation(np.ones((2, 3))), np.ones(3), **judged), word)


@pytest.mark.parametrize("mixed", [[True, 2.0], [2, False], [np.True_, 1.5]], ids=repr)
def test_bool_among_numbers_is_no_number(mixed: list) -> None:
    two = [[0, 0, 0.1], [0.01, 0, 0.1]]
    refused(lambda: scene(points=two, pressures=mixed), "pressures")
    refused(lambda: scene(points=[[0, 0, 0.1], [0.01, mixed[0], mixed[1]]]), "points")


def test_weights_that_leave_nothing_asked_for_are_refused() -> None:
    two = [[0, 0, 0.1], [0.01, 0, 0.1]]
    refused(lambda: scene(points=two, pressures=[0, 1], weights=[1, 0]), "pressures", "all 0")


def test_pressure_outside_every_unit_is_refused() -> None:
    for value in (1e300, 1e-300):
        refused(lambda value=value: midair.solve(scene(pressures=value)), "points[0].pressure")


@pytest.mark.parametrize("bad", [*NO_NUMBER, "None", "one point", "pairs", "cube", "scalar"])
@pytest.mark.parametrize("item", ["points", "positions", "normals", "field points"])
def test_vectors_are_refused_by_name(item: str, bad: str) -> None:
    shapes = {
        "None": None,
        "one point": [0, 0, 0.1],
        "pairs": [[0, 0.1]],
        "cube": np.zeros((1, 1, 3)),
        "scalar": 0.1,
    }
    value = (NO_NUMBER | shapes)[bad]
    if value is None and item in {"normals", "field points"}:
        return  # Left out.
    calls: dict[str, Callable[[], object]] = {
        "points": lambda: scene(points=value),
        "positions": lambda: midair.Array(value),
        "normals": lambda: midair.Array([[0, 0, 0]], value),
        "field points": lambda: midair.field(scene(), np.ones(16), value),
    }
    refused(calls[item], item)


@pytest.mark.parametrize("value", [NAN, INF, -INF, 1e9])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_vector_that_is_not_finite_or_far_away_is_named_by_its_index(value: float, axis: int) -> None:
    vectors = np.array([[0, 0, 0.1], [0.01, 0, 0.1]])
    vectors[1, axis] = value
    text = refused(lambda: scene(points=vectors), "points[1].position")
    assert str(value).lower()[:3] in text.lower()
    refused(lambda: midair.field(scene(), np.ones(16), vectors), "field points[1]")
    if not np.isfinite(value):
        refused(lambda: midair.Array(vectors), "array.positions[1]")
        refused(lambda: midair.Array(np.zeros((2, 3)), vectors), "array.normals[1]")
    else:
        # The middle of two transducers is as far from either, so the first is named.
        refused(lambda: scene(array=midair.Array(vectors)), "array.positions[0]")


@pytest.mark.parametrize(
    "bad", ["text", "bool", "list of None", "too many", "scalar", "NaN", "infinite", "1e300"]
)
def test_response_is_refused_by_name(bad: str) -> None:
    more = {"too many": [1, 1], "scalar": 1, "NaN": [NAN], "infinite": [complex(0, INF)], "1e300": [1e300]}
    refused(lambda: midair.Array([[0, 0, 0]], response=(NO_NUMBER | more)[bad]), "response")


def test_normals_need_a_direction_and_a_transducer_each() -> None:
    refused(lambda: midair.Array(np.zeros((2, 3)), [[0, 0, 1], [0, 0, 0]]), "array.normals[1]")
    refused(lambda: midair.Array(np.zeros((2, 3)), [[0, 0, 1]]), "array.normals", "2 positions")


@pytest.mark.parametrize("bad", [0, -1, 2.0, 2.5, NAN, "2", None, True, [2], 2**20 + 1, 10**30, np.True_, 1j])
@pytest.mark.parametrize("item", ["nx", "ny", "tiles"])
def test_counts_are_refused_by_name(item: str, bad: object) -> None:
    if item == "tiles":
        refused(lambda: midair.Array.preset("autd3", tiles=(1, bad)), "tiles")
    else:
        refused(lambda: midair.Array.grid(**{"nx": 2, "ny": 2, "pitch": 0.01, item: bad}), item)


@pytest.mark.parametrize("tiles", [2, (1,), (1, 2, 3), "ab", np.ones((3, 3)), object(), {1: 2}], ids=repr)
def test_tiles_are_two_counts(tiles: object) -> None:
    refused(lambda: midair.Array.preset("autd3", tiles=tiles), "tiles")


def test_array_of_a_million_and_one_transducers_is_refused_before_it_is_made() -> None:
    refused(lambda: midair.Array.grid(2**32, 2**32, pitch=0.01), "nx", "1048576")
    refused(lambda: midair.Array.preset("autd3", tiles=(2**40, 2**40)), "tiles", "1048576")
    refused(lambda: midair.Array.preset("paper20", tiles=(2, 1)), "tiles", "one piece")


@pytest.mark.parametrize("bad", [*NO_NUMBER, *NOT_FINITE, "zero", "negative"])
def test_pitch_is_refused_by_name(bad: str) -> None:
    values = NO_NUMBER | NOT_FINITE | {"zero": 0, "negative": -0.01}
    refused(lambda: midair.Array.grid(2, 2, values[bad]), "pitch")


@pytest.mark.parametrize(
    "bad",
    [
        "pistn", "Point", "", "pi\nston", 4, True, object(), [], {}, ["piston"],
        {"piston": -1}, {"piston": 0}, {"piston": NAN}, {"piston": None}, {"piston": "1"}, {"piston": True},
        {"piston": 4.5}, {"pistn": 1}, {"pis\nton": 1}, {1: 1}, {"point": 1}, {"t4010a1": 1}, {"cos": -0.1},
        {"sinc": [1]}, {"piston": 1e-3, "cos": 1},
    ],
    ids=repr,
)  # fmt: skip
def test_directivity_is_refused_by_name(bad: object) -> None:
    refused(lambda: midair.Array([[0, 0, 0]], directivity=bad), "directivity")
    refused(lambda: scene(directivity=bad), "directivity")


def test_unknown_names_list_the_known_ones() -> None:
    refused(lambda: midair.solve(scene(), "gredy"), "solver", '"gredy"', *SOLVERS)
    options = midair.solvers()["greedy"].options
    refused(lambda: midair.solve(scene(), "greedy", phasse=4), "greedy", '"phasse"', *options)
    refused(lambda: midair.Array.preset("autd4"), "preset", '"autd4"', *midair.Array.presets())
    patterns = ["point", "piston", "sinc", "cos", "t4010a1"]
    refused(lambda: midair.Array([[0, 0, 0]], directivity="pistn"), '"pistn"', *patterns)


@pytest.mark.parametrize("text", ["a\nb", "a\r\nb", "a\u2028b"], ids=ascii)
def test_text_with_line_breaks_is_refused_in_one_line(text: str) -> None:
    refused(lambda: midair.solve(scene(), text), "solver")
    refused(lambda: midair.solve(scene(), "greedy", **{text: 1}), "option")
    refused(lambda: midair.solve(scene(), "greedy", seed=text), "seed")
    refused(lambda: midair.solve(scene(), "greedy", objective=text), "objective")
    refused(lambda: midair.solve(scene(), "greedy", balance=text), "balance")
    refused(lambda: midair.Array.preset(text), "preset")
    refused(lambda: midair.plot(midair.field(scene(), np.ones(16)), quantity=text), "quantity")


@pytest.mark.parametrize("bad", [4, True, b"greedy", np.ones((3, 3)), object()], ids=repr)
def test_names_are_text(bad: object) -> None:
    refused(lambda: midair.solve(scene(), bad), "solver")
    refused(lambda: midair.Array.preset(bad), "preset")


OPTIONS: dict[str, list[object]] = {
    "phases": [1, 0, -4, 65537, 2.5, 4.0, NAN, "x", "16", True, [4], 10**30, np.True_, object(), {}, 1j],
    "amplitudes": [0, -1, 257, 1.5, "x", False, [[1]]],
    "objective": ["l3", "L2", 2, True, NAN],
    "seed": [-1, 2**64, 10**30, 0.5, "x", True, NAN],
    "order": ["row", "", 3, True, [], [0] * 16, range(1, 17), range(15), range(17), [-1, *range(15)],
              [2**40, *range(15)], np.arange(16.0), [[*range(16)]], ["a"] * 16, [True] * 16],
}  # fmt: skip


@pytest.mark.parametrize(
    ("option", "bad"), [(option, bad) for option, values in OPTIONS.items() for bad in values], ids=repr
)
def test_option_of_greedy_is_refused_by_name(option: str, bad: object) -> None:
    refused(lambda: midair.solve(scene(), "greedy", **{option: bad}), option)


def test_options_at_the_ends_of_their_ranges_are_taken() -> None:
    edges = {"phases": [2, 65536], "amplitudes": [1, 256], "seed": [0, 2**64 - 1], "order": [range(16)]}
    for option, values in edges.items():
        for value in values:
            assert usable(midair.solve(scene(), "greedy", **{option: value}))
    assert usable(midair.solve(scene(), "greedy", phases=np.uint8(8), order=np.arange(16, dtype=np.uint16)))


def test_columns_are_refused_for_gains() -> None:
    refused(
        lambda: midair.solve(midair.Propagation(np.ones((1, 4))), "greedy", order="columns"), "order", "columns"
    )


@pytest.mark.parametrize("solver", [name for name in SOLVERS if name in {"greedy", "naive"}])
def test_keywords_that_a_solver_does_not_use_are_refused(solver: str) -> None:
    refused(lambda: midair.solve(scene(), solver, start=np.ones(16)), "start", solver)
    refused(lambda: midair.solve(scene(), solver, start=midair.solve(scene())), "start", solver)
    refused(lambda: midair.solve(scene(), solver, aim="max"), "aim", solver)


@pytest.mark.parametrize("bad", [1, 0, "yes", np.ones((3, 3)), object()], ids=repr)
def test_balance_is_yes_no_or_left_out(bad: object) -> None:
    refused(lambda: midair.solve(scene(), balance=bad), "balance")


def test_requests_beside_a_scene_are_refused() -> None:
    for item in ("pressures", "weights"):
        refused(lambda item=item: midair.solve(scene(), **{item: 1}), item, "Scene")
        refused(lambda item=item: midair.judge(scene(), np.ones(16), **{item: 1}), item, "Scene")


def test_point_on_a_transducer_names_both_and_their_distance() -> None:
    on = scene(points=[[0, 0, 0.1], [0.005, 0.005, 6e-5]])
    for call in (lambda: midair.solve(on), on.propagation, lambda: midair.judge(on, np.ones(16))):
        text = refused(call, "points[1]", "transducer 10", "8.5")
        assert "6.000e-5 m" in text
    # The first distance that is not too near.
    assert usable(midair.solve(scene(points=[[0.005, 0.005, 8.6e-5]])))


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
    refused(lambda: midair.judge(scene(), DRIVES[bad]), "drive")
    refused(lambda: midair.field(scene(), DRIVES[bad]), "drive")


NO_MATRIX = ["x", None, object(), True, [[True]], [["1"]], [[None]], [1, 2], 1.0, [], [[]], [[], []], [[[1]]]]


@pytest.mark.parametrize("bad", NO_MATRIX, ids=repr)
def test_gains_are_a_matrix_of_numbers(bad: object) -> None:
    refused(lambda: midair.Propagation(bad), "propagation")


@pytest.mark.parametrize("bad", [NAN, INF, complex(0, NAN), complex(1, -INF)])
def test_entry_of_gains_that_is_not_finite_is_named_by_row_and_column(bad: complex) -> None:
    matrix = np.ones((3, 5), dtype=complex)
    matrix[2, 1] = bad
    refused(lambda: midair.Propagation(matrix), "propagation[2, 1]")


@pytest.mark.parametrize("bad", [*NO_NUMBER, *NOT_FINITE])
def test_plane_is_refused_by_name(bad: str) -> None:
    value = (NO_NUMBER | NOT_FINITE)[bad]
    refused(lambda: midair.Plane(value, 0.1), "plane", "z")
    refused(lambda: midair.Plane(0.1, value), "plane.size")
    refused(lambda: midair.Plane(0.1, 0.1, value), "plane.pixels")
    refused(lambda: midair.Plane(0.1, 0.1, center=(0, value)), "plane", "center")
    refused(lambda: midair.Plane(0.1, 0.1, center=value), "plane", "center")


def test_plane_out_of_range_is_refused_by_name() -> None:
    for size in (0, -0.1):
        refused(lambda size=size: midair.Plane(0.1, size), "plane.size")
    for pixels in (0, 1, -1, 2.5, 8193):
        refused(lambda pixels=pixels: midair.Plane(0.1, 0.1, pixels), "plane.pixels")
    for center in (0, (0,), (0, 0, 0), np.ones((3, 3))):
        refused(lambda center=center: midair.Plane(0.1, 0.1, center=center), "plane.center")


@pytest.mark.parametrize("bad", [None, 4, "scene.toml", POINT, np.ones((2, 2))], ids=repr)
def test_first_argument_of_the_wrong_class_is_a_type_error(bad: object) -> None:
    drive = np.ones(16)
    for call in (midair.solve, lambda x: midair.judge(x, drive), lambda x: midair.field(x, drive)):
        with pytest.raises(TypeError, match="Scene"):
            call(bad)
    with pytest.raises(TypeError, match="Array"):
        midair.Scene(bad, POINT)


def test_field_of_gains_is_a_type_error() -> None:
    with pytest.raises(TypeError, match="Scene"):
        midair.field(midair.Propagation(np.ones((1, 2))), [1, 1])


def test_file_that_cannot_be_read_or_written_is_its_os_error(tmp_path) -> None:
    with pytest.raises(FileNotFoundError) as caught:
        midair.Scene.load(tmp_path / "none.toml")
    assert str(caught.value.filename) == str(tmp_path / "none.toml")
    with pytest.raises(IsADirectoryError):
        midair.Scene.load(tmp_path)
    with pytest.raises(FileNotFoundError):
        scene().save(tmp_path / "none" / "scene.toml")
    with pytest.raises(IsADirectoryError):
        scene().save(tmp_path)
    with pytest.raises(TypeError, match="path"):
        midair.Scene.load(4)
    assert list(tmp_path.parent.glob("*.part")) == list(tmp_path.iterdir()) == []
