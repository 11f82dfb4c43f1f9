"""What cannot be meant: a result, and one line that names the item, its value and the cure."""

import threading
from collections.abc import Callable, Iterator
from ctypes import c_void_p
from types import SimpleNamespace

import numpy as np
import pytest

import midair
from library import ANSWER, Library

INVALID, MEMORY = 1, 2
POINT = np.array([[0.0, 0.0, 0.15]])
NAN = float("nan")


@pytest.fixture(scope="module")
def have(library: Library) -> Iterator[SimpleNamespace]:
    """One handle of each kind, and buffers that fit."""
    array = library.new("array_grid", 8, 8, 0.0105)
    session, board = library.session(array, "greedy"), library.new("board_new", "mega64", 64)
    buffers = {"drive": np.zeros(64, np.complex64), "place": np.zeros(1, np.uintp), "metrics": np.zeros(6)}
    yield SimpleNamespace(array=array, session=session, board=board, **buffers)
    library.plain("board_free", board)
    library.plain("session_free", session)
    library.plain("array_free", array)


def solve(have: SimpleNamespace, **changed: object) -> tuple[object, ...]:
    """Arguments of midair_session_solve, all in order but those changed."""
    own = {"session": have.session, "points": POINT, "pressures": None, "weights": None, "count": 1}
    own |= {"drive": have.drive, "transducers": 64, "answer": None}
    assert changed.keys() <= own.keys()
    return ("session_solve", *(own | changed).values())


def misaligned(dtype: type, count: int) -> np.ndarray:
    return np.zeros(count * np.dtype(dtype).itemsize + 1, np.uint8)[1:].view(dtype)


