"""Two foci above a SonicSurface by the C library alone: nothing but Python's own ctypes.

    python examples/ctypes/solve.py /usr/local/lib/libmidair.so.1

The package `midair` does all of this and more; this is how a language with a foreign function interface calls
the library.
"""

from __future__ import annotations

import sys
from ctypes import (
    CDLL,
    POINTER,
    Structure,
    byref,
    c_char_p,
    c_double,
    c_float,
    c_int,
    c_size_t,
    c_ubyte,
    c_void_p,
    create_string_buffer,
)


class Complex(Structure):
    """The struct midair_complex."""

    _fields_ = (("re", c_float), ("im", c_float))


NUMBERS = ["scale", "accuracy", "sigma", "uniformity", "level", "residual", "leak"]


class Answer(Structure):
    """The struct midair_answer, with its metrics as single fields."""

    _fields_ = (
        ("status", c_int),
        ("steps", c_size_t),
        *((name, c_double) for name in NUMBERS),
    )


#: Argument types of the functions in midair.h; message and message_size follow them.
FUNCTIONS = {
    "midair_array_preset": [c_char_p, c_size_t, c_size_t, POINTER(c_void_p)],
    "midair_session_new": [c_void_p, c_char_p, POINTER(c_void_p)],
    "midair_session_set_number": [c_void_p, c_char_p, c_double],
    "midair_session_solve": [
        c_void_p,
        POINTER(c_double),
        POINTER(c_double),
        POINTER(c_double),
        c_size_t,
        POINTER(Complex),
        c_size_t,
        POINTER(Answer),
    ],
    "midair_board_new": [c_char_p, c_size_t, POINTER(c_void_p)],
    "midair_board_encode": [c_void_p, POINTER(Complex), c_size_t, POINTER(c_ubyte), c_size_t],
}


class Library:
    """The functions of midair.h; a failed call raises an exception."""

    def __init__(self, path: str) -> None:
        self.functions = CDLL(path)
        for name, arguments in FUNCTIONS.items():
            function = getattr(self.functions, name)
            function.argtypes, function.restype = [*arguments, c_char_p, c_size_t], c_int
        for name in ("midair_array_count", "midair_board_frame_size"):
            function = getattr(self.functions, name)
            function.argtypes, function.restype = [c_void_p], c_size_t
        for name in ("midair_array_free", "midair_session_free", "midair_board_free"):
            function = getattr(self.functions, name)
            function.argtypes, function.restype = [c_void_p], None

    def call(self, name: str, *arguments: object) -> None:
        message = create_string_buffer(1024)
        result = getattr(self.functions, name)(*arguments, message, len(message))
        if result != 0:
            raise ValueError(message.value.decode())
        if message.value:
            print("warning:", message.value.decode(), file=sys.stderr)


def main(path: str) -> None:
    library = Library(path)
    array, session, board = c_void_p(), c_void_p(), c_void_p()
    library.call("midair_array_preset", b"sonicsurface", 1, 1, byref(array))
    library.call("midair_session_new", array, b"uniform", byref(session))
    library.call("midair_session_set_number", session, b"temperature", 23.0)

    count = library.functions.midair_array_count(array)
    points = (c_double * 6)(-0.02, 0.0, 0.15, 0.02, 0.0, 0.15)
    pressures = (c_double * 2)(1000.0, 1000.0)
    drive, answer = (Complex * count)(), Answer()
    library.call("midair_session_solve", session, points, pressures, None, 2, drive, count, byref(answer))
    shown = f"level {answer.level:.3f}, uniformity {answer.uniformity:.3f}, scale {answer.scale:.3f}"
    print(f"{count} transducers: {shown}")

    library.call("midair_board_new", b"sonicsurface", count, byref(board))
    frame = (c_ubyte * library.functions.midair_board_frame_size(board))()
    library.call("midair_board_encode", board, drive, count, frame, len(frame))
    print(f"a frame of {len(frame)} bytes: {frame[0]} {frame[1]} {frame[2]} ...")

    library.functions.midair_board_free(board)
    library.functions.midair_session_free(session)
    library.functions.midair_array_free(array)


if __name__ == "__main__":
    main(sys.argv[1])
