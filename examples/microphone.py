"""Four foci tuned by a microphone: the picture shows |p| at each focus before and after.
The microphone is simulated, or on a sound card.

    python examples/microphone.py                    simulated: an array that differs from its model
    python examples/microphone.py --device 3         a sound card: a microphone at each focus, a channel each

A sound card needs the extra midair[sound] and a rate of 96 kHz or more. This is untested on hardware.
"""

import argparse
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import midair

FREQUENCY = 40e3
#: The duration of a reading, and the waiting time after a change of drive until the sound is steady, in s.
LISTEN, SETTLE = 10e-3, 5e-3


def simulated(scene: midair.Scene, seed: int = 0) -> Callable[[Any], Any]:
    """Returns readings of an array with errors:
    gains 10 %, phases 20 degrees, 3 % dead, 346.1 m/s, noise 60 dB.
    """
    rng = np.random.default_rng(seed)
    n = len(scene.array)
    response = (1 + 0.1 * rng.normal(size=n)) * np.exp(1j * np.radians(20) * rng.normal(size=n))
    response[rng.choice(n, n * 3 // 100, replace=False)] = 0
    matrix = scene.replace(sound_speed=346.1).propagation() * response
    noise = 1e-3 * float(scene.reach().level.mean())
    return lambda drive: np.abs(np.abs(matrix @ drive) + noise * rng.normal(size=len(matrix)))


def sound_card(
    play: Callable[[Any], object], device: int, channels: int, rate: float, pascals: float
) -> Callable[[Any], Any]:
    """Returns readings of a sound card: the amplitude at 40 kHz of each channel, `pascals` at its full scale.

    The card has its own clock, so there is no phase: readings are |p|.
    """
    try:
        import sounddevice
    except (ImportError, OSError) as error:
        raise SystemExit(f"error: no sounddevice ({error}): pip install 'midair[sound]', and PortAudio") from None
    count = round((SETTLE + LISTEN) * rate)
    kept = round(LISTEN * rate)
    window = np.hanning(kept)[:, None]
    tone = window * np.exp(-2j * np.pi * FREQUENCY / rate * np.arange(kept))[:, None]

    def read(drive: Any) -> Any:
        play(drive)
        received = sounddevice.rec(count, samplerate=rate, channels=channels, device=device, blocking=True)
        if np.abs(received).max() > 0.99:
            raise midair.SceneError("the sound card clips: turn its gain down, or play at a lower intensity")
        return pascals * 2 * np.abs(np.sum(received[-kept:] * tone, axis=0)) / window.sum()

    return read


def draw(received: Mapping[str, Any]) -> None:
    """Prints the foci of each method, and draws them as microphone.png."""
    figure = Figure(figsize=(7, 3.8), layout="constrained")
    ax = figure.subplots()
    for k, (way, pressures) in enumerate(received.items()):
        print(f"{way}:", np.round(pressures), "Pa")
        ax.bar(np.arange(1, len(pressures) + 1) + 0.27 * (k - 1), pressures, width=0.25, label=way)
    ax.set(xlabel="focus", ylabel="|p| at the microphone / Pa", xticks=range(1, 5), ylim=(0, 4200))
    ax.legend()
    figure.savefig("microphone.png")


def main() -> None:
    """Tunes the foci, and prints the result."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--device", type=int, help="number of the sound card (python -m sounddevice lists them)")
    parser.add_argument("--rate", type=float, default=192e3, help="samples a second")
    parser.add_argument("--pascals", type=float, default=20.0, help="peak pressure at the card's full scale")
    parser.add_argument("--board", default="autd3", help="kind of board that plays")
    given = parser.parse_args()
    if given.device is None:
        array = midair.Array.grid(16, 16, 10e-3)
        scene = midair.Scene(array, [[x, y, 0.15] for x in (-0.02, 0.02) for y in (-0.02, 0.02)])
        read = simulated(scene)
        received = {"the model's answer": read(midair.solve(scene, "uniform").drive)}
        for method in ("feedback", "greedy"):
            found = midair.tune(read, scene, method, start="model")  # type: ignore[arg-type]
            received[f"{method}, {found.readings} readings"] = found.pressures
        draw(received)
        return
    array = midair.Array.preset(given.board)
    middle = array.positions.mean(axis=0)
    points = middle + np.array([[x, y, 0.15] for x in (-0.02, 0.02) for y in (-0.02, 0.02)])
    scene = midair.Scene(array, points)
    with midair.connect(given.board) as board:
        read = sound_card(board.send, given.device, len(points), given.rate, given.pascals)
        found = midair.tune(read, scene, "feedback")
    print(found.status, np.round(found.pressures), "Pa")


if __name__ == "__main__":
    main()
