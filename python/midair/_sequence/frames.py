"""Base class of `midair.Sequence`: points, targets, drives, air and settings of frames."""

from collections.abc import Mapping
from functools import partial
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Array, Moving, Scene, scene_keys
from .._pictures.notebook import sequence
from .._support import output
from .._support.arguments import flag, frame_rate, number, word
from . import arguments, drives as driven

#: Names of the arguments for the air, for obstacles in it, and for the kind of points.
AIR = (*scene_keys()["medium"], "obstacles", "signature", "bead")


def air_of(scene: Scene) -> dict[str, Any]:
    """Return the air of a scene, obstacles in it, and the kind of its points, as arguments."""
    return {**scene.medium, **{name: getattr(scene, name) for name in ("obstacles", "signature", "bead")}}


class Frames:
    """Data of a `midair.Sequence`, whose documentation explains the arguments."""

    def __init__(
        self,
        array: Array,
        points: ArrayLike,
        targets: ArrayLike,
        drives: ArrayLike,
        *,
        rate: float,
        closed: bool = False,
        change: float | None = None,
        quantization: Mapping[str, Any] | None = None,
        solver: str = "",
        **medium: Any,
    ) -> None:
        if not isinstance(array, Array):
            raise TypeError(f"expected a midair.Array first, not {type(array).__qualname__}")
        for name in medium.keys() - set(AIR):
            raise TypeError(f"Sequence has no argument {name!r}: of the air it takes {', '.join(AIR)}")
        self._points = arguments.points(points)
        self._targets = arguments.targets(targets, self._points.shape[:2])
        self._rate = frame_rate(rate)
        self._closed = flag("closed", closed)
        self._change = None if change is None else number("change", change, least=0)
        self._quantization = arguments.quantization(quantization, array)
        self._solver = word("solver", solver)
        self._drives = driven.read(drives, array, (self._quantization or {}).get("phases"))
        arguments.frames("drives", len(self._drives), len(self._points))
        self._scene = Scene(array, self._points[0], **medium)

    @classmethod
    def _solved(cls, moving: Moving, drives: Any) -> Self:
        """Return the sequence of solved frames, with drives or codes (T, N) of the core."""
        made = cls.__new__(cls)
        made._scene, made._points, made._targets = moving.scene, moving.points, moving.targets
        made._rate, made._closed, made._change = moving.rate, moving.closed, moving.change
        made._quantization, made._solver = moving.quantization, moving.solver
        phases = (made._quantization or {}).get("phases") if drives.dtype.kind == "u" else None
        made._drives = driven.Drives(drives, driven.sounding(moving.scene.array), phases)
        return made

    @property
    def array(self) -> Array:
        """Array of the transducers."""
        return self._scene.array

    @property
    def points(self) -> NDArray[np.float64]:
        """Points (T, M, 3) of each frame in m."""
        return self._points

    @property
    def targets(self) -> NDArray[np.float64]:
        """Targets (T, M) in Pa, 0 where a point is absent."""
        return self._targets

    @property
    def rate(self) -> float:
        """Frames per second."""
        return self._rate

    @property
    def closed(self) -> bool:
        """Whether the sequence repeats: its first frame follows its last."""
        return self._closed

    @property
    def change(self) -> float | None:
        """Bound of the phase change, in rad per frame, within which the frames were solved, or None."""
        return self._change

    @property
    def quantization(self) -> dict[str, Any] | None:
        """Quantization of the board, as in `midair.Array.quantization`; None if any drive is possible."""
        return self._quantization

    @property
    def solver(self) -> str:
        """Name of the solver."""
        return self._solver

    @property
    def codes(self) -> NDArray[Any] | None:
        """Codes l (T, N) of the phases 2 pi l/L, uint8 or uint16, or None if drives are complex."""
        return None if self._drives.phases is None else self._drives.kept[:]

    @property
    def drives(self) -> NDArray[np.complex64]:
        """Drives (T, N), |q| <= 1, 0 where a transducer is off; codes are converted at each access."""
        return self._drives[:]

    def __len__(self) -> int:
        return len(self._points)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Frames):
            return NotImplemented
        same = output.to_json(self._setting()) == output.to_json(other._setting())
        arrays = (
            (self._points, other._points),
            (self._targets, other._targets),
            (self._drives.kept, other._drives.kept),
        )
        return (
            same
            and self._scene == other._scene
            and all(mine.dtype == theirs.dtype and np.array_equal(mine, theirs) for mine, theirs in arrays)
        )

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        made = partial(type(self), **air_of(self._scene), **self._setting())
        return made, (self.array, self._points, self._targets, self._drives.kept)

    def __repr__(self) -> str:
        return f"<midair.{self._heading()}>"

    def _repr_html_(self) -> str:
        return sequence(self._scene.array, self._points, self._closed, self._facts())

    def _facts(self) -> list[tuple[str, str]]:
        frames, count = self._targets.shape
        board = "any" if self._drives.phases is None else str(self._drives.phases)
        facts = [
            (
                "midair.Sequence",
                f"{frames} frames at {self._rate:g} Hz, {'closed' if self._closed else 'open'}",
            ),
            ("time", f"{frames / self._rate:.4g} s"),
            ("points", str(count)),
            ("transducers", str(len(self.array))),
            ("phases", board),
        ]
        bound = [] if self._change is None else [("bound", f"{self._change:.4g} rad a frame")]
        return facts + bound + ([("solver", self._solver)] if self._solver else [])

    def _heading(self) -> str:
        frames, count = self._targets.shape
        how = f"{'closed' if self._closed else 'open'}{f', by {self._solver}' if self._solver else ''}"
        size = f"{frames} frames at {self._rate:g} Hz, {count} points, {len(self.array)} transducers"
        return f"Sequence of {size}: {how}"

    def setting(self) -> dict[str, Any]:
        """Return the arguments of an equal sequence, except array, points, targets and drives."""
        return {**self._setting(), **self._scene.medium}

    def _setting(self) -> dict[str, Any]:
        names = ("rate", "closed", "change", "quantization", "solver")
        return {name: getattr(self, name) for name in names}
