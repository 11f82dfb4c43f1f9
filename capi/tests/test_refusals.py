"""Invalid requests: a result code, and one line that names the item, its value and the cure."""

import itertools
import re
import threading
from collections.abc import Callable, Iterator
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
    """Returns one handle of each kind, and buffers of the right size."""
    array = library.new("array_grid", 8, 8, 0.0105)
    session, board = library.session(array, "greedy"), library.new("board_new", "mega64", 64)
    buffers = {"drive": np.zeros(64, np.complex64), "place": np.zeros(1, np.uintp), "metrics": np.zeros(6)}
    yield SimpleNamespace(array=array, session=session, board=board, **buffers)
    library.plain("board_free", board)
    library.plain("session_free", session)
    library.plain("array_free", array)


def solve(have: SimpleNamespace, **changed: object) -> tuple[object, ...]:
    """Returns the arguments of midair_session_solve, all valid except for those changed."""
    own = {"session": have.session, "points": POINT, "pressures": None, "weights": None, "count": 1}
    own |= {"drive": have.drive, "transducers": 64, "answer": None}
    assert changed.keys() <= own.keys()
    return ("session_solve", *(own | changed).values())


def misaligned(dtype: type, count: int) -> np.ndarray:
    return np.zeros(count * np.dtype(dtype).itemsize + 1, np.uint8)[1:].view(dtype)


Call = Callable[[SimpleNamespace], tuple[object, ...]]


def number(name: str, value: float) -> Call:
    return lambda h: ("session_set_number", h.session, name, value)


def text(name: str, value: str) -> Call:
    return lambda h: ("session_set_text", h.session, name, value)


def numbers(name: str, *values: float) -> Call:
    return lambda h: ("session_set_numbers", h.session, name, np.array(values, float), len(values))


def requested(**changed: object) -> Call:
    return lambda h: solve(h, **changed)


