"""Beams: drives by the focusing law of a plane wave or of a Bessel beam."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Array, Scene
from .._support.arguments import number, refused, vector


def beam(
    scene_or_array: Scene | Array, direction: ArrayLike, *, apex: ArrayLike = (0.0, 0.0, 0.0), angle: float = 0.0
) -> NDArray[np.complex64]:
    """Return the drive of a plane wave, or of a Bessel beam, at full amplitude.

    Parameters
    ----------
    scene_or_array : midair.Scene or midair.Array
        N transducers and their air.
    direction : (3,) array_like
        Direction of the wave, or of the beam's axis; any length.
    apex : (3,) array_like, optional
        A place on the axis in m, where the phase is 0.
    angle : float, optional
        Angle between the rays and the axis in rad, below pi/2: 0 is a plane wave, more a Bessel beam.

    Returns
    -------
    (N,) ndarray of complex64
        The drive: 0 for masked and dead transducers, one value in each channel.

    Raises
    ------
    SceneError
        For a direction without length and an angle that is not from 0 to below pi/2.

    Notes
    -----
    Transducer i plays e^{jk (s cos(angle) - rho sin(angle))}, minus the phase of its response; s is its place
    along the axis from the apex, and rho its distance from the axis. The rays of an array of radius R cross
    the axis up to the distance R / tan(angle). There |p| is nearly that of J0(k rho sin(angle)) (Durnin 1987,
    J. Opt. Soc. Am. A 4, 651). An array radiates a plane wave only within its width.

    Examples
    --------
    >>> import midair
    >>> scene = midair.Scene(midair.Array.grid(32, 32, 4e-3), [[0, 0, 0.1]])
    >>> drive = midair.beam(scene, [0, 0, 1], angle=0.3)
    >>> axis, zero = abs(midair.field(scene, drive, [[0, 0, 0.1], [0.011, 0, 0.1]]).pressure)
    >>> bool(zero < 0.15 * axis)
    True
    """
    if not isinstance(scene_or_array, Array | Scene):
        raise refused("scene_or_array", scene_or_array, "give a midair.Scene or a midair.Array")
    if isinstance(scene_or_array, Scene):
        array = scene_or_array.array
        frequency, sound_speed = scene_or_array.frequency, scene_or_array.sound_speed
    else:
        array = scene_or_array
        frequency, sound_speed = array.medium["frequency"], array.medium["sound_speed"]
    axis, tilt = vector("direction", direction), number("angle", angle, least=0)
    if not np.linalg.norm(axis) > 0:
        raise refused("direction", direction, "give a direction, as [0, 0, 1]")
    if tilt >= np.pi / 2:
        raise refused("angle", angle, "give an angle in rad below pi/2")
    axis = axis / np.linalg.norm(axis)
    away = array.positions - vector("apex", apex)
    along = away @ axis
    beside = np.linalg.norm(away - along[:, None] * axis, axis=1)
    wavenumber = 2 * np.pi * frequency / sound_speed
    wave = np.exp(1j * wavenumber * (along * np.cos(tilt) - beside * np.sin(tilt)))
    response = np.ones(len(array)) if array.response is None else array.response
    response = response * array.mask
    wave = wave * np.conj(response)
    if array.channels is not None:
        sums = np.zeros(array.channels.max() + 1, complex)
        np.add.at(sums, array.channels, wave)
        wave = sums[array.channels] * (response != 0)
    size = np.abs(wave)
    return np.asarray(wave / np.where(size > 0, size, 1), np.complex64)
