"""Built: the page's files inside the package, put there by `make studio`."""

from __future__ import annotations

from pathlib import Path

from .._midair import SceneError

#: Where they are.
BUILT = Path(__file__).with_name("built")


def file(name: str, folder: Path = BUILT) -> Path:
    """A file of the page by name. Raises SceneError where the page was never built."""
    path = folder / name
    if not path.is_file():
        raise SceneError(f"the studio's {name} is not built: run `make studio` in a clone of midair")
    return path