REFUSED: dict[str, tuple[Call, str]] = {
    # Invalid names.
    "preset": (
        lambda h: ("array_preset", "autd4", 1, 1, h.place),
        'unknown preset "autd4": did you mean autd3?',
    ),
    "no preset": (lambda h: ("array_preset", None, 1, 1, h.place), "preset is NULL: give text"),
    "latin": (
        lambda h: ("array_preset", b"\xe9", 1, 1, h.place),
        "preset is \N{REPLACEMENT CHARACTER}: give text in UTF-8",
    ),
    "method": (
        lambda h: ("session_new", h.array, "fsat", h.place),
        'unknown solver "fsat": did you mean fast?',
    ),
    "board": (lambda h: ("board_new", "mega65", 64, h.place), 'unknown board "mega65": did you mean mega64?'),
    "option": (number("phase", 8), 'unknown option of greedy "phase": did you mean phases?'),
    "medium": (
        number("frequncy", 8),
        'unknown option of greedy "frequncy": did you mean frequency? known are phases',
    ),
    "word": (text("objective", "l3"), 'objective is "l3": give "l2" or "l1"'),
    "flag": (text("balance", "yes"), 'solver.balance is "yes": give true or false'),
    "flag by number": (number("balance", 1), "solver.balance is 1: give true or false"),
    "aim": (text("aim", "max"), 'aim is given to "greedy": leave it out'),
    "directivity": (
        text("directivity", "pistol"),
        'unknown directivity "pistol": did you mean piston?',
    ),
    "quantization": (
        text("quantization", "non"),
        'unknown board "non": known are ',
    ),
    # Invalid numbers.
    "pitch": (lambda h: ("array_grid", 8, 8, NAN, h.place), "array.grid.pitch is NaN: give a finite number"),
    "none": (lambda h: ("array_grid", 0, 8, 0.01, h.place), "array.grid.nx is 0: give at least 1 transducer"),
    "huge": (lambda h: ("array_grid", 2**40, 2**40, 0.01, h.place), "array.grid nx * ny is "),
    "position": (
        lambda h: ("array_new", np.array([[0, NAN, 0]]), None, 1, h.place),
        "array.positions[0] is [0.0, NaN, 0.0]: give three finite numbers",
    ),
    "no positions": (
        lambda h: ("array_new", None, None, 0, h.place),
        "array.positions is empty: give at least one",
    ),
    "frequency": (
        number("frequency", NAN),
        "medium.frequency is NaN: give a finite number",
    ),
    "frequency of -1": (number("frequency", -1), "medium.frequency is -1.0: give a number above 0"),
    "text for a number": (
        text("frequency", "40k"),
        "medium.frequency is 40k: set it with midair_session_set_number",
    ),
    "radius": (number("directivity.piston", 4.5), "directivity.piston is 4.5: give metres"),
    "part of a phase": (
        number("phases", 2.5),
        "phases is 2.5: give a whole number",
    ),
    "weightless bead": (number("bead.density", 0), "bead.density is 0.0: give a number above 0"),
    "a key of a bead": (number("bead.weight", 1), 'unknown key of bead "weight"'),
    "gravity by number": (
        number("bead.gravity", 9.81),
        "bead.gravity is no list: set it with midair_session_set_numbers",
    ),
    "gravity along two axes": (
        numbers("bead.gravity", 0, 0),
        "bead.gravity is 2 numbers: give x, y and z in m/s^2",
    ),
    "mask": (numbers("mask", 1, 0.5), "array.mask[1] is 0.5: give 0 for off or 1"),
    "short mask": (
        numbers("mask", 1, 1, 1),
        "array.mask is 3 values: give one for each of the 64 transducers",
    ),
    "mask by number": (
        number("mask", 1),
        "array.mask is no list: set it with midair_session_set_numbers",
    ),
    "directivity by number": (
        number("directivity", 1),
        "array.directivity is no text: set it with midair_session_set_text",
    ),
    "odd response": (
        numbers("response", 1, 1, 1),
        "array.response is 3 numbers: give re and im of each transducer",
    ),
    "order": (
        numbers("order", 0, NAN),
        "order[1] is NaN: give whole numbers",
    ),
    "point": (
        requested(points=np.array([[0, NAN, 0.15]])),
        "points[0].position is [0.0, NaN, 0.15]: give three finite numbers",
    ),
    "point on a transducer": (
        requested(points=np.array([[0.00525, 0.00525, 0]])),
        "points[0] is 0.000e0 m from transducer",
    ),
    "pressure": (
        requested(pressures=np.array([-3.0])),
        "points[0].pressure is -3.0: give a number of at least 0",
    ),
    "weight": (requested(weights=np.array([NAN])), "points[0].weight is NaN: give a finite number"),
    "path of a scene": (
        lambda h: ("session_open", b"scene.toml", None, h.place),
        "scene is scene.toml: give the text of a scene file",
    ),
    "no points": (requested(points=None, count=0), "points is empty: give at least one point"),
    "drive of NaN": (
        lambda h: ("session_field", h.session, np.full(64, NAN, np.complex64), 64, POINT, 1, h.drive),
        "drive[0] is NaN+0i: give finite numbers",
    ),
    "loud drive": (
        lambda h: ("board_encode", h.board, np.full(64, 2, np.complex64), 64, np.zeros(210, np.uint8), 210),
        "drive[0] is 2 + 0j: give finite drives of at most 1",
    ),
    # Buffers that are NULL, too short or misaligned.
    "array": (
        lambda h: ("session_new", None, "fast", h.place),
        "array is NULL: make one with midair_array_new() or the like",
    ),
    "session": (requested(session=None), "session is NULL: make one with midair_session_new()"),
    "no board": (
        lambda h: ("board_encode", None, h.drive, 64, np.zeros(3, np.uint8), 3),
        "board is NULL: make one",
    ),
    "place": (lambda h: ("array_grid", 8, 8, 0.01, None), "array is NULL: give an address"),
    "points": (requested(points=None), "points is NULL: give an address"),
    "drive": (requested(drive=None), "drive is NULL: give an address"),
    "name": (lambda h: ("session_set_number", h.session, None, 1), "name is NULL: give text"),
    "metrics": (
        lambda h: ("session_judge", h.session, h.drive, 64, POINT, None, None, 1, None),
        "metrics is NULL: give an address",
    ),
    "short drive": (requested(transducers=63), "drive is room for 63: give room for 64"),
    "short drive to judge": (
        lambda h: ("session_judge", h.session, h.drive, 63, POINT, None, None, 1, h.metrics),
        "drive is 63 values: give one for each of the 64 transducers",
    ),
    "short frame": (
        lambda h: ("board_encode", h.board, h.drive, 64, np.zeros(3, np.uint8), 3),
        "frame is room for 3: give room for 210",
    ),
    "short silence": (
        lambda h: ("board_silence", h.board, np.zeros(3, np.uint8), 3),
        "bytes is room for 3: give room for 630",
    ),
    "short positions": (
        lambda h: ("array_positions", h.array, np.zeros(9), None, 3),
        "positions is room for 3: give room for 64",
    ),
    "crowded board": (
        lambda h: ("board_new", "nano", 9, h.place),
        "transducers is 9: nano has 1 to 8 channels",
    ),
    "misaligned points": (requested(points=misaligned(np.float64, 3)), "points is at address 0x"),
    "misaligned drive": (requested(drive=misaligned(np.complex64, 64)), "drive is at address 0x"),
    "misaligned answer": (requested(answer=misaligned(np.float64, 9)), "answer is at address 0x"),
    "count": (requested(count=2**61), "points is 2305843009213693952 of them: no memory holds so many"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused_by_item_value_and_cure(library: Library, have: SimpleNamespace, case: str) -> None:
    arguments, text = REFUSED[case]
    have.place[:] = 7
    result, message = library.call(*arguments(have))
    assert result == INVALID
    assert message.startswith(text)
    assert "\n" not in message
    # After an error, the place for a handle contains NULL if it can be written; the session still works.
    assert have.place[0] == (0 if any(argument is have.place for argument in arguments(have)) else 7)
    assert library.call(*solve(have))[0] == 0


def test_what_is_refused_writes_nothing(library: Library, have: SimpleNamespace) -> None:
    drive, answer = np.full(64, 9, np.complex64), np.full(1, 9, ANSWER)
    library.call(*solve(have, points=np.full((1, 3), NAN), drive=drive, answer=answer))
    assert (drive == 9).all()
    assert answer[0].tolist() == (9,) * 9


def test_pressures_are_those_of_a_solution(library: Library, have: SimpleNamespace) -> None:
    session, pressures = library.session(have.array, "naive"), np.full(2, 9, np.complex64)
    call = ("session_pressures", session, pressures, None)
    assert library.plain("session_points", session) == 0
    assert library.call(*call, 1) == (INVALID, "solution is not there: call midair_session_solve() before")
    library.call(*solve(have, session=session))
    assert library.call(*call, 2) == (INVALID, "pressures is room for 2: give room for 1")
    assert (pressures == 9).all()
    library.plain("session_free", session)


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
    # With a buffer of size 0, nothing is written.
    assert library.call(*arguments(have), size=0)[1].startswith("????")


def test_frees_take_null(library: Library) -> None:
    frees = [name for name in library.arguments if name.endswith("_free")]
    assert len(frees) == 3
    for name in frees:
        library.plain(name.removeprefix("midair_"), None)
    sizes = ("array_count", "board_frame_size", "board_silence_size")
    assert [library.plain(name, None) for name in sizes] == [0, 0, 0]


def test_null_is_refused_whatever_the_sizes(library: Library, have: SimpleNamespace) -> None:
    """Calls each function that can fail with NULL everywhere, then with its handle alone, and all sizes."""
    handles = {"array": have.array, "session": have.session, "board": have.board}
    nothing = {"size_t": (0, 1, 2**64 - 1), "double": (1.0,)}
    fallible = {name: words[:-2] for name, words in library.arguments.items() if "char *message" in words}
    assert len(fallible) > 20
    for name, words in fallible.items():
        given = [nothing.get(word.split()[0], (None,)) if "*" not in word else (None,) for word in words]
        own = re.fullmatch(r"(?:const )?midair_(\w+) \*\w+", words[0])
        if own:
            given[0] = (None, handles[own[1]])
        for arguments in itertools.product(*given):
            result, message = library.call(name.removeprefix("midair_"), *arguments)
            shown = name, arguments, message
            # With a handle, a function may do nothing, as it does if nobody asks for positions.
            harmless = own is not None and arguments[0] is not None
            assert result in (INVALID, MEMORY) or (result == 0 and harmless), shown
            assert bool(library.plain("last_code")) == bool(message) == bool(result), shown
            assert "\n" not in message, shown


def test_warnings_are_reported_once(library: Library, have: SimpleNamespace) -> None:
    session = library.session(have.array, "greedy")
    loud = np.array([1e6])
    call = solve(have, session=session, pressures=loud)
    assert "points[0].pressure is 1000000 Pa, beyond reach" in library.done(*call)
    assert library.done(*call) == ""
    # After an option is set, warnings are given again. A probable mistake in the array is reported at once.
    said = library.done("session_set_number", session, "frequency", 40.0)
    assert said.startswith("medium.frequency is 40 Hz")
    assert library.done("session_set_number", session, "density", 1.2) == ""
    library.plain("session_free", session)


def test_sessions_of_their_own_and_one_for_all(library: Library) -> None:
    """Checks that threads with their own sessions get the same bits, and that threads that share one session
    get these bits or an error.
    """
    array = library.new("array_preset", "paper20", 1, 1)
    points = np.array([[0.02 * np.cos(t), 0.02 * np.sin(t), 0.15] for t in range(8)])
    shared = library.session(array, "greedy")
    alone, _ = library.solve(shared, 400, points)
    own, reported = [], []

    def work() -> None:
        session = library.session(array, "greedy")
        for _ in range(20):
            own.append(library.solve(session, 400, points)[0].tobytes())
            drive = np.zeros(400, np.complex64)
            result, message = library.call("session_solve", shared, points, None, None, 8, drive, 400, None)
            reported.append(message if result else drive.tobytes())
        library.plain("session_free", session)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert set(own) == {alone.tobytes()}
    assert len(own) == len(reported) == 80
    busy = "session is at work in another thread: give each thread a session of its own"
    assert set(reported) <= {alone.tobytes(), busy}
    library.plain("session_free", shared)
    library.plain("array_free", array)


def test_version_and_interface(library: Library) -> None:
    assert library.plain("version").decode() == midair.__version__
    assert library.plain("abi") == library.abi


@pytest.mark.parametrize("make", [number("phases", 8), text("aim", "max"), numbers("mask", 1)])
def test_options_of_no_session_are_refused(library: Library, make: Call) -> None:
    no_one = SimpleNamespace(session=None)
    refused = (INVALID, "session is NULL: make one with midair_session_new() or the like")
    assert library.call(*make(no_one)) == refused
