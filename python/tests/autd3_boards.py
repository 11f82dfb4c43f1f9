"""AUTD3 boards in double precision, from their maker's documents: positions, codes and pulse widths."""

import math

import numpy as np
from numpy.typing import NDArray

import midair
import oracle

Floats = NDArray[np.float64]

#: The 249 transducers of a board, in mm: a grid of 18 x 14, x fastest. Screws and the connector take 3 sites.
SITES = np.array(
    [(10.16 * x, 10.16 * y, 0.0) for y in range(14) for x in range(18) if (x, y) not in {(1, 1), (2, 1), (16, 1)}]
)


def turned(axis: list[float], degrees: float) -> Floats:
    """Returns the unit quaternion (w, x, y, z) of a rotation about an axis."""
    half = math.radians(degrees) / 2
    return np.array([math.cos(half), *(math.sin(half) * np.array(axis) / np.linalg.norm(axis))])


def matrix(quaternion: Floats) -> Floats:
    """Returns the rotation matrix (3, 3) of a unit quaternion."""
    w, x, y, z = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def boards(*poses: tuple[list[float], Floats]) -> midair.Array:
    """Returns the array of boards at these poses (position of the first transducer in mm, quaternion)."""
    places = [np.array(origin) + SITES @ matrix(rotation).T for origin, rotation in poses]
    normals = [np.tile(matrix(rotation)[:, 2], (249, 1)) for _, rotation in poses]
    return midair.Array(np.concatenate(places) * 1e-3, np.concatenate(normals))


def some_poses(count: int) -> list[tuple[list[float], Floats]]:
    """Returns poses of one to four boards around the z axis.
    The second board is tilted and turned; for `count` 1, it is the only one.
    """
    flat, tilted = np.array([1.0, 0, 0, 0]), turned([0.2, 1, 0.1], -25)
    poses = [([-185.0, -145.0, 0.0], flat), ([10.0, -140.0, 2.0], tilted), ([-185.0, 8.0, 0.0], flat)]
    poses = [*poses, ([10.0, 12.0, -3.5], turned([0, 0, 1], 3.0))]
    return poses[1:2] if count == 1 else poses[:count]


def some_boards(count: int) -> midair.Array:
    """Returns the array of the boards at `some_poses`."""
    return boards(*some_poses(count))


def codes(drive: oracle.Complex) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """Returns the phase and intensity codes (boards, 249) of a drive;
    both are 0 where the intensity rounds to 0.
    """
    drive = np.asarray(drive, complex).reshape(-1, 249)
    phases = np.floor(np.angle(drive) / (2 * math.pi) * 256 + 0.5) % 256
    intensities = np.floor(255 * np.abs(drive) + 0.5)
    return np.where(intensities > 0, phases, 0).astype(np.uint8), intensities.astype(np.uint8)


def frame(drive: oracle.Complex) -> bytes:
    """Returns the bytes of a frame: for each board its phase codes, then its intensity codes."""
    return np.stack(codes(drive), axis=1).tobytes()


def widths(intensities: NDArray[np.uint8]) -> NDArray[np.int64]:
    """Returns the pulse widths that a board plays for intensity codes, in 1/512 of a period."""
    return np.floor(512 * np.arcsin(intensities / 255) / math.pi + 0.5).astype(np.int64)


def played(drive: oracle.Complex, *, pulses: bool) -> oracle.Complex:
    """Returns the drive that a drive's phase and intensity codes stand for.
    With `pulses`, an amplitude is sin(pi w / 512), where w is the pulse width.
    """
    phases, intensities = codes(drive)
    amplitudes = np.sin(math.pi * widths(intensities) / 512) if pulses else intensities / 255
    return (amplitudes * np.exp(2j * math.pi * phases / 256)).ravel()
