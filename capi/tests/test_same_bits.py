"""The library gives the same bits as the package."""

from collections.abc import Iterator
from ctypes import c_void_p

import numpy as np
import pytest

import midair
from library import METRICS, Library
from midair._midair import Codec

POINTS = np.array([[-0.02, 0.01, 0.15], [0.02, 0.0, 0.16], [0.0, -0.03, 0.15]])
PRESSURES = np.array([900.0, 700.0, 1100.0])
WEIGHTS = np.array([1.0, 2.0, 0.5])
STATUSES = ["done", "out_of_steps", "stopped", "missed"]
#: The layout of midair_link in C.
LINK = np.dtype(
    [
        ("kind", "i4"),
        ("lines", "u8"),
        ("baud", "u4"),
        ("rate", "f8"),
        *((name, "i4") for name in ("swap", "restarts", "one_chip", "modulates", "holds_sequence")),
    ],
    align=True,
)
pytestmark = pytest.mark.filterwarnings("ignore::midair.SceneWarning")


@pytest.fixture(scope="module")
def grid(library: Library) -> Iterator[c_void_p]:
    array = library.new("array_grid", 12, 10, 0.0105)
    yield array
    library.plain("array_free", array)


def same(library: Library, session: c_void_p, solver: midair.Solver, *request: np.ndarray | None) -> None:
    """Compares one request in the library and in the package."""
    names = dict(zip(("pressures", "weights"), request[1:], strict=False))
    out = np.zeros(len(solver(request[0], **names).drive), np.complex64)
    solver.reset()
    solver(request[0], **names, out=out)
    drive, answer = library.solve(session, len(out), *request)
    assert drive.tobytes() == out.tobytes()
    assert (STATUSES[answer["status"]], answer["scale"]) == (solver.status, solver.scale)
    assert answer["steps"] == solver.steps
    assert [answer[name] for name in METRICS] == [getattr(solver.metrics, name) for name in METRICS]


@pytest.mark.parametrize("method", sorted(midair.solvers()))
def test_every_method(library: Library, grid: c_void_p, method: str) -> None:
    solver = midair.Solver(midair.Array.grid(12, 10, 0.0105), method)
    for request in [(POINTS,), (POINTS, PRESSURES), (POINTS, PRESSURES, WEIGHTS), (POINTS[:1],)]:
        session = library.session(grid, method)
        same(library, session, solver, *request)
        library.plain("session_free", session)


@pytest.mark.parametrize(
    ("method", "options"),
    [
        ("greedy", {"phases": 32, "amplitudes": 4, "seed": 2**53, "objective": "l1", "order": "columns"}),
        ("uniform", {"aim": "max", "tolerance": 0.02}),
        ("fast", {"frequency": 25e3, "temperature": 31.5, "absorption": 0.1, "density": 1.1}),
        ("naive", {"source_pressure": 2.5, "directivity": "t4010a1"}),
        ("wgs", {"balance": True, "directivity": {"piston": 3e-3}}),
    ],
)
def test_options(library: Library, grid: c_void_p, method: str, options: dict[str, object]) -> None:
    solver = midair.Solver(midair.Array.grid(12, 10, 0.0105), method, **options)
    spelt: dict[str, object] = {}
    for name, value in options.items():
        if isinstance(value, dict):
            spelt |= {f"{name}.{word}": parameter for word, parameter in value.items()}
        else:
            spelt[name.upper()] = {True: "true", False: "false"}[value] if isinstance(value, bool) else value
    session = library.session(grid, method, **spelt)
    same(library, session, solver, POINTS, PRESSURES)
    library.plain("session_free", session)


@pytest.mark.parametrize("last", [{"sound_speed": 350.0}, {"temperature": 10.0}])
def test_the_last_of_sound_speed_and_temperature_counts(
    library: Library, grid: c_void_p, last: dict[str, float]
) -> None:
    first = {"sound_speed": 350.0, "temperature": 10.0}
    session = library.session(grid, "fast", **{name: first[name] for name in first.keys() - last} | last)
    same(library, session, midair.Solver(midair.Array.grid(12, 10, 0.0105), "fast", **last), POINTS, PRESSURES)
    library.plain("session_free", session)


def test_lists(library: Library) -> None:
    rng = np.random.default_rng(1)
    positions, normals = rng.normal(size=(40, 3)) * [0.05, 0.05, 0.001], rng.normal(size=(40, 3))
    array = library.new("array_new", positions, normals, 40)
    mine = midair.Array(positions, normals)
    read = [np.zeros((40, 3)), np.zeros((40, 3))]
    library.done("array_positions", array, *read, 40)
    assert read[0].tobytes() == mine.positions.tobytes()
    assert read[1].tobytes() == mine.normals.tobytes()
    assert library.plain("array_count", array) == 40
    mask, order = rng.random(40) < 0.8, rng.permutation(40)
    response = rng.normal(size=40) + 1j * rng.normal(size=40)
    session = library.new("session_new", array, "greedy")
    lists = {"mask": mask.astype(float), "order": order.astype(float), "response": response.view(float)}
    for name, values in lists.items():
        library.done("session_set_numbers", session, name, values, len(values))
    mine = midair.Array(positions, normals, mask=mask, response=response)
    same(library, session, midair.Solver(mine, "greedy", order=order), POINTS, PRESSURES)
    # The session has a copy of the array.
    library.plain("array_free", array)
    same(library, session, midair.Solver(mine, "greedy", order=order), POINTS)
    library.plain("session_free", session)


