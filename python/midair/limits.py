"""Limits of sound pressure levels in air, each with its source: what others have written down, not advice."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ._midair import Scene, SceneError
from .shape.arguments import number, refused


@dataclass(frozen=True)
class Limit:
    """A level that somebody has named as a limit.

    name : what it is asked for by
    spl : in dB re 20 uPa
    band : lowest and highest frequency in Hz that it is meant for
    source : who says so, and for whom
    """

    name: str
    spl: float
    band: tuple[float, float]
    source: str


LIMITS = {
    limit.name: limit
    for limit in (
        Limit(
            "howard",
            110.0,
            (25e3, 50e3),
            "consensus of the limits reviewed by Howard, Hansen and Zander 2004, under 4 hours a day",
        ),
        Limit(
            "acgih",
            115.0,
            (31.5e3, 100e3),
            "ACGIH, ceiling at work where the body may touch water or solids that carry the sound",
        ),
        Limit(
            "acgih air",
            145.0,
            (31.5e3, 100e3),
            "ACGIH, the same raised by 30 dB where the body cannot touch such water or solids",
        ),
        Limit("irpa", 100.0, (25e3, 100e3), "IRPA 1984, interim guideline for the public, continuous"),
    )
}


def limit_of(scene: Scene, asked: Any) -> Limit:
    """The limit by its name, or by a level in dB of one's own; refused where it is not meant for."""
    if not isinstance(asked, str):
        return Limit("own", number("limit", asked), (0.0, float("inf")), "a level of one's own")
    found = LIMITS.get(asked.lower().replace("-", " ").replace("_", " "))
    if found is None:
        raise refused("limit", asked, f"give {', '.join(LIMITS)}, or a level in dB")
    low, high = found.band
    if not low <= scene.frequency <= high:
        raise SceneError(
            f'limit "{found.name}" is for {low / 1e3:g} to {high / 1e3:g} kHz,'
            f" not {scene.frequency / 1e3:g} kHz: give a level in dB that is meant for it"
        )
    return found
