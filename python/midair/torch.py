"""PyTorch: quantities of the field at points, with the gradients of `midair.grad`.

`field` is an autograd function: `loss.backward()` gives the gradients by drive, points, positions, normals
and sound speed. It needs the extra `midair[torch]`.

Examples
--------
>>> import midair, torch
>>> drive = torch.ones(400, dtype=torch.complex64, requires_grad=True)
>>> array = midair.Array.preset("paper20")
>>> midair.torch.field(array, drive, [[0.0, 0.0, 0.15]], "amplitude").sum().backward()
>>> drive.grad.shape
torch.Size([400])
"""

from collections.abc import Mapping
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from ._midair import Array, Bead, Scene, Solution
from ._support import slips
from ._support.arguments import needs
from .grad import NAMES, run

if TYPE_CHECKING:
    import torch

__all__ = ["field"]


@cache
def _function() -> tuple[Any, Any]:
    """Return PyTorch and the autograd function, which is defined at the first call."""
    with needs("midair.torch needs PyTorch", "torch"):
        import torch
        from torch.autograd.function import once_differentiable

    class Field(torch.autograd.Function):  # type: ignore[misc, unused-ignore]
        """Autograd function of a quantity. Its arguments are the call, the tensors' names and the tensors."""

        @staticmethod
        def forward(ctx: Any, call: tuple[Any, ...], names: tuple[str, ...], *tensors: Any) -> Any:
            arrays = [tensor.detach().resolve_conj().cpu().numpy() for tensor in tensors]
            ctx.call, ctx.given = call, dict(zip(names, arrays, strict=True))
            ctx.kinds = [(tensor.dtype, tensor.device) for tensor in tensors]
            quantity, scene, bead = call
            value = torch.from_numpy(run(quantity, scene, ctx.given, bead)[0])
            kind, device = ctx.kinds[0]
            if kind in (torch.float32, torch.complex64):
                value = value.to(torch.complex64 if value.is_complex() else torch.float32)
            return value.to(device)

        @staticmethod
        @once_differentiable  # type: ignore[untyped-decorator, unused-ignore]
        def backward(ctx: Any, cotangent: Any) -> Any:
            quantity, scene, bead = ctx.call
            slopes = run(quantity, scene, ctx.given, bead, cotangent.resolve_conj().cpu().numpy())[1:]
            by = dict(zip(NAMES, slopes, strict=True))
            parts = []
            for name, (kind, device) in zip(ctx.given, ctx.kinds, strict=True):
                own = np.array(by[name])
                own = own if kind.is_complex else own.real
                parts.append(torch.as_tensor(own, dtype=kind, device=device))
            return (None, None, *parts)

    return torch, Field


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
) -> "torch.Tensor":
    """Compute a quantity of the field of a drive at points, as a tensor with gradients.

    Parameters
    ----------
    scene : midair.Scene, midair.Array or midair.Solution
        A scene, an array in its own air, or a solution, which gives its scene.
    drive : (N,) tensor or array_like
        Real or complex drive; the answer has the same precision.
    points : (M, 3) tensor or array_like
        Points in m.
    quantity : str, optional
        "pressure" (M,) complex, "amplitude" or "radiation" (M,) in Pa, "gorkov" (M,) in J, "force" (M, 3) in
        N or "stiffness" (M, 3) in N/m.
    positions, normals : (N, 3) tensor or array_like, optional
        Replace those of the array; a normal may have any length.
    sound_speed : float or tensor, optional
        Sound speed in m/s; replaces that of the air.
    bead : midair.Bead or mapping, optional
        The sphere for forces; by default the scene's.

    Returns
    -------
    torch.Tensor
        The quantity, computed on the CPU in double precision. PyTorch refuses second derivatives.

    Raises
    ------
    SceneError
        As for `midair.grad`, and if PyTorch is not installed.

    Examples
    --------
    >>> import midair, torch
    >>> array = midair.Array.preset("paper20")
    >>> midair.torch.field(array, torch.ones(400), [[0.0, 0.0, 0.15]]).shape
    torch.Size([1])
    """
    torch, function = _function()
    values = (drive, points, positions, normals, sound_speed)
    given = {name: value for name, value in zip(NAMES, values, strict=True) if value is not None}
    tensors = [x if torch.is_tensor(x) else torch.as_tensor(np.asarray(x)) for x in given.values()]
    return function.apply((quantity, scene, bead), tuple(given), *tensors)


slips.attach(__name__)