@pytest.mark.parametrize("preset", sorted(midair.presets()))
def test_presets(library: Library, preset: str) -> None:
    array = library.new("array_preset", preset, 1, 1)
    session = library.session(array, "fast")
    same(library, session, midair.Solver(midair.Array.preset(preset), "fast"), POINTS)
    library.done("session_set_text", session, "quantization", "none")
    same(library, session, midair.Solver(midair.Array.preset(preset, quantization={}), "fast"), POINTS)
    library.plain("session_free", session)
    library.plain("array_free", array)


def test_the_quantization_of_a_board(library: Library, grid: c_void_p) -> None:
    session = library.session(grid, "fast", quantization="SonicSurface")
    mine = midair.Array.grid(12, 10, 0.0105, quantization={"phases": 32, "amplitudes": [0.0, 1.0]})
    same(library, session, midair.Solver(mine, "fast"), POINTS, PRESSURES)
    library.plain("session_free", session)


def test_many_requests_of_one_session(library: Library, grid: c_void_p) -> None:
    session = library.session(grid, "glide")
    solver = midair.Solver(midair.Array.grid(12, 10, 0.0105), "glide")
    out = np.zeros(120, np.complex64)
    for step in range(20):
        points = POINTS + np.array([1e-4 * step, 0, 0])
        solver(points, out=out)
        drive, _ = library.solve(session, 120, points)
        assert drive.tobytes() == out.tobytes(), step
    library.plain("session_free", session)


def test_field_and_judge(library: Library, grid: c_void_p) -> None:
    scene = midair.Scene(midair.Array.grid(12, 10, 0.0105), POINTS, PRESSURES, weights=WEIGHTS)
    session = library.session(grid, "fast")
    drive, _ = library.solve(session, 120, POINTS, PRESSURES)
    places = np.random.default_rng(2).uniform(-0.1, 0.1, (500, 3)) + np.array([0, 0, 0.2])
    field = np.zeros(500, np.complex64)
    library.done("session_field", session, drive, 120, places, 500, field)
    assert field.tobytes() == midair.field(scene, drive, places).pressure.tobytes()
    metrics = np.zeros(6)
    library.done("session_judge", session, drive, 120, POINTS, PRESSURES, WEIGHTS, 3, metrics)
    judged = midair.judge(scene, drive, precision="double")
    assert metrics.tolist() == [getattr(judged, name) for name in METRICS]
    library.plain("session_free", session)


@pytest.mark.parametrize("name", Codec.kinds())
def test_bytes_of_boards(library: Library, name: str) -> None:
    mine = midair.Board(name)
    count = len(mine.array)
    rng = np.random.default_rng(3)
    drive = (rng.random(count) * np.exp(2j * np.pi * rng.random(count))).astype(np.complex64)
    board = library.new("board_new", name, count)
    frame = np.zeros(library.plain("board_frame_size", board), np.uint8)
    library.done("board_encode", board, drive, count, frame, len(frame))
    assert frame.tobytes() == mine.encode(drive)
    link = np.zeros(1, LINK)
    library.done("board_link", board, link)
    known = mine.link
    assert ["serial", "fifo", "udp"][link["kind"][0]] == known["kind"]
    assert link["swap"][0] == (-1 if known["swap"] is None else int(known["swap"], 16))
    assert (link["lines"][0], link["baud"][0], link["rate"][0]) == (mine.lines, mine.baud or 0, mine.rate)
    for fact in ("restarts", "one_chip", "modulates", "holds_sequence"):
        assert link[fact][0] == known[fact]
    array = library.new("array_board", name)
    positions = np.zeros((count, 3))
    library.done("array_positions", array, positions, None, count)
    assert positions.tobytes() == mine.array.positions.tobytes()
    library.plain("array_free", array)
    silence = np.zeros(library.plain("board_silence_size", board), np.uint8)
    library.done("board_silence", board, silence, len(silence))
    assert silence.tobytes() == mine.silence
    library.plain("board_free", board)


def test_boards_of_wired_arrays(library: Library, grid: c_void_p) -> None:
    levitator = library.new("array_preset", "tinylev", 1, 1)
    rows = np.repeat(np.arange(12.0), 10)
    mask = np.array([0.0] * 10 + [1.0] * 110)
    wired = library.session(grid, "uniform")
    library.done("session_set_numbers", wired, "channels", rows, 120)
    library.done("session_set_numbers", wired, "mask", mask, 120)
    mine = midair.Array.grid(12, 10, 0.0105, channels=rows.astype(int), mask=mask.astype(bool))
    scene = '[array]\npreset = "tinylev"\n[[points]]\nposition = [0, 0, 0]\n'
    for session, kind, array in (
        (library.session(levitator, "uniform"), "nano", midair.Array.preset("tinylev")),
        (library.new("session_open", scene, None), "mega64", midair.Array.preset("tinylev")),
        (wired, "nano16", mine),
    ):
        board = library.new("board_of_session", kind, session)
        library.plain("session_free", session)
        # These arrays lack the response of the boards: C corrects it in the bytes, Python in a solution.
        solution = midair.solve(midair.Scene(array, [[0, 0, 0.01]]), "uniform")
        drive, frame = solution.drive, np.zeros(library.plain("board_frame_size", board), np.uint8)
        library.done("board_encode", board, drive, len(drive), frame, len(frame))
        assert frame.tobytes() == midair.Board(kind, array).encode(solution)
        library.plain("board_free", board)
    library.plain("array_free", levitator)
    single = library.session(grid, "fast")
    _, message = library.call("board_of_session", "nano", single, np.zeros(1, np.uintp))
    assert message == "transducers is 120: nano has 1 to 8 channels"
    library.plain("session_free", single)
