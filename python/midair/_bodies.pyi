"""Obstacles of a few numbers, from the core. Made by `make stubs`."""

from typing import Final, Literal, TypeAlias, final

from numpy.typing import ArrayLike

__all__ = ["Sphere", "Wall"]

@final
class Wall:
    def __new__(
        cls, point: ArrayLike, normal: ArrayLike, kind: Literal["rigid", "soft"] = "rigid"
    ) -> Wall: ...
    point: Final[tuple[float, float, float]]
    normal: Final[tuple[float, float, float]]
    kind: Final[Literal["rigid", "soft"]]
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Sphere:
    def __new__(
        cls, center: ArrayLike, radius: float, kind: Literal["rigid", "soft"] = "rigid"
    ) -> Sphere: ...
    center: Final[tuple[float, float, float]]
    radius: Final[float]
    kind: Final[Literal["rigid", "soft"]]
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

Body: TypeAlias = Wall | Sphere
