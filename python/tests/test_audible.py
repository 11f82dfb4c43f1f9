"""Audible sound of sequences: against Berktay's and Westervelt's closed formulas for a piston, and against a
direct integral in float64 in which each spectral line of the ultrasound travels by itself.
"""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

import midair
from midair._judging.audible import TAU, audible_lines, loudness

PITCH = 4.25e-3


def line(values: NDArray[np.float64], rate: float, order: int) -> complex:
    """Line `order`, as sum of c_n e^(j w t), of drives (T,) that stay for a frame, through tau."""
    count = len(values)
    w = 2j * np.pi * rate / count * order
    held = 1.0 if order == 0 else (1 - np.exp(-w / rate)) / w * rate
    return complex(np.fft.fft(values)[order % count] / count * held / (1 + w * TAU))


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:medium.absorption")
@pytest.mark.parametrize(("absorption", "frequency"), [(2.0, 500.0), (2.0, 1000.0), (4.0, 2000.0)])
def test_a_piston_sounds_as_the_closed_formulas_have_it(absorption: float, frequency: float) -> None:
    """Berktay 1965 on the axis; off it Westervelt's directivity 2 alpha/|2 alpha + j k (1 - cos)|, 1963."""
    side, count = 20, 20
    array = midair.Array.grid(side, side, PITCH, source_pressure=1.0)
    amplitudes = np.sqrt((1 + np.cos(2 * np.pi * np.arange(count) / count)) / 2)
    drives = np.ones((count, side**2)) * amplitudes[:, None]
    points = np.broadcast_to([0, 0, 0.2], (count, 1, 3))
    played = midair.Sequence(array, points, 1.0, drives, rate=count * frequency, closed=True, absorption=absorption)
    scene, far, angle = played.scene(0), 30.0, 0.35
    ears = far * np.array([[0, 0, 1], [np.sin(angle), 0, np.cos(angle)]])
    frequencies, sound = audible_lines(played, ears)
    assert frequencies[0] == pytest.approx(frequency)
    orders = range(-40, 41)
    lines = {n: line(amplitudes, count * frequency, n) for n in orders}
    square = 2 * abs(sum(lines[n + 1] * lines[n].conjugate() for n in orders if n + 1 in lines))
    c, density = scene.sound_speed, scene.density
    plane, area, w = scene.wavelength / PITCH**2, (side * PITCH) ** 2, 2 * np.pi * frequency
    exact = 1.2 * plane**2 * area / (16 * np.pi * density * c**4 * far * absorption) * w**2 * square
    slant = 2 * absorption / abs(2 * absorption + 1j * w / c * (1 - np.cos(angle)))
    found = 20 * np.log10(sound[:, 0] / (exact * np.array([1, slant])))
    assert np.abs(found).max() < 1, found


