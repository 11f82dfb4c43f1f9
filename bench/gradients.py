"""Value and gradient of |p| in midair and in JAX, measured in one run: bench/records/gradients.csv.

JAX runs on all threads, in single precision (its default) and in double precision; midair runs in double
precision. Their results are compared before the times are measured. Times are CPU times in ms of all
threads, the least of several rounds in which all calls take turns, so that other programs on the machine
have little effect. This needs `midair[jax]`.
"""

import sys
import time
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import record

import midair

WAVENUMBER = 2 * np.pi * 40e3 / 340
#: Transducers along a side of the array, and numbers of points.
SIZES = ((16, 4), (16, 64), (32, 4), (32, 64), (32, 256))
ROUNDS, CALLS = 15, 10


def jax_loss(drive: Any, points: Any, positions: Any, weights: Any) -> Any:
    """Returns the sum of weights times |p|, in JAX's own operations."""
    d = points[:, None] - positions
    r = jnp.sqrt((d**2).sum(-1))
    field = (4.386 / r * jnp.exp(1j * WAVENUMBER * r)) @ drive
    return (weights * jnp.abs(field)).sum()


#: The compiled `jax_loss`, and its gradients by drive, points and positions.
VALUE = jax.jit(jax_loss)
SLOPES = jax.jit(jax.value_and_grad(jax_loss, argnums=(0, 1, 2)))


def interleaved(calls: dict[str, Callable[[], Any]]) -> dict[str, float]:
    """Returns the CPU time of each call in ms, measured in turns."""
    times: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(ROUNDS):
        for name, call in calls.items():
            begin = time.process_time()
            for _ in range(CALLS):
                call()
            times[name].append(1e3 * (time.process_time() - begin) / CALLS)
    return {name: min(own) for name, own in times.items()}


def measure(side: int, count: int) -> dict[str, float]:
    """Returns the times for one size; both programs compute gradients by drive, points and positions."""
    rng = np.random.default_rng(1)
    array = midair.Array.grid(side, side, 10e-3)
    points = rng.uniform([-0.05, -0.05, 0.1], [0.05, 0.05, 0.2], (count, 3))
    drive = np.exp(2j * np.pi * rng.uniform(size=len(array)))
    weights = rng.uniform(size=count)
    scene = midair.Scene(array, points)
    real = (points, array.positions, weights)
    single = [jnp.asarray(x, jnp.float32) for x in real]
    single = (jnp.asarray(drive, jnp.complex64), *single)
    double = (jnp.asarray(drive), *(jnp.asarray(x) for x in real))
    by = midair.grad.amplitude(scene, drive, points, weights)
    off = {}
    for name, inputs, most in (("single", single, 1e-3), ("double", double, 1e-6)):
        pairs = zip((by.drive.conj(), by.points, by.positions), SLOPES(*inputs)[1], strict=True)
        off[name] = max(np.abs(own - np.asarray(other)).max() / np.abs(own).max() for own, other in pairs)
        assert off[name] < most, (name, off[name])
    times = interleaved(
        {
            "field": lambda: midair.field(scene, drive, points),
            "value": lambda: midair._midair.gradient("amplitude", scene, drive, points),
            "gradient": lambda: midair.grad.amplitude(scene, drive, points, weights),
            "single_value": lambda: VALUE(*single).block_until_ready(),
            "single_gradient": lambda: jax.block_until_ready(SLOPES(*single)),
            "double_value": lambda: VALUE(*double).block_until_ready(),
            "double_gradient": lambda: jax.block_until_ready(SLOPES(*double)),
        }
    )
    return {**times, "single_off": float(off["single"]), "double_off": float(off["double"])}


def main() -> None:
    """Measures all sizes, prints them, and adds them to the record."""
    jax.config.update("jax_enable_x64", True)
    rows = []
    for side, count in SIZES:
        times = measure(side, count)
        shown = {name: f"{own:.1e}" if "off" in name else f"{own:.4f}" for name, own in times.items()}
        whole = times["gradient"]
        ratios = {name: f"{times[f'{name}_gradient'] / whole:.1f}" for name in ("single", "double")}
        rows.append({"N": side * side, "M": count, **shown, **ratios})
        print(rows[-1])
    record.add("gradients.csv", [{"jax": jax.__version__, **row} for row in rows])


if __name__ == "__main__":
    sys.exit(main())
