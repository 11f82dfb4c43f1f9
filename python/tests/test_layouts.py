"""Array arguments: every memory layout gives the same bits; `out` is written correctly or rejected."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.lib.stride_tricks import as_strided

import midair
from scenes import same_bits
from test_refusals import refused

RNG = np.random.default_rng(1)
GRID = midair.Array.grid(5, 4, pitch=0.01)
POINTS = RNG.uniform(-0.03, 0.03, (3, 3)) + np.array([0, 0, 0.15])
PLACES = RNG.uniform(-0.03, 0.03, (4, 3, 3)) + np.array([0, 0, 0.15])
PRESSURES = np.array([250.0, 150.0, 200.0])
MANY = 1000 * PLACES[:, :, 2]
SCENE = midair.Scene(GRID, POINTS, PRESSURES)
DRIVE = np.exp(1j * RNG.uniform(0, 6, 20))
DRIVES = np.exp(1j * RNG.uniform(0, 6, (4, 20)))
MATRIX = 30 * (RNG.normal(size=(3, 20)) + 1j * RNG.normal(size=(3, 20)))
MASK = RNG.uniform(size=20) < 0.7
ORDER = RNG.permutation(20)


def matrix(**beside: Any) -> np.ndarray:
    return midair.solve(midair.Propagation(MATRIX), "greedy", **beside).drive


def batch(points: Any = PLACES, **beside: Any) -> np.ndarray:
    return midair.solve_batch(GRID, points, **beside).drives


def solver(points: Any = POINTS, solver: str = "fast", **beside: Any) -> np.ndarray:
    call = midair.Solver(GRID, solver)
    # The first call fills the solver's buffers with other values, which must not change the second call.
    call(POINTS[::-1].copy(), PRESSURES[::-1].copy(), weights=PRESSURES)
    return call(points, **beside).drive


#: For each argument that is an array: a function that passes the array and returns what midair read,
#: and an array to pass.
ARGUMENTS: dict[str, tuple[Callable[[Any], Any], np.ndarray]] = {
    "positions": (lambda a: midair.Array(a).positions, GRID.positions),
    "normals": (lambda a: midair.Array(GRID.positions[:3], a).normals, POINTS),
    "response": (lambda a: midair.Array.grid(5, 4, 0.01, response=a).response, DRIVE),
    "array mask": (lambda a: midair.Array.grid(5, 4, 0.01, mask=a).mask, MASK),
    "amplitudes": (
        lambda a: midair.Array.preset("paper20", quantization={"amplitudes": a}).quantization["amplitudes"],
        np.array([0.0, 0.25, 0.5, 1.0]),
    ),
    "points": (lambda a: midair.solve(midair.Scene(GRID, a), "fast").drive, POINTS),
    "pressures": (lambda a: midair.solve(midair.Scene(GRID, POINTS, a), "lm").drive, PRESSURES),
    "weights": (lambda a: midair.solve(midair.Scene(GRID, POINTS, weights=a), "lm").drive, PRESSURES),
    "field points": (lambda a: midair.field(SCENE, DRIVE, a).pressure, POINTS),
    "field drive": (lambda a: midair.field(SCENE, a, POINTS).pressure, DRIVE),
    "judge drive": (lambda a: np.array(midair.judge(SCENE, a).accuracy), DRIVE),
    "order": (lambda a: midair.solve(SCENE, "greedy", order=a).drive, ORDER),
    "start drive": (lambda a: midair.solve(SCENE, "gs", start=a).drive, DRIVE),
    "start phases": (lambda a: midair.solve(SCENE, "gs", start=a).drive, PRESSURES),
    "matrix": (lambda a: midair.solve(midair.Propagation(a), "fast").drive, MATRIX),
    "matrix pressures": (lambda a: matrix(pressures=a), PRESSURES),
    "matrix weights": (lambda a: matrix(weights=a), PRESSURES),
    "matrix mask": (lambda a: matrix(mask=a), MASK),
    "matrix positions": (lambda a: matrix(positions=a, order="columns"), GRID.positions),
    "judge pressures": (
        lambda a: np.array(midair.judge(midair.Propagation(MATRIX), DRIVE, pressures=a).residual),
        PRESSURES,
    ),
    "bound weights": (lambda a: np.array(midair.bound(midair.Propagation(MATRIX), weights=a)), PRESSURES),
    "Solver points": (solver, POINTS),
    "Solver pressures": (lambda a: solver(pressures=a), PRESSURES),
    "Solver weights": (lambda a: solver(solver="lm", weights=a), PRESSURES),
    "Solver start": (lambda a: solver(solver="gs", start=a), DRIVE),
    "batch points": (batch, PLACES),
    "batch pressures": (lambda a: batch(pressures=a), MANY),
    "batch weights": (lambda a: batch(solver="lm", weights=a), MANY),
    "batch drives": (lambda a: batch(solver="gs", start=a), DRIVES),
    "batch phases": (lambda a: batch(solver="gs", start=a), PLACES[:, :, 1]),
    "batch of a matrix": (
        lambda a: midair.solve_batch(midair.Propagation(MATRIX), pressures=a).drives,
        MANY,
    ),
}


def strided(array: np.ndarray) -> np.ndarray:
    wide = np.zeros([2 * size for size in array.shape], array.dtype)
    view = wide[tuple(slice(None, None, 2) for _ in array.shape)]
    view[...] = array
    return view


def misaligned(array: np.ndarray) -> np.ndarray:
    view = np.zeros(array.nbytes + 1, np.uint8)[1:].view(array.dtype).reshape(array.shape)
    view[...] = array
    return view


def field_of_records(array: np.ndarray) -> np.ndarray:
    records = np.zeros(array.shape, [("tag", "u4"), ("value", array.dtype)])
    records["value"] = array
    return records["value"]


def read_only(array: np.ndarray) -> np.ndarray:
    copy = array.copy()
    copy.flags.writeable = False
    return copy


def backwards(array: np.ndarray) -> np.ndarray:
    turned = tuple(slice(None, None, -1) for _ in array.shape)
    return array[turned].copy()[turned]


#: Functions that store the same numbers in every kind of memory layout.
LAYOUTS: dict[str, Callable[[np.ndarray], Any]] = {
    "Fortran": np.asfortranarray,
    "transposed": lambda array: array.T.copy().T,
    "strided": strided,
    "backwards": backwards,
    "big-endian": lambda array: array.astype(array.dtype.newbyteorder(">")),
    "misaligned": misaligned,
    "records": field_of_records,
    "read-only": read_only,
    "masked nowhere": np.ma.masked_array,
    "nested lists": lambda array: array.tolist(),
}


@pytest.mark.parametrize("argument", ARGUMENTS)
def test_every_layout_gives_the_same_bits(argument: str) -> None:
    call, array = ARGUMENTS[argument]
    plain = np.array(call(np.ascontiguousarray(array)))
    for layout, lay in LAYOUTS.items():
        assert same_bits(np.array(call(lay(array))), plain), layout
    hiding = np.ma.masked_array(array, mask=np.arange(array.size).reshape(array.shape) == 1)
    refused(lambda: call(hiding), f"masked in 1 of {array.size} entries")
    refused(lambda: call([hiding]), "masked in 1 of")


@pytest.mark.parametrize("layout", ["big-endian", "misaligned", "read-only", "masked nowhere"])
def test_arrays_of_no_dimensions_are_numbers(layout: str) -> None:
    def laid(number: float) -> Any:
        return LAYOUTS[layout](np.array(number))

    scene = midair.Scene(GRID, POINTS, laid(200.0), weights=laid(2.0), frequency=laid(4e4))
    assert scene == midair.Scene(GRID, POINTS, 200.0, weights=2.0, frequency=4e4)
    assert midair.Plane(laid(0.1), laid(0.2)) == midair.Plane(0.1, 0.2)
    assert same_bits(solver(pressures=laid(200.0)), solver(pressures=200.0))
    assert same_bits(batch(pressures=laid(200.0)), batch(pressures=200.0))
    assert same_bits(
        midair.solve(SCENE, "gs", tolerance=laid(0.5)).drive, midair.solve(SCENE, "gs", tolerance=0.5).drive
    )
    hidden = np.ma.masked_array(3.0, mask=True)
    refused(lambda: midair.Scene(GRID, POINTS, frequency=hidden), "frequency", "masked")
    refused(lambda: midair.Scene(GRID, POINTS, np.ma.masked), "pressures", "masked")


def test_overlapping_views_are_read() -> None:
    row = np.array([0.01, 0.02, 0.15])
    assert midair.Scene(GRID, np.broadcast_to(row, (2, 3))).points.tolist() == [row.tolist()] * 2
    windows = as_strided(np.arange(1.0, 6.0), (3, 3), (8, 8))
    assert midair.Array(windows).positions.tolist() == windows.tolist()


@pytest.mark.parametrize("argument", ARGUMENTS)
@pytest.mark.parametrize("kind", ["holding itself", "twice itself", "deep"])
def test_lists_without_end_are_refused(argument: str, kind: str) -> None:
    value: list[Any] = []
    if kind == "deep":
        for _ in range(30_000):
            value = [value]
    else:
        value.extend([value] * (1 if kind == "holding itself" else 2))
    refused(lambda: ARGUMENTS[argument][0](value))


def test_lists_without_end_are_refused_where_no_array_is_meant() -> None:
    deep: Any = 0.0
    for _ in range(30_000):
        deep = [deep]
    for call in (
        lambda: midair.solve(SCENE, deep),
        lambda: midair.solve(SCENE, "greedy", phases=deep),
        lambda: midair.solve(SCENE, aim=deep),
        lambda: midair.solve(SCENE, balance=deep),
        lambda: midair.solve(SCENE, progress=deep),
        lambda: midair.Array.preset(deep),
        lambda: midair.Array.preset("autd3", deep),
        lambda: midair.Array.grid(deep, 1, 0.01),
        lambda: midair.Array.grid(1, 1, 0.01, directivity=deep),
        lambda: midair.Array.grid(1, 1, 0.01, directivity={"piston": deep}),
        lambda: midair.Array.grid(1, 1, 0.01, quantization=deep),
        lambda: midair.Array.grid(1, 1, 0.01, quantization={"phases": deep}),
        lambda: midair.Plane(0.1, 0.1, center=deep),
        lambda: midair.Scene(GRID, POINTS, frequency=deep),
        lambda: midair.Solver(GRID, points=deep),
        lambda: midair.solve_batch(GRID, PLACES, threads=deep),
        lambda: midair.Solver(GRID)(POINTS, out=deep),
    ):
        refused(call)


#: Memory layouts of `out` that a drive (20,) can be written into.
WRITABLE = {
    "C": np.copy,
    "strided": strided,
    "backwards": backwards,
    "records": field_of_records,
    "masked nowhere": np.ma.masked_array,
}
#: Layouts of `out` that a drive cannot be written into, with the word of the message that says why.
UNWRITABLE: dict[str, tuple[str, Callable[[np.ndarray], Any]]] = {
    "misaligned": ("misaligned", misaligned),
    "big-endian": ("dtype >c8", LAYOUTS["big-endian"]),
    "read-only": ("read-only", read_only),
    "double": ("dtype complex128", lambda array: array.astype(complex)),
    "overlapping": ("overlap", lambda array: as_strided(np.zeros_like(array), array.shape, [0] * array.ndim)),
    "sliding": ("overlap", lambda array: as_strided(np.zeros_like(array), array.shape, [4] * array.ndim)),
    "masked": ("masked in", lambda array: np.ma.masked_array(array, mask=np.ones(array.shape, bool))),
    "short": ("shape", lambda array: array[..., :-1].copy()),
    "list": ("complex64", lambda array: array.tolist()),
}


def test_out_is_written_or_refused() -> None:
    call = midair.Solver(GRID, "gs")
    wanted = call(POINTS, start=DRIVE).drive
    for layout, lay in WRITABLE.items():
        out = lay(np.zeros(20, np.complex64))
        call(POINTS, start=DRIVE, out=out)
        assert same_bits(np.array(out), wanted), layout
    for layout, (word, lay) in UNWRITABLE.items():
        out = lay(np.zeros(20, np.complex64))
        refused(lambda out=out: call(POINTS, out=out), "out", word)
        assert not np.any(out), layout


def test_batch_out_is_written_or_refused() -> None:
    wanted = batch()
    out = np.zeros((4, 20), np.complex64)
    assert midair.solve_batch(GRID, PLACES, out=out).drives is out
    assert same_bits(out, wanted)
    contiguous = {layout: ("C-contiguous", LAYOUTS[layout]) for layout in ("Fortran", "strided", "backwards")}
    for layout, (word, lay) in (UNWRITABLE | contiguous).items():
        refused_out = lay(np.zeros((4, 20), np.complex64))
        refused(lambda out=refused_out: midair.solve_batch(GRID, PLACES, out=out), "out", word)
        assert not np.any(refused_out), layout


def test_out_may_lie_over_what_is_read() -> None:
    call = midair.Solver(GRID, "gs")
    wanted = call(POINTS, PRESSURES, start=DRIVE.astype(np.complex64)).drive
    out = DRIVE.astype(np.complex64)
    call(POINTS, PRESSURES, start=out, out=out)
    assert same_bits(out, wanted)
    memory = np.zeros(20, np.complex64)
    points = memory.view(np.float64)[:9].reshape(3, 3)
    points[...] = POINTS
    call(points, PRESSURES, start=DRIVE, out=memory)
    assert same_bits(memory, call(POINTS, PRESSURES, start=DRIVE).drive)
    starts = DRIVES.astype(np.complex64)
    wanted = batch(solver="gs", start=starts)
    midair.solve_batch(GRID, PLACES, solver="gs", start=starts, out=starts)
    assert same_bits(starts, wanted)