def integral(played: midair.Sequence, ears: NDArray[np.float64], orders: int) -> NDArray[np.float64]:
    """Peak pressures (K, 2) in Pa of the two lowest lines at ears (K, 3). Line n of the drives has the
    wavenumber (w0 + n w)/c, so the envelope of each transducer travels its own way.
    """
    scene, step, count = played.scene(0), 6e-3, len(played)
    k, w = 2 * np.pi / scene.wavelength, 2 * np.pi * played.rate / count / scene.sound_speed
    drives = {n: np.array([line(q, played.rate, n) for q in played.drives.T]) for n in range(-orders, orders + 1)}
    summed = np.zeros((len(ears), 2), complex)
    for z in np.arange(step / 2, 2.5 / scene.absorption, step):
        x = np.arange(-0.03 - z, 0.03 + z, step)
        points = np.stack([*(part.ravel() for part in np.meshgrid(x, x)), np.full(len(x) ** 2, z)], axis=1)
        away = np.linalg.norm(points[:, None] - played.array.positions, axis=2)
        # The core's time factor is e^(-j w t); line n turns as e^(+j n w t). D is the squared cosine.
        fade = 4.386 / away * np.exp((1j * k - scene.absorption) * away) * (z / away) ** 2
        turn = np.exp(-1j * w * away)
        fields = {n: (fade * turn**n) @ q for n, q in drives.items()}
        distances = np.linalg.norm(points[:, None] - ears, axis=2)
        for order in (1, 2):
            energy = sum(fields[n + order] * fields[n].conj() for n in fields if n + order in fields) / 2
            summed[:, order - 1] += energy @ (np.exp(-1j * order * w * distances) / distances) * step**3
    scale = 2 * 1.2 / (4 * np.pi * scene.density * scene.sound_speed**2)
    found: NDArray[np.float64] = scale * np.abs(summed) * (w * np.array([1, 2])) ** 2
    return found


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:medium.absorption")
@pytest.mark.parametrize("technique", ["AM", pytest.param("moving", marks=pytest.mark.long), "glide"])
def test_a_small_array_sounds_as_the_direct_integral(technique: str) -> None:
    array = midair.Array.grid(4, 4, 5e-3, directivity={"cos": 2.0}, source_pressure=4.386)
    turns = 2 * np.pi * np.arange(10) / 10
    around = 0.02 * np.stack([np.cos(turns), np.sin(turns), 0 * turns], axis=1)
    points = np.array([0, 0, 0.06]) + around * (technique != "AM")
    if technique == "glide":
        played = midair.sequence(array, points[:, None], rate=5e3, change=np.pi / 2, absorption=5.0)
    else:
        gains = midair.Scene(array, points, absorption=5.0).propagation()
        drives = (gains / np.abs(gains)).conj()
        if technique == "AM":
            drives = drives * (0.5 + 0.4 * np.cos(turns[:, None]))
        played = midair.Sequence(array, points[:, None], 1.0, drives, rate=5e3, closed=True, absorption=5.0)
    # No ear is a point of the integral, or on the axis, where the sound of a circling focus cancels.
    ears = np.array([[0.1, 0, 0.151], [0.05, 0, 0.4], [-0.2, 0.1, 0.051]])
    frequencies, sound = audible_lines(played, ears)
    assert frequencies[:2].tolist() == [500, 1000]
    exact = integral(played, ears, 6)
    apart = 20 * np.log10(sound[:, :2] / exact)
    strong = exact > 0.1 * exact.max(axis=1, keepdims=True)
    assert np.abs(apart)[strong].max() < 1, apart


def test_levels_are_a_weighted_and_go_with_the_square_of_the_drive(monkeypatch: pytest.MonkeyPatch) -> None:
    tones = np.array([[0.2, 0, 0, 0], [0, 0.2, 0, 0.2], [0, 0, 0, 0]])
    found = loudness(np.array([100.0, 1000.0, 15.0, 17e3]), tones)
    one = 20 * np.log10(0.2 / np.sqrt(2) / 20e-6)
    assert found == pytest.approx([one - 19.1, one, -np.inf], abs=0.1)
    solution = midair.solve(midair.Scene(midair.Array.grid(4, 4, 8.5e-3), [[0, 0, 0.06]]))
    beat = solution.modulated(200, rate=2000)
    setting = beat.setting()
    half = midair.Sequence(beat.array, beat.points, beat.targets, beat.drives / 2, **setting)
    ears = {"ear": [0, 0.1, 0.2]}
    level = beat.exposure(ears, audible=True)
    assert half.exposure(ears, audible=True).loudest == pytest.approx(level.loudest - 12.04, abs=0.01)
    assert level.loudest == level["ear"].audible
    assert "dB(A)" in repr(level)
    assert "audible" in level.to_dict()
    assert beat.exposure(ears)["ear"].audible is None
    done: list[tuple[int, int]] = []
    again = beat.exposure(ears, audible=True, progress=lambda *step: done.append(step))
    assert again.loudest == level.loudest
    assert done[0][0] == 0 < done[1][0] <= done[-1][0] == done[-1][1]
    with pytest.raises(KeyboardInterrupt):
        beat.exposure(ears, audible=True, progress=lambda *_: False)
    with pytest.raises(midair.SceneError, match="progress is 3: give a function of"):
        beat.exposure(ears, progress=3)
    with pytest.raises(midair.SceneError, match="audible is True: give a sequence"):
        solution.exposure(ears, audible=True)
    monkeypatch.setenv("MIDAIR_MEMORY", "100kB")
    with pytest.raises(MemoryError, match=r"audible sound of 10 frames at 1 place needs .* GB: give fewer frames"):
        beat.exposure(ears, audible=True)
