"""JAX: quantities of the field at points, with the gradients of `midair.grad`.

`field` has a vector-Jacobian product of its own: `jax.grad`, `jax.jit` and `jax.vmap` take it. It needs the
extra `midair[jax]`.

Examples
--------
>>> import jax, midair
>>> array, points = midair.Array.preset("paper20"), [[0.0, 0.0, 0.15]]
>>> def loudness(drive):
...     return midair.jax.field(array, drive, points, "amplitude").sum()
>>> jax.grad(loudness)(jax.numpy.ones(400)).shape
(400,)
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ._midair import Array, Bead, Scene, Solution
from ._support import slips
from ._support.arguments import needs
from .grad import NAMES, run

if TYPE_CHECKING:
    import jax

__all__ = ["field"]


def field(
    scene: Scene | Array | Solution,
    drive: Any,
    points: Any,
    quantity: str = "pressure",
    *,
    positions: Any = None,
    normals: Any = None,
    sound_speed: Any = None,
    bead: Bead | Mapping[str, Any] | None = None,
) -> "jax.Array":
    """Compute a quantity of the field of a drive at points, as a JAX array with gradients.

    Parameters
    ----------
    scene : midair.Scene, midair.Array or midair.Solution
        A scene, an array in its own air, or a solution, which gives its scene.
    drive : (N,) array_like
        Real or complex drive; the answer has the same precision.
    points : (M, 3) array_like
        Points in m.
    quantity : str, optional
        "pressure" (M,) complex, "amplitude" or "radiation" (M,) in Pa, "gorkov" (M,) in J, "force" (M, 3) in
        N or "stiffness" (M, 3) in N/m.
    positions, normals : (N, 3) array_like, optional
        Replace those of the array; a normal may have any length.
    sound_speed : float, optional
        Sound speed in m/s; replaces that of the air.
    bead : midair.Bead or mapping, optional
        The sphere for forces; by default the scene's.

    Returns
    -------
    jax.Array
        The quantity, computed on the CPU in double precision. JAX refuses forward mode and second
        derivatives.

    Raises
    ------
    SceneError
        As for `midair.grad`, and if JAX is not installed.

    Examples
    --------
    >>> import jax, midair
    >>> array = midair.Array.preset("paper20")
    >>> midair.jax.field(array, jax.numpy.ones(400), [[0.0, 0.0, 0.15]]).shape
    (1,)
    """
    with needs("midair.jax needs JAX", "jax"):
        import jax
    values = (drive, points, positions, normals, sound_speed)
    named = {name: value for name, value in zip(NAMES, values, strict=True) if value is not None}
    given = {name: 1.0 * jax.numpy.asarray(value) for name, value in named.items()}
    double = given["drive"].dtype in (np.float64, np.complex128)
    kinds = (np.complex128, np.float64) if double else (np.complex64, np.float32)
    shape = given["points"].shape[:-1] + ((3,) if quantity in ("force", "stiffness") else ())
    answer = jax.ShapeDtypeStruct(shape, kinds[quantity != "pressure"])
    shapes = {name: jax.ShapeDtypeStruct(x.shape, x.dtype) for name, x in given.items()}

    def value(given: Any) -> Any:
        return run(quantity, scene, given, bead)[0].astype(answer.dtype)

    def slopes(given: Any, cotangent: Any) -> Any:
        # JAX's gradient with respect to a complex number is the conjugate of midair's.
        found = run(quantity, scene, given, bead, np.conj(cotangent))[1:]
        by = {name: np.conj(np.asarray(x)) for name, x in zip(NAMES, found, strict=True)}
        real = {name: by[name] if np.iscomplexobj(given[name]) else by[name].real for name in given}
        return {name: x.astype(given[name].dtype) for name, x in real.items()}

    @jax.custom_vjp  # type: ignore[untyped-decorator, unused-ignore]
    def own(given: Any) -> Any:
        return jax.pure_callback(value, answer, given, vmap_method="sequential")

    def back(given: Any, cotangent: Any) -> Any:
        return (jax.pure_callback(slopes, shapes, given, cotangent, vmap_method="sequential"),)

    own.defvjp(lambda given: (own(given), given), back)
    return own(given)


slips.attach(__name__)
