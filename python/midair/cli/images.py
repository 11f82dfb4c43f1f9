"""Pictures of fields as files, and the titles in them."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING

from .. import Solution, output

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def title(solution: Solution) -> str:
    """The solver and those of its options that change a picture most."""
    options = solution.options
    told = (
        key for key in ("phases", "amplitudes", "order", "limit") if isinstance(options.get(key), str | int)
    )
    return ", ".join([solution.solver, *(f"{key}={options[key]}" for key in told)])


def write_image(path: Path, figure: Figure) -> None:
    """Write a figure in the format of the path's ending."""
    content = io.BytesIO()
    figure.savefig(content, format=path.suffix[1:].lower(), dpi=150)
    output.write(path, content.getvalue())
