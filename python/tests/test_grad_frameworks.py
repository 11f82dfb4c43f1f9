"""`midair.torch` and `midair.jax` against `midair.grad`;
if a framework is missing, the message names its extra.
"""

import sys
from typing import Any

import numpy as np
import pytest

import midair

ARRAY = midair.Array.grid(4, 3, 10e-3, directivity={"piston": 4.5e-3})
POINTS = np.array([[0.01, 0, 0.1], [-0.02, 0.01, 0.12]])
DRIVE = np.exp(1j * np.arange(12))
#: Normals whose lengths are not 1.
NORMALS = ARRAY.normals * np.linspace(0.5, 2, 12)[:, None]
QUANTITIES = ("pressure", "amplitude", "radiation", "gorkov", "force", "stiffness")


def wanted(quantity: str) -> tuple[Any, midair.grad.Gradient]:
    """Returns a random cotangent of a quantity, and the gradients that `midair.grad` computes for it."""
    shape = (2, 3) if quantity in ("force", "stiffness") else (2,)
    rng = np.random.default_rng(1)
    cotangent = rng.normal(size=shape) + (1j * rng.normal(size=shape) if quantity == "pressure" else 0)
    return cotangent, getattr(midair.grad, quantity)(ARRAY, DRIVE, POINTS, cotangent)


def near(found: Any, expected: Any) -> bool:
    return bool(np.allclose(found, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max()))


@pytest.mark.slow
@pytest.mark.parametrize("quantity", QUANTITIES)
def test_torch_has_the_gradients_of_midair(quantity: str) -> None:
    torch = pytest.importorskip("torch")
    cotangent, by = wanted(quantity)
    given = {"positions": ARRAY.positions, "normals": NORMALS, "sound_speed": np.array(340.0)}
    leaves = {name: torch.tensor(x, requires_grad=True) for name, x in given.items()}
    drive, points = (torch.tensor(x, requires_grad=True) for x in (DRIVE, POINTS))
    value = midair.torch.field(ARRAY, drive, points, quantity, **leaves)
    assert near(value.detach().numpy(), by.value)
    value.backward(torch.tensor(cotangent))
    assert near(drive.grad.numpy(), by.drive)
    assert near(points.grad.numpy(), by.points)
    assert near(leaves["positions"].grad.numpy(), by.positions)
    length = np.linalg.norm(NORMALS, axis=1, keepdims=True)
    assert near(leaves["normals"].grad.numpy(), by.normals / length)
    assert near(leaves["sound_speed"].grad.numpy(), by.sound_speed)


@pytest.mark.slow
def test_torch_answers_in_the_drives_precision_and_takes_real_drives() -> None:
    torch = pytest.importorskip("torch")
    drive = torch.ones(12, requires_grad=True)
    value = midair.torch.field(ARRAY, drive, POINTS, "amplitude")
    assert value.dtype == torch.float32
    value.sum().backward()
    assert drive.grad.dtype == torch.float32
    assert np.allclose(drive.grad, midair.grad.amplitude(ARRAY, np.ones(12), POINTS).drive.real, rtol=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("quantity", QUANTITIES)
def test_jax_has_the_gradients_of_midair(quantity: str) -> None:
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    cotangent, by = wanted(quantity)
    own = {"drive": DRIVE, "points": POINTS, "positions": ARRAY.positions, "normals": NORMALS}

    def field(given: Any) -> Any:
        rest = {name: given[name] for name in ("positions", "normals", "sound_speed")}
        return midair.jax.field(ARRAY, given["drive"], given["points"], quantity, **rest)

    value, back = jax.vjp(jax.jit(field), {**own, "sound_speed": 340.0})
    assert near(value, by.value)
    # JAX's gradient by a complex number is the complex conjugate of ours.
    (found,) = back(jax.numpy.asarray(np.conj(cotangent), value.dtype))
    length = np.linalg.norm(NORMALS, axis=1, keepdims=True)
    assert near(found["drive"], by.drive.conj())
    assert near(found["points"], by.points)
    assert near(found["positions"], by.positions)
    assert near(found["normals"], by.normals / length)
    assert near(found["sound_speed"], by.sound_speed)


@pytest.mark.slow
def test_jax_maps_over_drives_in_single_precision() -> None:
    jax = pytest.importorskip("jax")
    drives = np.stack([DRIVE, DRIVE.conj()]).astype(np.complex64)

    def loudness(drive: Any) -> Any:
        return midair.jax.field(ARRAY, drive, POINTS, "amplitude").sum()

    found = jax.vmap(jax.grad(loudness))(drives)
    for own, drive in zip(found, drives, strict=True):
        expected = midair.grad.amplitude(ARRAY, drive, POINTS).drive.conj()
        assert np.allclose(own, expected, rtol=1e-4, atol=1e-4 * abs(expected).max())


@pytest.mark.parametrize(("name", "package"), [("torch", "PyTorch"), ("jax", "JAX")])
def test_what_is_missing_is_named_with_its_extra(name: str, package: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, name, None)
    module = getattr(midair, name)
    if name == "torch":
        module._function.cache_clear()
    with pytest.raises(midair.SceneError) as refusal:
        module.field(ARRAY, DRIVE, POINTS)
    assert str(refusal.value) == f'midair.{name} needs {package}: pip install "midair[{name}]"'
