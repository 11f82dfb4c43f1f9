"""Drives for airborne ultrasound phased arrays: the pressure at given points is what you request.

>>> import midair
>>> array = midair.Array.preset("paper20")
>>> scene = midair.Scene(array, [[-0.02, 0, 0.15], [0.02, 0, 0.15]])
>>> solution = midair.solve(scene, "greedy", seed=1)
>>> solution.metrics.accuracy > 0.8
True

SI units, e^{-jwt}, peak pressures: every convention is in docs/conventions.md.
"""

from . import _toolbox

# Each name is loaded at its first use: `_toolbox.HOMES`, from which each build makes `__init__.pyi` for type
# checkers.
__all__ = _toolbox.NAMES
__getattr__ = _toolbox.load


def __dir__() -> list[str]:
    return [*_toolbox.NAMES, "__version__"]


_toolbox.attach()
