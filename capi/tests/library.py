"""The library through ctypes: every function, with the types that the header declares."""

import re
from ctypes import CDLL, c_char_p, c_double, c_int, c_size_t, c_uint32, c_void_p, create_string_buffer
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

#: The layout of midair_answer in C; midair_metrics is its last six numbers.
METRICS = ["accuracy", "sigma", "uniformity", "level", "residual", "leak"]
ANSWER = np.dtype([("status", "i4"), ("steps", "u8"), *((name, "f8") for name in ["scale", *METRICS])], align=True)
RETURNED = {
    "midair_result": c_int,
    "size_t": c_size_t,
    "uint32_t": c_uint32,
    "const char *": c_char_p,
    "void": None,
}


def kind(argument: str) -> type:
    """Returns the ctypes type of an argument in the header."""
    if "*" in argument:
        return c_char_p if re.match(r"(const )?char \*[^*]+$", argument) else c_void_p
    return {"size_t": c_size_t, "double": c_double}[argument.split()[0]]


class Library:
    """Calls the functions of the C library by name. A text may be a str, a list a NumPy array."""

    def __init__(self, prefix: Path) -> None:
        header = (prefix / "include" / "midair.h").read_text("utf-8")
        self.abi = int(re.findall(r"^#define MIDAIR_ABI (\d+)$", header, re.MULTILINE)[0])
        #: Each function's arguments as the header declares them.
        self.arguments: dict[str, list[str]] = {}
        self._functions = CDLL(str(prefix / "lib" / "libmidair.so"))
        prototype = r"^([a-z][a-z0-9_ ]*?(?: \*| ))(midair_\w+)\(([^)]*)\);"
        for returned, name, arguments in re.findall(prototype, header, re.MULTILINE):
            function = getattr(self._functions, name)
            function.restype = RETURNED[returned if returned.endswith("*") else returned.strip()]
            words = [" ".join(argument.split()) for argument in arguments.split(",")]
            function.argtypes = [] if words == ["void"] else [kind(argument) for argument in words]
            self.arguments[name] = words

    def plain(self, name: str, *arguments: object) -> object:
        """Calls a function that cannot fail, and returns its result."""
        return getattr(self._functions, f"midair_{name}")(*arguments)

    def call(self, name: str, *arguments: object, size: int = 1024) -> tuple[int, str]:
        """Calls a function that can fail, and returns its result and its message."""
        message = create_string_buffer(b"?" * 1024, 1025)
        words = [argument.encode() if isinstance(argument, str) else argument for argument in arguments]
        words = [word.ctypes.data if isinstance(word, np.ndarray) else word for word in words]
        result = getattr(self._functions, f"midair_{name}")(*words, message, size)
        return result, message.value.decode()

    def done(self, name: str, *arguments: object) -> str:
        """Calls a function that must succeed, and returns its warnings."""
        result, message = self.call(name, *arguments)
        assert result == 0, message
        return message

    def new(self, name: str, *arguments: object) -> c_void_p:
        """Returns a new handle."""
        handle = np.zeros(1, np.uintp)
        self.done(name, *arguments, handle)
        return c_void_p(int(handle[0]))

    def session(self, array: c_void_p, method: str, **options: object) -> c_void_p:
        session = self.new("session_new", array, method)
        for name, value in options.items():
            kind = "text" if isinstance(value, str) else "number"
            self.done(f"session_set_{kind}", session, name, value)
        return session

    def solve(
        self,
        session: c_void_p,
        count: int,
        points: NDArray[np.float64],
        pressures: NDArray[np.float64] | None = None,
        weights: NDArray[np.float64] | None = None,
    ) -> tuple[NDArray[np.complex64], np.void]:
        """Returns the drive of `count` transducers and the answer."""
        drive, answer = np.zeros(count, np.complex64), np.zeros(1, ANSWER)
        self.done("session_solve", session, points, pressures, weights, len(points), drive, count, answer)
        return drive, answer[0]
