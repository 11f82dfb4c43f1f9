"""`midair.recipes`: named stimuli for one place of a hand."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..path import Path, circle, still

#: Samples per second of the touch's envelope.
SAMPLES = 1000


def recipes(place: ArrayLike) -> dict[str, Path]:
    """Return stimuli for a place of a hand, by name: paths for `midair.sequence` and `midair.haptic`.

    Parameters
    ----------
    place : (3,) array_like
        Place in m; the hand is normal to z.

    Returns
    -------
    dict of str to midair.path.Path
        "pressure": a focus that circles on 3 mm 5 times a second, felt as a steady push, hardly as vibration
        (Morisaki et al., IEEE Trans. Haptics, 2024, 10.1109/TOH.2023.3338230; arXiv 2601.16767). It feels
        smooth as a marble; "pressure and 30 Hz" and "pressure and 150 Hz" add vibration and feel rougher, up
        to sandpaper (arXiv 2601.16767).
        "AM": a focus at rest, modulated at 200 Hz, where the finger is most sensitive: a buzz (Dalecki et
        al., J. Acoust. Soc. Am. 97, 3165, 1995). "LM": a focus that circles on 8.5 mm 50 times a second, a
        flutter, stronger than AM of 50 Hz (Takahashi et al., IEEE Trans. Haptics 13(2), 2020). "STM": a focus
        that draws a circle of 3 cm radius at 7 m/s, a ring (Frier et al., EuroHaptics 2018).
        "touch": on for 0.1 s, then off for 0.1 s: an onset and a release. Play it once. No paper was read.

    Raises
    ------
    SceneError
        For a wrong place.

    Examples
    --------
    >>> import midair
    >>> array = midair.Array.preset("autd3")
    >>> push = midair.sequence(array, midair.recipes([0, 0, 0.15])["pressure"], rate=1e3, change=3.14)
    >>> midair.skin(push).felt_force > 0.1
    True
    """
    push = circle(place, 0.003, frequency=5)
    once = np.repeat([1.0, 0.0], SAMPLES // 10)
    return {
        "pressure": push,
        "pressure and 30 Hz": push.modulated(30),
        "pressure and 150 Hz": push.modulated(150),
        "AM": still(place, duration=0.1).modulated(200),
        "LM": circle(place, 0.0085, frequency=50),
        "STM": circle(place, 0.03, speed=7),
        "touch": still(place, duration=len(once) / SAMPLES).modulated(once, samples_rate=SAMPLES),
    }
