"""Arrays of other libraries: inputs by `__dlpack__` or `__array_interface__`,
and results that others read.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import midair
from midair._support.arguments import as_array

ARRAY = midair.Array.preset("autd3")
POINTS = np.array([[-0.02, 0, 0.15], [0.02, 0.01, 0.15]])


class Tensor:
    """An array with DLPack alone, like a tensor of another library."""

    def __init__(self, values: Any, device: tuple[int, int] = (1, 0)) -> None:
        # This version of DLPack cannot mark arrays as read-only, so the array must be writable.
        self.values = np.require(values, requirements="W")
        self.device = device

    def __dlpack__(self, *, dl_device: tuple[int, int] | None = None, **options: Any) -> Any:
        # The memory of a GPU is exported as a copy for the CPU if the caller requests one.
        if self.device != (1, 0) and dl_device != (1, 0):
            raise BufferError("on the GPU")
        return self.values.__dlpack__()

    def __dlpack_device__(self) -> tuple[int, int]:
        return self.device


class Interface:
    """An array with NumPy's interface alone."""

    def __init__(self, values: Any) -> None:
        self.values = np.asarray(values)
        self.__array_interface__ = self.values.__array_interface__


class Locked(Tensor):
    """A tensor that cannot be exported, like one that records gradients."""

    def __dlpack__(self, **options: Any) -> Any:
        raise BufferError("detach it")

    def __array__(self, *given: Any, **options: Any) -> Any:
        raise RuntimeError("detach it")


OTHERS = {"dlpack": Tensor, "interface": Interface}


@pytest.mark.parametrize("other", OTHERS.values(), ids=OTHERS)
def test_points_drives_and_fields_of_another_library(other: Any) -> None:
    scene = midair.Scene(ARRAY, POINTS, [800, 600])
    same = midair.Scene(ARRAY, other(POINTS), other([800.0, 600.0]))
    np.testing.assert_array_equal(same.points, scene.points)
    solution = midair.solve(scene)
    np.testing.assert_array_equal(midair.solve(same).drive, solution.drive)
    drive = other(solution.drive)
    np.testing.assert_array_equal(
        midair.field(scene, drive, other(POINTS)).pressure, midair.field(scene, solution, POINTS).pressure
    )
    board = midair.Board("autd3")
    assert board.encode(drive) == board.encode(solution)
    frames = [other(POINTS + np.array([0.001 * t, 0, 0])) for t in range(3)]
    streamed = list(midair.stream(ARRAY, frames, rate=80.0))
    np.testing.assert_array_equal(
        streamed, list(midair.stream(ARRAY, [frame.values for frame in frames], rate=80.0))
    )


@pytest.mark.parametrize("other", OTHERS.values(), ids=OTHERS)
def test_memory_is_shared_where_the_layout_allows(other: Any) -> None:
    for values in (POINTS, POINTS.astype(np.float32), POINTS[::-1], np.asfortranarray(POINTS)):
        assert np.shares_memory(as_array(other(values)), values)
        np.testing.assert_array_equal(as_array(other(values)), values)
        midair.Scene(ARRAY, other(values))


def test_a_gpu_gives_a_copy() -> None:
    if tuple(map(int, np.__version__.split(".")[:2])) < (2, 1):
        pytest.skip("numpy of before 2.1 does not ask for one")
    # In DLPack, (2, 0) is CUDA device 0.
    np.testing.assert_array_equal(midair.Scene(ARRAY, Tensor(POINTS, (2, 0))).points, POINTS)


def test_what_gives_nothing_away_is_refused_in_one_line() -> None:
    with pytest.raises(midair.SceneError, match="points is") as caught:
        midair.Scene(ARRAY, Locked(POINTS))
    assert "\n" not in str(caught.value)


def test_answers_go_out_in_place() -> None:
    solution = midair.solve(midair.Scene(ARRAY, POINTS))
    for answer in (
        solution.drive,
        solution.pressures,
        midair.field(solution.scene, solution, POINTS).pressure,
    ):
        assert np.shares_memory(np.from_dlpack(answer), answer)
        assert np.shares_memory(np.asarray(Interface(answer)), answer)
