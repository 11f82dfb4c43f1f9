"""Scene files with moving points: the table [motion] with its paths, beside array, medium and solver."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .._midair import Array, Motion, SceneError, solver_name
from .._support.arguments import existing
from .frames import air_of
from .sequence import Sequence
from .solve import sequence


@dataclass(frozen=True)
class Document:
    """A motion read from a scene file: the arguments of `midair.sequence`."""

    motion: Motion

    @property
    def array(self) -> Array:
        """The array of the file."""
        return self.motion.scene.array

    @property
    def solver(self) -> str:
        """Name of the file's solver; glide without one."""
        return (self.motion.scene.solver or ("glide", {}))[0]

    def solve(self, array: Array | None = None, solver: str | None = None, **keywords: Any) -> Sequence:
        """Solve the sequence; `array` and `solver` replace those of the file.

        The file's options apply to its own solver only. An error about a value of [motion] names the place in
        the file.
        """
        scene, name = self.motion.scene, self.solver if solver is None else solver_name(solver)
        options = scene.solver[1] if scene.solver and name == self.solver else {}
        given = {**self.motion.settings, **air_of(scene), **options, **keywords}
        try:
            return sequence(scene.array if array is None else array, self.motion.path, name, **given)
        except SceneError as error:
            placed = None if error.item in keywords else self.motion.placed(error)
            if placed is None:
                raise
            raise placed from error


def read(file: Path) -> Document | None:
    """Read the motion of a scene file, None if it has no [motion]. Errors name the file and the line."""
    motion = Motion.read(existing("path", file, "give a .toml or .json file"))
    return None if motion is None else Document(motion)