REFUSED: dict[str, tuple[Callable[[SimpleNamespace], tuple[object, ...]], str]] = {
    # Names.
    "preset": (lambda h: ("array_preset", "autd4", 1, 1, h.place), 'unknown preset "autd4": did you mean autd3?'),
    "no preset": (lambda h: ("array_preset", None, 1, 1, h.place), "preset is NULL: give text"),
    "latin": (lambda h: ("array_preset", b"\xe9", 1, 1, h.place), "preset is \N{REPLACEMENT CHARACTER}: give text in UTF-8"),
    "method": (lambda h: ("session_new", h.array, "fsat", h.place), 'unknown solver "fsat": did you mean fast?'),
    "board": (lambda h: ("board_new", "mega65", 64, h.place), 'unknown board "mega65": did you mean mega64?'),
    "option": (lambda h: ("session_set_number", h.session, "phase", 8), 'unknown option of greedy "phase": did you mean phases?'),
    "medium": (
        lambda h: ("session_set_number", h.session, "frequncy", 8),
        'unknown option of greedy "frequncy": did you mean frequency? known are phases',
    ),
    "word": (lambda h: ("session_set_text", h.session, "objective", "l3"), 'objective is "l3": give "l2" or "l1"'),
    "flag": (lambda h: ("session_set_text", h.session, "balance", "yes"), 'solver.balance is "yes": give true or false'),
    "flag by number": (lambda h: ("session_set_number", h.session, "balance", 1), "solver.balance is 1: give true or false"),
    "aim": (lambda h: ("session_set_text", h.session, "aim", "max"), 'aim is given to "greedy": leave it out'),
    "directivity": (
        lambda h: ("session_set_text", h.session, "directivity", "pistol"),
        'unknown directivity "pistol": did you mean piston?',
    ),
    "quantization": (
        lambda h: ("session_set_text", h.session, "quantization", "non"),
        'unknown board "non": known are ',
    ),
    # Numbers.
    "pitch": (lambda h: ("array_grid", 8, 8, NAN, h.place), "array.grid.pitch is NaN: give a finite number"),
    "none": (lambda h: ("array_grid", 0, 8, 0.01, h.place), "array.grid.nx is 0: give at least 1 transducer"),
    "huge": (lambda h: ("array_grid", 2**40, 2**40, 0.01, h.place), "array.grid nx * ny is "),
    "position": (
        lambda h: ("array_new", np.array([[0, NAN, 0]]), None, 1, h.place),
        "array.positions[0] is [0.0, NaN, 0.0]: give three finite numbers",
    ),
    "no positions": (lambda h: ("array_new", None, None, 0, h.place), "array.positions is empty: give at least one"),
    "frequency": (
        lambda h: ("session_set_number", h.session, "frequency", NAN),
        "medium.frequency is NaN: give a finite number",
    ),
    "frequency of -1": (lambda h: ("session_set_number", h.session, "frequency", -1), "medium.frequency is -1.0: give a number above 0"),
    "text for a number": (
        lambda h: ("session_set_text", h.session, "frequency", "40k"),
        'medium.frequency is "40k": give a finite number',
    ),
    "radius": (lambda h: ("session_set_number", h.session, "directivity.piston", 4.5), "directivity.piston is 4.5: give metres"),
    "part of a phase": (
        lambda h: ("session_set_number", h.session, "phases", 2.5),
        "phases is 2.5: give a whole number",
    ),
    "mask": (lambda h: ("session_set_numbers", h.session, "mask", np.array([1, 0.5]), 2), "array.mask[1] is 0.5: give 0 for off or 1"),
    "short mask": (
        lambda h: ("session_set_numbers", h.session, "mask", np.ones(3), 3),
        "array.mask is 3 values: give one for each of the 64 transducers",
    ),
    "mask by number": (
        lambda h: ("session_set_number", h.session, "mask", 1),
        "array.mask is no list: set it with midair_session_set_numbers",
    ),
    "directivity by number": (
        lambda h: ("session_set_number", h.session, "directivity", 1),
        "array.directivity is no text: set it with midair_session_set_text",
    ),
    "odd response": (
        lambda h: ("session_set_numbers", h.session, "response", np.ones(3), 3),
        "array.response is 3 numbers: give re and im of each transducer",
    ),
    "order": (
        lambda h: ("session_set_numbers", h.session, "order", np.array([0.0, NAN]), 2),
        "order[1] is NaN: give whole numbers",
    ),
    "point": (
        lambda h: solve(h, points=np.array([[0, NAN, 0.15]])),
        "points[0].position is [0.0, NaN, 0.15]: give three finite numbers",
    ),
    "point on a transducer": (lambda h: solve(h, points=np.array([[0.00525, 0.00525, 0]])), "points[0] is 0.000e0 m from transducer"),
    "pressure": (lambda h: solve(h, pressures=np.array([-3.0])), "points[0].pressure is -3.0: give a number of at least 0"),
    "weight": (lambda h: solve(h, weights=np.array([NAN])), "points[0].weight is NaN: give a finite number"),
    "no points": (lambda h: solve(h, points=None, count=0), "points is empty: give at least one point"),
    "drive of NaN": (
        lambda h: ("session_field", h.session, np.full(64, NAN, np.complex64), 64, POINT, 1, h.drive),
        "drive[0] is NaN+0i: give finite numbers",
    ),
    "loud drive": (
        lambda h: ("board_encode", h.board, np.full(64, 2, np.complex64), 64, np.zeros(210, np.uint8), 210),
        "drive[0] is 2 + 0j: give finite drives of at most 1",
    ),
    # NULL, short and misaligned buffers.
    "array": (lambda h: ("session_new", None, "fast", h.place), "array is NULL: make one with midair_array_new() or the like"),
    "session": (lambda h: solve(h, session=None), "session is NULL: make one with midair_session_new()"),
    "no board": (lambda h: ("board_encode", None, h.drive, 64, np.zeros(3, np.uint8), 3), "board is NULL: make one"),
    "place": (lambda h: ("array_grid", 8, 8, 0.01, None), "array is NULL: give an address"),
    "points": (lambda h: solve(h, points=None), "points is NULL: give an address"),
    "drive": (lambda h: solve(h, drive=None), "drive is NULL: give an address"),
    "name": (lambda h: ("session_set_number", h.session, None, 1), "name is NULL: give text"),
    "metrics": (lambda h: ("session_judge", h.session, h.drive, 64, POINT, None, None, 1, None), "metrics is NULL: give an address"),
    "short drive": (lambda h: solve(h, transducers=63), "drive is room for 63: give room for 64"),
    "short drive to judge": (
        lambda h: ("session_judge", h.session, h.drive, 63, POINT, None, None, 1, h.metrics),
        "drive is 63 values: give one for each of the 64 transducers",
    ),
    "short frame": (
        lambda h: ("board_encode", h.board, h.drive, 64, np.zeros(3, np.uint8), 3),
        "frame is room for 3: give room for 210",
    ),
    "short silence": (lambda h: ("board_silence", h.board, np.zeros(3, np.uint8), 3), "bytes is room for 3: give room for 630"),
    "short positions": (lambda h: ("array_positions", h.array, np.zeros(9), None, 3), "positions is room for 3: give room for 64"),
    "crowded board": (lambda h: ("board_new", "nano", 9, h.place), "transducers is 9: nano has 1 to 8 channels"),
    "misaligned points": (lambda h: solve(h, points=misaligned(np.float64, 3)), "points is at address 0x"),
    "misaligned drive": (lambda h: solve(h, drive=misaligned(np.complex64, 64)), "drive is at address 0x"),
    "misaligned answer": (lambda h: solve(h, answer=misaligned(np.float64, 9)), "answer is at address 0x"),
    "count": (lambda h: solve(h, count=2**61), "points is 2305843009213693952 of them: no memory holds so many"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_refused_by_item_value_and_cure(library: Library, have: SimpleNamespace, case: str) -> None:
    arguments, text = REFUSED[case]
    have.place[:] = 7
    result, message = library.call(*arguments(have))
    assert result == INVALID
    assert message.startswith(text)
    assert "\n" not in message
    # A place for a handle that could be written has NULL, and the session still answers.
    assert have.place[0] == (0 if any(argument is have.place for argument in arguments(have)) else 7)
    assert library.call(*solve(have))[0] == 0


def test_what_is_refused_writes_nothing(library: Library, have: SimpleNamespace) -> None:
    drive, answer = np.full(64, 9, np.complex64), np.full(1, 9, ANSWER)
    library.call(*solve(have, points=np.full((1, 3), NAN), drive=drive, answer=answer))
    assert (drive == 9).all()
    assert answer[0].tolist() == (9,) * 9


def test_too_much_memory_has_its_own_result(library: Library, have: SimpleNamespace) -> None:
    session = library.session(have.array, "evd")
    points = np.random.default_rng(0).uniform(0.1, 0.2, (33000, 3))
    result, message = library.call(*solve(have, session=session, points=points, count=33000))
    assert result == MEMORY
    assert message.startswith("the matrix G G^H of N = 64 transducers and M = 33000 points needs 8.7")
    library.plain("session_free", session)


def test_a_message_is_cut_to_fit(library: Library, have: SimpleNamespace) -> None:
    arguments, text = REFUSED["preset"]
    for size in (1, 2, 20):
        assert library.call(*arguments(have), size=size) == (INVALID, text[: size - 1])
    # Without room nothing is written.
    assert library.call(*arguments(have), size=0)[1].startswith("????")


def test_frees_take_null(library: Library) -> None:
    frees = [name for name in library.names if name.endswith("_free")]
    assert len(frees) == 3
    for name in frees:
        library.plain(name.removeprefix("midair_"), None)
    sizes = ("array_count", "board_frame_size", "board_silence_size")
    assert [library.plain(name, None) for name in sizes] == [0, 0, 0]


def test_warnings_are_told_once(library: Library, have: SimpleNamespace) -> None:
    session = library.session(have.array, "greedy")
    loud = np.array([1e6])
    assert "points[0].pressure is 1000000 Pa, beyond reach" in library.done(*solve(have, session=session, pressures=loud))
    assert library.done(*solve(have, session=session, pressures=loud)) == ""
    # Set anew it begins anew; an array in doubt is told when that is known.
    said = library.done("session_set_number", session, "frequency", 40.0)
    assert said.startswith("medium.frequency is 40 Hz")
    assert library.done("session_set_number", session, "density", 1.2) == ""
    library.plain("session_free", session)


def test_sessions_of_their_own_and_one_for_all(library: Library) -> None:
    """Threads with a session each get the same bits as one; those that share one are answered or refused."""
    array = library.new("array_preset", "paper20", 1, 1)
    points = np.array([[0.02 * np.cos(t), 0.02 * np.sin(t), 0.15] for t in range(8)])
    shared = library.session(array, "greedy")
    alone, _ = library.solve(shared, 400, points)
    own, told = [], []

    def work() -> None:
        session = library.session(array, "greedy")
        for _ in range(20):
            own.append(library.solve(session, 400, points)[0].tobytes())
            drive = np.zeros(400, np.complex64)
            result, message = library.call("session_solve", shared, points, None, None, 8, drive, 400, None)
            told.append(message if result else drive.tobytes())
        library.plain("session_free", session)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert set(own) == {alone.tobytes()}
    assert len(own) == len(told) == 80
    busy = "session is at work in another thread: give each thread a session of its own"
    assert set(told) <= {alone.tobytes(), busy}
    library.plain("session_free", shared)
    library.plain("array_free", array)


def test_version_and_interface(library: Library) -> None:
    assert library.plain("version").decode() == midair.__version__
    assert library.plain("abi") == library.abi


def test_a_null_handle_is_not_followed(library: Library) -> None:
    null = c_void_p()
    for name in ("session_set_number", "session_set_text", "session_set_numbers"):
        rest = {"session_set_number": (1.0,), "session_set_text": ("a",), "session_set_numbers": (np.ones(1), 1)}[name]
        assert library.call(name, null, "frequency", *rest) == (INVALID, "session is NULL: make one with midair_session_new() or the like")
